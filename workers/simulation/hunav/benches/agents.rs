//! Speed of a native run of an agents file: people at 0.25 per m² of an open floor who cross each other, 100 steps a
//! second; process CPU time, one thread, medians.
//!
//! `cargo bench --workspace --bench agents -- [SIZE]...` takes the sizes to run (10 30 100 300 1000); without one, all.
#![expect(clippy::print_stdout, reason = "a bench prints its table")]
#![expect(clippy::unwrap_used, clippy::indexing_slicing, reason = "a bench is no library")]

use std::fmt::Write as _;

use socrates_hunav::{AgentsFile, Inputs, simulate};

const SIZES: [u32; 5] = [10, 30, 100, 300, 1000];
const ROUNDS: usize = 5;
const SECS: f64 = 5.0;

/// CPU time of this process so far, s; wall time where the system does not tell.
fn cpu_s() -> f64 {
    static START: std::sync::LazyLock<std::time::Instant> = std::sync::LazyLock::new(std::time::Instant::now);
    let told = std::fs::read_to_string("/proc/self/schedstat").ok();
    let nanos = told.as_ref().and_then(|text| text.split_whitespace().next()?.parse::<f64>().ok());
    nanos.map_or_else(|| START.elapsed().as_secs_f64(), |nanos| nanos * 1e-9)
}

/// The processor, the vector instructions seen on it, and the build.
fn header() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let line = |word: &str| info.lines().find(|line| line.starts_with(word)).unwrap_or("").to_owned();
    let name =
        line("model name").split_once(": ").map_or_else(|| "unknown processor".to_owned(), |(_, name)| name.to_owned());
    let seen: String = [" avx2", " avx512f"].into_iter().filter(|flag| line("flags").contains(flag)).collect();
    let build = if cfg!(debug_assertions) { "debug" } else { "optimized" };
    format!("{name} ({} seen:{seen}), {build} build", std::env::consts::ARCH)
}

/// An agents file of people on a lattice, who walk to and fro along x or y at different speeds.
fn file(people: u32) -> String {
    let side = (f64::from(people) / 0.25).sqrt().max(8.0);
    let per_row = f64::from(people).sqrt().ceil() as u32;
    let cell = side / f64::from(per_row);
    let mut text =
        "hunav_loader:\n  ros__parameters:\n    map: none\n    publish_people: true\n    agents:\n".to_owned();
    for id in 1..=people {
        writeln!(text, "      - person_{id}").unwrap();
    }
    for id in 1..=people {
        let (column, row) = ((id - 1) % per_row, (id - 1) / per_row);
        // Off the lattice by a share of a cell, so that nobody meets anybody exactly head on.
        let off = |factor: f64| 0.3 * cell * libm::sin(factor * f64::from(id));
        let x = (f64::from(column) + 0.5) * cell + off(1.7) - side / 2.0;
        let y = (f64::from(row) + 0.5) * cell + off(2.3) - side / 2.0;
        let far = |at: f64| if at < 0.0 { side / 2.0 - 1.0 } else { 1.0 - side / 2.0 };
        let (goal_x, goal_y) = if id % 2 == 0 { (far(x), y) } else { (x, far(y)) };
        let speed = 0.8 + 0.1 * f64::from(id % 8);
        write!(
            text,
            "    person_{id}:\n      id: {id}\n      skin: 0\n      group_id: -1\n      max_vel: {speed:.2}\n      radius: 0.3\n\
             \x20     behavior: 1\n      init_pose:\n        x: {x:.4}\n        y: {y:.4}\n        z: 1.25\n        h: 0.0\n\
             \x20     goal_radius: 0.3\n      cyclic_goals: true\n      goals:\n        - g0\n        - g1\n\
             \x20     g0:\n        x: {goal_x:.4}\n        y: {goal_y:.4}\n        h: 1.25\n\
             \x20     g1:\n        x: {x:.4}\n        y: {y:.4}\n        h: 1.25\n"
        )
        .unwrap();
    }
    text
}

fn main() {
    let wanted: Vec<u32> = std::env::args().filter_map(|argument| argument.parse().ok()).collect();
    println!("{}", header());
    println!(
        "agents files, native, {SECS} s each, open floor, 0.25 people per m²; process CPU time, one thread, median of {ROUNDS}"
    );
    for people in SIZES.into_iter().filter(|people| wanted.is_empty() || wanted.contains(people)) {
        let agents = AgentsFile::read(&file(people), "agents.yaml").unwrap();
        let inputs = Inputs { duration_s: SECS, ..Inputs::new(&agents, "agents.yaml") };
        let mut rounds = Vec::new();
        let mut hash = String::new();
        for _ in 0..ROUNDS {
            let start = cpu_s();
            hash = simulate(&inputs).unwrap().hash().to_string();
            rounds.push(cpu_s() - start);
        }
        rounds.sort_by(f64::total_cmp);
        let spent = rounds[ROUNDS / 2];
        println!(
            "agents {people:5}  {:8.1} us a step  {:6.2} us an agent-step  {:7.1} x real time  ({})",
            spent / (SECS * 100.0) * 1e6,
            spent / (SECS * 100.0) * 1e6 / f64::from(people),
            SECS / spent,
            &hash[..12],
        );
    }
}
