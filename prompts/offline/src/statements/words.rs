//! What kind of word it is, as far as the account of a task or context needs it.

use std::ops::Range;

use socrates_model::Location;
use socrates_model::statement::TextKey;
use socrates_reader::Reader;

use super::text::Token;

/// Kinds of words.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// Joins others, or stands for them: says nothing of its own.
    Connective,
    /// That something is not so.
    Denial,
    /// Anything else.
    Other,
}

/// The kinds of the words of a text that tells of nobody's deeds: a task, of which some words may deny something, or a context.
pub(super) fn kinds(tokens: &[Token], denied: &[Range<usize>], key: TextKey) -> Vec<Kind> {
    let denies = |token: &Token| {
        key == TextKey::Task && denied.iter().any(|at| at.start < token.at.end && token.at.start < at.end)
    };
    let kind = |token: &Token| match Reader::shipped().says_nothing(&token.lower) {
        _ if denies(token) => Kind::Denial,
        true => Kind::Connective,
        false => Kind::Other,
    };
    tokens.iter().map(kind).collect()
}

/// Whether a word tells which place of this map is meant.
pub(super) fn tells_place(word: &str, location: &Location) -> bool {
    // `the office`, in an office
    on_map(word, location) && !crate::named::telling(word).is_empty() && !location.name.contains(word)
}

/// Whether a word stands in the name of a place of this map.
pub(super) fn on_map(word: &str, location: &Location) -> bool {
    let named = |node: &socrates_model::GraphNode| {
        node.kind.to_lowercase().split(|c: char| !c.is_alphanumeric()).any(|part| part.len() > 2 && part == word)
    };
    location.graph.nodes().iter().any(named)
}
