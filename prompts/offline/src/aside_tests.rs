//! Bystanders, people who come very close, groups that open, somebody who looks at another, and the way back, as texts say them.

use socrates_model::proposal::WayPart;
use socrates_model::{Action, FactKind, HumanId, Reading, Relation};

use crate::read;
use crate::tests::{map, request};

fn reading(task: &str, rough: &str) -> Reading {
    read(&request(task, Some(rough)), &map("hospital"))
}

fn acts(rough: &str) -> Vec<Action> {
    let humans = reading("Deliver mail", rough).humans;
    humans.into_iter().flat_map(|human| human.rules).map(|rule| rule.act).collect()
}

#[test]
fn a_bystander_stands_aside() {
    for rough in [
        "A visitor watches from the side in the corridor while a nurse walks towards the robot.",
        "A visitor stands off to one side in the corridor. A nurse walks towards the robot.",
    ] {
        let relations: Vec<_> =
            reading("Deliver mail", rough).humans.into_iter().filter_map(|human| human.relation).collect();
        assert_eq!(relations, [Relation::Aside, Relation::Frontal], "{rough}");
    }
}

#[test]
fn how_close_somebody_comes_and_whom_they_look_at_is_read() {
    assert_eq!(acts("A child in the corridor walks right up to the robot."), [Action::ApproachTo(0.8)]);
    let looks =
        acts("A nurse stands in the corridor. A visitor walks towards the robot, stops and looks at the nurse.");
    assert!(looks.contains(&Action::LookAt(HumanId::new(1))), "{looks:?}");
    assert!(
        acts("Three visitors stand in the corridor and open their circle when the robot is near.")
            .contains(&Action::MakeRoom)
    );
}

#[test]
fn a_way_back_is_part_of_the_robots_way_unless_it_leads_elsewhere() {
    let back = |task: &str| {
        let reading = reading(task, "A nurse walks towards the robot in the corridor.");
        let played =
            reading.facts.iter().any(|fact| matches!(fact.kind, FactKind::RobotAt { part: WayPart::Back, .. }));
        (played, reading.problems.iter().any(|fault| fault.message.to_string().contains("another way on")))
    };
    assert_eq!(back("Bring pills to the pharmacy and come back."), (true, false));
    assert_eq!(back("Bring pills to the pharmacy and then go back to the exit."), (false, true));
    assert_eq!(back("Bring pills to the pharmacy."), (false, false));
}
