//! A schema in the subset that a vendor takes.
//!
//! Schemas come in the strictest common form: closed objects, every member required, local references. What a vendor
//! refuses beyond that is taken out here, and bounds are kept as words in the description.

use serde_json::{Map, Value, json};

use crate::dialect::Dialect;

/// Bounds that not everybody takes.
const BOUNDS: [&str; 10] = [
    "minimum",
    "maximum",
    "exclusiveMinimum",
    "exclusiveMaximum",
    "multipleOf",
    "minItems",
    "maxItems",
    "pattern",
    "minLength",
    "maxLength",
];

/// The schema as this kind of server takes it.
#[must_use]
pub fn for_dialect(schema: &Value, dialect: Dialect) -> Value {
    let mut schema = schema.clone();
    match dialect {
        // Lengths of texts are the one bound that strict mode is known to refuse.
        Dialect::OpenAi | Dialect::Responses => move_bounds(&mut schema, &["minLength", "maxLength"]),
        Dialect::Anthropic => move_bounds(&mut schema, &BOUNDS),
        Dialect::Gemini => order(&mut schema),
        // Grammar compilers take bounds, but not all of them patterns.
        Dialect::Vllm | Dialect::Ollama | Dialect::LlamaCpp | Dialect::LmStudio => {
            move_bounds(&mut schema, &["pattern", "multipleOf"]);
        }
        // Its page holds an answer against every bound.
        Dialect::Console => {}
    }
    schema
}

/// Takes bounds out of every schema in it and writes them into its description.
fn move_bounds(schema: &mut Value, bounds: &[&str]) {
    each(schema, &mut |object| {
        let mut told: Vec<String> = Vec::new();
        for key in bounds {
            // Lists of at least one item are taken everywhere.
            let common = *key == "minItems" && object.get(*key).and_then(Value::as_u64).is_some_and(|least| least <= 1);
            if !common && let Some(value) = object.remove(*key) {
                told.push(format!("{key} {value}"));
            }
        }
        if !told.is_empty() {
            let before = object.get("description").and_then(Value::as_str).map(|text| format!("{text}; "));
            let text = format!("{}{}", before.unwrap_or_default(), told.join(", "));
            object.insert("description".to_owned(), json!(text));
        }
    });
}

/// Says in which order members come, that in which they are required, for servers that sort them otherwise.
fn order(schema: &mut Value) {
    each(schema, &mut |object| {
        let Some(members) = object.get("properties").and_then(Value::as_object) else { return };
        let required = object.get("required").and_then(Value::as_array).cloned().unwrap_or_default();
        let more = members.keys().map(|name| json!(name)).filter(|name| !required.contains(name));
        let names: Vec<Value> = required.iter().cloned().chain(more).collect();
        object.insert("propertyOrdering".to_owned(), Value::Array(names));
    });
}

/// Every schema in a schema; names of members are no schemas.
fn each(schema: &mut Value, change: &mut dyn FnMut(&mut Map<String, Value>)) {
    let Some(object) = schema.as_object_mut() else { return };
    for key in ["properties", "$defs"] {
        if let Some(members) = object.get_mut(key).and_then(Value::as_object_mut) {
            members.values_mut().for_each(|member| each(member, change));
        }
    }
    for key in ["items", "additionalProperties"] {
        if let Some(inner) = object.get_mut(key) {
            each(inner, change);
        }
    }
    for key in ["anyOf", "allOf", "oneOf"] {
        if let Some(choices) = object.get_mut(key).and_then(Value::as_array_mut) {
            choices.iter_mut().for_each(|choice| each(choice, change));
        }
    }
    change(object);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn schema() -> Value {
        json!({"type": "object", "properties": {
            "minimum": {"type": "number", "minimum": 0.3, "maximum": 15},
            "list": {"type": "array", "items": {"$ref": "#/$defs/a"}, "minItems": 1, "maxItems": 3, "description": "some"},
        }, "$defs": {"a": {"type": "string", "pattern": "^a", "maxLength": 9}}})
    }

    #[test]
    fn bounds_become_words_where_they_are_refused() {
        let form = for_dialect(&schema(), Dialect::Anthropic);
        let number = &form["properties"]["minimum"];
        assert_eq!(*number, json!({"type": "number", "description": "minimum 0.3, maximum 15"}));
        assert_eq!(form["properties"]["list"]["minItems"], 1);
        assert_eq!(form["properties"]["list"]["description"], "some; maxItems 3");
        assert_eq!(form["$defs"]["a"], json!({"type": "string", "description": "pattern \"^a\", maxLength 9"}));
    }

    #[test]
    fn bounds_stay_where_they_are_taken() {
        let form = for_dialect(&schema(), Dialect::OpenAi);
        assert_eq!(form["properties"]["minimum"]["maximum"], 15);
        assert_eq!(form["$defs"]["a"], json!({"type": "string", "pattern": "^a", "description": "maxLength 9"}));
    }

    #[test]
    fn one_server_is_told_the_order() {
        let form = for_dialect(&schema(), Dialect::Gemini);
        assert_eq!(form["propertyOrdering"], json!(["list", "minimum"]));
    }
}
