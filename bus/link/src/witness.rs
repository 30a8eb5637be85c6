//! Judges a router's certificate as the transport does, and keeps what was wrong with it: the library that shakes hands tells it as a
//! number and a sentence only.

use std::sync::{Arc, Mutex, PoisonError};

use quinn::rustls::client::WebPkiServerVerifier;
use quinn::rustls::client::danger::{HandshakeSignatureValid, ServerCertVerified, ServerCertVerifier};
use quinn::rustls::crypto::ring;
use quinn::rustls::pki_types::{CertificateDer, ServerName, UnixTime};
use quinn::rustls::{DigitallySignedStruct, Error, RootCertStore, SignatureScheme};

/// A judge of certificates who can be asked afterwards.
#[derive(Debug)]
pub(crate) struct Witness {
    judge: Arc<WebPkiServerVerifier>,
    complaint: Mutex<Option<Error>>,
}

impl Witness {
    /// One that trusts these authorities and no others.
    pub(crate) fn trusting(roots: RootCertStore) -> Result<Self, String> {
        let provider = Arc::new(ring::default_provider());
        let judge = WebPkiServerVerifier::builder_with_provider(Arc::new(roots), provider).build();
        Ok(Self { judge: judge.map_err(|why| why.to_string())?, complaint: Mutex::default() })
    }

    /// What was wrong with the last certificate; none where nothing was.
    pub(crate) fn complaint(&self) -> Option<Error> {
        self.complaint.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    fn keep<T>(&self, judged: Result<T, Error>) -> Result<T, Error> {
        *self.complaint.lock().unwrap_or_else(PoisonError::into_inner) = judged.as_ref().err().cloned();
        judged
    }
}

impl ServerCertVerifier for Witness {
    fn verify_server_cert(
        &self,
        certificate: &CertificateDer<'_>,
        between: &[CertificateDer<'_>],
        name: &ServerName<'_>,
        stapled: &[u8],
        now: UnixTime,
    ) -> Result<ServerCertVerified, Error> {
        self.keep(self.judge.verify_server_cert(certificate, between, name, stapled, now))
    }

    fn verify_tls12_signature(
        &self,
        message: &[u8],
        certificate: &CertificateDer<'_>,
        signed: &DigitallySignedStruct,
    ) -> Result<HandshakeSignatureValid, Error> {
        self.keep(self.judge.verify_tls12_signature(message, certificate, signed))
    }

    fn verify_tls13_signature(
        &self,
        message: &[u8],
        certificate: &CertificateDer<'_>,
        signed: &DigitallySignedStruct,
    ) -> Result<HandshakeSignatureValid, Error> {
        self.keep(self.judge.verify_tls13_signature(message, certificate, signed))
    }

    fn supported_verify_schemes(&self) -> Vec<SignatureScheme> {
        self.judge.supported_verify_schemes()
    }
}
