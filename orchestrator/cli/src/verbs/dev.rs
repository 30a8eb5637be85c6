//! `dev`: for developers of SocRATES.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use socrates_app::bench::{JobsOptions, What};
use socrates_app::config::Config;
use socrates_app::fuzz::{self, FuzzOptions};
use socrates_app::output::Printer;
use socrates_app::{agents, agreement, authors, bench, dev, golden, mutations, tokens, traces};

use super::{Outcome, done};

/// Arguments of `dev`.
#[derive(Debug, Args)]
pub(crate) struct Dev {
    /// What to do.
    #[command(subcommand)]
    verb: DevVerb,
}

/// Verbs of `dev`.
#[derive(Debug, Subcommand)]
enum DevVerb {
    /// Ask a model's server one small question that tells how far it enforces the form of an answer.
    Probe {
        /// Author, such as `ollama:MODEL`.
        author: String,
    },
    /// Count the tokens that a scenario of two people costs a model, by style, and time our own part of a call.
    Tokens {
        /// Folder for the questions as they are sent, and the picture of the map.
        #[arg(long)]
        out: Option<PathBuf>,
    },
    /// Print the JSON schema of an artifact.
    Schema {
        /// `request`, `reading`, `proposal`, `paths`, `behaviors`, `report`, `location`, `clause`.
        artifact: String,
    },
    /// Read a file of the published SocRATES tool and print what it holds.
    Import {
        /// Scenario, trajectory, tree or combined JSON.
        file: PathBuf,
    },
    /// Write a bundle as the published tool's stage files.
    Export {
        /// Bundle folder.
        bundle: PathBuf,
        /// Folder to write.
        #[arg(long, short)]
        out: PathBuf,
    },
    /// Run a crowd scene by the reference social forces, for comparison with the original library.
    SfmTrace {
        /// Scene (JSON).
        scene: PathBuf,
        /// Trajectory to write: `step,id,x,y,vx,vy,yaw,goals_reached`.
        #[arg(long, short)]
        out: PathBuf,
        /// Forces to write, where wanted.
        #[arg(long)]
        forces: Option<PathBuf>,
    },
    /// Tick a behavior tree with scripted leaves, for comparison with BehaviorTree.CPP.
    BtTrace {
        /// XML file.
        tree: PathBuf,
        /// Script: `{"ticks":[{"leaf":"SUCCESS"}]}`.
        script: PathBuf,
        /// Status of every node after every tick.
        #[arg(long, short)]
        out: PathBuf,
        /// Leaf ticks, halts and what the root gave.
        #[arg(long)]
        events: PathBuf,
    },
    /// Check a HuNavSim agents file, and write it in the form of another version.
    Agents {
        /// Agents file.
        file: PathBuf,
        /// Version to write: `1.0` (also the SocRATES fork), `1.1`, `2.0`.
        #[arg(long, value_parser = ["1.0", "1.1", "2.0"])]
        to: Option<String>,
        /// File to write; default: standard output.
        #[arg(long, short)]
        out: Option<PathBuf>,
    },
    /// Calibrate the judge: share of spoiled runs that it refuses and of harmless changes that it lets pass.
    Mutations {
        /// Request files or folders of them; default: every request of the shipped locations.
        requests: Vec<PathBuf>,
        /// Seeds of each scenario.
        #[arg(long, default_value_t = 2)]
        seeds: u64,
        /// First of the seeds.
        #[arg(long, default_value_t = 1)]
        first: u64,
        /// Print every mutant and not only what went wrong.
        #[arg(long)]
        all: bool,
    },
    /// Compare labels that people gave to runs with the verdicts: Cohen's kappa, Krippendorff's alpha.
    Agreement {
        /// Labels (CSV): `run,rater,simulable,appropriate,as_asked`, yes or no.
        labels: PathBuf,
        /// Bundles that hold the runs.
        #[arg(required = true)]
        bundles: Vec<PathBuf>,
    },
    /// Print the recording hash of each shipped request, each canonical scenario and these agents files, for two seeds.
    Golden {
        /// HuNavSim agents files.
        agents: Vec<PathBuf>,
    },
    /// Let damaged inputs in at every door: each must be read or refused with the name of its file.
    Fuzz(Fuzz),
    /// Measure the main job on this machine.
    Bench {
        /// Runs to take the median of.
        #[arg(long, default_value_t = 9)]
        runs: u32,
        /// Make a library of at least so many scenarios of all shipped requests instead: CPU, memory, growth.
        #[arg(long, value_name = "SCENARIOS", conflicts_with = "runs")]
        library: Option<u32>,
        /// Pass on so many jobs that do nothing instead, by an orchestrator with a store on disk: rate, its change, hand-over, memory.
        #[arg(long, value_name = "JOBS", conflicts_with_all = ["runs", "library"], value_parser = clap::value_parser!(u32).range(50..=10_000_000))]
        jobs: Option<u32>,
        /// Workers of those jobs on this machine, a process each.
        #[arg(long, default_value_t = 4, requires = "jobs")]
        workers: u32,
        /// Workers that come from elsewhere and are waited for (`dev idle`).
        #[arg(long, default_value_t = 0, requires = "port")]
        others: u32,
        /// How long each job waits, ms.
        #[arg(long, default_value_t = 0, requires = "jobs", value_name = "MS")]
        wait: u32,
        /// Listen on this TCP port of every address, without keys, for workers from elsewhere.
        #[arg(long, requires = "jobs")]
        port: Option<u16>,
    },
    /// Serve all stages with jobs that only wait, for `dev bench --jobs`.
    Idle {
        /// Endpoint of the orchestrator.
        #[arg(long)]
        connect: String,
        /// Folder for reports that are not yet recorded.
        #[arg(long)]
        dir: PathBuf,
        /// How long each job waits, ms.
        #[arg(long, default_value_t = 0, value_name = "MS")]
        wait: u32,
        /// Leave when standard input closes.
        #[arg(long)]
        tied: bool,
    },
}

/// Arguments of `dev fuzz`.
#[derive(Debug, Clone, Args)]
struct Fuzz {
    /// Damaged inputs for each door.
    #[arg(long, default_value_t = 200, value_parser = clap::value_parser!(u64).range(1..=10_000_000))]
    seeds: u64,
    /// Seed of the first of them.
    #[arg(long, default_value_t = 1)]
    first: u64,
    /// Only this door; may be repeated. Default: all of them.
    #[arg(long)]
    door: Vec<String>,
    /// Longest time for one input, s.
    #[arg(long, default_value_t = 20, value_parser = clap::value_parser!(u64).range(1..=3600))]
    limit: u64,
    /// Folder that keeps the inputs that were not answered well.
    #[arg(long, default_value = "fuzz")]
    keep: PathBuf,
    /// Bundle to damage; default: one of the shipped request is made.
    #[arg(long)]
    bundle: Option<PathBuf>,
}

impl Dev {
    pub(super) async fn act(&self, talk: &Printer, config: &Config) -> Outcome {
        done(match &self.verb {
            DevVerb::Probe { author } => authors::probe(talk, config, author).await,
            DevVerb::Tokens { out } => tokens::tokens(talk, out.as_deref()).await,
            DevVerb::Schema { artifact } => dev::schema(talk, artifact),
            DevVerb::Import { file } => dev::import(talk, file),
            DevVerb::Export { bundle, out } => dev::export(talk, bundle, out),
            DevVerb::SfmTrace { scene, out, forces } => traces::crowd(talk, scene, out, forces.as_deref()),
            DevVerb::BtTrace { tree, script, out, events } => traces::tree(talk, tree, script, out, events),
            DevVerb::Agents { file, to, out } => agents::convert(talk, file, to.as_deref(), out.as_deref()),
            DevVerb::Mutations { requests, seeds, first, all } => {
                let seeds = *first..first.saturating_add(*seeds);
                mutations::mutations(talk, config, requests, seeds, *all).await
            }
            DevVerb::Agreement { labels, bundles } => agreement::agreement(talk, labels, bundles),
            DevVerb::Golden { agents } => golden::golden(talk, config, agents).await,
            DevVerb::Fuzz(options) => {
                let Fuzz { seeds, first, door, limit, keep, bundle } = options.clone();
                fuzz::fuzz(talk, config, &FuzzOptions { seeds, first, door, limit, keep, bundle })
            }
            DevVerb::Bench { runs, library, jobs, workers, others, wait, port } => {
                let what = match (*library, *jobs) {
                    (Some(scenarios), _) => What::Library(scenarios),
                    (None, Some(jobs)) => {
                        let (workers, others, wait_ms, port) = (*workers, *others, *wait, *port);
                        What::Jobs(JobsOptions { jobs, workers, others, wait_ms, port })
                    }
                    (None, None) => What::Scenario(*runs),
                };
                bench::bench(talk, config, what).await
            }
            DevVerb::Idle { connect, dir, wait, tied } => bench::idle(config, connect, dir, *wait, *tied).await,
        })
    }
}
