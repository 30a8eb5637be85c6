//! A quantity over time, straight between its samples.
//!
//! Every time share, crossing and mean is computed on the piecewise-linear curve and not on the
//! samples, so that a recording at 10 Hz and one at 100 Hz give the same figures.

use crate::running::{Below, Mean, MeanWhileBelow, Pen, Piece, Stretches};

/// Samples of one quantity. Times rise; values are finite, or NaN where there is none: a hole.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Series {
    samples: Vec<(f64, f64)>,
    /// Whether there is a hole.
    holed: bool,
    /// Time and value of the smallest value.
    least: Option<(f64, f64)>,
}

/// A stretch of time, s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    /// First moment, s.
    pub from_s: f64,
    /// Last moment, s.
    pub to_s: f64,
}

impl Span {
    /// Length, s.
    #[must_use]
    pub fn length_s(&self) -> f64 {
        self.to_s - self.from_s
    }
}

impl FromIterator<(f64, f64)> for Series {
    fn from_iter<I: IntoIterator<Item = (f64, f64)>>(samples: I) -> Self {
        let samples: Vec<_> = samples.into_iter().filter(|(t, v)| t.is_finite() && v.is_finite()).collect();
        let least = smallest(&samples);
        Self { samples, holed: false, least }
    }
}

/// `None` is a hole: the curve ends before it and begins anew after it.
impl FromIterator<(f64, Option<f64>)> for Series {
    fn from_iter<I: IntoIterator<Item = (f64, Option<f64>)>>(samples: I) -> Self {
        let mut holed = false;
        let samples: Vec<_> = samples
            .into_iter()
            .filter(|(t, _)| t.is_finite())
            .map(|(t, value)| {
                let value = value.filter(|value| value.is_finite());
                holed |= value.is_none();
                (t, value.unwrap_or(f64::NAN))
            })
            .collect();
        let least = smallest(&samples);
        Self { samples, holed, least }
    }
}

/// The first of the smallest values, with its time.
fn smallest(samples: &[(f64, f64)]) -> Option<(f64, f64)> {
    let mut least: Option<(f64, f64)> = None;
    for (t, value) in samples {
        // Comparisons with NaN are false, so holes never win.
        if *value < least.map_or(f64::INFINITY, |(_, least)| least) {
            least = Some((*t, *value));
        }
    }
    least
}

impl Series {
    /// The samples, `(time s, value)`, NaN in a hole.
    #[must_use]
    pub fn samples(&self) -> &[(f64, f64)] {
        &self.samples
    }

    /// The pieces between neighboring samples: `(t0, v0, t1, v1)`; none in a hole.
    fn pieces(&self) -> impl Iterator<Item = Piece> + '_ {
        self.samples
            .iter()
            .zip(self.samples.iter().skip(1))
            .filter(|((_, v0), (_, v1))| !self.holed || !(v0.is_nan() || v1.is_nan()))
            .map(|((t0, v0), (t1, v1))| (*t0, *v0, *t1, *v1))
    }

    /// Length of the whole curve without its holes, s.
    #[must_use]
    pub fn length_s(&self) -> f64 {
        if self.holed {
            return self.pieces().map(|(t0, _, t1, _)| t1 - t0).sum();
        }
        match (self.samples.first(), self.samples.last()) {
            (Some((from, _)), Some((to, _))) => to - from,
            _ => 0.0,
        }
    }

    /// Smallest value with its time.
    #[must_use]
    pub fn least(&self) -> Option<(f64, f64)> {
        self.least
    }

    /// Largest value with its time.
    #[must_use]
    pub fn greatest(&self) -> Option<(f64, f64)> {
        self.samples.iter().copied().filter(|(_, value)| !value.is_nan()).max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Integral over time by the trapezoid rule.
    #[must_use]
    pub fn integral(&self) -> f64 {
        self.averaged().integral()
    }

    /// Mean over time; `None` for a curve of no length.
    #[must_use]
    pub fn mean(&self) -> Option<f64> {
        self.averaged().mean()
    }

    fn averaged(&self) -> Mean {
        let mut mean = Mean::default();
        for (t, value) in &self.samples {
            mean.add(*t, Some(*value));
        }
        mean
    }

    /// The curve with every value changed.
    #[must_use]
    pub fn map(&self, change: impl Fn(f64) -> f64) -> Self {
        self.samples.iter().map(|(t, v)| (*t, (!v.is_nan()).then(|| change(*v)))).collect()
    }

    /// Seconds for which the curve is below a level, crossings interpolated.
    #[must_use]
    pub fn time_below(&self, level: f64) -> f64 {
        if self.stays_above(level) {
            return 0.0;
        }
        let mut below = Below::level(level);
        for piece in self.pieces() {
            below.add(Some(piece));
        }
        below.seconds()
    }

    /// Whether no value is below a level.
    fn stays_above(&self, level: f64) -> bool {
        self.least.is_none_or(|(_, least)| least >= level)
    }

    /// Mean of the curve's level while another curve with the same times is below a level.
    #[must_use]
    pub fn mean_while_below(&self, other: &Self, level: f64) -> Option<f64> {
        if other.stays_above(level) {
            return None;
        }
        let mut found = MeanWhileBelow::level(level);
        let (mut mine, mut theirs) = (Pen::default(), Pen::default());
        for ((t, value), (u, level)) in self.samples.iter().zip(&other.samples) {
            found.add(mine.to(*t, Some(*value)), theirs.to(*u, Some(*level)));
        }
        found.mean()
    }

    /// Maximal stretches below a level. A stretch ends only when the curve has been above
    /// `level + rearm` for `rearm_s` (or for good), so that a flutter is one stretch.
    #[must_use]
    pub fn stretches_below(&self, level: f64, rearm: f64, rearm_s: f64) -> Vec<Span> {
        let mut found = Stretches::below(level, rearm, rearm_s);
        if !self.stays_above(level) {
            for piece in self.pieces() {
                found.add(Some(piece));
            }
        }
        found.into_spans()
    }

    /// The value below which the curve is for a share of the time, 0 to 1, to a millionth of the curve's range.
    #[must_use]
    pub fn time_quantile(&self, share: f64) -> Option<f64> {
        let ((_, mut low), (_, mut high)) = (self.least?, self.greatest()?);
        let wanted = share * self.length_s();
        let fine = 1e-6 * (high - low);
        // The time below a level rises with the level.
        while high - low > fine.max(1e-12) {
            let middle = f64::midpoint(low, high);
            if middle <= low || middle >= high {
                // Neighbors among floats: between large values there is nothing finer.
                break;
            }
            if self.time_below(middle) < wanted { low = middle } else { high = middle }
        }
        Some(high)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn vee(step: usize) -> Series {
        // |t - 5| over ten seconds.
        (0..=100)
            .step_by(step)
            .map(|k| f64::from(u8::try_from(k).unwrap()) / 10.0)
            .map(|t| (t, (t - 5.0).abs()))
            .collect()
    }

    #[test]
    fn a_coarse_curve_gives_the_same_times_as_a_fine_one() {
        for step in [1, 5, 10] {
            assert!((vee(step).time_below(2.25) - 4.5).abs() < 1e-9, "step {step}");
            assert!((vee(step).mean().unwrap() - 2.5).abs() < 1e-9);
        }
    }

    #[test]
    fn a_flutter_is_one_stretch_and_a_return_is_two() {
        let flutter: Series = [(0.0, 1.0), (1.0, -1.0), (2.0, 0.02), (3.0, -1.0), (4.0, 1.0)].into_iter().collect();
        assert_eq!(flutter.stretches_below(0.0, 0.05, 0.5).len(), 1);
        let twice: Series =
            [(0.0, 1.0), (1.0, -1.0), (2.0, 1.0), (4.0, 1.0), (5.0, -1.0), (6.0, 1.0)].into_iter().collect();
        assert_eq!(twice.stretches_below(0.0, 0.05, 0.5).len(), 2);
    }

    #[test]
    fn quantiles_are_weighted_by_time() {
        let curve: Series = [(0.0, 1.0), (9.0, 1.0), (9.0, 5.0), (10.0, 5.0)].into_iter().collect();
        assert!((curve.time_quantile(0.5).unwrap() - 1.0).abs() < 1e-5);
        assert!((curve.time_quantile(0.95).unwrap() - 5.0).abs() < 1e-5);
        // A slope from 0 to 10 has its share at every level.
        let slope: Series = [(0.0, 0.0), (4.0, 10.0)].into_iter().collect();
        assert!((slope.time_quantile(0.05).unwrap() - 0.5).abs() < 1e-5);
    }

    #[test]
    fn a_hole_is_no_time_and_ends_a_stretch() {
        let curve: Series = [(0.0, Some(-1.0)), (1.0, Some(-1.0)), (2.0, None), (3.0, Some(-2.0)), (5.0, Some(-2.0))]
            .into_iter()
            .collect();
        assert!((curve.length_s() - 3.0).abs() < 1e-12 && (curve.time_below(0.0) - 3.0).abs() < 1e-12);
        assert_eq!(curve.stretches_below(0.0, 0.05, 0.5).len(), 2);
        assert_eq!((curve.least(), curve.greatest()), (Some((3.0, -2.0)), Some((1.0, -1.0))));
        assert!((curve.mean().unwrap() + 5.0 / 3.0).abs() < 1e-12);
        assert!((curve.mean_while_below(&curve, 0.0).unwrap() + 5.0 / 3.0).abs() < 1e-12);
        assert!((curve.time_quantile(0.5).unwrap() + 2.0).abs() < 1e-5);
    }
}
