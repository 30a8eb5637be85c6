//! Why there are no paths: what does not fit, where, and by how much.

use std::collections::BTreeSet;
use std::fmt;

use socrates_maps::Ground;
use socrates_maps::openings::OpenPlan;
use socrates_model::proposal::WayPart;
use socrates_model::{Door, HumanId, HumanProposal, NodeId, PlaceClass, Point, Predicate, Relation, Side};

use crate::graph::Net;
use crate::measure::SHORTEST_M;
use crate::passable::{Closed, Why};
use crate::people::boarding;
use crate::{Problem, fit, inside, named_way, people, search, sides};

/// Floor that somebody needs who stands in a room with others, m²: a disc of 0.28 m and what keeps it from the next.
const PERSON_M2: f64 = 0.5;
/// A room that no walls bound is looked at so far about its node, m.
const ROOM_M: f64 = 5.0;

/// Why a map has no paths for a problem: the nearest miss, with its place and its numbers.
#[derive(Debug, Clone, PartialEq)]
pub enum Miss {
    /// The robot's start and goal are one place.
    OnePlace {
        /// The place.
        node: NodeId,
        /// Where it lies.
        at: Point,
    },
    /// No way of the graph joins two places.
    Apart {
        /// The robot's start.
        from: NodeId,
        /// Its goal.
        to: NodeId,
        /// How many nodes ways join to the start, and how many to the goal, themselves counted.
        nodes: [usize; 2],
    },
    /// The robot is wider than every way to its goal, or people are wider than every way to where they should be met.
    Narrow {
        /// Whether people are, who are a little wider than most robots.
        people: bool,
        /// The robot's start, or where people come from.
        from: NodeId,
        /// The robot's goal, or the place of the meeting.
        to: NodeId,
        /// The edge that is too narrow.
        between: [NodeId; 2],
        /// Its narrowest point.
        at: Point,
        /// Width there, m.
        has_m: f64,
        /// Width of the robot, or of the floor that people get through, m.
        needs_m: f64,
    },
    /// A door on every way to the goal never opens.
    Shut {
        /// The robot's start, or a place in the room that somebody should come out of.
        from: NodeId,
        /// The robot's goal, or the place before the room.
        to: NodeId,
        /// The door.
        door: String,
        /// Its middle.
        at: Point,
    },
    /// The only rooms or cars that somebody should come out of, stay in or go into have no opening.
    OpenPlan {
        /// A place in one of them.
        node: NodeId,
        /// Where it lies.
        at: Point,
        /// Why it has none.
        why: OpenPlan,
    },
    /// The longest way of the robot is too short.
    Short {
        /// Its ends; none where the map has no node outside of rooms.
        ends: Option<(NodeId, NodeId)>,
        /// Its length, m.
        has_m: f64,
        /// The least length, m.
        needs_m: f64,
    },
    /// The map has no place of the class.
    NoPlace(PlaceClass),
    /// Too few ways meet at every place of the class.
    Arms {
        /// The class.
        class: PlaceClass,
        /// The place where most ways meet.
        node: NodeId,
        /// How many.
        has: usize,
        /// How many are needed.
        needs: usize,
    },
    /// No place of the class is as wide as the pattern wants it.
    Width {
        /// The class.
        class: PlaceClass,
        /// The place whose width comes nearest.
        node: NodeId,
        /// Its free width, m.
        has_m: f64,
        /// Least and largest width, m.
        needs_m: [f64; 2],
    },
    /// A room or car is too small for those who are in it.
    Full {
        /// The place inside that has most room.
        node: NodeId,
        /// Floor there, m².
        has_m2: f64,
        /// How many people are to be there, the robot counted where it enters.
        people: usize,
        /// Floor that they need, m².
        needs_m2: f64,
    },
    /// Somebody cannot be led to the robot's way as they should.
    People {
        /// They, how they stand to the robot's way, and where they come from.
        who: Vec<(HumanId, Relation, Option<PlaceClass>)>,
        /// The class of the place.
        class: PlaceClass,
    },
    /// Somebody cannot be on the side of the robot's way on which they should be.
    Side {
        /// They, how they stand to the robot's way, and on which side of it.
        who: Vec<(HumanId, Relation, Side)>,
        /// The class of the place.
        class: PlaceClass,
    },
    /// No way of the robot leads over the places of all who meet it.
    Elsewhere {
        /// They who meet it at a place of their own, with its nodes.
        who: Vec<(HumanId, Vec<NodeId>)>,
        /// The class of the place of the others.
        class: PlaceClass,
    },
    /// No way of the robot begins, ends, leads past or keeps out where it should by name.
    Way {
        /// The parts of the way, with the nodes that count.
        parts: Vec<(WayPart, Vec<NodeId>)>,
    },
    /// Each alone could meet the robot, all together cannot.
    Together {
        /// How many.
        people: usize,
        /// The class of the place.
        class: PlaceClass,
    },
}

impl fmt::Display for Miss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let an = |class: &PlaceClass| inside::an(*class);
        match self {
            Self::OnePlace { node, at } => write!(
                f,
                "the robot's start and goal are one place, `{node}` at ({:.2}, {:.2}); name another goal, or leave one of them open",
                at.x, at.y
            ),
            Self::Apart { from, to, nodes: [here, there] } => write!(
                f,
                "no way leads from `{from}` to `{to}`: they lie in parts of the map that no edge joins, of {here} and {there} nodes; \
                 take another goal, or join them"
            ),
            Self::Narrow { people, from, to, between: [a, b], at, has_m, needs_m } => {
                let (who, hint) = if *people {
                    ("people need", "another place, or widen it")
                } else {
                    ("the robot needs", "a smaller robot or another goal")
                };
                write!(
                    f,
                    "{who} {needs_m:.2} m, and the way from `{from}` to `{to}` has {has_m:.2} m between `{a}` and `{b}`, at \
                     ({:.2}, {:.2}); take {hint}",
                    at.x, at.y
                )
            }
            Self::Shut { from, to, door, at } => write!(
                f,
                "the door `{door}` at ({:.2}, {:.2}) on the way from `{from}` to `{to}` never opens; take another place, or let it open",
                at.x, at.y
            ),
            Self::OpenPlan { node, at, why } => write!(
                f,
                "nobody can come out of `{node}` at ({:.2}, {:.2}) or go in: {why}; take another place, or give it a doorway or a door",
                at.x, at.y
            ),
            Self::Short { ends: Some((from, to)), has_m, needs_m } => write!(
                f,
                "the longest path of the robot on this map, from `{from}` to `{to}`, is {has_m:.1} m; at least {needs_m} m are needed"
            ),
            Self::Short { ends: None, .. } => {
                f.write_str("this map has no node outside of rooms, where the robot could drive")
            }
            Self::NoPlace(class) => write!(f, "this map has no place that is {}", an(class)),
            Self::Arms { class, node, has, needs } => write!(
                f,
                "{needs} ways have to meet at {}; at `{node}`, where most do on this map, {has} meet",
                an(class)
            ),
            Self::Width { class, node, has_m, needs_m: [least_m, most_m] } => write!(
                f,
                "{} of {least_m} to {most_m} m is needed; `{node}`, which comes nearest on this map, has {has_m:.1} m",
                an(class)
            ),
            Self::Full { node, has_m2, people, needs_m2 } => write!(
                f,
                "{people} at `{node}` need {needs_m2:.1} m² of floor; there are {has_m2:.1} m²; ask for fewer, or for another room"
            ),
            Self::Way { parts } => f.write_str(&no_way(parts)),
            Self::Elsewhere { who, class } => {
                let places = who.iter().map(|(human, nodes)| format!("{human} at {}", quoted(nodes)));
                write!(
                    f,
                    "this map has no path of the robot on which it meets {}, and the others at {}; take places that lie on one way",
                    places.collect::<Vec<_>>().join(", "),
                    an(class)
                )
            }
            Self::Side { who, class } => f.write_str(&no_side(who, *class)),
            Self::People { who, class } => {
                let names = who.iter().map(|(id, relation, from)| {
                    let from = from.map_or_else(String::new, |class| format!(" from {}", inside::an(class)));
                    format!("{id} (`{}`{from})", relation.name())
                });
                let names = names.collect::<Vec<_>>().join(" and ");
                write!(
                    f,
                    "this map has no path of the robot on which it meets {names} at {}; ask for another place or another part, or \
                     add nodes to the map",
                    an(class)
                )
            }
            Self::Together { people, class } => write!(
                f,
                "this map has no paths on which all {people} humans meet the robot at {}, though each of them alone could; ask for \
                 fewer, or for another place",
                an(class)
            ),
        }
    }
}

fn quoted(nodes: &[NodeId]) -> String {
    nodes.iter().map(|node| format!("`{node}`")).collect::<Vec<_>>().join(", ")
}

/// That no way of the robot does what is asked of it by name.
fn no_way(parts: &[(WayPart, Vec<NodeId>)]) -> String {
    let part = |(part, nodes): &(WayPart, Vec<NodeId>)| format!("{} {}", part.does(), quoted(nodes));
    let parts = parts.iter().map(part).collect::<Vec<_>>().join(" and ");
    format!(
        "this map has no path of the robot that {parts} and on which it meets the people as they are asked for; take other places for \
         its way, or for the people"
    )
}

/// That nobody can be on the side of the robot's way on which they are asked for.
fn no_side(who: &[(HumanId, Relation, Side)], class: PlaceClass) -> String {
    let names = who.iter().map(|(id, relation, side)| format!("{id} (`{}`, `{}`)", relation.name(), side.name()));
    let names = names.collect::<Vec<_>>().join(" and ");
    format!(
        "this map has no path of the robot on which {names} would be on that side of its way at {}; take the other side, another place, \
         or leave the side out",
        inside::an(class)
    )
}

impl std::error::Error for Miss {}

/// What keeps a problem from having paths whatever is drawn, as far as that can be seen without a search for ways of people:
/// ends, widths, doors, rooms, and the length of the longest way.
#[must_use]
pub fn impossible(problem: &Problem<'_>) -> Option<Miss> {
    let net = Net::of(problem);
    // Where the robot may drive through rooms a map has ways that are not counted here.
    let short = || too_short(problem, &net).filter(|_| search::solve(problem).is_err());
    beforehand(problem, &net)
        .or_else(short)
        .or_else(|| sides::missing(problem, &net))
        .or_else(|| named_way::missing(problem))
}

/// What can be seen before anything is tried.
pub(crate) fn beforehand(problem: &Problem<'_>, net: &Net<'_>) -> Option<Miss> {
    let comes_out = |human: &&HumanProposal| human.relation == Relation::Leaving;
    one_place(problem, net)
        .or_else(|| unreachable(problem, net))
        .or_else(|| problem.proposal.humans.iter().filter(comes_out).find_map(|human| shut_in(problem, net, human)))
        .or_else(|| full(problem, net))
}

/// Start and goal by name that are the same, or the same few nodes beside each other.
fn one_place(problem: &Problem<'_>, net: &Net<'_>) -> Option<Miss> {
    let nodes = |ids: &[NodeId]| ids.iter().filter_map(|id| net.index(id)).collect::<BTreeSet<usize>>();
    let (starts, goals) = (nodes(&problem.starts), nodes(&problem.goals));
    let first = *starts.first()?;
    let near = |node: &usize| (net.at(*node) - net.at(first)).norm() < SHORTEST_M;
    let node = net.id(first).filter(|_| starts == goals && starts.iter().all(near))?.clone();
    Some(Miss::OnePlace { node, at: net.at(first) })
}

/// The reason why a map has no paths for a problem, found by leaving parts of it out.
pub(crate) fn of(problem: &Problem<'_>, net: &Net<'_>) -> Miss {
    let proposal = problem.proposal;
    let class = proposal.place;
    if let Some(miss) = elsewhere(problem, net) {
        return miss;
    }
    let indoors = || proposal.humans.iter().filter(|human| is_indoors(human) || boarding::boards(human));
    if let Some(miss) = too_short(problem, net).or_else(|| indoors().find_map(|human| shut_in(problem, net, human))) {
        return miss;
    }
    let own: Vec<usize> = (0..net.len()).filter(|node| net.is(*node, class)).collect();
    if class != PlaceClass::Plain && own.is_empty() {
        return Miss::NoPlace(class);
    }
    if let Some(miss) = narrow_place(problem, net, &own) {
        return miss;
    }
    let open = |node: &usize| !net.inside(*node);
    let nodes: Vec<usize> = if class == PlaceClass::Plain { (0..net.len()).collect() } else { own };
    let nodes: Vec<usize> = nodes.into_iter().filter(open).collect();
    if let Some(miss) = arms(problem, net, &nodes).or_else(|| width(problem, net, &nodes)) {
        return miss;
    }
    let alone = |human: &HumanProposal| {
        let mut one = proposal.clone();
        one.humans.retain(|other| other.id == human.id);
        one.groups.clear();
        !search::solutions(&Problem { proposal: &one, ..problem.clone() }, net).is_empty()
    };
    let stuck = proposal.humans.iter().filter(|human| !alone(human));
    let who: Vec<_> = stuck.map(|human| (human.id, human.relation, human.start)).collect();
    if let Some(miss) = sides::missing(problem, net).or_else(|| named_way::missing(problem)) {
        return miss;
    }
    if who.is_empty() { Miss::Together { people: proposal.humans.len(), class } } else { Miss::People { who, class } }
}

/// Two ends by name between which the robot cannot drive, and what stops it.
fn unreachable(problem: &Problem<'_>, net: &Net<'_>) -> Option<Miss> {
    let known = |ids: &[NodeId]| ids.iter().filter_map(|id| net.index(id)).collect::<Vec<usize>>();
    let (starts, goals) = (known(&problem.starts), known(&problem.goals));
    let (start, goal) = (*starts.first()?, *goals.first()?);
    let joined =
        |net: &Net<'_>| starts.iter().any(|from| goals.iter().any(|to| net.ways_from(*from).length_m(*to).is_finite()));
    if joined(net) {
        return None;
    }
    let (from, to) = (net.id(start)?.clone(), net.id(goal)?.clone());
    let whole = Net::new(problem.location);
    if !joined(&whole) {
        let joined_to = |node: usize| {
            let ways = whole.ways_from(node);
            (0..whole.len()).filter(|other| ways.length_m(*other).is_finite()).count()
        };
        return Some(Miss::Apart { from, to, nodes: [start, goal].map(joined_to) });
    }
    let way = whole.named(&whole.ways_from(start).way(goal));
    stopped(problem, net, &way, (from, to))
}

/// What closes a way of the map to the robot.
fn stopped(problem: &Problem<'_>, net: &Net<'_>, way: &[NodeId], (from, to): (NodeId, NodeId)) -> Option<Miss> {
    let on_way = |closed: &&Closed| {
        let [a, b] = &closed.between;
        way.windows(2).any(|step| matches!(step, [p, q] if p == a && q == b || p == b && q == a))
    };
    let closed = net.closed().iter().find(on_way)?;
    Some(match &closed.why {
        Why::Shut(door) => {
            let at = problem.location.door(door).map_or_else(Point::origin, Door::middle);
            Miss::Shut { from, to, door: door.clone(), at }
        }
        Why::Narrow(at, has_m) => Miss::Narrow {
            people: net.radius_m > problem.radius_m,
            from,
            to,
            between: closed.between.clone(),
            at: *at,
            has_m: *has_m,
            needs_m: 2.0 * net.radius_m,
        },
    })
}

/// The places of the class where all lie behind edges that are too narrow, or behind doors that never open.
fn narrow_place(problem: &Problem<'_>, net: &Net<'_>, places: &[usize]) -> Option<Miss> {
    let first = net.id(*places.first()?)?;
    if places.iter().any(|place| !net.near(*place).is_empty()) {
        return None;
    }
    let edge = net.closed().iter().find(|edge| edge.between.contains(first))?;
    let before = edge.between.iter().find(|end| *end != first)?;
    stopped(problem, net, &[before.clone(), first.clone()], (before.clone(), first.clone()))
}

/// The longest way of the robot, where it is too short for any scenario; what stops it where the map would have a longer one.
fn too_short(problem: &Problem<'_>, net: &Net<'_>) -> Option<Miss> {
    let (has_m, ends) = net.longest(SHORTEST_M);
    let ends = ends.and_then(|(from, to)| net.id(from).cloned().zip(net.id(to).cloned()));
    if has_m >= SHORTEST_M {
        return None;
    }
    let whole = Net::new(problem.location);
    if let (more_m, Some((start, goal))) = whole.longest(SHORTEST_M)
        && more_m >= SHORTEST_M
        && let (Some(from), Some(to)) = (whole.id(start).cloned(), whole.id(goal).cloned())
    {
        let way = whole.named(&whole.ways_from(start).way(goal));
        if let Some(miss) = stopped(problem, net, &way, (from, to)) {
            return Some(miss);
        }
    }
    Some(Miss::Short { ends, has_m, needs_m: SHORTEST_M })
}

/// Places of people on no way of the robot, though it could meet all of them at one place.
fn elsewhere(problem: &Problem<'_>, net: &Net<'_>) -> Option<Miss> {
    let named = |(human, nodes): (&HumanId, &Vec<usize>)| (*human, net.named(nodes));
    let who: Vec<(HumanId, Vec<NodeId>)> = net.elsewhere.iter().map(named).collect();
    let mut proposal = problem.proposal.clone();
    proposal
        .expected_events
        .retain(|clause| !matches!(clause.predicate, Predicate::EncounterAt { human: Some(_), .. }));
    let alone = !who.is_empty() && search::solve(&Problem { proposal: &proposal, ..problem.clone() }).is_ok();
    alone.then_some(Miss::Elsewhere { who, class: proposal.place })
}

/// Too few ways that meet, for somebody who crosses or for the pattern.
fn arms(problem: &Problem<'_>, net: &Net<'_>, nodes: &[usize]) -> Option<Miss> {
    let crossing = problem.proposal.humans.iter().any(|human| human.relation == Relation::Crossing);
    let needs = problem.layout.arms.unwrap_or(0).max(if crossing { people::CROSSED_ARMS } else { 2 });
    let most = nodes.iter().copied().max_by_key(|node| (net.near(*node).len(), usize::MAX - node))?;
    let has = net.near(most).len();
    let class = problem.proposal.place;
    (has < needs).then(|| net.id(most).cloned()).flatten().map(|node| Miss::Arms { class, node, has, needs })
}

/// No place of the class as wide as the pattern wants it.
fn width(problem: &Problem<'_>, net: &Net<'_>, nodes: &[usize]) -> Option<Miss> {
    let [least_m, most_m] = problem.layout.width_m?;
    let ground = Ground::of(&net.location.grid);
    let width_m = |node: usize| fit::width_m(ground.field(), &net.at(node));
    let off = |node: usize| (least_m - width_m(node)).max(width_m(node) - most_m).max(0.0);
    let nearest = nodes.iter().copied().min_by(|a, b| off(*a).total_cmp(&off(*b)))?;
    let (node, has_m) = (net.id(nearest)?.clone(), width_m(nearest));
    let class = problem.proposal.place;
    (off(nearest) > 0.0).then_some(Miss::Width { class, node, has_m, needs_m: [least_m, most_m] })
}

/// Whether somebody is in a room or car at first.
const fn is_indoors(human: &HumanProposal) -> bool {
    matches!(human.relation, Relation::Leaving | Relation::Staying)
}

/// The rooms or cars of somebody who comes out, stays or goes in, where none has an opening or nothing leads out of any.
fn shut_in(problem: &Problem<'_>, net: &Net<'_>, human: &HumanProposal) -> Option<Miss> {
    let wanted = if is_indoors(human) { human.start } else { human.goal };
    let class = wanted.filter(|class| !inside::nodes(net, Some(*class)).is_empty());
    let rooms = net.rooms_of(human.id, inside::nodes(net, class));
    let Some(first) = rooms.first().copied() else {
        let wanted = wanted.unwrap_or(PlaceClass::Room);
        let open = net.enclosures.open_plan().iter().find_map(|(nodes, why)| {
            let own = |id: &&NodeId| net.index(id).is_some_and(|node| net.is(node, wanted));
            nodes.iter().find(own).map(|id| (id, why))
        });
        let Some((id, why)) = open else { return Some(Miss::NoPlace(wanted)) };
        let at = net.index(id).map_or_else(Point::origin, |node| net.at(node));
        return Some(Miss::OpenPlan { node: id.clone(), at, why: why.clone() });
    };
    let outside = |net: &Net<'_>, room: usize| {
        let ways = net.ways_from(room);
        let open = (0..net.len()).filter(|node| !net.inside(*node) && ways.length_m(*node).is_finite());
        open.min_by(|a, b| ways.length_m(*a).total_cmp(&ways.length_m(*b)))
    };
    if rooms.iter().any(|room| outside(net, *room).is_some()) {
        return None;
    }
    let whole = Net::new(problem.location);
    let before = outside(&whole, first)?;
    let way = whole.named(&whole.ways_from(first).way(before));
    stopped(problem, net, &way, (net.id(first)?.clone(), net.id(before)?.clone()))
}

/// A room or car that is too small for those who come out of it or stay in it.
fn full(problem: &Problem<'_>, net: &Net<'_>) -> Option<Miss> {
    let mut inside: Vec<&HumanProposal> = problem.proposal.humans.iter().filter(|human| is_indoors(human)).collect();
    let first = inside.first()?;
    let class = first.start;
    inside.retain(|human| human.start == class);
    let people = inside.len();
    let needs_m2 = PERSON_M2 * people as f64;
    let floor = |node: usize| (floor_m2(net, node), node);
    let all = net.rooms_of(inside.first()?.id, inside::nodes(net, class));
    let (has_m2, node) = all.into_iter().map(floor).max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)))?;
    (has_m2 < needs_m2).then(|| net.id(node).cloned()).flatten().map(|node| Miss::Full {
        node,
        has_m2,
        people,
        needs_m2,
    })
}

/// Free floor of the room or car of a place, m²; where no walls bound it, what is seen from the place on its side of the doors.
fn floor_m2(net: &Net<'_>, node: usize) -> f64 {
    let all = &net.enclosures;
    let place = net.id(node).and_then(|id| all.of_node(id));
    if let Some(floor_m2) = place.and_then(|place| all.floor_m2(place)) {
        return floor_m2;
    }
    let ground = Ground::of(&net.location.grid);
    let (grid, at) = (ground.grid(), net.at(node));
    let step_m = grid.resolution_m.max(0.1);
    let reach = libm::ceil(ROOM_M / step_m) as i32;
    let mut cells = 0_u32;
    for row in -reach..=reach {
        for column in -reach..=reach {
            let point = Point::new(at.x + f64::from(column) * step_m, at.y + f64::from(row) * step_m);
            let behind = place.is_none_or(|place| all.holds(place, &point));
            let free = ground.field().clearance(&point) > 0.0;
            cells += u32::from(free && behind && ground.sight().clear(&at, &point));
        }
    }
    f64::from(cells) * step_m * step_m
}
