//! From noise to trajectories.
//!
//! ```text
//! u + noise = control ─► speed, as far as accelerations reach ─► heading ─► position
//! ```
//!
//! Positions are in axes of the map with the robot at the origin: f32 is then as fine far from the map's origin as near to it.

use pulp::Simd;

use super::elementary::sin_cos;
use super::lanes::{Lanes, groups, groups_mut};
use super::noise::Axes;
use super::rows::{Rows, padded};
use super::sequence::{Command, Sequence};

/// How far a speed gets within one step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Reach {
    /// Largest gain, at least 0.
    pub(crate) gain: f32,
    /// Largest loss, at most 0.
    pub(crate) loss: f32,
}

/// Every trajectory of a batch.
#[derive(Debug, Clone)]
pub(crate) struct Rollout {
    /// Trajectories that count; rows are longer.
    pub(crate) batch: usize,
    /// Time of a step, s.
    pub(crate) dt: f32,
    /// What was asked for.
    pub(crate) controls: Axes,
    /// What the base does.
    pub(crate) speeds: Axes,
    /// East of the robot, m.
    pub(crate) x: Rows,
    /// North of the robot, m.
    pub(crate) y: Rows,
    /// Heading, rad, not wrapped.
    pub(crate) yaw: Rows,
    /// Length of each trajectory from its first point to its last, m.
    pub(crate) length: Vec<f32>,
}

impl Rollout {
    /// Trajectories that stand still.
    pub(crate) fn zeros(batch: usize, steps: usize, dt: f32, holonomic: bool) -> Self {
        let rows = || Rows::zeros(batch, steps);
        Self {
            batch,
            dt,
            controls: Axes::zeros(batch, steps, holonomic),
            speeds: Axes::zeros(batch, steps, holonomic),
            x: rows(),
            y: rows(),
            yaw: rows(),
            length: vec![0.0; padded(batch)],
        }
    }

    /// Steps of each trajectory.
    pub(crate) fn steps(&self) -> usize {
        self.x.iter().len()
    }
}

/// Rolls out a batch.
pub(crate) struct Predict<'a> {
    /// What is written.
    pub(crate) rollout: &'a mut Rollout,
    /// The noise.
    pub(crate) noise: &'a Axes,
    /// What the noise is added to.
    pub(crate) sequence: &'a Sequence,
    /// Speed now.
    pub(crate) speed: Command,
    /// Heading now, rad.
    pub(crate) yaw: f32,
    /// Limits of each axis; none where speeds follow commands at once.
    pub(crate) reach: Option<[Reach; 3]>,
    /// Whether controls become what the base can do.
    pub(crate) clamp_raw_controls: bool,
    /// Steps until each axis obeys.
    pub(crate) delay: [usize; 3],
    /// Commands before the first control, the newest first: a delayed axis still has to carry them out.
    pub(crate) past: &'a [Command],
}

impl pulp::WithSimd for Predict<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        let steps = self.rollout.steps();
        for step in 0..steps {
            self.control(simd, step);
            self.speed(simd, step);
            self.position(simd, step);
        }
        self.length(simd);
    }
}

/// The axes of controls, noise and speeds side by side.
macro_rules! each_axis {
    ($self:ident, $axis:ident) => {
        (&mut $self.rollout.controls.$axis, &$self.noise.$axis, &mut $self.rollout.speeds.$axis, &$self.sequence.$axis)
    };
}

impl Predict<'_> {
    /// Controls of a step.
    #[inline(always)]
    fn control<S: Simd>(&mut self, simd: S, step: usize) {
        for (controls, noise, _, sequence) in [each_axis!(self, vx), each_axis!(self, vy), each_axis!(self, wz)] {
            let u = Lanes::splat(simd, sequence.get(step).copied().unwrap_or_default());
            for (control, noise) in groups_mut::<S>(controls.row_mut(step)).zip(groups(simd, noise.row(step))) {
                *control = (u + noise).raw;
            }
        }
    }

    /// Speeds at a step: those of now at the first, then what the control before and the acceleration give.
    #[inline(always)]
    fn speed<S: Simd>(&mut self, simd: S, step: usize) {
        let axes = [each_axis!(self, vx), each_axis!(self, vy), each_axis!(self, wz)];
        for (axis, (controls, _, speeds, _)) in axes.into_iter().enumerate() {
            let Some(last) = step.checked_sub(1) else {
                speeds.row_mut(0).fill(self.speed.get(axis).copied().unwrap_or_default());
                continue;
            };
            let delay = self.delay.get(axis).copied().unwrap_or_default();
            let (before, speed) = speeds.pair_mut(step);
            let Some(obeyed) = last.checked_sub(delay) else {
                let sent = self.past.get(delay - last - 1).and_then(|command| command.get(axis));
                speed.fill(sent.copied().unwrap_or_default());
                continue;
            };
            let control = controls.row(obeyed);
            match self.reach.and_then(|reach| reach.get(axis).copied()) {
                Some(reach) => follow(simd, reach, control, before, speed),
                None => speed.copy_from_slice(control),
            }
            if self.clamp_raw_controls {
                controls.row_mut(obeyed).copy_from_slice(speed);
            }
        }
    }

    /// Headings and positions after a step, with the heading before it.
    #[inline(always)]
    fn position<S: Simd>(&mut self, simd: S, step: usize) {
        let rollout = &mut *self.rollout;
        let dt = rollout.dt;
        let (vx, vy, wz) = (rollout.speeds.vx.row(step), rollout.speeds.vy.row(step), rollout.speeds.wz.row(step));
        if step == 0 {
            // All begin alike.
            let [vx, vy, wz] = self.speed;
            let (sine, cosine) = libm::sincosf(self.yaw);
            rollout.x.row_mut(0).fill(dt * (vx * cosine - vy * sine));
            rollout.y.row_mut(0).fill(dt * (vx * sine + vy * cosine));
            rollout.yaw.row_mut(0).fill(self.yaw + wz * dt);
            return;
        }
        let dt = Lanes::splat(simd, dt);
        let (heading, yaw) = rollout.yaw.pair_mut(step);
        for ((yaw, before), wz) in groups_mut::<S>(yaw).zip(groups(simd, heading)).zip(groups(simd, wz)) {
            *yaw = (before + wz * dt).raw;
        }
        let ((x0, x), (y0, y)) = (rollout.x.pair_mut(step), rollout.y.pair_mut(step));
        let from = groups(simd, x0).zip(groups(simd, y0)).zip(groups(simd, heading)).zip(groups(simd, vx));
        let to = groups_mut::<S>(x).zip(groups_mut::<S>(y));
        if vy.is_empty() {
            for ((x, y), (((x0, y0), heading), vx)) in to.zip(from) {
                let (sine, cosine) = sin_cos(heading);
                *x = (x0 + dt * (vx * cosine)).raw;
                *y = (y0 + dt * (vx * sine)).raw;
            }
            return;
        }
        for (((x, y), (((x0, y0), heading), vx)), vy) in to.zip(from).zip(groups(simd, vy)) {
            let (sine, cosine) = sin_cos(heading);
            *x = (x0 + dt * (vx * cosine - vy * sine)).raw;
            *y = (y0 + dt * (vx * sine + vy * cosine)).raw;
        }
    }

    /// Lengths of all trajectories.
    #[inline(always)]
    fn length<S: Simd>(&mut self, simd: S) {
        let rollout = &mut *self.rollout;
        rollout.length.fill(0.0);
        let dt = Lanes::splat(simd, rollout.dt);
        for (step, vx) in rollout.speeds.vx.iter().enumerate().skip(1) {
            let vy = rollout.speeds.vy.row(step);
            let sums = groups_mut::<S>(&mut rollout.length).zip(groups(simd, vx));
            if vy.is_empty() {
                for (sum, vx) in sums {
                    *sum = (Lanes::new(simd, *sum) + vx.abs() * dt).raw;
                }
            } else {
                for ((sum, vx), vy) in sums.zip(groups(simd, vy)) {
                    *sum = (Lanes::new(simd, *sum) + (vx * vx + vy * vy).sqrt() * dt).raw;
                }
            }
        }
    }
}

/// The speeds that controls lead to within a step. What slows down has the smaller limit: which of the two is larger depends on the
/// side of zero the speed is on.
#[inline(always)]
fn follow<S: Simd>(simd: S, reach: Reach, control: &[f32], before: &[f32], speed: &mut [f32]) {
    let zero = Lanes::splat(simd, 0.0);
    let (gain, loss) = (zero.like(reach.gain), zero.like(reach.loss));
    for ((speed, before), control) in groups_mut::<S>(speed).zip(groups(simd, before)).zip(groups(simd, control)) {
        let forward = zero.below(before);
        let least = before + forward.select(loss, -gain);
        let most = before + forward.select(gain, -loss);
        *speed = control.clamp(least, most).raw;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mppi::lanes::Instructions;

    const REACH: [Reach; 3] = [Reach { gain: 0.15, loss: -0.1 }; 3];

    /// A batch of one with no noise.
    fn rolled(sequence: &Sequence, speed: Command, change: impl FnOnce(&mut Predict<'_>)) -> Rollout {
        let (steps, noise) = (sequence.vx.len(), Axes::zeros(1, sequence.vx.len(), true));
        let mut rollout = Rollout::zeros(1, steps, 0.05, true);
        let mut predict = Predict {
            rollout: &mut rollout,
            noise: &noise,
            sequence,
            speed,
            yaw: 0.0,
            reach: Some(REACH),
            clamp_raw_controls: false,
            delay: [0; 3],
            past: &[[0.8, 0.0, 0.0], [0.9, 0.0, 0.0]],
        };
        change(&mut predict);
        Instructions::Detected.arch().dispatch(predict);
        rollout
    }

    fn first(rows: &Rows) -> Vec<f32> {
        rows.iter().map(|row| row[0]).collect()
    }

    fn near(found: &[f32], wanted: &[f32]) {
        assert_eq!(found.len(), wanted.len());
        assert!(found.iter().zip(wanted).all(|(found, wanted)| (found - wanted).abs() < 1e-6), "{found:?} {wanted:?}");
    }

    #[test]
    fn speeds_follow_controls_one_step_later_and_no_faster_than_the_base_can() {
        let sequence = Sequence { vx: vec![1.0, 1.0, -1.0, 0.0], ..Sequence::zeros(4) };
        near(&first(&rolled(&sequence, [0.2, 0.0, 0.0], |_| ()).speeds.vx), &[0.2, 0.35, 0.5, 0.4]);
        near(&first(&rolled(&sequence, [-0.2, 0.0, 0.0], |_| ()).speeds.vx), &[-0.2, -0.1, 0.0, -0.15]);
        near(&first(&rolled(&sequence, [0.2, 0.0, 0.0], |it| it.reach = None).speeds.vx), &[0.2, 1.0, 1.0, -1.0]);
    }

    #[test]
    fn raw_controls_become_what_the_base_can_do_where_that_is_asked_for() {
        let sequence = Sequence { vx: vec![1.0; 3], ..Sequence::zeros(3) };
        let rollout = rolled(&sequence, [0.0; 3], |predict| predict.clamp_raw_controls = true);
        near(&first(&rollout.controls.vx), &[0.1, 0.25, 1.0]);
        near(&first(&rolled(&sequence, [0.0; 3], |_| ()).controls.vx), &[1.0; 3]);
    }

    #[test]
    fn a_delayed_axis_first_carries_out_what_was_sent_before() {
        let sequence = Sequence { vx: vec![0.1, 0.2, 0.3, 0.4, 0.5], ..Sequence::zeros(5) };
        let rollout = rolled(&sequence, [0.0; 3], |predict| {
            predict.reach = None;
            predict.delay = [2, 0, 0];
        });
        near(&first(&rollout.speeds.vx), &[0.0, 0.9, 0.8, 0.1, 0.2]);
    }

    #[test]
    fn positions_take_the_heading_before_each_step() {
        let sequence = Sequence { vx: vec![1.0; 3], vy: vec![0.5; 3], wz: vec![2.0; 3] };
        let rollout = rolled(&sequence, [1.0, 0.5, 2.0], |predict| predict.reach = None);
        near(&first(&rollout.yaw), &[0.1, 0.2, 0.3]);
        let (mut x, mut y, mut wanted) = (0.0, 0.0, (Vec::new(), Vec::new()));
        for heading in [0.0_f32, 0.1, 0.2] {
            let (sine, cosine) = libm::sincosf(heading);
            x += 0.05 * (cosine - 0.5 * sine);
            y += 0.05 * (sine + 0.5 * cosine);
            wanted.0.push(x);
            wanted.1.push(y);
        }
        near(&first(&rollout.x), &wanted.0);
        near(&first(&rollout.y), &wanted.1);
        near(&rollout.length[..1], &[2.0 * 0.05 * 1.25_f32.sqrt()]);
    }
}
