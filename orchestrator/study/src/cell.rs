//! One scale in one scenario: what the planners were given, and whether they differ.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::DMatrix;
use serde::Serialize;

use crate::design::{Design, Dimension};
use crate::rating::{Rating, Row};
use crate::stats::{
    Clustered, Level, NoValue, Zeros, balanced_mixed, bradley_terry, chi_upper, clustered_bca, cronbach, davidson,
    equivalence, float, friedman, icc, krippendorff, omega, ordinal, posthoc, wilcoxon,
};

/// A figure, or why there is none.
pub type Figure<T> = Result<T, String>;

/// What one scale says about one scenario.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Cell {
    /// Scenario.
    pub scenario: String,
    /// `instrument.scale`.
    pub dimension: String,
    /// Whether it has fewer than three items.
    pub single: bool,
    /// Whether its instrument has been validated.
    pub validated: bool,
    /// Lowest and highest score.
    pub points: (f64, f64),
    /// Whether a hypothesis was declared about it before.
    pub declared: bool,
    /// People who rated every planner.
    pub complete: usize,
    /// What each planner was given, in the order of the study.
    pub planners: Vec<PlannerScore>,
    /// Friedman's test.
    pub friedman: Figure<FriedmanFigure>,
    /// The same of everybody, without exclusions: p.
    pub friedman_all: Figure<f64>,
    /// Differences of two planners.
    pub pairs: Vec<Pair>,
    /// The cumulative mixed model.
    pub ordinal: Figure<OrdinalFigure>,
    /// F test of the linear mixed model of the scores: F, both degrees of freedom, p.
    pub linear: Figure<(f64, f64, f64, f64)>,
    /// Effect of one place later in the order, log odds: effect, standard error, p.
    pub order: Figure<(f64, f64, f64)>,
    /// Alpha and its interval.
    pub alpha: Figure<(f64, f64, f64)>,
    /// Alpha of answers less each person's means.
    pub alpha_within: Figure<f64>,
    /// Omega.
    pub omega: Figure<f64>,
    /// ICC(C,1) and ICC(C,k) of films by people, with the number of people.
    pub icc: Figure<(f64, f64, usize)>,
    /// Krippendorff's alpha of films by people, ordinal.
    pub krippendorff: Figure<f64>,
    /// Strengths by Bradley and Terry from who scored higher, ties left out: planner, strength, error.
    pub strengths: Figure<Vec<(String, f64, f64)>>,
    /// Strengths by Davidson, ties counted: planner and strength, and the log of the prevalence of ties.
    pub strengths_with_ties: Figure<(Vec<(String, f64)>, f64)>,
}

/// What one planner was given.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlannerScore {
    /// Planner.
    pub planner: String,
    /// People who rated it.
    pub people: usize,
    /// Median of their scores.
    pub median: f64,
    /// Mean of their scores.
    pub mean: f64,
    /// BCa interval of the mean, people drawn whole.
    pub mean_interval: Option<(f64, f64)>,
    /// Answers to its items in the direction of the scale: points and how often.
    pub answers: Vec<(f64, usize)>,
    /// Ratings that are missing.
    pub missing: usize,
}

/// Friedman's test as it is told.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FriedmanFigure {
    /// χ².
    pub chi2: f64,
    /// Degrees of freedom.
    pub df: usize,
    /// p by χ².
    pub p: f64,
    /// Exact p, where it could be counted out.
    pub p_exact: Option<f64>,
    /// Kendall's W.
    pub w: f64,
}

/// Two planners.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Pair {
    /// The planner that comes later in the study.
    pub first: String,
    /// The planner that it is compared with.
    pub against: String,
    /// The tests, by Pratt's rule.
    pub test: Figure<PairFigure>,
    /// p by Conover (none where all people have one order) and by Nemenyi, from the ranks of all planners.
    pub posthoc: Figure<(Option<f64>, f64)>,
    /// Equivalence, where the study declares a margin: mean difference, interval, p.
    pub equivalence: Option<Figure<(f64, f64, f64, f64)>>,
}

/// A signed-rank test as it is told.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PairFigure {
    /// People.
    pub n: usize,
    /// People who made no difference.
    pub zeros: usize,
    /// Normal deviate.
    pub z: f64,
    /// p with zeros ranked (Pratt).
    pub p: f64,
    /// p with zeros dropped (Wilcoxon).
    pub p_dropped: f64,
    /// p by Holm over the pairs and dimensions of the scenario that were declared, or of those that were not.
    pub p_holm: f64,
    /// `z / √n`.
    pub r: f64,
    /// Rank-biserial correlation.
    pub rank_biserial: f64,
    /// Hodges–Lehmann shift and its 95 % interval.
    pub shift: (f64, f64, f64),
}

/// The cumulative mixed model as it is told; odds ratios are of a higher rating than the first planner's.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OrdinalFigure {
    /// Planner, log odds ratio, standard error, p.
    pub effects: Vec<(String, f64, f64, f64)>,
    /// Standard deviation of people's intercepts.
    pub sigma: f64,
    /// Likelihood ratio against the model without planners, and its p.
    pub lr: (f64, f64),
}

/// Scores of each person by planner, means over the films of a planner; and of each film.
struct Scores<'r> {
    people: Vec<&'r str>,
    by_planner: BTreeMap<(&'r str, &'r str), f64>,
    by_film: BTreeMap<(&'r str, &'r str), f64>,
    /// Complete answers to the items, with their person.
    rows: Vec<(&'r str, Vec<f64>)>,
    position: BTreeMap<(&'r str, &'r str), u32>,
}

impl<'r> Scores<'r> {
    fn of(rows: &[&'r Row], design: &'r Design, dimension: Dimension<'_>) -> Self {
        let mut blocks: BTreeMap<(&str, &str), BTreeMap<&str, Rating>> = BTreeMap::new();
        let mut position = BTreeMap::new();
        for row in rows {
            blocks.entry((&row.participant, &row.film)).or_default().insert(&row.item, row.rating);
            if let (Some(place), Some(film)) = (row.position, design.film(&row.film)) {
                position.insert((row.participant.as_str(), film.planner.as_str()), place);
            }
        }
        let mut all: BTreeMap<(&str, &str), Vec<f64>> = BTreeMap::new();
        let (mut by_film, mut whole) = (BTreeMap::new(), Vec::new());
        for ((person, film), answers) in &blocks {
            let Some(score) = dimension.scale.score(dimension.instrument, answers) else { continue };
            let Some(planner) = design.film(film).map(|film| film.planner.as_str()) else { continue };
            by_film.insert((*person, *film), score);
            all.entry((person, planner)).or_default().push(score);
            let given = |code: &str| answers.get(code).copied().unwrap_or_default();
            let keyed: Option<Vec<f64>> =
                dimension.scale.items.iter().map(|item| dimension.instrument.keyed(item, given(&item.code))).collect();
            whole.extend(keyed.map(|keyed| (*person, keyed)));
        }
        let by_planner: BTreeMap<(&str, &str), f64> =
            all.into_iter().filter_map(|(key, scores)| Some((key, socrates_stats::mean(&scores).ok()?))).collect();
        let people: BTreeSet<&str> = by_planner.keys().map(|(person, _)| *person).collect();
        Self { people: people.into_iter().collect(), by_planner, by_film, rows: whole, position }
    }

    /// People who rated all of these, by planner.
    fn table(&self, planners: &[String]) -> (Vec<&'r str>, DMatrix<f64>) {
        let row = |person: &&'r str| -> Option<Vec<f64>> {
            planners.iter().map(|planner| self.by_planner.get(&(*person, planner.as_str())).copied()).collect()
        };
        let complete: Vec<(&str, Vec<f64>)> = self.people.iter().filter_map(|one| Some((*one, row(one)?))).collect();
        let flat: Vec<f64> = complete.iter().flat_map(|(_, row)| row.iter().copied()).collect();
        (complete.iter().map(|(one, _)| *one).collect(), DMatrix::from_row_slice(complete.len(), planners.len(), &flat))
    }
}

fn told<T>(found: Result<T, NoValue>) -> Figure<T> {
    found.map_err(|why| why.to_string())
}

/// Everything about one scale in one scenario; `rows` are those that stay, `all` those of everybody.
pub(crate) fn cell(design: &Design, scenario: &str, dimension: Dimension<'_>, rows: &[&Row], all: &[&Row]) -> Cell {
    let scores = Scores::of(rows, design, dimension);
    let films: Vec<&str> =
        design.films.iter().filter(|film| film.scenario == scenario).map(|film| film.id.as_str()).collect();
    let shown =
        |planner: &&String| design.films.iter().any(|film| film.scenario == scenario && film.planner == **planner);
    let planners: Vec<String> = design.planners.iter().filter(shown).cloned().collect();
    let (complete, table) = scores.table(&planners);
    let (_, everybody) = Scores::of(all, design, dimension).table(&planners);
    let mut units: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    scores.by_film.iter().for_each(|((_, film), score)| units.entry(film).or_default().push(*score));
    let units: Vec<Vec<f64>> = units.into_values().collect();
    let id = dimension.id();
    Cell {
        scenario: scenario.to_owned(),
        single: dimension.scale.is_single(),
        validated: dimension.instrument.validated,
        points: dimension.instrument.points,
        declared: design.is_declared(&id, scenario),
        dimension: id,
        complete: complete.len(),
        planners: planners.iter().map(|planner| score_of(design, dimension, planner, &scores, rows)).collect(),
        friedman: told(friedman(&table).map(|of| FriedmanFigure {
            chi2: of.chi2,
            df: of.df,
            p: of.p,
            p_exact: of.p_exact,
            w: of.w,
        })),
        friedman_all: told(friedman(&everybody).map(|of| of.p)),
        pairs: pairs(design, &planners, &table),
        ordinal: ordinal_of(&planners, &scores, false).map(|(figure, _)| figure),
        order: ordinal_of(&planners, &scores, true)
            .and_then(|(_, order)| order.ok_or_else(|| "no position is known".to_owned())),
        linear: told(balanced_mixed(&table).map(|of| of.f)),
        alpha: alpha(&scores).map(|of| (of.alpha, of.interval.0, of.interval.1)),
        alpha_within: within(&scores),
        omega: told(omega(&matrix(scores.rows.iter().map(|(_, row)| row)))),
        icc: icc_of(&scores, &films),
        krippendorff: told(krippendorff(&units, Level::Ordinal)),
        strengths: strengths(&planners, &table),
        strengths_with_ties: strengths_with_ties(&planners, &table),
    }
}

fn matrix<'v>(rows: impl Iterator<Item = &'v Vec<f64>>) -> DMatrix<f64> {
    let rows: Vec<&Vec<f64>> = rows.collect();
    let flat: Vec<f64> = rows.iter().flat_map(|row| row.iter().copied()).collect();
    DMatrix::from_row_slice(rows.len(), rows.first().map_or(0, |row| row.len()), &flat)
}

fn alpha(scores: &Scores<'_>) -> Figure<crate::stats::Alpha> {
    told(cronbach(&matrix(scores.rows.iter().map(|(_, row)| row))))
}

/// Alpha of what people tell apart themselves: their own means are taken away from their answers.
fn within(scores: &Scores<'_>) -> Figure<f64> {
    let mut centered = Vec::new();
    for group in scores.rows.chunk_by(|a, b| a.0 == b.0) {
        let count = float(group.len());
        let width = group.first().map_or(0, |(_, row)| row.len());
        let mean = |at: usize| group.iter().filter_map(|(_, row)| row.get(at)).sum::<f64>() / count;
        let means: Vec<f64> = (0..width).map(mean).collect();
        centered.extend(
            group.iter().map(|(_, row)| row.iter().zip(&means).map(|(one, mean)| one - mean).collect::<Vec<_>>()),
        );
    }
    told(cronbach(&matrix(centered.iter())).map(|of| of.alpha))
}

fn score_of(
    design: &Design,
    dimension: Dimension<'_>,
    planner: &str,
    scores: &Scores<'_>,
    rows: &[&Row],
) -> PlannerScore {
    let given: Vec<f64> =
        scores.people.iter().filter_map(|person| scores.by_planner.get(&(*person, planner)).copied()).collect();
    let mean = |drawn: &[usize]| {
        let sum: f64 = drawn.iter().filter_map(|at| given.get(*at)).sum();
        (!drawn.is_empty()).then(|| sum / float(drawn.len()))
    };
    let how = Clustered { resamples: design.resamples, confidence: 0.95, seed: design.seed };
    let mut answers: BTreeMap<u64, usize> = BTreeMap::new();
    let mut missing = 0;
    let (low, high) = dimension.instrument.points;
    for row in rows.iter().filter(|row| design.film(&row.film).is_some_and(|film| film.planner == planner)) {
        let Some(item) = dimension.scale.items.iter().find(|item| item.code == row.item) else { continue };
        match dimension.instrument.keyed(item, row.rating) {
            // Answers of a fine slider are counted in tenths of its range.
            Some(points) => {
                let tenth = (high - low) / 10.0;
                let shown =
                    if high - low > 20.0 { low + libm::floor((points - low) / tenth).min(9.0) * tenth } else { points };
                *answers.entry(shown.to_bits()).or_default() += 1;
            }
            None => missing += 1,
        }
    }
    PlannerScore {
        planner: planner.to_owned(),
        people: given.len(),
        median: socrates_stats::median(&given).unwrap_or(f64::NAN),
        mean: socrates_stats::mean(&given).unwrap_or(f64::NAN),
        mean_interval: clustered_bca(given.len(), how, mean),
        answers: {
            let mut list: Vec<(f64, usize)> =
                answers.into_iter().map(|(bits, count)| (f64::from_bits(bits), count)).collect();
            list.sort_by(|a, b| a.0.total_cmp(&b.0));
            list
        },
        missing,
    }
}

fn pairs(design: &Design, planners: &[String], table: &DMatrix<f64>) -> Vec<Pair> {
    let mut found = Vec::new();
    let ranked = posthoc(table);
    for (later, first) in planners.iter().enumerate() {
        for (earlier, against) in planners.iter().enumerate().take(later) {
            let differences: Vec<f64> =
                table.column(later).iter().zip(table.column(earlier).iter()).map(|(a, b)| a - b).collect();
            let test = wilcoxon(&differences, Zeros::Pratt, 0.95).and_then(|of| {
                let dropped = wilcoxon(&differences, Zeros::Drop, 0.95)?;
                Ok(PairFigure {
                    n: differences.len(),
                    zeros: differences.len() - of.used,
                    z: of.z,
                    p: of.p,
                    p_dropped: dropped.p,
                    p_holm: of.p,
                    r: of.r,
                    rank_biserial: of.rank_biserial,
                    shift: (of.shift, of.shift_interval.0, of.shift_interval.1),
                })
            });
            let same = |margin| {
                told(
                    equivalence(&differences, margin, design.alpha)
                        .map(|of| (of.mean, of.interval.0, of.interval.1, of.p)),
                )
            };
            let of_both =
                ranked.as_ref().map(|all| all.iter().find(|one| one.first == later && one.against == earlier));
            let posthoc = match of_both {
                Ok(Some(one)) => Ok((one.conover, one.nemenyi)),
                Ok(None) => Err("not compared".to_owned()),
                Err(why) => Err(why.to_string()),
            };
            let (first, against) = (first.clone(), against.clone());
            found.push(Pair { first, against, test: told(test), posthoc, equivalence: design.margin.map(same) });
        }
    }
    found
}

type Order = Option<(f64, f64, f64)>;

/// The cumulative mixed model of the scores, with the place in the order as a further column where that is asked.
fn ordinal_of(planners: &[String], scores: &Scores<'_>, with_order: bool) -> Figure<(OrdinalFigure, Order)> {
    let mut rows = Vec::new();
    for (number, person) in scores.people.iter().enumerate() {
        for planner in planners {
            let key = (*person, planner.as_str());
            let Some(score) = scores.by_planner.get(&key) else { continue };
            let place = scores.position.get(&key);
            if with_order && place.is_none() {
                continue;
            }
            let of = |other: &String| f64::from(u8::from(other == planner));
            let mut columns: Vec<f64> = planners.iter().skip(1).map(of).collect();
            columns.extend(place.filter(|_| with_order).map(|place| f64::from(*place)));
            rows.push((number, *score, columns));
        }
    }
    let found = told(ordinal(&rows, true))?;
    let order = found.terms.get(planners.len() - 1).map(|term| (term.effect, term.error, term.p));
    let lr = if with_order {
        (0.0, 1.0)
    } else {
        let none: Vec<_> = rows.iter().map(|(person, score, _)| (*person, *score, Vec::new())).collect();
        let lr = 2.0 * (found.log_likelihood - told(ordinal(&none, true))?.log_likelihood);
        (lr, chi_upper(lr, float(planners.len() - 1)))
    };
    let named = planners.iter().skip(1).zip(&found.terms);
    let effects = named.map(|(planner, term)| (planner.clone(), term.effect, term.error, term.p)).collect();
    Ok((OrdinalFigure { effects, sigma: found.sigma, lr }, order))
}

fn icc_of(scores: &Scores<'_>, films: &[&str]) -> Figure<(f64, f64, usize)> {
    let row = |person: &&str| -> Option<Vec<f64>> {
        films.iter().map(|film| scores.by_film.get(&(*person, *film)).copied()).collect()
    };
    let complete: Vec<Vec<f64>> = scores.people.iter().filter_map(row).collect();
    let found = told(icc(&matrix(complete.iter()).transpose()))?;
    Ok((found.consistency.value, found.consistency_k.value, complete.len()))
}

/// How many people scored each planner (row) so against each other (column).
fn counted(table: &DMatrix<f64>, is_so: impl Fn(f64, f64) -> bool) -> DMatrix<f64> {
    DMatrix::from_fn(table.ncols(), table.ncols(), |i, j| {
        float(table.column(i).iter().zip(table.column(j).iter()).filter(|(a, b)| is_so(**a, **b)).count())
    })
}

fn wins(table: &DMatrix<f64>) -> DMatrix<f64> {
    counted(table, |a, b| a > b + 1e-9)
}

fn strengths_with_ties(planners: &[String], table: &DMatrix<f64>) -> Figure<(Vec<(String, f64)>, f64)> {
    let mut ties = counted(table, |a, b| libm::fabs(a - b) <= 1e-9);
    ties.fill_diagonal(0.0);
    let found = told(davidson(&wins(table), &ties))?;
    Ok((planners.iter().cloned().zip(found.strengths).collect(), found.ties))
}

fn strengths(planners: &[String], table: &DMatrix<f64>) -> Figure<Vec<(String, f64, f64)>> {
    let found = told(bradley_terry(&wins(table)))?;
    let both = found.strengths.iter().zip(&found.errors);
    Ok(planners.iter().zip(both).map(|(planner, (strength, error))| (planner.clone(), *strength, *error)).collect())
}
