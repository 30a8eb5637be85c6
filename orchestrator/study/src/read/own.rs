//! Answers as lines of JSON: one for each film that a person saw, and one for the person.

use std::collections::BTreeMap;

use serde::Deserialize;
use serde_json::Value;

use super::{Gather, Pseudonyms, Spot, count_check};
use crate::design::Design;
use crate::problem::Problem;
use crate::rating::{Rating, Ratings, Row};

#[derive(Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase", deny_unknown_fields)]
enum Line {
    /// What a person said about a film.
    Film {
        participant: String,
        film: String,
        position: Option<u32>,
        watched_s: Option<f64>,
        rt_s: Option<f64>,
        answers: BTreeMap<String, Value>,
    },
    /// What is known of a person as a whole.
    Person {
        participant: String,
        order: Option<String>,
        duration_s: Option<f64>,
        #[serde(default)]
        checks: BTreeMap<String, Value>,
    },
}

/// Reads lines of JSON.
///
/// # Errors
/// A line that is none of both kinds, an unknown film, item or check, an answer out of range, an answer that stands twice.
pub fn own(text: &str, file: &str, design: &Design, names: Pseudonyms) -> Result<Ratings, Problem> {
    let mut gather = Gather::new(design, names, file);
    let mut persons: BTreeMap<String, u64> = BTreeMap::new();
    for (number, line) in (1_u64..).zip(text.lines()).filter(|(_, line)| !line.trim().is_empty()) {
        let parsed: Line = serde_json::from_str(line).map_err(|why| {
            let hint = "a line is `{\"kind\":\"film\",\"participant\":…,\"film\":…,\"answers\":{…}}` or `{\"kind\":\"person\",…}`";
            Problem::new(file, why.to_string(), hint).line(number)
        })?;
        match parsed {
            Line::Film { participant, film, position, watched_s, rt_s, answers } => {
                let film = gather.film(&film, at(number, "film"))?;
                for (code, value) in answers {
                    gather.item(&code, at(number, &code))?;
                    let rating = match value {
                        Value::Null => Rating::Missing,
                        Value::String(words) => gather.rating(&words, &code, at(number, &code))?,
                        Value::Number(_) | Value::Bool(_) | Value::Array(_) | Value::Object(_) => {
                            gather.rating(&value.to_string(), &code, at(number, &code))?
                        }
                    };
                    let (film, item) = (film.clone(), code.clone());
                    let row = Row { participant: String::new(), film, item, rating, position, rt_s, watched_s };
                    gather.add(&participant, row, at(number, &code))?;
                }
            }
            Line::Person { participant, order, duration_s, checks } => {
                if let Some(before) = persons.insert(participant.clone(), number) {
                    let what = format!("line {before} is about this person already");
                    return Err(gather.bad(at(number, "participant"), &participant, what, "keep one of both lines"));
                }
                let mut results = Vec::new();
                for (name, answer) in &checks {
                    let Some(right) = design.checks.get(name) else {
                        let hint = "name its right answer under `[checks]` of the study";
                        return Err(gather.bad(at(number, "checks"), name, "the study declares no such check", hint));
                    };
                    let told = answer.as_str().map_or_else(|| answer.to_string(), str::to_owned);
                    results.push(told.eq_ignore_ascii_case(right));
                }
                let person = gather.person(&participant);
                (person.order, person.duration_s) = (order, duration_s);
                results.iter().for_each(|right| count_check(person, *right));
            }
        }
    }
    gather.done()
}

const fn at(line: u64, column: &str) -> Spot<'_> {
    Spot { line, column }
}
