//! `library` and `labels`: what is taken out of many bundles.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use socrates_app::output::Printer;
use socrates_app::{export_chat, labels};

use super::{Outcome, done};

/// Arguments of `library`.
#[derive(Debug, Args)]
pub(crate) struct Library {
    /// What to do.
    #[command(subcommand)]
    verb: LibraryVerb,
}

/// What is done with a library.
#[derive(Debug, Subcommand)]
enum LibraryVerb {
    /// Write what authors were asked and answered as training data.
    Export {
        /// Bundle folders, or folders that hold bundles.
        #[arg(required = true)]
        what: Vec<PathBuf>,
        /// Folder for `chat.jsonl` (answers that were taken), `preferences.jsonl` (chosen and rejected) and `index.jsonl`.
        #[arg(long, value_name = "DIR")]
        chat_jsonl: PathBuf,
    },
}

impl Library {
    pub(super) fn act(&self, talk: &Printer) -> Outcome {
        match &self.verb {
            LibraryVerb::Export { what, chat_jsonl } => done(export_chat::export(talk, what, chat_jsonl)),
        }
    }
}

/// Arguments of `labels`.
#[derive(Debug, Args)]
pub(crate) struct Labels {
    /// What to do.
    #[command(subcommand)]
    verb: LabelsVerb,
}

/// Verbs of `labels`.
#[derive(Debug, Subcommand)]
enum LabelsVerb {
    /// Write a page on which people label runs: simulable, appropriate, as asked. It needs no network and saves a CSV.
    Page {
        /// Bundle folders, or folders that hold bundles.
        #[arg(required = true)]
        bundles: Vec<PathBuf>,
        /// File to write.
        #[arg(long, short, default_value = "labels.html")]
        out: PathBuf,
        /// Only the first run of each bundle.
        #[arg(long)]
        first: bool,
        /// Heading of the page.
        #[arg(long, default_value = "What do you see?")]
        title: String,
    },
}

impl Labels {
    pub(super) fn act(&self, talk: &Printer) -> Outcome {
        match &self.verb {
            LabelsVerb::Page { bundles, out, first, title } => done(labels::page(talk, bundles, out, *first, title)),
        }
    }
}
