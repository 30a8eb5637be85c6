//! Typed calls on top of any bus.

use std::time::Duration;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use socrates_model::TraceContext;

use crate::bus::Bus;
use crate::envelope::{Envelope, ReignId, decode, encode};
use crate::error::LinkError;

/// Kind of a reply that says no.
pub const KIND_REFUSED: &str = "refused";

/// Kind of a reply to a worker of a reign that is none of the orchestrator's own past.
pub const KIND_OTHER_REIGN: &str = "other_reign";

/// Body of a reply that says no.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Refusal {
    /// Why, in a sentence.
    pub why: String,
}

/// Asks with a message and gives the body of the reply, which has the same kind.
///
/// # Errors
/// As [`Bus::query`], [`encode`] and [`decode`]; [`LinkError::Refused`] when the other side said no.
pub async fn call<Req: Serialize + Sync, Rep: DeserializeOwned>(
    bus: &dyn Bus,
    key: &str,
    kind: &str,
    request: &Req,
    timeout: Duration,
) -> Result<Rep, LinkError> {
    Ok(call_envelope(bus, key, kind, request, (None, None), timeout).await?.body)
}

/// As [`call`], as a part of a trace and for the orchestrator of a reign, with the whole envelope of the reply: its reign tells a
/// stale orchestrator.
///
/// # Errors
/// As [`call`]; [`LinkError::OtherReign`] when the orchestrator never knew the reign.
pub async fn call_envelope<Req: Serialize + Sync, Rep: DeserializeOwned>(
    bus: &dyn Bus,
    key: &str,
    kind: &str,
    request: &Req,
    (trace, reign): (Option<TraceContext>, Option<ReignId>),
    timeout: Duration,
) -> Result<Envelope<Rep>, LinkError> {
    let body = encode(&Envelope::fresh(kind, bus.name(), 0, request).in_trace(trace).in_reign(reign))?;
    let reply = bus.query(key, body, timeout).await?;
    decode(kind, &reply)
}
