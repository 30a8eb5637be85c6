//! The command line, word by word: a file per verb or group of verbs, each with its own options.

mod author;
mod bt;
mod bundle;
mod cluster;
mod compare;
mod dev;
mod drive;
mod evaluate;
mod experiment;
mod explain;
mod export;
mod fsck;
mod keys;
mod library;
mod look;
mod map;
mod request;
mod run;
mod scenarios;
mod score;
mod serve;
mod simulate;
mod study;
mod top;
mod video;
mod view;

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use socrates_app::config::Config;
use socrates_app::exit::{Code, Diagnostic};
use socrates_app::output::Printer;

/// From a few sentences and a map to a social-navigation scenario that is simulated, checked and scored.
#[derive(Debug, Parser)]
#[command(
    name = "socrates",
    version,
    about,
    disable_help_subcommand = true,
    after_help = "First time? Run `socrates demo`."
)]
pub(crate) struct Cli {
    /// How results are printed; with json the last line of standard output is one object.
    #[arg(long, global = true, value_enum, default_value_t = Format::Text)]
    pub(crate) format: Format,
    /// Configuration.
    #[command(flatten)]
    pub(crate) flags: Flags,
    /// What to do.
    #[command(subcommand)]
    pub(crate) verb: Verb,
}

/// Where the configuration comes from; child processes get the same.
#[derive(Debug, Clone, Args)]
pub(crate) struct Flags {
    /// Configuration file; default `socrates.toml` in the current folder, if there is one.
    #[arg(long, global = true, value_name = "FILE")]
    pub(crate) config: Option<PathBuf>,
    /// One configuration value, such as `--set supervisor.workers=2`; may be repeated.
    #[arg(long, global = true, value_name = "KEY=VALUE")]
    pub(crate) set: Vec<String>,
    /// How the log on standard error is written, by this process and those that it starts: with json an object a line.
    #[arg(long, global = true, value_enum, value_name = "FORM")]
    pub(crate) log: Option<Format>,
}

impl Flags {
    /// Every value of the configuration that was named.
    pub(crate) fn all(&self) -> Vec<String> {
        let form = self.log.map(|form| match form {
            Format::Text => "log.format=text".to_owned(),
            Format::Json => "log.format=json".to_owned(),
        });
        self.set.iter().cloned().chain(form).collect()
    }
}

/// How results are printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// For people.
    Text,
    /// For programs.
    Json,
}

/// How a verb ended.
type Outcome = Result<Code, Diagnostic>;

/// The code of a verb that judges nothing.
fn done(outcome: Result<(), Diagnostic>) -> Outcome {
    outcome.map(|()| Code::Ok)
}

/// The verbs.
#[derive(Debug, Subcommand)]
pub(crate) enum Verb {
    /// Run a shipped request, with nothing to prepare.
    Demo(run::Options),
    /// Write a commented request file.
    New(request::New),
    /// Print how a request is read, and run nothing.
    Read(request::Read),
    /// Make scenarios from requests: propose, simulate, check, score.
    Run(run::Run),
    /// Compare planners over the same scenarios and seeds: tables, a page with the runs side by side, a film.
    Compare(compare::Compare),
    /// Open the page of a bundle.
    Open(bundle::Open),
    /// Write the page of a bundle anew, or one page for a folder of bundles.
    Report(bundle::Report),
    /// Film a bundle, seen from above: MP4 or WebM with ffmpeg, GIF or animated SVG without.
    Video(video::Video),
    /// Draw a figure for a paper: who went where and when.
    Figure(video::Figure),
    /// Print what a paper says about how a bundle was made, and what to cite.
    Cite(bundle::Cite),
    /// Add up what the authors of bundles were asked, in calls, tokens and money.
    Cost(bundle::Cost),
    /// Write bundles in formats of other simulators and data sets, with a list of what each cannot hold.
    Export(export::Export),
    /// Let people label runs by hand, and a vision model give a second opinion.
    Labels(library::Labels),
    /// Simulate a bundle again and compare the recording hashes, or run a HuNavSim agents file.
    Simulate(simulate::Simulate),
    /// Score a bundle again, or tracks of your own (CSV with `t,id,x,y[,yaw,gesture]`, MCAP, or a bag of ROS 2).
    Score(score::Score),
    /// Keep scenarios ready, whose runs drivers outside ask for one after the other: for reinforcement learning.
    Serve(serve::Serve),
    /// Try a driver outside.
    Drive(drive::Drive),
    /// Watch the agent states of a run that is being made.
    Watch(look::Watch),
    /// Show runs in a browser, in Foxglove or Lichtblick, while they happen and afterwards.
    View(view::View),
    /// Show how the scenarios of a folder stand, while they are made and afterwards.
    Status(look::Status),
    /// Check that a job store, its artifacts and its bundles are whole and agree, also while they are worked on.
    Fsck(fsck::Fsck),
    /// Show stages, workers and the newest failures of an orchestrator, drawn anew every second.
    Top(top::Top),
    /// Explain a fault code, such as G-DISC, a metric, or a word of output, pages and tables; or why a job waits. Without a word, list the
    /// codes.
    Explain(explain::Explain),
    /// Check what this machine can do, and say what is missing.
    Doctor,
    /// Print the effective configuration and where each value comes from.
    Config(explain::Config),
    /// Check, draw and convert behavior trees (BehaviorTree.CPP XML).
    Bt(bt::Bt),
    /// Check, draw and generate locations.
    Map(map::Map),
    /// Answer in the place of a language model.
    Author(author::Author),
    /// Measure authors: how often scenarios are right at first, after asking again, and in the run.
    Evaluate(evaluate::Evaluate),
    /// Try retry policies on injected faults, in virtual time or on real processes: what is lost, doubled, repeated, and what it costs.
    Experiment(experiment::Experiment),
    /// Make, put together, look through and check libraries of many scenarios.
    Library(library::Library),
    /// Human studies: power, preregistration, answers of several survey programs, statistics and report.
    Study(study::Study),
    /// List, show and rate the canonical scenarios of the catalog.
    Scenarios(scenarios::Scenarios),
    /// The same parts spread over machines.
    Cluster(cluster::Cluster),
    /// For developers of SocRATES.
    Dev(dev::Dev),
    /// One worker process; started by `run` and `cluster worker`.
    #[command(hide = true)]
    Worker(cluster::Worker),
    /// The orchestrator process; started by `run` and `cluster up`.
    #[command(hide = true)]
    Orchestrator(cluster::Up),
    /// A part of an experiment on processes; started by `experiment`.
    #[command(hide = true)]
    Play(experiment::Play),
}

impl Verb {
    /// Whether this process is the child of a supervisor.
    pub(crate) const fn is_tied(&self) -> bool {
        matches!(self, Self::Worker(cluster::Worker { tied: true, .. }))
            || matches!(self, Self::Orchestrator(cluster::Up { tied: true, .. }))
            || matches!(self, Self::View(view::View { tied: true, .. }))
            || matches!(self, Self::Author(author) if author.is_tied())
            || matches!(self, Self::Map(map) if map.is_tied())
            || matches!(self, Self::Study(study) if study.is_tied())
            || matches!(self, Self::Play(_))
    }

    /// Does it.
    pub(crate) async fn act(&self, talk: &Printer, config: &Config) -> Outcome {
        match self {
            Self::Demo(options) => options.demo(talk, config).await,
            Self::New(verb) => verb.act(talk).await,
            Self::Read(verb) => verb.act(talk, config),
            Self::Run(verb) => verb.act(talk, config).await,
            Self::View(verb) => verb.act(talk, config).await,
            Self::Compare(verb) => verb.act(talk, config).await,
            Self::Open(verb) => verb.act(talk),
            Self::Report(verb) => verb.act(talk),
            Self::Video(verb) => verb.act(talk, config),
            Self::Figure(verb) => verb.act(talk),
            Self::Cite(verb) => verb.act(talk),
            Self::Cost(verb) => verb.act(talk, config),
            Self::Export(verb) => verb.act(talk),
            Self::Labels(verb) => verb.act(talk, config).await,
            Self::Simulate(verb) => verb.act(talk),
            Self::Score(verb) => verb.act(talk),
            Self::Serve(verb) => verb.act(talk, config).await,
            Self::Drive(verb) => verb.act(talk, config).await,
            Self::Watch(verb) => verb.act(talk, config).await,
            Self::Status(verb) => verb.act(talk, config).await,
            Self::Fsck(verb) => verb.act(talk),
            Self::Top(verb) => verb.act(talk, config).await,
            Self::Explain(verb) => verb.act(talk, config).await,
            Self::Doctor => done(socrates_app::explain::doctor(talk, config)),
            Self::Config(verb) => verb.act(talk, config),
            Self::Bt(verb) => verb.act(talk),
            Self::Map(verb) => verb.act(talk, config).await,
            Self::Author(verb) => verb.act(talk).await,
            Self::Evaluate(verb) => verb.act(talk, config).await,
            Self::Experiment(verb) => verb.act(talk, config).await,
            Self::Library(verb) => verb.act(talk, config).await,
            Self::Study(verb) => verb.act(talk, config).await,
            Self::Scenarios(verb) => verb.act(talk).await,
            Self::Cluster(verb) => verb.act(talk, config).await,
            Self::Dev(verb) => verb.act(talk, config).await,
            Self::Worker(verb) => verb.act(config).await,
            Self::Orchestrator(verb) => verb.act(talk, config).await,
            Self::Play(verb) => verb.act(talk, config).await,
        }
    }
}
