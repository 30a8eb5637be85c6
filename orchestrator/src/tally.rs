//! What is counted: jobs by state, how attempts ended and how long they took, tokens. Of this reign, but for the jobs; nothing is decided by it.

use std::collections::{BTreeMap, VecDeque};

use socrates_model::fault::FailureClass;
use socrates_model::job::{JobKey, Stage};

use crate::state::{AttemptEnd, JobState, Millis};

/// Upper ends of the ranges in which times are counted, ms: from a cached answer to the longest simulation.
pub const TIMES_MS: &[u64] =
    &[10, 50, 100, 250, 500, 1_000, 2_500, 5_000, 10_000, 30_000, 60_000, 120_000, 300_000, 1_200_000];
/// Attempts of a stage whose median is told, at most.
const RECENT: usize = 129;
/// Failed attempts that are kept for a table, at most.
const FAILURES: usize = 32;
/// Servers that tokens are counted for by name, at most; the rest is counted as [`OTHER`].
const SERVERS: usize = 32;
/// Characters of the name of a server, at most.
const SERVER_CHARS: usize = 100;
/// Name under which the tokens of further servers are counted.
const OTHER: &str = "other";

/// How often values fell into ranges. The unit is the counter's.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Histogram {
    bounds: &'static [u64],
    counts: Vec<u64>,
    sum: u64,
}

impl Histogram {
    /// An empty one with these upper ends, which grow.
    #[must_use]
    pub fn new(bounds: &'static [u64]) -> Self {
        Self { bounds, counts: vec![0; bounds.len() + 1], sum: 0 }
    }

    /// Counts a value.
    pub fn add(&mut self, value: u64) {
        let place = self.bounds.partition_point(|bound| *bound < value);
        if let Some(count) = self.counts.get_mut(place) {
            *count += 1;
        }
        self.sum = self.sum.saturating_add(value);
    }

    /// Every upper end, and how many values are at most that.
    pub fn ranges(&self) -> impl Iterator<Item = (u64, u64)> {
        self.bounds.iter().zip(&self.counts).scan(0, |so_far, (bound, count)| {
            *so_far += count;
            Some((*bound, *so_far))
        })
    }

    /// How many values there were.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.counts.iter().sum()
    }

    /// All of them together.
    #[must_use]
    pub const fn sum(&self) -> u64 {
        self.sum
    }
}

/// Everything that is counted.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Tally {
    /// Jobs by stage and state.
    pub jobs: BTreeMap<(Stage, JobState), u64>,
    /// Attempts that ended, by how and by the class of their failure.
    pub attempts: BTreeMap<(Stage, AttemptEnd, Option<FailureClass>), u64>,
    /// Times from grant to report, ms.
    pub durations: BTreeMap<Stage, Histogram>,
    /// Times from ready to granted, ms.
    pub waits: BTreeMap<Stage, Histogram>,
    /// Reports that were known already.
    pub duplicates: u64,
    /// Reports that came too late to count as the result.
    pub late: u64,
    /// Tokens in and out by server and model.
    pub tokens: BTreeMap<String, (u64, u64)>,
    recent: BTreeMap<Stage, VecDeque<u64>>,
    failures: VecDeque<(JobKey, u32, Millis)>,
}

impl Tally {
    pub(crate) fn enters(&mut self, stage: Stage, state: JobState) {
        *self.jobs.entry((stage, state)).or_default() += 1;
    }

    pub(crate) fn leaves(&mut self, stage: Stage, state: JobState) {
        if let Some(count) = self.jobs.get_mut(&(stage, state)) {
            *count = count.saturating_sub(1);
        }
    }

    pub(crate) fn waited(&mut self, stage: Stage, ms: u64) {
        self.waits.entry(stage).or_insert_with(|| Histogram::new(TIMES_MS)).add(ms);
    }

    pub(crate) fn asked(&mut self, server: &str, tokens: (u64, u64)) {
        if tokens == (0, 0) {
            return;
        }
        let name: String = server.chars().take(SERVER_CHARS).collect();
        let known = self.tokens.contains_key(&name) || self.tokens.len() < SERVERS;
        let name = if known { name } else { OTHER.to_owned() };
        let sum = self.tokens.entry(name).or_default();
        *sum = (sum.0.saturating_add(tokens.0), sum.1.saturating_add(tokens.1));
    }

    /// An attempt ended; `took` where its worker reported it.
    pub(crate) fn ended(
        &mut self,
        key: &JobKey,
        number: u32,
        (end, class): (AttemptEnd, Option<FailureClass>),
        took: Option<u64>,
        now: Millis,
    ) {
        *self.attempts.entry((key.stage, end, class)).or_default() += 1;
        if let Some(ms) = took {
            self.durations.entry(key.stage).or_insert_with(|| Histogram::new(TIMES_MS)).add(ms);
            let recent = self.recent.entry(key.stage).or_default();
            recent.push_back(ms);
            if recent.len() > RECENT {
                recent.pop_front();
            }
        }
        if matches!(end, AttemptEnd::Failed | AttemptEnd::TimedOut | AttemptEnd::Lapsed) {
            self.failures.push_front((key.clone(), number, now));
            self.failures.truncate(FAILURES);
        }
    }

    /// Median of the times of the last attempts of a stage, ms.
    #[must_use]
    pub fn median_ms(&self, stage: Stage) -> Option<u64> {
        let mut times: Vec<u64> = self.recent.get(&stage)?.iter().copied().collect();
        times.sort_unstable();
        times.get(times.len() / 2).copied()
    }

    /// The newest failed attempts, newest first: job, number, and when.
    pub fn failures(&self) -> impl Iterator<Item = &(JobKey, u32, Millis)> {
        self.failures.iter()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_falls_into_the_first_range_that_holds_it() {
        let mut histogram = Histogram::new(&[10, 100]);
        for value in [0, 10, 11, 100, 101] {
            histogram.add(value);
        }
        assert_eq!(histogram.ranges().collect::<Vec<_>>(), [(10, 2), (100, 4)]);
        assert_eq!((histogram.count(), histogram.sum()), (5, 222));
    }

    #[test]
    fn servers_beyond_the_limit_are_counted_together() {
        let mut tally = Tally::default();
        for number in 0..40 {
            tally.asked(&format!("openai:m{number}"), (1, 2));
            tally.asked("offline", (0, 0));
        }
        assert_eq!((tally.tokens.len(), tally.tokens[OTHER]), (33, (8, 16)));
    }
}
