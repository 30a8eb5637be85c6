//! `report`: the pages of a bundle, or of a folder of bundles, written anew from what lies in them.

use std::path::Path;

use serde::Deserialize as _;
use serde_json::json;
use socrates_draw::StageRow;
use socrates_model::JobState;
use socrates_model::job::Stage;

use crate::batch;
use crate::bundle;
use crate::exit::Diagnostic;
use crate::layout;
use crate::output::Printer;

/// Writes the page of a bundle, or the page of a folder of bundles.
pub fn report(talk: &Printer, what: &Path) -> Result<(), Diagnostic> {
    if !bundle::is_bundle(what) {
        return batch::report(talk, what);
    }
    if let Some(archive) = bundle::archive(what) {
        return Err(Diagnostic::input(
            format!("`{}` is packed, and its page is in it", archive.display()),
            format!("`tar --zstd -xf {}` makes a folder of it; `socrates open` does too", archive.display()),
        ));
    }
    let bundle = bundle::read(what)?;
    let (stages, author) = past(what);
    let file = what.join(layout::PAGE.path);
    crate::files::write(&file, bundle::page(&bundle, &stages, &author).as_bytes())?;
    talk.line(&format!("look       {}", file.display()));
    talk.result(&json!({ "page": file.display().to_string(), "runs": bundle.runs.len() }));
    Ok(())
}

/// Stage lines and author out of the provenance of a bundle; a bundle without one has neither.
pub(crate) fn past(dir: &Path) -> (Vec<StageRow>, String) {
    let text = bundle::file(dir, layout::PROVENANCE.path).unwrap_or_default();
    let value: serde_json::Value = serde_json::from_slice(&text).unwrap_or_default();
    let word = |value: &serde_json::Value, key: &str| -> String {
        value.get(key).and_then(serde_json::Value::as_str).unwrap_or_default().to_owned()
    };
    let rows = value.get("jobs").and_then(serde_json::Value::as_array).into_iter().flatten().map(|job| {
        let key = job.get("job").cloned().unwrap_or_default();
        let attempts: Vec<&serde_json::Value> =
            job.get("attempts").and_then(serde_json::Value::as_array).into_iter().flatten().collect();
        let remarks: Vec<String> =
            attempts.iter().map(|attempt| word(attempt, "remark")).filter(|remark| !remark.is_empty()).collect();
        StageRow {
            stage: key.get("stage").and_then(|stage| Stage::deserialize(stage).ok()),
            item: word(&key, "item"),
            revision: key.get("revision").and_then(serde_json::Value::as_u64).unwrap_or(0),
            state: job.get("state").and_then(|state| JobState::deserialize(state).ok()),
            attempts: u32::try_from(attempts.len()).unwrap_or(u32::MAX),
            wall_ms: attempts.iter().filter_map(|attempt| attempt.get("wall_ms")?.as_u64()).sum(),
            remark: remarks.join(" · "),
        }
    });
    (rows.collect(), word(&value, "author"))
}
