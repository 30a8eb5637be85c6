//! The allowed velocity nearest to a wish: linear programs in two and three dimensions.
//!
//! Incremental, in the given order of half-planes (de Berg et al., "Computational Geometry", chapter 4):
//! the best point so far stays unless the next half-plane forbids it, and then the best lies on its edge.

use nalgebra::Vector2;

use crate::vector::{dot, left, norm};

/// Edges with a smaller sine between them count as parallel.
const PARALLEL: f64 = 1e-9;

/// Velocities on one side of a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct HalfPlane {
    /// A velocity on the edge.
    point: Vector2<f64>,
    /// Unit vector into the allowed side.
    normal: Vector2<f64>,
}

/// What is looked for.
#[derive(Debug, Clone, Copy)]
enum Aim {
    /// Nearest to a velocity.
    Near(Vector2<f64>),
    /// Farthest in a direction.
    Along(Vector2<f64>),
}

impl HalfPlane {
    /// The side of the line through `point` into which the unit vector `normal` points.
    pub(super) fn new(point: Vector2<f64>, normal: Vector2<f64>) -> Self {
        Self { point, normal }
    }

    /// How far a velocity is beyond the edge; negative on the allowed side.
    fn violation(&self, velocity: &Vector2<f64>) -> f64 {
        dot(&self.normal, &(self.point - velocity))
    }

    /// Along the edge, with the allowed side to the left.
    fn direction(&self) -> Vector2<f64> {
        -left(&self.normal)
    }
}

/// The velocity nearest to `wish` that is no faster than `most_mps` and allowed by all planes; where no
/// velocity is, one that violates the planes after the first `n_firm` as little as can be.
///
/// `projected` is room for planes; what it holds means nothing.
pub(super) fn solve(
    planes: &[HalfPlane],
    n_firm: usize,
    most_mps: f64,
    wish: &Vector2<f64>,
    projected: &mut Vec<HalfPlane>,
) -> Vector2<f64> {
    let speed = norm(wish);
    let start = if speed > most_mps { wish * (most_mps / speed) } else { *wish };
    match within(planes, most_mps, Aim::Near(*wish), start) {
        Ok(velocity) => velocity,
        Err((failed, velocity)) => least_violation(planes, n_firm, (failed, velocity), most_mps, projected),
    }
}

/// The best velocity in all planes and the circle; else the number of the first plane that leaves none,
/// and the best velocity in those before it.
fn within(
    planes: &[HalfPlane],
    radius: f64,
    aim: Aim,
    start: Vector2<f64>,
) -> Result<Vector2<f64>, (usize, Vector2<f64>)> {
    let mut best = start;
    for (number, plane) in planes.iter().enumerate() {
        if plane.violation(&best) > 0.0 {
            let before = planes.get(..number).unwrap_or_default();
            best = on_edge(plane, before, radius, aim).ok_or((number, best))?;
        }
    }
    Ok(best)
}

/// The best velocity on the edge of `plane`, in the circle and in all planes before it.
fn on_edge(plane: &HalfPlane, before: &[HalfPlane], radius: f64, aim: Aim) -> Option<Vector2<f64>> {
    let direction = plane.direction();
    let middle = dot(&plane.point, &direction);
    let inside = middle * middle + radius * radius - dot(&plane.point, &plane.point);
    if inside < 0.0 {
        return None;
    }
    let (mut low, mut high) = (-middle - inside.sqrt(), -middle + inside.sqrt());
    for other in before {
        let slope = dot(&other.normal, &direction);
        let lacking = other.violation(&plane.point);
        if slope.abs() <= PARALLEL {
            if lacking > 0.0 {
                return None;
            }
        } else if slope > 0.0 {
            low = low.max(lacking / slope);
        } else {
            high = high.min(lacking / slope);
        }
        if low > high {
            return None;
        }
    }
    let at = match aim {
        Aim::Near(wish) => dot(&direction, &(wish - plane.point)).clamp(low, high),
        Aim::Along(way) => {
            if dot(&way, &direction) > 0.0 {
                high
            } else {
                low
            }
        }
    };
    Some(plane.point + direction * at)
}

/// The velocity whose largest violation of the planes from `failed` on is smallest, with the firm planes
/// kept: a program in velocity and violation, worked out plane by plane.
fn least_violation(
    planes: &[HalfPlane],
    n_firm: usize,
    (failed, start): (usize, Vector2<f64>),
    radius: f64,
    projected: &mut Vec<HalfPlane>,
) -> Vector2<f64> {
    let (mut best, mut largest) = (start, 0.0);
    for (number, plane) in planes.iter().enumerate().skip(failed) {
        if plane.violation(&best) <= largest {
            continue;
        }
        // Where this plane is violated as much as an earlier one.
        projected.clear();
        projected.extend(planes.iter().take(n_firm.min(number)));
        for other in planes.iter().take(number).skip(n_firm) {
            let sine = plane.normal.x * other.normal.y - plane.normal.y * other.normal.x;
            let point = if sine.abs() <= PARALLEL {
                if dot(&plane.normal, &other.normal) > 0.0 {
                    continue;
                }
                (plane.point + other.point) * 0.5
            } else {
                let direction = plane.direction();
                plane.point + direction * (other.violation(&plane.point) / dot(&other.normal, &direction))
            };
            let between = other.normal - plane.normal;
            projected.push(HalfPlane::new(point, between / norm(&between)));
        }
        // By rounding alone there may be none: then the present one is as good as any.
        let aim = Aim::Along(plane.normal);
        if let Ok(velocity) = within(projected, radius, aim, plane.normal * radius) {
            best = velocity;
        }
        largest = plane.violation(&best);
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cross::SplitMix64;

    fn plane(x: f64, y: f64, angle: f64) -> HalfPlane {
        HalfPlane::new(Vector2::new(x, y), Vector2::new(libm::cos(angle), libm::sin(angle)))
    }

    /// The best velocity of a fine grid over the circle.
    fn by_trial(radius: f64, worth: impl Fn(&Vector2<f64>) -> f64) -> f64 {
        let steps = 400;
        let places = (0..=steps).flat_map(|i| (0..=steps).map(move |j| (i, j)));
        places
            .map(|(i, j)| Vector2::new(f64::from(i), f64::from(j)) * (2.0 * radius / f64::from(steps)))
            .map(|place| place - Vector2::new(radius, radius))
            .filter(|place| norm(place) <= radius)
            .fold(f64::INFINITY, |best, place| best.min(worth(&place)))
    }

    #[test]
    fn the_answer_is_as_good_as_the_best_of_a_grid() {
        let mut random = SplitMix64::new(11);
        let (mut easy, mut hard) = (0, 0);
        for _ in 0..60 {
            let mut number = |low: f64, high: f64| low + (high - low) * random.next_f64();
            let planes: Vec<HalfPlane> =
                (0..6).map(|_| plane(number(-0.8, 0.8), number(-0.8, 0.8), number(-3.2, 3.2))).collect();
            let wish = Vector2::new(number(-1.0, 1.0), number(-1.0, 1.0));
            let found = solve(&planes, 0, 1.2, &wish, &mut Vec::new());
            assert!(norm(&found) <= 1.2 + 1e-9);
            let violation = |velocity: &Vector2<f64>| {
                planes.iter().fold(0.0_f64, |worst, plane| worst.max(plane.violation(velocity)))
            };
            let least = by_trial(1.2, violation);
            if violation(&found) <= 1e-9 {
                easy += 1;
                let nearest = by_trial(1.2, |place| if violation(place) > 0.0 { 9.0 } else { norm(&(place - wish)) });
                assert!(norm(&(found - wish)) <= nearest + 1e-9);
            } else {
                hard += 1;
                assert!(violation(&found) <= least + 1e-9, "{} {least}", violation(&found));
            }
        }
        assert!(easy > 5 && hard > 5, "{easy} {hard}");
    }

    #[test]
    fn firm_planes_are_kept_when_the_others_cannot_be() {
        let planes = [plane(0.0, 0.0, 0.0), plane(-0.5, 0.0, std::f64::consts::PI), plane(0.2, 0.0, 0.0)];
        let found = solve(&planes, 1, 1.0, &Vector2::new(-1.0, 0.0), &mut Vec::new());
        assert!(found.x >= -1e-9, "{found}");
    }
}
