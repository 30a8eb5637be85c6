//! Trees as nested objects, and the XML they stand for.

use serde_json::{Value, json};
use socrates_bt::{NodeSheet, PortKind, REGULAR_NAV_PATH};
use socrates_model::{Fault, FaultCode, HumanId};

/// The word for the block that walks along the path.
pub(crate) const WALK: &str = "Walk";
/// Deepest tree that is read.
const DEEPEST: usize = 24;
/// Most nodes of a tree that is read.
const MOST: usize = 200;

/// Nodes that authors are told of: those that rules are compiled to.
pub(crate) const TAGS: [&str; 25] = [
    "Sequence",
    "Fallback",
    "Inverter",
    "Latch",
    "TimeExpiredCondition",
    "HasTimePassed",
    "IsRobotVisible",
    "IsRobotNearby",
    "IsRobotBlocking",
    "RobotMoved",
    "IsRobotStopped",
    "HasRobotPassed",
    "RobotSays",
    "HumanSays",
    "IsPathDone",
    "IsAtEncounter",
    "MakeGesture",
    "FollowRobot",
    "FollowHuman",
    "RunAwayFromRobot",
    "GiveWaytoRobot",
    "BlockRobot",
    "LookAtRobot",
    "ApproachRobot",
    "StandStill",
];

fn sheet(tag: &str) -> Option<&'static NodeSheet> {
    socrates_bt::CATALOG.iter().find(|sheet| sheet.is_called(tag)).copied()
}

/// The node table: with every port for XML, without what we fill in ourselves for objects.
pub(crate) fn table(in_full: bool) -> String {
    let mut text = String::new();
    for sheet in TAGS.iter().filter_map(|tag| sheet(tag)) {
        let ports = sheet.ports.iter().filter(|port| in_full || !is_ours(port.kind));
        let ports: Vec<String> = ports
            .map(|port| {
                let known = [
                    (PortKind::Own, "{id}"),
                    (PortKind::Step, "{dt}"),
                    (PortKind::Meters, "0.3 to 15"),
                    (PortKind::Gesture, "code"),
                ];
                let short = known.iter().find(|(kind, _)| *kind == port.kind).map(|(_, text)| *text);
                let value = short.or(port.default).map_or_else(|| port.kind.allowed(), str::to_owned);
                format!(" {}={value}", port.name)
            })
            .collect();
        text.push_str(&format!("- {} ({}){}: {}\n", sheet.tag, sheet.kind.name(), ports.concat(), sheet.about));
    }
    text
}

/// Whether a port says nothing that we do not know.
const fn is_ours(kind: PortKind) -> bool {
    matches!(kind, PortKind::Own | PortKind::Step)
}

/// The XML of a tree of objects `{"node": …, "ports": ["name=value"], "children": […]}`.
///
/// # Errors
/// E-SCHEMA with the path of the object that is none, is nested too deep, or has a port that is no pair.
pub(crate) fn xml(human: HumanId, tree: &Value, path: &str) -> Result<String, Vec<Fault>> {
    let mut text = format!(
        "<root main_tree_to_execute=\"{human}\">\n  <include path=\"{REGULAR_NAV_PATH}\"/>\n  <BehaviorTree ID=\"{human}\">\n"
    );
    let mut count = 0;
    element(tree, path, 0, &mut count, &mut text).map_err(|fault| vec![fault])?;
    Ok(text + "  </BehaviorTree>\n</root>\n")
}

fn element(node: &Value, path: &str, depth: usize, count: &mut usize, text: &mut String) -> Result<(), Fault> {
    let fault = |why: &str| Fault::new(FaultCode::ESchema, path, why);
    *count += 1;
    if depth > DEEPEST || *count > MOST {
        return Err(fault(&format!("expected a tree of at most {MOST} nodes, {DEEPEST} deep")));
    }
    let tag = node.get("node").and_then(Value::as_str);
    let tag = tag.filter(|tag| tag.chars().all(|c| c.is_ascii_alphanumeric()) && !tag.is_empty());
    let tag = tag.ok_or_else(|| fault("expected an object with `node`, the name of a node of the table"))?;
    let indent = "  ".repeat(depth + 2);
    if tag == WALK {
        text.push_str(&format!(
            "{indent}<Sequence name=\"walk\">\n{indent}  <SetBlackboard output_key=\"agentid\" value=\"{{id}}\"/>\n\
             {indent}  <SetBlackboard output_key=\"timestep\" value=\"{{dt}}\"/>\n\
             {indent}  <SubTree ID=\"RegularNavTree\" id=\"agentid\" dt=\"timestep\"/>\n{indent}</Sequence>\n"
        ));
        return Ok(());
    }
    text.push_str(&format!("{indent}<{tag}"));
    let mut given = Vec::new();
    for port in node.get("ports").and_then(Value::as_array).into_iter().flatten() {
        let pair = port.as_str().and_then(|port| port.split_once('='));
        let (name, value) = pair.ok_or_else(|| fault(&format!("expected ports as \"name=value\", found `{port}`")))?;
        let value = value.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;");
        let name: String = name.trim().chars().filter(|c| c.is_ascii_alphanumeric() || *c == '_').collect();
        text.push_str(&format!(" {name}=\"{value}\""));
        given.push(name);
    }
    for port in sheet(tag).map(|sheet| sheet.ports).unwrap_or_default() {
        if is_ours(port.kind) && !given.iter().any(|name| name == port.name) {
            let value = if port.kind == PortKind::Own { "{id}" } else { "{dt}" };
            text.push_str(&format!(" {}=\"{value}\"", port.name));
        } else if tag == "TimeExpiredCondition" && !given.iter().any(|name| name == port.name) {
            // A timer of a reaction runs once and counts in ticks.
            match port.name {
                "ts" => text.push_str(" ts=\"{dt}\""),
                "only_once" => text.push_str(" only_once=\"true\""),
                _ => {}
            }
        }
    }
    let children = node.get("children").and_then(Value::as_array).map(Vec::as_slice).unwrap_or_default();
    if children.is_empty() {
        text.push_str("/>\n");
        return Ok(());
    }
    text.push_str(">\n");
    for (index, child) in children.iter().enumerate() {
        element(child, &format!("{path}.children[{index}]"), depth + 1, count, text)?;
    }
    text.push_str(&format!("{indent}</{tag}>\n"));
    Ok(())
}

/// A rule list as a tree of objects: as a worked example shows it. The same shape as the compiler's.
pub(crate) fn of_rules(rules: &[socrates_model::Rule]) -> Value {
    let leaf = |tag: &str, ports: Vec<String>| json!({"node": tag, "ports": ports, "children": []});
    let speaks = rules.iter().any(|rule| rule.gesture.is_some());
    let mut branches: Vec<Value> = Vec::new();
    for rule in rules {
        let mut steps: Vec<Value> = rule.when.iter().filter_map(|trigger| condition(trigger, &leaf)).collect();
        if rule.latched && !steps.is_empty() {
            let inner = json!({"node": "Sequence", "ports": [], "children": steps});
            steps = vec![json!({"node": "Latch", "ports": [], "children": [inner]})];
        }
        if let Some(secs) = rule.for_s {
            let timer = leaf("TimeExpiredCondition", vec![format!("seconds={secs}")]);
            steps.push(json!({"node": "Inverter", "ports": [], "children": [timer]}));
        }
        if speaks {
            steps.push(leaf("MakeGesture", vec![format!("message={}", rule.gesture.unwrap_or_default().code())]));
        }
        steps.push(motion(&rule.act, &leaf));
        branches.push(json!({"node": "Sequence", "ports": [], "children": steps}));
    }
    let walk = json!({"node": WALK, "ports": [], "children": []});
    branches.push(if speaks {
        let quiet = leaf("MakeGesture", vec!["message=0".to_owned()]);
        json!({"node": "Sequence", "ports": [], "children": [quiet, walk]})
    } else {
        walk
    });
    json!({"node": "Fallback", "ports": [], "children": branches})
}

fn condition(trigger: &socrates_model::Trigger, leaf: &dyn Fn(&str, Vec<String>) -> Value) -> Option<Value> {
    use socrates_model::Trigger;
    let near = |tag: &str, m: f64| Some(leaf(tag, vec![format!("distance={m}")]));
    match trigger {
        Trigger::Always => None,
        Trigger::RobotVisible(m) => near("IsRobotVisible", *m),
        Trigger::RobotNear(m) => near("IsRobotNearby", *m),
        Trigger::RobotBlocking(m) => near("IsRobotBlocking", *m),
        Trigger::RobotMoving => Some(leaf("RobotMoved", vec![])),
        Trigger::RobotStopped => Some(leaf("IsRobotStopped", vec![])),
        Trigger::RobotPassed => Some(leaf("HasRobotPassed", vec![])),
        Trigger::RobotSays(gesture) => Some(leaf("RobotSays", vec![format!("message={}", gesture.code())])),
        Trigger::HumanSays(id, gesture) => {
            let ports = vec![format!("target_id={}", id.number()), format!("message={}", gesture.code())];
            Some(leaf("HumanSays", ports))
        }
        Trigger::GoalReached => Some(leaf("IsPathDone", vec![])),
        Trigger::AtEncounter => Some(leaf("IsAtEncounter", vec![])),
        Trigger::AfterSecs(secs) => Some(leaf("HasTimePassed", vec![format!("seconds={secs}")])),
    }
}

fn motion(action: &socrates_model::Action, leaf: &dyn Fn(&str, Vec<String>) -> Value) -> Value {
    use socrates_model::Action;
    match action {
        Action::Navigate => leaf(WALK, vec![]),
        Action::FollowRobot => leaf("FollowRobot", vec![]),
        Action::FollowHuman(id) => leaf("FollowHuman", vec![format!("target_id={}", id.number())]),
        Action::RunAway => leaf("RunAwayFromRobot", vec![]),
        Action::GiveWay => leaf("GiveWaytoRobot", vec![]),
        Action::Block => leaf("BlockRobot", vec![]),
        Action::LookAtRobot => leaf("LookAtRobot", vec![]),
        Action::Approach => leaf("ApproachRobot", vec![]),
        Action::StandStill => leaf("StandStill", vec![]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_node_that_authors_are_told_of_is_in_the_catalog() {
        let text = table(true);
        for tag in TAGS {
            assert!(sheet(tag).is_some() && text.contains(&format!("- {tag} (")), "{tag}");
        }
        assert!(text.contains("agent_id={id}") && !table(false).contains("agent_id"));
    }

    #[test]
    fn objects_become_the_same_tree_as_rules() {
        let rules: Vec<socrates_model::Rule> = serde_json::from_value(json!([
            {"when": [{"robot_near": 2.0}, {"robot_says": "PROCEED"}], "act": "give_way", "for_s": 4.0, "gesture": "WAIT"},
            {"when": [{"human_says": ["human_2", "WAIT"]}], "act": {"follow_human": "human_2"}, "latched": true},
        ]))
        .unwrap();
        let human = HumanId::new(1);
        let ours = socrates_bt::Tree::parse(&xml(human, &of_rules(&rules), "$").unwrap()).unwrap();
        let compiled = socrates_bt::Tree::parse(&socrates_bt::compile(human, &rules).unwrap()).unwrap();
        assert_eq!(ours.conditions(), compiled.conditions());
        assert_eq!(ours.actions(), compiled.actions());
        assert_eq!(ours.gestures_made(), compiled.gestures_made());
    }

    #[test]
    fn what_is_no_tree_is_named_with_its_place_and_nothing_is_smuggled_in() {
        let human = HumanId::new(1);
        let wrong = json!({"node": "Sequence", "children": [{"node": "a b"}]});
        assert_eq!(xml(human, &wrong, "$.tree").unwrap_err()[0].at, "$.tree.children[0]");
        let mut deep = json!({"node": "Inverter"});
        for _ in 0..60 {
            deep = json!({"node": "Inverter", "children": [deep]});
        }
        assert!(xml(human, &deep, "$").unwrap_err()[0].message.contains("24 deep"));
        let sly = json!({"node": "RobotSays", "ports": ["message=1\"/><include path=\"x"]});
        let text = xml(human, &sly, "$").unwrap();
        assert!(!text.contains("<include path=\"x"), "{text}");
    }
}
