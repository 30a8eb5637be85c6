//! Whether the recording could have happened: no overlap, no superhuman speed, nobody stuck.

use socrates_model::{AgentId, EventKind};

use crate::fidelity::finding::Finding;
use crate::fidelity::signals::Signals;
use crate::skips::{arcs, next};
use crate::tracks::Track;

/// Overlap that contact resolution may leave, m.
const OVERLAP_M: f64 = 0.02;
/// By how much of a cell the distance to a wall may be off.
const FIELD_CELLS: f64 = 0.25;
/// Fastest plausible agent, m/s, and what rounding of positions may add.
const FASTEST_MPS: f64 = 2.0;
const SPEED_SLACK_MPS: f64 = 0.1;
/// Speed is judged over at least this time, s.
const SPEED_SECS: f64 = 0.1;

/// A way in which a recording is not plausible.
#[derive(Debug, Clone, PartialEq)]
pub struct Flaw {
    /// What is wrong, with numbers.
    pub text: String,
    /// When, s.
    pub t: f64,
    /// By how much, in its unit.
    pub excess: f64,
    /// Who.
    pub agents: Vec<AgentId>,
    /// Whether it is a lack of progress and not an overlap or a speed.
    pub stuck: bool,
}

/// Everything implausible, worst first within each kind.
#[must_use]
pub(super) fn flaws(signals: &Signals<'_>) -> Vec<Flaw> {
    let mut found = Vec::new();
    let agents: Vec<&Track> = signals.full.all().collect();
    let ways: Vec<Vec<f64>> = agents.iter().map(|track| arcs(track.samples.iter().map(|sample| &sample.at))).collect();
    for (index, (a, way_a)) in agents.iter().zip(&ways).enumerate() {
        for (b, way_b) in agents.iter().zip(&ways).skip(index + 1) {
            found.extend(overlap((a, way_a), (b, way_b)));
        }
        found.extend(too_fast(a));
    }
    if let (Some(location), Some(field)) = (signals.evidence.location, &signals.field) {
        // The field is exact to a part of a cell only.
        let allowed = OVERLAP_M + FIELD_CELLS * location.grid.resolution_m;
        for track in signals.tracks.all() {
            let worst = track
                .present()
                .map(|sample| (track.radius_m - field.clearance(&sample.at), sample.t))
                .max_by(|a, b| a.0.total_cmp(&b.0));
            if let Some((depth, t)) = worst.filter(|(depth, _)| *depth > allowed) {
                let text = format!("{} is {depth:.2} m inside a wall at {t:.1} s", track.agent);
                found.push(Flaw { text, t, excess: depth - allowed, agents: vec![track.agent], stuck: false });
            }
        }
    }
    // A robot under test that gets stuck is a result; the reference robot, or a person, is a fault of the scenario.
    let reference = signals.evidence.recording.header.planner.is_reference();
    for event in &signals.evidence.recording.events {
        if let EventKind::Stuck { agent } = &event.kind
            && (*agent != AgentId::Robot || reference)
        {
            let t = event.time.secs();
            let text = format!("{agent} made no progress for 20 s up to {t:.1} s");
            found.push(Flaw { text, t, excess: 1.0, agents: vec![*agent], stuck: true });
        }
    }
    found
}

/// Whether two discs ever overlap, given the ways of both.
fn touches((a, way_a): (&Track, &[f64]), (b, way_b): (&Track, &[f64]), touch: f64) -> bool {
    let mut index = 0;
    while let (Some(p), Some(q)) = (a.samples.get(index), b.samples.get(index)) {
        let apart = (p.at - q.at).norm() - touch;
        if apart <= 0.0 && p.there && q.there {
            return true;
        }
        index = next([way_a, way_b], index, apart);
    }
    false
}

fn overlap((a, way_a): (&Track, &[f64]), (b, way_b): (&Track, &[f64])) -> Option<Flaw> {
    let touch = a.radius_m + b.radius_m;
    if !touches((a, way_a), (b, way_b), touch) {
        return None;
    }
    let (depth, t) = a
        .beside(b)
        .map(|(p, q)| (touch - (p.at - q.at).norm(), p.t))
        .max_by(|x, y| x.0.total_cmp(&y.0))
        .filter(|(depth, _)| *depth > OVERLAP_M)?;
    let text = format!("{} and {} overlap by {depth:.2} m at {t:.1} s", a.agent, b.agent);
    Some(Flaw { text, t, excess: depth - OVERLAP_M, agents: vec![a.agent, b.agent], stuck: false })
}

fn too_fast(track: &Track) -> Option<Flaw> {
    let mut from = track.samples.first()?;
    let mut top: Option<(f64, f64)> = None;
    for sample in &track.samples {
        let dt = sample.t - from.t;
        if !(sample.there && from.there) {
            from = sample;
            continue;
        }
        if dt < SPEED_SECS - 1e-9 {
            continue;
        }
        let speed = (sample.at - from.at).norm() / dt;
        if top.is_none_or(|(old, _)| speed > old) {
            top = Some((speed, sample.t));
        }
        from = sample;
    }
    let (speed, t) = top.filter(|(speed, _)| *speed > FASTEST_MPS + SPEED_SLACK_MPS)?;
    let text = format!("{} moves at {speed:.1} m/s at {t:.1} s (at most {FASTEST_MPS:.0} m/s)", track.agent);
    Some(Flaw { text, t, excess: speed - FASTEST_MPS, agents: vec![track.agent], stuck: false })
}

/// The clause made from the flaws.
#[must_use]
pub(super) fn plausible(flaws: &[Flaw]) -> Finding {
    match flaws.iter().max_by(|a, b| a.excess.total_cmp(&b.excess)) {
        None => Finding::holds(1.0, vec![0.0], "nobody overlaps a wall or another, nobody is faster than 2 m/s"),
        Some(worst) => {
            let times = flaws.iter().map(|flaw| flaw.t).collect();
            let text = flaws.iter().map(|flaw| flaw.text.clone()).collect::<Vec<_>>().join("; ");
            Finding::fails(-worst.excess, times, text).scaled(0.1)
        }
    }
}
