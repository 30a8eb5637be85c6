//! E: two leave the elevator, the third stays and is startled.

use socrates_model::{AgentId, AgentState, Relation, Trigger};

use super::{Case, FEW, MANY, STOPPED_MPS, Wrong, check, crossings, longest, off_heading, secs, study, tick};

pub(super) fn items(case: &Case<'_>) -> Wrong {
    let mut wrong = Wrong::new();
    let place = &case.scenario.prepared.location;
    let (leavers, stayers) = (case.of_relation(Relation::Leaving), case.of_relation(Relation::Staying));
    let three = (leavers.len(), stayers.len(), case.scenario.run.header.agents.len()) == (2, 1, 4);
    check(&mut wrong, three, || format!("S1: {} leave and {} stay", leavers.len(), stayers.len()));
    let (Some(third), [_, _]) = (stayers.first(), leavers.as_slice()) else { return wrong };
    let node = case.scenario.made.paths.humans[third].first().unwrap();
    let door = place.door_of(node).unwrap();
    let inside = case.node(node);
    let depths = |track: &[AgentState]| -> Vec<f64> {
        track.iter().map(|state| door.depth_m(&state.point(), &inside)).collect()
    };
    // S1: all inside at the start, apart from each other, the robot at least 4 m of way from the door.
    let starts: Vec<_> = leavers.iter().chain(&stayers).map(|id| (id, case.person(*id)[0].point())).collect();
    for (i, (id, a)) in starts.iter().enumerate() {
        check(&mut wrong, door.depth_m(a, &inside) > 0.0, || format!("S1: {id} starts outside"));
        for (other, b) in &starts[i + 1..] {
            let apart = (a - b).norm();
            check(&mut wrong, apart >= 0.6, || format!("S1: {id} and {other} start {apart:.2} m apart"));
        }
    }
    let to_door = case.on_way(&door.middle()).0 - case.on_way(&case.robot[0].point()).0;
    check(&mut wrong, to_door >= 4.0, || format!("S1: the robot starts {to_door:.1} m of way from the door"));
    // S2: the door opens once, with the robot 1 to 4 m away.
    let openings = case.openings(&door.id);
    check(&mut wrong, openings.len() == 1, || format!("S2: the door opens {} times", openings.len()));
    let Some(opens) = openings.first().copied() else { return wrong };
    let away = (case.robot[tick(opens)].point() - door.middle()).norm();
    check(&mut wrong, (1.0..=4.0).contains(&away), || format!("S2: the robot is {away:.2} m away as the door opens"));
    // S3: no line of sight before the door opens.
    for (id, _) in &starts {
        let seen = case.first_sight(**id).map_or(f64::INFINITY, secs);
        check(&mut wrong, seen >= opens - 0.1, || {
            format!("S3: {id} sees the robot at {seen:.1} s, before {opens:.1} s")
        });
    }
    // S4: two go out once each, one after the other, in time, and end outside.
    let mut out: Vec<f64> = Vec::new();
    for id in &leavers {
        let track = case.person(*id);
        let found = crossings(&depths(track));
        let once = matches!(found.as_slice(), [(_, true)]);
        check(&mut wrong, once, || format!("S4: {id} crosses the door line {} times", found.len()));
        let end = (track.last().unwrap().point() - door.middle()).norm();
        check(&mut wrong, end >= 2.0, || format!("S4: {id} ends {end:.1} m from the door"));
        out.extend(found.first().map(|(at, _)| secs(*at)));
    }
    out.sort_by(f64::total_cmp);
    let [first, second] = out[..] else { return wrong };
    let in_time = first >= opens + 0.5 && second <= opens + 15.0;
    check(&mut wrong, in_time, || format!("S4: out at {first:.1} and {second:.1} s, opened at {opens:.1} s"));
    let gap = second - first;
    check(&mut wrong, (0.5..=5.0).contains(&gap), || format!("S4: one leaves {gap:.2} s after the other"));
    // S5: the third sees the robot from near, stops, looks, and hardly steps back. It is startled by what it sees
    // within the distance that its rule tells, at most 5 m.
    let track = case.person(*third);
    let view = 100.0_f64.to_radians();
    let rules = &case.scenario.made.proposal.human(*third).unwrap().rules;
    let told = rules.iter().flat_map(|rule| &rule.when).find_map(|trigger| {
        let Trigger::RobotVisible(m) = trigger else { return None };
        Some(*m)
    });
    let startled_m = told.unwrap_or(5.0).min(5.0);
    let noticed = (tick(opens)..track.len()).find(|k| {
        let (h, r) = (&track[*k], &case.robot[*k]);
        (h.point() - r.point()).norm() <= startled_m
            && off_heading(h, &r.point()) <= view
            && socrates_maps::sight_clear(&case.sight, &h.point(), &r.point(), &case.closed(*k))
    });
    let Some(noticed) = noticed else {
        wrong.push("S5: the third never sees the robot".to_owned());
        return wrong;
    };
    let (t, near) = (secs(noticed), (track[noticed].point() - case.robot[noticed].point()).norm());
    check(&mut wrong, (0.8..=5.0).contains(&near), || format!("S5: the third sees the robot at {near:.2} m"));
    let still = (noticed..track.len()).find(|k| track[*k].speed() < STOPPED_MPS).map_or(f64::INFINITY, secs);
    check(&mut wrong, still - t <= 1.5, || format!("S5: the third stops {:.1} s after it sees the robot", still - t));
    let span = tick(t + 1.5)..tick(t + 6.5).min(track.len());
    let looks =
        span.clone().filter(|k| off_heading(&track[*k], &case.robot[*k].point()) <= 20.0_f64.to_radians()).count();
    let share = looks as f64 / span.len().max(1) as f64;
    check(&mut wrong, share >= 0.8, || format!("S5: the third looks for {:.0} % of the time", share * 100.0));
    let back = track[noticed..].iter().map(|s| (s.point() - track[noticed].point()).norm()).fold(0.0, f64::max);
    check(&mut wrong, back <= 0.6, || format!("S5: the third steps {back:.2} m away"));
    // S6: it stays inside, and is startled before all is over.
    check(&mut wrong, depths(track).iter().all(|depth| *depth > 0.0), || {
        "S6: the third crosses the door line".to_owned()
    });
    check(&mut wrong, t <= second + 3.0, || format!("S6: startled at {t:.1} s, the second left at {second:.1} s"));
    // S7: who leaves does not stop on the way unless the robot is right ahead.
    for id in &leavers {
        let track = case.person(*id);
        let walks = (tick(opens) + 50..track.len()).rev().find(|k| track[*k].speed() > STOPPED_MPS).unwrap_or(0);
        let begins = (tick(opens)..walks).find(|k| track[*k].speed() > STOPPED_MPS).unwrap_or(walks);
        let (from, length) = longest((begins..walks).map(|k| {
            let r = case.robot[k].point();
            let ahead = (r - track[k].point()).norm() <= 1.0 && off_heading(&track[k], &r) <= 1.0;
            track[k].speed() < STOPPED_MPS && !ahead
        }));
        check(&mut wrong, secs(length) <= 2.0, || {
            format!("S7: {id} stands for {:.1} s from {:.1} s", secs(length), secs(begins + from))
        });
    }
    let robot = AgentId::Robot;
    check(&mut wrong, case.scenario.run.header.agents[0].agent == robot, || "the robot is not the first".to_owned());
    wrong
}

/// Spoiled runs that must be tried and refused.
pub(super) const KINDS: &[&str] = &[
    "N: leavers 15 s late",
    "N: one leaver fewer",
    "N: who should stay leaves",
    "N: startle before the door opens",
    "reaction muted",
    "a person is missing",
];

#[tokio::test]
async fn in_the_elevator_two_leave_one_stays_startled() {
    study("elevator", items, KINDS, FEW).await;
}

#[tokio::test]
#[ignore = "sweep: 20 seeds"]
async fn in_the_elevator_two_leave_one_stays_startled_over_twenty_seeds() {
    study("elevator", items, KINDS, MANY).await;
}
