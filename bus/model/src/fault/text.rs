//! Texts that are for display only.

use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Whether [`Message::new`] keeps `x` in place of its text.
static MASKED: AtomicBool = AtomicBool::new(false);

/// From now on, in the whole process, every message that is made or read says `x`: for the test which shows that no decision
/// depends on one.
#[doc(hidden)]
pub fn mask_messages(masked: bool) {
    MASKED.store(masked, Ordering::SeqCst);
}

/// What people and authors read about a fault. It can be shown, stored, compared with another one and cut; no text comes out
/// of it to be searched.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(from = "String")]
#[schemars(with = "String")]
pub struct Message(String);

impl Message {
    /// The message of a text.
    pub fn new(text: impl Into<String>) -> Self {
        if MASKED.load(Ordering::Relaxed) { Self("x".to_owned()) } else { Self(text.into()) }
    }

    /// At most so many characters of it.
    #[must_use]
    pub fn shortened(mut self, characters: usize) -> Self {
        cut(&mut self.0, characters);
        self
    }

    /// Its length in UTF-8, bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.0.len()
    }
}

impl<T: Into<String>> From<T> for Message {
    fn from(text: T) -> Self {
        Self::new(text)
    }
}

impl fmt::Display for Message {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&self.0)
    }
}

/// A name within a place, as it is shown: a file, a key, an element of a tree. Two of them are the same or not; like a
/// [`Message`], no text comes out of it to be searched.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
#[schemars(with = "String")]
pub struct Label(String);

impl Label {
    /// The name of something that can be shown.
    pub fn new(name: impl fmt::Display) -> Self {
        Self(name.to_string())
    }

    /// At most so many characters of it.
    #[must_use]
    pub fn shortened(mut self, characters: usize) -> Self {
        cut(&mut self.0, characters);
        self
    }
}

impl fmt::Display for Label {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&self.0)
    }
}

fn cut(text: &mut String, characters: usize) {
    if let Some((end, _)) = text.char_indices().nth(characters) {
        text.truncate(end);
    }
}
