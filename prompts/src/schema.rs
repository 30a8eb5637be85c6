//! JSON schemas of the answers, in the strict subset that servers enforce.

use serde_json::{Map, Value, json};
use socrates_model::Rule;
use socrates_model::job::Stage;

use crate::question::Question;
use crate::sentences::sentences;
use crate::style::{BehaviorsForm, PathsForm, Style};
use crate::{account, order, place_text, scenario};

/// With more nodes than this, ids are checked after the answer instead of by the server.
const MOST_IDS: usize = 250;
/// Room to think before the answer proper; the first member of every answer. Not read.
pub(crate) const THINKING: &str = "analysis";

/// The schema that the answer to this question has to keep. Closed objects, every member required, `null` for nothing;
/// humans, nodes and place classes are those of the question.
#[must_use]
pub fn answer_schema(question: &Question, style: &Style) -> Value {
    match question.stage {
        Stage::Proposal | Stage::Review | Stage::Simulation | Stage::Scoring => {
            let one = stated(question);
            let count = question.variants(style);
            if count > 1 { several(one, count) } else { one }
        }
        Stage::Paths => paths(question, style.paths),
        Stage::Behaviors => behaviors(question, style.behaviors),
    }
}

/// The schema of a model type as it is derived, for the reader.
pub(crate) fn derived<T: schemars::JsonSchema>() -> Value {
    schemars::schema_for!(T).to_value()
}

/// A closed object of these members.
fn object(members: &[(&str, Value)]) -> Value {
    let members: Map<String, Value> =
        members.iter().map(|(name, schema)| ((*name).to_owned(), schema.clone())).collect();
    json!({"type": "object", "properties": members})
}

fn list(items: &Value) -> Value {
    json!({"type": "array", "items": items})
}

fn or_null(schema: &Value) -> Value {
    json!({"anyOf": [schema, {"type": "null"}]})
}

fn text() -> Value {
    json!({"type": "string"})
}

/// An answer with a scenario: see [`scenario`].
fn stated(question: &Question) -> Value {
    let (stated, definitions) = scenario::schema();
    let mut schema = object(&[
        (THINKING, thinking()),
        (account::MEMBER, account_of(question)),
        ("title", text()),
        ("description", text()),
        (scenario::MEMBER, stated),
        ("expected_behavior", text()),
        ("notes", list(&text())),
    ]);
    let definitions: Vec<(&str, Value)> = definitions.iter().map(|(name, one)| (name.as_str(), one.clone())).collect();
    define(&mut schema, &definitions);
    define(&mut schema, &[("lines", list(&text()))]);
    strict(&mut schema, order::of(question.stage));
    schema
}

/// The account of a request: a member for each sentence, so that none can be left out.
fn account_of(question: &Question) -> Value {
    let each: Vec<(String, Value)> =
        sentences(&question.request).into_iter().map(|one| (one.id, json!({"$ref": "#/$defs/lines"}))).collect();
    object(&each.iter().map(|(id, share)| (id.as_str(), share.clone())).collect::<Vec<_>>())
}

/// The schema of several answers of this form in one.
fn several(mut one: Value, count: u32) -> Value {
    let defs = one.as_object_mut().and_then(|members| members.remove("$defs")).unwrap_or_default();
    json!({"type": "object", "properties": {"variants": {"type": "array", "items": one, "minItems": count, "maxItems": count}},
        "required": ["variants"], "additionalProperties": false, "$defs": defs})
}

/// Adds definitions to those of a schema.
fn define(schema: &mut Value, defs: &[(&str, Value)]) {
    let Some(members) = schema.as_object_mut() else { return };
    let known = members.entry("$defs").or_insert_with(|| json!({}));
    if let Some(known) = known.as_object_mut() {
        known.extend(defs.iter().map(|(name, schema)| ((*name).to_owned(), schema.clone())));
    }
}

fn paths(question: &Question, form: PathsForm) -> Value {
    let graph = &question.location.graph;
    let mut ids: Vec<&str> = graph.nodes().iter().map(|node| node.id.as_str()).collect();
    ids.sort_unstable();
    let few = ids.len() <= MOST_IDS;
    let node = if few { json!({"type": "string", "enum": ids}) } else { text() };
    let names = human_names(question);
    let one = json!({"$ref": "#/$defs/node"});
    let mut defs = vec![("node".to_owned(), node)];
    let way = |more: Option<(&str, Value)>| {
        let stops = [("goal", one.clone()), ("start", one.clone()), ("via", list(&one))];
        object(&stops.into_iter().chain(more).collect::<Vec<_>>())
    };
    // A list of nodes only where somebody meets the robot more than once.
    let again = question.proposal.as_ref().is_some_and(|proposal| !crate::vocabulary::meetings(proposal).is_empty());
    let meet = if again { json!({"anyOf": [one.clone(), list(&one), {"type": "null"}]}) } else { or_null(&one) };
    let (robot, human) = match form {
        PathsForm::Anchors => (way(None), way(Some(("meet", meet)))),
        // A map too large for a chain of its own is walked by name.
        PathsForm::Walk if few => {
            // A definition for each node under a name of a letter: the names are most of what such a schema costs.
            let step = |id: &socrates_model::NodeId| ids.binary_search(&id.as_str()).ok().map(walk_from);
            defs.extend(ids.iter().enumerate().filter_map(|(place, id)| {
                let node = socrates_model::NodeId::new(*id).ok()?;
                let mut next: Vec<Value> = graph.neighbors(&node).iter().filter_map(step).collect();
                next.push(json!({"type": "null"}));
                let here = object(&[("at", json!({"const": id})), ("next", json!({"anyOf": next}))]);
                Some((place_text::letters_of(place), here))
            }));
            let walk: Vec<Value> = (0..ids.len()).map(walk_from).collect();
            defs.push(("walk".to_owned(), json!({"anyOf": walk})));
            let walk = json!({"$ref": "#/$defs/walk"});
            (walk.clone(), object(&[("meet", meet), ("walk", walk)]))
        }
        PathsForm::Walk | PathsForm::Nodes => (list(&one), list(&one)),
    };
    let human_ref = json!({"$ref": "#/$defs/human"});
    defs.push(("human".to_owned(), human));
    let each: Vec<(&str, Value)> = names.iter().map(|name| (name.as_str(), human_ref.clone())).collect();
    let mut members = vec![(THINKING, thinking()), ("humans", object(&each)), ("robot", robot)];
    if form == PathsForm::Nodes {
        let human = json!({"type": "string", "enum": names});
        members.push(("encounters", list(&object(&[("human", human), ("node", one)]))));
    }
    let mut schema = object(&members);
    let defs: Vec<(&str, Value)> = defs.iter().map(|(name, schema)| (name.as_str(), schema.clone())).collect();
    define(&mut schema, &defs);
    strict(&mut schema, order::of(question.stage));
    schema
}

/// The walk that begins at the node of this place among the sorted ids.
fn walk_from(place: usize) -> Value {
    json!({"$ref": format!("#/$defs/{}", place_text::letters_of(place))})
}

fn behaviors(question: &Question, form: BehaviorsForm) -> Value {
    let (key, written, defs) = match form {
        BehaviorsForm::Rules => {
            let mut rule = derived::<Rule>();
            let defs = rule.as_object_mut().and_then(|rule| rule.remove("$defs"));
            let mut defs: Map<String, Value> = defs.and_then(|defs| defs.as_object().cloned()).unwrap_or_default();
            defs.insert("Rule".to_owned(), rule);
            ("rules", list(&json!({"$ref": "#/$defs/Rule"})), Value::Object(defs))
        }
        BehaviorsForm::JsonTree => {
            let tags: Vec<&str> = crate::trees::TAGS.into_iter().chain([socrates_bt::WALK]).collect();
            let node = json!({"$ref": "#/$defs/node"});
            let each = object(&[
                ("children", list(&node)),
                ("node", json!({"type": "string", "enum": tags})),
                ("ports", list(&text())),
            ]);
            ("tree", node, json!({"node": each}))
        }
        BehaviorsForm::Xml => ("tree", text(), json!({})),
    };
    let behavior = object(&[(key, written)]);
    let names = human_names(question);
    let each: Vec<(&str, Value)> = names.iter().map(|name| (name.as_str(), behavior.clone())).collect();
    let mut schema = object(&[(THINKING, thinking()), ("humans", object(&each))]);
    if let Some(members) = schema.as_object_mut() {
        members.insert("$defs".to_owned(), defs);
    }
    strict(&mut schema, order::of(question.stage));
    schema
}

fn thinking() -> Value {
    json!({"type": "string", "description": "your plan, at most 400 characters"})
}

fn human_names(question: &Question) -> Vec<String> {
    question
        .proposal
        .as_ref()
        .map_or_else(Vec::new, |proposal| question.humans(proposal).iter().map(|human| human.id.to_string()).collect())
}

/// Brings a schema into the strict subset: closed objects, all members required (optional ones may be null),
/// `anyOf` for `oneOf`, lists of one item form, no titles, formats and defaults.
fn strict(schema: &mut Value, order: &[&str]) {
    match schema {
        Value::Array(items) => items.iter_mut().for_each(|item| strict(item, order)),
        Value::Object(object) => {
            // What things mean stands in the prompt, once.
            let thinking =
                object.get("description").and_then(Value::as_str).is_some_and(|text| text.starts_with("your plan"));
            for key in ["$schema", "title", "format", "default", "description", "minimum", "maximum"] {
                if thinking && key == "description" {
                    continue;
                }
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
            close(object, order);
            for value in object.values_mut() {
                strict(value, order);
            }
        }
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => {}
    }
}

/// Closes an object. Its list of required members says in which order they are written.
fn close(object: &mut Map<String, Value>, order: &[&str]) {
    if object.get("type") != Some(&json!("object")) {
        return;
    }
    let given = object.get("required").and_then(Value::as_array).cloned();
    let Some(members) = object.get_mut("properties").and_then(Value::as_object_mut) else { return };
    let mut names: Vec<&String> = members.keys().collect();
    names.sort_by(|one, other| order::compare(one, other, order));
    let names: Vec<Value> = names.into_iter().map(|name| json!(name)).collect();
    if let Some(given) = given {
        for (_, member) in members.iter_mut().filter(|(name, _)| !given.contains(&json!(name))) {
            if !allows_null(member) {
                let inner = std::mem::take(member);
                *member = or_null(&inner);
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

    fn styles() -> Vec<Style> {
        let forms = PathsForm::ALL.iter().zip(BehaviorsForm::ALL);
        forms.map(|(paths, behaviors)| Style { paths: *paths, behaviors: *behaviors, ..Style::default() }).collect()
    }

    #[test]
    fn every_object_is_closed_and_requires_all_its_members() {
        for (stage, style) in [Stage::Proposal, Stage::Paths, Stage::Behaviors].into_iter().zip(styles().repeat(3)) {
            let schema = answer_schema(&question(stage), &style);
            let mut objects = 0;
            walk(&schema, &mut |object| {
                for refused in ["oneOf", "prefixItems", "default", "format", "minimum"] {
                    assert!(object.get(refused).is_none_or(Value::is_object), "{refused} in {object:?}");
                }
                if object.get("type") == Some(&json!("object")) && object.contains_key("properties") {
                    objects += 1;
                    assert_eq!(object["additionalProperties"], json!(false));
                    let mut names: Vec<&str> =
                        object["properties"].as_object().unwrap().keys().map(String::as_str).collect();
                    names.sort_by(|one, other| order::compare(one, other, order::of(stage)));
                    assert_eq!(object["required"], json!(names));
                }
            });
            assert!(objects > 1, "{stage}");
        }
    }

    #[test]
    fn thinking_comes_before_the_answer() {
        for stage in [Stage::Proposal, Stage::Paths, Stage::Behaviors] {
            for style in styles() {
                let schema = answer_schema(&question(stage), &style);
                assert_eq!(schema["required"][0], THINKING);
            }
        }
    }

    #[test]
    fn node_ids_and_humans_are_those_of_the_question() {
        for style in styles() {
            let schema = answer_schema(&question(Stage::Paths), &style);
            assert_eq!(schema["$defs"]["node"]["enum"], json!(["c", "e", "n", "w"]));
            assert_eq!(schema["properties"]["humans"]["required"], json!(["human_1", "human_2"]));
        }
    }

    #[test]
    fn in_a_walk_only_a_neighbor_can_come_next() {
        let style = Style { paths: PathsForm::Walk, ..Style::default() };
        let schema = answer_schema(&question(Stage::Paths), &style);
        // Sorted: c, e, n, w. From `e` one comes to `c` alone.
        let here = &schema["$defs"]["B"]["properties"];
        assert_eq!(here["at"], json!({"const": "e"}));
        assert_eq!(here["next"]["anyOf"], json!([{"$ref": "#/$defs/A"}, {"type": "null"}]));
        let jump = json!({"at": "e", "next": {"at": "n", "next": null}});
        let step = json!({"at": "e", "next": {"at": "c", "next": null}});
        let wrong = |walk: &Value| {
            let humans = json!({"human_1": {"meet": "c", "walk": step}, "human_2": {"meet": "c", "walk": step}});
            let answer = json!({"analysis": "", "robot": walk, "humans": humans});
            crate::conforms::differences("$", &schema, &answer).len()
        };
        assert_eq!(wrong(&step), 0);
        assert!(wrong(&jump) > 0);
    }
}
