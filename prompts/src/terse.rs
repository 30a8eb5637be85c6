//! The short form of a proposal: rules, script and tests of clauses as lines of words instead of nested objects.
//!
//! ```text
//! robot_near:3 + robot_moving -> run_away for=5 gesture=WAIT latched      a rule
//! at_encounter:human_1 -> say:WAIT                                          a line of the robot's script
//! meets human=human_1 within_m=2.5                                          the test of a clause
//! ```
//!
//! It takes about a third of the tokens of the full form, going and coming. What cannot be read stays as it is, so that
//! the check against the schema names it.

use serde_json::{Map, Value, json};

/// Members of tests that are lists of triggers or one action, not plain values.
const LISTS: &str = "when";
const ACTIONS: &str = "act";
/// What an author could not use, who is told what was read.
pub(crate) const NOT_UNDERSTOOD: &str = "not_understood";
/// What stands in the line of a test before the id of the fact that it shows.
const SOURCE: &str = "source=";
/// Members of a human and of the robot that are written where they are nothing, too.
const OF_HUMAN: [&str; 4] = ["group", "start", "goal", "speed_mps"];
const OF_ROBOT: [&str; 2] = ["start", "goal"];

/// Brings a short proposal into the full form; a full one passes unchanged. The robot's task is the request's.
pub(crate) fn expand(value: &mut Value, task: &str) {
    let Some(members) = value.as_object_mut() else { return };
    // Only a request that names a pattern is asked for one.
    members.entry("pattern").or_insert_with(|| json!(socrates_model::Proposal::FREE));
    if let Some(humans) = members.get_mut("humans") {
        keyed_to_list(humans);
        for human in humans.as_array_mut().into_iter().flatten() {
            each_line(human.get_mut("rules"), rule);
        }
    }
    if let Some(robot) = members.get_mut("robot") {
        each_line(robot.get_mut("script"), script);
        if let Some(robot) = robot.as_object_mut() {
            robot.entry("task").or_insert_with(|| json!(task));
        }
    }
    if let Some(events) = members.get_mut("expected_events") {
        clauses(events);
    }
}

/// `{"setup": ["… source=f1"], "outcome": ["…"]}` becomes a list of clauses; so does every clause with a `test`.
fn clauses(events: &mut Value) {
    if let Some(parts) = events.as_object_mut() {
        let mut list = Vec::new();
        for role in ["setup", "outcome"] {
            for clause in parts.remove(role).and_then(|part| part.as_array().cloned()).unwrap_or_default() {
                let mut clause = if clause.is_object() { clause } else { json!({"test": clause}) };
                if let Some(clause) = clause.as_object_mut() {
                    clause.insert("role".to_owned(), json!(role));
                    clause.entry("must").or_insert(json!(true));
                }
                list.push(clause);
            }
        }
        // What else stands there is nothing that can be read.
        list.extend(std::mem::take(parts).into_iter().map(|(name, value)| json!({name: value})));
        *events = Value::Array(list);
    }
    for (index, clause) in events.as_array_mut().into_iter().flatten().enumerate() {
        let Some(clause) = clause.as_object_mut() else { continue };
        let Some(line) = clause.remove("test") else { continue };
        let (line, source) = sourced(line);
        if let Some(source) = source {
            clause.insert("source".to_owned(), json!(source));
        }
        let read = line.as_str().and_then(test).unwrap_or_else(|| line.clone());
        let text = crate::vocabulary::test_in_words(&read).map_or(line, Value::String);
        clause.insert("predicate".to_owned(), read);
        clause.entry("id").or_insert_with(|| json!(format!("c{}", index + 1)));
        clause.entry("text").or_insert(text);
    }
}

/// The line of a test without the fact that it shows, and that fact.
fn sourced(line: Value) -> (Value, Option<String>) {
    let Value::String(text) = &line else { return (line, None) };
    let is_source = |word: &&str| word.starts_with(SOURCE);
    let Some(word) = text.split_whitespace().find(is_source) else { return (line, None) };
    let source = word.trim_start_matches(SOURCE).to_owned();
    let rest: Vec<&str> = text.split_whitespace().filter(|word| !word.starts_with(SOURCE)).collect();
    (json!(rest.join(" ")), Some(source))
}

/// `{"human_1": {…}}` becomes `[{"id": "human_1", …}]`, in order of the numbers.
fn keyed_to_list(humans: &mut Value) {
    let Some(members) = humans.as_object_mut() else { return };
    let mut list: Vec<(u64, Value)> = std::mem::take(members)
        .into_iter()
        .map(|(name, mut human)| {
            if let Some(human) = human.as_object_mut() {
                human.insert("id".to_owned(), json!(name));
            }
            (name.rsplit('_').next().and_then(|number| number.parse().ok()).unwrap_or(u64::MAX), human)
        })
        .collect();
    list.sort_by_key(|(number, _)| *number);
    *humans = Value::Array(list.into_iter().map(|(_, human)| human).collect());
}

fn each_line(list: Option<&mut Value>, read: fn(&str) -> Option<Value>) {
    for line in list.and_then(Value::as_array_mut).into_iter().flatten() {
        if let Some(value) = line.as_str().and_then(read) {
            *line = value;
        }
    }
}

fn rule(line: &str) -> Option<Value> {
    let (when, then) = line.split_once("->")?;
    let mut words = then.split_whitespace();
    let mut rule = json!({"when": terms(when), "act": term(words.next()?)});
    for word in words {
        let (name, value) = match word.split_once('=') {
            Some(("for" | "for_s", secs)) => ("for_s", scalar(secs.trim_end_matches('s'))),
            Some(("gesture", name)) => ("gesture", json!(name)),
            None if word == "latched" => ("latched", json!(true)),
            Some(_) | None => return None,
        };
        rule.as_object_mut()?.insert(name.to_owned(), value);
    }
    Some(rule)
}

fn script(line: &str) -> Option<Value> {
    let (when, act) = line.split_once("->")?;
    Some(json!({"when": term(when.trim()), "act": term(act.trim())}))
}

/// Members of tests that are true where they stand alone: `before first=human_1 then=robot at_door`.
const FLAGS: [&str; 1] = ["at_door"];

fn test(line: &str) -> Option<Value> {
    let mut words = line.split_whitespace();
    let name = words.next()?;
    let mut members = Map::new();
    for word in words {
        let (key, value) = word.split_once('=').or_else(|| FLAGS.contains(&word).then_some((word, "true")))?;
        let value = match (key, value) {
            (LISTS, _) => terms(value),
            (ACTIONS, _) => term(value),
            (_, "true" | "false") => json!(value == "true"),
            _ => scalar(value),
        };
        members.insert(key.to_owned(), value);
    }
    Some(if members.is_empty() { json!(name) } else { json!({name: members}) })
}

fn terms(text: &str) -> Value {
    text.split('+').map(|part| term(part.trim())).collect()
}

/// `a` is `"a"`, `a:1` is `{"a": 1}`, `a:b:c` is `{"a": ["b", "c"]}`.
fn term(text: &str) -> Value {
    let mut parts = text.split(':');
    let name = parts.next().unwrap_or_default();
    let mut values: Vec<Value> = parts.map(scalar).collect();
    match values.len() {
        0 => json!(name),
        1 => json!({name: values.remove(0)}),
        _ => json!({name: values}),
    }
}

/// A number, a range `1..4` as a pair, else a text.
fn scalar(text: &str) -> Value {
    let number = |text: &str| -> Option<Value> {
        text.parse::<i64>()
            .map(|whole| json!(whole))
            .ok()
            .or_else(|| text.parse::<f64>().ok().filter(|value| value.is_finite()).map(|value| json!(value)))
    };
    if let Some((low, high)) = text.split_once("..")
        && let (Some(low), Some(high)) = (number(low), number(high))
    {
        return json!([low, high]);
    }
    number(text).unwrap_or_else(|| json!(text))
}

/// The full form of a trigger, an action or a test as a line.
pub(crate) fn line(value: &Value) -> String {
    match value {
        Value::Object(members) => members.iter().next().map_or_else(String::new, |(name, inner)| match inner {
            Value::Object(members) => {
                let words: Vec<String> = members
                    .iter()
                    .filter(|(_, value)| **value != json!(""))
                    .map(|(key, value)| format!(" {key}={}", member(key, value)))
                    .collect();
                format!("{name}{}", words.concat())
            }
            Value::Array(items) => {
                let parts: Vec<String> = items.iter().map(word).collect();
                format!("{name}:{}", parts.join(":"))
            }
            Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => format!("{name}:{}", word(inner)),
        }),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) | Value::Array(_) => word(value),
    }
}

fn member(key: &str, value: &Value) -> String {
    match (key, value) {
        (LISTS, Value::Array(items)) => items.iter().map(line).collect::<Vec<_>>().join("+"),
        (ACTIONS, _) => line(value),
        (_, Value::Array(items)) => items.iter().map(word).collect::<Vec<_>>().join(".."),
        _ => word(value),
    }
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
    let value = serde_json::to_value(rule).unwrap_or_default();
    let when = value.get("when").map(|when| member(LISTS, when)).unwrap_or_default();
    let mut text = format!("{} -> {}", when.replace('+', " + "), value.get("act").map(line).unwrap_or_default());
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

/// A full proposal in the short form, with every member of its form: as a worked example shows it. Humans are `keyed` by name, or listed.
pub(crate) fn shorten(proposal: &Value, keyed: bool) -> Value {
    let mut short = proposal.clone();
    let Some(members) = short.as_object_mut() else { return short };
    members.remove("format");
    members.remove("author");
    if members.get("pattern") == Some(&json!(socrates_model::Proposal::FREE)) {
        members.remove("pattern");
    }
    let humans: Vec<Map<String, Value>> =
        members.get("humans").and_then(Value::as_array).into_iter().flatten().filter_map(short_human).collect();
    let humans = if keyed {
        let named = |mut human: Map<String, Value>| {
            let name = human.remove("id").as_ref().and_then(Value::as_str).unwrap_or_default().to_owned();
            (name, Value::Object(human))
        };
        Value::Object(humans.into_iter().map(named).collect())
    } else {
        humans.into_iter().map(Value::Object).collect()
    };
    members.insert("humans".to_owned(), humans);
    if let Some(robot) = members.get_mut("robot").and_then(Value::as_object_mut) {
        short_robot(robot);
    }
    let mut events = json!({"setup": [], "outcome": []});
    for clause in members.remove("expected_events").as_ref().and_then(Value::as_array).into_iter().flatten() {
        let test = clause.get("predicate").map(line).unwrap_or_default();
        let role = clause.get("role").and_then(Value::as_str).unwrap_or("setup");
        let source = clause.get("source").and_then(Value::as_str).filter(|source| !source.is_empty());
        let line = source.map_or_else(|| test.clone(), |source| format!("{test} {SOURCE}{source}"));
        if let Some(list) = events.get_mut(role).and_then(Value::as_array_mut) {
            list.push(json!(line));
        }
    }
    members.insert("expected_events".to_owned(), events);
    for list in ["groups", "notes", NOT_UNDERSTOOD] {
        members.entry(list).or_insert_with(|| json!([]));
    }
    short
}

fn short_human(human: &Value) -> Option<Map<String, Value>> {
    let mut human = human.as_object().cloned()?;
    let rules = human.get("rules").cloned().and_then(|rules| serde_json::from_value(rules).ok());
    let rules: Vec<socrates_model::Rule> = rules.unwrap_or_default();
    human.insert("rules".to_owned(), rules.iter().map(rule_line).collect());
    for name in OF_HUMAN {
        human.entry(name).or_insert(Value::Null);
    }
    Some(human)
}

fn short_robot(robot: &mut Map<String, Value>) {
    robot.remove("task");
    let lines: Value = robot
        .get("script")
        .and_then(Value::as_array)
        .into_iter()
        .flatten()
        .map(|rule| {
            let part = |key: &str| rule.get(key).map(line).unwrap_or_default();
            format!("{} -> {}", part("when"), part("act"))
        })
        .collect();
    robot.insert("script".to_owned(), lines);
    for name in OF_ROBOT {
        robot.entry(name).or_insert(Value::Null);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::proposal;

    #[test]
    fn rules_scripts_and_tests_are_read() {
        assert_eq!(
            rule("robot_near:3 + robot_moving -> follow_human:human_2 for=5s gesture=WAIT latched"),
            Some(json!({"when": [{"robot_near": 3}, "robot_moving"], "act": {"follow_human": "human_2"},
                "for_s": 5, "gesture": "WAIT", "latched": true}))
        );
        assert_eq!(script("start -> say:WAIT"), Some(json!({"when": "start", "act": {"say": "WAIT"}})));
        assert_eq!(
            test("reacts human=human_1 when=robot_visible:5+human_says:human_2:WAIT act=block within_s=2.5"),
            Some(json!({"reacts": {"human": "human_1", "within_s": 2.5, "act": "block",
                "when": [{"robot_visible": 5}, {"human_says": ["human_2", "WAIT"]}]}}))
        );
        assert_eq!(test("flow count=4 angle_deg=0..30"), Some(json!({"flow": {"count": 4, "angle_deg": [0, 30]}})));
        assert_eq!(test("plausible"), Some(json!("plausible")));
        let before = json!({"before": {"first": "human_1", "then": "robot", "at_door": true}});
        for line in ["before first=human_1 then=robot at_door", "before at_door=true first=human_1 then=robot"] {
            assert_eq!(test(line), Some(before.clone()));
        }
        assert_eq!((rule("robot_near:3"), rule("always -> block loudly"), test("meets human_1")), (None, None, None));
    }

    #[test]
    fn a_short_proposal_is_the_full_one() {
        let full = serde_json::to_value(proposal()).unwrap();
        let mut short = shorten(&full, true);
        expand(&mut short, "deliver");
        let read = crate::answer::prepared(short);
        let read: socrates_model::Proposal = crate::answer::typed(read).unwrap();
        let mut full = proposal();
        // The text for people is made from the test.
        full.expected_events[0].text = "so many are there all the time (count=2)".into();
        assert_eq!(socrates_model::Proposal { format: 1, author: "test".into(), ..read }, full);
    }

    #[test]
    fn ten_humans_come_in_order() {
        let mut humans: Value = (1..=11).map(|k| (format!("human_{k}"), json!({}))).collect::<Map<_, _>>().into();
        keyed_to_list(&mut humans);
        assert_eq!((&humans[1]["id"], &humans[9]["id"]), (&json!("human_2"), &json!("human_10")));
    }
}
