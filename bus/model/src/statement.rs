//! Statements: what became of each piece of a request's texts. Together they account for every word that says something.

use std::fmt;
use std::ops::Range;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::fault::{Message, Span};
use crate::request::Request;

/// A text of the request.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TextKey {
    /// `rough_scenario`.
    RoughScenario,
    /// `task`.
    Task,
    /// `social_context`.
    SocialContext,
}

impl TextKey {
    /// The texts, in the order in which they are shown.
    pub const ALL: [Self; 3] = [Self::RoughScenario, Self::Task, Self::SocialContext];

    /// The text of a request; empty where it has none.
    #[must_use]
    pub fn text_of(self, request: &Request) -> &str {
        match self {
            Self::RoughScenario => request.rough_scenario.as_deref().unwrap_or_default(),
            Self::Task => &request.task,
            Self::SocialContext => &request.social_context,
        }
    }

    /// The key in the request.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::RoughScenario => "rough_scenario",
            Self::Task => "task",
            Self::SocialContext => "social_context",
        }
    }
}

impl fmt::Display for TextKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Why words ask for nothing that could be seen in a run. A closed list: whatever has none of these reasons is a wish.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Background {
    /// Place, time of day and mood of the whole.
    Setting,
    /// The robot's task in other words: what it carries, and why.
    Errand,
    /// About the study, or the asker: `we want to see whether the robot waits`.
    Comment,
    /// Why somebody does what is stated: `because she is late`.
    Cause,
    /// How somebody or something looks or feels, and what they have with them.
    Looks,
    /// Speaks to the program: nothing is done about it.
    Instruction,
    /// Of other days: `last week a visitor …`.
    Report,
}

impl Background {
    /// Every reason.
    pub const ALL: [Self; 7] =
        [Self::Setting, Self::Errand, Self::Comment, Self::Cause, Self::Looks, Self::Instruction, Self::Report];

    /// The reason in a word or two, as `socrates read` shows it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Setting => "setting",
            Self::Errand => "errand",
            Self::Comment => "comment",
            Self::Cause => "cause",
            Self::Looks => "looks",
            Self::Instruction => "instruction",
            Self::Report => "report",
        }
    }
}

/// What a piece of a text became.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Became {
    /// It was read.
    Read {
        /// What of the form it became: `human_1: relation = "frontal"`. Empty where it repeats what another piece says.
        lines: Vec<String>,
        /// The facts of the reading that it became, by their ids.
        facts: Vec<String>,
    },
    /// It asks for nothing.
    Background(Background),
    /// It was understood, and is not played.
    NotPlayed {
        /// Why, and what is played instead.
        why: Message,
    },
    /// The author calls it background, and the grammar finds in it what somebody does: a person has to say which is right.
    Disputed {
        /// The author's reason.
        reason: Background,
        /// What the grammar read of it: `human_1: relation = "frontal"`.
        found: Vec<String>,
    },
    /// It was not understood.
    NotRead {
        /// The sentence in other words that would be read, found by trying it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        rewording: Option<String>,
    },
}

/// One piece of a text, and what became of it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Statement {
    /// Which text.
    pub at: TextKey,
    /// Where in it, in characters from 0.
    pub span: Span,
    /// Its words, as they stand there.
    pub quote: String,
    /// What became of it.
    pub became: Became,
    /// Whether `waive` of the request gives it up.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub waived: bool,
}

/// Whether a quote stands in a text so that it has all of these bytes.
#[must_use]
pub fn covers(text: &str, quote: &str, bytes: &Range<usize>) -> bool {
    !quote.is_empty()
        && text.match_indices(quote).any(|(from, _)| from <= bytes.start && bytes.end <= from + quote.len())
}

impl Statement {
    /// Whether it stands in the same text as a span, and has a character in common with that.
    #[must_use]
    pub fn meets(&self, at: TextKey, span: Span) -> bool {
        self.at == at && self.span.overlaps(span)
    }

    /// The same, given up where it is a wish that is not in the run and `waive` of the request has its words.
    #[must_use]
    pub fn waived_by(mut self, request: &Request) -> Self {
        let text = self.at.text_of(request);
        let is_given_up = |bytes: Range<usize>| request.waive.iter().any(|quote| covers(text, quote, &bytes));
        self.waived = self.is_unplayed() && self.span.bytes(text).is_some_and(is_given_up);
        self
    }

    /// Whether it is a wish that is not in the run, and that nobody has given up.
    #[must_use]
    pub const fn is_missing(&self) -> bool {
        !self.waived && self.is_unplayed()
    }

    /// Whether it is a wish that is not in the run.
    #[must_use]
    pub const fn is_unplayed(&self) -> bool {
        matches!(self.became, Became::NotPlayed { .. } | Became::Disputed { .. } | Became::NotRead { .. })
    }

    /// Whether it was not understood.
    #[must_use]
    pub const fn is_unread(&self) -> bool {
        matches!(self.became, Became::NotRead { .. })
    }

    /// What it is called that became of it: `read`, `background`, `not played`, `disputed`, `not read`, `waived`.
    #[must_use]
    pub const fn fate(&self) -> &'static str {
        match self.became {
            _ if self.waived => "waived",
            Became::Read { .. } => "read",
            Became::Background(_) => "background",
            Became::NotPlayed { .. } => "not played",
            Became::Disputed { .. } => "disputed",
            Became::NotRead { .. } => "not read",
        }
    }

    /// What became of it, in words for people: the lines of a form, the reason, or what helps.
    #[must_use]
    pub fn told(&self) -> String {
        match &self.became {
            Became::Read { lines, .. } if lines.is_empty() => "goes with the rest".to_owned(),
            Became::Read { lines, .. } => lines.join("; "),
            Became::Background(reason) => reason.name().to_owned(),
            Became::NotPlayed { why } => why.to_string(),
            Became::Disputed { reason, found } => {
                format!("{} to the author; the grammar reads: {}", reason.name(), found.join("; "))
            }
            Became::NotRead { rewording: Some(other) } => format!("would be read: `{other}`"),
            Became::NotRead { rewording: None } => "say it in other words, or as a form".to_owned(),
        }
    }
}
