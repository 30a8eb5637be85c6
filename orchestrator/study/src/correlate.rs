//! Metrics of runs against what people said of their films.
//!
//! A film is one point: the mean of the scores that people gave it, and the metric of the run that it shows. What is missing stays missing: a
//! film without a value, or without a rating, is no point, and no 0. Intervals come from drawing people and films, both with replacement and
//! both whole (Owen 2007), so they say something about other people and other films. Beside each correlation stands what can be had at all:
//! how well one person agrees with the mean of the others.

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

use crate::design::{Design, Dimension};
use crate::problem::Problem;
use crate::rating::{Origin, Rating, Ratings, is_by_people};
use crate::simulate::Draws;
use crate::stats::{float, holm, kendall, spearman};
use crate::words;

/// Fewest films: of fewer, a correlation can be anything.
pub const FILMS: usize = 10;
/// Fewest films of a hold-out.
const HELD: usize = 4;
/// Resamples of an interval.
const RESAMPLES: usize = 2000;

/// Metrics by name, of films by name; a film without a value of a metric is missing there.
pub type Metrics = BTreeMap<String, BTreeMap<String, f64>>;

/// What is asked.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Wanted {
    /// Metrics that were named before anybody looked.
    Declared(Vec<String>),
    /// The best of all metrics, found without the films of some scenarios and judged by these.
    Search {
        /// The scenarios that are held out.
        hold_out: Vec<String>,
    },
}

/// How one person agrees with the mean of the others, and how reliable the means are.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Ceiling {
    /// The scale.
    pub dimension: String,
    /// Films that were rated.
    pub films: usize,
    /// People who rated them.
    pub people: usize,
    /// Spearman's ρ of single scores with the mean of the others' scores of the same film.
    pub one_against_others: Option<f64>,
    /// Share of the variance of the films' means that another sample of as many people would find again: ICC(1,k) of an unbalanced table.
    pub reliability: Option<f64>,
}

/// A metric against a scale.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Correlation {
    /// The scale.
    pub dimension: String,
    /// The metric.
    pub metric: String,
    /// Films with both.
    pub films: usize,
    /// Spearman's ρ.
    pub rho: Option<f64>,
    /// Its interval of 95 %.
    pub interval: Option<(f64, f64)>,
    /// Its p.
    pub p: Option<f64>,
    /// Its p by Holm over all that were declared.
    pub p_holm: Option<f64>,
    /// Kendall's τ-b.
    pub tau: Option<f64>,
    /// ρ of what is left when each scenario's mean is taken off both: whether the metric tells runs of one scenario apart.
    pub within_scenarios: Option<f64>,
    /// Smallest and largest ρ when one scenario is left out.
    pub without_a_scenario: Option<(f64, f64)>,
    /// ρ divided by the root of the reliability of the means (Spearman 1904), at most 1.
    pub disattenuated: Option<f64>,
    /// ρ on the films that were held out, where the metric was searched for.
    pub held_out: Option<f64>,
    /// Why something has no value.
    pub note: String,
}

/// All of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Correlations {
    /// Origin of the answers; a mark `"simulated": true` where no person gave them, else nothing.
    #[serde(rename = "simulated", skip_serializing_if = "is_by_people")]
    pub origin: Origin,
    /// What can be had.
    pub ceilings: Vec<Ceiling>,
    /// The metrics.
    pub correlations: Vec<Correlation>,
    /// Scenarios that were held out.
    pub hold_out: Vec<String>,
}

/// Scores of one scale by film and person.
struct Scores<'d> {
    films: Vec<&'d str>,
    people: Vec<&'d str>,
    /// By film, the persons' numbers and scores.
    given: Vec<Vec<(usize, f64)>>,
}

fn scores<'d>(ratings: &'d Ratings, design: &'d Design, dimension: Dimension<'d>, out: &BTreeSet<&str>) -> Scores<'d> {
    let mut answers: BTreeMap<(&str, &str), BTreeMap<&str, Rating>> = BTreeMap::new();
    for row in ratings.rows.iter().filter(|row| !out.contains(row.participant.as_str())) {
        if dimension.scale.items.iter().any(|item| item.code == row.item) {
            answers.entry((&row.film, &row.participant)).or_default().insert(&row.item, row.rating);
        }
    }
    let people: BTreeSet<&str> = answers.keys().map(|(_, person)| *person).collect();
    let people: Vec<&str> = people.into_iter().collect();
    let (mut films, mut given) = (Vec::new(), Vec::new());
    for film in &design.films {
        let of = |(at, person): (usize, &&str)| {
            let answers = answers.get(&(film.id.as_str(), *person))?;
            Some((at, dimension.scale.score(dimension.instrument, answers)?))
        };
        let scores: Vec<(usize, f64)> = people.iter().enumerate().filter_map(of).collect();
        if !scores.is_empty() {
            films.push(film.id.as_str());
            given.push(scores);
        }
    }
    Scores { films, people, given }
}

fn mean(values: impl Iterator<Item = f64> + Clone) -> Option<f64> {
    let count = values.clone().count();
    (count > 0).then(|| values.sum::<f64>() / float(count))
}

impl Scores<'_> {
    fn ceiling(&self, dimension: &str) -> Ceiling {
        let mut pairs = Vec::new();
        for scores in &self.given {
            let sum: f64 = scores.iter().map(|(_, score)| score).sum();
            let others = scores.len().saturating_sub(1);
            if others > 0 {
                pairs.extend(scores.iter().map(|(_, score)| (*score, (sum - score) / float(others))));
            }
        }
        Ceiling {
            dimension: dimension.to_owned(),
            films: self.films.len(),
            people: self.people.len(),
            one_against_others: spearman(&pairs).ok().map(|(rho, _)| rho),
            reliability: self.reliability(),
        }
    }

    /// ICC(1,k) of films, from the mean squares between and within them.
    fn reliability(&self) -> Option<f64> {
        let films = float(self.given.len());
        let count: f64 = self.given.iter().map(|scores| float(scores.len())).sum();
        let of = |scores: &Vec<(usize, f64)>| mean(scores.iter().map(|(_, score)| *score));
        let all = mean(self.given.iter().flatten().map(|(_, score)| *score))?;
        let (mut between, mut within) = (0.0, 0.0);
        for scores in &self.given {
            let own = of(scores)?;
            between += float(scores.len()) * (own - all) * (own - all);
            within += scores.iter().map(|(_, score)| (score - own) * (score - own)).sum::<f64>();
        }
        if films < 2.0 || count <= films {
            return None;
        }
        let (between, within) = (between / (films - 1.0), within / (count - films));
        (between > 1e-12).then(|| ((between - within) / between).max(0.0))
    }

    /// Means of films, each person counted so many times.
    fn means(&self, times: Option<&[usize]>) -> Vec<Option<f64>> {
        let count = |person: usize| times.map_or(1, |times| times.get(person).copied().unwrap_or(0));
        let of = |scores: &Vec<(usize, f64)>| {
            let (mut sum, mut all) = (0.0, 0);
            for (person, score) in scores {
                sum += float(count(*person)) * score;
                all += count(*person);
            }
            (all > 0).then(|| sum / float(all))
        };
        self.given.iter().map(of).collect()
    }
}

/// A film as a point: its number, scenario, metric and mean.
type Point<'p> = (usize, &'p str, f64, f64);

fn rho(points: &[Point<'_>]) -> Option<f64> {
    spearman(&points.iter().map(|(.., x, y)| (*x, *y)).collect::<Vec<_>>()).ok().map(|(rho, _)| rho)
}

/// Computes.
///
/// # Errors
/// Fewer than ten films that were rated, a metric that no film has, a search without scenarios that are held out.
pub fn correlate(
    ratings: &Ratings,
    design: &Design,
    excluded: &BTreeMap<String, Vec<&'static str>>,
    metrics: &Metrics,
    wanted: &Wanted,
) -> Result<Correlations, Problem> {
    let out: BTreeSet<&str> = excluded.keys().map(String::as_str).collect();
    let hold_out = check(design, metrics, wanted)?;
    let (origin, hold_out_of) = (ratings.origin, hold_out.clone());
    let mut found = Correlations { origin, ceilings: Vec::new(), correlations: Vec::new(), hold_out: hold_out_of };
    let rated: BTreeSet<&str> =
        ratings.rows.iter().filter(|row| row.rating.points().is_some()).map(|row| row.film.as_str()).collect();
    let apart = |film: &&str| design.film(film).is_some_and(|film| !hold_out.contains(&film.scenario));
    let count = rated.iter().filter(|film| apart(film)).count();
    if count < FILMS {
        let which = if hold_out.is_empty() { "films" } else { "films that are not held out" };
        let what = format!("{count} {which} were rated, and of fewer than {FILMS} a correlation can be anything");
        let hint = "rate films of more scenarios, planners or seeds; the report of `study analyze` compares planners without metrics";
        return Err(Problem::new("the ratings", what, hint));
    }
    for dimension in design.dimensions() {
        let scores = scores(ratings, design, dimension, &out);
        let id = dimension.id();
        let ceiling = scores.ceiling(&id);
        let reliability = ceiling.reliability;
        found.ceilings.push(ceiling);
        let one = |metric: &String| one(design, &scores, &id, metric, metrics, (&hold_out, reliability));
        match wanted {
            Wanted::Declared(names) => found.correlations.extend(names.iter().map(one)),
            Wanted::Search { .. } => {
                let size = |one: &Correlation| one.rho.map_or(-1.0, f64::abs);
                let best = metrics.keys().map(one).reduce(|a, b| if size(&b) > size(&a) { b } else { a });
                // Its own p would be that of the best of many.
                found.correlations.extend(best.map(|best| Correlation { p: None, interval: None, ..best }));
            }
        }
    }
    let p: Vec<f64> = found.correlations.iter().filter_map(|one| one.p).collect();
    let mut adjusted = holm(&p).into_iter();
    for one in found.correlations.iter_mut().filter(|one| one.p.is_some()) {
        one.p_holm = adjusted.next();
    }
    Ok(found)
}

/// The scenarios that are held out, after a look at what is asked.
fn check(design: &Design, metrics: &Metrics, wanted: &Wanted) -> Result<Vec<String>, Problem> {
    let known = || metrics.keys().take(20).cloned().collect::<Vec<_>>().join(", ");
    match wanted {
        Wanted::Declared(names) => {
            if let Some(name) = names.iter().find(|name| !metrics.contains_key(*name)) {
                let near = crate::problem::nearest(name, metrics.keys().map(String::as_str));
                let near = near.map_or_else(String::new, |near| format!("did you mean `{near}`? "));
                let hint = format!("{near}`socrates explain METRIC` tells of each; there are {}", known());
                return Err(Problem::new("--metrics", "no film has this metric", hint).value(name));
            }
            Ok(Vec::new())
        }
        Wanted::Search { hold_out } => {
            let all = design.scenarios.join(", ");
            if let Some(name) = hold_out.iter().find(|name| !design.scenarios.contains(name)) {
                return Err(Problem::new("--hold-out", "no film shows this scenario", format!("scenarios are {all}"))
                    .value(name));
            }
            let held = design.films.iter().filter(|film| hold_out.contains(&film.scenario)).count();
            if held < HELD {
                let what = format!(
                    "the best of {} metrics is searched for, and {held} films are held out to judge it: by chance alone some metric fits",
                    metrics.len()
                );
                let hint = format!(
                    "`--metrics` declares those that you expect something of, or `--hold-out` names scenarios with at least {HELD} films that the search does not see; scenarios are {all}"
                );
                return Err(Problem::new("--search", what, hint));
            }
            Ok(hold_out.clone())
        }
    }
}

fn one(
    design: &Design,
    scores: &Scores<'_>,
    dimension: &str,
    metric: &str,
    metrics: &Metrics,
    (hold_out, reliability): (&[String], Option<f64>),
) -> Correlation {
    let values = metrics.get(metric);
    let means = scores.means(None);
    let mut all: Vec<Point<'_>> = Vec::new();
    for (at, film) in scores.films.iter().enumerate() {
        let scenario = design.film(film).map_or("", |film| film.scenario.as_str());
        let value = values.and_then(|values| values.get(*film)).copied();
        if let Some((value, mean)) = value.zip(means.get(at).copied().flatten()) {
            all.push((at, scenario, value, mean));
        }
    }
    let is_held = |(_, scenario, ..): &Point<'_>| hold_out.iter().any(|name| name == scenario);
    let (held, points): (Vec<Point<'_>>, Vec<Point<'_>>) = all.into_iter().partition(is_held);
    let mut found = Correlation {
        dimension: dimension.to_owned(),
        metric: metric.to_owned(),
        films: points.len(),
        rho: None,
        interval: None,
        p: None,
        p_holm: None,
        tau: None,
        within_scenarios: None,
        without_a_scenario: None,
        disattenuated: None,
        held_out: None,
        note: String::new(),
    };
    if points.len() < FILMS {
        found.note = format!("{} films have both, and at least {FILMS} are needed", points.len());
        return found;
    }
    let pairs: Vec<(f64, f64)> = points.iter().map(|(.., x, y)| (*x, *y)).collect();
    match spearman(&pairs) {
        Ok((rho, p)) => (found.rho, found.p) = (Some(rho), Some(p)),
        Err(_constant) => {
            "the metric or the mean rating is the same for all films".clone_into(&mut found.note);
            return found;
        }
    }
    found.tau = kendall(&pairs).ok();
    found.interval = interval(scores, &points, design.seed);
    found.within_scenarios = rho(&centered(&points));
    found.without_a_scenario = without(&points);
    found.disattenuated = found.rho.zip(reliability.filter(|share| *share > 0.0)).map(|(rho, share)| {
        let full: f64 = rho / libm::sqrt(share);
        full.clamp(-1.0, 1.0)
    });
    found.held_out = if held.len() >= HELD { rho(&held) } else { None };
    found
}

/// Points less the means of their scenarios.
fn centered<'p>(points: &[Point<'p>]) -> Vec<Point<'p>> {
    let of = |scenario: &str, value: &dyn Fn(&Point<'_>) -> f64| {
        mean(points.iter().filter(|(_, own, ..)| *own == scenario).map(value)).unwrap_or(0.0)
    };
    points
        .iter()
        .map(|(at, scenario, x, y)| {
            (*at, *scenario, x - of(scenario, &|point| point.2), y - of(scenario, &|point| point.3))
        })
        .collect()
}

/// Smallest and largest ρ without one of the scenarios; none of a single one.
fn without(points: &[Point<'_>]) -> Option<(f64, f64)> {
    let scenarios: BTreeSet<&str> = points.iter().map(|(_, scenario, ..)| *scenario).collect();
    if scenarios.len() < 2 {
        return None;
    }
    let left = |out: &str| rho(&points.iter().filter(|(_, own, ..)| *own != out).copied().collect::<Vec<_>>());
    let all: Vec<f64> = scenarios.into_iter().filter_map(left).collect();
    let smallest = all.iter().copied().reduce(f64::min)?;
    Some((smallest, all.iter().copied().reduce(f64::max)?))
}

/// The interval of ρ where people and films are drawn anew.
fn interval(scores: &Scores<'_>, points: &[Point<'_>], seed: u64) -> Option<(f64, f64)> {
    let mut draws = Draws::new(seed);
    let mut found = Vec::with_capacity(RESAMPLES);
    let people = scores.people.len();
    for _ in 0..RESAMPLES {
        let mut times = vec![0; people];
        for _ in 0..people {
            if let Some(count) = times.get_mut(place(&mut draws, people)) {
                *count += 1;
            }
        }
        let means = scores.means(Some(&times));
        let mut pairs = Vec::with_capacity(points.len());
        for _ in 0..points.len() {
            let Some((at, _, value, _)) = points.get(place(&mut draws, points.len())) else { continue };
            if let Some(mean) = means.get(*at).copied().flatten() {
                pairs.push((*value, mean));
            }
        }
        found.extend(spearman(&pairs).ok().map(|(rho, _)| rho));
    }
    if found.len() < RESAMPLES / 2 {
        return None;
    }
    found.sort_by(f64::total_cmp);
    let end = |p: f64| socrates_stats::quantile(&found, p).ok();
    Some((end(0.025)?, end(0.975)?))
}

/// One of so many places.
fn place(draws: &mut Draws, count: usize) -> usize {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share of a small count")]
    let at = (draws.share() * float(count)) as usize;
    at.min(count.saturating_sub(1))
}

impl Correlations {
    /// As a table: a row for each scale and metric.
    #[must_use]
    pub fn csv(&self) -> String {
        let number = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:.6}"));
        let pair =
            |pair: Option<(f64, f64)>| format!("{},{}", number(pair.map(|two| two.0)), number(pair.map(|two| two.1)));
        let mut out = "dimension,metric,films,rho,low,high,p,p_holm,tau_b,within_scenarios,least_without_a_scenario,most_without_a_scenario,disattenuated,held_out,note".to_owned();
        let mark = if self.origin.is_simulated() { ",1" } else { "" };
        out.push_str(&if mark.is_empty() { "\n".to_owned() } else { format!(",{}\n", Origin::KEY) });
        for one in &self.correlations {
            out.push_str(&format!(
                "{},{},{},{},{},{},{},{},{},{},{},{},\"{}\"{mark}\n",
                one.dimension,
                one.metric,
                one.films,
                number(one.rho),
                pair(one.interval),
                number(one.p),
                number(one.p_holm),
                number(one.tau),
                number(one.within_scenarios),
                pair(one.without_a_scenario),
                number(one.disattenuated),
                number(one.held_out),
                one.note.replace('"', "'")
            ));
        }
        out
    }

    /// In words, for a methods section.
    #[must_use]
    pub fn words(&self) -> String {
        let shown = |value: Option<f64>| value.map_or_else(|| "no value".to_owned(), |value| format!("{value:.2}"));
        let mut out = words::mark(self.origin);
        out.push_str(
            "Metrics of runs were correlated with the mean scores of their films (Spearman's rho, Kendall's tau-b; a film is one point). Intervals of 95 % come from drawing people and films anew, both whole. p is adjusted by Holm over all metrics and scales that were declared. What has no value is missing, not 0. ",
        );
        if !self.hold_out.is_empty() {
            out.push_str(&format!(
                "The metric that fits best was searched for without the films of {}, and judged by these; it has no p. ",
                self.hold_out.join(", ")
            ));
        }
        for one in &self.ceilings {
            out.push_str(&format!(
                "\n{}: {} films, {}; one person agrees with the mean of the others by {}, reliability of the means {}.",
                one.dimension,
                one.films,
                words::people(one.people, self.origin),
                shown(one.one_against_others),
                shown(one.reliability)
            ));
        }
        out.push('\n');
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rating::{Participant, Row};

    fn study(scenarios: usize) -> Design {
        let mut text =
            "title = \"x\"\nplanners = [\"aa\", \"bb\", \"cc\"]\nparticipants = 42\ninstruments = [\"slider\"]\n"
                .to_owned();
        for scenario in 0..scenarios {
            for (at, planner) in ["aa", "bb", "cc"].iter().enumerate() {
                text.push_str(&format!(
                    "[[film]]\nid = \"f{scenario}{at}\"\nscenario = \"s{scenario}\"\nplanner = \"{planner}\"\n"
                ));
            }
        }
        Design::parse(&text, "study.toml").unwrap()
    }

    /// Twenty people who rate films by how good they are, with noise.
    fn answers(design: &Design) -> (Ratings, Metrics) {
        let mut draws = Draws::new(1);
        let (mut all, mut good, mut noise) = (Ratings::default(), BTreeMap::new(), BTreeMap::new());
        for (at, film) in design.films.iter().enumerate() {
            let value = float(at % 7);
            good.insert(film.id.clone(), value);
            noise.insert(film.id.clone(), draws.share());
            for person in 0..20 {
                let points = libm::round((30.0 + 5.0 * value + 8.0 * draws.normal()).clamp(0.0, 100.0));
                let rating = Rating::Given(points);
                let (participant, film, item) = (format!("p{person:02}"), film.id.clone(), "SL1".to_owned());
                all.rows.push(Row { participant, film, item, rating, position: None, rt_s: None, watched_s: None });
            }
        }
        all.participants = (0..20).map(|n| Participant { id: format!("p{n:02}"), ..Participant::default() }).collect();
        (all, Metrics::from([("good".to_owned(), good), ("noise".to_owned(), noise)]))
    }

    fn declared(names: &[&str]) -> Wanted {
        Wanted::Declared(names.iter().map(|name| (*name).to_owned()).collect())
    }

    #[test]
    fn a_metric_that_people_go_by_is_found_and_noise_is_not() {
        let design = study(4);
        let (ratings, metrics) = answers(&design);
        let found = correlate(&ratings, &design, &BTreeMap::new(), &metrics, &declared(&["good", "noise"])).unwrap();
        let [good, noise] = &found.correlations[..] else { panic!("two") };
        assert!(good.rho.unwrap() > 0.9 && good.p_holm.unwrap() < 0.01, "{good:?}");
        let (low, high) = good.interval.unwrap();
        assert!(low > 0.6 && high <= 1.0 && low < good.rho.unwrap(), "{good:?}");
        assert!(noise.p_holm.unwrap() > 0.05, "{noise:?}");
        let ceiling = &found.ceilings[0];
        let alone = ceiling.one_against_others.unwrap();
        assert!(alone < good.rho.unwrap() && alone > 0.5, "{ceiling:?}");
        assert!(ceiling.reliability.unwrap() > 0.9 && good.disattenuated.unwrap() >= good.rho.unwrap());
        assert!(good.without_a_scenario.unwrap().0 > 0.8 && good.within_scenarios.unwrap() > 0.8, "{good:?}");
        let again = correlate(&ratings, &design, &BTreeMap::new(), &metrics, &declared(&["good", "noise"])).unwrap();
        assert_eq!(again, found, "same seed, same figures");
        assert_eq!(found.csv().lines().count(), 3);
        assert!(!found.csv().contains("simulated") && !found.words().contains("simulated"));
    }

    #[test]
    fn correlations_with_simulated_answers_are_marked_in_table_and_words() {
        let design = study(4);
        let (ratings, metrics) = answers(&design);
        let ratings = Ratings { origin: Origin::Simulated, ..ratings };
        let found = correlate(&ratings, &design, &BTreeMap::new(), &metrics, &declared(&["good"])).unwrap();
        let (table, words) = (found.csv(), found.words());
        assert!(table.lines().next().is_some_and(|head| head.ends_with(",note,simulated")), "{table}");
        assert!(table.lines().skip(1).all(|line| line.ends_with(",1")), "{table}");
        assert!(words.starts_with(Origin::MARK) && words.contains("20 simulated people"), "{words}");
        assert!(serde_json::to_string(&found).unwrap().contains("\"simulated\":true"));
    }

    #[test]
    fn what_is_missing_is_no_point_and_no_zero() {
        let design = study(4);
        let (ratings, mut metrics) = answers(&design);
        let whole = correlate(&ratings, &design, &BTreeMap::new(), &metrics, &declared(&["good"])).unwrap();
        metrics.get_mut("good").unwrap().remove("f00");
        let fewer = correlate(&ratings, &design, &BTreeMap::new(), &metrics, &declared(&["good"])).unwrap();
        assert_eq!((whole.correlations[0].films, fewer.correlations[0].films), (12, 11));
        assert!(fewer.correlations[0].rho.unwrap() > 0.9);
        for film in ["f01", "f02"] {
            metrics.get_mut("good").unwrap().remove(film);
        }
        let few = correlate(&ratings, &design, &BTreeMap::new(), &metrics, &declared(&["good"])).unwrap();
        assert!(few.correlations[0].rho.is_none() && few.correlations[0].note.contains("9 films have both"));
    }

    #[test]
    fn few_films_and_a_search_without_a_hold_out_are_refused() {
        let (small, design) = (study(3), study(6));
        let (ratings, metrics) = answers(&small);
        let few =
            correlate(&ratings, &small, &BTreeMap::new(), &metrics, &declared(&["good"])).unwrap_err().to_string();
        assert!(few.contains("9 films were rated") && few.contains("hint"), "{few}");
        let (ratings, metrics) = answers(&design);
        let search = |hold_out: &[&str]| {
            let hold_out = hold_out.iter().map(|name| (*name).to_owned()).collect();
            correlate(&ratings, &design, &BTreeMap::new(), &metrics, &Wanted::Search { hold_out })
        };
        let blind = search(&[]).unwrap_err().to_string();
        assert!(blind.contains("`--search`: the best of 2 metrics") && blind.contains("--hold-out"), "{blind}");
        assert!(search(&["s9"]).unwrap_err().to_string().contains("`--hold-out` is `s9`"));
        let found = search(&["s0", "s1"]).unwrap();
        let best = &found.correlations[0];
        assert!(
            best.metric == "good" && best.p.is_none() && best.held_out.unwrap() > 0.7 && best.films == 12,
            "{best:?}"
        );
        let typo = correlate(&ratings, &design, &BTreeMap::new(), &metrics, &declared(&["goods"])).unwrap_err();
        assert!(typo.hint.contains("did you mean `good`"), "{typo}");
    }

    #[test]
    fn kendall_is_that_of_the_textbook() {
        // Values of scipy.stats.kendalltau (variant b).
        let pairs = [(12.0, 1.0), (2.0, 4.0), (1.0, 7.0), (12.0, 1.0), (2.0, 0.0)];
        assert!((kendall(&pairs).unwrap() + 0.471_404_520_791_031_7).abs() < 1e-12);
    }
}
