//! Constants of the model and the profiles that set them.

use serde::{Deserialize, Serialize};

/// In which order the center of a group is summed. Differs in the last bits only.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CenterOrder {
    /// Members in list order.
    #[default]
    List,
    /// The person itself first, then the others in list order.
    SelfFirst,
}

/// Constants of the social force model. Unit mass, so forces are accelerations in m/s².
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Params {
    /// Factor of the desired force. Default 2.0. Larger: brisker starts and turns.
    pub desired: f64,
    /// Factor of the obstacle force at touching distance, m/s². Default 10.
    pub obstacle: f64,
    /// Distance over which the obstacle force falls to 1/e, m. Default 0.2. Larger: wider berths.
    pub obstacle_sigma_m: f64,
    /// Factor of the social force, m/s². Default 5.0, as HuNavSim sets it (the library's own is 2.1).
    pub social: f64,
    /// Factor of the gaze force of groups. Default 3.0. Larger: members keep all others in sight.
    pub gaze: f64,
    /// Factor of the coherence force of groups. Default 2.0. Larger: tighter groups.
    pub coherence: f64,
    /// Factor of the repulsion between touching members. Default 1.0.
    pub repulsion: f64,
    /// Weight of relative velocity in the direction of interaction. Default 2.0.
    pub lambda: f64,
    /// Range of the interaction per unit of its strength, m. Default 0.35.
    pub gamma_m: f64,
    /// Angular sharpness of turning aside. Default 2.0.
    pub n: f64,
    /// Angular sharpness of slowing down. Default 3.0.
    pub n_prime: f64,
    /// Bias of the interaction angle, rad/m. Default 0.005. With 0, two people who meet exactly head
    /// on walk through each other.
    pub epsilon: f64,
    /// Time in which the desired velocity is taken up, s. Default 0.5.
    pub relaxation_s: f64,
    /// Order in which group centers are summed.
    pub center: CenterOrder,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            desired: 2.0,
            obstacle: 10.0,
            obstacle_sigma_m: 0.2,
            social: 5.0,
            gaze: 3.0,
            coherence: 2.0,
            repulsion: 1.0,
            lambda: 2.0,
            gamma_m: 0.35,
            n: 2.0,
            n_prime: 3.0,
            epsilon: 0.005,
            relaxation_s: 0.5,
            center: CenterOrder::List,
        }
    }
}

/// Constants that cannot be meant.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("crowd parameter `{name}` is `{value}`; allowed: {allowed}")]
pub struct BadParams {
    /// Field.
    pub name: &'static str,
    /// Its value.
    pub value: f64,
    /// What would be taken.
    pub allowed: &'static str,
}

impl Params {
    /// The one-person call of the reference library, as HuNavSim uses it: no angle bias, social factor 5.
    #[must_use]
    pub fn lightsfm_hunav() -> Self {
        Self { epsilon: 0.0, center: CenterOrder::SelfFirst, ..Self::default() }
    }

    /// The whole-crowd call of the reference library with its own defaults: social factor 2.1.
    #[must_use]
    pub fn lightsfm_batch() -> Self {
        Self { social: 2.1, ..Self::default() }
    }

    /// Whether every constant can be meant.
    ///
    /// # Errors
    /// [`BadParams`] for the first constant that is not finite, negative, or zero where it divides.
    pub fn check(&self) -> Result<(), BadParams> {
        let divides = [
            ("obstacle_sigma_m", self.obstacle_sigma_m),
            ("gamma_m", self.gamma_m),
            ("relaxation_s", self.relaxation_s),
        ];
        for (name, value) in divides {
            if !(value.is_finite() && value > 0.0) {
                return Err(BadParams { name, value, allowed: "a finite number above 0" });
            }
        }
        let factors = [
            ("desired", self.desired),
            ("obstacle", self.obstacle),
            ("social", self.social),
            ("gaze", self.gaze),
            ("coherence", self.coherence),
            ("repulsion", self.repulsion),
            ("lambda", self.lambda),
            ("n", self.n),
            ("n_prime", self.n_prime),
            ("epsilon", self.epsilon),
        ];
        for (name, value) in factors {
            if !(value.is_finite() && value >= 0.0) {
                return Err(BadParams { name, value, allowed: "a finite number of at least 0" });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_profile_can_be_meant_and_a_zero_divisor_cannot() {
        for params in [Params::default(), Params::lightsfm_batch(), Params::lightsfm_hunav()] {
            params.check().unwrap();
        }
        let bad = Params { gamma_m: 0.0, ..Params::default() };
        assert_eq!(bad.check().unwrap_err().name, "gamma_m");
        let bad = Params { social: f64::NAN, ..Params::default() };
        assert_eq!(bad.check().unwrap_err().name, "social");
    }
}
