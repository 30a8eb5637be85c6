//! Why a router did not let a participant in. The transport only says that nobody could be reached; a second look tells whether
//! somebody listens there, speaks TLS, shows a certificate that is trusted here, and takes ours.

use std::sync::Arc;
use std::time::Duration;

use tokio::io::{AsyncReadExt as _, AsyncWriteExt as _};
use tokio::net::TcpStream;
use tokio::time::timeout;
use tokio_rustls::TlsConnector;
use tokio_rustls::rustls::crypto::ring;
use tokio_rustls::rustls::pki_types::pem::PemObject as _;
use tokio_rustls::rustls::pki_types::{CertificateDer, PrivateKeyDer, ServerName};
use tokio_rustls::rustls::version::TLS13;
use tokio_rustls::rustls::{CertificateError, ClientConfig, Error, RootCertStore};

use crate::credentials::{Credentials, RoleFile};
use crate::error::LinkError;
use crate::join::{TLS, ZenohConfig};

/// Longest time of each step: the other end answers at once, or not at all.
const STEP: Duration = Duration::from_secs(3);
/// First byte of a refusal in TLS.
const ALERT: u8 = 21;

/// What is in the way; none where a second look finds nothing either.
pub(crate) async fn refused(config: &ZenohConfig) -> Option<LinkError> {
    for endpoint in &config.connect {
        let told = match (endpoint.split_once('/'), &config.credentials) {
            (Some(("tls", address)), Some(keys)) => with_tls(endpoint, address, keys).await,
            (Some(("tcp", address)), _) => in_clear(endpoint, address).await,
            (Some(_) | None, _) => None,
        };
        if told.is_some() {
            return told;
        }
    }
    None
}

fn bad(what: String, hint: &str) -> LinkError {
    LinkError::Keys { what, hint: hint.to_owned() }
}

async fn reached(endpoint: &str, address: &str) -> Result<TcpStream, LinkError> {
    let address = address.split(['?', '#']).next().unwrap_or_default();
    let nobody = |why: &str| LinkError::Transport { what: format!("connecting to `{endpoint}`"), why: why.to_owned() };
    match timeout(STEP, TcpStream::connect(address)).await {
        Ok(Ok(stream)) => Ok(stream),
        Ok(Err(why)) => Err(nobody(&why.to_string())),
        Err(_elapsed) => Err(nobody("nobody answers there")),
    }
}

/// Whether the other end of a plain connection wants TLS.
async fn in_clear(endpoint: &str, address: &str) -> Option<LinkError> {
    let mut stream = match reached(endpoint, address).await {
        Ok(stream) => stream,
        Err(why) => return Some(why),
    };
    let mut first = [0_u8];
    let look = async {
        // This is a message of no protocol: a program that speaks TLS says so.
        stream.write_all(b"socrates?\r\n").await?;
        stream.read_exact(&mut first).await
    };
    timeout(STEP, look).await.ok()?.ok()?;
    (first == [ALERT]).then(|| {
        let tls = format!("{TLS}{address}");
        bad(format!("`{endpoint}` wants keys: TLS is spoken there"), &format!("connect to `{tls}` with --keys FOLDER"))
    })
}

async fn with_tls(endpoint: &str, address: &str, keys: &Credentials) -> Option<LinkError> {
    let host = address.rsplit_once(':').map_or(address, |(host, _port)| host);
    let Ok(name) = ServerName::try_from(host.to_owned()) else {
        return Some(bad(
            format!("`{host}` in `{endpoint}` is no host name and no IPv4 address"),
            "write tls/NAME:PORT; an IPv6 address needs a name",
        ));
    };
    let settings = match client(keys) {
        Ok(settings) => settings,
        Err(why) => return Some(bad(format!("the keys in `{}` cannot be used: {why}", keys.folder().display()), ANEW)),
    };
    let stream = match reached(endpoint, address).await {
        Ok(stream) => stream,
        Err(why) => return Some(why),
    };
    match timeout(STEP, TlsConnector::from(Arc::new(settings)).connect(name, stream)).await {
        Err(_elapsed) => Some(bad(format!("`{endpoint}` does not speak TLS"), IN_CLEAR)),
        Ok(Err(why)) => Some(distrusted(endpoint, host, &why)),
        Ok(Ok(mut stream)) => {
            // Our own certificate is judged after the handshake is over here.
            let mut first = [0_u8];
            match timeout(STEP, stream.read(&mut first)).await {
                Ok(Err(why)) if tls_error(&why).is_some() => Some(bad(
                    format!("`{endpoint}` refuses the keys in `{}`: {why}", keys.folder().display()),
                    "they were made for another deployment, or hold no more; copy the folder of the role again",
                )),
                Ok(Ok(_) | Err(_)) | Err(_) => None,
            }
        }
    }
}

/// Where keys do not belong to the other end.
const ANEW: &str = "copy the folder of the role again, as `socrates cluster keys` made it";
/// Where the other end has no keys.
const IN_CLEAR: &str = "was it started with --keys, on an endpoint that begins with `tls/`?";

fn client(keys: &Credentials) -> Result<ClientConfig, String> {
    let certificates = |which: RoleFile| -> Result<Vec<CertificateDer<'static>>, String> {
        let read = CertificateDer::pem_file_iter(keys.file(which)).map_err(|why| why.to_string())?;
        read.collect::<Result<_, _>>().map_err(|why| why.to_string())
    };
    let mut roots = RootCertStore::empty();
    for root in certificates(RoleFile::Authority)? {
        roots.add(root).map_err(|why| why.to_string())?;
    }
    let file = keys.file(RoleFile::Key);
    let key = PrivateKeyDer::from_pem_file(&file).map_err(|why| why.to_string())?;
    ClientConfig::builder_with_provider(Arc::new(ring::default_provider()))
        .with_protocol_versions(&[&TLS13])
        .map_err(|why| why.to_string())?
        .with_root_certificates(roots)
        .with_client_auth_cert(certificates(RoleFile::Certificate)?, key)
        .map_err(|why| why.to_string())
}

fn tls_error(why: &std::io::Error) -> Option<&Error> {
    why.get_ref()?.downcast_ref::<Error>()
}

/// What is wrong with the other end.
fn distrusted(endpoint: &str, host: &str, why: &std::io::Error) -> LinkError {
    match tls_error(why) {
        Some(Error::InvalidCertificate(CertificateError::UnknownIssuer | CertificateError::BadSignature)) => bad(
            format!(
                "`{endpoint}` is of another deployment: its certificate was not signed by the authority of these keys"
            ),
            ANEW,
        ),
        Some(Error::InvalidCertificate(
            CertificateError::NotValidForName | CertificateError::NotValidForNameContext { .. },
        )) => bad(
            format!("the certificate of `{endpoint}` does not name the host `{host}`"),
            &format!("connect by a name that it has, or make the keys with `--host {host}`"),
        ),
        Some(Error::InvalidCertificate(reason)) => bad(
            format!("the certificate of `{endpoint}` is refused: {reason}"),
            "make new keys with `socrates cluster keys`",
        ),
        Some(Error::InvalidMessage(_)) | None => bad(format!("`{endpoint}` does not speak TLS ({why})"), IN_CLEAR),
        Some(other) => bad(format!("`{endpoint}` and these keys do not go together: {other}"), ANEW),
    }
}
