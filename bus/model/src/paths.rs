//! Paths and encounters.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::ids::{AgentId, HumanId, NodeId};

/// Where robot and a human meet.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Encounter {
    /// The human.
    pub human: HumanId,
    /// The node, on both paths; for a human who stays behind a door, the robot's last node.
    pub node: NodeId,
}

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
    /// At most one per human, in the order in which the robot comes to them.
    pub encounters: Vec<Encounter>,
    /// Why these paths, in a sentence or two.
    #[serde(default)]
    pub reasoning: String,
    /// Who wrote it.
    pub author: String,
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

    /// The node where the robot meets a human.
    #[must_use]
    pub fn encounter_of(&self, human: HumanId) -> Option<&NodeId> {
        self.encounters.iter().find(|encounter| encounter.human == human).map(|encounter| &encounter.node)
    }
}
