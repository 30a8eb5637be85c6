//! The channels as data: what is published, under which name, in which words, and when.

use std::ops::{BitAnd, BitOr};

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use socrates_stream::foxglove::description_by_files;
use socrates_stream::mcap::record_schema;

/// Most frames per simulated second that are worth sending; Lichtblick complains above 60 messages a second and topic.
pub const FRAMES_HZ: f64 = 20.0;
/// Most scans per simulated second that are worth sending.
pub const SCANS_HZ: f64 = 10.0;

/// A topic that viewers may subscribe to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Topic {
    /// The map.
    Map,
    /// The shapes of everybody who is there, the goal and the doors.
    Scene,
    /// Where everybody is.
    Frames,
    /// The people as points, where they are too many for shapes.
    Crowd,
    /// The robot's lidar.
    Scan,
    /// The robot's intended way.
    Plan,
    /// The robot's pose and speed.
    Odometry,
    /// What happens.
    Events,
    /// Gestures that are being made.
    Labels,
    /// The states as a recording has them.
    Agents,
}

/// What is said of a topic.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sheet {
    /// Which topic.
    pub topic: Topic,
    /// Its name.
    pub name: &'static str,
    /// How its messages are encoded.
    pub encoding: &'static str,
    /// Name of the schema.
    pub schema: &'static str,
    /// How the schema is written.
    pub schema_encoding: &'static str,
    /// Whether a viewer that subscribes late is given what it has missed.
    pub latched: bool,
    /// Most messages per simulated second; 0: one whenever it changes.
    pub rate_hz: f64,
    /// One line about it.
    pub about: &'static str,
}

const fn protobuf(topic: Topic, name: &'static str, schema: &'static str) -> Sheet {
    Sheet {
        topic,
        name,
        encoding: "protobuf",
        schema,
        schema_encoding: "protobuf",
        latched: false,
        rate_hz: FRAMES_HZ,
        about: "",
    }
}

/// Every topic, in order of the channel ids.
pub const CATALOG: [Sheet; 10] = [
    Sheet {
        latched: true,
        rate_hz: 0.0,
        about: "occupancy in percent: 0 free, 100 occupied, 50 never seen; first row at the bottom",
        ..protobuf(Topic::Map, "/map", "foxglove.Grid")
    },
    Sheet {
        latched: true,
        rate_hz: 0.0,
        about: "everybody who is there, each fixed to their own frame; the goal and the doors; every message holds the whole scene",
        ..protobuf(Topic::Scene, "/scene", "foxglove.SceneUpdate")
    },
    Sheet {
        about: "from map to robot and human_k; above 200 agents the robot and the 50 people who are nearest to it",
        ..protobuf(Topic::Frames, "/tf", "foxglove.FrameTransforms")
    },
    Sheet {
        about: "the people as points with their speed, m/s; above 200 agents alone",
        ..protobuf(Topic::Crowd, "/crowd", "foxglove.PointCloud")
    },
    Sheet {
        rate_hz: SCANS_HZ,
        about: "the lidar in the frame of the robot",
        ..protobuf(Topic::Scan, "/scan", "foxglove.LaserScan")
    },
    Sheet {
        latched: true,
        rate_hz: 0.0,
        about: "the intended way, start first, goal last",
        ..protobuf(Topic::Plan, "/robot/plan", "foxglove.PosesInFrame")
    },
    Sheet {
        about: "pose in the map; velocity in the frame of the robot, m/s and rad/s; covariances are not known and 0",
        ..protobuf(Topic::Odometry, "/robot/odom", "foxglove.Odometry")
    },
    Sheet {
        latched: true,
        rate_hz: 0.0,
        about: "what happens, in sentences; a late viewer is given the newest 256",
        ..protobuf(Topic::Events, "/events", "foxglove.Log")
    },
    Sheet {
        latched: true,
        rate_hz: 0.0,
        about: "gestures that are being made, above the heads of those who make them",
        ..protobuf(Topic::Labels, "/socrates/labels", "foxglove.SceneUpdate")
    },
    Sheet {
        encoding: AGENT_STATE,
        schema_encoding: "jsonschema",
        about: "everybody's state as a recording has it: records of 64 bytes; for programs, no viewer shows it",
        ..protobuf(Topic::Agents, "/socrates/agents", AGENT_STATE)
    },
];

/// Name of the records of 64 bytes, as recordings have it.
const AGENT_STATE: &str = "socrates.AgentState.v1";

impl Topic {
    /// Number of its channel, from 1.
    #[must_use]
    pub const fn id(self) -> u32 {
        self as u32 + 1
    }

    /// The topic of a channel.
    #[must_use]
    pub fn of(id: u64) -> Option<Self> {
        CATALOG.iter().map(|sheet| sheet.topic).find(|topic| u64::from(topic.id()) == id)
    }

    /// What is said of it.
    #[must_use]
    pub fn sheet(self) -> &'static Sheet {
        CATALOG.iter().find(|sheet| sheet.topic == self).unwrap_or(&CATALOG[0])
    }

    /// Its schema as bytes: a set of descriptors for protocol buffers, text for JSON Schema.
    #[must_use]
    pub fn schema(self) -> Vec<u8> {
        if self == Self::Agents { record_schema("").into() } else { description_by_files(self.sheet().schema) }
    }

    /// Its schema as the protocol writes it in JSON: base64 for protocol buffers, the text itself for JSON Schema.
    #[must_use]
    pub fn schema_text(self) -> String {
        if self == Self::Agents { record_schema("") } else { STANDARD.encode(self.schema()) }
    }
}

/// A set of topics.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Topics(u16);

impl Topics {
    /// None.
    pub const NONE: Self = Self(0);

    /// The set with one more.
    #[must_use]
    pub const fn with(self, topic: Topic) -> Self {
        Self(self.0 | 1 << topic as u16)
    }

    /// The set with one less.
    #[must_use]
    pub const fn without(self, topic: Topic) -> Self {
        Self(self.0 & !(1 << topic as u16))
    }

    /// Whether a topic is in it.
    #[must_use]
    pub const fn has(self, topic: Topic) -> bool {
        self.0 & (1 << topic as u16) != 0
    }

    /// Whether it is empty.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// The topics in order of their channels.
    pub fn iter(self) -> impl Iterator<Item = Topic> {
        CATALOG.iter().map(|sheet| sheet.topic).filter(move |topic| self.has(*topic))
    }
}

impl BitOr for Topics {
    type Output = Self;
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl BitAnd for Topics {
    type Output = Self;
    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

impl FromIterator<Topic> for Topics {
    fn from_iter<I: IntoIterator<Item = Topic>>(topics: I) -> Self {
        topics.into_iter().fold(Self::NONE, Self::with)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use foxglove::Encode as _;
    use foxglove::messages::{FrameTransforms, Grid, LaserScan, Log, Odometry, PointCloud, PosesInFrame, SceneUpdate};
    use socrates_model::recording::{AGENT_STATE_BYTES, AgentState};

    #[test]
    fn channels_are_numbered_from_one_in_the_order_of_the_catalog() {
        for (place, sheet) in CATALOG.iter().enumerate() {
            assert_eq!(sheet.topic.id() as usize, place + 1, "{}", sheet.name);
            assert_eq!(Topic::of(place as u64 + 1), Some(sheet.topic));
            assert_eq!(sheet.topic.sheet(), sheet);
            assert!(sheet.name.starts_with('/') && !sheet.about.is_empty());
        }
        assert_eq!((Topic::of(0), Topic::of(11), Topic::of(u64::MAX)), (None, None, None));
    }

    #[test]
    fn schemas_are_those_of_the_library_of_foxglove_byte_by_byte() {
        let theirs = [
            (Topic::Map, Grid::get_schema()),
            (Topic::Scene, SceneUpdate::get_schema()),
            (Topic::Frames, FrameTransforms::get_schema()),
            (Topic::Crowd, PointCloud::get_schema()),
            (Topic::Scan, LaserScan::get_schema()),
            (Topic::Plan, PosesInFrame::get_schema()),
            (Topic::Odometry, Odometry::get_schema()),
            (Topic::Events, Log::get_schema()),
            (Topic::Labels, SceneUpdate::get_schema()),
        ];
        assert_eq!(theirs.len(), CATALOG.iter().filter(|sheet| sheet.encoding == "protobuf").count());
        for (topic, schema) in theirs {
            let schema = schema.unwrap();
            assert_eq!((topic.sheet().schema, topic.sheet().schema_encoding), (&*schema.name, &*schema.encoding));
            assert_eq!(topic.schema(), *schema.data, "{}", schema.name);
            assert_eq!(STANDARD.decode(topic.schema_text()).unwrap(), *schema.data);
        }
    }

    #[test]
    fn the_text_about_the_records_says_where_the_bytes_are() {
        let schema: serde_json::Value = serde_json::from_str(&Topic::Agents.schema_text()).unwrap();
        assert_eq!(schema["x-record-bytes"], AGENT_STATE_BYTES);
        let state = AgentState { tick: 1, agent: 2, flags: 3, x: 4.0, y: 5.0, yaw: 6.0, vx: 7.0, vy: 8.0, omega: 9.0 };
        let bytes = state.to_bytes();
        let wanted = [
            ("tick", 1.0),
            ("agent", 2.0),
            ("flags", 3.0),
            ("x", 4.0),
            ("y", 5.0),
            ("yaw", 6.0),
            ("vx", 7.0),
            ("vy", 8.0),
            ("omega", 9.0),
        ];
        let fields = &schema["items"]["properties"];
        assert_eq!(fields.as_object().unwrap().len(), wanted.len());
        for (name, value) in wanted {
            let at = usize::try_from(fields[name]["x-offset"].as_u64().unwrap()).unwrap();
            let read = match fields[name]["format"].as_str().unwrap() {
                "uint64" => u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap()) as f64,
                "uint32" => f64::from(u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap())),
                "float64" => f64::from_le_bytes(bytes[at..at + 8].try_into().unwrap()),
                other => panic!("{other}"),
            };
            assert!((read - value).abs() < f64::EPSILON, "{name}: {read}");
        }
    }

    #[test]
    fn a_set_holds_what_was_put_into_it() {
        let set: Topics = [Topic::Events, Topic::Map].into_iter().collect();
        assert_eq!(set.iter().collect::<Vec<_>>(), [Topic::Map, Topic::Events]);
        assert!(
            set.has(Topic::Map) && !set.has(Topic::Scan) && set.without(Topic::Map).without(Topic::Events).is_empty()
        );
        assert_eq!(set & Topics::NONE.with(Topic::Map), Topics::NONE.with(Topic::Map));
        assert_eq!(Topics::NONE.with(Topic::Map) | Topics::NONE.with(Topic::Events), set);
    }
}
