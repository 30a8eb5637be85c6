//! `dev`: for developers of SocRATES.

use std::path::Path;

use serde_json::json;

use crate::agents;
use crate::agreement;
use crate::args::{Cli, DevVerb};
use crate::bench;
use crate::bundle;
use crate::config::Config;
use crate::exit::Complaint;
use crate::mutations;
use crate::talk::Talk;
use crate::traces;

/// Largest file of the published tool that is read, bytes.
const MAX_IMPORT_BYTES: u64 = 64 * 1024 * 1024;

/// Does a `dev` verb.
pub(crate) async fn dev(talk: &Talk, cli: &Cli, config: &Config, verb: &DevVerb) -> Result<(), Complaint> {
    match verb {
        DevVerb::Probe { author } => crate::authors::probe(talk, config, author).await,
        DevVerb::Tokens { out } => crate::tokens::tokens(talk, out.as_deref()).await,
        DevVerb::Schema { artifact } => schema(talk, artifact),
        DevVerb::Import { file } => import(talk, file),
        DevVerb::Export { bundle, out } => export(talk, bundle, out),
        DevVerb::SfmTrace { scene, out, forces } => traces::crowd(talk, scene, out, forces.as_deref()),
        DevVerb::BtTrace { tree, script, out, events } => traces::tree(talk, tree, script, out, events),
        DevVerb::Agents { file, to, out } => agents::convert(talk, file, to.as_deref(), out.as_deref()),
        DevVerb::Mutations { requests, seeds, all } => mutations::mutations(talk, config, requests, *seeds, *all).await,
        DevVerb::Agreement { labels, bundles } => agreement::agreement(talk, labels, bundles),
        DevVerb::Golden { agents } => crate::golden::golden(talk, config, agents).await,
        DevVerb::Fuzz(options) => crate::fuzz::fuzz(talk, config, options),
        DevVerb::Bench { runs, library } => bench::bench(talk, cli, config, *runs, *library).await,
    }
}

fn schema(talk: &Talk, artifact: &str) -> Result<(), Complaint> {
    let schema = socrates_model::schema::of(artifact).ok_or_else(|| {
        Complaint::input(
            format!("there is no artifact `{artifact}`"),
            format!("artifacts: {}", socrates_model::schema::NAMES.join(", ")),
        )
    })?;
    let text = serde_json::to_string_pretty(&schema).unwrap_or_default();
    talk.line(&text);
    talk.result(&schema);
    Ok(())
}

/// What a file of the published tool holds.
pub(crate) fn imported(file: &Path) -> Result<socrates_export::socrates_json::Imported, Complaint> {
    let text = crate::files::text(file, MAX_IMPORT_BYTES, "name a JSON file of the published tool")?;
    socrates_export::socrates_json::read(&text).map_err(|why| {
        Complaint::input(
            format!("`{}`: {why}", file.display()),
            "the forms are scenario, trajectory, trees and combined",
        )
    })
}

fn import(talk: &Talk, file: &Path) -> Result<(), Complaint> {
    let found = imported(file)?;
    let object = json!({ "proposal": found.proposal, "paths": found.paths, "behaviors": found.behaviors });
    talk.line(&serde_json::to_string_pretty(&object).unwrap_or_default());
    talk.result(&object);
    Ok(())
}

fn export(talk: &Talk, dir: &Path, out: &Path) -> Result<(), Complaint> {
    let bundle = bundle::read(dir)?;
    let cannot = |why: std::io::Error| {
        Complaint::input(format!("cannot write into `{}`: {why}", out.display()), "--out chooses another folder")
    };
    std::fs::create_dir_all(out).map_err(cannot)?;
    let files = [
        ("scenario.json", socrates_export::socrates_json::scenario(&bundle.proposal)),
        ("trajectory.json", socrates_export::socrates_json::trajectory(&bundle.proposal, &bundle.paths)),
        ("bt.json", socrates_export::socrates_json::trees(&bundle.behaviors)),
        (
            "response_traj.json",
            socrates_export::socrates_json::combined(&bundle.proposal, &bundle.paths, &bundle.behaviors),
        ),
    ];
    for (name, value) in &files {
        std::fs::write(out.join(name), serde_json::to_string_pretty(value).unwrap_or_default()).map_err(cannot)?;
    }
    talk.line(&format!("wrote      {} ({})", out.display(), files.map(|(name, _)| name).join(", ")));
    talk.result(&json!({ "out": out.display().to_string() }));
    Ok(())
}
