//! What viewers see of a run while it happens: a page of our own, Foxglove and Lichtblick, and files. One port, read-only.
//!
//! ```text
//! bus ─► air ─┐                 ┌─► page   frames of 16 bytes an agent, acknowledged, at most two on their way
//!             ├─► hub ─► run ───┼─► fox    Foxglove's protocol
//! bundle ─────┘   (shared by    └─► http   scene, frames of the past, events, standing, recording with ranges
//!                  all viewers)
//! ```
//!
//! Nothing that a viewer sends goes further than the socket it came by: no type of this room can publish to a run.
//!
//! | module | what |
//! |---|---|
//! | [`frame`], [`scene`], [`words`], [`judge`] | what is told, pure |
//! | [`run`], [`hub`], [`air`] | runs as all viewers share them, and where they come from |
//! | [`guard`], [`server`], [`http`], [`page`], [`files`] | the door |
//! | [`fox`] | Foxglove's protocol and messages, pure |
//! | [`plain`] | the same door for one text: figures of an orchestrator |
//!
//! *Never here:* a publication or a question that a run would notice besides being watched, a path out of a URL, a queue for a viewer.

pub mod air;
mod assets;
pub mod files;
pub mod fox;
mod fox_socket;
pub mod frame;
pub mod guard;
pub mod http;
pub mod hub;
pub mod judge;
pub mod page;
pub mod plain;
pub mod run;
pub mod scene;
pub mod server;
mod socket;
pub mod staging;
pub mod words;

use std::sync::Arc;

use rustls::pki_types::pem::PemObject as _;
use rustls::pki_types::{CertificateDer, PrivateKeyDer};
use tokio::net::TcpListener;
use tokio_rustls::TlsAcceptor;

use crate::guard::Rules;
use crate::http::{Policy, Shared, routes};
use crate::hub::{Hub, Shelf};

/// A certificate chain with its key.
#[derive(Clone)]
pub struct Tls(TlsAcceptor);

impl std::fmt::Debug for Tls {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Tls")
    }
}

impl Tls {
    /// Reads both from PEM.
    ///
    /// # Errors
    /// What is wrong with them, in a sentence.
    pub fn of_pem(chain: &[u8], key: &[u8]) -> Result<Self, String> {
        let chain: Vec<CertificateDer<'static>> =
            CertificateDer::pem_slice_iter(chain).collect::<Result<_, _>>().map_err(|why| why.to_string())?;
        let key = PrivateKeyDer::from_pem_slice(key).map_err(|why| why.to_string())?;
        let provider = Arc::new(rustls::crypto::ring::default_provider());
        let config = rustls::ServerConfig::builder_with_provider(provider)
            .with_safe_default_protocol_versions()
            .map_err(|why| why.to_string())?
            .with_no_client_auth()
            .with_single_cert(chain, key)
            .map_err(|why| why.to_string())?;
        Ok(Self(TlsAcceptor::from(Arc::new(config))))
    }
}

/// A gateway that is to be opened.
#[derive(Debug)]
pub struct Gateway {
    /// What is let in.
    pub rules: Rules,
    /// What a page of ours may load, and which pages may show it.
    pub policy: Policy,
    /// Certificate and key; none for plain HTTP.
    pub tls: Option<Tls>,
}

impl Gateway {
    /// Serves the runs of these places until it is dropped.
    pub async fn serve(self, listener: TcpListener, shelves: Vec<Box<dyn Shelf>>) {
        let rules = Arc::new(self.rules);
        let shared = Arc::new(Shared {
            hub: Hub::new(shelves),
            rules: Arc::clone(&rules),
            policy: self.policy,
            tls: self.tls.is_some(),
        });
        server::serve(listener, routes(shared), rules, self.tls.map(|tls| tls.0)).await;
    }
}
