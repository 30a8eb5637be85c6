//! Several tests at once.

/// Probabilities adjusted for how many there are, in the order given (Holm 1979).
#[must_use]
pub fn holm(p: &[f64]) -> Vec<f64> {
    let mut order: Vec<(usize, f64)> = p.iter().copied().enumerate().collect();
    order.sort_by(|a, b| a.1.total_cmp(&b.1));
    let mut found = vec![0.0; p.len()];
    let mut largest = 0.0_f64;
    for (rank, (at, value)) in order.iter().enumerate() {
        largest = largest.max((value * super::float(p.len() - rank)).min(1.0));
        if let Some(cell) = found.get_mut(*at) {
            *cell = largest;
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::holm;

    #[test]
    fn adjusted_values_never_fall_in_the_order_of_the_raw_ones() {
        let found = holm(&[0.01, 0.04, 0.03, 0.005]);
        let right = [0.03, 0.06, 0.06, 0.02];
        assert!(found.iter().zip(right).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
        assert_eq!(holm(&[0.6, 0.7]), [1.0, 1.0]);
    }
}
