//! Where everybody stands at tick 0: on free floor, apart from each other, in formation where asked.

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::f64::consts::TAU;

use socrates_model::{GroupId, GroupProposal, HumanId, Point, Polyline, Pose, Relation, Side, Vector};

use crate::floor::Floor;
use crate::gathering::{self, Around};
use crate::human::Human;

/// Smallest distance of two strangers' centers, m.
const APART_M: f64 = 0.8;
/// Smallest distance in a group or an elevator car, m.
const APART_CLOSE_M: f64 = 0.65;
/// Smallest distance to the robot at the start, m.
const ROBOT_APART_M: f64 = 0.9;
/// Free floor round a center beyond the body, m.
pub(crate) const MARGIN_M: f64 = 0.04;
/// Distance of neighbors in a standing circle, m.
const NEIGHBOR_M: f64 = 1.1;
/// Free width beside a standing group that lets a robot pass, m: its diameter and 0.4 m.
const WAY_ROUND_M: f64 = 0.9;
/// Smallest distance from which somebody comes from behind, m.
const BEHIND_M: f64 = 2.2;
/// Lane distance of people who walk side by side, m, and how many do at most.
const LANE_M: f64 = 0.75;
const ABREAST: usize = 3;

/// A person without a place in the rings round its node looks on from step to step of this length, m, at most so many steps far.
const WALK_STEP_M: f64 = 0.3;
const WALK_STEPS: i32 = 27;
/// Least distance from the robot's goal of a person who stands for good, m: both bodies and a hand's breadth.
const GOAL_FREE_M: f64 = 0.75;

/// Places everybody, and gives back who found no free place. `lines` are standing groups that wait in line; `doors` gives the door line and depth side for humans who start behind a door.
pub(crate) fn place(
    humans: &mut [Human],
    groups: &[GroupProposal],
    lines: &[GroupId],
    floor: &Floor,
    robot: Option<(Pose, &Polyline)>,
    doors: &BTreeMap<HumanId, Point>,
) -> Vec<HumanId> {
    let mut homeless = Vec::new();
    let mut taken: Vec<(Point, f64)> = robot.iter().map(|(pose, _)| (pose.point(), ROBOT_APART_M)).collect();
    let route = robot.map(|(_, route)| route);
    for group in groups {
        if group.standing {
            stand(humans, group, lines.contains(&group.id), floor, route, &mut taken);
        } else {
            lanes(humans, group);
        }
    }
    // Leavers first: they get the places near the door.
    let mut order: Vec<usize> = (0..humans.len()).collect();
    order.sort_by_key(|place| humans.get(*place).map(|human| (human.relation == Relation::Staying, human.id)));
    for place in order {
        let Some(human) = humans.get(place) else { continue };
        if human.standing {
            continue;
        }
        let Some((at, yaw)) = spot(human, floor, robot.as_ref(), doors.get(&human.id), &taken) else {
            homeless.push(human.id);
            continue;
        };
        if let Some(human) = humans.get_mut(place) {
            human.at = at;
            human.yaw = yaw;
            let apart = if human.group.is_some() || doors.contains_key(&human.id) { APART_CLOSE_M } else { APART_M };
            taken.push((at, apart));
        }
    }
    for human in humans {
        human.s = human.route.project_within(&human.at, 0.0, 2.0).0;
        human.trail = Polyline::new(&[human.at]);
        human.home = human.at;
    }
    homeless
}

/// A free place near a human's first node, and its heading; `None` where everything about is taken or too narrow.
fn spot(
    human: &Human,
    floor: &Floor,
    robot: Option<&(Pose, &Polyline)>,
    door: Option<&Point>,
    taken: &[(Point, f64)],
) -> Option<(Point, f64)> {
    let home = human.route.point(0.0);
    let ahead = human.route.direction(0.0);
    let left = Vector::new(-ahead.y, ahead.x);
    let beside = human.side.zip(robot).filter(|_| human.relation == Relation::Static);
    let beside = beside.map(|(side, (_, route))| Beside { side, route });
    let wished = if let Some(beside) = &beside {
        beside.wished(&home) + Vector::new(human.sway.0, human.sway.1)
    } else if human.route.length_m() > 0.0 {
        home + left * human.lane_m + ahead * human.sway.1
    } else {
        home + Vector::new(human.sway.0, human.sway.1)
    };
    let apart = if human.group.is_some() || door.is_some() { APART_CLOSE_M } else { APART_M };
    let behind = robot.filter(|_| human.relation == Relation::Behind);
    let stands =
        matches!(human.relation, Relation::Staying | Relation::Static | Relation::Aside) && human.doors.is_empty();
    let goal = robot.and_then(|(_, route)| route.end()).filter(|_| stands && door.is_none() && human.group.is_none());
    let free = |at: &Point| {
        let close = |(other, least): &(Point, f64)| {
            (at - other).norm() < if *least > APART_M { *least } else { least.min(apart) }
        };
        !taken.iter().any(close)
            && goal.is_none_or(|goal| (at - goal).norm() >= GOAL_FREE_M)
            && beside.as_ref().is_none_or(|beside| beside.left_m(at) >= BESIDE_LEAST_M)
            && off_way(human, at, robot, floor)
            && floor.clearance_m(at) >= human.radius_m + MARGIN_M
    };
    let mut best: Option<(f64, Point)> = None;
    for ring in 0..=20_u32 {
        for turn in 0..if ring == 0 { 1 } else { 24 } {
            let angle = f64::from(turn) / 24.0 * TAU;
            let at = wished + Vector::new(libm::cos(angle), libm::sin(angle)) * (0.15 * f64::from(ring));
            if !free(&at) || !reachable(floor, &home, &at, human.radius_m) {
                continue;
            }
            let mut cost = (at - wished).norm();
            if let Some(door) = door {
                let depth = (at - door).norm();
                // People who leave stand before those who stay.
                cost = if human.relation == Relation::Staying { cost - 1.5 * depth } else { cost + 0.6 * depth };
                cost += unmet(human, &at);
                if depth < 0.7 || cost.is_nan() {
                    cost += 5.0;
                }
            }
            if matches!(human.relation, Relation::Staying | Relation::Static) {
                // The robot's own place stays free.
                if let Some(end) = robot.and_then(|(_, route)| route.end()) {
                    cost += 4.0 * (1.05 - (at - end).norm()).max(0.0);
                }
            }
            if let Some((pose, _)) = behind {
                let way = at - pose.point();
                let depth = -(way.x * libm::cos(pose.yaw) + way.y * libm::sin(pose.yaw));
                cost += 3.0 * (BEHIND_M - depth).max(0.0);
            }
            if best.is_none_or(|(least, _)| cost < least - 1e-9) {
                best = Some((cost, at));
            }
        }
        if behind.is_none() && door.is_none() && best.is_some() {
            break;
        }
        // In a car or room the search stays near the node; from behind it may go further back.
        if door.is_some() && ring >= 11 {
            break;
        }
    }
    let at = best.map(|(_, at)| at).or_else(|| farther(floor, &home, human.radius_m, &free))?;
    Some((at, facing(human, &at, door)))
}

/// People who stay inside stand at most so far from where the robot comes to them, m, and what each meter more costs, m.
const MET_M: f64 = 2.6;
const UNMET_PER_M: f64 = 6.0;

/// What it costs somebody who stays to stand where the robot does not come near them, m.
fn unmet(human: &Human, at: &Point) -> f64 {
    let met = human.meeting().filter(|_| human.relation == Relation::Staying);
    met.map_or(0.0, |meeting| UNMET_PER_M * ((at - meeting.at).norm() - MET_M).max(0.0))
}

/// Least distance beside the robot's way as planned of somebody who stands on a side of it, m.
const BESIDE_LEAST_M: f64 = 0.4;
/// The direction of the way at a place is taken over so much of it before and behind, m.
const ALONG_M: f64 = 1.0;

/// A side of the robot's way.
struct Beside<'a> {
    side: Side,
    route: &'a Polyline,
}

impl Beside<'_> {
    /// The way's direction about a point of it.
    fn along(&self, s: f64) -> Vector {
        let line = self.route.point(s + ALONG_M) - self.route.point(s - ALONG_M);
        if line.norm() > 1e-9 { line / line.norm() } else { self.route.direction(s) }
    }

    /// Where somebody stands on that side of a place.
    fn wished(&self, home: &Point) -> Point {
        let along = self.along(self.route.project(home).0);
        home + Vector::new(-along.y, along.x) * (self.side.sign() * Side::BESIDE_M)
    }

    /// How far a place is on that side of the way, m; negative on the other.
    fn left_m(&self, at: &Point) -> f64 {
        let (s, _) = self.route.project(at);
        self.side.sign() * self.along(s).perp(&(at - self.route.point(s)))
    }
}

/// The free place to which fewest steps lead from `home`.
fn farther(floor: &Floor, home: &Point, radius_m: f64, free: &dyn Fn(&Point) -> bool) -> Option<Point> {
    let point = |(right, up): (i32, i32)| home + Vector::new(f64::from(right), f64::from(up)) * WALK_STEP_M;
    let mut known = BTreeSet::from([(0, 0)]);
    let mut open = VecDeque::from([(0, 0)]);
    while let Some(step) = open.pop_front() {
        let here = point(step);
        if free(&here) {
            return Some(here);
        }
        for next in [(1, 0), (0, 1), (-1, 0), (0, -1)].map(|(right, up)| (step.0 + right, step.1 + up)) {
            let near = next.0.abs() <= WALK_STEPS && next.1.abs() <= WALK_STEPS;
            if near && reachable(floor, &here, &point(next), radius_m) && known.insert(next) {
                open.push_back(next);
            }
        }
    }
    None
}

/// Whether a place is as far beside the robot's way as somebody stands who is not in it, on their side of it, and with no wall between; of
/// others it is not asked.
fn off_way(human: &Human, at: &Point, robot: Option<&(Pose, &Polyline)>, floor: &Floor) -> bool {
    let Some((_, route)) = robot.filter(|_| human.relation == Relation::Aside) else { return true };
    let on_side = |side| Beside { side, route }.left_m(at) > 0.0;
    let (s, away_m) = route.project(at);
    away_m >= Side::ASIDE_M && human.side.is_none_or(on_side) && floor.sees(at, &route.point(s))
}

fn facing(human: &Human, at: &Point, door: Option<&Point>) -> f64 {
    if let Some(gaze) = human.gaze {
        return gaze.yaw(at);
    }
    let ahead = human.route.direction(0.0);
    let watched = human.meeting().map(|meeting| meeting.at - at).filter(|way| way.norm() > 1e-6);
    if let Some(toward) = watched.filter(|_| human.relation == Relation::Aside) {
        return libm::atan2(toward.y, toward.x);
    }
    let toward = match door {
        Some(door) => door - at,
        None if ahead.norm() > 0.5 && (human.relation != Relation::Static || !human.doors.is_empty()) => ahead,
        None => human.meeting().map_or_else(|| Vector::new(1.0, 0.0), |_| human.heading()),
    };
    let off_rad = if human.relation == Relation::Staying && door.is_some() { human.off_rad } else { 0.0 };
    socrates_model::geometry::wrap_angle(libm::atan2(toward.y, toward.x) + off_rad)
}

fn reachable(floor: &Floor, from: &Point, to: &Point, radius_m: f64) -> bool {
    // The node itself may lie nearer to a wall than the body is wide (doorways); then sight is enough.
    (floor.straight(from, to, radius_m.min(floor.wall_clearance_m(from)).min(0.25)) || floor.sees(from, to))
        && !floor.shut_between(&(from + (to - from) * 0.3), to)
}

/// From the middle of a group that walks to its outermost member, m; 0 for who walks alone or stands.
pub(crate) fn flank_m(groups: &[GroupProposal], group: Option<GroupId>) -> f64 {
    let walks = groups.iter().find(|known| Some(known.id) == group && !known.standing);
    walks.map_or(0.0, |group| flank_of(group.members.len()))
}

/// The same for so many: at most three walk abreast.
fn flank_of(count: usize) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "at most three")]
    let width = count.clamp(1, ABREAST) as f64;
    0.5 * (width - 1.0) * LANE_M
}

/// People who walk together go side by side, or in file where the floor is narrow (the lane is cut there).
fn lanes(humans: &mut [Human], group: &GroupProposal) {
    let count = group.members.len();
    for (place, id) in group.members.iter().enumerate() {
        if let Some(human) = humans.iter_mut().find(|human| human.id == *id) {
            // The others walk in a second row through the spread at the start.
            #[expect(clippy::cast_precision_loss, reason = "at most three")]
            let row = (place % ABREAST) as f64;
            human.flank_m = flank_of(count);
            // A side of the robot's way is that of their middle: the lane of each has it already.
            let beside_m = if human.side.is_some() { human.lane_m } else { human.sway.0 };
            human.lane_m = row * LANE_M - human.flank_m + beside_m;
        }
    }
}

/// A circle facing its middle, on the side of the robot's way that leaves the wider passage; or a line.
fn stand(
    humans: &mut [Human],
    group: &GroupProposal,
    line: bool,
    floor: &Floor,
    route: Option<&Polyline>,
    taken: &mut Vec<(Point, f64)>,
) {
    let members: Vec<usize> =
        group.members.iter().filter_map(|id| humans.iter().position(|human| human.id == *id)).collect();
    let Some(first) = members.first().and_then(|place| humans.get(*place)) else { return };
    let home = first.meeting().map_or_else(|| first.route.point(0.0), |meeting| meeting.at);
    let body = first.radius_m;
    let around = Around { floor, route, taken, body };
    let places = if line {
        gathering::line(&home, members.len(), &around)
    } else {
        let ring = ring_m(members.len());
        gathering::at_end(&home, route).and_then(|ends| gathering::rim(&home, members.len(), ring, ends, &around))
    };
    // Where there is no room for them together each finds a place alone.
    let sides: Vec<Option<Side>> =
        members.iter().map(|place| humans.get(*place).and_then(|human| human.side)).collect();
    // People on both sides have the robot's way between them.
    let mixed = sides.iter().flatten().any(|side| Some(*side) != first.side);
    let beside = first.side.filter(|_| !mixed).zip(route).map(|(side, route)| Beside { side, route });
    let of = Formed { sides: &sides, beside, opens: first.opens };
    let places = places.or_else(|| formation(&home, &of, body, floor, route, taken));
    let Some(places) = places else { return };
    for (member, (at, yaw)) in members.iter().zip(places) {
        if let Some(human) = humans.get_mut(*member) {
            let swayed = at + Vector::new(human.sway.0, human.sway.1);
            let at = if floor.clearance_m(&swayed) >= body + MARGIN_M { swayed } else { at };
            human.at = at;
            human.yaw = yaw;
            human.standing = true;
            // It stands where it is: its way is this spot, whatever node it was given.
            if human.route.length_m() < 0.05 {
                human.route = Polyline::new(&[at]);
            }
            taken.push((at, APART_CLOSE_M));
        }
    }
}

/// Radius of a standing circle of so many, m.
fn ring_m(count: usize) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "a few people")]
    let n = count.max(1) as f64;
    if count < 2 { 0.0 } else { (NEIGHBOR_M / (2.0 * libm::sin(std::f64::consts::PI / n))).min(1.45) }
}

/// A circle is tried so many steps of 0.25 m beside the way; on a side of it, all of it has to be there.
const WIDEST: i32 = 5;
const WIDEST_BESIDE: i32 = 9;

/// People who stand together.
struct Formed<'a> {
    /// On which side of the robot's way each of them is.
    sides: &'a [Option<Side>],
    /// The side on which all of them are.
    beside: Option<Beside<'a>>,
    /// Whether they open for the robot.
    opens: bool,
}

impl Formed<'_> {
    /// Whether people on both sides stand where they are stated.
    fn parted(&self, places: &[(Point, f64)], route: Option<&Polyline>) -> bool {
        let Some(route) = route.filter(|_| self.beside.is_none()) else { return true };
        let own = |(side, (at, _)): (&Option<Side>, &(Point, f64))| {
            side.is_none_or(|side| Beside { side, route }.left_m(at) >= BESIDE_LEAST_M)
        };
        self.sides.iter().zip(places).all(own)
    }
}

/// Places and headings of a circle near `home`, or of people who stand together as they can; `None` where there is no room.
fn formation(
    home: &Point,
    of: &Formed<'_>,
    body: f64,
    floor: &Floor,
    route: Option<&Polyline>,
    taken: &[(Point, f64)],
) -> Option<Vec<(Point, f64)>> {
    let (count, beside) = (of.sides.len(), &of.beside);
    #[expect(clippy::cast_precision_loss, reason = "a few people")]
    let n = count.max(1) as f64;
    let ring = ring_m(count);
    let (s, along) = route.map_or((0.0, Vector::new(1.0, 0.0)), |route| {
        let (s, _) = route.project(home);
        (s, route.direction(s))
    });
    let heading = libm::atan2(along.y, along.x);
    let on_way = route.map_or(*home, |route| route.point(s));
    let mut best: Option<(f64, Vec<(Point, f64)>)> = None;
    let widest = if beside.is_some() { WIDEST_BESIDE } else { WIDEST };
    // Which of them stands where matters to those whose sides are stated.
    let turns = if beside.is_none() && of.sides.iter().any(Option::is_some) { 8 } else { 4_u32 };
    for ahead in -6..=6_i32 {
        for aside in -widest..=widest {
            let offset = along * (0.25 * f64::from(ahead)) + Vector::new(-along.y, along.x) * (0.25 * f64::from(aside));
            let center = on_way + offset;
            for turn in 0..turns {
                let phase = heading + f64::from(turn) / 4.0 * TAU / n;
                let places = ring_places(&center, ring, count, phase);
                let free = places.iter().all(|(at, _)| {
                    floor.clearance_m(at) >= body + MARGIN_M
                        && floor.straight(&center, at, body.min(0.2))
                        && taken.iter().all(|(other, least)| (at - other).norm() >= *least)
                });
                let near = |route: &Polyline| route.project(&center).1 <= 1.45;
                let there = match beside {
                    Some(beside) => places.iter().all(|(at, _)| beside.left_m(at) >= BESIDE_LEAST_M),
                    None => route.is_none_or(near),
                };
                if !free || !there || !of.parted(&places, route) {
                    continue;
                }
                let wide = way_round(floor, &center, ring + body, heading);
                // A way round is what matters, but for those who open for the robot; then near the node and in the robot's line is better.
                let round = if of.opens { 0.0 } else { 5.0 * wide };
                let score = round - 0.5 * offset.norm() - 0.6 * (offset.perp(&along).abs() - 0.4).max(0.0);
                if best.as_ref().is_none_or(|(top, _)| score > *top + 1e-9) {
                    best = Some((score, places));
                }
            }
        }
    }
    let squeezed = || gathering::squeezed(home, count, &Around { floor, route, taken, body });
    best.map(|(_, places)| places).or_else(squeezed)
}

/// How free the better of the two half circles round a group is for a robot, 0 to 1.
fn way_round(floor: &Floor, center: &Point, rim: f64, heading: f64) -> f64 {
    let free = |side: f64| {
        let open = (0..=12_u32).filter(|step| {
            let angle = heading + side * f64::from(*step) / 12.0 * std::f64::consts::PI;
            let at = center + Vector::new(libm::cos(angle), libm::sin(angle)) * (rim + WAY_ROUND_M / 2.0);
            floor.clearance_m(&at) >= WAY_ROUND_M / 2.0
        });
        f64::from(u32::try_from(open.count()).unwrap_or(0)) / 13.0
    };
    free(1.0).max(free(-1.0))
}

pub(crate) fn ring_places(center: &Point, ring: f64, count: usize, phase: f64) -> Vec<(Point, f64)> {
    #[expect(clippy::cast_precision_loss, reason = "a few people")]
    let n = count.max(1) as f64;
    (0..count)
        .map(|place| {
            #[expect(clippy::cast_precision_loss, reason = "a few people")]
            let angle = phase + (place as f64 + 0.5) / n * TAU;
            let out = Vector::new(libm::cos(angle), libm::sin(angle));
            (center + out * ring, socrates_model::geometry::wrap_angle(angle + std::f64::consts::PI))
        })
        .collect()
}
