//! The study as its authors declare it, before any answer: `study.toml`.

use std::collections::{BTreeMap, BTreeSet};

use serde::Deserialize;

use crate::instrument::{self, Instrument, Item, Scale, Written};
use crate::kit::setup::{MINUTES, Source, Survey};
use crate::plan::minutes;
use crate::problem::Problem;
use crate::rating::Film;

/// Most films of a study.
const MAX_FILMS: usize = 2000;

/// A study: films, instruments, people, hypotheses, and the rules by which people are left out.
#[derive(Debug, Clone, PartialEq)]
pub struct Design {
    /// Title.
    pub title: String,
    /// Seed of everything that is drawn: bootstrap, simulated people.
    pub seed: u64,
    /// Planners in the order in which they are told; the first is the reference of odds ratios.
    pub planners: Vec<String>,
    /// Scenarios, in the order of the films.
    pub scenarios: Vec<String>,
    /// Planned participants per scenario.
    pub participants: usize,
    /// Whether each person sees all scenarios instead of one.
    pub all_scenarios: bool,
    /// Instruments, shipped or pasted.
    pub instruments: Vec<Instrument>,
    /// Films.
    pub films: Vec<Film>,
    /// Right answers of attention checks, by name.
    pub checks: BTreeMap<String, String>,
    /// What is expected, as it was declared.
    pub hypotheses: Vec<Hypothesis>,
    /// When answers are left out.
    pub exclusions: Exclusions,
    /// Probability of a false alarm. Default 0.05.
    pub alpha: f64,
    /// Smallest difference of two planners that matters, points; where it is declared, equivalence is tested.
    pub margin: Option<f64>,
    /// Resamples of the bootstrap. Default 10 000.
    pub resamples: usize,
    /// Films that a person rates at most, where everybody sees all scenarios.
    pub films_per_person: Option<usize>,
    /// What participants read.
    pub survey: Survey,
    /// Where films come from.
    pub sources: Vec<Source>,
    /// BLAKE3 of the file's text.
    pub digest: String,
    /// Places of the films by their names; films stay as they were read.
    film_places: BTreeMap<String, usize>,
}

/// A declared expectation; what no hypothesis names is exploratory.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Hypothesis {
    /// The expectation in words.
    pub text: String,
    /// What it is about: `instrument.scale`.
    pub dimension: String,
    /// Scenario; none where all are meant.
    pub scenario: Option<String>,
}

/// Rules by which people are left out; each is applied to everybody before anything is computed.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Exclusions {
    /// Failed attention checks from which on a person is left out. Default 2; 0 turns the rule off.
    pub failed_checks: u32,
    /// Whether people are left out who left a film before its end. Default yes.
    pub left_early: bool,
    /// Whether people are left out who took less time than the films last. Default yes.
    pub too_fast: bool,
    /// Blocks of at least three items with one and the same answer from which on a person is left out. Default 2; 0 turns the
    /// rule off.
    pub straight_lines: u32,
    /// Whether people are left out whose submission was rejected, returned or timed out. Default yes.
    pub not_approved: bool,
}

impl Default for Exclusions {
    fn default() -> Self {
        Self { failed_checks: 2, left_early: true, too_fast: true, straight_lines: 2, not_approved: true }
    }
}

/// A scale of an instrument of the study.
#[derive(Debug, Clone, Copy)]
pub struct Dimension<'d> {
    /// The instrument.
    pub instrument: &'d Instrument,
    /// The scale.
    pub scale: &'d Scale,
}

impl Dimension<'_> {
    /// `instrument.scale`.
    #[must_use]
    pub fn id(&self) -> String {
        format!("{}.{}", self.instrument.id, self.scale.id)
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    title: String,
    #[serde(default = "one")]
    seed: u64,
    planners: Vec<String>,
    participants: usize,
    #[serde(default)]
    all_scenarios: bool,
    #[serde(default)]
    instruments: Vec<String>,
    #[serde(default)]
    instrument: Vec<Written>,
    #[serde(default)]
    film: Vec<Film>,
    #[serde(default)]
    checks: BTreeMap<String, toml::Value>,
    #[serde(default)]
    hypothesis: Vec<Hypothesis>,
    #[serde(default)]
    exclusions: Exclusions,
    #[serde(default = "five")]
    alpha: f64,
    margin: Option<f64>,
    #[serde(default = "many")]
    resamples: usize,
    films_per_person: Option<usize>,
    #[serde(default)]
    survey: Survey,
    #[serde(default)]
    scenario: Vec<Source>,
}

const fn one() -> u64 {
    1
}
const fn five() -> f64 {
    0.05
}
const fn many() -> usize {
    10_000
}

impl Design {
    /// Reads a study file.
    ///
    /// # Errors
    /// An unknown key, a film of an unknown planner, two films of one name, an instrument that is not shipped and has no items,
    /// a number of participants that is no multiple of the orders, a hypothesis about something that is not asked.
    pub fn parse(text: &str, file: &str) -> Result<Self, Problem> {
        let written: File = toml::from_str(text).map_err(|why| {
            let above = why.span().and_then(|span| text.get(..span.start)).unwrap_or_default();
            let line = above.matches('\n').count() + 1;
            Problem::new(file, why.message(), "docs/study.md lists the keys of a study").line(line as u64)
        })?;
        let digest = blake3::hash(text.as_bytes()).to_hex().to_string();
        let bad =
            |key: &str, value: &str, what: &str, hint: &str| Problem::new(file, what, hint).column(key).value(value);
        check_numbers(&written, &bad)?;
        let mut instruments = Vec::new();
        for id in &written.instruments {
            instruments.push(Instrument::named(id, file)?);
        }
        for own in &written.instrument {
            instruments.push(Instrument::of(own.clone(), file)?);
        }
        if instruments.is_empty() {
            return Err(bad("instruments", "[]", "nothing is asked", "name one, such as `instruments = [\"psi\"]`"));
        }
        instrument::apart(&instruments, file)?;
        let scenarios = check_films(&written, &bad)?;
        let film_places = written.film.iter().enumerate().map(|(at, film)| (film.id.clone(), at)).collect();
        let mut design = Self {
            title: written.title,
            seed: written.seed,
            planners: written.planners,
            scenarios,
            participants: written.participants,
            all_scenarios: written.all_scenarios,
            instruments,
            films: written.film,
            checks: written.checks.into_iter().map(|(name, value)| (name, plain(&value))).collect(),
            hypotheses: written.hypothesis,
            exclusions: written.exclusions,
            alpha: written.alpha,
            margin: written.margin,
            resamples: written.resamples,
            films_per_person: written.films_per_person,
            survey: written.survey,
            sources: written.scenario,
            digest,
            film_places,
        };
        if let Some(minutes) = minutes(&design) {
            design.survey.consent.fill(MINUTES, &format!("{minutes:.0}"));
        }
        check_sources(&design, &bad)?;
        let known: Vec<String> = design.dimensions().iter().map(Dimension::id).collect();
        for hypothesis in &design.hypotheses {
            if !known.contains(&hypothesis.dimension) {
                let hint = format!("dimensions are {}", known.join(", "));
                return Err(bad("hypothesis.dimension", &hypothesis.dimension, "no instrument asks this", &hint));
            }
            if let Some(scenario) = hypothesis.scenario.as_ref().filter(|one| !design.scenarios.contains(one)) {
                let hint = format!("scenarios are {}", design.scenarios.join(", "));
                return Err(bad("hypothesis.scenario", scenario, "no film shows it", &hint));
            }
        }
        Ok(design)
    }

    /// Its scales, in order.
    #[must_use]
    pub fn dimensions(&self) -> Vec<Dimension<'_>> {
        let of = |instrument| move |scale| Dimension { instrument, scale };
        self.instruments.iter().flat_map(|instrument| instrument.scales.iter().map(of(instrument))).collect()
    }

    /// Instrument, scale and item of a code.
    #[must_use]
    pub fn item(&self, code: &str) -> Option<(Dimension<'_>, &Item)> {
        let scales = self
            .instruments
            .iter()
            .flat_map(|instrument| instrument.scales.iter().map(move |scale| (instrument, scale)));
        let mut items = scales.flat_map(|(instrument, scale)| {
            scale.items.iter().map(move |item| (Dimension { instrument, scale }, item))
        });
        items.find(|(_, item)| item.code == code)
    }

    /// All item codes.
    pub fn codes(&self) -> impl Iterator<Item = &str> {
        let scales = self.instruments.iter().flat_map(|one| &one.scales);
        scales.flat_map(|scale| scale.items.iter().map(|item| item.code.as_str()))
    }

    /// A film by its name.
    #[must_use]
    pub fn film(&self, id: &str) -> Option<&Film> {
        self.film_places.get(id).and_then(|at| self.films.get(*at))
    }

    /// Whether a hypothesis was declared about a dimension in a scenario.
    #[must_use]
    pub fn is_declared(&self, dimension: &str, scenario: &str) -> bool {
        let fits = |one: &Hypothesis| one.scenario.as_ref().is_none_or(|of| of == scenario);
        self.hypotheses.iter().any(|one| one.dimension == dimension && fits(one))
    }
}

/// A value of a check as the answer is written.
fn plain(value: &toml::Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}

type Bad<'f> = dyn Fn(&str, &str, &str, &str) -> Problem + 'f;

fn check_numbers(written: &File, bad: &Bad<'_>) -> Result<(), Problem> {
    let distinct: BTreeSet<&String> = written.planners.iter().collect();
    if distinct.len() < 2 || distinct.len() < written.planners.len() {
        return Err(bad(
            "planners",
            &written.planners.join(", "),
            "planners are compared, at least two different ones",
            "name each planner of the films once",
        ));
    }
    let orders = williams(written.planners.len()).len();
    if written.participants == 0 || !written.participants.is_multiple_of(orders) {
        let (below, above) = (written.participants / orders * orders, (written.participants / orders + 1) * orders);
        let hint = if below == 0 { format!("take {above}") } else { format!("take {below} or {above}") };
        return Err(bad(
            "participants",
            &written.participants.to_string(),
            &format!("{} planners have {orders} balanced orders, and this is no multiple of {orders}", distinct.len()),
            &hint,
        ));
    }
    if !(0.001..=0.2).contains(&written.alpha) {
        return Err(bad("alpha", &written.alpha.to_string(), "not within 0.001 and 0.2", "0.05 is usual"));
    }
    if let Some(margin) = written.margin.filter(|margin| !(margin.is_finite() && *margin > 0.0)) {
        return Err(bad("margin", &margin.to_string(), "not above 0", "the smallest difference that matters, points"));
    }
    if !(200..=100_000).contains(&written.resamples) {
        return Err(bad("resamples", &written.resamples.to_string(), "not within 200 and 100000", "10000 is usual"));
    }
    Ok(())
}

fn check_films(written: &File, bad: &Bad<'_>) -> Result<Vec<String>, Problem> {
    if written.film.is_empty() || written.film.len() > MAX_FILMS {
        let count = written.film.len().to_string();
        return Err(bad(
            "film",
            &count,
            "1 to 2000 films are expected",
            "add `[[film]]` with id, scenario and planner",
        ));
    }
    let (mut seen, mut scenarios) = (BTreeSet::new(), Vec::new());
    for film in &written.film {
        if film.id.is_empty() || !film.id.chars().all(|c| c.is_ascii_alphanumeric() || c == '-') {
            return Err(bad("film.id", &film.id, "letters, digits and - are allowed", "an opaque name, such as k7f"));
        }
        if let Some(told) = written.planners.iter().find(|planner| film.id.contains(planner.as_str())) {
            let what = format!("the name tells the planner `{told}` to participants");
            return Err(bad("film.id", &film.id, &what, "an opaque name, such as k7f"));
        }
        if !seen.insert(&film.id) {
            return Err(bad("film.id", &film.id, "two films have this name", "each film has a name of its own"));
        }
        if !written.planners.contains(&film.planner) {
            let hint = format!("planners are {}", written.planners.join(", "));
            return Err(bad("film.planner", &film.planner, "not among the planners of the study", &hint));
        }
        if film.length_s.is_some_and(|length| !(0.1..=3600.0).contains(&length)) {
            let length = film.length_s.unwrap_or_default().to_string();
            return Err(bad("film.length_s", &length, "not within 0.1 and 3600 s", "the length of the film, s"));
        }
        if !scenarios.contains(&film.scenario) {
            scenarios.push(film.scenario.clone());
        }
    }
    check_lengths(written, &scenarios, bad)?;
    Ok(scenarios)
}

/// What is said of where films come from must be about films that there are.
fn check_sources(design: &Design, bad: &Bad<'_>) -> Result<(), Problem> {
    let mut seen = BTreeSet::new();
    for source in &design.sources {
        if !design.scenarios.contains(&source.name) {
            let hint = format!("scenarios of films are {}", design.scenarios.join(", "));
            return Err(bad("scenario.name", &source.name, "no film shows it", &hint));
        }
        if !seen.insert(&source.name) {
            return Err(bad("scenario.name", &source.name, "it stands twice", "one `[[scenario]]` for each"));
        }
        if source.bundles.is_empty() {
            return Err(bad("scenario.bundles", &source.name, "no bundle is named", "name folders of its runs"));
        }
        if !(5.0..=600.0).contains(&source.longest_s) {
            let hint = "45 s is the default; longer films tire";
            return Err(bad("scenario.longest_s", &source.longest_s.to_string(), "not within 5 and 600 s", hint));
        }
    }
    let least = design.planners.len();
    if let Some(count) = design.films_per_person.filter(|count| *count < least) {
        let what = format!("a person compares {least} planners, each in a film");
        return Err(bad("films_per_person", &count.to_string(), &what, &format!("at least {least}")));
    }
    Ok(())
}

/// A longer film tells which planner hesitated: films of one scenario have one length.
fn check_lengths(written: &File, scenarios: &[String], bad: &Bad<'_>) -> Result<(), Problem> {
    for scenario in scenarios {
        let mut lengths =
            written.film.iter().filter(|film| &film.scenario == scenario).filter_map(|film| film.length_s);
        let Some(first) = lengths.next() else { continue };
        if let Some(other) = lengths.find(|length| (length - first).abs() > 0.5) {
            let what = format!("films of `{scenario}` last {first} s and {other} s, and a length tells planners apart");
            return Err(bad("film.length_s", &other.to_string(), &what, "hold the last picture of the shorter film"));
        }
    }
    Ok(())
}

/// Orders in which every condition follows every other equally often (Williams 1949): `k` orders for an even number of
/// conditions, `2 k` for an odd one. Conditions are numbered from 0.
#[must_use]
pub fn williams(k: usize) -> Vec<Vec<usize>> {
    // 0, 1, k−1, 2, k−2, … and its shifts.
    let first: Vec<usize> = (0..k)
        .map(|at| {
            if at == 0 {
                0
            } else if at % 2 == 1 {
                at.div_ceil(2)
            } else {
                k - at / 2
            }
        })
        .collect();
    let shifted = |by: usize| -> Vec<usize> { first.iter().map(|one| (one + by) % k).collect() };
    let mut orders: Vec<Vec<usize>> = (0..k).map(shifted).collect();
    if k % 2 == 1 {
        let back: Vec<Vec<usize>> = orders.iter().map(|order| order.iter().rev().copied().collect()).collect();
        orders.extend(back);
    }
    orders
}

#[cfg(test)]
mod tests {
    use super::*;

    pub(crate) const STUDY: &str = r#"
title = "Elevator"
planners = ["mppi", "ha", "can"]
participants = 42
instruments = ["psi"]
[[film]]
id = "k7f"
scenario = "elevator"
planner = "mppi"
length_s = 20
[[film]]
id = "q2b"
scenario = "elevator"
planner = "ha"
length_s = 20
[[film]]
id = "z9x"
scenario = "elevator"
planner = "can"
length_s = 20
"#;

    #[test]
    fn every_condition_follows_every_other_equally_often() {
        for k in 2..9 {
            let orders = williams(k);
            assert_eq!(orders.len(), if k % 2 == 0 { k } else { 2 * k });
            let mut follows = BTreeMap::new();
            for order in &orders {
                assert_eq!(order.iter().collect::<BTreeSet<_>>().len(), k);
                order.windows(2).for_each(|pair| *follows.entry((pair[0], pair[1])).or_insert(0) += 1);
            }
            let counts: BTreeSet<i32> = follows.values().copied().collect();
            assert_eq!((follows.len(), counts), (k * (k - 1), BTreeSet::from([if k % 2 == 0 { 1 } else { 2 }])), "{k}");
        }
    }

    #[test]
    fn a_study_is_read_and_what_is_wrong_with_it_is_told() {
        let design = Design::parse(STUDY, "study.toml").unwrap();
        assert_eq!((design.films.len(), design.codes().count(), design.exclusions.failed_checks), (3, 8, 2));
        let wrong = |from: &str, to: &str, told: &str| {
            let text = STUDY.replacen(from, to, 1);
            assert_ne!(text, STUDY);
            let why = Design::parse(&text, "study.toml").unwrap_err().to_string();
            assert!(why.contains(told) && why.contains("study.toml"), "{why}");
        };
        wrong("= 42", "= 40", "`participants` is `40`: 3 planners have 6 balanced orders");
        wrong("= 42", "= 40", "take 36 or 42");
        wrong("\"psi\"", "\"psy\"", "did you mean `psi`");
        wrong("length_s = 20", "length_s = 23.5", "films of `elevator` last 23.5 s and 20 s");
        wrong("id = \"q2b\"", "id = \"k7f\"", "two films have this name");
        wrong("id = \"q2b\"", "id = \"ha-1\"", "tells the planner `ha`");
        wrong("planner = \"ha\"", "planner = \"orca\"", "planners are mppi, ha, can");
        wrong("title", "tint = 1\ntitle", "line 2");
        wrong("instruments = [\"psi\"]", "", "nothing is asked");
    }
}
