//! The cells under a line.

/// Cells of the line between two cells, both included: Bresenham's, so one cell for each step along the longer axis, the one
/// whose middle is nearest to the line.
#[derive(Debug, Clone)]
pub(super) struct Line {
    at: (isize, isize),
    step: (isize, isize),
    /// Cells along the longer and the shorter axis.
    long: isize,
    short: isize,
    /// Whether the longer axis is the rows.
    steep: bool,
    error: isize,
    left: isize,
}

impl Line {
    pub(super) fn new(from: (isize, isize), to: (isize, isize)) -> Self {
        let (across, up) = (to.0 - from.0, to.1 - from.1);
        let steep = up.abs() > across.abs();
        let (long, short) = if steep { (up.abs(), across.abs()) } else { (across.abs(), up.abs()) };
        Self { at: from, step: (across.signum(), up.signum()), long, short, steep, error: long / 2, left: long + 1 }
    }
}

impl Iterator for Line {
    type Item = (isize, isize);

    fn next(&mut self) -> Option<(isize, isize)> {
        if self.left == 0 {
            return None;
        }
        self.left -= 1;
        let here = self.at;
        self.error += self.short;
        let aside = self.error >= self.long && self.long > 0;
        if aside {
            self.error -= self.long;
        }
        if self.steep {
            self.at.1 += self.step.1;
            self.at.0 += if aside { self.step.0 } else { 0 };
        } else {
            self.at.0 += self.step.0;
            self.at.1 += if aside { self.step.1 } else { 0 };
        }
        Some(here)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::costmap::fixture::Chance;

    #[test]
    fn a_line_is_made_of_the_cells_that_a_finely_sampled_line_passes_nearest() {
        let mut chance = Chance::new(5);
        for _ in 0..2000 {
            let mut cell = || (chance.below(61) as isize - 30, chance.below(61) as isize - 30);
            let (from, to) = (cell(), cell());
            let cells: Vec<(isize, isize)> = Line::new(from, to).collect();
            assert_eq!((cells.first(), cells.last()), (Some(&from), Some(&to)));
            let (across, up) = ((to.0 - from.0) as f64, (to.1 - from.1) as f64);
            assert_eq!(cells.len(), across.abs().max(up.abs()) as usize + 1);
            let samples = 4000;
            for (x, y) in &cells {
                let near = (0..=samples).map(|sample| {
                    let share = f64::from(sample) / f64::from(samples);
                    let dx = from.0 as f64 + share * across - *x as f64;
                    let dy = from.1 as f64 + share * up - *y as f64;
                    dx.abs().max(dy.abs())
                });
                let near = near.fold(9.0, f64::min);
                assert!(near <= 0.51, "{from:?} to {to:?}: cell {x}, {y} is {near} off");
            }
            for pair in cells.windows(2) {
                assert!((pair[0].0 - pair[1].0).abs() <= 1 && (pair[0].1 - pair[1].1).abs() <= 1);
            }
        }
    }
}
