//! The trace of a scenario: what logs of all processes have in common. It follows from what was submitted.

use socrates_model::TraceContext;
use socrates_model::wire::ScenarioSpec;

use crate::state::Scenario;

/// The span of a scenario of a batch, from which those of its jobs and attempts follow.
#[must_use]
pub fn trace_of(batch: &str, spec: &ScenarioSpec) -> TraceContext {
    TraceContext::of_scenario(batch, &spec.id, &spec.request, spec.seed)
}

impl Scenario {
    /// Its span.
    #[must_use]
    pub fn trace(&self) -> TraceContext {
        trace_of(&self.batch, &self.spec)
    }
}
