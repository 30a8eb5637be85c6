//! `study correlate`: metrics of the runs against what people said of their films.

use std::path::{Path, PathBuf};

use serde_json::json;
use socrates_scoring::metrics::peers;
use socrates_study::correlate::{Correlations, Metrics, Wanted, correlate as correlated};
use socrates_study::design::Design;
use socrates_study::exclude::excluded;

use super::{bad, design, rated, warn_of};
use crate::bundle;
use crate::exit::{Code, Diagnostic};
use crate::files;
use crate::output::Printer;

/// Options of `study correlate`.
#[derive(Debug, Clone)]
pub struct CorrelateOptions {
    /// Folder of tables, or a table of ratings.
    pub answers: PathBuf,
    /// Study file.
    pub design: PathBuf,
    /// Metrics that are declared.
    pub metrics: Vec<String>,
    /// Whether the best of all metrics is searched for.
    pub search: bool,
    /// Scenarios that the search does not see.
    pub hold_out: Vec<String>,
    /// Folder for the tables.
    pub out: PathBuf,
}

/// Does `study correlate`.
pub fn correlate(talk: &Printer, options: &CorrelateOptions) -> Result<(), Diagnostic> {
    let design = design(&options.design)?;
    let wanted = if options.search {
        Wanted::Search { hold_out: options.hold_out.clone() }
    } else if options.metrics.is_empty() {
        return Err(Diagnostic::input(
            "no metric is named, and the best of all would fit by chance",
            "`--metrics human_distance_min,space_compliance` declares those that you expect something of; `--search --hold-out SCENARIO` looks for one",
        ));
    } else {
        // Other tools' names are those of ours that they mean: the same values under two names would be two tests of one thing.
        let ours = |name: &String| peers::ours(name).map_or_else(|| name.clone(), |name| name.ours.to_owned());
        let mut declared: Vec<String> = Vec::new();
        for name in options.metrics.iter().map(ours) {
            if !declared.contains(&name) {
                declared.push(name);
            }
        }
        Wanted::Declared(declared)
    };
    let metrics = metrics(&design, &options.design)?;
    let ratings = rated(&options.answers, &design)?;
    let out = excluded(&ratings, &design);
    let found = correlated(&ratings, &design, &out, &metrics, &wanted).map_err(|why| bad(&why))?;
    let whole = serde_json::to_string_pretty(&found)
        .map_err(|why| Diagnostic::input(why.to_string(), "").with_code(Code::Ours))?;
    for (file, text) in
        [("correlations.csv", found.csv()), ("correlations.json", whole), ("correlations.txt", found.words())]
    {
        files::write(&options.out.join(file), text.as_bytes())?;
    }
    warn_of(talk, found.origin);
    tell(talk, &found);
    talk.line(&format!("table      {}", options.out.join("correlations.csv").display()));
    talk.result(&json!({ "out": options.out, "ceilings": found.ceilings, "correlations": found.correlations, "simulated": found.origin }));
    Ok(())
}

fn tell(talk: &Printer, found: &Correlations) {
    let shown = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |value| format!("{value:+.2}"));
    for one in &found.ceilings {
        talk.line(&format!(
            "ceiling    {}: one person against the others {}, reliability of the means {} ({} films)",
            one.dimension,
            shown(one.one_against_others),
            shown(one.reliability),
            one.films
        ));
    }
    for one in &found.correlations {
        let interval = one.interval.map_or_else(String::new, |(low, high)| format!(" [{low:+.2}, {high:+.2}]"));
        let p = one.p_holm.map_or_else(String::new, |p| format!(", p {p:.4} after Holm"));
        let held = one.held_out.map_or_else(String::new, |rho| format!(", {rho:+.2} on the films held out"));
        let note = if one.note.is_empty() { String::new() } else { format!(" · {}", one.note) };
        talk.line(&format!(
            "metric     {} and {}: {}{interval}{p}{held}, within scenarios {}{note}",
            one.metric,
            one.dimension,
            shown(one.rho),
            shown(one.within_scenarios)
        ));
    }
}

/// Metrics of the runs that films show; one without a value is missing.
fn metrics(design: &Design, file: &Path) -> Result<Metrics, Diagnostic> {
    let mut found = Metrics::new();
    for source in &design.sources {
        for dir in &source.bundles {
            let (_, reports) = bundle::read_with_reports(&file.with_file_name(dir), |_, _| false)?;
            for film in design.films.iter().filter(|film| film.scenario == source.name) {
                let own = reports.iter().find(|one| one.planner.as_str() == film.planner && one.seed == film.seed);
                for metric in own.into_iter().flat_map(|report| &report.metrics) {
                    let of = found.entry(metric.id.clone()).or_default();
                    if let Some(value) = metric.value {
                        of.insert(film.id.clone(), value);
                    }
                }
            }
        }
    }
    if found.is_empty() {
        return Err(Diagnostic::input(
            "the study does not say which runs its films show",
            "add `[[scenario]]` with name and bundles; `socrates study new` writes them",
        ));
    }
    Ok(found)
}
