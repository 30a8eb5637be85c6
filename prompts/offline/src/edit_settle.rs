//! What follows from an edit: prose, clauses, the robot's script, and what was asked for.

use socrates_model::reading::ReadHuman;
use socrates_model::rule::RobotDo;
use socrates_model::{
    Action, Clause, ClauseRole, Fact, FactKind, HumanId, HumanProposal, Predicate, Proposal, Reading,
};

use crate::desk::Desk;
use crate::edit_people::{next_id, same_act};
use crate::{events, named_way, proposal, prose};

/// What follows from the changes: prose, clauses, script, and what was asked for.
pub(crate) fn settle(desk: &mut Desk, before: &Proposal, reading: &mut Reading) {
    reading.clone_from(&desk.question.reading);
    // Where a person has led the robot elsewhere, its way is asked for no longer.
    let paths = desk.draft.paths.as_ref();
    let proposal = &mut desk.draft.proposal;
    if let Some(paths) = paths {
        proposal.expected_events.retain(|clause| named_way::kept(&clause.predicate, paths));
    }
    let (were, are) = (prose::headcount(before.humans.len()), prose::headcount(proposal.humans.len()));
    if were != are {
        proposal.description = proposal.description.replacen(&were, &are, 1);
    }
    for who in &desk.changed {
        let place = proposal.place;
        // Two who do the same are described by the same words; then only the line with the name is certain.
        let same = proposal.humans.get(*who).map(|human| human.behavior.clone()).unwrap_or_default();
        let alone = proposal.humans.iter().filter(|human| human.behavior == same).count() == 1;
        let Some(human) = proposal.humans.get_mut(*who) else { continue };
        let old = std::mem::take(&mut human.behavior);
        let new = prose::behavior(&human.role, human.relation, place, human.start, &human.rules, human.group.is_some());
        human.behavior.clone_from(&new);
        let (told, line) = (format!("{}: {old}", human.id), format!("{}: {new}", human.id));
        if !old.is_empty() && proposal.description.contains(&told) {
            proposal.description = proposal.description.replacen(&told, &line, 1);
        } else if !old.is_empty() && alone && proposal.description.contains(&old) {
            proposal.description = proposal.description.replacen(&old, &new, 1);
        } else if !proposal.description.contains(&line) {
            proposal.description = told_anew(&proposal.description, human.id, &line);
        }
    }
    proposal::hear(&mut proposal.robot.script, &proposal.humans);
    facts(proposal, reading);
    let count = u32::try_from(proposal.humans.len()).unwrap_or(u32::MAX);
    for clause in &mut proposal.expected_events {
        if let Predicate::Humans { count: old } = &mut clause.predicate
            && *old != count
        {
            *old = count;
            clause.text = events::headcount(count);
        }
    }
    let changed: Vec<HumanProposal> =
        desk.changed.iter().filter_map(|who| proposal.humans.get(*who)).cloned().collect();
    for human in &changed {
        clauses_of(human, before, proposal, reading);
    }
    let says: Vec<_> = proposal
        .robot
        .script
        .iter()
        .filter_map(|line| if let RobotDo::Say(gesture) = line.act { Some(gesture) } else { None })
        .collect();
    proposal.expected_events.retain(|clause| {
        !matches!(clause.predicate, Predicate::Gestures { agent: socrates_model::AgentId::Robot, gesture } if !says.contains(&gesture))
    });
    let script = proposal.robot.script.clone();
    proposal
        .expected_events
        .retain(|clause| !matches!(&clause.predicate, Predicate::RobotStep { rule, .. } if !script.contains(rule)));
    // An order of clauses of which one is gone orders nothing.
    let ids: Vec<String> = proposal.expected_events.iter().map(|clause| clause.id.clone()).collect();
    proposal.expected_events.retain(|clause| {
        !matches!(&clause.predicate, Predicate::Order { first, then } if !ids.contains(first) || !ids.contains(then))
    });
    // What its author saw in clauses of which none is left was asked for before the edit.
    let served = |proposal: &Proposal, id: &str| proposal.expected_events.iter().any(|clause| clause.source == id);
    reading.facts.retain(|fact| {
        !matches!(fact.kind, FactKind::Asked { .. }) || served(proposal, &fact.id) || !served(before, &fact.id)
    });
}

/// A description with this line of somebody in place of the one that it has; at its end where it has none.
fn told_anew(description: &str, who: HumanId, line: &str) -> String {
    let name = format!("{who}: ");
    let Some((before, after)) = description.split_once(&name) else {
        return format!("{} {line}", description.trim_end());
    };
    // Another one's line begins with their name.
    let next = after.match_indices("human_").find(|(at, _)| {
        let rest = after.get(at + "human_".len()..).unwrap_or_default();
        rest.trim_start_matches(|c: char| c.is_ascii_digit()).starts_with(": ") && !rest.starts_with(": ")
    });
    let rest = next.and_then(|(at, _)| after.get(at..)).unwrap_or_default();
    format!("{before}{line} {rest}").trim_end().to_owned()
}

/// Clauses of a human who changed are written anew. Those that show what an author read of the request itself stay, as long as the human still
/// does it: no grammar could write them again.
fn clauses_of(human: &HumanProposal, before: &Proposal, proposal: &mut Proposal, reading: &Reading) {
    let asked = |clause: &Clause| {
        let of_author = |fact: &Fact| fact.id == clause.source && matches!(fact.kind, FactKind::Asked { .. });
        reading.facts.iter().any(of_author)
    };
    proposal.expected_events.retain(|clause| {
        clause.role != ClauseRole::Setup
            || clause.predicate.human() != Some(human.id)
            || asked(clause) && still_does(&clause.predicate, human, before)
    });
    for mut clause in events::of_human(human, proposal, reading) {
        if proposal.expected_events.iter().any(|other| says_the_same(&other.predicate, &clause.predicate)) {
            continue;
        }
        clause.id = next_id(proposal);
        proposal.expected_events.push(clause);
    }
}

/// Whether a human does after an edit what a clause tests: has a rule for it, or goes the same way as before.
fn still_does(predicate: &Predicate, human: &HumanProposal, before: &Proposal) -> bool {
    let acts = |test: &dyn Fn(&Action) -> bool| human.rules.iter().any(|rule| test(&rule.act));
    let same_way = || before.human(human.id).is_some_and(|was| was.relation == human.relation);
    if let Predicate::Reacts { act, .. } = predicate {
        acts(&|own| same_act(own, act))
    } else if let Predicate::Step { rule, .. } = predicate {
        human.rules.contains(rule)
    } else if let Predicate::Gestures { gesture, .. } | Predicate::GesturesTo { gesture, .. } = predicate {
        human.rules.iter().any(|rule| rule.gesture == Some(*gesture))
    } else if let Predicate::StandsStill { .. } = predicate {
        human.relation.stands() || acts(&|own| matches!(own, Action::StandStill | Action::LookAtRobot))
    } else if is_of_rules(predicate) {
        acts(&|own| predicate.is_deed(own))
    } else {
        same_way()
    }
}

/// Whether a test is of a deed that only a rule brings about. Whoever follows may do so by where they walk.
const fn is_of_rules(predicate: &Predicate) -> bool {
    matches!(
        predicate,
        Predicate::Looks { .. }
            | Predicate::Blocks { .. }
            | Predicate::RunsAway { .. }
            | Predicate::GivesWay { .. }
            | Predicate::MakesRoom { .. }
            | Predicate::ChangesPace { .. }
            | Predicate::TurnsBack { .. }
            | Predicate::ComesBack { .. }
    )
}

/// Whether two tests are of one kind about one human; of reactions and signs there may be several.
fn says_the_same(one: &Predicate, other: &Predicate) -> bool {
    let several = matches!(
        one,
        Predicate::Reacts { .. } | Predicate::Step { .. } | Predicate::Gestures { .. } | Predicate::GesturesTo { .. }
    );
    one == other
        || !several
            && one.human().is_some()
            && one.human() == other.human()
            && std::mem::discriminant(one) == std::mem::discriminant(other)
}

/// The facts that still hold; those that the edit overrules say what it says.
fn facts(proposal: &Proposal, reading: &mut Reading) {
    let count = u32::try_from(proposal.humans.len()).unwrap_or(u32::MAX);
    let rules = |id: &HumanId| proposal.human(*id).map(|human| human.rules.clone()).unwrap_or_default();
    for fact in &mut reading.facts {
        match &mut fact.kind {
            FactKind::Humans(n) => *n = count,
            FactKind::Relates { human, relation } => {
                if let Some(who) = proposal.human(*human) {
                    *relation = who.relation;
                }
            }
            FactKind::Reacts { human, rule } => {
                let own = rules(human);
                if !own.contains(rule)
                    && let Some(now) = own.iter().find(|other| same_act(&other.act, &rule.act))
                {
                    rule.clone_from(now);
                }
            }
            FactKind::Place(class) => *class = proposal.place,
            FactKind::Group { .. }
            | FactKind::Gestures { .. }
            | FactKind::GesturesTo { .. }
            | FactKind::MeetsTimes { .. }
            | FactKind::Side { .. }
            | FactKind::Facing { .. }
            | FactKind::Pace { .. }
            | FactKind::Goal { .. }
            | FactKind::MeetsAt { .. }
            | FactKind::Before { .. }
            | FactKind::RobotTask(_)
            | FactKind::RobotSays(_)
            | FactKind::RobotDoes(_)
            | FactKind::RobotStart(_)
            | FactKind::RobotGoal(_)
            | FactKind::RobotAt { .. }
            | FactKind::Asked { .. }
            | FactKind::Pattern(_) => {}
        }
    }
    let says = |gesture| proposal.robot.script.iter().any(|line| line.act == RobotDo::Say(gesture));
    reading.facts.retain(|fact| match &fact.kind {
        FactKind::Reacts { human, rule } => rules(human).contains(rule),
        FactKind::Gestures { human, gesture } => rules(human).iter().any(|rule| rule.gesture == Some(*gesture)),
        FactKind::GesturesTo { human, gesture, to } => {
            rules(human).iter().any(|rule| rule.gesture == Some(*gesture) && rule.to == Some(*to))
        }
        FactKind::Group { members, .. } => proposal.groups.iter().any(|group| group.members == *members),
        FactKind::Before { first, then, at_door } => {
            let clause = Predicate::Before { first: *first, then: *then, at_door: *at_door };
            proposal.expected_events.iter().any(|other| other.predicate == clause)
        }
        FactKind::RobotSays(gesture) => says(*gesture),
        FactKind::RobotDoes(line) => proposal.robot.script.contains(line),
        FactKind::Side { human, side } => proposal.human(*human).is_some_and(|human| human.side == Some(*side)),
        FactKind::Facing { human, facing } => {
            proposal.human(*human).is_some_and(|human| human.facing.as_ref() == Some(facing))
        }
        FactKind::Pace { human, mps } => proposal.human(*human).is_some_and(|human| human.speed_mps == Some(*mps)),
        FactKind::Goal { human, .. } => proposal.human(*human).is_some_and(|human| human.goal.is_some()),
        FactKind::MeetsAt { human, .. } => proposal.human(*human).is_some(),
        FactKind::RobotAt { part, nodes, .. } => {
            let clause = Predicate::RobotWay { part: *part, nodes: nodes.clone() };
            proposal.expected_events.iter().any(|other| other.predicate == clause)
        }
        FactKind::RobotStart(class) => proposal.robot.start.is_none_or(|now| now == *class),
        FactKind::RobotGoal(class) => proposal.robot.goal.is_none_or(|now| now == *class),
        FactKind::Humans(_)
        | FactKind::Relates { .. }
        | FactKind::MeetsTimes { .. }
        | FactKind::Place(_)
        | FactKind::RobotTask(_)
        | FactKind::Asked { .. }
        | FactKind::Pattern(_) => true,
    });
    reading.place = reading.place.map(|_| proposal.place);
    let guided = !reading.humans.is_empty();
    for (place, human) in proposal.humans.iter().enumerate() {
        let read = ReadHuman {
            id: human.id,
            role: human.role.clone(),
            summary: reading.humans.get(place).map(|read| read.summary.clone()).unwrap_or_default(),
            relation: Some(human.relation),
            rules: human.rules.clone(),
            group: human.group,
        };
        match reading.humans.get_mut(place) {
            Some(slot) => *slot = read,
            // An unguided request names nobody.
            None if guided => reading.humans.push(read),
            None => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_of_somebody_takes_the_place_of_their_last_one() {
        let told = |text: &str| told_anew(text, HumanId::new(1), "human_1: waits.");
        assert_eq!(told("Two meet."), "Two meet. human_1: waits.");
        assert_eq!(told("Two meet. human_1: goes on. human_2: looks."), "Two meet. human_1: waits. human_2: looks.");
        assert_eq!(told("human_1: goes on with human_2."), "human_1: waits.");
    }
}
