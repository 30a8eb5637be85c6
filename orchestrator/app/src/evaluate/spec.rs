//! What an evaluation asks: requests × locations × repeats × arms.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use serde::Deserialize;
use socrates_model::AuthorSpec;

use crate::exit::Diagnostic;
use crate::protocol::Door;

/// Scenarios of one arm at most.
const MOST: usize = 20_000;
/// Where specifications come in.
const DOOR: Door = Door {
    what: "evaluation",
    shipped: &[
        ("paper", include_str!("../../../../prompts/protocols/paper.toml")),
        ("feedback", include_str!("../../../../prompts/protocols/feedback.toml")),
        ("faults", include_str!("../../../../prompts/protocols/faults.toml")),
        ("arms", include_str!("../../../../prompts/protocols/arms.toml")),
    ],
};

/// An evaluation.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Spec {
    /// Heading of the report.
    pub(super) title: String,
    /// Seed of the experiment: every scenario's own follows from it.
    #[serde(default = "one")]
    pub(super) seed: u64,
    /// A specification that comes with the program, for the requests and rates that this one does not have.
    like: Option<String>,
    /// Whether the table of injected faults and of the checks that find them is made. Default false.
    #[serde(default)]
    pub(super) confusion: bool,
    /// Shipped names or folders.
    pub(super) locations: Vec<String>,
    /// Requests with a rough scenario.
    #[serde(default)]
    pub(super) guided: Vec<Guided>,
    /// Requests without.
    pub(super) unguided: Option<Unguided>,
    /// Ways of authoring that are compared; the first is what the others are compared with.
    #[serde(default)]
    pub(super) arms: Vec<Arm>,
    /// Arms made by combining values.
    grid: Option<Grid>,
    /// Named rates of faults, as `--inject` takes them.
    #[serde(default)]
    pub(super) rates: BTreeMap<String, BTreeMap<String, f64>>,
}

/// A request with a rough scenario.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Guided {
    name: String,
    social_context: String,
    task: String,
    rough_scenario: String,
    /// How often at each location. Default 1.
    #[serde(default = "once")]
    repeats: u32,
}

/// Requests with context and task only.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Unguided {
    contexts: Vec<Context>,
    /// How often each at each location. Default 1.
    #[serde(default = "once")]
    repeats: u32,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct Context {
    social_context: String,
    task: String,
}

/// One way of authoring.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Arm {
    /// Name in tables.
    pub(super) name: String,
    /// What it is, in a sentence.
    #[serde(default)]
    pub(super) about: String,
    /// As `--author` takes it.
    pub(super) author: AuthorSpec,
    /// Configuration values, such as `{ "author.paths" = "nodes", "author.image" = "off" }`.
    #[serde(default)]
    pub(super) set: BTreeMap<String, toml::Value>,
    /// How often a refused answer is asked again with its reasons. Default as configured.
    pub(super) asks_again: Option<u32>,
    /// How often a scenario goes back after its run. Default as configured.
    pub(super) repairs: Option<u32>,
    /// Rates of faults, by name; none by default.
    pub(super) faults: Option<String>,
    /// The same for requests without a rough scenario; those of `faults` by default.
    pub(super) faults_unguided: Option<String>,
}

/// Arms that differ in configuration values, every combination of them.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct Grid {
    /// What they are, in a sentence.
    #[serde(default)]
    about: String,
    /// As `--author` takes it, which takes its place. Default: the offline author.
    #[serde(default)]
    author: AuthorSpec,
    /// Values of each configuration key.
    axes: BTreeMap<String, Vec<toml::Value>>,
}

/// Arms of a grid at most.
const MOST_ARMS: usize = 64;

impl Grid {
    /// How many combinations there are; none where an axis is empty.
    fn count(&self) -> usize {
        self.axes.values().map(Vec::len).fold(1, usize::saturating_mul)
    }

    fn arms(&self, author: Option<&AuthorSpec>) -> Vec<Arm> {
        let mut sets: Vec<BTreeMap<String, toml::Value>> = vec![BTreeMap::new()];
        for (key, values) in &self.axes {
            let with = |set: &BTreeMap<String, toml::Value>, value: &toml::Value| {
                set.iter()
                    .map(|(key, value)| (key.clone(), value.clone()))
                    .chain([(key.clone(), value.clone())])
                    .collect()
            };
            sets = sets.iter().flat_map(|set| values.iter().map(move |value| with(set, value))).collect();
        }
        let name = |set: &BTreeMap<String, toml::Value>| {
            let words = set.iter().map(|(key, value)| {
                let value = value.as_str().map_or_else(|| value.to_string(), str::to_owned);
                format!("{} {value}", key.rsplit('.').next().unwrap_or(key))
            });
            words.collect::<Vec<_>>().join(", ")
        };
        let author = author.unwrap_or(&self.author);
        let arm = |set: BTreeMap<String, toml::Value>| Arm {
            name: name(&set),
            about: self.about.clone(),
            author: author.clone(),
            set,
            ..Arm::default()
        };
        sets.into_iter().map(arm).collect()
    }
}

const fn one() -> u64 {
    1
}

const fn once() -> u32 {
    1
}

/// One scenario to be made by every arm.
#[derive(Debug, Clone)]
pub(super) struct Case {
    /// Name of its request.
    pub(super) request: String,
    /// Whether it has a rough scenario.
    pub(super) guided: bool,
    /// Location.
    pub(super) location: String,
    /// From 1.
    pub(super) repeat: u32,
    /// Its seed, the same for every arm.
    pub(super) seed: u64,
    /// The request as TOML.
    pub(super) toml: String,
}

impl Spec {
    /// The specification of this name, or of this file.
    pub(super) fn load(what: &Path) -> Result<Self, Diagnostic> {
        let mut spec: Self = DOOR.read(what)?;
        if let Some(name) = spec.like.take() {
            let shown = what.display().to_string();
            if !DOOR.ships(&name) || name == shown {
                return Err(Diagnostic::input(
                    format!("the evaluation `{shown}` is to be like `{name}`, which does not come with the program"),
                    format!("there is {}", DOOR.names()),
                ));
            }
            spec.take(Self::load(Path::new(&name))?);
        }
        let problems = spec.problems();
        if problems.is_empty() { Ok(spec) } else { Err(DOOR.refused(what, problems)) }
    }

    /// The specification with the arms of its grid behind its own, asked of this author where one is given.
    ///
    /// # Errors
    /// A diagnostic where an author is given and there is no grid that could take it.
    pub(super) fn with_grid(mut self, author: Option<&AuthorSpec>) -> Result<Self, Diagnostic> {
        match self.grid.take() {
            Some(grid) => self.arms.extend(grid.arms(author)),
            None => {
                if let Some(author) = author {
                    return Err(Diagnostic::input(
                        format!("`--author {author}` is for a specification with a `[grid]`, and this has none"),
                        "the arms of this one name their own authors; `evaluate author arms --author …` takes one",
                    ));
                }
            }
        }
        Ok(self)
    }

    /// Takes over what it does not have itself.
    fn take(&mut self, other: Self) {
        if self.guided.is_empty() && self.unguided.is_none() {
            (self.guided, self.unguided) = (other.guided, other.unguided);
        }
        for (name, rates) in other.rates {
            self.rates.entry(name).or_insert(rates);
        }
    }

    fn problems(&self) -> Vec<String> {
        let mut problems = Vec::new();
        let combined = self.grid.as_ref().map_or(0, Grid::count);
        if self.grid.is_some() && !(1..=MOST_ARMS).contains(&combined) {
            problems.push(format!("the axes of `[grid]` make {combined} arms; allowed: 1 to {MOST_ARMS}"));
        }
        for (what, count) in [("locations", self.locations.len()), ("arms", self.arms.len() + combined)] {
            // A table of faults is made without any arm.
            if count == 0 && !(what == "arms" && self.confusion) {
                problems.push(format!("`{what}` is empty; at least one is needed"));
            }
        }
        let mut seen = BTreeSet::new();
        for name in self.arms.iter().map(|arm| &arm.name).chain(self.guided.iter().map(|guided| &guided.name)) {
            if !seen.insert(name) {
                problems.push(format!("the name `{name}` is there twice"));
            }
        }
        for arm in &self.arms {
            for (key, rates) in [("faults", &arm.faults), ("faults_unguided", &arm.faults_unguided)] {
                if let Some(name) = rates.as_ref().filter(|name| !self.rates.contains_key(*name)) {
                    let known: Vec<&str> = self.rates.keys().map(String::as_str).collect();
                    problems.push(format!(
                        "arm `{}`: `{key} = \"{name}\"`: there is no [rates.{name}]; there is {}",
                        arm.name,
                        known.join(", ")
                    ));
                }
            }
            for (key, value) in [("asks_again", arm.asks_again), ("repairs", arm.repairs)] {
                if let Some(value) = value.filter(|value| *value > 10) {
                    problems.push(format!("arm `{}`: `{key}` is `{value}`; allowed: 0 to 10", arm.name));
                }
            }
        }
        match self.count() {
            0 => problems.push("it asks for no scenario: give [[guided]] or [unguided]".to_owned()),
            count if count > MOST => problems.push(format!("it asks for {count} scenarios an arm; at most {MOST}")),
            _ => {}
        }
        problems
    }

    /// Scenarios of one arm.
    fn count(&self) -> usize {
        let times = |repeats: u32| usize::try_from(repeats).unwrap_or(usize::MAX);
        let guided = self.guided.iter().map(|guided| times(guided.repeats)).fold(0_usize, usize::saturating_add);
        let unguided = self.unguided.as_ref().map_or(0, |all| all.contexts.len().saturating_mul(times(all.repeats)));
        guided.saturating_add(unguided).saturating_mul(self.locations.len())
    }

    /// Every scenario of an arm, in the order of the specification.
    pub(super) fn cases(&self) -> Vec<Case> {
        let mut cases = Vec::new();
        for location in &self.locations {
            for guided in &self.guided {
                let words = [&guided.social_context, &guided.task, &guided.rough_scenario];
                self.add(&mut cases, &guided.name, location, guided.repeats, words.map(String::as_str));
            }
            for (place, context) in (1..).zip(self.unguided.iter().flat_map(|all| &all.contexts)) {
                let repeats = self.unguided.as_ref().map_or(0, |all| all.repeats);
                let words = [context.social_context.as_str(), context.task.as_str(), ""];
                self.add(&mut cases, &format!("unguided-{place}"), location, repeats, words);
            }
        }
        cases
    }

    fn add(&self, cases: &mut Vec<Case>, request: &str, location: &str, repeats: u32, words: [&str; 3]) {
        let [social_context, task, rough] = words.map(|text| toml::Value::from(text).to_string());
        let guided = rough != "\"\"";
        let rough = if guided { format!("rough_scenario = {rough}\n") } else { String::new() };
        let place = toml::Value::from(location);
        for repeat in 1..=repeats {
            let drawn =
                socrates_model::seeds::derive_seed(self.seed, &["evaluate", request, location, &repeat.to_string()]);
            cases.push(Case {
                request: request.to_owned(),
                guided,
                location: location.to_owned(),
                repeat,
                // Short enough to be typed: `--seed` makes the same scenario again.
                seed: drawn % 1_000_000,
                toml: format!("location = {place}\nsocial_context = {social_context}\ntask = {task}\n{rough}"),
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shipped_one_is_the_papers_protocol() {
        let spec = Spec::load(Path::new("paper")).unwrap();
        let cases = spec.cases();
        assert_eq!(cases.len(), spec.count());
        let guided = cases.iter().filter(|case| case.guided).count();
        assert_eq!((guided, cases.len() - guided), (100, 40), "5 × 10 × 2 guided, 20 × 2 unguided");
        let seeds: BTreeSet<u64> = cases.iter().map(|case| case.seed).collect();
        assert!(seeds.len() > 138, "{} seeds", seeds.len());
        for arm in &spec.arms {
            for name in [&arm.faults, &arm.faults_unguided].into_iter().flatten() {
                let rates = spec.rates[name].iter().map(|(kind, rate)| (format!("fault.{kind}"), rate.to_string()));
                assert!(!socrates_author::FaultRates::from_settings(&rates.collect()).unwrap().is_clean());
            }
        }
    }

    #[test]
    fn what_is_like_another_has_its_requests_and_rates() {
        for name in ["feedback", "faults"] {
            let spec = Spec::load(Path::new(name)).unwrap();
            assert!(spec.cases().len() >= 140 && spec.rates.contains_key("paper-guided"), "{name}");
        }
        let told: Vec<String> = Spec::load(Path::new("feedback"))
            .unwrap()
            .arms
            .iter()
            .take(3)
            .map(|arm| arm.set["author.feedback"].to_string())
            .collect();
        assert_eq!(told, ["\"named\"", "\"vague\"", "\"none\""]);
        assert!(Spec::load(Path::new("faults")).unwrap().confusion);
    }

    #[test]
    fn a_grid_is_every_combination_asked_of_one_author() {
        let author: AuthorSpec = "openai:gpt-4o".parse().unwrap();
        let spec = Spec::load(Path::new("arms")).unwrap().with_grid(Some(&author)).unwrap();
        let names: BTreeSet<&str> = spec.arms.iter().map(|arm| arm.name.as_str()).collect();
        assert_eq!((spec.arms.len(), names.len()), (16, 16));
        assert!(names.contains("behaviors rules, feedback named, paths_by solver, reading model"), "{names:?}");
        assert!(spec.arms.iter().all(|arm| arm.author == author && arm.set.len() == 4));
        let none = Spec::load(Path::new("paper")).unwrap().with_grid(Some(&author)).unwrap_err();
        assert!(none.hint.contains("arms"), "{none:?}");
        let text = "title = \"x\"\nlike = \"paper\"\nlocations = [\"office\"]\n[grid]\naxes = { a = [] }\n";
        let empty: Spec = toml::from_str(text).unwrap();
        assert!(empty.problems().join("\n").contains("make 0 arms; allowed: 1 to 64"));
    }

    #[test]
    fn what_cannot_be_done_is_said_line_by_line() {
        let text = "title = \"x\"\nlocations = []\n[[arms]]\nname = \"a\"\nauthor = \"offline\"\nfaults = \"none\"\nrepairs = 99\n";
        let spec: Spec = toml::from_str(text).unwrap();
        let problems = spec.problems().join("\n");
        for part in ["`locations` is empty", "no [rates.none]", "`repairs` is `99`", "asks for no scenario"] {
            assert!(problems.contains(part), "{part} in {problems}");
        }
        assert!(Spec::load(Path::new("nowhere.toml")).unwrap_err().hint.contains("paper"));
        assert!(toml::from_str::<Spec>("title = 1").is_err() && toml::from_str::<Spec>("titel = \"x\"").is_err());
    }
}
