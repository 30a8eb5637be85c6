//! The author itself: a question in, an answer as text out.

use serde_json::{Map, Value, json};
use socrates_model::job::Stage;
use socrates_model::{Location, Paths, Proposal, Reading, Request};
use socrates_prompts::Question;
use socrates_solver::Miss;

use crate::name::NAME;
use crate::{mended, proposal, solve};

/// The offline author.
///
/// Plays by the same rules as a language model: it gets the typed question and answers with text, which goes
/// through the same parser and the same checks.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Offline;

impl Offline {
    /// Name of this author, as artifacts spell it.
    pub const NAME: &'static str = NAME;

    /// The answer to a question, as JSON text; the same question gives the same answer.
    ///
    /// What cannot be answered (no way on the map, a stage without questions) is an object with a single member `cannot` that
    /// says why, which the parser refuses with that reason (E-CANNOT).
    #[must_use]
    pub fn answer(question: &Question) -> String {
        match question.stage {
            Stage::Proposal if question.reading.by.is_author() => read_and_proposed(question),
            Stage::Proposal => text(&proposal::propose(question)),
            Stage::Paths => match with_proposal(question, |known| Some(solve::solve(question, known))) {
                Some(Ok(paths)) => text(&paths),
                Some(Err(miss)) => json!({ "cannot": miss.to_string() }).to_string(),
                None => json!({ "cannot": "there is no proposal" }).to_string(),
            },
            Stage::Behaviors => {
                with_proposal(question, |known| Some(behaviors(question, known))).unwrap_or_else(|| "{}".to_owned())
            }
            Stage::Simulation | Stage::Scoring | Stage::Review => {
                json!({ "cannot": "only proposals, paths and behaviors are written" }).to_string()
            }
        }
    }
}

/// A proposal with the account of the request, which is read here as the question leaves it to its author.
fn read_and_proposed(question: &Question) -> String {
    let own = crate::read(&question.request, &question.location);
    let reading = crate::accounted::beside(own, &question.reading);
    let proposal = proposal::propose(&Question { reading: reading.clone(), ..question.clone() });
    let mut answer = serde_json::to_value(&proposal).unwrap_or_default();
    if let Some(members) = answer.as_object_mut() {
        members.insert("reading".to_owned(), crate::accounted::account(question, &reading, &proposal));
    }
    text(&answer)
}

/// Calls with the question's proposal; a question that came without one gets it from the same rules.
fn with_proposal<T>(question: &Question, answer: impl FnOnce(&Proposal) -> Option<T>) -> Option<T> {
    match &question.proposal {
        Some(known) => answer(known),
        None => {
            answer(&proposal::propose(&Question { stage: Stage::Proposal, feedback: Vec::new(), ..question.clone() }))
        }
    }
}

fn text<T: serde::Serialize>(answer: &T) -> String {
    serde_json::to_string_pretty(answer).unwrap_or_else(|why| json!({ "cannot": why.to_string() }).to_string())
}

fn behaviors(question: &Question, proposal: &Proposal) -> String {
    let mut humans = Map::new();
    for human in question.humans(proposal) {
        let rules = mended::rules(human, proposal, &question.feedback);
        humans.insert(human.id.to_string(), json!({ "description": human.behavior, "rules": rules }));
    }
    let answer = Value::Object(Map::from_iter([
        ("humans".to_owned(), Value::Object(humans)),
        ("author".to_owned(), json!(NAME)),
    ]));
    text(&answer)
}

/// The proposal of a request that is stated whole, such as [`socrates_model::Scenario::stated_in`] gives it.
#[must_use]
pub fn proposed(question: &Question) -> Proposal {
    proposal::propose(question)
}

/// The paths of a proposal.
///
/// # Errors
/// What the map lacks for them, and by how much.
pub fn ways(question: &Question, proposal: &Proposal) -> Result<Paths, Miss> {
    solve::solve(question, proposal)
}

/// Why a request can have no paths on a map, whatever is drawn; nothing where only the author finds that out.
#[must_use]
pub fn impossible(request: &Request, reading: &Reading, location: &Location) -> Option<Miss> {
    let mut question = Question::first(request.clone(), reading.clone(), location.clone(), 0);
    let mut proposal = proposal::propose(&question);
    if reading.humans.is_empty() {
        // Nobody asked for these people: another draw has others.
        proposal.humans.clear();
    }
    question.stage = Stage::Paths;
    socrates_solver::impossible(&solve::problem(&question, &proposal))
}
