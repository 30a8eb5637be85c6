//! Requests that say who comes before whom, who is excepted, and amounts that name nobody or cannot be played.

use socrates_model::{Action, AgentId, FactKind, HumanId, Predicate, Reading, Relation, Trigger};

use crate::read;
use crate::tests::{map, proposed, request};

fn told(rough: &str) -> Reading {
    read(&request("Drive along the corridor", Some(rough)), &map("office"))
}

/// Pairs of agents, the first of whom is there before the second; 0 is the robot.
fn order(reading: &Reading) -> Vec<(u32, u32)> {
    let number = |agent: &AgentId| if let AgentId::Human(id) = agent { id.number() } else { 0 };
    let of = |kind: &FactKind| {
        if let FactKind::Before { first, then, .. } = kind { Some((number(first), number(then))) } else { None }
    };
    reading.facts.iter().filter_map(|fact| of(&fact.kind)).collect()
}

/// How many do something by a rule.
fn doing(reading: &Reading, act: &Action) -> Vec<u32> {
    let does = |rules: &[socrates_model::Rule]| rules.iter().any(|rule| rule.act == *act);
    reading.humans.iter().filter(|human| does(&human.rules)).map(|human| human.id.number()).collect()
}

#[test]
fn who_comes_first_is_read_and_demanded() {
    for (rough, wanted) in [
        ("First a nurse crosses, then a doctor crosses.", vec![(1, 2)]),
        ("After the nurse has crossed, a doctor crosses.", vec![(1, 2)]),
        ("First a visitor crosses, then an employee crosses, then a cleaner.", vec![(1, 2), (2, 3)]),
        ("A man crosses behind the robot after it has passed.", vec![(0, 1)]),
        ("A nurse and a doctor cross.", vec![]),
        ("When a nurse crosses, a doctor comes towards the robot.", vec![]),
    ] {
        let reading = told(rough);
        assert_eq!(order(&reading), wanted, "{rough}");
        let asked = request("Drive along the corridor", Some(rough));
        let proposal = proposed(&asked, &map("office"));
        let clauses: Vec<(u32, u32)> = proposal
            .expected_events
            .iter()
            .filter(|clause| clause.must)
            .filter_map(|clause| {
                let Predicate::Before { first, then, .. } = &clause.predicate else { return None };
                let number = |agent: &AgentId| if let AgentId::Human(id) = agent { id.number() } else { 0 };
                Some((number(first), number(then)))
            })
            .collect();
        assert_eq!(clauses, wanted, "{rough}");
    }
}

#[test]
fn until_the_robot_has_passed_is_until_then() {
    let reading = told("A visitor waits until the robot has passed and then walks on.");
    let rules = &reading.humans[0].rules;
    assert_eq!((&rules[0].when[..], &rules[0].act), (&[Trigger::RobotPassed][..], &Action::Navigate));
    assert_eq!(rules[1].act, Action::StandStill);
    let reading = told("Once the robot has passed, a visitor follows it.");
    let rule = &reading.humans[0].rules[0];
    assert_eq!((&rule.when[..], &rule.act), (&[Trigger::RobotPassed][..], &Action::FollowRobot));
    assert_ne!(reading.humans[0].relation, Some(Relation::Behind), "it comes from somewhere else before");
}

#[test]
fn exceptions_leave_out_who_is_excepted() {
    let reading = told("A nurse and two doctors walk towards the robot. Everybody except the nurse stops.");
    assert_eq!((reading.humans.len(), doing(&reading, &Action::StandStill)), (3, vec![2, 3]));
}

#[test]
fn numbers_that_name_somebody_count_nobody() {
    for (rough, humans) in [
        ("Employee 42 talks with employee 17.", 2),
        ("Patient 12 waits in the corridor.", 1),
        ("Nurse number 9 crosses the corridor.", 1),
        ("A patient aged 30 crosses the corridor.", 1),
        ("Employee 7 follows employee 13.", 2),
        ("On 14 March two visitors cross the corridor.", 2),
        ("Human 2 follows human 1.", 2),
    ] {
        assert_eq!(told(rough).humans.len(), humans, "{rough}");
    }
    let reading = told("Employee 7 follows employee 13.");
    assert_eq!(reading.humans[0].rules[0].act, Action::FollowHuman(HumanId::new(2)));
}

#[test]
fn what_hands_do_is_said_not_to_be_played() {
    for rough in ["A woman hands the robot a letter.", "A patient collapses in the corridor."] {
        assert!(!told(rough).missing().is_empty(), "{rough}");
    }
    for rough in ["Two visitors walk hand in hand.", "A visitor raises his hand."] {
        assert!(told(rough).problems.is_empty(), "{rough}");
    }
}
