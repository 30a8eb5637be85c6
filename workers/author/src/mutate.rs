//! The operators of the fault model: each makes one kind of wrong answer out of a good one.

use serde_json::{Value, json};
use socrates_model::job::Stage;

use crate::faulty::FaultKind;

/// The text with the fault in it; nothing where the answer has no place for it.
pub(crate) fn apply(kind: FaultKind, stage: Stage, text: &str, draw: u64) -> Option<String> {
    match kind {
        FaultKind::Trunc => return cut(text, draw),
        FaultKind::Empty => return Some(String::new()),
        FaultKind::Fence => return Some(format!("Here is the answer:\n```json\n{text}\n```\n")),
        FaultKind::Json => return Some(text.replacen("\":", "\";", 1)),
        FaultKind::Schema
        | FaultKind::Pcount
        | FaultKind::Pverify
        | FaultKind::Pcap
        | FaultKind::Gdisc
        | FaultKind::Gunknown
        | FaultKind::Gshort
        | FaultKind::Gmeet
        | FaultKind::Gmeetend
        | FaultKind::Gagents
        | FaultKind::Bagents
        | FaultKind::Bdead
        | FaultKind::Bhear
        | FaultKind::Brange
        | FaultKind::Bmatch
        | FaultKind::Bxml => {}
        // These never reach the text.
        FaultKind::Refusal | FaultKind::T429 | FaultKind::T5xx | FaultKind::Tnet | FaultKind::Timeout => return None,
    }
    let mut answer: Value = serde_json::from_str(text).ok()?;
    match stage {
        Stage::Proposal => proposal(kind, &mut answer, draw)?,
        Stage::Paths => paths(kind, &mut answer, draw)?,
        Stage::Behaviors => behaviors(kind, &mut answer, draw)?,
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

#[expect(clippy::wildcard_enum_match_arm, reason = "a kind of another stage has no place in this answer")]
fn proposal(kind: FaultKind, answer: &mut Value, draw: u64) -> Option<()> {
    match kind {
        FaultKind::Pcount => {
            list(answer, "humans")?.pop()?;
        }
        FaultKind::Pverify => {
            let clauses = list(answer, "expected_events")?;
            let carriers: Vec<usize> = clauses
                .iter()
                .enumerate()
                .filter(|(_, clause)| {
                    clause["source"].as_str().is_some_and(|source| !source.is_empty()) && clause["must"] == true
                })
                .map(|(index, _)| index)
                .collect();
            let index = *carriers.get(pick(draw, carriers.len())?)?;
            // A wish is lost when every clause that carries it is.
            let wish = clauses.get(index)?["source"].clone();
            clauses.retain(|clause| clause["source"] != wish);
        }
        FaultKind::Pcap => {
            let humans = list(answer, "humans")?;
            let index = pick(draw, humans.len())?;
            let behavior = humans.get_mut(index)?.get_mut("behavior")?;
            *behavior = json!(format!("{} Then it picks up a box.", behavior.as_str().unwrap_or_default()));
        }
        FaultKind::Schema => rename(answer, "place", "location")?,
        _ => return None,
    }
    Some(())
}

#[expect(clippy::wildcard_enum_match_arm, reason = "a kind of another stage has no place in this answer")]
fn paths(kind: FaultKind, answer: &mut Value, draw: u64) -> Option<()> {
    let meeting = answer.pointer("/encounters/0/node").and_then(Value::as_str).map(str::to_owned);
    match kind {
        FaultKind::Gdisc => {
            // A node in the middle that is no encounter, so that the hole is the only fault.
            let met: Vec<Value> =
                answer["encounters"].as_array()?.iter().map(|encounter| encounter["node"].clone()).collect();
            let robot = list(answer, "robot")?;
            let inner: Vec<usize> = (1..robot.len().saturating_sub(1))
                .filter(|index| robot.get(*index).is_some_and(|node| !met.contains(node)))
                .collect();
            let index = *inner.get(pick(draw, inner.len())?)?;
            robot.remove(index);
        }
        FaultKind::Gunknown => {
            let robot = list(answer, "robot")?;
            let last = robot.last_mut()?;
            *last = json!(format!("{}_x", last.as_str()?));
        }
        FaultKind::Gshort => {
            let meeting = meeting?;
            let robot = list(answer, "robot")?;
            let at = robot.iter().position(|node| node.as_str() == Some(&meeting))?;
            robot.truncate(at + 2);
            robot.drain(..at.checked_sub(1)?);
        }
        FaultKind::Gmeet => {
            let robot: Vec<Value> = answer["robot"].as_array()?.clone();
            let stray = answer["humans"]
                .as_object()?
                .values()
                .filter_map(Value::as_array)
                .flatten()
                .find(|node| !robot.contains(node))?
                .clone();
            *answer.get_mut("encounters")?.get_mut(0)?.get_mut("node")? = stray;
        }
        FaultKind::Gmeetend => {
            let meeting = meeting?;
            let robot = list(answer, "robot")?;
            let at = robot.iter().position(|node| node.as_str() == Some(&meeting))?;
            robot.truncate(at + 1);
        }
        FaultKind::Gagents => {
            let humans = answer.get_mut("humans")?.as_object_mut()?;
            let path = humans.values().next()?.clone();
            humans.insert("human_99".to_owned(), path);
        }
        FaultKind::Schema => rename(answer, "robot", "Robot")?,
        _ => return None,
    }
    Some(())
}

#[expect(clippy::wildcard_enum_match_arm, reason = "a kind of another stage has no place in this answer")]
fn behaviors(kind: FaultKind, answer: &mut Value, draw: u64) -> Option<()> {
    let humans = answer.get_mut("humans")?.as_object_mut()?;
    let names: Vec<String> = humans.keys().cloned().collect();
    let name = names.get(pick(draw, names.len())?)?;
    if kind == FaultKind::Bagents {
        humans.remove(name)?;
        return Some(());
    }
    let ruled = names.iter().find(|name| {
        humans.get(*name).is_some_and(|human| human["rules"].as_array().is_some_and(|rules| !rules.is_empty()))
    });
    let human = humans.get_mut(ruled.unwrap_or(name))?;
    if kind == FaultKind::Bxml {
        *human =
            json!({"description": "broken", "tree": "<root main_tree_to_execute=\"Main\"><BehaviorTree ID=\"Main\">"});
        return Some(());
    }
    if kind == FaultKind::Schema {
        return rename(human, "rules", "rule_list");
    }
    let rules = human.get_mut("rules")?.as_array_mut()?;
    let extra = |when: Value, act: &str| json!({"when": when, "act": act});
    match kind {
        FaultKind::Bmatch => {
            if rules.is_empty() {
                return None;
            }
            rules.remove(0);
        }
        FaultKind::Bdead => {
            if rules.is_empty() {
                return None;
            }
            rules.insert(0, extra(json!(["always"]), "stand_still"));
        }
        FaultKind::Bhear => rules.insert(0, extra(json!([{"robot_says": "FOLLOW_ME"}]), "follow_robot")),
        FaultKind::Brange => rules.insert(0, extra(json!([{"robot_near": 99.0}]), "look_at_robot")),
        _ => return None,
    }
    Some(())
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
