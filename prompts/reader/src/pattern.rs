//! The pattern language of the rows, compiled once and found by the first word.
//!
//! | written | matches |
//! |---|---|
//! | `step` | the word in any form |
//! | `step\|move` | one of them |
//! | `<go>` | a word of this class |
//! | `aside?` | may be missing |
//! | `@`, `@robot`, `@person` | a noun phrase: anybody, the robot (or a pronoun), somebody (or a pronoun) |
//! | `~` | a noun phrase that is nobody's object: `stays where he is` |
//! | `@'s` | a possessor: `the robot's`, `its`, `their` |
//! | `&` | a place |
//! | `#` | a distance or time |
//!
//! Articles, possessives and adverbs may stand between the parts; those that say something (`slowly`) are handed back.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// One part of a pattern.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Part {
    Word(Arc<BTreeSet<String>>),
    Anybody,
    Robot,
    Person,
    /// Taken, and not kept.
    Somebody,
    Whose,
    Place,
    Amount,
}

/// A part, and whether it may be missing.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Slot {
    pub(crate) part: Part,
    pub(crate) optional: bool,
}

/// A pattern with the number of the row to which it belongs.
#[derive(Debug, Clone)]
pub(crate) struct Pattern {
    pub(crate) slots: Vec<Slot>,
    pub(crate) row: usize,
}

/// How an amount is written in a pattern.
pub(crate) const AMOUNT: &str = "#";

/// Patterns by their first words.
#[derive(Debug, Default)]
pub(crate) struct Patterns {
    all: Vec<Pattern>,
    by_first: BTreeMap<String, Vec<usize>>,
}

/// A pattern that cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{phrase}`: `{part}` is no part of a pattern; the first part has to be a word or amount, and classes are those of words.toml"
)]
pub struct BadPattern {
    /// The pattern.
    pub phrase: String,
    /// Its part.
    pub part: String,
}

type Classes = BTreeMap<String, BTreeSet<String>>;

impl Patterns {
    /// Adds a pattern of a row.
    pub(crate) fn add(&mut self, phrase: &str, row: usize, classes: &Classes) -> Result<(), BadPattern> {
        let bad = |part: &str| BadPattern { phrase: phrase.to_owned(), part: part.to_owned() };
        let mut slots = Vec::new();
        for word in phrase.split_whitespace() {
            slots.push(slot(word, classes).ok_or_else(|| bad(word))?);
        }
        // What may be missing at the beginning makes patterns of their own, so that each begins with a word.
        loop {
            let Some(first) = slots.first().cloned() else { return Err(bad("")) };
            let number = self.all.len();
            let words: Vec<String> = match &first.part {
                Part::Word(words) => words.iter().cloned().collect(),
                Part::Amount => vec![AMOUNT.to_owned()],
                Part::Anybody | Part::Robot | Part::Person | Part::Somebody | Part::Whose | Part::Place => {
                    return Err(bad("first"));
                }
            };
            for word in words {
                self.by_first.entry(word).or_default().push(number);
            }
            self.all.push(Pattern { slots: slots.clone(), row });
            if !first.optional {
                return Ok(());
            }
            slots.remove(0);
        }
    }

    /// The patterns that begin with a word.
    pub(crate) fn beginning(&self, lemma: &str) -> impl Iterator<Item = &Pattern> {
        self.by_first.get(lemma).into_iter().flatten().filter_map(|number| self.all.get(*number))
    }

    /// All words of all patterns.
    pub(crate) fn words(&self) -> impl Iterator<Item = (&str, bool)> {
        self.all.iter().flat_map(|pattern| pattern.slots.iter().enumerate()).flat_map(|(place, slot)| {
            let words = if let Part::Word(words) = &slot.part { Some(words) } else { None };
            words.into_iter().flat_map(|words| words.iter()).map(move |word| (word.as_str(), place == 0))
        })
    }
}

fn slot(written: &str, classes: &Classes) -> Option<Slot> {
    let (word, optional) = written.strip_suffix('?').map_or((written, false), |word| (word, true));
    let part = match word {
        "@" => Part::Anybody,
        "@robot" => Part::Robot,
        "@person" => Part::Person,
        "~" => Part::Somebody,
        "@'s" => Part::Whose,
        "&" => Part::Place,
        AMOUNT => Part::Amount,
        _ => {
            let mut words = BTreeSet::new();
            for one in word.split('|') {
                match one.strip_prefix('<').and_then(|class| class.strip_suffix('>')) {
                    Some(class) => words.extend(classes.get(class)?.iter().cloned()),
                    None => {
                        words.insert(one.to_owned());
                    }
                }
            }
            Part::Word(Arc::new(words))
        }
    };
    Some(Slot { part, optional })
}
