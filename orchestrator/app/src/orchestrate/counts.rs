//! What the shell counts beside the state machine: commits, questions and answers, artifacts. Of this start; nothing is decided by it.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use socrates_kit::BlobMove;
use socrates_link::keys;
use socrates_orchestrator::tally::Histogram;

/// Upper ends of the ranges of times of commits and answers, µs.
const TIMES_US: &[u64] =
    &[100, 250, 500, 1_000, 2_500, 5_000, 10_000, 25_000, 50_000, 100_000, 250_000, 1_000_000, 5_000_000];
/// Upper ends of the ranges of steps in a commit.
const COMMIT_STEPS: &[u64] = &[1, 2, 4, 8, 16, 32, 64, 128, 256];

/// Keys that are served, with the name that each has in figures.
const METHODS: [(&str, &str); 11] = [
    (keys::HELLO, "hello"),
    (keys::ACQUIRE, "acquire"),
    (keys::BEAT, "beat"),
    (keys::REPORT, "report"),
    (keys::RELEASE, "release"),
    (keys::SUBMIT, "submit"),
    (keys::CONTROL, "control"),
    (keys::STATUS, "status"),
    (keys::PAST, "past"),
    (keys::BLOB_GET, "blob_get"),
    (keys::BLOB_PUT, "blob_put"),
];

/// Why a question had another answer than it was asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Refusal {
    /// It could not be read, or is of a version that is not understood.
    Unreadable,
    /// It was said no to.
    Refused,
    /// It has to be asked again later.
    Busy,
}

impl Refusal {
    pub(super) const ALL: [Self; 3] = [Self::Unreadable, Self::Refused, Self::Busy];

    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Unreadable => "unreadable",
            Self::Refused => "refused",
            Self::Busy => "busy",
        }
    }
}

/// Bytes and number of artifacts that went one way.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Moved {
    pub(super) bytes: u64,
    pub(super) whole: u64,
}

/// Everything that is counted.
#[derive(Debug, Clone)]
pub(super) struct Counted {
    /// Times of commits, µs.
    pub(super) commit_us: Histogram,
    /// Steps that a commit took together.
    pub(super) commit_steps: Histogram,
    /// Times from a question to its answer by method, µs.
    pub(super) answers_us: BTreeMap<&'static str, Histogram>,
    /// Questions that were refused, by method and reason.
    pub(super) refusals: BTreeMap<(&'static str, Refusal), u64>,
    /// Artifacts that came in over the bus.
    pub(super) put: Moved,
    /// Artifacts that went out over the bus.
    pub(super) got: Moved,
}

/// The same, shared by the tasks of an orchestrator.
#[derive(Debug, Clone)]
pub(super) struct Counts(Arc<Mutex<Counted>>);

/// The name of a served key in figures.
fn method(key: &str) -> &'static str {
    METHODS.into_iter().find(|(known, _)| *known == key).map_or("other", |(_, name)| name)
}

impl Counts {
    pub(super) fn new() -> Self {
        // What did not happen yet is 0, so that its first time is seen as a change.
        let methods = || METHODS.into_iter().map(|(_, name)| name);
        let refusals = methods().flat_map(|name| Refusal::ALL.map(|why| ((name, why), 0))).collect();
        Self(Arc::new(Mutex::new(Counted {
            commit_us: Histogram::new(TIMES_US),
            commit_steps: Histogram::new(COMMIT_STEPS),
            answers_us: methods().map(|name| (name, Histogram::new(TIMES_US))).collect(),
            refusals,
            put: Moved::default(),
            got: Moved::default(),
        })))
    }

    fn counted(&self) -> MutexGuard<'_, Counted> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// How things stand now.
    pub(super) fn now(&self) -> Counted {
        self.counted().clone()
    }

    /// A commit of this number of steps took this long.
    pub(super) fn committed(&self, took: Duration, steps: usize) {
        let mut counted = self.counted();
        counted.commit_us.add(micros(took));
        counted.commit_steps.add(u64::try_from(steps).unwrap_or(u64::MAX));
    }

    /// A question on a key had its answer after this time.
    pub(super) fn answered(&self, key: &str, took: Duration) {
        let method = method(key);
        let mut counted = self.counted();
        counted.answers_us.entry(method).or_insert_with(|| Histogram::new(TIMES_US)).add(micros(took));
    }

    /// The answer was a refusal.
    pub(super) fn refused(&self, key: &str, why: Refusal) {
        *self.counted().refusals.entry((method(key), why)).or_default() += 1;
    }

    /// A part of an artifact went over the bus.
    pub(super) fn moved(&self, part: BlobMove) {
        let key = if part.put { keys::BLOB_PUT } else { keys::BLOB_GET };
        self.answered(key, part.took);
        if part.refused {
            self.refused(key, Refusal::Refused);
        }
        let mut counted = self.counted();
        let sum = if part.put { &mut counted.put } else { &mut counted.got };
        sum.bytes = sum.bytes.saturating_add(part.bytes);
        sum.whole += u64::from(part.whole);
    }
}

fn micros(took: Duration) -> u64 {
    u64::try_from(took.as_micros()).unwrap_or(u64::MAX)
}
