//! The tree as flat arrays, shared by all agents, and the state of one agent in it.

use std::collections::BTreeMap;

use socrates_model::{Action, AgentId, Fault, Gesture, HumanId, Trigger};

use crate::blackboard::{Input, Ports, Value};
use crate::parse::{Document, Options};
use crate::script::Script;
use crate::sheet::{Library, NodeSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;
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
    pub(crate) name: String,
    pub(crate) inputs: Vec<Input>,
    pub(crate) children: Vec<usize>,
    pub(crate) parent: Option<usize>,
    pub(crate) leaf: u16,
    /// Whether [`World::leaf`] is asked first.
    pub(crate) asks_world: bool,
    pub(crate) guards: Option<Box<Guards>>,
    /// For a `Script` node its code, for `SetBlackboard` nothing.
    pub(crate) script: Option<Script>,
    pub(crate) site: Site,
}

/// A behavior tree; immutable and shared. Node 0 is the root, the others follow in pre-order.
#[derive(Debug, Clone)]
pub struct Tree {
    pub(crate) nodes: Vec<Node>,
    pub(crate) board: Vec<Option<Value>>,
    /// Entries of the main tree, by name.
    pub(crate) keys: BTreeMap<String, usize>,
    pub(crate) format: Format,
    pub(crate) document: Document,
}

/// Memory of one node.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Cell {
    pub(crate) status: Status,
    /// Child to go on with, or branch that runs (counted from 1).
    pub(crate) index: usize,
    /// Repetitions, attempts, or successes.
    pub(crate) count: usize,
    /// Failures, or children left out.
    pub(crate) tally: usize,
    /// Whether the parent counts it as finished (children of `Parallel`), or it did its one run.
    pub(crate) done: bool,
    /// Outcome that is remembered.
    pub(crate) outcome: Status,
    /// Time counted, ns.
    pub(crate) nanos: u64,
    /// Number of the last tick that came here.
    pub(crate) seen: u64,
}

/// The state of one agent in a tree.
#[derive(Debug, Clone)]
pub struct TreeState {
    pub(crate) cells: Vec<Cell>,
    pub(crate) board: Vec<Option<Value>>,
    pub(crate) ticks: u64,
    /// First leaf without a native meaning that the world did not tick.
    pub(crate) unanswered: Option<u16>,
    pub(crate) spare: Cell,
}

impl TreeState {
    /// Status of every node, in the order of [`Tree::node_names`].
    #[must_use]
    pub fn statuses(&self) -> Vec<Status> {
        self.cells.iter().map(|cell| cell.status).collect()
    }

    /// The first leaf that failed because neither [`World::leaf`](crate::World::leaf) nor this crate could tick
    /// it. Only in trees read with [`Meaning::World`](crate::Meaning::World).
    #[must_use]
    pub const fn unanswered(&self) -> Option<u16> {
        self.unanswered
    }

    /// Whether the last tick came to a node, in the order of [`Tree::node_names`].
    #[must_use]
    pub fn visited(&self) -> Vec<bool> {
        self.cells.iter().map(|cell| self.ticks > 0 && cell.seen == self.ticks).collect()
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
        let document = Document::read(xml, options)?;
        crate::build::build(document)
    }

    /// The state of an agent before its first tick.
    #[must_use]
    pub fn start(&self) -> TreeState {
        self.start_with(&BTreeMap::new())
    }

    /// The same with blackboard entries of the main tree set, such as `id`.
    #[must_use]
    pub fn start_with(&self, entries: &BTreeMap<String, String>) -> TreeState {
        let mut board = self.board.clone();
        for (key, value) in entries {
            if let Some(entry) = self.keys.get(key).and_then(|slot| board.get_mut(*slot)) {
                *entry = Some(Value::Text(value.clone()));
            }
        }
        TreeState {
            cells: vec![Cell::default(); self.nodes.len()],
            board,
            ticks: 0,
            unanswered: None,
            spare: Cell::default(),
        }
    }

    /// Ticks once.
    pub fn tick(&self, state: &mut TreeState, world: &mut dyn World) -> Status {
        Ticker { tree: self, state, world, steps: 0 }.root()
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
        for node in &self.nodes {
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
        for node in &self.nodes {
            if let Role::Moves(means) = node.sheet.role
                && let Some(action) = means(&self.ports(node))
                && !found.contains(&action)
            {
                found.push(action);
            }
        }
        found
    }

    /// Gestures the tree makes, [`Gesture::None`] left out.
    #[must_use]
    pub fn gestures_made(&self) -> Vec<Gesture> {
        let mut found: Vec<Gesture> = self
            .nodes
            .iter()
            .filter(|node| matches!(node.sheet.role, Role::Says))
            .filter_map(|node| self.ports(node).gesture(1))
            .filter(|gesture| *gesture != Gesture::None)
            .collect();
        found.sort_unstable();
        found.dedup();
        found
    }

    /// Gestures the tree waits for and who would have to make them, [`Gesture::None`] left out.
    #[must_use]
    pub fn gestures_awaited(&self) -> Vec<(AgentId, Gesture)> {
        let mut found: Vec<(AgentId, Gesture)> = self.conditions().iter().filter_map(awaited).collect();
        found.sort_unstable();
        found.dedup();
        found
    }

    /// Leaves that only [`World::leaf`](crate::World::leaf) can tick, by number (see [`Tree::leaf_names`]).
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
            .filter(|sheet| sheet.role.is_catalogued() && !crate::nodes::is_known_to(sheet.tag, library))
            .map(|sheet| sheet.tag)
            .collect();
        tags.sort_unstable();
        tags.dedup();
        tags
    }

    /// Ports of a node over the blackboard as it is before the first tick.
    pub(crate) fn ports<'a>(&'a self, node: &'a Node) -> Ports<'a> {
        Ports { inputs: &node.inputs, board: &self.board }
    }
}

fn awaited(trigger: &Trigger) -> Option<(AgentId, Gesture)> {
    let (agent, gesture) = match trigger {
        Trigger::RobotSays(gesture) => (AgentId::Robot, *gesture),
        Trigger::HumanSays(id, gesture) => (AgentId::Human(HumanId::new(id.number())), *gesture),
        Trigger::Always
        | Trigger::RobotVisible(_)
        | Trigger::RobotNear(_)
        | Trigger::RobotBlocking(_)
        | Trigger::RobotMoving
        | Trigger::RobotStopped
        | Trigger::GoalReached
        | Trigger::AtEncounter
        | Trigger::AfterSecs(_) => return None,
    };
    (gesture != Gesture::None).then_some((agent, gesture))
}
