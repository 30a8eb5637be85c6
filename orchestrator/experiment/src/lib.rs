//! Experiments on reliability in virtual time: the orchestrator's own state machine, simulated workers and authors, and faults that
//! strike every policy alike.
//!
//! ```text
//! spec ─► cells ─► units ─┬─► batch: heap ─► step(state, event, now) ─► rows ─► ledger ─┐
//!                         ├─► batch …                                                    ┴─► results ─► tables, plots
//!                         └─► …
//! ```
//!
//! Modules in reading order: how chance is drawn ([`draws`]), what can strike ([`Kind`]), which policies there are
//! ([`policies`]), what is asked ([`spec`]), what becomes of an attempt (`fate`, the model of authors), the orchestrator and its
//! rows (`head`, `rows`), its workers (`worker`), a batch of them over time (`batch`, `heap`), what was seen of it (`ledger`), and
//! what it amounts to ([`results`], [`tables`], [`plots`]).
//!
//! A unit is a function of specification and number, on whichever thread and in whichever order it is played.
//!
//! *Never here:* a file, a clock, a thread, a generator with a state of its own, a rule of the orchestrator, a pixel.

pub mod draws;
mod kind;
pub mod policies;
pub mod spec;

mod problems;

mod asked;
mod fate;

mod heap;
mod rows;
mod worker;

mod head;
mod ledger;

mod batch;
mod observed;

pub mod beside;
pub mod heat;
pub mod plots;
pub mod results;
pub mod tables;

#[cfg(test)]
mod laws;
#[cfg(test)]
mod safety;

pub use asked::{BATCH, asked, number, texts};
pub use fate::{Crash, Fate, Fates, Outcome, all_wrong};
pub use head::Step;
pub use kind::Kind;
pub use ledger::{AttemptRow, Safety, ScenarioRow, Tally};
pub use observed::{Observed, Told};
pub use problems::checked;
pub use results::{CellResult, Figures, Limited, Pairing, Played, Unit, limited, play, units};
pub use spec::{Cell, Spec};
