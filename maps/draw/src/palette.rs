//! Colors that stay apart for color-blind eyes and in gray print (after Okabe and Ito 2008).

/// Robot.
pub const ROBOT: &str = "#0072B2";
/// Walls.
pub const WALL: &str = "#3b3f46";
/// Floor.
pub const FLOOR: &str = "#ffffff";
/// Never seen.
pub const UNKNOWN: &str = "#e8eaed";
/// Doors.
pub const DOOR: &str = "#a8641c";
/// Scene graph lines.
pub const GRAPH: &str = "#b9c0ca";
/// Text.
pub const INK: &str = "#1f2328";
/// Quiet text.
pub const QUIET: &str = "#5b636e";
/// Something that holds.
pub const GOOD: &str = "#00795c";
/// Something that fails.
pub const BAD: &str = "#b3400b";

const HUMANS: [&str; 8] = ["#D55E00", "#009E73", "#CC79A7", "#E69F00", "#6a51a3", "#8c564b", "#4d9221", "#c51b7d"];

/// Color of a human by its number from 1; repeats after eight.
#[must_use]
pub fn human(number: u32) -> &'static str {
    let index = (number.saturating_sub(1) as usize) % HUMANS.len();
    HUMANS.get(index).copied().unwrap_or(ROBOT)
}

/// Color of an agent by its frame number (0 is the robot).
#[must_use]
pub fn agent(number: u32) -> &'static str {
    if number == 0 { ROBOT } else { human(number) }
}
