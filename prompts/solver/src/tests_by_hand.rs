//! Ways that a person drew by hand on pictures of random worlds, beside those of the solver.

use serde::Deserialize;
use socrates_maps::random;
use socrates_model::geometry::nearest_on_segment;
use socrates_model::{Location, NodeId, PlaceClass, Relation};

use crate::testing::{node, proposal};
use crate::{Problem, solve};

/// What was drawn, before the solver was asked.
const DRAWN: &str = include_str!("../tests/data/ways.json");
/// A way agrees where none of its nodes lies so far from the other way, m, and the lengths differ by no more than this share.
const ASIDE_M: f64 = 3.0;
const LONGER: f64 = 0.05;
/// Ways that agreed when this was written.
const AGREE: usize = 20;
/// Of those where several ways are as short, ways as short as what was drawn, up to [`LONGER`].
const AS_SHORT: usize = 6;

#[derive(Deserialize)]
struct Drawn {
    ways: Vec<Way>,
    several: Vec<Way>,
}

#[derive(Deserialize)]
struct Way {
    kind: String,
    seed: u64,
    place: PlaceClass,
    relation: Relation,
    /// Nodes in order, with blanks between.
    way: String,
}

/// Whether every node of a way lies near another way.
fn is_near(location: &Location, nodes: &[NodeId], other: &[NodeId]) -> bool {
    let line = location.graph.polyline(other);
    nodes.iter().all(|id| {
        let at = location.graph.node(id).unwrap().at;
        line.windows(2).any(|leg| nearest_on_segment(&at, &leg[0], &leg[1]).0 < ASIDE_M)
    })
}

fn agree(location: &Location, one: &[NodeId], other: &[NodeId]) -> bool {
    let (one_m, other_m) = (location.graph.length_m(one), location.graph.length_m(other));
    is_near(location, one, other) && is_near(location, other, one) && (one_m - other_m).abs() <= LONGER * other_m
}

/// How many ways agree, and how many are as short as what was drawn; tells of each.
#[expect(clippy::print_stdout, reason = "figures are for whoever runs the test")]
fn counted(ways: &[Way]) -> (usize, usize) {
    let (mut same, mut near, mut as_short) = (0, 0, 0);
    for one in ways {
        let location = random::location(one.seed, one.kind.parse().unwrap()).unwrap();
        let by_hand: Vec<NodeId> = one.way.split(' ').map(node).collect();
        assert!(by_hand.windows(2).all(|step| location.graph.neighbors(&step[0]).contains(&step[1])), "{}", one.way);
        let proposal = proposal(one.place, &[one.relation]);
        let found = solve(&Problem {
            starts: vec![by_hand.first().unwrap().clone()],
            goals: vec![by_hand.last().unwrap().clone()],
            ..Problem::of(&proposal, &location, "test".into())
        });
        let told = match found.map(|solved| solved.paths.robot) {
            Ok(robot) if robot == by_hand => {
                (same, as_short) = (same + 1, as_short + 1);
                "the same".to_owned()
            }
            Ok(robot) => {
                let agrees = agree(&location, &robot, &by_hand);
                let by_hand_m = location.graph.length_m(&by_hand);
                let more_m = location.graph.length_m(&robot) - by_hand_m;
                near += usize::from(agrees);
                as_short += usize::from(more_m <= LONGER * by_hand_m);
                let names: Vec<&str> = robot.iter().map(NodeId::as_str).collect();
                format!("{} ({more_m:+.1} m) · {}", if agrees { "near" } else { "OTHER" }, names.join(" "))
            }
            Err(miss) => format!("OTHER · {miss}"),
        };
        println!("{:<14} {:<15} {:<9} {told}", location.name, one.place.name(), one.relation.name());
    }
    println!("{same} the same, {near} near, {as_short} as short, of {}", ways.len());
    (same + near, as_short)
}

#[test]
fn the_robot_goes_as_a_person_drew_it_on_worlds_that_the_solver_had_not_seen() {
    let drawn: Drawn = serde_json::from_str(DRAWN).unwrap();
    let (agree, _) = counted(&drawn.ways);
    assert!(agree >= AGREE, "{agree} of {}", drawn.ways.len());
    // Where other ways are as short a person and the solver need not take the same.
    let (_, as_short) = counted(&drawn.several);
    assert!(as_short >= AS_SHORT, "{as_short} of {}", drawn.several.len());
}
