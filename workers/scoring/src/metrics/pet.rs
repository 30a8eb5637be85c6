//! Post-encroachment time.

use socrates_model::Point;

use crate::metrics::scene::EVEN_SECS;
use crate::metrics::{Family, Measure, Measured, Scene, count, or_why};
use crate::skips::{arcs, next};
use crate::tracks::Track;

/// The family.
pub(super) const FAMILY: Family = Family {
    name: "pet",
    thresholds: &[],
    measure: Measure::Whole { measure, why: "the place where two ways cross is known when both have been gone" },
};

fn measure(scene: &Scene<'_>) -> Vec<Measured> {
    let gap = scene.pairs().filter_map(|(robot, human)| gap_s(robot, human)).min_by(f64::total_cmp);
    vec![or_why(gap, "the robot's way crosses nobody's")]
}

/// The smallest time between the two coming within reach of each other's place.
///
/// One nearest point of the two ways would not do: where they run side by side for a while, it jumps from one end of
/// that stretch to the other with the least change.
fn gap_s(robot: &Track, human: &Track) -> Option<f64> {
    let reach = robot.radius_m + human.radius_m;
    let (mine, others) = (places(robot), places(human));
    let there: Vec<Point> = others.iter().map(|(_, at)| *at).collect();
    let ahead = arcs(there.iter());
    let mut best: Option<f64> = None;
    for (row, at) in &mine {
        let mut index = 0;
        while let Some((other, place)) = others.get(index) {
            let apart = (at - place).norm();
            if apart <= reach {
                let lag = entered(&others, index, at, reach, *row);
                best = Some(best.map_or(lag, |old: f64| old.min(lag)));
                if lag <= 0.0 {
                    return best;
                }
                // Farther on in this stay it is only nearer in time while the other comes up from behind.
                index = if other < row { index + 1 } else { next([&ahead], index, reach - apart).max(index + 1) };
            } else {
                index = next([&ahead], index, apart - reach);
            }
        }
    }
    best.map(|rows| rows * EVEN_SECS)
}

/// By how many rows the other is at a place before or after a row; between rows by the straight line on which it comes
/// within reach, or leaves it.
fn entered(others: &[(usize, Point)], index: usize, at: &Point, reach: f64, row: usize) -> f64 {
    let Some((other, place)) = others.get(index) else { return f64::INFINITY };
    let whole = count(other.abs_diff(row));
    let toward = if *other > row { index.checked_sub(1) } else { Some(index + 1) };
    let beyond = toward.and_then(|index| others.get(index)).filter(|(next, _)| next.abs_diff(*other) == 1);
    let far = beyond.map(|(_, place)| (at - place).norm()).filter(|far| *far > reach && *other != row);
    far.map_or(whole, |far| whole - (reach - (at - place).norm()) / (far - (at - place).norm()).max(1e-9))
}

/// Rows in which an agent is there, with its place.
fn places(track: &Track) -> Vec<(usize, Point)> {
    let all = track.samples.iter().enumerate();
    all.filter(|(_, sample)| sample.there).map(|(row, sample)| (row, sample.at)).collect()
}

#[cfg(test)]
mod tests {
    use socrates_model::AgentId;

    use crate::fixture::{Walk, recording};
    use crate::metrics::tests::{at_both_rates, value};

    #[test]
    fn the_gap_at_a_crossing_is_the_time_between_leaving_and_entering() {
        // Both go at 1 m/s; a place at 45 degrees behind the human and ahead of the robot is left last and entered first:
        // 3 s less the sum of radii, 0.53 m, times the square root of 2.
        let walks = || vec![Walk::robot(-4., 0., 1., 0.), Walk::human(1, 0., -7., 0., 1.)];
        at_both_rates(&walks, 10.0, "post_encroachment_time", 3.0 - 0.53 * 2.0_f64.sqrt(), 0.05);
    }

    #[test]
    fn who_walks_on_the_same_way_is_as_late_as_it_is_behind_at_the_narrowest() {
        // Each place is left and entered 3 s less twice the reach apart where the robot goes at half its speed at last.
        let robot = || Walk::through(AgentId::Robot, &[(0., 0., 0.), (6., 6., 0.), (9., 7.5, 0.)]);
        let walks = || vec![robot(), Walk::human(1, -3., 0.1, 1., 0.)];
        let behind = (0.53_f64.powi(2) - 0.01).sqrt();
        at_both_rates(&walks, 9.0, "post_encroachment_time", 3.0 - 2.0 * behind, 0.05);
        // The nearest points of the two ways lie anywhere on the way: a millimeter does not matter.
        let moved = || vec![robot(), Walk::human_through(1, &[(0., -3., 0.101), (9., 6., 0.099)])];
        at_both_rates(&moved, 9.0, "post_encroachment_time", 3.0 - 2.0 * behind, 0.05);
    }

    #[test]
    fn parallel_ways_have_no_gap() {
        let run = recording(&[Walk::robot(-4., 0., 1., 0.), Walk::human(1, 4., 2., -1., 0.)], 8.0, 0.1);
        assert_eq!(value(&run, "post_encroachment_time"), None);
    }
}
