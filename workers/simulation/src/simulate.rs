//! One run, pure: the same setup gives the same recording.

use socrates_engine::{Engine, Keeper, Onlooker, Setup};
use socrates_model::request::{RobotGesture, Waypoints};
use socrates_model::rule::{RobotDo, RobotRule, RobotWhen};
use socrates_model::{
    Behaviors, Fault, FaultCode, Location, NodeId, Paths, Point, Proposal, Recording, Request, RobotModel, RunId,
};
use socrates_planners::{Mission, make};

/// The setup of a run from its artifacts. Without a request the robot is the default one and the run ends by itself.
///
/// # Errors
/// `J-REQUEST` for a robot model that is not known, a duration or a robot gesture that cannot be read.
pub fn setup(
    location: Location,
    mut proposal: Proposal,
    paths: Paths,
    behaviors: Behaviors,
    request: Option<&Request>,
    run: RunId,
    seed: u64,
) -> Result<Setup, Vec<Fault>> {
    let mut faults = Vec::new();
    let mut robot = RobotModel::default();
    let mut duration_s = None;
    let mut waypoints = Waypoints::default();
    if let Some(request) = request {
        waypoints = request.robot.waypoints;
        match RobotModel::named(&request.robot.model) {
            Some(known) => robot = known,
            None => {
                let names: Vec<&str> = RobotModel::ALL.iter().map(|model| model.name).collect();
                let message =
                    format!("there is no robot model `{}`; allowed: {}", request.robot.model, names.join(", "));
                faults.push(Fault::new(FaultCode::JRequest, "robot.model", message));
            }
        }
        match request.duration_s() {
            Ok(secs) => duration_s = secs,
            Err(why) => faults.push(Fault::new(FaultCode::JRequest, "run.duration", why)),
        }
        for gesture in &request.robot.gestures {
            match gesture_rule(gesture) {
                Ok(rule) if !proposal.robot.script.contains(&rule) => proposal.robot.script.push(rule),
                Ok(_) => {}
                Err(fault) => faults.push(fault),
            }
        }
    }
    if !faults.is_empty() {
        return Err(faults);
    }
    Ok(Setup { location, proposal, paths, behaviors, planner: String::new(), seed, run, duration_s, robot, waypoints })
}

/// `{ when = "blocked 3 s", say = "EXCUSE_ME" }` as a line of the script.
fn gesture_rule(gesture: &RobotGesture) -> Result<RobotRule, Fault> {
    let words: Vec<&str> = gesture.when.split_whitespace().collect();
    let number = |text: &str| {
        text.trim_end_matches(['s', 'm']).parse::<f64>().ok().filter(|value| (0.0..=600.0).contains(value))
    };
    let when = match words.as_slice() {
        ["start"] => Some(RobotWhen::Start),
        ["blocked", secs, ..] => number(secs).map(RobotWhen::Blocked),
        ["human", "within", reach, ..] => number(reach).map(RobotWhen::HumanNear),
        ["after", secs, ..] => number(secs).map(RobotWhen::AfterSecs),
        _ => None,
    };
    let unread = || {
        let message = format!(
            "`{}` is no moment; allowed: `start`, `blocked 3 s`, `human within 2 m`, `after 10 s`",
            gesture.when
        );
        Fault::new(FaultCode::JRequest, "robot.gestures", message)
    };
    Ok(RobotRule { when: when.ok_or_else(unread)?, act: RobotDo::Say(gesture.say) })
}

/// Runs a setup with a planner.
///
/// # Errors
/// `J-PLANNER` with the list of planners; what [`Engine::new`] finds.
pub fn simulate(setup: Setup, planner: &str) -> Result<Recording, Vec<Fault>> {
    let mut keeper = Keeper::default();
    simulate_into(setup, planner, &mut keeper)?;
    let nothing = || vec![Fault::new(FaultCode::JPanic, "the engine", "it ended before the first tick")];
    keeper.recording().ok_or_else(nothing)
}

/// The same; `onlooker` gets everything as it comes, and nothing of it is kept.
///
/// # Errors
/// As [`simulate`].
pub fn simulate_into(mut setup: Setup, planner: &str, onlooker: &mut dyn Onlooker) -> Result<(), Vec<Fault>> {
    if !socrates_planners::names().contains(&planner) {
        return Err(vec![socrates_planners::catalog::unknown(planner)]);
    }
    planner.clone_into(&mut setup.planner);
    let given = waypoints(&setup);
    let (robot, grid, doors) = (setup.robot, setup.location.grid.clone(), setup.location.doors.clone());
    let route = setup.location.graph.polyline(&setup.paths.robot);
    let script = setup.proposal.robot.script.clone();
    let place = |node: &NodeId| setup.location.graph.node(node).map(|node| node.at);
    // The script's `at_encounter` means the first of somebody who meets the robot several times.
    let encounters =
        setup.paths.encounters.iter().rev().filter_map(|meet| Some((meet.human, place(&meet.node)?))).collect();
    let engine = Engine::new(setup)?;
    let field = engine.floor().field().clone();
    let mission = Mission { robot, grid, field, doors, route, waypoints: given, script, encounters };
    let mut driver = make(planner, &mission).map_err(|fault| vec![fault])?;
    match driver.as_mut() {
        Some(driver) => engine.play(Some(driver.as_mut()), onlooker),
        None => engine.play(None, onlooker),
    }
    Ok(())
}

/// The points that the planner is given.
fn waypoints(setup: &Setup) -> Vec<Point> {
    let (graph, nodes) = (&setup.location.graph, setup.paths.robot.as_slice());
    let last = nodes.len().saturating_sub(1);
    let kept: Vec<usize> = match setup.waypoints {
        Waypoints::Ends => vec![0, last],
        Waypoints::All => (0..nodes.len()).collect(),
        Waypoints::Via => {
            // As few nodes as make the shortest way through them the intended one.
            let mut kept = vec![0];
            let mut from = 0;
            while from < last {
                let straight = |to: &usize| match (nodes.get(from), nodes.get(*to), nodes.get(from..=*to)) {
                    (Some(a), Some(b), Some(way)) => graph.shortest(a, b).is_some_and(|short| short == way),
                    _ => false,
                };
                from = (from + 2..=last).rev().find(straight).unwrap_or(from + 1);
                kept.push(from);
            }
            kept
        }
    };
    let mut points: Vec<Point> = kept
        .into_iter()
        .filter_map(|place| nodes.get(place))
        .filter_map(|id| graph.node(id))
        .map(|node| node.at)
        .collect();
    points.dedup();
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use socrates_model::Gesture;

    #[test]
    fn moments_of_robot_gestures_are_read_and_others_named() {
        let read = |when: &str| gesture_rule(&RobotGesture { when: when.to_owned(), say: Gesture::ExcuseMe });
        assert_eq!(read("blocked 3 s").unwrap().when, RobotWhen::Blocked(3.0));
        assert_eq!(read("human within 2m").unwrap().when, RobotWhen::HumanNear(2.0));
        assert_eq!(read("start").unwrap().when, RobotWhen::Start);
        assert!(read("whenever").unwrap_err().message.contains("`whenever`"));
    }
}
