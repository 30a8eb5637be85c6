//! A question with a picture, put to a language model or to recordings of one: outside of any job, with everything that was answered for
//! the books. The smallest door to the client for those who ask about what is drawn.

use serde_json::Value;
use socrates_llm::{Cassette, ChatAnswer, ChatClient, ChatError, ChatRequest, Detail, Objection, Turn};
use socrates_model::{AuthorSpec, FaultCode};
use socrates_prompts::Message;

use crate::author::{Answer, AskError, How};
use crate::cassette::{differs, not_recorded};
use crate::llm::{MAX_TOKENS, answered, ask_error, merged, turn};
use crate::settings::{Keys, read, seeing_client};

/// Times that a question is put where its answers cannot be read.
pub const ASKS: usize = 3;

/// A question about a picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Pictured {
    /// Name of the form of the answer, `[A-Za-z0-9_-]{1,64}`.
    pub form: String,
    /// The messages; the picture goes with the last one.
    pub messages: Vec<Message>,
    /// The picture, PNG.
    pub png: Vec<u8>,
    /// JSON schema that the answer should keep.
    pub schema: Value,
    /// Seed for servers that take one; another one is another question, also to recordings.
    pub seed: u64,
}

/// What came of a question.
#[derive(Debug)]
pub struct Looked<T> {
    /// Every answer that came, with its tokens: those that could not be read too.
    pub answers: Vec<Answer>,
    /// The answer as it was read; nothing where none of [`ASKS`] could be; or why none came.
    pub read: Result<Option<T>, AskError>,
}

/// One who is shown pictures: a model behind a server, recordings, or both.
#[derive(Debug, Clone)]
pub struct Onlooker {
    name: String,
    server: Option<ChatClient>,
    /// Looked through before the server is asked.
    replays: Vec<(String, Cassette)>,
    /// Every answer is kept there; answers of the server in `replays` as well.
    records: Vec<Cassette>,
    max_tokens: u32,
}

impl Onlooker {
    /// The one that a setting means: a server, `cassette:`, `record:` or `replay:`.
    ///
    /// # Errors
    /// [`AskError`]: `J-REQUEST` for a setting that sees no pictures or means nobody, `T-AUTH` for a server of others without a key.
    pub fn new(setting: &str, keys: &Keys) -> Result<Self, AskError> {
        let spec = read(setting)?;
        let max_tokens = keys.max_tokens.unwrap_or(MAX_TOKENS);
        let (mut replays, mut records, mut asked) = (Vec::new(), Vec::new(), &spec);
        let server = loop {
            match asked {
                AuthorSpec::Auto | AuthorSpec::Offline => {
                    let message = format!(
                        "`{asked}` sees no pictures; allowed: anthropic:<model>, openai:<model>, ollama:<model> and the like, \
                         cassette:<folder>, record:<folder>=<model>, replay:<folder>=<model>"
                    );
                    return Err(AskError::new(FaultCode::JRequest, message));
                }
                AuthorSpec::Cassette(folder) => {
                    replays.push((folder.clone(), Cassette::at(folder)));
                    break None;
                }
                AuthorSpec::Record(folder, inner) => {
                    records.push(Cassette::at(folder));
                    asked = inner;
                }
                AuthorSpec::Replay(folder, inner) => {
                    replays.push((folder.clone(), Cassette::at(folder)));
                    asked = inner;
                }
                AuthorSpec::Server(kind, model) => break Some(seeing_client(*kind, model, keys)?),
            }
        };
        Ok(Self { name: asked.to_string(), server, replays, records, max_tokens })
    }

    /// Name of the model, such as `openai:gpt-4o`, or of the recordings where there is no server behind them.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Asks about a picture. An answer that cannot be read is told so and asked for again, [`ASKS`] times in all.
    pub async fn ask<T>(&self, asked: &Pictured, read: impl Fn(&str) -> Result<T, Vec<String>>) -> Looked<T> {
        let mut turns: Vec<Turn> = asked.messages.iter().map(turn).collect();
        if let Some(last) = turns.last_mut() {
            last.png = Some(asked.png.clone());
        }
        let mut answers = Vec::new();
        for _ in 0..ASKS {
            let request = ChatRequest {
                turns: merged(turns.clone()),
                form: asked.form.clone(),
                schema: Some(asked.schema.clone()),
                grammar: None,
                seed: Some(asked.seed),
                temperature: None,
                max_tokens: MAX_TOKENS,
                detail: Detail::High,
            };
            let answer = match self.answered(&request).await {
                Ok(answer) => answer,
                Err(why) => return Looked { answers, read: Err(why) },
            };
            let found = read(&answer.text);
            let text = answer.text.clone();
            answers.push(booked(answer, &asked.png));
            match found {
                Ok(value) => return Looked { answers, read: Ok(Some(value)) },
                Err(why) => turns.extend(again(&text, &why)),
            }
        }
        Looked { answers, read: Ok(None) }
    }

    /// One answer: a recorded one, else the server's, which is kept.
    async fn answered(&self, request: &ChatRequest) -> Result<ChatAnswer, AskError> {
        let unusable =
            |why: &dyn std::error::Error| AskError::new(FaultCode::JRequest, format!("`{}`: {why}", self.name));
        for (_, cassette) in &self.replays {
            if let Some(answer) = cassette.find(request).map_err(|why| unusable(&why))? {
                self.keep(request, &answer, &self.records).map_err(|why| unusable(&why))?;
                return Ok(answer);
            }
        }
        let Some(server) = &self.server else { return Err(self.not_recorded(request)) };
        let sent = ChatRequest { max_tokens: self.max_tokens, ..request.clone() };
        let answer = server.ask(&sent).await.map_err(|why| self.unanswered(&why))?;
        let model = format!("{}:{}", self.name.split_once(':').map_or("", |(kind, _)| kind), answer.model);
        let answer = ChatAnswer { model, ..answer };
        self.keep(request, &answer, self.replays.iter().map(|(_, cassette)| cassette).chain(&self.records))
            .map_err(|why| unusable(&why))?;
        Ok(answer)
    }

    fn keep<'a>(
        &self,
        request: &ChatRequest,
        answer: &ChatAnswer,
        places: impl IntoIterator<Item = &'a Cassette>,
    ) -> Result<(), socrates_llm::CassetteError> {
        places.into_iter().try_for_each(|cassette| cassette.keep(request, answer, Some(&request.form)))
    }

    fn not_recorded(&self, request: &ChatRequest) -> AskError {
        let Some((folder, cassette)) = self.replays.first() else {
            return AskError::new(FaultCode::JRequest, format!("`{}` is nobody who can be asked", self.name));
        };
        let near = cassette.nearest(request).map(|near| differs(&near)).unwrap_or_default();
        not_recorded(folder, cassette, request, ("question", "model"), &near)
    }

    /// Why the server gave no answer, with the name of the model. One that takes no picture is never asked without.
    fn unanswered(&self, why: &ChatError) -> AskError {
        let name = &self.name;
        match why {
            ChatError::Rejected { to: Objection::Picture, .. } | ChatError::Server { to: Objection::Picture, .. } => {
                let message =
                    format!("the model `{name}` takes no picture, so it cannot be asked what one shows: {why}");
                AskError::new(FaultCode::JRequest, message)
            }
            ChatError::Rejected { .. }
            | ChatError::Server { .. }
            | ChatError::Unreachable { .. }
            | ChatError::Timeout { .. }
            | ChatError::Late { .. }
            | ChatError::Broken { .. }
            | ChatError::SlowDown { .. }
            | ChatError::Key { .. }
            | ChatError::TooLarge { .. }
            | ChatError::Refused { .. }
            | ChatError::Unreadable { .. }
            | ChatError::Setup { .. } => {
                let error = ask_error(why);
                AskError { message: format!("`{name}`: {}", error.message), ..error }
            }
        }
    }
}

/// The turns after an answer that cannot be used: the answer, and why.
fn again(answer: &str, why: &[String]) -> impl Iterator<Item = Turn> {
    socrates_prompts::opinion::again(answer, why).into_iter().map(|message| turn(&message))
}

/// An answer for the books.
fn booked(answer: ChatAnswer, png: &[u8]) -> Answer {
    let plain = answered(answer);
    let how = How { picture: Some(socrates_llm::estimate::png_size(png)), ..plain.how };
    Answer { how, ..plain }
}

#[cfg(test)]
mod tests {
    use std::io::{Read as _, Write as _};
    use std::net::{TcpListener, TcpStream};

    use serde_json::json;
    use socrates_llm::Dialect;
    use socrates_prompts::Role;

    use super::*;
    use crate::settings::Server;

    fn asked(seed: u64) -> Pictured {
        // The head of a PNG of 3 x 2.
        let mut png = vec![0x89, b'P', b'N', b'G', 13, 10, 26, 10, 0, 0, 0, 13, b'I', b'H', b'D', b'R'];
        png.extend([0, 0, 0, 3, 0, 0, 0, 2]);
        Pictured {
            form: "opinion".to_owned(),
            messages: vec![Message::text(Role::System, "Look."), Message::text(Role::User, "What is there?")],
            png,
            schema: json!({"type": "object"}),
            seed,
        }
    }

    fn request(socket: &mut TcpStream) -> String {
        let (mut head, mut byte) = (Vec::new(), [0]);
        while !head.ends_with(b"\r\n\r\n") && socket.read_exact(&mut byte).is_ok() {
            head.extend(byte);
        }
        let head = String::from_utf8_lossy(&head).to_lowercase();
        let length = head.lines().find_map(|line| line.strip_prefix("content-length: ")?.trim().parse().ok());
        let mut body = vec![0; length.unwrap_or(0)];
        socket.read_exact(&mut body).unwrap();
        String::from_utf8(body).unwrap()
    }

    /// A server that answers one question after the other; gives its address and, once they came, the questions.
    fn server(replies: Vec<(u16, String)>) -> (Keys, std::thread::JoinHandle<Vec<String>>) {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let url = format!("http://{}/v1", listener.local_addr().unwrap());
        let seen = std::thread::spawn(move || {
            let one = |(status, body): (u16, String)| {
                let (mut socket, _) = listener.accept().unwrap();
                let question = request(&mut socket);
                let head = format!("HTTP/1.1 {status} X\r\ncontent-type: application/json\r\nconnection: close\r\n");
                socket.write_all(format!("{head}content-length: {}\r\n\r\n{body}", body.len()).as_bytes()).unwrap();
                question
            };
            replies.into_iter().map(one).collect()
        });
        let server = Server { key: None, url: Some(url) };
        (Keys { servers: [(Dialect::Vllm, server)].into(), in_one_piece: true, ..Keys::default() }, seen)
    }

    fn chat(text: &str) -> (u16, String) {
        let message = json!({"role": "assistant", "content": text});
        let usage = json!({"prompt_tokens": 700, "completion_tokens": 9});
        let body = json!({"model": "eye", "choices": [{"message": message, "finish_reason": "stop"}], "usage": usage});
        (200, body.to_string())
    }

    fn number(text: &str) -> Result<u32, Vec<String>> {
        text.parse().map_err(|_why| vec![format!("`{text}` is no number")])
    }

    #[tokio::test]
    async fn an_answer_that_cannot_be_read_is_asked_for_again_and_every_answer_is_booked() {
        let (keys, seen) = server(vec![chat("many"), chat("7")]);
        let looked = Onlooker::new("vllm:eye", &keys).unwrap().ask(&asked(1), number).await;
        assert_eq!(looked.read.unwrap(), Some(7));
        let tokens: Vec<(u64, u64)> = looked.answers.iter().map(|answer| answer.tokens).collect();
        assert_eq!(tokens, [(700, 9), (700, 9)]);
        assert_eq!((looked.answers[0].model.as_str(), looked.answers[0].how.picture), ("vllm:eye", Some((3, 2))));
        let seen = seen.join().unwrap();
        assert!(seen.iter().all(|question| question.contains("data:image/png;base64,")), "{seen:?}");
        assert!(seen[1].contains("`many` is no number") && !seen[0].contains("is no number"));
    }

    #[tokio::test]
    async fn answers_that_can_never_be_read_are_no_answer() {
        let (keys, seen) = server(vec![chat("a"), chat("b"), chat("c")]);
        let looked = Onlooker::new("vllm:eye", &keys).unwrap().ask(&asked(1), number).await;
        assert_eq!((looked.read.unwrap(), looked.answers.len()), (None, ASKS));
        assert_eq!(seen.join().unwrap().len(), ASKS);
    }

    #[tokio::test]
    async fn a_model_without_eyes_is_named_and_never_asked_without_the_picture() {
        let body = json!({"error": {"message": "image input is not supported by this model"}}).to_string();
        let (keys, seen) = server(vec![(400, body)]);
        let looked = Onlooker::new("vllm:eye", &keys).unwrap().ask(&asked(1), number).await;
        let why = looked.read.unwrap_err();
        assert_eq!(why.code, FaultCode::JRequest);
        assert!(why.message.contains("the model `vllm:eye` takes no picture"), "{}", why.message);
        assert_eq!(seen.join().unwrap().len(), 1, "one question, with its picture");
    }

    #[tokio::test]
    async fn what_was_recorded_is_answered_again_without_the_server() {
        let folder = tempfile::tempdir().unwrap();
        let tape = folder.path().join("tape").display().to_string();
        let (keys, seen) = server(vec![chat("many"), chat("7")]);
        let recorder = Onlooker::new(&format!("record:{tape}=vllm:eye"), &keys).unwrap();
        let first = recorder.ask(&asked(1), number).await;
        seen.join().unwrap();
        let replay = Onlooker::new(&format!("cassette:{tape}"), &Keys::default()).unwrap();
        let second = replay.ask(&asked(1), number).await;
        assert_eq!((second.read.unwrap(), &second.answers), (Some(7), &first.answers));
        let missing = replay.ask(&asked(2), number).await.read.unwrap_err();
        assert!(missing.message.contains("holds 2 exchanges; the nearest, "), "{}", missing.message);
        // Another picture is another question.
        let mut other = asked(1);
        other.png.push(0);
        assert!(replay.ask(&other, number).await.read.unwrap_err().message.contains("differs in turns[1]"));
        // A replay with a server behind it asks nobody for what it holds.
        let (none, _seen) = server(Vec::new());
        let both = Onlooker::new(&format!("replay:{tape}=vllm:eye"), &none).unwrap();
        assert_eq!((both.ask(&asked(1), number).await.read.unwrap(), both.name()), (Some(7), "vllm:eye"));
    }

    #[test]
    fn rules_see_no_pictures() {
        for setting in ["offline", "auto", "record:tape=offline", "gpt"] {
            assert_eq!(Onlooker::new(setting, &Keys::default()).unwrap_err().code, FaultCode::JRequest, "{setting}");
        }
        assert_eq!(Onlooker::new("openai:m", &Keys::default()).unwrap_err().code, FaultCode::TAuth);
    }
}
