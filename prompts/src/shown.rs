//! A refused answer as the author reads it again: in the form in which it is to answer, whatever it was kept as.

use serde_json::{Value, json};
use socrates_bt::TreeSpec;
use socrates_model::job::Stage;
use socrates_model::{Behaviors, Paths, Proposal};

use crate::question::Question;
use crate::style::{BehaviorsForm, Mode, Style};
use crate::{account, order, scenario, ways};

/// The refused answer of a question. What a stage had taken already, and what comes back to it after the simulation, is kept in full form
/// and is put into that of the answer; other words come back as they are.
pub(crate) fn again(question: &Question, style: &Style) -> Option<String> {
    let refused = question.refused.as_deref()?;
    if style.mode == Mode::Naive {
        return Some(refused.to_owned());
    }
    let order = order::of(question.stage);
    let written = |answer: &Value| order::written(answer, order);
    Some(in_form(question, style, refused).map_or_else(|| refused.to_owned(), |answer| written(&answer)))
}

/// A kept output of the question's stage in the form of its answer; none of other words.
pub(crate) fn in_form(question: &Question, style: &Style, refused: &str) -> Option<Value> {
    match question.stage {
        Stage::Proposal | Stage::Review | Stage::Simulation | Stage::Scoring => {
            let kept: Proposal = serde_json::from_str(refused).ok()?;
            let stated = question.reading.scenario.as_ref()?;
            Some(json!({
                account::MEMBER: question.account, "title": kept.title, "description": kept.description,
                scenario::MEMBER: stated, "expected_behavior": kept.robot.expected_behavior, "notes": kept.notes,
            }))
        }
        Stage::Paths => {
            let kept: Paths = serde_json::from_str(refused).ok()?;
            Some(ways::written(&kept, style.paths, &question.location.graph))
        }
        Stage::Behaviors => {
            let kept: Behaviors = serde_json::from_str(refused).ok()?;
            let proposal = question.proposal.as_ref()?;
            let asked = question.humans(proposal);
            let humans = asked.into_iter().filter_map(|human| {
                let tree = &kept.humans.get(&human.id)?.tree;
                // A tree that was taken does what the rules of the proposal say.
                let behavior = match style.behaviors {
                    BehaviorsForm::Rules => json!({"rules": human.rules}),
                    BehaviorsForm::JsonTree => json!({"tree": TreeSpec::of_rules(&human.rules).json()}),
                    BehaviorsForm::Xml => json!({"tree": tree}),
                };
                Some((human.id.to_string(), behavior))
            });
            Some(json!({"humans": humans.collect::<serde_json::Map<String, Value>>()}))
        }
    }
}

#[cfg(test)]
mod tests {
    use socrates_model::HumanBehavior;

    use super::*;
    use crate::style::PathsForm;
    use crate::{examples, testing};

    /// The refused answer as the author of this style is shown it.
    fn shown(question: &Question, style: &Style) -> String {
        let messages = question.prompt(style).messages;
        messages.into_iter().find(|message| message.role == crate::Role::Assistant).unwrap().text
    }

    #[test]
    fn a_proposal_comes_back_as_the_scenario_that_it_was_made_from() {
        let (mut asked, answer) = examples::worked(Stage::Proposal, &Style::default()).remove(0);
        asked.refused = Some(serde_json::to_string_pretty(&testing::proposal()).unwrap());
        asked.reading.scenario = Some(crate::parse_scenario(&answer.to_string()).unwrap().scenario);
        let text = shown(&asked, &Style::default());
        assert!(!text.contains("\"format\"") && !text.contains("predicate"), "{text}");
        let read = crate::parse_scenario(&text).unwrap();
        assert_eq!(Some(read.scenario), asked.reading.scenario);
        assert_eq!(read.beside.title, testing::proposal().title);
    }

    #[test]
    fn paths_come_back_in_each_form() {
        for form in PathsForm::ALL {
            let style = Style { paths: *form, ..Style::default() };
            for (mut asked, answer) in examples::worked(Stage::Paths, &style) {
                let kept = crate::parse_paths(&answer.to_string(), &asked).unwrap();
                asked.refused = Some(serde_json::to_string(&kept).unwrap());
                let text = shown(&asked, &style);
                let again: Value = serde_json::from_str(&text).unwrap();
                assert_eq!((&again["humans"], &again["robot"]), (&answer["humans"], &answer["robot"]), "{form:?}");
                assert!(text.find("\"robot\"") < text.find("\"humans\""), "{text}");
            }
        }
    }

    #[test]
    fn behaviors_come_back_as_rules_as_trees_or_as_they_were_written() {
        let mut asked = testing::question(Stage::Behaviors);
        let proposal = asked.proposal.clone().unwrap();
        let tree = |id| socrates_bt::compile(id, &[]).unwrap();
        let humans = proposal
            .humans
            .iter()
            .map(|human| (human.id, HumanBehavior { tree: tree(human.id), description: String::new() }));
        let kept = Behaviors { format: 1, humans: humans.collect(), author: socrates_model::Signature::default() };
        asked.refused = Some(serde_json::to_string(&kept).unwrap());
        for (form, key) in
            [(BehaviorsForm::Rules, "rules"), (BehaviorsForm::JsonTree, "tree"), (BehaviorsForm::Xml, "tree")]
        {
            let style = Style { behaviors: form, ..Style::default() };
            let text = shown(&asked, &style);
            let read: Value = serde_json::from_str(&text).unwrap();
            assert!(read["humans"]["human_1"].get(key).is_some(), "{form:?}: {text}");
            assert!(!text.contains("\"format\""), "{text}");
        }
    }

    #[test]
    fn other_words_come_back_as_they_are() {
        let mut asked = testing::question(Stage::Paths);
        for words in ["{\"robot\": []}", "no", "{\"analysis\": \"x\", \"robot\": {\"start\": \"w\"}}"] {
            asked.refused = Some(words.to_owned());
            assert_eq!(shown(&asked, &Style::default()), words);
        }
    }
}
