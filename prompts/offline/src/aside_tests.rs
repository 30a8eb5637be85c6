//! Bystanders, people who come very close, groups that open, somebody who looks at another, and the way back, as texts say them.

use socrates_model::proposal::WayPart;
use socrates_model::{FactKind, Reading, Relation};

use crate::read;
use crate::tests::{map, request};

fn reading(task: &str, rough: &str) -> Reading {
    read(&request(task, Some(rough)), &map("hospital"))
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
