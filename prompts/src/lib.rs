//! Questions to an author, and how its answers are read.
//!
//! ```text
//! Question ──prompt(Style)──► system and user texts, picture of the map, JSON schema ──► author
//!                                                                                        │
//!                            proposal, paths, behaviors, or faults ◄── parse_*() ◄── text ┘
//! ```
//!
//! A model answers the first question with a scenario, which begins with an account of every sentence of the request. Each authoring stage has a template in `templates/`, worked examples in `examples/`, an answer schema with
//! the names of the question in it, and a reader that turns text into a typed artifact or into faults that name the
//! position. A style chooses how much is explained and in which form is answered; the reader takes every form.
//! Tables in the prompts (triggers, actions, gestures, nodes) are made from the types and the node
//! catalog, so that they cannot drift from what the readers take.
//!
//! *Never here:* a call of a model, a file, a check against map or request, an invented default answer.

pub mod question;

pub mod examples;
pub mod message;
pub mod prompt;
pub mod style;

pub mod account;
pub mod answer;
pub mod building;
pub mod json;
pub mod opinion;
pub mod scenario;
pub mod schema;

mod behaviors;
mod conforms;
mod feedback;
mod order;
mod passing;
mod place_text;
mod sentences;
mod shown;
mod terse;
mod trees;
mod vocabulary;
mod ways;
mod words;

#[cfg(test)]
mod hostile;
#[cfg(test)]
mod testing;

pub use account::{Account, Claim, Share, parse_account};
pub use answer::{parse_paths, parse_proposal};
pub use behaviors::parse_behaviors;
pub use conforms::{Misfit, misfits};
pub use message::{Message, Picture, Role};
pub use passing::Passing;
pub use prompt::{Prompt, Template, too_long};
pub use question::Question;
pub use scenario::parse_scenario;
pub use schema::answer_schema;
pub use sentences::{Sentence, sentences};
pub use style::{BehaviorsForm, Image, MOST_VARIANTS, Mode, PathsForm, Style, Telling};
