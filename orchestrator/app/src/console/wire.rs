//! Chat Completions as a server reads them: a request as a question, and what is wrong with one that is none.

use serde_json::{Value, json};

use super::desk::{Asked, Turn};

/// Turns of a prompt, at most.
const TURNS: usize = 400;
/// Characters of a name, at most.
const NAME: usize = 200;

/// What is wrong with a request: which member of it, and what is allowed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{param}`: {message}")]
pub(super) struct BadRequest {
    /// The member.
    pub(super) param: String,
    /// What was found and what is allowed.
    pub(super) message: String,
}

fn bad(param: &str, message: impl Into<String>) -> BadRequest {
    BadRequest { param: param.to_owned(), message: message.into() }
}

/// How the answer is to come.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Wish {
    /// In parts.
    pub(super) stream: bool,
    /// With a count of tokens behind the parts.
    pub(super) usage: bool,
}

/// Reads a request.
///
/// # Errors
/// [`BadRequest`] for the first thing that cannot be read or cannot be done.
pub(super) fn read(bytes: &[u8]) -> Result<(Asked, Wish), BadRequest> {
    let body: Value = serde_json::from_slice(bytes).map_err(|why| bad("body", format!("it is no JSON: {why}")))?;
    if !body.is_object() {
        return Err(bad("body", "it is no JSON object"));
    }
    let model = body.get("model").and_then(Value::as_str).ok_or_else(|| bad("model", "a name is missing"))?;
    if model.chars().count() > NAME {
        return Err(bad("model", format!("it has more than {NAME} characters")));
    }
    if body.get("n").and_then(Value::as_u64).is_some_and(|count| count > 1) {
        return Err(bad("n", "a person gives one answer; allowed: 1"));
    }
    let has_tools = body.get("tools").and_then(Value::as_array).is_some_and(|tools| !tools.is_empty());
    if has_tools {
        return Err(bad("tools", "a person calls no tools; ask for a form with `response_format`"));
    }
    let (form, schema) = form(body.get("response_format"))?;
    let truth = |pointer: &str| body.pointer(pointer).and_then(Value::as_bool) == Some(true);
    let count = |key: &str| body.get(key).and_then(Value::as_u64);
    let max_tokens = count("max_completion_tokens").or_else(|| count("max_tokens"));
    let asked = Asked { model: model.to_owned(), form, schema, turns: turns(body.get("messages"))?, max_tokens };
    Ok((asked, Wish { stream: truth("/stream"), usage: truth("/stream_options/include_usage") }))
}

/// Name and schema of the form of the answer.
fn form(format: Option<&Value>) -> Result<(String, Option<Value>), BadRequest> {
    let Some(format) = format.filter(|format| !format.is_null()) else { return Ok(("text".to_owned(), None)) };
    match format.get("type").and_then(Value::as_str) {
        Some("text") => Ok(("text".to_owned(), None)),
        Some("json_object") => Ok(("JSON object".to_owned(), Some(json!({"type": "object"})))),
        Some("json_schema") => {
            let own = format.get("json_schema").and_then(Value::as_object);
            let own = own.ok_or_else(|| bad("response_format.json_schema", "it is missing"))?;
            let name = own.get("name").and_then(Value::as_str).unwrap_or("answer");
            if name.chars().count() > NAME {
                return Err(bad("response_format.json_schema.name", format!("it has more than {NAME} characters")));
            }
            let schema = own.get("schema").filter(|schema| schema.is_object()).cloned();
            Ok((name.to_owned(), Some(schema.unwrap_or_else(|| json!({"type": "object"})))))
        }
        Some(other) => {
            Err(bad("response_format.type", format!("`{other}` is unknown; allowed: text, json_object, json_schema")))
        }
        None => Err(bad("response_format.type", "it is missing; allowed: text, json_object, json_schema")),
    }
}

fn turns(messages: Option<&Value>) -> Result<Vec<Turn>, BadRequest> {
    let messages = messages.and_then(Value::as_array).ok_or_else(|| bad("messages", "a list is missing"))?;
    if messages.is_empty() || messages.len() > TURNS {
        return Err(bad("messages", format!("it has {} messages; allowed: 1 to {TURNS}", messages.len())));
    }
    messages.iter().enumerate().map(|(index, message)| turn(index, message)).collect()
}

fn turn(index: usize, message: &Value) -> Result<Turn, BadRequest> {
    let at = |rest: &str| format!("messages[{index}]{rest}");
    let role = message.get("role").and_then(Value::as_str).ok_or_else(|| bad(&at(".role"), "it is missing"))?;
    const ROLES: [&str; 5] = ["system", "developer", "user", "assistant", "tool"];
    if !ROLES.contains(&role) {
        return Err(bad(&at(".role"), format!("`{}` is unknown; allowed: {}", cut(role), ROLES.join(", "))));
    }
    let mut turn = Turn { role: role.to_owned(), text: String::new(), pictures: Vec::new() };
    match message.get("content") {
        Some(Value::String(text)) => turn.text.clone_from(text),
        Some(Value::Array(parts)) => {
            for (number, part) in parts.iter().enumerate() {
                take(&mut turn, part, &at(&format!(".content[{number}]")))?;
            }
        }
        Some(Value::Null) | None => {}
        Some(_) => return Err(bad(&at(".content"), "it is neither a text nor a list of parts")),
    }
    Ok(turn)
}

/// Takes over one part of a message.
fn take(turn: &mut Turn, part: &Value, at: &str) -> Result<(), BadRequest> {
    match part.get("type").and_then(Value::as_str) {
        Some("text") => {
            let text = part.get("text").and_then(Value::as_str).ok_or_else(|| bad(at, "a text is missing"))?;
            if !turn.text.is_empty() {
                turn.text.push_str("\n\n");
            }
            turn.text.push_str(text);
            Ok(())
        }
        Some("image_url") => {
            let url = part.pointer("/image_url/url").and_then(Value::as_str);
            let url = url.ok_or_else(|| bad(at, "`image_url.url` is missing"))?;
            // A page of ours loads nothing from elsewhere.
            const KINDS: [&str; 4] = ["data:image/png;", "data:image/jpeg;", "data:image/webp;", "data:image/gif;"];
            if !KINDS.iter().any(|kind| url.starts_with(kind)) {
                let message =
                    format!("pictures come inside the request, as `data:image/png;base64,…`; found `{}`", cut(url));
                return Err(bad(&format!("{at}.image_url.url"), message));
            }
            turn.pictures.push(url.to_owned());
            Ok(())
        }
        Some(other) => Err(bad(at, format!("a part `{}` cannot be shown; allowed: text, image_url", cut(other)))),
        None => Err(bad(at, "its `type` is missing; allowed: text, image_url")),
    }
}

/// The beginning of what somebody else wrote, for a message.
fn cut(text: &str) -> String {
    text.chars().filter(|c| !c.is_control()).take(40).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(body: &Value) -> String {
        read(body.to_string().as_bytes()).unwrap_err().to_string()
    }

    #[test]
    fn a_request_becomes_a_question_with_its_form_and_its_pictures() {
        let png = "data:image/png;base64,AQID";
        let body = json!({"model": "anna", "stream": true, "stream_options": {"include_usage": true}, "max_tokens": 90,
            "messages": [{"role": "system", "content": "Be brief."},
                {"role": "user", "content": [{"type": "text", "text": "a"}, {"type": "image_url", "image_url": {"url": png}},
                    {"type": "text", "text": "b"}]}],
            "response_format": {"type": "json_schema", "json_schema": {"name": "paths", "schema": {"type": "object"}}}});
        let (asked, wish) = read(body.to_string().as_bytes()).unwrap();
        assert_eq!(
            (asked.form.as_str(), asked.schema, asked.max_tokens),
            ("paths", Some(json!({"type": "object"})), Some(90))
        );
        assert_eq!(
            (asked.turns[1].text.as_str(), asked.turns[1].pictures.as_slice()),
            ("a\n\nb", [png.to_owned()].as_slice())
        );
        assert_eq!(wish, Wish { stream: true, usage: true });
        let plain = json!({"model": "m", "messages": [{"role": "user", "content": "a"}]});
        let (asked, wish) = read(plain.to_string().as_bytes()).unwrap();
        assert!(asked.schema.is_none() && asked.form == "text" && !wish.stream);
    }

    #[test]
    fn what_is_no_question_is_told_where_and_what_is_allowed() {
        assert!(read(b"{").unwrap_err().to_string().contains("`body`: it is no JSON"));
        assert!(read(b"[]").unwrap_err().to_string().contains("no JSON object"));
        let with = |key: &str, value: Value| {
            let mut body = json!({"model": "m", "messages": [{"role": "user", "content": "a"}]});
            body[key] = value;
            told(&body)
        };
        for (key, value, wanted) in [
            ("model", json!(3), "`model`: a name is missing"),
            ("model", json!("x".repeat(300)), "more than 200"),
            ("n", json!(2), "`n`: a person gives one answer"),
            ("tools", json!([{}]), "calls no tools"),
            ("messages", json!([]), "0 messages; allowed: 1 to 400"),
            ("messages", json!([{"role": "robot", "content": "a"}]), "`messages[0].role`: `robot` is unknown"),
            ("messages", json!([{"role": "user", "content": 3}]), "neither a text nor a list"),
            ("messages", json!([{"role": "user", "content": [{"type": "input_audio"}]}]), "`messages[0].content[0]`"),
            (
                "messages",
                json!([{"role": "user", "content": [{"type": "image_url", "image_url": {"url": "https://x.example/a.png"}}]}]),
                "pictures come inside the request",
            ),
            ("response_format", json!({"type": "xml"}), "`xml` is unknown; allowed: text, json_object, json_schema"),
            ("response_format", json!({"type": "json_schema"}), "`response_format.json_schema`: it is missing"),
        ] {
            let told = with(key, value);
            assert!(told.contains(wanted), "{wanted}: {told}");
        }
    }
}
