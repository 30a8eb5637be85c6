//! `explain JOB`: what was tried for a job, and why it stands where it does.
//!
//! ```text
//! endpoint ─► rows of the scenario (what was tried), the orchestrator's word (why it waits)
//! folder   ─► the same two out of the job store, only read, where nobody serves it
//! ```

use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use socrates_link::Bus;
use socrates_model::TraceContext;
use socrates_model::fault::FailureClass;
use socrates_model::job::JobKey;
use socrates_model::wire::{JobAsk, JobWhy, StatusAsk, Wait};
use socrates_orchestrator::{Attempt, AttemptEnd, Scenario, Snapshot, whys_of_rows};
use socrates_store::Reader;

use crate::config::Config;
use crate::exit::Diagnostic;
use crate::files::shell;
use crate::history::{History, PastJob};
use crate::output::Printer;
use crate::progress::span;
use crate::standing::part_words;
use crate::supervise::endpoint;
use crate::words::plural;
use crate::{calls, logs, place, process, work};

/// Names that are proposed for one that is not known, at most.
const NEAR: usize = 5;
/// Attempts that are shown of a job, at most: the newest.
const ATTEMPTS: usize = 20;
/// Faults that are shown of an attempt, at most.
const FAULTS: usize = 6;
/// Letters of a worker's name that tell it from the others.
const SHORT: usize = 8;
/// Lines of logs that are shown of a job, at most: the newest.
const LOGGED: usize = 60;
/// Attempts whose lines are known by their span alone.
const MOST_SPANS: u32 = 64;

/// Where the job is.
#[derive(Debug, Clone)]
pub enum Where {
    /// With the orchestrator at this endpoint, in this namespace.
    Endpoint(String, String),
    /// In the folder of a run or of `cluster up`.
    Folder(PathBuf),
}

/// What is known of the jobs that were asked for.
struct Known {
    past: Vec<PastJob>,
    whys: Vec<JobWhy>,
    /// A remark on where it is from.
    note: Option<String>,
    /// The trace of the scenario; none where its rows do not tell it.
    trace: Option<TraceContext>,
    /// Folders where logs may lie.
    logs: Vec<PathBuf>,
}

/// Explains jobs, named as `SCENARIO`, `SCENARIO/STAGE` or `SCENARIO/STAGE/ITEM`.
///
/// # Errors
/// A name that cannot be one of a job, or is of none; no orchestrator, no store.
///
/// Logs are looked for in the folder, and in these `logs` besides, as workers of other machines keep them.
pub async fn explain(
    talk: &Printer,
    config: &Config,
    job: &str,
    at: &Where,
    logs: &[PathBuf],
) -> Result<(), Diagnostic> {
    let ask = asked_for(job)?;
    let mut known = match at {
        Where::Endpoint(endpoint, namespace) => of_endpoint(config, &ask, endpoint, namespace).await?,
        Where::Folder(folder) => of_folder(config, &ask, folder).await?,
    };
    known.logs.extend_from_slice(logs);
    for line in told(&ask, &known)? {
        talk.line(&line);
    }
    let object = |why: &JobWhy| {
        let past = known.past.iter().find(|past| past.key == why.key);
        let logged: Vec<Value> = known.timeline(&why.key).into_iter().map(|line| line.object).collect();
        object(why, past, logged)
    };
    let (trace, jobs) = (known.trace.map(|trace| trace.trace_id()), known.whys.iter().map(object).collect::<Vec<_>>());
    talk.result(&json!({ "job": ask.to_string(), "trace_id": trace, "jobs": jobs }));
    Ok(())
}

/// The same of an orchestrator that is connected to already, as lines.
pub(crate) async fn of_bus(bus: &dyn Bus, job: &str) -> Result<Vec<String>, Diagnostic> {
    let ask = asked_for(job)?;
    told(&ask, &asked(bus, &ask).await?)
}

fn asked_for(job: &str) -> Result<JobAsk, Diagnostic> {
    job.parse().map_err(|bad: socrates_model::ids::BadId| {
        Diagnostic::input(
            bad.to_string(),
            "a job is SCENARIO, SCENARIO/STAGE or SCENARIO/STAGE/ITEM, such as s-1/simulation/reference-1",
        )
    })
}

/// Everything that is known, in lines.
fn told(ask: &JobAsk, known: &Known) -> Result<Vec<String>, Diagnostic> {
    if known.whys.is_empty() {
        return Err(no_job(ask, &known.past));
    }
    let mut all: Vec<String> = known.note.iter().cloned().collect();
    all.extend(known.trace.map(|trace| format!("trace      {}", trace.trace_id())));
    let now_ms = socrates_link::wall_ms();
    for why in &known.whys {
        let past = known.past.iter().find(|past| past.key == why.key);
        all.extend(lines(why, past, now_ms));
        all.extend(known.timeline(&why.key).iter().map(logged_words));
    }
    Ok(all)
}

impl Known {
    /// What processes logged about a job, in order of time, the newest lines of it.
    fn timeline(&self, key: &JobKey) -> Vec<logs::Line> {
        let Some(trace) = self.trace else { return Vec::new() };
        let spans: Vec<String> = (1..=MOST_SPANS).map(|attempt| trace.of_attempt(key, attempt).span_id()).collect();
        let job = key.to_string();
        let is_of = |line: &logs::Line| {
            let word = |name: &str| line.object.get(name).and_then(Value::as_str);
            match (word("job"), word("span_id")) {
                (Some(named), _) => named == job,
                (None, Some(span)) => spans.iter().any(|own| own == span),
                (None, None) => true,
            }
        };
        let all = self.logs.iter().flat_map(|dir| logs::of_trace(dir, &trace.trace_id()));
        let mut own: Vec<logs::Line> = all.filter(is_of).collect();
        own.sort_by(|a, b| a.at.cmp(&b.at));
        own.split_off(own.len().saturating_sub(LOGGED))
    }
}

/// A line of a log in words: when, who, what, and the fields that say more.
fn logged_words(line: &logs::Line) -> String {
    let word = |name: &str| {
        let value = line.object.get(name)?;
        let text = value.as_str().map_or_else(|| value.to_string(), str::to_owned);
        (!text.is_empty()).then_some(text)
    };
    let mut words = format!("log        {}  {:<14} {}", line.clock, line.process, word("msg").unwrap_or_default());
    let fields = [
        ("attempt", "attempt "),
        ("outcome", ""),
        ("recorded", ""),
        ("result", ""),
        ("class", ""),
        ("faults", ""),
        ("why", ""),
        ("remark", ""),
        ("len", "bytes "),
        ("wall_ms", "ms "),
    ];
    for (name, label) in fields {
        if let Some(value) = word(name) {
            words.push_str(&format!(" · {label}{value}"));
        }
    }
    words
}

async fn of_endpoint(config: &Config, ask: &JobAsk, endpoint: &str, namespace: &str) -> Result<Known, Diagnostic> {
    let bus = process::looker(config, endpoint, namespace, "explain").await?;
    let known = asked(bus.as_ref(), ask).await;
    bus.close().await;
    known
}

/// What an orchestrator knows.
async fn asked(bus: &dyn Bus, ask: &JobAsk) -> Result<Known, Diagnostic> {
    let question = StatusAsk { job: Some(ask.clone()), ..StatusAsk::default() };
    let reply = calls::status(bus, &question).await.map_err(calls::silent)?;
    if reply.whys.as_ref().is_some_and(Vec::is_empty) {
        // Perhaps the scenario is there, and only its job is not.
        let names: Vec<String> = calls::ends(bus).await?.into_iter().map(|end| end.scenario.to_string()).collect();
        if !names.contains(&ask.scenario.to_string()) {
            return Err(no_scenario(ask, &names));
        }
    }
    let text = calls::rows(bus, &ask.scenario).await?;
    let rows: Snapshot = serde_json::from_slice(&text).map_err(|why| {
        Diagnostic::input(
            format!("the rows of `{}` cannot be read: {why}", ask.scenario),
            "orchestrator and this program must be of one version",
        )
    })?;
    let (whys, note) = match reply.whys {
        Some(whys) => (whys, None),
        None => {
            let note =
                "note       this orchestrator is of an earlier version; of what is only in its memory nothing is said";
            let mut whys = whys_of_rows(rows.clone(), ask);
            whys.iter_mut().for_each(|why| why.why.retain(|wait| *wait != Wait::Unserved));
            (whys, Some(note.to_owned()))
        }
    };
    Ok(Known { trace: trace(&rows, ask), past: past(rows, ask), whys, note, logs: Vec::new() })
}

/// What a folder holds, and what its orchestrator says where a run goes on in it.
async fn of_folder(config: &Config, ask: &JobAsk, folder: &Path) -> Result<Known, Diagnostic> {
    if let Some((endpoint, namespace)) = endpoint(&folder.display().to_string()).filter(|_| folder.is_dir()) {
        let known = of_endpoint(config, ask, &endpoint, &namespace).await?;
        return Ok(Known { logs: log_folders(folder), ..known });
    }
    let stores = [work::store(folder), work::store(&folder.join(place::WORK))];
    let store = stores.into_iter().find(|store| store.is_file()).ok_or_else(|| {
        Diagnostic::input(
            format!("`{}` holds no job store", folder.display()),
            format!(
                "name the folder of a run that is not done, or of `socrates cluster up --dir`; a finished bundle tells in {} what \
                 was tried",
                crate::layout::PROVENANCE.path
            ),
        )
    })?;
    let unread = |why: socrates_store::StoreError| {
        Diagnostic::input(format!("cannot read `{}`: {why}", store.display()), "name the folder of a job store")
    };
    let reader = Reader::open(&store).map_err(unread)?;
    let rows = reader.scenario(&ask.scenario).map_err(unread)?;
    if rows.scenarios.is_empty() {
        let standings = reader.standings(0, u64::MAX).map_err(unread)?;
        let names: Vec<String> = standings.into_iter().map(|one| one.scenario.to_string()).collect();
        return Err(no_scenario(ask, &names));
    }
    let note = format!(
        "store      {} · where `socrates cluster up` serves it, --connect tells what is in its memory alone",
        shell(&store)
    );
    let (trace, logs) = (trace(&rows, ask), log_folders(folder));
    Ok(Known { whys: whys_of_rows(rows.clone(), ask), past: past(rows, ask), note: Some(note), trace, logs })
}

/// Where the logs of a folder lie: of `cluster up` or `cluster work`, or of a run.
fn log_folders(folder: &Path) -> Vec<PathBuf> {
    vec![folder.join(logs::FOLDER), folder.join(place::WORK).join(logs::FOLDER)]
}

/// The trace of a scenario.
fn trace(rows: &Snapshot, ask: &JobAsk) -> Option<TraceContext> {
    rows.scenarios.iter().find(|scenario| scenario.spec.id == ask.scenario).map(Scenario::trace)
}

fn past(rows: Snapshot, ask: &JobAsk) -> Vec<PastJob> {
    History::of_rows(rows).of(&ask.scenario).to_vec()
}

/// What is said of a scenario that nobody knows.
fn no_scenario(ask: &JobAsk, names: &[String]) -> Diagnostic {
    let wanted = ask.scenario.to_string();
    let mut near: Vec<(f64, &String)> = names.iter().map(|name| (strsim::jaro_winkler(name, &wanted), name)).collect();
    near.sort_by(|a, b| b.0.total_cmp(&a.0).then_with(|| a.1.cmp(b.1)));
    let near: Vec<String> = near.into_iter().take(NEAR).map(|(_, name)| format!("`{name}`")).collect();
    let hint =
        if near.is_empty() { "nothing was submitted there".to_owned() } else { format!("near: {}", near.join(", ")) };
    Diagnostic::input(format!("there is no scenario `{wanted}`"), hint)
}

/// What is said of a job that a scenario does not have.
fn no_job(ask: &JobAsk, past: &[PastJob]) -> Diagnostic {
    let keys: Vec<String> = past.iter().take(24).map(|job| job.key.to_string()).collect();
    Diagnostic::input(format!("there is no job `{ask}`"), format!("jobs there: {}", keys.join(", ")))
}

/// A job: how it stands, why, and what was tried.
fn lines(why: &JobWhy, past: Option<&PastJob>, now_ms: u64) -> Vec<String> {
    let since = past.map_or(0, |past| past.since_ms);
    let since = ago(since, now_ms).map_or_else(String::new, |span| format!(" · for {span}"));
    let mut lines = vec![format!("job        {} · {}{since}", why.key, why.state.name())];
    if why.why.is_empty() {
        lines.push("waits      for nothing: it goes on by itself".to_owned());
    }
    lines.extend(why.why.iter().map(|wait| format!("{} {}", label(wait), wait_words(wait))));
    let Some(past) = past else { return lines };
    lines.extend(past.sent_back.iter().take(FAULTS).map(|fault| format!("made anew  because of {fault}")));
    let skipped = past.attempts.len().saturating_sub(ATTEMPTS);
    if skipped > 0 {
        lines.push(format!("attempts   {} earlier", plural(skipped, "attempt")));
    }
    for attempt in past.attempts.iter().skip(skipped) {
        lines.push(format!("attempt {:<2} {}", attempt.number, attempt_words(attempt, now_ms)));
        lines.extend(attempt.faults.iter().take(FAULTS).map(|fault| format!("             {fault}")));
        let more = attempt.faults.len().saturating_sub(FAULTS);
        if more > 0 {
            lines.push(format!("             and {more} more"));
        }
    }
    lines
}

/// `12 min 5 s` since a wall time; none where it is not known.
fn ago(at_ms: u64, now_ms: u64) -> Option<String> {
    (at_ms > 0).then(|| time(now_ms.saturating_sub(at_ms)))
}

/// A time in words.
fn time(ms: u64) -> String {
    span(std::time::Duration::from_millis(ms).as_secs_f64())
}

const fn label(wait: &Wait) -> &'static str {
    match wait {
        Wait::Held { .. } => "held      ",
        Wait::Ended(_) => "ended     ",
        Wait::Unserved => "served    ",
        Wait::Paused(_)
        | Wait::NoWorker
        | Wait::Version { .. }
        | Wait::Draining { .. }
        | Wait::Line { .. }
        | Wait::Rate { .. }
        | Wait::Rests { .. }
        | Wait::Slots { .. }
        | Wait::Begun { .. }
        | Wait::Twin(_)
        | Wait::Backoff { .. }
        | Wait::Parent { .. } => "waits     ",
    }
}

/// A reason in words, with what helps where something does.
fn wait_words(wait: &Wait) -> String {
    let many = |count: &u32, word: &str| plural(usize::try_from(*count).unwrap_or(usize::MAX), word);
    match wait {
        Wait::Paused(part) => format!("{} is paused; `socrates cluster resume` lets it go on", part_words(part)),
        Wait::NoWorker => "no worker of this stage is there; `socrates cluster work` starts some".to_owned(),
        Wait::Version { wanted, found } => format!(
            "the workers that came for this stage are of version `{found}` and were turned away; the jobs need `{wanted}`"
        ),
        Wait::Draining { workers } => {
            format!("{} of this stage take no more work; they are leaving", many(workers, "worker"))
        }
        Wait::Line { before: 0, workers, busy } if busy < workers => {
            format!("a worker takes it at its next question; {} of {workers} are free", workers - busy)
        }
        Wait::Line { before, workers, busy } => {
            format!("{} of the stage, {busy} busy; {} stand before it", many(workers, "worker"), many(before, "job"))
        }
        Wait::Rate { server, in_ms } => {
            format!("the rate of `{server}` is used up; it may be asked in {}", time(*in_ms))
        }
        Wait::Rests { in_ms } => {
            format!(
                "the stage rests, since many of its attempts failed with trouble that may pass; one is tried in {}",
                time(*in_ms)
            )
        }
        Wait::Slots { most } => format!("{most} questions are put to authors at one time, as many as may be now"),
        Wait::Begun { most } => format!("{most} scenarios are under way, as many as may be; they are finished first"),
        Wait::Twin(key) => format!("`{key}` does the very same work; its result is taken"),
        Wait::Backoff { in_ms, after } => format!("tried again in {}, after {after}", time(*in_ms)),
        Wait::Parent { key, state } => format!("needs what `{key}` makes, which is {}", state.name()),
        Wait::Held { instance, host, pid, attempt, for_ms, beat_ms, deadline_ms } => {
            let place = if host.is_empty() { String::new() } else { format!(" on {host}, process {pid}") };
            format!(
                "by worker {}{place} for {} as attempt {attempt}; heard {} ago; may take {} more",
                short(instance),
                time(*for_ms),
                time(*beat_ms),
                time(*deadline_ms)
            )
        }
        Wait::Unserved => "nobody serves this store as far as it tells; times count from when somebody does".to_owned(),
        Wait::Ended(reason) if reason.is_empty() => "with a result".to_owned(),
        Wait::Ended(reason) => format!("because of {reason}"),
    }
}

fn short(instance: &str) -> String {
    instance.chars().take(SHORT).collect()
}

/// How an attempt went, in words.
fn attempt_words(attempt: &Attempt, now_ms: u64) -> String {
    let end = match attempt.end {
        None => "goes on".to_owned(),
        Some(AttemptEnd::Succeeded) => "succeeded".to_owned(),
        Some(AttemptEnd::Failed) => format!("failed: {}", attempt.class.map_or("no reason was said", class_words)),
        Some(AttemptEnd::TimedOut) => "took too long".to_owned(),
        Some(AttemptEnd::Lapsed) => "its worker was lost".to_owned(),
        Some(AttemptEnd::Released) => "handed back unharmed".to_owned(),
        Some(AttemptEnd::Canceled) => "stopped: the job was given up".to_owned(),
        Some(AttemptEnd::Superseded) => "stopped: another attempt or revision made it needless".to_owned(),
    };
    let mut parts = vec![format!("worker {}", short(&attempt.instance)), end];
    parts.extend(ago(attempt.at_ms, now_ms).map(|span| format!("begun {span} ago")));
    if attempt.reported {
        parts.push(format!("{} ms", attempt.wall_ms));
    }
    if attempt.tokens != (0, 0) {
        parts.push(format!("{} tokens in, {} out", attempt.tokens.0, attempt.tokens.1));
    }
    parts.extend((!attempt.remark.is_empty()).then(|| attempt.remark.clone()));
    parts.join(" · ")
}

/// A class of failures in words.
pub(crate) const fn class_words(class: FailureClass) -> &'static str {
    match class {
        FailureClass::Transient => "trouble that may pass",
        FailureClass::Overload => "too much was asked of the server",
        FailureClass::Semantic => "a wrong answer",
        FailureClass::Unparsable => "an answer that cannot be read",
        FailureClass::WorkerDeath => "the worker died",
        FailureClass::Poison => "the job breaks its worker",
        FailureClass::Permanent => "it cannot get better by itself",
    }
}

fn object(why: &JobWhy, past: Option<&PastJob>, logged: Vec<Value>) -> Value {
    let attempt = |one: &Attempt| {
        json!({
            "attempt": one.number, "worker": one.instance, "end": one.end.map(AttemptEnd::name), "class": one.class,
            "at_ms": one.at_ms, "wall_ms": one.wall_ms, "tokens": one.tokens, "faults": one.faults, "remark": one.remark,
        })
    };
    let waits: Vec<Value> = why.why.iter().map(|wait| json!({ "reason": wait, "told": wait_words(wait) })).collect();
    json!({
        "job": why.key.to_string(), "state": why.state, "since_ms": past.map_or(0, |past| past.since_ms), "why": waits,
        "attempts": past.map(|past| past.attempts.iter().map(attempt).collect::<Vec<_>>()), "log": logged,
    })
}

#[cfg(test)]
mod tests {
    use socrates_model::job::Stage;
    use socrates_model::wire::Part;
    use socrates_model::{FaultCode, JobState};

    use super::*;

    fn why(state: JobState, why: Vec<Wait>) -> JobWhy {
        let ask: JobAsk = "s-1/paths".parse().unwrap();
        let key = socrates_model::job::JobKey {
            scenario: ask.scenario,
            stage: Stage::Paths,
            item: socrates_model::job::Item::Whole,
            revision: 0,
        };
        JobWhy { key, state, why }
    }

    #[test]
    fn a_reason_says_what_helps() {
        let waits = vec![
            Wait::Paused(Part::Stage(Stage::Paths)),
            Wait::NoWorker,
            Wait::Line { before: 3, workers: 1, busy: 1 },
            Wait::Rate { server: "openai:m".to_owned(), in_ms: 61_000 },
        ];
        let told = lines(&why(JobState::Ready, waits), None, 0);
        assert_eq!(
            told,
            [
                "job        s-1/paths/r0 · ready",
                "waits      stage paths is paused; `socrates cluster resume` lets it go on",
                "waits      no worker of this stage is there; `socrates cluster work` starts some",
                "waits      1 worker of the stage, 1 busy; 3 jobs stand before it",
                "waits      the rate of `openai:m` is used up; it may be asked in 1 min 1 s",
            ]
        );
        let held = Wait::Held {
            instance: "0123456789".to_owned(),
            host: "lab-3".to_owned(),
            pid: 7,
            attempt: 2,
            for_ms: 5_000,
            beat_ms: 900,
            deadline_ms: 115_000,
        };
        assert_eq!(
            lines(&why(JobState::Leased, vec![held]), None, 0)[1],
            "held       by worker 01234567 on lab-3, process 7 for 5 s as attempt 2; heard 1 s ago; may take 1 min 55 s more"
        );
    }

    #[test]
    fn what_was_tried_stands_under_the_job_in_words() {
        let attempt: Attempt = serde_json::from_value(json!({
            "number": 1, "instance": "0123456789", "fence": 1, "trial": 0, "end": "failed", "reported": true, "class": "semantic",
            "faults": [{ "code": FaultCode::GDisc.code(), "at": {}, "message": "jumps" }], "wall_ms": 4100, "tokens": [1200, 300],
            "remark": "", "artifacts": [], "at_ms": 1_000,
        }))
        .unwrap();
        let why = why(JobState::Delayed, vec![Wait::Backoff { in_ms: 500, after: "G-DISC".to_owned() }]);
        let past = PastJob {
            key: why.key.clone(),
            state: why.state,
            seed: 1,
            inputs: std::collections::BTreeMap::new(),
            sent_back: Vec::new(),
            attempts: vec![attempt],
            verdict: None,
            blames: None,
            remark: String::new(),
            artifacts: Vec::new(),
            since_ms: 61_000,
        };
        assert_eq!(
            lines(&why, Some(&past), 121_000),
            [
                "job        s-1/paths/r0 · delayed · for 1 min 0 s",
                "waits      tried again in 1 s, after G-DISC",
                "attempt 1  worker 01234567 · failed: a wrong answer · begun 2 min 0 s ago · 4100 ms · 1200 tokens in, 300 out",
                "             G-DISC: jumps",
            ]
        );
        let object = object(&why, Some(&past), Vec::new());
        assert_eq!(
            (object["why"][0]["reason"]["backoff"]["in_ms"].as_u64(), &object["attempts"][0]["class"]),
            (Some(500), &json!("semantic"))
        );
    }

    #[test]
    fn a_name_that_nobody_has_is_answered_with_near_ones() {
        let ask: JobAsk = "halll-3".parse().unwrap();
        let names = ["door-1", "hall-3", "hall-30"].map(str::to_owned);
        let why = no_scenario(&ask, &names);
        assert!(why.what.contains("`halll-3`") && why.hint.starts_with("near: `hall-3`"), "{why}");
    }
}
