//! How scenarios ended under each policy, as numbers to be colored: realised, judged otherwise, or failed by class.

use std::collections::BTreeMap;

use crate::results::CellResult;
use crate::tables::class_name;

/// What is said of a scenario that never ended.
const OPEN: &str = "never ended";
/// The end that is wished for; it stands first.
pub const REALISED: &str = "realised";

/// How the scenarios of some cells ended, a row for each policy.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Heat {
    /// Workload, fault, rate.
    pub title: String,
    /// The policies, in their order.
    pub rows: Vec<HeatRow>,
}

/// How the scenarios of a cell ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct HeatRow {
    /// Policy.
    pub policy: String,
    /// Scenarios.
    pub of: usize,
    /// Scenarios by how they ended.
    pub ends: BTreeMap<&'static str, usize>,
}

/// A table for each workload and fault that is put in, at its highest rate and with the most tries.
#[must_use]
pub fn heats(results: &[CellResult]) -> Vec<Heat> {
    let mut heats: Vec<Heat> = Vec::new();
    let mut from = 0;
    while let Some(first) = results.get(from) {
        let same = |one: &&CellResult| {
            one.cell.workload.name == first.cell.workload.name && one.cell.strike.shown() == first.cell.strike.shown()
        };
        let group: Vec<&CellResult> = results.iter().skip(from).take_while(same).collect();
        from += group.len().max(1);
        let rate = group.iter().map(|one| one.cell.rate).fold(0.0, f64::max);
        let tries = group.iter().map(|one| one.cell.tries).max().unwrap_or(0);
        let extreme = group.iter().filter(|one| one.cell.rate >= rate && one.cell.tries == tries);
        let rows = extreme.map(|one| row(one)).collect();
        let fault = if first.cell.strike.kinds.is_empty() {
            String::new()
        } else {
            format!(" · {} {} %", first.cell.strike.shown(), (rate * 1e6).round() / 1e4)
        };
        heats.push(Heat { title: format!("{}{fault}, {tries} tries", first.cell.workload.name), rows });
    }
    heats
}

fn row(one: &CellResult) -> HeatRow {
    let mut ends: BTreeMap<&'static str, usize> = BTreeMap::new();
    for scenario in &one.scenarios {
        let end = match (scenario.end, scenario.failed) {
            (_, Some((_, class))) => class_name(class),
            (Some(end), None) => end.name(),
            (None, None) => OPEN,
        };
        *ends.entry(end).or_default() += 1;
    }
    HeatRow { policy: one.cell.policy.name.clone(), of: one.scenarios.len(), ends }
}

/// The ends that occur in any of them: the one that is wished for first, then the most frequent ones.
#[must_use]
pub fn ends(heats: &[Heat]) -> Vec<&'static str> {
    let mut sums: BTreeMap<&'static str, usize> = BTreeMap::new();
    for (end, count) in heats.iter().flat_map(|heat| &heat.rows).flat_map(|row| &row.ends) {
        *sums.entry(end).or_default() += count;
    }
    sums.entry(REALISED).or_default();
    let mut all: Vec<(&'static str, usize)> = sums.into_iter().collect();
    all.sort_by_key(|(end, count)| (*end != REALISED, std::cmp::Reverse(*count)));
    all.into_iter().map(|(end, _)| end).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laws::{played, spec};

    #[test]
    fn every_scenario_is_counted_once_by_the_class_that_ended_it() {
        let spec = spec(serde_json::json!({
            "title": "heat", "scenarios": 80, "policies": ["none", "jitter"], "tries": [1, 3],
            "fault": [{ "kinds": ["worker_kill"], "rates": [0.0, 0.2] }, { "kinds": ["overload"], "rates": [0.2] }],
        }));
        let results: Vec<CellResult> = played(&spec).into_iter().map(|(result, _)| result).collect();
        let heats = heats(&results);
        assert_eq!(
            heats.iter().map(|heat| heat.title.as_str()).collect::<Vec<_>>(),
            ["plain · worker_kill 20 %, 3 tries", "plain · overload 20 %, 3 tries"]
        );
        for (heat, class) in heats.iter().zip(["worker lost", "overload"]) {
            let [none, jitter] = &heat.rows[..] else { panic!("{heat:?}") };
            assert_eq!((none.policy.as_str(), jitter.policy.as_str()), ("none", "jitter"));
            assert_eq!(none.ends.values().sum::<usize>(), 80);
            assert!(none.ends[class] > 20 && none.ends.len() == 2, "{none:?}");
            assert!(jitter.ends.get(class).copied().unwrap_or(0) < none.ends[class], "{jitter:?}");
        }
        assert_eq!(ends(&heats)[0], REALISED);
        assert!(ends(&heats).contains(&"overload"));
        assert_eq!(ends(&[]), [REALISED]);
    }
}
