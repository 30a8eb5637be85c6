//! Appositions: `two people, a nurse and a visitor, come out` are two people, not four.

use crate::lexicon::lexicon;
use crate::mention::{Mention, Who, mentions};
use crate::words::Word;

/// Words between people and the list of who they are.
const OPENS: &[&str] = &["consisting", "composed", "comprising", "made", "up", "of", "namely", "specifically"];

/// A list of people: the role of each, and the place after its last word.
struct List {
    roles: Vec<String>,
    end: usize,
}

/// The words of a sentence with such lists taken out; the noun before a list remembers in [`Word::made_of`] who they are.
pub(crate) fn apposed(mut words: Vec<Option<Word>>) -> Vec<Option<Word>> {
    let mut at = 1;
    while at < words.len() {
        if let Some((head, list)) = apposition(&words, at) {
            if let Some(noun) = words.get_mut(head).and_then(Option::as_mut) {
                noun.made_of = list.roles;
            }
            let closing = usize::from(words.get(list.end).is_some_and(Option::is_none));
            words.drain(at..list.end + closing);
        } else {
            at += 1;
        }
    }
    words
}

/// The noun before the list that begins at a mark or word, and the list.
fn apposition(words: &[Option<Word>], at: usize) -> Option<(usize, List)> {
    let opens = |k: usize| {
        words.get(k).and_then(Option::as_ref).is_some_and(|word| OPENS.contains(&word.text.as_str()) && !word.label)
    };
    let mark = words.get(at).is_some_and(Option::is_none);
    if !mark && !opens(at) {
        return None;
    }
    let from = (at + usize::from(mark)..).find(|k| !opens(*k))?;
    // `two people come out, first a nurse and then a porter`
    let ordered = words.get(from).and_then(Option::as_ref).is_some_and(|word| word.text == "first");
    let from = from + usize::from(ordered);
    let list = list(words, from)?;
    let (places, spoken): (Vec<usize>, Vec<Word>) =
        words.get(..at)?.iter().enumerate().filter_map(|(k, word)| Some((k, word.clone()?))).unzip();
    let head = mentions(&spoken).into_iter().rev().find(|mention| matches!(mention.who, Who::New { .. }))?;
    let Who::New { count, .. } = head.who else { return None };
    // `a family`: as many as the list names.
    // `exactly three people: a nurse, two visitors and a cleaner`: said to be wrong, once it is known whose they are.
    let colon = words
        .get(at + 1)
        .and_then(Option::as_ref)
        .is_some_and(|word| word.after_colon || matches!(word.text.as_str(), "namely" | "specifically"));
    // `three people get out, a cleaner, a doctor and a visitor, in that order`
    let whole = words.get(list.end).is_none_or(Option::is_none);
    let listed = |n: u32| {
        let wanted = usize::try_from(n).unwrap_or(usize::MAX);
        wanted == list.roles.len() || colon && whole && head.role.is_none() && wanted > 1 && wanted < list.roles.len()
    };
    let count = count.map_or(head.group, listed);
    let noun = *places.get(head.to)?;
    let adjacent = noun + 1 == at;
    // Farther on it is a list of them only if nothing comes after it: `two people come in: a nurse and a visitor`.
    let listed = adjacent || mark && whole && (colon || head.role.is_none());
    (count && listed).then_some((noun, list))
}

/// `a nurse, a doctor and two visitors`.
fn list(words: &[Option<Word>], from: usize) -> Option<List> {
    let (mut roles, mut end, mut joined) = (Vec::new(), from, false);
    let and = |k: usize| words.get(k).and_then(Option::as_ref).is_some_and(|word| word.text == "and");
    let item_at = |k: usize| item(&words.get(k..)?.iter().map_while(Clone::clone).collect::<Vec<Word>>());
    let mut next = from;
    while let Some((count, role, length)) = item_at(next) {
        roles.extend((0..count).map(|_| role.clone()));
        end = next + length;
        next = end + usize::from(words.get(end).is_some_and(Option::is_none));
        joined |= and(next);
        next += usize::from(and(next));
        // `a physio and after him a dietician`
        let after = |k: usize, texts: &[&str]| {
            words.get(k).and_then(Option::as_ref).is_some_and(|word| texts.contains(&word.text.as_str()))
        };
        if after(next, &["after", "then", "behind"]) && after(next + 1, &["him", "her", "them"]) {
            next += 2;
        }
        next += usize::from(after(next, &["then"]));
        if next == end {
            break;
        }
    }
    (joined && roles.len() > 1).then_some(List { roles, end })
}

/// How many, of which role, in how many words: `two visitors`. What is said of how they walk is not for a list.
fn item(run: &[Word]) -> Option<(u32, String, usize)> {
    let mention: Mention = mentions(run).into_iter().next().filter(|mention| mention.from == 0)?;
    // `a family, mother, father and girl, …`
    let bare = !run.first().is_some_and(|word| {
        matches!(word.text.as_str(), "the" | "this" | "that" | "her" | "his" | "their" | "our" | "my" | "its")
    });
    // `a patient and the patient's wife`
    let whose = run.get(..=mention.to).is_some_and(|words| {
        words.iter().filter(|word| lexicon().roles.contains_key(&word.stem)).count() > 1
            && words.first().is_some_and(|word| word.text == "the")
    });
    let count = if whose && mention.who == (Who::Definite { plural: false, count: None }) {
        1
    } else if let Who::New { count: Some(count), .. } = mention.who {
        count
    } else if bare && mention.who == (Who::Definite { plural: false, count: None }) {
        1
    } else {
        return None;
    };
    let length = mention.to + 1;
    let plain = run.get(..length)?.iter().all(|word| !lexicon().pace.contains_key(&word.text));
    (plain && !mention.group && (1..=9).contains(&count)).then_some((count, mention.role?, length))
}
