//! The CSV of Qualtrics: three head lines, of which the third tells columns apart.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::Value;

use super::sheet::Sheet;
use super::{Gather, Pseudonyms, Spot, count_check};
use crate::design::Design;
use crate::kit::asks::is_right;
use crate::problem::Problem;
use crate::rating::{Origin, Ratings, Row};

/// Columns that Qualtrics adds and that are never kept: addresses, places, names, mail.
const DROPPED: [&str; 12] = [
    "IPAddress",
    "ipAddress",
    "LocationLatitude",
    "locationLatitude",
    "LocationLongitude",
    "locationLongitude",
    "RecipientLastName",
    "recipientLastName",
    "RecipientFirstName",
    "recipientFirstName",
    "RecipientEmail",
    "recipientEmail",
];
/// Columns that Qualtrics adds and that nothing here needs.
const UNUSED: [&str; 17] = [
    "startDate",
    "endDate",
    "recordedDate",
    "externalDataReference",
    "distributionChannel",
    "userLanguage",
    "progress",
    "_recordId",
    "StartDate",
    "EndDate",
    "RecordedDate",
    "ExternalReference",
    "DistributionChannel",
    "UserLanguage",
    "ResponseId",
    "STUDY_ID",
    "SESSION_ID",
];
/// Endings of the columns of a timer that nothing here needs, by ImportId.
const TIMERS: [&str; 3] = ["_FIRST_CLICK", "_LAST_CLICK", "_CLICK_COUNT"];

/// What a column is.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Role {
    /// An item about a film.
    Item { film: String, item: String },
    /// Seconds on the page of a film.
    Time { film: String },
    /// Seconds of a film that were played.
    Watched { film: String },
    /// Place of a film in the order, from 1.
    Position { film: String },
    /// Id of the person who answered.
    Person,
    /// The order of films.
    Order,
    /// Time from start to end, s.
    Duration,
    /// Whether the survey was finished.
    Finished,
    /// Whether it is a preview.
    Status,
    /// An attention check.
    Check(String),
    /// Whether the answers are simulated.
    Origin,
    /// Nothing that is kept.
    Ignored,
}

/// Which column is what, for surveys whose columns are not called `FILM_ITEM`: by ImportId.
#[derive(Debug, Default)]
pub struct Codebook(BTreeMap<String, Role>);

impl Codebook {
    /// Reads `column,role,film,item`: `column` is the ImportId (with `/choiceId` where it has one), `role` one of item, time,
    /// watched, position, participant, order, check (its name in `item`), ignored.
    ///
    /// # Errors
    /// A missing column, an unknown role, a column twice.
    pub fn read(text: &str, file: &str) -> Result<Self, Problem> {
        let sheet = Sheet::read(text, file)?;
        sheet.need(&["column", "role", "film", "item"])?;
        let mut found = BTreeMap::new();
        for (number, cells) in &sheet.lines {
            let (film, item) = (sheet.cell(cells, "film").to_owned(), sheet.cell(cells, "item").to_owned());
            let role = match sheet.cell(cells, "role") {
                "item" => Role::Item { film, item },
                "time" => Role::Time { film },
                "watched" => Role::Watched { film },
                "position" => Role::Position { film },
                "participant" => Role::Person,
                "order" => Role::Order,
                "check" => Role::Check(item),
                "ignored" => Role::Ignored,
                other => {
                    let hint = "roles are item, time, watched, position, participant, order, check, ignored";
                    return Err(Problem::new(file, "no role", hint).line(*number).column("role").value(other));
                }
            };
            let column = sheet.cell(cells, "column");
            if found.insert(column.to_owned(), role).is_some() {
                let hint = "one line for each ImportId";
                return Err(Problem::new(file, "it stands twice", hint).line(*number).column("column").value(column));
            }
        }
        Ok(Self(found))
    }
}

/// Reads the CSV of Qualtrics; answers may be codes or words. Addresses, places, names and mail are never looked at.
///
/// Without a codebook a column is called `FILM_ITEM`, `FILM_time`, `FILM_watched` or `FILM_position` in the first head line, an
/// attention check by its name in the study, the person `PROLIFIC_PID`, and the order `order`.
///
/// # Errors
/// Fewer than three head lines, two columns of one ImportId, an unknown column, an answer out of range, a person who answers twice.
pub fn qualtrics(
    text: &str,
    file: &str,
    design: &Design,
    names: Pseudonyms,
    book: &Codebook,
) -> Result<Ratings, Problem> {
    let sheet = Sheet::read(text, file)?;
    let roles = roles(&sheet, file, design, book)?;
    let mut gather = Gather::new(design, names, file);
    for (number, cells) in sheet.lines.iter().skip(2) {
        line(&mut gather, &sheet.head, &roles, *number, cells)?;
    }
    gather.done()
}

/// The ImportId of each column, and from it what the column is.
fn roles(sheet: &Sheet, file: &str, design: &Design, book: &Codebook) -> Result<Vec<Role>, Problem> {
    let third = sheet.lines.get(1).filter(|(_, cells)| cells.first().is_some_and(|cell| cell.contains("ImportId")));
    let Some((number, ids)) = third else {
        let hint = "export from Qualtrics with `Download Data Table`, CSV, and leave its three head lines";
        return Err(Problem::new(file, "the third line holds no ImportIds", hint).line(3));
    };
    let (mut found, mut seen, mut people) = (Vec::new(), BTreeSet::new(), 0);
    for (name, cell) in sheet.head.iter().zip(ids) {
        let bad = |what: &str, hint: &str| Problem::new(file, what, hint).line(*number).column(name).value(cell);
        let object: Value = serde_json::from_str(cell)
            .map_err(|why| bad(&format!("no ImportId ({why})"), "leave the three head lines as they are"))?;
        let part = |key: &str| object.get(key).and_then(Value::as_str);
        let Some(id) = part("ImportId") else {
            return Err(bad("no ImportId", "leave the three head lines as they are"));
        };
        let whole = part("choiceId").map_or_else(|| id.to_owned(), |choice| format!("{id}/{choice}"));
        if !seen.insert(whole.clone()) {
            return Err(bad("two columns have this ImportId", "remove the one that was added by hand"));
        }
        let role = book.0.get(&whole).cloned().or_else(|| role_of(name, &whole, design));
        let Some(role) = role else {
            let hint = format!("call it FILM_ITEM, or add `{whole},ignored,,` to a codebook (`--codebook FILE`)");
            return Err(bad("unknown column", &hint));
        };
        people += usize::from(role == Role::Person);
        found.push(role);
    }
    if people != 1 {
        let what = format!("{people} columns tell who answered, and one is expected");
        return Err(Problem::new(file, what, "embedded data `PROLIFIC_PID`, or `participant` in the codebook").line(1));
    }
    Ok(found)
}

/// What a column is by its name; none where it cannot be told.
fn role_of(name: &str, id: &str, design: &Design) -> Option<Role> {
    if DROPPED.contains(&id)
        || DROPPED.contains(&name)
        || TIMERS.iter().any(|end| id.ends_with(end))
        || id.contains("_DO")
    {
        return Some(Role::Ignored);
    }
    match name {
        "PROLIFIC_PID" | "participant" => return Some(Role::Person),
        "order" => return Some(Role::Order),
        "Duration (in seconds)" => return Some(Role::Duration),
        "Finished" => return Some(Role::Finished),
        "Status" => return Some(Role::Status),
        Origin::KEY => return Some(Role::Origin),
        _other => {}
    }
    if design.checks.contains_key(name) {
        return Some(Role::Check(name.to_owned()));
    }
    if UNUSED.contains(&id) || UNUSED.contains(&name) {
        return Some(Role::Ignored);
    }
    let (film, rest) = name.split_once('_')?;
    let film = design.film(film)?.id.clone();
    match rest {
        "time" | "time_Page Submit" => Some(Role::Time { film }),
        "watched" => Some(Role::Watched { film }),
        "position" => Some(Role::Position { film }),
        code => design.item(code).map(|(_, item)| Role::Item { film, item: item.code.clone() }),
    }
}

/// One response.
fn line(
    gather: &mut Gather<'_>,
    head: &[String],
    roles: &[Role],
    number: u64,
    cells: &[String],
) -> Result<(), Problem> {
    let with: Vec<(&String, &Role, &str)> =
        head.iter().zip(roles).zip(cells).map(|((name, role), cell)| (name, role, cell.trim())).collect();
    let of = |wanted: &Role| with.iter().find(|(_, role, _)| *role == wanted).map(|(name, _, cell)| (*name, *cell));
    // Previews of the survey's author are no answers.
    if of(&Role::Status).is_some_and(|(_, cell)| matches!(cell, "1" | "Survey Preview")) {
        return Ok(());
    }
    gather.origin_of(of(&Role::Origin).map_or("", |(_, cell)| cell), number)?;
    let spot = |column| Spot { line: number, column };
    let Some((column, id)) = of(&Role::Person).filter(|(_, id)| !id.is_empty()) else {
        return Err(gather.bad(
            spot("participant"),
            "",
            "nobody is named",
            "remove responses without the id of a person",
        ));
    };
    if gather.knows(id) {
        let hint = "keep the first response of a person and remove the others, as the study declares";
        return Err(gather.bad(spot(column), id, "this person has answered on an earlier line", hint));
    }
    let mut numbers: BTreeMap<(&str, &str), f64> = BTreeMap::new();
    for (name, role, cell) in &with {
        let kind = match role {
            Role::Time { film } => ("time", film.as_str()),
            Role::Watched { film } => ("watched", film.as_str()),
            Role::Position { film } => ("position", film.as_str()),
            Role::Duration => ("duration", ""),
            Role::Item { .. }
            | Role::Person
            | Role::Order
            | Role::Finished
            | Role::Status
            | Role::Check(_)
            | Role::Origin
            | Role::Ignored => continue,
        };
        if cell.is_empty() {
            continue;
        }
        let value = cell.parse::<f64>().ok().filter(|value| value.is_finite() && *value >= 0.0);
        let bad = || gather.bad(spot(name), cell, "no number of at least 0", "a number such as 12.5, or nothing");
        numbers.insert(kind, value.ok_or_else(bad)?);
    }
    let mut shown: BTreeSet<&str> = numbers.keys().map(|(_, film)| *film).collect();
    shown.extend(with.iter().filter_map(|(_, role, cell)| match role {
        Role::Item { film, .. } if !cell.is_empty() => Some(film.as_str()),
        Role::Item { .. }
        | Role::Time { .. }
        | Role::Watched { .. }
        | Role::Position { .. }
        | Role::Person
        | Role::Order => None,
        Role::Duration | Role::Finished | Role::Status | Role::Check(_) | Role::Origin | Role::Ignored => None,
    }));
    let person = gather.person(id);
    person.order = of(&Role::Order).map(|(_, cell)| cell.to_owned()).filter(|cell| !cell.is_empty());
    person.duration_s = numbers.get(&("duration", "")).copied();
    for (name, role, cell) in &with {
        match role {
            Role::Check(check) => {
                let right = gather.design.checks.get(check).cloned();
                let Some(right) = right else {
                    let hint = "name its right answer under `[checks]` of the study";
                    return Err(gather.bad(spot(name), check, "the study declares no such check", hint));
                };
                let is_right = is_right(gather.design, &right, cell);
                count_check(gather.person(id), is_right);
            }
            // A film that this person was not shown leaves all its columns empty.
            Role::Item { film, .. } if !shown.contains(film.as_str()) => {}
            Role::Item { film, item } => {
                let film = gather.film(film, spot(name))?;
                gather.item(item, spot(name))?;
                let rating = gather.rating(cell, item, spot(name))?;
                let of = |kind| numbers.get(&(kind, film.as_str())).copied();
                let (rt_s, watched_s) = (of("time"), of("watched"));
                #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place in an order")]
                let position = of("position").map(|place| place.min(10_000.0) as u32);
                let item = item.clone();
                let row = Row { participant: String::new(), film, item, rating, position, rt_s, watched_s };
                gather.add(id, row, spot(name))?;
            }
            Role::Time { .. } | Role::Watched { .. } | Role::Position { .. } | Role::Person | Role::Order => {}
            Role::Duration | Role::Finished | Role::Status | Role::Origin | Role::Ignored => {}
        }
    }
    Ok(())
}
