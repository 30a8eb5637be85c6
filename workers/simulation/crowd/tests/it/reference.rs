//! One step at a time against recorded runs: of the reference library where its recordings are at hand, and of scenes of our own
//! that `tests/data/oracle.py` worked out by itself.

#![expect(
    clippy::float_cmp,
    clippy::print_stdout,
    reason = "profiles are what the files say to the last bit, and how much was checked is told"
)]

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use nalgebra::{Point2, Vector2};
use serde_json::Value;
use socrates_crowd::{Goal, Params, Person, Segment, forces, integrate, points_in_range};
use socrates_tests::skip::shared;

const TOLERANCE: f64 = 1e-12;

#[track_caller]
fn folder() -> Option<PathBuf> {
    shared("sfm_reference")
}

fn rows(path: &Path) -> Vec<Vec<f64>> {
    let text = fs::read_to_string(path).unwrap();
    text.lines().skip(1).map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect()
}

fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or_else(|| panic!("no number `{key}`"))
}

struct Scene {
    params: Params,
    segments: Vec<Segment>,
    range_m: f64,
    dt: f64,
    agents: Vec<Value>,
}

fn scene(json: &Value) -> Scene {
    let given = &json["params"];
    let base = if json["mode"] == "hunav" { Params::lightsfm_hunav() } else { Params::lightsfm_batch() };
    // The profiles must be what the files say: nothing is taken from the file that a profile sets.
    assert_eq!(base.social, number(given, "force_factor_social"));
    assert_eq!(base.epsilon, number(given, "epsilon"));
    assert_eq!(base.gamma_m, number(given, "gamma"));
    assert_eq!(base.relaxation_s, number(given, "relaxation_time"));
    let segments = json["segments"].as_array().unwrap();
    Scene {
        params: base,
        segments: segments
            .iter()
            .map(|ends| {
                let end = |i: usize| ends[i].as_f64().unwrap();
                Segment { from: Point2::new(end(0), end(1)), to: Point2::new(end(2), end(3)) }
            })
            .collect(),
        range_m: number(json, "obstacle_range"),
        dt: number(json, "dt"),
        agents: json["agents"].as_array().unwrap().clone(),
    }
}

/// The person of a trajectory row, with the goal it has at that row.
fn person(agent: &Value, row: &[f64]) -> Person {
    let goals = agent["goals"].as_array().unwrap();
    let reached = row[7] as usize;
    let place = if agent["cyclic_goals"] == true && !goals.is_empty() { reached % goals.len() } else { reached };
    let goal = goals.get(place).map(|goal| Goal {
        at: Point2::new(goal[0].as_f64().unwrap(), goal[1].as_f64().unwrap()),
        radius_m: goal[2].as_f64().unwrap(),
    });
    Person {
        id: row[1] as u32,
        position: Point2::new(row[2], row[3]),
        velocity: Vector2::new(row[4], row[5]),
        yaw: row[6],
        radius_m: number(agent, "radius"),
        speed_mps: number(agent, "desired_velocity"),
        goal,
        group: agent["group_id"].as_i64().filter(|id| *id >= 0).map(|id| id as u32),
    }
}

fn near(found: f64, wanted: f64, what: &str) {
    assert!(
        (found - wanted).abs() <= TOLERANCE * wanted.abs().max(1.0),
        "{what}: found {found:e}, the reference has {wanted:e}"
    );
}

#[test]
fn every_step_of_every_scene_is_the_reference_step() {
    let Some(folder) = folder() else { return };
    every_step_is_that_of(&folder);
}

#[test]
fn every_step_of_our_scenes_is_the_one_worked_out_apart() {
    every_step_is_that_of(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data")));
}

fn every_step_is_that_of(folder: &Path) {
    let mut files: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    let (mut checked, mut forces_checked) = (0, 0);
    for file in files.iter().filter(|file| file.extension().is_some_and(|ext| ext == "json")) {
        let json: Value = serde_json::from_str(&fs::read_to_string(file).unwrap()).unwrap();
        let scene = scene(&json);
        if scene.agents.iter().any(|agent| agent["teleoperated"] == true) {
            println!("not stepped: {} has a remote-controlled agent", file.display());
            continue;
        }
        let stem = file.file_stem().unwrap().to_str().unwrap();
        let trajectory = rows(&folder.join(format!("{stem}.traj.csv")));
        let n = scene.agents.len();
        let mut wanted_forces: BTreeMap<(u64, u32), Vec<f64>> = BTreeMap::new();
        for row in rows(&folder.join(format!("{stem}.forces.csv"))) {
            wanted_forces.insert((row[0] as u64, row[1] as u32), row);
        }
        for (step, pair) in trajectory.chunks(n).zip(trajectory.chunks(n).skip(1)).enumerate() {
            let people: Vec<Person> = scene.agents.iter().zip(pair.0).map(|(agent, row)| person(agent, row)).collect();
            let points: Vec<Vec<Point2<f64>>> =
                people.iter().map(|person| points_in_range(&person.position, &scene.segments, scene.range_m)).collect();
            let found = forces(&people, &points, &scene.params);
            for ((person, forces), row) in people.iter().zip(&found).zip(pair.1) {
                if let Some(wanted) = wanted_forces.get(&(step as u64, person.id)) {
                    forces_checked += 1;
                    let parts = [
                        forces.desired,
                        forces.obstacle,
                        forces.social,
                        forces.gaze,
                        forces.coherence,
                        forces.repulsion,
                        forces.total(),
                    ];
                    for (place, part) in parts.iter().enumerate() {
                        let what = format!("{stem} step {step} person {} force {place}", person.id);
                        near(part.x, wanted[3 + 2 * place], &what);
                        near(part.y, wanted[4 + 2 * place], &what);
                    }
                }
                let mut next = person.clone();
                integrate(&mut next, &forces.total(), scene.dt);
                let what = format!("{stem} step {step} person {}", person.id);
                near(next.position.x, row[2], &what);
                near(next.position.y, row[3], &what);
                near(next.velocity.x, row[4], &what);
                near(next.velocity.y, row[5], &what);
                near(next.yaw, row[6], &what);
                checked += 1;
            }
        }
    }
    println!("{checked} steps checked");
    assert!(checked > 1000, "only {checked} steps were checked");
    assert!(forces_checked > 100, "only {forces_checked} sets of forces were checked");
}

/// Walls of the crossing crowd: a square, and a bar in every full ten by ten meters.
fn crossing_walls(n: usize) -> Vec<Segment> {
    let side = (n as f64 / 0.25).sqrt().max(8.0);
    let segment = |ax: f64, ay: f64, bx: f64, by: f64| Segment { from: Point2::new(ax, ay), to: Point2::new(bx, by) };
    let mut walls = vec![
        segment(0.0, 0.0, side, 0.0),
        segment(side, 0.0, side, side),
        segment(side, side, 0.0, side),
        segment(0.0, side, 0.0, 0.0),
    ];
    let bars = (side / 10.0) as usize;
    for j in 0..bars {
        for i in 0..bars {
            let (x, y) = (10.0 * i as f64, 10.0 * j as f64);
            walls.push(segment(x + 4.0, y + 4.0, x + 6.0, y + 4.0));
        }
    }
    walls
}

#[test]
fn the_forces_of_the_crossing_crowd_are_the_reference_forces() {
    let Some(folder) = folder() else { return };
    for n in [10, 100] {
        let file = folder.join(format!("cross_{n}.hunav.csv"));
        let rows = rows(&file);
        for crowd in rows.chunks(n) {
            let people: Vec<Person> = crowd
                .iter()
                .map(|row| Person {
                    velocity: Vector2::new(row[4], row[5]),
                    yaw: row[6],
                    radius_m: 0.35,
                    speed_mps: row[7],
                    goal: Some(Goal { at: Point2::new(row[8], row[9]), radius_m: 0.3 }),
                    ..Person::standing(row[1] as u32, Point2::new(row[2], row[3]))
                })
                .collect();
            let walls = crossing_walls(n);
            let points: Vec<_> = people.iter().map(|person| points_in_range(&person.position, &walls, 3.0)).collect();
            for (row, forces) in crowd.iter().zip(forces(&people, &points, &Params::lightsfm_hunav())) {
                near(forces.total().x, row[12], &format!("cross_{n} step {} person {}", row[0], row[1]));
                near(forces.total().y, row[13], &format!("cross_{n} step {} person {}", row[0], row[1]));
            }
        }
    }
}
