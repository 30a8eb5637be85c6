//! Near misses.

use crate::metrics::{Direction, Family, Measured, Need, Scene, Sheet, count};

/// Nearer than this is a near miss, m (the default of Robot SF).
const NEAR_M: f64 = 0.5;

/// The family.
pub(super) const FAMILY: Family = Family {
    sheets: &[Sheet {
        id: "near_misses",
        unit: "count",
        direction: Direction::Down,
        needs: &[Need::Robot, Need::Humans],
        source: "Robot SF, near-miss counter",
        about: "stretches with a surface distance to a human from 0 to 0.5 m that do not end in a contact",
    }],
    measure,
};

fn measure(scene: &Scene<'_>) -> Vec<Measured> {
    let near = scene.distances.iter().flat_map(|distance| {
        let touching = distance.stretches_below(0.0, 0.0, 0.0);
        distance
            .stretches_below(NEAR_M, 0.05, 0.5)
            .into_iter()
            .filter(move |span| !touching.iter().any(|touch| touch.from_s <= span.to_s && touch.to_s >= span.from_s))
    });
    vec![Ok(count(near.count()))]
}

#[cfg(test)]
mod tests {
    use crate::fixture::Walk;
    use crate::metrics::tests::at_both_rates;

    #[test]
    fn a_close_pass_is_one_near_miss_and_a_contact_is_none() {
        let close = || vec![Walk::robot(-4., 0., 0.8, 0.), Walk::human(1, 0., 0.8, 0., 0.)];
        at_both_rates(&close, 10.0, "near_misses", 1.0, 0.0);
        let through = || vec![Walk::robot(-4., 0., 0.8, 0.), Walk::human(1, 0., 0.1, 0., 0.)];
        at_both_rates(&through, 10.0, "near_misses", 0.0, 0.0);
    }
}
