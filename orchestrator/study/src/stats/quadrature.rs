//! Gauss–Hermite quadrature.

use nalgebra::{DMatrix, SymmetricEigen};

use super::float;

/// Nodes and weights for `∫ exp(−x²) f(x) dx`, in rising order (Golub and Welsch 1969).
pub(super) fn gauss_hermite(nodes: usize) -> Vec<(f64, f64)> {
    let jacobi =
        DMatrix::from_fn(nodes, nodes, |i, j| if i.abs_diff(j) == 1 { libm::sqrt(float(i.max(j)) / 2.0) } else { 0.0 });
    let eigen = SymmetricEigen::new(jacobi);
    let root = libm::sqrt(std::f64::consts::PI);
    let mut found: Vec<(f64, f64)> = eigen
        .eigenvalues
        .iter()
        .zip(eigen.eigenvectors.row(0).iter())
        .map(|(node, first)| (*node, root * first * first))
        .collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_are_integrated_exactly() {
        let rule = gauss_hermite(10);
        let moment = |power: i32| rule.iter().map(|(x, w)| w * x.powi(power)).sum::<f64>();
        let root = std::f64::consts::PI.sqrt();
        for (power, right) in [(0, 1.0), (2, 0.5), (4, 0.75), (6, 1.875), (8, 6.5625)] {
            assert!((moment(power) / root - right).abs() < 1e-10, "{power}");
        }
        assert!(moment(3).abs() < 1e-10);
    }
}
