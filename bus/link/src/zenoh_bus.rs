//! The bus over zenoh: between processes and machines.
//!
//! Its functions are not generic, so that zenoh is compiled once, here.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use async_trait::async_trait;
use tokio::sync::mpsc::Receiver;
use zenoh::Session;
use zenoh::bytes::ZBytes;
use zenoh::config::Config;
use zenoh::pubsub::Publisher;
use zenoh::qos::{CongestionControl, Priority};
use zenoh::query::{ConsolidationMode, Query, QueryTarget};
use zenoh::sample::{Sample, SampleKind};

use crate::bus::{AliveToken, Ask, Bus, Overflow, Presence, Publish, Qos, Reply, Serving, Subscription};
use socrates_model::job::MESSAGE_BYTES;

use crate::credentials::{Credentials, RoleFile};
use crate::envelope::fits;
use crate::error::LinkError;
use crate::handshake;
use crate::join::{Mode, SECURE, ZenohConfig};
use crate::keys::Namespace;
use crate::mailbox::Mailbox;
use crate::rules::{MOST_BYTES, access_control};

/// Room of a served key and of a presence watch.
const DEPTH: usize = 1024;
/// A participant that is let in is let in by then; one that is not has a second look meanwhile.
const AT_ONCE: Duration = Duration::from_secs(1);
/// Longest time closing may take; on a lossy link the transport would wait 10 s.
const CLOSE_LIMIT: Duration = Duration::from_secs(3);
/// A peer that is silent for so long is gone, ms. Announced to the other side, so every participant sets it.
const LEASE_MS: u64 = 3000;

/// What is said to the library about a participant.
fn settings(of: &ZenohConfig) -> Result<Config, LinkError> {
    let mode = match of.mode {
        Mode::Router => "router",
        Mode::Peer => "peer",
        Mode::Client => "client",
    };
    // Debug of a string vector is a JSON5 list of strings.
    let mut rows = vec![
        ("mode", format!("{mode:?}")),
        ("listen/endpoints", format!("{:?}", of.listen)),
        ("listen/timeout_ms", "0".to_owned()),
        ("connect/endpoints", format!("{:?}", of.connect)),
        ("connect/timeout_ms", of.patience.as_millis().to_string()),
        ("connect/exit_on_failure", "true".to_owned()),
        ("connect/retry", "{ period_init_ms: 100, period_max_ms: 1000, period_increase_factor: 1.5 }".to_owned()),
        ("scouting/multicast/enabled", "false".to_owned()),
        ("scouting/gossip/enabled", "false".to_owned()),
        ("scouting/delay", "0".to_owned()),
        ("adminspace/enabled", "false".to_owned()),
        ("transport/shared_memory/enabled", "false".to_owned()),
        ("transport/link/tx/lease", LEASE_MS.to_string()),
        ("transport/link/tx/keep_alive", "4".to_owned()),
        ("transport/link/rx/max_message_size", MOST_BYTES.to_string()),
        ("transport/unicast/accept_timeout", "5000".to_owned()),
        ("transport/unicast/open_timeout", "5000".to_owned()),
        ("queries_default_timeout", "10000".to_owned()),
    ];
    if let Some(keys) = &of.credentials {
        rows.extend(secured(of, keys));
    }
    let mut config = Config::default();
    for (key, value) in rows {
        let set = config.insert_json5(key, &value);
        set.map_err(|why| transport(&format!("setting `{key}` to `{value}`"), &why.to_string()))?;
    }
    Ok(config)
}

/// What is said about TLS: paths of files, never what is in them, because the library repeats its settings in errors.
fn secured(of: &ZenohConfig, keys: &Credentials) -> Vec<(&'static str, String)> {
    let path = |which: RoleFile| format!("{:?}", keys.file(which).display().to_string());
    let secure = |endpoints: &[String]| endpoints.iter().any(|one| one.starts_with(SECURE));
    let (certificate, key) = (path(RoleFile::Certificate), path(RoleFile::Key));
    let mut rows = vec![
        ("transport/link/tls/root_ca_certificate", path(RoleFile::Authority)),
        ("transport/link/tls/enable_mtls", "true".to_owned()),
        ("transport/link/tls/verify_name_on_connect", "true".to_owned()),
        ("transport/link/tls/close_link_on_expiration", "true".to_owned()),
    ];
    if secure(&of.listen) {
        rows.push(("transport/link/tls/listen_certificate", certificate.clone()));
        rows.push(("transport/link/tls/listen_private_key", key.clone()));
        rows.push(("access_control", access_control()));
    }
    if secure(&of.connect) {
        rows.push(("transport/link/tls/connect_certificate", certificate));
        rows.push(("transport/link/tls/connect_private_key", key));
    }
    rows
}

/// Ends when keys are refused, which waiting does not change, and never otherwise.
async fn refusal(config: &ZenohConfig) -> LinkError {
    tokio::time::sleep(AT_ONCE).await;
    match handshake::refused(config).await {
        Some(why @ LinkError::Keys { .. }) => why,
        Some(_) | None => std::future::pending().await,
    }
}

fn transport(what: &str, why: &str) -> LinkError {
    // The transport ends its reasons with the place in its own source, which tells a person nothing.
    let why = why.split_once(" at /").map_or(why, |(words, _)| words);
    LinkError::Transport { what: what.to_owned(), why: why.to_owned() }
}

/// The session, and every mailbox that ends with it.
pub struct ZenohBus {
    session: Session,
    namespace: Namespace,
    name: String,
    endings: Arc<Mutex<Vec<Ending>>>,
}

/// Closes a mailbox with the given `true`; says whether anybody still reads it.
type Ending = Box<dyn Fn(bool) -> bool + Send>;

impl ZenohBus {
    /// Joins: listeners are bound and connections made before it returns.
    ///
    /// # Errors
    /// [`LinkError::BadKey`] for the namespace; [`LinkError::Keys`] when keys are missing, of the wrong role, or refused by the other
    /// end; [`LinkError::Transport`] when an endpoint cannot be bound or reached.
    pub async fn open(config: ZenohConfig) -> Result<Self, LinkError> {
        let namespace = Namespace::new(&config.namespace)?;
        config.check()?;
        let joined = settings(&config)?;
        let session = tokio::select! {
            biased;
            opened = async { zenoh::open(joined).await } => opened.map_err(|why| why.to_string()),
            why = refusal(&config) => return Err(why),
        };
        let session = match session {
            Ok(session) => session,
            Err(why) => {
                let what = format!("joining the bus (listen {:?}, connect {:?})", config.listen, config.connect);
                let reason = handshake::refused(&config).await;
                return Err(reason.unwrap_or_else(|| transport(&what, &why)));
            }
        };
        Ok(Self { session, namespace, name: config.name, endings: Arc::default() })
    }

    fn full(&self, key: &str) -> Result<String, LinkError> {
        if self.session.is_closed() {
            return Err(LinkError::Closed);
        }
        self.namespace.full(key)
    }

    /// Asks those who serve a key and gives the way by which replies come, with room for so many; those beyond are left out.
    async fn ask(
        &self,
        key: &str,
        body: Vec<u8>,
        target: QueryTarget,
        timeout: Duration,
        room: usize,
    ) -> Result<Receiver<zenoh::query::Reply>, LinkError> {
        let full = self.full(key)?;
        let body = fits(key, body)?;
        // A channel of our own: whoever gave up waiting is no error, which the transport's own channel would print.
        let (heard, replies) = tokio::sync::mpsc::channel(room.max(1));
        let get = self
            .session
            .get(full)
            .payload(body)
            .target(target)
            .consolidation(ConsolidationMode::None)
            .congestion_control(CongestionControl::Block)
            .express(true)
            .timeout(timeout)
            .callback(move |reply| drop(heard.try_send(reply)));
        get.await.map_err(|why| unanswered(key, &why))?;
        Ok(replies)
    }

    /// Remembers to close the mailbox with the bus, and forgets those whose reader is gone.
    fn ends_with_bus<T: Send + 'static>(&self, mailbox: &Mailbox<T>) {
        let mut endings = self.endings.lock().unwrap_or_else(PoisonError::into_inner);
        endings.retain(|still_read| still_read(false));
        endings.push(mailbox.ending());
    }
}

/// Why a question was not answered.
fn unanswered(key: &str, why: &dyn std::fmt::Display) -> LinkError {
    transport(&format!("asking `{key}`"), &why.to_string())
}

/// How long replies are waited for: the transport has the same limit, and ours also holds where a router forgets its own.
const fn patience(timeout: Duration) -> Duration {
    timeout.saturating_add(Duration::from_millis(250))
}

/// How the transport treats a message: what happens where it is full, whom it goes before, whether it waits for company.
const fn manner(qos: Qos) -> (CongestionControl, Priority, bool) {
    match qos {
        Qos::Control => (CongestionControl::Block, Priority::InteractiveHigh, true),
        Qos::Hint => (CongestionControl::Drop, Priority::Data, true),
        Qos::Stream => (CongestionControl::Drop, Priority::DataLow, false),
    }
}

/// A declared publisher.
struct Declaration {
    session: Session,
    publisher: Publisher<'static>,
    heard: Arc<AtomicBool>,
    key: String,
}

#[async_trait]
impl Publish for Declaration {
    fn is_heard(&self) -> bool {
        self.heard.load(Ordering::Acquire)
    }

    async fn put(&self, body: Vec<u8>) -> Result<(), LinkError> {
        if self.session.is_closed() {
            return Err(LinkError::Closed);
        }
        let body = fits(&self.key, body)?;
        self.publisher.put(body).await.map_err(|why| transport(&format!("publishing `{}`", self.key), &why.to_string()))
    }
}

struct Back(Query);

#[async_trait]
impl Reply for Back {
    async fn send(self: Box<Self>, key: &str, body: Vec<u8>) -> Result<(), LinkError> {
        // A reply takes the congestion control and express mark of its query.
        let reply = self.0.reply(self.0.key_expr().clone(), body);
        reply.await.map_err(|why| transport(&format!("replying on `{key}`"), &why.to_string()))
    }
}

/// Whether a message that came is one that this bus sends; another is told in the log and dropped.
fn within(key: &str, payload: &ZBytes) -> bool {
    let (len, cap) = (payload.len(), MESSAGE_BYTES);
    if len > cap {
        tracing::warn!(key, len, cap, "a message that is too large was refused");
    }
    len <= cap
}

fn bytes(payload: &ZBytes) -> Vec<u8> {
    payload.to_bytes().into_owned()
}

#[async_trait]
impl Bus for ZenohBus {
    fn name(&self) -> &str {
        &self.name
    }

    async fn query(&self, key: &str, body: Vec<u8>, timeout: Duration) -> Result<Vec<u8>, LinkError> {
        let late = || LinkError::Timeout { key: key.to_owned(), after: timeout };
        let mut replies = self.ask(key, body, QueryTarget::BestMatching, timeout, 1).await?;
        let first = tokio::time::timeout(patience(timeout), replies.recv());
        match first.await {
            Ok(Some(reply)) => match reply.into_result() {
                Ok(sample) => fits(key, bytes(sample.payload())),
                Err(error) => match error.payload().try_to_string() {
                    Ok(text) if text.eq_ignore_ascii_case("timeout") => Err(late()),
                    Ok(text) => Err(unanswered(key, &text)),
                    Err(why) => Err(unanswered(key, &why)),
                },
            },
            Ok(None) => Err(LinkError::NoReply { key: key.to_owned() }),
            Err(_elapsed) => Err(late()),
        }
    }

    async fn query_all(
        &self,
        expression: &str,
        body: Vec<u8>,
        most: usize,
        timeout: Duration,
    ) -> Result<Vec<Vec<u8>>, LinkError> {
        let mut replies = self.ask(expression, body, QueryTarget::All, timeout, most).await?;
        let mut found = Vec::new();
        let gathered = async {
            while found.len() < most
                && let Some(reply) = replies.recv().await
            {
                // An error is somebody who did not answer in time.
                if let Ok(sample) = reply.into_result()
                    && within(sample.key_expr().as_str(), sample.payload())
                {
                    found.push(bytes(sample.payload()));
                }
            }
        };
        // What came until then counts.
        drop(tokio::time::timeout(patience(timeout), gathered).await);
        Ok(found)
    }

    async fn serve(&self, key: &str) -> Result<Serving, LinkError> {
        let full = self.full(key)?;
        let mailbox = Mailbox::new(DEPTH);
        self.ends_with_bus(&mailbox);
        let (inbox, namespace) = (mailbox.clone(), self.namespace.clone());
        let declared = self
            .session
            .declare_queryable(full)
            .complete(true)
            .callback(move |query: Query| {
                let key = namespace.relative(query.key_expr().as_str()).to_owned();
                if query.payload().is_some_and(|payload| !within(&key, payload)) {
                    return;
                }
                let body = query.payload().map(bytes).unwrap_or_default();
                inbox.push_blocking(Ask::new(key, body, Box::new(Back(query))));
            })
            .await;
        let guard = declared.map_err(|why| transport(&format!("serving `{key}`"), &why.to_string()))?;
        Ok(Serving::new(mailbox, Box::new(guard)))
    }

    async fn publish(&self, key: &str, body: Vec<u8>, qos: Qos) -> Result<(), LinkError> {
        let full = self.full(key)?;
        let body = fits(key, body)?;
        let (congestion, priority, express) = manner(qos);
        let put = self.session.put(full, body).congestion_control(congestion).priority(priority).express(express);
        put.await.map_err(|why| transport(&format!("publishing `{key}`"), &why.to_string()))
    }

    async fn publisher(&self, key: &str, qos: Qos) -> Result<Box<dyn Publish>, LinkError> {
        let full = self.full(key)?;
        let failed = |why: &dyn std::fmt::Display| transport(&format!("declaring `{key}`"), &why.to_string());
        let (congestion, priority, express) = manner(qos);
        let declared = self.session.declare_publisher(full);
        let declared = declared.congestion_control(congestion).priority(priority).express(express);
        let publisher = declared.await.map_err(|why| failed(&why))?;
        let heard = Arc::new(AtomicBool::new(false));
        let change = Arc::clone(&heard);
        let listening =
            publisher.matching_listener().callback(move |status| change.store(status.matching(), Ordering::Release));
        listening.background().await.map_err(|why| failed(&why))?;
        // What was so before the listener was there; a listener that came in between has told by now.
        let status = publisher.matching_status().await.map_err(|why| failed(&why))?;
        heard.fetch_or(status.matching(), Ordering::AcqRel);
        Ok(Box::new(Declaration { session: self.session.clone(), publisher, heard, key: key.to_owned() }))
    }

    async fn subscribe(&self, expression: &str, depth: usize, overflow: Overflow) -> Result<Subscription, LinkError> {
        let full = self.full(expression)?;
        let mailbox = Mailbox::new(depth);
        self.ends_with_bus(&mailbox);
        let (inbox, namespace) = (mailbox.clone(), self.namespace.clone());
        let declared = self
            .session
            .declare_subscriber(full)
            .callback(move |sample: Sample| {
                if !within(sample.key_expr().as_str(), sample.payload()) {
                    return;
                }
                let message = (namespace.relative(sample.key_expr().as_str()).to_owned(), bytes(sample.payload()));
                match overflow {
                    Overflow::DropOldest => inbox.push_over(message),
                    Overflow::Block => inbox.push_blocking(message),
                }
            })
            .await;
        let guard = declared.map_err(|why| transport(&format!("listening to `{expression}`"), &why.to_string()))?;
        Ok(Subscription::new(mailbox, Box::new(guard)))
    }

    async fn declare_alive(&self, key: &str) -> Result<AliveToken, LinkError> {
        let full = self.full(key)?;
        let declared = self.session.liveliness().declare_token(full).await;
        let guard = declared.map_err(|why| transport(&format!("showing `{key}`"), &why.to_string()))?;
        Ok(AliveToken::new(Box::new(guard)))
    }

    async fn watch_alive(&self, expression: &str) -> Result<Presence, LinkError> {
        let full = self.full(expression)?;
        let mailbox = Mailbox::new(DEPTH);
        self.ends_with_bus(&mailbox);
        let (inbox, namespace) = (mailbox.clone(), self.namespace.clone());
        let declared = self
            .session
            .liveliness()
            .declare_subscriber(full)
            .history(true)
            .callback(move |sample: Sample| {
                let alive = sample.kind() == SampleKind::Put;
                inbox.push_over((namespace.relative(sample.key_expr().as_str()).to_owned(), alive));
            })
            .await;
        let guard = declared.map_err(|why| transport(&format!("watching `{expression}`"), &why.to_string()))?;
        Ok(Presence::new(mailbox, Box::new(guard)))
    }

    async fn close(&self) {
        // On a task of its own: closing takes locks of the library, and one that it does not get must not hold its caller.
        let session = self.session.clone();
        let closing = tokio::spawn(async move { session.close().await });
        if tokio::time::timeout(CLOSE_LIMIT, closing).await.is_err() {
            tracing::warn!(limit_s = CLOSE_LIMIT.as_secs(), "the bus did not close in time and was left");
        }
        let endings = std::mem::take(&mut *self.endings.lock().unwrap_or_else(PoisonError::into_inner));
        for end in endings {
            end(true);
        }
    }
}
