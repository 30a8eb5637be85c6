//! From an action to a wish: where to, how fast, looking where.

use std::collections::BTreeMap;

use socrates_model::{Action, HumanId, Location, NodeId, Point, Polyline, Relation, SceneGraph, Vector};

use crate::block::block;
use crate::floor::Floor;
use crate::give_way::{give_way, open};
use crate::human::Human;
use crate::make_room::make_room;
use crate::near::Other;
use crate::robot::Robot;

/// Length of the way that a walker looks ahead, m.
const LOOK_AHEAD_M: f64 = 0.9;
/// Cosine between the ways before and after a turn up to which it turns back (154°), and how near to it it is made, m.
const TURNS_BACK: f64 = -0.9;
const TURN_M: f64 = 0.25;
/// The distance that the floor allows is found in so many parts.
const SHARES: u32 = 12;
/// How fast a companion gets back to its line, per second, and at most, m/s.
const LINE_PER_S: f64 = 1.5;
const LINE_MPS: f64 = 0.5;
/// People who walk abreast fall into line so long before a place that is too narrow for that, m, and below that share of
/// their distance from the middle.
const LINE_UP_M: f64 = 1.9;
const IN_LINE: f64 = 0.6;
/// Speed of somebody who runs away, m/s.
const RUN_MPS: f64 = 1.6;
/// Fastest speed of somebody who keeps up with a leader, m/s.
const KEEP_UP_MPS: f64 = 1.8;
/// Gap that followers keep, along the way, m.
const FOLLOW_GAP_M: f64 = 1.5;
/// Where somebody curious stops, from the robot's center, m.
const APPROACH_M: f64 = 1.2;
/// Somebody ahead is stepped aside for from this far on, m.
const SEE_AHEAD_M: f64 = 4.5;
/// Gap to whom it passes that a walker wants, surface to surface, m: the near edge of personal space.
const BERTH_M: f64 = 0.45;
/// Somebody who walks along faster than this is overtaken by people behind it, m/s.
const OVERTAKEN_MPS: f64 = 0.2;
/// So far beside the robot's line, m, and so near, m, whoever comes from behind gets past it.
const BESIDE_M: f64 = 0.4;
const PASSES_M: f64 = 1.6;
/// Farther from its line than this, m, somebody has gone aside.
const ASIDE_TAKEN_M: f64 = 0.2;
/// Distance behind at which somebody is passed, m.
const PASSED_M: f64 = 0.9;

/// Face to face with a robot that stands, somebody on its way lets it through after so long, s.
const PATIENCE_S: f64 = 3.0;
/// The same for somebody whose place it is: the robot has asked twice by then, and rules had their chance.
const STAYING_PATIENCE_S: f64 = 12.0;

/// What a human wants this tick.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Want {
    /// Where to; `None` stands.
    pub(crate) target: Option<Point>,
    /// How fast, m/s.
    pub(crate) speed_mps: f64,
    /// What it looks at while it stands.
    pub(crate) face: Option<Point>,
    /// Whether it walks near the robot on purpose, so that the robot does not push it away.
    pub(crate) drawn: bool,
}

impl Want {
    pub(crate) const STAND: Self = Self { target: None, speed_mps: 0.0, face: None, drawn: false };

    pub(crate) fn stand_facing(point: Point) -> Self {
        Self { face: Some(point), ..Self::STAND }
    }

    pub(crate) fn go(target: Point, speed_mps: f64) -> Self {
        Self { target: Some(target), speed_mps, face: None, drawn: false }
    }
}

/// What motions look at.
pub(crate) struct Scene<'a> {
    pub(crate) location: &'a Location,
    pub(crate) floor: &'a Floor,
    pub(crate) now_s: f64,
    /// Whether the human in question looks round at this tick.
    pub(crate) looks: bool,
    pub(crate) robot: Option<&'a Robot>,
    /// Everybody else who is near the human in question.
    pub(crate) others: &'a [Other],
    pub(crate) trails: &'a BTreeMap<HumanId, (Point, Vector, Polyline)>,
}

/// The wish of one human for this tick; `pace` is the speed of the rendezvous controller.
pub(crate) fn want(human: &mut Human, scene: &Scene<'_>, pace: f64) -> Want {
    if let Some(told) = human.told() {
        return told;
    }
    match human.action.clone() {
        Action::Navigate | Action::ChangePace(_) => navigate(human, scene, pace),
        Action::TurnBack | Action::ComeBack | Action::GoTo(_) => navigate(human, scene, pace),
        Action::StandStill if human.keeps_place() => stay(human, scene),
        Action::StandStill => match scene.robot {
            // Somebody at the end of their way stands there for no reason of their own, so they let the robot through.
            Some(robot) if human.at_goal() && !human.stays() && jammed(human, robot, scene.now_s, PATIENCE_S) => {
                give_way(human, scene)
            }
            Some(_) | None => Want::STAND,
        },
        Action::LookAtRobot => scene.robot.map_or(Want::STAND, |robot| Want::stand_facing(robot.at())),
        Action::TurnAway => scene.robot.map_or(Want::STAND, |robot| {
            let away = human.at - robot.at();
            Want::stand_facing(human.at + away)
        }),
        Action::FollowRobot => follow_robot(human, scene),
        Action::FollowHuman(id) => match scene.trails.get(&id) {
            Some((at, velocity, trail)) => follow(human, scene, at, velocity, trail),
            None => Want::STAND,
        },
        Action::LookAt(id) => scene.trails.get(&id).map_or(Want::STAND, |(at, ..)| Want::stand_facing(*at)),
        Action::Approach => approach(human, scene, APPROACH_M, false),
        Action::ApproachTo(near_m) => approach(human, scene, near_m, true),
        Action::Block => block(human, scene),
        Action::GiveWay => give_way(human, scene),
        Action::MakeRoom => open(human, scene),
        Action::RunAway => run_away(human, scene),
    }
}

fn navigate(human: &mut Human, scene: &Scene<'_>, pace: f64) -> Want {
    if human.stays() {
        return stay(human, scene);
    }
    if let Some(robot) = scene.robot
        && jammed(human, robot, scene.now_s, PATIENCE_S)
    {
        return give_way(human, scene);
    }
    if human.at_goal() || pace <= 0.0 {
        return Want::STAND;
    }
    if let Some(want) = make_room(human, scene) {
        return want;
    }
    let left = human.route.length_m() - human.s;
    let speed = pace.min(0.25 + libm::sqrt(2.0 * left.max(0.0)));
    let ahead = human.route.direction(human.s + 0.5 * LOOK_AHEAD_M);
    if scene.looks {
        human.notice.aside_m = sidestep(human, scene, &ahead, speed);
    }
    let wish = human.lane_m + human.notice.aside_m;
    // The sidestep is taken up at 0.9 m/s sideways, so that nobody jumps.
    human.aside_m += (wish - human.aside_m).clamp(-0.009, 0.009);
    let base = human.route.point(human.s + look_ahead_m(human));
    let aside = Vector::new(-ahead.y, ahead.x) * human.aside_m;
    if scene.looks {
        human.notice.share = share(scene.floor, &base, &aside, human.radius_m + 0.08);
        if human.flank_m > 0.0 {
            // People abreast fall into line before the narrow place, not in it.
            let before = human.route.point(human.s + LINE_UP_M);
            human.notice.share = human.notice.share.min(share(scene.floor, &before, &aside, human.radius_m + 0.08));
            human.notice.in_line = human.notice.share < IN_LINE;
        }
    }
    let target = base + aside * human.notice.share;
    if scene.looks {
        human.notice.straight = scene.floor.straight(&human.at, &target, 0.15);
    }
    if human.notice.straight {
        human.errand.way = None;
        if human.relation == Relation::Abreast {
            return level(human, &ahead, speed);
        }
        let drawn = scene.robot.is_some_and(|robot| passes(human, robot, &ahead));
        return Want { drawn, ..Want::go(target, speed) };
    }
    // Pushed off its way behind a corner: round it, back to the way.
    let back = human.route.point(human.s + 0.4);
    Want::go(round(human, scene, &back).unwrap_or(base), speed)
}

/// Goes along its line beside the robot's, at the robot's pace: how fast it gets back to that line does not depend on the pace, or
/// walls would push a companion of a slow robot into its way.
fn level(human: &Human, ahead: &Vector, speed_mps: f64) -> Want {
    let left = Vector::new(-ahead.y, ahead.x);
    let line = human.route.point(human.s) + left * (human.aside_m * human.notice.share);
    let sideways = (LINE_PER_S * (line - human.at).dot(&left)).clamp(-LINE_MPS, LINE_MPS);
    let wish = ahead * speed_mps + left * sideways;
    let pace = wish.norm();
    if pace < 1e-9 { Want::STAND } else { Want::go(human.at + wish * (LOOK_AHEAD_M / pace), pace) }
}

/// Whether somebody from behind has gone aside and is about to get past the robot: it means to be so near, and being pushed back
/// it would walk beside it for good.
fn passes(human: &Human, robot: &Robot, ahead: &Vector) -> bool {
    let way = robot.at() - human.at;
    let along = robot.velocity.dot(ahead) > OVERTAKEN_MPS;
    let aside = human.gone_aside_m().abs() > ASIDE_TAKEN_M && way.perp(ahead).abs() > BESIDE_M;
    // Where the floor leaves it no wider berth.
    let narrow = human.notice.share < 1.0;
    human.relation == Relation::Behind && narrow && along && aside && way.norm() < PASSES_M
}

/// How far ahead on its way somebody heads for, m. Where the way turns back that is the turn, and from right before it a point
/// behind it: the point as far ahead as elsewhere would be where it stands.
fn look_ahead_m(human: &Human) -> f64 {
    let (route, s) = (&human.route, human.s);
    if route.direction(s).dot(&route.direction(s + LOOK_AHEAD_M)) > TURNS_BACK {
        return LOOK_AHEAD_M;
    }
    let back = |mark: &f64| {
        let (before, after) = (route.direction(mark - TURN_M), route.direction(mark + TURN_M));
        *mark > s && before.dot(&after) <= TURNS_BACK
    };
    let turn = route.marks_m().iter().copied().find(back);
    turn.map_or(LOOK_AHEAD_M, |turn| if turn - s > TURN_M { turn - s } else { turn - s + LOOK_AHEAD_M })
}

/// Stands at its place; lets a robot through that cannot get past it, and comes back.
pub(crate) fn stay(human: &mut Human, scene: &Scene<'_>) -> Want {
    let Some(robot) = scene.robot else { return Want::STAND };
    if jammed(human, robot, scene.now_s, STAYING_PATIENCE_S) {
        return give_way(human, scene);
    }
    // Members of a standing group look at its middle, and the robot goes round them, if there is room for that.
    if human.standing && human.yields_until_s <= 0.0 {
        return Want::STAND;
    }
    let back = (human.home - human.at).norm();
    if back > if human.anchor.is_some() { 0.3 } else { 0.1 } {
        return Want::go(human.home, (2.0 * back + 0.1).min(human.speed_mps));
    }
    Want::STAND
}

/// Whether it and the robot stand face to face, or it has ended up in the line of a robot that stands because of
/// it: after so long of that it lets the robot through for 8 s, as people do.
fn jammed(human: &mut Human, robot: &Robot, now_s: f64, patience_s: f64) -> bool {
    let way = robot.at() - human.at;
    if now_s < human.yields_until_s {
        // As long as the robot is about to pass, nobody steps back into its way.
        let ahead = -way.dot(&robot.intent()) > -0.3;
        if ahead && way.norm() < 2.5 && robot.arrived_s.is_none() {
            human.yields_until_s = human.yields_until_s.max(now_s + 1.0);
        }
        return true;
    }
    let stands = way.norm() < 1.6 && robot.velocity.norm() < 0.1;
    let stays = human.at_goal() || human.keeps_place();
    let in_line = stays && -way.dot(&robot.intent()) > 0.5 * way.norm();
    // Somebody who shuffles to and fro before the robot turns a little: their way still leads through the robot.
    let ahead = if human.at_goal() { Vector::zeros() } else { human.route.direction(human.s + 0.3) };
    let facing = stands && (in_line || way.dot(&human.travel()).max(way.dot(&ahead)) > 0.5 * way.norm());
    let still = facing && human.velocity.dot(&way).abs() < 0.3 * way.norm() && robot.arrived_s.is_none();
    human.jammed_s = if still {
        human.jammed_s + 0.01
    } else if stands {
        (human.jammed_s - 0.02).max(0.0)
    } else {
        0.0
    };
    if human.jammed_s > patience_s {
        human.jammed_s = 0.0;
        human.yields_until_s = now_s + 8.0;
        human.errand.spot = None;
    }
    false
}

/// How much of the way `aside` from `base` the floor allows.
fn share(floor: &Floor, base: &Point, aside: &Vector, clearance_m: f64) -> f64 {
    let free = |share: &f64| floor.clearance_m(&(base + aside * *share)) >= clearance_m;
    (1..=SHARES).rev().map(|part| f64::from(part) / f64::from(SHARES)).find(free).unwrap_or(0.0)
}

/// How far to go aside for whoever is ahead and in the way, m to the left.
fn sidestep(human: &Human, scene: &Scene<'_>, ahead: &Vector, speed_mps: f64) -> f64 {
    let left = Vector::new(-ahead.y, ahead.x);
    // Where it walks now, beside the middle of its way.
    let beside_m = (human.at - human.route.point(human.s)).dot(&left);
    let left_m = human.route.length_m() - human.s;
    let taken = human.gone_aside_m();
    let mut nearest = (SEE_AHEAD_M, 0.0);
    for other in scene.others {
        if other.id == Some(human.id) || human.group.is_some() && other.group == human.group {
            continue;
        }
        let way = other.at - human.at;
        let before = way.dot(ahead);
        // Most are behind it or farther than the nearest so far.
        if before < -PASSED_M || before > nearest.0 {
            continue;
        }
        let beside = way.dot(&left);
        let (along, others) = (human.velocity.dot(ahead), other.velocity.dot(ahead));
        // Somebody who has gone aside to overtake and is slowed down beside the other still wants to get past.
        let overtakes = others > OVERTAKEN_MPS && human.relation == Relation::Behind && taken.abs() > ASIDE_TAKEN_M;
        let closing = if overtakes { along.max(speed_mps) } else { along } - others;
        let across = other.velocity.dot(&left).abs();
        // From who comes towards them people who walk together go aside together: the line that counts is that of their
        // middle, and their flank needs room. Whom they overtake they pass on both sides.
        let together = human.flank_m > 0.0 && others < OVERTAKEN_MPS;
        let (line_m, flank_m) = if together { (0.0, human.flank_m) } else { (human.lane_m, 0.0) };
        let need = human.radius_m + other.radius_m + BERTH_M + flank_m;
        // Beside the line that it would keep to without anybody in the way.
        let off = beside + beside_m - line_m;
        // Somebody level with it is still passed: going back to the line now would run into its side.
        let level = before > -PASSED_M && before < 0.1 && human.aside_m.abs() > 0.1;
        // Somebody who crosses is left to the forces: going aside would lead into its way.
        if !level && (before < 0.1 || closing < 0.1) || off.abs() > need || across > 0.5 {
            continue;
        }
        // Somebody who stands where its way ends is joined, not passed.
        if before > left_m - 0.5 && other.velocity.norm() < 0.1 {
            continue;
        }
        let free = |side: f64| {
            scene.floor.clearance_m(&(other.at + left * (side * (human.radius_m + other.radius_m + 0.1))))
                >= human.radius_m + 0.05
        };
        // The side once taken is kept; on the same line everybody goes to the right, if there is room.
        let mut side = if taken.abs() > ASIDE_TAKEN_M {
            taken.signum()
        } else if off < -0.15 {
            1.0
        } else {
            -1.0
        };
        if !free(side) && free(-side) {
            side = -side;
        }
        let most = 1.3 + flank_m;
        nearest = (before, (off + side * need).clamp(-most, most));
    }
    nearest.1
}

/// The next point of a way round walls to `goal`; planned anew when the goal moves away from it.
pub(crate) fn round(human: &mut Human, scene: &Scene<'_>, goal: &Point) -> Option<Point> {
    if scene.floor.straight(&human.at, goal, 0.2) {
        human.errand.way = None;
        return Some(*goal);
    }
    let fits = human.errand.way.as_ref().is_some_and(|(way, _)| way.end().is_some_and(|end| (end - goal).norm() < 1.0));
    let due = scene.now_s - human.errand.since_s > 0.5 || human.errand.way.is_none();
    if !fits && due {
        // In an aisle as narrow as the body the way is still a way.
        let way = |room: f64| scene.floor.way(&human.at, goal, room);
        let way = way(human.radius_m + 0.04).or_else(|| way(human.radius_m - 0.06));
        human.errand.way = way.map(|way| (way, 0.0));
        human.errand.since_s = scene.now_s;
    }
    let at = human.at;
    let (way, gone) = human.errand.way.as_mut()?;
    let (s, _) = way.project_within(&at, *gone, *gone + 1.5);
    *gone = s;
    Some(way.point(s + 0.6))
}

fn follow_robot(human: &mut Human, scene: &Scene<'_>) -> Want {
    let Some(robot) = scene.robot else { return Want::STAND };
    let way = human.at - robot.at();
    let intent = robot.intent();
    let ahead = way.dot(&intent);
    // In front of the robot: let it pass first, beside its line, then follow.
    if ahead > 0.2 && robot.arrived_s.is_none() && robot.trail.project(&human.at).1 > 0.6 {
        let passing = give_way(human, scene);
        return if way.norm() < 5.0 { passing } else { Want::stand_facing(robot.at()) };
    }
    human.errand.spot = None;
    follow(human, scene, &robot.at(), &robot.velocity, &robot.trail)
}

/// Behind a leader along its trail, at the gap; stands where the leader stands.
fn follow(human: &mut Human, scene: &Scene<'_>, leader: &Point, velocity: &Vector, trail: &Polyline) -> Want {
    let total = trail.length_m() + trail.end().map_or(0.0, |end| (leader - end).norm());
    let distance = (human.at - leader).norm();
    let (s, aside) = trail.project_within(&human.at, (trail.length_m() - 12.0).max(0.0), trail.length_m());
    let on_trail = aside < 1.2 && trail.length_m() > 0.5;
    let gap = if on_trail { (total - s).max(distance) } else { distance };
    let lack = gap - FOLLOW_GAP_M;
    let leader_mps = velocity.norm();
    if lack <= 0.05 && leader_mps < 0.15 || distance < 0.9 {
        return Want::stand_facing(*leader);
    }
    let speed = (leader_mps + 0.8 * lack).clamp(0.0, KEEP_UP_MPS);
    if speed < 0.08 {
        return Want::stand_facing(*leader);
    }
    let target =
        if on_trail { Some(trail.point((s + 0.7).min((total - 0.9).max(s)))) } else { round(human, scene, leader) };
    Want { target: target.or(Some(*leader)), speed_mps: speed, face: Some(*leader), drawn: true }
}

/// Goes up to the robot as near as a distance; `after` it, where it drives away.
fn approach(human: &mut Human, scene: &Scene<'_>, near_m: f64, after: bool) -> Want {
    let Some(robot) = scene.robot else { return Want::STAND };
    let distance = (robot.at() - human.at).norm();
    if distance <= near_m + 0.05 {
        return Want::stand_facing(robot.at());
    }
    let away = (robot.at() - human.at) / distance.max(1e-6);
    let recedes = if after { robot.velocity.dot(&away).max(0.0) } else { 0.0 };
    let speed = (1.5 * (distance - near_m) + 0.1 + recedes).min(human.speed_mps);
    let target = round(human, scene, &robot.at()).unwrap_or_else(|| robot.at());
    Want { target: Some(target), speed_mps: speed, face: Some(robot.at()), drawn: true }
}

fn run_away(human: &mut Human, scene: &Scene<'_>) -> Want {
    let Some(robot) = scene.robot else { return Want::STAND };
    let distance = (robot.at() - human.at).norm();
    let there = human.errand.spot.is_none_or(|spot| (spot - human.at).norm() < 0.5);
    if there
        && (human.errand.spot.is_none() || distance < 5.0)
        && (human.errand.since_s <= 0.0 || scene.now_s - human.errand.since_s > 1.0 || human.errand.spot.is_none())
    {
        human.errand.spot = refuge(human, scene, robot);
        human.errand.way = None;
        human.errand.since_s = scene.now_s;
    }
    let Some(spot) = human.errand.spot else { return Want::stand_facing(robot.at()) };
    let left = (spot - human.at).norm();
    if left < 0.3 {
        return Want::stand_facing(robot.at());
    }
    let target = round(human, scene, &spot).unwrap_or(spot);
    Want::go(target, RUN_MPS.min(0.3 + libm::sqrt(2.0 * left)))
}

/// What a place straight away from the robot is worth against one to the side, m: people run from what comes at them, not across
/// its way.
const STRAIGHT_AWAY: f64 = 5.0;

/// The place of the scene graph that is best to run to: reached well before the robot, far from it, not too far away.
pub(crate) fn refuge(human: &Human, scene: &Scene<'_>, robot: &Robot) -> Option<Point> {
    let graph = &scene.location.graph;
    let walk = |from: &Point| {
        let start = graph
            .nodes()
            .iter()
            .min_by(|a, b| (a.at - from).norm_squared().total_cmp(&(b.at - from).norm_squared()))?;
        let offset = (start.at - from).norm();
        let costs = walking(graph, &start.id);
        Some(
            graph
                .nodes()
                .iter()
                .map(|node| costs.get(&node.id).map(|cost| cost + offset))
                .collect::<Vec<Option<f64>>>(),
        )
    };
    let (mine, robots) = (walk(&human.at)?, walk(&robot.at())?);
    let away = human.at - robot.at();
    let mut best: Option<(f64, Point)> = None;
    for ((node, mine), robots) in graph.nodes().iter().zip(mine).zip(robots) {
        let (Some(mine), Some(robots)) = (mine, robots) else { continue };
        let way = node.at - human.at;
        // Towards the robot is no way out, whatever the graph says.
        if way.norm() < 0.8 || way.dot(&-away) > 0.3 * way.norm() * away.norm() {
            continue;
        }
        let far = (node.at - robot.at()).norm();
        let straight = way.dot(&away) / (way.norm() * away.norm()).max(1e-9);
        let score =
            2.0 * (robots - mine).min(far) + far.min(10.0) - 0.5 * (mine - 8.0).max(0.0) + STRAIGHT_AWAY * straight;
        if best.is_none_or(|(top, _)| score > top) {
            best = Some((score, node.at));
        }
    }
    best.map(|(_, at)| at).or_else(|| open_end(human, scene, &away))
}

/// Without a node to run to: the longest free line that leads away.
fn open_end(human: &Human, scene: &Scene<'_>, away: &Vector) -> Option<Point> {
    let heading = libm::atan2(away.y, away.x);
    let mut best: Option<(f64, Point)> = None;
    for turn in [0.0, 0.5, -0.5, 1.0, -1.0, 1.5, -1.5] {
        let angle = heading + turn;
        let free = (scene.floor.ray_m(&human.at, angle, 6.0) - 0.5).max(0.0);
        let score = free * libm::cos(0.5 * turn);
        if best.is_none_or(|(top, _)| score > top) {
            best = Some((score, human.at + Vector::new(libm::cos(angle), libm::sin(angle)) * free));
        }
    }
    best.map(|(_, at)| at)
}

/// Walking distance from one node to all others, m.
fn walking(graph: &SceneGraph, from: &NodeId) -> BTreeMap<NodeId, f64> {
    let mut costs = BTreeMap::from([(from.clone(), 0.0)]);
    let mut open = vec![from.clone()];
    while let Some(node) = open.pop() {
        let here = costs.get(&node).copied().unwrap_or(0.0);
        for next in graph.neighbors(&node) {
            let cost = here + graph.edge_length_m(&node, next).unwrap_or(0.0);
            if costs.get(next).is_none_or(|known| cost + 1e-9 < *known) {
                costs.insert(next.clone(), cost);
                open.push(next.clone());
            }
        }
    }
    costs
}
