//! The crossing crowd: agent-steps per second, ratios to strict, real-time factors, errors, memory.
//!
//! `cargo bench --workspace --bench cross -- [SIZE]...` takes the sizes to run (10 50 100 1000 10000);
//! without one, all. One thread, process CPU time, median of several rounds; in each round every mode
//! has its turn, so that ratios are of the same minute.

#![expect(clippy::print_stdout, reason = "a bench prints its figures")]

mod common;

use std::hint::black_box;

use common::machine::{cpu_s, told};
use common::median;
use nalgebra::{Point2, Vector2};
use socrates_crowd::cross::{DT_S, WALL_RANGE_M, cross};
use socrates_crowd::fast::{Instructions, Settings};
use socrates_crowd::strict::Model;
use socrates_crowd::{Person, Route, Segment, Walker, fast, forces, integrate, points_in_range, strict};

const SIZES: [u32; 5] = [10, 50, 100, 1000, 10_000];
const BOUNDS: [f64; 4] = [1e-9, 1e-6, 1e-3, 1e-1];
const ROUNDS: usize = 5;
/// At least this much CPU time per mode and round, s: well above the clock tick of the system.
const SLICE_S: f64 = 0.05;
/// Slow modes get fewer rounds beyond this many pairs of people per step.
const MANY_PAIRS: f64 = 5e6;

/// Present and peak resident memory, MB.
fn memory_mb(field: &str) -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find(|line| line.starts_with(field)).unwrap_or_default();
    line.split_whitespace().nth(1).and_then(|kb| kb.parse::<f64>().ok()).map_or(f64::NAN, |kb| kb / 1024.0)
}

/// A crowd stepped by the portable functions alone.
struct Portable {
    people: Vec<Person>,
    routes: Vec<Route>,
    walls: Vec<Segment>,
}

impl Portable {
    fn new(walkers: &[Walker], walls: &[Segment]) -> Self {
        let person = |walker: &Walker| Person { goal: walker.route.goal(), ..walker.person.clone() };
        Self {
            people: walkers.iter().map(person).collect(),
            routes: walkers.iter().map(|walker| walker.route.clone()).collect(),
            walls: walls.to_vec(),
        }
    }

    fn step(&mut self) {
        let points: Vec<Vec<Point2<f64>>> =
            self.people.iter().map(|person| points_in_range(&person.position, &self.walls, WALL_RANGE_M)).collect();
        let forces = forces(&self.people, &points, &Model::Hunav.params());
        for ((person, route), force) in self.people.iter_mut().zip(&mut self.routes).zip(&forces) {
            integrate(person, &force.total(), DT_S);
            route.follow(person);
        }
    }
}

/// One way of stepping the crowd.
enum Mode {
    Strict(strict::Crowd),
    Portable(Portable),
    Fast(Box<fast::Crowd>),
}

impl Mode {
    fn step(&mut self) {
        match self {
            Self::Strict(crowd) => crowd.step(DT_S),
            Self::Portable(crowd) => crowd.step(),
            Self::Fast(crowd) => assert!(black_box(crowd.step(DT_S)).is_ok(), "a step of the workload is a good step"),
        }
    }
}

/// How long one of `steps` steps takes, s.
fn time(mode: &mut Mode, steps: u32) -> f64 {
    let before = cpu_s();
    for _ in 0..steps {
        mode.step();
    }
    (cpu_s() - before) / f64::from(steps)
}

/// How many steps take a slice of time.
fn steps_per_slice(mode: &mut Mode) -> u32 {
    let mut steps = 1;
    loop {
        let slice = time(mode, steps) * f64::from(steps);
        if slice >= SLICE_S / 2.0 || steps >= 1 << 20 {
            return steps;
        }
        steps *= 2;
    }
}

/// Largest difference of social forces, m/s².
fn error_mps2(fast: &mut fast::Crowd, wanted: &[Vector2<f64>]) -> f64 {
    fast.forces().iter().zip(wanted).map(|(found, wanted)| (found.social - wanted).norm()).fold(0.0, f64::max)
}

fn run(n: u32) {
    let floor = cross(n);
    let params = Model::Hunav.params();
    let before_mb = memory_mb("VmHWM");
    let strict = strict::Crowd::new(&floor.walkers, &floor.walls, WALL_RANGE_M, &params);
    let wanted: Vec<Vector2<f64>> = strict.forces(&strict.wall_points()).iter().map(|forces| forces.social).collect();
    let mut modes = vec![
        ("strict".to_owned(), Mode::Strict(strict), None),
        ("portable".to_owned(), Mode::Portable(Portable::new(&floor.walkers, &floor.walls)), None),
    ];
    let faster = BOUNDS.map(|bound| (bound, Instructions::Detected)).into_iter();
    for (error_mps2_bound, instructions) in faster.chain([(1e-3, Instructions::Avx2), (1e-3, Instructions::Baseline)]) {
        let settings =
            Settings { params: params.clone(), error_mps2: error_mps2_bound, instructions, ..Settings::default() };
        let Ok(mut crowd) = fast::Crowd::new(&floor.walkers, &floor.walls, &settings) else { continue };
        let error = error_mps2(&mut crowd, &wanted);
        let name = match instructions {
            Instructions::Detected => format!("fast {error_mps2_bound:e}"),
            Instructions::Avx2 => format!("fast {error_mps2_bound:e} AVX2"),
            Instructions::Baseline => format!("fast {error_mps2_bound:e} baseline"),
        };
        modes.push((name, Mode::Fast(Box::new(crowd)), Some(error)));
    }
    let pairs = f64::from(n) * f64::from(n);
    let mut seconds = vec![Vec::new(); modes.len()];
    // Modes over all pairs take minutes at the largest size: once is what there is time for.
    let all_pairs = |error: &Option<f64>| error.is_none() && pairs > MANY_PAIRS;
    let steps: Vec<u32> =
        modes.iter_mut().map(|(_, mode, error)| if all_pairs(error) { 1 } else { steps_per_slice(mode) }).collect();
    for round in 0..ROUNDS {
        for (((_, mode, error), seconds), steps) in modes.iter_mut().zip(&mut seconds).zip(&steps) {
            if round == 0 || !all_pairs(error) {
                seconds.push(time(mode, *steps));
            }
        }
    }
    println!(
        "\nCROSS-{n}, {} walls, memory before {before_mb:.1} MB, peak {:.1} MB",
        floor.walls.len(),
        memory_mb("VmHWM")
    );
    println!(
        "{:<20} {:>13} {:>10} {:>10} {:>10} {:>11}",
        "mode", "agent-steps/s", "x strict", "x at 20Hz", "x at 100Hz", "max error"
    );
    let medians: Vec<f64> = seconds.into_iter().map(median).collect();
    let strict_s = medians.first().copied().unwrap_or(f64::NAN);
    for ((name, _, error), seconds) in modes.iter().zip(&medians) {
        let rate = f64::from(n) / seconds;
        let error = error.map_or_else(|| "-".to_owned(), |error| format!("{error:.1e}"));
        println!(
            "{name:<20} {rate:>13.0} {:>10.1} {:>10.2} {:>10.2} {error:>11}",
            strict_s / seconds,
            0.05 / seconds,
            DT_S / seconds,
        );
    }
}

/// Peak memory of a fast crowd alone, before anything else has run.
fn memory_of_fast(n: u32) {
    let floor = cross(n);
    let before = memory_mb("VmHWM");
    let settings = Settings { params: Model::Hunav.params(), ..Settings::default() };
    if let Ok(mut crowd) = fast::Crowd::new(&floor.walkers, &floor.walls, &settings) {
        for _ in 0..3 {
            assert!(black_box(crowd.step(DT_S)).is_ok(), "a step of the workload is a good step");
        }
    }
    println!(
        "peak memory of the process: {before:.1} MB with CROSS-{n} laid out, {:.1} MB after fast steps",
        memory_mb("VmHWM")
    );
}

fn main() {
    let wanted: Vec<u32> = std::env::args().filter_map(|argument| argument.parse().ok()).collect();
    println!("{}", told("social forces of crossing crowds, one thread"));
    println!("one thread, process CPU time, median of {ROUNDS} rounds (all pairs at 10000: one)");
    memory_of_fast(10_000);
    for n in SIZES.into_iter().filter(|n| wanted.is_empty() || wanted.contains(n)) {
        run(n);
    }
}
