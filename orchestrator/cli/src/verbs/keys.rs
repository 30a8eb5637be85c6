//! `cluster keys`, and `--keys` of the verbs that join a bus.

use std::path::PathBuf;

use clap::Args;
use socrates_app::config::Config;
use socrates_app::exit::Diagnostic;
use socrates_app::keys::{self, KeysOptions};
use socrates_app::output::Printer;

use super::{Outcome, done};

/// Arguments of `cluster keys`.
#[derive(Debug, Args)]
pub(crate) struct MakeKeys {
    /// Folder that gets a folder for each role: orchestrator, worker, client, viewer, driver, router.
    dir: PathBuf,
    /// Name or address by which other machines connect to the orchestrator or router, besides localhost and 127.0.0.1; may be repeated.
    #[arg(long = "host", value_name = "NAME_OR_IP")]
    hosts: Vec<String>,
    /// Days that the keys hold, 1 to 3650.
    #[arg(long, default_value_t = 365)]
    days: u32,
    /// Make all keys anew where there are some; those that were handed out are then refused.
    #[arg(long)]
    force: bool,
}

impl MakeKeys {
    pub(super) fn act(&self, talk: &Printer) -> Outcome {
        let Self { dir, hosts, days, force } = self;
        let options = KeysOptions { dir: dir.clone(), hosts: hosts.clone(), days: *days, force: *force };
        done(keys::make(talk, &options))
    }
}

/// Keys of the role that a process plays.
#[derive(Debug, Clone, Args)]
pub(crate) struct Keys {
    /// Folder with the keys of a role, made by `socrates cluster keys`, for endpoints that begin with `quic/`; also `bus.keys` of the
    /// configuration, or SOCRATES_BUS__KEYS.
    #[arg(long = "keys", value_name = "FOLDER")]
    folder: Option<PathBuf>,
}

impl Keys {
    /// The configuration with them.
    pub(crate) fn over(&self, config: &Config) -> Result<Config, Diagnostic> {
        let chosen = self.folder.iter().map(|folder| format!("{}={}", keys::SETTING, folder.display()));
        config.clone().with(&chosen.collect::<Vec<_>>())
    }
}
