//! Ticking: what happens around every kind of node. What a kind does is in [`crate::nodes`].

use crate::blackboard::{Input, Ports, Value};
use crate::leaf::LeafCall;
use crate::script::Script;
use crate::status::Status;
use crate::tree::{Cell, Format, Guards, Step, Tree, TreeState};
use crate::world::World;

/// Most nodes ticked in one tick of a tree. Nested repetitions could otherwise keep it for ever;
/// what is left over goes on in the next tick.
pub(crate) const MAX_STEPS: usize = 16_384;

/// One tick of one tree.
pub(crate) struct Ticker<'a> {
    pub(crate) tree: &'a Tree,
    pub(crate) state: &'a mut TreeState,
    pub(crate) world: &'a mut dyn World,
    /// Nodes that may still be ticked.
    pub(crate) left: usize,
}

impl Ticker<'_> {
    /// Ticks the root; a finished root is put back, so that it starts anew next time.
    pub(crate) fn root(&mut self) -> Status {
        for cell in &mut self.state.cells {
            cell.mark(Cell::SEEN, false);
        }
        let outcome = self.tick(0);
        if outcome.is_finished() {
            self.set(0, Status::Idle);
        }
        outcome
    }

    /// Ticks a node with its attributes, and keeps its status.
    pub(crate) fn tick(&mut self, node: usize) -> Status {
        let tree = self.tree;
        let Some(step) = tree.steps.get(node) else { return Status::Failure };
        if self.left == 0 {
            return Status::Running;
        }
        self.left -= 1;
        let outcome = if step.is_guarded { self.guarded(node, step) } else { self.bare(node, step) };
        if outcome != Status::Skipped {
            self.set(node, outcome);
        }
        if step.is_decorator
            && let Some(child) = self.child(node, 0)
            && self.status(child).is_finished()
        {
            self.set(child, Status::Idle);
        }
        outcome
    }

    /// Ticks a node by the rule of its kind; a leaf by the world's, where it has one.
    #[inline]
    fn bare(&mut self, node: usize, step: &Step) -> Status {
        if let Some(cell) = self.state.cells.get_mut(node) {
            cell.mark(Cell::SEEN, true);
        }
        if step.asks_world { self.leaf_of_world(node, step) } else { (step.tick)(self, node) }
    }

    /// Apart from `bare`, so that control nodes do not pay for its frame.
    #[inline(never)]
    fn leaf_of_world(&mut self, node: usize, step: &Step) -> Status {
        let running = self.status(node) == Status::Running;
        let answer = self.world.leaf(&mut leaf_call(self.tree, step, running, &mut self.state.board));
        match answer {
            // A leaf cannot be idle after a tick, nor leave itself out in version 3.
            Some(Status::Idle) => Status::Failure,
            Some(Status::Skipped) if !self.is_v4() => Status::Failure,
            Some(outcome) => outcome,
            None => (step.tick)(self, node),
        }
    }

    /// The same between the attributes of version 4.
    #[inline(never)]
    fn guarded(&mut self, node: usize, step: &Step) -> Status {
        let tree = self.tree;
        let Some(guards) = tree.nodes.get(node).and_then(|it| it.guards.as_deref()) else {
            return self.bare(node, step);
        };
        let outcome = match self.decided_before(node, guards) {
            Some(outcome) => outcome,
            None => self.bare(node, step),
        };
        if outcome.is_finished() {
            let first = if outcome == Status::Success { &guards.on_success } else { &guards.on_failure };
            self.run(first.as_ref());
            self.run(guards.post.as_ref());
        }
        outcome
    }

    /// What the pre-conditions of a node decide, if they do.
    fn decided_before(&mut self, node: usize, guards: &Guards) -> Option<Status> {
        let status = self.status(node);
        if status == Status::Idle {
            if self.holds(guards.failure_if.as_ref()) {
                return Some(Status::Failure);
            }
            if self.holds(guards.success_if.as_ref()) {
                return Some(Status::Success);
            }
            if self.holds(guards.skip_if.as_ref()) {
                return Some(Status::Skipped);
            }
        }
        if guards.hold_while.is_some() && !self.holds(guards.hold_while.as_ref()) {
            if status == Status::Running {
                self.halt(node);
                return Some(Status::Skipped);
            }
            if status == Status::Idle {
                return Some(Status::Skipped);
            }
        }
        None
    }

    fn holds(&mut self, script: Option<&Script>) -> bool {
        script.and_then(|script| script.run(&mut self.state.board).ok()).is_some_and(|value: Value| value.flag())
    }

    fn run(&mut self, script: Option<&Script>) {
        if let Some(script) = script {
            // A script that cannot be computed changes nothing; the node has finished already.
            drop(script.run(&mut self.state.board));
        }
    }

    /// Halts a node: its kind's own rule, then its `_onHalted`.
    pub(crate) fn halt(&mut self, node: usize) {
        let tree = self.tree;
        let Some(step) = tree.steps.get(node) else { return };
        if step.asks_world {
            self.world.leaf_halted(&mut leaf_call(tree, step, true, &mut self.state.board));
        }
        (step.halt)(self, node);
        if step.is_guarded
            && let Some(guards) = tree.nodes.get(node).and_then(|it| it.guards.as_deref())
        {
            self.run(guards.on_halted.as_ref());
        }
    }

    /// Puts a child back: halts it where it runs.
    pub(crate) fn reset(&mut self, child: usize) {
        match self.state.cells.get_mut(child) {
            Some(cell) if cell.status == Status::Running => {
                self.halt(child);
                self.set(child, Status::Idle);
            }
            Some(cell) => cell.status = Status::Idle,
            None => {}
        }
    }

    /// Puts all children back, in order.
    pub(crate) fn reset_children(&mut self, node: usize) {
        for child in self.kids(node) {
            self.reset(*child as usize);
        }
    }

    /// Puts the children from `first` on back, in order, all but `spared`.
    pub(crate) fn reset_children_from(&mut self, node: usize, first: usize, spared: Option<usize>) {
        for (place, child) in self.kids(node).iter().enumerate().skip(first) {
            if Some(place) != spared {
                self.reset(*child as usize);
            }
        }
    }

    /// Children of a node.
    pub(crate) fn kids<'t>(&self, node: usize) -> &'t [u32]
    where
        Self: 't,
    {
        let tree: &'t Tree = self.tree;
        let Some(step) = tree.steps.get(node) else { return &[] };
        let first = step.first_kid as usize;
        tree.kids.get(first..first + step.n_kids as usize).unwrap_or(&[])
    }

    /// Number of children.
    pub(crate) fn children(&self, node: usize) -> usize {
        self.tree.steps.get(node).map_or(0, |step| step.n_kids as usize)
    }

    /// The child at a place.
    pub(crate) fn child(&self, node: usize, place: usize) -> Option<usize> {
        self.kids(node).get(place).map(|child| *child as usize)
    }

    /// Ticks the child at a place; a place without a child fails.
    pub(crate) fn tick_child(&mut self, node: usize, place: usize) -> Status {
        self.child(node, place).map_or(Status::Failure, |child| self.tick(child))
    }

    /// Status of the child at a place.
    pub(crate) fn child_status(&self, node: usize, place: usize) -> Status {
        self.child(node, place).map_or(Status::Idle, |child| self.status(child))
    }

    /// Puts the child at a place back.
    pub(crate) fn reset_child(&mut self, node: usize, place: usize) {
        if let Some(child) = self.child(node, place) {
            self.reset(child);
        }
    }

    /// Status of a node.
    pub(crate) fn status(&self, node: usize) -> Status {
        self.state.status(node)
    }

    /// Sets the status of a node.
    pub(crate) fn set(&mut self, node: usize, status: Status) {
        if let Some(cell) = self.state.cells.get_mut(node) {
            cell.status = status;
        }
    }

    /// The child a node goes on with, or the branch that runs, counted from 1.
    pub(crate) fn place(&self, node: usize) -> usize {
        self.state.cells.get(node).map_or(0, |cell| usize::from(cell.place))
    }

    /// Sets the place of a node. Places fit: a tree has at most 4096 nodes.
    pub(crate) fn set_place(&mut self, node: usize, place: usize) {
        if let Some(cell) = self.state.cells.get_mut(node) {
            cell.place = u16::try_from(place).unwrap_or(u16::MAX);
        }
    }

    /// Whether the parent of a node counts it as finished.
    pub(crate) fn is_done(&self, node: usize) -> bool {
        self.state.cells.get(node).is_some_and(|cell| cell.has(Cell::DONE))
    }

    /// Says whether the parent of a node counts it as finished.
    pub(crate) fn set_done(&mut self, node: usize, done: bool) {
        if let Some(cell) = self.state.cells.get_mut(node) {
            cell.mark(Cell::DONE, done);
        }
    }

    /// Word `k` of a node; 0 where it has none.
    pub(crate) fn word(&self, node: usize, k: usize) -> u64 {
        let place = self.tree.steps.get(node).map(|step| step.word as usize + k);
        place.and_then(|place| self.state.words.get(place)).copied().unwrap_or(0)
    }

    /// Sets word `k` of a node. The caller's kind must have it (see `words` in `build.rs`).
    pub(crate) fn set_word(&mut self, node: usize, k: usize, value: u64) {
        let place = self.tree.steps.get(node).map(|step| step.word as usize + k);
        if let Some(word) = place.and_then(|place| self.state.words.get_mut(place)) {
            *word = value;
        }
    }

    /// Ports of a node.
    pub(crate) fn ports(&self, node: usize) -> Ports<'_> {
        let inputs = self.tree.steps.get(node).map_or(&[][..], |step| inputs(self.tree, step));
        Ports { inputs, board: &self.state.board }
    }

    /// Number of the leaf, from 1; 0 for no leaf.
    pub(crate) fn leaf(&self, node: usize) -> u16 {
        self.tree.steps.get(node).map_or(0, |step| step.leaf)
    }

    /// Whether the rules of version 4 hold.
    pub(crate) fn is_v4(&self) -> bool {
        self.tree.format == Format::V4
    }
}

fn inputs<'a>(tree: &'a Tree, step: &Step) -> &'a [Input] {
    let first = step.first_input as usize;
    tree.inputs.get(first..first + step.n_inputs as usize).unwrap_or(&[])
}

fn leaf_call<'a>(tree: &'a Tree, step: &Step, running: bool, board: &'a mut [Option<Value>]) -> LeafCall<'a> {
    LeafCall { sheet: step.sheet, leaf: step.leaf, running, inputs: inputs(tree, step), board }
}
