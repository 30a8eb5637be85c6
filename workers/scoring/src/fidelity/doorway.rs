//! Monitors of doors and lines of sight: leaves, enters, stays inside, door opens, hidden until, robot enters last,
//! robot leaves first.

use socrates_model::{AgentId, Door, HumanId, Location, NodeId, Point, Relation};

use crate::fidelity::doors::{crossings, inside_point};
use crate::fidelity::finding::Finding;
use crate::fidelity::meeting::absent;
use crate::fidelity::openings::{opening, way_out};
use crate::fidelity::signals::{Moment, Signals};
use crate::temporal::{Signal, Within};
use crate::tracks::{Sample, Track};

/// Somebody nearer to a door line than this is on the threshold, m.
const THRESHOLD_M: f64 = 0.15;
/// Distances from a map's pixels are no better than this, m.
const SIGHT_SLACK_M: f64 = 0.3;
/// A door lets through a line of sight so long before its opening is told, s.
const OPENING_SECS: f64 = 0.1;

/// The door a clause means, with a point behind it, or why there is none. A room without a door has an opening.
fn door_of(signals: &Signals<'_>, door: &str, human: Option<HumanId>) -> Result<(Door, Point), Finding> {
    let Some(place) = signals.evidence.location else {
        return Err(Finding::not_applicable("there is no map, so there are no doors"));
    };
    if door.is_empty()
        && let Some(id) = human
        && guess(signals, place, human).is_none()
        && let Some(found) = way_out_of(signals, place, id)
    {
        let inside = inside_point(&found, place);
        return inside
            .map(|inside| (found, inside))
            .ok_or_else(|| Finding::not_applicable("the opening has no inside"));
    }
    if place.doors.is_empty() {
        return Err(Finding::not_applicable(format!("the map `{}` declares no doors", place.name)));
    }
    let found = if door.is_empty() { guess(signals, place, human) } else { place.door(door) };
    let Some(found) = found else {
        let names: Vec<&str> = place.doors.iter().map(|door| door.id.as_str()).collect();
        let what =
            if door.is_empty() { "no door belongs to the clause".to_owned() } else { format!("no door `{door}`") };
        return Err(Finding::not_applicable(format!("{what}; the map has {}", names.join(", "))));
    };
    inside_point(found, place)
        .map(|inside| (found.clone(), inside))
        .ok_or_else(|| Finding::not_applicable(format!("the door `{}` names no node behind it", found.id)))
}

/// The door of a human's first node; else of an encounter, the robot's last node, or any human's first node.
fn guess<'a>(signals: &Signals<'a>, place: &'a Location, human: Option<HumanId>) -> Option<&'a Door> {
    let paths = signals.evidence.paths?;
    let first = |id: HumanId| paths.humans.get(&id).and_then(|nodes| nodes.first());
    if let Some(id) = human {
        return first(id).and_then(|node| place.door_of(node));
    }
    let meetings = paths.encounters.iter().map(|encounter| &encounter.node);
    let starts = paths.humans.values().filter_map(|nodes| nodes.first());
    meetings.chain(paths.robot.last()).chain(starts).find_map(|node| place.door_of(node))
}

/// The opening that somebody's way leads out through; for who stays, the nearest way out of its room.
fn way_out_of(signals: &Signals<'_>, place: &Location, human: HumanId) -> Option<Door> {
    let (way, field) = (signals.evidence.paths?.humans.get(&human)?, signals.field.as_ref()?);
    opening(place, field, way).or_else(|| opening(place, field, &way_out(&place.graph, way.first()?)?))
}

fn person<'a>(signals: &'a Signals<'_>, human: HumanId) -> Result<&'a Track, Finding> {
    signals.tracks.human(human).ok_or_else(|| Finding::fails(-1.0, vec![], format!("{human} is not in the recording")))
}

/// The human starts inside and crosses the door line outward exactly once.
pub(super) fn leaves(signals: &Signals<'_>, human: HumanId, door: &str) -> Result<Finding, Finding> {
    let track = person(signals, human)?;
    let (door, inside) = door_of(signals, door, Some(human))?;
    let Some(start) = track.samples.first() else { return Err(Finding::not_applicable("the recording is empty")) };
    let depth = door.depth_m(&start.at, &inside);
    if depth < THRESHOLD_M {
        let text = format!("{human} starts {:.1} m outside the door `{}`", -depth, door.id);
        return Ok(Finding::fails(depth.min(-0.01), vec![0.0], text));
    }
    let found = crossings(&door, &inside, &track.samples);
    let out: Vec<f64> = found.iter().filter(|crossing| crossing.outward).map(|crossing| crossing.t).collect();
    let end = track.samples.last().map_or(0.0, |sample| -door.depth_m(&sample.at, &inside));
    let list = out.iter().map(|t| format!("{t:.1} s")).collect::<Vec<_>>().join(", ");
    match (out.as_slice(), found.len()) {
        ([at], 1) => {
            let text = format!("{human} leaves through `{}` at {at:.1} s", door.id);
            Ok(Finding::by_margin(end.max(0.05), vec![*at], text))
        }
        ([], _) => {
            let text = format!("{human} never leaves through `{}`: still {:.1} m inside at the end", door.id, -end);
            Ok(Finding::fails(end.min(-0.05), vec![], text))
        }
        _ => {
            let text =
                format!("{human} crosses the door `{}` {} times (out at {list}); once asked", door.id, found.len());
            Ok(Finding::fails(-1.0, out, text))
        }
    }
}

/// The human starts outside and crosses the door line inward exactly once.
pub(super) fn enters(signals: &Signals<'_>, human: HumanId, door: &str) -> Result<Finding, Finding> {
    let track = person(signals, human)?;
    let (door, inside) = if door.is_empty() { destination(signals, human)? } else { door_of(signals, door, None)? };
    let Some(start) = track.samples.first() else { return Err(Finding::not_applicable("the recording is empty")) };
    let depth = door.depth_m(&start.at, &inside);
    let found = crossings(&door, &inside, &track.samples);
    let inward: Vec<f64> = found.iter().filter(|crossing| !crossing.outward).map(|crossing| crossing.t).collect();
    let end = track.samples.last().map_or(0.0, |sample| door.depth_m(&sample.at, &inside));
    let list = inward.iter().map(|t| format!("{t:.1} s")).collect::<Vec<_>>().join(", ");
    match (inward.as_slice(), found.len()) {
        ([at], 1) => {
            let text = format!("{human} enters through `{}` at {at:.1} s", door.id);
            Ok(Finding::by_margin(end.max(0.05), vec![*at], text))
        }
        ([], 0) if depth > 0.0 && end > 0.0 => {
            let text = format!("{human} starts {depth:.1} m inside the door `{}`", door.id);
            Ok(Finding::fails((-depth).min(-0.01), vec![0.0], text))
        }
        ([], _) => {
            let text = format!("{human} never enters through `{}`: {:.1} m outside at the end", door.id, -end);
            Ok(Finding::fails(end.min(-0.05), vec![], text))
        }
        _ => {
            let text =
                format!("{human} crosses the door `{}` {} times (in at {list}); once asked", door.id, found.len());
            Ok(Finding::fails(-1.0, inward, text))
        }
    }
}

/// The door that a human's way leads into: the one of its last node, else the opening of the room of that node, else
/// the nearest door to it.
fn destination(signals: &Signals<'_>, human: HumanId) -> Result<(Door, Point), Finding> {
    let usual = || door_of(signals, "", Some(human));
    let way = signals.evidence.paths.and_then(|paths| paths.humans.get(&human));
    let Some((place, way, last)) =
        signals.evidence.location.zip(way).and_then(|(place, way)| Some((place, way, way.last()?)))
    else {
        return usual();
    };
    if place.door_of(last).is_none() {
        let back: Vec<NodeId> = way.iter().rev().cloned().collect();
        let found = signals.field.as_ref().and_then(|field| opening(place, field, &back));
        if let Some(found) = found.and_then(|door| Some((inside_point(&door, place)?, door))) {
            return Ok((found.1, found.0));
        }
    }
    let near = || {
        let at = signals.node(last)?;
        place.doors.iter().min_by(|a, b| (a.middle() - at).norm().total_cmp(&(b.middle() - at).norm()))
    };
    place.door_of(last).or_else(near).map_or_else(usual, |door| door_of(signals, &door.id, None))
}

/// The human is behind the door for the whole run.
pub(super) fn stays_inside(signals: &Signals<'_>, human: HumanId, door: &str) -> Result<Finding, Finding> {
    let track = person(signals, human)?;
    let (door, inside) = door_of(signals, door, Some(human))?;
    let out = crossings(&door, &inside, &track.samples).into_iter().find(|crossing| crossing.outward);
    let least = track.samples.iter().map(|s| (door.depth_m(&s.at, &inside), s.t)).min_by(|a, b| a.0.total_cmp(&b.0));
    let (depth, at) = least.unwrap_or((0.0, 0.0));
    let text = match out {
        Some(crossing) => format!("{human} crosses the door `{}` outward at {:.1} s", door.id, crossing.t),
        None => format!("{human} stays at least {depth:.2} m behind the door `{}` (at {at:.1} s)", door.id),
    };
    let margin = if out.is_some() { depth.min(-0.01) } else { depth };
    Ok(Finding::by_margin(margin, vec![out.map_or(0.0, |crossing| crossing.t)], text))
}

/// The door opens while the robot is within a range of distances.
pub(super) fn door_opens(signals: &Signals<'_>, door: &str, robot_m: [f64; 2]) -> Result<Finding, Finding> {
    let (door, _) = door_of(signals, door, None)?;
    let Some(robot) = &signals.tracks.robot else {
        return Err(Finding::not_applicable("there is no robot in the recording"));
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

/// No line of sight until they are near, or until the door opens.
pub(super) fn hidden_until(signals: &Signals<'_>, human: HumanId, within_m: f64) -> Result<Finding, Finding> {
    if let Some(found) = absent(signals, human) {
        return Err(found);
    }
    if signals.field.is_none() {
        return Err(Finding::not_applicable("there is no map to look for lines of sight"));
    }
    let first = signals.of(human).iter().find(|moment| moment.sight == Some(true));
    let Some(first) = first else {
        return Ok(Finding::never(
            -1.0,
            vec![],
            format!("there is never a line of sight between {human} and the robot"),
        ));
    };
    let opened = door_of(signals, "", Some(human))
        .ok()
        .filter(|(door, _)| !signals.doors.stands_open(&door.id))
        .and_then(|(door, _)| signals.doors.first_open_s(&door.id).map(|t| (door, t)));
    // Hidden until seen near by, or through the open door: (not seen) U (seen and (near or open)). Seen or not has no
    // size of its own, so that the margin is that of the distance, or of the time since the door opened.
    let moments = signals.of(human);
    let limit = within_m + SIGHT_SLACK_M;
    let crisp = |moment: &Moment| if moment.sight == Some(true) { f64::INFINITY } else { f64::NEG_INFINITY };
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
    let (door, inside) = door_of(signals, "", None)?;
    let Some(robot) = &signals.tracks.robot else {
        return Err(Finding::not_applicable("there is no robot in the recording"));
    };
    let entry = crossings(&door, &inside, &robot.samples).into_iter().find(|crossing| !crossing.outward);
    let mut last: Option<(f64, AgentId)> = None;
    let mut inside_still = Vec::new();
    for track in &signals.tracks.humans {
        let leaves = track.human().and_then(|id| signals.evidence.proposal?.human(id)).map(|human| human.relation);
        let out = crossings(&door, &inside, &track.samples)
            .into_iter()
            .filter(|crossing| crossing.outward)
            .map(|c| c.t)
            .next_back();
        match out {
            Some(t) if last.is_none_or(|(old, _)| t > old) => last = Some((t, track.agent)),
            None if leaves == Some(Relation::Leaving) => inside_still.push(track.agent.to_string()),
            Some(_) | None => {}
        }
    }
    let Some(entry) = entry else {
        return Ok(Finding::never(-1.0, vec![], format!("the robot never enters through `{}`", door.id)));
    };
    if !inside_still.is_empty() {
        let text =
            format!("the robot enters `{}` at {:.1} s, {} never left", door.id, entry.t, inside_still.join(", "));
        return Ok(Finding::fails(-1.0, vec![entry.t], text));
    }
    Ok(match last {
        Some((t, who)) => {
            let text = format!("the robot enters `{}` at {:.1} s, {who} left last at {t:.1} s", door.id, entry.t);
            Finding::by_margin(entry.t - t, vec![entry.t, t], text)
        }
        None => Finding::never(-1.0, vec![entry.t], format!("nobody leaves through `{}`", door.id)),
    })
}

/// The robot is out of the door before the first human goes in.
pub(super) fn robot_leaves_first(signals: &Signals<'_>) -> Result<Finding, Finding> {
    let paths = signals.evidence.paths;
    let own = paths
        .and_then(|paths| paths.robot.first())
        .and_then(|node| signals.evidence.location?.door_of(node))
        .map_or(String::new(), |door| door.id.clone());
    let (door, inside) = door_of(signals, &own, None)?;
    let Some(robot) = &signals.tracks.robot else {
        return Err(Finding::not_applicable("there is no robot in the recording"));
    };
    let first = signals
        .tracks
        .humans
        .iter()
        .filter_map(|track| {
            let entry = crossings(&door, &inside, &track.samples).into_iter().find(|crossing| !crossing.outward)?;
            Some((entry.t, track.agent))
        })
        .min_by(|a, b| a.0.total_cmp(&b.0));
    let exit = crossings(&door, &inside, &robot.samples).into_iter().find(|crossing| crossing.outward);
    Ok(match (exit, first) {
        (None, Some((t, who))) => {
            let text = format!("{who} enters `{}` at {t:.1} s, the robot never leaves", door.id);
            Finding::fails(-1.0, vec![t], text)
        }
        (None, None) => Finding::never(-1.0, vec![], format!("the robot never leaves through `{}`", door.id)),
        (Some(exit), None) => Finding::never(-1.0, vec![exit.t], format!("nobody enters through `{}`", door.id)),
        (Some(exit), Some((t, who))) => {
            let text = format!("the robot leaves `{}` at {:.1} s, {who} enters first at {t:.1} s", door.id, exit.t);
            Finding::by_margin(t - exit.t, vec![exit.t, t], text)
        }
    })
}
