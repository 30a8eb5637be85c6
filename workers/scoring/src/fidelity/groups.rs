//! Monitors of groups: standing formation, walking together, queue.

use std::f64::consts::FRAC_PI_4;

use socrates_model::{GroupId, Point, Vector};

use crate::circle::STANDING_MPS;
use crate::fidelity::finding::Finding;
use crate::fidelity::signals::Signals;
use crate::tracks::{Sample, Track};

/// A standing group is judged until the robot is this near to one of its members, m.
const NEAR_M: f64 = 3.0;
/// People settle into their places in the first moments, s.
const SETTLE_SECS: f64 = 0.5;
/// Share of member-time that must face the center of a group that talks (the o-space of Kendon's F-formations), and share
/// of the time in which a group must be together.
const SHARE: f64 = 0.8;
/// Somebody farther from the line of a queue does not stand in it, m.
const OFF_LINE_M: f64 = 0.6;
/// A queue may bend: from end to end it is at least this share of the way from neighbor to neighbor.
const STRAIGHT_SHARE: f64 = 0.7;
/// A formation may be broken for this share of the time before it is not one.
const BROKEN_SHARE: f64 = 0.05;

/// A group at one time.
struct Together {
    index: usize,
    t: f64,
    center: Point,
    spread_m: f64,
    fastest_mps: f64,
    facing: usize,
    robot_m: f64,
}

/// The tracks of a group's members, or why there are none.
pub(super) fn members<'s>(signals: &'s Signals<'_>, group: GroupId) -> Result<Vec<&'s Track>, Finding> {
    let Some(proposal) = signals.evidence.proposal else {
        return Err(Finding::not_applicable("there is no proposal that names the group's members"));
    };
    let Some(members) = proposal.groups.iter().find(|found| found.id == group).map(|found| &found.members) else {
        return Err(Finding::fails(-1.0, vec![], format!("the proposal has no {group}")));
    };
    let tracks: Vec<&Track> = members.iter().filter_map(|id| signals.tracks.human(*id)).collect();
    if tracks.len() != members.len() || tracks.len() < 2 {
        let text = format!("{group} has {} members, {} are in the recording", members.len(), tracks.len());
        return Err(Finding::fails(-1.0, vec![], text));
    }
    Ok(tracks)
}

fn over_time(signals: &Signals<'_>, group: GroupId) -> Result<(Vec<Together>, usize), Finding> {
    let tracks = members(signals, group)?;
    #[expect(clippy::cast_precision_loss, reason = "a group has few members")]
    let count = tracks.len() as f64;
    let mut columns: Vec<_> = tracks.iter().map(|track| track.samples.iter()).collect();
    let robot: Vec<Option<Sample>> = match &signals.tracks.robot {
        Some(robot) => robot.samples.iter().copied().map(Some).collect(),
        None => Vec::new(),
    };
    let mut found = Vec::new();
    let mut index = 0;
    loop {
        let now: Vec<&Sample> = columns.iter_mut().filter_map(Iterator::next).collect();
        let Some(first) = now.first().filter(|_| now.len() == tracks.len()) else { break };
        if now.iter().any(|sample| !sample.there) {
            index += 1;
            continue;
        }
        let sum: Vector = now.iter().map(|sample| sample.at - first.at).sum();
        let center = first.at + sum / count;
        let spread_m = now.iter().map(|sample| (sample.at - center).norm()).fold(0.0, f64::max);
        let robot_m = robot.get(index).copied().flatten().map_or(f64::INFINITY, |r| {
            now.iter().map(|sample| (sample.at - r.at).norm()).fold(f64::INFINITY, f64::min)
        });
        found.push(Together {
            index,
            t: first.t,
            center,
            spread_m,
            fastest_mps: now.iter().map(|sample| sample.speed()).fold(0.0, f64::max),
            facing: now.iter().filter(|sample| sample.bearing(&center).abs() <= FRAC_PI_4).count(),
            robot_m,
        });
        index += 1;
    }
    Ok((found, tracks.len()))
}

#[expect(clippy::cast_precision_loss, reason = "moments of a run are far below 2^53")]
fn share(part: usize, whole: usize) -> f64 {
    if whole == 0 { 0.0 } else { part as f64 / whole as f64 }
}

/// The group stands in formation until the robot is near.
pub(super) fn formation(signals: &Signals<'_>, group: GroupId, spread_m: f64) -> Result<Finding, Finding> {
    let (moments, members) = over_time(signals, group)?;
    let Some(arrival) = moments.iter().find(|moment| moment.robot_m <= NEAR_M) else {
        let near = moments.iter().min_by(|a, b| a.robot_m.total_cmp(&b.robot_m));
        let text = near.map_or_else(String::new, |m| format!(": nearest {:.1} m at {:.1} s", m.robot_m, m.t));
        return Ok(Finding::never(
            -1.0,
            vec![],
            format!("the robot never comes within {NEAR_M:.0} m of {group}{text}"),
        ));
    };
    let before: Vec<&Together> =
        moments.iter().filter(|m| m.t >= SETTLE_SECS.min(arrival.t) && m.t <= arrival.t).collect();
    let worst = before.iter().map(|m| m.spread_m).fold(0.0, f64::max);
    let broken: Vec<f64> =
        before.iter().filter(|m| m.spread_m > spread_m || m.fastest_mps > STANDING_MPS).map(|m| m.t).collect();
    let facing = share(before.iter().map(|m| m.facing).sum(), before.len() * members);
    let text = format!(
        "{group}: spread {worst:.2} m (at most {spread_m:.1} m), {:.0} % facing its center, until the robot is near at {:.1} s",
        facing * 100.0,
        arrival.t
    );
    let kept = BROKEN_SHARE - share(broken.len(), before.len());
    if kept < 0.0 {
        let since = broken.first().copied().unwrap_or(0.0);
        let text = format!("{text}; broken from {since:.1} s for {:.0} % of the time", (BROKEN_SHARE - kept) * 100.0);
        return Ok(Finding::fails((spread_m - worst).min(kept), vec![since], text));
    }
    Ok(Finding::by_margin((facing - SHARE).min((spread_m - worst).max(0.0)), vec![arrival.t], text).scaled(0.3))
}

/// The group walks together until it meets the robot.
pub(super) fn walks_together(signals: &Signals<'_>, group: GroupId, spread_m: f64) -> Result<Finding, Finding> {
    let (moments, _) = over_time(signals, group)?;
    let Some(nearest) = moments.iter().filter(|m| m.robot_m.is_finite()).min_by(|a, b| a.robot_m.total_cmp(&b.robot_m))
    else {
        return Err(Finding::not_applicable("there is no robot in the recording"));
    };
    let before: Vec<&Together> = moments.iter().filter(|m| m.t <= nearest.t).collect();
    let way: f64 = before.iter().zip(before.iter().skip(1)).map(|(a, b)| (b.center - a.center).norm()).sum();
    let near = before.iter().filter(|m| m.spread_m <= spread_m).count();
    let together = share(near, before.len());
    let text = format!(
        "{group}: within {spread_m:.1} m of its center for {:.0} % of the {:.1} s before the encounter, {way:.1} m walked",
        together * 100.0,
        nearest.t
    );
    if way < 1.0 {
        return Ok(Finding::fails((way - 1.0).min(together - SHARE), vec![nearest.t], text));
    }
    Ok(Finding::by_margin(together - SHARE, vec![nearest.t], text).scaled(0.2))
}

/// How well the members stand in a line at one time: margin, smallest and largest gap, all in m.
fn line_up(now: &[&Sample], [low, high]: [f64; 2]) -> Option<(f64, f64, f64)> {
    let first = now.first()?;
    #[expect(clippy::cast_precision_loss, reason = "a group has few members")]
    let count = now.len() as f64;
    let sum: Vector = now.iter().map(|sample| sample.at - first.at).sum();
    let middle = first.at + sum / count;
    // The line of least squares: half the angle of the second moments.
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for sample in now {
        let p = sample.at - middle;
        xx += p.x * p.x;
        xy += p.x * p.y;
        yy += p.y * p.y;
    }
    let angle = libm::atan2(2.0 * xy, xx - yy) / 2.0;
    let line = Vector::new(libm::cos(angle), libm::sin(angle));
    let off = now.iter().map(|sample| line.perp(&(sample.at - middle)).abs()).fold(0.0, f64::max);
    let mut order: Vec<(f64, Point)> = now.iter().map(|s| (line.dot(&(s.at - middle)), s.at)).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0));
    let gaps: Vec<f64> = order.iter().zip(order.iter().skip(1)).map(|((_, a), (_, b))| (b - a).norm()).collect();
    let least = gaps.iter().copied().min_by(f64::total_cmp)?;
    let most = gaps.iter().copied().max_by(f64::total_cmp)?;
    let length = order.first().zip(order.last()).map_or(0.0, |((_, a), (_, b))| (b - a).norm());
    let straight = length / gaps.iter().sum::<f64>().max(1e-9) - STRAIGHT_SHARE;
    let standing = now.iter().map(|sample| STANDING_MPS - sample.speed()).fold(f64::INFINITY, f64::min);
    Some(((least - low).min(high - most).min(OFF_LINE_M - off).min(straight).min(standing), least, most))
}

/// The group stands in a line until the robot is near.
pub(super) fn queues(signals: &Signals<'_>, group: GroupId, gap_m: [f64; 2]) -> Result<Finding, Finding> {
    let tracks = members(signals, group)?;
    let (moments, _) = over_time(signals, group)?;
    let Some(arrival) = moments.iter().find(|moment| moment.robot_m <= NEAR_M) else {
        let near = moments.iter().map(|moment| moment.robot_m).fold(f64::INFINITY, f64::min);
        let text = format!("the robot never comes within {NEAR_M:.0} m of {group}: nearest {near:.1} m");
        return Ok(Finding::never(-1.0, vec![], text));
    };
    let mut before: Vec<(f64, f64, f64, f64)> = Vec::new();
    for moment in moments.iter().filter(|m| m.t <= arrival.t) {
        let now: Vec<&Sample> = tracks.iter().filter_map(|track| track.samples.get(moment.index)).collect();
        if moment.t < SETTLE_SECS.min(arrival.t) {
            continue;
        }
        before.extend(line_up(&now, gap_m).map(|(margin, least, most)| (margin, moment.t, least, most)));
    }
    let broken = before.iter().filter(|(margin, ..)| *margin < 0.0).count();
    let kept = BROKEN_SHARE - share(broken, before.len());
    let least = before.iter().map(|found| found.2).fold(f64::INFINITY, f64::min);
    let most = before.iter().map(|found| found.3).fold(0.0, f64::max);
    let [low, high] = gap_m;
    let text = format!(
        "{group} in a line, gaps {least:.2} to {most:.2} m ({low:.1} to {high:.1} m asked), until the robot is near at {:.1} s",
        arrival.t
    );
    let worst = before.iter().min_by(|a, b| a.0.total_cmp(&b.0));
    Ok(match worst {
        None => Finding::not_applicable("the recording is empty"),
        Some((margin, t, ..)) if kept < 0.0 => Finding::fails(
            margin.min(kept),
            vec![*t],
            format!("{text}; no line for {:.0} % of the time, worst at {t:.1} s", (BROKEN_SHARE - kept) * 100.0),
        )
        .scaled(0.3),
        Some((margin, ..)) => Finding::holds(margin.max(0.0), vec![arrival.t], text).scaled(0.3),
    })
}
