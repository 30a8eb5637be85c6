//! What is checked before an event reaches the state machine: that artifacts are really there.

use socrates_kit::{BlobError, LocalBlobs};
use socrates_model::Role;
use socrates_model::fault::{FailureClass, Fault, FaultCode, Where};
use socrates_model::job::{Artifact, INLINE_BYTES};
use socrates_model::wire::{Outcome, Report, Submit};

/// Puts small contents among the artifacts and looks for the others. A success with an artifact that
/// is torn or missing becomes a passing failure; the same worker or another makes it anew.
///
/// # Errors
/// When the artifacts cannot be written now; the worker keeps its report.
pub(super) fn settle(blobs: &LocalBlobs, mut report: Report) -> Result<Report, BlobError> {
    let mut faults = Vec::new();
    let mut whole = Vec::with_capacity(report.artifacts.len());
    for artifact in std::mem::take(&mut report.artifacts) {
        match lacks(blobs, &artifact)? {
            None => whole.push(artifact),
            Some(why) => faults.push(Fault::new(FaultCode::JBlob, Where::key(artifact.role), why)),
        }
    }
    report.artifacts = whole;
    if !faults.is_empty() && report.outcome == Outcome::Ok {
        report.outcome = Outcome::Failed { class: FailureClass::Transient, faults, retry_after_ms: None };
    }
    Ok(report)
}

fn lacks(blobs: &LocalBlobs, artifact: &Artifact) -> Result<Option<String>, BlobError> {
    let digest = &artifact.digest;
    let Some(text) = &artifact.inline else {
        return Ok((!blobs.has(digest)).then(|| format!("artifact `{digest}` is not in the store")));
    };
    if text.len() > INLINE_BYTES {
        return Ok(Some(format!("`{}` bytes came inline; at most `{INLINE_BYTES}` do", text.len())));
    }
    let found = socrates_model::Digest::of(text.as_bytes());
    if found != *digest {
        return Ok(Some(format!("the content has digest `{found}`, not `{digest}`")));
    }
    // Not forced to disk: the store keeps it as a text in the commit that records the report, and puts it back where a power cut took it.
    blobs.unforced().put(text.as_bytes())?;
    Ok(None)
}

/// The first input that was submitted but is not there.
pub(super) fn missing_input(blobs: &LocalBlobs, submit: &Submit) -> Option<String> {
    let firsts = submit.series.iter().map(|series| &series.first);
    submit.scenarios.iter().chain(firsts).find_map(|spec| {
        let inputs = [(Role::Request, spec.request), (Role::Location, spec.location), (Role::Reading, spec.reading)];
        let pinned = spec.pinned.iter().map(|(role, digest)| (*role, *digest));
        let named = inputs.into_iter().chain(pinned).map(|(role, digest)| (role.to_string(), digest));
        let order = spec.order.map(|digest| ("order".to_owned(), digest));
        let (what, digest) = named.chain(order).find(|(_, digest)| !blobs.has(digest))?;
        Some(format!("scenario `{}`: its {what} `{digest}` is not among the artifacts; hand it over first", spec.id))
    })
}
