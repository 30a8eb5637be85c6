//! What the benches of this crate share.

/// The clock, and the lines that every bench prints first.
#[path = "../../../../../tests/machine.rs"]
pub(crate) mod machine;

/// The middle of several numbers.
pub(crate) fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    numbers.get(numbers.len() / 2).copied().unwrap_or(f64::NAN)
}
