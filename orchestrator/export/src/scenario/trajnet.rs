//! TrajNet++ ndjson: scenes of 21 frames at 2.5 a second, positions to the centimeter.
//!
//! A scene has a primary pedestrian, whose future is to be predicted from the others' past. Facts are those of the reader
//! `trajnetplusplustools` 0.3: `{"scene": {id, p, s, e, fps, tag}}` and `{"track": {f, p, x, y}}`, a line each.

use serde_json::json;
use socrates_model::AgentId;

use super::content::{Content, POSITIONS, WORDS, tracks_lack};
use super::frames::{Sample, between, file_name, number, samples};
use super::{File, Files, Foreign, Format, Scenario};
use crate::graph::Unusable;
use crate::not_carried::Losses;

/// Frames of a scene: 9 that are seen and 12 that are predicted.
const FRAMES: usize = 21;
/// Frames between the starts of two scenes of one pedestrian.
const STRIDE: usize = 12;
/// Ticks from frame to frame: 0.4 s.
const TICKS: u64 = 40;

const FLOOR: &str = "the format knows no floor";

/// What it lacks; ETH/UCY lacks the same.
pub(super) const LACKS: &[(Content, &str)] = tracks_lack!(
    [(Content::Headings, POSITIONS)],
    POSITIONS,
    [(Content::Walls, FLOOR), (Content::UnknownCells, FLOOR), (Content::Doors, FLOOR), (Content::DoorRules, FLOOR),],
    FLOOR
);

pub(super) const FORMAT: Format = Format {
    name: "trajnet",
    stem: "trajnet",
    about: "TrajNet++ ndjson: scenes of 21 frames at 2.5 a second; the robot is pedestrian 0",
    foreign: Foreign::Parsed,
    checked_by: "PyPI `trajnetplusplustools` 0.3.0",
    needs_run: true,
    feature: None,
    lacks: LACKS,
    write,
};

fn write(scenario: &Scenario, losses: &mut Losses) -> Result<Files, Unusable> {
    let Some(run) = &scenario.recording else { return Ok(Files::new()) };
    let samples = samples(run, TICKS)?;
    between(run, &samples, losses);
    losses.note(
        "digits of positions",
        "recording: x, y",
        "positions are written to the centimeter, as the data sets are",
    );
    let mut text = String::new();
    let mut scenes = 0_usize;
    for info in run.header.agents.iter().filter(|info| info.agent != AgentId::Robot) {
        let id = number(info.agent);
        let is_there = |sample: &Sample<'_>| sample.states.iter().any(|state| state.agent == id);
        let mut from = 0;
        while let Some(window) = samples.get(from..from + FRAMES) {
            let (Some(first), Some(last)) = (window.first(), window.last()) else { break };
            if window.iter().all(is_there) {
                // Tag 4 is `others`: the kinds 1 to 3 are results of an analysis of the tool.
                let scene = json!({"scene": {
                    "id": scenes, "p": id, "s": first.number, "e": last.number, "fps": 2.5, "tag": [4, []],
                }});
                text.push_str(&scene.to_string());
                text.push('\n');
                scenes += 1;
                from += STRIDE;
            } else {
                from += 1;
            }
        }
        if !text.contains(&format!("\"p\":{id},")) {
            losses.note(
                "scenes of people",
                format!("recording: {}", info.agent),
                "a scene needs 8 s of one person; they are tracks of other people's scenes only",
            );
        }
    }
    for sample in &samples {
        for state in &sample.states {
            let round = |value: f64| {
                let cents = (value * 100.0).round() / 100.0;
                if cents == 0.0 { 0.0 } else { cents }
            };
            let track =
                json!({"track": {"f": sample.number, "p": state.agent, "x": round(state.x), "y": round(state.y)}});
            text.push_str(&track.to_string());
            text.push('\n');
        }
    }
    Ok(Files::from([(format!("{}.ndjson", file_name(&scenario.name, losses)), File::Text(text))]))
}
