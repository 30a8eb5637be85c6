//! One run, pure: the same setup gives the same recording.

use socrates_engine::{Engine, Keeper, Onlooker, Setup};
use socrates_maps::openings::Enclosures;
use socrates_model::driver::Commands;
use socrates_model::request::Waypoints;
use socrates_model::{
    Behaviors, Fault, FaultCode, HumanId, Location, NodeId, Paths, PlannerName, Point, Proposal, Recording, Request,
    RunId,
};
use socrates_planners::{Mission, make};

use crate::driving::{Ended, Ending, Kept, Nobody, Outside, Wanted};

/// The setup of a run from its artifacts. Without a request the robot is the default one and the run ends by itself.
#[must_use]
pub fn setup(
    location: Location,
    mut proposal: Proposal,
    paths: Paths,
    behaviors: Behaviors,
    request: Option<&Request>,
    run: RunId,
    seed: u64,
) -> Setup {
    let robot = request.map(|request| request.robot.model).unwrap_or_default();
    let waypoints = request.map(|request| request.robot.waypoints).unwrap_or_default();
    let duration_s = request.and_then(|request| request.run.duration.fixed_s());
    for gesture in request.iter().flat_map(|request| &request.robot.gestures) {
        let line = gesture.line();
        if !proposal.robot.script.contains(&line) {
            proposal.robot.script.push(line);
        }
    }
    Setup {
        location,
        proposal,
        paths,
        behaviors,
        planner: PlannerName::reference(),
        seed,
        run,
        duration_s,
        robot,
        waypoints,
    }
}

/// The driver of a run.
#[derive(Debug, Clone, Copy)]
pub struct Driven<'a> {
    /// The planner.
    pub planner: &'a PlannerName,
    /// The parameter file of Nav2 that it is, where it is a planner of the request's own.
    pub nav2: Option<&'a str>,
}

impl<'a> From<&'a PlannerName> for Driven<'a> {
    fn from(planner: &'a PlannerName) -> Self {
        Self { planner, nav2: None }
    }
}

/// Runs a setup with a planner of the catalog.
///
/// # Errors
/// `J-PLANNER` with the list of planners; what [`Engine::new`] finds.
pub fn simulate(setup: Setup, planner: &PlannerName) -> Result<Recording, Vec<Fault>> {
    let mut keeper = Keeper::default();
    simulate_into(setup, planner, &mut Nobody, &mut keeper)?;
    let nothing = || vec![Fault::new(FaultCode::JPanic, "the engine", "it ended before the first tick")];
    keeper.recording().ok_or_else(nothing)
}

/// The same; `onlooker` gets everything as it comes, and nothing of it is kept. A planner that no catalog has is looked for
/// `outside`; its commands are given back.
///
/// # Errors
/// As [`simulate`]; `J-DRIVER` when the driver outside did not drive.
pub fn simulate_into<'a>(
    mut setup: Setup,
    driven: impl Into<Driven<'a>>,
    outside: &mut dyn Outside,
    onlooker: &mut dyn Onlooker,
) -> Result<Option<Commands>, Vec<Fault>> {
    let Driven { planner, nav2 } = driven.into();
    let own = planner.external().is_some() || nav2.is_some();
    if !own && !socrates_planners::names().contains(&planner.as_str()) {
        return Err(vec![socrates_planners::catalog::unknown(planner.as_str())]);
    }
    setup.planner = planner.clone();
    let given = waypoints(&setup);
    let (robot, grid) = (setup.robot, setup.location.grid.clone());
    let doors = Enclosures::of(&setup.location).doors(&setup.location);
    let route = setup.location.graph.polyline(&setup.paths.robot);
    let script = setup.proposal.robot.script.clone();
    let place = |node: &NodeId| setup.location.graph.node(node).map(|node| node.at);
    // The script's `at_encounter` means the first of somebody who meets the robot several times.
    let encounters =
        setup.paths.encounters.iter().rev().filter_map(|meet| Some((meet.human, place(&meet.node)?))).collect();
    let people: Vec<HumanId> = setup.proposal.humans.iter().map(|human| human.id).collect();
    let groups = setup.proposal.humans.iter().filter_map(|human| Some((human.id, human.group?.0))).collect();
    let (run, seed) = (setup.run.clone(), setup.seed);
    let engine = Engine::new(setup)?;
    let field = engine.floor().field().clone();
    let mission = Mission { robot, grid, field, doors, route, waypoints: given, script, groups, seed, encounters };
    let Some(driver) = planner.external() else {
        let made = nav2.map_or_else(
            || make(planner.as_str(), &mission),
            |text| socrates_planners::catalog::nav2(planner.as_str(), text, &mission).map(Some),
        );
        let mut driver = made.map_err(|fault| vec![fault])?;
        match driver.as_mut() {
            Some(driver) => engine.play(Some(driver.as_mut()), onlooker),
            None => engine.play(None, onlooker),
        }
        return Ok(None);
    };
    let wanted = Wanted { driver, run: &run, seed, people: &people, mission: &mission };
    let driver = outside.begin(&wanted).map_err(|fault| vec![fault])?;
    let mut kept = Kept { driver, commands: Vec::new() };
    let mut ending = Ending { onlooker, ended: Ended::default() };
    engine.play(Some(&mut kept), &mut ending);
    kept.driver.over(&ending.ended);
    match kept.driver.fault() {
        Some(fault) => Err(vec![fault]),
        None => Ok(Some(kept.commands())),
    }
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
