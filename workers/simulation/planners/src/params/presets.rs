//! Parameter files that come with this crate.

/// A parameter file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Preset {
    /// Its name.
    pub name: &'static str,
    /// One sentence for people.
    pub about: &'static str,
    /// The file: YAML with Nav2's names.
    pub text: &'static str,
}

/// Every preset.
pub const PRESETS: &[Preset] = &[
    Preset {
        name: "socrates_mppi",
        about: "MPPI as in the published case study: Nav2 Humble, 30 Hz, 2000 trajectories, commands of at most 0.5 m/s",
        text: include_str!("../../presets/socrates_mppi.yaml"),
    },
    Preset {
        name: "mppi",
        about: "MPPI as Nav2's main branch brings it up, for a round robot of 0.22 m",
        text: include_str!("../../presets/mppi.yaml"),
    },
    Preset {
        name: "ha_mppi",
        about: "MPPI of the case study with a social layer, so that it keeps away from people",
        text: include_str!("../../presets/ha_mppi.yaml"),
    },
    Preset {
        name: "nav2can",
        about: "MPPI of the case study with the social and group layers of Nav2CAN",
        text: include_str!("../../presets/nav2can.yaml"),
    },
];

/// The preset of this name.
#[must_use]
pub fn preset(name: &str) -> Option<&'static Preset> {
    PRESETS.iter().find(|preset| preset.name == name)
}
