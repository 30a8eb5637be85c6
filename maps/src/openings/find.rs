//! From a location to its rooms and cars.

use std::collections::BTreeMap;

use socrates_model::geometry::{nearest_on_segment, segments_cross};
use socrates_model::{Door, DoorKind, Location, NodeId, PlaceClass, Point, SceneGraph, Vector};

use super::chords::{Chord, along, chords, is_narrow, length_m};
use super::flood::{Cell, Closed, Stop, fill, paint};
use super::{Across, Enclosure, Enclosures, OpenPlan, Opening, THRESHOLD_M};
use crate::field::DistanceField;
use crate::layer::Layer;

/// An opening is looked for this near to a doorway node, m.
const NEAR_M: f64 = 1.2;
/// Distance of an opening from the node on its inner side, m, or half of the way to the next node where that is shorter:
/// somebody who stands at a node inside is inside.
const CLEAR_M: f64 = 0.5;
/// Half widths of what may not get round the closed gates, m, the least first: a person; then wider bodies, for rooms with
/// another gap in their walls, up to that of a door, which no edge of the graph leads through.
const BODIES_M: [f64; 4] = [0.2, 0.35, 0.5, 0.7];
/// Lines of one gate that are tried.
const TRIES: usize = 8;
/// Nodes without a telling type that a room may take in when no opening is found before them.
const TAKEN_IN: usize = 4;

/// Where a group of nodes is left.
#[derive(Debug, Clone)]
struct Gate {
    across: Across,
    /// The node inside.
    inner: usize,
    /// The nodes that lie outside of it.
    outer: Vec<usize>,
    /// Lines that might be the opening, the likeliest first; of a declared door its own alone.
    lines: Vec<Chord>,
    chosen: usize,
}

impl Gate {
    fn line(&self) -> Option<&Chord> {
        self.lines.get(self.chosen)
    }

    const fn is_declared(&self) -> bool {
        matches!(self.across, Across::Door(_))
    }
}

/// Nodes inside that hang together.
#[derive(Debug, Clone)]
struct Group {
    kind: DoorKind,
    nodes: Vec<usize>,
    gates: Vec<Gate>,
}

/// What is known of a place.
struct Found {
    group: Group,
    /// The half width that does not get round its gates, m, and the floor it reaches.
    body_m: f64,
    cells: Vec<Cell>,
}

/// The finder's view of a location.
struct Finder<'a> {
    location: &'a Location,
    graph: &'a SceneGraph,
    field: &'a DistanceField,
    /// What each node is inside of by its door or its type.
    kinds: Vec<Option<DoorKind>>,
}

impl Enclosures {
    /// The rooms and cars of a location, from its graph, its doors and the distances of its map.
    #[must_use]
    pub fn new(location: &Location, field: &DistanceField) -> Self {
        let finder = Finder::new(location, field);
        let mut groups = finder.groups();
        for group in &mut groups {
            group.gates = finder.gates(&group.nodes);
        }
        let mut made = Self {
            places: Vec::new(),
            open: Vec::new(),
            of_node: BTreeMap::new(),
            raster: field.raster.clone(),
            floor: Layer::filled(field.raster.width, field.raster.height, 0),
        };
        let mut found: Vec<Found> = Vec::new();
        for number in 0..groups.len() {
            let Some(group) = groups.get(number).cloned() else { continue };
            if let Some(same) = finder.known(&made.floor, &found, &group) {
                // Several nodes of one room.
                if let Some(place) = found.get_mut(same) {
                    place.join(group);
                }
                continue;
            }
            let others: Vec<(Point, Point)> = finder.lines(groups.iter().enumerate(), number);
            match finder.settle(group, &others) {
                Ok(place) => {
                    let closed = Closed::of(field, others.into_iter().chain(place.group.segments()));
                    let label = u16::try_from(found.len() + 1).unwrap_or(u16::MAX);
                    let reach_m = place.body_m + 2.0 * field.raster.resolution_m;
                    paint(field, &closed, &mut made.floor, (&place.cells, reach_m), label);
                    if let Some(slot) = groups.get_mut(number) {
                        slot.clone_from(&place.group);
                    }
                    found.push(place);
                }
                Err((nodes, why)) => {
                    if let Some(slot) = groups.get_mut(number) {
                        slot.gates.clear();
                    }
                    made.open.push((finder.ids(&nodes), why));
                }
            }
        }
        for (number, place) in found.iter().enumerate() {
            let place = finder.enclosure(place, number, &made);
            made.of_node.extend(place.nodes.iter().map(|node| (node.clone(), number)));
            made.places.push(place);
        }
        made
    }
}

impl Group {
    fn segments(&self) -> impl Iterator<Item = (Point, Point)> + '_ {
        self.gates.iter().filter_map(Gate::line).map(|line| (line.from, line.to))
    }
}

impl Found {
    /// Takes in another group of the same place with the gates that are not known yet.
    fn join(&mut self, group: Group) {
        let known = |gate: &Gate, gates: &[Gate]| gates.iter().any(|other| other.across == gate.across);
        for gate in group.gates {
            if !known(&gate, &self.group.gates) {
                self.group.gates.push(gate);
            }
        }
        self.group.nodes.extend(group.nodes);
    }
}

impl<'a> Finder<'a> {
    fn new(location: &'a Location, field: &'a DistanceField) -> Self {
        let graph = &location.graph;
        let kind = |(at, node): (usize, &socrates_model::GraphNode)| {
            if let Some(door) = location.door_of(&node.id) {
                return Some(door.kind);
            }
            match graph.kind_at(at) {
                PlaceClass::Elevator => Some(DoorKind::Elevator),
                PlaceClass::Room => Some(DoorKind::Room),
                PlaceClass::Corridor
                | PlaceClass::NarrowPassage
                | PlaceClass::Intersection
                | PlaceClass::BlindCorner
                | PlaceClass::Doorway
                | PlaceClass::ElevatorLobby
                | PlaceClass::OpenArea
                | PlaceClass::Exit
                | PlaceClass::Plain => None,
            }
        };
        Self { location, graph, field, kinds: graph.nodes().iter().enumerate().map(kind).collect() }
    }

    fn kind(&self, node: usize) -> Option<DoorKind> {
        self.kinds.get(node).copied().flatten()
    }

    fn id(&self, node: usize) -> Option<&NodeId> {
        self.graph.nodes().get(node).map(|node| &node.id)
    }

    fn ids(&self, nodes: &[usize]) -> Vec<NodeId> {
        nodes.iter().filter_map(|node| self.id(*node).cloned()).collect()
    }

    fn at(&self, node: usize) -> Point {
        self.graph.nodes().get(node).map_or_else(Point::origin, |node| node.at)
    }

    fn neighbors(&self, node: usize) -> impl Iterator<Item = usize> + '_ {
        let ids = self.id(node).map_or(&[][..], |id| self.graph.neighbors(id));
        ids.iter().filter_map(|id| self.graph.position(id))
    }

    fn way(&self, nodes: &[usize]) -> Vec<Point> {
        self.graph.polyline(&self.ids(nodes))
    }

    /// The first declared door that a line crosses.
    fn door_across(&self, way: &[Point]) -> Option<&'a Door> {
        let crosses = |door: &&Door| {
            way.windows(2).any(|pair| matches!(pair, [a, b] if segments_cross(a, b, &door.from, &door.to)))
        };
        self.location.doors.iter().find(crosses)
    }

    /// Nodes inside of one kind that hang together by edges on which nothing says that there is a door.
    fn groups(&self) -> Vec<Group> {
        let mut groups = Vec::new();
        let mut seen = vec![false; self.kinds.len()];
        for first in 0..self.kinds.len() {
            let Some(kind) = self.kind(first).filter(|_| seen.get(first) == Some(&false)) else { continue };
            let (mut nodes, mut open) = (Vec::new(), vec![first]);
            while let Some(node) = open.pop() {
                match seen.get_mut(node) {
                    Some(flag) if !*flag => *flag = true,
                    Some(_) | None => continue,
                }
                nodes.push(node);
                open.extend(
                    self.neighbors(node).filter(|next| self.kind(*next) == Some(kind) && self.joined(node, *next)),
                );
            }
            nodes.sort_unstable();
            groups.push(Group { kind, nodes, gates: Vec::new() });
        }
        groups
    }

    /// Whether two neighbors inside lie in one place as far as the edge between them tells: no door is declared across it and
    /// its type is no doorway. Two doors that name different nodes part them as well.
    fn joined(&self, a: usize, b: usize) -> bool {
        let edge = self.id(a).zip(self.id(b)).and_then(|(a, b)| self.graph.edge(a, b));
        let doorway = edge.is_none_or(|edge| PlaceClass::of_type(&edge.kind) == PlaceClass::Doorway);
        let doors = |node: usize| {
            self.id(node)
                .map(|id| self.location.doors.iter().filter(|door| door.inside.contains(id)).map(|door| &door.id))
        };
        let shared = |a: usize, b: usize| {
            let other: Vec<&String> = doors(b).into_iter().flatten().collect();
            let own: Vec<&String> = doors(a).into_iter().flatten().collect();
            own.is_empty() || other.is_empty() || own.iter().any(|door| other.contains(door))
        };
        // A type of the ways behind a door is often that of the door itself.
        let named = || {
            let both: Vec<&String> = doors(b).into_iter().flatten().collect();
            doors(a).into_iter().flatten().any(|door| both.contains(&door))
        };
        self.door_across(&self.way(&[a, b])).is_none() && shared(a, b) && (!doorway || named())
    }

    /// The gates of a group: where an edge leads out of it, and the declared doors that name its nodes.
    fn gates(&self, nodes: &[usize]) -> Vec<Gate> {
        let mut gates: Vec<Gate> = Vec::new();
        let named = self
            .location
            .doors
            .iter()
            .filter(|door| nodes.iter().any(|node| self.id(*node).is_some_and(|id| door.inside.contains(id))));
        for door in named {
            let inner = nodes.iter().copied().find(|node| self.id(*node).is_some_and(|id| door.inside.contains(id)));
            gates.extend(inner.map(|inner| self.declared(door, inner)));
        }
        for inner in nodes {
            for next in self.neighbors(*inner).filter(|next| !nodes.contains(next)) {
                let gate = self.gate(*inner, next, nodes);
                match gates.iter_mut().find(|known| known.across == gate.across) {
                    Some(known) => known.outer.extend(gate.outer),
                    None => gates.push(gate),
                }
            }
        }
        let rank = |gate: &Gate| match &gate.across {
            Across::Door(id) => self.location.doors.iter().position(|door| door.id == *id).unwrap_or(usize::MAX),
            Across::Node(_) | Across::Edge(..) => usize::MAX,
        };
        gates.sort_by_key(rank);
        gates
    }

    fn declared(&self, door: &Door, inner: usize) -> Gate {
        let middle = door.middle();
        let across = door.to - door.from;
        let ahead = Vector::new(-across.y, across.x).try_normalize(1e-9).unwrap_or_else(Vector::x);
        let line = Chord { from: door.from, to: door.to, at: middle, ahead, width_m: across.norm() };
        Gate { across: Across::Door(door.id.clone()), inner, outer: Vec::new(), lines: vec![line], chosen: 0 }
    }

    /// The gate between a node of a group and its neighbor outside.
    fn gate(&self, inner: usize, next: usize, group: &[usize]) -> Gate {
        if let Some(door) = self.door_across(&self.way(&[inner, next])) {
            let outer =
                if self.graph.kind_at(next) == PlaceClass::Doorway { self.beyond(next, group) } else { vec![next] };
            return Gate { outer, ..self.declared(door, inner) };
        }
        if self.graph.kind_at(next) == PlaceClass::Doorway && self.kind(next).is_none() {
            return self.gate_at_node(inner, next, group);
        }
        let straight = |node: &usize| {
            let (into, out) = (self.at(inner) - self.at(*node), self.at(next) - self.at(inner));
            into.dot(&out) / (into.norm() * out.norm()).max(1e-9)
        };
        // A node may be drawn right before the opening of its car: then that lies behind the node.
        let back = self.neighbors(inner).filter(|node| group.contains(node) && straight(node) > 0.5);
        let back = back.max_by(|a, b| straight(a).total_cmp(&straight(b)));
        let nodes: Vec<usize> = back.into_iter().chain([inner, next]).collect();
        let (way, edge) = (self.way(&nodes), self.way(&[inner, next]));
        let edge_m = length_m(&edge);
        let near = along(&edge, edge_m - CLEAR_M.min(edge_m / 2.0)).unwrap_or_else(|| self.at(next));
        // The floor before the opening tells what is an opening, that of the room itself what is none.
        let all = chords(self.field, &way, &near, f64::INFINITY);
        let lines = all.into_iter().filter(|line| is_narrow(self.field, line)).take(TRIES).collect();
        let ids = self.id(inner).zip(self.id(next)).map(|(inner, next)| Across::Edge(inner.clone(), next.clone()));
        let across = ids.unwrap_or_else(|| Across::Door(String::new()));
        Gate { across, inner, outer: vec![next], lines, chosen: 0 }
    }

    /// The gate at a doorway node.
    fn gate_at_node(&self, inner: usize, doorway: usize, group: &[usize]) -> Gate {
        let outer = self.beyond(doorway, group);
        let straight = |node: &usize| {
            let (into, out) = (self.at(doorway) - self.at(inner), self.at(*node) - self.at(doorway));
            into.dot(&out) / (into.norm() * out.norm()).max(1e-9)
        };
        let on = outer.iter().copied().max_by(|a, b| straight(a).total_cmp(&straight(b)));
        let way = self.way(&[inner, doorway].into_iter().chain(on).collect::<Vec<_>>());
        let at = self.at(doorway);
        let near = |door: &&Door| nearest_on_segment(&at, &door.from, &door.to).0 <= NEAR_M;
        if let Some(door) = self.door_across(&way).filter(near) {
            return Gate { outer, ..self.declared(door, inner) };
        }
        let mut lines = chords(self.field, &way, &at, NEAR_M);
        lines.truncate(TRIES);
        let across = self.id(doorway).cloned().map_or_else(|| Across::Door(String::new()), Across::Node);
        Gate { across, inner, outer, lines, chosen: 0 }
    }

    /// What lies beyond a doorway node: its neighbors outside; where all are inside of something, those that are not in the group.
    fn beyond(&self, doorway: usize, group: &[usize]) -> Vec<usize> {
        let all: Vec<usize> = self.neighbors(doorway).filter(|node| !group.contains(node)).collect();
        let outside: Vec<usize> = all.iter().copied().filter(|node| self.kind(*node).is_none()).collect();
        if outside.is_empty() { all } else { outside }
    }

    /// The lines that are closed besides those of one group: all declared doors and the gates of the others.
    fn lines<'g>(&self, groups: impl Iterator<Item = (usize, &'g Group)>, but: usize) -> Vec<(Point, Point)> {
        let declared = self.location.doors.iter().map(|door| (door.from, door.to));
        let others = groups.filter(|(number, _)| *number != but).flat_map(|(_, group)| group.segments());
        declared.chain(others).collect()
    }

    /// The place that a group lies in, if its floor is known already.
    fn known(&self, floor: &Layer<u16>, found: &[Found], group: &Group) -> Option<usize> {
        let raster = &self.field.raster;
        let label = |node: &usize| {
            let (px, py) = raster.pixel(&self.at(*node));
            raster.cell(px, py).and_then(|(column, row)| floor.get(column, row)).map(usize::from)
        };
        let number = group.nodes.iter().filter_map(label).find(|label| *label > 0)?.checked_sub(1)?;
        found.get(number).filter(|place| place.group.kind == group.kind).map(|_| number)
    }

    /// Looks for gates that part a group from what lies outside of it, and fills its floor.
    fn settle(&self, mut group: Group, others: &[(Point, Point)]) -> Result<Found, (Vec<usize>, OpenPlan)> {
        let typed = group.nodes.clone();
        loop {
            let (gate, why) = match self.close(&mut group, others) {
                Ok((body_m, cells)) => return Ok(Found { group, body_m, cells }),
                Err(failed) => failed,
            };
            let next = gate.and_then(|gate| group.gates.get(gate)).filter(|gate| !gate.is_declared());
            // Floor that runs on to another node of a room is that of the same room; what its type does not tell is taken in.
            let untold = group.nodes.iter().filter(|node| self.is_untold(**node)).count();
            let same =
                |node: &usize| self.kind(*node) == Some(group.kind) || untold < TAKEN_IN && self.is_untold(*node);
            match next.and_then(|gate| gate.outer.iter().copied().find(same)) {
                Some(node) => {
                    group.nodes.push(node);
                    group.gates = self.gates(&group.nodes);
                }
                // What lies behind a declared door is said; where its floor runs on, the line alone tells.
                None if self.is_named(&typed) => {
                    group.gates.retain(Gate::is_declared);
                    return Ok(Found { group: Group { nodes: typed, ..group }, body_m: 0.0, cells: Vec::new() });
                }
                None => return Err((typed, why)),
            }
        }
    }

    /// Whether a declared door names one of these nodes.
    fn is_named(&self, nodes: &[usize]) -> bool {
        nodes.iter().any(|node| self.id(*node).is_some_and(|id| self.location.door_of(id).is_some()))
    }

    /// Whether the type of a node does not tell whether it is inside or outside.
    fn is_untold(&self, node: usize) -> bool {
        use PlaceClass as C;
        self.kind(node).is_none()
            && matches!(self.graph.kind_at(node), C::Plain | C::OpenArea | C::Exit | C::BlindCorner)
    }

    /// Chooses the lines of a group's gates; else the gate that cannot be closed, and why.
    fn close(
        &self,
        group: &mut Group,
        others: &[(Point, Point)],
    ) -> Result<(f64, Vec<Cell>), (Option<usize>, OpenPlan)> {
        if group.gates.is_empty() {
            return Err((None, OpenPlan::NoWayOut));
        }
        if let Some(bare) = group.gates.iter().position(|gate| gate.lines.is_empty()) {
            let why = group.gates.get(bare).and_then(|gate| self.pair(gate));
            return Err((Some(bare), why.map_or(OpenPlan::NoWayOut, |(from, to)| OpenPlan::NoWalls { from, to })));
        }
        let from: Vec<Point> = group.nodes.iter().map(|node| self.at(*node)).collect();
        let outer: Vec<(usize, Point)> = group
            .gates
            .iter()
            .enumerate()
            .flat_map(|(number, gate)| gate.outer.iter().map(move |node| (number, *node)))
            .map(|(number, node)| (number, self.at(node)))
            .collect();
        let forbidden: Vec<Point> = outer.iter().map(|(_, at)| *at).collect();
        let mut stopped = None;
        for body_m in BODIES_M {
            for gate in &mut group.gates {
                gate.chosen = 0;
            }
            loop {
                let closed = Closed::of(self.field, others.iter().copied().chain(group.segments()));
                let gate = match fill(self.field, &closed, body_m, &self.inside_of(group, &from), &forbidden) {
                    Ok(cells) => return Ok((body_m, cells)),
                    Err(Stop::NoFloor) => break,
                    Err(Stop::Reached(point)) => outer.get(point).map(|(gate, _)| *gate),
                };
                stopped = stopped.or(gate);
                let next = gate.and_then(|gate| group.gates.get_mut(gate));
                match next.filter(|gate| gate.chosen + 1 < gate.lines.len()) {
                    Some(gate) => gate.chosen += 1,
                    None => break,
                }
            }
        }
        for gate in &mut group.gates {
            gate.chosen = 0;
        }
        let gate = stopped.and_then(|gate| group.gates.get(gate));
        let why = gate.and_then(|gate| Some((self.pair(gate)?, gate.line()?.width_m)));
        Err((
            stopped,
            why.map_or(OpenPlan::InWall, |((from, to), width_m)| OpenPlan::FloorRunsOn { from, to, width_m }),
        ))
    }

    fn pair(&self, gate: &Gate) -> Option<(NodeId, NodeId)> {
        let outer = gate.outer.first().and_then(|node| self.id(*node));
        Some((self.id(gate.inner)?.clone(), outer.or_else(|| self.id(gate.inner))?.clone()))
    }

    /// The points that a fill begins at: those on the inner side of their own gates, or, where none is, a point behind a gate.
    fn inside_of(&self, group: &Group, from: &[Point]) -> Vec<Point> {
        let behind = |line: &Chord, point: &Point| (point - line.at).dot(&line.ahead) < -self.field.raster.resolution_m;
        let own = |node: usize| {
            let mut gates = group.gates.iter().filter(|gate| !gate.is_declared() && gate.inner == node);
            gates.all(|gate| gate.line().is_none_or(|line| behind(line, &self.at(node))))
        };
        let inside: Vec<Point> =
            group.nodes.iter().zip(from).filter(|(node, _)| own(**node)).map(|(_, at)| *at).collect();
        if !inside.is_empty() {
            return inside;
        }
        group.gates.iter().filter_map(Gate::line).map(|line| line.at - line.ahead * CLEAR_M).collect()
    }

    /// The finished place.
    fn enclosure(&self, found: &Found, number: usize, made: &Enclosures) -> Enclosure {
        let label = |point: &Point| {
            let (px, py) = made.raster.pixel(point);
            let cell = made.raster.cell(px, py).and_then(|(column, row)| made.floor.get(column, row));
            usize::from(cell.unwrap_or(0)).checked_sub(1)
        };
        let group = &found.group;
        let is_own = |(at, node): &(usize, &socrates_model::GraphNode)| {
            let lies = || label(&node.at) == Some(number) && self.kind(*at).is_none_or(|kind| kind == group.kind);
            group.nodes.contains(at) || lies() && self.graph.kind_at(*at) != PlaceClass::Doorway
        };
        let own: Vec<NodeId> =
            self.graph.nodes().iter().enumerate().filter(is_own).map(|(_, node)| node.id.clone()).collect();
        // What another node of the place leads to is no way out of it.
        let leads_out = |gate: &&Gate| {
            gate.is_declared()
                || gate.outer.is_empty()
                || gate.outer.iter().any(|node| self.id(*node).is_some_and(|id| !own.contains(id)))
        };
        let openings: Vec<Opening> = group
            .gates
            .iter()
            .filter(leads_out)
            .filter_map(|gate| self.opening(gate, &|point| label(point) == Some(number)))
            .collect();
        let door = openings.iter().find_map(Opening::door).map(str::to_owned);
        let id = door.or_else(|| own.first().map(ToString::to_string)).unwrap_or_default();
        Enclosure { id, kind: group.kind, nodes: own, openings, walled: !found.cells.is_empty() }
    }

    /// A gate as an opening: its line, moved outward where a node inside would stand on it.
    fn opening(&self, gate: &Gate, own: &dyn Fn(&Point) -> bool) -> Option<Opening> {
        let line = *gate.line()?;
        let across = line.to - line.from;
        let normal = Vector::new(-across.y, across.x).try_normalize(1e-9)?;
        let inner = self.at(gate.inner);
        let toward = if gate.is_declared() {
            let sides = [0.2, 0.4, 0.6].map(|off| (own(&(line.at + normal * off)), own(&(line.at - normal * off))));
            match sides.iter().find(|(left, right)| left != right) {
                Some((left, _)) => {
                    if *left {
                        normal
                    } else {
                        -normal
                    }
                }
                None => inner - line.at,
            }
        } else {
            -line.ahead
        };
        let inward = if normal.dot(&toward) < 0.0 { -normal } else { normal };
        let mut moved = Vector::zeros();
        if !gate.is_declared() {
            let next = gate.outer.first().map(|node| self.at(*node));
            let clear_m = next.map_or(CLEAR_M, |next| CLEAR_M.min((next - inner).norm() / 2.0));
            let depth_m = (inner - line.from).dot(&inward);
            moved = -inward * (clear_m - depth_m).clamp(0.0, THRESHOLD_M);
        }
        Some(Opening {
            from: line.from + moved,
            to: line.to + moved,
            inward,
            width_m: line.width_m,
            across: gate.across.clone(),
        })
    }
}
