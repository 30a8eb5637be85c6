//! Drawing on the shipped maps: the same files as the shipped ones, undone and done again, checked, and helped by geometry.
#![cfg(test)]

use std::collections::BTreeSet;

use socrates_edit::{
    Door, Edit, EditError, History, Level, NoWay, Proposal, Sketch, Spot, Step, Subject, check, elevator, inside_of,
    levels, line, opening, seen, tile, way,
};
use socrates_maps::{EXTRA, GRAPH, shipped};
use socrates_model::{Cell, DoorKind, DoorOpens, Grid, Location, NodeId, Pose};

fn id(text: &str) -> NodeId {
    NodeId::new(text).unwrap()
}

fn spot(x: f64, y: f64) -> Spot {
    Spot { x, y }
}

/// The office as it is shipped, and its map without anything drawn.
fn office() -> (Sketch, Location) {
    let location = shipped::load("office").unwrap();
    (Sketch::of(&location), location)
}

/// The edits that draw a sketch.
fn strokes(sketch: &Sketch) -> Vec<Edit> {
    let node =
        |node: &socrates_edit::Node| Edit::AddNode { id: Some(node.id.clone()), kind: node.kind.clone(), at: node.at };
    let edge = |edge: &socrates_edit::Edge| Edit::AddEdge {
        from: edge.from.clone(),
        to: edge.to.clone(),
        kind: edge.kind.clone(),
    };
    let doors = sketch.doors.iter().cloned().map(Edit::AddDoor);
    let text = Edit::Describe { text: sketch.description.clone() };
    sketch.nodes.iter().map(node).chain(sketch.edges.iter().map(edge)).chain(doors).chain([text]).collect()
}

/// The node that stands at a place of the list.
fn nth(sketch: &Sketch, place: usize) -> NodeId {
    sketch.nodes[place % sketch.nodes.len()].id.clone()
}

#[test]
fn every_shipped_location_drawn_from_empty_is_the_shipped_file_byte_for_byte() {
    for name in shipped::names() {
        let (files, location) = (shipped::files(name).unwrap(), shipped::load(name).unwrap());
        let mut history = History::new(Sketch::default());
        for edit in strokes(&Sketch::of(&location)) {
            history.act(edit).unwrap();
        }
        let written = history.sketch().files(&location.grid);
        assert_eq!(written.each_ref().map(|(file, _)| *file), [GRAPH, EXTRA]);
        for (file, text) in written {
            assert_eq!(text.as_bytes(), files[file], "{name}/{file}");
        }
    }
}

#[test]
fn whatever_is_done_can_be_undone_to_the_beginning_and_done_again() {
    let (base, _) = office();
    let mut history = History::new(base.clone());
    let mut steps = Vec::new();
    let mut seen = vec![base.clone()];
    for round in 0..150_usize {
        let sketch = history.sketch().clone();
        let (a, b) = (nth(&sketch, round * 7), nth(&sketch, round * 11 + 3));
        let edit = match round % 7 {
            0 => Edit::AddNode { id: None, kind: "ROOM".into(), at: spot(round as f64, 9.5) },
            1 => Edit::MoveNodes { nodes: vec![(a, spot(5.0, round as f64)), (b, spot(1.0, 2.0))] },
            2 => Edit::RenameNode { id: a, to: id(&format!("renamed{round}")) },
            3 => Edit::Retype { nodes: vec![a], edges: vec![], kind: format!("KIND {round}") },
            4 => {
                let edge = &sketch.edges[round % sketch.edges.len()];
                let pair = (edge.to.clone(), edge.from.clone());
                Edit::SplitEdge { edge: pair, id: None, kind: "CORRIDOR".into(), at: spot(3.0, 4.0) }
            }
            5 => Edit::Delete { nodes: vec![a], edges: vec![], doors: vec![], join: true },
            _ => Edit::Several(vec![
                Edit::AddNode { id: Some(id(&format!("s{round}"))), kind: String::new(), at: spot(0.0, 0.0) },
                Edit::Describe { text: format!("round {round}") },
            ]),
        };
        steps.push(Step::Edit(history.act(edit).unwrap()));
        seen.push(history.sketch().clone());
    }
    for (undone, sketch) in seen.iter().rev().enumerate().skip(1) {
        assert!(history.undo());
        assert_eq!((history.sketch(), history.redoable()), (sketch, undone));
    }
    assert!(!history.undo());
    for sketch in seen.iter().skip(1) {
        assert!(history.redo());
        assert_eq!(history.sketch(), sketch);
    }
    assert!(!history.redo());
    // A journal of it, read back from text, comes to the same.
    steps.extend([Step::Undo, Step::Undo, Step::Redo, Step::Undo]);
    let mut again = History::new(base);
    for step in &steps {
        let text = serde_json::to_string(step).unwrap();
        assert!(again.take(serde_json::from_str(&text).unwrap()).unwrap(), "{text}");
    }
    assert_eq!((again.sketch(), again.undoable()), (&seen[148], 148));
    // What is done after an undo takes the place of what was undone.
    again.act(Edit::Describe { text: "other".into() }).unwrap();
    assert_eq!((again.redoable(), again.undoable()), (0, 149));
}

#[test]
fn what_cannot_be_done_is_refused_with_its_name_and_changes_nothing() {
    let (base, _) = office();
    let mut sketch = base.clone();
    let far = Edit::AddNode { id: None, kind: "ROOM".into(), at: spot(2e6, 0.0) };
    let door = base.doors[0].clone();
    for (edit, wanted) in [
        (far, EditError::Far { x: 2e6, y: 0.0 }),
        (
            Edit::AddNode { id: Some(id("h0")), kind: "ROOM".into(), at: spot(1.0, 1.0) },
            EditError::NodeTaken { id: id("h0") },
        ),
        (Edit::MoveNodes { nodes: vec![(id("zz"), spot(1.0, 1.0))] }, EditError::NoNode { id: id("zz") }),
        (Edit::MoveNodes { nodes: vec![] }, EditError::Nothing),
        (Edit::RenameNode { id: id("h0"), to: id("h1") }, EditError::NodeTaken { id: id("h1") }),
        (Edit::AddEdge { from: id("h0"), to: id("h0"), kind: "X".into() }, EditError::Loop { id: id("h0") }),
        (
            Edit::AddEdge { from: id("h1"), to: id("h0"), kind: "X".into() },
            EditError::EdgeTaken { from: id("h1"), to: id("h0") },
        ),
        (
            Edit::Delete { nodes: vec![], edges: vec![(id("h0"), id("h2"))], doors: vec![], join: false },
            EditError::NoEdge { from: id("h0"), to: id("h2") },
        ),
        (Edit::AddDoor(door.clone()), EditError::DoorTaken { id: door.id.clone() }),
        (
            Edit::ChangeDoor { id: "none".into(), door: Door { id: "new".into(), ..door.clone() } },
            EditError::NoDoor { id: "none".into() },
        ),
        (Edit::AddDoor(Door { id: "new".into(), inside: vec![id("zz")], ..door }), EditError::NoNode { id: id("zz") }),
        (
            Edit::Retype { nodes: vec![id("h0")], edges: vec![], kind: "A\nB".into() },
            EditError::Word { what: "type", found: 3, most: 100 },
        ),
        (Edit::Call { nodes: vec![id("zz")], name: "lab".into() }, EditError::NoNode { id: id("zz") }),
        (Edit::Call { nodes: vec![id("h0")], name: " lab".into() }, EditError::NoName { name: " lab".into() }),
    ] {
        // One wrong edit of several undoes the others.
        let several = Edit::Several(vec![Edit::Describe { text: "changed".into() }, edit.clone()]);
        assert_eq!(sketch.apply(edit).unwrap_err(), wanted);
        assert_eq!(sketch.apply(several).unwrap_err(), wanted);
        assert_eq!(sketch, base);
    }
}

#[test]
fn a_node_that_is_deleted_joins_its_neighbors_where_that_is_wished() {
    let (mut sketch, _) = office();
    sketch.apply(Edit::Delete { nodes: vec![id("h2")], edges: vec![], doors: vec![], join: true }).unwrap();
    assert_eq!(sketch.edge(&id("h1"), &id("ia")).unwrap().kind, "CORRIDOR");
    sketch.apply(Edit::Delete { nodes: vec![id("m1a")], edges: vec![], doors: vec![], join: false }).unwrap();
    assert!(sketch.edges.iter().all(|edge| edge.from != id("m1a") && edge.to != id("m1a")));
    assert_eq!(sketch.doors[0].inside, [id("m1b"), id("m1c")], "a door forgets it too");
}

#[test]
fn findings_name_the_thing_and_the_place_and_are_those_of_reading_the_folder() {
    let (base, mut location) = office();
    assert_eq!(check(&base, &mut location), [], "the shipped office has nothing to be told");
    let subjects = |sketch: &Sketch, location: &mut Location| -> Vec<(Level, Option<&'static str>, Subject)> {
        check(sketch, location).into_iter().map(|remark| (remark.level, remark.code, remark.subject)).collect()
    };
    let wall = spot(1.0, 1.0);
    let mut bad = base.clone();
    bad.apply(Edit::MoveNodes { nodes: vec![(id("h0"), wall)] }).unwrap();
    let told = check(&bad, &mut location);
    assert_eq!((told[0].code, &told[0].subject, told[0].at), (Some("M-WALL"), &Subject::Node(id("h0")), Some(wall)));
    let mut parted = base.clone();
    parted
        .apply(Edit::Delete {
            nodes: vec![],
            edges: vec![(id("e2"), id("e1")), (id("nb"), id("e1"))],
            doors: vec![],
            join: false,
        })
        .unwrap();
    assert!(subjects(&parted, &mut location).iter().any(|(level, code, subject)| {
        (*level, *code) == (Level::Refused, Some("M-PARTS")) && matches!(subject, Subject::Node(_))
    }));
    let mut odd = base.clone();
    odd.doors[0].inside.clear();
    odd.doors[1].from = odd.doors[1].to;
    let told = subjects(&odd, &mut location);
    assert!(told.contains(&(Level::Refused, Some("M-VALUE"), Subject::Door("meeting_room_2".into()))), "{told:?}");
    assert!(told.contains(&(Level::Advised, None, Subject::Door("meeting_room_1".into()))), "{told:?}");
    let mut crowded = base.clone();
    crowded.apply(Edit::AddNode { id: Some(id("twin")), kind: "CORRIDOR".into(), at: spot(15.0, 128.0) }).unwrap();
    let told = check(&crowded, &mut location);
    assert!(
        told.iter().any(|remark| remark.level == Level::Advised && remark.text.contains("0.10 m apart")),
        "{told:?}"
    );
    // All that refuses a folder is told by the reader of the folder, and the other way round.
    for sketch in [&bad, &parted, &odd] {
        let mut files = shipped::files("office").unwrap();
        for (file, text) in sketch.files(&location.grid) {
            files.insert(file.to_owned(), text.into_bytes());
        }
        let read: Vec<&str> =
            socrates_maps::parse(&files, "office").unwrap_err().iter().map(|fault| fault.code.code()).collect();
        let told = check(sketch, &mut location);
        let mut ours: Vec<&str> =
            told.iter().filter(|remark| remark.level == Level::Refused).filter_map(|remark| remark.code).collect();
        ours.sort_unstable();
        let mut read = read;
        read.sort_unstable();
        assert_eq!(ours, read);
    }
    assert_eq!(check(&Sketch::default(), &mut location)[0].subject, Subject::Whole);
}

#[test]
fn an_opening_is_found_where_the_shipped_doors_are_with_the_nodes_behind_it() {
    for name in shipped::names() {
        let location = shipped::load(name).unwrap();
        let sketch = Sketch::of(&location);
        let mut off = Vec::new();
        for door in &sketch.doors {
            let middle = spot(f64::midpoint(door.from.x, door.to.x), f64::midpoint(door.from.y, door.to.y));
            let near = spot(middle.x + 1.5, middle.y - 1.0);
            let line = opening(&location, near).unwrap();
            let apart = |a: Spot, b: Spot| (a.x - b.x).abs().max((a.y - b.y).abs());
            let fits = apart(line.from, door.from).max(apart(line.to, door.to)) <= 0.5
                || apart(line.from, door.to).max(apart(line.to, door.from)) <= 0.5;
            if !fits {
                off.push((door.id.clone(), line));
            }
            let behind: BTreeSet<NodeId> = inside_of(&sketch, &location, door.from, door.to).into_iter().collect();
            assert_eq!(behind, door.inside.iter().cloned().collect(), "{name}: {}", door.id);
        }
        assert!(off.is_empty(), "{name}: doors whose line is not found to half a pixel: {off:?}");
    }
    let (_, location) = office();
    assert_eq!(opening(&location, spot(1.0, 1.0)), None, "in a wall there is none");
}

#[test]
fn an_elevator_is_one_edit_that_the_checks_have_nothing_against() {
    let mut location = shipped::load("hospital").unwrap();
    let mut sketch = Sketch::of(&location);
    let cars: Vec<NodeId> = ["ea1", "ea2", "ea3"].map(id).to_vec();
    sketch.apply(Edit::Delete { nodes: cars, edges: vec![], doors: vec!["elevator_a".into()], join: false }).unwrap();
    let line = opening(&location, spot(274.0, 232.0)).unwrap();
    let edit = elevator(&sketch, &location, &line).unwrap();
    let Edit::Several(edits) = &edit else { panic!("{edit:?}") };
    assert!(
        edits.iter().all(|edit| !matches!(edit, Edit::AddNode { kind, .. } if kind == "ELEVATOR LOBBY")),
        "la is the lobby"
    );
    sketch.apply(edit).unwrap();
    assert_eq!(check(&sketch, &mut location), []);
    let door = sketch.door("elevator_1").unwrap();
    assert_eq!((door.kind, door.inside.len(), &door.opens), (DoorKind::Elevator, 2, &DoorOpens::RobotNear(3.0)));
    assert!(location.door("elevator_1").is_some_and(|door| !door.inside.is_empty()));
}

#[test]
fn the_programs_own_annotation_is_taken_over_whole_and_in_parts() {
    let (_, mut location) = office();
    let proposal = Proposal::of(&location.grid).unwrap();
    let mut all = Sketch::default();
    all.apply(proposal.taken_over(&all, &location.grid, None).unwrap()).unwrap();
    assert_eq!(all, proposal.sketch);
    assert!(check(&all, &mut location).iter().all(|remark| remark.level != Level::Refused));
    assert_eq!(proposal.taken_over(&all, &location.grid, None), None, "nothing of it is new");
    // Beside what is drawn: the places that are there stay, names that are taken are replaced.
    let (base, _) = office();
    let mut some = base.clone();
    let chosen: BTreeSet<NodeId> = proposal.sketch.nodes.iter().take(5).map(|node| node.id.clone()).collect();
    if let Some(edit) = proposal.taken_over(&some, &location.grid, Some(&chosen)) {
        some.apply(edit).unwrap();
    }
    assert!(some.nodes.len() <= base.nodes.len() + 5);
    assert_eq!(some.nodes[..base.nodes.len()], base.nodes);
}

#[test]
fn a_way_is_that_of_the_graph_else_one_over_free_floor() {
    let (sketch, mut location) = office();
    check(&sketch, &mut location);
    let found = way(&location, &id("h0"), &id("h8")).unwrap();
    assert_eq!((found.nodes.len(), found.nodes[0].clone()), (11, id("h0")));
    assert!((found.length_m - 33.9).abs() < 1e-6 && found.least_m > 0.3, "{found:?}");
    let mut parted = sketch;
    parted.edges.clear();
    check(&parted, &mut location);
    let free = way(&location, &id("h0"), &id("h8")).unwrap();
    assert!(free.nodes.is_empty() && free.length_m > 33.0, "{free:?}");
    assert_eq!(way(&location, &id("h0"), &id("zz")), Err(NoWay::NoNode { id: id("zz") }));
    let across = line(&location, spot(14.0, 128.0), spot(48.0, 20.0));
    assert!(!across.clear && across.least_m == 0.0);
    let along = line(&location, spot(14.0, 128.0), spot(48.0, 128.0));
    assert!(along.clear && (along.length_m - 3.4).abs() < 1e-9 && along.least_m > 0.5, "{along:?}");
}

#[test]
fn a_map_of_20_000_pixels_comes_in_tiles_in_which_a_thin_wall_is_not_lost() {
    let (width, height) = (20_000, 1_500);
    let mut cells = vec![Cell::Free; width * height];
    (0..height).for_each(|row| cells[row * width + 12_345] = Cell::Occupied);
    let grid = Grid { width, height, resolution_m: 0.05, origin: Pose::new(0.0, 0.0, 0.0), cells };
    assert_eq!((levels(&grid), seen(&grid)), (7, [0, 0, width, height]));
    let mut little = Grid { width: 4, height: 3, cells: vec![Cell::Unknown; 12], ..grid.clone() };
    assert_eq!(seen(&little), [0, 0, 4, 3]);
    little.cells[5] = Cell::Free;
    assert_eq!(seen(&little), [1, 1, 2, 2]);
    let whole = tile(&grid, 6, 0, 0).unwrap();
    let decoded = |bytes: &[u8]| {
        let side = |at: usize| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap());
        (side(16), side(20))
    };
    assert_eq!(decoded(&whole), (313, 24));
    let blank = tile(&Grid { cells: vec![Cell::Free; width * height], ..grid.clone() }, 6, 0, 0).unwrap();
    assert_ne!(whole, blank, "the wall of one cell is seen in the smallest picture");
    assert_eq!(decoded(&tile(&grid, 0, 39, 2).unwrap()), (32, 476));
    assert_eq!((tile(&grid, 7, 0, 0), tile(&grid, 0, 40, 0), tile(&grid, 0, 0, usize::MAX)), (None, None, None));
}

#[test]
fn a_node_is_called_by_one_name_and_an_area_without_nodes_has_none() {
    let (mut sketch, location) = office();
    let before = sketch.names.clone();
    let called = |sketch: &Sketch| -> Vec<(String, usize)> {
        sketch.names[before.len()..].iter().map(|area| (area.name.clone(), area.nodes.len())).collect()
    };
    let mut call = |nodes: &[&str], name: &str| {
        let nodes = nodes.iter().map(|node| id(node)).collect();
        sketch.apply(Edit::Call { nodes, name: name.to_owned() }).unwrap();
        called(&sketch)
    };
    assert_eq!(call(&["h0", "h1"], "west end"), [("west end".to_owned(), 2)]);
    assert_eq!(call(&["h2"], "West End"), [("west end".to_owned(), 3)], "capitals make no other name");
    assert_eq!(call(&["h1"], "crossing"), [("west end".to_owned(), 2), ("crossing".to_owned(), 1)]);
    assert_eq!(call(&["h1"], ""), [("west end".to_owned(), 2)]);
    // What is written is read again.
    let files = shipped::files("office").unwrap();
    let mut files: std::collections::BTreeMap<String, Vec<u8>> =
        files.iter().map(|(name, bytes)| ((*name).to_owned(), bytes.to_vec())).collect();
    for (name, text) in sketch.files(&location.grid) {
        files.insert(name.to_owned(), text.into_bytes());
    }
    assert_eq!(socrates_maps::parse(&files, "office").unwrap().names, sketch.names);
}
