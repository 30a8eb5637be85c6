//! Buildings with what a brief asks for: its rooms in a drawn skeleton, and what is left over filled with others.
//!
//! ```text
//! brief ─► rows of templates ─► for sizes from small to large, some draws each: skeleton ─► lobby ─► chains of rooms into strips
//!        ─► the first draw with everything, or what the best of them lacks
//! ```
//!
//! Rooms that are to share a wall are placed as a chain, one beside the other in a strip. Nothing is changed silently: a building
//! has what was asked, or there is none and each thing that is missing is named.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;
use socrates_model::building::same;
use socrates_model::{BuildingBrief, BuildingKind, CorridorForm, Fault, Location, PlaceClass, RoomBrief, Unmet};

use super::chance::Chance;
use super::corridors;
use super::draft::{Draft, MadeRoom, NodeAt};
use super::floors::{self, HOMES, HOSPITALS, OFFICES, Style};
use super::rooms::{Furniture, Template};
use super::shape::Frame;
use super::skeleton::{self, Skeleton, Widths};
use super::strip::{self, Program, Slot};
use super::widths::{Remark, remarks};
use crate::generate::made;

/// Lengths of corridors between their crossings, of those that a kind of building usually has, percent: from small buildings to large.
const SIZES: [(i32, i32); 6] = [(45, 70), (60, 90), (80, 110), (100, 140), (130, 190), (180, 260)];
/// Draws of each size.
const DRAWS: u32 = 60;
/// In a building for which no form is asked, at most so many rooms per asked room are others, and this many more.
const OTHERS: (usize, usize) = (1, 4);
/// How much an area may differ from one that a type of room usually has, where none is asked, percent.
const USUAL: (i32, i32) = (100, 130);
/// At most so many stations belong to one room.
const MOST_SLOTS: usize = 7;
/// How many times as long as wide a room may be, in tenths.
const ASPECT_TENTHS: i32 = 30;

/// A building that was made.
#[derive(Debug, Clone)]
pub struct Built {
    /// Its folder's files by name, the floor plan included.
    pub files: BTreeMap<String, Vec<u8>>,
    /// The location that they hold.
    pub location: Location,
    /// Its rooms, those that were asked for first.
    pub rooms: Vec<BuiltRoom>,
    /// Types of rooms that nobody asked for.
    pub others: Vec<String>,
    /// What a building of its kind should have otherwise.
    pub remarks: Vec<Remark>,
}

/// A room of a building.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BuiltRoom {
    /// Type of its nodes.
    pub kind: String,
    /// Its floor, m².
    pub area_m2: f64,
    /// The node behind its doorway.
    pub node: String,
}

/// Why there is no building.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub enum NotBuilt {
    /// What of the brief cannot be met, or was not in any draw.
    Unmet(Vec<Unmet>),
    /// A flaw of the drawn plan; none is known.
    Flawed(Vec<Fault>),
}

/// Builds what a brief asks for; the same brief and seed give the same bytes.
///
/// # Errors
/// Everything that cannot be met: what, what was asked, and what there would be.
pub fn build(brief: &BuildingBrief, seed: u64) -> Result<Built, NotBuilt> {
    let problems = brief.problems();
    if !problems.is_empty() {
        return Err(NotBuilt::Unmet(problems));
    }
    let style = style(brief.kind);
    let asked: Vec<Asked<'_>> = brief.rooms.iter().map(|room| Asked::of(room, style)).collect();
    let mut chance = Chance::new(seed, &format!("brief {}", brief.kind.name()));
    let mut best: Option<Vec<Unmet>> = None;
    for (size, strict) in [true, false].into_iter().flat_map(|strict| SIZES.map(|size| (size, strict))) {
        for _ in 0..DRAWS {
            let Some(attempt) = Attempt::draw(brief, style, &asked, size, &mut chance) else { continue };
            if attempt.unmet.is_empty() && (!strict || brief.form.is_some() || attempt.is_modest(brief)) {
                return attempt.built(brief, seed, &mut chance);
            }
            let fewer = best.as_ref().is_none_or(|best| attempt.unmet.len() < best.len());
            if fewer && !attempt.unmet.is_empty() {
                best = Some(attempt.unmet);
            }
        }
    }
    Err(NotBuilt::Unmet(best.unwrap_or_else(|| {
        let form = brief.form.map_or("any form", CorridorForm::name);
        vec![Unmet::new("form", form, format!("no corridors of a {} can be laid so", brief.kind.name()))]
    })))
}

const fn style(kind: BuildingKind) -> &'static Style {
    match kind {
        BuildingKind::Office => &OFFICES,
        BuildingKind::Hospital => &HOSPITALS,
        BuildingKind::Home => &HOMES,
    }
}

/// Skeletons of a form.
fn skeletons(form: CorridorForm) -> &'static [Skeleton] {
    match form {
        CorridorForm::Spine => &[skeleton::SPINE],
        CorridorForm::Bend => &[skeleton::BEND],
        CorridorForm::Tee => &[skeleton::TEE],
        CorridorForm::Cross => &[skeleton::CROSS],
        CorridorForm::Wings => &[skeleton::LADDER],
        CorridorForm::Comb => &[skeleton::COMB, skeleton::LONG_COMB, skeleton::DOUBLE_COMB],
        CorridorForm::Ring => &[skeleton::RING],
        CorridorForm::TwoRings => &[skeleton::TWO_RINGS],
    }
}

/// A length in tenths.
#[expect(clippy::cast_possible_truncation, reason = "a brief is checked first")]
fn tenths(m: f64) -> i32 {
    libm::round(m * 10.0) as i32
}

/// A row of a brief with the template of its rooms.
struct Asked<'a> {
    room: &'a RoomBrief,
    template: Template,
}

impl<'a> Asked<'a> {
    fn of(room: &'a RoomBrief, style: &Style) -> Self {
        let word = room.kind.trim().to_uppercase();
        let known = style.templates.iter().find(|template| is_called(&template.kind, &word));
        let mut template = match known {
            Some(known) => known.clone(),
            None => unknown(&word),
        };
        if let Some([least, most]) = room.area_m2 {
            template.area_m2 = (tenths(least) / 10, (tenths(most) + 9) / 10);
        } else if known.is_some() {
            let (least, most) = template.area_m2;
            template.area_m2 = (least * USUAL.0 / 100, most * USUAL.1 / 100);
        }
        if let Some(open) = room.open {
            template.open = open;
        }
        template.door = room.door_m.map(tenths).map(|wide| (wide, wide));
        template.most = usize::MAX;
        Self { room, template }
    }
}

/// Whether a type of ours is what a word means: `WARD` for a ward, `OFFICE ROOM` for an office.
fn is_called(kind: &str, word: &str) -> bool {
    let bare = |text: &str| text.trim_end_matches(" ROOM").trim_end_matches(" AREA").replace('-', " ");
    bare(kind) == bare(word)
}

/// A template for a type that no building of its kind usually has.
fn unknown(word: &str) -> Template {
    let inside = matches!(PlaceClass::of_type(word), PlaceClass::Room);
    let open = matches!(PlaceClass::of_type(word), PlaceClass::OpenArea);
    let kind = if inside || open { word.to_owned() } else { format!("{word} ROOM") };
    Template {
        kind: Cow::Owned(kind),
        area_m2: (8, 70),
        weight: 1,
        most: usize::MAX,
        needed: false,
        open,
        door_percent: 60,
        door: None,
        furniture: if open { Furniture::Tables } else { Furniture::Desks },
    }
}

/// The row of a type.
fn of_type<'a, 'b>(asked: &'b [Asked<'a>], kind: &str) -> Option<&'b Asked<'a>> {
    asked.iter().find(|row| same(&row.room.kind, kind))
}

/// Rooms that stand beside each other, by the places of their rows.
fn chains(asked: &[Asked<'_>]) -> Vec<Vec<usize>> {
    let mut left: Vec<u32> = asked.iter().map(|row| row.room.count).collect();
    let mut out: Vec<Vec<usize>> = Vec::new();
    let place = |kind: &str| asked.iter().position(|row| same(&row.room.kind, kind));
    for (at, row) in asked.iter().enumerate() {
        let Some(other) = row.room.beside.as_deref().and_then(place) else { continue };
        for _ in 0..left.get(at).copied().unwrap_or(0) {
            // A chain that ends or begins with such a room and has nothing at that end yet, else a new one.
            let last = out.iter_mut().find(|chain| chain.last() == Some(&other));
            if let Some(chain) = last {
                chain.push(at);
            } else if let Some(chain) = out.iter_mut().find(|chain| chain.first() == Some(&other)) {
                chain.insert(0, at);
            } else if left.get(other).is_some_and(|left| *left > 0) {
                out.push(vec![at, other]);
                if let Some(left) = left.get_mut(other) {
                    *left -= 1;
                }
            } else {
                out.push(vec![at]);
            }
        }
        if let Some(left) = left.get_mut(at) {
            *left = 0;
        }
    }
    for (at, count) in left.into_iter().enumerate() {
        out.extend((0..count).map(|_| vec![at]));
    }
    out
}

/// Strips with what is left of them.
type Strips = Vec<(Frame, Vec<Vec<Slot>>)>;

/// One draw.
struct Attempt {
    draft: Draft,
    unmet: Vec<Unmet>,
    words: &'static str,
    cars: u32,
}

impl Attempt {
    /// Draws a building; nothing where its corridors cannot be laid.
    fn draw(
        brief: &BuildingBrief,
        style: &Style,
        asked: &[Asked<'_>],
        size: (i32, i32),
        chance: &mut Chance,
    ) -> Option<Self> {
        let skeleton = chance.pick(brief.form.map_or(style.skeletons, skeletons))?;
        let (least, most) = style.widths.length;
        let mut widths = Widths { length: (least * size.0 / 100, most * size.1 / 100), ..style.widths };
        if let Some(wide) = brief.corridor_m.map(tenths) {
            widths.corridor = (wide, wide);
        }
        let door = brief.door_m.map(tenths).map_or(style.door, |wide| (wide, wide));
        let widest = asked.iter().filter_map(|row| row.template.door).map(|door| door.1).max().unwrap_or(0).max(door.1);
        let laid = skeleton.laid(&widths, chance);
        let mut draft = Draft::default();
        let lines = corridors::lay(&laid, &style.naming, &mut draft, chance);
        let mut strips: Strips = Vec::new();
        for block in laid.blocks() {
            let found = floors::beside(&laid, &lines, &block, &widths);
            strips.extend(
                found
                    .into_iter()
                    .map(|(frame, accesses)| (frame, vec![strip::slots(&frame, &accesses, (door.0, widest), chance)])),
            );
        }
        let others: Vec<Template> = style
            .templates
            .iter()
            .filter(|template| !asked.iter().any(|row| is_called(&template.kind, &row.template.kind)))
            .map(|template| Template { needed: false, ..template.clone() })
            .collect();
        let mut program = Program::new(&others, door);
        let cars = i32::try_from(brief.elevators).unwrap_or(0);
        let got = floors::lift(&mut strips, cars, &mut program, &mut draft, chance);
        let mut unmet = Vec::new();
        if got < cars {
            unmet.push(Unmet::new(
                "elevators",
                cars.to_string(),
                format!("got {got}, for there is no longer wall for a lobby"),
            ));
        }
        let mut chains = chains(asked);
        // Long chains first; those of a length in a drawn order.
        let mut order: Vec<(i32, Vec<usize>)> =
            chains.drain(..).map(|chain| (chance.between((0, 999)), chain)).collect();
        order.sort_by_key(|(drawn, chain)| (std::cmp::Reverse(chain.len()), *drawn));
        for (_, chain) in order {
            let rooms: Vec<&Template> = chain.iter().filter_map(|at| asked.get(*at)).map(|row| &row.template).collect();
            let Some((at, part, first, counts)) = place(&strips, &rooms, brief.only, chance) else {
                unmet.extend(missing(&chain, asked, &strips));
                continue;
            };
            take(&mut strips, (at, part, first), (&rooms, &counts), &mut program, &mut draft, chance);
        }
        if !brief.only && !others.is_empty() {
            for (frame, parts) in &strips {
                for part in parts {
                    strip::fill(frame, part, &mut program, &mut draft, chance);
                }
            }
        }
        corridors::join(&lines, &style.naming, &mut draft, (false, &program.open), chance);
        merged(&mut unmet);
        Some(Self { draft, unmet, words: skeleton.words, cars: brief.elevators })
    }

    /// Whether few rooms are there that nobody asked for.
    fn is_modest(&self, brief: &BuildingBrief) -> bool {
        let asked: usize = brief.rooms.iter().map(|room| usize::try_from(room.count).unwrap_or(0)).sum();
        self.draft.rooms.len() <= asked + asked * OTHERS.0 + OTHERS.1
    }

    fn built(mut self, brief: &BuildingBrief, seed: u64, chance: &mut Chance) -> Result<Built, NotBuilt> {
        let style = style(brief.kind);
        let lifts = match self.cars {
            0 => String::new(),
            1 => ", with an elevator".to_owned(),
            count => format!(", with {count} elevators"),
        };
        self.draft.description = format!("{}: {}{lifts}.", style.words, self.words);
        let asked: Vec<Asked<'_>> = brief.rooms.iter().map(|room| Asked::of(room, style)).collect();
        self.draft.called = names(&self.draft, &asked);
        let title = format!("# Built by a brief with seed {seed}; form: maps/README.md. Lengths in m.\n");
        let text = self.draft.text_under(&title, chance);
        let (mut files, location) = made(&text).map_err(NotBuilt::Flawed)?;
        files.insert(crate::plan::PLAN.to_owned(), text.into_bytes());
        let room = |room: &MadeRoom| {
            let (wide, high) = (f64::from(room.area.x1 - room.area.x0), f64::from(room.area.y1 - room.area.y0));
            let node = room.nodes.first().map_or("", |node| self.draft.id(*node)).to_owned();
            BuiltRoom { kind: room.kind.clone(), area_m2: wide * high / 100.0, node }
        };
        let rooms = self.draft.rooms.iter().map(room).collect();
        let kinds: BTreeSet<&String> = self.draft.rooms.iter().map(|room| &room.kind).collect();
        let others =
            kinds.into_iter().filter(|kind| !asked.iter().any(|row| row.template.kind == **kind)).cloned().collect();
        let remarks = remarks(brief, &location);
        Ok(Built { files, location, rooms, others, remarks })
    }
}

/// One line for what is missing several times.
fn merged(unmet: &mut Vec<Unmet>) {
    let mut out: Vec<(Unmet, usize)> = Vec::new();
    for one in unmet.drain(..) {
        match out.iter_mut().find(|(other, _)| *other == one) {
            Some((_, count)) => *count += 1,
            None => out.push((one, 1)),
        }
    }
    unmet.extend(out.into_iter().map(|(one, count)| {
        if count == 1 { one } else { Unmet { answer: format!("{}, {count} times", one.answer), ..one } }
    }));
}

/// What a chain of rooms that found no place lacks.
fn missing(chain: &[usize], asked: &[Asked<'_>], strips: &Strips) -> Vec<Unmet> {
    let widest = strips
        .iter()
        .flat_map(|(frame, parts)| parts.iter().map(move |part| span(part) * frame.depth() / 100))
        .max()
        .unwrap_or(0);
    let row = |at: &usize| asked.get(*at);
    let size = |row: &Asked<'_>| format!("{} to {} m²", row.template.area_m2.0, row.template.area_m2.1);
    chain
        .iter()
        .filter_map(row)
        .map(|row| {
            let what = format!("rooms `{}`", row.room.kind);
            match row.room.beside.as_deref().and_then(|kind| of_type(asked, kind)).filter(|_| chain.len() > 1) {
                Some(other) => Unmet::new(
                    what,
                    format!("beside `{}`, {}", other.room.kind, size(row)),
                    "no strip has both in a row",
                ),
                None => Unmet::new(
                    what,
                    format!("{}, {}", row.room.count, size(row)),
                    format!("no place left; the longest free wall has {widest} m² behind it"),
                ),
            }
        })
        .collect()
}

fn span(slots: &[Slot]) -> i32 {
    match (slots.first(), slots.last()) {
        (Some(first), Some(last)) => last.to - first.from,
        _ => 0,
    }
}

/// Strip, part of it, first slot, and how many slots each room takes.
type Spot = (usize, usize, usize, Vec<usize>);

/// Where rooms in a row fit: a drawn one of all places, or, packed, the first, so that rooms without others between them lie side by
/// side.
fn place(strips: &Strips, rooms: &[&Template], packed: bool, chance: &mut Chance) -> Option<Spot> {
    let mut found: Vec<Spot> = Vec::new();
    for (at, (frame, parts)) in strips.iter().enumerate() {
        for (part, slots) in parts.iter().enumerate() {
            for first in 0..slots.len() {
                let rest = slots.get(first..).unwrap_or_default();
                found.extend(taken(frame, rest, rooms, chance).map(|counts| (at, part, first, counts)));
            }
        }
    }
    let place = usize::try_from(chance.between((0, i32::try_from(found.len()).unwrap_or(1) - 1))).unwrap_or(0);
    let place = if packed { 0 } else { place };
    if found.is_empty() { None } else { Some(found.swap_remove(place.min(found.len() - 1))) }
}

/// How many slots each of some rooms in a row takes from the first slot on.
fn taken(frame: &Frame, slots: &[Slot], rooms: &[&Template], chance: &mut Chance) -> Option<Vec<usize>> {
    let mut counts = Vec::new();
    let mut from = 0;
    for template in rooms {
        let rest = slots.get(from..)?;
        let fits = |count: &usize| {
            let Some(group) = rest.get(..*count) else { return false };
            let (wide, depth) = (span(group), frame.depth());
            let area = wide * depth / 100;
            let slim = wide * ASPECT_TENTHS < depth * 10 || depth * ASPECT_TENTHS < wide * 10;
            let entered = template.open || group.iter().all(|slot| slot.access.width.is_none());
            (template.area_m2.0..=template.area_m2.1).contains(&area) && !slim && entered
        };
        let possible: Vec<usize> = (1..=MOST_SLOTS.min(rest.len())).filter(fits).collect();
        // The smaller of those that fit more often, so that there is room for the others.
        let count = if chance.happens(70) { possible.first() } else { chance.pick(&possible) };
        let count = *count?;
        counts.push(count);
        from += count;
    }
    Some(counts)
}

/// Builds rooms in a row and takes their slots out of the strip.
fn take(
    strips: &mut Strips,
    (at, part, first): (usize, usize, usize),
    (rooms, counts): (&[&Template], &[usize]),
    program: &mut Program<'_>,
    draft: &mut Draft,
    chance: &mut Chance,
) {
    let Some((frame, parts)) = strips.get_mut(at) else { return };
    if part >= parts.len() {
        return;
    }
    let slots = parts.remove(part);
    let mut from = first;
    for (template, count) in rooms.iter().zip(counts) {
        let group = slots.get(from..from + count).unwrap_or_default();
        strip::room(frame, group, template, program, draft, chance);
        from += count;
    }
    let rest = [slots.get(..first), slots.get(from..)].into_iter().flatten();
    parts.extend(rest.filter(|part| !part.is_empty()).map(<[Slot]>::to_vec));
}

/// Names that people use, with the nodes of the rooms: numbered where there are several.
fn names(draft: &Draft, asked: &[Asked<'_>]) -> Vec<(String, Vec<NodeAt>)> {
    let mut out = Vec::new();
    for row in asked {
        let Some(name) = row.room.name.as_deref().map(str::trim).filter(|name| !name.is_empty()) else { continue };
        let rooms = draft.rooms.iter().filter(|room| room.kind == row.template.kind);
        for (number, room) in rooms.enumerate() {
            let called = if row.room.count == 1 { name.to_owned() } else { format!("{name} {}", number + 1) };
            out.push((called, room.nodes.clone()));
        }
    }
    out
}

#[cfg(test)]
mod tests;
