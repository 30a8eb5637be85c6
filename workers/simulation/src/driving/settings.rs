//! How a driver outside is waited for.

use std::time::Duration;

use socrates_model::{Fault, FaultCode};

/// How the simulation and a driver outside keep step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Mode {
    /// The simulation stands until the driver has answered: thinking costs no simulated time.
    #[default]
    Step,
    /// It waits so long for each answer; after that the command before holds.
    Wait(Duration),
    /// It never waits: the newest command holds. Played at the pace of the clock unless another pace is stated.
    Free,
}

impl Mode {
    /// The word for the mission.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Step => "step",
            Self::Wait(_) => "wait",
            Self::Free => "free",
        }
    }
}

/// Mode and patience.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Drive {
    /// How they keep step.
    pub mode: Mode,
    /// Longest wait for a driver to come, and for one answer.
    pub patience: Duration,
}

/// Longest wait for a driver where nothing is stated.
const PATIENCE: Duration = Duration::from_secs(30);

impl Default for Drive {
    fn default() -> Self {
        Self { mode: Mode::Step, patience: PATIENCE }
    }
}

impl Drive {
    /// Reads the settings `drive` (`step`, `wait 50` with milliseconds, `free`) and `drive_patience_s`.
    ///
    /// # Errors
    /// `J-SPEC` for anything else.
    pub fn read(mode: Option<&str>, patience_s: Option<&str>) -> Result<Self, Fault> {
        let bad = |key: &'static str, found: &str, allowed: &str| {
            Fault::new(FaultCode::JSpec, key, format!("`{found}` is not understood; allowed: {allowed}"))
        };
        let text = mode.unwrap_or("step").trim();
        let mode = match text.split_once(char::is_whitespace) {
            None if text == "step" || text.is_empty() => Mode::Step,
            None if text == "free" => Mode::Free,
            Some(("wait", millis)) => match millis.trim().parse::<u64>() {
                Ok(millis) if (1..=10_000).contains(&millis) => Mode::Wait(Duration::from_millis(millis)),
                Ok(_) | Err(_) => return Err(bad("setting drive", text, "wait and 1 to 10000 milliseconds")),
            },
            Some(_) | None => return Err(bad("setting drive", text, "step, wait 50 (milliseconds), free")),
        };
        let patience = match patience_s.map(|text| (text, text.trim().parse::<u64>())) {
            None => PATIENCE,
            Some((_, Ok(seconds))) if (1..=600).contains(&seconds) => Duration::from_secs(seconds),
            Some((text, _)) => return Err(bad("setting drive_patience_s", text, "1 to 600")),
        };
        Ok(Self { mode, patience })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mode_is_one_of_three() {
        let read = |text| Drive::read(Some(text), None).map(|drive| drive.mode);
        assert_eq!(read("step").unwrap(), Mode::Step);
        assert_eq!(read("free").unwrap(), Mode::Free);
        assert_eq!(read("wait 50").unwrap(), Mode::Wait(Duration::from_millis(50)));
        assert_eq!(Drive::read(None, None).unwrap(), Drive::default());
        for bad in ["wait", "wait 0", "wait soon", "often", "free 3"] {
            assert!(
                read(bad).unwrap_err().message.to_string().contains(&format!("`{bad}` is not understood")),
                "{bad}"
            );
        }
        assert!(Drive::read(None, Some("0")).is_err());
    }
}
