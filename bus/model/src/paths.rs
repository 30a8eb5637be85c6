//! Paths and encounters.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::ids::{AgentId, HumanId, NodeId};

/// Where robot and a human meet.
///
/// A human may have several, given in the order in which robot and human come to them. A node may stand several times
/// on a path: [`Paths::visits`] says which of its visits an encounter means.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Encounter {
    /// The human.
    pub human: HumanId,
    /// The node, on both paths; for a human who stays behind a door, the robot's last node.
    pub node: NodeId,
}

/// Which visit of its node an encounter means, as steps of the two paths, 0 the start.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Visit<'a> {
    /// The node.
    pub node: &'a NodeId,
    /// Step of the robot's path; `None` where the robot does not come there in this order.
    pub robot_step: Option<usize>,
    /// Step of the human's path; `None` where the human does not come there in this order.
    pub human_step: Option<usize>,
}

/// Shortest way of a robot that is accepted, m.
pub const ROBOT_WAY_M: f64 = 6.0;

/// Node sequences for everybody.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Paths {
    /// Format number, see [`crate::FORMAT`].
    pub format: u32,
    /// The robot's nodes, start first.
    pub robot: Vec<NodeId>,
    /// Each human's nodes, start first; one node for somebody who stands.
    pub humans: BTreeMap<HumanId, Vec<NodeId>>,
    /// In the order in which the robot comes to them; a human who meets the robot twice is named twice.
    pub encounters: Vec<Encounter>,
    /// Why these paths, in a sentence or two.
    #[serde(default)]
    pub reasoning: String,
    /// Name of the author.
    pub author: crate::Signature,
}

impl Paths {
    /// Nodes of an agent.
    #[must_use]
    pub fn of(&self, agent: AgentId) -> Option<&[NodeId]> {
        match agent {
            AgentId::Robot => Some(&self.robot),
            AgentId::Human(id) => self.humans.get(&id).map(Vec::as_slice),
        }
    }

    /// Whether the robot's way leads there and back again.
    #[must_use]
    pub fn comes_back(&self) -> bool {
        self.robot.len() > 2 && self.robot.first() == self.robot.last()
    }

    /// The node where the robot's errand leads: its last one, or where a way there and back turns.
    #[must_use]
    pub fn robot_goal(&self) -> Option<&NodeId> {
        if self.comes_back() { self.robot.get(self.robot.len() / 2) } else { self.robot.last() }
    }

    /// The node where the robot meets a human, for the first time if it meets it several times.
    #[must_use]
    pub fn encounter_of(&self, human: HumanId) -> Option<&NodeId> {
        self.encounters_of(human).next()
    }

    /// The nodes where the robot meets a human, one after the other.
    pub fn encounters_of(&self, human: HumanId) -> impl Iterator<Item = &NodeId> {
        self.encounters.iter().filter(move |encounter| encounter.human == human).map(|encounter| &encounter.node)
    }

    /// Which visits of their nodes the encounters of a human mean, one after the other: the first on the robot's path
    /// after that of the encounter before, its start left out, and the same on the human's path, its start counted.
    /// An agent that stands is always at its one node. Where an encounter is not on a path in this order, it has no visit there,
    /// and the next is looked for from the same place.
    #[must_use]
    pub fn visits(&self, human: HumanId) -> Vec<Visit<'_>> {
        let own = self.humans.get(&human).map_or(&[][..], Vec::as_slice);
        let (mut robot_from, mut human_from) = (1, 0);
        let next = |path: &[NodeId], node: &NodeId, from: &mut usize| {
            let step = path.iter().enumerate().skip(*from).find(|(_, other)| *other == node).map(|(step, _)| step);
            *from = step.map_or(*from, |step| step + 1);
            step
        };
        self.encounters_of(human)
            .map(|node| {
                let robot_step = next(&self.robot, node, &mut robot_from);
                let human_step = if own.len() == 1 {
                    own.first().filter(|only| *only == node).map(|_| 0)
                } else {
                    next(own, node, &mut human_from)
                };
                Visit { node, robot_step, human_step }
            })
            .collect()
    }
}

/// Which meeting of a human, in a word: the first, second, third …
#[must_use]
pub fn ordinal(nth: u32) -> String {
    match nth {
        1 => "first".to_owned(),
        2 => "second".to_owned(),
        3 => "third".to_owned(),
        more => {
            let suffix = match (more % 100, more % 10) {
                (11..=13, _) => "th",
                (_, 1) => "st",
                (_, 2) => "nd",
                (_, 3) => "rd",
                _ => "th",
            };
            format!("{more}{suffix}")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn nodes(names: &str) -> Vec<NodeId> {
        names.split(' ').map(|name| NodeId::new(name).unwrap()).collect()
    }

    fn steps(robot: &str, human: &str, meets: &str) -> Vec<(Option<usize>, Option<usize>)> {
        let who = HumanId::new(1);
        let paths = Paths {
            format: crate::FORMAT,
            robot: nodes(robot),
            humans: BTreeMap::from([(who, nodes(human)), (HumanId::new(2), nodes("z"))]),
            encounters: nodes(meets).into_iter().map(|node| Encounter { human: who, node }).collect(),
            reasoning: String::new(),
            author: crate::Signature::default(),
        };
        assert_eq!(paths.encounters_of(HumanId::new(2)).count(), 0);
        assert_eq!(paths.encounter_of(who), paths.encounters_of(who).next());
        paths.visits(who).iter().map(|visit| (visit.robot_step, visit.human_step)).collect()
    }

    #[test]
    fn ordinals_end_as_in_english() {
        let found = [1, 4, 11, 12, 13, 21, 22, 23, 101, 111, 112].map(ordinal).join(" ");
        assert_eq!(found, "first 4th 11th 12th 13th 21st 22nd 23rd 101st 111th 112th");
    }

    #[test]
    fn an_encounter_means_the_first_visit_after_the_one_before() {
        assert_eq!(steps("a b c b d", "d b c b a", "b b"), [(Some(1), Some(1)), (Some(3), Some(3))]);
        assert_eq!(steps("a b c b d", "d c b a", "c b"), [(Some(2), Some(1)), (Some(3), Some(2))]);
        assert_eq!(steps("a b c b d", "d b c b a", "b"), [(Some(1), Some(1))]);
    }

    #[test]
    fn the_robots_start_is_no_encounter() {
        assert_eq!(steps("a b a c", "c a d", "a"), [(Some(2), Some(1))]);
        assert_eq!(steps("a b c", "c a d", "a"), [(None, Some(1))]);
    }

    #[test]
    fn an_encounter_out_of_order_has_no_visit_and_who_stands_is_there_each_time() {
        assert_eq!(steps("a b c d", "d b c e", "c b"), [(Some(2), Some(2)), (None, None)]);
        assert_eq!(steps("a b c b d", "b", "b b"), [(Some(1), Some(0)), (Some(3), Some(0))]);
    }
}
