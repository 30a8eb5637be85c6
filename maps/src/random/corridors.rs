//! Corridors with their nodes: junctions, ends, and stations between them from which doors lead off.

use std::collections::BTreeMap;

use super::chance::Chance;
use super::draft::{Draft, NodeAt};
use super::shape::{Area, Spot};
use super::skeleton::{Laid, Run};

/// From the last node of a corridor to the wall at its end, tenths.
pub(super) const END: i32 = 13;
/// A dead end longer than this has an exit at its end, tenths.
const DEAD_END: i32 = 70;
/// A corridor up to this wide is narrow, tenths.
const NARROW: i32 = 15;

/// Least width of a corridor with a doorway across it, tenths: 0.3 m of wall beside 1.1 m.
const PARTED: i32 = 17;

/// How corridors of a kind of building are called and how far apart their stations are.
#[derive(Debug, Clone, Copy)]
pub(super) struct Naming {
    pub(super) corridor: &'static str,
    pub(super) narrow: &'static str,
    /// Type of a dead end.
    pub(super) end: &'static str,
    /// Types of the ways out.
    pub(super) exits: &'static [&'static str],
    /// Distance of neighboring stations, tenths.
    pub(super) gap: (i32, i32),
}

/// A node of a corridor.
#[derive(Debug, Clone, Copy)]
pub(super) struct Station {
    /// Where along the corridor, tenths.
    pub(super) along: i32,
    pub(super) node: NodeAt,
    /// Whether another corridor meets here.
    pub(super) crossing: bool,
}

/// A straight corridor.
#[derive(Debug)]
pub(super) struct Line {
    pub(super) run: Run,
    /// Its long sides, tenths.
    pub(super) sides: (i32, i32),
    pub(super) stations: Vec<Station>,
}

impl Line {
    pub(super) const fn width(&self) -> i32 {
        self.sides.1 - self.sides.0
    }

    const fn middle(&self) -> i32 {
        (self.sides.0 + self.sides.1) / 2
    }

    const fn spot(&self, along: i32, across: i32) -> Spot {
        if self.run.along_x { Spot { x: along, y: across } } else { Spot { x: across, y: along } }
    }
}

/// Lays floors and nodes of every corridor; [`join`] adds the ways once the rooms are there.
pub(super) fn lay(laid: &Laid, naming: &Naming, draft: &mut Draft, chance: &mut Chance) -> Vec<Line> {
    let runs = laid.runs();
    let mut junctions: BTreeMap<(usize, usize), NodeAt> = BTreeMap::new();
    let mut lines = Vec::new();
    let mut exits = 0;
    for run in runs {
        let mut line = Line { run, sides: laid.sides(&run), stations: Vec::new() };
        let (from, to) = laid.span(&run);
        draft.floor(Area::between(line.spot(from, line.sides.0), line.spot(to, line.sides.1)));
        let mut fixed: Vec<Station> = Vec::new();
        for (cell, along, degree) in laid.crossings(&run) {
            let at = line.spot(along, line.middle());
            let node = *junctions.entry(cell).or_insert_with(|| {
                let id = draft.name("c");
                if degree == 2 { draft.bend(id, at) } else { draft.node(id, "INTERSECTION", at) }
            });
            // The middle of a corridor of odd width is rounded: both corridors share one node.
            let along = draft.at(node).map_or(along, |at| if run.along_x { at.x } else { at.y });
            fixed.push(Station { along, node, crossing: true });
        }
        for (last, end) in [(false, from), (true, to)] {
            let inward = if last { end - END } else { end + END };
            let nearest = fixed.iter().map(|station| (station.along - end).abs()).min().unwrap_or(i32::MAX);
            // A corridor that ends at a crossing has its last node there.
            if nearest <= line.width().max(20) {
                continue;
            }
            let outside = laid.past(&run, last) == '.';
            let leaves = outside && (exits < 2 || nearest > DEAD_END || chance.happens(60));
            let kind = match (outside, leaves) {
                (true, true) => chance.pick(naming.exits).copied().unwrap_or("EXIT"),
                (true, false) => naming.end,
                (false, _) => naming.corridor,
            };
            exits += i32::from(leaves);
            let id = draft.name(if leaves { "x" } else { "c" });
            let node = draft.node(id, kind, line.spot(inward, line.middle()));
            fixed.push(Station { along: inward, node, crossing: false });
        }
        fixed.sort_by_key(|station| station.along);
        fill(&mut line, &fixed, naming, draft, chance);
        lines.push(line);
    }
    lines
}

/// Puts stations between the fixed nodes of a corridor.
fn fill(line: &mut Line, fixed: &[Station], naming: &Naming, draft: &mut Draft, chance: &mut Chance) {
    let kind = type_of(line, naming);
    for (place, station) in fixed.iter().enumerate() {
        line.stations.push(*station);
        let Some(next) = fixed.get(place + 1) else { continue };
        let (least, most) = naming.gap;
        let long = next.along - station.along;
        let (few, many) = ((long + most - 1) / most, long / least);
        let parts = chance.between((few, many.max(few))).max(1);
        for part in 1..parts {
            let sway = if long / parts >= least + 4 { chance.between((-2, 2)) } else { 0 };
            let along = station.along + long * part / parts + sway;
            let id = draft.name("c");
            let node = draft.node(id, kind, line.spot(along, line.middle()));
            line.stations.push(Station { along, node, crossing: false });
        }
    }
}

fn type_of(line: &Line, naming: &Naming) -> &'static str {
    if line.width() <= NARROW { naming.narrow } else { naming.corridor }
}

/// A wall with a doorway across a corridor, between two stations that are no crossing and of which neither is in `open`.
fn parted(line: &Line, open: &[NodeAt], draft: &mut Draft, chance: &mut Chance) -> Option<(usize, NodeAt)> {
    let free = |station: &Station| !station.crossing && !open.contains(&station.node);
    let places: Vec<(usize, i32)> = line
        .stations
        .windows(2)
        .enumerate()
        .filter_map(|(place, pair)| match pair {
            [a, b] if free(a) && free(b) && b.along - a.along >= 28 => Some((place, (a.along + b.along) / 2)),
            _ => None,
        })
        .collect();
    let (place, along) = *chance.pick(&places)?;
    let wide = chance.between((10, 11));
    let from = line.middle() - wide / 2;
    draft.wall(line.spot(along, line.sides.0), line.spot(along, line.sides.1));
    draft.opening(line.spot(along, from), line.spot(along, from + wide));
    let id = draft.name("n");
    Some((place, draft.node(id, "NARROW DOORWAY", line.spot(along, from + wide / 2))))
}

/// Adds the ways along the corridors, with a narrow doorway across one of them where `part` says so.
///
/// `open` are stations with an opening so wide that no wall can stand beside it.
pub(super) fn join(
    lines: &[Line],
    naming: &Naming,
    draft: &mut Draft,
    (part, open): (bool, &[NodeAt]),
    chance: &mut Chance,
) {
    let wide: Vec<usize> =
        (0..lines.len()).filter(|at| lines.get(*at).is_some_and(|line| line.width() >= PARTED)).collect();
    let chosen = if part { chance.pick(&wide).copied() } else { None };
    for (at, line) in lines.iter().enumerate() {
        let kind = type_of(line, naming);
        // A dead end without a room is a way out.
        for station in line.stations.first().into_iter().chain(line.stations.last()) {
            if !station.crossing && draft.is_of(station.node, naming.end) && draft.leads_nowhere(station.node) {
                draft.retype(station.node, chance.pick(naming.exits).copied().unwrap_or("EXIT"));
            }
        }
        let nodes: Vec<NodeAt> = line.stations.iter().map(|station| station.node).collect();
        let cut = if chosen == Some(at) { parted(line, open, draft, chance) } else { None };
        let Some((place, door)) = cut else {
            draft.edge(kind, &nodes);
            continue;
        };
        let (before, after) = nodes.split_at((place + 1).min(nodes.len()));
        draft.edge(kind, before);
        if let (Some(from), Some(to)) = (before.last(), after.first()) {
            draft.edge("NARROW DOORWAY", &[*from, door, *to]);
        }
        draft.edge(kind, after);
    }
}
