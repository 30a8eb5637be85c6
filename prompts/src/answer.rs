//! From text to a proposal or to paths.

use serde::de::DeserializeOwned;
use serde_json::{Value, json};
use socrates_model::scenario::without_nulls;
use socrates_model::{FORMAT, Fault, FaultCode, Paths, Proposal, Where};

use crate::conforms::{Misfit, differences};
use crate::question::Question;
use crate::schema::{THINKING, derived};
use crate::ways;

/// Most differences named at once.
const MOST: usize = 5;

/// Reads a proposal without its account; see [`crate::parse_account`]. `format` and `author` may be left out.
///
/// # Errors
/// Syntax faults with their position, or up to five E-SCHEMA faults with JSON path, expected and found.
pub fn parse_proposal(text: &str) -> Result<Proposal, Vec<Fault>> {
    let mut value = crate::json::object(text)?;
    // The account is read apart.
    if let Some(members) = value.as_object_mut() {
        members.remove(crate::account::MEMBER);
    }
    typed(prepared(value))
}

/// Reads paths in any of the forms; see [`crate::style::PathsForm`]. `format` and `author` may be left out.
///
/// # Errors
/// As [`parse_proposal`].
pub fn parse_paths(text: &str, question: &Question) -> Result<Paths, Vec<Fault>> {
    let mut value = crate::json::object(text)?;
    ways::expand(&mut value, &question.location.graph);
    // What was thought is the reason, where none is given apart.
    let thought = value.get(THINKING).and_then(Value::as_str).map(str::to_owned);
    let mut value = prepared(value);
    if let Some((members, thought)) = value.as_object_mut().zip(thought) {
        members.entry("reasoning").or_insert_with(|| json!(thought));
    }
    typed(value)
}

/// The answer without its thinking, without nulls, with the members that we know better than the author.
pub(crate) fn prepared(mut value: Value) -> Value {
    without_nulls(&mut value);
    if let Some(members) = value.as_object_mut() {
        members.remove(THINKING);
        members.entry("format").or_insert_with(|| json!(FORMAT));
        members.entry("author").or_insert_with(|| json!(""));
    }
    value
}

/// The typed value, or every difference from its schema.
pub(crate) fn typed<T: DeserializeOwned + schemars::JsonSchema>(value: Value) -> Result<T, Vec<Fault>> {
    schema_faults_at("$", &derived::<T>(), &value)?;
    serde_json::from_value(value).map_err(|error| vec![Fault::new(FaultCode::ESchema, "answer", error.to_string())])
}

/// E-SCHEMA for every difference, at most five, of a value that stands at this path of the answer.
pub(crate) fn schema_faults_at(path: &str, schema: &Value, value: &Value) -> Result<(), Vec<Fault>> {
    let found = differences(path, schema, value);
    if found.is_empty() {
        return Ok(());
    }
    let fault = |misfit: Misfit| Fault::new(FaultCode::ESchema, Where::key(misfit.at), misfit.message);
    Err(found.into_iter().take(MOST).map(fault).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{proposal, question};
    use socrates_model::Signature;
    use socrates_model::job::Stage;

    #[test]
    fn what_is_written_is_read_back() {
        let text = serde_json::to_string(&proposal()).unwrap();
        assert_eq!(parse_proposal(&text).unwrap(), proposal());
    }

    #[test]
    fn an_answer_in_the_strict_form_is_read() {
        let mut value = serde_json::to_value(proposal()).unwrap();
        let members = value.as_object_mut().unwrap();
        members.remove("format");
        members.remove("author");
        members.insert("analysis".into(), json!("two people, one corner"));
        members["humans"][0]["group"] = Value::Null;
        members["expected_events"][0]["source"] = Value::Null;
        let read = parse_proposal(&value.to_string()).unwrap();
        assert_eq!((read.format, read.author), (FORMAT, Signature::default()));
    }

    #[test]
    fn every_wrong_member_is_named_at_once() {
        let mut value = serde_json::to_value(proposal()).unwrap();
        value["place"] = json!("moon");
        value["humans"][1]["relation"] = json!("sideways");
        value["robot"]["color"] = json!("red");
        let faults = parse_proposal(&value.to_string()).unwrap_err();
        let places: Vec<String> = faults.iter().map(|fault| fault.at.to_string()).collect();
        assert_eq!(places, ["$.humans[1].relation", "$.place", "$.robot.color"]);
        assert!(
            faults[1].message.to_string().contains("\"intersection\"")
                && faults[1].message.to_string().contains("found `\"moon\"`")
        );
    }

    #[test]
    fn a_node_id_that_cannot_be_one_is_refused_with_what_is_allowed() {
        let text = json!({"robot": ["a b"], "humans": {"human_1": ["c"]}, "encounters": []}).to_string();
        let faults = parse_paths(&text, &question(Stage::Paths)).unwrap_err();
        assert_eq!(faults[0].code, FaultCode::ESchema);
        assert!(faults[0].message.to_string().contains("without blanks"), "{}", faults[0].message);
    }
}
