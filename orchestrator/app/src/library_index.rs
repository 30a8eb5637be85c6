//! The list of a library: one file at the root of a folder of bundles.

use std::collections::{BTreeMap, VecDeque};
use std::path::Path;

use serde::{Deserialize, Serialize};
use socrates_checks::check_repeats;
use socrates_model::likeness::Kind;
use socrates_model::{Digest, Likeness, Reading, ScenarioEnd, ScenarioId, Verdict};

use crate::bundle;
use crate::exit::{Code, Diagnostic};
use crate::keep::Keep;
use crate::shard::Shard;

/// A scenario is compared with at most so many different ones of its kind, the newest: a library of a hundred thousand is no reason
/// for ten thousand million comparisons.
const COMPARED: usize = 500;
/// File that lists a library.
pub(crate) const FILE: &str = "library.json";

/// One scenario of a library.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Row {
    /// Which.
    pub(crate) scenario: ScenarioId,
    /// Name of its request.
    #[serde(default)]
    pub(crate) request: String,
    /// Its folder or file in the library; empty where its bundle was not kept.
    pub(crate) bundle: String,
    /// Verdict, or `failed` where no bundle could be made.
    pub(crate) verdict: ScenarioEnd,
    /// Why there is no bundle; empty where there is one.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub(crate) reason: String,
    /// The earlier scenario that it repeats (P-DUP).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) repeats: Option<ScenarioId>,
}

impl Row {
    /// The row of somebody who looks from outside: where its bundle lies with the folder of the library before it.
    pub(crate) fn seen_from(&self, root: &Path) -> Self {
        let bundle = match self.bundle.as_str() {
            "" => String::new(),
            bundle => root.join(bundle).display().to_string(),
        };
        Self { bundle, ..self.clone() }
    }
}

/// Which share of a batch a library is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Part {
    /// Which share.
    pub(crate) shard: Shard,
    /// What the whole batch is made from.
    pub(crate) whole: Digest,
}

/// A finished library.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Library {
    /// What it was made from.
    pub(crate) wish: Digest,
    /// Which share of a batch it is; none where it is whole.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) shard: Option<Part>,
    /// Which bundles it keeps; none in lists of earlier versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) keep: Option<Keep>,
    /// Scenarios asked for.
    pub(crate) count: u64,
    /// Readings of its requests.
    pub(crate) readings: Vec<Reading>,
    /// Scenarios, in order of submission.
    pub(crate) scenarios: Vec<Row>,
}

/// The library of a folder, if it is one.
pub(crate) fn read(root: &Path) -> Option<Library> {
    serde_json::from_str(&std::fs::read_to_string(root.join(FILE)).ok()?).ok()
}

/// The same of a folder that must be one.
///
/// # Errors
/// A list that is gone or cannot be understood, with file and line.
pub(crate) fn read_whole(root: &Path) -> Result<Library, Diagnostic> {
    let path = root.join(FILE);
    let hint = "the list was changed by hand or is damaged: make the library again in an empty folder";
    let bad = |why: String| Diagnostic::input(format!("`{}`: {why}", path.display()), hint);
    let text = std::fs::read_to_string(&path).map_err(|why| bad(why.to_string()))?;
    serde_json::from_str(&text).map_err(|why| bad(why.to_string()))
}

/// Writes the list.
pub(crate) fn write(root: &Path, library: &Library) -> Result<(), Diagnostic> {
    let path = root.join(FILE);
    let text = serde_json::to_string_pretty(library)
        .map_err(|why| Diagnostic::input(why.to_string(), "").with_code(Code::Ours))?;
    std::fs::write(&path, text).map_err(|why| {
        Diagnostic::input(format!("cannot write `{}`: {why}", path.display()), "--out chooses another folder")
    })
}

/// Finds scenarios that repeat earlier ones.
#[derive(Debug, Default)]
pub(crate) struct Repeats {
    made: BTreeMap<Kind, VecDeque<(ScenarioId, Likeness)>>,
    /// The first that failed, by request and reason.
    failed: BTreeMap<(String, String), ScenarioId>,
}

impl Repeats {
    /// The earlier scenario that this one repeats; it is remembered itself where it repeats none.
    pub(crate) fn of(&mut self, id: &ScenarioId, scenario: Likeness) -> Option<ScenarioId> {
        let alike = self.made.entry(scenario.kind.clone()).or_default();
        let earlier = alike.iter().find(|(other, earlier)| check_repeats(&scenario, other, earlier).is_some());
        if let Some((other, _)) = earlier {
            return Some(other.clone());
        }
        self.remember(id, scenario);
        None
    }

    /// The same for a scenario of a list, which says already what it repeats: nothing is compared, unless what it repeats is no
    /// longer `there`.
    pub(crate) fn of_listed(
        &mut self,
        id: &ScenarioId,
        scenario: Likeness,
        listed: Option<&ScenarioId>,
        there: impl Fn(&ScenarioId) -> bool,
    ) -> Option<ScenarioId> {
        match listed {
            Some(earlier) if there(earlier) => Some(earlier.clone()),
            Some(_) => self.of(id, scenario),
            None => {
                self.remember(id, scenario);
                None
            }
        }
    }

    /// Remembers a scenario that repeats none.
    fn remember(&mut self, id: &ScenarioId, scenario: Likeness) {
        let alike = self.made.entry(scenario.kind.clone()).or_default();
        if alike.len() == COMPARED {
            alike.pop_front();
        }
        alike.push_back((id.clone(), scenario));
    }

    /// The earlier scenario of the same request that failed for the same reason; it is remembered itself where there is none.
    pub(crate) fn of_failed(&mut self, id: &ScenarioId, request: &str, reason: &str) -> Option<ScenarioId> {
        let alike = (request.to_owned(), reason.to_owned());
        let earlier = self.failed.get(&alike).cloned();
        if earlier.is_none() {
            self.failed.insert(alike, id.clone());
        }
        earlier
    }
}

/// Scenarios by verdict, the most frequent first: `12 realised · 3 contradicted`.
fn counted<'a>(rows: impl Iterator<Item = &'a Row>) -> String {
    let mut verdicts = BTreeMap::<ScenarioEnd, u64>::new();
    rows.for_each(|row| *verdicts.entry(row.verdict).or_default() += 1);
    let mut verdicts: Vec<(ScenarioEnd, u64)> = verdicts.into_iter().collect();
    verdicts.sort_by_key(|(verdict, count)| (std::cmp::Reverse(*count), *verdict));
    let words: Vec<String> = verdicts.iter().map(|(verdict, count)| format!("{count} {verdict}")).collect();
    words.join(" · ")
}

impl Library {
    /// A library of `count` scenarios, before any of them is listed.
    pub(crate) fn new(
        wish: Digest,
        shard: Option<Part>,
        keep: Option<Keep>,
        count: usize,
        readings: Vec<Reading>,
    ) -> Self {
        let count = u64::try_from(count).unwrap_or(u64::MAX);
        Self { wish, shard, keep, count, readings, scenarios: Vec::new() }
    }

    /// Which bundles it keeps: as it says, else as its bundles lie; none where they leave it open.
    pub(crate) fn keeps(&self) -> Option<Keep> {
        let made = || self.scenarios.iter().filter(|row| row.verdict != ScenarioEnd::Failed);
        let by_bundles = || {
            let is_realised = |row: &Row| row.verdict == ScenarioEnd::Judged(Verdict::Realised);
            let bundled = made().filter(|row| !row.bundle.is_empty()).count();
            let packed = made().any(|row| row.bundle.ends_with(bundle::PACKED));
            match (bundled, made().count()) {
                (0, _) => made().any(|row| !is_realised(row)).then_some(Keep::Index),
                (some, all) if some < all => Some(Keep::Failed),
                // Of those that were not realised alone, it may be those or all that are kept.
                _ if packed => made().any(is_realised).then_some(Keep::Packed),
                _ => Some(Keep::Folders),
            }
        };
        self.keep.or_else(by_bundles)
    }

    /// Names of the scenarios whose bundles it does not keep.
    pub(crate) fn unbundled(&self) -> impl Iterator<Item = &ScenarioId> {
        let kept = self.scenarios.iter().filter(|row| row.bundle.is_empty() && row.verdict != ScenarioEnd::Failed);
        kept.map(|row| &row.scenario)
    }

    /// Scenarios that repeat no earlier one.
    pub(crate) fn distinct(&self) -> impl Iterator<Item = &Row> {
        self.scenarios.iter().filter(|row| row.repeats.is_none())
    }

    /// What is in it, in lines: how many were made, and how many different ones those are.
    pub(crate) fn told(&self) -> Vec<String> {
        let mut lines = vec![format!("made       {} of {}", self.scenarios.len(), self.count)];
        if let (Some(made), false) = (lines.first_mut(), self.scenarios.is_empty()) {
            made.push_str(&format!(" · {}", counted(self.scenarios.iter())));
        }
        let repeats = self.scenarios.iter().filter(|row| row.repeats.is_some()).count();
        if repeats > 0 {
            lines.push(format!("distinct   {} · {}", self.distinct().count(), counted(self.distinct())));
            lines.push(format!(
                "repeats    {repeats} repeat an earlier one (P-DUP): a share of the distinct ones is what counts"
            ));
        }
        lines
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn a_scenario_that_fails_as_an_earlier_one_did_repeats_it() {
        let id = |name: &str| ScenarioId::new(name).unwrap();
        let mut repeats = Repeats::default();
        assert_eq!(repeats.of_failed(&id("a"), "hall", "no way"), None);
        assert_eq!(repeats.of_failed(&id("b"), "hall", "no way"), Some(id("a")));
        assert_eq!(repeats.of_failed(&id("c"), "hall", "too narrow"), None);
        assert_eq!(repeats.of_failed(&id("d"), "ward", "no way"), None);
    }

    #[test]
    fn what_a_list_says_is_not_compared_again() {
        let id = |name: &str| ScenarioId::new(name).unwrap();
        let office = socrates_maps::shipped::load("office").unwrap();
        let of = |role: &str| {
            let human = json!({ "id": "human_1", "role": role, "behavior": "b", "relation": "frontal" });
            let proposal = json!({
                "format": 1, "title": "t", "description": "d", "pattern": "p", "place": "corridor", "humans": [human],
                "robot": { "task": "t", "expected_behavior": "e" }, "expected_events": [], "author": "a",
            });
            let paths = json!({ "format": 1, "robot": [], "humans": {}, "encounters": [], "author": "a" });
            let paths = serde_json::from_value(paths).unwrap();
            Likeness::of(&serde_json::from_value(proposal).unwrap(), &paths, &office)
        };
        let mut repeats = Repeats::default();
        let one = of("nurse");
        assert_eq!(repeats.of_listed(&id("a"), one.clone(), None, |_| true), None);
        // The same person, and yet the list says that it repeats none; another, and it says that it does.
        assert_eq!(repeats.of_listed(&id("b"), one.clone(), None, |_| true), None);
        let other = of("visitor");
        assert_eq!(repeats.of_listed(&id("c"), other.clone(), Some(&id("a")), |_| true), Some(id("a")));
        // What it repeats is gone: it is compared, and is the first of its kind.
        assert_eq!(repeats.of_listed(&id("d"), other.clone(), Some(&id("gone")), |_| false), None);
        assert_eq!((repeats.of(&id("e"), other), repeats.of(&id("f"), one)), (Some(id("d")), Some(id("a"))));
    }

    #[test]
    fn distinct_scenarios_are_counted_beside_all() {
        let row = |name: &str, verdict: &str, repeats: Option<&str>| Row {
            scenario: ScenarioId::new(name).unwrap(),
            request: "hall".to_owned(),
            bundle: name.to_owned(),
            verdict: verdict.parse().unwrap(),
            reason: String::new(),
            repeats: repeats.map(|other| ScenarioId::new(other).unwrap()),
        };
        let mut library = Library {
            wish: Digest::of(b"wish"),
            shard: None,
            keep: None,
            count: 4,
            readings: Vec::new(),
            scenarios: vec![
                row("a", "realised", None),
                row("b", "realised", Some("a")),
                row("c", "realised", Some("a")),
                row("d", "contradicted", None),
            ],
        };
        let told = library.told();
        assert_eq!(told[0], "made       4 of 4 · 3 realised · 1 contradicted");
        assert_eq!(told[1], "distinct   2 · 1 contradicted · 1 realised");
        assert!(told[2].starts_with("repeats    2 repeat"), "{told:?}");
        library.scenarios.iter_mut().for_each(|row| row.repeats = None);
        assert_eq!(library.told().len(), 1, "nothing is said of repeats where there are none");
    }
}
