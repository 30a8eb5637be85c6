//! The convex hull of a few points.

use socrates_model::Point;
use socrates_model::geometry::nearest_on_segment;

/// Corners of the convex hull, counter-clockwise, by the monotone chain (Andrew 1979). Of points on one line its ends.
pub(crate) fn convex_hull(mut points: Vec<Point>) -> Vec<Point> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    if points.len() < 3 {
        return points;
    }
    let half = |points: &mut dyn Iterator<Item = &Point>| {
        let mut chain: Vec<Point> = Vec::new();
        for point in points {
            while let [.., a, b] = chain.as_slice()
                && (b - a).perp(&(point - a)) <= 0.0
            {
                chain.pop();
            }
            chain.push(*point);
        }
        chain.pop();
        chain
    };
    let mut hull = half(&mut points.iter());
    hull.extend(half(&mut points.iter().rev()));
    hull
}

/// Distance of a point from a convex hull, m; 0 inside.
pub(crate) fn outside_hull_m(hull: &[Point], at: &Point) -> f64 {
    let sides = || hull.iter().zip(hull.iter().cycle().skip(1));
    if hull.len() > 2 && sides().all(|(a, b)| (b - a).perp(&(at - a)) >= 0.0) {
        return 0.0;
    }
    sides().map(|(a, b)| nearest_on_segment(at, a, b).0).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_with_a_point_inside_has_four_corners() {
        let points = [(0., 0.), (2., 0.), (1., 1.), (2., 2.), (0., 2.), (1., 0.)].map(|(x, y)| Point::new(x, y));
        let hull = convex_hull(points.to_vec());
        assert_eq!(hull.len(), 4);
        for (x, y, wanted) in [(1., 1.5, 0.), (3., 1., 1.), (3., 3., 2.0_f64.sqrt()), (1., -0.5, 0.5)] {
            assert!((outside_hull_m(&hull, &Point::new(x, y)) - wanted).abs() < 1e-12, "{x} {y}");
        }
        let line = convex_hull([(0., 0.), (1., 0.), (3., 0.)].map(|(x, y)| Point::new(x, y)).to_vec());
        assert!((outside_hull_m(&line, &Point::new(1., 2.)) - 2.0).abs() < 1e-12);
        assert!((outside_hull_m(&line, &Point::new(5., 0.)) - 2.0).abs() < 1e-12);
    }
}
