//! From a rule list to a tree.
//!
//! ```text
//! Fallback
//!   Sequence rule_1: conditions (under a Latch) · Inverter(timer) · gesture · motion
//!   Sequence rule_2: …
//!   Sequence RegNav: gesture 0 · blackboard · SubTree RegularNavTree
//! ```
//!
//! Conditions always come before the timer and the timer before the motion, so that the timer counts
//! while the motion is done; one motion per rule; every rule without a gesture takes an earlier one back.

use std::collections::BTreeMap;

use socrates_model::{Action, Fault, FaultCode, Gesture, HumanId, Rule, Trigger};

use crate::check::{CheckContext, check};
use crate::parse::REGULAR_NAV_PATH;
use crate::rules;
use crate::tree::Tree;

/// A rule list as a version 3 document. Earlier rules win; what follows the last rule is always the walk
/// along the path. The document passes [`check`] for the same rules.
///
/// # Errors
/// `B-RANGE` and `B-CONTRA` for the rules themselves, `B-DEAD` where a rule can never run because an
/// earlier one covers it or its triggers exclude each other.
pub fn compile(human: HumanId, rules: &[Rule]) -> Result<String, Vec<Fault>> {
    let faults = rules::check(human, rules);
    if !faults.is_empty() {
        return Err(faults);
    }
    let xml = write(human, rules);
    let tree = Tree::parse(&xml)?;
    // Who says what is the business of the joint check; here everybody may say everything.
    let everything = Gesture::ALL.to_vec();
    let human_says: BTreeMap<HumanId, Vec<Gesture>> = tree
        .gestures_awaited()
        .iter()
        .filter_map(|(agent, _)| speaker(*agent))
        .map(|id| (id, everything.clone()))
        .collect();
    let ctx = CheckContext { human, humans: u32::MAX, robot_says: &everything, human_says: &human_says, rules };
    let mut faults = socrates_model::fault::hard(&check(&tree, &ctx));
    // A rule that cannot run does not match either; only the cause is told.
    if faults.iter().any(|fault| fault.code == FaultCode::BDead) {
        faults.retain(|fault| fault.code == FaultCode::BDead);
    }
    if faults.is_empty() { Ok(xml) } else { Err(faults) }
}

fn speaker(agent: socrates_model::AgentId) -> Option<HumanId> {
    match agent {
        socrates_model::AgentId::Human(id) => Some(id),
        socrates_model::AgentId::Robot => None,
    }
}

/// A rule list in words, one sentence a rule.
#[must_use]
pub fn describe(human: HumanId, rules: &[Rule]) -> String {
    let mut sentences: Vec<String> = Vec::new();
    for rule in rules {
        let mut sentence = format!("{}, {human} {}", capital(&rules::when(rule)), rule.act.phrase());
        if let Some(gesture) = said(rule) {
            sentence.push_str(&format!(" and says {gesture}"));
        }
        if let Some(secs) = rule.for_s {
            sentence.push_str(&format!(" for {secs} s"));
        }
        if rule.latched && rules::asked(rule).next().is_some() {
            sentence.push_str(", and goes on when that has passed");
        }
        sentences.push(format!("{sentence}."));
    }
    sentences.push(if rules.is_empty() {
        format!("{} walks along their path.", capital(&human.to_string()))
    } else if rules.iter().any(rules::is_endless) {
        "They do nothing else.".to_owned()
    } else {
        "Otherwise they walk along their path.".to_owned()
    });
    sentences.join(" ")
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

fn said(rule: &Rule) -> Option<Gesture> {
    rule.gesture.filter(|gesture| *gesture != Gesture::None)
}

/// Indented lines of XML.
struct Lines(String);

impl Lines {
    fn add(&mut self, depth: usize, line: &str) {
        self.0.push_str(&"  ".repeat(depth));
        self.0.push_str(line);
        self.0.push('\n');
    }
}

fn write(human: HumanId, rules: &[Rule]) -> String {
    let speaks = rules.iter().any(|rule| said(rule).is_some());
    let mut lines = Lines(String::new());
    lines.add(0, &format!("<root main_tree_to_execute=\"{human}\">"));
    lines.add(1, &format!("<include path=\"{REGULAR_NAV_PATH}\"/>"));
    lines.add(1, &format!("<BehaviorTree ID=\"{human}\">"));
    lines.add(2, "<Fallback name=\"reactions\">");
    for (place, rule) in rules.iter().enumerate() {
        lines.add(3, &format!("<Sequence name=\"rule_{}\">", place + 1));
        conditions(rule, &mut lines);
        if let Some(secs) = rule.for_s {
            lines.add(4, "<Inverter>");
            lines.add(5, &format!("<TimeExpiredCondition seconds=\"{secs}\" ts=\"{{dt}}\" only_once=\"true\"/>"));
            lines.add(4, "</Inverter>");
        }
        if speaks {
            let code = said(rule).unwrap_or_default().code();
            lines.add(4, &format!("<MakeGesture agent_id=\"{{id}}\" message=\"{code}\"/>"));
        }
        if rule.act == Action::Navigate {
            walk(4, &mut lines);
        } else {
            lines.add(4, &motion(&rule.act));
        }
        lines.add(3, "</Sequence>");
    }
    lines.add(3, "<Sequence name=\"walk\">");
    if speaks {
        lines.add(4, "<MakeGesture agent_id=\"{id}\" message=\"0\"/>");
    }
    walk(4, &mut lines);
    lines.add(3, "</Sequence>");
    lines.add(2, "</Fallback>");
    lines.add(1, "</BehaviorTree>");
    lines.add(0, "</root>");
    lines.0
}

/// The block that walks along the path; version 3 hands entries over by name, hence the two copies.
fn walk(depth: usize, lines: &mut Lines) {
    lines.add(depth, "<SetBlackboard output_key=\"agentid\" value=\"{id}\"/>");
    lines.add(depth, "<SetBlackboard output_key=\"timestep\" value=\"{dt}\"/>");
    lines.add(depth, "<SubTree ID=\"RegularNavTree\" id=\"agentid\" dt=\"timestep\"/>");
}

fn conditions(rule: &Rule, lines: &mut Lines) {
    let asked: Vec<Vec<String>> = rules::asked(rule).map(condition).collect();
    let latched = rule.latched && !asked.is_empty();
    let depth = if latched { 6 } else { 4 };
    if latched {
        lines.add(4, "<Latch>");
        lines.add(5, "<Sequence name=\"triggers\">");
    }
    for part in asked.iter().flatten() {
        lines.add(depth, part);
    }
    if latched {
        lines.add(5, "</Sequence>");
        lines.add(4, "</Latch>");
    }
}

/// The node of a trigger. Not moving would also hold where there is no robot, hence `IsRobotStopped`.
fn condition(trigger: &Trigger) -> Vec<String> {
    let near = |tag: &str, m: f64| vec![format!("<{tag} agent_id=\"{{id}}\" distance=\"{m}\"/>")];
    let plain = |tag: &str| vec![format!("<{tag} agent_id=\"{{id}}\"/>")];
    match trigger {
        Trigger::Always => Vec::new(),
        Trigger::RobotVisible(m) => near("IsRobotVisible", *m),
        Trigger::RobotNear(m) => near("IsRobotNearby", *m),
        Trigger::RobotBlocking(m) => near("IsRobotBlocking", *m),
        Trigger::RobotMoving => plain("RobotMoved"),
        Trigger::RobotStopped => plain("IsRobotStopped"),
        Trigger::RobotPassed => plain("HasRobotPassed"),
        Trigger::RobotSays(gesture) => {
            vec![format!("<RobotSays agent_id=\"{{id}}\" message=\"{}\"/>", gesture.code())]
        }
        Trigger::HumanSays(id, gesture) => vec![format!(
            "<HumanSays agent_id=\"{{id}}\" target_id=\"{}\" message=\"{}\"/>",
            id.number(),
            gesture.code()
        )],
        Trigger::GoalReached => plain("IsPathDone"),
        Trigger::AtEncounter => plain("IsAtEncounter"),
        Trigger::AfterSecs(secs) => vec![format!("<HasTimePassed seconds=\"{secs}\"/>")],
    }
}

fn motion(action: &Action) -> String {
    let step = |tag: &str| format!("<{tag} agent_id=\"{{id}}\" time_step=\"{{dt}}\"/>");
    match action {
        Action::Navigate => step("RegularNav"),
        Action::FollowRobot => step("FollowRobot"),
        Action::FollowHuman(id) => {
            format!("<FollowHuman agent_id=\"{{id}}\" target_id=\"{}\" time_step=\"{{dt}}\"/>", id.number())
        }
        Action::RunAway => step("RunAwayFromRobot"),
        Action::GiveWay => step("GiveWaytoRobot"),
        Action::Block => step("BlockRobot"),
        Action::LookAtRobot => "<LookAtRobot agent_id=\"{id}\"/>".to_owned(),
        Action::Approach => step("ApproachRobot"),
        Action::StandStill => "<StandStill agent_id=\"{id}\"/>".to_owned(),
    }
}
