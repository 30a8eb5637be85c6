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

use socrates_model::{Fault, FaultCode, Gesture, HumanId, Rule};

use crate::check::{CheckContext, check};
use crate::rules;
use crate::spec::TreeSpec;
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
    let xml = TreeSpec::of_rules(rules).xml(human);
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
        if let Some(gesture) = rule.gesture {
            sentence.push_str(&format!(" and says {gesture}"));
        }
        if let Some(secs) = rule.for_s {
            sentence.push_str(&format!(" for {secs} s"));
        }
        if !rule.until.is_empty() {
            sentence.push_str(&format!(", until {}", rules::until(rule)));
        }
        if rule.latched && rule.step.is_none() && rules::asked(rule).next().is_some() {
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
