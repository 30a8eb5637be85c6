//! What the tests of costmaps share.

use socrates_model::{Cell, Grid, HumanId, Point, Pose, SeenPerson, Vector};

use super::layered::{Scan, Sensed};

/// Numbers that look random, the same for the same seed.
pub(crate) struct Chance(u64);

impl Chance {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    pub(crate) fn next(&mut self) -> u64 {
        // xorshift64*
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 32
    }

    pub(crate) fn below(&mut self, end: u64) -> u64 {
        self.next() % end
    }

    /// Between 0 and 1.
    pub(crate) fn share(&mut self) -> f64 {
        self.next() as f64 / f64::from(u32::MAX)
    }
}

/// A floor without walls, 0.1 m a cell.
pub(crate) fn floor(width: usize, height: usize) -> Grid {
    let cells = vec![Cell::Free; width * height];
    Grid { width, height, resolution_m: 0.1, origin: Pose::new(0.0, 0.0, 0.0), cells }
}

pub(crate) fn person(id: u32, (x, y): (f64, f64), (vx, vy): (f64, f64), yaw: f64) -> SeenPerson {
    let id = HumanId::new(id);
    SeenPerson { id, at: Point::new(x, y), velocity: Vector::new(vx, vy), yaw, radius_m: 0.28, gesture: None }
}

/// What a robot of 0.22 m at a pose senses.
pub(crate) fn sensed<'a>(pose: Pose, scan: Option<&'a Scan>, people: &'a [SeenPerson]) -> Sensed<'a> {
    Sensed { now_s: 0.0, pose, radius_m: 0.22, footprint: &[], scan, people }
}

/// A scan of round bodies.
pub(crate) fn scan_of(from: Pose, discs: &[(Point, f64)], range_max_m: f64) -> Scan {
    let range = |beam: u32| {
        let angle = from.yaw + f64::from(beam).to_radians();
        let ahead = Vector::new(libm::cos(angle), libm::sin(angle));
        let hit = |(center, radius): &(Point, f64)| {
            let to = center - from.point();
            let (along, aside) = (to.dot(&ahead), to.perp(&ahead));
            let inside = radius * radius - aside * aside;
            (inside >= 0.0 && along > 0.0).then(|| along - libm::sqrt(inside))
        };
        discs.iter().filter_map(hit).fold(range_max_m, f64::min)
    };
    Scan { from, ranges_m: (0..360).map(range).collect(), range_max_m }
}
