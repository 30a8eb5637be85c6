//! Monitors of how somebody walks and where they go: their pace, and the place at the end of their way.

use socrates_model::{Action, HumanId, NodeId, Point};

use crate::fidelity::finding::Finding;
use crate::fidelity::meeting::absent;
use crate::fidelity::signals::{MOMENT_SECS, Signals, Way};
use crate::tracks::{Sample, Track};

/// Somebody slower than this does not walk, m/s.
const WALKS_MPS: f64 = 0.15;
/// A pace is the mean over so much time of walking, s.
const PACE_SECS: f64 = 2.0;
/// And is right within this share.
const RIGHT: f64 = 0.15;
/// Samples farther apart than this tell of no walking between them, s.
const APART_SECS: f64 = 0.3;
/// Somebody is at the place from so near to a node of it, m, and has come from so much farther away.
const THERE_M: f64 = 1.5;
const FROM_M: f64 = 1.0;
/// Farther from their way than this nobody is on it, m.
const OFF_WAY_M: f64 = 2.0;
/// Where the run ends first, this share of their way from the meeting has to be behind them.
pub(super) const SHARE: f64 = 0.5;
/// And they get on by so much in the last time of the run, m and s.
const GETS_ON_M: f64 = 0.2;
pub(super) const LAST_SECS: f64 = 2.0;

/// The human walks at a pace, before they do anything else.
pub(super) fn walks(signals: &Signals<'_>, human: HumanId, mps: f64) -> Finding {
    if let Some(found) = absent(signals, human) {
        return found;
    }
    let Some(track) = signals.tracks.human(human) else { return Finding::not_applicable("nobody is recorded") };
    let leaves = signals.leaves_of(human);
    let own = |name: &str| Action::Navigate.is_leaf(name);
    let paces = |name: &str| Action::ChangePace(mps).is_leaf(name);
    let first = |other: &dyn Fn(&str) -> bool| {
        leaves.iter().find(|span| other(&span.name)).map_or(f64::INFINITY, |span| span.from_s)
    };
    let busy = |t: f64| leaves.iter().any(|span| !own(&span.name) && t >= span.from_s && t <= span.to_s + MOMENT_SECS);
    // Somebody whose steps have them stand first walks after that.
    let before = fastest(track, |t| t < first(&|name| !own(name)));
    let fastest = before.or_else(|| fastest(track, |t| t < first(&paces) && !busy(t)));
    let Some((found_mps, from_s)) = fastest else {
        let text = format!("{human} never walks for {PACE_SECS:.0} s by themselves, so that no pace is seen");
        return Finding::fails(-RIGHT, vec![], text);
    };
    let off = (found_mps - mps).abs() / mps.max(1e-9);
    let text = format!(
        "{human} walks at {found_mps:.2} m/s from {from_s:.1} s ({mps} m/s asked, within {:.0} %)",
        RIGHT * 100.0
    );
    Finding::by_margin(RIGHT - off, vec![from_s], text).scaled(RIGHT)
}

/// The largest mean speed over the time of a pace in which somebody walks without a break, m/s, and when it begins, s.
fn fastest(track: &Track, counts: impl Fn(f64) -> bool) -> Option<(f64, f64)> {
    let mut stretch: Vec<(f64, f64)> = Vec::new();
    let mut best: Option<(f64, f64)> = None;
    let mut from = 0;
    let mut before: Option<&Sample> = None;
    for sample in track.present() {
        let on = sample.speed() > WALKS_MPS && counts(sample.t);
        let joined = before.filter(|last| on && sample.t - last.t <= APART_SECS && !stretch.is_empty());
        match joined {
            Some(last) => {
                let way_m = stretch.last().map_or(0.0, |(_, way)| *way);
                stretch.push((sample.t, way_m + (sample.at - last.at).norm()));
            }
            None => {
                (stretch, from) = (Vec::new(), 0);
                if on {
                    stretch.push((sample.t, 0.0));
                }
            }
        }
        before = Some(sample);
        while let (Some((begin, way)), Some((end, whole))) = (stretch.get(from), stretch.last())
            && end - begin >= PACE_SECS - 1e-6
        {
            let mean = (whole - way) / (end - begin);
            if best.is_none_or(|(most, _)| mean > most) {
                best = Some((mean, *begin));
            }
            from += 1;
        }
    }
    best
}

/// The human gets to a place, or is well on the way to it when the run ends.
pub(super) fn gets_to(signals: &Signals<'_>, human: HumanId, nodes: &[NodeId]) -> Finding {
    if let Some(found) = absent(signals, human) {
        return found;
    }
    let (Some(paths), Some(location)) = (signals.evidence.paths, signals.evidence.location) else {
        return Finding::not_applicable("there is no map or no paths to tell where anybody goes");
    };
    let list = nodes.iter().map(|node| format!("`{node}`")).collect::<Vec<_>>().join(", ");
    let way = paths.humans.get(&human).map_or(&[][..], Vec::as_slice);
    if !way.last().is_some_and(|last| nodes.contains(last)) {
        return Finding::fails(-1.0, vec![], format!("the way of {human} as planned does not lead to {list}"));
    }
    let places: Vec<Point> = nodes.iter().filter_map(|node| signals.node(node)).collect();
    let rooms = signals.enclosures.as_deref();
    let inside = |at: &Point| {
        rooms.is_some_and(|rooms| nodes.iter().filter_map(|node| rooms.of_node(node)).any(|room| rooms.holds(room, at)))
    };
    let off_m = |at: &Point| {
        let nearest = places.iter().map(|place| (at - place).norm()).fold(f64::INFINITY, f64::min);
        if inside(at) { nearest.min(0.0) } else { nearest }
    };
    let track = signals.tracks.human(human);
    let ends = track.and_then(|track| track.present().next().zip(track.present().next_back()));
    let (Some(track), Some((start, end))) = (track, ends) else {
        return Finding::not_applicable("nobody is recorded");
    };
    if off_m(&start.at) <= THERE_M + FROM_M {
        let text = format!("{human} starts at {list}, {:.1} m from it", off_m(&start.at).max(0.0));
        return Finding::fails(off_m(&start.at) - THERE_M - FROM_M, vec![start.t], text);
    }
    if off_m(&end.at) <= THERE_M {
        let there = track.present().find(|sample| off_m(&sample.at) <= THERE_M).unwrap_or(end);
        let text = format!("{human} gets to {list} at {:.1} s and ends there", there.t);
        return Finding::by_margin(THERE_M - off_m(&end.at), vec![there.t, end.t], text);
    }
    let line = Way::new(location.graph.polyline(way));
    let last = places.iter().filter_map(|place| line.place(place)).map(|(s, _)| s).fold(0.0, f64::max);
    let left_m = |sample: &Sample| line.place(&sample.at).filter(|(_, off)| *off <= OFF_WAY_M).map(|(s, _)| last - s);
    let nearest = signals.of(human).iter().min_by(|a, b| a.distance_m.total_cmp(&b.distance_m));
    let met = nearest.and_then(|moment| Some((left_m(&moment.human)?, moment.t)));
    let (Some((met_m, met_s)), Some(end_m)) = (met, left_m(end)) else {
        let text = format!("{human} ends {:.1} m from {list}, off the way to it", off_m(&end.at));
        return Finding::fails(THERE_M - off_m(&end.at), vec![end.t], text);
    };
    let shortly = track.present().find(|sample| sample.t >= end.t - LAST_SECS).and_then(left_m);
    let gets_on_m = shortly.map_or(0.0, |before| before - end_m);
    let text = format!(
        "{human} has {met_m:.1} m to go to {list} when the robot is nearest, at {met_s:.1} s, and {end_m:.1} m when the run ends \
         (half of it asked), getting on by {gets_on_m:.1} m in the last {LAST_SECS:.0} s"
    );
    Finding::by_margin((met_m - end_m - SHARE * met_m).min(gets_on_m - GETS_ON_M), vec![met_s, end.t], text)
}
