//! What lies in a work folder: the job store and the artifacts.

use std::path::{Path, PathBuf};

use socrates_kit::LocalBlobs;
use socrates_model::Digest;
use socrates_store::StoreError;

use crate::exit::Diagnostic;

/// Where the artifacts of a work folder lie.
pub(crate) fn blobs(work: &Path) -> LocalBlobs {
    LocalBlobs::new(work.join("blobs"), false)
}

/// The job store of a work folder.
#[must_use]
pub fn store(work: &Path) -> PathBuf {
    work.join("jobs.sqlite")
}

/// An artifact of a work folder.
pub(crate) fn fetch(blobs: &LocalBlobs, digest: &Digest) -> Result<Vec<u8>, Diagnostic> {
    blobs.get(digest).map_err(|why| Diagnostic::resumes(format!("artifact {} cannot be read: {why}", digest.short())))
}

/// What is said of a store that cannot be read.
pub(crate) fn unread(why: StoreError) -> Diagnostic {
    Diagnostic::resumes(format!("the job store cannot be read: {why}"))
}
