//! The last frames of a run in memory: written by the simulation, read by whoever missed some. Older ones are read from the
//! recording that is being written.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

use serde::{Deserialize, Serialize};
use socrates_model::live::{LiveDoor, LiveDoors, LiveEnd, LiveEvents, LiveMeta, LiveScene, VERSION};
use socrates_model::lockstep::{MAP_PART_CELLS, map_bytes};
use socrates_model::recording::{AGENT_STATE_BYTES, AgentInfo, AgentState, Event, EventKind, RecordingHeader};

use crate::corner::SharedMemory;
use crate::mcap::Tape;
use crate::part;

/// Largest reply with events or agents, bytes.
const PART_BYTES: usize = 48 * 1024;
/// Ticks that are kept: the last 20 s.
const RING_TICKS: u64 = 2_000;
/// Bytes of ticks that are kept: more than a chunk of the recording, so that what is not in it yet is here.
const RING_BYTES: usize = 8 * 1024 * 1024;
/// What the ctl key is asked, in JSON. Frames come back as a message of the frame key, all else as JSON.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Ctl {
    /// Whole ticks from this one to that one, as many as fit; where a tick does not fit, this part of the first.
    Frames {
        /// First tick.
        from: u64,
        /// Last tick.
        to: u64,
        /// Part, from 0.
        #[serde(default)]
        part: u32,
    },
    /// Events from this number on, as many as fit.
    Events {
        /// First event, from 0.
        from: u64,
    },
    /// Agents of the header from this number on, as many as fit.
    Agents {
        /// First agent, from 0.
        from: u64,
    },
}

/// How a run stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Standing {
    /// Whether it was announced.
    pub(crate) announced: bool,
    /// Ticks so far.
    pub(crate) ticks: u64,
    /// Events so far.
    pub(crate) events: u64,
    /// How often a door has opened or shut.
    pub(crate) turns: u64,
    /// Whether it is over.
    pub(crate) ended: bool,
}

/// The frames.
#[derive(Default)]
pub(crate) struct Shelf {
    rows: Mutex<Rows>,
    /// The recording that is being written.
    tape: Tape,
    /// The ticks that were read from it last, for the questions that follow.
    read: Mutex<Vec<Vec<u8>>>,
    heard: AtomicBool,
    /// Cells of the map, as they are told.
    cells: Vec<u8>,
    /// Where it is in shared memory.
    shared: OnceLock<SharedMemory>,
}

#[derive(Default)]
struct Rows {
    scene: LiveScene,
    /// Doors as they stand now.
    doors: Vec<LiveDoor>,
    header: Option<RecordingHeader>,
    /// Bytes of the ticks from `first` on.
    ring: VecDeque<u8>,
    first: u64,
    ticks: u64,
    events: Vec<Event>,
    /// How often a door has opened or shut, and at which tick it did last.
    turns: u64,
    turned: u64,
    ended: Option<LiveEnd>,
}

impl Rows {
    fn tick_bytes(&self) -> usize {
        self.header.as_ref().map_or(0, |header| header.agents.len()).max(1) * AGENT_STATE_BYTES
    }
}

impl Shelf {
    /// A shelf for a run of this scene on a map of these cells, whose older ticks are on this tape.
    pub(crate) fn before(tape: Tape, scene: LiveScene, cells: Vec<u8>) -> Self {
        let rows = Mutex::new(Rows { doors: scene.doors.clone(), scene, ..Rows::default() });
        Self { tape, rows, cells, ..Self::default() }
    }

    fn rows(&self) -> MutexGuard<'_, Rows> {
        self.rows.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Where it is in shared memory, too; said once.
    pub(crate) fn shares(&self, place: SharedMemory) {
        self.shared.get_or_init(|| place);
    }

    /// Whether anybody listens, as far as is known.
    pub(crate) fn is_heard(&self) -> bool {
        self.heard.load(Ordering::Relaxed)
    }

    pub(crate) fn hears(&self, heard: bool) {
        self.heard.store(heard, Ordering::Relaxed);
    }

    pub(crate) fn announce(&self, header: &RecordingHeader) {
        let mut rows = self.rows();
        let scene = std::mem::take(&mut rows.scene);
        *rows = Rows { header: Some(header.clone()), doors: scene.doors.clone(), scene, ..Rows::default() };
    }

    /// Takes the next tick and lets go of what is older than the ring.
    pub(crate) fn tick(&self, states: &[AgentState]) {
        let mut rows = self.rows();
        states.iter().for_each(|state| rows.ring.extend(state.to_bytes()));
        rows.ticks += 1;
        let len = rows.tick_bytes();
        if rows.ticks - rows.first > RING_TICKS || rows.ring.len() > RING_BYTES {
            rows.ring.drain(..len);
            rows.first += 1;
        }
    }

    pub(crate) fn event(&self, event: &Event) {
        let mut rows = self.rows();
        if let EventKind::Door { door, open } = &event.kind
            && let Some(told) = rows.doors.iter_mut().find(|told| told.door.id == *door)
        {
            told.open = *open;
            rows.turns += 1;
            rows.turned = event.time.tick();
        }
        rows.events.push(event.clone());
    }

    /// The run is over; what was said of its end first stands. What is in the recording is not kept here as well.
    pub(crate) fn end(&self, end: &LiveEnd) {
        let recorded = self.tape.ticks();
        let mut rows = self.rows();
        rows.ended.get_or_insert_with(|| end.clone());
        if recorded >= rows.ticks {
            rows.first = rows.ticks;
            rows.ring = VecDeque::new();
        }
    }

    /// What the meta key says now; `None` before the announcement.
    pub(crate) fn meta(&self) -> Option<LiveMeta> {
        let rows = self.rows();
        let header = rows.header.as_ref()?;
        let meta = LiveMeta {
            socrates: "run".to_owned(),
            version: VERSION,
            header: RecordingHeader { agents: fitting(&header.agents, 0), ..header.clone() },
            agents: header.agents.len() as u64,
            scene: rows.scene.clone(),
            ticks: rows.ticks,
            events: rows.events.len() as u64,
            shared_memory: self.shared.get().and_then(SharedMemory::name),
            ended: rows.ended.clone(),
        };
        Some(meta)
    }

    /// How the run stands.
    pub(crate) fn standing(&self) -> Standing {
        let rows = self.rows();
        Standing {
            announced: rows.header.is_some(),
            ticks: rows.ticks,
            events: rows.events.len() as u64,
            turns: rows.turns,
            ended: rows.ended.is_some(),
        }
    }

    /// The doors as they stand now.
    pub(crate) fn doors(&self) -> LiveDoors {
        let rows = self.rows();
        LiveDoors { tick: rows.turned, doors: rows.doors.clone() }
    }

    /// The part of the map that begins with this cell; `None` where it has no such cell.
    pub(crate) fn map(&self, first: u64) -> Option<Vec<u8>> {
        let part = self.cells.get(usize::try_from(first).ok()?..)?;
        let part = part.get(..part.len().min(MAP_PART_CELLS))?;
        (!part.is_empty()).then(|| map_bytes(0, first, self.cells.len() as u64, part))
    }

    /// Agents of the header from a number on, as many as fit a message.
    pub(crate) fn agents(&self, from: u64) -> Vec<AgentInfo> {
        self.rows().header.as_ref().map_or_else(Vec::new, |header| fitting(&header.agents, from))
    }

    /// Events from a number on, as many as fit a message.
    pub(crate) fn events(&self, from: u64) -> LiveEvents {
        LiveEvents { first: from, events: fitting(&self.rows().events, from) }
    }

    /// The newest tick as one message or several; none before the first.
    pub(crate) fn latest(&self) -> Vec<Vec<u8>> {
        let Some(tick) = self.rows().ticks.checked_sub(1) else { return Vec::new() };
        let mut parts = Vec::new();
        while let Some((part, ended)) = self.message(tick, tick, u32::try_from(parts.len()).unwrap_or(u32::MAX)) {
            parts.push(part);
            if ended > 0 {
                break;
            }
        }
        parts
    }

    /// The message with the ticks from one to another, as many as fit, or with one part of the first; and how many whole
    /// ticks it ends. `None` where the first of them is nowhere.
    pub(crate) fn message(&self, from: u64, to: u64, part: u32) -> Option<(Vec<u8>, u64)> {
        let (len, agents) = {
            let rows = self.rows();
            (rows.tick_bytes(), rows.header.as_ref().map_or(0, |header| header.agents.len()))
        };
        let fit = part::ticks_that_fit(agents);
        let wanted = usize::try_from(to.saturating_add(1).saturating_sub(from)).unwrap_or(usize::MAX);
        let records = self.records(from, wanted.min(fit.max(1)), len)?;
        if fit > 0 {
            // It is whole in its first part.
            if part > 0 {
                return None;
            }
            let ticks = (records.len() / len) as u64;
            return Some((part::ticks(from, &records), ticks));
        }
        let last = (u64::from(part) + 1) * (part::RECORDS * AGENT_STATE_BYTES) as u64 >= records.len() as u64;
        part::piece(from, part, &records).map(|message| (message, u64::from(last)))
    }

    /// The records of at most so many ticks from one on, all from the ring or all from the recording.
    fn records(&self, from: u64, ticks: usize, len: usize) -> Option<Vec<u8>> {
        {
            let rows = self.rows();
            if let Some(skipped) = from.checked_sub(rows.first) {
                let begin = usize::try_from(skipped).ok()?.saturating_mul(len);
                let end = begin.saturating_add(ticks.saturating_mul(len)).min(rows.ring.len());
                return (begin < end).then(|| rows.ring.range(begin..end).copied().collect());
            }
        }
        let mut read = self.read.lock().unwrap_or_else(PoisonError::into_inner);
        let place = |read: &[Vec<u8>]| read.iter().position(|records| tick_of(records) == Some(from));
        let at = match place(&read) {
            Some(at) => at,
            None => {
                *read = self.tape.chunk_of(from);
                place(&read)?
            }
        };
        let found: Vec<u8> = read.iter().skip(at).take(ticks).flatten().copied().collect();
        Some(found)
    }
}

/// Number of the tick whose records these are.
fn tick_of(records: &[u8]) -> Option<u64> {
    records.get(..8)?.try_into().ok().map(u64::from_le_bytes)
}

/// Things from a number on, as many as fit a message.
fn fitting<T: Clone + Serialize>(all: &[T], from: u64) -> Vec<T> {
    let mut left = PART_BYTES;
    let from = usize::try_from(from).unwrap_or(usize::MAX);
    let fits = |thing: &&T| {
        let len = serde_json::to_vec(thing).map_or(PART_BYTES, |bytes| bytes.len());
        left = left.saturating_sub(len);
        left > 0
    };
    all.iter().skip(from).take_while(fits).cloned().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::csv;

    /// What is asked for from a shelf whose ring has passed on, tick by tick.
    #[test]
    fn older_ticks_come_from_the_recording_and_the_last_from_the_ring() {
        let mut text = String::from("t,id,x,y\n");
        for n in 0..=45 {
            text.push_str(&format!("{n},robot,{n},0\n{n},human_1,0,{n}\n"));
        }
        let recording = csv::read_tracks(&text).unwrap();
        let tape = Tape::default();
        let shelf = Shelf::before(tape.clone(), LiveScene::default(), Vec::new());
        let mut writer = tape.record(&recording.header, None).unwrap();
        shelf.announce(&recording.header);
        for tick in 0..recording.ticks() {
            writer.tick(recording.tick(tick)).unwrap();
            shelf.tick(recording.tick(tick));
        }
        assert!(shelf.rows().first > 2_000, "the ring holds the last ticks only");
        let ring = shelf.rows().ring.len() as u64;
        assert_eq!(ring, RING_TICKS * 128);
        // Not even the recording is finished, and every tick is there.
        let mut from = 0;
        while from < recording.ticks() as u64 {
            let (message, ticks) = shelf.message(from, u64::MAX, 0).unwrap();
            let begin = usize::try_from(from).unwrap() * 2;
            let Some(part::Part::Ticks(states)) = part::read(&message, 2) else { panic!("tick {from}") };
            assert_eq!(states.len() as u64, ticks * 2);
            assert_eq!(states, recording.frames[begin..begin + states.len()]);
            from += ticks;
        }
        assert_eq!(from, recording.ticks() as u64);
        assert!(shelf.message(from, u64::MAX, 0).is_none());
        assert!(shelf.message(7, 7, 1).is_none(), "a tick of one part has no second");
    }
}
