//! Finds the row whose pattern matches the most chunks from a place on.

use crate::chunk::{Amount, Chunk, Is};
use crate::noun::Noun;
use crate::pattern::{AMOUNT, Part, Pattern, Patterns};
use crate::token::{Bent, OWNS, Sort};
use socrates_model::PlaceClass;

/// A row that matches, and what it took.
#[derive(Debug, Clone, Default)]
pub(crate) struct Found {
    /// Number of the row.
    pub(crate) row: usize,
    /// The chunk behind it.
    pub(crate) end: usize,
    /// To whom it is done.
    pub(crate) object: Option<Noun>,
    /// Whose way, head or side it is.
    pub(crate) owner: Option<Noun>,
    /// A place in it, and its chunk.
    pub(crate) place: Option<(Option<PlaceClass>, usize)>,
    /// A distance or time in it, and its chunk.
    pub(crate) amount: Option<(Amount, usize)>,
    /// Adverbs that stand within it.
    pub(crate) between: Vec<usize>,
    /// Whether it stands in the passive, with its object before it.
    pub(crate) passive: bool,
}

/// Words that may stand between two parts of a pattern.
const BETWEEN: usize = 2;

/// The longest match of some patterns at a chunk.
pub(crate) fn longest(chunks: &[Chunk], at: usize, patterns: &Patterns) -> Option<Found> {
    let first = chunks.get(at)?;
    let (lemma, text) = match first.is {
        Is::Mark(_) | Is::Noun(_) | Is::Whose(_) => return None,
        Is::Amount(_) => (AMOUNT, AMOUNT),
        // A short `is`, or `has`.
        Is::Word if first.spelled == OWNS => ("be", "have"),
        Is::Word | Is::Place(_) => (first.lemma.as_str(), first.spelled.as_str()),
    };
    let be = |back: usize| {
        at.checked_sub(back).and_then(|before| chunks.get(before)).is_some_and(|before| before.word(Sort::Be))
    };
    let by = chunks.get(at + 1).is_some_and(|next| next.word(Sort::By));
    let passive = first.bent == Bent::Ed && (by || be(1) || be(2));
    let of_lemma = patterns.beginning(lemma);
    let of_text = patterns.beginning(text).filter(|_| text != lemma);
    of_lemma
        .chain(of_text)
        .filter_map(|pattern| {
            let in_passive = if passive { matched(chunks, at, pattern, true) } else { None };
            in_passive.or_else(|| matched(chunks, at, pattern, false))
        })
        .max_by_key(|found| (found.end - found.between.len(), found.passive, std::cmp::Reverse(found.row)))
}

fn matched(chunks: &[Chunk], at: usize, pattern: &Pattern, passive: bool) -> Option<Found> {
    let mut found = Found { row: pattern.row, end: at, passive, ..Found::default() };
    for (number, slot) in pattern.slots.iter().enumerate() {
        let object = matches!(slot.part, Part::Anybody | Part::Robot | Part::Person);
        if passive && number == 1 {
            // The object stands before the verb: `is overtaken by`.
            if !object {
                return None;
            }
            continue;
        }
        if takes(chunks, &slot.part, &mut found) {
            continue;
        }
        let start = found.end;
        let mut skipped = false;
        if number > 0 {
            for _ in 0..BETWEEN {
                if !chunks.get(found.end).is_some_and(may_stand_between) {
                    break;
                }
                found.between.push(found.end);
                found.end += 1;
                if takes(chunks, &slot.part, &mut found) {
                    skipped = true;
                    break;
                }
            }
        }
        if !skipped {
            found.between.retain(|between| *between < start);
            found.end = start;
            if !slot.optional {
                return None;
            }
        }
    }
    if passive && pattern.slots.len() < 2 { None } else { Some(found) }
}

fn takes(chunks: &[Chunk], part: &Part, found: &mut Found) -> bool {
    let Some(chunk) = chunks.get(found.end) else { return false };
    let fits = match (part, &chunk.is) {
        (Part::Word(words), Is::Word | Is::Place(_)) => {
            // `moves after the robot has stopped` is no `after the robot`.
            let next = chunks.get(found.end + 2);
            let finite = next.is_some_and(|next| {
                [Sort::Have, Sort::Be, Sort::Modal].iter().any(|sort| next.word(*sort))
                    || next.word(Sort::Verb) && next.bent == Bent::S
            });
            let noun = chunks.get(found.end + 1).is_some_and(|next| next.noun().is_some());
            if chunk.word(Sort::After) && noun && finite {
                return false;
            }
            let short = chunk.spelled == OWNS && ["be", "have"].iter().any(|word| words.contains(*word));
            (words.contains(&chunk.lemma) || words.contains(&chunk.spelled) || short) && chunk.tokens.len() == 1
        }
        (Part::Anybody | Part::Robot | Part::Person, Is::Noun(noun)) if noun.nominative => false,
        (Part::Anybody, Is::Noun(noun)) => {
            found.object = Some(noun.clone());
            true
        }
        (Part::Robot, Is::Noun(noun)) if noun.may_be_robot() => {
            found.object = Some(noun.clone());
            true
        }
        (Part::Person, Is::Noun(noun)) if noun.may_be_person() => {
            found.object = Some(noun.clone());
            true
        }
        (Part::Somebody, Is::Noun(_)) => true,
        (Part::Whose, Is::Whose(noun)) => {
            found.owner = Some(noun.clone());
            true
        }
        (Part::Place, Is::Place(class)) => {
            found.place = Some((*class, found.end));
            true
        }
        (Part::Amount, Is::Amount(amount)) => {
            found.amount = Some((*amount, found.end));
            true
        }
        _ => false,
    };
    found.end += usize::from(fits);
    fits
}

/// Articles, possessives and adverbs; never a word that joins, or denies.
fn may_stand_between(chunk: &Chunk) -> bool {
    let joins = [
        Sort::Not,
        Sort::To,
        Sort::Of,
        Sort::By,
        Sort::At,
        Sort::From,
        Sort::With,
        Sort::And,
        Sort::But,
        Sort::Who,
        Sort::When,
        Sort::While,
        Sort::Until,
        Sort::Before,
        Sort::After,
        Sort::Particle,
    ];
    match &chunk.is {
        Is::Whose(_) => true,
        Is::Word => {
            let says = [Sort::Fill, Sort::Definite, Sort::Indefinite, Sort::Slow, Sort::Brisk, Sort::Looks];
            (says.iter().any(|sort| chunk.sorts.has(*sort)) || chunk.spelled.ends_with("ly"))
                && !joins.iter().any(|sort| chunk.sorts.has(*sort))
        }
        Is::Noun(_) | Is::Place(_) | Is::Amount(_) | Is::Mark(_) => false,
    }
}
