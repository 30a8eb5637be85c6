//! What the page's script plays and lists, as JSON.

use serde_json::{Value, json};
use socrates_model::{ClauseRole, EventKind, Location, Point, Recording, Report};

use crate::map_layer::Frame;
use crate::palette;

/// Samples per second of the animation.
const SAMPLE_HZ: usize = 10;

/// All runs, and where on the map they happen.
pub(crate) fn page_data(location: &Location, frame: &Frame, way: &[Point], runs: &[(Recording, Report)]) -> Value {
    let seen: Vec<Point> = runs
        .iter()
        .flat_map(|(recording, _)| recording.header.agents.iter().map(move |info| (recording, info.agent)))
        .flat_map(|(recording, agent)| recording.track(agent).map(|state| state.point()))
        .chain(way.iter().copied())
        .collect();
    let focus = Frame::focused(location, &seen, 1120.0, 640.0, (0.0, 0.0)).cells;
    #[expect(clippy::cast_precision_loss, reason = "a map has fewer than 2^53 cells a side")]
    let place = |cell: usize, first: usize| (cell as f64 - first as f64) * frame.scale;
    let (w, h) = frame.size();
    let focus = [place(focus.0, frame.cells.0), place(focus.1, frame.cells.1), place(focus.2, 0), place(focus.3, 0)];
    let runs: Vec<Value> =
        runs.iter().map(|(recording, report)| run_data(location, frame, recording, report)).collect();
    json!({ "runs": runs, "whole": [0.0, 0.0, w, h], "focus": focus, "px_per_m": frame.len(location, 1.0) })
}

fn run_data(location: &Location, frame: &Frame, recording: &Recording, report: &Report) -> Value {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small positive number of ticks")]
    let every = ((1.0 / recording.header.step_s.max(1e-4)).round() as usize / SAMPLE_HZ).max(1);
    let round = |x: f64| (x * 10.0).round() / 10.0;
    let agents: Vec<Value> = recording
        .header
        .agents
        .iter()
        .map(|info| {
            let track: Vec<Value> = recording
                .track(info.agent)
                .step_by(every)
                .map(|state| {
                    let (x, y) = frame.px(location, &state.point());
                    json!([round(x), round(y), (state.yaw * 100.0).round() / 100.0, state.gesture().code()])
                })
                .collect();
            json!({
                "name": info.agent.to_string(), "role": info.role, "color": palette::agent(info.agent.number()),
                "words": palette::agent_words(info.agent.number()), "number": info.agent.number(),
                "radius": frame.len(location, info.radius_m).max(4.0), "track": track,
            })
        })
        .collect();
    let doors: Vec<Value> = location
        .doors
        .iter()
        .map(|door| {
            let times: Vec<Value> = recording
                .events
                .iter()
                .filter_map(|event| {
                    let EventKind::Door { door: id, open } = &event.kind else { return None };
                    (*id == door.id).then(|| json!([event.time.secs(), open]))
                })
                .collect();
            let (from, to) = (frame.px(location, &door.from), frame.px(location, &door.to));
            json!({ "id": door.id, "line": [from.0, from.1, to.0, to.1], "times": times })
        })
        .collect();
    let events: Vec<Value> =
        recording.events.iter().filter_map(|event| timeline_mark(event.time.secs(), &event.kind)).collect();
    let clauses: Vec<Value> = report
        .clauses
        .iter()
        .map(|clause| {
            json!({
                "id": clause.id, "text": clause.text, "setup": clause.role == ClauseRole::Setup, "must": clause.must,
                "standing": clause.standing, "times": clause.times_s, "evidence": clause.evidence, "source": clause.source,
            })
        })
        .collect();
    json!({
        "name": format!("{} · seed {}", report.planner, report.seed), "verdict": report.verdict.name(),
        "verdict_text": report.verdict_text, "robot_text": report.robot_text, "hz": SAMPLE_HZ, "agents": agents,
        "doors": doors, "events": events, "clauses": clauses, "metrics": report.metrics, "story": report.story,
        "simulated": report.simulated_s,
        "planner": report.planner, "seed": report.seed, "gaps": report.encounter_gaps_s, "success": report.success,
    })
}

/// A mark on the time line: time, lane (agent number), kind and words.
fn timeline_mark(secs: f64, kind: &EventKind) -> Option<Value> {
    let mark = |lane: u32, what: &str, words: String| Some(json!([secs, lane, what, words]));
    match kind {
        EventKind::Gesture { agent, gesture } if gesture.code() > 0 => {
            mark(agent.number(), "gesture", format!("{agent} says {gesture}"))
        }
        EventKind::Leaf { human, leaf } => mark(human.number(), "leaf", format!("{human}: {}", spoken(leaf))),
        EventKind::Sees { human, distance_m } => {
            mark(human.number(), "sees", format!("{human} sees the robot at {distance_m:.1} m"))
        }
        EventKind::Encounter { human, gap_s, .. } => {
            mark(human.number(), "encounter", format!("encounter of {human} and the robot, gap {gap_s:.1} s"))
        }
        EventKind::Contact { a, b, .. } => mark(b.number(), "contact", format!("{a} touches {b}")),
        EventKind::WallContact { agent, .. } => mark(agent.number(), "contact", format!("{agent} touches a wall")),
        EventKind::Door { door, open } => mark(0, "door", format!("{door} {}", if *open { "opens" } else { "closes" })),
        EventKind::RobotArrived => mark(0, "goal", "the robot is at its goal".to_owned()),
        EventKind::Stuck { agent } => mark(agent.number(), "stuck", format!("{agent} is stuck")),
        EventKind::Gesture { .. } | EventKind::Node { .. } | EventKind::End { .. } => None,
    }
}

/// A leaf's tag as words: `StandStill` becomes `stand still`.
fn spoken(tag: &str) -> String {
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
    use super::*;

    #[test]
    fn a_leaf_is_told_in_words() {
        assert_eq!(spoken("StandStill"), "stand still");
        assert_eq!(spoken("wait"), "wait");
    }
}
