//! Whose near miss it was, by what would have been: with a robot that stops in time, and with people who go as they
//! go without a robot.

use crate::metrics::{Family, Measure, Measured, Scene, count, or_why};
use crate::tracks::Track;
use socrates_model::Point;

/// Nearer than this is a near miss, m between surfaces (as in `near_misses`).
const NEAR_M: f64 = 0.5;
/// The other robot stops so long before the closest approach, s.
const STOP_SECS: f64 = 2.0;
/// What happens up to so long after the closest approach still counts, s.
const AFTER_SECS: f64 = 2.0;

/// The family.
pub(super) const FAMILY: Family = Family {
    name: "counterfactual",
    thresholds: &[("near_m", NEAR_M), ("stop_secs", STOP_SECS), ("after_secs", AFTER_SECS)],
    measure: Measure::Whole { measure, why: "compared with a whole run without the robot" },
};

/// Where somebody is; before its first and after its last moment, where it begins and ends.
fn place(track: &Track, t: f64) -> Option<Point> {
    if let Some(sample) = track.at(t) {
        return Some(sample.at);
    }
    let (first, last) = (track.present().next()?, track.present().next_back()?);
    (t >= last.t).then_some(last.at).or_else(|| (t <= first.t).then_some(first.at))
}

fn measure(scene: &Scene<'_>) -> Vec<Measured> {
    let fail = |why: String| FAMILY.sheets().iter().map(|_| Err(why.clone())).collect::<Vec<_>>();
    let twin = match scene.twin() {
        Ok(twin) => twin,
        Err(why) => return fail(why),
    };
    let (mut all, mut robots, mut people) = (0_usize, 0_usize, 0_usize);
    for ((robot, human), distance) in scene.pairs().zip(&scene.distances) {
        let spans = distance.stretches_below(NEAR_M, 0.05, 0.5);
        if spans.is_empty() {
            continue;
        }
        let Some(own) = twin.of(human.agent) else { return fail(format!("{} is not in the twin run", human.agent)) };
        let reach = NEAR_M + robot.radius_m + human.radius_m;
        for span in spans {
            let inside = distance.samples().iter().filter(|(t, _)| *t >= span.from_s - 1e-9 && *t <= span.to_s + 1e-9);
            let Some((closest, _)) = inside.copied().min_by(|a, b| a.1.total_cmp(&b.1)) else { continue };
            let begin = robot.samples.first().map_or(0.0, |sample| sample.t);
            let stop = (closest - STOP_SECS).max(begin);
            let Some(stopped) = place(robot, stop) else { continue };
            let times = || robot.samples.iter().filter(|s| s.t >= stop && s.t <= closest + AFTER_SECS);
            let near = |at: Point, t: f64| place(own, t).is_some_and(|person| (person - at).norm() < reach);
            let as_it_went = times().any(|sample| near(sample.at, sample.t));
            let with_a_stop = times().any(|sample| near(stopped, sample.t));
            all += 1;
            robots += usize::from(as_it_went && !with_a_stop);
            people += usize::from(!as_it_went);
        }
    }
    let share = |part: usize| or_why((all > 0).then(|| count(part) / count(all)), "nobody comes within 0.5 m");
    vec![share(robots), share(people)]
}

#[cfg(test)]
mod tests {
    use crate::evidence::Evidence;
    use crate::fixture::{Walk, recording};
    use crate::metrics::tests::value_of;

    /// Both shares of a run with one person, who goes the other way in the twin run.
    fn shares(robot: &dyn Fn() -> Walk, person: &[(f64, f64, f64)], own: &[(f64, f64, f64)]) -> Vec<Option<f64>> {
        let mut found = Vec::new();
        for step in [0.1, 0.01] {
            let run = recording(&[robot(), Walk::human_through(1, person)], 10.0, step);
            let twin = recording(&[Walk::human_through(1, own)], 10.0, step);
            let evidence = Evidence { twin: Some(&twin), ..Evidence::of(&run) };
            let both = ["blame_counterfactual", "near_misses_by_people"].map(|id| value_of(&evidence, id));
            assert!(found.is_empty() || found == both, "{found:?} at 10 Hz, {both:?} at 100 Hz");
            found = both.to_vec();
        }
        found
    }

    #[test]
    fn who_moves_into_whom_is_told_by_what_would_have_been() {
        let drives = || Walk::robot(-5., 0., 1., 0.);
        let stands = || Walk::robot(0., 0., 0., 0.);
        // The robot drives past somebody who stands: its doing.
        let still: &[(f64, f64, f64)] = &[(0., 0., 0.8)];
        assert_eq!(shares(&drives, still, still), [Some(1.0), Some(0.0)]);
        // Somebody walks past a standing robot on a way of its own: nobody's turn to stop.
        let past: &[(f64, f64, f64)] = &[(0., -5., 0.8), (10., 5., 0.8)];
        assert_eq!(shares(&stands, past, past), [Some(0.0), Some(0.0)]);
        // Somebody leaves its way for a look at the robot: the person's doing.
        let curious: &[(f64, f64, f64)] = &[(0., -5., 5.), (5., 0., 0.8), (10., 5., 5.)];
        let straight: &[(f64, f64, f64)] = &[(0., -5., 5.), (10., 5., 5.)];
        assert_eq!(shares(&stands, curious, straight), [Some(0.0), Some(1.0)]);
        let far: &[(f64, f64, f64)] = &[(0., 0., 4.)];
        assert_eq!(shares(&drives, far, far), [None, None]);
    }
}
