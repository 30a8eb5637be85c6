//! `socrates-dev sfm-trace` and `socrates-dev bt-trace`: our crowd and our trees in the formats of reference traces.

use std::path::Path;

use serde_json::json;
use socrates_app::bt::{faulty, including};
use socrates_app::exit::Diagnostic;
use socrates_app::files;
use socrates_app::output::Printer;

use crate::crowd_trace::{Scene, SceneError, forces_table, trajectory};

/// Largest scene or script that is read, bytes.
const MAX_BYTES: u64 = 64 * 1024 * 1024;

/// Steps a scene and writes where everybody was, and the forces where wanted.
pub fn crowd(talk: &Printer, scene: &Path, out: &Path, forces: Option<&Path>) -> Result<(), Diagnostic> {
    let text = files::text(scene, MAX_BYTES, "name a scene in JSON")?;
    let read = Scene::read(&text).map_err(|why: SceneError| {
        let why = why.to_string();
        let mut lines = why.lines().map(|line| line.trim().to_owned());
        let mut diagnostic = Diagnostic::input(
            format!("`{}`: {}", scene.display(), lines.next().unwrap_or_default()),
            "the README of `workers/simulation/crowd` describes scenes",
        );
        diagnostic.causes = lines.collect();
        diagnostic
    })?;
    files::write(out, trajectory(&read).as_bytes())?;
    if let Some(forces) = forces {
        files::write(forces, forces_table(&read).as_bytes())?;
    }
    talk.line(&format!("wrote      {}", out.display()));
    talk.result(
        &json!({ "trajectory": out.display().to_string(), "forces": forces.map(|path| path.display().to_string()) }),
    );
    Ok(())
}

/// Ticks a tree with scripted leaves and writes what every node did.
pub fn tree(talk: &Printer, tree: &Path, script: &Path, out: &Path, events: &Path) -> Result<(), Diagnostic> {
    let xml = files::bytes(tree, MAX_BYTES, "name a tree in BehaviorTree.CPP XML")?;
    let script = files::text(script, MAX_BYTES, "name a script in JSON")?;
    let folder = tree.parent().unwrap_or_else(|| Path::new("."));
    let found = socrates_bt::decode(&xml)
        .map_err(|fault| vec![fault])
        .and_then(|xml| socrates_bt::trace(xml, Some(&|path| including(folder, path)), &script))
        .map_err(|faults| faulty(tree, &faults))?;
    files::write(out, found.trace_csv.as_bytes())?;
    files::write(events, found.events_csv.as_bytes())?;
    talk.line(&format!("wrote      {} and {}", out.display(), events.display()));
    talk.result(&json!({ "trace": out.display().to_string(), "events": events.display().to_string() }));
    Ok(())
}
