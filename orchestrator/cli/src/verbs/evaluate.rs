//! `evaluate`.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use socrates_app::config::Config;
use socrates_app::evaluate::{self, AuthorOptions};
use socrates_app::output::Printer;
use socrates_model::AuthorSpec;

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
    /// worth), `faults` (which check finds which injected fault), `arms` (every way of asking one author).
    #[arg(default_value = "paper")]
    spec: PathBuf,
    /// Folder for `results.csv` and `report.md`, `confusion.csv` and `confusion.md`.
    #[arg(long, default_value = "evaluation")]
    out: PathBuf,
    /// Only the first so many scenarios of every location and kind, for a quick look.
    #[arg(long)]
    limit: Option<usize>,
    /// Author of every arm of a grid, such as `openai:gpt-4o`; without it, the one that the specification names.
    #[arg(long)]
    author: Option<AuthorSpec>,
    /// Keep the bundles of each arm, in `arm-1`, `arm-2`, …, for blind judges (`socrates labels page`).
    #[arg(long)]
    bundles: bool,
    /// Worker processes of the simulation stage.
    #[arg(long)]
    workers: Option<u32>,
}

impl Evaluate {
    pub(super) async fn act(&self, talk: &Printer, config: &Config) -> Outcome {
        let EvaluateVerb::Author(options) = &self.verb;
        let Author { spec, out, limit, author, bundles, workers } = options.clone();
        let options = AuthorOptions { spec, out, limit, author, bundles, workers };
        done(evaluate::evaluate(talk, config, &options).await)
    }
}
