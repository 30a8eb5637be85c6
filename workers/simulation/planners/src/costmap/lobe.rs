//! A Gaussian round a person, or one half of it: what social layers are made of.

use socrates_model::{Point, Vector};

use super::grid::{Bounds, Costmap};
use super::people::{cost_of, raise};

/// Which side of a lobe's middle counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Half {
    Both,
    /// Where the axis points to.
    Front,
    Rear,
}

/// A Gaussian along an axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lobe {
    /// Unit vector.
    pub(super) axis: Vector,
    /// Variances along and across the axis, m².
    pub(super) variances: (f64, f64),
    pub(super) half: Half,
}

/// Height of a lobe's middle, and below which height it ends.
#[derive(Debug, Clone, Copy)]
pub(super) struct Height {
    pub(super) amplitude: f64,
    pub(super) cutoff: f64,
}

impl Height {
    /// The exponent at which a lobe ends: amplitude e^-x = cutoff. Nothing is left of one that is not above its cutoff.
    fn end(self) -> f64 {
        // A cost below 1 is none.
        let cutoff = self.cutoff.max(1.0);
        if self.amplitude <= cutoff { 0.0 } else { libm::log(self.amplitude / cutoff) }
    }
}

impl Lobe {
    /// Half width and half height of the box along the map's axes that holds the lobe, m.
    pub(super) fn reach_m(&self, height: Height) -> (f64, f64) {
        let (along, across) = self.variances;
        let end = 2.0 * height.end();
        let reach = |on: f64, off: f64| libm::sqrt(end * (along * on * on + across * off * off));
        (reach(self.axis.x, self.axis.y), reach(self.axis.y, self.axis.x))
    }

    /// The exponent at an offset from the middle, m; infinite on the half that does not count.
    fn exponent(&self, offset: &Vector) -> f64 {
        let (x, y) = (offset.dot(&self.axis), self.axis.perp(offset));
        let counts = match self.half {
            Half::Both => true,
            Half::Front => x > 0.0,
            Half::Rear => x <= 0.0,
        };
        let (along, across) = self.variances;
        if counts { x * x / (2.0 * along) + y * y / (2.0 * across) } else { f64::INFINITY }
    }

    /// Cost at an offset from the middle, m; `None` below the cutoff.
    pub(super) fn cost(&self, height: Height, offset: &Vector) -> Option<u8> {
        self.cost_within(height, height.end(), offset)
    }

    fn cost_within(&self, height: Height, end: f64, offset: &Vector) -> Option<u8> {
        /// The last bit at the end is the power's own.
        const SLACK: f64 = 1e-9;
        let exponent = self.exponent(offset);
        // Far out nothing has to be raised to a power.
        if exponent > end + SLACK {
            return None;
        }
        let value = height.amplitude * libm::exp(-exponent);
        (value >= height.cutoff).then(|| cost_of(value))
    }

    /// The cells that the lobe may raise.
    pub(super) fn bounds(&self, map: &Costmap, center: &Point, height: Height) -> Bounds {
        map.rectangle(center, self.reach_m(height))
    }

    /// Raises the cells under the lobe.
    pub(super) fn raise(&self, map: &mut Costmap, bounds: &Bounds, center: &Point, height: Height) {
        let end = height.end();
        raise(map, bounds, (center, self.reach_m(height)), |offset| self.cost_within(height, end, offset));
    }
}
