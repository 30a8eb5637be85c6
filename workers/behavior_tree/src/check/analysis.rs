//! What can happen in a tree, whoever it belongs to: every case of its conditions, ticked.

use std::collections::BTreeMap;
use std::fmt;

use serde::Serialize;
use socrates_model::{Action, Fault, FaultCode, Gesture, Where};

use crate::check::atoms::MAX_EXACT;
use crate::check::cases::{Case, Cases};
use crate::check::has_foreign;
use crate::parse::Options;
use crate::tree::{Node, Tree};

/// Which cases were ticked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Cover {
    /// Every case that the world allows: what is not found does not exist.
    Every {
        /// Number of cases.
        cases: usize,
    },
    /// A fixed sample, because there are too many conditions: more than [`Cover::MOST_CONDITIONS`].
    Sample {
        /// Number of cases.
        cases: usize,
    },
}

impl Cover {
    /// Most conditions (timers and memories included) for which every case is ticked.
    pub const MOST_CONDITIONS: usize = MAX_EXACT;
}

/// What a tick analysis found. Each list is empty for a good tree.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Analysis {
    /// Nodes of the unfolded tree.
    pub nodes: usize,
    /// What the tree asks, in words: conditions, timers, memories, and leaves whose meaning is not known here.
    pub conditions: Vec<String>,
    /// Which cases were ticked.
    pub cover: Cover,
    /// Leaves whose meaning is not known here; each was taken to succeed and to fail, never to run on, and may move
    /// the human or not. Where there are any, frozen cases are not reported.
    pub opaque: Vec<String>,
    /// `B-DEAD`: topmost nodes that no case comes to.
    pub dead: Vec<Fault>,
    /// `B-MOVE2`: motions that are done in the same tick, each set once, in its simplest case.
    pub double_motion: Vec<Fault>,
    /// `B-STILL`: cases in which nothing moves the human and no goal is taken, now or later, while they last.
    pub frozen: Vec<Fault>,
    /// `B-LATCH`: gestures that stay up in a case that neither takes them back nor makes another.
    pub stuck_gestures: Vec<Fault>,
}

impl Analysis {
    /// All findings, in the order of the lists.
    pub fn faults(&self) -> impl Iterator<Item = &Fault> {
        self.dead.iter().chain(&self.double_motion).chain(&self.frozen).chain(&self.stuck_gestures)
    }
}

impl fmt::Display for Analysis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.cover {
            Cover::Every { cases } => writeln!(f, "ticked: all {cases} cases of {} conditions", self.conditions.len())?,
            Cover::Sample { cases } => writeln!(
                f,
                "ticked: a sample of {cases} cases, for there are {} conditions and all cases are ticked up to {}; \
                 what is not found may still exist",
                self.conditions.len(),
                Cover::MOST_CONDITIONS
            )?,
        }
        if !self.opaque.is_empty() {
            writeln!(
                f,
                "taken to succeed and to fail, for their meaning is not known here: {}",
                self.opaque.join(", ")
            )?;
        }
        for (what, found) in [
            ("dead branches", &self.dead),
            ("two motions in one tick", &self.double_motion),
            ("frozen", &self.frozen),
            ("stuck gestures", &self.stuck_gestures),
        ] {
            if found.is_empty() {
                writeln!(f, "{what}: none")?;
            } else {
                writeln!(f, "{what}: {}", found.len())?;
                for fault in found {
                    writeln!(f, "  {fault}")?;
                }
            }
        }
        Ok(())
    }
}

/// Ticks every case of a tree, or a fixed sample beyond [`Cover::MOST_CONDITIONS`] conditions.
#[must_use]
pub fn analyze(tree: &Tree) -> Analysis {
    let cases = Cases::of(tree);
    let n = cases.all.len();
    let is_exact = cases.atoms.len() <= MAX_EXACT;
    let mut dead = Vec::new();
    cases.dead(false, &at, &mut dead);
    let mut opaque: Vec<String> = tree
        .nodes
        .iter()
        .filter(|node| node.sheet.role.is_opaque())
        .map(|node| node.document_tag().to_owned())
        .collect();
    opaque.sort_unstable();
    opaque.dedup();
    Analysis {
        nodes: tree.nodes.len(),
        conditions: cases.atoms.iter().map(|atom| atom.phrase(tree, true)).collect(),
        cover: if is_exact { Cover::Every { cases: n } } else { Cover::Sample { cases: n } },
        opaque,
        dead,
        double_motion: double_motion(&cases),
        frozen: if has_foreign(tree) { Vec::new() } else { frozen(&cases) },
        stuck_gestures: stuck(&cases),
    }
}

fn at(node: &Node) -> Where {
    Where::from(&node.site).at_key(format_args!("{} `{}`", node.document_tag(), node.name))
}

/// Place of a leaf.
fn leaf_at(tree: &Tree, leaf: u16) -> Where {
    tree.nodes.iter().find(|node| node.leaf == leaf).map_or_else(Where::default, at)
}

fn simplicity(case: &Case) -> usize {
    case.truth.iter().filter(|holds| **holds).count()
}

/// Keeps the simpler of two cases.
fn simplest<'a>(known: &mut &'a Case, case: &'a Case) {
    if simplicity(case) < simplicity(known) {
        *known = case;
    }
}

/// A case, and the motions of one of its ticks with their leaves.
type Doing<'a> = (&'a Case, &'a [(Action, u16)]);

/// Each set of motions that some case does in one tick.
fn double_motion(cases: &Cases<'_>) -> Vec<Fault> {
    let mut found: BTreeMap<Vec<u16>, Doing<'_>> = BTreeMap::new();
    for case in &cases.all {
        for acts in case.acts.iter().filter(|acts| acts.len() > 1) {
            let leaves = acts.iter().map(|(_, leaf)| *leaf).collect();
            let known = found.entry(leaves).or_insert((case, acts.as_slice()));
            if simplicity(case) < simplicity(known.0) {
                *known = (case, acts.as_slice());
            }
        }
    }
    let told = found.iter().map(|(leaves, (case, acts))| {
        let done: Vec<String> = acts.iter().map(|(action, _)| action.they()).collect();
        let message = format!("two motions in one tick, {}: {}; allowed: one", cases.words(case), done.join(" and "));
        let second = leaves.get(1).copied().unwrap_or(0);
        Fault::new(FaultCode::BMove2, leaf_at(cases.tree, second), message)
    });
    told.collect()
}

/// The simplest case in which nothing ever happens, for each set of nodes it comes to.
fn frozen(cases: &Cases<'_>) -> Vec<Fault> {
    let acts = |case: &Case| case.acts.iter().any(|acts| !acts.is_empty()) || case.goals.contains(&true);
    let still: Vec<&Case> =
        cases.all.iter().filter(|case| !acts(case) && !cases.future(case).iter().any(acts)).collect();
    let mut found: BTreeMap<&[bool], &Case> = BTreeMap::new();
    for case in still {
        simplest(found.entry(case.visited()).or_insert(case), case);
    }
    let root = cases.tree.nodes.first().map_or_else(Where::default, at);
    let message = |case: &Case| {
        format!(
            "no motion runs, now or later, {}: it freezes; end with the block of regular navigation, or say StandStill \
             if that is meant",
            cases.words(case)
        )
    };
    found.values().map(|case| Fault::new(FaultCode::BStill, &root, message(case))).collect()
}

/// Gestures that are made in one case and stay in another that may follow it.
fn stuck(cases: &Cases<'_>) -> Vec<Fault> {
    let calls = |case: &Case| case.gestures.iter().any(|made| !made.is_empty());
    let silent: Vec<&Case> =
        cases.all.iter().filter(|case| !calls(case) && !cases.future(case).iter().any(calls)).collect();
    // The simplest case of each memory stands for all of them.
    let mut kept: BTreeMap<Vec<bool>, &Case> = BTreeMap::new();
    for case in silent {
        simplest(kept.entry(cases.memory_at_start(case)).or_insert(case), case);
    }
    let mut raised: BTreeMap<(Gesture, Vec<bool>), &Case> = BTreeMap::new();
    for case in &cases.all {
        for gesture in case.gestures.iter().filter_map(|made| made.last().copied().flatten()) {
            simplest(raised.entry((gesture, cases.memory_at_end(case))).or_insert(case), case);
        }
    }
    let mut found: BTreeMap<Gesture, (&Case, &Case)> = BTreeMap::new();
    for ((gesture, memory), case) in &raised {
        let follows = kept.iter().filter(|(later, _)| memory.iter().zip(*later).all(|(is, will)| *will || !*is));
        let Some(later) = follows.map(|(_, later)| *later).min_by_key(|later| simplicity(later)) else { continue };
        let known = found.entry(*gesture).or_insert((case, later));
        if simplicity(case) + simplicity(later) < simplicity(known.0) + simplicity(known.1) {
            *known = (case, later);
        }
    }
    let root = cases.tree.nodes.first().map_or_else(Where::default, at);
    let told = found.iter().map(|(gesture, (raised, kept))| {
        let message = format!(
            "{gesture} is raised {} and stays {}; put MakeGesture message='0' into every branch that does not make it",
            cases.words(raised),
            cases.words(kept)
        );
        Fault::new(FaultCode::BLatch, &root, message)
    });
    told.collect()
}

/// Everything that can be said of a document by itself.
#[derive(Debug, Clone, Serialize)]
pub struct CheckReport {
    /// Faults of the document, with line and column; without any there is a tree.
    pub faults: Vec<Fault>,
    /// What can happen in the tree; `None` where the document has faults.
    pub analysis: Option<Analysis>,
    /// The tree itself.
    #[serde(skip)]
    pub tree: Option<Tree>,
}

impl CheckReport {
    /// Whether the document loads and the analysis found nothing.
    #[must_use]
    pub fn is_clean(&self) -> bool {
        self.analysis.as_ref().is_some_and(|analysis| analysis.faults().next().is_none())
    }
}

impl fmt::Display for CheckReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for fault in &self.faults {
            writeln!(f, "{fault}")?;
        }
        match &self.analysis {
            Some(analysis) => analysis.fmt(f),
            None => Ok(()),
        }
    }
}

/// Reads a document and, where it has no fault, ticks every case of it.
#[must_use]
pub fn check_report(xml: &str, options: &Options<'_>) -> CheckReport {
    match Tree::parse_with(xml, options) {
        Ok(tree) => CheckReport { faults: Vec::new(), analysis: Some(analyze(&tree)), tree: Some(tree) },
        Err(faults) => CheckReport { faults, analysis: None, tree: None },
    }
}
