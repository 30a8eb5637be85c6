//! `top`: stages, workers and failures of an orchestrator, as texts for a table. Where they are drawn is not known here.

use std::sync::Arc;

use serde_json::{Value, json};
use socrates_link::Bus;
use socrates_model::JobState;
use socrates_model::wire::{BatchStatus, Failed, StageStatus, StatusAsk, StatusReply, Table, WorkerStatus};

use crate::config::Config;
use crate::exit::Diagnostic;
use crate::explain_job::{self, class_words};
use crate::progress::span;
use crate::standing::head;
use crate::steer::{self, Act, Whom};
use crate::supervise::endpoint;
use crate::{calls, process};

/// Letters of a worker's name that tell it from the others.
const SHORT: usize = 8;

/// Heads of the columns of stages.
pub const STAGE_HEADS: [&str; 10] =
    ["stage", "workers", "ready", "held", "delayed", "blocked", "done", "failed", "dead", "p50"];
/// Heads of the columns of workers.
pub const WORKER_HEADS: [&str; 5] = ["worker", "machine", "stages", "holds", "heard"];

/// Heads of the columns of batches.
pub const BATCH_HEADS: [&str; 6] = ["batch", "priority", "done", "failed", "running", "state"];

/// A batch of a table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BatchRow {
    /// Its name.
    pub name: String,
    /// Whether a client holds it back by itself or with everything.
    pub paused: bool,
    /// Its row, as [`BATCH_HEADS`].
    pub cells: [String; 6],
}

/// A failed attempt of a table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FailureRow {
    /// Its job, as `explain` takes it.
    pub job: String,
    /// Its scenario.
    pub scenario: String,
    /// What is said of it.
    pub line: String,
}

/// What a person at the table has done.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Deed {
    /// Hands out no more jobs of a batch.
    Pause(String),
    /// Hands them out again.
    Resume(String),
    /// Gives up what a batch has not done.
    CancelBatch(String),
    /// Gives up a scenario.
    CancelScenario(String),
}

/// One look at an orchestrator.
#[derive(Debug, Clone, PartialEq)]
pub struct Sight {
    /// Lines above the tables.
    pub head: Vec<String>,
    /// A row per stage, as [`STAGE_HEADS`].
    pub stages: Vec<[String; 10]>,
    /// A row per worker, as [`WORKER_HEADS`].
    pub workers: Vec<[String; 5]>,
    /// Batches, the newest last.
    pub batches: Vec<BatchRow>,
    /// Failed attempts, the newest first.
    pub failures: Vec<FailureRow>,
    /// The same for programs.
    pub object: Value,
}

/// A connection to an orchestrator that is looked at again and again.
pub struct Viewer {
    what: String,
    bus: Arc<dyn Bus>,
}

impl Viewer {
    /// Connects to an endpoint, or to the orchestrator of a run that goes on in a folder.
    ///
    /// # Errors
    /// Nobody works there, or lets nobody of this role in.
    pub async fn open(config: &Config, what: &str) -> Result<Self, Diagnostic> {
        let (address, namespace) = endpoint(what).ok_or_else(|| {
            Diagnostic::input(
                format!("nobody works in `{what}` now"),
                "name the folder of a run that goes on, or an endpoint such as tcp/127.0.0.1:7447@main",
            )
        })?;
        let bus = process::looker(config, &address, &namespace, "top").await?;
        Ok(Self { what: what.to_owned(), bus })
    }

    /// How things stand now.
    ///
    /// # Errors
    /// The orchestrator does not answer, or is of an earlier version.
    pub async fn look(&self) -> Result<Sight, Diagnostic> {
        let ask = StatusAsk { table: true, ..StatusAsk::default() };
        let reply = calls::status(self.bus.as_ref(), &ask).await.map_err(calls::silent)?;
        sight(&self.what, &reply).ok_or_else(|| {
            Diagnostic::input(
                "this orchestrator is of an earlier version and tells no table",
                "`socrates status` works with it; start `socrates cluster up` of this version",
            )
        })
    }

    /// Does what a person wants done, and says what came of it.
    ///
    /// # Errors
    /// The orchestrator does not answer, or refuses.
    pub async fn act(&self, deed: &Deed) -> Result<String, Diagnostic> {
        let of_batch = |name: &String| Whom { batch: Some(name.clone()), ..Whom::default() };
        let (act, whom) = match deed {
            Deed::Pause(batch) => (Act::Pause, of_batch(batch)),
            Deed::Resume(batch) => (Act::Resume, of_batch(batch)),
            Deed::CancelBatch(batch) => (Act::Cancel, of_batch(batch)),
            Deed::CancelScenario(name) => (Act::Cancel, Whom { scenarios: vec![name.clone()], ..Whom::default() }),
        };
        Ok(steer::over(self.bus.as_ref(), act, &whom).await?.join(" · "))
    }

    /// What was tried for a job, and why it stands where it does, in lines.
    ///
    /// # Errors
    /// The orchestrator does not answer, or does not know the job.
    pub async fn explain(&self, job: &str) -> Result<Vec<String>, Diagnostic> {
        explain_job::of_bus(self.bus.as_ref(), job).await
    }

    /// Leaves the bus.
    pub async fn close(self) {
        self.bus.close().await;
    }
}

/// What a reply tells; none where it has no table.
fn sight(what: &str, reply: &StatusReply) -> Option<Sight> {
    let table = reply.table.as_ref()?;
    let mut lines = head(what, reply).to_vec();
    lines.push(tokens(table));
    let mut workers: Vec<[String; 5]> = table.workers.iter().map(worker).collect();
    if table.workers_left > 0 {
        let more = format!("and {} more", table.workers_left);
        workers.push([more, String::new(), String::new(), String::new(), String::new()]);
    }
    Some(Sight {
        head: lines,
        stages: table.stages.iter().map(|of| stage(of, table)).collect(),
        workers,
        batches: reply.batches.iter().map(batch).collect(),
        failures: table.failures.iter().map(failure).collect(),
        object: json!({
            "what": what, "total": reply.total, "done": reply.done, "running": reply.running, "pace": reply.pace,
            "paused": reply.paused, "batches": reply.batches, "table": table,
        }),
    })
}

/// What authors were asked since this reign began.
fn tokens(table: &Table) -> String {
    let (asked, answered) = table
        .tokens
        .values()
        .fold((0_u64, 0_u64), |(asked, answered), one| (asked.saturating_add(one.0), answered.saturating_add(one.1)));
    format!("start {} of the orchestrator · since then {asked} tokens in, {answered} out", table.epoch)
}

fn time(ms: u64) -> String {
    match ms {
        0..1_000 => format!("{ms} ms"),
        _ => span(std::time::Duration::from_millis(ms).as_secs_f64()),
    }
}

fn stage(of: &StageStatus, table: &Table) -> [String; 10] {
    let count = |states: &[JobState]| -> String {
        let sum: u64 = states.iter().filter_map(|state| of.states.get(state)).sum();
        sum.to_string()
    };
    let workers = table.workers.iter().filter(|worker| worker.stages.contains(&of.stage)).count();
    let name = if of.paused { format!("{} (paused)", of.stage) } else { of.stage.to_string() };
    [
        name,
        workers.to_string(),
        count(&[JobState::Ready]),
        count(&[JobState::Leased, JobState::Canceling]),
        count(&[JobState::Delayed]),
        count(&[JobState::Blocked]),
        count(&[JobState::Succeeded]),
        count(&[JobState::Failed]),
        count(&[JobState::Dead]),
        of.p50_ms.map_or_else(|| "–".to_owned(), time),
    ]
}

fn worker(of: &WorkerStatus) -> [String; 5] {
    let stages: Vec<&str> = of.stages.iter().map(|stage| stage.name()).collect();
    let holds = match (&of.first, of.holds) {
        (None, _) if of.draining => "nothing; it is leaving".to_owned(),
        (None, _) => "nothing".to_owned(),
        (Some(first), 0 | 1) => first.to_string(),
        (Some(first), more) => format!("{first} and {} more", more - 1),
    };
    let machine = if of.host.is_empty() { "–".to_owned() } else { format!("{} {}", of.host, of.pid) };
    let short = of.instance.chars().take(SHORT).collect();
    [short, machine, stages.join(", "), holds, format!("{} ago", time(of.seen_ms))]
}

fn batch(of: &BatchStatus) -> BatchRow {
    let open = of.total.saturating_sub(of.done);
    let state = match (of.paused, open) {
        (_, 0) if of.canceled > 0 => format!("done, {} given up", of.canceled),
        (_, 0) => "done".to_owned(),
        (true, _) => "paused".to_owned(),
        (false, _) if of.running > 0 => "going on".to_owned(),
        (false, _) => "waiting".to_owned(),
    };
    BatchRow {
        name: of.name.clone(),
        paused: of.paused,
        cells: [
            of.name.clone(),
            of.priority.name().to_owned(),
            format!("{} of {}", of.done, of.total),
            of.failed.to_string(),
            of.running.to_string(),
            state,
        ],
    }
}

fn failure(of: &Failed) -> FailureRow {
    let why = of.class.map_or("no reason was said", class_words);
    let fault = of.fault.as_ref().map_or_else(String::new, |fault| format!(" · {fault}"));
    let line = format!("{} ago · {} attempt {} · {why}{fault}", time(of.ago_ms), of.key, of.attempt);
    FailureRow { job: of.key.to_string(), scenario: of.key.scenario.to_string(), line }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use socrates_model::fault::FailureClass;
    use socrates_model::job::Stage;
    use socrates_model::wire::Pace;
    use socrates_model::{Fault, FaultCode};

    use super::*;

    #[test]
    fn a_reply_becomes_rows_of_text() {
        let key: socrates_model::job::JobKey =
            serde_json::from_value(json!({ "scenario": "s-1", "stage": "paths", "item": "", "revision": 0 })).unwrap();
        let table = Table {
            epoch: 3,
            stages: vec![StageStatus {
                stage: Stage::Paths,
                states: BTreeMap::from([(JobState::Ready, 4), (JobState::Leased, 1), (JobState::Canceling, 1)]),
                paused: true,
                p50_ms: Some(2_500),
                waited_ms: Some(9),
            }],
            workers: vec![WorkerStatus {
                instance: "0123456789".to_owned(),
                host: "lab".to_owned(),
                pid: 7,
                stages: vec![Stage::Paths],
                holds: 2,
                first: Some(key.clone()),
                seen_ms: 400,
                draining: false,
            }],
            workers_left: 2,
            failures: vec![Failed {
                key,
                attempt: 2,
                class: Some(FailureClass::Semantic),
                fault: Some(Fault::new(FaultCode::GDisc, "robot", "jumps")),
                ago_ms: 12_000,
            }],
            tokens: BTreeMap::from([("a".to_owned(), (1, 2)), ("b".to_owned(), (10, 20))]),
        };
        let pace = Some(Pace { ended: 2, work_ms: 60_000, idle_ms: None });
        let batches =
            vec![BatchStatus { name: "night".to_owned(), total: 5, done: 2, paused: true, ..BatchStatus::default() }];
        let reply = StatusReply { total: 5, done: 2, table: Some(table), pace, batches, ..StatusReply::default() };
        let sight = sight("tcp/x:1", &reply).unwrap();
        assert_eq!(sight.head[0], "tcp/x:1 · going on");
        assert_eq!(sight.head[3], "start 3 of the orchestrator · since then 11 tokens in, 22 out");
        assert_eq!(sight.stages[0].join("|"), "paths (paused)|1|4|2|0|0|0|0|0|3 s");
        assert_eq!(sight.workers[0].join("|"), "01234567|lab 7|paths|s-1/paths/r0 and 1 more|400 ms ago");
        assert_eq!(sight.workers[1][0], "and 2 more");
        assert_eq!(sight.failures[0].line, "12 s ago · s-1/paths/r0 attempt 2 · a wrong answer · G-DISC robot: jumps");
        assert_eq!((sight.failures[0].job.as_str(), sight.failures[0].scenario.as_str()), ("s-1/paths/r0", "s-1"));
        assert_eq!(sight.batches[0].cells.join("|"), "night|normal|2 of 5|0|0|paused");
        assert_eq!(sight.object["table"]["stages"][0]["states"]["ready"], 4);
        assert!(super::sight("x", &StatusReply::default()).is_none());
    }
}
