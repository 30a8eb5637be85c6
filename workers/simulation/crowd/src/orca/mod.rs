//! Optimal reciprocal collision avoidance: people who choose the velocity nearest to the wished one
//! among those that bring no collision within a horizon, each taking half of the turn aside.
//!
//! After van den Berg, Guy, Lin and Manocha, "Reciprocal n-body collision avoidance" (2011). For each
//! neighbor the velocities that lead to a collision within the horizon form a truncated cone; the
//! nearest way out of it, halved, gives a half-plane of allowed velocities. Walls are simpler here than
//! in the paper: a segment is convex, so the line through its closest point, square to the way there,
//! has all of it on the far side, and a velocity that does not reach that line within the horizon is
//! safe. The allowed velocity nearest to the wish is a small linear program; where none is allowed, the
//! one that violates the people's half-planes least, with those of walls kept.

mod program;

use nalgebra::Vector2;

use crate::model::{CrowdModel, Room, View};
use crate::near::{Found, nearest_first};
use crate::obstacle::Segment;
use crate::person::Person;
use crate::vector::{dot, norm, unit};
pub(crate) use program::HalfPlane;
use program::solve;

/// How people who avoid each other look ahead.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OrcaSettings {
    /// People beyond this distance are not looked at, m. Default 5.
    pub neighbor_range_m: f64,
    /// At most so many people are looked at, the nearest. Default 10.
    pub most_neighbors: usize,
    /// No collision with people is allowed to be nearer than this, s. Default 2. Larger: earlier and
    /// smaller turns, and slower crowds.
    pub horizon_s: f64,
    /// The same for walls, s. Default 0.5.
    pub wall_horizon_s: f64,
    /// Largest speed, as a factor of the desired speed. Default 1: nobody is faster than wished.
    pub speed_factor: f64,
    /// How far the wish turns to the right while somebody is ahead, rad. Default 0.1. With 0 the model
    /// is that of the paper, in which people who meet exactly head on stop face to face for good.
    pub keep_right_rad: f64,
}

impl Default for OrcaSettings {
    fn default() -> Self {
        Self {
            neighbor_range_m: 5.0,
            most_neighbors: 10,
            horizon_s: 2.0,
            wall_horizon_s: 0.5,
            speed_factor: 1.0,
            keep_right_rad: 0.1,
        }
    }
}

/// A setting that cannot be meant.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("avoidance setting `{name}` is `{value}`; allowed: {allowed}")]
pub struct BadOrca {
    /// Field.
    pub name: &'static str,
    /// Its value.
    pub value: f64,
    /// What would be taken.
    pub allowed: &'static str,
}

/// The model.
#[derive(Debug, Clone, Copy)]
pub struct Orca {
    settings: OrcaSettings,
    /// Sine and cosine of the turn to the right.
    turn: (f64, f64),
}

impl Orca {
    /// People with these settings.
    ///
    /// # Errors
    /// [`BadOrca`] for the first setting that is not a finite number above 0 (for `keep_right_rad`: from
    /// 0 to pi/2).
    pub fn new(settings: OrcaSettings) -> Result<Self, BadOrca> {
        let numbers = [
            ("neighbor_range_m", settings.neighbor_range_m),
            ("horizon_s", settings.horizon_s),
            ("wall_horizon_s", settings.wall_horizon_s),
            ("speed_factor", settings.speed_factor),
        ];
        if let Some((name, value)) = numbers.into_iter().find(|(_, value)| !(value.is_finite() && *value > 0.0)) {
            return Err(BadOrca { name, value, allowed: "a finite number above 0" });
        }
        if !(0.0..=std::f64::consts::FRAC_PI_2).contains(&settings.keep_right_rad) {
            let value = settings.keep_right_rad;
            return Err(BadOrca { name: "keep_right_rad", value, allowed: "0 to pi/2" });
        }
        let turn = (libm::sin(-settings.keep_right_rad), libm::cos(settings.keep_right_rad));
        Ok(Self { settings, turn })
    }

    /// The velocity that somebody takes, m/s. What `room` holds means nothing.
    #[must_use]
    pub fn velocity(&self, view: &View<'_>, room: &mut Room) -> Vector2<f64> {
        let me = view.me;
        let most_mps = me.speed_mps * self.settings.speed_factor;
        let walls = view.walls_around(&me.position, me.radius_m + self.settings.wall_horizon_s * most_mps);
        room.planes.clear();
        room.planes.extend(walls.filter_map(|wall| self.around_wall(me, wall, most_mps, view.dt_s)));
        let n_walls = room.planes.len();
        self.neighbors(view, &mut room.found);
        let mut wish = wished(me, view.dt_s);
        let mut ahead = false;
        for (place, other) in room.found.iter().filter_map(|found| Some((found.place, view.people.get(found.place)?))) {
            let first = view.place.is_none_or(|own| own < place);
            room.planes.push(around_person(me, other, self.settings.horizon_s, view.dt_s, first));
            ahead |= dot(&(other.position - me.position), &wish) > 0.0;
        }
        if ahead {
            let (sin, cos) = self.turn;
            wish = Vector2::new(wish.x * cos - wish.y * sin, wish.x * sin + wish.y * cos);
        }
        solve(&room.planes, n_walls, most_mps, &wish, &mut room.projected)
    }

    /// The nearest others in range, the nearest first; those at one distance in the order of places.
    fn neighbors(&self, view: &View<'_>, found: &mut Vec<Found>) {
        let (at, range_m, most) = (&view.me.position, self.settings.neighbor_range_m, self.settings.most_neighbors);
        if let Some(index) = view.index {
            index.near.nearest(at, view.place, range_m, most, found);
            return;
        }
        found.clear();
        let finite = view.others().filter(|(_, other)| is_finite(other));
        let all = finite.map(|(place, other)| Found { distance_m: norm(&(other.position - at)), place });
        found.extend(all.filter(|found| found.distance_m < range_m));
        nearest_first(found, most);
    }

    /// Velocities that do not reach the line in front of a wall within the horizon. None for somebody
    /// whose center lies on the wall: there is no side to be led to.
    fn around_wall(&self, me: &Person, wall: &Segment, most_mps: f64, dt_s: f64) -> Option<HalfPlane> {
        let way = wall.closest(&me.position) - me.position;
        let distance = norm(&way);
        let free = distance - me.radius_m;
        let in_range = free < self.settings.wall_horizon_s * most_mps;
        if !in_range || distance <= 0.0 {
            return None;
        }
        let normal = -unit(&way);
        // Somebody inside the wall is led out, no faster than it can go.
        let approach =
            if free < 0.0 { (free / dt_s).max(-most_mps / 2.0) } else { free / self.settings.wall_horizon_s };
        Some(HalfPlane::new(-normal * approach, normal))
    }
}

fn is_finite(person: &Person) -> bool {
    person.position.iter().chain(person.velocity.iter()).all(|number| number.is_finite())
}

/// Towards the goal at the desired speed, slower in the last step; rest without one or inside its radius.
fn wished(me: &Person, dt_s: f64) -> Vector2<f64> {
    let Some(goal) = me.goal else { return Vector2::zeros() };
    let way = goal.at - me.position;
    let left = norm(&way);
    if left <= goal.radius_m { Vector2::zeros() } else { unit(&way) * me.speed_mps.min(left / dt_s) }
}

/// Velocities of `me` that, with the other doing its half, bring no collision within the horizon; out of
/// an overlap they lead within the step.
///
/// Two people on one spot with one velocity part along the x axis, the one who is `first` to the left.
fn around_person(me: &Person, other: &Person, horizon_s: f64, dt_s: f64, first: bool) -> HalfPlane {
    let way = other.position - me.position;
    let closing = me.velocity - other.velocity;
    let reach = me.radius_m + other.radius_m;
    let overlap = dot(&way, &way) <= reach * reach;
    let time_s = if overlap { dt_s } else { horizon_s };
    // From the center of the cut-off circle of the cone.
    let from_center = closing - way / time_s;
    let along = dot(&from_center, &way);
    let in_front = along < 0.0 && along * along > reach * reach * dot(&from_center, &from_center);
    let (normal, turn) = if overlap || in_front {
        let size = norm(&from_center);
        let normal = if size > 0.0 { from_center / size } else { Vector2::new(if first { -1.0 } else { 1.0 }, 0.0) };
        (normal, normal * (reach / time_s - size))
    } else {
        // The legs touch the circle of the sum of radii; on the axis everybody turns to the right.
        let distance2 = dot(&way, &way);
        let leg = (distance2 - reach * reach).sqrt();
        let to_left = way.x * from_center.y - way.y * from_center.x > 0.0;
        let direction = if to_left {
            Vector2::new(way.x * leg - way.y * reach, way.x * reach + way.y * leg) / distance2
        } else {
            Vector2::new(way.x * leg + way.y * reach, way.y * leg - way.x * reach) / -distance2
        };
        (Vector2::new(-direction.y, direction.x), direction * dot(&closing, &direction) - closing)
    };
    HalfPlane::new(me.velocity + turn * 0.5, normal)
}

impl CrowdModel for Orca {
    fn name(&self) -> &'static str {
        "orca"
    }

    /// Somebody whose own state is not finite stays as it is.
    fn next(&self, view: &View<'_>, room: &mut Room) -> Option<Person> {
        let mut next = view.me.clone();
        if is_finite(view.me) {
            next.velocity = self.velocity(view, room);
            next.position += next.velocity * view.dt_s;
            if norm(&next.velocity) > 0.0 {
                next.yaw = libm::atan2(next.velocity.y, next.velocity.x);
            }
        }
        Some(next)
    }
}
