//! A tree as it is written down: one description, printed as XML and as JSON.
//!
//! ```text
//! rules ──► TreeSpec ──► XML (version 3), which is parsed, checked and ticked
//! JSON  ──►    │
//!              └──────► JSON {"node", "ports", "children"}, as authors read and write it
//! ```
//!
//! A description holds what its writer decides. Ports that follow from the place (`agent_id`, `time_step`) are filled
//! in where the XML is printed.

use quick_xml::escape::escape;
use serde_json::{Value, json};
use socrates_model::{Action, Gesture, HumanId, Rule, Trigger};

use crate::parse::REGULAR_NAV_PATH;
use crate::rules;
use crate::sheet::{NodeSheet, PortKind, PortSheet};

/// The word for the block that walks along the path.
pub const WALK: &str = "Walk";

/// One node of a description with everything below it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NodeSpec {
    /// Tag of the node as the catalog spells it, or [`WALK`]; letters and digits.
    tag: String,
    /// Name in the XML, which explains and changes nothing; not in the JSON.
    pub name: Option<String>,
    /// Ports with their values; letters, digits and `_` in the names.
    pub ports: Vec<(String, String)>,
    /// Children in order.
    pub children: Vec<Self>,
}

impl NodeSpec {
    /// A node without ports and children.
    #[must_use]
    pub fn new(tag: &str) -> Self {
        Self { tag: tag.to_owned(), name: None, ports: Vec::new(), children: Vec::new() }
    }

    /// The same with one more port.
    #[must_use]
    pub fn port(mut self, name: &str, value: impl ToString) -> Self {
        self.ports.push((name.to_owned(), value.to_string()));
        self
    }

    /// A node with a name and children.
    fn of(tag: &str, name: &str, children: Vec<Self>) -> Self {
        Self { name: (!name.is_empty()).then(|| name.to_owned()), children, ..Self::new(tag) }
    }

    fn json(&self) -> Value {
        let ports: Vec<String> = self.ports.iter().map(|(name, value)| format!("{name}={value}")).collect();
        let children: Vec<Value> = self.children.iter().map(Self::json).collect();
        json!({"node": self.tag, "ports": ports, "children": children})
    }

    /// Writes the element; in a sequence the block of [`WALK`] needs no sequence of its own.
    fn xml(&self, depth: usize, in_sequence: bool, text: &mut String) {
        let indent = "  ".repeat(depth);
        if self.tag == WALK {
            return walk(depth, in_sequence, text);
        }
        text.push_str(&format!("{indent}<{}", self.tag));
        if let Some(name) = &self.name {
            text.push_str(&format!(" name=\"{}\"", escape(name.as_str())));
        }
        for (name, value) in self.attributes() {
            text.push_str(&format!(" {name}=\"{}\"", escape(value)));
        }
        if self.children.is_empty() {
            text.push_str("/>\n");
            return;
        }
        text.push_str(">\n");
        for child in &self.children {
            child.xml(depth + 1, self.tag == "Sequence", text);
        }
        text.push_str(&format!("{indent}</{}>\n", self.tag));
    }

    /// Ports in the order of the catalog with those that follow from the place, then those the catalog does not have.
    fn attributes(&self) -> Vec<(&str, &str)> {
        let ports = sheet(&self.tag).map(|sheet| sheet.ports).unwrap_or_default();
        let mut found: Vec<(&str, &str)> = Vec::new();
        for port in ports {
            let before = found.len();
            let given = self.ports.iter().filter(|(name, _)| name == port.name);
            found.extend(given.map(|(name, value)| (name.as_str(), value.as_str())));
            if found.len() == before {
                found.extend(filled_in(&self.tag, port).map(|value| (port.name, value)));
            }
        }
        let other = self.ports.iter().filter(|(name, _)| !ports.iter().any(|port| port.name == name));
        found.extend(other.map(|(name, value)| (name.as_str(), value.as_str())));
        found
    }
}

fn sheet(tag: &str) -> Option<&'static NodeSheet> {
    crate::nodes::CATALOG.iter().chain(crate::nodes::STEPS).find(|sheet| sheet.is_called(tag)).copied()
}

/// The value of a port that its writer leaves out. The timer of a reaction runs once and counts in ticks.
fn filled_in(tag: &str, port: &PortSheet) -> Option<&'static str> {
    match (port.kind, tag, port.name) {
        (PortKind::Own, ..) => Some("{id}"),
        (PortKind::Step, ..) => Some("{dt}"),
        (_, "TimeExpiredCondition", "only_once") => Some("true"),
        _ => None,
    }
}

/// The block that walks along the path; version 3 hands entries over by name, hence the two copies.
fn walk(depth: usize, in_sequence: bool, text: &mut String) {
    let (outer, inner) = if in_sequence { (None, depth) } else { (Some("  ".repeat(depth)), depth + 1) };
    let indent = "  ".repeat(inner);
    if let Some(outer) = &outer {
        text.push_str(&format!("{outer}<Sequence name=\"walk\">\n"));
    }
    for line in [
        "<SetBlackboard output_key=\"agentid\" value=\"{id}\"/>",
        "<SetBlackboard output_key=\"timestep\" value=\"{dt}\"/>",
        "<SubTree ID=\"RegularNavTree\" id=\"agentid\" dt=\"timestep\"/>",
    ] {
        text.push_str(&format!("{indent}{line}\n"));
    }
    if let Some(outer) = &outer {
        text.push_str(&format!("{outer}</Sequence>\n"));
    }
}

/// A whole tree of one human.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TreeSpec {
    /// The root.
    pub root: NodeSpec,
}

impl TreeSpec {
    /// The tree of a rule list. Earlier rules win; what follows the last rule is always the walk along the path.
    ///
    /// Conditions come before the timer and the timer before the motion, so that the timer counts while the motion is
    /// done; one motion per rule; every rule without a gesture takes an earlier one back.
    #[must_use]
    pub fn of_rules(list: &[Rule]) -> Self {
        let speaks = list.iter().any(|rule| rule.gesture.is_some());
        let mut branches: Vec<NodeSpec> = list
            .iter()
            .enumerate()
            .map(|(place, rule)| NodeSpec::of("Sequence", &format!("rule_{}", place + 1), steps(rule, speaks)))
            .collect();
        branches.push(if speaks {
            NodeSpec::of("Sequence", "walk", vec![says(None), NodeSpec::new(WALK)])
        } else {
            NodeSpec::new(WALK)
        });
        Self { root: NodeSpec::of("Fallback", "reactions", branches) }
    }

    /// The tree as a document of version 3.
    #[must_use]
    pub fn xml(&self, human: HumanId) -> String {
        let mut text = format!(
            "<root main_tree_to_execute=\"{human}\">\n  <include path=\"{REGULAR_NAV_PATH}\"/>\n  <BehaviorTree ID=\"{human}\">\n"
        );
        self.root.xml(2, false, &mut text);
        text.push_str("  </BehaviorTree>\n</root>\n");
        text
    }

    /// The tree as objects `{"node": …, "ports": ["name=value"], "children": […]}`.
    #[must_use]
    pub fn json(&self) -> Value {
        self.root.json()
    }
}

fn steps(rule: &Rule, speaks: bool) -> Vec<NodeSpec> {
    let mut steps: Vec<NodeSpec> = rules::asked(rule).filter_map(condition).collect();
    if rule.latched && !steps.is_empty() {
        steps = vec![NodeSpec::of("Latch", "", vec![NodeSpec::of("Sequence", "triggers", steps)])];
    }
    if let Some(end) = end(rule) {
        steps.push(NodeSpec::of("Inverter", "", vec![end]));
    }
    if speaks {
        steps.push(match (rule.gesture, rule.to) {
            (Some(gesture), Some(to)) => {
                NodeSpec::new("MakeGestureTo").port("message", gesture.code()).port("to", to.number())
            }
            (gesture, _) => says(gesture),
        });
    }
    steps.push(motion(&rule.act));
    steps
}

/// What ends a rule: its time, and for a step what it waits for; a step is then over for good.
fn end(rule: &Rule) -> Option<NodeSpec> {
    let timer = rule.for_s.map(|secs| NodeSpec::new("TimeExpiredCondition").port("seconds", secs));
    let Some(number) = rule.step else { return timer };
    // Somebody who goes back, or to another place, is at the end of their path before.
    let leads = matches!(rule.act, Action::TurnBack | Action::GoTo(_));
    // A robot that passed before the step began does not end it.
    let ends = |trigger: &Trigger| {
        if leads && *trigger == Trigger::GoalReached {
            Some(NodeSpec::new("HasArrived"))
        } else if *trigger == Trigger::RobotPassed {
            Some(NodeSpec::new("DoesRobotPass"))
        } else {
            condition(trigger)
        }
    };
    let mut until: Vec<NodeSpec> = rule.until.iter().filter_map(ends).collect();
    let until = if until.len() > 1 { Some(NodeSpec::of("Sequence", "until", until)) } else { until.pop() };
    let mut ends: Vec<NodeSpec> = until.into_iter().chain(timer).collect();
    let end = if ends.len() > 1 { Some(NodeSpec::of("Fallback", "ends", ends)) } else { ends.pop() };
    end.map(|end| NodeSpec {
        ports: vec![("step".to_owned(), number.to_string())],
        ..NodeSpec::of("EndStep", "", vec![end])
    })
}

/// The node that makes a gesture, or takes an earlier one back.
fn says(gesture: Option<Gesture>) -> NodeSpec {
    NodeSpec::new("MakeGesture").port("message", Gesture::code_of(gesture))
}

/// The node of a trigger. Not moving would also hold where there is no robot, hence `IsRobotStopped`.
fn condition(trigger: &Trigger) -> Option<NodeSpec> {
    let near = |tag: &str, m: f64| NodeSpec::new(tag).port("distance", m);
    Some(match trigger {
        Trigger::Always => return None,
        Trigger::RobotVisible(m) => near("IsRobotVisible", *m),
        Trigger::RobotNear(m) => near("IsRobotNearby", *m),
        Trigger::RobotBlocking(m) => near("IsRobotBlocking", *m),
        Trigger::RobotMoving => NodeSpec::new("RobotMoved"),
        Trigger::RobotStopped => NodeSpec::new("IsRobotStopped"),
        Trigger::RobotPassed => NodeSpec::new("HasRobotPassed"),
        Trigger::RobotSays(gesture) => NodeSpec::new("RobotSays").port("message", gesture.code()),
        Trigger::HumanSays(id, gesture) => {
            NodeSpec::new("HumanSays").port("target_id", id.number()).port("message", gesture.code())
        }
        Trigger::GoalReached => NodeSpec::new("IsPathDone"),
        Trigger::AtEncounter => NodeSpec::new("IsAtEncounter"),
        Trigger::AfterSecs(secs) => NodeSpec::new("HasTimePassed").port("seconds", secs),
        Trigger::StoppedFor(secs) => NodeSpec::new("HasRobotStoodFor").port("seconds", secs),
        Trigger::Did(id, step) => NodeSpec::new("HasStepEnded").port("target_id", id.number()).port("step", step),
        Trigger::Done(id) => NodeSpec::new("IsDone").port("target_id", id.number()),
    })
}

fn motion(action: &Action) -> NodeSpec {
    let node = NodeSpec::new(if *action == Action::Navigate { WALK } else { action.row().leaf });
    if let Some(id) = action.names() {
        node.port("target_id", id.number())
    } else if let Action::GoTo(to) = action {
        let nodes: Vec<&str> = to.nodes.iter().map(socrates_model::NodeId::as_str).collect();
        node.port("place", &to.place).port("nodes", nodes.join(","))
    } else if let Action::ChangePace(mps) = action {
        node.port("speed", mps)
    } else if let Action::ApproachTo(m) = action {
        node.port("distance", m)
    } else {
        node
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ports_stand_in_the_order_of_the_catalog_and_what_follows_from_the_place_is_filled_in() {
        let node = NodeSpec::new("HumanSays").port("message", 2).port("target_id", 3).port("other", "a<b\"");
        let mut text = String::new();
        node.xml(0, false, &mut text);
        assert_eq!(text, "<HumanSays agent_id=\"{id}\" target_id=\"3\" message=\"2\" other=\"a&lt;b&quot;\"/>\n");
        assert_eq!(node.json()["ports"], json!(["message=2", "target_id=3", "other=a<b\""]));
    }

    #[test]
    fn a_port_given_twice_stays_visible_to_the_parser() {
        let node = NodeSpec::new("StandStill").port("agent_id", "{id}").port("agent_id", "4");
        let mut text = String::new();
        node.xml(0, false, &mut text);
        assert_eq!(text, "<StandStill agent_id=\"{id}\" agent_id=\"4\"/>\n");
    }
}
