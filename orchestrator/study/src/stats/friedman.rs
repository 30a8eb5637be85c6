//! Friedman's test of conditions that everybody judged.

use std::collections::BTreeMap;

use nalgebra::DMatrix;

use super::rank::midranks;
use super::{NoValue, dist, float};

/// Largest number of sums of ranks that the exact distribution is followed over.
const MAX_STATES: usize = 60_000;

/// Result of Friedman's test.
#[derive(Debug, Clone, PartialEq)]
pub struct Friedman {
    /// The statistic, corrected for ties.
    pub chi2: f64,
    /// Degrees of freedom.
    pub df: usize,
    /// p by chi square.
    pub p: f64,
    /// p by all arrangements of each person's ranks; none where these are too many.
    pub p_exact: Option<f64>,
    /// Kendall's W, 0 to 1.
    pub w: f64,
}

/// Friedman's test of a table of people (rows) by conditions (columns), with ties, and Kendall's W (Friedman 1937; Conover 1999,
/// section 5.8). The exact p is conditional on the ties of each person.
///
/// # Errors
/// Fewer than two people or conditions; nobody made any difference.
pub fn friedman(table: &DMatrix<f64>) -> Result<Friedman, NoValue> {
    test(table, true)
}

/// The same by χ² alone.
///
/// # Errors
/// As [`friedman`].
pub fn friedman_by_chi2(table: &DMatrix<f64>) -> Result<Friedman, NoValue> {
    test(table, false)
}

fn test(table: &DMatrix<f64>, count_out: bool) -> Result<Friedman, NoValue> {
    let (n, k) = table.shape();
    if n < 2 || k < 2 {
        return Err(NoValue::TooFew { what: "people or conditions", found: n.min(k), needed: 2 });
    }
    let mut rows = Vec::with_capacity(n);
    let mut ties = 0.0;
    let mut sums = vec![0.0; k];
    for row in table.row_iter() {
        let (ranks, groups) = midranks(&row.iter().copied().collect::<Vec<_>>());
        ties += groups.iter().map(|t| float(t * t * t) - float(*t)).sum::<f64>();
        sums.iter_mut().zip(&ranks).for_each(|(sum, rank)| *sum += rank);
        rows.push(ranks);
    }
    let (nf, kf) = (float(n), float(k));
    let spread = 1.0 - ties / (nf * kf * (kf * kf - 1.0));
    if spread < 1e-12 {
        return Err(NoValue::Constant);
    }
    let middle = nf * (kf + 1.0) / 2.0;
    let squares = |sums: &mut dyn Iterator<Item = f64>| sums.map(|sum| (sum - middle) * (sum - middle)).sum::<f64>();
    let scale = 12.0 / (nf * kf * (kf + 1.0) * spread);
    let found = squares(&mut sums.iter().copied());
    let chi2 = scale * found;
    let is_extreme = |state: &[i32]| squares(&mut state.iter().map(|twice| f64::from(*twice) / 2.0)) >= found - 1e-9;
    let p_exact = if count_out { exact(&rows, &is_extreme) } else { None };
    Ok(Friedman { chi2, df: k - 1, p: dist::chi_upper(chi2, kf - 1.0), p_exact, w: chi2 / (nf * (kf - 1.0)) })
}

/// Share of all arrangements of each row's ranks whose sums are as extreme; sums are kept twice, as whole numbers.
fn exact(rows: &[Vec<f64>], is_extreme: &dyn Fn(&[i32]) -> bool) -> Option<f64> {
    let k = rows.first()?.len();
    if k > 6 {
        return None;
    }
    let mut states: BTreeMap<Vec<i32>, f64> = BTreeMap::from([(vec![0; k], 1.0)]);
    for row in rows {
        #[expect(clippy::cast_possible_truncation, reason = "twice a rank of at most six is a small whole number")]
        let twice: Vec<i32> = row.iter().map(|rank| libm::round(rank * 2.0) as i32).collect();
        let arrangements = arrangements(&twice);
        let share = 1.0 / float(arrangements.len());
        let mut next: BTreeMap<Vec<i32>, f64> = BTreeMap::new();
        for (state, weight) in &states {
            for order in &arrangements {
                let sum: Vec<i32> = state.iter().zip(order).map(|(a, b)| a + b).collect();
                *next.entry(sum).or_insert(0.0) += weight * share;
            }
        }
        states = next;
        if states.len() > MAX_STATES / k.pow(2) {
            return None;
        }
    }
    Some(states.iter().filter(|(state, _)| is_extreme(state)).map(|(_, weight)| weight).sum::<f64>().min(1.0))
}

/// All different orders of a row.
fn arrangements(row: &[i32]) -> Vec<Vec<i32>> {
    let mut found = vec![Vec::new()];
    for place in 0..row.len() {
        let mut longer = Vec::new();
        for begun in &found {
            let begun: &Vec<i32> = begun;
            let mut left = row.to_vec();
            for used in begun {
                if let Some(at) = left.iter().position(|one| one == used) {
                    left.swap_remove(at);
                }
            }
            left.sort_unstable();
            left.dedup();
            longer.extend(left.into_iter().map(|one| [begun.as_slice(), &[one]].concat()));
        }
        debug_assert!(longer.iter().all(|order| order.len() == place + 1));
        found = longer;
    }
    found
}
