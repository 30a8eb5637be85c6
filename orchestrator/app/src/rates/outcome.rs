//! What became of one run: realised or not, why not, and how straight the robot went.

use serde_json::{Value, json};
use socrates_maps::Ground;
use socrates_model::report::Standing;
use socrates_model::{AgentId, ClauseRole, Fault, Location, Point, Recording, Report, Verdict};
use socrates_offline::Card;

use crate::in_process::Played;

/// Cards whose way is a person's: they say nothing about how straight the robot goes.
const LED: &[&str] = &["robot_following", "leading", "accompanying"];
/// Ticks between two points of the robot's track: 0.1 s, as the metrics have it.
const EVERY: usize = 10;
/// The disc for which ways are looked for is so much narrower than the robot, m, as the metrics have it: a robot that fits a
/// doorway to the centimeter still has a way.
const SLACK_M: f64 = 0.05;

/// What became of a run.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Outcome {
    /// Whether the scenario happened, in time or late.
    pub(crate) realised: bool,
    /// Whether it happened late.
    pub(crate) late: bool,
    /// Whether it happened and the robot got to its goal without touching anybody.
    pub(crate) success: bool,
    /// What is wrong where it did not happen, in a few words.
    pub(crate) failing: Option<String>,
    /// What the judge says where it did not happen; what is wrong first where it was not written.
    pub(crate) verdict: Option<String>,
    /// Shortest free way over driven way, 0 to 1; none where the way is a person's, or where there was no run.
    pub(crate) efficiency: Option<f64>,
}

/// What became of a run of a card.
pub(super) fn of(card: &Card, location: &Location, played: &Result<Played, Vec<Fault>>) -> Outcome {
    match played {
        Ok(played) => {
            let report = &played.report;
            let realised = is_realised(report);
            let led = LED.contains(&card.id.as_str());
            let goal = played.paths.robot.last().and_then(|node| location.graph.node(node)).map(|node| node.at);
            Outcome {
                realised,
                late: report.verdict == Verdict::RealisedLate,
                success: realised && report.success,
                failing: failing(played),
                verdict: (!realised).then(|| format!("{} · {}", report.verdict, report.verdict_text)),
                efficiency: goal
                    .filter(|_| !led)
                    .and_then(|goal| efficiency(&played.recording, &Ground::of(&location.grid), &[], goal)),
            }
        }
        Err(faults) => {
            let mut codes: Vec<&str> = faults.iter().filter(|f| !f.is_soft()).map(|fault| fault.code.code()).collect();
            codes.dedup();
            let hard = faults.iter().find(|fault| !fault.is_soft());
            Outcome {
                realised: false,
                late: false,
                success: false,
                failing: Some(format!("not written: {}", codes.join(", "))),
                verdict: hard.map(|fault| format!("not written · {fault}")),
                efficiency: None,
            }
        }
    }
}

/// Whether the scenario happened, in time or late.
const fn is_realised(report: &Report) -> bool {
    matches!(report.verdict, Verdict::Realised | Verdict::RealisedLate)
}

/// What is wrong with a scenario that was not realised; nothing where it was.
fn failing(played: &Played) -> Option<String> {
    let report = &played.report;
    if is_realised(report) {
        return None;
    }
    let kind = |id: &str| {
        let clause = played.proposal.expected_events.iter().find(|clause| clause.id == id);
        clause.map_or_else(|| id.to_owned(), |clause| tag(&json!(clause.predicate)))
    };
    let mut kinds: Vec<String> = report
        .clauses
        .iter()
        .filter(|found| found.role == ClauseRole::Setup && found.must)
        .filter(|found| !matches!(found.standing, Standing::Holds | Standing::Late | Standing::NotApplicable))
        .map(|found| kind(&found.id))
        .collect();
    kinds.dedup();
    let kinds = if kinds.is_empty() { report.verdict_text.clone() } else { kinds.join(", ") };
    Some(format!("{}: {kinds}", report.verdict))
}

/// The tag of a tagged value.
fn tag(value: &Value) -> String {
    match value {
        Value::Object(members) => members.keys().next().cloned().unwrap_or_default(),
        Value::String(text) => text.clone(),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::Array(_) => value.to_string(),
    }
}

/// The shortest free way of the robot's disc from its start through `via` to its goal, over the way that it drove and would have
/// had to drive yet from where it ended; at most 1. `None` where the recording has no robot or the map no way.
fn efficiency(recording: &Recording, ground: &Ground, via: &[Point], goal: Point) -> Option<f64> {
    let radius_m = recording.header.agents.iter().find(|info| info.agent == AgentId::Robot)?.radius_m;
    let disc_m = (radius_m - SLACK_M).max(SLACK_M);
    let track: Vec<Point> = recording.track(AgentId::Robot).map(|state| state.point()).collect();
    let (start, end) = (*track.first()?, *track.last()?);
    let mut shortest_m = 0.0;
    let mut from = start;
    for stop in via.iter().chain([&goal]) {
        shortest_m += ground.geodesic(stop, disc_m).distance(&from)?;
        from = *stop;
    }
    let coarse: Vec<&Point> = track.iter().step_by(EVERY).chain([&end]).collect();
    let driven_m: f64 = coarse.windows(2).map(step_m).sum();
    // A robot that stopped short of its goal has not gone a shorter way.
    let left_m = ground.geodesic(&goal, disc_m).distance(&end)?;
    let whole_m = driven_m + left_m;
    (shortest_m > 0.0 && whole_m > 0.0).then(|| (shortest_m / whole_m).min(1.0))
}

/// Length of a step, m.
fn step_m(pair: &[&Point]) -> f64 {
    match pair {
        [a, b] => (**b - **a).norm(),
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_led_card_is_a_card_of_the_catalog() {
        assert!(LED.iter().all(|id| socrates_offline::card::card(id).is_some()));
    }
}
