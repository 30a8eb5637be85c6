//! What goes into a step and what comes out of it.

use serde::{Deserialize, Serialize};
use socrates_model::job::{JobKey, Stage};
use socrates_model::wire::{
    Acquire, Acquired, Beat, BeatReply, Control, Hello, Notice, Recorded, Release, Report, Steered, Submit, Submitted,
    Welcome,
};
use socrates_model::{Digest, ScenarioId};

use crate::batches::{Batch, Queue};
use crate::state::{Attempt, Job, JobResult, Scenario, ScenarioEnd};

/// Names the question that an answer belongs to; the shell hands it in and gets it back.
pub type Token = u64;

/// Something happened.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Event {
    /// A worker introduces itself.
    Hello {
        /// The worker.
        hello: Hello,
        /// Question.
        to: Token,
    },
    /// A client submits scenarios.
    Submit {
        /// Which.
        submit: Submit,
        /// Question.
        to: Token,
    },
    /// A worker asks for work.
    Acquire {
        /// For which stages.
        ask: Acquire,
        /// Question.
        to: Token,
    },
    /// A worker says what it holds.
    Beat {
        /// What.
        beat: Beat,
        /// Question.
        to: Token,
    },
    /// A worker reports an attempt. The shell has checked that every artifact is in the store.
    Report {
        /// What became of it.
        report: Box<Report>,
        /// Question.
        to: Token,
    },
    /// A worker hands an attempt back.
    Release {
        /// Which.
        release: Release,
        /// Question.
        to: Token,
    },
    /// A client pauses, resumes, cancels or requeues.
    Control {
        /// What.
        control: Control,
        /// Question.
        to: Token,
    },
    /// The liveliness token of a worker is gone.
    Gone {
        /// Which.
        instance: String,
    },
    /// Time has passed.
    Tick,
    /// The state was rebuilt: arm every timer, tell every stage.
    Recover {
        /// Whether no worker of before can be alive: what they held is handed out again at once, without counting.
        alone: bool,
    },
}

/// An answer to a question.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Answer {
    /// To a hello.
    Welcome(Welcome),
    /// To a submission, and to a control: `new` is then the number of scenarios it touched.
    Submitted(Submitted),
    /// To a control that asks what came of it.
    Steered(Steered),
    /// To an acquire.
    Acquired(Acquired),
    /// To a beat.
    Beat(BeatReply),
    /// To a report or release.
    Recorded(Recorded),
}

/// A row to be saved. Rows replace what is under the same key. Written down, it has what a store keeps of it and no time of this reign.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum Row {
    /// A scenario, with its result once it has one.
    Scenario(Box<Scenario>),
    /// A job.
    Job(Box<Job>),
    /// An attempt.
    Attempt(JobKey, Box<Attempt>),
    /// The result of a job; written once.
    Result(JobKey, Box<JobResult>),
    /// Small content that came with a report.
    Text(Digest, String),
    /// An entry of the outbox, and its batch.
    Event(String, Box<Notice>),
    /// A job that was given up, and why.
    Dead(JobKey, String),
    /// A job that lives again.
    Revived(JobKey),
    /// A batch.
    Batch(Box<Batch>),
    /// A series of a batch.
    Queue(Box<Queue>),
    /// The paused batches.
    Paused(Vec<String>),
    /// The paused stages.
    PausedStages(Vec<Stage>),
}

/// What a step wants done, in this order: all rows in one transaction, then the rest.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Effect {
    /// Save.
    Save(Row),
    /// Answer.
    Reply {
        /// Question.
        to: Token,
        /// Answer.
        answer: Box<Answer>,
    },
    /// Tell viewers.
    Notice {
        /// Batch of the job.
        batch: String,
        /// What changed.
        notice: Box<Notice>,
    },
    /// Tell workers that there is work.
    Hint(Stage),
    /// A scenario ended.
    ScenarioDone {
        /// Which.
        id: ScenarioId,
        /// How.
        end: ScenarioEnd,
    },
}
