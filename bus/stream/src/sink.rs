//! Where the simulation puts its frames.

use std::sync::{Arc, OnceLock};

use socrates_model::live::LiveEnd;
use socrates_model::recording::{AgentState, Event, Recording, RecordingHeader};

/// Takes a run tick by tick. Synchronous and quick: nothing here waits for a viewer.
///
/// Order of calls: `announce` once, then `tick` for 0, 1, 2 … with `event`s in between, then `end`.
pub trait FrameSink: Send {
    /// The run begins; before tick 0.
    fn announce(&mut self, header: &RecordingHeader);
    /// Every agent of one tick, in the header's order.
    fn tick(&mut self, tick: u64, states: &[AgentState]);
    /// Something happened.
    fn event(&mut self, event: &Event);
    /// The run is over, and is recorded as told.
    fn end(&mut self, end: &LiveEnd);
}

/// Takes everything and keeps nothing.
#[derive(Debug, Clone, Copy, Default)]
pub struct NoSink;

impl FrameSink for NoSink {
    fn announce(&mut self, _header: &RecordingHeader) {}
    fn tick(&mut self, _tick: u64, _states: &[AgentState]) {}
    fn event(&mut self, _event: &Event) {}
    fn end(&mut self, _end: &LiveEnd) {}
}

/// Hands everything to several sinks in order.
#[derive(Default)]
pub struct Fanout(Vec<Box<dyn FrameSink>>);

impl Fanout {
    /// A fanout to these.
    #[must_use]
    pub fn new(sinks: Vec<Box<dyn FrameSink>>) -> Self {
        Self(sinks)
    }

    /// One more sink.
    pub fn add(&mut self, sink: Box<dyn FrameSink>) {
        self.0.push(sink);
    }
}

impl FrameSink for Fanout {
    fn announce(&mut self, header: &RecordingHeader) {
        self.0.iter_mut().for_each(|sink| sink.announce(header));
    }

    fn tick(&mut self, tick: u64, states: &[AgentState]) {
        self.0.iter_mut().for_each(|sink| sink.tick(tick, states));
    }

    fn event(&mut self, event: &Event) {
        self.0.iter_mut().for_each(|sink| sink.event(event));
    }

    fn end(&mut self, end: &LiveEnd) {
        self.0.iter_mut().for_each(|sink| sink.end(end));
    }
}

/// The service of shared memory that has the ticks of a run, known from its announcement on.
#[derive(Debug, Clone, Default)]
pub struct SharedMemory(Arc<OnceLock<String>>);

impl SharedMemory {
    /// Its name; none where there is none, or not yet.
    #[must_use]
    pub fn name(&self) -> Option<String> {
        self.0.get().cloned()
    }

    /// It is there under this name.
    #[cfg_attr(not(feature = "shm"), expect(dead_code, reason = "without shared memory there is never one"))]
    pub(crate) fn is_at(&self, name: &str) {
        self.0.get_or_init(|| name.to_owned());
    }
}

/// Collects a recording in memory.
#[derive(Debug, Clone, Default)]
pub struct Recorder {
    recording: Option<Recording>,
}

impl Recorder {
    /// A recorder that has seen nothing.
    #[must_use]
    pub const fn new() -> Self {
        Self { recording: None }
    }

    /// What was recorded; `None` before `announce`.
    #[must_use]
    pub fn into_recording(self) -> Option<Recording> {
        self.recording
    }
}

impl FrameSink for Recorder {
    fn announce(&mut self, header: &RecordingHeader) {
        self.recording = Some(Recording { header: header.clone(), frames: Vec::new(), events: Vec::new() });
    }

    fn tick(&mut self, _tick: u64, states: &[AgentState]) {
        if let Some(recording) = &mut self.recording {
            recording.frames.extend_from_slice(states);
        }
    }

    fn event(&mut self, event: &Event) {
        if let Some(recording) = &mut self.recording {
            recording.events.push(event.clone());
        }
    }

    fn end(&mut self, _end: &LiveEnd) {}
}
