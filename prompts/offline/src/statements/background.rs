//! Why words that were not read ask for nothing, where they do: one reason of a closed list.

use socrates_model::statement::Background;

use super::text::Token;
use super::words::{Kind, is_person};

/// Words of the asker.
const ASKERS: &[&str] = &["we", "i", "our", "us", "my", "i'd", "we'd", "i'm", "we're"];
/// What is spoken of where a study is, after an article.
pub(super) const STUDIES: &[&str] = &[
    "study",
    "experiment",
    "test",
    "scenario",
    "case",
    "question",
    "aim",
    "goal",
    "purpose",
    "point",
    "idea",
    "hypothesis",
    "benchmark",
    "trial",
    "thesis",
    "paper",
    "survey",
    "condition",
    "evaluation",
    "measure",
    "metric",
    "expectation",
];
/// Words with which the asker wants to know something.
const QUESTIONS: &[&str] = &["whether", "how", "what", "why", "if"];
/// Words of other days.
const REPORTS: &[&str] = &["yesterday", "usually", "normally", "typically", "recently", "earlier"];
/// Words before a reason.
const CAUSES: &[&str] = &["because", "since", "due"];

/// What is known of the words around.
pub(super) struct Around<'a> {
    pub(super) tokens: &'a [Token],
    pub(super) kinds: &'a [Kind],
    /// Per word: whether it was read.
    pub(super) read: &'a [bool],
}

impl Around<'_> {
    fn words(&self, of: impl Fn(&Token) -> bool) -> impl Iterator<Item = usize> {
        (0..self.tokens.len()).filter(move |place| self.tokens.get(*place).is_some_and(&of))
    }

    fn is(&self, place: usize, table: &[&str]) -> bool {
        self.tokens.get(place).is_some_and(|token| table.contains(&token.lower.as_str()))
    }

    fn is_read(&self, place: usize) -> bool {
        self.read.get(place).copied().unwrap_or(false)
    }

    fn asks(&self, place: usize) -> bool {
        self.kinds.get(place).is_some_and(|kind| kind.asks())
    }

    /// Why a word that was not read asks for nothing; nothing where it does ask.
    pub(super) fn reason(&self, place: usize) -> Option<Background> {
        let token = self.tokens.get(place)?;
        let sentence: Vec<usize> = self.words(|other| other.sentence == token.sentence).collect();
        if self.comments(&sentence, place) {
            return Some(Background::Comment);
        }
        if sentence.iter().any(|k| self.is(*k, REPORTS)) && !sentence.iter().any(|k| self.is_read(*k)) {
            return Some(Background::Report);
        }
        if self.asks(place) {
            return None;
        }
        let clause = self.words(|other| other.clause == token.clause).next()?;
        if self.is(clause, CAUSES) {
            return Some(Background::Cause);
        }
        let scene = sentence.iter().any(|k| self.is_read(*k))
            || sentence.iter().any(|k| self.tokens.get(*k).is_some_and(is_person));
        Some(if scene { Background::Looks } else { Background::Setting })
    }

    /// Whether the words from where the asker or the study comes in speak of them alone: nothing of it was read, and nobody does
    /// anything there.
    fn comments(&self, sentence: &[usize], place: usize) -> bool {
        let opens = |k: &usize| {
            let article = k.checked_sub(1).is_some_and(|before| self.is(before, &["the", "this", "our", "a", "my"]));
            self.is(*k, ASKERS) || article && self.is(*k, STUDIES)
        };
        let Some(from) = sentence.iter().position(opens) else { return false };
        let zone = sentence.get(from..).unwrap_or_default();
        let people = zone.iter().any(|k| self.tokens.get(*k).is_some_and(is_person));
        let asks = zone.iter().any(|k| self.is(*k, QUESTIONS));
        let wishes = zone.iter().any(|k| self.is_read(*k));
        zone.contains(&place) && !wishes && (asks || !people)
    }
}
