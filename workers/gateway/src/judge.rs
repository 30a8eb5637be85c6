//! How a run stands while it goes on: the judgment of what has been seen so far, by the same function that judges it at the end.

use serde_json::{Value, json};
use socrates_model::clause::ClauseRole;
use socrates_model::report::Standing as Seen;
use socrates_model::{ClauseResult, Location, Paths, Proposal, Reading, Recording, Report, Request, SimTime};
use socrates_scoring::{Evidence, score};

use crate::run::Standing;

/// Metrics that the page shows, with their names, the first that matter most.
const SHOWN: [(&str, &str); 10] = [
    ("success", "success"),
    ("time_to_goal", "time to the goal"),
    ("path_length", "length of the robot's way"),
    ("path_efficiency", "shortest way as a share of it"),
    ("human_distance_min", "smallest surface distance to a human"),
    ("ttc_min", "smallest time to collision"),
    ("human_collisions", "collisions with humans"),
    ("wall_collisions", "collisions with walls"),
    ("near_misses", "near misses"),
    ("stalled_time", "time the robot stalled"),
];

/// What a scenario was made of, as far as a judgment needs it.
#[derive(Debug, Clone)]
pub struct Papers {
    /// The place.
    pub location: Location,
    /// What was asked.
    pub request: Option<Request>,
    /// What was read.
    pub reading: Option<Reading>,
    /// The scenario with its clauses.
    pub proposal: Proposal,
    /// Ways and meetings.
    pub paths: Paths,
}

impl Papers {
    /// Judges what was recorded so far; `last`: there is no more.
    #[must_use]
    pub fn judge(&self, recording: &Recording, last: bool) -> Standing {
        let report = score(&Evidence {
            recording,
            location: Some(&self.location),
            request: self.request.as_ref(),
            reading: self.reading.as_ref(),
            proposal: Some(&self.proposal),
            paths: Some(&self.paths),
            reference: None,
            twin: None,
            goal: None,
            groups: &[],
        });
        standing(&report, SimTime::of_last(recording.ticks() as u64).secs(), last)
    }
}

/// The standing that a report tells.
#[must_use]
pub fn standing(report: &Report, time_s: f64, last: bool) -> Standing {
    let shown = SHOWN.iter().filter_map(|(id, name)| {
        let metric = report.metrics.iter().find(|metric| metric.id == *id)?;
        Some(json!({ "id": id, "name": name, "value": metric.value, "unit": metric.unit.as_str() }))
    });
    Standing {
        time_s,
        last,
        verdict: last.then(|| report.verdict.name().to_owned()),
        clauses: report.clauses.iter().map(|clause| told(clause, last)).collect(),
        metrics: shown.collect(),
    }
}

/// A clause as the page is told. Before the end, what was not seen can still come.
fn told(clause: &ClauseResult, last: bool) -> Value {
    let part = match clause.role {
        ClauseRole::Setup => "setup",
        ClauseRole::Outcome => "outcome",
    };
    let standing = match clause.standing {
        Seen::Holds => "holds",
        Seen::Late => "late",
        Seen::NotTriggered if last => "not_triggered",
        Seen::Fails if last => "fails",
        Seen::NotTriggered | Seen::Fails => "open",
        Seen::NotApplicable => "not_applicable",
    };
    json!({
        "id": clause.id, "part": part, "text": clause.text, "standing": standing,
        "at_s": clause.times_s.first(), "evidence": clause.evidence,
    })
}
