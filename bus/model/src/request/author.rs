//! Which author a request names.

use std::fmt;
use std::str::FromStr;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::values::{as_text, shown};
use crate::ids::BadId;

/// A kind of server that language models are asked through.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum ServerKind {
    /// Chat Completions of the vendor, and servers that do the same.
    OpenAi,
    /// Responses of the same vendor, and servers that do the same.
    Responses,
    /// Anthropic Messages.
    Anthropic,
    /// Gemini generateContent.
    Gemini,
    /// vLLM.
    Vllm,
    /// Ollama.
    Ollama,
    /// llama.cpp's server.
    LlamaCpp,
    /// LM Studio.
    LmStudio,
    /// A person at the page of `socrates author console`.
    Console,
}

impl ServerKind {
    /// Every kind.
    pub const ALL: [Self; 9] = [
        Self::OpenAi,
        Self::Responses,
        Self::Anthropic,
        Self::Gemini,
        Self::Vllm,
        Self::Ollama,
        Self::LlamaCpp,
        Self::LmStudio,
        Self::Console,
    ];

    /// The name as requests and settings spell it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::OpenAi => "openai",
            Self::Responses => "responses",
            Self::Anthropic => "anthropic",
            Self::Gemini => "gemini",
            Self::Vllm => "vllm",
            Self::Ollama => "ollama",
            Self::LlamaCpp => "llamacpp",
            Self::LmStudio => "lmstudio",
            Self::Console => "console",
        }
    }
}

/// An author as a request, a setting or a flag names it.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "String", into = "String")]
#[schemars(with = "String")]
pub enum AuthorSpec {
    /// What the configuration says; without a key a server on this machine, else the offline author.
    #[default]
    Auto,
    /// Rules.
    Offline,
    /// A model on a server: `openai:gpt-4o`.
    Server(ServerKind, String),
    /// Recorded answers alone: `cassette:FOLDER`.
    Cassette(String),
    /// Another author, whose answers are recorded: `record:FOLDER=AUTHOR`.
    Record(String, Box<AuthorSpec>),
    /// Recorded answers, and another author for what was not recorded: `replay:FOLDER=AUTHOR`.
    Replay(String, Box<AuthorSpec>),
}

impl AuthorSpec {
    /// What is taken, for messages.
    pub const ALLOWED: &'static str = "auto, offline, openai:<model>, responses:<model>, anthropic:<model>, \
                                       gemini:<model>, vllm:<model>, ollama:<model>, llamacpp:<model>, \
                                       lmstudio:<model>, console:<name>, cassette:<folder>, \
                                       record:<folder>=<author>, replay:<folder>=<author>";

    /// Whether answers come from a language model, live or recorded. Not of [`AuthorSpec::Auto`], which is nobody yet.
    #[must_use]
    pub fn is_model(&self) -> bool {
        match self {
            Self::Auto | Self::Offline => false,
            Self::Server(..) | Self::Cassette(_) => true,
            Self::Record(_, inner) | Self::Replay(_, inner) => inner.is_model(),
        }
    }

    /// The server that is asked, with its model; nothing for rules and recordings.
    #[must_use]
    pub fn server(&self) -> Option<(ServerKind, &str)> {
        match self {
            Self::Auto | Self::Offline | Self::Cassette(_) => None,
            Self::Server(kind, model) => Some((*kind, model)),
            Self::Record(_, inner) | Self::Replay(_, inner) => inner.server(),
        }
    }

    /// The first folder of recordings that it names; nothing for authors that are chosen by a name alone.
    #[must_use]
    pub fn folder(&self) -> Option<&str> {
        match self {
            Self::Auto | Self::Offline | Self::Server(..) => None,
            Self::Cassette(folder) | Self::Record(folder, _) | Self::Replay(folder, _) => Some(folder),
        }
    }

    /// The server with its model in an author that was read before and is kept as text: what [`AuthorSpec::server`] finds, as
    /// one word and without reading it anew.
    #[must_use]
    pub fn server_in(author: &str) -> Option<&str> {
        // Recordings ask somebody else, who stands last.
        let asked = author.rsplit_once('=').map_or(author, |(_, inner)| inner);
        (asked.contains(':') && !asked.starts_with("cassette:")).then_some(asked)
    }
}

impl fmt::Display for AuthorSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::Offline => f.write_str("offline"),
            Self::Server(kind, model) => write!(f, "{}:{model}", kind.name()),
            Self::Cassette(folder) => write!(f, "cassette:{folder}"),
            Self::Record(folder, inner) => write!(f, "record:{folder}={inner}"),
            Self::Replay(folder, inner) => write!(f, "replay:{folder}={inner}"),
        }
    }
}

impl FromStr for AuthorSpec {
    type Err = BadId;
    fn from_str(text: &str) -> Result<Self, BadId> {
        let bad = || BadId { what: "name of an author", found: shown(text), allowed: Self::ALLOWED };
        match text.trim() {
            "" | "auto" => return Ok(Self::Auto),
            "offline" => return Ok(Self::Offline),
            _ => {}
        }
        let (kind, rest) = text.trim().split_once(':').filter(|(_, rest)| !rest.is_empty()).ok_or_else(bad)?;
        let inner = || -> Result<(String, Box<Self>), BadId> {
            let (folder, inner) = rest.split_once('=').filter(|(folder, _)| !folder.is_empty()).ok_or_else(bad)?;
            Ok((folder.to_owned(), Box::new(inner.parse()?)))
        };
        match kind {
            "cassette" => Ok(Self::Cassette(rest.to_owned())),
            "record" => inner().map(|(folder, author)| Self::Record(folder, author)),
            "replay" => inner().map(|(folder, author)| Self::Replay(folder, author)),
            _ => {
                let server = ServerKind::ALL.into_iter().find(|server| server.name() == kind).ok_or_else(bad)?;
                Ok(Self::Server(server, rest.to_owned()))
            }
        }
    }
}

as_text!(AuthorSpec);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn authors_are_read_as_they_are_written() {
        for text in [
            "auto",
            "offline",
            "openai:gpt-4o",
            "ollama:llama3:8b",
            "cassette:my tape",
            "record:tape=openai:gpt-4o",
            "replay:a=record:b=offline",
        ] {
            assert_eq!(text.parse::<AuthorSpec>().unwrap().to_string(), text);
        }
        for text in ["nobody", "openai", "openai:", "oracle:x", "record:tape", "record:=offline", "replay:tape=nobody"]
        {
            assert!(
                text.parse::<AuthorSpec>()
                    .unwrap_err()
                    .to_string()
                    .contains("is not a name of an author; allowed: auto"),
                "{text}"
            );
        }
        let asked = |text: &str| {
            let author: AuthorSpec = text.parse().unwrap();
            author.server().map(|(kind, model)| format!("{}:{model}", kind.name()))
        };
        assert_eq!(asked("replay:a=record:b=vllm:m").as_deref(), Some("vllm:m"));
        let folder = |text: &str| text.parse::<AuthorSpec>().unwrap().folder().map(str::to_owned);
        for (text, named) in
            [("cassette:/a", "/a"), ("record:../b=offline", "../b"), ("replay:c=record:d=offline", "c")]
        {
            assert_eq!(folder(text).as_deref(), Some(named), "{text}");
        }
        for text in ["auto", "offline", "console:person", "ollama:llama3:8b"] {
            assert_eq!(folder(text), None, "{text}");
        }
        assert_eq!(asked("record:tape=offline"), None);
        for text in
            ["auto", "offline", "cassette:a", "record:a=cassette:b", "gemini:m", "replay:a=record:b=ollama:l:8b"]
        {
            assert_eq!(AuthorSpec::server_in(text), asked(text).as_deref(), "{text}");
        }
    }
}
