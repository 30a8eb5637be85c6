//! Artifacts by content address: a folder on this host, or the orchestrator's over the bus.

use std::fs::{self, File};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use socrates_link::{Bus, LinkError};
use socrates_model::{Digest, TraceContext};

/// An artifact that could not be read or written.
#[derive(Debug, thiserror::Error)]
pub enum BlobError {
    /// Nobody has it.
    #[error("artifact `{digest}` is not there")]
    Missing {
        /// Which.
        digest: Digest,
    },
    /// What is there is not what its name says. It was put aside.
    #[error("artifact `{digest}` is torn: its content has the digest `{found}`")]
    Torn {
        /// Which.
        digest: Digest,
        /// Digest of what is there.
        found: Digest,
    },
    /// The file system refused.
    #[error("artifact file `{}`: {why}", path.display())]
    File {
        /// Which file.
        path: PathBuf,
        /// The system's words.
        why: io::Error,
    },
    /// The bus refused.
    #[error("artifact `{digest}` did not pass the bus")]
    Link {
        /// Which.
        digest: Digest,
        /// Why.
        #[source]
        why: LinkError,
    },
}

/// A folder of artifacts: `<root>/ab/<digest>`. Several processes may share it; writing twice is harmless.
#[derive(Debug, Clone)]
pub struct LocalBlobs {
    root: PathBuf,
    durable: bool,
}

/// Tells temporary files of one process apart.
static NEXT_TEMP: AtomicU64 = AtomicU64::new(0);

impl LocalBlobs {
    /// The folder, made when first written to. Durable: every write is forced to disk before it is visible.
    #[must_use]
    pub fn new(root: impl Into<PathBuf>, durable: bool) -> Self {
        Self { root: root.into(), durable }
    }

    /// The same folder, where what is put may be lost by a power cut.
    #[must_use]
    pub fn unforced(&self) -> Self {
        Self { root: self.root.clone(), durable: false }
    }

    /// The folder.
    #[must_use]
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// File of an artifact, whether it is there or not.
    #[must_use]
    pub fn path(&self, digest: &Digest) -> PathBuf {
        let name = digest.to_string();
        let shelf: String = name.chars().take(2).collect();
        self.root.join(shelf).join(name)
    }

    /// Whether the artifact is there. Its content is not looked at.
    #[must_use]
    pub fn has(&self, digest: &Digest) -> bool {
        self.path(digest).is_file()
    }

    /// The artifact, checked against its address.
    ///
    /// # Errors
    /// [`BlobError::Missing`], [`BlobError::Torn`], [`BlobError::File`].
    pub fn get(&self, digest: &Digest) -> Result<Vec<u8>, BlobError> {
        let path = self.path(digest);
        let bytes = match fs::read(&path) {
            Ok(bytes) => bytes,
            Err(why) if why.kind() == io::ErrorKind::NotFound => return Err(BlobError::Missing { digest: *digest }),
            Err(why) => return Err(BlobError::File { path, why }),
        };
        let found = Digest::of(&bytes);
        if found == *digest {
            return Ok(bytes);
        }
        // Put aside, so that the next put writes it anew.
        let aside = path.with_extension("torn");
        fs::rename(&path, aside).map_err(|why| BlobError::File { path, why })?;
        Err(BlobError::Torn { digest: *digest, found })
    }

    /// Stores an artifact: temporary file, forced to disk where durable, renamed.
    ///
    /// # Errors
    /// [`BlobError::File`].
    pub fn put(&self, bytes: &[u8]) -> Result<Digest, BlobError> {
        let digest = Digest::of(bytes);
        let path = self.path(&digest);
        if fs::metadata(&path).is_ok_and(|there| there.is_file() && there.len() == bytes.len() as u64) {
            return Ok(digest);
        }
        let temp = self.temp(&digest)?;
        let write = || -> io::Result<()> {
            let mut file = File::create(&temp)?;
            file.write_all(bytes)?;
            if self.durable { file.sync_all() } else { Ok(()) }
        };
        write().map_err(|why| {
            // Half of it would take room that the disk may not have.
            drop(fs::remove_file(&temp));
            BlobError::File { path: path.clone(), why }
        })?;
        self.reveal(&temp, &path)?;
        Ok(digest)
    }

    /// Takes a part of an artifact that comes in pieces; gives the number of bytes held so far, which is where the
    /// next part has to begin. The last part completes and checks it.
    ///
    /// # Errors
    /// [`BlobError::Torn`] when the whole has another digest (its parts are thrown away), [`BlobError::File`].
    pub fn put_part(&self, digest: &Digest, len: u64, offset: u64, bytes: &[u8]) -> Result<u64, BlobError> {
        if self.has(digest) {
            return Ok(len);
        }
        let path = self.root.join("parts").join(digest.to_string());
        let failed = |why: io::Error| BlobError::File { path: path.clone(), why };
        fs::create_dir_all(self.root.join("parts")).map_err(failed)?;
        let held = fs::metadata(&path).map_or(0, |there| there.len());
        if offset != held {
            return Ok(held);
        }
        let mut file = File::options().append(true).create(true).open(&path).map_err(failed)?;
        file.write_all(bytes).map_err(failed)?;
        drop(file);
        let held = held + bytes.len() as u64;
        if held < len {
            return Ok(held);
        }
        let whole = fs::read(&path).map_err(failed)?;
        fs::remove_file(&path).map_err(failed)?;
        let found = Digest::of(&whole);
        if found != *digest {
            return Err(BlobError::Torn { digest: *digest, found });
        }
        self.put(&whole)?;
        Ok(len)
    }

    fn temp(&self, digest: &Digest) -> Result<PathBuf, BlobError> {
        let folder = self.path(digest).parent().map_or_else(|| self.root.clone(), Path::to_path_buf);
        fs::create_dir_all(&folder).map_err(|why| BlobError::File { path: folder.clone(), why })?;
        let number = NEXT_TEMP.fetch_add(1, Ordering::Relaxed);
        Ok(folder.join(format!(".{}-{}-{number}.tmp", digest.short(), std::process::id())))
    }

    fn reveal(&self, temp: &Path, path: &Path) -> Result<(), BlobError> {
        fs::rename(temp, path).map_err(|why| BlobError::File { path: path.to_path_buf(), why })?;
        if let (true, Some(folder)) = (self.durable, path.parent()) {
            let synced = File::open(folder).and_then(|folder| folder.sync_all());
            synced.map_err(|why| BlobError::File { path: folder.to_path_buf(), why })?;
        }
        Ok(())
    }
}

/// Where a worker's artifacts are.
#[derive(Clone)]
pub enum Blobs {
    /// In a folder that the orchestrator shares.
    Local(LocalBlobs),
    /// At the orchestrator, in parts of at most 48 KiB.
    Bus,
}

impl Blobs {
    /// Fetches an artifact.
    ///
    /// # Errors
    /// As [`LocalBlobs::get`]; [`BlobError::Link`] over the bus.
    pub async fn get(&self, bus: &Arc<dyn Bus>, digest: Digest, timeout: Duration) -> Result<Vec<u8>, BlobError> {
        self.get_in(None, bus, digest, timeout).await
    }

    /// The same as a part of a trace.
    pub(crate) async fn get_in(
        &self,
        trace: Option<TraceContext>,
        bus: &Arc<dyn Bus>,
        digest: Digest,
        timeout: Duration,
    ) -> Result<Vec<u8>, BlobError> {
        match self {
            Self::Local(folder) => {
                let folder = folder.clone();
                off_thread(folder.path(&digest), move || folder.get(&digest)).await
            }
            Self::Bus => crate::blob_rpc::fetch(trace, bus, digest, timeout).await,
        }
    }

    /// Stores an artifact.
    ///
    /// # Errors
    /// As [`LocalBlobs::put`]; [`BlobError::Link`] over the bus.
    pub async fn put(&self, bus: &Arc<dyn Bus>, bytes: Vec<u8>, timeout: Duration) -> Result<Digest, BlobError> {
        self.put_in(None, bus, bytes, timeout).await
    }

    /// The same as a part of a trace.
    pub(crate) async fn put_in(
        &self,
        trace: Option<TraceContext>,
        bus: &Arc<dyn Bus>,
        bytes: Vec<u8>,
        timeout: Duration,
    ) -> Result<Digest, BlobError> {
        match self {
            Self::Local(folder) => {
                let folder = folder.clone();
                off_thread(folder.root().to_path_buf(), move || folder.put(&bytes)).await
            }
            Self::Bus => crate::blob_rpc::store(trace, bus, &bytes, timeout).await,
        }
    }
}

/// File work off the runtime's own threads.
pub(crate) async fn off_thread<T: Send + 'static>(
    path: PathBuf,
    work: impl FnOnce() -> Result<T, BlobError> + Send + 'static,
) -> Result<T, BlobError> {
    match tokio::task::spawn_blocking(work).await {
        Ok(result) => result,
        Err(why) => Err(BlobError::File { path, why: io::Error::other(why) }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_put_is_got_and_putting_twice_is_harmless() {
        let dir = tempfile::tempdir().unwrap();
        let blobs = LocalBlobs::new(dir.path().join("blobs"), true);
        let digest = blobs.put(b"hello").unwrap();
        assert_eq!(blobs.put(b"hello").unwrap(), digest);
        assert!(blobs.has(&digest));
        assert_eq!(blobs.get(&digest).unwrap(), b"hello");
        assert!(blobs.path(&digest).starts_with(dir.path().join("blobs").join(&digest.to_string()[..2])));
        let shelf: Vec<_> = fs::read_dir(blobs.path(&digest).parent().unwrap()).unwrap().collect();
        assert_eq!(shelf.len(), 1, "no temporary file stays");
    }

    #[test]
    fn a_torn_artifact_is_an_error_once_and_can_be_put_again() {
        let dir = tempfile::tempdir().unwrap();
        let blobs = LocalBlobs::new(dir.path(), false);
        let digest = blobs.put(b"hello").unwrap();
        fs::write(blobs.path(&digest), b"hellx").unwrap();
        assert!(matches!(blobs.get(&digest), Err(BlobError::Torn { .. })));
        assert!(matches!(blobs.get(&digest), Err(BlobError::Missing { .. })));
        blobs.put(b"hello").unwrap();
        assert_eq!(blobs.get(&digest).unwrap(), b"hello");
    }

    #[test]
    fn parts_come_together_and_a_repeated_part_is_told_where_to_go_on() {
        let dir = tempfile::tempdir().unwrap();
        let blobs = LocalBlobs::new(dir.path(), false);
        let digest = Digest::of(b"abcdef");
        assert_eq!(blobs.put_part(&digest, 6, 0, b"abc").unwrap(), 3);
        assert_eq!(blobs.put_part(&digest, 6, 0, b"abc").unwrap(), 3);
        assert_eq!(blobs.put_part(&digest, 6, 3, b"def").unwrap(), 6);
        assert_eq!(blobs.get(&digest).unwrap(), b"abcdef");
        let wrong = Digest::of(b"other");
        assert!(matches!(blobs.put_part(&wrong, 3, 0, b"abc"), Err(BlobError::Torn { .. })));
        assert_eq!(blobs.put_part(&wrong, 5, 0, b"ot").unwrap(), 2, "a torn upload begins anew");
    }
}
