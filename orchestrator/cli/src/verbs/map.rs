//! `map`: locations.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use socrates_app::map;
use socrates_app::output::Printer;

use super::{Outcome, done};

/// Arguments of `map`.
#[derive(Debug, Args)]
pub(crate) struct Map {
    /// What to do.
    #[command(subcommand)]
    verb: MapVerb,
}

/// Verbs of `map`.
#[derive(Debug, Subcommand)]
enum MapVerb {
    /// List the shipped locations and their requests.
    List,
    /// Check a location: everything that is wrong with it, at once.
    Check {
        /// A shipped name or a folder.
        location: String,
    },
    /// Draw a location with its node ids.
    Draw {
        /// A shipped name or a folder.
        location: String,
        /// PNG or SVG file to write.
        #[arg(long, short, default_value = "map.png")]
        out: PathBuf,
    },
    /// Make a location folder from a floor plan (`plan.toml`).
    Generate {
        /// The floor plan.
        plan: PathBuf,
        /// Folder to write.
        #[arg(long, short)]
        out: PathBuf,
    },
}

impl Map {
    pub(super) fn act(&self, talk: &Printer) -> Outcome {
        done(match &self.verb {
            MapVerb::List => map::list(talk),
            MapVerb::Check { location } => map::check(talk, location),
            MapVerb::Draw { location, out } => map::draw(talk, location, out),
            MapVerb::Generate { plan, out } => map::generate(talk, plan, out),
        })
    }
}
