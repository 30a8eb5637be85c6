//! How far raters agree where not everybody rated everything.

use std::collections::BTreeMap;

use super::{NoValue, float};

/// What distances between answers mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Level {
    /// Answers are equal or not.
    Nominal,
    /// Answers have an order.
    Ordinal,
    /// Distances between answers can be compared.
    Interval,
}

/// Krippendorff's alpha of units, each with the answers that it got (Krippendorff 2019, chapter 12). Units with one answer are left
/// out; 1 is agreement, 0 chance.
///
/// # Errors
/// Fewer than two units with two answers; all answers alike.
pub fn krippendorff(units: &[Vec<f64>], level: Level) -> Result<f64, NoValue> {
    let paired: Vec<&Vec<f64>> = units.iter().filter(|unit| unit.len() > 1).collect();
    if paired.len() < 2 {
        return Err(NoValue::TooFew { what: "units with two answers", found: paired.len(), needed: 2 });
    }
    let mut values: Vec<f64> = paired.iter().flat_map(|unit| unit.iter().copied()).collect();
    values.sort_by(f64::total_cmp);
    let mut counts: Vec<(f64, f64)> = Vec::new();
    for value in &values {
        match counts.last_mut() {
            Some((last, count)) if last.total_cmp(value).is_eq() => *count += 1.0,
            Some(_) | None => counts.push((*value, 1.0)),
        }
    }
    if counts.len() < 2 {
        return Err(NoValue::Constant);
    }
    // Place of each value on an axis on which ordinal distances are plain differences: the middle of its ranks.
    let mut axis: BTreeMap<u64, f64> = BTreeMap::new();
    let mut below = 0.0;
    for (value, count) in &counts {
        axis.insert(value.to_bits(), if level == Level::Ordinal { below + count / 2.0 } else { *value });
        below += count;
    }
    let place = |value: &f64| axis.get(&value.to_bits()).copied().unwrap_or(f64::NAN);
    let distance = |a: f64, b: f64| match level {
        Level::Nominal => f64::from(u8::from(!a.total_cmp(&b).is_eq())),
        Level::Ordinal | Level::Interval => (a - b) * (a - b),
    };
    let mut observed = 0.0;
    for unit in &paired {
        let places: Vec<f64> = unit.iter().map(place).collect();
        let pairs: f64 = places.iter().map(|a| places.iter().map(|b| distance(*a, *b)).sum::<f64>()).sum();
        observed += pairs / (float(unit.len()) - 1.0);
    }
    let n = float(values.len());
    let spots: Vec<(f64, f64)> = counts.iter().map(|(value, count)| (place(value), *count)).collect();
    let expected: f64 =
        spots.iter().map(|(a, ca)| spots.iter().map(|(b, cb)| ca * cb * distance(*a, *b)).sum::<f64>()).sum();
    Ok(1.0 - (n - 1.0) * observed / expected)
}

/// Cohen's kappa of two raters with quadratic weights (Cohen 1968).
///
/// # Errors
/// Fewer than two pairs; all answers alike.
pub fn weighted_kappa(pairs: &[(f64, f64)]) -> Result<f64, NoValue> {
    if pairs.len() < 2 {
        return Err(NoValue::TooFew { what: "pairs", found: pairs.len(), needed: 2 });
    }
    let square = |a: f64, b: f64| (a - b) * (a - b);
    let observed: f64 = pairs.iter().map(|(a, b)| square(*a, *b)).sum::<f64>() / float(pairs.len());
    let chance: f64 = pairs.iter().map(|(a, _)| pairs.iter().map(|(_, b)| square(*a, *b)).sum::<f64>()).sum();
    let chance = chance / float(pairs.len() * pairs.len());
    if chance < 1e-12 { Err(NoValue::Constant) } else { Ok(1.0 - observed / chance) }
}
