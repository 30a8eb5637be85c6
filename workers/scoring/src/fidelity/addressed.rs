//! Gestures that are made to somebody: facing them, and the robot does not stop by those that are made to others.

use socrates_model::geometry::wrap_angle;
use socrates_model::rule::RobotWhen;
use socrates_model::{AgentId, EventKind, Gesture, HumanId, Rule};

use crate::fidelity::finding::Finding;
use crate::fidelity::signals::{MOMENT_SECS, Signals};
use crate::fidelity::windows::Mark;
use crate::tracks::{MOVING_MPS, Sample};

/// Somebody faces whoever is within this of their heading, rad (20°).
const FACES_RAD: f64 = 0.349_065_850_398_866;
/// Farther away than this nobody notices a gesture, m.
const REACH_M: f64 = Gesture::SEEN_M;
/// Share of the time of a gesture for which it is made facing whomever it is for.
const SHARE: f64 = 0.6;
/// It takes so long to turn, s: that time does not count where the gesture lasts longer.
const TURN_SECS: f64 = 0.7;
/// A robot that stops within this after a gesture stops by it, s.
const STOPS_SECS: f64 = 2.0;

/// How far somebody faces another agent at a time: 1 straight at them, 0 at the limit.
fn faces(me: &Sample, other: &Sample) -> f64 {
    let way = other.at - me.at;
    let off = wrap_angle(libm::atan2(way.y, way.x) - me.yaw).abs();
    (FACES_RAD - off) / FACES_RAD
}

/// How far somebody stands and faces another agent, moment by moment.
pub(super) fn watch_marks(signals: &Signals<'_>, human: HumanId, other: AgentId) -> Vec<Mark> {
    let (Some(own), Some(other)) = (signals.tracks.human(human), signals.track(other)) else { return Vec::new() };
    let mark = |me: &Sample| {
        let still = (MOVING_MPS - me.speed()) / MOVING_MPS;
        let facing = other.at(me.t).map_or(-1.0, |other| faces(me, &other));
        Mark::new(me.t, still.min(facing))
    };
    own.present().map(mark).collect()
}

/// A gesture is made to somebody.
pub(super) fn gestures_to(signals: &Signals<'_>, human: HumanId, gesture: Gesture, to: AgentId) -> Finding {
    let (Some(own), Some(other)) = (signals.tracks.human(human), signals.track(to)) else {
        return Finding::fails(-1.0, vec![], format!("{human} or {to} is not in the recording"));
    };
    let begins: Vec<(f64, Option<AgentId>)> = signals
        .evidence
        .recording
        .events
        .iter()
        .filter_map(|event| {
            if let EventKind::Gesture { agent, gesture: Some(made), to } = &event.kind
                && (*agent, *made) == (human.into(), gesture)
            {
                Some((event.time.secs(), *to))
            } else {
                None
            }
        })
        .collect();
    if begins.is_empty() {
        return Finding::never(-1.0, vec![], format!("{human} never says {gesture}"));
    }
    let Some((begun_s, _)) = begins.iter().copied().find(|(_, told)| *told == Some(to)) else {
        let (t, _) = begins.first().copied().unwrap_or_default();
        return Finding::fails(-1.0, vec![t], format!("{human} says {gesture} at {t:.1} s, but not to {to}"));
    };
    let during: Vec<&Sample> = own
        .present()
        .filter(|sample| sample.t >= begun_s - MOMENT_SECS)
        .skip_while(|sample| sample.gesture != Some(gesture) && sample.t < begun_s + 2.0 * MOMENT_SECS)
        .take_while(|sample| sample.gesture == Some(gesture))
        .collect();
    let ends_s = during.last().map_or(begun_s, |sample| sample.t);
    let from_s = if ends_s - begun_s > 2.0 * TURN_SECS { begun_s + TURN_SECS } else { begun_s };
    let counted: Vec<&&Sample> = during.iter().filter(|sample| sample.t >= from_s).collect();
    // A person who makes a sign while walking looks ahead.
    let rules = signals.evidence.proposal.and_then(|proposal| proposal.human(human)).map_or(&[][..], |one| &one.rules);
    let goes = |rule: &Rule| rule.gesture == Some(gesture) && rule.to == Some(to) && !rule.act.stands();
    let goes = rules.iter().any(goes);
    let walking = |me: &Sample| goes || me.speed() > MOVING_MPS;
    let facing =
        counted.iter().filter(|me| walking(me) || other.at(me.t).is_some_and(|other| faces(me, &other) >= 0.0)).count();
    let share = facing as f64 / counted.len().max(1) as f64;
    let nearest =
        during.iter().filter_map(|me| Some((other.at(me.t)?.at - me.at).norm())).fold(f64::INFINITY, f64::min);
    let text = format!(
        "{human} says {gesture} to {to} at {begun_s:.1} s, {nearest:.1} m away (at most {REACH_M:.0} m), facing them for {:.0} % of \
         the time (at least {:.0} %)",
        share * 100.0,
        SHARE * 100.0
    );
    if nearest > REACH_M || share < SHARE {
        return Finding::fails((share - SHARE).min((REACH_M - nearest) / REACH_M), vec![begun_s], text);
    }
    if let Some(t) = stops_by_it(signals, to, begun_s) {
        return Finding::fails(-1.0, vec![begun_s, t], format!("{text}, but the robot stops by it at {t:.1} s"));
    }
    Finding::holds(share - SHARE, vec![begun_s], text)
}

/// When the robot comes to a stand after a gesture that is made to somebody else, with nobody in its way.
fn stops_by_it(signals: &Signals<'_>, to: AgentId, begun_s: f64) -> Option<f64> {
    let robot = signals.tracks.robot.as_ref().filter(|_| to != AgentId::Robot)?;
    let moved = robot.at(begun_s).is_some_and(|sample| sample.speed() > MOVING_MPS);
    let window = || robot.present().filter(|sample| sample.t >= begun_s && sample.t <= begun_s + STOPS_SECS);
    let stop = window().find(|sample| sample.speed() <= MOVING_MPS).filter(|_| moved)?;
    let stays = window().filter(|sample| sample.t >= stop.t).all(|sample| sample.speed() <= MOVING_MPS);
    let arrived = signals.arrived_s.is_some_and(|t| t <= stop.t + 1.0);
    let blocked = signals.tracks.humans.iter().filter_map(|track| track.at(stop.t)).any(|person| {
        let way = person.at - stop.at;
        let bearing = wrap_angle(libm::atan2(way.y, way.x) - stop.yaw);
        RobotWhen::is_blocked_by(way.norm(), bearing)
    });
    (stays && !arrived && !blocked).then_some(stop.t)
}
