//! Standing groups that are more than a circle on the robot's way: a line that waits, and a circle that the robot comes
//! to or starts from.

use std::f64::consts::TAU;

use socrates_model::{Point, Polyline, Vector};

use crate::floor::Floor;
use crate::placing::{MARGIN_M, ring_places};

/// Distance of neighbors in a line, m.
const LINE_GAP_M: f64 = 0.95;
/// Distance of a line from the robot's way that leaves it free, m.
const BESIDE_M: f64 = 1.0;
/// Distance of the robot's center from the ring of people whom it joins or leaves, m: in their p-space.
const RIM_M: f64 = 0.4;
/// Members keep so far from the robot's way, m.
const CLEAR_OF_WAY_M: f64 = 0.75;

/// Distance of neighbors where there is no room for a circle, m, and how many steps of 0.1 m to either side a place for
/// one of them is looked for.
const SQUEEZE_M: f64 = 0.75;
const SQUEEZE_STEPS: i32 = 30;

/// What is known of the floor round a group.
pub(crate) struct Around<'a> {
    pub(crate) floor: &'a Floor,
    pub(crate) route: Option<&'a Polyline>,
    pub(crate) taken: &'a [(Point, f64)],
    pub(crate) body: f64,
}

impl Around<'_> {
    fn free(&self, at: &Point) -> bool {
        self.floor.clearance_m(at) >= self.body + MARGIN_M
            && self.taken.iter().all(|(other, least)| (at - other).norm() >= *least)
    }

    fn off_way_m(&self, at: &Point) -> f64 {
        self.route.map_or(f64::INFINITY, |route| route.project(at).1)
    }
}

/// Whether a group at `home` is where the robot's way ends (`Some(true)`) or begins (`Some(false)`).
pub(crate) fn at_end(home: &Point, route: Option<&Polyline>) -> Option<bool> {
    let route = route.filter(|route| route.length_m() > 3.0)?;
    let near = |at: Option<Point>| at.is_some_and(|at| (at - home).norm() < 0.3);
    if near(route.end()) {
        Some(true)
    } else if near(Some(route.point(0.0))) {
        Some(false)
    } else {
        None
    }
}

/// A circle with the robot's first or last place on its rim: beyond the end of its way, or behind its start.
pub(crate) fn rim(home: &Point, count: usize, ring: f64, ends: bool, around: &Around<'_>) -> Option<Vec<(Point, f64)>> {
    let route = around.route?;
    let along = if ends { route.direction(route.length_m()) } else { -route.direction(0.0) };
    let heading = libm::atan2(along.y, along.x);
    let mut best: Option<(f64, Vec<(Point, f64)>)> = None;
    for turn in -8..=8_i32 {
        let off = f64::from(turn) * TAU / 32.0;
        let angle = heading + off;
        for far in 0..=3_u32 {
            let reach = ring + RIM_M + 0.1 * f64::from(far);
            let center = home + Vector::new(libm::cos(angle), libm::sin(angle)) * reach;
            // The robot's place is in a gap between two members.
            let places = ring_places(&center, ring, count, angle + std::f64::consts::PI);
            let free = places.iter().all(|(at, _)| {
                around.free(at) && (at - home).norm() >= around.body + 0.4 && around.floor.straight(&center, at, 0.2)
            });
            if !free || !around.floor.straight(home, &center, 0.2) {
                continue;
            }
            let close: f64 = places.iter().map(|(at, _)| (CLEAR_OF_WAY_M - around.off_way_m(at)).max(0.0)).sum();
            let score = -2.0 * close - 0.4 * off.abs() - 2.0 * (reach - ring - RIM_M);
            if best.as_ref().is_none_or(|(top, _)| score > *top + 1e-9) {
                best = Some((score, places));
            }
        }
    }
    best.map(|(_, places)| places)
}

/// A line of people who wait one behind the other, beside the robot's way or across from it.
pub(crate) fn line(home: &Point, count: usize, around: &Around<'_>) -> Option<Vec<(Point, f64)>> {
    let along = around.route.map_or_else(|| Vector::new(1.0, 0.0), |route| route.direction(route.project(home).0));
    let heading = libm::atan2(along.y, along.x);
    #[expect(clippy::cast_precision_loss, reason = "a few people")]
    let half = (count.max(1) as f64 - 1.0) / 2.0;
    let mut best: Option<(f64, Vec<(Point, f64)>)> = None;
    for quarter in 0..4_u32 {
        let yaw = heading + f64::from(quarter) * TAU / 4.0;
        let toward = Vector::new(libm::cos(yaw), libm::sin(yaw));
        for ahead in -8..=8_i32 {
            for aside in -10..=10_i32 {
                let offset =
                    along * (0.25 * f64::from(ahead)) + Vector::new(-along.y, along.x) * (0.25 * f64::from(aside));
                let center = home + offset;
                #[expect(clippy::cast_precision_loss, reason = "a few people")]
                let places: Vec<(Point, f64)> =
                    (0..count).map(|place| (center + toward * ((half - place as f64) * LINE_GAP_M), yaw)).collect();
                let off = places.iter().map(|(at, _)| around.off_way_m(at)).fold(f64::INFINITY, f64::min);
                let near = off < 2.5;
                if !near || !places.iter().all(|(at, _)| around.free(at) && around.floor.straight(&center, at, 0.2)) {
                    continue;
                }
                // Off the way first, then near the node; lengthwise before across.
                let score = 4.0 * off.min(BESIDE_M)
                    - 0.5 * offset.norm()
                    - 0.4 * (off - BESIDE_M).max(0.0)
                    - 0.2 * f64::from(quarter % 2);
                if best.as_ref().is_none_or(|(top, _)| score > *top + 1e-9) {
                    best = Some((score, places));
                }
            }
        }
    }
    best.map(|(_, places)| places)
}

/// Where no circle fits, as in an aisle: each on the free place nearest to `home`, looking at the middle of them all.
pub(crate) fn squeezed(home: &Point, count: usize, around: &Around<'_>) -> Option<Vec<(Point, f64)>> {
    let mut places: Vec<Point> = Vec::new();
    for _ in 0..count {
        let mut best: Option<(f64, Point)> = None;
        for (right, up) in (-SQUEEZE_STEPS..=SQUEEZE_STEPS).flat_map(|right| {
            (-SQUEEZE_STEPS..=SQUEEZE_STEPS).map(move |up| (0.1 * f64::from(right), 0.1 * f64::from(up)))
        }) {
            let at = home + Vector::new(right, up);
            let far = (at - home).norm();
            let free = around.free(&at)
                && places.iter().all(|other| (at - other).norm() >= SQUEEZE_M)
                && around.floor.straight(home, &at, around.body.min(around.floor.wall_clearance_m(home)).min(0.2));
            if free && best.is_none_or(|(least, _)| far < least - 1e-9) {
                best = Some((far, at));
            }
        }
        places.push(best?.1);
    }
    #[expect(clippy::cast_precision_loss, reason = "a few people")]
    let middle = places.iter().map(|at| at.coords).sum::<Vector>() / places.len().max(1) as f64;
    let toward = |at: &Point| {
        let way = middle - at.coords;
        if way.norm() > 0.05 { libm::atan2(way.y, way.x) } else { 0.0 }
    };
    Some(places.iter().map(|at| (*at, toward(at))).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::hall;

    fn floor() -> (Floor, Polyline) {
        (Floor::new(&hall(16.0, 8.0)), Polyline::new(&[Point::new(2.0, 4.0), Point::new(12.0, 4.0)]))
    }

    #[test]
    fn a_line_stands_beside_the_way_with_even_gaps_and_looks_one_way() {
        let (floor, route) = floor();
        let around = Around { floor: &floor, route: Some(&route), taken: &[], body: 0.28 };
        let places = line(&Point::new(7.0, 4.0), 4, &around).unwrap();
        for pair in places.windows(2) {
            assert!(((pair[0].0 - pair[1].0).norm() - LINE_GAP_M).abs() < 1e-9);
            assert!((pair[0].1 - pair[1].1).abs() < 1e-9);
        }
        assert!(places.iter().all(|(at, _)| route.project(at).1 >= BESIDE_M - 1e-9), "{places:?}");
    }

    #[test]
    fn people_in_an_aisle_too_narrow_for_a_circle_stand_free_of_its_walls_and_of_each_other() {
        let floor = Floor::new(&crate::fixture::carve(12.0, 4.0, &[(0.5, 1.5, 11.5, 2.6)]));
        let around = Around { floor: &floor, route: None, taken: &[], body: 0.28 };
        let places = squeezed(&Point::new(6.0, 2.05), 3, &around).unwrap();
        for (place, (at, _)) in places.iter().enumerate() {
            assert!(floor.clearance_m(at) >= 0.28 + MARGIN_M && (at.x - 6.0).abs() < 1.5, "{at}");
            assert!(places.iter().skip(place + 1).all(|(other, _)| (at - other).norm() >= SQUEEZE_M), "{places:?}");
        }
        let shut = Floor::new(&crate::fixture::carve(12.0, 4.0, &[(0.5, 1.8, 11.5, 2.2)]));
        assert_eq!(squeezed(&Point::new(6.0, 2.05), 3, &Around { floor: &shut, ..around }), None);
    }

    #[test]
    fn the_robots_place_is_on_the_rim_of_a_circle_beyond_its_end_or_behind_its_start() {
        let (floor, route) = floor();
        let around = Around { floor: &floor, route: Some(&route), taken: &[], body: 0.28 };
        for (home, ends) in [(Point::new(12.0, 4.0), true), (Point::new(2.0, 4.0), false)] {
            assert_eq!(at_end(&home, Some(&route)), Some(ends));
            let places = rim(&home, 3, 0.64, ends, &around).unwrap();
            let center = Point::from(places.iter().map(|(at, _)| at.coords).sum::<Vector>() / 3.0);
            assert!(((center - home).norm() - 0.64 - RIM_M).abs() < 0.35, "{center}");
            assert_eq!(center.x > home.x, ends, "{center}");
        }
        assert_eq!(at_end(&Point::new(7.0, 4.0), Some(&route)), None);
    }
}
