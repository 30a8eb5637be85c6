//! Words of a closed list: one that is not on it is answered with the nearest that is.

use serde::de::DeserializeOwned;
use serde_json::Value;

use super::read::Door;
use super::tree::{Kind, Node};

/// A closed list of words, some of which carry a value.
pub(super) struct Words {
    /// What one of them is: `trigger`.
    pub(super) what: &'static str,
    /// Each word with an example of how it is written.
    pub(super) all: Vec<(&'static str, String)>,
    /// What may stand besides: `, or a list of them`.
    pub(super) more: &'static str,
}

impl Words {
    /// A list whose words and examples stand in a table.
    pub(super) fn of_table(what: &'static str, table: &[(&'static str, &str)]) -> Self {
        Self { what, all: table.iter().map(|(word, example)| (*word, (*example).to_owned())).collect(), more: "" }
    }

    /// Every word as it is written.
    fn listed(&self) -> String {
        let examples: Vec<&str> = self.all.iter().map(|(_, example)| example.as_str()).collect();
        format!("{}{}", examples.join(", "), self.more)
    }

    /// The word that is spelled most like another one, with its example.
    fn nearest(&self, wrong: &str) -> Option<&(&'static str, String)> {
        let wrong = wrong.to_lowercase();
        self.all.iter().min_by_key(|(word, _)| distance(&wrong, &word.to_lowercase()))
    }
}

/// Letters that have to be changed, put in or left out to make one word of another.
fn distance(a: &str, b: &str) -> usize {
    let letters: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=letters.len()).collect();
    for (i, from) in (1..).zip(a.chars()) {
        let mut corner = i - 1;
        let mut left = i;
        if let Some(first) = row.first_mut() {
            *first = i;
        }
        for (cell, to) in row.iter_mut().skip(1).zip(&letters) {
            let changed = corner + usize::from(from != *to);
            corner = *cell;
            *cell = changed.min(*cell + 1).min(left + 1);
            left = *cell;
        }
    }
    row.last().copied().unwrap_or(0)
}

/// Longest text of a value that is shown, characters.
const SHOWN: usize = 60;

fn shown(value: &Value) -> String {
    let text = value.to_string();
    if text.chars().count() > SHOWN { text.chars().take(SHOWN).chain(['…']).collect() } else { text }
}

impl Door<'_> {
    /// A word of a list, as the type that it means. What is not on it is said with its value, the nearest word and, once a list, all.
    pub(super) fn word_of<T: DeserializeOwned>(&mut self, key: &str, node: &Node, words: &Words) -> Option<T> {
        let value = node.value();
        let word = match &node.kind {
            Kind::Plain(Value::String(word)) => Some(word.as_str()),
            Kind::Table(entries) => match entries.as_slice() {
                [(word, ..)] => Some(word.as_str()),
                _ => None,
            },
            Kind::List(_) | Kind::Plain(_) | Kind::Odd(_) => None,
        };
        if let Ok(found) = serde_json::from_value(value.clone()) {
            return Some(found);
        }
        let known = word.and_then(|word| words.all.iter().find(|(name, _)| *name == word));
        let (found, hint) = match (word, known) {
            (Some(word), Some((_, example))) => {
                (format!("`{word}` is not written as {}", shown(&value)), format!("write {example}"))
            }
            (Some(word), None) => {
                let near = words.nearest(word).map_or_else(String::new, |(_, example)| format!("nearest: {example}"));
                (format!("`{}` is no {}", word.chars().take(SHOWN).collect::<String>(), words.what), near)
            }
            (None, _) => (format!("{} is no {}", shown(&value), words.what), String::new()),
        };
        let list = if known.is_some() {
            String::new()
        } else if self.is_listed(words.what) {
            format!("all {}s stand at the first", words.what)
        } else {
            format!("{}s: {}", words.what, words.listed())
        };
        let hint = [hint, list].into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join("; ");
        self.bad(key, node.at, found, hint);
        None
    }
}

#[cfg(test)]
mod tests {
    use super::distance;

    #[test]
    fn the_distance_of_two_words_is_that_of_levenshtein() {
        for (a, b, wanted) in
            [("", "abc", 3), ("kitten", "sitting", 3), ("robot_neer", "robot_near", 1), ("same", "same", 0)]
        {
            assert_eq!(distance(a, b), wanted, "{a} {b}");
            assert_eq!(distance(b, a), wanted, "{b} {a}");
        }
    }
}
