//! What the orchestrator can say of itself in figures: the text format of Prometheus, base units, no label that grows with the work.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use async_trait::async_trait;
use socrates_gateway::plain::{Plain, Source};
use socrates_model::fault::FailureClass;
use socrates_model::job::Stage;
use socrates_orchestrator::tally::{Histogram, Tally};
use socrates_orchestrator::{AttemptEnd, JobState, Millis, State, overview};
use tokio::net::TcpListener;
use tokio::sync::{mpsc, oneshot};

use super::reader::Inbound;

/// Path of the figures.
const PATH: &str = "/metrics";
/// Media type of the text format.
const MEDIA: &str = "text/plain; version=0.0.4; charset=utf-8";
/// How long a collector is kept waiting.
const LIMIT: Duration = Duration::from_secs(2);
/// Upper ends of the ranges of times of a commit, µs.
const COMMIT_US: &[u64] =
    &[100, 250, 500, 1_000, 2_500, 5_000, 10_000, 25_000, 50_000, 100_000, 250_000, 1_000_000, 5_000_000];
/// Upper ends of the ranges of steps in a commit.
const COMMIT_STEPS: &[u64] = &[1, 2, 4, 8, 16, 32, 64, 128, 256];

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

/// Commits of the writer's thread, counted.
#[derive(Debug, Clone)]
pub(super) struct Commits(Arc<Mutex<(Histogram, Histogram)>>);

impl Commits {
    pub(super) fn new() -> Self {
        Self(Arc::new(Mutex::new((Histogram::new(COMMIT_US), Histogram::new(COMMIT_STEPS)))))
    }

    /// A commit of this number of steps took this long.
    pub(super) fn add(&self, took: Duration, steps: usize) {
        let mut counted = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        counted.0.add(u64::try_from(took.as_micros()).unwrap_or(u64::MAX));
        counted.1.add(u64::try_from(steps).unwrap_or(u64::MAX));
    }

    fn counted(&self) -> (Histogram, Histogram) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

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
pub(super) fn text(state: &State, now: Millis, commits: &Commits) -> String {
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
    page.family("socrates_orchestrator_epoch", "gauge", "Number of the orchestrator's reign; grows with every start.");
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
    page.family(
        "socrates_llm_tokens_total",
        "counter",
        "Tokens that authors' servers were asked with (in) and answered with (out).",
    );
    for (model, (asked, answered)) in &state.tally.tokens {
        page.sample("socrates_llm_tokens_total", &[("model", model.as_str()), ("direction", "in")], asked);
        page.sample("socrates_llm_tokens_total", &[("model", model.as_str()), ("direction", "out")], answered);
    }
    let (times, steps) = commits.counted();
    page.family("socrates_commit_duration_seconds", "histogram", "Time of a commit of the job store.");
    page.histogram("socrates_commit_duration_seconds", &[], &times, 1_000_000);
    page.family("socrates_commit_batch_size", "histogram", "Steps that one commit of the job store took together.");
    page.histogram("socrates_commit_batch_size", &[], &steps, 1);
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

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use socrates_model::wire::{Acquire, Outcome, Report, ScenarioSpec, Submit};
    use socrates_model::{Digest, Fault, FaultCode};
    use socrates_orchestrator::{Answer, Effect, Event, Policy, step};

    use super::*;

    /// Labels with their values, in order.
    type Labels = Vec<(String, String)>;
    /// A sample: name, labels, value.
    type Sample = (String, Labels, f64);

    fn is_name(text: &str) -> bool {
        let first = text.chars().next().is_some_and(|c| c.is_ascii_alphabetic() || c == '_');
        first && text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == ':')
    }

    /// `name{label="value",…} number`, as the format has it.
    fn sample(line: &str) -> Sample {
        let (name, mut rest) = line.split_at(line.find(['{', ' ']).unwrap());
        assert!(is_name(name), "{line}");
        let mut labels = Vec::new();
        if let Some(inside) = rest.strip_prefix('{') {
            rest = inside;
            while !rest.starts_with('}') {
                let (label, quoted) = rest.split_once("=\"").unwrap();
                assert!(is_name(label), "{line}");
                let (mut value, mut end) = (String::new(), None);
                let mut signs = quoted.char_indices();
                while let Some((at, sign)) = signs.next() {
                    match sign {
                        '"' => {
                            end = Some(at + 1);
                            break;
                        }
                        '\\' => match signs.next().unwrap().1 {
                            'n' => value.push('\n'),
                            other @ ('\\' | '"') => value.push(other),
                            other => panic!("`\\{other}` in {line}"),
                        },
                        other => value.push(other),
                    }
                }
                labels.push((label.to_owned(), value));
                rest = quoted[end.unwrap()..].trim_start_matches(',');
            }
            rest = &rest[1..];
        }
        let number = rest.strip_prefix(' ').unwrap();
        (name.to_owned(), labels, number.parse().unwrap_or_else(|_| panic!("`{number}` is no number: {line}")))
    }

    /// Reads a whole text as a collector does, and gives its samples; panics where it is not well formed.
    fn read(text: &str) -> Vec<Sample> {
        assert!(text.ends_with('\n'));
        let mut all: Vec<Sample> = Vec::new();
        let mut families: BTreeMap<String, String> = BTreeMap::new();
        let (mut helped, mut family, mut seen) = (None, String::new(), BTreeSet::new());
        for line in text.lines() {
            if let Some(help) = line.strip_prefix("# HELP ") {
                let (name, words) = help.split_once(' ').unwrap();
                assert!(!words.is_empty() && !families.contains_key(name), "{line}");
                helped = Some(name.to_owned());
            } else if let Some(kind) = line.strip_prefix("# TYPE ") {
                let (name, kind) = kind.split_once(' ').unwrap();
                assert_eq!(helped.take().as_deref(), Some(name), "help comes first: {line}");
                assert!(["counter", "gauge", "histogram"].contains(&kind), "{line}");
                assert_eq!(kind == "counter", name.ends_with("_total"), "{line}");
                assert!(name.starts_with("socrates_"), "{line}");
                family = name.to_owned();
                families.insert(family.clone(), kind.to_owned());
            } else {
                let found = sample(line);
                let of_family = match families[&family].as_str() {
                    "histogram" => ["_bucket", "_sum", "_count"].iter().any(|end| found.0 == format!("{family}{end}")),
                    _ => found.0 == family,
                };
                assert!(of_family, "`{line}` stands under `{family}`");
                assert!(seen.insert((found.0.clone(), found.1.clone())), "twice: {line}");
                all.push(found);
            }
        }
        for (name, _) in families.iter().filter(|(_, kind)| *kind == "histogram") {
            check_histogram(name, &all);
        }
        all
    }

    /// Ranges grow, the last is everything, and that is the count.
    fn check_histogram(name: &str, all: &[Sample]) {
        let mut series: BTreeMap<Labels, Vec<(f64, f64)>> = BTreeMap::new();
        for (_, labels, value) in all.iter().filter(|(of, ..)| *of == format!("{name}_bucket")) {
            let (le, rest): (Vec<_>, Vec<_>) = labels.iter().cloned().partition(|(label, _)| label == "le");
            let bound = if le[0].1 == "+Inf" { f64::INFINITY } else { le[0].1.parse().unwrap() };
            series.entry(rest).or_default().push((bound, *value));
        }
        for (labels, ranges) in series {
            assert!(ranges.windows(2).all(|two| two[0].0 < two[1].0 && two[0].1 <= two[1].1), "{name} {ranges:?}");
            let (last, count) = ranges[ranges.len() - 1];
            assert!(last.is_infinite(), "{name}");
            let counted = all.iter().find(|(of, own, _)| *of == format!("{name}_count") && *own == labels).unwrap();
            assert!((counted.2 - count).abs() < 0.5, "{name}");
            assert!(all.iter().any(|(of, own, _)| *of == format!("{name}_sum") && *own == labels), "{name}");
        }
    }

    fn value(all: &[Sample], name: &str, labels: &[(&str, &str)]) -> f64 {
        let same = |own: &[(String, String)]| {
            labels.iter().all(|(label, value)| own.iter().any(|(known, is)| known == label && is == value))
        };
        all.iter().find(|(of, own, _)| of == name && same(own)).unwrap_or_else(|| panic!("no {name} {labels:?}")).2
    }

    /// One scenario submitted, its first job failed once.
    fn state() -> State {
        let mut state = State::new(Policy { code_version: "9".to_owned(), ..Policy::default() });
        let spec = ScenarioSpec {
            id: "a".parse().unwrap(),
            request: Digest::of(b"r"),
            location: Digest::of(b"l"),
            reading: Digest::of(b"g"),
            seed: 1,
            planners: Vec::new(),
            run_seeds: vec![1],
            pinned: BTreeMap::new(),
            settings: BTreeMap::from([("author".to_owned(), "openai:a\"b\\c".to_owned())]),
            review: false,
            order: None,
        };
        let submit = Submit::new("b", socrates_model::wire::Priority::Normal, vec![spec]);
        step(&mut state, Event::Submit { submit, to: 0 }, 0);
        let ask = Acquire {
            req_id: "q".to_owned(),
            instance: "w".to_owned(),
            stages: vec![Stage::Proposal],
            credits: 1,
            code_version: "9".to_owned(),
        };
        let effects = step(&mut state, Event::Acquire { ask, to: 0 }, 2_500);
        let grant = effects.iter().find_map(|effect| {
            let Effect::Reply { answer, .. } = effect else { return None };
            let Answer::Acquired(socrates_model::wire::Acquired::Grants(grants)) = &**answer else { return None };
            grants.first().cloned()
        });
        let grant = grant.unwrap();
        let report = Report {
            instance: "w".to_owned(),
            key: grant.spec.key,
            attempt: grant.attempt,
            fence: grant.fence,
            outcome: Outcome::Failed {
                class: FailureClass::Transient,
                faults: vec![Fault::new(FaultCode::TNet, "x", "y")],
                retry_after_ms: None,
            },
            artifacts: Vec::new(),
            wall_ms: 1,
            tokens: (70, 30),
            remark: String::new(),
            repair: None,
            anew: Vec::new(),
            verdict: None,
            rates: None,
        };
        for _twice in 0..2 {
            step(&mut state, Event::Report { report: Box::new(report.clone()), to: 0 }, 4_000);
        }
        state
    }

    #[test]
    fn a_collector_reads_every_figure_and_none_grows_with_the_work() {
        let commits = Commits::new();
        commits.add(Duration::from_micros(300), 3);
        let text = text(&state(), 5_000, &commits);
        let all = read(&text);
        let is = |name: &str, labels: &[(&str, &str)], wanted: f64| {
            let found = value(&all, name, labels);
            assert!((found - wanted).abs() < 1e-9, "{name} {labels:?} is {found}, not {wanted}");
        };
        is("socrates_jobs", &[("stage", "proposal"), ("state", "delayed")], 1.0);
        is("socrates_jobs", &[("stage", "scoring"), ("state", "blocked")], 1.0);
        is("socrates_attempts_total", &[("stage", "proposal"), ("outcome", "failed"), ("class", "transient")], 1.0);
        is("socrates_attempts_total", &[("stage", "paths"), ("outcome", "succeeded")], 0.0);
        is("socrates_attempt_duration_seconds_sum", &[("stage", "proposal")], 1.5);
        is("socrates_queue_wait_seconds_bucket", &[("stage", "proposal"), ("le", "2.5")], 1.0);
        is("socrates_queue_wait_seconds_bucket", &[("stage", "proposal"), ("le", "1")], 0.0);
        is("socrates_duplicate_reports_total", &[], 1.0);
        is("socrates_workers", &[("stage", "proposal"), ("state", "idle")], 1.0);
        is("socrates_llm_tokens_total", &[("model", "openai:a\"b\\c"), ("direction", "in")], 70.0);
        is("socrates_commit_duration_seconds_bucket", &[("le", "0.0005")], 1.0);
        is("socrates_commit_batch_size_sum", &[], 3.0);
        is("socrates_dead_letters", &[("stage", "proposal")], 0.0);
        is("socrates_build_info", &[("version", "9")], 1.0);
        for (name, labels, _) in &all {
            let known = ["stage", "state", "outcome", "class", "le", "model", "direction", "version"];
            assert!(labels.iter().all(|(label, _)| known.contains(&label.as_str())), "{name} {labels:?}");
        }
    }

    #[test]
    fn every_figure_that_the_shipped_alerts_speak_of_is_there() {
        let rules = include_str!("../../../../deploy/prometheus/socrates.rules.yml");
        let mut state = state();
        // What was never lost or asked for has no series of its own.
        state.tally.tokens.insert("m".to_owned(), (1, 1));
        let names: BTreeSet<String> =
            read(&text(&state, 5_000, &Commits::new())).into_iter().map(|one| one.0).collect();
        let said: BTreeSet<&str> = rules
            .split(|c: char| !c.is_ascii_alphanumeric() && c != '_')
            .filter(|word| word.starts_with("socrates_"))
            .collect();
        assert!(said.len() > 7, "{said:?}");
        let missing: Vec<_> = said.into_iter().filter(|word| !names.contains(*word)).collect();
        assert_eq!(missing, [""; 0], "{names:?}");
    }

    #[test]
    fn parts_are_written_as_decimals_of_the_unit() {
        for (value, to_unit, text) in [
            (1_500, 1_000, "1.5"),
            (2_000, 1_000, "2"),
            (10, 1_000, "0.01"),
            (250, 1_000_000, "0.00025"),
            (7, 1, "7"),
            (0, 1_000, "0"),
            (10, 1, "10"),
        ] {
            assert_eq!(in_units(value, to_unit), text);
        }
    }
}
