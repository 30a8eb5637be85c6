//! The sentences of a request, numbered: an author that reads the texts itself accounts for each of them.

use std::ops::Range;

use socrates_model::Request;
use socrates_model::fault::Span;
use socrates_model::statement::TextKey;
use unicode_segmentation::UnicodeSegmentation as _;

use crate::prompt::{clean, most_shown};

/// Fewer words than this are no sentence of their own: `Dr.` goes with what follows.
const LEAST_WORDS: usize = 2;

/// One sentence of a request's texts.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Sentence {
    /// Its number in the request: `s1`, `s2`, …
    pub id: String,
    /// The text in which it stands.
    pub at: TextKey,
    /// Where in that text, in characters from 0.
    pub span: Span,
    /// Its words, as they stand there.
    pub quote: String,
    /// Its words as an author is shown them: without hidden characters.
    pub shown: String,
}

/// Every sentence of the texts of a request, in any language, in the order of [`TextKey::ALL`]. Together they have every character that is
/// not a blank.
#[must_use]
pub fn sentences(request: &Request) -> Vec<Sentence> {
    let mut found = Vec::new();
    for at in TextKey::ALL {
        let text = at.text_of(request);
        for bytes in bounds(text) {
            let Some((quote, span)) = text.get(bytes.clone()).zip(Span::of(text, &bytes)) else { continue };
            found.push(Sentence {
                id: format!("s{}", found.len() + 1),
                at,
                span,
                quote: quote.to_owned(),
                shown: clean(quote, most_shown(at)),
            });
        }
    }
    found
}

/// A line of fewer characters than this was not wrapped: a heading, an item of a list.
const WRAPPED: usize = 40;

/// The text with blanks for line breaks that only wrap it, byte for byte as long: a line that goes on in lower case, or a long one that ends
/// in no punctuation. Empty lines and lists stay apart.
fn unwrapped(text: &str) -> String {
    let mut flowing = String::with_capacity(text.len());
    let mut lines = text.split_inclusive('\n').peekable();
    while let Some(line) = lines.next() {
        let words = line.trim_end();
        let next = lines.peek().and_then(|next| next.trim_start_matches([' ', '\t']).chars().next());
        let goes_on = words.chars().last().is_some_and(|last| last.is_alphanumeric() || ",;)\"”".contains(last));
        let long = words.chars().count() >= WRAPPED && goes_on;
        let wraps = !words.is_empty() && next.is_some_and(|next| next.is_lowercase() || long && next.is_alphanumeric());
        flowing.push_str(words);
        let rest = line.get(words.len()..).unwrap_or_default();
        if wraps {
            flowing.extend(std::iter::repeat_n(' ', rest.len()));
        } else {
            flowing.push_str(rest);
        }
    }
    flowing
}

/// The bytes of each sentence, without the blanks around.
fn bounds(text: &str) -> Vec<Range<usize>> {
    let mut found: Vec<Range<usize>> = Vec::new();
    let mut open = None;
    let flowing = unwrapped(text);
    for (from, piece) in flowing.split_sentence_bound_indices() {
        if piece.trim().is_empty() {
            continue;
        }
        let from = from + piece.len() - piece.trim_start().len();
        let to = from + piece.trim().len();
        let start = open.take().unwrap_or(from);
        let words = flowing.get(start..to).unwrap_or_default().unicode_words().take(LEAST_WORDS).count();
        if words < LEAST_WORDS { open = Some(start) } else { found.push(start..to) }
    }
    // What is left belongs to what stands before it.
    if let Some(start) = open {
        let end = text.trim_end().len();
        match found.last_mut() {
            Some(last) => last.end = end,
            None => found.push(start..end),
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(rough: &str) -> Vec<Sentence> {
        let request =
            serde_json::json!({"location": "x", "social_context": "A hall.", "task": "Go", "rough_scenario": rough});
        sentences(&serde_json::from_value(request).unwrap())
    }

    fn shown(rough: &str) -> Vec<String> {
        of(rough).into_iter().filter(|one| one.at == TextKey::RoughScenario).map(|one| one.quote).collect()
    }

    #[test]
    fn a_wrapped_line_goes_on_and_a_list_does_not() {
        let wrapped = "A person comes towards the robot and stops to look at it\nwhen it is within 3 m. When the robot\nstops they go\non.";
        assert_eq!(shown(wrapped).len(), 2, "{:?}", shown(wrapped));
        let long = "Zwei Kollegen gehen plaudernd nebeneinander hinter dem\nRoboter her.";
        assert_eq!(shown(long), [long]);
        let list = "- a nurse crosses the corridor\n- a visitor follows the robot";
        assert_eq!(shown(list).len(), 2, "{:?}", shown(list));
        let apart = "Two people stand in the way of it and talk\n\nOne of them waves.";
        assert_eq!(shown(apart).len(), 2, "{:?}", shown(apart));
    }

    #[test]
    fn sentences_are_found_in_any_language() {
        assert_eq!(shown("A nurse waits. She waves!"), ["A nurse waits.", "She waves!"]);
        assert_eq!(
            shown("Eine Ärztin kommt dem Roboter entgegen. Sie bleibt stehen."),
            ["Eine Ärztin kommt dem Roboter entgegen.", "Sie bleibt stehen."]
        );
        assert_eq!(
            shown("两个人站在走廊里聊天。机器人从他们旁边经过。"),
            ["两个人站在走廊里聊天。", "机器人从他们旁边经过。"]
        );
    }

    #[test]
    fn a_word_alone_goes_with_what_stands_beside_it() {
        assert_eq!(shown("Dr. Smith waits at the door. Then."), ["Dr. Smith waits at the door. Then."]);
        assert_eq!(shown("Wait"), ["Wait"]);
        assert_eq!(shown("  "), [""; 0]);
    }

    #[test]
    fn every_character_lies_in_a_sentence_and_spans_count_characters() {
        let rough = "  Ein Mann grüßt.\nEr geht – langsam – weiter.  Ende";
        let all = of(rough);
        let ids: Vec<&str> = all.iter().map(|one| one.id.as_str()).collect();
        assert_eq!(ids, ["s1", "s2", "s3", "s4"], "{all:?}");
        for one in &all {
            let text: String = match one.at {
                TextKey::RoughScenario => rough,
                TextKey::Task => "Go",
                TextKey::SocialContext => "A hall.",
            }
            .chars()
            .skip(one.span.from as usize)
            .take((one.span.to - one.span.from) as usize)
            .collect();
            assert_eq!(text, one.quote);
        }
        let letters = |text: &str| text.chars().filter(|c| !c.is_whitespace()).collect::<String>();
        let mine: String = shown(rough).iter().map(|text| letters(text)).collect();
        assert_eq!(mine, letters(rough));
    }
}
