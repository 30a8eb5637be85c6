//! What a monitor found.

use socrates_model::Trigger;
use socrates_model::report::Standing;

/// A trigger that never held.
#[derive(Debug, Clone, PartialEq)]
pub struct Missed {
    /// The trigger.
    pub trigger: Trigger,
    /// How near the robot came in the whole run, m.
    pub nearest_m: f64,
}

/// Outcome of one monitor.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// Standing of the clause.
    pub standing: Standing,
    /// Robustness: positive by how much it holds, negative by how much it fails.
    pub margin: f64,
    /// Size of a clear margin in the same unit, to compare clauses of different units.
    pub scale: f64,
    /// Times of the evidence, s; the first is when it was first seen.
    pub times_s: Vec<f64>,
    /// What was seen, with numbers.
    pub evidence: String,
    /// Time robustness, s: by how much the evidence could come sooner, later or be shorter before the standing
    /// changes; negative: by how much it misses. `None` where time plays no part.
    pub shift_s: Option<f64>,
    /// A reaction that came before its trigger: told apart for the repair.
    pub early: bool,
    /// The trigger that never held, where a reaction had no reason: it tells who can mend it.
    pub missed: Option<Missed>,
}

impl Finding {
    /// Seen.
    pub fn holds(margin: f64, times_s: Vec<f64>, evidence: impl Into<String>) -> Self {
        Self::new(Standing::Holds, margin.max(0.0), times_s, evidence)
    }

    /// Seen, but outside its time window.
    pub fn late(margin: f64, times_s: Vec<f64>, evidence: impl Into<String>) -> Self {
        Self::new(Standing::Late, margin.min(0.0), times_s, evidence)
    }

    /// Seen to be otherwise.
    pub fn fails(margin: f64, times_s: Vec<f64>, evidence: impl Into<String>) -> Self {
        Self::new(Standing::Fails, negative(margin), times_s, evidence)
    }

    /// The premise never came true.
    pub fn never(margin: f64, times_s: Vec<f64>, evidence: impl Into<String>) -> Self {
        Self::new(Standing::NotTriggered, negative(margin), times_s, evidence)
    }

    /// Could not be judged.
    pub fn not_applicable(why: impl Into<String>) -> Self {
        Self::new(Standing::NotApplicable, 0.0, Vec::new(), why)
    }

    /// Holds or fails by the sign of the margin.
    pub fn by_margin(margin: f64, times_s: Vec<f64>, evidence: impl Into<String>) -> Self {
        if margin >= 0.0 { Self::holds(margin, times_s, evidence) } else { Self::fails(margin, times_s, evidence) }
    }

    fn new(standing: Standing, margin: f64, times_s: Vec<f64>, evidence: impl Into<String>) -> Self {
        let margin = if margin.is_finite() { margin } else { f64::copysign(1e6, margin) };
        Self {
            standing,
            margin,
            scale: 1.0,
            times_s,
            evidence: evidence.into(),
            shift_s: None,
            early: false,
            missed: None,
        }
    }

    /// Sets the size of a clear margin.
    #[must_use]
    pub const fn scaled(mut self, scale: f64) -> Self {
        self.scale = scale;
        self
    }

    /// Sets the time robustness.
    #[must_use]
    pub fn shifted(mut self, shift_s: f64) -> Self {
        self.shift_s = shift_s.is_finite().then_some(shift_s);
        self
    }

    /// Marks a reaction that came before its trigger.
    #[must_use]
    pub const fn too_early(mut self) -> Self {
        self.early = true;
        self
    }

    /// Names the trigger that never held.
    #[must_use]
    pub fn missing(mut self, missed: Option<Missed>) -> Self {
        self.missed = missed;
        self
    }

    /// When it was first seen, s.
    #[must_use]
    pub fn first_s(&self) -> Option<f64> {
        self.times_s.first().copied()
    }
}

/// A clause that fails exactly at its limit still fails.
fn negative(margin: f64) -> f64 {
    if margin < 0.0 { margin } else { -1e-3 }
}
