//! What people met who used the program for the first time: wrong words about what was read, and answers without a reason.

use socrates_model::job::Stage;
use socrates_model::request::Expect;
use socrates_model::{FactKind, FaultCode, PlaceClass, Reading, Request};
use socrates_prompts::{Question, parse_paths};

use crate::answer::Offline;
use crate::tests::{map, proposed, request};
use crate::{read, settled_by};

fn task(text: &str) -> Reading {
    read(&request(text, Some("A nurse comes towards the robot.")), &map("hospital"))
}

fn expecting(rough: &str, expect: Expect) -> Reading {
    let asked = Request { expect, ..request("Drive to the exit", Some(rough)) };
    read(&asked, &map("hospital"))
}

#[test]
fn to_return_to_the_only_place_of_a_task_is_no_way_back() {
    let goal = |reading: &Reading| reading.facts.iter().any(|fact| matches!(fact.kind, FactKind::RobotGoal(_)));
    for text in ["Return to the nurse station", "Fetch linen and return to the nurse station", "Go back to the exit"] {
        let reading = task(text);
        assert!(reading.problems.is_empty() && goal(&reading), "{text}: {:#?}", reading.problems);
    }
    for text in ["Bring pills to ward 1 and return to the nurse station", "Return"] {
        let reading = task(text);
        assert!(
            reading.problems.iter().any(|fault| fault.message.to_string().contains("another way on")),
            "{text}: {reading:#?}"
        );
    }
}

#[test]
fn what_is_expected_wins_over_the_text() {
    let three = Expect { humans: Some(3), ..Expect::default() };
    let reading = expecting("Two nurses come towards the robot.", three.clone());
    let roles: Vec<(&str, &str)> =
        reading.humans.iter().map(|human| (human.role.as_str(), human.summary.as_str())).collect();
    assert_eq!(roles, [("nurse", "comes towards the robot"); 3]);

    // Groups name people too.
    let grouped =
        expecting("Two nurses come towards the robot.", Expect { groups: vec![vec![1, 3]], ..Expect::default() });
    assert!(grouped.problems.is_empty() && grouped.humans.len() == 3, "{grouped:#?}");
    let nobody = expecting("Nobody is there.", Expect { humans: Some(2), ..Expect::default() });
    assert!(nobody.problems.is_empty(), "{nobody:#?}");
    let place = Expect { place: Some(PlaceClass::Corridor), ..Expect::default() };
    let beach = expecting("A nurse stands on the beach.", place);
    assert!(beach.problems.is_empty() && beach.place == Some(PlaceClass::Corridor), "{beach:#?}");
}

#[test]
fn a_key_of_expect_is_only_proposed_where_it_helps() {
    let keys = |rough: &str| settled_by(&request("Drive to the exit", Some(rough)), &map("hospital"));
    assert_eq!(keys("A nurse walks through a narrow passage."), ["place"]);
    assert_eq!(keys("400 people come towards the robot."), ["humans"]);
    for rough in ["A person follows the robot and runs away from it.", "Une personne marche vers le robot."] {
        assert_eq!(keys(rough), [""; 0], "{rough}");
    }
}

#[test]
fn people_are_they_in_a_proposal() {
    let rough = "A lady comes towards the robot. When she sees it within 3 m she stops and looks at it for 5 s.";
    let text = proposed(&request("Drive to the exit", Some(rough)), &map("hospital")).description;
    assert!(text.contains("When the robot is within 3 m they stop and look at the robot for 5 s."), "{text}");
    assert!(!text.contains(" it sees") && !text.contains(" it stops"), "{text}");
}

#[test]
fn an_author_that_cannot_says_why() {
    // A corridor of 5.9 m: too short for any scenario.
    let plan = "description = \"One corridor.\"\nsize_m = [8.0, 4.0]\nresolution_m = 0.1\nfloors = [[0.5, 0.5, 7.5, 3.0]]\n\
        nodes = [{ id = \"c1\", type = \"CORRIDOR\", at = [1.0, 1.7] }, { id = \"c2\", type = \"CORRIDOR\", at = [3.0, 1.7] },\n\
        { id = \"c3\", type = \"CORRIDOR\", at = [5.0, 1.7] }]\n\
        edges = [{ type = \"CORRIDOR\", along = [\"c1\", \"c2\", \"c3\"] }]\n";
    let small = socrates_maps::parse(&socrates_maps::generate(plan).unwrap(), "small").unwrap();
    let asked = request("Drive on", Some("A nurse comes towards the robot."));
    let reading = read(&asked, &small);
    let mut question = Question::first(asked, reading, small, 1);
    question.stage = Stage::Paths;
    let faults = parse_paths(&Offline::answer(&question), &question).unwrap_err();
    assert_eq!((faults.len(), faults[0].code), (1, FaultCode::ECannot), "{faults:#?}");
    assert!(
        faults[0].message.to_string().contains("from `c1` to `c3`, is 4.0 m; at least 6 m are needed"),
        "{}",
        faults[0].message
    );
}
