//! Whole runs on small maps.

use std::collections::BTreeMap;

use socrates_model::{
    Action, AgentId, Door, DoorKind, DoorOpens, EventKind, GroupId, GroupProposal, HumanId, Point, Recording, Relation,
    Trigger, Vector,
};

use crate::fixture::{Cast, Liner, carve, hall, id, location, rule, run, setup};
use crate::run::Engine;
use crate::setup::Setup;

pub(crate) fn corridor() -> socrates_model::Location {
    let grid = carve(30.0, 3.2, &[(0.1, 0.3, 29.9, 2.9)]);
    location(
        grid,
        &[("a", 2.0, 1.6), ("b", 8.0, 1.6), ("c", 15.0, 1.6), ("d", 21.0, 1.6), ("e", 28.0, 1.6)],
        &[("a", "b"), ("b", "c"), ("c", "d"), ("d", "e")],
    )
}

pub(crate) fn crossing() -> socrates_model::Location {
    let grid = carve(24.0, 24.0, &[(0.2, 10.7, 23.8, 13.3), (10.7, 0.2, 13.3, 23.8)]);
    location(
        grid,
        &[
            ("w", 2.0, 12.0),
            ("w2", 7.0, 12.0),
            ("m", 12.0, 12.0),
            ("e2", 17.0, 12.0),
            ("e", 22.0, 12.0),
            ("n", 12.0, 21.0),
            ("s", 12.0, 3.0),
        ],
        &[("w", "w2"), ("w2", "m"), ("m", "e2"), ("e2", "e"), ("n", "m"), ("m", "s")],
    )
}

fn gaps(recording: &Recording) -> BTreeMap<u32, f64> {
    recording
        .events
        .iter()
        .filter_map(|event| {
            if let EventKind::Encounter { human, gap_s, .. } = &event.kind {
                Some((human.number(), *gap_s))
            } else {
                None
            }
        })
        .collect()
}

fn reason(recording: &Recording) -> String {
    match recording.events.last().map(|event| event.kind.clone()) {
        Some(EventKind::End { reason }) => reason,
        other => panic!("the last event is {other:?}"),
    }
}

fn nobody_overlaps(recording: &Recording) {
    let radii: Vec<f64> = recording.header.agents.iter().map(|agent| agent.radius_m).collect();
    for tick in 0..recording.ticks() {
        let states = recording.tick(tick);
        for (i, a) in states.iter().enumerate() {
            assert!(a.speed() <= 2.0, "{} m/s at tick {tick}", a.speed());
            for (j, b) in states.iter().enumerate().skip(i + 1) {
                let surface = (a.point() - b.point()).norm() - radii[i] - radii[j];
                assert!(surface > -0.02, "{} and {} overlap by {surface} at tick {tick}", a.agent_id(), b.agent_id());
            }
        }
    }
}

fn frontal() -> Setup {
    setup(
        corridor(),
        &["a", "b", "c", "d", "e"],
        &[Cast(Relation::Frontal, &["e", "d", "c", "b", "a"], vec![])],
        &[(1, "c")],
    )
}

#[test]
fn the_same_seed_gives_the_same_hash_and_another_seed_another() {
    let first = run(frontal());
    assert_eq!(first.hash(), run(frontal()).hash());
    let other = run(Setup { seed: 2, ..frontal() });
    assert_ne!(first.hash(), other.hash());
}

#[test]
fn a_frontal_human_meets_the_robot_at_the_node_and_passes_it() {
    let recording = run(frontal());
    nobody_overlaps(&recording);
    let gap = gaps(&recording)[&1];
    assert!(gap.abs() <= 1.5, "gap {gap}");
    assert_eq!(reason(&recording), "done");
    assert!(recording.events.iter().any(|event| event.kind == EventKind::RobotArrived));
    assert!(
        !recording.events.iter().any(|event| matches!(event.kind, EventKind::Contact { .. } | EventKind::Stuck { .. }))
    );
}

#[test]
fn a_robot_that_has_not_set_off_yet_has_not_stopped() {
    let looks = rule(Trigger::RobotStopped, Action::LookAtRobot);
    let cast = [Cast(Relation::Frontal, &["e", "d", "c", "b", "a"], vec![looks])];
    let recording = run(setup(corridor(), &["a", "b", "c", "d", "e"], &cast, &[(1, "c")]));
    let began = |name: &str| -> Vec<f64> {
        let of = |kind: &EventKind| matches!(kind, EventKind::Leaf { leaf, .. } if leaf == name);
        recording.events.iter().filter(|event| of(&event.kind)).map(|event| event.time.secs()).collect()
    };
    let moves = recording.track(AgentId::Robot).position(|state| state.speed() > 0.1).unwrap() as f64 * 0.01;
    assert!(moves > 0.05, "it stands at first");
    let looks = began("LookAtRobot");
    assert!(!looks.is_empty() && looks.iter().all(|t| *t > moves + 1.0), "moves from {moves} s, looks from {looks:?}");
}

#[test]
fn people_who_cross_come_at_the_robots_time_whatever_the_seed() {
    for seed in 1..=8 {
        let cast =
            [Cast(Relation::Crossing, &["n", "m", "s"], vec![]), Cast(Relation::Crossing, &["s", "m", "n"], vec![])];
        let made = setup(crossing(), &["w", "w2", "m", "e2", "e"], &cast, &[(1, "m"), (2, "m")]);
        let recording = run(Setup { seed, ..made });
        nobody_overlaps(&recording);
        let gaps = gaps(&recording);
        assert_eq!(gaps.len(), 2, "seed {seed}");
        assert!(gaps.values().all(|gap| gap.abs() <= 1.5), "seed {seed}: {gaps:?}");
    }
}

#[test]
fn paths_that_never_meet_give_no_encounter() {
    let made = setup(crossing(), &["w", "w2"], &[Cast(Relation::Crossing, &["n", "m", "s"], vec![])], &[(1, "m")]);
    let recording = run(made);
    assert!(gaps(&recording).is_empty());
}

fn car() -> Setup {
    // A lobby and a car behind a door line at x = 16.
    let grid = carve(20.0, 8.0, &[(0.2, 0.2, 15.9, 7.8), (15.8, 3.4, 16.2, 4.6), (16.1, 2.8, 18.6, 5.2)]);
    let mut place = location(
        grid,
        &[
            ("far", 2.0, 4.0),
            ("mid", 8.0, 4.0),
            ("lobby", 13.0, 4.0),
            ("car", 17.0, 4.0),
            ("back", 18.0, 4.0),
            ("out", 12.0, 1.5),
        ],
        &[("far", "mid"), ("mid", "lobby"), ("lobby", "car"), ("car", "back"), ("lobby", "out")],
    );
    place.doors.push(Door {
        id: "elevator".into(),
        kind: DoorKind::Elevator,
        from: Point::new(16.0, 3.3),
        to: Point::new(16.0, 4.7),
        opens: DoorOpens::RobotNear(3.0),
        hold_s: 15.0,
        inside: vec![id("car"), id("back")],
    });
    let startled = rule(Trigger::RobotVisible(6.0), Action::LookAtRobot);
    let cast = [
        Cast(Relation::Leaving, &["car", "lobby", "out"], vec![]),
        Cast(Relation::Leaving, &["car", "lobby", "mid"], vec![]),
        Cast(Relation::Staying, &["back"], vec![startled]),
    ];
    setup(place, &["far", "mid", "lobby"], &cast, &[(1, "lobby"), (2, "lobby"), (3, "lobby")])
}

#[test]
fn the_door_opens_for_the_robot_and_those_who_leave_come_out() {
    let recording = run(car());
    let start = recording.tick(0);
    for human in &start[1..] {
        assert!(human.x > 16.28, "{} starts at {}", human.agent_id(), human.x);
        for other in &start[1..] {
            assert!(human.agent == other.agent || (human.point() - other.point()).norm() >= 0.6);
        }
    }
    let opened =
        recording.events.iter().find(|event| matches!(event.kind, EventKind::Door { open: true, .. })).unwrap();
    let robot = recording.tick(usize::try_from(opened.time.tick()).unwrap())[0];
    assert!((robot.point() - Point::new(16.0, 4.0)).norm() <= 3.1);
    let end = recording.tick(recording.ticks() - 1);
    assert!(end[1].x < 14.0 && end[2].x < 14.0, "leavers end at {} and {}", end[1].x, end[2].x);
    assert!(end[3].x > 16.28, "the third stays inside");
    nobody_overlaps(&recording);
}

#[test]
fn nobody_sees_through_a_closed_door() {
    let recording = run(car());
    let opened = recording.events.iter().find(|event| matches!(event.kind, EventKind::Door { .. })).unwrap().time;
    let seen = recording.events.iter().find(|event| matches!(event.kind, EventKind::Sees { .. })).unwrap().time;
    assert!(seen >= opened, "seen at {seen}, opened at {opened}");
}

#[test]
fn a_standing_group_keeps_its_circle_while_the_robot_comes() {
    let grid = hall(24.0, 8.0);
    let place = location(grid, &[("a", 2.0, 4.0), ("b", 12.0, 4.0), ("c", 22.0, 4.0)], &[("a", "b"), ("b", "c")]);
    let cast: Vec<Cast<'_>> = (0..4).map(|_| Cast(Relation::Static, &["b"], vec![])).collect();
    let mut made = setup(place, &["a", "b", "c"], &cast, &[(1, "b"), (2, "b"), (3, "b"), (4, "b")]);
    let members: Vec<HumanId> = (1..=4).map(HumanId::new).collect();
    for human in &mut made.proposal.humans {
        human.group = Some(GroupId(1));
    }
    made.proposal.groups = vec![GroupProposal { id: GroupId(1), members, standing: true }];
    made.duration_s = Some(20.0);
    let recording = run(made);
    for tick in [0, 400, 1500] {
        let people = &recording.tick(tick)[1..];
        let center = people.iter().fold(Point::origin(), |sum, state| sum + state.point().coords / 4.0);
        assert!((center.y - 4.0).abs() <= 1.5 && (center.x - 12.0).abs() < 2.0);
        for state in people {
            assert!((state.point() - center).norm() <= 1.5);
            let toward = center - state.point();
            let turn = socrates_model::geometry::wrap_angle(libm::atan2(toward.y, toward.x) - state.yaw);
            assert!(turn.abs() < 0.8, "looks away by {turn}");
            let nearest = people
                .iter()
                .filter(|o| o.agent != state.agent)
                .map(|o| (o.point() - state.point()).norm())
                .fold(9.0, f64::min);
            assert!((0.8..=1.4).contains(&nearest), "nearest neighbor at {nearest}");
        }
    }
}

#[test]
fn a_follower_keeps_its_gap_behind_the_robot() {
    let follow = rule(Trigger::RobotNear(8.0), Action::FollowRobot);
    let made = setup(
        corridor(),
        &["a", "b", "c", "d", "e"],
        &[Cast(Relation::Behind, &["a", "b", "c", "d", "e"], vec![follow])],
        &[],
    );
    let recording = run(made);
    nobody_overlaps(&recording);
    let held = (800..2800).filter(|tick| {
        let states = recording.tick(*tick);
        states.len() == 2 && (0.8..=2.5).contains(&(states[0].x - states[1].x))
    });
    assert!(held.count() > 1500);
}

#[test]
fn somebody_frightened_gets_away_and_somebody_kind_gives_way() {
    let flee = socrates_model::Rule { latched: true, ..rule(Trigger::RobotVisible(5.0), Action::RunAway) };
    let made = setup(
        crossing(),
        &["w", "w2", "m", "e2", "e"],
        &[Cast(Relation::Frontal, &["e", "e2", "m", "w2"], vec![flee])],
        &[(1, "m")],
    );
    let recording = run(made);
    nobody_overlaps(&recording);
    let seen = recording
        .events
        .iter()
        .find(|event| matches!(&event.kind, EventKind::Leaf { leaf, .. } if leaf == "RunAwayFromRobot"));
    let from = usize::try_from(seen.unwrap().time.tick()).unwrap();
    let apart = |tick: usize| (recording.tick(tick)[0].point() - recording.tick(tick)[1].point()).norm();
    assert!(apart(from + 500) > apart(from) + 1.5, "{} then {}", apart(from), apart(from + 500));

    let polite = rule(Trigger::RobotVisible(5.0), Action::GiveWay);
    let recording = run(setup(
        corridor(),
        &["a", "b", "c", "d", "e"],
        &[Cast(Relation::Frontal, &["e", "d", "c", "b", "a"], vec![polite])],
        &[(1, "c")],
    ));
    nobody_overlaps(&recording);
    let passing = (0..recording.ticks()).min_by(|a, b| {
        let x = |tick: &usize| (recording.tick(*tick)[0].x - recording.tick(*tick)[1].x).abs();
        x(a).total_cmp(&x(b))
    });
    let states = recording.tick(passing.unwrap());
    assert!((states[0].y - states[1].y).abs() >= 0.7, "{} beside", (states[0].y - states[1].y).abs());
}

#[test]
fn a_blocker_stands_in_the_robots_line() {
    let block =
        socrates_model::Rule { for_s: Some(8.0), latched: true, ..rule(Trigger::RobotVisible(6.0), Action::Block) };
    let made = setup(
        corridor(),
        &["a", "b", "c", "d", "e"],
        &[Cast(Relation::Frontal, &["e", "d", "c", "b", "a"], vec![block])],
        &[(1, "c")],
    );
    let recording = run(made);
    nobody_overlaps(&recording);
    let blocked = (0..recording.ticks()).filter(|tick| {
        let states = recording.tick(*tick);
        let way = states[1].point() - states[0].point();
        (0.5..2.5).contains(&way.x) && way.y.abs() < 0.6
    });
    assert!(blocked.count() > 400);
}

#[test]
fn without_a_robot_people_walk_to_their_goals() {
    let made = Setup { planner: "none".parse().unwrap(), ..frontal() };
    let recording = Engine::new(made).unwrap().run(None, &mut |_, _| {});
    assert_eq!(recording.header.agents.len(), 1);
    let last = recording.track(AgentId::from_number(1)).last().unwrap();
    assert!((last.x - 2.0).abs() < 0.6, "ends at {}", last.x);
}

#[test]
fn a_path_with_an_unknown_node_is_refused_with_its_name() {
    let mut made = frontal();
    made.paths.robot.push(id("nowhere"));
    made.behaviors.humans.clear();
    let faults = Engine::new(made).unwrap_err();
    assert!(faults.iter().any(|fault| fault.message.to_string().contains("`nowhere`")));
    assert!(faults.iter().any(|fault| fault.code == socrates_model::FaultCode::BAgents));
}

#[test]
fn sixty_seconds_with_three_people_are_recorded_tick_by_tick() {
    let mut made = car();
    made.duration_s = Some(60.0);
    let mut ticks = 0_u64;
    let mut driver = Liner::of(&made);
    let recording = Engine::new(made).unwrap().run(Some(&mut driver), &mut |states, _| {
        assert!(states.iter().all(|state| state.tick == ticks));
        ticks += 1;
    });
    assert_eq!(ticks, 6001);
    assert_eq!(recording.ticks(), 6001);
    assert_eq!(reason(&recording), "time");
}

#[test]
fn whoever_stands_within_open_floor_is_seen() {
    let mut dice = 3_u64;
    let mut share = || {
        dice = dice.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        f64::from(u32::try_from(dice >> 32).unwrap()) / f64::from(u32::MAX)
    };
    for name in socrates_maps::shipped::names() {
        let location = socrates_maps::shipped::load(name).unwrap();
        let mut floor = crate::Floor::new(&location.grid);
        floor.close(location.doors.iter().map(|door| (door.from, door.to)).collect());
        let (corner, grid) = (location.grid.origin.point(), &location.grid);
        let size = |cells: usize| f64::from(u32::try_from(cells).unwrap()) * grid.resolution_m;
        let mut tried = 0;
        for _ in 0..20_000 {
            let a = corner + Vector::new(share() * size(grid.width), share() * size(grid.height));
            let open_m = floor.open_of(floor.clearance_m(&a));
            if open_m <= 0.0 {
                continue;
            }
            let angle = share() * std::f64::consts::TAU;
            let b = a + Vector::new(libm::cos(angle), libm::sin(angle)) * (open_m * share());
            assert!(floor.sees(&a, &b), "{name}: {a} does not see {b} though {open_m} m are open");
            tried += 1;
        }
        assert!(tried > 1000, "{name}: {tried}");
    }
}
