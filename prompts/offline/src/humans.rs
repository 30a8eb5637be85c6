//! Ways of humans, by how they stand to the robot's way.

use socrates_model::{Action, HumanProposal, Location, PlaceClass, Relation};

use crate::boards;
use crate::card::Ends;
use crate::chance::walks_later;
use crate::place;
use crate::routes::{Net, Route};

/// Speed of the robot that timings are planned with, m/s.
const ROBOT_MPS: f64 = 0.8;
/// Fastest walk of somebody who is late for the meeting, m/s; what is farther away than that and so much more is too far, m.
const HURRY_MPS: f64 = 1.5;
const LATE_M: f64 = 2.0;
/// Desired speed of a human without one of its own, m/s.
const HUMAN_MPS: f64 = 1.2;
/// People start at least so far from each other and the robot unless they belong together, m.
const APART_M: f64 = 0.8;
/// So many may start at one node where there is no room for all to start apart.
const SHARED: usize = 3;
/// Somebody goes on at least so far after the meeting, m.
const ONWARD_M: f64 = 4.0;

/// Two who end nearer to each other than this are in each other's way, m.
const ENDS_APART_M: f64 = 1.5;

/// Who overtakes comes level with the robot after so much of its way, m.
const EARLY_M: f64 = 4.0;

/// The robot starts at least so far from those who stand at a place by name, so that it comes to them, m.
const SEEN_M: f64 = 6.0;

/// One human's way and where it meets the robot.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Way {
    pub(crate) nodes: Vec<usize>,
    /// The meeting node.
    pub(crate) meet: usize,
    /// How well it fits; 0 is best.
    pub(crate) cost: f64,
}

/// What is already taken.
pub(crate) struct Taken<'a> {
    pub(crate) net: &'a Net<'a>,
    pub(crate) starts: Vec<usize>,
    /// Where others end: who ends where somebody stands already does not get there.
    pub(crate) goals: Vec<usize>,
    /// There is no room for everybody to start apart: the checks will say so.
    pub(crate) crowded: bool,
    /// Where on the robot's way those stand who stand.
    pub(crate) ends: Ends,
    /// The class of place where people should meet.
    pub(crate) place: PlaceClass,
    /// The nodes of the place by name, if it has one: who stands stands there, together with others.
    pub(crate) meant: &'a [usize],
    /// Where those stand who have been placed there.
    pub(crate) standing: Vec<usize>,
    /// How many stand before a door at first and go in.
    pub(crate) boards: usize,
}

/// Cost of a way that ends in a doorway or where others end: any other way is better.
const BAD_END: f64 = 8.0;
/// Cost of a way that ends right after the meeting.
const SHORT_TAIL: f64 = 3.0;

/// Cost of turning into the robot's own way instead of crossing it: a room on the other side is better.
const OWN_WAY: f64 = 3.0;

/// Cost per what two ways over a corner are more alike than this, as the cosine between them.
const SAME_CORNER: f64 = 16.0;
const CROSSES: f64 = 0.75;

/// No node: somebody with whom the robot starts is met nowhere.
const NOWHERE: usize = usize::MAX;

impl Taken<'_> {
    fn free(&self, node: usize) -> bool {
        let near = |other: &&usize| (self.net.at(**other) - self.net.at(node)).norm() < APART_M;
        let others = self.starts.iter().filter(near).count();
        // The robot's own start, the first of them, is its alone.
        others == 0 || self.crowded && others < SHARED && !self.starts.iter().take(1).any(|robot| near(&robot))
    }

    /// Whether somebody may end there: nobody else does near by, and nobody has to get through.
    fn can_end(&self, node: usize) -> bool {
        let at = self.net.at(node);
        self.net.kind(node) != PlaceClass::Doorway
            && self.goals.iter().all(|other| (self.net.at(*other) - at).norm() >= ENDS_APART_M)
    }

    /// What it costs to end a way there.
    fn end_cost(&self, nodes: &[usize]) -> f64 {
        if nodes.last().is_some_and(|last| self.can_end(*last)) { 0.0 } else { BAD_END }
    }
}

/// The way of a human, if the robot's way has room for it.
pub(crate) fn way(human: &HumanProposal, route: &Route, taken: &Taken<'_>, along: bool) -> Option<Way> {
    match human.relation {
        Relation::Frontal => frontal(human, route, taken),
        Relation::Crossing => crossing(human, route, taken),
        Relation::Behind => behind(human, route, taken, along),
        Relation::Ahead | Relation::Abreast => ahead(human, route, taken),
        Relation::Static if boards::boards(human) => {
            boards::way(human, route, taken).or_else(|| standing(route, taken))
        }
        Relation::Static if walks_later(human) => standing(route, taken).map(|way| walking_on(way, route, taken)),
        Relation::Static => standing(route, taken),
        Relation::Leaving => leaving(human, route, taken),
        Relation::Staying => staying(human, route, taken),
    }
}

fn before_m(net: &Net<'_>, route: &Route) -> f64 {
    net.length_m(route.nodes.get(..=route.meet).unwrap_or_default())
}

/// How far a human walks until the robot is at the meeting node, m.
fn ideal_m(human: &HumanProposal, net: &Net<'_>, route: &Route) -> f64 {
    before_m(net, route) / ROBOT_MPS * human.speed_mps.unwrap_or(HUMAN_MPS)
}

/// Towards the robot: its own way the other way round, from beyond the meeting node.
fn frontal(human: &HumanProposal, route: &Route, taken: &Taken<'_>) -> Option<Way> {
    let net = taken.net;
    let meet = *route.nodes.get(route.meet)?;
    let mut back: Vec<usize> = route.nodes.get(..route.meet)?.iter().rev().copied().collect();
    if let Some(class) = human.goal {
        indoors(net, class, &mut back, &taken.goals);
    } else {
        let far = |n: &usize| onward_m(net, meet, back.get(..*n).unwrap_or_default()) >= ONWARD_M;
        let new = |n: &usize| n.checked_sub(1).and_then(|n| back.get(n)).is_some_and(|node| taken.can_end(*node));
        let long = (1..=back.len()).find(|n| far(n) && new(n)).or_else(|| (1..=back.len()).find(far));
        back.truncate(long.unwrap_or(back.len()));
    }
    let ideal = ideal_m(human, net, route);
    // Where the robot goes on to, and the nodes beyond its goal.
    let after = route.nodes.get(route.meet + 1..)?;
    let last = *after.last()?;
    let tree = net.tree(last, &|node| route.nodes.contains(&node) && node != last || net.inside(node));
    let mut starts: Vec<Vec<usize>> = (1..=after.len()).filter_map(|n| after.get(..n)).map(<[usize]>::to_vec).collect();
    for beyond in (0..net.len()).filter(|node| tree.length_m(*node) > 0.0 && tree.length_m(*node) <= 10.0) {
        let mut ahead = after.to_vec();
        ahead.extend(tree.way(beyond).into_iter().skip(1));
        starts.push(ahead);
    }
    // Where it turns into a room, others come along the passage from beyond the door instead of out of the doorway.
    let passage = |node: &usize| !net.inside(*node) && net.kind(*node) != PlaceClass::Doorway;
    let out: Vec<usize> = after.iter().copied().take_while(|node| passage(node)).collect();
    let mut beyond_door = Vec::new();
    if let Some(turn) = out.last().copied().filter(|_| net.inside(last)) {
        let tree = net.tree(turn, &|node| route.nodes.contains(&node) || !passage(&node));
        for beyond in (0..net.len()).filter(|node| tree.length_m(*node) > 0.0 && tree.length_m(*node) <= 10.0) {
            let mut ahead = out.clone();
            ahead.extend(tree.way(beyond).into_iter().skip(1));
            beyond_door.push(ahead);
        }
    }
    let cost = |ahead: &Vec<usize>| {
        let length = onward_m(net, meet, ahead);
        let inside = ahead.iter().filter(|node| net.inside(**node)).count() as f64;
        // Who could not be in time even in a hurry would have to start in the middle of its way.
        let late = if length > HURRY_MPS * before_m(net, route) / ROBOT_MPS + LATE_M { 30.0 } else { 0.0 };
        (length - ideal).abs() + if length < 3.0 { 20.0 } else { 0.0 } + 6.0 * inside + late
    };
    let free = |ahead: &Vec<usize>| ahead.last().is_some_and(|start| taken.free(*start));
    let pick = |starts: Vec<Vec<usize>>| {
        let costed = starts.into_iter().filter(free).map(|ahead| (cost(&ahead), ahead));
        costed.min_by(|a, b| a.0.total_cmp(&b.0).then_with(|| a.1.cmp(&b.1)))
    };
    let own = pick(starts);
    // One alone may come out of a doorway, several side by side do not.
    let alone = |node: &usize| human.group.is_none() && !net.inside(*node);
    let outside = own.as_ref().and_then(|(_, ahead)| ahead.last()).is_some_and(|node| passage(node) || alone(node));
    let best = if outside { own } else { pick(beyond_door).or(own) }?;
    let mut nodes: Vec<usize> = best.1.into_iter().rev().collect();
    nodes.push(meet);
    nodes.extend(back);
    let mut cost = best.0 * 0.2;
    if human.goal.is_none() {
        onward(&mut nodes, taken);
        cost += taken.end_cost(&nodes);
    }
    Some(Way { nodes, meet, cost })
}

/// Into the room or car at the end of a way: to a place of it where nobody else goes.
fn indoors(net: &Net<'_>, class: PlaceClass, back: &mut Vec<usize>, taken: &[usize]) {
    let Some(entry) = back.iter().position(|node| net.inside(*node)) else { return };
    back.truncate(entry + 1);
    let Some(first) = back.last().copied() else { return };
    let tree = net.tree(first, &|node| !net.inside(node));
    let all = place::inside(net.location, Some(class));
    let free = all.iter().filter_map(|id| net.index(id)).filter(|node| tree.length_m(*node).is_finite());
    // The deepest first, so that the next one finds room.
    let end = free.filter(|node| !taken.contains(node)).max_by(|a, b| tree.length_m(*a).total_cmp(&tree.length_m(*b)));
    if let Some(end) = end {
        back.extend(tree.way(end).into_iter().skip(1));
    }
}

/// Lengthens a way that ends where somebody else's does, straight on, to the next node where nobody ends.
fn onward(nodes: &mut Vec<usize>, taken: &Taken<'_>) {
    let net = taken.net;
    for _ in 0..4 {
        let (Some(last), Some(previous)) =
            (nodes.last().copied(), nodes.len().checked_sub(2).and_then(|i| nodes.get(i)).copied())
        else {
            return;
        };
        if taken.can_end(last) {
            return;
        }
        let next = net.near(last).iter().map(|(node, _)| *node);
        let next = next.filter(|node| !nodes.contains(node) && !net.inside(*node));
        let turn = |node: usize| net.straight(previous, last, node) - if taken.can_end(node) { 0.0 } else { 0.5 };
        let Some(next) = next.max_by(|a, b| turn(*a).total_cmp(&turn(*b))) else { return };
        nodes.push(next);
    }
}

/// Whoever the robot follows goes on past the robot's goal, so that both get to where they go.
pub(crate) fn led_past(mut way: Way, taken: &Taken<'_>) -> Way {
    onward(&mut way.nodes, taken);
    way.cost += taken.end_cost(&way.nodes);
    way
}

fn onward_m(net: &Net<'_>, from: usize, nodes: &[usize]) -> f64 {
    let mut all = vec![from];
    all.extend(nodes);
    net.length_m(&all)
}

/// Across: in by one way that the robot does not use, out by another.
fn crossing(human: &HumanProposal, route: &Route, taken: &Taken<'_>) -> Option<Way> {
    let net = taken.net;
    let meet = *route.nodes.get(route.meet)?;
    let used =
        [route.meet.checked_sub(1).and_then(|i| route.nodes.get(i)).copied(), route.nodes.get(route.meet + 1).copied()];
    let free: Vec<usize> = net
        .near(meet)
        .iter()
        .map(|(node, _)| *node)
        .filter(|node| !used.contains(&Some(*node)) && !route.nodes.contains(node))
        .collect();
    let ideal = ideal_m(human, net, route);
    let into = used.first().copied().flatten()?;
    let mut best: Option<Way> = None;
    for entry in &free {
        let tree = net.tree(*entry, &|node| route.nodes.contains(&node));
        let step = onward_m(net, meet, &[*entry]);
        // Out by a free way if there is one, else along the robot's own; where it came from before where it goes to.
        let exits = free.iter().copied().filter(|exit| exit != entry).chain(used.iter().copied().flatten());
        let tails: Vec<(usize, Vec<usize>, f64)> = exits
            .flat_map(|exit| {
                let mut tail = vec![*entry, meet, exit];
                let short = (exit, vec![meet, exit], taken.end_cost(&tail) + SHORT_TAIL);
                extend(net, &mut tail, meet, &|node| route.nodes.contains(&node) && node != exit);
                onward(&mut tail, taken);
                let cost = taken.end_cost(&tail);
                [(exit, tail.split_off(1), cost), short]
            })
            .collect();
        for start in (0..net.len()).filter(|start| tree.length_m(*start).is_finite() && taken.free(*start)) {
            let length = tree.length_m(start) + step;
            let way = tree.way(start);
            for (exit, tail, end_cost) in &tails {
                if way.iter().any(|node| tail.contains(node)) {
                    continue;
                }
                let side = net.straight(into, meet, *entry).abs();
                let turn = net.straight(*entry, meet, *exit);
                let own = if used.contains(&Some(*exit)) { OWN_WAY } else { 0.0 };
                // Where the robot turns, a way that cuts the same corner does not cross its own.
                let along = used.get(1).copied().flatten().map_or(0.0, |out| net.alike((into, out), (*entry, *exit)));
                let own = own + SAME_CORNER * (along - CROSSES).max(0.0);
                let into = net.inside(*exit) || net.kind(*exit) == PlaceClass::Doorway;
                let inside =
                    way.iter().filter(|node| net.inside(**node)).count() as f64 * 3.0 + if into { 2.0 } else { 0.0 };
                let cost = 0.2 * (length - ideal).abs() + if length < 3.0 { 10.0 } else { 0.0 } + 2.0 * side
                    - 0.5 * turn
                    + own
                    + inside
                    + end_cost;
                if best.as_ref().is_none_or(|best| cost < best.cost - 1e-9) {
                    let mut nodes: Vec<usize> = way.iter().rev().copied().collect();
                    nodes.extend(tail);
                    best = Some(Way { nodes, meet, cost });
                }
            }
        }
    }
    best
}

/// Lengthens a way, as straight as it goes, until it leads far enough from the meeting node.
fn extend(net: &Net<'_>, nodes: &mut Vec<usize>, meet: usize, barred: &dyn Fn(usize) -> bool) {
    while let Some(from) = nodes.iter().position(|node| *node == meet) {
        if net.length_m(nodes.get(from..).unwrap_or_default()) >= ONWARD_M {
            return;
        }
        let (Some(last), Some(previous)) =
            (nodes.last().copied(), nodes.len().checked_sub(2).and_then(|i| nodes.get(i)).copied())
        else {
            return;
        };
        let next = net
            .near(last)
            .iter()
            .map(|(node, _)| *node)
            .filter(|node| !nodes.contains(node) && !barred(*node))
            // Into a room only through its doorway, once that is entered.
            .filter(|node| !net.inside(*node) || net.kind(last) == PlaceClass::Doorway);
        let Some(next) =
            next.max_by(|a, b| net.straight(previous, last, *a).total_cmp(&net.straight(previous, last, *b)))
        else {
            return;
        };
        nodes.push(next);
    }
}

/// Whether somebody follows the robot or another human.
pub(crate) fn follows(human: &HumanProposal) -> bool {
    human.rules.iter().any(|rule| matches!(rule.act, Action::FollowRobot | Action::FollowHuman(_)))
}

/// Behind: the robot's way, from its start or from before it.
fn behind(human: &HumanProposal, route: &Route, taken: &Taken<'_>, along: bool) -> Option<Way> {
    let net = taken.net;
    let start = *route.nodes.first()?;
    let second = *route.nodes.get(1)?;
    // A node before the robot's start lets it be behind from the first moment on.
    let before = net
        .near(start)
        .iter()
        .filter(|(node, length)| !route.nodes.contains(node) && *length >= 1.5 && !net.inside(*node))
        .map(|(node, _)| *node)
        .max_by(|a, b| net.straight(*a, start, second).total_cmp(&net.straight(*b, start, second)));
    let mut nodes: Vec<usize> = before.into_iter().collect();
    nodes.extend(&route.nodes);
    // Somebody who only walks along is met on the way, before others are.
    let meet = if along && route.meet > 1 { route.meet - 1 } else { route.meet };
    // Who overtakes is level with the robot early, so that the way is long enough to get past it.
    let early = (1..=meet).find(|i| {
        let known = route.nodes.get(*i).is_some_and(|node| net.is(*node, taken.place));
        known && net.length_m(route.nodes.get(..=*i).unwrap_or_default()) >= EARLY_M
    });
    let meet = if follows(human) { meet } else { early.unwrap_or(meet) };
    let cost = if before.is_some() { 0.0 } else { 1.0 };
    Some(Way { nodes, meet: *route.nodes.get(meet)?, cost })
}

/// Ahead: the robot's way from a node further on, so that the robot comes up at the meeting node.
fn ahead(human: &HumanProposal, route: &Route, taken: &Taken<'_>) -> Option<Way> {
    let net = taken.net;
    let reach = before_m(net, route);
    let lead = (reach * (1.0 - human.speed_mps.unwrap_or(0.5).min(0.75) / ROBOT_MPS)).max(2.0);
    let wanted = if human.relation == Relation::Abreast { 1.5 } else { lead };
    let start =
        (1..=route.meet).filter(|i| route.nodes.get(*i).is_some_and(|node| taken.free(*node))).min_by(|a, b| {
            let off = |i: usize| (net.length_m(route.nodes.get(..=i).unwrap_or_default()) - wanted).abs();
            off(*a).total_cmp(&off(*b))
        })?;
    let mut nodes = route.nodes.get(start..)?.to_vec();
    // Into a car or room the robot goes alone: whoever walks ahead ends before its door and lets it through.
    let shared = (route.meet - start + 2).min(nodes.len());
    let out = nodes.iter().skip(shared).position(|node| net.inside(*node)).map_or(nodes.len(), |n| shared + n);
    if out < nodes.len() {
        nodes.truncate(out);
        while nodes.len() > shared && nodes.last().is_some_and(|node| net.kind(*node) == PlaceClass::Doorway) {
            nodes.pop();
        }
    }
    // Nor does it stand in the robot's way there: it goes on past the door.
    if let (Some(last), Some(previous)) = (nodes.last().copied(), nodes.len().checked_sub(2).and_then(|i| nodes.get(i)))
        && route.nodes.get(start..).is_some_and(|own| nodes.len() < own.len())
    {
        let on =
            net.near(last).iter().map(|(node, _)| *node).filter(|node| {
                !route.nodes.contains(node) && !net.inside(*node) && net.kind(*node) != PlaceClass::Doorway
            });
        let turn = |node: usize| net.straight(*previous, last, node);
        let on = on.max_by(|a, b| turn(*a).total_cmp(&turn(*b)));
        nodes.extend(on);
    }
    let cost = if start == route.meet { 4.0 } else { 0.0 };
    Some(Way { nodes, meet: *route.nodes.get(route.meet)?, cost })
}

/// Standing: at the meeting node, or at the free node of the robot's way nearest to it; at a place by name with the others.
fn standing(route: &Route, taken: &Taken<'_>) -> Option<Way> {
    match taken.ends {
        Ends::Past if !taken.meant.is_empty() => return together(route, taken),
        Ends::Past => {}
        Ends::With => {
            let at = *route.nodes.last()?;
            return Some(Way { nodes: vec![at], meet: at, cost: 0.0 });
        }
        Ends::From => return Some(Way { nodes: vec![*route.nodes.first()?], meet: NOWHERE, cost: 0.0 }),
    }
    let last = route.nodes.len().checked_sub(1)?;
    let mut places: Vec<usize> = (1..last).collect();
    places.sort_by_key(|i| (i.abs_diff(route.meet), *i));
    let at = places.into_iter().filter_map(|i| route.nodes.get(i).copied()).find(|node| taken.free(*node))?;
    Some(Way { nodes: vec![at], meet: at, cost: 0.0 })
}

/// On from where somebody stood: off the robot's way if there is one, else along it, to where it turns off or ends.
fn walking_on(mut way: Way, route: &Route, taken: &Taken<'_>) -> Way {
    let net = taken.net;
    let Some(from) = way.nodes.first().and_then(|at| route.nodes.iter().position(|node| node == at)) else {
        return way;
    };
    for at in route.nodes.get(from..).unwrap_or_default() {
        if way.nodes.last() != Some(at) {
            way.nodes.push(*at);
        }
        let off =
            |node: &usize| !route.nodes.contains(node) && !net.inside(*node) && net.kind(*node) != PlaceClass::Doorway;
        let off = net.near(*at).iter().map(|(node, _)| *node).filter(off);
        if let Some(off) = off.max_by_key(|node| taken.can_end(*node)) {
            way.nodes.push(off);
            break;
        }
    }
    way
}

/// At the node of a place by name that has the fewest people so far.
fn together(route: &Route, taken: &Taken<'_>) -> Option<Way> {
    let net = taken.net;
    let there = |i: &usize| route.nodes.get(*i).is_some_and(|node| taken.meant.contains(node));
    // Where the robot's way ends they are last: it has to pass the others to get to them.
    let rank = |i: &usize| {
        let node = route.nodes.get(*i);
        let others = taken.standing.iter().filter(|other| Some(*other) == node).count();
        (others + usize::from(i + 1 == route.nodes.len()), i.abs_diff(route.meet), *i)
    };
    let at = (1..route.nodes.len()).filter(there).min_by_key(rank)?;
    let near = (SEEN_M - net.length_m(route.nodes.get(..=at)?)).max(0.0);
    let node = *route.nodes.get(at)?;
    Some(Way { nodes: vec![node], meet: node, cost: near })
}

fn sources(human: &HumanProposal, location: &Location) -> Option<PlaceClass> {
    human.start.filter(|class| !place::inside(location, Some(*class)).is_empty())
}

/// Out of a room or car, through its door, over the meeting node and on.
fn leaving(human: &HumanProposal, route: &Route, taken: &Taken<'_>) -> Option<Way> {
    let net = taken.net;
    let meet = *route.nodes.get(route.meet)?;
    let car = sources(human, net.location) == Some(PlaceClass::Elevator);
    let before: Vec<usize> = route.nodes.get(..route.meet)?.to_vec();
    let beyond = route.nodes.get(route.meet + 1).copied();
    let inside: Vec<usize> =
        place::inside(net.location, sources(human, net.location)).iter().filter_map(|id| net.index(id)).collect();
    let inside = net.rooms_of(human.id, inside);
    // A room with one place only is the robot's when it ends there: nobody else comes out of it.
    let last = route.nodes.last().copied();
    let shared = |node: &usize| Some(*node) != last && same_door(net, *node, last);
    let enters = last.is_some_and(|last| net.inside(last)) && (car || inside.iter().any(shared));
    // Out of the very room that the robot enters, or of any other near by that is not on its way.
    let tree = net.tree(meet, &|node| before.contains(&node) || !enters && Some(node) == beyond);
    let same = |node: usize| !enters || same_door(net, node, route.nodes.last().copied());
    let start = inside
        .into_iter()
        .filter(|node| {
            same(*node)
                && tree.length_m(*node) >= 1.0
                && tree.length_m(*node) <= if car { 8.0 } else { 12.0 }
                && (car || Some(*node) != last)
        })
        .min_by(|a, b| tree.length_m(*a).total_cmp(&tree.length_m(*b)))?;
    let inward = tree.way(start);
    let mut nodes: Vec<usize> = inward.iter().rev().copied().collect();
    let entry = inward.get(1).copied()?;
    // Away from the robot if there is a way, else past it.
    let exits: Vec<usize> = net
        .near(meet)
        .iter()
        .map(|(node, _)| *node)
        .filter(|node| !nodes.contains(node) && !net.inside(*node))
        .collect();
    let from = route.meet.checked_sub(1).and_then(|i| route.nodes.get(i)).copied();
    let rank = |node: &usize| {
        let own = if Some(*node) == from {
            2.0
        } else if Some(*node) == beyond {
            1.0
        } else {
            0.0
        };
        let used = if taken.goals.contains(node) { 1.5 } else { 0.0 };
        net.straight(entry, meet, *node) - own - used
    };
    let exit = exits.into_iter().max_by(|a, b| rank(a).total_cmp(&rank(b)));
    nodes.extend(exit);
    extend(net, &mut nodes, meet, &|node| route.nodes.contains(&node) && Some(node) != exit);
    onward(&mut nodes, taken);
    let length = tree.length_m(start);
    Some(Way { nodes, meet, cost: 0.4 * (length - 4.0).max(0.0) + if exit.is_none() { 4.0 } else { 0.0 } })
}

/// Whether two places lie in one room or car.
pub(crate) fn same_door(net: &Net<'_>, a: usize, b: Option<usize>) -> bool {
    let both = net.id(a).zip(b.and_then(|b| net.id(b)));
    both.is_some_and(|(a, b)| net.enclosures.same(a, b))
}

/// Inside, as far from the door as it goes; met where the robot's way ends, or where it passes.
fn staying(human: &HumanProposal, route: &Route, taken: &Taken<'_>) -> Option<Way> {
    let net = taken.net;
    let last = *route.nodes.last()?;
    let meet = if net.inside(last) { last } else { *route.nodes.get(route.meet)? };
    let tree = net.tree(*route.nodes.get(route.meet)?, &|_| false);
    let inside = place::inside(net.location, sources(human, net.location));
    let mut all: Vec<usize> = inside.iter().filter_map(|id| net.index(id)).collect();
    if net.inside(last) {
        all.retain(|node| same_door(net, *node, Some(last)));
        let at = all.into_iter().max_by(|a, b| tree.length_m(*a).total_cmp(&tree.length_m(*b)))?;
        return Some(Way { nodes: vec![at], meet, cost: 0.0 });
    }
    let at = all.into_iter().min_by(|a, b| tree.length_m(*a).total_cmp(&tree.length_m(*b)))?;
    Some(Way { nodes: vec![at], meet, cost: 0.2 * tree.length_m(at) })
}
