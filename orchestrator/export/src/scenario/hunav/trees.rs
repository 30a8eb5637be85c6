//! Behavior trees in the nodes of a version: what the version lacks is said, and such a tree is not written.

use std::collections::{BTreeMap, BTreeSet};

use socrates_bt::{Format, Library, Meaning, Options, Tree, convert};
use socrates_hunav::{Reaction, default_tree};
use socrates_model::HumanId;

use super::super::Scenario;
use super::Kit;
use crate::not_carried::Losses;

/// The fork has codes for so many trees.
const FORK_TREES: u32 = 10;

/// Trees of a kit.
#[derive(Debug, Default)]
pub(super) struct Trees {
    /// Files by their names.
    pub(super) files: BTreeMap<String, String>,
    /// People whose own tree is there.
    pub(super) own: BTreeSet<HumanId>,
}

/// The trees of everybody.
pub(super) fn trees(scenario: &Scenario, kit: &Kit, base: &str, losses: &mut Losses) -> Trees {
    let mut trees = Trees::default();
    let Some(library) = kit.library else { return trees };
    if let Some(walk) = default_tree(Reaction::Regular, library) {
        trees.files.insert("BTRegularNav.xml".to_owned(), walk.clone());
        for human in &scenario.proposal.humans {
            if library == Library::HunavSim2 {
                trees.files.insert(format!("{base}__agent_{}_bt.xml", human.id.number()), walk.clone());
            }
        }
    }
    for (id, behavior) in &scenario.behaviors.humans {
        let at = format!("behaviors.json {id}.tree");
        let name = match library {
            Library::SocratesFork => format!("LLMBT_{}.xml", id.number() - 1),
            Library::BuiltIn | Library::HunavSim1_0 | Library::HunavSim1_1 | Library::HunavSim2 | Library::Native => {
                format!("{base}__agent_{}_bt.xml", id.number())
            }
        };
        if library == Library::SocratesFork && id.number() > FORK_TREES {
            losses.note(
                "trees beyond the tenth",
                at,
                "the fork has codes for ten trees; they walk their way by `Regular`",
            );
            continue;
        }
        match of_library(&behavior.tree, library, &at, losses) {
            Ok(text) => {
                trees.files.insert(name, text);
                trees.own.insert(*id);
            }
            Err(why) => {
                let why = format!("the tree is not written, they walk their way by `Regular`: {why}");
                losses.note("trees that the version cannot load", at, &why);
            }
        }
    }
    trees
}

/// A tree in the nodes of a library, or why the library cannot have it.
fn of_library(xml: &str, library: Library, at: &str, losses: &mut Losses) -> Result<String, String> {
    let format = if library == Library::HunavSim2 { Format::V4 } else { Format::V3 };
    let read = |xml: &str, library: Library| {
        let options = Options { library, meaning: Meaning::World, ..Options::default() };
        Tree::parse_with(xml, &options)
    };
    let tree =
        read(xml, Library::Native).map_err(|faults| faults.first().map_or_else(String::new, ToString::to_string))?;
    let numbers_people = xml.contains("target_id=");
    if library == Library::SocratesFork && numbers_people {
        return Err("it names other people, whom the fork counts from 0 in an order of its own".to_owned());
    }
    let (text, notes) = convert(&tree, format, library);
    let foreign = tree.foreign_to(library);
    let has_latch = foreign.contains(&"Latch");
    let text = if has_latch { without_latch(&text) } else { text };
    let is_near = library == Library::HunavSim2 && foreign.contains(&"IsRobotNearby");
    let text = if is_near { with_close(&text) } else { text };
    let is_solved = |tag: &str| tag == "Latch" || (is_near && tag == "IsRobotNearby");
    read(&text, library).map_err(|faults| {
        let lacks = foreign.iter().copied().filter(|tag| !is_solved(tag)).collect::<Vec<&str>>();
        let fault = faults.first().map_or_else(String::new, ToString::to_string);
        if lacks.is_empty() { fault } else { format!("{} has no node {}", library.name(), lacks.join(", ")) }
    })?;
    if is_near {
        let why = "`IsRobotNearby` is called `IsRobotClose` there, its `distance` a `threshold`";
        losses.note("spelling of nodes", at, why);
    }
    if has_latch {
        let why = format!("{} has no `Latch`: a reaction holds only while its trigger is true", library.name());
        losses.note("triggers that hold on", at, &why);
    }
    let is_told = |message: &str| ["`Latch`", "`IsRobotNearby`"].iter().any(|tag| message.contains(tag));
    for note in notes.iter().filter(|note| note.changes_meaning && !is_told(&note.message)) {
        losses.note("meaning of nodes", format!("{at}: {}", note.at), &note.message);
    }
    Ok(text)
}

/// Leaves the decorators out and keeps what is in them; each stands on a line of its own.
fn without_latch(xml: &str) -> String {
    let is_latch = |line: &str| {
        let line = line.trim();
        line == "<Latch>" || line == "</Latch>" || (line.starts_with("<Latch ") && !line.ends_with("/>"))
    };
    xml.lines().filter(|line| !is_latch(line)).map(|line| format!("{line}\n")).collect()
}

/// Writes the test of the robot's distance as version 2.0 calls it; each node stands on a line of its own.
fn with_close(xml: &str) -> String {
    let spelled = |line: &str| {
        if line.trim_start().starts_with("<IsRobotNearby ") {
            line.replace("<IsRobotNearby ", "<IsRobotClose ").replace(" distance=", " threshold=")
        } else {
            line.to_owned()
        }
    };
    xml.lines().map(|line| spelled(line) + "\n").collect()
}
