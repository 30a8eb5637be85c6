//! Forms of paths: what is written shorter or safer than a list of nodes is brought back to one.

use serde_json::{Map, Value, json};
use socrates_model::{NodeId, Paths, SceneGraph};

use crate::style::PathsForm;

/// Longest walk that is read, nodes.
const MOST: usize = 200;

/// Brings an answer in any of the forms into the form of nodes; one of nodes passes unchanged.
pub(crate) fn expand(value: &mut Value, graph: &SceneGraph) {
    let Some(members) = value.as_object_mut() else { return };
    if let Some(robot) = members.get_mut("robot") {
        flatten(robot, graph);
    }
    let order: Vec<Value> = members.get("robot").and_then(Value::as_array).cloned().unwrap_or_default();
    let mut met: Vec<(usize, Value)> = Vec::new();
    for (name, human) in members.get_mut("humans").and_then(Value::as_object_mut).into_iter().flatten() {
        // One node, or several where somebody meets the robot more than once.
        let nodes = match human.get("meet") {
            None | Some(Value::Null) => Vec::new(),
            Some(Value::Array(nodes)) => nodes.clone(),
            Some(node) => vec![node.clone()],
        };
        let mut from = 0;
        for node in nodes {
            let step = order.iter().skip(from).position(|other| *other == node).map(|step| step + from);
            from = step.map_or(from, |step| step + 1);
            met.push((step.unwrap_or(usize::MAX), json!({"human": name, "node": node})));
        }
        if human.get("walk").is_some() {
            *human = human.get("walk").cloned().unwrap_or_default();
        }
        flatten(human, graph);
    }
    // In the order in which the robot comes to them.
    met.sort_by_key(|(place, _)| *place);
    if !members.contains_key("encounters") {
        let met: Vec<Value> = met.into_iter().map(|(_, encounter)| encounter).collect();
        members.insert("encounters".to_owned(), Value::Array(met));
    }
}

/// One agent's way as a list of nodes.
fn flatten(way: &mut Value, graph: &SceneGraph) {
    if way.get("at").is_some() {
        *way = walked(way);
    } else if way.get("start").is_some() {
        *way = joined(way, graph);
    }
}

/// `{"at": a, "next": {"at": b, "next": null}}` is `[a, b]`.
fn walked(way: &Value) -> Value {
    let mut nodes = Vec::new();
    let mut step = Some(way);
    while let Some(here) = step.filter(|_| nodes.len() < MOST) {
        let Some(node) = here.get("at") else { break };
        nodes.push(node.clone());
        step = here.get("next").filter(|next| !next.is_null());
    }
    Value::Array(nodes)
}

/// Start, places on the way and goal, joined by shortest ways. A place that cannot be reached stays in the list, so that the
/// checks name it.
fn joined(way: &Value, graph: &SceneGraph) -> Value {
    let stops = [way.get("start")].into_iter().flatten();
    let stops = stops.chain(way.get("via").and_then(Value::as_array).into_iter().flatten()).chain(way.get("goal"));
    let mut nodes: Vec<Value> = Vec::new();
    for stop in stops.filter(|stop| !stop.is_null()) {
        if nodes.last() == Some(stop) {
            continue;
        }
        let between = nodes.last().and_then(|last| shortest(last, stop, graph));
        match between {
            Some(between) => nodes.extend(between.into_iter().skip(1).map(|node| json!(node))),
            None => nodes.push(stop.clone()),
        }
    }
    Value::Array(nodes)
}

fn shortest(from: &Value, to: &Value, graph: &SceneGraph) -> Option<Vec<NodeId>> {
    let id = |value: &Value| NodeId::new(value.as_str()?).ok();
    graph.shortest(&id(from)?, &id(to)?)
}

/// Paths as an answer in one of the forms: as a worked example shows them.
pub(crate) fn written(paths: &Paths, form: PathsForm, graph: &SceneGraph) -> Value {
    let meets: Vec<&NodeId> = paths.encounters.iter().map(|encounter| &encounter.node).collect();
    let mut humans = Map::new();
    for (id, nodes) in &paths.humans {
        let met: Vec<&NodeId> = paths.encounters_of(*id).collect();
        let meet = if met.len() > 1 { json!(met) } else { json!(met.first()) };
        let human = match form {
            PathsForm::Nodes => json!(nodes),
            PathsForm::Walk => json!({"meet": meet, "walk": nested(nodes)}),
            PathsForm::Anchors => {
                let mut anchors = anchors(nodes, &[], graph);
                anchors.insert("meet".to_owned(), meet);
                Value::Object(anchors)
            }
        };
        humans.insert(id.to_string(), human);
    }
    match form {
        PathsForm::Nodes => json!({"analysis": paths.reasoning, "robot": paths.robot, "humans": humans,
            "encounters": paths.encounters}),
        PathsForm::Walk => json!({"analysis": paths.reasoning, "robot": nested(&paths.robot), "humans": humans}),
        PathsForm::Anchors => {
            json!({"analysis": paths.reasoning, "robot": anchors(&paths.robot, &meets, graph), "humans": humans})
        }
    }
}

fn nested(nodes: &[NodeId]) -> Value {
    nodes.iter().rev().fold(Value::Null, |next, node| json!({"at": node, "next": next}))
}

/// The fewest places that bring the same nodes back, and those that have to be named.
fn anchors(nodes: &[NodeId], named: &[&NodeId], graph: &SceneGraph) -> Map<String, Value> {
    let mut via: Vec<&NodeId> = Vec::new();
    let mut from = 0;
    for place in 1..nodes.len().saturating_sub(1) {
        let here = nodes.get(place);
        let straight = nodes
            .get(from)
            .zip(nodes.get(place + 1))
            .is_some_and(|(start, next)| graph.shortest(start, next).as_deref() == nodes.get(from..=place + 1));
        if let Some(node) = here
            && (!straight || named.contains(&node))
        {
            via.push(node);
            from = place;
        }
    }
    let mut members = Map::new();
    members.insert("start".to_owned(), json!(nodes.first()));
    members.insert("via".to_owned(), json!(via));
    members.insert("goal".to_owned(), json!(nodes.last()));
    members
}

/// A grammar (GBNF) of the answer in the form of nodes, in which a node is followed by a neighbor or by nothing: the robot
/// walks 4 to 12 nodes, a human 1 to 12, with at most so many meetings.
#[must_use]
pub(crate) fn grammar(graph: &SceneGraph, humans: &[String], meetings: usize) -> String {
    const ROBOT_LEAST: usize = 4;
    const LONGEST: usize = 12;
    let mut ids: Vec<&NodeId> = graph.nodes().iter().map(|node| &node.id).collect();
    ids.sort();
    let number = |id: &NodeId| ids.iter().position(|other| *other == id);
    let mut text = String::from(
        "root ::= \"{\\\"analysis\\\":\" text \",\\\"robot\\\":[\" robot \"],\\\"humans\\\":{\" humans \"},\\\"encounters\\\":[\" met \"]}\"\n\
         text ::= \"\\\"\" [^\"\\\\\\x00-\\x1f]{0,400} \"\\\"\"\n",
    );
    let one_of =
        |prefix: &str| -> String { (0..ids.len()).map(|k| format!("{prefix}{k}-1")).collect::<Vec<_>>().join(" | ") };
    text.push_str(&format!("robot ::= {}\nhuman ::= {}\n", one_of("r"), one_of("h")));
    let each: Vec<String> = humans.iter().map(|name| format!("\"\\\"{name}\\\":[\" human \"]\"")).collect();
    text.push_str(&format!("humans ::= {}\n", each.join(" \",\" ")));
    let node: Vec<String> = ids.iter().map(|id| format!("\"\\\"{id}\\\"\"")).collect();
    text.push_str(&format!("node ::= {}\n", node.join(" | ")));
    let name: Vec<String> = humans.iter().map(|name| format!("\"\\\"{name}\\\"\"")).collect();
    text.push_str(&format!("name ::= {}\n", name.join(" | ")));
    text.push_str("meeting ::= \"{\\\"human\\\":\" name \",\\\"node\\\":\" node \"}\"\n");
    text.push_str(&format!("met ::= (meeting (\",\" meeting){{0,{}}})?\n", meetings.saturating_sub(1)));
    for (prefix, least) in [("r", ROBOT_LEAST), ("h", 1)] {
        for (k, id) in ids.iter().enumerate() {
            for step in 1..=LONGEST {
                let mut next: Vec<String> = Vec::new();
                if step < LONGEST {
                    let near = graph.neighbors(id).iter().filter_map(number);
                    next.extend(near.map(|other| format!("\",\" {prefix}{other}-{}", step + 1)));
                }
                if step >= least {
                    next.push("\"\"".to_owned());
                }
                text.push_str(&format!("{prefix}{k}-{step} ::= \"\\\"{id}\\\"\" ({})\n", next.join(" | ")));
            }
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::tee_map;

    fn paths() -> Paths {
        serde_json::from_value(json!({"format": 1, "author": "", "reasoning": "r",
            "robot": ["w", "c", "e", "c", "n"], "humans": {"human_1": ["c"], "human_2": ["n", "c"]},
            "encounters": [{"human": "human_1", "node": "c"}]}))
        .unwrap()
    }

    #[test]
    fn every_form_is_read_back_as_the_same_nodes() {
        let graph = tee_map().graph;
        for form in PathsForm::ALL {
            let mut value = written(&paths(), *form, &graph);
            expand(&mut value, &graph);
            let read = json!({"robot": value["robot"], "humans": value["humans"], "encounters": value["encounters"]});
            let whole = serde_json::to_value(paths()).unwrap();
            for member in ["robot", "humans", "encounters"] {
                assert_eq!(read[member], whole[member], "{form} {member}");
            }
        }
    }

    #[test]
    fn anchors_are_few() {
        let value = written(&paths(), PathsForm::Anchors, &tee_map().graph);
        assert_eq!(value["robot"], json!({"start": "w", "via": ["c", "e", "c"], "goal": "n"}));
        assert_eq!(value["humans"]["human_1"], json!({"start": "c", "via": [], "goal": "c", "meet": "c"}));
    }

    #[test]
    fn places_that_cannot_be_reached_are_left_to_the_checks() {
        let mut value = json!({"robot": {"start": "w", "via": ["moon"], "goal": "n"}, "humans": {}});
        expand(&mut value, &tee_map().graph);
        assert_eq!(value["robot"], json!(["w", "moon", "n"]));
    }

    #[test]
    fn somebody_may_meet_the_robot_several_times() {
        let graph = tee_map().graph;
        let mut twice = paths();
        let human = socrates_model::HumanId::new(2);
        let node = twice.encounters[0].node.clone();
        twice.encounters.clear();
        twice.encounters.extend([0, 1].map(|_| socrates_model::Encounter { human, node: node.clone() }));
        for form in PathsForm::ALL {
            let mut value = written(&twice, *form, &graph);
            expand(&mut value, &graph);
            assert_eq!(value["encounters"], json!(twice.encounters), "{form}");
        }
    }

    #[test]
    fn encounters_come_in_the_order_of_the_robots_way() {
        let mut value = json!({"robot": ["w", "c", "n"], "humans": {
            "human_1": {"start": "n", "goal": "n", "meet": "n"}, "human_2": {"start": "c", "goal": "c", "meet": "c"}}});
        expand(&mut value, &tee_map().graph);
        assert_eq!(value["encounters"][0]["human"], "human_2");
    }

    #[test]
    fn the_grammar_lets_only_neighbors_follow() {
        let graph = tee_map().graph;
        let text = grammar(&graph, &["human_1".into(), "human_2".into()], 2);
        // Sorted: c, e, n, w. From `e` one comes to `c` alone, and the robot must not stop yet.
        assert!(text.contains("r1-1 ::= \"\\\"e\\\"\" (\",\" r0-2)\n"), "{text}");
        assert!(text.contains("h1-1 ::= \"\\\"e\\\"\" (\",\" h0-2 | \"\")\n"), "{text}");
        assert!(text.contains("r0-12 ::= \"\\\"c\\\"\" (\"\")\n"), "{text}");
        // Every rule that is used is there.
        for rule in ["robot", "human", "humans", "node", "name", "met", "text", "r3-12", "h2-7"] {
            assert!(text.lines().any(|line| line.starts_with(&format!("{rule} ::="))), "{rule}");
        }
    }
}
