//! `watch` and `status`: looking at what is being made.

use clap::Args;
use socrates_app::config::Config;
use socrates_app::output::Printer;
use socrates_app::standing::{self, Listed};
use socrates_app::watch;

use super::keys::Keys;
use super::{Outcome, done};

/// Arguments of `watch`.
#[derive(Debug, Args)]
pub(crate) struct Watch {
    /// Its bundle folder, or a zenoh endpoint such as `tcp/127.0.0.1:7447` or `quic/lab-3:7447@main`.
    what: String,
    /// Run name; default: the first that is announced.
    #[arg(long)]
    run: Option<String>,
    #[command(flatten)]
    keys: Keys,
}

impl Watch {
    pub(super) async fn act(&self, talk: &Printer, config: &Config) -> Outcome {
        let config = &self.keys.over(config)?;
        done(watch::watch(talk, config, &self.what, self.run.as_deref()).await)
    }
}

/// Arguments of `status`.
#[derive(Debug, Args)]
pub(crate) struct Status {
    /// Bundle or library folder, a folder of bundles, or a zenoh endpoint.
    what: String,
    /// Only this batch of a cluster.
    #[arg(long, value_name = "NAME")]
    batch: Option<String>,
    /// List those of which no bundle could be made, with the reason.
    #[arg(long)]
    failed: bool,
    /// List every scenario with what its stages did.
    #[arg(long)]
    all: bool,
    #[command(flatten)]
    keys: Keys,
}

impl Status {
    pub(super) async fn act(&self, talk: &Printer, config: &Config) -> Outcome {
        let config = &self.keys.over(config)?;
        let listed = match (self.all, self.failed) {
            (true, _) => Listed::All,
            (false, true) => Listed::Failed,
            (false, false) => Listed::None,
        };
        done(standing::status(talk, config, &self.what, self.batch.as_deref(), listed).await)
    }
}
