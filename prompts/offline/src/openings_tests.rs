//! Rooms and cars whose doors the map does not declare.

use socrates_maps::openings::Enclosures;
use socrates_model::{Location, NodeId, Relation};

use crate::tests::{answers, map, request};

/// The hospital without declared doors, the nodes of both cars under one type name.
fn doorless() -> Location {
    let mut place = map("hospital");
    place.doors.clear();
    place.graph = place.graph.edited(|nodes, _| {
        for node in nodes.iter_mut().filter(|node| node.kind.starts_with("IN ELEVATOR")) {
            node.kind = "WITHIN_ELEVATOR_2".into();
        }
    });
    place
}

#[test]
fn who_comes_out_of_a_car_without_a_door_begins_in_it_and_leaves_it() {
    let place = doorless();
    let all = Enclosures::of(&place);
    for seed in 1..=5 {
        let text = "The door opens and a visitor comes out of the elevator.";
        let (_, proposal, paths) = answers(&request("Take the elevator to another floor", Some(text)), &place, seed);
        let human = &proposal.humans[0];
        assert_eq!(human.relation, Relation::Leaving, "{seed}");
        let way = &paths.humans[&human.id];
        let car = all.of_node(&way[0]).unwrap_or_else(|| panic!("{seed}: {way:?}"));
        assert!(all.is_car(&way[0]) && way.iter().any(|node| !car.holds(node)), "{seed}: {way:?}");
    }
}

#[test]
fn those_who_leave_and_stay_share_the_robots_car_and_not_the_one_beside_it() {
    let place = doorless();
    let all = Enclosures::of(&place);
    for seed in 1..=5 {
        let text = "The robot goes to the elevator. There are 3 people inside. Two of them leave the elevator, the third stays.";
        let (_, proposal, paths) = answers(&request("Take the elevator", Some(text)), &place, seed);
        let goal = paths.robot.last().unwrap();
        assert!(all.is_car(goal), "{seed}: the robot ends at {goal}");
        let starts: Vec<&NodeId> = proposal.humans.iter().map(|human| &paths.humans[&human.id][0]).collect();
        assert_eq!(starts.len(), 3);
        assert!(starts.iter().all(|start| all.same(start, goal)), "{seed}: {starts:?} and the robot to {goal}");
    }
}
