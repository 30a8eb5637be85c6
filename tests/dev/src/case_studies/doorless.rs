//! D: rooms and cars whose doors the map does not declare: they are told by the types of nodes, and their openings by the walls.

use std::path::Path;

use socrates_app::config::Config;
use socrates_app::prepare::prepare_text;
use socrates_maps::openings::Enclosures;
use socrates_model::{DoorKind, Relation};

use super::{Case, FEW, MANY, Wrong, check, study_of};

/// The hospital as a scanner and an annotator leave it: no `location.toml`, cars by the types of their nodes, both cars with one type
/// name; where `doorways` is false, rooms by an edge through the wall.
fn annotated(doorways: bool) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../maps/hospital");
    for name in ["map.yaml", "map.png"] {
        std::fs::copy(from.join(name), folder.path().join(name)).unwrap();
    }
    let text = std::fs::read_to_string(from.join("scene_graph.json")).unwrap();
    let mut graph: serde_json::Value = serde_json::from_str(&text).unwrap();
    for node in graph["nodes"].as_array_mut().unwrap() {
        let kind = node["type"].as_str().unwrap();
        if kind.starts_with("IN ELEVATOR") {
            node["type"] = "WITHIN_ELEVATOR_2".into();
        } else if kind == "ELEVATOR LOBBY" {
            node["type"] = "OUTSIDE_ELEVATOR_2".into();
        } else if kind == "DOORWAY" && !doorways {
            node["type"] = "SIMPLE NODE".into();
        }
    }
    std::fs::write(folder.path().join("scene_graph.json"), graph.to_string()).unwrap();
    folder
}

/// Who comes out begins on the floor of its room or car and crosses one of its openings once, outward; nobody else begins there.
fn items(case: &Case<'_>) -> Wrong {
    let mut wrong = Wrong::new();
    let place = &case.scenario.prepared.location;
    let all = Enclosures::of(place);
    check(&mut wrong, place.doors.is_empty(), || "D1: the map declares doors".to_owned());
    let leavers = case.of_relation(Relation::Leaving);
    check(&mut wrong, !leavers.is_empty(), || "D2: nobody comes out".to_owned());
    for id in leavers {
        let track = case.person(id);
        let first = case.scenario.made.paths.humans[&id].first().unwrap();
        let Some(room) = all.of_node(first) else {
            wrong.push(format!("D3: {id} begins at `{first}`, in no place"));
            continue;
        };
        let inside: Vec<bool> = track.iter().map(|state| all.holds(room, &state.point())).collect();
        let changes = inside.windows(2).filter(|pair| pair[0] != pair[1]).count();
        check(&mut wrong, inside[0] && !inside[inside.len() - 1] && changes == 1, || {
            format!(
                "D3: {id} is inside {} at first and {} at last, {changes} changes",
                inside[0],
                inside[inside.len() - 1]
            )
        });
    }
    wrong
}

async fn doorless(rough: &str, doorways: bool, kind: DoorKind, seeds: u64) {
    let folder = annotated(doorways);
    let text = format!(
        "location = {:?}\nsocial_context = \"A hospital\"\ntask = \"Deliver supplies\"\nrough_scenario = \"{rough}\"\n",
        folder.path().display().to_string()
    );
    let config = Config::load(None, std::iter::empty(), &[]).unwrap();
    let prepared = prepare_text("doorless", &text, "doorless", Path::new("."), None, &config).unwrap();
    let all = Enclosures::of(&prepared.location);
    assert_eq!(all.all().iter().filter(|place| place.kind == kind).count(), if kind == DoorKind::Room { 3 } else { 2 });
    study_of(prepared, items, &[], seeds).await;
}

#[tokio::test]
async fn a_visitor_comes_out_of_a_car_that_node_types_alone_tell() {
    doorless("The door opens and a visitor comes out of the elevator.", true, DoorKind::Elevator, FEW).await;
}

#[tokio::test]
async fn a_person_comes_out_of_a_room_with_a_doorway_node_and_no_door() {
    doorless("A person comes out of the room in front of the robot.", true, DoorKind::Room, FEW).await;
}

#[tokio::test]
async fn a_person_comes_out_of_a_room_that_an_edge_leads_into_through_the_wall() {
    doorless("A person comes out of the room in front of the robot.", false, DoorKind::Room, FEW).await;
}

#[tokio::test]
#[ignore = "sweep: 20 seeds of three places without doors"]
async fn people_come_out_of_places_without_doors_over_twenty_seeds() {
    doorless("The door opens and a visitor comes out of the elevator.", true, DoorKind::Elevator, MANY).await;
    for doorways in [true, false] {
        doorless("A person comes out of the room in front of the robot.", doorways, DoorKind::Room, MANY).await;
    }
}
