//! What there is: scenarios, jobs, attempts, results, workers.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};
use socrates_model::fault::FailureClass;
use socrates_model::job::{Artifact, Item, JobKey, JobSpec, Look, Stage};
use socrates_model::report::{Repair, Verdict};
pub use socrates_model::standing::{JobState, ScenarioEnd};
use socrates_model::wire::{Hello, Priority, ScenarioSpec};
use socrates_model::{Digest, Fault, Role, ScenarioId};

use crate::batches::{Batch, Queue};
use crate::bucket::Bucket;
use crate::circuit::Circuit;
use crate::pace::Pacer;
use crate::policy::Policy;
use crate::tally::Tally;

/// Time on the shell's monotonic clock, ms. Its zero has no meaning.
pub type Millis = u64;

/// How an attempt ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum AttemptEnd {
    /// Its result is the job's.
    Succeeded,
    /// It reported a failure.
    Failed,
    /// It took longer than it may.
    TimedOut,
    /// Its worker was lost.
    Lapsed,
    /// Handed back unharmed.
    Released,
    /// Stopped because a client gave the job up.
    Canceled,
    /// Stopped because another attempt or revision made it needless.
    Superseded,
}

impl AttemptEnd {
    /// Name in tables and metrics.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Succeeded => "succeeded",
            Self::Failed => "failed",
            Self::TimedOut => "timed_out",
            Self::Lapsed => "lapsed",
            Self::Released => "released",
            Self::Canceled => "canceled",
            Self::Superseded => "superseded",
        }
    }
}

/// One try at a job. Append-only; only its end is written later.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Attempt {
    /// Number, from 1.
    pub number: u32,
    /// Worker.
    pub instance: String,
    /// Fence; strictly growing per job.
    pub fence: u64,
    /// The job's trial when it was granted: a success of an older trial answers an older question.
    pub trial: u32,
    /// How it ended; none while it runs.
    pub end: Option<AttemptEnd>,
    /// Whether its worker's report is recorded.
    pub reported: bool,
    /// Class of its failure.
    pub class: Option<FailureClass>,
    /// Reasons of its failure.
    pub faults: Vec<Fault>,
    /// Working time as reported, ms.
    pub wall_ms: u64,
    /// From the moment the job was ready to its report, ms; what is more than the working time is waiting
    /// and carrying.
    #[serde(default)]
    pub span_ms: u64,
    /// Tokens in and out.
    pub tokens: (u64, u64),
    /// Remark of the report.
    pub remark: String,
    /// What a failed attempt left: the refused answer, the exchange.
    pub artifacts: Vec<Artifact>,
    /// Wall time at which it was granted, ms since 1970, for people; 0 where it is not known.
    #[serde(default)]
    pub at_ms: u64,
    /// When it was granted, on this reign's clock.
    #[serde(skip)]
    pub granted: Millis,
    /// When its job became ready, on this reign's clock.
    #[serde(skip)]
    pub ready: Millis,
    /// Whether its end was counted.
    #[serde(skip)]
    pub(crate) counted: bool,
    /// Characters that its author has written so far, as of the last beat.
    #[serde(skip)]
    pub(crate) characters: u64,
}

/// The one result of a job.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct JobResult {
    /// Attempt that made it; 0 when it was taken from another job with the same key.
    pub attempt: u32,
    /// Idempotency key under which it may be used again.
    pub idem_key: Digest,
    /// Outputs, without inline content.
    pub artifacts: Vec<Artifact>,
    /// Verdict, of a scoring job.
    pub verdict: Option<Verdict>,
    /// Repair that was asked for.
    pub repair: Option<Repair>,
    /// Stages that a person wants made again.
    #[serde(default)]
    pub anew: Vec<Repair>,
    /// Remark for the status line.
    pub remark: String,
    /// Working time, ms.
    pub wall_ms: u64,
}

/// Failures counted against the budgets of a job.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Tries {
    /// Passing failures and time-outs.
    pub transient: u32,
    /// Overloads without a stated wait.
    pub overload: u32,
    /// Unparsable answers.
    pub unparsable: u32,
    /// Wrong answers: the rung of the ladder.
    pub semantic: u32,
    /// Lost workers.
    pub lapses: u32,
}

/// A stage to be done for one scenario: a row of the store.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Job {
    /// Which.
    pub key: JobKey,
    /// Where it stands.
    pub state: JobState,
    /// The jobs its inputs come from, by role of the input.
    pub sources: BTreeMap<Role, JobKey>,
    /// What a worker is given; inputs are bound when it becomes ready.
    pub spec: JobSpec,
    /// Revision that the seed is drawn from: the last one in which this very stage was sent back.
    pub seed_revision: u32,
    /// How often the ladder asked for another seed.
    pub reseeds: u32,
    /// Reasons for which this revision was made.
    pub sent_back: Vec<Fault>,
    /// Grows whenever the question changes within the row.
    pub trial: u32,
    /// Failures so far.
    pub tries: Tries,
    /// Idempotency key, once its inputs are bound.
    pub idem_key: Option<Digest>,
    /// Pause it is in, ms, when delayed.
    pub delay_ms: u64,
    /// Why it is where it is, in a few words.
    pub reason: String,
    /// Wall time since which it is in its state, ms since 1970, for people; 0 where it is not known.
    #[serde(default)]
    pub since_ms: u64,
    /// Attempts in order.
    #[serde(skip)]
    pub attempts: Vec<Attempt>,
    /// The result, if it succeeded.
    #[serde(skip)]
    pub result: Option<JobResult>,
    /// Jobs whose inputs come from this one.
    #[serde(skip)]
    pub children: Vec<JobKey>,
    /// When it became ready last, on this reign's clock.
    #[serde(skip)]
    pub ready: Millis,
    /// When something happens to it by itself.
    #[serde(skip)]
    pub due: Option<Millis>,
    /// End of the lease.
    #[serde(skip)]
    pub lease_until: Millis,
    /// Longest the attempt may run.
    #[serde(skip)]
    pub deadline_at: Millis,
}

impl Job {
    /// The attempt that holds the job.
    #[must_use]
    pub fn current(&self) -> Option<&Attempt> {
        match self.state {
            JobState::Leased | JobState::Canceling => self.attempts.last(),
            JobState::Blocked
            | JobState::Ready
            | JobState::Delayed
            | JobState::Succeeded
            | JobState::Failed
            | JobState::Dead
            | JobState::Canceled
            | JobState::Superseded => None,
        }
    }

    /// The attempt of this number, where it was granted to this worker with this fence. A fence can be guessed; the name of the worker is
    /// known to it alone.
    #[must_use]
    pub fn granted(&self, number: u32, fence: u64, instance: &str) -> Option<&Attempt> {
        self.attempts.iter().find(|one| one.number == number && one.fence == fence && one.instance == instance)
    }

    /// Whether its result may be used for, and taken from, other jobs with the same key.
    #[must_use]
    pub fn shares(&self) -> bool {
        // A person's look is never a function of its inputs; experiments switch the cache off.
        self.key.stage != Stage::Review && self.spec.settings.get("cache").is_none_or(|cache| cache != "off")
    }
}

/// A scenario and how far it is. Its row in the store is also its one result row.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Scenario {
    /// Batch.
    pub batch: String,
    /// Place in the order of submission.
    pub order: u64,
    /// Its turn among the scenarios of all batches: the lowest is begun first.
    #[serde(default)]
    pub turn: u64,
    /// What was asked for.
    pub spec: ScenarioSpec,
    /// Newest revision.
    pub revision: u32,
    /// Repairs spent.
    pub repairs: u32,
    /// Re-proposals spent.
    pub reproposals: u32,
    /// Revisions a person asked for.
    pub reviews: u32,
    /// Verdict of the lead run, by revision.
    pub verdicts: BTreeMap<u32, Verdict>,
    /// Revisions that are invalid with nothing to mend: what was played was seen, and a part of the request has no place in any revision.
    #[serde(default, skip_serializing_if = "BTreeSet::is_empty")]
    pub partial: BTreeSet<u32>,
    /// The revision that counts; once it is set the other runs are made and nothing is repaired.
    pub settled: Option<u32>,
    /// Whether a client gave it up.
    pub canceled: bool,
    /// How it ended.
    pub end: Option<ScenarioEnd>,
    /// Whether any job was granted.
    pub started: bool,
    /// Wall time at which it was submitted, ms since 1970, for people; 0 where it is not known.
    #[serde(default)]
    pub since_ms: u64,
    /// How urgent its batch is.
    #[serde(default)]
    pub priority: Priority,
    /// Jobs in order of their making.
    #[serde(skip)]
    pub jobs: Vec<JobKey>,
    /// How many of them are not ended.
    #[serde(skip)]
    pub open: usize,
}

/// A worker process as the orchestrator sees it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Worker {
    /// Its introduction.
    pub hello: Hello,
    /// When it last spoke.
    pub seen: Millis,
    /// Whether it takes no more work.
    pub draining: bool,
    /// Jobs it holds.
    pub held: BTreeSet<JobKey>,
    /// Its last acquire, and what it was given.
    pub last: (String, Vec<(JobKey, u32)>),
}

/// Everything. Rebuilt from rows after a restart; the indices are derived.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct State {
    /// Number of this reign.
    pub epoch: u64,
    /// Limits and budgets.
    pub policy: Policy,
    /// Scenarios.
    pub scenarios: BTreeMap<ScenarioId, Scenario>,
    /// Jobs.
    pub jobs: BTreeMap<JobKey, Job>,
    /// Workers by instance.
    pub workers: BTreeMap<String, Worker>,
    /// Wall time at the zero of the shell's clock, ms since 1970; 0 where the shell does not say. It is shown and decides nothing.
    pub clock_ms: u64,
    /// Paused batches; the empty name pauses all.
    pub paused: BTreeSet<String>,
    /// Paused stages.
    pub paused_stages: BTreeSet<Stage>,
    /// Batches by name.
    pub batches: BTreeMap<String, Batch>,
    /// Series by the place of their first scenario.
    pub queues: BTreeMap<u64, Queue>,
    /// Versions of the last workers that were turned away, by stage.
    pub strangers: BTreeMap<Stage, String>,
    /// What is counted.
    pub tally: Tally,
    /// How fast everything goes.
    pub pace: Pacer,
    /// How fast each batch goes.
    pub paces: BTreeMap<String, Pacer>,
    /// Next fence.
    pub next_fence: u64,
    /// Next place in the order of submission.
    pub next_order: u64,
    /// Next number of the outbox.
    pub next_seq: u64,
    /// Authoring attempts allowed at one time; shrinks on overload.
    pub author_slots: u32,
    /// What is known of the authors' servers, by server and model.
    pub servers: BTreeMap<String, Bucket>,
    /// What came of the attempts of each stage lately; empty after a restart.
    pub circuits: BTreeMap<Stage, Circuit>,
    /// When somebody who was held back by a server's rates, or by a circuit, may go on; 0 where nobody was.
    pub author_wake_at: Millis,
    /// Scenarios in order of submission.
    pub(crate) by_order: BTreeMap<u64, ScenarioId>,
    /// Last turn that each batch took.
    pub(crate) last_turns: BTreeMap<String, u64>,
    /// Highest turn of a scenario that was begun.
    pub(crate) begun_turn: u64,
    /// Ready jobs by stage: by the turn of their scenario, then its place, then in order of their making.
    pub(crate) ready: BTreeMap<Stage, BTreeSet<(u64, u64, usize, JobKey)>>,
    /// Jobs by the time at which something happens to them.
    pub(crate) timers: BTreeSet<(Millis, JobKey)>,
    /// Batches by the time at which their own time is looked at.
    pub(crate) batch_timers: BTreeSet<(Millis, String)>,
    /// Series of which more scenarios may have to be made, by the place of their first.
    pub(crate) drawing: BTreeSet<u64>,
    /// Results by idempotency key.
    pub(crate) cached: BTreeMap<Digest, JobKey>,
    /// Keys that somebody works on.
    pub(crate) in_flight: BTreeMap<Digest, JobKey>,
    /// Jobs that wait, by key.
    pub(crate) waiting: BTreeMap<Digest, BTreeSet<JobKey>>,
    /// Scenarios started and not ended, those that wait for a person left out.
    pub(crate) under_way: usize,
    /// Scenarios ended.
    pub(crate) done: usize,
    /// Jobs not ended.
    pub(crate) open_jobs: usize,
    /// Authoring jobs leased.
    pub(crate) authoring: u32,
}

impl State {
    /// An empty state.
    #[must_use]
    pub fn new(policy: Policy) -> Self {
        Self {
            epoch: 1,
            author_slots: policy.author_slots,
            policy,
            scenarios: BTreeMap::new(),
            jobs: BTreeMap::new(),
            workers: BTreeMap::new(),
            clock_ms: 0,
            paused: BTreeSet::new(),
            paused_stages: BTreeSet::new(),
            batches: BTreeMap::new(),
            queues: BTreeMap::new(),
            strangers: BTreeMap::new(),
            tally: Tally::default(),
            pace: Pacer::default(),
            paces: BTreeMap::new(),
            next_fence: 1,
            next_order: 0,
            next_seq: 1,
            servers: BTreeMap::new(),
            circuits: BTreeMap::new(),
            author_wake_at: 0,
            by_order: BTreeMap::new(),
            last_turns: BTreeMap::new(),
            begun_turn: 0,
            ready: BTreeMap::new(),
            timers: BTreeSet::new(),
            batch_timers: BTreeSet::new(),
            drawing: BTreeSet::new(),
            cached: BTreeMap::new(),
            in_flight: BTreeMap::new(),
            waiting: BTreeMap::new(),
            under_way: 0,
            done: 0,
            open_jobs: 0,
            authoring: 0,
        }
    }

    /// When the next [`crate::Event::Tick`] is needed.
    #[must_use]
    pub fn next_due(&self) -> Option<Millis> {
        if !self.drawing.is_empty() {
            return Some(0);
        }
        let job = self.timers.first().map(|(due, _)| *due);
        job.into_iter().chain(self.batch_timers.first().map(|(due, _)| *due)).min()
    }

    /// Scenarios asked for, those of series that are not made among them, and those that ended or are never made.
    #[must_use]
    pub fn counts(&self) -> (usize, usize) {
        let (unmade, left_out) = self.unmade(|_| true);
        (self.scenarios.len() + unmade + left_out, self.done + left_out)
    }

    /// How many scenarios of the chosen series are not made yet, and how many never will be.
    pub(crate) fn unmade(&self, chosen: impl Fn(&Queue) -> bool) -> (usize, usize) {
        let size = |count: u32| usize::try_from(count).unwrap_or(usize::MAX);
        let own = self.queues.values().filter(|queue| chosen(queue));
        own.fold((0, 0), |(unmade, left), queue| (unmade + size(queue.unmade()), left + size(queue.left_out)))
    }

    /// The series that stands at this place in the order of submission.
    pub(crate) fn queue_at(&mut self, order: u64) -> Option<&mut Queue> {
        self.queues.range_mut(..=order).next_back().map(|(_, queue)| queue).filter(|queue| order < queue.end())
    }

    /// Whether there are scenarios and all of them ended.
    #[must_use]
    pub fn is_done(&self) -> bool {
        let (asked, done) = self.counts();
        asked > 0 && asked == done
    }

    /// Wall time of a time on the shell's clock, ms since 1970; 0 where it is not known.
    pub(crate) const fn wall_ms(&self, now: Millis) -> u64 {
        if self.clock_ms == 0 { 0 } else { self.clock_ms.saturating_add(now) }
    }

    /// Started scenarios at which no new one is begun.
    pub(crate) fn most_begun(&self) -> usize {
        let workers = u32::try_from(self.workers.len()).unwrap_or(u32::MAX);
        usize::try_from(workers.saturating_mul(self.policy.open_per_worker)).unwrap_or(usize::MAX).max(8)
    }

    /// Whether a job of this stage waits for a worker.
    #[must_use]
    pub fn has_ready(&self, stage: Stage) -> bool {
        self.ready.get(&stage).is_some_and(|ready| !ready.is_empty())
    }

    /// The job that stands in this place of the plan at a revision: the newest not newer than it.
    pub(crate) fn place(&self, id: &ScenarioId, stage: Stage, item: &Item, revision: u32) -> Option<&JobKey> {
        let key = |revision| JobKey { scenario: id.clone(), stage, item: item.clone(), revision };
        self.jobs.range(key(0)..=key(revision)).next_back().map(|(key, _)| key)
    }

    /// The newest look at a revision, or before it, that has a result or may still get one.
    pub(crate) fn look(&self, id: &ScenarioId, look: Look, revision: u32) -> Option<&JobKey> {
        let key = |revision| JobKey { scenario: id.clone(), stage: Stage::Review, item: look.into(), revision };
        let counts = |job: &Job| job.state == JobState::Succeeded || !job.state.is_terminal();
        self.jobs.range(key(0)..=key(revision)).rev().find(|(_, job)| counts(job)).map(|(key, _)| key)
    }
}
