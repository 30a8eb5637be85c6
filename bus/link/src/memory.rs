//! A bus inside one process, for tests: the same promises, no sockets.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use async_trait::async_trait;
use tokio::sync::oneshot;

use crate::bus::{AliveToken, Ask, Bus, Overflow, Presence, Publish, Qos, Reply, Serving, Subscription};
use crate::envelope::fits;
use crate::error::LinkError;
use crate::keys::{checked, covers, meets};
use crate::mailbox::Mailbox;

/// Room of a served key and of a presence watch.
const DEPTH: usize = 1024;

/// A bus in memory. Clones share everything but the name.
#[derive(Clone)]
pub struct MemoryBus {
    hub: Arc<Hub>,
    name: String,
}

#[derive(Default)]
struct Hub {
    tables: Mutex<Tables>,
    next: AtomicU64,
    closed: AtomicBool,
}

#[derive(Default)]
struct Tables {
    servers: Vec<Entry<Mailbox<Ask>>>,
    listeners: Vec<Entry<Listener>>,
    tokens: Vec<Entry<()>>,
    watchers: Vec<Entry<Mailbox<(String, bool)>>>,
}

struct Entry<T> {
    id: u64,
    key: String,
    what: T,
}

#[derive(Clone)]
struct Listener {
    mailbox: Mailbox<(String, Vec<u8>)>,
    overflow: Overflow,
}

impl Hub {
    fn tables(&self) -> MutexGuard<'_, Tables> {
        self.tables.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn check(&self, key: &str) -> Result<(), LinkError> {
        checked(key)?;
        if self.closed.load(Ordering::Acquire) { Err(LinkError::Closed) } else { Ok(()) }
    }

    fn tell(tables: &Tables, key: &str, alive: bool) {
        for watcher in &tables.watchers {
            if covers(&watcher.key, key).unwrap_or(false) {
                watcher.what.push_over((key.to_owned(), alive));
            }
        }
    }
}

/// Takes a declaration back when it is dropped.
struct Declared {
    hub: Arc<Hub>,
    id: u64,
}

impl Drop for Declared {
    fn drop(&mut self) {
        let mut tables = self.hub.tables();
        tables.servers.retain(|entry| entry.id != self.id);
        tables.listeners.retain(|entry| entry.id != self.id);
        tables.watchers.retain(|entry| entry.id != self.id);
        if let Some(at) = tables.tokens.iter().position(|entry| entry.id == self.id) {
            let token = tables.tokens.remove(at);
            if !tables.tokens.iter().any(|other| other.key == token.key) {
                Hub::tell(&tables, &token.key, false);
            }
        }
    }
}

impl MemoryBus {
    /// An empty bus.
    #[must_use]
    pub fn new() -> Self {
        Self { hub: Arc::new(Hub::default()), name: "memory".to_owned() }
    }

    /// The same bus under another name.
    #[must_use]
    pub fn named(&self, name: &str) -> Self {
        Self { hub: Arc::clone(&self.hub), name: name.to_owned() }
    }

    fn declared(&self) -> (u64, Box<Declared>) {
        let id = self.hub.next.fetch_add(1, Ordering::Relaxed);
        (id, Box::new(Declared { hub: Arc::clone(&self.hub), id }))
    }
}

impl Default for MemoryBus {
    fn default() -> Self {
        Self::new()
    }
}

/// A declared publisher.
struct Declaration {
    bus: MemoryBus,
    key: String,
    qos: Qos,
}

#[async_trait]
impl Publish for Declaration {
    fn is_heard(&self) -> bool {
        self.bus.hub.tables().listeners.iter().any(|entry| covers(&entry.key, &self.key).unwrap_or(false))
    }

    async fn put(&self, body: Vec<u8>) -> Result<(), LinkError> {
        self.bus.publish(&self.key, body, self.qos).await
    }
}

struct Back(oneshot::Sender<Vec<u8>>);

#[async_trait]
impl Reply for Back {
    async fn send(self: Box<Self>, _key: &str, body: Vec<u8>) -> Result<(), LinkError> {
        // An asker who gave up is no error of the answerer: the transport cannot know of it either.
        drop(self.0.send(body));
        Ok(())
    }
}

#[async_trait]
impl Bus for MemoryBus {
    fn name(&self) -> &str {
        &self.name
    }

    async fn query(&self, key: &str, body: Vec<u8>, timeout: Duration) -> Result<Vec<u8>, LinkError> {
        self.hub.check(key)?;
        let body = fits(key, body)?;
        let server = {
            let tables = self.hub.tables();
            tables.servers.iter().find(|entry| covers(&entry.key, key).unwrap_or(false)).map(|entry| entry.what.clone())
        };
        let Some(server) = server else { return Err(LinkError::NoReply { key: key.to_owned() }) };
        let (back, reply) = oneshot::channel();
        let ask = Ask::new(key.to_owned(), body, Box::new(Back(back)));
        let asked = async {
            server.push_waiting(ask).await;
            reply.await
        };
        match tokio::time::timeout(timeout, asked).await {
            Ok(Ok(bytes)) => Ok(bytes),
            Ok(Err(_dropped)) => Err(LinkError::NoReply { key: key.to_owned() }),
            Err(_elapsed) => Err(LinkError::Timeout { key: key.to_owned(), after: timeout }),
        }
    }

    async fn query_all(
        &self,
        expression: &str,
        body: Vec<u8>,
        most: usize,
        timeout: Duration,
    ) -> Result<Vec<Vec<u8>>, LinkError> {
        self.hub.check(expression)?;
        let body = fits(expression, body)?;
        let servers: Vec<Mailbox<Ask>> = {
            let tables = self.hub.tables();
            let asked = tables.servers.iter().filter(|entry| meets(&entry.key, expression).unwrap_or(false));
            asked.take(most).map(|entry| entry.what.clone()).collect()
        };
        let mut replies = Vec::new();
        for server in servers {
            let (back, reply) = oneshot::channel();
            replies.push(reply);
            let ask = Ask::new(expression.to_owned(), body.clone(), Box::new(Back(back)));
            if tokio::time::timeout(timeout, server.push_waiting(ask)).await.is_err() {
                break;
            }
        }
        let until = tokio::time::Instant::now() + timeout;
        let mut found = Vec::new();
        for reply in replies {
            if let Ok(Ok(bytes)) = tokio::time::timeout_at(until, reply).await {
                found.push(bytes);
            }
        }
        Ok(found)
    }

    async fn serve(&self, key: &str) -> Result<Serving, LinkError> {
        self.hub.check(key)?;
        let (id, guard) = self.declared();
        let mailbox = Mailbox::new(DEPTH);
        self.hub.tables().servers.push(Entry { id, key: key.to_owned(), what: mailbox.clone() });
        Ok(Serving::new(mailbox, guard))
    }

    async fn publish(&self, key: &str, body: Vec<u8>, _qos: Qos) -> Result<(), LinkError> {
        self.hub.check(key)?;
        let body = fits(key, body)?;
        let listeners: Vec<Listener> = {
            let tables = self.hub.tables();
            let hit = tables.listeners.iter().filter(|entry| covers(&entry.key, key).unwrap_or(false));
            hit.map(|entry| entry.what.clone()).collect()
        };
        for listener in listeners {
            let message = (key.to_owned(), body.clone());
            match listener.overflow {
                Overflow::DropOldest => listener.mailbox.push_over(message),
                Overflow::Block => listener.mailbox.push_waiting(message).await,
            }
        }
        Ok(())
    }

    async fn publisher(&self, key: &str, qos: Qos) -> Result<Box<dyn Publish>, LinkError> {
        self.hub.check(key)?;
        Ok(Box::new(Declaration { bus: self.clone(), key: key.to_owned(), qos }))
    }

    async fn subscribe(&self, expression: &str, depth: usize, overflow: Overflow) -> Result<Subscription, LinkError> {
        self.hub.check(expression)?;
        let (id, guard) = self.declared();
        let mailbox = Mailbox::new(depth);
        let what = Listener { mailbox: mailbox.clone(), overflow };
        self.hub.tables().listeners.push(Entry { id, key: expression.to_owned(), what });
        Ok(Subscription::new(mailbox, guard))
    }

    async fn declare_alive(&self, key: &str) -> Result<AliveToken, LinkError> {
        self.hub.check(key)?;
        let (id, guard) = self.declared();
        let mut tables = self.hub.tables();
        tables.tokens.push(Entry { id, key: key.to_owned(), what: () });
        Hub::tell(&tables, key, true);
        drop(tables);
        Ok(AliveToken::new(guard))
    }

    async fn watch_alive(&self, expression: &str) -> Result<Presence, LinkError> {
        self.hub.check(expression)?;
        let (id, guard) = self.declared();
        let mailbox = Mailbox::new(DEPTH);
        let mut tables = self.hub.tables();
        for token in &tables.tokens {
            if covers(expression, &token.key)? {
                mailbox.push_over((token.key.clone(), true));
            }
        }
        tables.watchers.push(Entry { id, key: expression.to_owned(), what: mailbox.clone() });
        drop(tables);
        Ok(Presence::new(mailbox, guard))
    }

    async fn close(&self) {
        self.hub.closed.store(true, Ordering::Release);
        let tables = std::mem::take(&mut *self.hub.tables());
        for server in tables.servers {
            server.what.close();
        }
        for listener in tables.listeners {
            listener.what.mailbox.close();
        }
        for watcher in tables.watchers {
            watcher.what.close();
        }
    }
}
