//! Holds a JSON value against a derived schema and says everything that is wrong, with paths.

use serde_json::{Map, Value};

/// One difference between value and schema.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Difference {
    /// JSON path, `$` for the whole.
    pub path: String,
    /// What the schema wants.
    pub expected: String,
    /// What is there.
    pub found: String,
}

/// Longest piece of a value that is shown.
const SHOWN: usize = 60;

/// Every difference, in document order.
#[cfg(test)]
pub(crate) fn differences(schema: &Value, value: &Value) -> Vec<Difference> {
    differences_at("$", schema, value)
}

/// Every difference, in document order, of a value that stands at a path.
pub(crate) fn differences_at(path: &str, schema: &Value, value: &Value) -> Vec<Difference> {
    let mut found = Vec::new();
    Reader { root: schema }.hold(schema, value, path, &mut found);
    found
}

struct Reader<'a> {
    root: &'a Value,
}

impl<'a> Reader<'a> {
    fn hold(&self, schema: &'a Value, value: &Value, path: &str, out: &mut Vec<Difference>) {
        let Some(rules) = schema.as_object() else { return };
        if let Some(target) = self.target(rules) {
            self.hold(target, value, path, out);
        }
        for key in ["oneOf", "anyOf"] {
            if let Some(choices) = rules.get(key).and_then(Value::as_array) {
                self.choose(choices, value, path, out);
            }
        }
        if let Some(words) = rules.get("enum").and_then(Value::as_array)
            && !words.contains(value)
        {
            out.push(difference(path, &format!("one of {}", joined(words)), value));
        }
        if let Some(word) = rules.get("const").filter(|word| *word != value) {
            out.push(difference(path, &word.to_string(), value));
        }
        if let Some(kind) = rules.get("type").filter(|kind| !is_kind(kind, value)) {
            out.push(difference(path, &kind_name(kind), value));
            return;
        }
        self.range(rules, value, path, out);
        match value {
            Value::Object(members) => self.object(rules, members, path, out),
            Value::Array(items) => self.array(rules, items, path, out),
            Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => {}
        }
    }

    fn target(&self, rules: &Map<String, Value>) -> Option<&'a Value> {
        let name = rules.get("$ref")?.as_str()?.strip_prefix("#/")?;
        name.split('/').try_fold(self.root, |at, part| at.get(part))
    }

    /// The alternative that fits, or the differences to the one that was meant.
    fn choose(&self, choices: &'a [Value], value: &Value, path: &str, out: &mut Vec<Difference>) {
        let mut nearest: Option<Vec<Difference>> = None;
        for choice in choices {
            let mut found = Vec::new();
            self.hold(choice, value, path, &mut found);
            if found.is_empty() {
                return;
            }
            if self.is_meant(choice, value) && nearest.as_ref().is_none_or(|best| found.len() < best.len()) {
                nearest = Some(found);
            }
        }
        match nearest {
            Some(found) => out.extend(found),
            None => {
                let names: Vec<String> = choices.iter().flat_map(|choice| self.names(choice)).collect();
                out.push(difference(path, &format!("one of {}", names.join(", ")), value));
            }
        }
    }

    /// Whether an object names one of the alternative's members, so that this alternative was meant.
    fn is_meant(&self, choice: &'a Value, value: &Value) -> bool {
        let Some(rules) = choice.as_object() else { return false };
        if let Some(target) = self.target(rules) {
            return self.is_meant(target, value);
        }
        match (value, rules.get("properties").and_then(Value::as_object)) {
            (Value::Object(members), Some(known)) => members.keys().any(|name| known.contains_key(name)),
            (Value::Array(_), None) => rules.get("type").is_some_and(|kind| is_kind(kind, value)),
            _ => false,
        }
    }

    fn names(&self, choice: &'a Value) -> Vec<String> {
        let Some(rules) = choice.as_object() else { return Vec::new() };
        if let Some(target) = self.target(rules) {
            return self.names(target);
        }
        let names = crate::schema::alternatives(choice);
        if names.is_empty() {
            return rules.get("type").map(kind_name).into_iter().collect();
        }
        let wraps = rules.contains_key("properties");
        names.into_iter().map(|name| if wraps { format!("{{\"{name}\": …}}") } else { format!("\"{name}\"") }).collect()
    }

    fn object(
        &self,
        rules: &'a Map<String, Value>,
        members: &Map<String, Value>,
        path: &str,
        out: &mut Vec<Difference>,
    ) {
        let known = rules.get("properties").and_then(Value::as_object);
        for name in rules.get("required").and_then(Value::as_array).into_iter().flatten().filter_map(Value::as_str) {
            if !members.contains_key(name) {
                out.push(Difference {
                    path: format!("{path}.{name}"),
                    expected: "a value".into(),
                    found: "nothing".into(),
                });
            }
        }
        for (name, member) in members {
            let inner = format!("{path}.{name}");
            if let Some(schema) = known.and_then(|known| known.get(name)) {
                self.hold(schema, member, &inner, out);
                continue;
            }
            match rules.get("additionalProperties") {
                Some(Value::Bool(false)) => {
                    let allowed: Vec<&str> = known.into_iter().flat_map(Map::keys).map(String::as_str).collect();
                    let expected = format!("no such member; allowed: {}", allowed.join(", "));
                    out.push(Difference { path: inner, expected, found: format!("`{name}`") });
                }
                Some(schema) => self.hold(schema, member, &inner, out),
                None => {}
            }
        }
    }

    fn array(&self, rules: &'a Map<String, Value>, items: &[Value], path: &str, out: &mut Vec<Difference>) {
        let count = |key: &str| rules.get(key).and_then(Value::as_u64);
        let length = items.len() as u64;
        if count("minItems").is_some_and(|least| length < least) || count("maxItems").is_some_and(|most| length > most)
        {
            let least = count("minItems").unwrap_or(0);
            let expected = match count("maxItems") {
                Some(most) if most == least => format!("{least} items"),
                Some(most) => format!("{least} to {most} items"),
                None => format!("at least {least} items"),
            };
            out.push(Difference { path: path.to_owned(), expected, found: format!("{length} items") });
        }
        let firsts = rules.get("prefixItems").and_then(Value::as_array).map(Vec::as_slice).unwrap_or_default();
        for (index, item) in items.iter().enumerate() {
            if let Some(schema) = firsts.get(index).or_else(|| rules.get("items")) {
                self.hold(schema, item, &format!("{path}[{index}]"), out);
            }
        }
    }

    fn range(&self, rules: &Map<String, Value>, value: &Value, path: &str, out: &mut Vec<Difference>) {
        let Some(number) = value.as_f64() else { return };
        let bound = |key: &str| rules.get(key).and_then(Value::as_f64);
        if bound("minimum").is_some_and(|least| number < least) {
            out.push(difference(path, &format!("at least {}", bound("minimum").unwrap_or(0.0)), value));
        }
        if bound("maximum").is_some_and(|most| number > most) {
            out.push(difference(path, &format!("at most {}", bound("maximum").unwrap_or(0.0)), value));
        }
    }
}

fn is_kind(kind: &Value, value: &Value) -> bool {
    match kind {
        Value::Array(kinds) => kinds.iter().any(|kind| is_kind(kind, value)),
        Value::String(name) => match name.as_str() {
            "object" => value.is_object(),
            "array" => value.is_array(),
            "string" => value.is_string(),
            "number" => value.is_number(),
            "integer" => value.is_i64() || value.is_u64(),
            "boolean" => value.is_boolean(),
            "null" => value.is_null(),
            _ => true,
        },
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::Object(_) => true,
    }
}

fn kind_name(kind: &Value) -> String {
    match kind {
        Value::Array(kinds) => kinds.iter().map(kind_name).collect::<Vec<_>>().join(" or "),
        Value::String(name) => name.clone(),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::Object(_) => kind.to_string(),
    }
}

fn joined(words: &[Value]) -> String {
    words.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
}

fn difference(path: &str, expected: &str, value: &Value) -> Difference {
    let text = value.to_string();
    let mut found: String = text.chars().take(SHOWN).collect();
    if text.chars().count() > SHOWN {
        found.push('…');
    }
    Difference { path: path.to_owned(), expected: expected.to_owned(), found: format!("`{found}`") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schema::derived;
    use serde_json::json;
    use socrates_model::Rule;

    fn wrong(value: &Value) -> Vec<(String, String)> {
        differences(&derived::<Rule>(), value).into_iter().map(|d| (d.path, d.expected)).collect()
    }

    #[test]
    fn a_good_rule_has_no_difference() {
        let rule = json!({"when": [{"robot_visible": 3.0}, "robot_moving", {"human_says": ["human_2", "WAIT"]}], "act": "block", "for_s": 5});
        assert_eq!(wrong(&rule), []);
    }

    #[test]
    fn all_differences_are_named_with_their_paths() {
        let rule = json!({"when": [{"robot_visible": "near"}, "sometimes"], "do": "block", "latched": 1});
        let paths: Vec<String> = wrong(&rule).into_iter().map(|(path, _)| path).collect();
        assert_eq!(paths, ["$.act", "$.do", "$.latched", "$.when[0].robot_visible", "$.when[1]"]);
    }

    #[test]
    fn an_unknown_word_is_answered_with_the_known_ones() {
        let found = wrong(&json!({"when": ["always"], "act": "dance"}));
        assert!(found[0].1.contains("\"run_away\"") && found[0].1.contains("{\"follow_human\": …}"), "{found:?}");
    }
}
