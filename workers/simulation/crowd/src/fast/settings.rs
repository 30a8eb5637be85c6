//! What can be set about a fast crowd.

use crate::params::{BadParams, Params};

/// The error bound of [`Settings::default`], m/s².
pub const ERROR_MPS2: f64 = 1e-3;
/// Within this distance walls are felt by default, m.
pub const WALL_RANGE_M: f64 = 3.0;

/// How a [`super::Crowd`] is worked out.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Constants of the forces.
    pub params: Params,
    /// Largest error of the social force on anybody, m/s², against the sum over all pairs. Default 1e-3.
    /// Smaller: farther people are taken into account and steps take longer; 0 keeps every pair.
    pub error_mps2: f64,
    /// Within this distance a wall is felt, m. Default 3.
    pub wall_range_m: f64,
    /// Which instructions of the processor are used. The results are the same.
    pub instructions: Instructions,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            params: Params::default(),
            error_mps2: ERROR_MPS2,
            wall_range_m: WALL_RANGE_M,
            instructions: Instructions::Detected,
        }
    }
}

/// Instructions of the processor. They change the time a step takes and no byte of its result.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Instructions {
    /// The widest vectors that the processor has, found out at run time.
    #[default]
    Detected,
    /// Vectors of 256 bits where an x86-64 processor has them (AVX2), else as [`Instructions::Baseline`].
    Avx2,
    /// Those that every processor of the architecture has.
    Baseline,
}

impl Instructions {
    pub(super) fn arch(self) -> pulp::Arch {
        match self {
            Self::Detected => pulp::Arch::new(),
            Self::Avx2 => avx2(),
            Self::Baseline => pulp::Arch::Scalar,
        }
    }
}

#[cfg(target_arch = "x86_64")]
fn avx2() -> pulp::Arch {
    pulp::x86::V3::try_new().map_or(pulp::Arch::Scalar, pulp::Arch::V3)
}

#[cfg(not(target_arch = "x86_64"))]
fn avx2() -> pulp::Arch {
    pulp::Arch::Scalar
}

/// Settings that cannot be meant.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BadSettings {
    /// A constant of the forces.
    #[error(transparent)]
    Params(#[from] BadParams),
    /// The error bound or the range of walls.
    #[error("crowd setting `{name}` is `{value}`; allowed: a finite number of at least 0")]
    Number {
        /// Field.
        name: &'static str,
        /// Its value.
        value: f64,
    },
}

/// A step that time cannot make.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("a step of `{dt}` s; allowed: a finite number of at least 0")]
pub struct BadStep {
    /// Its length, s.
    pub dt: f64,
}

pub(super) fn check_error(error_mps2: f64) -> Result<(), BadSettings> {
    at_least_zero("error_mps2", error_mps2)
}

fn at_least_zero(name: &'static str, value: f64) -> Result<(), BadSettings> {
    if value.is_finite() && value >= 0.0 { Ok(()) } else { Err(BadSettings::Number { name, value }) }
}

impl Settings {
    /// Whether every setting can be meant.
    ///
    /// # Errors
    /// [`BadSettings`] for the first that cannot.
    pub fn check(&self) -> Result<(), BadSettings> {
        self.params.check()?;
        check_error(self.error_mps2)?;
        at_least_zero("wall_range_m", self.wall_range_m)
    }
}
