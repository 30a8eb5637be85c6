//! What the script of the report page plays and lists, as JSON.

use serde_json::{Value, json};
use socrates_model::act::{ACTS, Takes};
use socrates_model::recording::DRIVEN_LEAF;
use socrates_model::{Action, ClauseRole, Event, EventKind, Location, Point, Reading, Recording, Report};

use crate::facts::fact_words;
use crate::play;
use crate::series::curves;

/// All runs, where on the map they happen, and what was asked for.
pub(crate) fn page_data(location: &Location, way: &[Point], reading: &Reading, runs: &[(Recording, Report)]) -> Value {
    let recordings: Vec<&Recording> = runs.iter().map(|(recording, _)| recording).collect();
    let hz = play::rate(&recordings);
    let place = play::place(location, 0);
    let focus = play::focus(location, way, &recordings);
    let facts: Vec<Value> = reading
        .facts
        .iter()
        .map(|fact| json!({ "id": fact.id, "quote": fact.quote, "says": fact_words(&fact.kind) }))
        .collect();
    let runs: Vec<Value> =
        runs.iter().map(|(recording, report)| run_data(location, way, recording, report, hz)).collect();
    let unplayed = reading.statements.iter().filter(|statement| statement.is_unplayed());
    let missing: Vec<Value> = unplayed
        .map(|statement| json!({ "quote": statement.quote, "fate": statement.fate(), "why": statement.told() }))
        .collect();
    json!({ "runs": runs, "facts": facts, "missing": missing, "whole": place.get("whole"), "focus": focus, "places": [place] })
}

fn run_data(location: &Location, way: &[Point], recording: &Recording, report: &Report, hz: u32) -> Value {
    let mut run = play::run(location, way, recording, hz);
    let Some(members) = run.as_object_mut() else { return run };
    let more = json!({
        "name": format!("{} · seed {}", report.planner, report.seed), "verdict": report.verdict.name(),
        "verdict_text": report.verdict_text, "robot_text": report.robot_text,
        "events": marks(recording), "clauses": clauses(report), "metrics": report.metrics, "story": report.story,
        "series": series(recording, hz), "simulated": report.simulated_s, "planner": report.planner,
        "seed": report.seed, "gap": gap_words(report), "gaps": gap_list(report), "success": report.success,
    });
    if let Value::Object(more) = more {
        members.extend(more);
    }
    run
}

/// The largest gap of all encounters, in the words of the verdict.
fn gap_words(report: &Report) -> String {
    let all = report.encounter_gaps_s.values().map(|gap| gap.abs()).max_by(f64::total_cmp);
    let more = if report.encounter_gaps_s.len() > 1 { " at most" } else { "" };
    all.map_or_else(|| "none".to_owned(), |gap| format!("{gap:.1} s{more}"))
}

/// The gap of each encounter; behind the human's name who came later is told by the sign.
fn gap_list(report: &Report) -> String {
    report.encounter_gaps_s.iter().map(|(who, gap)| format!("{who} {gap:.1} s")).collect::<Vec<_>>().join(", ")
}

/// Clauses with their evidence.
fn clauses(report: &Report) -> Vec<Value> {
    report
        .clauses
        .iter()
        .map(|clause| {
            json!({
                "id": clause.id, "text": clause.text, "setup": clause.role == ClauseRole::Setup, "must": clause.must,
                "standing": clause.standing, "times": clause.times_s, "evidence": clause.evidence, "source": clause.source,
                "shift": clause.shift_s,
            })
        })
        .collect()
}

/// The curves of the plots, rounded to what a plot can show.
fn series(recording: &Recording, hz: u32) -> Value {
    let curves = curves(recording, play::ticks_per_sample(recording, hz));
    let short = |values: &[Option<f64>]| -> Vec<Option<f64>> {
        values.iter().map(|value| value.map(|value| (value * 1000.0).round() / 1000.0)).collect()
    };
    json!({
        "distance": short(&curves.distance_m), "distance_to": curves.distance_to, "speed": short(&curves.speed_mps),
        "ttc": short(&curves.ttc_s), "ttc_to": curves.ttc_to,
    })
}

/// The marks of a time line.
pub(crate) fn marks(recording: &Recording) -> Vec<Value> {
    recording.events.iter().filter_map(|event| mark(recording, event)).collect()
}

/// A mark on the time line: time, lane (agent number), kind and words.
fn mark(recording: &Recording, event: &Event) -> Option<Value> {
    let secs = event.time.secs();
    let mark = |lane: u32, what: &str, words: String| Some(json!([secs, lane, what, words]));
    match &event.kind {
        EventKind::Gesture { agent, gesture: Some(gesture), to } => {
            let to = to.map_or_else(String::new, |to| format!(" to {to}"));
            mark(agent.number(), "gesture", format!("{agent} says {gesture}{to}"))
        }
        EventKind::Leaf { human, leaf } => mark(human.number(), "leaf", format!("{human} {}", spoken(leaf))),
        EventKind::Sees { human, distance_m } => {
            mark(human.number(), "sees", format!("{human} sees the robot at {distance_m:.1} m, center to center"))
        }
        EventKind::Encounter { human, .. } => mark(human.number(), "encounter", recording.encounter_words(event)?),
        EventKind::Contact { a, b, .. } => mark(b.number(), "contact", format!("{a} touches {b}")),
        EventKind::WallContact { agent, .. } => mark(agent.number(), "contact", format!("{agent} touches a wall")),
        EventKind::Door { door, open } => mark(0, "door", format!("{door} {}", if *open { "opens" } else { "closes" })),
        EventKind::RobotArrived => mark(0, "goal", "the robot is at its goal".to_owned()),
        EventKind::Stuck { agent } => mark(agent.number(), "stuck", format!("{agent} is stuck")),
        EventKind::Gesture { .. } | EventKind::StepEnded { .. } | EventKind::Node { .. } | EventKind::End { .. } => {
            None
        }
    }
}

/// Whether whoever runs a leaf of this tag does something about the robot.
pub(crate) fn reacts(tag: &str) -> bool {
    let quiet = [Action::Navigate, Action::StandStill].map(|act: Action| act.row().leaf);
    ACTS.iter().any(|act| act.leaf == tag && !quiet.contains(&tag))
}

/// What somebody does whose tree runs a leaf of this tag: `blocks the robot`; other tags as they are, `runs stand up` for `StandUp`.
fn spoken(tag: &str) -> String {
    if tag == DRIVEN_LEAF {
        return "is moved by a driver outside".to_owned();
    }
    match ACTS.iter().find(|act| act.leaf == tag).map(|act| (act.takes, act.does)) {
        Some((Takes::Nothing, does)) => does.to_owned(),
        // The tag does not say whom.
        Some((Takes::Person, does)) => does.replace("{}", "another human"),
        Some((Takes::Place | Takes::Pace | Takes::Meters, _)) | None => format!("runs {}", parted(tag)),
    }
}

/// `stand up` for `StandUp`.
fn parted(tag: &str) -> String {
    let mut out = String::new();
    for c in tag.chars() {
        if c.is_uppercase() && !out.is_empty() {
            out.push(' ');
        }
        out.extend(c.to_lowercase());
    }
    out
}

#[cfg(test)]
mod tests {
    use socrates_model::HumanId;

    use super::*;

    #[test]
    fn the_gap_is_that_of_the_verdict_text() {
        let mut report = crate::fixture::report(&crate::fixture::walk(1), "a hall");
        for (gap, words) in [(2.85, "2.9 s"), (-2.849, "2.8 s"), (0.25, "0.2 s")] {
            report.encounter_gaps_s = [("human_1".to_owned(), gap)].into();
            assert_eq!(gap_words(&report), words);
            assert_eq!(words, format!("{:.1} s", f64::abs(gap)));
        }
    }

    #[test]
    fn an_encounter_is_told_as_in_the_story() {
        let mut run = crate::fixture::walk(1);
        let node = socrates_model::NodeId::new("m").unwrap();
        let kind = EventKind::Encounter { human: HumanId::new(1), node, gap_s: 0.4, nth: 1 };
        run.events = vec![Event { time: socrates_model::SimTime::from_nanos(3_000_000_000), kind }];
        assert_eq!(marks(&run)[0][3], run.encounter_words(&run.events[0]).unwrap());
        assert_eq!(marks(&run)[0][3], "human_1 and the robot meet at m, gap 0.4 s");
    }

    #[test]
    fn a_leaf_is_told_in_words() {
        assert_eq!(spoken("StandStill"), "stands still");
        assert_eq!(spoken("BlockRobot"), "blocks the robot");
        assert_eq!(spoken("wait"), "runs wait");
        assert_eq!(spoken("RegularNav"), "walks on");
        assert_eq!(spoken(DRIVEN_LEAF), "is moved by a driver outside");
    }
}
