//! What the robot's presence costs people: the run against its twin, the same scenario and seed without a robot.

use crate::metrics::{Family, Measure, Measured, Scene, count, or_why};
use crate::series::Series;
use crate::tracks::Track;
use socrates_model::geometry::wrap_angle;

/// Somebody this near to where it ends in the twin run is there, m.
const THERE_M: f64 = 0.5;
/// Least way in the twin run of a person who can be delayed, m.
const WALK_M: f64 = 1.0;
/// Step of the grid for sums over changes, s.
const EVEN_SECS: f64 = 0.1;

/// The family.
pub(super) const FAMILY: Family = Family {
    name: "twin",
    thresholds: &[("there_m", THERE_M), ("walk_m", WALK_M)],
    measure: Measure::Whole { measure, why: "compared with a whole run without the robot" },
};

/// Changes of velocity and of heading on an even grid.
fn effort(track: &Track, end_s: f64) -> (f64, f64) {
    let even: Vec<_> = track.even(EVEN_SECS).into_iter().filter(|sample| sample.t <= end_s + 1e-9).collect();
    even.iter().zip(even.iter().skip(1)).fold((0.0, 0.0), |(speed, turn), (a, b)| {
        (speed + (b.velocity - a.velocity).norm(), turn + wrap_angle(b.yaw - a.yaw).abs())
    })
}

fn measure(scene: &Scene<'_>) -> Vec<Measured> {
    let fail = |why: String| FAMILY.sheets().iter().map(|_| Err(why.clone())).collect::<Vec<_>>();
    let twin = match scene.twin() {
        Ok(twin) => twin,
        Err(why) => return fail(why),
    };
    let (mut area, mut seconds, mut spent, mut turned) = (0.0, 0.0, 0.0, 0.0);
    let mut delays = Vec::new();
    for human in &scene.whole.humans {
        let Some(other) = twin.of(human.agent) else {
            return fail(format!("{} is not in the twin run", human.agent));
        };
        let apart: Series = human.present().filter_map(|h| Some((h.t, (other.at(h.t)?.at - h.at).norm()))).collect();
        area += apart.integral();
        seconds += apart.length_s();
        let end = human.samples.last().map_or(0.0, |s| s.t).min(other.samples.last().map_or(0.0, |s| s.t));
        let (with, without) = (effort(human, end), effort(other, end));
        spent += with.0 - without.0;
        turned += with.1 - without.1;
        let (Some(first), Some(last)) = (other.present().next(), other.present().next_back()) else { continue };
        if (last.at - first.at).norm() < WALK_M {
            continue;
        }
        let there = |track: &Track| track.present().find(|s| (s.at - last.at).norm() <= THERE_M).map(|s| s.t);
        // A person still on their way at the end is at least that late.
        let with = there(human).or_else(|| human.samples.last().map(|s| s.t));
        if let (Some(with), Some(without)) = (with, there(other)) {
            delays.push((with - without).max(0.0));
        }
    }
    let quantile = |share: f64| socrates_stats::quantile(&delays, share).ok();
    let nobody = "nobody walks in the twin run";
    let mean = (!delays.is_empty()).then(|| delays.iter().sum::<f64>() / count(delays.len()));
    let gap = quantile(0.9).zip(quantile(0.5)).map(|(high, middle)| high - middle);
    vec![
        or_why((seconds > 0.0).then(|| area / seconds), "the two runs share no time"),
        or_why(mean, nobody),
        or_why(quantile(0.95), nobody),
        or_why(gap, nobody),
        Ok(spent),
        Ok(turned),
    ]
}

#[cfg(test)]
mod tests {
    use crate::evidence::Evidence;
    use crate::fixture::{Walk, recording};
    use crate::metrics::tests::value_of;

    #[test]
    fn who_waits_two_seconds_for_the_robot_is_two_seconds_late() {
        for step in [0.1, 0.01] {
            let free =
                recording(&[Walk::human_through(1, &[(0., 0., 0.), (10., 10., 0.), (20., 10., 0.)])], 20.0, step);
            let waits =
                Walk::human_through(1, &[(0., 0., 0.), (4., 4., 0.), (6., 4., 0.), (12., 10., 0.), (20., 10., 0.)]);
            let run = recording(&[Walk::robot(4., -4., 0., 0.8), waits], 20.0, step);
            let evidence = Evidence { twin: Some(&free), ..Evidence::of(&run) };
            let of = |id: &str| value_of(&evidence, id).unwrap();
            assert!((of("flow_delay_mean") - 2.0).abs() < 0.02, "{}", of("flow_delay_mean"));
            assert!((of("flow_delay_gap")).abs() < 1e-9);
            // 0 to 2 m from 4 to 6 s, 2 m until 10 s, back to 0 at 12 s: 12 m s over 20 s.
            assert!((of("people_deviation") - 0.6).abs() < 0.01, "{}", of("people_deviation"));
            // One more stop and one more start of 1 m/s.
            assert!((of("people_effort") - 2.0).abs() < 0.05, "{}", of("people_effort"));
            assert!(of("people_turning").abs() < 1e-9);
            assert_eq!(value_of(&Evidence::of(&run), "flow_delay_mean"), None);
        }
    }
}
