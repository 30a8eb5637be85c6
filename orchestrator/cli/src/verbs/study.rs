//! `study`.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use socrates_app::output::Printer;
use socrates_app::study::{self, AnalyzeOptions, PlanOptions, ReadOptions, SimulateOptions};

use super::{Outcome, done};

/// Arguments of `study`.
#[derive(Debug, Args)]
pub(crate) struct Study {
    #[command(subcommand)]
    verb: StudyVerb,
}

#[derive(Debug, Subcommand)]
enum StudyVerb {
    /// List the shipped instruments, or print the file of one of them.
    Instruments {
        /// Name of an instrument whose items are printed.
        name: Option<String>,
    },
    /// Say how many people a study needs, by simulated studies; what they cost, and what fewer of them cannot show.
    Plan(Plan),
    /// Write the text of a preregistration from the study file, before answers are read.
    Preregister {
        /// Study file.
        study: PathBuf,
        /// File for the text.
        #[arg(long, default_value = "preregistration.md")]
        out: PathBuf,
    },
    /// Write answers of simulated people in every format that is read, to try a study.
    Simulate(Simulate),
    /// Read answers of Qualtrics, jsPsych or lines of JSON, and submissions of Prolific, into tables without ids and places.
    Read(Read),
    /// Compute statistics of ratings, and write the report, the methods text and scripts that check it.
    #[command(visible_alias = "analyse")]
    Analyze(Analyze),
}

/// Arguments of `study plan`.
#[derive(Debug, Clone, Args)]
struct Plan {
    /// Planners that each person compares, 2 to 8.
    #[arg(long, default_value_t = 3)]
    planners: usize,
    /// People per scenario; a multiple of the orders.
    #[arg(long, default_value_t = 42)]
    people: usize,
    /// Smallest effect that matters, log odds of a higher rating of the best planner against the first.
    #[arg(long, default_value_t = 1.0)]
    effect: f64,
    /// Scenarios; each has people of its own.
    #[arg(long, default_value_t = 1)]
    scenarios: usize,
    /// Items about each film.
    #[arg(long, default_value_t = 8)]
    items: usize,
    /// Length of a film, s.
    #[arg(long, default_value_t = 20.0)]
    length: f64,
    /// Pay for an hour.
    #[arg(long, default_value_t = 9.0)]
    hourly: f64,
    /// Seed of the simulated studies.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// Arguments of `study simulate`.
#[derive(Debug, Clone, Args)]
struct Simulate {
    /// Study file.
    #[arg(long, default_value = "study.toml")]
    design: PathBuf,
    /// Folder for the files.
    #[arg(long, default_value = "simulated")]
    out: PathBuf,
    /// People per scenario; default: as planned.
    #[arg(long)]
    people: Option<usize>,
    /// Effect of each planner, log odds, in the order of the study, such as `0,0.5,1`; default: none.
    #[arg(long, value_delimiter = ',', allow_hyphen_values = true)]
    effects: Vec<f64>,
    /// People who click without looking.
    #[arg(long, default_value_t = 0)]
    careless: usize,
    /// Share of answers that are skipped, 0 to 1.
    #[arg(long, default_value_t = 0.0)]
    skipped: f64,
    /// Seed.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// Arguments of `study read`.
#[derive(Debug, Clone, Args)]
struct Read {
    /// Files of answers; their formats are told apart by what they hold.
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// Study file.
    #[arg(long, default_value = "study.toml")]
    design: PathBuf,
    /// Folder for `ratings.csv` and `participants.csv`.
    #[arg(long, default_value = "tables")]
    out: PathBuf,
    /// Prolific's export of submissions.
    #[arg(long)]
    prolific: Option<PathBuf>,
    /// Which column of Qualtrics is what, by ImportId: `column,role,film,item`.
    #[arg(long)]
    codebook: Option<PathBuf>,
    /// File with the key that turns ids into names; made where it is missing. Keep it, and never hand it on.
    #[arg(long, default_value = "pid.key")]
    key: PathBuf,
}

/// Arguments of `study analyze`.
#[derive(Debug, Clone, Args)]
struct Analyze {
    /// Folder with `ratings.csv` (and `participants.csv`), or a table of ratings: `participant`, `item`, `raw`, and `film` or `scenario`
    /// and `planner`.
    answers: PathBuf,
    /// Study file.
    #[arg(long, default_value = "study.toml")]
    design: PathBuf,
    /// Folder for the report.
    #[arg(long, default_value = "results")]
    out: PathBuf,
    /// The text that `study preregister` wrote before; without it everything is called exploratory.
    #[arg(long)]
    preregistration: Option<PathBuf>,
}

impl Study {
    pub(super) fn act(&self, talk: &Printer) -> Outcome {
        done(match &self.verb {
            StudyVerb::Instruments { name } => study::instruments(talk, name.as_deref()),
            StudyVerb::Plan(of) => {
                let Plan { planners, people, effect, scenarios, items, length, hourly, seed } = of.clone();
                study::plan(talk, PlanOptions { planners, people, effect, scenarios, items, length, hourly, seed })
            }
            StudyVerb::Preregister { study, out } => study::preregister(talk, study, out),
            StudyVerb::Simulate(of) => {
                let Simulate { design, out, people, effects, careless, skipped, seed } = of.clone();
                study::simulate(talk, &SimulateOptions { design, out, people, effects, careless, skipped, seed })
            }
            StudyVerb::Read(of) => {
                let Read { files, design, out, prolific, codebook, key } = of.clone();
                study::read(talk, &ReadOptions { files, design, out, prolific, codebook, key })
            }
            StudyVerb::Analyze(of) => {
                let Analyze { answers, design, out, preregistration } = of.clone();
                study::analyze(talk, &AnalyzeOptions { answers, design, out, preregistration })
            }
        })
    }
}
