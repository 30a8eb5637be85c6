//! Why a bag cannot be scored, and what mends it.

/// Why a bag cannot be scored.
#[derive(Debug, thiserror::Error)]
pub enum BagFault {
    /// A file of the bag cannot be read at all.
    #[error("{why}")]
    Read {
        /// Why, in the words of the library.
        why: String,
        /// Whether it may be a file that was cut off.
        cut: bool,
    },
    /// There is no message of ROS 2 in it.
    #[error("it holds no message of ROS 2; its topics are {topics}")]
    Foreign {
        /// Its topics with their types, encodings and counts.
        topics: String,
    },
    /// There are topics, and no message.
    #[error("it holds no message; its topics are {topics}")]
    Empty {
        /// Its topics with their types.
        topics: String,
    },
    /// More than is read.
    #[error("it has more than {most} {what}")]
    Large {
        /// What there is too much of.
        what: &'static str,
        /// How much is read.
        most: u64,
    },
    /// More people than a recording has.
    #[error("more than {most} people are named in it")]
    Crowd {
        /// How many are read.
        most: usize,
    },
    /// Nothing says where the robot was.
    #[error("nothing in it says where the robot was; its topics are {topics}")]
    NoRobot {
        /// Its topics with their types, counts, and why those that were tried cannot be read.
        topics: String,
    },
    /// The topic or frame that the user names is not there.
    #[error("{option} names `{wanted}`, which is not there; {have}")]
    NotThere {
        /// The option of the command line.
        option: &'static str,
        /// What it says.
        wanted: String,
        /// What there is.
        have: String,
    },
    /// Most messages of a topic that is needed cannot be read.
    #[error("{bad} of {count} messages of `{topic}` ({kind}) cannot be read: {why}")]
    Messages {
        /// The topic.
        topic: String,
        /// Its type.
        kind: String,
        /// Messages that cannot be read.
        bad: u64,
        /// All messages.
        count: u64,
        /// Why the first of them cannot.
        why: String,
    },
    /// Most places of a topic that is needed are none.
    #[error("{bad} of {count} places of `{topic}` ({kind}) are none: {why}")]
    Places {
        /// The topic.
        topic: String,
        /// Its type.
        kind: String,
        /// Places with numbers that are none or out of all bounds.
        bad: usize,
        /// All places.
        count: usize,
        /// The first of them.
        why: String,
    },
    /// Frames that nothing connects.
    #[error(
        "`{topic}` is in the frame `{frame}` and the robot in `{target}`, and no transform in the bag connects them{near}"
    )]
    Apart {
        /// The topic.
        topic: String,
        /// Its frame.
        frame: String,
        /// The frame in which everybody is placed.
        target: String,
        /// Frames that do stand in others.
        near: String,
    },
    /// Frames that are connected, but at other times.
    #[error("no transform from `{frame}` to `{target}` is within 1 s of any message of `{topic}`")]
    Never {
        /// The topic.
        topic: String,
        /// Its frame.
        frame: String,
        /// The frame in which everybody is placed.
        target: String,
    },
    /// Two clocks in one bag.
    #[error("`{early}` begins at {early_s:.1} s and `{late}` at {late_s:.1} s: their time stamps are of two clocks")]
    Clocks {
        /// The topic with the smaller times.
        early: String,
        /// Its first time, s.
        early_s: f64,
        /// The topic with the larger times.
        late: String,
        /// Its first time, s.
        late_s: f64,
    },
    /// The clock was set or began again.
    #[error("the times of `{topic}` jump from {from_s:.2} s to {to_s:.2} s: the clock was set or started again")]
    Jumps {
        /// The topic.
        topic: String,
        /// Time before, s.
        from_s: f64,
        /// Time after, s.
        to_s: f64,
    },
    /// `metadata.yaml` is none.
    #[error("it is no metadata of a bag: {why}")]
    Metadata {
        /// Why.
        why: String,
    },
    /// A storage that is not read.
    #[error("its storage is `{storage}`; `mcap` is read")]
    Storage {
        /// `storage_identifier` of the metadata.
        storage: String,
    },
    /// Files or messages that were compressed by the recorder.
    #[error("it was compressed by `{mode}` with `{format}`; chunks of MCAP compressed with zstd or lz4 are read")]
    Compressed {
        /// `compression_mode` of the metadata.
        mode: String,
        /// `compression_format` of the metadata.
        format: String,
    },
}

/// How a bag of any storage becomes one that is read.
pub const CONVERT: &str = "`ros2 bag convert -i BAG -o mcap.yaml` writes it as MCAP, where mcap.yaml is \
                           `output_bags: [{uri: BAG_mcap, storage_id: mcap, all: true}]`; without ROS, \
                           `rosbags-convert --src BAG --dst BAG_mcap --dst-storage mcap` does (`pip install rosbags`)";

impl BagFault {
    /// What mends it.
    #[must_use]
    pub fn hint(&self) -> String {
        let hint = match self {
            Self::Read { cut: true, .. } => {
                "the file was cut off or is damaged: `mcap recover FILE -o WHOLE.mcap` keeps what is whole, or copy it again"
            }
            Self::Read { cut: false, .. } => {
                "MCAP as `ros2 bag record -s mcap` writes it is read, uncompressed or with zstd or lz4"
            }
            Self::Foreign { .. } | Self::Empty { .. } | Self::NoRobot { .. } => {
                "needed are /odom (nav_msgs/msg/Odometry), /tf (tf2_msgs/msg/TFMessage) or /robot_states (hunav_msgs/msg/Agent), and for \
                 people /human_states (hunav_msgs/msg/Agents), /people (people_msgs/msg/People) or poses: `ros2 bag record -s mcap /tf \
                 /tf_static /odom /people /goal_pose`"
            }
            Self::Large { .. } => {
                "a bag of the topics that are needed is small: `ros2 bag record -s mcap /tf /tf_static /odom /people /goal_pose`"
            }
            Self::Crowd { .. } => {
                "a tracker that gives people new names makes a crowd of few: score a shorter bag, or one in which names last"
            }
            Self::NotThere { .. } => "`ros2 bag info BAG` lists the topics",
            Self::Messages { .. } => {
                "plain CDR with its definition (`ros2msg`) is read: record where the package of the message is sourced, and without \
                 --compression-mode message"
            }
            Self::Places { .. } => "places are finite numbers of meters, at most 1000000 from the origin",
            Self::Apart { .. } | Self::Never { .. } => {
                "record /tf and /tf_static with it, or publish what is missing: `ros2 run tf2_ros static_transform_publisher --frame-id \
                 map --child-frame-id odom`"
            }
            Self::Clocks { .. } => {
                "set use_sim_time on every node, so that all of them stamp their messages by one clock"
            }
            Self::Jumps { .. } => "score one run at a time: record each into a bag of its own",
            Self::Metadata { .. } => {
                "`ros2 bag reindex BAG` writes it anew; the .mcap file of the bag can be named as well"
            }
            Self::Storage { .. } | Self::Compressed { .. } => CONVERT,
        };
        hint.to_owned()
    }
}
