//! Time to solve one problem by size of the map: process CPU time, one thread, medians in ms. What is worked out of a map once, its
//! distances, rooms and closed edges, is known from the second problem on; the first one is a column of its own.
//!
//! `cargo bench --workspace --bench solver`, or with `-- office` for one map alone
#![expect(clippy::print_stdout, reason = "a bench prints its table")]
#![expect(clippy::unwrap_used, clippy::indexing_slicing, reason = "a bench is no library")]

#[path = "../../../tests/machine.rs"]
mod machine;
#[path = "../src/testing.rs"]
#[expect(dead_code, reason = "the tests draw more maps")]
mod testing;

use std::hint::black_box;

use machine::cpu_s;
use socrates_maps::random::{self, Kind};
use socrates_model::{Location, NodeId, PlaceClass, Relation};
use socrates_solver::{Layout, Problem, impossible, solve};
use testing::{map, proposal};

/// Rounds, of which the median counts.
const ROUNDS: usize = 7;
/// The system's clock of CPU time ticks every 4 ms: a round takes at least so long, s.
const ROUND_S: f64 = 0.04;

/// A hall of so many columns and rows of nodes, 1 m apart.
fn hall(columns: usize, rows: usize) -> Location {
    let count = columns * rows;
    let names: Vec<String> = (0..count).map(|k| format!("n{k}")).collect();
    let at = |k: usize| (1.0 + (k % columns) as f64, 1.0 + (k / columns) as f64);
    let nodes: Vec<(&str, &str, f64, f64)> =
        names.iter().enumerate().map(|(k, id)| (id.as_str(), "OPEN_AREA", at(k).0, at(k).1)).collect();
    let mut edges: Vec<(&str, &str)> = Vec::new();
    for k in 0..count {
        if k % columns + 1 < columns {
            edges.push((&names[k], &names[k + 1]));
        }
        if k + columns < count {
            edges.push((&names[k], &names[k + columns]));
        }
    }
    let (width, height) = (columns as f64 + 1.0, rows as f64 + 1.0);
    map([width, height], &[[0.2, 0.2, width - 0.4, height - 0.4]], &nodes, &edges)
}

/// The maps by name.
fn maps() -> Vec<(String, Location)> {
    let mut maps: Vec<(String, Location)> = Vec::new();
    for (seed, kind) in [(9101, Kind::Home), (9104, Kind::Office)] {
        maps.push((random::name(seed, kind), random::location(seed, kind).unwrap()));
    }
    for name in socrates_maps::shipped::names() {
        maps.push((name.to_string(), socrates_maps::shipped::load(name).unwrap()));
    }
    maps.extend([(25, 20), (40, 25), (50, 40)].map(|(columns, rows)| ("hall".to_owned(), hall(columns, rows))));
    maps.sort_by_key(|(_, location)| location.graph.nodes().len());
    maps
}

/// The ends of the longest of the shortest ways from the first node outside.
fn ends(location: &Location) -> (NodeId, NodeId) {
    let graph = &location.graph;
    let outside = |id: &NodeId| !matches!(graph.kind(id), Some(PlaceClass::Room | PlaceClass::Elevator));
    let mut nodes = graph.nodes().iter().map(|node| node.id.clone()).filter(|id| outside(id));
    let first = nodes.next().unwrap();
    let far = |id: &NodeId| graph.shortest(&first, id).map_or(0.0, |way| graph.length_m(&way));
    let last = nodes.max_by(|a, b| far(a).total_cmp(&far(b))).unwrap();
    (first, last)
}

/// Median time of a call, ms.
fn median_ms(mut call: impl FnMut()) -> f64 {
    let mut all: Vec<f64> = (0..ROUNDS)
        .map(|_| {
            let (start, mut calls) = (cpu_s(), 0_u32);
            while cpu_s() - start < ROUND_S {
                call();
                calls += 1;
            }
            (cpu_s() - start) / f64::from(calls)
        })
        .collect();
    all.sort_by(f64::total_cmp);
    all[ROUNDS / 2] * 1e3
}

fn main() {
    let only: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    println!("{}", machine::told("solving of one problem, ms"));
    let heads = ["first", "one", "by name", "three", "nothing", "beforehand"].map(|head| format!("{head:>11}"));
    println!("{:<12} {:>6} {}", "map", "nodes", heads.join(" "));
    for (name, location) in maps() {
        if !only.is_empty() && !only.iter().any(|word| name.contains(word.as_str())) {
            continue;
        }
        let one = proposal(PlaceClass::Plain, &[Relation::Frontal]);
        let three = proposal(PlaceClass::Plain, &[Relation::Frontal, Relation::Crossing, Relation::Static]);
        let open = |proposal| Problem::of(proposal, &location, "bench".into());
        let start = cpu_s();
        black_box(solve(black_box(&open(&one)))).ok();
        let first_ms = (cpu_s() - start) * 1e3;
        let (from, to) = ends(&location);
        let named = Problem { starts: vec![from], goals: vec![to], ..open(&one) };
        // Nowhere meet nine ways: what comes nearest is looked for.
        let layout = Layout { arms: Some(9), ..Layout::default() };
        let nothing = Problem { layout, ..open(&one) };
        let time = |problem: &Problem<'_>| {
            median_ms(|| {
                black_box(solve(black_box(problem))).ok();
            })
        };
        let before_ms = median_ms(|| {
            black_box(impossible(black_box(&named)));
        });
        let columns = [first_ms, time(&open(&one)), time(&named), time(&open(&three)), time(&nothing), before_ms];
        let columns: Vec<String> = columns.iter().map(|ms| format!("{ms:>11.2}")).collect();
        println!("{name:<12} {:>6} {}", location.graph.nodes().len(), columns.join(" "));
    }
}
