//! What can go wrong between two processes.

use std::time::Duration;

use socrates_model::FailureClass;

/// A message that did not come through, or was not understood.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum LinkError {
    /// The query ended without any reply: nobody serves the key, or whoever did is gone. Never means "no work".
    #[error("`{key}` gave no reply: nobody serves it now")]
    NoReply {
        /// Key that was asked.
        key: String,
    },
    /// Nobody answered in time.
    #[error("`{key}` gave no reply within {} ms", after.as_millis())]
    Timeout {
        /// Key that was asked.
        key: String,
        /// The limit.
        after: Duration,
    },
    /// A message is larger than the bus carries; send a content address instead.
    #[error("message for `{key}` has {len} bytes, at most {cap} are carried; pass it by content address")]
    TooLarge {
        /// Key it was meant for.
        key: String,
        /// Its length, bytes.
        len: usize,
        /// The limit, bytes.
        cap: usize,
    },
    /// A key, key expression or namespace is not well formed.
    #[error("`{key}` is not a key: {why}")]
    BadKey {
        /// The key as given.
        key: String,
        /// What is wrong with it, and what would be allowed.
        why: String,
    },
    /// A body cannot be written as MessagePack.
    #[error("`{kind}` cannot be encoded: {why}")]
    Encode {
        /// Kind of the message.
        kind: String,
        /// The encoder's words.
        why: String,
    },
    /// Bytes are not a message of the expected kind.
    #[error("message of {len} bytes cannot be decoded as `{kind}`: {why}")]
    Decode {
        /// Expected kind.
        kind: String,
        /// Length of what came, bytes.
        len: usize,
        /// The decoder's words.
        why: String,
    },
    /// The message speaks a version that is not spoken here.
    #[error("message speaks version {found} and needs {needs} or newer; this side speaks {low} to {high}")]
    Incompatible {
        /// Version of the message.
        found: u32,
        /// Oldest reader it allows.
        needs: u32,
        /// Oldest version read here.
        low: u32,
        /// Newest version read here.
        high: u32,
    },
    /// The other side understood and said no.
    #[error("`{key}` was refused: {why}")]
    Refused {
        /// Key that was asked.
        key: String,
        /// The other side's words.
        why: String,
    },
    /// The orchestrator that answers never knew the reign which the asker serves: its job store is another one, or an older copy.
    #[error("`{key}` was refused: the job store of the orchestrator is another one, or an older copy of it")]
    OtherReign {
        /// Key that was asked.
        key: String,
    },
    /// The program was built without the bus between processes.
    #[error(
        "this program was built without the feature `{feature}`, so its processes cannot reach each other; build it with that feature"
    )]
    Absent {
        /// The feature of the build that is missing.
        feature: &'static str,
    },
    /// Keys cannot be used, or none are given where some are needed.
    #[error("{what}; {hint}")]
    Keys {
        /// What is wrong, with the file or the endpoint.
        what: String,
        /// What helps.
        hint: String,
    },
    /// The bus is closed.
    #[error("the bus is closed")]
    Closed,
    /// The transport underneath failed.
    #[error("{what} failed: {why}")]
    Transport {
        /// What was tried, with its value.
        what: String,
        /// The transport's words.
        why: String,
    },
}

impl LinkError {
    /// Whether waiting and trying again can help.
    #[must_use]
    pub const fn is_transient(&self) -> bool {
        matches!(self.class(), FailureClass::Transient)
    }

    /// How the orchestrator would treat it.
    #[must_use]
    pub const fn class(&self) -> FailureClass {
        match self {
            Self::NoReply { .. }
            | Self::Timeout { .. }
            | Self::Transport { .. }
            | Self::OtherReign { .. }
            | Self::Closed => FailureClass::Transient,
            Self::TooLarge { .. }
            | Self::BadKey { .. }
            | Self::Encode { .. }
            | Self::Incompatible { .. }
            | Self::Absent { .. }
            | Self::Keys { .. }
            | Self::Refused { .. } => FailureClass::Permanent,
            Self::Decode { .. } => FailureClass::Poison,
        }
    }
}
