//! The monitor of a step of somebody's sequence: it begins for its reason and not before, is done while it lasts, and is over
//! when what ends it holds.

use socrates_model::{Action, AgentId, EventKind, Gesture, HumanId, Rule, Trigger};

use crate::fidelity::acts::{motion, spans, timely};
use crate::fidelity::finding::Finding;
use crate::fidelity::meeting::absent;
use crate::fidelity::reactions::{EARLY_SECS, busy_until, first_reason, first_since, has_onset, never_came};
use crate::fidelity::signals::{MOMENT_SECS, Signals};
use crate::tracks::MOVING_MPS;

/// Share of its time for which a step has to be done.
const SHARE: f64 = 0.6;
/// How long after what ends it a step may still be done, s.
const END_SECS: f64 = 2.0;
/// Time in which a person comes to a stand, or turns about, s; of a short step, half of its length. It does not count.
const SETTLE_SECS: f64 = 1.0;
/// A longer time between two samples tells nothing of what was done in it, s.
const LONGEST_STEP_SECS: f64 = 0.3;
/// Nearer than this to the end of their way somebody is at it, m.
const AT_GOAL_M: f64 = 1.0;

/// When a step of somebody's sequence ended, as the recording tells; `None` where it never did.
pub(super) fn ended_s(signals: &Signals<'_>, human: HumanId, step: u32) -> Option<f64> {
    let kind = EventKind::StepEnded { human, step };
    signals.evidence.recording.events.iter().find(|event| event.kind == kind).map(|event| event.time.secs())
}

/// When somebody was done: with their last step; without steps, once their walk had led them past where they meet the robot, or to
/// its end.
pub(super) fn done_s(signals: &Signals<'_>, human: HumanId) -> Option<f64> {
    let steps = signals.evidence.proposal.and_then(|proposal| proposal.human(human)).map_or(0, |one| one.steps());
    if steps > 0 {
        return ended_s(signals, human, steps);
    }
    let goal = signals.evidence.paths.and_then(|paths| paths.of(AgentId::Human(human))).and_then(|way| way.last());
    let goal = goal.and_then(|node| signals.node(node));
    let meets = signals.encounter(human).map(|(_, at)| at);
    let mut nearest_m = f64::INFINITY;
    let track = signals.tracks.human(human)?;
    track.present().find_map(|sample| {
        let from_m = meets.map_or(f64::INFINITY, |at| (sample.at - at).norm());
        nearest_m = nearest_m.min(from_m);
        let past = nearest_m < Trigger::DONE_M && from_m >= Trigger::DONE_M;
        let there = goal.is_some_and(|goal| (sample.at - goal).norm() <= AT_GOAL_M);
        (past || there).then_some(sample.t)
    })
}

/// For how long the robot has stood at a moment, s.
pub(super) fn stood_s(signals: &Signals<'_>, t: f64) -> f64 {
    let Some(robot) = &signals.tracks.robot else { return 0.0 };
    if t < signals.moves_s {
        return 0.0;
    }
    let upto = robot.samples.partition_point(|sample| sample.t <= t);
    let moved = robot.samples.get(..upto).and_then(|all| all.iter().rfind(|sample| sample.speed() > MOVING_MPS));
    moved.map_or(0.0, |sample| t - sample.t)
}

/// For how long an act has to be seen at most, s: getting to where it can be seen takes its time.
const fn most_s(act: &Action) -> f64 {
    if act.stands() {
        f64::INFINITY
    } else if matches!(act, Action::Block) {
        2.5
    } else if matches!(act, Action::FollowRobot | Action::FollowHuman(_)) {
        1.5
    } else if matches!(act, Action::GiveWay | Action::MakeRoom) {
        0.3
    } else {
        0.5
    }
}

/// A step is done as its rule says.
pub(super) fn step(signals: &Signals<'_>, human: HumanId, rule: &Rule, within_s: f64) -> Finding {
    if let Some(found) = absent(signals, human) {
        return found;
    }
    let phrase = Trigger::phrases(&rule.when);
    let reason_s = match first_reason(signals, human, &rule.when) {
        Ok(t) => t,
        Err(near) => return never_came(signals, human, &rule.when, near),
    };
    let due_s = busy_until(signals, human, &rule.act, reason_s);
    let begun = match rule.gesture {
        Some(gesture) => says(signals, human, (rule, gesture), reason_s),
        None => does(signals, human, rule, reason_s),
    };
    let what = rule.gesture.map_or_else(|| rule.act.phrase(), |gesture| format!("says {gesture}"));
    let begun_s = match begun {
        Ok(t) => t,
        Err(early) if early.is_finite() => {
            let text =
                format!("{human} {what} at {early:.1} s, before the reason for it at {reason_s:.1} s ({phrase})");
            return Finding::fails(early - reason_s, vec![early, reason_s], text).too_early();
        }
        Err(_) => {
            let text = format!("trigger at {reason_s:.1} s ({phrase}), but {human} never {what} then");
            return Finding::fails(-within_s.max(0.5), vec![reason_s], text);
        }
    };
    let delay_s = (begun_s - due_s).max(0.0);
    let text = format!("trigger at {reason_s:.1} s ({phrase}); {human} {what} from {begun_s:.1} s");
    let times = vec![begun_s, reason_s];
    let found = timely(delay_s, within_s, times.clone(), text.clone());
    if found.margin < 0.0 {
        return found;
    }
    match lasts(signals, human, rule, begun_s) {
        Ok(kept) => Finding { evidence: format!("{text}{kept}"), ..found },
        Err((margin, why)) => Finding::fails(margin, times, format!("{text}, {why}")),
    }
}

/// From when to when a step is done; `None` where it is not.
pub fn step_times(signals: &Signals<'_>, human: HumanId, rule: &Rule) -> Option<(f64, f64)> {
    let reason_s = first_reason(signals, human, &rule.when).ok()?;
    let begun_s = match rule.gesture {
        Some(gesture) => says(signals, human, (rule, gesture), reason_s),
        None => does(signals, human, rule, reason_s),
    };
    let begun_s = begun_s.ok()?;
    Some((begun_s, over(signals, human, rule, begun_s).1))
}

/// When what ends a step comes, and when it is over: then, or when its time or the run is.
fn over(signals: &Signals<'_>, human: HumanId, rule: &Rule, begun_s: f64) -> (Option<f64>, f64) {
    let until_s = if rule.until.is_empty() { None } else { first_since(signals, human, &rule.until, begun_s) };
    let by_time_s = rule.for_s.map_or(f64::INFINITY, |secs| begun_s + secs);
    (until_s, until_s.unwrap_or(f64::INFINITY).min(by_time_s).min(signals.end_s()))
}

/// When a gesture is made for a reason; the error is when it is made before it, or infinite where it is never made.
fn says(signals: &Signals<'_>, human: HumanId, (rule, gesture): (&Rule, Gesture), reason_s: f64) -> Result<f64, f64> {
    let made = |sample: &&crate::tracks::Sample| sample.gesture == Some(gesture);
    let Some(track) = signals.tracks.human(human) else { return Err(f64::INFINITY) };
    let mut begins: Vec<f64> = Vec::new();
    let mut held = false;
    for sample in track.present() {
        if made(&sample) && !held {
            begins.push(sample.t);
        }
        held = made(&sample);
    }
    if let Some(t) = begins.iter().copied().find(|t| *t >= reason_s - EARLY_SECS) {
        let before = begins.iter().copied().find(|before| *before < reason_s - EARLY_SECS);
        let other = |before: f64| {
            others(signals, human, rule).filter(|other| other.gesture == Some(gesture)).any(|other| {
                first_reason(signals, human, &other.when).is_ok_and(|reason| reason <= before + EARLY_SECS)
            })
        };
        return before.filter(|before| !other(*before)).map_or(Ok(t), Err);
    }
    Err(begins.last().copied().unwrap_or(f64::INFINITY))
}

/// The same for an act.
fn does(signals: &Signals<'_>, human: HumanId, rule: &Rule, reason_s: f64) -> Result<f64, f64> {
    let all = spans(signals, human, &rule.act);
    let after = all.iter().find(|(from, _)| *from >= reason_s - EARLY_SECS).map(|(from, _)| *from);
    // What is done before it for another reason goes on.
    let goes_on = || all.iter().any(|(from, to)| *from < reason_s && *to > reason_s + EARLY_SECS);
    let early = all.iter().find(|(from, _)| *from < reason_s - EARLY_SECS).map(|(from, _)| *from);
    // A leaf does not tell whom, where to or how fast.
    let same = |act: &Action| std::mem::discriminant(act) == std::mem::discriminant(&rule.act);
    let by_other = others(signals, human, rule).any(|other| same(&other.act));
    let stands = matches!(rule.act, Action::StandStill | Action::Navigate);
    if let Some(early) = early.filter(|_| has_onset(&rule.act) && !by_other && signals.tells_leaves_of(human)) {
        return Err(early);
    }
    match after {
        Some(_) if stands && goes_on() => Ok(reason_s),
        Some(t) => Ok(t),
        None if (by_other || stands) && goes_on() => Ok(reason_s),
        None => Err(early.filter(|_| has_onset(&rule.act) && !by_other).unwrap_or(f64::INFINITY)),
    }
}

/// The other rules of somebody.
fn others<'a>(signals: &Signals<'a>, human: HumanId, rule: &'a Rule) -> impl Iterator<Item = &'a Rule> {
    let evidence = signals.evidence;
    let rules = evidence.proposal.and_then(|proposal| proposal.human(human)).map_or(&[][..], |one| &one.rules);
    rules.iter().filter(move |other| *other != rule)
}

/// Whether an act is done for as long as it should be, and no longer: the margin and the words where it is not.
fn lasts(signals: &Signals<'_>, human: HumanId, rule: &Rule, begun_s: f64) -> Result<String, (f64, String)> {
    // The end of the way is that of the way they walk then, not of the one they were given.
    let to_the_end = matches!(
        (&rule.act, rule.until.as_slice()),
        (Action::Navigate | Action::TurnBack | Action::GoTo(_), [Trigger::GoalReached])
    );
    let gives = matches!(rule.act, Action::GiveWay | Action::MakeRoom);
    let own = to_the_end || gives && rule.until == [Trigger::RobotPassed];
    let (until_s, over_s) = over(signals, human, rule, begun_s);
    if !rule.until.is_empty() && until_s.is_none() && rule.for_s.is_none() && !own {
        let until = rule.until.iter().map(Trigger::clause).collect::<Vec<_>>().join(" and ");
        return Err((-1.0, format!("and what ends it never came ({until})")));
    }
    let by_time_s = rule.for_s.map_or(f64::INFINITY, |secs| begun_s + secs);
    let length_s = over_s - begun_s;
    let settle_s = SETTLE_SECS.min(length_s / 2.0);
    let asked_s = (SHARE * (length_s - settle_s)).min(most_s(&rule.act));
    let kept_s = kept_s(signals, human, rule, (begun_s, over_s));
    if kept_s + 2.0 * MOMENT_SECS < asked_s {
        let text = format!("and does so for {kept_s:.1} s of {length_s:.1} s (at least {asked_s:.1} s asked)");
        return Err((kept_s - asked_s, text));
    }
    let alone = !others(signals, human, rule).any(|other| other.act == rule.act);
    let judged = alone && rule.act != Action::Navigate && !to_the_end;
    if let Some(until_s) = until_s.filter(|until_s| judged && *until_s <= by_time_s) {
        let late_s = until_s + END_SECS;
        let goes_on = |span: &&crate::fidelity::leaves::LeafSpan| {
            rule.act.is_leaf(&span.name) && span.from_s < late_s && span.to_s > late_s && span.to_s > begun_s
        };
        if let Some(span) = signals.leaves_of(human).iter().find(goes_on) {
            let text = format!("and goes on to {:.1} s, though what ends it came at {until_s:.1} s", span.to_s);
            return Err((late_s - span.to_s, text));
        }
    }
    Ok(format!(", for {kept_s:.1} s of {length_s:.1} s"))
}

/// For how long an act is seen within a time, s.
fn kept_s(signals: &Signals<'_>, human: HumanId, rule: &Rule, (from_s, to_s): (f64, f64)) -> f64 {
    let (marks, _) = motion(signals, human, &rule.act);
    let runs = |t: f64| {
        let mut spans = signals.leaves_of(human).iter().filter(|span| rule.act.is_leaf(&span.name));
        !signals.tells_leaves_of(human)
            || spans.any(|span| t >= span.from_s - MOMENT_SECS && t <= span.to_s + MOMENT_SECS)
    };
    // Recordings are sampled more or less often.
    let pairs = marks.iter().zip(marks.iter().skip(1));
    let seen = pairs.filter(|(mark, _)| mark.margin >= 0.0 && mark.t >= from_s && mark.t <= to_s && runs(mark.t));
    seen.map(|(mark, next)| (next.t - mark.t).min(LONGEST_STEP_SECS)).sum()
}
