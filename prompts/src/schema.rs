//! JSON schemas of the answers, in the strict subset that servers enforce.

use serde_json::{Map, Value, json};
use socrates_model::job::Stage;
use socrates_model::{Proposal, Rule};

use crate::question::Question;

/// With more nodes than this, ids are checked after the answer instead of by the server.
const MOST_IDS: usize = 250;
/// Room to think before the answer proper; its name sorts first in every schema. Not read.
pub(crate) const THINKING: &str = "analysis";

/// The schema that the answer to this question has to keep. Closed objects, every member required, `null` for nothing.
#[must_use]
pub fn answer_schema(question: &Question) -> Value {
    match question.stage {
        Stage::Proposal | Stage::Review | Stage::Simulation | Stage::Scoring => proposal(),
        Stage::Paths => paths(question),
        Stage::Behaviors => behaviors(question),
    }
}

/// The schema of a model type as it is derived, for the reader.
pub(crate) fn derived<T: schemars::JsonSchema>() -> Value {
    schemars::schema_for!(T).to_value()
}

fn proposal() -> Value {
    let mut schema = derived::<Proposal>();
    if let Some(members) = schema.get_mut("properties").and_then(Value::as_object_mut) {
        members.remove("format");
        members.remove("author");
        members.insert(THINKING.to_owned(), thinking());
    }
    if let Some(required) = schema.get_mut("required").and_then(Value::as_array_mut) {
        required.push(json!(THINKING));
    }
    strict(&mut schema);
    schema
}

fn paths(question: &Question) -> Value {
    let graph = &question.location.graph;
    let node = if graph.nodes.len() <= MOST_IDS {
        let mut ids: Vec<&str> = graph.nodes.iter().map(|node| node.id.as_str()).collect();
        ids.sort_unstable();
        json!({"type": "string", "enum": ids})
    } else {
        json!({"type": "string"})
    };
    let names = human_names(question);
    let walk = json!({"type": "array", "items": {"$ref": "#/$defs/node"}});
    let each: Map<String, Value> = names.iter().map(|name| (name.clone(), walk.clone())).collect();
    let mut schema = json!({
        "type": "object",
        "properties": {
            THINKING: thinking(),
            "encounters": {"type": "array", "items": {"type": "object", "properties": {
                "human": {"type": "string", "enum": names},
                "node": {"$ref": "#/$defs/node"},
            }}},
            "humans": {"type": "object", "properties": each},
            "reasoning": {"type": "string"},
            "robot": walk,
        },
        "$defs": {"node": node},
    });
    strict(&mut schema);
    schema
}

fn behaviors(question: &Question) -> Value {
    let mut rule = derived::<Rule>();
    let mut defs = rule.as_object_mut().and_then(|rule| rule.remove("$defs")).unwrap_or_else(|| json!({}));
    if let Some(defs) = defs.as_object_mut() {
        defs.insert("Rule".to_owned(), rule);
    }
    let behavior = json!({"type": "object", "properties": {
        "description": {"type": "string"},
        "rules": {"type": "array", "items": {"$ref": "#/$defs/Rule"}},
    }, "required": ["description", "rules"]});
    let each: Map<String, Value> = human_names(question).into_iter().map(|name| (name, behavior.clone())).collect();
    let mut schema = json!({
        "type": "object",
        "properties": {THINKING: thinking(), "humans": {"type": "object", "properties": each}},
        "$defs": defs,
    });
    strict(&mut schema);
    schema
}

fn thinking() -> Value {
    json!({"type": "string", "description": "your plan in at most 400 characters; it is not read"})
}

fn human_names(question: &Question) -> Vec<String> {
    question
        .proposal
        .as_ref()
        .map_or_else(Vec::new, |proposal| question.humans(proposal).iter().map(|human| human.id.to_string()).collect())
}

/// Brings a schema into the strict subset: closed objects, all members required (optional ones may be null),
/// `anyOf` for `oneOf`, lists of one item form, no titles, formats and defaults.
fn strict(schema: &mut Value) {
    match schema {
        Value::Array(items) => items.iter_mut().for_each(strict),
        Value::Object(object) => {
            for key in ["$schema", "title", "format", "default"] {
                // A member may be called `title`; only the keyword itself is a text.
                if object.get(key).is_some_and(|value| !value.is_object()) {
                    object.remove(key);
                }
            }
            if let Some(choices) = object.remove("oneOf") {
                object.insert("anyOf".to_owned(), choices);
            }
            if let Some(items) = object.remove("prefixItems") {
                object.insert("items".to_owned(), json!({"anyOf": items}));
            }
            close(object);
            for value in object.values_mut() {
                strict(value);
            }
        }
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => {}
    }
}

fn close(object: &mut Map<String, Value>) {
    if object.get("type") != Some(&json!("object")) {
        return;
    }
    let given = object.get("required").and_then(Value::as_array).cloned();
    let Some(members) = object.get_mut("properties").and_then(Value::as_object_mut) else { return };
    let names: Vec<Value> = members.keys().map(|name| json!(name)).collect();
    if let Some(given) = given {
        for (name, member) in members.iter_mut().filter(|(name, _)| !given.contains(&json!(name))) {
            if !allows_null(member) {
                let inner = std::mem::take(member);
                *member =
                    json!({"anyOf": [inner, {"type": "null"}], "description": format!("{name}, or null for none")});
            }
        }
    }
    object.insert("required".to_owned(), Value::Array(names));
    object.insert("additionalProperties".to_owned(), json!(false));
}

fn allows_null(schema: &Value) -> bool {
    let kind = schema.get("type");
    kind == Some(&json!("null"))
        || kind.and_then(Value::as_array).is_some_and(|kinds| kinds.contains(&json!("null")))
        || schema.get("anyOf").and_then(Value::as_array).is_some_and(|choices| choices.iter().any(allows_null))
}

/// Names of the alternatives of an enum's schema.
pub(crate) fn alternatives(schema: &Value) -> Vec<String> {
    let choices = schema.get("oneOf").or_else(|| schema.get("anyOf")).and_then(Value::as_array).cloned();
    let mut names = Vec::new();
    for choice in choices.unwrap_or_else(|| vec![schema.clone()]) {
        let words = choice.get("enum").and_then(Value::as_array).into_iter().flatten().chain(choice.get("const"));
        names.extend(words.filter_map(Value::as_str).map(str::to_owned));
        let members = choice.get("properties").and_then(Value::as_object);
        names.extend(members.into_iter().flat_map(Map::keys).cloned());
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::question;

    fn walk(schema: &Value, look: &mut impl FnMut(&Map<String, Value>)) {
        match schema {
            Value::Object(object) => {
                look(object);
                object.values().for_each(|value| walk(value, look));
            }
            Value::Array(items) => items.iter().for_each(|value| walk(value, look)),
            Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => {}
        }
    }

    #[test]
    fn every_object_is_closed_and_requires_all_its_members() {
        for stage in [Stage::Proposal, Stage::Paths, Stage::Behaviors] {
            let schema = answer_schema(&question(stage));
            let mut objects = 0;
            walk(&schema, &mut |object| {
                assert!(!object.contains_key("oneOf") && !object.contains_key("prefixItems"), "{object:?}");
                if object.get("type") == Some(&json!("object")) && object.contains_key("properties") {
                    objects += 1;
                    assert_eq!(object["additionalProperties"], json!(false));
                    let names: Vec<&String> = object["properties"].as_object().unwrap().keys().collect();
                    assert_eq!(object["required"], json!(names));
                }
            });
            assert!(objects > 1, "{stage}");
        }
    }

    #[test]
    fn thinking_comes_before_the_answer() {
        for stage in [Stage::Proposal, Stage::Paths, Stage::Behaviors] {
            let schema = answer_schema(&question(stage));
            assert_eq!(schema["properties"].as_object().unwrap().keys().next().unwrap(), THINKING);
        }
    }

    #[test]
    fn node_ids_and_humans_are_those_of_the_question() {
        let schema = answer_schema(&question(Stage::Paths));
        assert_eq!(schema["$defs"]["node"]["enum"], json!(["c", "e", "n", "w"]));
        assert_eq!(schema["properties"]["humans"]["required"], json!(["human_1", "human_2"]));
    }
}
