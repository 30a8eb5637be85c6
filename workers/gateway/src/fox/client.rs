//! What a viewer says, read at the door: into a value that cannot be wrong, or an error that says what, where, which value, and
//! what would have been right.

use serde::Deserialize;

/// Longest message that is read, bytes.
pub const MESSAGE_BYTES: usize = 64 * 1024;
/// Deepest nesting of a text.
pub const JSON_DEPTH: usize = 32;
/// Most subscriptions of one viewer, and most entries of any list in one message.
pub const SUBSCRIPTIONS: usize = 256;
/// Longest name of a request to play, bytes.
pub const REQUEST_BYTES: usize = 256;
/// Characters that an error repeats of what was sent.
const SHOWN_CHARS: usize = 40;

/// A message as it came in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Inbound<'a> {
    /// A text.
    Text(&'a str),
    /// Bytes.
    Binary(&'a [u8]),
}

/// A wish for the messages of a channel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Subscription {
    /// The viewer's own number for it, which every message repeats.
    pub id: u32,
    /// The channel.
    pub channel_id: u64,
}

/// A wish of a viewer of something that is kept.
#[derive(Debug, Clone, PartialEq)]
pub struct PlaybackControl {
    /// Whether to play; else to stand.
    pub play: bool,
    /// Simulated seconds per second.
    pub speed: f32,
    /// Where to go first, ns.
    pub seek: Option<u64>,
    /// Name of the request, which its answer repeats.
    pub request: String,
}

/// What a viewer asks for.
#[derive(Debug, Clone, PartialEq)]
pub enum ClientOp {
    /// The messages of channels.
    Subscribe(Vec<Subscription>),
    /// No more messages for these subscriptions.
    Unsubscribe(Vec<u32>),
    /// To play, stand or jump.
    Playback(PlaybackControl),
    /// Something that the protocol knows and that viewers here do not do.
    Other(Deed),
}

/// What the protocol knows and viewers here do not do: here they only read, and nothing of it reaches a run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Deed {
    /// To offer topics of its own.
    Advertise {
        /// Their names.
        topics: Vec<String>,
    },
    /// To take them back.
    Unadvertise {
        /// Their numbers.
        channels: Vec<u32>,
    },
    /// To publish a message.
    Publish {
        /// On which of its channels.
        channel: u32,
    },
    /// To read parameters.
    GetParameters {
        /// Which; none: all.
        names: Vec<String>,
    },
    /// To set parameters.
    SetParameters {
        /// Which.
        names: Vec<String>,
    },
    /// To be told when parameters change.
    SubscribeParameterUpdates {
        /// Which.
        names: Vec<String>,
    },
    /// To be told no longer.
    UnsubscribeParameterUpdates {
        /// Which.
        names: Vec<String>,
    },
    /// To call a service.
    CallService {
        /// Number of the service.
        service: u32,
        /// Number of the call.
        call: u32,
    },
    /// To be sent a file.
    FetchAsset {
        /// Which.
        uri: String,
        /// Number of the request.
        request: u32,
    },
    /// To be told who publishes what.
    SubscribeConnectionGraph,
    /// To be told no longer.
    UnsubscribeConnectionGraph,
}

impl Deed {
    /// Its name in the protocol.
    #[must_use]
    pub const fn op(&self) -> &'static str {
        match self {
            Self::Advertise { .. } => "advertise",
            Self::Unadvertise { .. } => "unadvertise",
            Self::Publish { .. } => "message data",
            Self::GetParameters { .. } => "getParameters",
            Self::SetParameters { .. } => "setParameters",
            Self::SubscribeParameterUpdates { .. } => "subscribeParameterUpdates",
            Self::UnsubscribeParameterUpdates { .. } => "unsubscribeParameterUpdates",
            Self::CallService { .. } => "service call",
            Self::FetchAsset { .. } => "fetchAsset",
            Self::SubscribeConnectionGraph => "subscribeConnectionGraph",
            Self::UnsubscribeConnectionGraph => "unsubscribeConnectionGraph",
        }
    }
}

/// A message that cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum BadMessage {
    /// It is too long.
    #[error("a message of {found} bytes is too long; at most {MESSAGE_BYTES}")]
    Long {
        /// Its length.
        found: usize,
    },
    /// A text is nested too deeply.
    #[error("a text is nested more than {JSON_DEPTH} deep at byte {at}; no message of the protocol needs more than 4")]
    Deep {
        /// Where.
        at: usize,
    },
    /// A text is no object with a name.
    #[error(
        "a text is no message of the protocol: {why}; it is an object such as {{\"op\":\"unsubscribe\",\"subscriptionIds\":[1]}}"
    )]
    Form {
        /// The reader's words.
        why: String,
    },
    /// A text with a name that the protocol does not have.
    #[error("`op` is `{found}`, which the protocol does not have; viewers here send `subscribe` and `unsubscribe`")]
    Op {
        /// The name.
        found: String,
    },
    /// A text whose name is known and whose rest is not right.
    #[error("`{op}` cannot be read: {why}; it is {example}")]
    Field {
        /// The name.
        op: &'static str,
        /// The reader's words.
        why: String,
        /// What would be right.
        example: &'static str,
    },
    /// A list that is too long.
    #[error("`{op}` lists {found} entries; at most {SUBSCRIPTIONS}")]
    Many {
        /// The name.
        op: &'static str,
        /// How many.
        found: usize,
    },
    /// Bytes of a kind that the protocol does not have.
    #[error(
        "a binary message begins with {found}; clients send 1 (message data), 2 (service call) and 3 (playback control)"
    )]
    Kind {
        /// The first byte.
        found: u8,
    },
    /// Bytes that end too early, or go on too long.
    #[error("a binary {what} is {found} bytes long; it takes {needed}")]
    Length {
        /// What kind.
        what: &'static str,
        /// Its length.
        found: usize,
        /// What it would have to be.
        needed: String,
    },
    /// A value in bytes that does not exist.
    #[error("`{field}` of a playback control is {found}; {allowed}")]
    Value {
        /// Which.
        field: &'static str,
        /// The value.
        found: String,
        /// What would be right.
        allowed: &'static str,
    },
}

/// Reads a message of a viewer.
///
/// # Errors
/// [`BadMessage`].
pub fn read(inbound: Inbound<'_>) -> Result<ClientOp, BadMessage> {
    let found = match inbound {
        Inbound::Text(text) => text.len(),
        Inbound::Binary(bytes) => bytes.len(),
    };
    if found > MESSAGE_BYTES {
        return Err(BadMessage::Long { found });
    }
    match inbound {
        Inbound::Text(text) => read_text(text),
        Inbound::Binary(bytes) => read_binary(bytes),
    }
}

#[derive(Deserialize)]
struct Named {
    op: String,
}

#[derive(Deserialize)]
struct Subscribe {
    subscriptions: Vec<Subscription>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Unsubscribe {
    subscription_ids: Vec<u32>,
}

#[derive(Deserialize)]
struct Advertise {
    channels: Vec<Advertised>,
}

#[derive(Deserialize)]
struct Advertised {
    topic: String,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Unadvertise {
    channel_ids: Vec<u32>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct ParameterNames {
    parameter_names: Vec<String>,
}

#[derive(Deserialize)]
struct SetParameters {
    parameters: Vec<Parameter>,
}

#[derive(Deserialize)]
struct Parameter {
    name: String,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct FetchAsset {
    uri: String,
    request_id: u32,
}

fn read_text(text: &str) -> Result<ClientOp, BadMessage> {
    if let Some(at) = too_deep(text) {
        return Err(BadMessage::Deep { at });
    }
    let Named { op } = serde_json::from_str(text).map_err(|why| BadMessage::Form { why: why.to_string() })?;
    let deed = match op.as_str() {
        "subscribe" => {
            let example = r#"{"op":"subscribe","subscriptions":[{"id":0,"channelId":1}]}"#;
            let Subscribe { subscriptions } = rest("subscribe", text, example)?;
            return listed("subscribe", subscriptions).map(ClientOp::Subscribe);
        }
        "unsubscribe" => {
            let example = r#"{"op":"unsubscribe","subscriptionIds":[0]}"#;
            let Unsubscribe { subscription_ids } = rest("unsubscribe", text, example)?;
            return listed("unsubscribe", subscription_ids).map(ClientOp::Unsubscribe);
        }
        "advertise" => {
            let example = r#"{"op":"advertise","channels":[{"id":1,"topic":"/a","encoding":"json","schemaName":"b"}]}"#;
            let Advertise { channels } = rest("advertise", text, example)?;
            let topics = listed("advertise", channels)?.into_iter().map(|channel| shown(&channel.topic)).collect();
            Deed::Advertise { topics }
        }
        "unadvertise" => {
            let Unadvertise { channel_ids } = rest("unadvertise", text, r#"{"op":"unadvertise","channelIds":[1]}"#)?;
            Deed::Unadvertise { channels: listed("unadvertise", channel_ids)? }
        }
        "getParameters" => Deed::GetParameters { names: parameter_names("getParameters", text)? },
        "setParameters" => {
            let example = r#"{"op":"setParameters","parameters":[{"name":"a","value":1}]}"#;
            let SetParameters { parameters } = rest("setParameters", text, example)?;
            let names = listed("setParameters", parameters)?.into_iter().map(|set| shown(&set.name)).collect();
            Deed::SetParameters { names }
        }
        "subscribeParameterUpdates" => {
            Deed::SubscribeParameterUpdates { names: parameter_names("subscribeParameterUpdates", text)? }
        }
        "unsubscribeParameterUpdates" => {
            Deed::UnsubscribeParameterUpdates { names: parameter_names("unsubscribeParameterUpdates", text)? }
        }
        "fetchAsset" => {
            let example = r#"{"op":"fetchAsset","uri":"package://a","requestId":1}"#;
            let FetchAsset { uri, request_id } = rest("fetchAsset", text, example)?;
            Deed::FetchAsset { uri: shown(&uri), request: request_id }
        }
        "subscribeConnectionGraph" => Deed::SubscribeConnectionGraph,
        "unsubscribeConnectionGraph" => Deed::UnsubscribeConnectionGraph,
        other => return Err(BadMessage::Op { found: shown(other) }),
    };
    Ok(ClientOp::Other(deed))
}

/// The rest of a text whose name is known.
fn rest<'a, T: Deserialize<'a>>(op: &'static str, text: &'a str, example: &'static str) -> Result<T, BadMessage> {
    serde_json::from_str(text).map_err(|why| BadMessage::Field { op, why: why.to_string(), example })
}

fn parameter_names(op: &'static str, text: &str) -> Result<Vec<String>, BadMessage> {
    let ParameterNames { parameter_names } = rest(op, text, r#"{"op":…,"parameterNames":["a"]}"#)?;
    Ok(listed(op, parameter_names)?.iter().map(|name| shown(name)).collect())
}

/// A list that is not too long.
fn listed<T>(op: &'static str, list: Vec<T>) -> Result<Vec<T>, BadMessage> {
    let found = list.len();
    if found > SUBSCRIPTIONS { Err(BadMessage::Many { op, found }) } else { Ok(list) }
}

/// The begin of a text that somebody sent.
fn shown(text: &str) -> String {
    text.chars().filter(|c| !c.is_control()).take(SHOWN_CHARS).collect()
}

/// The byte at which a text is nested too deeply. Brackets within quotes are no nesting.
fn too_deep(text: &str) -> Option<usize> {
    let (mut depth, mut quoted, mut escaped) = (0_usize, false, false);
    for (at, byte) in text.bytes().enumerate() {
        match byte {
            _ if escaped => escaped = false,
            b'\\' if quoted => escaped = true,
            b'"' => quoted = !quoted,
            _ if quoted => {}
            b'[' | b'{' => depth += 1,
            b']' | b'}' => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth > JSON_DEPTH {
            return Some(at);
        }
    }
    None
}

/// Bytes that are read from the front.
struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (taken, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*taken)
    }

    fn u8(&mut self) -> Option<u8> {
        self.take().map(u8::from_le_bytes)
    }

    fn u32(&mut self) -> Option<u32> {
        self.take().map(u32::from_le_bytes)
    }
}

fn read_binary(bytes: &[u8]) -> Result<ClientOp, BadMessage> {
    let short = |what, needed: &str| BadMessage::Length { what, found: bytes.len(), needed: needed.to_owned() };
    let mut reader = Reader(bytes);
    match reader.u8() {
        None => Err(short("message", "1 byte at least, which says its kind")),
        Some(1) => {
            let channel = reader.u32().ok_or_else(|| short("message data", "5 at least"))?;
            Ok(ClientOp::Other(Deed::Publish { channel }))
        }
        Some(2) => {
            let ids = reader.u32().zip(reader.u32());
            let (service, call) = ids.ok_or_else(|| short("service call", "13 at least"))?;
            let len = reader.u32().ok_or_else(|| short("service call", "13 at least"))?;
            if (reader.0.len() as u64) < u64::from(len) {
                return Err(short("service call", &format!("13 and the {len} of its encoding")));
            }
            Ok(ClientOp::Other(Deed::CallService { service, call }))
        }
        Some(3) => read_playback(bytes.len(), &mut reader).map(ClientOp::Playback),
        Some(found) => Err(BadMessage::Kind { found }),
    }
}

fn read_playback(found: usize, reader: &mut Reader<'_>) -> Result<PlaybackControl, BadMessage> {
    let what = "playback control";
    let head = (|| {
        let (command, speed) = (reader.u8()?, reader.take().map(f32::from_le_bytes)?);
        Some((command, speed, reader.u8()?, reader.take().map(u64::from_le_bytes)?, reader.u32()?))
    })();
    let (command, speed, has_seek, seek, len) =
        head.ok_or_else(|| BadMessage::Length { what, found, needed: "19 at least".to_owned() })?;
    let play = match command {
        0 => true,
        1 => false,
        other => {
            let allowed = "0 is to play, 1 to stand";
            return Err(BadMessage::Value { field: "command", found: other.to_string(), allowed });
        }
    };
    if len as usize > REQUEST_BYTES {
        let allowed = "at most 256 bytes";
        return Err(BadMessage::Value { field: "request id", found: format!("{len} bytes long"), allowed });
    }
    if reader.0.len() != len as usize {
        return Err(BadMessage::Length { what, found, needed: format!("19 and the {len} of its request id") });
    }
    let request = str::from_utf8(reader.0).map_err(|why| BadMessage::Value {
        field: "request id",
        found: format!("no text: {why}"),
        allowed: "it is UTF-8",
    })?;
    Ok(PlaybackControl { play, speed, seek: (has_seek != 0).then_some(seek), request: request.to_owned() })
}

#[cfg(test)]
mod tests;
