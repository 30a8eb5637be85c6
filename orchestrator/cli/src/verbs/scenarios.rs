//! `scenarios`: the catalog.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use socrates_app::output::Printer;
use socrates_app::scenarios;

use super::{Outcome, done};

/// Arguments of `scenarios`.
#[derive(Debug, Args)]
pub(crate) struct Scenarios {
    /// What to do.
    #[command(subcommand)]
    verb: ScenariosVerb,
}

/// Verbs on the catalog.
#[derive(Debug, Subcommand)]
enum ScenariosVerb {
    /// List every scenario.
    List,
    /// Show the card of a scenario.
    Show {
        /// Its id, or the letter of a canonical one.
        id: String,
    },
    /// Play scenarios with the reference robot and count how often each is realised.
    Rate {
        /// Ids or letters; all of them where none is named.
        ids: Vec<String>,
        /// Seeds 1 to N for each.
        #[arg(long, default_value_t = 20, value_parser = clap::value_parser!(u64).range(1..=10_000))]
        seeds: u64,
        /// A location for all of them; default: the shipped ones that fit, in turn.
        #[arg(long)]
        location: Option<String>,
        /// Markdown file for the table.
        #[arg(long, short)]
        out: Option<PathBuf>,
    },
}

impl Scenarios {
    pub(super) async fn act(&self, talk: &Printer) -> Outcome {
        done(match &self.verb {
            ScenariosVerb::List => {
                scenarios::list(talk);
                Ok(())
            }
            ScenariosVerb::Show { id } => scenarios::show(talk, id).await,
            ScenariosVerb::Rate { ids, seeds, location, out } => {
                scenarios::rate(talk, ids, *seeds, location.as_deref(), out.as_deref()).await
            }
        })
    }
}
