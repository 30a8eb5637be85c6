//! Edits of paths: longer, shorter, the other way round, from and to somewhere, round a place, met elsewhere.

use socrates_model::{
    Encounter, Fault, FaultCode, HumanId, HumanProposal, Location, NodeId, Paths, PlaceClass, Relation,
};
use socrates_prompts::Question;

use crate::card::{Ends, card};
use crate::edit::Desk;
use crate::edit_people::{Crowd, Whom};
use crate::edit_wish::{Kind, Wish};
use crate::humans::{Taken, Way, way};
use crate::routes::{Net, Route};
use crate::{place, solve, spot};

/// A path gets longer or shorter by so much where the edit does not say, m.
const STEP_M: f64 = 3.0;
/// The robot's path has at least this length and so many nodes.
const LEAST_M: f64 = 6.5;
const LEAST_NODES: usize = 4;
/// A human's path that moves is at least this long, m.
const LEAST_HUMAN_M: f64 = 3.0;
/// Other places of the meeting that are tried.
const TRIES: usize = 8;

/// Does what an edit of paths asks for.
pub(crate) fn grant(desk: &mut Desk, wish: &Wish, crowd: &mut Crowd) {
    let Some(paths) = desk.draft.paths.clone() else {
        return desk.refuse(&wish.quote, "speaks of paths, and there are none yet");
    };
    if wish.kind == Kind::Move {
        return moved(desk, wish, &paths);
    }
    let location = desk.question.location.clone();
    let net = Net::new(&location);
    if wish.kind == Kind::Reverse {
        return reverse(desk, wish, &paths);
    }
    let people = match crowd.whom(wish) {
        Whom::Robot | Whom::Unsaid => Vec::new(),
        Whom::People(people) => people,
    };
    let mut new = paths.clone();
    let mut done = Vec::new();
    // Without anybody named it is the robot's path.
    let whose: Vec<Option<usize>> = if people.is_empty() { vec![None] } else { people.into_iter().map(Some).collect() };
    for who in whose {
        let id = who.and_then(|who| desk.draft.proposal.humans.get(who)).map(|human| human.id);
        let nodes = match id {
            Some(id) => new.humans.get(&id).cloned().unwrap_or_default(),
            None => new.robot.clone(),
        };
        let name = id.map_or_else(|| "the robot".to_owned(), |id| id.to_string());
        let Some(old) = nodes.iter().map(|node| net.index(node)).collect::<Option<Vec<usize>>>() else { continue };
        if old.len() < 2 {
            desk.refuse(&wish.quote, &format!("speaks of {name}, who stands and has no way"));
            continue;
        }
        let trip = Trip { net: &net, old: &old, keep: kept(&new, id, &net), robot: id.is_none() };
        match trip.changed(wish, &others_ends(&new, id, &net)) {
            Ok(found) => {
                let [before, after] = [net.length_m(&old), net.length_m(&found)];
                done.push(format!(
                    "the way of {name} is {after:.1} m instead of {before:.1} m: {}",
                    listed(&net, &found)
                ));
                match id {
                    Some(id) => drop(new.humans.insert(id, net.named(&found))),
                    None => new.robot = net.named(&found),
                }
            }
            Err(why) => desk.refuse(&wish.quote, &format!("cannot be done for {name}: {why}")),
        }
    }
    if new == paths {
        return;
    }
    sort(&mut new);
    if let (Kind::Start | Kind::End, Some(class)) = (wish.kind, wish.place)
        && new.robot != paths.robot
    {
        let robot = &mut desk.draft.proposal.robot;
        *(if wish.kind == Kind::Start { &mut robot.start } else { &mut robot.goal }) = Some(class);
    }
    desk.draft.paths = Some(new);
    desk.done.extend(done);
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

fn listed(net: &Net<'_>, nodes: &[usize]) -> String {
    net.named(nodes).iter().map(NodeId::to_string).collect::<Vec<_>>().join(" ")
}

/// Encounters in the order in which the robot comes to them.
pub(crate) fn sort(paths: &mut Paths) {
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
    fn changed(&self, wish: &Wish, ends: &[usize]) -> Result<Vec<usize>, String> {
        let by = wish.meters.unwrap_or(STEP_M);
        match wish.kind {
            Kind::Longer => self.longer(by, ends),
            Kind::Shorter => self.shorter(by),
            Kind::Avoid => self.avoiding(&self.targets(wish)?),
            Kind::Start => self.from(&self.targets(wish)?, ends).map(|mut nodes| {
                nodes.reverse();
                nodes
            }),
            Kind::End => self.to(&self.targets(wish)?, ends),
            Kind::Reverse
            | Kind::Move
            | Kind::Remove
            | Kind::Pace(_)
            | Kind::NoGestures
            | Kind::Ungroup
            | Kind::Group
            | Kind::Swap
            | Kind::Gesture
            | Kind::Story => Err("it is no change of one way".to_owned()),
        }
    }

    /// Nodes that the wish names, by id or by class of place.
    fn targets(&self, wish: &Wish) -> Result<Vec<usize>, String> {
        let named: Vec<usize> = wish
            .names
            .iter()
            .filter_map(|name| {
                self.net.location.graph.nodes().iter().position(|node| node.id.as_str() == name.as_str())
            })
            .collect();
        if !named.is_empty() {
            return Ok(named);
        }
        let Some(class) = wish.place else { return Err("it does not say where".to_owned()) };
        // `at the kitchen` is the kitchen, not any room.
        if let Some(meant) = spot::named_in(self.net.location, &wish.quote, class) {
            let nodes: Vec<usize> = meant.nodes.iter().filter_map(|node| self.net.index(node)).collect();
            if nodes.is_empty() {
                let has = place::listed(self.net.location);
                return Err(format!("the map has no place called `{}`; it has: {has}", meant.name));
            }
            return Ok(nodes);
        }
        let found: Vec<usize> = (0..self.net.len()).filter(|node| self.net.is(*node, class)).collect();
        if found.is_empty() {
            return Err(format!(
                "the map has no {}; it has: {}",
                place::words(class),
                place::listed(self.net.location)
            ));
        }
        // A class that is a node's own type before one that only an edge gives it.
        let own: Vec<usize> = found.iter().copied().filter(|node| self.net.kind(*node) == class).collect();
        Ok(if own.is_empty() { found } else { own })
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

/// A longer way for a human whose way is too short.
pub(crate) fn lengthen(net: &Net<'_>, paths: &mut Paths, id: HumanId) {
    let nodes = paths.humans.get(&id).cloned().unwrap_or_default();
    let Some(old) = nodes.iter().map(|node| net.index(node)).collect::<Option<Vec<usize>>>() else { return };
    let trip = Trip { net, old: &old, keep: kept(paths, Some(id), net), robot: false };
    if let Ok(longer) = trip.longer(STEP_M, &others_ends(paths, Some(id), net)) {
        paths.humans.insert(id, net.named(&longer));
    }
}

/// Everybody who goes the robot's way, or against it, turns with it.
fn reverse(desk: &mut Desk, wish: &Wish, paths: &Paths) {
    let mut new = paths.clone();
    new.robot.reverse();
    let mut turned = Vec::new();
    for human in &desk.draft.proposal.humans {
        let along =
            matches!(human.relation, Relation::Frontal | Relation::Behind | Relation::Ahead | Relation::Abreast);
        if let Some(nodes) = new.humans.get_mut(&human.id).filter(|nodes| along && nodes.len() > 1) {
            nodes.reverse();
            turned.push(human.id.to_string());
        }
    }
    let inside = |node: Option<&NodeId>| node.is_some_and(|node| place::is_inside(&desk.question.location, node));
    if inside(paths.robot.last()) != inside(paths.robot.first()) {
        return desk.refuse(&wish.quote, "would turn the way into a room or an elevator into one out of it");
    }
    sort(&mut new);
    let robot = &mut desk.draft.proposal.robot;
    std::mem::swap(&mut robot.start, &mut robot.goal);
    let with = if turned.is_empty() { String::new() } else { format!(", and with it {}", turned.join(" and ")) };
    desk.done.push(format!("the robot goes its way the other way round{with}"));
    desk.draft.paths = Some(new);
}

/// The meeting somewhere else: all ways are laid anew.
fn moved(desk: &mut Desk, wish: &Wish, paths: &Paths) {
    let location = desk.question.location.clone();
    let class = wish.place.unwrap_or(desk.draft.proposal.place);
    if !place::has(&location, class) {
        return desk.no_place(&wish.quote, &format!("asks for {}, which the map does not have", place::an(class)));
    }
    let net = Net::new(&location);
    let node = |paths: &Paths| paths.encounters.first().map(|encounter| encounter.node.clone());
    let before = node(paths);
    let mut named: Vec<NodeId> = location
        .graph
        .nodes()
        .iter()
        .filter(|node| wish.names.iter().any(|name| *name == node.id.as_str()))
        .map(|node| node.id.clone())
        .collect();
    if let Some(meant) = spot::named_in(&location, &wish.quote, class).filter(|_| named.is_empty()) {
        if meant.nodes.is_empty() {
            return desk.no_place(&wish.quote, &format!("asks for `{}`, which the map does not have", meant.name));
        }
        // Nobody walks on beyond a dead end: they meet before it.
        named = spot::nodes(&location, &wish.quote, class, &desk.draft.proposal.humans);
    }
    let same = class == desk.draft.proposal.place && named.is_empty();
    if same && !wish.other && wish.place.is_some() {
        return desk.refuse(&wish.quote, "is so already; say `the other …` for another place of this kind");
    }
    let proposal = socrates_model::Proposal { place: class, ..desk.draft.proposal.clone() };
    let far = |other: &NodeId| {
        let at = |node: &NodeId| net.index(node).map(|node| net.at(node));
        before.as_ref().and_then(at).zip(at(other)).map_or(0.0, |(a, b)| (a - b).norm())
    };
    let mut best: Option<(f64, Paths)> = None;
    for moves in 0..TRIES {
        // Every refusal moves the solver on to its next meeting node.
        let feedback = vec![Fault::new(FaultCode::GMeet, "edit", ""); moves];
        let ask = Question { feedback, ..desk.question.clone() };
        let Some(found) = solve::solve(&ask, &proposal) else { break };
        let Some(there) = node(&found).filter(|there| Some(there) != before.as_ref()) else { continue };
        let fits = if named.is_empty() { location.graph.node_is(&there, class) } else { named.contains(&there) };
        // Another corridor is not the next node of the same one.
        let score = if wish.other { far(&there).min(8.0) } else { 0.0 };
        if fits && best.as_ref().is_none_or(|(top, _)| score > *top + 1e-9) {
            best = Some((score, found));
        }
    }
    let Some((_, found)) = best else {
        return desk.refuse(&wish.quote, "finds no other place of the meeting that has room for all ways");
    };
    let there = node(&found).map_or_else(String::new, |node| node.to_string());
    desk.done.push(format!("they meet at {} (`{there}`); all ways are new", place::an(class)));
    if class != desk.draft.proposal.place {
        desk.draft.proposal.place = class;
        for clause in &mut desk.draft.proposal.expected_events {
            if let socrates_model::Predicate::EncounterAt { place: old, nodes } = &mut clause.predicate {
                *old = class;
                nodes.clear();
                clause.text = format!("it happens at {}", place::an(class));
            }
        }
        for who in 0..desk.draft.proposal.humans.len() {
            desk.touch(who);
        }
    }
    desk.draft.paths = Some(found);
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
        boards: 0,
    }
}

fn lay(
    location: &Location,
    paths: &mut Paths,
    human: &HumanProposal,
    class: PlaceClass,
    at: Option<PlaceClass>,
    (pattern, twice): (&str, Option<Option<PlaceClass>>),
) -> bool {
    let net = Net::new(location);
    let old = paths.encounter_of(human.id).cloned();
    let Some(route) = route(&net, paths, old.as_ref()) else { return false };
    let taken = taken(&net, paths, human.id, class, card(pattern).map_or(Ends::Past, |card| card.ends));
    let found = match at {
        Some(at) => stands(&net, &route, &taken, at),
        None => way(human, &route, &taken, true),
    };
    let Some(own) = found else { return false };
    let second = twice.and_then(|class| crate::twice::second(&net, &route, &own, (human.relation, class)));
    let (own, again) = second.map_or((own, None), |(own, node)| (own, Some(node)));
    paths.encounters.retain(|encounter| encounter.human != human.id);
    for node in [Some(own.meet), again].into_iter().flatten().filter_map(|node| net.id(node)) {
        paths.encounters.push(Encounter { human: human.id, node: node.clone() });
    }
    paths.humans.insert(human.id, net.named(&own.nodes));
    sort(paths);
    true
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

/// A way for somebody new.
pub(crate) fn join(desk: &mut Desk, who: usize, at: Option<PlaceClass>) -> bool {
    let (Some(human), Some(mut paths)) = (desk.draft.proposal.humans.get(who).cloned(), desk.draft.paths.clone())
    else {
        return false;
    };
    let proposal = &desk.draft.proposal;
    let twice = crate::twice::asked(proposal).into_iter().find(|(id, _)| *id == human.id).map(|(_, class)| class);
    let done = lay(&desk.question.location, &mut paths, &human, proposal.place, at, (&proposal.pattern, twice));
    if done {
        desk.draft.paths = Some(paths);
    }
    done
}

/// Another way for somebody who stands to the robot's way otherwise than before.
pub(crate) fn anew(desk: &mut Desk, who: usize) -> bool {
    join(desk, who, None)
}

/// Members of a group go the way of the first of them.
pub(crate) fn together(desk: &mut Desk, members: &[usize]) {
    let ids: Vec<HumanId> =
        members.iter().filter_map(|i| desk.draft.proposal.humans.get(*i)).map(|human| human.id).collect();
    let Some(paths) = &mut desk.draft.paths else { return };
    let Some(first) = ids.first().and_then(|id| paths.humans.get(id)).cloned() else { return };
    let met: Vec<NodeId> = ids.first().map(|id| paths.encounters_of(*id).cloned().collect()).unwrap_or_default();
    for id in ids.iter().skip(1) {
        paths.humans.insert(*id, first.clone());
        if met.is_empty() || paths.encounter_of(*id).is_none() {
            continue;
        }
        paths.encounters.retain(|encounter| encounter.human != *id);
        paths.encounters.extend(met.iter().map(|node| Encounter { human: *id, node: node.clone() }));
    }
    sort(paths);
}
