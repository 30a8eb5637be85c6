//! Wrong behaviors: as rules where the answer has rules, else as trees.

use serde_json::{Value, json};
use socrates_model::rule::RobotDo;
use socrates_model::{Gesture, HumanId};
use socrates_prompts::{Question, parse_behaviors};

use super::{pick, rename};
use crate::fault_model::FaultKind;

/// The last of the nodes that walk along the path.
const WALK: &str = "<SubTree ID=\"RegularNavTree\"";

#[expect(clippy::wildcard_enum_match_arm, reason = "a kind of another stage has no place in this answer")]
pub(super) fn put(kind: FaultKind, answer: &mut Value, question: &Question, draw: u64) -> Option<()> {
    let whole = answer.to_string();
    let humans = answer.get_mut("humans")?.as_object_mut()?;
    let names: Vec<String> = humans.keys().cloned().collect();
    let name = names.get(pick(draw, names.len())?)?;
    let ruled = names.iter().find(|name| {
        humans.get(*name).is_some_and(|human| human["rules"].as_array().is_some_and(|rules| !rules.is_empty()))
    });
    match kind {
        FaultKind::Bagents => {
            humans.remove(name)?;
        }
        FaultKind::Bxml => {
            let tree = "<root main_tree_to_execute=\"Main\"><BehaviorTree ID=\"Main\">";
            *humans.get_mut(name)? = json!({"description": "broken", "tree": tree});
        }
        FaultKind::Schema => return rename(humans.get_mut(name)?, "rules", "rule_list"),
        FaultKind::Bmatch | FaultKind::Bdead | FaultKind::Bhear | FaultKind::Brange | FaultKind::Bcontra => {
            let human = humans.get_mut(ruled.unwrap_or(name))?;
            return rules(kind, human.get_mut("rules")?.as_array_mut()?, question);
        }
        _ => {
            // The tree that was meant, with the fault in it. Any human will do whose tree has a place for it.
            let read = parse_behaviors(&whole, question).ok()?;
            let start = pick(draw, names.len())?;
            let (turned, tree) = names.iter().cycle().skip(start).take(names.len()).find_map(|name| {
                let tree = &read.humans.get(&name.parse::<HumanId>().ok()?)?.tree;
                Some((name.clone(), in_tree(kind, tree)?))
            })?;
            *humans.get_mut(&turned)? = json!({"description": "", "tree": tree});
        }
    }
    Some(())
}

#[expect(clippy::wildcard_enum_match_arm, reason = "the others are put into trees")]
fn rules(kind: FaultKind, rules: &mut Vec<Value>, question: &Question) -> Option<()> {
    let extra = |when: Value, act: &str| json!({"when": when, "act": act});
    match kind {
        FaultKind::Bmatch if !rules.is_empty() => {
            rules.remove(0);
        }
        FaultKind::Bdead if !rules.is_empty() => rules.insert(0, extra(json!(["always"]), "stand_still")),
        FaultKind::Bcontra => {
            let mut other = rules.first()?.clone();
            let act = if other.get("act")? == "stand_still" { "run_away" } else { "stand_still" };
            *other.get_mut("act")? = json!(act);
            // An end would let the two follow each other.
            other.as_object_mut()?.remove("for_s");
            rules.insert(0, other);
        }
        FaultKind::Bhear => {
            let script =
                question.proposal.as_ref().map(|proposal| proposal.robot.script.as_slice()).unwrap_or_default();
            let made = |gesture: &Gesture| script.iter().any(|line| line.act == RobotDo::Say(*gesture));
            let unheard = Gesture::ALL.into_iter().find(|gesture| !made(gesture))?;
            rules.insert(0, extra(json!([{"robot_says": unheard}]), "follow_robot"));
        }
        FaultKind::Brange => rules.insert(0, extra(json!([{"robot_near": 99.0}]), "look_at_robot")),
        _ => return None,
    }
    Some(())
}

/// The tree with the fault in it; nothing where it has no place for it.
#[expect(clippy::wildcard_enum_match_arm, reason = "the others are put into rules")]
fn in_tree(kind: FaultKind, tree: &str) -> Option<String> {
    let mut lines: Vec<&str> = tree.lines().collect();
    // The first reaction with a motion of one node: from its `Sequence` to the motion before its end.
    let reaction = (0..lines.len()).find_map(|opens| {
        let indent = lines.get(opens)?.split_once("<Sequence name=\"rule_").map(|(indent, _)| indent)?;
        let end = format!("{indent}</Sequence>");
        let closes = opens + lines.iter().skip(opens).position(|line| **line == end)?;
        let motion = closes.checked_sub(1)?;
        (!lines.get(motion)?.contains(WALK)).then_some((opens, motion))
    });
    let gesture = "<MakeGesture agent_id=\"{id}\" message=\"";
    let whole = |lines: &[&str]| Some(lines.join("\n") + "\n");
    let replaced = |from: &str, to: &str| tree.contains(from).then(|| tree.replacen(from, to, 1));
    match kind {
        FaultKind::Bmain => replaced("main_tree_to_execute=\"", "main_tree_to_execute=\"not_"),
        FaultKind::Bnode => Some(replaced("<Fallback", "<Fallbak")?.replacen("</Fallback>", "</Fallbak>", 1)),
        FaultKind::Bport => replaced(" value=\"{dt}\"", ""),
        FaultKind::Barity => {
            replaced("<Fallback name=\"reactions\">", "<Fallback name=\"reactions\"><Inverter></Inverter>")
        }
        FaultKind::Bnav => {
            lines.retain(|line| !line.contains(WALK) && !line.contains("<RegularNav "));
            whole(&lines)
        }
        FaultKind::Bcode => {
            let at = lines.iter().rposition(|line| line.contains("<SetBlackboard output_key=\"agentid\""))?;
            let line = format!("{gesture}WAIT\"/>");
            lines.insert(at, &line);
            whole(&lines)
        }
        FaultKind::Blatch => {
            let speaks = lines.iter().any(|line| line.contains(gesture) && !line.contains("message=\"0\""));
            lines.retain(|line| !line.contains("message=\"0\""));
            speaks.then(|| whole(&lines))?
        }
        FaultKind::Btimer => {
            let (opens, motion) = reaction?;
            let within = lines.get(opens..motion)?;
            let timer = opens + within.iter().position(|line| line.contains("<TimeExpiredCondition"))?;
            // After the motion that it should limit; its `Inverter` goes with it.
            let from = timer.checked_sub(1)?;
            lines.get_mut(from..=motion)?.rotate_left(3);
            whole(&lines)
        }
        FaultKind::Border => {
            let (opens, motion) = reaction?;
            // There has to be a condition that comes to stand after it.
            lines.get(opens + 1).filter(|line| line.contains("<Is") || line.contains("<Latch"))?;
            let line = lines.remove(motion);
            lines.insert(opens + 1, line);
            whole(&lines)
        }
        FaultKind::Bmove2 => {
            let (_, motion) = reaction?;
            let line = *lines.get(motion)?;
            lines.insert(motion, line);
            whole(&lines)
        }
        FaultKind::Bstill => {
            // Without its motion the reaction holds its human where it is.
            lines.remove(reaction?.1);
            whole(&lines)
        }
        _ => None,
    }
}
