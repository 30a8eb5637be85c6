//! Halls: one large floor with stands or pillars, rooms along one or two of its walls, entrance passages and exits.

use super::chance::Chance;
use super::draft::{Draft, NodeAt, WALL};
use super::rooms::HALL;
use super::shape::{Area, Frame, Side, Spot};
use super::strip::{self, Access, Program, Slot};

/// What a hall is used for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Use {
    /// Stands with aisles between them.
    Fair,
    /// Pillars and benches.
    Station,
    /// Few pillars, sofas.
    Lobby,
}

impl Use {
    const ALL: [Self; 3] = [Self::Fair, Self::Station, Self::Lobby];

    const fn node(self) -> &'static str {
        match self {
            Self::Fair => "EXHIBITION AREA",
            Self::Station => "CONCOURSE AREA",
            Self::Lobby => "LOBBY AREA",
        }
    }

    const fn words(self) -> &'static str {
        match self {
            Self::Fair => "An exhibition hall: stands with aisles between them",
            Self::Station => "The hall of a station: pillars and benches",
            Self::Lobby => "A large lobby: a few pillars and sofas",
        }
    }
}

/// The lines on which the nodes of the hall stand.
struct Lattice {
    xs: Vec<i32>,
    ys: Vec<i32>,
    size: (i32, i32),
    /// From the outermost line to the wall.
    margin: i32,
}

/// A cell of the lattice: column and row of its lower left node.
type CellAt = (usize, usize);

impl Lattice {
    fn drawn(chance: &mut Chance) -> Self {
        let margin = chance.between((22, 26));
        let mut lines = |most: i32| {
            let step = chance.between((46, 62));
            let count = chance.between((3, most));
            let lines: Vec<i32> = (0..=count).map(|place| margin + place * step).collect();
            (lines, 2 * margin + count * step)
        };
        let ((xs, wide), (ys, high)) = (lines(7), lines(4));
        Self { xs, ys, size: (wide, high), margin }
    }

    /// The floor between four nodes, less half an aisle on every side.
    fn inner(&self, (column, row): CellAt, aisle: i32) -> Option<Area> {
        let half = aisle / 2;
        Some(Area {
            x0: self.xs.get(column)? + half,
            y0: self.ys.get(row)? + half,
            x1: self.xs.get(column + 1)? - half,
            y1: self.ys.get(row + 1)? - half,
        })
    }

    fn cells(&self) -> Vec<CellAt> {
        let columns = self.xs.len().saturating_sub(1);
        (0..self.ys.len().saturating_sub(1)).flat_map(|row| (0..columns).map(move |column| (column, row))).collect()
    }
}

/// Draws a hall.
pub(super) fn draw(chance: &mut Chance) -> Draft {
    let mut draft = Draft::default();
    let Some(purpose) = chance.pick(&Use::ALL).copied() else { return draft };
    let lattice = Lattice::drawn(chance);
    let (wide, high) = lattice.size;
    draft.floor(Area { x0: 0, y0: 0, x1: wide, y1: high });
    let (stands, joined) = furnish(&lattice, purpose, &mut draft, chance);
    let nodes = net(&lattice, purpose, (&stands, &joined), &mut draft);
    let mut program = Program::new(HALL, (10, 14));
    let deep = chance.between((40, 60));
    let below = Area { x0: 0, y0: -WALL - deep, x1: wide, y1: -WALL };
    beside(&lattice, Frame::new(below, Side::Top), &nodes, &mut program, &mut draft, chance);
    let two = chance.happens(40);
    if two {
        let above = Area { x0: 0, y0: high + WALL, x1: wide, y1: high + WALL + deep };
        beside(&lattice, Frame::new(above, Side::Bottom), &nodes, &mut program, &mut draft, chance);
    }
    exits(&lattice, &nodes, two, &mut draft, chance);
    draft.lacks = program.lacks();
    draft.description =
        format!("{}, with rooms along {}.", purpose.words(), if two { "two walls" } else { "one wall" });
    draft
}

/// Stands, pillars, benches; gives the cells with a stand, and those whose stand goes on into the next column.
fn furnish(lattice: &Lattice, purpose: Use, draft: &mut Draft, chance: &mut Chance) -> (Vec<CellAt>, Vec<CellAt>) {
    let (mut stands, mut joined) = (Vec::new(), Vec::new());
    let aisle = chance.between((22, 34));
    let thick = chance.between((5, 9));
    let parity = usize::from(chance.happens(50));
    for (column, row) in lattice.cells() {
        let Some(cell) = lattice.inner((column, row), aisle) else { continue };
        let (x, y) = ((cell.x0 + cell.x1) / 2, (cell.y0 + cell.y1) / 2);
        let of_size = |wide: i32, high: i32| Area {
            x0: x - wide / 2,
            y0: y - high / 2,
            x1: x + wide - wide / 2,
            y1: y + high - high / 2,
        };
        let odd = (column + row) % 2 == parity;
        match purpose {
            Use::Fair => {
                let joins = column > 0
                    && stands.contains(&(column - 1, row))
                    && !joined.contains(&(column.saturating_sub(2), row));
                if joins && chance.happens(25) {
                    // The stand fills the aisle to its neighbor too.
                    draft.block(Area { x0: cell.x0 - aisle, ..cell });
                    joined.push((column - 1, row));
                    stands.push((column, row));
                } else if chance.happens(75) {
                    draft.block(cell);
                    stands.push((column, row));
                }
            }
            Use::Station if odd => draft.block(of_size(thick, thick)),
            Use::Station if chance.happens(40) => draft.block(of_size(20, 7)),
            Use::Lobby if odd && chance.happens(50) => draft.block(of_size(thick, thick)),
            Use::Lobby if !odd && chance.happens(35) => draft.block(of_size(20, 9)),
            Use::Station | Use::Lobby => {}
        }
    }
    (stands, joined)
}

/// The nodes of the lattice by rows, with the ways between them.
fn net(
    lattice: &Lattice,
    purpose: Use,
    (stands, joined): (&[CellAt], &[CellAt]),
    draft: &mut Draft,
) -> Vec<Vec<NodeAt>> {
    let at = |column: Option<usize>, row: Option<usize>| column.zip(row).is_some_and(|cell| stands.contains(&cell));
    let mut rows: Vec<Vec<NodeAt>> = Vec::new();
    for (row, y) in lattice.ys.iter().enumerate() {
        let mut nodes = Vec::new();
        for (column, x) in lattice.xs.iter().enumerate() {
            let (left, below) = (column.checked_sub(1), row.checked_sub(1));
            let around = [at(left, below), at(Some(column), below), at(left, Some(row)), at(Some(column), Some(row))];
            let closed = [below, Some(row)].iter().any(|row| left.zip(*row).is_some_and(|cell| joined.contains(&cell)));
            let crossing = !closed && around.iter().filter(|stand| **stand).count() >= 3;
            let id = draft.name("h");
            nodes.push(draft.node(id, if crossing { "INTERSECTION" } else { purpose.node() }, Spot { x: *x, y: *y }));
        }
        rows.push(nodes);
    }
    let kind = |between: bool| if between { "PASSAGEWAY" } else { "OPEN AREA" };
    for (row, nodes) in rows.iter().enumerate() {
        for (column, pair) in nodes.windows(2).enumerate() {
            draft.edge(kind(at(Some(column), Some(row)) && at(Some(column), row.checked_sub(1))), pair);
        }
    }
    for (row, pair) in rows.windows(2).enumerate() {
        let [below, above] = pair else { continue };
        for (column, (from, to)) in below.iter().zip(above).enumerate() {
            let left = column.checked_sub(1);
            if left.is_some_and(|left| joined.contains(&(left, row))) {
                continue;
            }
            draft.edge(kind(at(left, Some(row)) && at(Some(column), Some(row))), &[*from, *to]);
        }
    }
    rows
}

/// Rooms along a wall of the hall, with one or two passages to the outside between them.
fn beside(
    lattice: &Lattice,
    frame: Frame,
    nodes: &[Vec<NodeAt>],
    program: &mut Program<'_>,
    draft: &mut Draft,
    chance: &mut Chance,
) {
    let row = if frame.spot(0, 0).y < 0 { nodes.first() } else { nodes.last() };
    let Some(row) = row else { return };
    let access = |(x, node): (&i32, &NodeAt)| Access {
        u: frame.u_of(*x),
        before: lattice.margin + WALL / 2,
        node: *node,
        reach: (0, frame.length()),
        width: None,
    };
    let accesses: Vec<Access> = lattice.xs.iter().zip(row).map(access).collect();
    let mut slots = strip::slots(&frame, &accesses, program.door, chance);
    let most = if slots.len() >= 6 { 2 } else { 1 };
    let count = chance.between((1, most));
    let mut passages: Vec<usize> = Vec::new();
    for _ in 0..count {
        let place = usize::try_from(chance.between((0, i32::try_from(slots.len()).unwrap_or(1) - 1))).unwrap_or(0);
        // Two passages have a room between them.
        if passages.iter().all(|other| other.abs_diff(place) >= 2) {
            passage(&frame, &mut slots, place, draft, chance);
            passages.push(place);
        }
    }
    passages.sort_unstable();
    let mut from = 0;
    for place in passages.into_iter().chain([slots.len()]) {
        strip::fill(&frame, slots.get(from..place).unwrap_or(&[]), program, draft, chance);
        from = place + 1;
    }
}

/// A passage from the hall to an exit in place of a room; the rooms beside it grow up to it.
fn passage(frame: &Frame, slots: &mut [Slot], place: usize, draft: &mut Draft, chance: &mut Chance) {
    let Some(access) = slots.get(place).map(|slot| slot.access) else { return };
    let wide = chance.between((22, 30));
    let (from, to) = (access.u - wide / 2, access.u - wide / 2 + wide);
    if let Some(before) = place.checked_sub(1).and_then(|before| slots.get_mut(before)) {
        before.to = from - WALL;
    }
    if let Some(after) = slots.get_mut(place + 1) {
        after.from = to + WALL;
    }
    draft.floor(frame.area((from, to), (0, frame.depth())));
    draft.opening(frame.spot(from, -1), frame.spot(to, -1));
    let id = draft.name("p");
    let inside = draft.node(id, "PASSAGEWAY", frame.spot(access.u, 8));
    let id = draft.name("x");
    let out = draft.node(id, "EXIT", frame.spot(access.u, frame.depth() - 13));
    draft.edge("PASSAGEWAY", &[access.node, inside, out]);
}

/// Exits in the walls without rooms.
fn exits(lattice: &Lattice, nodes: &[Vec<NodeAt>], two: bool, draft: &mut Draft, chance: &mut Chance) {
    let (wide, high) = lattice.size;
    let mut places: Vec<(NodeAt, Spot)> = Vec::new();
    for (row, y) in nodes.iter().zip(&lattice.ys) {
        places.extend(row.first().map(|node| (*node, Spot { x: 10, y: *y })));
        places.extend(row.last().map(|node| (*node, Spot { x: wide - 10, y: *y })));
    }
    if let Some(row) = nodes.last().filter(|_| !two) {
        places.extend(row.iter().zip(&lattice.xs).map(|(node, x)| (*node, Spot { x: *x, y: high - 10 })));
    }
    for _ in 0..chance.between((1, 3)) {
        if places.is_empty() {
            return;
        }
        let place = usize::try_from(chance.between((0, i32::try_from(places.len()).unwrap_or(1) - 1))).unwrap_or(0);
        let (node, at) = places.remove(place.min(places.len() - 1));
        let id = draft.name("x");
        let out = draft.node(id, "EXIT", at);
        draft.edge("OPEN AREA", &[node, out]);
    }
}
