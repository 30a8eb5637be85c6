//! Pass 3: tokens to chunks: noun phrases, places, amounts, and the words between them.

use std::collections::BTreeMap;
use std::fmt;
use std::ops::Range;

use socrates_model::PlaceClass;

use crate::lexicon::Lexicon;
use crate::normalize::end_of;
use crate::noun::{Head, Noun};
use crate::phrase::noun;
use crate::token::{Bent, Kind, Mark, OWNS, Sort, Sorts, Token};

/// A distance, a time or a speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Amount {
    /// m.
    Distance(f64),
    /// s.
    Time(f64),
    /// m/s.
    Speed(f64),
}

/// What a chunk is.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Is {
    /// People, or the robot.
    Noun(Noun),
    /// A possessor: `the robot's`, `its`.
    Whose(Noun),
    /// A place; none: one that no map holds.
    Place(Option<PlaceClass>),
    Amount(Amount),
    Mark(Mark),
    Word,
}

/// A piece of a sentence.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Chunk {
    pub(crate) is: Is,
    /// Its tokens.
    pub(crate) tokens: Range<usize>,
    /// Base form, of a word.
    pub(crate) lemma: String,
    /// As written, of a word.
    pub(crate) spelled: String,
    pub(crate) sorts: Sorts,
    pub(crate) bent: Bent,
}

impl Chunk {
    pub(crate) fn word(&self, sort: Sort) -> bool {
        self.is == Is::Word && self.sorts.has(sort)
    }

    pub(crate) fn noun(&self) -> Option<&Noun> {
        if let Is::Noun(noun) = &self.is { Some(noun) } else { None }
    }

    pub(crate) fn is_mark(&self, mark: Mark) -> bool {
        self.is == Is::Mark(mark)
    }
}

impl fmt::Display for Chunk {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.is {
            Is::Noun(noun) => write!(f, "[{noun}]"),
            Is::Whose(noun) => write!(f, "[{noun}]'s"),
            Is::Place(class) => write!(f, "[place {}]", class.map_or("nowhere", |class| class.name())),
            Is::Amount(Amount::Distance(m)) => write!(f, "[{m} m]"),
            Is::Amount(Amount::Time(secs)) => write!(f, "[{secs} s]"),
            Is::Amount(Amount::Speed(mps)) => write!(f, "[{mps} m/s]"),
            Is::Mark(mark) => write!(f, "<{mark:?}>"),
            Is::Word => f.write_str(&self.lemma),
        }
    }
}

/// The chunks of a text.
pub(crate) fn chunks(tokens: &[Token], lexicon: &Lexicon) -> Vec<Chunk> {
    let mut found = Vec::new();
    let mut at = 0;
    let mut named = BTreeMap::new();
    while let Some(token) = tokens.get(at) {
        let (mut is, end) = chunk(tokens, at, lexicon);
        // `the lobby`, of the elevator lobby that was named before.
        if let (Is::Place(class), Some(last)) = (&mut is, end.checked_sub(1).and_then(|last| tokens.get(last))) {
            let said = tokens.get(at..end).unwrap_or_default().iter().filter(|token| !token.says_nothing()).count();
            match named.get(&last.lemma) {
                Some(known) if said == 1 && token.is(Sort::Definite) => *class = *known,
                Some(_) | None if said > 1 => {
                    named.insert(last.lemma.clone(), *class);
                }
                Some(_) | None => {}
            }
        }
        // `some room` may be room to pass: the article stands alone.
        let (is, end) =
            if matches!(is, Is::Place(_)) && token.is(Sort::Indefinite) { (Is::Word, at + 1) } else { (is, end) };
        found.push(Chunk {
            is,
            tokens: at..end,
            lemma: token.lemma.clone(),
            spelled: token.spelled.clone(),
            sorts: token.sorts,
            bent: token.bent,
        });
        at = end;
    }
    found
}

fn chunk(tokens: &[Token], at: usize, lexicon: &Lexicon) -> (Is, usize) {
    let Some(token) = tokens.get(at) else { return (Is::Word, at + 1) };
    if let Kind::Mark(mark) = token.kind {
        return (Is::Mark(mark), at + 1);
    }
    if let Some((amount, end)) = amount(tokens, at, lexicon) {
        return (Is::Amount(amount), end);
    }
    // `a patient, crossing at the junction` crosses.
    let before = at.checked_sub(1).and_then(|at| tokens.get(at));
    let acts = token.bent == Bent::Ing
        && token.is(Sort::Verb)
        && before
            .is_some_and(|before| !before.is(Sort::Definite) && !before.is(Sort::At) && !before.is_mark(Mark::Stop));
    // `a few people exit`
    let people = |before: &Token| before.is(Sort::People) || before.is(Sort::Role) && before.bent == Bent::S;
    let does = token.bent == Bent::Base && token.is(Sort::Verb) && before.is_some_and(people);
    let place = place(tokens, at, lexicon).filter(|(_, end)| *end > at + 1 || !does).filter(|(_, end)| {
        let more = tokens.get(at + 1).is_some_and(|next| next.spelled.len() > 1 && next.number().is_none());
        !acts || *end > at + 1 && more
    });
    // `the robot guides a visitor` tells of no guides.
    let one = |token: &Token| token.is(Sort::Robot) || token.is(Sort::Role) && token.bent == Bent::Base;
    let object = tokens.get(at + 1).is_some_and(|next| next.is(Sort::Indefinite) || next.is(Sort::Definite));
    let acts = token.bent == Bent::S && (token.is(Sort::Verb) || object) && before.is_some_and(one);
    if let Some(noun) = noun(tokens, at, lexicon).filter(|_| !acts) {
        let end = noun.tokens.end;
        if place.is_none_or(|(_, place_end)| place_end < end) {
            return if owns(tokens, end) { (Is::Whose(noun), end + 1) } else { (Is::Noun(noun), end) };
        }
    }
    if let Some((class, end)) = place {
        return (Is::Place(class), end);
    }
    if token.is(Sort::Possessive) {
        let head = if token.is(Sort::He) {
            Head::He
        } else if token.spelled == "their" {
            Head::They
        } else {
            Head::It
        };
        let head = if token.spelled == "his" { Head::He } else { head };
        return (Is::Whose(Noun::new(head, at..at + 1)), at + 1);
    }
    // `rack 12`, `shift 2`: the number is a name.
    let named = token.is(Sort::Label)
        && tokens.get(at + 1).is_some_and(|next| next.number().is_some())
        && amount(tokens, at + 1, lexicon).is_none();
    let more = if named { 1 + and_number(tokens, at + 2, lexicon) } else { 0 };
    (Is::Word, at + 1 + more)
}

/// Tokens of `and 8`, behind `between racks 7`.
fn and_number(tokens: &[Token], at: usize, lexicon: &Lexicon) -> usize {
    let and = tokens.get(at).is_some_and(|token| token.is(Sort::And));
    let number = tokens.get(at + 1).is_some_and(|token| token.number().is_some());
    if and && number && amount(tokens, at + 1, lexicon).is_none() { 2 } else { 0 }
}

/// Whether `'s` makes a possessor of what stands before it, and is no short `is`.
fn owns(tokens: &[Token], at: usize) -> bool {
    let ends = tokens.get(at).is_some_and(|token| token.spelled == OWNS);
    let next = tokens.get(at + 1);
    let is = |next: &Token| {
        next.bent == Bent::Ing && next.is(Sort::Verb)
            || next.is(Sort::Not)
            || next.is(Sort::Indefinite)
            || next.is(Sort::At)
            || next.is(Sort::Definite)
            || next.number().is_some()
            || next.is(Sort::Fill)
                && tokens.get(at + 2).is_some_and(|behind| behind.is(Sort::At) || behind.number().is_some())
    };
    ends && next.is_some_and(|next| !is(next))
}

/// `2 m`, `half a meter`, `five seconds`.
fn amount(tokens: &[Token], at: usize, lexicon: &Lexicon) -> Option<(Amount, usize)> {
    let words = &lexicon.words;
    let token = tokens.get(at)?;
    let number = token.number().or_else(|| words.numbers.get(&token.lemma).map(|number| f64::from(*number)));
    let (number, mut end) = match number {
        Some(number) => (number, at + 1),
        None if token.is(Sort::Indefinite)
            && tokens.get(at + 1).is_some_and(|next| {
                let secs = words.seconds.contains_key(&next.lemma) && !words.ordinals.contains_key(&next.lemma);
                words.meters.contains_key(&next.lemma) || secs
            }) =>
        {
            (1.0, at + 1)
        }
        None if token.lemma == "half" && tokens.get(at + 1).is_some_and(|next| next.is(Sort::Indefinite)) => {
            (0.5, at + 2)
        }
        None => return None,
    };
    // `two and a half meters`, `1.5 or so`.
    let half = |at: usize, lemma: &str| tokens.get(at).is_some_and(|token| token.lemma == lemma);
    let mut number = number;
    if half(end, "and") && half(end + 2, "half") {
        (number, end) = (number + 0.5, end + 3);
    }
    let unit = tokens.get(end)?;
    if let Some(m) = words.meters.get(&unit.lemma) {
        // `a meter and a half`
        let more = half(end + 1, "and") && half(end + 3, "half");
        let number = if more { number + 0.5 } else { number };
        // `0.6 m/s`, `0.6 meters per second`
        let (stroke, per) = (end + 1, end + 1 + usize::from(half(end + 1, "per")));
        let second = |at: usize| tokens.get(at).and_then(|token| words.seconds.get(&token.lemma)).copied();
        let touch = tokens.get(stroke).is_some_and(|next| next.at.start == unit.at.end + 1);
        if let Some(secs) = second(per).filter(|secs| (per > stroke || touch) && *secs > 0.0) {
            return Some((Amount::Speed(number * m / secs), per + 1));
        }
        return Some((Amount::Distance((number * m * 1000.0).round() / 1000.0), end + 1 + 3 * usize::from(more)));
    }
    words.seconds.get(&unit.lemma).map(|secs| (Amount::Time(number * secs), end + 1))
}

/// A place with what belongs to its name: `the narrow aisle`, `room 214`.
pub(crate) fn place(tokens: &[Token], at: usize, lexicon: &Lexicon) -> Option<(Option<PlaceClass>, usize)> {
    let mut start = at;
    while tokens.get(start).is_some_and(|token| {
        token.is(Sort::Indefinite)
            || token.is(Sort::Definite)
            || token.is(Sort::Possessive) && start == at
            || token.is(Sort::Looks)
            || start > at && token.sorts.is_empty() && token.is_said() && token.bent == Bent::Base && start < at + 3
    }) && start < at + 4
    {
        start += 1;
    }
    let longest = |start: usize| {
        let first = tokens.get(start).filter(|token| token.is_said())?;
        let patterns = &lexicon.place_patterns;
        let of_text = patterns.beginning(&first.spelled).filter(|_| first.spelled != first.lemma);
        patterns
            .beginning(&first.lemma)
            .chain(of_text)
            .filter_map(|pattern| Some((end_of(tokens, start, pattern)?, pattern.row)))
            .max_by_key(|(end, row)| (*end, std::cmp::Reverse(*row)))
    };
    // The longest, and of those that end together the one that begins first: `narrow passage`.
    let found = (at..=start).filter_map(|start| longest(start).map(|(end, row)| (end, std::cmp::Reverse(start), row)));
    let (mut end, _, mut row) = found.max_by_key(|(end, start, row)| (*end, *start, std::cmp::Reverse(*row)))?;
    // `ward corridor`: the last word says what it is.
    while let Some((next, of)) = longest(end).filter(|_| tokens.get(end).is_some_and(|token| token.bent != Bent::Ing)) {
        (end, row) = (next, of);
    }
    // `the door of the meeting room` is a door.
    if tokens.get(end).is_some_and(|token| token.is(Sort::Of)) {
        let article = tokens.get(end + 1).is_some_and(|token| token.is(Sort::Definite) || token.is(Sort::Indefinite));
        end = longest(end + 1 + usize::from(article)).map_or(end, |(of, _)| of);
    }
    // `room 214`, `ward B`.
    let named = |token: &Token| {
        token.number().is_some() || token.spelled.len() == 1 && token.sorts.is_empty() && token.kind == Kind::Word
    };
    let unit = |token: Option<&Token>| {
        token.is_some_and(|token| {
            lexicon.words.meters.contains_key(&token.lemma) || lexicon.words.seconds.contains_key(&token.lemma)
        })
    };
    if tokens.get(end).is_some_and(named) && !unit(tokens.get(end + 1)) {
        end += 1 + and_number(tokens, end + 1, lexicon);
    }
    Some((lexicon.places.get(row)?.class, end))
}
