//! A cell on real processes beside the same cell in the simulator: whether what it foretells is what is measured.

use socrates_stats::Interval;

use crate::results::CellResult;
use crate::tables::{of_cell, real};

/// Columns of `predictions.csv`: what was measured on processes, and what the simulator says of the same cell.
pub const PREDICTIONS: &str = "cell,workload,fault,rate,tries,policy,scenarios,same_end,realised,realised_low,realised_high,simulated_realised,attempts_a_job,simulated_attempts_a_job,faults_struck,simulated_faults_struck,time_p50_s,simulated_time_p50_s,time_p95_s,simulated_time_p95_s,recovery_p50_s,simulated_recovery_p50_s,recovery_p95_s,simulated_recovery_p95_s";

/// A figure as it was measured, and as it was foretold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair<T> {
    /// On processes.
    pub measured: T,
    /// In the simulator.
    pub simulated: T,
}

/// A cell beside itself.
#[derive(Debug, Clone, PartialEq)]
pub struct Beside {
    /// Scenarios that ended the same way in both.
    pub same: usize,
    /// Scenarios.
    pub of: usize,
    /// Share of realised ones.
    pub success: Pair<Interval>,
    /// Attempts of a job.
    pub amplification: Pair<f64>,
    /// Faults that struck.
    pub struck: Pair<u64>,
    /// Median and 95th percentile of the time of realised scenarios, s.
    pub time_s: Pair<Option<[f64; 2]>>,
    /// Median and 95th percentile of the time until a struck job went on, s.
    pub recovery_s: Pair<Option<[f64; 2]>>,
}

impl Beside {
    /// Of the same cell.
    #[must_use]
    pub fn of(measured: &CellResult, simulated: &CellResult) -> Self {
        let ends = measured.scenarios.iter().zip(&simulated.scenarios);
        let same = ends.filter(|(one, other)| one.scenario == other.scenario && one.end == other.end).count();
        let (here, there) = (measured.figures(), simulated.figures());
        Self {
            same,
            of: measured.scenarios.len(),
            success: Pair { measured: here.success, simulated: there.success },
            amplification: Pair { measured: here.amplification(), simulated: there.amplification() },
            struck: Pair { measured: measured.tally().struck, simulated: simulated.tally().struck },
            time_s: Pair {
                measured: here.time_s.map(|(p50, p95)| [p50, p95]),
                simulated: there.time_s.map(|(p50, p95)| [p50, p95]),
            },
            recovery_s: Pair {
                measured: here.recovery_s.map(|[p50, p95, _]| [p50, p95]),
                simulated: there.recovery_s.map(|[p50, p95, _]| [p50, p95]),
            },
        }
    }

    /// A row of `predictions.csv`.
    #[must_use]
    pub fn row(&self, measured: &CellResult) -> Vec<String> {
        let at = |times: Option<[f64; 2]>, place: usize| {
            times.and_then(|times| times.get(place).copied()).map_or_else(String::new, real)
        };
        let mut row = of_cell(&measured.cell).to_vec();
        row.extend([
            self.of.to_string(),
            self.same.to_string(),
            real(self.success.measured.estimate),
            real(self.success.measured.low),
            real(self.success.measured.high),
            real(self.success.simulated.estimate),
            real(self.amplification.measured),
            real(self.amplification.simulated),
            self.struck.measured.to_string(),
            self.struck.simulated.to_string(),
        ]);
        for times in [self.time_s, self.recovery_s] {
            for place in 0..2 {
                row.extend([at(times.measured, place), at(times.simulated, place)]);
            }
        }
        row
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laws::{played, spec};

    #[test]
    fn a_cell_beside_itself_is_the_same_and_beside_another_it_is_not() {
        let spec = spec(serde_json::json!({
            "title": "beside", "scenarios": 60, "policies": ["none", "jitter"], "tries": [4],
            "fault": [{ "kinds": ["worker_kill"], "rates": [0.2] }],
        }));
        let results = played(&spec);
        let (none, jitter) = (&results[0].0, &results[1].0);
        let same = Beside::of(jitter, jitter);
        assert_eq!((same.same, same.of, same.struck.measured), (60, 60, same.struck.simulated));
        assert!(same.struck.measured > 20);
        let other = Beside::of(none, jitter);
        assert!(other.same < 50 && other.success.measured.high < other.success.simulated.estimate, "{other:?}");
        assert_eq!(other.row(none).len(), PREDICTIONS.split(',').count());
    }
}
