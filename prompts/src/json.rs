//! From text to JSON: E-EMPTY, E-TRUNC, E-JSON, E-EXTRA, T-OVERSIZE.

use std::fmt;

use serde::de::{Error as _, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
use serde_json::error::Category;
use serde_json::{Map, Value};
use socrates_model::{Fault, FaultCode};

/// Longest answer that is read, bytes.
pub const MAX_ANSWER_BYTES: usize = 2 * 1024 * 1024;
/// Characters shown around the place of an error, in all.
const AROUND: usize = 40;

/// The JSON object of an answer, without what stands around it.
///
/// # Errors
/// One fault: empty, too large, cut off, or not JSON; the latter two with line, column and the characters around. An author
/// that says in an object of one text that it cannot answer gives E-CANNOT with that text.
pub fn object(text: &str) -> Result<Value, Vec<Fault>> {
    let fault = |code, message: String| Err(vec![Fault::new(code, "answer", message)]);
    if text.len() > MAX_ANSWER_BYTES {
        return fault(FaultCode::TOversize, format!("has {} bytes; at most {MAX_ANSWER_BYTES} are read", text.len()));
    }
    if text.trim().is_empty() {
        return fault(FaultCode::EEmpty, "is empty; answer with one JSON object".to_owned());
    }
    let Some(core) = core(text) else {
        let start: String = text.trim().chars().take(AROUND).collect();
        return fault(FaultCode::EJson, format!("has no JSON object; it starts with `{start}`"));
    };
    match serde_json::from_str::<Once>(core).map(|Once(value)| value) {
        Ok(Value::Object(members)) => match cannot(&members) {
            Some(why) => fault(FaultCode::ECannot, why),
            None => Ok(Value::Object(members)),
        },
        Ok(other) => fault(FaultCode::EJson, format!("is {}, not a JSON object", kind(&other))),
        Err(error) if error.classify() == Category::Eof => fault(
            FaultCode::ETrunc,
            format!("ends too early, after `{}`; answer again, and shorter", around(core, usize::MAX, usize::MAX)),
        ),
        Err(error) => {
            let near = around(core, error.line(), error.column());
            fault(FaultCode::EJson, format!("{error}; near `{near}`"))
        }
    }
}

/// Members under which an author says in a sentence why it cannot answer, instead of an answer.
const SAYS_WHY: [&str; 5] = ["cannot", "error", "message", "note", "reason"];
/// Longest reason that is kept, characters.
const MAX_REASON: usize = 500;

/// The reason of an author that answers with nothing but one.
fn cannot(members: &Map<String, Value>) -> Option<String> {
    let mut answer = members.iter().filter(|(name, _)| !matches!(name.as_str(), "analysis" | "author" | "format"));
    let (Some((name, Value::String(why))), None) = (answer.next(), answer.next()) else { return None };
    let line = why.split_whitespace().collect::<Vec<_>>().join(" ");
    (SAYS_WHY.contains(&name.as_str()) && !line.is_empty()).then(|| line.chars().take(MAX_REASON).collect())
}

/// What was repaired to read the answer: text around the JSON object is dropped and named here (E-EXTRA, a warning).
#[must_use]
pub fn repairs(text: &str) -> Vec<Fault> {
    let Some(core) = core(text) else { return Vec::new() };
    let extra = text.trim().len().saturating_sub(core.trim().len());
    if extra == 0 {
        return Vec::new();
    }
    let message = format!("has {extra} bytes around the JSON object; they were dropped. Answer with the object alone");
    vec![Fault::new(FaultCode::EExtra, "answer", message)]
}

/// A JSON value in which no object names a member twice: which of the two is meant nobody can say.
struct Once(Value);

impl<'de> Deserialize<'de> for Once {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(OnceVisitor).map(Self)
    }
}

struct OnceVisitor;

impl<'de> Visitor<'de> for OnceVisitor {
    type Value = Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a JSON value")
    }

    fn visit_bool<E>(self, value: bool) -> Result<Value, E> {
        Ok(Value::Bool(value))
    }

    fn visit_i64<E>(self, value: i64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_u64<E>(self, value: u64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_f64<E>(self, value: f64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_str<E>(self, value: &str) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_unit<E>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Value, A::Error> {
        let mut list = Vec::new();
        while let Some(Once(item)) = items.next_element()? {
            list.push(item);
        }
        Ok(Value::Array(list))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut members: A) -> Result<Value, A::Error> {
        let mut object = Map::new();
        while let Some((name, Once(value))) = members.next_entry::<String, Once>()? {
            if object.contains_key(&name) {
                return Err(A::Error::custom(format!("the member `{name}` is there twice; write it once")));
            }
            object.insert(name, value);
        }
        Ok(Value::Object(object))
    }
}

/// From the first brace to the one that closes it; to the end where none does.
#[must_use]
pub fn core(text: &str) -> Option<&str> {
    let start = text.find('{')?;
    let (mut depth, mut in_string, mut escaped) = (0_u32, false, false);
    for (at, letter) in text.char_indices().skip_while(|(at, _)| *at < start) {
        if in_string {
            match letter {
                _ if escaped => escaped = false,
                '\\' => escaped = true,
                '"' => in_string = false,
                _ => {}
            }
            continue;
        }
        match letter {
            '"' => in_string = true,
            '{' => depth += 1,
            '}' => {
                depth = depth.saturating_sub(1);
                if depth == 0 {
                    return text.get(start..=at);
                }
            }
            _ => {}
        }
    }
    text.get(start..)
}

/// The characters around a position; around the end for positions past it.
fn around(text: &str, line: usize, column: usize) -> String {
    let before_line: usize = text.split_inclusive('\n').take(line.saturating_sub(1)).map(str::len).sum();
    let at = before_line.saturating_add(column).min(text.len());
    let before: Vec<char> = text.char_indices().filter(|(index, _)| *index < at).map(|(_, c)| c).collect();
    let after = text.char_indices().filter(|(index, _)| *index >= at).map(|(_, c)| c).take(AROUND / 2);
    let wanted = if at >= text.len() { AROUND } else { AROUND / 2 };
    let from = before.len().saturating_sub(wanted);
    before.into_iter().skip(from).chain(after).map(|c| if c == '\n' { ' ' } else { c }).collect()
}

const fn kind(value: &Value) -> &'static str {
    match value {
        Value::Null => "null",
        Value::Bool(_) => "a truth value",
        Value::Number(_) => "a number",
        Value::String(_) => "a text",
        Value::Array(_) => "a list",
        Value::Object(_) => "an object",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn code(text: &str) -> FaultCode {
        object(text).unwrap_err()[0].code
    }

    #[test]
    fn each_way_of_being_no_json_has_its_code() {
        assert_eq!(code("  \n"), FaultCode::EEmpty);
        assert_eq!(code("I am sorry."), FaultCode::EJson);
        assert_eq!(code("{\"a\": [1, 2"), FaultCode::ETrunc);
        assert_eq!(code("{\"a\": 'x'}"), FaultCode::EJson);
        assert_eq!(code(&format!("{{\"a\": \"{}\"}}", "x".repeat(MAX_ANSWER_BYTES))), FaultCode::TOversize);
    }

    #[test]
    fn what_only_looks_like_json_is_refused() {
        let deep = format!("{{\"a\": {}{}}}", "[".repeat(10_000), "]".repeat(10_000));
        assert_eq!(code(&deep), FaultCode::EJson);
        assert_eq!(code("{\"a\": NaN}"), FaultCode::EJson);
        assert_eq!(code("{\"a\": 1e999}"), FaultCode::EJson);
        let twice = &object("{\"a\": {\"b\": 1, \"b\": 2}}").unwrap_err()[0];
        assert!(twice.code == FaultCode::EJson && twice.message.to_string().contains("`b` is there twice"), "{twice}");
        // Another language is another text, not another form.
        assert_eq!(object("{\"a\": \"Ein Mensch kommt näher\"}").unwrap()["a"], "Ein Mensch kommt näher");
        assert_eq!(code("Es tut mir leid, das kann ich nicht."), FaultCode::EJson);
    }

    #[test]
    fn the_place_of_the_error_is_shown() {
        let fault = &object("{\"robot\": [\"a\", \"b\"],\n \"humans\": {human_1: []}}").unwrap_err()[0];
        assert!(
            fault.message.to_string().contains("line 2 column 13")
                && fault.message.to_string().contains("\"humans\": {human_1"),
            "{}",
            fault.message
        );
    }

    #[test]
    fn a_fence_is_stripped_and_named() {
        let text = "Here it is:\n```json\n{\"a\": \"} not the end\"}\n```\n";
        assert_eq!(object(text).unwrap()["a"], "} not the end");
        assert_eq!(repairs(text)[0].code, FaultCode::EExtra);
        assert!(repairs("{\"a\": 1}\n").is_empty());
    }
}
