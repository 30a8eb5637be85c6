//! The authors that answer the questions, and one attempt at an answer.
//!
//! ```text
//! Question ─► Author::ask ─► text ─► parse (prompts) ─► check (checks) ─► artifact + exchange
//!              offline │ language model │ cassette         └── any fault: refused, with every reason
//!              FaultyAuthor wraps any of them
//! ```
//!
//! One attempt is one ask. What comes next — asking again, waiting, giving up — is decided elsewhere.
//!
//! *Never here:* a second ask, a sleep, an environment variable, a private door for any author.

pub mod author;
pub mod offline;

pub mod compiled;
mod passing;
pub mod paths_by;

pub mod cassette;
pub mod llm;

pub mod fault_model;
pub mod faulty;
mod mutate;

pub mod confusion;

mod account;
pub mod attempt;
pub mod building;
pub mod here;
pub mod job;
pub mod pictured;
pub mod settings;
mod stated;
pub mod variants;

#[cfg(test)]
mod testing;

pub use attempt::{Exchange, Made, Refused, Written, attempt};
pub use author::{Answer, AskError, Author, How, Says};
pub use fault_model::{FaultKind, FaultRates};
pub use faulty::FaultyAuthor;
pub use job::{Asking, AuthorContext, JobAnswer, JobRefusal};
pub use socrates_llm::{Limits, Rate};
pub use socrates_prompts::Question;

pub use settings::{Keys, Recordings, Server, author_for, check, probe};
