//! Hall's zones around people.

use crate::metrics::{Direction, Family, Measured, Need, Scene, Sheet, count};
use crate::series::Series;

/// Outer limits of the intimate, personal and social zones, m (Hall 1966).
pub(crate) const HALL_M: [f64; 3] = [0.45, 1.2, 3.6];

const NEEDS: &[Need] = &[Need::Robot, Need::Humans];

const fn zone(id: &'static str, direction: Direction, about: &'static str) -> Sheet {
    Sheet {
        id,
        unit: "%",
        direction,
        needs: NEEDS,
        source: "Hall 1966; exclusive bands as in the code of HuNavSim",
        about,
    }
}

const fn within(id: &'static str, about: &'static str) -> Sheet {
    Sheet {
        id,
        unit: "%",
        direction: Direction::Down,
        needs: NEEDS,
        source: "Hall 1966; cumulative as in Okal and Arras 2016",
        about,
    }
}

const fn entries(id: &'static str, about: &'static str) -> Sheet {
    Sheet {
        id,
        unit: "count",
        direction: Direction::Down,
        needs: NEEDS,
        source: "SEAN 2.0, distance violations",
        about,
    }
}

/// The family.
pub(super) const FAMILY: Family = Family {
    sheets: &[
        zone("zone_intimate", Direction::Down, "share of time with the closest human's surface nearer than 0.45 m"),
        zone("zone_personal", Direction::Down, "share of time with the closest human's surface at 0.45 to 1.2 m"),
        zone("zone_social", Direction::Neutral, "share of time with the closest human's surface at 1.2 to 3.6 m"),
        zone("zone_public", Direction::Neutral, "share of time with the closest human's surface farther than 3.6 m"),
        within("within_personal", "share of time with the closest human's surface nearer than 1.2 m"),
        within("within_social", "share of time with the closest human's surface nearer than 3.6 m"),
        entries("intimate_entries", "entries into a human's intimate zone (0.45 m), re-armed 0.05 m outside for 0.5 s"),
        entries("personal_entries", "entries into a human's personal zone (1.2 m), re-armed 0.05 m outside for 0.5 s"),
        entries(
            "intimate_entries_by_robot",
            "entries into an intimate zone with more than half of the closing speed from the robot",
        ),
        entries(
            "intimate_entries_by_person",
            "entries into an intimate zone with at least half of the closing speed from the person",
        ),
        entries(
            "personal_entries_by_robot",
            "entries into a personal zone with more than half of the closing speed from the robot",
        ),
        entries(
            "personal_entries_by_person",
            "entries into a personal zone with at least half of the closing speed from the person",
        ),
    ],
    measure,
};

fn measure(scene: &Scene<'_>) -> Vec<Measured> {
    let nearest: &Series = &scene.nearest;
    let length = nearest.length_s();
    let [intimate, personal, social] = HALL_M.map(|limit| 100.0 * nearest.time_below(limit) / length.max(1e-9));
    let entered = |limit: f64| -> f64 {
        count(scene.distances.iter().map(|distance| distance.stretches_below(limit, 0.05, 0.5).len()).sum())
    };
    // Who closes in at an entry; nobody where neither does.
    let closers = |limit: f64| -> [f64; 2] {
        let all = scene.distances.iter().enumerate();
        let shares = all.flat_map(|(human, distance)| {
            let spans = distance.stretches_below(limit, 0.05, 0.5);
            spans.into_iter().filter_map(move |span| super::collisions::share(scene, human, span.from_s))
        });
        let (robot, person): (Vec<f64>, Vec<f64>) = shares.partition(|share| *share > 0.5);
        [count(robot.len()), count(person.len())]
    };
    let ([near_robot, near_person], [robot, person]) = (closers(HALL_M[0]), closers(HALL_M[1]));
    vec![
        Ok(intimate),
        Ok(personal - intimate),
        Ok(social - personal),
        Ok(100.0 - social),
        Ok(personal),
        Ok(social),
        Ok(entered(HALL_M[0])),
        Ok(entered(HALL_M[1])),
        Ok(near_robot),
        Ok(near_person),
        Ok(robot),
        Ok(person),
    ]
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
        // Offset 0.8 m, radii 0.53 m together: centres nearer than 1.73 m over 2 √(1.73² - 0.8²) m at 0.8 m/s.
        let walks = || vec![Walk::robot(-6., 0., 0.8, 0.), Walk::human(1, 0., 0.8, 0., 0.)];
        let chord = |limit: f64| 100.0 * 2.0 * (((limit + 0.53) * (limit + 0.53)) - 0.64_f64).sqrt() / 0.8 / 15.0;
        at_both_rates(&walks, 15.0, "zone_intimate", chord(0.45), 0.1);
        at_both_rates(&walks, 15.0, "within_personal", chord(1.2), 0.1);
        at_both_rates(&walks, 15.0, "zone_personal", chord(1.2) - chord(0.45), 0.1);
        at_both_rates(&walks, 15.0, "intimate_entries", 1.0, 0.0);
    }
}
