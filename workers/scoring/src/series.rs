//! A quantity over time, straight between its samples.
//!
//! Every time share, crossing and mean is computed on the piecewise-linear curve and not on the
//! samples, so that a recording at 10 Hz and one at 100 Hz give the same figures.

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
    fn pieces(&self) -> impl Iterator<Item = (f64, f64, f64, f64)> + '_ {
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
        self.pieces().map(|(t0, v0, t1, v1)| (t1 - t0) * (v0 + v1) / 2.0).sum()
    }

    /// Mean over time; `None` for a curve of no length.
    #[must_use]
    pub fn mean(&self) -> Option<f64> {
        let length = self.length_s();
        (length > 0.0).then(|| self.integral() / length)
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
        self.pieces().map(|piece| below(piece, level)).map(|span| span.map_or(0.0, |s| s.length_s())).sum()
    }

    /// Whether no value is below a level.
    fn stays_above(&self, level: f64) -> bool {
        self.least.is_none_or(|(_, least)| least >= level)
    }

    /// Mean of the curve's level while another curve with the same times is below a level.
    #[must_use]
    pub fn mean_while_below(&self, other: &Self, level: f64) -> Option<f64> {
        let (mut area, mut seconds) = (0.0, 0.0);
        if other.stays_above(level) {
            return None;
        }
        let pairs = |series: &'_ Self| series.samples.len().saturating_sub(1);
        for index in 0..pairs(self).min(pairs(other)) {
            let (Some([(t0, v0), (t1, v1)]), Some([(u0, w0), (u1, w1)])) =
                (self.samples.get(index..index + 2), other.samples.get(index..index + 2))
            else {
                break;
            };
            if [v0, v1, w0, w1].iter().any(|value| value.is_nan()) {
                continue;
            }
            let Some(span) = below((*u0, *w0, *u1, *w1), level) else { continue };
            let (t0, v0, t1, v1) = (*t0, *v0, *t1, *v1);
            let at = |t: f64| if t1 > t0 { v0 + (v1 - v0) * (t - t0) / (t1 - t0) } else { v0 };
            area += span.length_s() * (at(span.from_s) + at(span.to_s)) / 2.0;
            seconds += span.length_s();
        }
        (seconds > 0.0).then(|| area / seconds)
    }

    /// Maximal stretches below a level. A stretch ends only when the curve has been above
    /// `level + rearm` for `rearm_s` (or for good), so that a flutter is one stretch.
    #[must_use]
    pub fn stretches_below(&self, level: f64, rearm: f64, rearm_s: f64) -> Vec<Span> {
        let mut found: Vec<Span> = Vec::new();
        if self.stays_above(level) {
            return found;
        }
        let mut clear_since: Option<f64> = None;
        let mut last_s: Option<f64> = None;
        for piece in self.pieces() {
            let (t0, v0, t1, v1) = piece;
            // A hole ends every stretch.
            if self.holed && last_s.is_some_and(|last| last < t0) {
                clear_since = Some(f64::NEG_INFINITY);
            }
            last_s = Some(t1);
            if let Some(span) = below(piece, level) {
                let armed = clear_since.is_some_and(|since| span.from_s - since >= rearm_s);
                match found.last_mut() {
                    Some(last) if !armed => last.to_s = span.to_s,
                    _ => found.push(span),
                }
                clear_since = None;
            }
            if v1 >= level + rearm {
                clear_since.get_or_insert(if v0 >= level + rearm { t0 } else { t1 });
            } else if v1 >= level && rearm > 0.0 && clear_since.is_some() {
                clear_since = None;
            }
        }
        found
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
            if self.time_below(middle) < wanted { low = middle } else { high = middle }
        }
        Some(high)
    }
}

/// The part of a piece that lies below a level.
fn below((t0, v0, t1, v1): (f64, f64, f64, f64), level: f64) -> Option<Span> {
    match (v0 < level, v1 < level) {
        (true, true) => Some(Span { from_s: t0, to_s: t1 }),
        (false, false) => None,
        (starts_below, _) => {
            let cross = t0 + (t1 - t0) * (level - v0) / (v1 - v0);
            Some(if starts_below { Span { from_s: t0, to_s: cross } } else { Span { from_s: cross, to_s: t1 } })
        }
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
