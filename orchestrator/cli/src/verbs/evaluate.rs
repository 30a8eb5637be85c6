//! `evaluate`.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use socrates_app::config::Config;
use socrates_app::evaluate::{self, AuthorOptions};
use socrates_app::output::Printer;

use super::{Outcome, done};

/// Arguments of `evaluate`.
#[derive(Debug, Args)]
pub(crate) struct Evaluate {
    /// What to evaluate.
    #[command(subcommand)]
    verb: EvaluateVerb,
}

/// What is evaluated.
#[derive(Debug, Subcommand)]
enum EvaluateVerb {
    /// Measure authors: requests, locations, repeats and arms of a specification.
    Author(Author),
}

/// Arguments of `evaluate author`.
#[derive(Debug, Clone, Args)]
struct Author {
    /// Specification: a TOML file, or one that comes with the program: `paper`, `feedback` (what being told the faults is
    /// worth), `faults` (which check finds which injected fault).
    #[arg(default_value = "paper")]
    spec: PathBuf,
    /// Folder for `results.csv` and `report.md`, `confusion.csv` and `confusion.md`.
    #[arg(long, default_value = "evaluation")]
    out: PathBuf,
    /// Only the first so many scenarios of every location and kind, for a quick look.
    #[arg(long)]
    limit: Option<usize>,
    /// Worker processes of the simulation stage.
    #[arg(long)]
    workers: Option<u32>,
}

impl Evaluate {
    pub(super) async fn act(&self, talk: &Printer, config: &Config) -> Outcome {
        let EvaluateVerb::Author(options) = &self.verb;
        let Author { spec, out, limit, workers } = options.clone();
        done(evaluate::evaluate(talk, config, &AuthorOptions { spec, out, limit, workers }).await)
    }
}
