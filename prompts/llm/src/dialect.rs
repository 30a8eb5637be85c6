//! Kinds of servers, and how far each of them enforces the form of an answer.

use std::collections::BTreeMap;
use std::fmt;
use std::str::FromStr;
use std::sync::{Arc, Mutex};

/// How far a server enforces the form of an answer: the rungs of the ladder, best first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Rung {
    /// The server keeps to the schema.
    Schema,
    /// One tool that has to be called, whose input is the answer.
    Tool,
    /// Some JSON object; the schema stands in the prompt.
    Object,
    /// The server's own field: a grammar where the request brings one, else the schema.
    Grammar,
    /// Nothing; the schema stands in the prompt.
    Plain,
}

impl Rung {
    /// Every rung.
    pub const ALL: [Self; 5] = [Self::Schema, Self::Tool, Self::Object, Self::Grammar, Self::Plain];

    /// The name as settings spell it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Schema => "schema",
            Self::Tool => "tool",
            Self::Object => "object",
            Self::Grammar => "grammar",
            Self::Plain => "plain",
        }
    }

    /// Whether the server knows the form, so that the prompt need not repeat it.
    #[must_use]
    pub const fn knows_form(self) -> bool {
        matches!(self, Self::Schema | Self::Tool | Self::Grammar)
    }
}

impl fmt::Display for Rung {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A name that means nothing here.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{name}` is unknown; allowed: {allowed}")]
pub struct UnknownName {
    /// What was given.
    pub name: String,
    /// What is taken.
    pub allowed: String,
}

impl FromStr for Rung {
    type Err = UnknownName;

    fn from_str(name: &str) -> Result<Self, UnknownName> {
        Self::ALL
            .into_iter()
            .find(|rung| rung.name() == name)
            .ok_or_else(|| UnknownName { name: name.to_owned(), allowed: Self::ALL.map(Self::name).join(", ") })
    }
}

/// Ways to put a conversation into JSON.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wire {
    /// `POST {base}/chat/completions`.
    Chat,
    /// `POST {base}/responses`.
    Responses,
    /// `POST {base}/v1/messages`.
    Messages,
    /// `POST {base}/v1beta/models/{model}:generateContent`.
    Generate,
}

/// A kind of server.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Dialect {
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
    /// A page at which a person answers, behind Chat Completions.
    Console,
}

impl Dialect {
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

    /// The name as settings spell it.
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

    /// The address where such a server is found when none is given: the vendor's, or the server's own default port.
    #[must_use]
    pub const fn default_url(self) -> &'static str {
        match self {
            Self::OpenAi | Self::Responses => "https://api.openai.com/v1",
            Self::Anthropic => "https://api.anthropic.com",
            Self::Gemini => "https://generativelanguage.googleapis.com",
            Self::Vllm => "http://127.0.0.1:8000/v1",
            Self::Ollama => "http://127.0.0.1:11434/v1",
            Self::LlamaCpp => "http://127.0.0.1:8080/v1",
            Self::LmStudio => "http://127.0.0.1:1234/v1",
            Self::Console => "http://127.0.0.1:8790/v1",
        }
    }

    /// The wire format.
    #[must_use]
    pub const fn wire(self) -> Wire {
        match self {
            Self::OpenAi | Self::Vllm | Self::Ollama | Self::LlamaCpp | Self::LmStudio | Self::Console => Wire::Chat,
            Self::Responses => Wire::Responses,
            Self::Anthropic => Wire::Messages,
            Self::Gemini => Wire::Generate,
        }
    }

    /// What is tried, in this order. Some servers know no plain JSON mode, only two take a grammar.
    #[must_use]
    pub const fn ladder(self) -> &'static [Rung] {
        match self {
            Self::OpenAi | Self::Responses | Self::Ollama | Self::Gemini => &[Rung::Schema, Rung::Object, Rung::Plain],
            Self::Anthropic => &[Rung::Schema, Rung::Tool, Rung::Plain],
            Self::Vllm | Self::LlamaCpp => &[Rung::Schema, Rung::Object, Rung::Grammar, Rung::Plain],
            Self::LmStudio | Self::Console => &[Rung::Schema, Rung::Plain],
        }
    }

    /// Whether others run such a server, who name what they refuse; other servers answer anything to what they do not know.
    #[must_use]
    pub const fn is_vendor(self) -> bool {
        matches!(self, Self::OpenAi | Self::Responses | Self::Anthropic | Self::Gemini)
    }

    /// Whether such a server takes a grammar in place of a schema.
    #[must_use]
    pub const fn takes_grammar(self) -> bool {
        matches!(self, Self::Vllm | Self::LlamaCpp)
    }

    /// Whether its schemas may refer to themselves.
    #[must_use]
    pub const fn takes_recursion(self) -> bool {
        !matches!(self, Self::Anthropic)
    }
}

impl fmt::Display for Dialect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Dialect {
    type Err = UnknownName;

    fn from_str(name: &str) -> Result<Self, UnknownName> {
        Self::ALL
            .into_iter()
            .find(|dialect| dialect.name() == name)
            .ok_or_else(|| UnknownName { name: name.to_owned(), allowed: Self::ALL.map(Self::name).join(", ") })
    }
}

/// What is known of one server and model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Known {
    /// The rung on which it has answered; none where no form was asked for yet.
    pub rung: Option<Rung>,
    /// Whether it takes questions whose answer is to come in parts.
    pub streams: bool,
    /// Whether it takes pictures.
    pub pictures: bool,
}

impl Default for Known {
    /// Of a server that was never asked: it takes everything until it refuses something.
    fn default() -> Self {
        Self { rung: None, streams: true, pictures: true }
    }
}

/// What was learned of servers in this process: how each has answered. Clones share it.
#[derive(Debug, Clone, Default)]
pub struct Learned(Arc<Mutex<BTreeMap<String, Known>>>);

impl Learned {
    /// What is known of a server and model.
    #[must_use]
    pub fn of(&self, server: &str) -> Known {
        self.0.lock().ok().and_then(|known| known.get(server).copied()).unwrap_or_default()
    }

    /// Keeps how a server has answered.
    pub fn keep(&self, server: &str, known: Known) {
        if let Ok(mut all) = self.0.lock() {
            all.insert(server.to_owned(), known);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_back_and_others_are_answered_with_the_known_ones() {
        for dialect in Dialect::ALL {
            assert_eq!(dialect.name().parse(), Ok(dialect));
            assert_eq!(dialect.ladder().last(), Some(&Rung::Plain));
        }
        for rung in Rung::ALL {
            assert_eq!(rung.name().parse(), Ok(rung));
        }
        assert!("azure".parse::<Dialect>().unwrap_err().to_string().contains("llamacpp"));
        assert!("strict".parse::<Rung>().unwrap_err().to_string().contains("schema, tool"));
    }
}
