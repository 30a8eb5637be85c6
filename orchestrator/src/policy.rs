//! Limits and budgets, all in one place: leases, pauses, deadlines, and how often each class of failure is tried again.

use socrates_model::job::{JobKey, Stage};
use socrates_model::{Digest, seeds};

use crate::state::Millis;

/// What an authoring attempt may take beside its call, ms: fetching inputs, reading the answer, checking it.
pub const AFTER_CALL_MS: u64 = 30_000;

/// What the orchestrator allows. Every field has a default that suits one machine and a cluster.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Policy {
    /// Length of a lease, ms. Default 15 000. Shorter finds lost workers sooner and forgives less.
    pub lease_ms: u64,
    /// Pause between a worker's beats, ms. Default 2 000.
    pub beat_ms: u64,
    /// How long a worker whose liveliness token is gone may still beat, ms. Default 2 000.
    pub grace_ms: u64,
    /// How long a canceled attempt may take to say so, ms. Default 30 000.
    pub cancel_ms: u64,
    /// Longest authoring attempt, ms: the longest call of an author and [`AFTER_CALL_MS`]. Default 120 000.
    pub author_deadline_ms: u64,
    /// Longest simulation attempt, ms. Default 1 200 000: ten times the longest scenario.
    pub simulation_deadline_ms: u64,
    /// Longest scoring attempt, ms. Default 60 000.
    pub scoring_deadline_ms: u64,
    /// Longest look of a person, ms. Default ten years: whoever looks has all the time they want.
    pub review_deadline_ms: u64,
    /// Transient failures that a job survives. Default 8.
    pub transient_tries: u32,
    /// Questions without an answer in time that an authoring job survives. Default 3.
    pub late_tries: u32,
    /// Overloads without a stated wait that a job survives. Default 8.
    pub overload_tries: u32,
    /// Unparsable answers that a job survives. Default 2.
    pub unparsable_tries: u32,
    /// Wrong answers that are asked again with the reasons before the seed changes. Default 2.
    pub feedback_tries: u32,
    /// Asks with another seed after that. Default 1.
    pub reseeds: u32,
    /// Lost workers at which a job is taken for one that kills its worker. Default 3.
    pub lapses: u32,
    /// New revisions that a scenario may have, re-proposals included. Default 3.
    pub repairs: u32,
    /// Re-proposals because a later stage found no answer. Default 1.
    pub reproposals: u32,
    /// Revisions that a person may ask for. Default 1 000.
    pub reviews: u32,
    /// First back-off, ms. Default 500.
    pub backoff_ms: u64,
    /// What a back-off is multiplied by with every further failure. Default 2; 1 keeps it as it is.
    pub backoff_growth: u64,
    /// Whether a back-off is drawn evenly from zero to its length, so that those who failed together do not come back
    /// together. Default true.
    pub backoff_jitter: bool,
    /// Longest back-off, ms. Default 60 000.
    pub backoff_cap_ms: u64,
    /// Started scenarios per live worker before new ones are begun. Default 4.
    pub open_per_worker: u32,
    /// Jobs not yet ended at which a submission is told to come back. Default 200 000.
    pub max_open_jobs: usize,
    /// Runs (planner and seed) that one scenario may ask for. Default 10 000.
    pub max_runs: usize,
    /// Authoring attempts at one time. Default 256; halves on overload and grows back.
    pub author_slots: u32,
    /// Tokens, in and out, that the authors of one scenario may take; 0 sets no limit. Default 0.
    pub tokens_per_scenario: u64,
    /// Time that the authors of one scenario may take, ms; 0 sets no limit. Default 0.
    pub author_ms_per_scenario: u64,
    /// Money that the authors of one scenario may cost, in millionths; 0 sets no limit. Default 0.
    pub money_per_scenario: u64,
    /// Prices of a million tokens in and out by model, in millionths; an author without one costs nothing.
    pub prices: std::collections::BTreeMap<String, (u64, u64)>,
    /// Time that a batch may run without limits of its own, ms; 0 sets no limit. Default 2 592 000 000: thirty days.
    pub batch_deadline_ms: u64,
    /// Tokens that one author's server is asked for in a minute, in and out; 0 leaves it to what the server says. Default 0.
    pub tokens_per_minute: u64,
    /// Questions that one author's server is asked in a minute; 0 leaves it to what the server says. Default 0.
    pub requests_per_minute: u64,
    /// Share of a stage's attempts in a minute, percent, above which failures in passing let it rest; 0 never does. Default 0.
    pub circuit_percent: u32,
    /// How long it rests before one attempt is tried, ms. Default 30 000.
    pub circuit_ms: u64,
    /// Version that workers must have; empty takes any. Enters the idempotency keys.
    pub code_version: String,
}

impl Default for Policy {
    fn default() -> Self {
        Self {
            lease_ms: 15_000,
            beat_ms: 2_000,
            grace_ms: 2_000,
            cancel_ms: 30_000,
            author_deadline_ms: 120_000,
            simulation_deadline_ms: 1_200_000,
            scoring_deadline_ms: 60_000,
            review_deadline_ms: 315_360_000_000,
            transient_tries: 8,
            late_tries: 3,
            overload_tries: 8,
            unparsable_tries: 2,
            feedback_tries: 2,
            reseeds: 1,
            lapses: 3,
            repairs: 3,
            reproposals: 1,
            reviews: 1_000,
            backoff_ms: 500,
            backoff_growth: 2,
            backoff_jitter: true,
            backoff_cap_ms: 60_000,
            open_per_worker: 4,
            max_open_jobs: 200_000,
            max_runs: 10_000,
            author_slots: 256,
            tokens_per_scenario: 0,
            author_ms_per_scenario: 0,
            money_per_scenario: 0,
            prices: std::collections::BTreeMap::new(),
            batch_deadline_ms: 2_592_000_000,
            tokens_per_minute: 0,
            requests_per_minute: 0,
            circuit_percent: 0,
            circuit_ms: 30_000,
            code_version: String::new(),
        }
    }
}

impl Policy {
    /// The same with so many further asks after an answer that cannot be taken, the last of them with another seed.
    /// The default is 3; with 0 the first answer counts and nothing is proposed anew.
    #[must_use]
    pub fn asking_again(self, times: u32) -> Self {
        Self {
            feedback_tries: times.saturating_sub(1),
            reseeds: times.min(1),
            late_tries: times,
            unparsable_tries: times.min(self.unparsable_tries),
            reproposals: times.min(self.reproposals),
            ..self
        }
    }

    /// Longest attempt of a stage, ms.
    #[must_use]
    pub const fn deadline_ms(&self, stage: Stage) -> u64 {
        match stage {
            Stage::Proposal | Stage::Paths | Stage::Behaviors => self.author_deadline_ms,
            Stage::Simulation => self.simulation_deadline_ms,
            Stage::Scoring => self.scoring_deadline_ms,
            Stage::Review => self.review_deadline_ms,
        }
    }

    /// Pause before the next attempt after the `failures`-th failure, ms: min(cap, base · growth^(failures-1)), with full jitter
    /// uniform in 0 ..= that. The draw is a hash of job and attempt, so that the same history waits the same time.
    #[must_use]
    pub fn backoff(&self, key: &JobKey, attempt: u32, failures: u32) -> Millis {
        let grown =
            self.backoff_ms.saturating_mul(self.backoff_growth.saturating_pow(failures.saturating_sub(1).min(20)));
        let longest = grown.min(self.backoff_cap_ms);
        if !self.backoff_jitter {
            return longest;
        }
        seeds::derive_seed(u64::from(attempt), &[&key.to_string(), "backoff"]) % longest.saturating_add(1)
    }

    /// Key under which a result may be used again.
    #[must_use]
    pub fn idem_key(&self, spec: &socrates_model::job::JobSpec) -> Digest {
        spec.idem_key(&self.code_version)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use socrates_model::ScenarioId;

    #[test]
    fn backoff_grows_to_its_cap_and_repeats_itself() {
        let policy = Policy::default();
        let key = JobKey {
            scenario: ScenarioId::new("a").unwrap(),
            stage: Stage::Paths,
            item: socrates_model::job::Item::Whole,
            revision: 0,
        };
        for failures in 1..40 {
            let pause = policy.backoff(&key, failures, failures);
            assert!(pause <= policy.backoff_cap_ms.min(500 << (failures - 1).min(20)));
            assert_eq!(pause, policy.backoff(&key, failures, failures));
        }
        assert!((1..40).any(|n| policy.backoff(&key, n, n) > 5_000), "never waits long");
        let plain = Policy { backoff_jitter: false, ..Policy::default() };
        assert_eq!([1, 2, 3, 30].map(|n| plain.backoff(&key, n, n)), [500, 1_000, 2_000, 60_000]);
        let fixed = Policy { backoff_growth: 1, ..plain };
        assert_eq!([1, 2, 9].map(|n| fixed.backoff(&key, n, n)), [500; 3]);
    }
}
