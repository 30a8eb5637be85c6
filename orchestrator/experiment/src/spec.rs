//! What an experiment asks: workloads × faults × rates × policies × tries, and the assumptions that all of them share.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use socrates_model::job::Stage;

use crate::draws::Duration;
use crate::kind::Kind;
use crate::policies::{self, RetryPolicy, Tuned};

/// Scenarios of one experiment at most.
pub const MOST_SCENARIOS: u64 = 2_000_000;
/// Stages that ask an author, in the order of the pipeline.
pub const AUTHORED: [Stage; 3] = [Stage::Proposal, Stage::Paths, Stage::Behaviors];

/// An experiment.
#[derive(Debug, Clone, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Spec {
    /// Heading of the report.
    pub title: String,
    /// What it is to show, in a sentence or two.
    #[serde(default)]
    pub about: String,
    /// Seed of every draw. Default 1.
    #[serde(default = "one")]
    pub seed: u64,
    /// What the jobs are done with. Default `simulator`.
    #[serde(default)]
    pub level: Level,
    /// Scenarios of each cell. Default 1 000.
    #[serde(default = "thousand")]
    pub scenarios: u32,
    /// Scenarios that one orchestrator and its workers are given at once. Default 200.
    #[serde(default = "two_hundred")]
    pub batch: u32,
    /// Tries of each job and class of failure; each number is a cell of its own. Default 4.
    #[serde(default = "four")]
    pub tries: Vec<u32>,
    /// Names of policies: those that come with the program, and those of `policy`. The others are compared with the first.
    pub policies: Vec<String>,
    /// Rows of `attempts.csv` at most; what is more is left out and counted. Default 50 000; 0 writes none.
    #[serde(default = "rows")]
    pub attempt_rows: u64,
    /// What the authors are assumed to do.
    #[serde(default)]
    pub model: Model,
    /// Worker processes of each stage.
    #[serde(default)]
    pub workers: Workers,
    /// How long an attempt at each stage works.
    #[serde(default)]
    pub durations: Durations,
    /// Tokens of a question.
    #[serde(default)]
    pub tokens: Tokens,
    /// Times of bus, store, processes and faults, ms.
    #[serde(default)]
    pub times_ms: Times,
    /// Kinds of scenarios. Without any there is one whose answers are all right.
    #[serde(default)]
    pub workload: Vec<Workload>,
    /// Faults that are put in. Without any there is a row of cells without faults.
    #[serde(default)]
    pub fault: Vec<Strike>,
    /// Policies of one's own.
    #[serde(default)]
    pub policy: BTreeMap<String, Tuned>,
}

/// What the jobs of an experiment are done with.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Level {
    /// The orchestrator's state machine in virtual time, with workers that are simulated.
    #[default]
    Simulator,
    /// Real processes: an orchestrator, its store and its workers, with authors that are simulated. Times are those of the wall.
    Processes,
}

impl Level {
    /// What its clock is called.
    #[must_use]
    pub const fn clock(self) -> &'static str {
        match self {
            Self::Simulator => "virtual",
            Self::Processes => "wall",
        }
    }
}

/// What the authors are assumed to do. Every value is a choice of the experimenter, measured on no model.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Model {
    /// Probability that a violation is gone from the next answer when the author is told of it by name. Default 0.7.
    pub fix_if_named: f64,
    /// The same where it is told only that its answer was wrong. Default 0.4.
    pub fix_if_vague: f64,
    /// Probability that a mended answer has another violation. Default 0.05.
    pub collateral: f64,
    /// Correlation of whether two answers that were made from the beginning break a rule, at the same stage of the same scenario.
    /// 0: every try is a new chance; 1: what failed once fails for ever. Default 0.2.
    pub correlation: f64,
    /// Probability that the checks find a violation; what they do not find is judged `contradicted` in the end. Default 1.
    pub found: f64,
}

impl Default for Model {
    fn default() -> Self {
        Self { fix_if_named: 0.7, fix_if_vague: 0.4, collateral: 0.05, correlation: 0.2, found: 1.0 }
    }
}

/// Worker processes of each stage, 1 to 256.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Workers {
    /// Default 4.
    pub proposal: u32,
    /// Default 4.
    pub paths: u32,
    /// Default 4.
    pub behaviors: u32,
    /// Default 4.
    pub simulation: u32,
    /// Default 2.
    pub scoring: u32,
}

impl Default for Workers {
    fn default() -> Self {
        Self { proposal: 4, paths: 4, behaviors: 4, simulation: 4, scoring: 2 }
    }
}

impl Workers {
    /// Those of a stage.
    #[must_use]
    pub const fn of(&self, stage: Stage) -> u32 {
        match stage {
            Stage::Proposal => self.proposal,
            Stage::Paths => self.paths,
            Stage::Behaviors => self.behaviors,
            Stage::Simulation => self.simulation,
            Stage::Scoring => self.scoring,
            Stage::Review => 0,
        }
    }
}

/// How long an attempt at each stage works, where nothing strikes it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Durations {
    /// Default log-normal, median 4 s, 95 % below 9 s.
    pub proposal: Duration,
    /// Default log-normal, median 4 s, 95 % below 9 s.
    pub paths: Duration,
    /// Default log-normal, median 6 s, 95 % below 14 s.
    pub behaviors: Duration,
    /// Default 1 to 4 s.
    pub simulation: Duration,
    /// Default 0.2 s.
    pub scoring: Duration,
}

impl Default for Durations {
    fn default() -> Self {
        Self {
            proposal: Duration::Lognormal([4_000, 9_000]),
            paths: Duration::Lognormal([4_000, 9_000]),
            behaviors: Duration::Lognormal([6_000, 14_000]),
            simulation: Duration::Uniform([1_000, 4_000]),
            scoring: Duration::Fixed(200),
        }
    }
}

impl Durations {
    /// That of a stage.
    #[must_use]
    pub const fn of(&self, stage: Stage) -> Duration {
        match stage {
            Stage::Proposal => self.proposal,
            Stage::Paths => self.paths,
            Stage::Behaviors => self.behaviors,
            Stage::Simulation => self.simulation,
            Stage::Scoring | Stage::Review => self.scoring,
        }
    }
}

/// Tokens of a question, in and out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Tokens {
    /// Default 1 300 and 300.
    pub proposal: [u64; 2],
    /// Default 1 750 and 400.
    pub paths: [u64; 2],
    /// Default 1 900 and 500.
    pub behaviors: [u64; 2],
    /// Tokens in that a refused answer and its faults add. Default 600.
    pub refused: u64,
}

impl Default for Tokens {
    fn default() -> Self {
        Self { proposal: [1_300, 300], paths: [1_750, 400], behaviors: [1_900, 500], refused: 600 }
    }
}

impl Tokens {
    /// Those of a question of a stage; none where no author is asked.
    #[must_use]
    pub const fn of(&self, stage: Stage) -> [u64; 2] {
        match stage {
            Stage::Proposal => self.proposal,
            Stage::Paths => self.paths,
            Stage::Behaviors => self.behaviors,
            Stage::Simulation | Stage::Scoring | Stage::Review => [0, 0],
        }
    }
}

/// Times of bus, store, processes and faults, ms.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Times {
    /// One way of a message. Default 1.
    pub message: u64,
    /// A commit. Default 4.
    pub commit: u64,
    /// Until a worker sends a question without an answer again. Default 2 000.
    pub resend: u64,
    /// Until an idle worker asks by itself; hints wake it earlier. Default 5 000.
    pub poll: u64,
    /// Until the loss of a dead worker's token is seen. Default 100.
    pub token: u64,
    /// Until a dead worker has a successor. Default 1 000.
    pub restart: u64,
    /// Until a dead orchestrator has one. Default 800.
    pub down: u64,
    /// A slow commit. Default 5 000.
    pub slow: u64,
    /// How long a worker is cut off. Default 20 000.
    pub cut: u64,
    /// How long an author's server is waited for. Default 90 000.
    pub timeout: u64,
    /// The wait that an overloaded server asks for; 0 asks for none. Default 0.
    pub retry_after: u64,
}

impl Default for Times {
    fn default() -> Self {
        Self {
            message: 1,
            commit: 4,
            resend: 2_000,
            poll: 5_000,
            token: 100,
            restart: 1_000,
            down: 800,
            slow: 5_000,
            cut: 20_000,
            timeout: 90_000,
            retry_after: 0,
        }
    }
}

/// A kind of scenarios.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Workload {
    /// Name in tables.
    pub name: String,
    /// What it is, in a sentence.
    #[serde(default)]
    pub about: String,
    /// Probability that the first answers of all its questions are right, above 0 up to 1. Default 1.
    #[serde(default = "sure")]
    pub first_cut: f64,
    /// Which questions are asked, and how the difficulty is shared out among them. Default all three, 0.06, 0.34 and 0.60.
    #[serde(default)]
    pub asks: Asks,
}

/// Shares of the difficulty: the first answer to a question of share a is right with probability `first_cut`^(a / sum). A
/// question without a share is not asked: its answer is given.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Asks {
    /// Share of the proposal.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub proposal: Option<f64>,
    /// Share of the paths.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub paths: Option<f64>,
    /// Share of the behaviors.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub behaviors: Option<f64>,
}

impl Default for Asks {
    fn default() -> Self {
        Self { proposal: Some(0.06), paths: Some(0.34), behaviors: Some(0.60) }
    }
}

impl Asks {
    /// That of a stage; none where it is not asked.
    #[must_use]
    pub const fn of(&self, stage: Stage) -> Option<f64> {
        match stage {
            Stage::Proposal => self.proposal,
            Stage::Paths => self.paths,
            Stage::Behaviors => self.behaviors,
            Stage::Simulation | Stage::Scoring | Stage::Review => None,
        }
    }

    fn sum(&self) -> f64 {
        AUTHORED.iter().filter_map(|stage| self.of(*stage)).sum()
    }
}

impl Workload {
    /// Probability that a first answer of a stage breaks a rule, and nothing is put in besides.
    #[must_use]
    pub fn violation(&self, stage: Stage) -> f64 {
        let share = self.asks.of(stage).unwrap_or(0.0);
        let sum = self.asks.sum();
        if sum <= 0.0 { 0.0 } else { 1.0 - libm::pow(self.first_cut, share / sum) }
    }
}

/// Faults that are put in together, at one rate after the other.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Strike {
    /// Name in tables; its kinds where there is none.
    #[serde(default)]
    pub name: String,
    /// What is put in; each kind is drawn for itself.
    pub kinds: Vec<Kind>,
    /// Probability of each kind at each attempt that it can strike; each number is a cell of its own.
    pub rates: Vec<f64>,
    /// Virtual time from which on attempts are struck, ms after the batch was submitted. Default 0.
    #[serde(default)]
    pub from_ms: u64,
    /// Virtual time until which they are. Default for ever.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub to_ms: Option<u64>,
}

impl Strike {
    /// Name in tables.
    #[must_use]
    pub fn shown(&self) -> String {
        if !self.name.is_empty() {
            return self.name.clone();
        }
        let words: Vec<&str> = self.kinds.iter().map(|kind| kind.word()).collect();
        if words.is_empty() { "none".to_owned() } else { words.join("+") }
    }

    /// Whether attempts that begin at this time can be struck.
    #[must_use]
    pub fn holds_at(&self, ms: u64) -> bool {
        ms >= self.from_ms && self.to_ms.is_none_or(|to| ms < to)
    }
}

/// One cell: the same scenarios, one way of treating them.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    /// Number, from 0.
    pub number: usize,
    /// Kind of scenarios.
    pub workload: Workload,
    /// What is put in.
    pub strike: Strike,
    /// At which rate.
    pub rate: f64,
    /// Tries of a job.
    pub tries: u32,
    /// Policy.
    pub policy: RetryPolicy,
    /// Cell of the first policy with everything else the same.
    pub base: usize,
}

const fn one() -> u64 {
    1
}

const fn thousand() -> u32 {
    1_000
}

const fn two_hundred() -> u32 {
    200
}

fn four() -> Vec<u32> {
    vec![4]
}

const fn rows() -> u64 {
    50_000
}

const fn sure() -> f64 {
    1.0
}

impl Spec {
    /// The specification with everything that it leaves open filled in, and what is wrong with its policies, a line each.
    pub(crate) fn filled(mut self) -> (Self, Vec<String>) {
        if self.workload.is_empty() {
            self.workload.push(Workload {
                name: "plain".to_owned(),
                about: "Every answer is right.".to_owned(),
                first_cut: 1.0,
                asks: Asks::default(),
            });
        }
        if self.fault.is_empty() {
            let (name, kinds, rates) = ("none".to_owned(), Vec::new(), vec![0.0]);
            self.fault.push(Strike { name, kinds, rates, from_ms: 0, to_ms: None });
        }
        let mut problems = Vec::new();
        let mut chosen = BTreeMap::new();
        for name in &self.policies {
            match self.chosen(name) {
                Ok(policy) => drop(chosen.insert(name.clone(), policy.tuned())),
                Err(wrong) => problems.extend(wrong),
            }
        }
        for name in self.policy.keys().filter(|name| !self.policies.contains(name)) {
            problems.push(format!("`policy.{name}` is not used: `policies` does not name it"));
        }
        if problems.is_empty() {
            self.policy = chosen;
        }
        (self, problems)
    }

    /// The policy of this name: of the specification, else of the program.
    fn chosen(&self, name: &str) -> Result<RetryPolicy, Vec<String>> {
        if let Some(own) = self.policy.get(name) {
            return own.whole(name);
        }
        policies::shipped(name).ok_or_else(|| {
            let own = self.policy.keys().map(String::as_str);
            let known: Vec<&str> = policies::names().into_iter().chain(own).collect();
            let hedged = if name == "hedged" {
                "; the orchestrator has one attempt of a job at a time, so there is nothing that a hedge could be simulated with"
            } else {
                ""
            };
            vec![format!("`policies` names `{name}`; there is {}{hedged}", known.join(", "))]
        })
    }

    /// Every cell in order: workloads, faults, rates, tries, policies.
    #[must_use]
    pub fn cells(&self) -> Vec<Cell> {
        let chosen: Vec<RetryPolicy> = self.policies.iter().filter_map(|name| self.chosen(name).ok()).collect();
        let mut cells = Vec::new();
        for workload in &self.workload {
            for strike in &self.fault {
                for rate in &strike.rates {
                    for tries in &self.tries {
                        let base = cells.len();
                        cells.extend(chosen.iter().zip(base..).map(|(policy, number)| Cell {
                            number,
                            workload: workload.clone(),
                            strike: strike.clone(),
                            rate: *rate,
                            tries: *tries,
                            policy: policy.clone(),
                            base,
                        }));
                    }
                }
            }
        }
        cells
    }

    /// How many cells there are, without making them.
    #[must_use]
    pub fn count(&self) -> usize {
        let rates: usize = self.fault.iter().map(|strike| strike.rates.len()).fold(0, usize::saturating_add);
        [self.workload.len(), rates, self.tries.len(), self.policies.len()].into_iter().fold(1, usize::saturating_mul)
    }

    /// How many batches a cell has.
    #[must_use]
    pub fn batches(&self) -> u32 {
        self.scenarios.div_ceil(self.batch.max(1))
    }

    /// Numbers of the scenarios of a batch, from 0.
    #[must_use]
    pub fn scenarios_of(&self, batch: u32) -> std::ops::Range<u32> {
        let first = batch.saturating_mul(self.batch);
        first.min(self.scenarios)..first.saturating_add(self.batch).min(self.scenarios)
    }
}
