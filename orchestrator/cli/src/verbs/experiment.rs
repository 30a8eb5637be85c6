//! `experiment`, and the parts of one on processes.

use std::path::PathBuf;

use clap::Args;
use socrates_app::config::Config;
use socrates_app::experiment::{ExperimentOptions, PlayOptions, experiment, play};
use socrates_app::output::Printer;

use super::{Outcome, done};

/// Arguments of `experiment`.
#[derive(Debug, Clone, Args)]
pub(crate) struct Experiment {
    /// Specification: a TOML file, or one that comes with the program: `reliability` (asked once, again, and again with what was
    /// wrong), `worker-loss` (tries and leases), `outages` (pauses while an author's server is away), `processes` (a small one that
    /// kills and stops real processes).
    spec: PathBuf,
    /// Folder for the tables, the plots, the page and the specification with every value.
    #[arg(long, default_value = "experiment")]
    out: PathBuf,
    /// Number of scenarios of each cell, instead of those of the specification.
    #[arg(long)]
    scenarios: Option<u32>,
}

impl Experiment {
    pub(super) async fn act(&self, talk: &Printer, config: &Config) -> Outcome {
        let Self { spec, out, scenarios } = self.clone();
        done(experiment(talk, config, &ExperimentOptions { spec, out, scenarios }).await)
    }
}

/// Arguments of `play`.
#[derive(Debug, Clone, Args)]
pub(crate) struct Play {
    /// Stage of a worker; without it, the orchestrator.
    #[arg(long)]
    stage: Option<String>,
    /// The experiment with every value.
    #[arg(long)]
    spec: PathBuf,
    /// Number of the cell.
    #[arg(long)]
    cell: usize,
    /// Endpoint of the router.
    #[arg(long)]
    connect: String,
    /// Folder of the job store and the artifacts.
    #[arg(long)]
    dir: PathBuf,
    /// Name among those of its stage.
    #[arg(long)]
    name: String,
}

impl Play {
    pub(super) async fn act(&self, talk: &Printer, config: &Config) -> Outcome {
        let Self { stage, spec, cell, connect, dir, name } = self.clone();
        done(play(talk, config, &PlayOptions { stage, spec, cell, connect, dir, name }).await)
    }
}
