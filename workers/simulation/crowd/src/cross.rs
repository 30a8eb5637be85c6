//! The benchmark workload CROSS-N: a square floor on which every second person crosses the others.
//!
//! N people at 0.25 per square meter of a walled floor with short bars in it. Even ones walk along x,
//! odd ones along y, to the far wall and back, forever. Positions and desired speeds come from a
//! SplitMix64 of the given size, so everybody who writes the workload down gets the same crowd.

use nalgebra::{Point2, Vector2};

use crate::obstacle::Segment;
use crate::person::{Goal, Person};
use crate::walker::{Route, Walker};

/// Step of the workload, s.
pub const DT_S: f64 = 0.01;
/// Within this distance a wall is felt, m.
pub const WALL_RANGE_M: f64 = 3.0;

const DENSITY_PER_M2: f64 = 0.25;
const SMALLEST_SIDE_M: f64 = 8.0;
const RADIUS_M: f64 = 0.35;
const GOAL_RADIUS_M: f64 = 0.3;
const SEED: u64 = 0x5EED_0000;

/// SplitMix64 (Steele, Lea and Flood 2014): 64 bits of state, every seed good. For this workload and for tests; no crowd
/// draws anything.
#[derive(Debug, Clone)]
pub struct SplitMix64(u64);

impl SplitMix64 {
    /// A generator with `seed` as its state.
    #[must_use]
    pub const fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The next 64 bits.
    pub const fn next_u64(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// The next number in [0, 1), a multiple of 2^-53.
    #[expect(clippy::cast_precision_loss, reason = "53 bits fit an f64 exactly")]
    pub fn next_f64(&mut self) -> f64 {
        (self.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// The crowd of CROSS-N and its walls.
#[derive(Debug, Clone)]
pub struct Cross {
    /// Everybody, `id` counting from 0.
    pub walkers: Vec<Walker>,
    /// The four walls, then the bars.
    pub walls: Vec<Segment>,
    /// Length of a side of the floor, m.
    pub side_m: f64,
}

/// CROSS-N for `n_people`. Sizes with a published check sum: 10, 50, 100, 1000.
#[must_use]
pub fn cross(n_people: u32) -> Cross {
    let side_m = (f64::from(n_people) / DENSITY_PER_M2).sqrt().max(SMALLEST_SIDE_M);
    Cross { walkers: walkers(n_people, side_m), walls: walls(side_m), side_m }
}

fn walls(side_m: f64) -> Vec<Segment> {
    let segment = |ax: f64, ay: f64, bx: f64, by: f64| Segment { from: Point2::new(ax, ay), to: Point2::new(bx, by) };
    let mut walls = vec![
        segment(0.0, 0.0, side_m, 0.0),
        segment(side_m, 0.0, side_m, side_m),
        segment(side_m, side_m, 0.0, side_m),
        segment(0.0, side_m, 0.0, 0.0),
    ];
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small whole number of bars")]
    let bars = (side_m / 10.0).floor() as u32;
    for j in 0..bars {
        for i in 0..bars {
            let (x, y) = (10.0 * f64::from(i), 10.0 * f64::from(j));
            walls.push(segment(x + 4.0, y + 4.0, x + 6.0, y + 4.0));
        }
    }
    walls
}

fn walkers(n_people: u32, side_m: f64) -> Vec<Walker> {
    let mut random = SplitMix64::new(SEED + u64::from(n_people));
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the root of a 32-bit number")]
    let per_row = f64::from(n_people).sqrt().ceil() as u32;
    let cell = side_m / f64::from(per_row);
    let walker = |id: u32| {
        let (ux, uy, us) = (random.next_f64(), random.next_f64(), random.next_f64());
        let x = (f64::from(id % per_row) + 0.5) * cell + (ux - 0.5) * 0.5;
        let y = (f64::from(id / per_row) + 0.5) * cell + (uy - 0.5) * 0.5;
        let speed_mps = 0.8 + 0.7 * us;
        let far = |at: f64| if at < side_m / 2.0 { (side_m - 1.0, speed_mps) } else { (1.0, -speed_mps) };
        let (goal, velocity) = if id.is_multiple_of(2) {
            let (goal_x, speed) = far(x);
            (Point2::new(goal_x, y), Vector2::new(speed, 0.0))
        } else {
            let (goal_y, speed) = far(y);
            (Point2::new(x, goal_y), Vector2::new(0.0, speed))
        };
        let person = Person {
            velocity,
            yaw: libm::atan2(velocity.y, velocity.x),
            radius_m: RADIUS_M,
            speed_mps,
            ..Person::standing(id, Point2::new(x, y))
        };
        let goals = [goal, person.position].map(|at| Goal { at, radius_m: GOAL_RADIUS_M });
        Walker::walking(person, Route::new(goals.to_vec(), true))
    };
    (0..n_people).map(walker).collect()
}
