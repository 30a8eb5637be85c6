//! The stage files of the published SocRATES tool: scenario, trajectory, behavior trees, combined.
//!
//! | file | content |
//! |---|---|
//! | scenario | `{scenariodescription, humanbehavior: {name: text}, num_humans}` |
//! | trajectory | `{groupids: {name: int}, trajectories: {name: [node], robot: [node]}, interaction_points: {name: node}}` |
//! | bt | `{name: xml}` |
//! | combined | `{scenario, groupids, trajectories, interaction_points, behavior_trees}` |
//!
//! In a combined file `scenario` may be an object or a JSON string; both are read, the object is written.

use std::collections::BTreeMap;

use serde_json::{Map, Value, json};
use socrates_model::clause::{Clause, ClauseRole, Predicate};
use socrates_model::{
    Behaviors, Encounter, FORMAT, GroupId, GroupProposal, HumanBehavior, HumanId, HumanProposal, NodeId, Paths,
    PlaceClass, Proposal, Relation, RobotProposal,
};

/// Why a file of the published tool cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum SocratesJsonError {
    /// Not JSON.
    #[error("line {line}, column {column}: the file is not JSON")]
    Json {
        /// Line from 1.
        line: usize,
        /// Column from 1.
        column: usize,
        /// Reason.
        #[source]
        source: serde_json::Error,
    },
    /// None of the four forms.
    #[error(
        "the file has the keys `{found}`; allowed: a scenario (`scenariodescription`), a trajectory (`trajectories`), trees (`human1`: xml), or a combined file"
    )]
    Form {
        /// Keys that were found.
        found: String,
    },
    /// A value that cannot be taken.
    #[error("`{at}` is {found}; allowed: {allowed}")]
    Value {
        /// Key path.
        at: String,
        /// What was found.
        found: String,
        /// What would be taken.
        allowed: &'static str,
    },
}

/// What a file held.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Imported {
    /// From a scenario or combined file.
    pub proposal: Option<Proposal>,
    /// From a trajectory or combined file.
    pub paths: Option<Paths>,
    /// From a tree or combined file.
    pub behaviors: Option<Behaviors>,
}

/// The key the published tool uses for a human: lower case, no blanks.
fn key(id: HumanId) -> String {
    format!("human{}", id.number())
}

/// The scenario file.
#[must_use]
pub fn scenario(proposal: &Proposal) -> Value {
    let behavior: Map<String, Value> =
        proposal.humans.iter().map(|human| (key(human.id), json!(human.behavior))).collect();
    json!({
        "scenariodescription": proposal.description,
        "humanbehavior": behavior,
        "num_humans": proposal.humans.len(),
        "expected_robot_behavior": proposal.robot.expected_behavior,
    })
}

/// The trajectory file.
#[must_use]
pub fn trajectory(proposal: &Proposal, paths: &Paths) -> Value {
    let groups: Map<String, Value> = proposal
        .humans
        .iter()
        .map(|human| (key(human.id), json!(human.group.map_or(-1, |group| i64::from(group.0)))))
        .collect();
    let mut trajectories: Map<String, Value> =
        paths.humans.iter().map(|(id, nodes)| (key(*id), json!(nodes))).collect();
    trajectories.insert("robot".to_owned(), json!(paths.robot));
    // The published format has one point a human: of somebody who meets the robot several times, the first.
    let points: Map<String, Value> =
        paths.encounters.iter().rev().map(|encounter| (key(encounter.human), json!(encounter.node))).collect();
    json!({ "groupids": groups, "trajectories": trajectories, "interaction_points": points })
}

/// The tree file.
#[must_use]
pub fn trees(behaviors: &Behaviors) -> Value {
    let trees: Map<String, Value> = behaviors.humans.iter().map(|(id, human)| (key(*id), json!(human.tree))).collect();
    Value::Object(trees)
}

/// The combined file.
#[must_use]
pub fn combined(proposal: &Proposal, paths: &Paths, behaviors: &Behaviors) -> Value {
    let mut all = trajectory(proposal, paths);
    if let Some(map) = all.as_object_mut() {
        map.insert("scenario".to_owned(), scenario(proposal));
        map.insert("behavior_trees".to_owned(), trees(behaviors));
    }
    all
}

/// Reads any of the four files.
///
/// # Errors
/// [`SocratesJsonError`] with the place, the value and what would be taken.
pub fn read(text: &str) -> Result<Imported, SocratesJsonError> {
    let json = |text: &str| {
        serde_json::from_str::<Value>(text).map_err(|source| SocratesJsonError::Json {
            line: source.line(),
            column: source.column(),
            source,
        })
    };
    let value = json(text)?;
    let map = value.as_object().ok_or_else(|| bad("(root)", &value, "an object"))?;
    let mut imported = Imported::default();
    let scenario = match map.get("scenario") {
        Some(Value::String(inner)) => Some(json(inner)?),
        Some(other) => Some(other.clone()),
        None => map.contains_key("scenariodescription").then(|| value.clone()),
    };
    if map.contains_key("trajectories") {
        imported.paths = Some(read_paths(map)?);
    }
    if let Some(trees) = map.get("behavior_trees") {
        imported.behaviors = Some(read_trees(trees)?);
    } else if scenario.is_none() && imported.paths.is_none() && !map.is_empty() {
        let is_tree = |(name, xml): (&String, &Value)| name.parse::<HumanId>().is_ok() && xml.is_string();
        if map.iter().all(is_tree) {
            imported.behaviors = Some(read_trees(&value)?);
        }
    }
    if let Some(scenario) = scenario {
        imported.proposal = Some(read_scenario(&scenario, map.get("groupids"), imported.paths.as_ref())?);
    }
    if imported == Imported::default() {
        let found = map.keys().cloned().collect::<Vec<_>>().join(", ");
        return Err(SocratesJsonError::Form { found });
    }
    Ok(imported)
}

fn bad(at: &str, value: &Value, allowed: &'static str) -> SocratesJsonError {
    let mut found = value.to_string();
    if found.chars().count() > 60 {
        found = found.chars().take(60).chain(['…']).collect();
    }
    SocratesJsonError::Value { at: at.to_owned(), found: format!("`{found}`"), allowed }
}

fn human(at: &str, name: &str) -> Result<HumanId, SocratesJsonError> {
    name.parse().map_err(|_bad| bad(at, &json!(name), "human1, human2, …"))
}

fn nodes(at: &str, value: &Value) -> Result<Vec<NodeId>, SocratesJsonError> {
    let list = value.as_array().ok_or_else(|| bad(at, value, "a list of node ids"))?;
    list.iter()
        .map(|node| {
            let text = node.as_str().ok_or_else(|| bad(at, node, "a node id as text"))?;
            NodeId::new(text).map_err(|_bad| bad(at, node, "a node id without blanks"))
        })
        .collect()
}

fn read_paths(map: &Map<String, Value>) -> Result<Paths, SocratesJsonError> {
    let trajectories = map
        .get("trajectories")
        .and_then(Value::as_object)
        .ok_or_else(|| bad("trajectories", map.get("trajectories").unwrap_or(&Value::Null), "an object"))?;
    let mut robot = Vec::new();
    let mut humans = BTreeMap::new();
    for (name, list) in trajectories {
        let at = format!("trajectories.{name}");
        if name == "robot" {
            robot = nodes(&at, list)?;
        } else {
            humans.insert(human(&at, name)?, nodes(&at, list)?);
        }
    }
    let mut encounters = Vec::new();
    for (name, node) in map.get("interaction_points").and_then(Value::as_object).into_iter().flatten() {
        let at = format!("interaction_points.{name}");
        let list = nodes(&at, &json!([node]))?;
        encounters.extend(
            list.into_iter()
                .map(|node| (name, node))
                .map(|(name, node)| human(&at, name).map(|human| Encounter { human, node })),
        );
    }
    let mut encounters: Vec<Encounter> = encounters.into_iter().collect::<Result<_, _>>()?;
    // The order in which the robot comes to them.
    encounters.sort_by_key(|encounter| robot.iter().position(|node| *node == encounter.node));
    Ok(Paths { format: FORMAT, robot, humans, encounters, reasoning: String::new(), author: "socrates-json".into() })
}

fn read_trees(value: &Value) -> Result<Behaviors, SocratesJsonError> {
    let map = value.as_object().ok_or_else(|| bad("behavior_trees", value, "an object of trees by human"))?;
    let mut humans = BTreeMap::new();
    for (name, tree) in map {
        let at = format!("behavior_trees.{name}");
        let tree = tree.as_str().ok_or_else(|| bad(&at, tree, "XML as text"))?.to_owned();
        humans.insert(human(&at, name)?, HumanBehavior { tree, description: String::new() });
    }
    Ok(Behaviors { format: FORMAT, humans, author: "socrates-json".into() })
}

fn read_scenario(value: &Value, groups: Option<&Value>, paths: Option<&Paths>) -> Result<Proposal, SocratesJsonError> {
    let text = |name: &str| value.get(name).and_then(Value::as_str).unwrap_or_default().to_owned();
    let behaviors = value
        .get("humanbehavior")
        .and_then(Value::as_object)
        .ok_or_else(|| bad("humanbehavior", value.get("humanbehavior").unwrap_or(&Value::Null), "texts by human"))?;
    let mut humans = Vec::new();
    let mut members: BTreeMap<GroupId, Vec<HumanId>> = BTreeMap::new();
    for (name, behavior) in behaviors {
        let at = format!("humanbehavior.{name}");
        let id = human(&at, name)?;
        let behavior = behavior.as_str().ok_or_else(|| bad(&at, behavior, "text"))?.to_owned();
        let group = groups
            .and_then(|groups| groups.get(key(id)).or_else(|| groups.get(id.to_string())))
            .and_then(Value::as_i64)
            .and_then(|number| u32::try_from(number).ok())
            .map(GroupId);
        if let Some(group) = group {
            members.entry(group).or_default().push(id);
        }
        humans.push(HumanProposal {
            id,
            role: "person".to_owned(),
            behavior,
            relation: relation(paths, id),
            side: None,
            facing: None,
            rules: Vec::new(),
            group,
            speed_mps: None,
            start: None,
            goal: None,
        });
    }
    humans.sort_by_key(|human| human.id);
    // A group of one is no group; the published tool writes such ids.
    members.retain(|_, list| list.len() > 1);
    for human in &mut humans {
        human.group = human.group.filter(|group| members.contains_key(group));
    }
    let standing = |list: &[HumanId]| list.iter().all(|id| relation(paths, *id) == Relation::Static);
    let groups: Vec<GroupProposal> =
        members.into_iter().map(|(id, list)| GroupProposal { id, standing: standing(&list), members: list }).collect();
    let expected = [text("expected_robot_behavior"), text("expectedrobotbehavior")].concat();
    Ok(Proposal {
        format: FORMAT,
        title: "imported scenario".to_owned(),
        description: text("scenariodescription"),
        pattern: "free".to_owned(),
        place: PlaceClass::Plain,
        expected_events: clauses(&humans),
        humans,
        groups,
        robot: RobotProposal {
            task: "as imported".to_owned(),
            start: None,
            goal: None,
            script: Vec::new(),
            expected_behavior: if expected.is_empty() {
                "Reach the goal and keep clear of people.".to_owned()
            } else {
                expected
            },
        },
        not_understood: Vec::new(),
        notes: vec!["imported; clauses are made from the paths alone".to_owned()],
        author: "socrates-json".into(),
    })
}

/// How a human stands to the robot's way, as far as node order tells.
fn relation(paths: Option<&Paths>, id: HumanId) -> Relation {
    let Some(paths) = paths else { return Relation::Frontal };
    let Some(own) = paths.humans.get(&id).filter(|nodes| nodes.len() > 1) else { return Relation::Static };
    let ways = |nodes: &[NodeId]| -> Vec<(NodeId, NodeId)> {
        nodes
            .windows(2)
            .filter_map(|pair| if let [a, b] = pair { Some((a.clone(), b.clone())) } else { None })
            .collect()
    };
    let robot = ways(&paths.robot);
    let mine = ways(own);
    if mine.iter().any(|(a, b)| robot.contains(&(b.clone(), a.clone()))) {
        Relation::Frontal
    } else if let Some(first) = mine.iter().position(|way| robot.contains(way)) {
        let robot_first = mine.get(first).and_then(|way| robot.iter().position(|other| other == way)).unwrap_or(0);
        if first > robot_first { Relation::Behind } else { Relation::Ahead }
    } else {
        Relation::Crossing
    }
}

fn clauses(humans: &[HumanProposal]) -> Vec<Clause> {
    let mut number = 0;
    let mut clause = |text: String, role: ClauseRole, predicate: Predicate| {
        number += 1;
        Clause { id: format!("c{number}"), text, role, must: true, source: String::new(), predicate }
    };
    let count = u32::try_from(humans.len()).unwrap_or(u32::MAX);
    let mut all = vec![
        clause(format!("there are {count} humans"), ClauseRole::Setup, Predicate::Humans { count }),
        clause("nobody goes through walls or people".to_owned(), ClauseRole::Setup, Predicate::Plausible),
    ];
    for human in humans {
        let text = format!("{} and the robot meet", human.id);
        all.push(clause(text, ClauseRole::Setup, Predicate::Meets { human: human.id, within_m: 3.0 }));
    }
    all.push(clause("the robot arrives".to_owned(), ClauseRole::Outcome, Predicate::RobotArrives));
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    const COMBINED: &str = r#"{
        "scenario": "{\"scenariodescription\": \"Two meet.\", \"humanbehavior\": {\"Human 1\": \"walks\", \"Human 2\": \"stands\"}}",
        "groupids": {"human1": -1, "human2": 4},
        "trajectories": {"robot": ["a", "b", "c"], "human1": ["c", "b", "a"], "human2": ["b"]},
        "interaction_points": {"human1": "b", "human2": "b"},
        "behavior_trees": {"human1": "<root/>", "human2": "<root/>"}
    }"#;

    #[test]
    fn a_combined_file_comes_back_as_it_was() {
        let first = read(COMBINED).unwrap();
        let (proposal, paths, behaviors) =
            (first.proposal.clone().unwrap(), first.paths.clone().unwrap(), first.behaviors.clone().unwrap());
        assert_eq!(proposal.humans[0].relation, Relation::Frontal);
        assert_eq!(proposal.humans[1].relation, Relation::Static);
        assert!(proposal.groups.is_empty(), "a group of one is no group");
        let again = read(&combined(&proposal, &paths, &behaviors).to_string()).unwrap();
        assert_eq!(again.paths, first.paths);
        assert_eq!(again.behaviors, first.behaviors);
        assert_eq!(again.proposal.unwrap().humans, proposal.humans);
    }

    #[test]
    fn each_stage_file_is_told_by_its_keys() {
        let all = read(COMBINED).unwrap();
        let (proposal, paths) = (all.proposal.unwrap(), all.paths.unwrap());
        assert!(read(&scenario(&proposal).to_string()).unwrap().proposal.is_some());
        assert!(read(&trajectory(&proposal, &paths).to_string()).unwrap().paths.is_some());
        assert!(read(&trees(&all.behaviors.unwrap()).to_string()).unwrap().behaviors.is_some());
    }

    #[test]
    fn wrong_files_are_named_with_place_and_value() {
        assert!(matches!(read("{"), Err(SocratesJsonError::Json { .. })));
        assert!(matches!(read("{\"x\": 1}"), Err(SocratesJsonError::Form { .. })));
        let text = r#"{"trajectories": {"robot": [7]}}"#;
        assert_eq!(read(text).unwrap_err().to_string(), "`trajectories.robot` is `7`; allowed: a node id as text");
    }
}
