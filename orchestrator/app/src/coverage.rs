//! What a library covers: which kinds of scenarios it holds, and, of those that can be asked for, which it lacks.
//!
//! Known from `index.csv` alone. Counted are scenarios that repeat no earlier one, each once in every cell that it belongs to, and of
//! them those whose first run was realised: only then did happen what the cell says.
//!
//! The density of people is the most within 2.5 m of the robot at once over the area of that disc (`density_2_5m_max`, after the
//! evaluation tools of the CrowdBot project), in the first run. Its bands end at 0.31 and 0.72 people per m², where the levels of
//! service A and C of a walkway end (Fruin 1971), and below them at 0.1: one person.

mod told;

pub(crate) use told::WORDS;

use std::collections::{BTreeMap, BTreeSet};

use socrates_model::{PlaceClass, Verdict};
use socrates_stream::csv::{Row, Table};

use crate::encounters::Sector;
use crate::index;

/// Where the bands of density end, 1/m²; the first is that nobody comes so near.
const BANDS: [(&str, f64); 5] = [
    ("nobody_near", 0.0),
    ("below_0.1", 0.1),
    ("0.1_to_0.31", 0.31),
    ("0.31_to_0.72", 0.72),
    ("from_0.72", f64::INFINITY),
];

/// Scenarios of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Count {
    /// How many there are.
    pub(crate) scenarios: usize,
    /// Those of them that were realised.
    pub(crate) realised: usize,
}

impl Count {
    fn add(&mut self, seen: &Seen) {
        self.scenarios += 1;
        self.realised += usize::from(seen.realised);
    }
}

/// Something by which scenarios differ, and how many there are of each kind.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Axis {
    /// What it is, as in tables.
    pub(crate) name: &'static str,
    /// What it is called in the plural.
    pub(crate) plural: &'static str,
    /// Every cell that can be asked for, then others that were found.
    pub(crate) cells: Vec<(String, Count)>,
    /// How many of the cells can be asked for; the others were found.
    pub(crate) known: usize,
    /// Scenarios of which the table does not say it.
    pub(crate) untold: usize,
}

impl Axis {
    /// Cells that can be asked for and hold no scenario.
    pub(crate) fn empty(&self) -> impl Iterator<Item = &str> {
        self.cells.iter().filter(|(_, count)| count.scenarios == 0).map(|(name, _)| name.as_str())
    }

    /// How many of the cells that can be asked for hold a scenario.
    pub(crate) fn held(&self) -> usize {
        self.cells.iter().take(self.known).filter(|(_, count)| count.scenarios > 0).count()
    }

    /// Cells that hold scenarios of which none was realised.
    pub(crate) fn never_realised(&self) -> impl Iterator<Item = &str> {
        let never = |count: &Count| count.scenarios > 0 && count.realised == 0;
        self.cells.iter().filter(move |(_, count)| never(count)).map(|(name, _)| name.as_str())
    }
}

/// What a library covers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Coverage {
    /// Scenarios of the library.
    pub(crate) scenarios: usize,
    /// Those that repeat no earlier one.
    pub(crate) distinct: Count,
    /// Of these, those of which there is no run.
    pub(crate) failed: usize,
    /// By canonical scenario, encounter, density, place, location and context.
    pub(crate) axes: Vec<Axis>,
    /// By encounter, in the order of [`Sector::ALL`], and density.
    pub(crate) crossed: Vec<Vec<Count>>,
    /// Runs of each planner by verdict; planners that can be asked for first.
    pub(crate) planners: Vec<(String, BTreeMap<String, usize>)>,
}

/// A scenario as the table has it.
#[derive(Debug, Default)]
struct Seen {
    realised: bool,
    failed: bool,
    pattern: Option<String>,
    place: Option<String>,
    location: Option<String>,
    context: Option<String>,
    encounters: Option<BTreeSet<String>>,
    band: Option<usize>,
}

/// Places of the columns that are needed; a table of an earlier version lacks some.
struct Columns<'a>(&'a Table);

impl Columns<'_> {
    fn cell<'r>(&self, row: &'r Row, name: &str) -> Option<&'r str> {
        row.cell(self.0.column(name)?)
    }

    /// The same where it holds something.
    fn filled(&self, row: &Row, name: &str) -> Option<String> {
        self.cell(row, name).filter(|cell| !cell.is_empty()).map(str::to_owned)
    }

    /// What a scenario is said to be known by; in a table that does not name scenarios, by what their rows share.
    fn same(&self, a: &Row, b: &Row) -> bool {
        let names: &[&str] = if self.0.column("scenario").is_some() { &["scenario"] } else { &["request", "path"] };
        names.iter().all(|name| self.cell(a, name) == self.cell(b, name))
    }
}

impl Coverage {
    /// What a table of runs tells.
    pub(crate) fn of(table: &Table) -> Self {
        let columns = Columns(table);
        let groups: Vec<&[Row]> = table.rows.chunk_by(|a, b| columns.same(a, b)).collect();
        let distinct: Vec<&[Row]> =
            groups.iter().copied().filter(|rows| kind(&columns, rows) != Some("repeat")).collect();
        let seen: Vec<Seen> = distinct.iter().map(|rows| seen(&columns, rows)).collect();
        let mut all = Count::default();
        seen.iter().for_each(|one| all.add(one));
        Self {
            scenarios: groups.len(),
            distinct: all,
            failed: seen.iter().filter(|one| one.failed).count(),
            axes: axes(&seen),
            crossed: crossed(&seen),
            planners: planners(&columns, &distinct),
        }
    }
}

fn kind<'r>(columns: &Columns<'_>, rows: &'r [Row]) -> Option<&'r str> {
    columns.cell(rows.first()?, "kind")
}

/// A scenario by its rows, that of its leading run first.
fn seen(columns: &Columns<'_>, rows: &[Row]) -> Seen {
    let Some(row) = rows.first() else { return Seen::default() };
    let is = |verdict: &str| columns.cell(row, "verdict") == Some(verdict);
    let told = |name: &str| columns.filled(row, name);
    let density = columns.cell(row, index::DENSITY).and_then(|cell| cell.parse::<f64>().ok());
    // Of a scenario that was made and has no such cell, it is known that nobody is met.
    let made = told("pattern").is_some();
    let sectors = told("encounter").unwrap_or_default();
    Seen {
        realised: is(Verdict::Realised.name()) || is(Verdict::RealisedLate.name()),
        failed: told("planner").is_none(),
        pattern: told("pattern"),
        place: told("place"),
        location: told("location"),
        context: told("context"),
        encounters: made.then(|| sectors.split_whitespace().map(str::to_owned).collect()),
        band: density.filter(|_| made).or_else(|| made.then_some(0.0)).map(band),
    }
}

/// The band of a density.
fn band(density: f64) -> usize {
    let above = |(_, end): &&(&str, f64)| if *end > 0.0 { density >= *end } else { density > 0.0 };
    BANDS.iter().take_while(above).count().min(BANDS.len() - 1)
}

/// Scenarios by each of these cells and by others that are found.
fn axis(
    (name, plural): (&'static str, &'static str),
    known: impl Iterator<Item = String>,
    seen: &[Seen],
    of: impl Fn(&Seen) -> Option<Vec<String>>,
) -> Axis {
    let mut cells: Vec<(String, Count)> = known.map(|name| (name, Count::default())).collect();
    let known = cells.len();
    let mut found: BTreeMap<String, Count> = BTreeMap::new();
    let mut untold = 0;
    for one in seen {
        let Some(names) = of(one) else {
            untold += 1;
            continue;
        };
        for name in names {
            match cells.iter_mut().find(|(cell, _)| *cell == name) {
                Some((_, count)) => count.add(one),
                None => found.entry(name).or_default().add(one),
            }
        }
    }
    cells.extend(found);
    Axis { name, plural, cells, known, untold }
}

fn axes(seen: &[Seen]) -> Vec<Axis> {
    let one = |cell: &Option<String>| cell.clone().map(|cell| vec![cell]);
    let cards = socrates_offline::catalog().iter().map(|card| card.id.clone());
    let sectors = Sector::ALL.iter().map(|sector| sector.name().to_owned());
    let bands = BANDS.iter().map(|(name, _)| (*name).to_owned());
    let places = PlaceClass::ALL.iter().map(|class| class.name().to_owned());
    let locations = socrates_maps::shipped::names().iter().map(|name| (*name).to_owned());
    let band_of = |one: &Seen| Some(vec![BANDS.get(one.band?)?.0.to_owned()]);
    vec![
        axis(("scenario", "canonical scenarios"), cards, seen, |seen| one(&seen.pattern)),
        axis(("encounter", "encounter angles"), sectors, seen, |seen| {
            seen.encounters.clone().map(|sectors| sectors.into_iter().collect())
        }),
        axis(("density", "densities of people"), bands, seen, band_of),
        axis(("place", "places"), places, seen, |seen| one(&seen.place)),
        axis(("location", "locations"), locations, seen, |seen| one(&seen.location)),
        axis(("context", "social contexts"), std::iter::empty(), seen, |seen| one(&seen.context)),
    ]
}

fn crossed(seen: &[Seen]) -> Vec<Vec<Count>> {
    let cell = |sector: Sector, band: usize| {
        let mut count = Count::default();
        let has = |one: &&Seen| {
            one.band == Some(band) && one.encounters.as_ref().is_some_and(|all| all.contains(sector.name()))
        };
        seen.iter().filter(has).for_each(|one| count.add(one));
        count
    };
    Sector::ALL.iter().map(|sector| (0..BANDS.len()).map(|band| cell(*sector, band)).collect()).collect()
}

/// Runs of distinct scenarios by planner and verdict.
fn planners(columns: &Columns<'_>, distinct: &[&[Row]]) -> Vec<(String, BTreeMap<String, usize>)> {
    // The run without a robot is no planner's.
    let known: Vec<&str> = socrates_planners::names().into_iter().filter(|name| *name != "none").collect();
    let mut found: BTreeMap<&str, BTreeMap<String, usize>> =
        known.iter().map(|name| (*name, BTreeMap::new())).collect();
    for row in distinct.iter().copied().flatten() {
        let Some(planner) = columns.cell(row, "planner").filter(|planner| !planner.is_empty()) else { continue };
        let verdict = columns.cell(row, "verdict").unwrap_or_default().to_owned();
        *found.entry(planner).or_default().entry(verdict).or_default() += 1;
    }
    let first = known.iter().filter_map(|name| Some(((*name).to_owned(), found.remove(name)?)));
    let mut rows: Vec<(String, BTreeMap<String, usize>)> = first.collect();
    rows.extend(found.into_iter().map(|(name, verdicts)| (name.to_owned(), verdicts)));
    rows
}

#[cfg(test)]
mod tests;
