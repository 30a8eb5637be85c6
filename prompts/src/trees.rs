//! Trees as nested objects, as authors write them.

use serde_json::Value;
use socrates_bt::{NodeSheet, NodeSpec, PortKind, TreeSpec, WALK};
use socrates_model::{Fault, FaultCode, Where};

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

/// A tree of objects `{"node": …, "ports": ["name=value"], "children": […]}`.
///
/// # Errors
/// E-SCHEMA with the path of the object that is none, is nested too deep, or has a port that is no pair.
pub(crate) fn read(tree: &Value, path: &str) -> Result<TreeSpec, Vec<Fault>> {
    let mut count = 0;
    let root = node(tree, path, 0, &mut count).map_err(|fault| vec![fault])?;
    Ok(TreeSpec { root })
}

fn node(value: &Value, path: &str, depth: usize, count: &mut usize) -> Result<NodeSpec, Fault> {
    let fault = |why: &str| Fault::new(FaultCode::ESchema, Where::key(path), why);
    *count += 1;
    if depth > DEEPEST || *count > MOST {
        return Err(fault(&format!("expected a tree of at most {MOST} nodes, {DEEPEST} deep")));
    }
    let tag = value.get("node").and_then(Value::as_str);
    let tag = tag.filter(|tag| tag.chars().all(|c| c.is_ascii_alphanumeric()) && !tag.is_empty());
    let tag = tag.ok_or_else(|| fault("expected an object with `node`, the name of a node of the table"))?;
    let mut spec = NodeSpec::new(tag);
    if tag == WALK {
        return Ok(spec);
    }
    for port in value.get("ports").and_then(Value::as_array).into_iter().flatten() {
        let pair = port.as_str().and_then(|port| port.split_once('='));
        let (name, value) = pair.ok_or_else(|| fault(&format!("expected ports as \"name=value\", found `{port}`")))?;
        let name: String = name.trim().chars().filter(|c| c.is_ascii_alphanumeric() || *c == '_').collect();
        spec = spec.port(&name, value);
    }
    let children = value.get("children").and_then(Value::as_array).map(Vec::as_slice).unwrap_or_default();
    for (index, child) in children.iter().enumerate() {
        spec.children.push(node(child, &format!("{path}.children[{index}]"), depth + 1, count)?);
    }
    Ok(spec)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;
    use socrates_model::HumanId;

    fn xml(tree: &Value, path: &str) -> Result<String, Vec<Fault>> {
        read(tree, path).map(|spec| spec.xml(HumanId::new(1)))
    }

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
        let compiled = socrates_bt::compile(human, &rules).unwrap();
        let unnamed = |text: &str| {
            let lines = text.lines().map(|line| line.split_once(" name=").map_or(line, |(start, _)| start));
            lines.map(|line| line.trim_end_matches('>').to_owned()).collect::<Vec<_>>()
        };
        assert_eq!(unnamed(&xml(&TreeSpec::of_rules(&rules).json(), "$").unwrap()), unnamed(&compiled));
    }

    #[test]
    fn what_is_no_tree_is_named_with_its_place_and_nothing_is_smuggled_in() {
        let wrong = json!({"node": "Sequence", "children": [{"node": "a b"}]});
        assert_eq!(xml(&wrong, "$.tree").unwrap_err()[0].at, Where::key("$.tree.children[0]"));
        let mut deep = json!({"node": "Inverter"});
        for _ in 0..60 {
            deep = json!({"node": "Inverter", "children": [deep]});
        }
        assert!(xml(&deep, "$").unwrap_err()[0].message.to_string().contains("24 deep"));
        let sly = json!({"node": "RobotSays", "ports": ["message=1\"/><include path=\"x"]});
        let text = xml(&sly, "$").unwrap();
        assert!(!text.contains("<include path=\"x"), "{text}");
    }
}
