//! The offline author: same questions as a language model, answers by rules, no network, no weights.
//!
//! ```text
//! text ─► socrates_reader ─► told ──► settle, chance ─► understand ──► proposal ──► paths, rules
//! form ──────────────────► form ──┘   defaults           reading       catalog/*.toml   scene graph
//!                           story                        + problems
//! ```
//!
//! What stands can be edited in words ([`edit`]): the same reader, with the people of the proposal as those of whom was spoken.
//!
//! Everything is deterministic in the question's seed, and feedback is acted upon: a fault code leads to
//! a longer path, another place, another draw. The limits are those of a small reader: English only,
//! clause by clause, prose from templates; words that nothing was read from are reported, never dropped.
//!
//! Never: a network or a file; a random number that is not the seed's; a check of its own answers
//! (the same checks judge every author); a wish that vanishes without a trace in the reading.

pub mod building;
pub mod card;

mod aside;
mod expect;
mod form;
mod manner;
mod rules;
mod settle;
mod story;
mod told;

mod default_cast;
mod lines;
mod pattern;
mod summary;
mod understand;
mod written;

mod again;
mod facing;
mod named;
mod named_way;
mod place;
mod sides;
mod spot;
mod task;

mod events;
mod proposal;
mod prose;

mod desk;
mod edit;
mod edit_paths;
mod edit_people;
mod edit_settle;
mod edit_together;
mod edit_whom;
mod edit_wish;

mod accounted;
mod answer;
mod chance;
mod draw;
mod mended;
mod name;
mod noticing;
mod solve;
mod spans;
mod stated;
mod statements;
mod unfit;

#[cfg(test)]
mod aside_tests;
#[cfg(test)]
mod openings_tests;
#[cfg(test)]
mod order_tests;
#[cfg(test)]
mod said_tests;
#[cfg(test)]
mod spot_tests;
#[cfg(test)]
mod stranger_tests;
#[cfg(test)]
mod tests;

use socrates_model::{Location, Reading, Request};

pub use answer::{Offline, impossible};
pub use card::{Card, catalog};
pub use desk::Draft;
pub use edit::{Edited, edit, settled};
pub use name::NAME;
pub use proposal::propose;
pub use solve::{layout, solve};
pub use stated::{dispute, stated};
pub use summary::summary;
pub use understand::CONTEXT_NOTE;
pub use unfit::Unfit;

/// Reads a request: who, where, what, and every word that was not understood.
///
/// Deterministic in the request and the location; never fails. Wishes that cannot be read (P-READ), placed
/// (P-PLACE), reconciled (P-CONTRA) or simulated (P-LIMIT), and texts that are not English (P-LANG), stand in
/// [`Reading::problems`]; what became of every clause in [`Reading::statements`]; assumptions in [`Reading::notes`].
#[must_use]
pub fn read(request: &Request, location: &Location) -> Reading {
    let read = understand::understand(request, location);
    let statements = statements::statements(request, location, &read);
    Reading { statements, ..read.reading }
}

/// The same without [`Reading::statements`], at a fiftieth of the time: for those who only need what was understood.
#[must_use]
pub fn understood(request: &Request, location: &Location) -> Reading {
    understand::understand(request, location).reading
}

/// What each pass of the small reader makes of a rough scenario, a line for each thing: tokens, background, chunks, clauses, statements, the
/// story, and the pieces that are not in it.
#[must_use]
pub fn passes(rough: &str) -> String {
    socrates_reader::Reader::shipped().passes(rough).to_string()
}

/// What a text was read as ([`read`]), as the tables of a form: it can stand under the text in the request, be corrected there, and then wins
/// over it. How somebody stands to the robot's way, where the text leaves it open, is chosen as the author would.
#[must_use]
pub fn form_of(request: &Request, reading: &Reading, location: &Location) -> String {
    written::form(request, reading, location)
}

/// The keys of `[expect]` that would settle a problem of the reading for which nothing is made: found by setting them.
#[must_use]
pub fn settled_by(request: &Request, location: &Location) -> Vec<&'static str> {
    let stops =
        |request: &Request| socrates_model::fault::hard(&understand::understand(request, location).reading.problems);
    let before = stops(request);
    let settles = |expect: socrates_model::request::Expect| {
        let after = stops(&Request { expect, ..request.clone() });
        after.len() < before.len()
    };
    let class = socrates_model::PlaceClass::ALL.into_iter().find(|class| place::has(location, *class));
    let mut keys = Vec::new();
    if request.expect.humans.is_none()
        && settles(socrates_model::request::Expect { humans: Some(2), ..request.expect.clone() })
    {
        keys.push("humans");
    }
    if request.expect.place.is_none()
        && let Some(class) = class
        && settles(socrates_model::request::Expect { place: Some(class), ..request.expect.clone() })
    {
        keys.push("place");
    }
    keys
}
