//! Minima of smooth functions of some tens of variables.

use nalgebra::{DMatrix, DVector};

/// Slope by central differences.
#[expect(clippy::indexing_slicing, reason = "indices run over the sizes of the matrices that are made here")]
fn slope(f: &dyn Fn(&DVector<f64>) -> f64, at: &DVector<f64>) -> DVector<f64> {
    let mut x = at.clone();
    DVector::from_fn(at.len(), |i, _| {
        let h = 1e-5 * at[i].abs().max(1.0);
        x[i] = at[i] + h;
        let up = f(&x);
        x[i] = at[i] - h;
        let down = f(&x);
        x[i] = at[i];
        (up - down) / (2.0 * h)
    })
}

/// Second derivatives by central differences.
#[expect(clippy::indexing_slicing, reason = "indices run over the sizes of the matrices that are made here")]
pub(super) fn curvature(f: &dyn Fn(&DVector<f64>) -> f64, at: &DVector<f64>) -> DMatrix<f64> {
    let n = at.len();
    let step = |i: usize| 2e-4 * at[i].abs().max(1.0);
    let mut found = DMatrix::zeros(n, n);
    let mut x = at.clone();
    let middle = f(at);
    for i in 0..n {
        let hi = step(i);
        x[i] = at[i] + hi;
        let up = f(&x);
        x[i] = at[i] - hi;
        let down = f(&x);
        x[i] = at[i];
        found[(i, i)] = (up - 2.0 * middle + down) / (hi * hi);
        for j in 0..i {
            let hj = step(j);
            let mut corner = |si: f64, sj: f64| {
                x[i] = at[i] + si * hi;
                x[j] = at[j] + sj * hj;
                let value = f(&x);
                x[i] = at[i];
                x[j] = at[j];
                value
            };
            let mixed = corner(1.0, 1.0) - corner(1.0, -1.0) - corner(-1.0, 1.0) + corner(-1.0, -1.0);
            found[(i, j)] = mixed / (4.0 * hi * hj);
            found[(j, i)] = found[(i, j)];
        }
    }
    found
}

/// The place of a minimum near `start`, by the quasi-Newton method of Broyden, Fletcher, Goldfarb and Shanno with halved steps
/// (Nocedal and Wright 2006, chapter 6). The function is infinite where it is not defined. None where no descent ends.
pub(super) fn minimum(f: &dyn Fn(&DVector<f64>) -> f64, start: DVector<f64>) -> Option<DVector<f64>> {
    let n = start.len();
    let mut at = start;
    let mut value = f(&at);
    if !value.is_finite() {
        return None;
    }
    let mut inverse = DMatrix::identity(n, n) * 0.05;
    let mut gradient = slope(f, &at);
    for turn in 0..500 {
        if gradient.amax() < 1e-7 {
            return Some(at);
        }
        let mut direction = -(&inverse * &gradient);
        if direction.dot(&gradient) >= 0.0 {
            inverse = DMatrix::identity(n, n) * 0.05;
            direction = -(&inverse * &gradient);
        }
        let fall = direction.dot(&gradient);
        let mut length = 1.0;
        let mut reached = None;
        for _ in 0..40 {
            let next = &at + &direction * length;
            let there = f(&next);
            if there <= value + 1e-4 * length * fall {
                reached = Some((next, there));
                break;
            }
            length *= 0.5;
        }
        // Rounding hides a further fall: this is the minimum where the slope is small.
        let Some((next, there)) = reached else { return (gradient.amax() < 1e-3).then_some(at) };
        let after = slope(f, &next);
        let (moved, changed) = (&next - &at, &after - &gradient);
        let along = moved.dot(&changed);
        if along > 1e-14 {
            if turn == 0 {
                inverse = DMatrix::identity(n, n) * (along / changed.dot(&changed));
            }
            let left = DMatrix::identity(n, n) - &moved * changed.transpose() / along;
            inverse = &left * &inverse * left.transpose() + &moved * moved.transpose() / along;
        }
        let small = moved.amax() < 1e-10;
        (at, value, gradient) = (next, there, after);
        if small {
            return (gradient.amax() < 1e-3).then_some(at);
        }
    }
    (gradient.amax() < 1e-3).then_some(at)
}
