//! What is wrong with something that somebody gave.

use std::fmt;

/// Bad input: where it stands, which value it is, what is wrong, and what helps.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    /// File, as it was named.
    pub file: String,
    /// Line, from 1; none where the file as a whole is meant.
    pub line: Option<u64>,
    /// Column or key.
    pub column: Option<String>,
    /// The value that stands there.
    pub value: Option<String>,
    /// What is wrong.
    pub what: String,
    /// What helps.
    pub hint: String,
}

impl Problem {
    /// A problem of a whole file.
    pub fn new(file: &str, what: impl Into<String>, hint: impl Into<String>) -> Self {
        let (what, hint) = (what.into(), hint.into());
        Self { file: file.to_owned(), line: None, column: None, value: None, what, hint }
    }

    /// With the line, from 1.
    #[must_use]
    pub fn line(mut self, line: u64) -> Self {
        self.line = Some(line);
        self
    }

    /// With the column or key.
    #[must_use]
    pub fn column(mut self, column: &str) -> Self {
        self.column = Some(column.to_owned());
        self
    }

    /// With the value, cut after 60 characters.
    #[must_use]
    pub fn value(mut self, value: &str) -> Self {
        let mut shown: String = value.chars().take(60).collect();
        if shown.len() < value.len() {
            shown.push('…');
        }
        self.value = Some(shown);
        self
    }

    /// Where it is and what is wrong, on one line without the hint.
    #[must_use]
    pub fn told(&self) -> String {
        let mut out = format!("`{}`", self.file);
        if let Some(line) = self.line {
            out.push_str(&format!(" line {line}"));
        }
        if let Some(column) = &self.column {
            out.push_str(&format!(", `{column}`"));
        }
        if let Some(value) = &self.value {
            out.push_str(&format!(" is `{value}`"));
        }
        format!("{out}: {}", self.what)
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}\n\nhint: {}", self.told(), self.hint)
    }
}

impl std::error::Error for Problem {}

/// Of a known list, the name that is nearest to one that was written.
pub(crate) fn nearest<'k>(written: &str, known: impl IntoIterator<Item = &'k str>) -> Option<&'k str> {
    let near = known.into_iter().map(|name| (strsim::damerau_levenshtein(written, name), name));
    near.filter(|(far, name)| *far <= 1 + name.len() / 4).min().map(|(_, name)| name)
}
