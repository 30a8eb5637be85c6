//! Reports that are not recorded yet, on disk: a worker that dies between work and answer loses nothing.

use std::fs::{self, File};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use socrates_link::{Envelope, decode, encode};
use socrates_model::Digest;
use socrates_model::wire::Report;

use crate::error::KitError;

/// Kind of a spooled message; the same as on the bus.
pub(crate) const KIND_REPORT: &str = "report";

/// A folder with one file per unrecorded report.
#[derive(Debug, Clone)]
pub struct Spool {
    root: PathBuf,
    durable: bool,
}

impl Spool {
    /// Opens the folder, making it where needed. Durable: a report is forced to disk before it is sent.
    ///
    /// # Errors
    /// [`KitError::Folder`].
    pub fn open(root: impl Into<PathBuf>, durable: bool) -> Result<Self, KitError> {
        let root = root.into();
        fs::create_dir_all(&root).map_err(|why| folder(&root, &why))?;
        Ok(Self { root, durable })
    }

    /// File of a report: one per attempt.
    fn path(&self, report: &Report) -> PathBuf {
        let name = Digest::of(format!("{}|{}|{}", report.key, report.attempt, report.fence).as_bytes());
        self.root.join(format!("{}-{}.report", report.key.stage, name.short()))
    }

    /// Keeps a report until [`Spool::done`].
    ///
    /// # Errors
    /// [`KitError::Link`] when it is too large for the bus, [`KitError::Folder`].
    pub fn keep(&self, report: &Report) -> Result<(), KitError> {
        let bytes = encode(&Envelope::fresh(KIND_REPORT, &report.instance, 0, report))?;
        let path = self.path(report);
        let temp = path.with_extension("tmp");
        let write = || -> io::Result<()> {
            let mut file = File::create(&temp)?;
            file.write_all(&bytes)?;
            if self.durable {
                file.sync_all()?;
            }
            fs::rename(&temp, &path)?;
            if self.durable { File::open(&self.root)?.sync_all() } else { Ok(()) }
        };
        write().map_err(|why| folder(&path, &why))
    }

    /// Forgets a recorded report.
    ///
    /// # Errors
    /// [`KitError::Folder`]; one that is gone already is none.
    pub fn done(&self, report: &Report) -> Result<(), KitError> {
        let path = self.path(report);
        match fs::remove_file(&path) {
            Err(why) if why.kind() != io::ErrorKind::NotFound => Err(folder(&path, &why)),
            Ok(()) | Err(_) => Ok(()),
        }
    }

    /// Reports left by an earlier process, in the order of their names. A file that cannot be read is put aside.
    ///
    /// # Errors
    /// [`KitError::Folder`].
    pub fn leftovers(&self) -> Result<Vec<Report>, KitError> {
        let mut paths = Vec::new();
        for entry in fs::read_dir(&self.root).map_err(|why| folder(&self.root, &why))? {
            let path = entry.map_err(|why| folder(&self.root, &why))?.path();
            if path.extension().is_some_and(|extension| extension == "report") {
                paths.push(path);
            }
        }
        paths.sort();
        let mut reports = Vec::new();
        for path in paths {
            let bytes = fs::read(&path).map_err(|why| folder(&path, &why))?;
            match decode::<Report>(KIND_REPORT, &bytes) {
                Ok(envelope) => reports.push(envelope.body),
                Err(why) => {
                    tracing::warn!(file = %path.display(), %why, "a spooled report cannot be read and is put aside");
                    fs::rename(&path, path.with_extension("bad")).map_err(|why| folder(&path, &why))?;
                }
            }
        }
        Ok(reports)
    }
}

fn folder(path: &Path, why: &io::Error) -> KitError {
    KitError::Folder { path: path.to_path_buf(), why: why.to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use socrates_model::ScenarioId;
    use socrates_model::job::{JobKey, Stage};
    use socrates_model::wire::Outcome;

    fn report(attempt: u32) -> Report {
        let key = JobKey {
            scenario: ScenarioId::new("s").unwrap(),
            stage: Stage::Paths,
            item: socrates_model::job::Item::Whole,
            revision: 0,
        };
        Report {
            instance: "i".into(),
            key,
            attempt,
            fence: 1,
            outcome: Outcome::Ok,
            artifacts: vec![],
            wall_ms: 0,
            tokens: (0, 0),
            remark: String::new(),
            repair: None,
            anew: Vec::new(),
            verdict: None,
            rates: None,
        }
    }

    #[test]
    fn kept_reports_are_found_by_the_next_process_until_they_are_done() {
        let dir = tempfile::tempdir().unwrap();
        let spool = Spool::open(dir.path().join("spool"), true).unwrap();
        spool.keep(&report(1)).unwrap();
        spool.keep(&report(1)).unwrap();
        spool.keep(&report(2)).unwrap();
        let next = Spool::open(dir.path().join("spool"), true).unwrap();
        assert_eq!(next.leftovers().unwrap().len(), 2);
        next.done(&report(1)).unwrap();
        next.done(&report(1)).unwrap();
        assert_eq!(next.leftovers().unwrap(), [report(2)]);
    }

    #[test]
    fn a_broken_file_is_put_aside_and_stops_nobody() {
        let dir = tempfile::tempdir().unwrap();
        let spool = Spool::open(dir.path(), false).unwrap();
        spool.keep(&report(1)).unwrap();
        fs::write(dir.path().join("paths-x.report"), b"half").unwrap();
        assert_eq!(spool.leftovers().unwrap().len(), 1);
        assert!(dir.path().join("paths-x.bad").exists());
    }
}
