//! The text of PedPy: `id frame x y z` between tabs at 100 frames a second, and the floor as WKT.

use std::fmt::Write as _;

use super::content::Content;
use super::frames::{file_name, real, samples};
use super::outline::walkable;
use super::{File, Files, Foreign, Format, Scenario};
use crate::graph::Unusable;
use crate::not_carried::Losses;

/// Frames a second.
const FPS: u64 = 100;

const POSITIONS: &str = "the format holds positions alone";
const WORDS: &str = "the format has no place for words or rules";

pub(super) const FORMAT: Format = Format {
    name: "pedpy",
    stem: "pedpy",
    about: "trajectory text and walkable area (WKT) of PedPy, 100 frames a second; the robot is 0",
    foreign: Foreign::Parsed,
    checked_by: "PyPI `pedpy` 1.5.1",
    needs_run: true,
    lacks: &[
        (Content::Headings, POSITIONS),
        (Content::Velocities, POSITIONS),
        (Content::Gestures, POSITIONS),
        (Content::Leaves, POSITIONS),
        (Content::Events, POSITIONS),
        (Content::Radii, POSITIONS),
        (Content::Speeds, POSITIONS),
        (Content::Roles, WORDS),
        (Content::Groups, WORDS),
        (Content::UnknownCells, "what was never seen is no floor, as walls are"),
        (Content::Doors, "the floor of the format never changes: doors stand open"),
        (Content::DoorRules, "the floor of the format never changes: doors stand open"),
        (Content::Graph, WORDS),
        (Content::AreaNames, WORDS),
        (Content::Paths, WORDS),
        (Content::Encounters, WORDS),
        (Content::Trees, WORDS),
        (Content::Clauses, WORDS),
        (Content::Texts, WORDS),
    ],
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
