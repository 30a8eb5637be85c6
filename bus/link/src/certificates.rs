//! The certificates of a deployment: its authority signs one for each role and is forgotten.

use std::time::Duration;

use rcgen::{
    BasicConstraints, CertificateParams, CertifiedIssuer, DistinguishedName, DnType, ExtendedKeyUsagePurpose, IsCa,
    KeyPair, KeyUsagePurpose, date_time_ymd,
};

use crate::authority::{KeysWish, RoleKeys};
use crate::credentials::RoleFile;
use crate::rules::{Role, router_config};

/// Name of the authority in its certificate.
const AUTHORITY: &str = "SocRATES authority of one deployment";
/// Certificates hold from so long before they are made, s: clocks of machines differ.
const BEFORE_S: u64 = 24 * 3600;
/// Latest beginning that is written, s since 1970 (the year 2200): a clock beyond it is wrong.
const LATEST_S: u64 = 7_258_118_400;

/// The keys of every role, for these hosts.
pub(crate) fn made(hosts: &[String], wish: &KeysWish) -> Result<Vec<RoleKeys>, rcgen::Error> {
    let mut root = params(&[], AUTHORITY, wish)?;
    root.is_ca = IsCa::Ca(BasicConstraints::Constrained(0));
    root.key_usages = vec![KeyUsagePurpose::KeyCertSign, KeyUsagePurpose::CrlSign];
    let authority = CertifiedIssuer::self_signed(root, KeyPair::generate()?)?;
    let mut keys = Vec::new();
    for role in Role::ALL {
        let mut leaf = params(if role.listens() { hosts } else { &[] }, role.name(), wish)?;
        leaf.use_authority_key_identifier_extension = true;
        leaf.key_usages = vec![KeyUsagePurpose::DigitalSignature];
        if role.listens() {
            leaf.extended_key_usages.push(ExtendedKeyUsagePurpose::ServerAuth);
        }
        if role.connects() {
            leaf.extended_key_usages.push(ExtendedKeyUsagePurpose::ClientAuth);
        }
        let key = KeyPair::generate()?;
        let cert = leaf.signed_by(&key, &authority)?;
        let mut files = vec![
            (RoleFile::Authority.name(), authority.pem()),
            (RoleFile::Certificate.name(), cert.pem()),
            (RoleFile::Key.name(), key.serialize_pem()),
        ];
        if role == Role::Router {
            files.push(("router.json5", router_config()));
        }
        keys.push(RoleKeys { role, files });
    }
    Ok(keys)
}

/// What every certificate says.
fn params(hosts: &[String], name: &str, wish: &KeysWish) -> Result<CertificateParams, rcgen::Error> {
    let mut params = CertificateParams::new(hosts)?;
    params.distinguished_name = DistinguishedName::new();
    params.distinguished_name.push(DnType::CommonName, name);
    let epoch = date_time_ymd(1970, 1, 1);
    let now_s = wish.now_s.min(LATEST_S);
    params.not_before = epoch + Duration::from_secs(now_s.saturating_sub(BEFORE_S));
    params.not_after = epoch + Duration::from_secs(now_s + u64::from(wish.days) * 24 * 3600);
    Ok(params)
}
