//! Speed of a whole run and of the scan: process CPU time, one thread, medians, ratios from one run.
//!
//! `cargo bench --workspace --bench step -- [people] [scan|step]`
#![expect(clippy::print_stdout, reason = "a bench prints its table")]
#![expect(clippy::unwrap_used, clippy::indexing_slicing, reason = "a bench is no library")]

#[path = "../tests/it/common/mod.rs"]
mod common;
#[path = "../../../../tests/machine.rs"]
mod machine;

use std::hint::black_box;

use common::hall::crowd;
use common::scene::{Oracle, Scene, cross};
use machine::cpu_s;
use socrates_engine::{BEAMS, Disc, Engine, Floor, scan, scan_shapes};
use socrates_model::{Command, Observation, Point, Pose, RobotDriver};

/// A line of a file of the system that begins with this word.
fn told(path: &str, word: &str) -> String {
    let text = std::fs::read_to_string(path).unwrap_or_default();
    let line = text.lines().find(|line| line.starts_with(word)).unwrap_or("");
    line.split_once(':').map_or("unknown", |(_, value)| value.trim()).to_owned()
}

/// Median of several measurements of seconds per call.
fn median(rounds: usize, calls: usize, mut call: impl FnMut(usize)) -> f64 {
    let mut all: Vec<f64> = (0..rounds)
        .map(|_| {
            let start = cpu_s();
            (0..calls).for_each(&mut call);
            (cpu_s() - start) / calls as f64
        })
        .collect();
    all.sort_by(f64::total_cmp);
    all[all.len() / 2]
}

/// Drives straight to the far corner, slowly enough to be among people for the whole bench.
struct Straight;

impl RobotDriver for Straight {
    fn drive(&mut self, seen: &Observation<'_>) -> Command {
        let turn = socrates_model::geometry::wrap_angle(std::f64::consts::FRAC_PI_4 - seen.pose.yaw);
        let near = seen.people.iter().any(|person| (person.at - seen.pose.point()).norm() < 0.9);
        Command { v: if near { 0.0 } else { 0.4 }, omega: turn, waiting: near, ..Command::default() }
    }
}

fn steps(people: u32, secs: f64) {
    let mut rates = Vec::new();
    let mut events = 0;
    for _ in 0..5 {
        let engine = Engine::new(crowd(people, secs)).unwrap();
        let start = cpu_s();
        let recording = engine.run(Some(&mut Straight), &mut |_, _| {});
        let spent = cpu_s() - start;
        events = recording.events.len();
        rates.push((spent, recording.hash().to_string()));
    }
    rates.sort_by(|a, b| a.0.total_cmp(&b.0));
    let spent = rates[rates.len() / 2].0;
    println!(
        "step   {people:5} people  {:8.1} us a step  {:6.2} us a person  {:7.1} x real time at 100 Hz  ({events} events, {})",
        spent / (secs * 100.0) * 1e6,
        spent / (secs * 100.0) * 1e6 / f64::from(people),
        secs / spent,
        &rates[0].1[..12],
    );
}

fn spots(side: f64) -> Vec<Pose> {
    (0..50_u32)
        .map(|k| {
            let share = f64::from(k) / 50.0;
            Pose::new(side * (0.08 + 0.84 * share), side * (0.1 + 0.8 * ((share * 7.0) % 1.0)), 6.0 * share)
        })
        .collect()
}

fn scans(people: u32) {
    let (scene, side): (Scene, f64) = cross(people);
    let spots = spots(side);
    let oracle = Oracle::new(&scene);
    let ours = median(9, 8_000, |call| {
        black_box(scan_shapes(&spots[call % 50], &scene.discs, &scene.segments, 12.0).unwrap());
    });
    let theirs = median(7, 1_000, |call| {
        black_box(oracle.scan(&spots[call % 50], 12.0));
    });
    let (mut hits, mut their_hits, mut sum, mut their_sum) = (0_usize, 0_usize, 0.0, 0.0);
    for spot in &spots {
        let a = scan_shapes(spot, &scene.discs, &scene.segments, 12.0).unwrap();
        let b = oracle.scan(spot, 12.0);
        hits += a.iter().filter(|range| **range < 12.0).count();
        their_hits += b.iter().filter(|range| **range < 12.0).count();
        sum += a.iter().sum::<f64>();
        their_sum += b.iter().sum::<f64>();
    }
    let beams = (50 * BEAMS) as f64;
    println!(
        "scan   CROSS-{people:<5} ours {:7.2} us  rapier {:7.1} us  {:5.1} x   hits {hits} / {their_hits}  mean {:.4} / {:.4} m",
        ours * 1e6,
        theirs * 1e6,
        theirs / ours,
        sum / beams,
        their_sum / beams,
    );
}

/// A shipped map as a mapping robot would leave it: every 50th cell at random is blocked.
fn speckled(grid: &socrates_model::Grid) -> socrates_model::Grid {
    let mut grid = grid.clone();
    let mut dice = 1_u64;
    for cell in &mut grid.cells {
        dice = dice.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        if (dice >> 33).is_multiple_of(50) {
            *cell = socrates_model::Cell::Occupied;
        }
    }
    grid
}

fn map_scans(name: &str) {
    let location = socrates_maps::shipped::load(name).unwrap();
    let nodes: Vec<Point> = location.graph.nodes().iter().map(|node| node.at).collect();
    let people: Vec<Disc> = nodes.iter().map(|at| Disc { center: *at, radius_m: 0.28 }).collect();
    let pose = |call: usize| {
        let at = nodes[call % nodes.len()];
        Pose::new(at.x + 0.4, at.y + 0.1, 0.1 * call as f64)
    };
    let floor_of = |grid: &socrates_model::Grid| {
        let mut floor = Floor::new(grid);
        floor.close(location.doors.iter().map(|door| (door.from, door.to)).collect());
        floor
    };
    let (floor, rough) = (floor_of(&location.grid), floor_of(&speckled(&location.grid)));
    let us = |floor: &Floor| {
        // The clock moves in steps of 4 ms on some systems.
        let spent = median(7, 20_000, |call| {
            black_box(scan(floor, &pose(call), &people, 12.0));
        });
        spent * 1e6
    };
    let one_by_one = median(5, 1_000, |call| {
        let from = pose(call);
        for beam in 0..BEAMS {
            black_box(floor.ray_m(&from.point(), from.yaw + (beam as f64).to_radians(), 12.0));
        }
    });
    println!(
        "scan   {name:<11} {} doors, {} people: {:.1} us, speckled {:.1} us; walls and doors ray by ray over the cells {:.1} us",
        location.doors.len(),
        people.len(),
        us(&floor),
        us(&rough),
        one_by_one * 1e6
    );
}

fn main() {
    let only: Option<u32> = std::env::args().filter_map(|argument| argument.parse().ok()).next();
    println!("{}", machine::told("whole steps and scans of the engine, process CPU time, one thread"));
    let asked = |part: &str| {
        let words = || std::env::args().filter(|argument| ["scan", "step"].contains(&argument.as_str()));
        words().count() == 0 || words().any(|word| word == part)
    };
    for people in [10, 50, 1000].into_iter().filter(|people| only.is_none_or(|only| only == *people)) {
        if asked("scan") {
            scans(people);
        }
        if asked("step") {
            steps(people, if people >= 1000 { 5.0 } else { 20.0 });
        }
    }
    for name in socrates_maps::shipped::names().iter().filter(|_| asked("scan")) {
        map_scans(name);
    }
    println!("peak memory {}", told("/proc/self/status", "VmHWM"));
}
