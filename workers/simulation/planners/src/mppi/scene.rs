//! What a cycle is about: the plan, the goal and the costs, seen from the robot.

use pulp::Simd;
use socrates_model::geometry::wrap_angle;
use socrates_model::{Point, Pose};

use super::ground::Ground;
use super::lanes::{Arch, groups};
use super::rollout::Rollout;

/// The local plan in axes of the map with the robot at the origin.
#[derive(Debug, Clone, Default)]
pub(crate) struct Plan {
    /// East of the robot, m.
    pub(crate) x: Vec<f32>,
    /// North of the robot, m.
    pub(crate) y: Vec<f32>,
    /// Headings, rad.
    pub(crate) yaw: Vec<f32>,
    /// Lengths of the plan up to each point, m.
    pub(crate) s: Vec<f32>,
}

impl Plan {
    /// Takes over a plan.
    pub(crate) fn set(&mut self, poses: &[Pose], robot: &Pose) {
        self.clear();
        for pose in poses {
            let from_robot = pose.point() - robot.point();
            self.push(from_robot.x as f32, from_robot.y as f32, pose.yaw as f32);
        }
    }

    pub(crate) fn clear(&mut self) {
        for values in [&mut self.x, &mut self.y, &mut self.yaw, &mut self.s] {
            values.clear();
        }
    }

    pub(crate) fn push(&mut self, x: f32, y: f32, yaw: f32) {
        let (x0, y0) = (self.x.last().copied().unwrap_or(x), self.y.last().copied().unwrap_or(y));
        let step = ((x - x0) * (x - x0) + (y - y0) * (y - y0)).sqrt();
        self.s.push(self.s.last().copied().unwrap_or_default() + step);
        self.x.push(x);
        self.y.push(y);
        self.yaw.push(yaw);
    }

    /// Number of points.
    pub(crate) fn len(&self) -> usize {
        self.x.len()
    }

    /// Position of a point.
    pub(crate) fn point(&self, index: usize) -> Option<(f32, f32)> {
        Some((self.x.get(index).copied()?, self.y.get(index).copied()?))
    }

    /// Position of the last point; the robot's own where there is none.
    pub(crate) fn end(&self) -> (f32, f32) {
        self.x.last().copied().zip(self.y.last().copied()).unwrap_or_default()
    }

    /// Length, m.
    pub(crate) fn length(&self) -> f32 {
        self.s.last().copied().unwrap_or_default()
    }
}

/// What critics are told of a cycle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Scene<'a> {
    /// The local plan.
    pub(crate) plan: &'a Plan,
    /// Costs.
    pub(crate) ground: Ground<'a>,
    /// Heading of the robot, rad.
    pub(crate) yaw: f32,
    /// Heading at the goal, rad.
    pub(crate) goal_yaw: f32,
    /// What is left of the plan, m: along it, and straight for Nav2 Humble.
    pub(crate) left_m: f32,
    /// Whether critics are those of Nav2 Humble.
    pub(crate) humble: bool,
    /// Instructions of the processor.
    pub(crate) arch: Arch,
}

/// What critics say of a batch, and what they find out for each other.
#[derive(Debug, Clone, Default)]
pub(crate) struct Verdict {
    /// Cost of every trajectory.
    pub(crate) costs: Vec<f32>,
    /// Whether every trajectory collides.
    pub(crate) failed: bool,
    /// Number of the farthest point of the plan that a trajectory gets to.
    furthest: Option<usize>,
    /// Whether each point of the plan is free.
    valid: Vec<bool>,
}

impl Verdict {
    /// A verdict for rows of this length.
    pub(crate) fn new(row: usize) -> Self {
        Self { costs: vec![0.0; row], ..Self::default() }
    }

    /// Forgets everything; a new batch.
    pub(crate) fn clear(&mut self) {
        self.costs.fill(0.0);
        self.failed = false;
        self.furthest = None;
        self.valid.clear();
    }

    /// Number of the point of the plan that is nearest to the end of a trajectory, the farthest one over all trajectories.
    pub(crate) fn furthest(&mut self, scene: &Scene<'_>, rollout: &Rollout) -> usize {
        *self.furthest.get_or_insert_with(|| {
            let found = scene.arch.dispatch(Furthest { plan: scene.plan, rollout, bounded: !scene.humble });
            found.min(scene.plan.len().saturating_sub(1))
        })
    }

    /// Takes this point as the farthest one.
    #[cfg(test)]
    pub(crate) fn set_furthest(&mut self, index: usize) {
        self.furthest = Some(index);
    }

    /// Whether each point of the plan but the last is free.
    pub(crate) fn valid(&mut self, scene: &Scene<'_>) -> &[bool] {
        if self.valid.is_empty() {
            let before_last = scene.plan.len().saturating_sub(1);
            let points = scene.plan.x.iter().zip(&scene.plan.y).take(before_last);
            self.valid.extend(points.map(|(x, y)| scene.ground.is_valid(*x, *y)));
        }
        &self.valid
    }

    /// Where the memory is and how much of it there is, so that a test sees that none is taken.
    #[cfg(test)]
    pub(crate) fn memory(&self) -> [(usize, usize); 2] {
        [(self.costs.as_ptr() as usize, self.costs.capacity()), (self.valid.as_ptr() as usize, self.valid.capacity())]
    }
}

/// Looks for the farthest point.
struct Furthest<'a> {
    plan: &'a Plan,
    rollout: &'a Rollout,
    /// Whether a trajectory gets to no point that is farther along the plan than the trajectory is long.
    bounded: bool,
}

impl pulp::WithSimd for Furthest<'_> {
    type Output = usize;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> usize {
        let mut furthest: f32 = 0.0;
        let mut left = self.rollout.batch;
        let ends = groups(simd, self.rollout.x.last()).zip(groups(simd, self.rollout.y.last()));
        for ((x, y), length) in ends.zip(groups(simd, &self.rollout.length)) {
            let mut nearest = (x.like(f32::MAX), x.like(0.0));
            let points = self.plan.x.iter().zip(&self.plan.y).zip(&self.plan.s);
            let mut number = x.like(0.0);
            for ((px, py), s) in points {
                let (dx, dy) = (x - x.like(*px), y - y.like(*py));
                let square = dx * dx + dy * dy;
                let mut nearer = square.below(nearest.0);
                if self.bounded {
                    nearer = nearer.and(x.like(*s).at_most(length));
                }
                nearest = (nearer.select(square, nearest.0), nearer.select(number, nearest.1));
                number = number + x.like(1.0);
            }
            let width = S::F32_LANES.min(left);
            let numbers = nearest.1.each(0.0);
            furthest = numbers.iter().take(width).fold(furthest, |most, number| most.max(*number));
            left -= width;
        }
        furthest as usize
    }
}

/// The angle between a heading and the way to a point, rad, at least 0.
pub(crate) fn off_heading(yaw: f64, to: &Point) -> f64 {
    wrap_angle(libm::atan2(to.y, to.x) - yaw).abs()
}
