//! The social map of Nav2CAN (Schwoerer and Schmidt 2023): zones round a person.

use socrates_model::{Point, SeenPerson, Vector};

use super::grid::{Bounds, Costmap, MOST};
use super::layered::{Layer, Sensed};
use super::lobe::{Fall, Height};
use super::people::{Kept, cost_of, raise};

/// Parameters of the layer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nav2CanParams {
    /// Cost of the innermost zone; Nav2CAN has no default, ours is 252, at which a robot may still pass.
    pub maxcost: u8,
    /// Spread ahead of a person, m; default 2.
    pub sigma_front: f64,
    /// Spread to their sides, m; default 4/3.
    pub sigma_side: f64,
    /// Spread behind them, m; default 1.
    pub sigma_back: f64,
    /// The social map ends so far from the robot along x and y, m; default 7.5.
    pub half_size: f64,
}

impl Default for Nav2CanParams {
    fn default() -> Self {
        Self { maxcost: MOST, sigma_front: 2.0, sigma_side: 4.0 / 3.0, sigma_back: 1.0, half_size: 7.5 }
    }
}

/// The zones end so far to the side of a person, m.
const ZONES_M: [f64; 3] = [0.5, 1.0, 1.5];

impl Nav2CanParams {
    /// Exponent of the person's Gaussian so far to their side, m.
    fn at_side(&self, side_m: f64) -> f64 {
        side_m * side_m / (2.0 * self.sigma_side * self.sigma_side)
    }

    /// Cost at an offset from a person, m; 0 outside their zones. With g the value of a Gaussian whose spread along their heading
    /// is `sigma_front` or `sigma_back` and across it `sigma_side`: `maxcost` where g is above its value 0.5 m to the side, the
    /// value 1 m to the side times `maxcost` up to there, g times `maxcost` up to 1.5 m, all cut to whole numbers.
    #[must_use]
    pub fn cost(&self, person: &SeenPerson, offset: &Vector) -> u8 {
        let zones = ZONES_M.map(|side_m| self.at_side(side_m));
        let power = |exponent: f64| cost_of(libm::exp(-exponent) * f64::from(self.maxcost));
        self.zone(offset, (libm::sin(person.yaw), libm::cos(person.yaw)), zones, power)
    }

    fn zone(
        &self,
        offset: &Vector,
        (sin, cos): (f64, f64),
        [inner, middle, outer]: [f64; 3],
        power: impl Fn(f64) -> u8,
    ) -> u8 {
        let (x, y) = (offset.x * cos + offset.y * sin, offset.y * cos - offset.x * sin);
        let halved = |sigma: f64| 0.5 / (sigma * sigma);
        let along = if x > 0.0 { halved(self.sigma_front) } else { halved(self.sigma_back) };
        let exponent = x * x * along + y * y * halved(self.sigma_side);
        if exponent < inner {
            self.maxcost
        } else if exponent < middle {
            power(middle)
        } else if exponent < outer {
            power(exponent)
        } else {
            0
        }
    }

    fn reach_m(&self) -> f64 {
        let [_, _, outer_m] = ZONES_M;
        outer_m * self.sigma_front.max(self.sigma_side).max(self.sigma_back) / self.sigma_side
    }
}

/// The layer.
#[derive(Debug)]
pub struct Nav2CanLayer {
    params: Nav2CanParams,
    kept: Kept,
    fall: Fall,
}

impl Nav2CanLayer {
    /// The layer.
    #[must_use]
    pub fn new(params: &Nav2CanParams) -> Self {
        let height = Height { amplitude: f64::from(params.maxcost), cutoff: 1.0 };
        Self { params: *params, kept: Kept::new(0.0), fall: Fall::new(height) }
    }

    /// The cells of the social map, round the robot.
    fn window(&self, map: &Costmap, at: &Point) -> Bounds {
        map.square(at, self.params.half_size)
    }
}

impl Layer for Nav2CanLayer {
    fn look(&mut self, map: &Costmap, sensed: &Sensed<'_>, bounds: &mut Bounds) {
        self.kept.see(sensed);
        let window = self.window(map, &sensed.pose.point());
        let mut now = Bounds::EMPTY;
        for person in self.kept.people() {
            now.join(&map.square(&person.at, self.params.reach_m()).meet(&window));
        }
        self.kept.widen(now, bounds);
    }

    fn write(&mut self, map: &mut Costmap, bounds: &Bounds, sensed: &Sensed<'_>) {
        let here = self.window(map, &sensed.pose.point()).meet(bounds);
        let zones = ZONES_M.map(|side_m| self.params.at_side(side_m));
        let power = |exponent: f64| self.fall.cost(exponent).unwrap_or(0);
        for person in self.kept.people() {
            let heading = (libm::sin(person.yaw), libm::cos(person.yaw));
            let cost = |offset: &Vector| Some(self.params.zone(offset, heading, zones, power)).filter(|cost| *cost > 0);
            let zones = map.square(&person.at, self.params.reach_m()).meet(&here);
            raise(map, &zones, &person.at, cost);
        }
    }

    fn roll(&mut self, _columns: isize, _rows: isize) {
        self.kept.roll();
    }

    fn clear(&mut self) {
        self.kept.clear();
    }
}
