//! What the server says: texts in JSON, and binary messages, all numbers in them little endian.
//!
//! Source: foxglove/ws-protocol, `docs/spec.md`, and the reference server of `foxglove-sdk` 0.30.3, whose words these are.

use std::collections::BTreeMap;

use serde::Serialize;

use super::channels::{Topic, Topics};

/// Names of the protocol, the preferred one first. They differ in the name alone: the second is the older one, which releases of
/// Lichtblick up to 1.21 and the npm package `@foxglove/ws-protocol` offer.
pub const SUBPROTOCOLS: [&str; 2] = ["foxglove.sdk.v1", "foxglove.websocket.v1"];

/// The protocol to speak with a client that offers these, as its header `Sec-WebSocket-Protocol` lists them: names with commas
/// between. Nothing where it offers none that we know.
#[must_use]
pub fn pick(offered: &str) -> Option<&'static str> {
    SUBPROTOCOLS.into_iter().find(|name| offered.split(',').any(|offer| offer.trim() == *name))
}

/// What a server can do besides sending messages.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "camelCase")]
pub enum Capability {
    /// It tells the time.
    Time,
    /// It plays what is kept, and stops, and jumps.
    PlaybackControl,
}

/// A time in JSON: whole seconds and nanoseconds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct JsonTime {
    /// Seconds.
    pub sec: u64,
    /// Nanoseconds, less than a second.
    pub nsec: u64,
}

impl JsonTime {
    /// A time of so many nanoseconds.
    #[must_use]
    pub const fn of(nanos: u64) -> Self {
        Self { sec: nanos / 1_000_000_000, nsec: nanos % 1_000_000_000 }
    }
}

/// How much a status matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(into = "u8")]
pub enum Level {
    /// Good to know.
    Info,
    /// Something was not done as asked.
    Warning,
    /// Something could not be read.
    Error,
}

impl From<Level> for u8 {
    fn from(level: Level) -> Self {
        match level {
            Level::Info => 0,
            Level::Warning => 1,
            Level::Error => 2,
        }
    }
}

/// A channel as it is advertised.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Channel {
    /// Its number.
    pub id: u32,
    /// Name of the topic.
    pub topic: &'static str,
    /// How messages are encoded.
    pub encoding: &'static str,
    /// Name of the schema.
    pub schema_name: &'static str,
    /// How the schema is written.
    pub schema_encoding: &'static str,
    /// The schema: base64 for protocol buffers.
    pub schema: String,
}

impl Channel {
    /// The channel of a topic.
    #[must_use]
    pub fn of(topic: Topic) -> Self {
        let sheet = topic.sheet();
        Self {
            id: topic.id(),
            topic: sheet.name,
            encoding: sheet.encoding,
            schema_name: sheet.schema,
            schema_encoding: sheet.schema_encoding,
            schema: topic.schema_text(),
        }
    }
}

/// A text of the server.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(tag = "op", rename_all = "camelCase", rename_all_fields = "camelCase")]
pub enum ServerOp<'a> {
    /// The first message: who speaks, and what can be asked.
    ServerInfo {
        /// Name of what is shown.
        name: &'a str,
        /// What can be asked.
        capabilities: Vec<Capability>,
        /// Key and value, for people.
        #[serde(skip_serializing_if = "BTreeMap::is_empty")]
        metadata: BTreeMap<&'a str, &'a str>,
        /// Another one than before makes a viewer forget what it has.
        session_id: &'a str,
        /// Begin of what is kept; with playback alone.
        #[serde(skip_serializing_if = "Option::is_none")]
        data_start_time: Option<JsonTime>,
        /// End of what is kept; with playback alone.
        #[serde(skip_serializing_if = "Option::is_none")]
        data_end_time: Option<JsonTime>,
    },
    /// Channels that one may subscribe to.
    Advertise {
        /// The channels.
        channels: Vec<Channel>,
    },
    /// Channels that are gone.
    Unadvertise {
        /// Their numbers.
        channel_ids: Vec<u32>,
    },
    /// A sentence for the person in front of the viewer.
    Status {
        /// How much it matters.
        level: Level,
        /// The sentence.
        message: &'a str,
        /// A later status of the same id takes its place.
        #[serde(skip_serializing_if = "Option::is_none")]
        id: Option<&'a str>,
    },
    /// Takes statuses away again.
    RemoveStatus {
        /// Their ids.
        status_ids: Vec<&'a str>,
    },
}

impl ServerOp<'_> {
    /// The text.
    #[must_use]
    pub fn text(&self) -> String {
        // It holds texts and whole numbers alone, which always have a form in JSON.
        serde_json::to_string(self).unwrap_or_default()
    }

    /// Channels for topics.
    #[must_use]
    pub fn advertise(topics: Topics) -> Self {
        Self::Advertise { channels: topics.iter().map(Channel::of).collect() }
    }
}

/// A sentence for the person in front of the viewer, such as that frames are skipped; one of the same id takes its place.
#[must_use]
pub fn status(level: Level, message: &str, id: Option<&str>) -> String {
    ServerOp::Status { level, message, id }.text()
}

/// Bytes before the payload of a message.
pub const HEAD_BYTES: usize = 13;

/// What stands before the payload of a message: `1`, the viewer's number of its subscription, the time in ns.
#[must_use]
pub fn message_head(subscription: u32, nanos: u64) -> [u8; HEAD_BYTES] {
    let mut head = [0; HEAD_BYTES];
    let bytes = [1].into_iter().chain(subscription.to_le_bytes()).chain(nanos.to_le_bytes());
    head.iter_mut().zip(bytes).for_each(|(slot, byte)| *slot = byte);
    head
}

/// The simulated time, ns: `2`, the time. The same bytes for every viewer.
#[must_use]
pub fn time(nanos: u64) -> Vec<u8> {
    [2].into_iter().chain(nanos.to_le_bytes()).collect()
}

/// How far a playback is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlaybackStatus {
    /// It plays.
    Playing,
    /// It stands.
    Paused,
    /// It waits for what is to be shown.
    Buffering,
    /// It is at the end.
    Ended,
}

impl PlaybackStatus {
    const fn code(self) -> u8 {
        match self {
            Self::Playing => 0,
            Self::Paused => 1,
            Self::Buffering => 2,
            Self::Ended => 3,
        }
    }
}

/// State of a playback: `5`, status, time in ns, speed, whether it jumped, the request that it answers (empty: none).
#[must_use]
pub fn playback_state(status: PlaybackStatus, nanos: u64, speed: f32, jumped: bool, request: &str) -> Vec<u8> {
    let mut out = vec![5, status.code()];
    out.extend(nanos.to_le_bytes());
    out.extend(speed.to_le_bytes());
    out.push(u8::from(jumped));
    out.extend(u32::try_from(request.len()).unwrap_or(u32::MAX).to_le_bytes());
    out.extend(request.as_bytes());
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn hex(bytes: &[u8]) -> String {
        bytes.iter().map(|byte| format!("{byte:02x}")).collect()
    }

    #[test]
    fn the_newer_name_is_preferred_and_an_unknown_one_is_none() {
        assert_eq!(pick("foxglove.websocket.v1, foxglove.sdk.v1"), Some("foxglove.sdk.v1"));
        assert_eq!(pick("foxglove.websocket.v1"), Some("foxglove.websocket.v1"));
        assert_eq!(pick("foxglove.sdk.v1.1,foxglove.sdk.v1"), Some("foxglove.sdk.v1"));
        for offered in ["", "foxglove.sdk.v1.1", "foxglove.sdk.v2", "mqtt", "foxglove.sdk.v1 x"] {
            assert_eq!(pick(offered), None, "{offered}");
        }
    }

    #[test]
    fn texts_have_the_keys_of_the_reference_server() {
        let read = |op: &ServerOp<'_>| serde_json::from_str::<serde_json::Value>(&op.text()).unwrap();
        let info = ServerOp::ServerInfo {
            name: "reference",
            capabilities: vec![Capability::Time, Capability::PlaybackControl],
            metadata: BTreeMap::from([("fg-library", "foxglove-sdk-python/0.30.3")]),
            session_id: "s1",
            data_start_time: Some(JsonTime::of(0)),
            data_end_time: Some(JsonTime::of(60_000_000_000)),
        };
        // As the server of PyPI's foxglove-sdk 0.30.3 sent it.
        assert_eq!(
            read(&info),
            json!({
                "op": "serverInfo", "name": "reference", "capabilities": ["time", "playbackControl"],
                "metadata": {"fg-library": "foxglove-sdk-python/0.30.3"}, "sessionId": "s1",
                "dataStartTime": {"sec": 0, "nsec": 0}, "dataEndTime": {"sec": 60, "nsec": 0}
            })
        );
        let advertised = read(&ServerOp::advertise([Topic::Events].into_iter().collect()));
        let channel = advertised["channels"][0].as_object().unwrap();
        let keys: Vec<&str> = channel.keys().map(String::as_str).collect();
        assert_eq!(keys, ["encoding", "id", "schema", "schemaEncoding", "schemaName", "topic"]);
        assert_eq!((&channel["encoding"], &channel["schemaName"]), (&json!("protobuf"), &json!("foxglove.Log")));
        // The first bytes of the descriptors that the same server sent for foxglove.Log.
        assert!(
            channel["schema"].as_str().unwrap().starts_with("Cv8BCh9nb29nbGUvcHJvdG9idWYvdGltZXN0YW1wLnByb3RvEg9n")
        );
        assert_eq!(
            read(&ServerOp::Status { level: Level::Error, message: "Oh no", id: Some("my-id") }),
            json!({"op": "status", "level": 2, "message": "Oh no", "id": "my-id"})
        );
        assert_eq!(status(Level::Info, "a", None), r#"{"op":"status","level":0,"message":"a"}"#);
        assert_eq!(
            read(&ServerOp::RemoveStatus { status_ids: vec!["a"] }),
            json!({"op": "removeStatus", "statusIds": ["a"]})
        );
        assert_eq!(
            read(&ServerOp::Unadvertise { channel_ids: vec![1, 2] }),
            json!({"op": "unadvertise", "channelIds": [1, 2]})
        );
    }

    #[test]
    fn binary_messages_are_the_bytes_of_the_reference_server() {
        // Recorded from the server of PyPI's foxglove-sdk 0.30.3: a message of subscription 7 at 1.5 s, the time 2 s, the answer
        // to a request `r1` to play from 5 s on.
        assert_eq!(hex(&message_head(7, 1_500_000_000)), "0107000000002f685900000000");
        assert_eq!(hex(&time(2_000_000_000)), "020094357700000000");
        let state = playback_state(PlaybackStatus::Playing, 5_000_000_000, 1.0, true, "r1");
        assert_eq!(hex(&state), "050000f2052a010000000000803f01020000007231");
        let codes = [PlaybackStatus::Paused, PlaybackStatus::Buffering, PlaybackStatus::Ended];
        assert_eq!(codes.map(|status| playback_state(status, 0, 1.0, false, "")[1]), [1, 2, 3]);
    }
}
