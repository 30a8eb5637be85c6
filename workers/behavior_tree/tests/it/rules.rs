//! Rule lists become trees that do what the rules say.

use crate::common::Room;
use socrates_bt::{Library, Tree, compile, describe};
use socrates_model::{Action, FaultCode, Gesture, HumanId, Rule, Trigger};

fn rule(when: &[Trigger], act: Action) -> Rule {
    Rule { when: when.to_vec(), act, gesture: None, for_s: None, latched: false, ..Rule::default() }
}

fn me() -> HumanId {
    HumanId::new(1)
}

fn tree(rules: &[Rule]) -> Tree {
    let xml = compile(me(), rules).unwrap_or_else(|faults| panic!("{faults:#?}"));
    Tree::parse(&xml).unwrap()
}

fn seen(m: f64) -> Room {
    Room { distance_m: Some(m), visible: true, moving: true, ..Room::default() }
}

#[test]
fn every_trigger_and_every_action_gives_a_tree_without_faults() {
    let triggers = [
        Trigger::Always,
        Trigger::RobotVisible(5.0),
        Trigger::RobotNear(1.5),
        Trigger::RobotBlocking(2.0),
        Trigger::RobotMoving,
        Trigger::RobotStopped,
        Trigger::RobotSays(Gesture::ExcuseMe),
        Trigger::HumanSays(HumanId::new(2), Gesture::FollowMe),
        Trigger::GoalReached,
        Trigger::AtEncounter,
        Trigger::AfterSecs(12.5),
        Trigger::StoppedFor(3.0),
        Trigger::Did(HumanId::new(2), 1),
        Trigger::Done(HumanId::new(2)),
    ];
    let actions = [
        Action::Navigate,
        Action::FollowRobot,
        Action::FollowHuman(HumanId::new(2)),
        Action::RunAway,
        Action::GiveWay,
        Action::Block,
        Action::LookAtRobot,
        Action::Approach,
        Action::StandStill,
    ];
    for trigger in &triggers {
        for action in &actions {
            for for_s in [None, Some(4.0)] {
                for latched in [false, true] {
                    for gesture in [None, Some(Gesture::Wait)] {
                        let rules = [Rule {
                            when: vec![trigger.clone()],
                            act: action.clone(),
                            gesture,
                            for_s,
                            latched,
                            ..Rule::default()
                        }];
                        let tree = tree(&rules);
                        assert!(tree.actions().contains(action));
                    }
                }
            }
        }
    }
}

#[test]
fn without_rules_a_human_walks_and_takes_the_next_goal() {
    let tree = tree(&[]);
    let mut state = tree.start();
    let mut room = Room::default();
    assert_eq!(room.tick(&tree, &mut state), [Action::Navigate]);
    let leaf = room.leaves[0];
    assert_eq!(tree.leaf_names()[usize::from(leaf) - 1], "RegularNav");
    room.at_goal = true;
    assert!(room.tick(&tree, &mut state).is_empty());
    assert_eq!(room.goals_taken, 1);
}

#[test]
fn an_earlier_rule_wins() {
    let tree = tree(&[
        rule(&[Trigger::RobotNear(2.0)], Action::RunAway),
        rule(&[Trigger::RobotVisible(6.0)], Action::LookAtRobot),
    ]);
    let mut state = tree.start();
    assert_eq!(seen(1.0).tick(&tree, &mut state), [Action::RunAway]);
    assert_eq!(seen(4.0).tick(&tree, &mut state), [Action::LookAtRobot]);
    assert_eq!(seen(9.0).tick(&tree, &mut state), [Action::Navigate]);
}

#[test]
fn all_triggers_of_a_rule_must_hold() {
    let tree = tree(&[rule(&[Trigger::RobotVisible(6.0), Trigger::RobotStopped], Action::Approach)]);
    let mut state = tree.start();
    let mut room = seen(3.0);
    assert_eq!(room.tick(&tree, &mut state), [Action::Navigate]);
    room.moving = false;
    assert_eq!(room.tick(&tree, &mut state), [Action::Approach]);
}

#[test]
fn the_time_of_a_rule_counts_only_while_it_is_done() {
    let tree = tree(&[Rule { for_s: Some(2.0), ..rule(&[Trigger::RobotVisible(6.0)], Action::LookAtRobot) }]);
    let mut state = tree.start();
    let mut room = seen(3.0);
    let mut looks = 0;
    for tick in 0..1000 {
        // Out of sight half of the time.
        room.visible = tick % 2 == 0;
        looks += usize::from(room.tick(&tree, &mut state) == [Action::LookAtRobot]);
    }
    // The tick in which two seconds are full is the first one without it.
    assert_eq!(looks, 199);
}

#[test]
fn a_latched_rule_goes_on_until_its_time_is_over() {
    let rules = [Rule {
        for_s: Some(3.0),
        latched: true,
        gesture: Some(Gesture::Wait),
        ..rule(&[Trigger::RobotNear(2.0)], Action::Block)
    }];
    let tree = tree(&rules);
    let mut state = tree.start();
    let mut room = seen(1.0);
    assert_eq!(room.tick(&tree, &mut state), [Action::Block]);
    assert_eq!(room.gesture, Some(Gesture::Wait));
    room.distance_m = Some(10.0);
    let mut blocks = 0;
    for _ in 0..1000 {
        let acts = room.tick(&tree, &mut state);
        assert_eq!(acts.len(), 1);
        blocks += usize::from(acts == [Action::Block]);
    }
    assert_eq!(blocks, 298);
    assert_eq!(room.gesture, None, "the gesture was not taken back");
    room.distance_m = Some(1.0);
    assert_eq!(room.tick(&tree, &mut state), [Action::Navigate], "a rule whose time is over starts again");
}

#[test]
fn a_latch_does_not_hold_before_its_trigger() {
    let tree = tree(&[Rule { latched: true, ..rule(&[Trigger::RobotSays(Gesture::FollowMe)], Action::FollowRobot) }]);
    let mut state = tree.start();
    let mut room = seen(3.0);
    assert_eq!(room.tick(&tree, &mut state), [Action::Navigate]);
    room.robot_says = Some(Gesture::FollowMe);
    assert_eq!(room.tick(&tree, &mut state), [Action::FollowRobot]);
    room.robot_says = None;
    assert_eq!(room.tick(&tree, &mut state), [Action::FollowRobot]);
}

#[test]
fn two_rules_that_wait_for_one_word_follow_each_other() {
    let said = [Trigger::RobotSays(Gesture::ExcuseMe)];
    let rules = [
        Rule { latched: true, for_s: Some(4.0), ..rule(&said, Action::LookAtRobot) },
        Rule { latched: true, for_s: Some(6.0), ..rule(&said, Action::GiveWay) },
        Rule { latched: true, for_s: Some(3.0), ..rule(&[Trigger::RobotSays(Gesture::FollowMe)], Action::FollowRobot) },
    ];
    let tree = tree(&rules);
    let mut state = tree.start();
    let mut room = seen(3.0);
    assert_eq!(room.tick(&tree, &mut state), [Action::Navigate]);
    let mut done = Vec::new();
    for tick in 0..1200 {
        // The gesture lasts two seconds; it is over when the first of the two has run.
        room.robot_says = if tick < 200 { Some(Gesture::ExcuseMe) } else { None };
        let acts = room.tick(&tree, &mut state);
        if done.last() != acts.first() {
            done.extend(acts);
        }
    }
    assert_eq!(done, [Action::LookAtRobot, Action::GiveWay, Action::Navigate]);
    let mut other = tree.start();
    room.robot_says = None;
    assert_eq!(room.tick(&tree, &mut other), [Action::Navigate], "another agent has heard nothing");
}

#[test]
fn two_agents_share_a_tree_but_no_memory() {
    let tree = tree(&[Rule { latched: true, ..rule(&[Trigger::AtEncounter], Action::StandStill) }]);
    let (mut one, mut other) = (tree.start(), tree.start());
    let mut there = Room { at_encounter: true, ..Room::default() };
    assert_eq!(there.tick(&tree, &mut one), [Action::StandStill]);
    assert_eq!(Room::default().tick(&tree, &mut other), [Action::Navigate]);
}

#[test]
fn a_rule_that_an_earlier_one_covers_is_refused() {
    let covered =
        [rule(&[Trigger::RobotNear(5.0)], Action::LookAtRobot), rule(&[Trigger::RobotNear(2.0)], Action::RunAway)];
    let faults = compile(me(), &covered).unwrap_err();
    assert!(faults.iter().any(|fault| fault.code == FaultCode::BDead), "{faults:?}");
    let after_always = [rule(&[], Action::StandStill), rule(&[Trigger::RobotNear(2.0)], Action::RunAway)];
    assert!(compile(me(), &after_always).is_err());
    let impossible = [rule(&[Trigger::RobotMoving, Trigger::RobotStopped], Action::RunAway)];
    assert!(compile(me(), &impossible).is_err());
}

#[test]
fn two_motions_for_one_trigger_are_refused_unless_the_first_ends() {
    let mut rules = [
        rule(&[Trigger::RobotVisible(5.0)], Action::LookAtRobot),
        rule(&[Trigger::RobotVisible(5.0)], Action::FollowRobot),
    ];
    let faults = compile(me(), &rules).unwrap_err();
    assert!(faults.iter().any(|fault| fault.code == FaultCode::BContra), "{faults:?}");
    rules[0].for_s = Some(5.0);
    compile(me(), &rules).expect("look for 5 s, then follow");
}

#[test]
fn values_out_of_range_are_refused_all_at_once() {
    let rules = [
        rule(&[Trigger::RobotNear(0.0)], Action::LookAtRobot),
        Rule { for_s: Some(f64::NAN), ..rule(&[Trigger::RobotVisible(99.0)], Action::FollowHuman(me())) },
        rule(&[Trigger::HumanSays(me(), Gesture::Wait)], Action::RunAway),
    ];
    let faults = compile(me(), &rules).unwrap_err();
    assert_eq!(faults.iter().filter(|fault| fault.code == FaultCode::BRange).count(), 5, "{faults:?}");
}

#[test]
fn many_rules_are_still_checked() {
    let mut rules = Vec::new();
    for k in 0..8 {
        let when = [Trigger::RobotNear(1.0 + f64::from(k)), Trigger::AfterSecs(300.0 - 10.0 * f64::from(k))];
        rules.push(Rule { for_s: Some(2.0), gesture: Some(Gesture::Wait), ..rule(&when, Action::LookAtRobot) });
    }
    tree(&rules);
}

#[test]
fn a_tree_of_common_reactions_loads_in_the_fork() {
    let plain = tree(&[
        rule(&[Trigger::RobotVisible(4.0), Trigger::RobotMoving], Action::GiveWay),
        Rule { for_s: Some(5.0), ..rule(&[Trigger::RobotVisible(5.0)], Action::LookAtRobot) },
    ]);
    assert!(plain.foreign_to(Library::SocratesFork).is_empty());
    let native = tree(&[Rule { latched: true, ..rule(&[Trigger::AtEncounter], Action::Approach) }]);
    assert_eq!(native.foreign_to(Library::SocratesFork), ["ApproachRobot", "IsAtEncounter", "Latch"]);
}

#[test]
fn the_rules_are_told_in_words() {
    let rules = [Rule {
        for_s: Some(5.0),
        gesture: Some(Gesture::Wait),
        ..rule(&[Trigger::RobotVisible(5.0)], Action::LookAtRobot)
    }];
    assert_eq!(
        describe(me(), &rules),
        "When they see the robot within 5 m, human_1 stops and looks at the robot and says WAIT for 5 s. \
         Otherwise they walk along their path."
    );
}

#[test]
fn a_tree_written_in_version_4_does_the_same() {
    let tree = tree(&[
        Rule { gesture: Some(Gesture::Wait), ..rule(&[Trigger::RobotNear(2.0)], Action::RunAway) },
        Rule { latched: true, for_s: Some(1.0), ..rule(&[Trigger::AtEncounter], Action::LookAtRobot) },
    ]);
    let copy = Tree::parse(&tree.to_xml(socrates_bt::Format::V4)).unwrap();
    assert_eq!(copy.format(), socrates_bt::Format::V4);
    let (mut a, mut b) = (tree.start(), copy.start());
    let (mut room_a, mut room_b) = (seen(9.0), seen(9.0));
    for tick in 0..600_u32 {
        for room in [&mut room_a, &mut room_b] {
            room.distance_m = Some(if tick % 90 < 20 { 1.0 } else { 9.0 });
            room.at_encounter = tick == 100;
        }
        assert_eq!(room_a.tick(&tree, &mut a), room_b.tick(&copy, &mut b), "tick {tick}");
        assert_eq!(room_a.gesture, room_b.gesture, "tick {tick}");
    }
}
