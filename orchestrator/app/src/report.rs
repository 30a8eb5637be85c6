//! `report`: the pages of a bundle, or of a folder of bundles, written anew from what lies in them.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Deserialize as _;
use serde_json::json;
use socrates_draw::{Page, ProvenanceRow, StageRow};
use socrates_model::JobState;
use socrates_model::job::Stage;

use crate::batch;
use crate::batch_stats;
use crate::bundle::{self, Bundle};
use crate::exit::Complaint;
use crate::output::Printer;

/// The page of a bundle.
pub(crate) fn page(bundle: &Bundle, stages: &[StageRow], author: &str) -> String {
    let title = format!("{} · {}", bundle.proposal.title, bundle.location.name);
    let reading_line = socrates_offline::summary(&bundle.reading);
    let provenance = provenance_rows(bundle, author);
    let page = Page {
        title: &title,
        request: &bundle.request,
        reading: &bundle.reading,
        reading_line: &reading_line,
        location: &bundle.location,
        proposal: &bundle.proposal,
        paths: &bundle.paths,
        runs: &bundle.runs,
        stages,
        provenance: &provenance,
    };
    page.html()
}

/// Writes the page of a bundle, or the page of a folder of bundles.
pub fn report(talk: &Printer, what: &Path) -> Result<(), Complaint> {
    if !bundle::is_bundle(what) {
        let found = batch::write(talk, what, BTreeMap::new())?;
        let page = what.join(crate::layout::PAGE.path);
        let repeats = found.rows - found.distinct;
        let of_them = if repeats > 0 {
            format!(" · {} distinct, {repeats} repeat one of them", found.distinct)
        } else {
            String::new()
        };
        talk.line(&format!("scenarios  {}{of_them}", found.rows));
        for (name, why) in &found.left_out {
            talk.line(&format!("left out   {name}: {why}"));
        }
        if let Ok(pool) = &found.figures {
            batch_stats::print(talk, pool);
        }
        talk.line(&format!("table      {}", what.join(crate::index::FILE).display()));
        talk.line(&format!("look       {}", page.display()));
        let left_out: Vec<_> = found.left_out.iter().map(|(name, why)| json!({ "name": name, "why": why })).collect();
        let figures = found.figures.as_ref().ok().map(batch_stats::result);
        talk.result(&json!({
            "page": page.display().to_string(), "scenarios": found.rows, "distinct": found.distinct, "left_out": left_out, "figures": figures,
        }));
        return found.figures.map(|_| ());
    }
    let bundle = bundle::read(what)?;
    let (stages, author) = past(what);
    let file = what.join(crate::layout::PAGE.path);
    crate::files::write(&file, page(&bundle, &stages, &author).as_bytes())?;
    talk.line(&format!("look       {}", file.display()));
    talk.result(&json!({ "page": file.display().to_string(), "runs": bundle.runs.len() }));
    Ok(())
}

/// Versions, author, seed and the hashes that a reader can check against the files.
fn provenance_rows(bundle: &Bundle, author: &str) -> Vec<ProvenanceRow> {
    let manifest = &bundle.manifest;
    let digest = |name: &str| manifest.files.get(name).map(ToString::to_string).unwrap_or_default();
    let mut rows = vec![
        ("version".to_owned(), env!("CARGO_PKG_VERSION").to_owned()),
        ("author".to_owned(), author.to_owned()),
        ("seed".to_owned(), manifest.seed.to_string()),
        ("wish".to_owned(), manifest.wish.to_string()),
        ("request.toml".to_owned(), digest(crate::layout::REQUEST.path)),
        ("location.json".to_owned(), digest(crate::layout::LOCATION.path)),
        ("proposal.json".to_owned(), digest(crate::layout::PROPOSAL.path)),
    ];
    // What was scored before there were signatures has none.
    let signed = bundle.runs.iter().map(|(_, report)| &report.thresholds).find(|text| !text.is_empty());
    rows.extend(signed.map(|text| ("thresholds".to_owned(), text.clone())));
    rows.extend(manifest.runs.iter().map(|run| (format!("recording {}", run.run()), run.recording_hash.to_string())));
    rows.into_iter().map(|(name, value)| ProvenanceRow { name, value }).collect()
}

/// Stage lines and author out of the provenance of a bundle; a bundle without one has neither.
pub(crate) fn past(dir: &Path) -> (Vec<StageRow>, String) {
    let text = std::fs::read_to_string(dir.join(crate::layout::PROVENANCE.path)).unwrap_or_default();
    let value: serde_json::Value = serde_json::from_str(&text).unwrap_or_default();
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
