//! "For so long without a break" in one pass: sliding minima by a monotone queue.

use std::collections::VecDeque;

/// One sample of a margin: how far the condition holds (positive) or fails at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Mark {
    /// Time, s.
    pub t: f64,
    /// Margin.
    pub margin: f64,
    /// Way travelled so far by whoever has to move, m; constant where nobody has to.
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

/// Best stretch of `for_s` over all in which at least `travel_m` were travelled: the largest of the
/// smallest margins, in one pass (Lemire 2006). `None` when no stretch is that long.
pub(super) fn held(marks: impl IntoIterator<Item = Mark>, for_s: f64, travel_m: f64) -> Option<Held> {
    // Queue of candidates for the minimum, margins rising from front to back.
    let mut minima: VecDeque<(f64, f64)> = VecDeque::new();
    let mut window: VecDeque<(f64, f64)> = VecDeque::new();
    let mut start = None;
    let mut best: Option<Held> = None;
    for Mark { t, margin, arc_m } in marks {
        let begun = *start.get_or_insert(t);
        while minima.back().is_some_and(|(_, other)| *other >= margin) {
            minima.pop_back();
        }
        minima.push_back((t, margin));
        window.push_back((t, arc_m));
        while minima.front().is_some_and(|(old, _)| *old < t - for_s - 1e-9) {
            minima.pop_front();
        }
        while window.front().is_some_and(|(old, _)| *old < t - for_s - 1e-9) {
            window.pop_front();
        }
        if t - begun < for_s - 1e-9 {
            continue;
        }
        let (Some((_, smallest)), Some((from, arc_from))) = (minima.front(), window.front()) else { continue };
        if arc_m - arc_from < travel_m {
            continue;
        }
        let first_s = best.and_then(|held| held.first_s).or_else(|| (*smallest >= 0.0).then_some(*from));
        best = Some(match best {
            Some(held) if held.margin >= *smallest => Held { first_s, ..held },
            _ => Held { margin: *smallest, best_s: *from, first_s },
        });
    }
    best
}

/// Maximal stretches of at least `for_s` in which the margin is not negative: `(from s, to s)`.
pub(super) fn stretches(marks: impl IntoIterator<Item = Mark>, for_s: f64) -> Vec<(f64, f64)> {
    let mut found: Vec<(f64, f64)> = Vec::new();
    let mut open: Option<(f64, f64)> = None;
    for mark in marks {
        if mark.margin >= 0.0 {
            open = Some((open.map_or(mark.t, |(from, _)| from), mark.t));
        } else if let Some(stretch) = open.take() {
            found.push(stretch);
        }
    }
    found.extend(open);
    found.retain(|(from, to)| to - from >= for_s - 1e-9);
    found
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
