//! Which of two films was better.

use std::collections::BTreeMap;

use nalgebra::DMatrix;

use crate::stats::{NoValue, bradley_terry, davidson};

/// An answer to a pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Prefers {
    /// The film on the left.
    Left,
    /// The film on the right.
    Right,
    /// Both alike.
    Equal,
}

/// One answer, by what the two films are conditions of, such as planners.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    /// Condition on the left.
    pub left: String,
    /// Condition on the right.
    pub right: String,
    /// The answer.
    pub prefers: Prefers,
}

/// Strengths of conditions.
#[derive(Debug, Clone, PartialEq)]
pub struct Pairs {
    /// Answers, of which ties.
    pub answers: usize,
    /// Answers that both are alike.
    pub ties: usize,
    /// Answers that preferred the left, of those that preferred one: 0.5 where the place does not matter.
    pub left: Option<f64>,
    /// The model: `bradley_terry`, or `davidson` where there are ties.
    pub model: &'static str,
    /// Condition, log strength against the first, its standard error.
    pub strengths: Vec<(String, f64, f64)>,
}

/// Strengths from answers to pairs; the first condition by name is the reference.
///
/// # Errors
/// As [`bradley_terry`].
pub fn strengths(choices: &[Choice]) -> Result<Pairs, NoValue> {
    let names = choices.iter().flat_map(|choice| [choice.left.as_str(), choice.right.as_str()]);
    let places: BTreeMap<&str, usize> = names
        .collect::<std::collections::BTreeSet<_>>()
        .into_iter()
        .enumerate()
        .map(|(place, name)| (name, place))
        .collect();
    let k = places.len();
    let (mut wins, mut ties) = (DMatrix::zeros(k, k), DMatrix::zeros(k, k));
    let add = |counts: &mut DMatrix<f64>, at: (usize, usize)| {
        if let Some(cell) = counts.get_mut(at) {
            *cell += 1.0;
        }
    };
    let (mut left, mut decided, mut tied) = (0_usize, 0_usize, 0_usize);
    for choice in choices {
        let Some((a, b)) = places.get(choice.left.as_str()).copied().zip(places.get(choice.right.as_str()).copied())
        else {
            continue;
        };
        if a == b {
            continue;
        }
        match choice.prefers {
            Prefers::Left => add(&mut wins, (a, b)),
            Prefers::Right => add(&mut wins, (b, a)),
            Prefers::Equal => {
                add(&mut ties, (a, b));
                add(&mut ties, (b, a));
            }
        }
        left += usize::from(choice.prefers == Prefers::Left);
        tied += usize::from(choice.prefers == Prefers::Equal);
        decided += usize::from(choice.prefers != Prefers::Equal);
    }
    let (model, strengths, errors) = if tied > 0 {
        let found = davidson(&wins, &ties)?;
        ("davidson", found.strengths, found.errors)
    } else {
        let found = bradley_terry(&wins)?;
        ("bradley_terry", found.strengths, found.errors)
    };
    let rows = places
        .into_keys()
        .zip(strengths)
        .zip(errors)
        .map(|((name, strength), error)| (name.to_owned(), strength, error));
    Ok(Pairs {
        answers: decided + tied,
        ties: tied,
        left: (decided > 0).then(|| crate::stats::float(left) / crate::stats::float(decided)),
        model,
        strengths: rows.collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn many(left: &str, right: &str, prefers: Prefers, times: usize) -> Vec<Choice> {
        vec![Choice { left: left.into(), right: right.into(), prefers }; times]
    }

    #[test]
    fn two_conditions_have_the_log_of_their_wins_with_and_without_ties() {
        let all = [many("a", "b", Prefers::Left, 6), many("b", "a", Prefers::Left, 12)].concat();
        let found = strengths(&all).unwrap();
        assert_eq!((found.model, found.answers, found.left), ("bradley_terry", 18, Some(1.0)));
        assert!((found.strengths[1].1 - 2.0_f64.ln()).abs() < 1e-9);
        let all = [all, many("a", "b", Prefers::Equal, 5)].concat();
        let found = strengths(&all).unwrap();
        assert_eq!((found.model, found.answers, found.ties), ("davidson", 23, 5));
        assert!((found.strengths[1].1 - 2.0_f64.ln()).abs() < 1e-9);
        assert!((found.strengths[1].2 - (1.0_f64 / 6.0 + 1.0 / 12.0).sqrt()).abs() < 1e-9);
        assert_eq!(strengths(&many("a", "b", Prefers::Left, 6)), Err(NoValue::NotConnected));
    }
}
