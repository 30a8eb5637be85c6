//! Scenarios for simulators that move people anew: Arena, HumanSim, Isaac, JuPedSim; their keys, types and places.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::Value;
use socrates_export::scenario::{Cells, File, Format, Package, Scenario};
use socrates_model::{HumanId, Point, Pose};
use socrates_tests::skip;

use crate::whole::{COMES, TICKS, whole};

fn export(format: &str, scenario: &Scenario) -> Package {
    Format::named(format).unwrap().export(scenario).unwrap_or_else(|why| panic!("{format}: {why}"))
}

fn text<'a>(package: &'a Package, end: &str) -> &'a str {
    match package.files.iter().find(|(name, _)| name.ends_with(end)) {
        Some((_, File::Text(text))) => text,
        other => panic!("no text `{end}`: {other:?}"),
    }
}

fn yaml(package: &Package, end: &str) -> Value {
    yaml_serde::from_str(text(package, end)).unwrap_or_else(|why| panic!("{end}: {why}\n{}", text(package, end)))
}

fn whats(package: &Package) -> BTreeSet<&str> {
    package.losses.rows().iter().map(|row| row.what.as_str()).collect()
}

/// Whether every number of a value is written as a real.
fn is_real(value: &Value) -> bool {
    match value {
        Value::Number(number) => number.is_f64(),
        Value::Array(values) => values.iter().all(is_real),
        Value::Object(values) => values.values().all(is_real),
        Value::Null | Value::Bool(_) | Value::String(_) => false,
    }
}

/// Paths of keys and the kinds of their values; all elements of a list are one.
fn shape(value: &Value, path: &str, out: &mut BTreeMap<String, &'static str>) {
    let kind = match value {
        Value::Null => "null",
        Value::Bool(_) => "bool",
        Value::Number(_) => "number",
        Value::String(_) => "text",
        Value::Array(values) => {
            values.iter().for_each(|value| shape(value, &format!("{path}[]"), out));
            "list"
        }
        Value::Object(values) => {
            values.iter().for_each(|(key, value)| shape(value, &format!("{path}.{key}"), out));
            "object"
        }
    };
    out.insert(path.to_owned(), kind);
}

#[test]
fn a_scenario_of_arena_3_has_the_keys_and_kinds_of_those_that_arena_ships() {
    let package = export("arena-3", &whole());
    let ours: Value = serde_json::from_str(text(&package, "scenarios/Buero_drei_1.json")).unwrap();
    let mut found = BTreeMap::new();
    shape(&ours, "", &mut found);
    let Some(path) = skip::shared("formats/arena/arena_corridor/scenarios/1.json") else { return };
    let theirs: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let mut wanted = BTreeMap::new();
    shape(&theirs, "", &mut wanted);
    assert_eq!(found, wanted);
    let Some(path) = skip::shared("formats/arena/arena_corridor/map/map.world.yaml") else { return };
    let theirs: Value = yaml_serde::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let (mut found, mut wanted) = (BTreeMap::new(), BTreeMap::new());
    shape(&yaml(&package, "map/map.world.yaml"), "", &mut found);
    shape(&theirs, "", &mut wanted);
    assert_eq!(found, wanted);
}

#[test]
fn people_of_arena_begin_where_they_did_and_walk_their_paths() {
    let scenario = whole();
    let way = scenario.location.graph.polyline(&scenario.paths.humans[&HumanId::new(1)]);
    let third = export("arena-3", &scenario);
    let three: Value = serde_json::from_str(text(&third, ".json")).unwrap();
    let fifth = export("arena-5", &scenario);
    let five = yaml(&fifth, "scenario.yaml");
    for (format, value, pose) in [("arena-3", &three, "pos"), ("arena-5", &five, "pose")] {
        let people = value["obstacles"]["dynamic"].as_array().unwrap();
        assert_eq!(people.len(), 2, "{format}");
        assert!(
            people.iter().chain(value["robots"].as_array().unwrap()).all(|one| {
                ["pos", "pose", "start", "goal", "waypoints"].iter().all(|key| one.get(key).is_none_or(is_real))
            }),
            "{format}: a whole number among the places"
        );
        let one = &people[0];
        assert_eq!((one[pose][0].as_f64(), one[pose][1].as_f64()), (Some(9.0), Some(2.5)), "{format}");
        let last = one["waypoints"].as_array().unwrap().last().unwrap();
        let end = way.last().unwrap();
        assert!((last[0].as_f64().unwrap() - end.x).abs() < 1e-5 && (last[1].as_f64().unwrap() - end.y).abs() < 1e-5);
        let robot = scenario.location.graph.polyline(&scenario.paths.robot);
        let start = &value["robots"][0]["start"];
        assert!((start[0].as_f64().unwrap() - robot[0].x).abs() < 1e-5, "{format}");
    }
    // A height and no heading is the third number of a way point in the later one, so there is none.
    assert!(five["obstacles"]["dynamic"][0]["waypoints"][0].as_array().unwrap().len() == 2);
    assert_eq!(five["obstacles"]["dynamic"][0]["velocity"], 1.1);
    for package in [&third, &fifth] {
        let whats = whats(package);
        assert!(whats.contains("waits of people") && whats.contains("absence of people"), "{whats:?}");
    }
}

#[test]
fn a_world_of_arena_5_has_every_door_and_walls_along_the_cells() {
    let mut scenario = whole();
    scenario.location.grid.origin = Pose::new(-3.0, 1.5, 0.3);
    let world = yaml(&export("arena-5", &scenario), "world.yaml");
    let zone = &world["zones"][0];
    assert_eq!(world["zones"].as_array().unwrap().len(), 1);
    let doors = zone["doors"].as_array().unwrap();
    assert_eq!(doors.len(), scenario.location.doors.len());
    assert!(doors.iter().all(|door| door["kind"] == "sliding" && is_real(&door["start"]) && is_real(&door["end"])));
    assert!(zone["description"].as_str().unwrap().contains("Büro"));
    let walls = zone["walls"].as_array().unwrap();
    assert!(walls.len() > 20, "{}", walls.len());
    let grid = &scenario.location.grid;
    for wall in walls {
        for end in ["start", "end"] {
            let at = Point::new(wall[end]["x"].as_f64().unwrap(), wall[end]["y"].as_f64().unwrap());
            let (px, py) = grid.pixel_from_world(&at);
            assert!(
                (px - px.round()).abs() < 1e-3 && (py - py.round()).abs() < 1e-3,
                "{px} {py} is no corner of a cell"
            );
        }
    }
}

#[test]
fn a_scenario_of_humansim_has_its_keys_and_everybody_with_their_goals() {
    let package = export("humansim", &whole());
    let value = yaml(&package, ".yaml");
    let keys: Vec<&str> = value.as_object().unwrap().keys().map(String::as_str).collect();
    assert_eq!(keys, ["agents", "description", "interaction_scripts", "name", "simulation", "walls"]);
    let simulation = &value["simulation"];
    assert_eq!((simulation["dt"].as_f64(), simulation["max_ticks"].as_u64()), (Some(0.05), Some(TICKS / 5)));
    let agents = value["agents"].as_array().unwrap();
    let ids: Vec<i64> = agents.iter().map(|agent| agent["agent_id"].as_i64().unwrap()).collect();
    assert_eq!(ids, [-1, 1, 2]);
    assert_eq!((agents[0]["kind"].as_i64(), agents[1]["agent_type"].as_str()), (Some(1), Some("adult")));
    for agent in agents {
        assert!(
            is_real(&agent["spawn_pose"]) && is_real(&agent["goal_sequence"]) && is_real(&agent["desired_velocity"])
        );
        assert!(!agent["goal_sequence"].as_array().unwrap().is_empty());
    }
    assert!(value["walls"].as_array().unwrap().len() > 20);
}

#[test]
fn people_of_isaac_have_ways_in_the_spelling_of_their_generation() {
    let scenario = whole();
    let old = export("isaac-people-5.1", &scenario);
    let commands: Vec<&str> = text(&old, "commands.txt").lines().collect();
    assert_eq!(commands[0], "Character GoTo 9.0 2.5 0.0 _");
    let second: Vec<&&str> = commands.iter().filter(|line| line.starts_with("Character_01 ")).collect();
    // Human 2 stands from 3 s to the end.
    let stood = (TICKS - 1 - COMES) as f64 / 100.0;
    assert_eq!(
        second[1..3],
        [&"Character_01 GoTo 5.0 3.123457 0.0 _", &format!("Character_01 Idle {stood:?}").as_str()]
    );
    let config = &yaml(&old, "_agents.yaml")["isaacsim.replicator.agent"];
    assert_eq!((config["version"].as_str(), config["character"]["num"].as_u64()), (Some("0.7.0"), Some(2)));
    assert_eq!(config["global"]["simulation_length"], 600);
    for (format, version) in [("isaac-people-6.0", "1.6.0"), ("isaac-people-6.1", "1.7.0")] {
        let package = export(format, &scenario);
        let config = &yaml(&package, "_agents.yaml")["isaacsim.replicator.agent"];
        assert_eq!((config["version"].as_str(), config["simulation_duration"].as_f64()), (Some(version), Some(20.0)));
        let stage = config["environment"]["base_stage_asset_path"].as_str().unwrap();
        assert!(
            text(&package, stage).starts_with("#usda 1.0\n") && !text(&package, stage).contains("human_1"),
            "{format}"
        );
        let groups = config["character"]["groups"].as_object().unwrap();
        assert_eq!(groups.keys().collect::<Vec<_>>(), ["human_1", "human_2"]);
        let patrol = &groups["human_1"]["routines"][0]["patrol"];
        assert_eq!(patrol["speed_range"], serde_json::json!([1.1, 1.1]));
        assert!(patrol["path_points"].as_array().unwrap().len() > 2 && is_real(&patrol["path_points"]));
        assert!(whats(&package).contains("waits of people") && whats(&package).contains("mesh for navigation"));
    }
}

#[test]
fn a_scenario_of_jupedsim_names_only_stages_that_are_there_and_keeps_times_and_waits() {
    let package = export("jupedsim-scenarios", &whole());
    let config: Value = serde_json::from_str(text(&package, "config.json")).unwrap();
    let stages: BTreeSet<&String> =
        ["checkpoints", "exits"].iter().flat_map(|key| config[key].as_object().unwrap().keys()).collect();
    let journeys = config["journeys_v2"].as_array().unwrap();
    assert_eq!((journeys.len(), config["distributions"].as_object().unwrap().len()), (3, 3));
    let mut named = BTreeSet::new();
    for journey in journeys {
        let sequence: Vec<String> = serde_json::from_value(journey["sequence"].clone()).unwrap();
        assert!(sequence.last().unwrap().starts_with("jps-exits_"), "{journey}");
        assert!(sequence.iter().all(|stage| stages.contains(stage)), "{journey}");
        named.extend(sequence);
    }
    assert_eq!(named.len(), stages.len(), "a stage that nobody goes to");
    let third = &config["distributions"]["jps-distributions_2"];
    assert_eq!((third["name"].as_str(), third["parameters"]["flow_start_time"].as_f64()), (Some("human_2"), Some(3.0)));
    let waits: Vec<f64> = config["checkpoints"]
        .as_object()
        .unwrap()
        .values()
        .map(|stop| stop["waiting_time"].as_f64().unwrap())
        .filter(|wait| *wait > 0.0)
        .collect();
    assert_eq!(waits, [17.0]);
    assert!(text(&package, "geometry.wkt").starts_with("POLYGON (("));
    assert!(text(&package, "run.py").contains("jupedsim_scenarios"));
}

#[test]
fn tables_have_a_row_for_everybody_who_is_there() {
    let package = export("parquet", &whole());
    let table = |end: &str| match package.files.iter().find(|(name, _)| name.ends_with(end)) {
        Some((_, File::Columns(table))) => table,
        other => panic!("{other:?}"),
    };
    let tracks = table("_tracks.parquet");
    let rows = usize::try_from(TICKS * 2 + (TICKS - COMES)).unwrap();
    assert!(tracks.columns.iter().all(|(_, cells)| cells.rows() == rows));
    let column = |name: &str| &tracks.columns.iter().find(|(other, _)| *other == name).unwrap().1;
    let (Cells::Whole(ticks), Cells::Whole(agents), Cells::Real(x)) = (column("tick"), column("agent"), column("x_m"))
    else {
        panic!("kinds of columns");
    };
    let row = (0..rows).find(|row| (ticks[*row], agents[*row]) == (Some(400), Some(1))).unwrap();
    assert!((x[row].unwrap() - 7.8).abs() < 1e-6);
    assert!((0..rows).all(|row| agents[row] != Some(2) || ticks[row] >= Some(300)));
    let Cells::Text(gestures) = column("gesture") else { panic!("gestures") };
    assert_eq!(gestures.iter().flatten().collect::<BTreeSet<_>>(), BTreeSet::from([&"WAIT".to_owned()]));
    let agents = table("_agents.parquet");
    assert_eq!(agents.columns[2].1, Cells::Text(vec![None, Some("nurse".into()), Some("visitor".into())]));
    assert_eq!(agents.columns[3].1, Cells::Whole(vec![None, Some(1), Some(1)]));
}
