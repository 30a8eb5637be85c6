//! Robots that are driven from outside: who drives, and what is kept of it.
//!
//! ```text
//! Mission ─► Outside::begin ─► Driver: Observation ─► Command        over the bus (`over_bus`), or
//!                                └─► Commands, kept in the bundle ─► the same run again (`Again`), without the driver
//! ```
//!
//! A driver that hangs, dies or answers what no robot can be told ends its run with `J-DRIVER`.

mod again;
mod line;
mod mission;
mod over_bus;
mod settings;
#[cfg(test)]
mod tests;

use socrates_engine::Onlooker;
use socrates_model::driver::Commands;
use socrates_model::{
    AgentState, Command, Event, EventKind, Fault, FaultCode, Observation, RecordingHeader, RobotDriver, RunId, Where,
};
use socrates_planners::Mission;

pub use again::Again;
pub use line::{Claims, Line, told};
pub use over_bus::OverBus;
pub use settings::{Drive, Mode};

/// Which run a driver is wanted for.
#[derive(Debug, Clone, Copy)]
pub struct Wanted<'a> {
    /// Name of the driver, without `external:`.
    pub driver: &'a str,
    /// The run.
    pub run: &'a RunId,
    /// Its seed.
    pub seed: u64,
    /// Everybody who may be met.
    pub people: &'a [socrates_model::HumanId],
    /// Its task.
    pub mission: &'a Mission,
}

/// Where drivers outside are found.
pub trait Outside {
    /// A driver for this run.
    ///
    /// # Errors
    /// `J-DRIVER` when there is none.
    fn begin(&mut self, wanted: &Wanted<'_>) -> Result<Box<dyn Driver>, Fault>;
}

/// A robot's driver outside of the planners' catalog.
pub trait Driver: RobotDriver {
    /// The run is over: why, when, and whether the robot arrived.
    fn over(&mut self, ended: &Ended);

    /// Why it drives no more, if it does not.
    fn fault(&self) -> Option<Fault>;
}

/// How a run ended.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Ended {
    /// `done`, `time`, `stuck` or `driver`.
    pub reason: String,
    /// When, simulated, s.
    pub time_s: f64,
    /// Whether the robot arrived.
    pub arrived: bool,
}

/// No driver can be reached: runs of one process, without a bus.
#[derive(Debug, Clone, Copy, Default)]
pub struct Nobody;

impl Outside for Nobody {
    fn begin(&mut self, wanted: &Wanted<'_>) -> Result<Box<dyn Driver>, Fault> {
        Err(fault(wanted.driver, "drivers outside are reached by `socrates run` and `socrates serve` alone"))
    }
}

/// The fault of a driver.
pub(crate) fn fault(driver: &str, why: impl Into<String>) -> Fault {
    Fault::new(FaultCode::JDriver, Where::key(format_args!("driver {driver}")), why.into())
}

/// A driver, and every command that it gave.
pub(crate) struct Kept {
    pub(crate) driver: Box<dyn Driver>,
    pub(crate) commands: Vec<Command>,
}

impl Kept {
    /// What is kept of it.
    pub(crate) fn commands(&self) -> Commands {
        Commands { format: socrates_model::FORMAT, rate_hz: self.driver.rate_hz(), commands: self.commands.clone() }
    }
}

impl RobotDriver for Kept {
    fn rate_hz(&self) -> f64 {
        self.driver.rate_hz()
    }

    fn drive(&mut self, seen: &Observation<'_>) -> Command {
        let command = self.driver.drive(seen);
        self.commands.push(command);
        command
    }

    fn is_gone(&self) -> bool {
        self.driver.is_gone()
    }
}

/// Looks on, and remembers how the run ended.
pub(crate) struct Ending<'a> {
    pub(crate) onlooker: &'a mut dyn Onlooker,
    pub(crate) ended: Ended,
}

impl Onlooker for Ending<'_> {
    fn announce(&mut self, header: &RecordingHeader) {
        self.onlooker.announce(header);
    }

    fn tick(&mut self, states: &[AgentState], events: &[Event]) {
        for event in events {
            self.ended.arrived |= matches!(event.kind, EventKind::RobotArrived);
            if let EventKind::End { reason } = &event.kind {
                self.ended.reason.clone_from(reason);
                self.ended.time_s = event.time.secs();
            }
        }
        self.onlooker.tick(states, events);
    }
}
