//! Dynamic time warping of two tracks.

use crate::{StatsError, finite, float};

/// How far two tracks of points are from each other when time may run unevenly: the least weighted mean distance of
/// points that are matched in order (Sakoe and Chiba 1978, symmetric form: a step in both tracks weighs 2, in one 1, over
/// the number of points of both). In the unit of the points; 0 for tracks that differ in nothing but their pace.
///
/// # Errors
/// A track without points, or a point that is not finite.
pub fn time_warp(one: &[[f64; 2]], other: &[[f64; 2]]) -> Result<f64, StatsError> {
    finite(one.as_flattened(), 2)?;
    finite(other.as_flattened(), 2)?;
    let mut before: Vec<f64> = Vec::new();
    for (row, a) in one.iter().enumerate() {
        let mut now: Vec<f64> = Vec::with_capacity(other.len());
        for (column, b) in other.iter().enumerate() {
            let apart = (a[0] - b[0]).hypot(a[1] - b[1]);
            let left = now.last().map(|cost| cost + apart);
            let above = before.get(column).map(|cost| cost + apart);
            let both = column.checked_sub(1).and_then(|column| before.get(column)).map(|cost| cost + 2.0 * apart);
            let first = (row == 0 && column == 0).then_some(2.0 * apart);
            let least = [left, above, both, first].into_iter().flatten().reduce(f64::min);
            now.push(least.unwrap_or(f64::INFINITY));
        }
        before = now;
    }
    Ok(before.last().copied().unwrap_or(f64::INFINITY) / float(one.len() + other.len()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(xs: &[f64], y: f64) -> Vec<[f64; 2]> {
        xs.iter().map(|x| [*x, y]).collect()
    }

    #[test]
    fn pace_makes_no_difference_and_a_way_aside_is_as_far_as_it_is_aside() {
        let (even, waits) = (line(&[0., 1., 2., 3.], 0.), line(&[0., 1., 1., 1., 2., 3., 3.], 0.));
        assert!(time_warp(&even, &waits).unwrap() < 1e-12);
        assert!((time_warp(&even, &line(&[0., 1., 2., 3.], 2.)).unwrap() - 2.0).abs() < 1e-12);
    }

    #[test]
    fn the_weights_are_those_of_the_symmetric_form() {
        // Points 0 1 2 against 0 3: 0 with 0 (2 times 0), 1 with 0 (1), 2 with 3 (2 times 1): 3 over 5 points.
        let (a, b) = (line(&[0., 1., 2.], 0.), line(&[0., 3.], 0.));
        assert!((time_warp(&a, &b).unwrap() - 3.0 / 5.0).abs() < 1e-12);
        assert!((time_warp(&b, &a).unwrap() - 3.0 / 5.0).abs() < 1e-12);
        assert!(time_warp(&a, &[]).is_err() && time_warp(&a, &[[f64::NAN, 0.0]]).is_err());
    }
}
