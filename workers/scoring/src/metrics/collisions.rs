//! Contacts with people and walls, and who ran into whom.

use crate::metrics::online::{End, Now, Running, Setting};
use crate::metrics::scene::{REARM_M, REARM_SECS};
use crate::metrics::{Begin, Family, Measure, Measured, count};
use crate::running::Below;
use crate::series::Span;

/// A wall is known to the size of a cell only; nearer than the radius less this is a contact, m.
pub(super) const WALL_SLACK_M: f64 = 0.05;

/// The family.
pub(super) const FAMILY: Family = Family {
    name: "collisions",
    thresholds: &[("wall_slack_m", WALL_SLACK_M), ("rearm_m", REARM_M), ("rearm_secs", REARM_SECS)],
    measure: Measure::Online(Begin(|humans| Box::new(Contacts::new(humans)))),
};

/// Contacts so far.
#[derive(Clone)]
struct Contacts {
    /// Seconds in contact, by human.
    touching: Vec<Below>,
    /// The robot's share in each contact in which somebody moves, by human.
    shares: Vec<Vec<f64>>,
}

impl Contacts {
    fn new(humans: usize) -> Self {
        Self { touching: vec![Below::level(0.0); humans], shares: vec![Vec::new(); humans] }
    }
}

impl Running for Contacts {
    fn push(&mut self, _setting: &Setting<'_>, now: &Now<'_>) {
        for (touching, pieces) in self.touching.iter_mut().zip(now.pieces) {
            pieces.iter().for_each(|piece| touching.add(*piece));
        }
        for (human, from_s) in now.touched {
            if let (Some(shares), Some(share)) = (self.shares.get_mut(*human), now.share(*human, *from_s)) {
                shares.push(share);
            }
        }
    }

    fn values(&self, end: &End<'_>) -> Vec<Measured> {
        let shares: Vec<f64> = self.shares.iter().flatten().copied().collect();
        let robots = shares.iter().filter(|share| **share > 0.5).count();
        let mean = if shares.is_empty() {
            Err("there is no contact in which somebody moves".to_owned())
        } else {
            Ok(shares.iter().sum::<f64>() / count(shares.len()))
        };
        vec![
            Ok(count(end.contacts)),
            Ok(self.touching.iter().map(Below::seconds).sum()),
            Ok(count(robots)),
            Ok(count(shares.len() - robots)),
            mean,
            Ok(count(end.walls.spans().len())),
            Ok(end.walls.spans().iter().map(Span::length_s).sum()),
        ]
    }
}

/// The robot's share of the closing speed of two agents.
pub(crate) fn closing_share(r: &crate::tracks::Sample, h: &crate::tracks::Sample) -> Option<f64> {
    let line = h.at - r.at;
    let length = line.norm();
    if length <= 1e-9 {
        return None;
    }
    let normal = line / length;
    let (a, b) = (r.velocity.dot(&normal).max(0.0), (-h.velocity.dot(&normal)).max(0.0));
    (a + b > 1e-6).then(|| a / (a + b))
}

#[cfg(test)]
mod tests {
    use crate::fixture::{Walk, recording};
    use crate::metrics::tests::{at_both_rates, value};

    #[test]
    fn running_through_a_standing_person_is_one_contact_of_known_length_by_the_robot() {
        // Discs of 0.25 m and 0.28 m on one line at 0.5 m/s: contact over 2 * 0.53 m.
        let walks = || vec![Walk::robot(0., 0., 0.5, 0.), Walk::human(1, 3., 0., 0., 0.)];
        at_both_rates(&walks, 12.0, "human_collisions", 1.0, 0.0);
        at_both_rates(&walks, 12.0, "human_contact_seconds", 2.12, 0.01);
        at_both_rates(&walks, 12.0, "contact_robot_share", 1.0, 1e-9);
    }

    #[test]
    fn a_standing_robot_that_is_hit_has_no_part_in_it() {
        let run = recording(&[Walk::robot(0., 0., 0., 0.), Walk::human(1, 3., 0., -1., 0.)], 6.0, 0.1);
        assert_eq!(value(&run, "person_on_robot_collisions"), Some(1.0));
        assert_eq!(value(&run, "robot_on_person_collisions"), Some(0.0));
    }

    #[test]
    fn a_wall_is_touched_from_half_a_cell_inside_the_disc_on() {
        let place = crate::fixture::floor(&[(-20., 0.5, 20., 2.)], &[], &[]);
        // The wall begins at y = 0.5 m; the disc has 0.25 m.
        let touches = |y: f64| {
            let run = recording(&[Walk::robot(-3., y, 0.5, 0.)], 6.0, 0.1);
            let evidence = crate::evidence::Evidence { location: Some(&place), ..crate::evidence::Evidence::of(&run) };
            crate::metrics::tests::value_of(&evidence, "wall_collisions")
        };
        assert_eq!((touches(0.22), touches(0.28), touches(0.36)), (Some(0.0), Some(0.0), Some(1.0)));
    }

    #[test]
    fn a_graze_between_two_samples_is_a_contact() {
        // At 2 m/s past each other with 1 cm of overlap: in touch for less than a tenth of a second.
        let walks = || vec![Walk::robot(-1.1, 0., 1., 0.), Walk::human(1, 1.0, 0.52, -1., 0.)];
        at_both_rates(&walks, 3.0, "human_collisions", 1.0, 0.0);
        at_both_rates(&walks, 3.0, "human_distance_min", -0.01, 1e-6);
    }

    #[test]
    fn no_contact_is_a_count_of_zero_and_a_share_of_nothing() {
        let run = recording(&[Walk::robot(0., 0., 0.5, 0.), Walk::human(1, 3., 4., 0., 0.)], 6.0, 0.1);
        assert_eq!(value(&run, "human_collisions"), Some(0.0));
        assert_eq!(value(&run, "contact_robot_share"), None);
        assert_eq!(value(&run, "wall_collisions"), None);
    }
}
