//! Worked examples: two scenarios on a small map, shown in each question in the form in which it is to be answered.
//!
//! They are data, in full form; a test holds every answer that is shown against the checks of the stages.

use serde::Deserialize;
use serde_json::{Value, json};
use socrates_bt::TreeSpec;
use socrates_model::job::Stage;
use socrates_model::{Cell, FORMAT, Grid, Location, Paths, Pose, Proposal, ReadBy, Reading, Request, SceneGraph};

use crate::question::Question;
use crate::style::{BehaviorsForm, PathsForm, Style};
use crate::{account, scenario, ways};

/// The map of the examples.
pub(crate) const MAP: &str = include_str!("../examples/map.json");
/// The examples, in the order in which they are shown.
pub(crate) const ALL: [&str; 2] =
    [include_str!("../examples/crossing.json"), include_str!("../examples/overtaking.json")];

/// An answer to the first example that is refused, with its fault: paths in the form in which they are asked for.
#[must_use]
pub const fn refused_paths(form: PathsForm) -> &'static str {
    match form {
        PathsForm::Anchors => {
            "`\"human_2\":{\"start\":\"n\",\"via\":[],\"meet\":\"c\",\"goal\":\"c\"}`: G-MEETEND, it ends where it meets the robot; one node more."
        }
        PathsForm::Nodes => "`\"human_2\":[\"n\",\"c\"]`: G-MEETEND, it ends where it meets the robot; one node more.",
        PathsForm::Walk => {
            "`\"human_2\":{\"walk\":{\"at\":\"n\",\"next\":{\"at\":\"c\",\"next\":null}},\"meet\":\"c\"}`: G-MEETEND, it ends where it meets the robot; one node more."
        }
    }
}

/// One worked example.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct Example {
    request: Request,
    /// The account of its sentences, as an author that reads it itself gives it.
    reading: Value,
    scenario: Value,
    proposal: Proposal,
    paths: Paths,
}

/// Every worked example of a stage: its question, and the answer as it is shown in this style.
///
/// Empty where the data cannot be read, which a test keeps from happening.
#[must_use]
pub fn worked(stage: Stage, style: &Style) -> Vec<(Question, Value)> {
    ALL.iter()
        .filter_map(|text| serde_json::from_str::<Example>(text).ok())
        .map(|example| {
            let answer = answer(&example, stage, style);
            let reading = Reading { by: ReadBy::Author, ..Reading::default() };
            let question = Question {
                stage,
                proposal: (stage != Stage::Proposal).then_some(example.proposal),
                ..Question::first(example.request, reading, location(), 1)
            };
            (question, answer)
        })
        .collect()
}

fn answer(example: &Example, stage: Stage, style: &Style) -> Value {
    match stage {
        Stage::Proposal | Stage::Review | Stage::Simulation | Stage::Scoring => {
            let proposal = &example.proposal;
            json!({
                "analysis": "…", account::MEMBER: example.reading, "title": proposal.title, "description": proposal.description,
                scenario::MEMBER: example.scenario, "expected_behavior": proposal.robot.expected_behavior, "notes": [],
            })
        }
        Stage::Paths => ways::written(&example.paths, style.paths, &location().graph),
        Stage::Behaviors => {
            let humans: serde_json::Map<String, Value> = example
                .proposal
                .humans
                .iter()
                .map(|human| {
                    let (key, value) = match style.behaviors {
                        BehaviorsForm::Rules => ("rules", json!(human.rules)),
                        BehaviorsForm::JsonTree => ("tree", TreeSpec::of_rules(&human.rules).json()),
                        BehaviorsForm::Xml => {
                            ("tree", json!(socrates_bt::compile(human.id, &human.rules).unwrap_or_default()))
                        }
                    };
                    let shown = json!({key: value});
                    (human.id.to_string(), shown)
                })
                .collect();
            json!({"analysis": "…", "humans": humans})
        }
    }
}

/// The map of the examples, wide and empty.
#[must_use]
pub fn location() -> Location {
    const SIDE: usize = 48;
    let graph: SceneGraph = serde_json::from_str(MAP).unwrap_or_default();
    Location {
        format: FORMAT,
        name: "example".to_owned(),
        description: String::new(),
        grid: Grid {
            width: SIDE,
            height: SIDE,
            resolution_m: 0.5,
            origin: Pose::new(-12.0, -12.0, 0.0),
            cells: vec![Cell::Free; SIDE * SIDE],
        },
        graph,
        doors: Vec::new(),
        names: Vec::new(),
        warnings: Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_example_has_the_whole_form_that_is_asked_for() {
        let style = Style::default();
        let mut seen = 0;
        for stage in [Stage::Proposal, Stage::Paths] {
            for (question, answer) in worked(stage, &style) {
                seen += 1;
                // Open members of a scenario may be absent: its parser decides.
                if stage == Stage::Proposal {
                    crate::parse_scenario(&answer.to_string()).unwrap();
                    crate::parse_account(&answer.to_string()).unwrap();
                    continue;
                }
                let missing = crate::conforms::differences("$", &crate::answer_schema(&question, &style), &answer);
                let told: Vec<String> = missing.iter().map(|one| format!("{one:?}")).collect();
                assert_eq!(told, Vec::<String>::new());
            }
        }
        assert_eq!(seen, 4);
    }

    #[test]
    fn the_data_of_the_examples_can_be_read() {
        for text in ALL {
            serde_json::from_str::<Example>(text).unwrap();
        }
        assert_eq!(location().graph.parts().len(), 1);
    }
}
