//! One step of a human: wish and social forces to velocity, heading and place.
//!
//! Two passes over a few people at a time: first everybody notes whom it feels, then the social forces of all those
//! pairs are reckoned at once, then everybody is steered. Nobody's steering shows to the others before the next tick.

use std::ops::Range;

use socrates_crowd::fast::Lanes;
use socrates_crowd::model::Room;
use socrates_crowd::{Goal, Params, Person, forces_on};
use socrates_model::time::STEP_SECS;
use socrates_model::{GroupId, Point, Vector};

use crate::floor::Floor;
use crate::gait::{self, A_MAX, V_MAX};
use crate::human::Human;
use crate::models::{Walks, avoid};
use crate::motion::Want;
use crate::near::{CLOSE_M, FEEL_M, Near, Other};

/// A way with this much room to both sides can be walked, m: somebody turns the shoulders a little.
const DOORWAY_M: f64 = 0.22;
/// Gap to a robot at which somebody stops who does not seek it, surface to surface, m.
const ROBOT_GAP_M: f64 = 0.3;
/// Up to so many people forces are those of the crowd library to the last bit; more are worked out in lanes, within
/// 1e-12 m/s² of them.
const FEW: usize = 24;

/// The pairs of one person whose forces are reckoned together with those of others.
#[derive(Debug, Clone, Default)]
pub(crate) struct Pairs {
    close: Range<usize>,
    /// Nothing where what was felt of them at the last look still holds.
    far: Option<Range<usize>>,
}

/// Steers people; keeps the lists of whom they feel.
#[derive(Debug, Default)]
pub(crate) struct Walker {
    felt: Vec<Person>,
    around: Vec<Other>,
    lanes: Lanes,
    room: Room,
    /// Whether there are so many that forces are reckoned in lanes.
    many: bool,
}

impl Walker {
    /// Begins with the next few of so many people.
    pub(crate) fn begin(&mut self, people: usize) {
        self.many = people > FEW;
        self.lanes.clear();
    }

    /// Notes whom a person feels who wants this.
    pub(crate) fn feel(&mut self, human: &Human, want: &Want, near: &Near) -> Pairs {
        if !self.many || !walks(want) || !matches!(human.walks, Walks::Forces) {
            return Pairs::default();
        }
        let felt = |(other, seen): &(&Other, bool)| feels(human, want, other, *seen);
        let pair = |(other, _): (&Other, bool)| (other.at - human.at, human.velocity - other.velocity);
        let close = self.lanes.extend(near.close(&human.notice).filter(felt).map(pair));
        let far = human.notice.far.is_none();
        Pairs { close, far: far.then(|| self.lanes.extend(near.far(&human.notice).filter(felt).map(pair))) }
    }

    /// Reckons the forces of all pairs that were noted.
    pub(crate) fn reckon(&mut self, params: &Params) {
        if self.many {
            self.lanes.work_out(params);
        }
    }

    /// Velocity after this tick, before contacts. Heading and place follow in [`settle`].
    pub(crate) fn steer(&mut self, human: &mut Human, want: &Want, pairs: &Pairs, scene: &Steps<'_>) {
        if human.is_driven() {
            return human.obey();
        }
        let wished = match want.target {
            Some(target) if walks(want) => {
                human.anchor = None;
                if let Walks::Orca(orca) = &human.walks {
                    scene.near.noticed(&human.notice, &mut self.around);
                    let wished = avoid(orca, human, (&target, want.speed_mps), &self.around, &mut self.room);
                    let change = wished - human.velocity;
                    human.velocity + change * (A_MAX * STEP_SECS / change.norm().max(A_MAX * STEP_SECS))
                } else {
                    human.velocity + self.pull(human, want, &target, pairs, scene) * STEP_SECS
                }
            }
            Some(_) | None => gait::stand(&mut human.anchor, &human.at, &human.velocity, STEP_SECS),
        };
        let mut velocity = wished;
        let most = want.speed_mps.max(human.velocity.norm() - A_MAX * STEP_SECS).min(V_MAX);
        if want.target.is_some() && velocity.norm() > most {
            velocity *= most / velocity.norm();
        }
        stop_before_touching(human, want, scene.near, &mut velocity);
        human.velocity = velocity;
    }

    /// Acceleration by wish, people and walls, m/s².
    fn pull(&mut self, human: &mut Human, want: &Want, target: &Point, pairs: &Pairs, scene: &Steps<'_>) -> Vector {
        self.felt.clear();
        self.felt.push(Person {
            speed_mps: want.speed_mps,
            goal: Some(Goal { at: *target, radius_m: 0.02 }),
            ..person(0, human.at, human.velocity, human.radius_m)
        });
        let mut social = None;
        if self.many {
            let known = human.notice.far.unwrap_or_else(Vector::zeros);
            let from_afar = pairs.far.as_ref().map_or(known, |far| self.lanes.sum(far));
            social = Some(self.lanes.sum(&pairs.close) + from_afar);
            human.notice.far = Some(from_afar);
        } else {
            scene.near.noticed(&human.notice, &mut self.around);
            let felt = (1_u32..).zip(&self.around).filter(|(_, other)| feels(human, want, other, other.seen));
            let felt = felt.map(|(number, other)| person(number, other.at, other.velocity, other.radius_m));
            self.felt.extend(felt);
        }
        // A spot chosen beside a wall is meant: the wall's force would keep it from being reached.
        let meant = want.face.is_some()
            && (target - human.at).norm() < 1.3
            && scene.floor.straight(&human.at, target, human.radius_m);
        let walls: &[Point] = if meant { &[] } else { &human.notice.walls };
        let mut forces = forces_on(0, &self.felt, walls, scene.params);
        forces.social = social.unwrap_or(forces.social);
        // Walls beside a free way push aside, not back: their sum over both jambs would bar a narrow doorway.
        let way = target - human.at;
        let back = forces.obstacle.dot(&way) / way.norm_squared().max(1e-9);
        if back < 0.0 && scene.floor.straight(&human.at, target, DOORWAY_M) {
            forces.obstacle -= way * back;
        }
        gait::limited(&forces.total())
    }
}

/// What steering looks at.
pub(crate) struct Steps<'a> {
    pub(crate) params: &'a Params,
    pub(crate) floor: &'a Floor,
    pub(crate) near: &'a Near,
}

/// Whether this wish is a way to go.
fn walks(want: &Want) -> bool {
    want.target.is_some() && want.speed_mps > 0.0
}

/// Whether somebody who wants this feels somebody else whom it noticed.
fn feels(human: &Human, want: &Want, other: &Other, seen: bool) -> bool {
    let mate = human.group.is_some_and(|mine: GroupId| other.group == Some(mine));
    let drawn = want.drawn && other.id.is_none();
    seen && (other.at - human.at).norm_squared() < FEEL_M * FEEL_M && !mate && !drawn
}

/// A person stops before touching; forces alone would let shoulders meet.
fn stop_before_touching(human: &Human, want: &Want, near: &Near, velocity: &mut Vector) {
    for (other, _) in near.close(&human.notice) {
        let way = other.at - human.at;
        if way.norm_squared() > CLOSE_M * CLOSE_M {
            continue;
        }
        let distance = way.norm();
        let gap = distance - human.radius_m - other.radius_m;
        if !(1e-6..1.5).contains(&distance.min(1.5 - 1e-6)) || gap > 0.8 {
            continue;
        }
        let toward = way / distance;
        // Nobody brushes past a robot the way people brush past each other.
        let least = if other.id.is_none() && !want.drawn { ROBOT_GAP_M } else { 0.06 };
        // Whoever walks ahead in one's own group goes on: kept off it as from a post, a family would never get up to pace.
        let mate = human.group.is_some() && other.group == human.group;
        let goes_on = if mate { other.velocity.dot(&toward).max(0.0) } else { 0.0 };
        let excess = velocity.dot(&toward) - goes_on - (2.5 * (gap - least)).max(0.0);
        if excess > 0.0 {
            *velocity -= toward * excess;
        }
    }
}

fn person(id: u32, at: Point, velocity: Vector, radius_m: f64) -> Person {
    Person { velocity, radius_m, ..Person::standing(id, at) }
}

/// Takes over where contacts left it, turns, and counts progress along its way.
pub(crate) fn settle(human: &mut Human, want: &Want, at: Point, velocity: Vector) {
    human.at = at;
    human.velocity = velocity;
    if human.is_driven() {
        human.yaw = socrates_model::geometry::wrap_angle(human.yaw + human.omega * STEP_SECS);
    } else {
        (human.yaw, human.omega) =
            gait::turned(human.yaw, &at, &velocity, want.target.is_some(), want.face.as_ref(), STEP_SECS);
    }
    if human.trail.end().is_none_or(|end| (at - end).norm() > 0.1) {
        human.trail.push(at);
    }
}

/// Progress along the way while it is walked.
pub(crate) fn progress(human: &mut Human) {
    let (s, aside) = human.route.project_within(&human.at, human.s - 0.2, human.s + 1.5);
    if aside < 2.0 {
        human.s = s.max(human.s);
    }
}

/// Takes the way up again after something else was done.
pub(crate) fn resume(human: &mut Human) {
    let (s, aside) = human.route.project_within(&human.at, human.s, human.route.length_m());
    if aside < 2.5 {
        human.s = human.s.max(s);
    }
}
