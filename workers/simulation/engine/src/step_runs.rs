//! Runs in which people do one thing after the other.

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
    let said = |gesture| time(&recording, &EventKind::Gesture { agent: AgentId::Human(guard), gesture: Some(gesture) });
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
