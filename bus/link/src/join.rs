//! How a process joins the bus between processes. A program that was built without that bus says so here.

use std::sync::Arc;
use std::time::Duration;

use crate::bus::Bus;
use crate::credentials::Credentials;
use crate::error::LinkError;

/// How an endpoint with mutual TLS, spoken over QUIC, begins: what it needs, and what shows who connects, are [`Credentials`].
pub const SECURE: &str = "quic/";
/// How an endpoint with TLS over TCP begins, which is refused: the transport's link for it reads and writes one stream from two threads
/// (eclipse-zenoh/zenoh#2557, in 1.10), and processes crashed by it.
const OVER_TCP: &str = "tls/";
/// How the endpoints begin that are spoken.
const SPOKEN: [&str; 3] = ["tcp/", SECURE, "unixsock-stream/"];

/// Whether an endpoint is one at which a participant can listen, or to which it can connect: `tcp/HOST:PORT`, `quic/HOST:PORT` or
/// `unixsock-stream/PATH`. The transport judges the rest behind the first `/`.
///
/// # Errors
/// [`LinkError::Keys`] for any other, with what to write.
pub fn check_endpoint(endpoint: &str) -> Result<(), LinkError> {
    if SPOKEN.iter().any(|start| endpoint.strip_prefix(start).is_some_and(|rest| !rest.is_empty())) {
        return Ok(());
    }
    let (what, hint) = match endpoint.strip_prefix(OVER_TCP) {
        Some(rest) => ("TLS over TCP is not spoken", format!("write `{SECURE}{rest}`, with its UDP port open")),
        None => ("no endpoint", "write `tcp/HOST:PORT`, `quic/HOST:PORT` or `unixsock-stream/PATH`".to_owned()),
    };
    Err(LinkError::Keys { what: format!("`{endpoint}`: {what}"), hint })
}

/// The part a participant plays.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// Passes messages on between all that connect to it.
    Router,
    /// Talks to those it is connected to.
    Peer,
    /// Has one connection, to a router.
    Client,
}

/// How to join.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ZenohConfig {
    /// Part played.
    pub mode: Mode,
    /// Endpoints to listen on, such as `tcp/127.0.0.1:7447`, `quic/0.0.0.0:7447` or `unixsock-stream//run/socrates.sock`; none by
    /// default. One with keys switches the access rules on ([`crate::rules`]): then a guest may do what its role may, and one
    /// without a certificate, who came by another endpoint, nothing.
    pub listen: Vec<String>,
    /// Endpoints to connect to. There is no discovery: what is not listed is not found.
    pub connect: Vec<String>,
    /// Deployment that this participant belongs to.
    pub namespace: String,
    /// Name written into envelopes.
    pub name: String,
    /// How long opening keeps trying to connect. Default 10 s. Once open, a lost connection is sought for ever.
    pub patience: Duration,
    /// Keys for endpoints that begin with [`SECURE`]; other endpoints need none and use none. Default none.
    pub credentials: Option<Credentials>,
}

impl ZenohConfig {
    /// The settings of a participant that neither listens nor connects yet.
    #[must_use]
    pub fn new(mode: Mode, namespace: &str, name: &str) -> Self {
        Self {
            mode,
            listen: Vec::new(),
            connect: Vec::new(),
            namespace: namespace.to_owned(),
            name: name.to_owned(),
            patience: Duration::from_secs(10),
            credentials: None,
        }
    }

    /// Listens on this endpoint too.
    #[must_use]
    pub fn listen(mut self, endpoint: &str) -> Self {
        self.listen.push(endpoint.to_owned());
        self
    }

    /// Connects to this endpoint too.
    #[must_use]
    pub fn connect(mut self, endpoint: &str) -> Self {
        self.connect.push(endpoint.to_owned());
        self
    }

    /// With these keys.
    #[must_use]
    pub fn credentials(mut self, keys: Option<Credentials>) -> Self {
        self.credentials = keys;
        self
    }

    /// Whether the keys are there that the endpoints need, and are of a role that may use them so.
    ///
    /// # Errors
    /// [`LinkError::Keys`] when they are not; as [`check_endpoint`].
    pub fn check(&self) -> Result<(), LinkError> {
        let bad = |what: String, hint: &str| Err(LinkError::Keys { what, hint: hint.to_owned() });
        let of = |start: &str, endpoints: &'_ [String]| endpoints.iter().find(|one| one.starts_with(start)).cloned();
        self.listen.iter().chain(&self.connect).try_for_each(|endpoint| check_endpoint(endpoint))?;
        let (listens, connects) = (of(SECURE, &self.listen), of(SECURE, &self.connect));
        let Some(keys) = &self.credentials else {
            return match listens.or(connects) {
                Some(endpoint) => bad(
                    format!("`{endpoint}` needs keys"),
                    "--keys names the folder of a role, such as keys/worker; `socrates cluster keys` makes them",
                ),
                None => Ok(()),
            };
        };
        let (role, folder) = (keys.role(), keys.folder().display());
        if let Some(endpoint) = listens
            && !role.listens()
        {
            let what = format!("nobody can listen on `{endpoint}` with the keys of the role `{role}` (`{folder}`)");
            return bad(what, "an orchestrator listens with the folder `orchestrator`");
        }
        if let Some(endpoint) = connects
            && !role.connects()
        {
            let what = format!("nobody can connect to `{endpoint}` with the keys of the role `{role}` (`{folder}`)");
            return bad(what, "they are for a router; connect with the folder of your own role");
        }
        Ok(())
    }
}

/// Joins the bus between processes.
///
/// # Errors
/// [`LinkError::Absent`] in a program without the feature `zenoh`; else what kept the participant from joining.
#[cfg(feature = "zenoh")]
pub async fn join(config: ZenohConfig) -> Result<Arc<dyn Bus>, LinkError> {
    Ok(Arc::new(crate::zenoh_bus::ZenohBus::open(config).await?))
}

/// Joins the bus between processes, which this program was built without.
///
/// # Errors
/// Always [`LinkError::Absent`].
#[cfg(not(feature = "zenoh"))]
pub async fn join(_config: ZenohConfig) -> Result<Arc<dyn Bus>, LinkError> {
    Err(LinkError::Absent { feature: "zenoh" })
}

#[cfg(all(test, not(feature = "zenoh")))]
mod tests {
    use super::*;

    #[tokio::test]
    async fn a_program_without_the_bus_names_the_feature_that_it_lacks() {
        let told = join(ZenohConfig::new(Mode::Client, "t", "c")).await.err().unwrap();
        assert!(told.to_string().contains("`zenoh`"), "{told}");
    }
}
