//! A part of an experiment on processes: its orchestrator with the policy of a cell, or a worker whose author is simulated.
//!
//! What becomes of an attempt is asked of the same function that a simulated worker asks ([`Fates`]); a worker waits for as long as
//! that says, and tells its parent on standard output when it begins, when something is to be done to it, and when it is done.

use std::future::pending;
use std::io::Write as _;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use socrates_experiment::draws::At;
use socrates_experiment::spec::{Cell, Spec};
use socrates_experiment::{Crash, Fate, Fates, Kind, Outcome, Told, number};
use socrates_kit::{Blobs, Done, Failure, Job, Output, Stage, WorkerConfig, media};
use socrates_link::rules::Role as Part;
use socrates_link::wall_ms;
use socrates_model::job::{JobKey, Stage as StageName};
use socrates_model::{FailureClass, Fault, FaultCode, Role, Verdict, Where};
use tokio::time::sleep;

use crate::config::Config;
use crate::exit::{Code, Diagnostic};
use crate::output::Printer;
use crate::process::{self, Durability, OrchestratorOptions};
use crate::work;

/// Setting of every job: the wall time at which the batch was submitted, ms since 1970.
pub(super) const SINCE: &str = "since_ms";
/// How often one that is to be stopped looks whether it was.
const LOOK: Duration = Duration::from_millis(5);
/// How long one that is to be stopped waits for it, beyond the stop itself.
const PATIENCE: Duration = Duration::from_secs(5);
/// How long before and after its report a worker has the orchestrator killed: longer than the signal takes, and a commit.
const ASIDE: Duration = Duration::from_millis(40);
/// How what a wrong answer made begins, where no check found it.
const WRONG: &str = "wrong";

/// Which part, and where.
#[derive(Debug, Clone)]
pub struct PlayOptions {
    /// Stage of a worker; none for the orchestrator.
    pub stage: Option<String>,
    /// The experiment with every value.
    pub spec: PathBuf,
    /// Number of the cell.
    pub cell: usize,
    /// Endpoint of the router.
    pub connect: String,
    /// Folder of the job store and the artifacts.
    pub dir: PathBuf,
    /// Name of a worker among those of its stage.
    pub name: String,
}

/// Plays the part until the parent closes standard input.
///
/// # Errors
/// A specification that has no such cell, no such part, no router, a store that cannot be used.
pub async fn play(talk: &Printer, config: &Config, options: &PlayOptions) -> Result<(), Diagnostic> {
    let spec = super::load(&options.spec, None)?;
    let Some(cell) = spec.cells().into_iter().nth(options.cell) else {
        return Err(Diagnostic::input(
            format!("the experiment has no cell {}", options.cell),
            "cells are numbered from 0",
        ));
    };
    let Some(stage) = &options.stage else {
        let rules = cell.policy.of_orchestrator(cell.tries, spec.times_ms.timeout);
        let settings = OrchestratorOptions {
            dir: options.dir.clone(),
            listen: None,
            insecure: false,
            connect: Some(options.connect.clone()),
            namespace: super::processes::NAMESPACE.to_owned(),
            durable: Durability::Process,
            metrics: None,
            tied: true,
            alone: false,
            rules: Some(rules),
        };
        return process::orchestrator(talk, config, &settings).await;
    };
    let stage: StageName = stage.parse().map_err(|bad: socrates_model::ids::BadId| {
        Diagnostic::input(bad.to_string(), "stages: proposal, paths, behaviors, simulation, scoring")
    })?;
    let author = Author { spec, cell };
    match StageName::WORKERS.iter().position(|one| *one == stage) {
        Some(0) => worker(config, options, Acted::<0>(author)).await,
        Some(1) => worker(config, options, Acted::<1>(author)).await,
        Some(2) => worker(config, options, Acted::<2>(author)).await,
        Some(3) => worker(config, options, Acted::<3>(author)).await,
        _ => worker(config, options, Acted::<4>(author)).await,
    }
}

async fn worker(config: &Config, options: &PlayOptions, stage: impl Stage) -> Result<(), Diagnostic> {
    let shutdown = process::leave(true);
    let connected = process::client(config, Part::Worker, &options.connect, super::processes::NAMESPACE, &options.name);
    let bus = connected.await.map_err(|why| why.with_code(Code::Ours))?;
    let blobs = Blobs::Local(work::blobs(&options.dir));
    let spool = options.dir.join("spool").join(&options.name);
    let mut settings = WorkerConfig::new(blobs, spool, process::CODE_VERSION);
    settings.host = process::host();
    settings.durable = false;
    settings.waits_for_disk = false;
    let served = socrates_kit::serve(stage, bus.clone(), settings, shutdown).await;
    bus.close().await;
    served
        .map_err(|why| Diagnostic::input(format!("the {} worker stops: {why}", options.name), "").with_code(Code::Ours))
}

/// Tells the parent; one that is gone is told nothing.
#[expect(clippy::print_stdout, reason = "the parent reads it line by line")]
fn tell(told: &Told) {
    if let Ok(line) = serde_json::to_string(told) {
        println!("{line}");
        drop(std::io::stdout().flush());
    }
}

/// What a worker goes by.
struct Author {
    spec: Spec,
    cell: Cell,
}

/// A stage that does as a fate says.
struct Acted<const N: usize>(Author);

impl<const N: usize> Stage for Acted<N> {
    #[expect(clippy::indexing_slicing, reason = "looked up while the program is built")]
    const STAGE: StageName = StageName::WORKERS[N];

    async fn run(&self, job: &Job) -> Result<Done, Failure> {
        let Author { spec, cell } = &self.0;
        let (grant, key) = (job.grant(), &job.spec().key);
        let Some(scenario) = number(&key.scenario) else {
            let fault = Fault::new(FaultCode::JSpec, Where::default(), "the scenario is none of the experiment");
            return Err(Failure::new(FailureClass::Poison, vec![fault]));
        };
        let at = At { scenario, stage: key.stage, revision: key.revision, attempt: grant.attempt };
        let since: Option<u64> = job.setting(SINCE).and_then(|since| since.parse().ok());
        let begun_ms = since.map_or(0, |since| wall_ms().saturating_sub(since));
        let fates = Fates { spec, cell };
        let fate = fates.of(job.spec(), at, begun_ms);
        let (key, attempt) = (key.clone(), grant.attempt);
        let strikes = move |key: &JobKey, kind: Kind| tell(&Told::Strikes { key: key.clone(), attempt, kind });
        tell(&Told::Begins { key: key.clone(), attempt, due: fates.due(&fate).collect(), tokens: fate.tokens });
        if fate.frozen {
            strikes(&key, Kind::WorkerFreeze);
            frozen(Duration::from_millis(spec.times_ms.cut)).await;
        }
        if let Some(ms) = fate.dies_ms {
            sleep(Duration::from_millis(ms)).await;
            strikes(&key, Kind::WorkerKill);
            return pending().await;
        }
        sleep(Duration::from_millis(fate.works_ms)).await;
        let (fails, unseen) = (fate.outcome.kind(), fate.outcome == Outcome::Unseen);
        tell(&Told::Ends { key: key.clone(), attempt, fails, unseen });
        match fate.crash {
            Some(Crash::BeforeCommit) => {
                strikes(&key, Kind::OrchestratorKill);
                sleep(ASIDE).await;
            }
            Some(Crash::AfterCommit) => drop(tokio::spawn(async move {
                sleep(ASIDE).await;
                strikes(&key, Kind::OrchestratorKill);
            })),
            None => {}
        }
        ended(job, &fate, spec)
    }
}

/// Waits until this process was stopped and goes on, which shows as a pause much longer than was asked for.
async fn frozen(cut: Duration) {
    let begun = Instant::now();
    while begun.elapsed() < cut + PATIENCE {
        let looked = Instant::now();
        sleep(LOOK).await;
        if looked.elapsed() > cut / 2 {
            return;
        }
    }
}

/// What is reported of an attempt that came to its end.
fn ended(job: &Job, fate: &Fate, spec: &Spec) -> Result<Done, Failure> {
    let (key, fence) = (&job.spec().key, job.grant().fence);
    let [asked, answered] = fate.tokens;
    if let Some((class, fault)) = fate.outcome.failure() {
        let wish_ms = Some(spec.times_ms.retry_after).filter(|ms| *ms > 0 && fate.outcome == Outcome::Overload);
        let failure = Failure::new(class, vec![fault]).tokens((asked, answered)).retry_after(wish_ms);
        // What was refused lies beside the report, so that the author can be shown it.
        return Err(match fate.outcome.answered() {
            Some(_) => failure.with(Output::text(Role::Refused, media::TEXT, format!("refused {fence}"))),
            None => failure,
        });
    }
    let begins = if fate.outcome == Outcome::Unseen { WRONG } else { "right" };
    let made = Role::made_by(key.stage).map(|role| Output::text(role, media::TEXT, format!("{begins} {key} {fence}")));
    let is_wrong = |role: &Role| job.bytes(*role).is_ok_and(|bytes| bytes.starts_with(WRONG.as_bytes()));
    let wrong = Role::PINNED.iter().any(|role| job.has(*role) && is_wrong(role));
    let verdict =
        (key.stage == StageName::Scoring).then_some(if wrong { Verdict::Contradicted } else { Verdict::Realised });
    Ok(Done { verdict, tokens: (asked, answered), ..Done::with(made.into_iter().collect()) })
}
