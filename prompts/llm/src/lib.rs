//! A thin client for language models that speak the Chat Completions wire format, and recordings of them.
//!
//! ```text
//! ChatRequest ──► ChatClient ──HTTP──► server        (errors: ChatError, each with what to wait for)
//!      └────────► Cassette (one file per exchange, found by the BLAKE3 of the request)
//! ```
//!
//! One call is one HTTP request: no retry here, as the caller's caller owns patience and budgets.
//!
//! *Never here:* a word of what is asked about, a prompt, a retry, an environment variable, a key in a
//! message, a log line or a file.

mod base64;
pub mod cassette;
pub mod chat;
pub mod client;
pub mod error;
pub mod key;
mod waits;
mod wire;

#[cfg(test)]
mod server;

pub use cassette::{Cassette, CassetteError};
pub use chat::{ChatAnswer, ChatRequest, Finish, Speaker, Turn};
pub use client::{ChatClient, ClientConfig, Structured};
pub use error::ChatError;
pub use key::ApiKey;
