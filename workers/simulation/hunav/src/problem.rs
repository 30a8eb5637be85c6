//! What is wrong with an input, said so that it can be mended.

use std::fmt;

/// Whether something can run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// Nothing runs until it is mended.
    Error,
    /// It runs, and not quite as the file says.
    Warning,
}

/// One thing that is wrong with a file or an input: where, which value, what would be right.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub struct Problem {
    /// Whether it stops the run.
    pub severity: Severity,
    /// The file, as it was named to the reader.
    pub file: String,
    /// Line in it, from 1, where the writing style of the file lets it be found.
    pub line: Option<usize>,
    /// Section and key (`agent1.init_pose.x`); empty for the file as a whole.
    pub place: String,
    /// The value that was found, shortened; empty where there is none.
    pub value: String,
    /// What is wrong with it.
    pub message: String,
    /// What would be taken.
    pub hint: String,
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.file)?;
        if let Some(line) = self.line {
            write!(f, ":{line}")?;
        }
        f.write_str(": ")?;
        if self.severity == Severity::Warning {
            f.write_str("warning: ")?;
        }
        if !self.place.is_empty() {
            write!(f, "`{}` ", self.place)?;
        }
        if !self.value.is_empty() {
            write!(f, "is `{}`: ", self.value)?;
        }
        f.write_str(&self.message)?;
        if !self.hint.is_empty() {
            write!(f, "; {}", self.hint)?;
        }
        Ok(())
    }
}

/// Longest value that is repeated in a message, characters.
const SHOWN_CHARS: usize = 60;

impl Problem {
    /// An error about a place of a file.
    pub fn error(file: &str, place: impl Into<String>, message: impl Into<String>) -> Self {
        Self {
            severity: Severity::Error,
            file: file.to_owned(),
            line: None,
            place: place.into(),
            value: String::new(),
            message: message.into(),
            hint: String::new(),
        }
    }

    /// A warning about a place of a file.
    pub fn warning(file: &str, place: impl Into<String>, message: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, ..Self::error(file, place, message) }
    }

    /// The same with the value that was found.
    #[must_use]
    pub fn with_value(self, value: impl fmt::Display) -> Self {
        Self { value: shortened(&value.to_string()), ..self }
    }

    /// The same with what would be taken.
    #[must_use]
    pub fn with_hint(self, hint: impl Into<String>) -> Self {
        Self { hint: hint.into(), ..self }
    }

    /// Whether it stops the run.
    #[must_use]
    pub fn is_error(&self) -> bool {
        self.severity == Severity::Error
    }
}

/// The start of a text, on one line.
pub(crate) fn shortened(text: &str) -> String {
    let clean = text.chars().map(|c| if c.is_control() { ' ' } else { c });
    let mut short: String = clean.clone().take(SHOWN_CHARS).collect();
    if clean.count() > SHOWN_CHARS {
        short.push('…');
    }
    short
}

/// `did you mean`, where a name is close enough to one of these.
pub(crate) fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let folded = name.to_lowercase();
    known
        .into_iter()
        .map(|other| (strsim::damerau_levenshtein(&folded, &other.to_lowercase()), other))
        .min_by_key(|(distance, _)| *distance)
        .filter(|(distance, other)| *distance <= 1 + other.chars().count() / 4)
        .map(|(_, other)| other)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_problem_says_where_what_and_what_would_be_right() {
        let mut problem =
            Problem::error("a.yaml", "agent1.radius", "is below 0").with_value(-0.4).with_hint("allowed: 0.05 to 2 m");
        problem.line = Some(12);
        assert_eq!(problem.to_string(), "a.yaml:12: `agent1.radius` is `-0.4`: is below 0; allowed: 0.05 to 2 m");
    }

    #[test]
    fn only_close_names_are_suggested() {
        assert_eq!(nearest("raduis", ["radius", "max_vel"]), Some("radius"));
        assert_eq!(nearest("color", ["radius", "max_vel"]), None);
    }

    #[test]
    fn long_values_are_cut_and_stay_on_one_line() {
        let shown = shortened(&"x\n".repeat(500));
        assert!(shown.chars().count() <= SHOWN_CHARS + 1 && !shown.contains('\n'));
    }
}
