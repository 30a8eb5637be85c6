//! Hall's zones around people.

use crate::metrics::online::{End, Now, Running, Setting};
use crate::metrics::{Begin, Family, Measure, Measured, count};
use crate::running::{Below, Mean, Piece, Stretches};

/// Outer limits of the intimate, personal and social zones, m (Hall 1966).
pub(crate) const HALL_M: [f64; 3] = [0.45, 1.2, 3.6];

/// The family.
pub(super) const FAMILY: Family = Family {
    name: "zones",
    thresholds: &[("intimate_m", HALL_M[0]), ("personal_m", HALL_M[1]), ("social_m", HALL_M[2])],
    measure: Measure::Online(Begin(|humans| Box::new(Zones::new(humans)))),
};

/// Entries into the zone of one human.
#[derive(Clone)]
struct Entries {
    near: Stretches,
    by_robot: usize,
    by_person: usize,
}

impl Entries {
    const fn within(limit_m: f64) -> Self {
        Self { near: Stretches::below(limit_m, 0.05, 0.5), by_robot: 0, by_person: 0 }
    }

    /// Gives the entry to the agent that closes in; to none where neither does.
    fn add(&mut self, human: usize, piece: Option<Piece>, now: &Now<'_>) {
        if let Some(from_s) = self.near.add(piece)
            && let Some(share) = now.share(human, from_s)
        {
            *if share > 0.5 { &mut self.by_robot } else { &mut self.by_person } += 1;
        }
    }
}

#[derive(Clone)]
struct Zones {
    mean: Mean,
    below: [Below; 3],
    intimate: Vec<Entries>,
    personal: Vec<Entries>,
}

impl Zones {
    fn new(humans: usize) -> Self {
        Self {
            mean: Mean::default(),
            below: HALL_M.map(Below::level),
            intimate: vec![Entries::within(HALL_M[0]); humans],
            personal: vec![Entries::within(HALL_M[1]); humans],
        }
    }
}

impl Running for Zones {
    fn push(&mut self, _setting: &Setting<'_>, now: &Now<'_>) {
        self.mean.add(now.t, now.nearest);
        for below in &mut self.below {
            below.add(now.nearest_piece);
        }
        for (human, pieces) in now.pieces.iter().enumerate() {
            for zone in [&mut self.intimate, &mut self.personal] {
                if let Some(entries) = zone.get_mut(human) {
                    pieces.iter().for_each(|piece| entries.add(human, *piece, now));
                }
            }
        }
    }

    fn values(&self, _end: &End<'_>) -> Vec<Measured> {
        let length = self.mean.length_s();
        let [intimate, personal, social] = self.below.map(|below| 100.0 * below.seconds() / length.max(1e-9));
        let sum = |zone: &[Entries], one: fn(&Entries) -> usize| Ok(count(zone.iter().map(one).sum()));
        let entered = |entries: &Entries| entries.near.spans().len();
        vec![
            Ok(intimate),
            Ok(personal - intimate),
            Ok(social - personal),
            Ok(100.0 - social),
            Ok(personal),
            Ok(social),
            sum(&self.intimate, entered),
            sum(&self.personal, entered),
            sum(&self.intimate, |entries| entries.by_robot),
            sum(&self.intimate, |entries| entries.by_person),
            sum(&self.personal, |entries| entries.by_robot),
            sum(&self.personal, |entries| entries.by_person),
        ]
    }
}

#[cfg(test)]
mod tests {
    use crate::fixture::Walk;
    use crate::metrics::tests::at_both_rates;

    #[test]
    fn who_closes_in_has_the_entry() {
        let drives = || vec![Walk::robot(-6., 0., 0.8, 0.), Walk::human(1, 0., 0.8, 0., 0.)];
        at_both_rates(&drives, 15.0, "intimate_entries_by_robot", 1.0, 0.0);
        at_both_rates(&drives, 15.0, "personal_entries_by_person", 0.0, 0.0);
        let walks = || vec![Walk::robot(0., 0., 0., 0.), Walk::human(1, -6., 0.8, 0.8, 0.)];
        at_both_rates(&walks, 15.0, "personal_entries_by_robot", 0.0, 0.0);
        at_both_rates(&walks, 15.0, "personal_entries_by_person", 1.0, 0.0);
    }

    #[test]
    fn zone_times_past_a_standing_person_are_those_of_the_chord() {
        // Offset 0.8 m, radii 0.53 m together: centers nearer than 1.73 m over 2 √(1.73² - 0.8²) m at 0.8 m/s.
        let walks = || vec![Walk::robot(-6., 0., 0.8, 0.), Walk::human(1, 0., 0.8, 0., 0.)];
        let chord = |limit: f64| 100.0 * 2.0 * (((limit + 0.53) * (limit + 0.53)) - 0.64_f64).sqrt() / 0.8 / 15.0;
        at_both_rates(&walks, 15.0, "zone_intimate", chord(0.45), 0.1);
        at_both_rates(&walks, 15.0, "within_personal", chord(1.2), 0.1);
        at_both_rates(&walks, 15.0, "zone_personal", chord(1.2) - chord(0.45), 0.1);
        at_both_rates(&walks, 15.0, "intimate_entries", 1.0, 0.0);
    }
}
