//! The lines that somebody crosses who comes out of a room or car, goes in, or stays inside.

use socrates_maps::openings::{Enclosure, Enclosures, Opening};
use socrates_model::geometry::nearest_on_segment;
use socrates_model::{Door, HumanId, Location, NodeId, Point};

use crate::fidelity::doors::{Crossing, crossings, inside_point};
use crate::fidelity::finding::Finding;
use crate::fidelity::signals::Signals;
use crate::tracks::Sample;

/// The lines of a room or car that a clause is about, or one door of it.
pub(super) struct Lines<'s> {
    place: Option<(&'s Enclosures, &'s Enclosure)>,
    /// Each with a point on its inner side.
    doors: Vec<(Door, Point)>,
}

impl<'s> Lines<'s> {
    /// All ways out of a place.
    fn of_place(location: &Location, all: &'s Enclosures, place: &'s Enclosure) -> Self {
        let doors = place.ways_out().into_iter().map(|opening| line(location, place, opening)).collect();
        Self { place: Some((all, place)), doors }
    }

    /// Those of the place that a node lies in.
    fn of_node(signals: &'s Signals<'_>, node: &NodeId) -> Option<Self> {
        let (location, all) = (signals.evidence.location?, signals.enclosures.as_deref()?);
        Some(Self::of_place(location, all, all.of_node(node)?))
    }

    /// The line of a door, or of an opening, by its name.
    fn by_name(signals: &'s Signals<'_>, name: &str) -> Option<Self> {
        let (location, all) = (signals.evidence.location?, signals.enclosures.as_deref()?);
        let of = |place: &'s Enclosure| Some((place, place.openings.iter().find(|opening| opening.name() == name)?));
        if let Some((place, opening)) = all.all().iter().find_map(of) {
            return Some(Self { place: Some((all, place)), doors: vec![line(location, place, opening)] });
        }
        let door = location.door(name)?;
        Some(Self { place: None, doors: vec![(door.clone(), inside_point(door, location)?)] })
    }

    /// Its name, or their names, for texts.
    pub(super) fn name(&self) -> String {
        let names: Vec<String> = self.doors.iter().map(|(door, _)| format!("`{}`", door.id)).collect();
        names.join(" or ")
    }

    /// How far a point lies behind the nearest line, m; negative outside.
    pub(super) fn depth_m(&self, at: &Point) -> f64 {
        let far = |door: &Door| nearest_on_segment(at, &door.from, &door.to).0;
        let nearest = self.doors.iter().min_by(|a, b| far(&a.0).total_cmp(&far(&b.0)));
        let Some((door, inside)) = nearest else { return f64::NEG_INFINITY };
        let depth_m = door.depth_m(at, inside);
        match self.place {
            // A room may run on beside its own door, and a corridor behind it.
            Some((all, place)) if all.holds(place, at) != (depth_m > 0.0) => {
                if depth_m > 0.0 {
                    -far(door)
                } else {
                    far(door)
                }
            }
            Some(_) | None => depth_m,
        }
    }

    /// Who goes through when, over all lines, in time order, each with the name of its line.
    pub(super) fn crossings(&self, samples: &[Sample]) -> Vec<(Crossing, &str)> {
        let of = |(door, inside): &'_ (Door, Point)| crossings(door, inside, samples);
        let mut found: Vec<(Crossing, &str)> = self
            .doors
            .iter()
            .flat_map(|line| of(line).into_iter().map(|crossing| (crossing, line.0.id.as_str())))
            .collect();
        found.sort_by(|a, b| a.0.t.total_cmp(&b.0.t));
        found
    }

    /// When the first of its declared doors opens that does not stand open, s; `None` where none ever does.
    pub(super) fn first_open(&self, signals: &Signals<'_>) -> Option<(&Door, f64)> {
        let doors = self.doors.iter().map(|(door, _)| door).filter(|door| !signals.doors.stands_open(&door.id));
        let opened = doors.filter_map(|door| Some((door, signals.doors.first_open_s(&door.id)?)));
        opened.min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Its declared doors.
    pub(super) fn declared(&self, location: &Location) -> Vec<&Door> {
        self.doors.iter().map(|(door, _)| door).filter(|door| location.door(&door.id).is_some()).collect()
    }
}

/// An opening as a door, with a point on its inner side.
fn line(location: &Location, place: &Enclosure, opening: &Opening) -> (Door, Point) {
    (place.door(opening, location), opening.middle() + opening.inward)
}

/// The lines that a clause means, or why there are none: those of a door by its name; of the place that a human's way begins in; without a
/// human, of the first place among the encounters, the robot's last node, and where people begin.
pub(super) fn lines_of<'s>(signals: &'s Signals<'_>, door: &str, human: Option<HumanId>) -> Result<Lines<'s>, Finding> {
    let Some(place) = signals.evidence.location else {
        return Err(Finding::not_applicable("there is no map, so there are no doors"));
    };
    if !door.is_empty() {
        return Lines::by_name(signals, door).ok_or_else(|| Finding::not_applicable(unknown(place, door)));
    }
    let Some(paths) = signals.evidence.paths else {
        return Err(Finding::not_applicable(missing(signals, place, None)));
    };
    let first = |id: HumanId| paths.humans.get(&id).and_then(|nodes| nodes.first());
    if let Some(id) = human {
        let found = first(id).and_then(|node| Lines::of_node(signals, node));
        return found.ok_or_else(|| Finding::not_applicable(missing(signals, place, first(id))));
    }
    let meetings = paths.encounters.iter().map(|encounter| &encounter.node);
    let starts = paths.humans.values().filter_map(|nodes| nodes.first());
    let mut nodes = meetings.chain(paths.robot.last()).chain(starts);
    let found = nodes.find_map(|node| Lines::of_node(signals, node));
    found.ok_or_else(|| Finding::not_applicable(missing(signals, place, None)))
}

/// The lines of the place of a node; where it lies in none, those that a clause without a name means.
pub(super) fn from_node<'s>(signals: &'s Signals<'_>, node: Option<&NodeId>) -> Result<Lines<'s>, Finding> {
    node.and_then(|node| Lines::of_node(signals, node)).map_or_else(|| lines_of(signals, "", None), Ok)
}

/// The lines that a human's way leads in through: those of the place of its last node, else of the nearest declared door.
pub(super) fn destination<'s>(signals: &'s Signals<'_>, human: HumanId) -> Result<Lines<'s>, Finding> {
    let way = signals.evidence.paths.and_then(|paths| paths.humans.get(&human));
    let Some((place, last)) = signals.evidence.location.zip(way.and_then(|way| way.last())) else {
        return lines_of(signals, "", Some(human));
    };
    if let Some(found) = Lines::of_node(signals, last) {
        return Ok(found);
    }
    let near = signals
        .node(last)
        .and_then(|at| place.doors.iter().min_by(|a, b| (a.middle() - at).norm().total_cmp(&(b.middle() - at).norm())));
    near.map_or_else(
        || Err(Finding::not_applicable(missing(signals, place, Some(last)))),
        |door| lines_of(signals, &door.id, None),
    )
}

fn unknown(place: &Location, door: &str) -> String {
    if place.doors.is_empty() {
        return format!("the map `{}` declares no doors", place.name);
    }
    match place.door(door) {
        Some(found) => format!("the door `{}` names no node behind it", found.id),
        None => format!("no door `{door}`; the map has {}", names(place)),
    }
}

/// Why a node lies behind no line.
fn missing(signals: &Signals<'_>, place: &Location, node: Option<&NodeId>) -> String {
    let open = signals.enclosures.as_deref().map_or(&[][..], Enclosures::open_plan);
    let why = node.and_then(|node| Some((node, open.iter().find(|(nodes, _)| nodes.contains(node))?)));
    match why {
        Some((node, (_, why))) => format!("`{node}` lies in no room or car: {why}"),
        None if place.doors.is_empty() => format!("the map `{}` declares no doors", place.name),
        None => format!("no door belongs to the clause; the map has {}", names(place)),
    }
}

fn names(place: &Location) -> String {
    place.doors.iter().map(|door| door.id.as_str()).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::fixture::{floor, node};

    /// A room that runs on in front of its own door: an L round the end of the corridor; its opening faces +x.
    fn bent() -> Location {
        floor(
            &[
                (0.0, 1.0, 6.0, 1.2),
                (6.0, 0.6, 6.2, 1.2),
                (6.0, -1.2, 6.2, -0.6),
                (0.0, -1.2, 6.0, -1.0),
                (-0.2, 1.0, 0.0, 6.0),
                (-0.2, 6.0, 10.0, 6.2),
                (10.0, -1.2, 10.2, 6.2),
                (6.0, -1.4, 10.2, -1.2),
            ],
            &[("r", "ROOM", 8., 0.), ("q", "ROOM", 2., 4.), ("c", "CORRIDOR", 3., 0.), ("e", "CORRIDOR", -8., 0.)],
            &[("r", "c"), ("c", "e"), ("r", "q")],
        )
    }

    #[test]
    fn a_room_is_inside_also_where_it_runs_on_in_front_of_its_door() {
        let place = bent();
        let all: Arc<Enclosures> = Enclosures::of(&place);
        let room = all.of_node(&node("r")).unwrap();
        let lines = Lines::of_place(&place, &all, room);
        assert_eq!(lines.doors.len(), 1, "{:?}", room.openings);
        for (x, y, inside) in [(8.0, 0.0, true), (2.0, 4.0, true), (3.0, 0.0, false), (-8.0, 0.0, false)] {
            let depth_m = lines.depth_m(&Point::new(x, y));
            assert_eq!(depth_m > 0.0, inside, "({x}, {y}): {depth_m}");
        }
    }
}
