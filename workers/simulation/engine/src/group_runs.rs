//! Runs of people who walk together, of whoever overtakes, and of what a seed changes.

use socrates_model::{Action, AgentId, AgentState, EventKind, Recording, Relation, Rule, Trigger};

use crate::fixture::{Cast, carve, grouped, location, run, setup};
use crate::run::Engine;
use crate::setup::Setup;

/// A corridor along x of this width, with a doorway of 1 m at x = 15 if asked for.
fn corridor(width_m: f64, doorway: bool) -> socrates_model::Location {
    let (low, high) = (3.0 - width_m / 2.0, 3.0 + width_m / 2.0);
    let free = if doorway {
        vec![(0.1, low, 14.9, high), (14.8, 2.5, 15.2, 3.5), (15.1, low, 29.9, high)]
    } else {
        vec![(0.1, low, 29.9, high)]
    };
    location(
        carve(30.0, 6.0, &free),
        &[("a", 2.0, 3.0), ("b", 8.0, 3.0), ("c", 15.0, 3.0), ("d", 22.0, 3.0), ("e", 28.0, 3.0)],
        &[("a", "b"), ("b", "c"), ("c", "d"), ("d", "e")],
    )
}

const THERE: &[&str] = &["a", "b", "c", "d", "e"];
const BACK: &[&str] = &["e", "d", "c", "b", "a"];

/// Blocks the robot for so long as soon as it sees it within 4 m.
fn blocks(for_s: f64) -> Rule {
    Rule {
        when: vec![Trigger::RobotVisible(4.0)],
        act: Action::Block,
        gesture: None,
        for_s: Some(for_s),
        latched: true,
        ..Rule::default()
    }
}

fn robot(recording: &Recording) -> Vec<AgentState> {
    recording.track(AgentId::Robot).cloned().collect()
}

fn human(recording: &Recording, number: u32) -> Vec<AgentState> {
    recording.track(AgentId::from_number(number)).cloned().collect()
}

/// Where somebody is as it is level with the robot along x.
fn level(recording: &Recording, number: u32) -> Option<f64> {
    let (robot, track) = (robot(recording), human(recording, number));
    let beside = robot.iter().zip(&track).find(|(robot, human)| human.x <= robot.x);
    beside.map(|(robot, human)| human.y - robot.y)
}

#[test]
fn a_group_goes_aside_together_and_leaves_the_robot_the_other_side() {
    for seed in 1..=6 {
        let cast = [Cast(Relation::Frontal, BACK, vec![]), Cast(Relation::Frontal, BACK, vec![])];
        let made = grouped(setup(corridor(2.6, false), THERE, &cast, &[(1, "c"), (2, "c")]));
        let recording = run(Setup { seed, ..made });
        let sides: Vec<f64> = (1..=2).map(|number| level(&recording, number).unwrap()).collect();
        assert!(sides[0].signum() == sides[1].signum(), "seed {seed}: {sides:?}");
        assert!(sides.iter().all(|aside| aside.abs() > 0.55), "seed {seed}: {sides:?}");
    }
}

#[test]
fn a_group_of_four_walks_as_fast_as_its_members_want_to() {
    let cast: Vec<Cast<'_>> = (0..4).map(|_| Cast(Relation::Frontal, BACK, vec![])).collect();
    let mut made = grouped(setup(corridor(4.0, false), &["a", "b"], &cast, &[]));
    for human in &mut made.proposal.humans {
        human.speed_mps = Some(1.7);
    }
    let still = Setup { planner: "none".parse().unwrap(), duration_s: Some(30.0), ..made };
    let recording = Engine::new(still).unwrap().run(None, &mut |_, _| {});
    for number in 1..=4 {
        let track = human(&recording, number);
        // Between x = 22 and 8 m nobody is kept back by whoever walks before him.
        let on_way: Vec<f64> =
            track.iter().filter(|at| (8.0..22.0).contains(&at.x)).map(|at| at.vx.hypot(at.vy)).collect();
        #[expect(clippy::cast_precision_loss, reason = "a few thousand samples")]
        let mean = on_way.iter().sum::<f64>() / on_way.len() as f64;
        assert!(mean > 1.4, "human_{number}: {mean:.2} m/s");
    }
}

#[test]
fn a_group_falls_into_line_before_a_doorway_and_gets_through() {
    for seed in 1..=6 {
        let cast: Vec<Cast<'_>> = (0..3).map(|_| Cast(Relation::Frontal, BACK, vec![])).collect();
        let made = grouped(setup(corridor(2.6, true), &["a", "b"], &cast, &[]));
        let still = Setup { seed, planner: "none".parse().unwrap(), duration_s: Some(60.0), ..made };
        let recording = Engine::new(still).unwrap().run(None, &mut |_, _| {});
        // From 2 m before the doorway to 2 m behind it in less than 8 s: nobody is wedged in.
        for number in 1..=3 {
            let track = human(&recording, number);
            let near = track.iter().filter(|at| (at.x - 15.0).abs() < 2.0).count();
            #[expect(clippy::cast_precision_loss, reason = "a few thousand samples")]
            let secs = near as f64 * 60.0 / track.len() as f64;
            assert!(track.last().unwrap().x < 4.0 && secs < 8.0, "seed {seed}, human_{number}: {secs:.1} s");
        }
    }
}

#[test]
fn whoever_comes_from_behind_gets_past_the_robot_where_there_is_just_room() {
    for width_m in [2.4, 2.6] {
        for seed in 1..=4 {
            let cast = [Cast(Relation::Behind, THERE, vec![])];
            let mut made = setup(corridor(width_m, false), &THERE[1..], &cast, &[(1, "c")]);
            made.proposal.humans[0].speed_mps = Some(1.4);
            let recording = run(Setup { seed, ..made });
            let (robot, human) = (robot(&recording), human(&recording, 1));
            let past = robot.iter().zip(&human).any(|(robot, human)| human.x > robot.x + 1.0 && robot.x < 27.0);
            assert!(past, "{width_m} m, seed {seed}");
        }
    }
}

#[test]
fn seeds_differ_also_for_people_whose_speed_is_given() {
    let run = |seed: u64| {
        let cast = [Cast(Relation::Frontal, BACK, vec![]), Cast(Relation::Static, &["d"], vec![])];
        let mut made = setup(corridor(2.6, false), THERE, &cast, &[(1, "c")]);
        for human in &mut made.proposal.humans {
            human.speed_mps = Some(1.2);
        }
        run(Setup { seed, ..made })
    };
    let (one, same, other) = (run(1), run(1), run(2));
    assert_eq!(one.hash(), same.hash());
    for number in 1..=2 {
        let at = |recording: &Recording| human(recording, number)[0].y;
        assert!((at(&one) - at(&other)).abs() > 1e-6, "human_{number} stands where it stood");
    }
}

#[test]
fn those_who_block_together_stand_before_the_robot_two_by_two() {
    for seed in 1..=6 {
        let cast: Vec<Cast<'_>> = (0..4).map(|_| Cast(Relation::Frontal, BACK, vec![blocks(6.0)])).collect();
        let meetings = [(1, "c"), (2, "c"), (3, "c"), (4, "c")];
        let made = grouped(setup(corridor(4.0, false), THERE, &cast, &meetings));
        let recording = run(Setup { seed, ..made });
        let robot = robot(&recording);
        let people: Vec<Vec<AgentState>> = (1..=4).map(|number| human(&recording, number)).collect();
        // For two seconds and more all four stand in its line, two of them before the others.
        let wall = |tick: usize| {
            let from = |track: &Vec<AgentState>| (track[tick].x - robot[tick].x, track[tick].y - robot[tick].y);
            let mut ahead: Vec<f64> = people.iter().map(|track| from(track).0).collect();
            ahead.sort_by(f64::total_cmp);
            let in_line = |(ahead, aside): (f64, f64)| (0.6..2.5).contains(&ahead) && aside.abs() < 0.6;
            ahead[2] - ahead[1] > 0.3 && people.iter().map(from).all(in_line)
        };
        let longest = (0..robot.len()).fold((0_u32, 0_u32), |(most, now), tick| {
            let now = if wall(tick) { now + 1 } else { 0 };
            (most.max(now), now)
        });
        assert!(longest.0 >= 200, "seed {seed}: {} ticks", longest.0);
    }
}

#[test]
fn a_group_that_has_no_room_side_by_side_where_it_ends_gets_there_all_the_same() {
    for seed in 1..=6 {
        let cast: Vec<Cast<'_>> = (0..4).map(|_| Cast(Relation::Frontal, &BACK[..3], vec![])).collect();
        let made = grouped(setup(corridor(1.6, false), &["a", "b"], &cast, &[]));
        let still = Setup { seed, planner: "none".parse().unwrap(), duration_s: Some(60.0), ..made };
        let recording = Engine::new(still).unwrap().run(None, &mut |_, _| {});
        let stuck = |event: &&socrates_model::Event| matches!(event.kind, EventKind::Stuck { agent } if agent != AgentId::Robot);
        let stuck: Vec<_> = recording.events.iter().filter(stuck).collect();
        assert!(stuck.is_empty(), "seed {seed}: {stuck:?}");
    }
}
