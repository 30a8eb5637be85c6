//! `open`, `report`, `cite` and `cost`: what a bundle tells.

use std::path::PathBuf;

use clap::Args;
use socrates_app::config::Config;
use socrates_app::output::Printer;
use socrates_app::{cite, cost, explain, report};

use super::{Outcome, done};

/// Arguments of `open`.
#[derive(Debug, Args)]
pub(crate) struct Open {
    /// Bundle folder.
    bundle: PathBuf,
}

impl Open {
    pub(super) fn act(&self, talk: &Printer) -> Outcome {
        done(explain::open(talk, &self.bundle))
    }
}

/// Arguments of `report`.
#[derive(Debug, Args)]
pub(crate) struct Report {
    /// Bundle folder, or a folder that holds bundles.
    what: PathBuf,
}

impl Report {
    pub(super) fn act(&self, talk: &Printer) -> Outcome {
        done(report::report(talk, &self.what))
    }
}

/// Arguments of `cite`.
#[derive(Debug, Args)]
pub(crate) struct Cite {
    /// Bundle folder.
    bundle: PathBuf,
}

impl Cite {
    pub(super) fn act(&self, talk: &Printer) -> Outcome {
        done(cite::cite(talk, &self.bundle))
    }
}

/// Arguments of `cost`.
#[derive(Debug, Args)]
pub(crate) struct Cost {
    /// Bundle folders, folders that hold bundles, or folders that `labels opinion` wrote.
    #[arg(required = true)]
    what: Vec<PathBuf>,
    /// Table of prices (TOML, a table per model); default: `author.prices` of the configuration.
    #[arg(long, value_name = "FILE")]
    prices: Option<PathBuf>,
}

impl Cost {
    pub(super) fn act(&self, talk: &Printer, config: &Config) -> Outcome {
        done(cost::cost(talk, config, &self.what, self.prices.as_deref()))
    }
}
