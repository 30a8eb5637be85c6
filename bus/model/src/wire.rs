//! What workers, clients and the orchestrator say to each other: workers ask for work and report, clients submit and look.
//!
//! Bodies only; the envelope and its encoding live in `link`. Unknown fields are ignored and new
//! fields have defaults, so that neighbors one version apart understand each other.

mod byte_text;
mod overview;
mod steer;
mod submit;
mod why;

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::fault::{FailureClass, Fault};
use crate::hash::Digest;
use crate::ids::ScenarioId;
use crate::job::{Artifact, JobKey, JobSpec, Stage};
pub use crate::priority::Priority;
use crate::standing::{JobState, ScenarioEnd};
use crate::trace::TraceContext;

pub use overview::{BatchStatus, Failed, Pace, StageStatus, Table, WorkerStatus};
pub use steer::{Chosen, Left, Part, Steer, Steered};
pub use submit::{Limits, ScenarioSpec, Seeds, Series, Submit, Submitted};
pub use why::{JobAsk, JobWhy, Wait};

/// A worker introduces itself.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Hello {
    /// Fresh UUID of this process.
    pub instance: String,
    /// Stages it serves.
    pub stages: Vec<Stage>,
    /// Version of its code.
    pub code_version: String,
    /// Process id, for people.
    #[serde(default)]
    pub pid: u32,
    /// Host name, for people.
    #[serde(default)]
    pub host: String,
}

/// Answer to [`Hello`].
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Welcome {
    /// Taken in.
    Welcome {
        /// Number of this orchestrator's reign; a lower one is stale.
        epoch: u64,
        /// Length of a lease, ms.
        lease_ms: u64,
        /// Pause between beats, ms.
        beat_ms: u64,
    },
    /// The two cannot talk.
    Incompatible {
        /// What the orchestrator speaks.
        range: String,
    },
}

/// A worker asks for work.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Acquire {
    /// Repeated unchanged until an answer comes: the same id gets the same grants.
    pub req_id: String,
    /// The worker that asks.
    pub instance: String,
    /// Stages it serves.
    pub stages: Vec<Stage>,
    /// Free places.
    pub credits: u32,
    /// Version of its code.
    pub code_version: String,
}

/// A job handed out.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Grant {
    /// What is to be done.
    pub spec: JobSpec,
    /// Number of the attempt, from 1.
    pub attempt: u32,
    /// Fence of the attempt; strictly growing per job.
    pub fence: u64,
    /// Length of the lease, ms.
    pub lease_ms: u64,
    /// Longest time the attempt may take, ms.
    pub deadline_ms: u64,
    /// Idempotency key.
    pub idem_key: Digest,
    /// Small inputs, by content address.
    #[serde(default)]
    pub inline: BTreeMap<Digest, String>,
    /// Where the attempt stands in the trace of its scenario, for logs. Older readers pass over it.
    #[serde(default, deserialize_with = "crate::trace::lenient", skip_serializing_if = "Option::is_none")]
    pub traceparent: Option<TraceContext>,
}

/// Why there is no work.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum NoWork {
    /// Nothing is ready: the worker may ask again at its own pace.
    Empty,
    /// A person holds the batch, or the whole orchestrator.
    Paused,
    /// A limit of authors or of a server is reached: the worker waits as told.
    Throttled,
    /// The worker is leaving.
    Drained,
    /// The worker is of another version than the jobs.
    Version,
}

/// Answer to [`Acquire`]. "No work" is said; silence never means it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Acquired {
    /// Jobs.
    Grants(Vec<Grant>),
    /// None now.
    None {
        /// Ask again after, ms.
        retry_after_ms: u64,
        /// Why.
        reason: NoWork,
    },
}

/// One attempt held by a worker.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Held {
    /// Job.
    pub key: JobKey,
    /// Attempt.
    pub attempt: u32,
    /// Fence.
    pub fence: u64,
    /// Characters that its author has written so far; 0 where none is asked, and from workers of before.
    #[serde(default, skip_serializing_if = "no_characters")]
    pub characters: u64,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde calls it so")]
const fn no_characters(count: &u64) -> bool {
    *count == 0
}

/// A worker says that it lives and what it holds.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Beat {
    /// The worker.
    pub instance: String,
    /// Attempts it holds.
    pub held: Vec<Held>,
    /// Whether it takes no more work.
    #[serde(default)]
    pub draining: bool,
}

/// What becomes of a held attempt.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BeatVerdict {
    /// Go on.
    Ok,
    /// Stop: the job was canceled or superseded.
    Cancel,
    /// Stop: somebody else holds it.
    Lost,
}

/// Answer to [`Beat`].
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct BeatReply {
    /// One per held attempt, in order.
    pub verdicts: Vec<(JobKey, u32, BeatVerdict)>,
    /// Granted to this worker but not listed by it: the answer to its acquire was lost.
    #[serde(default)]
    pub missing: Vec<Grant>,
    /// Reign of the orchestrator.
    #[serde(default)]
    pub epoch: u64,
}

/// How an attempt ended.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// Done.
    Ok,
    /// Not done.
    Failed {
        /// How the orchestrator treats it.
        class: FailureClass,
        /// Every reason at once.
        faults: Vec<Fault>,
        /// The server's own wish, ms.
        #[serde(default)]
        retry_after_ms: Option<u64>,
    },
}

/// One rate of an author's server.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Rate {
    /// The limit per window.
    pub limit: u64,
    /// What is left of it.
    pub left: u64,
    /// Time until it is whole again, ms, where the server says.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub whole_in_ms: Option<u64>,
}

/// What an author's server says of its rates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Rates {
    /// Requests.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub requests: Option<Rate>,
    /// Tokens.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tokens: Option<Rate>,
}

/// A worker reports an attempt. Repeated until it is recorded.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Report {
    /// The worker.
    pub instance: String,
    /// Job.
    pub key: JobKey,
    /// Attempt.
    pub attempt: u32,
    /// Fence.
    pub fence: u64,
    /// How it ended.
    pub outcome: Outcome,
    /// Outputs; also of a failed attempt (the refused answer, the exchange).
    #[serde(default)]
    pub artifacts: Vec<Artifact>,
    /// Working time, ms, for people; decides nothing.
    #[serde(default)]
    pub wall_ms: u64,
    /// Tokens in and out, for the cost meter.
    #[serde(default)]
    pub tokens: (u64, u64),
    /// Short remarks for the status line: `2 people`, `61.2 s simulated`.
    #[serde(default)]
    pub remark: String,
    /// For a scoring report: the repair it asks for, as a copy of the artifact's field.
    #[serde(default)]
    pub repair: Option<crate::report::Repair>,
    /// For a review: the stages that the person wants made again, with reasons; empty goes on with what was left.
    #[serde(default)]
    pub anew: Vec<crate::report::Repair>,
    /// For a scoring report: the verdict.
    #[serde(default)]
    pub verdict: Option<crate::report::Verdict>,
    /// For an authoring report: what the server said of its rates. Older readers pass over it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rates: Option<Rates>,
}

/// A worker hands an attempt back unharmed; its budget is not touched.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Release {
    /// The worker.
    pub instance: String,
    /// Job.
    pub key: JobKey,
    /// Attempt.
    pub attempt: u32,
    /// Fence.
    pub fence: u64,
}

/// Answer to [`Report`] and [`Release`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Recorded {
    /// Committed as the result, or as the end of the attempt.
    Accepted,
    /// Known already.
    Duplicate,
    /// Annotated only: a newer attempt holds the job, or the job ended.
    Late,
    /// The store cannot take it now; keep it and send it again.
    Busy,
}

/// A client controls a batch.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Control {
    /// No more grants for the batch (empty name: for all).
    Pause(String),
    /// Grants again.
    Resume(String),
    /// Give up what is not done.
    Cancel(String),
    /// Dead or failed jobs of a scenario once more, with a new budget.
    Requeue(ScenarioId),
    /// Any of these and more, answered with what came of it: `Steered`.
    Steer(Steer),
}

/// A client asks how things stand.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct StatusAsk {
    /// Batch, or empty for all.
    pub batch: String,
    /// Give scenario lines from this index on (at most 200 a reply).
    #[serde(default)]
    pub from: u32,
    /// Say why these jobs stand where they do, instead of scenario lines.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub job: Option<JobAsk>,
    /// Give the table of stages and workers, instead of scenario lines.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub table: bool,
}

/// How a scenario stands.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ScenarioStatus {
    /// Which.
    pub id: ScenarioId,
    /// Whether nothing more will happen.
    pub done: bool,
    /// How it ended; none while it is not done.
    pub result: Option<ScenarioEnd>,
    /// Newest jobs of each stage and item.
    pub jobs: Vec<JobStatus>,
}

/// How a job stands.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct JobStatus {
    /// Which.
    pub key: JobKey,
    /// Where it stands.
    pub state: JobState,
    /// Attempts so far.
    pub attempts: u32,
    /// Working time of the last attempt, ms.
    pub wall_ms: u64,
    /// Characters that the author of the running attempt has written so far, as of the last beat.
    #[serde(default, skip_serializing_if = "no_characters")]
    pub characters: u64,
    /// Remark of the last report.
    pub remark: String,
    /// Faults of the last failed attempt.
    pub faults: Vec<Fault>,
    /// Outputs, once there are.
    pub artifacts: Vec<Artifact>,
}

/// Answer to [`StatusAsk`].
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct StatusReply {
    /// Scenarios known.
    pub total: u32,
    /// Scenarios done.
    pub done: u32,
    /// Scenarios of which a worker holds a job.
    #[serde(default)]
    pub running: u32,
    /// Scenarios that are done, by how they ended.
    #[serde(default)]
    pub results: BTreeMap<ScenarioEnd, u32>,
    /// How long this orchestrator has been serving, ms.
    #[serde(default)]
    pub serving_ms: u64,
    /// Scenarios that were done when it began.
    #[serde(default)]
    pub done_before: u32,
    /// Workers that beat, by stage name.
    pub workers: BTreeMap<String, u32>,
    /// Lines from the asked index on.
    pub scenarios: Vec<ScenarioStatus>,
    /// How fast they go; none from an orchestrator of before.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pace: Option<Pace>,
    /// Batches in the order in which they were submitted, with the first lines only; the newest where not all fit.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub batches: Vec<BatchStatus>,
    /// How many earlier batches are not listed.
    #[serde(default)]
    pub batches_left: u32,
    /// What clients hold back.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub paused: Vec<Part>,
    /// Why the jobs stand where they do that were asked for; none where none were, and from an orchestrator of before.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub whys: Option<Vec<JobWhy>>,
    /// The table, where it was asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub table: Option<Table>,
}

/// Something that viewers and the live line may miss.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Notice {
    /// Number in the orchestrator's outbox; gaps mean missed notices.
    pub seq: u64,
    /// Job.
    pub key: JobKey,
    /// State it has now.
    pub state: JobState,
    /// Attempt.
    pub attempt: u32,
    /// Remark: fault codes or the report's remark.
    pub remark: String,
    /// Working time, ms.
    #[serde(default)]
    pub wall_ms: u64,
}

/// A client asks what became of scenarios, to write their bundles.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PastAsk {
    /// How scenarios stand, in order of submission.
    Ends {
        /// The first place that is asked for, from 0.
        from: u64,
    },
    /// Everything that was tried for a scenario.
    Rows {
        /// Which.
        scenario: ScenarioId,
        /// From this byte on.
        offset: u64,
    },
}

/// Answer to [`PastAsk`].
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PastPart {
    /// At most 400 scenarios from the place on that was asked for; none when there are no more.
    Ends(Vec<PastEnd>),
    /// A part of the rows of a scenario, at most 48 KiB of a JSON text; none where it is unknown.
    Rows {
        /// Digest of the whole text: parts of another moment have another one.
        digest: Digest,
        /// Whole length, bytes.
        len: u64,
        /// The bytes.
        #[serde(with = "byte_text")]
        bytes: Vec<u8>,
    },
    /// It cannot be told.
    Unknown {
        /// Why.
        why: String,
    },
}

/// How one scenario stands.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct PastEnd {
    /// Place in the order of submission, from 0.
    pub place: u64,
    /// Which.
    pub scenario: ScenarioId,
    /// Batch that it was submitted with.
    pub batch: String,
    /// How it ended; none while it is not done.
    pub end: Option<ScenarioEnd>,
}

/// Asks for a part of an artifact.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct BlobGet {
    /// Which.
    pub digest: Digest,
    /// From this byte on.
    pub offset: u64,
}

/// A part of an artifact, at most 48 KiB.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct BlobPart {
    /// Whole length, bytes; 0 with `found` false.
    pub len: u64,
    /// Whether the store has it.
    pub found: bool,
    /// The bytes.
    #[serde(with = "byte_text")]
    pub bytes: Vec<u8>,
}

/// Hands over a part of an artifact; the last part completes it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct BlobPut {
    /// Which; checked when complete.
    pub digest: Digest,
    /// Whole length, bytes.
    pub len: u64,
    /// From this byte on.
    pub offset: u64,
    /// The bytes.
    #[serde(with = "byte_text")]
    pub bytes: Vec<u8>,
}
