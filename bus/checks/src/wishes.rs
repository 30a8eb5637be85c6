//! What the request asked for, held against the proposal: P-COUNT and P-ROUGH.

use std::collections::BTreeSet;

use socrates_model::{
    AgentId, Clause, Fact, FactKind, Fault, FaultCode, Gesture, HumanId, Predicate, Proposal, Reading, Rule, Trigger,
    Where,
};

use crate::list;
use crate::proposal::robot_says;

/// A fault per fact of the reading that the proposal drops.
pub(crate) fn check(proposal: &Proposal, reading: &Reading) -> Vec<Fault> {
    reading.facts.iter().filter_map(|fact| missing(fact, proposal)).collect()
}

#[expect(clippy::too_many_lines, reason = "a table: one short arm for each kind of fact")]
fn missing(fact: &Fact, proposal: &Proposal) -> Option<Fault> {
    let quote = if fact.quote.is_empty() { String::new() } else { format!(" (asked for by \"{}\")", fact.quote) };
    let rough = |at: Where, message: String| Some(Fault::new(FaultCode::PRough, at, format!("{message}{quote}")));
    match &fact.kind {
        FactKind::Humans(count) => {
            let listed = proposal.humans.len();
            (listed != *count as usize).then(|| {
                Fault::new(FaultCode::PCount, "humans", format!("lists {listed} humans, asked for were {count}{quote}"))
            })
        }
        FactKind::Group { group, members } => {
            let wanted: BTreeSet<HumanId> = members.iter().copied().collect();
            let there =
                proposal.groups.iter().any(|found| found.members.iter().copied().collect::<BTreeSet<_>>() == wanted);
            if there {
                None
            } else {
                rough((*group).into(), format!("no group has exactly the members {}", list(&wanted)))
            }
        }
        FactKind::Reacts { human, rule } => {
            let Some(found) = proposal.human(*human) else { return rough((*human).into(), "is missing".to_owned()) };
            if found.rules.iter().any(|other| covers(other, rule)) {
                None
            } else {
                rough(
                    (*human).into(),
                    format!("has no rule for: {}; its rules: {}", rule.phrase(), rules_in_words(&found.rules)),
                )
            }
        }
        FactKind::Relates { human, relation } => {
            let found = proposal.human(*human)?.relation;
            // A human who comes out and crosses the robot's way does both.
            let crosses =
                |clause: &Clause| matches!(&clause.predicate, Predicate::Crosses { human: who, .. } if who == human);
            let both = (found, *relation) == (socrates_model::Relation::Leaving, socrates_model::Relation::Crossing)
                && proposal.expected_events.iter().any(crosses);
            if found == *relation || both {
                None
            } else {
                rough(
                    (*human).into(),
                    format!("has the relation `{}`, asked for was `{}`", found.name(), relation.name()),
                )
            }
        }
        FactKind::Side { human, side } => {
            if proposal.human(*human)?.side == Some(*side) {
                None
            } else {
                rough((*human).into(), format!("has not the side `{}`", side.name()))
            }
        }
        FactKind::Facing { human, facing } => {
            if proposal.human(*human)?.facing.as_ref() == Some(facing) {
                None
            } else {
                rough((*human).into(), format!("does not face {}", facing.phrase()))
            }
        }
        FactKind::MeetsTimes { human, times, .. } => {
            let asks = |clause: &Clause| matches!(&clause.predicate, Predicate::MeetsAgain { human: who, nth, .. } if who == human && nth == times);
            if *times < 2 || proposal.expected_events.iter().any(asks) {
                None
            } else {
                let what = format!("has no `meets_again` clause with nth {times}; asked for were {times} meetings");
                rough((*human).into(), what)
            }
        }
        FactKind::Before { first, then, at_door } => {
            let wanted = Predicate::Before { first: *first, then: *then, at_door: *at_door };
            let asks = |clause: &Clause| clause.predicate == wanted;
            if proposal.expected_events.iter().any(asks) {
                None
            } else {
                rough((*then).into(), format!("has no `before` clause; asked for was {first} before {then}"))
            }
        }
        FactKind::Gestures { human, gesture } => {
            let found = proposal.human(*human)?;
            if found.rules.iter().any(|rule| rule.gesture == Some(*gesture)) {
                None
            } else {
                rough((*human).into(), format!("has no rule with the gesture {gesture}"))
            }
        }
        FactKind::GesturesTo { human, gesture, to } => {
            let found = proposal.human(*human)?;
            if found.rules.iter().any(|rule| rule.gesture == Some(*gesture) && rule.to == Some(*to)) {
                None
            } else {
                rough((*human).into(), format!("has no rule with the gesture {gesture} to {to}"))
            }
        }
        FactKind::Place(class) => {
            let clause = proposal
                .expected_events
                .iter()
                .any(|clause| matches!(clause.predicate, Predicate::EncounterAt { place, .. } if place == *class));
            if proposal.place == *class || clause {
                None
            } else {
                rough("place".into(), format!("is `{}`, asked for was `{class}`", proposal.place))
            }
        }
        FactKind::RobotSays(gesture) => {
            let said = robot_says(proposal);
            if said.contains(gesture) {
                None
            } else {
                rough(Where::robot("script"), format!("never says {gesture}; it says {}", list(&said)))
            }
        }
        FactKind::Pace { human, mps } => {
            let found = proposal.human(*human)?.speed_mps;
            let told = found.map_or_else(|| "has no pace".to_owned(), |found| format!("walks at {found} m/s"));
            if found == Some(*mps) { None } else { rough((*human).into(), format!("{told}, asked for were {mps} m/s")) }
        }
        FactKind::Goal { human, name, .. } => {
            let found = proposal.human(*human)?.goal.is_some();
            if found { None } else { rough((*human).into(), format!("does not go to {name}")) }
        }
        FactKind::RobotDoes(line) => {
            let found = proposal.robot.script.contains(line);
            if found { None } else { rough(Where::robot("script"), format!("has no line for: {}", line.phrase())) }
        }
        FactKind::RobotStart(class) => {
            let found = proposal.robot.start;
            if found == Some(*class) { None } else { rough(Where::robot("start"), format!("is not `{class}`")) }
        }
        FactKind::RobotGoal(class) => {
            let found = proposal.robot.goal;
            if found == Some(*class) { None } else { rough(Where::robot("goal"), format!("is not `{class}`")) }
        }
        FactKind::Pattern(card) => {
            if proposal.pattern == *card {
                None
            } else {
                rough("pattern".into(), format!("is `{}`, asked for was `{card}`", proposal.pattern))
            }
        }
        // An empty task is P-ROBOT; whether prose means the same as prose is not judged here. Where the robot's way leads by name
        // is written from the facts, or given up with a note.
        FactKind::RobotTask(_) | FactKind::RobotAt { .. } => None,
        FactKind::Asked { of } => match of {
            Some(AgentId::Human(human)) if proposal.human(*human).is_none() => {
                rough((*human).into(), "is missing".to_owned())
            }
            Some(_) | None => None,
        },
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
    use socrates_model::{Action, Relation};

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
