//! What the orchestrator can say of itself in figures: the text format of Prometheus, base units, no label that grows with the work.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::sync::Arc;
use std::time::Duration;

use async_trait::async_trait;
use socrates_gateway::plain::{Plain, Source};
use socrates_model::fault::FailureClass;
use socrates_model::job::Stage;
use socrates_orchestrator::tally::{Histogram, Tally};
use socrates_orchestrator::{AttemptEnd, JobState, Millis, State, cost_of, overview, price_of};
use tokio::net::TcpListener;
use tokio::sync::{mpsc, oneshot};

use super::counts::{Counted, Refusal};
use super::reader::Inbound;

/// Path of the figures.
const PATH: &str = "/metrics";
/// Media type of the text format.
const MEDIA: &str = "text/plain; version=0.0.4; charset=utf-8";
/// How long a collector is kept waiting.
const LIMIT: Duration = Duration::from_secs(2);
/// Every stage, in pipeline order.
const STAGES: [Stage; 6] =
    [Stage::Proposal, Stage::Review, Stage::Paths, Stage::Behaviors, Stage::Simulation, Stage::Scoring];
/// Every state of a job.
const STATES: [JobState; 10] = [
    JobState::Blocked,
    JobState::Ready,
    JobState::Delayed,
    JobState::Leased,
    JobState::Canceling,
    JobState::Succeeded,
    JobState::Failed,
    JobState::Dead,
    JobState::Canceled,
    JobState::Superseded,
];

/// Asks the owner of the state.
struct Owner(mpsc::Sender<Inbound>);

#[async_trait]
impl Source for Owner {
    async fn text(&self) -> Option<String> {
        let (answer, text) = oneshot::channel();
        let asked = async {
            self.0.send(Inbound::Counted(answer)).await.ok()?;
            text.await.ok()
        };
        tokio::time::timeout(LIMIT, asked).await.ok().flatten()
    }
}

/// Serves the figures until it is dropped.
pub(super) async fn serve(listener: TcpListener, line: mpsc::Sender<Inbound>) {
    let Ok(at) = listener.local_addr() else { return };
    let plain = Plain { path: PATH, media: MEDIA, source: Arc::new(Owner(line)) };
    socrates_gateway::plain::serve(listener, at, plain).await;
}

/// The page of figures.
struct Page(String);

impl Page {
    /// Begins a family: every sample of it follows at once.
    fn family(&mut self, name: &str, kind: &str, help: &str) {
        let _written = write!(self.0, "# HELP {name} {help}\n# TYPE {name} {kind}\n");
    }

    fn sample(&mut self, name: &str, labels: &[(&str, &str)], value: impl std::fmt::Display) {
        let label = |(name, value): &(&str, &str)| format!("{name}=\"{}\"", escaped(value));
        let labels: Vec<String> = labels.iter().map(label).collect();
        let labels = if labels.is_empty() { String::new() } else { format!("{{{}}}", labels.join(",")) };
        let _written = writeln!(self.0, "{name}{labels} {value}");
    }

    /// The samples of a histogram; `to_unit` of what it counts make one unit.
    fn histogram(&mut self, name: &str, labels: &[(&str, &str)], values: &Histogram, to_unit: u64) {
        let bucket = format!("{name}_bucket");
        for (bound, count) in values.ranges() {
            let bound = in_units(bound, to_unit);
            self.sample(&bucket, &[labels, &[("le", bound.as_str())]].concat(), count);
        }
        self.sample(&bucket, &[labels, &[("le", "+Inf")]].concat(), values.count());
        self.sample(&format!("{name}_sum"), labels, in_units(values.sum(), to_unit));
        self.sample(&format!("{name}_count"), labels, values.count());
    }
}

/// A whole number of parts as a decimal of the unit: `1500` of `1000` is `1.5`.
fn in_units(value: u64, to_unit: u64) -> String {
    let digits = usize::try_from(to_unit.checked_ilog10().unwrap_or(0)).unwrap_or(0);
    if digits == 0 {
        return value.to_string();
    }
    let whole = format!("{}.{:0digits$}", value / to_unit, value % to_unit);
    whole.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// A value of a label as the format wants it.
fn escaped(value: &str) -> String {
    value.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', "\\n")
}

const fn class_name(class: Option<FailureClass>) -> &'static str {
    match class {
        None => "none",
        Some(FailureClass::Transient) => "transient",
        Some(FailureClass::Overload) => "overload",
        Some(FailureClass::Semantic) => "semantic",
        Some(FailureClass::Unparsable) => "unparsable",
        Some(FailureClass::WorkerDeath) => "worker_death",
        Some(FailureClass::Poison) => "poison",
        Some(FailureClass::Permanent) => "permanent",
    }
}

/// All figures at time `now`, ms.
pub(super) fn text(state: &State, now: Millis, counted: &Counted) -> String {
    let mut page = Page(String::with_capacity(16 * 1024));
    let version = state.policy.code_version.as_str();
    page.family("socrates_build_info", "gauge", "Version of the program; always 1.");
    page.sample("socrates_build_info", &[("version", version)], 1);
    page.family(
        "socrates_is_active",
        "gauge",
        "Whether this orchestrator hands out jobs; one that does not is not asked.",
    );
    page.sample("socrates_is_active", &[], 1);
    page.family("socrates_orchestrator_epoch", "gauge", "Number of the orchestrator's start; grows with every one.");
    page.sample("socrates_orchestrator_epoch", &[], state.epoch);
    page.family("socrates_scenarios", "gauge", "Scenarios that were submitted, by whether they ended.");
    let (total, done) = state.counts();
    page.sample("socrates_scenarios", &[("state", "open")], total.saturating_sub(done));
    page.sample("socrates_scenarios", &[("state", "ended")], done);
    jobs(&mut page, state, now);
    attempts(&mut page, &state.tally);
    page.family("socrates_workers", "gauge", "Workers that beat, by stage and by what they do.");
    let workers = overview::workers(state, now);
    for stage in STAGES {
        for how in ["idle", "busy", "draining"] {
            let count = workers.get(&(stage, how)).copied().unwrap_or(0);
            page.sample("socrates_workers", &[("stage", stage.name()), ("state", how)], count);
        }
    }
    authors(&mut page, state);
    limits(&mut page, state, now);
    shell(&mut page, counted);
    page.0
}

fn jobs(page: &mut Page, state: &State, now: Millis) {
    page.family("socrates_jobs", "gauge", "Jobs in the store, by stage and state.");
    for stage in STAGES {
        for of in STATES {
            let count = state.tally.jobs.get(&(stage, of)).copied().unwrap_or(0);
            page.sample("socrates_jobs", &[("stage", stage.name()), ("state", of.name())], count);
        }
    }
    let mut by_stage = |name: &str, help: &str, of: &dyn Fn(Stage) -> String| {
        page.family(name, "gauge", help);
        for stage in STAGES {
            page.sample(name, &[("stage", stage.name())], of(stage));
        }
    };
    let dead = |stage| state.tally.jobs.get(&(stage, JobState::Dead)).copied().unwrap_or(0).to_string();
    by_stage("socrates_dead_letters", "Jobs that were given up after all their tries.", &dead);
    let waited = |stage| in_units(overview::waited_ms(state, stage, now).unwrap_or(0), 1_000);
    by_stage(
        "socrates_oldest_ready_seconds",
        "How long the job that waits the longest has waited for a worker.",
        &waited,
    );
    let paused = |stage| {
        let paused = state.paused.contains("") || state.paused_stages.contains(&stage);
        u8::from(paused).to_string()
    };
    by_stage("socrates_paused", "Whether a client holds the stage back.", &paused);
}

fn attempts(page: &mut Page, tally: &Tally) {
    // What did not happen yet is 0, so that its first time is seen as a change.
    let mut ended: BTreeMap<(Stage, AttemptEnd, Option<FailureClass>), u64> =
        STAGES.into_iter().map(|stage| ((stage, AttemptEnd::Succeeded, None), 0)).collect();
    ended.extend(tally.attempts.iter().map(|(key, count)| (*key, *count)));
    page.family(
        "socrates_attempts_total",
        "counter",
        "Attempts that ended since this start, by how and by the class of failure.",
    );
    for ((stage, end, class), count) in &ended {
        let labels = [("stage", stage.name()), ("outcome", end.name()), ("class", class_name(*class))];
        page.sample("socrates_attempts_total", &labels, count);
    }
    page.family("socrates_lease_lapses_total", "counter", "Attempts whose worker was lost since this start.");
    for stage in STAGES {
        let lapsed = ended.iter().filter(|((of, end, _), _)| *of == stage && *end == AttemptEnd::Lapsed);
        let count: u64 = lapsed.map(|(_, count)| count).sum();
        page.sample("socrates_lease_lapses_total", &[("stage", stage.name())], count);
    }
    let mut times = |name: &str, help: &str, of: &BTreeMap<Stage, Histogram>| {
        page.family(name, "histogram", help);
        for (stage, values) in of {
            page.histogram(name, &[("stage", stage.name())], values, 1_000);
        }
    };
    times("socrates_attempt_duration_seconds", "Time from the grant of an attempt to its report.", &tally.durations);
    times("socrates_queue_wait_seconds", "Time from the moment a job was ready to its grant.", &tally.waits);
    page.family("socrates_late_results_total", "counter", "Reports that came too late to count.");
    page.sample("socrates_late_results_total", &[], tally.late);
    page.family("socrates_duplicate_reports_total", "counter", "Reports that were known already.");
    page.sample("socrates_duplicate_reports_total", &[], tally.duplicates);
}

/// What authors were asked, and what that cost.
fn authors(page: &mut Page, state: &State) {
    page.family(
        "socrates_llm_tokens_total",
        "counter",
        "Tokens that authors' servers were asked with (in) and answered with (out).",
    );
    for (model, (asked, answered)) in &state.tally.tokens {
        page.sample("socrates_llm_tokens_total", &[("model", model.as_str()), ("direction", "in")], asked);
        page.sample("socrates_llm_tokens_total", &[("model", model.as_str()), ("direction", "out")], answered);
    }
    page.family(
        "socrates_llm_cost_total",
        "counter",
        "Money that authors cost, in the currency of author.prices; a model without a price has no series.",
    );
    for (model, tokens) in &state.tally.tokens {
        if let Some(price) = price_of(&state.policy.prices, model) {
            let spent = in_units(cost_of(*price, *tokens), 1_000_000);
            page.sample("socrates_llm_cost_total", &[("model", model.as_str())], spent);
        }
    }
}

/// What holds work back, and how batches share the workers.
fn limits(page: &mut Page, state: &State, now: Millis) {
    page.family(
        "socrates_circuit",
        "gauge",
        "Whether a stage hands out jobs (closed), rests because many failed (open), or tries one of them (trying).",
    );
    for stage in STAGES {
        let stands = overview::circuit(state, stage, now);
        for of in overview::CIRCUITS {
            page.sample("socrates_circuit", &[("stage", stage.name()), ("state", of)], u8::from(of == stands));
        }
    }
    let shares = overview::shares(state, now);
    page.family(
        "socrates_batch_running",
        "gauge",
        "Scenarios of which a worker holds a job, by batch: how batches share the workers.",
    );
    for share in &shares {
        let labels = [("batch", share.name.as_str()), ("priority", share.priority.name())];
        page.sample("socrates_batch_running", &labels, share.running);
    }
    page.family("socrates_batch_open", "gauge", "Scenarios that have not ended, by batch.");
    for share in &shares {
        let labels = [("batch", share.name.as_str()), ("priority", share.priority.name())];
        page.sample("socrates_batch_open", &labels, share.open);
    }
}

/// What the shell counts: questions, artifacts, commits.
fn shell(page: &mut Page, counted: &Counted) {
    page.family(
        "socrates_rpc_duration_seconds",
        "histogram",
        "Time from a question to its answer, which an acquire also spends waiting for work, a second at most.",
    );
    for (method, times) in &counted.answers_us {
        page.histogram("socrates_rpc_duration_seconds", &[("method", method)], times, 1_000_000);
    }
    page.family(
        "socrates_rpc_refusals_total",
        "counter",
        "Questions that could not be read, were refused, or have to be asked again (busy).",
    );
    for ((method, why), count) in &counted.refusals {
        page.sample("socrates_rpc_refusals_total", &[("method", method), ("reason", Refusal::name(*why))], count);
    }
    let ways = [("put", counted.put), ("get", counted.got)];
    page.family(
        "socrates_blob_bytes_total",
        "counter",
        "Bytes of artifacts that came (put) and went (get) over the bus.",
    );
    for (op, moved) in ways {
        page.sample("socrates_blob_bytes_total", &[("op", op)], moved.bytes);
    }
    page.family("socrates_blobs_total", "counter", "Artifacts that came (put) and went (get) over the bus.");
    for (op, moved) in ways {
        page.sample("socrates_blobs_total", &[("op", op)], moved.whole);
    }
    page.family("socrates_commit_duration_seconds", "histogram", "Time of a commit of the job store.");
    page.histogram("socrates_commit_duration_seconds", &[], &counted.commit_us, 1_000_000);
    page.family("socrates_commit_batch_size", "histogram", "Steps that one commit of the job store took together.");
    page.histogram("socrates_commit_batch_size", &[], &counted.commit_steps, 1);
}

#[cfg(test)]
mod tests;
