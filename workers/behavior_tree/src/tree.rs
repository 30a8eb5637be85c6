//! The tree as flat arrays, shared by all agents, and the state of one agent in it.

use std::collections::BTreeMap;
use std::sync::Arc;

use socrates_model::{Action, AgentId, Fault, Gesture, Trigger};

use crate::blackboard::{Input, Ports, Value};
use crate::parse::{Document, Options};
use crate::script::Script;
use crate::sheet::{HaltFn, Library, NodeSheet, Role, TickFn};
use crate::status::Status;
use crate::tick::{MAX_STEPS, Ticker};
use crate::world::World;
use crate::xml::Site;

/// Version of BehaviorTree.CPP whose rules and spelling a document follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub enum Format {
    /// Version 3.8: no format attribute, un-braced remaps, loops inside a tick.
    #[default]
    V3,
    /// Version 4: `BTCPP_format="4"`, braced remaps, `SKIPPED`, pre- and post-conditions.
    V4,
}

impl Format {
    /// Name in messages and on the command line: `v3` or `v4`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::V3 => "v3",
            Self::V4 => "v4",
        }
    }
}

/// Attributes of version 4 that decide before, or run after, a node.
#[derive(Debug, Clone, Default)]
pub(crate) struct Guards {
    pub(crate) failure_if: Option<Script>,
    pub(crate) success_if: Option<Script>,
    pub(crate) skip_if: Option<Script>,
    pub(crate) hold_while: Option<Script>,
    pub(crate) on_success: Option<Script>,
    pub(crate) on_failure: Option<Script>,
    pub(crate) on_halted: Option<Script>,
    pub(crate) post: Option<Script>,
}

/// One node.
#[derive(Debug, Clone)]
pub(crate) struct Node {
    pub(crate) sheet: &'static NodeSheet,
    /// Tag as the document spells it.
    pub(crate) tag: String,
    pub(crate) name: String,
    pub(crate) inputs: Vec<Input>,
    pub(crate) children: Vec<usize>,
    pub(crate) parent: Option<usize>,
    pub(crate) leaf: u16,
    pub(crate) guards: Option<Box<Guards>>,
    /// For a `Script` node its code, for `SetBlackboard` nothing.
    pub(crate) script: Option<Script>,
    /// Attributes as written, the name left out; for drawings.
    pub(crate) attrs: Vec<(String, String)>,
    pub(crate) site: Site,
}

impl Node {
    /// The tag, of a foreign leaf as the document spells it.
    pub(crate) fn document_tag(&self) -> &str {
        if self.sheet.role.is_cataloged() { self.sheet.tag } else { &self.tag }
    }
}

/// What a tick needs of a node; a row of the flat array that all agents share.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Step {
    pub(crate) sheet: &'static NodeSheet,
    pub(crate) tick: TickFn,
    pub(crate) halt: HaltFn,
    /// Place of the first child in [`Tree::kids`].
    pub(crate) first_kid: u32,
    pub(crate) n_kids: u32,
    /// Place of the first port in [`Tree::inputs`].
    pub(crate) first_input: u32,
    pub(crate) n_inputs: u32,
    /// Place of the node's first word in [`TreeState::words`].
    pub(crate) word: u32,
    /// Number of the leaf, 0 for no leaf.
    pub(crate) leaf: u16,
    /// Whether [`World::leaf`] is asked first.
    pub(crate) asks_world: bool,
    pub(crate) is_guarded: bool,
    pub(crate) is_decorator: bool,
}

/// A behavior tree; immutable, and shared by its clones. Node 0 is the root, the others follow in pre-order.
#[derive(Debug, Clone)]
pub struct Tree {
    pub(crate) nodes: Arc<[Node]>,
    pub(crate) steps: Arc<[Step]>,
    /// Children of all nodes, one node after the other.
    pub(crate) kids: Arc<[u32]>,
    /// Ports of all nodes, one node after the other.
    pub(crate) inputs: Arc<[Input]>,
    pub(crate) n_words: usize,
    pub(crate) board: Arc<[Option<Value>]>,
    /// Entries of the main tree, by name.
    pub(crate) keys: Arc<BTreeMap<String, usize>>,
    pub(crate) format: Format,
    pub(crate) document: Arc<Document>,
}

/// Memory that every node has.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Cell {
    pub(crate) status: Status,
    /// [`Cell::SEEN`] and [`Cell::DONE`].
    marks: u8,
    /// Child to go on with, or branch that runs (counted from 1).
    pub(crate) place: u16,
}

impl Cell {
    /// The last tick came here.
    pub(crate) const SEEN: u8 = 1;
    /// The parent counts it as finished (children of `Parallel`).
    pub(crate) const DONE: u8 = 2;

    pub(crate) const fn has(self, mark: u8) -> bool {
        self.marks & mark != 0
    }

    pub(crate) const fn mark(&mut self, mark: u8, on: bool) {
        if on {
            self.marks |= mark;
        } else {
            self.marks &= !mark;
        }
    }
}

/// The state of one agent in a tree. Its buffers are made once; no tick makes or grows any. The default is the state
/// of no tree: it only holds the place of one that was taken out.
#[derive(Debug, Clone, Default)]
pub struct TreeState {
    pub(crate) cells: Box<[Cell]>,
    /// Counts, times and remembered outcomes of the few nodes that have them.
    pub(crate) words: Box<[u64]>,
    pub(crate) board: Box<[Option<Value>]>,
    /// First leaf without a native meaning that the world did not tick.
    pub(crate) unanswered: Option<u16>,
}

impl TreeState {
    /// Status of every node, in the order of [`Tree::node_names`].
    #[must_use]
    pub fn statuses(&self) -> Vec<Status> {
        self.cells.iter().map(|cell| cell.status).collect()
    }

    /// The first leaf that failed because neither [`World::leaf`] nor this crate could tick
    /// it. Only in trees read with [`Meaning::World`](crate::Meaning::World).
    #[must_use]
    pub const fn unanswered(&self) -> Option<u16> {
        self.unanswered
    }

    /// Whether the last tick came to a node, in the order of [`Tree::node_names`].
    #[must_use]
    pub fn visited(&self) -> Vec<bool> {
        self.cells.iter().map(|cell| cell.has(Cell::SEEN)).collect()
    }

    /// Status of one node, in the order of [`Tree::node_names`].
    #[must_use]
    pub fn status(&self, node: usize) -> Status {
        self.cells.get(node).map_or(Status::Idle, |cell| cell.status)
    }

    /// Bytes of this agent's state: the struct and its buffers. Texts that leaves or scripts wrote are shared
    /// and not counted.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of::<Self>() + size_of_val(&*self.cells) + size_of_val(&*self.words) + size_of_val(&*self.board)
    }
}

impl Tree {
    /// Reads BehaviorTree.CPP XML, version 3 or 4, with the nodes of the SocRATES fork and our own.
    ///
    /// # Errors
    /// Every fault at once: `B-XML`, `B-MAIN`, `B-NODE`, `B-PORT`, `B-RANGE`, `B-ARITY`, `B-CODE`.
    pub fn parse(xml: &str) -> Result<Self, Vec<Fault>> {
        Self::parse_with(xml, &Options::default())
    }

    /// The same with other includes, node libraries or foreign leaves.
    ///
    /// # Errors
    /// As [`Tree::parse`].
    pub fn parse_with(xml: &str, options: &Options<'_>) -> Result<Self, Vec<Fault>> {
        Document::read(xml, options).and_then(crate::build::build).map_err(|faults| in_file(options.file, faults))
    }

    /// The state of an agent before its first tick.
    #[must_use]
    pub fn start(&self) -> TreeState {
        self.start_with(&BTreeMap::new())
    }

    /// The same with blackboard entries of the main tree set, such as `id`.
    #[must_use]
    pub fn start_with(&self, entries: &BTreeMap<String, String>) -> TreeState {
        let mut board: Box<[Option<Value>]> = self.board.iter().cloned().collect();
        for (key, value) in entries {
            if let Some(entry) = self.keys.get(key).and_then(|slot| board.get_mut(*slot)) {
                *entry = Some(Value::of_text(value));
            }
        }
        TreeState {
            cells: vec![Cell::default(); self.nodes.len()].into(),
            words: vec![0; self.n_words].into(),
            board,
            unanswered: None,
        }
    }

    /// Ticks once.
    pub fn tick(&self, state: &mut TreeState, world: &mut dyn World) -> Status {
        self.tick_at_most(state, world, MAX_STEPS)
    }

    /// The same with another limit of nodes ticked.
    pub(crate) fn tick_at_most(&self, state: &mut TreeState, world: &mut dyn World, left: usize) -> Status {
        Ticker { tree: self, state, world, left }.root()
    }

    /// Version of the document.
    #[must_use]
    pub const fn format(&self) -> Format {
        self.format
    }

    /// The tree as XML in either version; reading it back gives the same tree.
    #[must_use]
    pub fn to_xml(&self, format: Format) -> String {
        crate::write::write(&self.document, format)
    }

    /// Name of every node in pre-order: its `name` attribute, else its tag.
    #[must_use]
    pub fn node_names(&self) -> Vec<&str> {
        self.nodes.iter().map(|node| node.name.as_str()).collect()
    }

    /// Names of the leaves in pre-order. Leaf number `k` of [`World::act`] is entry `k - 1`.
    #[must_use]
    pub fn leaf_names(&self) -> Vec<&str> {
        self.nodes.iter().filter(|node| node.leaf > 0).map(|node| node.name.as_str()).collect()
    }

    /// What the tree asks about the world, in order of first appearance.
    #[must_use]
    pub fn conditions(&self) -> Vec<Trigger> {
        let mut found = Vec::new();
        for node in self.nodes.iter() {
            if let Role::Asks(means) = node.sheet.role
                && let Some(trigger) = means(&self.ports(node))
                && !found.contains(&trigger)
            {
                found.push(trigger);
            }
        }
        found
    }

    /// What the tree can do, in order of first appearance.
    #[must_use]
    pub fn actions(&self) -> Vec<Action> {
        let mut found = Vec::new();
        for node in self.nodes.iter() {
            if let Role::Moves(means) = node.sheet.role
                && let Some(action) = means(&self.ports(node))
                && !found.contains(&action)
            {
                found.push(action);
            }
        }
        found
    }

    /// Gestures the tree makes.
    #[must_use]
    pub fn gestures_made(&self) -> Vec<Gesture> {
        let mut found: Vec<Gesture> = self
            .nodes
            .iter()
            .filter(|node| matches!(node.sheet.role, Role::Says))
            .filter_map(|node| self.ports(node).said(1).flatten())
            .collect();
        found.sort_unstable();
        found.dedup();
        found
    }

    /// Gestures the tree waits for and who would have to make them.
    #[must_use]
    pub fn gestures_awaited(&self) -> Vec<(AgentId, Gesture)> {
        let mut found: Vec<(AgentId, Gesture)> = self.conditions().iter().filter_map(Trigger::awaits).collect();
        found.sort_unstable();
        found.dedup();
        found
    }

    /// Leaves that only [`World::leaf`] can tick, by number (see [`Tree::leaf_names`]).
    #[must_use]
    pub fn world_leaves(&self) -> Vec<u16> {
        self.nodes.iter().filter(|node| !node.sheet.is_native()).map(|node| node.leaf).collect()
    }

    /// Tags used that a simulator with this library could not load.
    #[must_use]
    pub fn foreign_to(&self, library: Library) -> Vec<&'static str> {
        let mut tags: Vec<&'static str> = self
            .nodes
            .iter()
            .map(|node| node.sheet)
            .filter(|sheet| sheet.role.is_cataloged() && !crate::nodes::is_known_to(sheet.tag, library))
            .map(|sheet| sheet.tag)
            .collect();
        tags.sort_unstable();
        tags.dedup();
        tags
    }

    /// Sets the first word of a node: the time of a timer, the outcome a `Latch` or `RunOnce` remembers.
    pub(crate) fn set_word(&self, state: &mut TreeState, node: usize, value: u64) {
        let place = self.steps.get(node).map(|step| step.word as usize);
        if let Some(word) = place.and_then(|place| state.words.get_mut(place)) {
            *word = value;
        }
    }

    /// The first word of a node.
    pub(crate) fn word(&self, state: &TreeState, node: usize) -> u64 {
        self.steps.get(node).and_then(|step| state.words.get(step.word as usize)).copied().unwrap_or(0)
    }

    /// Ports of a node over the blackboard as it is before the first tick.
    pub(crate) fn ports<'a>(&'a self, node: &'a Node) -> Ports<'a> {
        Ports { inputs: &node.inputs, board: &self.board }
    }
}

/// Puts the name of the document before places in it; those in an included file name that one.
fn in_file(file: &str, faults: Vec<Fault>) -> Vec<Fault> {
    let named = |fault: Fault| match fault.at.line {
        Some(_) if !file.is_empty() => Fault { at: fault.at.within(file), ..fault },
        Some(_) | None => fault,
    };
    faults.into_iter().map(named).collect()
}
