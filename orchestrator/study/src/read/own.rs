//! Answers as lines of JSON: one for each film that a person saw, and one for the person.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::{Gather, Pseudonyms, Spot, count_check};
use crate::design::Design;
use crate::kit::asks::is_right;
use crate::problem::Problem;
use crate::rating::{Rating, Ratings, Row};

/// A line of the book of a survey.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase", deny_unknown_fields)]
pub enum Line {
    /// Somebody begins.
    Begin {
        /// The participant, as an id or as its hash.
        participant: String,
        /// By this they come back.
        token: String,
        /// The order of films that they get.
        order: String,
    },
    /// What a person said about a film.
    Film {
        /// The participant.
        participant: String,
        /// The film.
        film: String,
        /// Its place in their order, from 1.
        position: Option<u32>,
        /// How much of it was played, s.
        watched_s: Option<f64>,
        /// Time to answer, s.
        rt_s: Option<f64>,
        /// Answers by item: points, words, or null where nothing was said.
        answers: BTreeMap<String, Value>,
        /// Answers to attention checks.
        #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
        checks: BTreeMap<String, Value>,
        /// Whether the answers are simulated: no person gave them.
        #[serde(default, skip_serializing_if = "std::ops::Not::not")]
        simulated: bool,
    },
    /// What is known of a person as a whole.
    Person {
        /// The participant.
        participant: String,
        /// The order of films that they saw.
        order: Option<String>,
        /// Time from start to end, s.
        duration_s: Option<f64>,
        /// Answers to attention checks.
        #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
        checks: BTreeMap<String, Value>,
        /// Whether the person is simulated.
        #[serde(default, skip_serializing_if = "std::ops::Not::not")]
        simulated: bool,
    },
}

/// Reads lines of JSON.
///
/// # Errors
/// A line that is none of both kinds, an unknown film, item or check, an answer out of range, an answer that stands twice, simulated
/// answers beside those of people.
pub fn own(text: &str, file: &str, design: &Design, names: Pseudonyms) -> Result<Ratings, Problem> {
    let mut gather = Gather::new(design, names, file);
    let mut persons: BTreeMap<String, u64> = BTreeMap::new();
    for (number, line) in (1_u64..).zip(text.lines()).filter(|(_, line)| !line.trim().is_empty()) {
        let parsed: Line = serde_json::from_str(line).map_err(|why| {
            let hint = "a line is `{\"kind\":\"film\",\"participant\":…,\"film\":…,\"answers\":{…}}` or `{\"kind\":\"person\",…}`";
            Problem::new(file, why.to_string(), hint).line(number)
        })?;
        match parsed {
            Line::Begin { participant, order, .. } => gather.person(&participant).order = Some(order),
            Line::Film { participant, film, position, watched_s, rt_s, answers, checks, simulated } => {
                gather.origin(simulated.into(), number)?;
                count(&mut gather, design, number, &participant, &checks)?;
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
            Line::Person { participant, order, duration_s, checks, simulated } => {
                gather.origin(simulated.into(), number)?;
                if let Some(before) = persons.insert(participant.clone(), number) {
                    let what = format!("line {before} is about this person already");
                    return Err(gather.bad(at(number, "participant"), &participant, what, "keep one of both lines"));
                }
                count(&mut gather, design, number, &participant, &checks)?;
                let person = gather.person(&participant);
                person.order = order.or_else(|| person.order.take());
                person.duration_s = duration_s;
            }
        }
    }
    gather.done()
}

/// Counts answers to checks.
fn count(
    gather: &mut Gather<'_>,
    design: &Design,
    number: u64,
    participant: &str,
    checks: &BTreeMap<String, Value>,
) -> Result<(), Problem> {
    for (name, answer) in checks {
        let Some(right) = design.checks.get(name) else {
            let hint = "name its right answer under `[checks]` of the study";
            return Err(gather.bad(at(number, "checks"), name, "the study declares no such check", hint));
        };
        let told = answer.as_str().map_or_else(|| answer.to_string(), str::to_owned);
        let is_right = is_right(design, right, &told);
        count_check(gather.person(participant), is_right);
    }
    Ok(())
}

const fn at(line: u64, column: &str) -> Spot<'_> {
    Spot { line, column }
}
