//! What a person looks at: proposal, paths and behaviors as they stand, in lines that a person reads and compares.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use socrates_checks::{check_behaviors, check_paths, check_proposal};
use socrates_model::job::Stage;
use socrates_model::{AgentId, Behaviors, Fault, HumanProposal, Location, Paths, Proposal, Reading, Signature};

/// Most letters in a line of text behind its name.
const WIDTH: usize = 96;
/// Fewest letters in a line of text behind its name, however narrow the terminal is.
const NARROWEST: usize = 16;
/// Name of the entry that tells the whole proposal in sentences.
const STORY: &str = "story";
/// Letters of the name before a line.
const NAME: usize = 11;

/// One state of the draft.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Version {
    /// The proposal.
    pub(super) proposal: Proposal,
    /// The paths, once there are any.
    pub(super) paths: Option<Paths>,
    /// The trees, once there are any.
    pub(super) behaviors: Option<Behaviors>,
    /// What is asked for: edits in words change it with the proposal.
    pub(super) reading: Reading,
}

impl Version {
    /// Everything that is wrong with it, by the stage that could mend it; warnings too.
    pub(super) fn faults(&self, location: &Location) -> BTreeMap<Stage, Vec<Fault>> {
        let mut found = BTreeMap::from([(Stage::Proposal, check_proposal(&self.proposal, &self.reading, location))]);
        if let Some(paths) = &self.paths {
            found.insert(Stage::Paths, check_paths(paths, &self.proposal, location));
        }
        if let Some(behaviors) = &self.behaviors {
            found.insert(Stage::Behaviors, check_behaviors(behaviors, &self.proposal, location));
        }
        found.retain(|_, faults| !faults.is_empty());
        found
    }

    /// Signs what a person changed.
    pub(super) fn sign(&mut self, before: &Self) {
        let signed = |author: &mut Signature| *author = std::mem::take(author).and_person();
        if self.proposal != before.proposal {
            signed(&mut self.proposal.author);
        }
        if let Some(paths) = self.paths.as_mut().filter(|paths| before.paths.as_ref() != Some(paths)) {
            signed(&mut paths.author);
        }
        if let Some(trees) = self.behaviors.as_mut().filter(|trees| before.behaviors.as_ref() != Some(trees)) {
            signed(&mut trees.author);
        }
    }

    /// The proposal, a name and a text each.
    pub(super) fn proposal_entries(&self) -> Vec<Entry> {
        let proposal = &self.proposal;
        let pattern = proposal.card().map_or_else(String::new, |card| format!(" · {card}"));
        let mut entries = vec![
            Entry::new("title", &proposal.title),
            Entry::new(STORY, &proposal.description),
            Entry::new("where", format!("{}{pattern}", proposal.place)),
            Entry::new("robot", &proposal.robot.task),
        ];
        entries.extend(proposal.robot.script.iter().map(|rule| Entry::new("robot", rule.phrase())));
        entries.extend(proposal.humans.iter().flat_map(human_entries));
        for group in &proposal.groups {
            let members: Vec<String> = group.members.iter().map(ToString::to_string).collect();
            let how = if group.standing { "stand together" } else { "walk together" };
            entries.push(Entry::new(&group.id.to_string(), format!("{} {how}", members.join(", "))));
        }
        entries.extend(proposal.notes.iter().map(|note| Entry::new("note", note)));
        entries
    }

    /// Paths and trees, a name and a text each; none where there are none yet.
    pub(super) fn draft_entries(&self, location: &Location) -> Vec<Entry> {
        let mut entries = Vec::new();
        if let Some(paths) = &self.paths {
            let agents = std::iter::once(AgentId::Robot).chain(paths.humans.keys().copied().map(AgentId::Human));
            for agent in agents {
                let Some(nodes) = paths.of(agent) else { continue };
                let ids: Vec<&str> = nodes.iter().map(socrates_model::NodeId::as_str).collect();
                let meets = match agent {
                    AgentId::Human(id) => {
                        let nodes: Vec<&str> = paths.encounters_of(id).map(socrates_model::NodeId::as_str).collect();
                        if nodes.is_empty() {
                            String::new()
                        } else {
                            format!(" · meets the robot at {}", nodes.join(", then at "))
                        }
                    }
                    AgentId::Robot => String::new(),
                };
                let way = if let [only] = ids[..] {
                    format!("stands at {only}{meets}")
                } else {
                    format!("{} ({:.1} m){meets}", ids.join(" → "), location.graph.length_m(nodes))
                };
                entries.push(Entry::new(&agent.to_string(), way));
            }
        }
        for (id, human) in self.behaviors.iter().flat_map(|behaviors| &behaviors.humans) {
            let words = if human.description.is_empty() { "a tree without a description" } else { &human.description };
            entries.push(Entry::new(&format!("tree {}", id.number()), words));
        }
        entries
    }

    /// Everything in which two versions can differ, the story left out: it tells the rest again.
    pub(super) fn entries(&self, location: &Location) -> Vec<Entry> {
        let story = Entry::new(STORY, &self.proposal.description);
        let mut entries = self.proposal_entries();
        entries.retain(|entry| *entry != story);
        entries.extend(self.draft_entries(location));
        entries
    }
}

/// A name and what is said under it.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Entry {
    name: String,
    text: String,
}

impl Entry {
    fn new(name: &str, text: impl Into<String>) -> Self {
        Self { name: name.to_owned(), text: text.into() }
    }

    /// The entry in lines of at most so many columns.
    pub(super) fn lines(&self, columns: usize) -> Vec<String> {
        named(&self.name, &self.text, columns)
    }
}

/// Entries in lines of at most so many columns; a name that comes again is not written again.
pub(super) fn lines(entries: &[Entry], columns: usize) -> Vec<String> {
    let mut before = "";
    let mut lines = Vec::new();
    for entry in entries {
        let name = if entry.name == before { "" } else { &entry.name };
        lines.extend(named(name, &entry.text, columns));
        before = &entry.name;
    }
    lines
}

fn human_entries(human: &HumanProposal) -> Vec<Entry> {
    let name = human.id.to_string();
    let speed = human.speed_mps.map(|speed| format!(", {speed} m/s")).unwrap_or_default();
    let places: Vec<String> = [("from", human.start), ("to", human.goal)]
        .into_iter()
        .filter_map(|(word, place)| Some(format!(", {word} {}", place?)))
        .collect();
    let who = Entry::new(&name, format!("{}, {}{speed}{}", human.role, human.relation.name(), places.concat()));
    let rules = human.rules.iter().map(|rule| {
        let lasts = rule.for_s.map(|secs| format!(" for {secs} s")).unwrap_or_default();
        Entry::new(&name, format!("{}{lasts}", rule.phrase()))
    });
    std::iter::once(who).chain(rules).collect()
}

/// A name and its text, broken into lines under each other of at most so many columns; a word that is longer stays whole.
pub(super) fn named(name: &str, text: &str, columns: usize) -> Vec<String> {
    let lines = broken(text, columns.saturating_sub(NAME).clamp(NARROWEST, WIDTH));
    (0..).zip(lines).map(|(index, line)| format!("{:<NAME$}{line}", if index == 0 { name } else { "" })).collect()
}

/// The words of a text in lines of at most so many letters; a word that is longer stays whole.
pub(super) fn broken(text: &str, width: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    let mut line = String::new();
    for word in text.split_whitespace() {
        if !line.is_empty() && line.chars().count() + 1 + word.chars().count() > width {
            lines.push(std::mem::take(&mut line));
        }
        if !line.is_empty() {
            line.push(' ');
        }
        line.push_str(word);
    }
    lines.push(line);
    lines
}
