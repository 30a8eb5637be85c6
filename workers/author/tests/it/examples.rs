//! Every worked example that a prompt shows would itself be accepted: read and checked like an answer of a model.

use socrates_author::{Says, Written, attempt};
use socrates_model::job::Stage;
use socrates_prompts::{BehaviorsForm, PathsForm, Style, examples};

fn styles() -> Vec<Style> {
    let forms = PathsForm::ALL.iter().zip(BehaviorsForm::ALL);
    forms.map(|(paths, behaviors)| Style { paths: *paths, behaviors: *behaviors, ..Style::default() }).collect()
}

#[tokio::test]
async fn every_example_of_every_stage_and_form_passes_the_checks_without_a_warning() {
    for stage in [Stage::Proposal, Stage::Paths, Stage::Behaviors] {
        for style in styles() {
            let shown = examples::worked(stage, &style);
            assert_eq!(shown.len(), 2);
            for (question, answer) in shown {
                // The form that servers are told to enforce takes it as well.
                let made = attempt(&Says(answer.to_string()), &question).await;
                let made = made.unwrap_or_else(|refused| panic!("{stage} {style:?}: {:?}\n{answer}", refused.faults));
                assert!(made.exchange.faults.is_empty(), "{stage} {style:?}: {:?}", made.exchange.faults);
            }
        }
    }
}

#[tokio::test]
async fn an_example_means_the_same_in_every_form() {
    let mut paths = Vec::new();
    let mut actions = Vec::new();
    for style in styles() {
        let (question, answer) = examples::worked(Stage::Paths, &style).remove(0);
        let Written::Paths(read) = attempt(&Says(answer.to_string()), &question).await.unwrap().written else {
            panic!()
        };
        paths.push((read.robot, read.humans, read.encounters));
        let (question, answer) = examples::worked(Stage::Behaviors, &style).remove(0);
        let Written::Behaviors(read) = attempt(&Says(answer.to_string()), &question).await.unwrap().written else {
            panic!()
        };
        let trees = read.humans.values().map(|human| socrates_bt::Tree::parse(&human.tree).unwrap());
        actions.push(trees.map(|tree| (tree.conditions(), tree.actions())).collect::<Vec<_>>());
    }
    assert!(paths.windows(2).all(|pair| pair[0] == pair[1]), "{paths:?}");
    assert!(actions.windows(2).all(|pair| pair[0] == pair[1]), "{actions:?}");
}

/// What a question shows as refused is refused with the fault that it names.
#[tokio::test]
async fn what_is_shown_as_refused_is_refused_for_the_reason_that_is_given() {
    for form in PathsForm::ALL {
        let style = Style { paths: *form, ..Style::default() };
        let shown = examples::refused_paths(*form);
        let (question, mut answer) = examples::worked(Stage::Paths, &style).remove(0);
        let (part, told) = shown.trim_start_matches('`').split_once("`: ").unwrap();
        let part: serde_json::Value = serde_json::from_str(&format!("{{{part}}}")).unwrap();
        let (name, value) = part.as_object().unwrap().iter().next().unwrap();
        answer["humans"][name] = value.clone();
        let refused = attempt(&Says(answer.to_string()), &question).await.unwrap_err();
        let codes: Vec<&str> = refused.faults.iter().map(|fault| fault.code.code()).collect();
        assert!(codes.contains(&told.split(',').next().unwrap()), "{form:?}: {codes:?}");
    }
}
