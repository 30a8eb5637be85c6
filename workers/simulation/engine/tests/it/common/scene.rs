//! Scenes of discs and segments, and rapier's casts over them: the oracle of our own scan.

use rapier2d::prelude::{ColliderBuilder, PhysicsWorld, QueryFilter, Ray, Vector as RapierVector};
use socrates_engine::{BEAMS, Disc};
use socrates_model::seeds::SplitMix64;
use socrates_model::{Point, Pose};

/// Discs, segments and where they are scanned from.
#[derive(Debug, Clone)]
pub struct Scene {
    /// Bodies.
    pub discs: Vec<Disc>,
    /// Walls.
    pub segments: Vec<(Point, Point)>,
}

/// A fixed sequence, uniform in [0, 1).
#[derive(Debug, Clone)]
pub struct Random(SplitMix64);

impl Random {
    /// The sequence of this seed.
    pub const fn new(seed: u64) -> Self {
        Self(SplitMix64::new(seed))
    }

    /// The next number.
    pub fn uniform(&mut self) -> f64 {
        self.0.unit()
    }

    /// A number between two.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }
}

/// The floor of `n` walkers at 0.25 people per m²: discs of 0.35 m and its walls, as the workload CROSS-n has them.
pub fn cross(n: u32) -> (Scene, f64) {
    let side = (f64::from(n) / 0.25).sqrt().max(8.0);
    let corner = |x: f64, y: f64| Point::new(x * side, y * side);
    let mut segments = vec![
        (corner(0., 0.), corner(1., 0.)),
        (corner(1., 0.), corner(1., 1.)),
        (corner(1., 1.), corner(0., 1.)),
        (corner(0., 1.), corner(0., 0.)),
    ];
    let blocks = (side / 10.0).floor() as u32;
    for j in 0..blocks {
        for i in 0..blocks {
            let (x, y) = (10.0 * f64::from(i), 10.0 * f64::from(j) + 4.0);
            segments.push((Point::new(x + 4.0, y), Point::new(x + 6.0, y)));
        }
    }
    let mut random = Random::new(0x5EED_0000 + u64::from(n));
    let g = f64::from(n).sqrt().ceil();
    let cell = side / g;
    let discs = (0..n)
        .map(|i| {
            let (ux, uy, _) = (random.uniform(), random.uniform(), random.uniform());
            let (column, row) = (f64::from(i) % g, (f64::from(i) / g).floor());
            let center = Point::new((column + 0.5) * cell + (ux - 0.5) * 0.5, (row + 0.5) * cell + (uy - 0.5) * 0.5);
            Disc { center, radius_m: 0.35 }
        })
        .collect();
    (Scene { discs, segments }, side)
}

/// The same scene in rapier.
pub struct Oracle(PhysicsWorld);

impl Oracle {
    /// Every disc a ball, every segment a segment.
    pub fn new(scene: &Scene) -> Self {
        let mut world = PhysicsWorld::default();
        let at = |point: &Point| RapierVector::new(point.x as f32, point.y as f32);
        for disc in &scene.discs {
            let ball = ColliderBuilder::ball(disc.radius_m as f32).translation(at(&disc.center));
            world.insert_collider(ball, None);
        }
        for (from, to) in &scene.segments {
            world.insert_collider(ColliderBuilder::segment(at(from), at(to)), None);
        }
        world.detect_collisions(&(), &());
        Self(world)
    }

    /// 360 casts.
    pub fn scan(&self, from: &Pose, max_m: f64) -> [f64; BEAMS] {
        let query = self.0.broad_phase.as_query_pipeline(
            self.0.narrow_phase.query_dispatcher(),
            &self.0.bodies,
            &self.0.colliders,
            QueryFilter::default(),
        );
        let origin = RapierVector::new(from.x as f32, from.y as f32);
        std::array::from_fn(|beam| {
            let (sin, cos) = (from.yaw + (beam as f64).to_radians()).sin_cos();
            let ray = Ray::new(origin, RapierVector::new(cos as f32, sin as f32));
            query.cast_ray(&ray, max_m as f32, true).map_or(max_m, |(_, range)| f64::from(range))
        })
    }
}
