//! Whether an answer keeps to a schema, and where it does not: for people who write one by hand.
//!
//! The keywords of the schemas that are asked for: types, enumerations, members, items, bounds, choices and local references.
//! `pattern`, `format` and keywords that are not known are not looked at.

use std::cell::Cell;

use serde_json::Value;

/// Looks at a value in all: a schema of strangers may send a check round and round.
const LOOKS: u32 = 200_000;
/// How deep references may lead into one another: a schema that refers to itself ends with the answer, not by itself.
const DEEPEST: usize = 600;
/// Characters of a value that a message shows.
const SHOWN: usize = 40;
/// Values of an enumeration that a message names.
const NAMED: usize = 12;

/// One place at which an answer does not keep to its schema.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct Misfit {
    /// Where, such as `humans.human_1.rules[2].when`; empty for the whole answer.
    pub at: String,
    /// What was found and what is allowed.
    pub message: String,
}

/// Where an answer does not keep to a schema, in order of the answer; at most `most` of them.
#[must_use]
pub fn misfits(schema: &Value, answer: &Value, most: usize) -> Vec<Misfit> {
    let mut found = Vec::new();
    Check { root: schema, most, left: Cell::new(LOOKS) }.value(schema, answer, &Place::default(), &mut found);
    found.truncate(most);
    found
}

/// Where the check is, in the answer.
#[derive(Debug, Clone, Default)]
struct Place {
    path: String,
    depth: usize,
}

impl Place {
    fn member(&self, name: &str) -> Self {
        let dot = if self.path.is_empty() { "" } else { "." };
        Self { path: format!("{}{dot}{name}", self.path), depth: self.depth + 1 }
    }

    fn item(&self, index: usize) -> Self {
        Self { path: format!("{}[{}]", self.path, index + 1), depth: self.depth + 1 }
    }

    /// The same place, one reference or choice further.
    fn deeper(&self) -> Self {
        Self { path: self.path.clone(), depth: self.depth + 1 }
    }
}

struct Check<'a> {
    root: &'a Value,
    most: usize,
    left: Cell<u32>,
}

impl<'a> Check<'a> {
    fn value(&self, schema: &'a Value, value: &Value, place: &Place, found: &mut Vec<Misfit>) {
        if found.len() >= self.most || place.depth > DEEPEST || self.left.get() == 0 {
            return;
        }
        self.left.set(self.left.get() - 1);
        if let Some(target) = schema.get("$ref").and_then(Value::as_str) {
            match self.target(target) {
                Some(inner) => self.value(inner, value, &place.deeper(), found),
                None => say(found, place, format!("the schema refers to `{target}`, which it lacks")),
            }
        }
        if !self.of_type(schema, value, place, found) {
            return;
        }
        constants(schema, value, place, found);
        self.choices(schema, value, place, found);
        match value {
            Value::Object(_) => self.members(schema, value, place, found),
            Value::Array(items) => self.items(schema, items, place, found),
            Value::String(text) => length(schema, text, place, found),
            Value::Number(_) => bounds(schema, value, place, found),
            Value::Null | Value::Bool(_) => {}
        }
    }

    fn target(&self, reference: &str) -> Option<&'a Value> {
        self.root.pointer(reference.strip_prefix('#')?)
    }

    /// Members that a choice fixes to one value: by these one sees which choice a value was meant to be.
    fn marks(&self, choice: &'a Value) -> Vec<(&'a str, &'a Value)> {
        let choice = choice.get("$ref").and_then(Value::as_str).and_then(|name| self.target(name)).unwrap_or(choice);
        let members = choice.get("properties").and_then(Value::as_object).into_iter().flatten();
        let fixed = |schema: &'a Value| match schema.get("enum").and_then(Value::as_array).map(Vec::as_slice) {
            Some([one]) => Some(one),
            _ => schema.get("const"),
        };
        members.filter_map(|(name, schema)| Some((name.as_str(), fixed(schema)?))).collect()
    }

    /// Whether the value is of an allowed type; where it is not, nothing else about it helps.
    fn of_type(&self, schema: &Value, value: &Value, place: &Place, found: &mut Vec<Misfit>) -> bool {
        let allowed: Vec<&str> = match schema.get("type") {
            Some(Value::String(one)) => vec![one],
            Some(Value::Array(several)) => several.iter().filter_map(Value::as_str).collect(),
            Some(_) | None => return true,
        };
        let fits = allowed.iter().any(|kind| is_of(kind, value));
        if !fits {
            say(found, place, format!("{} is {}; allowed: {}", shown(value), kind_of(value), allowed.join(" or ")));
        }
        fits
    }

    fn members(&self, schema: &'a Value, value: &Value, place: &Place, found: &mut Vec<Misfit>) {
        let Some(members) = value.as_object() else { return };
        let known = schema.get("properties").and_then(Value::as_object);
        for name in schema.get("required").and_then(Value::as_array).into_iter().flatten().filter_map(Value::as_str) {
            if !members.contains_key(name) {
                say(found, place, format!("`{name}` is missing"));
            }
        }
        for (name, inner) in members {
            match (known.and_then(|known| known.get(name)), schema.get("additionalProperties")) {
                (Some(own), _) => self.value(own, inner, &place.member(name), found),
                (None, Some(Value::Bool(false))) => {
                    let names: Vec<&str> = known.into_iter().flatten().map(|(name, _)| name.as_str()).collect();
                    say(found, place, format!("`{name}` is no member here; members: {}", listed(&names)));
                }
                (None, Some(own @ Value::Object(_))) => self.value(own, inner, &place.member(name), found),
                (None, _) => {}
            }
        }
    }

    fn items(&self, schema: &'a Value, items: &[Value], place: &Place, found: &mut Vec<Misfit>) {
        let count = u64::try_from(items.len()).unwrap_or(u64::MAX);
        let bound = |key: &str| schema.get(key).and_then(Value::as_u64);
        if let Some(least) = bound("minItems").filter(|least| count < *least) {
            say(found, place, format!("it has {count} items; at least {least}"));
        }
        if let Some(most) = bound("maxItems").filter(|most| count > *most) {
            say(found, place, format!("it has {count} items; at most {most}"));
        }
        let first: Vec<&Value> = schema.get("prefixItems").and_then(Value::as_array).into_iter().flatten().collect();
        let others = schema.get("items").filter(|inner| inner.is_object());
        for (index, item) in items.iter().enumerate() {
            if let Some(inner) = first.get(index).copied().or(others) {
                self.value(inner, item, &place.item(index), found);
            }
        }
    }

    /// `allOf`: every one; `anyOf` and `oneOf`: where none fits, what keeps the nearest from it.
    fn choices(&self, schema: &'a Value, value: &Value, place: &Place, found: &mut Vec<Misfit>) {
        let list = |key: &str| schema.get(key).and_then(Value::as_array).into_iter().flatten();
        for inner in list("allOf") {
            self.value(inner, value, &place.deeper(), found);
        }
        for key in ["anyOf", "oneOf"] {
            let choices: Vec<&Value> = list(key).collect();
            let differs = |(name, fixed): &(&str, &Value)| value.get(*name).is_some_and(|own| own != *fixed);
            let meant: Vec<&Value> =
                choices.iter().copied().filter(|choice| !self.marks(choice).iter().any(differs)).collect();
            if let (true, Some(first)) = (meant.is_empty(), choices.first()) {
                let name = self.marks(first).into_iter().find(differs).map_or("", |(name, _)| name);
                let allowed = choices.iter().flat_map(|choice| self.marks(choice)).filter(|(own, _)| *own == name);
                let allowed: Vec<String> = allowed.map(|(_, fixed)| fixed.to_string()).collect();
                let allowed: Vec<&str> = allowed.iter().map(String::as_str).collect();
                let own = value.get(name).map_or_else(String::new, shown);
                say(found, &place.member(name), format!("{own} is not allowed; allowed: {}", listed(&allowed)));
                continue;
            }
            let mut nearest: Option<(bool, Vec<Misfit>)> = None;
            for choice in meant {
                let mut own = Vec::new();
                self.value(choice, value, &place.deeper(), &mut own);
                // A choice of another type or with other members says less of the value than one with a wrong value inside.
                let other = own.iter().any(|misfit| misfit.at == place.path);
                if nearest.as_ref().is_none_or(|(best, misfits)| (other, own.len()) < (*best, misfits.len())) {
                    nearest = Some((other, own));
                }
            }
            found.extend(nearest.into_iter().flat_map(|(_, misfits)| misfits));
        }
    }
}

fn say(found: &mut Vec<Misfit>, place: &Place, message: String) {
    found.push(Misfit { at: place.path.clone(), message });
}

fn is_of(kind: &str, value: &Value) -> bool {
    match kind {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "null" => value.is_null(),
        "number" => value.is_number(),
        // 3.0 is a whole number to whoever reads it.
        "integer" => value.as_f64().is_some_and(|number| number.fract() == 0.0),
        _ => true,
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

fn shown(value: &Value) -> String {
    let text = value.to_string();
    if text.chars().count() <= SHOWN {
        return format!("`{text}`");
    }
    format!("`{}…`", text.chars().take(SHOWN).collect::<String>())
}

fn listed(names: &[&str]) -> String {
    let more = if names.len() > NAMED { ", …" } else { "" };
    format!("{}{more}", names.iter().take(NAMED).copied().collect::<Vec<_>>().join(", "))
}

fn constants(schema: &Value, value: &Value, place: &Place, found: &mut Vec<Misfit>) {
    if let Some(constant) = schema.get("const").filter(|constant| *constant != value) {
        say(found, place, format!("{} is not `{constant}`", shown(value)));
    }
    if let Some(allowed) = schema.get("enum").and_then(Value::as_array).filter(|allowed| !allowed.contains(value)) {
        let names: Vec<String> = allowed.iter().map(Value::to_string).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        say(found, place, format!("{} is not allowed; allowed: {}", shown(value), listed(&names)));
    }
}

fn length(schema: &Value, text: &str, place: &Place, found: &mut Vec<Misfit>) {
    let count = u64::try_from(text.chars().count()).unwrap_or(u64::MAX);
    let bound = |key: &str| schema.get(key).and_then(Value::as_u64);
    if let Some(least) = bound("minLength").filter(|least| count < *least) {
        say(found, place, format!("it has {count} characters; at least {least}"));
    }
    if let Some(most) = bound("maxLength").filter(|most| count > *most) {
        say(found, place, format!("it has {count} characters; at most {most}"));
    }
}

fn bounds(schema: &Value, value: &Value, place: &Place, found: &mut Vec<Misfit>) {
    let Some(number) = value.as_f64() else { return };
    let bound = |key: &str| schema.get(key).and_then(Value::as_f64);
    let broken = [
        ("at least", bound("minimum").filter(|least| number < *least)),
        ("at most", bound("maximum").filter(|most| number > *most)),
        ("more than", bound("exclusiveMinimum").filter(|least| number <= *least)),
        ("less than", bound("exclusiveMaximum").filter(|most| number >= *most)),
    ];
    for (words, bound) in broken.into_iter().filter_map(|(words, bound)| Some((words, bound?))) {
        say(found, place, format!("{number} is out of range: {words} {bound}"));
    }
    if let Some(step) = bound("multipleOf").filter(|step| *step > 0.0) {
        let steps = number / step;
        if (steps - steps.round()).abs() > 1e-9 {
            say(found, place, format!("{number} is no multiple of {step}"));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

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
}
