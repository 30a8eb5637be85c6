//! What holds of every metric.

use std::collections::BTreeSet;

use socrates_model::Recording;

use super::*;
use crate::evidence::Evidence;
use crate::fidelity::Signals;
use crate::fixture::{Walk, recording};
use crate::tracks::Tracks;

/// One metric of a run.
pub(crate) fn value_of(evidence: &Evidence<'_>, id: &str) -> Option<f64> {
    let tracks = Tracks::read(evidence.recording).unwrap();
    let signals = Signals::new(evidence, &tracks);
    let values = measure(&Scene::new(&signals));
    values.into_iter().find(|value| value.id == id).unwrap_or_else(|| panic!("no metric {id}")).value
}

pub(crate) fn value(run: &Recording, id: &str) -> Option<f64> {
    value_of(&Evidence::of(run), id)
}

/// Asserts a value to a tolerance at 10 Hz and at 100 Hz.
pub(crate) fn at_both_rates(walks: &dyn Fn() -> Vec<Walk>, seconds: f64, id: &str, wanted: f64, tolerance: f64) {
    for step in [0.1, 0.01] {
        let found = value(&recording(&walks(), seconds, step), id).unwrap_or_else(|| panic!("{id} has no value"));
        assert!((found - wanted).abs() <= tolerance, "{id} at a step of {step} s: {found}, wanted {wanted}");
    }
}

#[test]
fn every_family_has_its_sheets_in_the_file_and_no_sheet_is_of_none() {
    let file: BTreeMap<String, Vec<Sheet>> = toml::from_str(FILE).unwrap();
    let named: BTreeSet<&str> = CATALOG.iter().map(|family| family.name).collect();
    assert_eq!(file.keys().map(String::as_str).collect::<BTreeSet<_>>(), named);
    assert_eq!(named.len(), CATALOG.len());
}

#[test]
fn ids_are_unique_and_every_family_gives_as_many_values_as_sheets() {
    let ids: BTreeSet<&str> = sheets().map(|sheet| sheet.id).collect();
    assert_eq!(ids.len(), sheets().count());
    assert!(ids.len() >= 60, "{}", ids.len());
    let run = recording(&[Walk::robot(0., 0., 0.5, 0.), Walk::human(1, 6., 1., -1., 0.)], 10.0, 0.1);
    let evidence = Evidence::of(&run);
    let tracks = Tracks::read(&run).unwrap();
    let signals = Signals::new(&evidence, &tracks);
    let scene = Scene::new(&signals);
    let at = |family: &Family| CATALOG.iter().position(|other| other.name == family.name).unwrap();
    for family in CATALOG.iter().filter(|family| family.sheets().iter().any(|s| scene.lacks(s.needs).is_none())) {
        let values = match family.measure {
            Measure::Online(_) => scene.online()[at(family)].len(),
            Measure::Whole { measure, .. } => measure(&scene).len(),
        };
        assert_eq!(values, family.sheets().len(), "{}", family.sheets()[0].id);
    }
    for sheet in sheets() {
        assert!(!sheet.about.is_empty() && !sheet.source.is_empty() && !sheet.unit.is_empty(), "{}", sheet.id);
    }
}

#[test]
fn every_test_named_on_the_page_of_differences_exists() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let page = std::fs::read_to_string(root.join("WHY_OUR_NUMBER_DIFFERS.md")).unwrap();
    let mut found = 0;
    for name in page.split('`').filter(|word| word.contains("::tests::")) {
        let (module, test) = name.split_once("::tests::").unwrap();
        let path = root.join("src").join(module.replace("::", "/"));
        let files = [path.with_extension("rs"), path.join("mod.rs"), path.join("tests.rs")];
        let text: String = files.iter().filter_map(|file| std::fs::read_to_string(file).ok()).collect();
        assert!(text.contains(&format!("fn {test}()")), "{name} is no test");
        found += 1;
    }
    assert!(found >= 30, "{found}");
    for id in page.split('`').filter(|word| word.starts_with("hunav.") && word.len() > 6) {
        assert!(sheet(id).is_some(), "{id} is no metric");
    }
}

#[test]
fn every_name_of_the_table_is_a_metric_of_ours() {
    for (name, ours) in francis::NAMES {
        assert!(sheet(ours).is_some(), "{name} is {ours}, which is no metric");
    }
    assert_eq!(sheets().filter(|sheet| sheet.id.starts_with("hunav.")).count(), 29);
}

#[test]
fn a_run_that_begins_later_has_the_same_values() {
    let walks = [Walk::robot(0., 0., 0.6, 0.), Walk::human(1, 9., 0.6, -1., 0.)];
    let plain = recording(&walks, 12.0, 0.05);
    let mut late = plain.clone();
    for state in &mut late.frames {
        state.tick += 400;
    }
    for sheet in sheets() {
        match (value(&plain, sheet.id), value(&late, sheet.id)) {
            (Some(a), Some(b)) => assert!((a - b).abs() < 1e-6, "{}: {a} and {b}", sheet.id),
            (None, None) => {}
            other => panic!("{}: {other:?}", sheet.id),
        }
    }
}

#[test]
fn who_is_not_there_counts_for_nothing() {
    let alone = recording(&[Walk::robot(-4., 0., 0.5, 0.), Walk::human(1, 0., 3., 0., 0.)], 16.0, 0.1);
    // One stands on the robot's way and comes to be when the robot has passed; another is never there.
    let walks = [
        Walk::robot(-4., 0., 0.5, 0.),
        Walk::human(1, 0., 3., 0., 0.),
        Walk::human(2, -1., 0., 0., 0.),
        Walk::human(3, 0., 0.1, 0., 0.),
    ];
    let mut run = recording(&walks, 16.0, 0.1);
    crate::fixture::absent(&mut run, 2, 0.0..15.0);
    crate::fixture::absent(&mut run, 3, 0.0..99.0);
    let beside = |run: &Recording, id: &str| value(run, id).unwrap();
    assert!(beside(&run, "human_collisions") + beside(&run, "near_misses") < 1e-9);
    assert!((beside(&run, "human_distance_min") - beside(&alone, "human_distance_min")).abs() < 1e-9);
    // From 15 s on, two are there: the one left behind 4.5 m away or more.
    assert!((beside(&run, "personal_entries") - beside(&alone, "personal_entries")).abs() < 1e-9);
    let tracks = Tracks::read(&run).unwrap();
    assert_eq!(tracks.humans.len(), 2);
    let evidence = Evidence::of(&run);
    let signals = Signals::new(&evidence, &tracks);
    assert!(crate::fidelity::judge(&signals).flaws.is_empty());
    crate::fixture::absent(&mut run, 2, 0.0..99.0);
    for sheet in sheets() {
        assert_eq!(value(&run, sheet.id), value(&alone, sheet.id), "{}", sheet.id);
    }
}

#[test]
fn outside_its_own_record_the_robot_is_not_there() {
    use socrates_model::AgentId;
    // Recorded for its first six seconds only; a person walks over the place of its last sample later on.
    let walks = [Walk::robot(0., 0., 0.5, 0.), Walk::human(1, 12., 0., -0.9, 0.)];
    let short = recording(&walks, 6.0, 0.1);
    let mut long = recording(&walks, 20.0, 0.1);
    crate::fixture::gone(&mut long, AgentId::Robot, 6.05..99.0);
    for sheet in sheets().filter(|sheet| !sheet.as_coded_elsewhere()) {
        match (value(&short, sheet.id), value(&long, sheet.id)) {
            // Its last velocity is the same too, so nothing differs.
            (Some(a), Some(b)) => assert!((a - b).abs() < 1e-6, "{}: {a} and {b}", sheet.id),
            (None, None) => {}
            other => panic!("{}: {other:?}", sheet.id),
        }
    }
    assert_eq!(value(&long, "near_misses"), Some(0.0));
    assert_eq!(value(&long, "stalled_time"), Some(0.0));
    // Nobody who comes when it has gone is met.
    crate::fixture::absent(&mut long, 1, 0.0..6.5);
    assert_eq!(value(&long, "human_distance_min"), None);
}

#[test]
fn velocities_that_are_recorded_change_nothing() {
    let walks = [Walk::robot(0., 0., 0.6, 0.), Walk::human(1, 9., 0.6, -1., 0.)];
    let plain = recording(&walks, 12.0, 0.05);
    let mut without = plain.clone();
    for state in &mut without.frames {
        (state.vx, state.vy) = (0.0, 0.0);
    }
    for sheet in sheets().filter(|sheet| !sheet.as_coded_elsewhere()) {
        assert_eq!(value(&plain, sheet.id), value(&without, sheet.id), "{}", sheet.id);
    }
}

#[test]
fn missing_data_is_a_note_and_never_zero() {
    let run = recording(&[Walk::robot(0., 0., 0.5, 0.)], 4.0, 0.1);
    let evidence = Evidence::of(&run);
    let tracks = Tracks::read(&run).unwrap();
    let signals = Signals::new(&evidence, &tracks);
    for value in measure(&Scene::new(&signals)) {
        let Some(needs) = sheet(&value.id).map(|sheet| sheet.needs) else { continue };
        if needs.contains(&Need::Humans) || needs.contains(&Need::Map) || needs.contains(&Need::Goal) {
            assert_eq!(value.value, None, "{}", value.id);
            assert!(value.note.starts_with("not applicable: "), "{}", value.id);
        }
    }
}

#[test]
fn values_do_not_change_when_the_world_is_moved_turned_or_renamed() {
    let turn = |x: f64, y: f64| (3.0 - y, 7.0 + x);
    let plain = recording(
        &[Walk::robot(0., 0., 0.6, 0.), Walk::human(1, 9., 0.6, -1., 0.), Walk::human(2, 4., -3., 0., 0.8)],
        12.0,
        0.05,
    );
    let moved = {
        let (r, a, b) = (turn(0., 0.), turn(9., 0.6), turn(4., -3.));
        recording(
            &[Walk::robot(r.0, r.1, 0., 0.6), Walk::human(1, b.0, b.1, -0.8, 0.), Walk::human(2, a.0, a.1, 0., -1.)],
            12.0,
            0.05,
        )
    };
    for sheet in sheets().filter(|sheet| !sheet.as_coded_elsewhere()) {
        match (value(&plain, sheet.id), value(&moved, sheet.id)) {
            (Some(a), Some(b)) => assert!((a - b).abs() < 1e-4, "{}: {a} and {b}", sheet.id),
            (None, None) => {}
            other => panic!("{}: {other:?}", sheet.id),
        }
    }
}
