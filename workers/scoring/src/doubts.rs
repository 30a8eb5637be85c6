//! What looks wrong about a recording that can be read: other units, another map, holes.

use socrates_maps::{DistanceField, Ground};
use socrates_model::{Location, Recording};

use crate::tracks::{Track, Tracks};

/// Nobody walks or drives indoors faster than this, m/s: then the units are others.
const FAST_MPS: f64 = 5.0;
/// Who moves less than this over a minute and more has units that are too large, m.
const TINY_M: f64 = 0.05;
/// A hole in time longer than this is told, s.
const HOLE_SECS: f64 = 1.0;
/// Share of states in walls or off the map from which the map is taken to be another.
const OFF_SHARE: f64 = 0.1;

/// Doubts about a recording, in sentences; empty for one that looks like what it claims to be.
#[must_use]
pub fn doubts(recording: &Recording, location: Option<&Location>) -> Vec<String> {
    let Ok(tracks) = Tracks::read(recording) else { return Vec::new() };
    let mut found = Vec::new();
    if tracks.robot.is_none() {
        found.push("there is no robot: its id is `robot` or 0; only figures about people can be had".to_owned());
    }
    if tracks.humans.is_empty() {
        found.push("there is no human: figures about people are not applicable".to_owned());
    }
    for track in tracks.all() {
        found.extend(pace(track));
        found.extend(holes(track));
    }
    found.extend(apart(&tracks));
    if let Some(location) = location {
        let ground = Ground::of(&location.grid);
        found.extend(tracks.all().filter_map(|track| off(track, location, ground.field())));
    }
    found
}

/// Who is recorded at other times than the robot: outside its own record nobody is there.
fn apart(tracks: &Tracks) -> Vec<String> {
    let Some(robot) = &tracks.robot else { return Vec::new() };
    let ends = |track: &Track| Some((track.present().next()?.t, track.present().next_back()?.t));
    let mut found = Vec::new();
    let all: Vec<(f64, f64)> = tracks.all().filter_map(ends).collect();
    let begin = all.iter().map(|(first, _)| *first).fold(f64::INFINITY, f64::min);
    let end = all.iter().map(|(_, last)| *last).fold(f64::NEG_INFINITY, f64::max);
    if let Some((first, last)) = ends(robot).filter(|(first, last)| first - begin > HOLE_SECS || end - last > HOLE_SECS)
    {
        found.push(format!(
            "the robot is recorded from {first:.1} to {last:.1} s of {begin:.1} to {end:.1} s: only that is its trip"
        ));
    }
    for human in &tracks.humans {
        if robot.beside(human).next().is_none() {
            found.push(format!("{} is never recorded together with the robot: they count for nothing", human.agent));
        }
    }
    found
}

/// Speed of a moving agent by its positions, in the middle of all.
fn pace(track: &Track) -> Option<String> {
    let even = track.even(0.5);
    let mut speeds: Vec<f64> = even
        .iter()
        .zip(even.iter().skip(1))
        .map(|(a, b)| (b.at - a.at).norm() / (b.t - a.t).max(1e-9))
        .filter(|speed| *speed > 1e-9)
        .collect();
    speeds.sort_by(f64::total_cmp);
    let middle = *speeds.get(speeds.len() / 2)?;
    if middle > FAST_MPS {
        return Some(format!(
            "{} moves at {middle:.0} m/s: positions are expected in meters and times in seconds, not in pixels, centimeters or milliseconds",
            track.agent
        ));
    }
    let (first, last) = (track.samples.first()?, track.samples.last()?);
    let reach = track.samples.iter().map(|s| (s.at - first.at).norm()).fold(0.0, f64::max);
    (last.t - first.t > 60.0 && reach > 0.0 && reach < TINY_M).then(|| {
        format!("{} moves {reach:.3} m in {:.0} s: are positions in kilometers?", track.agent, last.t - first.t)
    })
}

/// The longest stretch without a sample.
fn holes(track: &Track) -> Option<String> {
    let pairs = track.samples.iter().zip(track.samples.iter().skip(1));
    let (length, from) = pairs.map(|(a, b)| (b.t - a.t, a.t)).max_by(|a, b| a.0.total_cmp(&b.0))?;
    (length > HOLE_SECS).then(|| {
        format!("{} has no sample for {length:.1} s from {from:.1} s on: taken as a straight line", track.agent)
    })
}

/// Whether the agent is in walls or off the map.
fn off(track: &Track, location: &Location, field: &DistanceField) -> Option<String> {
    let all = track.samples.len().max(1);
    let bad = track.present().filter(|s| field.clearance(&s.at) <= 0.0).count();
    #[expect(clippy::cast_precision_loss, reason = "samples of a run")]
    let share = bad as f64 / all as f64;
    let first = track.present().find(|s| field.clearance(&s.at) <= 0.0)?;
    (share > OFF_SHARE).then(|| {
        format!(
            "{} is in a wall or off the map `{}` for {:.0} % of the time, first at ({:.1}, {:.1}): is the map's origin another?",
            track.agent,
            location.name,
            share * 100.0,
            first.at.x,
            first.at.y
        )
    })
}

#[cfg(test)]
mod tests {
    use socrates_model::AgentId;

    use super::*;
    use crate::fixture::{Walk, floor, recording};

    #[test]
    fn other_units_another_map_and_holes_are_told_and_a_plain_run_is_not() {
        let plain = recording(&[Walk::robot(0., 0., 0.6, 0.), Walk::human(1, 5., 1., -1., 0.)], 10.0, 0.1);
        let place = floor(&[(-20., 5., 20., 10.)], &[], &[]);
        assert_eq!(doubts(&plain, Some(&place)), Vec::<String>::new());
        let pixels = recording(&[Walk::robot(0., 0., 60., 0.), Walk::human(1, 5., 1., -100., 0.)], 10.0, 0.1);
        let found = doubts(&pixels, None);
        assert!(found.len() == 2 && found[0].contains("60 m/s") && found[1].contains("human_1"), "{found:?}");
        let mut holed = plain.clone();
        holed.frames.drain(40..80);
        assert!(doubts(&holed, None)[0].contains("no sample for 2.1 s from 1.9 s"), "{:?}", doubts(&holed, None));
        let inside = recording(&[Walk::robot(0., 7., 0.6, 0.), Walk::human(1, 5., 1., -1., 0.)], 10.0, 0.1);
        assert!(doubts(&inside, Some(&place))[0].contains("is the map's origin another"));
        let mut early = plain.clone();
        crate::fixture::gone(&mut early, AgentId::Robot, 6.0..11.0);
        assert_eq!(
            doubts(&early, None),
            ["the robot is recorded from 0.0 to 5.9 s of 0.0 to 10.0 s: only that is its trip"]
        );
        crate::fixture::absent(&mut early, 1, 0.0..5.95);
        assert!(doubts(&early, None)[1].contains("human_1 is never recorded together with the robot"));
        let alone = recording(&[Walk::human(1, 5., 1., -1., 0.)], 10.0, 0.1);
        assert!(doubts(&alone, None)[0].starts_with("there is no robot"));
        let empty = recording(&[Walk::robot(0., 0., 0.6, 0.)], 10.0, 0.1);
        assert!(doubts(&empty, None)[0].starts_with("there is no human"));
    }
}
