//! `explain` and `config`: the manual, and why a job waits.

use std::path::PathBuf;

use clap::Args;
use socrates_app::exit::Diagnostic;
use socrates_app::explain_job::{self, Where};
use socrates_app::output::Printer;
use socrates_app::{config, explain};

use super::keys::Keys;
use super::{Outcome, done};

/// Arguments of `explain`.
#[derive(Debug, Args)]
pub(crate) struct Explain {
    /// Fault code, metric such as `ttc_min`, or word such as `encounter gap`; `metrics` and `words` list all of them. With `--connect` or
    /// `--dir`: a job, as SCENARIO, SCENARIO/STAGE or SCENARIO/STAGE/ITEM, of which it is said what was tried and why it waits.
    #[arg(value_name = "WORD|JOB")]
    code: Vec<String>,
    /// Endpoint of the orchestrator that has the job.
    #[arg(long)]
    connect: Option<String>,
    /// Namespace.
    #[arg(long, default_value = "main")]
    namespace: String,
    /// Folder of a run, or of `cluster up`, whose job store has the job; it is only read, also where nobody serves it.
    #[arg(long, conflicts_with = "connect")]
    dir: Option<PathBuf>,
    /// Folder of logs, as `cluster up` and `cluster work` keep them in `logs`, whose lines about the job are shown in order of time; may be
    /// repeated. With `--dir` its own logs are looked at anyway.
    #[arg(long, value_name = "DIR")]
    logs: Vec<PathBuf>,
    #[command(flatten)]
    keys: Keys,
}

impl Explain {
    pub(super) async fn act(&self, talk: &Printer, config: &config::Config) -> Outcome {
        let Self { code, connect, namespace, dir, logs, keys } = self;
        let at = match (connect, dir) {
            (Some(connect), _) => Where::Endpoint(connect.clone(), namespace.clone()),
            (None, Some(dir)) => Where::Folder(dir.clone()),
            (None, None) => return done(explain::explain(talk, code)),
        };
        let [job] = &code[..] else {
            let named = code.join(" ");
            return Err(Diagnostic::input(
                format!("`{named}` names no single job"),
                "name one, such as s-1/paths; `socrates status --all` lists the scenarios",
            ));
        };
        done(explain_job::explain(talk, &keys.over(config)?, job, &at, logs).await)
    }
}

/// Arguments of `config`.
#[derive(Debug, Args)]
pub(crate) struct Config {
    /// Only this part, such as `author`.
    part: Option<String>,
}

impl Config {
    pub(super) fn act(&self, talk: &Printer, config: &config::Config) -> Outcome {
        done(explain::config(talk, config, self.part.as_deref()))
    }
}
