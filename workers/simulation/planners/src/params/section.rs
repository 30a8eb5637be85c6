//! A section of a parameter file, and what is wrong with it.

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::fmt;

use yaml_serde::{Mapping, Value};

/// Longest value that a message repeats, characters.
const SHOWN_CHARS: usize = 60;

/// A value that cannot be meant.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BadValue {
    /// Sections and key, apart by points.
    pub key: String,
    /// Line of the key in the file, from 1, or of the section round it; none where neither is written.
    pub line: Option<usize>,
    /// The value, shortened.
    pub value: String,
    /// What may stand there.
    pub allowed: String,
}

impl fmt::Display for BadValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(line) = self.line {
            write!(f, "line {line}: ")?;
        }
        write!(f, "`{}` is `{}`; allowed: {}", self.key, self.value, self.allowed)
    }
}

/// What was found while sections were read.
#[derive(Debug, Default)]
pub(super) struct Notes {
    /// The file.
    text: String,
    /// Values that cannot be meant.
    pub(super) bad: Vec<BadValue>,
    /// Keys that nobody asked for, with their lines.
    pub(super) unknown: Vec<String>,
    /// Keys that say something else than what this simulation does, with their lines.
    pub(super) idle: Vec<String>,
}

impl Notes {
    pub(super) fn new(text: &str) -> Self {
        Self { text: text.to_owned(), ..Self::default() }
    }

    /// A key as a warning names it.
    fn named(&self, path: &[String]) -> String {
        let at = line_of(&self.text, path).map_or_else(String::new, |line| format!(" (line {line})"));
        format!("`{}`{at}", path.join("."))
    }

    /// Notes a value that cannot be meant.
    pub(super) fn add(&mut self, path: &[String], value: impl Into<String>, allowed: impl Into<String>) {
        let key = path.join(".");
        // The first fault of a key is the one to mend.
        if self.bad.iter().any(|other| other.key == key) {
            return;
        }
        let value: String = value.into();
        self.bad.push(BadValue {
            key,
            line: line_of(&self.text, path),
            value: value.chars().take(SHOWN_CHARS).collect(),
            allowed: allowed.into(),
        });
    }
}

/// The line of a key, or of the nearest section round it that begins a line, as for what is written in braces.
fn line_of(text: &str, path: &[String]) -> Option<usize> {
    (1..=path.len()).rev().find_map(|depth| line_of_key(text, path.get(..depth)?))
}

/// The line that begins with a key, looked for by indentation.
fn line_of_key(text: &str, path: &[String]) -> Option<usize> {
    // Keys that are open at this line, with their indentation.
    let mut open: Vec<(usize, &str)> = Vec::new();
    for (number, line) in (1_usize..).zip(text.lines()) {
        let content = line.trim_start();
        let indent = line.len() - content.len();
        let Some((key, _)) = content.split_once(':').filter(|_| !content.starts_with(['#', '-'])) else { continue };
        open.retain(|(outer, _)| *outer < indent);
        open.push((indent, key.trim().trim_matches(['"', '\''])));
        if open.iter().map(|(_, key)| *key).eq(path.iter().map(String::as_str)) {
            return Some(number);
        }
    }
    None
}

/// A value as a message shows it.
fn shown(value: &Value) -> String {
    match value {
        Value::Null => "(nothing)".to_owned(),
        Value::Bool(flag) => flag.to_string(),
        Value::Number(number) => number.to_string(),
        Value::String(text) => text.clone(),
        Value::Sequence(list) => format!("a list of {}", list.len()),
        Value::Mapping(map) => format!("a section of {}", map.len()),
        Value::Tagged(_) => "a tagged value".to_owned(),
    }
}

/// The number of a value.
fn number(value: &Value) -> Option<f64> {
    value.as_f64()
}

/// A section that is being read: it knows which of its keys were asked for.
pub(super) struct Section<'a> {
    map: Option<&'a Mapping>,
    path: Vec<String>,
    notes: &'a RefCell<Notes>,
    asked: BTreeSet<String>,
}

impl<'a> Section<'a> {
    /// The whole file.
    pub(super) const fn root(map: Option<&'a Mapping>, notes: &'a RefCell<Notes>) -> Self {
        Self { map, path: Vec::new(), notes, asked: BTreeSet::new() }
    }

    /// The path of a key.
    pub(super) fn path(&self, key: &str) -> Vec<String> {
        self.path.iter().map(String::as_str).chain([key]).map(str::to_owned).collect()
    }

    /// Notes that the value of a key cannot be meant.
    pub(super) fn refuse(&self, key: &str, value: impl Into<String>, allowed: impl Into<String>) {
        self.notes.borrow_mut().add(&self.path(key), value, allowed);
    }

    /// Notes a fault of a key below this section, given with points.
    pub(super) fn refuse_below(&self, keys: &str, value: &str, allowed: &str) {
        let path: Vec<String> =
            self.path.iter().map(String::as_str).chain(keys.split('.')).map(str::to_owned).collect();
        self.notes.borrow_mut().add(&path, value, allowed);
    }

    fn value(&mut self, key: &str) -> Option<&'a Value> {
        self.asked.insert(key.to_owned());
        self.map?.get(key)
    }

    /// Whether the file has a key, which is not asked for by this.
    pub(super) fn has(&self, key: &str) -> bool {
        self.map.is_some_and(|map| map.contains_key(key))
    }

    /// Keys that Nav2 has and that mean nothing here.
    pub(super) fn skip(&mut self, keys: &[&str]) {
        self.asked.extend(keys.iter().map(|key| (*key).to_owned()));
    }

    /// The value of a key as a reader takes it; a wrong one is noted.
    fn read<T>(&mut self, key: &str, allowed: &str, take: impl Fn(&Value) -> Option<T>) -> Option<T> {
        let value = self.value(key)?;
        let taken = take(value);
        if taken.is_none() {
            self.refuse(key, shown(value), allowed);
        }
        taken
    }

    /// A number in its range.
    pub(super) fn number(&mut self, key: &str, into: &mut f64, allowed: Range) {
        let fits = |value: &Value| number(value).filter(|number| allowed.holds(*number));
        if let Some(found) = self.read(key, allowed.words(), fits) {
            *into = found;
        }
    }

    /// A whole number from `least` on.
    pub(super) fn whole(&mut self, key: &str, into: &mut usize, least: usize) {
        let words = format!("a whole number of at least {least}");
        let fits = |value: &Value| value.as_u64().and_then(|whole| usize::try_from(whole).ok()).filter(|n| *n >= least);
        if let Some(found) = self.read(key, &words, fits) {
            *into = found;
        }
    }

    /// A small whole number.
    pub(super) fn small(&mut self, key: &str, into: &mut u32, words: &str, least: u32, most: u32) {
        let fits = |value: &Value| {
            value.as_u64().and_then(|whole| u32::try_from(whole).ok()).filter(|n| (least..=most).contains(n))
        };
        if let Some(found) = self.read(key, words, fits) {
            *into = found;
        }
    }

    /// A cost of a cell.
    pub(super) fn cost(&mut self, key: &str, into: &mut u8) {
        let fits = |value: &Value| value.as_u64().and_then(|whole| u8::try_from(whole).ok());
        if let Some(found) = self.read(key, "a whole number from 0 to 255", fits) {
            *into = found;
        }
    }

    /// True or false.
    pub(super) fn flag(&mut self, key: &str, into: &mut bool) {
        if let Some(found) = self.read(key, "true or false", Value::as_bool) {
            *into = found;
        }
    }

    /// A text.
    pub(super) fn text(&mut self, key: &str) -> Option<String> {
        self.read(key, "a text", |value| value.as_str().map(str::to_owned))
    }

    /// A text that is a choice.
    pub(super) fn choice<T: Clone>(&mut self, key: &str, into: &mut T, choices: &[(&str, T)]) {
        let names: Vec<String> = choices.iter().map(|(name, _)| format!("`{name}`")).collect();
        let fits = |value: &Value| {
            let found = shown(value);
            choices.iter().find(|(name, _)| *name == found).map(|(_, choice)| choice.clone())
        };
        if let Some(found) = self.read(key, &names.join(", "), fits) {
            *into = found;
        }
    }

    /// A list of texts.
    pub(super) fn texts(&mut self, key: &str) -> Option<Vec<String>> {
        self.read(key, "a list of texts", |value| {
            value.as_sequence()?.iter().map(|item| item.as_str().map(str::to_owned)).collect()
        })
    }

    /// Three numbers: of the axes forward, to the left, turning.
    pub(super) fn axes(&mut self, key: &str, into: &mut [f64; 3]) {
        let fits = |value: &Value| {
            let list = value.as_sequence()?;
            let numbers: Vec<f64> = list.iter().filter_map(number).filter(|number| number.is_finite()).collect();
            <[f64; 3]>::try_from(numbers).ok().filter(|_| list.len() == 3)
        };
        if let Some(found) = self.read(key, "three finite numbers: x, y, turning", fits) {
            *into = found;
        }
    }

    /// Notes a key that says something else than what this simulation does.
    fn idle(&self, key: &str, same: bool) {
        if !same {
            let mut notes = self.notes.borrow_mut();
            let named = notes.named(&self.path(key));
            notes.idle.push(named);
        }
    }

    /// A number that is not acted on; `done` is what is done instead.
    pub(super) fn idle_number(&mut self, key: &str, done: f64, allowed: Range) {
        let mut found = done;
        self.number(key, &mut found, allowed);
        self.idle(key, (found - done).abs() < f64::EPSILON);
    }

    /// The same of a flag.
    pub(super) fn idle_flag(&mut self, key: &str, done: bool) {
        let mut found = done;
        self.flag(key, &mut found);
        self.idle(key, found == done);
    }

    /// The same of three numbers.
    pub(super) fn idle_axes(&mut self, key: &str, done: [f64; 3]) {
        let mut found = done;
        self.axes(key, &mut found);
        self.idle(key, found.iter().zip(done).all(|(found, done)| (found - done).abs() < f64::EPSILON));
    }

    /// The same of a choice.
    pub(super) fn idle_choice(&mut self, key: &str, done: &str, choices: &[&str]) {
        let choices: Vec<(&str, bool)> = choices.iter().map(|choice| (*choice, *choice == done)).collect();
        let mut same = true;
        self.choice(key, &mut same, &choices);
        self.idle(key, same);
    }

    /// An outline: a list of points, or Nav2's text of one.
    pub(super) fn outline(&mut self, key: &str) -> Option<Vec<[f64; 2]>> {
        self.read(key, "at least 3 points, as in \"[[0.2, 0.1], [-0.2, 0.1], [-0.2, -0.1]]\"", |value| {
            let parsed;
            let list = match value.as_str() {
                Some(text) => {
                    parsed = yaml_serde::from_str::<Value>(text).ok()?;
                    parsed.as_sequence()?
                }
                None => value.as_sequence()?,
            };
            let point = |item: &Value| {
                let numbers: Option<Vec<f64>> = item.as_sequence()?.iter().map(number).collect();
                <[f64; 2]>::try_from(numbers?).ok().filter(|[x, y]| x.is_finite() && y.is_finite())
            };
            list.iter().map(point).collect::<Option<Vec<_>>>().filter(|points| points.len() >= 3)
        })
    }

    /// Reads a section below this one, which may be missing.
    pub(super) fn section<T>(&mut self, key: &str, read: impl FnOnce(&mut Section<'a>) -> T) -> T {
        let map = match self.value(key) {
            None | Some(Value::Null) => None,
            Some(Value::Mapping(map)) => Some(map),
            Some(
                other @ (Value::Bool(_) | Value::Number(_) | Value::String(_) | Value::Sequence(_) | Value::Tagged(_)),
            ) => {
                self.refuse(key, shown(other), "a section of keys");
                None
            }
        };
        let mut below = Section { map, path: self.path(key), notes: self.notes, asked: BTreeSet::new() };
        let found = read(&mut below);
        below.end();
        found
    }

    /// Notes the keys that nobody asked for.
    pub(super) fn end(&self) {
        for key in self.map.into_iter().flat_map(Mapping::keys) {
            let name = key.as_str().map_or_else(|| shown(key), str::to_owned);
            if self.asked.contains(&name) {
                continue;
            }
            let mut notes = self.notes.borrow_mut();
            let named = notes.named(&self.path(&name));
            notes.unknown.push(named);
        }
    }
}

/// Which numbers may stand somewhere.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Range {
    /// Above 0.
    Above0,
    /// 0 and above.
    AtLeast0,
    /// Below 0.
    Below0,
    /// 0 and below.
    AtMost0,
    /// Any.
    Finite,
}

impl Range {
    fn holds(self, number: f64) -> bool {
        number.is_finite()
            && match self {
                Self::Above0 => number > 0.0,
                Self::AtLeast0 => number >= 0.0,
                Self::Below0 => number < 0.0,
                Self::AtMost0 => number <= 0.0,
                Self::Finite => true,
            }
    }

    const fn words(self) -> &'static str {
        match self {
            Self::Above0 => "a finite number above 0",
            Self::AtLeast0 => "a finite number of at least 0",
            Self::Below0 => "a finite number below 0",
            Self::AtMost0 => "a finite number of at most 0",
            Self::Finite => "a finite number",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_found_by_its_sections() {
        let text = "a:\n  b: 1\n  c:\n    # d: 5\n    d: 2\n\ne:\n  b: 3\n  'f': [1,\n    2]\nd: {x: 1}\n";
        let line = |path: &[&str]| line_of(text, &path.iter().map(|key| (*key).to_owned()).collect::<Vec<_>>());
        assert_eq!(line(&["a", "b"]), Some(2));
        assert_eq!(line(&["a", "c", "d"]), Some(5));
        assert_eq!(line(&["e", "b"]), Some(8));
        assert_eq!(line(&["e", "f"]), Some(9));
        assert_eq!(line(&["d"]), Some(11));
        assert_eq!(line(&["d", "x"]), Some(11), "in braces: where they are");
        assert_eq!(line(&["b"]), None);
    }
}
