//! Keys at the door: the folder of a role, read and checked before anything connects.
//!
//! The transport reads the files itself, by their paths, so that no secret stands in a setting, an endpoint or a log line.

use std::path::{Path, PathBuf};

use crate::error::LinkError;
use crate::rules::Role;

/// A file in the folder of a role.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RoleFile {
    /// Certificate of the authority that everybody of a deployment trusts.
    Authority,
    /// Certificate of this role.
    Certificate,
    /// Its private key.
    Key,
}

impl RoleFile {
    /// Every file of a role.
    pub const ALL: [Self; 3] = [Self::Authority, Self::Certificate, Self::Key];

    /// Name of the file.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Authority => "ca.pem",
            Self::Certificate => "cert.pem",
            Self::Key => "key.pem",
        }
    }
}

/// Keys that were read, fit together, and hold now.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Credentials {
    folder: PathBuf,
    role: Role,
    days_left: u64,
}

impl Credentials {
    /// Role that the certificate names.
    #[must_use]
    pub const fn role(&self) -> Role {
        self.role
    }

    /// Whole days that the certificate held when it was read.
    #[must_use]
    pub const fn days_left(&self) -> u64 {
        self.days_left
    }

    /// The folder, as a whole path.
    #[must_use]
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Path of a file.
    #[must_use]
    pub fn file(&self, which: RoleFile) -> PathBuf {
        self.folder.join(which.name())
    }

    /// Reads the folder of a role. `now_s` is the wall time, s since 1970.
    ///
    /// # Errors
    /// [`LinkError::Keys`] when a file is missing, is not what it should be, can be read by others, or does not fit the others;
    /// when the certificate holds no more or not yet. [`LinkError::Absent`] in a program without the feature `zenoh`.
    #[cfg(not(feature = "zenoh"))]
    pub fn read(_folder: &Path, _now_s: u64) -> Result<Self, LinkError> {
        Err(LinkError::Absent { feature: "zenoh" })
    }

    /// Reads the folder of a role. `now_s` is the wall time, s since 1970.
    ///
    /// # Errors
    /// [`LinkError::Keys`] when a file is missing, is not what it should be, can be read by others, or does not fit the others;
    /// when the certificate holds no more or not yet. [`LinkError::Absent`] in a program without the feature `zenoh`.
    #[cfg(feature = "zenoh")]
    pub fn read(folder: &Path, now_s: u64) -> Result<Self, LinkError> {
        door::read(folder, now_s)
    }
}

#[cfg(feature = "zenoh")]
mod door {
    use std::os::unix::fs::{MetadataExt as _, PermissionsExt as _};

    use x509_parser::certificate::X509Certificate;
    use x509_parser::pem::parse_x509_pem;

    use super::{Credentials, LinkError, Path, Role, RoleFile};

    /// Largest file that is read, bytes: a chain of certificates has a few thousand.
    const MOST_BYTES: u64 = 64 * 1024;
    /// Signs that have a meaning in an endpoint of the transport, to which paths are handed.
    const ODD: [char; 4] = [';', '#', '?', '|'];
    /// Seconds of a day.
    const DAY_S: i64 = 24 * 3600;
    /// What is said wherever a file does not fit.
    const ANEW: &str = "copy the folder of the role again, as `socrates cluster keys` made it";

    fn bad(what: String, hint: &str) -> LinkError {
        LinkError::Keys { what, hint: hint.to_owned() }
    }

    pub(super) fn read(folder: &Path, now_s: u64) -> Result<Credentials, LinkError> {
        let whole = std::fs::canonicalize(folder).map_err(|why| {
            let hint = "name the folder of a role, such as keys/worker; `socrates cluster keys` makes them";
            bad(format!("there are no keys in `{}`: {why}", folder.display()), hint)
        })?;
        // What is written as it stands is the same in the settings of the transport.
        let plain = |path: &str| !path.contains(ODD) && format!("{path:?}").len() == path.len() + 2;
        if !whole.to_str().is_some_and(plain) {
            let what =
                format!("the path of the keys `{}` holds `;`, `#`, `?`, `|`, quotes or odd signs", whole.display());
            return Err(bad(what, "move the folder to a path without them"));
        }
        let file = |which: RoleFile| whole.join(which.name());
        private(&file(RoleFile::Key))?;
        let authority = pem(&file(RoleFile::Authority))?;
        let authority = certificate(&file(RoleFile::Authority), &authority)?;
        let der = pem(&file(RoleFile::Certificate))?;
        let cert = certificate(&file(RoleFile::Certificate), &der)?;
        let shown = file(RoleFile::Certificate).display().to_string();
        if cert.verify_signature(Some(authority.public_key())).is_err() {
            let what =
                format!("`{shown}` was not signed by the authority of `{}`", file(RoleFile::Authority).display());
            return Err(bad(what, ANEW));
        }
        holds(&file(RoleFile::Authority), &authority, now_s)?;
        let days_left = holds(&file(RoleFile::Certificate), &cert, now_s)?;
        let name = cert.subject().iter_common_name().next().and_then(|name| name.as_str().ok()).unwrap_or_default();
        let role = Role::of_name(name).ok_or_else(|| {
            let name: String = name.chars().take(80).collect();
            let known: Vec<&str> = Role::ALL.map(Role::name).into();
            bad(format!("`{shown}` is for the role `{name}`"), &format!("roles are {}", known.join(", ")))
        })?;
        let key = text(&file(RoleFile::Key))?;
        let key = rcgen::KeyPair::from_pem(&key).map_err(|why| {
            bad(format!("`{}` is not a private key in PEM (PKCS #8): {why}", file(RoleFile::Key).display()), ANEW)
        })?;
        if key.public_key_raw() != &*cert.public_key().subject_public_key.data {
            return Err(bad(format!("`{}` is not the key of `{shown}`", file(RoleFile::Key).display()), ANEW));
        }
        Ok(Credentials { folder: whole, role, days_left })
    }

    /// A key that others can read is no secret. One that the system hands to a service is root's, and the service reads it by its group,
    /// as secrets of Kubernetes are mounted.
    fn private(key: &Path) -> Result<(), LinkError> {
        let there = std::fs::metadata(key).map_err(|why| unread(key, &why))?;
        let mode = there.permissions().mode();
        let ours = std::fs::metadata("/proc/self").is_ok_and(|own| own.uid() == there.uid());
        let by_group = if there.uid() == 0 && !ours { 0o040 } else { 0 };
        if mode & 0o077 & !by_group == 0 {
            return Ok(());
        }
        let what = format!("`{}` can be used by others than its owner (mode {:03o})", key.display(), mode & 0o777);
        Err(bad(what, &format!("`chmod 600 {}`", key.display())))
    }

    fn unread(file: &Path, why: &std::io::Error) -> LinkError {
        bad(format!("cannot read `{}`: {why}", file.display()), ANEW)
    }

    fn text(file: &Path) -> Result<String, LinkError> {
        let length = std::fs::metadata(file).map_err(|why| unread(file, &why))?.len();
        if length > MOST_BYTES {
            return Err(bad(format!("`{}` has {length} bytes, at most {MOST_BYTES} are read", file.display()), ANEW));
        }
        std::fs::read_to_string(file).map_err(|why| unread(file, &why))
    }

    /// The first certificate of a file, as bytes.
    fn pem(file: &Path) -> Result<Vec<u8>, LinkError> {
        let text = text(file)?;
        let no = |why: &str| bad(format!("`{}` is not a certificate in PEM: {why}", file.display()), ANEW);
        let (_, found) = parse_x509_pem(text.as_bytes()).map_err(|why| no(&why.to_string()))?;
        if found.label != "CERTIFICATE" {
            return Err(no(&format!("it holds a `{}`", found.label.chars().take(40).collect::<String>())));
        }
        Ok(found.contents)
    }

    fn certificate<'d>(file: &Path, der: &'d [u8]) -> Result<X509Certificate<'d>, LinkError> {
        let read = x509_parser::parse_x509_certificate(der);
        read.map(|(_, cert)| cert).map_err(|why| bad(format!("`{}` is not a certificate: {why}", file.display()), ANEW))
    }

    /// Whole days that it still holds.
    fn holds(file: &Path, cert: &X509Certificate<'_>, now_s: u64) -> Result<u64, LinkError> {
        let now = i64::try_from(now_s).unwrap_or(i64::MAX);
        let (from, to) = (&cert.validity().not_before, &cert.validity().not_after);
        if now > to.timestamp() {
            let what = format!("`{}` holds no more since {to}", file.display());
            return Err(bad(what, "make new keys with `socrates cluster keys`, or set the clock of this machine"));
        }
        if now < from.timestamp() {
            let what = format!("`{}` does not hold before {from}", file.display());
            return Err(bad(what, "set the clock of this machine"));
        }
        Ok(u64::try_from((to.timestamp() - now) / DAY_S).unwrap_or_default())
    }
}
