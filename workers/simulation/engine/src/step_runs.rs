//! Runs in which people do one thing after the other.

use socrates_model::act::Destination;
use socrates_model::{Action, AgentId, EventKind, Gesture, HumanId, Recording, Relation, Rule, Trigger};

use crate::fixture::{Cast, run, setup};
use crate::tests::{corridor, crossing};

fn step(human: u32, number: u32, when: &[Trigger], act: Action) -> Rule {
    let mut all = if number > 1 { vec![Trigger::Did(HumanId::new(human), number - 1)] } else { Vec::new() };
    all.extend_from_slice(when);
    Rule { when: all, act, latched: true, step: Some(number), ..Rule::default() }
}

fn time(recording: &Recording, kind: &EventKind) -> Option<f64> {
    recording.events.iter().find(|event| event.kind == *kind).map(|event| event.time.secs())
}

#[test]
fn a_guard_stops_the_robot_until_somebody_is_through() {
    let (guard, visitor) = (HumanId::new(1), HumanId::new(2));
    let sign = |number, when: Trigger, gesture| Rule {
        gesture: Some(gesture),
        for_s: Some(1.0),
        ..step(1, number, &[when], Action::StandStill)
    };
    let rules =
        vec![sign(1, Trigger::RobotNear(6.0), Gesture::Wait), sign(2, Trigger::Done(visitor), Gesture::Proceed)];
    let made = setup(
        crossing(),
        &["w", "w2", "m", "e2", "e"],
        &[Cast(Relation::Static, &["m"], rules), Cast(Relation::Crossing, &["s", "m", "n"], Vec::new())],
        &[(1, "m"), (2, "m")],
    );
    let recording = run(made);
    let said = |gesture| {
        time(&recording, &EventKind::Gesture { agent: AgentId::Human(guard), gesture: Some(gesture), to: None })
    };
    let (wait, proceed) = (said(Gesture::Wait), said(Gesture::Proceed));
    assert!(wait.is_some() && proceed > wait, "{wait:?} {proceed:?}");
    let first = time(&recording, &EventKind::StepEnded { human: guard, step: 1 }).unwrap();
    assert!((first - wait.unwrap() - 1.0).abs() < 0.05, "{first}");
    assert!(time(&recording, &EventKind::StepEnded { human: guard, step: 2 }).is_some());
}

#[test]
fn a_step_goes_on_until_the_robot_has_stood_for_a_while() {
    let rules = vec![
        Rule { until: vec![Trigger::StoppedFor(2.0)], ..step(1, 1, &[Trigger::RobotVisible(5.0)], Action::Block) },
        Rule { until: vec![Trigger::RobotPassed], ..step(1, 2, &[], Action::GiveWay) },
    ];
    let made = setup(
        corridor(),
        &["a", "b", "c", "d", "e"],
        &[Cast(Relation::Frontal, &["e", "d", "c", "b", "a"], rules)],
        &[(1, "c")],
    );
    let recording = run(made);
    let human = HumanId::new(1);
    let over = time(&recording, &EventKind::StepEnded { human, step: 1 }).expect("the first step ends");
    let stood = (0..recording.ticks()).filter(|tick| recording.tick(*tick)[0].speed() <= 0.1).count();
    assert!(stood > 200, "{stood}");
    assert!(time(&recording, &EventKind::StepEnded { human, step: 2 }).is_some_and(|t| t > over));
    assert!(time(&recording, &EventKind::RobotArrived).is_some(), "the robot gets past");
}

/// Somebody who comes towards the robot along the corridor and does this at its sight within 6 m.
fn comes(act: Action, more: Rule) -> Recording {
    let rules = vec![Rule { act: act.clone(), ..step(1, 1, &[Trigger::RobotVisible(6.0)], act) }];
    let rules = rules.into_iter().map(|rule| Rule { until: more.until.clone(), for_s: more.for_s, ..rule }).collect();
    run(setup(
        corridor(),
        &["a", "b", "c", "d", "e"],
        &[Cast(Relation::Frontal, &["e", "d", "c", "b", "a"], rules)],
        &[(1, "c")],
    ))
}

fn leaf_s(recording: &Recording, leaf: &str) -> f64 {
    let kind = EventKind::Leaf { human: HumanId::new(1), leaf: leaf.to_owned() };
    time(recording, &kind).unwrap_or_else(|| panic!("{leaf} never runs"))
}

#[test]
fn somebody_turns_back_and_walks_to_where_they_came_from() {
    let recording = comes(Action::TurnBack, Rule { until: vec![Trigger::GoalReached], ..Rule::default() });
    let tick = usize::try_from(
        recording
            .events
            .iter()
            .find(|event| matches!(&event.kind, EventKind::Leaf { leaf, .. } if leaf == "TurnBack"))
            .unwrap()
            .time
            .tick(),
    )
    .unwrap();
    let x = |tick: usize| recording.tick(tick)[1].x;
    assert!(x(0) - x(tick) > 2.0, "they walk towards the robot first");
    assert!((x(recording.ticks() - 1) - x(0)).abs() < 1.0, "{} and {}", x(recording.ticks() - 1), x(0));
    let leaf = usize::from(recording.tick(tick + 1)[1].leaf());
    assert_eq!(recording.header.leaves[leaf], "TurnBack");
    assert!(time(&recording, &EventKind::StepEnded { human: HumanId::new(1), step: 1 }).is_some());
}

#[test]
fn somebody_walks_at_another_pace_from_then_on() {
    let recording = comes(Action::ChangePace(0.5), Rule { for_s: Some(1.0), ..Rule::default() });
    let from = leaf_s(&recording, "ChangePace");
    let speeds: Vec<f64> = (0..recording.ticks())
        .map(|tick| (tick as f64 * 0.01, recording.tick(tick)[1].speed()))
        .filter(|(t, _)| *t > from + 1.5 && *t < from + 4.0)
        .map(|(_, speed)| speed)
        .collect();
    let mean = speeds.iter().sum::<f64>() / speeds.len() as f64;
    assert!((0.3..0.6).contains(&mean), "{mean}");
}

#[test]
fn somebody_goes_to_a_place_and_stays_there() {
    let nodes = vec![crate::fixture::id("d")];
    let go = Action::GoTo(Destination { place: "corridor".into(), nodes });
    let recording = comes(go, Rule { until: vec![Trigger::GoalReached], ..Rule::default() });
    leaf_s(&recording, "GoToPlace");
    let last = recording.tick(recording.ticks() - 1)[1];
    assert!((last.x - 21.0).abs() < 1.0, "{}", last.x);
}

#[test]
fn a_sign_to_one_faces_them_and_is_seen_by_all_who_wait_for_it() {
    let (to, other) = (HumanId::new(2), HumanId::new(3));
    let says = Rule {
        gesture: Some(Gesture::Wait),
        to: Some(AgentId::Human(to)),
        for_s: Some(3.0),
        ..step(1, 1, &[Trigger::AfterSecs(2.0)], Action::LookAt(to))
    };
    let heard = |human| {
        let when = vec![Trigger::HumanSays(HumanId::new(1), Gesture::Wait)];
        let looks = step(human, 1, &[], Action::LookAtRobot);
        Rule { when, latched: true, step: Some(1), for_s: Some(1.0), ..looks }
    };
    let recording = run(setup(
        corridor(),
        &["a", "b", "c", "d", "e"],
        &[
            Cast(Relation::Static, &["c"], vec![says]),
            Cast(Relation::Static, &["d"], vec![heard(2)]),
            Cast(Relation::Static, &["e"], vec![heard(3)]),
        ],
        &[(1, "c")],
    ));
    let wait = Some(Gesture::Wait);
    let made =
        EventKind::Gesture { agent: AgentId::Human(HumanId::new(1)), gesture: wait, to: Some(AgentId::Human(to)) };
    let said = time(&recording, &made).expect("the sign says to whom it is made");
    for human in [to, other] {
        assert!(time(&recording, &EventKind::StepEnded { human, step: 1 }).is_some(), "{human}");
    }
    let at = |t: f64| recording.tick((t * 100.0) as usize);
    let (me, you) = (at(said + 2.0)[1], at(said + 2.0)[2]);
    let off = socrates_model::geometry::wrap_angle(libm::atan2(you.y - me.y, you.x - me.x) - me.yaw);
    assert!(off.abs() < 0.35, "{off}");
}

#[test]
fn somebody_who_has_come_no_way_yet_turns_back_to_where_they_came_from_before() {
    let me = HumanId::new(1);
    let turns =
        Rule { until: vec![Trigger::GoalReached], ..step(1, 1, &[Trigger::RobotVisible(12.0)], Action::TurnBack) };
    let recording = run(setup(
        corridor(),
        &["a", "b", "c", "d"],
        &[Cast(Relation::Frontal, &["c", "b", "a"], vec![turns])],
        &[(1, "b")],
    ));
    let from = leaf_s(&recording, "TurnBack");
    let x = |t: f64| recording.tick((t * 100.0) as usize)[1].x;
    let ended = time(&recording, &EventKind::StepEnded { human: me, step: 1 }).expect("they get there");
    assert!(x(ended) - x(from) > 2.0, "{} to {}", x(from), x(ended));
}

#[test]
fn somebody_whom_something_led_off_their_way_turns_back_as_they_walked() {
    let me = HumanId::new(1);
    let rules = vec![
        Rule { for_s: Some(12.0), ..step(1, 1, &[Trigger::RobotNear(3.0)], Action::FollowRobot) },
        Rule { until: vec![Trigger::GoalReached], ..step(1, 2, &[], Action::TurnBack) },
    ];
    let recording = run(setup(
        crossing(),
        &["w", "w2", "m", "e2", "e"],
        &[Cast(Relation::Crossing, &["s", "m", "n"], rules)],
        &[(1, "m")],
    ));
    let turned = time(&recording, &EventKind::StepEnded { human: me, step: 1 }).expect("they follow");
    let x = |t: f64| recording.tick((t * 100.0) as usize)[1].x;
    assert!(x(turned) > 14.0, "they follow the robot off their way: {}", x(turned));
    assert!(x(turned) - x(turned + 4.0) > 2.0, "{} to {}", x(turned), x(turned + 4.0));
}

#[test]
fn somebody_who_stands_aside_already_gives_way_all_the_same() {
    let away = Rule { until: vec![Trigger::RobotPassed], ..step(1, 1, &[Trigger::RobotNear(3.0)], Action::GiveWay) };
    let hall = crate::fixture::location(
        crate::fixture::carve(30.0, 8.0, &[(0.2, 0.2, 29.8, 7.8)]),
        &[("a", 2.0, 4.0), ("b", 15.0, 4.0), ("s", 15.0, 4.9), ("e", 28.0, 4.0)],
        &[("a", "b"), ("b", "e"), ("b", "s")],
    );
    let recording = run(setup(hall, &["a", "b", "e"], &[Cast(Relation::Static, &["s"], vec![away])], &[(1, "b")]));
    let y = |t: f64| recording.tick((t * 100.0) as usize)[1].y;
    let passed = time(&recording, &EventKind::StepEnded { human: HumanId::new(1), step: 1 }).expect("it passes");
    assert!(y(passed) - y(0.0) > 0.3, "{} to {}", y(0.0), y(passed));
}
