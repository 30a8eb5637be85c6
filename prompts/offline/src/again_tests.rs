//! Requests in which somebody meets the robot twice.

use socrates_model::job::Stage;
use socrates_model::{FactKind, Fault, HumanId, Location, PlaceClass, Reading, Relation, Request};
use socrates_prompts::Question;

use crate::proposal::propose;
use crate::read;
use crate::solve::solve;

fn request(rough: &str) -> Request {
    Request {
        location: "x".to_owned(),
        social_context: String::new(),
        task: "Drive along the corridor".to_owned(),
        rough_scenario: Some(rough.to_owned()),
        location_description: None,
        robot: Default::default(),
        run: Default::default(),
        expect: Default::default(),
        proposal: None,
        paths: None,
        behaviors: None,
    }
}

fn map(name: &str) -> Location {
    socrates_maps::shipped::load(name).unwrap()
}

fn twice(reading: &Reading) -> Vec<(u32, u32, Option<PlaceClass>)> {
    let of = |kind: &FactKind| {
        if let FactKind::MeetsTimes { human, times, place } = kind {
            Some((human.number(), *times, *place))
        } else {
            None
        }
    };
    reading.facts.iter().filter_map(|fact| of(&fact.kind)).collect()
}

#[test]
#[expect(clippy::print_stderr, reason = "looked at by hand")]
fn look() {
    for rough in [
        "A nurse meets the robot twice.",
        "A nurse meets the robot in the corridor and meets it again later.",
        "A nurse comes towards the robot. Later she meets it a second time.",
        "A visitor crosses the robot's path twice.",
        "A visitor crosses its path twice.",
        "The robot meets the same nurse two times.",
        "A nurse walks towards the robot and meets it again at an intersection.",
        "A nurse walks towards the robot and meets it again at the exit.",
        "A man walks past the robot and then passes it once more.",
        "Two people walk together towards the robot and meet it twice.",
        "A nurse meets the robot three times.",
        "A nurse stands in the corridor and meets the robot twice.",
        "A nurse comes towards the robot, looks at it for 5 seconds, and crosses its way again later.",
        "A doctor meets the robot, then they meet again at the intersection. A visitor crosses.",
    ] {
        let reading = read(&request(rough), &map("office"));
        eprintln!("\n{rough}\n  {:?}", twice(&reading));
        for fact in &reading.facts {
            eprintln!("  {} {:?} {:?}", fact.id, fact.quote, fact.kind);
        }
        eprintln!("  ignored {:?}", reading.ignored);
        for fault in &reading.problems {
            eprintln!("  {fault}");
        }
    }
}

fn made(rough: &str, place: &str, seed: u64) -> (socrates_model::Paths, Vec<Fault>) {
    let (request, location) = (request(rough), map(place));
    let question = Question { stage: Stage::Proposal, ..Question::first(request.clone(), read(&request, &location), location.clone(), seed) };
    let _ = &location; let proposal = propose(&question);
    let ask = Question { stage: Stage::Paths, proposal: Some(proposal.clone()), ..question };
    let paths = solve(&ask, &proposal).unwrap();
    let faults = Vec::<Fault>::new();
    (paths, faults)
}

#[test]
#[expect(clippy::print_stderr, reason = "looked at by hand")]
fn look_at_paths() {
    for rough in ["A nurse comes towards the robot and meets it again later.", "A visitor crosses the robot's path twice."] {
        for place in ["office", "hospital", "warehouse"] {
            for seed in 1..=3 {
                let (paths, faults) = made(rough, place, seed);
                let way = |nodes: &[socrates_model::NodeId]| nodes.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ");
                eprintln!("{place} {seed} {rough}");
                eprintln!("   robot {}", way(&paths.robot));
                eprintln!("   human {}", way(&paths.humans[&HumanId::new(1)]));
                eprintln!("   meets {}", way(&paths.encounters.iter().map(|e| e.node.clone()).collect::<Vec<_>>()));
                for fault in faults {
                    eprintln!("   {fault}");
                }
            }
        }
    }
    let _ = Relation::Frontal;
}
