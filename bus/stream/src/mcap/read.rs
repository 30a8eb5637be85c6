//! Reads recordings: whole ones, and what is left of those that were cut.

use std::collections::BTreeMap;

use ::mcap::McapError;
use ::mcap::sans_io::{LinearReaderOptions, MessageReadEvent, MessageReader};
use socrates_model::FORMAT;
use socrates_model::recording::{AgentState, Event, Recording, RecordingHeader};

use super::{AGENTS, END, EVENTS, End, HEADER};
use crate::bounds;
use crate::error::StreamError;
use crate::part::records_of;

/// Largest record that is read, bytes.
const MAX_RECORD: usize = 256 * 1024 * 1024;
/// Most topics of others that are named.
const MAX_TOPICS: usize = 12;
/// Most states that are read: an hour with forty agents is 14.4 million.
const MAX_STATES: usize = 32 * 1024 * 1024;
/// Most events that are read: a run of an hour has some thousands.
const MAX_EVENTS: usize = 4 * 1024 * 1024;
/// Most bytes of messages that are unpacked: 32 million states and ten pictures of them a second.
const MAX_UNPACKED: usize = 8 * 1024 * 1024 * 1024;

/// A recording that may have been cut.
#[derive(Debug, Clone, PartialEq)]
pub struct Rest {
    /// What is there.
    pub recording: Recording,
    /// Why it ends where it does; `None` for one that is whole.
    pub cut: Option<String>,
}

/// Reads as much of a recording as there is: all of it, or all up to where the file is cut or damaged.
///
/// # Errors
/// As [`read`], where not even two ticks are there or what is there contradicts itself.
pub fn read_rest(bytes: &[u8]) -> Result<Rest, StreamError> {
    // A chunk that was damaged is dropped whole. One that was cut is good up to the cut, but its checksum is not.
    let (mut parts, mut filled) = Parts::read(bytes, Chunks::Whole);
    if let Err(StreamError::Read { cut: true, .. }) = filled {
        (parts, filled) = Parts::read(bytes, Chunks::UpToTheCut);
    }
    let why = match filled {
        Ok(()) if parts.end.is_some() || parts.header.is_none() => {
            return Ok(Rest { recording: parts.whole()?, cut: None });
        }
        Ok(()) => "the file was cut off".to_owned(),
        Err(StreamError::Read { len, cut, why }) => {
            let agents = parts.header.as_ref().map_or(usize::MAX, |header| header.agents.len());
            if parts.frames.len() / 2 < agents {
                return Err(StreamError::Read { len, cut, why });
            }
            format!("the file is cut off or damaged: {why}")
        }
        Err(other) => return Err(other),
    };
    match parts.header {
        Some(header) if parts.frames.len() / 2 >= header.agents.len() => {
            Ok(Rest { recording: Recording { header, frames: parts.frames, events: parts.events }, cut: Some(why) })
        }
        Some(_) | None => Err(StreamError::Read { len: bytes.len(), cut: true, why }),
    }
}

/// Whether bytes begin as an MCAP file does, as far as there are any.
#[must_use]
pub fn begins(bytes: &[u8]) -> bool {
    const MAGIC: &[u8] = b"\x89MCAP0\r\n";
    let shared = bytes.len().min(MAGIC.len());
    shared > 0 && bytes.get(..shared) == MAGIC.get(..shared)
}

/// Reads a recording and checks that it is whole.
///
/// # Errors
/// [`StreamError::Read`] for bytes that are no MCAP file or are cut, [`StreamError::NotWhole`] for a file that lacks
/// something, has states in a wrong order or another hash than it was written with.
pub fn read(bytes: &[u8]) -> Result<Recording, StreamError> {
    let (parts, filled) = Parts::read(bytes, Chunks::Whole);
    filled?;
    parts.whole()
}

/// What must be there of a chunk before its messages count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Chunks {
    /// All of it, with the right checksum.
    Whole,
    /// What comes before the end of the file.
    UpToTheCut,
}

#[derive(Default)]
struct Parts {
    header: Option<RecordingHeader>,
    frames: Vec<AgentState>,
    events: Vec<Event>,
    end: Option<End>,
    /// Topics of others, with their schemas.
    others: BTreeMap<String, String>,
    /// Bytes of all messages so far.
    unpacked: usize,
}

fn not_whole(why: impl Into<String>) -> StreamError {
    StreamError::NotWhole { why: why.into() }
}

impl Parts {
    /// What a file holds, and why no more of it.
    fn read(bytes: &[u8], chunks: Chunks) -> (Self, Result<(), StreamError>) {
        let mut parts = Self::default();
        let filled = parts.fill(bytes, chunks);
        (parts, filled)
    }

    /// Takes every message of a file; what came before an error is kept.
    fn fill(&mut self, bytes: &[u8], chunks: Chunks) -> Result<(), StreamError> {
        let failed = |why: &McapError| StreamError::Read {
            len: bytes.len(),
            cut: matches!(why, McapError::UnexpectedEof),
            why: why.to_string(),
        };
        let mut options = LinearReaderOptions::default()
            .with_record_length_limit(MAX_RECORD)
            .with_validate_chunk_crcs(true)
            .with_prevalidate_chunk_crcs(chunks == Chunks::Whole);
        options.validate_data_section_crc = true;
        let mut reader = MessageReader::new_with_options(options);
        let mut rest = bytes;
        while let Some(event) = reader.next_event() {
            match event.map_err(|why| failed(&why))? {
                MessageReadEvent::ReadRequest(wanted) => {
                    // Never more memory than the file has bytes, whatever its lengths claim.
                    let (given, left) = rest.split_at(wanted.min(rest.len()));
                    if let Some(room) = reader.insert(given.len()).get_mut(..given.len()) {
                        room.copy_from_slice(given);
                    }
                    reader.notify_read(given.len());
                    rest = left;
                }
                MessageReadEvent::Message(message) => {
                    self.unpacked = self.unpacked.saturating_add(message.data.len());
                    if self.unpacked > MAX_UNPACKED {
                        return Err(not_whole(format!("its messages have more than {MAX_UNPACKED} bytes")));
                    }
                    if !self.take(&message.channel.topic, &message.data)? && self.others.len() < MAX_TOPICS {
                        let schema = message.channel.schema.as_ref().map_or("no schema", |schema| schema.name.as_str());
                        self.others.entry(message.channel.topic.clone()).or_insert_with(|| schema.to_owned());
                    }
                }
            }
        }
        Ok(())
    }

    /// Takes a message; `false` for one of a topic of others.
    fn take(&mut self, topic: &str, data: &[u8]) -> Result<bool, StreamError> {
        let unread = |why: serde_json::Error| not_whole(format!("a message of `{topic}` cannot be read: {why}"));
        match topic {
            HEADER => {
                let header: RecordingHeader = serde_json::from_slice(data).map_err(unread)?;
                if header.format > FORMAT {
                    return Err(not_whole(format!(
                        "it has format {}, this version reads up to {FORMAT}",
                        header.format
                    )));
                }
                if self.header.is_some() {
                    return Err(not_whole("it has two headers"));
                }
                if let Some(why) = bounds::header(&header) {
                    return Err(not_whole(why));
                }
                self.header = Some(header);
            }
            AGENTS => self.tick(data)?,
            EVENTS => {
                let event: Event = serde_json::from_slice(data).map_err(unread)?;
                if let Some(why) = bounds::event(&event) {
                    return Err(not_whole(why));
                }
                if self.events.len() >= MAX_EVENTS {
                    return Err(not_whole(format!("it has more than {MAX_EVENTS} events")));
                }
                self.events.push(event);
            }
            END => self.end = Some(serde_json::from_slice(data).map_err(unread)?),
            _other => return Ok(false),
        }
        Ok(true)
    }

    fn tick(&mut self, data: &[u8]) -> Result<(), StreamError> {
        let Some(header) = &self.header else { return Err(not_whole("states come before the header")) };
        let states =
            records_of(data).ok_or_else(|| not_whole(format!("{} bytes are not whole 64-byte states", data.len())))?;
        let agents = header.agents.len();
        let tick = self.frames.len() / agents.max(1);
        let expected = header.agents.iter().map(|info| info.agent.number());
        if states.len() != agents || !states.iter().map(|state| state.agent).eq(expected) {
            return Err(not_whole(format!(
                "tick {tick} does not have the {agents} agents of the header in their order"
            )));
        }
        if let Some(state) = states.iter().find(|state| state.tick != tick as u64) {
            return Err(not_whole(format!("tick {} stands where tick {tick} is due", state.tick)));
        }
        if let Some(why) = states.iter().find_map(bounds::state) {
            return Err(not_whole(why));
        }
        if self.frames.len() >= MAX_STATES {
            return Err(not_whole(format!("it has more than {MAX_STATES} states")));
        }
        self.frames.extend(states);
        Ok(())
    }

    fn whole(self) -> Result<Recording, StreamError> {
        let Some(header) = self.header else {
            let topics: Vec<String> =
                self.others.iter().map(|(topic, schema)| format!("`{topic}` ({schema})")).collect();
            let topics = if topics.is_empty() { "no message".to_owned() } else { topics.join(", ") };
            return Err(StreamError::Foreign { topics });
        };
        let end = self.end.ok_or_else(|| not_whole(format!("there is no `{END}`: it was cut off")))?;
        let recording = Recording { header, frames: self.frames, events: self.events };
        let (ticks, events) = (recording.ticks() as u64, recording.events.len() as u64);
        if (ticks, events) != (end.ticks, end.events) {
            return Err(not_whole(format!(
                "{ticks} of {} ticks and {events} of {} events are there",
                end.ticks, end.events
            )));
        }
        let hash = recording.hash();
        if hash != end.hash {
            return Err(not_whole(format!("its hash is `{hash}` but it was written with `{}`", end.hash)));
        }
        Ok(recording)
    }
}
