//! Looking at every sample only where it can matter: from a distance, nothing is reached before so much way is done.

use socrates_model::Point;

/// Way up to each point, m.
pub(crate) fn arcs<'a>(points: impl Iterator<Item = &'a Point>) -> Vec<f64> {
    let mut arc = 0.0;
    let mut before: Option<&Point> = None;
    points
        .map(|point| {
            arc += before.map_or(0.0, |before| (point - before).norm());
            before = Some(point);
            arc
        })
        .collect()
}

/// The next index at which something `far` away can be reached by those whose ways these are, m; a little sooner, so
/// that rounding decides nothing.
pub(crate) fn next<const N: usize>(arcs: [&[f64]; N], index: usize, far: f64) -> usize {
    let done = |index: usize| -> f64 { arcs.iter().filter_map(|arcs| arcs.get(index)).sum() };
    let (from, all) = (done(index), arcs.iter().map(|arcs| arcs.len()).min().unwrap_or(0));
    let needed = far - 1e-6;
    // Doubling steps, then halving: most ways ahead are short against the whole.
    let mut step = 1;
    while index + step < all && done(index + step) - from < needed {
        step *= 2;
    }
    let (mut low, mut high) = (index + step / 2, (index + step).min(all));
    while high - low > 1 {
        let middle = usize::midpoint(low, high);
        if done(middle) - from < needed { low = middle } else { high = middle }
    }
    high.max(index + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_left_out_that_could_be_reached() {
        let points: Vec<Point> = (0..50).map(|k| Point::new(f64::from(k * k) * 0.1, 0.0)).collect();
        let arcs = arcs(points.iter());
        for index in 0..50 {
            for far in [-1.0, 0.0, 0.05, 0.3, 2.0, 20.0, 1e9] {
                let wanted = (index + 1..50).find(|k| arcs[*k] - arcs[index] >= far - 1e-6).unwrap_or(50);
                assert_eq!(next([&arcs], index, far), wanted.max(index + 1), "from {index}, {far} m");
                assert_eq!(next([&arcs, &arcs], index, 2.0 * far - 1e-6), wanted.max(index + 1), "from {index}");
            }
        }
    }
}
