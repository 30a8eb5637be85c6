//! Personal intrusion in person-seconds.

use crate::metrics::online::{End, Now, Running, Setting};
use crate::metrics::zones::HALL_M;
use crate::metrics::{Begin, Family, Measure, Measured};
use crate::running::{AreaBelow, Below};
use crate::tracks::Sample;

/// The family.
pub(super) const FAMILY: Family = Family {
    name: "intrusion",
    thresholds: &[("intimate_m", HALL_M[0]), ("personal_m", HALL_M[1]), ("social_m", HALL_M[2])],
    measure: Measure::Online(Begin(|humans| Box::new(Intrusions::new(humans)))),
};

/// Nobody is intruded upon from farther than this whatever the angle, m: 1.2 e^(0.9 - 1.5) is less.
const REACH_M: f64 = 1.5;

fn reaches(r: &Sample, h: &Sample) -> bool {
    (r.at - h.at).norm_squared() < REACH_M * REACH_M
}

/// How far outside the anisotropic region the robot is.
fn margin(r: &Sample, h: &Sample) -> f64 {
    let d = (r.at - h.at).norm();
    let front = (1.0 + libm::cos(h.bearing(&r.at))) / 2.0;
    d - 1.2 * libm::exp(0.9 - d) * (0.4 + 0.6 * front)
}

/// Time with the robot near one human.
#[derive(Clone)]
struct Intrusion {
    zones: [Below; 3],
    front: Below,
    area: AreaBelow,
}

#[derive(Clone)]
struct Intrusions(Vec<Intrusion>);

impl Intrusions {
    fn new(humans: usize) -> Self {
        let none =
            Intrusion { zones: HALL_M.map(Below::level), front: Below::level(0.0), area: AreaBelow::level(HALL_M[1]) };
        Self(vec![none; humans])
    }
}

impl Running for Intrusions {
    fn push(&mut self, _setting: &Setting<'_>, now: &Now<'_>) {
        let Some(robot) = now.robot else { return };
        for (index, ((intrusion, pieces), human)) in self.0.iter_mut().zip(now.pieces).zip(now.humans).enumerate() {
            for zone in &mut intrusion.zones {
                pieces.iter().for_each(|piece| zone.add(*piece));
            }
            pieces.iter().for_each(|piece| intrusion.area.add(*piece));
            // Only pieces with an end inside count, so angles matter only there.
            if let Some((r, others)) = now.before
                && let Some(h) = others.get(index).filter(|h| h.there && human.there && r.there && robot.there)
                && (reaches(r, h) || reaches(robot, human))
            {
                intrusion.front.add(Some((r.t, margin(r, h), robot.t, margin(robot, human))));
            }
        }
    }

    fn values(&self, _end: &End<'_>) -> Vec<Measured> {
        let uniform = |zone: usize| self.0.iter().filter_map(|one| one.zones.get(zone)).map(Below::seconds).sum();
        let front = self.0.iter().map(|one| one.front.seconds()).sum();
        let area = self.0.iter().map(|one| one.area.area()).sum();
        vec![Ok(uniform(0)), Ok(uniform(1)), Ok(uniform(2)), Ok(front), Ok(area)]
    }
}

#[cfg(test)]
mod tests {
    use crate::fixture::{Walk, recording};
    use crate::metrics::tests::{at_both_rates, value};

    #[test]
    fn depth_times_time_is_that_of_the_straight_approach() {
        // From 2 m between surfaces to 0.2 m at 0.5 m/s: below 1.2 m for 2 s, on the mean 0.5 m deep; then it stands 4.4 s at 1 m.
        let walks = || {
            let robot = [(0., -2.53, 0.), (3.6, -0.73, 0.), (1000., -0.73, 0.)];
            vec![Walk::through(socrates_model::AgentId::Robot, &robot), Walk::human(1, 0., 0., 0., 0.)]
        };
        at_both_rates(&walks, 8.0, "intrusion_area", 0.5 * 2.0 + 4.4 * 1.0, 1e-3);
        let far = || vec![Walk::robot(-6., 0., 0., 0.), Walk::human(1, 0., 0., 0., 0.)];
        at_both_rates(&far, 8.0, "intrusion_area", 0.0, 1e-12);
    }

    #[test]
    fn two_people_at_one_meter_count_twice_and_the_front_reaches_farther() {
        let stand = |yaw: f64, n: u32| Walk::human(n, 1.4, if n == 1 { 0.0 } else { 1.2 }, 0., 0.).facing(yaw);
        let pi = std::f64::consts::PI;
        let two = recording(&[Walk::robot(0., 0., 0., 0.), stand(0., 1), stand(0., 2)], 10.0, 0.1);
        assert!((value(&two, "intrusion_social").unwrap() - 20.0).abs() < 1e-6);
        let at = |yaw: f64| {
            let walk = Walk::human(1, 1.0, 0., 0., 0.).facing(yaw);
            value(&recording(&[Walk::robot(0., 0., 0., 0.), walk], 10.0, 0.1), "intrusion_anisotropic").unwrap()
        };
        assert!((at(pi) - 10.0).abs() < 1e-6 && at(0.0).abs() < 1e-6);
    }
}
