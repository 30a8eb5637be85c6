//! An author whose paths the solver writes: the model says who is there and what they do, geometry says where they go.

use async_trait::async_trait;
use socrates_model::job::Stage;
use socrates_model::{FaultCode, Paths, Proposal, seeds};
use socrates_prompts::Question;
use socrates_solver::{Problem, Told};

use crate::author::{Answer, AskError, Author};

/// Setting of a job that says who writes the paths, and its words.
const SETTING: &str = "paths_by";
const MODEL: &str = "model";
const SOLVER: &str = "solver";

/// Name of the solver, as artifacts spell it.
pub const NAME: &str = "solver/1";

/// Whether the settings of a job have the solver write paths; the author itself does without the setting.
///
/// # Errors
/// `J-REQUEST` for a word that means nobody.
pub(crate) fn by_solver(settings: &std::collections::BTreeMap<String, String>) -> Result<bool, AskError> {
    match settings.get(SETTING).map(String::as_str) {
        None | Some(MODEL) => Ok(false),
        Some(SOLVER) => Ok(true),
        Some(other) => {
            let message = format!("`{SETTING}`: `{other}` is unknown; allowed: {MODEL}, {SOLVER}");
            Err(AskError::new(FaultCode::JRequest, message))
        }
    }
}

/// Asks the inner author for everything but paths.
pub(crate) struct BySolver {
    pub(crate) inner: Box<dyn Author>,
}

#[async_trait]
impl Author for BySolver {
    async fn ask(&self, question: &Question) -> Result<Answer, AskError> {
        match &question.proposal {
            Some(proposal) if question.stage == Stage::Paths => {
                Ok(Answer { text: answer(question, proposal), model: NAME.to_owned(), ..Answer::default() })
            }
            Some(_) | None => self.inner.ask(question).await,
        }
    }

    fn name(&self) -> String {
        self.inner.name()
    }
}

/// The paths of a proposal as text; where there are none, the reason under `cannot`, which is E-CANNOT.
fn answer(question: &Question, proposal: &Proposal) -> String {
    let former = question.refused.as_deref().and_then(|text| serde_json::from_str::<Paths>(text).ok());
    // What the task says in words is the model's to read: it stands in the proposal as classes of places.
    let problem = Problem {
        radius_m: question.request.robot.model.radius_m,
        layout: socrates_offline::layout(&proposal.pattern),
        told: Told::of(&question.feedback, former, proposal),
        draw: seeds::derive_seed(question.seed, &["paths"]),
        breadth: question.request.run.breadth,
        ..Problem::of(proposal, &question.location, NAME.into())
    };
    let written = socrates_solver::solve(&problem).map(|solved| serde_json::to_string_pretty(&solved.paths));
    match written {
        Ok(Ok(text)) => text,
        Ok(Err(why)) => serde_json::json!({ "cannot": why.to_string() }).to_string(),
        Err(miss) => serde_json::json!({ "cannot": miss.to_string() }).to_string(),
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::attempt::{Written, attempt};
    use crate::testing::{Scripted, question};

    #[tokio::test]
    async fn paths_come_from_geometry_and_everything_else_from_the_author() {
        let author = BySolver { inner: Box::new(Scripted::says("no paths")) };
        let made = attempt(&author, &question(Stage::Paths)).await.unwrap();
        let Written::Paths(paths) = &made.written else { panic!("{made:?}") };
        assert_eq!((paths.author.clone(), paths.encounters.len()), (NAME.into(), 2));
        assert_eq!(author.ask(&question(Stage::Proposal)).await.unwrap().text, "no paths");
    }

    #[tokio::test]
    async fn what_does_not_fit_is_said_with_its_numbers() {
        let author = BySolver { inner: Box::new(Scripted::says("no paths")) };
        let mut ask = question(Stage::Paths);
        ask.location.graph = ask.location.graph.edited(|_, edges| edges.retain(|edge| edge.from.as_str() != "c"));
        let refused = attempt(&author, &ask).await.unwrap_err();
        assert_eq!(refused.faults[0].code, FaultCode::ECannot);
        assert!(refused.faults[0].message.to_string().contains(" m "), "{:?}", refused.faults);
    }

    #[test]
    fn a_word_that_means_nobody_is_named() {
        let settings = |word: &str| BTreeMap::from([(SETTING.to_owned(), word.to_owned())]);
        assert_eq!(by_solver(&settings("solver")), Ok(true));
        assert_eq!(by_solver(&BTreeMap::new()), Ok(false));
        assert_eq!(by_solver(&settings("oracle")).unwrap_err().code, FaultCode::JRequest);
    }
}
