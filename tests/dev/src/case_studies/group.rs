//! G: the robot passes people who stand and talk.

use std::path::Path;

use socrates_app::config::Config;
use socrates_app::prepare::prepare_text;
use socrates_model::{AgentState, EventKind, Point, Trigger, Vector};

use super::{Case, FEW, MANY, STOPPED_MPS, Wrong, check, off_heading, secs, study, study_of, tick};

/// Leaves of reactions.
const REACTS: &[&str] = &["RunAway", "LookAt", "GiveWay", "Block", "Approach", "Follow"];

/// Whether a trigger waits to see the robot, and how near.
const fn distance(trigger: &Trigger) -> Option<(bool, f64)> {
    if let Trigger::RobotVisible(m) = trigger {
        Some((true, *m))
    } else if let Trigger::RobotNear(m) = trigger {
        Some((false, *m))
    } else {
        None
    }
}

pub(super) fn items(case: &Case<'_>) -> Wrong {
    let mut wrong = Wrong::new();
    let group = &case.scenario.made.proposal.groups[0];
    check(&mut wrong, (3..=6).contains(&group.members.len()), || format!("S1: {} members", group.members.len()));
    let members: Vec<&[AgentState]> = group.members.iter().map(|id| case.person(*id)).collect();
    let center = |tick: usize| -> Point {
        let first = members[0][tick].point();
        let sum: Vector = members.iter().map(|states| states[tick].point() - first).sum();
        first + sum / members.len() as f64
    };
    let near = (0..case.robot.len())
        .find(|tick| members.iter().any(|states| (states[*tick].point() - case.robot[*tick].point()).norm() <= 3.0));
    let Some(near) = near else { return vec!["S5: the robot never comes within 3 m".to_owned()] };
    // S1 and S2: about one center, neighbors apart, facing it, standing until the robot is near.
    let (mut facing, mut all) = (0, 0);
    let (mut widest, mut moved) = ((0.0, 0), (0.0, 0));
    let (mut closest, mut loosest) = (f64::INFINITY, 0.0_f64);
    for tick in (50..near).step_by(5) {
        let middle = center(tick);
        for (index, states) in members.iter().enumerate() {
            let state = &states[tick];
            let away = (state.point() - middle).norm();
            widest = if away > widest.0 { (away, tick) } else { widest };
            moved = if state.speed() > moved.0 { (state.speed(), tick) } else { moved };
            facing += usize::from(off_heading(state, &middle) <= 45.0_f64.to_radians());
            all += 1;
            let others = members.iter().enumerate().filter(|(other, _)| *other != index);
            let next =
                others.map(|(_, other)| (other[tick].point() - state.point()).norm()).fold(f64::INFINITY, f64::min);
            (closest, loosest) = (closest.min(next), loosest.max(next));
        }
    }
    check(&mut wrong, widest.0 <= 1.5, || {
        format!("S1: a member {:.2} m from the center at {:.1} s", widest.0, secs(widest.1))
    });
    check(&mut wrong, closest >= 0.6 && loosest <= 1.6, || {
        format!("S1: neighbors {closest:.2} to {loosest:.2} m apart")
    });
    check(&mut wrong, facing * 10 >= all * 8, || format!("S1: {facing} of {all} looks go to the center"));
    check(&mut wrong, moved.0 < STOPPED_MPS, || {
        format!("S2: a member at {:.2} m/s at {:.1} s", moved.0, secs(moved.1))
    });
    // S3: the center near the intended way.
    let middle = center(near);
    let off = case.on_way(&middle).1;
    check(&mut wrong, off <= 1.5, || format!("S3: the center is {off:.2} m from the robot's way"));
    // S4: there is a way round outside of where they stand, not much longer than the direct one.
    let place = &case.scenario.prepared.location;
    let radius = case.scenario.run.header.agents[0].radius_m;
    let mut grid = place.grid.clone();
    let (start, goal) = (case.way[0], case.way[case.way.len() - 1]);
    let direct =
        socrates_maps::Geodesic::to(&socrates_maps::DistanceField::new(&grid), &goal, radius + 0.2).distance(&start);
    let reach = members.iter().map(|states| (states[near].point() - middle).norm()).fold(0.0, f64::max) + 0.3;
    for row in 0..grid.height {
        for column in 0..grid.width {
            if (grid.center_of(column, row) - middle).norm() <= reach {
                grid.cells[row * grid.width + column] = socrates_model::Cell::Occupied;
            }
        }
    }
    let round =
        socrates_maps::Geodesic::to(&socrates_maps::DistanceField::new(&grid), &goal, radius + 0.2).distance(&start);
    let ratio = direct.zip(round).map(|(direct, round)| round / direct);
    check(&mut wrong, ratio.is_some_and(|ratio| ratio <= 1.6), || {
        format!("S4: the way round is {ratio:?} of the direct one")
    });
    // S5: the robot goes by and ends 3 m beyond, on the other side.
    let (begin, end) = (case.robot[0].point(), case.robot[case.robot.len() - 1].point());
    let beyond = (end - middle).norm();
    let sides = (case.on_way(&begin).0, case.on_way(&middle).0, case.on_way(&end).0);
    check(&mut wrong, beyond >= 3.0 && sides.0 < sides.1 && sides.1 < sides.2, || {
        format!("S5: the robot ends {beyond:.1} m away")
    });
    // S6: nobody who is not named reacts.
    for (id, track) in &case.people {
        let rules = &case.scenario.made.proposal.human(*id).unwrap().rules;
        let runs = case.scenario.run.events.iter().any(|event| matches!(&event.kind, EventKind::Leaf { human, leaf } if human == id && REACTS.iter().any(|word| leaf.contains(word))));
        check(&mut wrong, !rules.is_empty() || !runs, || format!("S6: {id} reacts, unasked"));
        check(&mut wrong, !track.is_empty(), || format!("{id} has no track"));
        // Who is named reacts as near to the robot as it is told, give or take 0.3 m, or once it sees it.
        let Some((seen, asked)) = rules.first().and_then(|rule| rule.when.iter().find_map(distance)) else { continue };
        let begins = case.scenario.run.events.iter().find_map(|event| {
            let EventKind::Leaf { human, leaf } = &event.kind else { return None };
            let reacts = human == id && REACTS.iter().any(|word| leaf.contains(word));
            reacts.then(|| tick(event.time.secs()))
        });
        let Some(at) = begins.filter(|at| *at < track.len()) else {
            wrong.push(format!("S6: {id} never reacts"));
            continue;
        };
        let apart = (track[at].point() - case.robot[at].point()).norm();
        let late = !seen || case.first_sight(*id).is_some_and(|sight| sight + 30 < at);
        check(&mut wrong, apart <= asked + 0.3 && (!late || apart >= asked - 0.3), || {
            format!("S6: {id} reacts at {apart:.2} m, asked for {asked} m")
        });
    }
    wrong
}

async fn named(seeds: u64) {
    let text = "location = \"warehouse\"\nsocial_context = \"A morning shift\"\ntask = \"Carry a box through the packing area\"\n\
                rough_scenario = \"A group of 4 employees stands in the packing area and talks. One of them looks at the \
                robot when it is within 3 m.\"\n";
    let config = Config::load(None, std::iter::empty(), &[]).unwrap();
    let prepared = prepare_text("named", text, "named", Path::new("."), None, &config).unwrap();
    study_of(prepared, items, &["N: reaction at 8 m", "reaction muted"], seeds).await;
}

#[tokio::test]
async fn who_is_named_of_the_group_reacts_alone_and_where_it_was_told() {
    named(FEW).await;
}

#[tokio::test]
#[ignore = "sweep: 20 seeds"]
async fn who_is_named_of_the_group_reacts_alone_over_twenty_seeds() {
    named(MANY).await;
}

/// Spoiled runs that must be tried and refused.
pub(super) const KINDS: &[&str] = &[
    "N: a line back to back",
    "group broken",
    "N: 5 m from the way",
    "N: dissolves before the robot comes",
    "a person is missing",
];

#[tokio::test]
async fn in_the_warehouse_a_group_stands_in_a_circle_until_the_robot_is_there() {
    study("warehouse-group", items, KINDS, FEW).await;
}

#[tokio::test]
#[ignore = "sweep: 20 seeds"]
async fn in_the_warehouse_a_group_stands_in_a_circle_until_the_robot_is_there_over_twenty_seeds() {
    study("warehouse-group", items, KINDS, MANY).await;
}
