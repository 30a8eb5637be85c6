//! Minima of smooth functions of some tens of variables.

use nalgebra::{DMatrix, DVector};

/// A function with its slope; infinite where it is not defined.
pub(super) type Sloped<'f> = dyn Fn(&DVector<f64>) -> (f64, DVector<f64>) + 'f;

/// Second derivatives by central differences of the slope.
#[expect(clippy::indexing_slicing, reason = "indices run over the sizes of the matrices that are made here")]
pub(super) fn curvature(f: &Sloped<'_>, at: &DVector<f64>) -> DMatrix<f64> {
    let n = at.len();
    let mut found = DMatrix::zeros(n, n);
    let mut x = at.clone();
    for i in 0..n {
        let h = 1e-5 * at[i].abs().max(1.0);
        x[i] = at[i] + h;
        let up = f(&x).1;
        x[i] = at[i] - h;
        let down = f(&x).1;
        x[i] = at[i];
        found.set_column(i, &((up - down) / (2.0 * h)));
    }
    let turned = found.transpose();
    (found + turned) * 0.5
}

/// The place of a minimum near `start`, by the quasi-Newton method of Broyden, Fletcher, Goldfarb and Shanno with halved steps
/// (Nocedal and Wright 2006, chapter 6). The function is infinite where it is not defined. None where no descent ends.
pub(super) fn minimum(f: &Sloped<'_>, start: DVector<f64>) -> Option<DVector<f64>> {
    let n = start.len();
    let mut at = start;
    let (mut value, mut gradient) = f(&at);
    if !value.is_finite() {
        return None;
    }
    let mut inverse = DMatrix::identity(n, n) * 0.05;
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
            let (there, after) = f(&next);
            if there <= value + 1e-4 * length * fall {
                reached = Some((next, there, after));
                break;
            }
            length *= 0.5;
        }
        // Rounding hides a further fall: this is the minimum where the slope is small.
        let Some((next, there, after)) = reached else { return (gradient.amax() < 1e-2).then_some(at) };
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
            return (gradient.amax() < 1e-2).then_some(at);
        }
    }
    (gradient.amax() < 1e-2).then_some(at)
}
