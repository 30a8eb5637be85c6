//! Readers: one per served key. They decode, check artifacts, and put events into the owner's line.

use std::sync::Arc;
use std::time::Instant;

use serde::de::DeserializeOwned;
use socrates_kit::{BlobError, LocalBlobs};
use socrates_link::{Ask, Bus, Presence, ReignId, Serving, keys};
use socrates_model::TraceContext;
use socrates_model::wire::{Acquire, Beat, Control, Hello, Recorded, Release, Report, StatusAsk, Submit, Submitted};
use tokio::sync::{mpsc, oneshot};

use super::artifacts;
use super::counts::{Counts, Refusal};

/// A decoded question.
pub(super) enum Question {
    Hello(Hello),
    Acquire(Acquire),
    Beat(Beat),
    Report(Box<Report>),
    Release(Release),
    Submit(Submit),
    Control(Control),
    Status(StatusAsk),
}

/// What stands in the owner's line.
pub(super) enum Inbound {
    /// A question and the way back.
    Asked(Question, Came),
    /// A worker's token is gone.
    Gone(String),
    /// The figures are wanted.
    Counted(oneshot::Sender<String>),
    /// The disk takes nothing more, and nobody waits until it does.
    Full(BlobError),
}

/// The way back of a question.
pub(super) struct Came {
    pub(super) ask: Ask,
    /// When it came.
    pub(super) at: Instant,
    /// The trace that it says it is of.
    pub(super) trace: Option<TraceContext>,
}

/// The start of the orchestrator that reads, and those of its store before.
#[derive(Debug, Clone)]
pub(super) struct Reign {
    /// Number of the start.
    pub(super) epoch: u64,
    /// This start.
    pub(super) id: ReignId,
    /// Starts whose workers are still workers of this store; this one among them.
    pub(super) known: Arc<[ReignId]>,
}

/// Where artifacts are kept, and what is counted.
#[derive(Clone)]
pub(super) struct Disk {
    pub(super) blobs: LocalBlobs,
    /// Whether room is waited for.
    pub(super) waits: bool,
    pub(super) counts: Counts,
}

/// Kind of the messages on a key: its last chunk.
pub(super) fn kind(key: &str) -> &str {
    key.rsplit('/').next().unwrap_or(key)
}

/// Reads one key until the bus closes. Whatever cannot be read is refused with the reason, and so is a worker of another store: its
/// attempts and reports would be taken for those of jobs that have the same names here.
pub(super) async fn read(
    bus: Arc<dyn Bus>,
    reign: Reign,
    mut serving: Serving,
    line: mpsc::Sender<Inbound>,
    disk: Disk,
) {
    let epoch = reign.epoch;
    let mut told_of_disk = false;
    while let Some(ask) = serving.next().await {
        let at = Instant::now();
        let key = ask.key().to_owned();
        let ask = ask.in_reign(reign.id);
        let (question, trace) = match decode(&ask) {
            Ok((.., Some(asked))) if !reign.known.contains(&asked) => {
                tracing::debug!(key, "a worker of another job store asks");
                disk.counts.refused(&key, Refusal::Refused);
                told(ask.disown(bus.name(), epoch).await);
                continue;
            }
            Ok((question, trace, _)) => (question, trace),
            Err(why) => {
                tracing::warn!(key, why, "a message cannot be read");
                disk.counts.refused(&key, Refusal::Unreadable);
                told(ask.refuse(bus.name(), epoch, &why).await);
                continue;
            }
        };
        match checked(question, &disk.blobs).await {
            Ok(question) => {
                if line.send(Inbound::Asked(question, Came { ask, at, trace })).await.is_err() {
                    return;
                }
            }
            Err(Refused::Full(why)) if !disk.waits => {
                drop(line.send(Inbound::Full(why)).await);
                return;
            }
            Err(Refused::Full(why)) => {
                if !std::mem::replace(&mut told_of_disk, true) {
                    tracing::error!(%why, "artifacts cannot be written; reports stay with the workers until they can");
                }
                disk.counts.refused(&key, Refusal::Busy);
                told(ask.answer(kind(keys::REPORT), bus.name(), epoch, &Recorded::Busy).await);
            }
            Err(Refused::Said(answer)) => {
                let busy = matches!(answer, Submitted::Busy { .. });
                disk.counts.refused(&key, if busy { Refusal::Busy } else { Refusal::Refused });
                told(ask.answer(kind(keys::SUBMIT), bus.name(), epoch, &answer).await);
            }
            Err(Refused::Busy) => {
                disk.counts.refused(&key, Refusal::Busy);
                told(ask.answer(kind(keys::REPORT), bus.name(), epoch, &Recorded::Busy).await);
            }
        }
    }
}

/// An answer that does not go out is asked for again.
pub(super) fn told(sent: Result<(), socrates_link::LinkError>) {
    if let Err(why) = sent {
        tracing::debug!(%why, "an answer did not go out");
    }
}

/// A question, the trace that it says it is of, and the reign that it is for.
type Decoded = (Question, Option<TraceContext>, Option<ReignId>);

fn decode(ask: &Ask) -> Result<Decoded, String> {
    fn read<T: DeserializeOwned>(ask: &Ask, question: fn(T) -> Question) -> Result<Decoded, String> {
        let envelope = ask.read(kind(ask.key())).map_err(|why| why.to_string())?;
        Ok((question(envelope.body), envelope.traceparent, envelope.reign))
    }
    match ask.key() {
        keys::HELLO => read(ask, Question::Hello),
        keys::ACQUIRE => read(ask, Question::Acquire),
        keys::BEAT => read(ask, Question::Beat),
        keys::REPORT => read(ask, |report| Question::Report(Box::new(report))),
        keys::RELEASE => read(ask, Question::Release),
        keys::SUBMIT => read(ask, Question::Submit),
        keys::CONTROL => read(ask, Question::Control),
        keys::STATUS => read(ask, Question::Status),
        other => Err(format!("`{other}` is not served here")),
    }
}

/// Why a question does not reach the owner.
enum Refused {
    /// It has its answer.
    Said(Submitted),
    /// The report has to be sent again.
    Busy,
    /// Its artifacts cannot be written.
    Full(BlobError),
}

/// Looks after the artifacts a question speaks of, off the runtime's own threads.
async fn checked(question: Question, blobs: &LocalBlobs) -> Result<Question, Refused> {
    let blobs = blobs.clone();
    match question {
        Question::Report(report) => {
            match tokio::task::spawn_blocking(move || artifacts::settle(&blobs, *report)).await {
                Ok(Ok(report)) => Ok(Question::Report(Box::new(report))),
                Ok(Err(why)) => Err(Refused::Full(why)),
                Err(why) => {
                    tracing::error!(%why, "a report could not be looked at");
                    Err(Refused::Busy)
                }
            }
        }
        Question::Submit(submit) => {
            let looked = tokio::task::spawn_blocking(move || (artifacts::missing_input(&blobs, &submit), submit)).await;
            match looked {
                Ok((None, submit)) => Ok(Question::Submit(submit)),
                Ok((Some(why), _)) => Err(Refused::Said(Submitted::Refused { why })),
                Err(_broken) => Err(Refused::Said(Submitted::Busy { retry_after_ms: 500 })),
            }
        }
        Question::Hello(_)
        | Question::Acquire(_)
        | Question::Beat(_)
        | Question::Release(_)
        | Question::Control(_)
        | Question::Status(_) => Ok(question),
    }
}

/// Tells the owner of workers that vanished. Tokens that appear say nothing: the worker speaks for itself.
pub(super) async fn watch(mut presence: Presence, line: mpsc::Sender<Inbound>) {
    while let Some((key, here)) = presence.next().await {
        if here {
            continue;
        }
        if let Some((stage, instance)) = keys::worker_of(&key) {
            tracing::info!(%stage, instance, "a worker's token is gone");
            if line.send(Inbound::Gone(instance)).await.is_err() {
                return;
            }
        }
    }
}
