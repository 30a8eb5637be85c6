//! The account: what an author says becomes of each sentence of a request, as the first part of its proposal.
//!
//! ```text
//! "reading": {"s1": ["human_1.does.2: waves", "all: in the ward"],              asked for: line of the scenario, words of the sentence
//!             "s2": ["setting"],                                                background
//!             "s4": ["expected_behavior: keeps right"],                         asked of a robot under test, and no part of the setup
//!             "s3": ["cannot_be_played: people have no hands"]}                 no part of any run; may stand beside what is asked for
//! ```
//!
//! Where an answer is no scenario, a line begins with the id of a fact and the agent instead (`f1 human_1: a nurse waves`), and clauses name
//! the id.

use std::collections::BTreeMap;

use serde_json::Value;
use socrates_model::statement::{Background, Became, Statement};
use socrates_model::{AgentId, FactKind, Fault, FaultCode, Reading, Request, Where};

use crate::sentences::sentences;

/// Member of an answer that holds the account.
pub(crate) const MEMBER: &str = "reading";
/// Word for what is of nobody in particular.
const ALL: &str = "all";
/// Word before the reason why something cannot be played.
pub(crate) const CANNOT: &str = "cannot_be_played";
/// Word before what a good robot does, which decides nothing about the scenario.
pub(crate) const EXPECTED: &str = "expected_behavior";
/// Longest reason that is kept, characters.
const MOST_REASON: usize = 300;

/// What becomes of each sentence, by its number.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Account(pub BTreeMap<String, Share>);

impl Account {
    /// The account that a reading tells of: what its author said of each sentence of the request.
    #[must_use]
    pub fn of(reading: &Reading, request: &Request) -> Self {
        let claim = |id: &String| {
            let fact = reading.facts.iter().find(|fact| fact.id == *id)?;
            let FactKind::Asked { of } = fact.kind else { return None };
            Some(Claim { fact: id.clone(), quote: fact.quote.clone(), of })
        };
        let mut account = Self::default();
        for sentence in sentences(request) {
            let own = |statement: &&Statement| statement.at == sentence.at && statement.span == sentence.span;
            let (mut claims, mut cannot, mut background, mut stated) = (Vec::new(), None, None, false);
            for statement in reading.statements.iter().filter(own) {
                match &statement.became {
                    Became::Read { facts, .. } => {
                        stated |= facts.is_empty();
                        claims.extend(facts.iter().filter_map(claim));
                    }
                    Became::NotPlayed { why } => cannot = Some(why.to_string()),
                    Became::Background(reason) | Became::Disputed { reason, .. } => background = Some(*reason),
                    Became::NotRead { .. } => {}
                }
            }
            let share = match background {
                Some(reason) => Share::Background(reason),
                None if claims.is_empty() && cannot.is_none() && !stated => continue,
                None => Share::Asked { claims, expected: None, cannot },
            };
            account.0.insert(sentence.id, share);
        }
        account
    }

    /// The lines of each sentence, as an answer writes them.
    #[must_use]
    pub fn lines(&self) -> BTreeMap<String, Vec<String>> {
        self.0.iter().map(|(id, share)| (id.clone(), share.lines())).collect()
    }
}

/// What becomes of one sentence.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Share {
    /// It asks for nothing that could be seen.
    Background(Background),
    /// It asks for something.
    Asked {
        /// What is played.
        claims: Vec<Claim>,
        /// Words on what a robot under test should do; no part of the setup.
        expected: Option<String>,
        /// Why a part of it, or all of it, is in no run.
        cannot: Option<String>,
    },
}

impl Share {
    /// The share as an answer writes it: a line for each thing.
    #[must_use]
    pub fn lines(&self) -> Vec<String> {
        match self {
            Self::Background(reason) => vec![reason.name().to_owned()],
            Self::Asked { claims, expected, cannot } => {
                let claim = |claim: &Claim| {
                    let of = claim.of.map_or_else(|| ALL.to_owned(), |of| of.to_string());
                    let of = if claim.is_line() { String::new() } else { format!(" {of}") };
                    format!("{}{of}: {}", claim.fact, claim.quote)
                };
                let expected = expected.as_ref().map(|words| format!("{EXPECTED}: {words}"));
                let cannot = cannot.as_ref().map(|why| format!("{CANNOT}: {why}"));
                claims.iter().map(claim).chain(expected).chain(cannot).collect()
            }
        }
    }
}

/// One thing that a sentence asks for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Claim {
    /// Id of the fact, which clauses name as their source; where the answer is a scenario, its line, such as `human_1.does.2`.
    pub fact: String,
    /// Words of the sentence.
    pub quote: String,
    /// The agent that does it; none for what holds of the whole scene.
    pub of: Option<AgentId>,
}

impl Claim {
    /// Whether it names a line of a scenario.
    #[must_use]
    pub fn is_line(&self) -> bool {
        ["all", "human_", "group.", "order.", "robot"].iter().any(|start| self.fact.starts_with(start))
    }
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

/// One line of a sentence.
enum Line {
    Background(Background),
    Expected(String),
    Cannot(String),
    Claim(Claim),
}

fn share(id: &str, value: &Value) -> Result<Share, Fault> {
    let lines: Vec<&str> = match value {
        Value::String(line) => vec![line],
        Value::Array(items) => items.iter().filter_map(Value::as_str).collect(),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::Object(_) => Vec::new(),
    };
    let whole = value.as_array().is_none_or(|items| items.len() == lines.len());
    let read: Result<Vec<Line>, String> = lines.iter().map(|text| line(text)).collect();
    let read = read.map_err(|why| wrong(&format!(".{id}"), why))?;
    // A sentence may ask for nothing beyond what is stated.
    let nothing = value.as_array().is_some_and(Vec::is_empty);
    if read.is_empty() && !nothing || !whole {
        let message = format!("expected lines such as `f1 human_1: words of it`, `setting` or `{CANNOT}: why`");
        return Err(wrong(&format!(".{id}"), message));
    }
    let several = read.len() > 1;
    let (mut claims, mut expected, mut cannot) = (Vec::new(), Vec::new(), Vec::new());
    for line in read {
        match line {
            Line::Background(reason) if !several => return Ok(Share::Background(reason)),
            Line::Background(reason) => {
                let message = format!(
                    "says `{}` beside other lines; a sentence asks for something or is background",
                    reason.name()
                );
                return Err(wrong(&format!(".{id}"), message));
            }
            Line::Expected(words) => expected.push(words),
            Line::Cannot(why) => cannot.push(why),
            Line::Claim(claim) => claims.push(claim),
        }
    }
    let joined = |words: Vec<String>| (!words.is_empty()).then(|| words.join("; "));
    Ok(Share::Asked { claims, expected: joined(expected), cannot: joined(cannot) })
}

/// One line, or what is wrong with it.
fn line(text: &str) -> Result<Line, String> {
    let text = text.trim();
    if let Some(reason) = Background::ALL.into_iter().find(|reason| reason.name() == text) {
        return Ok(Line::Background(reason));
    }
    let Some((before, after)) = text.split_once(':').filter(|(_, after)| !after.trim().is_empty()) else {
        let reasons = reasons().join(", ");
        return Err(format!("`{text}` is no line; allowed: {reasons}, `f1 human_1: words of it`, `{CANNOT}: why`"));
    };
    let after = after.trim();
    let words = || after.chars().take(MOST_REASON).collect();
    match before.trim() {
        CANNOT => return Ok(Line::Cannot(words())),
        EXPECTED => return Ok(Line::Expected(words())),
        _ => {}
    }
    let words: Vec<&str> = before.split_whitespace().collect();
    let (fact, of) = match words[..] {
        [fact, of] => (fact, of),
        // A line of a scenario is of the agent whose name it begins with; groups and orders have no agent.
        [line] => (
            line,
            Some(line.split('.').next().unwrap_or(line))
                .filter(|of| *of == "robot" || of.starts_with("human_"))
                .unwrap_or(ALL),
        ),
        _ => return Err(format!("`{text}` names no line; expected `human_1.does.2: words of it`")),
    };
    let of = if of == ALL {
        None
    } else {
        let who = of
            .parse()
            .map_err(|_no_agent| format!("`{of}` is nobody; allowed: robot, {ALL}, or a human such as human_1"));
        Some(who?)
    };
    Ok(Line::Claim(Claim { fact: fact.to_owned(), quote: after.trim_matches('"').to_owned(), of }))
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
    fn every_kind_of_line_is_read() {
        let text = json!({"title": "x", "reading": {
            "s1": ["f1 all: two nurses", "f2 human_1: wave: and smile", "cannot_be_played: nobody smiles"],
            "s2": ["setting"],
            "s3": "cannot_be_played: nobody flies",
        }});
        let account = parse_account(&text.to_string()).unwrap();
        assert_eq!(account.0["s2"], Share::Background(Background::Setting));
        assert_eq!(
            account.0["s3"],
            Share::Asked { claims: Vec::new(), expected: None, cannot: Some("nobody flies".into()) }
        );
        let Share::Asked { claims, cannot, .. } = &account.0["s1"] else { panic!() };
        assert_eq!((claims[0].of, claims[1].of.unwrap().to_string()), (None, "human_1".to_owned()));
        assert_eq!((claims[1].quote.as_str(), cannot.as_deref()), ("wave: and smile", Some("nobody smiles")));
    }

    #[test]
    fn a_line_of_a_scenario_is_of_the_agent_that_it_names() {
        let text = json!({"reading": {"s1": ["human_2.does.1: waves", "order.1: first", "robot.goal: to the exit", "all: two"]}});
        let account = parse_account(&text.to_string()).unwrap();
        let Share::Asked { claims, .. } = &account.0["s1"] else { panic!() };
        let of: Vec<String> = claims.iter().map(|one| one.of.map_or_else(String::new, |of| of.to_string())).collect();
        assert_eq!(of, ["human_2", "", "robot", ""]);
        assert!(claims.iter().all(Claim::is_line));
        assert_eq!(account.0["s1"].lines()[0], "human_2.does.1: waves");
    }

    #[test]
    fn every_wrong_share_is_named_with_what_is_allowed() {
        let text = json!({"reading": {
            "s1": ["weather"], "s2": {}, "s3": ["cannot_be_played: "], "s4": ["f1 dog: x"], "s5": ["f1 human_1 x: y"], "s6": 7,
            "s7": ["setting", "f1 all: x"], "s8": ["setting", 3],
        }});
        let faults = parse_account(&text.to_string()).unwrap_err();
        let told: Vec<String> = faults.iter().map(ToString::to_string).collect();
        assert_eq!(told.len(), 8, "{told:?}");
        assert!(told[0].contains("$.reading.s1") && told[0].contains("setting, errand"), "{told:?}");
        assert!(told[3].contains("robot, all"), "{told:?}");
        assert!(told[6].contains("beside other lines"), "{told:?}");
        assert!(parse_account("{\"title\": \"x\"}").unwrap_err()[0].to_string().contains("$.reading"));
    }
}
