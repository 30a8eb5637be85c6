//! Names of people beside who they are: `Dele, the porter`, `our foreman, Marek`, `her colleague Jonas`,
//! `two loaders, Chuy and Big Tom`.

use crate::clock::{MONTHS, WEEKDAYS};
use crate::lexicon::lexicon;
use crate::noun::plural;
use crate::words::{Piece, Word, comma_at, text_at, word_at};

/// Words before a name that belong to it.
const TITLES: &[&str] = &["mr", "mrs", "ms", "miss", "prof", "sister", "dr"];
/// Feasts have a capital and are no names of people, as days and months are not.
const FEASTS: &[&str] = &["christmas", "easter"];
/// Words before who somebody is.
const WHOSE: &[&str] = &["our", "the", "a", "an", "my", "her", "his", "their", "your", "this", "that", "another"];
/// Words that begin where somebody is from.
const FROM: &[&str] = &["from", "on", "in", "of", "at", "with", "by"];
/// So many words at most say who somebody is, and as many where from.
const SPAN: usize = 5;

/// Takes names that stand beside who somebody is out of the text, and returns them in order: the noun remembers them in
/// [`Word::called`], and whoever is called so later is the same.
pub(crate) fn called(pieces: &mut Vec<Piece>) -> Vec<String> {
    let mut known: Vec<String> = Vec::new();
    second(pieces);
    let mut at = 0;
    while at < pieces.len() {
        if let Some(found) = several(pieces, at)
            .or_else(|| both(pieces, at))
            .or_else(|| before(pieces, at))
            .or_else(|| after(pieces, at))
        {
            for name in &found.names {
                if !known.contains(name) {
                    known.push(name.clone());
                }
            }
            if let Some(Piece::Word(noun)) = pieces.get_mut(found.noun) {
                noun.called.clone_from(&found.names);
            }
            // Whoever is introduced by name is one: `Dele, our porter` is a porter.
            if let Some(Piece::Word(whose)) = found.whose.and_then(|whose| pieces.get_mut(whose)) {
                "a".clone_into(&mut whose.text);
                "a".clone_into(&mut whose.stem);
            }
            for at in found.noun..found.end {
                if let Some(Piece::Word(word)) = pieces.get_mut(at) {
                    // `our foreman on shift 2`
                    word.label |= word.is_digits() || at > found.noun;
                }
            }
            for (from, to) in found.drop.into_iter().rev() {
                pieces.drain(from..to);
            }
        }
        at += 1;
    }
    alone(pieces, &mut known);
    known
}

/// `a second person, a visitor walking behind it`: a second visitor.
fn second(pieces: &mut Vec<Piece>) {
    let mut at = 0;
    while at + 5 < pieces.len() {
        let one = matches!(text_at(pieces, at), "a" | "the")
            && (lexicon().ordinals.contains_key(text_at(pieces, at + 1)) || text_at(pieces, at + 1) == "other")
            || text_at(pieces, at + 1) == "another";
        let other = comma_at(pieces, at + 3) && matches!(text_at(pieces, at + 4), "a" | "an");
        let noun = (at + 5..at + 8).take_while(|k| word_at(pieces, *k).is_some()).find(|k| role(pieces, *k));
        if one
            && generic(pieces, at + 2)
            && other
            && noun.is_some()
            && (!comma_at(pieces, noun.unwrap_or(at) + 1) || text_at(pieces, noun.unwrap_or(at) + 2) == "who")
        {
            pieces.drain(at + 2..at + 5);
        }
        // `1 ped, clerk, oncoming`
        let single = word_at(pieces, at).is_some_and(|word| word.count() == Some(1) || word.text == "a");
        let listed = comma_at(pieces, at + 2) && role(pieces, at + 3) && ends(pieces, at + 4);
        if single && generic(pieces, at + 1) && listed && !word_at(pieces, at + 3).is_some_and(plural) {
            pieces.drain(at + 1..at + 3);
        }
        at += 1;
    }
}

/// `Mrs. Aydin from ward 3`, `we've got Petra in accounting`: names that nothing else tells.
fn alone(pieces: &[Piece], known: &mut Vec<String>) {
    for at in 0..pieces.len() {
        let titled = matches!(text_at(pieces, at), "mr" | "mrs" | "ms" | "miss");
        let got = matches!(text_at(pieces, at), "got" | "picture" | "imagine" | "meet");
        let from = |k: usize| matches!(text_at(pieces, k), "in" | "from" | "at" | "of");
        // `Petra in accounting is …`; `Avoidance in its mildest form: …` is nobody
        let goes_on = |k: usize| word_at(pieces, k).is_some_and(|word| lexicon().verbs.contains(&word.stem));
        let placed = ends(pieces, at.wrapping_sub(1))
            && from(at + 1)
            && (at + 3..at + 6).any(|k| goes_on(k) || comma_at(pieces, k) && text_at(pieces, k + 1) == "who");
        let start = if titled || got { at + 1 } else { at };
        if !(titled || got || placed) || !capital(pieces, start) {
            continue;
        }
        if let Some((name, end)) = name(pieces, start)
            && (titled || from(end) || ends(pieces, end))
            && !known.contains(&name)
        {
            known.push(name);
        }
    }
}

/// Who has which names, and what of the text only says so.
struct Found {
    /// Where the noun stands.
    noun: usize,
    /// Where what says who somebody is ends.
    end: usize,
    /// Where the word before it stands that is to be an article.
    whose: Option<usize>,
    names: Vec<String>,
    /// Stretches that go, in order.
    drop: Vec<(usize, usize)>,
}

/// Whether a clause part ends here.
fn ends(pieces: &[Piece], at: usize) -> bool {
    !matches!(pieces.get(at), Some(Piece::Word(_)))
}

fn role(pieces: &[Piece], at: usize) -> bool {
    word_at(pieces, at).is_some_and(|word| lexicon().roles.contains_key(&word.stem) && !word.label)
}

/// Whether a word for people says nothing about who it is: `person`.
fn generic(pieces: &[Piece], at: usize) -> bool {
    word_at(pieces, at).and_then(|word| lexicon().roles.get(&word.stem)).is_some_and(|role| role.generic)
}

/// A word with a capital that no table has.
fn capital(pieces: &[Piece], at: usize) -> bool {
    word_at(pieces, at).is_some_and(|word| {
        word.capital
            && word.text.len() > 1
            && word.text.chars().all(char::is_alphabetic)
            && !lexicon().has(word)
            && [WEEKDAYS, MONTHS, FEASTS].iter().all(|list| !list.contains(&word.text.as_str()))
            // `Thereupon the picker hurries`
            && !["ly", "upon", "wards", "fter", "while"].iter().any(|end| word.text.ends_with(end))
            && !lexicon().roles.contains_key(&word.stem)
            && !lexicon().places.iter().any(|place| place.items == [crate::lexicon::Item::Word(word.text.clone())])
    })
}

/// A name with what belongs to it, `old Mrs. Whitcombe`: its last word, by which somebody is called, and where it ends.
fn name(pieces: &[Piece], at: usize) -> Option<(String, usize)> {
    let belongs = |k: &usize| {
        TITLES.contains(&text_at(pieces, *k))
            || lexicon().adjectives.contains(text_at(pieces, *k))
            || matches!(text_at(pieces, *k), "poor" | "little" | "dear" | "good")
    };
    let first = (at..at + 3).take_while(belongs).last().map_or(at, |last| last + 1);
    let last = (first..first + 2).take_while(|k| capital(pieces, *k)).last()?;
    Some((word_at(pieces, last)?.stem.clone(), last + 1))
}

/// `our oldest picker from shift 2`: the noun, and where that ends.
fn described(pieces: &[Piece], at: usize) -> Option<(usize, usize)> {
    // `one of our pickers`
    let start = if text_at(pieces, at) == "one" && text_at(pieces, at + 1) == "of" { at + 2 } else { at };
    if !WHOSE.contains(&text_at(pieces, start)) {
        return None;
    }
    let run = (start + 1..start + 1 + SPAN)
        .take_while(|k| word_at(pieces, *k).is_some() && !FROM.contains(&text_at(pieces, *k)));
    let run: Vec<usize> = run.collect();
    let last = *run.last()?;
    let known = run.iter().rev().copied().find(|k| role(pieces, *k));
    // `the dietician`
    let noun = known.unwrap_or(last);
    let strange = word_at(pieces, noun).is_some_and(|word| {
        !lexicon().has(word) && word.text.len() > 4 && !word.capital && word.text.chars().all(char::is_alphabetic)
    });
    if noun != last || known.is_none() && !strange {
        return None;
    }
    // `from ward 6`, `on shift 2`
    let end = if FROM.contains(&text_at(pieces, last + 1)) {
        (last + 1..last + 2 + SPAN).find(|k| ends(pieces, *k))?
    } else {
        last + 1
    };
    Some((noun, end))
}

/// `Dele, the porter, …`
fn before(pieces: &[Piece], at: usize) -> Option<Found> {
    // Inside a name no name begins.
    if at > 0 && (capital(pieces, at - 1) || TITLES.contains(&text_at(pieces, at - 1))) {
        return None;
    }
    let (name, mark) = name(pieces, at)?;
    // `Dieter the planner and Sofia the buyer come out`
    if text_at(pieces, mark) == "the"
        && word_at(pieces, mark + 1).is_some_and(|word| {
            lexicon().roles.contains_key(&word.stem) || crate::noun::agentive(word) && !lexicon().has(word)
        })
    {
        return Some(Found {
            noun: mark + 1,
            end: mark + 1,
            whose: Some(mark),
            names: vec![name],
            drop: vec![(at, mark)],
        });
    }
    if !comma_at(pieces, mark) {
        return None;
    }
    let (noun, end) = described(pieces, mark + 1)?;
    if !ends(pieces, end) {
        return None;
    }
    let one_of = text_at(pieces, mark + 1) == "one";
    let whose = mark + if one_of { 3 } else { 1 };
    // The first mark goes with the name; the second one parts nothing any more, if the sentence goes on.
    let mut drop = vec![(at, whose)];
    let listed = text_at(pieces, end + 1) == "and" || lexicon().roles.contains_key(text_at(pieces, end + 2));
    if comma_at(pieces, end) && !listed {
        drop.push((end, end + 1));
    }
    Some(Found { noun, end, whose: Some(whose), names: vec![name], drop })
}

/// `our foreman, Marek, …`, `her colleague Jonas`
fn after(pieces: &[Piece], at: usize) -> Option<Found> {
    if !role(pieces, at)
        || word_at(pieces, at)
            .is_some_and(|word| plural(word) || !word.called.is_empty() || word.stem == "doctor" && word.text == "dr")
    {
        return None;
    }
    if let Some((name, end)) = name(pieces, at + 1) {
        // `employee Tom waves`, and not `nurse Station`
        let goes_on = ends(pieces, end) || word_at(pieces, end).is_some_and(|word| !word.capital);
        return goes_on.then(|| Found { noun: at, end: at, whose: None, names: vec![name], drop: vec![(at + 1, end)] });
    }
    // `our foreman on shift 2, Marek, …`
    let from = FROM.contains(&text_at(pieces, at + 1));
    let mark = if from { (at + 1..at + 2 + SPAN).find(|k| ends(pieces, *k))? } else { at + 1 };
    if !comma_at(pieces, mark) {
        return None;
    }
    let (name, end) = name(pieces, mark + 1)?;
    let other = |k: usize| text_at(pieces, k) == "and" || capital(pieces, k);
    if !ends(pieces, end) || comma_at(pieces, end) && other(end + 1) {
        return None;
    }
    let close = usize::from(comma_at(pieces, end));
    Some(Found { noun: at, end: mark, whose: None, names: vec![name], drop: vec![(mark, end + close)] })
}

/// `two loaders, Chuy and Big Tom, …`
fn several(pieces: &[Piece], at: usize) -> Option<Found> {
    if !role(pieces, at) || !word_at(pieces, at).is_some_and(plural) || !comma_at(pieces, at + 1) {
        return None;
    }
    let count =
        (1..=4).filter_map(|back| at.checked_sub(back)).find_map(|k| word_at(pieces, k).and_then(Word::count))?;
    let mut names = Vec::new();
    // `three packers, that's Olu, Petra and Sven`
    let mut next = at + 2 + usize::from(matches!(text_at(pieces, at + 2), "that" | "namely" | "called" | "named"));
    while let Some((who, end)) = name(pieces, next) {
        names.push(who);
        next = end;
        let mark = usize::from(comma_at(pieces, next));
        let and = usize::from(text_at(pieces, next + mark) == "and");
        if mark + and == 0 || name(pieces, next + mark + and).is_none() {
            break;
        }
        next += mark + and;
    }
    let close = usize::from(comma_at(pieces, next));
    let all = usize::try_from(count) == Ok(names.len()) && names.len() > 1;
    all.then(|| Found { noun: at, end: at, whose: None, names, drop: vec![(at + 1, next + close)] })
}

/// `Mia and Jonas, my two confederates, …`
fn both(pieces: &[Piece], at: usize) -> Option<Found> {
    let (first, and) = name(pieces, at).filter(|_| at == 0 || !capital(pieces, at - 1))?;
    let (second, mark) = name(pieces, and + 1).filter(|_| text_at(pieces, and) == "and")?;
    let whose = mark + 1;
    if !comma_at(pieces, mark) || !matches!(text_at(pieces, whose), "my" | "our" | "the" | "her" | "his" | "two") {
        return None;
    }
    let noun = (whose..whose + SPAN).take_while(|k| !ends(pieces, *k)).find(|k| role(pieces, *k))?;
    let close = usize::from(comma_at(pieces, noun + 1));
    // What is left begins with the number: `two confederates come …`
    let begin = whose + usize::from(text_at(pieces, whose) != "two");
    let drop = vec![(at, begin), (noun + 1, noun + 1 + close)];
    (word_at(pieces, noun).is_some_and(plural) && ends(pieces, noun + 1)).then(|| Found {
        noun,
        end: noun,
        whose: None,
        names: vec![first, second],
        drop,
    })
}
