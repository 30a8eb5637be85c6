//! The envelope round every control message, and the one place where it is written and read.
//!
//! MessagePack maps with named fields: unknown fields are skipped and new ones have defaults, so that
//! neighbors one version apart understand each other. Frames never come here; they are plain records.

use serde::de::{DeserializeOwned, IgnoredAny};
use serde::{Deserialize, Serialize};
use socrates_model::TraceContext;
use socrates_model::job::MESSAGE_BYTES;

use crate::error::LinkError;

/// Version of the messages written here. Since 2, the ticks of a live run come several to a message; since 3, the run
/// of a job stands in its key alone.
pub const VERSION: u32 = 3;
/// Oldest reader of a message with grants: an older one would take every run for that of the reference planner.
pub const GRANTS_VERSION: u32 = 3;
/// Oldest version read here.
pub const MIN_VERSION: u32 = 1;
/// Deepest nesting that is read: far more than any message has, far less than a stack holds.
const MAX_DEPTH: usize = 32;

/// One start of an orchestrator on one job store: a random number. The store lists those of its starts, so that an orchestrator
/// tells workers of its own past from workers that served another store, or a later state of a store that was restored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct ReignId(pub u64);

impl ReignId {
    /// A number that no other start has.
    #[must_use]
    pub fn fresh() -> Self {
        Self(uuid::Uuid::new_v4().as_u64_pair().0)
    }
}

/// A message with what is needed to tell where it comes from and whether it can be read.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Envelope<T> {
    /// Version of the writer.
    pub v: u32,
    /// Oldest reader the writer allows.
    #[serde(default)]
    pub min_v: u32,
    /// What the body is, such as `acquire`.
    pub kind: String,
    /// Unique id, UUID v7; for logs.
    #[serde(default)]
    pub msg_id: String,
    /// Name of the writer.
    #[serde(default)]
    pub sender: String,
    /// Reign of the orchestrator that wrote it; 0 from anybody else.
    #[serde(default)]
    pub epoch: u64,
    /// Reign of the orchestrator that wrote it, or the one that the worker who wrote it serves; none from clients, and from
    /// programs that know no such field.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reign: Option<ReignId>,
    /// Wall time of the writer, ms since 1970; shown, never decides.
    #[serde(default)]
    pub sent_ms: u64,
    /// Where the message belongs in the trace of a scenario, for logs; none where it is of no job. Older readers pass over it.
    #[serde(default, deserialize_with = "socrates_model::trace::lenient", skip_serializing_if = "Option::is_none")]
    pub traceparent: Option<TraceContext>,
    /// The message.
    pub body: T,
}

impl<T> Envelope<T> {
    /// The same for readers of this version and newer ones: an older one would take it for something else.
    #[must_use]
    pub fn for_readers_of(self, version: u32) -> Self {
        Self { min_v: version, ..self }
    }

    /// The same as a part of this trace.
    #[must_use]
    pub fn in_trace(self, traceparent: Option<TraceContext>) -> Self {
        Self { traceparent, ..self }
    }

    /// The same as written in, or for, this reign.
    #[must_use]
    pub fn in_reign(self, reign: Option<ReignId>) -> Self {
        Self { reign, ..self }
    }

    /// An envelope of this version with a fresh id; its time is the id's own.
    #[must_use]
    pub fn fresh(kind: &str, sender: &str, epoch: u64, body: T) -> Self {
        let id = uuid::Uuid::now_v7();
        let sent_ms = wall_ms_of(&id);
        Self {
            v: VERSION,
            min_v: MIN_VERSION,
            kind: kind.to_owned(),
            msg_id: id.to_string(),
            sender: sender.to_owned(),
            epoch,
            reign: None,
            sent_ms,
            traceparent: None,
            body,
        }
    }
}

/// The wall time now, ms since 1970: shown, never decides.
#[must_use]
pub fn wall_ms() -> u64 {
    wall_ms_of(&uuid::Uuid::now_v7())
}

/// The wall time of an id, ms since 1970.
fn wall_ms_of(id: &uuid::Uuid) -> u64 {
    id.get_timestamp().map_or(0, |stamp| {
        let (secs, nanos) = stamp.to_unix();
        secs.saturating_mul(1000).saturating_add(u64::from(nanos) / 1_000_000)
    })
}

/// Writes a message.
///
/// # Errors
/// [`LinkError::TooLarge`] above 64 KiB, [`LinkError::Encode`] when the body cannot be written.
pub fn encode<T: Serialize>(message: &Envelope<T>) -> Result<Vec<u8>, LinkError> {
    let bytes = rmp_serde::to_vec_named(message)
        .map_err(|why| LinkError::Encode { kind: message.kind.clone(), why: why.to_string() })?;
    fits(&message.kind, bytes)
}

/// The bytes, if the bus carries so many.
pub(crate) fn fits(key: &str, bytes: Vec<u8>) -> Result<Vec<u8>, LinkError> {
    if bytes.len() > MESSAGE_BYTES {
        return Err(LinkError::TooLarge { key: key.to_owned(), len: bytes.len(), cap: MESSAGE_BYTES });
    }
    Ok(bytes)
}

/// Reads a message of this kind.
///
/// # Errors
/// [`LinkError::Incompatible`] for another version, [`LinkError::Refused`] when the other side said no,
/// [`LinkError::OtherReign`] when it is an orchestrator that never knew the reign of the question,
/// [`LinkError::Decode`] for anything else that is not such a message.
pub fn decode<T: DeserializeOwned>(kind: &str, bytes: &[u8]) -> Result<Envelope<T>, LinkError> {
    if bytes.len() > MESSAGE_BYTES {
        return Err(LinkError::TooLarge { key: kind.to_owned(), len: bytes.len(), cap: MESSAGE_BYTES });
    }
    let head: Envelope<IgnoredAny> = read(kind, bytes)?;
    if head.v < MIN_VERSION || head.min_v > VERSION {
        return Err(LinkError::Incompatible { found: head.v, needs: head.min_v, low: MIN_VERSION, high: VERSION });
    }
    if head.kind == crate::call::KIND_REFUSED && kind != crate::call::KIND_REFUSED {
        let refusal: Envelope<crate::call::Refusal> = read(kind, bytes)?;
        return Err(LinkError::Refused { key: kind.to_owned(), why: refusal.body.why });
    }
    if head.kind == crate::call::KIND_OTHER_REIGN {
        return Err(LinkError::OtherReign { key: kind.to_owned() });
    }
    if head.kind != kind {
        let why = format!("it is of kind `{}`", head.kind.chars().take(80).collect::<String>());
        return Err(LinkError::Decode { kind: kind.to_owned(), len: bytes.len(), why });
    }
    read(kind, bytes)
}

fn read<T: DeserializeOwned>(kind: &str, bytes: &[u8]) -> Result<T, LinkError> {
    let mut reader = rmp_serde::Deserializer::from_read_ref(bytes);
    reader.set_max_depth(MAX_DEPTH);
    T::deserialize(&mut reader).map_err(|why| LinkError::Decode {
        kind: kind.to_owned(),
        len: bytes.len(),
        why: why.to_string(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use socrates_model::job::Stage;
    use socrates_model::wire::Acquire;

    fn sample() -> Envelope<Acquire> {
        Envelope {
            v: 1,
            min_v: 1,
            kind: "acquire".into(),
            msg_id: "m".into(),
            sender: "w".into(),
            epoch: 3,
            reign: None,
            sent_ms: 1000,
            traceparent: None,
            body: Acquire {
                req_id: "r1".into(),
                instance: "i1".into(),
                stages: vec![Stage::Paths],
                credits: 2,
                code_version: "0.1.0".into(),
            },
        }
    }

    /// The bytes of version 1, which every later version must read.
    const GOLDEN_V1: &str = include_str!("../tests/acquire.v1.hex");

    fn hex(bytes: &[u8]) -> String {
        bytes.iter().map(|byte| format!("{byte:02x}")).collect()
    }

    fn unhex(text: &str) -> Vec<u8> {
        let digits = text.trim();
        (0..digits.len()).step_by(2).map(|at| u8::from_str_radix(&digits[at..at + 2], 16).unwrap()).collect()
    }

    #[test]
    fn the_bytes_of_version_1_are_written_and_read_as_ever() {
        assert_eq!(hex(&encode(&sample()).unwrap()), GOLDEN_V1.trim());
        assert_eq!(decode::<Acquire>("acquire", &unhex(GOLDEN_V1)).unwrap(), sample());
    }

    #[test]
    fn a_newer_neighbors_unknown_field_is_skipped_and_a_missing_one_has_its_default() {
        #[derive(Serialize)]
        struct Newer<'a> {
            v: u32,
            kind: &'a str,
            body: u32,
            color: Vec<(u8, &'a str)>,
        }
        let bytes = rmp_serde::to_vec_named(&Newer { v: 1, kind: "n", body: 7, color: vec![(1, "x")] }).unwrap();
        let read = decode::<u32>("n", &bytes).unwrap();
        assert_eq!((read.body, read.epoch, read.sender.as_str()), (7, 0, ""));
    }

    #[test]
    fn a_trace_travels_and_what_is_none_costs_no_message() {
        let parent: TraceContext = "00-4bf92f3577b34da6a3ce929d0e0e4736-00f067aa0ba902b7-01".parse().unwrap();
        let traced = sample().in_trace(Some(parent));
        let bytes = encode(&traced).unwrap();
        assert_eq!(decode::<Acquire>("acquire", &bytes).unwrap(), traced);
        // A reader of before has no such field.
        #[derive(serde::Deserialize)]
        struct Before {
            body: Acquire,
        }
        assert_eq!(rmp_serde::from_slice::<Before>(&bytes).unwrap().body, sample().body);
        #[derive(Serialize)]
        struct Strange {
            v: u32,
            kind: &'static str,
            traceparent: &'static str,
            body: u32,
        }
        let strange = Strange { v: 3, kind: "n", traceparent: "of another kind", body: 7 };
        let read = decode::<u32>("n", &rmp_serde::to_vec_named(&strange).unwrap()).unwrap();
        assert_eq!((read.body, read.traceparent), (7, None));
    }

    #[test]
    fn a_reign_travels_and_what_is_none_costs_no_message() {
        let of_reign = sample().in_reign(Some(ReignId(u64::MAX)));
        let bytes = encode(&of_reign).unwrap();
        assert_eq!(decode::<Acquire>("acquire", &bytes).unwrap(), of_reign);
        assert_eq!(hex(&encode(&sample().in_reign(None)).unwrap()), GOLDEN_V1.trim());
        assert_ne!(ReignId::fresh(), ReignId::fresh());
    }

    #[test]
    fn a_fault_travels_with_its_place_and_one_of_the_version_before_is_read() {
        use socrates_model::{AgentId, Fault, FaultCode, Where};
        #[derive(Serialize)]
        struct Before {
            code: &'static str,
            at: &'static str,
            message: &'static str,
        }
        let fault = Fault::new(FaultCode::GDisc, Where::agent(AgentId::Robot).step(3), "jumps");
        let bytes = encode(&Envelope::fresh("f", "", 0, fault.clone())).unwrap();
        assert_eq!(decode::<Fault>("f", &bytes).unwrap().body, fault);
        let before = Before { code: "G-DISC", at: "robot step 3", message: "jumps" };
        let bytes = encode(&Envelope::fresh("f", "", 0, before)).unwrap();
        let read = decode::<Fault>("f", &bytes).unwrap().body;
        assert_eq!((read.to_string(), read.at), (fault.to_string(), Where::key("robot step 3")));
    }

    #[test]
    fn a_reply_with_a_table_and_reasons_travels() {
        use socrates_model::JobState;
        use socrates_model::wire::{JobAsk, JobWhy, Part, StageStatus, StatusReply, Table, Wait};
        let ask: JobAsk = "s-1/simulation/reference-1/r2".parse().unwrap();
        let key = socrates_model::job::JobKey {
            scenario: ask.scenario.clone(),
            stage: Stage::Simulation,
            item: ask.item.clone().unwrap(),
            revision: 2,
        };
        let why = vec![Wait::NoWorker, Wait::Paused(Part::Stage(Stage::Paths)), Wait::Twin(key.clone())];
        let stage = StageStatus {
            stage: Stage::Paths,
            states: [(JobState::Ready, 2), (JobState::Dead, 1)].into(),
            paused: true,
            p50_ms: Some(5),
            waited_ms: None,
        };
        let reply = StatusReply {
            whys: Some(vec![JobWhy { key, state: JobState::Ready, why }]),
            table: Some(Table { epoch: 2, stages: vec![stage], ..Table::default() }),
            ..StatusReply::default()
        };
        let bytes = encode(&Envelope::fresh("status", "", 0, reply.clone())).unwrap();
        assert_eq!(decode::<StatusReply>("status", &bytes).unwrap().body, reply);
        let bytes = encode(&Envelope::fresh("ask", "", 0, ask.clone())).unwrap();
        assert_eq!(decode::<JobAsk>("ask", &bytes).unwrap().body, ask);
    }

    #[test]
    fn a_message_that_needs_a_newer_reader_is_refused_by_version() {
        let bytes = encode(&Envelope { v: 9, min_v: 9, ..sample() }).unwrap();
        assert!(matches!(decode::<Acquire>("acquire", &bytes), Err(LinkError::Incompatible { found: 9, .. })));
    }

    #[test]
    fn a_message_above_the_cap_is_a_permanent_error() {
        let big = Envelope::fresh("x", "", 0, "y".repeat(MESSAGE_BYTES));
        let error = encode(&big).unwrap_err();
        assert!(matches!(error, LinkError::TooLarge { .. }));
        assert!(!error.is_transient());
    }

    #[test]
    fn any_bytes_give_an_error_and_never_a_panic() {
        let good = encode(&sample()).unwrap();
        for cut in 0..good.len() {
            assert!(decode::<Acquire>("acquire", &good[..cut]).is_err());
        }
        for at in 0..good.len() {
            for flip in [0x01_u8, 0x80, 0xff] {
                let mut bad = good.clone();
                bad[at] ^= flip;
                let _either = decode::<Acquire>("acquire", &bad);
            }
        }
        assert!(decode::<Acquire>("acquire", &vec![0x91; 4000]).is_err());
        assert!(decode::<Acquire>("beat", &good).is_err());
    }

    #[test]
    fn a_fresh_envelope_carries_the_time_of_its_id() {
        let fresh = Envelope::fresh("x", "me", 0, 1_u32);
        assert!(fresh.sent_ms > 1_600_000_000_000, "{}", fresh.sent_ms);
        assert_eq!(fresh.msg_id.len(), 36);
    }
}
