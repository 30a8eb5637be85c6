//! What becomes of the sentences of a request where its author reads them: checked, and turned into a reading.
//!
//! ```text
//! account + what the request states ─► check: every sentence, verbatim quotes, ids ─► reading: facts, a statement for each sentence
//!                                                                                        │
//!                                          the grammar, where it knows the language ─► dispute
//! ```

use std::collections::BTreeSet;

use socrates_model::job::Stage;
use socrates_model::reading::ReadHuman;
use socrates_model::statement::{Became, Statement};
use socrates_model::{Fact, FactKind, Fault, FaultCode, Proposal, Reading, Where};
use socrates_prompts::{Account, Claim, Question, Sentence, Share, sentences};

/// Most sentences or quotes that one message names.
const MOST: usize = 4;

/// Every fault of an account: a sentence left out or made up, a quote that is not there, an id twice.
pub(crate) fn check(account: &Account, question: &Question) -> Vec<Fault> {
    let all = sentences(&question.request);
    let mut faults = Vec::new();
    let mut bad = |at: String, message: String| faults.push(Fault::new(FaultCode::PAccount, Where::key(at), message));
    for sentence in all.iter().filter(|sentence| !account.0.contains_key(&sentence.id)) {
        bad(
            format!("reading.{}", sentence.id),
            format!(
                "is missing; account for \"{}\": facts with quotes, a reason, or why it cannot be played",
                sentence.shown
            ),
        );
    }
    let stated: BTreeSet<&str> = question.reading.facts.iter().map(|fact| fact.id.as_str()).collect();
    let mut ids: BTreeSet<&str> = BTreeSet::new();
    for (id, share) in &account.0 {
        let Some(sentence) = all.iter().find(|sentence| sentence.id == *id) else {
            let known: Vec<&str> = all.iter().map(|sentence| sentence.id.as_str()).take(MOST).collect();
            bad(format!("reading.{id}"), format!("is no sentence of the request; it has {} …", known.join(", ")));
            continue;
        };
        let Share::Asked { claims, expected, cannot } = share else { continue };
        if claims.is_empty() && expected.is_none() && cannot.is_none() && stated.is_empty() {
            let message = format!("is empty, and nothing is stated; account for \"{}\"", sentence.shown);
            bad(format!("reading.{id}"), message);
        }
        for claim in claims {
            // The words beside a line are for people.
            if !claim.is_line() && !holds(&sentence.shown, &claim.quote) {
                bad(
                    format!("reading.{id}"),
                    format!(
                        "quotes \"{}\", which does not stand in \"{}\"; copy its words",
                        claim.quote, sentence.shown
                    ),
                );
            }
            if stated.contains(claim.fact.as_str()) {
                bad(
                    format!("reading.{id}"),
                    format!(
                        "has `{}`, which is a fact under `stated`: leave that out, and give your own facts ids from f{} on",
                        claim.fact,
                        stated.len() + 1
                    ),
                );
            } else if !claim.is_line() && !ids.insert(&claim.fact) {
                let what = format!("has `{}`, which another fact has; give each fact its own id", claim.fact);
                bad(format!("reading.{id}"), what);
            }
        }
    }
    faults
}

/// The question of a proposal that is made again, for an author that reads the request itself: what is stated and what a person wished in
/// words binds, and what the author read before is no more than its last answer, which is shown with its account.
pub(crate) fn again(question: &Question) -> Option<Question> {
    if question.stage != Stage::Proposal || !question.reading.by.is_author() {
        return None;
    }
    let own = &question.reading.account;
    let account = if own.is_empty() { Account::of(&question.reading, &question.request).lines() } else { own.clone() };
    if account.is_empty() {
        return None;
    }
    let mut stated = socrates_offline::stated(&question.request, &question.location);
    stated.scenario.clone_from(&question.reading.scenario);
    // An earlier scenario of the author does not bind it.
    let before = question.reading.scenario.as_ref().map(|scenario| crate::stated::facts(scenario, question));
    for fact in &question.reading.facts {
        let of_scenario = before.as_ref().is_some_and(|before| before.facts.iter().any(|own| own.kind == fact.kind));
        let own = matches!(fact.kind, FactKind::Asked { .. }) || of_scenario;
        if !own && !stated.facts.iter().any(|other| other.id == fact.id) {
            stated.facts.push(fact.clone());
        }
    }
    Some(Question { reading: stated, account: Some(account), ..question.clone() })
}

/// Whether a quote stands in a sentence as it is, blanks apart.
fn holds(sentence: &str, quote: &str) -> bool {
    let line = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    let quote = line(quote);
    !quote.is_empty() && line(sentence).contains(&quote)
}

/// The reading that an account gives: what the request states, and what its author read of the texts; held against the grammar where
/// that knows the language.
pub(crate) fn reading(account: &Account, proposal: &Proposal, question: &Question) -> Reading {
    let mut reading = question.reading.clone();
    let all = sentences(&question.request);
    for sentence in &all {
        let Some(share) = account.0.get(&sentence.id) else { continue };
        if let Share::Asked { claims, .. } = share {
            reading.facts.extend(claims.iter().map(fact));
        }
        reading.statements.extend(statements(sentence, share, proposal));
    }
    if question.request.rough_scenario.as_deref().is_some_and(|text| !text.trim().is_empty()) {
        reading.humans = proposal.humans.iter().map(read_human).collect();
    }
    held_against(reading, question)
}

/// A reading held against the grammar, and with what the request waives.
pub(crate) fn held_against(mut reading: Reading, question: &Question) -> Reading {
    socrates_offline::dispute(&question.request, &question.location, &mut reading);
    reading.statements =
        reading.statements.into_iter().map(|statement| statement.waived_by(&question.request)).collect();
    reading
}

fn fact(claim: &Claim) -> Fact {
    Fact { id: claim.fact.clone(), quote: claim.quote.clone(), kind: FactKind::Asked { of: claim.of } }
}

fn read_human(human: &socrates_model::HumanProposal) -> ReadHuman {
    ReadHuman {
        id: human.id,
        role: human.role.clone(),
        summary: human.behavior.clone(),
        relation: Some(human.relation),
        rules: human.rules.clone(),
        group: human.group,
    }
}

/// The statements of a sentence: one for what is played, one for what is expected of a robot, one for what cannot be played.
fn statements(sentence: &Sentence, share: &Share, proposal: &Proposal) -> Vec<Statement> {
    fates(sentence, share, |claims| Became::Read {
        lines: claims.iter().flat_map(|claim| lines(claim, proposal)).collect(),
        facts: claims.iter().map(|claim| claim.fact.clone()).collect(),
    })
}

/// The statements of a sentence, of which `read` tells what its claims became.
pub(crate) fn fates(sentence: &Sentence, share: &Share, read: impl FnOnce(&[Claim]) -> Became) -> Vec<Statement> {
    let of = |became: Became| Statement {
        at: sentence.at,
        span: sentence.span,
        quote: sentence.quote.clone(),
        became,
        waived: false,
    };
    match share {
        Share::Background(reason) => vec![of(Became::Background(*reason))],
        Share::Asked { claims, expected, cannot } => {
            let expected = expected.as_ref().map(|words| Became::Read {
                lines: vec![format!("expected of a robot under test: {words}")],
                facts: Vec::new(),
            });
            // Nothing beyond what is stated.
            let read = (!claims.is_empty() || expected.is_none() && cannot.is_none()).then(|| read(claims));
            let unplayed = cannot.as_ref().map(|why| Became::NotPlayed { why: why.as_str().into() });
            read.into_iter().chain(expected).chain(unplayed).map(of).collect()
        }
    }
}

/// What of the scenario serves a claim, in words.
fn lines(claim: &Claim, proposal: &Proposal) -> Vec<String> {
    let serve = proposal.expected_events.iter().filter(|clause| clause.source == claim.fact);
    let who = claim.of.map_or_else(String::new, |of| format!("{of}: "));
    let told: Vec<String> = serve.map(|clause| format!("{who}{}", clause.text)).collect();
    if told.is_empty() { vec![format!("{who}as its task or script says")] } else { told }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::attempt::attempt;
    use crate::author::Says;
    use crate::offline::Offline;
    use serde_json::{Value, json};
    use socrates_model::reading::ReadBy;
    use socrates_model::{FaultCode, Location, Request};

    const ROUGH: &str =
        "It is a busy morning. A visitor comes towards the robot in the corridor and stops when the robot is near.";

    fn asked(rough: &str) -> (Question, Location) {
        let location = socrates_maps::shipped::load("office").unwrap();
        let request = json!({"location": "office", "social_context": "An office.", "task": "Drive to the exit.",
            "rough_scenario": rough});
        let request: Request = serde_json::from_value(request).unwrap();
        let reading = socrates_offline::stated(&request, &location);
        (Question::first(request, reading, location.clone(), 5), location)
    }

    async fn answer(question: &Question) -> Value {
        let made = attempt(&Offline, question).await.unwrap();
        serde_json::from_str(&made.exchange.answer).unwrap()
    }

    async fn refused(question: &Question, edit: impl FnOnce(&mut Value)) -> Vec<String> {
        let mut answer = answer(question).await;
        edit(&mut answer["reading"]);
        let refused = attempt(&Says(answer.to_string()), question).await.unwrap_err();
        assert!(refused.faults.iter().all(|fault| fault.code == FaultCode::PAccount), "{:?}", refused.faults);
        refused.faults.iter().map(ToString::to_string).collect()
    }

    #[tokio::test]
    async fn an_author_that_reads_gives_a_reading_in_which_every_sentence_has_a_fate() {
        let (question, _) = asked(ROUGH);
        let made = attempt(&Offline, &question).await.unwrap();
        let reading = made.reading.unwrap();
        assert_eq!(reading.by, ReadBy::Author);
        let fates: Vec<(&str, &str)> =
            reading.statements.iter().map(|statement| (statement.quote.as_str(), statement.fate())).collect();
        assert_eq!(fates.len(), 4, "{fates:?}");
        assert_eq!(fates[1].1, "read", "{fates:?}");
        assert!(reading.facts.iter().all(|fact| matches!(fact.kind, FactKind::Asked { .. })), "{:?}", reading.facts);
        assert_eq!(reading.humans.len(), 1);
        assert!(reading.missing().is_empty());
    }

    #[tokio::test]
    async fn a_proposal_that_is_asked_for_again_has_its_account_beside_it_and_is_bound_by_nothing_of_it() {
        let (first, _) = asked(ROUGH);
        assert_eq!(again(&first), None);
        let made = attempt(&Offline, &first).await.unwrap();
        let crate::Written::Proposal(proposal) = &made.written else { panic!() };
        let wish =
            Fact { id: "w1".into(), quote: "slower".into(), kind: FactKind::RobotSays(socrates_model::Gesture::Wait) };
        let mut reading = made.reading.unwrap();
        reading.facts.push(wish.clone());
        let refused = Some(serde_json::to_string(proposal).unwrap());
        let feedback = vec![Fault::new(FaultCode::DNoTrig, "c2", "never")];
        let asked = again(&Question { reading, refused, feedback, ..first.clone() }).unwrap();
        let mut bound = first.reading.facts.clone();
        bound.push(wish);
        assert_eq!(asked.reading.facts, bound, "what a person wished stays");
        let account = asked.account.unwrap();
        assert_eq!((account["s1"].clone(), account.len()), (vec!["looks".to_owned()], 4));
    }

    #[tokio::test]
    async fn an_edit_in_words_keeps_the_clauses_of_what_an_author_read() {
        let (question, location) = asked(ROUGH);
        let made = attempt(&Offline, &question).await.unwrap();
        let (crate::Written::Proposal(proposal), Some(reading)) = (made.written, made.reading) else { panic!() };
        let draft = socrates_offline::Draft { proposal, paths: None, behaviors: None };
        let asked = Question { reading, ..question };
        for words in [
            "human_1 should wave at the robot",
            "human_1 walks at 0.8 m/s",
            "human_1 gives way when the robot is within 2 m",
        ] {
            let edited = socrates_offline::edit(&asked, &draft, words);
            assert!(!edited.done.is_empty(), "{words}: {:?}", edited.not_done);
            let faults = socrates_checks::check_proposal(&edited.draft.proposal, &edited.reading, &location);
            assert_eq!(socrates_model::fault::hard(&faults), [], "{words}");
            let refused = Some(serde_json::to_string(&edited.draft.proposal).unwrap());
            let shown = again(&Question { reading: edited.reading, refused, ..asked.clone() });
            let account = shown.unwrap_or_else(|| panic!("{words}")).account.unwrap();
            assert_eq!(account.len(), 4, "{words}: {account:?}");
        }
    }

    #[tokio::test]
    async fn a_sentence_left_out_or_made_up_is_refused() {
        let (question, _) = asked(ROUGH);
        let told = refused(&question, |reading| drop(reading.as_object_mut().unwrap().remove("s1"))).await;
        assert!(told[0].contains("It is a busy morning."), "{told:?}");
        let told = refused(&question, |reading| reading["s9"] = json!(["setting"])).await;
        assert!(told[0].contains("no sentence of the request"), "{told:?}");
    }

    #[tokio::test]
    async fn a_quote_that_does_not_stand_there_and_an_id_twice_are_refused() {
        let (question, _) = asked(ROUGH);
        let told = refused(&question, |reading| {
            let line = reading["s2"][0].as_str().unwrap().to_owned();
            let (before, _) = line.split_once(':').unwrap();
            reading["s2"][0] = json!(format!("{before}: a visitor who flies"));
        })
        .await;
        assert!(told[0].contains("does not stand in"), "{told:?}");
        let told = refused(&question, |reading| {
            let first = reading["s2"][0].clone();
            reading["s2"].as_array_mut().unwrap().push(first);
        })
        .await;
        assert!(told[0].contains("which another fact has"), "{told:?}");
    }

    #[tokio::test]
    async fn a_fact_that_nobody_serves_is_refused() {
        let (question, _) = asked(ROUGH);
        let mut answer = answer(&question).await;
        answer["reading"]["s1"] = json!(["f77 human_1: busy"]);
        let refused = attempt(&Says(answer.to_string()), &question).await.unwrap_err();
        assert_eq!(refused.faults[0].code, FaultCode::PVerify);
        assert!(refused.faults[0].to_string().contains("\"busy\" was asked for"), "{:?}", refused.faults);
    }

    #[tokio::test]
    async fn background_in_which_somebody_acts_is_disputed_until_it_is_waived() {
        let (mut question, _) = asked("A visitor comes towards the robot in the corridor. He waves.");
        let mut answer = answer(&question).await;
        let clauses = answer["expected_events"].as_array_mut().unwrap();
        for clause in clauses {
            clause.as_object_mut().unwrap().remove("source");
        }
        for id in ["s1", "s2"] {
            answer["reading"][id] = json!(["looks"]);
        }
        let made = attempt(&Says(answer.to_string()), &question).await.unwrap();
        assert_eq!(made.reading.unwrap().missing()[0], "A visitor comes towards the robot in the corridor.");
        question.request.waive = vec!["A visitor comes towards the robot in the corridor. He waves.".to_owned()];
        let made = attempt(&Says(answer.to_string()), &question).await.unwrap();
        assert!(made.reading.unwrap().missing().is_empty());
    }

    #[tokio::test]
    async fn what_cannot_be_played_is_missing_with_the_authors_reason() {
        let (question, _) = asked(ROUGH);
        let mut answer = answer(&question).await;
        answer["reading"]["s1"] = json!(["cannot_be_played: mornings cannot be seen"]);
        let reading = attempt(&Says(answer.to_string()), &question).await.unwrap().reading.unwrap();
        assert_eq!(reading.missing(), ["It is a busy morning."]);
        assert!(reading.statements[0].told().contains("mornings"), "{:?}", reading.statements[0]);
    }

    #[tokio::test]
    async fn a_request_in_another_language_is_asked_and_marked_as_not_held_against_anything() {
        let (question, _) = asked("Eine Besucherin kommt dem Roboter im Flur entgegen und bleibt vor ihm stehen.");
        // Nobody's grammar reads it here: the answer is one to an English request, with the German words.
        let (english, _) = asked(ROUGH);
        let mut answer = answer(&english).await;
        let sources = answer["expected_events"].as_array_mut().unwrap();
        for clause in sources.iter_mut() {
            clause.as_object_mut().unwrap().remove("source");
        }
        let last = sources.iter().position(|clause| clause.to_string().contains("human_1")).unwrap();
        sources[last]["source"] = json!("f1");
        answer["reading"] =
            json!({"s1": ["f1 human_1: kommt dem Roboter im Flur entgegen"], "s2": ["errand"], "s3": ["setting"]});
        let reading = attempt(&Says(answer.to_string()), &question).await.unwrap().reading.unwrap();
        assert_eq!((reading.by, reading.missing().len()), (ReadBy::AuthorAlone, 0));
    }

    #[tokio::test]
    async fn every_shipped_request_can_be_accounted_for() {
        for name in socrates_maps::shipped::names() {
            let location = socrates_maps::shipped::load(name).unwrap();
            for (file, text) in socrates_maps::shipped::requests(name) {
                let request = Request::of_toml(text, None).unwrap();
                let reading = socrates_offline::stated(&request, &location);
                let question = Question::first(request, reading, location.clone(), 5);
                let made = attempt(&Offline, &question).await;
                let made = made.unwrap_or_else(|refused| panic!("{name}/{file}: {:?}", refused.faults));
                let reading = made.reading.unwrap();
                let all = sentences(&question.request).len();
                assert_eq!(reading.statements.len(), all, "{name}/{file}: {:?}", reading.statements);
                assert_eq!(reading.missing(), [""; 0], "{name}/{file}: {:?}", reading.statements);
            }
        }
    }
}
