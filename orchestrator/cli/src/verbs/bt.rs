//! `bt`: behavior trees.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use socrates_app::bt;
use socrates_app::output::Printer;

use super::{Outcome, done};

/// Arguments of `bt`.
#[derive(Debug, Args)]
pub(crate) struct Bt {
    /// What to do.
    #[command(subcommand)]
    verb: BtVerb,
}

/// Verbs of `bt`.
#[derive(Debug, Subcommand)]
enum BtVerb {
    /// Read trees, tick every case of their conditions, and say what is wrong, with line and column.
    Check {
        /// XML files.
        #[arg(required = true)]
        trees: Vec<PathBuf>,
        /// Whose nodes: `native`, `socrates-fork`, `hunav-1.0`, `hunav-1.1`, `hunav-2.0`.
        #[arg(long, default_value = "native")]
        library: String,
    },
    /// Draw a tree as text, or as SVG or PNG.
    Show {
        /// XML file.
        tree: PathBuf,
        /// SVG or PNG file to write.
        #[arg(long, short)]
        out: Option<PathBuf>,
        /// Whose nodes; default: the first library that knows them all.
        #[arg(long)]
        library: Option<String>,
    },
    /// Write a tree in the other XML version or for another simulator, with a note for what changes meaning.
    Convert {
        /// XML file.
        tree: PathBuf,
        /// `v3` or `v4`.
        #[arg(long, value_parser = ["v3", "v4"])]
        to: String,
        /// Whose nodes it is read with; default: the first library that knows them all.
        #[arg(long)]
        library: Option<String>,
        /// Simulator it is written for; default: as it is read.
        #[arg(long = "for")]
        target: Option<String>,
        /// File to write; default: standard output.
        #[arg(long, short)]
        out: Option<PathBuf>,
    },
}

impl Bt {
    pub(super) fn act(&self, talk: &Printer) -> Outcome {
        done(match &self.verb {
            BtVerb::Check { trees, library } => bt::check(talk, trees, library),
            BtVerb::Show { tree, out, library } => bt::show(talk, tree, out.as_deref(), library.as_deref()),
            BtVerb::Convert { tree, to, library, target, out } => {
                bt::convert(talk, tree, to, library.as_deref(), target.as_deref(), out.as_deref())
            }
        })
    }
}
