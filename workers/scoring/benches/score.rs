//! Time to score one recording of 60 s at 100 Hz: process CPU time, one thread, medians and, in brackets, the least.
//!
//! `cargo bench --workspace --bench score`, or with `-- 12` for so many humans alone
#![expect(clippy::print_stdout, reason = "a bench prints its table")]
#![expect(clippy::unwrap_used, clippy::indexing_slicing, reason = "a bench is no library")]

#[path = "../../../tests/machine.rs"]
mod machine;

use std::collections::BTreeMap;
use std::hint::black_box;

use machine::cpu_s;
use socrates_model::recording::AgentInfo;
use socrates_model::{
    AgentId, AgentState, Encounter, HumanId, Location, NodeId, Paths, PlannerName, Point, Recording, RecordingHeader,
    RunId,
};
use socrates_scoring::{Evidence, score};

const SECONDS: f64 = 60.0;
const STEP_S: f64 = 0.01;
const ROUNDS: usize = 15;
/// Scores in a round: the system's clock of CPU time ticks every 4 ms.
const EACH: usize = 4;

/// The longest of the shortest ways between any two nodes.
fn longest(location: &Location) -> Vec<NodeId> {
    let nodes = location.graph.nodes();
    let pairs = nodes.iter().flat_map(|a| nodes.iter().map(move |b| (a, b)));
    let ways = pairs.filter_map(|(a, b)| location.graph.shortest(&a.id, &b.id));
    ways.max_by(|a, b| location.graph.length_m(a).total_cmp(&location.graph.length_m(b))).unwrap()
}

/// Where somebody is on a way who goes it in the given time, and the direction of the way there.
fn along(points: &[Point], share: f64) -> (Point, f64) {
    let whole: f64 = points.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
    let mut left = whole * share.clamp(0.0, 1.0);
    for pair in points.windows(2) {
        let line = pair[1] - pair[0];
        if left <= line.norm() {
            return (pair[0] + line * (left / line.norm()), line.y.atan2(line.x));
        }
        left -= line.norm();
    }
    let line = points[points.len() - 1] - points[points.len() - 2];
    (points[points.len() - 1], line.y.atan2(line.x))
}

/// The robot goes the longest way of the map, so many humans come from its other end one after the other.
fn scene(location: &Location, humans: u32) -> (Recording, Paths) {
    let way = longest(location);
    let points = location.graph.polyline(&way);
    let back: Vec<Point> = points.iter().rev().copied().collect();
    let ids: Vec<HumanId> = (1..=humans).map(HumanId::new).collect();
    let agents: Vec<AgentId> =
        std::iter::once(AgentId::Robot).chain(ids.iter().map(|id| AgentId::Human(*id))).collect();
    let ticks = (SECONDS / STEP_S) as u64;
    let mut frames = Vec::new();
    for tick in 0..=ticks {
        let share = tick as f64 / ticks as f64;
        for (k, agent) in agents.iter().enumerate() {
            let (at, yaw) = if k == 0 { along(&points, share) } else { along(&back, share - 0.03 * k as f64) };
            let aside = if k == 0 { -0.3 } else { 0.4 };
            frames.push(AgentState {
                tick,
                agent: agent.number(),
                flags: AgentState::flags(*agent, None, 0),
                x: at.x - aside * yaw.sin(),
                y: at.y + aside * yaw.cos(),
                yaw,
                vx: 0.8 * yaw.cos(),
                vy: 0.8 * yaw.sin(),
                omega: 0.0,
            });
        }
    }
    let header = RecordingHeader {
        format: 1,
        run: RunId::new("bench.reference-1").unwrap(),
        planner: PlannerName::reference(),
        seed: 1,
        profile: "native".into(),
        step_s: STEP_S,
        agents: agents
            .iter()
            .map(|agent| AgentInfo { agent: *agent, radius_m: 0.28, speed_mps: 0.8, role: "person".into() })
            .collect(),
        leaves: vec![],
    };
    let middle = way[way.len() / 2].clone();
    let reversed: Vec<NodeId> = way.iter().rev().cloned().collect();
    let paths = Paths {
        format: 1,
        robot: way,
        humans: ids.iter().map(|id| (*id, reversed.clone())).collect::<BTreeMap<_, _>>(),
        encounters: ids.iter().map(|id| Encounter { human: *id, node: middle.clone() }).collect(),
        reasoning: String::new(),
        author: "bench".into(),
    };
    (Recording { header, frames, events: vec![] }, paths)
}

fn main() {
    let only: Vec<u32> = std::env::args().filter_map(|word| word.parse().ok()).collect();
    println!("{}", machine::told("scoring of one recording of 60 s at 100 Hz"));
    println!("{:<12} {:>7} {:>16} {:>17} {:>17}", "map", "humans", "cells", "tracks only", "with map");
    for name in socrates_maps::shipped::names() {
        let location = socrates_maps::shipped::load(name).unwrap();
        for humans in [2, 4, 12].into_iter().filter(|humans| only.is_empty() || only.contains(humans)) {
            let (run, paths) = scene(&location, humans);
            let alone = Evidence::of(&run);
            let whole = Evidence { location: Some(&location), paths: Some(&paths), ..alone };
            let median = |evidence: &Evidence<'_>| {
                let mut all: Vec<f64> = (0..ROUNDS)
                    .map(|_| {
                        let start = cpu_s();
                        for _ in 0..EACH {
                            black_box(score(black_box(evidence)));
                        }
                        (cpu_s() - start) / EACH as f64
                    })
                    .collect();
                all.sort_by(f64::total_cmp);
                (all[ROUNDS / 2] * 1e3, all[0] * 1e3)
            };
            let cells = format!("{} x {}", location.grid.width, location.grid.height);
            let ((alone, alone_least), (whole, whole_least)) = (median(&alone), median(&whole));
            println!(
                "{name:<12} {humans:>7} {cells:>16} {alone:>7.1} ({alone_least:.1}) ms {whole:>7.1} ({whole_least:.1}) ms"
            );
        }
    }
}
