//! People who avoid each other: the crossing crowd with everybody walking by `Orca`, against the reference
//! implementation of the paper where it is installed.
//!
//! `cargo bench --workspace --bench orca -- [SIZE]...` takes the sizes to run (10 50 300 1000 5000); without one,
//! all. The peer is the Python package `pyrvo` (RVO2 in C++): `python3 -m pip install pyrvo`. The variable
//! `PYTHON` names another interpreter. Without the package its column says so.

#![expect(clippy::print_stdout, reason = "a bench prints its figures")]

mod common;

use std::fmt::Write as _;
use std::hint::black_box;
use std::io::Write as _;
use std::process::{Command, Stdio};
use std::sync::Arc;

use common::machine::{cpu_s, told};
use common::median;
use socrates_crowd::cross::{Cross, DT_S, cross};
use socrates_crowd::orca::{Orca, OrcaSettings};
use socrates_crowd::{Member, Mix};

const SIZES: [u32; 5] = [10, 50, 300, 1000, 5000];
const ROUNDS: usize = 7;
/// Agent-steps of one round: some tens of milliseconds.
const AGENT_STEPS: u32 = 50_000;

/// RVO2 with the same people, walls and settings, from standard input; prints the CPU time of a step, s.
const PEER: &str = r"
import sys, time
try:
    import pyrvo
except ImportError:
    print('not here'); sys.exit()
n, rounds, steps, dt, reach, most, horizon, wall_horizon = [float(w) for w in sys.stdin.readline().split()]
sim = pyrvo.RVOSimulator(dt, reach, int(most), horizon, wall_horizon, 0.35, 1.0)
goals = []
for line in sys.stdin:
    kind, *numbers = line.split()
    a = [float(w) for w in numbers]
    if kind == 'wall':
        sim.add_obstacle([(a[0], a[1]), (a[2], a[3])])
    else:
        i = sim.add_agent((a[0], a[1]), reach, int(most), horizon, wall_horizon, a[5], a[4], (a[2], a[3]))
        goals.append((a[6], a[7], a[4]))
sim.process_obstacles()
times = []
for _ in range(int(rounds)):
    spent = 0.0
    for _ in range(int(steps)):
        for i, (x, y, speed) in enumerate(goals):
            at = sim.get_agent_position(i)
            dx, dy = x - at.x, y - at.y
            left = (dx * dx + dy * dy) ** 0.5 or 1.0
            sim.set_agent_pref_velocity(i, (dx / left * speed, dy / left * speed))
        start = time.process_time()
        sim.do_step()
        spent += time.process_time() - start
    times.append(spent / int(steps))
times.sort()
print(times[len(times) // 2])
";

fn mix(floor: &Cross) -> Mix {
    let model = Arc::new(Orca::new(OrcaSettings::default()).unwrap_or_else(|bad| unreachable!("defaults: {bad}")));
    let members = floor.walkers.iter().map(|walker| Member::walking(walker.clone(), model.clone()));
    Mix::new(members.collect(), floor.walls.clone(), 0.0)
}

/// FNV-1a of all places and velocities.
fn check_sum(mix: &Mix) -> u64 {
    let numbers = mix
        .people()
        .flat_map(|person| [person.position.x, person.position.y, person.velocity.x, person.velocity.y, person.yaw]);
    let bytes = numbers.flat_map(|number| number.to_bits().to_le_bytes());
    bytes.fold(0xCBF2_9CE4_8422_2325, |sum, byte| (sum ^ u64::from(byte)).wrapping_mul(0x0100_0000_01B3))
}

/// CPU time of a step of the peer, s; `None` where it is not installed.
fn peer(floor: &Cross, steps: u32) -> Option<f64> {
    let settings = OrcaSettings::default();
    let mut text = format!(
        "{} {ROUNDS} {steps} {DT_S} {} {} {} {}\n",
        floor.walkers.len(),
        settings.neighbor_range_m,
        settings.most_neighbors,
        settings.horizon_s,
        settings.wall_horizon_s
    );
    for wall in &floor.walls {
        writeln!(text, "wall {} {} {} {}", wall.from.x, wall.from.y, wall.to.x, wall.to.y).ok()?;
    }
    for walker in &floor.walkers {
        let (person, goal) = (&walker.person, walker.route.goal()?);
        let (at, velocity) = (person.position, person.velocity);
        let own = format!("{} {} {} {}", at.x, at.y, velocity.x, velocity.y);
        writeln!(text, "agent {own} {} {} {} {}", person.speed_mps, person.radius_m, goal.at.x, goal.at.y).ok()?;
    }
    let python = std::env::var("PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let mut child = Command::new(python)
        .args(["-c", PEER])
        .env("OMP_NUM_THREADS", "1")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .ok()?;
    // A peer that is not here reads nothing; what it prints tells.
    let _written = child.stdin.take().map(|mut input| input.write_all(text.as_bytes()));
    let output = child.wait_with_output().ok()?;
    String::from_utf8_lossy(&output.stdout).trim().parse().ok()
}

fn main() {
    let wanted: Vec<u32> = std::env::args().filter_map(|argument| argument.parse().ok()).collect();
    println!("{}", told("avoidance (ORCA) in crossing crowds, one thread"));
    println!("CROSS-N, all by Orca, 10 neighbors in 5 m, horizons 2 s and 0.5 s, steps of {DT_S} s; one thread,");
    println!("process CPU time, median of {ROUNDS} rounds; RVO2 by pyrvo, its doStep alone");
    println!(
        "{:>6} {:>12} {:>15} {:>12} {:>14}   check sum",
        "N", "us a step", "agent-steps/s", "RVO2 us", "times RVO2"
    );
    for n in SIZES.into_iter().filter(|n| wanted.is_empty() || wanted.contains(n)) {
        let floor = cross(n);
        let mut mix = mix(&floor);
        let steps = AGENT_STEPS.div_ceil(n);
        let mut done = 0;
        let rounds = (0..ROUNDS).map(|_| {
            let before = cpu_s();
            for _ in 0..steps {
                done += 1;
                assert!(black_box(mix.advance_to(f64::from(done) * DT_S)).is_ok(), "time goes on");
            }
            (cpu_s() - before) / f64::from(steps)
        });
        let ours = median(rounds.collect());
        let theirs = peer(&floor, steps);
        println!(
            "{n:>6} {:>12.1} {:>15.0} {:>12} {:>14}   {:016x}",
            ours * 1e6,
            f64::from(n) / ours,
            theirs.map_or_else(|| "not here".to_owned(), |theirs| format!("{:.1}", theirs * 1e6)),
            theirs.map_or_else(|| "-".to_owned(), |theirs| format!("{:.2}", theirs / ours)),
            check_sum(&mix),
        );
    }
}
