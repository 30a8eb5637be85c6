//! Which detector finds which injected fault: every operator of the fault model against every check.
//!
//! ```text
//! right answer ──► as it is ───────────────► checks ──► false alarms, by code
//!       └────────► one fault of each kind ─► checks ──► the codes that are found, by kind
//! ```
//!
//! Injected faults, not a model's: the figures say what the checks are worth, nothing about any language model.

use std::collections::BTreeMap;

use socrates_model::fault::hard;
use socrates_model::job::Stage;
use socrates_model::{FaultCode, seeds::derive_seed};
use socrates_prompts::Question;

use crate::attempt::{Exchange, Written, attempt};
use crate::author::{Author, Says};
use crate::fault_model::{FaultKind, FaultRates, concerns};
use crate::faulty::FaultyAuthor;

/// An answer into which nothing was put.
#[derive(Debug, Clone, PartialEq)]
pub struct Clean {
    /// The question.
    pub question: Question,
    /// Its answer.
    pub answer: String,
}

/// What was found of one kind of fault.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Row {
    /// Answers with this fault in them.
    pub put_in: usize,
    /// Answers that have no place for it.
    pub no_place: usize,
    /// Those of them that were refused, or repaired where a repair is what it asks for.
    pub noticed: usize,
    /// Those in which its own code was found.
    pub own: usize,
    /// Codes that were found, with the number of answers.
    pub found: BTreeMap<FaultCode, usize>,
}

/// What was found in the answers into which nothing was put, by stage.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Alarms {
    /// Answers.
    pub answers: usize,
    /// Those of them that were refused.
    pub refused: usize,
    /// Codes for which they were refused.
    pub found: BTreeMap<FaultCode, usize>,
}

/// The whole table.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Confusion {
    /// By stage and kind of fault.
    pub rows: BTreeMap<(Stage, FaultKind), Row>,
    /// By stage.
    pub clean: BTreeMap<Stage, Alarms>,
}

/// The answers of an author to the three questions of one request, of which `first` asks for the proposal. Where the proposal
/// is refused there are no further questions.
pub async fn answers(author: &dyn Author, first: &Question) -> Vec<Clean> {
    let mut found = Vec::new();
    let mut proposal = None;
    for stage in [Stage::Proposal, Stage::Paths, Stage::Behaviors] {
        let seed = derive_seed(first.seed, &[stage.name()]);
        let question = Question { stage, seed, proposal: proposal.clone(), ..first.clone() };
        let Ok(answer) = author.ask(&question).await else { break };
        if stage == Stage::Proposal {
            match attempt(&Says(answer.text.clone()), &question).await.map(|made| made.written) {
                Ok(Written::Proposal(written)) => proposal = Some(written),
                Ok(Written::Paths(_) | Written::Behaviors(_)) | Err(_) => {}
            }
        }
        found.push(Clean { question, answer: answer.text });
        if proposal.is_none() {
            break;
        }
    }
    found
}

/// Puts every kind of fault into every right answer, one at a time, and looks which codes are found.
pub async fn confusion(answers: &[Clean]) -> Confusion {
    let mut table = Confusion::default();
    for clean in answers {
        let stage = clean.question.stage;
        let exchange = exchange(&Says(clean.answer.clone()), &clean.question).await;
        let alarms = table.clean.entry(stage).or_default();
        let codes = codes(&exchange, false);
        alarms.answers += 1;
        alarms.refused += usize::from(!codes.is_empty());
        for code in &codes {
            *alarms.found.entry(*code).or_default() += 1;
        }
        if !codes.is_empty() {
            continue;
        }
        for kind in FaultKind::ALL.iter().copied().filter(|kind| concerns(*kind, stage)) {
            let row = table.rows.entry((stage, kind)).or_default();
            put_in(clean, kind, row).await;
        }
    }
    table
}

async fn put_in(clean: &Clean, kind: FaultKind, row: &mut Row) {
    let rates = FaultRates { rates: BTreeMap::from([(kind, 1.0)]), ..FaultRates::default() };
    let faulty = FaultyAuthor::new(Says(clean.answer.clone()), rates, 1);
    let exchange = exchange(&faulty, &clean.question).await;
    if exchange.injected.is_empty() && !kind.is_of_server() {
        row.no_place += 1;
        return;
    }
    let found = codes(&exchange, true);
    row.put_in += 1;
    row.noticed += usize::from(!found.is_empty());
    row.own += usize::from(found.contains(&kind.code()));
    for code in found {
        *row.found.entry(code).or_default() += 1;
    }
}

async fn exchange(author: &dyn Author, question: &Question) -> Exchange {
    match attempt(author, question).await {
        Ok(made) => made.exchange,
        Err(refused) => *refused.exchange,
    }
}

/// The codes for which an answer was refused, each once; with those of its repairs where asked for.
fn codes(exchange: &Exchange, repairs: bool) -> Vec<FaultCode> {
    let repaired = exchange.repairs.iter().filter(|_| repairs).map(|fault| fault.code);
    let mut codes: Vec<FaultCode> = hard(&exchange.faults).iter().map(|fault| fault.code).chain(repaired).collect();
    codes.sort_unstable();
    codes.dedup();
    codes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{good_paths, good_proposal, question};

    #[tokio::test]
    async fn a_right_answer_is_turned_wrong_kind_by_kind_and_a_wrong_one_is_an_alarm() {
        let right = Clean { question: question(Stage::Paths), answer: good_paths() };
        let wrong = Clean { question: question(Stage::Paths), answer: "{}".into() };
        let table = confusion(&[right, wrong]).await;
        let alarms = &table.clean[&Stage::Paths];
        assert_eq!((alarms.answers, alarms.refused), (2, 1));
        let gap = &table.rows[&(Stage::Paths, FaultKind::Gdisc)];
        assert_eq!((gap.put_in, gap.own), (1, 1));
        let group = &table.rows[&(Stage::Paths, FaultKind::Ggrp)];
        assert_eq!((group.put_in, group.no_place), (0, 1), "nobody is in a group");
        assert!(!table.rows.contains_key(&(Stage::Paths, FaultKind::Bdead)));
    }

    #[tokio::test]
    async fn an_authors_answers_follow_from_its_proposal() {
        let found = answers(&Says(good_proposal()), &question(Stage::Proposal)).await;
        let stages: Vec<Stage> = found.iter().map(|clean| clean.question.stage).collect();
        assert_eq!(stages, [Stage::Proposal, Stage::Paths, Stage::Behaviors]);
        assert!(found[1].question.proposal.is_some());
        assert_eq!(answers(&Says("no".into()), &question(Stage::Proposal)).await.len(), 1);
    }
}
