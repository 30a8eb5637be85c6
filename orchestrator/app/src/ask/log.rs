//! What was seen and said, kept in the work folder: undo reaches back through it, and who left comes back to it.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::version::Version;
use crate::exit::Diagnostic;

/// How a version came about that an author made.
pub(super) const MADE: &str = "made by the author";
/// The same of one that a person had wanted otherwise.
pub(super) const MADE_AGAIN: &str = "made again";
/// Format number of the file.
const FORMAT: u32 = 1;
/// Largest file that is read, bytes.
const MOST_BYTES: u64 = 64 * 1024 * 1024;

/// One version and how it came about.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Kept {
    /// `made by the author`, `"human_2 walks slower"`, `edited by hand`.
    pub(super) how: String,
    /// The version.
    pub(super) version: Version,
}

/// Versions, oldest first; the last one stands.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Log {
    format: u32,
    /// The job whose look it is.
    pub(super) look: String,
    /// Versions.
    pub(super) versions: Vec<Kept>,
    /// What the person typed in this look.
    pub(super) said: Vec<String>,
}

impl Log {
    /// Nothing yet.
    pub(super) const fn new() -> Self {
        Self { format: FORMAT, look: String::new(), versions: Vec::new(), said: Vec::new() }
    }

    /// Begins the look of a job, or goes on with it when it was left. Gives the version before, when there is one.
    pub(super) fn begin(&mut self, look: &str, came: Version, how: &str) -> Option<Version> {
        let before = self.versions.last().map(|kept| kept.version.clone());
        if self.look == look && before.is_some() {
            return None;
        }
        look.clone_into(&mut self.look);
        self.said.clear();
        if before.as_ref() != Some(&came) {
            self.versions.push(Kept { how: how.to_owned(), version: came });
        }
        before
    }

    /// What the author made last and what the person made of it; nothing where they changed nothing.
    pub(super) fn edits(&self) -> Option<(Version, Version)> {
        let base = self.versions.iter().rev().find(|kept| kept.how == MADE || kept.how == MADE_AGAIN)?;
        let mine = self.now().filter(|mine| **mine != base.version)?;
        Some((base.version.clone(), mine.clone()))
    }

    /// The version that stands.
    pub(super) fn now(&self) -> Option<&Version> {
        self.versions.last().map(|kept| &kept.version)
    }

    /// A new version stands.
    pub(super) fn push(&mut self, how: &str, version: Version) {
        self.versions.push(Kept { how: how.to_owned(), version });
    }

    /// Takes the last version back, unless the one before lacks what is looked at; says how the undone one had come about.
    pub(super) fn undo(&mut self, whole: bool) -> Option<String> {
        let before = self.versions.iter().rev().nth(1)?;
        if whole && (before.version.paths.is_none() || before.version.behaviors.is_none()) {
            return None;
        }
        self.versions.pop().map(|kept| kept.how)
    }
}

/// Where the log of a work folder is.
#[derive(Debug, Clone)]
pub(super) struct Shelf(PathBuf);

impl Shelf {
    /// The file of a work folder.
    pub(super) fn of(work: &Path) -> Self {
        Self(work.join("ask.json"))
    }

    /// The log, if one was kept.
    pub(super) fn load(&self) -> Result<Log, Diagnostic> {
        if !self.0.exists() {
            return Ok(Log::new());
        }
        let hint = "remove it to begin the looks anew; what the authors made is kept";
        let text = crate::files::text(&self.0, MOST_BYTES, hint)?;
        let log: Log = serde_json::from_str(&text)
            .map_err(|why| Diagnostic::input(format!("`{}` holds no looks: {why}", self.0.display()), hint))?;
        if log.format != FORMAT {
            let what = format!("`{}` has format {}, this version reads {FORMAT}", self.0.display(), log.format);
            return Err(Diagnostic::input(what, hint));
        }
        Ok(log)
    }

    /// Keeps the log; a crash leaves the old one or the new one.
    pub(super) fn keep(&self, log: &Log) -> Result<(), Diagnostic> {
        let cannot = |why: String| Diagnostic::input(format!("cannot write `{}`: {why}", self.0.display()), "");
        let text = serde_json::to_string(log).map_err(|why| cannot(why.to_string()))?;
        let beside = self.0.with_extension("new");
        std::fs::write(&beside, text)
            .and_then(|()| std::fs::rename(&beside, &self.0))
            .map_err(|why| cannot(why.to_string()))
    }
}
