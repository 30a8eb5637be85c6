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
    axis: Vector,
    /// Variances along and across the axis, m².
    variances: (f64, f64),
    /// Halves of their inverses, 1/m²: a division takes as long as all the rest of an exponent.
    falls: (f64, f64),
    half: Half,
}

/// Height of a lobe's middle, and below which height it ends.
#[derive(Debug, Clone, Copy)]
pub(super) struct Height {
    pub(super) amplitude: f64,
    pub(super) cutoff: f64,
}

impl Height {
    /// The exponent at which a lobe ends: amplitude e^-x = cutoff. Below 0 where none of it is above.
    fn end(self) -> f64 {
        // A cost below 1 is none.
        let cutoff = self.cutoff.max(1.0);
        if self.amplitude < cutoff { -1.0 } else { libm::log(self.amplitude / cutoff) }
    }

    /// Cost where a Gaussian has this exponent; `None` below the cutoff.
    fn cost(self, exponent: f64) -> Option<u8> {
        let value = self.amplitude * libm::exp(-exponent);
        (value >= self.cutoff).then(|| cost_of(value))
    }
}

/// Costs by exponents, looked up: a power takes ten times as long.
#[derive(Debug)]
pub(super) struct Fall {
    height: Height,
    end: f64,
    /// For each cost the largest exponent that has it.
    last: Vec<f64>,
    /// Cost where each of equal steps of the exponent begins.
    begins: Vec<u8>,
    steps_per_one: f64,
}

impl Fall {
    pub(super) fn new(height: Height) -> Self {
        /// Steps so short that a cost hardly falls by one in each.
        const STEPS: usize = 4096;
        let end = height.end();
        let last = (0..=255_u8).map(|cost| libm::log(height.amplitude / f64::from(cost.max(1))));
        let step = end.max(0.0) / STEPS as f64;
        let begins = (0..=STEPS).map(|count| cost_of(height.amplitude * libm::exp(-(count as f64 * step))));
        let steps_per_one = if end > 0.0 { STEPS as f64 / end } else { 0.0 };
        Self { height, end, last: last.collect(), begins: begins.collect(), steps_per_one }
    }

    /// Cost where a Gaussian has this exponent; `None` below the cutoff.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and the number of steps")]
    pub(super) fn cost(&self, exponent: f64) -> Option<u8> {
        if exponent > self.end {
            return None;
        }
        let mut cost = self.begins.get((exponent * self.steps_per_one) as usize).copied()?;
        while cost > 1 && self.last.get(usize::from(cost)).is_some_and(|last| exponent > *last) {
            cost -= 1;
        }
        Some(cost)
    }

    pub(super) const fn height(&self) -> Height {
        self.height
    }
}

impl Lobe {
    /// A lobe along a unit vector, with the variances along and across it, m².
    pub(super) fn new(axis: Vector, variances: (f64, f64), half: Half) -> Self {
        Self { axis, variances, falls: (0.5 / variances.0, 0.5 / variances.1), half }
    }

    /// How far the lobe reaches along a unit vector, m.
    fn reach_m(&self, towards: &Vector, height: Height) -> f64 {
        let (along, across) = self.variances;
        let (on, off) = (towards.dot(&self.axis), towards.perp(&self.axis));
        let away = match self.half {
            Half::Both => false,
            Half::Front => on < 0.0,
            Half::Rear => on > 0.0,
        };
        // Away from its side a half ends at the line through its middle.
        let square = if away { across * off * off } else { along * on * on + across * off * off };
        libm::sqrt(2.0 * height.end().max(0.0) * square)
    }

    /// The exponent at an offset from the middle, m; infinite on the half that does not count.
    fn exponent(&self, offset: &Vector) -> f64 {
        let (x, y) = (offset.dot(&self.axis), self.axis.perp(offset));
        let counts = match self.half {
            Half::Both => true,
            Half::Front => x > 0.0,
            Half::Rear => x <= 0.0,
        };
        let (along, across) = self.falls;
        if counts { x * x * along + y * y * across } else { f64::INFINITY }
    }

    /// Cost at an offset from the middle, m; `None` below the cutoff.
    pub(super) fn cost(&self, height: Height, offset: &Vector) -> Option<u8> {
        height.cost(self.exponent(offset))
    }

    /// The cells that the lobe may raise.
    pub(super) fn bounds(&self, map: &Costmap, center: &Point, height: Height) -> Bounds {
        let reach = |x: f64, y: f64| self.reach_m(&Vector::new(x, y), height);
        let least = center - Vector::new(reach(-1.0, 0.0), reach(0.0, -1.0));
        let most = center + Vector::new(reach(1.0, 0.0), reach(0.0, 1.0));
        map.rectangle(&least, &most)
    }

    /// Raises the cells under the lobe.
    pub(super) fn raise(&self, map: &mut Costmap, bounds: &Bounds, center: &Point, fall: &Fall) {
        let here = self.bounds(map, center, fall.height()).meet(bounds);
        raise(map, &here, center, |offset| fall.cost(self.exponent(offset)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cost_looked_up_is_the_cost_reckoned() {
        for (amplitude, cutoff) in [(252.0, 10.0), (77.0, 10.0), (252.0, 0.0), (30.5, 5.0), (9.0, 10.0), (400.0, 3.0)] {
            let height = Height { amplitude, cutoff };
            let fall = Fall::new(height);
            for step in 0..80_000 {
                // Irrational steps, so that none is at the very edge of a cost.
                let exponent = f64::from(step) * 1e-4 * std::f64::consts::FRAC_1_SQRT_2;
                let reckoned = height.cost(exponent).filter(|cost| *cost > 0);
                assert_eq!(fall.cost(exponent), reckoned, "{amplitude}, {cutoff}: at {exponent}");
            }
        }
    }
}
