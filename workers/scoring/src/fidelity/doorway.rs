//! Monitors of doors and lines of sight: leaves, enters, stays inside, door opens, hidden until, robot enters last,
//! robot leaves first, one before another.

use socrates_model::{Action, AgentId, HumanId, NodeId, Relation};

use crate::fidelity::doors::Crossing;
use crate::fidelity::finding::Finding;
use crate::fidelity::meeting::absent;
use crate::fidelity::openings::{destination, from_node, lines_of};
use crate::fidelity::setting::in_order;
use crate::fidelity::signals::{Moment, Signals};
use crate::temporal::{Signal, Within};
use crate::tracks::{Sample, Track};

/// Somebody nearer to a door line than this is on the threshold, m.
const THRESHOLD_M: f64 = 0.15;
/// Distances from a map's pixels are no better than this, m.
const SIGHT_SLACK_M: f64 = 0.3;
/// A door lets through a line of sight so long before its opening is told, s.
const OPENING_SECS: f64 = 0.1;

fn person<'a>(signals: &'a Signals<'_>, human: HumanId) -> Result<&'a Track, Finding> {
    signals.tracks.human(human).ok_or_else(|| Finding::fails(-1.0, vec![], format!("{human} is not in the recording")))
}

/// The human starts inside and crosses the door line outward exactly once.
pub(super) fn leaves(signals: &Signals<'_>, human: HumanId, door: &str) -> Result<Finding, Finding> {
    let track = person(signals, human)?;
    let lines = lines_of(signals, door, Some(human))?;
    let Some(start) = track.samples.first() else { return Err(Finding::not_applicable("the recording is empty")) };
    let (depth, name) = (lines.depth_m(&start.at), lines.name());
    if depth < THRESHOLD_M {
        let text = format!("{human} starts {:.1} m outside the door {name}", -depth);
        return Ok(Finding::fails(depth.min(-0.01), vec![0.0], text));
    }
    let found = lines.crossings(&track.samples);
    let out: Vec<f64> = found.iter().filter(|(crossing, _)| crossing.outward).map(|(crossing, _)| crossing.t).collect();
    let end = track.samples.last().map_or(0.0, |sample| -lines.depth_m(&sample.at));
    let list = out.iter().map(|t| format!("{t:.1} s")).collect::<Vec<_>>().join(", ");
    match (out.as_slice(), found.as_slice()) {
        ([at], [(_, line)]) => {
            let text = format!("{human} leaves through `{line}` at {at:.1} s");
            Ok(Finding::by_margin(end.max(0.05), vec![*at], text))
        }
        ([], _) => {
            let text = format!("{human} never leaves through {name}: still {:.1} m inside at the end", -end);
            Ok(Finding::fails(end.min(-0.05), vec![], text))
        }
        _ => {
            let text = format!("{human} crosses the door {name} {} times (out at {list}); once asked", found.len());
            Ok(Finding::fails(-1.0, out, text))
        }
    }
}

/// The human starts outside and crosses the door line inward exactly once.
pub(super) fn enters(signals: &Signals<'_>, human: HumanId, door: &str) -> Result<Finding, Finding> {
    let track = person(signals, human)?;
    let lines = if door.is_empty() { destination(signals, human)? } else { lines_of(signals, door, None)? };
    let Some(start) = track.samples.first() else { return Err(Finding::not_applicable("the recording is empty")) };
    let (depth, name) = (lines.depth_m(&start.at), lines.name());
    let found = lines.crossings(&track.samples);
    let inward: Vec<f64> =
        found.iter().filter(|(crossing, _)| !crossing.outward).map(|(crossing, _)| crossing.t).collect();
    let end = track.samples.last().map_or(0.0, |sample| lines.depth_m(&sample.at));
    let list = inward.iter().map(|t| format!("{t:.1} s")).collect::<Vec<_>>().join(", ");
    match (inward.as_slice(), found.as_slice()) {
        ([at], [(_, line)]) => {
            let text = format!("{human} enters through `{line}` at {at:.1} s");
            Ok(Finding::by_margin(end.max(0.05), vec![*at], text))
        }
        ([], []) if depth > 0.0 && end > 0.0 => {
            let text = format!("{human} starts {depth:.1} m inside the door {name}");
            Ok(Finding::fails((-depth).min(-0.01), vec![0.0], text))
        }
        ([], _) => {
            let text = format!("{human} never enters through {name}: {:.1} m outside at the end", -end);
            Ok(Finding::fails(end.min(-0.05), vec![], text))
        }
        _ => {
            let text = format!("{human} crosses the door {name} {} times (in at {list}); once asked", found.len());
            Ok(Finding::fails(-1.0, inward, text))
        }
    }
}

/// The human is behind the door for the whole run.
pub(super) fn stays_inside(signals: &Signals<'_>, human: HumanId, door: &str) -> Result<Finding, Finding> {
    let track = person(signals, human)?;
    let lines = lines_of(signals, door, Some(human))?;
    let out = lines.crossings(&track.samples).into_iter().map(|(crossing, _)| crossing).find(|found| found.outward);
    let least = track.samples.iter().map(|s| (lines.depth_m(&s.at), s.t)).min_by(|a, b| a.0.total_cmp(&b.0));
    let (depth, at) = least.unwrap_or((0.0, 0.0));
    let name = lines.name();
    let text = match out {
        Some(crossing) => format!("{human} crosses the door {name} outward at {:.1} s", crossing.t),
        None => format!("{human} stays at least {depth:.2} m behind the door {name} (at {at:.1} s)"),
    };
    let margin = if out.is_some() { depth.min(-0.01) } else { depth };
    Ok(Finding::by_margin(margin, vec![out.map_or(0.0, |crossing| crossing.t)], text))
}

/// The door opens while the robot is within a range of distances.
pub(super) fn door_opens(signals: &Signals<'_>, door: &str, robot_m: [f64; 2]) -> Result<Finding, Finding> {
    let lines = lines_of(signals, door, None)?;
    let Some(robot) = &signals.tracks.robot else {
        return Err(Finding::not_applicable("there is no robot in the recording"));
    };
    let declared = signals.evidence.location.map_or_else(Vec::new, |location| lines.declared(location));
    let opened = lines.first_open(signals).map(|(door, _)| door);
    let Some(door) = opened.or_else(|| declared.first().copied()) else {
        return Err(Finding::not_applicable(format!("{} is an opening without a door", lines.name())));
    };
    if signals.doors.stands_open(&door.id) {
        return Err(Finding::not_applicable(format!("the door `{}` stands open for the whole run", door.id)));
    }
    let [low, high] = robot_m;
    let middle = door.middle();
    let Some(t) = signals.doors.first_open_s(&door.id) else {
        let near = robot.samples.iter().map(|s| (s.at - middle).norm()).fold(f64::INFINITY, f64::min);
        let text = format!("the door `{}` never opens; the robot comes within {near:.1} m of it", door.id);
        return Ok(Finding::never(-1.0, vec![], text));
    };
    let distance = robot.at(t).or_else(|| robot.samples.last().copied()).map_or(f64::NAN, |s| (s.at - middle).norm());
    let text =
        format!("`{}` opens at {t:.1} s with the robot {distance:.1} m away ({low:.1} to {high:.1} m asked)", door.id);
    // For how long around the opening the robot is where it should be.
    let inside = |s: &&Sample| (low..=high).contains(&(s.at - middle).norm());
    let before = robot.samples.iter().rev().skip_while(|s| s.t > t).take_while(inside).last();
    let after = robot.samples.iter().skip_while(|s| s.t < t).take_while(inside).last();
    let room = before.map_or(0.0, |s| t - s.t).min(after.map_or(0.0, |s| s.t - t));
    let finding = Finding::by_margin((distance - low).min(high - distance), vec![t], text);
    Ok(if finding.margin >= 0.0 { finding.shifted(room) } else { finding })
}

/// Largest distance at which a person is noticed, m.
const NOTICED_M: f64 = 12.0;

/// No line of sight until they are near, or until the door opens.
pub(super) fn hidden_until(signals: &Signals<'_>, human: HumanId, within_m: f64) -> Result<Finding, Finding> {
    if let Some(found) = absent(signals, human) {
        return Err(found);
    }
    if signals.field.is_none() {
        return Err(Finding::not_applicable("there is no map to look for lines of sight"));
    }
    // A person far away down a long way is not noticed.
    let sees = |moment: &Moment| moment.sight == Some(true) && moment.distance_m <= NOTICED_M;
    let first = signals.of(human).iter().find(|moment| sees(moment));
    let Some(first) = first else {
        return Ok(Finding::never(
            -1.0,
            vec![],
            format!("there is never a line of sight between {human} and the robot"),
        ));
    };
    let lines = lines_of(signals, "", Some(human)).ok();
    let opened = lines.as_ref().and_then(|lines| lines.first_open(signals));
    // Hidden until seen near by, or through the open door: (not seen) U (seen and (near or open)). Seen or not has no
    // size of its own, so that the margin is that of the distance, or of the time since the door opened.
    let moments = signals.of(human);
    let limit = within_m + SIGHT_SLACK_M;
    let crisp = |moment: &Moment| if sees(moment) { f64::INFINITY } else { f64::NEG_INFINITY };
    let seen: Signal = moments.iter().map(|moment| (moment.t, crisp(moment))).collect();
    let near: Signal = moments.iter().map(|moment| (moment.t, limit - moment.distance_m)).collect();
    let open_s = opened.as_ref().map_or(f64::INFINITY, |(_, t)| t - OPENING_SECS);
    let open: Signal = moments.iter().map(|moment| (moment.t, moment.t - open_s)).collect();
    let margin = seen.not().until(&seen.and(&near.or(&open)), Within::EVER).now().unwrap_or(f64::NEG_INFINITY);
    let mut text = format!("first line of sight at {:.1} s from {:.1} m", first.t, first.distance_m);
    let mut times = vec![first.t];
    match opened.filter(|(_, t)| first.t >= t - OPENING_SECS) {
        Some((door, t)) => {
            text.push_str(&format!(", after the door `{}` opened at {t:.1} s", door.id));
            times.push(t);
        }
        None => text.push_str(&format!(" (at most {within_m:.1} m asked)")),
    }
    // How much sooner the sight could come: up to when they were as near, or the door opened.
    let near_s = moments.iter().rev().skip_while(|m| m.t >= first.t).take_while(|m| m.distance_m <= limit).last();
    let since = near_s.map_or(first.t, |moment| moment.t).min(open_s);
    let finding = Finding::by_margin(margin, times, text);
    Ok(if margin >= 0.0 { finding.shifted(first.t - since) } else { finding })
}

/// The robot crosses the door line inward only after everybody who leaves is out.
pub(super) fn robot_enters_last(signals: &Signals<'_>) -> Result<Finding, Finding> {
    let lines = lines_of(signals, "", None)?;
    let Some(robot) = &signals.tracks.robot else {
        return Err(Finding::not_applicable("there is no robot in the recording"));
    };
    let crossings = |samples: &[Sample]| -> Vec<Crossing> {
        lines.crossings(samples).into_iter().map(|(crossing, _)| crossing).collect()
    };
    let name = lines.name();
    let entry = crossings(&robot.samples).into_iter().find(|crossing| !crossing.outward);
    let mut last: Option<(f64, AgentId)> = None;
    let mut inside_still = Vec::new();
    for track in &signals.tracks.humans {
        let leaves = track.human().and_then(|id| signals.evidence.proposal?.human(id)).map(|human| human.relation);
        let out = crossings(&track.samples).into_iter().filter(|crossing| crossing.outward).map(|c| c.t).next_back();
        match out {
            Some(t) if last.is_none_or(|(old, _)| t > old) => last = Some((t, track.agent)),
            None if leaves == Some(Relation::Leaving) => inside_still.push(track.agent.to_string()),
            Some(_) | None => {}
        }
    }
    let Some(entry) = entry else {
        return Ok(Finding::never(-1.0, vec![], format!("the robot never enters through {name}")));
    };
    if !inside_still.is_empty() {
        let text = format!("the robot enters {name} at {:.1} s, {} never left", entry.t, inside_still.join(", "));
        return Ok(Finding::fails(-1.0, vec![entry.t], text));
    }
    Ok(match last {
        Some((t, who)) => {
            let text = format!("the robot enters {name} at {:.1} s, {who} left last at {t:.1} s", entry.t);
            Finding::by_margin(entry.t - t, vec![entry.t, t], text)
        }
        None => Finding::never(-1.0, vec![entry.t], format!("nobody leaves through {name}")),
    })
}

/// One gets through the door before the other: the door of whoever comes out, else of whoever goes in.
pub(super) fn before(signals: &Signals<'_>, first: AgentId, then: AgentId) -> Result<Finding, Finding> {
    let humans =
        || [first, then].into_iter().filter_map(|agent| if let AgentId::Human(id) = agent { Some(id) } else { None });
    let comes_out = |id: &HumanId| {
        let human = signals.evidence.proposal.and_then(|proposal| proposal.human(*id));
        human.is_some_and(|human| matches!(human.relation, Relation::Leaving | Relation::Staying))
    };
    let lines = match humans().find(comes_out) {
        Some(human) => lines_of(signals, "", Some(human))?,
        None => match (humans().next(), humans().find_map(|human| led_to(signals, human))) {
            _ if [first, then].contains(&AgentId::Robot) => lines_of(signals, "", None)?,
            (Some(_), Some(node)) => from_node(signals, Some(node))?,
            (Some(human), None) => destination(signals, human)?,
            (None, _) => lines_of(signals, "", None)?,
        },
    };
    let name = lines.name();
    let mut times = Vec::new();
    for agent in [first, then] {
        let track = match agent {
            AgentId::Human(id) => person(signals, id)?,
            AgentId::Robot => match &signals.tracks.robot {
                Some(robot) => robot,
                None => return Err(Finding::not_applicable("there is no robot in the recording")),
            },
        };
        // Somebody who comes out goes through it outward, whoever goes in inward; the robot may do either.
        let wanted = |crossing: &Crossing| match agent {
            AgentId::Human(id) => crossing.outward == comes_out(&id),
            AgentId::Robot => true,
        };
        let mut through = lines.crossings(&track.samples).into_iter().filter(|(crossing, _)| wanted(crossing));
        let Some((crossing, _)) = through.next() else {
            return Ok(Finding::never(-1.0, vec![], format!("{agent} never gets through the door {name}")));
        };
        times.push(crossing.t);
    }
    let &[before, after] = times.as_slice() else { return Err(Finding::not_applicable("there is nobody to compare")) };
    Ok(in_order(before, after, format!("{first} gets through {name} at {before:.1} s, {then} at {after:.1} s")))
}

/// A node of the place to which a step leads a person.
fn led_to<'a>(signals: &Signals<'a>, human: HumanId) -> Option<&'a NodeId> {
    let rules = signals.evidence.proposal?.human(human).map(|human| &human.rules)?;
    rules.iter().find_map(|rule| if let Action::GoTo(to) = &rule.act { to.nodes.first() } else { None })
}

/// The robot is out of the door before the first human goes in.
pub(super) fn robot_leaves_first(signals: &Signals<'_>) -> Result<Finding, Finding> {
    let lines = from_node(signals, signals.evidence.paths.and_then(|paths| paths.robot.first()))?;
    let name = lines.name();
    let crossings = |samples: &[Sample]| -> Vec<Crossing> {
        lines.crossings(samples).into_iter().map(|(crossing, _)| crossing).collect()
    };
    let Some(robot) = &signals.tracks.robot else {
        return Err(Finding::not_applicable("there is no robot in the recording"));
    };
    let first = signals
        .tracks
        .humans
        .iter()
        .filter_map(|track| {
            let entry = crossings(&track.samples).into_iter().find(|crossing| !crossing.outward)?;
            Some((entry.t, track.agent))
        })
        .min_by(|a, b| a.0.total_cmp(&b.0));
    let exit = crossings(&robot.samples).into_iter().find(|crossing| crossing.outward);
    Ok(match (exit, first) {
        (None, Some((t, who))) => {
            let text = format!("{who} enters {name} at {t:.1} s, the robot never leaves");
            Finding::fails(-1.0, vec![t], text)
        }
        (None, None) => Finding::never(-1.0, vec![], format!("the robot never leaves through {name}")),
        (Some(exit), None) => Finding::never(-1.0, vec![exit.t], format!("nobody enters through {name}")),
        (Some(exit), Some((t, who))) => {
            let text = format!("the robot leaves {name} at {:.1} s, {who} enters first at {t:.1} s", exit.t);
            Finding::by_margin(t - exit.t, vec![exit.t, t], text)
        }
    })
}
