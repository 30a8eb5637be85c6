//! One run, pure: the same setup gives the same recording.

use std::collections::BTreeMap;
use std::sync::Arc;

use socrates_engine::{Drivers, Engine, HumanModel, Setup};
use socrates_maps::DistanceField;
use socrates_maps::openings::Enclosures;
use socrates_model::driver::{Commands, Told};
use socrates_model::{
    AgentId, Behaviors, Fault, FaultCode, HumanId, Keeper, Location, NodeId, Onlooker, Paths, PersonModel, PlannerName,
    Proposal, Recording, Request, RobotDriver, RunId,
};
use socrates_planners::{Mission, make};

use crate::driving::{Ending, Kept, Nobody, Outside, Wanted};
use crate::people::Parts;
use crate::ways::waypoints;

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

/// The drivers of a run.
#[derive(Debug, Clone, Copy)]
pub struct Driven<'a> {
    /// The planner.
    pub planner: &'a PlannerName,
    /// The parameter file of Nav2 that it is, where it is a planner of the request's own.
    pub nav2: Option<&'a str>,
    /// People whom drivers outside move.
    pub people: &'a BTreeMap<HumanId, PersonModel>,
}

/// Everybody walks by the simulation's own models.
static NOBODY: BTreeMap<HumanId, PersonModel> = BTreeMap::new();

impl<'a> From<&'a PlannerName> for Driven<'a> {
    fn from(planner: &'a PlannerName) -> Self {
        Self { planner, nav2: None, people: &NOBODY }
    }
}

impl<'a> Driven<'a> {
    /// The drivers of this run of a request.
    #[must_use]
    pub fn of(request: &'a Request, planner: &'a PlannerName) -> Self {
        let nav2 = request.robot.nav2.get(planner).map(String::as_str);
        Self { planner, nav2, people: &request.people }
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

/// The same; `onlooker` gets everything as it comes, and nothing of it is kept. A planner that no catalog has, and whoever moves people
/// instead of the simulation, is looked for `outside`; their commands are given back, if there are any.
///
/// # Errors
/// As [`simulate`]; `J-REQUEST` for a model of somebody who is not there; `J-DRIVER` when a driver outside did not drive.
pub fn simulate_into<'a>(
    mut setup: Setup,
    driven: impl Into<Driven<'a>>,
    outside: &mut dyn Outside,
    onlooker: &mut dyn Onlooker,
) -> Result<Option<Commands>, Vec<Fault>> {
    let Driven { planner, nav2, people } = driven.into();
    let own = planner.external().is_some() || nav2.is_some();
    if !own && !socrates_planners::names().contains(&planner.as_str()) {
        return Err(vec![socrates_planners::catalog::unknown(planner.as_str())]);
    }
    setup.planner = planner.clone();
    let parts = Parts::of(&setup, people)?;
    let task = task(&setup);
    let (run, seed) = (setup.run.clone(), setup.seed);
    let models = people.keys().map(|id| (*id, HumanModel::Driven)).collect();
    let engine = Engine::new(setup)?.with_models(&models)?;
    let mission = task(engine.floor().field().clone());
    let begin = |agent: AgentId, outside: &mut dyn Outside, wanted: Wanted<'_>| {
        Kept::begin(outside, &wanted).map(|kept| (agent, kept)).map_err(|fault| vec![fault])
    };
    let mut kept: Vec<(AgentId, Kept)> = Vec::new();
    let mut inside = None;
    match (planner.external(), nav2) {
        (Some(driver), _) => {
            let wanted = Wanted { driver, run: &run, seed, people: &parts.everybody, person: None, mission: &mission };
            kept.push(begin(AgentId::Robot, outside, wanted)?);
        }
        (None, Some(text)) => {
            let made = socrates_planners::catalog::nav2(planner.as_str(), text, &mission);
            inside = Some(made.map_err(|fault| vec![fault])?);
        }
        (None, None) => inside = make(planner.as_str(), &mission).map_err(|fault| vec![fault])?,
    }
    for (id, model) in people {
        let Some(part) = parts.mission(*id, engine.header(), &mission) else { continue };
        let (others, person) = (&part.others, Some(&part.person));
        let wanted = Wanted { driver: model.driver(), run: &run, seed, people: others, person, mission: &part.mission };
        kept.push(begin((*id).into(), outside, wanted)?);
    }
    let mut drivers = Drivers::from(inside.as_mut().map(|driver| &mut **driver as &mut dyn RobotDriver));
    for (agent, kept) in &mut kept {
        match agent {
            AgentId::Robot => drivers.robot = Some(kept),
            AgentId::Human(id) => drop(drivers.people.insert(*id, kept)),
        }
    }
    let mut ending = Ending::of(onlooker);
    engine.play(drivers, &mut ending);
    let told = kept.into_iter().map(|(agent, kept)| (agent, kept.over(agent, &ending)));
    let told: Vec<(AgentId, Result<Told, Fault>)> = told.collect();
    let mut commands = Commands::default();
    let mut faults = Vec::new();
    for (agent, told) in told {
        match told {
            Ok(told) => commands = commands.with(agent, told),
            Err(fault) => faults.push(fault),
        }
    }
    if faults.is_empty() { Ok(Some(commands).filter(|commands| !commands.is_empty())) } else { Err(faults) }
}

/// The robot's task, once the distances to its walls are known.
fn task(setup: &Setup) -> impl FnOnce(Arc<DistanceField>) -> Mission + use<> {
    let graph = &setup.location.graph;
    let waypoints = waypoints(graph, &setup.paths.robot, setup.waypoints);
    let (robot, grid, seed) = (setup.robot, setup.location.grid.clone(), setup.seed);
    let doors = Enclosures::of(&setup.location).doors(&setup.location);
    let route = socrates_engine::intended_way(setup).0.points().to_vec();
    let script = setup.proposal.robot.script.clone();
    let place = |node: &NodeId| graph.node(node).map(|node| node.at);
    // The script's `at_encounter` means the first of somebody who meets the robot several times.
    let encounters =
        setup.paths.encounters.iter().rev().filter_map(|meet| Some((meet.human, place(&meet.node)?))).collect();
    let groups = setup.proposal.humans.iter().filter_map(|human| Some((human.id, human.group?.0))).collect();
    move |field| Mission { robot, grid, field, doors, route, waypoints, script, groups, seed, encounters }
}
