//! People who are left out, by the rules that the study declares.

use std::collections::{BTreeMap, BTreeSet};

use crate::design::Design;
use crate::instrument::{Instrument, SCALE_ITEMS};
use crate::rating::{Ratings, Row};

/// A film counts as left when this much of it was not played, s: players report its end late.
const END_S: f64 = 0.5;

/// The rules, with their words.
pub const RULES: [(&str, &str); 5] = [
    ("failed-checks", "failed attention checks"),
    ("left-early", "left a film before its end"),
    ("too-fast", "took less time than the films last"),
    ("straight-lines", "gave one and the same answer to all items of several blocks"),
    ("not-approved", "submission rejected, returned or timed out"),
];

/// What each rule looks at in words, with the numbers of the study.
#[must_use]
pub fn declared(design: &Design) -> Vec<(&'static str, String)> {
    let of = &design.exclusions;
    let mut found = Vec::new();
    if of.failed_checks > 0 {
        found.push(("failed-checks", format!("failed {} or more attention checks", of.failed_checks)));
    }
    if of.left_early {
        found.push(("left-early", "left a film before its end".to_owned()));
    }
    if of.too_fast {
        found.push(("too-fast", "took less time in total than the rated films last".to_owned()));
    }
    if of.straight_lines > 0 {
        let text = format!(
            "gave one and the same answer to all items of an instrument (three or more) about {} or more films",
            of.straight_lines
        );
        found.push(("straight-lines", text));
    }
    if of.not_approved {
        found.push(("not-approved", "had a submission that was rejected, returned or timed out".to_owned()));
    }
    found
}

/// The rules that each person broke, by name; people who stay are missing here.
#[must_use]
pub fn excluded(ratings: &Ratings, design: &Design) -> BTreeMap<String, Vec<&'static str>> {
    let rules = &design.exclusions;
    let mut found: BTreeMap<String, Vec<&'static str>> = BTreeMap::new();
    let mut said: BTreeMap<&str, Vec<&Row>> = BTreeMap::new();
    ratings.rows.iter().for_each(|row| said.entry(&row.participant).or_default().push(row));
    for person in &ratings.participants {
        let mut broken = Vec::new();
        let rows = said.get(person.id.as_str()).map_or(&[][..], Vec::as_slice);
        let failed = person.checks.map_or(0, |(_, failed)| failed);
        if rules.failed_checks > 0 && failed >= rules.failed_checks {
            broken.push("failed-checks");
        }
        let length = |film: &str| design.film(film).and_then(|film| film.length_s);
        let left = |watched: Option<f64>, film: &str| {
            watched.zip(length(film)).is_some_and(|(watched, length)| watched < length - END_S)
        };
        if rules.left_early && rows.iter().any(|row| left(row.watched_s, &row.film)) {
            broken.push("left-early");
        }
        let films: BTreeSet<&str> = rows.iter().map(|row| row.film.as_str()).collect();
        let lengths: f64 = films.iter().filter_map(|film| length(film)).sum();
        if rules.too_fast && person.duration_s.is_some_and(|taken| taken < lengths) {
            broken.push("too-fast");
        }
        if rules.straight_lines > 0 && straight(rows, design) >= rules.straight_lines as usize {
            broken.push("straight-lines");
        }
        let bad = |status: &String| matches!(status.as_str(), "REJECTED" | "RETURNED" | "TIMED-OUT" | "SCREENED OUT");
        if rules.not_approved && person.status.as_ref().is_some_and(bad) {
            broken.push("not-approved");
        }
        if !broken.is_empty() {
            found.insert(person.id.clone(), broken);
        }
    }
    found
}

/// Blocks (an instrument about a film) of at least three of a person's answers that are all the same, as they were clicked. Where the
/// study has an instrument with reversed items, only blocks of such instruments count: whoever finds a robot excellent may honestly give
/// the highest answer to all items that are keyed alike.
fn straight(rows: &[&Row], design: &Design) -> usize {
    let mixed = |of: &Instrument| of.scales.iter().flat_map(|scale| &scale.items).any(|item| item.reversed);
    let any_mixed = design.instruments.iter().any(mixed);
    let mut blocks: BTreeMap<(&str, &str), Vec<f64>> = BTreeMap::new();
    for row in rows {
        let (Some((dimension, _)), Some(points)) = (design.item(&row.item), row.rating.points()) else { continue };
        if any_mixed && !mixed(dimension.instrument) {
            continue;
        }
        blocks.entry((&row.film, &dimension.instrument.id)).or_default().push(points);
    }
    let same = |block: &&Vec<f64>| {
        block.len() >= SCALE_ITEMS && block.windows(2).all(|pair| matches!(pair, [a, b] if a.total_cmp(b).is_eq()))
    };
    blocks.values().filter(same).count()
}
