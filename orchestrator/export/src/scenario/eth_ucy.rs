//! The text of ETH and UCY as trajectory prediction reads it: `frame id x y` between tabs, a frame every 0.4 s.
//!
//! Frames are numbered in tens, as in the files that Social-GAN and OpenTraj read.

use std::fmt::Write as _;

use super::frames::{between, file_name, real, samples};
use super::trajnet::LACKS;
use super::{File, Files, Foreign, Format, Scenario};
use crate::graph::Unusable;
use crate::not_carried::Losses;

/// Ticks from frame to frame: 0.4 s.
const TICKS: u64 = 40;
/// Difference of the numbers of two frames.
const FRAME_STEP: u64 = 10;

pub(super) const FORMAT: Format = Format {
    name: "eth-ucy",
    stem: "eth-ucy",
    about: "text of the ETH and UCY data sets: frame, id, x, y; 2.5 frames a second, numbered in tens; the robot is 0",
    foreign: Foreign::Parsed,
    checked_by: "PyPI `numpy` (`loadtxt`, as the loaders of the data sets read it)",
    needs_run: true,
    feature: None,
    lacks: LACKS,
    write,
};

fn write(scenario: &Scenario, losses: &mut Losses) -> Result<Files, Unusable> {
    let Some(run) = &scenario.recording else { return Ok(Files::new()) };
    let samples = samples(run, TICKS)?;
    between(run, &samples, losses);
    let mut text = String::new();
    for sample in &samples {
        for state in &sample.states {
            let frame = sample.number * FRAME_STEP;
            // Writing to a String cannot fail.
            let (Ok(()) | Err(std::fmt::Error)) =
                writeln!(text, "{frame}.0\t{}.0\t{}\t{}", state.agent, real(state.x), real(state.y));
        }
    }
    Ok(Files::from([(format!("{}.txt", file_name(&scenario.name, losses)), File::Text(text))]))
}
