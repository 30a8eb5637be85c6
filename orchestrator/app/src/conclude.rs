//! The end of one scenario: its bundle, or why there is none.

use std::path::Path;

use socrates_model::job::Stage;
use socrates_model::{Digest, Family, Fault, JobState, ScenarioId};
use socrates_store::Reader;

use crate::bundle::{self, Bundle, Past};
use crate::exit::{Code, Complaint};
use crate::history::History;
use crate::prepare::Prepared;
use crate::work;

/// The bundle of one finished scenario, written from what the job store and the artifacts of a work folder tell of it. `alone`: no
/// other is written meanwhile.
pub(crate) fn bundled(
    dir: &Path,
    work: &Path,
    id: &ScenarioId,
    prepared: &Prepared,
    seed: u64,
    reader: &Reader,
    alone: bool,
) -> Result<Bundle, Complaint> {
    let gone = || Complaint::resumes(format!("the job store has lost `{id}`"));
    let rows = reader.scenario(id).map_err(work::unread)?;
    let status = socrates_orchestrator::standing(rows.clone()).pop().ok_or_else(gone)?;
    let (history, blobs) = (History::of_rows(rows), work::blobs(work));
    let fetch = |digest: &Digest| work::fetch(&blobs, digest);
    conclude(dir, prepared, seed, &Past { status: &status, jobs: history.of(id), fetch: &fetch, work, alone })
}

/// Writes the bundle, or says why there is none.
fn conclude(dir: &Path, prepared: &Prepared, seed: u64, past: &Past<'_>) -> Result<Bundle, Complaint> {
    let status = past.status;
    let scored = status.jobs.iter().any(|job| job.key.stage == Stage::Scoring && job.state == JobState::Succeeded);
    if scored {
        return bundle::write(dir, prepared, seed, past);
    }
    let faults: Vec<Fault> =
        status.jobs.iter().filter(|job| job.state != JobState::Succeeded).flat_map(|job| job.faults.clone()).collect();
    let author = faults.iter().any(|fault| fault.code.family() == Family::Transport);
    let mut complaint = Complaint::faults(
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
    complaint.code = if author { Code::Author } else { Code::NotRealised };
    Err(complaint)
}
