//! The frames of a run in memory: written by the simulation, read by whoever missed some.

use std::sync::{Mutex, MutexGuard, PoisonError};

use serde::{Deserialize, Serialize};
use socrates_model::recording::{AGENT_STATE_BYTES, AgentState, Event, RecordingHeader};

/// Largest reply with frames or events, bytes.
pub(crate) const PART_BYTES: usize = 48 * 1024;
/// Agent number of the record that ends a run on the frame key; its tick is the number of ticks.
pub(crate) const END_AGENT: u32 = u32::MAX;
/// Kind of a message on the meta key and of its queries.
pub(crate) const KIND_META: &str = "live_meta";
/// Kind of a query on the ctl key.
pub(crate) const KIND_CTL: &str = "live_ctl";

/// What the meta key says: header and how far the run is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Meta {
    /// Header.
    pub(crate) header: RecordingHeader,
    /// Ticks so far.
    pub(crate) ticks: u64,
    /// Events so far.
    pub(crate) events: u64,
    /// Whether the run is over.
    pub(crate) ended: bool,
}

/// What the ctl key is asked. Frames come back as plain records, events as a message.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Ctl {
    /// Whole ticks from this one to that one, as many as fit.
    Frames {
        /// First tick.
        from: u64,
        /// Last tick.
        to: u64,
    },
    /// Events from this number on, as many as fit.
    Events {
        /// First event, from 0.
        from: u64,
    },
}

/// The frames.
#[derive(Default)]
pub(crate) struct Shelf(Mutex<Rows>);

#[derive(Default)]
struct Rows {
    header: Option<RecordingHeader>,
    frames: Vec<AgentState>,
    events: Vec<Event>,
    ticks: u64,
    ended: bool,
}

impl Shelf {
    fn rows(&self) -> MutexGuard<'_, Rows> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(crate) fn announce(&self, header: &RecordingHeader) {
        *self.rows() = Rows { header: Some(header.clone()), ..Rows::default() };
    }

    pub(crate) fn tick(&self, states: &[AgentState]) {
        let mut rows = self.rows();
        rows.frames.extend_from_slice(states);
        rows.ticks += 1;
    }

    pub(crate) fn event(&self, event: &Event) {
        self.rows().events.push(event.clone());
    }

    pub(crate) fn end(&self) {
        self.rows().ended = true;
    }

    /// What the meta key says now; `None` before the announcement.
    pub(crate) fn meta(&self) -> Option<Meta> {
        let rows = self.rows();
        let header = rows.header.clone()?;
        Some(Meta { header, ticks: rows.ticks, events: rows.events.len() as u64, ended: rows.ended })
    }

    /// Ticks so far, events so far, whether the run is over.
    pub(crate) fn standing(&self) -> (u64, u64, bool) {
        let rows = self.rows();
        (rows.ticks, rows.events.len() as u64, rows.ended)
    }

    /// The records of one tick; empty where there is none.
    pub(crate) fn frame(&self, tick: u64) -> Vec<u8> {
        self.frames(tick, tick, usize::MAX)
    }

    /// Whole ticks from one to another, as many as fit into `cap` bytes.
    pub(crate) fn frames(&self, from: u64, to: u64, cap: usize) -> Vec<u8> {
        let rows = self.rows();
        let agents = rows.header.as_ref().map_or(0, |header| header.agents.len()).max(1);
        let fit = (cap / (agents * AGENT_STATE_BYTES)).max(1);
        let begin = usize::try_from(from).unwrap_or(usize::MAX).saturating_mul(agents);
        let wanted = usize::try_from(to.saturating_add(1).saturating_sub(from)).unwrap_or(usize::MAX);
        let states = rows.frames.iter().skip(begin).take(wanted.min(fit).saturating_mul(agents));
        states.flat_map(AgentState::to_bytes).collect()
    }

    /// Events from a number on, as many as fit a message.
    pub(crate) fn events(&self, from: u64) -> Vec<Event> {
        let mut left = PART_BYTES;
        let rows = self.rows();
        let from = usize::try_from(from).unwrap_or(usize::MAX);
        let fits = |event: &&Event| {
            let len = serde_json::to_vec(event).map_or(PART_BYTES, |bytes| bytes.len());
            left = left.saturating_sub(len);
            left > 0
        };
        rows.events.iter().skip(from).take_while(fits).cloned().collect()
    }
}

/// Reads the records of a message; `None` when they are not whole records.
pub(crate) fn records(bytes: &[u8]) -> Option<Vec<AgentState>> {
    bytes.chunks(AGENT_STATE_BYTES).map(AgentState::from_bytes).collect()
}
