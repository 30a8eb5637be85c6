//! What was seen from outside of the orchestrator: attempts, scenarios, recoveries, and what its workers were promised.

use std::collections::{BTreeMap, BTreeSet};

use socrates_model::fault::FailureClass;
use socrates_model::job::{JobKey, Stage};
use socrates_model::wire::Recorded;
use socrates_model::{ScenarioEnd, ScenarioId, Verdict};

use crate::draws::At;
use crate::kind::Kind;
use crate::rows::Rows;
use crate::spec::AUTHORED;

/// One attempt, as its worker saw it. Times are virtual, ms after the batch was submitted.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AttemptRow {
    /// Which.
    pub at: At,
    /// When it began.
    pub begun_ms: u64,
    /// When its report was recorded, or it ended without one; none where neither happened.
    pub ended_ms: Option<u64>,
    /// What came of it.
    pub outcome: &'static str,
    /// What the orchestrator said to its report; none where no answer came.
    pub recorded: Option<Recorded>,
    /// Tokens in and out.
    pub tokens: [u64; 2],
}

/// One scenario of a cell.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ScenarioRow {
    /// Number, from 0, in the whole experiment.
    pub scenario: u32,
    /// How it ended; none where it never did.
    pub end: Option<ScenarioEnd>,
    /// Whether the first answer of every question was right.
    pub first_cut: bool,
    /// When its first attempt began, virtual ms after the batch was submitted.
    pub begun_ms: Option<u64>,
    /// When it ended.
    pub ended_ms: Option<u64>,
    /// Attempts of all stages.
    pub attempts: u64,
    /// Attempts of stages that ask an author.
    pub asks: u64,
    /// Jobs that were tried at all.
    pub jobs: u64,
    /// Tokens in and out.
    pub tokens: [u64; 2],
    /// Stage and class of the failure that ended it, where it failed.
    pub failed: Option<(Stage, FailureClass)>,
}

/// Faults of a kind.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Tally {
    /// Those that were drawn for attempts which began.
    pub scheduled: u64,
    /// Those that were seen to strike: the others were too late, for example because another fault had ended the attempt.
    pub struck: u64,
}

impl ScenarioRow {
    /// Whether it was realised.
    #[must_use]
    pub fn succeeded(&self) -> bool {
        self.end == Some(ScenarioEnd::Judged(Verdict::Realised))
    }

    /// From its first attempt to its end, ms.
    #[must_use]
    pub fn span_ms(&self) -> Option<u64> {
        Some(self.ended_ms?.saturating_sub(self.begun_ms?))
    }
}

/// What must be zero.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Safety {
    /// Scenarios that were taken and never ended, and acknowledged results that are not in the store.
    pub lost: u64,
    /// Results and ends that there are twice.
    pub doubled: u64,
    /// Complaints of the checker.
    pub complaints: u64,
    /// The first of them.
    pub first: String,
}

impl Safety {
    /// Adds those of another batch.
    pub(crate) fn add(&mut self, other: &Self) {
        self.lost += other.lost;
        self.doubled += other.doubled;
        self.complaints += other.complaints;
        if self.first.is_empty() {
            self.first.clone_from(&other.first);
        }
    }

    /// Whether nothing was lost, doubled or complained of.
    #[must_use]
    pub const fn is_clean(&self) -> bool {
        self.lost == 0 && self.doubled == 0 && self.complaints == 0
    }
}

/// The ledger of a batch.
#[derive(Debug, Default)]
pub(crate) struct Ledger {
    pub(crate) attempts: Vec<AttemptRow>,
    pub(crate) scenarios: Vec<ScenarioRow>,
    /// How long it took until a struck job went on, with what struck it, ms.
    pub(crate) recoveries: Vec<(Kind, u64)>,
    pub(crate) safety: Safety,
    /// What was to strike, and what did.
    pub(crate) faults: BTreeMap<Kind, Tally>,
    places: BTreeMap<ScenarioId, usize>,
    /// The first answer of each question.
    first: BTreeMap<(usize, Stage), bool>,
    /// Jobs that something struck and that nobody took up since.
    struck: BTreeMap<JobKey, (u64, Kind)>,
    jobs: BTreeSet<JobKey>,
    /// Results that the orchestrator acknowledged.
    promised: BTreeMap<JobKey, u32>,
    ended: usize,
}

impl Ledger {
    /// A scenario was submitted.
    pub(crate) fn submitted(&mut self, id: ScenarioId, scenario: u32) {
        self.places.insert(id, self.scenarios.len());
        self.scenarios.push(ScenarioRow { scenario, ..ScenarioRow::default() });
    }

    /// The number of a scenario in the experiment.
    pub(crate) fn number(&self, id: &ScenarioId) -> Option<u32> {
        self.scenarios.get(*self.places.get(id)?).map(|row| row.scenario)
    }

    /// Whether every scenario has ended.
    pub(crate) fn is_done(&self) -> bool {
        self.ended >= self.scenarios.len()
    }

    /// An attempt begins; its place among the attempts.
    pub(crate) fn begun(&mut self, key: &JobKey, row: AttemptRow) -> usize {
        let (stage, now) = (key.stage, row.begun_ms);
        let new = self.jobs.insert(key.clone());
        let place = self.places.get(&key.scenario).copied();
        if let Some(scenario) = place.and_then(|place| self.scenarios.get_mut(place)) {
            scenario.begun_ms.get_or_insert(now);
            scenario.attempts += 1;
            scenario.asks += u64::from(AUTHORED.contains(&stage));
            scenario.jobs += u64::from(new);
            for (sum, tokens) in scenario.tokens.iter_mut().zip(row.tokens) {
                *sum += tokens;
            }
        }
        self.recovered(key, now);
        self.attempts.push(row);
        self.attempts.len() - 1
    }

    /// These are to strike an attempt that begins.
    pub(crate) fn due(&mut self, kinds: impl Iterator<Item = Kind>) {
        for kind in kinds {
            self.faults.entry(kind).or_default().scheduled += 1;
        }
    }

    /// A fault struck.
    pub(crate) fn hit(&mut self, kind: Kind) {
        self.faults.entry(kind).or_default().struck += 1;
    }

    /// Something struck a job; its recovery is measured from now on.
    pub(crate) fn struck(&mut self, key: &JobKey, kind: Kind, now: u64) {
        self.struck.entry(key.clone()).or_insert((now, kind));
    }

    /// A struck job goes on.
    pub(crate) fn recovered(&mut self, key: &JobKey, now: u64) {
        if let Some((since, kind)) = self.struck.remove(key) {
            self.recoveries.push((kind, now.saturating_sub(since)));
        }
    }

    /// An attempt was answered by its author, rightly or not; or not answered.
    pub(crate) fn answered(&mut self, key: &JobKey, right: Option<bool>) {
        let asked = AUTHORED.contains(&key.stage);
        if let (true, Some(right), Some(place)) = (asked, right, self.places.get(&key.scenario)) {
            self.first.entry((*place, key.stage)).or_insert(right);
        }
    }

    /// The orchestrator said to a worker what became of its report.
    pub(crate) fn recorded(
        &mut self,
        place: usize,
        (key, attempt): (&JobKey, u32),
        said: Recorded,
        is_result: bool,
        now: u64,
    ) {
        if let Some(row) = self.attempts.get_mut(place) {
            row.ended_ms = Some(now);
            row.recorded = Some(said);
        }
        if said == Recorded::Accepted && is_result {
            self.recovered(key, now);
            let before = self.promised.insert(key.clone(), attempt);
            self.safety.doubled += u64::from(before.is_some_and(|before| before != attempt));
        }
    }

    /// An attempt ended without a report.
    pub(crate) fn stopped(&mut self, place: usize, how: &'static str, now: u64) {
        if let Some(row) = self.attempts.get_mut(place) {
            row.ended_ms = Some(now);
            row.outcome = how;
        }
    }

    /// A scenario ended.
    pub(crate) fn ended(&mut self, id: &ScenarioId, end: ScenarioEnd, now: u64) {
        let place = self.places.get(id).copied();
        let Some(row) = place.and_then(|place| self.scenarios.get_mut(place)) else { return };
        if row.end.is_some() {
            self.safety.doubled += 1;
            return;
        }
        row.end = Some(end);
        row.ended_ms = Some(now);
        self.ended += 1;
    }

    /// A successor of the orchestrator shows how scenarios stand; what ended while its predecessor died was told to nobody.
    pub(crate) fn caught_up(&mut self, rows: &Rows, now: u64) {
        let open: Vec<(ScenarioId, ScenarioEnd)> = self
            .places
            .iter()
            .filter(|(_, place)| self.scenarios.get(**place).is_some_and(|row| row.end.is_none()))
            .filter_map(|(id, _)| Some((id.clone(), rows.scenario(id)?.end?)))
            .collect();
        for (id, end) in open {
            self.ended(&id, end, now);
        }
    }

    /// What the checker found.
    pub(crate) fn complained(&mut self, complaints: &[String]) {
        self.safety.complaints += complaints.len() as u64;
        if let (true, Some(first)) = (self.safety.first.is_empty(), complaints.first()) {
            self.safety.first.clone_from(first);
        }
    }

    /// Closes the books: what was promised is held against the rows.
    pub(crate) fn close(&mut self, rows: &Rows, asked: &[Stage]) {
        let gone = self.promised.iter().filter(|(key, attempt)| !rows.holds(key, **attempt)).count();
        let open = self.places.keys().filter(|id| rows.scenario(id).is_none_or(|row| row.end.is_none())).count();
        self.safety.lost += (gone + open) as u64;
        self.safety.doubled += rows.doubled;
        let failures = rows.failures();
        for (id, place) in &self.places {
            if let Some(row) = self.scenarios.get_mut(*place).filter(|row| row.end == Some(ScenarioEnd::Failed)) {
                row.failed = failures.get(id).copied();
            }
        }
        for (place, row) in self.scenarios.iter_mut().enumerate() {
            row.first_cut = asked.iter().all(|stage| self.first.get(&(place, *stage)) == Some(&true));
        }
    }
}
