//! The proxemic and the passing layer of Lu, Hershberger and Smart, "Layered costmaps for context-sensitive navigation" (2014).

use std::f64::consts::PI;

use socrates_model::{SeenPerson, Vector};

use super::grid::{Bounds, Costmap};
use super::layered::{Layer, Sensed};
use super::people::{Kept, cost_of, raise};

/// Turn from the way a person comes from to the axis of the passing layer, rad: their right-hand side.
const SIDE_RAD: f64 = 1.51;

/// Parameters of the proxemic layer; defaults are those of `social_navigation_layers`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProxemicParams {
    /// Costs below this are left out; default 10.
    pub cutoff: f64,
    /// Cost in the middle; default 77.
    pub amplitude: f64,
    /// Variance, m²; default 0.25.
    pub covariance: f64,
    /// How much longer the front half is, for each m/s of the person's speed; default 5.
    pub factor: f64,
    /// So long somebody no longer seen is kept, s; default 0.75.
    pub keep_time: f64,
    /// Whether only the right-hand side of a person is dear, so that the robot passes on their left; default false.
    pub passing: bool,
}

impl Default for ProxemicParams {
    fn default() -> Self {
        Self { cutoff: 10.0, amplitude: 77.0, covariance: 0.25, factor: 5.0, keep_time: 0.75, passing: false }
    }
}

/// Distance at which a Gaussian of this variance falls to the cutoff, m.
pub(super) fn reach_m(amplitude: f64, cutoff: f64, variance: f64) -> f64 {
    if cutoff <= 0.0 || amplitude <= cutoff {
        return 0.0;
    }
    libm::sqrt(-2.0 * variance * libm::log(cutoff / amplitude))
}

/// Unit vector of a person's walk, along x if they stand.
pub(super) fn walk(velocity: &Vector) -> Vector {
    let speed = velocity.norm();
    if speed > 0.0 { velocity / speed } else { Vector::new(1.0, 0.0) }
}

/// Value at an offset of a Gaussian with these variances along and across an axis, 1 in the middle.
pub(super) fn gauss(offset: &Vector, axis: &Vector, (along, across): (f64, f64)) -> f64 {
    let (x, y) = (offset.dot(axis), axis.perp(offset));
    libm::exp(-(x * x / (2.0 * along) + y * y / (2.0 * across)))
}

impl ProxemicParams {
    /// Cost at an offset from a person, m: `amplitude` e^-(x²/2vx + y²/2vy) with x along their walk, vy = `covariance`, and
    /// vx = `covariance` (1 + `factor` v) in front, `covariance` behind; `None` below the cutoff.
    #[must_use]
    pub fn cost(&self, person: &SeenPerson, offset: &Vector) -> Option<u8> {
        let long = self.covariance * (1.0 + self.factor * person.velocity.norm());
        let ahead = walk(&person.velocity);
        let axis = if self.passing { turned(&-ahead, SIDE_RAD) } else { ahead };
        let front = offset.dot(&axis) > 0.0;
        if self.passing && !front {
            return None;
        }
        let along = if front { long } else { self.covariance };
        let value = self.amplitude * gauss(offset, &axis, (along, self.covariance));
        (value >= self.cutoff).then(|| cost_of(value))
    }

    fn reach_m(&self, person: &SeenPerson) -> f64 {
        let long = self.covariance * (1.0 + self.factor * person.velocity.norm());
        reach_m(self.amplitude, self.cutoff, long.max(self.covariance))
    }
}

/// A vector turned counter-clockwise, rad.
pub(super) fn turned(vector: &Vector, angle: f64) -> Vector {
    debug_assert!(angle.abs() <= PI, "a turn of at most half a circle");
    let (sin, cos) = (libm::sin(angle), libm::cos(angle));
    Vector::new(vector.x * cos - vector.y * sin, vector.x * sin + vector.y * cos)
}

/// The proxemic layer.
#[derive(Debug)]
pub struct ProxemicLayer {
    params: ProxemicParams,
    kept: Kept,
}

impl ProxemicLayer {
    /// The layer.
    #[must_use]
    pub fn new(params: &ProxemicParams) -> Self {
        Self { params: *params, kept: Kept::new(params.keep_time) }
    }
}

impl Layer for ProxemicLayer {
    fn look(&mut self, map: &Costmap, sensed: &Sensed<'_>, bounds: &mut Bounds) {
        self.kept.see(sensed);
        let mut now = Bounds::EMPTY;
        for person in self.kept.people() {
            now.join(&map.square(&person.at, self.params.reach_m(person)));
        }
        self.kept.widen(now, bounds);
    }

    fn write(&mut self, map: &mut Costmap, bounds: &Bounds, _sensed: &Sensed<'_>) {
        for person in self.kept.people() {
            let reach_m = self.params.reach_m(person);
            raise(map, bounds, (&person.at, reach_m), |offset| self.params.cost(person, offset));
        }
    }

    fn roll(&mut self, _columns: isize, _rows: isize) {
        self.kept.roll();
    }

    fn clear(&mut self) {
        self.kept.clear();
    }
}
