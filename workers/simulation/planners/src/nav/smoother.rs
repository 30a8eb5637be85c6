//! Limits of speed and acceleration, after the controller.

use crate::controller::Twist;

/// Parameters of the velocity smoother; defaults are Nav2's and the paper's. It works open loop: from its own last command.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SmootherParams {
    /// Largest speed forward, m/s, to the left, m/s, and of turning, rad/s; default 0.5, 0, 2.5. It caps what the controller may
    /// think of as its own largest speed.
    pub max_velocity: [f64; 3],
    /// Largest speeds the other way, below 0; default -0.5, 0, -2.5.
    pub min_velocity: [f64; 3],
    /// Largest acceleration, m/s² and rad/s²; default 2.5, 0, 3.2.
    pub max_accel: [f64; 3],
    /// Largest braking, below 0; default -2.5, 0, -3.2.
    pub max_decel: [f64; 3],
    /// So long after the last command the robot is stopped, s; default 1.
    pub velocity_timeout: f64,
}

impl Default for SmootherParams {
    fn default() -> Self {
        Self {
            max_velocity: [0.5, 0.0, 2.5],
            min_velocity: [-0.5, 0.0, -2.5],
            max_accel: [2.5, 0.0, 3.2],
            max_decel: [-2.5, 0.0, -3.2],
            velocity_timeout: 1.0,
        }
    }
}

/// The velocity smoother.
#[derive(Debug, Default)]
pub struct VelocitySmoother {
    params: SmootherParams,
    wanted: [f64; 3],
    wanted_s: f64,
    last: [f64; 3],
}

impl VelocitySmoother {
    /// A smoother of a robot that stands.
    #[must_use]
    pub fn new(params: &SmootherParams) -> Self {
        Self { params: *params, wanted: [0.0; 3], wanted_s: f64::NEG_INFINITY, last: [0.0; 3] }
    }

    /// The next command, `dt_s` after the one before. Without a wanted speed the last one holds until the timeout.
    pub fn smooth(&mut self, wanted: Option<Twist>, now_s: f64, dt_s: f64) -> Twist {
        if let Some(wanted) = wanted {
            self.wanted = [wanted.vx, wanted.vy, wanted.omega];
            self.wanted_s = now_s;
        } else if now_s - self.wanted_s > self.params.velocity_timeout {
            self.wanted = [0.0; 3];
        }
        let SmootherParams { max_velocity, min_velocity, max_accel, max_decel, .. } = self.params;
        let speeds = max_velocity.iter().zip(&min_velocity);
        let changes = max_accel.iter().zip(&max_decel);
        for (((last, wanted), (most, least)), (accel, decel)) in
            self.last.iter_mut().zip(&self.wanted).zip(speeds).zip(changes)
        {
            let wanted = wanted.min(*most).max(*least);
            // Braking is towards 0, whichever way the robot moves.
            let faster = wanted.abs() >= last.abs() && wanted * *last >= 0.0;
            let (up, down) = if faster { (*accel, -*accel) } else { (-*decel, *decel) };
            *last += (wanted - *last).min(up * dt_s).max(down * dt_s);
        }
        let [vx, vy, omega] = self.last;
        Twist { vx, vy, omega }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn speeds_and_their_changes_keep_to_the_limits() {
        let mut smoother = VelocitySmoother::new(&SmootherParams::default());
        let fast = Twist { vx: 1.0, vy: 0.4, omega: -9.0 };
        let mut last = Twist::default();
        for step in 1..=60 {
            let now = smoother.smooth(Some(fast), 0.05 * f64::from(step), 0.05);
            assert!((now.vx - last.vx).abs() <= 0.125 + 1e-12 && (now.omega - last.omega).abs() <= 0.16 + 1e-12);
            last = now;
        }
        assert!((last.vx - 0.5).abs() < 1e-12 && last.vy == 0.0 && (last.omega + 2.5).abs() < 1e-12, "{last:?}");
        let brakes = smoother.smooth(Some(Twist::default()), 3.05, 0.05);
        assert!((brakes.vx - 0.375).abs() < 1e-12, "{brakes:?}");
    }

    #[test]
    fn without_commands_the_last_one_holds_for_a_second() {
        let mut smoother = VelocitySmoother::new(&SmootherParams::default());
        smoother.smooth(Some(Twist { vx: 0.3, ..Twist::default() }), 0.0, 1.0);
        assert!((smoother.smooth(None, 0.9, 0.1).vx - 0.3).abs() < 1e-12);
        assert!((smoother.smooth(None, 1.1, 1.0).vx).abs() < 1e-12);
    }
}
