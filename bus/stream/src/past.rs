//! Ticks of a run that is still on the bus, asked for.

use std::sync::Arc;
use std::time::Duration;

use socrates_link::{Bus, LinkError, keys};
use socrates_model::RunId;
use socrates_model::recording::AgentState;

use crate::error::StreamError;
use crate::part::{self, Joiner, Part};
use crate::shelf::Ctl;

/// Limit of one question to the run.
pub(crate) const TIMEOUT: Duration = Duration::from_secs(2);

/// Asks a run for ticks.
#[derive(Clone)]
pub struct Past {
    bus: Arc<dyn Bus>,
    run: RunId,
    agents: usize,
}

impl Past {
    /// For a run of so many agents.
    #[must_use]
    pub fn new(bus: Arc<dyn Bus>, run: &RunId, agents: usize) -> Self {
        Self { bus, run: run.clone(), agents: agents.max(1) }
    }

    /// Agents of a tick.
    #[must_use]
    pub const fn agents(&self) -> usize {
        self.agents
    }

    /// Whole ticks that come with one answer, at least 1.
    #[must_use]
    pub const fn ticks_at_once(&self) -> usize {
        match part::ticks_that_fit(self.agents) {
            0 => 1,
            ticks => ticks,
        }
    }

    /// The states of the ticks from one to another, in order, as many as the run has: fewer end before the first that it lacks.
    ///
    /// # Errors
    /// [`StreamError::Link`] when the run cannot be asked any more.
    pub async fn ticks(&self, from: u64, to: u64) -> Result<Vec<AgentState>, StreamError> {
        let (mut found, mut joiner): (Vec<AgentState>, Joiner) = (Vec::new(), Joiner::default());
        let (mut next, mut asked) = (from, 0);
        while next <= to {
            let reply = self.ask(&Ctl::Frames { from: next, to, part: asked }).await;
            let reply = reply.map_err(|why| StreamError::Link { run: self.run.to_string(), why })?;
            let states = match part::read(&reply, self.agents) {
                Some(Part::Ticks(states)) => states,
                Some(Part::Piece { tick, part, last, states }) if tick == next && part == asked => {
                    let joined = joiner.join((tick, part, last), states, self.agents);
                    if !last {
                        asked += 1;
                        continue;
                    }
                    asked = 0;
                    joined.unwrap_or_default()
                }
                Some(Part::Piece { .. } | Part::Over(_)) | None => break,
            };
            if states.first().is_none_or(|first| first.tick != next) {
                break;
            }
            next += (states.len() / self.agents) as u64;
            found.extend(states);
        }
        Ok(found)
    }

    /// Asks the run on its ctl key.
    pub(crate) async fn ask(&self, what: &Ctl) -> Result<Vec<u8>, LinkError> {
        let body = serde_json::to_vec(what)
            .map_err(|why| LinkError::Encode { kind: self.run.to_string(), why: why.to_string() })?;
        self.bus.query(&keys::live_ctl(&self.run), body, TIMEOUT).await
    }
}
