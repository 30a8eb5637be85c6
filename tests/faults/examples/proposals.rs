//! `P-`: proposals, and requests that cannot be read.

use socrates_author::offline::Offline;
use socrates_author::{FaultKind, Says, attempt};
use socrates_checks::{check_proposal, check_repeats};
use socrates_model::job::Stage;
use socrates_model::{FORMAT, Family, FaultCode, Likeness, Paths, ScenarioId};
use socrates_prompts::Question;

use super::{Examples, injected, keep, office, proposed};

/// Requests that can be read and not be met.
const UNMET: &[(&str, &str)] = &[
    ("Drive to the planetarium", "A nurse comes towards the robot."),
    ("Drive to the exit", "A worker follows the robot. He runs away from it."),
    ("Drive to the exit", "Ein Mann geht auf den Roboter zu und bleibt dann stehen."),
    ("Drive to the exit", "60 people come towards the robot."),
    ("Drive to the exit", "Two people come out of the elevator."),
];

pub(super) async fn examples() -> Examples {
    let mut all = injected(Stage::Proposal, |kind: FaultKind| kind.code().family() == Family::Proposal).await;
    for (task, rough) in UNMET {
        let (request, location) = office(task, rough);
        keep(&mut all, socrates_offline::read(&request, &location).problems);
    }
    let (request, location) = office("Drive to the exit", "A visitor comes towards the robot.");
    let mut proposal = proposed(&request, &location).await;
    let read_by_author =
        Question::first(request.clone(), socrates_offline::stated(&request, &location), location.clone(), 1);
    let mut answer: serde_json::Value =
        serde_json::from_str(&attempt(&Offline, &read_by_author).await.unwrap().exchange.answer).unwrap();
    answer["reading"].as_object_mut().unwrap().remove("s1");
    let refused = attempt(&Says(answer.to_string()), &read_by_author).await.unwrap_err();
    keep(&mut all, refused.faults.into_iter().filter(|fault| fault.code == FaultCode::PAccount));
    let nowhere = Paths {
        format: FORMAT,
        robot: Vec::new(),
        humans: std::collections::BTreeMap::new(),
        encounters: Vec::new(),
        reasoning: String::new(),
        author: proposal.author.clone(),
    };
    let likeness = Likeness::of(&proposal, &nowhere, &location);
    keep(&mut all, check_repeats(&likeness, &ScenarioId::new("frontal-1").unwrap(), &likeness));
    let id = location.graph.nodes().iter().map(|node| node.id.clone()).find(|id| {
        let id = id.as_str();
        id.len() > 1 && id.chars().any(|c| c.is_ascii_digit() || c == '_')
    });
    proposal.description.push_str(&format!(" They meet at {}.", id.unwrap()));
    keep(&mut all, check_proposal(&proposal, &socrates_offline::read(&request, &location), &location));
    all
}
