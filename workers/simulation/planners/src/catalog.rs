//! Every planner by name.

use socrates_model::{Fault, FaultCode, PlannerName, RobotDriver, Where};

use crate::mission::Mission;
use crate::nav::{Stack, StackParams};
use crate::nav2;
use crate::params;
use crate::reactive::Reactive;
use crate::reference::Reference;
use crate::rpp::{RegulatedPurePursuit, RppParams};
use crate::walker::Walker;

/// Makes a planner.
type Maker = fn(&Mission) -> Result<Box<dyn RobotDriver>, Fault>;

/// What is known of a planner without making it.
#[derive(Debug, Clone, Copy)]
pub struct PlannerSheet {
    /// Name in requests and reports.
    pub name: &'static str,
    /// One sentence for people.
    pub about: &'static str,
    make: Option<Maker>,
}

/// Every planner, `reference` first.
pub const CATALOG: &[PlannerSheet] = &[
    PlannerSheet {
        name: PlannerName::REFERENCE,
        about: "keeps to the intended way, plays the robot script, steps round people and waits for them",
        make: Some(|mission| Ok(Box::new(Reference::new(mission)))),
    },
    PlannerSheet {
        name: "reactive",
        about: "a simple baseline: the shortest free way through the waypoints, stops for people ahead, goes round who stands; no script",
        make: Some(|mission| Ok(Box::new(Reactive::new(mission)))),
    },
    PlannerSheet {
        name: "straight_line",
        about: "a control: the shortest free way through the waypoints at full speed; it sees walls and doors, and nobody",
        make: Some(|mission| Ok(Box::new(Walker::straight(mission)))),
    },
    PlannerSheet {
        name: "social_force",
        about: "a robot that social forces push as they push people, with the constants of the HuNavSim family",
        make: Some(|mission| Ok(Box::new(Walker::forces(mission)))),
    },
    PlannerSheet {
        name: "orca",
        about: "optimal reciprocal collision avoidance: the velocity nearest to its wish at which nobody is hit within 5 s",
        make: Some(|mission| Ok(Box::new(Walker::avoids(mission)))),
    },
    PlannerSheet {
        name: "rpp",
        about: "Nav2 with NavFn and Regulated Pure Pursuit: sees people by lidar alone, as obstacles; no script",
        make: Some(|mission| Ok(Box::new(rpp(mission)))),
    },
    PlannerSheet {
        name: "socrates_mppi",
        about: "Nav2 with NavFn and MPPI as in the paper's case study: 30 Hz, 2000 trajectories, 0.5 m/s; sees people by lidar alone",
        make: Some(|mission| preset("socrates_mppi", mission)),
    },
    PlannerSheet {
        name: "mppi",
        about: "the same as Nav2's main branch brings it up",
        make: Some(|mission| preset("mppi", mission)),
    },
    PlannerSheet {
        name: "ha_mppi",
        about: "socrates_mppi with a social layer, which keeps it away from people; the parameters are our choice",
        make: Some(|mission| preset("ha_mppi", mission)),
    },
    PlannerSheet {
        name: "nav2can",
        about: "socrates_mppi with the social and group layers of Nav2CAN, which keep it out of groups; the parameters are our choice",
        make: Some(|mission| preset("nav2can", mission)),
    },
    PlannerSheet { name: PlannerName::NO_ROBOT, about: "no robot at all: the twin run", make: None },
];

/// Nav2's stack with Regulated Pure Pursuit and the mission's robot.
fn rpp(mission: &Mission) -> Stack {
    let params = StackParams::shipped(&mission.robot);
    let period_s = 1.0 / params.controller_frequency;
    let controller = RppParams { period_s, ..RppParams::default() }.with_robot(&mission.robot);
    Stack::new(params, mission, Box::new(RegulatedPurePursuit::new(&controller)))
}

/// Nav2 with a preset.
fn preset(name: &str, mission: &Mission) -> Result<Box<dyn RobotDriver>, Fault> {
    nav2(name, params::preset(name).ok_or_else(|| unknown(name))?.text, mission)
}

/// Nav2's stack with the text of a parameter file.
///
/// # Errors
/// `J-PLANNER` with everything that is wrong with it.
pub fn nav2(name: &str, text: &str, mission: &Mission) -> Result<Box<dyn RobotDriver>, Fault> {
    let wrong = |why: String| Fault::new(FaultCode::JPlanner, Where::key(format_args!("planner {name}")), why);
    let loaded = params::read(text).map_err(|bad| wrong(bad.to_string()))?;
    Ok(Box::new(nav2::stack(&loaded.params, mission).map_err(|bad| wrong(bad.to_string()))?))
}

/// Names in catalog order.
#[must_use]
pub fn names() -> Vec<&'static str> {
    CATALOG.iter().map(|sheet| sheet.name).collect()
}

/// The planner of this name; `None` for `none`.
///
/// # Errors
/// `J-PLANNER` with the list of names, or with what is wrong with its parameters.
pub fn make(name: &str, mission: &Mission) -> Result<Option<Box<dyn RobotDriver>>, Fault> {
    let Some(sheet) = CATALOG.iter().find(|sheet| sheet.name == name) else {
        return Err(unknown(name));
    };
    sheet.make.map(|make| make(mission)).transpose()
}

/// The fault for a name that is not in the catalog.
#[must_use]
pub fn unknown(name: &str) -> Fault {
    let message = format!("there is no planner `{name}`; allowed: {}", names().join(", "));
    Fault::new(FaultCode::JPlanner, "planner", message)
}
