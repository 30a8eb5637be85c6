//! Tick by tick against recorded runs of BehaviorTree.CPP 3.8 and 4.10.
#![expect(
    clippy::unwrap_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::print_stdout,
    reason = "test code: a wrong file should stop the test, and a skipped test says why"
)]

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;
use socrates_bt::{Kind, Options, Status, Tree, World};
use socrates_model::{Action, Gesture, HumanId, SimTime};

/// Leaves whose outcomes are scripted, and what happened to them.
struct Scripted {
    names: Vec<String>,
    outcomes: BTreeMap<String, Status>,
    events: Vec<String>,
    tick: usize,
}

impl Scripted {
    fn name(&self, leaf: u16) -> String {
        self.names[usize::from(leaf) - 1].clone()
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
    fn robot_gesture(&self) -> Gesture {
        Gesture::None
    }
    fn human_gesture(&self, _id: HumanId) -> Gesture {
        Gesture::None
    }
    fn goal_reached(&self) -> bool {
        false
    }
    fn next_goal(&mut self) {}
    fn at_encounter(&self) -> bool {
        false
    }
    fn now(&self) -> SimTime {
        SimTime::ZERO
    }
    fn step_s(&self) -> f64 {
        0.01
    }
    fn act(&mut self, _action: &Action, _leaf: u16) {}
    fn gesture(&mut self, _gesture: Gesture) {}
    fn foreign(&mut self, leaf: u16) -> Status {
        let name = self.name(leaf);
        let base = name.split('#').next().unwrap().to_owned();
        let outcome = self.outcomes.get(&base).copied().unwrap_or(Status::Success);
        self.events.push(format!("{},TICK,{name},{outcome}", self.tick));
        outcome
    }
    fn foreign_halted(&mut self, leaf: u16) {
        let name = self.name(leaf);
        self.events.push(format!("{},HALT,{name},", self.tick));
    }
}

fn status(text: &str) -> Status {
    match text {
        "SUCCESS" => Status::Success,
        "FAILURE" => Status::Failure,
        "RUNNING" => Status::Running,
        other => panic!("outcome `{other}`"),
    }
}

/// Later nodes of one name are written `NAME#2`, `NAME#3`, …
fn numbered(names: &[&str]) -> Vec<String> {
    let mut seen: BTreeMap<&str, usize> = BTreeMap::new();
    names
        .iter()
        .map(|name| {
            let n = seen.entry(name).or_default();
            *n += 1;
            if *n == 1 { (*name).to_owned() } else { format!("{name}#{n}") }
        })
        .collect()
}

/// The first difference between what happened and what was recorded.
fn difference(case: &Path) -> Option<String> {
    let read = |ending: &str| fs::read_to_string(case.with_extension(ending)).unwrap();
    let options =
        Options { foreign: &[("ScriptAction", Kind::Action), ("ScriptCond", Kind::Condition)], ..Options::default() };
    let tree = match Tree::parse_with(&read("xml"), &options) {
        Ok(tree) => tree,
        Err(faults) => return Some(format!("{faults:?}")),
    };
    // What is written must be what was read: the rest of the test runs on the copy.
    let tree = Tree::parse_with(&tree.to_xml(tree.format()), &options).unwrap();
    let names = numbered(&tree.node_names());
    let script: Value = serde_json::from_str(&read("script.json")).unwrap();
    let mut world = Scripted {
        names: numbered(&tree.leaf_names()),
        outcomes: BTreeMap::new(),
        events: vec!["tick,event,name,status".to_owned()],
        tick: 0,
    };
    let mut state = tree.start();
    let mut trace = vec!["tick,name,status".to_owned()];
    for (tick, entry) in script["ticks"].as_array().unwrap().iter().enumerate() {
        world.tick = tick;
        for (leaf, outcome) in entry.as_object().unwrap() {
            world.outcomes.insert(leaf.clone(), status(outcome.as_str().unwrap()));
        }
        let outcome = tree.tick(&mut state, &mut world);
        world.events.push(format!("{tick},RETURN,{},{outcome}", names[0]));
        for (name, status) in names.iter().zip(state.statuses()) {
            trace.push(format!("{tick},{name},{status}"));
        }
    }
    for (found, wanted) in [(&world.events, read("events.csv")), (&trace, read("trace.csv"))] {
        let wanted: Vec<&str> = wanted.lines().collect();
        for (row, wanted_row) in wanted.iter().enumerate() {
            let found_row = found.get(row).map_or("(end)", String::as_str);
            if found_row != *wanted_row {
                return Some(format!("row {row}: found `{found_row}`, recorded `{wanted_row}`"));
            }
        }
        if found.len() != wanted.len() {
            return Some(format!("{} rows instead of {}", found.len(), wanted.len()));
        }
    }
    None
}

fn every_case_of(version: &str) {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data/bt_reference")).join(version);
    if !folder.is_dir() {
        println!("skipped: no reference data at {}", folder.display());
        return;
    }
    let mut cases: Vec<PathBuf> = fs::read_dir(&folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|ext| ext == "xml"))
        .collect();
    cases.sort();
    let different: Vec<String> = cases
        .iter()
        .filter_map(|case| difference(case).map(|how| format!("{}: {how}", case.file_stem().unwrap().display())))
        .collect();
    println!("{version}: {} of {} cases are equal", cases.len() - different.len(), cases.len());
    assert!(!cases.is_empty(), "no case was found");
    assert!(different.is_empty(), "{}", different.join("\n"));
}

#[test]
fn every_version_3_case_runs_as_recorded() {
    every_case_of("v3");
}

#[test]
fn every_version_4_case_runs_as_recorded() {
    every_case_of("v4");
}
