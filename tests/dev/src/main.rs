//! `socrates-dev`: tools for developers of SocRATES, a verb each.

mod terminal;

use std::path::{Path, PathBuf};
use std::pin::Pin;
use std::process::ExitCode;

use clap::{Args, Parser, Subcommand, ValueEnum};
use socrates_app::config::{Config, Program};
use socrates_app::exit::{Code, Diagnostic};
use socrates_app::output::{self, Printer};
use socrates_dev::bench::{self, JobsOptions, What};
use socrates_dev::fuzz::{self, FuzzOptions};
use socrates_dev::{golden, mutations, program, tokens, traces};
use tracing_subscriber::EnvFilter;

/// Tools for developers of SocRATES; no part of the product.
#[derive(Debug, Parser)]
#[command(name = "socrates-dev", version, about, disable_help_subcommand = true)]
struct Cli {
    /// How results are printed; with json the last line of standard output is one object.
    #[arg(long, global = true, value_enum, default_value_t = Format::Text)]
    format: Format,
    /// Configuration file; default `socrates.toml` in the current folder, if there is one.
    #[arg(long, global = true, value_name = "FILE")]
    config: Option<PathBuf>,
    /// One configuration value, such as `--set supervisor.workers=2`; may be repeated.
    #[arg(long, global = true, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// The program `socrates`, which some tools start; default: the one beside this program.
    #[arg(long, global = true, value_name = "FILE")]
    program: Option<PathBuf>,
    /// What to do.
    #[command(subcommand)]
    verb: Verb,
}

/// How results are printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    /// For people.
    Text,
    /// For programs.
    Json,
}

/// Tools.
#[derive(Debug, Subcommand)]
enum Verb {
    /// Count the tokens that a scenario of two people costs a model, by style, and time our own part of a call.
    Tokens {
        /// Folder for the questions as they are sent, and the picture of the map.
        #[arg(long)]
        out: Option<PathBuf>,
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
        /// Make a library of all shipped requests with at least this number of scenarios instead: CPU, memory, growth.
        #[arg(long, value_name = "SCENARIOS", conflicts_with = "runs")]
        library: Option<u32>,
        /// Pass on this number of jobs that do nothing instead, by an orchestrator with a store on disk: rate, its change, hand-over, memory.
        #[arg(long, value_name = "JOBS", conflicts_with_all = ["runs", "library"], value_parser = clap::value_parser!(u32).range(50..=10_000_000))]
        jobs: Option<u32>,
        /// Workers of those jobs on this machine, a process each.
        #[arg(long, default_value_t = 4, requires = "jobs")]
        workers: u32,
        /// Workers that come from elsewhere and are waited for (`socrates-dev idle`).
        #[arg(long, default_value_t = 0, requires = "port")]
        others: u32,
        /// How long each job waits, ms.
        #[arg(long, default_value_t = 0, requires = "jobs", value_name = "MS")]
        wait: u32,
        /// Listen on this TCP port of every address, without keys, for workers from elsewhere.
        #[arg(long, requires = "jobs")]
        port: Option<u16>,
    },
    /// Serve all stages with jobs that only wait, for `socrates-dev bench --jobs`.
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

/// Arguments of `fuzz`.
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

impl Verb {
    async fn act(&self, talk: &Printer, config: &Config, own: Option<&Path>) -> Result<(), Diagnostic> {
        match self {
            Self::Tokens { out } => tokens::tokens(talk, out.as_deref()).await,
            Self::SfmTrace { scene, out, forces } => traces::crowd(talk, scene, out, forces.as_deref()),
            Self::BtTrace { tree, script, out, events } => traces::tree(talk, tree, script, out, events),
            Self::Mutations { requests, seeds, first, all } => {
                let seeds = *first..first.saturating_add(*seeds);
                mutations::mutations(talk, config, requests, seeds, *all).await
            }
            Self::Golden { agents } => golden::golden(talk, config, agents).await,
            Self::Fuzz(options) => {
                let Fuzz { seeds, first, door, limit, keep, bundle } = options.clone();
                fuzz::fuzz(talk, config, &FuzzOptions { seeds, first, door, limit, keep, bundle })
            }
            Self::Bench { runs, library, jobs, workers, others, wait, port } => {
                let what = match (*library, *jobs) {
                    (Some(scenarios), _) => What::Library(scenarios),
                    (None, Some(jobs)) => {
                        let (workers, others, wait_ms, port) = (*workers, *others, *wait, *port);
                        What::Jobs(JobsOptions { jobs, workers, others, wait_ms, port })
                    }
                    (None, None) => What::Scenario(*runs),
                };
                bench::bench(talk, config, own, what).await
            }
            Self::Idle { connect, dir, wait, tied } => bench::idle(config, connect, dir, *wait, *tied).await,
        }
    }
}

fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(why) => {
            drop(why.print());
            return ExitCode::from(if why.use_stderr() { Code::Input as u8 } else { Code::Ok as u8 });
        }
    };
    let talk = terminal::talk(match cli.format {
        Format::Text => output::Format::Text,
        Format::Json => output::Format::Json,
    });
    let code = match begin(&talk, &cli) {
        Ok(()) => Code::Ok,
        Err(diagnostic) => {
            talk.warn(&format!("error: {diagnostic}"));
            talk.result(&diagnostic.object());
            diagnostic.code
        }
    };
    ExitCode::from(code as u8)
}

fn begin(talk: &Printer, cli: &Cli) -> Result<(), Diagnostic> {
    let own = std::env::current_exe().ok();
    let config = Config::load(cli.config.as_deref(), std::env::vars(), &cli.set)?.of(Program {
        file: program::find(cli.program.as_deref(), own.as_deref())?,
        build: String::new(),
        temp: std::env::temp_dir(),
    });
    start_log(&config)?;
    let ours = |why| Diagnostic::input(format!("no threads can be started: {why}"), "").with_code(Code::Ours);
    let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build().map_err(ours)?;
    // Boxed: the runtime's loops would else each hold the code of all verbs.
    let work: Pin<Box<dyn Future<Output = _> + '_>> = Box::pin(cli.verb.act(talk, &config, own.as_deref()));
    let ended = runtime.block_on(work);
    runtime.shutdown_background();
    ended
}

/// The log on standard error, as the configuration filters it.
fn start_log(config: &Config) -> Result<(), Diagnostic> {
    let filter = EnvFilter::try_new(config.text("log.filter")).map_err(|why| {
        Diagnostic::input(
            format!("`log.filter` is not a filter: {why}"),
            "for example \"warn\" or \"socrates_kit=debug\"",
        )
    })?;
    tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_writer(std::io::stderr)
        .with_ansi(false)
        .without_time()
        .compact()
        .init();
    Ok(())
}
