//! A tree run with scripted leaves, and what every node did: the oracle format for comparing interpreters.
//!
//! A script is `{"ticks": [{"leaf": "SUCCESS", …}, …]}`: before tick `t` the outcomes of entry `t` are set; a leaf
//! that is not named keeps its last outcome, and the first one is SUCCESS. Leaves are `ScriptAction` (any outcome)
//! and `ScriptCond` (SUCCESS or FAILURE); they are found by their `name`, and a leaf ticked in a second copy of a
//! subtree shares the outcome of the first.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::Value;
use socrates_model::{Action, Fault, FaultCode, Gesture, HumanId, SimTime, Where};

use crate::parse::{Includes, Options};
use crate::sheet::Kind;
use crate::status::Status;
use crate::tree::Tree;
use crate::world::World;
use crate::xml::Element;

/// Leaves of a script.
const SCRIPTED: &[(&str, Kind)] = &[("ScriptAction", Kind::Action), ("ScriptCond", Kind::Condition)];

/// What happened, as two CSV texts with a header line each.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Trace {
    /// `tick,name,status`: every node after every tick, in pre-order.
    pub trace_csv: String,
    /// `tick,event,name,status`: leaf ticks (`TICK`), leaf halts (`HALT`, without a status) and what the root gave
    /// (`RETURN`), in order of occurrence.
    pub events_csv: String,
}

/// Runs a tree with scripted leaves, once per entry of the script.
///
/// # Errors
/// Every fault of the tree (see [`Tree::parse`]), or every fault of the script: `E-JSON` and `E-SCHEMA`.
pub fn trace(xml: &str, includes: Option<Includes<'_>>, script: &str) -> Result<Trace, Vec<Fault>> {
    let options = Options { includes, foreign: SCRIPTED, ..Options::default() };
    let tree = Tree::parse_with(xml, &options)?;
    let ticks = read(script, &tree)?;
    let names = numbered(&tree.node_names());
    let leaves = tree.leaf_names().into_iter().map(str::to_owned).collect();
    let mut world = Scripted {
        leaves,
        labels: leaf_labels(&tree, &names),
        outcomes: BTreeMap::new(),
        events: String::new(),
        tick: 0,
    };
    world.events.push_str("tick,event,name,status\n");
    let mut trace_csv = "tick,name,status\n".to_owned();
    let root = names.first().map_or("", String::as_str);
    let mut state = tree.start();
    for (tick, outcomes) in ticks.into_iter().enumerate() {
        world.tick = tick;
        world.outcomes.extend(outcomes);
        let outcome = tree.tick(&mut state, &mut world);
        world.event("RETURN", root, outcome.name());
        for (name, status) in names.iter().zip(state.statuses()) {
            row(&mut trace_csv, format_args!("{tick},{name},{status}"));
        }
    }
    Ok(Trace { trace_csv, events_csv: world.events })
}

fn row(text: &mut String, line: std::fmt::Arguments<'_>) {
    text.push_str(&line.to_string());
    text.push('\n');
}

/// The outcomes set before each tick; every fault at once.
fn read(script: &str, tree: &Tree) -> Result<Vec<BTreeMap<String, Status>>, Vec<Fault>> {
    let syntax = |message: String| vec![Fault::new(FaultCode::EJson, "script", message)];
    let script: Value = serde_json::from_str(script.trim_start_matches('\u{feff}'))
        .map_err(|why| syntax(format!("not JSON: {why}; expected {{\"ticks\":[{{\"leaf\":\"SUCCESS\"}}]}}")))?;
    let mut faults = Vec::new();
    let mut fault = |at: String, message: String| faults.push(Fault::new(FaultCode::ESchema, Where::key(at), message));
    if let Some(top) = script.as_object() {
        for key in top.keys().filter(|key| *key != "ticks") {
            fault("script".to_owned(), format!("unknown field `{key}`; allowed: ticks"));
        }
    }
    let conditions = scripted(tree, Kind::Condition);
    let actions = scripted(tree, Kind::Action);
    let Some(entries) = script.get("ticks").and_then(Value::as_array) else {
        fault(
            "script".to_owned(),
            "`ticks` is missing or no list; expected a list of objects, one per tick".to_owned(),
        );
        return Err(faults);
    };
    let mut ticks = Vec::with_capacity(entries.len());
    for (tick, entry) in entries.iter().enumerate() {
        let mut outcomes = BTreeMap::new();
        let Some(entry) = entry.as_object() else {
            fault(format!("script tick {tick}"), format!("`{entry}` is no object; expected {{\"leaf\":\"SUCCESS\"}}"));
            continue;
        };
        for (leaf, outcome) in entry {
            let at = || format!("script tick {tick} `{leaf}`");
            let is_condition = conditions.contains(leaf.as_str());
            if !is_condition && !actions.contains(leaf.as_str()) {
                let known: Vec<&str> = conditions.iter().chain(&actions).copied().collect();
                fault(at(), format!("the tree has no scripted leaf of this name; its leaves: {}", known.join(", ")));
                continue;
            }
            match outcome.as_str().and_then(outcome_of) {
                Some(Status::Running) if is_condition => {
                    fault(at(), "`RUNNING` for a ScriptCond; allowed: SUCCESS, FAILURE".to_owned());
                }
                Some(outcome) => drop(outcomes.insert(leaf.clone(), outcome)),
                None => fault(at(), format!("{outcome} is no outcome; allowed: SUCCESS, FAILURE, RUNNING")),
            }
        }
        ticks.push(outcomes);
    }
    if faults.is_empty() { Ok(ticks) } else { Err(faults) }
}

fn outcome_of(text: &str) -> Option<Status> {
    [Status::Success, Status::Failure, Status::Running].into_iter().find(|status| status.name() == text)
}

/// Names of the scripted leaves of a kind, in every tree of the document, also those that nothing uses.
fn scripted(tree: &Tree, kind: Kind) -> BTreeSet<&str> {
    let mut open: Vec<&Element> = tree.document.trees.iter().map(|def| &def.root).collect();
    let mut names = BTreeSet::new();
    while let Some(it) = open.pop() {
        if SCRIPTED.iter().any(|(tag, of)| *tag == it.tag && *of == kind) {
            names.insert(it.attr("name").unwrap_or(&it.tag));
        }
        open.extend(&it.children);
    }
    names
}

/// Later nodes of one name are written `NAME#2`, `NAME#3`, …
fn numbered(names: &[&str]) -> Vec<String> {
    let mut seen: BTreeMap<&str, usize> = BTreeMap::new();
    let mut labels = Vec::with_capacity(names.len());
    for name in names {
        let n = seen.entry(name).or_default();
        *n += 1;
        labels.push(if *n == 1 { (*name).to_owned() } else { format!("{name}#{n}") });
    }
    labels
}

/// Labels of the leaves, in order of their numbers.
fn leaf_labels(tree: &Tree, names: &[String]) -> Vec<String> {
    tree.nodes.iter().zip(names).filter(|(node, _)| node.leaf > 0).map(|(_, name)| name.clone()).collect()
}

/// Leaves whose outcomes are scripted, and what happened to them.
struct Scripted {
    leaves: Vec<String>,
    labels: Vec<String>,
    outcomes: BTreeMap<String, Status>,
    events: String,
    tick: usize,
}

impl Scripted {
    fn label(&self, leaf: u16) -> String {
        self.labels.get(usize::from(leaf).wrapping_sub(1)).cloned().unwrap_or_default()
    }

    fn event(&mut self, event: &str, name: &str, status: &str) {
        let tick = self.tick;
        row(&mut self.events, format_args!("{tick},{event},{name},{status}"));
    }
}

impl World for Scripted {
    fn robot_distance_m(&self) -> Option<f64> {
        None
    }
    fn robot_visible(&self, _within_m: f64) -> bool {
        false
    }
    fn robot_blocking(&self, _within_m: f64) -> bool {
        false
    }
    fn robot_moving(&self) -> bool {
        false
    }
    fn robot_gesture(&self) -> Option<Gesture> {
        None
    }
    fn human_gesture(&self, _id: HumanId) -> Option<Gesture> {
        None
    }
    fn goal_reached(&self) -> bool {
        false
    }
    fn next_goal(&mut self) {}
    fn at_encounter(&self) -> bool {
        false
    }
    fn now(&self) -> SimTime {
        SimTime::at_tick(self.tick as u64)
    }
    fn step_s(&self) -> f64 {
        0.01
    }
    fn act(&mut self, _action: &Action, _leaf: u16) {}
    fn gesture(&mut self, _gesture: Option<Gesture>) {}
    fn foreign(&mut self, leaf: u16) -> Status {
        let name = self.leaves.get(usize::from(leaf).wrapping_sub(1));
        let outcome = name.and_then(|name| self.outcomes.get(name)).copied().unwrap_or(Status::Success);
        self.event("TICK", &self.label(leaf), outcome.name());
        outcome
    }
    fn foreign_halted(&mut self, leaf: u16) {
        self.event("HALT", &self.label(leaf), "");
    }
}
