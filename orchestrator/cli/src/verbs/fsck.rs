//! `fsck`.

use std::path::PathBuf;

use clap::Args;
use socrates_app::fsck;
use socrates_app::output::Printer;

use super::Outcome;

/// Arguments of `fsck`.
#[derive(Debug, Args)]
pub(crate) struct Fsck {
    /// Folders: of `cluster up --dir`, a library, a run, or its `.socrates`; bundles are held against the stores that are named with them.
    #[arg(required = true, value_name = "PATH")]
    folders: Vec<PathBuf>,
}

impl Fsck {
    pub(super) fn act(&self, talk: &Printer) -> Outcome {
        fsck::fsck(talk, &self.folders)
    }
}
