//! Labels of people in notes: `ped A (employee): head-on`, `actor 1 = patient`, `P1+P2 = workers`, `#1 oncoming`.
//!
//! Who is told by a label is spoken of as `human 1` from there on; a sentence before the first label says how many there are
//! and what each is.

use std::collections::{BTreeMap, BTreeSet};

use crate::lexicon::lexicon;
use crate::mention::{Who, mentions};
use crate::notes::{Item, Items, Mark};
use crate::noun::{band, noun, plural, stranger};
use crate::words::Word;

/// What a label is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Key {
    Number(u32),
    /// `E1`, `w2`.
    Code(char, u32),
    Letter(char),
}

/// Words before a number or a letter that make it somebody's label.
const GENERIC: &[&str] = &[
    "actor",
    "pedestrian",
    "person",
    "human",
    "participant",
    "subject",
    "agent",
    "individual",
    "bystander",
    "confederate",
];

/// Words behind which a letter is a label.
const BEFORE: &[&str] = &[
    "and", "with", "to", "from", "behind", "follow", "past", "when", "while", "but", "then", "if", "after", "before",
    "only", "both", "beside", "towards", "toward", "at", "until", "once", "both", "as", "signal", "tell", "ask",
    "wave", "than", "next", "near", "help", "lead", "meet", "pass", "overtake", "group", "or", "not", "for", "does",
    "do",
];

/// Labels of a text: the families of letters and digits that stand for people, and the number of each.
struct Labels {
    items: Items,
    letters: BTreeSet<char>,
    /// First letters of `E1`, `w2`.
    families: BTreeSet<char>,
    /// `#1`, `(2)`.
    tags: bool,
    listed: bool,
}

/// Rewrites labels; a text without any stays as it is.
pub(crate) fn actors(items: Items) -> Items {
    let items = listed_roles(generic_roles(items));
    let labels = Labels::of(items);
    let keys = labels.keys();
    if keys.is_empty() {
        return labels.items;
    }
    let mut written = Written { keys, roles: BTreeMap::new(), out: Vec::new(), first: None, marks: None };
    labels.write(&mut written);
    written.finish()
}

/// `1 ped (cleaner)` is one cleaner.
fn generic_roles(items: Items) -> Items {
    let mut items = items;
    let mut at = 0;
    while at + 1 < items.0.len() {
        let generic = lexicon().roles.get(items.stem(at)).is_some_and(|role| role.generic)
            && items.word(at).is_some_and(|word| !word.label);
        let opens = items.0.get(at + 1).is_some_and(|item| item.opens() && !item.closes());
        if generic
            && opens
            && let Some((role, end)) = role(&items, at + 1)
        {
            let closes = items.0.get(end).is_none_or(Item::closes);
            if closes && !role.is_empty() && !items.has(end, Mark::Colon) || closes && end >= items.0.len() {
                let marks = items.0.get(at).map(|item| item.marks.clone()).unwrap_or_default();
                let gap = items.0.get(at).map(|item| item.gap.clone()).unwrap_or_default();
                if let Some(item) = items.0.get_mut(at + 1) {
                    (item.marks, item.gap) = (marks, gap);
                }
                let _generic = items.0.remove(at);
            }
        }
        at += 1;
    }
    items
}

/// `roles: doctor + visitor` are two people.
fn listed_roles(mut items: Items) -> Items {
    let heads = |k: &usize| matches!(items.text(*k), "role" | "roles" | "cast") && items.begins(*k);
    let Some(at) = (0..items.0.len()).find(heads) else { return items };
    let end = items.end(at).min(items.0.len());
    let (mut roles, mut k) = (Vec::new(), at + 1);
    while k < end {
        let Some((name, to)) = role(&items, k) else { break };
        roles.push(name);
        k = to + usize::from(items.text(to) == "and");
    }
    if roles.len() < 2 || k < end {
        return items;
    }
    let count = u32::try_from(roles.len()).unwrap_or(u32::MAX);
    // `human_count 2`
    for k in 0..at {
        let counts = items.word(k).and_then(Word::count) == Some(count);
        let generic = |back: usize| k.checked_sub(back).is_some_and(|k| GENERIC.contains(&items.stem(k)));
        let from = if generic(1) {
            Some(k - 1)
        } else if generic(2) && matches!(items.text(k - 1), "count" | "number") {
            Some(k - 2)
        } else {
            None
        };
        if counts && let Some(from) = from {
            for item in items.0.iter_mut().take(k + 1).skip(from) {
                (item.word.label, item.word.used) = (true, true);
            }
        }
    }
    let Some(first) = items.0.get(at).cloned() else { return items };
    let mut people = Item::said("people", &first);
    people.word.made_of = roles;
    let number = Item::said(&count.to_string(), &first).with(&first.marks);
    let _old: Vec<Item> = items.0.splice(at..end, [number, people]).collect();
    items
}

/// The role that a run of words names, and the place after it: `a forklift driver`, `both workers`.
fn role(items: &Items, from: usize) -> Option<(String, usize)> {
    let skip = usize::from(matches!(items.text(from), "a" | "an" | "the" | "all" | "both" | "one" | "is" | "are"));
    let skip = skip + usize::from(skip == 1 && matches!(items.text(from + 1), "a" | "an"));
    let start = from + skip;
    if start >= items.0.len() || (start > from && items.marked(start)) {
        return None;
    }
    let run = items.run(start);
    let lex = lexicon();
    // `ped 1 and ped 2: couple, hand in hand`
    if run.len() == 1 && band(&run, 0).is_some() {
        return Some((String::new(), start + 1));
    }
    let end = noun(&run, 0, lex).or_else(|| stranger(&run, 0, true, lex)).or_else(|| {
        // A word that nobody knows, alone: `actor 1 (docker)`.
        let alone = run.len() == 1 && run.first().is_some_and(|word| word.text.len() >= 4 && !lex.has(word));
        alone.then_some(0)
    })?;
    let named = (0..=2)
        .filter_map(|back| end.checked_sub(back))
        .filter_map(|k| run.get(k))
        .find(|word| lex.roles.contains_key(&word.stem));
    let role = match named {
        Some(word) if lex.roles.get(&word.stem).is_some_and(|role| role.generic) => String::new(),
        Some(word) => word.stem.clone(),
        None => run.get(end)?.stem.clone(),
    };
    Some((role, start + end + 1))
}

impl Labels {
    fn of(items: Items) -> Self {
        let mut labels =
            Self { items, letters: BTreeSet::new(), families: BTreeSet::new(), tags: false, listed: false };
        let count = labels.items.0.len();
        let mut bare = BTreeSet::new();
        for k in 0..count {
            if let Some(letter) = labels.letter(k) {
                // `ped A/B`, `actors A and B`
                let joined = labels.items.0.get(k).is_some_and(|item| matches!(item.gap.trim(), "/" | "+" | "&"));
                let and = labels.items.text(k.wrapping_sub(1)) == "and" && !labels.items.marked(k);
                let before = k.checked_sub(1 + usize::from(and)).filter(|_| joined || and);
                let second =
                    before.and_then(|back| labels.letter(back)).is_some_and(|letter| labels.letters.contains(&letter));
                if second || labels.generic(k) || labels.role_before(k) || labels.bracketed(k) {
                    labels.letters.insert(letter);
                } else if matches!(letter, 'A'..='H' | 'X'..='Z') && labels.free(k) && labels.declares(k) {
                    bare.insert(letter);
                }
            }
            if let Some((family, number)) = labels.coded(k) {
                let person = matches!(family, 'P' | 'H') && labels.items.word(k).is_some_and(|word| word.capital);
                let of_role = (0..k).any(|back| {
                    labels.items.word(back).is_some_and(|word| {
                        lexicon().roles.contains_key(&word.stem)
                            && word.text.starts_with(family.to_ascii_lowercase())
                            && plural(word)
                    })
                });
                let told = labels.items.has(k + 1, Mark::Colon) || labels.items.0.get(k + 1).is_some_and(Item::equals);
                let bracketed = labels.items.0.get(k).is_some_and(Item::opens)
                    && k > 0
                    && (labels.role_at(k - 1)
                        || labels.items.word(k - 1).is_some_and(|word| word.is_digits() || word.stem == "group"));
                let named = labels.named(k);
                if number > 0 && (labels.free(k) && (person || of_role || told || bracketed) || named) {
                    labels.families.insert(family);
                }
            }
            let gap = labels.items.0.get(k).map_or("", |item| item.gap.as_str());
            labels.tags |= gap.ends_with("#") && labels.items.text(k) == "1" && labels.items.marked(k);
            labels.listed |= gap.contains("(1)") && role(&labels.items, k).is_some();
        }
        if bare.len() > 1 || !labels.letters.is_empty() {
            labels.letters.extend(bare);
        }
        labels
    }

    /// A capital letter alone.
    fn letter(&self, at: usize) -> Option<char> {
        let item = self.items.0.get(at)?;
        // `actor_a`
        let tied = item.gap == "_" && at > 0 && GENERIC.contains(&self.items.stem(at - 1));
        let word = Some(&item.word).filter(|word| (word.capital || tied) && !word.label && word.text.len() == 1)?;
        word.text.chars().next().map(|c| c.to_ascii_uppercase()).filter(char::is_ascii_uppercase)
    }

    /// `nurse (N)`.
    fn bracketed(&self, at: usize) -> bool {
        let closes = self.items.0.get(at + 1).is_some_and(Item::closes);
        let opens = self.items.0.get(at).is_some_and(|item| item.opens() && !item.closes());
        let role = at > 0
            && self.items.word(at - 1).is_some_and(|word| lexicon().roles.contains_key(&word.stem) && !plural(word));
        closes && opens && role
    }

    fn role_at(&self, at: usize) -> bool {
        self.items.word(at).is_some_and(|word| lexicon().roles.contains_key(&word.stem) && !word.label)
    }

    /// `doctor D1`.
    fn named(&self, at: usize) -> bool {
        let beside = self.items.0.get(at).is_some_and(|item| item.gap == " " && item.word.capital);
        at > 0 && beside && self.role_at(at - 1) && self.items.word(at - 1).is_some_and(|word| !plural(word))
    }

    fn generic(&self, at: usize) -> bool {
        at > 0 && !self.items.marked(at) && (GENERIC.contains(&self.items.stem(at - 1)))
    }

    /// `worker A`.
    fn role_before(&self, at: usize) -> bool {
        at > 0
            && !self.items.marked(at)
            && self.items.0.get(at).is_some_and(|item| item.gap == " ")
            && self.items.word(at - 1).is_some_and(|word| {
                lexicon().roles.contains_key(&word.stem) && !plural(word) && !lexicon().labels.contains(&word.stem)
            })
            && (self.letter(at) != Some('A') || !self.noun_follows(at))
    }

    fn noun_follows(&self, at: usize) -> bool {
        self.items.0.get(at + 1).is_some_and(|item| item.marks.is_empty() && !item.equals())
            && role(&self.items, at + 1).is_some()
    }

    /// `E1`, `w2`.
    fn coded(&self, at: usize) -> Option<(char, u32)> {
        let word = self.items.word(at).filter(|word| !word.label && word.text.len() == 2)?;
        let family = word.text.chars().next().filter(char::is_ascii_alphabetic)?;
        let number = word.text.get(1..)?.parse().ok()?;
        Some((if word.capital { family.to_ascii_uppercase() } else { family }, number))
    }

    /// Whether a letter or code stands where people are named: `rooms A, B and C` are none.
    fn free(&self, at: usize) -> bool {
        let Some(item) = self.items.0.get(at) else { return false };
        let chained = matches!(item.gap.trim(), "," | "+" | "-" | "/") && at > 0 && self.letter(at - 1).is_some();
        if chained && self.letter(at).is_some() {
            return self.generic(at - 1) || self.free(at - 1);
        }
        let joined = item.gap.contains(['+', '(']) || item.arrow;
        at == 0
            || self.items.marked(at)
            || joined
            || BEFORE.contains(&self.items.stem(at - 1))
            || BEFORE.contains(&self.items.text(at - 1))
    }

    /// `A:`, `A =`, `A+B`, `(A, B, C)`, `A-C`, `B nurse`.
    fn declares(&self, at: usize) -> bool {
        let next = self.items.0.get(at + 1);
        let other = |k: usize| self.letter(k).is_some();
        self.items.has(at + 1, Mark::Colon)
            || next.is_some_and(Item::equals)
            || next.is_some_and(|next| {
                matches!(next.gap.trim(), "+" | "-" | ",") && other(at + 1)
                    || next.opens() && role(&self.items, at + 1).is_some()
            })
            || at > 0
                && self.items.0.get(at).is_some_and(|item| matches!(item.gap.trim(), "+" | "-" | ","))
                && other(at - 1)
    }

    /// The label at a place, with the place after it.
    fn key(&self, at: usize) -> Option<(Key, usize)> {
        let item = self.items.0.get(at)?;
        let tight = |k: usize| {
            self.items
                .0
                .get(k)
                .is_some_and(|item| item.marks.is_empty() && matches!(item.gap.trim(), "" | "_" | "-" | "#"))
        };
        // A name of something else: `H1N1`, `B2 building`.
        let digit = |k: usize| {
            let word = self.items.word(k).filter(|word| word.text.len() == 1 && word.is_digits())?;
            word.text.parse::<u32>().ok().filter(|n| *n > 0)
        };
        if GENERIC.contains(&self.items.stem(at)) && !plural(&item.word) && tight(at + 1) {
            if let Some(number) = digit(at + 1).filter(|_| !self.noun_follows(at + 1)) {
                return Some((Key::Number(number), at + 2));
            }
            if let Some(letter) = self.letter(at + 1).filter(|letter| self.letters.contains(letter)) {
                return Some((Key::Letter(letter), at + 2));
            }
        }
        if self.letter(at + 1).is_some() && self.role_before(at + 1) {
            let letter = self.letter(at + 1).filter(|letter| self.letters.contains(letter))?;
            return Some((Key::Letter(letter), at + 2));
        }
        let code = |at: usize| self.coded(at).filter(|(family, _)| self.families.contains(family));
        if let Some((family, number)) = code(at + 1).filter(|_| self.named(at + 1)) {
            return Some((Key::Code(family, number), at + 2));
        }
        if let Some((family, number)) = code(at)
            && !(at > 0 && !self.items.marked(at) && lexicon().labels.contains(self.items.stem(at - 1)))
        {
            return Some((Key::Code(family, number), at + 1));
        }
        if (self.tags && item.gap.ends_with('#')
            || self.listed && item.gap.ends_with('(') && self.items.0.get(at + 1).is_none_or(Item::closes))
            && let Some(number) = item.word.text.parse::<u32>().ok().filter(|n| (1..=9).contains(n))
        {
            return Some((Key::Number(number), at + 1));
        }
        let letter = self.letter(at).filter(|letter| self.letters.contains(letter) && self.free(at))?;
        // `A nurse` is a nurse, unless others are told by letters in the same way.
        let joined =
            self.items.0.get(at + 1).is_some_and(|next| matches!(next.gap.trim(), "-" | "–" | "+" | "=" | "/"));
        let article = letter == 'A' && !self.items.marked(at + 1) && !joined && {
            let next = self.items.word(at + 1);
            let acts = next.is_some_and(|next| {
                lexicon().verbs.contains(&next.stem) && next.text != next.stem && next.text.ends_with('s')
                    || matches!(
                        next.text.as_str(),
                        "and"
                            | "when"
                            | "is"
                            | "does"
                            | "then"
                            | "only"
                            | "in"
                            | "on"
                            | "at"
                            | "must"
                            | "should"
                            | "will"
                            | "never"
                            | "just"
                            | "after"
                            | "if"
                            | "to"
                            | "from"
                    )
            });
            !acts && !self.juxtaposed(at)
        };
        (!article).then_some((Key::Letter(letter), at + 1))
    }

    /// `A nurse, B+C visitors`.
    fn juxtaposed(&self, at: usize) -> bool {
        let of =
            |k: usize| self.noun_follows(k) && role(&self.items, k + 1).is_some_and(|(_, end)| self.items.marked(end));
        let other = |k: usize| self.letter(k).is_some_and(|letter| letter != 'A' && self.letters.contains(&letter));
        of(at) && (0..self.items.0.len()).any(|k| k != at && other(k) && of(k))
    }

    /// Labels in a row: `A, B and C`, `P1+P2`, `A-C`.
    fn list(&self, at: usize) -> Option<(Vec<Key>, usize)> {
        let (first, mut end) = self.key(at)?;
        let mut keys = vec![first];
        // `follows agent 1, agent 3 stops` is no list.
        let heads = self.items.marked(at) || self.items.0.get(at).is_some_and(Item::opens);
        let generic = GENERIC.contains(&self.items.stem(at));
        loop {
            let gap = self.items.0.get(end).map_or("", |item| item.gap.trim()).to_owned();
            let and = matches!(self.items.text(end), "and" | "or") && !self.items.marked(end);
            let comma = heads && (self.items.has(end, Mark::Comma) && gap == "," || gap == ", and");
            let at = end + usize::from(and || self.items.text(end) == "and");
            // `ped 1+2`, `actors 1 and 2`
            let bare = || {
                let number = self.items.text(at).parse().ok().filter(|n| (1..=9).contains(n))?;
                let ends = self.items.word(at + 1).is_none_or(|next| {
                    !next.is_digits() && !matches!(next.stem.as_str(), "meter" | "second" | "m" | "s")
                });
                (generic && ends && matches!(keys.last(), Some(Key::Number(_))))
                    .then_some((Key::Number(number), at + 1))
            };
            let next = self
                .key(at)
                .or_else(bare)
                .filter(|_| and || comma || matches!(gap.as_str(), "+" | "-" | "–" | "/" | "&"));
            let Some((key, to)) = next else { break };
            let range = keys
                .last()
                .copied()
                .filter(|_| matches!(gap.as_str(), "-" | "–"))
                .map_or_else(Vec::new, |last| between(last, key));
            keys.extend(range);
            keys.push(key);
            end = to;
        }
        Some((keys, end))
    }

    /// Every label that stands for somebody, in order, each with its number.
    fn keys(&self) -> BTreeMap<Key, u32> {
        let mut found = BTreeSet::new();
        for k in 0..self.items.0.len() {
            if let Some((keys, _)) = self.list(k) {
                found.extend(keys);
            }
            let gap = self.items.0.get(k).map_or("", |item| item.gap.as_str());
            if self.listed
                && let Some(number) = listed(gap).filter(|_| role(&self.items, k).is_some())
            {
                found.insert(Key::Number(number));
            }
        }
        let codes: BTreeSet<char> =
            found.iter().filter_map(|key| if let Key::Code(family, _) = key { Some(*family) } else { None }).collect();
        let numbers = found.iter().any(|key| matches!(key, Key::Number(_)));
        let letters = found.iter().any(|key| matches!(key, Key::Letter(_)));
        let row = found.iter().zip('A'..='Z').all(|(key, letter)| *key == Key::Letter(letter));
        // `nurse (N)` and `patient (P)`, `doctor D1` and `patient P1`: in the order in which they are told.
        if !row && (letters || codes.len() > 1 && !numbers) {
            let first =
                |key: &Key| (0..self.items.0.len()).find(|k| self.list(*k).is_some_and(|(keys, _)| keys.contains(key)));
            let mut keys: Vec<Key> = found.into_iter().collect();
            keys.sort_by_key(first);
            return keys.into_iter().zip(1..).collect();
        }
        if letters {
            return found.into_iter().zip(1..).collect();
        }
        let number = |key: &Key| if let Key::Number(n) | Key::Code(_, n) = key { *n } else { 0 };
        let most = found.iter().map(number).max().unwrap_or(0);
        found.extend((1..=most).map(Key::Number));
        found.into_iter().map(|key| (key, number(&key))).collect()
    }
}

/// The labels between two: of `A-D`, B and C.
fn between(from: Key, to: Key) -> Vec<Key> {
    if let (Key::Letter(from), Key::Letter(to)) = (from, to) {
        return (from..to).skip(1).map(Key::Letter).collect();
    }
    if let (Key::Code(family, from), Key::Code(_, to)) = (from, to) {
        return (from..to).skip(1).map(|n| Key::Code(family, n)).collect();
    }
    if let (Key::Number(from), Key::Number(to)) = (from, to) {
        return (from..to).skip(1).map(Key::Number).collect();
    }
    Vec::new()
}

/// The number of `(2)` at the end of a gap.
fn listed(gap: &str) -> Option<u32> {
    let inner = gap.trim_end().strip_suffix(')')?;
    inner.rsplit_once('(')?.1.parse().ok().filter(|n| (1..=9).contains(n))
}

/// The text as it is written anew.
struct Written {
    keys: BTreeMap<Key, u32>,
    roles: BTreeMap<u32, String>,
    out: Vec<Item>,
    /// The word at which the first label stands.
    first: Option<usize>,
    /// Marks that the next word gets instead of its own.
    marks: Option<Vec<Mark>>,
}

impl Written {
    fn numbers(&self, keys: &[Key]) -> Vec<u32> {
        keys.iter().filter_map(|key| self.keys.get(key).copied()).collect()
    }

    fn define(&mut self, numbers: &[u32], role: &str) {
        for number in numbers {
            if self.roles.get(number).is_none_or(String::is_empty) {
                self.roles.insert(*number, role.to_owned());
            }
        }
    }

    fn push(&mut self, item: &Item) {
        let mut item = item.clone();
        if let Some(marks) = self.marks.take() {
            item.marks = marks;
        }
        self.out.push(item);
    }

    /// `human 1 and human 2`, with the marks of what stood there.
    fn speak(&mut self, numbers: &[u32], at: &Item) {
        if self.out.last().is_some_and(|last| last.word.text == "the") && at.marks.is_empty() {
            self.out.pop();
        }
        let mut words = spoken(numbers, at);
        if let Some(first) = words.first_mut() {
            first.marks = self.marks.take().unwrap_or_else(|| at.marks.clone());
            (first.arrow, first.gap) = (at.arrow, at.gap.clone());
        }
        self.out.extend(words);
    }
}

/// `human 1 and human 2` at the place of a word.
fn spoken(numbers: &[u32], at: &Item) -> Vec<Item> {
    let mut words = Vec::new();
    for number in numbers {
        if !words.is_empty() {
            words.push(Item::said("and", at));
        }
        words.push(Item::said("human", at));
        words.push(Item::said(&number.to_string(), at));
    }
    words
}

impl Labels {
    fn write(&self, written: &mut Written) {
        let mut k = 0;
        while let Some(item) = self.items.0.get(k) {
            // `(1) doctor - same direction`
            if self.listed
                && let (Some(number), Some((name, end))) = (listed(&item.gap), role(&self.items, k))
            {
                let numbers = written.numbers(&[Key::Number(number)]);
                written.first.get_or_insert(written.out.len());
                written.define(&numbers, &name);
                written.speak(&numbers, item);
                written.marks = (!self.items.begins(end)).then(Vec::new);
                k = end;
            } else if let Some((keys, end)) = self.list(k) {
                written.first.get_or_insert(written.out.len());
                let numbers = written.numbers(&keys);
                k = self.label(written, &numbers, k, end);
            } else {
                written.push(item);
                k += 1;
            }
        }
    }

    /// Writes a list of labels, with what defines it; says where to read on.
    fn label(&self, written: &mut Written, numbers: &[u32], at: usize, end: usize) -> usize {
        let items = &self.items;
        let Some(item) = items.0.get(at) else { return end };
        let next = items.0.get(end);
        // `worker A`
        if end >= at + 2 && (self.letter(end - 1).is_some() && self.role_before(end - 1) || self.named(end - 1)) {
            let named = items.stem(end - 2);
            if lexicon().roles.get(named).is_some_and(|role| !role.generic) {
                written.define(numbers, named);
            }
        }
        // `guard (actor 1)`, `two dockers (actor 1, actor 2)`, `grp (A, B, C)`
        let inside = item.opens() && !item.closes() && next.is_none_or(Item::closes);
        if inside && written.inside(numbers, item) {
            written.marks = (!items.begins(end)).then(Vec::new);
            // `+ D`
            let more = (items.text(end) == "and").then(|| self.list(end + 1)).flatten();
            return match more.filter(|(_, to)| items.marked(*to)) {
                Some((_, to)) => {
                    written.marks = None;
                    to
                }
                None => end,
            };
        }
        if inside && written.out.last().is_some_and(|last| last.word.stem == "group") {
            return end;
        }
        let equal = next.is_some_and(Item::equals);
        let colon = items.has(end, Mark::Colon);
        if let Some((role, to)) = role(items, end) {
            let closes = items.marked(to);
            let gap = next.map_or("", |next| next.gap.as_str());
            let article = matches!(items.text(end), "a" | "an" | "both" | "all") || gap.contains(['-', '–', '—']);
            let apposed = items.has(end, Mark::Comma) && closes && article;
            let paren = next.is_some_and(Item::opens)
                && items.0.get(to).is_none_or(|item| item.closes() || item.gap.contains(','));
            let beside = gap == " " && closes && self.letter(end - 1).is_some() && self.noun_follows(end - 1);
            if equal || colon || paren || apposed || beside {
                written.define(numbers, &role);
                return self.defined(written, numbers, at, to, paren);
            }
        }
        written.speak(numbers, item);
        if colon || equal {
            written.marks = (!items.begins(end)).then(Vec::new);
        }
        end
    }

    /// Writes on behind a definition: `P1+P2 = workers, cross`, `actor 1 = patient, actor 2 = nurse`.
    fn defined(&self, written: &mut Written, numbers: &[u32], at: usize, to: usize, paren: bool) -> usize {
        let items = &self.items;
        let Some(item) = items.0.get(at) else { return to };
        // `patient with walking frame`
        let mut end = to;
        let mut tail: Vec<Item> = Vec::new();
        if !items.marked(to) && items.text(to) == "with" {
            end = items.mark(to).min(items.0.len());
            tail = items.0.get(to..end).unwrap_or_default().to_vec();
            if tail.iter().any(|item| item.word.stem == "robot") {
                (end, tail) = (to, Vec::new());
            }
            for item in &mut tail {
                item.word.label = true;
            }
        }
        let next = items.0.get(end);
        let another = self.list(end + usize::from(items.text(end) == "and")).is_some()
            || self.listed && next.is_some_and(|next| listed(&next.gap).is_some());
        if !paren && items.marked(end) && (items.begins(end) || another) {
            for item in &tail {
                written.push(item);
            }
            // A list of definitions is a sentence of its own.
            written.marks = Some(vec![Mark::Stop]);
            return end;
        }
        written.speak(numbers, item);
        for item in &tail {
            written.push(item);
        }
        let listed = another && next.is_some_and(|next| next.gap.contains(','));
        written.marks = if items.begins(end) {
            None
        } else if listed {
            Some(vec![Mark::Comma])
        } else {
            Some(Vec::new())
        };
        end
    }
}

impl Written {
    /// Puts labels in brackets in the place of the noun before them: `a guard (actor 1)`.
    fn inside(&mut self, numbers: &[u32], at: &Item) -> bool {
        let from = self.out.iter().rposition(|item| !item.marks.is_empty() || item.arrow).unwrap_or(0);
        let run: Vec<Word> = self.out.get(from..).unwrap_or_default().iter().map(|item| item.word.clone()).collect();
        let grouped = run.last().is_some_and(|word| word.stem == "group");
        let mut banded = false;
        let people = if grouped {
            // `standing grp`
            let adjective =
                |word: &Word| lexicon().adjectives.contains(&word.text) || matches!(word.text.as_str(), "a" | "the");
            let first = run.iter().rev().skip(1).take_while(|word| adjective(word)).count();
            Some((run.len() - 1 - first, run.len() - 1))
        } else {
            let found = mentions(&run)
                .into_iter()
                .rev()
                .find(|mention| !matches!(mention.who, Who::Same | Who::All | Who::Number(_)));
            if let Some(role) = found.as_ref().and_then(|mention| mention.role.clone()) {
                self.define(numbers, &role);
            }
            banded = found.as_ref().is_some_and(|mention| mention.group);
            found.map(|mention| (mention.from, mention.to))
        };
        let Some((first, last)) = people else { return false };
        let (first, last) = (from + first, from + last);
        let mut words = spoken(numbers, self.out.get(first).unwrap_or(at));
        if grouped {
            words.extend(["stand", "in", "a", "group"].map(|text| Item::said(text, at)));
        }
        if banded {
            words.extend(["in", "a", "group"].map(|text| Item::said(text, at)));
        }
        if let (Some(new), Some(old)) = (words.first_mut(), self.out.get(first)) {
            (new.marks, new.arrow, new.gap) = (old.marks.clone(), old.arrow, old.gap.clone());
            // `4 peds = standing grp (A, B, C)`
            if old.equals() {
                new.marks = vec![Mark::Stop];
            }
        }
        let _old: Vec<Item> = self.out.splice(first..=last, words).collect();
        true
    }

    /// The text, with a sentence that says who is there.
    fn finish(mut self) -> Items {
        let count = self.keys.values().copied().max().unwrap_or(0);
        let total = self.total(count);
        if let Some((_, _, role)) = &total
            && !self.roles.values().all(String::is_empty)
        {
            let all: Vec<u32> = (1..=count).collect();
            let role = role.clone();
            self.define(&all, &role);
        }
        let known = self.roles.values().any(|role| !role.is_empty());
        if !known {
            return Items(self.out);
        }
        let first = self.first.unwrap_or(0).min(self.out.len().saturating_sub(1));
        if let Some((from, to, _)) = total {
            let does = self.out.get(to + 1).is_some_and(|next| {
                next.marks.is_empty() && !next.equals() && lexicon().verbs.contains(&next.word.stem)
            });
            if does && let Some(at) = self.out.get(from).cloned() {
                let mut words = spoken(&(1..=count).collect::<Vec<u32>>(), &at);
                if let Some(word) = words.first_mut() {
                    (word.marks, word.arrow) = (at.marks.clone(), at.arrow);
                }
                let _old: Vec<Item> = self.out.splice(from..=to, words).collect();
            } else {
                for item in self.out.iter_mut().take(to + 1).skip(from) {
                    (item.word.label, item.word.used) = (true, true);
                }
            }
        }
        let mut items = Items(self.out);
        let start = items.start(first);
        let Some(at) = items.0.get(start).cloned() else { return items };
        let roles = (1..=count).map(|number| self.roles.get(&number).cloned().unwrap_or_default()).collect();
        let mut people = Item::said(if count == 1 { "person" } else { "people" }, &at);
        people.word.made_of = roles;
        let mut marks = vec![Mark::Stop];
        if let Some(next) = items.0.get_mut(start) {
            std::mem::swap(&mut next.marks, &mut marks);
        }
        if !marks.contains(&Mark::Stop) {
            marks.push(Mark::Stop);
        }
        let number = Item::said(&count.to_string(), &at).with(&marks);
        let _none: Vec<Item> = items.0.splice(start..start, [number, people]).collect();
        items
    }

    /// Where so many people are named as there are labels, with their role: `3 peds`, `two workers`.
    fn total(&self, count: u32) -> Option<(usize, usize, String)> {
        (0..self.out.len()).find_map(|from| {
            let number = self.out.get(from)?;
            let counts = number.word.count() == Some(count) && !number.word.used;
            if !counts {
                return None;
            }
            // `n=2`
            let sample =
                from > 0 && number.equals() && self.out.get(from - 1).is_some_and(|item| item.word.text == "n");
            let near =
                |(k, item): &(usize, &Item)| *k == 0 || item.marks.is_empty() && !item.equals() && !item.word.used;
            let words = self.out.iter().skip(from + 1).take(4).enumerate().take_while(near);
            let run: Vec<Word> = words.map(|(_, item)| item.word.clone()).collect();
            let end = noun(&run, 0, lexicon());
            // `pedestrians: 2`
            let before = from.checked_sub(1).and_then(|k| self.out.get(k)).filter(|noun| {
                let given = number.equals() || number.marks == [Mark::Colon];
                given && plural(&noun.word) && lexicon().roles.contains_key(&noun.word.stem)
            });
            if let Some(noun) = before.filter(|_| self.out.get(from + 1).is_none_or(|next| !next.marks.is_empty())) {
                let role =
                    lexicon().roles.get(&noun.word.stem).filter(|role| !role.generic).map(|_| noun.word.stem.clone());
                return Some((from - 1, from, role.unwrap_or_default()));
            }
            let of = self.out.get(from + 1).is_some_and(|item| !item.marks.is_empty());
            match end.filter(|_| !of) {
                Some(end) => {
                    let word = run.get(end)?;
                    let role = lexicon().roles.get(&word.stem).filter(|role| !role.generic).map(|_| word.stem.clone());
                    Some((from, from + 1 + end, role.unwrap_or_default()))
                }
                None => sample.then(|| (from - 1, from, String::new())),
            }
        })
    }
}
