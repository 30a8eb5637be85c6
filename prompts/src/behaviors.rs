//! From text to behaviors: rules are lowered to trees, trees are taken as they are.

use std::collections::BTreeMap;

use serde_json::Value;
use socrates_model::{Behaviors, FORMAT, Fault, FaultCode, HumanBehavior, HumanId, Rule, Where};

use crate::answer::{prepared, schema_faults_at};
use crate::question::Question;
use crate::schema::derived;
use crate::trees;

/// Longest behavior answer of one human that is read, rules.
const MOST_RULES: usize = 12;

/// Reads `{"humans": {"human_1": {"description": "…", "rules": […]}}}`; `tree`, as XML or as objects, may stand in place of
/// `rules`.
///
/// # Errors
/// Syntax faults with their position, E-SCHEMA faults with JSON path, expected and found, or the faults of lowering the rules;
/// those of all humans at once.
pub fn parse_behaviors(text: &str, question: &Question) -> Result<Behaviors, Vec<Fault>> {
    let value = prepared(crate::json::object(text)?);
    let author = value.get("author").and_then(Value::as_str).unwrap_or_default().into();
    let Some(members) = value.get("humans").and_then(Value::as_object) else {
        return Err(vec![Fault::new(
            FaultCode::ESchema,
            "$.humans",
            "expected an object with one member per human, found nothing",
        )]);
    };
    let mut faults = Vec::new();
    for name in value.as_object().into_iter().flatten().map(|(name, _)| name) {
        if !matches!(name.as_str(), "humans" | "format" | "author") {
            let message = format!("expected no such member; allowed: analysis, humans, found `{name}`");
            faults.push(Fault::new(FaultCode::ESchema, Where::key(format_args!("$.{name}")), message));
        }
    }
    let mut humans = BTreeMap::new();
    for (name, member) in members {
        let read = name
            .parse::<HumanId>()
            .map_err(|bad| {
                vec![Fault::new(FaultCode::ESchema, Where::key(format_args!("$.humans.{name}")), bad.to_string())]
            })
            .and_then(|id| Ok((id, behavior(id, member, question)?)));
        match read {
            Ok((id, behavior)) => {
                humans.insert(id, behavior);
            }
            Err(wrong) => faults.extend(wrong),
        }
    }
    if faults.is_empty() { Ok(Behaviors { format: FORMAT, humans, author }) } else { Err(faults) }
}

fn behavior(id: HumanId, value: &Value, question: &Question) -> Result<HumanBehavior, Vec<Fault>> {
    let path = format!("$.humans.{id}");
    let fault = |at: String, message: &str| vec![Fault::new(FaultCode::ESchema, Where::key(at), message)];
    let Some(members) = value.as_object() else {
        return Err(fault(path, "expected an object with `description` and `rules`"));
    };
    if let Some(name) = members.keys().find(|name| !matches!(name.as_str(), "description" | "rules" | "tree")) {
        return Err(fault(format!("{path}.{name}"), "expected no such member; allowed: description, rules, tree"));
    }
    let description = members.get("description").and_then(Value::as_str).unwrap_or_default();
    match (members.get("rules"), members.get("tree")) {
        (Some(rules), None) => {
            let rules = rules_of(rules, &path)?;
            let tree = socrates_bt::compile(id, &rules)
                .map_err(|faults| faults.into_iter().map(|fault| fault.of(id)).collect::<Vec<_>>())?;
            Ok(HumanBehavior { tree, description: told(description, &rules, id, question) })
        }
        (None, Some(Value::String(tree))) => {
            if let Some(foreign) = foreign(tree) {
                let message = format!("holds {foreign}; write elements and attributes alone");
                return Err(vec![Fault::new(FaultCode::BXml, Where::agent(id).at_key("tree"), message)]);
            }
            Ok(HumanBehavior { tree: tree.clone(), description: told(description, &[], id, question) })
        }
        (None, Some(tree @ Value::Object(_))) => {
            let tree = trees::read(tree, &format!("{path}.tree"))?.xml(id);
            Ok(HumanBehavior { tree, description: told(description, &[], id, question) })
        }
        (None, Some(_)) => Err(fault(format!("{path}.tree"), "expected a text with the XML of the tree")),
        (Some(_), Some(_)) => Err(fault(path, "expected either `rules` or `tree`, found both")),
        (None, None) => Err(fault(path, "expected `rules` (or `tree`), found neither")),
    }
}

/// What an author has no reason to put into a tree: orders to a program that reads it, and text that is read by nobody.
fn foreign(tree: &str) -> Option<&'static str> {
    let orders = tree.match_indices("<?").any(|(at, _)| !tree.get(at..).is_some_and(|rest| rest.starts_with("<?xml ")));
    if orders { Some("a processing instruction") } else { tree.contains("<![CDATA[").then_some("a CDATA section") }
}

fn rules_of(value: &Value, path: &str) -> Result<Vec<Rule>, Vec<Fault>> {
    let Some(items) = value.as_array() else {
        return Err(vec![Fault::new(
            FaultCode::ESchema,
            Where::key(format_args!("{path}.rules")),
            "expected a list of rules",
        )]);
    };
    if items.len() > MOST_RULES {
        let message = format!("expected at most {MOST_RULES} rules, found {}", items.len());
        return Err(vec![Fault::new(FaultCode::ESchema, Where::key(format_args!("{path}.rules")), message)]);
    }
    let schema = derived::<Rule>();
    let mut rules = Vec::new();
    let mut faults = Vec::new();
    for (index, item) in items.iter().enumerate() {
        let at = format!("{path}.rules[{index}]");
        match schema_faults_at(&at, &schema, item) {
            Err(wrong) => faults.extend(wrong),
            Ok(()) => match serde_json::from_value(item.clone()) {
                Ok(rule) => rules.push(rule),
                Err(error) => faults.push(Fault::new(FaultCode::ESchema, Where::key(&at), error.to_string())),
            },
        }
    }
    if faults.is_empty() { Ok(rules) } else { Err(faults) }
}

fn told(description: &str, rules: &[Rule], id: HumanId, question: &Question) -> String {
    if description.is_empty() { in_words(rules, id, question) } else { description.to_owned() }
}

/// The rules in a sentence, where the author gave none; the proposal's own words come first.
fn in_words(rules: &[Rule], id: HumanId, question: &Question) -> String {
    let told = question.proposal.as_ref().and_then(|proposal| proposal.human(id)).map(|human| human.behavior.clone());
    told.unwrap_or_else(|| {
        let parts: Vec<String> = rules
            .iter()
            .map(|rule| format!("{} they {}", socrates_model::Trigger::phrases(&rule.when), rule.act.they()))
            .collect();
        if parts.is_empty() {
            "walks their path".to_owned()
        } else {
            format!("{}; otherwise they walk their path", parts.join("; "))
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::question;
    use serde_json::json;
    use socrates_model::job::Stage;

    fn parse(value: &Value) -> Result<Behaviors, Vec<Fault>> {
        parse_behaviors(&value.to_string(), &question(Stage::Behaviors))
    }

    #[test]
    fn rules_become_trees_and_trees_stay() {
        let tree = "<root main_tree_to_execute=\"M\"/>";
        let read = parse(&json!({"analysis": "…", "humans": {
            "human_1": {"description": "", "rules": [{"when": [{"robot_near": 3.0}], "act": "run_away"}]},
            "human_2": {"description": "walks", "tree": tree},
        }}))
        .unwrap();
        assert!(read.humans[&HumanId::new(1)].tree.contains("RunAwayFromRobot"));
        assert!(!read.humans[&HumanId::new(1)].description.is_empty());
        assert_eq!(read.humans[&HumanId::new(2)].tree, tree);
    }

    #[test]
    fn faults_of_all_humans_are_named_with_their_paths() {
        let faults = parse(&json!({"humans": {
            "human_1": {"rules": [{"when": ["always"], "act": "dance"}]},
            "human_2": {"rules": [], "tree": ""},
            "robot": {},
        }}))
        .unwrap_err();
        let places: Vec<String> = faults.iter().map(|fault| fault.at.to_string()).collect();
        assert_eq!(places, ["$.humans.human_1.rules[0].act", "$.humans.human_2", "$.humans.robot"]);
    }

    #[test]
    fn behaviors_as_they_are_stored_are_read_too() {
        let stored =
            json!({"format": 1, "author": "x", "humans": {"human_1": {"tree": "<root/>", "description": "d"}}});
        assert_eq!(parse(&stored).unwrap().author, "x".into());
    }
}
