//! Recorded exchanges as author, and the recorder that makes them.

use async_trait::async_trait;
use socrates_llm::{Cassette, ChatAnswer, Finish};
use socrates_model::FaultCode;
use socrates_prompts::Question;

use crate::author::{Answer, AskError, Author};
use crate::llm::{chat_request, said};

/// Replays a folder of recorded exchanges byte for byte.
#[derive(Debug, Clone)]
pub struct Replay {
    cassette: Cassette,
    folder: String,
}

impl Replay {
    /// The recordings of this folder.
    #[must_use]
    pub fn from(folder: &str) -> Self {
        Self { cassette: Cassette::at(folder), folder: folder.to_owned() }
    }
}

#[async_trait]
impl Author for Replay {
    async fn ask(&self, question: &Question) -> Result<Answer, AskError> {
        let sent = question.messages();
        // Pictures are drawn from the same map that the text describes, so the text alone is the key.
        let request = chat_request(question, &sent, false)?;
        match self.cassette.find(&request) {
            Ok(Some(answer)) => Ok(said(answer, sent)),
            Ok(None) => Err(AskError::new(
                FaultCode::JRequest,
                format!(
                    "`{}` has no recorded answer to this {} question (key {}); it holds {} exchanges. Record it with \
                     `record:{}=<author>`",
                    self.folder,
                    question.stage,
                    Cassette::key(&request),
                    self.cassette.len(),
                    self.folder
                ),
            )),
            Err(error) => Err(AskError::new(FaultCode::JRequest, error.to_string())),
        }
    }

    fn name(&self) -> String {
        format!("cassette:{}", self.folder)
    }
}

/// Asks another author and keeps every exchange.
pub struct Recorder<A> {
    inner: A,
    cassette: Cassette,
}

impl<A: Author> Recorder<A> {
    /// Keeps the exchanges of `inner` in this folder.
    #[must_use]
    pub fn new(inner: A, folder: &str) -> Self {
        Self { inner, cassette: Cassette::at(folder) }
    }
}

#[async_trait]
impl<A: Author> Author for Recorder<A> {
    async fn ask(&self, question: &Question) -> Result<Answer, AskError> {
        let answer = self.inner.ask(question).await?;
        let request = chat_request(question, &question.messages(), false)?;
        let kept = ChatAnswer {
            text: answer.text.clone(),
            finish: if answer.cut { Finish::Cut } else { Finish::Stop },
            model: answer.model.clone(),
            tokens: answer.tokens,
            estimated: false,
        };
        self.cassette.keep(&request, &kept).map_err(|error| AskError::new(FaultCode::JRequest, error.to_string()))?;
        Ok(answer)
    }

    fn name(&self) -> String {
        self.inner.name()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Scripted, question};
    use socrates_model::job::Stage;

    #[tokio::test]
    async fn a_recorded_answer_is_replayed_and_an_unknown_question_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path().to_str().unwrap();
        let asked = question(Stage::Proposal);
        let answer = Recorder::new(Scripted::says("{\"a\": 1}"), folder).ask(&asked).await.unwrap();
        let replay = Replay::from(folder);
        let again = replay.ask(&asked).await.unwrap();
        assert_eq!((again.text, again.model), (answer.text, answer.model));
        let mut other = asked;
        other.seed += 1;
        let missing = replay.ask(&other).await.unwrap_err();
        assert_eq!(missing.code, FaultCode::JRequest);
        assert!(missing.message.contains("holds 1 exchanges"), "{}", missing.message);
    }
}
