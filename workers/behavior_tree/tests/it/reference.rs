//! Tick by tick against recorded runs of BehaviorTree.CPP 3.8 and 4.10 where they are at hand, and against trees of our own that
//! `tests/data/oracle.py` ticked by the same rules.
#![expect(clippy::print_stdout, reason = "how many are equal is told")]

use std::fs;
use std::path::{Path, PathBuf};

use socrates_bt::{Kind, Options, Tree, trace};
use socrates_tests::skip::shared;

/// The first difference between what happened and what was recorded, byte by byte; also of the tree written
/// and read back.
fn difference(case: &Path) -> Option<String> {
    let read = |ending: &str| fs::read_to_string(case.with_extension(ending)).unwrap();
    let xml = read("xml");
    let options =
        Options { foreign: &[("ScriptAction", Kind::Action), ("ScriptCond", Kind::Condition)], ..Options::default() };
    let tree = match Tree::parse_with(&xml, &options) {
        Ok(tree) => tree,
        Err(faults) => return Some(format!("{faults:?}")),
    };
    for xml in [xml, tree.to_xml(tree.format())] {
        let traced = match trace(&xml, None, &read("script.json")) {
            Ok(traced) => traced,
            Err(faults) => return Some(format!("{faults:?}")),
        };
        for (found, wanted) in [(traced.events_csv, read("events.csv")), (traced.trace_csv, read("trace.csv"))] {
            if found == wanted {
                continue;
            }
            let row = found.lines().zip(wanted.lines()).position(|(found, wanted)| found != wanted);
            return Some(match row {
                Some(row) => format!("row {row}: {:?}", found.lines().nth(row).zip(wanted.lines().nth(row))),
                None => {
                    format!("{} rows instead of {}, or other line ends", found.lines().count(), wanted.lines().count())
                }
            });
        }
    }
    None
}

#[track_caller]
fn every_recorded_case_of(version: &str) {
    let Some(folder) = shared(&format!("bt_reference/{version}")) else { return };
    every_case_of(&folder);
}

fn every_case_of(folder: &Path) {
    let mut cases: Vec<PathBuf> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|ext| ext == "xml"))
        .collect();
    cases.sort();
    let different: Vec<String> = cases
        .iter()
        .filter_map(|case| difference(case).map(|how| format!("{}: {how}", case.file_stem().unwrap().display())))
        .collect();
    println!("{}: {} of {} cases are equal", folder.display(), cases.len() - different.len(), cases.len());
    assert!(cases.len() >= 12, "{} cases were found", cases.len());
    assert!(different.is_empty(), "{}", different.join("\n"));
}

#[test]
fn every_version_3_case_runs_as_recorded() {
    every_recorded_case_of("v3");
}

#[test]
fn every_version_4_case_runs_as_recorded() {
    every_recorded_case_of("v4");
}

#[test]
fn our_trees_of_both_versions_run_as_worked_out_apart() {
    for version in ["v3", "v4"] {
        every_case_of(&Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data")).join(version));
    }
}
