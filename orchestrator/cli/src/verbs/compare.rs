//! `compare`.

use std::path::PathBuf;

use clap::Args;
use socrates_app::compare::{self, CompareOptions};
use socrates_app::config::Config;
use socrates_app::output::Printer;
use socrates_model::PlannerName;

use super::{Outcome, run};

/// Arguments of `compare`.
#[derive(Debug, Args)]
pub(crate) struct Compare {
    /// Request files and folders of them, which are run; or bundles and folders of bundles that are compared as they are.
    #[arg(required = true)]
    what: Vec<PathBuf>,
    /// The planner that the others are compared with; default: the first.
    #[arg(long, value_name = "PLANNER")]
    against: Option<PlannerName>,
    /// Film the first scenario and seed side by side: `.mp4` and `.webm` need ffmpeg, `.gif` and `.svg` need nothing.
    #[arg(long, value_name = "FILE")]
    film: Option<PathBuf>,
    /// In the film, call the planners robot A, robot B and so on, in an order that tells nothing of them.
    #[arg(long, requires = "film")]
    opaque: bool,
    /// How requests are run. Without `--planner`: the three of the case study, `socrates_mppi,ha_mppi,nav2can`; of bundles, all
    /// that were tested. `--out` is the folder of the comparison, default `runs/compare-SEED`.
    #[command(flatten)]
    options: run::Options,
}

impl Compare {
    pub(super) async fn act(&self, talk: &Printer, config: &Config) -> Outcome {
        let Self { what, against, film, opaque, options } = self;
        let options = CompareOptions {
            what: what.clone(),
            run: options.values(),
            against: against.clone(),
            film: film.clone(),
            opaque: *opaque,
        };
        compare::compare(talk, config, &options).await
    }
}
