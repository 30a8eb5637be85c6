//! Where shared memory is arranged, also for a program that was built without it.

use std::path::{Path as FsPath, PathBuf};
use std::sync::{Arc, OnceLock};

/// Where shared memory is arranged: a corner of one user, which nobody else can enter. Writers and readers must agree.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ShmConfig {
    /// Folder of the small files by which both sides find each other. Made where needed; it has to belong to `user` alone.
    pub root: PathBuf,
    /// Begin of every segment's name.
    pub prefix: String,
    /// Number of the user whose corner it is.
    pub user: u32,
}

impl ShmConfig {
    /// The corner of a user in a folder for temporary files: `FOLDER/socrates-shm-USER`.
    #[must_use]
    pub fn of_user(folder: &FsPath, user: u32) -> Self {
        Self { root: folder.join(format!("socrates-shm-{user}")), prefix: format!("socrates_{user}_"), user }
    }
}

/// The service of shared memory that has the ticks of a run, known from its announcement on.
#[derive(Debug, Clone, Default)]
pub struct SharedMemory(Arc<OnceLock<String>>);

impl SharedMemory {
    /// Its name; none where there is none, or not yet.
    #[must_use]
    pub fn name(&self) -> Option<String> {
        self.0.get().cloned()
    }

    /// It is there under this name.
    #[cfg_attr(not(feature = "shm"), expect(dead_code, reason = "without shared memory there is never one"))]
    pub(crate) fn is_at(&self, name: &str) {
        self.0.get_or_init(|| name.to_owned());
    }
}

/// Shared memory in a program that was built without the feature `shm`: no run has any, which is logged.
#[cfg(not(feature = "shm"))]
#[derive(Debug, Clone)]
pub struct ShmHost;

#[cfg(not(feature = "shm"))]
impl ShmHost {
    /// The shared memory that would be arranged so.
    #[must_use]
    pub fn new(_config: ShmConfig) -> Self {
        Self
    }

    /// None, with a line in the log that names the missing feature.
    #[must_use]
    pub fn sink(
        &self,
        run: &socrates_model::RunId,
    ) -> Option<(Box<dyn socrates_model::Onlooker + Send>, crate::SharedMemory)> {
        let why = crate::StreamError::Shm {
            run: run.to_string(),
            what: "joining",
            why: "this program was built without the feature `shm`".to_owned(),
        };
        tracing::warn!(%why, "no shared memory for this run");
        None
    }
}
