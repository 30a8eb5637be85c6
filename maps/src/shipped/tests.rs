use super::*;
use std::path::Path;

use crate::{DistanceField, Sight, generate, place, sight_clear};
use socrates_model::{DoorKind, PlaceClass, Point, Request};

fn folder(name: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

#[test]
fn each_shipped_folder_is_what_its_plan_makes() {
    for name in names() {
        let shipped = files(name).unwrap();
        let plan = String::from_utf8(shipped["plan.toml"].clone()).unwrap();
        for (file, bytes) in generate(&plan).unwrap_or_else(|faults| panic!("{name}: {faults:#?}")) {
            assert!(
                shipped[&file] == bytes,
                "{name}/{file} differs from its plan; `socrates map generate` makes the folder anew"
            );
        }
    }
}

#[test]
fn the_catalog_lists_every_folder_and_every_request() {
    for name in names() {
        let listed: Vec<String> = requests(name).iter().map(|(stem, _)| format!("{stem}.toml")).collect();
        let mut found: Vec<String> = std::fs::read_dir(folder(name).join("scenarios"))
            .unwrap()
            .map(|file| file.unwrap().file_name().into_string().unwrap())
            .collect();
        found.sort();
        let mut sorted = listed.clone();
        sorted.sort();
        assert_eq!(sorted, found, "{name}");
    }
    let folders =
        std::fs::read_dir(folder(".")).unwrap().filter(|dir| dir.as_ref().unwrap().path().join("map.yaml").is_file());
    assert_eq!(folders.count(), names().len());
    assert!(load("moon").unwrap_err()[0].message.to_string().contains("warehouse"));
}

#[test]
fn every_shipped_location_is_rich_and_passable() {
    for name in names() {
        let location = load(name).unwrap_or_else(|faults| panic!("{name}: {faults:#?}"));
        assert_eq!(location.warnings, Vec::<String>::new(), "{name}");
        assert!((30..=48).contains(&location.graph.nodes().len()), "{name}: {} nodes", location.graph.nodes().len());
        let field = DistanceField::new(&location.grid);
        for node in location.graph.nodes() {
            let class = PlaceClass::of_type(&node.kind);
            let needed = if class == PlaceClass::Doorway { 0.4 } else { 0.45 };
            let clearance = field.clearance(&node.at);
            assert!(clearance >= needed, "{name} {}: {clearance:.2} m", node.id);
            assert_ne!(class, PlaceClass::Plain, "{name} {}: `{}` says nothing", node.id, node.kind);
        }
        let mut long = 0;
        for edge in location.graph.edges() {
            assert_ne!(PlaceClass::of_type(&edge.kind), PlaceClass::Plain, "{name}: `{}` says nothing", edge.kind);
            let points = location.graph.edge_points(&edge.from, &edge.to).unwrap();
            let length = (points[1] - points[0]).norm();
            long += usize::from(length > 4.05);
            assert!(length < 6.1, "{name} {} – {}: {length:.1} m", edge.from, edge.to);
            for share in 0..=40 {
                let at = points[0] + (points[1] - points[0]) * (f64::from(share) / 40.0);
                let clearance = field.clearance(&at);
                assert!(clearance >= 0.38, "{name} {} – {}: {clearance:.2} m at {at}", edge.from, edge.to);
            }
        }
        assert!(long * 5 <= location.graph.edges().len(), "{name}: {long} long edges");
    }
}

#[test]
fn every_sample_request_is_valid_and_of_its_location() {
    for name in names() {
        for (stem, text) in requests(name) {
            let request = Request::of_toml(text, None).unwrap_or_else(|why| panic!("{name}/{stem}: {why:?}"));
            assert_eq!(request.location, *name, "{stem}");
            assert_eq!(request.rough_scenario.is_none(), stem == "unguided", "{stem}");
        }
    }
}

#[test]
fn two_elevators_hide_those_inside_and_hold_four() {
    let hospital = load("hospital").unwrap();
    let sight = Sight::new(&hospital.grid);
    let elevators: Vec<_> = hospital.doors.iter().filter(|door| door.kind == DoorKind::Elevator).collect();
    assert_eq!(elevators.len(), 2);
    for door in elevators {
        assert!(door.inside.len() >= 2, "{}", door.id);
        let inside: Vec<_> = door.inside.iter().map(|id| hospital.graph.node(id).unwrap()).collect();
        for node in hospital.graph.nodes() {
            if inside.iter().any(|other| other.id == node.id) {
                continue;
            }
            for within in &inside {
                assert!(
                    !sight_clear(&sight, &node.at, &within.at, &[(door.from, door.to)]),
                    "{} {}",
                    node.id,
                    within.id
                );
            }
        }
        // The car is at least 2.2 m wide and deep: a walk inward and sideways from its middle node.
        let middle = inside[0].at;
        let span = |angle: f64| sight.ray(&middle, angle, 9.0) + sight.ray(&middle, angle + std::f64::consts::PI, 9.0);
        assert!(span(0.0) >= 2.2, "{}: {}", door.id, span(0.0));
        let far: Vec<f64> = hospital
            .graph
            .nodes()
            .iter()
            .filter_map(|node| hospital.graph.shortest(&node.id, &inside[0].id))
            .map(|way| hospital.graph.length_m(&way))
            .collect();
        assert!(far.iter().any(|length| *length >= 10.0));
    }
}

#[test]
fn from_the_meeting_room_the_junction_is_near_and_the_corridor_hidden() {
    let office = load("office").unwrap();
    let sight = Sight::new(&office.grid);
    let door = office.door("meeting_room_1").unwrap();
    let junctions: Vec<_> = office
        .graph
        .nodes()
        .iter()
        .filter(|node| office.graph.degree(&node.id) >= 3 && (node.at - door.middle()).norm() <= 8.0)
        .filter(|node| PlaceClass::of_type(&node.kind) == PlaceClass::Intersection)
        .collect();
    assert!(!junctions.is_empty());
    let closed: Vec<(Point, Point)> = office.doors.iter().map(|door| (door.from, door.to)).collect();
    // Even when the door is open, nobody inside sees along the corridor.
    let middle = office.graph.node(&door.inside[0]).unwrap().at;
    for approach in ["h5", "h6"] {
        let along = office.graph.nodes().iter().find(|node| node.id.as_str() == approach).unwrap();
        assert!(!sight.clear(&middle, &along.at), "{approach}");
    }
    for id in &door.inside {
        let within = office.graph.node(id).unwrap();
        for node in office.graph.nodes().iter().filter(|node| PlaceClass::of_type(&node.kind) == PlaceClass::Corridor) {
            assert!(!sight_clear(&sight, &within.at, &node.at, &closed), "{id} sees {}", node.id);
        }
    }
}

/// Distance between the walls left and right of a node, m, across a direction.
fn width(location: &Location, id: &str, across: f64) -> f64 {
    let sight = Sight::new(&location.grid);
    let at = location.graph.nodes().iter().find(|node| node.id.as_str() == id).unwrap().at;
    sight.ray(&at, across, 50.0) + sight.ray(&at, across + std::f64::consts::PI, 50.0)
}

#[test]
fn the_narrow_and_the_wide_places_are_as_the_readme_says() {
    let (along_x, along_y) = (0.0, std::f64::consts::FRAC_PI_2);
    let office = load("office").unwrap();
    assert!((width(&office, "nd", along_x) - 1.0).abs() < 1e-6);
    assert!(width(&office, "h4", along_x) > 35.9);
    let warehouse = load("warehouse").unwrap();
    for aisle in ["g1", "g2"] {
        assert!((width(&warehouse, aisle, along_x) - 1.4).abs() < 1e-6);
    }
    assert!((width(&warehouse, "c3", along_x) - 4.2).abs() < 1e-6);
    let hospital = load("hospital").unwrap();
    assert!(
        (width(&hospital, "c4", along_y) - 3.0).abs() < 1e-6 && (width(&hospital, "n2", along_y) - 2.6).abs() < 1e-6
    );
}

#[test]
fn a_group_can_stand_in_the_packing_area_and_a_robot_can_pass() {
    let warehouse = load("warehouse").unwrap();
    let field = DistanceField::new(&warehouse.grid);
    let open: Vec<_> = place::nodes_of(&warehouse, PlaceClass::OpenArea);
    let roomy = open.iter().filter(|id| field.clearance(&warehouse.graph.node(id).unwrap().at) >= 2.5).count();
    assert!(roomy >= 2, "{roomy} of {open:?}");
    let on_a_straight_way = |id: &&socrates_model::NodeId| {
        let at = warehouse.graph.node(id).unwrap().at;
        let near = warehouse.graph.neighbors(id);
        near.iter().any(|a| {
            near.iter().any(|b| {
                let way = |to| (warehouse.graph.node(to).unwrap().at - at).normalize();
                way(a).dot(&way(b)) < -0.99
            })
        })
    };
    assert!(open.iter().any(|id| on_a_straight_way(&id)));
}
