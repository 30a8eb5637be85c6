//! What a finished scenario's artifacts hold, before anything of it is written.

use std::collections::BTreeSet;

use socrates_model::job::{Artifact, Item, Stage};
use socrates_model::wire::{JobStatus, ScenarioStatus};
use socrates_model::{Behaviors, JobState, Paths, Proposal, Reading, Recording, Report, Role, Run};

use super::{FailedRun, Fetch, Past, missing, ours};
use crate::exit::Diagnostic;
use crate::prepare::Prepared;

/// A run with what was found of it.
pub(super) type Judged = (Recording, Report);
/// A run as it was made.
pub(super) struct MadeRun {
    pub(super) run: Run,
    /// Its recording as it is stored.
    pub(super) recording: Vec<u8>,
    /// The commands of a driver outside as they are stored, where one drove.
    pub(super) commands: Option<Vec<u8>>,
    pub(super) judged: Judged,
}

/// What was made.
pub(super) struct Made {
    pub(super) reading: Reading,
    pub(super) proposal: Proposal,
    pub(super) paths: Paths,
    pub(super) behaviors: Behaviors,
    /// Runs, the reference first.
    pub(super) runs: Vec<MadeRun>,
    /// Runs that have no result, and why.
    pub(super) failed: Vec<FailedRun>,
}

/// Reads every artifact that the bundle is made of.
pub(super) fn made(prepared: &Prepared, past: &Past<'_>) -> Result<Made, Diagnostic> {
    let Past { status, fetch, .. } = *past;
    let lead = scoring_jobs(status).into_iter().next();
    // What the leading run was judged with: a person may have changed what the stage made, or what was pinned.
    let judged = lead.and_then(|lead| past.jobs.iter().find(|job| job.key == lead.key));
    let text = |role: Role, stage: Stage| -> Result<String, Diagnostic> {
        if let Some(digest) = judged.and_then(|job| job.inputs.get(&role)) {
            return utf8(role, fetch(digest)?);
        }
        if let Some(pinned) = prepared.pins.get(&role) {
            return Ok(pinned.clone());
        }
        let artifact = newest(status, stage, &Item::Whole).and_then(|job| output(job, role));
        string(artifact.ok_or_else(|| missing(role))?, fetch)
    };
    let reading = match judged.and_then(|job| job.inputs.get(&Role::Reading)) {
        Some(digest) => parse(Role::Reading, &utf8(Role::Reading, fetch(digest)?)?)?,
        None => prepared.reading.clone(),
    };
    Ok(Made {
        reading,
        proposal: parse(Role::Proposal, &text(Role::Proposal, Stage::Proposal)?)?,
        paths: parse(Role::Paths, &text(Role::Paths, Stage::Paths)?)?,
        behaviors: parse(Role::Behaviors, &text(Role::Behaviors, Stage::Behaviors)?)?,
        runs: runs(status, fetch)?,
        failed: failed(status),
    })
}

/// Every run that was wanted and has no result, with the faults of its last attempt.
fn failed(status: &ScenarioStatus) -> Vec<FailedRun> {
    let jobs = || status.jobs.iter().filter(|job| matches!(job.key.stage, Stage::Simulation | Stage::Scoring));
    let items: BTreeSet<&Item> = jobs().map(|job| &job.key.item).collect();
    let unjudged = items.into_iter().filter(|item| newest(status, Stage::Scoring, item).is_none());
    let told = |item: &Item| {
        let run = item.run()?.clone();
        let last =
            jobs().filter(|job| job.key.item == *item && !job.faults.is_empty()).max_by_key(|job| job.key.revision)?;
        Some(FailedRun { run, faults: last.faults.clone() })
    };
    unjudged.filter_map(told).collect()
}

/// Every run that was judged.
fn runs(status: &ScenarioStatus, fetch: &Fetch<'_>) -> Result<Vec<MadeRun>, Diagnostic> {
    let mut runs = Vec::new();
    for job in scoring_jobs(status) {
        let simulation = newest(status, Stage::Simulation, &job.key.item);
        let (Some(run), Some(judged), Some(simulation)) = (job.key.item.run(), output(job, Role::Report), simulation)
        else {
            continue;
        };
        let report: Report = parse(Role::Report, &string(judged, fetch)?)?;
        let recorded = output(simulation, Role::Recording).ok_or_else(|| missing(Role::Recording))?;
        let bytes = fetch(&recorded.digest)?;
        let recording =
            socrates_stream::mcap::read(&bytes).map_err(|why| ours(&format!("the recording cannot be read: {why}")))?;
        let commands = output(simulation, Role::Commands).map(|artifact| string(artifact, fetch)).transpose()?;
        let commands = commands.map(String::into_bytes);
        runs.push(MadeRun { run: run.clone(), recording: bytes, commands, judged: (recording, report) });
    }
    Ok(runs)
}

fn parse<T: serde::de::DeserializeOwned>(role: Role, text: &str) -> Result<T, Diagnostic> {
    serde_json::from_str(text).map_err(|why| ours(&format!("the {role} cannot be decoded: {why}")))
}

/// An artifact as text.
pub(super) fn string(artifact: &Artifact, fetch: &Fetch<'_>) -> Result<String, Diagnostic> {
    if let Some(text) = &artifact.inline {
        return Ok(text.clone());
    }
    utf8(artifact.role, fetch(&artifact.digest)?)
}

fn utf8(role: Role, bytes: Vec<u8>) -> Result<String, Diagnostic> {
    String::from_utf8(bytes).map_err(|why| ours(&format!("the {role} is no text: {why}")))
}

/// The output of a job in this role.
fn output(job: &JobStatus, role: Role) -> Option<&Artifact> {
    job.artifacts.iter().find(|artifact| artifact.role == role)
}

/// The newest job of a stage and item that has a result.
fn newest<'a>(status: &'a ScenarioStatus, stage: Stage, item: &Item) -> Option<&'a JobStatus> {
    status
        .jobs
        .iter()
        .filter(|job| job.key.stage == stage && job.key.item == *item && job.state == JobState::Succeeded)
        .max_by_key(|job| job.key.revision)
}

/// Newest scoring jobs, the reference first, then by planner and seed.
fn scoring_jobs(status: &ScenarioStatus) -> Vec<&JobStatus> {
    let items: BTreeSet<&Item> =
        status.jobs.iter().filter(|job| job.key.stage == Stage::Scoring).map(|job| &job.key.item).collect();
    items.into_iter().filter_map(|item| newest(status, Stage::Scoring, item)).collect()
}
