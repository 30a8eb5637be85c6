//! Telling a running stage that it should stop.

use tokio::sync::watch;

/// How an attempt stands with its orchestrator.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Standing {
    /// It holds its lease.
    Held,
    /// No beat came through for 0.8 of the lease: it may compute on but must not spend (no new question to an author).
    Fenced,
    /// It is canceled, lost or out of time: stop.
    Stopped,
}

/// A cancel token; clones tell the same.
#[derive(Debug, Clone)]
pub struct Cancel(watch::Sender<Standing>);

impl Cancel {
    /// A token of an attempt that holds its lease.
    #[must_use]
    pub fn new() -> Self {
        Self(watch::Sender::new(Standing::Held))
    }

    /// How the attempt stands now.
    #[must_use]
    pub fn standing(&self) -> Standing {
        *self.0.borrow()
    }

    /// Whether to stop. Synchronous code asks this now and then.
    #[must_use]
    pub fn is_stopped(&self) -> bool {
        self.standing() == Standing::Stopped
    }

    /// Whether side effects that cost something are still allowed.
    #[must_use]
    pub fn may_spend(&self) -> bool {
        self.standing() == Standing::Held
    }

    /// Waits until the attempt has to stop.
    pub async fn stopped(&self) {
        let mut changes = self.0.subscribe();
        // The sender lives in `self`, so waiting ends with the standing alone.
        drop(changes.wait_for(|standing| *standing == Standing::Stopped).await);
    }

    /// Stops the attempt, for good.
    pub fn stop(&self) {
        self.0.send_replace(Standing::Stopped);
    }

    /// Fences the attempt or takes the fence back; a stopped one stays stopped.
    pub(crate) fn fence(&self, fenced: bool) {
        self.0.send_if_modified(|standing| {
            let next = if fenced { Standing::Fenced } else { Standing::Held };
            let change = *standing != Standing::Stopped && *standing != next;
            if change {
                *standing = next;
            }
            change
        });
    }
}

impl Default for Cancel {
    fn default() -> Self {
        Self::new()
    }
}
