//! The monitor of reactions: a trigger, then an action in time, and not before.

use std::f64::consts::PI;

use socrates_model::{Action, AgentId, Gesture, HumanId, Rule, Trigger};

use crate::fidelity::acts::{spans, timely};
use crate::fidelity::finding::{Finding, Missed};
use crate::fidelity::kept::kept;
use crate::fidelity::meeting::absent;
use crate::fidelity::missed;
use crate::fidelity::signals::{Moment, Signals};
use crate::fidelity::steps;
use crate::fidelity::windows::{Mark, best, first};
use crate::tracks::MOVING_MPS;

/// Half of a human's field of view, rad (100°).
const HALF_VIEW_RAD: f64 = 100.0 / 180.0 * PI;
/// A robot within this angle of where somebody goes is in its way, rad.
const IN_WAY_RAD: f64 = 0.5;
/// Somebody this near to the node is at the encounter, or at its goal, m.
const AT_ENCOUNTER_M: f64 = 1.0;
const AT_GOAL_M: f64 = 0.6;
/// How much farther than its stated distance a trigger may be and still not be early, m.
pub(super) const EARLY_M: f64 = 0.3;
/// How much sooner than its trigger an action may start, s: a tree reads the tick before.
pub(super) const EARLY_SECS: f64 = 0.3;
/// How much sooner than after what comes before it a gesture may be made, s.
const TOO_EARLY_SECS: f64 = 1.5;

/// How far all triggers hold at a moment, at which the robot has been so near at its nearest; distances are widened by `slack_m`.
fn trigger_mark(
    signals: &Signals<'_>,
    human: HumanId,
    when: &[Trigger],
    (moment, nearest_m): (&Moment, f64),
    slack_m: f64,
) -> Mark {
    let flag = |yes: bool| if yes { 1.0 } else { -1.0 };
    let one = |trigger: &Trigger| -> f64 {
        match trigger {
            Trigger::Always => 1.0,
            Trigger::RobotVisible(m) => (m + slack_m - moment.distance_m)
                .min(HALF_VIEW_RAD + slack_m - moment.human.bearing(&moment.robot.at).abs())
                .min(flag(moment.sight.unwrap_or(true))),
            Trigger::RobotNear(m) => m + slack_m - moment.distance_m,
            Trigger::RobotBlocking(m) => {
                let away = -moment.away();
                let by_course = moment.human.course().dot(&away);
                let off = libm::acos(by_course.max(moment.human.facing().dot(&away)).clamp(-1.0, 1.0));
                (m + slack_m - moment.distance_m)
                    .min(IN_WAY_RAD + slack_m - off)
                    .min(flag(moment.sight.unwrap_or(true)))
            }
            Trigger::RobotMoving => moment.robot.speed() - MOVING_MPS,
            // A robot that has not set off yet has not stopped.
            Trigger::RobotStopped if moment.t < signals.moves_s => -MOVING_MPS,
            Trigger::RobotStopped => MOVING_MPS - moment.robot.speed(),
            Trigger::RobotPassed => (Trigger::PASSED_WITHIN_M + slack_m - nearest_m)
                .min(moment.distance_m + slack_m - nearest_m - Trigger::PASSED_BY_M),
            Trigger::RobotSays(gesture) => flag(moment.robot.gesture == Some(*gesture)),
            Trigger::HumanSays(other, gesture) => flag(
                signals
                    .tracks
                    .human(*other)
                    .and_then(|track| track.at(moment.t))
                    .is_some_and(|s| s.gesture == Some(*gesture)),
            ),
            Trigger::GoalReached => signals
                .evidence
                .paths
                .and_then(|paths| paths.of(AgentId::Human(human)))
                .and_then(|nodes| nodes.last())
                .and_then(|id| signals.node(id))
                .map_or(-1.0, |goal| AT_GOAL_M + slack_m - (moment.human.at - goal).norm()),
            Trigger::AtEncounter => signals
                .encounter(human)
                .map_or(-1.0, |(_, at)| AT_ENCOUNTER_M + slack_m - (moment.human.at - at).norm()),
            Trigger::AfterSecs(s) => moment.t + slack_m - s,
            Trigger::StoppedFor(s) => steps::stood_s(signals, moment.t) + slack_m - s,
            Trigger::Did(id, step) => flag(steps::ended_s(signals, *id, *step).is_some_and(|t| t <= moment.t)),
            Trigger::Done(id) => flag(steps::done_s(signals, *id).is_some_and(|t| t <= moment.t)),
        }
    };
    Mark::new(moment.t, when.iter().map(one).fold(f64::INFINITY, f64::min))
}

fn marks(signals: &Signals<'_>, human: HumanId, when: &[Trigger], slack_m: f64) -> Vec<Mark> {
    marks_from(signals, human, when, (f64::NEG_INFINITY, slack_m))
}

/// Margins of triggers from a time on; the nearest distance of the robot counts from then.
fn marks_from(signals: &Signals<'_>, human: HumanId, when: &[Trigger], (from_s, slack_m): (f64, f64)) -> Vec<Mark> {
    // The nearest that the robot has been by then.
    let mut nearest_m = f64::INFINITY;
    let mark = |moment: &Moment| {
        nearest_m = nearest_m.min(moment.distance_m);
        trigger_mark(signals, human, when, (moment, nearest_m), slack_m)
    };
    signals.of(human).iter().filter(|moment| moment.t >= from_s).map(mark).collect()
}

/// The finding where triggers never held together and were nearest to it at a moment: which of them did not, and what was true instead.
pub(super) fn never_came(signals: &Signals<'_>, human: HumanId, when: &[Trigger], near: Mark) -> Finding {
    let phrase = Trigger::phrases(when);
    let trigger = missed_at(signals, human, when, near.t);
    let instead = trigger.as_ref().map_or_else(String::new, |one| format!(": {}", missed::told(signals, human, one)));
    let text = format!("the reason of {human} never came ({phrase}){instead}");
    let missed = trigger.map(|trigger| Missed { trigger, nearest_m: signals.nearest_m(human) });
    Finding::never(near.margin, vec![near.t], text).missing(missed)
}

/// Of several triggers that never held together, the one that was farthest from it at this time.
fn missed_at(signals: &Signals<'_>, human: HumanId, when: &[Trigger], t: f64) -> Option<Trigger> {
    let moments = signals.of(human);
    let before = moments.iter().take_while(|moment| moment.t <= t + 1e-9);
    let nearest_m = before.map(|moment| moment.distance_m).fold(f64::INFINITY, f64::min);
    let moment = moments.iter().find(|moment| moment.t >= t - 1e-9)?;
    let margin = |trigger: &Trigger| {
        trigger_mark(signals, human, std::slice::from_ref(trigger), (moment, nearest_m), 0.0).margin
    };
    when.iter().min_by(|one, other| margin(one).total_cmp(&margin(other))).cloned()
}

/// When all triggers first hold for a human, their distances read loosely; where they never do, the moment that comes nearest.
pub(super) fn first_reason(signals: &Signals<'_>, human: HumanId, when: &[Trigger]) -> Result<f64, Mark> {
    let loose = marks(signals, human, when, EARLY_M);
    match first(loose.iter().copied()) {
        Some(mark) => Ok(mark.t),
        None => Err(best(loose).unwrap_or(Mark::new(0.0, -1.0))),
    }
}

/// When all triggers first hold from a time on.
pub(super) fn first_since(signals: &Signals<'_>, human: HumanId, when: &[Trigger], since_s: f64) -> Option<f64> {
    first(marks_from(signals, human, when, (since_s, 0.0))).map(|mark| mark.t)
}

/// Whether all triggers hold at a moment of a human.
pub(super) fn holds(signals: &Signals<'_>, human: HumanId, when: &[Trigger], moment: &Moment) -> bool {
    // Only who was passed needs to know how near the robot has been.
    let nearest_m = if when.contains(&Trigger::RobotPassed) {
        let before = signals.of(human).iter().take_while(|other| other.t <= moment.t);
        before.map(|other| other.distance_m).fold(f64::INFINITY, f64::min)
    } else {
        moment.distance_m
    };
    trigger_mark(signals, human, when, (moment, nearest_m), 0.0).margin >= 0.0
}

/// Times at which the triggers begin to hold.
fn rises(marks: &[Mark]) -> Vec<f64> {
    let mut held = false;
    let mut found = Vec::new();
    for mark in marks {
        let holds = mark.margin >= 0.0;
        if holds && !held {
            found.push(mark.t);
        }
        held = holds;
    }
    found
}

/// Actions that have a beginning of their own; walking and standing go on all the time.
pub(super) const fn has_onset(action: &Action) -> bool {
    !matches!(action, Action::Navigate | Action::StandStill)
}

/// After the triggers first hold, the action is seen in time, and not before them.
pub(super) fn reacts(signals: &Signals<'_>, human: HumanId, when: &[Trigger], act: &Action, within_s: f64) -> Finding {
    if let Some(found) = absent(signals, human) {
        return found;
    }
    let phrase = Trigger::phrases(when);
    let acts = spans(signals, human, act);
    let onsets: Vec<f64> = acts.iter().map(|(from, _)| *from).collect();
    let strict = marks(signals, human, when, 0.0);
    let loose = marks(signals, human, when, EARLY_M);
    let distance = |t: f64| {
        signals.of(human).iter().find(|moment| moment.t >= t - 1e-9).map_or(f64::NAN, |moment| moment.distance_m)
    };
    let triggered =
        first(strict.iter().copied()).or_else(|| first(loose.iter().copied()).filter(|_| !onsets.is_empty()));
    // The action is early when neither this rule nor another of the same action had a reason by then.
    if let Some(onset) = onsets.first().copied()
        && has_onset(act)
        && (!signals.leaves_of(human).is_empty() || *act == Action::RunAway)
        && first(loose.iter().copied()).is_none_or(|mark| mark.t > onset + EARLY_SECS)
        && !other_reason(signals, human, when, act, onset)
    {
        let text = format!(
            "{human} {} at {onset:.1} s with the robot {:.1} m away, {}",
            act.phrase(),
            distance(onset),
            triggered.map_or_else(
                || format!("but never {phrase}"),
                |mark| format!("{:.1} s before the trigger ({phrase})", mark.t - onset)
            )
        );
        return Finding::fails(-1.0, vec![onset], text).too_early();
    }
    let Some(trigger) = triggered else {
        let near = best(strict.iter().copied()).unwrap_or(Mark::new(0.0, -1.0));
        return never_came(signals, human, when, near);
    };
    // Begun in time under the loose reading, or by another rule, it counts where it is still going on then.
    let loosely_s = first(loose.iter().copied()).map_or(trigger.t, |mark| mark.t.min(trigger.t));
    let goes_on = || acts.iter().rfind(|(_, to)| *to >= loosely_s - EARLY_SECS).map(|(from, _)| *from);
    let Some(onset) = onsets.iter().copied().find(|onset| *onset >= trigger.t - EARLY_SECS).or_else(goes_on) else {
        let start = format!("trigger at {:.1} s ({phrase}), but {human}", trigger.t);
        return match acts.last() {
            Some((from, to)) => {
                let text = format!("{start} {} only before it, from {from:.1} s to {to:.1} s", act.phrase());
                Finding::fails(to - trigger.t, vec![trigger.t, *from], text).too_early()
            }
            None => {
                let text = format!("{start} never {}", act.phrase());
                Finding::fails(-within_s.max(0.5), vec![trigger.t], text)
            }
        };
    };
    let start = busy_until(signals, human, act, trigger.t);
    let delay = (onset - start).max(0.0);
    let again = rises(&strict).into_iter().rfind(|rise| *rise <= onset + EARLY_SECS);
    let text = format!(
        "trigger at {:.1} s ({phrase}); {human} {} from {onset:.1} s, {delay:.1} s later (at most {within_s:.1} s)",
        trigger.t,
        act.phrase()
    );
    let times = vec![onset, trigger.t];
    if delay > within_s && again.is_some_and(|rise| onset - rise <= within_s) {
        let found = Finding::late(within_s - delay, times, format!("{text}, when the trigger came again"));
        return kept(signals, human, when, act, found);
    }
    kept(signals, human, when, act, timely(delay, within_s, times, text))
}

/// How long after the reason for it a gesture is made, s: after the last rise of the triggers of a rule with this
/// gesture up to then, no sooner than earlier rules end; below 0 where it is made too soon for them. `None` where no rule asks for it or no reason is seen.
pub(super) fn said_after(signals: &Signals<'_>, human: HumanId, gesture: Gesture, said_s: f64) -> Option<f64> {
    let rules = &signals.evidence.proposal?.human(human)?.rules;
    let delay = |(at, rule): (usize, &Rule)| {
        let all = rises(&marks(signals, human, &rule.when, EARLY_M));
        let rise = all.iter().copied().rfind(|t| *t <= said_s + EARLY_SECS)?;
        // What the same reason calls for before it lasts as long as its rules say.
        let before = || rules.iter().take(at).filter(|other| other.when == rule.when);
        let due_s = before().filter_map(|other| other.for_s).sum::<f64>();
        // Whoever walks up to the robot, or out of its way, may be there sooner.
        let stands = |rule: &&Rule| matches!(rule.act, Action::StandStill | Action::LookAtRobot | Action::Block);
        let stood_s = before().filter(stands).filter_map(|other| other.for_s).sum::<f64>();
        let soonest = all.first().map_or(rise, |first| first.min(rise)) + stood_s;
        if said_s < soonest - TOO_EARLY_SECS {
            return Some(said_s - soonest);
        }
        Some((said_s - busy_until(signals, human, &rule.act, rise).max(rise + due_s)).max(0.0))
    };
    let said = |(_, rule): &(usize, &Rule)| rule.gesture == Some(gesture);
    rules.iter().enumerate().filter(said).filter_map(delay).min_by(|a, b| a.abs().total_cmp(&b.abs()))
}

/// Whether another rule with the same action had a reason at the time.
fn other_reason(signals: &Signals<'_>, human: HumanId, when: &[Trigger], act: &Action, onset: f64) -> bool {
    let rules =
        signals.evidence.proposal.and_then(|proposal| proposal.human(human)).map_or(&[][..], |human| &human.rules);
    rules
        .iter()
        .filter(|rule| rule.act == *act && rule.when != when)
        .any(|rule| first(marks(signals, human, &rule.when, EARLY_M)).is_some_and(|mark| mark.t <= onset + EARLY_SECS))
}

/// The clock of a reaction starts when no earlier rule of the same human runs any more: earlier rules win.
pub(super) fn busy_until(signals: &Signals<'_>, human: HumanId, act: &Action, trigger_s: f64) -> f64 {
    let Some(proposal) = signals.evidence.proposal.and_then(|proposal| proposal.human(human)) else { return trigger_s };
    let earlier: Vec<&Action> = proposal.rules.iter().map(|rule| &rule.act).take_while(|other| *other != act).collect();
    let mut start = trigger_s;
    for span in signals.leaves_of(human) {
        let covers = span.from_s <= start + EARLY_SECS && span.to_s > start;
        if covers && earlier.iter().any(|other| other.is_leaf(&span.name)) {
            start = span.to_s;
        }
    }
    start
}
