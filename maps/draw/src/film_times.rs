//! When a film begins and ends, and how fast it goes.

use socrates_model::{EventKind, Recording};

use crate::film::{FilmError, FilmOptions};
use crate::page_data::reacts;

/// Longest film, s.
pub const LONGEST_SECS: f64 = 20.0;
/// Seconds of a card with words before and behind the run.
const CARD_SECS: (f64, f64) = (1.5, 2.5);
/// Seconds for which a film without words stands still before and behind the run.
const STILL_SECS: f64 = 1.0;
/// Seconds of the run that are shown before and behind what happens.
const AROUND_SECS: f64 = 5.0;
/// Below this surface distance robot and human are near each other, m.
const NEAR_M: f64 = 2.0;
/// What begins within so long is how somebody starts, s.
pub(crate) const FIRST_SECS: f64 = 0.5;

/// Which part of the run a film shows, and how fast.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Times {
    /// First moment of the run, s.
    pub from_s: f64,
    /// Last moment of the run, s.
    pub to_s: f64,
    /// Simulated seconds per second.
    pub speed: f64,
    /// Pictures per second.
    pub fps: u32,
    /// Seconds of the film before the run begins, and after it has ended.
    pub cards_s: (f64, f64),
}

impl Times {
    /// The times of a film of these runs: from 5 s before the first meeting to 5 s after the last, in all of them.
    ///
    /// # Errors
    /// [`FilmError::Speed`] for a speed outside 0.1 to 20, [`FilmError::Part`] for a part that ends before it begins.
    pub fn of(shown: &[&Recording], options: &FilmOptions) -> Result<Self, FilmError> {
        let cards_s = if options.labels { CARD_SECS } else { (STILL_SECS, STILL_SECS) };
        if let Some((from_s, to_s)) = options.part {
            if !(from_s.is_finite() && to_s.is_finite() && 0.0 <= from_s && from_s < to_s) {
                return Err(FilmError::Part { from_s, to_s });
            }
            let speed = options.speed.unwrap_or(1.0);
            return Ok(Self { from_s, to_s, speed, fps: options.fps.max(1), cards_s });
        }
        let (from, to) = window(shown);
        let room = LONGEST_SECS - cards_s.0 - cards_s.1;
        let speed = match options.speed {
            Some(found) if !(0.1..=20.0).contains(&found) => return Err(FilmError::Speed { found }),
            Some(speed) => speed,
            // Rounded up to a tenth, so that it can be told in words.
            None => (((to - from) / room * 10.0 - 1e-9).ceil() / 10.0).max(1.0),
        };
        let most = room * speed;
        let (from_s, to_s) = if to - from <= most {
            (from, to)
        } else {
            let middle = shown.iter().find_map(|run| heart_s(run)).unwrap_or_else(|| f64::midpoint(from, to));
            let from_s = (middle - most / 2.0).clamp(from, to - most);
            (from_s, from_s + most)
        };
        Ok(Self { from_s, to_s, speed, fps: options.fps.max(1), cards_s })
    }

    /// Length of the film, s.
    #[must_use]
    pub fn length_s(&self) -> f64 {
        self.cards_s.0 + self.cards_s.1 + (self.to_s - self.from_s) / self.speed
    }

    /// Number of pictures.
    #[must_use]
    pub fn pictures(&self) -> usize {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a film has fewer than 2^53 pictures"
        )]
        let count = (self.length_s() * f64::from(self.fps)).round() as usize;
        count.max(1)
    }

    /// The time of the film at which a picture is shown, s.
    pub(crate) fn picture_s(&self, picture: usize) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "at most some thousand pictures")]
        let picture = picture as f64;
        picture / f64::from(self.fps.max(1))
    }

    /// The moment of the run that a picture shows, s.
    #[must_use]
    pub fn moment_s(&self, picture: usize) -> f64 {
        self.at_film_s(self.picture_s(picture))
    }

    /// The moment of the run at a time of the film, s.
    pub(crate) fn at_film_s(&self, film_s: f64) -> f64 {
        (self.from_s + (film_s - self.cards_s.0).max(0.0) * self.speed).min(self.to_s)
    }

    /// When a moment of the run is seen first in the film, s: from the start where the run begins with it, to the end
    /// where it comes later.
    pub(crate) fn film_s(&self, moment_s: f64) -> f64 {
        if moment_s <= self.from_s {
            0.0
        } else if moment_s >= self.to_s {
            self.length_s()
        } else {
            self.cards_s.0 + (moment_s - self.from_s) / self.speed
        }
    }
}

/// Length of a recording, s.
pub(crate) fn length_s(recording: &Recording) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "a recording has fewer than 2^53 ticks")]
    let ticks = recording.ticks().saturating_sub(1) as f64;
    ticks * recording.header.step_s
}

/// From when to when something happens between robot and people in any of these runs, with some seconds around it, s; all of
/// them where nothing does.
#[must_use]
pub fn window(shown: &[&Recording]) -> (f64, f64) {
    let whole = shown.iter().map(|run| length_s(run)).fold(0.0, f64::max);
    let met: Vec<(f64, f64)> = shown.iter().filter_map(|run| meeting(run)).collect();
    let (first, last) = met.iter().fold((f64::MAX, f64::MIN), |(a, b), (from, to)| (a.min(*from), b.max(*to)));
    if first > last {
        return (0.0, whole);
    }
    ((first - AROUND_SECS).max(0.0), (last + AROUND_SECS).min(whole))
}

/// From the first to the last event between robot and people, s.
fn meeting(run: &Recording) -> Option<(f64, f64)> {
    let told = run.events.iter().filter(|event| match &event.kind {
        EventKind::Encounter { .. } | EventKind::Contact { .. } => true,
        EventKind::Gesture { gesture, .. } => gesture.is_some(),
        EventKind::Leaf { leaf, .. } => event.time.secs() >= FIRST_SECS && reacts(leaf),
        EventKind::Sees { .. }
        | EventKind::StepEnded { .. }
        | EventKind::WallContact { .. }
        | EventKind::Door { .. }
        | EventKind::Node { .. }
        | EventKind::RobotArrived
        | EventKind::Stuck { .. }
        | EventKind::End { .. } => false,
    });
    span(told.map(|event| event.time.secs())).or_else(|| span(near(run)))
}

fn span(moments: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    moments.fold(None, |span, t| {
        let (first, last) = span.unwrap_or((t, t));
        Some((first.min(t), last.max(t)))
    })
}

/// Moments at which robot and human are near each other.
fn near(run: &Recording) -> impl Iterator<Item = f64> {
    const EVERY: usize = 10;
    let curve = crate::series::curves(run, EVERY).distance_m;
    let step_s = run.header.step_s;
    curve.into_iter().enumerate().filter(|(_, gap)| gap.is_some_and(|gap| gap < NEAR_M)).map(move |(index, _)| {
        #[expect(clippy::cast_precision_loss, reason = "a recording has fewer than 2^53 ticks")]
        let tick = (index * EVERY) as f64;
        tick * step_s
    })
}

/// When it happens: the first encounter, else the first moment at which they are near each other.
fn heart_s(run: &Recording) -> Option<f64> {
    let met = run.events.iter().find(|event| matches!(event.kind, EventKind::Encounter { .. }));
    met.map(|event| event.time.secs()).or_else(|| near(run).next())
}

#[cfg(test)]
mod tests {
    use socrates_model::{Event, HumanId, NodeId, SimTime};

    use super::*;
    use crate::fixture::walk;

    const OPTIONS: FilmOptions = FilmOptions { size: (320, 180), fps: 10, ..FilmOptions::USUAL };

    fn long(seconds: usize, met_s: &[u64]) -> Recording {
        let mut run = walk(if met_s.is_empty() { 0 } else { 1 });
        let tick: Vec<_> = run.tick(0).to_vec();
        while run.ticks() <= seconds * 100 {
            run.frames.extend(&tick);
        }
        let met =
            || EventKind::Encounter { human: HumanId::new(1), node: NodeId::new("m").unwrap(), gap_s: 0.4, nth: 1 };
        let event = |s: &u64| Event { time: SimTime::from_nanos(s * 1_000_000_000), kind: met() };
        run.events = met_s.iter().map(event).collect();
        run
    }

    fn of(run: &Recording, speed: Option<f64>) -> Times {
        Times::of(&[run], &FilmOptions { speed, ..OPTIONS }).unwrap()
    }

    #[test]
    fn a_film_shows_the_meeting_with_five_seconds_around_it() {
        let times = of(&long(98, &[40, 44]), None);
        assert!((times.from_s - 35.0).abs() < 1e-9 && (times.to_s - 49.0).abs() < 1e-9, "{times:?}");
        assert!((times.speed - 1.0).abs() < 1e-12 && times.length_s() <= 18.1);
        // Pictures cover it from its first to its last moment.
        let moments: Vec<f64> = (0..times.pictures()).map(|index| times.moment_s(index)).collect();
        assert!((moments[0] - 35.0).abs() < 1e-9 && (moments[moments.len() - 1] - 49.0).abs() < 1e-9);
        assert!(moments.windows(2).all(|pair| pair[1] - pair[0] <= 0.1 + 1e-9));
        let both = Times::of(&[&long(98, &[40]), &long(98, &[60])], &OPTIONS).unwrap();
        assert!((both.from_s - 35.0).abs() < 1e-9 && (both.to_s - 65.0).abs() < 1e-9, "{both:?}");
    }

    #[test]
    fn a_run_without_a_meeting_is_shown_whole_and_a_long_one_faster() {
        let times = of(&long(60, &[]), None);
        assert!(times.from_s.abs() < 1e-9 && (times.to_s - 60.0).abs() < 0.02);
        assert!(times.speed > 3.0 && times.length_s() <= LONGEST_SECS, "{times:?}");
        let slow = of(&long(98, &[20, 80]), None);
        assert!(
            (slow.from_s - 15.0).abs() < 1e-9 && (slow.to_s - 85.0).abs() < 1e-9 && slow.length_s() <= LONGEST_SECS
        );
    }

    #[test]
    fn a_fixed_speed_shows_the_part_where_it_happens() {
        let part = of(&long(98, &[20, 80]), Some(1.0));
        assert!(part.length_s() <= LONGEST_SECS + 1e-9 && part.from_s <= 20.0 && part.to_s >= 20.0, "{part:?}");
    }

    #[test]
    fn a_film_stands_still_at_both_ends() {
        let times = of(&walk(1), None);
        assert!((times.moment_s(0) - times.moment_s(9)).abs() < 1e-12);
        let last = times.pictures();
        assert!((times.moment_s(last - 1) - times.moment_s(last - 10)).abs() < 1e-12);
    }
}
