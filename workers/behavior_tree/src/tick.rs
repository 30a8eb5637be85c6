//! Ticking: the rules that hold for every kind of node. What a kind does is in [`crate::nodes`].

use crate::blackboard::{Ports, Value};
use crate::leaf::LeafCall;
use crate::script::Script;
use crate::sheet::Kind;
use crate::status::Status;
use crate::tree::{Cell, Format, Node, Tree, TreeState};
use crate::world::World;

/// Most nodes ticked in one tick of a tree. Nested repetitions could otherwise keep it for ever;
/// what is left over goes on in the next tick.
const MAX_STEPS: usize = 16_384;

/// One tick of one tree.
pub(crate) struct Ticker<'a> {
    pub(crate) tree: &'a Tree,
    pub(crate) state: &'a mut TreeState,
    pub(crate) world: &'a mut dyn World,
    pub(crate) steps: usize,
}

impl Ticker<'_> {
    /// Ticks the root; a finished root is put back, so that it starts anew next time.
    pub(crate) fn root(&mut self) -> Status {
        self.state.ticks += 1;
        let outcome = self.tick(0);
        if outcome.is_finished() {
            self.set(0, Status::Idle);
        }
        outcome
    }

    /// Ticks a node with its attributes, and keeps its status.
    pub(crate) fn tick(&mut self, node: usize) -> Status {
        let tree = self.tree;
        let Some(it) = tree.nodes.get(node) else { return Status::Failure };
        self.steps += 1;
        if self.steps > MAX_STEPS {
            return Status::Running;
        }
        let ticks = self.state.ticks;
        let outcome = match self.decided_before(node, it) {
            Some(outcome) => outcome,
            None => {
                self.cell(node).seen = ticks;
                match self.asked(node, it) {
                    Some(outcome) => outcome,
                    None => (it.sheet.tick)(self, node),
                }
            }
        };
        if outcome.is_finished()
            && let Some(guards) = &it.guards
        {
            let first = if outcome == Status::Success { &guards.on_success } else { &guards.on_failure };
            self.run(first.as_ref());
            self.run(guards.post.as_ref());
        }
        if outcome != Status::Skipped {
            self.set(node, outcome);
        }
        if it.sheet.kind == Kind::Decorator
            && let Some(child) = self.child(node, 0)
            && self.status(child).is_finished()
        {
            self.set(child, Status::Idle);
        }
        outcome
    }

    /// What the world makes of a leaf, if it does.
    fn asked(&mut self, node: usize, it: &Node) -> Option<Status> {
        if !it.asks_world {
            return None;
        }
        let running = self.status(node) == Status::Running;
        self.world.leaf(&mut leaf_call(it, running, &mut self.state.board))
    }

    /// What the pre-conditions of a node decide, if they do.
    fn decided_before(&mut self, node: usize, it: &Node) -> Option<Status> {
        let guards = it.guards.as_ref()?;
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
        let Some(it) = tree.nodes.get(node) else { return };
        if it.asks_world {
            self.world.leaf_halted(&mut leaf_call(it, true, &mut self.state.board));
        }
        (it.sheet.halt)(self, node);
        if let Some(guards) = &it.guards {
            self.run(guards.on_halted.as_ref());
        }
    }

    /// Puts a child back: halts it where it runs.
    pub(crate) fn reset(&mut self, child: usize) {
        if self.status(child) == Status::Running {
            self.halt(child);
        }
        self.set(child, Status::Idle);
    }

    /// Puts all children back, in order.
    pub(crate) fn reset_children(&mut self, node: usize) {
        self.reset_children_from(node, 0, None);
    }

    /// Puts the children from `first` on back, in order, all but `spared`.
    pub(crate) fn reset_children_from(&mut self, node: usize, first: usize, spared: Option<usize>) {
        for place in first..self.children(node) {
            if Some(place) != spared
                && let Some(child) = self.child(node, place)
            {
                self.reset(child);
            }
        }
    }

    /// Number of children.
    pub(crate) fn children(&self, node: usize) -> usize {
        self.tree.nodes.get(node).map_or(0, |it| it.children.len())
    }

    /// The child at a place.
    pub(crate) fn child(&self, node: usize, place: usize) -> Option<usize> {
        self.tree.nodes.get(node)?.children.get(place).copied()
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
        self.state.cells.get(node).map_or(Status::Idle, |cell| cell.status)
    }

    /// Sets the status of a node.
    pub(crate) fn set(&mut self, node: usize, status: Status) {
        self.cell(node).status = status;
    }

    /// Memory of a node.
    pub(crate) fn cell(&mut self, node: usize) -> &mut Cell {
        match self.state.cells.get_mut(node) {
            Some(cell) => cell,
            None => &mut self.state.spare,
        }
    }

    /// Ports of a node.
    pub(crate) fn ports(&self, node: usize) -> Ports<'_> {
        let inputs = self.tree.nodes.get(node).map_or(&[][..], |it| it.inputs.as_slice());
        Ports { inputs, board: &self.state.board }
    }

    /// Number of the leaf, from 1; 0 for no leaf.
    pub(crate) fn leaf(&self, node: usize) -> u16 {
        self.tree.nodes.get(node).map_or(0, |it| it.leaf)
    }

    /// Whether the rules of version 4 hold.
    pub(crate) fn is_v4(&self) -> bool {
        self.tree.format == Format::V4
    }
}

fn leaf_call<'a>(it: &'a Node, running: bool, board: &'a mut [Option<Value>]) -> LeafCall<'a> {
    LeafCall { sheet: it.sheet, leaf: it.leaf, running, inputs: &it.inputs, board }
}
