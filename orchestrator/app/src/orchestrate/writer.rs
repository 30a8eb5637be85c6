//! The writer: one thread that takes all steps that wait, saves their rows in one transaction, and only
//! then lets their answers, notices and hints out.

use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll};
use std::time::Instant;

use socrates_link::{Ask, Bus, Envelope, GRANTS_VERSION, LinkError, Qos, encode, keys};
use socrates_model::job::Stage;
use socrates_model::wire::{Notice, Recorded, StatusReply, Submitted, Welcome};
use socrates_orchestrator::{Answer, Row};
use socrates_store::{Store, StoreError};
use tokio::sync::{mpsc, oneshot};
use tokio::task::JoinSet;

use super::counts::{Counts, Refusal};
use super::reader::{Came, kind, told};

/// Steps in one transaction at most.
const GROUP: usize = 256;
/// Steps that wait for the writer at most; beyond it the owner waits.
const LINE: usize = 1024;
/// Answers on their way at one time at most: one slow asker holds up nobody.
const ANSWERING: usize = 256;

/// An answer and the way back.
pub(super) struct Reply {
    pub(super) came: Came,
    pub(super) say: Say,
}

/// What is answered.
pub(super) enum Say {
    /// The state machine's word.
    Answer(Box<Answer>),
    /// How things stand.
    Status(Box<StatusReply>),
}

/// What is said once the rows are durable.
#[derive(Default)]
pub(super) struct Said {
    pub(super) replies: Vec<Reply>,
    pub(super) notices: Vec<(String, Notice)>,
    pub(super) hints: Vec<Stage>,
}

impl Said {
    pub(super) fn is_empty(&self) -> bool {
        self.replies.is_empty() && self.notices.is_empty() && self.hints.is_empty()
    }
}

/// A step: what to save and what to say.
#[derive(Default)]
pub(super) struct Commit {
    pub(super) rows: Vec<Row>,
    pub(super) said: Said,
}

/// Resolves with the error that ended the writer; with none when its line ended.
pub(super) struct Broken(oneshot::Receiver<Result<(), StoreError>>, bool);

impl Future for Broken {
    type Output = Result<StoreError, oneshot::error::RecvError>;
    fn poll(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<Self::Output> {
        match Pin::new(&mut self.0).poll(cx) {
            Poll::Ready(Ok(Err(why))) => Poll::Ready(Ok(why)),
            Poll::Ready(Err(gone)) => Poll::Ready(Err(gone)),
            Poll::Ready(Ok(Ok(()))) => {
                self.1 = true;
                Poll::Pending
            }
            Poll::Pending => Poll::Pending,
        }
    }
}

impl Broken {
    /// Waits until everything in the writer's line is saved, unless it broke before.
    pub(super) async fn await_end(self, unbroken: bool) -> anyhow::Result<()> {
        if !unbroken || self.1 {
            return Ok(());
        }
        match self.0.await {
            Ok(Ok(())) => Ok(()),
            Ok(Err(why)) => Err(why.into()),
            Err(_gone) => Err(anyhow::anyhow!("the writer of the job store has ended")),
        }
    }
}

/// Starts the writer's thread.
///
/// # Errors
/// When the system gives no thread.
pub(super) fn start(
    mut store: impl Store + 'static,
    committed: mpsc::Sender<Said>,
    counts: Counts,
) -> std::io::Result<(mpsc::Sender<Commit>, Broken)> {
    let (line, mut steps) = mpsc::channel::<Commit>(LINE);
    let (ended, broken) = oneshot::channel();
    std::thread::Builder::new().name("job-store".to_owned()).spawn(move || {
        let result = write(&mut store, &mut steps, &committed, &counts);
        // The store is closed before anybody hears that it ended.
        drop(store);
        if ended.send(result).is_err() {
            tracing::debug!("nobody waits for the writer's end");
        }
    })?;
    Ok((line, Broken(broken, false)))
}

fn write(
    store: &mut impl Store,
    steps: &mut mpsc::Receiver<Commit>,
    committed: &mpsc::Sender<Said>,
    counts: &Counts,
) -> Result<(), StoreError> {
    while let Some(first) = steps.blocking_recv() {
        let mut rows = first.rows;
        let mut said = vec![first.said];
        while said.len() < GROUP
            && let Ok(next) = steps.try_recv()
        {
            rows.extend(next.rows);
            said.push(next.said);
        }
        let began = Instant::now();
        store.save(&rows)?;
        if !rows.is_empty() {
            counts.committed(began.elapsed(), said.len());
        }
        for said in said {
            if !said.is_empty() && committed.blocking_send(said).is_err() {
                return Ok(());
            }
        }
    }
    Ok(())
}

/// Says what was committed, in order; answers go out side by side.
pub(super) async fn tell(bus: Arc<dyn Bus>, epoch: u64, mut committed: mpsc::Receiver<Said>, counts: Counts) {
    let mut answering = JoinSet::new();
    while let Some(said) = committed.recv().await {
        for reply in said.replies {
            let (bus, counts) = (Arc::clone(&bus), counts.clone());
            answering.spawn(async move {
                let (key, at) = (reply.came.ask.key().to_owned(), reply.came.at);
                if let Some(why) = refusal(&reply.say) {
                    counts.refused(&key, why);
                }
                let sent = answer(&*bus, epoch, reply).await;
                counts.answered(&key, at.elapsed());
                told(sent);
            });
        }
        for (batch, notice) in said.notices {
            let key = keys::event(&batch, notice.key.scenario.as_str());
            publish(&*bus, &key, "notice", epoch, &notice).await;
        }
        for stage in said.hints {
            publish(&*bus, &keys::hint(stage), "hint", epoch, &stage).await;
        }
        while answering.try_join_next().is_some() {}
        while answering.len() > ANSWERING {
            answering.join_next().await;
        }
    }
    while answering.join_next().await.is_some() {}
}

async fn publish<T: serde::Serialize + Sync>(bus: &dyn Bus, key: &str, what: &str, epoch: u64, body: &T) {
    let sent = match encode(&Envelope::fresh(what, bus.name(), epoch, body)) {
        Ok(bytes) => bus.publish(key, bytes, Qos::Hint).await,
        Err(why) => Err(why),
    };
    told(sent);
}

/// Answers with what may hold grants: a worker that would misread them is told that it is too old.
async fn grant<T: serde::Serialize>(ask: Ask, answer: Envelope<T>) -> Result<(), LinkError> {
    let bytes = encode(&answer.for_readers_of(GRANTS_VERSION).in_reign(ask.reign()))?;
    ask.reply(bytes).await
}

/// Whether an answer says no, and how. That there is no work is no refusal.
fn refusal(say: &Say) -> Option<Refusal> {
    let Say::Answer(answer) = say else { return None };
    match &**answer {
        Answer::Welcome(Welcome::Incompatible { .. }) | Answer::Submitted(Submitted::Refused { .. }) => {
            Some(Refusal::Refused)
        }
        Answer::Recorded(Recorded::Busy) | Answer::Submitted(Submitted::Busy { .. }) => Some(Refusal::Busy),
        Answer::Welcome(_)
        | Answer::Acquired(_)
        | Answer::Beat(_)
        | Answer::Recorded(_)
        | Answer::Steered(_)
        | Answer::Submitted(_) => None,
    }
}

async fn answer(bus: &dyn Bus, epoch: u64, reply: Reply) -> Result<(), LinkError> {
    let Reply { came: Came { ask, .. }, say } = reply;
    let kind = kind(ask.key()).to_owned();
    let control = ask.key() == keys::CONTROL;
    match say {
        Say::Status(status) => ask.answer(&kind, bus.name(), epoch, &status).await,
        Say::Answer(answer) => match *answer {
            Answer::Welcome(welcome) => ask.answer(&kind, bus.name(), epoch, &welcome).await,
            Answer::Acquired(acquired) => grant(ask, Envelope::fresh(&kind, bus.name(), epoch, acquired)).await,
            Answer::Beat(beat) => grant(ask, Envelope::fresh(&kind, bus.name(), epoch, beat)).await,
            Answer::Recorded(recorded) => ask.answer(&kind, bus.name(), epoch, &recorded).await,
            Answer::Steered(steered) => ask.answer(&kind, bus.name(), epoch, &steered).await,
            // A control is answered with how many scenarios it touched.
            Answer::Submitted(Submitted::Accepted { new, held: _ }) if control => {
                ask.answer(&kind, bus.name(), epoch, &new).await
            }
            Answer::Submitted(Submitted::Refused { why }) if control => ask.refuse(bus.name(), epoch, &why).await,
            Answer::Submitted(submitted) => ask.answer(&kind, bus.name(), epoch, &submitted).await,
        },
    }
}
