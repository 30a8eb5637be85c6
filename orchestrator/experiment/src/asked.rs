//! What an orchestrator is handed: the scenarios of a batch.

use std::collections::BTreeMap;

use socrates_model::job::Stage;
use socrates_model::wire::ScenarioSpec;
use socrates_model::{Digest, PlannerName, Role, ScenarioId};

use crate::spec::{AUTHORED, Cell, Spec};

/// Name of the batch.
pub const BATCH: &str = "experiment";
/// What the jobs say of their author: rates are kept by its server.
const AUTHOR: &str = "openai:simulated";
/// What location and reading hold; nobody looks into them.
const GIVEN: [&str; 2] = ["location", "reading"];

/// Stages of a cell that ask an author.
pub(crate) fn of_authors(cell: &Cell) -> Vec<Stage> {
    AUTHORED.into_iter().filter(|stage| cell.workload.asks.of(*stage).is_some()).collect()
}

/// The scenarios of a batch with their numbers, from 0 in the whole experiment.
#[must_use]
pub fn asked(spec: &Spec, cell: &Cell, batch: u32) -> Vec<(u32, ScenarioSpec)> {
    let text = |text: &str| Digest::of(text.as_bytes());
    let given = Role::PINNED.into_iter().zip(AUTHORED).filter(|(_, stage)| cell.workload.asks.of(*stage).is_none());
    let pinned: BTreeMap<Role, Digest> = given.map(|(role, _)| (role, text(role.name()))).collect();
    let settings = [("author", AUTHOR), ("cache", "off")].map(|(key, value)| (key.to_owned(), value.to_owned()));
    let [location, reading] = GIVEN.map(text);
    let one = |number: u32| {
        let id = ScenarioId::new(format!("s{number:07}")).ok()?;
        let scenario = ScenarioSpec {
            request: text(id.as_str()),
            id,
            location,
            reading,
            seed: u64::from(number),
            planners: vec![PlannerName::reference()],
            run_seeds: vec![1],
            pinned: pinned.clone(),
            settings: settings.clone().into(),
            review: false,
            order: None,
        };
        Some((number, scenario))
    };
    spec.scenarios_of(batch).filter_map(one).collect()
}

/// The texts behind the content addresses of these scenarios.
#[must_use]
pub fn texts(scenarios: &[(u32, ScenarioSpec)]) -> Vec<String> {
    let shared = GIVEN.into_iter().chain(Role::PINNED.map(|role| role.name())).map(str::to_owned);
    shared.chain(scenarios.iter().map(|(_, scenario)| scenario.id.as_str().to_owned())).collect()
}

/// The number of a scenario; none where it is not one of these.
#[must_use]
pub fn number(id: &ScenarioId) -> Option<u32> {
    id.as_str().strip_prefix('s')?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laws::spec;

    #[test]
    fn every_text_that_a_scenario_names_is_handed_out_with_it() {
        let spec = spec(serde_json::json!({
            "title": "asked", "scenarios": 5, "batch": 3, "policies": ["none"],
            "workload": [{ "name": "one", "asks": { "paths": 1.0 } }],
        }));
        let scenarios = asked(&spec, &spec.cells()[0], 1);
        assert_eq!(scenarios.iter().map(|(number, _)| *number).collect::<Vec<_>>(), [3, 4]);
        let there: Vec<Digest> = texts(&scenarios).iter().map(|text| Digest::of(text.as_bytes())).collect();
        for (of, scenario) in &scenarios {
            assert_eq!(number(&scenario.id), Some(*of));
            assert_eq!(scenario.pinned.len(), 2, "what is not asked is given");
            let named = [&scenario.request, &scenario.location, &scenario.reading];
            assert!(named.into_iter().chain(scenario.pinned.values()).all(|digest| there.contains(digest)));
        }
    }
}
