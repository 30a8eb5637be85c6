//! The floor as planners see it: walls, closed doors, people as discs.

use std::sync::Arc;

use socrates_maps::{DistanceField, nearest_free, shortest_path};
use socrates_model::geometry::{nearest_on_segment, segments_cross};
use socrates_model::{Grid, Observation, Point, Polyline, Pose, Vector};

use crate::mission::Mission;

/// Somebody slower than this stands, m/s.
pub(crate) const STANDING_MPS: f64 = 0.2;

/// Room beside the body that a way is planned with, m.
const ROOM_M: f64 = 0.03;
/// A point too near to a wall is taken to a place at most so far away, m.
const BESIDE_M: f64 = 0.5;

/// The shortest free way through the waypoints of a mission, as far as one leads; shut doors and people are not looked at.
#[must_use]
pub fn free_way(mission: &Mission) -> Vec<Point> {
    Ground::new(mission).through(&mission.waypoints).0.points().to_vec()
}

/// Walls of the mission.
#[derive(Debug, Clone)]
pub(crate) struct Ground {
    grid: Grid,
    field: Arc<DistanceField>,
    pub(crate) radius_m: f64,
    /// Lines of the doors that were shut at the last look.
    shut: Vec<(Point, Point)>,
}

/// A person as an obstacle: a stretch of floor with a radius, and whether going there is forbidden or only dear.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Obstacle {
    pub(crate) from: Point,
    pub(crate) to: Point,
    pub(crate) radius_m: f64,
    pub(crate) hard: bool,
}

impl Ground {
    pub(crate) fn new(mission: &Mission) -> Self {
        Self {
            grid: mission.grid.clone(),
            field: Arc::clone(&mission.field),
            radius_m: mission.robot.radius_m,
            shut: Vec::new(),
        }
    }

    /// Takes over which doors are shut.
    pub(crate) fn look(&mut self, seen: &Observation<'_>) {
        self.shut.clear();
        self.shut.extend(seen.doors.iter().filter(|door| !door.open).map(|door| (door.from, door.to)));
    }

    /// Distance to the nearest wall or shut door, m.
    pub(crate) fn clearance_m(&self, point: &Point) -> f64 {
        let wall = self.field.clearance(point);
        self.shut.iter().fold(wall, |least, (from, to)| least.min(nearest_on_segment(point, from, to).0))
    }

    /// The nearest wall point in each of so many sectors within reach, and of each shut door.
    pub(crate) fn wall_points(&self, at: &Point, reach_m: f64, sectors: usize) -> Vec<Point> {
        let mut points = self.field.sectors(at, reach_m, sectors);
        let near = |(from, to): &(Point, Point)| {
            let (distance_m, point) = nearest_on_segment(at, from, to);
            (distance_m < reach_m).then_some(point)
        };
        points.extend(self.shut.iter().filter_map(near));
        points
    }

    /// Whether the robot's disc with a margin can go straight.
    pub(crate) fn straight(&self, from: &Point, to: &Point, margin_m: f64) -> bool {
        let way = to - from;
        let length = way.norm();
        let reach = self.radius_m + margin_m;
        let mut gone = 0.0;
        loop {
            let here = if length > 0.0 { from + way * (gone / length) } else { *from };
            let free = self.clearance_m(&here);
            if free < reach {
                return false;
            }
            if gone >= length {
                return true;
            }
            gone = (gone + (free - reach).max(0.04)).min(length);
        }
    }

    /// The shortest way over the whole map.
    pub(crate) fn way(&self, from: &Point, to: &Point) -> Option<Polyline> {
        if self.straight(from, to, 0.05) {
            return Some(Polyline::new(&[*from, *to]));
        }
        shortest_path(&self.grid, &self.field, from, to, self.radius_m + ROOM_M).map(|points| Polyline::new(&points))
    }

    /// The shortest way through all these points, and whether it leads to the last of them: it ends before the first that cannot
    /// be reached. Points too near to a wall are passed beside it.
    pub(crate) fn through(&self, points: &[Point]) -> (Polyline, bool) {
        let mut route = Polyline::default();
        for point in points {
            let Some(to) = nearest_free(&self.field, point, self.radius_m + ROOM_M, BESIDE_M) else {
                return (route, false);
            };
            let Some(from) = route.end() else {
                route.push(to);
                continue;
            };
            let Some(way) = self.way(&from, &to) else { return (route, false) };
            way.points().iter().for_each(|point| route.push(*point));
        }
        (route, true)
    }

    /// How far the robot's disc with a margin can go straight ahead, at most `reach_m`, m.
    pub(crate) fn front_m(&self, pose: &Pose, margin_m: f64, reach_m: f64) -> f64 {
        let ahead = Vector::new(libm::cos(pose.yaw), libm::sin(pose.yaw));
        let mut gone = 0.0;
        while gone < reach_m {
            let free = self.clearance_m(&(pose.point() + ahead * gone)) - self.radius_m - margin_m;
            if free < 0.0 {
                return gone;
            }
            gone += free.max(0.02);
        }
        reach_m
    }
}

/// People near the way as obstacles: who stands, whoever comes the other way, and the space inside a circle of people.
pub(crate) fn obstacles(seen: &Observation<'_>, ahead: &Vector, reach_m: f64) -> Vec<Obstacle> {
    let at = seen.pose.point();
    let mut found = Vec::new();
    for person in seen.people {
        let way = person.at - at;
        if way.norm() > reach_m {
            continue;
        }
        let speed = person.velocity.norm();
        let to = if speed < STANDING_MPS {
            person.at
        } else if person.velocity.dot(ahead) < -0.6 * speed && way.dot(ahead) > 0.0 {
            // Comes the other way: its next second and a half is taken.
            person.at + person.velocity * 1.5
        } else {
            continue;
        };
        found.push(Obstacle { from: person.at, to, radius_m: person.radius_m, hard: true });
    }
    let standing: Vec<&socrates_model::SeenPerson> = seen
        .people
        .iter()
        .filter(|person| person.velocity.norm() < STANDING_MPS && (person.at - at).norm() < reach_m)
        .collect();
    for (place, a) in standing.iter().enumerate() {
        for b in standing.iter().skip(place + 1).filter(|b| (b.at - a.at).norm() < 2.2) {
            found.push(Obstacle { from: a.at, to: b.at, radius_m: 0.1, hard: false });
        }
    }
    found
}

impl Obstacle {
    /// Distance from a point to the obstacle's surface, m.
    pub(crate) fn gap_m(&self, point: &Point) -> f64 {
        nearest_on_segment(point, &self.from, &self.to).0 - self.radius_m
    }
}

/// Before a shut door on its way a robot of this radius stands so far off, m, and looks for one so far ahead, m.
const DOOR_M: f64 = 0.7;
const DOOR_AHEAD_M: f64 = 1.2;
/// So near to the end of its way a robot has arrived, m.
const ARRIVED_M: f64 = 0.12;

/// Whether a robot that has come to `s` along a way stands before a shut door on it.
pub(crate) fn waits_at_door(seen: &Observation<'_>, way: &Polyline, s: f64, robot_radius_m: f64) -> bool {
    closed_door_ahead(seen, way, s, DOOR_AHEAD_M).is_some_and(|left| left < robot_radius_m + DOOR_M)
}

/// Whether a robot that has come to `s` along a way is at its end.
pub(crate) fn is_at_end(way: &Polyline, at: &Point, s: f64) -> bool {
    way.end().is_some_and(|end| (end - at).norm() < ARRIVED_M) && s > way.length_m() - 2.0 * ARRIVED_M
}

/// Distance along a way, from `s` on, to the first closed door on it, m.
pub(crate) fn closed_door_ahead(seen: &Observation<'_>, way: &Polyline, s: f64, reach_m: f64) -> Option<f64> {
    let mut gone = 0.0;
    let mut from = way.point(s);
    while gone < reach_m {
        let to = way.point(s + gone + 0.2);
        if seen.doors.iter().any(|door| !door.open && segments_cross(&from, &to, &door.from, &door.to)) {
            return Some(gone);
        }
        from = to;
        gone += 0.2;
    }
    None
}
