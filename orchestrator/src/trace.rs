//! The trace of a scenario: what logs of all processes have in common. It follows from what was submitted.

use socrates_model::TraceContext;

use crate::state::Scenario;

impl Scenario {
    /// Its span, from which those of its jobs and attempts follow.
    #[must_use]
    pub fn trace(&self) -> TraceContext {
        TraceContext::of_scenario(&self.batch, &self.spec.id, &self.spec.request, self.spec.seed)
    }
}
