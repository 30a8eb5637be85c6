//! What came of each cell: shares with intervals, tries, tokens, times, and the difference to the first policy pair by pair.

use std::collections::BTreeMap;

use socrates_stats::{Interval, Z_95, kaplan_meier, mcnemar, paired_difference, quantile, restricted_mean, wilson};

use crate::draws::float;
use crate::head::Step;
use crate::kind::Kind;
use crate::ledger::{AttemptRow, Ledger, Safety, ScenarioRow, Tally};
use crate::spec::{Cell, Spec};

/// One batch of one cell: what is played by itself, on any thread.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Unit {
    /// Number of the cell.
    pub cell: usize,
    /// Number of the batch within it.
    pub batch: u32,
}

/// Every unit of an experiment, in order.
#[must_use]
pub fn units(spec: &Spec, cells: &[Cell]) -> Vec<Unit> {
    cells.iter().flat_map(|cell| (0..spec.batches()).map(|batch| Unit { cell: cell.number, batch })).collect()
}

/// What came of a unit.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Played {
    /// Attempts in order of their beginning.
    pub attempts: Vec<AttemptRow>,
    /// Scenarios in order of their numbers.
    pub scenarios: Vec<ScenarioRow>,
    /// How long it took until a struck job went on, and what had struck it.
    pub recoveries: Vec<(Kind, u64)>,
    /// What must be zero.
    pub safety: Safety,
    /// What was to strike, and what did.
    pub faults: BTreeMap<Kind, Tally>,
}

/// Plays a unit: the same specification and unit give the same result, wherever and whenever.
#[must_use]
pub fn play(spec: &Spec, cell: &Cell, batch: u32, step: Step<'_>) -> Played {
    crate::batch::play(spec, cell, batch, step).into()
}

impl From<Ledger> for Played {
    fn from(ledger: Ledger) -> Self {
        let Ledger { attempts, scenarios, recoveries, safety, faults, .. } = ledger;
        Self { attempts, scenarios, recoveries, safety, faults }
    }
}

/// What came of a cell; units are added in order of their batches.
#[derive(Debug, Clone, PartialEq)]
pub struct CellResult {
    /// The cell.
    pub cell: Cell,
    /// Its scenarios.
    pub scenarios: Vec<ScenarioRow>,
    /// Times until a struck job went on, ms, and what had struck it.
    pub recoveries: Vec<(Kind, u64)>,
    /// What must be zero.
    pub safety: Safety,
    /// What was to strike, and what did.
    pub faults: BTreeMap<Kind, Tally>,
}

/// Figures of a cell.
#[derive(Debug, Clone, PartialEq)]
pub struct Figures {
    /// Scenarios that were realised.
    pub successes: usize,
    /// Their share.
    pub success: Interval,
    /// Scenarios whose first answers were all right.
    pub first_cuts: usize,
    /// Their share.
    pub first_cut: Interval,
    /// Attempts of all stages.
    pub attempts: u64,
    /// Jobs that were tried.
    pub jobs: u64,
    /// Attempts of stages that ask an author.
    pub asks: u64,
    /// Tokens in and out.
    pub tokens: [u64; 2],
    /// Median and 95th percentile of the time of realised scenarios, s; none where there is none.
    pub time_s: Option<(f64, f64)>,
    /// Median, 95th and 99th percentile of the time until a struck job went on, s.
    pub recovery_s: Option<[f64; 3]>,
}

/// A cell beside the cell of the first policy, scenario by scenario.
#[derive(Debug, Clone, PartialEq)]
pub struct Pairing {
    /// Realised only by the first policy.
    pub only_first: usize,
    /// Realised only by this one.
    pub only_this: usize,
    /// This share less that of the first policy.
    pub difference: Interval,
    /// p of McNemar's test.
    pub p: f64,
}

/// Means up to a limit that a cell shares with those which it is compared with: the most that any of their realised scenarios took.
/// A scenario that is not realised counts with the whole limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limited {
    /// Mean number of questions to authors until a scenario is realised.
    pub asks: f64,
    /// Its limit.
    pub asks_limit: f64,
    /// Mean time until a scenario is realised, s.
    pub time_s: f64,
    /// Its limit.
    pub time_limit_s: f64,
}

/// The limited means of every cell.
#[must_use]
pub fn limited(results: &[CellResult]) -> Vec<Limited> {
    let mut limits: BTreeMap<usize, (f64, f64)> = BTreeMap::new();
    for one in results {
        let limit = limits.entry(one.cell.base).or_default();
        for row in one.realised() {
            limit.0 = limit.0.max(float(row.asks));
            limit.1 = limit.1.max(row.span_ms().map_or(0.0, seconds));
        }
    }
    let of = |one: &CellResult| {
        let (asks_limit, time_limit_s) = limits.get(&one.cell.base).copied().unwrap_or_default();
        let asks = restricted_mean(&one.open_after_asks(), asks_limit);
        Limited { asks, asks_limit, time_s: restricted_mean(&one.open_after_s(), time_limit_s), time_limit_s }
    };
    results.iter().map(of).collect()
}

/// A share that nothing is known of.
const UNKNOWN: Interval = Interval { estimate: 0.0, low: 0.0, high: 1.0 };

/// Milliseconds as seconds.
pub(crate) fn seconds(ms: u64) -> f64 {
    float(ms) / 1_000.0
}

impl CellResult {
    /// Nothing yet.
    #[must_use]
    pub fn of(cell: Cell) -> Self {
        Self { cell, scenarios: Vec::new(), recoveries: Vec::new(), safety: Safety::default(), faults: BTreeMap::new() }
    }

    /// Adds what came of the next unit; its attempts are handed back.
    pub fn add(&mut self, played: Played) -> Vec<AttemptRow> {
        self.scenarios.extend(played.scenarios);
        self.recoveries.extend(played.recoveries);
        self.safety.add(&played.safety);
        for (kind, tally) in played.faults {
            let sum = self.faults.entry(kind).or_default();
            sum.scheduled += tally.scheduled;
            sum.struck += tally.struck;
        }
        played.attempts
    }

    /// Its figures.
    #[must_use]
    pub fn figures(&self) -> Figures {
        let count = |is: &dyn Fn(&ScenarioRow) -> bool| self.scenarios.iter().filter(|row| is(row)).count();
        let share = |count: usize| wilson(count, self.scenarios.len(), Z_95).unwrap_or(UNKNOWN);
        let sum = |of: &dyn Fn(&ScenarioRow) -> u64| self.scenarios.iter().map(of).sum::<u64>();
        let (successes, first_cuts) = (count(&ScenarioRow::succeeded), count(&|row| row.first_cut));
        let spans: Vec<f64> = self.realised().filter_map(ScenarioRow::span_ms).map(seconds).collect();
        let recoveries: Vec<f64> = self.recoveries.iter().map(|(_, ms)| seconds(*ms)).collect();
        let at = |values: &[f64], share: f64| quantile(values, share).ok();
        Figures {
            successes,
            success: share(successes),
            first_cuts,
            first_cut: share(first_cuts),
            attempts: sum(&|row| row.attempts),
            jobs: sum(&|row| row.jobs),
            asks: sum(&|row| row.asks),
            tokens: [sum(&|row| row.tokens[0]), sum(&|row| row.tokens[1])],
            time_s: at(&spans, 0.5).zip(at(&spans, 0.95)),
            recovery_s: match [0.5, 0.95, 0.99].map(|share| at(&recoveries, share)) {
                [Some(p50), Some(p95), Some(p99)] => Some([p50, p95, p99]),
                _ => None,
            },
        }
    }

    /// All faults together.
    #[must_use]
    pub fn tally(&self) -> Tally {
        let sum = |of: &dyn Fn(&Tally) -> u64| self.faults.values().map(of).sum();
        Tally { scheduled: sum(&|one| one.scheduled), struck: sum(&|one| one.struck) }
    }

    fn realised(&self) -> impl Iterator<Item = &ScenarioRow> {
        self.scenarios.iter().filter(|row| row.succeeded())
    }

    /// Share of scenarios that are not yet realised after so many asks of authors.
    #[must_use]
    pub fn open_after_asks(&self) -> Vec<(f64, f64)> {
        self.open(&|row| Some(float(row.asks)))
    }

    /// Share of scenarios that are not yet realised so many seconds after their first attempt began.
    #[must_use]
    pub fn open_after_s(&self) -> Vec<(f64, f64)> {
        self.open(&|row| row.span_ms().map(seconds))
    }

    /// A scenario that was given up is unfinished to the end: to leave it out from then on would take it for one that would have
    /// ended like the others.
    fn open(&self, time: &dyn Fn(&ScenarioRow) -> Option<f64>) -> Vec<(f64, f64)> {
        let watched: Vec<(f64, bool)> = self
            .scenarios
            .iter()
            .map(|row| match time(row).filter(|_| row.succeeded()) {
                Some(time) => (time, true),
                None => (f64::MAX, false),
            })
            .collect();
        kaplan_meier(&watched).unwrap_or_default()
    }

    /// It beside the result of the first policy.
    #[must_use]
    pub fn beside(&self, first: &Self) -> Option<Pairing> {
        let pairs = || self.scenarios.iter().zip(&first.scenarios);
        if pairs().any(|(this, first)| this.scenario != first.scenario) {
            return None;
        }
        let only = |this_wins: bool| {
            pairs().filter(|(this, first)| this.succeeded() == this_wins && first.succeeded() != this_wins).count()
        };
        let (only_this, only_first) = (only(true), only(false));
        let difference = paired_difference(pairs().count(), only_first, only_this, Z_95).ok()?;
        Some(Pairing { only_first, only_this, difference, p: mcnemar(only_first, only_this) })
    }
}

impl Figures {
    /// Attempts of a job, on average.
    #[must_use]
    pub fn amplification(&self) -> f64 {
        float(self.attempts) / float(self.jobs.max(1))
    }

    /// All tokens for each scenario that was realised; none where none was.
    #[must_use]
    pub fn tokens_per_success(&self) -> Option<f64> {
        let tokens = self.tokens.iter().sum();
        (self.successes > 0).then(|| float(tokens) / float(self.successes as u64))
    }

    /// Tokens that each further realised scenario takes, beside what the first policy takes; none where there is no further one.
    #[must_use]
    pub fn tokens_per_saved(&self, first: &Self) -> Option<f64> {
        let more = self.successes.checked_sub(first.successes).filter(|more| *more > 0)?;
        let all = |figures: &Self| float(figures.tokens.iter().sum());
        Some((all(self) - all(first)) / float(more as u64))
    }
}
