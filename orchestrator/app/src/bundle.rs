//! The bundle: one folder that holds a scenario whole, and reads as a page.
//!
//! ```text
//! request, artifacts, runs ─► files of `layout` ─► beside the folder ─► one rename ─► a bundle ─► read
//! ```

mod beside;
mod collect;
pub(crate) mod dead;
mod files;
mod page;
mod read;
mod whole;

pub(crate) use files::{PACKED, archive, unpack_beside};
pub(crate) use page::page;
pub use read::{changed, read};
pub(crate) use read::{commands, file, is_bundle, manifest, read_some, read_with_reports, reports};
pub(crate) use whole::{copy, copy_dead, damaged, moved, whole};

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::json;
use socrates_draw::StageRow;
use socrates_model::job::{Artifact, Item};
use socrates_model::wire::ScenarioStatus;
use socrates_model::{
    Behaviors, Digest, Fault, Location, Paths, PlannerName, Proposal, Reading, Recording, Report, Request, Role, Run,
    Verdict,
};
use socrates_stream::csv::joined;

use self::beside::Beside;
use self::collect::{Judged, Made, MadeRun, string};
use crate::exit::Diagnostic;
use crate::history::PastJob;
use crate::keep::{Form, Keep};
use crate::layout::{self, Sheet};
use crate::prepare::Prepared;

/// One run in the manifest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunEntry {
    /// Planner.
    pub(crate) planner: PlannerName,
    /// Simulation seed.
    pub(crate) seed: u64,
    /// Verdict.
    pub(crate) verdict: Verdict,
    /// Hash over decoded frames and events.
    pub(crate) recording_hash: Digest,
    /// Digest of the report file.
    pub(crate) report: Digest,
}

impl RunEntry {
    /// The run.
    #[must_use]
    pub fn run(&self) -> Run {
        Run { planner: self.planner.clone(), seed: self.seed }
    }
}

/// What a bundle is made of; the last file written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    /// Format number.
    pub(crate) format: u32,
    /// Scenario id.
    pub(crate) scenario: String,
    /// Name of the request it was made from; empty in bundles from before it was kept.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub(crate) request: String,
    /// Base seed.
    pub(crate) seed: u64,
    /// Digest of the request and everything it names: the same wish has the same one.
    pub(crate) wish: Digest,
    /// Verdict of the reference run of the first seed.
    pub(crate) verdict: Verdict,
    /// Runs, the reference first.
    pub runs: Vec<RunEntry>,
    /// Runs that were wanted and have no result.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) failed: Vec<FailedRun>,
    /// Digest of every file of the bundle but this one and the provenance.
    pub files: BTreeMap<String, Digest>,
}

impl Manifest {
    /// Name of the request, or of the scenario where that was not kept.
    pub(crate) fn request_name(&self) -> &str {
        if self.request.is_empty() { &self.scenario } else { &self.request }
    }
}

/// A run without a result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct FailedRun {
    /// Which.
    pub(crate) run: Run,
    /// Why: the faults of its last attempt.
    pub(crate) faults: Vec<Fault>,
}

impl FailedRun {
    /// Why, in a line.
    pub(crate) fn told(&self) -> String {
        self.faults.iter().map(ToString::to_string).collect::<Vec<_>>().join(" · ")
    }
}

/// A finished bundle.
#[derive(Debug, Clone)]
pub struct Bundle {
    /// Folder.
    pub(crate) dir: PathBuf,
    /// Manifest.
    pub manifest: Manifest,
    /// The request.
    pub request: Request,
    /// The location.
    pub location: Location,
    /// The reading.
    pub reading: Reading,
    /// The proposal.
    pub proposal: Proposal,
    /// The paths.
    pub paths: Paths,
    /// The trees.
    pub behaviors: Behaviors,
    /// Runs, the reference first.
    pub runs: Vec<(Recording, Report)>,
}

impl Bundle {
    /// The recording of a run and its report, if the bundle has it.
    pub(crate) fn run(&self, run: &Run) -> Option<(&Recording, &Report)> {
        let mut runs = self.manifest.runs.iter().zip(&self.runs);
        runs.find(|(entry, _)| entry.run() == *run).map(|(_, (recording, report))| (recording, report))
    }

    /// The recording of a run, if the bundle has it.
    pub(crate) fn recording(&self, run: &Run) -> Option<&Recording> {
        self.run(run).map(|(recording, _)| recording)
    }
}

/// The digest of a wish: request, location, reading, pins, seed, author.
pub(crate) fn wish(prepared: &Prepared, seed: u64) -> Digest {
    let mut text = json!({
        "request": prepared.request, "location": prepared.location, "pins": prepared.pins, "seed": seed,
        "author": prepared.author.to_string(), "injected": prepared.injected, "version": env!("CARGO_PKG_VERSION"),
    });
    if let Some(members) = text.as_object_mut().filter(|_| !prepared.style.is_empty()) {
        members.insert("style".to_owned(), json!(prepared.style));
    }
    if let Some(members) = text.as_object_mut().filter(|_| prepared.looked_at) {
        members.insert("looked_at".to_owned(), json!(true));
    }
    Digest::of(text.to_string().as_bytes())
}

/// Whether the bundle of this wish lies in a folder, or packed beside where the folder would be.
pub(crate) fn lies_in(dir: &Path, prepared: &Prepared, seed: u64) -> bool {
    manifest(dir).is_some_and(|manifest| manifest.wish == wish(prepared, seed))
}

/// Where artifacts are read from.
pub(crate) type Fetch<'a> = dyn Fn(&Digest) -> Result<Vec<u8>, Diagnostic> + 'a;

/// A finished scenario: what its bundle is written from.
pub(crate) struct Past<'a> {
    /// How it stands.
    pub(crate) status: &'a ScenarioStatus,
    /// Every revision and attempt.
    pub(crate) jobs: &'a [PastJob],
    /// Where artifacts are read from.
    pub(crate) fetch: &'a Fetch<'a>,
    /// Work folder on the same file system: files are written there, then moved to where they belong.
    pub(crate) work: &'a Path,
    /// Whether it is the only one: then its picture is painted by a thread of its own. Of many, each has a thread anyway.
    pub(crate) alone: bool,
    /// What is kept of it.
    pub(crate) keep: Keep,
}

/// Writes the bundle of a finished scenario in the form in which it is kept. It is there whole or, whatever happens on the way, not
/// finished.
pub(crate) fn write(dir: &Path, prepared: &Prepared, seed: u64, past: &Past<'_>) -> Result<Bundle, Diagnostic> {
    let beside = Beside::new(past.work, past.status.id.as_str())?;
    let bundle = written(&beside.0, dir, prepared, seed, past)?;
    match past.keep.form(bundle.manifest.verdict) {
        Form::Folder => beside.appear(dir)?,
        Form::Packed => beside.appear_packed(dir)?,
        Form::Nothing => {}
    }
    Ok(bundle)
}

/// What a request asks for, as it stands over the picture.
fn asked(request: &Request) -> String {
    let task = format!("Task: {}", request.task.trim());
    match &request.rough_scenario {
        Some(scenario) => format!("{task} · Scenario: {}", scenario.trim()),
        None => task,
    }
}

/// Writes the files of a bundle that will lie in `dir` into the folder `beside`.
fn written(beside: &Path, dir: &Path, prepared: &Prepared, seed: u64, past: &Past<'_>) -> Result<Bundle, Diagnostic> {
    let Made { reading, proposal, paths, behaviors, runs, failed } = collect::made(prepared, past)?;
    let Some((recording, report)) = runs.first().map(|run| &run.judged) else { return Err(missing(Role::Report)) };
    let verdict = report.verdict;
    let mut out = Writer { dir: beside.to_path_buf(), files: BTreeMap::new() };
    let title = format!("{} · {}", proposal.title, prepared.location.name);
    let heading = socrates_draw::Heading { title: &title, asked: &asked(&prepared.request) };
    let svg = socrates_draw::run_picture(&prepared.location, recording, Some(&paths), Some(report), heading);
    out.put(&layout::DRAWING, &"", svg.as_bytes())?;
    let paint = move || socrates_draw::png_from_svg(&svg, 1.5).map_err(|why| ours(&why.to_string()));
    // Painting takes as long as everything else of a bundle, so it goes on beside it where a core is free.
    let (painting, painted) = if past.alone { (Some(std::thread::spawn(paint)), None) } else { (None, Some(paint())) };
    out.put(&layout::STORY, &"", story(&title, &proposal, report).as_bytes())?;
    out.put(&layout::METRICS, &"", metrics(runs.iter().map(|run| &run.judged.1)).as_bytes())?;
    let recordings: Vec<&Recording> = runs.iter().map(|run| &run.judged.0).collect();
    out.put(&layout::AGENTS, &"", socrates_stream::csv::write_agents(&recordings).as_bytes())?;
    put_request(&mut out, prepared)?;
    out.put(&layout::READING, &"", pretty(&reading)?.as_bytes())?;
    out.put(&layout::PROPOSAL, &"", pretty(&proposal)?.as_bytes())?;
    out.put(&layout::PATHS, &"", pretty(&paths)?.as_bytes())?;
    out.put(&layout::BEHAVIORS, &"", pretty(&behaviors)?.as_bytes())?;
    for (id, human) in &behaviors.humans {
        out.put(&layout::TREES, id, human.tree.as_bytes())?;
    }
    let (runs, entries) = put_runs(&mut out, runs)?;
    let broke = || Err(ours(&format!("the thread that painted `{}` broke", layout::PICTURE.path)));
    let painted = painted.or_else(|| painting?.join().ok()).unwrap_or_else(broke)?;
    out.put(&layout::PICTURE, &"", &painted)?;
    let provenance = provenance(prepared, seed, past);
    out.put(&layout::PROVENANCE, &"", pretty(&provenance)?.as_bytes())?;
    let manifest = Manifest {
        format: socrates_model::FORMAT,
        scenario: past.status.id.to_string(),
        request: prepared.name.clone(),
        seed,
        wish: wish(prepared, seed),
        verdict,
        runs: entries,
        failed,
        files: out.files.clone(),
    };
    let (request, location) = (prepared.request.clone(), prepared.location.clone());
    let dir = dir.to_path_buf();
    let bundle = Bundle { dir, manifest, request, location, reading, proposal, paths, behaviors, runs };
    // The page shows working times, so it stands outside the bundle's digest, like the provenance.
    let page = page(&bundle, &stage_rows(past.jobs), &prepared.author.to_string());
    out.put(&layout::PAGE, &"", page.as_bytes())?;
    out.put(&layout::MANIFEST, &"", pretty(&bundle.manifest)?.as_bytes())?;
    Ok(bundle)
}

/// Writes the request and its location, which make the scenario again.
fn put_request(out: &mut Writer, prepared: &Prepared) -> Result<(), Diagnostic> {
    let request = toml::to_string_pretty(&portable(prepared)).map_err(|why| ours(&why.to_string()))?;
    out.put(&layout::REQUEST, &"", request.as_bytes())?;
    for (name, bytes) in &prepared.location_files {
        out.put(&layout::LOCATION_FILES, name, bytes)?;
    }
    out.put(&layout::LOCATION, &"", pretty(&prepared.location)?.as_bytes())?;
    Ok(())
}

/// Writes every recording and report, and hands them back with their entries in the manifest.
fn put_runs(out: &mut Writer, made: Vec<MadeRun>) -> Result<(Vec<Judged>, Vec<RunEntry>), Diagnostic> {
    let (mut runs, mut entries) = (Vec::new(), Vec::new());
    for MadeRun { run, recording: bytes, commands, judged: (recording, report) } in made {
        out.put(&layout::RECORDINGS, &run, &bytes)?;
        if let Some(commands) = commands {
            out.put(&layout::COMMANDS, &run, &commands)?;
        }
        entries.push(RunEntry {
            verdict: report.verdict,
            recording_hash: recording.hash(),
            report: out.put(&layout::REPORTS, &run, pretty(&report)?.as_bytes())?,
            planner: run.planner,
            seed: run.seed,
        });
        runs.push((recording, report));
    }
    Ok((runs, entries))
}

struct Writer {
    dir: PathBuf,
    files: BTreeMap<String, Digest>,
}

impl Writer {
    /// Writes the file of this name, or the only one of its kind.
    fn put(&mut self, sheet: &Sheet, name: &dyn std::fmt::Display, bytes: &[u8]) -> Result<Digest, Diagnostic> {
        let file = sheet.of(name);
        let path = self.dir.join(&file);
        let cannot = |why: std::io::Error| {
            Diagnostic::input(format!("cannot write `{}`: {why}", path.display()), "--out chooses another folder")
        };
        if let Some(parent) = path.parent() {
            std::fs::create_dir_all(parent).map_err(cannot)?;
        }
        std::fs::write(&path, bytes).map_err(cannot)?;
        let digest = Digest::of(bytes);
        if sheet.counted {
            self.files.insert(file, digest);
        }
        Ok(digest)
    }
}

fn ours(what: &str) -> Diagnostic {
    let hint = format!("this is our fault; `{}` holds what is needed to find it", layout::PROVENANCE.path);
    Diagnostic::input(what, hint).with_code(crate::exit::Code::Ours)
}

fn missing(role: Role) -> Diagnostic {
    ours(&format!("the scenario ended without a {role}"))
}

fn pretty<T: Serialize>(value: &T) -> Result<String, Diagnostic> {
    serde_json::to_string_pretty(value).map(|text| text + "\n").map_err(|why| ours(&why.to_string()))
}

/// The request as the bundle keeps it: its location lies beside it, so it can be moved.
fn portable(prepared: &Prepared) -> Request {
    // What a person looked at was perhaps changed by hand: the same again is what they left, not what an author writes.
    let keep = |slot: &mut Option<String>, sheet: &Sheet| {
        if slot.is_some() || prepared.looked_at {
            *slot = Some(sheet.path.to_owned());
        }
    };
    let mut request = prepared.request.clone();
    if socrates_maps::shipped::files(&request.location).is_none() {
        request.location = layout::LOCATION_FILES.folder().to_owned();
    }
    keep(&mut request.proposal, &layout::PROPOSAL);
    keep(&mut request.paths, &layout::PATHS);
    keep(&mut request.behaviors, &layout::BEHAVIORS);
    request
}

fn story(title: &str, proposal: &Proposal, report: &Report) -> String {
    let mut text = format!("{title}\nauthor {}\n\n{}\n\n", proposal.author, proposal.description);
    for line in &report.story {
        text.push_str(line);
        text.push('\n');
    }
    text.push_str(&format!("\n{}: {}\nrobot: {}\n", report.verdict, report.verdict_text, report.robot_text));
    text
}

/// Columns of `metrics.csv`: one row per run and metric.
pub(crate) const METRIC_COLUMNS: [&str; 9] =
    ["planner", "seed", "metric", "value", "unit", "direction", "note", "version", "thresholds"];

/// Every metric of these runs as a table.
pub(crate) fn metrics<'a>(reports: impl IntoIterator<Item = &'a Report>) -> String {
    let mut text = joined(METRIC_COLUMNS) + "\n";
    for report in reports {
        for metric in &report.metrics {
            let value = metric.value.map_or_else(|| "n/a".to_owned(), |value| value.to_string());
            let (seed, direction) = (report.seed.to_string(), metric.direction.to_string());
            let cells = joined([report.planner.as_str(), &seed, &metric.id, &value, metric.unit.as_str(), &direction]);
            // The note stands in quotes in every row.
            let note = metric.note.replace('"', "'");
            let last = joined([&metric.version.to_string(), &report.thresholds]);
            text.push_str(&format!("{cells},\"{note}\",{last}\n"));
        }
    }
    text
}

/// Stage lines of what was tried, in pipeline order.
pub(crate) fn stage_rows(past: &[PastJob]) -> Vec<StageRow> {
    let row = |job: &PastJob| {
        let item = if job.key.item == Item::Whole { String::new() } else { job.key.item.to_string() };
        let faults: Vec<String> =
            job.attempts.iter().flat_map(|attempt| &attempt.faults).map(ToString::to_string).collect();
        let remark = [job.remark.clone(), faults.join("; ")];
        StageRow {
            stage: Some(job.key.stage),
            item,
            revision: u64::from(job.key.revision),
            state: Some(job.state),
            attempts: u32::try_from(job.attempts.len()).unwrap_or(u32::MAX),
            wall_ms: job.attempts.iter().map(|attempt| attempt.wall_ms).sum(),
            remark: remark.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(" · "),
        }
    };
    past.iter().map(row).collect()
}

/// An exchange without what was asked and answered.
fn without_words(mut exchange: serde_json::Value) -> serde_json::Value {
    if let Some(members) = exchange.as_object_mut() {
        for words in ["messages", "answer"] {
            members.remove(words);
        }
    }
    exchange
}

/// Versions, seeds, every question, answer, fault and attempt, superseded revisions included.
fn provenance(prepared: &Prepared, seed: u64, past: &Past<'_>) -> serde_json::Value {
    let Past { status, jobs: past, fetch, .. } = *past;
    // What passed between the stage and its author, as text or as the object it is.
    let exchanges = |artifacts: &[Artifact]| -> Vec<serde_json::Value> {
        artifacts
            .iter()
            .filter(|artifact| {
                artifact.role == Role::Exchange || artifact.role == Role::Refused && prepared.keep_answers
            })
            .filter_map(|artifact| string(artifact, fetch).ok())
            .map(|text| serde_json::from_str(&text).unwrap_or(serde_json::Value::String(text)))
            .map(|exchange| if prepared.keep_answers { exchange } else { without_words(exchange) })
            .collect()
    };
    // What a person typed who looked at it.
    let said = |artifacts: &[Artifact]| -> Option<serde_json::Value> {
        let typed = artifacts.iter().find(|artifact| artifact.role == Role::Said)?;
        serde_json::from_str(&string(typed, fetch).ok()?).ok()
    };
    let names = |artifacts: &[Artifact]| -> Vec<serde_json::Value> {
        artifacts.iter().map(|a| json!({"role": a.role, "digest": a.digest, "bytes": a.len})).collect()
    };
    let jobs: Vec<serde_json::Value> = past
        .iter()
        .map(|job| {
            let attempts: Vec<serde_json::Value> = job
                .attempts
                .iter()
                .map(|attempt| {
                    json!({ "attempt": attempt.number, "end": attempt.end, "class": attempt.class, "faults": attempt.faults,
                            "wall_ms": attempt.wall_ms, "span_ms": attempt.span_ms, "tokens": attempt.tokens, "remark": attempt.remark,
                            "artifacts": names(&attempt.artifacts), "exchanges": exchanges(&attempt.artifacts) })
                })
                .collect();
            json!({ "job": job.key, "state": job.state, "seed": job.seed, "inputs": job.inputs, "sent_back": job.sent_back,
                    "attempts": attempts, "artifacts": names(&job.artifacts), "exchanges": exchanges(&job.artifacts),
                    "said": said(&job.artifacts) })
        })
        .collect();
    json!({ "version": env!("CARGO_PKG_VERSION"), "program": prepared.build, "author": prepared.author.to_string(), "seed": seed, "result": status.result, "jobs": jobs })
}
