//! How well the meetings were timed.

use std::collections::BTreeMap;

use socrates_model::{EventKind, HumanId, ordinal};

use crate::fidelity::signals::Signals;

/// Arriving at an encounter is coming this near to its node, m.
pub(super) const ARRIVED_M: f64 = 1.5;

/// A gap as reports have it, to a millisecond: whoever writes it with fewer digits begins from the same figure.
fn to_millis(gap_s: f64) -> f64 {
    (gap_s * 1e3).round() / 1e3
}

/// Achieved gap of each encounter, s, by human and number of the meeting, from 1.
pub type Gaps = BTreeMap<(HumanId, u32), f64>;

/// Achieved gap of each encounter: as the engine tells it, else from the tracks. Positive: the human came later.
pub(crate) fn encounter_gaps(signals: &Signals<'_>) -> Gaps {
    let mut gaps = BTreeMap::new();
    for event in &signals.evidence.recording.events {
        if let EventKind::Encounter { human, gap_s, nth, .. } = &event.kind
            && gap_s.is_finite()
        {
            gaps.entry((*human, *nth)).or_insert_with(|| to_millis(*gap_s));
        }
    }
    let Some(paths) = signals.evidence.paths else { return gaps };
    let mut met: BTreeMap<HumanId, u32> = BTreeMap::new();
    for encounter in &paths.encounters {
        let nth = *met.entry(encounter.human).and_modify(|nth| *nth += 1).or_insert(1);
        let (Some(at), Some(robot), Some(human)) =
            (signals.node(&encounter.node), &signals.tracks.robot, signals.tracks.human(encounter.human))
        else {
            continue;
        };
        let meeting = signals.meeting(encounter.human, nth);
        let own = |t: f64| meeting.is_none_or(|meeting| (meeting.from_s..meeting.to_s).contains(&t));
        let arrival = |samples: &[crate::tracks::Sample]| {
            let there =
                |sample: &&crate::tracks::Sample| sample.there && own(sample.t) && (sample.at - at).norm() <= ARRIVED_M;
            samples.iter().find(there).map(|sample| sample.t)
        };
        if let (Some(first), Some(second)) = (arrival(&robot.samples), arrival(&human.samples)) {
            gaps.entry((encounter.human, nth)).or_insert_with(|| to_millis(second - first));
        }
    }
    gaps
}

/// The gaps as reports have them: by human, those after the first meeting with its number in words.
pub(crate) fn by_name(gaps: &Gaps) -> BTreeMap<String, f64> {
    gaps.iter().map(|((human, nth), gap_s)| (name(*human, *nth), *gap_s)).collect()
}

/// Who, and which of their meetings if not the first.
fn name(human: HumanId, nth: u32) -> String {
    if nth > 1 { format!("{human} {} meeting", ordinal(nth)) } else { human.to_string() }
}
