//! Rooms in a row beside a corridor: where the walls between them stand, what they are, their doors and nodes.

use std::collections::BTreeMap;

use super::chance::Chance;
use super::draft::{Draft, NodeAt, Opens, WALL};
use super::furnish::Furnished;
use super::rooms::Template;
use super::shape::{Frame, Spot};

/// From a door's edge to the nearest wall across, tenths.
const CORNER: i32 = 3;
/// How far inside its door the first node of a room lies, tenths.
const INSIDE: i32 = 12;
/// From a node of a room to the nearest wall, tenths.
const CLEAR: i32 = 8;
/// How many times as long as wide a room may be, in tenths: 2.5.
const ASPECT_TENTHS: i32 = 25;
/// At most so many stations belong to one room.
const MOST_SLOTS: usize = 5;

/// A node in the corridor from which a door may lead off, as seen from the strip.
#[derive(Debug, Clone, Copy)]
pub(super) struct Access {
    /// Where along the strip, tenths.
    pub(super) u: i32,
    /// How far before the strip's wall face it stands, tenths.
    pub(super) before: i32,
    pub(super) node: NodeAt,
    /// From where to where the floor before the strip goes along it, tenths.
    pub(super) reach: (i32, i32),
    /// Width of the opening where the strip lies at the end of a corridor: all of the corridor's.
    pub(super) width: Option<i32>,
}

impl Access {
    /// Half the width of the widest opening here, tenths, with wall beside it on both sides, in a room between two walls.
    fn half(&self, (from, to): (i32, i32)) -> i32 {
        (self.u - from.max(self.reach.0)).min(to.min(self.reach.1) - self.u) - CORNER
    }
}

/// A piece of a strip with one access.
#[derive(Debug, Clone, Copy)]
pub(super) struct Slot {
    pub(super) from: i32,
    pub(super) to: i32,
    pub(super) access: Access,
}

/// What the rooms of a building are drawn from, and which there are already.
#[derive(Debug)]
pub(super) struct Program<'a> {
    templates: &'a [Template],
    pub(super) door: (i32, i32),
    counts: BTreeMap<String, usize>,
    /// Corridor nodes with an opening wider than a door.
    pub(super) open: Vec<NodeAt>,
}

impl<'a> Program<'a> {
    pub(super) const fn new(templates: &'a [Template], door: (i32, i32)) -> Self {
        Self { templates, door, counts: BTreeMap::new(), open: Vec::new() }
    }

    fn count(&self, template: &Template) -> usize {
        self.counts.get(template.kind.as_ref()).copied().unwrap_or(0)
    }

    /// Whether a room that every building of the kind has is not there.
    pub(super) fn lacks(&self) -> bool {
        self.templates.iter().any(|template| template.needed && self.count(template) == 0)
    }

    /// How much a template is wanted for a room of this area, m².
    fn wish(&self, template: &Template, access: Access, area_m2: i32) -> i32 {
        let (least, most) = template.area_m2;
        if access.width.is_some() && !template.open {
            return 0;
        }
        if area_m2 < least || area_m2 > most || self.count(template) >= template.most {
            return 0;
        }
        if template.needed && self.count(template) == 0 { template.weight * 20 } else { template.weight * 4 }
    }

    /// How badly a template suits where none fits, m²: what the area lacks or has too much, and 20 for each room of the
    /// type over the most.
    fn misfit(&self, template: &Template, area_m2: i32) -> i32 {
        let (least, most) = template.area_m2;
        let more = (self.count(template) + 1).saturating_sub(template.most);
        (least - area_m2).max(area_m2 - most).max(0) + 20 * i32::try_from(more).unwrap_or(i32::MAX / 40)
    }
}

/// Cuts a strip between the stations from which a door of any width can lead.
pub(super) fn slots(frame: &Frame, accesses: &[Access], door: (i32, i32), chance: &mut Chance) -> Vec<Slot> {
    let length = frame.length();
    let half = (door.1 + 1) / 2;
    let need = CORNER + half;
    let mut usable: Vec<Access> = Vec::new();
    for access in accesses.iter().filter(|access| access.half((0, length)) >= half) {
        let near = usable.last().is_some_and(|last: &Access| access.u - last.u < 2 * need + WALL);
        if !near {
            usable.push(*access);
        }
    }
    let mut out = Vec::new();
    let mut from = 0;
    for (place, access) in usable.iter().enumerate() {
        let to = match usable.get(place + 1) {
            Some(next) => {
                let slack = (next.u - access.u - 2 * need - WALL) / 2;
                let sway = chance.between((-slack.min(3), slack.min(3)));
                (access.u + next.u) / 2 + sway
            }
            None => length + WALL / 2,
        };
        out.push(Slot { from, to: to - WALL / 2, access: *access });
        from = to + WALL / 2;
    }
    out
}

/// Fills slots that lie in a row with rooms.
pub(super) fn fill(frame: &Frame, slots: &[Slot], program: &mut Program<'_>, draft: &mut Draft, chance: &mut Chance) {
    let depth = frame.depth();
    let mut rest = slots;
    while let Some(first) = rest.first() {
        let mut choices: Vec<(usize, &Template, i32)> = Vec::new();
        let mut weights = Vec::new();
        for count in 1..=rest.len().min(MOST_SLOTS) {
            let Some(last) = rest.get(count - 1) else { break };
            let wide = last.to - first.from;
            let slim = wide * ASPECT_TENTHS < depth * 10 || depth * ASPECT_TENTHS < wide * 10;
            if slim && count > 1 {
                break;
            }
            if slim && rest.len() > 1 {
                continue;
            }
            let area_m2 = wide * depth / 100;
            for template in program.templates {
                choices.push((count, template, program.misfit(template, area_m2)));
                weights.push(program.wish(template, first.access, area_m2));
            }
        }
        if choices.is_empty() {
            // Whatever is chosen is slim.
            choices.extend(
                program
                    .templates
                    .iter()
                    .map(|template| (1, template, program.misfit(template, (first.to - first.from) * depth / 100))),
            );
        }
        let drawn = chance.weighted(&weights).and_then(|at| choices.get(at));
        let Some((count, template, _)) = drawn.or_else(|| choices.iter().min_by_key(|(_, _, misfit)| *misfit)) else {
            return;
        };
        let (group, after) = rest.split_at((*count).min(rest.len()));
        room(frame, group, template, program, draft, chance);
        rest = after;
    }
}

/// Builds one room over a group of slots.
pub(super) fn room(
    frame: &Frame,
    group: &[Slot],
    template: &Template,
    program: &mut Program<'_>,
    draft: &mut Draft,
    chance: &mut Chance,
) {
    let (Some(first), Some(last)) = (group.first(), group.last()) else { return };
    let (u0, u1) = (first.from, last.to);
    let depth = frame.depth();
    draft.floor(frame.area((u0, u1), (0, depth)));
    *program.counts.entry(template.kind.to_string()).or_insert(0) += 1;
    let entrance = if template.open { group.get(group.len() / 2) } else { chance.pick(group) };
    let Some(access) = entrance.map(|slot| slot.access) else { return };
    let around = 2 * access.half((u0, u1));
    let wide = if template.open { chance.between((18, 36)).min(around) } else { 0 };
    let open = wide >= 16 || access.width.is_some();
    let wide = match access.width {
        Some(all) => all,
        None if open => wide,
        None => chance.between(template.door.unwrap_or(program.door)).min(around),
    };
    let line = (access.u - wide / 2, access.u - wide / 2 + wide);
    let ends = (frame.spot(line.0, -1), frame.spot(line.1, -1));
    draft.opening(ends.0, ends.1);
    let stem = draft.name("r");
    let ways = Inside { frame: *frame, template, range: (u0, u1), stem: &stem }.nodes(access, open, draft, chance);
    if open {
        program.open.push(access.node);
        draft.retype_corridor(access.node);
    } else if access.before >= 9 && chance.happens(template.door_percent) {
        let name = template.kind.to_lowercase().replace([' ', '-'], "_");
        let id = format!("{name}_{}", program.count(template));
        draft.door(id, ends, Opens::Near((access.before - 1).min(12)), ways.nodes.clone());
    }
    draft.made(&template.kind, frame.area((u0, u1), (0, depth)), &ways.nodes);
    // The room's own frame: from its corner, so that furniture knows its walls.
    let own = frame.part((u0, u1));
    let mut kept: Vec<(Spot, Spot)> = ways.lines;
    kept.push((frame.spot(line.0, 0), frame.spot(line.1, INSIDE - 2)));
    Furnished::new(own, &kept, draft).furnish(template.furniture);
}

/// The nodes of a room and the lines between them.
struct Ways {
    nodes: Vec<NodeAt>,
    lines: Vec<(Spot, Spot)>,
}

/// A room whose nodes are to be made.
struct Inside<'a> {
    frame: Frame,
    template: &'a Template,
    /// From its left to its right wall.
    range: (i32, i32),
    stem: &'a str,
}

impl Inside<'_> {
    /// A node behind the door; in larger rooms one deeper inside and a row across.
    fn nodes(&self, access: Access, open: bool, draft: &mut Draft, chance: &mut Chance) -> Ways {
        let (u, depth) = (access.u, self.frame.depth());
        let mut ways = Ways { nodes: Vec::new(), lines: Vec::new() };
        let near = INSIDE.min(depth / 2);
        let first = self.add((u, near), draft, &mut ways);
        let way = if open { "OPEN AREA" } else { "DOORWAY" };
        if open {
            draft.edge(way, &[access.node, first]);
        } else {
            let id = format!("{}d", self.stem);
            let door = draft.node(id, "DOORWAY", self.frame.spot(u, -1));
            draft.edge(way, &[access.node, door, first]);
        }
        ways.lines.push((self.frame.spot(u, 0), self.frame.spot(u, near)));
        let inner = if open { "OPEN AREA" } else { "ROOM" };
        let area_m2 = (self.range.1 - self.range.0) * depth / 100;
        let mut middle = (first, near);
        let deep = depth - CLEAR - 6;
        if depth >= 42 && deep - near >= 16 && (area_m2 >= 24 || chance.happens(40)) {
            let v = (near + chance.between((22, 34))).min(deep);
            let second = self.add((u, v), draft, &mut ways);
            draft.edge(inner, &[first, second]);
            ways.lines.push((self.frame.spot(u, near), self.frame.spot(u, v)));
            if open || chance.happens(50) {
                middle = (second, v);
            }
        }
        if area_m2 >= 18 {
            self.row((u, middle), inner, draft, &mut ways);
        }
        ways
    }

    /// Nodes to the left and right of a node, as far as the room goes.
    fn row(&self, (u, (from, v)): (i32, (NodeAt, i32)), kind: &str, draft: &mut Draft, ways: &mut Ways) {
        for (side, wall) in [(-1, self.range.0), (1, self.range.1)] {
            let far = (wall - u).abs() - CLEAR;
            let steps = (far + 37) / 38;
            if far < 18 {
                continue;
            }
            let mut row = vec![from];
            for step in 1..=steps {
                let at = u + side * far * step / steps;
                row.push(self.add((at, v), draft, ways));
            }
            draft.edge(kind, &row);
            ways.lines.push((self.frame.spot(u, v), self.frame.spot(u + side * far, v)));
        }
    }

    fn add(&self, (u, v): (i32, i32), draft: &mut Draft, ways: &mut Ways) -> NodeAt {
        let letter = char::from_u32(u32::from(b'a') + u32::try_from(ways.nodes.len()).unwrap_or(0)).unwrap_or('z');
        let node =
            draft.node(format!("{}{}", self.stem, skip_door(letter)), &self.template.kind, self.frame.spot(u, v));
        ways.nodes.push(node);
        node
    }
}

/// The letter `d` is the door's: letters from it on move by one.
fn skip_door(letter: char) -> char {
    if letter < 'd' { letter } else { char::from_u32(u32::from(letter) + 1).unwrap_or(letter) }
}

/// A lobby with cars behind it, in some slots of a strip.
///
/// Gives the slots before and after those it took; nothing where there is no room for it.
pub(super) fn elevators(
    frame: &Frame,
    slots: &[Slot],
    cars: i32,
    draft: &mut Draft,
    chance: &mut Chance,
) -> Option<(usize, usize, NodeAt)> {
    let depth = frame.depth();
    // The lobby is at least one and a half times as deep as a car.
    let car_deep = ((depth - WALL) * 2 / 5).min(26);
    if car_deep < 21 {
        return None;
    }
    let car_wide = chance.between((21, 25));
    let need = cars * (car_wide + WALL) + 6;
    let mut windows = Vec::new();
    for first in 0..slots.len() {
        let fits = (first..slots.len()).find(|last| width(slots, first, *last) >= need);
        windows.extend(fits.filter(|last| width(slots, first, *last) <= need + 45).map(|last| (first, last)));
    }
    let (first, last) = *chance.pick(&windows)?;
    let group = slots.get(first..=last)?;
    let (u0, u1) = (group.first()?.from, group.last()?.to);
    let access = group.get(group.len() / 2)?.access;
    let lobby = depth - WALL - car_deep;
    draft.floor(frame.area((u0, u1), (0, lobby)));
    let around = 2 * access.half((u0, u1));
    let wide = chance.between((20, 36)).min(around);
    draft.opening(frame.spot(access.u - wide / 2, -1), frame.spot(access.u - wide / 2 + wide, -1));
    let id = draft.name("l");
    let entry = draft.node(id, "ELEVATOR LOBBY", frame.spot(access.u, INSIDE));
    draft.edge("ELEVATOR LOBBY", &[access.node, entry]);
    let start = u0 + (u1 - u0 - cars * (car_wide + WALL) + WALL) / 2;
    let mut before: Option<NodeAt> = None;
    for (car, letter) in (0..cars).zip(["A", "B", "C", "D"]) {
        let left = start + car * (car_wide + WALL);
        let middle = left + car_wide / 2;
        let floor = frame.area((left, left + car_wide), (lobby + WALL, depth));
        draft.floor(floor);
        let door = (frame.spot(middle - 6, lobby + 1), frame.spot(middle + 6, lobby + 1));
        draft.opening(door.0, door.1);
        let small = letter.to_lowercase();
        let front = draft.node(format!("l{small}"), "ELEVATOR LOBBY", frame.spot(middle, lobby - 13));
        draft.edge("ELEVATOR LOBBY", &[entry, front]);
        if let Some(before) = before {
            draft.edge("ELEVATOR LOBBY", &[before, front]);
        }
        before = Some(front);
        let kind = format!("IN ELEVATOR {letter}");
        let far = car_wide / 2 - 6;
        let places = [(middle, lobby + WALL + 8), (middle - far, depth - 6), (middle + far, depth - 6)];
        let inside: Vec<NodeAt> = places
            .iter()
            .zip(1..)
            .map(|((u, v), count)| draft.node(format!("e{small}{count}"), &kind, frame.spot(*u, *v)))
            .collect();
        if let [near, one, other] = inside.as_slice() {
            draft.edge("ELEVATOR DOORWAY", &[front, *near]);
            draft.edge(&kind, &[*one, *near, *other]);
        }
        draft.door(format!("elevator_{small}"), door, Opens::Elevator, inside);
    }
    Some((first, last, access.node))
}

fn width(slots: &[Slot], first: usize, last: usize) -> i32 {
    match (slots.get(first), slots.get(last)) {
        (Some(first), Some(last)) => last.to - first.from,
        _ => 0,
    }
}
