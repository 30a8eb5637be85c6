//! Asks a language model for the brief of a building in words, and again with what could not be built.

use socrates_llm::{ChatRequest, Detail, Speaker, Turn};
use socrates_model::{BuildingBrief, FaultCode};
use socrates_prompts::building::{Briefed, again, question, read, schema};
use socrates_prompts::message::{Message, Role};

use crate::author::AskError;
use crate::llm::{MAX_TOKENS, ask_error};
use crate::settings::{Keys, client};

/// Times that a brief is asked for.
const ASKS: usize = 3;

/// The brief that the server of a setting makes of these words; `builds` says why a brief cannot be built, nothing where it can.
///
/// # Errors
/// [`AskError`]: `J-REQUEST` for a setting that means no server, `E-CANNOT` with the reasons where no answer could be built, else why
/// there was no answer.
pub async fn brief(
    setting: &str,
    keys: &Keys,
    words: &str,
    seed: u64,
    builds: impl Fn(&BuildingBrief) -> Vec<String>,
) -> Result<Briefed, AskError> {
    let client = client(setting, keys)?;
    let mut turns: Vec<Turn> = question(words).into_iter().map(turn).collect();
    let mut refused = Vec::new();
    for _ in 0..ASKS {
        let request = ChatRequest {
            turns: turns.clone(),
            form: "building".to_owned(),
            schema: Some(schema()),
            grammar: None,
            seed: Some(seed),
            temperature: None,
            max_tokens: keys.max_tokens.unwrap_or(MAX_TOKENS),
            detail: Detail::Low,
        };
        let answer = client.ask(&request).await.map_err(|error| ask_error(&error))?;
        refused = match read(&answer.text) {
            Ok(briefed) => match builds(&briefed.brief) {
                why if why.is_empty() => return Ok(briefed),
                why => why,
            },
            Err(why) => why,
        };
        turns.extend(again(&answer.text, &refused).into_iter().map(turn));
    }
    let message = format!("after {ASKS} answers there is no building: {}", refused.join("; "));
    Err(AskError::new(FaultCode::ECannot, message))
}

fn turn(message: Message) -> Turn {
    let speaker = match message.role {
        Role::System => Speaker::System,
        Role::User => Speaker::User,
        Role::Assistant => Speaker::Assistant,
    };
    Turn { speaker, text: message.text, png: None }
}
