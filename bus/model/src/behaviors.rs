//! Behaviors: one behavior tree per human.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::ids::HumanId;

/// One human's tree.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HumanBehavior {
    /// BehaviorTree.CPP XML (v3 or v4).
    pub tree: String,
    /// The tree in words.
    #[serde(default)]
    pub description: String,
}

/// Trees of everybody, keyed by human.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Behaviors {
    /// Format number, see [`crate::FORMAT`].
    pub format: u32,
    /// The trees.
    pub humans: BTreeMap<HumanId, HumanBehavior>,
    /// Who wrote them.
    pub author: crate::Signature,
}
