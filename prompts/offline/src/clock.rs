//! Times of day, which count nobody: `at a quarter to eight`, `around half six`, `ten past two`, `at ten in the morning`.

use crate::lexicon::lexicon;
use crate::words::{Piece, Word, text_at, word_at};

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
        if let Some(to) = minutes(pieces, at).or_else(|| hour(pieces, at)).or_else(|| date(pieces, at)) {
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

/// `on 14 march`, `3rd of June`, `from May 2`: where that ends.
fn date(pieces: &[Piece], at: usize) -> Option<usize> {
    const MONTHS: &[&str] = &[
        "january",
        "february",
        "march",
        "april",
        "may",
        "june",
        "july",
        "august",
        "september",
        "october",
        "november",
        "december",
        "jan",
        "feb",
        "mar",
        "apr",
        "jun",
        "jul",
        "aug",
        "sep",
        "sept",
        "oct",
        "nov",
        "dec",
    ];
    let month = |k: usize| MONTHS.contains(&text_at(pieces, k));
    // `two may stop`, `two march past`
    let doubtful = |k: usize| matches!(text_at(pieces, k), "may" | "march" | "mar");
    let day = |k: usize| number(pieces, k).is_some_and(|n| (1..=31).contains(&n));
    // `what went wrong on the 3rd`
    let text = text_at(pieces, at);
    let numeral = text.starts_with(|c: char| c.is_ascii_digit()) && text.ends_with(|c: char| c.is_alphabetic());
    let on = at >= 2
        && text_at(pieces, at - 1) == "the"
        && matches!(text_at(pieces, at - 2), "on" | "since" | "until" | "by");
    let person =
        word_at(pieces, at + 1).is_some_and(|next| lexicon().roles.contains_key(&next.stem) || next.text == "one");
    if numeral && on && !person {
        return Some(at + 1);
    }
    // `a girl, about six, …`
    let aside = |k: Option<usize>| k.is_none_or(|k| word_at(pieces, k).is_none());
    let of_role = |k: usize| word_at(pieces, k).is_some_and(|word| lexicon().roles.contains_key(&word.stem));
    let about = at.checked_sub(1).filter(|k| matches!(text_at(pieces, *k), "about" | "aged"));
    if about.is_some_and(|k| k > 1 && aside(k.checked_sub(1)) && of_role(k - 2))
        && number(pieces, at).is_some()
        && aside(Some(at + 1))
    {
        return Some(at + 1);
    }
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
