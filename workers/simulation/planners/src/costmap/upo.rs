//! The social layer of the `nav2_social_costmap_plugin` of the UPO group.

use std::f64::consts::FRAC_PI_2;

use socrates_model::{SeenPerson, Vector};

use super::grid::{Bounds, Costmap, MOST};
use super::layered::{Layer, Sensed};
use super::lobe::{Fall, Half, Height, Lobe};
use super::people::Kept;
use super::proxemic::{turned, walk};

/// Somebody slower than this stands, m/s.
const STILL_MPS: f64 = 0.1;

/// Parameters of the layer; defaults are the plugin's, but for the amplitude: there it is 255, which makes the cell of a person
/// unknown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UpoSocialParams {
    /// Costs below this are left out; default 5.
    pub cutoff: f64,
    /// Cost in the middle; default 252. More than 252 becomes 252.
    pub amplitude: f64,
    /// Variance along the walk in front of somebody at no speed, m²; default 0.25, like every one below.
    pub covariance_front_height: f64,
    /// Variance across the walk in front, m².
    pub covariance_front_width: f64,
    /// Variance along the walk behind, m².
    pub covariance_rear_height: f64,
    /// Variance across the walk behind, m².
    pub covariance_rear_width: f64,
    /// Variance away from the walk on the right-hand side, m².
    pub covariance_right_height: f64,
    /// Variance along the walk on the right-hand side, m².
    pub covariance_right_width: f64,
    /// Variance round somebody who stands, m².
    pub covariance_when_still: f64,
    /// How much longer the front is, for each m/s; default 5.
    pub speed_factor_multiplier: f64,
    /// Whether the right-hand side is dear too, so that the robot passes on the left of people; default true.
    pub use_passing: bool,
    /// So long somebody no longer seen is kept, s; default 0.75.
    pub keep_time: f64,
}

impl Default for UpoSocialParams {
    fn default() -> Self {
        /// The plugin's one default for every variance, m².
        const VARIANCE_M2: f64 = 0.25;
        Self {
            cutoff: 5.0,
            amplitude: f64::from(MOST),
            covariance_front_height: VARIANCE_M2,
            covariance_front_width: VARIANCE_M2,
            covariance_rear_height: VARIANCE_M2,
            covariance_rear_width: VARIANCE_M2,
            covariance_right_height: VARIANCE_M2,
            covariance_right_width: VARIANCE_M2,
            covariance_when_still: VARIANCE_M2,
            speed_factor_multiplier: 5.0,
            use_passing: true,
            keep_time: 0.75,
        }
    }
}

impl UpoSocialParams {
    /// The example of the plugin's README.
    #[must_use]
    pub fn example() -> Self {
        Self {
            cutoff: 10.0,
            covariance_front_height: 0.4,
            covariance_right_height: 0.3,
            covariance_right_width: 0.2,
            ..Self::default()
        }
    }

    fn front(&self, speed_mps: f64) -> f64 {
        self.covariance_front_height * (1.0 + self.speed_factor_multiplier * speed_mps)
    }

    /// Cost at an offset from a person, m; `None` below the cutoff. Somebody who stands has one round Gaussian; somebody who
    /// walks has one in front, one behind, and with `use_passing` one to the right, of which the largest counts.
    #[must_use]
    pub fn cost(&self, person: &SeenPerson, offset: &Vector) -> Option<u8> {
        self.lobes(person).flatten().filter_map(|lobe| lobe.cost(self.height(), offset)).max()
    }

    const fn height(&self) -> Height {
        Height { amplitude: self.amplitude, cutoff: self.cutoff }
    }

    fn lobes(&self, person: &SeenPerson) -> impl Iterator<Item = Option<Lobe>> + use<> {
        let speed = person.velocity.norm();
        let axis = walk(&person.velocity);
        if speed < STILL_MPS {
            let variances = (self.covariance_when_still, self.covariance_when_still);
            return [Some(Lobe::new(axis, variances, Half::Both)), None, None].into_iter();
        }
        let front = (self.front(speed), self.covariance_front_width);
        let rear = (self.covariance_rear_height, self.covariance_rear_width);
        let right = (self.covariance_right_height, self.covariance_right_width);
        let side = Lobe::new(turned(&axis, -FRAC_PI_2), right, Half::Front);
        [
            Some(Lobe::new(axis, front, Half::Front)),
            Some(Lobe::new(axis, rear, Half::Rear)),
            self.use_passing.then_some(side),
        ]
        .into_iter()
    }
}

/// The layer.
#[derive(Debug)]
pub struct UpoSocialLayer {
    params: UpoSocialParams,
    kept: Kept,
    fall: Fall,
}

impl UpoSocialLayer {
    /// The layer.
    #[must_use]
    pub fn new(params: &UpoSocialParams) -> Self {
        Self { params: *params, kept: Kept::new(params.keep_time), fall: Fall::new(params.height()) }
    }
}

impl Layer for UpoSocialLayer {
    fn look(&mut self, map: &Costmap, sensed: &Sensed<'_>, bounds: &mut Bounds) {
        self.kept.see(sensed);
        let mut now = Bounds::EMPTY;
        for person in self.kept.people() {
            for lobe in self.params.lobes(person).flatten() {
                now.join(&lobe.bounds(map, &person.at, self.params.height()));
            }
        }
        self.kept.widen(now, bounds);
    }

    fn write(&mut self, map: &mut Costmap, bounds: &Bounds, _sensed: &Sensed<'_>) {
        for person in self.kept.people() {
            for lobe in self.params.lobes(person).flatten() {
                lobe.raise(map, bounds, &person.at, &self.fall);
            }
        }
    }

    fn roll(&mut self, _columns: isize, _rows: isize) {
        self.kept.roll();
    }

    fn clear(&mut self) {
        self.kept.clear();
    }
}
