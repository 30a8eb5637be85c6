//! The cumulative logit model of ratings, with one random intercept per person.

use nalgebra::DVector;

use super::likelihood::Observed;
use super::optimize::minimum;
use super::{NoValue, dist, float};

/// Most different answers; a mean of very many items may have more, and is then too fine for this model.
const MAX_LEVELS: usize = 120;

/// An effect with its standard error and Wald's p.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Term {
    /// The effect on the log of the odds of a higher rating.
    pub effect: f64,
    /// Its standard error.
    pub error: f64,
    /// Two-sided p by Wald's z.
    pub p: f64,
}

/// A fitted model.
#[derive(Debug, Clone, PartialEq)]
pub struct Ordinal {
    /// Thresholds between neighboring answers, logit.
    pub thresholds: Vec<f64>,
    /// An effect for each column of the design.
    pub terms: Vec<Term>,
    /// Standard deviation of the people's intercepts, logit; 0 in the model without.
    pub sigma: f64,
    /// Log likelihood.
    pub log_likelihood: f64,
}

/// Fits `logit P(rating ≤ level j) = θ_j − x·β − u_person` to ratings with their person and their columns `x`; with
/// `random = false` all `u` are 0. The intercepts are integrated out by sums over evenly spaced points around each person's mode, exact
/// to nine digits; `clmm` of the R package `ordinal` comes to them with many nodes (Christensen 2022).
///
/// # Errors
/// Fewer than two different answers, too many, or a likelihood without a maximum.
#[expect(clippy::indexing_slicing, reason = "indices run over the sizes of the matrices that are made here")]
pub fn ordinal(rows: &[(usize, f64, Vec<f64>)], random: bool) -> Result<Ordinal, NoValue> {
    let mut answers: Vec<f64> = rows.iter().map(|(_, answer, _)| libm::round(answer * 1e6) / 1e6).collect();
    let coded = answers.clone();
    answers.sort_by(f64::total_cmp);
    answers.dedup_by(|a, b| a.total_cmp(b).is_eq());
    if answers.len() < 2 {
        return Err(NoValue::Constant);
    }
    if answers.len() > MAX_LEVELS || rows.len() < answers.len() + 4 {
        return Err(NoValue::TooFew {
            what: "scores for so many different values",
            found: rows.len(),
            needed: answers.len() + 4,
        });
    }
    let people_count = rows.iter().map(|(person, _, _)| person + 1).max().unwrap_or(0);
    let mut people = vec![Vec::new(); people_count];
    for ((person, _, columns), answer) in rows.iter().zip(&coded) {
        let level = answers.partition_point(|one| one < answer);
        if let Some(of) = people.get_mut(*person) {
            of.push((level, columns.as_slice()));
        }
    }
    let columns = rows.first().map_or(0, |(_, _, columns)| columns.len());
    let data = Observed { people, levels: answers.len(), columns };
    let cuts = data.levels - 1;
    // Where nothing has an effect, thresholds are the logits of the cumulated shares.
    let start: Vec<f64> = (1..data.levels)
        .map(|level| {
            let below = coded.iter().filter(|one| answers.get(level).is_some_and(|at| *one < at)).count();
            let share = float(below) / float(coded.len());
            libm::log(share / (1.0 - share))
        })
        .collect();
    let free = cuts + columns + usize::from(random);
    let start =
        DVector::from_fn(free, |i, _| start.get(i).copied().unwrap_or(if i < cuts + columns { 0.0 } else { 1.0 }));
    let (at, here) = minimum(&|at| data.minus_log_likelihood(at, random), start).ok_or(NoValue::NoMaximum)?;
    let sigma = if random { at[free - 1].abs() } else { 0.0 };
    // At a variance of 0 the likelihood is flat in it: errors are then those of the model without.
    let flat = random && sigma < 1e-3;
    let curved =
        if flat { data.minus_log_likelihood(&at.rows(0, free - 1).into_owned(), false).bend } else { here.bend };
    let covariance = curved.cholesky().ok_or(NoValue::NoMaximum)?.inverse();
    let terms = (cuts..cuts + columns)
        .map(|i| {
            let (effect, error) = (at[i], libm::sqrt(covariance[(i, i)]));
            Term { effect, error, p: dist::normal_two_sided(effect / error) }
        })
        .collect::<Vec<_>>();
    if terms.iter().any(|term| term.effect.abs() > 15.0 || !term.error.is_finite()) {
        return Err(NoValue::NoMaximum);
    }
    let thresholds = at.iter().take(cuts).copied().collect();
    Ok(Ordinal { thresholds, terms, sigma, log_likelihood: -here.value })
}
