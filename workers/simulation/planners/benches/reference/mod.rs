//! One cycle of MPPI written as plainly as it can be: one trajectory after the other, one number at a time, the functions of `libm`. It is
//! what the controller of this crate is measured against, on the same machine in the same minute.

use socrates_model::Pose;
use socrates_planners::controller::Twist;
use socrates_planners::costmap::{Costmap, INSCRIBED, LETHAL, UNKNOWN};
use socrates_planners::mppi::{MotionModel, MppiParams};

/// A controller for an empty outline, Nav2's main semantics, and the eight critics that Nav2 brings up.
pub(crate) struct Reference {
    params: MppiParams,
    noise: Vec<[f32; 3]>,
    sequence: Vec<[f32; 3]>,
    history: [[f32; 3]; 4],
    last: [f32; 3],
    trajectories: Vec<Vec<Step>>,
    costs: Vec<f32>,
}

/// One step of one trajectory.
#[derive(Clone, Copy, Default)]
struct Step {
    control: [f32; 3],
    speed: [f32; 3],
    x: f32,
    y: f32,
    yaw: f32,
}

/// What a cycle is about.
struct Scene<'a> {
    plan: &'a [(f32, f32)],
    arc: &'a [f32],
    costmap: &'a Costmap,
    robot: Pose,
    goal_yaw: f32,
    furthest: usize,
    valid: &'a [bool],
}

/// Normal numbers by Box and Muller's transform of a linear congruence.
fn normal(state: &mut u64) -> f32 {
    let mut uniform = || {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((*state >> 40) as f32 + 0.5) / 16_777_216.0
    };
    let (a, b) = (uniform(), uniform());
    libm::sqrtf(-2.0 * libm::logf(a)) * libm::cosf(std::f32::consts::TAU * b)
}

fn wrapped(angle: f32) -> f32 {
    let turns = libm::floorf((angle + std::f32::consts::PI) / std::f32::consts::TAU);
    angle - turns * std::f32::consts::TAU
}

/// A value as far as it can be reached from a speed.
fn reached(value: f32, from: f32, gain: f32, loss: f32) -> f32 {
    if from > 0.0 { value.max(from + loss).min(from + gain) } else { value.max(from - gain).min(from - loss) }
}

impl Reference {
    pub(crate) fn new(params: &MppiParams, mut seed: u64) -> Self {
        let (batch, steps) = (params.batch_size, params.time_steps);
        let std = [params.vx_std, params.vy_std, params.wz_std].map(|std| std as f32);
        let holonomic = params.motion_model == MotionModel::Omni;
        let noise = (0..batch * steps).map(|_| {
            let [vx, vy, wz] = std.map(|std| std * normal(&mut seed));
            [vx, if holonomic { vy } else { 0.0 }, wz]
        });
        Self {
            noise: noise.collect(),
            sequence: vec![[0.0; 3]; steps],
            history: [[0.0; 3]; 4],
            last: [0.0; 3],
            trajectories: vec![vec![Step::default(); steps]; batch],
            costs: vec![0.0; batch],
            params: params.clone(),
        }
    }

    /// Limits of the change of speed within a step: gain and loss of each axis.
    fn reach(&self) -> [(f32, f32); 3] {
        let it = &self.params;
        [(it.ax_max, it.ax_min), (it.ay_max, it.ay_min), (it.az_max, -it.az_max)]
            .map(|(gain, loss)| ((it.model_dt * gain) as f32, (it.model_dt * loss) as f32))
    }

    /// One cycle of a robot that carries out what it is told.
    pub(crate) fn command(&mut self, robot: Pose, plan: &[Pose], costmap: &Costmap) -> Twist {
        let points: Vec<(f32, f32)> =
            plan.iter().map(|pose| ((pose.x - robot.x) as f32, (pose.y - robot.y) as f32)).collect();
        let mut arc = vec![0.0];
        for pair in points.windows(2) {
            let (a, b) = (pair[0], pair[1]);
            arc.push(arc[arc.len() - 1] + libm::hypotf(b.0 - a.0, b.1 - a.1));
        }
        if let Some(first) = self.sequence.first_mut() {
            *first = self.last;
        }
        self.roll_out(robot.yaw as f32);
        let furthest = self.furthest(&points, &arc);
        let mut scene = Scene {
            plan: &points,
            arc: &arc,
            costmap,
            robot,
            goal_yaw: plan.last().map_or(0.0, |pose| pose.yaw as f32),
            furthest,
            valid: &[],
        };
        let valid: Vec<bool> =
            points.iter().map(|(x, y)| !matches!(scene.cost(*x, *y), INSCRIBED | LETHAL | UNKNOWN)).collect();
        scene.valid = &valid;
        self.judge(&scene);
        self.average();
        self.smooth();
        self.bound();
        self.is_free(&scene);
        self.send()
    }

    fn roll_out(&mut self, yaw: f32) {
        let (dt, reach, steps) = (self.params.model_dt as f32, self.reach(), self.params.time_steps);
        for (number, trajectory) in self.trajectories.iter_mut().enumerate() {
            let mut before = Step { speed: self.last, yaw, ..Step::default() };
            for (step, now) in trajectory.iter_mut().enumerate() {
                let mut speed = self.last;
                if step > 0 {
                    for axis in 0..3 {
                        let (gain, loss) = reach[axis];
                        speed[axis] = reached(before.control[axis], before.speed[axis], gain, loss);
                    }
                }
                let noise = self.noise[number * steps + step];
                let u = self.sequence[step];
                now.control = [u[0] + noise[0], u[1] + noise[1], u[2] + noise[2]];
                let (sine, cosine) = libm::sincosf(before.yaw);
                now.speed = speed;
                now.yaw = before.yaw + speed[2] * dt;
                now.x = before.x + dt * (speed[0] * cosine - speed[1] * sine);
                now.y = before.y + dt * (speed[0] * sine + speed[1] * cosine);
                before = *now;
            }
        }
    }

    fn furthest(&self, plan: &[(f32, f32)], arc: &[f32]) -> usize {
        let mut furthest = 0;
        for trajectory in &self.trajectories {
            let dt = self.params.model_dt as f32;
            let length: f32 =
                trajectory.iter().skip(1).map(|step| dt * libm::hypotf(step.speed[0], step.speed[1])).sum();
            let end = trajectory[trajectory.len() - 1];
            let mut nearest = (f32::MAX, 0);
            for (number, point) in plan.iter().enumerate().take_while(|(number, _)| arc[*number] <= length) {
                let square = (end.x - point.0) * (end.x - point.0) + (end.y - point.1) * (end.y - point.1);
                if square < nearest.0 {
                    nearest = (square, number);
                }
            }
            furthest = furthest.max(nearest.1);
        }
        furthest
    }

    /// All critics, one trajectory after the other.
    fn judge(&mut self, scene: &Scene<'_>) {
        let it = &self.params;
        let left = scene.arc[scene.arc.len() - 1];
        let angled = scene.angle_target(it);
        let blocked = scene.valid[..scene.furthest].iter().filter(|valid| !**valid).count();
        let share = blocked as f32 / scene.furthest.max(1) as f32;
        let aligned = left >= 0.5
            && scene.furthest >= it.path_align_critic.offset_from_furthest
            && !(blocked > 2 && share > it.path_align_critic.max_path_occupancy_ratio as f32);
        let steps = it.time_steps as f32;
        for (trajectory, total) in self.trajectories.iter().zip(&mut self.costs) {
            let mut cost = it.constraint_critic.cost_weight as f32 * constraint(trajectory, it);
            cost += scene.cells(trajectory, it, left);
            if left <= it.goal_critic.threshold_to_consider as f32 {
                let goal = scene.plan[scene.plan.len() - 1];
                let sum: f32 = trajectory.iter().map(|step| libm::hypotf(step.x - goal.0, step.y - goal.1)).sum();
                cost += it.goal_critic.cost_weight as f32 * sum / steps;
            }
            if left <= it.goal_angle_critic.threshold_to_consider as f32 {
                let sum: f32 = trajectory.iter().map(|step| wrapped(scene.goal_yaw - step.yaw).abs()).sum();
                cost += it.goal_angle_critic.cost_weight as f32 * sum / steps;
            }
            if aligned {
                cost += it.path_align_critic.cost_weight as f32 * scene.align(trajectory, it);
            }
            let end = trajectory[trajectory.len() - 1];
            if left >= it.path_follow_critic.threshold_to_consider as f32 {
                let to = scene.follow_target(it);
                cost += it.path_follow_critic.cost_weight as f32 * libm::hypotf(end.x - to.0, end.y - to.1);
            }
            if let Some(to) = angled {
                let bearing = libm::atan2f(to.1 - end.y, to.0 - end.x);
                cost += it.path_angle_critic.cost_weight as f32 * wrapped(bearing - end.yaw).abs();
            }
            if left >= it.prefer_forward_critic.threshold_to_consider as f32 {
                let back: f32 = trajectory.iter().map(|step| (-step.speed[0]).max(0.0)).sum();
                cost += it.prefer_forward_critic.cost_weight as f32 * it.model_dt as f32 * back;
            }
            *total = cost;
        }
    }

    fn average(&mut self) {
        let it = &self.params;
        let stay = [it.vx_std, it.vy_std, it.wz_std].map(|std| (it.gamma / (std * std)) as f32);
        for (trajectory, cost) in self.trajectories.iter().zip(&mut self.costs) {
            for (step, u) in trajectory.iter().zip(&self.sequence) {
                for axis in 0..3 {
                    *cost += stay[axis] * u[axis] * (step.control[axis] - u[axis]);
                }
            }
        }
        let least = self.costs.iter().copied().fold(f32::INFINITY, f32::min);
        let mut sum = 0.0;
        for cost in &mut self.costs {
            *cost = libm::expf((least - *cost) / it.temperature as f32);
            sum += *cost;
        }
        self.sequence.iter_mut().for_each(|u| *u = [0.0; 3]);
        for (trajectory, weight) in self.trajectories.iter().zip(&self.costs) {
            for (step, u) in trajectory.iter().zip(&mut self.sequence) {
                for (u, control) in u.iter_mut().zip(step.control) {
                    *u += weight / sum * control;
                }
            }
        }
    }

    fn smooth(&mut self) {
        let weights = [-21.0, 14.0, 39.0, 54.0, 59.0, 54.0, 39.0, 14.0, -21.0];
        let last = self.sequence[self.sequence.len() - 1];
        let padded: Vec<[f32; 3]> = self.history.iter().chain(&self.sequence).chain(&[last; 4]).copied().collect();
        let kept = self.sequence.len() - 1;
        for (u, window) in self.sequence[..kept].iter_mut().zip(padded.windows(9)) {
            for axis in 0..3 {
                u[axis] = window.iter().zip(weights).map(|(value, weight)| value[axis] * weight / 231.0).sum();
            }
        }
    }

    fn bound(&mut self) {
        let it = &self.params;
        let limits = [(it.vx_min, it.vx_max), (-it.vy_max, it.vy_max), (-it.wz_max, it.wz_max)];
        let reach = self.reach();
        let turn = |u: &mut [f32; 3]| {
            if let MotionModel::Ackermann { min_turning_r } = it.motion_model {
                let most = u[0].abs() / min_turning_r as f32;
                u[2] = u[2].max(-most).min(most);
            }
        };
        let mut last = self.last;
        self.sequence[0] = last;
        for u in &mut self.sequence[1..] {
            turn(u);
            for axis in 0..3 {
                let bounded = u[axis].max(limits[axis].0 as f32).min(limits[axis].1 as f32);
                u[axis] = reached(bounded, last[axis], reach[axis].0, reach[axis].1);
            }
            last = *u;
            turn(u);
        }
    }

    fn is_free(&self, scene: &Scene<'_>) -> bool {
        let dt = self.params.model_dt as f32;
        let (mut x, mut y, mut yaw) = (0.0, 0.0, scene.robot.yaw as f32);
        self.sequence.iter().take(40).all(|u| {
            let (sine, cosine) = libm::sincosf(yaw);
            x += dt * (u[0] * cosine - u[1] * sine);
            y += dt * (u[0] * sine + u[1] * cosine);
            yaw += dt * u[2];
            !matches!(scene.cost(x, y), INSCRIBED | LETHAL)
        })
    }

    fn send(&mut self) -> Twist {
        let command = self.sequence[1];
        self.last = command;
        self.history.rotate_left(1);
        self.history[3] = command;
        self.sequence.rotate_left(1);
        let end = self.sequence.len() - 1;
        self.sequence[end] = self.sequence[end - 1];
        let [vx, vy, omega] = command.map(f64::from);
        Twist { vx, vy, omega }
    }
}

fn constraint(trajectory: &[Step], it: &MppiParams) -> f32 {
    let mut sum = 0.0;
    for Step { speed: [vx, vy, wz], .. } in trajectory {
        sum += (vx - it.vx_max as f32).max(0.0) + (it.vx_min as f32 - vx).max(0.0);
        match it.motion_model {
            MotionModel::DiffDrive => (),
            MotionModel::Omni => sum += (vy.abs() - it.vy_max as f32).max(0.0),
            MotionModel::Ackermann { min_turning_r } => {
                sum += (min_turning_r as f32 - vx.abs() / wz.abs().max(1e-6)).max(0.0);
            }
        }
    }
    sum * it.model_dt as f32
}

impl Scene<'_> {
    fn cost(&self, x: f32, y: f32) -> u8 {
        let (left, low) = (self.costmap.origin().x - self.robot.x, self.costmap.origin().y - self.robot.y);
        let per_m = 1.0 / self.costmap.resolution_m() as f32;
        let (column, row) = ((x - left as f32) * per_m, (y - low as f32) * per_m);
        if column < 0.0 || row < 0.0 {
            return UNKNOWN;
        }
        self.costmap.cost(column as usize, row as usize)
    }

    fn cells(&self, trajectory: &[Step], it: &MppiParams, left: f32) -> f32 {
        let own = &it.cost_critic;
        let mut total = 0.0;
        for step in trajectory.iter().step_by(own.trajectory_point_step) {
            match self.cost(step.x, step.y) {
                0 => (),
                INSCRIBED..=UNKNOWN => {
                    total = own.collision_cost as f32;
                    break;
                }
                cost => {
                    if left >= own.near_goal_distance as f32 {
                        total += f32::from(cost);
                    }
                }
            }
        }
        let samples = it.time_steps.div_ceil(own.trajectory_point_step);
        own.cost_weight as f32 / 254.0 * total / samples as f32
    }

    fn align(&self, trajectory: &[Step], it: &MppiParams) -> f32 {
        let own = &it.path_align_critic;
        let (mut traveled, mut point, mut sum, mut count) = (0.0, 0, 0.0, 0.0);
        let mut before = trajectory[0];
        for step in trajectory.iter().step_by(own.trajectory_point_step).skip(1) {
            traveled += libm::hypotf(step.x - before.x, step.y - before.y);
            before = *step;
            while point + 1 < self.furthest
                && (self.arc[point + 1] - traveled).abs() <= (self.arc[point] - traveled).abs()
            {
                point += 1;
            }
            if self.valid[point] {
                sum += libm::hypotf(self.plan[point].0 - step.x, self.plan[point].1 - step.y);
                count += 1.0;
            }
        }
        if count > 0.0 { sum / count } else { 0.0 }
    }

    fn follow_target(&self, it: &MppiParams) -> (f32, f32) {
        let last = self.plan.len() - 1;
        let mut index = (self.furthest + it.path_follow_critic.offset_from_furthest).min(last);
        while index < last && !self.valid[index] {
            index += 1;
        }
        self.plan[index]
    }

    fn angle_target(&self, it: &MppiParams) -> Option<(f32, f32)> {
        let own = &it.path_angle_critic;
        let to = self.plan[(self.furthest + own.offset_from_furthest).min(self.plan.len() - 1)];
        let off = wrapped(libm::atan2f(to.1, to.0) - self.robot.yaw as f32).abs();
        (off > own.max_angle_to_furthest as f32).then_some(to)
    }
}
