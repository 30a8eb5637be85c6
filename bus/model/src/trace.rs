//! Where a message belongs in the making of a scenario: the `traceparent` of W3C Trace Context.
//!
//! ```text
//! trace (a scenario of a batch) ─► span of a job ─► span of each of its attempts
//! ```
//!
//! Nothing is drawn: all of it follows from names, so that a repeated step and another process come to the same ids.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Deserializer, Serialize};

use crate::hash::Digest;
use crate::ids::{BadId, ScenarioId};
use crate::job::JobKey;

/// A place in a trace. As text it is a `traceparent`: version, trace, span and flags, `00-<32 hex>-<16 hex>-01`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct TraceContext {
    trace: u128,
    span: u64,
}

impl TraceContext {
    /// The span of a scenario, from which its trace is named: batch, name, content address of the request, base seed. The same
    /// scenario made again, as somebody else or elsewhere, has the same trace.
    #[must_use]
    pub fn of_scenario(batch: &str, scenario: &ScenarioId, request: &Digest, seed: u64) -> Self {
        let named = Digest::of(format!("socrates/trace/1|{batch}|{scenario}|{request}|{seed}").as_bytes());
        let trace = named.bytes().iter().take(16).fold(0_u128, |all, byte| (all << 8) | u128::from(*byte));
        // No id is all zeros.
        Self { trace: trace.max(1), span: 0 }.spanning(scenario.as_str())
    }

    /// The span of a job in the trace of its scenario.
    #[must_use]
    pub fn of_job(self, job: &JobKey) -> Self {
        self.spanning(&job.to_string())
    }

    /// The span of an attempt in the trace of its scenario: another one for each, so that repeated attempts stand side by side.
    #[must_use]
    pub fn of_attempt(self, job: &JobKey, attempt: u32) -> Self {
        self.spanning(&format!("{job}#{attempt}"))
    }

    fn spanning(self, name: &str) -> Self {
        let span = Digest::of(format!("{:032x}|{name}", self.trace).as_bytes()).seed();
        Self { span: span.max(1), ..self }
    }

    /// Id of the trace, 32 hex digits: what every line about a scenario has in common.
    #[must_use]
    pub fn trace_id(&self) -> String {
        format!("{:032x}", self.trace)
    }

    /// Id of the span, 16 hex digits.
    #[must_use]
    pub fn span_id(&self) -> String {
        format!("{:016x}", self.span)
    }
}

impl fmt::Display for TraceContext {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Sampled: a process that writes lines at all writes these.
        write!(f, "00-{:032x}-{:016x}-01", self.trace, self.span)
    }
}

impl FromStr for TraceContext {
    type Err = BadId;

    /// Later versions may append parts; they are passed over, as the recommendation asks.
    fn from_str(text: &str) -> Result<Self, BadId> {
        let bad = || BadId {
            what: "traceparent",
            found: text.chars().take(80).collect(),
            allowed: "00-<32 hex digits>-<16 hex digits>-<2 hex digits>",
        };
        let is_hex = |part: &str, len: usize| {
            part.len() == len && part.bytes().all(|byte| byte.is_ascii_digit() || (b'a'..=b'f').contains(&byte))
        };
        let parts: Vec<&str> = text.split('-').collect();
        let [version, trace, span, flags, further @ ..] = parts.as_slice() else { return Err(bad()) };
        let fits = is_hex(version, 2) && is_hex(trace, 32) && is_hex(span, 16) && is_hex(flags, 2);
        if !fits || *version == "ff" || (*version == "00" && !further.is_empty()) {
            return Err(bad());
        }
        let trace = u128::from_str_radix(trace, 16).map_err(|_digits| bad())?;
        let span = u64::from_str_radix(span, 16).map_err(|_digits| bad())?;
        if trace == 0 || span == 0 { Err(bad()) } else { Ok(Self { trace, span }) }
    }
}

impl TryFrom<String> for TraceContext {
    type Error = BadId;
    fn try_from(text: String) -> Result<Self, BadId> {
        text.parse()
    }
}

impl From<TraceContext> for String {
    fn from(trace: TraceContext) -> Self {
        trace.to_string()
    }
}

/// Reads what a message says of its trace. What is no `traceparent` counts as none: no message is lost for it.
///
/// # Errors
/// What stands there is no text.
pub fn lenient<'de, D: Deserializer<'de>>(input: D) -> Result<Option<TraceContext>, D::Error> {
    let text = Option::<String>::deserialize(input)?;
    Ok(text.and_then(|text| text.parse().ok()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::{Item, Stage};

    fn job(stage: Stage) -> JobKey {
        JobKey { scenario: ScenarioId::new("hall-1").unwrap(), stage, item: Item::Whole, revision: 0 }
    }

    fn scenario(batch: &str, seed: u64) -> TraceContext {
        TraceContext::of_scenario(batch, &ScenarioId::new("hall-1").unwrap(), &Digest::of(b"request"), seed)
    }

    #[test]
    fn a_scenario_has_one_trace_and_each_attempt_a_span_of_its_own() {
        let trace = scenario("night", 1);
        assert_eq!(trace, scenario("night", 1));
        assert!(
            trace.trace_id() != scenario("night", 2).trace_id() && trace.trace_id() != scenario("day", 1).trace_id()
        );
        let paths = job(Stage::Paths);
        let spans = [
            trace,
            trace.of_job(&paths),
            trace.of_job(&job(Stage::Behaviors)),
            trace.of_attempt(&paths, 1),
            trace.of_attempt(&paths, 2),
        ];
        assert!(spans.iter().all(|span| span.trace_id() == trace.trace_id()));
        let ids: std::collections::BTreeSet<String> = spans.iter().map(TraceContext::span_id).collect();
        assert_eq!(ids.len(), spans.len());
        // From any span of a trace the same further ones follow: a process needs to be told one of them alone.
        assert_eq!(trace.of_attempt(&paths, 1), trace.of_job(&paths).of_attempt(&paths, 1));
    }

    #[test]
    fn it_is_written_and_read_as_w3c_says() {
        let trace = scenario("night", 1).of_attempt(&job(Stage::Paths), 1);
        assert_eq!(trace.to_string().parse::<TraceContext>().unwrap(), trace);
        let theirs = "00-4bf92f3577b34da6a3ce929d0e0e4736-00f067aa0ba902b7-01";
        let read: TraceContext = theirs.parse().unwrap();
        assert_eq!((read.to_string().as_str(), read.span_id().as_str()), (theirs, "00f067aa0ba902b7"));
        let later = "01-4bf92f3577b34da6a3ce929d0e0e4736-00f067aa0ba902b7-00-more";
        assert_eq!(later.parse::<TraceContext>().unwrap(), read);
        for bad in [
            "",
            "00-4bf92f3577b34da6a3ce929d0e0e4736-00f067aa0ba902b7",
            "00-4BF92F3577B34DA6A3CE929D0E0E4736-00f067aa0ba902b7-01",
            "00-00000000000000000000000000000000-00f067aa0ba902b7-01",
            "00-4bf92f3577b34da6a3ce929d0e0e4736-0000000000000000-01",
            "ff-4bf92f3577b34da6a3ce929d0e0e4736-00f067aa0ba902b7-01",
            "00-4bf92f3577b34da6a3ce929d0e0e4736-00f067aa0ba902b7-01-more",
            "00-+bf92f3577b34da6a3ce929d0e0e4736-00f067aa0ba902b7-01",
        ] {
            assert!(bad.parse::<TraceContext>().is_err(), "{bad}");
        }
    }
}
