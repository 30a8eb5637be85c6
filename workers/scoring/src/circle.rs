//! The spaces of people who stand together (Kendon 1990): the o-space between them, the p-space they stand in, the
//! r-space about them.

use socrates_model::{Point, Vector};

use crate::tracks::Sample;

/// Width of the p-space, m: where the members themselves stand.
pub(crate) const P_SPACE_M: f64 = 0.6;
/// Width of the r-space outside the p-space, m: Hall's personal distance, within which somebody still belongs.
pub(crate) const R_SPACE_M: f64 = 1.2;
/// Somebody faster than this does not stand, m/s.
pub(crate) const STANDING_MPS: f64 = 0.25;
/// Smallest o-space, m: of people who stand in each other's arms.
const LEAST_M: f64 = 0.1;

/// The circle of a standing group at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Circle {
    /// Middle of the o-space.
    pub(crate) center: Point,
    /// Radius of the o-space, m: it touches the members' discs.
    pub(crate) o_m: f64,
}

impl Circle {
    /// The circle of members who all stand; `None` when one walks or there are fewer than two.
    pub(crate) fn of(now: &[&Sample], radius_m: f64) -> Option<Self> {
        if now.len() < 2 || now.iter().any(|sample| sample.speed() > STANDING_MPS) {
            return None;
        }
        let center = o_center(now)?;
        let reach = now.iter().map(|sample| (sample.at - center).norm()).sum::<f64>() / count(now.len());
        Some(Self { center, o_m: (reach - radius_m).max(LEAST_M) })
    }

    /// How far a disc is outside the o-space, m; negative inside.
    pub(crate) fn outside_o(&self, at: &Point, radius_m: f64) -> f64 {
        (at - self.center).norm() - radius_m - self.o_m
    }

    /// How far a disc is outside the p-space, m; negative inside.
    pub(crate) fn outside_p(&self, at: &Point, radius_m: f64) -> f64 {
        self.outside_o(at, radius_m) - P_SPACE_M
    }

    /// How far a disc is outside the r-space, m; negative inside.
    pub(crate) fn outside_r(&self, at: &Point, radius_m: f64) -> f64 {
        self.outside_p(at, radius_m) - R_SPACE_M
    }
}

#[expect(clippy::cast_precision_loss, reason = "a group has few members")]
fn count(n: usize) -> f64 {
    n as f64
}

/// The point nearest to all lines of sight in the sense of least squares; the middle of the members
/// where the lines are nearly parallel or meet behind their backs.
fn o_center(now: &[&Sample]) -> Option<Point> {
    let first = now.first()?;
    let sum: Vector = now.iter().map(|sample| sample.at - first.at).sum();
    let middle = first.at + sum / count(now.len());
    // Sum of (I - d dᵀ), and of its product with the positions relative to the middle.
    let (mut xx, mut xy, mut yy, mut bx, mut by) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for sample in now {
        let d = sample.facing();
        let p = sample.at - middle;
        let (a, b, c) = (1.0 - d.x * d.x, -d.x * d.y, 1.0 - d.y * d.y);
        xx += a;
        xy += b;
        yy += c;
        bx += a * p.x + b * p.y;
        by += b * p.x + c * p.y;
    }
    let determinant = xx * yy - xy * xy;
    if determinant < 0.05 * count(now.len()) {
        return Some(middle);
    }
    let center = middle + Vector::new((yy * bx - xy * by) / determinant, (xx * by - xy * bx) / determinant);
    let spread = now.iter().map(|sample| (sample.at - middle).norm()).fold(0.0, f64::max);
    Some(if (center - middle).norm() <= spread { center } else { middle })
}
