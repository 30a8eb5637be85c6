//! Which author a setting means.

use std::collections::BTreeMap;

use socrates_llm::{ApiKey, ClientConfig};
use socrates_model::FaultCode;

use crate::author::{AskError, Author};
use crate::cassette::{Recorder, Replay};
use crate::faulty::{FaultRates, FaultyAuthor};
use crate::llm::Llm;
use crate::offline::Offline;

/// What a process knows beside the job: keys and addresses. The command line reads them from its environment; they never
/// travel with a job.
#[derive(Debug, Clone, Default)]
pub struct Keys {
    /// Key for Chat Completions servers.
    pub openai: Option<ApiKey>,
    /// Address of the server; default `https://api.openai.com/v1`.
    pub openai_base_url: Option<String>,
    /// Model that `auto` means when there is a key; default [`DEFAULT_MODEL`].
    pub openai_model: Option<String>,
    /// Enforcement of the answer's form: `schema` (default), `object`, `plain`.
    pub structured: Option<String>,
    /// Whether the model is shown the map as a picture. Default true.
    pub pictures: Option<bool>,
}

/// Model of `auto` with a key where none is named.
pub const DEFAULT_MODEL: &str = "gpt-4o";
/// Settings that are taken, for messages.
pub const ALLOWED: &str = "auto, offline, openai:<model>, cassette:<folder>, record:<folder>=<author>";

/// The author of a setting. `auto` is the offline author unless there is a key.
///
/// # Errors
/// [`AskError`]: `J-REQUEST` for a setting that means nobody, `T-AUTH` for a server of others without a key.
pub fn author_for(setting: &str, keys: &Keys) -> Result<Box<dyn Author>, AskError> {
    let setting = setting.trim();
    match setting.split_once(':') {
        None => match setting {
            "offline" => Ok(Box::new(Offline)),
            "auto" | "" if keys.openai.as_ref().is_none_or(ApiKey::is_empty) => Ok(Box::new(Offline)),
            "auto" | "" => openai(keys.openai_model.as_deref().unwrap_or(DEFAULT_MODEL), keys),
            _ => Err(unknown(setting)),
        },
        Some(("openai", model)) if !model.is_empty() => openai(model, keys),
        Some(("cassette", folder)) if !folder.is_empty() => Ok(Box::new(Replay::from(folder))),
        Some(("record", rest)) => match rest.split_once('=') {
            Some((folder, inner)) if !folder.is_empty() => {
                Ok(Box::new(Recorder::new(author_for(inner, keys)?, folder)))
            }
            Some(_) | None => Err(unknown(setting)),
        },
        Some(_) => Err(unknown(setting)),
    }
}

/// The author that a job's settings ask for: `author`, and `fault.…` rates for this attempt.
///
/// # Errors
/// As [`author_for`] and [`FaultRates::from_settings`].
pub fn author_of_job(
    settings: &BTreeMap<String, String>,
    keys: &Keys,
    attempt: u32,
) -> Result<Box<dyn Author>, AskError> {
    let author = author_for(settings.get("author").map_or("auto", String::as_str), keys)?;
    let rates = FaultRates::from_settings(settings)?;
    if rates.is_clean() { Ok(author) } else { Ok(Box::new(FaultyAuthor::new(author, rates, attempt))) }
}

fn openai(model: &str, keys: &Keys) -> Result<Box<dyn Author>, AskError> {
    let base = keys.openai_base_url.as_deref().unwrap_or("https://api.openai.com/v1");
    let key = keys.openai.clone().unwrap_or_else(|| ApiKey::new(""));
    if key.is_empty() && base.contains("api.openai.com") {
        let message = format!("`openai:{model}` needs a key; set OPENAI_API_KEY, or use `offline`");
        return Err(AskError::new(FaultCode::TAuth, message));
    }
    let mut config = ClientConfig::new(base, key, model);
    if let Some(name) = &keys.structured {
        config.structured = Llm::structured(name).ok_or_else(|| {
            AskError::new(
                FaultCode::JRequest,
                format!("structured output `{name}` is unknown; allowed: schema, object, plain"),
            )
        })?;
    }
    Ok(Box::new(Llm::new(config, keys.pictures.unwrap_or(true))?))
}

fn unknown(setting: &str) -> AskError {
    AskError::new(FaultCode::JRequest, format!("`{setting}` is no author; allowed: {ALLOWED}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn name(setting: &str, keys: &Keys) -> Result<String, FaultCode> {
        author_for(setting, keys).map(|author| author.name()).map_err(|error| error.code)
    }

    #[test]
    fn auto_is_offline_without_a_key_and_a_model_with_one() {
        let keyed = Keys { openai: Some(ApiKey::new("k")), ..Keys::default() };
        assert_eq!(name("auto", &Keys::default()), Ok(socrates_offline::NAME.to_owned()));
        assert_eq!(name("auto", &keyed), Ok(format!("openai:{DEFAULT_MODEL}")));
        assert_eq!(name("openai:tiny", &keyed), Ok("openai:tiny".to_owned()));
    }

    #[test]
    fn a_setting_that_means_nobody_says_who_there_is() {
        for setting in ["gpt", "openai:", "record:x", "cassette:"] {
            assert_eq!(name(setting, &Keys::default()), Err(FaultCode::JRequest), "{setting}");
        }
        assert_eq!(name("openai:tiny", &Keys::default()), Err(FaultCode::TAuth));
        let local = Keys { openai_base_url: Some("http://127.0.0.1:1/v1".into()), ..Keys::default() };
        assert_eq!(name("openai:tiny", &local), Ok("openai:tiny".to_owned()));
    }

    #[test]
    fn rates_are_read_from_settings_and_wrong_ones_are_named() {
        let settings = |pairs: &[(&str, &str)]| {
            pairs.iter().map(|(k, v)| ((*k).to_owned(), (*v).to_owned())).collect::<BTreeMap<_, _>>()
        };
        let rates = FaultRates::from_settings(&settings(&[
            ("fault.gdisc", "0.3"),
            ("fault.first_only", "true"),
            ("pace", "max"),
        ]))
        .unwrap();
        assert!(rates.first_only && rates.rates.len() == 1 && !rates.is_clean());
        for wrong in [("fault.gdisc", "3"), ("fault.typo", "0.1"), ("fault_rate.json", "x")] {
            assert!(FaultRates::from_settings(&settings(&[wrong])).is_err(), "{wrong:?}");
        }
    }
}
