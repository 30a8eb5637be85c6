//! The link between processes: keys, envelope, codec and the [`Bus`] itself.
//!
//! ```text
//! caller ── call(key, kind, &request) ──► envelope ──► Bus ──► Ask ──► answer ──► envelope ──► reply
//!                                                       │
//!                                     MemoryBus (tests) ┴ ZenohBus (everything else)
//! ```
//!
//! Modules in reading order: errors, keys, the envelope and its one codec, the trait with the
//! things it hands out, then the two buses and the typed calls on top of either.
//!
//! *Never here:* a job's meaning, a retry (the caller owns its backoff), a file, a word of zenoh in
//! a public signature, a callback that does more than hand a message to a bounded mailbox.

mod error;
pub mod keys;

mod envelope;
pub use envelope::{Envelope, MIN_VERSION, VERSION, decode, encode};

mod bus;
mod mailbox;
pub use bus::{AliveToken, Ask, Bus, Overflow, Presence, Publish, Qos, Reply, Serving, Subscription};

mod call;
pub use call::{KIND_REFUSED, Refusal, call, call_envelope};

mod memory;
mod zenoh_bus;
pub use memory::MemoryBus;
pub use zenoh_bus::{Mode, ZenohBus, ZenohConfig};

pub use async_trait::async_trait;
pub use error::LinkError;
