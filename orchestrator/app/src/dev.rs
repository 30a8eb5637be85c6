//! `dev`: for developers of SocRATES.

use std::path::Path;

use serde_json::json;

use crate::bundle;
use crate::exit::Diagnostic;
use crate::output::Printer;

/// Largest file of the published tool that is read, bytes.
const MAX_IMPORT_BYTES: u64 = 64 * 1024 * 1024;

/// Prints the JSON schema of an artifact.
pub fn schema(talk: &Printer, artifact: &str) -> Result<(), Diagnostic> {
    let schema = socrates_model::schema::of(artifact).ok_or_else(|| {
        Diagnostic::input(
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
pub fn imported(file: &Path) -> Result<socrates_export::socrates_json::Imported, Diagnostic> {
    let text = crate::files::text(file, MAX_IMPORT_BYTES, "name a JSON file of the published tool")?;
    socrates_export::socrates_json::read(&text).map_err(|why| {
        Diagnostic::input(
            format!("`{}`: {why}", file.display()),
            "the forms are scenario, trajectory, trees and combined",
        )
    })
}

/// Reads a file of the published tool and prints what it holds.
pub fn import(talk: &Printer, file: &Path) -> Result<(), Diagnostic> {
    let found = imported(file)?;
    let object = json!({ "proposal": found.proposal, "paths": found.paths, "behaviors": found.behaviors });
    talk.line(&serde_json::to_string_pretty(&object).unwrap_or_default());
    talk.result(&object);
    Ok(())
}

/// Writes a bundle as the published tool's stage files.
pub fn export(talk: &Printer, dir: &Path, out: &Path) -> Result<(), Diagnostic> {
    let bundle = bundle::read(dir)?;
    let cannot = |why: std::io::Error| {
        Diagnostic::input(format!("cannot write into `{}`: {why}", out.display()), "--out chooses another folder")
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
