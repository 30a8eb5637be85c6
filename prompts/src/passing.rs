//! An example of what passes, beside the reasons why an answer was refused: the parts in which the two differ.

use serde::{Deserialize, Serialize};
use serde_json::Value;
use socrates_model::job::Stage;

use crate::question::Question;
use crate::style::Style;
use crate::{order, parse_behaviors, parse_paths, shown};

/// An answer that passes the checks, made by the program from the refused one.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Passing {
    /// The paths or behaviors in full form, JSON.
    pub answer: String,
}

const INTRODUCTION: &str = "So it would pass the checks before a run, for instance (made by the program, which does not know what is meant):\n";

/// The parts of the example that the refused answer has otherwise, a line each, in the form of the answer; nothing where there is no
/// example, or nothing to compare it with.
pub(crate) fn told(question: &Question, style: &Style) -> String {
    let Some(passing) = &question.passing else { return String::new() };
    let Some(good) = shown::in_form(question, style, &passing.answer) else { return String::new() };
    let mut lines: Vec<String> = Vec::new();
    match (question.stage, refused(question, style)) {
        // Ways fit each other: a part of one answer is none of another.
        (Stage::Paths, _) => lines.push(order::written(&good, order::of(Stage::Paths))),
        (_, Some(bad)) => differences("", &bad, &good, &mut lines),
        (_, None) => {}
    }
    if lines.is_empty() { String::new() } else { format!("{INTRODUCTION}{}\n", lines.join("\n")) }
}

/// The refused answer in the form of the answer, where it can be read.
fn refused(question: &Question, style: &Style) -> Option<Value> {
    let text = question.refused.as_deref()?;
    let kept = match question.stage {
        Stage::Paths => serde_json::to_string(&parse_paths(text, question).ok()?),
        Stage::Behaviors => serde_json::to_string(&parse_behaviors(text, question).ok()?),
        Stage::Proposal | Stage::Review | Stage::Simulation | Stage::Scoring => return None,
    };
    shown::in_form(question, style, &kept.ok()?)
}

/// A line for each part of `good` that `bad` has otherwise.
fn differences(path: &str, bad: &Value, good: &Value, lines: &mut Vec<String>) {
    if bad == good {
        return;
    }
    let under = |key: &str| if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
    match (bad, good) {
        (Value::Object(bad), Value::Object(good)) => {
            for (key, value) in good {
                differences(&under(key), bad.get(key).unwrap_or(&Value::Null), value, lines);
            }
            for key in bad.keys().filter(|key| !good.contains_key(*key)) {
                lines.push(format!("{}: leave it out", under(key)));
            }
        }
        (Value::Array(bad), Value::Array(good)) if good.len() > bad.len() && good.starts_with(bad) => {
            for more in good.iter().skip(bad.len()) {
                lines.push(format!("{path}, one more: {more}"));
            }
        }
        (Value::Array(bad), Value::Array(good)) if bad.len() == good.len() => {
            for (index, (bad, good)) in bad.iter().zip(good).enumerate() {
                differences(&format!("{path}[{index}]"), bad, good, lines);
            }
        }
        (_, good) => lines.push(format!("{path}: {good}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_part_that_differs_is_shown_and_the_rest_is_not() {
        let (bad, good) = (
            json!({"a": {"b": 1, "c": [1, 2], "gone": 1}, "same": [{}], "d": [1, 2, 3]}),
            json!({"a": {"b": 2, "c": [1, 2, {"x": 1}]}, "same": [{}], "d": [1, 5, 3], "new": true}),
        );
        let mut lines = Vec::new();
        differences("", &bad, &good, &mut lines);
        assert_eq!(lines, ["a.b: 2", "a.c, one more: {\"x\":1}", "a.gone: leave it out", "d[1]: 5", "new: true"]);
    }
}
