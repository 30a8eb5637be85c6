//! The order in which the members of an answer are written: that in which one thinks.
//!
//! A server that enforces a schema has its members written in the order in which they stand there, and a model does as the examples do: the
//! account before the scenario, a human's place before what they do, and a rule's triggers before its action. Members that are not named here
//! follow by their names.

use std::cmp::Ordering;

use serde_json::Value;
use socrates_model::job::Stage;

const PROPOSAL: &[&str] = &[
    "analysis",
    "variants",
    "reading",
    "title",
    "description",
    "scenario",
    "place",
    "robot",
    "human",
    "order",
    "notes",
    // Of a human, a group, the robot.
    "id",
    "role",
    "relation",
    "group",
    "start",
    "goal",
    "when",
    "act",
    "for_s",
    "until",
    "say",
    "to",
    "expected_behavior",
];

const PATHS: &[&str] = &[
    "analysis",
    "robot",
    "humans",
    "encounters",
    "walk",
    "at",
    "next",
    "start",
    "via",
    "meet",
    "goal",
    "human",
    "node",
];

const BEHAVIORS: &[&str] =
    &["analysis", "humans", "rules", "tree", "when", "act", "for_s", "gesture", "latched", "node", "ports", "children"];

/// The names of a stage's members in their order.
pub(crate) const fn of(stage: Stage) -> &'static [&'static str] {
    match stage {
        Stage::Proposal | Stage::Review | Stage::Simulation | Stage::Scoring => PROPOSAL,
        Stage::Paths => PATHS,
        Stage::Behaviors => BEHAVIORS,
    }
}

/// Which of two members comes first.
pub(crate) fn compare(one: &str, other: &str, order: &[&str]) -> Ordering {
    let rank = |name: &str| order.iter().position(|known| *known == name).unwrap_or(order.len());
    rank(one).cmp(&rank(other)).then_with(|| numbered(one).cmp(&numbered(other)))
}

/// A name without its number, and the number: `human_2` comes before `human_10`.
fn numbered(name: &str) -> (&str, u64) {
    let stem = name.trim_end_matches(|c: char| c.is_ascii_digit());
    (stem, name.get(stem.len()..).and_then(|number| number.parse().ok()).unwrap_or(0))
}

/// An answer as JSON with its members in order.
pub(crate) fn written(value: &Value, order: &[&str]) -> String {
    match value {
        Value::Object(members) => {
            let mut names: Vec<&String> = members.keys().collect();
            names.sort_by(|one, other| compare(one, other, order));
            let each = names.into_iter().filter_map(|name| Some((name, members.get(name)?)));
            let each = each.map(|(name, value)| format!("{}:{}", Value::from(name.as_str()), written(value, order)));
            format!("{{{}}}", each.collect::<Vec<_>>().join(","))
        }
        Value::Array(items) => {
            format!("[{}]", items.iter().map(|item| written(item, order)).collect::<Vec<_>>().join(","))
        }
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => value.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn an_answer_is_written_in_the_order_in_which_one_thinks() {
        let rule = json!({"latched": true, "act": "run_away", "when": ["robot_moving"], "for_s": 2});
        assert_eq!(
            written(&rule, of(Stage::Behaviors)),
            r#"{"when":["robot_moving"],"act":"run_away","for_s":2,"latched":true}"#
        );
        let paths =
            json!({"humans": {"human_10": 1, "human_2": {"goal": "b", "start": "a", "via": []}}, "robot": null});
        assert_eq!(
            written(&paths, of(Stage::Paths)),
            r#"{"robot":null,"humans":{"human_2":{"start":"a","via":[],"goal":"b"},"human_10":1}}"#
        );
        // Whatever the order, it is the same value.
        let odd = json!({"z": "\"\n", "a": [1.5, {"b": {}, "analysis": []}]});
        assert_eq!(serde_json::from_str::<Value>(&written(&odd, of(Stage::Proposal))).unwrap(), odd);
    }
}
