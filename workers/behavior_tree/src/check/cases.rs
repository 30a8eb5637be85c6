//! Exhaustive tick analysis: every case of the conditions, ticked once.
//!
//! A tree of this library finishes each leaf in the tick it runs in, and its conditions are truths
//! about the world; so the truth of each condition, the phase of each timer and the memory of each
//! latch decide the whole tick. Cases that the world rules out (near at 2 m but not at 5 m) are left out.

use socrates_model::{Action, Fault, FaultCode, Gesture, Where};

use crate::check::atoms::{Atom, atoms, truths};
use crate::check::case_world::CaseWorld;
use crate::check::{CheckContext, below, has_foreign, place};
use crate::nodes::{memory, remembered};
use crate::rules::is_endless;
use crate::sheet::Role;
use crate::status::Status;
use crate::tree::{Node, Tree};

/// Ticks of a case where nodes keep a place between ticks.
const MEMORY_TICKS: usize = 6;

/// Nodes that a tick of a case may come to at least. Nested repetitions say nothing new after that, and there are
/// thousands of cases.
const LEAST_STEPS: usize = 1024;

/// What was seen in one case.
#[derive(Debug, Clone)]
pub(super) struct Case {
    /// Truth of each atom.
    pub(super) truth: Vec<bool>,
    /// Motions and their leaves, tick by tick.
    pub(super) acts: Vec<Vec<(Action, u16)>>,
    /// Gestures, tick by tick.
    pub(super) gestures: Vec<Vec<Option<Gesture>>>,
    /// Whether a tick took the next goal, tick by tick.
    pub(super) goals: Vec<bool>,
    /// Nodes that were come to.
    visited: Vec<bool>,
    /// Atoms of timers that were counting and of latches that were set.
    reached: Vec<bool>,
}

/// Every case of a tree.
pub(super) struct Cases<'a> {
    pub(super) tree: &'a Tree,
    pub(super) atoms: Vec<Atom>,
    pub(super) all: Vec<Case>,
    visited: Vec<bool>,
}

impl Case {
    /// Nodes that were come to.
    pub(super) fn visited(&self) -> &[bool] {
        &self.visited
    }
}

impl<'a> Cases<'a> {
    /// Ticks every case.
    pub(super) fn of(tree: &'a Tree) -> Self {
        let atoms = atoms(tree);
        let mut cases = Self { tree, atoms, all: Vec::new(), visited: vec![false; tree.nodes.len()] };
        cases.all = truths(tree, &cases.atoms).into_iter().map(|truth| cases.ticked(truth)).collect();
        cases.keep_reachable();
        for case in &cases.all {
            for (seen, now) in cases.visited.iter_mut().zip(&case.visited) {
                *seen |= now;
            }
        }
        cases
    }

    /// Leaves out the cases in which a latch holds that no case sets, or a timer has run out that no
    /// case counts; over and over, since one may hang on the other.
    fn keep_reachable(&mut self) {
        let mut allowed: Vec<bool> = self.atoms.iter().map(|atom| !atom.is_memory()).collect();
        let is_allowed =
            |case: &Case, allowed: &[bool]| case.truth.iter().zip(allowed).all(|(holds, may)| !holds || *may);
        loop {
            let before = allowed.clone();
            for case in self.all.iter().filter(|case| is_allowed(case, &before)) {
                for (may, reached) in allowed.iter_mut().zip(&case.reached) {
                    *may |= reached;
                }
            }
            if allowed == before {
                break;
            }
        }
        self.all.retain(|case| is_allowed(case, &allowed));
    }

    /// Ticks one case.
    pub(super) fn ticked(&self, truth: Vec<bool>) -> Case {
        let tree = self.tree;
        let mut state = tree.start();
        for (atom, holds) in self.atoms.iter().zip(&truth) {
            match atom {
                Atom::Timer(node, _) if *holds => tree.set_word(&mut state, *node, u64::MAX / 2),
                Atom::Memory(node) if *holds => tree.set_word(&mut state, *node, memory(Status::Success)),
                Atom::Timer(..) | Atom::Memory(_) | Atom::World(_) | Atom::GoalHere | Atom::Answer(_) => {}
            }
        }
        let most = LEAST_STEPS.max(4 * tree.nodes.len());
        let ticks = if keeps_places(tree) { MEMORY_TICKS } else { 1 };
        let mut case = Case {
            truth,
            acts: Vec::new(),
            gestures: Vec::new(),
            goals: Vec::new(),
            visited: vec![false; tree.nodes.len()],
            reached: Vec::new(),
        };
        for _ in 0..ticks {
            let mut world = CaseWorld {
                atoms: &self.atoms,
                truth: &case.truth,
                acts: Vec::new(),
                gestures: Vec::new(),
                goal_taken: false,
            };
            tree.tick_at_most(&mut state, &mut world, most);
            let CaseWorld { acts, gestures, goal_taken, .. } = world;
            case.acts.push(acts);
            case.gestures.push(gestures);
            case.goals.push(goal_taken);
            for (seen, now) in case.visited.iter_mut().zip(state.visited()) {
                *seen |= now;
            }
        }
        let was = |node: &usize| case.visited.get(*node).copied().unwrap_or(false);
        let is_set = |node: &usize| remembered(tree.word(&state, *node)) == Some(Status::Success);
        case.reached = self
            .atoms
            .iter()
            .map(|atom| match atom {
                Atom::Timer(node, _) => was(node),
                Atom::Memory(node) => is_set(node),
                Atom::World(_) | Atom::GoalHere | Atom::Answer(_) => false,
            })
            .collect();
        case
    }

    /// A case and what follows from it while the world stays as it is: timers that count run out, latches that are
    /// set hold.
    pub(super) fn future(&self, case: &Case) -> Vec<Case> {
        let mut future = vec![case.clone()];
        while let Some(last) = future.last() {
            let next: Vec<bool> =
                last.truth.iter().zip(&last.reached).map(|(holds, reached)| *holds || *reached).collect();
            if next == last.truth {
                break;
            }
            future.push(self.ticked(next));
        }
        future
    }

    /// What a case remembers before it is ticked: one truth for each atom, false for those of the world.
    pub(super) fn memory_at_start(&self, case: &Case) -> Vec<bool> {
        let is_memory = |atom: &Atom| matches!(atom, Atom::Memory(_));
        self.atoms.iter().zip(&case.truth).map(|(atom, holds)| is_memory(atom) && *holds).collect()
    }

    /// What a case remembers after it was ticked.
    pub(super) fn memory_at_end(&self, case: &Case) -> Vec<bool> {
        let is_memory = |atom: &Atom| matches!(atom, Atom::Memory(_));
        let now = self.memory_at_start(case);
        let atoms = self.atoms.iter().zip(&case.reached).zip(now);
        atoms.map(|((atom, reached), now)| now || (is_memory(atom) && *reached)).collect()
    }

    /// The truths of a case in words, those that hold; `otherwise` where none does.
    pub(super) fn words(&self, case: &Case) -> String {
        let holding: Vec<String> = self
            .atoms
            .iter()
            .zip(&case.truth)
            .filter(|(_, holds)| **holds)
            .map(|(atom, _)| atom.phrase(self.tree, true))
            .collect();
        if holding.is_empty() { "when nothing holds".to_owned() } else { holding.join(", ") }
    }

    /// The simplest case (fewest truths) in which some tick is as asked.
    pub(super) fn simplest(&self, is: impl Fn(&Case, usize) -> bool) -> Option<(&Case, usize)> {
        self.all
            .iter()
            .filter_map(|case| (0..case.acts.len()).find(|tick| is(case, *tick)).map(|tick| (case, tick)))
            .min_by_key(|(case, _)| case.truth.iter().filter(|holds| **holds).count())
    }

    /// `B-DEAD`, `B-MOVE2`, `B-STILL`, `B-LATCH`, `B-NAV`.
    pub(super) fn check(&self, ctx: &CheckContext<'_>) -> Vec<Fault> {
        let mut faults = Vec::new();
        let at = Where::agent(ctx.human);
        self.dead(ctx.rules.iter().any(is_endless), &|node| place(ctx, node), &mut faults);
        let foreign = has_foreign(self.tree);
        let acts = |case: &Case, tick: usize| case.acts.get(tick).cloned().unwrap_or_default();
        if let Some((case, tick)) = self.simplest(|case, tick| acts(case, tick).len() > 1) {
            let done: Vec<String> = acts(case, tick).iter().map(|(action, _)| action.they()).collect();
            let message =
                format!("two motions in one tick, {}: {}; allowed: one", self.words(case), done.join(" and "));
            faults.push(Fault::new(FaultCode::BMove2, &at, message));
        }
        let is_still = |case: &Case, tick: usize| acts(case, tick).is_empty() && case.goals.get(tick) == Some(&false);
        if !foreign && let Some((case, _)) = self.simplest(is_still) {
            let message = format!(
                "no motion runs, {}: they would freeze; end with the block of regular navigation, or say StandStill if that is meant",
                self.words(case)
            );
            faults.push(Fault::new(FaultCode::BStill, &at, message));
        }
        self.latched(&at, &mut faults);
        let walks = self.simplest(|case, tick| acts(case, tick).iter().any(|(action, _)| *action == Action::Navigate));
        if walks.is_none() && !foreign && !ctx.rules.iter().any(is_endless) {
            let message = "regular navigation never runs; the last child of the outermost Fallback must be: \
                <Sequence name='walk'> <SetBlackboard output_key='agentid' value='{id}'/> \
                <SetBlackboard output_key='timestep' value='{dt}'/> \
                <SubTree ID='RegularNavTree' id='agentid' dt='timestep'/> </Sequence>, \
                with <include path='BTRegularNav.xml'/> under root";
            faults.push(Fault::new(FaultCode::BNav, &at, message));
        }
        faults
    }

    /// A gesture that is made in some case, not made in another, and taken back in none.
    fn latched(&self, at: &Where, faults: &mut Vec<Fault>) {
        let calls = || self.all.iter().flat_map(|case| case.gestures.iter());
        let made: Option<Gesture> = calls().flatten().copied().flatten().next();
        let taken_back = calls().any(|tick| tick.last() == Some(&None));
        let absent = calls().any(|tick| tick.iter().all(Option::is_none));
        if let (Some(gesture), false, true) = (made, taken_back, absent) {
            let message = format!(
                "{gesture} is never taken back; put MakeGesture message='0' into every branch that does not make it"
            );
            faults.push(Fault::new(FaultCode::BLatch, at, message));
        }
    }

    /// The topmost nodes that no case ever comes to.
    pub(super) fn dead(&self, endless: bool, place: &dyn Fn(&Node) -> Where, faults: &mut Vec<Fault>) {
        let nodes = &self.tree.nodes;
        let seen = |node: usize| self.visited.get(node).copied().unwrap_or(true);
        for (index, node) in nodes.iter().enumerate() {
            let Some(parent) = node.parent else { continue };
            // A tree that is used twice is dead only where every use is.
            if seen(index) || !seen(parent) || (endless && self.is_the_walk(index)) {
                continue;
            }
            let same = |other: usize| nodes.get(other).is_some_and(|it| it.site == node.site);
            if (0..nodes.len()).any(|other| same(other) && seen(other)) {
                continue;
            }
            let siblings = nodes.get(parent).map_or(&[][..], |it| it.children.as_slice());
            let before = siblings.iter().take_while(|sibling| **sibling != index).last();
            let why = before.and_then(|before| nodes.get(*before)).map_or_else(
                || "its parent never comes to it".to_owned(),
                |before| format!("the sibling `{}` before it always ends first", before.name),
            );
            let hint = if node.sheet.tag == "UpdateGoal" {
                "; outside RegularNavTree ask IsPathDone, not IsGoalReached, or they stop at their first goal"
            } else {
                ""
            };
            let message = format!("`{}` can never run: {why}{hint}", node.name);
            faults.push(Fault::new(FaultCode::BDead, place(node), message));
        }
    }

    /// Whether a node is the last branch and does nothing but regular navigation: beside an endless rule
    /// it is never needed.
    fn is_the_walk(&self, node: usize) -> bool {
        self.tree.nodes.first().is_some_and(|root| root.children.last() == Some(&node)) && self.only_walks(node)
    }

    fn only_walks(&self, node: usize) -> bool {
        let leaves = below(self.tree, node).into_iter().filter_map(|place| self.tree.nodes.get(place));
        let mut walks = false;
        for leaf in leaves {
            match leaf.sheet.role {
                Role::Moves(means) if means(&self.tree.ports(leaf)) == Some(Action::Navigate) => walks = true,
                Role::Moves(_) | Role::World | Role::Foreign => return false,
                Role::Flow | Role::Asks(_) | Role::Timer | Role::Says | Role::Quiet => {}
            }
        }
        walks
    }
}

/// Whether a later tick may go another way than the first one in the same case.
fn keeps_places(tree: &Tree) -> bool {
    tree.nodes.iter().any(|node| {
        matches!(
            node.sheet.tag,
            "SequenceWithMemory"
                | "Repeat"
                | "RetryUntilSuccessful"
                | "KeepRunningUntilFailure"
                | "RunOnce"
                | "Parallel"
                | "AsyncSequence"
                | "AsyncFallback"
                | "Precondition"
                | "Delay"
                | "Timeout"
                | "Sleep"
        ) || node.sheet.role.is_opaque()
    })
}
