//! The parts of people who are driven from outside: who they are, and their way, as their drivers are told.

use std::collections::BTreeMap;

use socrates_engine::{PERSON_RADIUS_M, Setup, body_of};
use socrates_model::driver::MissionPerson;
use socrates_model::request::Waypoints;
use socrates_model::{
    AgentId, Fault, FaultCode, GroupId, HumanId, PersonModel, Point, RecordingHeader, Relation, Where,
};
use socrates_planners::Mission;

use crate::ways::waypoints;

/// Everybody's part, as far as it is known before the run is made.
pub(crate) struct Parts {
    pub(crate) everybody: Vec<HumanId>,
    driven: BTreeMap<HumanId, Known>,
    groups: Vec<(HumanId, GroupId)>,
}

/// What the scenario says of one of them.
struct Known {
    role: String,
    relation: Relation,
    behavior: String,
    waypoints: Vec<Point>,
    route: Vec<Point>,
    meets: Vec<Point>,
}

/// A person's part, ready to be told.
pub(crate) struct Part {
    pub(crate) person: MissionPerson,
    pub(crate) mission: Mission,
    /// Everybody else.
    pub(crate) others: Vec<HumanId>,
}

impl Parts {
    /// Those of the people who are driven.
    ///
    /// # Errors
    /// `J-REQUEST` for each of them who is not in the scenario.
    pub(crate) fn of(setup: &Setup, people: &BTreeMap<HumanId, PersonModel>) -> Result<Self, Vec<Fault>> {
        let humans = &setup.proposal.humans;
        let everybody: Vec<HumanId> = humans.iter().map(|human| human.id).collect();
        let names: Vec<String> = everybody.iter().map(ToString::to_string).collect();
        let missing = |(id, model): (&HumanId, &PersonModel)| {
            let there = if names.is_empty() { "nobody".to_owned() } else { names.join(", ") };
            let message = format!("`{model}` is to drive {id}, who is not in this scenario; it has {there}");
            Fault::new(FaultCode::JRequest, Where::key(format_args!("people.{id}")), message)
        };
        let faults: Vec<Fault> = people.iter().filter(|(id, _)| !everybody.contains(id)).map(missing).collect();
        if !faults.is_empty() {
            return Err(faults);
        }
        let graph = &setup.location.graph;
        let known = |human: &&socrates_model::HumanProposal| {
            let nodes = setup.paths.of(AgentId::Human(human.id)).unwrap_or_default();
            let meets = setup.paths.encounters.iter().filter(|meet| meet.human == human.id);
            let known = Known {
                role: human.role.clone(),
                relation: human.relation,
                behavior: human.behavior.clone(),
                waypoints: waypoints(graph, nodes, Waypoints::Via),
                route: graph.polyline(nodes),
                meets: meets.filter_map(|meet| graph.node(&meet.node)).map(|node| node.at).collect(),
            };
            (human.id, known)
        };
        let driven = humans.iter().filter(|human| people.contains_key(&human.id)).map(|human| known(&human)).collect();
        let groups = humans.iter().filter_map(|human| Some((human.id, human.group?))).collect();
        Ok(Self { everybody, driven, groups })
    }

    /// The mission of one of them, in the world of the robot's; nothing for somebody who is not driven.
    pub(crate) fn mission(&self, id: HumanId, header: &RecordingHeader, robot: &Mission) -> Option<Part> {
        let Known { role, relation, behavior, waypoints, route, meets } = self.driven.get(&id)?;
        let info = header.agents.iter().find(|info| info.agent == AgentId::Human(id));
        let group = self.groups.iter().find(|(member, _)| *member == id).map(|(_, group)| *group);
        let mates = self.groups.iter().filter(|(mate, of)| *mate != id && Some(*of) == group);
        let person = MissionPerson {
            id,
            role: role.clone(),
            relation: *relation,
            behavior: behavior.clone(),
            pace_mps: info.map_or(0.0, |info| info.speed_mps),
            meets: meets.iter().map(|at| [at.x, at.y]).collect(),
            group: mates.map(|(mate, _)| *mate).collect(),
        };
        let mission = Mission {
            robot: body_of(id, info.map_or(PERSON_RADIUS_M, |info| info.radius_m)),
            route: route.clone(),
            waypoints: waypoints.clone(),
            script: Vec::new(),
            ..robot.clone()
        };
        let others = self.everybody.iter().copied().filter(|other| *other != id).collect();
        Some(Part { person, mission, others })
    }
}
