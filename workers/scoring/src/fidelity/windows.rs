//! "For so long without a break", by the operators of [`crate::temporal`].
//!
//! On the operators are all monitors that ask for a stretch of time (through [`held`] and [`stretches`]: follows,
//! abreast, parallel, ahead, head-on, blocks, looks, stands still, flow, density, surrounds, converges, and the
//! motion that reactions are seen by), hidden until, order, and the robot's answers to gestures.
//!
//! Not on them, because they need more than how far something holds:
//! - the smallest or largest of one quantity (meets, reaches, starts at, keeps, arrives, stays inside) is an `F` or a
//!   `G` over the whole run, and the evidence names the very sample;
//! - what happens at single events (leaves, enters, door opens, enters last, leaves first, gestures, gives way) has
//!   no samples to look at;
//! - reactions run a clock that stands still while an earlier rule runs; passes and crosses join two places that are
//!   reached at different times; runs away measures a way from each onset; groups ask for a share of the time.

use crate::temporal::{Signal, TIME_SLACK, Within};

/// One sample of a margin: how far the condition holds (positive) or fails at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Mark {
    /// Time, s.
    pub t: f64,
    /// Margin.
    pub margin: f64,
    /// Way traveled so far by whoever has to move, m; constant where nobody has to.
    pub arc_m: f64,
}

impl Mark {
    /// A mark where nobody has to move.
    #[must_use]
    pub(super) const fn new(t: f64, margin: f64) -> Self {
        Self { t, margin, arc_m: 0.0 }
    }
}

/// The best stretch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Held {
    /// Smallest margin inside the best stretch; the robustness of "eventually for so long".
    pub margin: f64,
    /// Start of the best stretch, s.
    pub best_s: f64,
    /// Start of the first stretch that holds throughout, s.
    pub first_s: Option<f64>,
}

/// Best stretch of `for_s` over all in which at least `travel_m` were traveled: the largest of the
/// smallest margins, `F (H[0, for_s] margin)`. `None` when no stretch is that long.
pub(super) fn held(marks: impl IntoIterator<Item = Mark>, for_s: f64, travel_m: f64) -> Option<Held> {
    let marks: Vec<Mark> = marks.into_iter().collect();
    let begun = marks.first()?.t;
    let kept = signal(marks.iter().copied()).historically(Within::secs(for_s));
    // The first mark of the window that ends at each mark: a window has its travel too, which no margin tells.
    let mut window = marks.iter().peekable();
    let mut best: Option<Held> = None;
    for (mark, (t, smallest)) in marks.iter().zip(kept.samples()) {
        while window.next_if(|old| old.t < t - for_s - TIME_SLACK).is_some() {}
        let Some(from) = window.peek() else { continue };
        if t - begun < for_s - TIME_SLACK || mark.arc_m - from.arc_m < travel_m || smallest.is_nan() {
            continue;
        }
        let first_s = best.and_then(|held| held.first_s).or_else(|| (smallest >= 0.0).then_some(from.t));
        best = Some(match best {
            Some(held) if held.margin >= smallest => Held { first_s, ..held },
            _ => Held { margin: smallest, best_s: from.t, first_s },
        });
    }
    best
}

/// Maximal stretches of at least `for_s` in which the margin is not negative: `(from s, to s)`.
pub(super) fn stretches(marks: impl IntoIterator<Item = Mark>, for_s: f64) -> Vec<(f64, f64)> {
    let mut found = signal(marks).stretches();
    found.retain(|(from, to)| to - from >= for_s - TIME_SLACK);
    found
}

/// Length of the longest stretch in which the margin is not negative, s; 0 without any.
pub(super) fn longest_s(marks: impl IntoIterator<Item = Mark>) -> f64 {
    stretches(marks, 0.0).into_iter().map(|(from, to)| to - from).fold(0.0, f64::max)
}

/// The margins as a signal.
fn signal(marks: impl IntoIterator<Item = Mark>) -> Signal {
    marks.into_iter().map(|mark| (mark.t, mark.margin)).collect()
}

/// The mark with the largest margin.
pub(super) fn best(marks: impl IntoIterator<Item = Mark>) -> Option<Mark> {
    marks.into_iter().max_by(|a, b| a.margin.total_cmp(&b.margin))
}

/// The first mark whose margin is not negative.
pub(super) fn first(marks: impl IntoIterator<Item = Mark>) -> Option<Mark> {
    marks.into_iter().find(|mark| mark.margin >= 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn marks(margins: &[f64]) -> Vec<Mark> {
        margins.iter().enumerate().map(|(k, margin)| Mark::new(k as f64 * 0.5, *margin)).collect()
    }

    #[test]
    fn the_sliding_minimum_is_that_of_brute_force() {
        let margins = [0.3, -0.2, 0.4, 0.5, 0.1, 0.6, 0.7, -1.0, 0.2, 0.9, 0.8, 0.9];
        let marks = marks(&margins);
        for n in 1..6 {
            let brute = margins
                .windows(n)
                .map(|window| window.iter().copied().fold(f64::INFINITY, f64::min))
                .fold(f64::NEG_INFINITY, f64::max);
            let found = held(marks.clone(), (n - 1) as f64 * 0.5, 0.0).unwrap();
            assert!((found.margin - brute).abs() < 1e-12, "window of {n}");
        }
    }

    #[test]
    fn the_best_stretch_is_that_of_the_definition_with_uneven_times_and_travel() {
        let mut state = 11_u64;
        let mut draw = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        for _ in 0..200 {
            let (mut t, mut arc_m) = (draw(), 0.0);
            let marks: Vec<Mark> = (0..40)
                .map(|_| {
                    t += 0.05 + 0.1 * (draw() * 4.0).floor();
                    arc_m += draw() * 0.2;
                    Mark { t, margin: (draw() * 9.0).floor() - 3.0, arc_m }
                })
                .collect();
            let (for_s, travel_m) = (draw() * 2.0, draw() * 0.6);
            let mut wanted: Option<Held> = None;
            for end in &marks {
                let window: Vec<&Mark> =
                    marks.iter().filter(|mark| mark.t >= end.t - for_s - 1e-9 && mark.t <= end.t).collect();
                if end.t - marks[0].t < for_s - 1e-9 || end.arc_m - window[0].arc_m < travel_m {
                    continue;
                }
                let margin = window.iter().map(|mark| mark.margin).fold(f64::INFINITY, f64::min);
                let first_s = wanted.and_then(|held| held.first_s).or_else(|| (margin >= 0.0).then_some(window[0].t));
                let better = wanted.is_none_or(|held| margin > held.margin);
                let (margin, best_s) = match wanted {
                    Some(held) if !better => (held.margin, held.best_s),
                    _ => (margin, window[0].t),
                };
                wanted = Some(Held { margin, best_s, first_s });
            }
            assert_eq!(held(marks, for_s, travel_m), wanted);
        }
    }

    #[test]
    fn a_run_shorter_than_the_stretch_holds_nothing() {
        assert_eq!(held(marks(&[1.0, 1.0]), 5.0, 0.0), None);
        assert_eq!(stretches(marks(&[1.0, 1.0, -1.0, 1.0]), 0.5), vec![(0.0, 0.5)]);
    }

    #[test]
    fn a_stretch_without_travel_does_not_count() {
        let still: Vec<Mark> = (0..10).map(|k| Mark { t: f64::from(k), margin: 1.0, arc_m: 3.0 }).collect();
        assert_eq!(held(still, 4.0, 1.0), None);
    }
}
