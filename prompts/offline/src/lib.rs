//! The offline author: same questions as a language model, answers by rules, no network, no weights.
//!
//! ```text
//! request text ─► words ─► notes, names, preamble ─► cut ─► clause ─► story ─► reading ──► proposal ──► paths, rules
//!                 lexicon.toml                               mention    cast     + problems   catalog/*.toml   scene graph
//! ```
//!
//! What stands can be edited in words ([`edit`]): the same grammar, with the people of the proposal as those of whom was spoken.
//!
//! Everything is deterministic in the question's seed, and feedback is acted upon: a fault code leads to
//! a longer path, another place, another draw. The limits are those of a small grammar: English only,
//! clause by clause, prose from templates; words that nothing was read from are reported, never dropped.
//!
//! Never: a network or a file; a random number that is not the seed's; a check of its own answers
//! (the same checks judge every author); a wish that vanishes without a trace in the reading.

#![expect(clippy::too_many_lines, reason = "the present reader of requests, as a whole, until it is replaced")]

pub mod building;
pub mod card;

mod aside;
mod begins;
mod expect;
mod form;
mod hands;
mod lexicon;
mod slips;
mod wording;
mod words;

mod named;
mod named_way;
mod noun;
mod numbered;

mod meant;
mod mention;
mod negation;
mod refer;
mod topic;

mod actors;
mod addressee;
mod arrows;
mod labels;
mod notes;
mod terse;

mod apposed;
mod around;
mod arrange;
mod asker;
mod called;
mod clock;
mod cut;
mod interject;
mod preamble;
mod retract;

mod again;
mod clause;
mod contra;
mod deeds;
mod measure;
mod message;

mod bind;
mod cast;
mod deed;
mod ellipsis;
mod facing;
mod finish;
mod inside;
mod lasting;
mod pick;
mod relation;
mod robot_deed;
mod short;
mod sides;
mod small;
mod story;
mod task;
mod thread;
mod timing;
mod whereabouts;
mod who;
mod whom;

mod default_cast;
mod order;
mod pattern;
mod summary;
mod understand;

mod events;
mod place;
mod proposal;
mod prose;

mod edit;
mod edit_paths;
mod edit_people;
mod edit_settle;
mod edit_together;
mod edit_whom;
mod edit_wish;

mod accounted;
mod answer;
mod boards;
mod chance;
mod draw;
mod headings;
mod mended;
mod noticing;
mod rules;
mod solve;
mod spans;
mod spot;
mod stated;
mod statements;
mod unfit;

#[cfg(test)]
mod again_tests;
#[cfg(test)]
mod aside_tests;
#[cfg(test)]
mod cut_tests;
#[cfg(test)]
mod mention_tests;
#[cfg(test)]
mod notes_tests;
#[cfg(test)]
mod openings_tests;
#[cfg(test)]
mod order_tests;
#[cfg(test)]
mod preface_tests;
#[cfg(test)]
mod said_tests;
#[cfg(test)]
mod short_tests;
#[cfg(test)]
mod spot_tests;
#[cfg(test)]
mod stranger_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod wording_tests;

use socrates_model::{Location, ReadBy, Reading, Request};

pub use answer::Offline;
pub use card::{Card, catalog};
pub use edit::{Draft, Edited, edit, settled};
pub use solve::{impossible, layout};
pub use stated::{dispute, stated};
pub use summary::summary;
pub use understand::CONTEXT_NOTE;
pub use unfit::Unfit;

/// Name of this author, as artifacts spell it.
pub const NAME: &str = "offline/1";

/// Reads a request: who, where, what, and every word that was not understood.
///
/// Deterministic in the request and the location; never fails. Wishes that cannot be read (P-READ), placed
/// (P-PLACE), reconciled (P-CONTRA) or simulated (P-LIMIT), and texts that are not English (P-LANG), stand in
/// [`Reading::problems`]; what became of every clause in [`Reading::statements`]; assumptions in [`Reading::notes`].
#[must_use]
pub fn read(request: &Request, location: &Location) -> Reading {
    read_by(request, location, ReadBy::Grammar)
}

/// The same, with the rough scenario read by the grammar or by the small reader ([`ReadBy::Small`]); an author that reads it itself is
/// taken for the grammar.
#[must_use]
pub fn read_by(request: &Request, location: &Location, by: ReadBy) -> Reading {
    let read = understand::understand(request, location, by);
    let statements = statements::statements(request, location, &read);
    Reading { statements, ..read.reading }
}

/// The same without [`Reading::statements`], at a fiftieth of the time: for those who only need what was understood.
#[must_use]
pub fn understood(request: &Request, location: &Location, by: ReadBy) -> Reading {
    understand::understand(request, location, by).reading
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
    statements::form(request, reading, location)
}

/// The keys of `[expect]` that would settle a problem of the reading for which nothing is made: found by setting them.
#[must_use]
pub fn settled_by(request: &Request, location: &Location, by: ReadBy) -> Vec<&'static str> {
    let stops = |request: &Request| {
        socrates_model::fault::hard(&understand::understand(request, location, by).reading.problems)
    };
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
