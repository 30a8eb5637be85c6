//! The simple baseline `reactive` alone on the shipped floors: it arrives, by a short way, and touches no wall.
#![expect(clippy::print_stdout, reason = "the longest way of each floor is told")]

use socrates_engine::Setup;
use socrates_maps::{DistanceField, Geodesic};
use socrates_model::request::Waypoints;
use socrates_model::{EventKind, GraphEdge, GraphNode, Location, NodeId, Point, Recording, SceneGraph};

use crate::common::scenario::{place, run, scenario};
use crate::common::scene::Random;

/// Ways of each floor.
const WAYS: usize = 12;
/// Longest way, as a share of the shortest free way.
const LONGEST: f64 = 1.3;

/// A free place, by chance, from which the robot reaches a node of the graph straight; with that node.
fn spot(random: &mut Random, location: &Location, field: &DistanceField) -> (Point, NodeId) {
    let grid = &location.grid;
    let (width, height) = (grid.width as f64 * grid.resolution_m, grid.height as f64 * grid.resolution_m);
    loop {
        let (x, y) = (grid.origin.x + random.uniform() * width, grid.origin.y + random.uniform() * height);
        let at = Point::new(x, y);
        if field.clearance(&at) < 0.35 {
            continue;
        }
        let near = location.graph.nodes().iter().filter(|node| location.door_of(&node.id).is_none());
        let nearest = near.min_by(|a, b| (a.at - at).norm().total_cmp(&(b.at - at).norm()));
        if let Some(node) = nearest.filter(|node| (node.at - at).norm() < 6.0 && free(field, &at, &node.at)) {
            return (at, node.id.clone());
        }
    }
}

fn free(field: &DistanceField, from: &Point, to: &Point) -> bool {
    (0..=100).all(|step| field.clearance(&(from + (to - from) * (f64::from(step) / 100.0))) >= 0.3)
}

/// The robot alone, from one free place to another through the nodes between; with the points of that way.
fn alone(random: &mut Random, location: &Location, field: &DistanceField) -> (Setup, Vec<Point>) {
    loop {
        let ((from, first), (to, last)) = (spot(random, location, field), spot(random, location, field));
        let Some(between) = location.graph.shortest(&first, &last) else { continue };
        // Nobody opens doors for a robot that is alone.
        if between.iter().any(|node| location.door_of(node).is_some()) || (to - from).norm() < 4.0 {
            continue;
        }
        let named = |name: &str| NodeId::new(name).unwrap();
        let node = |name: &str, at: Point| GraphNode { id: named(name), kind: "CORRIDOR".into(), at };
        let edge = |from: NodeId, to: NodeId| GraphEdge { from, to, kind: "CORRIDOR".into(), via: vec![] };
        let mut graph = (location.graph.nodes().to_vec(), location.graph.edges().to_vec());
        graph.0.extend([node("from_here", from), node("to_there", to)]);
        graph.1.extend([edge(named("from_here"), first), edge(last, named("to_there"))]);
        let location = Location { graph: SceneGraph::new(graph.0, graph.1), ..location.clone() };
        let way: Vec<NodeId> = [named("from_here")].into_iter().chain(between).chain([named("to_there")]).collect();
        let points = way.iter().map(|id| location.graph.node(id).unwrap().at).collect();
        return (scenario(&location, way, vec![], &[], vec![], false), points);
    }
}

fn shortest_m(field: &DistanceField, points: &[Point], radius_m: f64) -> f64 {
    let legs = points.windows(2).map(|leg| Geodesic::to(field, &leg[1], radius_m).distance(&leg[0]).unwrap());
    legs.sum()
}

fn driven_m(recording: &Recording) -> f64 {
    (1..recording.ticks())
        .map(|tick| (recording.tick(tick)[0].point() - recording.tick(tick - 1)[0].point()).norm())
        .sum()
}

#[test]
fn alone_on_every_shipped_floor_the_baseline_arrives_by_a_short_way_and_touches_no_wall() {
    let mut random = Random::new(5);
    for name in socrates_maps::shipped::names() {
        let location = place(name);
        let field = DistanceField::new(&location.grid);
        let mut longest = (0.0, String::new());
        for _ in 0..WAYS {
            let (made, points) = alone(&mut random, &location, &field);
            let ends = [points[0], points[points.len() - 1]];
            for (waypoints, through) in [(Waypoints::All, points.as_slice()), (Waypoints::Ends, &ends)] {
                let about = format!("{name}, {waypoints:?}, {:.1} to {:.1}", ends[0], ends[1]);
                let recording = run(Setup { waypoints, ..made.clone() }, "reactive");
                let told = |kind: &dyn Fn(&EventKind) -> bool| recording.events.iter().any(|event| kind(&event.kind));
                assert!(
                    told(&|kind| *kind == EventKind::RobotArrived),
                    "{about}: it does not arrive, it ends at {:?}",
                    recording.tick(recording.ticks() - 1)[0].point()
                );
                assert!(!told(&|kind| matches!(kind, EventKind::WallContact { .. })), "{about}: it touches a wall");
                let share = driven_m(&recording) / shortest_m(&field, through, made.robot.radius_m);
                assert!(share <= LONGEST, "{about}: it drives {share:.2} times the shortest free way");
                if share > longest.0 {
                    longest = (share, about);
                }
            }
        }
        println!("{:.3} times the shortest way: {}", longest.0, longest.1);
    }
}
