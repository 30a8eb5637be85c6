//! Paths for everybody: the meeting node, the robot's way over it, and everybody else's.

use std::collections::BTreeMap;

use socrates_maps::Ground;
use socrates_model::rule::{RobotDo, RobotWhen};
use socrates_model::{
    AgentId, Encounter, FORMAT, FaultCode, HumanId, HumanProposal, NodeId, Paths, PlaceClass, Proposal, Relation,
};
use socrates_prompts::Question;

use crate::NAME;
use crate::boards;
use crate::card::{Ends, card};
use crate::crowd;
use crate::draw::Draw;
use crate::edit_paths;
use crate::fit::{SQUEEZED, hides, layout, overtakes, squeezed, tight};
use crate::humans::{Taken, Way, led_past, same_door, way};
use crate::place;
use crate::routes::{Net, Route, Tree, Wish, over, score};
use crate::spot;
use crate::twice;

/// Shortest path of the robot that is taken where the map has no longer one, m.
pub(crate) const SHORTEST_M: f64 = 6.0;
/// Meeting nodes that are tried, and ways of the robot over each.
const NODES: usize = 14;
const ROUTES: usize = 10;
/// Answers within this much of the best are as good, and the seed picks among them.
const ALIKE: f64 = 2.5;

/// Who the robot speaks to as it comes near starts at least so much farther away, m, and what it costs not to.
const SETS_OFF_M: f64 = 1.5;
const EARLY: f64 = 8.0;
/// More people than this who come towards the robot come as a stream.
const STREAM: usize = 8;

/// A person who wants other paths is given one of so many.
const OTHERS: usize = 6;

struct Solution {
    route: Route,
    ways: BTreeMap<HumanId, Way>,
    /// Where somebody meets the robot for the second time.
    again: BTreeMap<HumanId, usize>,
    score: f64,
}

/// Answers a paths question. `None` where the map has no way at all that fits.
pub(crate) fn solve(question: &Question, proposal: &Proposal) -> Option<Paths> {
    let task = crate::task::read(&question.request.task, &question.location);
    let net = Net::new(&question.location);
    let rooms = spot::rooms(&net, question);
    let net = net
        .with_ends(
            &spot::ends(question, &task.starts, proposal.robot.start, false),
            &spot::ends(question, &task.goals, proposal.robot.goal, true),
        )
        .with_rooms(rooms);
    let told = |code: FaultCode| {
        let robot = |fault: &&socrates_model::Fault| fault.code == code && fault.at.human().is_none();
        u32::try_from(question.feedback.iter().filter(robot).count()).unwrap_or(0)
    };
    let via = task.via.map(|(class, _)| class);
    let wish = Wish { via, ..wish(proposal, told(FaultCode::GShort)) };
    // Who got stuck is not led through doorways and aisles again.
    let wish = Wish { roomy: question.feedback.iter().any(|fault| fault.code == FaultCode::DStuck), ..wish };
    let mut solutions = solutions(&net, proposal, &wish);
    if solutions.is_empty() {
        // Better another place than no answer; the checks and the person see what became of it.
        solutions = anywhere(&net, proposal, &wish, false);
    }
    if solutions.is_empty() {
        solutions = anywhere(&net, proposal, &wish, true);
    }
    solutions.sort_by(|a, b| b.score.total_cmp(&a.score).then_with(|| a.route.nodes.cmp(&b.route.nodes)));
    // What is wrong with the place moves on to the next meeting node, and so does a simulation in which they did not meet.
    let moves = question.feedback.iter().filter(|fault| moves(fault.code)).count();
    let mut seen: Vec<usize> = Vec::new();
    let mut best: Vec<&Solution> = Vec::new();
    for solution in &solutions {
        let node = solution.route.nodes.get(solution.route.meet).copied().unwrap_or(usize::MAX);
        if !seen.contains(&node) {
            seen.push(node);
            best.push(solution);
        }
    }
    let another = question.feedback.iter().any(|fault| fault.code == FaultCode::PPerson);
    if another {
        // A person wants others, not the same once more; where there are no others, the same are better than none.
        let former = question.refused.as_deref().and_then(|text| serde_json::from_str::<Paths>(text).ok());
        let others = |solution: &&Solution| {
            former.as_ref().is_none_or(|former| written(&net, solution, proposal).robot != former.robot)
        };
        let different: Vec<&Solution> = best.iter().copied().filter(others).collect();
        // The robot still has to get where its task says: the best answer knows where that is.
        let goal = best.first().and_then(|top| top.route.nodes.last());
        let there: Vec<&Solution> =
            different.iter().copied().filter(|other| other.route.nodes.last() == goal).collect();
        best = [there, different, best].into_iter().find(|some| !some.is_empty())?;
    }
    let top = best.first()?.score;
    let alike = best.iter().filter(|solution| solution.score >= top - ALIKE).count();
    let first = match moves {
        0 if another => Draw::new(question.seed, "other paths").below(best.len().min(OTHERS)),
        0 => Draw::new(question.seed, "paths").below(alike.clamp(1, 3)),
        moves => moves,
    };
    let chosen = best.get(first % best.len())?;
    let mut paths = written(&net, chosen, proposal);
    for human in &proposal.humans {
        let short = |fault: &&socrates_model::Fault| {
            fault.code == FaultCode::GShort && fault.at.names(AgentId::Human(human.id))
        };
        for _ in question.feedback.iter().filter(short).take(4) {
            edit_paths::lengthen(&net, &mut paths, human.id);
        }
    }
    Some(paths)
}

/// Whether a fault is one of the place of the meeting. A slip of the pen is none: then the same paths are written again.
const fn moves(code: FaultCode) -> bool {
    matches!(
        code,
        FaultCode::GMeet
            | FaultCode::GMeetEnd
            | FaultCode::GType
            | FaultCode::GRel
            | FaultCode::GColl
            | FaultCode::GGrp
            | FaultCode::DNoMeet
            | FaultCode::DStuck
            | FaultCode::DPen
            | FaultCode::DGroup
            | FaultCode::DSetup
    )
}

fn wish(proposal: &Proposal, shorts: u32) -> Wish {
    let has = |relation: Relation| proposal.humans.iter().any(|human| human.relation == relation);
    let straight = if proposal.place == PlaceClass::BlindCorner {
        -1.0
    } else if has(Relation::Frontal)
        || has(Relation::Crossing)
        || has(Relation::Ahead)
        || proposal.groups.iter().any(|group| group.standing)
    {
        1.0
    } else {
        0.3
    };
    let longer = f64::from(shorts.min(4));
    let twice = !twice::asked(proposal).is_empty();
    // Followers and overtakers need a longer way to show what they do.
    let along = has(Relation::Behind) || has(Relation::Ahead) || has(Relation::Abreast);
    Wish {
        start: proposal.robot.start,
        goal: proposal.robot.goal,
        place: proposal.place,
        via: None,
        roomy: false,
        indoors: proposal.place == PlaceClass::Room,
        straight,
        least_m: if twice { twice::LEAST_M } else { 6.5 } + 2.0 * longer,
        aim_m: if twice {
            twice::AIM_M
        } else if along {
            20.0
        } else {
            16.0
        } + 4.0 * longer,
    }
}

/// Whether the robot's way ends inside the car or room that people leave, or go into.
fn enters(net: &Net<'_>, proposal: &Proposal) -> Option<Vec<usize>> {
    let indoors = |human: &&HumanProposal| matches!(human.relation, Relation::Leaving | Relation::Staying);
    let class = match proposal.humans.iter().find(indoors) {
        Some(human) => human.start.unwrap_or(PlaceClass::Room),
        None => proposal.humans.iter().filter(|human| boards::boards(human)).find_map(|human| human.goal)?,
    };
    let car = class == PlaceClass::Elevator;
    let goes_in = proposal.robot.goal == Some(class) || car;
    let all: Vec<usize> = place::inside(net.location, Some(class)).iter().filter_map(|id| net.index(id)).collect();
    // Into a room that others come out of the robot goes where it has a place besides theirs.
    let roomy = |node: &usize| car || all.iter().any(|other| other != node && same_door(net, *other, Some(*node)));
    let cars: Vec<usize> = all.iter().copied().filter(roomy).collect();
    if goes_in && !cars.is_empty() { Some(cars) } else { None }
}

fn solutions(net: &Net<'_>, proposal: &Proposal, wish: &Wish) -> Vec<Solution> {
    let found = card(&proposal.pattern);
    if let Some(inside) = enters(net, proposal) {
        return inside.iter().flat_map(|goal| into(net, proposal, wish, *goal)).collect();
    }
    if let Some(class) = found.and_then(|card| card.start).filter(|class| proposal.robot.start == Some(*class)) {
        let inside = place::inside(net.location, Some(class));
        return inside
            .iter()
            .filter_map(|id| net.index(id))
            .flat_map(|start| out_of(net, proposal, wish, start))
            .collect();
    }
    let meant = spot::indices(net, proposal);
    if !meant.is_empty() && found.is_none_or(|card| card.ends == Ends::Past) {
        let there = at_meant(net, proposal, wish, &meant);
        if !there.is_empty() {
            return there;
        }
    }
    let walkers = proposal.humans.iter().filter(|human| human.relation == Relation::Frontal).count();
    let typed: Vec<usize> =
        socrates_maps::place::nodes_of(net.location, wish.place).iter().filter_map(|id| net.index(id)).collect();
    let nodes: Vec<usize> = if wish.place == PlaceClass::Plain { (0..net.len()).collect() } else { typed };
    match found.map(|card| card.ends) {
        Some(Ends::With) => return nodes.into_iter().flat_map(|node| to_node(net, proposal, wish, node)).collect(),
        Some(Ends::From) => {
            return nodes.into_iter().flat_map(|node| from_node(net, proposal, wish, node)).collect();
        }
        Some(Ends::Past) | None => {}
    }
    // So many come as a stream: two or three from each node.
    at_nodes(net, proposal, wish, &nodes, walkers > STREAM)
}

/// Ways to a place by name: through it, or into it where it is a dead end.
fn at_meant(net: &Net<'_>, proposal: &Proposal, wish: &Wish, meant: &[usize]) -> Vec<Solution> {
    let wish = &Wish { indoors: true, ..*wish };
    let moves = |human: &HumanProposal| !matches!(human.relation, Relation::Static | Relation::Staying);
    let mut found = at_nodes(net, proposal, wish, meant, false);
    if proposal.humans.iter().any(|human| !moves(human)) {
        let walkers = proposal.humans.iter().any(moves);
        for goal in meant.iter().filter(|node| net.near(**node).len() < 2 || net.inside(**node)) {
            found.extend(up_to(net, proposal, wish, *goal, walkers));
        }
    }
    found
}

/// The robot's ways that end with people who stand at a place; whoever walks is met on the way there.
fn up_to(net: &Net<'_>, proposal: &Proposal, wish: &Wish, goal: usize, walkers: bool) -> Vec<Solution> {
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
    best(&mut routes);
    routes.into_iter().filter_map(|route| people(net, proposal, route, false)).collect()
}

fn anywhere(net: &Net<'_>, proposal: &Proposal, wish: &Wish, crowded: bool) -> Vec<Solution> {
    let all: Vec<usize> = (0..net.len()).collect();
    let relaxed = Wish { least_m: SHORTEST_M, ..*wish };
    at_nodes(net, proposal, &relaxed, &all, crowded)
}

fn at_nodes(net: &Net<'_>, proposal: &Proposal, wish: &Wish, nodes: &[usize], crowded: bool) -> Vec<Solution> {
    let crossing = proposal.humans.iter().any(|human| human.relation == Relation::Crossing);
    let standing = proposal.humans.iter().filter(|human| human.relation == Relation::Static).count();
    let found = card(&proposal.pattern);
    let wide = found.and_then(|card| card.width_m);
    let overtakers = proposal.humans.iter().filter(|human| overtakes(human)).count();
    let overtaken = overtakers > 0;
    let ground = Ground::of(&net.location.grid);
    let field = (standing > 0 || wide.is_some() || overtaken).then(|| ground.field());
    // People who come out are met near the place that they leave.
    let leaver = proposal.humans.iter().find(|human| human.relation == Relation::Leaving);
    let sources: Option<Vec<Tree>> = leaver.map(|human| {
        let inside = place::inside(net.location, human.start);
        let inside = net.rooms_of(human.id, inside.iter().filter_map(|id| net.index(id)).collect());
        inside.into_iter().map(|node| net.tree(node, &|_| false)).collect()
    });
    let abreast = proposal.groups.iter().any(|group| !group.standing && group.members.len() > 2);
    let many = proposal.humans.len() > 3 || abreast;
    let sight = (wish.place == PlaceClass::BlindCorner).then(|| ground.sight());
    let mut ranked: Vec<(f64, usize)> = nodes
        .iter()
        .filter(|node| (!net.inside(**node) || wish.indoors) && net.near(**node).len() >= 2)
        .map(|node| {
            let own = if net.kind(*node) == wish.place { 2.0 } else { 0.0 };
            let arms = net.near(*node).len();
            // Four ways let people cross straight; fewer than three let nobody cross.
            let cross = if !crossing {
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
            (own + cross + room + far + layout(found, arms, clear_m) - net.astray(*node), *node)
        })
        .collect();
    ranked.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let mut found = Vec::new();
    for (rank, meet) in ranked.into_iter().take(NODES) {
        for route in over(net, meet, wish).into_iter().take(ROUTES) {
            let hidden = sight.map_or(0.0, |sight| if hides(net, sight, &route) { 3.0 } else { 0.0 });
            if let Some(mut solution) = people(net, proposal, route, crowded) {
                // Many people do not get through a doorway against each other.
                let tight = solution.route.nodes.iter().filter(|node| tight(net, **node)).count() as f64;
                let squeezed = field
                    .filter(|_| overtaken)
                    .map_or(0.0, |field| squeezed(net, field, &solution.route, overtakers > 1));
                let tight = 3.0 * tight + crowd::squeezes(net, proposal, &solution.route, &solution.ways);
                solution.score += rank + hidden - if many || wish.roomy { tight } else { 0.0 } - SQUEEZED * squeezed;
                found.push(solution);
            }
        }
    }
    found
}

/// The robot's ways into a car or room: met is who leaves at the node before its door.
fn into(net: &Net<'_>, proposal: &Proposal, wish: &Wish, goal: usize) -> Vec<Solution> {
    let tree = net.tree(goal, &|_| false);
    // The robot stops at the first node inside; whoever stays is further in.
    let entry = (0..net.len())
        .filter(|node| !net.inside(*node) && tree.way(*node).iter().rev().nth(1).is_some_and(|next| *next == goal))
        .count();
    if entry == 0 {
        return Vec::new();
    }
    // Where those who go in need a car of their own the robot's way leads past its door, which opens for it.
    let by = boards::doors_beside(net, proposal, goal);
    let ways = |start: usize| {
        let direct = Some(tree.way(start)).filter(|_| by.is_empty());
        let past = by.iter().filter_map(move |door| boards::way_past(net, (goal, *door), start));
        direct.into_iter().chain(past).collect::<Vec<_>>()
    };
    let mut found: Vec<Solution> = (0..net.len())
        .filter(|start| !net.inside(*start) && tree.length_m(*start).is_finite())
        .flat_map(ways)
        .filter_map(|mut nodes| {
            nodes.reverse();
            let inside = nodes.iter().filter(|node| net.inside(**node)).count();
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
            people(net, proposal, Route { nodes, meet, score: value + 4.0 }, false)
        })
        .collect();
    found.sort_by(|a, b| b.score.total_cmp(&a.score));
    found.truncate(ROUTES);
    found
}

/// The robot's ways out of a car or room: met is who comes by at the first node outside.
fn out_of(net: &Net<'_>, proposal: &Proposal, wish: &Wish, start: usize) -> Vec<Solution> {
    let tree = net.tree(start, &|_| false);
    let crossing = proposal.humans.iter().any(|human| human.relation == Relation::Crossing);
    let mut routes: Vec<Route> = (0..net.len())
        .filter(|goal| !net.inside(*goal) && tree.length_m(*goal).is_finite())
        .filter_map(|goal| {
            let nodes = tree.way(goal);
            let meet = nodes.iter().position(|node| !net.inside(*node) && net.kind(*node) != PlaceClass::Doorway)?;
            let out = nodes.get(meet..)?.iter().all(|node| !net.inside(*node));
            if meet == 0 || !out || meet + 1 >= nodes.len() {
                return None;
            }
            let value = score(net, &nodes, meet, &Wish { aim_m: 14.0, straight: 0.5, start: None, ..*wish });
            let arms = net.near(*nodes.get(meet)?).len();
            let cross = if crossing && arms < 3 {
                -20.0
            } else if crossing && arms > 3 {
                6.0
            } else {
                0.0
            };
            value.is_finite().then_some(Route { nodes, meet, score: value + cross })
        })
        .collect();
    best(&mut routes);
    routes.into_iter().filter_map(|route| people(net, proposal, route, false)).collect()
}

/// The robot's ways to people who stand at a node, where it stays.
fn to_node(net: &Net<'_>, proposal: &Proposal, wish: &Wish, node: usize) -> Vec<Solution> {
    let wish = Wish { aim_m: 12.0, straight: 0.0, goal: None, ..*wish };
    at_end(net, proposal, node, |mut nodes| {
        nodes.reverse();
        let meet = nodes.len().checked_sub(1)?;
        let score = score(net, &nodes, meet, &wish);
        Some(Route { nodes, meet, score })
    })
}

/// The robot's ways away from people who stand at a node.
fn from_node(net: &Net<'_>, proposal: &Proposal, wish: &Wish, node: usize) -> Vec<Solution> {
    let wish = Wish { aim_m: 12.0, straight: 0.0, start: None, ..*wish };
    at_end(net, proposal, node, |nodes| {
        let score = score(net, &nodes, 1, &wish);
        Some(Route { nodes, meet: 0, score })
    })
}

/// The best of the robot's ways that have a node at one end; `route` makes one of the nodes from there on.
fn at_end(
    net: &Net<'_>,
    proposal: &Proposal,
    node: usize,
    route: impl Fn(Vec<usize>) -> Option<Route>,
) -> Vec<Solution> {
    if net.inside(node) || net.kind(node) == PlaceClass::Doorway {
        return Vec::new();
    }
    let tree = net.tree(node, &|_| false);
    let mut routes: Vec<Route> = outside(net, &tree, node)
        .filter_map(|other| route(tree.way(other)))
        .filter(|route| route.score.is_finite())
        .map(|route| Route { score: route.score + roomy(net, node), ..route })
        .collect();
    best(&mut routes);
    routes.into_iter().filter_map(|route| people(net, proposal, route, false)).collect()
}

fn outside(net: &Net<'_>, tree: &Tree, but: usize) -> impl Iterator<Item = usize> {
    (0..net.len()).filter(move |node| *node != but && !net.inside(*node) && tree.length_m(*node).is_finite())
}

/// Nodes with many ways have room around them.
fn roomy(net: &Net<'_>, node: usize) -> f64 {
    if net.kind(node) == PlaceClass::OpenArea { 2.0 } else { 0.0 }
}

fn best(routes: &mut Vec<Route>) {
    routes.sort_by(|a, b| b.score.total_cmp(&a.score).then_with(|| a.nodes.cmp(&b.nodes)));
    routes.truncate(ROUTES);
}

/// Everybody's way for one way of the robot.
fn people(net: &Net<'_>, proposal: &Proposal, route: Route, crowded: bool) -> Option<Solution> {
    let ends = card(&proposal.pattern).map_or(Ends::Past, |card| card.ends);
    let starts = route.nodes.first().copied().into_iter().collect();
    let goals = route.nodes.last().copied().into_iter().collect();
    let meant = spot::indices(net, proposal);
    let mut taken = Taken {
        net,
        starts,
        goals,
        crowded,
        ends,
        place: proposal.place,
        meant: &meant,
        standing: Vec::new(),
        boards: boards::count(proposal),
    };
    let mut ways: BTreeMap<HumanId, Way> = BTreeMap::new();
    let spread = crowd::spread(net, proposal, &route);
    let beside = |relation: Relation| matches!(relation, Relation::Behind | Relation::Ahead | Relation::Abreast);
    let along = proposal.humans.iter().any(|human| !beside(human.relation));
    let mut cost = 0.0;
    let near = proposal.robot.script.iter().filter(|line| matches!(line.act, RobotDo::Say(_)));
    let near = near.filter_map(|line| if let RobotWhen::HumanNear(m) = line.when { Some(m) } else { None });
    let says_m = near.fold(-SETS_OFF_M, f64::max);
    let twice = twice::asked(proposal);
    let mut again: BTreeMap<HumanId, usize> = BTreeMap::new();
    for human in &proposal.humans {
        // Members of a group go together; people of one room leave it one after the other.
        let mate = proposal
            .humans
            .iter()
            .filter(|other| other.group.is_some() && other.group == human.group)
            .find_map(|other| ways.get(&other.id).filter(|_| other.relation == human.relation));
        let led = human.rules.iter().find_map(|rule| {
            if let socrates_model::Action::FollowHuman(leader) = rule.act { ways.get(&leader) } else { None }
        });
        let led = led.filter(|way| way.nodes.len() > 1);
        let shared = mate.or_else(|| led.filter(|_| matches!(human.relation, Relation::Frontal | Relation::Ahead)));
        let own = match shared {
            Some(way) if mate.is_some() || human.relation == Relation::Ahead => way.clone(),
            Some(leader) => after(net, leader, &taken)?,
            None => match spread.iter().find(|(id, _)| *id == human.id) {
                Some((_, meet)) => way(human, &Route { meet: *meet, ..route.clone() }, &taken, along)?,
                None => way(human, &route, &taken, along)?,
            },
        };
        let own = match twice.iter().find(|(id, _)| *id == human.id) {
            // A member of a group goes the way of the one before it, its second meeting included.
            Some(_) if mate.is_some() => {
                let of = proposal.humans.iter().filter(|other| other.group == human.group);
                again.extend(of.filter_map(|other| again.get(&other.id)).next().copied().map(|node| (human.id, node)));
                own
            }
            Some((_, class)) => match twice::second(net, &route, &own, (human.relation, *class)) {
                Some((own, node)) => {
                    again.insert(human.id, node);
                    own
                }
                None => Way { cost: own.cost + twice::ONLY_ONCE, ..own },
            },
            None => own,
        };
        let start_m =
            own.nodes.first().zip(route.nodes.first()).map(|(own, robot)| (net.at(*own) - net.at(*robot)).norm());
        // What the robot says to somebody near is said on the way, not before it sets off.
        if start_m.is_some_and(|m| m < says_m + SETS_OFF_M) && !beside(human.relation) {
            cost += EARLY;
        }
        let followed = proposal.robot.script.iter().any(|line| line.act == RobotDo::Follow(human.id));
        // Of many who walk ahead nobody ends where the robot does.
        let ahead = human.relation == Relation::Ahead && spread.iter().any(|(id, _)| *id == human.id);
        let own = if followed || ahead { led_past(own, &taken) } else { own };
        cost += own.cost;
        if !matches!(human.relation, Relation::Leaving | Relation::Staying) && mate.is_none() {
            taken.starts.extend(own.nodes.first());
        }
        if human.relation == Relation::Static {
            taken.standing.extend(own.nodes.first());
        }
        if own.nodes.len() > 1 && mate.is_none() {
            taken.goals.extend(own.nodes.last());
        }
        ways.insert(human.id, own);
    }
    let score = route.score - cost;
    Some(Solution { route, ways, again, score })
}

/// The way of somebody who follows another human: the same, from the node before or after its start.
fn after(net: &Net<'_>, leader: &Way, taken: &Taken<'_>) -> Option<Way> {
    let first = *leader.nodes.first()?;
    let back = net
        .near(first)
        .iter()
        .map(|(node, _)| *node)
        .find(|node| !leader.nodes.contains(node) && !taken.starts.contains(node));
    let mut nodes: Vec<usize> = back.into_iter().collect();
    nodes.extend(leader.nodes.iter().skip(usize::from(back.is_none())));
    if nodes.len() < 2 || nodes.first() == Some(&leader.meet) {
        return None;
    }
    Some(Way { nodes, meet: leader.meet, cost: 0.5 })
}

fn written(net: &Net<'_>, solution: &Solution, proposal: &Proposal) -> Paths {
    let order = |node: &usize| solution.route.nodes.iter().position(|other| other == node).unwrap_or(usize::MAX);
    let mut meetings: Vec<(HumanId, usize)> = solution.ways.iter().map(|(id, way)| (*id, way.meet)).collect();
    meetings.extend(solution.again.iter().map(|(id, node)| (*id, *node)));
    meetings.sort_by_key(|(id, node)| (order(node), *id));
    let encounters: Vec<Encounter> = meetings
        .into_iter()
        .filter_map(|(human, node)| net.id(node).map(|node| Encounter { human, node: node.clone() }))
        .collect();
    let humans: BTreeMap<HumanId, Vec<NodeId>> =
        solution.ways.iter().map(|(id, way)| (*id, net.named(&way.nodes))).collect();
    let length = libm::round(net.length_m(&solution.route.nodes) * 10.0) / 10.0;
    let mut at: Vec<String> = Vec::new();
    for encounter in &encounters {
        let node = format!("`{}`", encounter.node);
        if !at.contains(&node) {
            at.push(node);
        }
    }
    let reasoning = format!(
        "The robot goes {length} m over a meeting place that is {} ({}); {} encounters lie on its way in this order.",
        place::an(proposal.place),
        at.join(", "),
        encounters.len()
    );
    Paths {
        format: FORMAT,
        robot: net.named(&solution.route.nodes),
        humans,
        encounters,
        reasoning,
        author: NAME.into(),
    }
}
