//! `simulate` and `score`: a bundle again, or tracks and bags of one's own.

mod bags;
mod lines;
mod options;
pub mod tracks;

pub use options::ScoreOptions;
pub use tracks::{Group, group, point};

use std::path::{Path, PathBuf};

use serde_json::json;
use socrates_draw::{FigureRow, TrackPage};
use socrates_model::{MetricValue, PlannerName, Report, Run, ScenarioId};
use socrates_scoring::Evidence;
use socrates_scoring::metrics::{KEY_FIGURES, in_words, key_figures};
use socrates_simulation::driving::{Again, Nobody, Outside};
use socrates_stream::csv::{RunChoice, Table, joined};

use crate::bundle::{self, Bundle, RunEntry};
use crate::exit::{Code, Diagnostic};
use crate::files;
use crate::in_process::{self, Made};
use crate::output::Printer;
use crate::prepare::load_location;
use crate::replay::tracks::{Known, Scored};
use crate::scribe::{Scribe, Written};

/// Simulates a bundle again and compares hashes.
pub fn simulate(
    talk: &Printer,
    dir: &Path,
    planner: Option<&PlannerName>,
    seed: Option<u64>,
    out: Option<&PathBuf>,
) -> Result<(), Diagnostic> {
    let bundle = bundle::read(dir)?;
    let mut wanted: Vec<Run> = bundle.manifest.runs.iter().map(RunEntry::run).collect();
    if planner.is_some() || seed.is_some() {
        let first = bundle.manifest.runs.first().map_or(1, |run| run.seed);
        let planner = planner.cloned().unwrap_or_else(PlannerName::reference);
        wanted = vec![Run { planner, seed: seed.unwrap_or(first) }];
    }
    let mut rows = Vec::new();
    let mut differ = 0;
    for run in wanted {
        let path = out.map(|folder| folder.join(format!("{run}.mcap")));
        let Written { hash, last_s, .. } = written(&bundle, &run, path.as_deref())?;
        let known = bundle.manifest.runs.iter().find(|entry| entry.run() == run).map(|entry| entry.recording_hash);
        let word = match known {
            Some(known) if known == hash => "same hash as the bundle",
            Some(_) => {
                differ += 1;
                "ANOTHER hash than the bundle"
            }
            None => "not in the bundle",
        };
        let Run { planner, seed } = run;
        talk.line(&format!("simulated  {planner} seed {seed}: {last_s:.1} s, {} ({word})", hash.short()));
        rows.push(json!({ "planner": planner, "seed": seed, "recording_hash": hash, "same": known.map(|known| known == hash) }));
    }
    talk.result(&json!({ "bundle": dir.display().to_string(), "runs": rows }));
    if differ > 0 {
        return Err(differs(&bundle, &format!("{differ} recordings differ from the bundle's")));
    }
    Ok(())
}

/// One run of a bundle's scenario; its recording goes into a file where one is named, and is kept nowhere else.
pub fn written(bundle: &Bundle, run: &Run, path: Option<&Path>) -> Result<Written, Diagnostic> {
    let scenario = ScenarioId::new(&bundle.manifest.scenario)
        .map_err(|bad| Diagnostic::input(bad.to_string(), "the manifest was changed by hand or is damaged"))?;
    let made =
        Made { proposal: bundle.proposal.clone(), paths: bundle.paths.clone(), behaviors: bundle.behaviors.clone() };
    let mut scribe = Scribe::new(path, Some(&bundle.location));
    let scene = (&bundle.request, &bundle.location);
    // A driver outside need not be there again: what it told the robot, or a person, is in the bundle.
    let is_driven = run.planner.external().is_some() || !bundle.request.people.is_empty();
    let mut outside: Box<dyn Outside> = if is_driven {
        let known = bundle.manifest.runs.iter().any(|entry| entry.run() == *run);
        let commands = bundle::commands(&bundle.dir, run).map_err(|why| if known { why } else { not_driven(run) })?;
        Box::new(Again::new(commands))
    } else {
        Box::new(Nobody)
    };
    let played = in_process::simulate_into(scene, made, run.id(&scenario), run, outside.as_mut(), &mut scribe);
    played.map_err(|faults| {
        Diagnostic::faults("the scenario cannot be simulated", &faults, "`socrates explain CODE` says what to do")
    })?;
    scribe.finish()
}

/// Another run than those of the bundle cannot be played where a driver outside would have to answer.
fn not_driven(run: &Run) -> Diagnostic {
    Diagnostic::input(
        format!("a driver outside drives in {run}, and its commands are not in the bundle"),
        "`socrates run BUNDLE/request.toml --driver COMMAND` asks it; the runs of the bundle itself need no driver",
    )
}

/// Scores a bundle again, one file of tracks, or a bag of ROS 2.
pub fn score(talk: &Printer, options: &ScoreOptions) -> Result<(), Diagnostic> {
    let what = options.what.as_path();
    let location = options.location.as_deref().map(|name| load_location(name, Path::new("."))).transpose()?;
    let known = Known {
        location: location.map(|(location, _)| location),
        goal: options.goal,
        radius_m: options.radius,
        speed_mps: options.speed,
        groups: options.groups.clone(),
        robot: options.robot.clone(),
        people: options.people.clone(),
        run: RunChoice { planner: options.planner.clone(), seed: options.seed },
    };
    let Some(scored) = tracks::at(what, &known)? else {
        if options.tells() {
            return Err(Diagnostic::input(
                "a bundle knows its location, goal, radius and groups",
                "these flags are for tracks of your own: name a CSV or an MCAP file, or a bag of ROS 2; the page of a bundle is its report.html",
            ));
        }
        return score_bundle(talk, what);
    };
    let report = &scored.report;
    for metric in key_figures(report) {
        talk.line(format!("{:<20} {:<12} {}", metric.id, in_words(metric), metric.note).trim_end());
    }
    let page = options.out.as_deref().map(|out| write_tracks(out, what, &known, &scored)).transpose()?;
    match (&options.out, &page) {
        (Some(out), Some(page)) => {
            talk.line(&format!("table      {}", out.join(METRICS).display()));
            if scored.table.is_some() {
                talk.line(&format!("tracks     {}", out.join(TRACKS).display()));
            }
            talk.line(&format!("look       {}", page.display()));
        }
        _ => talk.line(&format!(
            "more       {} metrics; --out FOLDER writes them as a table, and a page that plays the tracks",
            report.metrics.len()
        )),
    }
    // What looks wrong comes last, where it is read.
    for told in &scored.told {
        talk.line(&format!("warning    {told}"));
    }
    talk.result(&json!({
        "verdict": null, "metrics": values(report), "key": KEY_FIGURES, "missing": missing(report), "told": scored.told,
        "recording_hash": scored.recording.hash(), "page": page.map(|page| page.display().to_string()),
    }));
    Ok(())
}

/// Name of the table of metrics.
const METRICS: &str = "metrics.csv";

/// Name of the table of tracks that a bag became, which `score` reads as well.
const TRACKS: &str = "tracks.csv";

/// The text of a table.
fn text(table: &Table) -> String {
    std::iter::once(&table.head).chain(&table.rows).map(|row| joined(&row.cells) + "\n").collect()
}

/// Writes the page of tracks and their metrics, and hands back where the page is.
fn write_tracks(out: &Path, what: &Path, known: &Known, scored: &Scored) -> Result<PathBuf, Diagnostic> {
    let row = |metric: &MetricValue| FigureRow {
        name: metric.id.clone(),
        value: in_words(metric),
        better: match metric.direction.signum() {
            1 => "more is better",
            -1 => "less is better",
            _ => "",
        },
        note: metric.note.clone(),
    };
    let title = what.file_name().map_or_else(|| what.display().to_string(), |name| name.to_string_lossy().into_owned());
    let page = TrackPage {
        title: &title,
        location: known.location.as_ref(),
        goal: scored.goal,
        recording: &scored.recording,
        report: &scored.report,
        key: &key_figures(&scored.report).map(row).collect::<Vec<_>>(),
        all: &scored.report.metrics.iter().map(row).collect::<Vec<_>>(),
        told: &scored.told,
    };
    files::write(&out.join(METRICS), bundle::metrics([&scored.report]).as_bytes())?;
    if let Some(table) = &scored.table {
        files::write(&out.join(TRACKS), text(table).as_bytes())?;
    }
    let file = out.join("report.html");
    files::write(&file, page.html().as_bytes())?;
    Ok(file)
}

fn score_bundle(talk: &Printer, dir: &Path) -> Result<(), Diagnostic> {
    let bundle = bundle::read(dir)?;
    let mut rows = Vec::new();
    let mut differ = 0;
    for (place, (entry, (recording, old))) in bundle.manifest.runs.iter().zip(&bundle.runs).enumerate() {
        let run = entry.run();
        // What the run is compared with, where it is another one.
        let beside = |other: Run| bundle.recording(&other).filter(|_| other != run);
        let (reference, twin) = (beside(Run::reference(run.seed)), beside(run.without_robot()));
        let evidence = Evidence {
            location: Some(&bundle.location),
            request: Some(&bundle.request),
            reading: Some(&bundle.reading),
            proposal: Some(&bundle.proposal),
            paths: Some(&bundle.paths),
            reference,
            // The leading run is judged before any other begins, so the report in the bundle knows no twin.
            twin: twin.filter(|_| place > 0),
            ..Evidence::of(recording)
        };
        let report = socrates_scoring::score(&evidence);
        // Reports from before there were signatures have none.
        let signed = !old.thresholds.is_empty();
        let same = if signed { report == *old } else { Report { thresholds: String::new(), ..report.clone() } == *old };
        differ += usize::from(!same);
        talk.line(&format!(
            "scored     {} seed {}: {} ({})",
            entry.planner,
            entry.seed,
            report.verdict,
            if same { "same report as the bundle" } else { "ANOTHER report than the bundle" }
        ));
        // Now there is one, and what the robot costs people can be told of this run as of the others.
        let late = twin.filter(|_| place == 0).map(|_| socrates_scoring::score(&Evidence { twin, ..evidence }));
        let report = late.unwrap_or(report);
        rows.push(json!({
            "planner": entry.planner, "seed": entry.seed, "verdict": report.verdict, "same": same, "metrics": values(&report),
            "missing": missing(&report),
        }));
    }
    talk.result(&json!({ "bundle": dir.display().to_string(), "verdict": bundle.manifest.verdict, "runs": rows }));
    if differ > 0 {
        return Err(differs(&bundle, &format!("{differ} reports differ from the bundle's")));
    }
    Ok(())
}

/// Results that are not the bundle's: the fault of whoever changed a file, else of the program.
fn differs(bundle: &Bundle, what: &str) -> Diagnostic {
    let changed = bundle::changed(bundle);
    if changed.is_empty() {
        let hint = "no file of the bundle was changed: another version of the program made it, or this one has a fault";
        return Diagnostic::input(what, hint).with_code(Code::Ours);
    }
    let mut diagnostic = Diagnostic::input(
        format!("{what}: files were changed after it was made"),
        "`socrates run BUNDLE/request.toml` makes a bundle of what they say now",
    );
    diagnostic.causes = changed.iter().map(|name| bundle.dir.join(name).display().to_string()).collect();
    diagnostic
}

/// Why metrics have no value, by id.
fn missing(report: &Report) -> serde_json::Value {
    let without = report.metrics.iter().filter(|metric| metric.value.is_none());
    serde_json::Value::Object(without.map(|metric| (metric.id.clone(), json!(metric.note))).collect())
}

/// Metric values by id.
pub(crate) fn values(report: &socrates_model::Report) -> serde_json::Value {
    serde_json::Value::Object(report.metrics.iter().map(|metric| (metric.id.clone(), json!(metric.value))).collect())
}
