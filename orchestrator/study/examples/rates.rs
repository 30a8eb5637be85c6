//! How often the tests reject where there is nothing, and how often intervals hold what was planted.
//!
//! ```text
//! cargo run --release -p socrates-study --example rates [STUDIES]
//! ```
#![expect(clippy::print_stdout, reason = "an example prints")]

use nalgebra::DMatrix;
use rand_chacha::ChaCha8Rng;
use rand_core::{Rng as _, SeedableRng as _};
use socrates_study::stats::{Zeros, friedman_by_chi2, holm, ordinal, wilcoxon};

/// Seeded draws.
struct Draws(ChaCha8Rng);

impl Draws {
    fn share(&mut self) -> f64 {
        (f64::from(self.0.next_u32()) + 0.5) / 4_294_967_296.0
    }
    fn normal(&mut self) -> f64 {
        libm::sqrt(-2.0 * libm::log(self.share())) * libm::cos(2.0 * std::f64::consts::PI * self.share())
    }
    fn logistic(&mut self) -> f64 {
        let share = self.share();
        libm::log(share / (1.0 - share))
    }
}

/// Answers of `people` to `items` items about three planners, by the cumulative mixed model; means of the items.
fn study(draws: &mut Draws, people: u32, items: u32, points: u32, effects: [f64; 3]) -> DMatrix<f64> {
    let mut flat = Vec::new();
    for _ in 0..people {
        let own = draws.normal() * 1.63;
        for effect in effects {
            let mut sum = 0.0;
            for _ in 0..items {
                let latent = own + effect + draws.logistic();
                let cuts =
                    (1..points).filter(|cut| latent > -3.0 + 6.0 * f64::from(cut - 1) / f64::from(points - 2)).count();
                sum += f64::from(u32::try_from(cuts).unwrap_or(0)) + 1.0;
            }
            flat.push(sum / f64::from(items));
        }
    }
    DMatrix::from_row_slice(people as usize, 3, &flat)
}

fn rows(table: &DMatrix<f64>, planners: bool) -> Vec<(usize, f64, Vec<f64>)> {
    let mut found = Vec::new();
    for (person, row) in table.row_iter().enumerate() {
        for (planner, answer) in row.iter().enumerate() {
            let columns =
                if planners { (1..3).map(|one| f64::from(u8::from(one == planner))).collect() } else { Vec::new() };
            found.push((person, *answer, columns));
        }
    }
    found
}

fn main() {
    let studies: u32 = std::env::args().nth(1).and_then(|text| text.parse().ok()).unwrap_or(10_000);
    println!("{studies} studies of three planners each; share that rejects at .05 where nothing was planted");
    for (people, items, points) in [(42, 1, 5), (60, 1, 5), (42, 4, 5), (60, 6, 9)] {
        let mut draws = Draws(ChaCha8Rng::seed_from_u64(1));
        let (mut by_ranks, mut by_pairs) = (0, 0);
        for _ in 0..studies {
            let table = study(&mut draws, people, items, points, [0.0; 3]);
            by_ranks += u32::from(friedman_by_chi2(&table).is_ok_and(|of| of.p < 0.05));
            let less = |a: usize, b: usize| {
                table.column(a).iter().zip(table.column(b).iter()).map(|(a, b)| a - b).collect::<Vec<_>>()
            };
            let p = |a, b| wilcoxon(&less(a, b), Zeros::Pratt, 0.95).map_or(1.0, |of| of.p);
            by_pairs += u32::from(holm(&[p(1, 0), p(2, 0), p(2, 1)]).iter().any(|p| *p < 0.05));
        }
        let share = |count: u32| f64::from(count) / f64::from(studies);
        println!(
            "n {people}, {items} items of {points} points: Friedman {:.4}, any pair by Holm {:.4}",
            share(by_ranks),
            share(by_pairs)
        );
    }
    let mut draws = Draws(ChaCha8Rng::seed_from_u64(2));
    let mut rejected = 0;
    for _ in 0..studies {
        let table = study(&mut draws, 42, 1, 5, [0.0; 3]);
        let both = ordinal(&rows(&table, true), true)
            .and_then(|full| Ok(full.log_likelihood - ordinal(&rows(&table, false), true)?.log_likelihood));
        // χ² with two degrees of freedom is above 5.991 in 5 of 100 cases.
        rejected += u32::from(both.is_ok_and(|gain| 2.0 * gain > 5.991_464_547));
    }
    println!(
        "n 42, one item: likelihood ratio of the cumulative mixed model {:.4}",
        f64::from(rejected) / f64::from(studies)
    );
    let mut draws = Draws(ChaCha8Rng::seed_from_u64(3));
    let (mut held, mut fitted) = ([0, 0], 0);
    for _ in 0..studies {
        let table = study(&mut draws, 42, 1, 5, [0.0, 1.0, 0.5]);
        let Ok(of) = ordinal(&rows(&table, true), true) else { continue };
        fitted += 1;
        for ((count, term), planted) in held.iter_mut().zip(&of.terms).zip([1.0, 0.5]) {
            *count += u32::from((term.effect - planted).abs() < 1.959_964 * term.error);
        }
    }
    let share = held.map(|count| f64::from(count) / f64::from(fitted));
    println!("{fitted} fits: intervals that hold the planted log odds 1.0 and 0.5: {:.4} {:.4}", share[0], share[1]);
}
