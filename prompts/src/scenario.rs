//! The scenario of an answer: what an author that reads the request itself states.
//!
//! ```text
//! {"reading": account, "title", "description",
//!  "scenario": {"robot", "human", "group", "order"},     as the form of a request has them (docs/form.md)
//!  "expected_behavior", "notes"}
//! ```

use serde::Deserialize;
use serde_json::{Map, Value, json};
use socrates_model::form::Form;
use socrates_model::scenario::RobotPart;
use socrates_model::{BadRequest, Fault, FaultCode, Scenario, Where};

use crate::account;
use crate::schema::{THINKING, derived};

/// Member of an answer that holds the scenario.
pub(crate) const MEMBER: &str = "scenario";
/// Most faults that are named at once.
const MOST: usize = 8;
/// Keys of a human that an answer does not have: it lists everybody, so that people are `human_1`, `human_2`, … in its order.
const NOT_ASKED: [&str; 2] = ["id", "count"];

/// An answer with a scenario.
#[derive(Debug, Clone, PartialEq)]
pub struct ScenarioAnswer {
    /// The scenario.
    pub scenario: Scenario,
    /// Sentences for people.
    pub beside: Captions,
}

/// Sentences for people beside a scenario.
#[derive(Debug, Clone, PartialEq, Eq, Default, Deserialize)]
#[serde(default)]
pub struct Captions {
    /// A few words.
    pub title: String,
    /// The scene in a few sentences: events, places, positions.
    pub description: String,
    /// Behavior of a good robot.
    pub expected_behavior: String,
    /// Assumptions.
    pub notes: Vec<String>,
}

/// Whether an answer states a scenario.
#[must_use]
pub fn is_stated(answer: &Value) -> bool {
    answer.get(MEMBER).is_some()
}

/// Reads the scenario of an answer.
///
/// # Errors
/// E-SCHEMA for each part that has not the asked form, with its key, the value and what is allowed.
pub fn parse_scenario(text: &str) -> Result<ScenarioAnswer, Vec<Fault>> {
    let mut answer = crate::json::object(text)?;
    let Some(members) = answer.as_object_mut() else { return Err(Vec::new()) };
    let stated = members.remove(MEMBER).unwrap_or_default();
    members.retain(|name, value| !value.is_null() && ![THINKING, account::MEMBER].contains(&name.as_str()));
    let beside = serde_json::from_value(answer)
        .map_err(|error| vec![Fault::new(FaultCode::ESchema, "answer", error.to_string())]);
    let scenario = Scenario::of_json(&stated).map_err(|all| all.iter().take(MOST).map(fault).collect::<Vec<_>>());
    let empty = || vec![Fault::new(FaultCode::ESchema, Where::key("$.scenario.human"), "is empty; list every person")];
    let scenario = scenario.and_then(|stated| if stated.form.humans.is_empty() { Err(empty()) } else { Ok(stated) });
    match (scenario, beside) {
        (Ok(scenario), Ok(beside)) => Ok(ScenarioAnswer { scenario, beside }),
        (Err(faults), Ok(_)) | (Ok(_), Err(faults)) => Err(faults),
        (Err(mut faults), Err(others)) => {
            faults.extend(others);
            Err(faults)
        }
    }
}

fn fault(bad: &BadRequest) -> Fault {
    let at = if bad.key.is_empty() { format!("$.{MEMBER}") } else { format!("$.{MEMBER}.{}", bad.key) };
    Fault::new(FaultCode::ESchema, Where::key(at), format!("{}; allowed: {}", bad.found, bad.hint))
}

/// The schema of a scenario, and the definitions that it names.
pub(crate) fn schema() -> (Value, Map<String, Value>) {
    let mut definitions = Map::new();
    let mut take = |mut schema: Value| {
        let own = schema.as_object_mut().and_then(|members| members.remove("$defs"));
        definitions.extend(own.and_then(|own| own.as_object().cloned()).unwrap_or_default());
        schema
    };
    let (form, robot) = (take(derived::<Form>()), take(derived::<RobotPart>()));
    let mut members = form.get("properties").and_then(Value::as_object).cloned().unwrap_or_default();
    members.insert("robot".to_owned(), robot);
    if let Some(human) = definitions.get_mut("FormHuman").and_then(|human| human.get_mut("properties")) {
        human.as_object_mut().into_iter().for_each(|human| human.retain(|key, _| !NOT_ASKED.contains(&key.as_str())));
    }
    for definition in definitions.values_mut() {
        merged(definition);
    }
    (json!({"type": "object", "properties": members, "required": ["human"]}), definitions)
}

/// Makes of members beside alternatives, of which one is there, members that may be null: what servers enforce has no alternatives of parts
/// of an object. The reader refuses two of them at once.
fn merged(schema: &mut Value) {
    let Some(object) = schema.as_object_mut().filter(|object| object.contains_key("properties")) else { return };
    let choices = object.remove("oneOf").or_else(|| object.remove("anyOf")).unwrap_or_default();
    let more = choices.as_array().into_iter().flatten().filter_map(|one| one.get("properties")?.as_object());
    let more: Vec<(String, Value)> = more.flat_map(|one| one.clone()).collect();
    if let Some(members) = object.get_mut("properties").and_then(Value::as_object_mut) {
        members.extend(more);
    }
    object.remove("unevaluatedProperties");
    object.insert("required".to_owned(), object.get("required").cloned().unwrap_or_else(|| json!([])));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn answer() -> Value {
        json!({
            "analysis": "two people", "reading": {"s1": ["human_1: a nurse"]}, "title": "A nurse", "description": "A nurse comes.",
            "scenario": {
                "robot": {"goal": "exit", "start": null, "does": []},
                "human": [{"role": "nurse", "relation": "frontal", "does": [
                    {"when": [{"robot_near": 3.0}], "act": "stand_still", "for_s": 4.0, "until": [], "say": null}]}],
                "group": [], "order": [],
            },
            "expected_behavior": "Waits.", "notes": [],
        })
    }

    #[test]
    fn a_scenario_is_read_with_what_stands_beside_it() {
        let read = parse_scenario(&answer().to_string()).unwrap();
        assert_eq!((read.beside.title.as_str(), read.scenario.form.headcount()), ("A nurse", 1));
        assert_eq!(read.scenario.form.humans[0].does[0].for_s, Some(4.0));
        assert!(is_stated(&answer()) && !is_stated(&json!({"humans": []})));
    }

    #[test]
    fn every_wrong_part_is_named_with_what_is_allowed() {
        let mut bad = answer();
        bad["scenario"]["human"][0]["relation"] = json!("sideways");
        bad["scenario"]["human"][0]["does"][0]["act"] = json!("fly");
        bad["notes"] = json!(7);
        let said: Vec<String> = parse_scenario(&bad.to_string()).unwrap_err().iter().map(ToString::to_string).collect();
        assert!(
            said.iter().any(|one| one.contains("$.scenario.human.relation") && one.contains("frontal")),
            "{said:?}"
        );
        assert!(said.iter().any(|one| one.contains("fly") && one.contains("give_way")), "{said:?}");
        assert_eq!(said.len(), 3, "{said:?}");
        bad["scenario"] = json!({"human": []});
        assert!(parse_scenario(&bad.to_string()).is_err());
    }
}
