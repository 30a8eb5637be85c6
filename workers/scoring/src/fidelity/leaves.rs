//! Leaves of behavior trees as the recording tells them: who ran what, from when to when.

use socrates_model::recording::DRIVEN_LEAF;
use socrates_model::{EventKind, HumanId, Recording};

use crate::tracks::Track;

/// A leaf that ran without a break.
#[derive(Debug, Clone, PartialEq)]
pub struct LeafSpan {
    /// Start, s.
    pub from_s: f64,
    /// End, s.
    pub to_s: f64,
    /// Name as in the tree.
    pub name: String,
}

/// Spans of a human's leaves: from events where there are any, else from the states. Somebody who is driven from outside has none.
#[must_use]
pub(super) fn leaf_spans(recording: &Recording, track: &Track) -> Vec<LeafSpan> {
    let Some(id) = track.human() else { return Vec::new() };
    let end = track.samples.last().map_or(0.0, |sample| sample.t);
    let mut starts: Vec<(f64, String)> = Vec::new();
    for event in &recording.events {
        if let EventKind::Leaf { human, leaf } = &event.kind
            && *human == id
        {
            starts.push((event.time.secs(), leaf.clone()));
        }
    }
    if starts.is_empty() {
        let mut last = 0_u16;
        for sample in &track.samples {
            if sample.leaf != last {
                let name = recording.header.leaves.get(usize::from(sample.leaf)).cloned().unwrap_or_default();
                starts.push((sample.t, name));
                last = sample.leaf;
            }
        }
    }
    let ends: Vec<f64> = starts.iter().skip(1).map(|(t, _)| *t).chain([end]).collect();
    starts
        .into_iter()
        .zip(ends)
        .filter(|((_, name), _)| !name.is_empty() && name != DRIVEN_LEAF)
        .map(|((from_s, name), to_s)| LeafSpan { from_s, to_s, name })
        .collect()
}

/// Whether somebody is driven from outside: by no tree, so that their motion alone tells what they do.
#[must_use]
pub(super) fn is_driven(recording: &Recording, track: &Track) -> bool {
    let Some(id) = track.human() else { return false };
    let told = |human: &HumanId, leaf: &str| *human == id && leaf == DRIVEN_LEAF;
    let by_event = recording
        .events
        .iter()
        .any(|event| if let EventKind::Leaf { human, leaf } = &event.kind { told(human, leaf) } else { false });
    let number = recording.header.leaves.iter().position(|leaf| leaf == DRIVEN_LEAF);
    by_event || track.samples.first().is_some_and(|sample| number == Some(usize::from(sample.leaf)))
}
