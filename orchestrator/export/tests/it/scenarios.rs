//! Scenarios in formats of others: what every format holds, what it leaves behind and says so, and what is read back.

use std::collections::BTreeSet;

use socrates_export::scenario::{Content, Database, FORMATS, File, Format, Package, Value};
use socrates_model::{AgentId, Cell, Pose};

use crate::whole::{COMES, TICKS, whole, without};

fn export(name: &str) -> Package {
    Format::named(name).unwrap().export(&whole()).unwrap_or_else(|why| panic!("{name}: {why}"))
}

fn whats(package: &Package) -> BTreeSet<String> {
    package.losses.rows().iter().map(|row| row.what.clone()).collect()
}

fn text<'a>(package: &'a Package, end: &str) -> &'a str {
    let file = package.files.iter().find(|(name, _)| name.ends_with(end));
    match file {
        Some((_, File::Text(text))) => text,
        other => panic!("no text `{end}`: {other:?}"),
    }
}

/// Every format either changes its files where content of a kind is gone, or had listed it as lost and no longer does.
#[test]
fn what_is_removed_changes_the_files_or_shortens_the_list_of_losses() {
    let scenario = whole();
    let exported = |format: &'static Format| {
        format.export(&scenario).map(|before| (format, before)).unwrap_or_else(|why| panic!("{}: {why}", format.name))
    };
    let whole: Vec<_> = FORMATS.iter().map(exported).collect();
    for content in Content::ALL {
        assert!(!content.places(&scenario).is_empty(), "the scenario lacks {}", content.name());
        let rest = without(&scenario, content);
        assert_eq!(content.places(&rest), [""; 0], "{} is still there", content.name());
        for (format, before) in &whole {
            let (name, what) = (format.name, content.name());
            let after = format.export(&rest);
            if format.carries(content) {
                // A format may need what was removed, and then says so.
                assert!(after.is_err() || after.unwrap().files != before.files, "{name} does not hold {what}");
                assert!(!whats(before).contains(what), "{name} holds {what} and lists it as lost");
            } else {
                let after = after.unwrap_or_else(|why| panic!("{name} without {what}: {why}"));
                assert!(whats(before).contains(what), "{name} does not say that it loses {what}");
                assert!(!whats(&after).contains(what), "{name} loses {what} where there is none");
                assert!(after.losses.rows().len() < before.losses.rows().len(), "{name}: {what}");
                assert!(after.files == before.files, "{name} loses {what} and writes it all the same");
            }
        }
    }
}

#[test]
fn the_same_scenario_gives_the_same_files_under_a_plain_name() {
    for format in FORMATS {
        let (one, other) = (export(format.name), export(format.name));
        assert!(one == other, "{}", format.name);
        assert!(!one.files.is_empty(), "{}", format.name);
        for name in one.files.keys() {
            let plain = |letter: char| letter.is_ascii_alphanumeric() || "_./-".contains(letter);
            assert!(name.chars().all(plain), "{}: {name}", format.name);
        }
        assert!(whats(&one).contains("spelling of names"), "{}", format.name);
        assert!(one.losses.rows().iter().all(|row| !row.why.is_empty() && row.count > 0), "{}", format.name);
    }
}

#[test]
fn a_bundle_without_recording_is_refused_where_tracks_are_needed_and_noted_elsewhere() {
    let mut scenario = whole();
    scenario.recording = None;
    for format in FORMATS {
        match format.export(&scenario) {
            Ok(package) => {
                assert!(!format.needs_run, "{}", format.name);
                assert!(whats(&package).contains("the run"), "{}", format.name);
            }
            Err(why) => {
                assert!(format.needs_run, "{}: {why}", format.name);
                assert!(why.to_string().contains("keeps no recording") && !why.hint.is_empty(), "{why}");
            }
        }
    }
}

#[test]
fn a_name_without_version_means_the_only_version() {
    assert_eq!(Format::named("jupedsim").unwrap().name, "jupedsim-2");
    assert_eq!(Format::named("jupedsim-2").unwrap().name, "jupedsim-2");
    let told = Format::named("jupedsim-3").unwrap_err();
    assert!(told.to_string().contains("`jupedsim-3`") && told.hint.contains("jupedsim-2"), "{told:?}");
}

#[test]
fn trajnet_holds_scenes_of_21_frames_with_positions_to_the_centimeter() {
    let package = export("trajnet");
    let lines: Vec<serde_json::Value> =
        text(&package, ".ndjson").lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let (scenes, tracks): (Vec<_>, Vec<_>) = lines.iter().partition(|line| line.get("scene").is_some());
    let first = &scenes[0]["scene"];
    assert_eq!((first["p"].as_u64(), first["s"].as_u64(), first["e"].as_u64()), (Some(1), Some(0), Some(20)));
    // Human 2 comes at 3 s, which is after frame 7.
    let second = scenes.iter().find(|scene| scene["scene"]["p"] == 2).unwrap();
    assert_eq!(second["scene"]["s"], 8);
    let at = |frame: u64, who: u64| {
        let found = tracks.iter().find(|line| line["track"]["f"] == frame && line["track"]["p"] == who);
        found.map(|line| (line["track"]["x"].as_f64().unwrap(), line["track"]["y"].as_f64().unwrap()))
    };
    assert_eq!(at(10, 0), Some((2.6, 2.0)));
    assert_eq!(at(10, 1), Some((7.8, 2.5)));
    assert_eq!((at(7, 2), at(8, 2)), (None, Some((5.0, 3.12))));
    assert_eq!(tracks.len(), 51 * 2 + 43);
}

#[test]
fn eth_ucy_numbers_frames_in_tens_and_keeps_positions() {
    let package = export("eth-ucy");
    let rows: Vec<Vec<f64>> =
        text(&package, ".txt").lines().map(|line| line.split('\t').map(|n| n.parse().unwrap()).collect()).collect();
    let row = rows
        .iter()
        .find(|row| row[0].to_bits() == 100.0_f64.to_bits() && row[1].to_bits() == 1.0_f64.to_bits())
        .unwrap();
    assert!((row[2] - 7.8).abs() < 1e-6 && (row[3] - 2.5).abs() < 1e-6, "{row:?}");
    assert!(text(&package, ".txt").lines().all(|line| line.split('\t').all(|number| number.contains('.'))));
    assert_eq!(rows.len(), 51 * 2 + 43);
}

#[test]
fn pedpy_holds_every_tick_of_those_who_are_there() {
    let package = export("pedpy");
    let text = text(&package, ".txt");
    assert!(text.starts_with("# framerate: 100 fps\n# ID\tframe\tx/m\ty/m\tz/m\n"));
    assert!(text.contains("\n2\t300\t5.0\t3.123457\t0.0\n") && !text.contains("\n2\t299\t"));
    let rows = text.lines().count() - 2;
    assert_eq!(rows as u64, TICKS * 2 + (TICKS - COMES));
}

fn database(package: &Package) -> &Database {
    match package.files.values().next() {
        Some(File::Database(database)) => database,
        other => panic!("no database: {other:?}"),
    }
}

#[test]
fn jupedsim_holds_positions_and_orientations_and_version_2() {
    let package = export("jupedsim-2");
    let tables = &database(&package).tables;
    assert_eq!(tables[0].rows.len() as u64, TICKS * 2 + (TICKS - COMES));
    let robot = &tables[0].rows[0];
    let Value::Real(cosine) = robot[4] else { panic!("{robot:?}") };
    assert!((cosine - 0.1_f64.cos()).abs() < 1e-6);
    let version = [Value::Text("version".into()), Value::Text("2".into())];
    assert!(tables[1].rows.contains(&version.to_vec()), "{:?}", tables[1].rows);
    let Value::Text(wkt) = &tables[2].rows[0][1] else { panic!("no floor") };
    assert!(wkt.starts_with("GEOMETRYCOLLECTION (POLYGON (("), "{wkt}");
    assert_eq!(tables[3].rows.len() as u64, TICKS);
}

/// The rules of the published schema: required keys, types, ranges, timestamps that rise by less than 0.5 s.
#[test]
fn socnav3_keeps_the_rules_of_its_schema() {
    let mut scenario = whole();
    scenario.location.grid.origin = Pose::new(-3.0, 1.5, 0.3);
    let package = Format::named("socnav3").unwrap().export(&scenario).unwrap();
    let value: serde_json::Value = serde_json::from_str(text(&package, ".json")).unwrap();
    assert!(value["metadata"].as_str().unwrap().contains("Büro"));
    let (grid, ours) = (&value["grid"], &scenario.location.grid);
    assert_eq!((grid["x_orig"].as_f64(), grid["angle_orig"].as_f64()), (Some(-3.0), Some(0.3)));
    let rows = grid["data"].as_array().unwrap();
    assert_eq!((rows.len(), rows[0].as_array().unwrap().len()), (ours.height, ours.width));
    let want = |cell: Cell| match cell {
        Cell::Free => 0,
        Cell::Occupied => 1,
        Cell::Unknown => -1,
    };
    for (row, column) in [(0, 0), (0, 1), (ours.height / 2, ours.width / 2)] {
        assert_eq!(rows[row][column], want(ours.at(column, row)), "{row} {column}");
    }
    let sequence = value["sequence"].as_array().unwrap();
    let times: Vec<f64> = sequence.iter().map(|one| one["timestamp"].as_f64().unwrap()).collect();
    assert!(times.windows(2).all(|pair| pair[1] > pair[0] && pair[1] - pair[0] < 0.5));
    let one = &sequence[50];
    assert_eq!((one["timestamp"].as_f64(), one["robot"]["x"].as_f64()), (Some(5.0), Some(3.0)));
    assert_eq!(one["robot"]["shape"]["width"], 0.5);
    assert!(one["goal"].as_object().unwrap().contains_key("human") && one["goal"]["human"].is_null());
    assert_eq!(sequence[29]["people"].as_array().unwrap().len(), 1);
    assert_eq!(one["people"].as_array().unwrap().len(), 2);
    for key in ["x", "y", "angle", "speed_x", "speed_y", "speed_a"] {
        assert!(one["robot"][key].is_f64(), "{key}: {}", one["robot"]);
    }
}

#[test]
fn a_run_of_another_rate_or_without_ticks_is_named() {
    let mut scenario = whole();
    let run = scenario.recording.as_mut().unwrap();
    run.frames.retain(|state| state.tick % 3 == 0);
    let told = Format::named("trajnet").unwrap().export(&scenario).unwrap_err();
    assert!(told.to_string().contains("tick 40"), "{told}");
    scenario.recording.as_mut().unwrap().frames.clear();
    for format in FORMATS.iter().filter(|format| format.needs_run) {
        let told = format.export(&scenario).unwrap_err();
        assert!(told.to_string().contains("no tick"), "{}: {told}", format.name);
    }
}

#[test]
fn people_who_are_not_there_have_no_rows() {
    let scenario = without(&whole(), Content::RobotTrack);
    let package = Format::named("pedpy").unwrap().export(&scenario).unwrap();
    assert!(!text(&package, ".txt").lines().any(|line| line.starts_with("0\t")));
    let run = scenario.recording.unwrap();
    assert!(run.track(AgentId::Robot).all(|state| !state.is_there(run.header.absent())));
}

/// The table of the page is that of the program.
#[test]
fn the_page_has_the_table_of_formats() {
    let page = std::fs::read_to_string(socrates_tests::root().join("docs/export.md")).unwrap();
    let told: Vec<&str> = page.lines().filter(|line| line.starts_with("| `")).collect();
    let rows: Vec<String> = FORMATS.iter().map(Format::row).collect();
    assert_eq!(told, rows, "docs/export.md should have these rows:\n{}", rows.join("\n"));
}
