//! Reports: metrics, fidelity verdict and narrative of one recording.

use std::collections::BTreeMap;
use std::fmt;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::clause::ClauseRole;
use crate::fault::Fault;
use crate::hash::Digest;
use crate::ids::RunId;
use crate::job::Stage;
use crate::planner_name::PlannerName;

/// Whether the scenario that was asked for happened.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Every setup clause was seen.
    Realised,
    /// Every setup clause was seen, some only with a shift in time.
    RealisedLate,
    /// A premise never came true.
    NotTriggered,
    /// Something that was promised was seen to be otherwise.
    Contradicted,
    /// The recording proves nothing (overlap, stuck, NaN, nothing to verify), or part of the request was not played.
    Invalid,
    /// It happens with the reference robot, but not with this planner.
    RobotPrevented,
}

impl Verdict {
    /// Every verdict.
    pub const ALL: [Self; 6] = [
        Self::Realised,
        Self::RealisedLate,
        Self::NotTriggered,
        Self::Contradicted,
        Self::Invalid,
        Self::RobotPrevented,
    ];

    /// Spelled as in every file.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Realised => "realised",
            Self::RealisedLate => "realised_late",
            Self::NotTriggered => "not_triggered",
            Self::Contradicted => "contradicted",
            Self::Invalid => "invalid",
            Self::RobotPrevented => "robot_prevented",
        }
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// What became of one clause.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ClauseResult {
    /// Clause id.
    pub id: String,
    /// The clause in words.
    pub text: String,
    /// Setup or outcome.
    pub role: ClauseRole,
    /// Whether it is needed.
    pub must: bool,
    /// Fact it comes from, or empty.
    #[serde(default)]
    pub source: String,
    /// Standing of the clause.
    pub standing: Standing,
    /// Robustness: by how much it holds (positive) or fails, in the unit of the clause.
    pub margin: f64,
    /// Times of the evidence, s; first is when it was first seen.
    pub times_s: Vec<f64>,
    /// What was seen, with numbers.
    pub evidence: String,
    /// Time robustness, s: by how much the evidence could come sooner, later or be shorter before the standing changes;
    /// negative: by how much it misses. Absent where time plays no part.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shift_s: Option<f64>,
}

/// Standing of a clause.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Standing {
    /// Seen.
    Holds,
    /// Seen, but outside its time window.
    Late,
    /// Its premise never came true.
    NotTriggered,
    /// Seen to be otherwise.
    Fails,
    /// Could not be judged (a map without doors …); says why in the evidence.
    NotApplicable,
}

/// A metric's value. Missing data is never 0.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MetricValue {
    /// Metric id, such as `human_distance_min`.
    pub id: String,
    /// Unit.
    pub unit: Unit,
    /// The value; `None` with a reason in `note`.
    pub value: Option<f64>,
    /// Whether larger is better (1), worse (-1), or neither (0).
    pub direction: i8,
    /// Version of the metric's formula; figures of different versions are not mixed.
    #[serde(default = "first", skip_serializing_if = "is_first")]
    pub version: u32,
    /// How the value is missing; absent where there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub missing: Option<Missing>,
    /// Why there is no value, or the convention used.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub note: String,
}

/// Unit of a metric: `m`, `s`, `m/s`, …, and three that are none of physics: `count`, `share` (0 to 1) and `0/1` (no or yes).
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct Unit(String);

impl Unit {
    const YES_OR_NO: &'static str = "0/1";
    const COUNT: &'static str = "count";
    const SHARE: &'static str = "share";

    /// The unit of this spelling.
    #[must_use]
    pub fn new(text: impl Into<String>) -> Self {
        Self(text.into())
    }

    /// As it is spelled.
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// Whether the value is 0 for no or 1 for yes.
    #[must_use]
    pub fn is_yes_or_no(&self) -> bool {
        self.0 == Self::YES_OR_NO
    }

    /// Whether the value counts something.
    #[must_use]
    pub fn is_count(&self) -> bool {
        self.0 == Self::COUNT
    }

    /// Whether the value is a share from 0 to 1, which is printed without a unit.
    #[must_use]
    pub fn is_share(&self) -> bool {
        self.0 == Self::SHARE
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

const fn first() -> u32 {
    1
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands a reference")]
const fn is_first(version: &u32) -> bool {
    *version == 1
}

/// How a value is missing. Never as 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Missing {
    /// The evidence lacks what it takes (a map, a run without the robot …); more evidence of the same run would give it.
    Unavailable,
    /// The run has no such value (nobody makes a gesture, the robot never arrives …).
    NotApplicable,
}

/// A wish of the report: do a stage again with this reason.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Repair {
    /// Stage to be done again.
    pub stage: Stage,
    /// Reasons; the author reads them next.
    pub faults: Vec<Fault>,
}

/// Report of one recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Report {
    /// Format number, see [`crate::FORMAT`].
    pub format: u32,
    /// The run.
    pub run: RunId,
    /// Planner.
    pub planner: PlannerName,
    /// Simulation seed.
    pub seed: u64,
    /// Hash of the recording that was judged.
    pub recording: Digest,
    /// Verdict.
    pub verdict: Verdict,
    /// One sentence on the verdict, with times.
    pub verdict_text: String,
    /// Score of fidelity, 0 to 1.
    pub score: f64,
    /// Clauses, setup first.
    pub clauses: Vec<ClauseResult>,
    /// Metrics in catalog order.
    pub metrics: Vec<MetricValue>,
    /// Profile and signature of the thresholds that the metrics used, such as `standard-1f3a9c2e8b07`; empty in reports
    /// from before there was one. Reports with different ones are not pooled.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub thresholds: String,
    /// One sentence on what the robot did.
    pub robot_text: String,
    /// Whether the robot reached its goal without a collision.
    pub success: bool,
    /// The story of the run: one line per thing that happened, with times.
    pub story: Vec<String>,
    /// Achieved gap of each encounter, s, by human; later ones as `human_1 second meeting`.
    pub encounter_gaps_s: BTreeMap<String, f64>,
    /// Simulated seconds.
    pub simulated_s: f64,
    /// What should be done again, if the verdict asks for it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub repair: Option<Repair>,
}

impl Report {
    /// The metric of this id; `None` where the catalog has none or the report was made before there was one.
    #[must_use]
    pub fn metric(&self, id: &str) -> Option<&MetricValue> {
        self.metrics.iter().find(|metric| metric.id == id)
    }
}
