//! The orchestrator process: the bus, the clock and the store round the pure state machine.
//!
//! ```text
//! bus ─► readers (decode, check artifacts) ─► owner (step, one task) ─► writer thread (group commit)
//!  ▲                                            ▲ presence, timers               │ durable
//!  └────────────── answers, notices, hints ◄─────────────────────────────────────┘
//! ```
//!
//! Events stand in one line before the owner; nothing of a step is seen before its rows are durable.

mod artifacts;
mod counts;
mod metrics;
mod owner;
mod past;
mod reader;
mod writer;

#[cfg(test)]
mod tests;

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use anyhow::Context as _;
use socrates_kit::{LocalBlobs, Stop};
use socrates_link::{Bus, ReignId, keys};
use socrates_orchestrator::{Event, Policy, Row, State, step};
use socrates_store::{Durability, SqliteStore, Store as _, StoreError};
use tokio::sync::{mpsc, watch};
use tokio::task::JoinSet;

use counts::Counts;
use owner::Owner;
use reader::{Disk, Inbound, Reign};

/// Events that wait for the owner at most; beyond it the readers wait, then the bus.
const LINE: usize = 1024;
/// Committed steps that wait to be told at most.
const TELLING: usize = 256;

/// Settings of an orchestrator process.
pub(crate) struct OrchestratorConfig {
    /// Folder of `jobs.sqlite` and `blobs/`; on a local disk.
    pub(crate) dir: PathBuf,
    /// Length of a lease, ms.
    pub(crate) lease_ms: u64,
    /// Pause between a worker's beats, ms.
    pub(crate) beat_ms: u64,
    /// Longest attempts of authoring, simulation and scoring, ms.
    pub(crate) deadlines_ms: (u64, u64, u64),
    /// New revisions that a scenario may have.
    pub(crate) repairs: u32,
    /// Further asks after an answer that cannot be taken.
    pub(crate) asks_again: u32,
    /// Tokens and questions that one author's server is asked for in a minute; 0 leaves it to the server.
    pub(crate) author_rates: (u64, u64),
    /// Tokens and time in ms that the authors of one scenario may take; 0 sets no limit.
    pub(crate) author_budget: (u64, u64),
    /// Money that the authors of one scenario may cost, hundredths; 0 sets no limit.
    pub(crate) cents_per_scenario: u64,
    /// Prices of a million tokens in and out by model, in millionths.
    pub(crate) prices: std::collections::BTreeMap<String, (u64, u64)>,
    /// Share of a stage's attempts above which failures in passing let it rest, percent; 0 never does.
    pub(crate) circuit_percent: u32,
    /// What a commit of the job store outlives.
    pub(crate) durability: Durability,
    /// Version that workers must have; empty takes any.
    pub(crate) code_version: String,
    /// Whether no worker of before is alive: what they held is handed out again at once.
    pub(crate) alone: bool,
    /// Whether a disk that takes nothing more is waited for, while workers keep their reports; otherwise serving ends with
    /// the reason, for whoever supervises it.
    pub(crate) waits: bool,
    /// Where figures are served; none for nowhere.
    pub(crate) metrics: Option<tokio::net::TcpListener>,
    /// Rules of an experiment, instead of those made of the values above.
    pub(crate) rules: Option<Policy>,
}

/// How long the orchestrator of a supervisor waits for the one of an earlier supervisor, which is leaving, to give up the store.
const PREDECESSOR: Duration = Duration::from_secs(5);

/// Serves until it is asked to stop or the store fails. Stopping takes no time for anybody's work: what
/// workers hold stays theirs, and the next orchestrator on this folder knows of it.
///
/// # Errors
/// When the store is in use, cannot be read or written (then nothing that was acknowledged is lost), or
/// the bus does not take the keys.
pub(crate) async fn serve(
    config: OrchestratorConfig,
    bus: Arc<dyn Bus>,
    mut shutdown: watch::Receiver<Stop>,
) -> anyhow::Result<()> {
    let (started, began_ms) = (Instant::now(), socrates_link::wall_ms());
    let blobs = LocalBlobs::new(config.dir.join("blobs"), config.durability == Durability::Disk);
    let rules = config.rules.map(|rules| Policy { code_version: config.code_version.clone(), ..rules });
    let policy = rules.unwrap_or_else(|| Policy {
        lease_ms: config.lease_ms,
        beat_ms: config.beat_ms,
        author_deadline_ms: config.deadlines_ms.0,
        simulation_deadline_ms: config.deadlines_ms.1,
        scoring_deadline_ms: config.deadlines_ms.2,
        repairs: config.repairs,
        code_version: config.code_version,
        tokens_per_scenario: config.author_budget.0,
        author_ms_per_scenario: config.author_budget.1,
        money_per_scenario: config.cents_per_scenario.saturating_mul(10_000),
        prices: config.prices,
        tokens_per_minute: config.author_rates.0,
        requests_per_minute: config.author_rates.1,
        circuit_percent: config.circuit_percent,
        ..Policy::default().asking_again(config.asks_again)
    });
    let (store, mut state, reign) = loop {
        let (at, durability, kept) = (config.dir.join("jobs.sqlite"), config.durability, blobs.clone());
        let (policy, alone) = (policy.clone(), config.alone);
        let opened = tokio::task::spawn_blocking(move || open(&at, durability, policy, &kept, alone)).await;
        match opened.context("opening the job store")? {
            Err(why) if config.alone && is_locked(&why) && started.elapsed() < PREDECESSOR => {
                tokio::time::sleep(Duration::from_millis(20)).await;
            }
            opened => break opened?,
        }
    };
    state.clock_ms = began_ms;
    let epoch = state.epoch;
    tracing::info!(epoch, scenarios = state.counts().0, "the orchestrator begins");

    let (line, inbound) = mpsc::channel::<Inbound>(LINE);
    let (committed, telling) = mpsc::channel(TELLING);
    let counts = Counts::new();
    let (writer, mut broken) = writer::start(store, committed, counts.clone()).context("starting the writer")?;
    let mut tasks = JoinSet::new();
    tasks.spawn(writer::tell(Arc::clone(&bus), epoch, telling, counts.clone()));
    // Everything is declared before the token that says so.
    for key in
        [keys::HELLO, keys::ACQUIRE, keys::BEAT, keys::REPORT, keys::RELEASE, keys::SUBMIT, keys::CONTROL, keys::STATUS]
    {
        let serving = bus.serve(key).await.with_context(|| format!("serving `{key}`"))?;
        let disk = Disk { blobs: blobs.clone(), waits: config.waits, counts: counts.clone() };
        tasks.spawn(reader::read(Arc::clone(&bus), reign.clone(), serving, line.clone(), disk));
    }
    let (parts_bus, parts, moved) = (Arc::clone(&bus), blobs.clone(), counts.clone());
    tasks.spawn(async move {
        if let Err(why) = socrates_kit::serve_blobs(parts_bus, parts, move |part| moved.moved(part)).await {
            tracing::error!(%why, "artifacts are not served over the bus");
        }
    });
    let store_file = config.dir.join("jobs.sqlite");
    let past = bus.serve(keys::PAST).await.context("serving the past")?;
    tasks.spawn(past::serve(Arc::clone(&bus), past, store_file, counts.clone()));
    let presence = bus.watch_alive(keys::WORKERS_ALIVE).await.context("watching the workers")?;
    if let Some(listener) = config.metrics {
        tasks.spawn(metrics::serve(listener, line.clone()));
    }
    tasks.spawn(reader::watch(presence, line));
    let token = bus.declare_alive(&keys::orchestrator_alive(bus.name())).await.context("showing the token")?;

    let mut owner = Owner::new(state, started, writer, counts);
    let result = tokio::select! {
        biased;
        why = &mut broken => Err(why.map_or_else(|_gone| anyhow::anyhow!("the writer of the job store has ended"), anyhow::Error::from)),
        // Nobody left who could ask is a wish to stop, too.
        _asked = shutdown.wait_for(|stop| *stop != Stop::Run) => Ok(()),
        full = owner.run(inbound) => full.map_or(Ok(()), |why| Err(why.into())),
    };
    drop(token);
    // The writer ends when its line does: what stands in it is committed and told.
    drop(owner);
    let ended = broken.await_end(result.is_ok()).await;
    tasks.shutdown().await;
    result.and(ended)
}

fn is_locked(why: &anyhow::Error) -> bool {
    why.downcast_ref::<StoreError>().is_some_and(|why| matches!(why, StoreError::Locked { .. }))
}

/// Opens the store, begins a new reign, and puts small texts back where workers look for them.
fn open(
    at: &std::path::Path,
    durability: Durability,
    policy: Policy,
    blobs: &LocalBlobs,
    alone: bool,
) -> anyhow::Result<(SqliteStore, State, Reign)> {
    let mut store = SqliteStore::open_with(at, durability)?;
    let snapshot = store.load().context("reading the job store")?;
    let id = ReignId::fresh();
    let known = store.begin(id.0).context("writing the start into the job store")?.into_iter().map(ReignId).collect();
    let reign = Reign { epoch: snapshot.epoch, id, known };
    for digest in store.texts()? {
        // Looked into, not only for: a power cut may have left a file without its content.
        if blobs.get(&digest).is_err()
            && let Some(text) = store.text(&digest)?
        {
            blobs.put(text.as_bytes()).context("putting a text back among the artifacts")?;
        }
    }
    let mut state = State::restore(snapshot, policy, 0);
    let rows: Vec<Row> = step(&mut state, Event::Recover { alone }, 0).into_iter().filter_map(owner::row).collect();
    store.save(&rows)?;
    Ok((store, state, reign))
}
