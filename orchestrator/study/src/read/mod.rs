//! Files of answers, as survey programs write them, become one table of ratings.

mod jspsych;
mod limesurvey;
mod own;
mod prolific;
mod qualtrics;
pub(crate) mod sheet;
mod tables;

use std::collections::{BTreeMap, BTreeSet};

pub use jspsych::jspsych;
pub use limesurvey::limesurvey;
pub use own::{Line, own};
pub use prolific::{Submission, prolific};
pub use qualtrics::{Codebook, qualtrics};
pub use tables::{participants_csv, ratings_csv, ratings_of_csv};

use crate::design::{Design, Dimension};
use crate::problem::Problem;
use crate::rating::{Origin, Participant, Rating, Ratings, Row};

/// A format of answers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Lines of JSON.
    Own,
    /// The CSV of jsPsych.
    JsPsych,
    /// The CSV of Qualtrics.
    Qualtrics,
    /// The CSV of LimeSurvey.
    LimeSurvey,
}

/// The format of a text.
///
/// # Errors
/// It is none of those that are read.
pub fn format_of(text: &str, file: &str) -> Result<Format, Problem> {
    let text = text.trim_start_matches('\u{feff}').trim_start();
    let head = text.lines().next().unwrap_or_default();
    if text.starts_with('{') {
        return Ok(Format::Own);
    }
    if head.split(',').any(|name| name.trim_matches('"') == "trial_type") {
        return Ok(Format::JsPsych);
    }
    if head.split(',').any(|name| name.trim_matches('"') == crate::kit::limesurvey::PERSON) {
        return Ok(Format::LimeSurvey);
    }
    // Question texts of the second head line may hold line ends.
    if text.get(..text.floor_char_boundary(2_000_000)).is_some_and(|begin| begin.contains("ImportId")) {
        return Ok(Format::Qualtrics);
    }
    let hint = "lines of JSON, the CSV of Qualtrics with its three head lines, and those of jsPsych and LimeSurvey are read; a table of ratings goes to `study analyze` as it is";
    Err(Problem::new(file, "no format of answers that is known", hint).line(1).value(head))
}

/// Hint for a mixture of origins.
const UNMIXED: &str = "read simulated answers apart from those of people, into another folder";

/// Begins an id that is a hash already.
pub const HASHED: char = '~';

/// Replaces the ids under which people came: a keyed hash, so that nobody without the key finds them again.
#[derive(Debug, Clone, Copy)]
pub struct Pseudonyms {
    /// Key of the hash; kept beside the answers and never handed on.
    pub key: [u8; 32],
}

impl Pseudonyms {
    /// The name of a person in all tables: 12 hexadecimal digits. An id that our own survey hashed when the person came keeps its name.
    #[must_use]
    pub fn of(&self, id: &str) -> String {
        let hashed =
            id.strip_prefix(HASHED).filter(|rest| rest.len() == 12 && rest.chars().all(|c| c.is_ascii_hexdigit()));
        if let Some(name) = hashed {
            return name.to_owned();
        }
        blake3::keyed_hash(&self.key, id.trim().as_bytes()).to_hex().chars().take(12).collect()
    }
}

/// What one person said, on the way into the table.
#[derive(Debug, Default)]
struct Gathered {
    person: Participant,
    rows: BTreeMap<(String, String), (Row, String)>,
}

/// Ratings as they come in, refused where one stands twice.
pub(crate) struct Gather<'d> {
    pub(crate) design: &'d Design,
    pub(crate) names: Pseudonyms,
    pub(crate) file: String,
    people: BTreeMap<String, Gathered>,
    /// Origin of the first answer, and its line.
    origin: Option<(Origin, u64)>,
}

/// Where an answer stands: line and column.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Spot<'s> {
    pub(crate) line: u64,
    pub(crate) column: &'s str,
}

impl<'d> Gather<'d> {
    pub(crate) fn new(design: &'d Design, names: Pseudonyms, file: &str) -> Self {
        Self { design, names, file: file.to_owned(), people: BTreeMap::new(), origin: None }
    }

    /// The person who came under an id.
    pub(crate) fn person(&mut self, id: &str) -> &mut Participant {
        let name = self.names.of(id);
        let of = self.people.entry(name.clone()).or_default();
        of.person.id = name;
        &mut of.person
    }

    /// Whether anything is known of them.
    pub(crate) fn knows(&self, id: &str) -> bool {
        self.people.contains_key(&self.names.of(id))
    }

    pub(crate) fn bad(&self, spot: Spot<'_>, value: &str, what: impl Into<String>, hint: impl Into<String>) -> Problem {
        Problem::new(&self.file, what, hint).line(spot.line).column(spot.column).value(value)
    }

    /// Notes the origin of an answer; refuses a file that mixes simulated answers with those of people.
    pub(crate) fn origin(&mut self, origin: Origin, line: u64) -> Result<(), Problem> {
        let (first, at) = *self.origin.get_or_insert((origin, line));
        if first == origin {
            return Ok(());
        }
        let what = format!("line {at} holds {}, and this line {}", first.name(), origin.name());
        let spot = Spot { line, column: Origin::KEY };
        Err(self.bad(spot, &origin.is_simulated().to_string(), what, UNMIXED))
    }

    /// The same of the origin that a cell states.
    pub(crate) fn origin_of(&mut self, cell: &str, line: u64) -> Result<(), Problem> {
        let hint = "1 for a simulated answer; 0 or nothing for an answer by a person";
        let bad = || self.bad(Spot { line, column: Origin::KEY }, cell, "no such mark", hint);
        let origin = Origin::of_cell(cell).ok_or_else(bad)?;
        self.origin(origin, line)
    }

    /// Adds a row, whose rating has been checked.
    pub(crate) fn add(&mut self, id: &str, row: Row, spot: Spot<'_>) -> Result<(), Problem> {
        let key = (row.film.clone(), row.item.clone());
        let shown = row.rating.points().map_or_else(|| "missing".to_owned(), |points| points.to_string());
        let at = format!("line {}", spot.line);
        self.person(id);
        let name = self.names.of(id);
        let earlier = self.people.get(&name).and_then(|of| of.rows.get(&key)).map(|(_, at)| at.clone());
        if let Some(earlier) = earlier {
            let what = format!("this person has answered `{}` about the film `{}` already, {earlier}", key.1, key.0);
            return Err(self.bad(spot, &shown, what, "keep one of both answers: the first, where a person came twice"));
        }
        if let Some(of) = self.people.get_mut(&name) {
            of.rows.insert(key, (Row { participant: name.clone(), ..row }, at));
        }
        Ok(())
    }

    /// A film of the design.
    pub(crate) fn film(&self, id: &str, spot: Spot<'_>) -> Result<String, Problem> {
        let unknown = || {
            let names: Vec<&str> = self.design.films.iter().map(|film| film.id.as_str()).take(12).collect();
            self.bad(spot, id, "no film of the study has this name", format!("films are {}", names.join(", ")))
        };
        self.design.film(id).map(|film| film.id.clone()).ok_or_else(unknown)
    }

    /// An item of the design.
    pub(crate) fn item(&self, code: &str, spot: Spot<'_>) -> Result<Dimension<'d>, Problem> {
        let unknown = || {
            let near = crate::problem::nearest(code, self.design.codes());
            let near = near.map_or_else(String::new, |near| format!("did you mean `{near}`? "));
            let codes: Vec<&str> = self.design.codes().take(12).collect();
            let hint = format!("{near}items are {}", codes.join(", "));
            self.bad(spot, code, "no instrument of the study has this item", hint)
        };
        self.design.item(code).map(|(dimension, _)| dimension).ok_or_else(unknown)
    }

    /// An answer in points or in words; an empty one is missing.
    pub(crate) fn rating(&self, text: &str, code: &str, spot: Spot<'_>) -> Result<Rating, Problem> {
        let text = text.trim();
        if text.is_empty() {
            return Ok(Rating::Missing);
        }
        let of = self.item(code, spot)?.instrument;
        let points = text.parse::<f64>().ok().or_else(|| of.points_of(text));
        if let Some(points) = points.filter(|points| of.takes(*points)) {
            return Ok(Rating::Given(points));
        }
        let (low, high) = of.points;
        let hint = if points.is_some_and(|points| (points - (low - 1.0)).abs() < 1e-9) {
            format!(
                "answers of `{}` go from {low} to {high}; a file that counts from {} is shifted before it is read",
                of.id,
                low - 1.0
            )
        } else {
            let words: Vec<&str> = of.anchors.iter().map(|(_, words)| words.as_str()).collect();
            format!(
                "answers of `{}` go from {low} to {high}, or in words: {}; leave it empty where nothing was said",
                of.id,
                words.join(", ")
            )
        };
        Err(self.bad(spot, text, format!("no answer to `{code}`"), hint))
    }

    /// Everything that came in, in the order of participant, film and item.
    pub(crate) fn done(self) -> Result<Ratings, Problem> {
        if self.people.values().all(|of| of.rows.is_empty()) {
            return Err(Problem::new(&self.file, "it holds no answer", "export the responses, not the survey"));
        }
        let mut all =
            Ratings { origin: self.origin.map_or(Origin::People, |(origin, _)| origin), ..Ratings::default() };
        for of in self.people.into_values() {
            all.participants.push(of.person);
            all.rows.extend(of.rows.into_values().map(|(row, _)| row));
        }
        Ok(all)
    }
}

/// Counts an attention check of a person.
pub(crate) fn count_check(person: &mut Participant, right: bool) {
    let (all, failed) = person.checks.unwrap_or_default();
    person.checks = Some((all + 1, failed + u32::from(!right)));
}

impl Ratings {
    /// Joins tables of several files.
    ///
    /// # Errors
    /// A person answered an item about a film in two of them; some hold simulated answers and others answers by people.
    pub fn join(parts: Vec<(String, Self)>) -> Result<Self, Problem> {
        let mut seen: BTreeMap<(String, String, String), String> = BTreeMap::new();
        let (mut all, mut people) = (Self::default(), BTreeSet::new());
        let mut first_of: Option<(String, Origin)> = None;
        for (file, part) in parts {
            let (first, origin) = first_of.get_or_insert_with(|| (file.clone(), part.origin));
            if *origin != part.origin {
                let what = format!("it holds {}, and `{first}` {}", part.origin.name(), origin.name());
                return Err(Problem::new(&file, what, UNMIXED).column(Origin::KEY));
            }
            all.origin = part.origin;
            for row in &part.rows {
                let key = (row.participant.clone(), row.film.clone(), row.item.clone());
                if let Some(first) = seen.insert(key, file.clone()) {
                    let what = format!("`{first}` holds this answer of `{}` as well", row.participant);
                    return Err(Problem::new(&file, what, "name each file once").column(&row.item).value(&row.film));
                }
            }
            all.participants.extend(part.participants.into_iter().filter(|person| people.insert(person.id.clone())));
            all.rows.extend(part.rows);
        }
        all.rows.sort_by(|a, b| (&a.participant, &a.film, &a.item).cmp(&(&b.participant, &b.film, &b.item)));
        all.participants.sort_by(|a, b| a.id.cmp(&b.id));
        Ok(all)
    }

    /// Adds what Prolific knows of the people who answered; gives how many submissions answered nothing.
    pub fn add_submissions(&mut self, submissions: Vec<(String, Submission)>) -> usize {
        let mut left: BTreeMap<String, Submission> = submissions.into_iter().collect();
        for person in &mut self.participants {
            let Some(of) = left.remove(&person.id) else { continue };
            person.status = Some(of.status);
            person.age = of.age;
            person.sex = of.sex;
            person.duration_s = person.duration_s.or(of.taken_s);
        }
        left.len()
    }
}
