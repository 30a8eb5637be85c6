//! Doors where walls leave an opening: the line between two wall ends, the nodes behind it, and the elevator that it closes.

use std::collections::BTreeSet;

use serde::Serialize;
use socrates_maps::{DistanceField, Ground};
use socrates_model::{DoorKind, DoorOpens, Location, NodeId, Point, Vector};

use crate::edit::Edit;
use crate::sketch::{Door, Sketch, Spot};

/// An opening is looked for this near to the place that was pointed at, m.
const NEAR_M: f64 = 0.8;
/// Places that are tried lie so far apart, m, or half a cell where that is more.
const STEP_M: f64 = 0.05;
/// Narrowest and widest opening, m.
const WIDTH_M: (f64, f64) = (0.4, 4.0);
/// Lines that are tried at each place, in a half circle.
const TURNS: u32 = 24;
/// A point with less clearance than this is at the wall, m.
const WALL_M: f64 = 0.02;
/// The middle of a line between walls that face each other has at least so much clearance, of the line's length: half of it, less what
/// cells make of a wall. In a right corner it is 0.35.
const FACING: f64 = 0.45;
/// A node this near to the line of a door stands in the door, m.
const IN_DOOR_M: f64 = 0.15;
/// Depth of floor behind a door that is looked at, m.
const DEEP_M: f64 = 4.0;
/// How an elevator's door opens, and how long it stays open, as in the shipped hospital.
const CAR_NEAR_M: f64 = 3.0;
const CAR_HOLD_S: f64 = 15.0;
/// People wait this far before an elevator, m.
const LOBBY_M: f64 = 1.2;
/// A node that is this near to where people wait is where they wait, m.
const SAME_M: f64 = 0.8;

/// A line from wall to wall.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Opening {
    /// One end, at the wall.
    pub from: Spot,
    /// The other end.
    pub to: Spot,
    /// Its length, m.
    pub width_m: f64,
}

/// A line that was tried.
#[derive(Clone, Copy)]
struct Chord {
    from: Point,
    to: Point,
    at: Point,
    width_m: f64,
}

/// The narrowest opening at a place, in the middle of the wall's thickness; none where no walls face each other there.
#[must_use]
pub fn opening(location: &Location, near: Spot) -> Option<Opening> {
    let (grid, ground) = (&location.grid, Ground::of(&location.grid));
    let field = ground.field();
    let near = near.point(grid);
    let step_m = STEP_M.max(grid.resolution_m / 2.0);
    #[expect(clippy::cast_possible_truncation, reason = "a number of steps within a meter")]
    let steps = (NEAR_M / step_m) as i32;
    let mut found = Vec::new();
    for down in -steps..=steps {
        for right in -steps..=steps {
            let at = near + Vector::new(f64::from(right) * step_m, f64::from(down) * step_m);
            if (at - near).norm() <= NEAR_M {
                found.extend(narrowest(field, &at));
            }
        }
    }
    let least_m = found.iter().map(|chord| chord.width_m).fold(f64::INFINITY, f64::min);
    found.retain(|chord| chord.width_m <= least_m + grid.resolution_m / 2.0);
    let nearest = *found.iter().min_by(|a, b| (a.at - near).norm().total_cmp(&(b.at - near).norm()))?;
    // The walls have a thickness: of the lines beside each other the middle one.
    let along = (nearest.to - nearest.from).normalize();
    let across = Vector::new(-along.y, along.x);
    let offset =
        |chord: &Chord| across.dot(&(chord.from - nearest.from)).midpoint(across.dot(&(chord.to - nearest.from)));
    let beside = found.iter().filter(|chord| {
        let other = (chord.to - chord.from).normalize();
        along.dot(&other).abs() > 0.99 && along.dot(&(chord.at - nearest.at)).abs() < nearest.width_m
    });
    let (low, high) = beside.map(offset).fold((0.0_f64, 0.0_f64), |(low, high), off| (low.min(off), high.max(off)));
    let middle = across * low.midpoint(high);
    let half = |spot: Spot| Spot { x: libm::round(spot.x * 2.0) / 2.0, y: libm::round(spot.y * 2.0) / 2.0 };
    let ends = [nearest.from, nearest.to].map(|end| half(Spot::of(grid, &(end + middle))));
    let [mut from, mut to] = ends;
    if (from.x, from.y) > (to.x, to.y) {
        std::mem::swap(&mut from, &mut to);
    }
    let width_m = (to.point(grid) - from.point(grid)).norm();
    Some(Opening { from, to, width_m })
}

/// The shortest line from wall to wall through a point, where it is as wide as an opening.
fn narrowest(field: &DistanceField, at: &Point) -> Option<Chord> {
    if field.clearance(at) < WALL_M {
        return None;
    }
    let line = |turn: u32| {
        let (sin, cos) = libm::sincos(f64::from(turn) * std::f64::consts::PI / f64::from(TURNS));
        let along = Vector::new(cos, sin);
        let wall = |along: &Vector| field.to_wall(at, along, WALL_M, WIDTH_M.1);
        let (to, from) = wall(&along).zip(wall(&-along))?;
        Some(Chord { from, to, at: *at, width_m: (to - from).norm() })
    };
    // Of a line that only cuts a corner off, the middle is nearer to the walls than its ends are.
    let faces =
        |chord: &Chord| field.clearance(&(chord.from + (chord.to - chord.from) / 2.0)) >= FACING * chord.width_m;
    let fits = |chord: &Chord| (WIDTH_M.0..=WIDTH_M.1).contains(&chord.width_m) && faces(chord);
    let chords = (0..TURNS).filter_map(line).filter(fits);
    chords.min_by(|a, b| a.width_m.total_cmp(&b.width_m))
}

/// The nodes that lie behind a line: of the two parts into which it cuts the edges, the smaller one; none where it cuts off nothing.
#[must_use]
pub fn inside_of(sketch: &Sketch, location: &Location, from: Spot, to: Spot) -> Vec<NodeId> {
    let (a, b) = (from.point(&location.grid), to.point(&location.grid));
    let near = |at: Spot| socrates_model::geometry::nearest_on_segment(&at.point(&location.grid), &a, &b).0;
    let in_door: BTreeSet<&NodeId> =
        sketch.nodes.iter().filter(|node| near(node.at) < IN_DOOR_M).map(|node| &node.id).collect();
    let place = |id: &NodeId| sketch.node(id).map(|node| node.at.point(&location.grid));
    let mut kept = Vec::new();
    let mut cut: BTreeSet<&NodeId> = BTreeSet::new();
    for edge in &sketch.edges {
        let Some((p, q)) = place(&edge.from).zip(place(&edge.to)) else { continue };
        let ends = [&edge.from, &edge.to];
        let through = ends.iter().any(|end| in_door.contains(*end));
        if through || socrates_model::geometry::segments_cross(&p, &q, &a, &b) {
            cut.extend(ends.into_iter().filter(|end| !in_door.contains(*end)));
        } else {
            kept.push(ends);
        }
    }
    let reached = |start: &NodeId| {
        let mut seen: BTreeSet<&NodeId> = BTreeSet::new();
        let mut open: Vec<&NodeId> = sketch.node(start).map(|node| &node.id).into_iter().collect();
        while let Some(id) = open.pop() {
            if seen.insert(id) {
                let on = kept.iter().filter(|ends| ends.contains(&id));
                open.extend(on.flat_map(|ends| ends.iter().copied()).filter(|other| !seen.contains(*other)));
            }
        }
        seen
    };
    let parts: Vec<BTreeSet<&NodeId>> = cut.iter().map(|start| reached(start)).collect();
    let Some(least) = parts.iter().min_by_key(|part| part.len()) else { return Vec::new() };
    // One part alone is not cut off from anything.
    if parts.iter().all(|part| part == least) {
        return Vec::new();
    }
    sketch.nodes.iter().map(|node| &node.id).filter(|id| least.contains(id)).cloned().collect()
}

/// An elevator behind an opening, as one edit: its landing door, two nodes in the car, a node before it where there is none, and the edges
/// between them. The car is the side on which the floor ends sooner; none where the floor behind the door is too shallow for two.
#[must_use]
pub fn elevator(sketch: &Sketch, location: &Location, at: &Opening) -> Option<Edit> {
    let (grid, ground) = (&location.grid, Ground::of(&location.grid));
    let (from, to) = (at.from.point(grid), at.to.point(grid));
    let middle = from + (to - from) / 2.0;
    let along = (to - from).normalize();
    let across = Vector::new(-along.y, along.x);
    let depth = |way: Vector| {
        ground
            .field()
            .to_wall(&(middle + way * 0.3), &way, WALL_M, DEEP_M)
            .map_or(DEEP_M, |wall| (wall - middle).norm())
    };
    let (one, other) = (depth(across), depth(-across));
    let (inward, deep_m, free_m) = if one <= other { (across, one, other) } else { (-across, other, one) };
    if deep_m < 1.0 {
        return None;
    }
    let whole = |point: Point| {
        let spot = Spot::of(grid, &point);
        Spot { x: libm::round(spot.x), y: libm::round(spot.y) }
    };
    let door = sketch.free_door("elevator");
    let name = |part: &str| {
        let plain = format!("{door}_{part}");
        let taken = |name: &String| sketch.nodes.iter().any(|node| node.id.as_str() == name);
        let free = std::iter::once(plain.clone()).chain((2..).map(|number| format!("{plain}{number}")));
        free.into_iter().find(|name| !taken(name)).and_then(|name| NodeId::new(name).ok())
    };
    let (first, second) = (name("a")?, name("b")?);
    let wait = middle - inward * LOBBY_M.min(free_m / 2.0);
    let known = sketch.nodes.iter().find(|node| (node.at.point(grid) - wait).norm() < SAME_M);
    let kind = format!("IN {}", door.to_uppercase().replace('_', " "));
    let node = |id: &NodeId, kind: &str, at: Point| Edit::AddNode {
        id: Some(id.clone()),
        kind: kind.to_owned(),
        at: whole(at),
    };
    let edge = |from: &NodeId, to: &NodeId, kind: &str| Edit::AddEdge {
        from: from.clone(),
        to: to.clone(),
        kind: kind.to_owned(),
    };
    let mut edits = Vec::new();
    let lobby = match known {
        Some(node) => node.id.clone(),
        None => {
            let lobby = name("lobby")?;
            edits.push(node(&lobby, "ELEVATOR LOBBY", wait));
            lobby
        }
    };
    edits.extend([
        node(&first, &kind, middle + inward * (deep_m / 3.0)),
        node(&second, &kind, middle + inward * (deep_m * 2.0 / 3.0)),
        edge(&lobby, &first, "ELEVATOR DOORWAY"),
        edge(&first, &second, &kind),
        Edit::AddDoor(Door {
            id: door,
            kind: DoorKind::Elevator,
            from: at.from,
            to: at.to,
            opens: DoorOpens::RobotNear(CAR_NEAR_M),
            hold_s: CAR_HOLD_S,
            inside: vec![first, second],
        }),
    ]);
    Some(Edit::Several(edits))
}
