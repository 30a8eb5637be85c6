//! `dev`: for developers of SocRATES.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use socrates_app::config::Config;
use socrates_app::output::Printer;
use socrates_app::{agents, agreement, authors, dev};

use super::{Outcome, done};

/// Arguments of `dev`.
#[derive(Debug, Args)]
pub(crate) struct Dev {
    /// What to do.
    #[command(subcommand)]
    verb: DevVerb,
}

/// Verbs of `dev`.
#[derive(Debug, Subcommand)]
enum DevVerb {
    /// Ask a model's server one small question that tells how far it enforces the form of an answer.
    Probe {
        /// Author, such as `ollama:MODEL`.
        author: String,
    },
    /// Print the JSON schema of an artifact.
    Schema {
        /// `request`, `reading`, `proposal`, `paths`, `behaviors`, `report`, `location`, `clause`.
        artifact: String,
    },
    /// Read a file of the published SocRATES tool and print what it holds.
    Import {
        /// Scenario, trajectory, tree or combined JSON.
        file: PathBuf,
    },
    /// Write a bundle as the published tool's stage files.
    Export {
        /// Bundle folder.
        bundle: PathBuf,
        /// Folder to write.
        #[arg(long, short)]
        out: PathBuf,
    },
    /// Check a HuNavSim agents file, and write it in the form of another version.
    Agents {
        /// Agents file.
        file: PathBuf,
        /// Version to write: `1.0` (also the SocRATES fork), `1.1`, `2.0`.
        #[arg(long, value_parser = ["1.0", "1.1", "2.0"])]
        to: Option<String>,
        /// File to write; default: standard output.
        #[arg(long, short)]
        out: Option<PathBuf>,
    },
    /// Compare labels that people gave to runs with the verdicts: Cohen's kappa, Krippendorff's alpha.
    Agreement {
        /// Labels (CSV): `run,rater,simulable,appropriate,as_asked`, yes or no.
        labels: PathBuf,
        /// Bundles that hold the runs.
        #[arg(required = true)]
        bundles: Vec<PathBuf>,
    },
}

impl Dev {
    pub(super) async fn act(&self, talk: &Printer, config: &Config) -> Outcome {
        done(match &self.verb {
            DevVerb::Probe { author } => authors::probe(talk, config, author).await,
            DevVerb::Schema { artifact } => dev::schema(talk, artifact),
            DevVerb::Import { file } => dev::import(talk, file),
            DevVerb::Export { bundle, out } => dev::export(talk, bundle, out),
            DevVerb::Agents { file, to, out } => agents::convert(talk, file, to.as_deref(), out.as_deref()),
            DevVerb::Agreement { labels, bundles } => agreement::agreement(talk, labels, bundles),
        })
    }
}
