//! Requests that name a place of the map: people are met there and nowhere else.

use socrates_model::{FactKind, Location, NodeId, Paths, PlaceClass, Predicate, Proposal};

use crate::read;
use crate::tests::{answers, map, request};

fn both(on: &str, task: &str, rough: &str, seed: u64) -> (Location, Proposal, Paths) {
    let location = map(on);
    let (_, proposal, paths) = answers(&request(task, Some(rough)), &location, seed);
    (location, proposal, paths)
}

fn judged(proposal: &Proposal) -> Vec<NodeId> {
    let named = proposal.expected_events.iter().filter(|clause| clause.must).find_map(|clause| {
        if let Predicate::EncounterAt { nodes, .. } = &clause.predicate { Some(nodes.clone()) } else { None }
    });
    named.unwrap_or_default()
}

#[test]
fn who_stands_at_a_place_by_name_stands_there_with_the_others() {
    for (on, task, rough, nodes) in [
        (
            "hospital",
            "Bring tea to the patients",
            "Two patients stand in the waiting area and look at the robot when it comes.",
            &["wa1", "wa2"][..],
        ),
        ("hospital", "Bring tea to the waiting area", "Five visitors stand in the waiting area.", &["wa1", "wa2"]),
        ("office", "Collect cups in the kitchen", "Two people stand in the kitchen and talk.", &["kt"]),
        ("office", "Collect cups", "Four people queue in the kitchen.", &["kt"]),
        (
            "warehouse",
            "Drive to the loading dock",
            "Eight workers stand in the packing area. The robot says excuse me and they make room for it.",
            &["p1", "p2", "p3"],
        ),
    ] {
        for seed in 1..=3 {
            let (_, proposal, paths) = both(on, task, rough, seed);
            assert_eq!(judged(&proposal).iter().map(ToString::to_string).collect::<Vec<_>>(), nodes, "{rough}");
            for way in paths.humans.values() {
                assert!(way.iter().all(|node| nodes.contains(&node.as_str())), "{rough} {:?}", paths.humans);
            }
            assert!(paths.robot.iter().any(|node| nodes.contains(&node.as_str())), "{rough}");
        }
    }
}

#[test]
fn a_doorway_is_met_in_a_doorway() {
    let rough = "A woman and the robot meet at the doorway. Both stop. She waves the robot through.";
    for seed in 1..=3 {
        let (location, _, paths) = both("office", "Drive to reception", rough, seed);
        let kinds =
            paths.encounters.iter().map(|encounter| location.graph.node(&encounter.node).unwrap().kind.as_str());
        assert!(kinds.clone().all(|kind| PlaceClass::of_type(kind) == PlaceClass::Doorway), "{:?}", paths.encounters);
    }
}

#[test]
fn a_name_that_the_map_does_not_have_is_said() {
    let reading = read(&request("Deliver mail", Some("Two visitors talk in the cafeteria.")), &map("hospital"));
    let said: Vec<String> = reading.problems.iter().map(|fault| fault.message.to_string()).collect();
    assert!(matches!(said.as_slice(), [only] if only.starts_with("`cafeteria`: this map has no place")), "{said:?}");
    let reading = read(&request("Deliver mail", Some("Two visitors talk in the kitchen.")), &map("office"));
    assert_eq!(reading.problems, []);
}

#[test]
fn where_somebody_goes_is_not_where_the_robot_meets_it() {
    let rough = "An old man walks slowly in front of the robot. The robot follows him until he turns into the ward.";
    let reading = read(&request("Deliver lunch to the ward", Some(rough)), &map("hospital"));
    assert_eq!(reading.place, None);
}

#[test]
fn who_leaves_a_standing_group_stands_with_it() {
    let rough =
        "Three people are standing in a circle at the intersection. One leaves the group when the robot arrives.";
    let reading = read(&request("Drive to the meeting room", Some(rough)), &map("office"));
    let relations: Vec<_> = reading.humans.iter().map(|human| human.relation.unwrap()).collect();
    assert_eq!(relations, [socrates_model::Relation::Static; 3]);
    assert!(reading.notes.iter().any(|note| note.contains("not played")), "{:?}", reading.notes);
    let coming = read(&request("Drive", Some("One person comes out of a room.")), &map("office"));
    assert!(coming.facts.iter().any(|fact| matches!(fact.kind, FactKind::Relates { .. })));
}

#[test]
fn many_people_start_as_a_stream_and_no_four_at_one_node() {
    let rough = "Twelve visitors walk in both directions along the main corridor.";
    let (_, _, paths) = both("hospital", "Drive from the waiting area to the exit", rough, 1);
    for way in paths.humans.values() {
        let start = way.first().unwrap();
        let others = paths.humans.values().filter(|other| other.first() == Some(start)).count();
        assert!(others <= 3 && paths.robot.first() != Some(start), "{:?}", paths.humans);
    }
}
