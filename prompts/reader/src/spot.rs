//! Where the words of a place stand, for those who have a map on which it may have that name.

use std::ops::Range;

use socrates_model::PlaceClass;

use crate::chunk::{Is, chunks, place};
use crate::lexicon::Lexicon;
use crate::token::{Sort, Token};

/// Words of a name before the word for the place, at most.
const BEFORE: usize = 2;
/// Words before or behind a place that tell whether somebody is outside of it.
const AROUND: usize = 3;

/// A place that a text names.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Named {
    /// Its class.
    pub class: PlaceClass,
    /// Its words, without an article, in bytes.
    pub own: Range<usize>,
    /// The same with the words before it that may belong to its name.
    pub whole: Range<usize>,
    /// Whether it is outside of it: `in front of the kitchen`, `at the meeting room door`.
    pub outside: bool,
}

/// The places of a text, in its order.
pub(crate) fn places(text: &str, lexicon: &Lexicon) -> Vec<Named> {
    let tokens = crate::lex::lex(text, &lexicon.words);
    let article = |token: &Token| token.is(Sort::Definite) || token.is(Sort::Indefinite) || token.is(Sort::Possessive);
    let bytes = |tokens: &[Token]| {
        let start = tokens.first().map_or(0, |token| token.at.start);
        start..tokens.last().map_or(start, |token| token.at.end)
    };
    // No word of a name: another one that says something is before it.
    let describes = |token: &Token| {
        token.is_said() && !token.says_nothing() && !token.is(Sort::Verb) && !token.is(Sort::Role) && !article(token)
    };
    let mut found = Vec::new();
    for chunk in chunks(&tokens, lexicon) {
        let Is::Place(Some(class)) = chunk.is else { continue };
        let own = tokens.get(chunk.tokens.clone()).unwrap_or_default();
        let skipped = own.iter().take_while(|token| article(token)).count();
        let end = chunk.tokens.end;
        let first = chunk.tokens.start + skipped;
        // `the busy corridor`: the word for the place, and the words before it.
        let is_place = |token: &Token| {
            let mut rows = [&token.lemma, &token.spelled].into_iter();
            rows.any(|word| lexicon.place_patterns.beginning(word).next().is_some())
        };
        let start = first + own.iter().skip(skipped).position(is_place).unwrap_or(0);
        let before = tokens.get(..first).unwrap_or_default();
        let words =
            if skipped > 0 { 0 } else { before.iter().rev().take(BEFORE).take_while(|token| describes(token)).count() };
        let behind = tokens.get(end..).unwrap_or_default();
        let outside = is_outside(before, own.iter().chain(behind.iter().take(AROUND - 1)), lexicon);
        let range = |from: usize| bytes(tokens.get(from..end).unwrap_or_default());
        found.push(Named { class, own: range(start), whole: range(first - words), outside });
        // `the meeting room door` names a room as well.
        let within = tokens.get(..end - 1).unwrap_or_default();
        if let Some((Some(room), behind)) = place(within, first, lexicon).filter(|(room, _)| *room != Some(class)) {
            let own = bytes(tokens.get(first..behind).unwrap_or_default());
            found.push(Named { class: room, whole: own.clone(), own, outside: true });
        }
    }
    found
}

fn is_outside<'a>(before: &[Token], mut own: impl Iterator<Item = &'a Token>, lexicon: &Lexicon) -> bool {
    let words = &lexicon.errands;
    let article = |token: &&Token| token.is(Sort::Definite) || token.is(Sort::Indefinite);
    let mut near = before.iter().rev().take(AROUND).skip_while(article);
    let Some(first) = near.next() else { return false };
    let mut front = || near.next().is_some_and(|next| words.front.contains(&next.spelled));
    words.outside.contains(&first.spelled)
        || first.is(Sort::Of) && front()
        || words.at_door.contains(&first.spelled) && own.any(|token| words.door.contains(&token.lemma))
}
