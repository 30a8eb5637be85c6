//! The end of one scenario: its bundle, or why there is none.

use std::path::Path;

use socrates_model::job::Stage;
use socrates_model::{Family, Fault, JobState, ScenarioId};
use socrates_orchestrator::Snapshot;
use socrates_store::Reader;

use crate::bundle::{self, Bundle, Fetch, Past};
use crate::exit::{Code, Diagnostic};
use crate::history::History;
use crate::keep::Keep;
use crate::prepare::Prepared;
use crate::work;

/// A finished scenario of which a bundle is to be written.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Finished<'a> {
    /// Folder of the bundle.
    pub(crate) dir: &'a Path,
    /// Work folder on the same file system.
    pub(crate) work: &'a Path,
    /// Which.
    pub(crate) id: &'a ScenarioId,
    /// What it is made from.
    pub(crate) prepared: &'a Prepared,
    /// Its seed.
    pub(crate) seed: u64,
    /// Whether no other is written meanwhile.
    pub(crate) alone: bool,
    /// What is kept of it.
    pub(crate) keep: Keep,
}

impl Finished<'_> {
    /// The bundle, written from what the job store and the artifacts of the work folder tell of it.
    pub(crate) fn by_store(&self, reader: &Reader) -> Result<Bundle, Diagnostic> {
        let rows = reader.scenario(self.id).map_err(work::unread)?;
        let blobs = work::blobs(self.work);
        self.by_rows(rows, &|digest| work::fetch(&blobs, digest))
    }

    /// The bundle, written from these rows, with artifacts from wherever they are.
    pub(crate) fn by_rows(&self, rows: Snapshot, fetch: &Fetch<'_>) -> Result<Bundle, Diagnostic> {
        let Self { dir, work, id, prepared, seed, alone, keep } = *self;
        let gone = || Diagnostic::resumes(format!("the job store has lost `{id}`"));
        let status = socrates_orchestrator::standing(rows.clone()).pop().ok_or_else(gone)?;
        let history = History::of_rows(rows);
        let past = Past { status: &status, jobs: history.of(id), fetch, work, alone, keep };
        let made = conclude(dir, prepared, seed, &past);
        // One of several that could not be made leaves behind what makes it again; a single one is told at once.
        if let (Err(why), Some(library), false) = (&made, dir.parent(), alone) {
            bundle::dead::write(library, prepared, seed, &past, why)?;
        }
        made
    }
}

/// Writes the bundle, or says why there is none.
fn conclude(dir: &Path, prepared: &Prepared, seed: u64, past: &Past<'_>) -> Result<Bundle, Diagnostic> {
    let status = past.status;
    let scored = status.jobs.iter().any(|job| job.key.stage == Stage::Scoring && job.state == JobState::Succeeded);
    if scored {
        return bundle::write(dir, prepared, seed, past);
    }
    let faults: Vec<Fault> =
        status.jobs.iter().filter(|job| job.state != JobState::Succeeded).flat_map(|job| job.faults.clone()).collect();
    let author = faults.iter().any(|fault| fault.code.family() == Family::Transport);
    let mut diagnostic = Diagnostic::faults(
        match status.result {
            Some(end) => format!("the scenario ended as `{end}` before it could be simulated"),
            None => "the scenario has not ended and was not simulated".to_owned(),
        },
        &faults,
        if author {
            "`socrates config author` shows which author is asked; `--author offline` needs none"
        } else {
            "`socrates explain CODE` says what each fault means; say it in other words, or look at it with --ask"
        },
    );
    diagnostic.code = if author { Code::Author } else { Code::NotRealised };
    Err(diagnostic)
}
