//! Which author a setting means.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Duration;

use async_trait::async_trait;
use socrates_llm::models::Has;
use socrates_llm::probe::Probe;
use socrates_llm::{ApiKey, ChatClient, ClientConfig, Dialect, Learned, Listener, Rung};
use socrates_model::ids::BadId;
use socrates_model::request::ServerKind;
use socrates_model::{AuthorSpec, FaultCode};
use socrates_prompts::{Question, Style, Telling};

use crate::author::{Answer, AskError, Author};
use crate::cassette::{Recorder, Replay};
use crate::fault_model::FaultRates;
use crate::faulty::FaultyAuthor;
use crate::llm::{Llm, MAX_TOKENS, ask_error};
use crate::offline::Offline;
use crate::variants::BySeed;
use crate::{compiled, paths_by};

/// What a process knows of one kind of server.
#[derive(Debug, Clone, Default)]
pub struct Server {
    /// The key, where there is one.
    pub key: Option<ApiKey>,
    /// The address; without one, the vendor's, or this machine with the server's own port.
    pub url: Option<String>,
}

/// What a process knows beside the job: keys and addresses. The command line reads them from its environment; they never
/// travel with a job.
#[derive(Debug, Clone, Default)]
pub struct Keys {
    /// Servers by kind.
    pub servers: BTreeMap<Dialect, Server>,
    /// Model that `auto` means when there is a key for Chat Completions; default [`DEFAULT_MODEL`].
    pub auto_model: Option<String>,
    /// The only rung of enforcement to use; without one, what the server takes.
    pub rung: Option<Rung>,
    /// How long a server may be silent; default 5 min.
    pub silence: Option<Duration>,
    /// Longest time of a call; default 30 min.
    pub longest: Option<Duration>,
    /// Whether answers are asked for in one piece, and not in parts that can be heard while they come.
    pub in_one_piece: bool,
    /// Hears how far an answer is.
    pub listener: Listener,
    /// Most tokens of an answer; default 16 000.
    pub max_tokens: Option<u32>,
    /// Whether plain HTTP may go to other machines.
    pub plain_http: bool,
    /// What was learned of servers; clones share it.
    pub learned: Learned,
    /// Whether jobs may name folders of recordings.
    pub recordings: Recordings,
}

/// Whether the author of a job may be a folder of recordings on the machine of the worker: `record:`, `replay:` and `cassette:`
/// make and read files there.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Recordings {
    /// Jobs come from others: their authors are chosen by name alone.
    #[default]
    Refused,
    /// The user of the worker hands in its jobs, as in `socrates run`.
    Own,
}

impl Keys {
    fn of(&self, dialect: Dialect) -> Option<&ApiKey> {
        self.servers.get(&dialect).and_then(|server| server.key.as_ref()).filter(|key| !key.is_empty())
    }
}

/// Model of `auto` with a key where none is named.
pub const DEFAULT_MODEL: &str = "gpt-4o";
/// Models that a message names at most.
const NAMED: usize = 12;
/// The author of a setting, asked in a style. `auto` is the offline author unless there is a key: it is settled before a job is made,
/// and nothing is looked for here.
///
/// # Errors
/// [`AskError`]: `J-REQUEST` for a setting that means nobody, `T-AUTH` for a server of others without a key.
pub fn author_for(setting: &str, keys: &Keys, style: Style) -> Result<Box<dyn Author>, AskError> {
    author_of(&read(setting)?, keys, style)
}

fn author_of(author: &AuthorSpec, keys: &Keys, style: Style) -> Result<Box<dyn Author>, AskError> {
    match author {
        AuthorSpec::Offline => Ok(Box::new(Offline)),
        AuthorSpec::Auto if keys.of(Dialect::OpenAi).is_none() => Ok(Box::new(Offline)),
        AuthorSpec::Auto => server(Dialect::OpenAi, keys.auto_model.as_deref().unwrap_or(DEFAULT_MODEL), keys, style),
        AuthorSpec::Server(kind, model) => server(dialect(*kind), model, keys, style),
        AuthorSpec::Cassette(folder) => Ok(Box::new(Replay::new(folder, style))),
        AuthorSpec::Record(folder, inner) => Ok(Box::new(Recorder::new(author_of(inner, keys, style)?, folder, style))),
        AuthorSpec::Replay(folder, inner) => {
            Ok(Box::new(Replay::new(folder, style).or_else(author_of(inner, keys, style)?)))
        }
    }
}

/// The author that a setting names.
pub(crate) fn read(setting: &str) -> Result<AuthorSpec, AskError> {
    setting.parse().map_err(|bad: BadId| AskError::new(FaultCode::JRequest, bad.to_string()))
}

/// How a kind of server is spoken to.
pub(crate) const fn dialect(kind: ServerKind) -> Dialect {
    match kind {
        ServerKind::OpenAi => Dialect::OpenAi,
        ServerKind::Responses => Dialect::Responses,
        ServerKind::Anthropic => Dialect::Anthropic,
        ServerKind::Gemini => Dialect::Gemini,
        ServerKind::Vllm => Dialect::Vllm,
        ServerKind::Ollama => Dialect::Ollama,
        ServerKind::LlamaCpp => Dialect::LlamaCpp,
        ServerKind::LmStudio => Dialect::LmStudio,
        ServerKind::Console => Dialect::Console,
    }
}

/// The author that a job's settings ask for: `author`, `prompt.…` for the style, and `fault.…` rates for this attempt.
///
/// # Errors
/// `J-REQUEST` for a folder of recordings where [`Recordings`] refuses them; else as [`author_for`], [`Style::from_settings`] and
/// [`FaultRates::from_settings`].
pub fn author_of_job(
    settings: &BTreeMap<String, String>,
    keys: &Keys,
    attempt: u32,
) -> Result<Box<dyn Author>, AskError> {
    let style = Style::from_settings(settings)
        .map_err(|fault| AskError::new(fault.code, format!("{}: {}", fault.at, fault.message)))?;
    let named = read(settings.get("author").map_or("auto", String::as_str))?;
    if let (Recordings::Refused, Some(folder)) = (keys.recordings, named.folder()) {
        let message = format!(
            "the setting `author` of the job is `{named}`, and this worker opens no folder that a job names: `{folder}`; submit with an \
             author that has a name, such as `offline` or `openai:<model>`; recordings are for `socrates run`"
        );
        return Err(AskError::new(FaultCode::JRequest, message));
    }
    let author = author_of(&named, keys, style)?;
    let author: Box<dyn Author> = if style.feedback == Telling::Named {
        author
    } else {
        Box::new(Told { inner: author, telling: style.feedback })
    };
    // Rules act on what their behaviors are told.
    let compiles = compiled::by_proposal(settings)? && author.name() != socrates_offline::NAME;
    let author: Box<dyn Author> = if compiles { Box::new(compiled::Compiled { inner: author }) } else { author };
    // Rules have the solver anyway.
    let from = paths_by::solver_from(settings, &style)?.filter(|_| author.name() != socrates_offline::NAME);
    let author: Box<dyn Author> = match from {
        Some(from) => Box::new(paths_by::BySolver { inner: author, asked: attempt, from }),
        None => author,
    };
    // A model writes several in one answer; rules are asked with as many seeds.
    let author: Box<dyn Author> = if style.variants > 1 && author.name() == socrates_offline::NAME {
        Box::new(BySeed { inner: author, count: style.variants })
    } else {
        author
    };
    let rates = FaultRates { told: style.feedback, ..FaultRates::from_settings(settings)? };
    if rates.is_clean() { Ok(author) } else { Ok(Box::new(FaultyAuthor::new(author, rates, attempt))) }
}

/// An author who is not told everything of its refused answers.
struct Told {
    inner: Box<dyn Author>,
    telling: Telling,
}

#[async_trait]
impl Author for Told {
    async fn ask(&self, question: &Question) -> Result<Answer, AskError> {
        self.inner.ask(&question.clone().telling(self.telling)).await
    }

    fn name(&self) -> String {
        self.inner.name()
    }
}

/// Asks the server of a setting what it enforces; see [`ChatClient::probe`].
///
/// # Errors
/// [`AskError`]: `J-REQUEST` for a setting that means no server, else why there was no answer.
pub async fn probe(setting: &str, keys: &Keys) -> Result<Probe, AskError> {
    client(setting, keys)?.probe().await.map_err(|error| ask_error(&error))
}

/// The client of a setting that names a server.
pub(crate) fn client(setting: &str, keys: &Keys) -> Result<ChatClient, AskError> {
    let author = read(setting)?;
    let AuthorSpec::Server(kind, model) = &author else {
        let message = format!("`{author}` is no server; allowed: openai:<model>, ollama:<model> and the like");
        return Err(AskError::new(FaultCode::JRequest, message));
    };
    ChatClient::new(config(dialect(*kind), model, keys)?).map_err(|error| ask_error(&error))
}

/// The client of a server for questions that mean nothing without their picture.
pub(crate) fn seeing_client(kind: ServerKind, model: &str, keys: &Keys) -> Result<ChatClient, AskError> {
    let mut config = config(dialect(kind), model, keys)?;
    config.needs_pictures = true;
    ChatClient::new(config).map_err(|error| ask_error(&error))
}

/// Looks whether the author of a setting can be asked: a key where one is needed, a folder of recordings that is there, a server
/// that answers and has the model. What a server does not say stops nobody.
///
/// # Errors
/// [`AskError`], as [`author_for`] and as asking would end.
pub async fn check(setting: &str, keys: &Keys) -> Result<(), AskError> {
    let author = read(setting)?;
    drop(author_of(&author, keys, Style::default())?);
    let mut asked = &author;
    loop {
        match asked {
            AuthorSpec::Cassette(folder) if !Path::new(folder).is_dir() => {
                let message =
                    format!("`{asked}`: there is no folder `{folder}`; `record:{folder}=<author>` records one");
                return Err(AskError::new(FaultCode::JRequest, message));
            }
            // A recorder asks somebody; a replay asks only what was not recorded.
            AuthorSpec::Record(_, inner) => asked = inner,
            AuthorSpec::Server(kind, model) => return has_model(dialect(*kind), model, keys).await,
            AuthorSpec::Auto | AuthorSpec::Offline | AuthorSpec::Cassette(_) | AuthorSpec::Replay(..) => return Ok(()),
        }
    }
}

async fn has_model(dialect: Dialect, model: &str, keys: &Keys) -> Result<(), AskError> {
    let client = ChatClient::new(config(dialect, model, keys)?).map_err(|error| ask_error(&error))?;
    match client.has_model().await.map_err(|error| ask_error(&error))? {
        Has::Yes | Has::Unsaid => Ok(()),
        Has::No(others) => {
            let shown: Vec<&str> = others.iter().map(String::as_str).take(NAMED).collect();
            let more = if others.len() > shown.len() { ", …" } else { "" };
            let there = if shown.is_empty() { String::new() } else { format!("; it has: {}{more}", shown.join(", ")) };
            Err(AskError::new(FaultCode::TAuth, format!("the server of `{dialect}` has no model `{model}`{there}")))
        }
    }
}

fn server(dialect: Dialect, model: &str, keys: &Keys, style: Style) -> Result<Box<dyn Author>, AskError> {
    let llm = Llm::new(config(dialect, model, keys)?, style, keys.max_tokens.unwrap_or(MAX_TOKENS))?;
    Ok(Box::new(llm))
}

pub(crate) fn config(dialect: Dialect, model: &str, keys: &Keys) -> Result<ClientConfig, AskError> {
    let url = keys.servers.get(&dialect).and_then(|server| server.url.as_deref());
    let url = url.filter(|url| !url.is_empty()).unwrap_or_else(|| dialect.default_url());
    let key = keys.of(dialect).cloned().unwrap_or_else(|| ApiKey::new(""));
    // The vendors' own servers answer nobody without a key; a server of one's own may.
    if key.is_empty() && url == dialect.default_url() && url.starts_with("https:") {
        let message = format!(
            "`{dialect}:{model}` needs a key: put it into the environment variable that `author.key_variable` names, or into \
             the file of `author.key_file`; `socrates config author` shows both. `offline` needs none"
        );
        return Err(AskError::new(FaultCode::TAuth, message));
    }
    let mut config = ClientConfig::new(dialect, url, key, model);
    config.rung = keys.rung;
    config.learned = keys.learned.clone();
    config.plain_http = keys.plain_http;
    config.silence = keys.silence.unwrap_or(config.silence);
    config.longest = keys.longest.unwrap_or(config.longest);
    config.stream = !keys.in_one_piece;
    config.listener = keys.listener.clone();
    Ok(config)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn name(setting: &str, keys: &Keys) -> Result<String, FaultCode> {
        author_for(setting, keys, Style::default()).map(|author| author.name()).map_err(|error| error.code)
    }

    fn keyed(dialect: Dialect) -> Keys {
        let server = Server { key: Some(ApiKey::new("k")), url: None };
        Keys { servers: BTreeMap::from([(dialect, server)]), ..Keys::default() }
    }

    #[test]
    fn auto_is_offline_without_a_key_and_a_model_with_one() {
        assert_eq!(name("auto", &Keys::default()), Ok(socrates_offline::NAME.to_owned()));
        assert_eq!(name("auto", &keyed(Dialect::OpenAi)), Ok(format!("openai:{DEFAULT_MODEL}")));
        assert_eq!(name("openai:tiny", &keyed(Dialect::OpenAi)), Ok("openai:tiny".to_owned()));
    }

    #[test]
    fn each_vendor_wants_its_own_key_and_local_servers_none() {
        for dialect in [Dialect::OpenAi, Dialect::Responses, Dialect::Anthropic, Dialect::Gemini] {
            let setting = format!("{dialect}:m");
            assert_eq!(name(&setting, &Keys::default()), Err(FaultCode::TAuth));
            assert_eq!(name(&setting, &keyed(dialect)), Ok(setting.clone()));
        }
        for setting in ["vllm:org/model-7b", "ollama:model:7b", "llamacpp:m", "lmstudio:m"] {
            assert_eq!(name(setting, &Keys::default()), Ok(setting.to_owned()));
        }
        let server = Server { key: None, url: Some("http://127.0.0.1:1/v1".into()) };
        let local = Keys { servers: BTreeMap::from([(Dialect::OpenAi, server)]), ..Keys::default() };
        assert_eq!(name("openai:tiny", &local), Ok("openai:tiny".to_owned()));
    }

    #[tokio::test]
    async fn what_cannot_be_asked_is_known_before_it_is_asked() {
        let code = async |setting: &str, keys: &Keys| check(setting, keys).await.map_err(|error| error.code);
        let none = Keys::default();
        for setting in ["offline", "auto", "replay:no/such/folder=offline", "record:no/such/folder=offline"] {
            assert_eq!(code(setting, &none).await, Ok(()), "{setting}");
        }
        for setting in ["openai:m", "record:x=anthropic:m", "replay:x=gemini:m"] {
            assert_eq!(code(setting, &none).await, Err(FaultCode::TAuth), "{setting}");
        }
        assert_eq!(code("cassette:no/such/folder", &none).await, Err(FaultCode::JRequest));
        assert_eq!(code("gpt", &none).await, Err(FaultCode::JRequest));
        let server = Server { key: None, url: Some("http://127.0.0.1:1/v1".into()) };
        let gone = Keys { servers: BTreeMap::from([(Dialect::Vllm, server)]), ..Keys::default() };
        assert_eq!(code("record:x=vllm:m", &gone).await, Err(FaultCode::TNet));
        assert_eq!(code("replay:x=vllm:m", &gone).await, Ok(()), "everything may be recorded");
    }

    #[test]
    fn a_job_of_others_opens_no_folder_and_one_of_the_own_user_does() {
        let folder = tempfile::tempdir().unwrap();
        let at = folder.path().join("tape").display().to_string();
        let named = |author: &str| BTreeMap::from([("author".to_owned(), author.to_owned())]);
        let own = Keys { recordings: Recordings::Own, ..Keys::default() };
        for author in [
            format!("record:{at}=offline"),
            format!("replay:{at}=offline"),
            format!("cassette:{at}"),
            format!("record:{at}=record:b=offline"),
        ] {
            let why = author_of_job(&named(&author), &Keys::default(), 1).err().unwrap();
            assert_eq!(why.code, FaultCode::JRequest, "{author}");
            assert!(why.message.contains(&author) && why.message.contains("`author`"), "{}", why.message);
            assert!(author_of_job(&named(&author), &own, 1).is_ok(), "{author}");
        }
        for author in ["offline", "auto", "console:person", "vllm:m"] {
            assert!(author_of_job(&named(author), &Keys::default(), 1).is_ok(), "{author}");
        }
    }

    #[test]
    fn a_setting_that_means_nobody_says_who_there_is() {
        for setting in ["gpt", "openai:", "record:x", "cassette:", "replay:=offline", "azure:m", "record:x=nobody"] {
            assert_eq!(name(setting, &Keys::default()), Err(FaultCode::JRequest), "{setting}");
        }
    }

    #[test]
    fn rates_and_styles_are_read_from_settings_and_wrong_ones_are_named() {
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
        for wrong in [("fault.gdisc", "3"), ("fault.typo", "0.1"), ("prompt.paths", "edges")] {
            assert!(author_of_job(&settings(&[wrong]), &Keys::default(), 1).is_err(), "{wrong:?}");
        }
    }

    #[test]
    fn every_kind_of_server_is_spoken_to_by_its_own_name() {
        for kind in ServerKind::ALL {
            assert_eq!(dialect(kind).name(), kind.name());
        }
        assert_eq!(ServerKind::ALL.len(), Dialect::ALL.len());
    }
}
