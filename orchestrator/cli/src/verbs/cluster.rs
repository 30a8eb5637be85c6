//! `cluster`, and the processes of `run`.

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};
use socrates_app::cluster::{self, SubmitOptions};
use socrates_app::cluster_work::{self, WorkOptions};
use socrates_app::collect::{self, CollectOptions};
use socrates_app::config::Config;
use socrates_app::exit::Diagnostic;
use socrates_app::keep::Keep;
use socrates_app::output::Printer;
use socrates_app::process::{self, Durability, OrchestratorOptions, WorkerOptions};
use socrates_app::steer::{self, Act, SteerOptions, Whom};
use socrates_model::wire::{Limits, Priority};

use super::keys::{Keys, MakeKeys};
use super::run::Options;
use super::{Outcome, done};

/// Longest time of a batch, hours: ten years.
const MOST_HOURS: f64 = 87_600.0;

/// Arguments of `cluster`.
#[derive(Debug, Args)]
pub(crate) struct Cluster {
    /// What to do.
    #[command(subcommand)]
    verb: ClusterVerb,
}

/// Verbs of `cluster`.
#[derive(Debug, Subcommand)]
enum ClusterVerb {
    /// Start the orchestrator and listen for workers.
    Up(Up),
    /// Serve all stages on this machine, with a process for each and one for each slot of the simulation.
    Work(Work),
    /// Serve one stage with one process.
    Worker(Worker),
    /// Hand requests to a running orchestrator and return.
    Submit(Box<Submit>),
    /// Write the bundles of a batch that are done, with page and tables; also while others are being made, and again.
    Collect(Collect),
    /// Hand out no more jobs: of a stage, of a batch, or at all. What workers hold is finished.
    Pause(Hold),
    /// Hand them out again.
    Resume(Hold),
    /// Give up scenarios, or what a batch has not done yet.
    Cancel(Cancel),
    /// Try the dead and failed jobs of scenarios once more, with new budgets.
    Requeue(Requeue),
    /// Make the keys with which machines know each other, and what each may do.
    Keys(MakeKeys),
}

/// Where an orchestrator is, for those who ask it.
#[derive(Debug, Clone, Args)]
struct At {
    /// Endpoint of the orchestrator.
    #[arg(long)]
    connect: String,
    /// Namespace.
    #[arg(long, default_value = "main")]
    namespace: String,
    #[command(flatten)]
    keys: Keys,
}

/// Arguments of `cluster work`.
#[derive(Debug, Args)]
struct Work {
    #[command(flatten)]
    at: At,
    /// Folder for reports that are not yet recorded; `socrates-work-HOST` in the current folder if it is left out.
    #[arg(long)]
    dir: Option<PathBuf>,
    /// Processes of the simulation stage; one per core if it is left out.
    #[arg(long, value_name = "N")]
    slots: Option<u32>,
    /// Stages to serve, separated by commas; all if it is left out.
    #[arg(long, value_delimiter = ',')]
    stages: Vec<String>,
}

/// Arguments of `cluster submit`.
#[derive(Debug, Args)]
struct Submit {
    /// Request files, or folders of them.
    #[arg(required = true)]
    requests: Vec<PathBuf>,
    #[command(flatten)]
    at: At,
    /// Name of the batch; without one it is called after what it is made from.
    #[arg(long)]
    batch: Option<String>,
    /// How urgent it is beside other batches: `interactive`, `normal` or `bulk`. While all wait, ten scenarios of one are begun for each
    /// of the next; none waits for ever.
    #[arg(long, default_value = "normal")]
    priority: Priority,
    /// Hours that the batch may run, over all its scenarios; what is open then fails. Thirty days if it is left out.
    #[arg(long, value_name = "H")]
    max_hours: Option<f64>,
    /// Tokens, in and out, that the authors of the batch may take. Then nothing more of it is begun; what was begun is finished.
    #[arg(long, value_name = "N")]
    max_tokens: Option<u64>,
    /// Cents that the authors of the batch may cost by the prices of the configuration; as with tokens.
    #[arg(long, value_name = "N")]
    max_cents: Option<u64>,
    /// Options of `run`; those that are for this machine are refused.
    #[command(flatten)]
    options: Options,
}

impl Submit {
    /// What the batch may take.
    fn limits(&self) -> Result<Limits, Diagnostic> {
        let hours = self.max_hours.unwrap_or(0.0);
        if !(0.0..=MOST_HOURS).contains(&hours) || self.max_hours == Some(0.0) {
            return Err(Diagnostic::input(
                format!("`--max-hours {hours}` is no time that a batch may run"),
                format!("allowed: more than 0, at most {MOST_HOURS} hours"),
            ));
        }
        for (option, value) in [("--max-tokens", self.max_tokens), ("--max-cents", self.max_cents)] {
            if value == Some(0) {
                let hint = "allowed: 1 or more; without the option there is no limit";
                return Err(Diagnostic::input(format!("`{option} 0` lets nothing be made"), hint));
            }
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked above")]
        let deadline_ms = (hours * 3_600_000.0).ceil() as u64;
        let money = self.max_cents.unwrap_or(0).saturating_mul(10_000);
        Ok(Limits { deadline_ms, tokens: self.max_tokens.unwrap_or(0), money })
    }
}

/// Arguments of `cluster collect`.
#[derive(Debug, Args)]
struct Collect {
    #[command(flatten)]
    at: At,
    /// Name of the batch; needed where there are several.
    #[arg(long)]
    batch: Option<String>,
    /// Folder of the library.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Which bundles are kept, `folders`, `packed`, `failed` or `index`: see `socrates run --help`.
    #[arg(long, value_name = "WHICH")]
    keep: Option<Keep>,
}

/// Arguments of `cluster pause` and `cluster resume`.
#[derive(Debug, Args)]
struct Hold {
    /// Only this stage: proposal, paths, behaviors, simulation, scoring or review.
    stage: Option<String>,
    /// Only this batch.
    #[arg(long, value_name = "NAME", conflicts_with = "stage")]
    batch: Option<String>,
    #[command(flatten)]
    at: At,
}

impl Hold {
    fn whom(&self) -> Whom {
        Whom { stage: self.stage.clone(), batch: self.batch.clone(), ..Whom::default() }
    }
}

/// Arguments of `cluster cancel`.
#[derive(Debug, Args)]
struct Cancel {
    /// Scenarios.
    scenarios: Vec<String>,
    /// All of this batch that is not done.
    #[arg(long, value_name = "NAME", conflicts_with = "scenarios")]
    batch: Option<String>,
    #[command(flatten)]
    at: At,
}

/// Arguments of `cluster requeue`.
#[derive(Debug, Args)]
struct Requeue {
    /// Scenarios.
    scenarios: Vec<String>,
    /// All of this batch.
    #[arg(long, value_name = "NAME", conflicts_with = "scenarios")]
    batch: Option<String>,
    /// All of every batch that failed.
    #[arg(long, conflicts_with_all = ["scenarios", "batch"])]
    dead: bool,
    #[command(flatten)]
    at: At,
}

/// Has something done about jobs.
async fn steered(talk: &Printer, config: &Config, at: &At, act: Act, whom: &Whom) -> Outcome {
    let At { connect, namespace, keys } = at.clone();
    let options = SteerOptions { connect, namespace };
    steer::steer(talk, &keys.over(config)?, &options, act, whom).await
}

impl Cluster {
    pub(super) async fn act(&self, talk: &Printer, config: &Config) -> Outcome {
        match &self.verb {
            ClusterVerb::Up(verb) => verb.act(talk, config).await,
            ClusterVerb::Work(Work { at, dir, slots, stages }) => {
                let At { connect, namespace, keys } = at.clone();
                let config = &keys.over(config)?;
                let (dir, stages) = (dir.clone(), stages.clone());
                let options = WorkOptions { connect, namespace, dir, slots: *slots, stages };
                cluster_work::work(talk, config, &options).await
            }
            ClusterVerb::Worker(verb) => verb.act(config).await,
            ClusterVerb::Keys(verb) => verb.act(talk),
            ClusterVerb::Pause(verb) => steered(talk, config, &verb.at, Act::Pause, &verb.whom()).await,
            ClusterVerb::Resume(verb) => steered(talk, config, &verb.at, Act::Resume, &verb.whom()).await,
            ClusterVerb::Cancel(Cancel { scenarios, batch, at }) => {
                let whom = Whom { batch: batch.clone(), scenarios: scenarios.clone(), ..Whom::default() };
                steered(talk, config, at, Act::Cancel, &whom).await
            }
            ClusterVerb::Requeue(Requeue { scenarios, batch, dead, at }) => {
                let (batch, scenarios, dead) = (batch.clone(), scenarios.clone(), *dead);
                let whom = Whom { batch, scenarios, dead, stage: None };
                steered(talk, config, at, Act::Requeue, &whom).await
            }
            ClusterVerb::Submit(verb) => {
                let Submit { requests, at, batch, priority, options, .. } = verb.as_ref();
                let At { connect, namespace, keys } = at.clone();
                let config = &keys.over(config)?;
                let (batch, limits) = (batch.clone(), verb.limits()?);
                let to = SubmitOptions { connect, namespace, batch, priority: *priority, limits };
                cluster::submit(talk, config, requests, &to, &options.values()).await
            }
            ClusterVerb::Collect(Collect { at, batch, out, keep }) => {
                let At { connect, namespace, keys } = at.clone();
                let config = &keys.over(config)?;
                let wanted = CollectOptions { connect, namespace, batch: batch.clone(), out: out.clone(), keep: *keep };
                collect::collect(talk, config, &wanted).await
            }
        }
    }
}

/// Arguments of one worker process.
#[derive(Debug, Clone, Args)]
pub(crate) struct Worker {
    /// Stage it serves.
    stage: String,
    /// Endpoint of the orchestrator's router.
    #[arg(long)]
    connect: String,
    /// Namespace.
    #[arg(long, default_value = "main")]
    namespace: String,
    /// Artifact folder shared with the orchestrator; without it artifacts travel over the bus.
    #[arg(long)]
    blobs: Option<PathBuf>,
    /// Folder for reports that are not yet recorded.
    #[arg(long)]
    spool: PathBuf,
    /// Leave when standard input closes.
    #[arg(long, hide = true)]
    pub(super) tied: bool,
    /// Reports outlive a power cut, also those of a worker that leaves with its supervisor.
    #[arg(long, hide = true)]
    durable: bool,
    /// Faults to inject, for experiments: `die_before_report=0.1,drop_report=0.05`.
    #[arg(long, default_value = "")]
    inject: String,
    /// File in which its log is kept, as JSON lines; see `socrates config log`.
    #[arg(long, value_name = "FILE")]
    log_file: Option<PathBuf>,
    /// Let jobs name folders of recordings (`record:`, `replay:`, `cassette:`); for jobs of the user of this process alone.
    #[arg(long, hide = true)]
    own_jobs: bool,
    #[command(flatten)]
    keys: Keys,
}

impl Worker {
    pub(super) async fn act(&self, config: &Config) -> Outcome {
        let Self { stage, connect, namespace, blobs, spool, tied, durable, inject, log_file, own_jobs, keys } =
            self.clone();
        let config = &keys.over(config)?;
        let options =
            WorkerOptions { stage, connect, namespace, blobs, spool, tied, durable, inject, log_file, own_jobs };
        done(process::worker(config, &options).await)
    }
}

/// What a commit of the job store outlives.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Durable {
    /// A power cut.
    Disk,
    /// Any signal; for workers on this machine alone.
    Process,
}

/// Arguments of the orchestrator process.
#[derive(Debug, Clone, Args)]
pub(crate) struct Up {
    /// Folder of the job store and the artifacts; on a local disk.
    #[arg(long)]
    dir: PathBuf,
    /// Endpoint to listen on, such as `tcp/127.0.0.1:7447`; one that other machines can reach takes `--keys`, such as
    /// `quic/0.0.0.0:7447`, or needs `--insecure`.
    #[arg(long)]
    listen: Option<String>,
    /// Listens where other machines can reach it: whoever does may hand in and read jobs, and join as a worker that
    /// returns any result. There is no password and no encryption. It also lets `--metrics` be read from other machines.
    #[arg(long)]
    insecure: bool,
    /// Endpoint of a router to use instead of listening.
    #[arg(long)]
    connect: Option<String>,
    /// Namespace.
    #[arg(long, default_value = "main")]
    namespace: String,
    /// What a commit outlives: `disk` (a power cut) or `process` (any signal; for workers on this machine alone).
    #[arg(long, value_enum, default_value_t = Durable::Disk)]
    durable: Durable,
    /// Serve figures for Prometheus on this address, such as 127.0.0.1:9464, at /metrics; one that other machines can reach needs
    /// `--insecure`.
    #[arg(long, value_name = "ADDR")]
    metrics: Option<String>,
    /// Leave when standard input closes.
    #[arg(long, hide = true)]
    pub(super) tied: bool,
    /// No worker of before is alive: what they held is handed out again at once.
    #[arg(long, hide = true)]
    alone: bool,
    #[command(flatten)]
    keys: Keys,
}

impl Up {
    pub(super) async fn act(&self, talk: &Printer, config: &Config) -> Outcome {
        let Self { dir, listen, insecure, connect, namespace, durable, metrics, tied, alone, keys } = self.clone();
        let config = &keys.over(config)?;
        let durable = match durable {
            Durable::Disk => Durability::Disk,
            Durable::Process => Durability::Process,
        };
        let options = OrchestratorOptions {
            dir,
            listen,
            insecure,
            connect,
            namespace,
            durable,
            metrics,
            tied,
            alone,
            rules: None,
        };
        done(process::orchestrator(talk, config, &options).await)
    }
}
