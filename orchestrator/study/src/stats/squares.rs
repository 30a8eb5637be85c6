//! Sums of squares of a complete table.

use nalgebra::DMatrix;

use super::float;

/// Sums of squares about the mean of all values.
pub(super) struct Squares {
    /// Of all values.
    pub(super) total: f64,
    /// Between the means of rows.
    pub(super) rows: f64,
    /// Between the means of columns.
    pub(super) columns: f64,
}

impl Squares {
    pub(super) fn of(table: &DMatrix<f64>) -> Self {
        let (n, k) = (float(table.nrows()), float(table.ncols()));
        let grand = table.mean();
        let square = |mean: f64| (mean - grand) * (mean - grand);
        Self {
            total: table.iter().map(|value| square(*value)).sum(),
            rows: k * table.row_iter().map(|row| square(row.mean())).sum::<f64>(),
            columns: n * table.column_iter().map(|column| square(column.mean())).sum::<f64>(),
        }
    }
}
