//! The story as the reading that the solver takes.

#![cfg(test)]

use socrates_model::statement::{Became, TextKey};
use socrates_model::{Action, AgentId, FactKind, Gesture, GroupId, HumanId, Reading, Trigger};

fn reading(text: &str) -> Reading {
    socrates_reader::read(text).reading(text, TextKey::RoughScenario)
}

fn id(number: u32) -> HumanId {
    HumanId::new(number)
}

/// The quote of the first fact of a kind.
fn quote<'a>(reading: &'a Reading, kind: &FactKind) -> &'a str {
    &reading.facts.iter().find(|fact| fact.kind == *kind).unwrap_or_else(|| panic!("{kind:?} of {reading:#?}")).quote
}

#[test]
fn people_have_roles_relations_and_groups() {
    let reading = reading("Two nurses walk side by side towards the robot in the corridor.");
    let roles: Vec<&str> = reading.humans.iter().map(|human| human.role.as_str()).collect();
    assert_eq!(roles, ["nurse", "nurse"]);
    assert!(reading.humans.iter().all(|human| human.group == Some(GroupId(1))));
    assert_eq!(reading.place, Some(socrates_model::PlaceClass::Corridor));
    let group = FactKind::Group { group: GroupId(1), members: vec![id(1), id(2)] };
    assert_eq!(quote(&reading, &group), "side by side");
}

#[test]
fn a_reason_without_a_distance_has_the_usual_one() {
    let reading = reading("A nurse steps aside when the robot comes near, and stops when she sees it.");
    let rules = &reading.humans[0].rules;
    assert_eq!((&rules[0].act, &rules[0].when[..]), (&Action::GiveWay, &[Trigger::RobotNear(3.0)][..]));
    assert_eq!((&rules[1].act, &rules[1].when[..]), (&Action::StandStill, &[Trigger::RobotVisible(5.0)][..]));
}

#[test]
fn what_ends_a_step_is_a_rule_before_it() {
    let reading = reading("A guard blocks the robot until it says excuse me.");
    let rules = &reading.humans[0].rules;
    assert_eq!((&rules[0].act, &rules[0].when[..]), (&Action::Navigate, &[Trigger::RobotSays(Gesture::ExcuseMe)][..]));
    assert_eq!((&rules[1].act, &rules[1].when[..]), (&Action::Block, &[Trigger::Always][..]));
    assert!(reading.facts.iter().any(|fact| fact.kind == FactKind::RobotSays(Gesture::ExcuseMe)));
}

#[test]
fn steps_that_follow_each_other_begin_together() {
    let reading = reading("When the robot is 2 m away, a guest stops for 3 s and then walks on.");
    let rules = &reading.humans[0].rules;
    assert_eq!((rules[0].for_s, &rules[0].when[..]), (Some(3.0), &[Trigger::RobotNear(2.0)][..]));
    assert_eq!((&rules[1].act, &rules[1].when), (&Action::Navigate, &rules[0].when));
}

#[test]
fn a_sign_to_somebody_is_made_to_them() {
    let reading = reading("A nurse tells a patient to wait, and the patient stops.");
    let to = FactKind::GesturesTo { human: id(1), gesture: Gesture::Wait, to: AgentId::Human(id(2)) };
    assert!(reading.facts.iter().any(|fact| fact.kind == to), "{reading:#?}");
    assert_eq!(reading.humans[1].rules[0].when, [Trigger::HumanSays(id(1), Gesture::Wait)]);
}

#[test]
fn statements_name_their_facts_and_what_is_missing() {
    let text = "Ünal yodels. A nurse crosses the corridor and dances.";
    let reading = reading(text);
    assert_eq!(reading.missing(), ["Ünal yodels", "dances"]);
    let crosses = reading.facts.iter().find(|fact| matches!(fact.kind, FactKind::Relates { .. })).unwrap();
    let read = |became: &Became| matches!(became, Became::Read { facts, lines } if facts.contains(&crosses.id) && facts.len() == lines.len());
    assert!(reading.statements.iter().any(|statement| read(&statement.became)), "{reading:#?}");
    // Spans count characters: the first word has one that is two bytes long.
    for statement in &reading.statements {
        let span = statement.span;
        let own: String = text.chars().skip(span.from as usize).take((span.to - span.from) as usize).collect();
        assert_eq!(own, statement.quote);
    }
}

#[test]
fn nothing_is_read_of_nothing() {
    let nothing = reading("");
    assert!(nothing.humans.is_empty() && nothing.facts.is_empty() && nothing.statements.is_empty(), "{nothing:?}");
}
