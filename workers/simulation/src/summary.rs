//! What is said about a recording without reading it.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use socrates_model::{Digest, EventKind, HumanId, Recording, RunId};

/// Summary of one run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Format number, see [`socrates_model::FORMAT`].
    pub format: u32,
    /// The run.
    pub run: RunId,
    /// Planner.
    pub planner: String,
    /// Simulation seed.
    pub seed: u64,
    /// Recording hash: over decoded frames and events.
    pub hash: Digest,
    /// Ticks recorded.
    pub ticks: u64,
    /// Simulated seconds.
    pub seconds: f64,
    /// Why it ended: `done`, `time`, `stuck`.
    pub end: String,
    /// When the robot arrived, s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub robot_arrived_s: Option<f64>,
    /// Achieved gap of each human's first encounter, s; positive: the human came later.
    pub encounter_gaps_s: BTreeMap<HumanId, f64>,
    /// Those of the encounters after the first, one after the other.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub later_gaps_s: BTreeMap<HumanId, Vec<f64>>,
    /// Touches between agents.
    pub contacts: u32,
}

impl Summary {
    /// The summary of a recording.
    #[must_use]
    pub fn of(recording: &Recording) -> Self {
        let mut summary = Self {
            format: socrates_model::FORMAT,
            run: recording.header.run.clone(),
            planner: recording.header.planner.clone(),
            seed: recording.header.seed,
            hash: recording.hash(),
            ticks: recording.ticks() as u64,
            seconds: recording.events.last().map_or(0.0, |event| event.time.secs()),
            end: String::new(),
            robot_arrived_s: None,
            encounter_gaps_s: BTreeMap::new(),
            later_gaps_s: BTreeMap::new(),
            contacts: 0,
        };
        for event in &recording.events {
            match &event.kind {
                EventKind::Encounter { human, gap_s, nth, .. } if *nth > 1 => {
                    summary.later_gaps_s.entry(*human).or_default().push(*gap_s);
                }
                EventKind::Encounter { human, gap_s, .. } => {
                    summary.encounter_gaps_s.insert(*human, *gap_s);
                }
                EventKind::Contact { .. } => summary.contacts += 1,
                EventKind::RobotArrived => summary.robot_arrived_s = Some(event.time.secs()),
                EventKind::End { reason } => summary.end.clone_from(reason),
                EventKind::Gesture { .. }
                | EventKind::Leaf { .. }
                | EventKind::Sees { .. }
                | EventKind::WallContact { .. }
                | EventKind::Door { .. }
                | EventKind::Node { .. }
                | EventKind::Stuck { .. } => {}
            }
        }
        summary
    }

    /// The remark for the status line: `61.2 s simulated`.
    #[must_use]
    pub fn remark(&self) -> String {
        format!("{:.1} s simulated", self.seconds)
    }
}
