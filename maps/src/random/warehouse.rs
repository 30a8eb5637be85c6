//! Warehouses: racks with aisles between them, cross aisles, a staging area with docks, and rooms along a side wall.

use super::chance::Chance;
use super::draft::{Draft, NodeAt, WALL};
use super::furnish::Furnished;
use super::rooms::{Furniture, WAREHOUSE};
use super::shape::{Area, Frame, Side, Spot};
use super::strip::{self, Access, Program};

/// Widths of aisles, tenths: for picking by hand, for pallet jacks, for forklifts.
const AISLES: [(i32, i32); 3] = [(10, 12), (18, 24), (30, 37)];
/// Aisles that go all round and across, tenths.
const MAIN: (i32, i32) = (24, 37);
/// From the outermost node of the staging area to the wall, tenths.
const FROM_WALL: i32 = 13;
/// Longest way between two nodes of an aisle, tenths.
const STEP: i32 = 38;

/// Longest way between two nodes of the staging area, tenths.
const WIDEST_GAP: i32 = 76;

/// A range of coordinates, tenths.
type Range = (i32, i32);

/// Where racks and aisles lie.
struct Layout {
    aisles: Vec<Range>,
    racks: Vec<Range>,
    runs: Vec<Range>,
    /// Middles of the cross aisles; the first lies before the racks.
    rows: Vec<(i32, i32)>,
    /// Depth of the staging area.
    staging: i32,
    size: (i32, i32),
}

fn layout(chance: &mut Chance) -> Layout {
    let base = chance.between((0, 2));
    let count = chance.between(if base == 2 { (3, 5) } else { (4, 7) });
    let mut x = chance.between(MAIN);
    let mut aisles = vec![(0, x)];
    let mut racks = Vec::new();
    for place in 0..count {
        let rack = if chance.happens(80) { chance.between((18, 24)) } else { chance.between((10, 13)) };
        racks.push((x, x + rack));
        x += rack;
        let sort = if chance.happens(60) { base } else { chance.between((0, 2)) };
        let of_sort = AISLES.get(usize::try_from(sort).unwrap_or(0)).copied().unwrap_or(MAIN);
        let wide = chance.between(if place + 1 == count { MAIN } else { of_sort });
        aisles.push((x, x + wide));
        x += wide;
    }
    let staging = chance.between((64, 110));
    let (mut y, mut runs, mut rows) = (staging, Vec::new(), vec![(staging - FROM_WALL, 30)]);
    let parts = chance.between((1, 3));
    for _ in 0..parts {
        let long = chance.between(if parts == 1 { (120, 200) } else { (60, 110) });
        runs.push((y, y + long));
        let cross = chance.between(MAIN);
        y += long;
        rows.push((y + cross / 2, cross));
        y += cross;
    }
    Layout { aisles, racks, runs, rows, staging, size: (x, y) }
}

const fn aisle_type(wide: i32) -> &'static str {
    match wide {
        ..=15 => "NARROW AISLE",
        16..=29 => "PASSAGEWAY",
        _ => "WIDE PASSAGEWAY",
    }
}

/// Draws a warehouse.
pub(super) fn draw(chance: &mut Chance) -> Draft {
    let mut draft = Draft::default();
    let layout = layout(chance);
    let (wide, high) = layout.size;
    draft.floor(Area { x0: 0, y0: 0, x1: wide, y1: high });
    for (x0, x1) in &layout.racks {
        for (y0, y1) in &layout.runs {
            draft.block(Area { x0: *x0, y0: *y0, x1: *x1, y1: *y1 });
        }
    }
    let columns = aisles(&layout, &mut draft);
    staging(&layout, &columns, &mut draft, chance);
    let mut program = Program::new(WAREHOUSE, (10, 12));
    let right = chance.happens(50);
    side_rooms(&layout, right, &columns, &mut program, &mut draft, chance);
    if chance.happens(30) {
        side_rooms(&layout, !right, &columns, &mut program, &mut draft, chance);
    }
    let narrow = layout.aisles.iter().filter(|(from, to)| to - from <= 15).count();
    let aisles = match narrow {
        0 => "wide aisles",
        1 => "one narrow aisle",
        _ => "narrow aisles",
    };
    draft.lacks = program.lacks();
    draft.description =
        format!("A warehouse: racks with {aisles}, a packing area, loading docks and rooms at the side.");
    draft
}

/// Nodes of every aisle from its first to its last, with the ways along and across.
fn aisles(layout: &Layout, draft: &mut Draft) -> Vec<Vec<NodeAt>> {
    let mut columns = Vec::new();
    let mut crossings: Vec<Vec<NodeAt>> = layout.rows.iter().map(|_| Vec::new()).collect();
    for (place, (x0, x1)) in layout.aisles.iter().enumerate() {
        let (x, kind) = ((x0 + x1) / 2, aisle_type(x1 - x0));
        let outermost = place == 0 || place + 1 == layout.aisles.len();
        let mut column: Vec<NodeAt> = Vec::new();
        let mut below: Option<i32> = None;
        for (at, ((y, _), row)) in layout.rows.iter().zip(&mut crossings).enumerate() {
            if let Some(from) = below {
                let parts = (y - from + STEP - 1) / STEP;
                for part in 1..parts {
                    let id = draft.name("a");
                    column.push(draft.node(id, kind, Spot { x, y: from + (y - from) * part / parts }));
                }
            }
            let corner = outermost && at + 1 == layout.rows.len();
            let id = draft.name("c");
            let spot = Spot { x, y: *y };
            let node = if corner { draft.bend(id, spot) } else { draft.node(id, "INTERSECTION", spot) };
            column.push(node);
            row.push(node);
            below = Some(*y);
        }
        draft.edge(kind, &column);
        columns.push(column);
    }
    for (row, (_, wide)) in crossings.iter().zip(&layout.rows) {
        draft.edge(aisle_type(*wide), row);
    }
    columns
}

/// The area before the racks: packing, docks in the outer wall, pallets.
fn staging(layout: &Layout, columns: &[Vec<NodeAt>], draft: &mut Draft, chance: &mut Chance) {
    let top = layout.staging - FROM_WALL;
    let mut ys = vec![FROM_WALL];
    if top - FROM_WALL >= 52 {
        ys.push((top + FROM_WALL) / 2);
    }
    let mut picked: Vec<(i32, NodeAt)> = Vec::new();
    let middles: Vec<i32> = layout.aisles.iter().map(|(x0, x1)| (x0 + x1) / 2).collect();
    for (place, (x, column)) in middles.iter().zip(columns).enumerate() {
        let Some(first) = column.first() else { continue };
        // One near the last is left out where the way to the next stays short; the outermost ones always go on.
        let next = middles.get(place + 1);
        let left_out =
            picked.last().zip(next).is_some_and(|((last, _), next)| x - last < 34 && next - last <= WIDEST_GAP);
        if !left_out {
            picked.push((*x, *first));
        }
    }
    let mut ways: Vec<(Spot, Spot)> = Vec::new();
    let docks_from = usize::from(chance.happens(50));
    let mut rows: Vec<Vec<NodeAt>> = ys.iter().map(|_| Vec::new()).collect();
    for (place, (x, first)) in picked.iter().enumerate() {
        let mut column = Vec::new();
        for ((y, row), depth) in ys.iter().zip(&mut rows).zip(0..) {
            let (stem, kind) = match (depth, place % 3 == docks_from) {
                (0, true) => ("k", "LOADING DOCK"),
                (0, false) if place + 1 == picked.len() => ("x", "EXIT"),
                _ => ("p", "PACKING AREA"),
            };
            let id = draft.name(stem);
            let node = draft.node(id, kind, Spot { x: *x, y: *y });
            row.push(node);
            column.push(node);
        }
        column.push(*first);
        draft.edge("OPEN AREA", &column);
        ways.push((Spot { x: *x, y: FROM_WALL }, Spot { x: *x, y: layout.staging }));
    }
    let (first, last) = (picked.first().map_or(0, |(x, _)| *x), picked.last().map_or(0, |(x, _)| *x));
    for (row, y) in rows.iter().zip(&ys) {
        draft.edge("OPEN AREA", row);
        ways.push((Spot { x: first, y: *y }, Spot { x: last, y: *y }));
    }
    let floor = Area { x0: 0, y0: 0, x1: layout.size.0, y1: top - 9 };
    Furnished::new(Frame::new(floor, Side::Bottom), &ways, draft).furnish(Furniture::PalletRows);
}

/// Rooms behind one of the side walls, beside the outermost aisle.
fn side_rooms(
    layout: &Layout,
    right: bool,
    columns: &[Vec<NodeAt>],
    program: &mut Program<'_>,
    draft: &mut Draft,
    chance: &mut Chance,
) {
    let deep = chance.between((36, 50));
    let (first, last) = (layout.staging - 2 * FROM_WALL, layout.size.1);
    let long = chance.between((90, 200)).min(last - first);
    let from = if chance.happens(50) { first } else { last - long };
    let (wall, side) = if right { (layout.size.0 + WALL, Side::Left) } else { (-WALL - deep, Side::Right) };
    let frame = Frame::new(Area { x0: wall, y0: from, x1: wall + deep, y1: from + long }, side);
    let (column, aisle) =
        if right { (columns.last(), layout.aisles.last()) } else { (columns.first(), layout.aisles.first()) };
    let (Some(column), Some((x0, x1))) = (column, aisle) else { return };
    let before = if right { x1 - (x0 + x1) / 2 } else { (x0 + x1) / 2 - x0 } + WALL / 2;
    let reach = (frame.u_of(0), frame.u_of(layout.size.1));
    let access = |node: &NodeAt, at: Spot| Access { u: frame.u_of(at.y), before, node: *node, reach, width: None };
    let accesses: Vec<Access> = column.iter().filter_map(|node| draft.at(*node).map(|at| access(node, at))).collect();
    let slots = strip::slots(&frame, &accesses, program.door, chance);
    strip::fill(&frame, &slots, program, draft, chance);
}
