use std::collections::BTreeSet;

use super::*;
use crate::plan::Plan;
use crate::{DistanceField, Ground, Sight, check};
use socrates_model::{Cell, GraphNode, Grid, PlaceClass, Point};

/// Seeds of each kind in the gate; none was chosen for what it draws.
const FEW: u64 = 4;
/// Seeds of each kind in a sweep, and of plans, which are drawn quickly.
const MANY: u64 = 40;

/// Radius of the robot that has to get everywhere, m.
const ROBOT_M: f64 = 0.3;

/// What a world is made of, as measured on its map.
#[derive(Default)]
struct Measures {
    doors_m: Vec<f64>,
    corridors_m: Vec<f64>,
    aisles_m: Vec<f64>,
    rooms: Vec<usize>,
    nodes: Vec<usize>,
}

fn made_of(seed: u64, kind: Kind) -> (String, Location) {
    let text = plan(seed, kind);
    match location(seed, kind) {
        Ok(location) => (text, location),
        Err(faults) => {
            let told: Vec<String> = faults.iter().map(ToString::to_string).collect();
            panic!("{kind} {seed}: {told:#?}\n{text}")
        }
    }
}

/// The smaller of both distances between walls through a point, along x and along y, m.
fn width_m(sight: &Sight, at: &Point) -> f64 {
    let across = |angle: f64| sight.ray(at, angle, 60.0) + sight.ray(at, angle + std::f64::consts::PI, 60.0);
    across(0.0).min(across(std::f64::consts::FRAC_PI_2))
}

/// Whether every place where the robot fits can be reached from every other one.
fn one_floor(grid: &Grid, field: &DistanceField) -> Result<(), String> {
    let fits = |column: usize, row: usize| {
        grid.at(column, row) == Cell::Free && field.clearance(&grid.center_of(column, row)) >= ROBOT_M
    };
    let all: BTreeSet<(usize, usize)> = (0..grid.height)
        .flat_map(|row| (0..grid.width).map(move |column| (column, row)))
        .filter(|(column, row)| fits(*column, *row))
        .collect();
    let mut left = all.clone();
    let mut open: Vec<(usize, usize)> = left.pop_first().into_iter().collect();
    while let Some((column, row)) = open.pop() {
        for next in [(column + 1, row), (column.wrapping_sub(1), row), (column, row + 1), (column, row.wrapping_sub(1))]
        {
            if left.remove(&next) {
                open.push(next);
            }
        }
    }
    match left.first() {
        None => Ok(()),
        Some((column, row)) => {
            Err(format!("{} of {} places are cut off, one at {}", left.len(), all.len(), grid.center_of(*column, *row)))
        }
    }
}

/// Whether only ways along a corridor lead from a node, so that no doorway is beside it.
fn is_between_walls(location: &Location, node: &GraphNode) -> bool {
    let mut ways = location.graph.edges().iter().filter(|edge| edge.from == node.id || edge.to == node.id);
    ways.all(|edge| matches!(PlaceClass::of_type(&edge.kind), PlaceClass::Corridor | PlaceClass::NarrowPassage))
}

/// Every fact that holds for every world; adds what was measured.
fn holds(seed: u64, kind: Kind, measures: &mut Measures) {
    let (text, location) = made_of(seed, kind);
    let told = |what: String| format!("{kind} {seed}: {what}");
    assert_eq!(location.warnings, Vec::<String>::new(), "{kind} {seed}");
    assert_eq!(check(&location), [], "{kind} {seed}");
    assert_eq!(location.name, format!("{kind}-{seed}"));
    let ground = Ground::of(&location.grid);
    let (field, sight) = (DistanceField::new(&location.grid), ground.sight());
    if let Err(why) = one_floor(&location.grid, &field) {
        panic!("{}", told(why));
    }
    for node in location.graph.nodes() {
        let class = PlaceClass::of_type(&node.kind);
        assert_ne!(class, PlaceClass::Plain, "{}", told(format!("`{}` says nothing", node.kind)));
        let needed = if class == PlaceClass::Doorway { 0.4 } else { 0.45 };
        let clearance = field.clearance(&node.at);
        assert!(clearance >= needed, "{}", told(format!("{} has {clearance:.2} m", node.id)));
        let degree = location.graph.degree(&node.id);
        match class {
            PlaceClass::Doorway => measures.doors_m.push(width_m(sight, &node.at)),
            PlaceClass::Corridor | PlaceClass::NarrowPassage if degree == 2 && is_between_walls(&location, node) => {
                let narrow = node.kind.contains("AISLE") || kind == Kind::Warehouse;
                let list = if narrow { &mut measures.aisles_m } else { &mut measures.corridors_m };
                list.push(width_m(sight, &node.at));
            }
            PlaceClass::BlindCorner => assert_eq!(degree, 2, "{}", told(format!("{} is no corner", node.id))),
            PlaceClass::Intersection => assert!(degree >= 3, "{}", told(format!("{} is no junction", node.id))),
            PlaceClass::Corridor | PlaceClass::NarrowPassage => {
                assert!(degree >= 2, "{}", told(format!("{} leads nowhere", node.id)));
            }
            PlaceClass::Elevator
            | PlaceClass::ElevatorLobby
            | PlaceClass::Room
            | PlaceClass::OpenArea
            | PlaceClass::Exit
            | PlaceClass::Plain => {}
        }
    }
    for edge in location.graph.edges() {
        assert_ne!(PlaceClass::of_type(&edge.kind), PlaceClass::Plain, "{}", told(format!("`{}`", edge.kind)));
        let points = location.graph.edge_points(&edge.from, &edge.to).unwrap();
        let length = (points[1] - points[0]).norm();
        let ends = || told(format!("{} – {}: {length:.2} m", edge.from, edge.to));
        assert!(length <= 8.0, "{}", ends());
        for share in 0..=20 {
            let at = points[0] + (points[1] - points[0]) * (f64::from(share) / 20.0);
            assert!(field.clearance(&at) >= 0.38, "{} has {:.2} m at {at}", ends(), field.clearance(&at));
        }
    }
    assert!(
        location
            .graph
            .nodes()
            .iter()
            .any(|node| node.kind == "EXIT" || node.kind == "LOADING DOCK" || node.kind == "STAIRS"),
        "{}",
        told("no exit".into())
    );
    measures.rooms.push(rooms(&location));
    measures.nodes.push(location.graph.nodes().len());
    corners(&text, &location, &told);
    doors(&location, &told);
}

/// Rooms and open areas behind doorways and wide openings: parts of the ids of their nodes.
fn rooms(location: &Location) -> usize {
    let stem =
        |id: &str| id.strip_prefix('r').map(|rest| rest.trim_end_matches(|c: char| c.is_ascii_lowercase()).to_owned());
    location.graph.nodes().iter().filter_map(|node| stem(node.id.as_str())).collect::<BTreeSet<String>>().len()
}

/// Whoever stands before a doorway has wall for 0.3 m on both sides, on both sides of the wall.
fn corners(text: &str, location: &Location, told: &dyn Fn(String) -> String) {
    let plan = Plan::read(text).unwrap();
    for opening in &plan.openings {
        let [x0, y0, x1, y1] = *opening.get_ref();
        let middle = Point::new((x0 + x1) / 2.0, (y0 + y1) / 2.0);
        let doorway = location
            .graph
            .nodes()
            .iter()
            .any(|node| PlaceClass::of_type(&node.kind) == PlaceClass::Doorway && (node.at - middle).norm() < 0.15);
        if !doorway {
            continue;
        }
        let along = Point::new(x1, y1) - Point::new(x0, y0);
        let (unit, half) = (along.normalize(), along.norm() / 2.0);
        for aside in [-0.15, 0.15] {
            let before = middle + nalgebra_turn(unit) * aside;
            for side in [-1.0, 1.0] {
                let beside = before + unit * (side * (half + 0.29));
                let same_floor = plan.floors.iter().any(|floor| {
                    let [left, bottom, right, top] = *floor.get_ref();
                    [before, beside].iter().all(|p| p.x > left && p.x < right && p.y > bottom && p.y < top)
                });
                assert!(same_floor, "{}", told(format!("the doorway at {middle} is in a corner")));
            }
        }
    }
}

fn nalgebra_turn(v: socrates_model::Vector) -> socrates_model::Vector {
    socrates_model::Vector::new(-v.y, v.x)
}

/// What is behind a door is reached through it, and through nothing else.
fn doors(location: &Location, told: &dyn Fn(String) -> String) {
    for door in &location.doors {
        let mut closed = location.grid.clone();
        let along = door.to - door.from;
        for share in 0..=60 {
            let at = door.from + along * (f64::from(share) / 60.0);
            for aside in [-0.05, 0.05] {
                let cell = closed.cell_of(&(at + nalgebra_turn(along.normalize()) * aside)).unwrap();
                closed.cells[cell.1 * closed.width + cell.0] = Cell::Occupied;
            }
        }
        assert!(!door.inside.is_empty(), "{}", told(format!("nothing is behind {}", door.id)));
        let start = location.graph.node(&door.inside[0]).unwrap().at;
        let mut seen: BTreeSet<(usize, usize)> = closed.cell_of(&start).into_iter().collect();
        let mut open: Vec<(usize, usize)> = seen.iter().copied().collect();
        while let Some((column, row)) = open.pop() {
            for next in [(column + 1, row), (column - 1, row), (column, row + 1), (column, row - 1)] {
                if closed.at(next.0, next.1) == Cell::Free && seen.insert(next) {
                    open.push(next);
                }
            }
        }
        for node in location.graph.nodes() {
            let inside = closed.cell_of(&node.at).is_some_and(|cell| seen.contains(&cell));
            let on_line = (node.at - door.middle()).norm() < 0.2;
            assert!(
                on_line || inside == door.inside.contains(&node.id),
                "{}",
                told(format!("{} and {}", door.id, node.id))
            );
        }
    }
}

fn spread(values: &[f64]) -> String {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let at = |share: usize| sorted.get((sorted.len().max(1) - 1) * share / 4).copied().unwrap_or(f64::NAN);
    format!("{} values: {:.2} {:.2} {:.2} {:.2} {:.2}", sorted.len(), at(0), at(1), at(2), at(3), at(4))
}

/// All facts over all seeds of a kind, the ranges of its widths, and that no two of its worlds are the same.
#[expect(clippy::print_stdout, reason = "figures are for whoever runs the test")]
fn every_world(kind: Kind, seeds: u64) {
    let mut measures = Measures::default();
    for seed in 0..seeds {
        holds(seed, kind, &mut measures);
    }
    let floats =
        |counts: &[usize]| -> Vec<f64> { counts.iter().map(|n| f64::from(u32::try_from(*n).unwrap())).collect() };
    println!("{kind}: least, quartiles and most");
    println!("  doorways, m    {}", spread(&measures.doors_m));
    println!("  corridors, m   {}", spread(&measures.corridors_m));
    println!("  aisles, m      {}", spread(&measures.aisles_m));
    println!("  rooms          {}", spread(&floats(&measures.rooms)));
    println!("  nodes          {}", spread(&floats(&measures.nodes)));
    let within = |values: &[f64], least: f64, most: f64, what: &str| {
        let out: Vec<&f64> = values.iter().filter(|v| **v < least - 1e-6 || **v > most + 1e-6).collect();
        assert!(out.is_empty(), "{kind}: {what} of {out:?} m");
    };
    within(&measures.doors_m, 1.0, 1.4, "doorways");
    let narrowest = if kind == Kind::Hospital { 2.44 } else { 1.2 };
    within(&measures.corridors_m, narrowest, 3.0, "corridors");
    within(&measures.aisles_m, 1.0, 3.7, "aisles");
}

#[test]
fn every_office_is_sound() {
    every_world(Kind::Office, FEW);
}

#[test]
fn every_hospital_is_sound_and_has_elevators() {
    every_world(Kind::Hospital, FEW);
    for seed in 0..FEW {
        let (_, hospital) = made_of(seed, Kind::Hospital);
        let cars: Vec<_> = hospital.doors.iter().filter(|door| door.id.starts_with("elevator_")).collect();
        assert!(!cars.is_empty(), "hospital {seed}");
        assert!(cars.iter().all(|door| door.inside.len() >= 2), "hospital {seed}");
    }
}

#[test]
fn every_warehouse_is_sound() {
    every_world(Kind::Warehouse, FEW);
}

#[test]
fn every_hall_is_sound() {
    every_world(Kind::Hall, FEW);
}

#[test]
fn every_home_is_sound() {
    every_world(Kind::Home, FEW);
}

#[test]
#[ignore = "sweep: 40 worlds of every kind"]
fn every_world_of_every_kind_is_sound() {
    for kind in Kind::ALL {
        every_world(kind, MANY);
    }
}

#[test]
fn the_same_seed_gives_the_same_files_and_no_two_seeds_the_same_plan() {
    let mut seen = BTreeSet::new();
    for kind in Kind::ALL {
        for seed in 0..MANY {
            let text = plan(seed, kind);
            assert_eq!(text, plan(seed, kind));
            // The first line holds the seed.
            let drawn = text.split_once('\n').map(|(_, rest)| rest.to_owned()).unwrap();
            assert!(seen.insert(drawn), "{kind} {seed} was there before");
        }
        let files = files(7, kind).unwrap();
        assert_eq!(files, super::files(7, kind).unwrap());
        assert_eq!(files["plan.toml"], plan(7, kind).into_bytes());
        let read = crate::parse(&files, "kind-7").unwrap();
        let in_memory = location(7, kind).unwrap();
        assert_eq!((read.grid, read.graph, read.doors), (in_memory.grid, in_memory.graph, in_memory.doors));
    }
}

#[test]
#[expect(clippy::print_stdout, reason = "figures are for whoever runs the test")]
fn types_of_rooms_are_read_as_rooms_and_areas_and_needed_ones_are_there() {
    for (kind, templates) in [
        (Kind::Office, rooms::OFFICE),
        (Kind::Hospital, rooms::HOSPITAL),
        (Kind::Warehouse, rooms::WAREHOUSE),
        (Kind::Hall, rooms::HALL),
        (Kind::Home, rooms::HOME),
    ] {
        let count = MANY;
        for template in templates {
            let class = PlaceClass::of_type(&template.kind);
            let wanted = if template.kind.ends_with("AREA") { PlaceClass::OpenArea } else { PlaceClass::Room };
            assert_eq!(class, wanted, "{}", template.kind);
            let there = |seed: &u64| plan(*seed, kind).contains(&format!("\"{}\"", template.kind));
            let lacking = (0..count).filter(|seed| !there(seed)).count() as u64;
            println!("{kind}: {lacking} of {count} lack a {}", template.kind);
            if template.needed {
                assert!(lacking * 20 <= count, "{kind}: {lacking} of {count} lack a {}", template.kind);
            }
        }
    }
}

#[test]
fn a_kind_is_read_by_its_name_and_others_are_refused_with_the_list() {
    for kind in Kind::ALL {
        assert_eq!(kind.name().parse::<Kind>().unwrap(), kind);
    }
    let fault = "castle".parse::<Kind>().unwrap_err();
    assert_eq!(fault.code, FaultCode::MValue);
    let text = fault.to_string();
    assert!(text.contains("`castle`") && text.contains("office, hospital, warehouse, hall, home"), "{text}");
}
