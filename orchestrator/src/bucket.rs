//! Rates of the authors' servers, shared by every worker: who asks when is decided where the jobs are handed out.
//!
//! ```text
//! report: what the server said is left ─┐
//! grant:  what a question takes, about ─┴─► level ── refilled by the minute ──► go on, or from when
//! ```
//!
//! A bucket knows the limits that a server names with its answers, and those of the configuration. Without either it holds
//! nobody back until the server asks for a pause.

use std::collections::BTreeMap;

use socrates_model::AuthorSpec;
use socrates_model::job::{JobSpec, Stage};
use socrates_model::wire::{Rate, Rates};

use crate::pipeline;
use crate::policy::Policy;
use crate::state::Millis;

/// Milliseconds of a minute.
const MINUTE: u64 = 60_000;
/// Tokens that a question and its answer take before any was seen: a usual scenario's third part.
const TYPICAL_TOKENS: u64 = 3_000;

/// One rate with its level.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Gauge {
    /// The most there can be.
    limit: u64,
    /// What flows in by the minute.
    per_minute: u64,
    /// What there was at `since`.
    level: u64,
    since: Millis,
}

impl Gauge {
    const fn full(limit: u64, now: Millis) -> Self {
        Self { limit, per_minute: limit, level: limit, since: now }
    }

    /// As the server says. Where it says when everything will be there again, that is how fast it flows.
    fn said(rate: Rate, now: Millis) -> Self {
        let missing = rate.limit.saturating_sub(rate.left);
        let flow = rate.whole_in_ms.filter(|ms| *ms > 0 && missing > 0);
        let per_minute = flow.map_or(rate.limit, |ms| missing.saturating_mul(MINUTE) / ms);
        Self { limit: rate.limit, per_minute: per_minute.max(1), level: rate.left.min(rate.limit), since: now }
    }

    fn at(&self, now: Millis) -> u64 {
        let flown = self.per_minute.saturating_mul(now.saturating_sub(self.since)) / MINUTE;
        self.level.saturating_add(flown).min(self.limit)
    }

    fn take(&mut self, now: Millis, amount: u64) {
        (self.level, self.since) = (self.at(now).saturating_sub(amount), now);
    }

    /// From when on there is so much more than `taken`. Who wants more than there can ever be waits until it is full.
    fn from(&self, now: Millis, taken: u64, amount: u64) -> Millis {
        let missing = taken.saturating_add(amount.min(self.limit)).saturating_sub(self.at(now));
        now.saturating_add(missing.saturating_mul(MINUTE).div_ceil(self.per_minute.max(1)))
    }
}

/// What is known of one server.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Bucket {
    tokens: Option<Gauge>,
    requests: Option<Gauge>,
    /// Nothing is asked before this time: the server wanted a pause.
    pause_until: Millis,
    /// Tokens of a question and its answer, as they were of late.
    typical: BTreeMap<Stage, u64>,
}

impl Bucket {
    /// A full one with the limits of the configuration.
    #[must_use]
    pub fn new(policy: &Policy, now: Millis) -> Self {
        let gauge = |limit: u64| (limit > 0).then(|| Gauge::full(limit, now));
        Self {
            tokens: gauge(policy.tokens_per_minute),
            requests: gauge(policy.requests_per_minute),
            pause_until: 0,
            typical: BTreeMap::new(),
        }
    }

    /// Tokens that a question of this stage is expected to take, its answer included.
    #[must_use]
    pub fn typical(&self, stage: Stage) -> u64 {
        self.typical.get(&stage).copied().unwrap_or(TYPICAL_TOKENS)
    }

    /// From when on a question with so many tokens may be asked, after others (their number and tokens) that are about to be;
    /// `now` where it may be at once.
    #[must_use]
    pub fn from(&self, now: Millis, others: (u64, u64), tokens: u64) -> Millis {
        let by_tokens = self.tokens.map_or(now, |gauge| gauge.from(now, others.1, tokens));
        let by_requests = self.requests.map_or(now, |gauge| gauge.from(now, others.0, 1));
        by_tokens.max(by_requests).max(self.pause_until)
    }

    /// A question of this stage is asked.
    pub fn take(&mut self, now: Millis, stage: Stage) {
        let tokens = self.typical(stage);
        if let Some(gauge) = &mut self.tokens {
            gauge.take(now, tokens);
        }
        if let Some(gauge) = &mut self.requests {
            gauge.take(now, 1);
        }
    }

    /// A question of this stage was answered, with so many tokens in all and these words of the server on its rates.
    pub fn answered(&mut self, policy: &Policy, now: Millis, stage: Stage, tokens: u64, rates: Option<Rates>) {
        let expected = self.typical(stage);
        if tokens > 0 {
            let before = self.typical.get(&stage).copied();
            // Three parts habit, one part news; the first is believed as it is.
            let typical = before.map_or(tokens, |before| (before.saturating_mul(3).saturating_add(tokens)) / 4);
            self.typical.insert(stage, typical.max(1));
        }
        // What our own limit allows is counted here: what was thought too much comes back, what was too little goes.
        if let Some(gauge) = &mut self.tokens {
            gauge.level = gauge.at(now).saturating_add(expected).saturating_sub(tokens).min(gauge.limit);
            gauge.since = now;
        }
        let newer = |own: Option<Gauge>, said: Option<Rate>, most: u64| {
            let said = said.filter(|rate| rate.limit > 0 && (most == 0 || rate.limit <= most));
            said.map(|rate| Gauge::said(rate, now)).or(own)
        };
        let rates = rates.unwrap_or_default();
        self.tokens = newer(self.tokens, rates.tokens, policy.tokens_per_minute);
        self.requests = newer(self.requests, rates.requests, policy.requests_per_minute);
    }

    /// The server wants a pause.
    pub fn pause(&mut self, until: Millis) {
        self.pause_until = self.pause_until.max(until);
    }
}

/// The server that a job's author asks, with its model: rates are kept by model. Nothing for authors without a server.
#[must_use]
pub fn server_of(spec: &JobSpec) -> Option<&str> {
    if !pipeline::is_authored(spec.key.stage) {
        return None;
    }
    AuthorSpec::server_in(spec.settings.get("author")?)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rate(limit: u64, left: u64, whole_in_ms: Option<u64>) -> Option<Rate> {
        Some(Rate { limit, left, whole_in_ms })
    }

    #[test]
    fn without_any_limit_nobody_waits_but_for_a_pause() {
        let mut bucket = Bucket::new(&Policy::default(), 0);
        for _ in 0..1_000 {
            bucket.take(5, Stage::Paths);
        }
        assert_eq!(bucket.from(5, (0, 0), 1_000_000), 5);
        bucket.pause(90);
        assert_eq!((bucket.from(5, (0, 0), 1), bucket.from(100, (0, 0), 1)), (90, 100));
    }

    #[test]
    fn a_level_sinks_with_every_question_and_rises_by_the_minute() {
        let policy = Policy { tokens_per_minute: 6_000, ..Policy::default() };
        let mut bucket = Bucket::new(&policy, 0);
        assert_eq!(bucket.from(0, (0, 0), 3_000), 0);
        bucket.take(0, Stage::Paths);
        bucket.take(0, Stage::Paths);
        // Empty: 3 000 tokens are there after half a minute.
        assert_eq!(bucket.from(0, (0, 0), 3_000), 30_000);
        assert_eq!(bucket.from(30_000, (0, 0), 3_000), 30_000);
        // More than ever fits is let through when it is full.
        assert_eq!(bucket.from(0, (0, 0), 50_000), 60_000);
        // An answer that took less gives the rest back, and the next is expected to be like it.
        bucket.answered(&policy, 0, Stage::Paths, 1_000, None);
        assert_eq!((bucket.typical(Stage::Paths), bucket.from(0, (0, 0), 1_000)), (1_000, 0));
        bucket.answered(&policy, 0, Stage::Paths, 2_000, None);
        assert_eq!(bucket.typical(Stage::Paths), 1_250);
    }

    #[test]
    fn what_the_server_says_wins_where_it_is_stricter() {
        let policy = Policy { tokens_per_minute: 6_000, ..Policy::default() };
        let mut bucket = Bucket::new(&policy, 0);
        let generous = Rates { tokens: rate(90_000, 90_000, None), requests: None };
        bucket.answered(&policy, 0, Stage::Paths, 100, Some(generous));
        assert_eq!(bucket.from(0, (0, 0), 6_000), 0);
        bucket.take(0, Stage::Paths);
        assert!(bucket.from(0, (0, 0), 6_000) > 0, "the configured limit still holds");
        let strict = Rates { tokens: rate(4_000, 0, Some(120_000)), requests: rate(50, 0, Some(1_000)) };
        bucket.answered(&policy, 0, Stage::Paths, 100, Some(strict));
        // 4 000 in two minutes are 2 000 in one; a request comes every 20 ms.
        assert_eq!((bucket.from(0, (0, 0), 2_000), bucket.from(0, (0, 0), 0)), (60_000, 20));
    }

    #[test]
    fn authors_without_a_server_have_no_bucket() {
        let key = socrates_model::job::JobKey {
            scenario: socrates_model::ScenarioId::new("a").unwrap(),
            stage: Stage::Paths,
            item: socrates_model::job::Item::Whole,
            revision: 0,
        };
        let of = |author: &str, stage: Stage| {
            let spec = JobSpec {
                key: socrates_model::job::JobKey { stage, ..key.clone() },
                inputs: BTreeMap::new(),
                seed: 0,
                feedback: Vec::new(),
                refused: None,
                settings: BTreeMap::from([("author".to_owned(), author.to_owned())]),
            };
            server_of(&spec).map(str::to_owned)
        };
        assert_eq!(of("openai:gpt-4o", Stage::Paths).as_deref(), Some("openai:gpt-4o"));
        assert_eq!(of("record:tape=vllm:small", Stage::Paths).as_deref(), Some("vllm:small"));
        for author in ["offline", "cassette:tape", "record:tape=offline"] {
            assert_eq!(of(author, Stage::Paths), None, "{author}");
        }
        assert_eq!(of("openai:gpt-4o", Stage::Simulation), None);
    }
}
