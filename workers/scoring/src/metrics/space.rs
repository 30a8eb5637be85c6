//! Keeping a distance.

use crate::metrics::online::{End, Now, Running, Setting};
use crate::metrics::{Begin, Family, Measure, Measured, or_why};
use crate::running::{Below, Mean, MeanWhileBelow};

/// Distance to be kept, m (Francis et al. 2023), and that of `SocNavGym`.
const KEPT_M: f64 = 0.5;
const PERSONAL_M: f64 = 0.45;
/// Nearer than this is uncomfortable, m (`CrowdNav`).
const DISCOMFORT_M: f64 = 0.2;

/// The family.
pub(super) const FAMILY: Family = Family {
    name: "space",
    thresholds: &[("kept_m", KEPT_M), ("personal_m", PERSONAL_M), ("discomfort_m", DISCOMFORT_M)],
    measure: Measure::Online(Begin(|_| Box::new(Space::new()))),
};

#[derive(Clone)]
struct Space {
    mean: Mean,
    kept: Below,
    personal: Below,
    discomfort: MeanWhileBelow,
}

impl Space {
    fn new() -> Self {
        Self {
            mean: Mean::default(),
            kept: Below::level(KEPT_M),
            personal: Below::level(PERSONAL_M),
            discomfort: MeanWhileBelow::level(DISCOMFORT_M),
        }
    }
}

impl Running for Space {
    fn push(&mut self, _setting: &Setting<'_>, now: &Now<'_>) {
        let piece = now.nearest_piece;
        self.mean.add(now.t, now.nearest);
        self.kept.add(piece);
        self.personal.add(piece);
        self.discomfort.add(piece, piece);
    }

    fn values(&self, _end: &End<'_>) -> Vec<Measured> {
        let length = self.mean.length_s();
        let share = |seconds: f64| or_why((length > 0.0).then(|| seconds / length), "the recording has no length");
        vec![
            share(self.kept.seconds()).map(|share| 1.0 - share),
            share(self.personal.seconds()).map(|share| 1.0 - share),
            share(self.discomfort.seconds()),
            or_why(self.discomfort.mean(), "nobody comes within 0.2 m"),
        ]
    }
}

#[cfg(test)]
mod tests {
    use crate::fixture::Walk;
    use crate::metrics::tests::at_both_rates;

    #[test]
    fn the_share_that_is_not_kept_is_the_chord_of_half_a_meter() {
        let walks = || vec![Walk::robot(-6., 0., 0.8, 0.), Walk::human(1, 0., 0.8, 0., 0.)];
        let chord = 2.0 * (1.03_f64 * 1.03 - 0.64).sqrt() / 0.8 / 15.0;
        at_both_rates(&walks, 15.0, "space_compliance", 1.0 - chord, 0.001);
        at_both_rates(&walks, 15.0, "discomfort_share", 0.0, 1e-9);
        let chord = 2.0 * (0.98_f64 * 0.98 - 0.64).sqrt() / 0.8 / 15.0;
        at_both_rates(&walks, 15.0, "personal_space_compliance", 1.0 - chord, 0.001);
    }
}
