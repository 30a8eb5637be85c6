//! The likelihood of the cumulative logit model with its first and second derivatives.

use nalgebra::{DMatrix, DVector};

use super::float;
use super::optimize::Bent;

/// Distance of the points of a sum over intercepts: as a share of the likelihood's width, which makes `exp(−40)` for a normal one, and
/// times `sigma`, which makes `exp(−35)` for the poles.
const OF_WIDTH: f64 = 0.7;
const OF_POLES: f64 = 0.56;
/// Points whose log likelihood lies so far below the highest add nothing.
const FAR: f64 = 37.0;
/// Most points to either side.
const MOST: u32 = 2000;
/// Largest `sigma`, logits: people who differ more have answers that fit no size of it best.
const MOST_SIGMA: f64 = 50.0;

/// Observations as the likelihood takes them. Variables stand in the order of thresholds, effects and `sigma`.
pub(super) struct Observed<'d> {
    /// Per person, each answer's level from 0 and its columns of the design.
    pub(super) people: Vec<Vec<(usize, &'d [f64])>>,
    /// Different answers.
    pub(super) levels: usize,
    /// Columns of the design.
    pub(super) columns: usize,
}

/// A person's answer: level from 0, its lower and upper threshold less its fixed effects, and its columns of the design.
struct Answer<'d> {
    level: usize,
    lower: f64,
    upper: f64,
    columns: &'d [f64],
}

/// The logistic F at both ends of an answer, with `1 − F`, and the share between them.
#[derive(Clone, Copy, Default)]
struct Ends {
    upper: (f64, f64),
    lower: (f64, f64),
    share: f64,
}

impl Ends {
    fn of(answer: &Answer<'_>, intercept: f64) -> Self {
        let lower = logistic(answer.lower - intercept);
        let upper = logistic(answer.upper - intercept);
        // Without cancellation far out.
        let share = if lower.0 > 0.5 { lower.1 - upper.1 } else { upper.0 - lower.0 };
        Self { upper, lower, share }
    }
}

/// `1 / (1 + exp(−x))` and `1 / (1 + exp(x))`.
fn logistic(x: f64) -> (f64, f64) {
    let small = libm::exp(-libm::fabs(x));
    let (far, near) = (1.0 / (1.0 + small), small / (1.0 + small));
    if x > 0.0 { (far, near) } else { (near, far) }
}

/// Where a person's likelihood is summed: `v` with the log of the likelihood there, and the ends of each answer, point after point.
struct Points {
    at: Vec<(f64, f64)>,
    ends: Vec<Ends>,
}

impl Points {
    /// The one point of a model without intercepts.
    fn one(answers: &[Answer<'_>]) -> Self {
        let mut found = Self { at: Vec::new(), ends: Vec::new() };
        found.push(answers, (0.0, 0.0), 0.0);
        found
    }

    /// Evenly spaced points around the mode.
    fn of(answers: &[Answer<'_>], sigma: f64) -> Self {
        let mut found = Self { at: Vec::new(), ends: Vec::new() };
        let (mode, step) = spread(answers, sigma);
        let all = libm::log(step) - 0.5 * libm::log(2.0 * std::f64::consts::PI);
        let mut add = |v: f64| found.push(answers, (sigma, v), all - 0.5 * v * v);
        let top = add(mode);
        for side in [-step, step] {
            // The log likelihood has one peak.
            for number in 1..MOST {
                if add(mode + side * f64::from(number)) < top - FAR {
                    break;
                }
            }
        }
        found
    }

    fn push(&mut self, answers: &[Answer<'_>], (sigma, v): (f64, f64), log: f64) -> f64 {
        let begin = self.ends.len();
        self.ends.extend(answers.iter().map(|answer| Ends::of(answer, sigma * v)));
        let log = log + self.ends.iter().skip(begin).map(|end| libm::log(end.share)).sum::<f64>();
        self.at.push((v, log));
        log
    }
}

impl Observed<'_> {
    /// Minus the log likelihood with its slope and its second derivatives; where not `random`, all intercepts are 0 and no variable
    /// is `sigma`.
    pub(super) fn minus_log_likelihood(&self, at: &DVector<f64>, random: bool) -> Bent {
        let (cuts, n, at) = (self.levels - 1, at.len(), at.as_slice());
        let mut total = Bent { value: 0.0, slope: DVector::zeros(n), bend: DMatrix::zeros(n, n) };
        let cut = |level: usize| at.get(level).copied().unwrap_or(f64::INFINITY);
        let sigma = at.last().copied().filter(|_| random).unwrap_or(0.0);
        if sigma.abs() > MOST_SIGMA || (1..cuts).any(|level| cut(level) <= cut(level - 1)) {
            total.value = f64::NEG_INFINITY;
        }
        for person in self.people.iter().filter(|person| !person.is_empty()) {
            if !total.value.is_finite() {
                break;
            }
            let answers: Vec<Answer<'_>> = person
                .iter()
                .map(|(level, columns)| {
                    let eta: f64 = columns.iter().zip(at.iter().skip(cuts)).map(|(x, effect)| x * effect).sum();
                    let upper = if *level < cuts { cut(*level) - eta } else { f64::INFINITY };
                    let lower = if *level > 0 { cut(*level - 1) - eta } else { f64::NEG_INFINITY };
                    Answer { level: *level, lower, upper, columns }
                })
                .collect();
            let points = if random { Points::of(&answers, sigma) } else { Points::one(&answers) };
            self.add(&answers, &points, random, &mut total);
        }
        Bent { value: -total.value, slope: -total.slope, bend: -total.bend }
    }

    /// Places of a person's variables among all: two for each answer, then effects and `sigma`; none for an end without a threshold.
    fn places(&self, answers: &[Answer<'_>], has_sigma: bool) -> Vec<Option<usize>> {
        let cuts = self.levels - 1;
        let ends = answers.iter().flat_map(|one| [Some(one.level).filter(|at| *at < cuts), one.level.checked_sub(1)]);
        ends.chain((cuts..cuts + self.columns + usize::from(has_sigma)).map(Some)).collect()
    }

    /// Adds a person: log of the sum of their likelihood over points. With `w` the share of a point in the sum, the slope is the mean of
    /// the slopes by `w`, and the second derivatives are the mean of those at the points and the covariance of the slopes (Louis 1982).
    #[expect(clippy::indexing_slicing, reason = "indices run over the sizes of the arrays that are made here")]
    fn add(&self, answers: &[Answer<'_>], points: &Points, has_sigma: bool, total: &mut Bent) {
        let places = self.places(answers, has_sigma);
        let (many, size, fixed) = (answers.len(), places.len(), 2 * answers.len());
        let most = points.at.iter().map(|(_, log)| *log).fold(f64::NEG_INFINITY, f64::max);
        let sum: f64 = points.at.iter().map(|(_, log)| libm::exp(log - most)).sum();
        total.value += most + libm::log(sum);
        let (mut mean, mut own) = (vec![0.0; size], vec![0.0; size]);
        let mut bend = vec![0.0; size * size];
        for ((v, log), ends) in points.at.iter().zip(points.ends.chunks(many)) {
            let weight = libm::exp(log - most) / sum;
            own.iter_mut().skip(fixed).for_each(|of| *of = 0.0);
            for (number, (end, answer)) in ends.iter().zip(answers).enumerate() {
                let (upper, lower) = (end.upper.0 * end.upper.1, end.lower.0 * end.lower.1);
                let (up, down) = (upper / end.share, -lower / end.share);
                let shift = end.upper.0 - end.lower.1;
                let (i, j) = (2 * number, 2 * number + 1);
                (own[i], own[j]) = (up, down);
                bend[i * size + i] += weight * (up * (end.upper.1 - end.upper.0) - up * up);
                bend[j * size + j] += weight * (down * (end.lower.1 - end.lower.0) - down * down);
                bend[i * size + j] -= weight * up * down;
                // An effect moves both ends: along its column, and `sigma` along `v`.
                let along = |place: usize| if place < self.columns { answer.columns[place] } else { *v };
                for place in 0..size - fixed {
                    let (at, x) = (fixed + place, along(place));
                    own[at] += shift * x;
                    bend[i * size + at] += weight * upper * x;
                    bend[j * size + at] += weight * lower * x;
                    for other in place..size - fixed {
                        bend[at * size + fixed + other] -= weight * (upper + lower) * x * along(other);
                    }
                }
            }
            for i in 0..size {
                mean[i] += weight * own[i];
                for j in i..size {
                    bend[i * size + j] += weight * own[i] * own[j];
                }
            }
        }
        for i in 0..size {
            let Some(at) = places[i] else { continue };
            total.slope[at] += mean[i];
            for j in i..size {
                let Some(other) = places[j] else { continue };
                let found = bend[i * size + j] - mean[i] * mean[j];
                total.bend[(at, other)] += found;
                if i != j {
                    total.bend[(other, at)] += found;
                }
            }
        }
    }
}

/// Mode of a person's intercept, which is `sigma` times a standard normal value `v`, and the distance of points at which the
/// likelihood is summed there. A sum over evenly spaced points is off by `exp(−2π d / step)` where the likelihood has no pole nearer
/// than `d` to the real line (Trefethen and Weideman 2014); the poles of the logistic lie at `π / sigma`.
fn spread(answers: &[Answer<'_>], sigma: f64) -> (f64, f64) {
    let (mut mode, mut bend) = (0.0, 1.0);
    // The slope falls everywhere, and each answer pulls by at most `sigma`, which bounds the mode: where a step leaves the interval that
    // holds the zero, or is not half as long as the one before, the interval is halved instead.
    let bound = sigma.abs() * float(answers.len()) + 1.0;
    let (mut low, mut high, mut before) = (-bound, bound, 2.0 * bound);
    for _ in 0..100 {
        // Of log likelihood − v²/2: slope and bend in v.
        let (mut first, mut second) = (-mode, -1.0);
        for answer in answers {
            let (a, b) = (logistic(answer.upper - sigma * mode), logistic(answer.lower - sigma * mode));
            // d/dx log(F(u − x) − F(l − x)) = F(u − x) + F(l − x) − 1 for the logistic F.
            first += sigma * (a.0 - b.1);
            second -= sigma * sigma * (a.0 * a.1 + b.0 * b.1);
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
    (mode, (OF_WIDTH / libm::sqrt(bend)).min(OF_POLES / sigma.abs()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_are_those_of_the_value() {
        let columns = [[0.0, 1.0], [1.0, 0.0], [0.5, -1.0]];
        let person = |levels: [usize; 4]| -> Vec<(usize, &[f64])> {
            levels.iter().zip(columns.iter().cycle()).map(|(level, columns)| (*level, columns.as_slice())).collect()
        };
        let people = vec![person([0, 1, 2, 2]), Vec::new(), person([3, 3, 0, 1]), person([2, 2, 3, 2])];
        let observed = Observed { people, levels: 4, columns: 2 };
        for (at, random) in [
            (DVector::from_vec(vec![-1.0, 0.2, 0.9, 0.3, -0.4, 1.3]), true),
            (DVector::from_vec(vec![-1.0, 0.2, 0.9, 0.3, -0.4, 9.0]), true),
            (DVector::from_vec(vec![-1.0, 0.2, 0.9, 0.3, -0.4]), false),
        ] {
            let found = observed.minus_log_likelihood(&at, random);
            assert_eq!(found.bend, found.bend.transpose());
            for place in 0..at.len() {
                let moved = |by: f64| {
                    let mut there = at.clone();
                    there[place] += by;
                    observed.minus_log_likelihood(&there, random)
                };
                let (up, down) = (moved(1e-4), moved(-1e-4));
                assert!(((up.value - down.value) / 2e-4 - found.slope[place]).abs() < 1e-6, "{place}");
                let bend = (up.slope - down.slope) / 2e-4;
                assert!((bend - found.bend.column(place)).amax() < 1e-6, "{place}");
            }
        }
        let crossed = observed.minus_log_likelihood(&DVector::from_vec(vec![1.0, 0.2, 0.9, 0.3, -0.4]), false);
        assert!(crossed.value.is_infinite());
    }
}
