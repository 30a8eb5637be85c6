//! Monitors of the robot and a standing group: joins it, leaves it.

use socrates_model::GroupId;

use crate::circle::Circle;
use crate::fidelity::finding::Finding;
use crate::fidelity::groups::members;
use crate::fidelity::signals::Signals;
use crate::tracks::{MOVING_MPS, Sample, Track};

/// Two who stand farther apart than this are not of one group, m.
const APART_M: f64 = 6.0;
/// A disc that touches the o-space by this much only is still outside, m.
const TOUCH_M: f64 = 0.05;

/// The group's circle with the robot at one sample.
struct Beside {
    t: f64,
    circle: Circle,
    robot: Sample,
}

/// Every moment at which the whole group stands, with the robot's radius.
fn beside(signals: &Signals<'_>, group: GroupId) -> Result<(Vec<Beside>, f64), Finding> {
    let Some(robot) = &signals.tracks.robot else {
        return Err(Finding::not_applicable("there is no robot in the recording"));
    };
    let tracks: Vec<&Track> = members(signals, group)?;
    let radius_m = tracks.first().map_or(0.0, |track| track.radius_m);
    let moments = robot.samples.iter().enumerate().filter_map(|(index, sample)| {
        let now: Vec<&Sample> =
            tracks.iter().filter_map(|track| track.samples.get(index)).filter(|s| s.there).collect();
        // Somebody who stands somewhere else does not stand in the group.
        let apart = |one: &&Sample| now.iter().all(|other| (one.at - other.at).norm() <= APART_M);
        let circle = now.iter().all(apart).then(|| Circle::of(&now, radius_m)).flatten()?;
        Some(Beside { t: sample.t, circle, robot: *sample })
    });
    Ok((moments.collect(), robot.radius_m))
}

/// The robot ends in the group's p-space and never more than touches its o-space at the end.
pub(super) fn robot_joins(signals: &Signals<'_>, group: GroupId) -> Result<Finding, Finding> {
    let (moments, radius_m) = beside(signals, group)?;
    let end_s = signals.tracks.end_s();
    let Some(last) = moments.last().filter(|moment| end_s - moment.t < 1.0) else {
        return Ok(Finding::never(
            -1.0,
            vec![end_s],
            format!("{group} does not stand when the run ends at {end_s:.1} s"),
        ));
    };
    let (o, p) = (last.circle.outside_o(&last.robot.at, radius_m), last.circle.outside_p(&last.robot.at, radius_m));
    let stands = MOVING_MPS - last.robot.speed();
    let first = moments.iter().find(|moment| moment.circle.outside_p(&moment.robot.at, radius_m) <= 0.0);
    let text = format!(
        "at {:.1} s the robot is {:.2} m {} the o-space of {group} and {:.2} m {} its p-space",
        last.t,
        o.abs(),
        if o < 0.0 { "inside" } else { "outside" },
        p.abs(),
        if p > 0.0 { "outside" } else { "inside" }
    );
    Ok(Finding::by_margin((o + TOUCH_M).min(-p).min(stands), vec![first.map_or(last.t, |found| found.t)], text))
}

/// The robot starts in the group's r-space or nearer and ends outside it.
pub(super) fn robot_leaves(signals: &Signals<'_>, group: GroupId) -> Result<Finding, Finding> {
    let (moments, radius_m) = beside(signals, group)?;
    let (Some(first), Some(last)) = (moments.first(), moments.last()) else {
        return Ok(Finding::never(-1.0, vec![], format!("{group} never stands")));
    };
    let start = first.circle.outside_r(&first.robot.at, radius_m);
    if start > 0.0 || first.t > 1.0 {
        let text = format!("the robot starts {start:.2} m outside the space about {group} (at {:.1} s)", first.t);
        return Ok(Finding::never(-start.max(0.01), vec![first.t], text));
    }
    // Who walks off after the robot has gone does not change that it left: the last circle stays where it was.
    let end = signals.tracks.robot.as_ref().and_then(|robot| robot.samples.last()).map_or(last.robot, |sample| *sample);
    let gone = last.circle.outside_r(&end.at, radius_m);
    let out = moments.iter().find(|moment| moment.circle.outside_r(&moment.robot.at, radius_m) > 0.0);
    let text = format!("the robot ends {gone:.2} m outside the space about {group} at {:.1} s", end.t);
    Ok(Finding::by_margin(gone, vec![out.map_or(end.t, |found| found.t)], text))
}
