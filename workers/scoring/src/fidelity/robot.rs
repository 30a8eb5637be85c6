//! Monitors of what the robot does: arrives, keeps away, obeys.

use socrates_model::rule::{RobotDo, RobotRule, RobotWhen};
use socrates_model::{AgentId, EventKind, Gesture, Point};

use crate::fidelity::acts::timely;
use crate::fidelity::finding::Finding;
use crate::fidelity::signals::Signals;
use crate::temporal::{Signal, Within};
use crate::tracks::{MOVING_MPS, Track};

/// The robot is at its goal from this near, m.
pub const GOAL_M: f64 = 0.5;

/// A robot that says it has arrived is at most this far from its goal, m: it may wait short of it where somebody stands there.
pub(super) const ARRIVED_M: f64 = 1.5;
/// A robot that has stood for longer than this before a gesture does not stop because of it, s.
pub(super) const MOVED_SECS: f64 = 5.0;
/// A robot that was told to wait has set off where it has gone farther than this since it stood, m.
pub(super) const CREEPS_M: f64 = 0.5;

/// The robot's goal: the last node of its path.
pub fn goal(signals: &Signals<'_>) -> Option<Point> {
    signals.evidence.paths?.robot.last().and_then(|id| signals.node(id))
}

/// The robot gets to its goal.
pub(super) fn arrives(signals: &Signals<'_>) -> Finding {
    let Some(robot) = &signals.full.robot else {
        return Finding::not_applicable("there is no robot in the recording");
    };
    let Some(goal) = goal(signals) else {
        return match signals.arrived_s {
            Some(t) => Finding::holds(1.0, vec![t], format!("the robot arrives at {t:.1} s")),
            None => Finding::not_applicable("the robot's goal is not known"),
        };
    };
    // What the log tells counts where the robot is: at its goal, or waiting for room there.
    if let Some(t) = signals.arrived_s {
        let apart_m =
            robot.at(t).or_else(|| robot.samples.last().copied()).map_or(f64::INFINITY, |s| (s.at - goal).norm());
        if apart_m <= ARRIVED_M {
            return Finding::holds(1.0, vec![t], format!("the robot arrives at {t:.1} s"));
        }
        let text = format!("the log has the robot arrive at {t:.1} s, {apart_m:.1} m from its goal");
        return Finding::fails(ARRIVED_M - apart_m, vec![t], text);
    }
    // A robot that starts at its goal gets there when it comes back.
    let away = robot.samples.iter().position(|s| (s.at - goal).norm() > GOAL_M).unwrap_or(0);
    let came = robot.samples.get(away..).unwrap_or_default();
    let nearest = came.iter().map(|s| ((s.at - goal).norm(), s.t)).min_by(|a, b| a.0.total_cmp(&b.0));
    let (distance, t) = nearest.unwrap_or((f64::INFINITY, 0.0));
    let first = came.iter().find(|s| (s.at - goal).norm() <= GOAL_M).map_or(t, |s| s.t);
    let text = format!("the robot comes within {distance:.2} m of its goal at {t:.1} s (at most {GOAL_M} m)");
    Finding::by_margin(GOAL_M - distance, vec![first], text)
}

/// The robot keeps a surface distance from every human.
pub(super) fn keeps(signals: &Signals<'_>, min_m: f64) -> Finding {
    let Some(robot) = &signals.full.robot else {
        return Finding::not_applicable("there is no robot in the recording");
    };
    let end = signals.arrived_s.unwrap_or(f64::INFINITY);
    let mut least: Option<(f64, f64, AgentId)> = None;
    for human in &signals.full.humans {
        for (r, h) in robot.beside(human).filter(|(r, _)| r.t <= end) {
            let distance = (r.at - h.at).norm() - robot.radius_m - human.radius_m;
            if least.is_none_or(|(old, _, _)| distance < old) {
                least = Some((distance, r.t, human.agent));
            }
        }
    }
    match least {
        Some((distance, t, who)) => {
            let text =
                format!("smallest surface distance {distance:.2} m to {who} at {t:.1} s (at least {min_m:.2} m asked)");
            Finding::by_margin(distance - min_m, vec![t], text)
        }
        None => Finding::not_applicable("there is no human in the recording"),
    }
}

/// How long after the log tells of a gesture the states show it, s.
const SHOWN_SECS: f64 = 0.25;

/// Whether the states show a gesture that the log tells of.
pub(super) fn shows(signals: &Signals<'_>, agent: AgentId, gesture: Gesture, t: f64) -> bool {
    let samples = signals.full.of(agent).map_or(&[][..], |track| &track.samples);
    let from = samples.partition_point(|sample| sample.t < t - SHOWN_SECS);
    let mut near = samples.iter().skip(from).take_while(|sample| sample.t <= t + SHOWN_SECS);
    near.any(|sample| sample.gesture == Some(gesture))
}

/// When and by whom a gesture is made.
fn said(signals: &Signals<'_>, gesture: Gesture) -> Vec<(f64, AgentId)> {
    let by_event = signals.evidence.recording.events.iter().filter_map(|event| match &event.kind {
        EventKind::Gesture { agent: AgentId::Human(id), gesture: Some(made), .. } if *made == gesture => {
            let t = event.time.secs();
            shows(signals, AgentId::Human(*id), *made, t).then_some((t, AgentId::Human(*id)))
        }
        EventKind::Gesture { .. }
        | EventKind::Leaf { .. }
        | EventKind::StepEnded { .. }
        | EventKind::Sees { .. }
        | EventKind::Encounter { .. }
        | EventKind::Contact { .. }
        | EventKind::WallContact { .. }
        | EventKind::Door { .. }
        | EventKind::Node { .. }
        | EventKind::RobotArrived
        | EventKind::Stuck { .. }
        | EventKind::End { .. } => None,
    });
    let by_state = signals
        .tracks
        .humans
        .iter()
        .filter_map(|track| Some((track.samples.iter().find(|s| s.gesture == Some(gesture))?.t, track.agent)));
    by_event.chain(by_state).collect()
}

/// For how much of a time the robot stands because its script has it wait for whoever asks it to, s.
pub(super) fn held_on_request_s(signals: &Signals<'_>, from_s: f64, to_s: f64) -> f64 {
    let (Some(robot), Some(proposal)) = (&signals.tracks.robot, signals.evidence.proposal) else { return 0.0 };
    let hold = |line: &RobotRule| match (&line.when, &line.act) {
        (RobotWhen::HumanSays(gesture), RobotDo::Hold(secs)) => {
            // A line of the script is played once.
            let asked = said(signals, *gesture).into_iter().map(|(t, _)| t).min_by(f64::total_cmp)?;
            Some((asked.max(from_s), (asked + secs).min(to_s)))
        }
        (RobotWhen::HumanSays(gesture), RobotDo::HoldUntil(RobotWhen::HumanSays(goes))) => {
            let first = |gesture: Gesture, from: f64| {
                said(signals, gesture).into_iter().map(|(t, _)| t).filter(|t| *t >= from).min_by(f64::total_cmp)
            };
            let asked = first(*gesture, f64::NEG_INFINITY)?;
            let over = first(*goes, asked).unwrap_or(f64::INFINITY).min(asked + RobotDo::HOLD_MOST_S);
            Some((asked.max(from_s), over.min(to_s)))
        }
        _ => None,
    };
    let spans: Vec<(f64, f64)> = proposal.robot.script.iter().filter_map(hold).collect();
    let steps = robot.samples.iter().zip(robot.samples.iter().skip(1));
    let stands = steps.filter(|(now, next)| {
        now.speed() <= MOVING_MPS && spans.iter().any(|(from, to)| now.t >= *from && next.t <= *to)
    });
    stands.map(|(now, next)| next.t - now.t).sum()
}

/// When the robot was told to wait and when it drove on all the same, before it was told to go.
fn sets_off_sooner(signals: &Signals<'_>, robot: &Track, (gesture, made_s): (Gesture, f64)) -> Option<(f64, f64)> {
    let told_s =
        said(signals, Gesture::Wait).into_iter().map(|(t, _)| t).filter(|t| *t < made_s).max_by(f64::total_cmp);
    let told_s = told_s.filter(|_| gesture == Gesture::Proceed)?;
    let between = || robot.samples.iter().filter(|sample| sample.t >= told_s && sample.t <= made_s);
    let stands_s = between().find(|sample| sample.speed() <= MOVING_MPS)?.t;
    let mut went_m = 0.0;
    let steps = between().zip(between().skip(1)).filter(|(now, _)| now.t >= stands_s);
    let mut steps = steps.map(|(now, next)| {
        went_m += (next.at - now.at).norm();
        (next.t, went_m)
    });
    steps.find(|(_, went_m)| *went_m > CREEPS_M).map(|(t, _)| (told_s, t))
}

/// The robot does what the gesture asks in time: it goes for PROCEED and `FOLLOW_ME`, else it stops.
pub(super) fn obeys(signals: &Signals<'_>, gesture: Gesture, within_s: f64) -> Finding {
    let Some(robot) = &signals.tracks.robot else {
        return Finding::not_applicable("there is no robot in the recording");
    };
    let all = said(signals, gesture);
    let Some((made, who)) = all.iter().copied().min_by(|a, b| a.0.total_cmp(&b.0)) else {
        return Finding::never(-within_s, vec![], format!("nobody says {gesture} to the robot"));
    };
    let goes = matches!(gesture, Gesture::Proceed | Gesture::FollowMe);
    let moved = |t: f64| {
        let mut before = robot.samples.iter().filter(|s| s.t >= t - MOVED_SECS && s.t <= t);
        before.any(|s| s.speed() > MOVING_MPS)
    };
    if !goes && !all.iter().any(|(t, _)| moved(*t)) {
        let text =
            format!("{who} says {gesture} at {made:.1} s to a robot that has stood for {MOVED_SECS:.0} s and more");
        return Finding::never(-within_s, vec![made], text);
    }
    if let Some((told_s, t)) = sets_off_sooner(signals, robot, (gesture, made)) {
        let text = format!(
            "the robot is told to wait at {told_s:.1} s and sets off at {t:.1} s, before {who} says {gesture} at {made:.1} s"
        );
        return Finding::fails(t - made, vec![t, made], text);
    }
    let done = robot.samples.iter().find(|s| s.t >= made && (s.speed() > MOVING_MPS) == goes);
    let verb = if goes { "goes" } else { "stops" };
    // Whenever it is said, it is done in time: G (said -> F[0, within] done).
    let said: Signal = robot
        .samples
        .iter()
        .zip(robot.samples.iter().skip(1))
        .map(|(before, now)| {
            let begins = all.iter().any(|(t, _)| *t > before.t && *t <= now.t);
            (now.t, if begins { 1.0 } else { -1.0 })
        })
        .collect();
    let does: Signal = robot
        .samples
        .iter()
        .skip(1)
        .map(|sample| {
            let margin = sample.speed() - MOVING_MPS;
            (sample.t, if goes { margin } else { -margin })
        })
        .collect();
    let answered = said.not().or(&does.eventually(Within::secs(within_s)));
    let every_time = answered.always(Within::EVER).holds();
    match done {
        Some(sample) if every_time == Some(false) && sample.t - made <= within_s => {
            let missed = answered.not().first_s().unwrap_or(made);
            let text = format!(
                "the robot {verb} {:.1} s after {who} says {gesture} at {made:.1} s, but not when it is said at {missed:.1} s",
                sample.t - made
            );
            Finding::fails(-within_s, vec![missed, made], text)
        }
        Some(sample) => {
            let delay = sample.t - made;
            let text = format!(
                "{who} says {gesture} at {made:.1} s; the robot {verb} {delay:.1} s later (at most {within_s:.1} s)"
            );
            timely(delay, within_s, vec![sample.t, made], text)
        }
        None => Finding::fails(
            -within_s,
            vec![made],
            format!("{who} says {gesture} at {made:.1} s; the robot never {verb}"),
        ),
    }
}
