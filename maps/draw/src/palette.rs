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

const HUMAN_WORDS: [&str; 8] = ["#a84a00", "#00755a", "#9c3f75", "#8a5f00", "#5d4596", "#784a40", "#3f7a1a", "#a8155f"];

/// Color for words about an agent: the agent's own, darkened until it has a contrast of 4.5 on white.
#[must_use]
pub fn agent_words(number: u32) -> &'static str {
    let Some(index) = number.checked_sub(1) else { return "#00619a" };
    HUMAN_WORDS.get(index as usize % HUMAN_WORDS.len()).copied().unwrap_or(INK)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn luminance(color: &str) -> f64 {
        let channel = |at: usize| {
            let c = f64::from(u8::from_str_radix(&color[at..at + 2], 16).unwrap()) / 255.0;
            if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
        };
        0.2126 * channel(1) + 0.7152 * channel(3) + 0.0722 * channel(5)
    }

    #[test]
    fn words_in_the_color_of_an_agent_can_be_read_on_white() {
        for color in (0..9).map(agent_words).chain([INK, QUIET, GOOD, BAD]) {
            let contrast = 1.05 / (luminance(color) + 0.05);
            assert!(contrast >= 4.5, "{color} has a contrast of {contrast:.2}");
        }
    }
}
