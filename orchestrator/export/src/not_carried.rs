//! What a format could not hold: kinds of content with where they stood and why they were left behind.

use serde::{Deserialize, Serialize};

/// At most so many places are named for a kind; the count tells of all.
const SHOWN: usize = 8;

/// A kind of content that was left behind.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NotCarried {
    /// What it is, such as `door rules`.
    pub what: String,
    /// How much of it.
    pub count: usize,
    /// Where it stood, for the first few.
    pub at: Vec<String>,
    /// Why it was left behind, or what stands in its place.
    pub why: String,
}

/// Collects what is left behind, kind by kind, in the order of the first finds.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Losses(Vec<NotCarried>);

impl Losses {
    /// Notes one thing of a kind.
    pub fn note(&mut self, what: &str, at: impl Into<String>, why: &str) {
        let row = match self.0.iter_mut().position(|row| row.what == what) {
            Some(place) => self.0.get_mut(place),
            None => {
                let (what, why) = (what.to_owned(), why.to_owned());
                self.0.push(NotCarried { what, count: 0, at: Vec::new(), why });
                self.0.last_mut()
            }
        };
        if let Some(row) = row {
            row.count += 1;
            if row.at.len() < SHOWN {
                row.at.push(at.into());
            }
        }
    }

    /// The kinds, in the order of the first finds.
    #[must_use]
    pub fn rows(&self) -> &[NotCarried] {
        &self.0
    }

    /// The text of a `not_carried.json`; the same losses give the same bytes.
    #[must_use]
    pub fn json(&self, format: &str) -> String {
        #[derive(Serialize)]
        struct File<'a> {
            format: &'a str,
            not_carried: &'a [NotCarried],
        }
        let mut text =
            serde_json::to_string_pretty(&File { format, not_carried: &self.0 }).unwrap_or_else(|why| why.to_string());
        text.push('\n');
        text
    }
}
