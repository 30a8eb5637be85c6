//! The monitor of a line of the robot's script: what it says, how it waits, and with whom it goes, each for its reason.

use socrates_model::rule::{RobotDo, RobotRule, RobotWhen};
use socrates_model::{Action, AgentId, EventKind, Gesture, HumanId, Point};

use crate::fidelity::acts::timely;
use crate::fidelity::finding::Finding;
use crate::fidelity::reactions::{EARLY_M, EARLY_SECS};
use crate::fidelity::robot::{ARRIVED_M, CREEPS_M, MOVED_SECS, goal};
use crate::fidelity::signals::{Moment, Signals};
use crate::fidelity::since::since_follows;
use crate::fidelity::windows::{Mark, best, first, stretches};
use crate::fidelity::{company, doorway, meeting, steps};
use crate::tracks::{MOVING_MPS, Sample, Track};

/// A gesture that is shown for less was not made, s.
const SHOWN_SECS: f64 = 0.3;
/// Share of its time for which the robot has to stand, and the time that it takes to come to a stand, s, which does not count.
const SHARE: f64 = 0.6;
const SETTLE_SECS: f64 = 1.0;
/// Shortest stand that can be seen, s.
const LEAST_SECS: f64 = 0.2;
/// The robot goes within so long of the moment that it waits for, s, and goes on so far, m.
const GOES_SECS: f64 = 3.0;
const GOES_M: f64 = 0.5;
/// The robot follows somebody, goes beside them, or is followed for so long, s, and follows with this gap, m.
const WITH_SECS: f64 = 3.0;
const GAP_M: [f64; 2] = [0.5, 3.5];
/// A follower may be so much farther behind than the robot allows for, m, and for so long, s, while it stops and they catch up.
const SLACK_M: f64 = 1.5;
const SLACK_SECS: f64 = 3.0;
/// Number of followers within the usual distance, and how much farther behind each one more is, m: they go one behind the other.
const FEW_FOLLOW: usize = 3;
const QUEUE_M: f64 = 0.5;

/// When a reason first holds, s: as it is stated, and read loosely.
#[derive(Debug, Clone, Copy)]
struct Reason {
    t: f64,
    loose_s: f64,
    /// Whether it holds as it is stated.
    strict: bool,
}

/// The robot does a line of its script, for its reason.
pub(super) fn robot_step(signals: &Signals<'_>, rule: &RobotRule, within_s: f64) -> Finding {
    let Some(robot) = &signals.tracks.robot else {
        return Finding::not_applicable("there is no robot in the recording");
    };
    let reason = match comes(signals, robot, &rule.when, f64::NEG_INFINITY) {
        Ok(reason) => reason,
        Err(near) => {
            let text = format!("the reason never came ({}): nearest at {:.1} s", rule.when.phrase(), near.t);
            return Finding::never(near.margin, vec![near.t], text);
        }
    };
    let found = match &rule.act {
        RobotDo::Say(gesture) => says(signals, rule, *gesture, reason, within_s),
        RobotDo::Hold(secs) => holds(signals, robot, (&rule.when, *secs), reason, within_s),
        RobotDo::HoldUntil(until) => holds_until(signals, robot, (&rule.when, until), reason, within_s),
        RobotDo::WaitForLeavers => doorway::robot_enters_last(signals).unwrap_or_else(|found| found),
        RobotDo::Follow(human) => {
            company::follows_since(signals, (AgentId::Robot, (*human).into()), GAP_M, WITH_SECS, reason.t)
        }
        RobotDo::Abreast(human) => company::abreast_since(signals, *human, WITH_SECS, reason.t),
        RobotDo::Overtake(human) => meeting::passes_since(signals, *human, false, reason.t),
        RobotDo::Lead(reach_m) => leads(signals, *reach_m, reason.t),
    };
    let evidence = format!("reason at {:.1} s ({}); {}", reason.t.max(0.0), rule.when.phrase(), found.evidence);
    Finding { evidence, ..found }
}

/// Humans whom the robot sees, with how they stand to it, at each of its samples.
fn seen<'s>(signals: &'s Signals<'_>, count: usize) -> Vec<Vec<(HumanId, &'s Moment)>> {
    let mut found = vec![Vec::new(); count];
    for (id, moments) in &signals.moments {
        for moment in moments.iter().filter(|moment| moment.sight != Some(false)) {
            if let Some(here) = found.get_mut(moment.index) {
                here.push((*id, moment));
            }
        }
    }
    found
}

/// Whether the last sign of a human up to a time was made to another human: it is none for the robot.
fn is_for_others(signals: &Signals<'_>, human: HumanId, said: Gesture, t: f64) -> bool {
    let made = signals.evidence.recording.events.iter().filter(|event| event.time.secs() <= t + EARLY_SECS);
    let whom = made.rev().find_map(|event| match &event.kind {
        EventKind::Gesture { agent, gesture: Some(gesture), to } if (*agent, *gesture) == (human.into(), said) => {
            Some(*to)
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
    matches!(whom, Some(Some(AgentId::Human(_))))
}

/// How far a reason holds at each sample of the robot from a time on; distances and times are widened by `slack`.
fn marks(signals: &Signals<'_>, robot: &Track, when: &RobotWhen, (from_s, slack): (f64, f64)) -> Vec<Mark> {
    let people = seen(signals, robot.samples.len());
    let over_s = if let RobotWhen::Did(human, step) = when {
        steps::ended_s(signals, *human, *step)
    } else if let RobotWhen::Done(human) = when {
        steps::done_s(signals, *human)
    } else if let RobotWhen::AfterLine(number) = when {
        over(signals, robot, *number)
    } else {
        None
    };
    let mut blocked_s = 0.0;
    let mut last_s: Option<f64> = None;
    let mut mark = |(sample, people): (&Sample, &Vec<(HumanId, &Moment)>)| {
        let step_s = last_s.replace(sample.t).map_or(0.0, |last| sample.t - last);
        let margin = match when {
            RobotWhen::Start => 1.0,
            RobotWhen::Blocked(secs) => {
                let is_blocked = |(_, moment): &(HumanId, &Moment)| {
                    let off = (sample.bearing(&moment.human.at).abs() - slack).max(0.0);
                    RobotWhen::is_blocked_by(moment.distance_m - slack, off)
                };
                blocked_s = if people.iter().any(is_blocked) { blocked_s + step_s } else { 0.0 };
                blocked_s + slack - secs
            }
            RobotWhen::HumanNear(reach_m) => {
                let near = people.iter().map(|(_, moment)| reach_m + slack - moment.distance_m);
                near.fold(-1e3, f64::max)
            }
            RobotWhen::Near(human, reach_m) => {
                let own = people.iter().find(|(id, _)| id == human);
                own.map_or(-1e3, |(_, moment)| reach_m + slack - moment.distance_m)
            }
            RobotWhen::HumanSays(gesture) => {
                let says = |(id, moment): &(HumanId, &Moment)| {
                    moment.human.gesture == Some(*gesture)
                        && moment.distance_m < Gesture::SEEN_M + slack
                        && !is_for_others(signals, *id, *gesture, moment.t)
                };
                if people.iter().any(says) { 1.0 } else { -1.0 }
            }
            RobotWhen::AtEncounter(human) => {
                let own = people.iter().find(|(id, _)| id == human).map(|(_, moment)| moment.human.at);
                signals.encounter(*human).map_or(-1e3, |(_, at)| {
                    let apart = |from: &Point| own.map_or(f64::INFINITY, |own| (own - from).norm());
                    RobotWhen::at_encounter_m((sample.at - at).norm(), apart(&sample.at), apart(&at)) + slack
                })
            }
            RobotWhen::AfterSecs(secs) => sample.t + slack - secs,
            RobotWhen::Did(..) | RobotWhen::Done(_) | RobotWhen::AfterLine(_) => {
                over_s.map_or(-1e3, |over_s| sample.t + slack - over_s)
            }
        };
        Mark::new(sample.t, margin)
    };
    robot.samples.iter().zip(&people).filter(|(sample, _)| sample.there && sample.t >= from_s).map(&mut mark).collect()
}

/// End of a line of the script, s, by its beginning and its deed; none where it does not end.
fn over(signals: &Signals<'_>, robot: &Track, number: u32) -> Option<f64> {
    let script = signals.evidence.proposal.map_or(&[][..], |proposal| &proposal.robot.script);
    let place = usize::try_from(number).ok()?.checked_sub(1)?;
    let line = script.get(place)?;
    // An order in a circle has no end.
    if matches!(line.when, RobotWhen::AfterLine(before) if before >= number) {
        return None;
    }
    let begun_s = comes(signals, robot, &line.when, f64::NEG_INFINITY).ok()?.t.max(0.0);
    let longest_s = begun_s + line.act.longest_s();
    let ends_s = if let RobotDo::HoldUntil(until) = &line.act {
        comes(signals, robot, until, begun_s).map_or(longest_s, |reason| reason.t.min(longest_s))
    } else {
        longest_s
    };
    (ends_s <= signals.end_s()).then_some(ends_s)
}

/// When a reason first holds from a time on; where it never does, the moment that comes nearest.
fn comes(signals: &Signals<'_>, robot: &Track, when: &RobotWhen, from_s: f64) -> Result<Reason, Mark> {
    let loose = marks(signals, robot, when, (from_s, EARLY_M));
    let Some(begins) = first(loose.iter().copied()) else {
        return Err(best(loose).unwrap_or(Mark::new(0.0, -1.0)));
    };
    let strict = first(marks(signals, robot, when, (from_s, 0.0)));
    Ok(Reason { t: strict.map_or(begins.t, |mark| mark.t), loose_s: begins.t, strict: strict.is_some() })
}

/// Stretches of the recording in which the robot shows a gesture.
fn shown(signals: &Signals<'_>, gesture: Gesture) -> Vec<(f64, f64)> {
    let samples = signals.full.robot.as_ref().map_or(&[][..], |robot| &robot.samples);
    let mark = |sample: &Sample| Mark::new(sample.t, if sample.gesture == Some(gesture) { 1.0 } else { -1.0 });
    stretches(samples.iter().map(mark), SHOWN_SECS)
}

/// The robot makes the gesture within a time of its reason, and not before it.
fn says(signals: &Signals<'_>, rule: &RobotRule, gesture: Gesture, reason: Reason, within_s: f64) -> Finding {
    let spans = shown(signals, gesture);
    let soonest_s = reason.loose_s - EARLY_SECS;
    // The same said for another line of the script is not said too early for this one.
    let others: Vec<f64> = signals.evidence.proposal.map_or_else(Vec::new, |proposal| {
        let same = proposal.robot.script.iter().filter(|line| line.act == rule.act && *line != rule);
        let robot = signals.tracks.robot.as_ref();
        let came = same.filter_map(|line| comes(signals, robot?, &line.when, f64::NEG_INFINITY).ok());
        came.map(|other| other.loose_s).collect()
    });
    let early = |(from, _): &&(f64, f64)| *from < soonest_s && !others.iter().any(|t| *t <= from + EARLY_SECS);
    if let Some((from, _)) = spans.iter().find(early) {
        let text = format!("the robot says {gesture} at {from:.1} s, before it");
        return Finding::fails(from - reason.t, vec![*from, reason.t], text);
    }
    match spans.iter().find(|(from, _)| *from >= soonest_s) {
        Some((from, _)) => {
            let delay = (from - reason.t).max(0.0);
            let text = format!("the robot says {gesture} at {from:.1} s (at most {within_s:.1} s later)");
            timely(delay, within_s, vec![*from, reason.t], text)
        }
        None if !reason.strict => Finding::never(-EARLY_M, vec![reason.t], "it nearly came, and nothing was said"),
        None => Finding::fails(-within_s, vec![reason.t], format!("the robot never says {gesture} then")),
    }
}

/// Stretches in which the robot stands.
fn stands(robot: &Track) -> Vec<(f64, f64)> {
    stretches(robot.present().map(|sample| Mark::new(sample.t, MOVING_MPS - sample.speed())), 0.0)
}

/// Times in which other lines of the script have the robot stand, s.
fn held_by_others(signals: &Signals<'_>, robot: &Track, act: &RobotDo) -> Vec<(f64, f64)> {
    let script = signals.evidence.proposal.map_or(&[][..], |proposal| &proposal.robot.script);
    let stands = |line: &&RobotRule| matches!(line.act, RobotDo::Hold(_) | RobotDo::HoldUntil(_)) && line.act != *act;
    let span = |(number, line): (u32, &RobotRule)| {
        let begun_s = comes(signals, robot, &line.when, f64::NEG_INFINITY).ok()?.loose_s;
        Some((begun_s, over(signals, robot, number).unwrap_or_else(|| signals.end_s())))
    };
    (1..).zip(script).filter(|(_, line)| stands(line)).filter_map(span).collect()
}

/// Whether one of some times goes on to a time, s, or ended shortly before it.
fn lasts_to(spans: &[(f64, f64)], t: f64) -> bool {
    spans.iter().any(|(from, to)| *from <= t + EARLY_SECS && *to >= t - GOES_SECS)
}

/// When the robot comes to a stand for a reason, and where; else the finding that it does not. It has moved shortly before, unless it
/// waits from the start.
fn comes_to_stand(
    robot: &Track,
    (when, others): (&RobotWhen, &[(f64, f64)]),
    reason: Reason,
    within_s: f64,
) -> Result<(f64, Point, Finding), Finding> {
    // A blocked robot has stood for as long.
    let before_s = if let RobotWhen::Blocked(secs) = when { MOVED_SECS + secs } else { MOVED_SECS };
    let found = stands(robot).into_iter().find(|(_, to)| *to > reason.loose_s);
    let Some(((from, _), place)) = found.and_then(|span| Some((span, robot.at(span.0)?.at))) else {
        return Err(Finding::fails(-within_s, vec![reason.t], "the robot never stands then"));
    };
    let moved = |sample: &&Sample| sample.t <= reason.t && sample.t >= reason.t - before_s;
    if *when != RobotWhen::Start
        && !lasts_to(others, reason.t)
        && !robot.present().filter(moved).any(|sample| sample.speed() > MOVING_MPS)
    {
        let text = format!("the robot has stood from {from:.1} s, for {before_s:.0} s and more");
        return Err(Finding::fails(from - reason.t, vec![from, reason.t], text));
    }
    let delay_s = (from - reason.t).max(0.0);
    let text = format!("the robot stands from {from:.1} s (at most {within_s:.1} s later)");
    let found = timely(delay_s, within_s, vec![from, reason.t], text);
    if found.margin < 0.0 { Err(found) } else { Ok((from, place, found)) }
}

/// How far from a place the robot gets after a time, m; infinite where it waits at its goal.
fn goes_on_m(signals: &Signals<'_>, robot: &Track, place: &Point, from_s: f64) -> f64 {
    if goal(signals).is_some_and(|goal| (goal - place).norm() <= ARRIVED_M) {
        return f64::INFINITY;
    }
    let after = robot.present().filter(|sample| sample.t >= from_s);
    after.map(|sample| (sample.at - place).norm()).fold(0.0, f64::max)
}

/// The finding of a stand whose end is known, where the robot goes on after it.
fn and_goes_on(found: Finding, went_m: f64) -> Finding {
    if went_m >= GOES_M {
        return found;
    }
    let text = format!("{}, and does not go on: {went_m:.1} m (at least {GOES_M} m)", found.evidence);
    Finding::fails(went_m - GOES_M, found.times_s, text)
}

/// The robot stands for so long.
fn holds(
    signals: &Signals<'_>,
    robot: &Track,
    (when, secs): (&RobotWhen, f64),
    reason: Reason,
    within_s: f64,
) -> Finding {
    let others = held_by_others(signals, robot, &RobotDo::Hold(secs));
    let (from, place, found) = match comes_to_stand(robot, (when, &others), reason, within_s) {
        Ok(found) => found,
        Err(found) => return found,
    };
    // It waits from its reason on, and has begun to stand before it where it was slow.
    let begin_s = from.max(reason.loose_s);
    let spans = stands(robot);
    let within = |(a, b): &(f64, f64)| (b.min(begin_s + secs) - a.max(begin_s)).max(0.0);
    let stood_s: f64 = spans.iter().map(within).sum();
    let settle_s = (begin_s - reason.t).clamp(0.0, SETTLE_SECS);
    let asked_s = (SHARE * (secs - settle_s)).max(LEAST_SECS.min(secs));
    let text = format!("{}, for {stood_s:.1} s of {secs:.1} s (at least {asked_s:.1} s)", found.evidence);
    if stood_s < asked_s {
        return Finding::fails(stood_s - asked_s, found.times_s, text);
    }
    let found = Finding { evidence: text, ..found }.shifted(stood_s - asked_s);
    and_goes_on(found, goes_on_m(signals, robot, &place, begin_s + stood_s))
}

/// The robot stands until a moment comes, and goes then.
fn holds_until(
    signals: &Signals<'_>,
    robot: &Track,
    (when, until): (&RobotWhen, &RobotWhen),
    reason: Reason,
    within_s: f64,
) -> Finding {
    let others = held_by_others(signals, robot, &RobotDo::HoldUntil(until.clone()));
    let (from, place, found) = match comes_to_stand(robot, (when, &others), reason, within_s) {
        Ok(found) => found,
        Err(found) => return found,
    };
    let over = match comes(signals, robot, until, reason.t) {
        Ok(over) => over,
        Err(near) => {
            let text = format!("{}; what ends it never came ({})", found.evidence, until.phrase());
            return Finding::never(near.margin, vec![from, reason.t], text);
        }
    };
    let upto_s = over.loose_s - EARLY_SECS;
    if from > upto_s {
        let text = format!("the robot stands only from {from:.1} s, when what ends it comes ({})", until.phrase());
        return Finding::fails(upto_s - from, vec![from, reason.t], text);
    }
    let begin_s = from.max(reason.loose_s);
    let between = || robot.present().filter(|sample| sample.t >= begin_s && sample.t <= upto_s);
    let crept_m: f64 = between().zip(between().skip(1)).map(|(a, b)| (b.at - a.at).norm()).sum();
    let text = format!("{}, until {:.1} s ({})", found.evidence, over.t, until.phrase());
    if crept_m > CREEPS_M {
        let text = format!("{text}, and goes {crept_m:.1} m before that (at most {CREEPS_M} m)");
        return Finding::fails(CREEPS_M - crept_m, vec![from, reason.t], text);
    }
    let went_m = goes_on_m(signals, robot, &place, upto_s);
    let goes = robot.present().find(|sample| sample.t >= upto_s && sample.speed() > MOVING_MPS);
    let Some(goes) = goes else {
        return and_goes_on(Finding { evidence: text, ..found }, went_m);
    };
    let text = format!("{text}, and goes at {:.1} s (at most {GOES_SECS:.1} s later)", goes.t);
    // Another line may have it stand on.
    let held_s = others.iter().filter(|(from, to)| *from <= over.t + GOES_SECS && *to > over.t);
    let free_s = held_s.map(|(_, to)| *to).fold(over.t, f64::max);
    let ended = timely((goes.t - free_s).max(0.0), GOES_SECS, vec![from, reason.t, goes.t], text);
    if ended.margin < 0.0 { ended } else { and_goes_on(ended, went_m) }
}

/// Humans who follow the robot by a rule of theirs.
fn followers(signals: &Signals<'_>) -> Vec<HumanId> {
    let humans = signals.evidence.proposal.map_or(&[][..], |proposal| &proposal.humans);
    let follows = |rules: &[socrates_model::Rule]| rules.iter().any(|rule| rule.act == Action::FollowRobot);
    humans.iter().filter(|human| follows(&human.rules)).map(|human| human.id).collect()
}

/// Somebody follows the robot, and nobody who does is left behind.
fn leads(signals: &Signals<'_>, reach_m: f64, from_s: f64) -> Finding {
    let all = followers(signals);
    if all.is_empty() {
        return Finding::fails(-1.0, vec![from_s], "nobody has a rule to follow the robot");
    }
    let queue_m = QUEUE_M * all.len().saturating_sub(FEW_FOLLOW) as f64;
    let pair = |human: &HumanId| (AgentId::from(*human), AgentId::Robot);
    let [least_m, usual_m] = GAP_M;
    let gap_m = [least_m, usual_m.max(reach_m) + queue_m];
    let followed = all.iter().map(|human| company::follows_since(signals, pair(human), gap_m, WITH_SECS, from_s));
    let Some(found) = followed.max_by(|a, b| a.margin.total_cmp(&b.margin)) else {
        return Finding::not_applicable("nobody is recorded");
    };
    if found.margin < 0.0 || found.first_s().is_none() {
        return found;
    }
    let most_m = reach_m + SLACK_M + queue_m;
    let end_s = signals.arrived_s.unwrap_or(f64::INFINITY);
    let mut worst: Option<(f64, HumanId, (f64, f64))> = None;
    for human in all {
        let Ok(since) = since_follows(signals, human.into(), AgentId::Robot) else { continue };
        let leaves = signals.leaves_of(human);
        let follows = |t: f64| {
            let mut own = leaves.iter().filter(|span| Action::FollowRobot.is_leaf(&span.name));
            !signals.tells_leaves_of(human) || own.any(|span| t >= span.from_s && t <= span.to_s)
        };
        // Nobody is left behind who has not come up to the robot yet.
        let own = signals
            .of(human)
            .iter()
            .filter(|moment| moment.t >= from_s && moment.t <= end_s && since.counts(moment.t) && follows(moment.t));
        let own = own.skip_while(|moment| moment.distance_m > most_m);
        let left = own.map(|moment| {
            let moves = moment.robot.speed() > MOVING_MPS && moment.ahead_m < 0.0;
            Mark::new(moment.t, if moves { moment.distance_m - most_m } else { -1.0 })
        });
        let longest = stretches(left, 0.0).into_iter().max_by(|a, b| (a.1 - a.0).total_cmp(&(b.1 - b.0)));
        if let Some((from, to)) = longest
            && worst.as_ref().is_none_or(|(secs, _, _)| to - from > *secs)
        {
            worst = Some((to - from, human, (from, to)));
        }
    }
    match worst {
        Some((secs, human, (from, to))) if secs > SLACK_SECS => {
            let text = format!(
                "the robot drives on while {human} is more than {most_m:.1} m behind, from {from:.1} s to {to:.1} s (at most \
                 {SLACK_SECS:.0} s)"
            );
            Finding::fails(SLACK_SECS - secs, vec![from, from_s], text)
        }
        Some(_) | None => found,
    }
}
