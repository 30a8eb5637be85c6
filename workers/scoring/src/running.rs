//! Statistics of a curve while its samples come.
//!
//! A [`Pen`] turns samples into the straight pieces between them; each statistic takes the pieces one by one and can
//! be asked at any time. [`crate::Series`] gives its pieces to the same statistics, so that a curve that is whole and
//! one that grows have the same figures, to the last bit.

use crate::series::Span;

/// The straight piece between two neighboring samples: `(t0, v0, t1, v1)`.
pub(crate) type Piece = (f64, f64, f64, f64);

/// Joins each sample to the one before; a hole (no value, or none that is finite) ends the curve, and the next sample
/// begins it anew.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Pen {
    last: Option<(f64, f64)>,
}

impl Pen {
    /// The piece up to a sample, if there is one.
    pub(crate) fn to(&mut self, t: f64, value: Option<f64>) -> Option<Piece> {
        let now = value.filter(|value| value.is_finite()).map(|value| (t, value));
        let before = std::mem::replace(&mut self.last, now);
        before.zip(now).map(|((t0, v0), (t1, v1))| (t0, v0, t1, v1))
    }
}

/// The smallest value.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Least(Option<f64>);

impl Least {
    pub(crate) fn add(&mut self, value: Option<f64>) {
        if let Some(value) = value.filter(|value| value.is_finite())
            && self.0.is_none_or(|least| value < least)
        {
            self.0 = Some(value);
        }
    }

    pub(crate) const fn value(&self) -> Option<f64> {
        self.0
    }
}

/// Length, integral and mean over time.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Mean {
    pen: Pen,
    ends: Option<(f64, f64)>,
    holed: bool,
    seconds: f64,
    area: f64,
}

impl Mean {
    pub(crate) fn add(&mut self, t: f64, value: Option<f64>) {
        self.holed |= value.is_none_or(|value| !value.is_finite());
        self.ends = Some((self.ends.map_or(t, |(first, _)| first), t));
        if let Some((t0, v0, t1, v1)) = self.pen.to(t, value) {
            self.seconds += t1 - t0;
            self.area += (t1 - t0) * (v0 + v1) / 2.0;
        }
    }

    /// Length of the curve without its holes, s. Without holes it is that from end to end, free of the rounding of a
    /// sum.
    pub(crate) fn length_s(&self) -> f64 {
        if self.holed { self.seconds } else { self.ends.map_or(0.0, |(first, last)| last - first) }
    }

    /// Integral by the trapezoid rule.
    pub(crate) const fn integral(&self) -> f64 {
        self.area
    }

    /// Mean over time; `None` for a curve of no length.
    pub(crate) fn mean(&self) -> Option<f64> {
        let length = self.length_s();
        (length > 0.0).then(|| self.area / length)
    }
}

/// Seconds below a level, crossings interpolated.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Below {
    level: f64,
    seconds: f64,
}

impl Below {
    pub(crate) const fn level(level: f64) -> Self {
        Self { level, seconds: 0.0 }
    }

    pub(crate) fn add(&mut self, piece: Option<Piece>) {
        if let Some(span) = piece.and_then(|piece| below(piece, self.level)) {
            self.seconds += span.length_s();
        }
    }

    pub(crate) const fn seconds(&self) -> f64 {
        self.seconds
    }
}

/// Area between a level and the curve where that is below it: depth times time.
#[derive(Debug, Clone, Copy)]
pub(crate) struct AreaBelow {
    level: f64,
    area: f64,
}

impl AreaBelow {
    pub(crate) const fn level(level: f64) -> Self {
        Self { level, area: 0.0 }
    }

    pub(crate) fn add(&mut self, piece: Option<Piece>) {
        let Some((t0, v0, t1, v1)) = piece else { return };
        let Some(span) = below((t0, v0, t1, v1), self.level) else { return };
        let deep = |t: f64| self.level - if t1 > t0 { v0 + (v1 - v0) * (t - t0) / (t1 - t0) } else { v0 };
        self.area += span.length_s() * (deep(span.from_s) + deep(span.to_s)) / 2.0;
    }

    pub(crate) const fn area(&self) -> f64 {
        self.area
    }
}

/// Mean of one curve while another with the same times is below a level.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MeanWhileBelow {
    below: Below,
    area: f64,
}

impl MeanWhileBelow {
    pub(crate) const fn level(level: f64) -> Self {
        Self { below: Below::level(level), area: 0.0 }
    }

    /// Takes the pieces of both curves between the same two samples.
    pub(crate) fn add(&mut self, piece: Option<Piece>, other: Option<Piece>) {
        let Some(((t0, v0, t1, v1), other)) = piece.zip(other) else { return };
        let Some(span) = below(other, self.below.level) else { return };
        let at = |t: f64| if t1 > t0 { v0 + (v1 - v0) * (t - t0) / (t1 - t0) } else { v0 };
        self.area += span.length_s() * (at(span.from_s) + at(span.to_s)) / 2.0;
        self.below.seconds += span.length_s();
    }

    pub(crate) const fn seconds(&self) -> f64 {
        self.below.seconds
    }

    pub(crate) fn mean(&self) -> Option<f64> {
        (self.seconds() > 0.0).then(|| self.area / self.seconds())
    }
}

/// Maximal stretches below a level. A stretch ends only when the curve has been above `level + rearm` for `rearm_s`
/// (or for good), so that a flutter is one stretch.
#[derive(Debug, Clone)]
pub(crate) struct Stretches {
    level: f64,
    rearm: f64,
    rearm_s: f64,
    found: Vec<Span>,
    clear_since: Option<f64>,
    last_s: Option<f64>,
}

impl Stretches {
    pub(crate) const fn below(level: f64, rearm: f64, rearm_s: f64) -> Self {
        Self { level, rearm, rearm_s, found: Vec::new(), clear_since: None, last_s: None }
    }

    /// When a new stretch begins in the piece, s.
    pub(crate) fn add(&mut self, piece: Option<Piece>) -> Option<f64> {
        let (t0, v0, t1, v1) = piece?;
        // Up to the first stretch nothing above the level is worth remembering.
        if self.found.is_empty() && v0 >= self.level && v1 >= self.level {
            return None;
        }
        let mut begins = None;
        // A hole ends every stretch.
        if self.last_s.is_some_and(|last| last < t0) {
            self.clear_since = Some(f64::NEG_INFINITY);
        }
        self.last_s = Some(t1);
        if let Some(span) = below((t0, v0, t1, v1), self.level) {
            let armed = self.clear_since.is_some_and(|since| span.from_s - since >= self.rearm_s);
            match self.found.last_mut() {
                Some(last) if !armed => last.to_s = span.to_s,
                _ => {
                    self.found.push(span);
                    begins = Some(span.from_s);
                }
            }
            self.clear_since = None;
        }
        let clear = self.level + self.rearm;
        if v1 >= clear {
            self.clear_since.get_or_insert(if v0 >= clear { t0 } else { t1 });
        } else if v1 >= self.level && self.rearm > 0.0 && self.clear_since.is_some() {
            self.clear_since = None;
        }
        begins
    }

    pub(crate) fn spans(&self) -> &[Span] {
        &self.found
    }

    pub(crate) fn into_spans(self) -> Vec<Span> {
        self.found
    }
}

/// The part of a piece that lies below a level.
fn below((t0, v0, t1, v1): Piece, level: f64) -> Option<Span> {
    match (v0 < level, v1 < level) {
        (true, true) => Some(Span { from_s: t0, to_s: t1 }),
        (false, false) => None,
        (starts_below, _) => {
            let cross = t0 + (t1 - t0) * (level - v0) / (v1 - v0);
            Some(if starts_below { Span { from_s: t0, to_s: cross } } else { Span { from_s: cross, to_s: t1 } })
        }
    }
}
