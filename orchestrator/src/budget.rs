//! What the authoring of one scenario may cost, in tokens, money and time of authors. A scenario that needs more ends with what there is.

use std::collections::BTreeMap;

use socrates_model::fault::{Fault, FaultCode};
use socrates_model::job::{Item, JobKey, Stage};
use socrates_model::{AuthorSpec, ScenarioId, Where, job};

use crate::pipeline;
use crate::state::{JobState, State};
use crate::turn::Turn;

impl Turn<'_> {
    /// Why the author of this scenario is asked no more, where its budget is spent.
    pub(crate) fn spent(&self, id: &ScenarioId) -> Option<Fault> {
        let batch = self.scenario(id).and_then(|scenario| self.state.batches.get(&scenario.batch));
        if let Some(batch) = batch.filter(|batch| !batch.over.is_empty()) {
            return Some(Fault::new(FaultCode::JBudget, Where::key(id), batch.over.clone()));
        }
        let policy = &self.state.policy;
        let (tokens_limit, ms_limit, money_limit) =
            (policy.tokens_per_scenario, policy.author_ms_per_scenario, policy.money_per_scenario);
        if tokens_limit == 0 && ms_limit == 0 && money_limit == 0 {
            return None;
        }
        let first = JobKey { scenario: id.clone(), stage: Stage::Proposal, item: Item::Whole, revision: 0 };
        let own = self.state.jobs.range(first..).take_while(|(key, _)| key.scenario == *id);
        let attempts = own.filter(|(key, _)| pipeline::is_authored(key.stage)).flat_map(|(_, job)| &job.attempts);
        let (input, output, ms) = attempts.fold((0_u64, 0_u64, 0_u64), |(input, output, ms), attempt| {
            let (asked, answered) = attempt.tokens;
            (input.saturating_add(asked), output.saturating_add(answered), ms.saturating_add(attempt.wall_ms))
        });
        let tokens = input.saturating_add(output);
        let money = self.state.money(id, (input, output));
        let over = |spent: u64, limit: u64| limit > 0 && spent >= limit;
        let message = if over(tokens, tokens_limit) {
            format!(
                "{tokens} tokens were spent, {tokens_limit} are allowed; `orchestrator.tokens_per_scenario` sets it"
            )
        } else if over(money, money_limit) {
            let (spent, limit) = (money / 10_000, money_limit / 10_000);
            format!("authors cost {spent} cents, {limit} are allowed; `orchestrator.cents_per_scenario` sets it")
        } else if over(ms, ms_limit) {
            let (spent, limit) = (ms / 1_000, ms_limit / 1_000);
            format!("authors took {spent} s, {limit} s are allowed; `orchestrator.author_s_per_scenario` sets it")
        } else {
            return None;
        };
        Some(Fault::new(FaultCode::JBudget, Where::key(id), message))
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

impl State {
    /// What tokens in and out cost the author of a scenario, in millionths.
    pub(crate) fn money(&self, id: &ScenarioId, tokens: (u64, u64)) -> u64 {
        let author = self.scenarios.get(id).and_then(|scenario| scenario.spec.settings.get("author"));
        let server = author.and_then(|author| AuthorSpec::server_in(author));
        let price = server.and_then(|server| price_of(&self.policy.prices, server));
        price.map_or(0, |price| cost_of(*price, tokens))
    }
}

/// What tokens in and out cost, in millionths of the currency, where a million of them costs `price`, each in millionths as well.
#[must_use]
pub fn cost_of(price: (u64, u64), tokens: (u64, u64)) -> u64 {
    let cost = |tokens: u64, price: u64| u128::from(tokens) * u128::from(price) / 1_000_000;
    u64::try_from(cost(tokens.0, price.0) + cost(tokens.1, price.1)).unwrap_or(u64::MAX)
}

/// The price of a server with its model, `openai:gpt-4o`: that of the longest name in the table with which the model's name begins.
///
/// Servers add a date to the name that was asked for, so `gpt-4o` is the price of `gpt-4o-2024-08-06` where no longer name is
/// known. A name in the table may say the server as well, and then holds for this server only and before the same name without one.
#[must_use]
pub fn price_of<'a, P>(prices: &'a BTreeMap<String, P>, server: &str) -> Option<&'a P> {
    let model = server.split_once(':').map_or(server, |(_, model)| model);
    let before = server.len() - model.len();
    let begins =
        |name: &str, known: &str| name.strip_prefix(known).is_some_and(|rest| rest.is_empty() || rest.starts_with('-'));
    let begins = |known: &str| {
        let whole = known.len().checked_sub(before).filter(|length| *length > 0 && begins(server, known));
        whole.map(|length| (length, true)).or_else(|| begins(model, known).then_some((known.len(), false)))
    };
    let found = prices.iter().filter_map(|(known, price)| Some((begins(known)?, price)));
    found.max_by_key(|(length, _)| *length).map(|(_, price)| price)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_price_is_that_of_the_longest_name_that_begins_the_models() {
        let names = ["gpt-4", "gpt-4o", "gpt-4o-mini", "azure:gpt-4o", "local:llama", "qwen:7b"];
        let prices: BTreeMap<String, &str> = names.iter().map(|name| ((*name).to_owned(), *name)).collect();
        for (server, name) in [
            ("openai:gpt-4o", Some("gpt-4o")),
            ("gpt-4o", Some("gpt-4o")),
            ("openai:gpt-4o-2024-08-06", Some("gpt-4o")),
            ("openai:gpt-4o-mini-2024", Some("gpt-4o-mini")),
            ("azure:gpt-4o-2024", Some("azure:gpt-4o")),
            ("azure:gpt-4o-mini", Some("gpt-4o-mini")),
            ("openai:gpt-4omni", None),
            ("openai:llama", None),
            ("local:llama", Some("local:llama")),
            ("ollama:qwen:7b", Some("qwen:7b")),
            ("qwen:7b", Some("qwen:7b")),
            ("gpt-4:other", None),
        ] {
            assert_eq!(price_of(&prices, server).copied(), name, "{server}");
        }
    }
}
