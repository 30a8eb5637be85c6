//! Doors: in which order robot and people go through, and how many people go through in a time.

use socrates_model::Door;

use crate::fidelity::doors::{FRAME_M, pieces_over};
use crate::metrics::{Family, Measure, Measured, Scene, count};
use crate::tracks::Track;

/// Somebody nearer to the middle of a door than this has come to it, m.
const AT_DOOR_M: f64 = 2.0;

/// The family.
pub(super) const FAMILY: Family = Family {
    name: "passages",
    thresholds: &[("at_door_m", AT_DOOR_M), ("frame_m", FRAME_M)],
    measure: Measure::Whole { measure, why: "whether somebody goes through later is known at the end" },
};

/// When a track crosses the line of a door, s, in order.
fn crossings(door: &Door, track: &Track) -> Vec<f64> {
    let along = door.to - door.from;
    pieces_over(door, &track.samples, |at| along.perp(&(at - door.from)))
        .map(|((a, before), (b, after))| a.t + (b.t - a.t) * before / (before - after))
        .collect()
}

/// Since when, up to a time, somebody has been at a door without a break, s; `None` for who is not there then.
fn there_since(door: &Door, track: &Track, t: f64) -> Option<f64> {
    let middle = door.middle();
    let at_door = |index: &usize| {
        track.samples.get(*index).is_some_and(|sample| sample.there && (sample.at - middle).norm() < AT_DOOR_M)
    };
    let last = track.samples.partition_point(|sample| sample.t <= t).checked_sub(1)?;
    let first = (0..=last).rev().take_while(at_door).last()?;
    track.samples.get(first).map(|sample| sample.t)
}

/// Whether somebody who shares the door with the robot was passed over; `None` for who does not share it.
fn passed_over(door: &Door, robot: (&Track, f64), human: &Track) -> Option<bool> {
    let (track, through) = robot;
    let theirs = crossings(door, human);
    match theirs.iter().find(|t| **t > through).zip(there_since(door, human, through)) {
        // Waits there while the robot goes through.
        Some((_, came)) => Some(came < there_since(door, track, through)?),
        // Went through while the robot was there.
        None => theirs.iter().rfind(|t| **t <= through).and_then(|t| there_since(door, track, *t)).map(|_| false),
    }
}

fn measure(scene: &Scene<'_>) -> Vec<Measured> {
    let doors = scene.signals.evidence.location.map_or(&[][..], |location| &location.doors);
    let none = || Err::<f64, String>("the map has no doors".to_owned());
    if doors.is_empty() {
        return vec![none(), none()];
    }
    let mut shared = Vec::new();
    for (door, robot) in doors.iter().flat_map(|door| scene.robot().map(|robot| (door, robot))) {
        for through in crossings(door, robot) {
            shared.extend(scene.whole.humans.iter().filter_map(|human| passed_over(door, (robot, through), human)));
        }
    }
    let errors = match shared.as_slice() {
        [] => Err("nobody shares a door with the robot".to_owned()),
        shared => Ok(count(shared.iter().filter(|passed| **passed).count())),
    };
    let times = doors.iter().map(|door| {
        let mut times: Vec<f64> = scene.whole.humans.iter().flat_map(|human| crossings(door, human)).collect();
        times.sort_by(f64::total_cmp);
        times
    });
    // Of doors that as many go through, the first.
    let most = times.reduce(|most, times| if times.len() > most.len() { times } else { most }).unwrap_or_default();
    let flow = match most.as_slice() {
        [first, .., last] if last > first => Ok(count(most.len() - 1) / (last - first)),
        [_, .., _] => Err("all go through the door at once".to_owned()),
        [] | [_] => Err("fewer than two people go through a door".to_owned()),
    };
    vec![errors, flow]
}

#[cfg(test)]
mod tests {
    use socrates_model::{AgentId, Location, Point};

    use super::*;
    use crate::evidence::Evidence;
    use crate::fixture::{Walk, floor, recording};
    use crate::metrics::tests::value_of;

    fn place() -> Location {
        let mut place = floor(&[], &[], &[]);
        place.doors.push(Door {
            id: "door".into(),
            kind: socrates_model::DoorKind::Room,
            from: Point::new(0., -0.5),
            to: Point::new(0., 0.5),
            opens: socrates_model::DoorOpens::Always,
            hold_s: 12.0,
            inside: Vec::new(),
        });
        place
    }

    fn of(walks: &[Walk], id: &str) -> [Option<f64>; 2] {
        let place = place();
        [0.1, 0.01].map(|step| {
            let run = recording(walks, 20.0, step);
            value_of(&Evidence { location: Some(&place), ..Evidence::of(&run) }, id)
        })
    }

    fn through(at_s: f64, agent: AgentId) -> Walk {
        Walk::through(agent, &[(0., -at_s, 0.), (20., 20.0 - at_s, 0.)])
    }

    #[test]
    fn whoever_came_first_and_is_passed_over_is_counted() {
        let human = |n| AgentId::Human(socrates_model::HumanId::new(n));
        // One waits 1 m before the door from the start and goes at 15 s; the robot goes through at 8 s.
        let waits = |until: f64| Walk::through(human(1), &[(0., -1., 0.4), (until, -1., 0.4), (20., 4., 0.4)]);
        let robot = || through(8.0, AgentId::Robot);
        assert_eq!(of(&[robot(), waits(15.)], "entering_order_errors"), [Some(1.0); 2]);
        // The same one goes before the robot while the robot is at the door already.
        let first = Walk::through(human(1), &[(0., -1., 0.4), (6.2, -1., 0.4), (7.2, 1., 0.4), (20., 9., 0.4)]);
        assert_eq!(of(&[robot(), first], "entering_order_errors"), [Some(0.0); 2]);
        // Somebody who comes to the door after the robot is behind it, and no error.
        assert_eq!(of(&[robot(), through(9.0, human(1))], "entering_order_errors"), [Some(0.0); 2]);
        // Somebody who never goes through shares nothing.
        let stays = Walk::through(human(1), &[(0., -1., 0.4), (20., -1., 0.4)]);
        assert_eq!(of(&[robot(), stays], "entering_order_errors"), [None; 2]);
    }

    #[test]
    fn flow_is_that_between_the_first_and_the_last_through_the_door() {
        let human = |n| AgentId::Human(socrates_model::HumanId::new(n));
        let robot = || Walk::robot(-15., 5., 0.1, 0.);
        let three: Vec<Walk> =
            [(2.0, 1), (5.0, 2), (7.0, 3)].iter().map(|(t, n)| through(*t, human(*n))).chain([robot()]).collect();
        for flow in of(&three, "flow_throughput") {
            assert!((flow.unwrap() - 2.0 / 5.0).abs() < 1e-4);
        }
        assert_eq!(of(&[robot(), through(3.0, human(1))], "flow_throughput"), [None; 2]);
        let run = recording(&[robot(), through(3.0, human(1)), through(5.0, human(2))], 20.0, 0.1);
        let bare = floor(&[], &[], &[]);
        assert_eq!(value_of(&Evidence { location: Some(&bare), ..Evidence::of(&run) }, "flow_throughput"), None);
    }
}
