//! Asks a language model for the brief of a building in words, and again with what could not be built.

use socrates_llm::{ChatRequest, Detail, Turn};
use socrates_model::{BuildingBrief, FaultCode};
use socrates_prompts::building::{Briefed, again, question, read, schema};

use crate::author::AskError;
use crate::llm::{MAX_TOKENS, ask_error, turn};
use crate::settings::{Keys, client};

/// Times that a brief is asked for.
const ASKS: usize = 3;

/// The brief that the server of a setting makes of these words, and what `builds` makes of it, or why that cannot be built.
///
/// # Errors
/// [`AskError`]: `J-REQUEST` for a setting that means no server, `E-CANNOT` with the reasons where no answer could be built, else why
/// there was no answer.
pub async fn brief<T>(
    setting: &str,
    keys: &Keys,
    words: &str,
    seed: u64,
    builds: impl Fn(&BuildingBrief) -> Result<T, Vec<String>>,
) -> Result<(Briefed, T), AskError> {
    let client = client(setting, keys)?;
    let mut turns: Vec<Turn> = question(words).iter().map(turn).collect();
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
        refused = match read(&answer.text).and_then(|briefed| builds(&briefed.brief).map(|built| (briefed, built))) {
            Ok(made) => return Ok(made),
            Err(why) => why,
        };
        turns.extend(again(&answer.text, &refused).iter().map(turn));
    }
    let message = format!("after {ASKS} answers there is no building: {}", refused.join("; "));
    Err(AskError::new(FaultCode::ECannot, message))
}
