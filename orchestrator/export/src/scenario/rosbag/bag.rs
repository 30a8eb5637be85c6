//! The file of a bag and its `metadata.yaml`, as rosbag2 of ROS 2 Humble writes them (version 5); newer ones read that.

use std::collections::BTreeMap;
use std::io::Cursor;

use mcap::records::MessageHeader;
use mcap::{Compression, WriteOptions, Writer};
use serde::Serialize;

use super::cdr::Cdr;
use super::definitions::definition;
use crate::graph::Unusable;

/// Time of the first tick, ns: 0 means "no time" or "the latest" to ROS.
pub(super) const BEGIN_NANOS: u64 = 1_000_000_000;

/// Whether a topic keeps its last message for those who come later.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kept {
    /// Those who come later miss it.
    No,
    /// Durability `transient_local`.
    Last,
}

/// A topic: its name, its type (`nav_msgs/Odometry`) and whether its last message is kept.
#[derive(Debug, Clone, Copy)]
pub(super) struct Topic {
    pub(super) name: &'static str,
    pub(super) kind: &'static str,
    pub(super) kept: Kept,
}

impl Topic {
    /// The type with the folder in which ROS 2 keeps it.
    fn full_kind(&self) -> String {
        self.kind.replacen('/', "/msg/", 1)
    }

    /// Quality of service as rosbag2 notes it: history, depth, reliability and durability; no deadline.
    fn qos(&self) -> String {
        let durability = if self.kept == Kept::Last { 1 } else { 2 };
        let ever = "\n    sec: 9223372036\n    nsec: 854775807";
        format!(
            "- history: 3\n  depth: 0\n  reliability: 1\n  durability: {durability}\n  deadline:{ever}\n  lifespan:{ever}\n  \
             liveliness: 1\n  liveliness_lease_duration:{ever}\n  avoid_ros_namespace_conventions: false"
        )
    }
}

/// A bag as it is written.
pub(super) struct Bag {
    writer: Writer<Cursor<Vec<u8>>>,
    /// Channel, topic and number of messages, by the topic's name.
    topics: BTreeMap<&'static str, (u16, Topic, u64)>,
    /// Times of the first and the last message, ns.
    times: Option<(u64, u64)>,
}

fn broken(why: mcap::McapError) -> Unusable {
    Unusable::new("recording", format!("the bag cannot be written: {why}"), "export a shorter run")
}

impl Bag {
    pub(super) fn new() -> Result<Self, Unusable> {
        let options = WriteOptions::new().compression(Some(Compression::Zstd)).profile("ros2");
        let writer = options.create(Cursor::new(Vec::new())).map_err(broken)?;
        Ok(Self { writer, topics: BTreeMap::new(), times: None })
    }

    /// Adds a message so many nanoseconds after the first tick.
    pub(super) fn send(&mut self, topic: Topic, nanos: u64, message: Cdr) -> Result<(), Unusable> {
        if !self.topics.contains_key(topic.name) {
            let text = definition(topic.kind);
            let schema = self.writer.add_schema(&topic.full_kind(), "ros2msg", text.as_bytes()).map_err(broken)?;
            let notes = BTreeMap::from([("offered_qos_profiles".to_owned(), topic.qos())]);
            let channel = self.writer.add_channel(schema, topic.name, "cdr", &notes).map_err(broken)?;
            self.topics.insert(topic.name, (channel, topic, 0));
        }
        let Some((channel, _, count)) = self.topics.get_mut(topic.name) else { return Ok(()) };
        let log_time = BEGIN_NANOS.saturating_add(nanos);
        let sequence = u32::try_from(*count).unwrap_or(u32::MAX);
        let header = MessageHeader { channel_id: *channel, sequence, log_time, publish_time: log_time };
        *count += 1;
        self.times =
            Some(self.times.map_or((log_time, log_time), |(first, last)| (first.min(log_time), last.max(log_time))));
        self.writer.write_to_known_channel(&header, &message.bytes()).map_err(broken)
    }

    /// The file, and the text of `metadata.yaml` for a file of this name.
    pub(super) fn finish(mut self, file: &str) -> Result<(Vec<u8>, String), Unusable> {
        self.writer.finish().map_err(broken)?;
        let (first, last) = self.times.unwrap_or((BEGIN_NANOS, BEGIN_NANOS));
        let count = self.topics.values().map(|(_, _, count)| count).sum();
        let span = Span {
            duration: Nanos { nanoseconds: last - first },
            starting_time: Since { nanoseconds_since_epoch: first },
        };
        let topic = |(_, topic, count): &(u16, Topic, u64)| Counted {
            topic_metadata: Told {
                name: topic.name,
                r#type: topic.full_kind(),
                serialization_format: "cdr",
                offered_qos_profiles: topic.qos(),
            },
            message_count: *count,
        };
        let metadata = Metadata {
            rosbag2_bagfile_information: Information {
                version: 5,
                storage_identifier: "mcap",
                span,
                message_count: count,
                topics_with_message_count: self.topics.values().map(topic).collect(),
                compression_format: "",
                compression_mode: "",
                relative_file_paths: [file],
                files: [Part { path: file, span, message_count: count }],
            },
        };
        let text = yaml_serde::to_string(&metadata)
            .map_err(|why| Unusable::new("metadata.yaml", why.to_string(), "please report it"))?;
        Ok((self.writer.into_inner().into_inner(), text))
    }
}

#[derive(Serialize)]
struct Metadata<'a> {
    rosbag2_bagfile_information: Information<'a>,
}

#[derive(Serialize)]
struct Information<'a> {
    version: u32,
    storage_identifier: &'static str,
    #[serde(flatten)]
    span: Span,
    message_count: u64,
    topics_with_message_count: Vec<Counted>,
    compression_format: &'static str,
    compression_mode: &'static str,
    relative_file_paths: [&'a str; 1],
    files: [Part<'a>; 1],
}

#[derive(Serialize, Clone, Copy)]
struct Span {
    duration: Nanos,
    starting_time: Since,
}

#[derive(Serialize, Clone, Copy)]
struct Nanos {
    nanoseconds: u64,
}

#[derive(Serialize, Clone, Copy)]
struct Since {
    nanoseconds_since_epoch: u64,
}

#[derive(Serialize)]
struct Counted {
    topic_metadata: Told,
    message_count: u64,
}

#[derive(Serialize)]
struct Told {
    name: &'static str,
    r#type: String,
    serialization_format: &'static str,
    offered_qos_profiles: String,
}

#[derive(Serialize)]
struct Part<'a> {
    path: &'a str,
    #[serde(flatten)]
    span: Span,
    message_count: u64,
}
