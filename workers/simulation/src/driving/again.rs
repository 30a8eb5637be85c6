//! A run that was driven from outside, played again from its commands.

use socrates_model::driver::{Commands, Told};
use socrates_model::{Command, Fault, Observation, RobotDriver};

use super::{Driver, Ended, Outside, Wanted, fault};

/// Drives with the commands that drivers gave before.
#[derive(Debug, Clone)]
pub struct Again {
    commands: Commands,
}

impl Again {
    /// With these commands.
    #[must_use]
    pub const fn new(commands: Commands) -> Self {
        Self { commands }
    }
}

impl Outside for Again {
    fn begin(&mut self, wanted: &Wanted<'_>) -> Result<Box<dyn Driver>, Fault> {
        let agent = wanted.agent();
        let told = self.commands.of(agent);
        let Told { rate_hz, commands } =
            told.ok_or_else(|| wanted.fault(format!("the commands that were kept hold none for {agent}")))?;
        if !(1.0..=100.0).contains(&rate_hz) {
            return Err(wanted.fault(format!("`rate_hz` of its commands is {rate_hz}; allowed: 1 to 100")));
        }
        let commands = commands.into_iter();
        Ok(Box::new(Player { place: wanted.place(), rate_hz, commands, given: 0, fault: None }))
    }
}

/// The commands, one after the other.
struct Player {
    place: String,
    rate_hz: f64,
    commands: std::vec::IntoIter<Command>,
    given: usize,
    fault: Option<Fault>,
}

impl RobotDriver for Player {
    fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    fn drive(&mut self, seen: &Observation<'_>) -> Command {
        let Some(command) = self.commands.next() else {
            let at = seen.time.secs();
            let why = format!("at {at:.2} s: its commands end after {}, and the run goes on", self.given);
            self.fault = Some(fault(&self.place, why));
            return Command::default();
        };
        self.given += 1;
        command
    }

    fn is_gone(&self) -> bool {
        self.fault.is_some()
    }
}

impl Driver for Player {
    fn over(&mut self, _ended: &Ended) {}

    fn fault(&self) -> Option<Fault> {
        self.fault.clone()
    }
}
