//! What is said about a recording without reading it.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use socrates_model::{Digest, Event, EventKind, HumanId, PlannerName, Recording, RecordingHeader, RunId};

/// Summary of one run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Format number, see [`socrates_model::FORMAT`].
    pub format: u32,
    /// The run.
    pub run: RunId,
    /// Planner.
    pub planner: PlannerName,
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
    /// The summary of a run that has not begun: its hash is that of nothing until [`Summary::ends`].
    #[must_use]
    pub fn begun(header: &RecordingHeader) -> Self {
        Self {
            format: socrates_model::FORMAT,
            run: header.run.clone(),
            planner: header.planner.clone(),
            seed: header.seed,
            hash: Digest::of(b""),
            ticks: 0,
            seconds: 0.0,
            end: String::new(),
            robot_arrived_s: None,
            encounter_gaps_s: BTreeMap::new(),
            later_gaps_s: BTreeMap::new(),
            contacts: 0,
        }
    }

    /// Takes what happened next.
    pub fn event(&mut self, event: &Event) {
        self.seconds = event.time.secs();
        match &event.kind {
            EventKind::Encounter { human, gap_s, nth, .. } if *nth > 1 => {
                self.later_gaps_s.entry(*human).or_default().push(*gap_s);
            }
            EventKind::Encounter { human, gap_s, .. } => {
                self.encounter_gaps_s.insert(*human, *gap_s);
            }
            EventKind::Contact { .. } => self.contacts += 1,
            EventKind::RobotArrived => self.robot_arrived_s = Some(event.time.secs()),
            EventKind::End { reason } => self.end.clone_from(reason),
            EventKind::Gesture { .. }
            | EventKind::Leaf { .. }
            | EventKind::StepEnded { .. }
            | EventKind::Sees { .. }
            | EventKind::WallContact { .. }
            | EventKind::Door { .. }
            | EventKind::Node { .. }
            | EventKind::Stuck { .. } => {}
        }
    }

    /// The run is over: so many ticks with this recording hash.
    pub const fn ends(&mut self, ticks: u64, hash: Digest) {
        self.ticks = ticks;
        self.hash = hash;
    }

    /// The summary of a recording.
    #[must_use]
    pub fn of(recording: &Recording) -> Self {
        let mut summary = Self::begun(&recording.header);
        recording.events.iter().for_each(|event| summary.event(event));
        summary.ends(recording.ticks() as u64, recording.hash());
        summary
    }

    /// The remark for the status line: `61.2 s simulated`.
    #[must_use]
    pub fn remark(&self) -> String {
        format!("{:.1} s simulated", self.seconds)
    }
}
