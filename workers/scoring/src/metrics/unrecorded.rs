//! What recordings do not hold: commands and computing times of a planner, and the robot's way without people.

use crate::metrics::{Family, Measure, Scene};

/// The family. It has values as soon as recordings tell what it needs.
pub(super) const FAMILY: Family = Family {
    name: "unrecorded",
    thresholds: &[],
    measure: Measure::Whole { measure: nothing, why: "no recording holds what it needs" },
};

/// None of the needs is ever met, so this is never asked.
fn nothing(_: &Scene<'_>) -> Vec<super::Measured> {
    Vec::new()
}

#[cfg(test)]
mod tests {
    use crate::evidence::Evidence;
    use crate::fidelity::Signals;
    use crate::fixture::{Walk, recording};
    use crate::metrics::{Scene, measure};
    use crate::tracks::Tracks;

    #[test]
    fn what_is_not_recorded_says_so_and_is_no_number() {
        let run = recording(&[Walk::robot(0., 0., 0.5, 0.), Walk::human(1, 5., 1., 0., 0.)], 4.0, 0.1);
        let evidence = Evidence::of(&run);
        let tracks = Tracks::read(&run).unwrap();
        let signals = Signals::new(&evidence, &tracks);
        let values = measure(&Scene::new(&signals));
        let of = |id: &str| values.iter().find(|value| value.id == id).unwrap();
        for id in ["planner_latency_p50", "planner_latency_p95", "planner_wait"] {
            let value = of(id);
            assert_eq!(value.value, None);
            assert!(value.note.contains("recordings hold no computing times of planners"), "{}", value.note);
            assert_eq!(value.missing, Some(socrates_model::Missing::Unavailable));
        }
        assert!(of("command_fluency").note.contains("no commands"));
    }
}
