//! Minima of smooth functions of some tens of variables.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// Slope at a minimum, at most.
const FLAT: f64 = 1e-6;

/// A function's value with its slope and its second derivatives; the value is infinite where the function is not defined.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Bent {
    pub(super) value: f64,
    pub(super) slope: DVector<f64>,
    pub(super) bend: DMatrix<f64>,
}

/// The place of a minimum near `start`, by Newton's steps that are halved until the value falls; where the function is bent downwards,
/// the steps lean towards the steepest descent (Nocedal and Wright 2006, chapters 3.3 and 3.4). None where no descent ends.
pub(super) fn minimum(f: &dyn Fn(&DVector<f64>) -> Bent, start: DVector<f64>) -> Option<(DVector<f64>, Bent)> {
    let (mut at, mut here) = (start.clone(), f(&start));
    for _ in 0..100 {
        if !here.value.is_finite() || here.slope.amax() < 1e-11 {
            break;
        }
        let step = -upwards(&here.bend)?.solve(&here.slope);
        let fall = step.dot(&here.slope);
        let mut length = 1.0;
        let mut reached = None;
        for _ in 0..50 {
            let next = &at + &step * length;
            let there = f(&next);
            // Near the minimum rounding hides the fall of the value, and the slope tells.
            let is_close = (there.value - here.value).abs() < 1e-9 * (1.0 + here.value.abs());
            let is_flatter = is_close && there.slope.amax() < 0.9 * here.slope.amax();
            if there.value.is_finite() && (there.value <= here.value + 1e-4 * length * fall || is_flatter) {
                reached = Some((next, there));
                break;
            }
            length *= 0.5;
        }
        let Some((next, there)) = reached else { break };
        (at, here) = (next, there);
    }
    (here.value.is_finite() && here.slope.amax() < FLAT).then_some((at, here))
}

/// Second derivatives with so much added to their diagonal that they bend upwards everywhere.
fn upwards(bend: &DMatrix<f64>) -> Option<Cholesky<f64, Dyn>> {
    let most = bend.diagonal().amax().max(1e-8);
    let mut more = 0.0;
    while more < 1e6 {
        let lifted = bend + DMatrix::identity(bend.nrows(), bend.ncols()) * (more * most);
        if let Some(found) = lifted.cholesky() {
            return Some(found);
        }
        more = if more > 0.0 { 4.0 * more } else { 1e-4 };
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_valley_that_bends_downwards_at_the_start_is_left() {
        // x⁴ − x² + (y − 1)²: bent downwards at x = 0.1, with minima at x = ±√½.
        let valley = |at: &DVector<f64>| {
            let (x, y) = (at[0], at[1]);
            Bent {
                value: x.powi(4) - x * x + (y - 1.0) * (y - 1.0),
                slope: DVector::from_vec(vec![4.0 * x.powi(3) - 2.0 * x, 2.0 * (y - 1.0)]),
                bend: DMatrix::from_row_slice(2, 2, &[12.0 * x * x - 2.0, 0.0, 0.0, 2.0]),
            }
        };
        let (at, _) = minimum(&valley, DVector::from_vec(vec![0.1, 5.0])).unwrap();
        assert!((at[0] - 0.5_f64.sqrt()).abs() < 1e-9 && (at[1] - 1.0).abs() < 1e-9, "{at}");
        let slope = |at: &DVector<f64>| Bent {
            value: at[0],
            slope: DVector::from_vec(vec![1.0]),
            bend: DMatrix::from_row_slice(1, 1, &[0.0]),
        };
        assert_eq!(minimum(&slope, DVector::from_vec(vec![0.0])), None, "no descent of a plane ends");
    }
}
