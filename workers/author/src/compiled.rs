//! An author whose behaviors are compiled: what the proposal states as rules is not asked for again.

use async_trait::async_trait;
use serde_json::json;
use socrates_model::job::{BEHAVIORS_BY, BY_PROPOSAL, Stage};
use socrates_model::{FaultCode, Proposal};
use socrates_prompts::{BehaviorsForm, Mode, Question, Style};

use crate::author::{Answer, AskError, Author};

/// Name under which artifacts say that nobody was asked.
pub const NAME: &str = "compiled/1";

/// Whether an author that is asked in this style leaves behaviors to the compiler: it writes rules in its proposal, and is asked for trees only
/// where it writes them freely.
#[must_use]
pub const fn compiles(style: &Style) -> bool {
    matches!((style.mode, style.behaviors), (Mode::Structured, BehaviorsForm::Rules))
}

/// Whether the settings of a job have behaviors compiled; authors are asked without the setting.
///
/// # Errors
/// `J-REQUEST` for another word.
pub(crate) fn by_proposal(settings: &std::collections::BTreeMap<String, String>) -> Result<bool, AskError> {
    match settings.get(BEHAVIORS_BY).map(String::as_str) {
        None => Ok(false),
        Some(BY_PROPOSAL) => Ok(true),
        Some(other) => {
            let message = format!("`{BEHAVIORS_BY}`: `{other}` is unknown; allowed: {BY_PROPOSAL}, or no such setting");
            Err(AskError::new(FaultCode::JRequest, message))
        }
    }
}

/// Asks the inner author for everything but behaviors.
pub(crate) struct Compiled {
    pub(crate) inner: Box<dyn Author>,
}

#[async_trait]
impl Author for Compiled {
    async fn ask(&self, question: &Question) -> Result<Answer, AskError> {
        match &question.proposal {
            Some(proposal) if question.stage == Stage::Behaviors => {
                Ok(Answer { text: answer(question, proposal), model: NAME.to_owned(), ..Answer::default() })
            }
            Some(_) | None => self.inner.ask(question).await,
        }
    }

    fn name(&self) -> String {
        self.inner.name()
    }
}

/// The rules of the proposal as an answer to the behaviors question.
fn answer(question: &Question, proposal: &Proposal) -> String {
    let humans: serde_json::Map<String, serde_json::Value> = question
        .humans(proposal)
        .into_iter()
        .map(|human| (human.id.to_string(), json!({"description": human.behavior, "rules": human.rules})))
        .collect();
    json!({ "humans": humans }).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::attempt::{Written, attempt};
    use crate::testing::{Scripted, proposal, question};

    #[tokio::test]
    async fn the_rules_of_the_proposal_are_played_and_nobody_is_asked() {
        let author = Compiled { inner: Box::new(Scripted::says("I was asked")) };
        let made = attempt(&author, &question(Stage::Behaviors)).await.unwrap();
        let Written::Behaviors(behaviors) = &made.written else { panic!() };
        assert_eq!(behaviors.humans.len(), proposal().humans.len());
        assert_eq!(behaviors.author, NAME.into());
        let refused = attempt(&author, &question(Stage::Paths)).await.unwrap_err();
        assert_eq!(refused.text.as_deref(), Some("I was asked"));
    }

    #[test]
    fn a_word_that_means_nothing_is_named() {
        let settings = |word: &str| std::collections::BTreeMap::from([(BEHAVIORS_BY.to_owned(), word.to_owned())]);
        assert_eq!(by_proposal(&settings(BY_PROPOSAL)), Ok(true));
        assert_eq!(by_proposal(&std::collections::BTreeMap::new()), Ok(false));
        assert_eq!(by_proposal(&settings("oracle")).unwrap_err().code, FaultCode::JRequest);
    }

    #[test]
    fn trees_that_are_written_freely_are_asked_for() {
        assert!(compiles(&Style::default()));
        for other in [
            Style { behaviors: BehaviorsForm::Xml, ..Style::default() },
            Style { behaviors: BehaviorsForm::JsonTree, ..Style::default() },
            Style { mode: Mode::Naive, ..Style::default() },
        ] {
            assert!(!compiles(&other), "{other:?}");
        }
    }
}
