use socrates_model::{
    Cell, Door, DoorKind, DoorOpens, GraphEdge, GraphNode, Grid, Location, NodeId, Point, Pose, SceneGraph,
};

use super::{Across, Enclosures, OpenPlan};

fn id(text: &str) -> NodeId {
    NodeId::new(text).unwrap()
}

/// A map of 16 m by 12 m with this free floor: rectangles `(left, bottom, right, top)`, m.
fn map(floors: &[(f64, f64, f64, f64)], nodes: &[(&str, &str, f64, f64)], edges: &[(&str, &str)]) -> Location {
    let (width, height, resolution_m) = (160, 120, 0.1);
    let origin = Pose::new(0.0, 0.0, 0.0);
    let mut grid = Grid { width, height, resolution_m, origin, cells: vec![Cell::Occupied; width * height] };
    for row in 0..height {
        for column in 0..width {
            let at = grid.center_of(column, row);
            let on = |(left, bottom, right, top): &(f64, f64, f64, f64)| {
                at.x > *left && at.x < *right && at.y > *bottom && at.y < *top
            };
            if floors.iter().any(on) {
                grid.cells[row * width + column] = Cell::Free;
            }
        }
    }
    let node = |(name, kind, x, y): &(&str, &str, f64, f64)| GraphNode {
        id: id(name),
        kind: (*kind).into(),
        at: Point::new(*x, *y),
    };
    let edge = |(a, b): &(&str, &str)| GraphEdge { from: id(a), to: id(b), kind: "SIMPLE EDGE".into(), via: vec![] };
    Location {
        format: 1,
        name: "own".into(),
        description: "Made for a test.".into(),
        grid,
        graph: SceneGraph::new(nodes.iter().map(node).collect(), edges.iter().map(edge).collect()),
        doors: vec![],
        names: Vec::new(),
        warnings: vec![],
    }
}

fn door(name: &str, kind: DoorKind, line: [f64; 4], inside: &[&str]) -> Door {
    let [x0, y0, x1, y1] = line;
    Door {
        id: name.into(),
        kind,
        from: Point::new(x0, y0),
        to: Point::new(x1, y1),
        opens: DoorOpens::Near(1.2),
        hold_s: 8.0,
        inside: inside.iter().map(|node| id(node)).collect(),
    }
}

/// A corridor along y = 2 and two rooms above it, with openings of 1 m at x = 4 and x = 11.
const CORRIDOR: (f64, f64, f64, f64) = (0.5, 1.0, 15.5, 3.0);
const LEFT: (f64, f64, f64, f64) = (1.0, 3.2, 7.4, 8.0);
const RIGHT: (f64, f64, f64, f64) = (7.6, 3.2, 15.0, 8.0);
const LEFT_GAP: (f64, f64, f64, f64) = (3.5, 2.9, 4.5, 3.3);
const RIGHT_GAP: (f64, f64, f64, f64) = (10.5, 2.9, 11.5, 3.3);
const FLOORS: [(f64, f64, f64, f64); 5] = [CORRIDOR, LEFT, RIGHT, LEFT_GAP, RIGHT_GAP];

#[track_caller]
fn only_opening(location: &Location, node: &str, across: &Across, middle: (f64, f64), width_m: f64) {
    let found = Enclosures::of(location);
    let place = found.of_node(&id(node)).unwrap_or_else(|| panic!("`{node}` is in no place: {:?}", found.open_plan()));
    assert_eq!(place.openings.len(), 1, "{place:?}");
    let opening = &place.openings[0];
    assert_eq!(&opening.across, across);
    let off = (opening.middle() - Point::new(middle.0, middle.1)).norm();
    assert!(off < 0.3, "{off} m off: {opening:?}");
    assert!((opening.width_m - width_m).abs() < 0.25, "{opening:?}");
    let inner = location.graph.node(&id(node)).unwrap().at;
    assert!(opening.depth_m(&inner) > 0.25, "{opening:?}");
    assert!((opening.inward.norm() - 1.0).abs() < 1e-9);
}

#[test]
fn two_rooms_with_doorway_nodes_are_two_places() {
    let place = map(
        &FLOORS,
        &[
            ("c", "CORRIDOR", 4.0, 2.0),
            ("e", "CORRIDOR", 11.0, 2.0),
            ("d", "DOORWAY", 4.0, 3.1),
            ("f", "DOORWAY", 11.0, 3.1),
            ("r", "ROOM", 4.0, 5.0),
            ("s", "ROOM", 11.0, 5.0),
        ],
        &[("c", "e"), ("c", "d"), ("d", "r"), ("e", "f"), ("f", "s")],
    );
    only_opening(&place, "r", &Across::Node(id("d")), (4.0, 3.1), 1.0);
    only_opening(&place, "s", &Across::Node(id("f")), (11.0, 3.1), 1.0);
    let found = Enclosures::of(&place);
    assert!(!found.same(&id("r"), &id("s")) && found.same(&id("r"), &id("r")) && found.all().len() == 2);
    assert!(["c", "e", "d", "f"].iter().all(|node| !found.is_inside(&id(node))));
    let room = found.of_node(&id("r")).unwrap();
    for (x, y, inside) in [(1.2, 7.8, true), (4.0, 3.6, true), (4.0, 2.5, false), (11.0, 5.0, false)] {
        assert_eq!(found.holds(room, &Point::new(x, y)), inside, "({x}, {y})");
    }
}

#[test]
fn an_edge_out_of_a_room_has_its_opening_at_its_narrowest_place() {
    // The way passes the opening obliquely.
    let place = map(
        &FLOORS,
        &[
            ("c", "CORRIDOR", 3.0, 2.0),
            ("e", "CORRIDOR", 12.0, 2.0),
            ("r", "ROOM", 5.0, 4.4),
            ("s", "OFFICE", 10.4, 4.2),
        ],
        &[("c", "e"), ("c", "r"), ("e", "s")],
    );
    only_opening(&place, "r", &Across::Edge(id("r"), id("c")), (4.0, 3.1), 1.1);
    only_opening(&place, "s", &Across::Edge(id("s"), id("e")), (11.0, 3.1), 1.1);
}

#[test]
fn a_node_between_room_and_corridor_without_a_telling_type_lies_where_the_walls_say() {
    // `p` stands in the room, `q` in the corridor.
    let place = map(
        &FLOORS,
        &[
            ("r", "ROOM", 4.0, 6.5),
            ("p", "SIMPLE NODE", 4.0, 4.5),
            ("q", "SIMPLE NODE", 4.0, 2.0),
            ("c", "CORRIDOR", 8.0, 2.0),
        ],
        &[("r", "p"), ("p", "q"), ("q", "c")],
    );
    only_opening(&place, "p", &Across::Edge(id("p"), id("q")), (4.0, 3.1), 1.0);
    let found = Enclosures::of(&place);
    assert!(found.same(&id("r"), &id("p")) && !found.is_inside(&id("q")));
}

#[test]
fn declared_doors_are_taken_as_they_are() {
    let mut place = map(
        &FLOORS,
        &[
            ("c", "CORRIDOR", 4.0, 2.0),
            ("e", "CORRIDOR", 11.0, 2.0),
            ("r", "STORE", 4.0, 5.0),
            ("f", "DOORWAY", 11.0, 3.1),
            ("s", "ROOM", 11.0, 5.0),
        ],
        &[("c", "e"), ("c", "r"), ("e", "f"), ("f", "s")],
    );
    place.doors = vec![
        door("store", DoorKind::Room, [3.5, 3.1, 4.5, 3.1], &["r"]),
        door("office", DoorKind::Room, [11.5, 3.1, 10.5, 3.1], &[]),
    ];
    only_opening(&place, "r", &Across::Door("store".into()), (4.0, 3.1), 1.0);
    // It names nothing behind it: the walls tell.
    only_opening(&place, "s", &Across::Door("office".into()), (11.0, 3.1), 1.0);
    let found = Enclosures::of(&place);
    assert_eq!(found.of_node(&id("s")).unwrap().id, "office");
    assert_eq!(found.doors(&place), place.doors, "nothing is added where every opening has its door");
    let way = [id("r"), id("c"), id("e")];
    let (_, opening) = found.way_out(&place, &way).unwrap();
    assert_eq!(opening.door(), Some("store"));
}

/// Two cars side by side before a lobby; the nodes of both have one type.
fn cars(front_y: f64) -> Location {
    map(
        &[(0.5, 1.0, 15.5, 4.0), (4.0, 4.0, 5.8, 6.4), (7.0, 4.0, 8.8, 6.4)],
        &[
            ("hall", "CORRIDOR", 1.5, 2.5),
            ("oa", "OUTSIDE_ELEVATOR_2", 4.9, 2.6),
            ("ob", "OUTSIDE_ELEVATOR_2", 7.9, 2.6),
            ("a1", "WITHIN_ELEVATOR_2", 4.9, front_y),
            ("a2", "WITHIN_ELEVATOR_2", 4.9, 5.8),
            ("b1", "WITHIN_ELEVATOR_2", 7.9, front_y),
            ("b2", "WITHIN_ELEVATOR_2", 7.9, 5.8),
        ],
        &[("hall", "oa"), ("oa", "ob"), ("oa", "a1"), ("a1", "a2"), ("ob", "b1"), ("b1", "b2")],
    )
}

#[test]
fn two_cars_of_one_type_are_two_places_and_their_nodes_stay_behind_their_lines() {
    for front_y in [5.0, 4.3, 4.0, 3.95] {
        let place = cars(front_y);
        let found = Enclosures::of(&place);
        assert_eq!(found.all().len(), 2, "{front_y}: {:?} {:?}", found.all(), found.open_plan());
        assert!(found.same(&id("a1"), &id("a2")) && found.same(&id("b1"), &id("b2")));
        assert!(!found.same(&id("a1"), &id("b1")) && !found.is_inside(&id("oa")));
        for (car, names) in found.all().iter().zip([["a1", "a2"], ["b1", "b2"]]) {
            assert_eq!((car.kind, car.nodes.clone()), (DoorKind::Elevator, names.map(id).to_vec()));
            let [opening] = &car.openings[..] else { panic!("{car:?}") };
            let y = opening.middle().y;
            assert!(y < front_y - 0.3 && y > 3.2 && y < 4.3, "front at {front_y}, line at {y}");
            assert!(opening.inward.y > 0.99);
            for node in car.nodes.iter().map(|node| place.graph.node(node).unwrap().at) {
                assert!(opening.depth_m(&node) > 0.3 && found.holds(car, &node), "{front_y}: {opening:?}");
            }
        }
        let (car, _) = found.way_out(&place, &[id("b2"), id("b1"), id("ob"), id("oa")]).unwrap();
        assert!(car.holds(&id("b1")));
    }
}

#[test]
fn a_car_with_a_landing_door_and_a_door_of_its_own_is_one_place() {
    let mut place = cars(5.0);
    place.doors = vec![
        door("landing", DoorKind::Elevator, [4.0, 4.05, 5.8, 4.05], &["a1", "a2"]),
        door("car", DoorKind::Elevator, [4.0, 4.35, 5.8, 4.35], &["a1", "a2"]),
    ];
    let found = Enclosures::of(&place);
    let car = found.of_node(&id("a2")).unwrap();
    assert_eq!((car.id.as_str(), car.openings.len(), found.all().len()), ("landing", 2, 2));
    assert!(car.openings.iter().all(|opening| opening.inward.y > 0.99), "{car:?}");
}

#[test]
fn a_room_with_two_doors_has_two_openings_and_a_way_uses_its_own() {
    let place = map(
        &[CORRIDOR, (1.0, 3.2, 15.0, 8.0), LEFT_GAP, RIGHT_GAP],
        &[
            ("c", "CORRIDOR", 4.0, 2.0),
            ("e", "CORRIDOR", 11.0, 2.0),
            ("d", "DOORWAY", 4.0, 3.1),
            ("r", "WARD", 4.0, 5.0),
            ("m", "SIMPLE NODE", 8.0, 5.0),
            ("s", "WARD", 11.0, 5.0),
        ],
        &[("c", "e"), ("c", "d"), ("d", "r"), ("r", "m"), ("m", "s"), ("s", "e")],
    );
    let found = Enclosures::of(&place);
    assert_eq!(found.all().len(), 1, "{:?} {:?}", found.all(), found.open_plan());
    let ward = &found.all()[0];
    assert_eq!(ward.nodes, ["r", "m", "s"].map(id));
    assert_eq!(
        ward.openings.iter().map(|opening| opening.across.clone()).collect::<Vec<_>>(),
        [Across::Node(id("d")), Across::Edge(id("s"), id("e"))]
    );
    let used = |way: &[&str]| {
        let way: Vec<NodeId> = way.iter().map(|node| id(node)).collect();
        found.way_out(&place, &way).map(|(_, opening)| opening.name())
    };
    assert_eq!(used(&["r", "d", "c"]), Some("d".into()));
    assert_eq!(used(&["r", "m", "s", "e"]), Some("s-e".into()));
    assert_eq!(used(&["c", "d", "r"]), None, "who begins in the corridor comes out of nothing");
    let doors = found.doors(&place);
    assert_eq!(doors.iter().map(|door| door.id.as_str()).collect::<Vec<_>>(), ["d", "s-e"]);
    assert!(doors.iter().all(|door| door.opens == DoorOpens::Always && door.inside == ward.nodes));
}

#[test]
fn a_room_with_a_gap_that_no_edge_leads_through_is_a_place_all_the_same() {
    let place = map(
        &[CORRIDOR, (1.0, 3.2, 15.0, 8.0), LEFT_GAP, RIGHT_GAP],
        &[("c", "CORRIDOR", 4.0, 2.0), ("d", "DOORWAY", 4.0, 3.1), ("r", "WARD", 4.0, 5.0)],
        &[("c", "d"), ("d", "r")],
    );
    only_opening(&place, "r", &Across::Node(id("d")), (4.0, 3.1), 1.0);
}

#[test]
fn an_open_plan_room_says_why_it_has_no_opening() {
    // A bay as wide as 6 m beside the corridor; the room at the end of the corridor as wide as the corridor itself.
    let place = map(
        &[CORRIDOR, (4.0, 2.9, 10.0, 6.0)],
        &[
            ("c", "CORRIDOR", 7.0, 2.0),
            ("e", "CORRIDOR", 12.5, 2.0),
            ("bay", "ROOM", 7.0, 5.0),
            ("end", "ROOM", 14.5, 2.0),
            ("far", "ROOM", 2.0, 2.0),
        ],
        &[("c", "bay"), ("c", "e"), ("e", "end")],
    );
    let found = Enclosures::of(&place);
    assert!(found.all().is_empty(), "{:?}", found.all());
    let why = |node: &str| {
        let of = |(nodes, _): &&(Vec<NodeId>, OpenPlan)| nodes.contains(&id(node));
        found.open_plan().iter().find(of).map(|(_, why)| why.clone())
    };
    assert!(
        matches!(why("bay"), Some(OpenPlan::NoWalls { .. } | OpenPlan::FloorRunsOn { .. })),
        "{:?}",
        found.open_plan()
    );
    assert_eq!(why("end"), Some(OpenPlan::NoWalls { from: id("end"), to: id("e") }));
    assert_eq!(why("far"), Some(OpenPlan::NoWayOut));
    assert_eq!(why("c"), None);
    let text = why("end").map(|why| why.to_string()).unwrap_or_default();
    assert_eq!(text, "no walls bound an opening between `end` and `e`");
    let mut place = place;
    place.graph = place.graph.edited(|nodes, _| nodes.retain(|node| node.id != id("far")));
    let warned: Vec<String> = crate::check(&place).iter().map(ToString::to_string).collect();
    assert!(warned.iter().all(|line| line.starts_with("M-TYPE")) && warned.len() == 2, "{warned:?}");
    assert!(warned.iter().any(|line| line.contains(&text)), "{warned:?}");
}

#[test]
fn the_door_between_two_rooms_belongs_to_both_and_leads_different_ways() {
    let place = map(
        &[CORRIDOR, LEFT, RIGHT, LEFT_GAP, (7.3, 5.0, 7.7, 6.0)],
        &[
            ("c", "CORRIDOR", 4.0, 2.0),
            ("d", "DOORWAY", 4.0, 3.1),
            ("r", "ROOM", 4.0, 5.5),
            ("g", "DOORWAY", 7.5, 5.5),
            ("s", "ROOM", 11.0, 5.5),
        ],
        &[("c", "d"), ("d", "r"), ("r", "g"), ("g", "s")],
    );
    let found = Enclosures::of(&place);
    assert_eq!(found.all().len(), 2, "{:?} {:?}", found.all(), found.open_plan());
    let across =
        |node: &str| found.of_node(&id(node)).unwrap().openings.iter().find(|o| o.name() == "g").cloned().unwrap();
    assert!(across("r").inward.x < -0.9 && across("s").inward.x > 0.9);
    assert_eq!(found.doors(&place).len(), 2, "{:?}", found.doors(&place));
}

#[test]
fn shipped_locations_have_the_rooms_and_cars_that_their_plans_draw() {
    for (name, places) in [
        ("hospital", &["elevator_a", "elevator_b", "ward_1", "ward_2", "p3"][..]),
        ("office", &["meeting_room_1", "meeting_room_2", "s1", "kt"]),
        ("warehouse", &["break_room"]),
    ] {
        let location = crate::shipped::load(name).unwrap();
        let found = Enclosures::of(&location);
        assert_eq!(found.open_plan(), [], "{name}");
        assert_eq!(found.all().iter().map(|place| place.id.as_str()).collect::<Vec<_>>(), places, "{name}");
        for node in location.graph.nodes() {
            use socrates_model::PlaceClass as C;
            let typed = location.door_of(&node.id).is_some()
                || matches!(location.graph.kind(&node.id), Some(C::Elevator | C::Room));
            assert_eq!(found.is_inside(&node.id), typed, "{name} {}", node.id);
        }
        for place in found.all() {
            for node in &place.nodes {
                let at = location.graph.node(node).unwrap().at;
                assert!(found.holds(place, &at), "{name} {node}");
                assert!(place.openings.iter().all(|opening| opening.depth_m(&at) > 0.25), "{name} {node}");
            }
        }
    }
}
