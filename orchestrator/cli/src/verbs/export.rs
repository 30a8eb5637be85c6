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
    #[arg(required_unless_present = "formats")]
    what: Option<PathBuf>,
    /// Format, such as `trajnet`, `jupedsim` or `hunav-1.1`; `--formats` lists all.
    #[arg(long, required_unless_present = "formats")]
    to: Option<String>,
    /// Run to export, such as `reference-1`. Default: the first of each bundle.
    #[arg(long)]
    run: Option<Run>,
    /// Folder to write; each bundle of a library gets a folder in it. Default: `NAME-FORMAT`.
    #[arg(long, short)]
    out: Option<PathBuf>,
    /// List the formats that this program writes, and end.
    #[arg(long, exclusive = true)]
    formats: bool,
}

impl Export {
    pub(super) fn act(&self, talk: &Printer) -> Outcome {
        let (Some(what), Some(format)) = (self.what.clone(), self.to.clone()) else {
            exports::formats(talk);
            return done(Ok(()));
        };
        let options = ExportOptions { what, format, run: self.run.clone(), out: self.out.clone() };
        done(exports::export(talk, &options))
    }
}
