//! Child processes: one worker, or the orchestrator.

use std::path::Path;
use std::sync::Arc;

use socrates_kit::{Blobs, FaultPlan, KitError, LocalBlobs, Stop, WorkerConfig};
use socrates_link::{Bus, Mode, ZenohBus, ZenohConfig};
use socrates_model::job::Stage;
use socrates_store::Durability;
use tokio::sync::watch;

use crate::args::{OrchestratorOptions, WorkerOptions};
use crate::config::Config;
use crate::exit::{Code, Complaint};
use crate::orchestrate::{self, OrchestratorConfig};

/// Version of the stages' code; results of another version are not reused.
pub(crate) const CODE_VERSION: &str = env!("CARGO_PKG_VERSION");

/// Serves one stage until told to leave.
pub(crate) async fn worker(config: &Config, options: &WorkerOptions) -> Result<(), Complaint> {
    let stage: Stage = options.stage.parse().map_err(|bad: socrates_model::ids::BadId| {
        Complaint::input(bad.to_string(), "`socrates cluster worker --help`")
    })?;
    let shutdown = leave(options.tied);
    let bus = client(&options.connect, &options.namespace, &format!("worker-{stage}")).await?;
    let blobs = options.blobs.as_ref().map_or(Blobs::Bus, |dir| Blobs::Local(LocalBlobs::new(dir, false)));
    let mut settings = WorkerConfig::new(blobs, &options.spool, CODE_VERSION);
    settings.faults = FaultPlan::parse(&options.inject)
        .map_err(|why| Complaint::input(why.to_string(), "for example --inject die_before_report=2"))?;
    settings.host = host();
    // A worker that leaves with its supervisor shares the machine with whoever records its reports.
    settings.durable = !options.tied;
    if stage == Stage::Simulation && config.text("stream.live") != "off" {
        // Control and stream never share a session, so that a frozen viewer stalls no job.
        settings.live = Some(client(&options.connect, &options.namespace, "stream").await?);
    }
    let keys = crate::authors::keys(config)?;
    let live = settings.live.clone();
    let served = match stage {
        Stage::Proposal => {
            socrates_kit::serve(socrates_proposal::ProposalStage::new(keys), bus.clone(), settings, shutdown).await
        }
        Stage::Paths => {
            socrates_kit::serve(socrates_paths::PathsStage::new(keys), bus.clone(), settings, shutdown).await
        }
        Stage::Behaviors => {
            socrates_kit::serve(socrates_behaviors::BehaviorsStage::new(keys), bus.clone(), settings, shutdown).await
        }
        Stage::Simulation => {
            socrates_kit::serve(socrates_simulation::Simulation, bus.clone(), settings, shutdown).await
        }
        Stage::Scoring => socrates_kit::serve(socrates_scoring::ScoringStage, bus.clone(), settings, shutdown).await,
        Stage::Review => {
            return Err(Complaint::input(
                "a review is done by a person: `socrates run --ask`",
                "stages of workers: proposal, paths, behaviors, simulation, scoring",
            ));
        }
    };
    if let Some(live) = live {
        live.close().await;
    }
    bus.close().await;
    if let Err(KitError::InjectedDeath { .. }) = served {
        // An experiment asked for this death: as sudden as kill -9, without any farewell.
        std::process::abort();
    }
    served.map_err(|why| Complaint::input(format!("the {stage} worker stops: {why}"), "").with_code(Code::Ours))
}

/// Runs the orchestrator until told to leave.
pub(crate) async fn orchestrator(config: &Config, options: &OrchestratorOptions) -> Result<(), Complaint> {
    let bus: Arc<dyn Bus> = match (&options.listen, &options.connect) {
        (Some(listen), None) => {
            let settings = ZenohConfig::new(Mode::Router, &options.namespace, "orchestrator").listen(listen);
            let opened = ZenohBus::open(settings).await;
            Arc::new(opened.map_err(|why| {
                Complaint::input(
                    format!("cannot listen on `{listen}`: {why}"),
                    "another port, or end the program that has it",
                )
            })?)
        }
        (None, Some(connect)) => client(connect, &options.namespace, "orchestrator").await?,
        (Some(_), Some(_)) | (None, None) => {
            return Err(Complaint::input(
                "give either --listen or --connect",
                "for example `socrates cluster up --dir jobs --listen tcp/0.0.0.0:7447`",
            ));
        }
    };
    let settings = OrchestratorConfig {
        dir: options.dir.clone(),
        lease_ms: config.number("orchestrator.lease_ms").clamp(1_000, 600_000),
        beat_ms: config.number("orchestrator.beat_ms").clamp(100, 200_000),
        repairs: u32::try_from(config.number("orchestrator.repairs")).unwrap_or(3).min(10),
        asks_again: u32::try_from(config.number("orchestrator.asks_again")).unwrap_or(3).min(10),
        author_rates: (config.number("author.tokens_per_minute"), config.number("author.requests_per_minute")),
        author_budget: (
            config.number("orchestrator.tokens_per_scenario"),
            config.number("orchestrator.author_s_per_scenario").saturating_mul(1_000),
        ),
        cents_per_scenario: config.number("orchestrator.cents_per_scenario"),
        prices: crate::cost::prices_of(config)?,
        durability: if options.durable == "process" { Durability::Process } else { Durability::Disk },
        code_version: CODE_VERSION.to_owned(),
    };
    let served = orchestrate::serve(settings, bus.clone(), leave(options.tied)).await;
    bus.close().await;
    served.map_err(|why| {
        Complaint::input(
            format!("the orchestrator stops: {why:#}"),
            format!("the jobs are kept in `{}`", options.dir.display()),
        )
        .with_code(Code::Ours)
    })
}

/// A client of a router.
pub(crate) async fn client(endpoint: &str, namespace: &str, name: &str) -> Result<Arc<dyn Bus>, Complaint> {
    let bus = ZenohBus::open(ZenohConfig::new(Mode::Client, namespace, name).connect(endpoint)).await;
    let bus = bus.map_err(|why| {
        Complaint::input(
            format!("cannot connect to `{endpoint}`: {why}"),
            "is `socrates run` or `socrates cluster up` running there?",
        )
    })?;
    Ok(Arc::new(bus))
}

/// Turns SIGTERM, SIGINT and, for children of a supervisor, the end of standard input into a wish to leave.
fn leave(tied: bool) -> watch::Receiver<Stop> {
    let (wish, shutdown) = watch::channel(Stop::Run);
    let wish = Arc::new(wish);
    if tied {
        let wish = wish.clone();
        // Nothing is ever written to a child's standard input: reading it ends when its supervisor does.
        drop(tokio::task::spawn_blocking(move || {
            drop(std::io::copy(&mut std::io::stdin(), &mut std::io::sink()));
            wish.send_replace(Stop::Now);
        }));
    }
    drop(tokio::spawn(async move {
        use tokio::signal::unix::{SignalKind, signal};
        let (Ok(mut term), Ok(mut int)) = (signal(SignalKind::terminate()), signal(SignalKind::interrupt())) else {
            return;
        };
        let mut asked = 0;
        loop {
            tokio::select! {
                _ = term.recv() => {}
                _ = int.recv() => {}
            }
            asked += 1;
            wish.send_replace(if asked == 1 { Stop::Drain } else { Stop::Now });
        }
    }));
    shutdown
}

fn host() -> String {
    std::fs::read_to_string(Path::new("/proc/sys/kernel/hostname"))
        .map(|name| name.trim().to_owned())
        .unwrap_or_default()
}
