//! The questions that were put, and what a person said to them. Nothing here knows how they come or go.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use serde_json::{Value, json};
use tokio::sync::{mpsc, oneshot};
use tokio::time::Instant;

/// Questions that wait at once, at most: more is a program that asks without end.
pub(super) const WAITING: usize = 64;
/// Questions that are remembered, at most.
const REMEMBERED: usize = 400;
/// Things that the terminal has not said yet, at most; what is more is not said.
const UNSAID: usize = 256;

/// One turn of a prompt.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Turn {
    /// The speaker, as the program names it.
    pub(super) role: String,
    /// What is said.
    pub(super) text: String,
    /// Pictures: addresses that hold them.
    pub(super) pictures: Vec<String>,
}

/// A question as it was put.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Asked {
    /// Model that was named.
    pub(super) model: String,
    /// Name of the form of the answer.
    pub(super) form: String,
    /// Schema of the answer; none where any text will do.
    pub(super) schema: Option<Value>,
    /// The prompt.
    pub(super) turns: Vec<Turn>,
    /// Most tokens of the answer, where the program says.
    pub(super) max_tokens: Option<u64>,
}

/// What a person said.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Said {
    /// An answer, as it was typed.
    Answer(String),
    /// That they cannot answer, and why.
    Refusal(String),
}

/// Where a question stands.
#[derive(Debug)]
enum State {
    Waits(oneshot::Sender<Said>),
    Answered(Said),
    /// Whoever asked is gone.
    Left,
}

/// One question.
#[derive(Debug)]
struct Question {
    asked: Asked,
    at: Instant,
    ended: Option<Instant>,
    state: State,
}

/// What happened, for the terminal.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct News {
    /// Which question.
    pub(super) number: u64,
    /// Name of its form.
    pub(super) form: String,
    /// `waits`, `answered`, `refused` or `left`.
    pub(super) what: &'static str,
}

/// Why nothing came of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub(super) enum DeskError {
    /// Too many wait.
    #[error("{WAITING} questions wait already")]
    Full,
    /// There is no such question.
    #[error("there is no question {0}, or no longer")]
    Unknown(u64),
    /// It does not wait any more.
    #[error("question {0} was answered already, or whoever asked it has left")]
    Over(u64),
}

/// All questions.
#[derive(Debug)]
pub(super) struct Desk {
    questions: Mutex<BTreeMap<u64, Question>>,
    began: Instant,
    news: mpsc::Sender<News>,
}

impl Desk {
    /// An empty desk, and what happens at it.
    pub(super) fn new(now: Instant) -> (Arc<Self>, mpsc::Receiver<News>) {
        let (news, said) = mpsc::channel(UNSAID);
        (Arc::new(Self { questions: Mutex::default(), began: now, news }), said)
    }

    fn questions(&self) -> MutexGuard<'_, BTreeMap<u64, Question>> {
        self.questions.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Puts a question; gives its number and where the answer comes.
    ///
    /// # Errors
    /// [`DeskError::Full`].
    pub(super) fn put(&self, asked: Asked, now: Instant) -> Result<(u64, oneshot::Receiver<Said>), DeskError> {
        let mut questions = self.questions();
        if questions.values().filter(|one| matches!(one.state, State::Waits(_))).count() >= WAITING {
            return Err(DeskError::Full);
        }
        let number = questions.last_key_value().map_or(1, |(number, _)| number + 1);
        let (sender, receiver) = oneshot::channel();
        self.say(number, &asked.form, "waits");
        questions.insert(number, Question { asked, at: now, ended: None, state: State::Waits(sender) });
        let old = questions.iter().find(|(_, one)| !matches!(one.state, State::Waits(_))).map(|(number, _)| *number);
        if let Some(old) = old.filter(|_| questions.len() > REMEMBERED) {
            questions.remove(&old);
        }
        Ok((number, receiver))
    }

    /// Hands on what a person said.
    ///
    /// # Errors
    /// [`DeskError::Unknown`], [`DeskError::Over`].
    pub(super) fn settle(&self, number: u64, said: Said, now: Instant) -> Result<(), DeskError> {
        let mut questions = self.questions();
        let question = questions.get_mut(&number).ok_or(DeskError::Unknown(number))?;
        if !matches!(question.state, State::Waits(_)) {
            return Err(DeskError::Over(number));
        }
        let State::Waits(sender) = std::mem::replace(&mut question.state, State::Answered(said.clone())) else {
            return Err(DeskError::Over(number));
        };
        question.ended = Some(now);
        let what = if matches!(said, Said::Answer(_)) { "answered" } else { "refused" };
        if sender.send(said).is_err() {
            question.state = State::Left;
            return Err(DeskError::Over(number));
        }
        self.say(number, &question.asked.form, what);
        Ok(())
    }

    /// Whoever asked has left; nothing for a question that was answered.
    pub(super) fn leave(&self, number: u64, now: Instant) {
        if let Some(question) = self.questions().get_mut(&number)
            && matches!(question.state, State::Waits(_))
        {
            question.state = State::Left;
            question.ended = Some(now);
            self.say(number, &question.asked.form, "left");
        }
    }

    /// The schema of a question.
    ///
    /// # Errors
    /// [`DeskError::Unknown`].
    pub(super) fn schema(&self, number: u64) -> Result<Option<Value>, DeskError> {
        self.questions().get(&number).map(|one| one.asked.schema.clone()).ok_or(DeskError::Unknown(number))
    }

    /// Every question in a line, for the list of the page.
    pub(super) fn list(&self, now: Instant) -> Value {
        let questions = self.questions();
        let lines = questions.iter().map(|(number, question)| {
            json!({
                "number": number,
                "form": question.asked.form,
                "model": question.asked.model,
                "state": question.state.name(),
                "waited_s": (question.ended.unwrap_or(now) - question.at).as_secs(),
            })
        });
        json!({"questions": lines.collect::<Vec<_>>(), "up_s": (now - self.began).as_secs()})
    }

    /// All of one question.
    ///
    /// # Errors
    /// [`DeskError::Unknown`].
    pub(super) fn one(&self, number: u64, now: Instant) -> Result<Value, DeskError> {
        let questions = self.questions();
        let question = questions.get(&number).ok_or(DeskError::Unknown(number))?;
        let turn = |turn: &Turn| json!({"role": turn.role, "text": turn.text, "pictures": turn.pictures});
        let (answer, refusal) = match &question.state {
            State::Answered(Said::Answer(text)) => (Some(text), None),
            State::Answered(Said::Refusal(why)) => (None, Some(why)),
            State::Waits(_) | State::Left => (None, None),
        };
        Ok(json!({
            "number": number,
            "form": question.asked.form,
            "model": question.asked.model,
            "state": question.state.name(),
            "waited_s": (question.ended.unwrap_or(now) - question.at).as_secs(),
            "max_tokens": question.asked.max_tokens,
            // As text, whose members stand in the order in which they are to be written.
            "schema": question.asked.schema.as_ref().map(socrates_llm::ordered::text),
            "turns": question.asked.turns.iter().map(turn).collect::<Vec<_>>(),
            "answer": answer,
            "refusal": refusal,
        }))
    }

    fn say(&self, number: u64, form: &str, what: &'static str) {
        // Where the terminal does not keep up, the page still shows everything.
        drop(self.news.try_send(News { number, form: form.to_owned(), what }));
    }
}

impl State {
    const fn name(&self) -> &'static str {
        match self {
            Self::Waits(_) => "waits",
            Self::Answered(Said::Answer(_)) => "answered",
            Self::Answered(Said::Refusal(_)) => "refused",
            Self::Left => "left",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asked(form: &str) -> Asked {
        let turn = Turn { role: "user".to_owned(), text: "?".to_owned(), pictures: Vec::new() };
        Asked { model: "m".to_owned(), form: form.to_owned(), schema: None, turns: vec![turn], max_tokens: None }
    }

    #[test]
    fn a_question_is_answered_once_and_keeps_its_answer() {
        let now = Instant::now();
        let (desk, mut news) = Desk::new(now);
        let (number, mut answer) = desk.put(asked("paths"), now).unwrap();
        assert_eq!(desk.one(number, now).unwrap()["state"], "waits");
        desk.settle(number, Said::Answer("{}".to_owned()), now).unwrap();
        assert_eq!(answer.try_recv().unwrap(), Said::Answer("{}".to_owned()));
        assert_eq!(desk.settle(number, Said::Refusal(String::new()), now), Err(DeskError::Over(number)));
        // The end of its connection changes nothing any more.
        desk.leave(number, now);
        let one = desk.one(number, now).unwrap();
        assert_eq!((&one["state"], &one["answer"]), (&json!("answered"), &json!("{}")));
        assert_eq!(desk.settle(9, Said::Answer(String::new()), now), Err(DeskError::Unknown(9)));
        let told: Vec<&str> = std::iter::from_fn(|| news.try_recv().ok()).map(|news| news.what).collect();
        assert_eq!(told, ["waits", "answered"]);
    }

    #[test]
    fn whoever_leaves_cannot_be_answered_and_takes_no_place() {
        let now = Instant::now();
        let (desk, _news) = Desk::new(now);
        let kept: Vec<_> = (0..WAITING).map(|_| desk.put(asked("a"), now).unwrap()).collect();
        assert_eq!(desk.put(asked("a"), now).unwrap_err(), DeskError::Full);
        desk.leave(kept[0].0, now);
        assert_eq!(desk.settle(kept[0].0, Said::Answer(String::new()), now), Err(DeskError::Over(kept[0].0)));
        let (number, receiver) = desk.put(asked("a"), now).unwrap();
        drop(receiver);
        assert_eq!(desk.settle(number, Said::Answer(String::new()), now), Err(DeskError::Over(number)));
        assert_eq!(desk.list(now)["questions"].as_array().unwrap().len(), WAITING + 1);
    }

    #[test]
    fn old_answers_are_forgotten_and_waiting_questions_are_not() {
        let now = Instant::now();
        let (desk, _news) = Desk::new(now);
        let (first, _receiver) = desk.put(asked("a"), now).unwrap();
        for _ in 0..REMEMBERED + 10 {
            let (number, receiver) = desk.put(asked("b"), now).unwrap();
            desk.settle(number, Said::Answer(String::new()), now).unwrap();
            drop(receiver);
        }
        assert_eq!(desk.list(now)["questions"].as_array().unwrap().len(), REMEMBERED);
        assert_eq!(desk.one(first, now).unwrap()["state"], "waits");
    }
}
