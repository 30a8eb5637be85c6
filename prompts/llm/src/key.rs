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
    #[must_use]
    pub fn strike_from(&self, text: &str) -> String {
        if self.0.len() < 6 { text.to_owned() } else { text.replace(&self.0, "***") }
    }
}

/// The text with everything struck out that has the shape of a vendor's key.
#[must_use]
pub fn strike_shapes(text: &str) -> String {
    /// How a key begins, and how many characters it has after that at least.
    const SHAPES: [(&str, usize); 3] = [("sk-", 20), ("AIza", 30), ("Bearer ", 20)];
    let of_key = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.');
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some((at, start)) =
        SHAPES.iter().filter_map(|(start, _)| rest.find(start).map(|at| (at, *start))).min_by_key(|(at, _)| *at)
    {
        let (before, found) = rest.split_at_checked(at).unwrap_or((rest, ""));
        let (start, tail) = found.split_at_checked(start.len()).unwrap_or((found, ""));
        let length = tail.find(|c: char| !of_key(c)).unwrap_or(tail.len());
        let (body, next) = tail.split_at_checked(length).unwrap_or((tail, ""));
        let least = SHAPES.iter().find(|(name, _)| *name == start).map_or(0, |(_, least)| *least);
        let alone = !before.chars().next_back().is_some_and(char::is_alphanumeric);
        out.push_str(before);
        out.push_str(start);
        if alone && length >= least && body.bytes().any(|byte| byte.is_ascii_digit()) {
            out.push_str("***");
            rest = next;
        } else {
            rest = tail;
        }
    }
    out + rest
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

    #[test]
    fn shapes_of_keys_are_struck_and_words_are_not() {
        let key = "a1B2c3D4e5F6g7H8i9J0k1L2m3N4o5P6";
        assert_eq!(strike_shapes(&format!("use sk-{key}, or AIza{key}!")), "use sk-***, or AIza***!");
        assert_eq!(strike_shapes(&format!("Bearer {key}")), "Bearer ***");
        for plain in ["a desk-bound risk-averse-person-at-place-1", "sk-short1", "Bearer of news", "ü sk- ä"] {
            assert_eq!(strike_shapes(plain), plain);
        }
    }
}
