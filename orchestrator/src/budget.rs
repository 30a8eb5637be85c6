//! What the authoring of one scenario may cost, in tokens and in time of authors. Who asks for more ends with what there is.

use socrates_model::fault::{Fault, FaultCode};
use socrates_model::job::{JobKey, Stage};
use socrates_model::{ScenarioId, job};

use crate::pipeline;
use crate::state::JobState;
use crate::turn::Turn;

impl Turn<'_> {
    /// Why the author of this scenario is asked no more, where its budget is spent.
    pub(crate) fn spent(&self, id: &ScenarioId) -> Option<Fault> {
        let (tokens_limit, ms_limit) =
            (self.state.policy.tokens_per_scenario, self.state.policy.author_ms_per_scenario);
        if tokens_limit == 0 && ms_limit == 0 {
            return None;
        }
        let first = JobKey { scenario: id.clone(), stage: Stage::Proposal, item: String::new(), revision: 0 };
        let own = self.state.jobs.range(first..).take_while(|(key, _)| key.scenario == *id);
        let attempts = own.filter(|(key, _)| pipeline::is_authored(key.stage)).flat_map(|(_, job)| &job.attempts);
        let (tokens, ms) = attempts.fold((0_u64, 0_u64), |(tokens, ms), attempt| {
            let both = attempt.tokens.0.saturating_add(attempt.tokens.1);
            (tokens.saturating_add(both), ms.saturating_add(attempt.wall_ms))
        });
        let over = |spent: u64, limit: u64| limit > 0 && spent >= limit;
        let message = if over(tokens, tokens_limit) {
            format!(
                "{tokens} tokens were spent, {tokens_limit} are allowed; `orchestrator.tokens_per_scenario` sets it"
            )
        } else if over(ms, ms_limit) {
            let (spent, limit) = (ms / 1_000, ms_limit / 1_000);
            format!("authors took {spent} s, {limit} s are allowed; `orchestrator.author_s_per_scenario` sets it")
        } else {
            return None;
        };
        Some(Fault::new(FaultCode::JBudget, id, message))
    }

    /// Ends a job whose author would have to be asked again, where nothing is left to ask with.
    pub(crate) fn stop_if_spent(&mut self, key: &job::JobKey, number: u32, why: &str) -> bool {
        let Some(fault) = self.spent(&key.scenario).filter(|_| pipeline::is_authored(key.stage)) else { return false };
        let reason = format!("{why}, {}", fault.code);
        if let Some(attempt) = self.attempt_mut(key, number) {
            attempt.faults.push(fault);
        }
        self.move_to(key, JobState::Failed, reason);
        true
    }
}
