//! Questions to an author, and how its answers are read.
//!
//! ```text
//! Question ──messages()──► system and user texts, picture of the map ──► author
//!    │                                                                     │
//!    └──answer_schema()──► JSON schema                parse_*() ◄── text ◄─┘
//! ```
//!
//! Each authoring stage has a template in `templates/`, an answer schema made from the model's own
//! types, and a reader that turns text into a typed artifact or into faults that name the position.
//! Tables in the prompts (triggers, actions, gestures, nodes) are made from the types and the node
//! catalogue, so that they cannot drift from what the readers take.
//!
//! *Never here:* a call of a model, a file, a check against map or request, an invented default answer.

pub mod question;

pub mod ask;
pub mod message;

pub mod answer;
pub mod json;
pub mod schema;

mod behaviors;
mod feedback;
mod place_text;
mod validate;
mod vocabulary;

#[cfg(test)]
mod testing;

pub use answer::{parse_paths, parse_proposal};
pub use behaviors::parse_behaviors;
pub use message::{Message, Picture, Role};
pub use question::Question;
pub use schema::answer_schema;
