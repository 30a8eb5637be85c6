//! A bounded mailbox between a transport's callback and the task that reads.

use std::collections::VecDeque;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use tokio::sync::Notify;

/// Longest time a sender is held up by a full mailbox: as long as the transport itself would wait.
const PATIENCE: Duration = Duration::from_secs(5);

/// Where messages wait. Cloning gives another handle to the same mailbox.
pub(crate) struct Mailbox<T>(Arc<Inner<T>>);

struct Inner<T> {
    state: Mutex<State<T>>,
    arrived: Notify,
    space: Condvar,
    space_async: Notify,
    depth: usize,
}

struct State<T> {
    queue: VecDeque<T>,
    lost: u64,
    closed: bool,
}

impl<T> Clone for Mailbox<T> {
    fn clone(&self) -> Self {
        Self(Arc::clone(&self.0))
    }
}

impl<T> Mailbox<T> {
    /// A mailbox for `depth` messages (0 is taken as 1).
    pub(crate) fn new(depth: usize) -> Self {
        let depth = depth.max(1);
        let state = State { queue: VecDeque::with_capacity(depth.min(1024)), lost: 0, closed: false };
        Self(Arc::new(Inner {
            state: Mutex::new(state),
            arrived: Notify::new(),
            space: Condvar::new(),
            space_async: Notify::new(),
            depth,
        }))
    }

    fn lock(&self) -> MutexGuard<'_, State<T>> {
        // The state is whole after every statement, so a panicked holder leaves nothing half done.
        self.0.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Puts a message in; a full mailbox loses its oldest.
    pub(crate) fn push_over(&self, message: T) {
        let mut state = self.lock();
        if state.closed {
            return;
        }
        if state.queue.len() >= self.0.depth {
            state.queue.pop_front();
            state.lost += 1;
        }
        state.queue.push_back(message);
        drop(state);
        self.0.arrived.notify_one();
    }

    /// Puts a message in and holds the thread up while the mailbox is full, at most 5 s; then it is lost and counted.
    #[cfg(feature = "zenoh")]
    pub(crate) fn push_blocking(&self, message: T) {
        let full = |state: &mut State<T>| state.queue.len() >= self.0.depth && !state.closed;
        let waited = self.0.space.wait_timeout_while(self.lock(), PATIENCE, full);
        let (mut state, limit) = waited.unwrap_or_else(PoisonError::into_inner);
        if state.closed {
            return;
        }
        if limit.timed_out() {
            state.lost += 1;
            return;
        }
        state.queue.push_back(message);
        drop(state);
        self.0.arrived.notify_one();
    }

    /// As [`Mailbox::push_blocking`], for a task.
    pub(crate) async fn push_waiting(&self, message: T) {
        let limit = tokio::time::sleep(PATIENCE);
        tokio::pin!(limit);
        let mut message = Some(message);
        loop {
            let space = self.0.space_async.notified();
            {
                let mut state = self.lock();
                if state.closed {
                    return;
                }
                if state.queue.len() < self.0.depth {
                    state.queue.extend(message.take());
                    drop(state);
                    self.0.arrived.notify_one();
                    return;
                }
            }
            tokio::select! {
                () = space => {}
                () = &mut limit => {
                    self.lock().lost += 1;
                    return;
                }
            }
        }
    }

    /// The next message; `None` once the mailbox is closed and empty.
    pub(crate) async fn pop(&self) -> Option<T> {
        loop {
            let arrived = self.0.arrived.notified();
            {
                let mut state = self.lock();
                if let Some(message) = state.queue.pop_front() {
                    drop(state);
                    self.made_space();
                    return Some(message);
                }
                if state.closed {
                    return None;
                }
            }
            arrived.await;
        }
    }

    /// The next message, if there is one now.
    pub(crate) fn try_pop(&self) -> Option<T> {
        let message = self.lock().queue.pop_front();
        if message.is_some() {
            self.made_space();
        }
        message
    }

    /// How many messages were lost because the mailbox was full.
    pub(crate) fn lost(&self) -> u64 {
        self.lock().lost
    }

    /// Takes no more messages; what is in it can still be read.
    pub(crate) fn close(&self) {
        self.lock().closed = true;
        self.0.arrived.notify_one();
        self.made_space();
    }

    /// A handle that keeps nothing alive: closes the mailbox when given `true`, says whether it still takes messages.
    #[cfg(feature = "zenoh")]
    pub(crate) fn ending(&self) -> Box<dyn Fn(bool) -> bool + Send>
    where
        T: Send + 'static,
    {
        let weak = Arc::downgrade(&self.0);
        Box::new(move |close| {
            let Some(inner) = weak.upgrade() else { return false };
            let mailbox = Self(inner);
            if close {
                mailbox.close();
            }
            !mailbox.lock().closed
        })
    }

    fn made_space(&self) {
        self.0.space.notify_one();
        self.0.space_async.notify_one();
    }
}
