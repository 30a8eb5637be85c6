//! Buildings of corridors and rooms: offices, hospitals and homes.

use super::chance::Chance;
use super::corridors::{self, END, Line, Naming};
use super::draft::{Draft, WALL};
use super::rooms::{HOME, HOSPITAL, OFFICE, Template};
use super::shape::{Area, Frame, Side};
use super::skeleton::{
    BEND, BENT_PASSAGE, Block, COMB, CROSS, DOUBLE_COMB, FORKED_PASSAGE, LADDER, LONG_COMB, Laid, PASSAGE, RING, SPINE,
    Skeleton, TEE, TWO_RINGS, Widths,
};
use super::strip::{self, Access, Program};

/// A kind of building with corridors.
#[derive(Debug)]
pub(super) struct Style {
    /// What a description calls it.
    pub(super) words: &'static str,
    pub(super) skeletons: &'static [Skeleton],
    pub(super) widths: Widths,
    pub(super) naming: Naming,
    pub(super) door: (i32, i32),
    pub(super) templates: &'static [Template],
    /// How often it has elevators, percent, and how many at most.
    elevators: (i32, i32),
    /// How often a corridor is parted by a narrow doorway, percent.
    parted_percent: i32,
}

pub(super) const OFFICES: Style = Style {
    words: "One floor of an office building",
    skeletons: &[SPINE, BEND, TEE, CROSS, LADDER, COMB, LONG_COMB, DOUBLE_COMB, RING, TWO_RINGS],
    widths: Widths { corridor: (14, 24), depth: (42, 60), length: (90, 170) },
    naming: Naming {
        corridor: "CORRIDOR",
        narrow: "NARROW CORRIDOR",
        end: "CORRIDOR END",
        exits: &["EXIT", "EXIT", "STAIRS"],
        gap: (29, 40),
    },
    door: (10, 12),
    templates: OFFICE,
    elevators: (50, 2),
    parted_percent: 40,
};

pub(super) const HOSPITALS: Style = Style {
    words: "A hospital floor",
    skeletons: &[SPINE, BEND, TEE, CROSS, LADDER, COMB, DOUBLE_COMB, RING, TWO_RINGS],
    widths: Widths { corridor: (25, 30), depth: (58, 72), length: (100, 160) },
    naming: Naming {
        corridor: "CORRIDOR",
        narrow: "NARROW CORRIDOR",
        end: "CORRIDOR END",
        exits: &["EXIT", "EXIT", "STAIRS"],
        gap: (32, 40),
    },
    door: (11, 14),
    templates: HOSPITAL,
    elevators: (100, 3),
    parted_percent: 0,
};

pub(super) const HOMES: Style = Style {
    words: "A home on one floor",
    skeletons: &[PASSAGE, PASSAGE, BENT_PASSAGE, FORKED_PASSAGE, SPINE],
    widths: Widths { corridor: (12, 16), depth: (30, 44), length: (46, 74) },
    naming: Naming { corridor: "HALLWAY", narrow: "HALLWAY", end: "HALLWAY", exits: &["EXIT"], gap: (24, 34) },
    door: (10, 11),
    templates: HOME,
    elevators: (0, 0),
    parted_percent: 0,
};

/// Draws a building of a style.
pub(super) fn draw(style: &Style, chance: &mut Chance) -> Draft {
    let mut draft = Draft::default();
    let Some(skeleton) = chance.pick(style.skeletons) else { return draft };
    let laid = skeleton.laid(&style.widths, chance);
    let lines = corridors::lay(&laid, &style.naming, &mut draft, chance);
    let mut program = Program::new(style.templates, style.door);
    let mut strips = Vec::new();
    for block in laid.blocks() {
        strips.extend(beside(&laid, &lines, &block, &style.widths));
    }
    let mut slots: Vec<_> = strips
        .iter()
        .map(|(frame, accesses)| (*frame, vec![strip::slots(frame, accesses, style.door, chance)]))
        .collect();
    let cars = if chance.happens(style.elevators.0) { chance.between((1, style.elevators.1)) } else { 0 };
    let cars = lift(&mut slots, cars, &mut program, &mut draft, chance);
    // What lies at the end of a corridor can only be an open room; then the order is drawn, so that the rooms that every
    // building has are not always in the first strip.
    let at_end = |parts: &[Vec<strip::Slot>]| parts.iter().flatten().any(|slot| slot.access.width.is_some());
    while !slots.is_empty() {
        let drawn = usize::try_from(chance.between((0, i32::try_from(slots.len()).unwrap_or(1) - 1))).unwrap_or(0);
        let next = slots.iter().position(|(_, parts)| at_end(parts)).unwrap_or(drawn);
        let (frame, parts) = slots.remove(next.min(slots.len() - 1));
        for part in parts {
            strip::fill(&frame, &part, &mut program, &mut draft, chance);
        }
    }
    let part = chance.happens(style.parted_percent);
    corridors::join(&lines, &style.naming, &mut draft, (part, &program.open), chance);
    let lifts = match cars {
        0 => "",
        1 => ", with an elevator",
        _ => ", with elevators",
    };
    draft.lacks = program.lacks();
    draft.description = format!("{}: {}{lifts}.", style.words, skeleton.words);
    draft
}

/// Takes slots for elevators out of one strip where there is room for them, with fewer cars where there is not; gives the
/// number of cars.
pub(super) fn lift(
    slots: &mut [(Frame, Vec<Vec<strip::Slot>>)],
    cars: i32,
    program: &mut Program<'_>,
    draft: &mut Draft,
    chance: &mut Chance,
) -> i32 {
    for count in (1..=cars).rev() {
        let start = usize::try_from(chance.between((0, 99))).unwrap_or(0);
        for turn in 0..slots.len() {
            let place = (start + turn) % slots.len();
            let Some((frame, parts)) = slots.get_mut(place) else { continue };
            let Some(all) = parts.first().cloned() else { continue };
            let Some((first, last, node)) = strip::elevators(frame, &all, count, draft, chance) else { continue };
            *parts = [all.get(..first), all.get(last + 1..)].into_iter().flatten().map(<[_]>::to_vec).collect();
            program.open.push(node);
            draft.retype_corridor(node);
            return count;
        }
    }
    0
}

/// The strips of a block: one beside its best corridor, or two back to back between two corridors.
pub(super) fn beside(laid: &Laid, lines: &[Line], block: &Block, widths: &Widths) -> Vec<(Frame, Vec<Access>)> {
    let area = block.area;
    let along = |side: Side, area: Area| -> Vec<Access> {
        let frame = Frame::new(area, side);
        let runs = lines.iter().filter(|line| laid.borders(&line.run, block, side));
        let stations = runs.flat_map(|line| line.stations.iter().map(move |station| (line, station)));
        let mut found: Vec<Access> = stations
            .map(|(line, station)| Access {
                u: frame.u_of(station.along),
                before: line.width() / 2 + WALL / 2,
                node: station.node,
                reach: (frame.u_of(laid.span(&line.run).0), frame.u_of(laid.span(&line.run).1)),
                width: None,
            })
            .filter(|access| access.u > 0 && access.u < frame.length())
            .collect();
        found.sort_by_key(|access| access.u);
        found
    };
    let two_deep = 2 * widths.depth.0 + WALL;
    for (one, other) in [(Side::Bottom, Side::Top), (Side::Left, Side::Right)] {
        let deep = if one.along_x() { area.y1 - area.y0 } else { area.x1 - area.x0 };
        if deep < two_deep || deep > 2 * widths.depth.1 + WALL {
            continue;
        }
        let half = (deep - WALL) / 2;
        let (first, second) = if one.along_x() {
            (Area { y1: area.y0 + half, ..area }, Area { y0: area.y0 + half + WALL, ..area })
        } else {
            (Area { x1: area.x0 + half, ..area }, Area { x0: area.x0 + half + WALL, ..area })
        };
        let (near, far) = (along(one, first), along(other, second));
        if !near.is_empty() && !far.is_empty() {
            return vec![(Frame::new(first, one), near), (Frame::new(second, other), far)];
        }
    }
    let sides = Side::ALL.iter().map(|side| (Frame::new(area, *side), along(*side, area)));
    // A strip as deep as a room is wanted; of two, the longer one.
    let best = sides
        .filter(|(_, accesses)| !accesses.is_empty())
        .min_by_key(|(frame, _)| (frame.depth() > widths.depth.1, -frame.length()));
    let at_end = || {
        Side::ALL.iter().find_map(|side| {
            let frame = Frame::new(area, *side);
            lines.iter().find_map(|line| {
                let last = laid.ends_at(&line.run, block, *side)?;
                let station = if last { line.stations.last() } else { line.stations.first() }?;
                let across = (line.sides.0 + line.sides.1) / 2;
                Some((
                    frame,
                    vec![Access {
                        u: frame.u_of(across),
                        before: END + WALL / 2,
                        node: station.node,
                        reach: (0, frame.length()),
                        width: Some(line.width()),
                    }],
                ))
            })
        })
    };
    best.or_else(at_end).into_iter().collect()
}
