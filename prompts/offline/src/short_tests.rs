//! Requests of which a part is not played, and times that count from what was told before.

use socrates_model::{Action, AgentId, FactKind, FaultCode, Gesture, Reading, Relation, Rule, Trigger};

use crate::read;
use crate::tests::{map, request};

fn told(rough: &str) -> Reading {
    read(&request("Drive along the corridor", Some(rough)), &map("office"))
}

/// What the reading says is not played.
fn unplayed(reading: &Reading) -> String {
    let wish = reading.problems.iter().filter(|fault| fault.code == FaultCode::PRead);
    wish.map(|fault| fault.message.to_string()).collect::<Vec<_>>().join("\n")
}

fn rule(reading: &Reading, act: &Action) -> Rule {
    let mut rules = reading.humans.iter().flat_map(|human| &human.rules);
    rules.find(|rule| rule.act == *act).unwrap_or_else(|| panic!("no {act:?} in {reading:#?}")).clone()
}

#[test]
fn a_way_of_walking_that_is_not_played_is_said() {
    for (rough, words) in [
        ("A visitor walks up and down in the corridor.", "walks up and down"),
        ("A cleaner wanders back and forth along the corridor.", "wanders back and forth"),
        ("A person comes out of the meeting room, sees the robot and goes back into the room.", "goes back"),
        ("A nurse overtakes the robot, turns around and comes back towards it.", "comes back"),
        ("A nurse walks up to a patient who stands in the corridor.", "walks up to a patient"),
        ("A colleague follows the robot but keeps at least three metres away from it.", "3 m"),
        ("An employee follows the robot at a distance of four metres.", "4 m"),
        ("One after another, four people follow the robot.", "one does it after the other"),
        ("When it says excuse me, three workers step aside one by one.", "one does it after the other"),
    ] {
        let found = unplayed(&told(rough));
        assert!(found.contains(words), "{rough}\n{found}");
    }
    for rough in [
        "A visitor walks through the corridor.",
        "A visitor walks up to the robot.",
        "A nurse lets the robot pass and goes back to her copies.",
        "A worker steps back to let the robot pass.",
        "The robot turns back.",
        "An employee follows the robot at 1.5 m.",
        "A nurse goes to her room.",
        "Three visitors leave the meeting room one after the other.",
    ] {
        assert_eq!(unplayed(&told(rough)), "", "{rough}");
    }
}

#[test]
fn of_two_ways_to_stand_to_the_robot_one_is_played_and_the_other_said() {
    let found = told("A man overtakes the robot, comes back and follows it.");
    assert!(unplayed(&found).contains("follows it afterwards"), "{found:#?}");
    let beside = told("The older child walks past the robot from behind and then walks next to it.");
    assert!(unplayed(&beside).contains("walks next to it"), "{beside:#?}");
    assert!(!beside.humans.first().unwrap().summary.contains("beside"), "{beside:#?}");
    let same = told("A worker walks in the same direction as the robot, next to it.");
    assert_eq!(same.humans.first().unwrap().relation, Some(Relation::Abreast));
    assert_eq!(unplayed(&same), "");
    // Without a word for one after the other it cannot be.
    let both = told("A man comes towards the robot and walks ahead of it.");
    assert!(both.problems.iter().any(|fault| fault.code == FaultCode::PContra), "{both:#?}");
}

#[test]
fn seconds_count_from_what_was_told_before() {
    let blocked = told("A worker blocks the corridor. After ten seconds he steps aside.");
    assert_eq!(rule(&blocked, &Action::Block).for_s, Some(10.0));
    assert_eq!(rule(&blocked, &Action::GiveWay).when, rule(&blocked, &Action::Block).when);
    let stopped = told("A nurse stops in front of the robot. Ten seconds later she walks on.");
    assert_eq!(rule(&stopped, &Action::Block).for_s, Some(10.0));
    assert_eq!(rule(&stopped, &Action::Navigate).when, rule(&stopped, &Action::Block).when);
    let signals = told("A guest says wait. After five seconds he says proceed.");
    let said: Vec<(Gesture, Option<f64>)> = signals
        .humans
        .iter()
        .flat_map(|human| &human.rules)
        .filter_map(|rule| Some((rule.gesture?, rule.for_s)))
        .collect();
    assert_eq!(said.first(), Some(&(Gesture::Wait, Some(5.0))), "{signals:#?}");
    assert_eq!(said.last().map(|(gesture, _)| *gesture), Some(Gesture::Proceed));
    // Whoever only stands there has done nothing yet: the clock starts with the run.
    let stands = told("A cleaner stands in the doorway and moves aside after ten seconds.");
    assert_eq!(rule(&stands, &Action::GiveWay).when, [Trigger::AfterSecs(10.0)]);
}

#[test]
fn who_answers_the_robot_answers_its_word_and_who_runs_to_it_comes_up_to_it() {
    let answers = told("The robot says excuse me. A worker who blocks the corridor answers that it may proceed.");
    let gesture = answers.humans.iter().flat_map(|human| &human.rules).find(|rule| rule.gesture.is_some()).unwrap();
    assert_eq!(gesture.when, [Trigger::RobotSays(Gesture::ExcuseMe)], "{answers:#?}");
    let runs = told("A mother and her child walk in the corridor. When the child sees the robot, it runs to it.");
    assert_eq!(rule(&runs, &Action::Approach).gesture, None);
    assert!(runs.humans.first().unwrap().rules.is_empty(), "{runs:#?}");
    let away = told(
        "A worker stands in the corridor until the robot has passed, then he walks away in the opposite direction.",
    );
    assert!(away.humans.iter().all(|human| human.rules.iter().all(|rule| rule.act != Action::Approach)), "{away:#?}");
    let trails = told("Participant 1 walks towards the robot. Participant 2 walks 2 m behind participant 1.");
    assert!(trails.humans.iter().flat_map(|human| &human.rules).any(|rule| matches!(rule.act, Action::FollowHuman(_))));
}

#[test]
fn those_who_meet_the_robot_one_after_the_other_are_ordered() {
    let reading = told("Two pickers cross the robot's path, one after the other.");
    let order =
        |kind: &FactKind| matches!(kind, FactKind::Before { first: AgentId::Human(_), then: AgentId::Human(_), .. });
    assert_eq!(reading.facts.iter().filter(|fact| order(&fact.kind)).count(), 1, "{reading:#?}");
}

#[test]
fn a_guard_who_stops_the_robot_with_a_gesture_says_so() {
    let reading = told("A security guard stops the robot with a gesture.");
    assert!(reading.humans.iter().flat_map(|human| &human.rules).any(|rule| rule.gesture == Some(Gesture::Wait)));
}

#[test]
fn what_is_done_only_then_waits_for_that_alone() {
    let only =
        told("A nurse gestures to the robot to wait, and only once the robot has stopped does the doctor look at it.");
    assert_eq!(rule(&only, &Action::LookAtRobot).when, [Trigger::RobotStopped]);
    assert_ne!(rule(&only, &Action::Navigate).when, [Trigger::RobotStopped]);
    let so =
        told("Two workers come towards the robot. The first steps aside; the second does so only when the robot asks.");
    let second = so.humans.get(1).and_then(|human| human.rules.first()).unwrap();
    assert_eq!((&second.act, second.when.as_slice()), (&Action::GiveWay, &[Trigger::RobotSays(Gesture::ExcuseMe)][..]));
}

#[test]
fn who_is_excepted_does_not_do_it() {
    let doing = |rough: &str, act: &Action| -> Vec<u32> {
        let humans = told(rough).humans;
        let does = humans.iter().filter(|human| human.rules.iter().any(|rule| rule.act == *act));
        does.map(|human| human.id.number()).collect()
    };
    for rough in [
        "Four workers come towards the robot. All but the third step aside.",
        "Four workers come towards the robot. All but the third one step aside; the third blocks it.",
        "Six agents are too many for CI, take four. All come towards the robot. All but the third step aside.",
    ] {
        assert_eq!(doing(rough, &Action::GiveWay), [1, 2, 4], "{rough}");
    }
    assert_eq!(doing("Four workers come towards the robot. All but the last step aside.", &Action::GiveWay), [1, 2, 3]);
}

#[test]
fn who_is_nobody_of_the_scene_is_not_counted() {
    for (rough, count) in [
        ("Two, no wait, three visitors come towards the robot.", 3),
        ("Two porters and a doctor – no, sorry, just one porter and the doctor. The porter crosses.", 2),
        ("An earlier draft had four pedestrians in it, but two are enough. They cross the robot's path.", 2),
        ("A visitor walks towards the robot. Twenty raters will watch the videos.", 1),
        ("Children are known to block robots. One child blocks the robot.", 1),
        ("What if a human competes with the robot? A doctor crosses its path.", 1),
        ("Five people stand in a circle, plus one doctor who has nothing to do with them and crosses.", 6),
        ("Mia and Jonas, my two confederates, come towards the robot. Mia steps aside; Jonas blocks it.", 2),
        ("My supervisor wants the student to give way to the robot.", 1),
    ] {
        assert_eq!(told(rough).humans.len(), count, "{rough}");
    }
    let called =
        told("A confederate crosses the robot's path, a bystander stands at the wall. The confederate says wait.");
    assert!(called.humans.first().unwrap().rules.iter().any(|rule| rule.gesture == Some(Gesture::Wait)), "{called:#?}");
}
