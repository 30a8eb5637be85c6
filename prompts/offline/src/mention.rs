//! Mentions: the stretches of a clause that speak of people.

use crate::lexicon::{Item, Lexicon, lexicon};
use crate::noun::{band, noun, plural, stranger, thing};
use crate::numbered::numbered;
use crate::refer::{group, others, predicate};
pub(crate) use crate::who::Who;
use crate::words::Word;

/// Words behind `her` that are nothing of hers: `follows her along the corridor`.
const NO_NOUNS: &[&str] = &[
    "to",
    "at",
    "in",
    "into",
    "on",
    "through",
    "along",
    "and",
    "from",
    "by",
    "until",
    "for",
    "past",
    "like",
    "wherever",
    "everywhere",
    "throughout",
    "around",
    "all",
    "there",
    "after",
    "again",
    "if",
    "as",
    "or",
    "closely",
    "when",
    "while",
    "without",
    "but",
    "robot",
];

/// One mention.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Mention {
    pub(crate) who: Who,
    /// Role word, if it says more than `person`.
    pub(crate) role: Option<String>,
    /// The word that stands for a noun, if it is `he`, `she` or `one`.
    pub(crate) word: String,
    /// `a group of four`.
    pub(crate) group: bool,
    /// `two groups of three`: into how many; else 1.
    pub(crate) parts: u32,
    /// First word.
    pub(crate) from: usize,
    /// Last word.
    pub(crate) to: usize,
}

/// Every mention of people in the words, in order.
pub(crate) fn mentions(words: &[Word]) -> Vec<Mention> {
    let lex = lexicon();
    let mut found: Vec<Mention> = Vec::new();
    let mut at = 0;
    while at < words.len() {
        if words.get(at).is_some_and(|word| word.label) {
            at += 1;
        } else if let Some(mention) = phrase_at(words, at, lex) {
            at = mention.to + 1;
            // `three relatives of a patient` are three.
            let text = |k: usize| words.get(k).map_or("", |word| word.text.as_str());
            if text(at) == "of"
                && matches!(text(at + 1), "a" | "an")
                && let Some(of) = phrase_at(words, at + 1, lex)
                    .filter(|of| matches!(of.who, Who::New { count: Some(1), .. }) && !of.group)
                && mention.role.is_some()
            {
                at = of.to + 1;
            }
            // `a colleague of mine as a bystander`
            let as_one = mention.from > 0
                && text(mention.from - 1) == "as"
                && text(mention.from) != "the"
                && matches!(mention.who, Who::New { count: Some(1), article: true })
                && !found.is_empty();
            if !as_one {
                found.push(predicate(words, mention, &found));
            }
        } else {
            at += 1;
        }
    }
    found
}

/// Of whom some are meant: `of the three visitors`.
struct Whole {
    end: usize,
    role: Option<String>,
    count: Option<u32>,
}

fn phrase_at(words: &[Word], at: usize, lex: &Lexicon) -> Option<Mention> {
    let text = |k: usize| words.get(k).map_or("", |word| word.text.as_str());
    let stem = |k: usize| words.get(k).map_or("", |word| word.stem.as_str());
    let role = |k: usize| {
        let named =
            (0..=2).filter_map(|back| k.checked_sub(back)).map(&stem).find(|name| lex.roles.contains_key(*name));
        match named {
            Some(name) => lex.roles.get(name).filter(|word| !word.generic).map(|_| name.to_owned()),
            None if matches!(text(k), "guide" | "escort") => Some(stem(k).to_owned()),
            None => {
                Some(stem(k).to_owned()).filter(|name| !name.is_empty() && !lex.known.contains(name) && name != "robot")
            }
        }
    };
    let made = |who: Who, role: Option<String>, to: usize| {
        Some(Mention { who, role, word: String::new(), group: false, parts: 1, from: at, to })
    };
    let of_them = |k: usize| {
        if stem(k) != "of" {
            return None;
        }
        if matches!(text(k + 1), "them" | "these" | "those" | "us" | "whom" | "which") {
            return Some(Whole { end: k + 1, role: None, count: None });
        }
        let skip = if matches!(
            text(k + 1),
            "the" | "these" | "those" | "all" | "our" | "my" | "your" | "his" | "her" | "their"
        ) {
            k + 2
        } else {
            k + 1
        };
        // `one of the pair`
        if skip == k + 2 && band(words, skip).is_some() && text(skip + 1) != "of" {
            return Some(Whole { end: skip, role: None, count: None });
        }
        let count = words.get(skip).and_then(Word::count).filter(|n| *n > 1);
        let start = skip + usize::from(count.is_some());
        let named = noun(words, start, lex).or_else(|| stranger(words, start, count.is_some(), lex));
        // `none of the five`
        let bare =
            count.filter(|_| start > skip && text(k + 1) == "the").map(|_| Whole { end: skip, role: None, count });
        named.map(|end| Whole { end, role: role(end), count }).or(bare)
    };
    // `neither of the others`, `both of the rest`: those who are left.
    let left = matches!(text(at), "both" | "neither" | "none" | "each" | "all" | "any")
        && text(at + 1) == "of"
        && text(at + 2) == "the"
        && matches!(text(at + 3), "other" | "others" | "rest" | "remaining");
    if left {
        return others(words, at + 2, lex, &role).map(|mention| Mention { who: Who::Other(None), from: at, ..mention });
    }
    match text(at) {
        "not"
            if matches!(text(at + 1), "a" | "one") && text(at + 2) == "single"
                || text(at + 1) == "one" && matches!(text(at + 2), "of" | "person" | "human") =>
        {
            // `not a single one of them`
            let one = at + 2 + usize::from(text(at + 2) == "single");
            let of = one + usize::from(text(one) == "one");
            if let Some(them) = of_them(of) {
                return made(Who::Nobody, None, them.end);
            }
            let end = noun(words, at + 3, lex).unwrap_or(at + 2);
            return made(Who::Nobody, None, end);
        }
        "nobody" | "noone" => return made(Who::Nobody, None, at),
        "no" => {
            if text(at + 1) == "one" {
                // `no one of them`
                return match of_them(at + 2) {
                    Some(of) => made(of.count.map_or(Who::All, Who::AllOf), of.role, of.end),
                    None => made(Who::Nobody, None, at + 1),
                };
            }
            // `no other people`
            let more = usize::from(
                matches!(text(at + 1), "other" | "more" | "further" | "additional" | "others")
                    || lex.ordinals.contains_key(text(at + 1)),
            );
            return noun(words, at + 1 + more, lex).and_then(|end| made(Who::Nobody, None, end));
        }
        // `his instructor neither runs away nor steps aside`
        "neither"
            if at > 0
                && lex.roles.contains_key(stem(at - 1))
                && words.iter().skip(at).any(|word| word.text == "nor") =>
        {
            return None;
        }
        "both" if matches!(text(at + 1), "others" | "other") => {
            return made(Who::Other(None), None, noun(words, at + 2, lex).unwrap_or(at + 1));
        }
        "both" | "neither" => {
            let of = of_them(at + 1);
            let named = of.as_ref().map(|of| of.end).or_else(|| noun(words, at + 1, lex));
            // `both the manager and the visitor` are two mentions of their own.
            let listed = of.is_none() && named.is_none() && matches!(text(at + 1), "the" | "a" | "an");
            if listed {
                return None;
            }
            return match (named, of.and_then(|of| of.count)) {
                (Some(end), count) => made(Who::AllOf(count.unwrap_or(2)), role(end), end),
                (None, _) => made(Who::All, None, at),
            };
        }
        // `most of the five people`
        "most" if of_them(at + 1).as_ref().is_some_and(|of| of.count.is_some_and(|n| n > 2)) => {
            let of = of_them(at + 1)?;
            let count = of.count?;
            return made(Who::PartOfNew(count - (count - 1) / 3, count), of.role, of.end);
        }
        "none" | "each" | "all" | "everyone" | "everybody"
            if of_them(at + 1).as_ref().is_some_and(|of| of.count.is_some()) =>
        {
            let of = of_them(at + 1)?;
            return made(Who::AllOf(of.count?), of.role, of.end);
        }
        "all" | "everyone" | "everybody"
            if matches!(text(at + 1), "but" | "except" | "save")
                && words.get(at + 2).is_some_and(|word| word.count().is_some()) =>
        {
            let out = words.get(at + 2).and_then(Word::count).unwrap_or(1);
            // `all but one of the five employees`
            if let Some(of) = of_them(at + 3)
                && let Some(count) = of.count.filter(|count| *count > out)
            {
                return made(Who::PartOfNew(count - out, count), of.role, of.end);
            }
            let end = noun(words, at + 3, lex).unwrap_or(at + 2);
            return made(Who::AllBut(out), None, end);
        }
        "they" | "them" | "everyone" | "everybody" | "none" => {
            let end = of_them(at + 1).map_or(at, |of| of.end);
            let mention = made(Who::All, None, end);
            let word = if text(at) == "them" { "them" } else { "" };
            return mention.map(|mention| Mention { word: word.to_owned(), ..mention });
        }
        // `all but the first …`, where the last ones spoken of are some of them
        "all"
            if at == 0 && words.get(1).is_some_and(|word| word.text == word.stem && lex.verbs.contains(&word.stem)) =>
        {
            return made(Who::All, None, at).map(|mention| Mention { word: "all".to_owned(), ..mention });
        }
        "all" | "each" => {
            if let Some(of) = of_them(at + 1) {
                return made(Who::All, None, of.end);
            }
            // `all three of them`
            if let Some(count) = words.get(at + 1).and_then(Word::count).filter(|n| *n > 1)
                && text(at + 2) == "of"
                && let Some(of) = of_them(at + 2)
            {
                let who = if of.role.is_none() && of.count.is_none() { Who::SoMany(count) } else { Who::AllOf(count) };
                return made(who, of.role, of.end);
            }
            // `all three nurses` are those three, or three new ones.
            if let Some(count) = words.get(at + 1).and_then(Word::count).filter(|n| *n > 1)
                && let Some(end) = noun(words, at + 2, lex)
            {
                return made(Who::AllOf(count), role(end), end);
            }
            let start = at + 1 + usize::from(matches!(text(at + 1), "the"));
            let count = words.get(start).and_then(Word::count);
            let start = start + usize::from(count.is_some());
            return match noun(words, start, lex) {
                Some(end) => made(Who::All, None, end),
                None if let Some(count) = count.filter(|n| *n > 1) => made(Who::SoMany(count), None, start - 1),
                None if start > at + 1 => made(Who::All, None, start - 1),
                // `each steps aside`
                None if text(at) == "each"
                    // `the first and the second each wave`
                    && (at == 0 || matches!(text(at - 1), "and" | "then" | "but" | "they"))
                    && words.get(at + 1).is_none_or(|word| lex.verbs.contains(&word.stem)) =>
                {
                    made(Who::All, None, at)
                }
                None => None,
            };
        }
        "he" | "she" => {
            return made(Who::Same, None, at).map(|mention| Mention { word: text(at).to_owned(), ..mention });
        }
        "him" => return made(Who::Object, None, at),
        // `her` before a word of its own is whose, not whom.
        "her" if words.get(at + 1).is_none_or(|word| NO_NOUNS.contains(&word.stem.as_str())) => {
            return made(Who::Object, None, at);
        }
        "a" | "an" if lex.ordinals.get(text(at + 1)).is_some_and(|n| *n > 1) => {
            let number = lex.ordinals.get(text(at + 1)).copied()?;
            let start = at + 2 + usize::from(text(at + 2) == "one");
            let end = noun(words, start, lex).unwrap_or(start - 1);
            let time = matches!(text(at + 2), "time" | "later" | "after") || stem(at + 2) == "robot";
            let one = if end < start { "one" } else { "" };
            let mention = made(Who::Further(number), role(end), end).filter(|_| !time);
            return mention.map(|mention| Mention { word: one.to_owned(), ..mention });
        }
        // `all but the last step aside, that one blocks it`
        "that"
            if text(at + 1) == "one"
                && words.get(at + 2).is_some_and(|word| word.text.ends_with('s') && lex.verbs.contains(&word.stem)) =>
        {
            return made(Who::Same, None, at + 1);
        }
        "someone" | "somebody" => return made(Who::New { count: Some(1), article: true }, None, at),
        _ => {}
    }
    if let Some(mention) = others(words, at, lex, &role) {
        return Some(mention);
    }
    if let Some((number, role_at, to)) = numbered(words, at, lex) {
        return made(Who::Number(number), role_at.and_then(&role), to);
    }
    counted(words, at, lex, &role, &of_them)
}

fn stem(words: &[Word], at: usize) -> &str {
    words.get(at).map_or("", |word| word.stem.as_str())
}

/// Counts and articles: `two nurses`, `a group of 4 employees`, `one of them`, `the nurse`, `people`.
fn counted(
    words: &[Word],
    at: usize,
    lex: &Lexicon,
    role: &dyn Fn(usize) -> Option<String>,
    of_them: &dyn Fn(usize) -> Option<Whole>,
) -> Option<Mention> {
    let text = |k: usize| words.get(k).map_or("", |word| word.text.as_str());
    let before = if at == 0 { "" } else { words.get(at - 1).map_or("", |word| word.stem.as_str()) };
    let made = |who: Who, role: Option<String>, group: bool, to: usize| {
        Some(Mention { who, role, word: String::new(), group, parts: 1, from: at, to })
    };
    let article = matches!(text(at), "a" | "an");
    let the = matches!(text(at), "the" | "these" | "those" | "this");
    let mut next = at + usize::from(article || the);
    let mut count = words.get(next).and_then(Word::count);
    if text(next) == "half" && text(next + 1) == "a" && text(next + 2) == "dozen" {
        (count, next) = (Some(6), next + 2);
    } else if matches!(text(next), "large" | "small" | "whole")
        && words.get(next + 1).is_some_and(|word| word.count().is_some() || word.stem == "group")
    {
        next += 1;
        count = words.get(next).and_then(Word::count);
    }
    if count.is_some() {
        next += 1;
    }
    // `some visitor`
    if text(at) == "some" && noun(words, next, lex).is_some_and(|end| !words.get(end).is_some_and(plural)) {
        count = Some(1);
    }
    // `an old couple`, `the pair`: words that are numbers too, but not where they count others.
    let described = next + usize::from(words.get(next).is_some_and(|word| lex.adjectives.contains(&word.text)));
    // `a tour group of six`
    let named = words
        .get(next)
        .is_some_and(|word| !lex.stop.contains(&word.text) && !lex.verbs.contains(&word.stem) && !word.label);
    let of_six = next
        + usize::from(
            named && text(next + 2) == "of" && words.get(next + 3).is_some_and(|word| word.count().is_some()),
        );
    for k in [described, next.saturating_sub(usize::from(count.is_some())), of_six] {
        let counts = text(k + 1) == "of" && count.is_some() && matches!(text(k), "couple" | "crowd" | "trio");
        let around = matches!(text(k + 1), "around" | "round" | "about" | "up" | "in" | "the");
        let bare = at == 0 && k == 0 && words.len() > 1 && !around
            || text(k + 1) == "of" && words.get(k + 2).is_some_and(|word| word.count().is_some());
        let compound = words.get(k + 1).is_some_and(|next| lex.roles.contains_key(&next.stem));
        if k >= at && !counts && !compound && band(words, k).is_some() && (article || the || count.is_some() || bare) {
            return group(words, at, k, count.filter(|_| k >= next), the, lex, role);
        }
    }
    // `half of the six employees`, `two others`
    if text(at) == "half"
        && let Some(of) = of_them(at + 1)
        && let Some(whole) = of.count
    {
        return made(Who::PartOfNew(whole / 2, whole), of.role, false, of.end);
    }
    if let Some(n) = count.filter(|_| text(next) == "others") {
        return made(Who::More(n), None, false, next);
    }
    let more = matches!(text(next), "more" | "additional" | "further");
    next += usize::from(more);
    let linked = count.is_some() && text(next) == "of";
    if linked && let Some(of) = of_them(next) {
        let listed =
            matches!(text(next - 1), "couple" | "pair" | "crowd" | "dozen" | "handful" | "trio" | "group" | "bunch")
                && text(next + 1) != "the"
                && text(next + 1) != "them";
        let part = count.unwrap_or(1);
        let who = match of.count {
            // `the two of them`
            None if the && of.role.is_none() => Who::All,
            _ if listed => Who::New { count, article: true },
            Some(whole) if whole > part => Who::PartOfNew(part, whole),
            Some(_) | None => Who::PartOf(part),
        };
        return made(who, of.role, false, of.end);
    }
    // `one on each side` tells where those are of whom was spoken.
    if text(at) == "one" && text(at + 1) == "on" && matches!(text(at + 2), "each" | "either" | "every" | "both") {
        return None;
    }
    // `one of the meeting rooms` is a place.
    if text(at) == "one" && text(at + 1) == "of" {
        let place = |k: usize| {
            let named = Item::Word(stem(words, k).to_owned());
            lex.labels.contains(stem(words, k)) || lex.places.iter().any(|place| place.items == [named.clone()])
        };
        let ends = (at + 2..at + 6).find(|k| place(*k) || lex.roles.contains_key(stem(words, *k)));
        if ends.is_some_and(place) {
            return None;
        }
    }
    // `Can you do one where …`
    let makes = |k: usize| {
        matches!(stem(words, k), "do" | "make" | "create" | "simulate" | "run" | "try" | "generate" | "build" | "write")
    };
    if text(at) == "one" && at + 1 == words.len() && at > 0 && makes(at - 1) {
        return None;
    }
    // `but that one I already have`, `has never seen one before`: a scenario, a robot.
    if text(at) == "one"
        && at > 0
        && (matches!(text(at - 1), "this" | "that") && matches!(text(at + 1), "i" | "we" | "is" | "was")
            || matches!(words.get(at - 1).map_or("", |word| word.stem.as_str()), "see" | "meet" | "have" | "want")
                && matches!(text(at + 1), "" | "before" | "already" | "yet"))
    {
        return None;
    }
    // `In this one an intern …`: a scenario.
    if text(at) == "one"
        && at > 0
        && matches!(text(at - 1), "this" | "that")
        && at > 1
        && matches!(text(at - 2), "in" | "for")
    {
        return None;
    }
    // `one after another`, `one by one` say how, not who.
    if text(at) == "one"
        && matches!(text(at + 1), "after" | "by" | "behind")
        && (text(at + 2) != "the" || text(at + 3) == "other")
        && (text(at + 1) != "behind" || matches!(text(at + 2), "another" | "the" | "each"))
    {
        return None;
    }
    // `the taller one`, `the one on the left`.
    if the && !text(at).starts_with("thi") && !text(at).starts_with("tho") {
        let plain = |k: usize| {
            let word = text(k);
            !lex.stop.contains(word)
                && !lex.places.iter().any(|place| place.items.contains(&Item::Word(word.to_owned())))
        };
        if text(at + 1) == "one" {
            return made(Who::ToldApart, None, false, at + 1);
        }
        let wide = matches!(text(at + 1), "narrow" | "wide" | "main" | "broad" | "long");
        if text(at + 2) == "one" && !wide && (plain(at + 1) || text(at + 1) == "only") && stem(words, at + 1) != "robot"
        {
            return made(Who::ToldApart, None, false, at + 2);
        }
    }
    // `left one gives way`, where people leave articles out.
    if at == 0 && text(1) == "one" && lex.adjectives.contains(text(0)) && stem(words, 0) != "robot" {
        return made(Who::ToldApart, None, false, 1);
    }
    // `the slower of the two`
    if the && lex.adjectives.contains(text(at + 1)) && text(at + 2) == "of" {
        let two = text(at + 3) == "the" && matches!(text(at + 4), "two" | "pair" | "three" | "four");
        if two || text(at + 3) == "them" {
            return made(Who::ToldApart, None, false, at + if two { 4 } else { 3 });
        }
    }
    // `his guide`
    if matches!(text(at), "his" | "her" | "their") && matches!(text(at + 1), "guide" | "escort") {
        let mention = made(Who::Definite { plural: false, count: None }, role(at + 1), false, at + 1);
        return mention.map(|mention| Mention { word: "own".to_owned(), ..mention });
    }
    // `his mother`, `her colleague`: known or new.
    // `her two colleagues`
    if matches!(text(at), "his" | "her" | "their" | "our" | "my")
        && let Some(n) = words.get(at + 1).and_then(Word::count).filter(|n| *n > 1)
        && let Some(end) = noun(words, at + 2, lex)
    {
        return made(Who::Definite { plural: true, count: Some(n) }, role(end), false, end);
    }
    // `her registrar waits`, which no table has
    if matches!(text(at), "his" | "her" | "their" | "our" | "my")
        && noun(words, at + 1, lex).is_none()
        && words.get(at + 1).is_some_and(crate::noun::agentive)
        && !thing(words, at + 1)
        && let Some(end) = stranger(words, at + 1, true, lex)
        && words.get(end + 1).is_none_or(|word| lex.verbs.contains(&word.stem) || word.text == "who")
    {
        return made(Who::Definite { plural: false, count: None }, role(end), false, end);
    }
    if matches!(text(at), "his" | "her" | "their" | "our" | "my")
        && let Some(end) = noun(words, at + 1, lex).filter(|end| {
            // `our porter Dennis`
            let named = words.get(*end).is_some_and(|word| word.capital) && *end > at + 1;
            let noun = if named && !lex.roles.contains_key(stem(words, *end)) { end - 1 } else { *end };
            lex.roles.get(stem(words, noun)).is_some_and(|role| !role.generic)
        })
    {
        let called = words.get(end).is_some_and(|word| word.capital && !lex.roles.contains_key(&word.stem));
        let many = words.get(if called { end - 1 } else { end }).is_some_and(plural);
        let mention = made(Who::Definite { plural: many, count: None }, role(end), false, end);
        return mention.map(|mention| Mention { word: "own".to_owned(), ..mention });
    }
    if next == at && count.is_none() && words.get(at).is_some_and(|word| word.name && !word.label) {
        let mention = made(Who::Definite { plural: false, count: None }, role(at), false, at);
        return mention.map(|mention| Mention { word: "name".to_owned(), ..mention });
    }
    // `Maria follows the robot`: somebody by name, whoever is called so later is the same.
    if next == at
        && count.is_none()
        && words.get(at).is_some_and(|word| word.capital)
        // `Sarah from HR walks`
        && !at.checked_sub(1).is_some_and(|k| matches!(text(k), "from" | "in" | "of" | "at" | "by"))
        && noun(words, at, lex).is_none()
        && stranger(words, at, true, lex).is_some_and(|end| {
            // `Blood samples are urgent` names nobody.
            words.get(at..=end).is_some_and(|name| {
                let notion = |word: &Word| ["tion", "ness", "ment", "ity", "ance", "ence", "ism", "ics", "ogy"].iter().any(|end| word.text.ends_with(end));
                name.iter().all(|word| word.capital && !notion(word))
            })
                // `Earlier work suggests …` names nobody.
                && words.get(end + 1).is_some_and(|word| {
                    let copula = matches!(word.text.as_str(), "is" | "was" | "has")
                        && matches!(text(end + 2), "the" | "what" | "why" | "how" | "one" | "that");
                    lex.verbs.contains(&word.stem) && word.text != word.stem && !copula || word.text == "who"
                })
        })
    {
        return made(Who::Definite { plural: false, count: None }, role(at), false, at);
    }
    if let Some(end) = noun(words, next, lex).or_else(|| stranger(words, next, article || count.is_some(), lex)) {
        // `Dr. Haas` is one.
        let named =
            end > next && words.get(end).is_some_and(|word| word.capital && !lex.roles.contains_key(&word.stem));
        let many = words.get(if named { end - 1 } else { end }).is_some_and(plural);
        // `the new guy` is somebody else than who was spoken of.
        let the = the && (many || text(next) != "new");
        let article = article || text(next) == "new" && !many;
        let who = match (the, count, more) {
            (_, Some(n), true) => Who::More(n),
            (true, count, _) => Who::Definite { plural: many, count },
            (false, Some(n), false) => Who::New { count: Some(n), article: false },
            (false, None, _) if article => Who::New { count: Some(1), article: true },
            // `Driver blocks. Driver ignores it.`: without an article it is who is there already, if there is.
            (false, None, _) if !many => Who::Definite { plural: false, count: None },
            (false, None, _) => Who::New { count: None, article: true },
        };
        return made(who, role(end), false, end);
    }
    // A number alone speaks of people only where it can stand for them: `2 leave`, `one stays`, `two more`.
    let n = count?;
    // `when it is one and a half metres away`
    if text(next) == "and" && text(next + 1) == "a" && text(next + 2) == "half" {
        return None;
    }
    let label = lex.labels.contains(before) && (words.get(next - 1).is_some_and(Word::is_digits))
        || matches!(before, "of" | "at" | "within" | "for" | "after" | "than" | "robot")
        // `a boy from wing 3`
        || words.get(next - 1).is_some_and(Word::is_digits)
            && at > 1
            && matches!(text(at - 2), "from" | "in" | "on" | "at" | "to" | "near")
        // `truck 7 is late`
        || lex.things.contains(before) && !lex.verbs.contains(before) && words.get(next - 1).is_some_and(Word::is_digits);
    let unit = words.get(next).is_some_and(|word| {
        matches!(word.stem.as_str(), "meter" | "second" | "minute" | "centimeter" | "hour" | "pm" | "am")
    });
    // `two or three meters`
    let range = text(next) == "or" && words.get(next + 1).is_some_and(|word| word.count().is_some());
    let counts = thing(words, next) || range;
    let verb = words.get(next).is_none_or(|word| {
        let does = lex.verbs.contains(&word.stem);
        lex.known.contains(&word.stem) && (does || !lex.labels.contains(&word.stem))
    });
    if label || unit || counts || !verb || article || text(at).contains('.') || n == 0 {
        return None;
    }
    let who = if more {
        Who::More(n)
    } else if the {
        let mention = made(Who::Definite { plural: n > 1, count: Some(n) }, None, false, next - 1);
        let these = if matches!(text(at), "these" | "those") { "these" } else { "" };
        return mention.map(|mention| Mention { word: these.to_owned(), ..mention });
    } else {
        Who::Bare(n)
    };
    made(who, None, false, next - 1)
}
