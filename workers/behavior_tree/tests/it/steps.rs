//! Sequences of steps: each begins when the one before has ended and its own triggers hold.

use crate::common::Room;
use socrates_bt::{Tree, compile};
use socrates_model::{Action, Gesture, HumanId, Rule, Trigger};

fn me() -> HumanId {
    HumanId::new(1)
}

fn step(number: u32, when: &[Trigger], act: Action) -> Rule {
    let mut all = if number > 1 { vec![Trigger::Did(me(), number - 1)] } else { Vec::new() };
    all.extend_from_slice(when);
    Rule { when: all, act, latched: true, step: Some(number), ..Rule::default() }
}

fn tree(rules: &[Rule]) -> Tree {
    let xml = compile(me(), rules).unwrap_or_else(|faults| panic!("{faults:#?}"));
    Tree::parse(&xml).unwrap()
}

#[test]
fn a_step_waits_for_its_own_reason_and_people_walk_on_until_then() {
    let visitor = HumanId::new(2);
    let rules = [
        Rule {
            for_s: Some(1.0),
            gesture: Some(Gesture::Wait),
            ..step(1, &[Trigger::RobotNear(4.0)], Action::StandStill)
        },
        Rule {
            for_s: Some(1.0),
            gesture: Some(Gesture::Proceed),
            ..step(2, &[Trigger::Done(visitor)], Action::StandStill)
        },
        Rule { until: vec![Trigger::RobotPassed], ..step(3, &[], Action::GiveWay) },
    ];
    let tree = tree(&rules);
    let mut state = tree.start();
    let mut room = Room { distance_m: Some(9.0), moving: true, ..Room::default() };
    assert_eq!(room.tick(&tree, &mut state), [Action::Navigate]);
    room.done.push(visitor);
    assert_eq!(room.tick(&tree, &mut state), [Action::Navigate], "the second step comes before the first");
    room.done.clear();
    room.distance_m = Some(3.0);
    assert_eq!(room.tick(&tree, &mut state), [Action::StandStill]);
    assert_eq!(room.gesture, Some(Gesture::Wait));
    room.distance_m = Some(9.0);
    for _ in 0..300 {
        room.tick(&tree, &mut state);
    }
    assert_eq!(room.acts, [Action::Navigate], "between two steps they walk on");
    assert_eq!((room.gesture, room.ended[&me()]), (None, 1));
    room.done.push(visitor);
    assert_eq!(room.tick(&tree, &mut state), [Action::StandStill]);
    assert_eq!(room.gesture, Some(Gesture::Proceed));
    room.done.clear();
    for _ in 0..300 {
        room.tick(&tree, &mut state);
    }
    assert_eq!((room.acts.as_slice(), room.ended[&me()]), (&[Action::GiveWay][..], 2));
}

#[test]
fn a_step_ends_with_what_ends_it_and_never_begins_again() {
    let proceed = Trigger::RobotSays(Gesture::Proceed);
    let rules = [
        Rule { until: vec![proceed, Trigger::RobotMoving], ..step(1, &[Trigger::RobotNear(4.0)], Action::StandStill) },
        Rule { for_s: Some(0.5), ..step(2, &[], Action::LookAtRobot) },
    ];
    let tree = tree(&rules);
    let mut state = tree.start();
    let mut room = Room { distance_m: Some(3.0), ..Room::default() };
    for _ in 0..500 {
        assert_eq!(room.tick(&tree, &mut state), [Action::StandStill]);
    }
    room.robot_says = Some(Gesture::Proceed);
    assert_eq!(room.tick(&tree, &mut state), [Action::StandStill], "only one of two triggers holds");
    room.moving = true;
    assert_eq!(room.tick(&tree, &mut state), [Action::LookAtRobot], "the next begins in the tick in which one ends");
    room.robot_says = None;
    for _ in 0..100 {
        room.tick(&tree, &mut state);
    }
    assert_eq!(room.acts, [Action::Navigate]);
    assert_eq!(room.ended[&me()], 2);
}

#[test]
fn a_reaction_interrupts_a_step_which_goes_on_where_it_was() {
    let flees = Rule { when: vec![Trigger::RobotNear(1.0)], act: Action::RunAway, ..Rule::default() };
    let rules = [flees, Rule { for_s: Some(2.0), ..step(1, &[], Action::StandStill) }];
    let tree = tree(&rules);
    let mut state = tree.start();
    let mut room = Room { distance_m: Some(5.0), ..Room::default() };
    let mut stood = 0;
    for tick in 0..1000 {
        room.distance_m = Some(if (50..350).contains(&tick) { 0.5 } else { 5.0 });
        stood += usize::from(room.tick(&tree, &mut state) == [Action::StandStill]);
    }
    assert_eq!(stood, 199);
}

#[test]
fn twelve_steps_are_a_tree_without_faults() {
    let when = [Trigger::RobotNear(4.0), Trigger::StoppedFor(2.0), Trigger::RobotVisible(6.0)];
    let acts = [Action::StandStill, Action::LookAtRobot, Action::GiveWay, Action::Block];
    let rules: Vec<Rule> = (1..=12)
        .zip(when.iter().cycle())
        .zip(acts.iter().cycle())
        .map(|((number, when), act)| Rule {
            for_s: Some(f64::from(number)),
            ..step(number, std::slice::from_ref(when), act.clone())
        })
        .collect();
    assert_eq!(tree(&rules).actions().len(), 5);
}
