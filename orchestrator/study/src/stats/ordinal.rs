//! The cumulative logit model of ratings, with one random intercept per person.

use nalgebra::DVector;

use super::optimize::{Sloped, curvature, minimum};
use super::quadrature::gauss_hermite;
use super::{NoValue, dist, float};

/// Nodes of the quadrature. The slope is that of the integral and the value that of the sum over the nodes; with ten nodes and people who
/// differ by more than 2 logits they disagree in the fourth digit.
const NODES: usize = 30;
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

/// Observations sorted for the fit.
struct Data<'d> {
    /// Per person, each answer's level from 0 and its columns of the design.
    people: Vec<Vec<(usize, &'d [f64])>>,
    levels: usize,
    columns: usize,
    rule: Vec<(f64, f64)>,
}

/// Fits `logit P(rating ≤ level j) = θ_j − x·β − u_person` to ratings with their person and their columns `x`; with
/// `random = false` all `u` are 0. The intercepts are integrated out by adaptive Gauss–Hermite quadrature with thirty nodes (Pinheiro
/// and Bates 1995), as `clmm(nAGQ = 30)` of the R package `ordinal` does (Christensen 2022).
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
    let data = Data { people, levels: answers.len(), columns, rule: gauss_hermite(NODES) };
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
    let target = |at: &DVector<f64>| data.minus_log_likelihood(at, random);
    let found =
        minimum(&|by_gaps| through_gaps(by_gaps, cuts, &target), gaps(&start, cuts)).ok_or(NoValue::NoMaximum)?;
    let at = polished(&target, thresholds_of(&found, cuts));
    let sigma = if random { at[free - 1].abs() } else { 0.0 };
    // At a variance of 0 the likelihood is flat in it: errors are then those of the model without.
    let flat = random && sigma < 1e-3;
    let (inner, of) = if flat { (at.rows(0, free - 1).into_owned(), false) } else { (at.clone(), random) };
    let curved = curvature(&|x| data.minus_log_likelihood(x, of), &inner);
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
    Ok(Ordinal { thresholds, terms, sigma, log_likelihood: -target(&at).0 })
}

/// Thresholds as the first of them and the logs of their distances, so that no step can put them out of order.
fn gaps(at: &DVector<f64>, cuts: usize) -> DVector<f64> {
    let mut found = at.clone();
    let pairs = at.as_slice().windows(2).take(cuts - 1);
    found.iter_mut().skip(1).zip(pairs).for_each(|(gap, pair)| {
        if let [below, above] = pair {
            *gap = libm::log(above - below);
        }
    });
    found
}

/// The reverse of [`gaps`].
fn thresholds_of(by_gaps: &DVector<f64>, cuts: usize) -> DVector<f64> {
    let mut found = by_gaps.clone();
    let mut last = by_gaps.iter().next().copied().unwrap_or(0.0);
    found.iter_mut().take(cuts).skip(1).for_each(|gap| {
        last += libm::exp(*gap);
        *gap = last;
    });
    found
}

/// A function of thresholds, and its slope, in distances.
fn through_gaps(by_gaps: &DVector<f64>, cuts: usize, of: &Sloped<'_>) -> (f64, DVector<f64>) {
    let (value, mut slope) = of(&thresholds_of(by_gaps, cuts));
    // A distance moves its own threshold and all above it.
    let mut above = 0.0;
    for (place, (slope, gap)) in
        slope.iter_mut().zip(by_gaps.iter()).take(cuts).enumerate().collect::<Vec<_>>().into_iter().rev()
    {
        above += *slope;
        *slope = if place == 0 { above } else { above * libm::exp(*gap) };
    }
    (value, slope)
}

/// Newton's steps at a minimum, as long as they lower the slope.
fn polished(of: &Sloped<'_>, mut at: DVector<f64>) -> DVector<f64> {
    for _ in 0..4 {
        let slope = of(&at).1;
        let Some(solved) = curvature(of, &at).cholesky() else { break };
        let next = &at - solved.solve(&slope);
        let (value, there) = of(&next);
        if !value.is_finite() || there.amax() >= slope.amax() {
            break;
        }
        at = next;
    }
    at
}

/// `1 / (1 + exp(−x))`, and 0 or 1 far out.
fn logistic(x: f64) -> f64 {
    1.0 / (1.0 + libm::exp(-x))
}

/// A person's answer: level from 0, its lower and upper threshold less its fixed effects, and its columns of the design.
struct Answer<'d> {
    level: usize,
    lower: f64,
    upper: f64,
    columns: &'d [f64],
}

impl Data<'_> {
    /// Minus the log likelihood and its slope in thresholds, effects and `sigma`.
    fn minus_log_likelihood(&self, at: &DVector<f64>, random: bool) -> (f64, DVector<f64>) {
        let (cuts, at) = (self.levels - 1, at.as_slice());
        let mut slope = DVector::zeros(at.len());
        let cut = |level: usize| at.get(level).copied().unwrap_or(f64::INFINITY);
        if (1..cuts).any(|level| cut(level) <= cut(level - 1)) {
            return (f64::INFINITY, slope);
        }
        let sigma = if random { at.last().copied().unwrap_or(0.0) } else { 0.0 };
        let mut total = 0.0;
        for person in self.people.iter().filter(|person| !person.is_empty()) {
            let answers: Vec<Answer<'_>> = person
                .iter()
                .map(|(level, columns)| {
                    let eta: f64 = columns.iter().zip(at.iter().skip(cuts)).map(|(x, effect)| x * effect).sum();
                    let upper = if *level < cuts { cut(*level) - eta } else { f64::INFINITY };
                    let lower = if *level > 0 { cut(*level - 1) - eta } else { f64::NEG_INFINITY };
                    Answer { level: *level, lower, upper, columns }
                })
                .collect();
            let of = if random {
                self.integrated(&answers, sigma, &mut slope)
            } else {
                self.add_slope(&answers, (0.0, 0.0), 1.0, &mut slope);
                log_of(&answers, 0.0)
            };
            if !of.is_finite() {
                return (f64::INFINITY, slope);
            }
            total -= of;
        }
        (total, -slope)
    }

    /// Log of the integral of a person's likelihood over their intercept, which is `sigma` times a standard normal value `v`. The
    /// slope is the mean of the slopes at the nodes, each by its share of the integral.
    fn integrated(&self, answers: &[Answer<'_>], sigma: f64, slope: &mut DVector<f64>) -> f64 {
        let (mut mode, mut bend) = (0.0, 1.0);
        // The slope falls everywhere, and each answer pulls by at most `sigma`, which bounds the mode: where a step leaves the interval
        // that holds the zero, or is not half as long as the one before, the interval is halved instead.
        let bound = sigma.abs() * float(answers.len()) + 1.0;
        let (mut low, mut high, mut before) = (-bound, bound, 2.0 * bound);
        for _ in 0..100 {
            // Of log likelihood − v²/2: slope and bend in v.
            let (mut first, mut second) = (-mode, -1.0);
            for answer in answers {
                let (a, b) = (logistic(answer.upper - sigma * mode), logistic(answer.lower - sigma * mode));
                // d/dx log(F(u − x) − F(l − x)) = F(u − x) + F(l − x) − 1 for the logistic F.
                first += sigma * (a + b - 1.0);
                second -= sigma * sigma * (a * (1.0 - a) + b * (1.0 - b));
            }
            bend = -second;
            if first > 0.0 {
                low = mode
            } else {
                high = mode
            }
            let step = first / bend;
            if libm::fabs(step) < 1e-11 {
                break;
            }
            let next = mode + step;
            let is_shorter = libm::fabs(step) < 0.5 * before;
            let next = if is_shorter && next > low && next < high { next } else { 0.5 * (low + high) };
            before = libm::fabs(next - mode);
            mode = next;
        }
        let wide = libm::sqrt(2.0 / bend);
        let nodes: Vec<(f64, f64)> = self
            .rule
            .iter()
            .map(|(x, w)| {
                let v = mode + wide * x;
                (v, libm::log(*w) + x * x - 0.5 * v * v + log_of(answers, sigma * v))
            })
            .collect();
        let most = nodes.iter().map(|(_, log)| *log).fold(f64::NEG_INFINITY, f64::max);
        let sum: f64 = nodes.iter().map(|(_, log)| libm::exp(log - most)).sum();
        for (v, log) in &nodes {
            self.add_slope(answers, (sigma, *v), libm::exp(log - most) / sum, slope);
        }
        most + libm::log(sum) + libm::log(wide) - 0.5 * libm::log(2.0 * std::f64::consts::PI)
    }

    /// Adds the slope of a person's log likelihood at an intercept `sigma · v`, times its weight.
    fn add_slope(&self, answers: &[Answer<'_>], (sigma, v): (f64, f64), weight: f64, slope: &mut DVector<f64>) {
        let cuts = self.levels - 1;
        let slope = slope.as_mut_slice();
        let has_sigma = slope.len() > cuts + self.columns;
        let mut add = |place: usize, value: f64| {
            if let Some(cell) = slope.get_mut(place) {
                *cell += weight * value;
            }
        };
        for answer in answers {
            let (upper, lower) = (answer.upper - sigma * v, answer.lower - sigma * v);
            let (a, b) = (logistic(upper), logistic(lower));
            let share = between(lower, upper);
            if answer.level < cuts {
                add(answer.level, a * (1.0 - a) / share);
            }
            if answer.level > 0 {
                add(answer.level - 1, -b * (1.0 - b) / share);
            }
            let shift = a + b - 1.0;
            answer.columns.iter().enumerate().for_each(|(column, x)| add(cuts + column, shift * x));
            if has_sigma {
                add(cuts + self.columns, shift * v);
            }
        }
    }
}

/// `F(upper) − F(lower)` of the logistic F, without cancellation far out.
fn between(lower: f64, upper: f64) -> f64 {
    if lower > 0.0 { logistic(-lower) - logistic(-upper) } else { logistic(upper) - logistic(lower) }
}

/// Log likelihood of a person's answers at an intercept.
fn log_of(answers: &[Answer<'_>], intercept: f64) -> f64 {
    answers.iter().map(|one| libm::log(between(one.lower - intercept, one.upper - intercept))).sum()
}
