//! The offline author: rules instead of a model.

use async_trait::async_trait;
use socrates_prompts::Question;

use crate::author::{Answer, AskError, Author};

/// Answers by rules, without network or key. The same question has the same answer.
#[derive(Debug, Clone, Copy, Default)]
pub struct Offline;

#[async_trait]
impl Author for Offline {
    async fn ask(&self, question: &Question) -> Result<Answer, AskError> {
        let text = socrates_offline::Offline::answer(question);
        Ok(Answer { text, model: self.name(), ..Answer::default() })
    }

    fn name(&self) -> String {
        socrates_offline::NAME.to_owned()
    }
}
