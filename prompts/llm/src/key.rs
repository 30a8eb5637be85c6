//! Secrets that do not print.

use std::fmt;

/// A key of a server. It prints as `***` and goes nowhere but into the request's header.
#[derive(Clone, PartialEq, Eq)]
pub struct ApiKey(String);

impl ApiKey {
    /// The key; blanks around it are a matter of how it was stored and are dropped.
    #[must_use]
    pub fn new(secret: &str) -> Self {
        Self(secret.trim().to_owned())
    }

    /// Whether there is nothing in it.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The secret itself, for the header.
    pub(crate) fn secret(&self) -> &str {
        &self.0
    }

    /// The text with every occurrence of the secret struck out; servers repeat keys in their errors.
    pub(crate) fn strike_from(&self, text: &str) -> String {
        if self.0.len() < 6 { text.to_owned() } else { text.replace(&self.0, "***") }
    }
}

impl fmt::Debug for ApiKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("***")
    }
}

impl fmt::Display for ApiKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("***")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_does_not_print() {
        let key = ApiKey::new(" topsecret\n");
        assert_eq!(format!("{key} {key:?}"), "*** ***");
        assert_eq!(key.strike_from("bad key topsecret."), "bad key ***.");
    }
}
