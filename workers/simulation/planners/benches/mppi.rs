//! MPPI: time of a cycle, against a plain scalar one of the same run.
//!
//! `cargo bench -p socrates-planners --bench mppi`. One thread, process CPU time, median of several rounds; in each round every row has its
//! turn with both, so that ratios are of the same minute. A robot drives past a disc beside a straight plan, 240 cycles of 0.05 s.

#![expect(clippy::print_stdout, reason = "a bench prints its figures")]

#[path = "../../../../tests/machine.rs"]
mod machine;
#[expect(clippy::indexing_slicing, reason = "written as plainly as it can be; its sizes are its own")]
mod reference;

use std::hint::black_box;

use machine::{cpu_s, told};
use reference::Reference;
use socrates_model::{Point, Pose};
use socrates_planners::controller::{Controller as _, Following, Twist};
use socrates_planners::costmap::{Costmap, FREE, LETHAL};
use socrates_planners::mppi::{Instructions, MotionModel, Mppi, MppiParams};

const ROUNDS: usize = 5;
const CYCLES: u32 = 240;
const PERIOD_S: f64 = 0.05;
/// Calls of the unit that the reference is given in.
const CALLS: u32 = 1_000_000;

/// A floor of 10 m by 10 m with a disc of 0.2 m at (6.0, 5.1).
fn floor() -> Costmap {
    let mut costmap = Costmap::new(200, 200, 0.05, Point::origin(), FREE);
    for row in 0..200 {
        for column in 0..200 {
            let center = costmap.center(column, row);
            let distance = libm::hypot(center.x - 6.0, center.y - 5.1) - 0.2;
            let inflated = (252.0 * libm::exp(-3.0 * (distance - 0.22))).min(253.0) as u8;
            let cost = match distance {
                inside if inside <= 0.0 => LETHAL,
                near if near <= 0.7 => inflated,
                _ => continue,
            };
            costmap.set(column, row, cost);
        }
    }
    costmap
}

/// What is measured.
struct Row {
    name: &'static str,
    params: MppiParams,
}

/// Drives past the disc; gives the CPU time of a cycle, ms, and where the robot got to.
fn drive(costmap: &Costmap, mut command: impl FnMut(Pose, Twist, &[Pose]) -> Twist) -> (f64, Pose) {
    let plan: Vec<Pose> = (0..=160_u8).map(|number| Pose::new(4.0 + 0.025 * f64::from(number), 5.0, 0.0)).collect();
    let (mut pose, mut speed) = (Pose::new(4.0, 5.0, 0.0), Twist::default());
    let before = cpu_s();
    for _ in 0..CYCLES {
        let first = (((pose.x - 4.0) / 0.025 + 0.5).max(0.0) as usize).min(plan.len() - 1);
        let local = plan.get(first..(first + 81).min(plan.len())).unwrap_or_default();
        speed = black_box(command(pose, speed, local));
        let (sine, cosine) = libm::sincos(pose.yaw);
        pose = Pose::new(
            pose.x + PERIOD_S * (speed.vx * cosine - speed.vy * sine),
            pose.y + PERIOD_S * (speed.vx * sine + speed.vy * cosine),
            pose.yaw + PERIOD_S * speed.omega,
        );
    }
    black_box(costmap);
    ((cpu_s() - before) * 1e3 / f64::from(CYCLES), pose)
}

/// A drive of the controller of this crate.
fn ours(row: &Row, costmap: &Costmap, seed: u64, instructions: Instructions) -> (f64, Pose) {
    let Ok(mppi) = Mppi::new(&row.params, seed) else { return (f64::NAN, Pose::new(0.0, 0.0, 0.0)) };
    let mut mppi = mppi.with_instructions(instructions);
    drive(costmap, |pose, speed, plan| {
        let cycle =
            Following { pose, speed, plan, goal: Pose::new(8.0, 5.0, 0.0), costmap, footprint: &[], speed_share: 1.0 };
        mppi.command(&cycle).unwrap_or_default()
    })
}

/// A drive of the reference.
fn plain(row: &Row, costmap: &Costmap, seed: u64) -> (f64, Pose) {
    let mut reference = Reference::new(&row.params, seed);
    drive(costmap, |pose, _, plan| reference.command(pose, plan, costmap))
}

/// Time of a million exponentials, ms.
fn exponentials_ms() -> f64 {
    let before = cpu_s();
    let mut sum = 0.0_f32;
    for call in 0..CALLS {
        sum += libm::expf(black_box(-8.0 * (call as f32 / CALLS as f32)));
    }
    black_box(sum);
    (cpu_s() - before) * 1e3
}

/// The middle of several numbers.
fn median(numbers: impl Iterator<Item = f64>) -> f64 {
    let mut numbers: Vec<f64> = numbers.collect();
    numbers.sort_by(f64::total_cmp);
    numbers.get(numbers.len() / 2).copied().unwrap_or(f64::NAN)
}

fn rows() -> Vec<Row> {
    let row = |name, batch_size, motion_model| Row {
        name,
        params: MppiParams { batch_size, motion_model, ..MppiParams::bringup() },
    };
    let mut rows = vec![
        row("diff drive 400 x 56", 400, MotionModel::DiffDrive),
        row("diff drive 1000 x 56", 1000, MotionModel::DiffDrive),
        row("diff drive 2000 x 56", 2000, MotionModel::DiffDrive),
        row("omni 2000 x 56", 2000, MotionModel::Omni),
        row("Ackermann 2000 x 56", 2000, MotionModel::Ackermann { min_turning_r: 0.2 }),
    ];
    let mut fresh = row("diff drive 2000 x 56, new noise", 2000, MotionModel::DiffDrive);
    fresh.params.regenerate_noises = true;
    rows.push(fresh);
    rows
}

fn main() {
    println!("{}", told("MPPI with the eight critics of Nav2's bringup, one thread"));
    println!("process CPU time, median of {ROUNDS} drives of {CYCLES} cycles, each with a seed of its own");
    let costmap = floor();
    let mut exponentials = Vec::new();
    let rows = rows();
    let mut times = vec![Vec::new(); rows.len()];
    for seed in 0..ROUNDS as u64 {
        exponentials.push(exponentials_ms());
        for (row, times) in rows.iter().zip(&mut times) {
            let detected = ours(row, &costmap, seed, Instructions::Detected);
            let one_lane = ours(row, &costmap, seed, Instructions::Baseline);
            let plain = plain(row, &costmap, seed);
            times.push([detected.0, one_lane.0, plain.0, detected.1.x, plain.1.x]);
        }
    }
    let unit_ms = median(exponentials.into_iter());
    println!("10^6 calls of libm::expf: {unit_ms:.2} ms");
    println!(
        "\n{:<32} {:>9} {:>9} {:>9} {:>8} {:>9} {:>7} {:>15}",
        "", "ours, ms", "one lane", "plain, ms", "ratio", "x expf", "x 20Hz", "ends x, m"
    );
    for (row, times) in rows.iter().zip(&times) {
        let of = |column: usize| median(times.iter().filter_map(|row| row.get(column).copied()));
        println!(
            "{:<32} {:>9.2} {:>9.2} {:>9.2} {:>8.2} {:>9.2} {:>7.0} {:>7.2} {:>7.2}",
            row.name,
            of(0),
            of(1),
            of(2),
            of(0) / of(2),
            of(2) / unit_ms,
            1e3 * PERIOD_S / of(0),
            of(3),
            of(4)
        );
    }
}
