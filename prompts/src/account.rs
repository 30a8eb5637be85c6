//! The account: what an author says becomes of each sentence of a request, as the first part of its proposal.
//!
//! ```text
//! "reading": {"s1": [{"fact": "f1", "quote": "a nurse waves", "of": "human_1"}],      asked for
//!             "s2": "setting",                                                         background
//!             "s3": {"cannot_be_played": "people have no hands"}}                      no part of any run
//! ```

use std::collections::BTreeMap;

use serde_json::Value;
use socrates_model::statement::Background;
use socrates_model::{AgentId, Fault, FaultCode, Where};

/// Member of an answer that holds the account.
pub(crate) const MEMBER: &str = "reading";
/// Word for what is of nobody in particular.
pub(crate) const ALL: &str = "all";
/// Member of a sentence that cannot be played.
pub(crate) const CANNOT: &str = "cannot_be_played";
/// Longest reason that is kept, characters.
const MOST_REASON: usize = 300;

/// What becomes of each sentence, by its number.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Account(pub BTreeMap<String, Share>);

/// What becomes of one sentence.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Share {
    /// It asks for this.
    Asked(Vec<Claim>),
    /// It asks for nothing that could be seen.
    Background(Background),
    /// It asks for something that no run can show.
    CannotBePlayed(String),
}

/// One thing that a sentence asks for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Claim {
    /// Id of the fact, which clauses name as their source.
    pub fact: String,
    /// Words of the sentence.
    pub quote: String,
    /// Who does it; nobody for what holds of the whole scene.
    pub of: Option<AgentId>,
}

/// Reads the account of an answer.
///
/// # Errors
/// E-SCHEMA for each part that has not the asked form, with its path; one for an answer without any.
pub fn parse_account(text: &str) -> Result<Account, Vec<Fault>> {
    let answer = crate::json::object(text)?;
    let Some(Value::Object(shares)) = answer.get(MEMBER) else {
        return Err(vec![wrong("", "expected an object with one member for each sentence, found none")]);
    };
    let mut account = Account::default();
    let mut faults = Vec::new();
    for (id, value) in shares {
        match share(id, value) {
            Ok(share) => drop(account.0.insert(id.clone(), share)),
            Err(fault) => faults.push(fault),
        }
    }
    if faults.is_empty() { Ok(account) } else { Err(faults) }
}

fn wrong(path: &str, message: impl Into<String>) -> Fault {
    Fault::new(FaultCode::ESchema, Where::key(format_args!("$.{MEMBER}{path}")), message.into())
}

fn share(id: &str, value: &Value) -> Result<Share, Fault> {
    match value {
        Value::String(word) => background(word).map(Share::Background).ok_or_else(|| {
            wrong(&format!(".{id}"), format!("`{word}` is no reason; allowed: {}", reasons().join(", ")))
        }),
        Value::Object(members) => match members.get(CANNOT).and_then(Value::as_str) {
            Some(why) if !why.trim().is_empty() && members.len() == 1 => {
                Ok(Share::CannotBePlayed(why.trim().chars().take(MOST_REASON).collect()))
            }
            Some(_) | None => Err(wrong(&format!(".{id}"), format!("expected `{CANNOT}` alone, with a reason"))),
        },
        Value::Array(items) if !items.is_empty() => {
            let claims: Result<Vec<Claim>, Fault> =
                items.iter().enumerate().map(|(place, item)| claim(&format!(".{id}[{place}]"), item)).collect();
            claims.map(Share::Asked)
        }
        Value::Array(_) | Value::Null | Value::Bool(_) | Value::Number(_) => Err(wrong(
            &format!(".{id}"),
            format!("expected a list of facts, a reason such as `setting`, or {{\"{CANNOT}\": why}}"),
        )),
    }
}

fn claim(path: &str, item: &Value) -> Result<Claim, Fault> {
    let text = |name: &str| {
        let found = item.get(name).and_then(Value::as_str).map(str::trim).filter(|text| !text.is_empty());
        found.map(str::to_owned).ok_or_else(|| wrong(path, format!("has no `{name}`; expected fact, quote and of")))
    };
    let of = text("of")?;
    let of = if of == ALL {
        None
    } else {
        let who = of.parse().map_err(|_no_agent| {
            wrong(path, format!("`of` is `{of}`; allowed: robot, {ALL}, or a human such as human_1"))
        });
        Some(who?)
    };
    Ok(Claim { fact: text("fact")?, quote: text("quote")?, of })
}

fn background(word: &str) -> Option<Background> {
    Background::ALL.into_iter().find(|reason| reason.name() == word)
}

/// Every word for background.
pub(crate) fn reasons() -> Vec<&'static str> {
    Background::ALL.iter().map(|reason| reason.name()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn the_three_kinds_of_share_are_read() {
        let text = json!({"title": "x", "reading": {
            "s1": [{"fact": "f1", "quote": "two nurses", "of": "all"}, {"fact": "f2", "quote": "wave", "of": "human_1"}],
            "s2": "setting",
            "s3": {"cannot_be_played": "nobody flies"},
        }});
        let account = parse_account(&text.to_string()).unwrap();
        assert_eq!(account.0["s2"], Share::Background(Background::Setting));
        assert_eq!(account.0["s3"], Share::CannotBePlayed("nobody flies".into()));
        let Share::Asked(claims) = &account.0["s1"] else { panic!() };
        assert_eq!((claims[0].of, claims[1].of.unwrap().to_string()), (None, "human_1".to_owned()));
    }

    #[test]
    fn every_wrong_share_is_named_with_what_is_allowed() {
        let text = json!({"reading": {
            "s1": "weather", "s2": [], "s3": {"cannot_be_played": ""}, "s4": [{"fact": "f1", "quote": "x", "of": "dog"}],
            "s5": [{"quote": "x", "of": "all"}], "s6": 7,
        }});
        let faults = parse_account(&text.to_string()).unwrap_err();
        let told: Vec<String> = faults.iter().map(ToString::to_string).collect();
        assert_eq!(told.len(), 6, "{told:?}");
        assert!(told[0].contains("$.reading.s1") && told[0].contains("setting, errand"), "{told:?}");
        assert!(told[3].contains("robot, all"), "{told:?}");
        assert!(parse_account("{\"title\": \"x\"}").unwrap_err()[0].to_string().contains("$.reading"));
    }
}
