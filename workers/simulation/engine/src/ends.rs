//! Where paths end: beside the robot's goal, beside each other, and out of the way of those who still go somewhere.

use socrates_model::geometry::nearest_on_segment;
use socrates_model::{Door, Point, Polyline, Vector};

use crate::floor::Floor;
use crate::setup::PERSON_RADIUS_M;

/// Nearer than this to the robot's way somebody stands on it, and at this distance the robot passes with room, m.
const ON_WAY_M: f64 = 0.8;
const OFF_WAY_M: f64 = 1.0;
/// Least distance from the robot's way that is worth a step aside, m.
const LEAST_OFF_M: f64 = 0.7;
/// Nearer than this to a door somebody stands before it, m; a place that is chosen in front of it is farther; beside its
/// frame so far is enough.
const BEFORE_DOOR_M: f64 = 2.0;
const CLEAR_OF_DOOR_M: f64 = 3.0;
const BESIDE_DOOR_M: f64 = 0.4;
/// Distance from a wall at which people stand along it, m.
const BY_WALL_M: f64 = 0.45;
/// Nobody's way ends nearer to the robot's goal than this, m: both bodies, and the half meter before its end where somebody already
/// stands. Two ends are so far apart, m.
pub(crate) const GOAL_APART_M: f64 = 1.2;
const ENDS_APART_M: f64 = 0.75;
/// Whoever ends short of an end that is taken does so at one of so many steps of this length, m, and walks at least so far, m.
const SHORT_STEPS: u32 = 24;
const SHORT_M: f64 = 0.125;
const LEAST_WAY_M: f64 = 1.0;
/// How far from the end of the path a place is looked for, in rings of 0.25 m.
const RINGS: u32 = 8;

/// A route that ends at another place: it turns off so far before its old end, where nothing is between, instead of walking to
/// that first.
fn turned_off(route: &Polyline, to: Point, short_m: f64, floor: &Floor) -> Polyline {
    let mut points: Vec<Point> = route.points().to_vec();
    let before = route.point(route.length_m() - short_m);
    if let Some(last) = points.last_mut().filter(|_| floor.straight(&before, &to, 0.2)) {
        *last = before;
    }
    points.push(to);
    Polyline::new(&points)
}

/// A route that ends before the first place on its way back that is free: where there is no room beside its end, whoever walks it
/// stops short of it.
fn short_of(route: Polyline, crowded: &dyn Fn(&Point) -> bool) -> Polyline {
    let length_m = route.length_m();
    let steps = (1..=SHORT_STEPS).map(|step| length_m - SHORT_M * f64::from(step)).take_while(|s| *s > LEAST_WAY_M);
    let free = steps.filter(|s| !crowded(&route.point(*s)));
    let Some(s) = free.max_by(f64::total_cmp) else { return route };
    let mut points: Vec<Point> =
        route.points().iter().zip(route.marks_m()).filter(|(_, mark)| **mark < s).map(|(point, _)| *point).collect();
    points.push(route.point(s));
    Polyline::new(&points)
}

/// Who walks to the robot's own goal ends beside it, so that both can arrive; who walks with others, so many meters to both
/// sides, farther by that.
pub(crate) fn clear_end(route: Polyline, robot_way: &Polyline, flank_m: f64, floor: &Floor) -> Polyline {
    let (Some(end), Some(goal)) = (route.end(), robot_way.end()) else { return route };
    let crowded = |at: &Point| (at - goal).norm() <= GOAL_APART_M + flank_m;
    if !crowded(&end) {
        return route;
    }
    let mut best: Option<(f64, Point)> = None;
    for ring in 0..=6_u32 {
        for turn in 0..24_u32 {
            let angle = f64::from(turn) / 24.0 * std::f64::consts::TAU;
            let far = 1.3 + flank_m + 0.2 * f64::from(ring);
            let at = goal + Vector::new(libm::cos(angle), libm::sin(angle)) * far;
            let aside = robot_way.project(&at).1;
            let free = floor.wall_clearance_m(&at) >= PERSON_RADIUS_M + 0.05 && floor.straight(&end, &at, 0.2);
            let cost = (at - goal).norm() + 2.0 * (1.1 - aside).max(0.0);
            if free && aside > 0.6 && best.is_none_or(|(least, _)| cost < least - 1e-9) {
                best = Some((cost, at));
            }
        }
    }
    let Some((_, at)) = best else { return short_of(route, &crowded) };
    turned_off(&route, at, 0.8, floor)
}

/// Who walks to a place where somebody else's path ends too ends beside them, so that both can arrive, and not on the robot's
/// goal.
pub(crate) fn apart(route: Polyline, taken: &[Point], goal: Option<Point>, floor: &Floor) -> Polyline {
    let crowded = |at: &Point| {
        taken.iter().any(|other| (other - at).norm() < ENDS_APART_M)
            || goal.is_some_and(|goal| (goal - at).norm() < GOAL_APART_M)
    };
    let Some(end) = route.end().filter(|end| route.length_m() > LEAST_WAY_M && crowded(end)) else { return route };
    let mut best: Option<(f64, Point)> = None;
    for ring in 0..=4_u32 {
        for turn in 0..16_u32 {
            let angle = f64::from(turn) / 16.0 * std::f64::consts::TAU;
            let at = end + Vector::new(libm::cos(angle), libm::sin(angle)) * (0.8 + 0.2 * f64::from(ring));
            let free = floor.wall_clearance_m(&at) >= PERSON_RADIUS_M + 0.1 && floor.straight(&end, &at, 0.2);
            // Short of the others, so that nobody has to walk round them.
            let cost = (at - end).norm() + 0.3 * (at - route.point(route.length_m() - 1.0)).norm();
            if free && !crowded(&at) && best.is_none_or(|(least, _)| cost < least - 1e-9) {
                best = Some((cost, at));
            }
        }
    }
    let Some((_, at)) = best else { return short_of(route, &crowded) };
    turned_off(&route, at, 0.9, floor)
}

/// A route that ends so far to the left of its end, where there is room.
pub(crate) fn beside(route: &Polyline, left_m: f64, floor: &Floor) -> Polyline {
    let ahead = route.direction((route.length_m() - 0.1).max(0.0));
    let mut points = route.points().to_vec();
    if let Some(end) = points.last_mut() {
        let at = *end + Vector::new(-ahead.y, ahead.x) * left_m;
        if floor.wall_clearance_m(&at) >= PERSON_RADIUS_M + 0.05 {
            *end = at;
        }
    }
    Polyline::new(&points)
}

/// Whether a point is in front of a door: so near to it and not beside its frame.
fn before(door: &Door, at: &Point, near_m: f64) -> bool {
    let along = door.to - door.from;
    let length = along.norm().max(1e-6);
    let share_m = (at - door.from).dot(&along) / length;
    nearest_on_segment(at, &door.from, &door.to).0 < near_m
        && (-BESIDE_DOOR_M..=length + BESIDE_DOOR_M).contains(&share_m)
}

/// Who would stay on the robot's way or in front of a door ends at the wall beside it, where there is room.
pub(crate) fn aside(route: Polyline, robot_way: &Polyline, doors: &[Door], floor: &Floor) -> Polyline {
    let Some(end) = route.end() else { return route };
    let off = |at: &Point| if robot_way.length_m() > 0.0 { robot_way.project(at).1 } else { f64::INFINITY };
    let barred = |at: &Point, near_m: f64| doors.iter().any(|door| before(door, at, near_m));
    if off(&end) >= ON_WAY_M && !barred(&end, BEFORE_DOOR_M) {
        return route;
    }
    let mut best: Option<(f64, Point)> = None;
    for ring in 1..=RINGS {
        for turn in 0..16_u32 {
            let angle = f64::from(turn) / 16.0 * std::f64::consts::TAU;
            let far = 0.25 * f64::from(ring);
            let at = end + Vector::new(libm::cos(angle), libm::sin(angle)) * far;
            let room = floor.wall_clearance_m(&at);
            if room < PERSON_RADIUS_M + 0.05
                || off(&at) < LEAST_OFF_M
                || barred(&at, CLEAR_OF_DOOR_M)
                || !floor.straight(&end, &at, 0.2)
            {
                continue;
            }
            let cost = far + 3.0 * (OFF_WAY_M - off(&at)).max(0.0) + 0.5 * (room - BY_WALL_M).max(0.0);
            if best.is_none_or(|(least, _)| cost < least - 1e-9) {
                best = Some((cost, at));
            }
        }
    }
    let Some((_, at)) = best else { return route };
    turned_off(&route, at, 0.8, floor)
}

#[cfg(test)]
mod tests {
    use socrates_model::{DoorKind, DoorOpens};

    use super::*;
    use crate::fixture::carve;

    #[test]
    fn who_would_stay_on_the_robots_way_or_before_a_door_ends_at_the_wall() {
        let floor = Floor::new(&carve(20.0, 6.0, &[(0.5, 1.0, 19.5, 4.0)]));
        let along = Polyline::new(&[Point::new(1.0, 2.5), Point::new(19.0, 2.5)]);
        let walk = |x: f64, y: f64| Polyline::new(&[Point::new(2.0, 3.2), Point::new(x, y)]);
        let ended = aside(walk(10.0, 2.5), &along, &[], &floor);
        let end = ended.end().unwrap();
        assert!((end.y - 2.5).abs() >= 0.95 && floor.wall_clearance_m(&end) >= 0.33, "{end}");
        assert!((end - Point::new(10.0, 2.5)).norm() <= 2.0, "{end}");
        // A door in the lower wall, the robot elsewhere.
        let away = Polyline::new(&[Point::new(1.0, 3.6), Point::new(1.0, 1.4)]);
        let door = Door {
            id: "lift".into(),
            kind: DoorKind::Elevator,
            from: Point::new(9.4, 1.0),
            to: Point::new(10.6, 1.0),
            opens: DoorOpens::Never,
            hold_s: 12.0,
            inside: vec![],
        };
        let end = aside(walk(10.0, 2.5), &away, std::slice::from_ref(&door), &floor).end().unwrap();
        assert!(!before(&door, &end, CLEAR_OF_DOOR_M) && (end - Point::new(10.0, 2.5)).norm() > 0.5, "{end}");
        let short = beside(&walk(10.0, 2.5), 0.4, &floor).end().unwrap();
        assert!(((short - Point::new(10.0, 2.5)).norm() - 0.4).abs() < 1e-9, "{short}");
        // Who is in nobody's way stays where it is, and so does who has no room.
        assert_eq!(aside(walk(15.0, 2.5), &away, std::slice::from_ref(&door), &floor), walk(15.0, 2.5));
        let narrow = Floor::new(&carve(20.0, 6.0, &[(0.5, 2.0, 19.5, 3.2)]));
        assert_eq!(aside(walk(10.0, 2.6), &along, &[], &narrow), walk(10.0, 2.6));
    }
}
