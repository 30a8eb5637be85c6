//! Requests in which somebody meets the robot twice.

use socrates_model::job::Stage;
use socrates_model::{FactKind, FaultCode, HumanId, Paths, PlaceClass, Predicate, Proposal, Reading, Request};
use socrates_prompts::Question;

use crate::proposal::propose;
use crate::read;
use crate::solve::solve;
use crate::tests::{self, map};

fn request(rough: &str) -> Request {
    tests::request("Drive along the corridor", Some(rough))
}

/// Who meets the robot how often, and where at last.
fn often(reading: &Reading) -> Vec<(u32, u32, Option<PlaceClass>)> {
    let of = |kind: &FactKind| {
        if let FactKind::MeetsTimes { human, times, place } = kind {
            Some((human.number(), *times, *place))
        } else {
            None
        }
    };
    reading.facts.iter().filter_map(|fact| of(&fact.kind)).collect()
}

const TWICE: (u32, u32, Option<PlaceClass>) = (1, 2, None);

#[test]
fn a_second_meeting_is_read_in_many_words() {
    for rough in [
        "A nurse meets the robot twice.",
        "A nurse meets the robot in the corridor and meets it again later.",
        "A nurse comes towards the robot. Later she meets it a second time.",
        "A visitor crosses the robot's path twice.",
        "A visitor crosses its path twice.",
        "The robot meets the same nurse two times.",
        "A nurse comes towards the robot, looks at it for 5 seconds, and crosses its way again later.",
    ] {
        let reading = read(&request(rough), &map("office"));
        assert_eq!(often(&reading), [TWICE], "{rough}");
        assert_eq!(reading.humans.len(), 1, "{rough}");
        assert!(reading.problems.is_empty() && crate::tests::loose(&reading).is_empty(), "{rough}: {reading:#?}");
    }
}

#[test]
fn everybody_of_a_group_meets_it_twice() {
    let reading = read(&request("Two people walk together towards the robot and meet it twice."), &map("office"));
    assert_eq!(often(&reading), [TWICE, (2, 2, None)]);
}

#[test]
fn the_place_of_the_second_meeting_is_its_own() {
    let rough = "A nurse walks towards the robot in the corridor and meets it again at an intersection.";
    let reading = read(&request(rough), &map("office"));
    assert_eq!(often(&reading), [(1, 2, Some(PlaceClass::Intersection))]);
    assert_eq!(reading.place, Some(PlaceClass::Corridor));
}

#[test]
fn what_cannot_be_played_twice_is_said_before_the_run() {
    for (rough, code, found) in [
        ("A nurse meets the robot three times.", FaultCode::PRead, vec![TWICE]),
        ("A nurse stands in the corridor and meets the robot twice.", FaultCode::PRead, vec![]),
        ("A nurse walks towards the robot and meets it again at the exit.", FaultCode::PPlace, vec![TWICE]),
    ] {
        let reading = read(&request(rough), &map("office"));
        assert_eq!(often(&reading), found, "{rough}");
        let codes: Vec<FaultCode> = reading.problems.iter().map(|fault| fault.code).collect();
        assert_eq!(codes, [code], "{rough}");
    }
}

#[test]
fn other_things_done_again_are_no_second_meeting() {
    for rough in [
        "A nurse stops and then walks on again.",
        "A visitor looks at the robot twice.",
        "A second person crosses the corridor.",
    ] {
        assert!(often(&read(&request(rough), &map("office"))).is_empty(), "{rough}");
    }
}

fn made(rough: &str, place: &str, seed: u64) -> (Proposal, Paths) {
    let (request, location) = (request(rough), map(place));
    let reading = read(&request, &location);
    let question = Question { stage: Stage::Proposal, ..Question::first(request, reading, location, seed) };
    let proposal = propose(&question);
    let ask = Question { stage: Stage::Paths, proposal: Some(proposal.clone()), ..question };
    let paths = solve(&ask, &proposal).unwrap();
    (proposal, paths)
}

#[test]
fn both_paths_lead_to_both_meetings() {
    let human = HumanId::new(1);
    for rough in [
        "A nurse comes towards the robot and meets it again later.",
        "A visitor crosses the robot's path twice.",
        "A nurse walks towards the robot in the corridor and meets it again at an intersection.",
    ] {
        for place in ["office", "hospital", "warehouse"] {
            for seed in 1..=3 {
                let (proposal, paths) = made(rough, place, seed);
                let wants = |clause: &socrates_model::Clause| {
                    clause.must
                        && matches!(clause.predicate, Predicate::MeetsAgain { human: who, nth: 2, .. } if who == human)
                };
                assert!(proposal.expected_events.iter().any(wants), "{rough}");
                let visits = paths.visits(human);
                let [first, second] = visits[..] else { panic!("{place} {seed} {rough}: {paths:#?}") };
                let steps = [first.robot_step, first.human_step, second.robot_step, second.human_step];
                assert!(steps.iter().all(Option::is_some), "{place} {seed} {rough}: {steps:?} {paths:#?}");
                let between = &paths.robot[first.robot_step.unwrap()..=second.robot_step.unwrap()];
                assert!(map(place).graph.length_m(between) >= 6.0, "{place} {seed} {rough}");
                if rough.contains("intersection") {
                    assert!(map(place).graph.node_is(second.node, PlaceClass::Intersection), "{place} {seed}");
                }
            }
        }
    }
}

#[test]
fn many_are_met_one_after_the_other_along_the_way() {
    let met = |task: &str, rough: &str| {
        let (_, _, paths) = crate::tests::answers(&crate::tests::request(task, Some(rough)), &map("hospital"), 1);
        paths.encounters.iter().map(|encounter| encounter.node.clone()).collect::<std::collections::BTreeSet<_>>()
    };
    let rough = "Eight people walk along the corridor: four come towards the robot, four walk in the same direction as the robot.";
    let nodes = met("Drive along the main corridor", rough);
    assert!(nodes.len() > 1, "{nodes:?}");
    assert_eq!(met("Drive", "Three people come towards the robot.").len(), 1);
}
