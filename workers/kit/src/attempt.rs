//! One attempt from grant to recorded report.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use socrates_link::LinkError;
use socrates_model::job::{Artifact, INLINE_BYTES, JobKey};
use socrates_model::wire::{Grant, Outcome, Report};
use socrates_model::{Digest, FailureClass, Fault, FaultCode, Role, TraceContext, Where};
use tokio::task::{JoinError, JoinSet};
use tokio::time::Instant;
use tracing::Instrument as _;

use crate::blobs::{BlobError, Blobs};
use crate::cancel::Cancel;
use crate::error::KitError;
use crate::held::slot_of;
use crate::job::Job;
use crate::messages::{Backoff, Worker};
use crate::stage::{Done, Failure, Output, Stage};

/// Inline text of one report, bytes: what is above goes to the artifact store, so that a report fits a message.
const INLINE_BUDGET: usize = 32 * 1024;
/// Faults of one report that keep their full words when it would not fit otherwise.
const FAULTS_KEPT: usize = 20;
/// Longest message of a fault when its report would not fit otherwise, characters.
const FAULT_CHARS: usize = 400;

/// Why an attempt has no report.
enum End {
    /// The stage is through.
    Worked(Result<Done, Failure>),
    /// It was told to stop.
    Stopped,
}

/// Runs an attempt that [`crate::held::Held::take`] took. Whatever is logged meanwhile says of which attempt it is.
pub(crate) async fn attempt<S: Stage>(worker: Arc<Worker>, stage: Arc<S>, grant: Grant) -> Result<(), KitError> {
    let span = span(&worker, &grant);
    carried_out(worker, stage, grant).instrument(span).await
}

/// The span of an attempt, with all that tells its lines from those of others.
fn span(worker: &Worker, grant: &Grant) -> tracing::Span {
    let key = &grant.spec.key;
    tracing::info_span!(
        "attempt",
        job = %key,
        scenario = %key.scenario,
        stage = key.stage.name(),
        attempt = grant.attempt,
        fence = grant.fence,
        worker = worker.config.instance,
        trace_id = grant.traceparent.map(|trace| trace.trace_id()),
        span_id = grant.traceparent.map(|trace| trace.span_id()),
    )
}

async fn carried_out<S: Stage>(worker: Arc<Worker>, stage: Arc<S>, grant: Grant) -> Result<(), KitError> {
    let slot = slot_of(&grant);
    let Some(entry) = worker.held.entry(&slot) else { return Ok(()) };
    let begun = Instant::now();
    tracing::info!("the attempt begins");
    let end = tokio::select! {
        () = entry.cancel.stopped() => End::Stopped,
        worked = work(&worker, stage, &grant, &entry.cancel, &entry.characters) => worked,
    };
    let worked = match end {
        End::Worked(worked) => worked,
        End::Stopped => {
            tracing::info!("the attempt was stopped and is handed back");
            worker.held.worked(&slot);
            worker.release(&slot).await;
            worker.held.end(&slot);
            return Ok(());
        }
    };
    // To the nearest: always down would count work as overhead.
    let wall_ms = u64::try_from((begun.elapsed().as_micros() + 500) / 1000).unwrap_or(u64::MAX);
    let number = worker.next_report();
    if let Some(delay) = worker.config.faults.delay {
        tokio::time::sleep(delay).await;
    }
    if worker.config.faults.die_before_report == Some(number) {
        return Err(KitError::InjectedDeath { at: "before a report" });
    }
    let report = report(&worker, &grant, worked, wall_ms).await?;
    tell(&report);
    let report = keep(&worker, report).await?;
    worker.held.worked(&slot);
    worker.send_report(&report, number, grant.traceparent).await?;
    worker.held.end(&slot);
    Ok(())
}

/// One line with all that is known of a finished attempt. What an author was asked and answered is not in it.
fn tell(report: &Report) {
    let (tokens_in, tokens_out) = report.tokens;
    let (wall_ms, artifacts, remark) = (report.wall_ms, report.artifacts.len(), report.remark.as_str());
    match &report.outcome {
        Outcome::Ok => {
            tracing::info!(outcome = "ok", wall_ms, tokens_in, tokens_out, artifacts, remark, "the attempt ended");
        }
        Outcome::Failed { class, faults, .. } => {
            let faults: Vec<&str> = faults.iter().map(|fault| fault.code.code()).collect();
            let faults = faults.join(" ");
            tracing::info!(
                outcome = "failed",
                ?class,
                faults,
                wall_ms,
                tokens_in,
                tokens_out,
                artifacts,
                "the attempt ended"
            );
        }
    }
}

/// Fetches the inputs and runs the stage within its deadline, on a task of its own so that a panic stays there.
async fn work<S: Stage>(
    worker: &Arc<Worker>,
    stage: Arc<S>,
    grant: &Grant,
    cancel: &Cancel,
    characters: &Arc<std::sync::atomic::AtomicU64>,
) -> End {
    let inputs = match inputs(worker, grant).await {
        Ok(inputs) => inputs,
        Err(failure) => return End::Worked(Err(failure)),
    };
    let (inputs, refused) = inputs;
    let job = Job {
        grant: grant.clone(),
        inputs,
        refused,
        cancel: cancel.clone(),
        characters: Arc::clone(characters),
        live: worker.config.live.as_ref().map_or_else(|| Arc::clone(&worker.bus), Arc::clone),
    };
    // A set of one: dropping it stops the task.
    let mut task = JoinSet::new();
    task.spawn(async move { stage.run(&job).await }.in_current_span());
    let deadline = Duration::from_millis(grant.deadline_ms);
    match tokio::time::timeout(deadline, task.join_next()).await {
        Ok(Some(Ok(result))) => End::Worked(result),
        Ok(Some(Err(why))) => End::Worked(Err(broke(grant, why))),
        Ok(None) => End::Stopped,
        Err(_elapsed) => {
            cancel.stop();
            let message = format!("the attempt took longer than its {} ms", grant.deadline_ms);
            End::Worked(Err(Fault::new(FaultCode::JDeadline, &grant.spec.key, message).into()))
        }
    }
}

fn broke(grant: &Grant, why: JoinError) -> Failure {
    let words = match why.try_into_panic() {
        Ok(panic) => panic
            .downcast_ref::<&str>()
            .map(|text| (*text).to_owned())
            .or_else(|| panic.downcast_ref::<String>().cloned())
            .unwrap_or_else(|| "without words".to_owned()),
        Err(why) => why.to_string(),
    };
    let message = format!("the worker broke on this job: {}", words.chars().take(FAULT_CHARS).collect::<String>());
    Failure::new(FailureClass::Poison, vec![Fault::new(FaultCode::JPanic, &grant.spec.key, message)])
}

type Inputs = (BTreeMap<Role, Vec<u8>>, Option<String>);

async fn inputs(worker: &Arc<Worker>, grant: &Grant) -> Result<Inputs, Failure> {
    let mut fetched = BTreeMap::new();
    // All at once: each is a question of its own where artifacts come over the bus.
    let mut asked = JoinSet::new();
    let inputs = grant.spec.inputs.iter().map(|(role, digest)| (*role, *digest));
    for (role, digest) in inputs.chain(grant.spec.refused.map(|digest| (Role::Refused, digest))) {
        let inline = grant.inline.get(&digest).filter(|text| Digest::of(text.as_bytes()) == digest);
        if let Some(bytes) = inline.map(|text| text.clone().into_bytes()).or_else(|| worker.inputs.get(&digest)) {
            fetched.insert(role, bytes);
            continue;
        }
        let (worker, key, trace) = (Arc::clone(worker), grant.spec.key.clone(), grant.traceparent);
        let fetching = async move { input(&worker, (&key, trace), role, digest).await.map(|bytes| (role, bytes)) };
        asked.spawn(fetching.in_current_span());
    }
    while let Some(came) = asked.join_next().await {
        let (role, bytes) = came.map_err(|why| broke(grant, why))??;
        fetched.insert(role, bytes);
    }
    let refused = fetched.remove(&Role::Refused).map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
    Ok((fetched, refused))
}

async fn input(
    worker: &Worker,
    (key, trace): (&JobKey, Option<TraceContext>),
    role: Role,
    digest: Digest,
) -> Result<Vec<u8>, Failure> {
    let (blobs, limit) = (&worker.config.blobs, worker.config.timeout);
    let bytes = blobs.get_in(trace, &worker.bus, digest, limit).await.map_err(|why| {
        let message = format!("input `{role}` could not be fetched: {}", chain(&why));
        Failure::from(Fault::new(FaultCode::JBlob, key, message))
    })?;
    if matches!(worker.config.blobs, Blobs::Bus) {
        worker.inputs.keep(digest, &bytes);
    }
    Ok(bytes)
}

/// An error with its causes in one line.
#[must_use]
pub fn chain(error: &dyn std::error::Error) -> String {
    let mut text = error.to_string();
    let mut source = error.source();
    while let Some(cause) = source {
        text.push_str(": ");
        text.push_str(&cause.to_string());
        source = cause.source();
    }
    text
}

/// Stores the outputs and makes the report. An output that cannot be stored makes it a passing failure, or ends the worker.
async fn report(
    worker: &Worker,
    grant: &Grant,
    worked: Result<Done, Failure>,
    wall_ms: u64,
) -> Result<Report, KitError> {
    let mut report = Report {
        instance: worker.config.instance.clone(),
        key: grant.spec.key.clone(),
        attempt: grant.attempt,
        fence: grant.fence,
        outcome: Outcome::Ok,
        artifacts: Vec::new(),
        wall_ms,
        tokens: (0, 0),
        remark: String::new(),
        repair: None,
        anew: Vec::new(),
        verdict: None,
        rates: None,
    };
    let outputs = match worked {
        Ok(done) => {
            (report.tokens, report.remark) = (done.tokens, done.remark);
            (report.repair, report.anew) = (done.repair, done.anew);
            (report.verdict, report.rates) = (done.verdict, done.rates);
            done.artifacts
        }
        Err(failure) => {
            let Failure { class, faults, artifacts, retry_after_ms, tokens, rates } = failure;
            (report.tokens, report.rates) = (tokens, rates.map(|rates| *rates));
            report.outcome = Outcome::Failed { class, faults, retry_after_ms };
            artifacts
        }
    };
    let mut budget = INLINE_BUDGET;
    for output in outputs {
        let role = output.role;
        match stored(worker, grant, output, &mut budget).await {
            Ok(artifact) => report.artifacts.push(artifact),
            Err(BlobError::File { path, why }) if !worker.config.waits_for_disk => {
                return Err(KitError::Folder { path, why: why.to_string() });
            }
            Err(why) => {
                let message = format!("output `{role}` could not be stored: {}", chain(&why));
                let fault = Fault::new(FaultCode::JBlob, Where::key(role), message);
                report.outcome =
                    Outcome::Failed { class: FailureClass::Transient, faults: vec![fault], retry_after_ms: None };
                (report.repair, report.verdict) = (None, None);
                break;
            }
        }
    }
    Ok(report)
}

async fn stored(worker: &Worker, grant: &Grant, output: Output, budget: &mut usize) -> Result<Artifact, BlobError> {
    let Output { role, media, bytes } = output;
    let (digest, len) = (Digest::of(&bytes), bytes.len());
    let small = len <= INLINE_BYTES.min(*budget);
    let inline = if small { std::str::from_utf8(&bytes).ok().map(str::to_owned) } else { None };
    if inline.is_some() {
        *budget -= len;
    } else {
        let (blobs, limit) = (&worker.config.blobs, worker.config.timeout);
        blobs.put_in(grant.traceparent, &worker.bus, bytes, limit).await?;
    }
    Ok(Artifact { role, digest, len: len as u64, media, inline })
}

/// Spools a report; one that does not fit a message gets shorter faults. A full disk is waited out, or ends the worker.
async fn keep(worker: &Worker, mut report: Report) -> Result<Report, KitError> {
    let mut backoff = Backoff::new(&worker.config.instance);
    let mut told = false;
    loop {
        let (spool, copy) = (worker.spool.clone(), report.clone());
        let kept = match tokio::task::spawn_blocking(move || spool.keep(&copy)).await {
            Ok(kept) => kept,
            Err(why) => Err(KitError::Folder { path: worker.config.spool_dir.clone(), why: why.to_string() }),
        };
        match kept {
            Ok(()) => return Ok(report),
            Err(KitError::Link(LinkError::TooLarge { len, .. })) => {
                tracing::warn!(job = %report.key, len, "the report is too large for a message and is shortened");
                shorten(&mut report);
            }
            Err(why) if !worker.config.waits_for_disk => return Err(why),
            Err(why) => {
                if !std::mem::replace(&mut told, true) {
                    tracing::error!(job = %report.key, %why, "the report cannot be spooled; tried until it can");
                }
                tokio::time::sleep(backoff.next()).await;
            }
        }
    }
}

/// Makes a report small enough for any message: first its faults, then its remark and repair.
fn shorten(report: &mut Report) {
    let cut = |faults: &mut Vec<Fault>| {
        faults.truncate(FAULTS_KEPT);
        for fault in faults {
            *fault = fault.clone().shortened(FAULT_CHARS, FAULT_CHARS / 2);
        }
    };
    if let Outcome::Failed { faults, .. } = &mut report.outcome {
        cut(faults);
    }
    if let Some(repair) = &mut report.repair {
        cut(&mut repair.faults);
    }
    report.remark = report.remark.chars().take(FAULT_CHARS).collect();
    report.artifacts.truncate(64);
}
