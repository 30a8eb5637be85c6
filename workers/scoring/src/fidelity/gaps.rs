//! How well the meetings were timed.

use std::collections::BTreeMap;

use socrates_model::EventKind;

use crate::fidelity::signals::Signals;

/// Arriving at an encounter is coming this near to its node, m.
pub(super) const ARRIVED_M: f64 = 1.5;

/// A gap as reports have it, to a millisecond: whoever writes it with fewer digits begins from the same figure.
#[must_use]
pub(crate) fn to_millis(gap_s: f64) -> f64 {
    (gap_s * 1e3).round() / 1e3
}

/// Achieved gap of each encounter, s, by human: as the engine tells it, else from the tracks. Positive:
/// the human came later.
pub(crate) fn encounter_gaps(signals: &Signals<'_>) -> BTreeMap<String, f64> {
    let mut gaps = BTreeMap::new();
    for event in &signals.evidence.recording.events {
        if let EventKind::Encounter { human, gap_s, .. } = &event.kind
            && gap_s.is_finite()
        {
            gaps.entry(human.to_string()).or_insert_with(|| to_millis(*gap_s));
        }
    }
    let Some(paths) = signals.evidence.paths else { return gaps };
    for encounter in &paths.encounters {
        let (Some(at), Some(robot), Some(human)) =
            (signals.node(&encounter.node), &signals.tracks.robot, signals.tracks.human(encounter.human))
        else {
            continue;
        };
        let arrival = |samples: &[crate::tracks::Sample]| {
            samples.iter().find(|sample| sample.there && (sample.at - at).norm() <= ARRIVED_M).map(|sample| sample.t)
        };
        if let (Some(first), Some(second)) = (arrival(&robot.samples), arrival(&human.samples)) {
            gaps.entry(encounter.human.to_string()).or_insert_with(|| to_millis(second - first));
        }
    }
    gaps
}
