//! From a setup to the world at tick 0.

use std::collections::BTreeMap;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng as _, SeedableRng as _};
use socrates_bt::{Tree, TreeState};
use socrates_maps::openings::Enclosures;
use socrates_model::act::ActRow;
use socrates_model::geometry::{nearest_on_segment, segments_cross};
use socrates_model::recording::{ABSENT_LEAF, AgentInfo};
use socrates_model::seeds::{self, derive_seed};
use socrates_model::time::STEP_SECS;
use socrates_model::{
    Action, AgentId, Clause, Command, Fault, FaultCode, GroupId, HumanId, HumanProposal, NodeId, Point, Polyline, Pose,
    Predicate, RecordingHeader, Relation, Side, Trigger, Vector, Where,
};

use crate::block::blockers;
use crate::ends;
use crate::floor::Floor;
use crate::gaze;
use crate::human::{DoorOnWay, Errand, Human, Meeting};
use crate::make_room::Facing;
use crate::meetings::{self, Marks};
use crate::models::{TRACK_LEAF, Walks};
use crate::near::Notice;
use crate::placing;
use crate::rendezvous;
use crate::robot::Robot;
use crate::setup::{PERSON_RADIUS_M, Setup};

/// Desired speeds: mean, standard deviation and limits, m/s.
const SPEED: (f64, f64, f64, f64) = (1.2, 0.2, 0.6, 1.8);

/// Largest distance to the left, and ahead, from where somebody stands by plan, m; who walks keeps so many times as far from its
/// line.
const SWAY_M: f64 = 0.04;
const SWAY_WALKING: f64 = 2.0;

/// So far before a meeting the robot's way tells from where it comes, m.
const COMES_M: f64 = 0.5;

/// Angle beside the door at which a person inside looks first, who is to look at the robot later, rad.
const TURNED_RAD: f64 = 0.6;

/// Two who go in to one place stand so far to its sides, m.
const SHARED_M: f64 = 0.4;

/// Speed at which somebody late comes to an encounter, m/s: below the fastest that the rendezvous asks for.
pub(crate) const HURRY_MPS: f64 = 1.5;
/// Later than this at the encounter is not made good on the way, s.
const LATE_S: f64 = 0.5;
/// Least way to the encounter, m.
const STILL_LEFT_M: f64 = 2.5;

/// A node sequence as a way, with the length at each node.
fn way(setup: &Setup, nodes: &[NodeId]) -> (Polyline, Vec<(NodeId, f64)>) {
    let graph = &setup.location.graph;
    let mut line = Polyline::default();
    let mut marks = Vec::new();
    for (step, node) in nodes.iter().enumerate() {
        let head = nodes.get(..=step).unwrap_or(&[]);
        if let Some(last) = head.len().checked_sub(2).and_then(|from| head.get(from..)) {
            for point in graph.polyline(last).into_iter().skip(1) {
                line.push(point);
            }
        } else if let Some(place) = graph.node(node) {
            line.push(place.at);
        }
        marks.push((node.clone(), line.length_m()));
    }
    (line, marks)
}

/// Distance at which the robot turns back before a person who stands where its way folds, m.
const TURNS_BEFORE_M: f64 = 1.2;

/// The robot's intended way, with the length at each node. Where it folds back at the node of a person who stands, it turns before them.
#[must_use]
pub fn intended_way(setup: &Setup) -> (Polyline, Vec<(NodeId, f64)>) {
    let (line, marks) = way(setup, &setup.paths.robot);
    let stands =
        |node: &NodeId| setup.paths.humans.values().any(|own| matches!(own.as_slice(), [only] if only == node));
    let taken = |fold: &f64| marks.iter().any(|(node, mark)| (mark - fold).abs() < 1e-6 && stands(node));
    let cuts: Vec<(f64, f64)> = line
        .folds_m(0.0, line.length_m())
        .filter(taken)
        .map(|fold| (fold - TURNS_BEFORE_M.min(fold), (fold + TURNS_BEFORE_M).min(line.length_m())))
        .collect();
    if cuts.is_empty() {
        return (line, marks);
    }
    // A length of the way once what is cut off is gone.
    let kept = |s: f64| cuts.iter().fold(s, |left, (from, to)| left - (s.min(*to) - from).max(0.0));
    let mut short = Polyline::default();
    let mut cut = cuts.iter().peekable();
    for (point, mark) in line.points().iter().zip(line.marks_m()) {
        while let Some((from, _)) = cut.next_if(|(from, _)| from < mark) {
            short.push(line.point(*from));
        }
        if !cuts.iter().any(|(from, to)| from < mark && mark < to) {
            short.push(*point);
        }
    }
    (short, marks.into_iter().map(|(node, mark)| (node, kept(mark))).collect())
}

/// The robot on its first node.
pub(crate) fn robot(setup: &Setup, floor: &Floor) -> Robot {
    let (route, nodes) = intended_way(setup);
    let home = route.point(0.0);
    let ahead = route.direction(0.0);
    let yaw = if ahead.norm() > 0.5 { libm::atan2(ahead.y, ahead.x) } else { 0.0 };
    let at = free_near(floor, &home, setup.robot.radius_m + 0.03);
    Robot {
        model: setup.robot,
        pose: Pose::new(at.x, at.y, yaw),
        v: 0.0,
        vy: 0.0,
        omega: 0.0,
        velocity: Vector::zeros(),
        has_moved: false,
        stood_s: 0.0,
        command: Command::default(),
        calls: 0,
        gesture: None,
        gesture_until_s: 0.0,
        route,
        nodes,
        next_node: 0,
        s: 0.0,
        other_way: None,
        pace_mps: 0.93 * setup.robot.v_max_mps,
        arrived_s: None,
        at_full_goal_s: 0.0,
        trail: Polyline::new(&[at]),
    }
}

fn free_near(floor: &Floor, home: &Point, radius: f64) -> Point {
    let mut best = (floor.wall_clearance_m(home), *home);
    for ring in 1..=10_u32 {
        if best.0 >= radius {
            break;
        }
        for turn in 0..16_u32 {
            let angle = f64::from(turn) / 16.0 * std::f64::consts::TAU;
            let at = home + Vector::new(libm::cos(angle), libm::sin(angle)) * (0.05 * f64::from(ring));
            let free = floor.wall_clearance_m(&at);
            if free > best.0 + 1e-9 {
                best = (free, at);
            }
        }
    }
    best.1
}

/// Everybody, placed.
///
/// # Errors
/// `G-COLL` for each who finds no free place about its first node.
pub(crate) fn humans(
    (setup, enclosures): (&Setup, &Enclosures),
    mut trees: BTreeMap<HumanId, Tree>,
    floor: &Floor,
    robot: Option<&Robot>,
) -> Result<Vec<Human>, Vec<Fault>> {
    let (robot_way, robot_marks) = intended_way(setup);
    let mut inside = BTreeMap::new();
    let mut humans = Vec::new();
    for proposal in &setup.proposal.humans {
        let Some(tree) = trees.remove(&proposal.id) else { continue };
        let mut human = human((setup, enclosures), proposal, tree, (&robot_way, &robot_marks), floor);
        let taken: Vec<Point> = humans
            .iter()
            .filter(|other: &&Human| other.group.is_none() || other.group != human.group)
            .filter_map(|other| other.route.end())
            .collect();
        // A person who goes in through a door does not end short of the others, in the door.
        if human.relation != Relation::Static || human.doors.is_empty() {
            human.route = ends::apart(human.route, &taken, robot_way.end(), floor);
        } else if let Some(other) = humans.iter_mut().find(|other: &&mut Human| same_end(other, &human)) {
            other.route = ends::beside(&other.route, SHARED_M, floor);
            human.route = ends::beside(&human.route, -SHARED_M, floor);
        }
        let nodes = setup.paths.humans.get(&proposal.id).map_or(&[][..], Vec::as_slice);
        if let Some((_, opening)) = enclosures.way_out(&setup.location, nodes) {
            inside.insert(proposal.id, opening.middle());
        }
        humans.push(human);
    }
    let robot = robot.map(|robot| (robot.pose, &robot.route));
    let lines = lines(&setup.proposal);
    let homeless = placing::place(&mut humans, &setup.proposal.groups, &lines, floor, robot, &inside);
    let faults: Vec<Fault> = homeless.into_iter().map(|human| no_place(setup, human)).collect();
    if faults.is_empty() { Ok(humans) } else { Err(faults) }
}

/// The fault of somebody for whom there is no room.
fn no_place(setup: &Setup, human: HumanId) -> Fault {
    let node = setup.paths.humans.get(&human).and_then(|nodes| nodes.first());
    let at = node.and_then(|node| setup.location.graph.node(node)).map_or_else(Point::origin, |node| node.at);
    let node = node.map_or_else(String::new, ToString::to_string);
    let message = format!(
        "{human} has no place to start: round `{node}` at ({:.1}, {:.1}) all floor that it can walk to is taken or narrower than {:.2} m; let fewer people start there, or elsewhere",
        at.x,
        at.y,
        2.0 * PERSON_RADIUS_M
    );
    Fault::new(FaultCode::GColl, Where::agent(AgentId::Human(human)).step(1), message)
}

/// Whether two who go in have the same place behind the door.
fn same_end(one: &Human, other: &Human) -> bool {
    let ends = one.route.end().zip(other.route.end());
    one.relation == Relation::Static && ends.is_some_and(|(a, b)| (a - b).norm() < SHARED_M)
}

/// Whether somebody has nothing more to do at the end of its path and may stand beside it: it came out of a room or went
/// across, alone, and nothing asks for that very place.
fn goes_off((setup, enclosures): (&Setup, &Enclosures), proposal: &HumanProposal, nodes: &[NodeId]) -> bool {
    let Some(last) = nodes.last() else { return false };
    let asked = |clause: &Clause| {
        matches!(&clause.predicate, Predicate::Reaches { agent, .. } if *agent == proposal.id.into())
            || matches!(&clause.predicate, Predicate::Enters { human, .. } if *human == proposal.id)
    };
    matches!(proposal.relation, Relation::Leaving | Relation::Crossing)
        && proposal.group.is_none()
        && !enclosures.is_inside(last)
        && setup.paths.encounters_of(proposal.id).all(|node| node != last)
        && !proposal.rules.iter().any(|rule| rule.when.contains(&Trigger::GoalReached))
        && !setup.proposal.expected_events.iter().any(asked)
}

/// Groups that wait in line: those of which a clause says so.
fn lines(proposal: &socrates_model::Proposal) -> Vec<GroupId> {
    let queue = |clause: &Clause| {
        if let Predicate::Queues { group, .. } = clause.predicate { Some(group) } else { None }
    };
    proposal.expected_events.iter().filter_map(queue).collect()
}

fn human(
    (setup, enclosures): (&Setup, &Enclosures),
    proposal: &HumanProposal,
    tree: Tree,
    (robot_way, robot_marks): (&Polyline, &Marks),
    floor: &Floor,
) -> Human {
    let nodes: &[NodeId] = setup.paths.humans.get(&proposal.id).map_or(&[], Vec::as_slice);
    let (mut route, marks) = way(setup, nodes);
    if route.length_m() > 1.0 {
        route = ends::clear_end(route, robot_way, placing::flank_m(&setup.proposal.groups, proposal.group), floor);
        if goes_off((setup, enclosures), proposal, nodes) {
            route = ends::aside(route, robot_way, &setup.location.doors, floor);
        }
    }
    let meetings = meetings::of(setup, proposal, (&route, &marks), (robot_way, robot_marks));
    let speed_mps = proposal.speed_mps.unwrap_or_else(|| drawn_speed(setup.seed, proposal.id));
    let fastest_mps = fastest(setup, proposal);
    let (route, marks, meetings) = in_time(setup, (proposal.relation, speed_mps, fastest_mps), route, marks, meetings);
    let doors = doors_on(setup, &route);
    let sway = drawn_sway(setup.seed, proposal.id);
    let mut facing = 0.0;
    if let Some(meeting) = meetings.first()
        && (route.length_m() < 0.05 || proposal.relation == Relation::Static && doors.is_empty())
    {
        // Somebody who stands in the robot's way looks across it, not at the robot: where the robot turns, across the way by
        // which it comes. Who does something at its sight looks half to where it comes from, or it might pass unseen behind.
        let along = robot_way.direction((meeting.robot_s - COMES_M).max(0.0));
        let sees = |rule: &socrates_model::Rule| rule.when.iter().any(|when| matches!(when, Trigger::RobotVisible(_)));
        let across = Vector::new(-along.y, along.x);
        let looks = if proposal.rules.iter().any(sees) { across - along } else { across };
        facing = libm::atan2(looks.y, looks.x);
    }
    // A person who stays inside and is to look at the robot when it comes is not looking at its door all along.
    let looks = |rule: &socrates_model::Rule| rule.step.is_some() && rule.act == Action::LookAtRobot;
    let off_rad = if proposal.rules.iter().any(looks) { TURNED_RAD } else { 0.0 };
    let state = tree.start_with(&BTreeMap::from([
        ("id".to_owned(), proposal.id.number().to_string()),
        ("dt".to_owned(), STEP_SECS.to_string()),
    ]));
    let at = route.point(0.0);
    Human {
        role: proposal.role.clone(),
        relation: proposal.relation,
        group: proposal.group,
        side: proposal.side,
        gaze: gaze::of(setup, proposal, meetings.first(), robot_way),
        lane_m: lane_m(proposal, SWAY_WALKING * sway.0),
        blockers: blockers(setup, proposal),
        sway,
        route,
        nodes: marks,
        meetings,
        doors,
        yaw: facing,
        awaited: meetings::is_awaited(setup, proposal),
        off_rad,
        speed_mps,
        steps: proposal.steps(),
        fastest_mps,
        bound: is_bound(setup, proposal),
        opens: proposal.rules.iter().any(|rule| rule.act == socrates_model::Action::MakeRoom),
        ..bare(proposal.id, tree, state, at)
    }
}

/// Somebody whose pace is stated hurries by this factor of it at most.
const STATED: f64 = 1.1;

/// How fast somebody hurries at most to be in time, m/s: at about their pace where a clause tells of it.
fn fastest(setup: &Setup, proposal: &HumanProposal) -> f64 {
    let stated = setup.proposal.expected_events.iter().find_map(|clause| {
        if let Predicate::Walks { human, mps } = clause.predicate {
            (human == proposal.id).then_some(mps)
        } else {
            None
        }
    });
    stated.map_or(f64::INFINITY, |mps| STATED * mps)
}

/// Whether a clause asks that this human gets to the place at the end of their way.
fn is_bound(setup: &Setup, proposal: &HumanProposal) -> bool {
    let gets_to = |clause: &Clause| matches!(clause.predicate, Predicate::GetsTo { human, .. } if human == proposal.id);
    setup.proposal.expected_events.iter().any(gets_to)
}

/// Companions walk so far beside the robot, m.
const COMPANION_M: f64 = 1.0;

/// How far to the left of the middle of their way somebody walks, m: beside the robot's on the side that is theirs, else as they sway.
fn lane_m(proposal: &HumanProposal, sway_m: f64) -> f64 {
    // Beside the robot people are to the right of it unless they are to be on the left.
    let left = |side: Option<Side>| side.map(Side::sign);
    match proposal.relation {
        Relation::Abreast => COMPANION_M * left(proposal.side).unwrap_or(-1.0),
        // What is left of the robot is right of those who come towards it.
        Relation::Frontal => left(proposal.side).map_or(sway_m, |left| sway_m - left * Side::BESIDE_M),
        Relation::Behind | Relation::Ahead => left(proposal.side).map_or(sway_m, |left| sway_m + left * Side::BESIDE_M),
        Relation::Crossing | Relation::Static | Relation::Leaving | Relation::Staying | Relation::Aside => sway_m,
    }
}

/// Somebody who stands at a spot, in nobody's story.
pub(crate) fn bystander(id: HumanId, tree: Tree, at: Point) -> Human {
    let state = tree.start();
    bare(id, tree, state, at)
}

fn bare(id: HumanId, tree: Tree, state: TreeState, at: Point) -> Human {
    Human {
        id,
        role: String::new(),
        relation: Relation::Static,
        group: None,
        standing: false,
        side: None,
        gaze: None,
        lane_m: 0.0,
        flank_m: 0.0,
        lined_up: false,
        blockers: 1,
        place_m: None,
        sway: (0.0, 0.0),
        tree,
        state,
        at,
        home: at,
        route: Polyline::new(&[at]),
        nodes: Vec::new(),
        next_node: 0,
        s: 0.0,
        meetings: Vec::new(),
        doors: Vec::new(),
        velocity: Vector::zeros(),
        yaw: 0.0,
        awaited: false,
        off_rad: 0.0,
        omega: 0.0,
        radius_m: PERSON_RADIUS_M,
        speed_mps: SPEED.0,
        action: Action::Navigate,
        gesture: None,
        gesture_to: None,
        pace_mps: None,
        diverted: false,
        errand: Errand::default(),
        fastest_mps: f64::INFINITY,
        bound: false,
        opens: false,
        anchor: None,
        aside_m: 0.0,
        jammed_s: 0.0,
        yields_until_s: 0.0,
        facing: Facing::default(),
        nearest_robot_m: f64::INFINITY,
        steps: 0,
        steps_ended: 0,
        started: false,
        trail: Polyline::default(),
        notice: Notice::default(),
        walks: Walks::Forces,
    }
}

type Way = (Polyline, Vec<(NodeId, f64)>, Vec<Meeting>);

/// A person who could not be at their encounter in time even at a fast walk is already under way at tick 0: it starts
/// later on its path, but never nearer than [`STILL_LEFT_M`] to the (first) encounter.
fn in_time(
    setup: &Setup,
    (relation, speed_mps, fastest_mps): (Relation, f64, f64),
    route: Polyline,
    marks: Vec<(NodeId, f64)>,
    meetings: Vec<Meeting>,
) -> Way {
    // Of those ahead only whoever does something as the robot comes up: the others it may come up with sooner.
    let timed = |meet: &&Meeting| match relation {
        Relation::Crossing | Relation::Frontal => true,
        Relation::Ahead => meet.lead_s > rendezvous::lead_s(Relation::Ahead, false),
        Relation::Behind
        | Relation::Abreast
        | Relation::Static
        | Relation::Leaving
        | Relation::Staying
        | Relation::Aside => false,
    };
    let Some(meet) = meetings.first().filter(timed) else {
        return (route, marks, meetings);
    };
    let ahead = relation == Relation::Ahead;
    let robot_s = meet.robot_s / (0.93 * setup.robot.v_max_mps).max(0.1) - if ahead { meet.lead_s } else { 0.0 };
    // Somebody who is fast anyway has the longer way; nobody ahead of a robot that is to come up with them hurries.
    let hurry_mps = if ahead { speed_mps } else { HURRY_MPS.max(speed_mps).min(fastest_mps) };
    let late_s = meet.human_s / hurry_mps - robot_s;
    if late_s < LATE_S {
        return (route, marks, meetings);
    }
    let cut = (meet.human_s - hurry_mps * robot_s).min(meet.human_s - STILL_LEFT_M).max(0.0);
    // Inside a door it stays inside: the door is part of the story.
    if cut <= 0.0 || !doors_on(setup, &route).is_empty() {
        return (route, marks, meetings);
    }
    let marks = marks.into_iter().filter(|(_, s)| *s >= cut).map(|(node, s)| (node, s - cut)).collect();
    let meetings = meetings.into_iter().map(|meet| Meeting { human_s: meet.human_s - cut, ..meet }).collect();
    (route.from(cut), marks, meetings)
}

/// Doors that a way goes through, in order.
pub(crate) fn doors_on(setup: &Setup, route: &Polyline) -> Vec<DoorOnWay> {
    let mut found = Vec::new();
    for (ends, marks) in route.points().windows(2).zip(route.marks_m().windows(2)) {
        let ([a, b], [s0, _]) = (ends, marks) else { continue };
        for (place, door) in setup.location.doors.iter().enumerate() {
            if segments_cross(a, b, &door.from, &door.to) {
                let along = door.to - door.from;
                let share = (door.from - a).perp(&along) / (b - a).perp(&along);
                let share = if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.5 };
                found.push(DoorOnWay { door: place, s: s0 + share * (b - a).norm() });
            }
        }
    }
    // A way that ends in a doorway needs the door open as well.
    if let Some(end) = route.end().filter(|_| route.length_m() > 0.0) {
        for (place, door) in setup.location.doors.iter().enumerate() {
            let near = nearest_on_segment(&end, &door.from, &door.to).0 < 0.35;
            if near && found.iter().all(|known| known.door != place) {
                found.push(DoorOnWay { door: place, s: route.length_m() });
            }
        }
    }
    found.sort_by(|a, b| a.s.total_cmp(&b.s));
    found
}

/// A desired speed from N(1.2, 0.2), clipped; the same seed and human give the same.
fn drawn_speed(seed: u64, human: HumanId) -> f64 {
    let mut random = ChaCha8Rng::seed_from_u64(derive_seed(seed, &["speed", &human.to_string()]));
    let mut drawn = || seeds::unit_above_zero(random.next_u64());
    let (radius, turn) = (drawn(), drawn());
    let normal = seeds::standard_normal(radius, turn);
    (SPEED.0 + SPEED.1 * normal).clamp(SPEED.2, SPEED.3)
}

/// Where somebody stands or walks beside where it would by plan, m; the same seed and human give the same.
fn drawn_sway(seed: u64, human: HumanId) -> (f64, f64) {
    let mut random = ChaCha8Rng::seed_from_u64(derive_seed(seed, &["sway", &human.to_string()]));
    let mut sway = || SWAY_M * (2.0 * seeds::unit(random.next_u64()) - 1.0);
    (sway(), sway())
}

/// Names of leaves; those of steps only where somebody has such a step.
fn leaves(setup: &Setup) -> Vec<String> {
    let mut rules = setup.proposal.humans.iter().flat_map(|human| &human.rules);
    let behind = rules.any(|rule| rule.act.row().is_of_steps());
    let steps = behind.then(|| [TRACK_LEAF, ABSENT_LEAF].into_iter().chain(ActRow::leaves(true)));
    ActRow::leaves(false).chain(steps.into_iter().flatten()).map(str::to_owned).collect()
}

/// The header of the run.
pub(crate) fn header(setup: &Setup, humans: &[Human], robot: Option<&Robot>) -> RecordingHeader {
    let mut agents = Vec::new();
    if let Some(robot) = robot {
        agents.push(AgentInfo {
            agent: AgentId::Robot,
            radius_m: robot.model.radius_m,
            speed_mps: robot.model.v_max_mps,
            role: "robot".to_owned(),
        });
    }
    agents.extend(humans.iter().map(|human| AgentInfo {
        agent: human.agent(),
        radius_m: human.radius_m,
        speed_mps: human.speed_mps,
        role: human.role.clone(),
    }));
    RecordingHeader {
        format: socrates_model::FORMAT,
        run: setup.run.clone(),
        planner: setup.planner.clone(),
        seed: setup.seed,
        profile: "native".to_owned(),
        step_s: STEP_SECS,
        agents,
        leaves: leaves(setup),
    }
}
