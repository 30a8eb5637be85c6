//! Monitors of groups: standing formation, walking together.

use std::f64::consts::FRAC_PI_4;

use socrates_model::{GroupId, Point};

use crate::fidelity::finding::Finding;
use crate::fidelity::signals::Signals;
use crate::tracks::{Sample, Track};

/// A standing group is judged until the robot is this near to one of its members, m.
const NEAR_M: f64 = 3.0;
/// People settle into their places in the first moments, s.
const SETTLE_SECS: f64 = 0.5;
/// Somebody of a standing group who is faster than this walks, m/s.
const STANDING_MPS: f64 = 0.25;
/// Share of member-time that must face the centre (`spec/case_studies` G.S1), and of time together (clause text).
const SHARE: f64 = 0.8;
/// A formation may be broken for this share of the time before it is not one.
const BROKEN_SHARE: f64 = 0.05;

/// A group at one time.
struct Together {
    t: f64,
    center: Point,
    spread_m: f64,
    fastest_mps: f64,
    facing: usize,
    robot_m: f64,
}

fn over_time(signals: &Signals<'_>, group: GroupId) -> Result<(Vec<Together>, usize), Finding> {
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
        let sum: socrates_model::Vector = now.iter().map(|sample| sample.at - first.at).sum();
        let center = first.at + sum / count;
        let spread_m = now.iter().map(|sample| (sample.at - center).norm()).fold(0.0, f64::max);
        let robot_m = robot.get(index).copied().flatten().map_or(f64::INFINITY, |r| {
            now.iter().map(|sample| (sample.at - r.at).norm()).fold(f64::INFINITY, f64::min)
        });
        found.push(Together {
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
        "{group}: spread {worst:.2} m (at most {spread_m:.1} m), {:.0} % facing its centre, until the robot is near at {:.1} s",
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
        "{group}: within {spread_m:.1} m of its centre for {:.0} % of the {:.1} s before the encounter, {way:.1} m walked",
        together * 100.0,
        nearest.t
    );
    if way < 1.0 {
        return Ok(Finding::fails((way - 1.0).min(together - SHARE), vec![nearest.t], text));
    }
    Ok(Finding::by_margin(together - SHARE, vec![nearest.t], text).scaled(0.2))
}
