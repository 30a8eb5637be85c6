//! Could somebody tell early on which side the robot will pass?

use socrates_model::Vector;

use crate::metrics::goals::BETA_PER_M;
use crate::metrics::{Family, Measure, Measured, Scene, count, or_why};
use crate::tracks::Track;

/// From this near on a person looks where the robot will pass, m.
const LOOK_M: f64 = 6.0;
/// Largest distance at which a person counts as passed, m.
const PASS_M: f64 = 3.0;
/// The two goals lie so far to the left and to the right of the person, m.
const BESIDE_M: f64 = 1.0;
/// Belief from which the side is told: at 1 m to the side nothing can be surer than 0.88.
const TOLD: f64 = 0.6;

/// The family.
pub(super) const FAMILY: Family = Family {
    name: "sides",
    thresholds: &[("look_m", LOOK_M), ("pass_m", PASS_M), ("beside_m", BESIDE_M), ("told", TOLD)],
    measure: Measure::Whole { measure, why: "the side on which the robot passes is known when it has passed" },
};

/// Beliefs in the side on which a person is passed, as `(time s, belief)`, up to being level; `None` where the person
/// is not passed.
fn beliefs(scene: &Scene<'_>, human: &Track) -> Option<Vec<(f64, f64)>> {
    // Where the robot is seen from the person, as if the person stood.
    let seen: Vec<(f64, Vector)> =
        scene.even.iter().filter_map(|robot| Some((robot.t, robot.at - human.at(robot.t)?.at))).collect();
    let near = seen.iter().position(|(_, away)| away.norm() <= LOOK_M)?;
    let approach = seen.get(near..)?;
    let (_, start) = approach.first()?;
    let ahead = -start.try_normalize(BESIDE_M)?;
    let level = approach.iter().position(|(_, away)| away.dot(&ahead) >= 0.0)?;
    let (_, passing) = approach.get(level)?;
    let side = ahead.perp(passing);
    // A person that is run into, or left far aside, is passed on no side.
    if side.abs() < 0.1 || passing.norm() > PASS_M {
        return None;
    }
    let goal = Vector::new(-ahead.y, ahead.x) * (BESIDE_M * side.signum());
    let belief = |away: &Vector| {
        let (left, other) = ((away - goal).norm(), (away + goal).norm());
        1.0 / (1.0 + libm::exp(BETA_PER_M * (left - other)))
    };
    Some(approach.iter().take(level + 1).map(|(t, away)| (*t, belief(away))).collect())
}

fn measure(scene: &Scene<'_>) -> Vec<Measured> {
    let (mut shares, mut least) = (Vec::new(), None::<f64>);
    for found in scene.tracks.humans.iter().filter_map(|human| beliefs(scene, human)) {
        let Some((end, _)) = found.last().copied() else { continue };
        let weights: f64 = found.iter().map(|(t, _)| end - t).sum();
        if weights <= 0.0 {
            continue;
        }
        shares.push(found.iter().map(|(t, belief)| (end - t) * belief).sum::<f64>() / weights);
        let since = found.iter().rev().take_while(|(_, belief)| *belief >= TOLD).last().map_or(end, |(t, _)| *t);
        least = Some(least.map_or(end - since, |old| old.min(end - since)));
    }
    let nobody = "the robot passes nobody within 3 m";
    let mean = (!shares.is_empty()).then(|| shares.iter().sum::<f64>() / count(shares.len()));
    vec![or_why(mean, nobody), or_why(least, nobody)]
}

#[cfg(test)]
mod tests {
    use socrates_model::AgentId;

    use crate::fixture::{Walk, recording};
    use crate::metrics::tests::{at_both_rates, value};

    /// The robot past somebody who stands at the origin.
    fn past(stops: &[(f64, f64, f64)]) -> Vec<Walk> {
        vec![Walk::through(AgentId::Robot, stops), Walk::human(1, 0., 0., 0., 0.)]
    }

    #[test]
    fn a_robot_that_goes_aside_early_tells_its_side_and_one_that_goes_late_does_not() {
        let early: &[(f64, f64, f64)] = &[(0., -8., 0.), (2., -6., 0.), (4., -4., 1.), (14., 6., 1.)];
        let late: &[(f64, f64, f64)] = &[(0., -8., 0.), (6.5, -1.5, 0.), (7.5, -0.5, 1.), (14., 6., 1.)];
        let wrong: &[(f64, f64, f64)] = &[(0., -8., 0.), (4., -4., -1.), (7.5, -0.8, 1.), (14., 6., 1.)];
        let of = |stops: &[(f64, f64, f64)], id: &str| value(&recording(&past(stops), 14.0, 0.1), id).unwrap();
        let [a, b, c] = [early, late, wrong].map(|stops| of(stops, "side_legibility"));
        assert!(a > 0.6 && (b - 0.5).abs() < 0.02 && c < 0.5, "{a} {b} {c}");
        let [a, b, c] = [early, late, wrong].map(|stops| of(stops, "side_told"));
        assert!(a > 3.5 && b < 1.5 && c < 2.5, "{a} {b} {c}");
        // The other side is as legible.
        let mirrored: Vec<(f64, f64, f64)> = early.iter().map(|(t, x, y)| (*t, *x, -y)).collect();
        assert!((of(&mirrored, "side_legibility") - of(early, "side_legibility")).abs() < 1e-9);
    }

    #[test]
    fn the_belief_is_that_of_the_formula_at_any_rate() {
        // From 6 m straight to 1 m beside: after half the way at (-3, 0.5), so 3.04 and 3.35 m from the two goals.
        let way: &[(f64, f64, f64)] = &[(0., -6., 0.), (6., 0., 1.), (8., 2., 1.)];
        let belief = |t: f64| {
            let (x, y) = (t - 6.0, t / 6.0);
            1.0 / (1.0 + (x.hypot(y - 1.0) - x.hypot(y + 1.0)).exp())
        };
        let steps: Vec<f64> = (0..=60).map(|k| f64::from(k) * 0.1).collect();
        let weights: f64 = steps.iter().map(|t| 6.0 - t).sum();
        let wanted = steps.iter().map(|t| (6.0 - t) * belief(*t)).sum::<f64>() / weights;
        at_both_rates(&|| past(way), 8.0, "side_legibility", wanted, 1e-6);
        let told = steps.iter().find(|t| belief(**t) >= 0.6).unwrap();
        at_both_rates(&|| past(way), 8.0, "side_told", 6.0 - told, 1e-6);
    }

    #[test]
    fn who_is_not_passed_has_no_side() {
        let stops: &[(f64, f64, f64)] = &[(0., -8., 0.), (5., -3., 0.), (9., -3., 0.)];
        let far: &[(f64, f64, f64)] = &[(0., -8., 5.), (16., 8., 5.)];
        for stops in [stops, far] {
            assert_eq!(value(&recording(&past(stops), 9.0, 0.1), "side_legibility"), None);
        }
    }
}
