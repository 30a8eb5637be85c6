//! I: people come out of a room suddenly where ways meet.

use std::f64::consts::FRAC_PI_2;

use socrates_model::{AgentState, Point};

use super::{Case, FEW, MANY, Wrong, check, secs, study, tick};

/// The first tick at which somebody is within a distance of a place.
fn there(track: &[AgentState], at: &Point, within_m: f64) -> Option<usize> {
    track.iter().position(|state| (state.point() - at).norm() <= within_m)
}

pub(super) fn items(case: &Case<'_>) -> Wrong {
    let mut wrong = Wrong::new();
    let graph = &case.scenario.prepared.location.graph;
    let paths = &case.scenario.made.paths;
    check(&mut wrong, case.people.len() >= 2, || format!("{} people", case.people.len()));
    let (mut gaps, mut out, mut sights) = (Vec::new(), Vec::new(), Vec::new());
    for id in case.people.keys() {
        let track = case.person(*id);
        let way = &paths.humans[id];
        let Some(node) = paths.encounter_of(*id) else {
            wrong.push(format!("S2: {id} has no encounter"));
            continue;
        };
        let junction = case.node(node);
        // S1: in the room, out of sight, with the robot 5 m from the junction.
        let kind = graph.node(&way[0]).unwrap().kind.to_lowercase();
        let room = ["room", "office", "kitchen"].iter().any(|word| kind.contains(word));
        check(&mut wrong, room, || format!("S1: {id} starts at a {kind}"));
        let hidden = case.first_sight(*id);
        check(&mut wrong, hidden.is_some_and(|k| k > 0), || {
            format!("S1: {id} and the robot see each other at {hidden:?}")
        });
        let start = (case.robot[0].point() - junction).norm();
        check(&mut wrong, start >= 5.0, || format!("S1: the robot starts {start:.1} m from the junction"));
        // S2: three ways or more meet there, within 8 m of the way out of the room.
        let degree = graph.neighbors(node).len();
        check(&mut wrong, degree >= 3, || format!("S2: {degree} ways meet at {node}"));
        let door = case.node(&way[1]);
        let far = (door - junction).norm();
        check(&mut wrong, far <= 8.0, || format!("S2: the door is {far:.1} m from {node}"));
        // S3: out once. Without a door line, the threshold is the half way between the room's node and its door.
        let room = case.node(&way[0]);
        let line = (door - room).normalize();
        let outside: Vec<bool> = track.iter().map(|state| (state.point() - door).dot(&line) > 0.0).collect();
        let changes: Vec<usize> = (1..outside.len())
            .filter(|k| outside[*k] != outside[*k - 1] && (track[*k].point() - door).norm() < 1.0)
            .collect();
        check(&mut wrong, changes.len() == 1, || format!("S3: {id} crosses the threshold {} times", changes.len()));
        out.extend(changes.first().map(|k| secs(*k)));
        // S4: seen from near only, and then soon in the robot's way; S6: the robot moves and is still before it.
        if let Some(k) = hidden {
            let near = (track[k].point() - case.robot[k].point()).norm();
            check(&mut wrong, near <= 4.0, || format!("S4: {id} is first seen from {near:.1} m"));
            let enters =
                (k..track.len()).find(|k| case.on_way(&track[*k].point()).1 <= 0.6).map_or(f64::INFINITY, secs);
            check(&mut wrong, enters - secs(k) <= 2.5, || {
                format!("S4: {id} is in the way {:.1} s after it is seen", enters - secs(k))
            });
            sights.push(k);
            let (mine, theirs) = (case.on_way(&case.robot[k].point()).0, case.on_way(&junction).0);
            check(&mut wrong, mine < theirs, || format!("S6: the robot is {:.1} m past the junction", mine - theirs));
        }
        // S5: there together.
        match (there(&case.robot, &junction, 1.5), there(track, &junction, 1.5)) {
            (Some(r), Some(h)) => gaps.push((secs(h) - secs(r)).abs()),
            (None, _) | (_, None) => wrong.push(format!("S5: not both of {id} and the robot get to {node}")),
        }
        let course = |track: &[AgentState]| {
            let k = there(track, &junction, 1.5)?;
            let (from, to) = (track[k.saturating_sub(50)].point(), track[(k + 50).min(track.len() - 1)].point());
            Some((to - from).normalize())
        };
        if let (Some(r), Some(h)) = (course(&case.robot), course(track)) {
            let angle = r.dot(&h).clamp(-1.0, 1.0).acos();
            check(&mut wrong, (angle - FRAC_PI_2).abs() <= FRAC_PI_2 / 2.0, || {
                format!("S5: {id} at {:.0} degrees", angle.to_degrees())
            });
        }
        // S7: nobody is back in the room within 5 s.
        if let Some(first) = changes.first() {
            let back = (*first..tick(secs(*first) + 5.0).min(outside.len()))
                .any(|k| !outside[k] && (track[k].point() - room).norm() < (door - room).norm());
            check(&mut wrong, !back, || format!("S7: {id} turns back"));
        }
    }
    // S6: the robot moves when it sees the first of them.
    let speed = sights.iter().min().map_or(0.0, |k| case.robot[*k].speed());
    check(&mut wrong, speed > 0.2, || format!("S6: the robot is at {speed:.2} m/s at first sight"));
    out.sort_by(f64::total_cmp);
    let spread = out.last().zip(out.first()).map_or(0.0, |(last, first)| last - first);
    check(&mut wrong, spread <= 4.0, || format!("S3: the last comes out {spread:.1} s after the first"));
    let (least, most) = (gaps.iter().copied().fold(f64::INFINITY, f64::min), gaps.iter().copied().fold(0.0, f64::max));
    check(&mut wrong, least <= 2.0 && most <= 4.0, || format!("S5: gaps of {gaps:.1?} s"));
    wrong
}

/// Spoiled runs that must be tried and refused.
pub(super) const KINDS: &[&str] =
    &["N: 8 s late", "N: already outside at the start", "path reversed", "a person is missing"];

#[tokio::test]
async fn at_the_intersection_two_come_out_of_a_room_suddenly() {
    study("intersection", items, KINDS, FEW).await;
}

#[tokio::test]
#[ignore = "sweep: 20 seeds"]
async fn at_the_intersection_two_come_out_of_a_room_suddenly_over_twenty_seeds() {
    study("intersection", items, KINDS, MANY).await;
}
