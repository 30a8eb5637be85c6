//! How many are not yet done, and how long it takes within a limit.

use crate::{StatsError, finite, float};

/// Share of things that are not yet done after each time at which one was done (Kaplan and Meier 1958): the product of
/// `1 - done / at risk` over the times so far. Each thing is given by its time and by whether it was done then; what was not is
/// watched until that time and left out of the risk afterwards. Times without anything done are no step.
///
/// # Errors
/// No value, or a time that is not finite.
pub fn kaplan_meier(watched: &[(f64, bool)]) -> Result<Vec<(f64, f64)>, StatsError> {
    let times: Vec<f64> = watched.iter().map(|(time, _)| *time).collect();
    finite(&times, 1)?;
    let mut sorted = watched.to_vec();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut steps, mut left, mut share) = (Vec::new(), sorted.len(), 1.0);
    let mut rest = sorted.as_slice();
    while let Some((time, _)) = rest.first() {
        let same = rest.iter().take_while(|(other, _)| other.total_cmp(time).is_eq()).count();
        let (now, later) = rest.split_at(same);
        let done = now.iter().filter(|(_, done)| *done).count();
        if done > 0 {
            share *= 1.0 - float(done) / float(left);
            steps.push((*time, share));
        }
        left -= same;
        rest = later;
    }
    Ok(steps)
}

/// Mean time until something is done, counted up to a limit at most: the area under the steps of [`kaplan_meier`] from 0 to the
/// limit.
#[must_use]
pub fn restricted_mean(steps: &[(f64, f64)], limit: f64) -> f64 {
    let (mut area, mut from, mut share) = (0.0, 0.0, 1.0);
    for (time, next) in steps.iter().take_while(|(time, _)| *time < limit) {
        area += share * (time - from);
        (from, share) = (*time, *next);
    }
    area + share * (limit - from).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_steps_of_the_textbook_example_are_as_counted_by_hand() {
        // Times 3, 5+, 7, 7, 18+: S(3) = 4/5, S(7) = 4/5 (1 - 2/3).
        let watched = [(7.0, true), (3.0, true), (5.0, false), (18.0, false), (7.0, true)];
        let steps = kaplan_meier(&watched).unwrap();
        assert_eq!(steps.len(), 2);
        assert!((steps[0].0 - 3.0).abs() < 1e-12 && (steps[0].1 - 0.8).abs() < 1e-12, "{steps:?}");
        assert!((steps[1].0 - 7.0).abs() < 1e-12 && (steps[1].1 - 0.8 / 3.0).abs() < 1e-12, "{steps:?}");
        // 3 · 1 + 4 · 0.8 + 3 · 0.2667.
        assert!((restricted_mean(&steps, 10.0) - (3.0 + 3.2 + 0.8)).abs() < 1e-12);
        assert!((restricted_mean(&steps, 2.0) - 2.0).abs() < 1e-12);
    }

    #[test]
    fn where_nothing_is_done_nothing_steps_and_the_mean_is_the_limit() {
        let steps = kaplan_meier(&[(2.0, false), (9.0, false)]).unwrap();
        assert!(steps.is_empty() && (restricted_mean(&steps, 9.0) - 9.0).abs() < 1e-12);
        assert!(kaplan_meier(&[]).is_err() && kaplan_meier(&[(f64::NAN, true)]).is_err());
    }
}
