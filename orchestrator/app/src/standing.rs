//! `status`: how scenarios stand, in eight lines, while they are made and afterwards.
//!
//! ```text
//! endpoint ─► the orchestrator's answer
//! folder   ─► manifest │ library.json │ the job store, only read (and the orchestrator's answer while there is one)
//! ```

mod batches;

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Duration;

use serde_json::{Value, json};
use socrates_link::rules::Role;
use socrates_model::wire::{BatchStatus, Pace, Part, StatusAsk, StatusReply};
use socrates_model::{JobState, ScenarioEnd};
use socrates_store::Reader;

use crate::config::Config;
use crate::exit::Diagnostic;
use crate::files::shell;
use crate::history::History;
use crate::output::Printer;
use crate::progress::{Speed, span};
use crate::supervise::endpoint;
use crate::{batch, bundle, calls, library_index, place, process, stages, work};

pub(crate) use batches::part_words;

/// How long an orchestrator may take to answer before the folder counts as one where nobody works.
const ANSWER: Duration = Duration::from_secs(5);

/// How long nobody has to hold a job until that is called idle, ms.
const IDLE_MS: u64 = 2_000;

/// Which scenarios are listed under the eight lines.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Listed {
    /// None, but a single one.
    None,
    /// Those of which no bundle could be made.
    Failed,
    /// All.
    All,
}

/// Whether anybody works on it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum Phase {
    #[default]
    GoingOn,
    Idle,
    Stopped,
    Finished,
}

impl Phase {
    const fn name(self) -> &'static str {
        match self {
            Self::GoingOn => "going_on",
            Self::Idle => "idle",
            Self::Stopped => "stopped",
            Self::Finished => "finished",
        }
    }
}

/// One scenario.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
struct Row {
    scenario: String,
    /// How it ended; none while it is open.
    result: Option<ScenarioEnd>,
    /// Its stages, or why it failed.
    told: String,
}

/// How everything stands.
#[derive(Debug, Clone, PartialEq, Default)]
struct Standing {
    what: String,
    phase: Phase,
    total: u64,
    running: u64,
    results: BTreeMap<ScenarioEnd, u64>,
    /// Since when, s, and how fast; only while somebody works.
    speed: Option<(f64, Speed)>,
    /// How long nobody has held a job, s.
    idle_s: Option<f64>,
    workers: BTreeMap<String, u32>,
    rows: Vec<Row>,
    batches: Vec<BatchStatus>,
    batches_left: u32,
    paused: Vec<Part>,
}

/// Seconds of milliseconds.
fn seconds(ms: u64) -> f64 {
    Duration::from_millis(ms).as_secs_f64()
}

impl Standing {
    fn of_rows(what: &str, phase: Phase, rows: Vec<Row>) -> Self {
        let mut results: BTreeMap<ScenarioEnd, u64> = BTreeMap::new();
        for result in rows.iter().filter_map(|row| row.result) {
            *results.entry(result).or_default() += 1;
        }
        let total = u64::try_from(rows.len()).unwrap_or(u64::MAX);
        Self { what: what.to_owned(), phase, total, results, rows, ..Self::default() }
    }

    /// What the orchestrator says beside the counts.
    fn with(mut self, reply: &StatusReply) -> Self {
        let (total, done) = (u64::from(reply.total), u64::from(reply.done));
        self.speed = Some(match reply.pace {
            Some(Pace { ended, work_ms, .. }) => {
                let made = Speed::of(u64::from(ended), u64::from(ended), 0, Duration::from_millis(work_ms));
                (seconds(work_ms), made.for_open(total.saturating_sub(done)))
            }
            // An orchestrator of before says only since when it serves.
            None => {
                let elapsed = Duration::from_millis(reply.serving_ms);
                (elapsed.as_secs_f64(), Speed::of(done, total, u64::from(reply.done_before), elapsed))
            }
        });
        // Between two jobs of a chain nobody holds one for a moment.
        let idle = reply.pace.and_then(|pace| pace.idle_ms).filter(|ms| *ms >= IDLE_MS || done == total);
        self.idle_s = idle.map(seconds);
        if self.phase == Phase::GoingOn && self.idle_s.is_some() {
            self.phase = if total > 0 && done == total { Phase::Finished } else { Phase::Idle };
        }
        (self.batches, self.batches_left) = (reply.batches.clone(), reply.batches_left);
        self.paused.clone_from(&reply.paused);
        self.total = u64::from(reply.total);
        self.running = u64::from(reply.running);
        self.results = reply.results.iter().map(|(result, count)| (*result, u64::from(*count))).collect();
        self.workers.clone_from(&reply.workers);
        self
    }

    fn done(&self) -> u64 {
        self.results.values().sum()
    }

    fn failed(&self) -> u64 {
        self.results.get(&ScenarioEnd::Failed).copied().unwrap_or(0)
    }

    /// Whether it goes on.
    fn phase_words(&self) -> String {
        let (total, done) = (self.total, self.done());
        match self.phase {
            Phase::GoingOn => "going on".to_owned(),
            Phase::Idle if total == 0 => "nothing was submitted".to_owned(),
            Phase::Idle => format!("idle for {}", span(self.idle_s.unwrap_or(0.0))),
            Phase::Stopped => format!("stopped at {done} of {total}; the same command resumes"),
            Phase::Finished => "finished".to_owned(),
        }
    }

    /// How fast, and how long yet.
    fn rate_words(&self) -> (String, String) {
        let rate = self.speed.filter(|(_, speed)| speed.per_s > 0.0);
        let rate = rate.map_or_else(
            || "none".to_owned(),
            |(since, speed)| format!("{} over {} of work", speed.rate(), span(since)),
        );
        let left = match (self.phase, self.speed.and_then(|(_, speed)| speed.left_s)) {
            (Phase::Finished, _) => "nothing".to_owned(),
            (Phase::GoingOn, Some(left)) => format!("about {}", span(left)),
            (Phase::Idle, Some(left)) if self.total > self.done() => {
                format!("about {} of work, once something moves again", span(left))
            }
            (Phase::GoingOn | Phase::Idle | Phase::Stopped, _) => "not known".to_owned(),
        };
        (rate, left)
    }

    /// The eight lines.
    fn lines(&self) -> [String; 8] {
        let (total, done, failed) = (self.total, self.done(), self.failed());
        let word = Path::new(&self.what);
        let phase = self.phase_words();
        let share = (done * 100).checked_div(total).map_or_else(String::new, |share| format!(" ({share} %)"));
        let waiting = total.saturating_sub(done).saturating_sub(self.running);
        let why =
            if failed > 0 { format!(" · `socrates status --failed {}` says why", shell(word)) } else { String::new() };
        let list = |rows: Vec<String>| if rows.is_empty() { "none".to_owned() } else { rows.join(" · ") };
        let mut verdicts: Vec<(&ScenarioEnd, &u64)> =
            self.results.iter().filter(|(result, _)| **result != ScenarioEnd::Failed).collect();
        verdicts.sort_by_key(|(_, count)| std::cmp::Reverse(**count));
        let verdicts = list(verdicts.iter().map(|(verdict, count)| format!("{count} {verdict}")).collect());
        let (rate, left) = self.rate_words();
        let workers = list(self.workers.iter().map(|(stage, count)| format!("{count} {stage}")).collect());
        [
            format!("made in    {} · {phase}", self.what),
            format!("done       {done} of {total}{share}"),
            format!("running    {} · {waiting} waiting", self.running),
            format!("failed     {failed}{why}"),
            format!("verdicts   {verdicts}"),
            format!("rate       {rate}"),
            format!("left       {left}"),
            format!("workers    {workers}"),
        ]
    }

    /// The scenarios that are listed.
    fn listed(&self, which: Listed) -> Vec<&Row> {
        let meant = |row: &&Row| match which {
            Listed::None => self.total == 1,
            Listed::Failed => row.result == Some(ScenarioEnd::Failed),
            Listed::All => true,
        };
        self.rows.iter().filter(meant).collect()
    }

    fn object(&self, which: Listed) -> Value {
        let row = |row: &&Row| json!({ "scenario": row.scenario, "done": row.result.is_some(), "result": row.result, "told": row.told });
        let speed = self.speed.map(|(_, speed)| speed);
        let left = speed.and_then(|speed| speed.left_s).filter(|_| self.phase == Phase::GoingOn);
        json!({
            "what": self.what, "phase": self.phase.name(), "total": self.total, "done": self.done(), "running": self.running,
            "failed": self.failed(), "verdicts": self.results, "rate_per_s": speed.map(|speed| speed.per_s), "left_s": left,
            "idle_s": self.idle_s, "batches": self.batches, "paused": self.paused, "workers": self.workers, "scenarios": self.listed(which).iter().map(row).collect::<Vec<_>>(),
        })
    }
}

/// What an orchestrator says of everything, in three lines for the head of a table.
pub(crate) fn head(what: &str, reply: &StatusReply) -> [String; 3] {
    let standing = Standing::of_rows(what, Phase::GoingOn, Vec::new()).with(reply);
    let (rate, left) = standing.rate_words();
    let (total, done, failed, running) = (standing.total, standing.done(), standing.failed(), standing.running);
    let paused: Vec<String> = standing.paused.iter().map(part_words).collect();
    let paused = if paused.is_empty() { "nothing".to_owned() } else { paused.join(" · ") };
    [
        format!("{what} · {}", standing.phase_words()),
        format!("{done} of {total} done · {failed} failed · {running} running · paused: {paused}"),
        format!("rate {rate} · left {left}"),
    ]
}

/// Shows how the jobs of a folder or endpoint stand, or those of one batch.
///
/// # Errors
/// Nothing is made there, no orchestrator answers, or there is no such batch.
pub async fn status(
    talk: &Printer,
    config: &Config,
    what: &str,
    batch: Option<&str>,
    listed: Listed,
) -> Result<(), Diagnostic> {
    let folder = Path::new(what);
    let wish = Wish { what, batch: batch.unwrap_or_default(), listed };
    let standing =
        if folder.exists() { of_folder(config, wish, folder).await? } else { of_endpoint(config, wish).await? };
    let further = batches::lines(&standing.paused, &standing.batches, standing.batches_left, socrates_link::wall_ms());
    for line in standing.lines().into_iter().chain(further) {
        talk.line(&line);
    }
    for row in standing.listed(listed) {
        let result = row.result.map_or("open", ScenarioEnd::name);
        talk.line(&format!("{:<28} {result:<14} {}", row.scenario, row.told));
    }
    talk.result(&standing.object(listed));
    Ok(())
}

/// What is asked for.
#[derive(Debug, Clone, Copy)]
struct Wish<'a> {
    what: &'a str,
    /// One batch; empty for all.
    batch: &'a str,
    listed: Listed,
}

impl Wish<'_> {
    fn page(self, from: u32) -> StatusAsk {
        StatusAsk { batch: self.batch.to_owned(), from, ..StatusAsk::default() }
    }

    /// Refuses a batch that is not there.
    fn check(self, reply: &StatusReply) -> Result<(), Diagnostic> {
        if self.batch.is_empty() || reply.total > 0 {
            return Ok(());
        }
        let names: Vec<String> = reply.batches.iter().map(|batch| format!("`{}`", batch.name)).collect();
        Err(no_batch(self.batch, &names))
    }
}

fn no_batch(name: &str, there: &[String]) -> Diagnostic {
    let there = if there.is_empty() { "none is there".to_owned() } else { format!("there are: {}", there.join(", ")) };
    Diagnostic::input(format!("there is no batch `{name}`"), there)
}

/// What the orchestrator at an endpoint says.
async fn of_endpoint(config: &Config, wish: Wish<'_>) -> Result<Standing, Diagnostic> {
    let Wish { what, batch, listed } = wish;
    let (address, namespace) = endpoint(what).ok_or_else(|| nothing(what))?;
    let bus = process::looker(config, &address, &namespace, "watch").await?;
    let mut first = calls::status(bus.as_ref(), &wish.page(0)).await.map_err(calls::silent)?;
    wish.check(&first)?;
    first.batches.retain(|one| batch.is_empty() || one.name == batch);
    let mut rows = Vec::new();
    let mut from = 0;
    // One scenario is told with the counts; more are asked for page by page.
    while listed != Listed::None || (from == 0 && first.total == 1) {
        let page = calls::status(bus.as_ref(), &wish.page(from)).await.map_err(calls::silent)?.scenarios;
        if page.is_empty() {
            break;
        }
        from += u32::try_from(page.len()).unwrap_or(u32::MAX);
        rows.extend(page.iter().map(|scenario| Row {
            scenario: scenario.id.to_string(),
            result: scenario.result,
            told: stages::line_of(scenario),
        }));
    }
    bus.close().await;
    Ok(Standing { rows, ..Standing::of_rows(what, Phase::GoingOn, Vec::new()).with(&first) })
}

/// What lies in a folder: a bundle, a library, something that is being made, or several of them.
async fn of_folder(config: &Config, wish: Wish<'_>, folder: &Path) -> Result<Standing, Diagnostic> {
    let Wish { what, batch, .. } = wish;
    if !batch.is_empty() {
        let hint = "name the endpoint of the orchestrator, such as tcp/127.0.0.1:7447@main";
        return Err(Diagnostic::input(format!("`{what}` is a folder, and batches are of a cluster"), hint));
    }
    if let Some(rows) = made(folder) {
        return Ok(Standing::of_rows(what, Phase::Finished, rows));
    }
    if folder.join(place::WORK).is_dir() {
        return being_made(config, wish, folder).await;
    }
    // A folder of bundles, perhaps with some that are not finished.
    let mut below: Vec<_> = std::fs::read_dir(folder)
        .map_err(|why| Diagnostic::input(format!("cannot read `{what}`: {why}"), "name a folder"))?
        .filter_map(Result::ok)
        .map(|entry| entry.path())
        .filter(|dir| dir.is_dir())
        .collect();
    below.sort();
    let (mut rows, mut phase) = (Vec::new(), Phase::Finished);
    for dir in below {
        if let Some(found) = made(&dir) {
            rows.extend(found);
        } else if dir.join(place::WORK).is_dir() {
            let found = being_made(config, wish, &dir).await?;
            let open = found.phase;
            let goes_on = matches!(open, Phase::GoingOn | Phase::Idle);
            phase = if phase == Phase::Finished || goes_on { open } else { phase };
            rows.extend(from_store(&dir, true)?);
        }
    }
    if rows.is_empty() {
        return Err(nothing(what));
    }
    Ok(Standing::of_rows(what, phase, rows))
}

/// The scenarios of a finished bundle or library.
fn made(folder: &Path) -> Option<Vec<Row>> {
    if let Some(manifest) = bundle::manifest(folder) {
        let told = stages::line_of_bundle(folder, manifest.verdict);
        let result = Some(ScenarioEnd::Judged(manifest.verdict));
        return Some(vec![Row { scenario: manifest.scenario, result, told }]);
    }
    let library = library_index::read(folder)?;
    let row = |row: library_index::Row| Row {
        scenario: row.scenario.to_string(),
        result: Some(row.verdict),
        told: row.reason,
    };
    Some(library.scenarios.into_iter().map(row).collect())
}

/// A folder with a job store: its rows, and what the orchestrator says where one works.
async fn being_made(config: &Config, wish: Wish<'_>, folder: &Path) -> Result<Standing, Diagnostic> {
    let rows = from_store(folder, wish.listed != Listed::None)?;
    let ended = place::ended(folder).is_some();
    let standing = Standing::of_rows(wish.what, if ended { Phase::Finished } else { Phase::Stopped }, rows);
    let endpoint = endpoint(&folder.display().to_string()).filter(|_| !ended);
    let Some((address, namespace)) = endpoint else { return Ok(standing) };
    let answer = tokio::time::timeout(ANSWER, async {
        let bus = process::client(config, Role::Client, &address, &namespace, "watch").await.ok()?;
        let reply = calls::status(bus.as_ref(), &wish.page(0)).await.ok();
        bus.close().await;
        reply
    });
    let Some(reply) = answer.await.ok().flatten() else { return Ok(standing) };
    let mut standing = Standing { phase: Phase::GoingOn, ..standing };
    // Of one that goes on, the orchestrator knows more than its store: how much its authors have written.
    if let ([row], [line]) = (standing.rows.as_mut_slice(), reply.scenarios.as_slice())
        && row.result.is_none()
    {
        row.told = stages::line_of(line);
    }
    // The one batch of a run needs no name.
    Ok(Standing { batches: Vec::new(), ..standing.with(&reply) })
}

/// The scenarios of the job store of a folder, with what they did where that is wanted or there is only one.
fn from_store(folder: &Path, told: bool) -> Result<Vec<Row>, Diagnostic> {
    let store = work::store(&folder.join(place::WORK));
    if !store.is_file() {
        return Ok(Vec::new());
    }
    let unread = |why: socrates_store::StoreError| {
        Diagnostic::input(format!("cannot read `{}`: {why}", store.display()), "the same command again resumes")
    };
    let reader = Reader::open(&store).map_err(unread)?;
    let standings = reader.standings(0, u64::MAX).map_err(unread)?;
    if !told && standings.len() != 1 {
        let row = |one: socrates_store::Standing| Row {
            scenario: one.scenario.to_string(),
            result: one.result,
            told: String::new(),
        };
        return Ok(standings.into_iter().map(row).collect());
    }
    let history = History::of_rows(reader.all().map_err(unread)?);
    let row = |(id, end): &(socrates_model::ScenarioId, Option<ScenarioEnd>)| {
        let past = history.of(id);
        let mut told = stages::line(past, *end);
        // The reason of a failure: the newest fault of the job that ended it.
        let wrong = past.iter().rev().find(|job| matches!(job.state, JobState::Failed | JobState::Dead));
        let fault = wrong.and_then(|job| job.attempts.iter().rev().find_map(|attempt| attempt.faults.first()));
        told.push_str(&fault.map_or_else(String::new, |fault| format!(" · {fault}")));
        Row { scenario: id.to_string(), result: *end, told }
    };
    Ok(history.ends.iter().map(row).collect())
}

fn nothing(what: &str) -> Diagnostic {
    let path = Path::new(what);
    if path.is_dir() {
        return batch::none(path);
    }
    Diagnostic::input(
        format!("nothing is made, or being made, in `{what}`"),
        "name a bundle, a library, or an endpoint such as tcp/127.0.0.1:7447@main",
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use socrates_model::Verdict;

    fn reply() -> StatusReply {
        StatusReply {
            total: 60,
            done: 24,
            running: 5,
            results: BTreeMap::from([
                (ScenarioEnd::Judged(Verdict::Realised), 20),
                (ScenarioEnd::Judged(Verdict::Contradicted), 3),
                (ScenarioEnd::Failed, 1),
            ]),
            serving_ms: 10_000,
            done_before: 4,
            pace: Some(Pace { ended: 20, work_ms: 10_000, idle_ms: None }),
            workers: BTreeMap::from([("paths".to_owned(), 1), ("simulation".to_owned(), 2)]),
            ..StatusReply::default()
        }
    }

    #[test]
    fn a_batch_is_told_in_eight_lines() {
        let standing = Standing::of_rows("my lib", Phase::GoingOn, Vec::new()).with(&reply());
        let told = [
            "made in    my lib · going on",
            "done       24 of 60 (40 %)",
            "running    5 · 31 waiting",
            "failed     1 · `socrates status --failed 'my lib'` says why",
            "verdicts   20 realised · 3 contradicted",
            "rate       2.0 a second over 10 s of work",
            "left       about 18 s",
            "workers    1 paths · 2 simulation",
        ];
        assert_eq!(standing.lines(), told);
        let object = standing.object(Listed::None);
        assert_eq!((object["rate_per_s"].as_f64(), object["left_s"].as_f64()), (Some(2.0), Some(18.0)));
        assert_eq!((&object["phase"], &object["failed"]), (&json!("going_on"), &json!(1)));
    }

    #[test]
    fn what_nobody_works_on_is_idle_and_keeps_the_rate_of_its_work() {
        // Served for an hour, in ten seconds of which twenty were made.
        let pace = Pace { ended: 20, work_ms: 10_000, idle_ms: Some(185_000) };
        let idle = StatusReply { serving_ms: 3_600_000, pace: Some(pace), ..reply() };
        let standing = Standing::of_rows("tcp/x:1", Phase::GoingOn, Vec::new()).with(&idle);
        let lines = standing.lines();
        assert_eq!(lines[0], "made in    tcp/x:1 · idle for 3 min 5 s");
        assert_eq!(lines[5], "rate       2.0 a second over 10 s of work");
        assert_eq!(lines[6], "left       about 18 s of work, once something moves again");
        assert_eq!(
            (&standing.object(Listed::None)["phase"], standing.object(Listed::None)["left_s"].as_f64()),
            (&json!("idle"), None)
        );
        // Between two jobs nobody holds one for a moment.
        let pace = Pace { idle_ms: Some(40), ..pace };
        let moment = StatusReply { pace: Some(pace), ..reply() };
        assert_eq!(Standing::of_rows("x", Phase::GoingOn, Vec::new()).with(&moment).phase, Phase::GoingOn);
        // An orchestrator of before tells no pace.
        let before = StatusReply { pace: None, ..reply() };
        assert_eq!(
            Standing::of_rows("x", Phase::GoingOn, Vec::new()).with(&before).lines()[6],
            "left       about 18 s"
        );
        let done = StatusReply { done: 60, results: BTreeMap::from([(ScenarioEnd::Failed, 60)]), ..idle };
        assert_eq!(Standing::of_rows("x", Phase::GoingOn, Vec::new()).with(&done).phase, Phase::Finished);
    }

    #[test]
    fn a_batch_that_is_not_there_is_answered_with_those_that_are() {
        let batch = |name: &str| BatchStatus { name: name.to_owned(), ..BatchStatus::default() };
        let told = StatusReply { total: 0, batches: vec![batch("night"), batch("day")], ..reply() };
        let wish = |batch| Wish { what: "x", batch, listed: Listed::None };
        let why = wish("nigth").check(&told).unwrap_err();
        assert!(why.what.contains("`nigth`") && why.hint.contains("`night`, `day`"), "{why}");
        wish("").check(&told).unwrap();
    }

    #[test]
    fn what_stopped_or_ended_knows_its_counts_and_claims_no_speed() {
        let row = |name: &str, result: Option<&str>| Row {
            scenario: name.to_owned(),
            result: result.map(|word| word.parse().unwrap()),
            told: String::new(),
        };
        let rows = || vec![row("a", Some("realised")), row("b", Some("failed")), row("c", None)];
        let stopped = Standing::of_rows("lib", Phase::Stopped, rows());
        let lines = stopped.lines();
        assert_eq!(lines[0], "made in    lib · stopped at 2 of 3; the same command resumes");
        assert_eq!((lines[5].as_str(), lines[6].as_str()), ("rate       none", "left       not known"));
        assert_eq!(stopped.listed(Listed::Failed), [&row("b", Some("failed"))]);
        assert_eq!((stopped.listed(Listed::None).len(), stopped.listed(Listed::All).len()), (0, 3));
        let one = Standing::of_rows("x", Phase::Finished, vec![row("a", Some("realised"))]);
        assert_eq!((one.listed(Listed::None).len(), one.lines()[6].as_str()), (1, "left       nothing"));
    }
}
