//! Whether an answer keeps to a schema, and where it does not: for authors, who answer again, and for people who write one by hand.
//!
//! The keywords of the schemas that are asked for: types, enumerations, members, items, bounds, choices and local references.
//! `pattern`, `format` and keywords that are not known are not looked at.

use std::cell::Cell;

use serde_json::Value;

/// Looks at a value in all: a schema of strangers may send a check round and round.
const LOOKS: u32 = 200_000;
/// How deep references may lead into one another: a schema that refers to itself ends with the answer, not by itself.
const DEEPEST: usize = 600;
/// Characters of a value that a message to a person shows.
const SHOWN: usize = 40;
/// Characters of a value that a message to an author shows.
const SHOWN_TO_AUTHORS: usize = 60;
/// Values of an enumeration that a message to a person names.
const NAMED: usize = 12;

/// One place at which an answer does not keep to its schema.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct Misfit {
    /// Where, such as `humans.human_1.rules[2].when`; empty for the whole answer.
    pub at: String,
    /// Found value and allowed values.
    pub message: String,
}

/// Where an answer does not keep to a schema, in order of the answer, in words for a person; at most `most` of them.
#[must_use]
pub fn misfits(schema: &Value, answer: &Value, most: usize) -> Vec<Misfit> {
    let check = Check { root: schema, audience: Audience::Person, most, left: Cell::new(LOOKS) };
    let mut found = Vec::new();
    check.value(schema, answer, &AnswerPlace { path: String::new(), depth: 0, first: 1 }, &mut found);
    found.truncate(most);
    found
}

/// Every misfit to a derived schema of a value that stands at a path of an answer, in words for its author. Paths are JSON paths.
pub(crate) fn differences(path: &str, schema: &Value, value: &Value) -> Vec<Misfit> {
    let check = Check { root: schema, audience: Audience::Author, most: usize::MAX, left: Cell::new(u32::MAX) };
    let mut found = Vec::new();
    check.value(schema, value, &AnswerPlace { path: path.to_owned(), depth: 0, first: 0 }, &mut found);
    found
}

/// Audience of the messages. An author gets everything at once, and words of its own schema; a whole number must be written as one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Audience {
    Author,
    Person,
}

/// Where the check is, in the answer.
#[derive(Debug, Clone)]
struct AnswerPlace {
    path: String,
    depth: usize,
    /// Number of the first item of a list.
    first: usize,
}

impl AnswerPlace {
    fn member(&self, name: &str) -> Self {
        let dot = if self.path.is_empty() { "" } else { "." };
        Self { path: format!("{}{dot}{name}", self.path), ..self.deeper() }
    }

    fn item(&self, index: usize) -> Self {
        Self { path: format!("{}[{}]", self.path, index + self.first), ..self.deeper() }
    }

    /// The same place, one reference or choice further.
    fn deeper(&self) -> Self {
        Self { depth: self.depth + 1, ..self.clone() }
    }
}

/// A rule of a schema that a value breaks.
enum Breach<'a> {
    Kind(Vec<&'a str>),
    OneOf(Vec<String>),
    Constant(&'a Value),
    Missing(&'a str),
    Stranger(&'a str, Vec<String>),
    Count { count: u64, unit: &'static str, least: Option<u64>, most: Option<u64> },
    Bound(&'static str, f64),
    Step(f64),
    Reference(&'a str),
}

impl Breach<'_> {
    fn for_person(&self, value: &Value) -> String {
        let (own, number) = (shown(value, SHOWN), value.as_f64().unwrap_or_default());
        match self {
            Self::Kind(kinds) => format!("{own} is {}; allowed: {}", kind_of(value), kinds.join(" or ")),
            Self::OneOf(words) => format!("{own} is not allowed; allowed: {}", listed(words)),
            Self::Constant(word) => format!("{own} is not `{word}`"),
            Self::Missing(name) => format!("`{name}` is missing"),
            Self::Stranger(name, known) => format!("`{name}` is no member here; members: {}", listed(known)),
            Self::Count { count, unit, least: Some(least), .. } if count < least => {
                format!("it has {count} {unit}; at least {least}")
            }
            Self::Count { count, unit, most, .. } => {
                format!("it has {count} {unit}; at most {}", most.unwrap_or_default())
            }
            Self::Bound(words, bound) => format!("{number} is out of range: {words} {bound}"),
            Self::Step(step) => format!("{number} is no multiple of {step}"),
            Self::Reference(target) => format!("the schema refers to `{target}`, which it lacks"),
        }
    }

    fn for_author(&self, value: &Value) -> String {
        let (expected, found) = match self {
            Self::Kind(kinds) => (kinds.join(" or "), None),
            Self::OneOf(words) => (format!("one of {}", words.join(", ")), None),
            Self::Constant(word) => (word.to_string(), None),
            Self::Missing(_) => ("a value".to_owned(), Some("nothing".to_owned())),
            Self::Stranger(name, known) => {
                (format!("no such member; allowed: {}", known.join(", ")), Some(format!("`{name}`")))
            }
            Self::Count { count, unit, least, most } => {
                let least = least.unwrap_or(0);
                let expected = match most {
                    Some(most) if *most == least => format!("{least} {unit}"),
                    Some(most) => format!("{least} to {most} {unit}"),
                    None => format!("at least {least} {unit}"),
                };
                (expected, Some(format!("{count} {unit}")))
            }
            Self::Bound(words, bound) => (format!("{words} {bound}"), None),
            Self::Step(step) => (format!("a multiple of {step}"), None),
            Self::Reference(target) => (format!("a schema at `{target}`"), None),
        };
        format!("expected {expected}, found {}", found.unwrap_or_else(|| shown(value, SHOWN_TO_AUTHORS)))
    }
}

struct Check<'a> {
    root: &'a Value,
    audience: Audience,
    most: usize,
    left: Cell<u32>,
}

impl<'a> Check<'a> {
    fn value(&self, schema: &'a Value, value: &'a Value, place: &AnswerPlace, found: &mut Vec<Misfit>) {
        if found.len() >= self.most || place.depth > DEEPEST || self.left.get() == 0 {
            return;
        }
        self.left.set(self.left.get() - 1);
        if let Some(target) = schema.get("$ref").and_then(Value::as_str) {
            match self.target(target) {
                Some(inner) => self.value(inner, value, &place.deeper(), found),
                None => self.say(found, place, &Breach::Reference(target), value),
            }
        }
        let kinds = self.wrong_kinds(schema, value);
        if kinds.is_none() || self.audience == Audience::Author {
            self.constants(schema, value, place, found);
            self.choices(schema, value, place, found);
        }
        // Where it is of another type nothing in it helps.
        if let Some(kinds) = kinds {
            return self.say(found, place, &Breach::Kind(kinds), value);
        }
        let count = |count: usize| u64::try_from(count).unwrap_or(u64::MAX);
        match value {
            Value::Object(_) => self.members(schema, value, place, found),
            Value::Array(items) => {
                let (unit, keys) = ("items", ["minItems", "maxItems"]);
                self.count(schema, (count(items.len()), unit, keys), value, place, found);
                self.items(schema, items, place, found);
            }
            Value::String(text) => {
                let (unit, keys) = ("characters", ["minLength", "maxLength"]);
                self.count(schema, (count(text.chars().count()), unit, keys), value, place, found);
            }
            Value::Number(_) => self.bounds(schema, value, place, found),
            Value::Null | Value::Bool(_) => {}
        }
    }

    fn say(&self, found: &mut Vec<Misfit>, place: &AnswerPlace, broken: &Breach<'_>, value: &Value) {
        let misfit = match (self.audience, broken) {
            (Audience::Person, _) => Misfit { at: place.path.clone(), message: broken.for_person(value) },
            (Audience::Author, Breach::Missing(name) | Breach::Stranger(name, _)) => {
                Misfit { at: place.member(name).path, message: broken.for_author(value) }
            }
            (Audience::Author, _) => Misfit { at: place.path.clone(), message: broken.for_author(value) },
        };
        found.push(misfit);
    }

    fn target(&self, reference: &str) -> Option<&'a Value> {
        self.root.pointer(reference.strip_prefix('#')?)
    }

    /// Target of a reference; any other schema itself.
    fn resolved(&self, schema: &'a Value) -> &'a Value {
        schema.get("$ref").and_then(Value::as_str).and_then(|name| self.target(name)).unwrap_or(schema)
    }

    /// Members that a choice fixes to one value: by these one sees which choice a value was meant to be.
    fn marks(&self, choice: &'a Value) -> Vec<(&'a str, &'a Value)> {
        let members = self.resolved(choice).get("properties").and_then(Value::as_object).into_iter().flatten();
        let fixed = |schema: &'a Value| match schema.get("enum").and_then(Value::as_array).map(Vec::as_slice) {
            Some([one]) => Some(one),
            _ => schema.get("const"),
        };
        members.filter_map(|(name, schema)| Some((name.as_str(), fixed(schema)?))).collect()
    }

    /// Whether a value has a member, or is the list, of a choice: which choice it was meant to be where nothing is fixed.
    fn is_like(&self, choice: &'a Value, value: &Value) -> bool {
        let choice = self.resolved(choice);
        match (value, choice.get("properties").and_then(Value::as_object)) {
            (Value::Object(members), Some(known)) => members.keys().any(|name| known.contains_key(name)),
            (Value::Array(_), None) => choice.get("type").is_some() && self.wrong_kinds(choice, value).is_none(),
            _ => false,
        }
    }

    /// The words of a choice, or its types.
    fn names(&self, choice: &'a Value) -> Vec<String> {
        let choice = self.resolved(choice);
        let names = crate::schema::alternatives(choice);
        if names.is_empty() {
            let kinds = kinds(choice).unwrap_or_default();
            return if kinds.is_empty() { Vec::new() } else { vec![kinds.join(" or ")] };
        }
        let wraps = choice.get("properties").is_some();
        names.into_iter().map(|name| if wraps { format!("{{\"{name}\": …}}") } else { format!("\"{name}\"") }).collect()
    }

    /// The allowed types of a value that is of none of them.
    fn wrong_kinds(&self, schema: &'a Value, value: &Value) -> Option<Vec<&'a str>> {
        kinds(schema).filter(|kinds| !kinds.iter().any(|kind| self.is_of(kind, value)))
    }

    fn is_of(&self, kind: &str, value: &Value) -> bool {
        match kind {
            "object" => value.is_object(),
            "array" => value.is_array(),
            "string" => value.is_string(),
            "boolean" => value.is_boolean(),
            "null" => value.is_null(),
            "number" => value.is_number(),
            "integer" if self.audience == Audience::Author => value.is_i64() || value.is_u64(),
            // The program that asks may well read 3.0 as a whole number.
            "integer" => value.as_f64().is_some_and(|number| number.fract() == 0.0),
            _ => true,
        }
    }

    fn constants(&self, schema: &'a Value, value: &Value, place: &AnswerPlace, found: &mut Vec<Misfit>) {
        if let Some(constant) = schema.get("const").filter(|constant| *constant != value) {
            self.say(found, place, &Breach::Constant(constant), value);
        }
        if let Some(allowed) = schema.get("enum").and_then(Value::as_array).filter(|allowed| !allowed.contains(value)) {
            self.say(found, place, &Breach::OneOf(allowed.iter().map(Value::to_string).collect()), value);
        }
    }

    fn members(&self, schema: &'a Value, value: &'a Value, place: &AnswerPlace, found: &mut Vec<Misfit>) {
        let Some(members) = value.as_object() else { return };
        let known = schema.get("properties").and_then(Value::as_object);
        for name in schema.get("required").and_then(Value::as_array).into_iter().flatten().filter_map(Value::as_str) {
            if !members.contains_key(name) {
                self.say(found, place, &Breach::Missing(name), value);
            }
        }
        for (name, inner) in members {
            match (known.and_then(|known| known.get(name)), schema.get("additionalProperties")) {
                (Some(own), _) => self.value(own, inner, &place.member(name), found),
                (None, Some(Value::Bool(false))) => {
                    let names = known.into_iter().flatten().map(|(name, _)| name.clone()).collect();
                    self.say(found, place, &Breach::Stranger(name, names), value);
                }
                (None, Some(own @ Value::Object(_))) => self.value(own, inner, &place.member(name), found),
                (None, _) => {}
            }
        }
    }

    fn items(&self, schema: &'a Value, items: &'a [Value], place: &AnswerPlace, found: &mut Vec<Misfit>) {
        let first: Vec<&Value> = schema.get("prefixItems").and_then(Value::as_array).into_iter().flatten().collect();
        let others = schema.get("items").filter(|inner| inner.is_object());
        for (index, item) in items.iter().enumerate() {
            if let Some(inner) = first.get(index).copied().or(others) {
                self.value(inner, item, &place.item(index), found);
            }
        }
    }

    fn count(
        &self,
        schema: &Value,
        (count, unit, keys): (u64, &'static str, [&str; 2]),
        value: &Value,
        place: &AnswerPlace,
        found: &mut Vec<Misfit>,
    ) {
        let [least, most] = keys.map(|key| schema.get(key).and_then(Value::as_u64));
        if least.is_some_and(|least| count < least) || most.is_some_and(|most| count > most) {
            self.say(found, place, &Breach::Count { count, unit, least, most }, value);
        }
    }

    fn bounds(&self, schema: &Value, value: &Value, place: &AnswerPlace, found: &mut Vec<Misfit>) {
        let Some(number) = value.as_f64() else { return };
        let bound = |key: &str| schema.get(key).and_then(Value::as_f64);
        let broken = [
            ("at least", bound("minimum").filter(|least| number < *least)),
            ("at most", bound("maximum").filter(|most| number > *most)),
            ("more than", bound("exclusiveMinimum").filter(|least| number <= *least)),
            ("less than", bound("exclusiveMaximum").filter(|most| number >= *most)),
        ];
        for (words, bound) in broken.into_iter().filter_map(|(words, bound)| Some((words, bound?))) {
            self.say(found, place, &Breach::Bound(words, bound), value);
        }
        if let Some(step) = bound("multipleOf").filter(|step| *step > 0.0) {
            let steps = number / step;
            if (steps - steps.round()).abs() > 1e-9 {
                self.say(found, place, &Breach::Step(step), value);
            }
        }
    }

    /// `allOf`: every one; `anyOf` and `oneOf`: one of them.
    fn choices(&self, schema: &'a Value, value: &'a Value, place: &AnswerPlace, found: &mut Vec<Misfit>) {
        let list = |key: &str| schema.get(key).and_then(Value::as_array).into_iter().flatten();
        for inner in list("allOf") {
            self.value(inner, value, &place.deeper(), found);
        }
        for key in ["anyOf", "oneOf"] {
            let choices: Vec<&Value> = list(key).collect();
            if !choices.is_empty() {
                self.choose(&choices, value, place, found);
            }
        }
    }

    /// Where no choice fits, what keeps the nearest from it.
    fn choose(&self, choices: &[&'a Value], value: &'a Value, place: &AnswerPlace, found: &mut Vec<Misfit>) {
        let differs = |(name, fixed): &(&str, &Value)| value.get(*name).is_some_and(|own| own != *fixed);
        let mark = |choice: &&'a Value| self.marks(choice).into_iter().find(differs);
        let meant: Vec<&Value> = choices.iter().copied().filter(|choice| mark(choice).is_none()).collect();
        if let (true, Some((name, _))) = (meant.is_empty(), choices.first().and_then(mark)) {
            let allowed = choices.iter().flat_map(|choice| self.marks(choice)).filter(|(own, _)| *own == name);
            let allowed = Breach::OneOf(allowed.map(|(_, fixed)| fixed.to_string()).collect());
            return self.say(found, &place.member(name), &allowed, value.get(name).unwrap_or(value));
        }
        let mut nearest: Option<((bool, usize), Vec<Misfit>)> = None;
        for choice in meant {
            let mut own = Vec::new();
            self.value(choice, value, &place.deeper(), &mut own);
            if own.is_empty() {
                return;
            }
            let other = match self.audience {
                // An author is shown all choices where it meant none of them.
                Audience::Author if self.is_like(choice, value) => false,
                Audience::Author => continue,
                // A choice of another type or with other members says less of the value than one with a wrong value inside.
                Audience::Person => own.iter().any(|misfit| misfit.at == place.path),
            };
            let distance = (other, own.len());
            if nearest.as_ref().is_none_or(|(best, _)| distance < *best) {
                nearest = Some((distance, own));
            }
        }
        match nearest {
            Some((_, misfits)) => found.extend(misfits),
            None => {
                let names = choices.iter().flat_map(|choice| self.names(choice)).collect();
                self.say(found, place, &Breach::OneOf(names), value);
            }
        }
    }
}

/// The types that a schema allows, where it says any.
fn kinds(schema: &Value) -> Option<Vec<&str>> {
    match schema.get("type")? {
        Value::String(one) => Some(vec![one]),
        Value::Array(several) => Some(several.iter().filter_map(Value::as_str).collect()),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::Object(_) => None,
    }
}

const fn kind_of(value: &Value) -> &'static str {
    match value {
        Value::Null => "null",
        Value::Bool(_) => "a boolean",
        Value::Number(_) => "a number",
        Value::String(_) => "a string",
        Value::Array(_) => "an array",
        Value::Object(_) => "an object",
    }
}

fn shown(value: &Value, most: usize) -> String {
    let text = value.to_string();
    let more = if text.chars().count() > most { "…" } else { "" };
    format!("`{}{more}`", text.chars().take(most).collect::<String>())
}

fn listed(names: &[String]) -> String {
    let more = if names.len() > NAMED { ", …" } else { "" };
    format!("{}{more}", names.iter().take(NAMED).map(String::as_str).collect::<Vec<_>>().join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schema::derived;
    use serde_json::json;
    use socrates_model::Rule;

    fn told(schema: &Value, answer: &Value) -> Vec<String> {
        misfits(schema, answer, 20).into_iter().map(|misfit| format!("{}: {}", misfit.at, misfit.message)).collect()
    }

    fn schema() -> Value {
        let when = json!({"anyOf": [
            {"type": "object", "properties": {"near_m": {"type": "number", "minimum": 0.3}}, "required": ["near_m"], "additionalProperties": false},
            {"type": "object", "properties": {"says": {"enum": ["WAIT", "PROCEED"]}}, "required": ["says"], "additionalProperties": false},
        ]});
        let human = json!({"type": "object", "properties": {
            "name": {"type": "string", "maxLength": 5}, "age": {"type": ["integer", "null"], "maximum": 120},
            "when": {"type": "array", "items": {"$ref": "#/$defs/when"}, "minItems": 1},
        }, "required": ["name", "age", "when"], "additionalProperties": false});
        json!({"type": "object", "properties": {"humans": {"type": "object", "additionalProperties": human}},
            "required": ["humans"], "additionalProperties": false, "$defs": {"when": when}})
    }

    #[test]
    fn an_answer_that_keeps_to_its_schema_has_no_misfit() {
        let when = json!([{"near_m": 1}, {"says": "WAIT"}]);
        let answer = json!({"humans": {"human_1": {"name": "Ann", "age": null, "when": when}}});
        assert!(misfits(&schema(), &answer, 20).is_empty(), "{:?}", told(&schema(), &answer));
    }

    #[test]
    fn every_misfit_says_where_it_is_and_what_is_allowed() {
        let when = json!([{"near_m": 0.1}, {"says": "STOP"}, {"near_m": 1, "far": 2}]);
        let answer = json!({"humans": {"human_1": {"name": "Bernadette", "age": 1.5, "when": when},
            "human_2": {"name": 3, "age": 130, "when": [], "more": 1}}, "extra": null});
        let told = told(&schema(), &answer);
        for wanted in [
            ": `extra` is no member here; members: humans",
            "humans.human_1.name: it has 10 characters; at most 5",
            "humans.human_1.age: `1.5` is a number; allowed: integer or null",
            "humans.human_1.when[1].near_m: 0.1 is out of range: at least 0.3",
            "humans.human_1.when[2].says: `\"STOP\"` is not allowed; allowed: \"WAIT\", \"PROCEED\"",
            "humans.human_1.when[3]: `far` is no member here; members: near_m",
            "humans.human_2: `more` is no member here; members: age, name, when",
            "humans.human_2.name: `3` is a number; allowed: string",
            "humans.human_2.age: 130 is out of range: at most 120",
            "humans.human_2.when: it has 0 items; at least 1",
        ] {
            assert!(told.iter().any(|line| line == wanted), "{wanted}\n{told:#?}");
        }
        assert_eq!(told.len(), 10, "{told:#?}");
        assert_eq!(misfits(&schema(), &answer, 3).len(), 3);
    }

    #[test]
    fn a_choice_is_told_by_the_member_that_it_fixes() {
        let act = |kind: &str, member: &str| {
            json!({"type": "object", "properties": {"kind": {"const": kind}, member: {"type": "number"}},
            "required": ["kind", member]})
        };
        let schema = json!({"anyOf": [act("walk", "m"), act("wait", "s")]});
        assert_eq!(
            told(&schema, &json!({"kind": "wait", "s": "long"})),
            ["s: `\"long\"` is a string; allowed: number"]
        );
        assert_eq!(
            told(&schema, &json!({"kind": "fly"})),
            ["kind: `\"fly\"` is not allowed; allowed: \"walk\", \"wait\""]
        );
        let pair = json!({"type": "array", "prefixItems": [{"type": "string"}, {"type": "number"}]});
        assert_eq!(told(&pair, &json!(["a", "b"])), ["[2]: `\"b\"` is a string; allowed: number"]);
        // Chains of neighbors, as of a way through a graph: only the choice that is meant is followed.
        let next = |at: &str| {
            json!({"type": "object", "properties": {"at": {"const": at}, "next": {"anyOf": [{"$ref": "#/$defs/a"},
            {"$ref": "#/$defs/b"}, {"type": "null"}]}}, "required": ["at", "next"]})
        };
        let chain = json!({"$ref": "#/$defs/a", "$defs": {"a": next("a"), "b": next("b")}});
        let way = (0..80)
            .fold(Value::Null, |rest, index| json!({"at": if index % 2 == 0 { "b" } else { "a" }, "next": rest}));
        assert!(told(&chain, &way).is_empty(), "{:?}", told(&chain, &way));
    }

    #[test]
    fn a_schema_that_refers_to_itself_ends() {
        let schema = json!({"$ref": "#/$defs/a", "$defs": {"a": {"anyOf": [{"$ref": "#/$defs/a"}, {"type": "null"}]}}});
        assert!(misfits(&schema, &Value::Null, 5).is_empty());
        assert!(told(&json!({"$ref": "#/$defs/none"}), &json!(1))[0].contains("which it lacks"));
        assert!(told(&json!({"const": "a", "multipleOf": 2}), &json!(3)).len() == 2);
    }

    fn wrong(value: &Value) -> Vec<(String, String)> {
        differences("$", &derived::<Rule>(), value).into_iter().map(|d| (d.at, d.message)).collect()
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
