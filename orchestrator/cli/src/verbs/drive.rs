//! `drive`: drivers outside.

use clap::{Args, Subcommand};
use socrates_app::config::Config;
use socrates_app::drive_check::{self, CheckOptions};
use socrates_app::output::Printer;

use super::{Outcome, done};

/// Arguments of `drive`.
#[derive(Debug, Args)]
pub(crate) struct Drive {
    /// What to do.
    #[command(subcommand)]
    what: What,
}

/// What can be done with a driver.
#[derive(Debug, Subcommand)]
enum What {
    /// Try every message on a driver and say what it does with each; for those who write one.
    Check(Check),
}

/// Arguments of `drive check`.
#[derive(Debug, Args)]
struct Check {
    /// Its name, without `external:`.
    name: String,
    /// Folder of `socrates serve`, or endpoint, where it is connected.
    #[arg(long, conflicts_with = "driver")]
    place: Option<String>,
    /// Command that starts it; it ends with the check.
    #[arg(long, value_name = "COMMAND", required_unless_present = "place")]
    driver: Option<String>,
}

impl Drive {
    pub(super) async fn act(&self, talk: &Printer, config: &Config) -> Outcome {
        let What::Check(Check { name, place, driver }) = &self.what;
        let options = CheckOptions { driver: name.clone(), place: place.clone(), command: driver.clone() };
        done(drive_check::check(talk, config, &options).await)
    }
}
