//! Writes recordings as they grow.

use std::collections::BTreeMap;
use std::io::Write;

use ::mcap::records::MessageHeader;
use ::mcap::write::NoSeek;
use ::mcap::{Compression, McapError, WriteOptions};
use serde::Serialize;
use socrates_model::recording::{AGENT_STATE_BYTES, AgentState, Event, Recording, RecordingHash, RecordingHeader};
use socrates_model::{Digest, Location, SimTime};

use super::scene::{self, Painter, Picture};
use super::tape::Stretch;
use super::{AGENTS, END, EVENTS, End, HEADER};
use crate::error::StreamError;
use crate::foxglove::{self, Proto};

/// Ticks between two pictures: ten a second.
const PICTURE_EVERY: u64 = 10;
/// Bytes of ticks after which a chunk is closed.
const CHUNK_BYTES: usize = 1024 * 1024;
/// Ticks after which a chunk is closed in any case: what a run that breaks off loses at most.
const CHUNK_TICKS: u64 = 1_000;

/// Field, place in the record, type.
const RECORD: [(&str, usize, &str, &str); 9] = [
    ("tick", 0, "uint64", "number of the tick, from 0"),
    ("agent", 8, "uint32", "0 for the robot, k for human_k"),
    (
        "flags",
        12,
        "uint32",
        "bits 0-7: 0 robot, 1 human; 8-15: gesture; 16-31: leaf, as an index into the header's list",
    ),
    ("x", 16, "float64", "m"),
    ("y", 24, "float64", "m"),
    ("yaw", 32, "float64", "rad"),
    ("vx", 40, "float64", "m/s"),
    ("vy", 48, "float64", "m/s"),
    ("omega", 56, "float64", "rad/s"),
];

/// JSON Schema of the records of a tick, with the place of each field in the record; `order` names the order of the agents.
#[must_use]
pub fn record_schema(order: &str) -> String {
    let fields: Vec<String> = RECORD
        .iter()
        .map(|(name, offset, format, what)| {
            let kind = if format.starts_with("uint") { "integer" } else { "number" };
            format!(r#""{name}":{{"type":"{kind}","format":"{format}","x-offset":{offset},"description":"{what}"}}"#)
        })
        .collect();
    format!(
        r#"{{"title":"socrates.AgentState.v1","description":"every agent of one tick{order}: records of {AGENT_STATE_BYTES} bytes one after the other, little endian","type":"array","x-record-bytes":{AGENT_STATE_BYTES},"x-byte-order":"little","items":{{"type":"object","properties":{{{}}}}}}}"#,
        fields.join(",")
    )
}

/// What was written of a recording that is whole.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Whole {
    /// Ticks.
    pub ticks: u64,
    /// Events.
    pub events: u64,
    /// The recording hash.
    pub hash: Digest,
}

/// A library's writer with the channels it knows.
struct Pen<W: Write> {
    writer: ::mcap::Writer<NoSeek<W>>,
    sequences: BTreeMap<u16, u32>,
}

impl<W: Write> Pen<W> {
    fn channel(&mut self, topic: &str, encoding: &str, schema: (&str, &str, &[u8])) -> Result<u16, McapError> {
        let (name, kind, data) = schema;
        let schema_id = self.writer.add_schema(name, kind, data)?;
        self.writer.add_channel(schema_id, topic, encoding, &BTreeMap::new())
    }

    /// A channel of JSON messages.
    fn json_channel(&mut self, topic: &str, name: &str) -> Result<u16, McapError> {
        self.channel(topic, "json", (name, "jsonschema", br#"{"type":"object"}"#))
    }

    /// A channel of messages of package `foxglove`.
    fn picture_channel(&mut self, topic: &str, name: &str) -> Result<u16, McapError> {
        let (full, description) = (format!("foxglove.{name}"), foxglove::description(name));
        self.channel(topic, "protobuf", (&full, "protobuf", &description))
    }

    fn message(&mut self, channel_id: u16, time: SimTime, data: &[u8]) -> Result<(), McapError> {
        let sequence = self.sequences.entry(channel_id).or_insert(0);
        let header =
            MessageHeader { channel_id, sequence: *sequence, log_time: time.nanos(), publish_time: time.nanos() };
        *sequence = sequence.wrapping_add(1);
        self.writer.write_to_known_channel(&header, data)
    }

    fn json<T: Serialize>(&mut self, channel_id: u16, time: SimTime, value: &T) -> Result<(), McapError> {
        let data = serde_json::to_vec(value).map_err(|why| McapError::Io(std::io::Error::other(why)))?;
        self.message(channel_id, time, &data)
    }

    /// Writes a picture, unless it has nothing new.
    fn picture(&mut self, channel_id: u16, time: SimTime, picture: &Proto) -> Result<(), McapError> {
        if picture.is_empty() { Ok(()) } else { self.message(channel_id, time, picture.bytes()) }
    }
}

/// Numbers of the channels.
struct Channels {
    agents: u16,
    events: u16,
    end: u16,
    scene: u16,
    frames: u16,
    people: u16,
    robot: u16,
}

/// Writes a recording tick by tick; of the run it holds only the chunk that is being filled.
///
/// Order of calls: [`Writer::tick`] for 0, 1, 2 … with the events of each after it, then [`Writer::finish`]. One that is
/// dropped leaves a file that [`super::read_rest`] reads.
pub struct Writer<W: Write> {
    run: String,
    pen: Pen<W>,
    channels: Channels,
    painter: Painter,
    picture: Picture,
    hash: RecordingHash,
    ticks: u64,
    events: u64,
    last: SimTime,
    /// Bytes of the tick that is written.
    bytes: Vec<u8>,
    /// What the open chunk holds.
    open: Stretch,
    filled: usize,
    closed: Box<dyn FnMut(Stretch) + Send>,
}

impl<W: Write> Writer<W> {
    /// Begins a recording; with the location, its walls are in the scene.
    ///
    /// # Errors
    /// [`StreamError::Write`].
    pub fn begin(out: W, header: &RecordingHeader, location: Option<&Location>) -> Result<Self, StreamError> {
        Self::begun(out, header, location).map_err(|why| failed(header.run.as_str(), &why))
    }

    fn begun(out: W, header: &RecordingHeader, location: Option<&Location>) -> Result<Self, McapError> {
        let options = WriteOptions::new()
            .compression(Some(Compression::Zstd))
            .compression_threads(0)
            .profile("")
            .library("socrates")
            .disable_seeking(true)
            .chunk_size(None);
        let mut pen = Pen { writer: options.create(NoSeek::new(out))?, sequences: BTreeMap::new() };
        let first = pen.json_channel(HEADER, "socrates.Header")?;
        let schema = record_schema(", in the order of the header");
        let channels = Channels {
            agents: pen.channel(
                AGENTS,
                "socrates.AgentState.v1",
                ("socrates.AgentState.v1", "jsonschema", schema.as_bytes()),
            )?,
            events: pen.json_channel(EVENTS, "socrates.Event")?,
            end: pen.json_channel(END, "socrates.End")?,
            scene: pen.picture_channel("/scene", "SceneUpdate")?,
            frames: pen.picture_channel("/tf", "FrameTransforms")?,
            people: pen.picture_channel("/crowd", "PosesInFrame")?,
            robot: pen.picture_channel("/robot", "PoseInFrame")?,
        };
        let map = pen.picture_channel("/map", "Grid")?;
        pen.json(first, SimTime::ZERO, header)?;
        if let Some(location) = location {
            let mut floor = Proto::default();
            foxglove::occupancy(&mut floor, &location.grid);
            pen.picture(map, SimTime::ZERO, &floor)?;
            pen.picture(channels.scene, SimTime::ZERO, &scene::walls(location))?;
        }
        Ok(Self {
            run: header.run.to_string(),
            pen,
            channels,
            painter: Painter::new(header),
            picture: Picture::default(),
            hash: RecordingHash::default(),
            ticks: 0,
            events: 0,
            last: SimTime::ZERO,
            bytes: Vec::new(),
            open: Stretch::default(),
            filled: 0,
            closed: Box::new(|_| {}),
        })
    }

    /// Calls `closed` with the ticks of each chunk once all of it is written.
    pub(super) fn telling(mut self, closed: impl FnMut(Stretch) + Send + 'static) -> Self {
        self.closed = Box::new(closed);
        self
    }

    /// Number of the channel of states.
    pub(super) const fn agents_channel(&self) -> u16 {
        self.channels.agents
    }

    /// Every agent of the next tick, in the header's order.
    ///
    /// # Errors
    /// [`StreamError::Write`].
    pub fn tick(&mut self, states: &[AgentState]) -> Result<(), StreamError> {
        self.ticked(states).map_err(|why| failed(&self.run, &why))
    }

    fn ticked(&mut self, states: &[AgentState]) -> Result<(), McapError> {
        if self.filled >= CHUNK_BYTES || self.open.ticks >= CHUNK_TICKS {
            self.close()?;
        }
        let (tick, time) = (self.ticks, SimTime::at_tick(self.ticks));
        self.bytes.clear();
        states.iter().for_each(|state| self.bytes.extend_from_slice(&state.to_bytes()));
        self.hash.state_bytes(&self.bytes);
        self.pen.message(self.channels.agents, time, &self.bytes)?;
        self.painter.follow(tick, states);
        if tick.is_multiple_of(PICTURE_EVERY) {
            self.painter.paint(&mut self.picture, states, time);
            let Channels { scene, frames, people, robot, .. } = self.channels;
            self.pen.picture(scene, time, &self.picture.scene)?;
            self.pen.picture(frames, time, &self.picture.frames)?;
            self.pen.picture(people, time, &self.picture.people)?;
            self.pen.picture(robot, time, &self.picture.robot)?;
        }
        self.filled += self.bytes.len();
        self.open.ticks += 1;
        self.ticks += 1;
        self.last = time;
        Ok(())
    }

    /// The next event.
    ///
    /// # Errors
    /// [`StreamError::Write`].
    pub fn event(&mut self, event: &Event) -> Result<(), StreamError> {
        self.hash.event(event);
        self.events += 1;
        self.last = self.last.max(event.time);
        self.pen.json(self.channels.events, event.time, event).map_err(|why| failed(&self.run, &why))
    }

    /// Closes the chunk that is open: what was written so far is in the file.
    fn close(&mut self) -> Result<(), McapError> {
        self.pen.writer.flush()?;
        (self.closed)(self.open);
        self.open = Stretch { from: self.ticks, ticks: 0 };
        self.filled = 0;
        Ok(())
    }

    /// Ends the recording and hands back where it was written to.
    ///
    /// # Errors
    /// [`StreamError::Write`].
    pub fn finish(mut self) -> Result<(W, Whole), StreamError> {
        let whole = self.finished().map_err(|why| failed(&self.run, &why))?;
        Ok((self.pen.writer.into_inner().into_inner(), whole))
    }

    fn finished(&mut self) -> Result<Whole, McapError> {
        let hash = std::mem::take(&mut self.hash).finish();
        let whole = Whole { ticks: self.ticks, events: self.events, hash };
        let end = End { ticks: whole.ticks, events: whole.events, hash };
        self.close()?;
        // The ways are those of the whole run and show from its begin: a chunk of their own, so that chunks do not overlap.
        let ways = self.painter.ways();
        if !ways.is_empty() {
            self.pen.picture(self.channels.scene, SimTime::ZERO, &ways)?;
            self.pen.writer.flush()?;
        }
        self.pen.json(self.channels.end, self.last, &end)?;
        self.pen.writer.finish()?;
        Ok(whole)
    }
}

fn failed(run: &str, why: &McapError) -> StreamError {
    StreamError::Write { run: run.to_owned(), why: why.to_string() }
}

/// Writes a recording that is there already; with the location, its walls are in the scene.
///
/// # Errors
/// [`StreamError::Write`].
pub fn write(recording: &Recording, location: Option<&Location>) -> Result<Vec<u8>, StreamError> {
    let mut writer = Writer::begin(Vec::new(), &recording.header, location)?;
    let mut events = recording.events.iter().peekable();
    for tick in 0..recording.ticks() {
        let time = SimTime::at_tick(tick as u64);
        while let Some(event) = events.next_if(|event| event.time < time) {
            writer.event(event)?;
        }
        writer.tick(recording.tick(tick))?;
    }
    events.try_for_each(|event| writer.event(event))?;
    Ok(writer.finish()?.0)
}
