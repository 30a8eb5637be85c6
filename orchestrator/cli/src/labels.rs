//! `labels page`: a page on which people label the runs of bundles by hand.

use std::collections::BTreeMap;
use std::path::PathBuf;

use clap::Subcommand;
use serde_json::json;
use socrates_draw::LabelPage;
use socrates_model::Recording;

use crate::batch;
use crate::bundle;
use crate::exit::Complaint;
use crate::talk::Talk;

/// More runs than anybody labels in one sitting, and than a browser opens at once.
const MOST: usize = 500;

/// Verbs of `labels`.
#[derive(Debug, Subcommand)]
pub(crate) enum LabelsVerb {
    /// Write a page on which people label runs: simulable, appropriate, as asked. It needs no network and saves a CSV.
    Page {
        /// Bundle folders, or folders that hold bundles.
        #[arg(required = true)]
        bundles: Vec<PathBuf>,
        /// File to write.
        #[arg(long, short, default_value = "labels.html")]
        out: PathBuf,
        /// Only the first run of each bundle.
        #[arg(long)]
        first: bool,
        /// Heading of the page.
        #[arg(long, default_value = "What do you see?")]
        title: String,
    },
}

/// Does a verb of `labels`.
pub(crate) fn labels(talk: &Talk, verb: &LabelsVerb) -> Result<(), Complaint> {
    let LabelsVerb::Page { bundles, out, first, title } = verb;
    let mut page = LabelPage::default();
    let mut known: BTreeMap<String, PathBuf> = BTreeMap::new();
    for dir in folders(bundles)? {
        let bundle = bundle::read_some(&dir, |index, _| !first || index == 0)?;
        let all: Vec<&Recording> = bundle.runs.iter().map(|(recording, _)| recording).collect();
        for (recording, report) in &bundle.runs {
            // Without the robot there is nothing to label: the twin run only serves comparison.
            if report.planner == "none" {
                continue;
            }
            let id = report.run.to_string();
            if let Some(other) = known.insert(id.clone(), dir.clone()) {
                return Err(Complaint::input(
                    format!("`{}` and `{}` both hold a run `{id}`", other.display(), dir.display()),
                    "a label could not tell them apart; make two pages",
                ));
            }
            page.add(&bundle.request, &bundle.location, &bundle.paths, &all, recording);
        }
        if page.len() > MOST {
            return Err(Complaint::input(
                format!("`{}` runs are too many for one page", page.len()),
                format!("at most {MOST}; --first takes one run of each bundle, or name fewer bundles"),
            ));
        }
    }
    if page.is_empty() {
        return Err(Complaint::input("the bundles hold no run with a robot", "`socrates run` makes one"));
    }
    crate::files::write(out, page.html(title).as_bytes())?;
    talk.line(&format!("wrote      {} · {} runs", out.display(), page.len()));
    talk.result(&json!({ "page": out.display().to_string(), "runs": known.keys().collect::<Vec<_>>() }));
    Ok(())
}

/// Every bundle that is meant: a bundle itself, or those right below a folder.
fn folders(named: &[PathBuf]) -> Result<Vec<PathBuf>, Complaint> {
    let mut found = Vec::new();
    for dir in named {
        if bundle::manifest(dir).is_some() {
            found.push(dir.clone());
            continue;
        }
        let names = batch::bundles(dir)?;
        if names.is_empty() {
            return Err(batch::none(dir));
        }
        found.extend(names.iter().map(|name| dir.join(name)));
    }
    Ok(found)
}
