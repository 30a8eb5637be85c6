//! An answer that states a scenario: its proposal and its reading follow from it, and nothing of them is the author's choice.
//!
//! ```text
//! scenario ─► reading (facts) ─► proposal (people, rules, script, clauses) ─► ways on the map
//! account ──► what became of each sentence, by the lines that serve it
//! ```

use std::collections::BTreeSet;

use socrates_model::form::PlaceWord;
use socrates_model::job::Stage;
use socrates_model::rule::RobotDo;
use socrates_model::statement::Became;
use socrates_model::{
    AgentId, Fact, FactKind, FailureClass, Fault, FaultCode, HumanId, Proposal, Reading, Scenario, Where,
};
use socrates_prompts::scenario::ScenarioAnswer;
use socrates_prompts::{Account, Claim, Question, Share, sentences};

use crate::account;

/// Most lines that one message lists.
const MOST: usize = 24;

/// The question whose request states the scenario of its reading; none where there is no scenario.
pub(crate) fn asked(question: &Question) -> Option<Question> {
    let scenario = question.reading.scenario.as_ref()?;
    Some(Question { request: scenario.stated_in(&question.request), ..question.clone() })
}

/// The facts of a scenario.
pub(crate) fn facts(scenario: &Scenario, question: &Question) -> Reading {
    let request = scenario.stated_in(&question.request);
    let mut reading = socrates_offline::stated(&request, &question.location);
    reading.task.clone_from(&question.reading.task);
    reading.scenario = Some(scenario.clone());
    reading
}

/// The proposal of a scenario.
///
/// # Errors
/// Places and acts that the map or the simulation lacks, each with its key; a map without ways for it.
pub(crate) fn proposal(stated: &ScenarioAnswer, question: &Question) -> Result<Proposal, Vec<Fault>> {
    let reading = facts(&stated.scenario, question);
    let missing = missing(question, &reading);
    if !missing.is_empty() {
        return Err(missing);
    }
    let problems = socrates_model::fault::hard(&reading.problems);
    if !problems.is_empty() {
        return Err(problems.into_iter().map(of_answer).collect());
    }
    let request = stated.scenario.stated_in(&question.request);
    let ask = Question { request, reading, feedback: Vec::new(), refused: None, ..question.clone() };
    let mut proposal = socrates_offline::propose(&ask);
    if let Err(miss) = socrates_offline::solve(&Question { stage: Stage::Paths, ..ask }, &proposal) {
        let message = format!("this map has no ways for it: {miss}");
        return Err(vec![Fault::new(FaultCode::PPlace, Where::key("$.scenario"), message)]);
    }
    let beside = &stated.beside;
    for (text, own) in [(&beside.title, &mut proposal.title), (&beside.description, &mut proposal.description)] {
        if !text.trim().is_empty() {
            own.clone_from(text);
        }
    }
    proposal.robot.task.clone_from(&question.request.task);
    if !beside.expected_behavior.trim().is_empty() {
        proposal.robot.expected_behavior.clone_from(&beside.expected_behavior);
    }
    proposal.notes.extend(beside.notes.iter().cloned());
    Ok(proposal)
}

/// Statements of the request that the scenario lacks, beyond the words of the task.
fn missing(question: &Question, reading: &Reading) -> Vec<Fault> {
    let said = |fact: &&Fact| reading.facts.iter().any(|own| own.kind == fact.kind);
    let words =
        |fact: &&Fact| matches!(fact.kind, FactKind::RobotTask(_) | FactKind::Pattern(_) | FactKind::Asked { .. });
    let missing = question.reading.facts.iter().filter(|fact| !words(fact) && !said(fact));
    let fault = |fact: &Fact| {
        let message = format!("does not say what is stated: {} ({})", fact.id, fact.quote);
        Fault::new(FaultCode::PRough, Where::key("$.scenario"), message)
    };
    missing.map(fault).collect()
}

/// A problem of a request as a fault of an answer: its author can change what only a person could change of a request.
fn of_answer(problem: Fault) -> Fault {
    let code = if problem.code.class() == FailureClass::Permanent { FaultCode::PCap } else { problem.code };
    Fault { code, ..problem }
}

/// The names of the lines of a scenario.
fn lines(scenario: &Scenario) -> BTreeSet<String> {
    let mut all: BTreeSet<String> = ["all", "robot"].map(str::to_owned).into();
    let form = &scenario.form;
    for person in form.people() {
        let (id, human) = (person.id, person.human);
        all.insert(id.to_string());
        let parts = [
            ("place", human.place.is_some()),
            ("start", human.start.is_some()),
            ("goal", human.goal.is_some()),
            ("side", human.side.is_some()),
            ("facing", human.facing.is_some()),
            ("pace", human.pace.is_some()),
            ("group", human.group.is_some()),
        ];
        all.extend(parts.into_iter().filter(|(_, there)| *there).map(|(key, _)| format!("{id}.{key}")));
        for (key, steps) in [("does", &human.does), ("reacts", &human.reacts)] {
            all.extend((1..=steps.len()).map(|number| format!("{id}.{key}.{number}")));
        }
    }
    all.extend(form.group_names().into_iter().map(|name| format!("group.{name}")));
    all.extend((1..=form.orders.len()).map(|number| format!("order.{number}")));
    let robot = &scenario.robot;
    let parts = [
        ("start", robot.start.is_some()),
        ("goal", robot.goal.is_some()),
        ("via", robot.via.is_some()),
        ("avoid", !robot.avoid.is_empty()),
        ("return", robot.returns),
    ];
    all.extend(parts.into_iter().filter(|(_, there)| *there).map(|(key, _)| format!("robot.{key}")));
    all.extend((1..=robot.does.len()).map(|number| format!("robot.does.{number}")));
    all
}

/// Every claim of an account that names no line of the scenario.
pub(crate) fn check(account: &Account, scenario: &Scenario) -> Vec<Fault> {
    let known = lines(scenario);
    let claims = account.0.iter().flat_map(|(sentence, share)| {
        let claims = if let Share::Asked { claims, .. } = share { &claims[..] } else { &[] };
        claims.iter().map(move |claim| (sentence, claim))
    });
    let unknown = claims.filter(|(_, claim)| !known.contains(&claim.fact));
    let fault = |(sentence, claim): (&String, &Claim)| {
        let listed: Vec<&str> = known.iter().map(String::as_str).take(MOST).collect();
        let message =
            format!("names `{}`, which is no line of the scenario; its lines: {}", claim.fact, listed.join(", "));
        Fault::new(FaultCode::PAccount, Where::key(format_args!("reading.{sentence}")), message)
    };
    unknown.map(fault).collect()
}

/// The reading that a scenario and its account give.
pub(crate) fn reading(account: &Account, scenario: &Scenario, proposal: &Proposal, question: &Question) -> Reading {
    let mut reading = facts(scenario, question);
    reading.account = account.lines();
    for sentence in &sentences(&question.request) {
        let Some(share) = account.0.get(&sentence.id) else { continue };
        let statements = account::fates(sentence, share, |claims| {
            let serve: Vec<&Fact> = claims.iter().flat_map(|claim| serving(claim, &reading, scenario)).collect();
            let shown = |fact: &&Fact| {
                let clause = proposal.expected_events.iter().find(|clause| clause.source == fact.id);
                clause.map(|clause| clause.text.clone())
            };
            Became::Read {
                lines: serve.iter().filter_map(shown).collect(),
                facts: serve.iter().map(|fact| fact.id.clone()).collect(),
            }
        });
        reading.statements.extend(statements);
    }
    account::held_against(reading, question)
}

/// The facts of a line.
fn serving<'r>(claim: &Claim, reading: &'r Reading, scenario: &Scenario) -> Vec<&'r Fact> {
    let parts: Vec<&str> = claim.fact.split('.').collect();
    let of = |fact: &&Fact| match (&parts[..], claim.of) {
        (["all"], _) => matches!(fact.kind, FactKind::Humans(_) | FactKind::Place(_)),
        (["group", ..], _) => matches!(fact.kind, FactKind::Group { .. }),
        (["order", number], _) => order(&fact.kind, number, scenario),
        ([_], Some(AgentId::Human(id))) => {
            matches!(fact.kind, FactKind::Relates { human, .. } if human == id)
        }
        ([_, rest @ ..], Some(AgentId::Human(id))) => of_human(&fact.kind, id, rest, scenario),
        ([_, "does", number], Some(AgentId::Robot)) => of_robot(&fact.kind, number, scenario),
        ([_, ..], Some(AgentId::Robot)) => {
            matches!(fact.kind, FactKind::RobotStart(_) | FactKind::RobotGoal(_) | FactKind::RobotAt { .. })
        }
        _ => false,
    };
    reading.facts.iter().filter(of).collect()
}

fn order(kind: &FactKind, number: &str, scenario: &Scenario) -> bool {
    let FactKind::Before { first, then, .. } = kind else { return false };
    let place = number.parse::<usize>().ok().and_then(|number| number.checked_sub(1));
    let stated = place.and_then(|place| scenario.form.orders.get(place));
    let names = |name: &str, agent: &AgentId| scenario.form.agents(name).contains(agent);
    stated.is_some_and(|stated| names(&stated.first, first) && names(&stated.then, then))
}

fn of_human(kind: &FactKind, id: HumanId, rest: &[&str], scenario: &Scenario) -> bool {
    let people = scenario.form.people();
    let own = people.iter().find(|person| person.id == id);
    // The rule of a step, or of a standing rule by its place.
    let rule = || match rest {
        ["does", number] => {
            let number = number.parse().ok();
            own?.rules.iter().find(|rule| rule.step.is_some() && rule.step == number)
        }
        ["reacts", number] => {
            let place = number.parse::<usize>().ok()?.checked_sub(1)?;
            own?.rules.iter().filter(|rule| rule.step.is_none()).nth(place)
        }
        _ => None,
    };
    match (kind, rest) {
        (FactKind::Side { human, .. }, ["side"])
        | (FactKind::Facing { human, .. }, ["facing"])
        | (FactKind::Pace { human, .. }, ["pace"])
        | (FactKind::Goal { human, .. }, ["goal"]) => *human == id,
        (FactKind::Group { members, .. }, ["group"]) => members.contains(&id),
        (FactKind::MeetsAt { human, .. }, ["place"]) => *human == id,
        (FactKind::Place(_), ["place"]) => own.is_some_and(|own| own.human.place == first_place(scenario)),
        (FactKind::Reacts { human, rule: made }, ["does" | "reacts", _]) => *human == id && rule() == Some(made),
        (
            FactKind::Gestures { human, gesture } | FactKind::GesturesTo { human, gesture, .. },
            ["does" | "reacts", _],
        ) => *human == id && rule().is_some_and(|rule| rule.gesture == Some(*gesture)),
        _ => false,
    }
}

/// The first place that is stated, which is that of all people without one.
fn first_place(scenario: &Scenario) -> Option<PlaceWord> {
    scenario.form.humans.iter().find_map(|human| human.place.clone())
}

fn of_robot(kind: &FactKind, number: &str, scenario: &Scenario) -> bool {
    let place = number.parse::<usize>().ok().and_then(|number| number.checked_sub(1));
    let rules = scenario.form.script(&scenario.robot.does);
    let Some(own) = place.and_then(|place| rules.get(place)) else { return false };
    if let FactKind::RobotDoes(rule) = kind {
        return own == rule;
    }
    matches!(kind, FactKind::RobotSays(gesture) if own.act == RobotDo::Say(*gesture))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Says;
    use crate::attempt::{Made, Written, attempt};
    use serde_json::{Value, json};
    use socrates_model::{Predicate, Request};

    fn question(more: &Value) -> Question {
        let location = socrates_maps::shipped::load("office").unwrap();
        let mut request = json!({"location": "office", "social_context": "An office.", "task": "Drive to the exit.",
            "rough_scenario": "A visitor comes towards the robot and waves. Then he turns back. A colleague stays at her desk."});
        request.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
        let request: Request = serde_json::from_value(request).unwrap();
        let reading = socrates_offline::stated(&request, &location);
        Question::first(request, reading, location, 5)
    }

    fn answer() -> Value {
        json!({
            "analysis": "", "title": "A wave", "description": "A visitor waves and turns back.", "expected_behavior": "Goes on.", "notes": [],
            "reading": {
                "s1": ["human_1: A visitor comes towards the robot", "human_1.does.1: waves"], "s2": ["human_1.does.2: he turns back"],
                "s3": ["cannot_be_played: nobody sits at a desk"], "s4": ["robot.goal: Drive to the exit"], "s5": ["setting"],
            },
            "scenario": {
                "robot": {"goal": "exit"},
                "human": [{"role": "visitor", "relation": "frontal", "place": "corridor", "does": [
                    {"when": [{"robot_visible": 6.0}], "say": "ACKNOWLEDGED"}, {"act": "turn_back"}]}],
            },
        })
    }

    async fn made(answer: &Value) -> Made {
        attempt(&Says(answer.to_string()), &question(&json!({})))
            .await
            .unwrap_or_else(|refused| panic!("{:?}", refused.faults))
    }

    async fn refused(answer: &Value, more: &Value) -> Vec<String> {
        let refused = attempt(&Says(answer.to_string()), &question(more)).await.unwrap_err();
        assert_eq!(refused.class, FailureClass::Semantic, "{:?}", refused.faults);
        refused.faults.iter().map(ToString::to_string).collect()
    }

    #[tokio::test]
    async fn the_clauses_follow_from_the_lines_and_the_account_tells_which_serve_a_sentence() {
        let made = made(&answer()).await;
        let Written::Proposal(proposal) = &made.written else { panic!() };
        assert_eq!((proposal.humans.len(), proposal.humans[0].steps(), proposal.title.as_str()), (1, 2, "A wave"));
        let has = |wanted: fn(&Predicate) -> bool| {
            proposal.expected_events.iter().any(|clause| clause.must && wanted(&clause.predicate))
        };
        assert!(
            has(|one| matches!(one, Predicate::HeadOn { .. })) && has(|one| matches!(one, Predicate::TurnsBack { .. }))
        );
        let reading = made.reading.unwrap();
        assert_eq!(reading.missing().len(), 1, "{:?}", reading.missing());
        let served = |at: usize| {
            let Became::Read { facts, lines } = &reading.statements[at].became else {
                panic!("{:?}", reading.statements)
            };
            (facts.len(), lines.len())
        };
        assert!(served(0).0 >= 2 && served(1).0 == 1 && served(0).1 >= 1, "{:?}", reading.statements);
        // The paths follow from the scenario as well.
        let ask = Question { stage: Stage::Paths, reading, proposal: Some(proposal.clone()), ..question(&json!({})) };
        let paths = crate::paths_by::answer(&ask, proposal);
        assert!(crate::attempt::read(&paths, &ask).is_ok(), "{paths}");
    }

    #[tokio::test]
    async fn how_a_robot_under_test_should_drive_is_expected_and_no_part_of_the_setup() {
        let mut answer = answer();
        answer["reading"]["s3"] = json!(["expected_behavior: keeps to the right"]);
        answer["expected_behavior"] = json!("Keeps to the right.");
        let rough = "A visitor comes towards the robot and waves. Then he turns back. The robot keeps to the right.";
        let question = question(&json!({"rough_scenario": rough}));
        let made = attempt(&Says(answer.to_string()), &question).await;
        let reading = made.unwrap_or_else(|refused| panic!("{:?}", refused.faults)).reading.unwrap();
        assert!(reading.missing().is_empty(), "{:?}", reading.statements);
        let Became::Read { lines, facts } = &reading.statements[2].became else { panic!("{:?}", reading.statements) };
        assert!(lines[0].ends_with("keeps to the right") && facts.is_empty(), "{lines:?}");
        // Asked again, the author sees what it said of each sentence.
        let again = account::again(&Question { reading, ..question }).unwrap().account.unwrap();
        assert_eq!(json!(again["s3"]), answer["reading"]["s3"]);
        assert_eq!(json!(again["s1"]), answer["reading"]["s1"]);
    }

    #[tokio::test]
    async fn what_the_scenario_cannot_be_goes_back_to_its_author_with_what_is_allowed() {
        let mut bad = answer();
        bad["reading"]["s2"] = json!(["human_1.does.3: he turns back"]);
        let said = refused(&bad, &json!({})).await;
        assert!(said[0].contains("`human_1.does.3`") && said[0].contains("human_1.does.2"), "{said:?}");
        let mut bad = answer();
        bad["scenario"]["human"][0]["place"] = json!("swimming pool");
        let said = refused(&bad, &json!({})).await;
        assert!(said[0].contains("P-PLACE") && said[0].contains("swimming pool"), "{said:?}");
        let mut bad = answer();
        bad["scenario"]["human"][0]["does"][1] = json!({"act": "fly"});
        assert!(refused(&bad, &json!({})).await[0].contains("turn_back"));
        let said = refused(&answer(), &json!({"expect": {"humans": 2}})).await;
        assert!(said[0].contains("P-ROUGH") && said[0].contains("expect.humans"), "{said:?}");
    }
}
