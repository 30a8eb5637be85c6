//! A thin client for language models, and recordings of them.
//!
//! ```text
//! ChatRequest ──► ChatClient ──HTTP──► server        (errors: ChatError, each with what to wait for)
//!      │            │ Dialect: whose server it is · Wire: Chat Completions, Responses, Messages, generateContent
//!      │            │ Rung: how far it enforces the form of the answer, learned by what it refuses
//!      │            └ Listener: how much of the answer came so far, while it comes
//!      └────────► Cassette (one file per exchange, found by the BLAKE3 of the request)
//! ```
//!
//! One ask is one answer: no retry here, as the caller's caller owns patience and budgets. Only a question that was refused for
//! its form, its picture, or the wish for an answer in parts is put again without what was refused.
//!
//! *Never here:* a word of what is asked about, a prompt, a retry, an environment variable, a key in a
//! message, a log line or a file.

pub mod cassette;
pub mod chat;
pub mod client;
pub mod dialect;
pub mod error;
pub mod estimate;
pub mod form;
pub mod key;
pub mod limits;
mod listener;
pub mod models;
pub mod ordered;
pub mod probe;

mod events;
mod waits;
mod wire;

#[cfg(test)]
mod client_tests;
#[cfg(test)]
mod server;
#[cfg(test)]
mod stream_tests;

pub use cassette::{Cassette, CassetteError, Nearest};
pub use chat::{ChatAnswer, ChatRequest, Detail, Finish, Speaker, Turn};
pub use client::{ChatClient, ClientConfig};
pub use dialect::{Dialect, Known, Learned, Rung, UnknownName, Wire};
pub use error::{ChatError, Objection};
pub use key::{ApiKey, strike_shapes};
pub use limits::{Limits, Rate};
pub use listener::Listener;
