//! What authors were asked and answered, as training data: one JSON object a line.
//!
//! ```text
//! chat.jsonl         {"messages": [system, user, assistant]}           the answers that were taken
//! preferences.jsonl  {"prompt": [system, user], "chosen": [assistant], "rejected": [assistant]}
//! index.jsonl        line by line: which file and line, scenario, stage, author, faults, injected
//! ```
//!
//! The first two hold what trainers read and nothing else; everything about their lines stands in the index. A person's edit is
//! preferred to what it was made from; of other answers those are rejected that had faults before the one that was taken.

use serde::Serialize;
use serde_json::{Value, json};

/// Who says a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ChatRole {
    /// Rules of the conversation.
    System,
    /// Who asks.
    User,
}

/// What became of an answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Fate {
    /// It was taken.
    Accepted,
    /// A person wrote it, on top of one that was taken.
    Edited,
    /// It had faults.
    Rejected,
}

/// An answer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ChatAnswered {
    /// Its text.
    pub text: String,
    /// What became of it.
    pub fate: Fate,
    /// Who gave it.
    pub author: String,
    /// Codes of its faults.
    pub faults: Vec<String>,
    /// Faults that were put in on purpose; such an answer is no model's.
    pub injected: Vec<String>,
}

/// One question with its answers in the order in which they came.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ChatAsked {
    /// Scenario.
    pub scenario: String,
    /// Stage.
    pub stage: String,
    /// How the scenario ended.
    pub verdict: String,
    /// The question, as it was first put.
    pub prompt: Vec<(ChatRole, String)>,
    /// Its answers.
    pub answers: Vec<ChatAnswered>,
}

/// The three files.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ChatFiles {
    /// Answers that were taken.
    pub chat: String,
    /// Pairs.
    pub preferences: String,
    /// What each line is.
    pub index: String,
}

/// The files of these questions. A question without an answer that was taken gives no line; an answer that is empty or like the
/// chosen one is no alternative to it.
#[must_use]
pub fn write(asked: &[ChatAsked]) -> ChatFiles {
    let mut files = ChatFiles::default();
    let (mut chats, mut pairs) = (0_usize, 0_usize);
    for question in asked {
        let last = |fate: Fate| question.answers.iter().rev().find(|answer| answer.fate == fate);
        let Some(chosen) = last(Fate::Edited).or_else(|| last(Fate::Accepted)) else { continue };
        let prompt = messages(&question.prompt);
        let mut whole = prompt.clone();
        whole.push(said(&chosen.text));
        chats += 1;
        line(&mut files.chat, &json!({ "messages": whole }));
        line(&mut files.index, &about("chat.jsonl", chats, question, chosen, None));
        for other in &question.answers {
            if other == chosen || other.text.trim().is_empty() || other.text == chosen.text {
                continue;
            }
            pairs += 1;
            let pair = json!({"prompt": prompt, "chosen": [said(&chosen.text)], "rejected": [said(&other.text)]});
            line(&mut files.preferences, &pair);
            line(&mut files.index, &about("preferences.jsonl", pairs, question, chosen, Some(other)));
        }
    }
    files
}

/// The question as turns of the system and one turn of the user: trainers want the speakers to alternate.
fn messages(prompt: &[(ChatRole, String)]) -> Vec<Value> {
    let of = |role: ChatRole| -> Vec<&str> {
        prompt.iter().filter(|(who, _)| *who == role).map(|(_, text)| text.trim_end()).collect()
    };
    let turn = |role: ChatRole| {
        let texts = of(role);
        (!texts.is_empty()).then(|| json!({"role": role, "content": texts.join("\n\n")}))
    };
    [ChatRole::System, ChatRole::User].into_iter().filter_map(turn).collect()
}

fn said(text: &str) -> Value {
    json!({"role": "assistant", "content": text})
}

fn about(
    file: &str,
    number: usize,
    asked: &ChatAsked,
    chosen: &ChatAnswered,
    rejected: Option<&ChatAnswered>,
) -> Value {
    let mut about = json!({
        "file": file, "line": number, "scenario": asked.scenario, "stage": asked.stage, "verdict": asked.verdict,
        "chosen": told(chosen),
    });
    if let (Some(members), Some(rejected)) = (about.as_object_mut(), rejected) {
        members.insert("rejected".to_owned(), told(rejected));
    }
    about
}

fn told(answer: &ChatAnswered) -> Value {
    json!({"fate": answer.fate, "author": answer.author, "faults": answer.faults, "injected": answer.injected})
}

/// One line: JSON writes line breaks inside of texts as `\n`.
fn line(out: &mut String, value: &Value) {
    out.push_str(&value.to_string());
    out.push('\n');
}

#[cfg(test)]
mod tests {
    use super::*;

    fn answered(text: &str, fate: Fate, faults: &[&str]) -> ChatAnswered {
        let faults = faults.iter().map(|code| (*code).to_owned()).collect();
        ChatAnswered { text: text.into(), fate, author: "openai:m".into(), faults, injected: Vec::new() }
    }

    fn asked(answers: Vec<ChatAnswered>) -> ChatAsked {
        let prompt = vec![
            (ChatRole::System, "You design.\n".to_owned()),
            (ChatRole::User, "Rules\n".to_owned()),
            (ChatRole::User, "Scenario\nof two lines".to_owned()),
        ];
        ChatAsked { scenario: "s-1".into(), stage: "paths".into(), verdict: "realised".into(), prompt, answers }
    }

    fn lines(text: &str) -> Vec<Value> {
        text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
    }

    #[test]
    fn every_line_is_an_object_of_the_shape_that_trainers_read() {
        let answers = vec![
            answered("{\"a\": 1}", Fate::Rejected, &["G-DISC"]),
            answered("", Fate::Rejected, &["E-EMPTY"]),
            answered("{\"a\":\n2}", Fate::Accepted, &[]),
        ];
        let files = write(&[asked(answers)]);
        let chat = lines(&files.chat);
        assert_eq!(chat.len(), 1);
        assert_eq!(chat[0].as_object().unwrap().keys().collect::<Vec<_>>(), ["messages"]);
        let turns = chat[0]["messages"].as_array().unwrap();
        let roles: Vec<&str> = turns.iter().map(|turn| turn["role"].as_str().unwrap()).collect();
        assert_eq!(roles, ["system", "user", "assistant"]);
        assert_eq!(turns[1]["content"], "Rules\n\nScenario\nof two lines");
        assert_eq!(turns[2]["content"], "{\"a\":\n2}");
        let pairs = lines(&files.preferences);
        assert_eq!(pairs.len(), 1, "an empty answer teaches nothing");
        assert_eq!(pairs[0].as_object().unwrap().keys().collect::<Vec<_>>(), ["chosen", "prompt", "rejected"]);
        assert_eq!(pairs[0]["rejected"], json!([{"role": "assistant", "content": "{\"a\": 1}"}]));
        assert_eq!(pairs[0]["prompt"], json!(turns[..2]));
        let index = lines(&files.index);
        assert_eq!(index.len(), 2);
        assert_eq!((&index[1]["line"], &index[1]["rejected"]["faults"]), (&json!(1), &json!(["G-DISC"])));
    }

    #[test]
    fn an_edit_is_preferred_to_what_it_was_made_from() {
        let answers = vec![answered("first", Fate::Accepted, &[]), answered("by hand", Fate::Edited, &[])];
        let files = write(&[asked(answers)]);
        assert_eq!(lines(&files.chat)[0]["messages"][2]["content"], "by hand");
        assert_eq!(lines(&files.preferences)[0]["rejected"][0]["content"], "first");
    }

    #[test]
    fn without_an_answer_that_was_taken_there_is_nothing_to_learn() {
        let refused = asked(vec![answered("no", Fate::Rejected, &["E-JSON"])]);
        assert_eq!(write(&[refused]), ChatFiles::default());
    }
}
