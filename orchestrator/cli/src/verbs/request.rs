//! `new` and `read`: requests.

use std::path::PathBuf;

use clap::Args;
use socrates_app::config::Config;
use socrates_app::output::Printer;
use socrates_app::{new_request, run};

use super::{Outcome, done};

/// Arguments of `new`.
#[derive(Debug, Args)]
pub(crate) struct New {
    /// File to write.
    file: PathBuf,
    /// Location: a shipped name or a folder.
    #[arg(long, default_value = "office")]
    location: String,
}

impl New {
    pub(super) async fn act(&self, talk: &Printer) -> Outcome {
        done(new_request::new(talk, &self.file, &self.location).await)
    }
}

/// Arguments of `read`.
#[derive(Debug, Args)]
pub(crate) struct Read {
    /// Request file.
    request: PathBuf,
    /// Write what was read as a form under the text, to be corrected there; it then wins over the text.
    #[arg(long)]
    write: bool,
    /// Show first what each pass of the small reader makes of the rough scenario.
    #[arg(long)]
    passes: bool,
}

impl Read {
    pub(super) fn act(&self, talk: &Printer, config: &Config) -> Outcome {
        done(run::read(talk, config, &self.request, self.write, self.passes))
    }
}
