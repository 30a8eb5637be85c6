//! Exit codes, and the errors that carry them.

use std::fmt;

use socrates_model::Fault;

/// Documented exit codes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Code {
    /// Realised, or the verb did what was asked.
    Ok = 0,
    /// Our fault.
    Ours = 1,
    /// Bad input or usage.
    Input = 2,
    /// Bundle made, not realised.
    NotRealised = 3,
    /// Waits for a person.
    Waits = 4,
    /// Author unreachable.
    Author = 5,
    /// An experiment lost or doubled a result, or its checker complained.
    Unsafe = 6,
    /// Between a supervisor and its children only: the child cannot go on, and would not after another start either.
    Stuck = 65,
}

/// An error for the user: what, causes, a hint with a command that helps, and the exit code.
#[derive(Debug)]
pub struct Diagnostic {
    /// Exit code.
    pub code: Code,
    /// What is wrong, with the value.
    pub what: String,
    /// Causes or single problems, one a line.
    pub causes: Vec<String>,
    /// What helps.
    pub hint: String,
    /// What there is of a result all the same, for programs.
    pub result: Option<Box<serde_json::Value>>,
}

impl Diagnostic {
    /// Bad input.
    pub fn input(what: impl Into<String>, hint: impl Into<String>) -> Self {
        Self { code: Code::Input, what: what.into(), causes: Vec::new(), hint: hint.into(), result: None }
    }

    /// A fault of ours in what is being made: nothing is lost, and the same command goes on from there.
    pub fn resumes(what: impl Into<String>) -> Self {
        Self::input(what, "run the same command again; it resumes").with_code(Code::Ours)
    }

    /// Bad input with several problems.
    pub fn faults(what: impl Into<String>, faults: &[Fault], hint: impl Into<String>) -> Self {
        let causes = faults.iter().map(ToString::to_string).collect();
        Self { code: Code::Input, what: what.into(), causes, hint: hint.into(), result: None }
    }

    /// The object that programs get: what there is of a result, and the error.
    pub fn object(&self) -> serde_json::Value {
        let mut object = self.result.as_deref().cloned().unwrap_or_else(|| serde_json::json!({}));
        if let Some(members) = object.as_object_mut() {
            members.insert("error".to_owned(), self.what.clone().into());
            members.insert("causes".to_owned(), self.causes.clone().into());
            members.insert("hint".to_owned(), self.hint.clone().into());
        }
        object
    }

    /// What the object of a child says, for its supervisor.
    pub fn of_object(object: &serde_json::Value) -> Option<Self> {
        let text = |key: &str| object.get(key)?.as_str().map(str::to_owned);
        let causes = object.get("causes")?.as_array()?.iter().filter_map(|cause| cause.as_str().map(str::to_owned));
        Some(Self {
            code: Code::Ours,
            what: text("error")?,
            causes: causes.collect(),
            hint: text("hint")?,
            result: None,
        })
    }

    /// What is wrong and the first cause, on one line.
    pub fn short(&self) -> String {
        let cause = self.causes.first().map_or_else(String::new, |cause| format!(": {}", cause.trim()));
        format!("{}{cause}", self.what)
    }

    /// With another exit code.
    pub fn with_code(mut self, code: Code) -> Self {
        self.code = code;
        self
    }
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.what)?;
        for cause in &self.causes {
            write!(f, "\n  {cause}")?;
        }
        if !self.hint.is_empty() {
            write!(f, "\n\nhint: {}", self.hint)?;
        }
        Ok(())
    }
}

impl std::error::Error for Diagnostic {}
