//! `library` and `labels`: many bundles together.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use socrates_app::config::Config;
use socrates_app::labels::{
    Blind, CalibrateOptions, CompareOptions, ObserveOptions, ObservedOptions, OpinionOptions, PageOptions,
};
use socrates_app::library_coverage::{self, CoverageOptions};
use socrates_app::library_diversity::{self, DiversityOptions};
use socrates_app::merge::{self, MergeOptions};
use socrates_app::output::Printer;
use socrates_app::query::{self, Condition, QueryOptions};
use socrates_app::{export_chat, labels, report, verify};

use super::{Outcome, done};

/// Arguments of `library`.
#[derive(Debug, Args)]
pub(crate) struct Library {
    /// What to do.
    #[command(subcommand)]
    verb: LibraryVerb,
}

/// Columns of `library list`.
const LISTED: [&str; 7] = ["request", "planner", "seed", "verdict", "kind", "path", "reason"];

/// What is done with a library.
#[derive(Debug, Subcommand)]
enum LibraryVerb {
    /// Make a library from requests: `run` by another name, with the same options, that makes a library of a single scenario too.
    Build(Box<super::run::Run>),
    /// Put the shards of a batch together: the library that one run would have made.
    Merge {
        /// Folders of `run --shard`, or folders that hold such folders.
        #[arg(required = true)]
        shards: Vec<PathBuf>,
        /// Folder of the library.
        #[arg(long, value_name = "DIR")]
        out: PathBuf,
        /// Move the bundles out of the shards instead of copying them.
        #[arg(long = "move")]
        moves: bool,
    },
    /// Check that every file of every bundle is as it was written, and that no scenario of the list lacks.
    Verify {
        /// Libraries, bundles, or folders that hold bundles.
        #[arg(required = true)]
        what: Vec<PathBuf>,
    },
    /// Print every run of a library in a line: request, planner, seed, verdict, whether it repeats another, where it lies, and why.
    List {
        /// Folder of the library.
        library: PathBuf,
    },
    /// Print what a library covers and lacks: canonical scenarios, encounter angles by density of people, places, locations, contexts,
    /// planners and verdicts, with the number of scenarios and of realised ones in each cell.
    Coverage {
        /// Folder of the library.
        library: PathBuf,
        /// Write every cell as a table too (`.csv`).
        #[arg(long, value_name = "FILE")]
        out: Option<PathBuf>,
    },
    /// Print how different the scenarios of a library are: edits of the nodes that robot and people pass, and time warping of the robot's
    /// tracks, over all pairs on one location and for each scenario's nearest.
    Diversity {
        /// Libraries, bundles, or folders that hold bundles.
        #[arg(required = true)]
        what: Vec<PathBuf>,
        /// Scenarios that are compared, at most; of more, as many that are evenly spread over the list.
        #[arg(long, value_name = "N", default_value_t = 200)]
        most: usize,
        /// Write every pair as a table too (`.csv`).
        #[arg(long, value_name = "FILE")]
        out: Option<PathBuf>,
    },
    /// Write page and tables of a library anew; of more than 1000 scenarios several pages that lead to each other.
    Gallery {
        /// Folder of the library.
        library: PathBuf,
    },
    /// Print the runs that fulfill conditions, as a table, or their folders.
    Query {
        /// Folder of the library.
        library: PathBuf,
        /// A condition on a column of `index.csv`, such as `verdict=realised` or `human_distance_min<0.5` (= != < <= > >= ~); all of several
        /// have to hold.
        #[arg(long = "where", value_name = "CONDITION")]
        conditions: Vec<Condition>,
        /// Columns to print, separated by commas; all if it is left out.
        #[arg(long, value_delimiter = ',', value_name = "NAME,…")]
        columns: Vec<String>,
        /// Print the folders of the scenarios alone, for other commands.
        #[arg(long, conflicts_with = "columns")]
        paths: bool,
        /// Write the table to this file instead of printing it: `.csv`, or `.parquet` in a program built with the feature `parquet`.
        #[arg(long, value_name = "FILE", conflicts_with = "paths")]
        out: Option<PathBuf>,
    },
    /// Write what authors were asked and answered as training data.
    Export {
        /// Bundle folders, or folders that hold bundles.
        #[arg(required = true)]
        what: Vec<PathBuf>,
        /// Folder for `chat.jsonl` (answers that were taken), `preferences.jsonl` (chosen and rejected) and `index.jsonl`.
        #[arg(long, value_name = "DIR")]
        chat_jsonl: PathBuf,
    },
}

impl Library {
    pub(super) async fn act(&self, talk: &Printer, config: &Config) -> Outcome {
        match &self.verb {
            LibraryVerb::Build(run) => run.build(talk, config).await,
            LibraryVerb::Merge { shards, out, moves } => {
                merge::merge(talk, &MergeOptions { shards: shards.clone(), out: out.clone(), moves: *moves })
            }
            LibraryVerb::Verify { what } => verify::verify(talk, what),
            LibraryVerb::List { library } => {
                let (library, columns) = (library.clone(), LISTED.map(str::to_owned).into());
                query::query(talk, &QueryOptions { library, conditions: Vec::new(), columns, paths: false, out: None })
            }
            LibraryVerb::Coverage { library, out } => {
                let (library, out) = (library.clone(), out.clone());
                library_coverage::coverage(talk, &CoverageOptions { library, out })
            }
            LibraryVerb::Diversity { what, most, out } => {
                let (what, most, out) = (what.clone(), *most, out.clone());
                done(library_diversity::diversity(talk, &DiversityOptions { what, most, out }))
            }
            LibraryVerb::Gallery { library } => done(report::report(talk, library)),
            LibraryVerb::Query { library, conditions, columns, paths, out } => {
                let (library, conditions, columns) = (library.clone(), conditions.clone(), columns.clone());
                query::query(talk, &QueryOptions { library, conditions, columns, paths: *paths, out: out.clone() })
            }
            LibraryVerb::Export { what, chat_jsonl } => done(export_chat::export(talk, what, chat_jsonl)),
        }
    }
}

/// Arguments of `labels`.
#[derive(Debug, Args)]
pub(crate) struct Labels {
    /// What to do.
    #[command(subcommand)]
    verb: LabelsVerb,
}

/// Verbs of `labels`.
#[derive(Debug, Subcommand)]
enum LabelsVerb {
    /// Write a page on which people label runs: simulable, appropriate, as asked. It needs no network and saves a CSV.
    Page(Page),
    /// Write a page for observers: films that play once, with a slider, a belief or pairs; nothing on it names a planner.
    Observe(Observe),
    /// Tell what observers said: who is kept, how far they agree, what films were rated, what viewers knew when, strengths of planners.
    Observed {
        /// Tables (CSV) that the page saved: `task,rater,t,value`.
        #[arg(required = true)]
        answers: Vec<PathBuf>,
        /// The key that `labels observe` wrote beside the page.
        #[arg(long, value_name = "FILE")]
        key: PathBuf,
        /// Folder for `raters.csv`, `films.csv` and `beliefs.csv`.
        #[arg(long, value_name = "DIR", default_value = "observed")]
        out: PathBuf,
    },
    /// Show stills of runs to a vision model and ask which facts of their requests it sees. Off unless a model is named; no verdict knows of
    /// it.
    Opinion(Opinion),
    /// Hold second opinions against labels by people: how often the judge errs, and the corrected share of facts that hold.
    Calibrate {
        /// Tables of answers of people (CSV): `run,rater,as_asked,sentence`.
        #[arg(required = true)]
        labels: Vec<PathBuf>,
        /// The key that `labels page --films` wrote beside their page.
        #[arg(long, value_name = "FILE")]
        key: PathBuf,
        /// The table of facts that `labels opinion` wrote.
        #[arg(long, value_name = "FILE", default_value = "opinion/second_opinion.csv")]
        opinion: PathBuf,
    },
    /// Compare what blind judges answered with the verdicts, with each other, and on the controls.
    Compare {
        /// Tables of answers (CSV) that the page saved: `run,rater,as_asked,sentence`.
        #[arg(required = true)]
        labels: Vec<PathBuf>,
        /// The key that `labels page --films` wrote beside the page.
        #[arg(long, value_name = "FILE")]
        key: PathBuf,
        /// Bundles, or folders that hold bundles, that were on the page; those that were mixed in need not be named.
        #[arg(long, required = true, num_args = 1.., value_name = "FOLDER")]
        bundles: Vec<PathBuf>,
    },
}

/// Arguments of `labels observe`.
#[derive(Debug, Clone, Args)]
#[expect(clippy::struct_excessive_bools, reason = "each is a flag of the command line")]
struct Observe {
    /// Bundle folders, or folders that hold bundles.
    #[arg(required = true)]
    bundles: Vec<PathBuf>,
    /// File of the page; the key is written beside it.
    #[arg(long, short, default_value = "observing/observe.html")]
    out: PathBuf,
    /// Only the first run of each bundle.
    #[arg(long)]
    first: bool,
    /// Heading of the page.
    #[arg(long, default_value = "Robots among people")]
    title: String,
    /// A slider after each film: how good was the robot's behavior, 0 to 1.
    #[arg(long)]
    slider: bool,
    /// A slider during each film: to which of two places does the robot go.
    #[arg(long)]
    belief: bool,
    /// Two films of one scenario and seed under two planners in step: which is better.
    #[arg(long)]
    pairs: bool,
    /// Films that come a second time, by which raters are kept or dropped.
    #[arg(long, value_name = "N", default_value_t = 5)]
    repeat: usize,
    /// Films that every rater gets.
    #[arg(long, value_name = "N", default_value_t = 15)]
    control: usize,
    /// How many of the other films a rater gets, drawn by their name; all if it is left out.
    #[arg(long, value_name = "N")]
    each: Option<usize>,
    /// Seed of the order in which films are numbered, and of sides.
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
}

impl Observe {
    fn options(&self) -> ObserveOptions {
        let Self { bundles, out, first, title, slider, belief, pairs, repeat, control, each, seed } = self.clone();
        ObserveOptions { bundles, out, first, title, slider, belief, pairs, repeat, control, each, seed }
    }
}

/// Arguments of `labels opinion`.
#[derive(Debug, Clone, Args)]
struct Opinion {
    /// Bundle folders, or folders that hold bundles.
    #[arg(required = true)]
    bundles: Vec<PathBuf>,
    /// The model that is asked, of another family than the authors: `anthropic:MODEL`, `openai:MODEL`, `vllm:MODEL`, …, with `record:FOLDER=`,
    /// `replay:FOLDER=` or `cassette:FOLDER` as an author. Default: `author.second_opinion` of the configuration, which is empty.
    #[arg(long, value_name = "MODEL")]
    model: Option<String>,
    /// Folder for the tables, the sheets of pictures and what was asked.
    #[arg(long, short, value_name = "DIR", default_value = "opinion")]
    out: PathBuf,
    /// Only the first run of each bundle.
    #[arg(long)]
    first: bool,
    /// Stills of each run, 8 to 12.
    #[arg(long, value_name = "N", default_value_t = 11)]
    stills: usize,
    /// Times that each run is asked about, 1 to 25, the facts in another order each time.
    #[arg(long, value_name = "N", default_value_t = 5)]
    repeats: usize,
    /// Seed of the orders and of the planted facts.
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
}

impl Opinion {
    fn options(&self) -> OpinionOptions {
        let Self { bundles, model, out, first, stills, repeats, seed } = self.clone();
        OpinionOptions { bundles, model, out, first, stills, repeats, seed }
    }
}

/// Arguments of `labels page`.
#[derive(Debug, Clone, Args)]
struct Page {
    /// Bundle folders, or folders that hold bundles.
    #[arg(required = true)]
    bundles: Vec<PathBuf>,
    /// File to write; with --films its folder is also that of everything that lies beside it.
    #[arg(long, short, default_value = "labels.html", default_value_if("films", "true", "judging/labels.html"))]
    out: PathBuf,
    /// Only the first run of each bundle.
    #[arg(long)]
    first: bool,
    /// Heading of the page.
    #[arg(long, default_value = "What do you see?")]
    title: String,
    /// For blind judges: nothing tells where a run is from; stills, texts, the protocol and the key are written beside the page.
    #[arg(long)]
    films: bool,
    /// Stills of each run, from when robot and people are first within 8 m of each other to when they last are, 2 to 24.
    #[arg(long, value_name = "N", default_value_t = 8, requires = "films")]
    stills: usize,
    /// Seed of the order in which the runs are numbered.
    #[arg(long, value_name = "S", default_value_t = 1, requires = "films")]
    seed: u64,
    /// Folder of bundles to mix in, unmarked: controls, of which it is known that something did not happen.
    #[arg(long, value_name = "FOLDER", requires = "films")]
    mixed_in: Vec<PathBuf>,
}

impl Page {
    fn options(&self) -> PageOptions {
        let Self { bundles, out, first, title, films, stills, seed, mixed_in } = self.clone();
        let blind = films.then_some(Blind { stills, seed, mixed_in });
        PageOptions { bundles, out, first, title, blind }
    }
}

impl Labels {
    pub(super) async fn act(&self, talk: &Printer, config: &Config) -> Outcome {
        done(match &self.verb {
            LabelsVerb::Opinion(opinion) => labels::opinion(talk, config, &opinion.options()).await,
            LabelsVerb::Calibrate { labels, key, opinion } => {
                let (labels, key, opinion) = (labels.clone(), key.clone(), opinion.clone());
                labels::calibrate(talk, &CalibrateOptions { labels, key, opinion })
            }
            LabelsVerb::Page(page) => labels::page(talk, &page.options()),
            LabelsVerb::Observe(observe) => labels::observe(talk, &observe.options()),
            LabelsVerb::Observed { answers, key, out } => {
                let (answers, key, out) = (answers.clone(), key.clone(), out.clone());
                labels::observed(talk, &ObservedOptions { answers, key, out })
            }
            LabelsVerb::Compare { labels, key, bundles } => {
                let (labels, key, bundles) = (labels.clone(), key.clone(), bundles.clone());
                labels::compare(talk, &CompareOptions { labels, key, bundles })
            }
        })
    }
}
