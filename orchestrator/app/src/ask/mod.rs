//! `run --ask`: a person looks at what the authors made before it goes on.
//!
//! ```text
//! orchestrator ── review job ──► Reviewer ── Look ──► converse ◄──► Terminal
//!      ▲                            │                    │
//!      └──────── Done ◄─────────────┴──── Decision ◄─────┘
//! ```
//!
//! The looks are jobs of the stage `review`: whoever leaves hands the job back, and the same command is granted it again.
//!
//! *Never here:* what an edit in words means (the offline author knows), what is wrong with a draft (the checks know).

mod command;
mod conversation;
mod keep;
mod log;
mod terminal;
mod version;

#[cfg(test)]
mod tests;

use std::path::Path;
use std::sync::mpsc;
use std::sync::{Arc, Mutex, PoisonError};

use socrates_author::{Exchange, variants};
use socrates_kit::{Blobs, Done, Failure, Job, KitError, LocalBlobs, Output, Stage, Stop, WorkerConfig};
use socrates_link::Bus;
use socrates_model::job;
use socrates_model::{AuthorSpec, FailureClass, Fault, FaultCode, Proposal, Role};
use socrates_prompts::Question;
use tokio::sync::{oneshot, watch};
use tokio::task::JoinHandle;

use self::conversation::{About, Decision, Look, converse};
use self::terminal::Terminal;
use self::version::Version;
use crate::config::Config;
use crate::exit::{Code, Diagnostic};
use crate::output::Printer;
use crate::prepare::Prepared;
use crate::process::CODE_VERSION;

/// The person and the worker that brings them the looks.
pub(crate) struct Asking {
    left: watch::Receiver<Option<Left>>,
    looking: Arc<Mutex<bool>>,
    stop: watch::Sender<Stop>,
    served: JoinHandle<Result<(), KitError>>,
}

/// How a person left.
#[derive(Debug, Clone)]
struct Left {
    look: u8,
    /// What went wrong; empty where the person wanted to leave.
    why: String,
}

impl Asking {
    /// Begins to serve the review jobs of a run.
    pub(crate) fn start(
        talk: &Printer,
        config: &Config,
        bus: Arc<dyn Bus>,
        work: &Path,
        blobs: LocalBlobs,
        prepared: &Prepared,
    ) -> Result<Self, Diagnostic> {
        let mut terminal = Terminal::new(*talk, config, work);
        let mut log = terminal.log()?;
        let (looks, brought) = mpsc::sync_channel::<(Look, oneshot::Sender<Decision>)>(1);
        let (leave, left) = watch::channel(None);
        let looking = Arc::new(Mutex::new(false));
        let busy = Arc::clone(&looking);
        let talk = *talk;
        // Reading a terminal cannot be taken back, so it has a thread of its own that nobody waits for.
        std::thread::spawn(move || {
            while let Ok((look, answer)) = brought.recv() {
                set(&busy, true);
                talk.clear();
                let decided = converse(&look, &mut log, &mut terminal);
                set(&busy, false);
                let why = match decided {
                    Ok(Some(decision)) => {
                        // The worker may be gone; then nobody asks any more.
                        drop(answer.send(decision));
                        continue;
                    }
                    Ok(None) => String::new(),
                    Err(diagnostic) => diagnostic.to_string(),
                };
                leave.send_replace(Some(Left { look: look.about.number(), why }));
                return;
            }
        });
        let pinned = [job::Stage::Proposal, job::Stage::Paths, job::Stage::Behaviors]
            .into_iter()
            .filter(|stage| Role::made_by(*stage).is_some_and(|role| prepared.pins.contains_key(&role)))
            .collect();
        let reviewer = Reviewer { looks, author: prepared.author.clone(), pinned };
        let mut settings = WorkerConfig::new(Blobs::Local(blobs), work.join("spool").join("review"), CODE_VERSION);
        settings.durable = false;
        let (stop, stopped) = watch::channel(Stop::Run);
        let served = tokio::spawn(socrates_kit::serve(reviewer, bus, settings, stopped));
        Ok(Self { left, looking, stop, served })
    }

    /// Whether the person has the terminal.
    pub(crate) fn is_looking(&self) -> bool {
        *self.looking.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Writes a passing line, unless the person has the terminal; they do not get it while it is written.
    pub(crate) fn passing(&self, talk: &Printer, text: &str) {
        let looking = self.looking.lock().unwrap_or_else(PoisonError::into_inner);
        if !*looking {
            talk.passing(text);
        }
    }

    /// Ends when the person leaves, with what is said then.
    pub(crate) async fn left(&mut self) -> Diagnostic {
        let left = match self.left.wait_for(Option::is_some).await {
            Ok(left) => left.clone(),
            Err(_) => None,
        };
        let Some(left) = left else { return std::future::pending().await };
        if left.why.is_empty() {
            Diagnostic::input(
                format!("left at look {}; nothing is lost", left.look),
                "the same command comes back to it",
            )
            .with_code(Code::Waits)
        } else {
            Diagnostic::input(left.why, "").with_code(Code::Ours)
        }
    }

    /// Hands back what is looked at.
    pub(crate) async fn end(self) {
        self.stop.send_replace(Stop::Now);
        match self.served.await {
            Ok(Ok(())) => {}
            Ok(Err(why)) => tracing::warn!(%why, "the review worker stopped"),
            Err(why) => tracing::warn!(%why, "the review worker broke"),
        }
    }
}

fn set(flag: &Mutex<bool>, value: bool) {
    *flag.lock().unwrap_or_else(PoisonError::into_inner) = value;
}

/// The stage that a person does.
struct Reviewer {
    looks: mpsc::SyncSender<(Look, oneshot::Sender<Decision>)>,
    author: AuthorSpec,
    pinned: Vec<job::Stage>,
}

impl Stage for Reviewer {
    const STAGE: job::Stage = job::Stage::Review;

    async fn run(&self, job: &Job) -> Result<Done, Failure> {
        let look = self.look(job)?;
        let came = look.came.clone();
        let about = look.about;
        let (answer, decided) = oneshot::channel();
        if self.looks.send((look, answer)).is_err() {
            // The person has left: the job is handed back when this process stops.
            return std::future::pending().await;
        }
        match decided.await {
            Ok(decision) => done(about, &came, decision),
            Err(_) => std::future::pending().await,
        }
    }
}

impl Reviewer {
    fn look(&self, job: &Job) -> Result<Look, Failure> {
        let spec = job.spec();
        let came = Version {
            proposal: job.json(Role::Proposal)?,
            paths: job.json_if_there(Role::Paths)?,
            behaviors: job.json_if_there(Role::Behaviors)?,
            reading: job.json(Role::Reading)?,
        };
        let question =
            Question::first(job.json(Role::Request)?, came.reading.clone(), job.json(Role::Location)?, spec.seed);
        let draft = spec.key.item.look() == Some(socrates_model::job::Look::Draft);
        if draft && (came.paths.is_none() || came.behaviors.is_none()) {
            let why = "is a look at a draft without paths or behaviors";
            return Err(Failure::new(FailureClass::Poison, vec![Fault::new(FaultCode::JSpec, &spec.key, why)]));
        }
        Ok(Look {
            job: spec.key.to_string(),
            about: if draft { About::Draft } else { About::Proposal },
            others: if draft { Vec::new() } else { others(job.json_if_there(Role::Exchange)?, &question) },
            came,
            reasons: spec.feedback.clone(),
            question,
            author: self.author.clone(),
            pinned: self.pinned.clone(),
        })
    }
}

/// Every proposal of an answer that held several.
fn others(exchange: Option<Exchange>, question: &Question) -> Vec<Proposal> {
    let Some(exchange) = exchange.filter(|exchange| exchange.variants.len() > 1) else { return Vec::new() };
    // What was read once can be read again; an answer in another form holds no others.
    let variants = variants::read(&exchange.answer, question).unwrap_or_default();
    variants.into_iter().filter_map(|variant| variant.proposal).collect()
}

/// What a person left, as the outputs of the job: only what differs from what came.
fn done(about: About, came: &Version, decision: Decision) -> Result<Done, Failure> {
    let Decision { left, anew, said } = decision;
    let mut outputs = Vec::new();
    if left.proposal != came.proposal {
        outputs.push(Output::json(Role::Proposal, &left.proposal)?);
    }
    if left.reading != came.reading {
        outputs.push(Output::json(Role::Reading, &left.reading)?);
    }
    if about == About::Draft {
        if let Some(paths) = left.paths.as_ref().filter(|_| left.paths != came.paths) {
            outputs.push(Output::json(Role::Paths, paths)?);
        }
        if let Some(behaviors) = left.behaviors.as_ref().filter(|_| left.behaviors != came.behaviors) {
            outputs.push(Output::json(Role::Behaviors, behaviors)?);
        }
    }
    let edited = if outputs.is_empty() { "" } else { ", edited" };
    let remark = if anew.is_empty() {
        format!("accepted{edited}")
    } else {
        let stages: Vec<&str> = anew.iter().map(|wish| wish.stage.name()).collect();
        format!("{} again{edited}", stages.join(" and "))
    };
    outputs.push(Output::json(Role::Said, &said)?);
    let mut done = Done::with(outputs).remark(remark);
    done.anew = anew;
    Ok(done)
}
