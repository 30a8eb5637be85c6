//! The messages of a bag and its `metadata.yaml`, as rosbag2 of ROS 2 Humble writes it (version 5); newer ones read that.

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

/// The messages of a bag, which the shell writes as MCAP.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Bag {
    /// Topics in the order of their first messages.
    pub channels: Vec<Channel>,
    /// Messages in the order of their times.
    pub messages: Vec<Message>,
}

/// A topic of a bag.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Channel {
    /// Name of the topic.
    pub topic: &'static str,
    /// Type as ROS 2 writes it: `nav_msgs/msg/Odometry`.
    pub kind: String,
    /// Definition of the type in the encoding `ros2msg`.
    pub definition: String,
    /// Quality of service as YAML, as rosbag2 notes it.
    pub qos: String,
}

/// A message of a bag.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Message {
    /// Place of its topic among the channels.
    pub channel: usize,
    /// When, ns.
    pub nanos: u64,
    /// Its bytes in CDR.
    pub data: Vec<u8>,
}

impl Bag {
    /// Adds a message so many nanoseconds after the first tick.
    pub(super) fn send(&mut self, topic: Topic, nanos: u64, message: Cdr) {
        let known = self.channels.iter().position(|channel| channel.topic == topic.name);
        let channel = known.unwrap_or_else(|| {
            let (kind, definition, qos) = (topic.full_kind(), definition(topic.kind), topic.qos());
            self.channels.push(Channel { topic: topic.name, kind, definition, qos });
            self.channels.len() - 1
        });
        self.messages.push(Message { channel, nanos: BEGIN_NANOS.saturating_add(nanos), data: message.bytes() });
    }

    /// The text of `metadata.yaml` for a file of this name.
    pub(super) fn metadata(&self, file: &str) -> Result<String, Unusable> {
        let times = || self.messages.iter().map(|message| message.nanos);
        let first = times().min().unwrap_or(BEGIN_NANOS);
        let count = |wanted: usize| self.messages.iter().filter(|message| message.channel == wanted).count();
        let span = Span {
            duration: Nanos { nanoseconds: times().max().unwrap_or(first) - first },
            starting_time: Since { nanoseconds_since_epoch: first },
        };
        let topic = |(number, channel): (usize, &Channel)| Counted {
            topic_metadata: Told {
                name: channel.topic,
                r#type: channel.kind.clone(),
                serialization_format: "cdr",
                offered_qos_profiles: channel.qos.clone(),
            },
            message_count: count(number),
        };
        let message_count = self.messages.len();
        let metadata = Metadata {
            rosbag2_bagfile_information: Information {
                version: 5,
                storage_identifier: "mcap",
                span,
                message_count,
                topics_with_message_count: self.channels.iter().enumerate().map(topic).collect(),
                compression_format: "",
                compression_mode: "",
                relative_file_paths: [file],
                files: [Part { path: file, span, message_count }],
            },
        };
        yaml_serde::to_string(&metadata)
            .map_err(|why| Unusable::new("metadata.yaml", why.to_string(), "please report it"))
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
    message_count: usize,
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
    message_count: usize,
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
    message_count: usize,
}
