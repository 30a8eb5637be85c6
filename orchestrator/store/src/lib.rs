//! The job store: every scenario, job, attempt and result, durable before anybody sees it.
//!
//! ```text
//! rows of a step ─► save (one transaction) ─► disk      load ─► Snapshot ─► State
//!                                              └─► audit ─► what is wrong with it
//! ```
//!
//! [`Store`] is what the orchestrator's shell needs; [`SqliteStore`] keeps it in one file,
//! [`MemoryStore`] in memory for tests. Artifacts live beside it, by content address; only small
//! texts that came inside a report are kept here too, so that they are as durable as the report.
//! [`audit()`] asks the file alone whether it is right, by rules that share nothing with the state machine.
//!
//! *Never here:* a decision about a job, the bus, a clock.

mod audit;
mod memory;
mod reader;
mod schema;
mod sqlite;

#[cfg(test)]
mod promises;

use std::path::PathBuf;

use socrates_model::Digest;
use socrates_orchestrator::{Row, Snapshot};

pub use audit::{Audit, Checked, Counts, Named, Stands, audit};
pub use memory::MemoryStore;
pub use reader::{Reader, Standing};
pub use sqlite::{Durability, SqliteStore};

/// Layout number of the tables. A store with a larger one is refused; a smaller one is read and written on as this one.
///
/// Since 3, batches have limits and series; a program of before would take the scenarios of a series that are not made for none.
/// Since 2, the run of a job stands in its key alone. A program of before would take every run for the reference's.
pub const SCHEMA_VERSION: u32 = 3;

/// Entries of the outbox that are kept over a restart.
pub const OUTBOX: u64 = 10_000;

/// Why the store cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// Another process has it.
    #[error("the job store `{path}` is in use by {holder}; one orchestrator per store is allowed")]
    Locked {
        /// Its file.
        path: PathBuf,
        /// The process that has it: `process 4711`.
        holder: String,
    },
    /// The folder or file cannot be made or written.
    #[error("the job store `{path}` cannot be written")]
    Unwritable {
        /// Its file.
        path: PathBuf,
        /// Why.
        #[source]
        source: std::io::Error,
    },
    /// The disk is full; nothing of the transaction was kept.
    #[error("the disk under the job store `{path}` is full; what was committed is kept")]
    Full {
        /// Its file.
        path: PathBuf,
    },
    /// It was written by a newer program.
    #[error("the job store `{path}` has layout `{found}`; this program reads layouts up to `{SCHEMA_VERSION}`")]
    Newer {
        /// Its file.
        path: PathBuf,
        /// Layout found.
        found: u32,
    },
    /// It is a database of something else.
    #[error("`{path}` is a database, and no job store: it lacks the table `meta`")]
    Stranger {
        /// Its file.
        path: PathBuf,
    },
    /// A row cannot be read or written as what it should be.
    #[error("a row of table `{table}` in the job store is not what it should be")]
    Row {
        /// Which table.
        table: &'static str,
        /// Why.
        #[source]
        source: serde_json::Error,
    },
    /// A second result for a job; the first stays.
    #[error("job `{job}` has a result already; a job has exactly one")]
    SecondResult {
        /// Which.
        job: String,
    },
    /// Anything else that `SQLite` says.
    #[error("the job store `{path}` failed")]
    Sqlite {
        /// Its file.
        path: PathBuf,
        /// Why.
        #[source]
        source: rusqlite::Error,
    },
}

/// Where the rows of a step go.
pub trait Store: Send {
    /// Saves rows in one transaction: all or none, durable on return.
    ///
    /// # Errors
    /// [`StoreError::Full`], [`StoreError::Unwritable`], [`StoreError::SecondResult`] and others;
    /// nothing was saved then.
    fn save(&mut self, rows: &[Row]) -> Result<(), StoreError>;

    /// Begins a new reign, one number higher than the last, and reads everything.
    ///
    /// # Errors
    /// When a row cannot be read, or the new reign cannot be written.
    fn load(&mut self) -> Result<Snapshot, StoreError>;

    /// A small text that came with a report.
    ///
    /// # Errors
    /// When the store cannot be read.
    fn text(&self, digest: &Digest) -> Result<Option<String>, StoreError>;

    /// Addresses of all small texts.
    ///
    /// # Errors
    /// When the store cannot be read.
    fn texts(&self) -> Result<Vec<Digest>, StoreError>;

    /// What is wrong with the tables; empty when nothing is.
    ///
    /// # Errors
    /// When the store cannot be read.
    fn fsck(&self) -> Result<Vec<String>, StoreError>;
}

/// What is wrong with rows as such: orphans, second results, states that do not fit.
fn check(snapshot: &Snapshot) -> Vec<String> {
    use socrates_orchestrator::JobState;
    use std::collections::{BTreeMap, BTreeSet};
    let mut wrong = Vec::new();
    let scenarios: BTreeSet<_> = snapshot.scenarios.iter().map(|scenario| &scenario.spec.id).collect();
    let jobs: BTreeMap<_, _> = snapshot.jobs.iter().map(|job| (&job.key, job)).collect();
    let results: BTreeMap<_, _> = snapshot.results.iter().map(|(key, result)| (key, result)).collect();
    for (key, job) in &jobs {
        if !scenarios.contains(&key.scenario) {
            wrong.push(format!("job `{key}` belongs to no scenario"));
        }
        if results.contains_key(key) != (job.state == JobState::Succeeded) {
            wrong.push(format!("job `{key}` is {}, its result is another matter", job.state.name()));
        }
        if let Some(source) = job.sources.values().find(|source| !jobs.contains_key(source)) {
            wrong.push(format!("job `{key}` waits for `{source}`, which is not there"));
        }
    }
    for key in results.keys().filter(|key| !jobs.contains_key(*key)) {
        wrong.push(format!("a result belongs to `{key}`, which is not there"));
    }
    let mut fences: BTreeMap<&socrates_model::job::JobKey, u64> = BTreeMap::new();
    for (key, attempt) in &snapshot.attempts {
        if !jobs.contains_key(key) {
            wrong.push(format!("attempt `{}` belongs to `{key}`, which is not there", attempt.number));
        }
        if fences.insert(key, attempt.fence).is_some_and(|before| before >= attempt.fence) {
            wrong.push(format!(
                "attempt `{}` of `{key}` has fence `{}`, not above the last",
                attempt.number, attempt.fence
            ));
        }
    }
    wrong
}
