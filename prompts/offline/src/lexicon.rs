//! The words that the grammar knows, from `data/lexicon.toml`.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, LazyLock};

use serde::Deserialize;
use socrates_model::{Gesture, PlaceClass};

use crate::words::Word;

/// What somebody does, as the text says it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Act {
    RunAway,
    GiveWay,
    Block,
    Look,
    Approach,
    Toward,
    Overtake,
    Behind,
    Abreast,
    Ahead,
    Follow,
    Cross,
    ComeOut,
    Stay,
    Enter,
    Talk,
    WalkTogether,
    Stop,
    Stand,
    Ignore,
    Gesture,
    Lead,
    Pass,
    /// Walks on after something else.
    GoOn,
    Walk,
    /// Walks back the way they came.
    TurnBack,
    /// Walks at another pace from then on.
    SlowDown,
    SpeedUp,
    /// Stands beside the robot's way, and never in it.
    Aside,
    /// Comes up to the robot nearer than people do.
    ComeClose,
    /// Makes room as a group does, and closes up again.
    OpenUp,
}

/// What somebody notices, as the text says it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Cue {
    Visible,
    Near,
    Blocking,
    Stopped,
    Moving,
    /// It was there and is going away.
    Passed,
    Says,
    /// Another human says something.
    Told,
    /// What was said before.
    Echo,
    Goal,
    /// Where they meet.
    Meet,
}

/// A word for people.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RoleWord {
    /// `person` and its like: says nothing about who it is.
    pub(crate) generic: bool,
    /// Desired speed, m/s, where the word says something about it.
    pub(crate) speed_mps: Option<f64>,
}

/// A part of a phrase.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Item {
    /// This word in its base form.
    Word(String),
    /// A verb of a kind: `<go>`.
    OneOf(Arc<BTreeSet<String>>),
    /// Up to four words of any kind.
    Gap,
}

impl Item {
    /// Whether this word, in its base form, may stand here.
    pub(crate) fn takes(&self, stem: &str) -> bool {
        match self {
            Self::Word(wanted) => wanted == stem,
            Self::OneOf(kind) => kind.contains(stem),
            Self::Gap => false,
        }
    }
}

/// A phrase and what it means.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Phrase<T> {
    pub(crate) items: Vec<Item>,
    pub(crate) means: T,
}

/// Every table, ready for look-ups. Phrases are sorted, longest first.
#[derive(Debug, Default)]
pub(crate) struct Lexicon {
    pub(crate) stop: BTreeSet<String>,
    pub(crate) task: BTreeSet<String>,
    pub(crate) labels: BTreeSet<String>,
    pub(crate) impossible: BTreeSet<String>,
    pub(crate) nowhere: BTreeSet<String>,
    pub(crate) adjectives: BTreeSet<String>,
    /// Base forms of every verb that tells that somebody does something.
    pub(crate) verbs: BTreeSet<String>,
    /// Nouns that are no people.
    pub(crate) things: BTreeSet<String>,
    pub(crate) numbers: BTreeMap<String, u32>,
    pub(crate) ordinals: BTreeMap<String, u32>,
    pub(crate) roles: BTreeMap<String, RoleWord>,
    pub(crate) places: Vec<Phrase<PlaceClass>>,
    pub(crate) actions: Vec<Phrase<Act>>,
    pub(crate) gestures: Vec<Phrase<Gesture>>,
    pub(crate) cues: Vec<Phrase<Cue>>,
    pub(crate) distances: Vec<Phrase<f64>>,
    /// Ways of walking that are not played.
    pub(crate) unplayed: Vec<Phrase<()>>,
    pub(crate) pace: BTreeMap<String, f64>,
    /// Every known word, also those of plain English.
    pub(crate) known: BTreeSet<String>,
    /// Words that carry a wish, in the forms in which people write them: what a slip of the pen may have meant.
    pub(crate) telling: BTreeSet<String>,
    /// Things that people take from a robot or put on it.
    pub(crate) goods: BTreeSet<String>,
    pub(crate) forms: BTreeMap<String, String>,
    /// Verbs by kind, for phrases.
    classes: BTreeMap<String, Arc<BTreeSet<String>>>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    stop: String,
    english: String,
    labels: String,
    impossible: String,
    task: String,
    verbs: String,
    goods: String,
    things: String,
    classes: BTreeMap<String, String>,
    numbers: BTreeMap<String, u32>,
    ordinals: BTreeMap<String, u32>,
    forms: BTreeMap<String, String>,
    role: Vec<RoleRow>,
    adjectives: WordRow,
    place: Vec<PlaceRow>,
    nowhere: WordRow,
    action: Vec<PhraseRow<Act>>,
    gesture: Vec<GestureRow>,
    trigger: Vec<PhraseRow<Cue>>,
    distance: Vec<DistanceRow>,
    unplayed: UnplayedRow,
    pace: Vec<PaceRow>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct RoleRow {
    words: Vec<String>,
    #[serde(default)]
    generic: bool,
    #[serde(default)]
    speed: Option<f64>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct WordRow {
    words: String,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct PlaceRow {
    class: PlaceClass,
    words: Vec<String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct PhraseRow<T> {
    id: T,
    phrases: Vec<String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct GestureRow {
    name: Gesture,
    phrases: Vec<String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct DistanceRow {
    phrase: String,
    m: f64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct UnplayedRow {
    phrases: Vec<String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct PaceRow {
    words: Vec<String>,
    mps: f64,
}

static LEXICON: LazyLock<Lexicon> = LazyLock::new(|| {
    // The file is compiled in and loaded by a test, so an empty lexicon is never seen in a release.
    toml::from_str::<File>(include_str!("../data/lexicon.toml")).map(Lexicon::of).unwrap_or_default()
});

/// The tables.
pub(crate) fn lexicon() -> &'static Lexicon {
    &LEXICON
}

impl Lexicon {
    fn of(file: File) -> Self {
        let set = |text: &str| -> BTreeSet<String> { text.split_whitespace().map(str::to_owned).collect() };
        let mut lex = Self {
            stop: set(&file.stop),
            task: set(&file.task),
            labels: set(&file.labels),
            impossible: set(&file.impossible),
            nowhere: set(&file.nowhere.words),
            adjectives: set(&file.adjectives.words),
            verbs: set(&file.verbs),
            things: set(&file.things),
            goods: set(&file.goods),
            classes: file.classes.iter().map(|(name, text)| (name.clone(), Arc::new(set(text)))).collect(),
            numbers: file.numbers,
            ordinals: file.ordinals,
            forms: file.forms,
            ..Self::default()
        };
        for row in &file.role {
            for word in &row.words {
                lex.roles.insert(word.clone(), RoleWord { generic: row.generic, speed_mps: row.speed });
            }
        }
        for row in &file.pace {
            for word in &row.words {
                lex.pace.insert(word.clone(), row.mps);
            }
        }
        lex.telling =
            file.place.iter().flat_map(|row| &row.words).flat_map(|text| text.split(' ')).map(str::to_owned).collect();
        lex.learn(&file.english, &file.action, &file.trigger, &file.gesture);
        // Places are matched as written, all else in base forms.
        lex.places = sorted(
            file.place.iter().flat_map(|row| row.words.iter().map(|text| (text.as_str(), row.class))),
            &|word| Item::Word(word.to_owned()),
        );
        let kinds: Vec<String> = lex.classes.values().flat_map(|kind| kind.iter().cloned()).collect();
        lex.verbs.extend(kinds);
        let item = |word: &str| {
            let kind = word.strip_prefix('<').and_then(|word| word.strip_suffix('>'));
            match kind.and_then(|kind| lex.classes.get(kind)) {
                Some(kind) => Item::OneOf(Arc::clone(kind)),
                // The side has its own base form, and so has who leaves.
                None if word == "left" => {
                    Item::OneOf(Arc::new(BTreeSet::from(["left".to_owned(), "leave".to_owned()])))
                }
                None => Item::Word(lex.stem(word)),
            }
        };
        let actions = sorted(pairs(&file.action), &item);
        let cues = sorted(pairs(&file.trigger), &item);
        let gestures =
            sorted(file.gesture.iter().flat_map(|row| row.phrases.iter().map(|text| (text.as_str(), row.name))), &item);
        let distances = sorted(file.distance.iter().map(|row| (row.phrase.as_str(), row.m)), &item);
        lex.unplayed = sorted(file.unplayed.phrases.iter().map(|text| (text.as_str(), ())), &item);
        (lex.actions, lex.cues, lex.gestures, lex.distances) = (actions, cues, gestures, distances);
        lex
    }

    /// Collects every base form, so that [`Self::stem`] can tell a right cut from a wrong one.
    fn learn(&mut self, english: &str, actions: &[PhraseRow<Act>], cues: &[PhraseRow<Cue>], gestures: &[GestureRow]) {
        let mut known: BTreeSet<String> = english.split_whitespace().map(str::to_owned).collect();
        let phrases = actions.iter().flat_map(|row| &row.phrases).chain(cues.iter().flat_map(|row| &row.phrases));
        for text in phrases.chain(gestures.iter().flat_map(|row| &row.phrases)) {
            known.extend(plain_words(text).map(str::to_owned));
        }
        known.extend(self.classes.values().flat_map(|kind| kind.iter().cloned()));
        for table in [&self.stop, &self.task, &self.labels, &self.impossible, &self.nowhere, &self.verbs, &self.things]
        {
            known.extend(table.iter().cloned());
        }
        known.extend(self.roles.keys().cloned());
        known.extend(self.pace.keys().cloned());
        known.extend(self.numbers.keys().chain(self.ordinals.keys()).cloned());
        known.extend(self.forms.values().cloned());
        self.known = known;
        let mut telling: BTreeSet<String> =
            self.roles.keys().flat_map(|role| [role.clone(), format!("{role}s")]).collect();
        let said = gestures.iter().flat_map(|row| &row.phrases);
        for text in
            actions.iter().flat_map(|row| &row.phrases).chain(cues.iter().flat_map(|row| &row.phrases)).chain(said)
        {
            for word in plain_words(text) {
                // `pace` gives `pacing`, and no `paceing`.
                let cut = word.strip_suffix('e');
                let ends = if cut.is_some() { ["", "s", "d"].as_slice() } else { &["", "s", "es", "ed", "ing"] };
                telling.extend(ends.iter().map(|end| format!("{word}{end}")));
                telling.extend(cut.map(|cut| format!("{cut}ing")));
            }
        }
        self.telling.extend(telling);
    }

    /// Verbs of a kind, as phrases name it: `go`.
    pub(crate) fn kind(&self, name: &str) -> &BTreeSet<String> {
        static NONE: BTreeSet<String> = BTreeSet::new();
        self.classes.get(name).map_or(&NONE, |kind| kind)
    }

    /// Whether one of the tables of plain words has it, as written or in its base form.
    pub(crate) fn has(&self, word: &Word) -> bool {
        [&self.known, &self.stop, &self.labels, &self.task, &self.nowhere, &self.adjectives, &self.things]
            .iter()
            .any(|table| table.contains(&word.stem) || table.contains(&word.text))
    }

    /// The base form of a word in lower case.
    pub(crate) fn stem(&self, word: &str) -> String {
        if let Some(base) = self.forms.get(word) {
            return base.clone();
        }
        // `gets`, `makes` and `takes` are words of their own only as far as they carry no wish.
        if let Some(cut) = word.strip_suffix('s').filter(|cut| cut.len() > 2 && self.known.contains(*cut)) {
            return cut.to_owned();
        }
        if self.known.contains(word) || word.len() < 4 {
            return word.to_owned();
        }
        let mut tries: Vec<String> = Vec::new();
        for (end, puts) in [
            ("ies", &["y", "ie"][..]),
            ("ied", &["y"]),
            ("ying", &["ie", "y"]),
            ("ing", &["", "e"]),
            ("ed", &["", "e"]),
            ("es", &["", "e"]),
            ("s", &[""]),
            ("ly", &[""]),
        ] {
            // `friendly` is no friend.
            let Some(cut) = word.strip_suffix(end).filter(|cut| end != "ly" || !self.roles.contains_key(*cut)) else {
                continue;
            };
            tries.extend(puts.iter().map(|put| format!("{cut}{put}")));
            let mut letters = cut.chars().rev();
            if let (Some(last), Some(before)) = (letters.next(), letters.next())
                && last == before
            {
                tries.push(cut.chars().take(cut.chars().count().saturating_sub(1)).collect());
            }
        }
        if let Some(base) = tries.into_iter().find(|base| self.known.contains(base)) {
            return base;
        }
        match word.strip_suffix('s') {
            Some(cut) if !cut.ends_with('s') && !cut.ends_with('u') => cut.to_owned(),
            Some(_) | None => word.to_owned(),
        }
    }
}

/// The words of a phrase that are words.
fn plain_words(text: &str) -> impl Iterator<Item = &str> {
    text.split_whitespace().filter(|word| *word != ".." && !word.starts_with('<'))
}

fn pairs<T: Copy>(rows: &[PhraseRow<T>]) -> impl Iterator<Item = (&str, T)> {
    rows.iter().flat_map(|row| row.phrases.iter().map(|text| (text.as_str(), row.id)))
}

fn sorted<'a, T>(rows: impl Iterator<Item = (&'a str, T)>, base: &dyn Fn(&str) -> Item) -> Vec<Phrase<T>> {
    let mut phrases: Vec<Phrase<T>> = rows
        .map(|(text, means)| {
            let items = text.split_whitespace();
            let items = items.map(|word| if word == ".." { Item::Gap } else { base(word) }).collect();
            Phrase { items, means }
        })
        .collect();
    phrases.sort_by_key(|phrase| std::cmp::Reverse(phrase.items.iter().filter(|item| **item != Item::Gap).count()));
    phrases
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_file_loads_and_knows_its_words() {
        let lex = lexicon();
        assert!(lex.actions.len() > 100 && lex.cues.len() > 30 && lex.places.len() > 30);
        assert!(lex.roles["person"].generic);
    }

    #[test]
    fn base_forms_are_found() {
        for (word, base) in [
            ("follows", "follow"),
            ("running", "run"),
            ("stopped", "stop"),
            ("leaves", "leave"),
            ("carries", "carry"),
            ("startled", "startle"),
            ("employees", "employee"),
            ("people", "person"),
            ("nurses", "nurse"),
            ("gestures", "gesture"),
            ("slowly", "slowly"),
        ] {
            assert_eq!(lexicon().stem(word), base);
        }
    }
}
