//! Times of day, which count nobody: `at a quarter to eight`, `around half six`, `ten past two`, `at ten in the morning`.

use crate::lexicon::lexicon;
use crate::words::{Piece, Word, text_at, word_at};

/// Days of the week.
pub(crate) const WEEKDAYS: &[&str] = &["monday", "tuesday", "wednesday", "thursday", "friday", "saturday", "sunday"];
/// Months that are nothing else.
pub(crate) const MONTHS: &[&str] =
    &["january", "february", "april", "june", "july", "august", "september", "october", "november", "december"];
/// Months that are other words too: `two may stop`, `two march past`.
const DOUBTFUL_MONTHS: &[&str] = &["may", "march", "mar"];
const SHORT_MONTHS: &[&str] = &["jan", "feb", "apr", "jun", "jul", "aug", "sep", "sept", "oct", "nov", "dec"];
/// Words right before an hour.
const BEFORE: &[&str] = &["at", "around", "about", "by", "since", "until", "till", "before", "after", "past", "from"];
/// Words right after an hour.
const AFTER: &[&str] = &["am", "pm", "oclock", "sharp", "ish"];
/// Words after `in the` and the like that tell the time of day.
const DAY: &[&str] = &["morning", "afternoon", "evening", "night", "noon", "midnight", "day"];

/// Makes labels of the numbers and words that tell what time it is.
pub(crate) fn clock(pieces: &mut [Piece]) {
    let mut told = Vec::new();
    for at in 0..pieces.len() {
        let found = [minutes, hour, numeral, age, date].iter().find_map(|told| told(pieces, at));
        if let Some(to) = found {
            told.extend(at..to);
        }
    }
    for at in told {
        if let Some(Piece::Word(word)) = pieces.get_mut(at) {
            (word.label, word.used) = (true, true);
        }
    }
}

fn number(pieces: &[Piece], at: usize) -> Option<u32> {
    word_at(pieces, at).and_then(Word::count)
}

/// `a quarter to eight`, `ten past two`, `half past nine`, `half six`: where that ends.
fn minutes(pieces: &[Piece], at: usize) -> Option<usize> {
    let hour = |k: usize| number(pieces, k).is_some_and(|n| (1..=12).contains(&n));
    let part = matches!(text_at(pieces, at), "quarter" | "half");
    let some = number(pieces, at).is_some_and(|n| n < 30);
    let turned = |k: usize| matches!(text_at(pieces, k), "past" | "to");
    if (part || some) && turned(at + 1) && hour(at + 2) && ends(pieces, at + 3) {
        return Some(at + 3);
    }
    let half = text_at(pieces, at) == "half" && hour(at + 1) && ends(pieces, at + 2);
    half.then_some(at + 2)
}

/// `what went wrong on the 3rd`: where that ends.
fn numeral(pieces: &[Piece], at: usize) -> Option<usize> {
    let text = text_at(pieces, at);
    let numeral = text.starts_with(|c: char| c.is_ascii_digit()) && text.ends_with(|c: char| c.is_alphabetic());
    let on = at >= 2
        && text_at(pieces, at - 1) == "the"
        && matches!(text_at(pieces, at - 2), "on" | "since" | "until" | "by");
    let person = of_role(pieces, at + 1) || text_at(pieces, at + 1) == "one";
    (numeral && on && !person).then_some(at + 1)
}

/// `a girl, about six, …`: where that ends.
fn age(pieces: &[Piece], at: usize) -> Option<usize> {
    let about = at.checked_sub(1).filter(|k| *k > 1 && matches!(text_at(pieces, *k), "about" | "aged"))?;
    let aside = word_at(pieces, about - 1).is_none() && word_at(pieces, at + 1).is_none();
    (aside && of_role(pieces, about - 2) && number(pieces, at).is_some()).then_some(at + 1)
}

/// Whether a word for people stands at this place.
fn of_role(pieces: &[Piece], at: usize) -> bool {
    word_at(pieces, at).is_some_and(|word| lexicon().roles.contains_key(&word.stem))
}

/// `on 14 march`, `3rd of June`, `from May 2`: where that ends.
fn date(pieces: &[Piece], at: usize) -> Option<usize> {
    let doubtful = |k: usize| DOUBTFUL_MONTHS.contains(&text_at(pieces, k));
    let month = |k: usize| doubtful(k) || [MONTHS, SHORT_MONTHS].iter().any(|list| list.contains(&text_at(pieces, k)));
    let day = |k: usize| number(pieces, k).is_some_and(|n| (1..=31).contains(&n));
    let before = at.checked_sub(1).map_or("", |k| text_at(pieces, k));
    let dated = matches!(before, "on" | "of" | "by" | "since" | "until" | "till" | "from" | "before" | "the");
    let after = at + 1 + usize::from(text_at(pieces, at + 1) == "of");
    if day(at) && month(after) && (dated || !doubtful(after)) {
        return Some(after + 1);
    }
    (month(at) && day(at + 1) && (dated || !doubtful(at)) && ends(pieces, at + 2)).then_some(at + 2)
}

/// Whether nobody can be counted by the number before this place.
fn ends(pieces: &[Piece], at: usize) -> bool {
    word_at(pieces, at).is_none_or(|next| {
        !lexicon().roles.contains_key(&next.stem)
            && !matches!(next.stem.as_str(), "meter" | "second" | "minute" | "centimeter" | "hour" | "of" | "more")
            && (next.text != next.stem || !lexicon().verbs.contains(&next.stem))
    })
}

/// `at ten, …`, `four in the morning`, `around nine she comes`: where that ends.
fn hour(pieces: &[Piece], at: usize) -> Option<usize> {
    let n = number(pieces, at).filter(|n| (1..=12).contains(n) && text_at(pieces, at) != "one")?;
    let before = at.checked_sub(1).map_or("", |k| text_at(pieces, k));
    let day = matches!(text_at(pieces, at + 1), "in" | "at" | "this" | "every")
        && (at + 2..at + 4).any(|k| DAY.contains(&text_at(pieces, k)));
    if AFTER.contains(&text_at(pieces, at + 1)) || day {
        return Some(at + 1);
    }
    let closes = word_at(pieces, at + 1).is_none()
        || matches!(
            text_at(pieces, at + 1),
            "when"
                | "as"
                | "because"
                | "so"
                | "and"
                | "he"
                | "she"
                | "they"
                | "i"
                | "we"
                | "our"
                | "my"
                | "the"
                | "this"
        );
    // `after two, …` may be two of those who are there; `at ten` may not.
    let told = matches!(before, "at" | "around" | "past") || n > 6 && BEFORE.contains(&before);
    (told && closes).then_some(at + 1)
}
