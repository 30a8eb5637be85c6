//! Receivers of a run while it goes: writers, viewers, and the collector of whole runs.

use crate::live::LiveEnd;
use crate::recording::{AgentState, Event, Recording, RecordingHeader};

/// Receives a run tick by tick. Synchronous and quick: nothing here waits for a viewer.
///
/// Order of calls: `announce` once, then `tick` for 0, 1, 2 …, then `end`.
pub trait Onlooker {
    /// The run begins; before tick 0.
    fn announce(&mut self, header: &RecordingHeader);
    /// One tick's states, in the header's order, and what happened at it.
    fn tick(&mut self, states: &[AgentState], events: &[Event]);
    /// The run is over, and is recorded as stated. The recorder of a run calls it for live viewers; an engine never does.
    fn end(&mut self, _end: &LiveEnd) {}
}

/// Collects a whole run in memory.
#[derive(Debug, Clone, Default)]
pub struct Keeper(Option<Recording>);

impl Keeper {
    /// The collected run; `None` before it was announced.
    #[must_use]
    pub fn recording(self) -> Option<Recording> {
        self.0
    }
}

impl Onlooker for Keeper {
    fn announce(&mut self, header: &RecordingHeader) {
        self.0 = Some(Recording { header: header.clone(), frames: Vec::new(), events: Vec::new() });
    }

    fn tick(&mut self, states: &[AgentState], events: &[Event]) {
        if let Some(recording) = &mut self.0 {
            recording.frames.extend_from_slice(states);
            recording.events.extend_from_slice(events);
        }
    }
}
