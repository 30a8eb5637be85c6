//! `experiment`.

use std::path::PathBuf;

use clap::Args;
use socrates_app::experiment::{ExperimentOptions, experiment};
use socrates_app::output::Printer;

use super::{Outcome, done};

/// Arguments of `experiment`.
#[derive(Debug, Clone, Args)]
pub(crate) struct Experiment {
    /// Specification: a TOML file, or one that comes with the program: `reliability` (asked once, again, and again with what was
    /// wrong), `worker-loss` (tries and leases), `outages` (pauses while an author's server is away).
    spec: PathBuf,
    /// Folder for the tables, the plots, the page and the specification with every value.
    #[arg(long, default_value = "experiment")]
    out: PathBuf,
    /// Number of scenarios of each cell, instead of those of the specification.
    #[arg(long)]
    scenarios: Option<u32>,
}

impl Experiment {
    pub(super) fn act(&self, talk: &Printer) -> Outcome {
        let Self { spec, out, scenarios } = self.clone();
        done(experiment(talk, &ExperimentOptions { spec, out, scenarios }))
    }
}
