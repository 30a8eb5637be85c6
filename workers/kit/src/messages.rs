//! The worker's side of the protocol: one function per message, each repeated with backoff by its caller.

use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use serde::Serialize;
use serde::de::DeserializeOwned;
use socrates_link::{Bus, LinkError, ReignId, call_envelope, keys};
use socrates_model::job::Stage;
use socrates_model::seeds::derive_seed;
use socrates_model::wire::{Hello, Recorded, Release, Report};
use socrates_model::{Digest, TraceContext};
use tokio::sync::watch;

use crate::cache::Cache;
use crate::config::WorkerConfig;
use crate::error::KitError;
use crate::held::{Held, Slot};
use crate::spool::{KIND_REPORT, Spool};

/// Beats in a row that an orchestrator of another store has to answer before a worker leaves its reign and serves that one.
const DISOWNED: u32 = 3;

/// Everything that the tasks of one worker share.
pub(crate) struct Worker {
    pub(crate) stage: Stage,
    pub(crate) bus: Arc<dyn Bus>,
    pub(crate) config: WorkerConfig,
    pub(crate) held: Held,
    pub(crate) spool: Spool,
    /// Inputs that came over the bus.
    pub(crate) inputs: Cache,
    /// The reign that this worker serves; none before its first answer.
    reign: Mutex<Option<ReignId>>,
    /// Beats in a row that were answered by an orchestrator of another store and by none of this one's reign.
    disowned: AtomicU32,
    /// Whether the orchestrator of this reign was not told yet who this worker is.
    unknown: AtomicBool,
    /// Whether it takes no more work.
    leaving: watch::Sender<bool>,
    /// Reports made so far, for the fault plan.
    reports: AtomicU32,
}

/// Ends when the worker leaves.
pub(crate) async fn left(leaving: &mut watch::Receiver<bool>) {
    // The sender lives as long as the worker.
    drop(leaving.wait_for(|leaving| *leaving).await);
}

/// Growing pauses with jitter that is a function of the worker and the count, not of a clock.
pub(crate) struct Backoff {
    seed: u64,
    tries: u32,
}

impl Backoff {
    const FIRST_MS: u64 = 40;
    const LAST_MS: u64 = 2000;

    pub(crate) fn new(instance: &str) -> Self {
        Self { seed: Digest::of(instance.as_bytes()).seed(), tries: 0 }
    }

    /// The next pause: doubling from 40 ms to 2 s, each drawn from its upper half.
    pub(crate) fn next(&mut self) -> Duration {
        self.tries = self.tries.saturating_add(1);
        let full = Self::FIRST_MS.saturating_mul(1 << self.tries.min(10)).min(Self::LAST_MS);
        let drawn = derive_seed(self.seed, &["pause", &self.tries.to_string()]);
        Duration::from_millis(full / 2 + drawn % (full / 2 + 1))
    }

    pub(crate) fn reset(&mut self) {
        self.tries = 0;
    }
}

impl Worker {
    pub(crate) fn new(stage: Stage, bus: Arc<dyn Bus>, config: WorkerConfig) -> Result<Self, KitError> {
        let spool = Spool::open(&config.spool_dir, config.durable)?;
        Ok(Self {
            stage,
            bus,
            config,
            held: Held::default(),
            spool,
            inputs: Cache::default(),
            reign: Mutex::new(None),
            disowned: AtomicU32::new(0),
            unknown: AtomicBool::new(false),
            leaving: watch::Sender::new(false),
            reports: AtomicU32::new(0),
        })
    }

    /// Takes no more work from now on.
    pub(crate) fn leave(&self) {
        self.leaving.send_replace(true);
    }

    /// Whether it takes no more work.
    pub(crate) fn is_leaving(&self) -> bool {
        *self.leaving.borrow()
    }

    /// Tells when it takes no more work.
    pub(crate) fn leaving(&self) -> watch::Receiver<bool> {
        self.leaving.subscribe()
    }

    /// What this worker says of itself.
    pub(crate) fn introduction(&self) -> Hello {
        Hello {
            instance: self.config.instance.clone(),
            stages: vec![self.stage],
            code_version: self.config.code_version.clone(),
            pid: std::process::id(),
            host: self.config.host.clone(),
        }
    }

    /// Whether a new orchestrator answers that was not told who this worker is; the next call says no.
    pub(crate) fn take_unknown(&self) -> bool {
        self.unknown.swap(false, Ordering::AcqRel)
    }

    /// The orchestrator has to be told later who this worker is.
    pub(crate) fn stays_unknown(&self) {
        self.unknown.store(true, Ordering::Release);
    }

    fn reign(&self) -> MutexGuard<'_, Option<ReignId>> {
        self.reign.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether an answer of this reign, to a question for that one, is heard. An orchestrator answers what was asked in its own
    /// past, so another answer to a question of the reign that is served comes from the next one, which is served from now on. An
    /// answer to an older question was on its way while the reign changed.
    fn hears(&self, answered: Option<ReignId>, asked: Option<ReignId>) -> bool {
        let mut served = self.reign();
        if answered != *served {
            if asked != *served {
                return false;
            }
            if served.is_some() {
                self.stays_unknown();
            }
            *served = answered;
        }
        drop(served);
        self.disowned.store(0, Ordering::Release);
        true
    }

    /// One more beat was answered by an orchestrator that never knew the reign of this worker; whether it is to be followed. An
    /// orchestrator that is left over beside the one that reigns is not: the other's answers are heard in between.
    pub(crate) fn is_outlived(&self) -> bool {
        self.disowned.fetch_add(1, Ordering::AcqRel).saturating_add(1) >= DISOWNED
    }

    /// One message and its answer; an answer of an earlier reign counts as none.
    pub(crate) async fn ask<Req, Rep>(&self, key: &str, kind: &str, request: &Req) -> Result<Rep, LinkError>
    where
        Req: Serialize + Sync,
        Rep: DeserializeOwned,
    {
        self.ask_in(None, key, kind, request).await
    }

    /// The same as a part of a trace.
    async fn ask_in<Req, Rep>(
        &self,
        trace: Option<TraceContext>,
        key: &str,
        kind: &str,
        request: &Req,
    ) -> Result<Rep, LinkError>
    where
        Req: Serialize + Sync,
        Rep: DeserializeOwned,
    {
        let asked = *self.reign();
        let reply = call_envelope(&*self.bus, key, kind, request, (trace, asked), self.config.timeout).await?;
        if !self.hears(reply.reign, asked) {
            tracing::debug!(key, epoch = reply.epoch, "an answer of an earlier orchestrator is not heard");
            return Err(LinkError::NoReply { key: key.to_owned() });
        }
        Ok(reply.body)
    }

    /// Number of the next report, from 1.
    pub(crate) fn next_report(&self) -> u32 {
        self.reports.fetch_add(1, Ordering::Relaxed).saturating_add(1)
    }

    /// Sends a spooled report until it is recorded, then forgets it. `number` is 0 for one of an earlier process, of which the
    /// trace is not known here.
    pub(crate) async fn send_report(
        &self,
        report: &Report,
        number: u32,
        trace: Option<TraceContext>,
    ) -> Result<(), KitError> {
        let mut backoff = Backoff::new(&self.config.instance);
        let mut lose = number > 0 && self.config.faults.drop_report == Some(number);
        loop {
            let sent = if std::mem::take(&mut lose) {
                Err(LinkError::NoReply { key: keys::REPORT.to_owned() })
            } else {
                self.ask_in::<Report, Recorded>(trace, keys::REPORT, KIND_REPORT, report).await
            };
            if number > 0 && sent.is_ok() && self.config.faults.die_after_report == Some(number) {
                return Err(KitError::InjectedDeath { at: "after a report" });
            }
            match sent {
                Ok(recorded @ (Recorded::Accepted | Recorded::Duplicate | Recorded::Late)) => {
                    tracing::info!(job = %report.key, attempt = report.attempt, ?recorded, "the report is recorded");
                    let (spool, report) = (self.spool.clone(), report.clone());
                    return match tokio::task::spawn_blocking(move || spool.done(&report)).await {
                        Ok(done) => done,
                        Err(why) => Err(KitError::Folder { path: self.config.spool_dir.clone(), why: why.to_string() }),
                    };
                }
                Ok(Recorded::Busy) => tracing::debug!(job = %report.key, "the store is busy; the report is kept"),
                Err(why) if why.is_transient() => tracing::debug!(job = %report.key, %why, "the report is sent again"),
                Err(why) => {
                    tracing::warn!(job = %report.key, %why, "the report was refused; it is kept and sent again")
                }
            }
            tokio::time::sleep(backoff.next()).await;
        }
    }

    /// Hands an attempt back unharmed; tried a few times, then left to its lease.
    pub(crate) async fn release(&self, slot: &Slot) {
        let instance = self.config.instance.clone();
        let release = Release { instance, key: slot.0.clone(), attempt: slot.1, fence: slot.2 };
        let trace = self.held.entry(slot).and_then(|entry| entry.trace);
        let mut backoff = Backoff::new(&self.config.instance);
        for _try in 0..3 {
            match self.ask_in::<Release, Recorded>(trace, keys::RELEASE, "release", &release).await {
                Ok(Recorded::Accepted | Recorded::Duplicate | Recorded::Late) => return,
                Ok(Recorded::Busy) => {}
                Err(why) => tracing::debug!(job = %slot.0, %why, "handing back is tried again"),
            }
            tokio::time::sleep(backoff.next()).await;
        }
        // Costs time, loses nothing: the lease ends by itself.
        tracing::info!(job = %slot.0, attempt = slot.1, "could not be handed back; its lease will end");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pauses_grow_to_two_seconds_and_differ_between_workers() {
        let (mut a, mut b) = (Backoff::new("a"), Backoff::new("b"));
        let (first, other) = (a.next(), b.next());
        assert_ne!(first, other);
        let last = (0..20).map(|_| a.next()).last().unwrap();
        assert!(last >= Duration::from_secs(1) && last <= Duration::from_secs(2), "{last:?}");
        a.reset();
        assert!(a.next() <= Duration::from_millis(80));
    }
}
