//! The offline author's account of a request, for questions in which the author reads the texts itself.

use std::collections::BTreeMap;

use serde_json::{Map, Value, json};
use socrates_model::statement::{Became, Statement};
use socrates_model::{Clause, ClauseRole, FactKind, Proposal, Reading};
use socrates_prompts::{Question, Sentence, sentences};

/// A reading whose facts have the ids of those that the question states, and ids that are free where it states none.
pub(crate) fn beside(mut own: Reading, stated: &Reading) -> Reading {
    let mut free = stated.facts.len();
    let mut renamed = BTreeMap::new();
    for fact in &mut own.facts {
        let same = stated.facts.iter().find(|other| other.kind == fact.kind);
        let id = same.map_or_else(
            || {
                free += 1;
                format!("f{free}")
            },
            |same| same.id.clone(),
        );
        renamed.insert(std::mem::replace(&mut fact.id, id.clone()), id);
    }
    for statement in &mut own.statements {
        if let Became::Read { facts, .. } = &mut statement.became {
            for id in facts {
                if let Some(new) = renamed.get(id) {
                    id.clone_from(new);
                }
            }
        }
    }
    own
}

/// The member `reading` of an answer: what the grammar read, sentence by sentence.
pub(crate) fn account(question: &Question, reading: &Reading, proposal: &Proposal) -> Value {
    // What is stated has its fact already.
    let mut told: Vec<String> = question.reading.facts.iter().map(|fact| fact.id.clone()).collect();
    let shares = sentences(&question.request).into_iter().map(|sentence| {
        let share = share(&sentence, reading, proposal, &mut told);
        (sentence.id, share)
    });
    Value::Object(shares.collect::<Map<String, Value>>())
}

fn share(sentence: &Sentence, reading: &Reading, proposal: &Proposal, told: &mut Vec<String>) -> Value {
    let own: Vec<&Statement> = reading.statements.iter().filter(|one| one.meets(sentence.at, sentence.span)).collect();
    let ids = own.iter().flat_map(|one| if let Became::Read { facts, .. } = &one.became { &facts[..] } else { &[] });
    let mut claims = Vec::new();
    for id in ids {
        if told.contains(id) {
            continue;
        }
        let Some(fact) = reading.facts.iter().find(|fact| fact.id == *id) else { continue };
        told.push(id.clone());
        let shows = |clause: &&Clause| clause.source == *id && clause.must && clause.role == ClauseRole::Setup;
        let carrier = proposal.expected_events.iter().find(shows);
        // How somebody stands to the robot's way is in their part where no clause shows it.
        if carrier.is_none() && matches!(fact.kind, FactKind::Relates { .. }) {
            continue;
        }
        let of = carrier.map_or_else(
            || "robot".to_owned(),
            |clause| clause.predicate.human().map_or_else(|| "all".to_owned(), |human| human.to_string()),
        );
        let quote = if sentence.shown.contains(&fact.quote) { &fact.quote } else { &sentence.shown };
        claims.push(json!(format!("{id} {of}: {quote}")));
    }
    if !claims.is_empty() {
        return Value::Array(claims);
    }
    let unplayed = own.iter().find(|one| one.is_unplayed()).map(|one| one.told());
    if let Some(why) = unplayed {
        return json!([format!("cannot_be_played: {why}")]);
    }
    let reason =
        own.iter().find_map(|one| if let Became::Background(reason) = one.became { Some(reason.name()) } else { None });
    match reason {
        Some(reason) => json!([reason]),
        None => {
            let id = format!("r{}", sentence.id.trim_start_matches('s'));
            json!([format!("{id} robot: {}", sentence.shown)])
        }
    }
}
