//! Whole runs on the shipped locations with the reference robot: many ways, every relation.
#![expect(clippy::print_stdout, reason = "what went wrong in which of many runs is told run by run")]

use std::collections::BTreeMap;

use socrates_model::PlaceClass;

use crate::common::scenario::{look_through, place, relations, run, scenario, ways};

/// Number of ways per way that the gate plays.
const SAMPLE: usize = 37 * 8;
/// Runs of the sample that are known to miss: three crossings in the warehouse.
const KNOWN: u32 = 3;

#[test]
fn on_a_few_ways_of_every_shipped_location_the_reference_arrives_and_meets_everybody() {
    let found = look_at(SAMPLE);
    assert!(found.runs == 55 && found.bad <= KNOWN, "{} of {}: {}", found.bad, found.runs, found.lines.join("\n"));
}

#[test]
#[ignore = "sweep: one in 34 ways of every shipped location, every relation, at most 5 % with troubles"]
fn on_every_shipped_location_the_reference_arrives_and_meets_everybody() {
    let Found { runs, bad, lines, berths } = look_at(34);
    assert!(runs > 300 && f64::from(bad) <= 0.05 * f64::from(runs), "{bad} of {runs}: {}", lines.join("\n"));
    // Nine of ten runs keep 0.28 m between robot and person; a person in a doorway is passed nearer.
    for relation in ["ahead", "frontal", "crossing"] {
        assert!(berths[relation] >= 0.28, "{relation}: {berths:?}");
    }
    // A person who overtakes has the space that a narrow floor leaves beside the robot.
    assert!(berths["behind"] >= 0.2, "{berths:?}");
}

/// Findings of many runs.
struct Found {
    runs: u32,
    /// Runs in which anything is wrong.
    bad: u32,
    /// Troubles, run by run.
    lines: Vec<String>,
    /// Lower decile of the distances kept, m, by relation.
    berths: BTreeMap<&'static str, f64>,
}

/// Runs on one way in `every`.
fn look_at(every: usize) -> Found {
    let (mut runs, mut bad) = (0_u32, 0_u32);
    let mut lines = Vec::new();
    let mut per: BTreeMap<&'static str, Vec<(f64, f64)>> = BTreeMap::new();
    for name in socrates_maps::shipped::names() {
        let location = place(name);
        for way in ways(&location, every) {
            for (relation, cast, node) in relations(&location, &way) {
                let made = scenario(&location, way.clone(), vec![cast], &[Some(node.clone())], vec![], false);
                // One behind the other they pass the node one after the other; people let the robot out of a room first.
                let out = location.graph.kind(&way[0]) == Some(PlaceClass::Room);
                let loose = if relation == "ahead" || relation == "behind" || out { 4.0 } else { 1.5 };
                let found = look_through(&run(made, "reference"), 1, loose);
                runs += 1;
                per.entry(relation).or_default().push((found.closest_m, found.gaps.first().copied().unwrap_or(99.0)));
                let (from, to) = (&way[0], &way[way.len() - 1]);
                if !found.troubles.is_empty() {
                    bad += 1;
                    lines.push(format!("{name} {relation} {from} → {to} at {node}: {}", found.troubles.join(" · ")));
                } else if found.closest_m < 0.25 {
                    lines.push(format!("{name} {relation} {from} → {to} at {node}: near {:.2}", found.closest_m));
                }
            }
        }
    }
    println!("{}", lines.join("\n"));
    let mut berths: BTreeMap<&'static str, f64> = BTreeMap::new();
    for (relation, all) in &mut per {
        let mut near: Vec<f64> = all.iter().map(|(near, _)| *near).collect();
        let mut gaps: Vec<f64> = all.iter().map(|(_, gap)| *gap).collect();
        near.sort_by(f64::total_cmp);
        gaps.sort_by(f64::total_cmp);
        let at = |list: &[f64], share: f64| list[((list.len() - 1) as f64 * share) as usize];
        berths.insert(*relation, at(&near, 0.1));
        println!(
            "{relation}: {} runs, closest {:.2} / 5 % {:.2} / 20 % {:.2} / median {:.2} m, gap median {:.2} s",
            near.len(),
            near[0],
            at(&near, 0.05),
            at(&near, 0.2),
            at(&near, 0.5),
            at(&gaps, 0.5)
        );
    }
    println!("{bad} of {runs} runs with troubles");
    Found { runs, bad, lines, berths }
}
