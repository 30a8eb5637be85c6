//! What a model was asked beside the bundles, kept so that `cost` adds it up: a file in the shape of a bundle's provenance.

use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use socrates_author::Answer;

use crate::exit::Diagnostic;
use crate::files;

/// Its name in the folder of what was asked.
const FILE: &str = "asked.json";
/// Largest ledger that is read, bytes.
const MAX_BYTES: u64 = 256 * 1024 * 1024;

/// The books of what one author was asked.
#[derive(Debug)]
pub(crate) struct Ledger {
    author: String,
    jobs: Vec<Value>,
}

impl Ledger {
    /// Empty books of an author.
    pub(crate) fn of(author: &str) -> Self {
        Self { author: author.to_owned(), jobs: Vec::new() }
    }

    /// Books a question, by what it is called, with everything that was answered. An answer without a model is a call that got none.
    pub(crate) fn book(&mut self, question: &str, answers: &[Answer]) {
        let exchanges: Vec<Value> = answers
            .iter()
            .map(|answer| {
                json!({"author": self.author, "model": answer.model, "answer": answer.text,
                    "tokens": [answer.tokens.0, answer.tokens.1], "how": answer.how})
            })
            .collect();
        self.jobs.push(json!({"question": question, "exchanges": exchanges}));
    }

    /// Writes the books into a folder.
    pub(crate) fn write(&self, folder: &Path) -> Result<(), Diagnostic> {
        let text = json!({"author": self.author, "jobs": self.jobs}).to_string();
        files::write(&folder.join(FILE), (text + "\n").as_bytes())
    }
}

/// The file of the books in a folder, where it has any.
pub(crate) fn in_folder(folder: &Path) -> Option<PathBuf> {
    Some(folder.join(FILE)).filter(|file| file.is_file())
}

/// Reads books, in the shape of a bundle's provenance.
pub(crate) fn read(file: &Path) -> Result<Value, Diagnostic> {
    let hint = "take the file as the program wrote it";
    let bytes = files::bytes(file, MAX_BYTES, hint)?;
    serde_json::from_slice(&bytes).map_err(|why| Diagnostic::input(format!("`{}`: {why}", file.display()), hint))
}
