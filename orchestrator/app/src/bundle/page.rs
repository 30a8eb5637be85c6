//! The page of a bundle, filled from what the bundle holds.

use socrates_draw::{Page, ProvenanceRow, StageRow};

use super::Bundle;
use crate::layout;

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

/// Versions, author, seed and the hashes that a reader can check against the files.
fn provenance_rows(bundle: &Bundle, author: &str) -> Vec<ProvenanceRow> {
    let manifest = &bundle.manifest;
    let digest = |name: &str| manifest.files.get(name).map(ToString::to_string).unwrap_or_default();
    let mut rows = vec![
        ("version".to_owned(), env!("CARGO_PKG_VERSION").to_owned()),
        ("author".to_owned(), author.to_owned()),
        ("seed".to_owned(), manifest.seed.to_string()),
        ("wish".to_owned(), manifest.wish.to_string()),
    ];
    let files = [layout::REQUEST, layout::LOCATION, layout::PROPOSAL];
    rows.extend(files.map(|sheet| (sheet.file_name().to_owned(), digest(sheet.path))));
    // What was scored before there were signatures has none.
    let signed = bundle.runs.iter().map(|(_, report)| &report.thresholds).find(|text| !text.is_empty());
    rows.extend(signed.map(|text| ("thresholds".to_owned(), text.clone())));
    rows.extend(manifest.runs.iter().map(|run| (format!("recording {}", run.run()), run.recording_hash.to_string())));
    rows.into_iter().map(|(name, value)| ProvenanceRow { name, value }).collect()
}
