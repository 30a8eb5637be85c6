//! The authoring stages: proposal, paths and behaviors. A job's inputs become a question, its answer becomes a report.
//!
//! ```text
//! Job ──► Question ──► AuthorContext::answer ──► report ──► Done or Failure
//! ```
//!
//! The three stages differ in the role of their output and in whether they need a proposal. A refused answer is
//! reported with every reason and kept as the artifact `refused`, so that the next ask can show it to the author.
//!
//! *Never here:* another stage, the orchestrator, a second ask, a wait, what an answer must look like, an environment
//! variable.

mod report;
mod stages;

pub use stages::{BehaviorsStage, PathsStage, ProposalStage};

use socrates_author::{Asking, AuthorContext, Question};
use socrates_kit::{Done, Failure, Job};
use socrates_model::Role;
use socrates_model::job::Stage;

/// Does a job of an authoring stage: one question, one ask.
///
/// Inputs by role: `request`, `reading`, `location`, and `proposal` for every stage but the proposal itself. Outputs:
/// the stage's artifact, and `exchange` for provenance.
///
/// # Errors
/// [`Failure`] with every reason at once: inputs that are missing or cannot be read (poison), or what is wrong with
/// the author and its answer.
async fn serve(context: &AuthorContext, stage: Stage, job: &Job) -> Result<Done, Failure> {
    let spec = job.spec();
    let question = Question {
        stage,
        request: job.json(Role::Request)?,
        reading: job.json(Role::Reading)?,
        location: job.json(Role::Location)?,
        proposal: if stage == Stage::Proposal { None } else { Some(job.json(Role::Proposal)?) },
        only: Vec::new(),
        feedback: spec.feedback.clone(),
        refused: job.refused().map(str::to_owned),
        seed: spec.seed,
    };
    let asking = Asking { settings: spec.settings.clone(), attempt: job.grant().attempt };
    tracing::debug!(job = %spec.key, attempt = asking.attempt, "author asked");
    match context.heard_by(job.hears()).answer(&question, &asking).await {
        Ok(answer) => report::done(answer),
        Err(refusal) => Err(report::failure(refusal)),
    }
}
