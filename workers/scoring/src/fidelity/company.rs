//! Monitors of going together: follows, abreast, parallel.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use socrates_model::{AgentId, HumanId};

use crate::fidelity::finding::Finding;
use crate::fidelity::follow::{Gap, Together, arcs, gaps};
use crate::fidelity::meeting::absent;
use crate::fidelity::signals::Signals;
use crate::fidelity::since::since_follows;
use crate::fidelity::windows::{Mark, held, longest_s, stretches};
use crate::tracks::MOVING_MPS;

/// How far off the leader's trail one still follows, m.
const TRAIL_M: f64 = 1.2;
/// The two go together at this pace over the asked time at least, and 0.5 m: to stand behind somebody, or beside them as they
/// drive off, is neither following nor going along.
const LEAD_MPS: f64 = 0.1;
/// Courses nearer to each other than this are the same way, rad (30°).
const SAME_WAY_RAD: f64 = PI / 6.0;
/// Within this distance two go in parallel, m.
const PARALLEL_M: f64 = 4.0;
/// Slower than this is not walking along, m/s.
const WALKING_MPS: f64 = 0.2;

/// Marks of one who goes behind another with the gap in a range.
#[must_use]
pub(super) fn follow_marks(gaps: &[Gap], gap_m: [f64; 2]) -> Vec<Mark> {
    let [low, high] = gap_m;
    gaps.iter()
        .map(|gap| Mark {
            t: gap.t,
            margin: (gap.gap_m - low).min(high - gap.gap_m).min(TRAIL_M - gap.off_m),
            arc_m: gap.together_m,
        })
        .collect()
}

/// The follower goes behind the leader for some time.
pub(super) fn follows(
    signals: &Signals<'_>,
    follower: AgentId,
    leader: AgentId,
    gap_m: [f64; 2],
    for_s: f64,
) -> Finding {
    follows_since(signals, (follower, leader), gap_m, for_s, f64::NEG_INFINITY)
}

/// The same from a time on.
pub(super) fn follows_since(
    signals: &Signals<'_>,
    (follower, leader): (AgentId, AgentId),
    gap_m: [f64; 2],
    for_s: f64,
    since_s: f64,
) -> Finding {
    let missing = |agent: AgentId| match agent {
        AgentId::Robot => Finding::not_applicable("there is no robot in the recording"),
        AgentId::Human(id) => Finding::fails(-1.0, vec![], format!("{id} is not in the recording")),
    };
    let Some(behind) = signals.track(follower) else { return missing(follower) };
    let Some(lead) = signals.track(leader) else { return missing(leader) };
    let from = match since_follows(signals, follower, leader) {
        Ok(from) => from,
        Err(never) => return never,
    };
    let mut gaps = gaps(lead, behind);
    gaps.retain(|gap| from.counts(gap.t) && gap.t >= since_s);
    let marks = follow_marks(&gaps, gap_m);
    let [low, high] = gap_m;
    let what = format!("{follower} behind {leader} with a gap of {low:.1} to {high:.1} m for {for_s:.1} s");
    let Some(nearest) = gaps.iter().min_by(|a, b| a.distance_m.total_cmp(&b.distance_m)) else {
        return Finding::not_applicable("the recording is empty");
    };
    let Some(found) = held(marks.iter().copied(), for_s, (LEAD_MPS * for_s).max(0.5)) else {
        return Finding::never(-1.0, vec![nearest.t], format!("{what}: the two do not go together for so long"));
    };
    if let Some(from) = found.first_s {
        let spans = stretches(marks, for_s);
        let all: f64 = spans.iter().map(|(from, to)| to - from).sum();
        let longest = spans.iter().map(|(from, to)| to - from).fold(0.0, f64::max);
        let text = format!("{what}: from {from:.1} s, {all:.1} s in all, margin {:.2} m", found.margin);
        return Finding::holds(found.margin, vec![from, from + for_s], text).shifted(longest - for_s);
    }
    if nearest.distance_m > high + 1.0 {
        let text = format!("{what}: never near, closest {:.1} m at {:.1} s", nearest.distance_m, nearest.t);
        return Finding::never(found.margin, vec![nearest.t], text);
    }
    let longest = stretches(marks, 0.0).into_iter().map(|(a, b)| (b - a, a)).max_by(|a, b| a.0.total_cmp(&b.0));
    let text = match longest {
        Some((length, from)) if length >= for_s => {
            format!("{what}: {length:.1} s from {from:.1} s, but the two hardly go anywhere then")
        }
        Some((length, from)) => format!("{what}: only {length:.1} s from {from:.1} s"),
        None if found.margin.is_infinite() => format!("{what}: it never came about"),
        None => format!("{what}: not once, short by {:.2} m at {:.1} s", -found.margin, found.best_s),
    };
    Finding::fails(found.margin, vec![found.best_s], text).shifted(longest.map_or(0.0, |(length, _)| length) - for_s)
}

/// Human and robot go side by side for some time.
pub(super) fn abreast(signals: &Signals<'_>, human: HumanId, for_s: f64) -> Finding {
    abreast_since(signals, human, for_s, f64::NEG_INFINITY)
}

/// The same from a time on.
pub(super) fn abreast_since(signals: &Signals<'_>, human: HumanId, for_s: f64, since_s: f64) -> Finding {
    if let Some(found) = absent(signals, human) {
        return found;
    }
    let mut together = Together::default();
    let marks: Vec<Mark> = signals
        .of(human)
        .iter()
        .filter(|moment| moment.t >= since_s)
        .map(|moment| {
            let arc_m = together.to(moment.robot.at, moment.human.at);
            let aside = FRAC_PI_4 - (moment.robot.bearing(&moment.human.at).abs() - FRAC_PI_2).abs();
            // Somebody who comes the other way is beside the robot for a moment only, and does not go with it.
            let way = if moment.human.speed() > MOVING_MPS { FRAC_PI_2 - moment.course_rad } else { aside };
            let margin = (moment.distance_m - 0.5).min(2.0 - moment.distance_m).min(aside).min(way);
            Mark { t: moment.t, margin, arc_m }
        })
        .collect();
    let what = format!("{human} beside the robot at 0.5 to 2.0 m for {for_s:.1} s");
    match held(marks.iter().copied(), for_s, (LEAD_MPS * for_s).max(0.5)) {
        None => Finding::never(-1.0, vec![], format!("{what}: the two do not go together for so long")),
        Some(found) => {
            let longest = longest_s(marks);
            let finding = match found.first_s {
                Some(from) => {
                    Finding::holds(found.margin, vec![from, from + for_s], format!("{what}: from {from:.1} s"))
                }
                None => Finding::fails(found.margin, vec![found.best_s], format!("{what}: longest {longest:.1} s")),
            };
            finding.shifted(longest - for_s)
        }
    }
}

/// Human and robot go the same way near each other for some time.
pub(super) fn parallel(signals: &Signals<'_>, human: HumanId, for_s: f64) -> Finding {
    if let Some(found) = absent(signals, human) {
        return found;
    }
    let Some(robot) = &signals.tracks.robot else { return Finding::not_applicable("there is no robot") };
    let moments = signals.of(human);
    let ways = arcs(&robot.samples);
    let marks = moments.iter().filter_map(|moment| Some((moment, *ways.get(moment.index)?))).map(|(moment, arc_m)| {
        let margin = (PARALLEL_M - moment.distance_m)
            .min(SAME_WAY_RAD - moment.course_rad)
            .min(moment.human.speed() - WALKING_MPS)
            .min(moment.robot.speed() - MOVING_MPS);
        Mark { t: moment.t, margin, arc_m }
    });
    let marks: Vec<Mark> = marks.collect();
    let what = format!("{human} goes the robot's way within {PARALLEL_M:.0} m for {for_s:.1} s");
    let Some(nearest) = moments.iter().min_by(|a, b| a.distance_m.total_cmp(&b.distance_m)) else {
        return Finding::not_applicable("the recording is empty");
    };
    let Some(found) = held(marks.iter().copied(), for_s, (LEAD_MPS * for_s).max(0.5)) else {
        return Finding::never(-1.0, vec![], format!("{what}: the robot does not go for so long"));
    };
    let longest = longest_s(marks);
    if let Some(from) = found.first_s {
        let text = format!("{what}: from {from:.1} s, margin {:.2}", found.margin);
        return Finding::holds(found.margin, vec![from, from + for_s], text).scaled(0.3).shifted(longest - for_s);
    }
    if nearest.distance_m > PARALLEL_M {
        let text = format!("{what}: never near, closest {:.1} m at {:.1} s", nearest.distance_m, nearest.t);
        return Finding::never(found.margin, vec![nearest.t], text);
    }
    let text = format!("{what}: longest {longest:.1} s");
    Finding::fails(found.margin, vec![found.best_s], text).scaled(0.3).shifted(longest - for_s)
}
