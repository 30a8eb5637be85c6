//! The state machine that decides what happens to every job: pure, so that it can be driven through
//! millions of odd histories in a test.
//!
//! ```text
//! event, now ─► step(state) ─► rows to save, then replies, then hints
//! ```
//!
//! A shell around it owns the bus, the clock and the store: it commits the rows of a step in one
//! transaction *before* it sends the replies of that step. Modules in reading order: what there is
//! ([`state`]), how stages hang together ([`pipeline`]), what goes in and out ([`event`]), how a
//! step keeps its books (`turn`), then one file per kind of event, and the checker ([`fsck`]).
//!
//! *Never here:* a runtime, the bus, a file, a clock, a random number, what an artifact contains.

pub mod batches;
pub mod bucket;
pub mod circuit;
pub mod event;
pub mod pace;
pub mod pipeline;
pub mod policy;
pub mod state;
pub mod tally;
mod trace;

mod turn;

mod acquire;
mod beat;
mod budget;
mod control;
mod failure;
mod limits;
mod recover;
mod report;
mod revision;
mod series;
mod share;
mod submit;
mod timer;

mod fsck;
pub mod overview;
mod status;
mod why;

#[cfg(test)]
mod batch_rules;
#[cfg(test)]
mod best_rules;
#[cfg(test)]
mod broken;
#[cfg(test)]
mod histories;
#[cfg(test)]
mod lease_rules;
#[cfg(test)]
mod look_rules;
#[cfg(test)]
mod rates;
#[cfg(test)]
mod rules;
#[cfg(test)]
mod steer_rules;
#[cfg(test)]
mod world;

pub use batches::{Batch, Queue};
pub use budget::{cost_of, price_of};
pub use event::{Answer, Effect, Event, Row, Token};
pub use fsck::fsck;
pub use policy::Policy;
pub use recover::Snapshot;
pub use state::{Attempt, AttemptEnd, Job, JobResult, JobState, Millis, Scenario, ScenarioEnd, State, Worker};
pub use status::{standing, status};
pub use tally::Tally;
pub use trace::trace_of;
pub use why::whys_of_rows;

/// One step: takes an event at time `now` and says what is to be saved and sent.
///
/// `now` is the shell's monotonic clock in ms and must never run backwards. The rows among the
/// effects belong into one transaction; nothing else of the step may be seen before it is durable.
pub fn step(state: &mut State, event: Event, now: Millis) -> Vec<Effect> {
    let mut turn = turn::Turn::new(state, now);
    match event {
        Event::Hello { hello, to } => turn.hello(hello, to),
        Event::Submit { submit, to } => turn.submit(submit, to),
        Event::Acquire { ask, to } => turn.acquire(&ask, to),
        Event::Beat { beat, to } => turn.beat(&beat, to),
        Event::Report { report, to } => turn.report(*report, to),
        Event::Release { release, to } => turn.release(&release, to),
        Event::Control { control, to } => turn.control(&control, to),
        Event::Gone { instance } => turn.gone(&instance),
        Event::Tick => turn.tick(),
        Event::Recover { alone } => turn.recover(alone),
    }
    turn.finish()
}
