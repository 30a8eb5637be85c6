//! Monitors of the setting: how many humans, where and when the encounter is, who starts at and who reaches a node.

use socrates_model::{AgentId, HumanId, NodeId, PlaceClass, Point, Relation};

use crate::fidelity::finding::Finding;
use crate::fidelity::gaps::ARRIVED_M;
use crate::fidelity::meeting::{LATE_FACTOR, MEET_NODE_M, absent};
use crate::fidelity::robot::held_on_request_s;
use crate::fidelity::signals::{Moment, Signals};
use crate::tracks::{MOVING_MPS, Sample, Track};

/// Who is there less than this before another is there at the same time, s.
pub(super) const BEFORE_S: f64 = 0.3;
/// An encounter is at its place where the human is this near to the node, m.
const PLACE_M: f64 = 4.0;
/// Additional distance of the robot from the human, m.
const BEFORE_M: f64 = 2.0;
/// Role of somebody who walks as recorded, as the simulation writes it.
const RECORDED: &str = "recorded";

/// Exactly so many humans are there from the first to the last tick.
pub(super) fn humans(signals: &Signals<'_>, count: u32) -> Finding {
    // Who walks as recorded comes with the place and is nobody the scenario tells of.
    let asked = signals.evidence.proposal.map(|proposal| &proposal.humans);
    let bystander = |track: &Track| {
        track.role == RECORDED
            && asked.is_some_and(|asked| !asked.iter().any(|human| AgentId::from(human.id) == track.agent))
    };
    let people: Vec<&Track> = signals.full.humans.iter().filter(|track| !bystander(track)).collect();
    let found = people.len();
    if let Some((gone, t)) = people.iter().find_map(|track| {
        let gone = track.samples.iter().find(|sample| !sample.there)?;
        Some((track.agent, gone.t))
    }) {
        return Finding::fails(-1.0, vec![t], format!("{gone} is not there at {t:.1} s ({count} asked all the time)"));
    }
    let text = format!("{found} humans from 0.0 s to {:.1} s ({count} asked)", signals.end_s());
    if usize::try_from(count).is_ok_and(|count| count == found) {
        Finding::holds(1.0, vec![0.0], text)
    } else {
        Finding::fails(-1.0, vec![0.0], text)
    }
}

/// An encounter, that of one human where they are given, lies on one of the named nodes, or on a place of this class where none is named.
pub(super) fn encounter_at(signals: &Signals<'_>, place: PlaceClass, named: &[NodeId], of: Option<HumanId>) -> Finding {
    let (Some(location), Some(paths)) = (signals.evidence.location, signals.evidence.paths) else {
        return Finding::not_applicable("there is no map or no paths to tell where the encounters are");
    };
    if paths.encounters.is_empty() {
        return Finding::fails(-1.0, vec![], "the paths have no encounter");
    }
    let lies =
        |node: &NodeId| if named.is_empty() { location.graph.node_is(node, place) } else { named.contains(node) };
    // Who comes out of an elevator, or stays in it, is met before its door.
    let from_inside = |human: HumanId| {
        let relation = signals.evidence.proposal.and_then(|proposal| proposal.human(human)).map(|human| human.relation);
        let inside = matches!(relation, Some(Relation::Leaving | Relation::Staying));
        inside && paths.of(AgentId::Human(human)).and_then(|nodes| nodes.first()).is_some_and(lies)
    };
    let here: Vec<(HumanId, &NodeId)> = paths
        .encounters
        .iter()
        .filter(|encounter| of.is_none_or(|human| human == encounter.human))
        .filter(|encounter| lies(&encounter.node) || from_inside(encounter.human))
        .map(|encounter| (encounter.human, &encounter.node))
        .collect();
    let list = |nodes: Vec<&NodeId>| nodes.iter().map(|node| format!("`{node}`")).collect::<Vec<_>>().join(", ");
    let what = if named.is_empty() {
        format!("a place of class `{place}`")
    } else {
        format!("the {} meant ({})", place.name().replace('_', " "), list(named.iter().collect()))
    };
    if here.is_empty() {
        let all = paths.encounters.iter().map(|encounter| &encounter.node).collect();
        return Finding::fails(-1.0, vec![], format!("no encounter is at {what}: they are at {}", list(all)));
    }
    let text = format!("{} is {what}", list(here.iter().map(|(_, node)| *node).collect()));
    if signals.tracks.robot.is_none() {
        return Finding::not_applicable("there is no robot in the recording");
    }
    // A place at which nobody meets the robot is none of an encounter.
    let met = here.iter().filter_map(|(human, node)| together(signals, *human, node));
    match met.min_by(|a, b| a.0.total_cmp(&b.0)) {
        Some((apart_m, t)) if apart_m <= PLACE_M => Finding::holds(1.0, vec![t], text),
        Some((apart_m, t)) => {
            let text = format!("{text}, but nobody meets the robot there: nearest {apart_m:.1} m at {t:.1} s");
            Finding::never(PLACE_M - apart_m, vec![t], text)
        }
        None => Finding::never(-1.0, vec![], format!("{text}, but nobody meets the robot there")),
    }
}

/// How far the human, the robot and the node of their encounter are from each other when they are nearest, m, and when that is, s.
fn together(signals: &Signals<'_>, human: HumanId, node: &NodeId) -> Option<(f64, f64)> {
    let at = signals.node(node)?;
    // The place is where the human is; the robot may stand before it.
    let apart = |moment: &Moment| (moment.human.at - at).norm().max(moment.distance_m - BEFORE_M);
    signals.of(human).iter().map(|moment| (apart(moment), moment.t)).min_by(|a, b| a.0.total_cmp(&b.0))
}

/// The agent comes within a distance of the node.
pub(super) fn reaches(signals: &Signals<'_>, agent: AgentId, node: &NodeId, within_m: f64) -> Finding {
    let Some(at) = signals.node(node) else {
        return Finding::not_applicable(format!("the map has no node `{node}`, or there is no map"));
    };
    let Some(track) = signals.track(agent) else {
        return Finding::fails(-1.0, vec![], format!("{agent} is not in the recording"));
    };
    let nearest = track.present().map(|s| ((s.at - at).norm(), s.t)).min_by(|a, b| a.0.total_cmp(&b.0));
    let (distance, t) = nearest.unwrap_or((f64::INFINITY, 0.0));
    let first = track.present().find(|s| (s.at - at).norm() <= within_m).map_or(t, |s| s.t);
    let text = format!("{agent} comes within {distance:.2} m of `{node}` at {t:.1} s (at most {within_m:.1} m asked)");
    Finding::by_margin(within_m - distance, vec![first], text)
}

/// The agent is near the node when the run begins.
pub(super) fn starts_at(signals: &Signals<'_>, agent: AgentId, node: &NodeId, within_m: f64) -> Finding {
    let Some(at) = signals.node(node) else {
        return Finding::not_applicable(format!("the map has no node `{node}`, or there is no map"));
    };
    let Some(start) = signals.track(agent).and_then(|track| track.samples.first()) else {
        return match agent {
            AgentId::Robot => Finding::not_applicable("there is no robot in the recording"),
            AgentId::Human(id) => Finding::fails(-1.0, vec![], format!("{id} is not in the recording")),
        };
    };
    if !start.there {
        return Finding::fails(-1.0, vec![start.t], format!("{agent} is not there when the run begins"));
    }
    let distance = (start.at - at).norm();
    let text = format!("{agent} starts {distance:.2} m from `{node}` (at most {within_m:.1} m asked)");
    Finding::by_margin(within_m - distance, vec![start.t], text)
}

/// One is there before the other: two humans each at its encounter node, or a human and the robot at the human's.
pub(super) fn before(signals: &Signals<'_>, first: AgentId, then: AgentId) -> Finding {
    let human = |agent: AgentId| if let AgentId::Human(id) = agent { Some(id) } else { None };
    let place =
        |agent: AgentId, other: AgentId| human(agent).or_else(|| human(other)).and_then(|id| signals.encounter(id));
    let track = |agent: AgentId| human(agent).map_or(signals.tracks.robot.as_ref(), |id| signals.tracks.human(id));
    let mut times = Vec::new();
    for (agent, other) in [(first, then), (then, first)] {
        let (Some((_, at)), Some(track)) = (place(agent, other), track(agent)) else {
            return Finding::not_applicable("there is no encounter, or no map to tell where it is");
        };
        let Some(t) = arrival(track, at, f64::INFINITY) else {
            return Finding::never(-1.0, vec![], format!("{agent} is never at the encounter"));
        };
        times.push(t);
    }
    let &[before, after] = times.as_slice() else { return Finding::not_applicable("there is nobody to compare") };
    in_order(before, after, format!("{first} is there at {before:.1} s, {then} at {after:.1} s"))
}

/// What two times say of one thing before another: at the same time is not before.
pub(super) fn in_order(before_s: f64, after_s: f64, text: String) -> Finding {
    let margin = after_s - before_s - BEFORE_S;
    Finding::by_margin(margin, vec![before_s.max(after_s), before_s, after_s], text).shifted(margin)
}

/// When a track gets to a place, or is nearest to it within reach. Whoever goes aside for somebody passes the place beside it.
fn arrival(track: &Track, at: Point, until_s: f64) -> Option<f64> {
    let off = |s: &Sample| (s.at - at).norm();
    let near = || track.present().filter(|s| s.t < until_s && off(s) <= MEET_NODE_M);
    near().find(|s| off(s) <= ARRIVED_M).or_else(|| near().min_by(|a, b| off(a).total_cmp(&off(b)))).map(|s| s.t)
}

/// Until when a track that is at a place at a time stands there, s.
fn stands_until(track: &Track, at: Point, from_s: f64) -> f64 {
    let there = track.present().skip_while(|s| s.t < from_s).take_while(|s| (s.at - at).norm() <= ARRIVED_M);
    there.filter(|s| s.speed() <= MOVING_MPS).last().map_or(from_s, |sample| sample.t)
}

/// Human and robot get to the encounter at about the same time; how long the robot waits in between because it is asked to does
/// not count.
pub(super) fn on_time(signals: &Signals<'_>, human: HumanId, gap_s: f64) -> Finding {
    if let Some(found) = absent(signals, human) {
        return found;
    }
    let (Some((id, at)), Some(robot), Some(person)) =
        (signals.encounter(human), &signals.tracks.robot, signals.tracks.human(human))
    else {
        return Finding::not_applicable("there is no encounter, or no map to tell where it is");
    };
    // The first of several encounters is over when the next one begins.
    let until_s = signals.meeting(human, 1).map_or(f64::INFINITY, |meeting| meeting.to_s);
    let (Some(first), Some(second)) = (arrival(robot, at, until_s), arrival(person, at, until_s)) else {
        return Finding::never(-gap_s, vec![], format!("not both of {human} and the robot get to `{id}`"));
    };
    // Somebody who came sooner and whose steps have them stand there until the robot comes is on time.
    let steps = signals.evidence.proposal.and_then(|proposal| proposal.human(human)).map_or(0, |human| human.steps());
    let second = if second < first && steps > 0 { stands_until(person, at, second).min(first) } else { second };
    // A robot that stands because somebody asked it to is kept waiting by the scenario, not late.
    let apart_s = (second - first).abs();
    let waits_s = held_on_request_s(signals, first.min(second), first.max(second)).min(apart_s);
    let gap = apart_s - waits_s;
    let waits = if waits_s > 0.0 { format!(" and {waits_s:.1} s on request") } else { String::new() };
    let text = format!(
        "at `{id}` the robot is at {first:.1} s, {human} at {second:.1} s: gap {gap:.1} s{waits} (at most {gap_s:.1} s asked)"
    );
    let times = vec![first.max(second), first, second];
    let finding = match gap {
        gap if gap <= gap_s => Finding::holds(gap_s - gap, times, text),
        gap if gap <= LATE_FACTOR * gap_s => Finding::late(gap_s - gap, times, text),
        gap => Finding::fails(gap_s - gap, times, text),
    };
    finding.shifted(gap_s - gap)
}
