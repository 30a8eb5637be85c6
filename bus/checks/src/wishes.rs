//! What the request asked for, held against the proposal: P-COUNT and P-ROUGH.

use std::collections::BTreeSet;

use socrates_model::{
    AgentId, Fact, FactKind, Fault, FaultCode, Gesture, GroupProposal, HumanId, Predicate, Proposal, Reading, Relation,
    Rule, Trigger, Where,
};

use crate::list;
use crate::proposal::robot_says;

/// A fault per fact of the reading that the proposal drops.
pub(crate) fn check(proposal: &Proposal, reading: &Reading) -> Vec<Fault> {
    reading.facts.iter().filter_map(|fact| missing(fact, proposal)).collect()
}

/// What a proposal lacks of a fact.
pub(crate) fn missing(fact: &Fact, proposal: &Proposal) -> Option<Fault> {
    let quote = if fact.quote.is_empty() { String::new() } else { format!(" (asked for by \"{}\")", fact.quote) };
    if let FactKind::Humans(count) = fact.kind {
        let listed = proposal.humans.len();
        return (listed != count as usize).then(|| {
            Fault::new(FaultCode::PCount, "humans", format!("lists {listed} humans, asked for were {count}{quote}"))
        });
    }
    let (at, message) = rough(&fact.kind, proposal)?;
    Some(Fault::new(FaultCode::PRough, at, format!("{message}{quote}")))
}

/// A place and a message, unless it is as it was asked for.
fn unless(holds: bool, at: impl Into<Where>, message: impl FnOnce() -> String) -> Option<(Where, String)> {
    (!holds).then(|| (at.into(), message()))
}

/// Where a proposal departs from what was asked for, and how.
fn rough(kind: &FactKind, proposal: &Proposal) -> Option<(Where, String)> {
    let asks = |wanted: &dyn Fn(&Predicate) -> bool| proposal.expected_events.iter().any(|one| wanted(&one.predicate));
    let robot = &proposal.robot;
    match kind {
        FactKind::Group { group, members } => {
            let wanted: BTreeSet<HumanId> = members.iter().copied().collect();
            let has = |found: &GroupProposal| found.members.iter().copied().collect::<BTreeSet<_>>() == wanted;
            unless(proposal.groups.iter().any(has), *group, || {
                format!("no group has exactly the members {}", list(&wanted))
            })
        }
        FactKind::Asked { of: Some(AgentId::Human(human)) } | FactKind::Reacts { human, .. }
            if proposal.human(*human).is_none() =>
        {
            Some(((*human).into(), "is missing".to_owned()))
        }
        FactKind::Reacts { human, rule } => {
            let found = proposal.human(*human)?;
            unless(found.rules.iter().any(|other| covers(other, rule)), *human, || {
                format!("has no rule for: {}; its rules: {}", rule.phrase(), rules_in_words(&found.rules))
            })
        }
        FactKind::Relates { human, relation } => {
            let found = proposal.human(*human)?.relation;
            // A human who comes out and crosses the robot's way does both.
            let crosses = |test: &Predicate| matches!(test, Predicate::Crosses { human: who, .. } if who == human);
            let both = (found, *relation) == (Relation::Leaving, Relation::Crossing) && asks(&crosses);
            unless(found == *relation || both, *human, || {
                format!("has the relation `{}`, asked for was `{}`", found.name(), relation.name())
            })
        }
        FactKind::Side { human, side } => unless(proposal.human(*human)?.side == Some(*side), *human, || {
            format!("has not the side `{}`", side.name())
        }),
        FactKind::Facing { human, facing } => {
            unless(proposal.human(*human)?.facing.as_ref() == Some(facing), *human, || {
                format!("does not face {}", facing.phrase())
            })
        }
        FactKind::MeetsTimes { human, times, .. } => {
            let again = |test: &Predicate| matches!(test, Predicate::MeetsAgain { human: who, nth, .. } if who == human && nth == times);
            unless(*times < 2 || asks(&again), *human, || {
                format!("has no `meets_again` clause with nth {times}; asked for were {times} meetings")
            })
        }
        FactKind::Before { first, then, at_door } => {
            let wanted = Predicate::Before { first: *first, then: *then, at_door: *at_door };
            unless(asks(&|test| *test == wanted), *then, || {
                format!("has no `before` clause; asked for was {first} before {then}")
            })
        }
        FactKind::Gestures { human, gesture } => {
            let has = proposal.human(*human)?.rules.iter().any(|rule| rule.gesture == Some(*gesture));
            unless(has, *human, || format!("has no rule with the gesture {gesture}"))
        }
        FactKind::GesturesTo { human, gesture, to } => {
            let fits = |rule: &Rule| rule.gesture == Some(*gesture) && rule.to == Some(*to);
            unless(proposal.human(*human)?.rules.iter().any(fits), *human, || {
                format!("has no rule with the gesture {gesture} to {to}")
            })
        }
        FactKind::Place(class) => {
            let there = |test: &Predicate| matches!(test, Predicate::EncounterAt { place, .. } if place == class);
            unless(proposal.place == *class || asks(&there), "place", || {
                format!("is `{}`, asked for was `{class}`", proposal.place)
            })
        }
        FactKind::RobotSays(gesture) => {
            let said = robot_says(proposal);
            unless(said.contains(gesture), Where::robot("script"), || {
                format!("never says {gesture}; it says {}", list(&said))
            })
        }
        FactKind::Pace { human, mps } => {
            let found = proposal.human(*human)?.speed_mps;
            let told = || found.map_or_else(|| "has no pace".to_owned(), |found| format!("walks at {found} m/s"));
            unless(found == Some(*mps), *human, || format!("{}, asked for were {mps} m/s", told()))
        }
        FactKind::Goal { human, name, .. } => {
            unless(proposal.human(*human)?.goal.is_some(), *human, || format!("does not go to {name}"))
        }
        FactKind::MeetsAt { human, name, .. } => {
            unless(proposal.own_place(*human).is_some(), *human, || format!("does not meet the robot at {name}"))
        }
        FactKind::RobotDoes(line) => unless(robot.script.contains(line), Where::robot("script"), || {
            format!("has no line for: {}", line.phrase())
        }),
        FactKind::RobotStart(class) => {
            unless(robot.start == Some(*class), Where::robot("start"), || format!("is not `{class}`"))
        }
        FactKind::RobotGoal(class) => {
            unless(robot.goal == Some(*class), Where::robot("goal"), || format!("is not `{class}`"))
        }
        FactKind::Pattern(card) => unless(proposal.pattern == *card, "pattern", || {
            format!("is `{}`, asked for was `{card}`", proposal.pattern)
        }),
        // An empty task is P-ROBOT; whether prose means the same as prose is not judged here. Where the robot's way leads by name
        // is written from the facts, or given up with a note. People are counted apart.
        FactKind::RobotTask(_) | FactKind::RobotAt { .. } | FactKind::Humans(_) | FactKind::Asked { .. } => None,
    }
}

/// Whether a rule of the proposal does what was asked: same action, same gestures; distances are the author's.
fn covers(found: &Rule, asked: &Rule) -> bool {
    let heard =
        |rule: &Rule| -> BTreeSet<(AgentId, Gesture)> { rule.when.iter().filter_map(Trigger::awaits).collect() };
    found.act == asked.act
        && (asked.gesture.is_none() || found.gesture == asked.gesture)
        && heard(asked).is_subset(&heard(found))
}

fn rules_in_words(rules: &[Rule]) -> String {
    if rules.is_empty() { "none".to_owned() } else { rules.iter().map(Rule::phrase).collect::<Vec<_>>().join("; ") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{codes, crossing_proposal, reading_of};
    use socrates_model::Action;

    #[test]
    fn every_dropped_wish_is_named_with_its_words() {
        let asked = crossing_proposal();
        let reading = reading_of(&asked);
        let mut proposal = asked;
        proposal.humans.pop();
        proposal.humans[0].rules[0].act = Action::StandStill;
        proposal.humans[0].relation = Relation::Frontal;
        let faults = check(&proposal, &reading);
        assert_eq!(codes(&faults), ["P-COUNT", "P-ROUGH", "P-ROUGH"]);
        assert!(faults[1].message.to_string().contains("asked for by"), "{}", faults[1].message);
    }

    #[test]
    fn another_distance_for_the_same_reaction_is_the_authors_choice() {
        let asked = crossing_proposal();
        let reading = reading_of(&asked);
        let mut proposal = asked;
        proposal.humans[0].rules[0].when = vec![Trigger::RobotNear(2.5)];
        assert!(check(&proposal, &reading).is_empty());
    }
}
