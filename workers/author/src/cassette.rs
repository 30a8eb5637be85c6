//! Recorded exchanges as author, and the recorder that makes them.

use async_trait::async_trait;
use socrates_llm::{Cassette, ChatAnswer, ChatRequest, Finish, Nearest};
use socrates_model::FaultCode;
use socrates_prompts::{Image, Prompt, Question, Style};

use crate::author::{Answer, AskError, Author};
use crate::llm::{MAX_TOKENS, chat_request, said};
use crate::passing;

/// The request that stands for a question in a folder: without picture, as it is drawn from the map that the text describes,
/// and without anything that depends on the server.
fn recorded_as(question: &Question, style: Style) -> Result<(ChatRequest, Prompt), AskError> {
    let prompt = passing::asked(question, style.mode).prompt(&style);
    let request = chat_request(question, &prompt, Image::Off, MAX_TOKENS)?;
    Ok((request, prompt))
}

fn unusable(error: &dyn std::error::Error) -> AskError {
    AskError::new(FaultCode::JRequest, error.to_string())
}

/// Replays a folder of recorded exchanges byte for byte.
pub struct Replay {
    cassette: Cassette,
    folder: String,
    style: Style,
    other: Option<Box<dyn Author>>,
}

impl Replay {
    /// The recordings of this folder.
    #[must_use]
    pub fn new(folder: &str, style: Style) -> Self {
        Self { cassette: Cassette::at(folder), folder: folder.to_owned(), style, other: None }
    }

    /// Asks somebody else what is not recorded, and records it; the offline author's answers need no recording.
    #[must_use]
    pub fn or_else(mut self, author: Box<dyn Author>) -> Self {
        self.other = Some(author);
        self
    }
}

#[async_trait]
impl Author for Replay {
    async fn ask(&self, question: &Question) -> Result<Answer, AskError> {
        let (request, prompt) = recorded_as(question, self.style)?;
        if let Some(answer) = self.cassette.find(&request).map_err(|error| unusable(&error))? {
            return Ok(said(answer, prompt, self.style));
        }
        let Some(other) = &self.other else {
            let near = self.cassette.nearest(&request).map(|near| told(&near, &prompt.template.id)).unwrap_or_default();
            let what = format!("{} question", question.stage);
            return Err(not_recorded(&self.folder, &self.cassette, &request, (&what, "author"), &near));
        };
        let answer = other.ask(question).await?;
        if other.name() != socrates_offline::NAME {
            keep(&self.cassette, &request, &answer, Some(&prompt.template.id))?;
        }
        Ok(answer)
    }

    fn name(&self) -> String {
        match &self.other {
            None => format!("cassette:{}", self.folder),
            Some(other) => format!("replay:{}={}", self.folder, other.name()),
        }
    }
}

/// Asks another author and keeps every exchange.
pub struct Recorder<A> {
    inner: A,
    cassette: Cassette,
    style: Style,
}

impl<A: Author> Recorder<A> {
    /// Keeps the exchanges of `inner` in this folder.
    #[must_use]
    pub fn new(inner: A, folder: &str, style: Style) -> Self {
        Self { inner, cassette: Cassette::at(folder), style }
    }
}

#[async_trait]
impl<A: Author> Author for Recorder<A> {
    async fn ask(&self, question: &Question) -> Result<Answer, AskError> {
        let answer = self.inner.ask(question).await?;
        let (request, prompt) = recorded_as(question, self.style)?;
        keep(&self.cassette, &request, &answer, Some(&prompt.template.id))?;
        Ok(answer)
    }

    fn name(&self) -> String {
        self.inner.name()
    }
}

/// A question that a folder has no answer to: what is asked, by whom it can be recorded, and words about the nearest recording.
pub(crate) fn not_recorded(
    folder: &str,
    cassette: &Cassette,
    request: &ChatRequest,
    (what, by): (&str, &str),
    near: &str,
) -> AskError {
    let (key, held) = (Cassette::key(request), cassette.len());
    let message = format!(
        "`{folder}` has no recorded answer to this {what} (key {key}); it holds {held} exchanges{near}. Record it with \
         `record:{folder}=<{by}>`"
    );
    AskError::new(FaultCode::JRequest, message)
}

/// In what the nearest recording differs.
pub(crate) fn differs(near: &Nearest) -> String {
    let key: String = near.key.chars().take(12).collect();
    format!("; the nearest, {key}, differs in {}", near.differs.join(", "))
}

/// What is said of the nearest recording; where its rules are those of another version of the program, which.
fn told(near: &Nearest, template: &str) -> String {
    let differs = differs(near);
    // The second turn holds the rules, which depend on nothing but the version and the style.
    if !near.differs.iter().any(|name| name == "turns[1]") {
        return differs;
    }
    let version = match near.note.as_deref() {
        None => "an earlier version".to_owned(),
        Some(note) if note == template => return format!("{differs} (the rules of another style)"),
        Some(note) => format!("the version that asks with `{note}`"),
    };
    format!(
        "{differs}; it was recorded by {version}, this program asks with `{template}`: replay it with that version, or record anew"
    )
}

fn keep(cassette: &Cassette, request: &ChatRequest, answer: &Answer, template: Option<&str>) -> Result<(), AskError> {
    let kept = ChatAnswer {
        text: answer.text.clone(),
        finish: if answer.cut { Finish::Cut } else { Finish::Stop },
        model: answer.model.clone(),
        tokens: answer.tokens,
        cached: answer.how.cached,
        thought: answer.how.thought,
        estimated: answer.how.estimated,
        rung: answer.how.rung.as_deref().and_then(|name| name.parse().ok()),
        steps: answer.how.steps.clone(),
        // What is kept has no picture in any case.
        without_picture: false,
        limits: answer.how.limits,
    };
    cassette.keep(request, &kept, template).map_err(|error| unusable(&error))
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
        let style = Style::default();
        let asked = question(Stage::Proposal);
        let answer = Recorder::new(Scripted::says("{\"a\": 1}"), folder, style).ask(&asked).await.unwrap();
        let replay = Replay::new(folder, style);
        let again = replay.ask(&asked).await.unwrap();
        assert_eq!((again.text, again.model), (answer.text, answer.model));
        let mut other = asked;
        other.seed += 1;
        let missing = replay.ask(&other).await.unwrap_err();
        assert_eq!(missing.code, FaultCode::JRequest);
        assert!(missing.message.contains("holds 1 exchanges; the nearest, "), "{}", missing.message);
        assert!(missing.message.contains("differs in seed."), "{}", missing.message);
    }

    #[tokio::test]
    async fn a_recording_of_another_version_says_which_version_it_needs() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path().to_str().unwrap();
        let asked = question(Stage::Proposal);
        let (mut request, prompt) = recorded_as(&asked, Style::default()).unwrap();
        request.turns[1].text.push_str("\nAn older rule.");
        let answer = Answer { text: "{}".to_owned(), ..Answer::default() };
        for (note, words) in
            [(Some("proposal/1"), "by the version that asks with `proposal/1`"), (None, "by an earlier version")]
        {
            keep(&Cassette::at(folder), &request, &answer, note).unwrap();
            let missing = Replay::new(folder, Style::default()).ask(&asked).await.unwrap_err().message;
            assert!(missing.contains(words), "{missing}");
            assert!(missing.contains(&format!("this program asks with `{}`", prompt.template.id)), "{missing}");
        }
    }

    #[tokio::test]
    async fn what_is_not_recorded_may_be_asked_of_somebody_else_once() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path().to_str().unwrap();
        let style = Style::default();
        let asked = question(Stage::Proposal);
        let first = Replay::new(folder, style).or_else(Box::new(Scripted::says("{\"a\": 1}")));
        assert_eq!(first.ask(&asked).await.unwrap().text, "{\"a\": 1}");
        let second = Replay::new(folder, style).or_else(Box::new(Scripted::says("{\"a\": 2}")));
        assert_eq!(second.ask(&asked).await.unwrap().text, "{\"a\": 1}");
        // The offline author answers the same for ever; nothing of it is kept.
        let mut other = asked;
        other.seed += 1;
        Replay::new(folder, style).or_else(Box::new(crate::offline::Offline)).ask(&other).await.unwrap();
        assert_eq!(Cassette::at(folder).len(), 1);
    }
}
