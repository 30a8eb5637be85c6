//! Keys: every name on the bus, relative to the namespace `soc/v1/<ns>`.
//!
//! | key | kind | use |
//! |---|---|---|
//! | `rpc/…` | query, served by the active orchestrator | worker protocol, clients, artifacts |
//! | `hint/<stage>` | put, [`crate::Qos::Hint`] | work exists |
//! | `cmd/<instance>` | put, [`crate::Qos::Control`] | cancel, drain |
//! | `ev/<batch>/<scenario>` | put, [`crate::Qos::Hint`] | numbered notices for viewers |
//! | `live/orch/<id>`, `live/worker/<stage>/<instance>` | presence tokens | hastening |
//! | `live/<run>/{meta,doors,events}` | put and query | a run, its doors and events, in JSON |
//! | `live/<run>/{agents,latest}` | put | every tick of a run; its newest, at most twenty a second |
//! | `live/<run>/{map,ctl}` | query | the map of a run; its ticks, events and agents from a number on |
//! | `serve/run` | query, served by `socrates serve` | the next run of a driver |
//! | `drive/<name>/{mission,step}` | query, served by the driver of this name | a robot, or a person, that is driven from outside |
//! | `drive/<name>/claim/<id>` | presence token | the driver is there, and alone |

use socrates_model::RunId;
use socrates_model::job::Stage;

use crate::error::LinkError;

/// A worker introduces itself: `wire::Hello` → `wire::Welcome`.
pub const HELLO: &str = "rpc/hello";
/// A worker asks for work: `wire::Acquire` → `wire::Acquired`.
pub const ACQUIRE: &str = "rpc/acquire";
/// A worker says that it lives: `wire::Beat` → `wire::BeatReply`.
pub const BEAT: &str = "rpc/beat";
/// A worker reports: `wire::Report` → `wire::Recorded`.
pub const REPORT: &str = "rpc/report";
/// A worker hands back: `wire::Release` → `wire::Recorded`.
pub const RELEASE: &str = "rpc/release";
/// A client submits: `wire::Submit` → `wire::Submitted`.
pub const SUBMIT: &str = "rpc/submit";
/// A client controls: `wire::Control` → `u32`, how many were changed.
pub const CONTROL: &str = "rpc/control";
/// A client asks how things stand: `wire::StatusAsk` → `wire::StatusReply`.
pub const STATUS: &str = "rpc/status";
/// A client asks what became of scenarios: `wire::PastAsk` → `wire::PastPart`.
pub const PAST: &str = "rpc/past";
/// A part of an artifact is fetched: `wire::BlobGet` → `wire::BlobPart`.
pub const BLOB_GET: &str = "rpc/blob_get";
/// A part of an artifact is stored: `wire::BlobPut` → `u64`, bytes held so far.
pub const BLOB_PUT: &str = "rpc/blob_put";

/// Somebody who drives asks `socrates serve` for a run: JSON, see `docs/wire.md`.
pub const SERVE_RUN: &str = "serve/run";

/// Every query key of the orchestrator, in the order in which they are declared.
pub const RPC: [&str; 11] = [HELLO, ACQUIRE, BEAT, REPORT, RELEASE, SUBMIT, CONTROL, STATUS, PAST, BLOB_GET, BLOB_PUT];

/// Presence tokens of every worker.
pub const WORKERS_ALIVE: &str = "live/worker/**";
/// Presence tokens of every orchestrator.
pub const ORCHESTRATORS_ALIVE: &str = "live/orch/*";
/// Notices of every batch.
pub const EVENTS: &str = "ev/**";
/// Announcements of every run.
pub const RUNS: &str = "live/*/meta";

/// Wake hint of a stage.
#[must_use]
pub fn hint(stage: Stage) -> String {
    format!("hint/{stage}")
}

/// Commands for one worker process.
#[must_use]
pub fn command(instance: &str) -> String {
    format!("cmd/{}", chunk(instance))
}

/// Notices about one scenario of a batch.
#[must_use]
pub fn event(batch: &str, scenario: &str) -> String {
    format!("ev/{}/{}", chunk(batch), chunk(scenario))
}

/// Presence token of a worker process.
#[must_use]
pub fn worker_alive(stage: Stage, instance: &str) -> String {
    format!("live/worker/{stage}/{}", chunk(instance))
}

/// Presence token of an orchestrator.
#[must_use]
pub fn orchestrator_alive(id: &str) -> String {
    format!("live/orch/{}", chunk(id))
}

/// Stage and instance named by a worker's presence token; `None` for another key.
#[must_use]
pub fn worker_of(key: &str) -> Option<(Stage, String)> {
    let (stage, instance) = key.strip_prefix("live/worker/")?.split_once('/')?;
    Some((stage.parse().ok()?, instance.to_owned()))
}

/// Everything that is asked of a run: one process serves it.
#[must_use]
pub fn live_served(run: &RunId) -> String {
    format!("live/{}/*", chunk(run.as_str()))
}

/// What is served of a run under a key of [`live_served`], or of all runs at once.
#[must_use]
pub fn live_topic(key: &str) -> Option<&str> {
    let (_, topic) = key.strip_prefix("live/")?.split_once('/')?;
    Some(topic)
}

/// What a run is, how far it is and how it ended.
#[must_use]
pub fn live_meta(run: &RunId) -> String {
    format!("live/{}/meta", chunk(run.as_str()))
}

/// Events of a run as they happen.
#[must_use]
pub fn live_events(run: &RunId) -> String {
    format!("live/{}/events", chunk(run.as_str()))
}

/// The doors of a run whenever one opens or shuts.
#[must_use]
pub fn live_doors(run: &RunId) -> String {
    format!("live/{}/doors", chunk(run.as_str()))
}

/// The map of a run, asked for part by part.
#[must_use]
pub fn live_map(run: &RunId) -> String {
    format!("live/{}/map", chunk(run.as_str()))
}

/// The newest tick of a run, at most twenty a second whatever its pace: for eyes.
#[must_use]
pub fn live_latest(run: &RunId) -> String {
    format!("live/{}/latest", chunk(run.as_str()))
}

/// Every tick of a run: up to ten to a message, or one part of a tick that is larger than a message.
#[must_use]
pub fn live_agents(run: &RunId) -> String {
    format!("live/{}/agents", chunk(run.as_str()))
}

/// Asks a run for ticks and events that were missed.
#[must_use]
pub fn live_ctl(run: &RunId) -> String {
    format!("live/{}/ctl", chunk(run.as_str()))
}

/// The mission, the map and the end of every run of a driver: `driver::MissionMessage`, see `docs/wire.md`.
#[must_use]
pub fn drive_mission(driver: &str) -> String {
    format!("drive/{}/mission", chunk(driver))
}

/// Every step of every run of a driver: `lockstep`, see `docs/wire.md`.
#[must_use]
pub fn drive_step(driver: &str) -> String {
    format!("drive/{}/step", chunk(driver))
}

/// Presence token of a driver process.
#[must_use]
pub fn drive_claim(driver: &str, id: &str) -> String {
    format!("drive/{}/claim/{}", chunk(driver), chunk(id))
}

/// Presence tokens of every process that drives under this name.
#[must_use]
pub fn drive_claims(driver: &str) -> String {
    format!("drive/{}/claim/*", chunk(driver))
}

/// Presence tokens of every driver.
pub const DRIVERS_ALIVE: &str = "drive/*/claim/*";

/// Name of the driver named by its presence token; `None` for another key.
#[must_use]
pub fn driver_of(key: &str) -> Option<&str> {
    key.strip_prefix("drive/")?.split_once("/claim/").map(|(name, _)| name)
}

/// Free text as one chunk of a key: everything that is not a letter, digit, `.`, `_` or `-` becomes `%` and hex digits.
#[must_use]
pub fn chunk(text: &str) -> String {
    if text.is_empty() {
        return "%".to_owned();
    }
    text.bytes()
        .map(|byte| match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'.' | b'_' | b'-' => char::from(byte).to_string(),
            other => format!("%{other:02x}"),
        })
        .collect()
}

/// A namespace: deployments that share a router and must not hear each other have different ones.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Namespace(String);

impl Namespace {
    /// Reads a namespace.
    ///
    /// # Errors
    /// [`LinkError::BadKey`] unless it is 1 to 64 of `a-z A-Z 0-9 . _ -`.
    pub fn new(text: &str) -> Result<Self, LinkError> {
        let fits = |c: char| c.is_ascii_alphanumeric() || matches!(c, '.' | '_' | '-');
        if !text.is_empty() && text.len() <= 64 && text.chars().all(fits) {
            return Ok(Self(format!("soc/v1/{text}/")));
        }
        Err(LinkError::BadKey {
            key: text.chars().take(80).collect(),
            why: "a namespace is 1 to 64 of a-z A-Z 0-9 . _ -".to_owned(),
        })
    }

    /// The whole key of a relative one.
    ///
    /// # Errors
    /// [`LinkError::BadKey`] when the key is not a well-formed key expression.
    pub fn full(&self, key: &str) -> Result<String, LinkError> {
        checked(key)?;
        Ok(format!("{}{key}", self.0))
    }

    /// The relative key of a whole one; a foreign key is given back as it is.
    #[must_use]
    pub fn relative<'k>(&self, full: &'k str) -> &'k str {
        full.strip_prefix(self.0.as_str()).unwrap_or(full)
    }
}

/// The chunks of a key expression, if it is one: chunks between `/`, of which `*` stands for any one and `**` for any number.
/// These are the key expressions of zenoh without its `$*` inside a chunk, so every bus takes the same keys.
///
/// # Errors
/// [`LinkError::BadKey`] for an empty chunk, a sign that has a meaning of its own, or wildcards in another order than `*/**`.
pub(crate) fn checked(key: &str) -> Result<Vec<&str>, LinkError> {
    let chunks: Vec<&str> = key.split('/').collect();
    let bad = |why: &str| Err(LinkError::BadKey { key: key.chars().take(200).collect(), why: why.to_owned() });
    if chunks.iter().any(|chunk| chunk.is_empty()) {
        return bad("it begins or ends with `/`, or has nothing between two; chunks such as `a/b` are allowed");
    }
    let odd = |chunk: &&str| chunk.contains(['#', '?', '$']) || chunk.contains('*') && !matches!(*chunk, "*" | "**");
    if let Some(chunk) = chunks.iter().find(|chunk| odd(chunk)) {
        return bad(&format!("`{chunk}` holds `#`, `?`, `$` or a `*` beside letters; `*` and `**` stand alone"));
    }
    if chunks.windows(2).any(|pair| matches!(pair, ["**", "*" | "**"])) {
        return bad("after `**` comes another wildcard; `*/**` is allowed");
    }
    Ok(chunks)
}

/// Whether a key falls under a key expression (`*` is one chunk, `**` any number).
///
/// # Errors
/// [`LinkError::BadKey`] when either is not well formed.
pub fn covers(expression: &str, key: &str) -> Result<bool, LinkError> {
    Ok(meet(&checked(expression)?, &checked(key)?))
}

/// Whether a key exists that falls under both expressions.
///
/// # Errors
/// [`LinkError::BadKey`] when either is not well formed.
pub(crate) fn meets(a: &str, b: &str) -> Result<bool, LinkError> {
    Ok(meet(&checked(a)?, &checked(b)?))
}

/// Whether a key exists that falls under both.
fn meet(a: &[&str], b: &[&str]) -> bool {
    match (a, b) {
        ([], []) => true,
        (["**", rest @ ..], other) | (other, ["**", rest @ ..]) => {
            // A chunk that begins with `@` is met by its own name alone.
            let most = other.iter().position(|chunk| chunk.starts_with('@')).unwrap_or(other.len());
            (0..=most).any(|taken| other.get(taken..).is_some_and(|left| meet(rest, left)))
        }
        ([], _) | (_, []) => false,
        ([first, rest @ ..], [other, left @ ..]) => one_meets(first, other) && meet(rest, left),
    }
}

/// Whether two chunks, none of them `**`, name a common one.
fn one_meets(a: &str, b: &str) -> bool {
    a == b || a == "*" && !b.starts_with('@') || b == "*" && !a.starts_with('@')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_of_the_table_is_well_formed_and_apart_from_the_others() {
        let run = RunId::new("case-3.reference-1").unwrap();
        let mut all: Vec<String> = RPC.iter().map(|key| (*key).to_owned()).collect();
        all.extend(Stage::WORKERS.map(hint));
        all.extend([command("a b"), event("", "s"), worker_alive(Stage::Paths, "i"), orchestrator_alive("o")]);
        all.extend([live_meta(&run), live_agents(&run), live_ctl(&run)]);
        all.extend([drive_mission("d"), drive_step("d"), drive_claim("d", "1")]);
        for key in &all {
            assert!(checked(key).is_ok(), "{key}");
        }
        let mut apart = all.clone();
        apart.sort();
        apart.dedup();
        assert_eq!(apart.len(), all.len());
    }

    #[test]
    fn a_wildcard_covers_what_it_should_and_nothing_else() {
        assert!(covers(RUNS, "live/a/meta").unwrap());
        assert!(!covers(RUNS, "live/a/agents").unwrap());
        assert!(covers(WORKERS_ALIVE, &worker_alive(Stage::Scoring, "x")).unwrap());
        assert!(covers("a//b", "a").is_err());
    }

    /// The other bus would refuse a key that this one takes, or deliver to others: its own words decide.
    #[cfg(feature = "zenoh")]
    #[test]
    fn keys_are_taken_and_covered_as_zenoh_does() {
        use zenoh::key_expr::keyexpr;
        // All expressions of up to four of these chunks.
        let chunks = ["a", "b", "*", "**", "", "a*", "@v", "#"];
        let mut all = vec![String::new()];
        for chunk in chunks {
            all.push(chunk.to_owned());
        }
        for _longer in 0..3 {
            let longer: Vec<String> =
                all.iter().flat_map(|begin| chunks.iter().map(move |chunk| format!("{begin}/{chunk}"))).collect();
            all.extend(longer);
            all.sort();
            all.dedup();
        }
        let mut good = Vec::new();
        for text in &all {
            let theirs = keyexpr::new(text.as_str());
            assert_eq!(checked(text).is_ok(), theirs.is_ok(), "`{text}`: {:?} {theirs:?}", checked(text));
            good.extend(theirs.ok());
        }
        assert!(good.len() > 300, "{}", good.len());
        for (place, a) in good.iter().enumerate() {
            for b in good.iter().skip(place % 7).step_by(7) {
                assert_eq!(covers(a, b).unwrap(), a.intersects(b), "`{a}` and `{b}`");
            }
        }
    }

    #[test]
    fn a_namespace_is_put_in_front_and_taken_off_again() {
        let ns = Namespace::new("lab-1").unwrap();
        let full = ns.full(ACQUIRE).unwrap();
        assert_eq!(full, "soc/v1/lab-1/rpc/acquire");
        assert_eq!(ns.relative(&full), ACQUIRE);
        for bad in ["", "a/b", "a*", "ä"] {
            assert!(Namespace::new(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn a_presence_token_names_its_driver() {
        assert_eq!(driver_of(&drive_claim("mine", "7")), Some("mine"));
        assert!(covers(DRIVERS_ALIVE, &drive_claim("mine", "7")).unwrap());
        assert_eq!(driver_of("drive/mine/step"), None);
    }

    #[test]
    fn a_presence_token_names_its_worker() {
        let key = worker_alive(Stage::Simulation, "9f");
        assert_eq!(worker_of(&key), Some((Stage::Simulation, "9f".to_owned())));
        assert_eq!(worker_of("live/orch/x"), None);
    }
}
