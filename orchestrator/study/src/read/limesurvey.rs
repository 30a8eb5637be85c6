//! The CSV of LimeSurvey, exported with question codes and answer codes.

use super::sheet::Sheet;
use super::{Gather, Pseudonyms, Spot, count_check};
use crate::design::Design;
use crate::kit::asks::is_right;
use crate::kit::limesurvey::{PERSON, SEEN, code};
use crate::problem::Problem;
use crate::rating::{Origin, Rating, Ratings, Row};

/// Columns that LimeSurvey adds, and those of our own survey that nothing here needs; addresses are never looked at.
const IGNORED: [&str; 17] = [
    "id",
    "submitdate",
    "lastpage",
    "startlanguage",
    "seed",
    "token",
    "startdate",
    "datestamp",
    "ipaddr",
    "refurl",
    "consent",
    SEEN,
    Origin::KEY,
    "scenario",
    "groupTime",
    "questionTime",
    "",
];
/// Time from start to end, s.
const DURATION: &str = "interviewtime";

/// What a column is.
enum Role {
    Item { film: String, item: String },
    Time { film: String },
    Watched { film: String },
    Position { film: String },
    Check(String),
    Person,
    Order,
    Duration,
    Ignored,
}

fn role(name: &str, design: &Design) -> Option<Role> {
    if IGNORED.contains(&name) || name.starts_with("groupTime") || name.starts_with("questionTime") {
        return Some(Role::Ignored);
    }
    match name {
        PERSON => return Some(Role::Person),
        "order" => return Some(Role::Order),
        DURATION => return Some(Role::Duration),
        _other => {}
    }
    if let Some(check) = design.checks.keys().find(|check| code(check) == name) {
        return Some(Role::Check(check.clone()));
    }
    // The longest name first: one film may begin like another.
    let mut films: Vec<&str> = design.films.iter().map(|film| film.id.as_str()).collect();
    films.sort_by_key(|film| std::cmp::Reverse(film.len()));
    let (film, rest) = films.into_iter().find_map(|film| Some((film.to_owned(), name.strip_prefix(&code(film))?)))?;
    match rest {
        "time" => return Some(Role::Time { film }),
        "watched" => return Some(Role::Watched { film }),
        "position" => return Some(Role::Position { film }),
        "film" => return Some(Role::Ignored),
        _other => {}
    }
    let (instrument, item) = rest.strip_suffix(']')?.split_once('[')?;
    let (of, item) = design.item(item)?;
    (code(&of.instrument.id) == instrument).then(|| Role::Item { film, item: item.code.clone() })
}

/// Reads the CSV of LimeSurvey.
///
/// # Errors
/// An unknown column, nobody named, an answer out of range, a person who answers twice.
pub fn limesurvey(text: &str, file: &str, design: &Design, names: Pseudonyms) -> Result<Ratings, Problem> {
    let sheet = Sheet::read(text, file)?;
    let mut roles = Vec::new();
    for name in &sheet.head {
        let hint =
            "export responses as CSV with `question code` as heading and answer codes; remove columns of your own";
        let found =
            role(name, design).ok_or_else(|| Problem::new(file, "unknown column", hint).line(1).column(name))?;
        roles.push(found);
    }
    let mut gather = Gather::new(design, names, file);
    for (number, cells) in &sheet.lines {
        line(&mut gather, &sheet, &roles, *number, cells)?;
    }
    gather.done()
}

fn line(gather: &mut Gather<'_>, sheet: &Sheet, roles: &[Role], number: u64, cells: &[String]) -> Result<(), Problem> {
    let spot = |column| Spot { line: number, column };
    let id = sheet.cell(cells, PERSON).to_owned();
    if id.is_empty() {
        return Err(gather.bad(spot(PERSON), "", "nobody is named", "remove responses without the id of a person"));
    }
    if gather.knows(&id) {
        let hint = "keep the first response of a person and remove the others, as the study declares";
        return Err(gather.bad(spot(PERSON), &id, "this person has answered on an earlier line", hint));
    }
    gather.origin_of(sheet.cell(cells, Origin::KEY), number)?;
    let place = (number, cells);
    let order = Some(sheet.cell(cells, "order").to_owned()).filter(|order| !order.is_empty());
    let duration_s = if sheet.has(DURATION) { sheet.number(place, DURATION)? } else { None };
    let person = gather.person(&id);
    (person.order, person.duration_s) = (order, duration_s);
    let all: Vec<(&String, &Role, &str)> =
        sheet.head.iter().zip(roles).zip(cells).map(|((name, role), cell)| (name, role, cell.trim())).collect();
    let number_of = |film: &str, what: &str| -> Result<Option<f64>, Problem> {
        let column = format!("{}{what}", code(film));
        if sheet.has(&column) { sheet.number(place, &column) } else { Ok(None) }
    };
    for (name, role, cell) in &all {
        match role {
            Role::Check(check) => {
                let right = gather.design.checks.get(check).cloned().unwrap_or_default();
                if !cell.is_empty() {
                    let is_right = is_right(gather.design, &right, cell);
                    count_check(gather.person(&id), is_right);
                }
            }
            Role::Item { film, item } => {
                // A film that this person was not shown leaves all its columns empty.
                let shown = all.iter().any(|(_, role, cell)| match role {
                    Role::Item { film: of, .. }
                    | Role::Time { film: of }
                    | Role::Watched { film: of }
                    | Role::Position { film: of } => of == film && !cell.is_empty(),
                    Role::Check(_) | Role::Person | Role::Order | Role::Duration | Role::Ignored => false,
                });
                if !shown {
                    continue;
                }
                let rating: Rating = gather.rating(cell, item, spot(name))?;
                let (rt_s, watched_s) = (number_of(film, "time")?, number_of(film, "watched")?);
                #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place in an order")]
                let position = number_of(film, "position")?.map(|place| place.clamp(0.0, 10_000.0) as u32);
                let (film, item) = (film.clone(), item.clone());
                gather.add(
                    &id,
                    Row { participant: String::new(), film, item, rating, position, rt_s, watched_s },
                    spot(name),
                )?;
            }
            Role::Time { .. } | Role::Watched { .. } | Role::Position { .. } => {}
            Role::Person | Role::Order | Role::Duration | Role::Ignored => {}
        }
    }
    Ok(())
}
