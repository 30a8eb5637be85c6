//! `library export --chat-jsonl`: questions and answers out of the provenance of bundles, for training.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use socrates_export::chat_jsonl::{ChatAnswered, ChatAsked, ChatRole, Fate, write};
use socrates_model::job::Stage;
use socrates_model::{Behaviors, Paths, Proposal, Signature};
use socrates_prompts::{Question, Role, parse_behaviors, parse_paths, parse_proposal};

use crate::bundle;
use crate::cost::bundles_in;
use crate::exit::Diagnostic;
use crate::files;
use crate::output::Printer;

/// Exports.
pub fn export(talk: &Printer, what: &[PathBuf], out: &Path) -> Result<(), Diagnostic> {
    let bundles = bundles_in(what)?;
    let mut asked = Vec::new();
    let mut silent = 0;
    for dir in &bundles {
        let found = questions(dir)?;
        silent += usize::from(found.is_empty());
        asked.extend(found);
    }
    let written = write(&asked);
    for (name, text) in
        [("chat.jsonl", &written.chat), ("preferences.jsonl", &written.preferences), ("index.jsonl", &written.index)]
    {
        files::write(&out.join(name), text.as_bytes())?;
    }
    let (chats, pairs) = (written.chat.lines().count(), written.preferences.lines().count());
    talk.line(&format!("wrote      {}: {chats} answers, {pairs} pairs, of {} bundles", out.display(), bundles.len()));
    if silent > 0 {
        talk.warn(&format!("{silent} bundles hold no answers; `author.keep_answers` was off when they were made"));
    }
    talk.result(&json!({"out": out.display().to_string(), "answers": chats, "pairs": pairs, "bundles": bundles.len()}));
    Ok(())
}

/// What was asked for a bundle. One question is what has the same stage and inputs: asked again, with another seed, or after a
/// run it stays the same question.
fn questions(dir: &Path) -> Result<Vec<ChatAsked>, Diagnostic> {
    let name = crate::layout::PROVENANCE.path;
    let text = bundle::file(dir, name)?;
    let provenance: Value = serde_json::from_slice(&text)
        .map_err(|why| Diagnostic::input(format!("`{}`: {why}", dir.join(name).display()), "make the bundle again"))?;
    let whole = bundle::read_some(dir, |_, _| false)?;
    let mut found: BTreeMap<(Stage, String), Vec<Exchange>> = BTreeMap::new();
    let mut reviewed = false;
    for job in list(&provenance, "jobs") {
        let Some(stage) = word(&job, "/job/stage").and_then(|name| name.parse::<Stage>().ok()) else { continue };
        reviewed |= stage == Stage::Review && word(&job, "/state") == Some("succeeded");
        let inputs = job.get("inputs").map(Value::to_string).unwrap_or_default();
        // A job that was made anew after a run: what was taken before was not good enough.
        if !list(&job, "sent_back").is_empty()
            && let Some(earlier) = found.get_mut(&(stage, inputs.clone()))
        {
            earlier.iter_mut().for_each(|exchange| exchange.fate = Fate::Rejected);
        }
        let refused = list(&job, "attempts").into_iter().flat_map(|attempt| list(&attempt, "exchanges"));
        let refused = refused.filter_map(|value| Exchange::read(&value, Fate::Rejected));
        let taken = list(&job, "exchanges").into_iter().filter_map(|value| Exchange::read(&value, Fate::Accepted));
        for exchange in refused.chain(taken) {
            let all = found.entry((stage, inputs.clone())).or_default();
            // The exchange of the attempt that was taken stands with the attempt as well.
            all.retain(|other| other.answer != exchange.answer);
            all.push(exchange);
        }
    }
    let question = |stage: Stage| Question {
        stage,
        proposal: (stage != Stage::Proposal).then(|| whole.proposal.clone()),
        ..Question::first(whole.request.clone(), whole.reading.clone(), whole.location.clone(), whole.manifest.seed)
    };
    let mut asked = Vec::new();
    for ((stage, _), exchanges) in found {
        let question = question(stage);
        // Rules read no messages: the question as a model would be asked it.
        let first = exchanges.iter().find(|exchange| !exchange.messages.is_empty());
        let messages = first.map_or_else(|| question.messages(), |exchange| exchange.messages.clone());
        let prompt = messages
            .into_iter()
            // An answer inside of a question is a refused one: that question was no first one.
            .take_while(|message| message.role != Role::Assistant)
            .map(|message| (if message.role == Role::System { ChatRole::System } else { ChatRole::User }, message.text))
            .collect();
        let mut answers: Vec<ChatAnswered> =
            exchanges.into_iter().map(|exchange| exchange.answered(&question)).collect();
        if reviewed {
            match stage {
                Stage::Proposal => edited(&mut answers, whole.proposal.clone(), |text| parse_proposal(text).ok()),
                Stage::Paths => edited(&mut answers, whole.paths.clone(), |text| parse_paths(text, &question).ok()),
                Stage::Behaviors => {
                    edited(&mut answers, whole.behaviors.clone(), |text| parse_behaviors(text, &question).ok());
                }
                Stage::Simulation | Stage::Scoring | Stage::Review => {}
            }
        }
        let verdict = whole.manifest.verdict.name().to_owned();
        asked.push(ChatAsked {
            scenario: whole.manifest.scenario.clone(),
            stage: stage.name().to_owned(),
            verdict,
            prompt,
            answers,
        });
    }
    Ok(asked)
}

/// What can be signed by whoever wrote it.
trait Signed: Clone + PartialEq + serde::Serialize {
    /// Where the name stands.
    fn author(&mut self) -> &mut Signature;
}

impl Signed for Proposal {
    fn author(&mut self) -> &mut Signature {
        &mut self.author
    }
}

impl Signed for Paths {
    fn author(&mut self) -> &mut Signature {
        &mut self.author
    }
}

impl Signed for Behaviors {
    fn author(&mut self) -> &mut Signature {
        &mut self.author
    }
}

/// Adds what a person left otherwise than the author wrote it, in a form that an author could have answered in.
fn edited<T: Signed>(answers: &mut Vec<ChatAnswered>, mut left: T, read: impl Fn(&str) -> Option<T>) {
    let author = std::mem::take(left.author());
    let same = |text: &str| {
        read(text).is_some_and(|mut read| {
            *read.author() = Signature::default();
            read == left
        })
    };
    if answers.iter().any(|answer| answer.fate == Fate::Accepted && same(&answer.text)) {
        return;
    }
    if let Some(text) = serde_json::to_string(&left).ok().filter(|text| same(text)) {
        let author = author.to_string();
        answers.push(ChatAnswered { text, fate: Fate::Edited, author, faults: Vec::new(), injected: Vec::new() });
    }
}

/// What is read of an exchange.
struct Exchange {
    answer: String,
    fate: Fate,
    author: String,
    faults: Vec<String>,
    injected: Vec<String>,
    chosen: Option<usize>,
    messages: Vec<socrates_prompts::Message>,
}

impl Exchange {
    /// Nothing where there is no answer: none came, or answers were not kept.
    fn read(value: &Value, fate: Fate) -> Option<Self> {
        let answer = value.get("answer")?.as_str().filter(|answer| !answer.is_empty())?.to_owned();
        let words = |key: &str, of: fn(&Value) -> Option<&str>| -> Vec<String> {
            list(value, key).iter().filter_map(of).map(str::to_owned).collect()
        };
        let name = |pointer: &str| word(value, pointer).filter(|name| !name.is_empty());
        Some(Self {
            answer,
            fate,
            author: name("/model").or_else(|| name("/author")).unwrap_or("unknown").to_owned(),
            faults: words("faults", |fault| word(fault, "/code")),
            injected: words("injected", Value::as_str),
            chosen: value.get("chosen").and_then(Value::as_u64).and_then(|place| usize::try_from(place).ok()),
            messages: value
                .get("messages")
                .and_then(|messages| serde_json::from_value(messages.clone()).ok())
                .unwrap_or_default(),
        })
    }

    /// Of several proposals the one that was taken.
    fn answered(self, question: &Question) -> ChatAnswered {
        let several = self.chosen.and_then(|place| {
            let all = socrates_author::variants::read(&self.answer, question).ok()?;
            Some(all.into_iter().nth(place)?.text)
        });
        ChatAnswered {
            text: several.unwrap_or(self.answer),
            fate: self.fate,
            author: self.author,
            faults: self.faults,
            injected: self.injected,
        }
    }
}

fn list(value: &Value, key: &str) -> Vec<Value> {
    value.get(key).and_then(Value::as_array).cloned().unwrap_or_default()
}

fn word<'a>(value: &'a Value, pointer: &str) -> Option<&'a str> {
    value.pointer(pointer)?.as_str()
}
