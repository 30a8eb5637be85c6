//! Where the worker kit and the author meet: a job's inputs become papers, an answer becomes a report.
//!
//! ```text
//! Job ──► papers ──► Desk::answer ──► report ──► Done or Failure
//! ```
//!
//! The three authoring stages differ in the role of their output and in whether they need a proposal; this is
//! everything else. A refused answer is reported with every reason and kept as the artifact `refused`, so that the
//! next ask can show it to the author.
//!
//! *Never here:* a second ask, a wait, what an answer must look like, an environment variable.

mod report;

use socrates_author::{Desk, Papers};
use socrates_kit::{Done, Failure, Job};
use socrates_model::job::Stage;

/// Does a job of an authoring stage: one question, one ask.
///
/// Inputs by role: `request`, `reading`, `location`, and `proposal` for every stage but the proposal itself. Outputs:
/// the stage's artifact, and `exchange` for provenance.
///
/// # Errors
/// [`Failure`] with every reason at once: inputs that are missing or cannot be read (poison), or what the desk says
/// of the author and its answer.
pub async fn serve(desk: &Desk, stage: Stage, job: &Job) -> Result<Done, Failure> {
    let spec = job.spec();
    let papers = Papers {
        stage,
        request: job.json("request")?,
        reading: job.json("reading")?,
        location: job.json("location")?,
        proposal: if stage == Stage::Proposal { None } else { Some(job.json("proposal")?) },
        only: Vec::new(),
        feedback: spec.feedback.clone(),
        refused: job.refused().map(str::to_owned),
        seed: spec.seed,
        settings: spec.settings.clone(),
        attempt: job.grant().attempt,
    };
    tracing::debug!(job = %spec.key, attempt = papers.attempt, "author asked");
    match desk.answer(papers).await {
        Ok(answer) => report::done(answer),
        Err(refusal) => Err(report::failure(refusal)),
    }
}
