//! Readers: one per served key. They decode, check artifacts, and put events into the owner's line.

use std::sync::Arc;

use serde::de::DeserializeOwned;
use socrates_kit::{BlobError, LocalBlobs};
use socrates_link::{Ask, Bus, Presence, Serving, keys};
use socrates_model::wire::{Acquire, Beat, Control, Hello, Recorded, Release, Report, StatusAsk, Submit, Submitted};
use tokio::sync::{mpsc, oneshot};

use super::artifacts;

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
    Asked(Question, Ask),
    /// A worker's token is gone.
    Gone(String),
    /// The figures are wanted.
    Counted(oneshot::Sender<String>),
    /// The disk takes nothing more, and nobody waits until it does.
    Full(BlobError),
}

/// Where artifacts are kept.
#[derive(Clone)]
pub(super) struct Disk {
    pub(super) blobs: LocalBlobs,
    /// Whether room is waited for.
    pub(super) waits: bool,
}

/// Kind of the messages on a key: its last chunk.
pub(super) fn kind(key: &str) -> &str {
    key.rsplit('/').next().unwrap_or(key)
}

/// Reads one key until the bus closes. Whatever cannot be read is refused with the reason.
pub(super) async fn read(bus: Arc<dyn Bus>, epoch: u64, mut serving: Serving, line: mpsc::Sender<Inbound>, disk: Disk) {
    let mut told_of_disk = false;
    while let Some(ask) = serving.next().await {
        let question = match decode(&ask) {
            Ok(question) => question,
            Err(why) => {
                tracing::warn!(key = ask.key(), why, "a message cannot be read");
                told(ask.refuse(bus.name(), epoch, &why).await);
                continue;
            }
        };
        match checked(question, &disk.blobs).await {
            Ok(question) => {
                if line.send(Inbound::Asked(question, ask)).await.is_err() {
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
                told(ask.answer(kind(keys::REPORT), bus.name(), epoch, &Recorded::Busy).await);
            }
            Err(Refused::Said(answer)) => told(ask.answer(kind(keys::SUBMIT), bus.name(), epoch, &answer).await),
            Err(Refused::Busy) => told(ask.answer(kind(keys::REPORT), bus.name(), epoch, &Recorded::Busy).await),
        }
    }
}

/// An answer that does not go out is asked for again.
pub(super) fn told(sent: Result<(), socrates_link::LinkError>) {
    if let Err(why) = sent {
        tracing::debug!(%why, "an answer did not go out");
    }
}

fn decode(ask: &Ask) -> Result<Question, String> {
    fn body<T: DeserializeOwned>(ask: &Ask) -> Result<T, String> {
        ask.read(kind(ask.key())).map(|envelope| envelope.body).map_err(|why| why.to_string())
    }
    match ask.key() {
        keys::HELLO => body(ask).map(Question::Hello),
        keys::ACQUIRE => body(ask).map(Question::Acquire),
        keys::BEAT => body(ask).map(Question::Beat),
        keys::REPORT => body(ask).map(|report| Question::Report(Box::new(report))),
        keys::RELEASE => body(ask).map(Question::Release),
        keys::SUBMIT => body(ask).map(Question::Submit),
        keys::CONTROL => body(ask).map(Question::Control),
        keys::STATUS => body(ask).map(Question::Status),
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
