//! Everything a run is made from, and what is wrong with it.

use std::collections::BTreeMap;

use socrates_bt::Tree;
use socrates_model::request::Waypoints;
use socrates_model::{
    AgentId, Behaviors, Fault, FaultCode, HumanId, Location, Paths, PlannerName, Proposal, RobotModel, RunId, Where,
};

/// Input of one run.
#[derive(Debug, Clone)]
pub struct Setup {
    /// Where.
    pub location: Location,
    /// Who, and what should happen.
    pub proposal: Proposal,
    /// Ways and encounters.
    pub paths: Paths,
    /// Trees.
    pub behaviors: Behaviors,
    /// Planner, for the header; with [`PlannerName::no_robot`] there is no robot.
    pub planner: PlannerName,
    /// Simulation seed: speeds and small differences between people are drawn from it.
    pub seed: u64,
    /// Name of the run.
    pub run: RunId,
    /// Fixed duration, s; `None` runs until everything is done, at most [`MAX_AUTO_S`].
    pub duration_s: Option<f64>,
    /// Body of the robot.
    pub robot: RobotModel,
    /// Which nodes of the intended way the planner is given.
    pub waypoints: Waypoints,
}

/// Longest run without a fixed duration, s (simulated).
pub const MAX_AUTO_S: f64 = 120.0;
/// Body radius of a person, m: half the shoulder width of the native profile.
pub const PERSON_RADIUS_M: f64 = 0.28;

/// Reads every tree and checks that the parts fit each other.
///
/// # Errors
/// All faults at once: ids that do not fit (`G-AGENTS`, `B-AGENTS`), unknown nodes (`G-UNKNOWN`), empty
/// paths (`G-EMPTY`), unreadable trees (`B-…`, with the human in front).
pub(crate) fn trees(setup: &Setup) -> Result<BTreeMap<HumanId, Tree>, Vec<Fault>> {
    let mut faults = path_faults(setup);
    let mut trees = BTreeMap::new();
    for human in &setup.proposal.humans {
        let Some(behavior) = setup.behaviors.humans.get(&human.id) else {
            let have: Vec<String> = setup.behaviors.humans.keys().map(ToString::to_string).collect();
            let message = format!("{} has no tree; trees are given for {}", human.id, list(&have));
            faults.push(Fault::new(FaultCode::BAgents, human.id, message));
            continue;
        };
        match Tree::parse(&behavior.tree) {
            Ok(tree) => {
                trees.insert(human.id, tree);
            }
            Err(why) => faults.extend(why.into_iter().map(|fault| fault.of(human.id))),
        }
    }
    if socrates_model::fault::hard(&faults).is_empty() { Ok(trees) } else { Err(faults) }
}

fn path_faults(setup: &Setup) -> Vec<Fault> {
    let mut faults = Vec::new();
    let agents =
        std::iter::once(AgentId::Robot).chain(setup.proposal.humans.iter().map(|human| AgentId::Human(human.id)));
    for agent in agents {
        let Some(nodes) = setup.paths.of(agent) else {
            faults.push(Fault::new(FaultCode::GAgents, agent, format!("{agent} has no path")));
            continue;
        };
        if nodes.is_empty() {
            faults.push(Fault::new(FaultCode::GEmpty, agent, format!("the path of {agent} has no node")));
        }
        for (node, step) in nodes.iter().zip(1..) {
            if setup.location.graph.node(node).is_none() {
                let message = format!("the scene graph has no node `{node}`");
                faults.push(Fault::new(FaultCode::GUnknown, Where::agent(agent).step(step), message));
            }
        }
    }
    for encounter in &setup.paths.encounters {
        if setup.location.graph.node(&encounter.node).is_none() {
            let message = format!(
                "the encounter of {} is at `{}`, which the scene graph does not have",
                encounter.human, encounter.node
            );
            faults.push(Fault::new(FaultCode::GUnknown, encounter.human, message));
        }
    }
    faults
}

fn list(names: &[String]) -> String {
    if names.is_empty() { "nobody".to_owned() } else { names.join(", ") }
}
