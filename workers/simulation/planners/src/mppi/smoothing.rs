//! Savitzky and Golay's smoothing of a control sequence.
//!
//! A parabola (or a mean) is fitted through nine commands. To the left of the first stand the last four commands that were sent, to the
//! right of the last its repetition. The last command stays as it is, and so does a sequence of 20 commands or fewer.

use super::params::SgfOrder;
use super::sequence::{Command, Sequence};

/// Commands on either side of the one that is smoothed.
const SIDE: usize = 4;
/// Sequences of at most so many commands are left alone.
const SHORT: usize = 20;
/// Weights of a parabola through nine values (Savitzky and Golay 1964), and their sum.
const PARABOLA: [f32; 9] = [-21.0, 14.0, 39.0, 54.0, 59.0, 54.0, 39.0, 14.0, -21.0];
const PARABOLA_SUM: f32 = 231.0;

/// Smooths sequences.
#[derive(Debug, Clone, Default)]
pub(crate) struct Smoother {
    /// The last commands, oldest first.
    history: [Command; SIDE],
    /// One axis with what stands on either side of it.
    padded: Vec<f32>,
}

impl Smoother {
    /// Forgets the last commands.
    pub(crate) fn reset(&mut self) {
        self.history = Default::default();
    }

    /// Takes over a command.
    pub(crate) fn push(&mut self, command: Command) {
        self.history.rotate_left(1);
        if let Some(last) = self.history.last_mut() {
            *last = command;
        }
    }

    /// Smooths a sequence.
    pub(crate) fn smooth(&mut self, sequence: &mut Sequence, order: SgfOrder) {
        let (weights, sum) = match order {
            SgfOrder::One => ([1.0; 9], 9.0),
            SgfOrder::Two => (PARABOLA, PARABOLA_SUM),
        };
        for (axis, values) in sequence.axes_mut().into_iter().enumerate() {
            let Some((last, rest)) = values.split_last_mut().filter(|(_, rest)| rest.len() >= SHORT) else { return };
            self.padded.clear();
            self.padded.extend(self.history.iter().filter_map(|command| command.get(axis)));
            self.padded.extend_from_slice(rest);
            self.padded.extend([*last; SIDE + 1]);
            for (value, window) in rest.iter_mut().zip(self.padded.windows(weights.len())) {
                *value = window.iter().zip(weights).map(|(value, weight)| value * weight).sum::<f32>() / sum;
            }
        }
    }

    /// Where the memory is and how much of it there is, so that a test sees that none is taken.
    #[cfg(test)]
    pub(crate) fn memory(&self) -> (usize, usize) {
        (self.padded.as_ptr() as usize, self.padded.capacity())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noisy(steps: u16) -> Sequence {
        let wave = |step: u16| 0.3 + 0.1 * f32::from(step.wrapping_mul(40_503) % 1000) / 1000.0;
        let axis = || (0..steps).map(wave).collect();
        Sequence { vx: axis(), vy: axis(), wz: axis() }
    }

    fn deviation(values: &[f32]) -> f32 {
        let mean = values.iter().sum::<f32>() / values.len() as f32;
        values.iter().map(|value| (value - mean).abs()).sum()
    }

    #[test]
    fn smoothing_brings_every_axis_nearer_to_its_mean() {
        for order in [SgfOrder::One, SgfOrder::Two] {
            let (before, mut after) = (noisy(56), noisy(56));
            let mut smoother = Smoother::default();
            (0..4).for_each(|_| smoother.push([0.35; 3]));
            smoother.smooth(&mut after, order);
            for (before, after) in before.axes().into_iter().zip(after.axes()) {
                assert!(deviation(after) < 0.7 * deviation(before), "{order:?}");
                assert_eq!(before[55].to_bits(), after[55].to_bits(), "the last stays");
            }
        }
    }

    #[test]
    fn a_parabola_is_kept_and_short_sequences_are_left_alone() {
        let parabola = |step: i16| 0.01 * f32::from(step * step) - 0.1 * f32::from(step);
        let axis: Vec<f32> = (0..30).map(parabola).collect();
        let mut sequence = Sequence { vx: axis.clone(), vy: axis.clone(), wz: axis.clone() };
        let mut smoother = Smoother::default();
        (-4..0).for_each(|step| smoother.push([parabola(step); 3]));
        smoother.smooth(&mut sequence, SgfOrder::Two);
        let kept = sequence.vx.iter().zip(&axis).take(26);
        assert!(kept.into_iter().all(|(found, wanted)| (found - wanted).abs() < 1e-5));
        let mut short = noisy(20);
        smoother.smooth(&mut short, SgfOrder::Two);
        assert_eq!(short, noisy(20));
    }

    #[test]
    fn the_history_holds_the_last_four_commands() {
        let mut smoother = Smoother::default();
        (1..=6_u8).for_each(|number| smoother.push([f32::from(number), 0.0, 0.0]));
        assert_eq!(smoother.history.map(|command| command[0] as u8), [3, 4, 5, 6]);
        let mut sequence = Sequence { vx: vec![6.0; 56], ..Sequence::zeros(56) };
        smoother.smooth(&mut sequence, SgfOrder::One);
        assert!((sequence.vx[0] - (3.0 + 4.0 + 5.0 + 6.0 * 6.0) / 9.0).abs() < 1e-6);
        smoother.reset();
        assert_eq!(smoother.history, [[0.0; 3]; 4]);
    }
}
