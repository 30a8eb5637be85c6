//! The link between processes: keys, envelope, codec and the [`Bus`] itself.
//!
//! ```text
//! caller ── call(key, kind, &request) ──► envelope ──► Bus ──► Ask ──► answer ──► envelope ──► reply
//!                                                       │
//!                          MemoryBus (always, one process) ┴ ZenohBus (feature `zenoh`, between processes)
//! ```
//!
//! Modules in reading order: errors, keys, the envelope and its one codec, the trait with the
//! things it hands out, then the two buses, how to join the second, and the typed calls on top of either; then
//! who may do what on a router (`rules`), how they are known (`credentials`), and how those keys are made (`authority`).
//! Without the feature `zenoh`, [`join()`] is an error that names it.
//!
//! *Never here:* a job's meaning, a retry (the caller owns its backoff), a file other than keys, a word of zenoh in
//! a public signature, a callback that does more than hand a message to a bounded mailbox.

mod error;
pub mod keys;

mod envelope;
pub use envelope::{Envelope, GRANTS_VERSION, MIN_VERSION, ReignId, VERSION, decode, encode, wall_ms};

mod bus;
mod mailbox;
pub use bus::{AliveToken, Ask, Bus, Overflow, Presence, Publish, Qos, Reply, Serving, Subscription};

mod call;
pub use call::{KIND_OTHER_REIGN, KIND_REFUSED, Refusal, call, call_envelope};

mod authority;
#[cfg(feature = "zenoh")]
mod certificates;
mod credentials;
#[cfg(feature = "zenoh")]
mod handshake;
mod join;
mod memory;
pub mod rules;
#[cfg(feature = "zenoh")]
mod witness;
#[cfg(feature = "zenoh")]
mod zenoh_bus;
pub use authority::{KeysWish, RoleKeys, host_of, keys_of};
pub use credentials::{Credentials, RoleFile};
pub use join::{Mode, SECURE, ZenohConfig, check_endpoint, join};
pub use memory::MemoryBus;
#[cfg(feature = "zenoh")]
pub use zenoh_bus::ZenohBus;

pub use async_trait::async_trait;
pub use error::LinkError;
