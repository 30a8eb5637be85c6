//! How fast a run plays for those who watch it. The engine knows nothing of it.

use std::time::{Duration, Instant};

use socrates_model::time::STEP_NANOS;
use socrates_model::{Fault, FaultCode};

/// The pace of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Pace {
    /// As fast as it goes.
    Max,
    /// So many simulated seconds per second, 0.1 to 100.
    Times(f64),
}

impl Pace {
    /// Reads `max` or a number.
    ///
    /// # Errors
    /// `J-SPEC` for anything else.
    pub fn read(text: Option<&str>) -> Result<Self, Fault> {
        match text.unwrap_or("max").trim() {
            "" | "max" => Ok(Self::Max),
            other => match other.parse::<f64>() {
                Ok(times) if (0.1..=100.0).contains(&times) => Ok(Self::Times(times)),
                Ok(_) | Err(_) => Err(Fault::new(
                    FaultCode::JSpec,
                    "setting pace",
                    format!("`{other}` is no pace; allowed: max, 0.1 to 100"),
                )),
            },
        }
    }

    /// How long tick `tick` of a run that began at `start` is still away.
    #[must_use]
    pub fn left(self, start: Instant, tick: u64) -> Duration {
        match self {
            Self::Max => Duration::ZERO,
            Self::Times(times) => {
                let due = Duration::from_nanos(tick.saturating_mul(STEP_NANOS)).div_f64(times);
                due.saturating_sub(start.elapsed())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pace_is_max_or_a_number_in_range() {
        assert_eq!(Pace::read(None).unwrap(), Pace::Max);
        assert_eq!(Pace::read(Some("2")).unwrap(), Pace::Times(2.0));
        for bad in ["fast", "0", "-1", "nan", "1000"] {
            assert!(Pace::read(Some(bad)).unwrap_err().message.to_string().contains(bad));
        }
    }

    #[test]
    fn a_later_tick_is_farther_away() {
        let start = Instant::now();
        assert_eq!(Pace::Max.left(start, 1_000_000), Duration::ZERO);
        assert!(Pace::Times(1.0).left(start, 100_000) > Duration::from_secs(900));
    }
}
