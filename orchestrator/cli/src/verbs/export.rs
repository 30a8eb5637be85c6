//! `export`: bundles in formats of others.

use std::path::PathBuf;

use clap::Args;
use socrates_app::exports::{self, ExportOptions};
use socrates_app::output::Printer;
use socrates_model::Run;

use super::{Outcome, done};

/// Arguments of `export`.
#[derive(Debug, Args)]
pub(crate) struct Export {
    /// A bundle, or a folder of bundles.
    what: PathBuf,
    /// Format, such as `trajnet`, `pedpy`, `jupedsim` or `socnav3`; `docs/export.md` has the table of all.
    #[arg(long)]
    to: String,
    /// Run to export, such as `reference-1`. Default: the first of each bundle.
    #[arg(long)]
    run: Option<Run>,
    /// Folder to write; each bundle of a library gets a folder in it. Default: `NAME-FORMAT`.
    #[arg(long, short)]
    out: Option<PathBuf>,
}

impl Export {
    pub(super) fn act(&self, talk: &Printer) -> Outcome {
        let Self { what, to, run, out } = self;
        let options = ExportOptions { what: what.clone(), format: to.clone(), run: run.clone(), out: out.clone() };
        done(exports::export(talk, &options))
    }
}
