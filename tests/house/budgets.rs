//! Budgets of lines: `budgets.toml` beside this file has a row for every room.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use super::members;
use super::rooms::{sources, table};

/// The table.
const TABLE: &str = "budgets.toml";
/// Shortest reason of a row, characters.
const REASON: usize = 12;

/// The row of a room.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Budget {
    lines: usize,
    why: String,
    /// Reason for a budget above that of any other room.
    exception: Option<String>,
}

/// The table.
#[derive(Debug, Clone)]
struct Budgets {
    /// Lines of all rooms together.
    total: usize,
    /// Lines of a room without an exception.
    room: usize,
    rooms: BTreeMap<String, Budget>,
}

impl Budgets {
    fn parse(text: &str) -> Self {
        let table: toml::Table = text.parse().unwrap_or_else(|why| panic!("tests/house/{TABLE}: {why}"));
        let number = |value: &toml::Value, of: &str| {
            let lines = value.as_integer().and_then(|lines| usize::try_from(lines).ok());
            lines.unwrap_or_else(|| panic!("tests/house/{TABLE}: {of} is no number of lines: {value}"))
        };
        let rooms = table["rooms"].as_table().unwrap().iter().map(|(room, row)| {
            let text = |key: &str| row.get(key).and_then(toml::Value::as_str).map(str::to_owned);
            let why = text("why").unwrap_or_else(|| panic!("tests/house/{TABLE}: `{room}` has no `why`"));
            (room.clone(), Budget { lines: number(&row["lines"], room), why, exception: text("exception") })
        });
        Self { total: number(&table["total"], "total"), room: number(&table["room"], "room"), rooms: rooms.collect() }
    }

    /// Faults of the table and rooms above it, given the lines of every room.
    fn broken(&self, found: &BTreeMap<String, usize>) -> Vec<String> {
        let mut broken = Vec::new();
        for room in self.rooms.keys().chain(found.keys()).collect::<BTreeSet<_>>() {
            match (self.rooms.get(room), found.get(room)) {
                (Some(budget), Some(lines)) => broken.extend(self.broken_by(room, budget, *lines)),
                (None, Some(lines)) => broken.push(format!("`{room}` has {lines} lines and no row")),
                (_, None) => broken.push(format!("`{room}` has a row and is no room")),
            }
        }
        let total: usize = found.values().sum();
        if total > self.total {
            let more = total - self.total;
            broken
                .push(format!("all rooms: {total} lines, {more} above their budget of {}; raise `total`", self.total));
        }
        broken
    }

    fn broken_by(&self, room: &str, budget: &Budget, lines: usize) -> Vec<String> {
        let mut broken = Vec::new();
        if lines > budget.lines {
            let more = lines - budget.lines;
            let to = lines.next_multiple_of(100);
            broken.push(format!(
                "`{room}`: {lines} lines, {more} above its budget of {}; delete code, or raise `lines` to {to} in the commit that \
                 needs it and say why there",
                budget.lines
            ));
        }
        if budget.lines > self.room && budget.exception.is_none() {
            broken.push(format!("`{room}`: a budget above {} needs an `exception` with the reason", self.room));
        }
        if budget.lines <= self.room && budget.exception.is_some() {
            broken.push(format!("`{room}`: its budget fits into {}; remove the `exception`", self.room));
        }
        if budget.why.len() < REASON || budget.exception.as_ref().is_some_and(|why| why.len() < REASON) {
            broken.push(format!("`{room}`: its `why` or `exception` says too little"));
        }
        broken
    }

    /// The table with the present sizes, for reading and for copying figures from it.
    fn shown(&self, found: &BTreeMap<String, usize>) -> String {
        let mut text = format!("{:<30} {:>8} {:>8} {:>8} {:>8}\n", "room", "lines", "budget", "spare", "less 5 %");
        let mut row = |room: &str, lines: usize, budget: usize| {
            let goal = (lines * 95 / 100 + 50) / 100 * 100;
            let spare = i64::try_from(budget).unwrap() - i64::try_from(lines).unwrap();
            writeln!(text, "{room:<30} {lines:>8} {budget:>8} {spare:>8} {goal:>8}").unwrap();
        };
        for (room, lines) in found {
            row(room, *lines, self.rooms.get(room).map_or(0, |budget| budget.lines));
        }
        row("all rooms", found.values().sum(), self.total);
        text
    }
}

/// Lines of code of every room.
fn lines() -> BTreeMap<String, usize> {
    let mut found: BTreeMap<String, usize> = members().into_keys().map(|room| (room, 0)).collect();
    for source in sources() {
        *found.get_mut(&source.room).unwrap() += source.lines;
    }
    found
}

#[test]
#[expect(clippy::print_stdout, reason = "`--nocapture` shows the table")]
fn budgets_of_lines_are_kept() {
    let found = lines();
    let budgets = Budgets::parse(&table(TABLE).1);
    println!("{}", budgets.shown(&found));
    let broken = budgets.broken(&found);
    assert!(broken.is_empty(), "tests/house/{TABLE}:\n  {}", broken.join("\n  "));
}

#[test]
fn budgets_name_a_room_that_outgrows_its_row_and_rows_without_rooms() {
    let budgets = Budgets::parse(
        "total = 1000\nroom = 500\n[rooms]\n\"a\" = { lines = 300, why = \"the first of them\" }\n\
         \"b\" = { lines = 600, why = \"the second of them\" }\n\"d\" = { lines = 100, why = \"the last of them\" }",
    );
    let found = |rows: &[(&str, usize)]| rows.iter().map(|(room, lines)| ((*room).to_owned(), *lines)).collect();
    let broken = budgets.broken(&found(&[("a", 401), ("b", 600), ("c", 7)]));
    assert_eq!(broken.len(), 5, "{broken:?}");
    assert!(broken[0].starts_with("`a`: 401 lines, 101 above its budget of 300; delete code, or raise `lines` to 500"));
    assert!(broken[1].starts_with("`b`: a budget above 500 needs an `exception`"));
    assert_eq!(broken[2..4], ["`c` has 7 lines and no row", "`d` has a row and is no room"]);
    assert!(broken[4].starts_with("all rooms: 1008 lines, 8 above their budget of 1000"));
}
