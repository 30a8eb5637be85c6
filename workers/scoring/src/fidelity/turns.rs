//! What changes somebody's way or pace: they turn back, or walk at another speed from then on.

use std::f64::consts::PI;

use socrates_model::act::Destination;
use socrates_model::{Action, HumanId, NodeId, Point, Rule};

use crate::fidelity::finding::Finding;
use crate::fidelity::going::{LAST_SECS, SHARE};
use crate::fidelity::meeting::absent;
use crate::fidelity::signals::Signals;
use crate::fidelity::since::{Since, since, since_act};
use crate::tracks::{Sample, Track};

/// Walking back is going at an angle of at least this to the way before, rad (150°).
const BACK_RAD: f64 = 150.0 / 180.0 * PI;
/// So far somebody walks back at least, m.
const BACK_M: f64 = 2.0;
/// The way before is that of so much time of walking, s; the way back begins within this after the reason, s.
const BEFORE_SECS: f64 = 2.0;
const WITHIN_SECS: f64 = 6.0;
/// Somebody slower than this does not walk, m/s.
const WALKS_MPS: f64 = 0.15;
/// Somebody this near to a node is there, m, and goes there from so much farther away.
const THERE_M: f64 = 1.0;
const FROM_M: f64 = 1.0;
/// A pace is the mean over so much time of walking, s, of which at least so much is there, s.
const PACE_SECS: f64 = 3.0;
const LEAST_SECS: f64 = 1.5;
/// Two paces differ that are so far apart, as a share of the one before.
const DIFFERS: f64 = 0.25;
/// It takes so long to take up another pace, s.
const TAKES_SECS: f64 = 1.0;

fn walking(track: &Track, from_s: f64, to_s: f64) -> impl DoubleEndedIterator<Item = &Sample> {
    track.samples.iter().filter(move |s| s.there && s.t >= from_s && s.t <= to_s && s.speed() > WALKS_MPS)
}

/// Time between two samples of a track, s.
fn step_s(track: &Track) -> f64 {
    let ends = track.samples.first().zip(track.samples.last());
    ends.map_or(0.0, |(first, last)| (last.t - first.t) / track.samples.len().saturating_sub(1).max(1) as f64)
}

/// The human walks back the way they came.
pub(super) fn turns_back(signals: &Signals<'_>, human: HumanId) -> Finding {
    if let Some(found) = absent(signals, human) {
        return found;
    }
    let Some(track) = signals.tracks.human(human) else { return Finding::not_applicable("nobody is recorded") };
    let since = match since_act(signals, human, &Action::TurnBack) {
        Ok(since) => since,
        Err(never) => return never,
    };
    let begun_s =
        signals.leaves_of(human).iter().find(|span| Action::TurnBack.is_leaf(&span.name)).map(|span| span.from_s);
    let Some(turn_s) = begun_s.or_else(|| since.is_reaction().then(|| since.secs())) else {
        return Finding::never(-BACK_M, vec![], format!("{human} never turns back"));
    };
    let before: Vec<&Sample> =
        walking(track, 0.0, turn_s).rev().take_while(|s| s.t >= turn_s - 4.0 * BEFORE_SECS).collect();
    let way = before.iter().map(|sample| sample.velocity).fold(socrates_model::Vector::zeros(), |sum, v| sum + v);
    if before.len() as f64 * step_s(track) < 0.25 * BEFORE_SECS || way.norm() < 1e-9 {
        return Finding::fails(
            -BACK_M,
            vec![turn_s],
            format!("{human} does not walk before they turn at {turn_s:.1} s"),
        );
    }
    let way = way / way.norm();
    // One stretch of walking back, from its beginning in time.
    let (mut back_m, mut best_m, mut first_s) = (0.0_f64, 0.0_f64, None);
    for sample in walking(track, turn_s, f64::INFINITY) {
        let course = sample.velocity / sample.speed().max(1e-9);
        let turned = libm::acos(course.dot(&way).clamp(-1.0, 1.0)) >= BACK_RAD;
        back_m = if turned { back_m + sample.speed() * step_s(track) } else { 0.0 };
        if turned && first_s.is_none() {
            first_s = Some(sample.t);
        }
        best_m = best_m.max(back_m);
    }
    let text =
        format!("{human} turns at {turn_s:.1} s and walks {best_m:.1} m back in one stretch (at least {BACK_M:.0} m)");
    let Some(first_s) = first_s else { return Finding::fails(-BACK_M, vec![turn_s], text) };
    if first_s - turn_s > WITHIN_SECS {
        let text = format!("{text}, {:.1} s later (at most {WITHIN_SECS:.0} s)", first_s - turn_s);
        return Finding::fails(turn_s + WITHIN_SECS - first_s, vec![first_s, turn_s], text);
    }
    since.told(Finding::by_margin(best_m - BACK_M, vec![first_s, turn_s], text))
}

/// The human goes to a place.
pub(super) fn goes_to(signals: &Signals<'_>, human: HumanId, nodes: &[NodeId]) -> Finding {
    if let Some(found) = absent(signals, human) {
        return found;
    }
    let Some(track) = signals.tracks.human(human) else { return Finding::not_applicable("nobody is recorded") };
    let places: Vec<Point> = nodes.iter().filter_map(|node| signals.node(node)).collect();
    if places.is_empty() {
        return Finding::not_applicable("there is no map with the nodes of the place");
    }
    let goes = |rule: &Rule| matches!(&rule.act, Action::GoTo(to) if to.nodes == *nodes);
    let since = match since(signals, human, goes) {
        Ok(since) => since,
        Err(never) => return never,
    };
    let act = Action::GoTo(Destination { place: String::new(), nodes: Vec::new() });
    gets_near(signals, (human, track), &act, &since, ("the place", &places))
}

/// The human goes back to where they began.
pub(super) fn comes_back(signals: &Signals<'_>, human: HumanId) -> Finding {
    if let Some(found) = absent(signals, human) {
        return found;
    }
    let Some(track) = signals.tracks.human(human) else {
        return Finding::not_applicable("they are not in the recording");
    };
    let since = match since_act(signals, human, &Action::ComeBack) {
        Ok(since) => since,
        Err(never) => return never,
    };
    let began: Vec<Point> = track.present().take(1).map(|sample| sample.at).collect();
    gets_near(signals, (human, track), &Action::ComeBack, &since, ("where they began", &began))
}

/// The human gets near one of some places by an act, from farther away.
fn gets_near(
    signals: &Signals<'_>,
    (human, track): (HumanId, &Track),
    act: &Action,
    since: &Since,
    (place, places): (&str, &[Point]),
) -> Finding {
    let begun_s = signals
        .leaves_of(human)
        .iter()
        .find(|span| act.is_leaf(&span.name) && since.counts(span.from_s))
        .map(|span| span.from_s);
    let begun_s = begun_s.unwrap_or_else(|| since.secs().max(0.0));
    let from = |sample: &Sample| places.iter().map(|at| (sample.at - at).norm()).fold(f64::INFINITY, f64::min);
    let there = |sample: &&Sample| sample.there && sample.t >= begun_s;
    let Some(first) = track.samples.iter().find(there) else {
        return Finding::never(-1.0, vec![], format!("{human} is not there any more at {begun_s:.1} s"));
    };
    if from(first) <= THERE_M + FROM_M {
        let text = format!(
            "{human} goes to {place} from {begun_s:.1} s, and is there already: {:.1} m away (more than {:.0} m asked)",
            from(first),
            THERE_M + FROM_M
        );
        return Finding::fails(from(first) - THERE_M - FROM_M, vec![begun_s], text);
    }
    let nearest = track.samples.iter().filter(there).min_by(|a, b| from(a).total_cmp(&from(b))).unwrap_or(first);
    let arrived = track.samples.iter().filter(there).find(|sample| from(sample) <= THERE_M);
    let text = format!(
        "{human} goes to {place} from {begun_s:.1} s, {:.1} m away from it: nearest {:.1} m at {:.1} s (at most {THERE_M:.0} m)",
        from(first),
        from(nearest),
        nearest.t
    );
    let t = arrived.map_or(nearest.t, |sample| sample.t);
    // People on the way to it as the run ends count.
    let ends_s = track.samples.iter().rfind(there).map_or(begun_s, |sample| sample.t);
    let came_m = from(first) - from(nearest);
    let on_the_way = nearest.t >= ends_s - LAST_SECS && came_m >= SHARE * from(first);
    if arrived.is_none() && on_the_way {
        return since.told(Finding::holds(came_m, vec![t, begun_s], format!("{text}, on the way as the run ends")));
    }
    since.told(Finding::by_margin(THERE_M - from(nearest), vec![t, begun_s], text))
}

/// The human walks at another pace from a time on.
pub(super) fn changes_pace(signals: &Signals<'_>, human: HumanId, mps: f64) -> Finding {
    if let Some(found) = absent(signals, human) {
        return found;
    }
    let Some(track) = signals.tracks.human(human) else { return Finding::not_applicable("nobody is recorded") };
    let act = Action::ChangePace(mps);
    let since = match since_act(signals, human, &act) {
        Ok(since) => since,
        Err(never) => return never,
    };
    let mut spans = signals.leaves_of(human).iter();
    let begun_s = spans.find(|span| act.is_leaf(&span.name) && since.counts(span.from_s)).map(|span| span.from_s);
    let Some(begun_s) = begun_s.or_else(|| since.is_reaction().then(|| since.secs())) else {
        return Finding::never(-DIFFERS, vec![], format!("{human} never changes their pace"));
    };
    let mean = |samples: Vec<&Sample>| {
        let long_s = samples.len() as f64 * step_s(track);
        let sum: f64 = samples.iter().map(|sample| sample.speed()).sum();
        (long_s >= LEAST_SECS).then(|| sum / samples.len() as f64)
    };
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few samples")]
    let most = (PACE_SECS / step_s(track).max(1e-6)) as usize;
    let before = mean(walking(track, 0.0, begun_s).rev().take(most).collect());
    let after = mean(walking(track, begun_s + TAKES_SECS, f64::INFINITY).take(most).collect());
    let (Some(before), Some(after)) = (before, after) else {
        let text = format!("{human} does not walk long enough before and after {begun_s:.1} s to show a pace");
        return Finding::fails(-DIFFERS, vec![begun_s], text);
    };
    let change = (after - before) / before.max(1e-9);
    let asked = if mps >= before { 1.0 } else { -1.0 };
    let text = format!(
        "{human} walks at {before:.2} m/s before and at {after:.2} m/s after {begun_s:.1} s ({:+.0} %, at least {:.0} % toward {mps} \
         m/s asked)",
        change * 100.0,
        DIFFERS * 100.0
    );
    // Past the pace asked for is not toward it.
    let nearer = ((before - mps).abs() - (after - mps).abs()) / before.max(1e-9);
    since.told(Finding::by_margin((asked * change - DIFFERS).min(nearer), vec![begun_s], text))
}
