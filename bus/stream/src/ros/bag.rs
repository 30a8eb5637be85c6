//! What the files of a bag hold, gathered in one pass.

use std::collections::BTreeMap;
use std::io::Read;

use ::mcap::sans_io::{LinearReaderOptions, MessageReadEvent, MessageReader};
use ::mcap::{Channel, McapError};

use super::decode::Message;
use super::fault::BagFault;
use super::frames::Tree;
use super::schema::{Layout, plain};
use super::sight::{self, Kind, Seen, Sighting};

/// Largest record that is read, bytes: as for recordings of our own.
const MAX_RECORD: usize = 256 * 1024 * 1024;
/// Most bytes of a bag that are asked for at once.
const MAX_ASKED: usize = 1024 * 1024;
/// Most bytes of messages that are unpacked: an hour of four cameras.
const MAX_UNPACKED: u64 = 64 * 1024 * 1024 * 1024;
/// Most places and transforms: an hour of a robot with forty joints at 50 Hz is 7.2 million.
const MAX_SIGHTINGS: usize = 8 * 1024 * 1024;
/// Most topics.
const MAX_TOPICS: usize = 4096;
/// Most topics that are named in a sentence.
const NAMED: usize = 12;

/// Somebody at a place, with the time at which the recorder got it.
#[derive(Debug, Clone)]
pub(super) struct Logged {
    pub(super) log: i64,
    pub(super) sighting: Sighting,
}

/// A topic of a bag.
#[derive(Debug)]
pub(super) struct Topic {
    pub(super) name: String,
    /// Its type as the bag writes it.
    pub(super) kind_name: String,
    /// What it is read as.
    pub(super) kind: Option<Kind>,
    /// How its messages are read, or why they cannot be.
    layout: Option<Result<Layout, String>>,
    pub(super) messages: u64,
    /// Messages that cannot be read, and why the first cannot.
    pub(super) bad: u64,
    pub(super) why: Option<String>,
    /// Places that are none, and the first of them.
    pub(super) wrong: usize,
    pub(super) first_wrong: Option<String>,
    pub(super) robots: usize,
    pub(super) sightings: Vec<Logged>,
    pub(super) goals: Vec<Logged>,
}

impl Topic {
    /// Its name with its type.
    pub(super) fn shown(&self) -> String {
        format!("`{}` ({})", self.name, self.kind_name)
    }
}

/// All that is taken of a bag. Add its files in order, then ask for [`Bag::tracks`].
#[derive(Debug, Default)]
pub struct Bag {
    pub(super) topics: Vec<Topic>,
    /// Topics by name, type and encoding.
    places: BTreeMap<(String, String, String), usize>,
    pub(super) tree: Tree,
    /// What the recorder's clock and the simulator's were together, ns.
    pub(super) clock: Vec<(i64, i64)>,
    pub(super) told: Vec<String>,
    unpacked: u64,
    taken: usize,
}

impl Bag {
    /// A bag without files.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Whether bytes begin as a file of ROS 2's recorder does: MCAP with the profile `ros2`.
    #[must_use]
    pub fn begins(bytes: &[u8]) -> bool {
        // The magic, a record of kind 1 with its length, and the profile with its own.
        const BEFORE: usize = 8 + 1 + 8;
        crate::mcap::begins(bytes) && bytes.get(BEFORE..).is_some_and(|rest| rest.starts_with(b"\x04\0\0\0ros2"))
    }

    /// Whether there is any message of ROS 2.
    #[must_use]
    pub fn is_ros(&self) -> bool {
        self.topics.iter().any(|topic| topic.layout.is_some() && topic.messages > 0)
    }

    /// Takes a file of a bag. One that is cut or damaged is taken as far as it is whole, which [`Bag::tracks`] reports.
    ///
    /// # Errors
    /// [`BagFault::Read`] where nothing of it can be read, [`BagFault::Large`] beyond the bounds.
    pub fn add(&mut self, file: &str, mut source: impl Read) -> Result<(), BagFault> {
        let before = self.messages();
        let Err(stop) = self.fill(&mut source) else { return Ok(()) };
        let (why, cut) = match stop {
            Stop::Fault(fault) => return Err(fault),
            Stop::Source(why) => return Err(BagFault::Read { why: why.to_string(), cut: false }),
            Stop::Format(why @ McapError::UnexpectedEof) => (why.to_string(), true),
            Stop::Format(McapError::BadMagic) => {
                return Err(BagFault::Read { why: "it is no MCAP file".to_owned(), cut: false });
            }
            Stop::Format(McapError::UnsupportedCompression(name)) => {
                return Err(BagFault::Read { why: format!("its chunks are compressed with `{name}`"), cut: false });
            }
            Stop::Format(why) => (why.to_string(), true),
        };
        let read = self.messages().saturating_sub(before);
        if read == 0 {
            return Err(BagFault::Read { why, cut });
        }
        self.told.push(format!("`{file}` is cut off or damaged ({why}): read up to there, {read} messages"));
        Ok(())
    }

    fn fill(&mut self, source: &mut impl Read) -> Result<(), Stop> {
        let options = LinearReaderOptions::default()
            .with_record_length_limit(MAX_RECORD)
            .with_validate_chunk_crcs(true)
            .with_prevalidate_chunk_crcs(true);
        let mut reader = MessageReader::new_with_options(options);
        while let Some(event) = reader.next_event() {
            match event.map_err(Stop::Format)? {
                MessageReadEvent::ReadRequest(wanted) => {
                    // Piece by piece, so that a length which claims more than there is costs nothing.
                    let read = source.read(reader.insert(wanted.min(MAX_ASKED))).map_err(Stop::Source)?;
                    reader.notify_read(read);
                }
                MessageReadEvent::Message(message) => {
                    let log = i64::try_from(message.log_time).unwrap_or(i64::MAX);
                    self.take(&message.channel, log, &message.data).map_err(Stop::Fault)?;
                }
            }
        }
        Ok(())
    }

    fn take(&mut self, channel: &Channel<'_>, log: i64, data: &[u8]) -> Result<(), BagFault> {
        self.unpacked = self.unpacked.saturating_add(data.len() as u64);
        if self.unpacked > MAX_UNPACKED {
            return Err(BagFault::Large { what: "bytes of messages", most: MAX_UNPACKED });
        }
        let place = self.place(channel)?;
        let Some(topic) = self.topics.get_mut(place) else { return Ok(()) };
        topic.messages += 1;
        let (Some(kind), Some(layout)) = (topic.kind, &topic.layout) else { return Ok(()) };
        let seen = match layout {
            Ok(layout) => Message::read(layout, data).and_then(|message| sight::read(kind, message.view())),
            // The reason is told once.
            Err(_why) => {
                topic.bad += 1;
                return Ok(());
            }
        };
        match seen {
            Ok(seen) => self.keep(place, kind, log, seen),
            Err(why) => {
                topic.bad += 1;
                topic.why.get_or_insert_with(|| why.to_string());
                Ok(())
            }
        }
    }

    fn keep(&mut self, place: usize, kind: Kind, log: i64, seen: Seen) -> Result<(), BagFault> {
        self.taken += seen.sightings.len() + seen.transforms.len();
        if self.taken > MAX_SIGHTINGS {
            return Err(BagFault::Large { what: "places and transforms", most: MAX_SIGHTINGS as u64 });
        }
        let Some(topic) = self.topics.get_mut(place) else { return Ok(()) };
        let fixed = topic.name.ends_with("tf_static");
        let logged = |sighting| Logged { log, sighting };
        topic.sightings.extend(seen.sightings.into_iter().map(logged));
        if kind == Kind::Agent {
            topic.goals = seen.goals.into_iter().map(logged).collect();
        }
        topic.robots += seen.robots;
        topic.wrong += seen.wrong;
        topic.first_wrong = topic.first_wrong.take().or(seen.first_wrong);
        for transform in seen.transforms {
            self.tree.add(&transform.parent, &transform.child, transform.stamp, fixed, transform.place);
        }
        // A simulator sends its time a thousand times a second; ten are enough.
        if let Some(time) = seen.clock
            && self.clock.last().is_none_or(|(_, last)| (time - last).abs() >= 100_000_000)
        {
            self.clock.push((log, time));
        }
        Ok(())
    }

    /// The place of a channel's topic.
    fn place(&mut self, channel: &Channel<'_>) -> Result<usize, BagFault> {
        let kind_name = channel.schema.as_ref().map_or_else(|| "no type".to_owned(), |schema| schema.name.clone());
        let key = (channel.topic.clone(), kind_name, channel.message_encoding.clone());
        if let Some(place) = self.places.get(&key) {
            return Ok(*place);
        }
        if self.topics.len() >= MAX_TOPICS {
            return Err(BagFault::Large { what: "topics", most: MAX_TOPICS as u64 });
        }
        let (name, kind_name, encoding) = key.clone();
        let is_ros = encoding == "cdr";
        let kind = Kind::of(&plain(&kind_name)).filter(|_| is_ros);
        let layout = is_ros.then(|| match (kind, &channel.schema) {
            (Some(_), Some(schema)) => {
                Layout::read(&schema.name, &schema.encoding, &schema.data).map_err(|why| why.to_string())
            }
            (Some(_) | None, _) => Err("it is not read".to_owned()),
        });
        let why = layout.as_ref().and_then(|layout| layout.as_ref().err().cloned()).filter(|_| kind.is_some());
        self.topics.push(Topic {
            name,
            kind_name: if is_ros { kind_name } else { format!("{kind_name}, {encoding}") },
            kind,
            layout,
            messages: 0,
            bad: 0,
            why,
            wrong: 0,
            first_wrong: None,
            robots: 0,
            sightings: Vec::new(),
            goals: Vec::new(),
        });
        let place = self.topics.len() - 1;
        self.places.insert(key, place);
        Ok(place)
    }

    fn messages(&self) -> u64 {
        self.topics.iter().map(|topic| topic.messages).sum()
    }

    /// Topics in order of their names.
    pub(super) fn in_order(&self) -> Vec<&Topic> {
        self.places.values().filter_map(|place| self.topics.get(*place)).collect()
    }

    /// Topics with type and count in a sentence, and why those that should be read cannot be.
    pub(super) fn listed(&self, which: impl Fn(&Topic) -> bool) -> String {
        let topics: Vec<&Topic> = self.in_order().into_iter().filter(|topic| which(topic)).collect();
        let named = topics.iter().take(NAMED).map(|topic| {
            let why = topic.why.as_ref().filter(|_| topic.bad > 0).map_or_else(String::new, |why| format!(": {why}"));
            format!("{} {}{why}", topic.shown(), topic.messages)
        });
        let mut named: Vec<String> = named.collect();
        if topics.len() > NAMED {
            named.push(format!("{} more", topics.len() - NAMED));
        }
        if named.is_empty() { "none".to_owned() } else { named.join(", ") }
    }

    /// Whether there is anything that could be scored.
    ///
    /// # Errors
    /// [`BagFault::Empty`] and [`BagFault::Foreign`].
    pub(super) fn holds_messages(&self) -> Result<(), BagFault> {
        if self.messages() == 0 {
            return Err(BagFault::Empty { topics: self.listed(|_| true) });
        }
        if !self.is_ros() {
            return Err(BagFault::Foreign { topics: self.listed(|_| true) });
        }
        Ok(())
    }
}

/// Why no more of a file is read.
enum Stop {
    Fault(BagFault),
    Source(std::io::Error),
    Format(McapError),
}
