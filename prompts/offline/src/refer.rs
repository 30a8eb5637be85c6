//! Mentions that lean on others (`the other one`, `the second`), and mentions of several as one (`a group of four`).

use crate::lexicon::Lexicon;
use crate::mention::{Mention, Who};
use crate::noun::{band, noun, plural, thing};
use crate::words::Word;

/// `another …`, `the other …`, `the rest`, `the first …`.
pub(crate) fn others(
    words: &[Word],
    at: usize,
    lex: &Lexicon,
    role: &dyn Fn(usize) -> Option<String>,
) -> Option<Mention> {
    let text = |k: usize| words.get(k).map_or("", |word| word.text.as_str());
    let made = |who: Who, role: Option<String>, to: usize| {
        Some(Mention { who, role, word: String::new(), group: false, parts: 1, from: at, to })
    };
    let that = text(at) == "that" && matches!(text(at + 1), "last" | "first" | "second" | "third");
    let the = usize::from(that || matches!(text(at), "the" | "each"));
    // `each other` and `one after the other` are nobody new.
    let before = if at == 0 { "" } else { text(at - 1) };
    let manner = text(at) == "other" && before == "no"
        || text(at) == "each" && text(at + 1) == "other"
        || text(at) == "other"
            && (before == "each" || before == "the" && at > 1 && matches!(text(at - 2), "after" | "behind" | "to"))
        || text(at) == "the" && text(at + 1) == "other" && matches!(before, "after" | "behind" | "on")
        // `from one side to the other`
        || text(at) == "the"
            && text(at + 1) == "other"
            && before == "to"
            && at > 2
            && matches!(text(at - 2), "side" | "end" | "wall");
    if manner {
        return None;
    }
    let count = |k: usize| words.get(k).and_then(Word::count);
    match text(at + the) {
        // `one after another` is a manner, nobody new.
        "another" if at > 0 && matches!(text(at - 1), "after" | "to" | "from") => None,
        "another" => {
            let unit =
                words.get(at + 2).is_some_and(|word| matches!(word.stem.as_str(), "second" | "meter" | "minute"));
            if unit && count(at + 1).is_some() {
                return None;
            }
            let several = count(at + 1).filter(|n| *n > 0 && text(at + 1) != "one");
            let start = at + 1 + usize::from(several.is_some() || text(at + 1) == "one");
            let end = noun(words, start, lex).or_else(|| if thing(words, start) { None } else { Some(start - 1) })?;
            let one = if end < start && several.is_none() { "one" } else { "" };
            let mention = made(Who::More(several.unwrap_or(1)), role(end), end);
            mention.map(|mention| Mention { word: one.to_owned(), ..mention })
        }
        "others" | "rest" | "remaining" => {
            let several = count(at + the + 1);
            let mut end = noun(words, at + the + 1 + usize::from(several.is_some()), lex)
                .unwrap_or_else(|| at + the + usize::from(several.is_some()));
            if text(end + 1) == "of" && matches!(text(end + 2), "them") {
                end += 2;
            }
            let single = text(at + the) == "remaining" && !words.get(end).is_some_and(plural);
            made(Who::Other(several.or(if single { Some(1) } else { None })), None, end)
        }
        "other" if text(at + the + 1) == "half" => made(Who::Other(None), None, at + the + 1),
        "other" => {
            let several = count(at + the + 1);
            let start = at + the + 1 + usize::from(several.is_some());
            match noun(words, start, lex) {
                Some(end) if several.is_none() && words.get(end).is_some_and(plural) => {
                    made(Who::Other(None), role(end), end)
                }
                Some(end) => made(Who::Other(Some(several.unwrap_or(1))), role(end), end),
                None if thing(words, start) => None,
                None => made(Who::Other(Some(several.unwrap_or(1))), None, start - 1),
            }
        }
        word if the == 1 || lex.ordinals.contains_key(word) => {
            let named = |word: &str| match word {
                "last" | "latter" => Some(0),
                "former" => Some(1),
                _ => None,
            };
            let number = lex.ordinals.get(word).copied().or_else(|| named(word))?;
            // `the first two`, `the last two of them`
            if (the == 1 || at == 0)
                && number <= 1
                && word != "former"
                && word != "latter"
                && let Some(some) = count(at + the + 1).filter(|some| *some > 1)
                && !words.get(at + the + 2).is_some_and(|word| {
                    matches!(word.stem.as_str(), "meter" | "second" | "minute" | "centimeter" | "hour" | "time")
                })
            {
                let of = text(at + the + 2) == "of" && matches!(text(at + the + 3), "them" | "these" | "those");
                let last = if of { at + the + 3 } else { at + the + 1 };
                // `the first four of them patients`
                let named = noun(words, last + 1, lex);
                let role = named.and_then(role);
                return made(Who::Some { first: number == 1, count: some }, role, named.unwrap_or(last));
            }
            let start = at + the + 1 + usize::from(text(at + the + 1) == "one");
            // `the last of them`
            if text(start) == "of" && matches!(text(start + 1), "them" | "these" | "those") {
                return made(Who::Ordinal(number), None, start + 1);
            }
            if text(start) == "of"
                && let Some(of) = count(start + 1).filter(|of| *of >= number.max(1))
                && let Some(end) = noun(words, start + 2, lex)
            {
                return made(Who::OrdinalOf { number, count: of }, role(end), end);
            }
            let end = noun(words, start, lex).unwrap_or(start - 1);
            // `First waits, second looks`, where people leave articles out.
            let verb = words.get(start).is_some_and(|word| lex.verbs.contains(&word.stem) && at == 0);
            let bare = end == at + the && (the == 0 && !verb || thing(words, start));
            if bare {
                None
            } else if matches!(word, "former" | "latter") {
                let mention = made(Who::Ordinal(number), None, end);
                mention.map(|mention| Mention { word: word.to_owned(), ..mention })
            } else {
                made(Who::Ordinal(number), role(end), end)
            }
        }
        _ => None,
    }
}

/// `a group of four nurses`, `the pair`, `two groups of three`; `in a group` is a manner and nobody.
pub(crate) fn group(
    words: &[Word],
    at: usize,
    group: usize,
    count: Option<u32>,
    the: bool,
    lex: &Lexicon,
    role: &dyn Fn(usize) -> Option<String>,
) -> Option<Mention> {
    let text = |k: usize| words.get(k).map_or("", |word| word.text.as_str());
    // `in a group` says how people stand; it is not a mention of its own.
    let lead = (1..=3).filter_map(|back| group.checked_sub(back)).map(&text).find(|word| {
        !matches!(
            *word,
            "a" | "the" | "one" | "same" | "small" | "large" | "big" | "tight" | "loose" | "single" | "close"
        )
    });
    let in_a = matches!(lead, Some("in" | "as" | "form" | "forms" | "are" | "make" | "be" | "forming" | "into"))
        && text(group + 1) != "of";
    if in_a || words.get(group).is_some_and(|word| word.stem == "circle") {
        return None;
    }
    // `a group consisting of a doctor and two students` is those whom it lists.
    if matches!(text(group + 1), "consisting" | "comprising" | "composed" | "made") {
        return None;
    }
    let listed = text(group + 1) == "of";
    let inner = if listed { words.get(group + 2).and_then(Word::count) } else { None };
    let start = group + 1 + usize::from(listed) + usize::from(inner.is_some());
    let noun = if listed { noun(words, start, lex) } else { None };
    let end = noun.unwrap_or(start - 1);
    let role = noun.and_then(role);
    let pair = band(words, group).and_then(|(_, count)| *count);
    let who = if the && inner.is_none() {
        Who::Definite { plural: true, count: pair }
    } else {
        Who::New { count: inner.or(pair).or_else(|| count.filter(|_| !listed)), article: true }
    };
    // `two groups of three` are six people.
    let parts = count.filter(|n| (2..=8).contains(n) && listed && inner.is_some()).unwrap_or(1);
    let who = if let Who::New { count: Some(n), article } = who {
        Who::New { count: Some(n.saturating_mul(parts)), article: article && parts == 1 }
    } else {
        who
    };
    let lined = matches!(text(group), "queue" | "line" | "row");
    Some(Mention { who, role, word: String::new(), group: !lined, parts, from: at, to: end })
}

/// `he is a doctor`, `they are friends`: the same people by another word.
pub(crate) fn predicate(words: &[Word], mention: Mention, before: &[Mention]) -> Mention {
    let is = mention.from.checked_sub(1).and_then(|at| words.get(at));
    let is = is.is_some_and(|word| word.stem == "be" || word.text == "am");
    let subject = before.last().filter(|last| is && last.to + 2 == mention.from);
    match (subject, &mention.who) {
        // `he is one of our pickers`
        (Some(subject), Who::PartOf(1) | Who::PartOfNew(1, _)) if subject.who == Who::Same => {
            Mention { who: Who::Same, ..mention }
        }
        // `she is the only one who looks`
        (Some(subject), Who::ToldApart) if subject.who != Who::Nobody => {
            Mention { who: if subject.who == Who::All { Who::All } else { Who::Same }, ..mention }
        }
        (Some(subject), Who::New { .. }) if subject.who != Who::Nobody => {
            let many = matches!(subject.who, Who::All | Who::AllOf(_) | Who::New { count: None | Some(2..), .. });
            if let (Who::All, Who::New { count: Some(n @ 2..), .. }) = (&subject.who, &mention.who) {
                return Mention { who: Who::AllOf(*n), ..mention };
            }
            Mention { who: if many { Who::All } else { Who::Same }, ..mention }
        }
        _ => mention,
    }
}
