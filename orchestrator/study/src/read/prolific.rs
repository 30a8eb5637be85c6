//! Prolific's export of submissions.

use std::collections::BTreeMap;

use super::Pseudonyms;
use super::sheet::Sheet;
use crate::problem::Problem;

/// Standings that Prolific knows.
const STATUS: [&str; 7] =
    ["APPROVED", "REJECTED", "RETURNED", "TIMED-OUT", "ACTIVE", "AWAITING REVIEW", "SCREENED OUT"];

/// What is kept of a submission: no name of a country, language or job, ages in bands.
#[derive(Debug, Clone, PartialEq)]
pub struct Submission {
    /// Standing, in capitals.
    pub status: String,
    /// Time taken, s.
    pub taken_s: Option<f64>,
    /// Age in a band of ten years.
    pub age: Option<String>,
    /// Sex as it was told.
    pub sex: Option<String>,
}

/// Reads Prolific's CSV: a name and what is kept of each submission.
///
/// # Errors
/// A missing column, an unknown standing, two submissions of one person.
pub fn prolific(text: &str, file: &str, names: Pseudonyms) -> Result<Vec<(String, Submission)>, Problem> {
    let sheet = Sheet::read(text, file)?;
    sheet.need(&["Participant id", "Status"])?;
    let mut found: Vec<(String, Submission)> = Vec::new();
    let mut places: BTreeMap<String, usize> = BTreeMap::new();
    for (number, cells) in &sheet.lines {
        let bad = |column: &str, value: &str, what: &str, hint: &str| {
            Problem::new(file, what, hint).line(*number).column(column).value(value)
        };
        let id = sheet.cell(cells, "Participant id");
        let status = sheet.cell(cells, "Status").to_uppercase();
        if !STATUS.contains(&status.as_str()) {
            return Err(bad(
                "Status",
                &status,
                "Prolific has no such standing",
                &format!("it has {}", STATUS.join(", ")),
            ));
        }
        let name = names.of(id);
        let submission = Submission {
            status,
            taken_s: sheet.number((*number, cells), "Time taken")?,
            age: sheet
                .cell(cells, "Age")
                .parse::<u32>()
                .ok()
                .map(|age| format!("{}-{}", age / 10 * 10, age / 10 * 10 + 9)),
            sex: told(sheet.cell(cells, "Sex")),
        };
        let place = *places.entry(name.clone()).or_insert(found.len());
        if let Some((_, first)) = found.get_mut(place) {
            // A person may return a submission and come again: the one that counts is kept.
            let counts = |of: &Submission| matches!(of.status.as_str(), "APPROVED" | "AWAITING REVIEW");
            if counts(first) && counts(&submission) {
                return Err(bad(
                    "Participant id",
                    id,
                    "two submissions of this person count",
                    "reject one at Prolific, or remove its line",
                ));
            }
            if counts(&submission) {
                *first = submission;
            }
            continue;
        }
        found.push((name, submission));
    }
    Ok(found)
}

/// What was told; none where consent was taken back.
fn told(text: &str) -> Option<String> {
    let gone = text.is_empty() || matches!(text, "CONSENT_REVOKED" | "DATA_EXPIRED");
    (!gone).then(|| text.to_lowercase())
}
