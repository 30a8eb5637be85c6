//! Tables of a few scenarios, and what is said of them.

use super::*;

const HEAD: &str = "request,location,planner,seed,verdict,reason,kind,path,scenario,pattern,place,people,encounter,context,density_2_5m_max\n";

fn coverage(rows: &[&str]) -> Coverage {
    Coverage::of(&Table::read(&format!("{HEAD}{}\n", rows.join("\n"))).unwrap())
}

fn cell(coverage: &Coverage, axis: &str, name: &str) -> (usize, usize) {
    let axis = coverage.axes.iter().find(|one| one.name == axis).unwrap();
    let (_, count) = axis.cells.iter().find(|(cell, _)| cell == name).unwrap_or_else(|| panic!("{name}: {axis:?}"));
    (count.scenarios, count.realised)
}

fn crossed(coverage: &Coverage, sector: Sector, band: usize) -> (usize, usize) {
    let at = Sector::ALL.iter().position(|one| *one == sector).unwrap();
    (coverage.crossed[at][band].scenarios, coverage.crossed[at][band].realised)
}

#[test]
fn a_scenario_counts_once_however_many_runs_it_has_and_a_repeat_not_at_all() {
    let all = coverage(&[
        "hall,office,reference,1,realised,,distinct,,s1,frontal_approach,corridor,2,frontal frontal crossing_left,An office,0.051",
        "hall,office,mppi,1,contradicted,,distinct,,s1,frontal_approach,corridor,2,frontal frontal crossing_left,An office,0.2",
        "hall,office,reference,2,realised,,repeat,,s2,frontal_approach,corridor,2,frontal,An office,0.051",
        "hall,lab,reference,3,contradicted,,distinct,,s3,frontal_approach,corridor,1,frontal,A lab,0.2",
    ]);
    assert_eq!((all.scenarios, all.distinct), (3, Count { scenarios: 2, realised: 1 }));
    assert_eq!(cell(&all, "scenario", "frontal_approach"), (2, 1));
    assert_eq!(cell(&all, "scenario", "human_overtaking"), (0, 0));
    assert_eq!(cell(&all, "encounter", "frontal"), (2, 1));
    assert_eq!(cell(&all, "encounter", "crossing_left"), (1, 1));
    assert_eq!((cell(&all, "location", "lab"), cell(&all, "location", "hospital")), ((1, 0), (0, 0)));
    assert_eq!(cell(&all, "context", "A lab"), (1, 0));
    assert_eq!(crossed(&all, Sector::Frontal, 1), (1, 1), "the density is that of the first run");
    assert_eq!(crossed(&all, Sector::Frontal, 2), (1, 0));
    let mppi = all.planners.iter().find(|(name, _)| name == "mppi").unwrap();
    assert_eq!(mppi.1, BTreeMap::from([("contradicted".to_owned(), 1)]));
}

#[test]
fn what_lacks_is_said_in_sentences() {
    let all = coverage(&[
        "hall,office,reference,1,realised,,distinct,,s1,human_overtaking,corridor,1,behind,,0.051",
        "hall,office,reference,1,realised,,distinct,,s2,crowd_navigation,corridor,8,frontal,,0.051",
        "hall,office,reference,1,not_triggered,,distinct,,s3,crowd_navigation,open_area,8,frontal,,0.4",
    ]);
    let gaps = all.gaps();
    let has = |text: &str| gaps.iter().any(|gap| gap.contains(text));
    assert!(has("no scenario with an encounter from behind at a density of 0.1 people per m² or more"), "{gaps:#?}");
    assert!(has("from the front at a density of 0.1 to 0.31 people"), "{gaps:#?}");
    assert!(!has("0.72 people per m² or more") && has("densities of people have no scenario"), "{gaps:#?}");
    assert!(has("9 of 11 encounter angles have no scenario: frontal_left"), "{gaps:#?}");
    assert!(has("never realised of the places: open_area"), "{gaps:#?}");
    assert!(has("no run of these planners: reactive") && !has(", none"), "{gaps:#?}");
    let lines = all.lines().join("\n");
    assert!(lines.contains("2 of 45 canonical scenarios") && lines.contains("1 / 2"), "{lines}");
}

#[test]
fn densities_lie_in_the_band_that_begins_below_them() {
    assert_eq!([0.0, 0.051, 0.099, 0.1, 0.30, 0.31, 0.71, 0.72, 5.0].map(band), [0, 1, 1, 2, 2, 3, 3, 4, 4]);
}

#[test]
fn of_scenarios_that_were_not_made_and_of_earlier_tables_it_is_said_that_nothing_is_known() {
    let failed = coverage(&["hall,,,,failed,no author,distinct,,s1,,,,,,"]);
    assert_eq!((failed.failed, failed.distinct.scenarios), (1, 1));
    assert!(failed.axes.iter().all(|axis| axis.untold == 1), "{:?}", failed.axes);
    assert!(failed.summary().contains("1 without a run"), "{}", failed.summary());
    let head = "request,location,planner,seed,verdict,reason,kind,path\n";
    let rows = "hall,office,reference,1,realised,,distinct,hall-1\nhall,office,mppi,1,realised,,distinct,hall-1\nhall,office,reference,1,realised,,distinct,hall-2\n";
    let earlier = Coverage::of(&Table::read(&format!("{head}{rows}")).unwrap());
    assert_eq!((earlier.scenarios, cell(&earlier, "location", "office")), (2, (2, 2)));
    assert_eq!(earlier.axes.iter().filter(|axis| axis.untold == 2).count(), 5);
    assert!(!earlier.gaps().iter().any(|gap| gap.contains("canonical")), "{:?}", earlier.gaps());
}

#[test]
fn every_cell_is_a_row_of_the_table() {
    let all = coverage(&[
        "hall,office,reference,1,realised,,distinct,,s1,frontal_approach,corridor,1,frontal,\"A, B\",0.051",
    ]);
    let table = Table::read(&all.csv()).unwrap();
    assert_eq!(table.head.cells, ["axis", "cell", "by", "scenarios", "realised"]);
    let cells: usize = all.axes.iter().map(|axis| axis.cells.len()).sum();
    let planners = all.planners.len() + 1;
    assert_eq!(table.rows.len(), cells + Sector::ALL.len() * BANDS.len() + planners);
    assert!(table.rows.iter().any(|row| row.cells == ["encounter", "frontal", "below_0.1", "1", "1"]));
    assert!(table.rows.iter().any(|row| row.cells == ["context", "A, B", "", "1", "1"]));
    let object = all.object();
    assert_eq!(object["encounter_by_density"]["frontal"]["below_0.1"]["realised"], 1);
}
