//! JSON for a server: members of a schema in the order in which the schema requires them. Servers that enforce a schema have a model write
//! them in this order, so that it matters what stands first.

use serde_json::{Map, Value};

/// The value as JSON; members of `properties` stand in the order of `required` beside them, all others by their names.
#[must_use]
pub fn text(value: &Value) -> String {
    match value {
        Value::Object(members) => {
            let required = members.get("required").and_then(Value::as_array);
            let each = members.iter().map(|(name, value)| {
                let inner = match (name.as_str(), value, required) {
                    ("properties", Value::Object(properties), Some(required)) => sorted(properties, required),
                    _ => text(value),
                };
                format!("{}:{inner}", Value::from(name.as_str()))
            });
            format!("{{{}}}", each.collect::<Vec<_>>().join(","))
        }
        Value::Array(items) => format!("[{}]", items.iter().map(text).collect::<Vec<_>>().join(",")),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => value.to_string(),
    }
}

fn sorted(properties: &Map<String, Value>, required: &[Value]) -> String {
    let mut names: Vec<&String> = properties.keys().collect();
    // Stable: members that are not required stay behind, by their names.
    names.sort_by_key(|name| required.iter().position(|known| known == name.as_str()).unwrap_or(required.len()));
    let each = names.into_iter().filter_map(|name| Some((name, properties.get(name)?)));
    let each = each.map(|(name, value)| format!("{}:{}", Value::from(name.as_str()), text(value)));
    format!("{{{}}}", each.collect::<Vec<_>>().join(","))
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn members_stand_as_they_are_required_and_nothing_else_is_changed() {
        let inner =
            json!({"type": "object", "properties": {"act": {}, "when": {}, "more": {}}, "required": ["when", "act"]});
        let body = json!({"model": "m", "schema": {"properties": {"b": inner, "a": {"type": "string"}}, "required": ["b", "a"]}});
        let written = text(&body);
        assert!(written.contains(r#""properties":{"b":{"properties":{"when":{},"act":{},"more":{}}"#), "{written}");
        assert!(written.find(r#""a":{"type""#) > written.find(r#""b":{"#), "{written}");
        assert_eq!(serde_json::from_str::<Value>(&written).unwrap(), body);
        // A member that is called `properties`, and one without a list of what is required.
        let odd = json!({"properties": {"z": 1, "properties": {"y": "\"", "x": null}}, "list": [1.5, "é\n"]});
        assert_eq!(text(&odd), odd.to_string());
    }
}
