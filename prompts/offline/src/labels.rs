//! Which words of notes are labels of people: `ped A`, `actor 1`, `P1+P2`, `E1`, `#1`, `(2)`, `A-C`.

use std::collections::{BTreeMap, BTreeSet};

use crate::lexicon::lexicon;
use crate::notes::{Item, Items, Mark};
use crate::noun::{band, noun, plural, stranger};

/// What a label is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Key {
    Number(u32),
    /// `E1`, `w2`.
    Code(char, u32),
    Letter(char),
}

/// Words before a number or a letter that make it somebody's label.
pub(crate) const GENERIC: &[&str] = &[
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
pub(crate) struct Labels {
    pub(crate) items: Items,
    letters: BTreeSet<char>,
    /// First letters of `E1`, `w2`.
    families: BTreeSet<char>,
    /// `#1`, `(2)`.
    tags: bool,
    /// `(1) doctor; (2) nurse`.
    pub(crate) listed: bool,
}

/// The role that a run of words names, and the place after it: `a forklift driver`, `both workers`.
pub(crate) fn role(items: &Items, from: usize) -> Option<(String, usize)> {
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
    // A word that nobody knows, alone, where only a role can stand: `actor 1 (docker)`.
    let bracketed = items.0.get(from).is_some_and(|item| item.opens() || item.equals());
    let alone = || {
        let word = run.first().filter(|_| run.len() == 1 && bracketed)?;
        let quality = ["ic", "al", "ous", "ive", "ary", "ing", "ed", "ly"].iter().any(|end| word.text.ends_with(end));
        (word.text.len() >= 4 && !quality && !lex.has(word)).then_some(0)
    };
    let end = noun(&run, 0, lex).or_else(|| stranger(&run, 0, true, lex)).or_else(alone)?;
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
    pub(crate) fn of(items: Items) -> Self {
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
        // `A nurse, B+C visitors. A gets out`
        let first = |k: &usize| labels.letter(*k) == Some('A') && labels.free(*k) && labels.acts(*k);
        if labels.letters.contains(&'B') && (0..count).any(|k| first(&k)) {
            labels.letters.insert('A');
        }
        labels
    }

    /// A capital letter alone.
    pub(crate) fn letter(&self, at: usize) -> Option<char> {
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
    pub(crate) fn named(&self, at: usize) -> bool {
        let beside = self.items.0.get(at).is_some_and(|item| item.gap == " " && item.word.capital);
        at > 0 && beside && self.role_at(at - 1) && self.items.word(at - 1).is_some_and(|word| !plural(word))
    }

    fn generic(&self, at: usize) -> bool {
        at > 0 && !self.items.marked(at) && (GENERIC.contains(&self.items.stem(at - 1)))
    }

    /// `worker A`.
    pub(crate) fn role_before(&self, at: usize) -> bool {
        at > 0
            && !self.items.marked(at)
            && self.items.0.get(at).is_some_and(|item| item.gap == " ")
            && self.items.word(at - 1).is_some_and(|word| {
                lexicon().roles.contains_key(&word.stem) && !plural(word) && !lexicon().labels.contains(&word.stem)
            })
            && (self.letter(at) != Some('A') || !self.noun_follows(at))
    }

    pub(crate) fn noun_follows(&self, at: usize) -> bool {
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
        let article = letter == 'A' && !self.items.marked(at + 1) && !joined && !self.acts(at) && !self.juxtaposed(at);
        (!article).then_some((Key::Letter(letter), at + 1))
    }

    /// Whether somebody does something behind a letter: `A stops`, `A when out`.
    fn acts(&self, at: usize) -> bool {
        const SMALL: &[&str] = &[
            "and", "when", "is", "does", "then", "only", "in", "on", "at", "must", "should", "will", "never", "just",
            "after", "if", "to", "from",
        ];
        let next = self.items.word(at + 1).filter(|_| !self.items.marked(at + 1));
        next.is_some_and(|next| {
            let finite = next.text != next.stem && next.text.ends_with('s');
            lexicon().verbs.contains(&next.stem) && finite || SMALL.contains(&next.text.as_str())
        })
    }

    /// `A nurse, B+C visitors`.
    fn juxtaposed(&self, at: usize) -> bool {
        let of =
            |k: usize| self.noun_follows(k) && role(&self.items, k + 1).is_some_and(|(_, end)| self.items.marked(end));
        let other = |k: usize| self.letter(k).is_some_and(|letter| letter != 'A' && self.letters.contains(&letter));
        of(at) && (0..self.items.0.len()).any(|k| k != at && other(k) && of(k))
    }

    /// Labels in a row: `A, B and C`, `P1+P2`, `A-C`.
    pub(crate) fn list(&self, at: usize) -> Option<(Vec<Key>, usize)> {
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
    pub(crate) fn keys(&self) -> BTreeMap<Key, u32> {
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
pub(crate) fn listed(gap: &str) -> Option<u32> {
    let inner = gap.trim_end().strip_suffix(')')?;
    inner.rsplit_once('(')?.1.parse().ok().filter(|n| (1..=9).contains(n))
}
