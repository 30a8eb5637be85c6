//! How many people a study needs, what they cost, and what fewer of them cannot show.

use nalgebra::DMatrix;
use serde::Serialize;

use crate::design::{Design, williams};
use crate::kit::orders::films_each;
use crate::simulate::Draws;
use crate::stats::{Zeros, float, friedman_by_chi2, holm, wilcoxon};

/// Thresholds between the five answers, logit: evenly spread, as none are published with the table of power that tests compare with.
const THRESHOLDS: [f64; 4] = [-3.0, -1.0, 1.0, 3.0];
/// Standard deviation between people, logit: that of a cumulative mixed model of public ratings of robots' runs.
pub const BETWEEN: f64 = 1.63;
/// Simulated studies for each figure.
pub const STUDIES: usize = 2000;

/// A question about power.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ask {
    /// People per scenario.
    pub people: usize,
    /// Planners.
    pub planners: usize,
    /// Effect of the best planner against the first, log odds; the last has half of it, and all others none.
    pub effect: f64,
    /// Probability of a false alarm.
    pub alpha: f64,
    /// Simulated studies.
    pub studies: usize,
    /// Seed.
    pub seed: u64,
}

/// How often a study finds a planted effect on one five-point item.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Power {
    /// Share of studies in which Friedman's test rejects.
    pub friedman: f64,
    /// Share in which the signed-rank test of the best planner against the first rejects, by Holm over all pairs.
    pub pair: f64,
}

/// Power by simulation: answers by the cumulative mixed model, tests as in the analysis.
#[must_use]
pub fn power(ask: Ask) -> Power {
    let mut draws = Draws::new(ask.seed);
    let effects: Vec<f64> = (0..ask.planners)
        .map(|at| {
            if at == 1 {
                ask.effect
            } else if at + 1 == ask.planners && at > 1 {
                ask.effect / 2.0
            } else {
                0.0
            }
        })
        .collect();
    let (mut all, mut pair) = (0, 0);
    for _ in 0..ask.studies {
        let mut flat = Vec::with_capacity(ask.people * ask.planners);
        for _ in 0..ask.people {
            let own = draws.normal() * BETWEEN;
            for effect in &effects {
                let latent = own + effect + draws.logistic();
                flat.push(1.0 + float(THRESHOLDS.iter().filter(|cut| latent > **cut).count()));
            }
        }
        let table = DMatrix::from_row_slice(ask.people, ask.planners, &flat);
        all += usize::from(friedman_p(&table) < ask.alpha);
        pair += usize::from(first_pair(&table) < ask.alpha);
    }
    let share = |count: usize| float(count) / float(ask.studies.max(1));
    Power { friedman: share(all), pair: share(pair) }
}

/// p of Friedman's test by χ²; 1 where nobody made a difference. The exact distribution of thousands of studies would take minutes.
fn friedman_p(table: &DMatrix<f64>) -> f64 {
    friedman_by_chi2(table).map_or(1.0, |of| of.p)
}

/// p by Holm of the second planner against the first.
fn first_pair(table: &DMatrix<f64>) -> f64 {
    let mut p = Vec::new();
    for later in 0..table.ncols() {
        for earlier in 0..later {
            let less: Vec<f64> =
                table.column(later).iter().zip(table.column(earlier).iter()).map(|(a, b)| a - b).collect();
            p.push(wilcoxon(&less, Zeros::Pratt, 0.95).map_or(1.0, |of| of.p));
        }
    }
    holm(&p).first().copied().unwrap_or(1.0)
}

/// Smallest effect, log odds to one decimal, that is found in 80 of 100 studies by the test of pairs; none up to 3.
#[must_use]
pub fn smallest_found(ask: Ask) -> Option<f64> {
    let (mut low, mut high) = (0_u32, 31_u32);
    while high - low > 1 {
        let middle = u32::midpoint(low, high);
        let found = power(Ask { effect: f64::from(middle) / 10.0, ..ask }).pair >= 0.8;
        if found { high = middle } else { low = middle }
    }
    (high <= 30).then(|| f64::from(high) / 10.0)
}

/// Raters of a film for a reliability of their mean, from that of one of them (Spearman 1910; Brown 1910): `k = r(1−ρ)/(ρ(1−r))`.
#[must_use]
pub fn raters(one: f64, mean: f64) -> f64 {
    mean * (1.0 - one) / (one * (1.0 - mean))
}

/// Orders, and the numbers of people around `people` that show all of them equally often.
#[must_use]
pub fn orders(planners: usize, people: usize) -> (usize, usize, usize) {
    let orders = williams(planners).len().max(1);
    (orders, people / orders * orders, people.div_ceil(orders) * orders)
}

/// What a study costs: minutes for each person and what is paid to all, in an hourly rate's currency.
#[must_use]
pub fn pay(films: usize, length_s: f64, items: usize, people: usize, hourly: f64) -> (f64, f64) {
    // Consent, instructions, checks and questions about the person; then each film and about 5 s for an item.
    let minutes = 4.0 + float(films) * (length_s + 5.0 * float(items)) / 60.0;
    (minutes, float(people) * hourly * minutes / 60.0)
}

/// Minutes that a study takes each person; none where no film has a length.
#[must_use]
pub fn minutes(design: &Design) -> Option<f64> {
    let lengths: Vec<f64> = design.films.iter().filter_map(|film| film.length_s).collect();
    let length_s = socrates_stats::mean(&lengths).ok()?;
    Some(pay(films_each(design), length_s, design.codes().count(), 1, 0.0).0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ask(people: usize, effect: f64) -> Ask {
        Ask { people, planners: 3, effect, alpha: 0.05, studies: STUDIES, seed: 1 }
    }

    #[test]
    fn power_is_that_of_the_published_table() {
        let table = [
            (0.5, [(24, 0.12, 0.07), (42, 0.17, 0.12), (60, 0.21, 0.16), (84, 0.29, 0.23), (120, 0.42, 0.39)]),
            (0.8, [(24, 0.21, 0.14), (42, 0.33, 0.27), (60, 0.50, 0.44), (84, 0.63, 0.62), (120, 0.80, 0.81)]),
            (1.0, [(24, 0.31, 0.23), (42, 0.51, 0.47), (60, 0.69, 0.65), (84, 0.85, 0.83), (120, 0.95, 0.96)]),
            (1.4, [(24, 0.56, 0.49), (42, 0.83, 0.82), (60, 0.95, 0.95), (84, 0.99, 0.99), (120, 1.0, 1.0)]),
        ];
        // The table rests on 600 studies a figure, whose standard error reaches 0.02: one of its 40 figures lies farther off.
        let mut far = Vec::new();
        for (effect, row) in table {
            for (people, all, pair) in row {
                let found = power(ask(people, effect));
                for (found, told) in [(found.friedman, all), (found.pair, pair)] {
                    assert!((found - told).abs() <= 0.05, "{effect} {people}: {found} for {told}");
                    if (found - told).abs() > 0.03 {
                        far.push(format!("{effect} {people}: {found} for {told}"));
                    }
                }
            }
        }
        assert!(far.len() <= 2, "{far:#?}");
    }

    #[test]
    fn raters_orders_and_pay() {
        assert!((raters(0.25, 0.8) - 12.0).abs() < 1e-9);
        assert_eq!((orders(3, 40), orders(3, 42), orders(4, 42)), ((6, 36, 42), (6, 42, 42), (4, 40, 44)));
        let (minutes, all) = pay(3, 20.0, 8, 42, 9.0);
        assert!((minutes - 7.0).abs() < 1e-9 && (all - 44.1).abs() < 1e-9);
    }
}
