//! Which way viewers thought the robot goes, moment by moment.

use std::collections::BTreeMap;

use nalgebra::DMatrix;

use super::{BELIEF_HZ, MOST_DELAY_SECS, SURE};
use crate::stats::{float, icc, spearman};

/// What one viewer believed during one film: ten values a second of film time, 0 (surely the other goal) to 1 (surely the
/// goal that the robot had).
#[derive(Debug, Clone, PartialEq)]
pub struct Trace {
    /// By whom.
    pub rater: String,
    /// Which film.
    pub film: String,
    /// Values at 0 s, 0.1 s, and so on.
    pub values: Vec<f64>,
}

/// What viewers of a film knew when.
#[derive(Debug, Clone, PartialEq)]
pub struct Believed {
    /// Which film.
    pub film: String,
    /// Viewers.
    pub raters: usize,
    /// Mean time before the end from which on a viewer's belief stays at 0.5 or more, s; 0 for who never gets there.
    pub readiness_s: f64,
    /// Mean belief over time and viewers.
    pub clarity: f64,
    /// Mean drops below 0.5 after having been at 0.5 or more.
    pub confusions: f64,
    /// Mean rank correlation of every two viewers, as recorded; none of one viewer or of traces that never move.
    pub agreement: Option<f64>,
    /// The same with everybody's delay taken out.
    pub agreement_undelayed: Option<f64>,
    /// Median delay behind the mean of the others, s.
    pub delay_s: Option<f64>,
    /// Reliability of the mean of these viewers over means of 1 s, ICC(C,k); none of fewer than two viewers or seconds.
    pub reliability: Option<f64>,
}

/// Every film, in the order of names. Readiness, clarity and confusions are those of Taylor et al. 2022, as recorded: a viewer's delay is
/// part of what they knew.
#[must_use]
pub fn believed(traces: &[Trace]) -> Vec<Believed> {
    let mut films: BTreeMap<&str, Vec<&[f64]>> = BTreeMap::new();
    for trace in traces.iter().filter(|trace| trace.values.len() > 1) {
        films.entry(&trace.film).or_default().push(&trace.values);
    }
    films.into_iter().map(|(film, traces)| one(film, &traces)).collect()
}

fn one(film: &str, traces: &[&[f64]]) -> Believed {
    let mean = |of: &dyn Fn(&[f64]) -> f64| traces.iter().map(|trace| of(trace)).sum::<f64>() / float(traces.len());
    let length = traces.iter().map(|trace| trace.len()).min().unwrap_or(0);
    let cut: Vec<&[f64]> = traces.iter().filter_map(|trace| trace.get(..length)).collect();
    let delays: Vec<usize> = (0..cut.len()).filter_map(|index| delay(&cut, index)).collect();
    let delayed = delays.len() == cut.len() && cut.len() > 1;
    let longest = delays.iter().copied().max().unwrap_or(0);
    let shifted: Vec<&[f64]> = cut
        .iter()
        .zip(&delays)
        .filter_map(|(trace, delay)| trace.get(*delay..length.checked_sub(longest)? + delay))
        .collect();
    let seconds: Vec<f64> = delays.iter().map(|delay| float(*delay) / BELIEF_HZ).collect();
    Believed {
        film: film.to_owned(),
        raters: traces.len(),
        readiness_s: mean(&readiness_s),
        clarity: mean(&clarity),
        confusions: mean(&confusions),
        agreement: pairwise(&cut),
        agreement_undelayed: if delayed { pairwise(&shifted) } else { None },
        delay_s: if delayed { socrates_stats::median(&seconds).ok() } else { None },
        reliability: reliability(&cut),
    }
}

fn readiness_s(trace: &[f64]) -> f64 {
    let sure = trace.iter().rev().take_while(|belief| **belief >= SURE).count();
    float(sure.saturating_sub(1)) / BELIEF_HZ
}

fn clarity(trace: &[f64]) -> f64 {
    let area: f64 = trace.iter().zip(trace.iter().skip(1)).map(|(a, b)| f64::midpoint(*a, *b)).sum();
    area / float(trace.len() - 1)
}

fn confusions(trace: &[f64]) -> f64 {
    float(trace.iter().zip(trace.iter().skip(1)).filter(|(a, b)| **a >= SURE && **b < SURE).count())
}

/// Mean rank correlation of every two; none where no two have one.
fn pairwise(traces: &[&[f64]]) -> Option<f64> {
    let mut found = Vec::new();
    for (index, one) in traces.iter().enumerate() {
        for other in traces.iter().skip(index + 1) {
            let pairs: Vec<(f64, f64)> = one.iter().copied().zip(other.iter().copied()).collect();
            found.extend(spearman(&pairs).ok().map(|(rho, _)| rho));
        }
    }
    socrates_stats::mean(&found).ok()
}

/// Samples by which a viewer is behind the mean of the others: the shift with the largest rank correlation, the smallest of equal
/// ones. None for one viewer, or for traces that never move.
fn delay(traces: &[&[f64]], index: usize) -> Option<usize> {
    let own = traces.get(index)?;
    let others: Vec<&&[f64]> =
        traces.iter().enumerate().filter(|(other, _)| *other != index).map(|(_, trace)| trace).collect();
    if others.is_empty() {
        return None;
    }
    let mean: Vec<f64> = (0..own.len())
        .map(|at| others.iter().filter_map(|trace| trace.get(at)).sum::<f64>() / float(others.len()))
        .collect();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few tens")]
    let most = (MOST_DELAY_SECS * BELIEF_HZ) as usize;
    let mut best: Option<(f64, usize)> = None;
    for shift in 0..=most.min(own.len() / 2) {
        let late = own.get(shift..)?;
        let pairs: Vec<(f64, f64)> = late.iter().copied().zip(mean.iter().copied()).collect();
        if let Ok((rho, _)) = spearman(&pairs)
            && best.is_none_or(|(most, _)| rho > most + 1e-9)
        {
            best = Some((rho, shift));
        }
    }
    best.map(|(_, shift)| shift)
}

/// Reliability of the mean over means of one second.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "ten")]
fn reliability(traces: &[&[f64]]) -> Option<f64> {
    let second = BELIEF_HZ as usize;
    let seconds = traces.first()?.len() / second;
    if traces.len() < 2 || seconds < 2 {
        return None;
    }
    let mean = |trace: &[f64], at: usize| {
        let part = trace.get(at * second..(at + 1) * second).unwrap_or_default();
        part.iter().sum::<f64>() / float(part.len().max(1))
    };
    let table =
        DMatrix::from_fn(seconds, traces.len(), |row, column| traces.get(column).map_or(0.0, |trace| mean(trace, row)));
    icc(&table).ok().map(|found| found.consistency_k.value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trace(rater: &str, values: Vec<f64>) -> Trace {
        Trace { rater: rater.into(), film: "r01".into(), values }
    }

    /// A rise from 0 to 1 between two moments, s, in a film of 10 s.
    fn rise(from_s: f64, to_s: f64) -> Vec<f64> {
        (0..=100).map(|k| ((f64::from(k) / 10.0 - from_s) / (to_s - from_s)).clamp(0.0, 1.0)).collect()
    }

    #[test]
    fn readiness_clarity_and_confusions_are_those_of_the_trace() {
        let found = &believed(&[trace("a", rise(2.0, 6.0))])[0];
        // Half of the rise is at 4 s of 10; the area is a triangle of 4 s and 4 s in full.
        assert!((found.readiness_s - 6.0).abs() < 1e-9 && (found.clarity - 0.6).abs() < 1e-9, "{found:?}");
        assert_eq!((found.confusions, found.raters, found.agreement, found.delay_s), (0.0, 1, None, None));
        let mut doubt = rise(2.0, 6.0);
        doubt[70..80].fill(0.2);
        let found = &believed(&[trace("a", doubt)])[0];
        assert!((found.readiness_s - 2.0).abs() < 1e-9, "{found:?}");
        assert!((found.confusions - 1.0).abs() < 1e-9);
        // A viewer who is wrong at the end was never ready.
        let wrong: Vec<f64> = rise(2.0, 6.0).into_iter().map(|belief| 1.0 - belief).collect();
        let found = &believed(&[trace("a", wrong)])[0];
        assert_eq!((found.readiness_s, found.confusions), (0.0, 1.0));
    }

    #[test]
    fn a_viewer_who_is_late_is_late_by_so_much_and_agrees_once_that_is_taken_out() {
        let wave = |late: f64| -> Vec<f64> {
            (0..=200).map(|k| 0.5 + 0.4 * libm::sin((f64::from(k) / 10.0 - late) * 0.7)).collect()
        };
        let all = [trace("a", wave(0.0)), trace("b", wave(0.0)), trace("c", wave(2.0))];
        let found = &believed(&all)[0];
        assert!(found.agreement_undelayed.unwrap() > found.agreement.unwrap() + 0.2, "{found:?}");
        assert!(found.agreement_undelayed.unwrap() > 0.95 && found.reliability.unwrap() > 0.5, "{found:?}");
        // A viewer who never moves the slider agrees with nobody, and that is no 0.
        let still = [trace("a", wave(0.0)), trace("b", vec![0.5; 201])];
        assert_eq!((believed(&still)[0].agreement, believed(&still)[0].delay_s), (None, None));
    }
}
