#![cfg(test)]
mod common;
use common::scenario::{look_through, place, relations, run, scenario, ways};
#[test]
fn look() {
    let want = std::env::var("LOOK").unwrap();
    let w: Vec<&str> = want.split(' ').collect(); // map relation from to
    let location = place(w[0]);
    for way in ways(&location, 37, 0) {
        if &way[0].to_string() != w[2] || &way[way.len() - 1].to_string() != w[3] {
            continue;
        }
        for (relation, cast, node) in relations(&location, &way) {
            if relation != w[1] {
                continue;
            }
            println!(
                "robot {:?} human {:?} at {node} {:?}",
                way.iter().map(|n| n.to_string()).collect::<Vec<_>>(),
                cast.1.iter().map(|n| n.to_string()).collect::<Vec<_>>(),
                location.graph.node(&node).unwrap().at
            );
            for n in &way {
                println!("  {n} {:?}", location.graph.node(n).unwrap().at);
            }
            let made = scenario(&location, way.clone(), vec![cast], &[Some(node.clone())], vec![], false);
            let rec = run(made, "reference");
            println!("{:?}", look_through(&rec, 1, 1.5));
            for e in &rec.events {
                println!("{} {:?}", e.time, e.kind);
            }
            let step: usize = std::env::var("STEP").ok().and_then(|s| s.parse().ok()).unwrap_or(100);
            for tick in (0..rec.ticks()).step_by(step) {
                let s = rec.tick(tick);
                println!(
                    "{:.1}: r {:.2} {:.2} yaw {:.2} v {:.2} | h {:.2} {:.2} yaw {:.2} v {:.2} leaf {} | d {:.2}",
                    tick as f64 * 0.01,
                    s[0].x,
                    s[0].y,
                    s[0].yaw,
                    s[0].speed(),
                    s[1].x,
                    s[1].y,
                    s[1].yaw,
                    s[1].speed(),
                    s[1].leaf(),
                    (s[0].point() - s[1].point()).norm() - 0.53
                );
            }
        }
    }
}
