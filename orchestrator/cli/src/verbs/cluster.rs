//! `cluster`, and the processes of `run`.

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};
use socrates_app::config::Config;
use socrates_app::output::Printer;
use socrates_app::process::{self, Durability, OrchestratorOptions, WorkerOptions};

use super::keys::{Keys, MakeKeys};
use super::{Outcome, done};

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
    /// Serve stages on this machine.
    Worker(Worker),
    /// Hand requests to a running orchestrator and return.
    Submit {
        /// Request files, or folders of them.
        #[arg(required = true)]
        requests: Vec<PathBuf>,
        /// Endpoint of the orchestrator.
        #[arg(long)]
        connect: String,
        /// Namespace.
        #[arg(long, default_value = "main")]
        namespace: String,
        /// Base seed.
        #[arg(long, default_value_t = 1)]
        seed: u64,
        #[command(flatten)]
        keys: Keys,
    },
    /// Make the keys with which machines know each other, and what each may do.
    Keys(MakeKeys),
}

impl Cluster {
    pub(super) async fn act(&self, talk: &Printer, config: &Config) -> Outcome {
        match &self.verb {
            ClusterVerb::Up(verb) => verb.act(talk, config).await,
            ClusterVerb::Worker(verb) => verb.act(config).await,
            ClusterVerb::Keys(verb) => verb.act(talk),
            ClusterVerb::Submit { requests, connect, namespace, seed, keys } => {
                let config = &keys.over(config)?;
                done(socrates_app::cluster::submit(talk, config, requests, connect, namespace, *seed).await)
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
    /// Faults to inject, for experiments: `die_before_report=0.1,drop_report=0.05`.
    #[arg(long, default_value = "")]
    inject: String,
    #[command(flatten)]
    keys: Keys,
}

impl Worker {
    pub(super) async fn act(&self, config: &Config) -> Outcome {
        let Self { stage, connect, namespace, blobs, spool, tied, inject, keys } = self.clone();
        let config = &keys.over(config)?;
        let options = WorkerOptions { stage, connect, namespace, blobs, spool, tied, inject };
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
    /// Endpoint to listen on, such as `tcp/127.0.0.1:7447`; one that other machines can reach has TLS and needs `--keys`, such as
    /// `tls/0.0.0.0:7447`, or needs `--insecure`.
    #[arg(long)]
    listen: Option<String>,
    /// Listens where other machines can reach it: whoever does may hand in and read jobs, and join as a worker that
    /// returns any result. There is no password and no encryption.
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
        let Self { dir, listen, insecure, connect, namespace, durable, tied, alone, keys } = self.clone();
        let config = &keys.over(config)?;
        let durable = match durable {
            Durable::Disk => Durability::Disk,
            Durable::Process => Durability::Process,
        };
        let options = OrchestratorOptions { dir, listen, insecure, connect, namespace, durable, tied, alone };
        done(process::orchestrator(talk, config, &options).await)
    }
}
