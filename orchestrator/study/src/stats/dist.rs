//! Distribution functions, from `statrs`.

use statrs::distribution::{ChiSquared, ContinuousCDF as _, FisherSnedecor, Normal, StudentsT};

/// Upper tail of chi square.
pub(crate) fn chi_upper(value: f64, df: f64) -> f64 {
    ChiSquared::new(df).map_or(f64::NAN, |law| law.sf(value.max(0.0)))
}

/// Probability of a normal value at least as far from 0 on either side.
pub(crate) fn normal_two_sided(z: f64) -> f64 {
    Normal::new(0.0, 1.0).map_or(f64::NAN, |law| (2.0 * law.sf(libm::fabs(z))).min(1.0))
}

/// Normal distribution function.
pub(super) fn normal_cdf(z: f64) -> f64 {
    Normal::new(0.0, 1.0).map_or(f64::NAN, |law| law.cdf(z))
}

/// Normal quantile.
pub(super) fn normal_quantile(p: f64) -> f64 {
    Normal::new(0.0, 1.0).map_or(f64::NAN, |law| law.inverse_cdf(p))
}

/// Upper tail of Student's t.
pub(super) fn t_upper(t: f64, df: f64) -> f64 {
    StudentsT::new(0.0, 1.0, df).map_or(f64::NAN, |law| law.sf(t))
}

/// Quantile of Student's t.
pub(crate) fn t_quantile(p: f64, df: f64) -> f64 {
    StudentsT::new(0.0, 1.0, df).map_or(f64::NAN, |law| law.inverse_cdf(p))
}

/// Upper tail of F.
pub(super) fn f_upper(value: f64, df1: f64, df2: f64) -> f64 {
    FisherSnedecor::new(df1, df2).map_or(f64::NAN, |law| law.sf(value.max(0.0)))
}

/// Quantile of F, by bisection of the distribution function.
pub(super) fn f_quantile(p: f64, df1: f64, df2: f64) -> f64 {
    let Ok(law) = FisherSnedecor::new(df1, df2) else { return f64::NAN };
    let (mut low, mut high) = (0.0, 1.0);
    while law.cdf(high) < p && high < 1e12 {
        high *= 2.0;
    }
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if law.cdf(middle) < p { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}
