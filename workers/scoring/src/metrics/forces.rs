//! Social forces between the robot and people, as a measure of disturbance.

use socrates_model::Vector;

use crate::metrics::{Family, Measure, Measured, Scene, count, or_why};
use crate::series::Series;
use crate::tracks::{Sample, Track};

/// Constants of Moussaïd et al. 2009 as HuNavSim's evaluator has them: strength, weight of the velocity
/// difference, range per speed, and the two angular exponents.
const STRENGTH: f64 = 2.1;
const LAMBDA: f64 = 2.0;
const GAMMA: f64 = 0.35;
const N: f64 = 2.0;
const N_PRIME: f64 = 3.0;
/// Force from walls: strength at touching distance and range, m.
const WALL_STRENGTH: f64 = 10.0;
const WALL_RANGE_M: f64 = 0.2;

/// Time between two samples that are looked at, s.
const THIN_SECS: f64 = 0.05;

/// The family.
pub(super) const FAMILY: Family = Family {
    name: "forces",
    thresholds: &[
        ("strength", STRENGTH),
        ("lambda", LAMBDA),
        ("gamma", GAMMA),
        ("n", N),
        ("n_prime", N_PRIME),
        ("wall_strength", WALL_STRENGTH),
        ("wall_range_m", WALL_RANGE_M),
    ],
    measure: Measure::Whole {
        measure,
        why: "summed by pairs over whole tracks, so that pairs far apart can be skipped",
    },
};

/// From this exponent on a force is below 1e-19 and not worth an exponential.
pub(super) const FADED: f64 = 45.0;

/// `e^(-x)`, and nothing where it is too small to count.
pub(super) fn faded(x: f64) -> f64 {
    if x > FADED { 0.0 } else { libm::exp(-x) }
}

/// Social force of another agent on one: with `e` from self to other, `t = lambda (v_self - v_other) + e`,
/// `B = gamma |t|` and `theta` the angle from `t` to `e`.
pub(crate) fn social_force(one: &Sample, other: &Sample) -> Vector {
    let line = other.at - one.at;
    let distance = line.norm();
    if distance <= 1e-9 {
        return Vector::zeros();
    }
    let e = line / distance;
    let t = (one.velocity - other.velocity) * LAMBDA + e;
    let size = t.norm();
    if size <= 1e-9 {
        return Vector::zeros();
    }
    let b = GAMMA * size;
    let along = t / size;
    let left = Vector::new(-along.y, along.x);
    if distance > FADED * b {
        return Vector::zeros();
    }
    let theta = libm::atan2(along.perp(&e), along.dot(&e));
    let decay = |n: f64| faded(distance / b + (n * b * theta) * (n * b * theta));
    let sign = if theta > 0.0 {
        1.0
    } else if theta < 0.0 {
        -1.0
    } else {
        0.0
    };
    along * (-STRENGTH * decay(N_PRIME)) + left * (-STRENGTH * sign * decay(N))
}

fn measure(scene: &Scene<'_>) -> Vec<Measured> {
    // Forces are smooth in time: 20 Hz gives the same means as 100 Hz.
    let thin = scene.tracks.thinned(THIN_SECS);
    let Some(robot) = &thin.robot else { return Vec::new() };
    let mut on_people: Vec<(f64, f64)> = robot.samples.iter().map(|sample| (sample.t, 0.0)).collect();
    let mut on_robot: Vec<Vector> = vec![Vector::zeros(); robot.samples.len()];
    for human in &thin.humans {
        for ((r, h), (people, sum)) in
            robot.samples.iter().zip(&human.samples).zip(on_people.iter_mut().zip(on_robot.iter_mut()))
        {
            if !h.there {
                continue;
            }
            // Swapped, the line, the velocities and so the force change sign, and nothing else.
            let push = social_force(h, r);
            people.1 += push.norm();
            *sum -= push;
        }
    }
    let on_robot: Series = robot.samples.iter().zip(&on_robot).map(|(r, force)| (r.t, force.norm())).collect();
    let on_people: Series = on_people.into_iter().collect();
    let walls: Option<Series> = scene.signals.field.as_ref().map(|field| {
        robot
            .samples
            .iter()
            .map(|r| (r.t, WALL_STRENGTH * libm::exp(-(field.clearance(&r.at) - robot.radius_m) / WALL_RANGE_M)))
            .collect()
    });
    let on_walls = scene.signals.field.as_ref().and_then(|field| {
        let force = |human: &Track| {
            human.curve(|h| WALL_STRENGTH * libm::exp(-(field.clearance(&h.at) - human.radius_m) / WALL_RANGE_M)).mean()
        };
        let means: Vec<f64> = thin.humans.iter().filter_map(force).collect();
        (!means.is_empty()).then(|| means.iter().sum::<f64>() / count(means.len()))
    });
    let short = "the recording has no length";
    let no_map = "there is no map";
    let length = on_people.length_s();
    let work = walls.as_ref().map(|walls| walls.integral() + on_robot.integral() + on_people.integral());
    vec![
        or_why(on_people.mean(), short),
        or_why(on_robot.mean(), short),
        or_why(walls.as_ref().and_then(Series::mean), no_map),
        or_why(on_walls, no_map),
        or_why(work, no_map),
        match work {
            Some(work) => or_why((length > 0.0).then(|| work / length), short),
            None => Err(no_map.to_owned()),
        },
        or_why(on_people.time_quantile(0.95).filter(|_| length > 0.0), short),
    ]
}

#[cfg(test)]
mod tests {
    use crate::evidence::Evidence;
    use crate::fixture::{Walk, floor, recording};
    use crate::metrics::tests::{value, value_of};

    #[test]
    fn two_who_stand_face_the_closed_form_of_the_force() {
        // v = 0: t = e, B = 0.35, theta = 0: |f| = 2.1 e^(-d / 0.35).
        let run = recording(&[Walk::robot(0., 0., 0., 0.), Walk::human(1, 1.0, 0., 0., 0.)], 5.0, 0.1);
        let wanted = 2.1 * (-1.0_f64 / 0.35).exp();
        assert!((value(&run, "social_force_on_robot").unwrap() - wanted).abs() < 1e-6);
        assert!((value(&run, "social_force_on_people").unwrap() - wanted).abs() < 1e-6);
        assert_eq!((value(&run, "social_work"), value(&run, "social_work_rate")), (None, None));
        assert!((value(&run, "social_force_p95").unwrap() - wanted).abs() < 1e-6, "always the same");
        let place = floor(&[], &[], &[]);
        let evidence = Evidence { location: Some(&place), ..Evidence::of(&run) };
        let (work, rate) = (value_of(&evidence, "social_work"), value_of(&evidence, "social_work_rate"));
        assert!((work.unwrap() / 5.0 - rate.unwrap()).abs() < 1e-5, "5 s");
    }

    #[test]
    fn a_wall_beside_a_standing_person_has_the_closed_form() {
        let place = floor(&[(-20., 1.0, 20., 1.5)], &[], &[]);
        let run = recording(&[Walk::robot(0., -5., 0., 0.), Walk::human(1, 0.05, 0.45, 0., 0.)], 5.0, 0.1);
        let evidence = Evidence { location: Some(&place), ..Evidence::of(&run) };
        // The wall's cells begin at 1.0 m: 0.55 m from the person, 0.27 m from its surface.
        let wanted = 10.0 * (-(0.55_f64 - 0.28) / 0.2).exp();
        let found = value_of(&evidence, "obstacle_force_on_people").unwrap();
        assert!((found - wanted).abs() < 0.02 * wanted, "{found} instead of {wanted}");
    }
}
