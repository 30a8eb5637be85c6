//! Crowd density around the robot.

use std::f64::consts::PI;

use crate::metrics::online::{End, Now, Running, Setting};
use crate::metrics::{Begin, Family, Measure, Measured, count, or_why};
use crate::running::{Below, Pen};

/// The family.
pub(super) const FAMILY: Family = Family {
    name: "crowding",
    thresholds: &[("mean_a_m", MEAN_M[0]), ("mean_b_m", MEAN_M[1]), ("mean_c_m", MEAN_M[2]), ("most_m", MOST_M)],
    measure: Measure::Online(Begin(|humans| Box::new(Crowding::new(humans)))),
};

/// Radii of the discs for the means, m, and that of the disc for the most, m.
const MEAN_M: [f64; 3] = [5.0, 3.0, 10.0];
const MOST_M: f64 = 2.5;

#[derive(Clone)]
struct Crowding {
    /// Time within each radius, by human.
    humans: Vec<(Pen, [Below; 3])>,
    most: Option<usize>,
}

impl Crowding {
    fn new(humans: usize) -> Self {
        Self { humans: vec![(Pen::default(), MEAN_M.map(Below::level)); humans], most: None }
    }
}

impl Running for Crowding {
    fn push(&mut self, _setting: &Setting<'_>, now: &Now<'_>) {
        let Some(robot) = now.robot else { return };
        let mut near = 0;
        for ((pen, discs), human) in self.humans.iter_mut().zip(now.humans) {
            let distance = (robot.there && human.there).then(|| (robot.at - human.at).norm());
            near += usize::from(distance.is_some_and(|distance| distance < MOST_M));
            let piece = pen.to(now.t, distance);
            for disc in discs {
                disc.add(piece);
            }
        }
        self.most = self.most.max(Some(near));
    }

    fn values(&self, end: &End<'_>) -> Vec<Measured> {
        let length = end.length_s();
        let short = "the recording has no length";
        let mean = |(index, reach): (usize, f64)| {
            let seconds = |discs: &[Below; 3]| discs.get(index).map_or(0.0, Below::seconds);
            let person_seconds: f64 = self.humans.iter().map(|(_, discs)| seconds(discs)).sum();
            or_why((length > 0.0).then(|| person_seconds / length / (PI * (reach * reach))), short)
        };
        let most = or_why(self.most.map(|most| count(most) / (PI * (MOST_M * MOST_M))), short);
        MEAN_M.into_iter().enumerate().map(mean).chain([most]).collect()
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use crate::fixture::{Walk, recording};
    use crate::metrics::tests::value;

    #[test]
    fn two_people_beside_a_standing_robot_are_two_per_disc() {
        let walks = [Walk::robot(0., 0., 0., 0.), Walk::human(1, 2., 0., 0., 0.), Walk::human(2, 0., 4., 0., 0.)];
        let run = recording(&walks, 5.0, 0.1);
        assert!((value(&run, "density_5m_mean").unwrap() - 2.0 / (25.0 * PI)).abs() < 1e-6);
        assert!((value(&run, "density_3m_mean").unwrap() - 1.0 / (9.0 * PI)).abs() < 1e-6);
        assert!((value(&run, "density_10m_mean").unwrap() - 2.0 / (100.0 * PI)).abs() < 1e-6);
        assert!((value(&run, "density_2_5m_max").unwrap() - 1.0 / (6.25 * PI)).abs() < 1e-6);
    }
}
