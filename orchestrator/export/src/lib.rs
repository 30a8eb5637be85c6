//! Scenario bundles in other tools' formats, one file per format.
//!
//! ```text
//! Proposal + Paths + Behaviors ─► scenario.json trajectory.json bt.json, or one combined file ─► back again
//! questions and answers of authors ─► chat.jsonl preferences.jsonl index.jsonl
//! ```
//!
//! *Never here:* a file, a socket, a rule of simulation. Text in, text out.

pub mod chat_jsonl;
pub mod socrates_json;

pub use socrates_json::{Imported, SocratesJsonError};
