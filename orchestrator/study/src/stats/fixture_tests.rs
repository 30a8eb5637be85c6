//! The fixture of 16 people, three planners and four items, with what R 4.2.2 (`ordinal`, `lme4`, `psych`, `BradleyTerry2`) and Python
//! (`scipy`, `pingouin`, `krippendorff`) find in it.

use nalgebra::DMatrix;

use super::*;

const A: &str = "5435 3332 2424 1211 2221 4321 3214 5544 1413 3212 5335 3524 2542 2112 4111 1354";
const B: &str = "3342 1343 4424 4353 5343 2532 4435 5555 4234 2353 5545 4545 4444 4432 3334 5544";
const C: &str = "1335 3142 3423 2331 4314 3322 1312 4555 1333 2242 3523 3322 3534 4332 1324 4245";

fn answers(of: &str) -> Vec<Vec<f64>> {
    of.split(' ').map(|one| one.chars().map(|c| f64::from(c.to_digit(10).unwrap())).collect()).collect()
}

/// People by planners, first item.
fn first_item() -> DMatrix<f64> {
    let of = [answers(A), answers(B), answers(C)];
    DMatrix::from_fn(16, 3, |i, j| of[j][i][0])
}

fn near(found: f64, right: f64, by: f64) {
    assert!((found - right).abs() <= by, "{found} instead of {right}");
}

#[test]
fn friedman_with_ties_and_exactly() {
    let found = friedman(&first_item()).unwrap();
    near(found.chi2, 5.719_298_25, 1e-8);
    near(found.p, 0.057_288_858_1, 1e-9);
    near(found.w, 0.178_728_070, 1e-8);
    let ranks =
        DMatrix::from_row_slice(5, 3, &[1.0, 2.0, 3.0, 2.0, 1.0, 3.0, 1.0, 3.0, 2.0, 1.0, 2.0, 3.0, 3.0, 1.0, 2.0]);
    let found = friedman(&ranks).unwrap();
    near(found.chi2, 2.8, 1e-12);
    near(found.p, 0.246_596_963_9, 1e-9);
    near(found.p_exact.unwrap(), 2856.0 / 7776.0, 1e-12);
    assert_eq!(friedman(&DMatrix::from_element(5, 3, 2.0)), Err(NoValue::Constant));
}

#[test]
fn pairs_after_friedman_by_conover_and_nemenyi() {
    // scikit-posthocs 0.17.1; B − A, C − A, C − B.
    let found = posthoc(&first_item()).unwrap();
    for (one, right) in found.iter().zip([(0.099_262, 0.289_666), (0.429_696, 0.759_287), (0.018_046, 0.069_530)]) {
        near(one.conover.unwrap(), right.0, 1e-6);
        near(one.nemenyi, right.1, 1e-6);
    }
}

#[test]
fn wilcoxon_by_both_rules() {
    let table = first_item();
    let less = |i: usize, j: usize| table.row_iter().map(|row| row[i] - row[j]).collect::<Vec<_>>();
    let drop = |i, j| wilcoxon(&less(i, j), Zeros::Drop, 0.95).unwrap();
    let pratt = |i, j| wilcoxon(&less(i, j), Zeros::Pratt, 0.95).unwrap();
    near(drop(1, 0).plus, 77.5, 1e-12);
    near(drop(1, 0).t, 27.5, 1e-12);
    near(drop(1, 0).p, 0.112_127_421, 1e-9);
    near(pratt(1, 0).t, 37.5, 1e-12);
    near(pratt(1, 0).z.abs(), 1.514_561_66, 1e-8);
    near(pratt(1, 0).p, 0.129_883_447, 1e-9);
    near(drop(2, 0).plus, 39.0, 1e-12);
    near(drop(2, 0).p, 0.644_961_630, 1e-9);
    near(pratt(2, 0).p, 0.675_301_923, 1e-9);
    near(drop(2, 1).plus, 14.0, 1e-12);
    near(drop(2, 1).p, 0.013_736_588_8, 1e-9);
    near(pratt(2, 1).t, 18.0, 1e-12);
    near(pratt(2, 1).p, 0.010_923_029_0, 1e-9);
    let held = holm(&[pratt(1, 0).p, pratt(2, 0).p, pratt(2, 1).p]);
    for (found, right) in held.iter().zip([0.259_766_894, 0.675_301_923, 0.032_769_087_0]) {
        near(*found, right, 1e-8);
    }
    near(drop(1, 0).shift, 1.0, 1e-12);
    near(drop(1, 0).rank_biserial, 0.476_190_476, 1e-8);
    let exact = wilcoxon(&[1.2, -0.4, 2.1, 3.3, -1.7, 0.9, 2.6, 4.0], Zeros::Pratt, 0.95).unwrap();
    assert!(exact.exact);
    near(exact.t, 5.0, 1e-12);
    near(exact.p, 0.078_125, 1e-12);
    assert_eq!(wilcoxon(&[0.0; 9], Zeros::Pratt, 0.95), Err(NoValue::Constant));
}

#[test]
fn reliability_of_the_four_items() {
    let rows: Vec<Vec<f64>> = [A, B, C].iter().flat_map(|of| answers(of)).collect();
    let rows = DMatrix::from_fn(48, 4, |i, j| rows[i][j]);
    let found = cronbach(&rows).unwrap();
    near(found.alpha, 0.677_322_404, 1e-8);
    near(found.standardized, 0.678_022_516, 1e-8);
    assert!(found.interval.0 < found.alpha && found.alpha < found.interval.1);
    near(omega(&rows).unwrap(), 0.683_647_043, 1e-6);
}

#[test]
fn intraclass_correlations() {
    let found = icc(&first_item().transpose()).unwrap();
    let right = [0.117_589_893, 0.117_418_351, 0.117_054_264, 0.680_731_364, 0.680_371_726, 0.679_606_188];
    let all = [found.one, found.agreement, found.consistency, found.one_k, found.agreement_k, found.consistency_k];
    all.iter().zip(right).for_each(|(one, right)| near(one.value, right, 1e-8));
    // Shrout and Fleiss 1979, table 2.
    let table = DMatrix::from_row_slice(
        6,
        4,
        &[
            9.0, 2.0, 5.0, 8.0, 6.0, 1.0, 3.0, 2.0, 8.0, 4.0, 6.0, 8.0, 7.0, 1.0, 2.0, 6.0, 10.0, 5.0, 6.0, 9.0, 6.0,
            2.0, 4.0, 7.0,
        ],
    );
    let found = icc(&table).unwrap();
    let right = [0.165_742, 0.289_764, 0.714_841, 0.442_797, 0.620_051, 0.909_316];
    let all = [found.one, found.agreement, found.consistency, found.one_k, found.agreement_k, found.consistency_k];
    all.iter().zip(right).for_each(|(one, right)| near(one.value, right, 5e-7));
}

#[test]
fn krippendorff_by_level() {
    let table = first_item();
    let units: Vec<Vec<f64>> = table.column_iter().map(|column| column.iter().copied().collect()).collect();
    near(krippendorff(&units, Level::Nominal).unwrap(), 0.018_890_113_9, 1e-9);
    near(krippendorff(&units, Level::Ordinal).unwrap(), 0.090_608_024_7, 1e-9);
    near(krippendorff(&units, Level::Interval).unwrap(), 0.083_182_951_0, 1e-9);
    // Krippendorff's own example of four observers and twelve units, 0 where nothing was said.
    let told = ["123321412000", "123322412503", "033323422510", "123324412510"];
    let mut units = vec![Vec::new(); 12];
    for of in told {
        of.chars()
            .enumerate()
            .filter(|(_, c)| *c != '0')
            .for_each(|(i, c)| units[i].push(f64::from(c.to_digit(10).unwrap())));
    }
    near(krippendorff(&units, Level::Nominal).unwrap(), 0.743_421, 5e-7);
    near(krippendorff(&units, Level::Ordinal).unwrap(), 0.815_388, 5e-7);
    near(krippendorff(&units, Level::Interval).unwrap(), 0.849_107, 5e-7);
}

#[test]
fn strengths_of_paired_comparison() {
    let wins = DMatrix::from_row_slice(3, 3, &[0.0, 5.0, 7.0, 9.0, 0.0, 12.0, 6.0, 2.0, 0.0]);
    let found = bradley_terry(&wins).unwrap();
    near(found.strengths[1], 0.888_776_889, 1e-8);
    near(found.errors[1], 0.487_152_066, 1e-8);
    near(found.strengths[2], -0.444_379_742, 1e-8);
    near(found.errors[2], 0.477_867_647, 1e-8);
    // The same with ties; R 4.2.2, optim (BFGS, tolerance 1e-18) of the likelihood.
    let ties = DMatrix::from_row_slice(3, 3, &[0.0, 2.0, 3.0, 2.0, 0.0, 2.0, 3.0, 2.0, 0.0]);
    let found = davidson(&wins, &ties).unwrap();
    near(found.strengths[1], 0.917_463_85, 1e-5);
    near(found.strengths[2], -0.430_092_07, 1e-5);
    near(found.ties, -0.964_527_25, 1e-5);
    near(found.errors[1], 0.488_247_9, 1e-5);
    near(found.errors[2], 0.469_138_2, 1e-5);
    near(found.ties_error, 0.416_192_0, 1e-5);
    let always = DMatrix::from_row_slice(2, 2, &[0.0, 3.0, 0.0, 0.0]);
    assert_eq!(bradley_terry(&always), Err(NoValue::NotConnected));
}

/// The ratings of the first item with the design columns B and C.
fn ordinal_rows(planner: bool) -> Vec<(usize, f64, Vec<f64>)> {
    let table = first_item();
    let mut rows = Vec::new();
    for i in 0..16 {
        for j in 0..3 {
            let columns =
                if planner { vec![f64::from(u8::from(j == 1)), f64::from(u8::from(j == 2))] } else { Vec::new() };
            rows.push((i, table[(i, j)], columns));
        }
    }
    rows
}

#[test]
fn the_cumulative_model_with_and_without_an_intercept_per_person() {
    let found = ordinal(&ordinal_rows(true), true).unwrap();
    for (one, right) in found.thresholds.iter().zip([-1.457_058_243, -0.484_248_108, 0.675_575_274, 2.317_062_607]) {
        near(*one, right, 1e-4);
    }
    near(found.terms[0].effect, 1.310_042_702, 1e-4);
    near(found.terms[0].error, 0.688_141_762, 1e-4);
    near(found.terms[1].effect, -0.295_811_060, 1e-4);
    near(found.terms[1].error, 0.646_757_008, 1e-4);
    near(found.sigma, 0.344_694_403, 1e-4);
    near(found.log_likelihood, -72.499_170_86, 1e-5);
    let none = ordinal(&ordinal_rows(false), true).unwrap();
    let lr = 2.0 * (found.log_likelihood - none.log_likelihood);
    near(lr, 6.525_641_03, 1e-4);
    near(dist::chi_upper(lr, 2.0), 0.038_280_275_5, 1e-5);
    let plain = ordinal(&ordinal_rows(true), false).unwrap();
    for (one, right) in plain.thresholds.iter().zip([-1.411_952_721, -0.455_171_278, 0.682_528_830, 2.283_826_692]) {
        near(*one, right, 1e-5);
    }
    near(plain.terms[0].effect, 1.286_984_537, 1e-5);
    near(plain.terms[1].effect, -0.268_127_130, 1e-5);
    near(plain.log_likelihood, -72.521_741_69, 1e-7);
}

/// Where people differ by 4 logits, thirty nodes of `clmm` say 3.879427 for the deviation; the figures are from a sum over 1800 points.
#[test]
fn the_cumulative_model_of_people_who_differ_much() {
    let mut rows = Vec::new();
    for (person, told) in "101 011 000 000 111 111 000 111 111 101 001 001".split(' ').enumerate() {
        for (planner, answer) in told.chars().enumerate() {
            let columns = [1, 2].map(|one| f64::from(u8::from(one == planner))).to_vec();
            rows.push((person, f64::from(answer.to_digit(10).unwrap()), columns));
        }
    }
    let found = ordinal(&rows, true).unwrap();
    near(found.sigma, 3.879_403_952_5, 1e-8);
    near(found.terms[0].effect, -0.869_633_133_2, 1e-8);
    near(found.terms[0].error, 1.370_223_357_2, 1e-8);
    near(found.terms[1].effect, 2.950_214_353_8, 1e-8);
    near(found.terms[1].error, 2.029_441_321_6, 1e-8);
    // Everybody says always the same: no deviation of people is large enough.
    let same: Vec<_> =
        rows.iter().map(|(person, _, columns)| (*person, f64::from(u8::from(*person > 5)), columns.clone())).collect();
    assert_eq!(ordinal(&same, true), Err(NoValue::NoMaximum));
}

#[test]
fn the_mixed_model_of_item_means() {
    let of = [answers(A), answers(B), answers(C)];
    let means = DMatrix::from_fn(16, 3, |i, j| of[j][i].iter().sum::<f64>() / 4.0);
    let found = balanced_mixed(&means).unwrap();
    near(found.effects[0], 2.75, 1e-12);
    near(found.effects[1], 0.968_75, 1e-12);
    near(found.effects[2], 0.156_25, 1e-12);
    near(found.error, 0.195_545, 1e-6);
    near(found.between, 0.348_958_334, 1e-8);
    near(found.within, 0.305_902_777, 1e-8);
    near(found.f.0, 14.148_694_7, 1e-6);
    near(found.f.3, 4.699_83e-5, 1e-9);
}

#[test]
fn equivalence_dominance_and_weights() {
    // R: t.test(d, mu = −0.5, alternative = "greater") and mu = 0.5, "less".
    let d = [0.1, -0.2, 0.3, 0.0, -0.1, 0.2, -0.3, 0.1];
    let found = equivalence(&d, 0.5, 0.05).unwrap();
    near(found.mean, 0.0125, 1e-12);
    assert!(found.p < 0.001 && found.interval.0 > -0.5 && found.interval.1 < 0.5, "{found:?}");
    assert!(equivalence(&d, 0.05, 0.05).unwrap().p > 0.05);
    near(cliffs_delta(&[1.0, 2.0, 3.0], &[1.0, 1.0, 2.0]).unwrap(), 4.0 / 9.0, 1e-12);
    near(weighted_kappa(&[(1.0, 1.0), (2.0, 2.0), (3.0, 3.0)]).unwrap(), 1.0, 1e-12);
    near(weighted_kappa(&[(1.0, 3.0), (3.0, 1.0)]).unwrap(), -1.0, 1e-12);
}

#[test]
fn the_bootstrap_interval_of_a_mean_matches_theory_and_medians_are_covered() {
    let values: Vec<f64> = (0..=100).map(f64::from).collect();
    let how = Clustered { resamples: 5000, confidence: 0.95, seed: 3 };
    let mean = |drawn: &[usize]| Some(drawn.iter().map(|i| values[*i]).sum::<f64>() / float(drawn.len()));
    let (low, high) = clustered_bca(101, how, mean).unwrap();
    near(low, 44.31, 0.6);
    near(high, 55.69, 0.6);
    assert_eq!(clustered_bca(101, how, mean), Some((low, high)), "same seed, same interval");
    assert_eq!(clustered_bca(4, how, mean), None);
}
