//! What rooms there are in which building.

use std::borrow::Cow;

/// What stands in a room.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Furniture {
    /// Desks along the walls.
    Desks,
    /// Desks in rows all over the floor.
    DeskRows,
    /// One table in the middle.
    Table,
    /// Small tables all over the floor.
    Tables,
    /// Beds with their heads at the wall.
    Beds,
    /// One bed in the middle.
    BedInside,
    /// A double bed and a wardrobe.
    Bedroom,
    /// Shelves along the walls.
    Shelves,
    /// Chairs in rows along the walls.
    Chairs,
    /// A counter before the far wall.
    Counter,
    /// A worktop along the far wall.
    Worktop,
    /// Sofas.
    Sofas,
    /// Pallets along the walls.
    Pallets,
    /// Pallets in rows all over the floor.
    PalletRows,
}

/// A type of room.
#[derive(Debug, Clone)]
pub(super) struct Template {
    /// Type of its nodes.
    pub(super) kind: Cow<'static, str>,
    /// Least and largest area, m².
    pub(super) area_m2: (i32, i32),
    /// How often it is drawn, against the others.
    pub(super) weight: i32,
    /// At most as many in a building.
    pub(super) most: usize,
    /// Whether every building has one.
    pub(super) needed: bool,
    /// Whether it is open to the corridor instead of behind a doorway.
    pub(super) open: bool,
    /// How often its doorway has a door, percent.
    pub(super) door_percent: i32,
    /// Least and largest width of its doorway, tenths, where it is not that of the building.
    pub(super) door: Option<(i32, i32)>,
    pub(super) furniture: Furniture,
}

/// A row of a table: type, area, weight, most, how it is entered, what stands in it.
const fn row(
    kind: &'static str,
    area_m2: (i32, i32),
    (weight, most): (i32, usize),
    (entry, furniture): (Entry, Furniture),
) -> Template {
    let (open, door_percent) = match entry {
        Entry::Open | Entry::NeededOpen => (true, 0),
        Entry::Door(percent) | Entry::NeededDoor(percent) => (false, percent),
    };
    let needed = matches!(entry, Entry::NeededOpen | Entry::NeededDoor(_));
    Template { kind: Cow::Borrowed(kind), area_m2, weight, most, needed, open, door_percent, door: None, furniture }
}

/// How a room is entered; the chance of a door is in percent.
enum Entry {
    Open,
    Door(i32),
    NeededOpen,
    NeededDoor(i32),
}

use Entry::{Door, NeededDoor, NeededOpen, Open};
use Furniture::{
    BedInside, Bedroom, Beds, Chairs, Counter, DeskRows, Desks, Pallets, Shelves, Sofas, Table, Tables, Worktop,
};

pub(super) const OFFICE: &[Template] = &[
    row("OFFICE ROOM", (8, 28), (8, 99), (Door(60), Desks)),
    row("MEETING ROOM", (16, 60), (3, 4), (NeededDoor(90), Table)),
    row("OPEN-PLAN AREA", (40, 400), (4, 4), (Open, DeskRows)),
    row("KITCHEN", (10, 34), (1, 2), (NeededDoor(40), Worktop)),
    row("COPY ROOM", (5, 18), (1, 2), (Door(20), Shelves)),
    row("STORAGE ROOM", (4, 18), (1, 2), (Door(80), Shelves)),
    row("RESTROOM", (8, 26), (2, 2), (NeededDoor(100), Worktop)),
    row("RECEPTION AREA", (18, 80), (1, 1), (NeededOpen, Counter)),
    row("LOUNGE AREA", (18, 60), (1, 1), (Open, Sofas)),
];

pub(super) const HOSPITAL: &[Template] = &[
    row("WARD", (16, 70), (7, 99), (NeededDoor(70), Beds)),
    row("EXAM ROOM", (12, 30), (3, 99), (Door(70), Desks)),
    row("TREATMENT ROOM", (14, 40), (2, 4), (Door(70), BedInside)),
    row("OPERATING ROOM", (26, 70), (1, 2), (Door(100), BedInside)),
    row("NURSE STATION AREA", (16, 60), (2, 2), (NeededOpen, Counter)),
    row("WAITING AREA", (18, 90), (2, 2), (NeededOpen, Chairs)),
    row("CAFETERIA AREA", (50, 400), (2, 1), (Open, Tables)),
    row("PHARMACY ROOM", (14, 36), (1, 1), (Door(60), Shelves)),
    row("LABORATORY", (16, 60), (1, 2), (Door(80), Worktop)),
    row("STAFF ROOM", (12, 40), (1, 2), (Door(60), Tables)),
    row("STORAGE ROOM", (5, 26), (1, 3), (Door(80), Shelves)),
    row("RESTROOM", (8, 26), (2, 3), (NeededDoor(100), Worktop)),
];

pub(super) const HOME: &[Template] = &[
    row("BEDROOM", (8, 34), (4, 4), (NeededDoor(90), Bedroom)),
    row("BATHROOM", (4, 13), (2, 2), (NeededDoor(100), Worktop)),
    row("KITCHEN", (7, 24), (2, 1), (NeededDoor(20), Worktop)),
    row("LIVING ROOM", (16, 80), (3, 1), (NeededOpen, Sofas)),
    row("DINING ROOM", (10, 28), (1, 1), (Door(20), Table)),
    row("STUDY ROOM", (7, 20), (1, 2), (Door(70), Desks)),
    row("STORAGE ROOM", (3, 12), (1, 1), (Door(90), Shelves)),
];

pub(super) const WAREHOUSE: &[Template] = &[
    row("BREAK ROOM", (10, 40), (2, 1), (NeededDoor(60), Tables)),
    row("OFFICE ROOM", (8, 36), (2, 2), (Door(60), Desks)),
    row("CHARGING ROOM", (10, 50), (1, 1), (Door(0), Shelves)),
    row("RESTROOM", (6, 24), (1, 1), (Door(100), Worktop)),
    row("STORAGE ROOM", (6, 60), (1, 2), (Door(60), Pallets)),
];

pub(super) const HALL: &[Template] = &[
    row("SHOP ROOM", (10, 60), (4, 99), (Door(10), Shelves)),
    row("TICKET OFFICE", (8, 40), (1, 2), (Door(40), Worktop)),
    row("RESTROOM", (8, 40), (2, 2), (NeededDoor(100), Worktop)),
    row("MEETING ROOM", (14, 60), (1, 2), (Door(80), Table)),
    row("CAFE AREA", (18, 200), (2, 2), (Open, Tables)),
    row("WAITING AREA", (18, 200), (1, 1), (Open, Chairs)),
    row("STORAGE ROOM", (6, 40), (1, 2), (Door(80), Shelves)),
];
