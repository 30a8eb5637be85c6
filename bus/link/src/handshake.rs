//! Why a router did not let a participant in. The transport only says that nobody could be reached; a second look tells whether
//! somebody listens there, speaks QUIC, shows a certificate that is trusted here, and takes ours.

use std::net::{Ipv6Addr, SocketAddr};
use std::pin::Pin;
use std::sync::Arc;
use std::time::Duration;

use quinn::crypto::rustls::QuicClientConfig;
use quinn::rustls::pki_types::pem::PemObject as _;
use quinn::rustls::pki_types::{CertificateDer, PrivateKeyDer};
use quinn::rustls::version::TLS13;
use quinn::rustls::{self, CertificateError, ClientConfig, Error, RootCertStore};
use quinn::{ConnectionError, Endpoint, TransportErrorCode};
use tokio::net::{TcpStream, UdpSocket};
use tokio::time::timeout;

use crate::credentials::{Credentials, RoleFile};
use crate::error::LinkError;
use crate::join::{SECURE, ZenohConfig};
use crate::witness::Witness;

/// Longest time of each step: the other end answers at once, or not at all.
const STEP: Duration = Duration::from_secs(3);
/// Protocols that the transport offers over QUIC (zenoh 1.10): one stream or several, with datagrams or without.
const PROTOCOLS: [&[u8]; 5] = [b"zenoh", b"zenoh-ms", b"zenoh-mr", b"zenoh-ms-mr", b"hq-29"];
/// Errors of QUIC from here to [`LAST_ALERT`] are alerts of TLS (RFC 9001, section 4.8).
const FIRST_ALERT: u64 = 0x100;
const LAST_ALERT: u64 = 0x1ff;
/// The alert by which the other end says that it speaks none of the protocols that were offered (RFC 7301, section 3.2).
const NO_PROTOCOL: u64 = FIRST_ALERT + 120;

/// What is in the way; none where a second look finds nothing either. Boxed: a handshake is large, and seldom made.
pub(crate) fn refused(config: &ZenohConfig) -> Pin<Box<dyn Future<Output = Option<LinkError>> + Send + '_>> {
    Box::pin(look(config))
}

async fn look(config: &ZenohConfig) -> Option<LinkError> {
    for endpoint in &config.connect {
        let told = match (endpoint.split_once('/'), &config.credentials) {
            (Some(("quic", address)), Some(keys)) => with_keys(endpoint, plain(address), keys).await,
            (Some(("tcp", address)), _) => in_clear(endpoint, plain(address)).await,
            (Some(_) | None, _) => None,
        };
        if told.is_some() {
            return told;
        }
    }
    None
}

/// An address without what the transport lets stand behind it.
fn plain(address: &str) -> &str {
    address.split(['?', '#']).next().unwrap_or_default()
}

fn bad(what: String, hint: &str) -> LinkError {
    LinkError::Keys { what, hint: hint.to_owned() }
}

fn nobody(endpoint: &str, why: &str) -> LinkError {
    LinkError::Transport { what: format!("connecting to `{endpoint}`"), why: why.to_owned() }
}

/// Whether somebody takes plain connections.
async fn takes_tcp(address: &str) -> Result<(), String> {
    match timeout(STEP, TcpStream::connect(address)).await {
        Ok(Ok(_stream)) => Ok(()),
        Ok(Err(why)) => Err(why.to_string()),
        Err(_elapsed) => Err("nobody answers there".to_owned()),
    }
}

/// The first address of a name.
async fn first_of(address: &str) -> Result<SocketAddr, String> {
    let mut found = tokio::net::lookup_host(address).await.map_err(|why| why.to_string())?;
    found.next().ok_or_else(|| "the name has no address".to_owned())
}

/// Where a socket of our own is bound to reach an address.
fn own_end(towards: SocketAddr) -> SocketAddr {
    if towards.is_ipv4() { SocketAddr::from(([0, 0, 0, 0], 0)) } else { SocketAddr::from((Ipv6Addr::UNSPECIFIED, 0)) }
}

/// Whether a plain connection is refused where QUIC is spoken.
async fn in_clear(endpoint: &str, address: &str) -> Option<LinkError> {
    let Err(why) = takes_tcp(address).await else { return None };
    if speaks_quic(address).await != Some(true) {
        return Some(nobody(endpoint, &why));
    }
    let quic = format!("{SECURE}{address}");
    Some(bad(
        format!("`{endpoint}` wants keys: QUIC is spoken there"),
        &format!("connect to `{quic}` with --keys FOLDER"),
    ))
}

/// Whether QUIC is spoken at an address; none where it cannot be asked. A packet of a version that nobody speaks must be answered with
/// the versions that are spoken (RFC 9000, sections 6 and 15), without keys.
async fn speaks_quic(address: &str) -> Option<bool> {
    let towards = first_of(address).await.ok()?;
    let socket = UdpSocket::bind(own_end(towards)).await.ok()?;
    socket.connect(towards).await.ok()?;
    let mut packet = [0_u8; 1200];
    // Long header, version 0x0a0a0a0a, then eight bytes of each connection's name.
    let head = [0xc0, 0x0a, 0x0a, 0x0a, 0x0a, 8, 1, 2, 3, 4, 5, 6, 7, 8, 8, 8, 7, 6, 5, 4, 3, 2, 1];
    for (byte, head) in packet.iter_mut().zip(head) {
        *byte = head;
    }
    socket.send(&packet).await.ok()?;
    let mut answer = [0_u8; 1500];
    let Ok(Ok(length)) = timeout(STEP, socket.recv(&mut answer)).await else { return Some(false) };
    // A long header of version zero is a list of versions.
    Some(matches!(answer.get(..length), Some([first, 0, 0, 0, 0, ..]) if first & 0x80 != 0))
}

async fn with_keys(endpoint: &str, address: &str, keys: &Credentials) -> Option<LinkError> {
    let host = address.rsplit_once(':').map_or(address, |(host, _port)| host);
    let towards = match first_of(address).await {
        Ok(towards) => towards,
        Err(why) => return Some(nobody(endpoint, &why)),
    };
    let witness = match witness_of(keys) {
        Ok(witness) => Arc::new(witness),
        Err(why) => return Some(unusable(keys, &why)),
    };
    let mut end = match Endpoint::client(own_end(towards)) {
        Ok(end) => end,
        Err(why) => return Some(nobody(endpoint, &why.to_string())),
    };
    match client(keys, Arc::clone(&witness)) {
        Ok(settings) => end.set_default_client_config(settings),
        Err(why) => return Some(unusable(keys, &why)),
    }
    let connecting = match end.connect(towards, host) {
        Ok(connecting) => connecting,
        Err(why) => {
            let what = format!("`{host}` in `{endpoint}` is no host name and no address: {why}");
            return Some(bad(what, "write quic/NAME:PORT"));
        }
    };
    match timeout(STEP, connecting).await {
        Err(_elapsed) => Some(silent(endpoint, address).await),
        Ok(Err(why)) => Some(distrusted(endpoint, host, &why, witness.complaint())),
        // Our own certificate is judged after the handshake is over here.
        Ok(Ok(connection)) => match timeout(STEP, connection.closed()).await {
            Ok(why) if alert(&why).is_some() => Some(bad(
                format!("`{endpoint}` refuses the keys in `{}`: {why}", keys.folder().display()),
                "they were made for another deployment, or hold no more; copy the folder of the role again",
            )),
            Ok(_) | Err(_) => None,
        },
    }
}

/// What is said where no QUIC comes back: either something else is spoken there, or nobody is.
async fn silent(endpoint: &str, address: &str) -> LinkError {
    match takes_tcp(address).await {
        Ok(()) => bad(format!("`{endpoint}` does not speak QUIC: plain connections are taken there"), IN_CLEAR),
        Err(_nobody) => nobody(endpoint, "nobody answers there; QUIC needs its UDP port open on the way"),
    }
}

/// Where keys do not belong to the other end.
const ANEW: &str = "copy the folder of the role again, as `socrates cluster keys` made it";
/// Where the other end has no keys.
const IN_CLEAR: &str = "was it started with --keys, on an endpoint that begins with `quic/`?";

fn unusable(keys: &Credentials, why: &str) -> LinkError {
    bad(format!("the keys in `{}` cannot be used: {why}", keys.folder().display()), ANEW)
}

fn certificates(keys: &Credentials, which: RoleFile) -> Result<Vec<CertificateDer<'static>>, String> {
    let read = CertificateDer::pem_file_iter(keys.file(which)).map_err(|why| why.to_string())?;
    read.collect::<Result<_, _>>().map_err(|why| why.to_string())
}

fn witness_of(keys: &Credentials) -> Result<Witness, String> {
    let mut roots = RootCertStore::empty();
    for root in certificates(keys, RoleFile::Authority)? {
        roots.add(root).map_err(|why| why.to_string())?;
    }
    Witness::trusting(roots)
}

fn client(keys: &Credentials, witness: Arc<Witness>) -> Result<quinn::ClientConfig, String> {
    let key = PrivateKeyDer::from_pem_file(keys.file(RoleFile::Key)).map_err(|why| why.to_string())?;
    let mut settings = ClientConfig::builder_with_provider(Arc::new(rustls::crypto::ring::default_provider()))
        .with_protocol_versions(&[&TLS13])
        .map_err(|why| why.to_string())?
        .dangerous()
        .with_custom_certificate_verifier(witness)
        .with_client_auth_cert(certificates(keys, RoleFile::Certificate)?, key)
        .map_err(|why| why.to_string())?;
    settings.alpn_protocols = PROTOCOLS.map(<[u8]>::to_vec).into();
    let settings = QuicClientConfig::try_from(settings).map_err(|why| why.to_string())?;
    Ok(quinn::ClientConfig::new(Arc::new(settings)))
}

/// The alert of TLS by which a connection ended, as QUIC numbers it.
fn alert(why: &ConnectionError) -> Option<u64> {
    let code = |code: TransportErrorCode| u64::from(code);
    let code = match why {
        ConnectionError::TransportError(error) => code(error.code),
        ConnectionError::ConnectionClosed(close) => code(close.error_code),
        ConnectionError::VersionMismatch
        | ConnectionError::ApplicationClosed(_)
        | ConnectionError::Reset
        | ConnectionError::TimedOut
        | ConnectionError::LocallyClosed
        | ConnectionError::CidsExhausted => return None,
    };
    (FIRST_ALERT..=LAST_ALERT).contains(&code).then_some(code)
}

/// What is wrong with the other end, by what was found wrong with its certificate, or by how the handshake ended.
fn distrusted(endpoint: &str, host: &str, why: &ConnectionError, certificate: Option<Error>) -> LinkError {
    match (certificate, alert(why)) {
        (Some(Error::InvalidCertificate(CertificateError::UnknownIssuer | CertificateError::BadSignature)), _) => bad(
            format!(
                "`{endpoint}` is of another deployment: its certificate was not signed by the authority of these keys"
            ),
            ANEW,
        ),
        (
            Some(Error::InvalidCertificate(
                CertificateError::NotValidForName | CertificateError::NotValidForNameContext { .. },
            )),
            _,
        ) => bad(
            format!("the certificate of `{endpoint}` does not name the host `{host}`"),
            &format!("connect by a name that it has, or make the keys with `--host {host}`"),
        ),
        (Some(Error::InvalidCertificate(reason)), _) => bad(
            format!("the certificate of `{endpoint}` is refused: {reason}"),
            "make new keys with `socrates cluster keys`",
        ),
        (Some(other), _) => bad(format!("`{endpoint}` and these keys do not go together: {other}"), ANEW),
        (None, Some(NO_PROTOCOL)) => bad(format!("`{endpoint}` speaks QUIC, but is no router of zenoh"), IN_CLEAR),
        (None, Some(_)) => bad(format!("`{endpoint}` and these keys do not go together: {why}"), ANEW),
        (None, None) => nobody(endpoint, &why.to_string()),
    }
}
