//! The linear mixed model of a balanced table.

use nalgebra::DMatrix;

use super::squares::Squares;
use super::{NoValue, dist, float};

/// The linear model with one random intercept per person, by restricted maximum likelihood.
#[derive(Debug, Clone, PartialEq)]
pub struct Balanced {
    /// Mean of the first condition, then each other condition less the first.
    pub effects: Vec<f64>,
    /// Standard error of a difference of two conditions.
    pub error: f64,
    /// Variance between people, at least 0.
    pub between: f64,
    /// Variance within people.
    pub within: f64,
    /// F of the conditions, its degrees of freedom and p.
    pub f: (f64, f64, f64, f64),
}

/// The mixed model of a complete table of people (rows) by conditions (columns). In a balanced table it has a closed form, and its F
/// is that of the analysis of variance with repeated measures (Searle, Casella and McCulloch 1992, chapter 4).
///
/// # Errors
/// Fewer than two people or conditions; no variance.
pub fn balanced_mixed(table: &DMatrix<f64>) -> Result<Balanced, NoValue> {
    let (rows, columns) = table.shape();
    if rows < 2 || columns < 2 {
        return Err(NoValue::TooFew { what: "people or conditions", found: rows.min(columns), needed: 2 });
    }
    let (n, k) = (float(rows), float(columns));
    let Squares { total, rows: people, columns: conditions } = Squares::of(table);
    let (mut df, mut within) = ((n - 1.0) * (k - 1.0), total - people - conditions);
    let mut between = (people / (n - 1.0) - within / df) / k;
    if between < 0.0 {
        // The likelihood is largest without a difference between people.
        (between, within, df) = (0.0, within + people, df + n - 1.0);
    }
    let within = within / df;
    if within < 1e-12 {
        return Err(NoValue::Constant);
    }
    let means: Vec<f64> = table.column_iter().map(|column| column.mean()).collect();
    let first = means.first().copied().unwrap_or(f64::NAN);
    let effects = means.iter().enumerate().map(|(at, mean)| if at == 0 { *mean } else { mean - first }).collect();
    let f = conditions / (k - 1.0) / within;
    let f = (f, k - 1.0, df, dist::f_upper(f, k - 1.0, df));
    Ok(Balanced { effects, error: libm::sqrt(2.0 * within / n), between, within, f })
}
