//! Robots and people that are driven from outside: who drives, and what is kept of it.
//!
//! ```text
//! Mission ─► Outside::begin ─► Driver: Observation ─► Command        over the bus (`over_bus`), or
//!                                └─► Commands, kept in the bundle ─► the same run again (`Again`), without the drivers
//! ```
//!
//! One process may drive the robot and several people of a run: each of them is a session of its own. A driver that hangs, dies or
//! answers what nobody can be told ends its run with `J-DRIVER`.

mod again;
mod line;
mod mission;
mod over_bus;
#[cfg(test)]
mod people_tests;
mod settings;
#[cfg(test)]
mod tests;

pub use socrates_engine::body_of;
use socrates_model::driver::{MissionPerson, Told};
use socrates_model::{
    AgentId, AgentState, Command, Event, EventKind, Fault, FaultCode, HumanId, Observation, Onlooker, Point,
    RecordingHeader, RobotDriver, RunId, Where,
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
    /// Everybody else who may be met.
    pub people: &'a [HumanId],
    /// The person who is to be driven; nothing for the robot.
    pub person: Option<&'a MissionPerson>,
    /// The task: body, way and map of the one who is driven.
    pub mission: &'a Mission,
}

impl Wanted<'_> {
    /// The one who is driven: the robot, or a person.
    #[must_use]
    pub fn agent(&self) -> AgentId {
        self.person.map_or(AgentId::Robot, |person| person.id.into())
    }

    /// Where its faults are: which driver, and of whom, where that is not the robot.
    #[must_use]
    pub fn place(&self) -> String {
        self.person.map_or_else(|| self.driver.to_owned(), |person| format!("{} of {}", self.driver, person.id))
    }

    /// A fault of this driver.
    pub(crate) fn fault(&self, why: impl Into<String>) -> Fault {
        fault(&self.place(), why)
    }
}

/// Where drivers outside are found.
pub trait Outside {
    /// A driver for this run.
    ///
    /// # Errors
    /// `J-DRIVER` when there is none.
    fn begin(&mut self, wanted: &Wanted<'_>) -> Result<Box<dyn Driver>, Fault>;
}

/// A driver outside of the planners' catalog and of the models of people.
pub trait Driver: RobotDriver {
    /// The run is over: why, when, and whether the one who was driven arrived.
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
    /// Whether the one who was driven arrived.
    pub arrived: bool,
}

/// No driver can be reached: runs of one process, without a bus.
#[derive(Debug, Clone, Copy, Default)]
pub struct Nobody;

impl Outside for Nobody {
    fn begin(&mut self, wanted: &Wanted<'_>) -> Result<Box<dyn Driver>, Fault> {
        Err(wanted.fault("drivers outside are reached by `socrates run` and `socrates serve` alone"))
    }
}

/// The fault of a driver, named by [`Wanted::place`].
pub(crate) fn fault(place: &str, why: impl Into<String>) -> Fault {
    Fault::new(FaultCode::JDriver, Where::key(format_args!("driver {place}")), why.into())
}

/// Nearer than this to the end of their way a person has arrived, m: as near as a robot has to come.
const ARRIVED_M: f64 = 0.5;

/// A driver, and every command that it gave.
pub(crate) struct Kept {
    driver: Box<dyn Driver>,
    commands: Vec<Command>,
    /// End of the way, where it drives a person.
    goal: Option<Point>,
}

impl Kept {
    /// The driver that is wanted.
    pub(crate) fn begin(outside: &mut dyn Outside, wanted: &Wanted<'_>) -> Result<Self, Fault> {
        let goal = wanted.person.and_then(|_| wanted.mission.waypoints.last()).copied();
        Ok(Self { driver: outside.begin(wanted)?, commands: Vec::new(), goal })
    }

    /// Tells it how the run ended for the one whom it drove, and hands over what is kept of it, or its fault.
    pub(crate) fn over(mut self, agent: AgentId, ending: &Ending<'_>) -> Result<Told, Fault> {
        let there = |goal: Point| ending.at(agent).is_some_and(|at| (at - goal).norm() <= ARRIVED_M);
        let arrived = self.goal.map_or(ending.ended.arrived, there);
        self.driver.over(&Ended { arrived, ..ending.ended.clone() });
        match self.driver.fault() {
            Some(fault) => Err(fault),
            None => Ok(Told { rate_hz: self.driver.rate_hz(), commands: self.commands }),
        }
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
    onlooker: &'a mut dyn Onlooker,
    ended: Ended,
    /// Everybody as they were at the end.
    last: Vec<AgentState>,
}

impl<'a> Ending<'a> {
    pub(crate) fn of(onlooker: &'a mut dyn Onlooker) -> Self {
        Self { onlooker, ended: Ended::default(), last: Vec::new() }
    }

    /// Where somebody was at the end.
    fn at(&self, agent: AgentId) -> Option<Point> {
        self.last.iter().find(|state| state.agent_id() == agent).map(AgentState::point)
    }
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
                self.last = states.to_vec();
            }
        }
        self.onlooker.tick(states, events);
    }
}
