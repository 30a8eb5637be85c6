//! The robot's ways that are tried, by what the scenario is: into a car, out of it, up to people, over a place.

use socrates_maps::Ground;
use socrates_model::{Clause, HumanProposal, PlaceClass, Predicate, Proposal, Relation};

use crate::breadth::Limits;
use crate::everybody::{Solution, everybody};
use crate::fit::{SQUEEZED, hides, overtakes, squeezed, suits, tight, width_m};
use crate::graph::{Net, Tree};
use crate::over_all::over_all;
use crate::people::boarding;
use crate::robot_way::{Route, Wish, over, score};
use crate::{Ends, Layout, inside, meant, spread};

/// Length of a way to people who stand, or away from them, that is aimed at, m.
const AIM_M: f64 = 12.0;
/// Places at which a way may begin or end that are tried, and other ends for each.
const PLACES: usize = 60;
const OTHER_ENDS: usize = 120;
/// More people than this who come towards the robot come as a stream.
const STREAM: usize = 8;

/// What every try of a problem shares.
#[derive(Clone, Copy)]
pub(crate) struct Scene<'a> {
    pub(crate) net: &'a Net<'a>,
    pub(crate) proposal: &'a Proposal,
    pub(crate) layout: Layout,
    /// Whether a few may start at one node: where there is no room for all to start apart.
    pub(crate) crowded: bool,
    /// How much is tried.
    pub(crate) limits: Limits,
}

/// Whether the robot's way ends inside the car or room that people leave, or go into.
fn enters(scene: &Scene<'_>) -> Option<Vec<usize>> {
    let Scene { net, proposal, .. } = *scene;
    let indoors = |human: &&HumanProposal| matches!(human.relation, Relation::Leaving | Relation::Staying);
    let class = match proposal.humans.iter().find(indoors) {
        Some(human) => human.start.unwrap_or(PlaceClass::Room),
        None => proposal.humans.iter().filter(|human| boarding::boards(human)).find_map(|human| human.goal)?,
    };
    let car = class == PlaceClass::Elevator;
    let goes_in = proposal.robot.goal == Some(class) || car;
    let all = inside::nodes(net, Some(class));
    // Into a room that others come out of the robot goes where it has a place besides theirs.
    let roomy =
        |node: &usize| car || all.iter().any(|other| other != node && inside::same_door(net, *other, Some(*node)));
    let cars: Vec<usize> = all.iter().copied().filter(roomy).collect();
    if goes_in && !cars.is_empty() { Some(cars) } else { None }
}

pub(crate) fn candidates(scene: &Scene<'_>, wish: &Wish) -> Vec<Solution> {
    let Scene { net, proposal, .. } = *scene;
    if !net.elsewhere.is_empty() {
        return over_all(scene, wish, enters(scene).as_deref());
    }
    if let Some(inside) = enters(scene) {
        return inside.iter().flat_map(|goal| into(scene, wish, *goal)).collect();
    }
    if let Some(class) = scene.layout.start.filter(|class| proposal.robot.start == Some(*class)) {
        let inside = inside::nodes(net, Some(class));
        return inside.into_iter().flat_map(|start| out_of(scene, wish, start)).collect();
    }
    let meant = meant::indices(net, proposal);
    if !meant.is_empty() && scene.layout.ends == Ends::Past {
        let there = at_meant(scene, wish, &meant);
        if !there.is_empty() {
            return there;
        }
    }
    let walkers = proposal.humans.iter().filter(|human| human.relation == Relation::Frontal).count();
    let typed: Vec<usize> =
        socrates_maps::place::nodes_of(net.location, wish.place).iter().filter_map(|id| net.index(id)).collect();
    let nodes: Vec<usize> = if wish.place == PlaceClass::Plain { (0..net.len()).collect() } else { typed };
    // Those near where the task begins or ends come first: of a very large map the others are not tried.
    let mut near = nodes.clone();
    near.sort_by(|a, b| net.astray(*a).total_cmp(&net.astray(*b)));
    near.truncate(PLACES);
    match scene.layout.ends {
        Ends::With => return near.into_iter().flat_map(|node| to_node(scene, wish, node)).collect(),
        Ends::From => {
            return near.into_iter().flat_map(|node| from_node(scene, wish, node)).collect();
        }
        Ends::Past => {}
    }
    // A crowd comes as a stream: two or three from each node.
    let found = at_nodes(&Scene { crowded: scene.crowded || walkers > STREAM, ..*scene }, wish, &nodes);
    if !found.is_empty() {
        return found;
    }
    // Where every place of the class is a dead end the robot comes to those who stand there; others are met right before it.
    let there = at_meant(scene, wish, &near);
    if there.is_empty() { at_nodes(scene, wish, &before(net, &near)) } else { there }
}

/// Nodes next to places, and on the other side of a doorway next to them, which are none of the places.
fn before(net: &Net<'_>, places: &[usize]) -> Vec<usize> {
    let mut found: Vec<usize> = Vec::new();
    for (next, _) in places.iter().flat_map(|place| net.near(*place)) {
        let mut beside = vec![*next];
        if net.kind(*next) == PlaceClass::Doorway {
            beside.extend(net.near(*next).iter().map(|(node, _)| *node));
        }
        for node in beside {
            if !places.contains(&node) && !found.contains(&node) {
                found.push(node);
            }
        }
    }
    found
}

/// Ways to a place by name: through it, or into it where it is a dead end.
fn at_meant(scene: &Scene<'_>, wish: &Wish, meant: &[usize]) -> Vec<Solution> {
    let Scene { net, proposal, .. } = *scene;
    let wish = &Wish { indoors: true, ..*wish };
    let moves = |human: &HumanProposal| !human.relation.stands();
    let mut found = at_nodes(scene, wish, meant);
    if proposal.humans.iter().any(|human| !moves(human)) {
        let walkers = proposal.humans.iter().any(moves);
        for goal in meant.iter().filter(|node| net.near(**node).len() < 2 || net.inside(**node)) {
            found.extend(up_to(scene, wish, *goal, walkers));
        }
    }
    found
}

/// The robot's ways that end with people who stand at a place; whoever walks is met on the way there.
fn up_to(scene: &Scene<'_>, wish: &Wish, goal: usize, walkers: bool) -> Vec<Solution> {
    let net = scene.net;
    let tree = net.tree(goal, &|_| false);
    let wish = Wish { aim_m: 14.0, straight: 0.0, goal: None, ..*wish };
    let mut routes: Vec<Route> = outside(net, &tree, goal)
        .filter_map(|start| {
            let nodes: Vec<usize> = tree.way(start).into_iter().rev().collect();
            let open = |node: &usize| !net.inside(*node) && net.kind(*node) != PlaceClass::Doorway;
            let last = nodes.len().checked_sub(1)?;
            let meet = if walkers { (1..last).rev().find(|i| nodes.get(*i).is_some_and(open))? } else { last };
            let value = score(net, &nodes, meet, &wish);
            value.is_finite().then_some(Route { nodes, meet, score: value + 6.0 })
        })
        .collect();
    best(scene, &mut routes);
    routes.into_iter().flat_map(|route| everybody(scene, &route)).collect()
}

/// Cost of a place where whoever comes out of a room finds no way across.
const NOT_ACROSS: f64 = 10.0;

fn at_nodes(scene: &Scene<'_>, wish: &Wish, nodes: &[usize]) -> Vec<Solution> {
    let Scene { net, proposal, .. } = *scene;
    let crossing = proposal.humans.iter().any(|human| human.relation == Relation::Crossing);
    // Somebody who comes out of a room and has to cross needs a way on that is not the robot's.
    let crosses = |human: &HumanProposal| {
        let own =
            |clause: &Clause| matches!(&clause.predicate, Predicate::Crosses { human: who, .. } if *who == human.id);
        human.relation == Relation::Leaving && proposal.expected_events.iter().any(|clause| clause.must && own(clause))
    };
    let out_and_across = proposal.humans.iter().any(crosses);
    let standing = proposal.humans.iter().filter(|human| human.relation == Relation::Static).count();
    let overtakers = proposal.humans.iter().filter(|human| overtakes(human)).count();
    let beside = proposal.humans.iter().any(|human| human.relation == Relation::Abreast);
    let overtaken = overtakers > 0 || beside;
    let ground = Ground::of(&net.location.grid);
    let field = (standing > 0 || overtaken).then(|| ground.field());
    // People who come out are met near the place that they leave.
    let leaver = proposal.humans.iter().find(|human| human.relation == Relation::Leaving);
    let sources: Option<Vec<Tree>> = leaver.map(|human| {
        let inside = net.rooms_of(human.id, inside::nodes(net, human.start));
        inside.into_iter().map(|node| net.tree(node, &|_| false)).collect()
    });
    let abreast = proposal.groups.iter().any(|group| !group.standing && group.members.len() > 2);
    let many = proposal.humans.len() > 3 || abreast;
    let sight = (wish.place == PlaceClass::BlindCorner).then(|| ground.sight());
    let mut ranked: Vec<(f64, usize)> = nodes
        .iter()
        .filter(|node| (!net.inside(**node) || wish.indoors) && net.near(**node).len() >= 2)
        .filter(|node| suits(&scene.layout, net.near(**node).len(), || width_m(ground.field(), &net.at(**node))))
        .map(|node| {
            let own = if net.kind(*node) == wish.place { 2.0 } else { 0.0 };
            let arms = net.near(*node).len();
            // Four ways let people cross straight; fewer than three let nobody cross. The way out of a room is one of them.
            let cross = if out_and_across {
                if arms >= 4 { 1.5 } else { -NOT_ACROSS }
            } else if !crossing {
                0.0
            } else if arms >= 4 {
                1.5
            } else if arms == 3 {
                0.0
            } else {
                -20.0
            };
            let clear_m = field.map_or(0.0, |field| field.clearance(&net.at(*node)));
            let room = if standing > 0 { 1.5 * clear_m.min(2.5) } else { 0.0 };
            let far = sources.as_ref().map_or(0.0, |trees| {
                let nearest = trees.iter().map(|tree| tree.length_m(*node)).fold(f64::INFINITY, f64::min);
                if nearest > 12.0 { -20.0 } else { -0.4 * (nearest - 3.0).max(0.0) }
            });
            (own + cross + room + far - net.astray(*node), *node)
        })
        .collect();
    ranked.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    ranked.truncate(scene.limits.nodes);
    let routes = scene.limits.routes.max(scene.limits.shared / ranked.len().max(1));
    let mut found = Vec::new();
    for (rank, meet) in ranked {
        for route in over(net, meet, wish).into_iter().take(routes) {
            let hidden = sight.map_or(0.0, |sight| if hides(net, sight, &route) { 3.0 } else { 0.0 });
            for mut solution in everybody(scene, &route) {
                // Many people do not get through a doorway against each other.
                let tight = solution.route.nodes.iter().filter(|node| tight(net, **node)).count() as f64;
                let squeezed = field
                    .filter(|_| overtaken)
                    .map_or(0.0, |field| squeezed(net, field, &solution.route, (overtakers > 1, beside)));
                let tight = 3.0 * tight + spread::squeezes(net, proposal, &solution.route, &solution.ways);
                solution.score += rank + hidden - if many || wish.roomy { tight } else { 0.0 } - SQUEEZED * squeezed;
                found.push(solution);
            }
        }
    }
    found
}

/// The robot's ways into a car or room: met is who leaves at the node before its door.
fn into(scene: &Scene<'_>, wish: &Wish, goal: usize) -> Vec<Solution> {
    let Scene { net, proposal, .. } = *scene;
    let tree = net.tree(goal, &|_| false);
    // The robot stops at the first node inside; whoever stays is further in.
    let entry = (0..net.len())
        .filter(|node| !net.inside(*node) && tree.way(*node).iter().rev().nth(1).is_some_and(|next| *next == goal))
        .count();
    if entry == 0 {
        return Vec::new();
    }
    // Where those who go in need a car of their own the robot's way leads past its door, which opens for it.
    let by = boarding::doors_beside(net, proposal, goal);
    let ways = |start: usize| {
        let direct = Some(tree.way(start)).filter(|_| by.is_empty());
        let past = by.iter().filter_map(move |door| boarding::way_past(net, (goal, *door), start));
        direct.into_iter().chain(past).collect::<Vec<_>>()
    };
    // A room by name in which the robot starts is left first.
    let named = |start: usize| net.called(start, false) > 0.0 && !inside::same_door(net, start, Some(goal));
    let mut found: Vec<Solution> = (0..net.len())
        .filter(|start| (!net.inside(*start) || named(*start)) && tree.length_m(*start).is_finite())
        .flat_map(ways)
        .filter_map(|mut nodes| {
            nodes.reverse();
            let left = nodes.first().copied().filter(|start| net.inside(*start));
            let own = |node: usize| left.is_some_and(|start| inside::same_door(net, node, Some(start)));
            let inside = nodes.iter().filter(|node| net.inside(**node) && !own(**node)).count();
            if inside != 1 {
                return None;
            }
            // The last node that is neither inside nor in the doorway.
            let meet = (1..nodes.len()).rev().find(|i| {
                nodes.get(*i).is_some_and(|node| !net.inside(*node) && net.kind(*node) != PlaceClass::Doorway)
            })?;
            let value = score(net, &nodes, meet, &Wish { aim_m: 14.0, straight: 0.0, goal: None, ..*wish });
            if !value.is_finite() {
                return None;
            }
            Some(Route { nodes, meet, score: value + 4.0 })
        })
        .flat_map(|route| everybody(scene, &route))
        .collect();
    found.sort_by(|a, b| b.score.total_cmp(&a.score));
    found.truncate(scene.limits.routes);
    found
}

/// Points of a way out of a room that others can cross.
const CROSSED: f64 = 6.0;
/// The robot's ways out of a car or room: met is who comes by at the first node outside.
fn out_of(scene: &Scene<'_>, wish: &Wish, start: usize) -> Vec<Solution> {
    let Scene { net, proposal, .. } = *scene;
    let tree = net.tree(start, &|_| false);
    let crossing = proposal.humans.iter().any(|human| human.relation == Relation::Crossing);
    let named = |goal: usize| net.called(goal, true) > 0.0 && !inside::same_door(net, goal, Some(start));
    let mut routes: Vec<Route> = (0..net.len())
        .filter(|goal| !net.inside(*goal) || named(*goal))
        .filter(|goal| tree.length_m(*goal).is_finite())
        .filter_map(|goal| {
            let nodes = tree.way(goal);
            let meet = nodes.iter().position(|node| !net.inside(*node) && net.kind(*node) != PlaceClass::Doorway)?;
            let out = nodes.get(meet..)?.iter().all(|node| !net.inside(*node) || *node == goal);
            if meet == 0 || !out || meet + 1 >= nodes.len() {
                return None;
            }
            let value = score(net, &nodes, meet, &Wish { aim_m: 14.0, straight: 0.5, start: None, ..*wish });
            let arms = net.near(*nodes.get(meet)?).len();
            // Only a way straight on over a place of four ways is crossed there: one that turns into another runs along it.
            let straight_on = spread::straight_over(net, &nodes, meet);
            let cross = match (crossing, arms) {
                (false, _) => 0.0,
                (true, 0..3) => -20.0,
                (true, _) if arms > 3 && straight_on => CROSSED,
                (true, _) => -CROSSED,
            };
            value.is_finite().then_some(Route { nodes, meet, score: value + cross })
        })
        .collect();
    best(scene, &mut routes);
    routes.into_iter().flat_map(|route| everybody(scene, &route)).collect()
}

/// The robot's ways to people who stand at a node, where it stays.
fn to_node(scene: &Scene<'_>, wish: &Wish, node: usize) -> Vec<Solution> {
    let net = scene.net;
    let wish = Wish { aim_m: AIM_M, straight: 0.0, goal: None, ..*wish };
    at_end(scene, node, |mut nodes| {
        nodes.reverse();
        let meet = nodes.len().checked_sub(1)?;
        let score = score(net, &nodes, meet, &wish);
        Some(Route { nodes, meet, score })
    })
}

/// The robot's ways away from people who stand at a node.
fn from_node(scene: &Scene<'_>, wish: &Wish, node: usize) -> Vec<Solution> {
    let net = scene.net;
    let wish = Wish { aim_m: AIM_M, straight: 0.0, start: None, ..*wish };
    at_end(scene, node, |nodes| {
        let score = score(net, &nodes, 1, &wish);
        Some(Route { nodes, meet: 0, score })
    })
}

/// The best of the robot's ways that have a node at one end; `route` makes one of the nodes from there on.
fn at_end(scene: &Scene<'_>, node: usize, route: impl Fn(Vec<usize>) -> Option<Route>) -> Vec<Solution> {
    let net = scene.net;
    if net.inside(node) || net.kind(node) == PlaceClass::Doorway {
        return Vec::new();
    }
    let tree = net.tree(node, &|_| false);
    let mut others: Vec<usize> = outside(net, &tree, node).collect();
    let rank = |other: usize| {
        let named = net.called(other, false).max(net.called(other, true));
        named - (tree.length_m(other) - AIM_M).abs()
    };
    others.sort_by(|a, b| rank(*b).total_cmp(&rank(*a)).then(a.cmp(b)));
    others.truncate(OTHER_ENDS);
    let mut routes: Vec<Route> = others
        .into_iter()
        .filter_map(|other| route(tree.way(other)))
        .filter(|route| route.score.is_finite())
        .map(|route| Route { score: route.score + roomy(net, node), ..route })
        .collect();
    best(scene, &mut routes);
    routes.into_iter().flat_map(|route| everybody(scene, &route)).collect()
}

fn outside(net: &Net<'_>, tree: &Tree, but: usize) -> impl Iterator<Item = usize> {
    (0..net.len()).filter(move |node| *node != but && !net.inside(*node) && tree.length_m(*node).is_finite())
}

/// Nodes with many ways have room around them.
fn roomy(net: &Net<'_>, node: usize) -> f64 {
    if net.kind(node) == PlaceClass::OpenArea { 2.0 } else { 0.0 }
}

pub(crate) fn best(scene: &Scene<'_>, routes: &mut Vec<Route>) {
    routes.sort_by(|a, b| b.score.total_cmp(&a.score).then_with(|| a.nodes.cmp(&b.nodes)));
    routes.truncate(scene.limits.routes);
}
