//! Motion as we do it: ways round walls, rates per second, nobody through anybody.

use std::f64::consts::{PI, TAU};
use std::ops::Range;

use socrates_crowd::fast::Lanes;
use socrates_crowd::model::{Room, View};
use socrates_crowd::{Found, Goal, Params, Person, Segment, forces_on};
use socrates_engine::gait::{self, A_MAX, V_MAX};
use socrates_engine::{Body, Touch, resolve};
use socrates_model::{AgentId, Point, Polyline, Vector};

use super::agent::{Agent, HumanModel};
use super::scene::{Deed, Scene, Target};

/// Up to so many people social forces are those of `forces_on` to the last bit; more are worked out many at a time,
/// within 1e-12 m/s² of them.
const FEW: usize = 24;
/// So many people's forces are worked out at once: enough to fill the lanes, few enough for the nearest cache.
const AT_ONCE: usize = 32;
/// Others farther away are not felt, m.
const FEEL_M: f64 = 5.0;
/// Lengths of a planned way that a walker looks ahead, m, the farthest first.
const LOOK_AHEAD_M: [f64; 4] = [0.7, 0.4, 0.2, 0.05];
/// The most that walls push a walker, m/s²: half of what its wish can pull.
const WALL_MOST_MPS2: f64 = 1.5;
/// Who gets no farther for so long is jammed, s.
const JAMMED_S: f64 = 0.8;
/// How long it goes round, s.
const DODGE_S: f64 = 1.2;
/// Gap that nobody goes below on purpose: to people, to the robot, m.
const GAPS_M: (f64, f64) = (0.06, 0.18);
/// Gap from which on somebody slows down before another, m.
const STOPS_M: f64 = 0.8;
/// Distance from the robot's line that lets it through, m.
const ASIDE_M: f64 = 1.0;
/// How far somebody scared looks for a better place, m.
const FLEE_M: f64 = 2.5;
/// Whoever runs away knows for so long where the robot is, s.
const AWARE_S: f64 = 2.0;
/// A spot once chosen is kept for so long, s.
const CHOSEN_S: f64 = 1.0;

/// What somebody wants this tick.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Want {
    /// Where to; `None` stands.
    pub(crate) target: Option<Point>,
    pub(crate) speed_mps: f64,
    /// What it looks at while it stands.
    face: Option<Point>,
    /// Whether it is near the robot on purpose, so that the robot does not push it away.
    drawn: bool,
}

impl Want {
    const STAND: Self = Self { target: None, speed_mps: 0.0, face: None, drawn: false };

    fn looking(at: Point) -> Self {
        Self { face: Some(at), ..Self::STAND }
    }

    const fn going(to: Point, speed_mps: f64) -> Self {
        Self { target: Some(to), speed_mps, face: None, drawn: false }
    }
}

/// Lists that are filled anew for every agent.
#[derive(Debug, Default)]
struct Lists {
    /// The largest radius, m.
    widest_m: f64,
    found: Vec<Found>,
    people: Vec<Person>,
    lanes: Lanes,
    room: Room,
}

impl Lists {
    /// Others nearer than a distance, in list order.
    fn others<'a>(&'a mut self, scene: &'a Scene, me: usize, range_m: f64) -> impl Iterator<Item = &'a Agent> {
        self.found.clear();
        if let Some(agent) = scene.agents.get(me) {
            scene.near.within(&agent.at, range_m, &mut self.found);
        }
        self.found.sort_unstable_by_key(|found| found.place);
        let others = self.found.iter().filter(move |found| found.place != me);
        others.filter_map(|found| scene.agents.get(found.place))
    }
}

/// Moves everybody and the robot by one step; the deeds are those of this tick, in list order.
pub(crate) fn advance(scene: &mut Scene, deeds: &[Deed]) -> Vec<Touch> {
    // Whoever is not there is nowhere, and is not found.
    let nowhere = Point::new(f64::NAN, f64::NAN);
    let spots = scene.agents.iter().map(|agent| if agent.present { agent.at } else { nowhere });
    scene.near.fill(spots.map(|at| (at, Vector::zeros())));
    let wants: Vec<Want> = deeds.iter().enumerate().map(|(me, deed)| want(scene, me, *deed)).collect();
    let targets: Vec<Option<Point>> =
        wants.iter().enumerate().map(|(me, want)| unjammed(scene, me, want).filter(|_| want.speed_mps > 0.0)).collect();
    let velocities = velocities(scene, &wants, &targets);
    let people: Vec<(Point, f64)> =
        scene.agents.iter().filter(|agent| agent.present).map(|agent| (agent.at, agent.radius_m)).collect();
    let (now_s, dt) = (scene.now_s, scene.dt);
    let mut bodies = Vec::with_capacity(scene.agents.len() + 1);
    if let Some(robot) = &mut scene.robot {
        if robot.step(now_s, dt, &people) {
            scene.events.push(socrates_model::EventKind::RobotArrived);
        }
        bodies.push(Body {
            agent: AgentId::Robot,
            at: robot.at(),
            velocity: robot.velocity,
            radius_m: robot.spec.radius_m,
            // A robot is not pushed about by people; it waits for them.
            yields: 0.02,
            clear: false,
        });
    }
    for ((agent, velocity), want) in scene.agents.iter().zip(&velocities).zip(&wants) {
        if agent.present {
            bodies.push(Body {
                agent: agent.agent(),
                at: agent.at + velocity * dt,
                velocity: *velocity,
                radius_m: agent.radius_m,
                yields: match (agent.model, want.target) {
                    // A recorded person goes where it went.
                    (HumanModel::Track, _) => 0.0,
                    (_, Some(_)) => 1.0,
                    (_, None) => 0.3,
                },
                clear: false,
            });
        }
    }
    let touches = resolve(&mut bodies, &scene.floor);
    let mut resolved = bodies.into_iter();
    if let Some(robot) = &mut scene.robot
        && let Some(body) = resolved.next()
    {
        (robot.pose.x, robot.pose.y) = (body.at.x, body.at.y);
        robot.velocity = body.velocity;
    }
    for (agent, want) in scene.agents.iter_mut().zip(&wants) {
        if agent.present
            && let Some(body) = resolved.next()
            && agent.model != HumanModel::Track
        {
            settle(agent, want, &body, dt);
        }
    }
    touches
}

/// What a deed means here.
fn want(scene: &mut Scene, me: usize, deed: Deed) -> Want {
    let Some(agent) = scene.agents.get(me) else { return Want::STAND };
    let (at, speed_mps) = (agent.at, agent.speed_mps());
    let keep_off =
        |scene: &Scene, target| scene.radius_m(target) + scene.agents.get(me).map_or(0.0, |a| a.radius_m) + 0.2;
    match deed {
        Deed::Walk => walk(scene, me),
        Deed::Stand => Want::STAND,
        Deed::Look(target) => scene.place(target).map_or(Want::STAND, Want::looking),
        Deed::GoTo(to) => go(scene, me, &to, speed_mps),
        Deed::Approach { target, stop_m, speed_mps } => {
            let Some(to) = scene.place(target) else { return Want::STAND };
            let left = (to - at).norm() - stop_m.max(keep_off(scene, target));
            if left <= 0.05 {
                return Want::looking(to);
            }
            let speed = (1.5 * left + 0.1).min(speed_mps);
            Want { face: Some(to), drawn: target == Target::Robot, ..go(scene, me, &to, speed) }
        }
        Deed::Follow { target, gap_m, speed_mps } => {
            let Some(to) = scene.place(target) else { return Want::STAND };
            let left = (to - at).norm() - gap_m.max(keep_off(scene, target));
            let speed = (scene.velocity(target).norm() + 0.8 * left).min(speed_mps);
            if left <= 0.0 || speed < 0.08 {
                return Want::looking(to);
            }
            Want { face: Some(to), drawn: target == Target::Robot, ..go(scene, me, &to, speed) }
        }
        Deed::Flee { speed_mps, .. } => flee(scene, me, speed_mps),
        Deed::GiveWay => give_way(scene, me),
        Deed::Block { target, ahead_m } => block(scene, me, target, ahead_m),
    }
}

fn walk(scene: &mut Scene, me: usize) -> Want {
    let Some(agent) = scene.agents.get(me) else { return Want::STAND };
    let Some(goal) = agent.goals.front().map(|goal| goal.at) else { return Want::STAND };
    let left = (goal - agent.at).norm();
    let last = agent.goals.len() == 1;
    if last && agent.at_goal() {
        return Want::STAND;
    }
    let full = agent.speed_mps();
    let speed = if last && !agent.cyclic { full.min(0.25 + libm::sqrt(2.0 * left)) } else { full };
    go(scene, me, &goal, speed)
}

/// To a place, round walls where the straight line meets them.
fn go(scene: &mut Scene, me: usize, to: &Point, speed_mps: f64) -> Want {
    let Some(agent) = scene.agents.get(me) else { return Want::STAND };
    let (at, radius_m) = (agent.at, agent.radius_m);
    if scene.floor.straight(&at, to, 0.95 * radius_m) {
        if let Some(agent) = scene.agents.get_mut(me) {
            agent.errand.way = None;
        }
        return Want::going(*to, speed_mps);
    }
    let fits = agent.errand.way.as_ref().is_some_and(|(way, gone)| {
        way.end().is_some_and(|end| (end - to).norm() < 0.8) && way.project_within(&at, *gone, *gone + 1.5).1 < 1.0
    });
    let due = agent.errand.way.is_none() || scene.now_s - agent.errand.planned_s > 0.5;
    if !fits && due {
        // The berth shrinks where the body itself would not fit: the map is coarser than people are careful.
        let way = [radius_m + 0.05, radius_m, 0.7 * radius_m]
            .into_iter()
            .find_map(|radius_m| scene.floor.way(&at, to, radius_m))
            .map(|way: Polyline| (way, 0.0));
        let now_s = scene.now_s;
        if let Some(agent) = scene.agents.get_mut(me) {
            agent.errand.way = way;
            agent.errand.planned_s = now_s;
        }
    }
    let floor = &scene.floor;
    let next = scene.agents.get_mut(me).and_then(|agent| {
        let (way, gone) = agent.errand.way.as_mut()?;
        *gone = way.project_within(&at, *gone, *gone + 0.5).0;
        // The farthest point ahead that it can go to straight: a way may lead back on the other side of a wall.
        let ahead = LOOK_AHEAD_M.into_iter().map(|ahead_m| way.point(*gone + ahead_m));
        let mut points = ahead.filter(|point| floor.straight(&at, point, 0.5 * radius_m));
        let next = points.next();
        if next.is_none() {
            let back = way.point(*gone);
            agent.errand.way = None;
            return Some(back);
        }
        next
    });
    // Without any way it stands: a goal behind a wall is not walked through.
    next.map_or(Want::STAND, |next| Want::going(next, speed_mps))
}

/// Spots around an agent where it fits and that it can reach straight, nearest first.
fn spots(scene: &Scene, agent: &Agent, reach_m: f64) -> Vec<Point> {
    let mut found = Vec::new();
    let mut around = Vec::new();
    let widest_m = scene.agents.iter().fold(0.0, |most: f64, agent| most.max(agent.radius_m));
    scene.near.within(&agent.at, reach_m + widest_m + agent.radius_m + 0.1, &mut around);
    let rings = 8_u32;
    for ring in 1..=rings {
        for turn in 0..16_u32 {
            let (sin, cos) = libm::sincos(f64::from(turn) / 16.0 * TAU);
            let spot = agent.at + Vector::new(cos, sin) * (reach_m * f64::from(ring) / f64::from(rings));
            let crowded = around.iter().filter_map(|found| scene.agents.get(found.place)).any(|other| {
                other.human != agent.human && (other.at - spot).norm() < other.radius_m + agent.radius_m + 0.05
            });
            if !crowded
                && scene.floor.clearance_m(&spot) > agent.radius_m + 0.02
                && scene.floor.straight(&agent.at, &spot, 0.8 * agent.radius_m)
            {
                found.push(spot);
            }
        }
    }
    found
}

/// Keeps a chosen spot for a while, then asks `choose` again.
fn chosen(scene: &mut Scene, me: usize, choose: impl Fn(&Scene, &Agent) -> Point) -> Point {
    let Some(agent) = scene.agents.get(me) else { return Point::origin() };
    if let Some(spot) = agent.errand.spot
        && scene.now_s - agent.errand.chosen_s < CHOSEN_S
    {
        return spot;
    }
    let (spot, now_s) = (choose(scene, agent), scene.now_s);
    if let Some(agent) = scene.agents.get_mut(me) {
        agent.errand.spot = Some(spot);
        agent.errand.chosen_s = now_s;
    }
    spot
}

fn flee(scene: &mut Scene, me: usize, speed_mps: f64) -> Want {
    let Some(robot) = scene.place(Target::Robot) else { return Want::STAND };
    let spot = chosen(scene, me, |scene, agent| {
        let farthest = |best: Point, spot: Point| {
            if (spot - robot).norm() > (best - robot).norm() + 0.05 { spot } else { best }
        };
        spots(scene, agent, FLEE_M).into_iter().fold(agent.at, farthest)
    });
    let now_s = scene.now_s;
    let Some(agent) = scene.agents.get_mut(me) else { return Want::STAND };
    agent.errand.aware_until_s = now_s + AWARE_S;
    if (spot - agent.at).norm() < 0.1 { Want::looking(robot) } else { Want::going(spot, speed_mps) }
}

/// Distance of a point from the line that the robot drives along.
fn off_line(scene: &Scene, point: &Point) -> f64 {
    let Some(robot) = &scene.robot else { return f64::INFINITY };
    let from = robot.at();
    let ahead = robot.goal().map_or_else(|| robot.heading(), |goal| goal - from);
    let ahead = if ahead.norm() > 0.1 { ahead / ahead.norm() } else { robot.heading() };
    let way = point - from;
    // Behind the robot is beside its line.
    if way.dot(&ahead) < -0.3 { way.norm() } else { way.perp(&ahead).abs() }
}

fn give_way(scene: &mut Scene, me: usize) -> Want {
    let Some(robot) = scene.place(Target::Robot) else { return Want::STAND };
    let spot = chosen(scene, me, |scene, agent| {
        if off_line(scene, &agent.at) >= ASIDE_M {
            return agent.at;
        }
        let all = spots(scene, agent, 3.0);
        // The nearest that is far enough off the line, else the farthest off.
        all.iter().copied().find(|spot| off_line(scene, spot) >= ASIDE_M + 0.05).unwrap_or_else(|| {
            all.into_iter().fold(agent.at, |best, spot| {
                if off_line(scene, &spot) > off_line(scene, &best) + 0.05 { spot } else { best }
            })
        })
    });
    let Some(agent) = scene.agents.get(me) else { return Want::STAND };
    let left = (spot - agent.at).norm();
    if left < 0.08 {
        return Want::looking(robot);
    }
    Want { face: Some(robot), ..Want::going(spot, (2.0 * left + 0.1).min(agent.max_vel_mps.max(0.9))) }
}

fn block(scene: &mut Scene, me: usize, target: Target, ahead_m: f64) -> Want {
    let Some(to) = scene.place(target) else { return Want::STAND };
    let (sin, cos) = libm::sincos(scene.yaw(target));
    let Some(agent) = scene.agents.get(me) else { return Want::STAND };
    let least = scene.radius_m(target) + agent.radius_m + 0.2;
    let spot = to + Vector::new(cos, sin) * ahead_m.max(least);
    let left = (spot - agent.at).norm();
    if left < 0.12 || scene.floor.clearance_m(&spot) < agent.radius_m {
        return Want::looking(to);
    }
    let speed = (2.0 * left + 0.1).min(agent.max_vel_mps.clamp(0.5, scene.rules.threat.speed_mps));
    Want { face: Some(to), drawn: target == Target::Robot, ..go(scene, me, &spot, speed) }
}

/// Where to go now: the target, or beside whoever it is jammed with. Two who stand against each other both go round
/// to the right; where that does not help, the next time to the left.
fn unjammed(scene: &mut Scene, me: usize, want: &Want) -> Option<Point> {
    let target = want.target?;
    let (now_s, dt) = (scene.now_s, scene.dt);
    let agent = scene.agents.get_mut(me)?;
    let errand = &mut agent.errand;
    let slow = want.speed_mps > 0.3 && agent.velocity.norm() < 0.15;
    errand.jammed_s = if slow { errand.jammed_s + dt } else { 0.0 };
    if errand.jammed_s > JAMMED_S {
        errand.jammed_s = 0.0;
        errand.dodges += 1;
        // Not all for the same time, else they would stand against each other again.
        let share = f64::from((agent.human.number() + errand.dodges) % 3);
        errand.dodges_until_s = now_s + DODGE_S * (1.0 + 0.5 * share);
    }
    if now_s >= errand.dodges_until_s {
        return Some(target);
    }
    let (at, radius_m) = (agent.at, agent.radius_m);
    let side = if errand.dodges % 2 == 1 { -1.0 } else { 1.0 };
    let way = target - at;
    let ahead = if way.norm() > 1e-6 { way / way.norm() } else { Vector::new(1.0, 0.0) };
    let turned = |angle: f64| {
        let (sin, cos) = libm::sincos(angle);
        Vector::new(ahead.x * cos - ahead.y * sin, ahead.x * sin + ahead.y * cos)
    };
    // Aside, to the other side, or back: the first that has room.
    let ways = [side * 1.3, side * 2.2, -side * 1.3, -side * 2.2, PI];
    let free = ways.into_iter().map(turned).find(|way| scene.floor.clearance_m(&(at + way * 0.5)) > radius_m);
    Some(free.map_or(target, |way| at + way))
}

/// Velocities of this tick before contacts; the targets are where everybody who walks goes now.
fn velocities(scene: &mut Scene, wants: &[Want], targets: &[Option<Point>]) -> Vec<Vector> {
    let mut lists = Lists {
        widest_m: scene.agents.iter().fold(0.0, |most: f64, agent| most.max(agent.radius_m)),
        ..Lists::default()
    };
    let present = scene.agents.iter().filter(|agent| agent.present).count() + usize::from(scene.robot.is_some());
    let plain = Params { social: 1.0, ..Params::default() };
    let mut velocities = Vec::with_capacity(wants.len());
    let mut pairs = Vec::with_capacity(AT_ONCE);
    let whole: Vec<(&Want, &Option<Point>)> = wants.iter().zip(targets).collect();
    for group in whole.chunks(AT_ONCE) {
        pairs.clear();
        if present > FEW {
            lists.lanes.clear();
            for (me, (want, target)) in (velocities.len()..).zip(group) {
                pairs.push(target.map(|_| noted(scene, me, want, &mut lists)));
            }
            lists.lanes.work_out(&plain);
        }
        for (place, (want, target)) in group.iter().enumerate() {
            let pairs = pairs.get(place).cloned().flatten();
            let velocity = steered(scene, velocities.len(), want, (**target, pairs), &mut lists);
            velocities.push(velocity);
        }
    }
    velocities
}

/// Velocity of this tick before contacts, to a target if it has one; `pairs` are those whose forces are in the lanes.
fn steered(
    scene: &mut Scene,
    me: usize,
    want: &Want,
    (target, pairs): (Option<Point>, Option<Range<usize>>),
    lists: &mut Lists,
) -> Vector {
    let dt = scene.dt;
    let model = scene.agents.get(me).map_or(HumanModel::SocialForces, |agent| agent.model);
    let wished = match target {
        _ if model == HumanModel::Track => return scene.velocity(Target::Agent(me)),
        Some(target) if model == HumanModel::Orca => {
            if let Some(agent) = scene.agents.get_mut(me) {
                agent.errand.anchor = None;
            }
            return avoiding(scene, me, want, &target, lists);
        }
        Some(target) => {
            let force = pull(scene, me, want, (&target, pairs), lists);
            let Some(agent) = scene.agents.get_mut(me) else { return Vector::zeros() };
            agent.errand.anchor = None;
            agent.velocity + force * dt
        }
        None => match scene.agents.get_mut(me) {
            Some(agent) => stand(agent, dt),
            None => return Vector::zeros(),
        },
    };
    let Some(agent) = scene.agents.get(me) else { return Vector::zeros() };
    let mut velocity = wished;
    let most = want.speed_mps.max(agent.velocity.norm() - A_MAX * dt).min(V_MAX);
    if want.target.is_some() && velocity.norm() > most {
        velocity *= most / velocity.norm();
    }
    // A little farther than the widest at that gap: rounding decides nothing.
    let reach_m = STOPS_M + agent.radius_m + lists.widest_m + 1e-6;
    let others = lists.others(scene, me, reach_m).map(|other| (other.at, other.radius_m, GAPS_M.0));
    let robot =
        scene.robot.iter().map(|robot| (robot.at(), robot.spec.radius_m, if want.drawn { GAPS_M.0 } else { GAPS_M.1 }));
    for (at, radius_m, gap_m) in others.chain(robot) {
        let way = at - agent.at;
        let distance = way.norm();
        let gap = distance - agent.radius_m - radius_m;
        if distance > 1e-6 && gap < STOPS_M {
            let toward = way / distance;
            // A person stops before touching; forces alone would let shoulders meet.
            let excess = velocity.dot(&toward) - (2.5 * (gap - gap_m)).max(0.0);
            if excess > 0.0 {
                velocity -= toward * excess;
            }
        }
    }
    velocity
}

/// Velocity of somebody who avoids collisions with others who do so too.
fn avoiding(scene: &Scene, me: usize, want: &Want, target: &Point, lists: &mut Lists) -> Vector {
    let Some(agent) = scene.agents.get(me) else { return Vector::zeros() };
    felt(scene, me, want, target, lists);
    let people = &lists.people;
    let walls: Vec<Segment> =
        scene.floor.felt(&agent.at).into_iter().map(|point| Segment { from: point, to: point }).collect();
    let Some(person) = people.first() else { return Vector::zeros() };
    let (now_s, dt_s) = (scene.now_s, scene.dt);
    let view = View { me: person, place: Some(0), people, walls: &walls, now_s, dt_s, index: None };
    let velocity = scene.orca.velocity(&view, &mut lists.room);
    if velocity.iter().all(|component| component.is_finite()) { velocity } else { Vector::zeros() }
}

fn stand(agent: &mut Agent, dt: f64) -> Vector {
    if agent.errand.anchor.is_some_and(|anchor| (anchor - agent.at).norm() > 0.4) {
        // Pushed that far, it has a new place.
        agent.errand.anchor = Some(agent.at);
        return Vector::zeros();
    }
    gait::stand(&mut agent.errand.anchor, &agent.at, &agent.velocity, dt)
}

fn pull(
    scene: &Scene,
    me: usize,
    want: &Want,
    (target, pairs): (&Point, Option<Range<usize>>),
    lists: &mut Lists,
) -> Vector {
    let Some(agent) = scene.agents.get(me) else { return Vector::zeros() };
    let social = pairs.map(|pairs| lists.lanes.sum(&pairs) * agent.forces.social);
    if social.is_none() || agent.group.is_some() {
        felt(scene, me, want, target, lists);
    } else {
        lists.people.clear();
        lists.people.push(wishing(agent, want, target));
    }
    if social.is_some() {
        // Nothing but the forces inside a group is left to be found.
        lists.people.retain(|person| person.goal.is_some() || person.group == agent.group);
    }
    let mut forces = forces_on(0, &lists.people, &scene.floor.felt(&agent.at), &agent.forces);
    forces.social = social.unwrap_or(forces.social);
    // Contacts keep everybody out of walls; their force keeps nobody out of a doorway, or from a goal beside one.
    let push = forces.obstacle.norm();
    if push > WALL_MOST_MPS2 {
        forces.obstacle *= WALL_MOST_MPS2 / push;
    }
    gait::limited(&forces.total())
}

/// The agent with its wish.
fn wishing(agent: &Agent, want: &Want, target: &Point) -> Person {
    Person { goal: Some(Goal { at: *target, radius_m: 0.02 }), speed_mps: want.speed_mps, ..agent.person() }
}

/// Lists the agent with its wish, then everybody it feels: in line of sight and near.
fn felt(scene: &Scene, me: usize, want: &Want, target: &Point, lists: &mut Lists) {
    let mut people = std::mem::take(&mut lists.people);
    people.clear();
    if let Some(agent) = scene.agents.get(me) {
        people.push(wishing(agent, want, target));
        let seen = seen_from(scene, agent);
        people.extend(lists.others(scene, me, FEEL_M).filter(|other| seen(&other.at)).map(Agent::person));
        people.extend(felt_robot(scene, agent, want).filter(|robot| seen(&robot.position)));
    }
    lists.people = people;
}

/// Puts everybody whom an agent feels into the lanes.
fn noted(scene: &Scene, me: usize, want: &Want, lists: &mut Lists) -> Range<usize> {
    let mut lanes = std::mem::take(&mut lists.lanes);
    let mut pairs = 0..0;
    if let Some(agent) = scene.agents.get(me).filter(|agent| agent.model == HumanModel::SocialForces) {
        let seen = seen_from(scene, agent);
        let others = lists.others(scene, me, FEEL_M).filter(|other| seen(&other.at));
        let robot = felt_robot(scene, agent, want).filter(|robot| seen(&robot.position));
        let others = others.map(|other| (other.at, other.velocity));
        let all = others.chain(robot.map(|robot| (robot.position, robot.velocity)));
        pairs = lanes.extend(all.map(|(at, velocity)| (at - agent.at, agent.velocity - velocity)));
    }
    lists.lanes = lanes;
    pairs
}

/// Whether an agent sees a place.
fn seen_from<'a>(scene: &'a Scene, agent: &'a Agent) -> impl Fn(&Point) -> bool + 'a {
    let open_m = scene.floor.open_m(&agent.at);
    move |at| (at - agent.at).norm() < open_m || scene.floor.sees(&agent.at, at)
}

/// The robot as somebody near it feels it who has not come for it.
fn felt_robot<'a>(scene: &'a Scene, agent: &Agent, want: &Want) -> impl Iterator<Item = Person> + use<'a> {
    let (at, drawn) = (agent.at, want.drawn);
    let robot = scene.robot.iter().filter(move |robot| !drawn && (robot.at() - at).norm() < FEEL_M);
    robot.map(|robot| Person {
        velocity: robot.velocity,
        radius_m: robot.spec.radius_m,
        ..Person::standing(0, robot.at())
    })
}

/// Takes over where contacts left it, and turns.
fn settle(agent: &mut Agent, want: &Want, body: &Body, dt: f64) {
    agent.at = body.at;
    agent.velocity = body.velocity;
    (agent.yaw, agent.omega) =
        gait::turned(agent.yaw, &body.at, &body.velocity, want.target.is_some(), want.face.as_ref(), dt);
}
