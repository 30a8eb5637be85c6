//! Post-encroachment time.

use socrates_model::Point;

use crate::metrics::{Direction, Family, Measure, Measured, Need, Scene, Sheet, or_why};
use crate::skips::{arcs, next};
use crate::tracks::Track;

/// Spacing of the points at which two ways are compared, m.
const STEP_M: f64 = 0.1;

/// The family.
pub(super) const FAMILY: Family = Family {
    sheets: &[Sheet {
        id: "post_encroachment_time",
        unit: "s",
        direction: Direction::Up,
        needs: &[Need::Robot, Need::Humans],
        source: "Allen, Shin and Cooper 1978 (PET)",
        about: "smallest time between one agent leaving the place where the ways cross (a disc of both radii) and the other entering it; 0 when both are in it at once",
    }],
    thresholds: &[("step_m", STEP_M)],
    measure: Measure::Whole { measure, why: "the place where two ways cross is known when both have been gone" },
};

fn measure(scene: &Scene<'_>) -> Vec<Measured> {
    let way = scene.robot().map(points).unwrap_or_default();
    let gap = scene.pairs().filter_map(|(robot, human)| gap_s(robot, &way, human)).min_by(f64::total_cmp);
    vec![or_why(gap, "the robot's way crosses nobody's")]
}

/// The smallest gap over the places that both come through.
fn gap_s(robot: &Track, way: &[Point], human: &Track) -> Option<f64> {
    let reach = robot.radius_m + human.radius_m;
    let place = nearest(way, &points(human)).filter(|(apart, _)| *apart <= reach)?.1;
    let (r_in, r_out) = stay(robot, &place, reach)?;
    let (h_in, h_out) = stay(human, &place, reach)?;
    Some((h_in - r_out).max(r_in - h_out).max(0.0))
}

/// The first of the points of a way that are nearest to another way, with its distance, m.
fn nearest(way: &[Point], other: &[Point]) -> Option<(f64, Point)> {
    let ahead = arcs(other.iter());
    let mut best: Option<(f64, Point)> = None;
    let mut hint = 0;
    for at in way {
        let mut least = (at - other.get(hint)?).norm();
        let mut index = 0;
        while let Some(point) = other.get(index) {
            let apart = (at - point).norm();
            if apart < least {
                (least, hint) = (apart, index);
            }
            index = next([&ahead], index, apart - least);
        }
        if least < best.map_or(f64::INFINITY, |(apart, _)| apart) {
            best = Some((least, *at));
        }
    }
    best
}

/// Points of a way, one per step.
fn points(track: &Track) -> Vec<Point> {
    let mut kept: Vec<Point> = Vec::new();
    for sample in track.present() {
        if kept.last().is_none_or(|last| (sample.at - last).norm() >= STEP_M) {
            kept.push(sample.at);
        }
    }
    kept
}

/// First time inside a disc, and last time of that stay.
fn stay(track: &Track, at: &Point, reach: f64) -> Option<(f64, f64)> {
    let distance = track.curve(|sample| (sample.at - at).norm());
    distance.stretches_below(reach, 0.05, 0.5).first().map(|span| (span.from_s, span.to_s))
}

#[cfg(test)]
mod tests {
    use crate::fixture::{Walk, recording};
    use crate::metrics::tests::{at_both_rates, value};

    #[test]
    fn the_gap_at_a_crossing_is_the_time_between_leaving_and_entering() {
        // The robot leaves the disc of 0.53 m about the origin at t = 4.53 s, the human enters at 6.47 s.
        let walks = || vec![Walk::robot(-4., 0., 1., 0.), Walk::human(1, 0., -7., 0., 1.)];
        at_both_rates(&walks, 10.0, "post_encroachment_time", 7.0 - 4.0 - 1.06, 0.12);
    }

    #[test]
    fn parallel_ways_have_no_gap() {
        let run = recording(&[Walk::robot(-4., 0., 1., 0.), Walk::human(1, 4., 2., -1., 0.)], 8.0, 0.1);
        assert_eq!(value(&run, "post_encroachment_time"), None);
    }
}
