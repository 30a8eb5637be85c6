//! Faults put in on purpose, at set rates, for reliability experiments.

use async_trait::async_trait;
use socrates_prompts::Question;

use crate::author::{Answer, AskError, Author};
use crate::fault_model::{Asked, FaultKind, FaultRates};
use crate::mutate;

/// Wraps an author and puts faults into its answers.
///
/// Draws are keyed by experiment seed, question seed, stage, attempt and kind, so that results depend neither on the number of
/// workers nor on their order.
pub struct FaultyAuthor<A> {
    inner: A,
    rates: FaultRates,
    attempt: u32,
}

impl<A: Author> FaultyAuthor<A> {
    /// The author with faults, for this attempt of its job (from 1).
    #[must_use]
    pub const fn new(inner: A, rates: FaultRates, attempt: u32) -> Self {
        Self { inner, rates, attempt }
    }
}

#[async_trait]
impl<A: Author> Author for FaultyAuthor<A> {
    async fn ask(&self, question: &Question) -> Result<Answer, AskError> {
        let asked = Asked::of(question, self.attempt);
        let struck = self.rates.struck(&asked);
        for kind in &struck {
            let message = format!("injected: {}", kind.code().about());
            if *kind == FaultKind::T429 {
                return Err(AskError { code: kind.code(), message, retry_after_ms: Some(100) });
            }
            if kind.is_of_server() {
                return Err(AskError::new(kind.code(), message));
            }
        }
        let mut answer = self.inner.ask(question).await?;
        // Faults of the text come last: after them the answer can no longer be changed as JSON.
        let textual =
            |kind: &FaultKind| matches!(kind, FaultKind::Empty | FaultKind::Trunc | FaultKind::Json | FaultKind::Fence);
        let (last, mut first): (Vec<FaultKind>, Vec<FaultKind>) = struck.into_iter().partition(textual);
        // What takes a rule away goes before what puts one in, or one fault would undo the other.
        first.sort_by_key(|kind| *kind != FaultKind::Bmatch);
        for kind in first.into_iter().chain(last) {
            let draw = self.rates.draw(&asked, kind.word(), "where");
            if let Some(text) = mutate::apply(kind, question, &answer.text, draw) {
                answer.text = text;
                answer.injected.push(kind.word().to_owned());
            }
        }
        if !answer.injected.is_empty() {
            tracing::debug!(stage = %question.stage, injected = ?answer.injected, "fault injected");
        }
        Ok(answer)
    }

    fn name(&self) -> String {
        format!("{} with injected faults", self.inner.name())
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use socrates_model::job::Stage;

    use super::*;
    use crate::attempt::attempt;
    use crate::fault_model::concerns;
    use crate::testing::{Scripted, good_behaviors, good_paths, good_proposal, question};

    fn only(kind: FaultKind, rate: f64) -> FaultRates {
        FaultRates { rates: BTreeMap::from([(kind, rate)]), ..FaultRates::default() }
    }

    fn good(stage: Stage) -> String {
        match stage {
            Stage::Proposal => good_proposal(),
            Stage::Paths => good_paths(),
            Stage::Behaviors | Stage::Simulation | Stage::Scoring | Stage::Review => good_behaviors(),
        }
    }

    #[tokio::test]
    async fn good_answers_are_good_without_faults() {
        for stage in [Stage::Proposal, Stage::Paths, Stage::Behaviors] {
            let faulty = FaultyAuthor::new(Scripted::says(&good(stage)), FaultRates::default(), 1);
            let made = attempt(&faulty, &question(stage)).await.unwrap();
            assert!(made.exchange.faults.is_empty(), "{stage}: {:?}", made.exchange.faults);
        }
    }

    #[tokio::test]
    async fn every_injected_fault_is_found_under_its_own_code() {
        let mut tried = 0;
        for stage in [Stage::Proposal, Stage::Paths, Stage::Behaviors] {
            for kind in FaultKind::ALL.iter().copied().filter(|kind| concerns(*kind, stage)) {
                let faulty = FaultyAuthor::new(Scripted::says(&good(stage)), only(kind, 1.0), 1);
                let outcome = attempt(&faulty, &question(stage)).await;
                // Some kinds need more than this small scene has; they are tried on whole scenarios.
                if outcome.as_ref().is_ok_and(|made| made.exchange.injected.is_empty()) {
                    continue;
                }
                tried += 1;
                if kind == FaultKind::Fence {
                    assert_eq!(outcome.unwrap().exchange.repairs[0].code, kind.code());
                    continue;
                }
                let faults = outcome.expect_err(kind.word()).faults;
                assert!(faults.iter().any(|fault| fault.code == kind.code()), "{stage} {}: {faults:?}", kind.word());
            }
        }
        assert!(tried > 50, "{tried} of three stages");
    }

    #[tokio::test]
    async fn rates_are_kept_and_the_attempt_draws_anew() {
        let mut struck = 0;
        let mut differs = false;
        for seed in 0..400 {
            let mut asked = question(Stage::Paths);
            asked.seed = seed;
            let hit = |attempt| FaultyAuthor::new(Scripted::says(&good_paths()), only(FaultKind::Gdisc, 0.3), attempt);
            let injected = |answer: Answer| !answer.injected.is_empty();
            let (one, two) = (hit(1).ask(&asked).await.unwrap(), hit(2).ask(&asked).await.unwrap());
            let again = hit(1).ask(&asked).await.unwrap();
            assert_eq!(one, again);
            let (one, two) = (injected(one), injected(two));
            struck += u32::from(one);
            differs |= one != two;
        }
        assert!((90..150).contains(&struck), "{struck} of 400 at a rate of 0.3");
        assert!(differs);
    }

    #[tokio::test]
    async fn first_only_leaves_later_attempts_alone() {
        let rates = FaultRates { first_only: true, ..only(FaultKind::Trunc, 1.0) };
        let asked = question(Stage::Paths);
        assert!(attempt(&FaultyAuthor::new(Scripted::says(&good_paths()), rates.clone(), 1), &asked).await.is_err());
        assert!(attempt(&FaultyAuthor::new(Scripted::says(&good_paths()), rates, 2), &asked).await.is_ok());
    }
}
