//! The text of PedPy: `id frame x y z` between tabs at 100 frames a second, and the floor as WKT.

use std::fmt::Write as _;

use super::content::{Content, NEVER_SEEN, POSITIONS, WORDS, tracks_lack};
use super::frames::{file_name, real, samples};
use super::outline::walkable;
use super::{File, Files, Foreign, Format, Scenario};
use crate::graph::Unusable;
use crate::not_carried::Losses;

/// Frames a second.
const FPS: u64 = 100;

pub(super) const FORMAT: Format = Format {
    name: "pedpy",
    stem: "pedpy",
    about: "trajectory text and walkable area (WKT) of PedPy, 100 frames a second; the robot is 0",
    foreign: Foreign::Parsed,
    checked_by: "PyPI `pedpy` 1.5.1",
    needs_run: true,
    feature: None,
    lacks: tracks_lack!(
        [(Content::Headings, POSITIONS)],
        POSITIONS,
        [
            (Content::UnknownCells, NEVER_SEEN),
            (Content::Doors, "the floor of the format never changes: doors stand open"),
            (Content::DoorRules, "the floor of the format never changes: doors stand open"),
        ],
        WORDS
    ),
    write,
};

fn write(scenario: &Scenario, losses: &mut Losses) -> Result<Files, Unusable> {
    let Some(run) = &scenario.recording else { return Ok(Files::new()) };
    let mut text = format!("# framerate: {FPS} fps\n# ID\tframe\tx/m\ty/m\tz/m\n");
    for sample in &samples(run, 1)? {
        for state in &sample.states {
            // Writing to a String cannot fail.
            let (Ok(()) | Err(std::fmt::Error)) =
                writeln!(text, "{}\t{}\t{}\t{}\t0.0", state.agent, sample.number, real(state.x), real(state.y));
        }
    }
    let name = file_name(&scenario.name, losses);
    let wkt = walkable(&scenario.location.grid, losses)?;
    Ok(Files::from([
        (format!("{name}.txt"), File::Text(text)),
        (format!("{name}.wkt"), File::Text(format!("{}\n", wkt.polygon()))),
    ]))
}
