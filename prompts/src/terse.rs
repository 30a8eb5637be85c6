//! Rules, triggers, actions and lines of a script as short lines: `robot_near:3 + robot_moving -> run_away for=5 gesture=WAIT`.

use serde_json::{Value, json};

/// A trigger or an action as a line.
pub(crate) fn line(value: &Value) -> String {
    let Value::Object(members) = value else { return word(value) };
    members.iter().next().map_or_else(String::new, |(name, inner)| match inner {
        Value::Object(members) => {
            let words: String = members.iter().map(|(key, value)| format!(" {key}={}", word(value))).collect();
            format!("{name}{words}")
        }
        Value::Array(items) => format!("{name}:{}", items.iter().map(word).collect::<Vec<_>>().join(":")),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => format!("{name}:{}", word(inner)),
    })
}

fn word(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Number(number) => number.as_f64().map_or_else(|| number.to_string(), |value| value.to_string()),
        Value::Null | Value::Bool(_) | Value::Array(_) | Value::Object(_) => value.to_string(),
    }
}

/// A rule as a line.
pub(crate) fn rule_line(rule: &socrates_model::Rule) -> String {
    let when: Vec<String> = rule.when.iter().map(|trigger| line(&json!(trigger))).collect();
    let mut text = format!("{} -> {}", when.join(" + "), line(&json!(rule.act)));
    if let Some(secs) = rule.for_s {
        text.push_str(&format!(" for={secs}"));
    }
    if let Some(gesture) = rule.gesture {
        text.push_str(&format!(" gesture={}", gesture.name()));
    }
    if rule.latched {
        text.push_str(" latched");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rule_is_a_line() {
        let rule = json!({"when": [{"robot_near": 3}, {"human_says": ["human_2", "WAIT"]}], "act": {"follow_human": "human_2"},
            "for_s": 5, "gesture": "WAIT", "latched": true});
        let rule: socrates_model::Rule = serde_json::from_value(rule).unwrap();
        let line = "robot_near:3 + human_says:human_2:WAIT -> follow_human:human_2 for=5 gesture=WAIT latched";
        assert_eq!(rule_line(&rule), line);
    }
}
