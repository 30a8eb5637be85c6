//! Agreement of raters beyond chance.

use std::collections::BTreeMap;

use crate::{StatsError, float};

/// Cohen's kappa of two raters' labels of the same things: `(p_o - p_e) / (1 - p_e)`.
///
/// 1 is full agreement, 0 that of chance. When both use one and the same label throughout, chance
/// agreement is 1 and kappa is taken as 1.
///
/// # Errors
/// No label, or lists of different lengths.
pub fn cohen_kappa<L: Ord>(first: &[L], second: &[L]) -> Result<f64, StatsError> {
    if first.len() != second.len() {
        return Err(StatsError::Unequal { left: first.len(), right: second.len() });
    }
    if first.is_empty() {
        return Err(StatsError::TooFew { found: 0, needed: 1 });
    }
    let n = float(first.len());
    let mut counts: BTreeMap<&L, (usize, usize)> = BTreeMap::new();
    for label in first {
        counts.entry(label).or_default().0 += 1;
    }
    for label in second {
        counts.entry(label).or_default().1 += 1;
    }
    let observed = float(first.iter().zip(second).filter(|(a, b)| a == b).count()) / n;
    let chance: f64 = counts.values().map(|(a, b)| float(*a) / n * float(*b) / n).sum();
    if 1.0 - chance <= f64::EPSILON {
        return Ok(1.0);
    }
    Ok((observed - chance) / (1.0 - chance))
}

/// Krippendorff's alpha for nominal labels: any number of raters, missing labels allowed.
///
/// `units` holds for each thing the labels it was given; things with fewer than two labels count
/// for nothing. `alpha = 1 - D_o / D_e` over coincidences.
///
/// # Errors
/// Fewer than two labels that can be paired.
pub fn krippendorff_alpha<L: Ord>(units: &[Vec<L>]) -> Result<f64, StatsError> {
    let mut totals: BTreeMap<&L, f64> = BTreeMap::new();
    let (mut pairable, mut disagreement) = (0_usize, 0.0);
    for unit in units.iter().filter(|unit| unit.len() >= 2) {
        let mut counts: BTreeMap<&L, usize> = BTreeMap::new();
        for label in unit {
            *counts.entry(label).or_default() += 1;
        }
        let m = float(unit.len());
        pairable += unit.len();
        for (label, count) in counts {
            disagreement += float(count) * (m - float(count)) / (m - 1.0);
            *totals.entry(label).or_default() += float(count);
        }
    }
    if pairable < 2 {
        return Err(StatsError::TooFew { found: pairable, needed: 2 });
    }
    let n = float(pairable);
    let expected: f64 = totals.values().map(|count| count * (n - count)).sum::<f64>() / (n - 1.0);
    Ok(if expected <= 0.0 { 1.0 } else { 1.0 - disagreement / expected })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kappa_of_the_textbook_table_is_0_4() {
        // 20 yes/yes, 5 yes/no, 10 no/yes, 15 no/no: p_o 0.7, p_e 0.5.
        let table = [(true, true, 20), (true, false, 5), (false, true, 10), (false, false, 15)];
        let (mut a, mut b) = (Vec::new(), Vec::new());
        for (left, right, count) in table {
            a.extend(std::iter::repeat_n(left, count));
            b.extend(std::iter::repeat_n(right, count));
        }
        assert!((cohen_kappa(&a, &b).unwrap() - 0.4).abs() < 1e-12);
    }

    #[test]
    fn full_agreement_is_one_and_lists_must_match() {
        assert!((cohen_kappa(&["x", "y"], &["x", "y"]).unwrap() - 1.0).abs() < 1e-12);
        assert!((cohen_kappa(&["x", "x"], &["x", "x"]).unwrap() - 1.0).abs() < 1e-12);
        assert!(cohen_kappa(&["x"], &["x", "y"]).is_err());
    }

    #[test]
    fn alpha_of_the_published_example_with_missing_labels() {
        // Krippendorff 2011, example C: four observers, twelve units; nominal alpha 0.743.
        let units: Vec<Vec<u8>> = vec![
            vec![1, 1, 1],
            vec![2, 2, 3, 2],
            vec![3, 3, 3, 3],
            vec![3, 3, 3, 3],
            vec![2, 2, 2, 2],
            vec![1, 2, 3, 4],
            vec![4, 4, 4, 4],
            vec![1, 1, 2, 1],
            vec![2, 2, 2, 2],
            vec![5, 5, 5],
            vec![1, 1],
            vec![3],
        ];
        assert!((krippendorff_alpha(&units).unwrap() - 0.743).abs() < 5e-4);
    }
}
