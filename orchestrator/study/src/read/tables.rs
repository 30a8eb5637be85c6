//! The tidy tables: one line for each rating, one for each person.

use std::collections::BTreeMap;

use super::sheet::Sheet;
use super::{Gather, Pseudonyms, Spot};
use crate::design::Design;
use crate::problem::Problem;
use crate::rating::{Origin, Ratings, Row};

/// Columns of `ratings.csv`; [`Origin::KEY`] follows where the answers are simulated.
const RATINGS: [&str; 17] = [
    "participant",
    "scenario",
    "planner",
    "seed",
    "film",
    "order",
    "position",
    "instrument",
    "dimension",
    "item",
    "reversed",
    "raw",
    "score",
    "rt_s",
    "watched_s",
    "excluded",
    "excluded_by",
];
/// Columns of `participants.csv`; [`Origin::KEY`] follows where the people are simulated.
const PEOPLE: [&str; 8] = ["participant", "order", "duration_s", "checks", "checks_failed", "status", "age", "sex"];

/// The table as text; a last column marks every line of simulated answers.
fn csv_of(head: &[&str], origin: Origin, lines: impl Iterator<Item = Vec<String>>) -> String {
    let mark = |key: &str| origin.is_simulated().then(|| key.to_owned());
    let mut writer = csv::WriterBuilder::new().from_writer(Vec::new());
    // Writing into memory has no error but that of a line of another length, which these have not.
    let mut wrong = writer.write_record(head.iter().map(|name| (*name).to_owned()).chain(mark(Origin::KEY))).is_err();
    for line in lines {
        wrong |= writer.write_record(line.into_iter().chain(mark("1"))).is_err();
    }
    debug_assert!(!wrong, "lines of one length");
    writer.into_inner().ok().and_then(|bytes| String::from_utf8(bytes).ok()).unwrap_or_default()
}

fn shown(number: Option<f64>) -> String {
    number.map_or_else(String::new, |number| number.to_string())
}

/// `ratings.csv`: a missing rating is an empty cell in `raw` and `score`. `excluded_by` gives the rules of a person, none where
/// they stay.
#[must_use]
pub fn ratings_csv(ratings: &Ratings, design: &Design, excluded_by: &dyn Fn(&str) -> Vec<&'static str>) -> String {
    let orders: BTreeMap<&str, &str> =
        ratings.participants.iter().filter_map(|person| Some((person.id.as_str(), person.order.as_deref()?))).collect();
    let order = |id: &str| orders.get(id).copied().unwrap_or_default().to_owned();
    csv_of(
        &RATINGS,
        ratings.origin,
        ratings.rows.iter().filter_map(|row| {
            let (film, (dimension, item)) = (design.film(&row.film)?, design.item(&row.item)?);
            let rules = excluded_by(&row.participant);
            Some(vec![
                row.participant.clone(),
                film.scenario.clone(),
                film.planner.clone(),
                film.seed.to_string(),
                film.id.clone(),
                order(&row.participant),
                row.position.map_or_else(String::new, |place| place.to_string()),
                dimension.instrument.id.clone(),
                dimension.id(),
                item.code.clone(),
                u8::from(item.reversed).to_string(),
                shown(row.rating.points()),
                shown(dimension.instrument.keyed(item, row.rating)),
                shown(row.rt_s),
                shown(row.watched_s),
                u8::from(!rules.is_empty()).to_string(),
                rules.join(" "),
            ])
        }),
    )
}

/// `participants.csv`.
#[must_use]
pub fn participants_csv(ratings: &Ratings) -> String {
    let text = |of: &Option<String>| of.clone().unwrap_or_default();
    csv_of(
        &PEOPLE,
        ratings.origin,
        ratings.participants.iter().map(|person| {
            let count =
                |of: fn((u32, u32)) -> u32| person.checks.map_or_else(String::new, |checks| of(checks).to_string());
            vec![
                person.id.clone(),
                text(&person.order),
                shown(person.duration_s),
                count(|checks| checks.0),
                count(|checks| checks.1),
                text(&person.status),
                text(&person.age),
                text(&person.sex),
            ]
        }),
    )
}

/// Reads a table of ratings: `participant`, `item` and `raw`, and either `film` or `scenario` and `planner` (with `seed` where a
/// scenario has several films of a planner); other columns of [`ratings_csv`] as far as they are there. `people` is the text of
/// `participants.csv`. Names of people are kept as they are.
///
/// # Errors
/// A missing or unknown column, an unknown film or item, an answer out of range, an answer twice, simulated answers beside those of people.
pub fn ratings_of_csv(
    text: &str,
    people: Option<(&str, &str)>,
    file: &str,
    design: &Design,
) -> Result<Ratings, Problem> {
    let sheet = Sheet::read(text, file)?;
    sheet.need(&["participant", "item", "raw"])?;
    if !sheet.has("film") {
        sheet.need(&["scenario", "planner"])?;
    }
    if let Some(unknown) =
        sheet.head.iter().find(|name| !RATINGS.contains(&name.as_str()) && name.as_str() != Origin::KEY)
    {
        let hint = format!("columns are {}", RATINGS.join(", "));
        return Err(Problem::new(file, "unknown column", hint).line(1).column(unknown));
    }
    // Hashed for the time of reading alone; the names come back below.
    let mut gather = Gather::new(design, Pseudonyms { key: [0; 32] }, file);
    let mut names = BTreeMap::new();
    for (number, cells) in &sheet.lines {
        let spot = |column| Spot { line: *number, column };
        let cell = |column: &str| sheet.cell(cells, column);
        gather.origin_of(cell(Origin::KEY), *number)?;
        let film = film_of(&gather, &cell, *number)?;
        let code = cell("item");
        gather.item(code, spot("item"))?;
        let rating = gather.rating(cell("raw"), code, spot("raw"))?;
        let at = (*number, cells.as_slice());
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place in an order")]
        let position = sheet.number(at, "position")?.map(|place| place.min(10_000.0) as u32);
        let (rt_s, watched_s) = (sheet.number(at, "rt_s")?, sheet.number(at, "watched_s")?);
        let id = cell("participant");
        if id.is_empty() {
            return Err(gather.bad(spot("participant"), "", "nobody is named", "each line names its person"));
        }
        names.insert(gather.names.of(id), id.to_owned());
        let row = Row { participant: String::new(), film, item: code.to_owned(), rating, position, rt_s, watched_s };
        gather.add(id, row, spot("raw"))?;
        let order = Some(cell("order").to_owned()).filter(|order| !order.is_empty());
        if order.is_some() {
            gather.person(id).order = order;
        }
    }
    let mut all = gather.done()?;
    let name = |id: &str| names.get(id).cloned().unwrap_or_else(|| id.to_owned());
    all.rows.iter_mut().for_each(|row| row.participant = name(&row.participant));
    all.participants.iter_mut().for_each(|person| person.id = name(&person.id));
    if let Some((text, file)) = people {
        add_people(&mut all, text, file)?;
    }
    Ratings::join(vec![(file.to_owned(), all)])
}

fn film_of<'c>(gather: &Gather<'_>, cell: &dyn Fn(&str) -> &'c str, line: u64) -> Result<String, Problem> {
    let spot = |column| Spot { line, column };
    let film = cell("film");
    if !film.is_empty() {
        return gather.film(film, spot("film"));
    }
    let (scenario, planner, seed) = (cell("scenario"), cell("planner"), cell("seed"));
    let fits = |film: &&crate::rating::Film| {
        film.scenario == scenario && film.planner == planner && (seed.is_empty() || film.seed.to_string() == seed)
    };
    let mut found = gather.design.films.iter().filter(fits);
    match (found.next(), found.next()) {
        (Some(film), None) => Ok(film.id.clone()),
        (Some(_), Some(_)) => {
            let what = "several films of the study fit";
            Err(gather.bad(spot("planner"), &format!("{scenario}, {planner}"), what, "add the column `seed` or `film`"))
        }
        (None, _) => {
            let what = "no film of the study shows this";
            Err(gather.bad(
                spot("planner"),
                &format!("{scenario}, {planner}"),
                what,
                "add it as `[[film]]` to the study",
            ))
        }
    }
}

fn add_people(all: &mut Ratings, text: &str, file: &str) -> Result<(), Problem> {
    let sheet = Sheet::read(text, file)?;
    sheet.need(&["participant"])?;
    let places: BTreeMap<String, usize> =
        all.participants.iter().enumerate().map(|(at, person)| (person.id.clone(), at)).collect();
    for (number, cells) in &sheet.lines {
        let text = |column: &str| Some(sheet.cell(cells, column).to_owned()).filter(|cell| !cell.is_empty());
        let place = places.get(sheet.cell(cells, "participant"));
        let Some(person) = place.and_then(|at| all.participants.get_mut(*at)) else { continue };
        let mark = sheet.cell(cells, Origin::KEY);
        if Origin::of_cell(mark) != Some(all.origin) {
            let what = format!("these people are not those of the ratings, which are {}", all.origin.name());
            let hint = "keep the tables of one `study read` together";
            return Err(Problem::new(file, what, hint).line(*number).column(Origin::KEY).value(mark));
        }
        let at = (*number, cells.as_slice());
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count of checks")]
        let count = |column: &str| Ok(sheet.number(at, column)?.map(|count| count.min(1e6) as u32));
        let (asked, failed): (Option<u32>, Option<u32>) = (count("checks")?, count("checks_failed")?);
        person.duration_s = sheet.number(at, "duration_s")?;
        person.checks = asked.zip(failed);
        (person.status, person.age, person.sex) = (text("status"), text("age"), text("sex"));
        person.order = text("order").or_else(|| person.order.clone());
    }
    Ok(())
}
