//! The bus as everybody sees it, and the things it hands out.

use std::time::Duration;

use async_trait::async_trait;
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::call::{KIND_OTHER_REIGN, KIND_REFUSED, Refusal};
use crate::envelope::{Envelope, ReignId, decode, encode};
use crate::error::LinkError;
use crate::mailbox::Mailbox;

/// How a publication is carried. Each has a priority of its own, because a blocking message can hold up
/// a dropping one of the same priority.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Qos {
    /// Blocks the sender rather than be lost; sent at once.
    Control,
    /// May be lost; sent at once.
    Hint,
    /// May be lost, gives way to everything else; batched.
    Stream,
}

/// What a full subscription does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Overflow {
    /// Loses its oldest message and counts it.
    DropOldest,
    /// Holds the sender up, at most 5 s.
    Block,
}

/// Carries messages of at most 64 KiB between processes. Keys are relative to the namespace (see [`crate::keys`]).
#[async_trait]
pub trait Bus: Send + Sync + 'static {
    /// Name of this participant, written into envelopes.
    fn name(&self) -> &str;

    /// Asks whoever serves the key and gives the first reply.
    ///
    /// # Errors
    /// [`LinkError::NoReply`] when nobody serves it or whoever did is gone, [`LinkError::Timeout`] after `timeout`,
    /// [`LinkError::TooLarge`], [`LinkError::BadKey`], [`LinkError::Closed`], [`LinkError::Transport`].
    async fn query(&self, key: &str, body: Vec<u8>, timeout: Duration) -> Result<Vec<u8>, LinkError>;

    /// Asks everybody who serves a key under the expression and gives the replies that came within `timeout`, at most `most` of them,
    /// in the order in which they came. Nobody serving is no error.
    ///
    /// # Errors
    /// [`LinkError::TooLarge`], [`LinkError::BadKey`], [`LinkError::Closed`], [`LinkError::Transport`].
    async fn query_all(
        &self,
        expression: &str,
        body: Vec<u8>,
        most: usize,
        timeout: Duration,
    ) -> Result<Vec<Vec<u8>>, LinkError>;

    /// Serves a key, or every key under an expression: queries come as [`Ask`]s until the [`Serving`] is dropped. One process serves
    /// a key.
    ///
    /// # Errors
    /// [`LinkError::BadKey`], [`LinkError::Closed`], [`LinkError::Transport`].
    async fn serve(&self, key: &str) -> Result<Serving, LinkError>;

    /// Publishes to whoever listens now.
    ///
    /// # Errors
    /// [`LinkError::TooLarge`], [`LinkError::BadKey`], [`LinkError::Closed`], [`LinkError::Transport`]; nobody listening is none.
    async fn publish(&self, key: &str, body: Vec<u8>, qos: Qos) -> Result<(), LinkError>;

    /// Declares that much will be published to a key, so that it is known whether anybody listens. Taken back when dropped.
    ///
    /// # Errors
    /// [`LinkError::BadKey`], [`LinkError::Closed`], [`LinkError::Transport`].
    async fn publisher(&self, key: &str, qos: Qos) -> Result<Box<dyn Publish>, LinkError>;

    /// Listens to a key expression with room for `depth` messages.
    ///
    /// # Errors
    /// [`LinkError::BadKey`], [`LinkError::Closed`], [`LinkError::Transport`].
    async fn subscribe(&self, expression: &str, depth: usize, overflow: Overflow) -> Result<Subscription, LinkError>;

    /// Shows a presence token until it is dropped or this process is gone.
    ///
    /// # Errors
    /// [`LinkError::BadKey`], [`LinkError::Closed`], [`LinkError::Transport`].
    async fn declare_alive(&self, key: &str) -> Result<AliveToken, LinkError>;

    /// Tells of every presence token under an expression: those there already, and every change.
    ///
    /// # Errors
    /// [`LinkError::BadKey`], [`LinkError::Closed`], [`LinkError::Transport`].
    async fn watch_alive(&self, expression: &str) -> Result<Presence, LinkError>;

    /// Leaves the bus; waits at most 3 s. Everything it handed out ends.
    async fn close(&self);
}

/// A key that one participant publishes to again and again; see [`Bus::publisher`].
#[async_trait]
pub trait Publish: Send + Sync {
    /// Whether anybody listens. A listener is known a moment after it came.
    fn is_heard(&self) -> bool;

    /// Publishes to whoever listens now.
    ///
    /// # Errors
    /// As [`Bus::publish`].
    async fn put(&self, body: Vec<u8>) -> Result<(), LinkError>;
}

/// What must live as long as a declaration; dropping it takes the declaration back.
pub(crate) type Guard = Box<dyn Send + Sync>;

/// Sends the reply of one query.
#[async_trait]
pub trait Reply: Send {
    /// Sends it.
    ///
    /// # Errors
    /// [`LinkError::Transport`] when the transport does not take it.
    async fn send(self: Box<Self>, key: &str, body: Vec<u8>) -> Result<(), LinkError>;
}

/// A query to be answered. Dropped unanswered, the asker gets [`LinkError::NoReply`] at once.
pub struct Ask {
    key: String,
    body: Vec<u8>,
    reply: Box<dyn Reply>,
    reign: Option<ReignId>,
}

impl Ask {
    /// A query with the way back.
    #[must_use]
    pub fn new(key: String, body: Vec<u8>, reply: Box<dyn Reply>) -> Self {
        Self { key, body, reply, reign: None }
    }

    /// The same, to be answered in this reign.
    #[must_use]
    pub fn in_reign(self, reign: ReignId) -> Self {
        Self { reign: Some(reign), ..self }
    }

    /// The reign in which it is answered.
    #[must_use]
    pub const fn reign(&self) -> Option<ReignId> {
        self.reign
    }

    /// Key that was asked.
    #[must_use]
    pub fn key(&self) -> &str {
        &self.key
    }

    /// What was sent along.
    #[must_use]
    pub fn body(&self) -> &[u8] {
        &self.body
    }

    /// The request inside.
    ///
    /// # Errors
    /// As [`decode`].
    pub fn read<T: DeserializeOwned>(&self, kind: &str) -> Result<Envelope<T>, LinkError> {
        decode(kind, &self.body)
    }

    /// Replies with plain bytes.
    ///
    /// # Errors
    /// [`LinkError::TooLarge`] above 64 KiB, [`LinkError::Transport`].
    pub async fn reply(self, body: Vec<u8>) -> Result<(), LinkError> {
        let body = crate::envelope::fits(&self.key, body)?;
        self.reply.send(&self.key, body).await
    }

    /// Replies with a message.
    ///
    /// # Errors
    /// As [`encode`] and [`Ask::reply`].
    pub async fn answer<T: Serialize + Sync>(
        self,
        kind: &str,
        sender: &str,
        epoch: u64,
        body: &T,
    ) -> Result<(), LinkError> {
        let bytes = encode(&Envelope::fresh(kind, sender, epoch, body).in_reign(self.reign))?;
        self.reply(bytes).await
    }

    /// Says no, for good: the asker gets [`LinkError::Refused`].
    ///
    /// # Errors
    /// As [`Ask::reply`].
    pub async fn refuse(self, sender: &str, epoch: u64, why: &str) -> Result<(), LinkError> {
        let refusal = Refusal { why: why.chars().take(4000).collect() };
        self.answer(KIND_REFUSED, sender, epoch, &refusal).await
    }

    /// Says that the reign of the question is unknown here: the asker gets [`LinkError::OtherReign`].
    ///
    /// # Errors
    /// As [`Ask::reply`].
    pub async fn disown(self, sender: &str, epoch: u64) -> Result<(), LinkError> {
        self.answer(KIND_OTHER_REIGN, sender, epoch, &()).await
    }
}

impl std::fmt::Debug for Ask {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Ask").field("key", &self.key).field("len", &self.body.len()).finish_non_exhaustive()
    }
}

/// A stream out of a mailbox that lives as long as its declaration.
struct Inbox<T> {
    mailbox: Mailbox<T>,
    _guard: Guard,
}

impl<T> Drop for Inbox<T> {
    fn drop(&mut self) {
        self.mailbox.close();
    }
}

/// Queries of one served key.
pub struct Serving(Inbox<Ask>);

impl Serving {
    pub(crate) fn new(mailbox: Mailbox<Ask>, guard: Guard) -> Self {
        Self(Inbox { mailbox, _guard: guard })
    }

    /// The next query; `None` once the bus is closed.
    pub async fn next(&mut self) -> Option<Ask> {
        self.0.mailbox.pop().await
    }
}

/// Messages of one key expression, as key and body.
pub struct Subscription(Inbox<(String, Vec<u8>)>);

impl Subscription {
    pub(crate) fn new(mailbox: Mailbox<(String, Vec<u8>)>, guard: Guard) -> Self {
        Self(Inbox { mailbox, _guard: guard })
    }

    /// The next message; `None` once the bus is closed.
    pub async fn next(&mut self) -> Option<(String, Vec<u8>)> {
        self.0.mailbox.pop().await
    }

    /// The next message, if one is here now.
    pub fn try_next(&mut self) -> Option<(String, Vec<u8>)> {
        self.0.mailbox.try_pop()
    }

    /// How many messages were lost because nobody read them in time.
    #[must_use]
    pub fn lost(&self) -> u64 {
        self.0.mailbox.lost()
    }
}

/// Presence changes under one key expression. The same state may be told twice.
pub struct Presence(Inbox<(String, bool)>);

impl Presence {
    pub(crate) fn new(mailbox: Mailbox<(String, bool)>, guard: Guard) -> Self {
        Self(Inbox { mailbox, _guard: guard })
    }

    /// The next change: token and whether it is there now; `None` once the bus is closed.
    pub async fn next(&mut self) -> Option<(String, bool)> {
        self.0.mailbox.pop().await
    }
}

/// A presence token; dropping it takes it back.
pub struct AliveToken(#[expect(dead_code, reason = "held for its drop")] Guard);

impl AliveToken {
    pub(crate) fn new(guard: Guard) -> Self {
        Self(guard)
    }
}
