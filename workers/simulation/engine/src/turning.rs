//! What changes somebody's way or pace for good: they turn back, or walk at another speed from then on.

use socrates_model::{Action, DoorKind, NodeId, Point, Polyline};

use crate::floor::Floor;
use crate::human::{Human, Meeting};
use crate::setup::Setup;
use crate::start;

/// Nearer than this to where they are, the way back has no point of its own, m.
const NEAR_M: f64 = 0.3;
/// Room that a way has beside somebody's body, m; in an aisle as narrow as the body the way is still a way.
const WIDE_M: f64 = 0.04;
const NARROW_M: f64 = 0.06;
/// Farther from their way than this something has led them off it, m; where they walked then is gone back in steps of this length,
/// m, at most so many.
const OFF_WAY_M: f64 = 0.8;
const STEP_M: f64 = 0.4;
const MOST_STEPS: u32 = 500;
/// A way back that is shorter than this, m, leads on past where they began: to a node that lies behind it (cosine), on a way at most
/// so many times as long as the straight line. Slower than this, m/s, they tell by their way from where they came.
const BACK_M: f64 = 3.5;
const BEHIND_COS: f64 = 0.8;
const STRAIGHT: f64 = 1.1;
const SLOW_MPS: f64 = 0.2;
/// Most nodes of a place that are tried, the nearest first.
const MOST_TRIED: usize = 6;
/// What lies behind somebody is so far along their way, m: before its beginning.
const BEHIND_M: f64 = -1.0;

/// The robot and the other people.
pub(crate) struct OthersAround<'a> {
    pub(crate) robot: Option<Point>,
    /// Ends of the other people's ways.
    pub(crate) ends: &'a [Point],
}

/// Smallest distance of a goal to the end of another person's way, m, and of a way to the robot where there is another.
const TAKEN_M: f64 = 0.7;
const PAST_ROBOT_M: f64 = 1.0;
/// Costs of a way past the robot and of a goal that is taken, m of way.
const PAST_ROBOT_COST_M: f64 = 30.0;
const TAKEN_COST_M: f64 = 60.0;
/// Into a car people go as deep as they can: what a meter of way inside it is worth, m.
const DEEPER: f64 = 2.0;

/// Begins the present act, where it changes the way or the pace.
pub(crate) fn begin(human: &mut Human, setup: &Setup, floor: &Floor, there: &OthersAround<'_>) {
    if human.action == Action::TurnBack && !human.diverted {
        turn(human, setup, floor);
    } else if let Action::GoTo(to) = &human.action {
        if let Some((node, way)) = nearest(human, &to.nodes, (setup, floor), there) {
            go(human, node, way, setup);
        }
    } else if human.action == Action::ComeBack {
        home(human, setup, floor);
    } else if let Action::ChangePace(mps) = human.action {
        (human.pace_mps, human.speed_mps) = (Some(mps), mps);
    }
}

/// From here on the way leads back along where it came from.
fn turn(human: &mut Human, setup: &Setup, floor: &Floor) {
    let off_m = (human.route.point(human.s) - human.at).norm();
    let mut points = if off_m > OFF_WAY_M { walked(human) } else { gone(human) };
    onward(&mut points, human, setup, floor);
    let way = Polyline::new(&points);
    let passed = std::mem::take(&mut human.nodes).into_iter().rev().filter(|(_, mark)| *mark < human.s);
    let at = |mark: f64| way.project(&human.route.point(mark)).0;
    human.nodes = passed.map(|(node, mark)| (node, at(mark))).collect();
    human.doors = start::doors_on(setup, &way);
    // A robot that they have not met by now they meet nowhere else.
    let meetings = std::mem::take(&mut human.meetings);
    human.meetings = meetings.into_iter().map(|meeting| Meeting { human_s: BEHIND_M, ..meeting }).collect();
    human.lane_m = -human.lane_m;
    take(human, way);
}

/// Back along their way from where they are.
fn gone(human: &Human) -> Vec<Point> {
    let marks = human.route.points().iter().zip(human.route.marks_m());
    let behind: Vec<Point> = marks.filter(|(_, mark)| **mark < human.s - NEAR_M).map(|(at, _)| *at).collect();
    std::iter::once(human.at).chain(behind.into_iter().rev()).collect()
}

/// Back as they walked, where something led them off their way.
fn walked(human: &Human) -> Vec<Point> {
    let trail = &human.trail;
    let steps = (0..MOST_STEPS).map(|step| trail.length_m() - STEP_M * f64::from(step)).take_while(|s| *s > 0.0);
    let back = steps.map(|s| trail.point(s)).filter(|at| (at - human.at).norm() > NEAR_M);
    std::iter::once(human.at).chain(back).chain([trail.point(0.0)]).collect()
}

/// Lengthens a way back that is short: behind where they began they came from the nearest node that lies there.
fn onward(points: &mut Vec<Point>, human: &Human, setup: &Setup, floor: &Floor) {
    let length_m = Polyline::new(points).length_m();
    let Some(home) = points.last().copied().filter(|_| length_m < BACK_M) else { return };
    let came = if human.velocity.norm() > SLOW_MPS { human.velocity } else { human.route.direction(human.s) };
    let nodes = setup.location.graph.nodes().iter().map(|node| node.at);
    let behind = nodes.filter(|at| {
        let way = at - home;
        way.norm() + length_m >= BACK_M && -way.dot(&came) > BEHIND_COS * way.norm() * came.norm()
    });
    let mut all: Vec<Point> = behind.collect();
    all.sort_by(|a, b| (a - home).norm().total_cmp(&(b - home).norm()));
    let way = |goal: &Point| {
        let way = floor.way(&home, goal, human.radius_m + WIDE_M)?;
        (way.length_m() < STRAIGHT * (goal - home).norm()).then_some(way)
    };
    if let Some(way) = all.iter().take(MOST_TRIED).find_map(way) {
        points.extend(way.points().iter().skip(1));
    }
}

/// From here on the way leads to where they began.
fn home(human: &mut Human, setup: &Setup, floor: &Floor) {
    let began = human.trail.point(0.0);
    let node = human.nodes.first().map(|(node, _)| node.clone());
    let way = |room: f64| floor.way(&human.at, &began, room);
    let way = way(human.radius_m + WIDE_M).or_else(|| way(human.radius_m - NARROW_M));
    if let (Some(node), Some(way)) = (node, way) {
        go(human, node, way, setup);
    }
}

/// The way to the nearest of some nodes that is free, not past the robot if that can be; of two as near, the first. Of an elevator
/// the deepest.
fn nearest(
    human: &Human,
    nodes: &[NodeId],
    (setup, floor): (&Setup, &Floor),
    there: &OthersAround<'_>,
) -> Option<(NodeId, Polyline)> {
    let at = human.at;
    let mut all: Vec<(f64, &NodeId, Point)> = nodes
        .iter()
        .filter_map(|id| setup.location.graph.node(id).map(|node| ((node.at - at).norm(), id, node.at)))
        .collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let way = |goal: &Point| {
        let way = |room: f64| floor.way(&at, goal, room);
        way(human.radius_m + WIDE_M).or_else(|| way(human.radius_m - NARROW_M))
    };
    let taken = |goal: &Point| there.ends.iter().any(|end| (end - goal).norm() < TAKEN_M);
    let past_robot = |way: &Polyline| {
        there.robot.is_some_and(|robot| (robot - at).norm() > PAST_ROBOT_M && way.project(&robot).1 < PAST_ROBOT_M)
    };
    let in_car = |id: &NodeId| {
        let cars = setup.location.doors.iter().filter(|door| door.kind == DoorKind::Elevator);
        cars.into_iter().any(|door| door.inside.contains(id))
    };
    let cost_m = |id: &NodeId, goal: &Point, way: &Polyline| {
        let past_m = if past_robot(way) { PAST_ROBOT_COST_M } else { 0.0 };
        let taken_m = if taken(goal) { TAKEN_COST_M } else { 0.0 };
        let own_m = if in_car(id) { way.length_m() - DEEPER * inside_m(setup, id, goal) } else { way.length_m() };
        own_m + past_m + taken_m
    };
    let ways = all.into_iter().take(MOST_TRIED).filter_map(|(_, id, goal)| {
        let way = way(&goal)?;
        Some((cost_m(id, &goal, &way), id.clone(), way))
    });
    ways.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, id, way)| (id, way))
}

/// How far a node lies behind the door of its car, m.
fn inside_m(setup: &Setup, id: &NodeId, at: &Point) -> f64 {
    let doors = setup.location.doors.iter().filter(|door| door.inside.contains(id));
    doors.map(|door| (door.middle() - at).norm()).fold(f64::INFINITY, f64::min).min(f64::from(u8::MAX))
}

/// From here on the way leads to another place.
fn go(human: &mut Human, node: NodeId, way: Polyline, setup: &Setup) {
    human.nodes = vec![(node, way.length_m())];
    human.doors = start::doors_on(setup, &way);
    for meeting in &mut human.meetings {
        meeting.human_s = BEHIND_M;
    }
    take(human, way);
}

fn take(human: &mut Human, way: Polyline) {
    (human.route, human.s, human.next_node) = (way, 0.0, 0);
    (human.diverted, human.lined_up, human.aside_m) = (true, false, 0.0);
}
