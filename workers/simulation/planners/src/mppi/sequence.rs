//! The control sequence that is optimized.

/// One command per axis: forward and to the left, m/s, turning, rad/s.
pub(crate) type Command = [f32; 3];

/// A command for every step of the horizon.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Sequence {
    /// Forward, m/s.
    pub(crate) vx: Vec<f32>,
    /// To the left, m/s.
    pub(crate) vy: Vec<f32>,
    /// Turning, rad/s.
    pub(crate) wz: Vec<f32>,
}

impl Sequence {
    /// Standing still.
    pub(crate) fn zeros(steps: usize) -> Self {
        Self { vx: vec![0.0; steps], vy: vec![0.0; steps], wz: vec![0.0; steps] }
    }

    /// The axes in the order of a command.
    pub(crate) fn axes_mut(&mut self) -> [&mut Vec<f32>; 3] {
        [&mut self.vx, &mut self.vy, &mut self.wz]
    }

    /// The axes in the order of a command.
    pub(crate) const fn axes(&self) -> [&Vec<f32>; 3] {
        [&self.vx, &self.vy, &self.wz]
    }

    /// Stands still.
    pub(crate) fn reset(&mut self) {
        self.axes_mut().into_iter().for_each(|axis| axis.fill(0.0));
    }

    /// The command of a step; standing where there is none.
    pub(crate) fn command(&self, step: usize) -> Command {
        self.axes().map(|axis| axis.get(step).copied().unwrap_or_default())
    }

    /// One step on: every command moves to the front, the last stays.
    pub(crate) fn shift(&mut self) {
        for axis in self.axes_mut() {
            if axis.len() > 1 {
                axis.copy_within(1.., 0);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shift_moves_every_command_to_the_front_and_repeats_the_last() {
        let mut sequence = Sequence { vx: vec![1.0, 2.0, 3.0], vy: vec![0.0; 3], wz: vec![4.0, 5.0, 6.0] };
        sequence.shift();
        assert_eq!((sequence.vx.as_slice(), sequence.wz.as_slice()), (&[2.0, 3.0, 3.0][..], &[5.0, 6.0, 6.0][..]));
        let mut short = Sequence { vx: vec![1.0], vy: vec![2.0], wz: vec![3.0] };
        short.shift();
        assert_eq!(short.command(0).map(f32::to_bits), [1.0_f32, 2.0, 3.0].map(f32::to_bits));
    }
}
