//! The words of `data/words.toml`: of what sort each is, and its base form.

use std::collections::{BTreeMap, BTreeSet};

use serde::Deserialize;

use crate::token::{Bent, Sort, Sorts};

/// The file as written.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    fill: String,
    empty: String,
    person_endings: String,
    looks: String,
    things: String,
    robot: String,
    people: String,
    roles: String,
    groups: String,
    labels: String,
    slow: String,
    brisk: String,
    hurried: String,
    paces: BTreeMap<String, f64>,
    numbers: BTreeMap<String, u32>,
    ordinals: BTreeMap<String, u32>,
    meters: BTreeMap<String, f64>,
    seconds: BTreeMap<String, f64>,
    classes: BTreeMap<String, String>,
    grammar: BTreeMap<Sort, String>,
    forms: BTreeMap<String, String>,
}

/// What is known of words.
#[derive(Debug, Default)]
pub(crate) struct Words {
    sorts: BTreeMap<String, Sorts>,
    pub(crate) numbers: BTreeMap<String, u32>,
    pub(crate) ordinals: BTreeMap<String, u32>,
    pub(crate) meters: BTreeMap<String, f64>,
    pub(crate) seconds: BTreeMap<String, f64>,
    pub(crate) classes: BTreeMap<String, BTreeSet<String>>,
    forms: BTreeMap<String, String>,
    person_endings: Vec<String>,
    pub(crate) hurried: BTreeSet<String>,
    /// How fast people of a role walk, m/s.
    pub(crate) paces: BTreeMap<String, f64>,
}

/// Endings, and what stands in their place in the base form.
const ENDINGS: &[(&str, &[&str], Bent)] = &[
    ("ies", &["y", "ie"], Bent::S),
    ("ied", &["y"], Bent::Ed),
    ("ying", &["ie", "y"], Bent::Ing),
    ("ing", &["", "e"], Bent::Ing),
    ("ed", &["", "e"], Bent::Ed),
    ("es", &["", "e"], Bent::S),
    ("s", &[""], Bent::S),
];

impl Words {
    /// Reads the file.
    ///
    /// # Errors
    /// What the file says that is none of its keys.
    pub(crate) fn read(text: &str) -> Result<Self, toml::de::Error> {
        let file: File = toml::from_str(text)?;
        let mut words = Self {
            paces: file.paces,
            numbers: file.numbers,
            ordinals: file.ordinals,
            meters: file.meters,
            seconds: file.seconds,
            forms: file.forms,
            person_endings: split(&file.person_endings).collect(),
            hurried: split(&file.hurried).collect(),
            classes: file.classes.into_iter().map(|(name, all)| (name, split(&all).collect())).collect(),
            ..Self::default()
        };
        let mut lists: Vec<(Sort, &str)> = vec![
            (Sort::Fill, &file.fill),
            (Sort::Empty, &file.empty),
            (Sort::Looks, &file.looks),
            (Sort::Thing, &file.things),
            (Sort::Robot, &file.robot),
            (Sort::People, &file.people),
            (Sort::Role, &file.roles),
            (Sort::Group, &file.groups),
            (Sort::Label, &file.labels),
            (Sort::Slow, &file.slow),
            (Sort::Brisk, &file.brisk),
        ];
        lists.extend(file.grammar.iter().map(|(sort, all)| (*sort, all.as_str())));
        for (sort, all) in lists {
            for word in split(all) {
                words.note(word, sort);
            }
        }
        let verbs: Vec<String> = words.classes.values().flatten().cloned().collect();
        for verb in verbs {
            words.note(verb, Sort::Verb);
        }
        Ok(words)
    }

    /// Notes that a word is of a sort.
    pub(crate) fn note(&mut self, word: String, sort: Sort) {
        let sorts = self.sorts.entry(word).or_default();
        *sorts = sorts.with(sort);
    }

    /// Makes a word known, of whatever sort.
    pub(crate) fn know(&mut self, word: &str) {
        self.sorts.entry(word.to_owned()).or_default();
    }

    pub(crate) fn sorts(&self, word: &str) -> Sorts {
        self.sorts.get(word).copied().unwrap_or_default()
    }

    pub(crate) fn knows_bent(&self, word: &str) -> bool {
        self.knows(word) || self.knows(&self.base(word).0)
    }

    fn knows(&self, word: &str) -> bool {
        self.sorts.contains_key(word) || self.numbers.contains_key(word) || self.ordinals.contains_key(word)
    }

    /// The base form of a word in lower case, and how it was bent.
    pub(crate) fn base(&self, word: &str) -> (String, Bent) {
        if let Some(base) = self.forms.get(word) {
            let noun = [Sort::Role, Sort::People, Sort::Indefinite].iter().any(|sort| self.sorts(base).has(*sort));
            let bent = match ENDINGS.iter().find(|(end, _, _)| word.ends_with(end)) {
                _ if base == word => Bent::Base,
                Some((_, _, Bent::Ed | Bent::Ing)) if noun => Bent::Base,
                Some((_, _, bent)) => *bent,
                // `women` are several, and a `ped` is one.
                None if noun && word.ends_with("en") => Bent::S,
                None if noun => Bent::Base,
                None => Bent::Ed,
            };
            return (base.clone(), bent);
        }
        if self.knows(word) && !word.ends_with("ing") || word.len() < 3 {
            return (word.to_owned(), Bent::Base);
        }
        for (end, puts, bent) in ENDINGS {
            let Some(cut) = word.strip_suffix(end) else { continue };
            let mut chars = cut.chars().rev();
            let doubled = match (chars.next(), chars.next()) {
                (Some(last), Some(before)) if last == before => cut.get(..cut.len() - last.len_utf8()),
                _ => None,
            };
            let tries = puts.iter().map(|put| format!("{cut}{put}")).chain(doubled.map(str::to_owned));
            if let Some(base) = tries.into_iter().find(|base| self.knows(base)) {
                return (base, *bent);
            }
        }
        if self.knows(word) {
            return (word.to_owned(), Bent::Base);
        }
        (word.to_owned(), ending_of_unknown(word))
    }

    /// Whether a word that nobody knows ends as words for people do: `storekeeper`.
    pub(crate) fn sounds_like_a_person(&self, word: &str) -> bool {
        word.len() > 5 && self.person_endings.iter().any(|ending| word.ends_with(ending.as_str()))
    }

    /// Known words that begin with a letter and have at least so many, for spelling.
    pub(crate) fn long(&self, first: char, letters: usize) -> impl Iterator<Item = &str> {
        let sorts = self.sorts.range(first.to_string()..).map(|(word, _)| word);
        let forms = self.forms.range(first.to_string()..).map(|(word, _)| word);
        let begins = move |word: &&String| word.starts_with(first);
        let all = sorts.take_while(begins).chain(forms.take_while(begins));
        all.map(String::as_str).filter(move |word| word.len() >= letters)
    }

    /// What a word would be without each ending, for spelling: `aproaches` is `aproach`, bent.
    pub(crate) fn stems<'a>(word: &'a str) -> impl Iterator<Item = (String, Bent)> + 'a {
        let stems = |(end, puts, bent): &'static (&str, &[&str], Bent)| {
            let cut = word.strip_suffix(end);
            cut.into_iter().flat_map(move |cut| puts.iter().map(move |put| (format!("{cut}{put}"), *bent)))
        };
        ENDINGS.iter().flat_map(stems)
    }
}

/// How a word that nobody knows is bent, by its ending.
fn ending_of_unknown(word: &str) -> Bent {
    ENDINGS.iter().find(|(end, _, _)| word.len() > 4 && word.ends_with(end)).map_or(Bent::Base, |(_, _, bent)| *bent)
}

fn split(words: &str) -> impl Iterator<Item = String> + '_ {
    words.split_whitespace().map(str::to_owned)
}
