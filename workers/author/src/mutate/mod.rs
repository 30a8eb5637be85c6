//! The operators of the fault model: each makes one kind of wrong answer out of a good one.

mod behaviors;
mod paths;
mod proposal;

use serde_json::Value;
use socrates_model::job::Stage;
use socrates_prompts::Question;

use crate::fault_model::{FaultKind, concerns};
use crate::variants::MEMBER;

/// The text with the fault in it; nothing where the answer has no place for it.
pub(crate) fn apply(kind: FaultKind, question: &Question, text: &str, draw: u64) -> Option<String> {
    if !concerns(kind, question.stage) || kind.is_of_server() {
        return None;
    }
    #[expect(clippy::wildcard_enum_match_arm, reason = "every other kind is of the content")]
    match kind {
        FaultKind::Trunc => return cut(text, draw),
        FaultKind::Empty => return Some(String::new()),
        FaultKind::Fence => return Some(format!("Here is the answer:\n```json\n{text}\n```\n")),
        FaultKind::Json => return Some(text.replacen("\":", "\";", 1)),
        _ => {}
    }
    let mut answer: Value = serde_json::from_str(text).ok()?;
    match question.stage {
        Stage::Proposal => match answer.get_mut(MEMBER).and_then(Value::as_array_mut) {
            // Several proposals have the fault in common, or the best of them would hide it.
            Some(all) => {
                let hit = all.iter_mut().filter_map(|one| proposal::put(kind, one, question, draw)).count();
                (hit > 0).then_some(())?;
            }
            None => proposal::put(kind, &mut answer, question, draw)?,
        },
        Stage::Paths => paths::put(kind, &mut answer, question, draw)?,
        Stage::Behaviors => behaviors::put(kind, &mut answer, question, draw)?,
        Stage::Simulation | Stage::Scoring | Stage::Review => return None,
    }
    serde_json::to_string(&answer).ok()
}

/// The text up to a drawn character, a tenth to nine tenths of it.
fn cut(text: &str, draw: u64) -> Option<String> {
    let count = text.chars().count();
    let keep = count / 10 + pick(draw, count * 8 / 10)?;
    Some(text.chars().take(keep.max(1)).collect())
}

fn list<'a>(answer: &'a mut Value, name: &str) -> Option<&'a mut Vec<Value>> {
    answer.get_mut(name)?.as_array_mut()
}

fn rename(answer: &mut Value, from: &str, to: &str) -> Option<()> {
    let members = answer.as_object_mut()?;
    let value = members.remove(from)?;
    members.insert(to.to_owned(), value);
    Some(())
}

/// A drawn index below `count`.
fn pick(draw: u64, count: usize) -> Option<usize> {
    let count = u64::try_from(count).ok().filter(|count| *count > 0)?;
    usize::try_from(draw % count).ok()
}
