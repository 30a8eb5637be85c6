//! Who wrote an artifact.

use std::fmt;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What stands behind the name where a person changed what the author wrote.
const PERSON: &str = " + person";
/// What the names of rules begin with; their version follows.
const RULES: &str = "offline";

/// Who wrote an artifact, as files hold it: `offline/1` for rules, `openai:gpt-4o` for a model, `pinned`; `offline/1 + person`
/// once a person changed what was written.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(from = "String", into = "String")]
#[schemars(with = "String")]
pub struct Signature {
    name: String,
    person: bool,
}

impl Signature {
    /// A program or a model of this name.
    pub fn new(text: impl Into<String>) -> Self {
        let mut name: String = text.into();
        let person = name.ends_with(PERSON);
        if person {
            name.truncate(name.len() - PERSON.len());
        }
        Self { name, person }
    }

    /// The same, changed by a person.
    #[must_use]
    pub fn and_person(self) -> Self {
        Self { person: true, ..self }
    }

    /// Whether rules wrote it, whoever changed it then.
    #[must_use]
    pub fn is_rules(&self) -> bool {
        self.name.starts_with(RULES)
    }

    /// Whether a person changed it.
    #[must_use]
    pub const fn has_person(&self) -> bool {
        self.person
    }
}

impl fmt::Display for Signature {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}", self.name, if self.person { PERSON } else { "" })
    }
}

impl From<String> for Signature {
    fn from(text: String) -> Self {
        Self::new(text)
    }
}

impl From<&str> for Signature {
    fn from(text: &str) -> Self {
        Self::new(text)
    }
}

impl From<Signature> for String {
    fn from(signature: Signature) -> Self {
        signature.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_signature_is_read_as_it_is_written() {
        for (text, rules, person) in [
            ("offline/1", true, false),
            ("offline/1 + person", true, true),
            ("openai:gpt-4o", false, false),
            ("openai:gpt-4o + person", false, true),
            ("", false, false),
        ] {
            let json = serde_json::to_string(text).unwrap();
            let signature: Signature = serde_json::from_str(&json).unwrap();
            assert_eq!((signature.is_rules(), signature.has_person()), (rules, person), "{text}");
            assert_eq!(serde_json::to_string(&signature).unwrap(), json);
        }
        assert_eq!(Signature::from("offline/1").and_person().and_person().to_string(), "offline/1 + person");
    }
}
