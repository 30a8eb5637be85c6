//! An author whose paths the solver writes: the model says who is there and what they do, geometry says where they go.

use async_trait::async_trait;
use socrates_model::job::Stage;
use socrates_model::{FaultCode, Paths, Proposal, seeds};
use socrates_prompts::{Mode, Question, Style};
use socrates_solver::{Miss, Problem, Told};

use crate::author::{Answer, AskError, Author, How};
use crate::stated;

/// Setting of a job that says who writes the paths, and its words.
const SETTING: &str = "paths_by";
const MODEL: &str = "model";
const ALONE: &str = "model_alone";
const SOLVER: &str = "solver";

/// Name of the solver, as artifacts spell it.
pub const NAME: &str = "solver/1";

/// Refused answers of a model after which the solver writes its paths.
const REFUSALS: u32 = 2;

/// From which attempt on the solver writes paths by the settings of a job: from the first, after the model was refused twice, or never for the
/// baseline of ablations and by the word `model_alone`.
///
/// # Errors
/// `J-REQUEST` for a word that means nobody.
pub(crate) fn solver_from(
    settings: &std::collections::BTreeMap<String, String>,
    style: &Style,
) -> Result<Option<u32>, AskError> {
    match settings.get(SETTING).map(String::as_str) {
        None | Some(SOLVER) => Ok((style.mode == Mode::Structured).then_some(1)),
        Some(MODEL) => Ok((style.mode == Mode::Structured).then_some(REFUSALS + 1)),
        Some(ALONE) => Ok(None),
        Some(other) => {
            let message = format!("`{SETTING}`: `{other}` is unknown; allowed: {MODEL}, {ALONE}, {SOLVER}");
            Err(AskError::new(FaultCode::JRequest, message))
        }
    }
}

/// Asks the inner author for everything but paths, and for those until the solver's turn comes.
pub(crate) struct BySolver {
    pub(crate) inner: Box<dyn Author>,
    /// Number of this attempt, from 1.
    pub(crate) asked: u32,
    /// First attempt of the solver.
    pub(crate) from: u32,
}

impl BySolver {
    /// Whether the solver answers: from its attempt on, and as the fallback only where an answer was refused.
    fn answers(&self, question: &Question) -> bool {
        question.stage == Stage::Paths && self.asked >= self.from && (self.from == 1 || !question.feedback.is_empty())
    }
}

#[async_trait]
impl Author for BySolver {
    async fn ask(&self, question: &Question) -> Result<Answer, AskError> {
        match &question.proposal {
            Some(proposal) if self.answers(question) => {
                let mut how = How { by_solver: true, ..How::default() };
                if self.from > 1 {
                    how.steps.push(format!("{REFUSALS} answers of the model were refused: the solver wrote the paths"));
                }
                Ok(Answer { text: answer(question, proposal), model: NAME.to_owned(), how, ..Answer::default() })
            }
            Some(_) | None => self.inner.ask(question).await,
        }
    }

    fn name(&self) -> String {
        self.inner.name()
    }
}

/// The paths of a proposal as text; where there are none, the reason under `cannot`, which is E-CANNOT.
pub(crate) fn answer(question: &Question, proposal: &Proposal) -> String {
    let ways = stated::asked(question)
        .map_or_else(|| by_proposal(question, proposal), |asked| socrates_offline::solve(&asked, proposal));
    match ways.map(|paths| serde_json::to_string_pretty(&paths)) {
        Ok(Ok(text)) => text,
        Ok(Err(why)) => serde_json::json!({ "cannot": why.to_string() }).to_string(),
        Err(miss) => serde_json::json!({ "cannot": miss.to_string() }).to_string(),
    }
}

/// The paths of a proposal whose author stated no scenario: what the task says in words is the model's to read, and stands in the proposal as
/// classes of places.
fn by_proposal(question: &Question, proposal: &Proposal) -> Result<Paths, Miss> {
    let former = question.refused.as_deref().and_then(|text| serde_json::from_str::<Paths>(text).ok());
    let problem = Problem {
        radius_m: question.request.robot.model.radius_m,
        layout: socrates_offline::layout(&proposal.pattern),
        told: Told::of(&question.feedback, former, proposal),
        draw: seeds::derive_seed(question.seed, &["paths"]),
        breadth: question.request.run.breadth,
        ..Problem::of(proposal, &question.location, NAME.into())
    };
    socrates_solver::solve(&problem).map(|solved| solved.paths)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::attempt::{Written, attempt};
    use crate::testing::{Scripted, question};

    fn solver(asked: u32, from: u32) -> BySolver {
        BySolver { inner: Box::new(Scripted::says("no paths")), asked, from }
    }

    #[tokio::test]
    async fn after_two_refusals_of_a_model_the_solver_writes_the_paths_and_says_so() {
        let mut ask = question(Stage::Paths);
        assert!(attempt(&solver(3, 3), &ask).await.is_err(), "nothing was refused: the third try is the model's");
        ask.feedback = vec![socrates_model::Fault::new(FaultCode::GDisc, "robot", "jumps")];
        assert!(attempt(&solver(2, 3), &ask).await.is_err());
        let made = attempt(&solver(3, 3), &ask).await.unwrap();
        assert_eq!(made.exchange.model, NAME);
        assert!(made.exchange.how.steps[0].contains("2 answers of the model were refused"), "{:?}", made.exchange.how);
    }

    #[tokio::test]
    async fn paths_come_from_geometry_and_everything_else_from_the_author() {
        let author = solver(1, 1);
        let made = attempt(&author, &question(Stage::Paths)).await.unwrap();
        let Written::Paths(paths) = &made.written else { panic!("{made:?}") };
        assert_eq!((paths.author.clone(), paths.encounters.len()), (NAME.into(), 2));
        assert_eq!(author.ask(&question(Stage::Proposal)).await.unwrap().text, "no paths");
    }

    #[tokio::test]
    async fn what_does_not_fit_is_said_with_its_numbers() {
        let author = solver(1, 1);
        let mut ask = question(Stage::Paths);
        ask.location.graph = ask.location.graph.edited(|_, edges| edges.retain(|edge| edge.from.as_str() != "c"));
        let refused = attempt(&author, &ask).await.unwrap_err();
        assert_eq!(refused.faults[0].code, FaultCode::ECannot);
        assert!(refused.faults[0].message.to_string().contains(" m "), "{:?}", refused.faults);
    }

    #[test]
    fn a_word_that_means_nobody_is_named() {
        let settings = |word: &str| BTreeMap::from([(SETTING.to_owned(), word.to_owned())]);
        let from = |settings: &BTreeMap<String, String>| solver_from(settings, &Style::default());
        assert_eq!(from(&settings("solver")), Ok(Some(1)));
        assert_eq!((from(&settings("model")), from(&settings("model_alone"))), (Ok(Some(3)), Ok(None)));
        assert_eq!(from(&BTreeMap::new()), Ok(Some(1)));
        assert_eq!(from(&settings("oracle")).unwrap_err().code, FaultCode::JRequest);
        let naive = Style { mode: Mode::Naive, ..Style::default() };
        assert_eq!(solver_from(&BTreeMap::new(), &naive), Ok(None), "a baseline has no net");
    }
}
