//! A language model as author.

use async_trait::async_trait;
use socrates_llm::{
    ChatAnswer, ChatClient, ChatError, ChatRequest, ClientConfig, Detail, Dialect, Finish, Speaker, Turn,
};
use socrates_model::FaultCode;
use socrates_model::job::Stage;
use socrates_prompts::message::Message;
use socrates_prompts::{Image, PathsForm, Picture, Prompt, Question, Role, Style};

use crate::author::{Answer, AskError, Author, How};
use crate::passing;

/// Most tokens of an answer. The largest answers, proposals of many humans, take about a third.
pub const MAX_TOKENS: u32 = 16_000;

/// Most tokens of an answer that is asked for again because it was cut off.
const MOST_TOKENS: u32 = 64_000;

/// Room for the answer: twice as much where the answer before was cut off, once, and never more than [`MOST_TOKENS`] unless
/// so much was configured.
fn room(question: &Question, max_tokens: u32) -> u32 {
    let cut = question.feedback.iter().any(|fault| fault.code == FaultCode::ETrunc);
    if cut { max_tokens.saturating_mul(2).min(MOST_TOKENS.max(max_tokens)) } else { max_tokens }
}

/// A language model behind a server.
#[derive(Debug, Clone)]
pub struct Llm {
    client: ChatClient,
    dialect: Dialect,
    name: String,
    style: Style,
    max_tokens: u32,
}

impl Llm {
    /// The model that this configuration reaches, asked in this style.
    ///
    /// # Errors
    /// [`AskError`] `J-REQUEST` when the address cannot be used.
    pub fn new(config: ClientConfig, style: Style, max_tokens: u32) -> Result<Self, AskError> {
        let name = format!("{}:{}", config.dialect, config.model);
        let dialect = config.dialect;
        let client = ChatClient::new(config).map_err(|error| ask_error(&error))?;
        Ok(Self { client, dialect, name, style, max_tokens })
    }

    /// The style that this server can be asked in, a grammar where it takes one, and what was changed for it.
    fn fitted(&self, question: &Question) -> (Style, Option<String>, Option<String>) {
        let style = self.style;
        if question.stage != Stage::Paths || style.paths != PathsForm::Walk {
            return (style, None, None);
        }
        let nodes = Style { paths: PathsForm::Nodes, ..style };
        if self.dialect.takes_grammar() {
            return (nodes, question.grammar(), Some("walk: by a grammar of the graph".to_owned()));
        }
        if self.dialect.takes_recursion() {
            return (style, None, None);
        }
        let why = format!("walk: {} takes no schema that refers to itself, so nodes were asked for", self.dialect);
        (nodes, None, Some(why))
    }
}

#[async_trait]
impl Author for Llm {
    async fn ask(&self, question: &Question) -> Result<Answer, AskError> {
        let (style, grammar, change) = self.fitted(question);
        let prompt = passing::asked(question, style.mode).prompt(&style);
        let room = room(question, self.max_tokens);
        let mut request = chat_request(question, &prompt, style.image, room)?;
        request.grammar = grammar;
        if !matches!(self.dialect, Dialect::OpenAi | Dialect::Responses | Dialect::Console) {
            // Some models take turns by turns only; two in a row by the same speaker are one.
            request.turns = merged(request.turns);
        }
        let answer = self.client.ask(&request).await.map_err(|error| ask_error(&error))?;
        let answer = ChatAnswer { model: format!("{}:{}", self.dialect, answer.model), ..answer };
        let without_picture = answer.without_picture;
        let mut said = said(answer, prompt, style);
        said.how.steps.extend(change);
        if room != self.max_tokens {
            let words =
                format!("up to {room} tokens were allowed, not {}: the answer before was cut off", self.max_tokens);
            said.how.steps.push(words);
        }
        said.how.picture = if without_picture { None } else { picture_of(&request) };
        Ok(said)
    }

    fn name(&self) -> String {
        self.name.clone()
    }
}

fn picture_of(request: &ChatRequest) -> Option<(u32, u32)> {
    request.turns.iter().find_map(|turn| turn.png.as_deref()).map(socrates_llm::estimate::png_size)
}

/// The question in the words of the client. A picture is drawn where a message asks for one.
///
/// # Errors
/// [`AskError`] when the map cannot be drawn.
pub fn chat_request(
    question: &Question,
    prompt: &Prompt,
    image: Image,
    max_tokens: u32,
) -> Result<ChatRequest, AskError> {
    let mut turns = Vec::new();
    for message in &prompt.messages {
        let png = match message.image {
            Some(Picture::AnnotatedMap) if image != Image::Off => Some(picture(question, image)?),
            Some(Picture::AnnotatedMap) | None => None,
        };
        turns.push(Turn { png, ..turn(message) });
    }
    Ok(ChatRequest {
        turns,
        form: question.stage.name().to_owned(),
        schema: prompt.schema.clone(),
        grammar: None,
        seed: Some(question.seed),
        temperature: None,
        max_tokens,
        detail: if image == Image::High { Detail::High } else { Detail::Low },
    })
}

/// A message in the words of the client, without a picture.
pub(crate) fn turn(message: &Message) -> Turn {
    let speaker = match message.role {
        Role::System => Speaker::System,
        Role::User => Speaker::User,
        Role::Assistant => Speaker::Assistant,
    };
    Turn { speaker, text: message.text.clone(), png: None }
}

/// The part of the map with its graph, no larger than asked for.
fn picture(question: &Question, image: Image) -> Result<Vec<u8>, AskError> {
    let undrawn = |why: String| AskError::new(FaultCode::JRequest, format!("the map cannot be drawn: {why}"));
    let svg = socrates_draw::annotated_graph(&question.location);
    let (width, height) = svg_size(&svg).ok_or_else(|| undrawn("it has no size".to_owned()))?;
    #[expect(clippy::cast_possible_truncation, reason = "a scale needs no more digits")]
    let scale = (f64::from(image.side_px()) / width.max(height)).min(2.0) as f32;
    socrates_draw::png_from_svg(&svg, scale).map_err(|error| undrawn(error.to_string()))
}

/// Width and height that a drawing names.
fn svg_size(svg: &str) -> Option<(f64, f64)> {
    let head = svg.split_once('>')?.0;
    let number = |name: &str| {
        let rest = head.split_once(&format!(" {name}=\""))?.1;
        rest.split_once('"')?.0.trim_end_matches("px").parse::<f64>().ok().filter(|value| *value >= 1.0)
    };
    Some((number("width")?, number("height")?))
}

/// Turns of the same speaker in a row as one turn, its picture kept.
pub(crate) fn merged(turns: Vec<Turn>) -> Vec<Turn> {
    let mut out: Vec<Turn> = Vec::new();
    for turn in turns {
        match out.last_mut() {
            Some(last) if last.speaker == turn.speaker && (last.png.is_none() || turn.png.is_none()) => {
                last.text = format!("{}\n\n{}", last.text.trim_end(), turn.text);
                last.png = last.png.take().or(turn.png);
            }
            Some(_) | None => out.push(turn),
        }
    }
    out
}

/// A chat answer as an author's answer to a prompt.
pub(crate) fn said(answer: ChatAnswer, prompt: Prompt, style: Style) -> Answer {
    let plain = answered(answer);
    let how = How { template: Some(prompt.template), style: Some(style), ..plain.how };
    Answer { sent: prompt.messages, how, ..plain }
}

/// A chat answer as an answer for the books.
pub(crate) fn answered(answer: ChatAnswer) -> Answer {
    Answer {
        text: answer.text,
        tokens: answer.tokens,
        model: answer.model,
        cut: answer.finish == Finish::Cut,
        how: How {
            rung: answer.rung.map(|rung| rung.name().to_owned()),
            steps: answer.steps,
            cached: answer.cached,
            thought: answer.thought,
            estimated: answer.estimated,
            limits: answer.limits,
            ..How::default()
        },
        ..Answer::default()
    }
}

/// The client's error with the code that the orchestrator knows.
pub(crate) fn ask_error(error: &ChatError) -> AskError {
    let (code, retry_after_ms) = match error {
        ChatError::Unreachable { .. } | ChatError::Broken { .. } => (FaultCode::TNet, None),
        ChatError::Timeout { .. } | ChatError::Late { .. } => (FaultCode::TTimeout, None),
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
    use socrates_llm::ApiKey;

    fn pictures(image: Image) -> Vec<Vec<u8>> {
        let asked = question(Stage::Paths);
        let prompt = asked.prompt(&Style { image, ..Style::default() });
        let request = chat_request(&asked, &prompt, image, 100).unwrap();
        request.turns.into_iter().filter_map(|turn| turn.png).collect()
    }

    #[test]
    fn a_picture_is_drawn_as_large_as_asked_for() {
        assert!(pictures(Image::Off).is_empty());
        for (image, most) in [(Image::Low, 512), (Image::High, 1024)] {
            let (width, height) = socrates_llm::estimate::png_size(&pictures(image)[0]);
            assert!(width.max(height) <= most + 1 && width.max(height) > most / 2, "{image}: {width} x {height}");
        }
    }

    #[test]
    fn a_walk_is_asked_for_in_the_way_that_the_server_can_enforce() {
        let style = Style { paths: PathsForm::Walk, ..Style::default() };
        let fitted = |dialect: Dialect| {
            let config = ClientConfig::new(dialect, dialect.default_url(), ApiKey::new(""), "m");
            let (style, grammar, change) = Llm::new(config, style, 1).unwrap().fitted(&question(Stage::Paths));
            (style.paths, grammar.is_some(), change.is_some())
        };
        assert_eq!(fitted(Dialect::OpenAi), (PathsForm::Walk, false, false));
        assert_eq!(fitted(Dialect::LlamaCpp), (PathsForm::Nodes, true, true));
        assert_eq!(fitted(Dialect::Anthropic), (PathsForm::Nodes, false, true));
    }

    #[test]
    fn a_cut_answer_gets_twice_the_room_once() {
        let mut asked = question(Stage::Paths);
        assert_eq!(room(&asked, 16_000), 16_000);
        let cut = socrates_model::Fault::new(FaultCode::ETrunc, "answer", "was cut");
        asked.feedback = vec![cut.clone(), cut];
        assert_eq!((room(&asked, 16_000), room(&asked, 40_000), room(&asked, 90_000)), (32_000, 64_000, 90_000));
        // It is asked to be shorter as well.
        let told = asked.prompt(&Style::default()).messages.pop().unwrap().text;
        assert!(told.contains("E-TRUNC"), "{told}");
    }

    #[test]
    fn turns_of_one_speaker_become_one() {
        let turn = |speaker, text: &str, png: Option<Vec<u8>>| Turn { speaker, text: text.into(), png };
        let turns = vec![
            turn(Speaker::System, "s", None),
            turn(Speaker::User, "a\n", None),
            turn(Speaker::User, "b", Some(vec![1])),
            turn(Speaker::Assistant, "c", None),
            turn(Speaker::User, "d", None),
        ];
        let joined = merged(turns);
        assert_eq!(joined.len(), 4);
        assert_eq!((joined[1].text.as_str(), joined[1].png.as_deref()), ("a\n\nb", Some([1].as_slice())));
    }

    #[test]
    fn a_wish_to_wait_goes_on_to_the_orchestrator() {
        let error = ChatError::SlowDown { status: 429, retry_after_ms: Some(1500), why: "slow".into() };
        let told = ask_error(&error);
        assert_eq!((told.code, told.retry_after_ms), (FaultCode::T429, Some(1500)));
    }
}
