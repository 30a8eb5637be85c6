//! A language model as author.

use async_trait::async_trait;
use socrates_llm::{ChatAnswer, ChatClient, ChatError, ChatRequest, ClientConfig, Finish, Speaker, Structured, Turn};
use socrates_model::FaultCode;
use socrates_prompts::{Message, Picture, Question, Role, answer_schema};

use crate::author::{Answer, AskError, Author};

/// Most tokens of an answer. The largest answers, proposals of many humans, take about a third.
const MAX_TOKENS: u32 = 16_000;
/// Scale of the map picture, pixels per drawing unit.
const PICTURE_SCALE: f32 = 1.0;

/// A language model behind a Chat Completions server.
#[derive(Debug, Clone)]
pub struct Llm {
    client: ChatClient,
    name: String,
    pictures: bool,
}

impl Llm {
    /// The model that this configuration reaches; `pictures` tells whether it is shown the map.
    ///
    /// # Errors
    /// [`AskError`] `J-REQUEST` when the address cannot be used.
    pub fn new(config: ClientConfig, pictures: bool) -> Result<Self, AskError> {
        let name = format!("openai:{}", config.model);
        let client = ChatClient::new(config).map_err(|error| ask_error(&error))?;
        Ok(Self { client, name, pictures })
    }

    /// The enforcement of the answer's form by name: `schema`, `object`, `plain`.
    #[must_use]
    pub fn structured(name: &str) -> Option<Structured> {
        match name {
            "schema" => Some(Structured::Schema),
            "object" => Some(Structured::Object),
            "plain" => Some(Structured::Plain),
            _ => None,
        }
    }
}

#[async_trait]
impl Author for Llm {
    async fn ask(&self, question: &Question) -> Result<Answer, AskError> {
        let sent = question.messages();
        let request = chat_request(question, &sent, self.pictures)?;
        let answer = self.client.ask(&request).await.map_err(|error| ask_error(&error))?;
        let answer = ChatAnswer { model: format!("openai:{}", answer.model), ..answer };
        Ok(said(answer, sent))
    }

    fn name(&self) -> String {
        self.name.clone()
    }
}

/// The question in the words of the client. A picture is drawn where a message asks for one.
///
/// # Errors
/// [`AskError`] when the map cannot be drawn.
pub(crate) fn chat_request(question: &Question, messages: &[Message], pictures: bool) -> Result<ChatRequest, AskError> {
    let mut turns = Vec::new();
    for message in messages {
        let speaker = match message.role {
            Role::System => Speaker::System,
            Role::User => Speaker::User,
            Role::Assistant => Speaker::Assistant,
        };
        let png = match message.image {
            Some(Picture::AnnotatedMap) if pictures => {
                let svg = socrates_draw::annotated_map(&question.location);
                let png = socrates_draw::png_from_svg(&svg, PICTURE_SCALE)
                    .map_err(|error| AskError::new(FaultCode::JRequest, format!("the map cannot be drawn: {error}")))?;
                Some(png)
            }
            Some(Picture::AnnotatedMap) | None => None,
        };
        turns.push(Turn { speaker, text: message.text.clone(), png });
    }
    Ok(ChatRequest {
        turns,
        form: question.stage.name().to_owned(),
        schema: Some(answer_schema(question)),
        seed: Some(question.seed),
        temperature: None,
        max_tokens: MAX_TOKENS,
    })
}

/// A chat answer as an author's answer.
pub(crate) fn said(answer: ChatAnswer, sent: Vec<Message>) -> Answer {
    Answer {
        text: answer.text,
        tokens: answer.tokens,
        model: answer.model,
        cut: answer.finish == Finish::Cut,
        sent,
        injected: Vec::new(),
    }
}

/// The client's error with the code that the orchestrator knows.
pub(crate) fn ask_error(error: &ChatError) -> AskError {
    let (code, retry_after_ms) = match error {
        ChatError::Unreachable { .. } => (FaultCode::TNet, None),
        ChatError::Timeout { .. } => (FaultCode::TTimeout, None),
        ChatError::SlowDown { retry_after_ms, .. } => (FaultCode::T429, *retry_after_ms),
        ChatError::Server { retry_after_ms, .. } => (FaultCode::T5xx, *retry_after_ms),
        // A proxy's page in place of an answer passes like any other trouble of a server.
        ChatError::Unreadable { .. } => (FaultCode::T5xx, None),
        ChatError::Key { .. } | ChatError::Rejected { .. } => (FaultCode::TAuth, None),
        ChatError::TooLarge { .. } => (FaultCode::TOversize, None),
        ChatError::Refused { .. } => (FaultCode::ERefusal, None),
        ChatError::Setup { .. } => (FaultCode::JRequest, None),
    };
    AskError { code, message: error.to_string(), retry_after_ms }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::question;
    use socrates_model::job::Stage;

    #[test]
    fn a_picture_is_drawn_only_for_models_that_see() {
        let asked = question(Stage::Paths);
        let pictures = |see| {
            let request = chat_request(&asked, &asked.messages(), see).unwrap();
            request.turns.iter().filter_map(|turn| turn.png.clone()).collect::<Vec<_>>()
        };
        assert!(pictures(false).is_empty());
        assert_eq!(pictures(true)[0].get(1..4), Some(b"PNG".as_slice()));
    }

    #[test]
    fn a_wish_to_wait_goes_on_to_the_orchestrator() {
        let error = ChatError::SlowDown { status: 429, retry_after_ms: Some(1500), why: "slow".into() };
        let told = ask_error(&error);
        assert_eq!((told.code, told.retry_after_ms), (FaultCode::T429, Some(1500)));
    }
}
