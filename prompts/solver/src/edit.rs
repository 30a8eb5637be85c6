//! Changes of paths that stand: longer, shorter, from and to somewhere, round a place; a way for somebody new.

use socrates_model::{AgentId, Encounter, HumanId, HumanProposal, Location, NodeId, Paths, PlaceClass, Proposal};

use crate::graph::Net;
use crate::people::{Taken, Way, way};
use crate::robot_way::Route;
use crate::{Ends, second_meeting};

/// A way that is too short gets longer by so much, m.
const STEP_M: f64 = 3.0;
/// The robot's path has at least this length and so many nodes.
const LEAST_M: f64 = 6.5;
const LEAST_NODES: usize = 4;
/// A human's path that moves is at least this long, m.
pub(crate) const LEAST_HUMAN_M: f64 = 3.0;

/// How one way is to change.
#[derive(Debug, Clone, PartialEq)]
pub enum Change {
    /// Longer by so much, m.
    Longer(f64),
    /// Shorter by so much, m.
    Shorter(f64),
    /// Round these nodes.
    Avoid(Vec<NodeId>),
    /// Beginning at one of these nodes.
    Start(Vec<NodeId>),
    /// Ending at one of these nodes.
    End(Vec<NodeId>),
}

/// The paths with one way changed; everybody is still met where they were.
///
/// # Errors
/// Why that cannot be done, as a half sentence for a person.
pub fn changed(location: &Location, paths: &Paths, who: AgentId, change: &Change) -> Result<Paths, String> {
    let net = Net::new(location);
    let id = if let AgentId::Human(id) = who { Some(id) } else { None };
    let nodes = paths.of(who).unwrap_or_default();
    let old = nodes.iter().map(|node| net.index(node)).collect::<Option<Vec<usize>>>();
    let Some(old) = old else { return Err("it leads over nodes that the map does not have".to_owned()) };
    let trip = Trip { net: &net, old: &old, keep: kept(paths, id, &net), robot: id.is_none() };
    let found = net.named(&trip.changed(change, &others_ends(paths, id, &net))?);
    let mut new = paths.clone();
    match id {
        Some(id) => drop(new.humans.insert(id, found)),
        None => new.robot = found,
    }
    Ok(new)
}

/// Nodes at which an agent meets somebody.
fn kept(paths: &Paths, id: Option<HumanId>, net: &Net<'_>) -> Vec<usize> {
    let own = paths.encounters.iter().filter(|encounter| id.is_none_or(|id| encounter.human == id));
    own.filter_map(|encounter| net.index(&encounter.node)).collect()
}

/// Where everybody else ends.
fn others_ends(paths: &Paths, id: Option<HumanId>, net: &Net<'_>) -> Vec<usize> {
    let people = paths.humans.iter().filter(|(other, _)| Some(**other) != id).filter_map(|(_, nodes)| nodes.last());
    let robot = paths.robot.last().filter(|_| id.is_some());
    people.chain(robot).filter_map(|node| net.index(node)).collect()
}

/// Encounters in the order in which the robot comes to them.
pub fn sort(paths: &mut Paths) {
    let mut all: Vec<(usize, Encounter)> = Vec::new();
    for human in paths.humans.keys() {
        all.extend(paths.visits(*human).into_iter().map(|visit| {
            (visit.robot_step.unwrap_or(usize::MAX), Encounter { human: *human, node: visit.node.clone() })
        }));
    }
    // Those of one human stay in their order.
    all.sort_by_key(|(step, encounter)| (*step, encounter.human));
    paths.encounters = all.into_iter().map(|(_, encounter)| encounter).collect();
}

/// One agent's way that is to change.
struct Trip<'a> {
    net: &'a Net<'a>,
    old: &'a [usize],
    /// Nodes that it has to keep, because somebody is met there.
    keep: Vec<usize>,
    robot: bool,
}

impl Trip<'_> {
    fn changed(&self, change: &Change, ends: &[usize]) -> Result<Vec<usize>, String> {
        let known = |nodes: &[NodeId]| nodes.iter().filter_map(|node| self.net.index(node)).collect::<Vec<usize>>();
        match change {
            Change::Longer(by) => self.longer(*by, ends),
            Change::Shorter(by) => self.shorter(*by),
            Change::Avoid(nodes) => self.avoiding(&known(nodes)),
            Change::Start(nodes) => self.from(&known(nodes), ends).map(|mut nodes| {
                nodes.reverse();
                nodes
            }),
            Change::End(nodes) => self.to(&known(nodes), ends),
        }
    }

    fn longer(&self, by: f64, ends: &[usize]) -> Result<Vec<usize>, String> {
        let wanted = self.net.length_m(self.old) + by;
        let mut nodes = self.old.to_vec();
        // On from its end; where that is not enough, from farther before its start.
        for _ in 0..2 {
            while self.net.length_m(&nodes) < wanted - 1e-9 {
                let (Some(last), Some(previous)) =
                    (nodes.last().copied(), nodes.len().checked_sub(2).and_then(|i| nodes.get(i)).copied())
                else {
                    break;
                };
                let free = |node: &usize| {
                    !nodes.contains(node)
                        && !ends.contains(node)
                        && !self.net.inside(*node)
                        && self.net.near(*node).len() + usize::from(self.net.kind(*node) != PlaceClass::Doorway) > 1
                };
                let next = self.net.near(last).iter().map(|(node, _)| *node).filter(free);
                let straight = |node: usize| self.net.straight(previous, last, node);
                let Some(next) = next.max_by(|a, b| straight(*a).total_cmp(&straight(*b))) else { break };
                nodes.push(next);
            }
            nodes.reverse();
        }
        if nodes.len() == self.old.len() {
            return Err("the map does not lead on from either of its ends".to_owned());
        }
        Ok(nodes)
    }

    fn shorter(&self, by: f64) -> Result<Vec<usize>, String> {
        let wanted = self.net.length_m(self.old) - by;
        let (least_m, least) = if self.robot { (LEAST_M, LEAST_NODES) } else { (LEAST_HUMAN_M, 2) };
        let mut nodes = self.old.to_vec();
        for _ in 0..2 {
            while self.net.length_m(&nodes) > wanted + 1e-9 {
                let cut = nodes.get(..nodes.len().saturating_sub(1)).unwrap_or_default();
                // The meeting stays, and so does a node after it.
                let meets = self.keep.iter().any(|node| cut.last() == Some(node) || nodes.last() == Some(node));
                if meets || cut.len() < least || self.net.length_m(cut) < least_m {
                    break;
                }
                nodes.truncate(cut.len());
            }
            nodes.reverse();
        }
        if nodes.len() == self.old.len() {
            return Err(format!(
                "it needs its {:.1} m for the meeting and the way after it",
                self.net.length_m(self.old)
            ));
        }
        Ok(nodes)
    }

    /// First and last node and those between that have to stay, in order.
    fn anchors(&self) -> Vec<usize> {
        let last = self.old.len().saturating_sub(1);
        let stays = |(i, node): &(usize, &usize)| *i == 0 || *i == last || self.keep.contains(node);
        self.old.iter().enumerate().filter(stays).map(|(_, node)| *node).collect()
    }

    fn avoiding(&self, barred: &[usize]) -> Result<Vec<usize>, String> {
        if !self.old.iter().any(|node| barred.contains(node)) {
            return Err("it does not lead past there".to_owned());
        }
        let anchors = self.anchors();
        if let Some(node) = anchors.iter().find(|node| barred.contains(node)).and_then(|node| self.net.id(*node)) {
            return Err(format!("it starts, ends or meets somebody at `{node}`; move that first"));
        }
        let mut nodes: Vec<usize> = anchors.first().copied().into_iter().collect();
        for pair in anchors.windows(2) {
            let [from, to] = pair else { continue };
            let tree = self.net.tree(*from, &|node| {
                barred.contains(&node) || node != *to && (nodes.contains(&node) || anchors.contains(&node))
            });
            let part = tree.way(*to);
            if part.is_empty() {
                return Err("there is no other way".to_owned());
            }
            nodes.extend(part.into_iter().skip(1));
        }
        Ok(nodes)
    }

    /// The way to one of the targets, from the last meeting on.
    fn to(&self, targets: &[usize], ends: &[usize]) -> Result<Vec<usize>, String> {
        self.onward(self.old, targets, ends)
    }

    /// The way from one of the targets, turned round.
    fn from(&self, targets: &[usize], ends: &[usize]) -> Result<Vec<usize>, String> {
        let turned: Vec<usize> = self.old.iter().rev().copied().collect();
        self.onward(&turned, targets, ends)
    }

    fn onward(&self, old: &[usize], targets: &[usize], ends: &[usize]) -> Result<Vec<usize>, String> {
        if old.last().is_some_and(|last| targets.contains(last)) {
            return Err("it is so already".to_owned());
        }
        // Up to the last meeting, or up to its own start where nobody is met.
        let meet = old.iter().rposition(|node| self.keep.contains(node)).unwrap_or(0);
        let head = old.get(..=meet).unwrap_or_default();
        let Some(from) = head.last().copied() else { return Err("there is no way".to_owned()) };
        let tree = self.net.tree(from, &|node| head.contains(&node));
        let aim = self.net.length_m(old.get(meet..).unwrap_or_default());
        let (least_m, least) = if self.robot { (LEAST_M, LEAST_NODES) } else { (LEAST_HUMAN_M, 2) };
        let mut found: Vec<(f64, Vec<usize>)> = targets
            .iter()
            .filter(|node| **node != from && !ends.contains(node))
            .map(|node| tree.way(*node))
            .filter(|way| way.len() > 1)
            .map(|way| {
                let nodes: Vec<usize> = head.iter().copied().chain(way.iter().copied().skip(1)).collect();
                ((self.net.length_m(&way) - aim).abs(), nodes)
            })
            .filter(|(_, nodes)| nodes.len() >= least && self.net.length_m(nodes) >= least_m)
            .collect();
        found.sort_by(|a, b| a.0.total_cmp(&b.0).then_with(|| a.1.cmp(&b.1)));
        found
            .into_iter()
            .next()
            .map(|(_, nodes)| nodes)
            .ok_or_else(|| "no way leads there that keeps the meeting and is long enough".to_owned())
    }
}

/// A longer way for somebody whose way is too short.
pub(crate) fn lengthened(net: &Net<'_>, paths: &mut Paths, id: HumanId) {
    let nodes = paths.humans.get(&id).cloned().unwrap_or_default();
    let Some(old) = nodes.iter().map(|node| net.index(node)).collect::<Option<Vec<usize>>>() else { return };
    let trip = Trip { net, old: &old, keep: kept(paths, Some(id), net), robot: false };
    if let Ok(longer) = trip.longer(STEP_M, &others_ends(paths, Some(id), net)) {
        paths.humans.insert(id, net.named(&longer));
    }
}

/// The robot's way with the node where this human is to be met.
fn route(net: &Net<'_>, paths: &Paths, meet: Option<&NodeId>) -> Option<Route> {
    let nodes: Vec<usize> = paths.robot.iter().map(|node| net.index(node)).collect::<Option<_>>()?;
    let node = meet.or_else(|| paths.encounters.first().map(|encounter| &encounter.node));
    let meet = node.and_then(|node| paths.robot.iter().position(|other| other == node)).unwrap_or(nodes.len() / 2);
    let meet = meet.clamp(1, nodes.len().saturating_sub(2).max(1));
    Some(Route { nodes, meet, score: 0.0 })
}

fn taken<'a>(net: &'a Net<'a>, paths: &Paths, but: HumanId, class: PlaceClass, ends: Ends) -> Taken<'a> {
    let others = || paths.humans.iter().filter(|(id, _)| **id != but).map(|(_, nodes)| nodes);
    let index = |node: Option<&NodeId>| node.and_then(|node| net.index(node));
    Taken {
        net,
        starts: others().filter_map(|nodes| index(nodes.first())).chain(index(paths.robot.first())).collect(),
        goals: others()
            .filter(|nodes| nodes.len() > 1)
            .filter_map(|nodes| index(nodes.last()))
            .chain(index(paths.robot.last()))
            .collect(),
        crowded: false,
        ends,
        place: class,
        meant: &[],
        standing: Vec::new(),
        toward: false,
        boards: 0,
        wide: false,
        entry: None,
    }
}

/// The paths with a way for somebody new, or for somebody who stands to the robot's way otherwise than before; who is to stand
/// at a class of place stands at one that the robot passes. `None` where the robot's way has no room for them.
#[must_use]
pub fn joined(
    location: &Location,
    proposal: &Proposal,
    paths: &Paths,
    (human, at): (&HumanProposal, Option<PlaceClass>),
    ends: Ends,
) -> Option<Paths> {
    let net = Net::new(location);
    let mut paths = paths.clone();
    let old = paths.encounter_of(human.id).cloned();
    let route = route(&net, &paths, old.as_ref())?;
    let taken = taken(&net, &paths, human.id, proposal.place, ends);
    let found = match at {
        Some(at) => stands(&net, &route, &taken, at),
        None => way(human, &route, &taken, true),
    };
    let own = found?;
    let twice = second_meeting::asked(proposal).into_iter().find(|(id, _)| *id == human.id).map(|(_, class)| class);
    let second = twice.and_then(|class| second_meeting::second(&net, &route, &own, (human.relation, class)));
    let (own, again) = second.map_or((own, None), |(own, node)| (own, Some(node)));
    paths.encounters.retain(|encounter| encounter.human != human.id);
    for node in [Some(own.meet), again].into_iter().flatten().filter_map(|node| net.id(node)) {
        paths.encounters.push(Encounter { human: human.id, node: node.clone() });
    }
    paths.humans.insert(human.id, net.named(&own.nodes));
    sort(&mut paths);
    Some(paths)
}

/// Somebody who stands at a place that the robot passes.
fn stands(net: &Net<'_>, route: &Route, taken: &Taken<'_>, class: PlaceClass) -> Option<Way> {
    let inner = route.nodes.get(1..route.nodes.len().checked_sub(1)?)?;
    let free = |node: &&usize| net.is(**node, class) && !taken.starts.contains(node);
    let own = inner.iter().filter(free).find(|node| net.kind(**node) == class);
    let at = own.or_else(|| inner.iter().find(free)).copied();
    // Beside a place that lies off its way, as far as a few steps.
    let near = || {
        let off = |node: usize| {
            (0..net.len())
                .filter(|other| net.is(*other, class))
                .map(|other| (net.at(other) - net.at(node)).norm())
                .fold(f64::INFINITY, f64::min)
        };
        let free = inner.iter().copied().filter(|node| !taken.starts.contains(node) && off(*node) < 4.0);
        free.min_by(|a, b| off(*a).total_cmp(&off(*b)))
    };
    let at = at.or_else(near)?;
    Some(Way { nodes: vec![at], meet: at, cost: 0.0 })
}
