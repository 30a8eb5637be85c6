//! The CSV of jsPsych 8: a line for each trial.
//!
//! `survey-likert` counts its answers from 0, whatever the scale; `video-slider-response` gives points of a slider.

use std::collections::BTreeMap;

use serde_json::Value;

use super::sheet::Sheet;
use super::{Gather, Pseudonyms, Spot, count_check};
use crate::design::Design;
use crate::kit::asks::is_right;
use crate::problem::Problem;
use crate::rating::{Origin, Rating, Ratings, Row};

/// Columns that may hold the id of a person, the first that is there counts.
const PEOPLE: [&str; 3] = ["PROLIFIC_PID", "participant", "subject"];

/// Reads jsPsych's CSV. Each trial that asks has the film in the column `film`; a trial that is an attention check has its name in
/// `check`; a slider has the code of its item in `item`.
///
/// # Errors
/// A missing column, an unknown film or item, an answer out of range, Likert answers that count from 1 or now from 0 and now from
/// 1, an answer that stands twice.
pub fn jspsych(text: &str, file: &str, design: &Design, names: Pseudonyms) -> Result<Ratings, Problem> {
    let sheet = Sheet::read(text, file)?;
    sheet.need(&["trial_type", "response", "film"])?;
    let Some(person) = PEOPLE.into_iter().find(|name| sheet.has(name)) else {
        let hint = "`jsPsych.data.addProperties({PROLIFIC_PID: …})` adds it";
        return Err(Problem::new(file, "no column tells who answered", hint).line(1).column(&PEOPLE.join(" or ")));
    };
    let mut gather = Gather::new(design, names, file);
    let mut likert = Vec::new();
    let mut positions: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for (number, cells) in &sheet.lines {
        let spot = |column| Spot { line: *number, column };
        let cell = |column: &str| sheet.cell(cells, column);
        let id = cell(person);
        if id.is_empty() {
            return Err(gather.bad(spot(person), "", "nobody is named", "each line carries the id of its person"));
        }
        let kind = cell("trial_type");
        if !matches!(kind, "survey-likert" | "video-slider-response" | "html-slider-response") {
            continue;
        }
        gather.origin_of(cell(Origin::KEY), *number)?;
        // What the page adds to every line, and how long the person has been there.
        let elapsed = sheet.number((*number, cells), "time_elapsed")?.map(|ms| ms / 1000.0);
        let of = gather.person(id);
        of.order = of.order.take().or_else(|| Some(cell("order")).filter(|order| !order.is_empty()).map(str::to_owned));
        of.duration_s = of.duration_s.into_iter().chain(elapsed).reduce(f64::max);
        let check = cell("check");
        if !check.is_empty() {
            let Some(right) = design.checks.get(check) else {
                let hint = "name its right answer under `[checks]` of the study";
                return Err(gather.bad(spot("check"), check, "the study declares no such check", hint));
            };
            let told = parsed(&gather, cell("response"), spot("response"))?;
            // Counted from 0 like every answer of this plugin.
            let answers: Vec<f64> =
                told.as_object().into_iter().flatten().filter_map(|(_, one)| one.as_f64()).collect();
            let is_right = answers.iter().all(|one| is_right(design, right, &(one + 1.0).to_string()));
            count_check(gather.person(id), is_right && !answers.is_empty());
            continue;
        }
        let film = gather.film(cell("film"), spot("film"))?;
        let seen = positions.entry(id.to_owned()).or_default();
        if !seen.contains(&film) {
            seen.push(film.clone());
        }
        let position = seen.iter().position(|one| *one == film).and_then(|at| u32::try_from(at + 1).ok());
        let rt_s = sheet.number((*number, cells), "rt")?.map(|ms| ms / 1000.0);
        let watched_s = sheet.number((*number, cells), "watched_s")?;
        let row = |item: &str, rating| {
            let (film, item) = (film.clone(), item.to_owned());
            Row { participant: String::new(), film, item, rating, position, rt_s, watched_s }
        };
        if kind != "survey-likert" {
            let rating = gather.rating(cell("response"), cell("item"), spot("response"))?;
            gather.add(id, row(cell("item"), rating), spot("response"))?;
            continue;
        }
        let told = parsed(&gather, cell("response"), spot("response"))?;
        let Some(told) = told.as_object() else {
            let hint = "`survey-likert` writes `{\"RB1\":3}`; name each question after its item";
            return Err(gather.bad(spot("response"), cell("response"), "no answers by item", hint));
        };
        for (code, value) in told {
            gather.item(code, spot(code))?;
            likert.push((id.to_owned(), row(code, Rating::Missing), value.clone(), *number));
        }
    }
    add_likert(&mut gather, likert)?;
    gather.done()
}

fn parsed(gather: &Gather<'_>, text: &str, spot: Spot<'_>) -> Result<Value, Problem> {
    serde_json::from_str(text).map_err(|why| {
        gather.bad(spot, text, format!("no JSON ({why})"), "`survey-likert` writes `{\"RB1\":3}` into `response`")
    })
}

/// Adds Likert answers once it is known that all of them count from 0.
fn add_likert(gather: &mut Gather<'_>, answers: Vec<(String, Row, Value, u64)>) -> Result<(), Problem> {
    let zero = answers
        .iter()
        .find(|(_, _, value, _)| value.as_f64().is_some_and(|value| value.abs() < 1e-9))
        .map(|(.., at)| *at);
    for (id, mut row, value, number) in answers {
        let spot = Spot { line: number, column: &row.item.clone() };
        let (low, high) = gather.item(&row.item, spot)?.instrument.points;
        row.rating = match value.as_f64() {
            None if value.is_null() || value.as_str() == Some("") => Rating::Missing,
            Some(step) if (step - (high - low + 1.0)).abs() < 1e-9 => {
                let (what, hint) = zero.map_or_else(
                    || {
                        (
                            "answers of this file count from 1".to_owned(),
                            "subtract 1 from all Likert answers: jsPsych counts from 0",
                        )
                    },
                    |at| {
                        (
                            format!("this counts from 1, and line {at} counts from 0"),
                            "read files of both kinds apart, after subtracting 1 in one of them",
                        )
                    },
                );
                return Err(gather.bad(spot, &value.to_string(), what, hint));
            }
            Some(step) => gather.rating(&(step + low).to_string(), &row.item, spot).map_err(|mut why| {
                why.value = Some(value.to_string());
                why
            })?,
            None => return Err(gather.bad(spot, &value.to_string(), "no answer", "a number from 0 is expected")),
        };
        gather.add(&id, row, spot)?;
    }
    Ok(())
}
