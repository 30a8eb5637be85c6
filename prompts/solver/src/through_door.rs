//! Doors that somebody has to be seen to go through: an order at a door is one only where the robot's way leads through it too.

use socrates_model::{AgentId, ClauseRole, HumanId, NodeId, PlaceClass, Predicate, Proposal, Relation};

use crate::{Layout, Problem};

/// A problem with the ends of ways that its doors ask for.
#[derive(Debug, PartialEq)]
pub(crate) struct Led {
    proposal: Proposal,
    goals: Vec<NodeId>,
    layout: Layout,
}

impl Led {
    /// The problem so led.
    pub(crate) fn problem<'b>(&'b self, of: &Problem<'b>) -> Problem<'b> {
        Problem { proposal: &self.proposal, goals: self.goals.clone(), layout: self.layout, ..of.clone() }
    }
}

/// What the doors of a problem ask for beside what it has already; `None` where that is nothing.
///
/// The robot goes in to whoever comes out or stays inside. Whoever comes towards a robot that is to be through first goes in where it
/// came out.
pub(crate) fn led(problem: &Problem<'_>) -> Option<Led> {
    let as_it_is = || Led { proposal: problem.proposal.clone(), goals: problem.goals.clone(), layout: problem.layout };
    let mut led = as_it_is();
    for (human, robot_first) in ordered(problem.proposal) {
        let Some(person) = led.proposal.humans.iter_mut().find(|person| person.id == human) else { continue };
        let robot = &mut led.proposal.robot;
        match person.relation {
            Relation::Leaving | Relation::Staying if robot.goal.is_none() && problem.goals.is_empty() => {
                robot.goal = Some(person.start.unwrap_or(PlaceClass::Room));
            }
            Relation::Frontal if robot_first && robot.start.is_none() && problem.starts.is_empty() => {
                (robot.start, led.layout.start) = (Some(PlaceClass::Room), Some(PlaceClass::Room));
                person.goal = person.goal.or(Some(PlaceClass::Room));
            }
            Relation::Leaving
            | Relation::Staying
            | Relation::Frontal
            | Relation::Behind
            | Relation::Ahead
            | Relation::Abreast
            | Relation::Crossing
            | Relation::Static
            | Relation::Aside => {}
        }
    }
    // The robot comes to whoever stays in a room by name, where its task leads it nowhere.
    let humans = &problem.proposal.humans;
    let mut rooms = humans.iter().filter(|human| human.relation == Relation::Staying);
    let room = rooms.find_map(|human| problem.rooms.get(&human.id).filter(|room| !room.is_empty()));
    let others = humans.iter().any(|human| human.relation != Relation::Staying);
    if let Some(room) = room.filter(|_| others && led.goals.is_empty() && led.proposal.robot.goal.is_none()) {
        led.goals.clone_from(room);
    }
    (led != as_it_is()).then_some(led)
}

/// The people of whom an order at a door tells together with the robot, and whether the robot is first.
fn ordered(proposal: &Proposal) -> Vec<(HumanId, bool)> {
    let own = proposal.expected_events.iter().filter(|clause| clause.must && clause.role == ClauseRole::Setup);
    let orders = own.filter_map(|clause| {
        let Predicate::Before { first, then, at_door: true } = &clause.predicate else { return None };
        match (first, then) {
            (AgentId::Robot, AgentId::Human(human)) => Some((*human, true)),
            (AgentId::Human(human), AgentId::Robot) => Some((*human, false)),
            (AgentId::Human(_), AgentId::Human(_)) | (AgentId::Robot, AgentId::Robot) => None,
        }
    });
    orders.collect()
}
