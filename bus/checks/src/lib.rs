//! Checks that need several artifacts or the map: is this answer good enough to go on?
//!
//! ```text
//! reading ──► check_proposal ◄── proposal ──► check_paths ◄── paths
//!                                   └───────► check_behaviors ◄── behaviors
//! ```
//!
//! Every check lists **all** faults at once, and each message names the agent, the step, what was
//! found and what is allowed, because the author reads these words on the next attempt.
//! [`model::fault::hard`](socrates_model::fault::hard) tells the faults that refuse an answer from the warnings.
//!
//! *Never here:* a file, a clock, a random number, a call of an author.

mod behaviors;
mod encounters;
mod free;
mod groups;
mod lexicon;
mod limits;
mod nearest;
mod people;
mod places;
mod proposal;
mod relations;
mod repeats;
mod routes;
mod timing;
mod verify;
mod wishes;

#[cfg(test)]
mod testing;

pub use behaviors::check_behaviors;
pub use proposal::check_proposal;
pub use repeats::check_repeats;
pub use routes::check_paths;

use socrates_maps::openings::Enclosures;
use socrates_model::{Behaviors, Fault, Location, NodeId, Paths, Proposal, Reading};

/// Whether a node of a location lies inside of a room or an elevator, as all checks see it.
#[must_use]
pub fn is_inside(location: &Location, node: &NodeId) -> bool {
    Enclosures::of(location).is_inside(node)
}

/// Everything of one scenario against everything else; run before tick 0.
///
/// Without a reading (a pinned proposal) the wishes of a request are not checked.
#[must_use]
pub fn check_all(
    location: &Location,
    reading: Option<&Reading>,
    proposal: &Proposal,
    paths: &Paths,
    behaviors: &Behaviors,
) -> Vec<Fault> {
    let mut faults = match reading {
        Some(reading) => check_proposal(proposal, reading, location),
        None => proposal::check_alone(proposal, location),
    };
    faults.extend(check_paths(paths, proposal, location));
    faults.extend(check_behaviors(behaviors, proposal, location));
    faults
}

/// Words joined by commas; `none` for an empty list.
fn list<T: std::fmt::Display>(items: impl IntoIterator<Item = T>) -> String {
    let words: Vec<String> = items.into_iter().map(|item| format!("`{item}`")).collect();
    if words.is_empty() { "none".to_owned() } else { words.join(", ") }
}
