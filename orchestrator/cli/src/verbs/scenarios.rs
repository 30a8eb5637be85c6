//! `scenarios`: the catalog.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use socrates_app::output::Printer;
use socrates_app::rates::{self, RateOptions};
use socrates_app::scenarios;
use socrates_model::Seeds;

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
        /// Seeds 1 to N of each scenario, on the locations that it fits in turn.
        #[arg(long, default_value_t = 20, value_parser = clap::value_parser!(u64).range(1..=10_000))]
        seeds: u64,
        /// A shipped name or a folder; again for each further one. Default: the shipped locations, or none beside random worlds.
        #[arg(long, value_name = "LOCATION")]
        location: Vec<String>,
        /// Play on random worlds of these seeds: "7", "1..40" or "1,4,9", each kind with every seed.
        #[arg(long, value_name = "SEEDS")]
        random: Option<Seeds>,
        /// Kind of the random worlds: office, hospital, warehouse, hall or home; again for each further one. Default: every kind.
        #[arg(long, requires = "random")]
        kind: Vec<String>,
        /// Play every seed on each location that fits instead of on one in turn.
        #[arg(long)]
        each: bool,
        /// Markdown file for the tables.
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
            ScenariosVerb::Rate { ids, seeds, location, random, kind, each, out } => {
                let (ids, locations, out) = (ids.clone(), location.clone(), out.clone());
                let (worlds, kinds) = (random.clone(), kind.clone());
                rates::rate(talk, &RateOptions { ids, seeds: *seeds, each: *each, locations, worlds, kinds, out })
            }
        })
    }
}
