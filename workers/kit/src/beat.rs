//! The heartbeat: says what is held, hears what was canceled, lost or missed.

use std::sync::Arc;
use std::time::Duration;

use socrates_link::{LinkError, keys};
use socrates_model::wire::{Beat, BeatReply, BeatVerdict, Grant, Hello, Welcome};
use tokio::sync::mpsc;
use tokio::time::{Instant, MissedTickBehavior};

use crate::error::KitError;
use crate::held::slot_of;
use crate::messages::{Worker, left};

/// Beats until the reign of this worker is over and an orchestrator of another store answers in its place. Grants that were missed
/// go to `granted`.
pub(crate) async fn beats(worker: Arc<Worker>, every: Duration, granted: mpsc::Sender<Vec<Grant>>) {
    let mut ticks = tokio::time::interval(every.max(Duration::from_millis(10)));
    ticks.set_missed_tick_behavior(MissedTickBehavior::Delay);
    let mut leaving = worker.leaving();
    loop {
        // Who leaves says so at once: then it is given no more work.
        let told = worker.is_leaving();
        tokio::select! {
            _tick = ticks.tick() => {}
            () = left(&mut leaving), if !told => {}
        }
        worker.held.fence_late(Instant::now());
        let sent_at = Instant::now();
        let beat =
            Beat { instance: worker.config.instance.clone(), held: worker.held.lines(), draining: worker.is_leaving() };
        let reply: BeatReply = match worker.ask(keys::BEAT, "beat", &beat).await {
            Ok(reply) => reply,
            Err(LinkError::OtherReign { .. }) if worker.is_outlived() && !worker.is_leaving() => return,
            Err(why) => {
                tracing::debug!(%why, "a beat did not come through");
                continue;
            }
        };
        for (key, attempt, verdict) in reply.verdicts {
            match verdict {
                BeatVerdict::Ok => worker.held.confirm(&key, attempt, sent_at),
                BeatVerdict::Cancel | BeatVerdict::Lost => {
                    tracing::info!(job = %key, attempt, ?verdict, "is to be stopped");
                    worker.held.stop(&key, attempt);
                }
            }
        }
        if worker.take_unknown() {
            introduce(&worker).await;
        }
        let missed = reply.missing;
        if worker.is_leaving() {
            for grant in &missed {
                worker.release(&slot_of(grant)).await;
            }
        } else if !missed.is_empty() && granted.send(missed).await.is_err() {
            return;
        }
    }
}

/// Says hello to an orchestrator that was started after this worker: it knows of beats and leases, but not who they are of.
async fn introduce(worker: &Worker) {
    match worker.ask::<Hello, Welcome>(keys::HELLO, "hello", &worker.introduction()).await {
        Ok(Welcome::Welcome { .. }) => {}
        Ok(Welcome::Incompatible { range }) => {
            let why = KitError::incompatible(&worker.config.code_version, &range);
            tracing::warn!(%why, "a new orchestrator gives this worker no work");
        }
        Err(why) => {
            tracing::debug!(%why, "the hello to a new orchestrator is tried again");
            worker.stays_unknown();
        }
    }
}
