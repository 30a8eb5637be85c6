//! `serve`: scenarios for drivers outside.

use std::path::PathBuf;

use clap::Args;
use socrates_app::config::Config;
use socrates_app::output::Printer;
use socrates_app::serve::{self, ServeOptions};

use super::{Outcome, done};

/// Arguments of `serve`.
#[derive(Debug, Args)]
pub(crate) struct Serve {
    /// Request files, folders of them, or bundles.
    #[arg(required = true)]
    what: Vec<PathBuf>,
    /// Folder whose name drivers connect by.
    #[arg(long, default_value = "served")]
    out: PathBuf,
    /// Base seed with which requests are authored.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Keep the recording of every run in that folder.
    #[arg(long)]
    keep: bool,
}

impl Serve {
    pub(super) async fn act(&self, talk: &Printer, config: &Config) -> Outcome {
        let Self { what, out, seed, keep } = self;
        let options = ServeOptions { what: what.clone(), out: out.clone(), seed: *seed, keep: *keep };
        done(serve::serve(talk, config, &options).await)
    }
}
