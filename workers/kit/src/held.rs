//! Attempts that this worker holds, and the lease clock of each.

use std::collections::{BTreeMap, VecDeque};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use socrates_model::TraceContext;
use socrates_model::job::JobKey;
use socrates_model::wire::{Grant, Held as HeldLine};
use tokio::sync::Notify;
use tokio::time::Instant;

use crate::cancel::Cancel;

/// One attempt: job, number, fence.
pub(crate) type Slot = (JobKey, u32, u64);

/// The attempt of a grant.
pub(crate) fn slot_of(grant: &Grant) -> Slot {
    (grant.spec.key.clone(), grant.attempt, grant.fence)
}

/// Share of the lease after which a worker without a beat fences itself: before the orchestrator gives the job away.
const FENCE_SHARE: f64 = 0.8;
/// Ended attempts that are remembered, so that a late `missing` does not run one twice.
const REMEMBERED: usize = 512;

/// An attempt that is held.
#[derive(Clone)]
pub(crate) struct Entry {
    /// Its cancel token.
    pub(crate) cancel: Cancel,
    /// Characters that its author has written so far.
    pub(crate) characters: Arc<AtomicU64>,
    /// Where it stands in its trace.
    pub(crate) trace: Option<TraceContext>,
    lease: Duration,
    last_ok: Instant,
    running: bool,
}

/// All of them.
#[derive(Default)]
pub(crate) struct Held {
    table: Mutex<Table>,
    changed: Notify,
}

#[derive(Default)]
struct Table {
    entries: BTreeMap<Slot, Entry>,
    ended: VecDeque<Slot>,
}

impl Held {
    fn table(&self) -> MutexGuard<'_, Table> {
        self.table.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes a grant; `false` when it is held or was done already.
    pub(crate) fn take(&self, grant: &Grant) -> bool {
        let slot = slot_of(grant);
        let mut table = self.table();
        if table.entries.contains_key(&slot) || table.ended.contains(&slot) {
            return false;
        }
        let entry = Entry {
            cancel: Cancel::new(),
            characters: Arc::default(),
            trace: grant.traceparent,
            lease: Duration::from_millis(grant.lease_ms),
            last_ok: Instant::now(),
            running: true,
        };
        table.entries.insert(slot, entry);
        drop(table);
        self.changed.notify_waiters();
        true
    }

    /// The entry of an attempt.
    pub(crate) fn entry(&self, slot: &Slot) -> Option<Entry> {
        self.table().entries.get(slot).cloned()
    }

    /// The stage is through with it; only the report is open. Its place is free again.
    pub(crate) fn worked(&self, slot: &Slot) {
        if let Some(entry) = self.table().entries.get_mut(slot) {
            entry.running = false;
        }
        self.changed.notify_waiters();
    }

    /// The attempt is over.
    pub(crate) fn end(&self, slot: &Slot) {
        let mut table = self.table();
        table.entries.remove(slot);
        if table.ended.len() >= REMEMBERED {
            table.ended.pop_front();
        }
        table.ended.push_back(slot.clone());
        drop(table);
        self.changed.notify_waiters();
    }

    /// Places free of `slots`.
    pub(crate) fn free(&self, slots: u32) -> u32 {
        let running = self.table().entries.values().filter(|entry| entry.running).count();
        slots.saturating_sub(u32::try_from(running).unwrap_or(u32::MAX))
    }

    /// Waits until a place is free; gives how many are.
    pub(crate) async fn wait_free(&self, slots: u32) -> u32 {
        loop {
            let changed = self.changed.notified();
            tokio::pin!(changed);
            // Registered before the look, so that no change is missed.
            changed.as_mut().enable();
            let free = self.free(slots);
            if free > 0 {
                return free;
            }
            changed.await;
        }
    }

    fn seen(&self, slots: &[Slot]) -> bool {
        let table = self.table();
        slots.iter().all(|slot| table.entries.contains_key(slot) || table.ended.contains(slot))
    }

    /// Waits until each of these was taken or is over.
    pub(crate) async fn wait_seen(&self, slots: &[Slot]) {
        loop {
            let changed = self.changed.notified();
            tokio::pin!(changed);
            changed.as_mut().enable();
            if self.seen(slots) {
                return;
            }
            changed.await;
        }
    }

    /// Waits until nothing is held.
    pub(crate) async fn wait_empty(&self) {
        loop {
            let changed = self.changed.notified();
            tokio::pin!(changed);
            changed.as_mut().enable();
            if self.table().entries.is_empty() {
                return;
            }
            changed.await;
        }
    }

    /// What a beat says.
    pub(crate) fn lines(&self) -> Vec<HeldLine> {
        let line = |(slot, entry): (&Slot, &Entry)| HeldLine {
            key: slot.0.clone(),
            attempt: slot.1,
            fence: slot.2,
            characters: entry.characters.load(Ordering::Relaxed),
        };
        self.table().entries.iter().map(line).collect()
    }

    /// Stops every attempt that still runs.
    pub(crate) fn stop_all(&self) {
        for entry in self.table().entries.values().filter(|entry| entry.running) {
            entry.cancel.stop();
        }
    }

    /// The lease of an attempt was confirmed by a beat sent at `at`.
    pub(crate) fn confirm(&self, key: &JobKey, attempt: u32, at: Instant) {
        for (slot, entry) in &mut self.table().entries {
            if slot.0 == *key && slot.1 == attempt {
                entry.last_ok = at;
                entry.cancel.fence(false);
            }
        }
    }

    /// Stops an attempt that was canceled or lost.
    pub(crate) fn stop(&self, key: &JobKey, attempt: u32) {
        for (slot, entry) in &self.table().entries {
            if slot.0 == *key && slot.1 == attempt && entry.running {
                entry.cancel.stop();
            }
        }
    }

    /// Fences every attempt whose lease was not confirmed for too long.
    pub(crate) fn fence_late(&self, now: Instant) {
        for (slot, entry) in &self.table().entries {
            if now.saturating_duration_since(entry.last_ok) >= entry.lease.mul_f64(FENCE_SHARE)
                && entry.cancel.may_spend()
            {
                tracing::warn!(job = %slot.0, attempt = slot.1, "no beat came through for most of the lease: the attempt is set aside, another worker may have it");
                entry.cancel.fence(true);
            }
        }
    }
}
