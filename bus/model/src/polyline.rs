//! A way through the plane, measured along itself.

use crate::geometry::{Point, Vector, nearest_on_segment};

/// Points joined by straight lines, with the length along them. Never has two equal points in a row.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Polyline {
    points: Vec<Point>,
    along: Vec<f64>,
}

impl Polyline {
    /// The way through these points; points nearer than a millimeter to the one before are left out.
    #[must_use]
    pub fn new(points: &[Point]) -> Self {
        let mut way = Self::default();
        for point in points {
            way.push(*point);
        }
        way
    }

    /// Goes on to one more point.
    pub fn push(&mut self, point: Point) {
        let step = self.points.last().map_or(0.0, |last| (point - last).norm());
        if self.points.is_empty() || step > 1e-3 {
            self.along.push(self.length_m() + step);
            self.points.push(point);
        }
    }

    /// Its points.
    #[must_use]
    pub fn points(&self) -> &[Point] {
        &self.points
    }

    /// Length along it at each point, m.
    #[must_use]
    pub fn marks_m(&self) -> &[f64] {
        &self.along
    }

    /// Whole length, m; 0 for a single point or none.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.along.last().copied().unwrap_or(0.0)
    }

    /// Last point.
    #[must_use]
    pub fn end(&self) -> Option<Point> {
        self.points.last().copied()
    }

    /// The leg that holds the length `s`: its ends and the lengths at them.
    fn leg(&self, s: f64) -> Option<(Point, Point, f64, f64)> {
        let place = self.along.partition_point(|mark| *mark <= s).clamp(1, self.points.len().max(2) - 1);
        Some((
            *self.points.get(place - 1)?,
            *self.points.get(place)?,
            *self.along.get(place - 1)?,
            *self.along.get(place)?,
        ))
    }

    /// The point at length `s`, clamped to the ends; the origin for an empty way.
    #[must_use]
    pub fn point(&self, s: f64) -> Point {
        match self.leg(s) {
            Some((from, to, s0, s1)) => from + (to - from) * ((s - s0) / (s1 - s0)).clamp(0.0, 1.0),
            None => self.points.first().copied().unwrap_or_else(Point::origin),
        }
    }

    /// Unit direction at length `s`; zero for a single point.
    #[must_use]
    pub fn direction(&self, s: f64) -> Vector {
        self.leg(s).map_or_else(Vector::zeros, |(from, to, s0, s1)| (to - from) / (s1 - s0))
    }

    /// Length along the way of the point nearest to `point`, and the distance to it.
    #[must_use]
    pub fn project(&self, point: &Point) -> (f64, f64) {
        self.project_within(point, 0.0, self.length_m())
    }

    /// Lengths between `from` and `to` at which the way folds back along itself, m, in their order.
    pub fn folds_m(&self, from: f64, to: f64) -> impl Iterator<Item = f64> {
        let first = self.along.partition_point(|mark| *mark < from);
        let marks = self.along.iter().skip(first).copied().take_while(move |mark| *mark <= to);
        let inner = marks.filter(|mark| *mark > 0.0 && *mark < self.length_m());
        let turned = |mark: f64| self.direction(mark - Self::TURN_M).dot(&self.direction(mark + Self::TURN_M));
        inner.filter(move |mark| turned(*mark) < Self::FOLDED)
    }

    /// Progress along a way from `s`, and the distance off it, m: looked for between `back` behind and `ahead` of it. Before a fold of the
    /// way what lies behind the fold is not taken for it.
    #[must_use]
    pub fn progress(&self, point: &Point, s: f64, (back, ahead): (f64, f64)) -> (f64, f64) {
        let (mut from, mut to) = (s - back, s + ahead);
        for fold in self.folds_m(from, to + Self::TURN_M) {
            if s < fold - Self::TURN_M {
                to = to.min(fold);
            } else {
                from = from.max(fold - Self::TURN_M);
            }
        }
        self.project_within(point, from, to)
    }

    /// Distance before and after a fold at which the directions are compared, and within which both sides of it count, m.
    const TURN_M: f64 = 0.4;
    /// Cosine of the angle between the two directions below which it is a fold.
    const FOLDED: f64 = -0.9;

    /// As [`Polyline::project`], but only between the lengths `from` and `to`: a way that comes back to
    /// itself is not cut short.
    #[must_use]
    pub fn project_within(&self, point: &Point, from: f64, to: f64) -> (f64, f64) {
        let mut best = (from.clamp(0.0, self.length_m()), f64::INFINITY);
        // Marks only grow: what ends before `from` is left out at once, and nothing comes after `to`.
        let first = self.along.partition_point(|mark| *mark < from).saturating_sub(1);
        for (ends, marks) in self.points.windows(2).zip(self.along.windows(2)).skip(first) {
            let ([a, b], [s0, s1]) = (ends, marks) else { continue };
            if *s0 > to {
                break;
            }
            if *s1 < from {
                continue;
            }
            let (_, nearest) = nearest_on_segment(point, a, b);
            let s = (s0 + (nearest - a).norm()).clamp(from, to);
            let distance = (point - (a + (b - a) * ((s - s0) / (s1 - s0)))).norm();
            if distance < best.1 - 1e-9 {
                best = (s, distance);
            }
        }
        if best.1.is_infinite() {
            best.1 = (point - self.point(best.0)).norm();
        }
        best
    }

    /// Distance of a point to the left of the way at length `s` (negative: to the right), m.
    #[must_use]
    pub fn lateral_m(&self, point: &Point, s: f64) -> f64 {
        self.direction(s).perp(&(point - self.point(s)))
    }

    /// The rest of the way from length `s` on.
    #[must_use]
    pub fn from(&self, s: f64) -> Self {
        let mut rest = Self::new(&[self.point(s)]);
        for (point, mark) in self.points.iter().zip(&self.along) {
            if *mark > s {
                rest.push(*point);
            }
        }
        rest
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corner() -> Polyline {
        Polyline::new(&[Point::new(0., 0.), Point::new(4., 0.), Point::new(4., 0.), Point::new(4., 3.)])
    }

    #[test]
    fn lengths_points_and_directions_follow_the_corner() {
        let way = corner();
        assert!((way.length_m() - 7.0).abs() < 1e-12);
        assert!((way.point(5.0) - Point::new(4., 1.)).norm() < 1e-12);
        assert!((way.direction(6.0) - Vector::new(0., 1.)).norm() < 1e-12);
        assert!((way.point(99.0) - Point::new(4., 3.)).norm() < 1e-12);
        assert!((way.from(5.0).length_m() - 2.0).abs() < 1e-12);
    }

    #[test]
    fn a_point_is_projected_within_the_window_only() {
        let (s, distance) = corner().project(&Point::new(2., 1.));
        assert!((s - 2.0).abs() < 1e-12 && (distance - 1.0).abs() < 1e-12);
        let (s, _) = corner().project_within(&Point::new(2., 1.), 4.5, 6.0);
        assert!((4.5..=6.0).contains(&s));
        assert!(corner().lateral_m(&Point::new(2., 1.), 2.0) > 0.99);
    }

    #[test]
    fn a_way_there_and_back_is_walked_once_in_each_direction() {
        let points = [(0., 0.), (6., 0.), (6., 3.), (6., 0.), (0., 0.)].map(|(x, y)| Point::new(x, y));
        let way = Polyline::new(&points);
        let folds = |way: &Polyline| way.folds_m(0.0, way.length_m()).collect::<Vec<_>>();
        assert_eq!((folds(&way), folds(&corner())), (vec![9.0], vec![]));
        // One meter before the turn, and one meter behind it, the place is the same.
        let at = Point::new(6., 2.);
        assert!((way.progress(&at, 7.5, (0.3, 3.0)).0 - 8.0).abs() < 1e-12);
        assert!((way.progress(&at, 9.2, (0.3, 3.0)).0 - 10.0).abs() < 1e-12);
        let start = Point::new(0.1, 0.);
        assert!((way.progress(&start, 0.0, (0.3, 30.0)).0 - 0.1).abs() < 1e-12);
    }

    #[test]
    fn a_way_with_two_dead_ends_folds_twice_and_no_fold_is_skipped() {
        let points = [(0., 0.), (2., 0.), (2., 1.), (2., 0.), (4., 0.), (4., 1.), (4., 0.), (6., 0.)];
        let way = Polyline::new(&points.map(|(x, y)| Point::new(x, y)));
        assert_eq!(way.folds_m(0.0, way.length_m()).collect::<Vec<_>>(), [3.0, 7.0]);
        // The mouth of the first dead end is level with 2 m and with 4 m: who has not been in it is at the former.
        let mouth = Point::new(2., 0.1);
        assert!(way.progress(&mouth, 1.9, (0.3, 3.0)).0 <= 2.11);
        assert!((way.progress(&mouth, 3.7, (0.3, 3.0)).0 - 3.9).abs() < 1e-9);
        assert!(way.progress(&Point::new(4., 0.9), 6.8, (0.3, 3.0)).0 <= 7.11);
    }

    #[test]
    fn a_single_point_has_no_length_and_no_direction() {
        let spot = Polyline::new(&[Point::new(1., 2.)]);
        assert!(spot.length_m().abs() < 1e-12 && spot.direction(0.0).norm() < 1e-12);
        assert!((spot.project(&Point::new(1., 5.)).1 - 3.0).abs() < 1e-12);
    }
}
