//! Whose semantics a run has.

use std::f64::consts::{FRAC_PI_2, PI};
use std::fmt;
use std::str::FromStr;

use socrates_bt::Library;

/// Whose semantics a run has. Default: [`Profile::Native`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub enum Profile {
    /// Ours: the known defects of the others are fixed.
    #[default]
    Native,
    /// The SocRATES fork of HuNavSim, as it is.
    SocratesFork,
    /// HuNavSim 1.0, as it is.
    Hunav10,
    /// HuNavSim 1.1, as it is.
    Hunav11,
    /// HuNavSim 2.0, as far as its meaning is plain.
    Hunav20,
}

/// A name that is no profile.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{found}` is no profile; allowed: native, socrates-fork, hunav-1.0, hunav-1.1, hunav-2.0")]
pub struct BadProfile {
    /// What was found.
    pub found: String,
}

impl Profile {
    /// All, ours first.
    pub const ALL: [Self; 5] = [Self::Native, Self::SocratesFork, Self::Hunav10, Self::Hunav11, Self::Hunav20];

    /// Name on the command line and in recordings.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Native => "native",
            Self::SocratesFork => "socrates-fork",
            Self::Hunav10 => "hunav-1.0",
            Self::Hunav11 => "hunav-1.1",
            Self::Hunav20 => "hunav-2.0",
        }
    }

    /// Whose nodes trees of this profile have; ours takes trees of every library.
    #[must_use]
    pub const fn library(self) -> Library {
        match self {
            Self::Native => Library::Native,
            Self::SocratesFork => Library::SocratesFork,
            Self::Hunav10 => Library::HunavSim1_0,
            Self::Hunav11 => Library::HunavSim1_1,
            Self::Hunav20 => Library::HunavSim2,
        }
    }

    /// What is done in this profile.
    pub(crate) const fn rules(self) -> Rules {
        match self {
            Self::Native => NATIVE,
            Self::SocratesFork => FORK,
            Self::Hunav10 => HUNAV_1_0,
            Self::Hunav11 => HUNAV_1_1,
            Self::Hunav20 => HUNAV_2_0,
        }
    }
}

impl fmt::Display for Profile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Profile {
    type Err = BadProfile;

    fn from_str(text: &str) -> Result<Self, BadProfile> {
        Self::ALL
            .into_iter()
            .find(|profile| profile.name() == text.trim())
            .ok_or_else(|| BadProfile { found: crate::problem::shortened(text) })
    }
}

/// Who feels the robot in the social forces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum RobotFelt {
    /// Everybody, always.
    ByAll,
    /// The regular as a person, the impassive as an obstacle point, nobody else.
    ByReaction,
    /// Everybody who does not react at the moment, as a person.
    UnlessReacting,
}

/// How somebody curious slows down near the robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Approach {
    /// Speed × distance / 10 m, with the speed of the node or this one, m/s.
    Tenth(Option<f64>),
    /// Speed × distance / (distance + stop).
    Ratio,
}

/// How somebody stands in the robot's way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Threat {
    /// Distance before the robot where the node has none, m.
    pub(crate) ahead_m: f64,
    /// Whether sine and cosine of the robot's heading are swapped.
    pub(crate) swapped: bool,
    /// Speed on the way there, m/s.
    pub(crate) speed_mps: f64,
    /// Within this distance of the robot it faces it, m.
    pub(crate) face_within_m: f64,
}

/// What is done in a profile; one field per known difference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Rules {
    /// Whether motion is ours: walls and ways from the map, turning rates per second, contacts.
    pub(crate) native: bool,
    /// Half of the field of view in which a robot counts as visible, rad.
    pub(crate) half_view_rad: f64,
    /// Whether walls hide the robot.
    pub(crate) sight: bool,
    /// Who feels the robot.
    pub(crate) robot_felt: RobotFelt,
    /// Largest turn of somebody who looks at something, rad per tick.
    pub(crate) turn_rad: f64,
    /// Whether a target on the right is overshot: the limit is negative there, so that every step counts as too long.
    pub(crate) turn_overshoots: bool,
    /// How somebody curious slows down.
    pub(crate) approach: Approach,
    /// How somebody stands in the robot's way.
    pub(crate) threat: Threat,
    /// Whether the last goal stays on the list.
    pub(crate) keeps_last_goal: bool,
    /// Whether a robot moves only where one component of its velocity is above 0.1 m/s, sign included.
    pub(crate) moved_is_signed: bool,
    /// Whether a new gesture is seen only in ticks in which the state of its maker did not change.
    pub(crate) gestures_get_lost: bool,
    /// Whether the gesture codes of people differ from the robot's: 3 is EXCUSE ME.
    pub(crate) own_gesture_codes: bool,
    /// Number of the first human in the ports of trees.
    pub(crate) first_human: i64,
    /// Whether durations and speeds that cannot be meant are mended.
    pub(crate) mends_draws: bool,
}

const NATIVE: Rules = Rules {
    native: true,
    half_view_rad: 100.0 * PI / 180.0,
    sight: true,
    robot_felt: RobotFelt::ByAll,
    turn_rad: PI * 0.01,
    turn_overshoots: false,
    approach: Approach::Ratio,
    threat: Threat { ahead_m: 1.4, swapped: false, speed_mps: 1.8, face_within_m: 1.6 },
    keeps_last_goal: true,
    moved_is_signed: false,
    gestures_get_lost: false,
    own_gesture_codes: false,
    first_human: 1,
    mends_draws: true,
};

const HUNAV_1_0: Rules = Rules {
    native: false,
    half_view_rad: FRAC_PI_2 + 0.17,
    sight: false,
    robot_felt: RobotFelt::ByReaction,
    turn_rad: PI * 0.01,
    turn_overshoots: true,
    approach: Approach::Tenth(Some(1.8)),
    threat: Threat { ahead_m: 1.1, swapped: true, speed_mps: 2.0, face_within_m: 1.2 },
    keeps_last_goal: false,
    moved_is_signed: true,
    gestures_get_lost: false,
    own_gesture_codes: false,
    first_human: 0,
    mends_draws: false,
};

const HUNAV_1_1: Rules = Rules {
    robot_felt: RobotFelt::UnlessReacting,
    approach: Approach::Tenth(None),
    threat: Threat { ahead_m: 1.4, swapped: true, speed_mps: 2.0, face_within_m: 0.6 },
    ..HUNAV_1_0
};

const HUNAV_2_0: Rules = Rules { turn_rad: 0.04, approach: Approach::Ratio, ..HUNAV_1_1 };

const FORK: Rules = Rules {
    half_view_rad: 4.188,
    threat: Threat { ahead_m: 1.5, swapped: false, speed_mps: 0.5, face_within_m: 0.6 },
    keeps_last_goal: true,
    gestures_get_lost: true,
    own_gesture_codes: true,
    ..HUNAV_1_0
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_profile_is_read_back_by_its_name() {
        for profile in Profile::ALL {
            assert_eq!(profile.name().parse::<Profile>(), Ok(profile));
        }
        assert!("hunav".parse::<Profile>().is_err());
    }
}
