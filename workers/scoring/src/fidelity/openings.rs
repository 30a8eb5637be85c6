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
/// the way at its first doorway node; where it has none, at the narrowest place between the room and what comes next.
/// `None` where the way begins in no room, or no walls bound the opening.
#[must_use]
pub(super) fn opening(place: &Location, field: &DistanceField, way: &[NodeId]) -> Option<Door> {
    let class = |id: &NodeId| place.graph.node(id).map(|node| PlaceClass::of_type(&node.kind));
    let first = way.first()?;
    if !class(first).is_some_and(is_inside) {
        return None;
    }
    let doorway = way.iter().position(|id| class(id) == Some(PlaceClass::Doorway));
    let outside = way.iter().position(|id| class(id).is_some_and(|class| !is_inside(class)))?;
    // A doorway farther on belongs to another room.
    let (door, nodes) = match doorway.filter(|at| *at == outside) {
        Some(at) => (way.get(at), way.get(at.checked_sub(1)?..way.len().min(at + 2))?),
        // Plain nodes say nothing of a room without a doorway.
        None if class(first) == Some(PlaceClass::Plain) => return None,
        None => (None, way.get(outside.checked_sub(1)?..=outside)?),
    };
    let near = door.and_then(|id| place.graph.node(id)).map(|node| node.at);
    let (from, to) = narrowest(field, &place.graph.polyline(nodes), near)?;
    let id = door.or_else(|| nodes.first()).map(ToString::to_string)?;
    let kind = if class(first) == Some(PlaceClass::Elevator) { DoorKind::Elevator } else { DoorKind::Room };
    let inside = nodes.first().cloned().into_iter().collect();
    Some(Door { id, kind, from, to, opens: DoorOpens::Always, hold_s: 0.0, inside })
}

/// The way out of the room of a node: to the nearest doorway and one node on.
#[must_use]
pub(super) fn way_out(graph: &SceneGraph, from: &NodeId) -> Option<Vec<NodeId>> {
    let doorways = graph.nodes.iter().filter(|node| PlaceClass::of_type(&node.kind) == PlaceClass::Doorway);
    let mut way = doorways
        .filter_map(|node| graph.shortest(from, &node.id))
        .min_by(|a, b| graph.length_m(a).total_cmp(&graph.length_m(b)))?;
    let on = way.last().and_then(|last| graph.neighbors(last).into_iter().find(|next| !way.contains(next)));
    way.extend(on);
    Some(way)
}

/// Ends of the shortest line across a way from wall to wall; of equal ones the nearest to a point.
fn narrowest(field: &DistanceField, way: &[Point], near: Option<Point>) -> Option<(Point, Point)> {
    let mut best: Option<(f64, f64, (Point, Point))> = None;
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
            let off = near.map_or(0.0, |near| (at - near).norm());
            if off > NEAR_M {
                continue;
            }
            let Some((left, right)) = to_wall(field, &at, &across).zip(to_wall(field, &at, &-across)) else { continue };
            let width = (left - right).norm();
            let better = best
                .as_ref()
                .is_none_or(|(least, far, _)| width < least - EQUAL_M || width < least + EQUAL_M && off < *far);
            if better {
                best = Some((width, off, (left, right)));
            }
        }
    }
    best.map(|(_, _, line)| line)
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
        place.graph.nodes[1].at = Point::new(6., 0.);
        let door = found(&place, &["r", "d", "c"]).unwrap();
        assert!((door.middle().x - 4.1).abs() < 0.25 && (door.to - door.from).norm() < 1.4, "{door:?}");
        assert_eq!(found(&room(["NODE", "NODE", "CORRIDOR"]), &["r", "d", "c"]), None, "plain nodes tell of no room");
    }
}
