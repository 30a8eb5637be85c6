//! Rules that were refused, or did not work: what the author writes instead.

use socrates_model::rule::RobotDo;
use socrates_model::{Action, AgentId, Fault, FaultCode, HumanProposal, Proposal, Rule, Trigger};

/// A trigger that never fired gets so much more reach, one that fired too early so much less.
const MORE: f64 = 1.5;
const LESS: f64 = 0.7;
/// Distances of triggers, m, and durations of rules, s, that trees take.
const REACH_M: (f64, f64) = (0.5, 12.0);
const LASTS_S: (f64, f64) = (1.0, 60.0);
/// Where nobody makes the gesture that a rule waits for, the robot's nearness does, m.
const NEAR_M: f64 = 3.0;
/// A gesture is shown so long, and somebody stands still so long, where the rule does not say, s.
const SHOWN_S: f64 = 4.0;
const STILL_S: f64 = 8.0;

/// The rules of a human, changed by what was wrong with its last tree. Faults that speak of others change nothing.
pub(crate) fn rules(human: &HumanProposal, proposal: &Proposal, feedback: &[Fault]) -> Vec<Rule> {
    let told = |codes: &[FaultCode]| {
        let own = |fault: &Fault| fault.at.names(AgentId::Human(human.id));
        feedback.iter().any(|fault| codes.contains(&fault.code) && own(fault))
    };
    let mut rules = human.rules.clone();
    if told(&[FaultCode::DNoTrig, FaultCode::DNoGest]) {
        rules = rules.iter().map(|rule| scaled(rule, MORE)).collect();
    } else if told(&[FaultCode::DEarly]) {
        rules = rules.iter().map(|rule| scaled(rule, LESS)).collect();
    }
    if told(&[FaultCode::BHear, FaultCode::BCode]) {
        for trigger in rules.iter_mut().flat_map(|rule| &mut rule.when) {
            if !is_made(trigger, proposal) {
                *trigger = Trigger::RobotNear(NEAR_M);
            }
        }
    }
    if told(&[FaultCode::BRange]) {
        rules = rules.iter().map(|rule| scaled(rule, 1.0)).collect();
        for secs in rules.iter_mut().filter_map(|rule| rule.for_s.as_mut()) {
            *secs = secs.clamp(LASTS_S.0, LASTS_S.1);
        }
    }
    if told(&[FaultCode::BLatch]) {
        for rule in rules.iter_mut().filter(|rule| rule.gesture.is_some()) {
            rule.for_s.get_or_insert(SHOWN_S);
        }
    }
    if told(&[FaultCode::BStill]) {
        for rule in rules.iter_mut().filter(|rule| rule.act == Action::StandStill) {
            rule.for_s.get_or_insert(STILL_S);
        }
    }
    if told(&[FaultCode::BDead, FaultCode::BContra, FaultCode::BMove2]) {
        // What never ends comes last, else nothing behind it is ever done.
        rules.sort_by_key(|rule| rule.for_s.is_none());
    }
    if told(&[FaultCode::BContra, FaultCode::BMove2]) {
        let mut seen: Vec<Vec<Trigger>> = Vec::new();
        rules.retain(|rule| {
            let new = !seen.contains(&rule.when);
            seen.push(rule.when.clone());
            new
        });
    }
    rules
}

/// Whether somebody makes the gesture that a trigger waits for; other triggers wait for none.
fn is_made(trigger: &Trigger, proposal: &Proposal) -> bool {
    match trigger.awaits() {
        Some((AgentId::Robot, gesture)) => proposal.robot.script.iter().any(|line| line.act == RobotDo::Say(gesture)),
        Some((AgentId::Human(who), gesture)) => {
            proposal.human(who).is_some_and(|human| human.rules.iter().any(|rule| rule.gesture == Some(gesture)))
        }
        None => true,
    }
}

fn scaled(rule: &Rule, scale: f64) -> Rule {
    let reach = |m: f64| (libm::round(m * scale * 10.0) / 10.0).clamp(REACH_M.0, REACH_M.1);
    let when = rule.when.iter().cloned().map(|trigger| match trigger.distance_m() {
        Some(m) => trigger.at_distance(reach(m)),
        None => trigger,
    });
    // Running away from afar would end the meeting before it began.
    let flees = rule.act == Action::RunAway && scale > 1.0;
    if flees { rule.clone() } else { Rule { when: when.collect(), ..rule.clone() } }
}
