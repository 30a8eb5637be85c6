//! Reading one section of a file: every key once, each value strictly of its type.

use std::collections::BTreeSet;

use super::node::Node;
use crate::problem::{Problem, nearest};

/// Collects what is wrong while a file is read.
#[derive(Debug)]
pub(crate) struct Found {
    pub(crate) file: String,
    pub(crate) problems: Vec<Problem>,
}

/// Most problems that are told; the rest is counted.
const MAX_TOLD: usize = 200;

impl Found {
    pub(crate) fn error(&mut self, place: &str, value: &str, message: impl Into<String>, hint: impl Into<String>) {
        let problem = Problem::error(&self.file, place, message).with_value(value).with_hint(hint);
        self.push(problem);
    }

    pub(crate) fn warning(&mut self, place: &str, value: &str, message: impl Into<String>, hint: impl Into<String>) {
        let problem = Problem::warning(&self.file, place, message).with_value(value).with_hint(hint);
        self.push(problem);
    }

    /// Keeps a problem; of errors and warnings each the first [`MAX_TOLD`] are told.
    fn push(&mut self, problem: Problem) {
        let severity = problem.severity;
        let told = self.problems.iter().filter(|known| known.severity == severity).count();
        match told {
            n if n < MAX_TOLD => self.problems.push(problem),
            MAX_TOLD => {
                let last = Problem::error(&self.file, "", "there are more problems of this kind than are told");
                let hint = format!("mend these {MAX_TOLD} first");
                self.problems.push(Problem { severity, ..last }.with_hint(hint));
            }
            _ => {}
        }
    }
}

/// Whether a number fits, and what would.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Range {
    pub(crate) least: f64,
    pub(crate) most: f64,
    pub(crate) unit: &'static str,
}

impl Range {
    fn allowed(&self) -> String {
        format!("allowed: {:?} to {:?} {}", self.least, self.most, self.unit).trim_end().to_owned()
    }
}

/// A section with the keys that were asked for.
#[derive(Debug)]
pub(crate) struct Section<'a> {
    place: String,
    entries: &'a [(String, Node)],
    asked: BTreeSet<&'static str>,
}

impl<'a> Section<'a> {
    /// The section at a place; a problem where something else stands there.
    pub(crate) fn of(node: &'a Node, place: &str, found: &mut Found) -> Option<Self> {
        let Node::Map(entries) = node else {
            found.error(place, &node.shown(), "must be a section with keys", "indent its keys below it");
            return None;
        };
        let mut seen = BTreeSet::new();
        for (key, _) in entries {
            if !seen.insert(key.as_str()) {
                found.error(&joined(place, key), "", "is given twice", "ROS 2 keeps one of them; remove the other");
            }
        }
        Some(Self { place: place.to_owned(), entries, asked: BTreeSet::new() })
    }

    /// Full name of a key of this section.
    pub(crate) fn at(&self, key: &str) -> String {
        joined(&self.place, key)
    }

    /// All entries.
    pub(crate) const fn entries(&self) -> &'a [(String, Node)] {
        self.entries
    }

    /// The node of a key.
    pub(crate) fn node(&mut self, key: &'static str) -> Option<&'a Node> {
        self.asked.insert(key);
        self.find(key)
    }

    /// The node of a key whose name comes from the file itself.
    pub(crate) fn find(&self, key: &str) -> Option<&'a Node> {
        self.entries.iter().find(|(name, _)| name == key).map(|(_, node)| node)
    }

    /// A double; must have a decimal point.
    pub(crate) fn real(&mut self, key: &'static str, default: Option<f64>, range: Range, found: &mut Found) -> f64 {
        let place = self.at(key);
        let Some(node) = self.node(key) else {
            if default.is_none() {
                found.error(&place, "", "is missing", range.allowed());
            }
            return default.unwrap_or_default();
        };
        let spare = default.unwrap_or_else(|| range.least.max(0.0));
        match node {
            Node::Real(real) if real.is_finite() && (range.least..=range.most).contains(real) => *real,
            Node::Real(_) => {
                found.error(&place, &node.shown(), "is out of range", range.allowed());
                spare
            }
            Node::Whole(whole) => {
                found.error(
                    &place,
                    &node.shown(),
                    "is a whole number where ROS 2 reads a double",
                    format!("write {whole}.0; {}", range.allowed()),
                );
                spare
            }
            Node::Null | Node::Flag(_) | Node::Text(_) | Node::List(_) | Node::Map(_) => {
                found.error(&place, &node.shown(), "is no number", range.allowed());
                spare
            }
        }
    }

    /// A whole number; must not have a decimal point.
    pub(crate) fn whole(
        &mut self,
        key: &'static str,
        default: Option<i64>,
        range: std::ops::RangeInclusive<i64>,
        found: &mut Found,
    ) -> i64 {
        let place = self.at(key);
        let allowed = format!("allowed: {} to {}", range.start(), range.end());
        let Some(node) = self.node(key) else {
            if default.is_none() {
                found.error(&place, "", "is missing", allowed);
            }
            return default.unwrap_or_else(|| *range.start());
        };
        let spare = default.unwrap_or_else(|| *range.start());
        match node {
            Node::Whole(whole) if range.contains(whole) => *whole,
            Node::Whole(_) => {
                found.error(&place, &node.shown(), "is out of range", allowed);
                spare
            }
            Node::Real(real) => {
                let write = if real.is_finite() { format!("write {real:.0}; ") } else { String::new() };
                let hint = format!("{write}{allowed}");
                found.error(&place, &node.shown(), "has a decimal point where ROS 2 reads an integer", hint);
                spare
            }
            Node::Null | Node::Flag(_) | Node::Text(_) | Node::List(_) | Node::Map(_) => {
                found.error(&place, &node.shown(), "is no whole number", allowed);
                spare
            }
        }
    }

    /// A truth value.
    pub(crate) fn flag(&mut self, key: &'static str, default: bool, found: &mut Found) -> bool {
        let place = self.at(key);
        match self.node(key) {
            None => default,
            Some(Node::Flag(flag)) => *flag,
            Some(Node::Text(text)) if matches!(text.as_str(), "yes" | "Yes" | "YES" | "on" | "On" | "ON") => true,
            Some(Node::Text(text)) if matches!(text.as_str(), "no" | "No" | "NO" | "off" | "Off" | "OFF") => false,
            Some(node) => {
                found.error(&place, &node.shown(), "is neither true nor false", "allowed: true, false");
                default
            }
        }
    }

    /// A text that is not empty; `None` where the key is missing.
    pub(crate) fn text(&mut self, key: &'static str, found: &mut Found) -> Option<String> {
        let place = self.at(key);
        let node = self.node(key)?;
        if let Node::Text(text) = node
            && !text.trim().is_empty()
        {
            return Some(text.clone());
        }
        found.error(&place, &node.shown(), "is no text", "allowed: a name");
        None
    }

    /// Names every key that was not asked for and that `expected` does not excuse.
    pub(crate) fn close(&self, found: &mut Found, expected: impl Fn(&str, &Node, &mut Found) -> bool) {
        for (key, node) in self.entries {
            if self.asked.contains(key.as_str()) || expected(key, node, found) {
                continue;
            }
            if let Some(name) = self.asked.iter().find(|name| name.eq_ignore_ascii_case(key)) {
                // ROS 2 tells the case apart and takes the default; where there is none, that is named as missing.
                let hint = format!("ROS 2 does not read it; write `{name}`");
                found.warning(&self.at(key), &node.shown(), "differs from a key in case", hint);
                continue;
            }
            let meant = nearest(key, self.asked.iter().copied())
                .map_or_else(String::new, |name| format!("did you mean `{name}`? "));
            let keys: Vec<&str> = self.asked.iter().copied().collect();
            let hint = format!("{meant}known here: {}", keys.join(", "));
            found.error(&self.at(key), &node.shown(), "is an unknown key", hint);
        }
    }
}

fn joined(place: &str, key: &str) -> String {
    if place.is_empty() { key.to_owned() } else { format!("{place}.{key}") }
}
