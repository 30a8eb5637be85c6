//! What is wrong with a location as a whole.

use std::collections::BTreeSet;

use socrates_model::{AreaName, Cell, Door, DoorOpens, Fault, FaultCode, Grid, Location, NodeId, Point, Vector, Where};

use crate::finding::{About, Finding};
use crate::ground::Ground;
use crate::openings::Enclosures;
use crate::read::{EXTRA, GRAPH, edge_at};

/// Longest opening that counts as a door, m.
const DOOR_MAX_M: f64 = 8.0;
/// How far a door's end may be from the wall that holds it, m.
const DOOR_SLACK_M: f64 = 0.35;
/// Places between a door's end and there at which the wall is looked for.
const DOOR_STEPS: u32 = 14;
/// Largest time, s, or distance, m, that a door may be given; a run lasts at most as long.
const DOOR_VALUE_MAX: f64 = 600.0;

/// Sizes of a cell, m.
pub(crate) const CELL_M: std::ops::RangeInclusive<f64> = 0.001..=10.0;
/// Largest coordinate of a map's origin, m, and yaw, rad.
pub(crate) const ORIGIN_MAX: f64 = 1e7;

/// Every problem of a location that can be seen from its parts together; soft faults are warnings.
///
/// Nodes on free floor, edges (with their via points) on free floor, one connected graph, types that
/// are not empty, doors that are sensible and whose inside nodes exist.
#[must_use]
pub fn check(location: &Location) -> Vec<Fault> {
    findings(location).into_iter().map(|finding| finding.fault).collect()
}

/// The same with what each problem is about and where it is.
#[must_use]
pub fn findings(location: &Location) -> Vec<Finding> {
    let mut found = Vec::new();
    if !measures(&location.grid, &mut found) {
        // Everything below walks over the cells between two points.
        return found;
    }
    grid_problems(&location.grid, &mut found);
    let on_wall = node_problems(location, &mut found);
    edge_problems(location, &on_wall, &mut found);
    part_problems(location, &mut found);
    for (index, door) in location.doors.iter().enumerate() {
        door_problems(location, index, door, &mut found);
    }
    for (index, area) in location.names.iter().enumerate() {
        name_problems(location, index, area, &mut found);
    }
    if found.iter().all(|finding| finding.fault.is_soft()) {
        open_plan(location, &mut found);
    }
    found
}

/// Whether the grid lies somewhere, in cells of some size: bounds as for `map.yaml`.
fn measures(grid: &Grid, found: &mut Vec<Finding>) -> bool {
    let before = found.len();
    let mut fault = |message: String| found.push(Finding::whole(FaultCode::MValue, "grid", message));
    if !CELL_M.contains(&grid.resolution_m) {
        let (least, most) = (CELL_M.start(), CELL_M.end());
        fault(format!("`resolution_m` is {:e}; allowed: {least} to {most} m", grid.resolution_m));
    }
    for (key, value) in [("x", grid.origin.x), ("y", grid.origin.y), ("yaw", grid.origin.yaw)] {
        if !(-ORIGIN_MAX..=ORIGIN_MAX).contains(&value) {
            fault(format!("`origin.{key}` is {value:e}; allowed: -{ORIGIN_MAX} to {ORIGIN_MAX}"));
        }
    }
    found.len() == before
}

fn grid_problems(grid: &Grid, found: &mut Vec<Finding>) {
    if grid.width.saturating_mul(grid.height) != grid.cells.len() {
        let message = format!("the grid has {} cells for {} by {}", grid.cells.len(), grid.width, grid.height);
        found.push(Finding::whole(FaultCode::MImage, "grid", message));
    }
    if !grid.cells.contains(&Cell::Free) {
        let message = "no cell of the map is free; check `negate` and the thresholds".to_owned();
        found.push(Finding::whole(FaultCode::MImage, "grid", message));
    }
}

fn node_problems<'a>(location: &'a Location, found: &mut Vec<Finding>) -> BTreeSet<&'a NodeId> {
    let mut on_wall = BTreeSet::new();
    for node in location.graph.nodes() {
        let mut fault = |code: FaultCode, message: String| {
            let place = Where::file(GRAPH).node(node.id.clone());
            found.push(Finding::new(About::Node(node.id.clone()), Some(node.at), Fault::new(code, place, message)));
        };
        if !location.grid.is_free(&node.at) {
            let stands = location.grid.cell_of(&node.at).map_or("outside the map", |(column, row)| {
                match location.grid.at(column, row) {
                    Cell::Occupied => "in a wall",
                    Cell::Unknown => "on unknown floor",
                    Cell::Free => "free",
                }
            });
            let (px, py) = location.grid.pixel_from_world(&node.at);
            let message = format!(
                "stands {stands} at ({:.2}, {:.2}) m, pixel ({px:.0}, {py:.0}); move it to free floor",
                node.at.x, node.at.y
            );
            fault(FaultCode::MWall, message);
            on_wall.insert(&node.id);
        }
        if node.kind.trim().is_empty() {
            fault(FaultCode::MType, "the type is empty; say what kind of place it is".to_owned());
        }
    }
    on_wall
}

fn edge_problems(location: &Location, on_wall: &BTreeSet<&NodeId>, found: &mut Vec<Finding>) {
    let ground = Ground::of(&location.grid);
    let sight = ground.sight();
    for edge in location.graph.edges() {
        let mut fault = |code: FaultCode, at: Option<Point>, message: String| {
            let about = About::Edge(edge.from.clone(), edge.to.clone());
            found.push(Finding::new(about, at, Fault::new(code, edge_at(edge), message)));
        };
        let ends = location.graph.node(&edge.from).zip(location.graph.node(&edge.to));
        if edge.kind.trim().is_empty() {
            let half = ends.map(|(a, b)| middle(&a.at, &b.at));
            fault(FaultCode::MType, half, "the type is empty; say what kind of way it is".to_owned());
        }
        if on_wall.contains(&edge.from) || on_wall.contains(&edge.to) {
            continue;
        }
        let Some(points) = location.graph.edge_points(&edge.from, &edge.to) else {
            fault(FaultCode::MId, None, "joins a node that does not exist".to_owned());
            continue;
        };
        let blocked = points.windows(2).find_map(|pair| match pair {
            [a, b] if !sight.clear(a, b) => Some((*a, *b)),
            _ => None,
        });
        if let Some((a, b)) = blocked {
            let message = format!(
                "crosses a wall between ({:.2}, {:.2}) and ({:.2}, {:.2}) m; open the wall in the image or remove the edge",
                a.x, a.y, b.x, b.y
            );
            fault(FaultCode::GFree, Some(middle(&a, &b)), message);
        }
    }
}

/// Half way between two points.
pub(crate) fn middle(a: &Point, b: &Point) -> Point {
    a + (b - a) / 2.0
}

/// Rooms and cars without an opening: nobody can be seen to come out of them.
fn open_plan(location: &Location, found: &mut Vec<Finding>) {
    for (nodes, why) in Enclosures::of(location).open_plan() {
        let Some(first) = nodes.first() else { continue };
        let node = location.graph.node(first);
        let kind = node.map_or("", |node| node.kind.as_str());
        let message = format!(
            "the type `{kind}` of {} says that it is inside, but {why}; nobody can come out of it or go in. Give it a doorway node or a \
             door, or a type such as `OPEN AREA`",
            names(nodes)
        );
        let fault = Fault::new(FaultCode::MType, Where::file(GRAPH).node(first.clone()), message);
        found.push(Finding::new(About::Node(first.clone()), node.map(|node| node.at), fault));
    }
}

fn part_problems(location: &Location, found: &mut Vec<Finding>) {
    let mut parts = location.graph.parts();
    if parts.len() < 2 {
        return;
    }
    parts.sort_by_key(|part| std::cmp::Reverse(part.len()));
    let listed: Vec<String> = parts.iter().map(|part| names(part)).collect();
    let message = format!("the graph falls into {} parts: {}; join them by edges", parts.len(), listed.join(" | "));
    // The smallest part is what was most likely forgotten.
    let least = parts.last().and_then(|part| location.graph.node(part.first()?));
    let fault = Fault::new(FaultCode::MParts, Where::file(GRAPH), message);
    let about = least.map_or(About::Whole, |node| About::Node(node.id.clone()));
    found.push(Finding::new(about, least.map(|node| node.at), fault));
}

/// Ids in a row, at most a dozen.
fn names(ids: &[NodeId]) -> String {
    let shown: Vec<&str> = ids.iter().take(12).map(NodeId::as_str).collect();
    let more = ids.len().saturating_sub(shown.len());
    if more > 0 { format!("{} and {more} more", shown.join(", ")) } else { shown.join(", ") }
}

/// What is wrong with a door of a location: its line, its rule, and the nodes behind it.
#[must_use]
pub fn check_door(location: &Location, index: usize) -> Vec<Fault> {
    let mut found = Vec::new();
    if let Some(door) = location.doors.get(index) {
        door_problems(location, index, door, &mut found);
    }
    found.into_iter().map(|finding| finding.fault).collect()
}

fn door_problems(location: &Location, index: usize, door: &Door, found: &mut Vec<Finding>) {
    let mut fault = |code: FaultCode, message: String| {
        let place = Where::file(EXTRA).at_key(format_args!("door `{}`", door.id));
        found.push(Finding::new(About::Door(index), Some(door.middle()), Fault::new(code, place, message)))
    };
    if door.id.trim().is_empty() {
        fault(FaultCode::MId, format!("door {} has an empty id", index + 1));
    }
    if location.doors.iter().take(index).any(|other| other.id == door.id) {
        fault(FaultCode::MId, "the id is taken by an earlier door".to_owned());
    }
    let length_m = (door.to - door.from).norm();
    if !(0.3..=DOOR_MAX_M).contains(&length_m) {
        fault(FaultCode::MValue, format!("the door line is {length_m:.2} m long; allowed: 0.3 to {DOOR_MAX_M} m"));
    } else {
        line_problems(location, door, &mut fault);
    }
    let mut values = match &door.opens {
        DoorOpens::AtTimes(times) => times.iter().map(|secs| ("opens.at_times", *secs)).collect(),
        DoorOpens::Near(m) => vec![("opens.near", *m)],
        DoorOpens::RobotNear(m) => vec![("opens.robot_near", *m)],
        DoorOpens::Always | DoorOpens::OnEvent(_) | DoorOpens::Never => Vec::new(),
    };
    if door.opens == DoorOpens::AtTimes(Vec::new()) {
        fault(
            FaultCode::MValue,
            "`opens.at_times` has no time; a door that never opens has `opens = \"never\"`".to_owned(),
        );
    }
    values.push(("hold_s", door.hold_s));
    for (key, value) in values {
        if !(0.0..=DOOR_VALUE_MAX).contains(&value) {
            fault(FaultCode::MValue, format!("`{key}` is `{value}`; allowed: 0 to {DOOR_VALUE_MAX}"));
        }
    }
    for id in &door.inside {
        if location.graph.node(id).is_none() {
            fault(FaultCode::MId, format!("the inside node `{id}` is no node of the scene graph"));
        }
    }
    let insides: Vec<Point> = door.inside.iter().filter_map(|id| location.graph.node(id)).map(|node| node.at).collect();
    if let Some(first) = insides.first()
        && let Some(other) = insides.iter().find(|point| door.depth_m(point, first) <= 0.0)
    {
        fault(
            FaultCode::MValue,
            format!("its inside nodes lie on both sides of the door line, one at ({:.2}, {:.2}) m", other.x, other.y),
        );
    }
}

/// Longest name of an area, letters.
const NAME_MAX: usize = 60;

/// Whether an area may be called so: 1 to 60 letters on one line, with no blank at either end.
#[must_use]
pub fn is_area_name(name: &str) -> bool {
    let letters = name.chars().count();
    name.trim() == name && (1..=NAME_MAX).contains(&letters) && !name.chars().any(char::is_control)
}

fn name_problems(location: &Location, index: usize, area: &AreaName, found: &mut Vec<Finding>) {
    let shown: String = area.name.chars().take(NAME_MAX).collect();
    let mut fault = |code: FaultCode, message: String| {
        let at = area.nodes.iter().find_map(|id| location.graph.node(id)).map(|node| node.at);
        let place = Where::file(EXTRA).at_key(format_args!("name `{shown}`"));
        found.push(Finding::new(About::Name(index), at, Fault::new(code, place, message)));
    };
    if !is_area_name(&area.name) {
        fault(
            FaultCode::MValue,
            format!("is no name; allowed: 1 to {NAME_MAX} letters on one line, no blank at either end"),
        );
    }
    let lower = area.name.to_lowercase();
    if location.names.iter().take(index).any(|other| other.name.to_lowercase() == lower) {
        fault(FaultCode::MId, "the name is taken by an earlier area; list all its nodes in one entry".to_owned());
    }
    if area.nodes.is_empty() {
        fault(FaultCode::MValue, "`nodes` is empty; name the nodes of the area".to_owned());
    }
    for id in area.nodes.iter().filter(|id| location.graph.node(id).is_none()) {
        fault(FaultCode::MId, format!("its node `{id}` is no node of the scene graph"));
    }
}

fn line_problems(location: &Location, door: &Door, fault: &mut impl FnMut(FaultCode, String)) {
    if !location.grid.is_free(&door.middle()) {
        let middle = door.middle();
        let message =
            format!("its middle ({:.2}, {:.2}) m is not on free floor; a door closes an opening", middle.x, middle.y);
        fault(FaultCode::MWall, message);
        return;
    }
    let along = (door.to - door.from).normalize();
    // Behind a thin wall that the door's line meets lies the floor of somebody else.
    let steps = (1..=DOOR_STEPS).map(|step| DOOR_SLACK_M * f64::from(step) / f64::from(DOOR_STEPS));
    // A wall that bends away from the door's line begins beside the line's end, half a right angle off it.
    let beside_m = (1.5 * location.grid.resolution_m).min(DOOR_SLACK_M);
    for (end, outward) in [(door.from, -along), (door.to, along)] {
        let left = Vector::new(-outward.y, outward.x);
        let beside = [outward + left, outward - left].map(|way| end + way.normalize() * beside_m);
        let mut looked = steps.clone().map(|off_m| end + outward * off_m).chain(beside);
        if looked.all(|at| location.grid.is_free(&at)) {
            let message = format!(
                "its end ({:.2}, {:.2}) m does not meet a wall within {DOOR_SLACK_M} m; the gap beside the door would stay open",
                end.x, end.y
            );
            fault(FaultCode::MWall, message);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::tests::grid;
    use socrates_model::{DoorKind, GraphEdge, GraphNode, Grid, SceneGraph};

    fn id(text: &str) -> NodeId {
        NodeId::new(text).unwrap()
    }

    fn location() -> Location {
        let node = |name: &str, x: f64, y: f64| GraphNode { id: id(name), kind: "ROOM".into(), at: Point::new(x, y) };
        let edge = |a: &str, b: &str| GraphEdge { from: id(a), to: id(b), kind: "DOORWAY".into(), via: vec![] };
        Location {
            format: 1,
            name: "two".into(),
            description: "Two rooms.".into(),
            grid: grid(&["#########", "#...#...#", "#.......#", "#...#...#", "#########"]),
            graph: SceneGraph::new(vec![node("a", 1.2, 1.25), node("b", 3.2, 1.25)], vec![edge("a", "b")]),
            doors: vec![Door {
                id: "d".into(),
                kind: DoorKind::Room,
                from: Point::new(2.25, 1.0),
                to: Point::new(2.25, 1.5),
                opens: DoorOpens::Near(1.5),
                hold_s: 5.0,
                inside: vec![id("b")],
            }],
            names: Vec::new(),
            warnings: vec![],
        }
    }

    fn codes(location: &Location) -> Vec<&'static str> {
        check(location).iter().map(|fault| fault.code.code()).collect()
    }

    #[test]
    fn a_good_location_has_no_problem() {
        assert_eq!(check(&location()), []);
    }

    #[test]
    fn nodes_in_walls_and_edges_through_walls_are_named() {
        let mut bad = location();
        bad.graph = bad.graph.edited(|nodes, _| nodes[0].at = Point::new(0.2, 0.2));
        assert_eq!(codes(&bad), ["M-WALL"]);
        let mut bad = location();
        bad.graph = bad.graph.edited(|nodes, _| {
            nodes[0].at = Point::new(1.2, 0.75);
            nodes[1].at = Point::new(3.2, 0.75);
        });
        assert_eq!(codes(&bad), ["G-FREE"]);
    }

    #[test]
    fn the_parts_of_a_broken_graph_are_listed() {
        let mut bad = location();
        bad.graph = bad.graph.edited(|_, edges| edges.clear());
        let faults = check(&bad);
        assert_eq!(faults[0].code, FaultCode::MParts);
        assert!(faults[0].message.to_string().contains("2 parts: a | b"), "{}", faults[0]);
    }

    #[test]
    fn doors_that_cannot_be_are_named() {
        let mut bad = location();
        bad.doors.push(bad.doors[0].clone());
        bad.doors[1].inside = vec![id("a"), id("b"), id("zz")];
        bad.doors[1].hold_s = -1.0;
        bad.doors[1].opens = DoorOpens::RobotNear(f64::NAN);
        assert_eq!(codes(&bad), ["M-ID", "M-VALUE", "M-VALUE", "M-ID", "M-VALUE"]);
        bad.doors[1].opens = DoorOpens::AtTimes(vec![4.0, 1e9]);
        assert_eq!(codes(&bad), ["M-ID", "M-VALUE", "M-VALUE", "M-ID", "M-VALUE"]);
        bad.doors[1].opens = DoorOpens::AtTimes(vec![]);
        assert!(check(&bad).iter().any(|fault| fault.message.to_string().contains("at_times")));
        bad.doors[1].from = bad.doors[1].to;
        assert!(codes(&bad).contains(&"M-VALUE"));
        let mut open = location();
        open.doors[0].from = Point::new(1.0, 1.25);
        open.doors[0].to = Point::new(1.5, 1.25);
        open.doors[0].inside.clear();
        assert_eq!(codes(&open), ["M-WALL", "M-WALL"]);
    }

    #[test]
    fn a_door_may_end_at_a_thin_wall_with_a_room_behind_it() {
        let mut thin = location();
        // Walls of one cell of 0.1 m; the opening on the left ends at the wall that parts the two rooms on the right of it.
        let rows = [
            "####################",
            "#........#.........#",
            "#........#.........#",
            "#........#.........#",
            "#........#.........#",
            "####.....#.........#",
            "#........#.........#",
            "#........#.........#",
            "#..................#",
            "#........#.........#",
            "####################",
        ];
        thin.grid = Grid { resolution_m: 0.1, ..grid(&rows) };
        thin.graph = thin.graph.edited(|nodes, edges| {
            nodes[0].at = Point::new(0.65, 0.85);
            nodes[1].at = Point::new(0.65, 0.25);
            edges.truncate(1);
        });
        (thin.doors[0].from, thin.doors[0].to) = (Point::new(0.4, 0.55), Point::new(0.9, 0.55));
        assert_eq!(check(&thin), []);
        // With a gap in that wall right there the line ends nowhere.
        thin.grid.cells[5 * 20 + 9] = socrates_model::Cell::Free;
        assert_eq!(codes(&thin), ["M-WALL"]);
    }
}
