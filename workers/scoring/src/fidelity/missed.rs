//! What was true instead, where a trigger never came: which of several never held, and what the run had of it.

use socrates_model::rule::{RobotDo, RobotWhen};
use socrates_model::{Gesture, HumanId, Trigger};

use crate::fidelity::signals::{MOMENT_SECS, Moment, Signals};
use crate::tracks::MOVING_MPS;

/// The sentence about a trigger that never held for a human: what the run had instead.
pub(super) fn told(signals: &Signals<'_>, human: HumanId, trigger: &Trigger) -> String {
    let moments = signals.of(human);
    let nearest_m = signals.nearest_m(human);
    match trigger {
        Trigger::RobotSays(gesture) => format!("the robot never says {gesture}: {}", unsaid(signals, *gesture)),
        Trigger::HumanSays(other, gesture) => format!("{other} never says {gesture}"),
        Trigger::RobotNear(_) => format!("the robot comes no nearer than {nearest_m:.1} m"),
        Trigger::RobotVisible(m) => {
            let seen = moments.iter().filter(|moment| moment.sight.unwrap_or(true)).map(|moment| moment.distance_m);
            let within = least(seen);
            if within.is_finite() && within > *m {
                format!("the robot is seen from {within:.1} m at the nearest")
            } else {
                format!("the robot, {nearest_m:.1} m away at the nearest, is never before their eyes within {m} m")
            }
        }
        Trigger::RobotBlocking(m) => {
            format!("the robot, {nearest_m:.1} m away at the nearest, never stands in their way within {m} m")
        }
        Trigger::RobotMoving => "the robot does not move".to_owned(),
        Trigger::RobotStopped => "the robot never stands still after it has set off".to_owned(),
        Trigger::StoppedFor(s) => {
            format!(
                "the robot stands for {:.1} s at the longest, not for {s} s",
                longest(moments, |moment| { moment.t >= signals.moves_s && moment.robot.speed() < MOVING_MPS })
            )
        }
        Trigger::RobotPassed => format!("the robot, {nearest_m:.1} m away at the nearest, does not pass them"),
        Trigger::GoalReached => "they do not come to the end of their way".to_owned(),
        Trigger::AtEncounter => "they do not come to where they meet the robot".to_owned(),
        Trigger::AfterSecs(s) => {
            let end_s = moments.last().map_or(0.0, |moment| moment.t);
            format!("the run ends at {end_s:.0} s, before {s} s")
        }
        Trigger::Did(other, step) => format!("step {step} of {other} does not end"),
        Trigger::Done(other) => format!("{other} does not end all steps"),
        Trigger::Always => "nobody is there".to_owned(),
    }
}

/// Why the robot does not make a gesture: what its script waits for, and what came of that.
fn unsaid(signals: &Signals<'_>, gesture: Gesture) -> String {
    let script = signals.evidence.proposal.map_or(&[][..], |proposal| &proposal.robot.script);
    let lines: Vec<String> = script
        .iter()
        .filter(|line| line.act == RobotDo::Say(gesture))
        .map(|line| format!("{} ({})", line.when.phrase(), instead(signals, &line.when)))
        .collect();
    if lines.is_empty() {
        "its script has no such line".to_owned()
    } else {
        format!("it says so {}", lines.join(", or "))
    }
}

/// What the run had of a moment of the robot's script.
fn instead(signals: &Signals<'_>, when: &RobotWhen) -> String {
    let all = || signals.moments.values();
    match when {
        RobotWhen::Blocked(_) => {
            let blocked = |moment: &Moment| {
                let bearing = libm::atan2(moment.left_m, moment.ahead_m);
                RobotWhen::is_blocked_by(moment.distance_m, bearing)
            };
            let longest_s = all().map(|moments| longest(moments, blocked)).fold(0.0, f64::max);
            format!("{longest_s:.1} s at the longest: where it finds room beside somebody it passes")
        }
        RobotWhen::HumanNear(_) | RobotWhen::Near(..) => {
            let nearest_m = least(signals.moments.keys().map(|human| signals.nearest_m(*human)));
            format!("{nearest_m:.1} m at the nearest")
        }
        RobotWhen::HumanSays(gesture) => format!("nobody says {gesture} within 10 m"),
        RobotWhen::AtEncounter(human) => format!("it does not come to where it meets {human}"),
        RobotWhen::Did(human, step) => format!("step {step} of {human} does not end"),
        RobotWhen::Done(human) => format!("{human} does not end all steps"),
        RobotWhen::AfterLine(number) => format!("line {number} of its script is not over before the run is"),
        RobotWhen::Start | RobotWhen::AfterSecs(_) => "the run ends before".to_owned(),
    }
}

fn least(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(f64::INFINITY, f64::min)
}

/// The longest time for which something holds without a break, s.
fn longest(moments: &[Moment], holds: impl Fn(&Moment) -> bool) -> f64 {
    let (mut run_s, mut longest_s) = (0.0, 0.0_f64);
    for moment in moments {
        run_s = if holds(moment) { run_s + MOMENT_SECS } else { 0.0 };
        longest_s = longest_s.max(run_s);
    }
    longest_s
}
