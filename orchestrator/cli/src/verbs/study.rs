//! `study`.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use socrates_app::config::Config;
use socrates_app::output::Printer;
use socrates_app::study::{
    self, AnalyzeOptions, BuildOptions, Clips, CorrelateOptions, NewOptions, PlanOptions, ReadOptions, ServeOptions,
    SimulateOptions,
};
use socrates_model::{HumanId, PlannerName};

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
    /// Write a study file from the bundles of a comparison: its films, with opaque names, and texts to be filled in.
    New(New),
    /// Make the films and the survey page of a study: a kit for participants in which nothing names a planner.
    Build(Build),
    /// Serve the survey page on a port of this machine, and keep what is answered.
    Serve(Serve),
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
    /// Read answers of our own page, Qualtrics, jsPsych or LimeSurvey, and submissions of Prolific, into tables without ids and places.
    Read(Read),
    /// Compute statistics of ratings, and write the report, the methods text and scripts that check it.
    #[command(visible_alias = "analyse")]
    Analyze(Analyze),
    /// Correlate metrics of the runs with what people said of their films.
    Correlate(Correlate),
}

/// Arguments of `study new`.
#[derive(Debug, Clone, Args)]
struct New {
    /// Bundles with runs of the same scenarios under several planners, or folders of them, such as those of `socrates compare`.
    #[arg(required = true)]
    bundles: Vec<PathBuf>,
    /// File to write.
    #[arg(long, short, default_value = "study.toml")]
    out: PathBuf,
    /// Planners to compare, such as `socrates_mppi,nav2can`, the reference of odds ratios first; default: those that all scenarios have.
    #[arg(long, value_delimiter = ',')]
    planner: Vec<PlannerName>,
    /// Seeds of the runs, such as `1,2`; default: the first that all scenarios and planners have.
    #[arg(long, value_delimiter = ',')]
    seeds: Vec<u64>,
    /// Instruments; `socrates study instruments` lists them.
    #[arg(long, value_delimiter = ',', default_value = "psi,principles")]
    instruments: Vec<String>,
    /// People per scenario; default: 42, or the next multiple of the orders.
    #[arg(long)]
    people: Option<usize>,
    /// Show what this person sees, such as `human_2`, instead of the view from above.
    #[arg(long, value_name = "PERSON")]
    from: Option<HumanId>,
    /// Title of the survey, which participants read.
    #[arg(long, default_value = "Robots among people")]
    title: String,
    /// Replace an existing file.
    #[arg(long)]
    force: bool,
}

/// Arguments of `study build`.
#[derive(Debug, Clone, Args)]
struct Build {
    /// Study file.
    #[arg(default_value = "study.toml")]
    design: PathBuf,
    /// Folder of the kit.
    #[arg(long, short, default_value = "kit")]
    out: PathBuf,
    /// Make no clips for other survey programs, though ffmpeg is installed.
    #[arg(long)]
    no_clips: bool,
    /// Folder with https to which you will upload the clips, such as `https://films.example.org/study1`: then the survey is also written
    /// for Qualtrics (QSF and Advanced TXT) and LimeSurvey.
    #[arg(long, value_name = "URL")]
    media_url: Option<String>,
}

/// Arguments of `study serve`.
#[derive(Debug, Clone, Args)]
struct Serve {
    /// The kit that `study build` made.
    #[arg(default_value = "kit")]
    kit: PathBuf,
    /// Study file.
    #[arg(long, default_value = "study.toml")]
    design: PathBuf,
    /// Folder of answers; an existing one is gone on with.
    #[arg(long, default_value = "answers")]
    answers: PathBuf,
    /// File with the key that turns ids into names, as of `study read`; made where it is missing.
    #[arg(long, default_value = "pid.key")]
    key: PathBuf,
    /// Port of this machine; default: any that is free.
    #[arg(long)]
    port: Option<u16>,
    /// Name under which a proxy of yours passes people on to this port, such as `study.example.org`; may be given several times.
    #[arg(long)]
    host: Vec<String>,
    /// Minutes without a sign of somebody after which their order is given to somebody else.
    #[arg(long, default_value_t = 60, value_parser = clap::value_parser!(u64).range(1..=10_000))]
    patience: u64,
    /// Leave when standard input closes.
    #[arg(long, hide = true)]
    tied: bool,
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

/// Arguments of `study correlate`.
#[derive(Debug, Clone, Args)]
struct Correlate {
    /// Folder with `ratings.csv` (and `participants.csv`), or a table of ratings.
    #[arg(default_value = "tables")]
    answers: PathBuf,
    /// Study file; its bundles hold the metrics.
    #[arg(long, default_value = "study.toml")]
    design: PathBuf,
    /// Metrics that you expect something of, such as `human_distance_min,space_compliance`.
    #[arg(long, value_delimiter = ',', conflicts_with = "search")]
    metrics: Vec<String>,
    /// Look for the metric that fits best, without the scenarios of --hold-out, which then judge it.
    #[arg(long)]
    search: bool,
    /// Scenarios that the search does not see.
    #[arg(long, value_delimiter = ',', requires = "search")]
    hold_out: Vec<String>,
    /// Folder for the tables.
    #[arg(long, default_value = "correlations")]
    out: PathBuf,
}

impl Study {
    /// Whether this process is the child of another one that it leaves with.
    pub(super) const fn is_tied(&self) -> bool {
        matches!(self.verb, StudyVerb::Serve(Serve { tied: true, .. }))
    }

    pub(super) async fn act(&self, talk: &Printer, config: &Config) -> Outcome {
        done(match &self.verb {
            StudyVerb::New(of) => {
                let New { bundles: what, out, planner: planners, seeds, instruments, people, from, title, force } =
                    of.clone();
                study::new(talk, &NewOptions { what, out, planners, seeds, instruments, people, from, title, force })
            }
            StudyVerb::Build(of) => {
                let Build { design, out, no_clips, media_url } = of.clone();
                let clips = if no_clips { Clips::None } else { Clips::Auto };
                study::build(talk, config, &BuildOptions { design, out, clips, media_url })
            }
            StudyVerb::Serve(of) => {
                let Serve { kit, design, answers, key, port, host: hosts, patience: patience_min, tied } = of.clone();
                let options = ServeOptions { kit, design, answers, key, port, hosts, patience_min, tied };
                study::serve(talk, &options).await
            }
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
            StudyVerb::Correlate(of) => {
                let Correlate { answers, design, metrics, search, hold_out, out } = of.clone();
                study::correlate(talk, &CorrelateOptions { answers, design, metrics, search, hold_out, out })
            }
            StudyVerb::Analyze(of) => {
                let Analyze { answers, design, out, preregistration } = of.clone();
                study::analyze(talk, &AnalyzeOptions { answers, design, out, preregistration })
            }
        })
    }
}
