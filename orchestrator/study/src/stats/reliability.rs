//! How well items agree with each other, and raters with each other: alpha, omega, intraclass correlations.

use nalgebra::{DMatrix, DVector};

use super::rank::pearson;
use super::squares::Squares;
use super::{NoValue, dist, float};

/// Cronbach's alpha and what belongs to it.
#[derive(Debug, Clone, PartialEq)]
pub struct Alpha {
    /// Alpha.
    pub alpha: f64,
    /// Its 95 % interval (Feldt, Woodruff and Salih 1987).
    pub interval: (f64, f64),
    /// Alpha of standardized items.
    pub standardized: f64,
    /// Of each item: its correlation with the sum of the others, and alpha without it (none with two items).
    pub items: Vec<(f64, Option<f64>)>,
}

fn covariance(rows: &DMatrix<f64>) -> DMatrix<f64> {
    let mut centered = rows.clone();
    for mut column in centered.column_iter_mut() {
        let mean = column.sum() / float(column.len());
        column.add_scalar_mut(-mean);
    }
    centered.tr_mul(&centered) / (float(rows.nrows()) - 1.0)
}

#[expect(clippy::indexing_slicing, reason = "indices run over the sizes of the matrices that are made here")]
fn correlation(covariance: &DMatrix<f64>) -> DMatrix<f64> {
    let sd = covariance.diagonal().map(libm::sqrt);
    DMatrix::from_fn(covariance.nrows(), covariance.ncols(), |i, j| covariance[(i, j)] / (sd[i] * sd[j]))
}

fn alpha_of(covariance: &DMatrix<f64>) -> f64 {
    let k = float(covariance.nrows());
    k / (k - 1.0) * (1.0 - covariance.trace() / covariance.sum())
}

fn checked(rows: &DMatrix<f64>, items: usize) -> Result<DMatrix<f64>, NoValue> {
    if rows.nrows() < 3 {
        return Err(NoValue::TooFew { what: "complete answers", found: rows.nrows(), needed: 3 });
    }
    if rows.ncols() < items {
        return Err(NoValue::TooFew { what: "items", found: rows.ncols(), needed: items });
    }
    let covariance = covariance(rows);
    if covariance.diagonal().iter().any(|variance| *variance < 1e-12) || libm::fabs(covariance.sum()) < 1e-12 {
        return Err(NoValue::Constant);
    }
    Ok(covariance)
}

/// Cronbach's alpha of complete answers (rows) to items (columns), reversed items already turned round (Cronbach 1951).
///
/// # Errors
/// Fewer than three rows or two items, or an item that everybody answered alike.
#[expect(clippy::indexing_slicing, reason = "indices run over the sizes of the matrices that are made here")]
pub fn cronbach(rows: &DMatrix<f64>) -> Result<Alpha, NoValue> {
    let covariance = checked(rows, 2)?;
    let (n, k) = (float(rows.nrows()), rows.ncols());
    let alpha = alpha_of(&covariance);
    let (df1, df2) = (n - 1.0, (n - 1.0) * (float(k) - 1.0));
    let end = |p: f64| 1.0 - (1.0 - alpha) * dist::f_quantile(p, df1, df2);
    let items = (0..k).map(|item| {
        let own: Vec<f64> = rows.column(item).iter().copied().collect();
        let rest: Vec<f64> = rows.row_iter().map(|row| row.sum() - row[item]).collect();
        let less = covariance.clone().remove_row(item).remove_column(item);
        (pearson(&own, &rest).unwrap_or(f64::NAN), (k > 2).then(|| alpha_of(&less)))
    });
    let items = items.collect();
    Ok(Alpha { alpha, interval: (end(0.975), end(0.025)), standardized: alpha_of(&correlation(&covariance)), items })
}

/// McDonald's omega total by one factor, fitted to the correlations by maximum likelihood (McDonald 1999; Rubin and Thayer 1982 for
/// the fit). An item's own variance is at least 0.005.
///
/// # Errors
/// Fewer than three rows or three items, or an item that everybody answered alike.
#[expect(clippy::indexing_slicing, reason = "indices run over the sizes of the matrices that are made here")]
pub fn omega(rows: &DMatrix<f64>) -> Result<f64, NoValue> {
    let r = correlation(&checked(rows, 3)?);
    let k = r.nrows();
    let mut own = DVector::from_element(k, 0.5);
    let mut loading = own.map(libm::sqrt);
    for _ in 0..20_000 {
        // One factor f ~ N(0, 1): regression of f on the items, then of the items on f.
        let scaled = loading.component_div(&own);
        let weight = &scaled / (1.0 + scaled.dot(&loading));
        let with_items = &r * &weight;
        let second = 1.0 - weight.dot(&loading) + weight.dot(&with_items);
        let next = &with_items / second;
        let far = (&next - &loading).amax();
        own = DVector::from_fn(k, |i, _| (r[(i, i)] - next[i] * with_items[i]).max(0.005));
        loading = next;
        if far < 1e-13 {
            break;
        }
    }
    let common = loading.sum() * loading.sum();
    Ok(common / (common + own.sum()))
}

/// An intraclass correlation with its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Icc {
    /// The estimate.
    pub value: f64,
    /// Lower and upper end.
    pub interval: (f64, f64),
}

/// Intraclass correlations of one rater, and of the mean of all of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Iccs {
    /// ICC(1): raters are not told apart.
    pub one: Icc,
    /// ICC(A,1): absolute agreement.
    pub agreement: Icc,
    /// ICC(C,1): consistency.
    pub consistency: Icc,
    /// ICC(1,k).
    pub one_k: Icc,
    /// ICC(A,k).
    pub agreement_k: Icc,
    /// ICC(C,k).
    pub consistency_k: Icc,
    /// F of the targets, its degrees of freedom and p.
    pub f: (f64, f64, f64, f64),
}

/// Intraclass correlations of a complete table of targets (rows) by raters (columns) (Shrout and Fleiss 1979; McGraw and Wong 1996).
///
/// # Errors
/// Fewer than two targets or raters; no variance.
pub fn icc(table: &DMatrix<f64>) -> Result<Iccs, NoValue> {
    let (rows, columns) = table.shape();
    if rows < 2 || columns < 2 {
        return Err(NoValue::TooFew { what: "targets or raters", found: rows.min(columns), needed: 2 });
    }
    let (n, k) = (float(rows), float(columns));
    let Squares { total, rows: between, columns: raters } = Squares::of(table);
    if total < 1e-12 {
        return Err(NoValue::Constant);
    }
    let (msr, msc) = (between / (n - 1.0), raters / (k - 1.0));
    let mse = ((total - between - raters) / ((n - 1.0) * (k - 1.0))).max(1e-300);
    let msw = (total - between) / (n * (k - 1.0));
    let (df1, df2) = (n - 1.0, (n - 1.0) * (k - 1.0));
    let q = dist::f_quantile;
    let many = |one: f64| one * k / (1.0 + one * (k - 1.0));
    // By one F alone: ICC(1) and ICC(C,1).
    let by_f = |f: f64, df2: f64| {
        let (low, high) = (f / q(0.975, df1, df2), f * q(0.975, df2, df1));
        let single = |f: f64| (f - 1.0) / (f + k - 1.0);
        let mean = |f: f64| 1.0 - 1.0 / f;
        (
            Icc { value: single(f), interval: (single(low), single(high)) },
            Icc { value: mean(f), interval: (mean(low), mean(high)) },
        )
    };
    let (one, one_k) = by_f(msr / msw, n * (k - 1.0));
    let (consistency, consistency_k) = by_f(msr / mse, df2);
    let value = (msr - mse) / (msr + (k - 1.0) * mse + k * (msc - mse) / n);
    let fj = msc / mse;
    let part = n * (1.0 + (k - 1.0) * value) - k * value;
    let upper = df2 * (k * value * fj + part) * (k * value * fj + part);
    let v = upper / (df1 * k * k * value * value * fj * fj + part * part);
    let (high, low) = (q(0.975, df1, v), q(0.975, v, df1));
    let rest = k * msc + (k * n - k - n) * mse;
    let interval = (n * (msr - high * mse) / (high * rest + n * msr), n * (low * msr - mse) / (rest + n * low * msr));
    let agreement = Icc { value, interval };
    let agreement_k =
        Icc { value: (msr - mse) / (msr + (msc - mse) / n), interval: (many(interval.0), many(interval.1)) };
    let f = msr / mse;
    let f = (f, df1, df2, dist::f_upper(f, df1, df2));
    Ok(Iccs { one, agreement, consistency, one_k, agreement_k, consistency_k, f })
}
