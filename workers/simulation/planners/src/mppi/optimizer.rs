//! The controller: one cycle after the other.

use socrates_model::Pose;

use super::critics::Critic;
use super::faults::BadParams;
use super::ground::Ground;
use super::lanes::{Arch, Instructions};
use super::limits::Limits;
use super::noise::{Axes, Draw};
use super::params::MppiParams;
use super::rollout::{Predict, Rollout};
use super::rows::padded;
use super::scene::{Plan, Scene, Verdict};
use super::sequence::{Command, Sequence};
use super::smoothing::Smoother;
use super::update::Average;
use super::validator;
use crate::controller::{Controller, Following, NoControl, Twist};

/// The controller's period is that of the model within this, s.
const SAME_PERIOD_S: f64 = 1e-6;

/// Model predictive path integral control, as in Nav2 (Williams et al. 2016).
///
/// The same parameters, seed and cycles give the same commands on every machine. Nothing is allocated in a cycle, once a plan and a
/// map of the size have been seen.
#[derive(Debug)]
pub struct Mppi {
    params: MppiParams,
    seed: u64,
    arch: Arch,
    limits: Limits,
    critics: Vec<Box<dyn Critic>>,
    /// Whether the sequence moves on by a step each cycle.
    shifts: bool,
    delay: [usize; 3],
    pub(super) noise: Axes,
    /// Number of the next draw of noise.
    pub(super) draw: u64,
    pub(super) sequence: Sequence,
    smoother: Smoother,
    rollout: Rollout,
    pub(super) verdict: Verdict,
    pub(super) weights: Vec<f32>,
    plan: Plan,
    /// The commands sent, the newest first.
    sent: Vec<Command>,
}

/// What a cycle starts from.
struct Start<'a> {
    scene: CycleScene<'a>,
    speed: Command,
    share: f32,
}

/// What a cycle sees.
#[derive(Clone, Copy)]
struct CycleScene<'a> {
    ground: Ground<'a>,
    yaw: f32,
    goal_yaw: f32,
    left_m: f32,
}

impl Mppi {
    /// A controller that stands still. `seed` decides its noise.
    ///
    /// # Errors
    /// [`BadParams`] with every parameter that is out of its range.
    pub fn new(params: &MppiParams, seed: u64) -> Result<Self, BadParams> {
        params.check()?;
        let (batch, steps) = (params.batch_size, params.time_steps);
        let holonomic = params.holonomic();
        let shifts = (params.period_s() - params.model_dt).abs() < SAME_PERIOD_S;
        let delay = [params.model_delay_vx, params.model_delay_vy, params.model_delay_wz]
            .map(|delay_s| (delay_s / params.model_dt + 0.5) as usize);
        let longest = delay.into_iter().max().unwrap_or_default();
        let mut made = Self {
            seed,
            arch: Instructions::Detected.arch(),
            limits: Limits::new(params, shifts),
            critics: params.critics.iter().filter_map(|sheet| sheet.critic(params)).collect(),
            shifts,
            delay,
            noise: Axes::zeros(batch, steps, holonomic),
            draw: 0,
            sequence: Sequence::zeros(steps),
            smoother: Smoother::default(),
            rollout: Rollout::zeros(batch, steps, params.model_dt as f32, holonomic),
            verdict: Verdict::new(padded(batch)),
            weights: vec![0.0; padded(batch)],
            plan: Plan::default(),
            sent: vec![[0.0; 3]; longest + 1],
            params: params.clone(),
        };
        made.draw_noise();
        Ok(made)
    }

    /// The same with a choice of instructions. Gives the same bytes; for tests and benches.
    #[must_use]
    pub fn with_instructions(mut self, instructions: Instructions) -> Self {
        self.arch = instructions.arch();
        self
    }

    /// The parameters that it was made with.
    #[must_use]
    pub const fn params(&self) -> &MppiParams {
        &self.params
    }

    /// Whether the control sequence moves on by a step each cycle. It does not where the controller runs more often than the model has
    /// steps; Nav2 warns of that.
    #[must_use]
    pub const fn shifts(&self) -> bool {
        self.shifts
    }

    /// Says that no command was asked for, for so long, s: as Nav2 Humble it begins anew where that is longer than its period.
    pub fn paused(&mut self, pause_s: f64) {
        if self.params.humble && pause_s > self.params.reset_period {
            self.forget();
        }
    }

    /// Stands still and draws new noise.
    fn forget(&mut self) {
        self.sequence.reset();
        self.smoother.reset();
        self.verdict.clear();
        self.draw_noise();
    }

    fn draw_noise(&mut self) {
        let std = [self.params.vx_std, self.params.vy_std, self.params.wz_std].map(|std| std as f32);
        self.arch.dispatch(Draw { key: (self.seed, self.draw), std, noise: &mut self.noise });
        self.draw += 1;
    }

    /// Takes over plan and speed.
    fn start<'a>(&mut self, cycle: &Following<'a>) -> Start<'a> {
        let robot: &Pose = &cycle.pose;
        self.plan.set(cycle.plan, robot);
        let measured = [cycle.speed.vx as f32, cycle.speed.vy as f32, cycle.speed.omega as f32];
        let last = self.sent.first().copied().unwrap_or_default();
        let speed = if self.params.humble {
            measured
        } else if self.params.open_loop {
            last
        } else {
            self.limits.speed_now(last, measured)
        };
        let (x, y) = self.plan.end();
        let scene = CycleScene {
            ground: Ground::new(cycle.costmap, robot, cycle.footprint, self.params.surroundings.track_unknown_space),
            yaw: robot.yaw as f32,
            goal_yaw: cycle.goal.yaw as f32,
            left_m: if self.params.humble { (x * x + y * y).sqrt() } else { self.plan.length() },
        };
        Start { scene, speed, share: cycle.speed_share as f32 }
    }

    /// Improves the sequence; false where no trajectory is free of collisions.
    fn optimize(&mut self, start: &Start<'_>) -> bool {
        for _ in 0..self.params.iteration_count {
            self.limits.begin(&mut self.sequence, start.speed);
            self.arch.dispatch(Predict {
                rollout: &mut self.rollout,
                noise: &self.noise,
                sequence: &self.sequence,
                speed: start.speed,
                yaw: start.scene.yaw,
                reach: (!self.params.humble).then_some(self.limits.step),
                clamp_raw_controls: self.params.clamp_raw_controls,
                delay: self.delay,
                past: self.sent.get(usize::from(self.shifts)..).unwrap_or_default(),
            });
            if !self.judge(start) || !self.average() {
                return false;
            }
            if !self.params.humble {
                self.smoother.smooth(&mut self.sequence, self.params.sgf_order);
            }
            self.limits.bound(&mut self.sequence, start.speed, start.share);
        }
        if self.params.humble {
            self.smoother.smooth(&mut self.sequence, self.params.sgf_order);
        }
        true
    }

    /// Asks the critics; false where every trajectory collides.
    fn judge(&mut self, start: &Start<'_>) -> bool {
        let CycleScene { ground, yaw, goal_yaw, left_m } = start.scene;
        let (humble, arch) = (self.params.humble, self.arch);
        let scene = Scene { plan: &self.plan, ground, yaw, goal_yaw, left_m, humble, arch };
        self.verdict.clear();
        for critic in &mut self.critics {
            critic.score(&scene, &self.rollout, &mut self.verdict);
            if self.verdict.failed {
                return false;
            }
        }
        true
    }

    /// Takes the mean of the controls, weighted by their costs; false where a cost is no number.
    fn average(&mut self) -> bool {
        let params = &self.params;
        let stay = |std: f64| if std > 0.0 { (params.gamma / (std * std)) as f32 } else { 0.0 };
        self.arch.dispatch(Average {
            batch: self.rollout.batch,
            controls: &self.rollout.controls,
            costs: &mut self.verdict.costs,
            weights: &mut self.weights,
            sequence: &mut self.sequence,
            stay: [params.vx_std, params.vy_std, params.wz_std].map(stay),
            temperature: params.temperature as f32,
        })
    }

    /// Sends the command of this cycle and moves on.
    fn send(&mut self) -> Twist {
        let command = self.sequence.command(usize::from(self.shifts));
        self.smoother.push(command);
        self.sent.rotate_right(1);
        if let Some(newest) = self.sent.first_mut() {
            *newest = command;
        }
        if self.shifts {
            self.sequence.shift();
        }
        if self.params.regenerate_noises {
            self.draw_noise();
        }
        let [vx, vy, omega] = command.map(f64::from);
        Twist { vx, vy, omega }
    }

    /// Where the memory is and how much of it there is, so that a test sees that none is taken.
    #[cfg(test)]
    pub(crate) fn memory(&self) -> Vec<(usize, usize)> {
        let Rollout { controls, speeds, x, y, yaw, length, .. } = &self.rollout;
        let rows = [&self.noise, controls, speeds].into_iter().flat_map(|axes| [&axes.vx, &axes.vy, &axes.wz]);
        let plan = [&self.plan.x, &self.plan.y, &self.plan.yaw, &self.plan.s];
        let vectors = plan.into_iter().chain(self.sequence.axes()).chain([length, &self.weights]);
        rows.chain([x, y, yaw])
            .map(super::rows::Rows::memory)
            .chain(vectors.map(|vector| (vector.as_ptr() as usize, vector.capacity())))
            .chain(self.verdict.memory())
            .chain([self.smoother.memory(), (self.sent.as_ptr() as usize, self.sent.capacity())])
            .collect()
    }
}

impl Controller for Mppi {
    fn command(&mut self, cycle: &Following<'_>) -> Result<Twist, NoControl> {
        if cycle.plan.is_empty() {
            return Err(NoControl::NoPlan);
        }
        let start = self.start(cycle);
        for _ in 0..=self.params.retry_attempt_limit {
            let free = self.optimize(&start)
                && (self.params.humble
                    || validator::is_free(
                        &self.sequence,
                        self.rollout.dt,
                        start.scene.yaw,
                        &start.scene.ground,
                        &self.params.trajectory_validator,
                    ));
            if free {
                return Ok(self.send());
            }
            self.forget();
        }
        Err(NoControl::Collision)
    }

    fn reset(&mut self) {
        self.forget();
        self.sent.fill([0.0; 3]);
    }
}
