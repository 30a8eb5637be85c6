//! Conventions that formats share, decided once.
//!
//! | thing | ours, and how it is written |
//! |---|---|
//! | frame | map frame of ROS: meters, x to the right, y up, z up; the same in every format |
//! | map | its origin is the lower left corner of the lower left cell, with a yaw; cells are turned with it |
//! | yaw | rad, counterclockwise from +x, from -π to π |
//! | time | seconds from the first tick; a tick is 0.01 s |
//! | numbers | reals always with a decimal point, never with an exponent, to a millionth |
//! | ids | the robot is 0, `human_k` is k, where a format wants whole numbers |
//! | names | letters, digits and `_` where a format allows no others; what is rewritten is noted |

use socrates_model::{AgentId, AgentState, Point, Recording, SimTime, time::STEP_NANOS};

use crate::graph::{Unusable, micro};
use crate::not_carried::Losses;

/// A real as formats with strict types want it: `1.0`, `-0.25`, never `1`, `1e-6` or `-0.0`.
pub(crate) fn real(value: f64) -> String {
    let text = format!("{:.6}", micro(value));
    let short = text.trim_end_matches('0');
    if short.ends_with('.') { format!("{short}0") } else { short.to_owned() }
}

/// A place as formats of YAML want it: `{x: 1.0, y: -0.25}`, m.
pub(crate) fn point(at: Point) -> String {
    format!("{{x: {}, y: {}}}", real(at.x), real(at.y))
}

/// An angle from -π to π, rad.
pub(crate) fn angle(value: f64) -> f64 {
    libm::atan2(libm::sin(value), libm::cos(value))
}

/// The whole number by which formats know an agent: 0 for the robot, k for `human_k`.
pub(crate) const fn number(agent: AgentId) -> u32 {
    match agent {
        AgentId::Robot => 0,
        AgentId::Human(id) => id.number(),
    }
}

/// Refuses ids that messages of ROS cannot hold.
///
/// # Errors
/// An agent whose number is above [`i32::MAX`].
pub(crate) fn small_ids(agents: impl Iterator<Item = AgentId>) -> Result<(), Unusable> {
    match agents.into_iter().find(|agent| i32::try_from(number(*agent)).is_err()) {
        None => Ok(()),
        Some(agent) => {
            let problem = format!("`{agent}` is above {}, the largest id of a message of ROS", i32::MAX);
            Err(Unusable::new("proposal.json humans", problem, "number people from 1, or choose a format of tracks"))
        }
    }
}

/// Those who are at a place at one time.
#[derive(Debug, Clone)]
pub(crate) struct Sample<'a> {
    /// Number of the sample, from 0.
    pub(crate) number: u64,
    /// When, from the first tick.
    pub(crate) time: SimTime,
    /// States of those who are there, in the order of the recording.
    pub(crate) states: Vec<&'a AgentState>,
}

/// Samples of a run every so many ticks, from its first tick on.
///
/// # Errors
/// A run without ticks, or whose ticks do not fall on the times of the samples.
pub(crate) fn samples(run: &Recording, every: u64) -> Result<Vec<Sample<'_>>, Unusable> {
    let absent = run.header.absent();
    let first = run.frames.first().map(|state| state.tick).ok_or_else(|| {
        Unusable::new("recording", "the run has no tick", "`socrates run BUNDLE/request.toml` makes the run again")
    })?;
    let mut found: Vec<Sample<'_>> = Vec::new();
    for index in 0..run.ticks() {
        let states = run.tick(index);
        let Some(tick) = states.first().map(|state| state.tick.saturating_sub(first)) else { continue };
        if tick % every != 0 {
            continue;
        }
        let number = tick / every;
        let next = found.last().map_or(0, |last| last.number + 1);
        if number != next {
            let problem = format!("the run has no tick {} of the format's rate", first + next * every);
            return Err(Unusable::new(
                "recording",
                problem,
                "export a run with 100 ticks a second, as simulations make them",
            ));
        }
        let time = SimTime::from_nanos(tick.saturating_mul(STEP_NANOS));
        let states = states.iter().filter(|state| state.is_there(absent)).collect();
        found.push(Sample { number, time, states });
    }
    Ok(found)
}

/// Notes what lies between the samples of a format that is coarser than the run.
pub(crate) fn between(run: &Recording, samples: &[Sample<'_>], losses: &mut Losses) {
    let left = run.ticks().saturating_sub(samples.len());
    if left > 0 {
        let at = format!("recording: {left} of {} ticks", run.ticks());
        losses.note("ticks between samples", at, "the format has fewer samples a second than the run has ticks");
    }
}

/// A name of letters, digits and `_` for formats that allow no others; umlauts keep their letters.
pub(crate) fn plain_name(name: &str) -> String {
    let mut out = String::new();
    for letter in name.trim().chars() {
        match letter {
            'a'..='z' | 'A'..='Z' | '0'..='9' | '_' => out.push(letter),
            'ä' | 'æ' => out.push_str("ae"),
            'ö' | 'œ' => out.push_str("oe"),
            'ü' => out.push_str("ue"),
            'Ä' | 'Æ' => out.push_str("Ae"),
            'Ö' | 'Œ' => out.push_str("Oe"),
            'Ü' => out.push_str("Ue"),
            'ß' => out.push_str("ss"),
            _ => out.push('_'),
        }
    }
    let out: String = out.chars().take(60).collect();
    if out.chars().any(|letter| letter != '_') { out } else { "scenario".to_owned() }
}

/// The same, noted where the name had to be changed.
pub(crate) fn file_name(name: &str, losses: &mut Losses) -> String {
    let plain = plain_name(&name.replace('-', "_"));
    if plain != name.replace('-', "_") {
        losses.note(
            "spelling of names",
            format!("bundle `{}`", name.chars().take(80).collect::<String>()),
            &format!("names of files have letters, digits and `_`: it is written as `{plain}`"),
        );
    }
    plain
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_real_has_a_point_and_no_exponent() {
        let cases = [(1.0, "1.0"), (0.0, "0.0"), (-0.0, "0.0"), (1e-6, "0.000001"), (1e-9, "0.0"), (-2.5, "-2.5")];
        for (value, text) in cases {
            assert_eq!(real(value), text);
        }
        assert_eq!(real(123_456.789), "123456.789");
    }

    #[test]
    fn an_angle_lies_between_minus_pi_and_pi() {
        assert!((angle(7.0) - (7.0 - std::f64::consts::TAU)).abs() < 1e-12);
        assert!((angle(-4.0) - (std::f64::consts::TAU - 4.0)).abs() < 1e-12);
    }

    #[test]
    fn names_keep_letters_digits_and_umlauts() {
        let mut losses = Losses::default();
        assert_eq!(file_name("elevator-1", &mut losses), "elevator_1");
        assert!(losses.rows().is_empty(), "a hyphen is no loss");
        assert_eq!(file_name("Süd Straße 3", &mut losses), "Sued_Strasse_3");
        assert_eq!(losses.rows().len(), 1);
        assert_eq!((plain_name("日本"), plain_name("")), ("scenario".to_owned(), "scenario".to_owned()));
    }
}
