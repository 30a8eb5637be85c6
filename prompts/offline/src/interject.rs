//! Words between marks that say nothing of the scene: `never, under any circumstances, steps aside`, `the girl, bless her, stares`.

use crate::lexicon::lexicon;
use crate::words::{Piece, Word, comma_at, silence, text_at, word_at};

/// Such words, without the marks around them.
const SAID: &[&[&str]] = &[
    &["under", "any", "circumstances"],
    &["by", "contrast"],
    &["in", "contrast"],
    &["by", "comparison"],
    &["of", "course"],
    &["of", "all", "things"],
    &["for", "once"],
    &["for", "example"],
    &["for", "instance"],
    &["as", "usual"],
    &["as", "per", "usual"],
    &["as", "always"],
    &["as", "ever"],
    &["as", "one", "should"],
    &["as", "expected"],
    &["bless", "him"],
    &["bless", "her"],
    &["bless", "them"],
    &["poor", "thing"],
    &["poor", "soul"],
    &["mind", "you"],
    &["i", "think"],
    &["i", "guess"],
    &["i", "suppose"],
    &["i", "believe"],
    &["if", "you", "like"],
    &["if", "you", "will"],
    &["if", "possible"],
    &["if", "you", "please"],
    &["to", "be", "honest"],
    &["to", "be", "fair"],
    &["to", "be", "precise"],
    &["on", "the", "other", "hand"],
    &["on", "the", "contrary"],
    &["so", "to", "speak"],
    &["that", "is"],
    &["that", "is", "to", "say"],
    &["after", "all"],
    &["somebody", "told", "me"],
    &["someone", "told", "me"],
    &["i", "was", "told"],
    &["they", "told", "me"],
    &["once", "again"],
    &["by", "the", "way"],
    &["in", "turn"],
    &["in", "fact"],
    &["in", "particular"],
    &["in", "general"],
    &["as", "it", "were"],
    &["as", "before"],
    &["if", "at", "all"],
    &["all", "being", "well"],
    &["i", "mean"],
    &["you", "know"],
    &["you", "see"],
    &["sort", "of"],
    &["kind", "of"],
    &["more", "or", "less"],
    &["however"],
    &["nonetheless"],
    &["nevertheless"],
    &["though"],
    &["frankly"],
    &["naturally"],
    &["obviously"],
    &["please"],
    &["say"],
    &["basically"],
    &["ideally"],
    &["preferably"],
    &["specifically"],
    &["conversely"],
    &["moreover"],
    &["furthermore"],
    &["additionally"],
    &["accordingly"],
    &["consequently"],
    &["therefore"],
    &["unsurprisingly"],
    &["sic"],
    &["and", "not", "earlier"],
    &["and", "not", "before"],
    &["but", "not", "before"],
    &["but", "not", "earlier"],
    &["not", "earlier"],
    &["not", "before"],
    &["and", "only", "then"],
    &["and", "no", "sooner"],
    &["honestly"],
    &["seriously"],
    &["literally"],
];
/// Words with which a text, or a sentence of it, speaks to whoever reads it: `Folks, …`.
const OPENS: &[&[&str]] = &[
    &["folks"],
    &["guys"],
    &["team"],
    &["everyone"],
    &["hi", "all"],
    &["hello", "all"],
    &["hi", "team"],
    &["morning", "all"],
    &["afternoon", "all"],
    &["good", "morning"],
    &["listen"],
    &["right"],
    &["well"],
    &["look"],
];

/// `Two, no wait, three pickers`: nobody waits.
pub(crate) fn no_wait(pieces: &mut Vec<Piece>) {
    for at in (1..pieces.len()).rev() {
        let said = |k: usize, text: &str| word_at(pieces, k).is_some_and(|word| word.text == text);
        let ends = !matches!(pieces.get(at + 1), Some(Piece::Word(word)) if word.count().is_none());
        let opens = at < 2 || !matches!(pieces.get(at - 2), Some(Piece::Word(word)) if word.count().is_none());
        if said(at - 1, "no") && said(at, "wait") && ends && opens {
            pieces.remove(at);
        }
    }
}

/// Takes such words out of the text, with the marks around them where both are commas.
pub(crate) fn interjected(pieces: &mut Vec<Piece>) {
    let mut at = 0;
    while at < pieces.len() {
        let first = at == 0 || matches!(pieces.get(at - 1), Some(Piece::Stop));
        let tables = [(SAID, opens(pieces, at)), (OPENS, first)];
        let found = tables.iter().filter(|(_, may)| *may).flat_map(|(table, _)| table.iter()).find(|said| {
            said.iter().enumerate().all(|(k, wanted)| text_at(pieces, at + k) == *wanted)
                && comma_at(pieces, at + said.len())
        });
        // `five people, that is, four`
        let corrects = |said: &&&[&str]| {
            said.len() == 2
                && text_at(pieces, at) == "that"
                && word_at(pieces, at + 3).is_some_and(|word| word.count().is_some())
        };
        let Some(length) = found.filter(|said| !corrects(said)).map(|said| said.len()) else {
            at += 1;
            continue;
        };
        // Behind a stop the comma goes with them; between commas both go, if the sentence goes on with its verb.
        let between = at > 0 && comma_at(pieces, at - 1);
        let from = if between && goes_on(pieces, at + length + 1) { at - 1 } else { at };
        pieces.drain(from..=at + length);
        at = from;
    }
}

/// `Following Hall's notion of personal space, …`, `a leader-follower triad`: words that speak of no follower and no leader.
pub(crate) fn notions(pieces: &mut [Piece]) {
    let mut told = Vec::new();
    for at in 0..pieces.len() {
        let first = at == 0 || matches!(pieces.get(at - 1), Some(Piece::Stop | Piece::Colon));
        if first && matches!(text_at(pieces, at), "following" | "given" | "considering" | "regarding") {
            let end = (at + 1..at + 12).find(|k| comma_at(pieces, *k));
            let body = |k: usize| {
                word_at(pieces, k).is_some_and(|word| word.stem == "robot" || lexicon().roles.contains_key(&word.stem))
            };
            told.extend(end.filter(|end| !(at..*end).any(body)).map(|end| at..end).into_iter().flatten());
        }
        // `like most of our people he steps aside`
        if text_at(pieces, at) == "like" && matches!(text_at(pieces, at + 1), "most" | "many" | "all" | "other") {
            let end = (at + 2..at + 8)
                .find(|k| comma_at(pieces, *k) || matches!(text_at(pieces, *k), "he" | "she" | "they" | "the" | "a"));
            told.extend(end.map(|end| at..end).into_iter().flatten());
        }
        // `The leader, unlike the picker, steps aside`
        if text_at(pieces, at) == "unlike" {
            let end = (at + 1..at + 8).find(|k| comma_at(pieces, *k));
            told.extend(end.map(|end| at..end).into_iter().flatten());
        }
        // Joined by a hyphen, two who deal with each other name a kind of thing.
        let joined = word_at(pieces, at).zip(word_at(pieces, at + 1)).is_some_and(|(one, other)| {
            let role = |word: &Word| {
                lexicon().roles.contains_key(&word.stem) || matches!(word.stem.as_str(), "robot" | "follower")
            };
            one.to + 1 == other.from && role(one) && role(other)
        });
        let hyphen = joined && word_at(pieces, at + 2).is_some_and(|next| !lexicon().verbs.contains(&next.stem));
        if hyphen && !matches!(text_at(pieces, at + 2), "and" | "who" | "in" | "on" | "at") {
            told.extend([at, at + 1]);
        }
    }
    silence(pieces, told);
}

/// Whether a clause that was begun goes on here with its verb.
fn goes_on(pieces: &[Piece], at: usize) -> bool {
    word_at(pieces, at).is_some_and(|word| {
        lexicon().verbs.contains(&word.stem) && !lexicon().roles.contains_key(&word.stem)
            || matches!(
                word.text.as_str(),
                "never" | "not" | "just" | "only" | "always" | "simply" | "then" | "who" | "with"
            )
    })
}

/// Whether such words may begin here.
fn opens(pieces: &[Piece], at: usize) -> bool {
    at == 0 || !matches!(pieces.get(at - 1), Some(Piece::Word(_)))
}
