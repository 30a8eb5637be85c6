//! The rendezvous controller: humans and robot come to their encounter at about the same time.
//!
//! Each tick it predicts when the robot will be at the encounter node, and chooses the human's start
//! and speed so that both arrive together. A human who has not started may wait as long as needed while the
//! robot is far or cannot see it; one who walks is only made slower or faster within 0.6 to 1.8 m/s (from 0.3 m/s
//! where the robot comes up from behind), and is held (at most 10 s in all) only where the robot cannot see it: nobody freezes in
//! the robot's view.

use socrates_model::{Action, HumanId, Point, Relation, Vector};

use crate::human::{DoorOnWay, Human};
use crate::robot::Robot;
use crate::start::HURRY_MPS;

/// Slowest walk the controller asks for, m/s.
const SLOWEST_MPS: f64 = 0.6;
/// The same of somebody whom the robot comes up with from behind, m/s: they have to be slower than it, also where it is held up.
const STROLL_MPS: f64 = 0.3;
/// Fastest walk the controller asks for, m/s.
const FASTEST_MPS: f64 = 1.8;
/// Longest hold of somebody who has started, s.
const HOLD_MAX_S: f64 = 10.0;
/// Nearer than this a human in line of sight is in the robot's view, m.
const VIEW_M: f64 = 9.0;
/// Somebody who has not started sets off when the robot sees it from nearer than this, m: it would stand in its way.
const SET_OFF_M: f64 = 2.5;
/// Somebody who needs less than this share of their pace to be there in time is early.
const EARLY: f64 = 0.97;
/// Of a robot that another holds up people keep so far away while they wait for it, m.
const KEEPS_OFF_M: f64 = 3.0;
/// Smallest distance to the line of a door, along the way, at which people are held, m.
const IN_DOOR_M: f64 = 1.2;
/// Nobody waits longer for a robot that stands, s: it may have been told to wait for them.
const SET_OFF_S: f64 = 8.0;
/// Nobody starts before this, s: the first moments show where everybody is.
const FIRST_START_S: f64 = 0.5;
/// Pause between an opened door and the first leaver, s.
const AFTER_OPENING_S: f64 = 0.4;
/// Pause between two leavers, s.
const BETWEEN_LEAVERS_S: f64 = 1.1;
/// A robot this near, along its way, makes people leave a place without a door, m.
const LEAVE_AT_M: f64 = 4.0;
/// Behind a closed door it makes them leave from so much farther: it waits before the door, and they have to get there, m.
const DOOR_M: f64 = 2.0;
/// A robot that is nearer to a door than this stands before it, m: it stops outside of where those who come out have to get by.
const AT_DOOR_M: f64 = 2.2;
/// A companion goes so far ahead of a robot that stands beside it, m: it may stand because they are too near to each other.
const MAKES_WAY_M: f64 = 0.8;
/// Somebody who crosses aims at being there so long before the robot, s: on the last steps the robot's nearness slows it.
const CROSS_S: f64 = 1.1;
/// Somebody who comes towards the robot aims at being there so long before it, s: who stops on seeing the robot
/// stops near the place of the meeting, not far before it.
const TOWARD_S: f64 = 0.7;
/// Several who come towards it aim at being there so long after it, s: it slows down before all of them, and would still be on
/// its way to the place when they have passed.
const SEVERAL_TOWARD_S: f64 = -0.7;
/// A robot slower than this stands, m/s; after its first moments that takes it so much longer, s.
const STANDS_MPS: f64 = 0.15;
const STANDS_FROM_S: f64 = 3.0;
const STANDS_S: f64 = 1.5;
/// A robot nearer than this before somebody, m, slower than this share of its top speed, waits for it.
const FACES_M: f64 = 5.0;
const FACES_SHARE: f64 = 0.5;
/// Cosine from which two ways are the same or opposite: 45°.
const SAME_COS: f64 = std::f64::consts::FRAC_1_SQRT_2;
/// Somebody who wants in through a door of which the robot comes out aims at being there so long after it, s: in the door both would
/// stand.
const LETS_OUT_S: f64 = 1.2;
/// A robot that starts farther than this behind a door starts inside, m.
const INSIDE_M: f64 = 0.5;
/// Somebody ahead is at the encounter so long before the robot, s.
const AHEAD_S: f64 = 1.0;

/// The controller's memory of one human.
#[derive(Debug, Clone, Default)]
pub(crate) struct Timing {
    pub(crate) held_s: f64,
    /// Since when the door on its way is open, s.
    pub(crate) open_since_s: Option<f64>,
    /// Its place among those who leave through the same door.
    pub(crate) leaving_order: u32,
    /// The meeting that is watched, counted from 0.
    pub(crate) meeting: usize,
    /// Whether it is over.
    pub(crate) over: bool,
    /// How many of those before it happened.
    pub(crate) happened: usize,
    /// Whether the robot's own way leads into the place that is left.
    pub(crate) robot_enters: bool,
    /// Whether its door opens for whoever comes near, so that it need not wait for it.
    pub(crate) opens_door: bool,
}

/// What is asked of a human who walks its way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pace {
    /// Speed, m/s; 0 holds.
    pub(crate) speed_mps: f64,
}

/// What the controller knows of the moment.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Moment {
    pub(crate) now_s: f64,
    pub(crate) dt: f64,
    /// Whether human and robot are in line of sight.
    pub(crate) sight: bool,
    /// Whether nobody but its own group is nearer before the robot: it is whom the robot waits for.
    pub(crate) first: bool,
    /// State of the first door ahead of the human: how far, and whether it is open.
    pub(crate) door: Option<(f64, bool)>,
    /// Whether that door stands open for the whole run.
    pub(crate) stands_open: bool,
    /// Whether nobody is to come out through that door any more.
    pub(crate) let_out: bool,
    /// Whether the robot stands because of somebody else whom it meets no later: nobody knows for how long.
    pub(crate) held_up: bool,
}

/// Speed for one human at one tick.
pub(crate) fn pace(human: &Human, timing: &mut Timing, robot: Option<&Robot>, moment: &Moment) -> Pace {
    let free = Pace { speed_mps: human.speed_mps };
    let hold = Pace { speed_mps: 0.0 };
    if moment.now_s < FIRST_START_S {
        return hold;
    }
    let Some(robot) = robot else { return free };
    if human.relation == Relation::Leaving && !human.started && timing.robot_enters {
        return leave(human, timing, robot, moment);
    }
    if human.relation == Relation::Static && !human.started {
        return go_in(human, timing, robot, moment);
    }
    let next = timing.meeting + usize::from(timing.over);
    let is_first = next == 0;
    if human.relation == Relation::Abreast && is_first {
        return Pace { speed_mps: beside(human, robot) };
    }
    let Some(meeting) = human.meetings.get(next) else { return free };
    let left = meeting.human_s - human.s;
    if left <= 0.0 || !robot.before(meeting.robot_s) {
        return free;
    }
    let slowest = if human.relation == Relation::Ahead { STROLL_MPS } else { SLOWEST_MPS }.min(human.speed_mps);
    let fastest =
        if human.relation == Relation::Ahead && is_first { human.speed_mps.max(slowest) } else { FASTEST_MPS };
    // A robot that stands before the meeting is there later than its pace says: it has to get going first.
    let stands_s = if robot.speed_mps() < STANDS_MPS && moment.now_s > STANDS_FROM_S { STANDS_S } else { 0.0 };
    let due_s = robot.eta_s(meeting.robot_s) + stands_s - meeting.lead_s;
    let needed = left / due_s.max(0.05);
    let apart = (human.at - robot.at()).norm();
    let in_view = moment.sight && apart < VIEW_M;
    // Whoever would be there long before a robot that somebody else holds up waits until it drives again.
    if moment.held_up && apart > KEEPS_OFF_M && needed < EARLY * human.speed_mps && !in_doorway(human) {
        return hold;
    }
    if human.started && in_view && moment.first && apart < FACES_M && faces(human, robot) {
        return Pace { speed_mps: needed.clamp(human.speed_mps, HURRY_MPS.max(human.speed_mps)) };
    }
    if !human.started {
        // Early: somebody who stands there, and sets off in time. Late or just right: go.
        let early = needed < EARLY * human.speed_mps;
        if early && robot.stood_s < SET_OFF_S && !(moment.sight && apart < SET_OFF_M) {
            return hold;
        }
    } else if needed < 0.9 * slowest && !in_view && !in_doorway(human) && timing.held_s < HOLD_MAX_S {
        timing.held_s += moment.dt;
        return hold;
    }
    let mut speed = needed.clamp(slowest, fastest);
    // Whoever is to be there well before it gets past it on the way.
    if human.relation == Relation::Behind && is_first && meeting.lead_s <= 0.0 {
        // Catches up without treading on its heels.
        let behind = robot.s - (human.s + meeting.robot_s - meeting.human_s);
        speed = speed.min((robot.speed_mps().max(0.0) + 0.6 * (behind - 1.2)).max(0.0));
    }
    Pace { speed_mps: speed }
}

/// Whether a person is in a door, where others have to get by.
fn in_doorway(human: &Human) -> bool {
    human.doors.iter().any(|door| (human.s - door.s).abs() < IN_DOOR_M)
}

/// A robot that somebody holds up who stands nearer to it than this, m, stands because of them.
const HOLDS_UP_M: f64 = 5.0;
/// Somebody who is met at most so much farther along the robot's way is met at the same place, m.
const SAME_PLACE_M: f64 = 0.5;

/// The meetings at which somebody holds the robot up, by where they lie along its way, m, with who does; none while it drives.
pub(crate) fn holders(humans: &[Human], robot: Option<&Robot>) -> Vec<(HumanId, f64)> {
    let Some(robot) =
        robot.filter(|robot| robot.has_moved && robot.speed_mps() < STANDS_MPS && robot.arrived_s.is_none())
    else {
        return Vec::new();
    };
    // Standing by a rule of theirs: whoever comes up to it, walks on, or stands where they always do keeps nobody away.
    let stands = |human: &Human| human.action.stands() || human.action == Action::Block;
    let holds = |human: &&Human| human.present() && stands(human) && (human.at - robot.at()).norm() < HOLDS_UP_M;
    let at = |human: &Human| human.meetings.first().map(|meeting| (human.id, meeting.robot_s));
    humans.iter().filter(holds).filter_map(at).collect()
}

/// Whether one of them does so to somebody else who is met no earlier.
pub(crate) fn is_held_up(holders: &[(HumanId, f64)], human: &Human, timing: &Timing) -> bool {
    // For whom the others wait they do not wait in turn.
    let next = human.meetings.get(timing.meeting + usize::from(timing.over)).filter(|_| !human.awaited);
    next.is_some_and(|meeting| {
        holders.iter().any(|(holder, robot_s)| *holder != human.id && *robot_s < meeting.robot_s + SAME_PLACE_M)
    })
}

/// How long before the robot somebody aims at being at its first meeting, s; `several` come towards the robot there.
pub(crate) const fn lead_s(relation: Relation, several: bool) -> f64 {
    match relation {
        Relation::Ahead => AHEAD_S,
        // A little before the robot: who crosses is seen crossing, not waiting.
        Relation::Crossing | Relation::Leaving => CROSS_S,
        Relation::Frontal if several => SEVERAL_TOWARD_S,
        Relation::Frontal => TOWARD_S,
        Relation::Behind | Relation::Static | Relation::Staying | Relation::Abreast | Relation::Aside => 0.0,
    }
}

/// The same for a later meeting, where the ways tell how the two come together: `human` and `robot` are their directions.
pub(crate) fn lead_by_ways_s(human: &Vector, robot: &Vector) -> f64 {
    let same = human.dot(robot);
    if same < -SAME_COS {
        TOWARD_S
    } else if same < SAME_COS {
        CROSS_S
    } else {
        0.0
    }
}

/// Whether the robot stands or hardly moves before somebody who comes towards it: it waits until this one has passed, so that
/// going slower would keep both waiting for each other.
fn faces(human: &Human, robot: &Robot) -> bool {
    let way = robot.at() - human.at;
    let toward = human.travel().dot(&way) > SAME_COS * way.norm();
    robot.speed_mps() < FACES_SHARE * robot.model.v_max_mps && toward && human.travel().dot(&robot.intent()) < -SAME_COS
}

/// People who leave the place that the robot enters: after the door has opened, one after the other.
fn leave(human: &Human, timing: &mut Timing, robot: &Robot, moment: &Moment) -> Pace {
    let pause = f64::from(timing.leaving_order) * BETWEEN_LEAVERS_S;
    // A robot that waits before the door is near, however deep the room is.
    let at_door = human.doors.first().is_some_and(|door| near_along(robot, &human.route.point(door.s), AT_DOOR_M));
    let waits = at_door || robot.stood_s >= SET_OFF_S;
    let since = match moment.door {
        Some((_, true)) if !moment.stands_open => true,
        // A door that opens for those who come near would wait for who waits for it.
        Some((_, false)) => timing.opens_door && (waits || near_along(robot, &human.at, LEAVE_AT_M + DOOR_M)),
        // Nothing opens: the robot's coming tells when to go.
        Some((_, true)) | None => {
            let seen = (robot.at() - human.at).norm() <= LEAVE_AT_M && moment.sight;
            seen || waits || near_along(robot, &human.at, LEAVE_AT_M)
        }
    };
    if !since {
        timing.open_since_s = None;
        return Pace { speed_mps: 0.0 };
    }
    let opened = *timing.open_since_s.get_or_insert(moment.now_s);
    let go = moment.now_s - opened >= AFTER_OPENING_S + pause;
    Pace { speed_mps: if go { human.speed_mps.max(0.9) } else { 0.0 } }
}

/// People who wait before a door and go in: once it is open and whoever comes out is out, one after the other.
fn go_in(human: &Human, timing: &mut Timing, robot: &Robot, moment: &Moment) -> Pace {
    let free = Pace { speed_mps: human.speed_mps };
    let near = (robot.at() - human.at).norm() <= LEAVE_AT_M && moment.sight;
    let opens = match moment.door {
        Some((_, true)) => near || !moment.stands_open || timing.open_since_s.is_some(),
        Some((_, false)) => timing.opens_door && near,
        // Somebody who goes in nowhere is held by their rules alone.
        None => return free,
    };
    if !opens || !moment.let_out {
        timing.open_since_s = None;
        return Pace { speed_mps: 0.0 };
    }
    let opened = *timing.open_since_s.get_or_insert(moment.now_s);
    let pause = f64::from(timing.leaving_order) * BETWEEN_LEAVERS_S;
    if moment.now_s - opened >= AFTER_OPENING_S + pause { free } else { Pace { speed_mps: 0.0 } }
}

fn near_along(robot: &Robot, at: &Point, reach_m: f64) -> bool {
    let (s, aside) = robot.route.project(at);
    aside < 2.5 && s - robot.s <= reach_m
}

/// Has those who want in where the robot comes out be at their first meeting after it.
pub(crate) fn let_out(humans: &mut [Human], robot_doors: &[DoorOnWay]) {
    for Human { meetings, doors, .. } in humans {
        let Some(met) = meetings.first_mut() else { continue };
        let comes_out = |own: &DoorOnWay, out: &DoorOnWay| {
            out.door == own.door && out.s > INSIDE_M && out.s < met.robot_s && own.s > met.human_s
        };
        if doors.iter().any(|own| robot_doors.iter().any(|out| comes_out(own, out))) {
            met.lead_s = -LETS_OUT_S;
        }
    }
}

/// Speed of somebody who keeps level with the robot.
fn beside(human: &Human, robot: &Robot) -> f64 {
    let (s, _) = human.route.project_within(&robot.at(), human.s - 4.0, human.s + 4.0);
    let lead_m = if robot.speed_mps() < STANDS_MPS { MAKES_WAY_M } else { 0.0 };
    let ahead = s + lead_m - human.s;
    (robot.speed_mps().max(0.0) + 0.9 * ahead).clamp(0.0, FASTEST_MPS)
}

/// The controller's memory at the start: who leaves a place that the robot enters, and in which order.
/// `by_nearness` tells the doors that open for whoever comes near, `before` of two people whether the one is to be first.
pub(crate) fn timings(
    humans: &[Human],
    robot: Option<&Robot>,
    robot_doors: &[DoorOnWay],
    by_nearness: &dyn Fn(usize) -> bool,
    before: &dyn Fn(HumanId, HumanId) -> bool,
) -> Vec<Timing> {
    let enters = |human: &Human| {
        let Some(robot) = robot else { return false };
        let start = human.route.point(0.0);
        match human.doors.first() {
            Some(door) => robot_doors.iter().any(|on_way| on_way.door == door.door),
            None => robot.route.end().is_some_and(|end| (end - start).norm() < 3.0),
        }
    };
    let through = |relation: Relation| {
        let mut out: Vec<(f64, usize)> = Vec::new();
        for (place, human) in humans.iter().enumerate().filter(|(_, human)| human.relation == relation) {
            let way = human.doors.first().map_or_else(|| human.route.length_m(), |door| door.s);
            out.push(((human.route.point(way) - human.at).norm(), place));
        }
        out.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        // Whoever is to be first goes first, however far they have to the door.
        let first = |one: usize, other: usize| {
            humans.get(one).zip(humans.get(other)).is_some_and(|(one, other)| before(one.id, other.id))
        };
        let mut ordered: Vec<(f64, usize)> = Vec::new();
        for one in out {
            let at = ordered.iter().position(|other| first(one.1, other.1)).unwrap_or(ordered.len());
            ordered.insert(at, one);
        }
        ordered
    };
    let (out, into) = (through(Relation::Leaving), through(Relation::Static));
    humans
        .iter()
        .enumerate()
        .map(|(place, human)| {
            let order = if human.relation == Relation::Static { &into } else { &out };
            let order = order
                .iter()
                .position(|(_, other)| *other == place)
                .and_then(|order| u32::try_from(order).ok())
                .unwrap_or(0);
            let opens_door = human.doors.first().is_some_and(|on_way| by_nearness(on_way.door));
            Timing { leaving_order: order, robot_enters: enters(human), opens_door, ..Timing::default() }
        })
        .collect()
}
