//! Checks of a tree without a simulator: form, every case of its conditions, and what was asked.

mod aim;
mod analysis;
mod atoms;
mod case_world;
mod cases;
mod form;
mod listen;
mod matching;

pub use analysis::{Analysis, CheckReport, Cover, analyze, check_report};

use std::collections::BTreeMap;

use socrates_model::{Fault, FaultCode, Gesture, HumanId, Rule, Where};

use crate::rules;
use crate::tree::{Node, Tree};

/// What a tree is held against.
#[derive(Debug, Clone, Copy)]
pub struct CheckContext<'a> {
    /// Whose tree it is.
    pub human: HumanId,
    /// Number of humans in the scenario.
    pub humans: u32,
    /// Gestures the robot's script makes.
    pub robot_says: &'a [Gesture],
    /// Gestures the trees of the others make.
    pub human_says: &'a BTreeMap<HumanId, Vec<Gesture>>,
    /// What the proposal asks of this human, earlier rules first.
    pub rules: &'a [Rule],
}

/// All faults of a tree: `B-NAV`, `B-TIMER`, `B-ORDER`, `B-DEAD`, `B-MOVE2`, `B-STILL`, `B-LATCH`, `B-HEAR`,
/// `B-RANGE`, `B-PORT`, `B-MATCH`, `B-CONTRA`. Empty for a good tree.
///
/// The tick analysis is exact for trees whose leaves finish in the tick they run in, up to twelve
/// different conditions; beyond that, a fixed sample of cases is ticked.
#[must_use]
pub fn check(tree: &Tree, ctx: &CheckContext<'_>) -> Vec<Fault> {
    let contradictions: Vec<Fault> =
        rules::check(ctx.human, ctx.rules).into_iter().filter(|fault| fault.code == FaultCode::BContra).collect();
    let cases = cases::Cases::of(tree);
    let mut faults = form::check(tree, ctx);
    faults.extend(listen::check(tree, ctx));
    faults.extend(cases.check(ctx));
    faults.extend(matching::check(&cases, ctx));
    faults.extend(contradictions);
    faults
}

/// Human, place and tag, as faults give it.
fn place(ctx: &CheckContext<'_>, node: &Node) -> Where {
    Where::from(&node.site).of(ctx.human).at_key(node.sheet.tag)
}

/// Places of a node and everything below it, in pre-order.
fn below(tree: &Tree, node: usize) -> Vec<usize> {
    let mut found = vec![node];
    let mut at = 0;
    while let Some(next) = found.get(at).copied() {
        found.extend(tree.nodes.get(next).map_or(&[][..], |it| it.children.as_slice()));
        at += 1;
    }
    found
}

/// Whether a tree has leaves nothing is known about.
fn has_foreign(tree: &Tree) -> bool {
    tree.nodes.iter().any(|node| node.sheet.role.is_opaque())
}
