//! The loop of a worker.

use std::sync::Arc;
use std::time::Duration;

use socrates_link::{Bus, Overflow, Subscription, keys};
use socrates_model::wire::{Acquire, Acquired, Grant, Hello, NoWork, Welcome};
use tokio::sync::{mpsc, watch};
use tokio::task::JoinSet;

use crate::attempt::attempt;
use crate::beat::beats;
use crate::config::{Stop, WorkerConfig};
use crate::error::KitError;
use crate::held::slot_of;
use crate::messages::{Backoff, Worker, left};
use crate::stage::Stage;

/// Longest pause that an orchestrator may ask for between two asks for work.
const LONGEST_PAUSE: Duration = Duration::from_secs(10);
/// Time for handing back and for the last reports.
const LAST_REPORTS: Duration = Duration::from_secs(2);

/// Serves a stage until it is asked to stop: says hello, shows its presence token, asks for work, does it,
/// reports it. Reports left by an earlier process with the same spool are sent first.
///
/// Where an orchestrator of another store answers in the place of the one that was served, or of an older copy of its store, nothing
/// that is held has a job there: it is dropped, and the worker begins as a new one, with an instance of its own.
///
/// # Errors
/// [`KitError`] when the worker cannot begin, or dies as its fault plan asks.
pub async fn serve<S: Stage>(
    stage: S,
    bus: Arc<dyn Bus>,
    mut config: WorkerConfig,
    mut shutdown: watch::Receiver<Stop>,
) -> Result<(), KitError> {
    let stage = Arc::new(stage);
    loop {
        let worker = Worker::new(S::STAGE, Arc::clone(&bus), config.clone())?;
        match serve_store(Arc::clone(&stage), Arc::new(worker), &mut shutdown).await? {
            Departure::Asked => return Ok(()),
            Departure::OtherStore => {
                tracing::warn!(
                    worker = config.instance,
                    "an orchestrator of another job store, or of an older copy, answers: what was held is dropped, and it is served"
                );
                config.instance = uuid::Uuid::new_v4().to_string();
            }
        }
    }
}

/// Why a store is served no longer.
enum Departure {
    /// The worker was asked to stop.
    Asked,
    /// An orchestrator of another store answers.
    OtherStore,
}

/// Serves the orchestrators of one store, one after another.
async fn serve_store<S: Stage>(
    stage: Arc<S>,
    worker: Arc<Worker>,
    shutdown: &mut watch::Receiver<Stop>,
) -> Result<Departure, KitError> {
    let leftovers = worker.spool.leftovers()?;
    let welcomed = tokio::select! {
        biased;
        () = stopping(shutdown) => return Ok(Departure::Asked),
        welcomed = hello(&worker) => welcomed,
    };
    let beat_every = welcomed?;
    let hints = worker.bus.subscribe(&keys::hint(S::STAGE), 16, Overflow::DropOldest).await?;
    let token = worker.bus.declare_alive(&keys::worker_alive(S::STAGE, &worker.config.instance)).await?;
    let (granted, mut grants) = mpsc::channel::<Vec<Grant>>(16);

    // Tasks that end with this function, whatever happens.
    let mut service = JoinSet::new();
    service.spawn(beats(Arc::clone(&worker), beat_every, granted.clone()));
    let mut asking = JoinSet::new();
    asking.spawn(asks(Arc::clone(&worker), hints, granted));
    let mut attempts: JoinSet<Result<(), KitError>> = JoinSet::new();
    let replay = Arc::clone(&worker);
    attempts.spawn(async move {
        for report in leftovers {
            replay.send_report(&report, 0, None).await?;
        }
        Ok(())
    });

    loop {
        tokio::select! {
            biased;
            () = stopping(shutdown) => break,
            Some(_ended) = service.join_next() => {
                // Stages that block look for it; the others end where they wait.
                worker.held.stop_all();
                attempts.shutdown().await;
                return Ok(Departure::OtherStore);
            }
            Some(ended) = attempts.join_next() => settled(ended)?,
            Some(batch) = grants.recv() => {
                for grant in batch {
                    if grant.spec.key.stage != S::STAGE {
                        tracing::warn!(job = %grant.spec.key, "a job of another stage was granted and is handed back");
                        let slot = slot_of(&grant);
                        worker.release(&slot).await;
                        worker.held.end(&slot);
                    } else if worker.held.take(&grant) {
                        attempts.spawn(attempt(Arc::clone(&worker), Arc::clone(&stage), grant));
                    }
                }
            }
        }
    }
    worker.leave();
    finish(&worker, &mut attempts, &mut grants, shutdown).await?;
    hand_back(&worker, &mut attempts, &mut asking, &mut grants).await?;
    service.shutdown().await;
    drop(token);
    Ok(Departure::Asked)
}

/// Ends when the worker is asked to stop, or nobody is left who could ask.
async fn stopping(shutdown: &mut watch::Receiver<Stop>) {
    drop(shutdown.wait_for(|stop| *stop != Stop::Run).await);
}

fn settled(ended: Result<Result<(), KitError>, tokio::task::JoinError>) -> Result<(), KitError> {
    match ended {
        Ok(result) => result,
        Err(why) => {
            // The stage itself cannot get here: its panics end in a report.
            tracing::error!(%why, "a task of the worker broke");
            Ok(())
        }
    }
}

/// Says hello until it is welcomed; gives the pause between beats.
async fn hello(worker: &Worker) -> Result<Duration, KitError> {
    let hello = worker.introduction();
    let mut backoff = Backoff::new(&worker.config.instance);
    loop {
        match worker.ask::<Hello, Welcome>(keys::HELLO, "hello", &hello).await {
            Ok(Welcome::Welcome { beat_ms, .. }) => return Ok(Duration::from_millis(beat_ms)),
            Ok(Welcome::Incompatible { range }) => {
                return Err(KitError::incompatible(&worker.config.code_version, &range));
            }
            Err(why) if why.is_transient() => {
                tracing::debug!(%why, "no orchestrator yet");
                tokio::time::sleep(backoff.next()).await;
            }
            Err(why) => return Err(why.into()),
        }
    }
}

/// Asks for work whenever a place is free, until the worker leaves. A lost answer is asked for again under the same id; an
/// answer that is on its way is waited for, so that no grant comes after the last was handed back.
async fn asks(worker: Arc<Worker>, mut hints: Subscription, granted: mpsc::Sender<Vec<Grant>>) {
    let mut backoff = Backoff::new(&worker.config.instance);
    let mut leaving = worker.leaving();
    loop {
        let credits = tokio::select! {
            biased;
            () = left(&mut leaving) => return,
            free = worker.held.wait_free(worker.config.slots.max(1)) => free,
        };
        let acquire = Acquire {
            req_id: uuid::Uuid::new_v4().to_string(),
            instance: worker.config.instance.clone(),
            stages: vec![worker.stage],
            credits,
            code_version: worker.config.code_version.clone(),
        };
        let answer = loop {
            // Hints that came before this ask are answered by it.
            while hints.try_next().is_some() {}
            match worker.ask::<Acquire, Acquired>(keys::ACQUIRE, "acquire", &acquire).await {
                Ok(answer) => break answer,
                Err(why) => {
                    if why.is_transient() {
                        tracing::debug!(%why, "asking for work is tried again");
                    } else {
                        tracing::warn!(%why, "asking for work was refused and is tried again");
                    }
                    tokio::select! {
                        () = left(&mut leaving) => return,
                        () = tokio::time::sleep(backoff.next()) => {}
                    }
                }
            }
        };
        backoff.reset();
        match answer {
            Acquired::Grants(grants) if !grants.is_empty() => {
                let slots: Vec<_> = grants.iter().map(slot_of).collect();
                if granted.send(grants).await.is_err() {
                    return;
                }
                // Asking again before the places are taken would ask for too much.
                tokio::select! {
                    () = left(&mut leaving) => return,
                    () = worker.held.wait_seen(&slots) => {}
                }
            }
            Acquired::Grants(_none) => pause(&worker, &mut hints, &mut leaving, Duration::ZERO).await,
            Acquired::None { retry_after_ms, reason } => {
                tracing::trace!(?reason, "no work");
                // Only an empty queue may be cut short by the poll period: whoever is throttled waits as told.
                let told = Duration::from_millis(retry_after_ms).min(LONGEST_PAUSE);
                let told = if reason == NoWork::Empty { told.min(worker.config.poll) } else { told };
                pause(&worker, &mut hints, &mut leaving, told).await;
            }
        }
    }
}

/// Waits for a hint, the pause asked for, or the poll period where none was; not longer than the worker stays.
async fn pause(worker: &Worker, hints: &mut Subscription, leaving: &mut watch::Receiver<bool>, told: Duration) {
    let pause = if told.is_zero() { worker.config.poll } else { told };
    tokio::select! {
        () = left(leaving) => {}
        _hint = hints.next() => {}
        () = tokio::time::sleep(pause) => {}
    }
}

/// Finishes what fits the drain time; nothing where the worker has to stop now.
async fn finish(
    worker: &Arc<Worker>,
    attempts: &mut JoinSet<Result<(), KitError>>,
    grants: &mut mpsc::Receiver<Vec<Grant>>,
    shutdown: &mut watch::Receiver<Stop>,
) -> Result<(), KitError> {
    let limit = tokio::time::sleep(worker.config.drain);
    tokio::pin!(limit);
    loop {
        let now = async {
            if shutdown.wait_for(|stop| *stop == Stop::Now).await.is_err() {
                // Nobody can ask for more haste any longer.
                std::future::pending::<()>().await;
            }
        };
        tokio::select! {
            biased;
            () = now => return Ok(()),
            () = &mut limit => return Ok(()),
            Some(ended) = attempts.join_next() => settled(ended)?,
            Some(batch) = grants.recv() => release(worker, &batch).await,
            () = worker.held.wait_empty() => return Ok(()),
        }
    }
}

/// Hands back what is left, each with an answer of the orchestrator, and gives the last reports a moment. The asking for
/// work has to end as well: its last answer may grant what was just handed back.
async fn hand_back(
    worker: &Arc<Worker>,
    attempts: &mut JoinSet<Result<(), KitError>>,
    asking: &mut JoinSet<()>,
    grants: &mut mpsc::Receiver<Vec<Grant>>,
) -> Result<(), KitError> {
    worker.held.stop_all();
    let last = async {
        while !(attempts.is_empty() && asking.is_empty()) {
            tokio::select! {
                Some(batch) = grants.recv() => release(worker, &batch).await,
                Some(ended) = attempts.join_next() => settled(ended)?,
                Some(_ended) = asking.join_next() => {}
            }
        }
        while let Ok(batch) = grants.try_recv() {
            release(worker, &batch).await;
        }
        Ok(())
    };
    match tokio::time::timeout(LAST_REPORTS, last).await {
        Ok(result) => result,
        Err(_elapsed) => {
            tracing::info!("some reports are not recorded; they stay in the spool");
            Ok(())
        }
    }
}

async fn release(worker: &Worker, grants: &[Grant]) {
    for grant in grants {
        worker.release(&slot_of(grant)).await;
    }
}
