//! Monitors of what one human does: blocks, looks, stands, runs away, gives way, gestures.

use socrates_model::geometry::wrap_angle;
use socrates_model::{Action, AgentId, EventKind, Gesture, HumanId, Vector};

use crate::fidelity::addressed;
use crate::fidelity::company::follow_marks;
use crate::fidelity::finding::Finding;
use crate::fidelity::follow::gaps;
use crate::fidelity::leaves::LeafSpan;
use crate::fidelity::meeting::{LATE_FACTOR, absent, lasting};
use crate::fidelity::reactions::said_after;
use crate::fidelity::robot::shows;
use crate::fidelity::signals::{Moment, Signals};
use crate::fidelity::since::{since, since_act};
use crate::fidelity::windows::{Mark, held, longest_s, stretches};
use crate::tracks::{MOVING_MPS, Sample};

/// Heading within this of the robot is looking at it, rad (20°).
const LOOK_RAD: f64 = 0.349_065_850_398_866;
/// From this angle off the robot on somebody has their back to it, rad (120°).
const AWAY_RAD: f64 = 2.0 * std::f64::consts::FRAC_PI_3;
/// Within this distance somebody can be in the robot's way, m.
const BLOCK_M: f64 = 2.5;
/// Nearer to the robot's line than this is in its way, m.
const IN_WAY_M: f64 = 0.6;
/// Somebody farther than this beside the robot's intended way is not in its way, wherever it turns, m.
const OFF_WAY_M: f64 = 1.2;
/// Somebody who comes faster than this towards the robot does not stay in front of it, m/s.
const COMES_MPS: f64 = 0.7;
/// How much sooner than the first sight a look may begin, s.
const EARLY_SECS: f64 = 0.5;
/// A look counts from this near where there is no map to tell lines of sight, m.
const LOOK_REACH_M: f64 = 10.0;
/// Distance within which a gesture can be noticed, m.
const GESTURE_M: f64 = Gesture::SEEN_M;
/// A gesture with a reason comes so long after it at most, s.
const SAID_SECS: f64 = 3.0;
/// Room beside the robot's line that lets it pass, m.
pub(super) const ASIDE_M: f64 = 0.6;
/// Somebody is seen to stand when the robot comes this near, m: as far as anybody sees it.
const STANDS_REACH_M: f64 = 15.0;
/// Speed away from the robot that is running from it, m/s.
const FLEE_MPS: f64 = 0.3;
/// Time in which somebody who runs away must have gained distance, s.
const FLEE_SECS: f64 = 6.0;

fn block_mark(moment: &Moment) -> Mark {
    let beside = moment.way.map_or(f64::INFINITY, |(_, off)| OFF_WAY_M - off);
    // Somebody who walks up to the robot, and past it, does not stay in front of it.
    let stays = COMES_MPS + moment.human.velocity.dot(&moment.away());
    let in_way = (BLOCK_M - moment.distance_m).min(IN_WAY_M - moment.off_line_m());
    Mark::new(moment.t, in_way.min(beside).min(stays))
}

/// How far somebody looks at the robot at each moment: stopped and turned to it, having seen it since
/// it began. Whose eyes follow a robot that a door frame hides for a moment looks all the same. A moment at which it
/// `may` not be a look never is one.
fn look_marks(moments: &[Moment], may: impl Fn(f64) -> bool) -> Vec<Mark> {
    let mut seen = false;
    let mark = |moment: &Moment| {
        let still = (MOVING_MPS - moment.human.speed()) / MOVING_MPS;
        let turned = (LOOK_RAD - moment.human.bearing(&moment.robot.at).abs()) / LOOK_RAD;
        let kept = still.min(turned).min(if may(moment.t) { 1.0 } else { -0.1 });
        let reach = match moment.sight {
            Some(true) => 1.0,
            Some(false) => -1.0,
            None => (LOOK_REACH_M - moment.distance_m) / LOOK_REACH_M,
        };
        seen = kept >= 0.0 && (seen || reach >= 0.0);
        Mark::new(moment.t, kept.min(if seen { 1.0 } else { reach }))
    };
    moments.iter().map(mark).collect()
}

fn flee_mark(moment: &Moment) -> Mark {
    Mark::new(moment.t, moment.human.velocity.dot(&moment.away()) - FLEE_MPS)
}

/// The human stands or walks in the robot's way for some time, before the robot is at its goal.
pub(super) fn blocks(signals: &Signals<'_>, human: HumanId, for_s: f64) -> Finding {
    if let Some(found) = absent(signals, human) {
        return found;
    }
    let from = match since_act(signals, human, &Action::Block) {
        Ok(from) => from,
        Err(never) => return never,
    };
    let end = signals.arrived_s.unwrap_or(f64::INFINITY);
    let marks = signals.of(human).iter().filter(|moment| moment.t <= end).map(block_mark).collect();
    let what = format!("in the robot's way within {BLOCK_M} m for {for_s:.1} s");
    from.told(lasting(signals, human, from.marks(marks), for_s, 4.0, &what))
}

/// The human has stopped and looks at the robot for some time.
pub(super) fn looks(signals: &Signals<'_>, human: HumanId, for_s: f64) -> Finding {
    if let Some(found) = absent(signals, human) {
        return found;
    }
    let from = match since_act(signals, human, &Action::LookAtRobot) {
        Ok(from) => from,
        Err(never) => return never,
    };
    // A human who looks by a rule looks while its leaf runs; one who only happens to face the robot was not startled.
    let by_rule = signals.tells_leaves_of(human)
        && signals
            .evidence
            .proposal
            .and_then(|proposal| proposal.human(human))
            .is_some_and(|human| human.rules.iter().any(|rule| rule.act == Action::LookAtRobot));
    // A human who looks before they could see anything was not startled by the robot.
    let seen_s = signals.of(human).iter().find(|moment| moment.sight != Some(false)).map_or(f64::INFINITY, |m| m.t);
    let runs = |t: f64| {
        let spans = signals.leaves_of(human).iter();
        let caused = spans.filter(|span| Action::LookAtRobot.is_leaf(&span.name) && span.from_s >= seen_s - EARLY_SECS);
        caused.into_iter().any(|span| t >= span.from_s && t <= span.to_s)
    };
    let mut marks = look_marks(signals.of(human), |t| !by_rule || runs(t));
    // Somebody who stood there facing that way all the time did not stop or turn to look. By their tree they turn however little.
    let turned_rad = if by_rule { TURNED_LITTLE_RAD } else { TURNED_RAD };
    let mut idle = stretches(marks.iter().copied(), 0.0);
    idle.retain(|span| !stops_or_turns(signals, human, *span, turned_rad));
    for mark in &mut marks {
        if idle.iter().any(|(from, to)| mark.t >= *from && mark.t <= *to) {
            mark.margin = mark.margin.min(-0.1);
        }
    }
    let what = format!("stopped and looking at the robot for {for_s:.1} s");
    from.told(lasting(signals, human, from.marks(marks), for_s, GESTURE_M, &what))
}

/// Somebody who was faster than this shortly before has stopped, m/s, and one who turns by more has turned, rad (15°).
const WALKED_MPS: f64 = 0.2;
const TURNED_RAD: f64 = 0.26;
/// Somebody who stands the right way by chance does not turn as much as this, rad (2°).
const TURNED_LITTLE_RAD: f64 = 0.03;
/// Shortly before is so long before, s.
const BEFORE_SECS: f64 = 2.0;

/// Whether a human stops for a stretch of time, or turns shortly before or in it.
fn stops_or_turns(signals: &Signals<'_>, human: HumanId, (from, to): (f64, f64), turned_rad: f64) -> bool {
    let Some(track) = signals.tracks.human(human) else { return false };
    let within = |sample: &&Sample| sample.t >= from - BEFORE_SECS && sample.t <= to;
    let Some(first) = track.present().find(within) else { return false };
    let mut all = track.present().filter(within);
    all.any(|sample| sample.speed() > WALKED_MPS || wrap_angle(sample.yaw - first.yaw).abs() > turned_rad)
}

/// The human stands still for some time; where that is a reaction, after its reason.
pub(super) fn stands_still(signals: &Signals<'_>, human: HumanId, for_s: f64) -> Finding {
    let Some(track) = signals.tracks.human(human) else {
        return Finding::fails(-1.0, vec![], format!("{human} is not in the recording"));
    };
    let from = match since_act(signals, human, &Action::StandStill) {
        Ok(from) => from,
        Err(never) => return never,
    };
    // A human who stands at the end of their path, or waits to set off, walks as far as their tree is concerned.
    let walking: Vec<&LeafSpan> =
        signals.leaves_of(human).iter().filter(|span| Action::Navigate.is_leaf(&span.name)).collect();
    let walks = |t: f64| from.is_reaction() && walking.iter().any(|span| t > span.from_s && t < span.to_s);
    let mark = |sample: &Sample| {
        let margin = MOVING_MPS - sample.speed();
        Mark::new(sample.t, if walks(sample.t) { margin.min(-MOVING_MPS) } else { margin })
    };
    let mut marks = from.marks(track.present().map(mark).collect());
    let apart = |from: f64, to: f64| {
        let moments = signals.of(human).iter().filter(|moment| moment.t >= from && moment.t <= to);
        moments.map(|moment| moment.distance_m).fold(f64::INFINITY, f64::min)
    };
    // Somebody who stood before there was a reason does not stand for it, unless their tree says so.
    let stood_before = |since: f64, to: f64| {
        let mut acts = signals.leaves_of(human).iter();
        let by_tree = acts.any(|span| span.from_s < to && span.to_s > since);
        let before = from.is_reaction() && from.secs() >= since - EARLY_SECS;
        before && !by_tree && !stops_or_turns(signals, human, (since, since), TURNED_RAD)
    };
    let robot = !signals.of(human).is_empty();
    for (since, to) in stretches(marks.iter().copied(), 0.0) {
        if robot && apart(since, to) > STANDS_REACH_M || stood_before(since, to) {
            for mark in marks.iter_mut().filter(|mark| mark.t >= since && mark.t <= to) {
                mark.margin = mark.margin.min(-MOVING_MPS);
            }
        }
    }
    let longest = longest_s(marks.iter().copied());
    let text = format!(
        "{human} stands still (below {MOVING_MPS} m/s) for {longest:.1} s without a break ({for_s:.1} s asked)"
    );
    let found = match held(marks, for_s, 0.0) {
        Some(found) => Finding::by_margin(
            if found.first_s.is_some() { longest - for_s } else { (longest - for_s).min(found.margin) },
            vec![found.first_s.unwrap_or(found.best_s)],
            text,
        ),
        None => Finding::fails(longest - for_s, vec![], text),
    };
    from.told(found.shifted(longest - for_s))
}

/// The human gets away from the robot by its own motion.
pub(super) fn runs_away(signals: &Signals<'_>, human: HumanId, by_m: f64) -> Finding {
    if let Some(found) = absent(signals, human) {
        return found;
    }
    let since = match since_act(signals, human, &Action::RunAway) {
        Ok(from) => from,
        Err(never) => return never,
    };
    let moments = signals.of(human);
    let mut onsets = seen(signals, human, &Action::RunAway);
    onsets.retain(|onset| since.counts(*onset));
    let Some(nearest) = moments.iter().min_by(|a, b| a.distance_m.total_cmp(&b.distance_m)) else {
        return Finding::not_applicable("the recording is empty");
    };
    let mut top: Option<(f64, f64, f64)> = None;
    for from in &onsets {
        let Some(start) = moments.iter().find(|moment| moment.t >= *from) else { continue };
        for later in moments.iter().filter(|moment| moment.t > *from && moment.t <= from + FLEE_SECS) {
            // The way must be the human's own: a robot that drives off makes nobody flee.
            let own = (later.human.at - start.human.at).dot(&start.away());
            let gained = (later.distance_m - start.distance_m).min(own * 2.0);
            if top.is_none_or(|(old, _, _)| gained > old) {
                top = Some((gained, *from, later.t));
            }
        }
    }
    match top {
        Some((gained, from, to)) => {
            let text = format!("{human} gained {gained:.1} m from {from:.1} s to {to:.1} s ({by_m:.1} m asked)");
            Finding::by_margin(gained - by_m, vec![from, to], text)
        }
        None if nearest.distance_m > GESTURE_M => {
            let text = format!("{human} never came near: closest {:.1} m at {:.1} s", nearest.distance_m, nearest.t);
            Finding::never(-by_m, vec![nearest.t], text)
        }
        None => {
            let text = format!("{human} never ran away from the robot");
            since.undone(signals, human, Finding::fails(-by_m, vec![nearest.t], text))
        }
    }
}

/// The agent makes the gesture where the other can notice it.
pub(super) fn gestures(signals: &Signals<'_>, agent: AgentId, gesture: Gesture) -> Finding {
    let Some(track) = signals.track(agent) else {
        return match agent {
            AgentId::Robot => Finding::not_applicable("there is no robot in the recording"),
            AgentId::Human(id) => Finding::fails(-1.0, vec![], format!("{id} is not in the recording")),
        };
    };
    let mut times: Vec<f64> = signals
        .evidence
        .recording
        .events
        .iter()
        .filter(|event| {
            matches!(&event.kind, EventKind::Gesture { agent: who, gesture: Some(made), .. } if (*who, *made) == (agent, gesture))
        })
        .map(|event| event.time.secs())
        .filter(|t| shows(signals, agent, gesture, *t))
        .collect();
    times.extend(track.samples.iter().find(|sample| sample.gesture == Some(gesture)).map(|sample| sample.t));
    times.sort_by(f64::total_cmp);
    if let AgentId::Human(id) = agent
        && let Some(early) = before_reason(signals, id, gesture, &mut times)
    {
        return early;
    }
    let reach = |t: f64| -> Option<f64> {
        let me = track.at(t)?;
        let others: Vec<f64> = match agent {
            AgentId::Robot => signals.tracks.humans.iter().filter_map(|h| Some((h.at(t)?.at - me.at).norm())).collect(),
            AgentId::Human(id) => {
                // A human may speak to another human where the proposal says so; else to the robot.
                let listeners = listeners(signals, id, gesture);
                let to = signals.tracks.robot.iter().chain(
                    signals.tracks.humans.iter().filter(|h| h.human().is_some_and(|other| listeners.contains(&other))),
                );
                to.filter_map(|other| Some((other.at(t)?.at - me.at).norm())).collect()
            }
        };
        others.into_iter().min_by(f64::total_cmp)
    };
    let nearest = times
        .iter()
        .filter_map(|t| Some((reach(*t)?, *t)))
        .min_by(|a, b| (a.0 > GESTURE_M).cmp(&(b.0 > GESTURE_M)).then(a.1.total_cmp(&b.1)));
    match nearest {
        Some((distance, t)) => {
            let text =
                format!("{agent} says {gesture} at {t:.1} s, listener {distance:.1} m away (at most {GESTURE_M:.0} m)");
            let near = Finding::by_margin(GESTURE_M - distance, vec![t], text.clone());
            // What is said for a reason is said when there is the reason.
            match agent {
                AgentId::Human(id) if near.margin >= 0.0 => match said_after(signals, id, gesture, t) {
                    Some(delay) if delay > SAID_SECS => {
                        timely(delay, SAID_SECS, vec![t], format!("{text}, {delay:.1} s after its reason"))
                    }
                    Some(delay) if delay < 0.0 => {
                        Finding::fails(delay, vec![t], format!("{text}, {:.1} s too early", -delay))
                    }
                    Some(delay) => near.shifted(SAID_SECS - delay),
                    None => near,
                },
                AgentId::Human(_) | AgentId::Robot => near,
            }
        }
        None => {
            let silent = Finding::never(-1.0, vec![], format!("{agent} never says {gesture}"));
            let AgentId::Human(human) = agent else { return silent };
            match since(signals, human, |rule| rule.gesture == Some(gesture)) {
                Ok(_) => silent,
                Err(never) => Finding::never(-1.0, vec![], format!("{}; {}", silent.evidence, never.evidence))
                    .missing(never.missed),
            }
        }
    }
}

/// Takes the times out at which a human makes a gesture before its reason; the finding where no other is left.
fn before_reason(signals: &Signals<'_>, human: HumanId, gesture: Gesture, times: &mut Vec<f64>) -> Option<Finding> {
    let first = times.first().copied()?;
    let early = |why: String| Finding::fails(-1.0, vec![first], why).too_early();
    match since(signals, human, |rule| rule.gesture == Some(gesture)) {
        Ok(from) => {
            times.retain(|t| from.counts(*t));
            let text =
                || from.told(early(format!("{human} says {gesture} at {first:.1} s, only before the reason for it")));
            times.is_empty().then(text)
        }
        Err(never) => Some(early(format!("{human} says {gesture} at {first:.1} s; {}", never.evidence))),
    }
}

fn listeners(signals: &Signals<'_>, speaker: HumanId, gesture: Gesture) -> Vec<HumanId> {
    let Some(proposal) = signals.evidence.proposal else { return Vec::new() };
    proposal
        .humans
        .iter()
        .filter(|human| {
            human.rules.iter().any(|rule| rule.when.contains(&socrates_model::Trigger::HumanSays(speaker, gesture)))
        })
        .map(|human| human.id)
        .collect()
}

/// Marks of an action as the motion alone shows it, with the time for which it must be kept.
pub(super) fn motion(signals: &Signals<'_>, human: HumanId, action: &Action) -> (Vec<Mark>, f64) {
    let moments = signals.of(human);
    let follow = |leader: AgentId| -> Vec<Mark> {
        match (signals.track(leader), signals.tracks.human(human)) {
            (Some(lead), Some(behind)) => follow_marks(&gaps(lead, behind), [0.3, 4.0]),
            _ => Vec::new(),
        }
    };
    let speeds = |margin: fn(f64) -> f64| -> Vec<Mark> {
        signals.tracks.human(human).map_or_else(Vec::new, |track| {
            track.present().map(|sample| Mark::new(sample.t, margin(sample.speed()))).collect()
        })
    };
    match action {
        Action::Navigate => (speeds(|speed| speed - 0.2), 0.5),
        Action::StandStill => (speeds(|speed| MOVING_MPS - speed), 0.5),
        Action::FollowRobot => (follow(AgentId::Robot), 1.5),
        Action::FollowHuman(id) => (follow(AgentId::Human(*id)), 1.5),
        Action::RunAway => (moments.iter().map(flee_mark).collect(), 0.5),
        Action::GiveWay | Action::MakeRoom => {
            // Aside already or stepping aside: both leave the line free.
            let marks = moments.iter().map(|m| Mark::new(m.t, m.off_line_m().min(m.distance_m) - (ASIDE_M - 0.1)));
            (marks.collect(), 0.3)
        }
        Action::Block => (moments.iter().map(block_mark).collect(), 0.5),
        Action::LookAtRobot => (look_marks(moments, |_| true), 0.5),
        Action::TurnAway => {
            let marks = moments.iter().map(|m| {
                let back = m.human.bearing(&m.robot.at).abs() - AWAY_RAD;
                Mark::new(m.t, back.min((MOVING_MPS - m.human.speed()) / MOVING_MPS))
            });
            (marks.collect(), 0.5)
        }
        Action::LookAt(id) => (addressed::watch_marks(signals, human, AgentId::Human(*id)), 0.5),
        Action::TurnBack | Action::ComeBack | Action::GoTo(_) | Action::ChangePace(_) => {
            (speeds(|speed| speed - 0.1), 0.5)
        }
        Action::ApproachTo(near_m) => {
            let reach_m = near_m + Action::CLOSE_M;
            (moments.iter().map(|m| Mark::new(m.t, reach_m - m.distance_m)).collect(), 0.3)
        }
        Action::Approach => {
            let marks = moments.iter().map(|m| {
                let nearing = -m.human.velocity.dot(&m.away()) - 0.2;
                let there = if m.human.speed() < MOVING_MPS { 1.6 - m.distance_m } else { -1.0 };
                Mark::new(m.t, nearing.max(there))
            });
            (marks.collect(), 0.5)
        }
    }
}

/// Times at which the action begins, in order.
pub(super) fn seen(signals: &Signals<'_>, human: HumanId, action: &Action) -> Vec<f64> {
    spans(signals, human, action).into_iter().map(|(from, _)| from).collect()
}

/// The motion may last so much longer than the leaf that began it, s.
const AFTER_LEAF_SECS: f64 = 1.0;

/// Times from which and up to which the action is seen, in order. Where the recording tells leaves, a leaf that does the
/// action and the motion to be seen while it runs are both needed; else the motion alone decides.
pub(super) fn spans(signals: &Signals<'_>, human: HumanId, action: &Action) -> Vec<(f64, f64)> {
    let (marks, kept_s) = motion(signals, human, action);
    let shown = stretches(marks, kept_s);
    let leaves = signals.leaves_of(human);
    if leaves.is_empty() && !signals.tells_leaves_of(human) {
        if *action == Action::RunAway {
            return turns_away(signals, human, &shown);
        }
        return shown.into_iter().filter(|span| moves_for(signals, human, action, *span)).collect();
    }
    let seen = |span: &LeafSpan| {
        let latest_s = span.to_s + AFTER_LEAF_SECS;
        let fits = |(from, to): &&(f64, f64)| *from <= latest_s && *to >= span.from_s + kept_s.min(0.3);
        shown.iter().rfind(fits).map(|(_, to)| (span.from_s, to.min(latest_s)))
    };
    let done = leaves.iter().filter(|span| action.is_leaf(&span.name)).filter_map(seen);
    done.filter(|span| moves_for(signals, human, action, *span)).collect()
}

/// Somebody who follows, comes up to the robot, gets away from it or out of its way goes so far for it by themselves, m.
const FOLLOWS_M: f64 = 0.5;
const GOES_M: f64 = 0.3;
const STEPS_ASIDE_M: f64 = 0.2;
/// What the motion shows may begin a little sooner than what the log tells, and last longer, s.
const AROUND_SECS: f64 = 0.5;

/// Whether an act that consists of a motion has one of the human's own: what the robot does by itself is none.
fn moves_for(signals: &Signals<'_>, human: HumanId, action: &Action, (from, to): (f64, f64)) -> bool {
    let moments =
        || signals.of(human).iter().filter(|moment| moment.t >= from - AROUND_SECS && moment.t <= to + AROUND_SECS);
    let way_m = || moments().zip(moments().skip(1)).map(|(a, b)| (b.human.at - a.human.at).norm()).sum::<f64>();
    let Some(begin) = moments().next() else { return true };
    let most = |line: Vector, either: bool| {
        let along = moments().map(|moment| line.dot(&(moment.human.at - begin.human.at)));
        along.map(|way| if either { way.abs() } else { way }).fold(0.0, f64::max)
    };
    match action {
        Action::FollowRobot | Action::FollowHuman(_) => way_m() >= FOLLOWS_M,
        Action::Approach | Action::ApproachTo(_) => way_m() >= GOES_M,
        Action::RunAway => most(begin.away(), false) >= GOES_M,
        Action::GiveWay | Action::MakeRoom => {
            let facing = begin.robot.facing();
            most(Vector::new(-facing.y, facing.x), true) >= STEPS_ASIDE_M
        }
        Action::TurnBack | Action::ComeBack | Action::GoTo(_) => way_m() >= GOES_M,
        // Somebody who stands there facing the robot all the time has not looked up. By their tree they turn however little.
        Action::LookAtRobot => {
            let turned_rad = if signals.tells_leaves_of(human) { TURNED_LITTLE_RAD } else { TURNED_RAD };
            stops_or_turns(signals, human, (from, to), turned_rad)
        }
        Action::Navigate | Action::StandStill | Action::TurnAway => true,
        Action::Block | Action::LookAt(_) | Action::ChangePace(_) => true,
    }
}

/// Without leaves, walking away after passing looks like fleeing: only a change of velocity away from
/// the robot, of at least 0.4 m/s within 2 s, begins a flight.
fn turns_away(signals: &Signals<'_>, human: HumanId, shown: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let Some(track) = signals.tracks.human(human) else { return Vec::new() };
    shown
        .iter()
        .filter(|(from, _)| {
            let moment = signals.of(human).iter().find(|moment| moment.t >= *from);
            let before = track.at((from - 1.0).max(0.0));
            let after = track.at(from + 1.0).or_else(|| track.samples.last().copied());
            match (moment, before, after) {
                (Some(moment), Some(before), Some(after)) => {
                    (after.velocity - before.velocity).dot(&moment.away()) >= 0.4
                }
                _ => false,
            }
        })
        .copied()
        .collect()
}

/// Whether a delay is within its limit, late, or too long.
pub(super) fn timely(delay: f64, limit: f64, times: Vec<f64>, text: String) -> Finding {
    let finding = if delay <= limit {
        Finding::holds(limit - delay, times, text)
    } else if delay <= LATE_FACTOR * limit + 1.0 {
        Finding::late(limit - delay, times, text)
    } else {
        Finding::fails(limit - delay, times, text)
    };
    finding.shifted(limit - delay)
}
