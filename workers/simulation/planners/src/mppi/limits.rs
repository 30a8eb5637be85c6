//! What a base can do: limits of speed and acceleration, and the turns of a car.

use super::params::{MotionModel, MppiParams};
use super::rollout::Reach;
use super::sequence::{Command, Sequence};

/// Limits of a base.
#[derive(Debug, Clone)]
pub(crate) struct Limits {
    /// Least and largest speed of each axis.
    speeds: [[f32; 2]; 3],
    /// Change of speed within a step of the model.
    pub(crate) step: [Reach; 3],
    /// Change of speed within a cycle of the controller.
    pub(crate) cycle: [Reach; 3],
    /// Smallest radius of a car, m.
    radius: Option<f32>,
    /// Whether accelerations have limits.
    accelerates: bool,
    /// Whether the first command of a sequence is the one in force.
    shifts: bool,
}

impl Limits {
    pub(crate) fn new(params: &MppiParams, shifts: bool) -> Self {
        let reach = |dt: f64| {
            let [x, y] = [[params.ax_max, params.ax_min], [params.ay_max, params.ay_min]];
            [x, y, [params.az_max, -params.az_max]]
                .map(|[gain, loss]| Reach { gain: (dt * gain) as f32, loss: (dt * loss) as f32 })
        };
        Self {
            speeds: [
                [params.vx_min as f32, params.vx_max as f32],
                [-params.vy_max as f32, params.vy_max as f32],
                [-params.wz_max as f32, params.wz_max as f32],
            ],
            step: reach(params.model_dt),
            cycle: reach(params.period_s()),
            radius: match params.motion_model {
                MotionModel::Ackermann { min_turning_r } => Some(min_turning_r as f32),
                MotionModel::DiffDrive | MotionModel::Omni => None,
            },
            accelerates: !params.humble,
            shifts,
        }
    }

    /// The speed to reckon with, given the last command and the measured speed: the command, as far as the base can have got to it.
    pub(crate) fn speed_now(&self, last: Command, measured: Command) -> Command {
        let mut speed = last;
        for ((speed, measured), reach) in speed.iter_mut().zip(measured).zip(&self.cycle) {
            *speed = speed.max(measured + reach.loss).min(measured + reach.gain);
        }
        speed
    }

    /// Brings the first command to the speed now, before noise is added to it.
    pub(crate) fn begin(&self, sequence: &mut Sequence, speed: Command) {
        if !self.accelerates {
            return;
        }
        for ((axis, speed), reach) in sequence.axes_mut().into_iter().zip(speed).zip(&self.cycle) {
            if let Some(first) = axis.first_mut() {
                *first = if self.shifts { speed } else { reach.bound(*first, speed) };
            }
        }
    }

    /// Brings every command within the limits, of which the given share is allowed.
    pub(crate) fn bound(&self, sequence: &mut Sequence, speed: Command, share: f32) {
        if !self.accelerates {
            for (axis, limits) in sequence.axes_mut().into_iter().zip(&self.speeds) {
                let [least, most] = limits.map(|limit| share * limit);
                axis.iter_mut().for_each(|value| *value = value.max(least).min(most));
            }
            self.turn(sequence);
            return;
        }
        self.turn(sequence);
        let axes = sequence.axes_mut().into_iter().zip(speed);
        for ((axis, speed), ((limits, step), cycle)) in axes.zip(self.speeds.iter().zip(&self.step).zip(&self.cycle)) {
            let [least, most] = limits.map(|limit| share * limit);
            let mut values = axis.iter_mut();
            if self.shifts
                && let Some(first) = values.next()
            {
                *first = speed;
            }
            let mut last = speed;
            for (number, value) in values.enumerate() {
                let reach = if number == 0 { cycle } else { step };
                *value = reach.bound(value.max(least).min(most), last);
                last = *value;
            }
        }
        self.turn(sequence);
    }

    /// A car turns no tighter than its radius.
    fn turn(&self, sequence: &mut Sequence) {
        let Some(radius) = self.radius else { return };
        for (vx, wz) in sequence.vx.iter().zip(&mut sequence.wz) {
            let most = vx.abs() / radius;
            *wz = wz.max(-most).min(most);
        }
    }
}

impl Reach {
    /// The value as far as it can be reached from a speed.
    fn bound(self, value: f32, from: f32) -> f32 {
        let (least, most) =
            if from >= 0.0 { (from + self.loss, from + self.gain) } else { (from - self.gain, from - self.loss) };
        value.max(least).min(most)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn limits(change: impl FnOnce(&mut MppiParams), shifts: bool) -> Limits {
        let mut params = MppiParams { ax_max: 2.0, ax_min: -4.0, ..MppiParams::default() };
        change(&mut params);
        Limits::new(&params, shifts)
    }

    fn sequence(vx: &[f32]) -> Sequence {
        Sequence { vx: vx.to_vec(), ..Sequence::zeros(vx.len()) }
    }

    fn near(found: &[f32], wanted: &[f32]) {
        assert!(found.iter().zip(wanted).all(|(found, wanted)| (found - wanted).abs() < 1e-6), "{found:?} {wanted:?}");
    }

    #[test]
    fn commands_get_no_farther_than_speed_and_acceleration_allow() {
        let mut found = sequence(&[0.9, 0.9, 0.9, 0.9, -0.9, -0.9, -0.9, -0.9]);
        limits(|_| (), true).bound(&mut found, [0.3, 0.0, 0.0], 1.0);
        // Braking through zero has the limit of braking, then that of speeding up.
        near(&found.vx, &[0.3, 0.4, 0.5, 0.5, 0.3, 0.1, -0.1, -0.2]);
    }

    #[test]
    fn without_shifting_the_first_command_is_the_next_one() {
        let mut found = sequence(&[0.9, 0.9, 0.9]);
        // 40 Hz: the first step is 0.025 s, the others 0.05 s.
        limits(|params| params.controller_frequency = 40.0, false).bound(&mut found, [0.3, 0.0, 0.0], 1.0);
        near(&found.vx, &[0.35, 0.45, 0.5]);
    }

    #[test]
    fn nav2_humble_knows_no_acceleration() {
        let mut found = sequence(&[0.9, -0.9]);
        limits(|params| params.humble = true, true).bound(&mut found, [0.0; 3], 1.0);
        near(&found.vx, &[0.5, -0.35]);
    }

    #[test]
    fn a_share_of_the_limits_is_a_limit() {
        let mut found = sequence(&[0.25, 0.3, 0.3]);
        limits(|_| (), true).bound(&mut found, [0.25, 0.0, 0.0], 0.5);
        near(&found.vx, &[0.25, 0.25, 0.25]);
        let mut back = sequence(&[-0.3, -0.3]);
        limits(|params| params.humble = true, true).bound(&mut back, [0.0; 3], 0.5);
        near(&back.vx, &[-0.175, -0.175]);
    }

    #[test]
    fn a_car_turns_no_tighter_than_its_radius() {
        let car = |params: &mut MppiParams| params.motion_model = MotionModel::Ackermann { min_turning_r: 0.5 };
        let mut found = Sequence { vx: vec![0.2; 30], vy: vec![0.0; 30], wz: vec![-1.9; 30] };
        limits(car, true).bound(&mut found, [0.2, 0.0, 0.0], 1.0);
        assert!(found.wz.iter().all(|wz| (-0.4..=0.4).contains(wz)), "{:?}", found.wz);
        near(&found.wz[10..], &[-0.4; 20]);
    }

    #[test]
    fn the_speed_now_is_the_last_command_as_far_as_the_base_can_have_followed() {
        let limits = limits(|_| (), true);
        near(&limits.speed_now([0.5, 0.0, 0.0], [0.3, 0.0, 0.0]), &[0.4, 0.0, 0.0]);
        near(&limits.speed_now([0.0, 0.0, 0.0], [0.3, 0.0, 0.0]), &[0.1, 0.0, 0.0]);
        near(&limits.speed_now([0.35, 0.0, 0.1], [0.3, 0.0, 0.0]), &[0.35, 0.0, 0.1]);
    }

    #[test]
    fn the_first_command_begins_at_the_speed_now() {
        let mut found = sequence(&[0.5, 0.5]);
        limits(|_| (), true).begin(&mut found, [0.1, 0.0, 0.2]);
        near(&[found.vx[0], found.vx[1], found.wz[0]], &[0.1, 0.5, 0.2]);
        let mut found = sequence(&[0.5, 0.5]);
        limits(|_| (), false).begin(&mut found, [0.1, 0.0, 0.0]);
        near(&found.vx, &[0.2, 0.5]);
    }
}
