//! The heartbeat: says what is held, hears what was canceled, lost or missed.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use socrates_link::keys;
use socrates_model::wire::{Beat, BeatReply, BeatVerdict, Grant};
use tokio::sync::mpsc;
use tokio::time::{Instant, MissedTickBehavior};

use crate::held::slot_of;
use crate::messages::Worker;

/// Beats for as long as the worker lives. Grants that were missed go to `granted`.
pub(crate) async fn beats(
    worker: Arc<Worker>,
    every: Duration,
    draining: Arc<AtomicBool>,
    granted: mpsc::Sender<Vec<Grant>>,
) {
    let mut ticks = tokio::time::interval(every.max(Duration::from_millis(10)));
    ticks.set_missed_tick_behavior(MissedTickBehavior::Delay);
    loop {
        ticks.tick().await;
        worker.held.fence_late(Instant::now());
        let sent_at = Instant::now();
        let beat = Beat {
            instance: worker.config.instance.clone(),
            held: worker.held.lines(),
            draining: draining.load(Ordering::Acquire),
        };
        let reply: BeatReply = match worker.ask(keys::BEAT, "beat", &beat).await {
            Ok(reply) => reply,
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
        let missed = reply.missing;
        if draining.load(Ordering::Acquire) {
            for grant in &missed {
                worker.release(&slot_of(grant)).await;
            }
        } else if !missed.is_empty() && granted.send(missed).await.is_err() {
            return;
        }
    }
}
