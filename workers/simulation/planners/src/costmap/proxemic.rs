//! The proxemic and the passing layer of Lu, Hershberger and Smart, "Layered costmaps for context-sensitive navigation" (2014).

use socrates_model::{SeenPerson, Vector};

use super::grid::{Bounds, Costmap};
use super::layered::{Layer, Sensed};
use super::lobe::{Fall, Half, Height, Lobe};
use super::people::Kept;

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

/// Unit vector of a person's walk, along x if they stand.
pub(super) fn walk(velocity: &Vector) -> Vector {
    let speed = velocity.norm();
    if speed > 0.0 { velocity / speed } else { Vector::new(1.0, 0.0) }
}

/// A vector turned counter-clockwise, rad.
pub(super) fn turned(vector: &Vector, angle: f64) -> Vector {
    let (sin, cos) = (libm::sin(angle), libm::cos(angle));
    Vector::new(vector.x * cos - vector.y * sin, vector.x * sin + vector.y * cos)
}

impl ProxemicParams {
    /// Cost at an offset from a person, m: `amplitude` e^-(x²/2vx + y²/2vy) with x along their walk, vy = `covariance`, and
    /// vx = `covariance` (1 + `factor` v) in front, `covariance` behind; `None` below the cutoff.
    #[must_use]
    pub fn cost(&self, person: &SeenPerson, offset: &Vector) -> Option<u8> {
        self.lobes(person).flatten().filter_map(|lobe| lobe.cost(self.height(), offset)).max()
    }

    const fn height(&self) -> Height {
        Height { amplitude: self.amplitude, cutoff: self.cutoff }
    }

    fn lobes(&self, person: &SeenPerson) -> impl Iterator<Item = Option<Lobe>> + use<> {
        let long = self.covariance * (1.0 + self.factor * person.velocity.norm());
        let ahead = walk(&person.velocity);
        let axis = if self.passing { turned(&-ahead, SIDE_RAD) } else { ahead };
        let front = Lobe::new(axis, (long, self.covariance), Half::Front);
        let rear = Lobe::new(axis, (self.covariance, self.covariance), Half::Rear);
        [Some(front), (!self.passing).then_some(rear)].into_iter()
    }
}

/// The proxemic layer.
#[derive(Debug)]
pub struct ProxemicLayer {
    params: ProxemicParams,
    kept: Kept,
    fall: Fall,
}

impl ProxemicLayer {
    /// The layer.
    #[must_use]
    pub fn new(params: &ProxemicParams) -> Self {
        Self { params: *params, kept: Kept::new(params.keep_time), fall: Fall::new(params.height()) }
    }
}

impl Layer for ProxemicLayer {
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
