//! People who walk as they were recorded.

use std::collections::BTreeMap;

use csv::StringRecord;
use nalgebra::{Point2, Vector2};

use crate::model::{CrowdModel, Room, View};
use crate::person::Person;
use crate::vector::{norm, wrap};

/// Where somebody was at one moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Time, s.
    pub t_s: f64,
    /// Center, m.
    pub position: Point2<f64>,
    /// Heading, rad, if recorded.
    pub yaw: Option<f64>,
    /// Velocity, m/s, if recorded.
    pub velocity: Option<Vector2<f64>>,
}

/// The recorded way of one person. It is there from its first sample to its last, both included; others
/// feel it, and it feels nobody.
#[derive(Debug, Clone, PartialEq)]
pub struct Track {
    /// By time, no two at one; at least one.
    samples: Vec<Sample>,
}

impl Track {
    /// Time of the first sample, s.
    #[must_use]
    pub fn first_s(&self) -> f64 {
        self.samples.first().map_or(f64::NAN, |sample| sample.t_s)
    }

    /// Time of the last sample, s.
    #[must_use]
    pub fn last_s(&self) -> f64 {
        self.samples.last().map_or(f64::NAN, |sample| sample.t_s)
    }

    /// The recorded samples, by time.
    #[must_use]
    pub fn samples(&self) -> &[Sample] {
        &self.samples
    }

    /// `person` as it was at a time; `None` before the first sample and after the last.
    ///
    /// Between two samples position and velocity change linearly, the heading the shorter way round.
    /// Without recorded velocities the velocity is that of the way between the samples; without recorded
    /// headings the person looks where it goes, and as before while it stands.
    #[must_use]
    pub fn at(&self, time_s: f64, person: &Person) -> Option<Person> {
        let next = self.samples.partition_point(|sample| sample.t_s <= time_s);
        let before = self.samples.get(next.checked_sub(1)?)?;
        let Some(after) = self.samples.get(next) else {
            // Exactly at the last sample: as on the way to it.
            let earlier = next.checked_sub(2).and_then(|place| self.samples.get(place)).unwrap_or(before);
            return (time_s <= before.t_s).then(|| between(earlier, before, 1.0, person));
        };
        Some(between(before, after, (time_s - before.t_s) / (after.t_s - before.t_s), person))
    }
}

/// `person` at a share of the way between two samples (which may be one and the same).
fn between(before: &Sample, after: &Sample, share: f64, person: &Person) -> Person {
    let (way, took_s) = (after.position - before.position, after.t_s - before.t_s);
    let velocity = match (before.velocity, after.velocity) {
        (Some(from), Some(to)) => from + (to - from) * share,
        _ if took_s > 0.0 => way / took_s,
        _ => Vector2::zeros(),
    };
    let yaw = match (before.yaw, after.yaw) {
        (Some(from), Some(to)) => wrap(from + wrap(to - from) * share),
        _ if norm(&velocity) > 0.0 => libm::atan2(velocity.y, velocity.x),
        _ => person.yaw,
    };
    // The last sample itself, not the way there and back by rounding.
    let position = if share < 1.0 { before.position + way * share } else { after.position };
    Person { position, velocity, yaw, ..person.clone() }
}

impl CrowdModel for Track {
    fn name(&self) -> &'static str {
        "recorded"
    }

    fn next(&self, view: &View<'_>, _room: &mut Room) -> Option<Person> {
        self.at(view.now_s + view.dt_s, view.me)
    }
}

/// Recorded ways by the id of the person.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Tracks(BTreeMap<u32, Track>);

/// One thing in a file of tracks that cannot be meant.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("line {line}, `{column}` is `{found}`; allowed: {allowed}")]
pub struct TrackProblem {
    /// Line of the file, from 1.
    pub line: usize,
    /// Column by name, or `line` for the whole of it.
    pub column: String,
    /// What stands there.
    pub found: String,
    /// What would be taken.
    pub allowed: String,
}

/// Why a file of tracks cannot be replayed: everything that is wrong with it, by line.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{} wrong in the tracks:{}", counted(.problems.len()), listed(.problems))]
pub struct TracksError {
    /// At least one.
    pub problems: Vec<TrackProblem>,
}

/// At most this many are written out in a message.
const MOST_LISTED: usize = 50;

fn counted(count: usize) -> String {
    if count == 1 { "1 value is".to_owned() } else { format!("{count} values are") }
}

fn listed(problems: &[TrackProblem]) -> String {
    let mut text: String = problems.iter().take(MOST_LISTED).map(|problem| format!("\n  {problem}")).collect();
    if problems.len() > MOST_LISTED {
        text.push_str(&format!("\n  and {} more", problems.len() - MOST_LISTED));
    }
    text
}

/// The columns that a file may have; the first four it must have.
const COLUMNS: [&str; 7] = ["t", "id", "x", "y", "yaw", "vx", "vy"];
const NEEDED: usize = 4;

impl Tracks {
    /// Reads a CSV table (RFC 4180) `t,id,x,y[,yaw][,vx,vy]` (s, m, rad, m/s; any order of columns, named in
    /// the first line). Rows of one id in the order of time; those of several may be mixed. Empty lines are
    /// passed over.
    ///
    /// # Errors
    /// [`TracksError`] with everything that is wrong: columns, cells, times that do not grow, no row.
    pub fn read(text: &str) -> Result<Self, TracksError> {
        let mut problems = Vec::new();
        let mut lines = lines(text, &mut problems).into_iter();
        let header = lines.next().map_or_else(StringRecord::new, |(_, cells)| cells);
        let header: Vec<&str> = header.iter().collect();
        check_header(&header, &mut problems);
        let mut tracks: BTreeMap<u32, Track> = BTreeMap::new();
        if problems.is_empty() {
            for (line, cells) in lines {
                if let Some((id, sample)) = row(&header, line, &cells, &mut problems) {
                    let samples = &mut tracks.entry(id).or_insert(Track { samples: Vec::new() }).samples;
                    match samples.last() {
                        Some(last) if sample.t_s <= last.t_s => {
                            let allowed = format!("later than {} s, the row before of person {id}", last.t_s);
                            problems.push(problem(line, "t", &sample.t_s.to_string(), &allowed));
                        }
                        _ => samples.push(sample),
                    }
                }
            }
            if tracks.is_empty() && problems.is_empty() {
                problems.push(problem(1, "line", "the last one", "at least one row after the names of the columns"));
            }
        }
        if problems.is_empty() { Ok(Self(tracks)) } else { Err(TracksError { problems }) }
    }

    /// Every person with its track, by id.
    pub fn iter(&self) -> impl Iterator<Item = (u32, &Track)> {
        self.0.iter().map(|(id, track)| (*id, track))
    }

    /// The track of a person.
    #[must_use]
    pub fn get(&self, id: u32) -> Option<&Track> {
        self.0.get(&id)
    }
}

fn problem(line: usize, column: &str, found: &str, allowed: &str) -> TrackProblem {
    const LONGEST: usize = 40;
    let found = found.chars().take(LONGEST).collect();
    TrackProblem { line, column: column.to_owned(), found, allowed: allowed.to_owned() }
}

/// The lines that hold anything, each with its number from 1: cells without the blanks around them; in quotes
/// a comma is text.
fn lines(text: &str, problems: &mut Vec<TrackProblem>) -> Vec<(usize, StringRecord)> {
    let mut reader =
        csv::ReaderBuilder::new().has_headers(false).flexible(true).trim(csv::Trim::All).from_reader(text.as_bytes());
    let mut lines = Vec::new();
    for record in reader.records() {
        match record {
            Ok(cells) if cells.len() == 1 && cells.get(0) == Some("") => {}
            Ok(cells) => lines.push((line_of(text, cells.position()), cells)),
            Err(why) => {
                problems.push(problem(line_of(text, why.position()), "line", &why.to_string(), "text in UTF-8"));
            }
        }
    }
    lines
}

/// The line on which a record stands; its position is that of the empty lines before it.
fn line_of(text: &str, position: Option<&csv::Position>) -> usize {
    let Some(position) = position else { return 1 };
    let number = |of: u64| usize::try_from(of).unwrap_or(usize::MAX);
    let rest = text.as_bytes().get(number(position.byte())..).unwrap_or_default();
    let empty = rest.iter().take_while(|byte| matches!(byte, b'\r' | b'\n')).filter(|byte| **byte == b'\n').count();
    number(position.line()).saturating_add(empty)
}

fn check_header(header: &[&str], problems: &mut Vec<TrackProblem>) {
    for (place, name) in header.iter().enumerate() {
        if !COLUMNS.contains(name) {
            problems.push(problem(1, "line", name, &format!("the columns {}", COLUMNS.join(", "))));
        } else if header.iter().take(place).any(|before| before == name) {
            problems.push(problem(1, "line", name, "each column once"));
        }
    }
    for name in COLUMNS.iter().take(NEEDED).filter(|name| !header.contains(name)) {
        problems.push(problem(1, "line", "missing", &format!("a column `{name}`")));
    }
    if header.contains(&"vx") != header.contains(&"vy") {
        problems.push(problem(1, "line", "one of vx and vy", "both or neither"));
    }
}

/// One row; `None` when something is wrong with it.
fn row(header: &[&str], line: usize, cells: &StringRecord, problems: &mut Vec<TrackProblem>) -> Option<(u32, Sample)> {
    if cells.len() != header.len() {
        let found = format!("{} cells", cells.len());
        problems.push(problem(line, "line", &found, &format!("{} cells, as in the first line", header.len())));
        return None;
    }
    let before = problems.len();
    let mut number = |name: &str| {
        let cell = header.iter().position(|column| *column == name).and_then(|place| cells.get(place))?;
        let number = cell.parse::<f64>().ok().filter(|number| number.is_finite());
        if number.is_none() {
            problems.push(problem(line, name, cell, "a finite number"));
        }
        number
    };
    let (t_s, x, y, yaw) = (number("t"), number("x"), number("y"), number("yaw").map(wrap));
    let velocity = number("vx").zip(number("vy")).map(|(vx, vy)| Vector2::new(vx, vy));
    let cell = header.iter().position(|column| *column == "id").and_then(|place| cells.get(place)).unwrap_or_default();
    let id = cell.parse::<u32>();
    if id.is_err() {
        problems.push(problem(line, "id", cell, &format!("a whole number from 0 to {}", u32::MAX)));
    }
    if problems.len() > before {
        return None;
    }
    let position = Point2::new(x?, y?);
    Some((id.ok()?, Sample { t_s: t_s?, position, yaw, velocity }))
}
