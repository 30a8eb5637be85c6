//! The controller as a whole.

mod acceptance;
mod control;
mod properties;

use socrates_model::{Point, Pose};

use super::{Mppi, MppiParams};
use crate::controller::{Controller as _, Following, NoControl, Twist};
use crate::costmap::{Costmap, FREE, LETHAL};

/// A robot on a floor with a plan. It carries out every command at once.
pub(super) struct World {
    pub(super) costmap: Costmap,
    pub(super) plan: Vec<Pose>,
    pub(super) pose: Pose,
    pub(super) speed: Twist,
    pub(super) outline: Vec<Point>,
    pub(super) speed_share: f64,
    pub(super) period_s: f64,
    /// Length of the plan that the controller is shown, m.
    pub(super) prune_m: f64,
}

impl World {
    /// A floor of 10 m by 10 m of cells of 0.05 m, a plan along y = 5 from x = 4 to x = 8 with a point every 0.025 m, and the robot at its
    /// beginning.
    pub(super) fn empty() -> Self {
        Self {
            costmap: Costmap::new(200, 200, 0.05, Point::origin(), FREE),
            plan: (0..=160_u8).map(|number| Pose::new(4.0 + 0.025 * f64::from(number), 5.0, 0.0)).collect(),
            pose: Pose::new(4.0, 5.0, 0.0),
            speed: Twist::default(),
            outline: Vec::new(),
            speed_share: 1.0,
            period_s: 0.05,
            prune_m: 2.0,
        }
    }

    /// Puts a disc into the map: lethal inside, then 253 up to 0.22 m from it, then inflated to 0.7 m with a factor of 3.
    pub(super) fn with_disc(mut self, x: f64, y: f64, radius_m: f64) -> Self {
        for row in 0..self.costmap.height() {
            for column in 0..self.costmap.width() {
                let center = self.costmap.center(column, row);
                let distance = libm::hypot(center.x - x, center.y - y) - radius_m;
                let cost = if distance <= 0.0 {
                    LETHAL
                } else if distance <= 0.22 {
                    253
                } else if distance <= 0.7 {
                    (252.0 * libm::exp(-3.0 * (distance - 0.22))) as u8
                } else {
                    continue;
                };
                self.costmap.set(column, row, cost);
            }
        }
        self
    }

    /// The plan from the robot on.
    pub(super) fn local_plan(&self) -> Vec<Pose> {
        let off = |pose: &Pose| (pose.point() - self.pose.point()).norm();
        let nearest = (0..self.plan.len()).min_by(|a, b| off(&self.plan[*a]).total_cmp(&off(&self.plan[*b])));
        let mut left_m = self.prune_m;
        let mut last: Option<Pose> = None;
        let ahead = self.plan[nearest.unwrap_or(0)..].iter().take_while(|pose| {
            left_m -= last.map_or(0.0, |last| (pose.point() - last.point()).norm());
            last = Some(**pose);
            left_m >= 0.0
        });
        ahead.copied().collect()
    }

    /// Asks for a command.
    pub(super) fn command(&self, mppi: &mut Mppi) -> Result<Twist, NoControl> {
        let plan = self.local_plan();
        mppi.command(&Following {
            pose: self.pose,
            speed: self.speed,
            plan: &plan,
            goal: *self.plan.last().unwrap(),
            costmap: &self.costmap,
            footprint: &self.outline,
            speed_share: self.speed_share,
        })
    }

    /// Carries out a command for one period.
    pub(super) fn carry_out(&mut self, command: Twist) {
        let Twist { vx, vy, omega } = command;
        let (sine, cosine) = libm::sincos(self.pose.yaw);
        self.pose = Pose::new(
            self.pose.x + self.period_s * (vx * cosine - vy * sine),
            self.pose.y + self.period_s * (vx * sine + vy * cosine),
            socrates_model::geometry::wrap_angle(self.pose.yaw + self.period_s * omega),
        );
        self.speed = command;
    }

    /// One cycle.
    pub(super) fn step(&mut self, mppi: &mut Mppi) -> Twist {
        let command = self.command(mppi).unwrap();
        self.carry_out(command);
        command
    }

    /// Several cycles.
    pub(super) fn steps(&mut self, mppi: &mut Mppi, count: u16) {
        for _ in 0..count {
            self.step(mppi);
        }
    }
}

/// The bringup parameters with fewer trajectories.
pub(super) fn bringup(batch_size: usize) -> MppiParams {
    MppiParams { batch_size, ..MppiParams::bringup() }
}
