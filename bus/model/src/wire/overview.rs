//! How batches, stages and workers stand.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::fault::{FailureClass, Fault};
use crate::job::{JobKey, Stage};
use crate::priority::Priority;
use crate::standing::JobState;
use crate::wire::Limits;

/// How fast scenarios ended, over the time in which workers held jobs of theirs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Pace {
    /// Scenarios that ended in the last minutes of such time.
    pub ended: u32,
    /// How much such time that was, ms; pauses in which nobody held a job are left out.
    pub work_ms: u64,
    /// How long nobody has held a job, ms; none while somebody does.
    #[serde(default)]
    pub idle_ms: Option<u64>,
}

/// How one batch stands.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct BatchStatus {
    /// Name.
    pub name: String,
    /// Scenarios.
    pub total: u32,
    /// Scenarios that ended, however they did.
    pub done: u32,
    /// Scenarios that failed.
    #[serde(default)]
    pub failed: u32,
    /// Scenarios that were given up.
    #[serde(default)]
    pub canceled: u32,
    /// Scenarios of which a worker holds a job.
    #[serde(default)]
    pub running: u32,
    /// Whether a client holds it back.
    #[serde(default)]
    pub paused: bool,
    /// Wall time at which it was first submitted, ms since 1970, for people; 0 where it is not known.
    #[serde(default)]
    pub since_ms: u64,
    /// Wall time at which the last of it ended, ms since 1970, for people; 0 while something of it is open, and where it is not known.
    #[serde(default)]
    pub ended_ms: u64,
    /// How urgent it is beside other batches.
    #[serde(default)]
    pub priority: Priority,
    /// How fast it goes.
    #[serde(default)]
    pub pace: Pace,
    /// Scenarios of series that are not made yet; they are among the total.
    #[serde(default)]
    pub unmade: u32,
    /// What it may take.
    #[serde(default, skip_serializing_if = "Limits::are_none")]
    pub limits: Limits,
    /// What it has taken of that: time in which it was not done, tokens and money, in the units of the limits.
    #[serde(default, skip_serializing_if = "Limits::are_none")]
    pub taken: Limits,
    /// Why nothing more of it is begun; empty where it goes on.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub over: String,
}

/// How stages and workers stand, for a table.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Table {
    /// Number of the orchestrator's reign.
    pub epoch: u64,
    /// Stages in pipeline order.
    pub stages: Vec<StageStatus>,
    /// Workers that beat, at most as many as fit a message.
    pub workers: Vec<WorkerStatus>,
    /// How many workers are not listed.
    #[serde(default)]
    pub workers_left: u32,
    /// The newest failed attempts, newest first.
    #[serde(default)]
    pub failures: Vec<Failed>,
    /// Tokens that authors were asked with and answered with, by server and model, since this reign began.
    #[serde(default)]
    pub tokens: BTreeMap<String, (u64, u64)>,
}

/// How one stage stands.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct StageStatus {
    /// Which.
    pub stage: Stage,
    /// Jobs by state; a state without jobs is left out.
    pub states: BTreeMap<JobState, u64>,
    /// Whether a client holds it back, alone or with everything.
    #[serde(default)]
    pub paused: bool,
    /// Median of the last attempts that were reported, from grant to report, ms; none where there was none.
    #[serde(default)]
    pub p50_ms: Option<u64>,
    /// How long the job has waited for a worker that waits the longest, ms.
    #[serde(default)]
    pub waited_ms: Option<u64>,
}

/// How one worker stands.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct WorkerStatus {
    /// UUID of its process.
    pub instance: String,
    /// Its machine; empty where it did not say.
    #[serde(default)]
    pub host: String,
    /// Its process id; 0 where it did not say.
    #[serde(default)]
    pub pid: u32,
    /// Stages that it serves.
    pub stages: Vec<Stage>,
    /// How many jobs it holds.
    pub holds: u32,
    /// The first of them.
    #[serde(default)]
    pub first: Option<JobKey>,
    /// Time since it was last heard, ms.
    pub seen_ms: u64,
    /// Whether it takes no more work.
    #[serde(default)]
    pub draining: bool,
}

/// An attempt that failed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Failed {
    /// Of which job.
    pub key: JobKey,
    /// Number of the attempt.
    pub attempt: u32,
    /// How it is treated.
    #[serde(default)]
    pub class: Option<FailureClass>,
    /// The first reason.
    #[serde(default)]
    pub fault: Option<Fault>,
    /// How long ago, ms.
    pub ago_ms: u64,
}

#[cfg(test)]
mod tests {
    use crate::wire::{StatusAsk, StatusReply};

    #[test]
    fn neighbors_of_before_understand_each_other() {
        // What was asked before is asked in the same words.
        assert_eq!(serde_json::to_string(&StatusAsk::default()).unwrap(), r#"{"batch":"","from":0}"#);
        let before = r#"{"total":3,"done":1,"workers":{"paths":1},"scenarios":[]}"#;
        let reply: StatusReply = serde_json::from_str(before).unwrap();
        assert_eq!((reply.total, reply.pace, reply.whys, reply.table), (3, None, None, None));
        assert!(reply.batches.is_empty() && reply.paused.is_empty());
    }
}
