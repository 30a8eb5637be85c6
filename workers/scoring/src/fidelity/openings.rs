//! Openings of rooms without a door: the line that somebody crosses who comes out, goes in, or stays inside.

use socrates_maps::DistanceField;
use socrates_model::{Door, DoorKind, DoorOpens, Location, NodeId, PlaceClass, Point, SceneGraph, Vector};

/// An opening is looked for this near to the doorway node of a way, m.
const NEAR_M: f64 = 1.2;
/// Distance between the places along the way that are tried, and between points across it, m.
const STEP_M: f64 = 0.05;
/// A wall farther from the way than this bounds no opening, m.
const REACH_M: f64 = 2.5;
/// A point with less clearance than this is at the wall, m.
const WALL_M: f64 = 0.02;
/// Places that differ in width by less than this are equally narrow, m: what a cell of a map makes of it.
const EQUAL_M: f64 = 0.1;
/// Distance of an opening from the nodes on both of its sides, m, or half of the way between them where that is shorter:
/// somebody who stands at the inside node is inside.
const CLEAR_M: f64 = 0.5;

/// Whether somebody at a node of this kind is inside of something.
const fn is_inside(class: PlaceClass) -> bool {
    match class {
        PlaceClass::Room | PlaceClass::Elevator | PlaceClass::OpenArea | PlaceClass::Plain => true,
        PlaceClass::Corridor
        | PlaceClass::NarrowPassage
        | PlaceClass::Intersection
        | PlaceClass::BlindCorner
        | PlaceClass::Doorway
        | PlaceClass::ElevatorLobby
        | PlaceClass::Exit => false,
    }
}

/// The opening through which a way leads out of the room that it begins in, as a door that always stands open: across
/// the way at its first doorway node; where it has none, at the narrowest place between the room and what comes next, of
/// equally narrow ones the outermost. `None` where the way begins in no room, or no walls bound the opening.
#[must_use]
pub(super) fn opening(place: &Location, field: &DistanceField, way: &[NodeId]) -> Option<Door> {
    let class = |id: &NodeId| place.graph.kind(id);
    let first = way.first()?;
    if !class(first).is_some_and(is_inside) {
        return None;
    }
    let doorway = way.iter().position(|id| class(id) == Some(PlaceClass::Doorway));
    let outside = way.iter().position(|id| class(id).is_some_and(|class| !is_inside(class)))?;
    // A doorway farther on belongs to another room.
    let (door, nodes): (Option<&NodeId>, &[NodeId]) = match doorway.filter(|at| *at == outside) {
        Some(at) => (way.get(at), way.get(at.checked_sub(1)?..way.len().min(at + 2))?),
        // Plain nodes say nothing of a room without a doorway.
        None if class(first) == Some(PlaceClass::Plain) => return None,
        None => (None, way.get(outside.checked_sub(1)?..=outside)?),
    };
    let line = place.graph.polyline(nodes);
    let (from, to) = match door.and_then(|id| place.graph.node(id)) {
        Some(node) => narrowest(field, &line, node.at, NEAR_M)?,
        None => between(field, &line)?,
    };
    let id = door.or_else(|| nodes.first()).map(ToString::to_string)?;
    let kind = if class(first) == Some(PlaceClass::Elevator) { DoorKind::Elevator } else { DoorKind::Room };
    let inside = nodes.first().cloned().into_iter().collect();
    Some(Door { id, kind, from, to, opens: DoorOpens::Always, hold_s: 0.0, inside })
}

/// The way out of the room of a node: to the nearest node that is not inside of anything and, where that is a doorway, one
/// node on.
#[must_use]
pub(super) fn way_out(graph: &SceneGraph, from: &NodeId) -> Option<Vec<NodeId>> {
    let outside = graph.nodes().iter().enumerate().filter(|(at, _)| !is_inside(graph.kind_at(*at)));
    let mut way = outside
        .filter_map(|(_, node)| graph.shortest(from, &node.id))
        .min_by(|a, b| graph.length_m(a).total_cmp(&graph.length_m(b)))?;
    let last = way.last()?;
    let on = graph.neighbors(last).iter().find(|next| !way.contains(next));
    let on = on.filter(|_| graph.kind(last) == Some(PlaceClass::Doorway)).cloned();
    way.extend(on);
    Some(way)
}

/// Ends of the shortest line across a way from an inside node to an outside node: the narrowest place, of equally narrow ones
/// the outermost, and at some distance from both nodes. A node may be drawn in the very opening of its room, or a corridor
/// go on as wide as the car: then the line is moved along the way.
fn between(field: &DistanceField, way: &[Point]) -> Option<(Point, Point)> {
    let length_m: f64 = way.windows(2).map(|pair| if let [a, b] = pair { (b - a).norm() } else { 0.0 }).sum();
    let clear_m = CLEAR_M.min(length_m / 2.0);
    let outermost = along(way, length_m - clear_m)?;
    let (left, right) = narrowest(field, way, outermost, f64::INFINITY)?;
    let first = way.first()?;
    let middle = left + (right - left) / 2.0;
    let inside = (middle - first).norm();
    let moved = if inside < clear_m { along(way, clear_m)? - along(way, inside)? } else { Vector::zeros() };
    Some((left + moved, right + moved))
}

/// The point so far along a way.
fn along(way: &[Point], mut length_m: f64) -> Option<Point> {
    for pair in way.windows(2) {
        let [a, b] = pair else { continue };
        let piece = (b - a).norm();
        if piece >= length_m && piece > 0.0 {
            return Some(a + (b - a) * (length_m / piece));
        }
        length_m -= piece;
    }
    way.last().copied()
}

/// Ends of the shortest line across a way from wall to wall, of places within a distance of a point; of equally narrow ones
/// the nearest to it.
fn narrowest(field: &DistanceField, way: &[Point], near: Point, within_m: f64) -> Option<(Point, Point)> {
    let mut places: Vec<(f64, f64, (Point, Point))> = Vec::new();
    for pair in way.windows(2) {
        let [a, b] = pair else { continue };
        let length = (b - a).norm();
        if length <= 0.0 {
            continue;
        }
        let ahead = (b - a) / length;
        let across = Vector::new(-ahead.y, ahead.x);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a way has few steps")]
        let steps = (length / STEP_M).floor() as u32;
        for step in 0..=steps {
            let at = a + ahead * (f64::from(step) * STEP_M);
            let off = (at - near).norm();
            if off > within_m {
                continue;
            }
            let Some((left, right)) = to_wall(field, &at, &across).zip(to_wall(field, &at, &-across)) else { continue };
            places.push(((left - right).norm(), off, (left, right)));
        }
    }
    let least = places.iter().map(|(width, ..)| *width).min_by(f64::total_cmp)?;
    let narrow = places.into_iter().filter(|(width, ..)| *width < least + EQUAL_M);
    narrow.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(_, _, line)| line)
}

/// The wall that a line from a point meets, if it does so within reach.
fn to_wall(field: &DistanceField, from: &Point, along: &Vector) -> Option<Point> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small positive number")]
    let steps = (REACH_M / STEP_M) as u32;
    (0..=steps).map(|step| from + along * (f64::from(step) * STEP_M)).find(|at| field.clearance(at) < WALL_M)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{floor, node};

    /// A room behind the wall x = 4 with an opening 1.2 m wide at y = 0, and a corridor before it.
    fn room(kinds: [&str; 3]) -> Location {
        let [room, door, corridor] = kinds;
        floor(
            &[(4., 0.6, 4.2, 4.), (4., -4., 4.2, -0.6), (4., 4., 9., 4.2), (4., -4.2, 9., -4.), (9., -4., 9.2, 4.)],
            &[("r", room, 7., 0.), ("d", door, 4.1, 0.), ("c", corridor, 1., 0.)],
            &[("r", "d"), ("d", "c")],
        )
    }

    fn found(place: &Location, way: &[&str]) -> Option<Door> {
        let way: Vec<NodeId> = way.iter().map(|id| node(id)).collect();
        opening(place, &DistanceField::new(&place.grid), &way)
    }

    #[test]
    fn an_opening_lies_across_the_way_at_its_doorway_node() {
        let place = room(["KITCHEN", "DOORWAY", "CORRIDOR"]);
        let door = found(&place, &["r", "d", "c"]).unwrap();
        assert_eq!((door.id.as_str(), &door.inside[..]), ("d", &[node("r")][..]));
        for end in [door.from, door.to] {
            assert!((end.x - 4.1).abs() < 0.15 && (end.y.abs() - 0.6).abs() < 0.15, "{end}");
        }
        assert_eq!(found(&place, &["c", "d", "r"]), None, "who begins in the corridor comes out of nothing");
        assert_eq!(way_out(&place.graph, &node("r")), Some(vec![node("r"), node("d"), node("c")]));
    }

    #[test]
    fn without_a_doorway_node_the_narrowest_place_before_the_corridor_is_the_opening() {
        let mut place = room(["OFFICE ROOM", "OFFICE ROOM", "CORRIDOR"]);
        place.graph = place.graph.edited(|nodes, _| nodes[1].at = Point::new(6., 0.));
        let door = found(&place, &["r", "d", "c"]).unwrap();
        assert!((door.middle().x - 4.1).abs() < 0.25 && (door.to - door.from).norm() < 1.4, "{door:?}");
        assert_eq!(found(&room(["NODE", "NODE", "CORRIDOR"]), &["r", "d", "c"]), None, "plain nodes tell of no room");
    }

    /// A car of constant width behind the wall x = 4, with a node deep inside and one near its opening; the lobby before it.
    fn car(front_x: f64) -> Location {
        floor(
            &[(4., 0.9, 9., 4.), (4., -4., 9., -0.9), (7., -0.9, 9., 0.9)],
            &[
                ("back", "WITHIN_ELEVATOR_2", 6.4, 0.),
                ("front", "WITHIN_ELEVATOR_2", front_x, 0.),
                ("out", "OUTSIDE_ELEVATOR_2", 2.6, 0.),
                ("hall", "CORRIDOR", 2.6, 6.),
                ("d", "DOORWAY", 2.6, 7.),
            ],
            &[("back", "front"), ("front", "out"), ("out", "hall"), ("hall", "d")],
        )
    }

    #[test]
    fn a_car_told_by_node_types_alone_has_its_opening_outside_its_nodes() {
        for front_x in [5.0, 4.3, 4.0] {
            let place = car(front_x);
            for way in [&["front", "out", "hall"][..], &["back", "front", "out", "hall"]] {
                let door = found(&place, way).unwrap();
                assert_eq!((door.kind, door.id.as_str()), (DoorKind::Elevator, "front"));
                let x = door.middle().x;
                assert!(x < front_x - 0.3 && x > 2.9 && x < 4.1, "a node at {front_x}, its opening at {x}");
                let inside = place.graph.nodes()[1].at;
                for node in &place.graph.nodes()[..2] {
                    assert!(door.depth_m(&node.at, &inside) > 0.3, "{}: {door:?}", node.id);
                }
                assert!(door.depth_m(&place.graph.nodes()[2].at, &inside) < -0.3, "{door:?}");
            }
        }
    }

    #[test]
    fn whoever_stays_in_a_car_without_a_door_has_its_own_opening_and_no_other_doorway() {
        let place = car(5.0);
        let way = way_out(&place.graph, &node("back")).unwrap();
        assert_eq!(way, vec![node("back"), node("front"), node("out")]);
        assert!(opening(&place, &DistanceField::new(&place.grid), &way).is_some());
    }
}
