//! `run` and `demo`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use socrates_app::config::Config;
use socrates_app::keep::Keep;
use socrates_app::output::Printer;
use socrates_app::run;
use socrates_app::run_options::{self, RunOptions};
use socrates_app::shard::Shard;
use socrates_model::request::MAX_VARIANTS;
use socrates_model::{AuthorSpec, PlannerName, Seeds};

use super::Outcome;

/// What a run has to be for the exit code 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Require {
    /// Realised.
    Realised,
    /// Made, with any verdict.
    Any,
}

/// Arguments of `run`.
#[derive(Debug, Args)]
pub(crate) struct Run {
    /// Request files, or folders of them.
    #[arg(required = true)]
    requests: Vec<PathBuf>,
    /// Make one share of the scenarios, `0/200` to `199/200`, by itself: what they become does not depend on the number of shards.
    /// `socrates library merge` puts the folders together.
    #[arg(long, value_name = "K/N")]
    shard: Option<Shard>,
    /// Which bundles of several scenarios are kept: `folders`, `packed` (each in one file, `NAME.tar.zst`), `failed` (packed, those that
    /// were not realised) or `index` (none: list, page and tables alone); folders up to 1000 scenarios, else packed, if it is left out.
    #[arg(long, value_name = "WHICH")]
    keep: Option<Keep>,
    /// Make nothing: say how many different scenarios and jobs there would be, and about how much CPU, disk, calls and tokens they take.
    #[arg(long)]
    dry_run: bool,
    /// Options.
    #[command(flatten)]
    options: Options,
}

impl Run {
    pub(super) async fn act(&self, talk: &Printer, config: &Config) -> Outcome {
        run::run(talk, config, &self.requests, &self.values()).await
    }

    /// The same into a library, also where there is one scenario.
    pub(super) async fn build(&self, talk: &Printer, config: &Config) -> Outcome {
        run::build(talk, config, &self.requests, &self.values()).await
    }

    fn values(&self) -> RunOptions {
        RunOptions { shard: self.shard, keep: self.keep, dry_run: self.dry_run, ..self.options.values() }
    }
}

/// Options of `run` and `demo`.
#[derive(Debug, Clone, Args)]
pub(crate) struct Options {
    /// Folder for the bundle; default `runs/<name>`. With several scenarios: the folder that holds them.
    #[arg(long)]
    out: Option<PathBuf>,
    /// Base seed of authoring; of the simulation too, unless `--seeds` or the request names its seeds.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Simulation seeds, `1..20` or `1,4,9`; wins over the request.
    #[arg(long)]
    seeds: Option<Seeds>,
    /// Planners under test, separated by commas; wins over the request.
    #[arg(long, value_delimiter = ',')]
    planner: Vec<PlannerName>,
    /// Different scenarios to make from each request, 1 to 100000, as many as there are; wins over the request.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_VARIANTS)))]
    variants: Option<u32>,
    /// Let variants repeat one another: take the seeds in turn instead of choosing different scenarios.
    #[arg(long)]
    repeats: bool,
    /// Author: `auto`, `offline`, `openai:MODEL`, `responses:MODEL`, `anthropic:MODEL`, `gemini:MODEL`, `vllm:`, `ollama:`, `llamacpp:`
    /// or `lmstudio:MODEL`, `console:NAME`, `cassette:FOLDER`, `record:FOLDER=AUTHOR`, `replay:FOLDER=AUTHOR`; wins over the request.
    #[arg(long)]
    author: Option<AuthorSpec>,
    /// Pace of the simulation: `max`, or simulated seconds per second; default `max`, 1 with `--view`.
    #[arg(long)]
    pace: Option<String>,
    /// Exit with 3 unless the verdict is at least this.
    #[arg(long, value_enum, default_value_t = Require::Realised)]
    require: Require,
    /// Worker processes of the simulation stage.
    #[arg(long)]
    workers: Option<u32>,
    /// Faults put into the author's answers, for experiments: `gdisc=0.3,bxml=0.1,first_only=true`; each number is
    /// a probability per ask.
    #[arg(long, value_name = "KIND=RATE,…", default_value = "")]
    inject: String,
    /// Start this command with the run: a driver for `--planner external:NAME`, or for people of `[people]`. It finds the bus by SOCRATES_ENDPOINT and
    /// SOCRATES_NAMESPACE, and leaves when its standard input closes.
    #[arg(long, value_name = "COMMAND")]
    driver: Option<String>,
    /// Look at the proposal, then at paths and behaviors, before they go on: accept, change in words, edit, have made again.
    #[arg(long)]
    ask: bool,
    /// Show the run in a browser while it happens, at pace 1 unless `--pace` says otherwise, and afterwards until Ctrl-C.
    #[arg(long)]
    view: bool,
}

impl Options {
    pub(super) async fn demo(&self, talk: &Printer, config: &Config) -> Outcome {
        run::demo(talk, config, &self.values()).await
    }

    pub(super) fn values(&self) -> RunOptions {
        let own = self.clone();
        let pace = own.pace.unwrap_or_else(|| if own.view { "1" } else { "max" }.to_owned());
        let require = match own.require {
            Require::Any => run_options::Require::Any,
            Require::Realised => run_options::Require::Realised,
        };
        RunOptions {
            out: own.out,
            seed: own.seed,
            seeds: own.seeds,
            planner: own.planner,
            variants: own.variants,
            repeats: own.repeats,
            shard: None,
            keep: None,
            dry_run: false,
            author: own.author,
            pace,
            require,
            workers: own.workers,
            inject: own.inject,
            driver: own.driver,
            ask: own.ask,
            view: own.view,
        }
    }
}
