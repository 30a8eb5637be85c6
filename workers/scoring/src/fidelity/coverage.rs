//! Whether the clauses verify what was asked: every human, reaction, gesture, place and group.

use socrates_model::report::Standing;
use socrates_model::{AgentId, Clause, ClauseRole, Fact, FactKind, HumanId, Predicate};

use crate::evidence::Evidence;
use crate::fidelity::finding::Finding;

/// What has no clause that decides anything, in words. Empty when everything is covered.
#[must_use]
pub(super) fn uncovered(evidence: &Evidence<'_>, clauses: &[(Clause, Finding)]) -> Vec<String> {
    let deciding: Vec<&Clause> = clauses
        .iter()
        .filter(|(clause, _)| clause.role == ClauseRole::Setup && clause.must)
        .map(|(clause, _)| clause)
        .collect();
    let judged: Vec<&Clause> = clauses
        .iter()
        .filter(|(clause, finding)| {
            clause.role == ClauseRole::Setup && clause.must && finding.standing != Standing::NotApplicable
        })
        .map(|(clause, _)| clause)
        .collect();
    let mut missing = Vec::new();
    if let Some(proposal) = evidence.proposal {
        let count = u32::try_from(proposal.humans.len()).unwrap_or(u32::MAX);
        for human in &proposal.humans {
            let group = human.group;
            // A clause that the map cannot judge verifies nobody.
            if !judged.iter().any(|clause| about(clause, human.id, group, count)) {
                missing.push(format!("nothing that could be judged shows what {} does", human.id));
            }
        }
    }
    if let Some(reading) = evidence.reading {
        for fact in &reading.facts {
            // A clause of a fact may be dropped with a note where the map has no doors; it must have been promised.
            if asks(&fact.kind) && !deciding.iter().any(|clause| covers(clause, fact)) {
                missing.push(format!(
                    "\"{}\" was asked for, and no clause shows whether it happened (fact {})",
                    fact.quote, fact.id
                ));
            }
        }
    }
    missing
}

/// Whether a clause is about the human, alone, in its group, or because it takes in everybody.
fn about(clause: &Clause, human: HumanId, group: Option<socrates_model::GroupId>, humans: u32) -> bool {
    if let Some(of) = clause.predicate.group() {
        return group == Some(of);
    }
    if let Predicate::Follows { follower, leader, .. } = &clause.predicate {
        return [follower, leader].into_iter().any(|agent| *agent == AgentId::Human(human));
    }
    clause.predicate.takes_in_all(humans) || clause.predicate.human() == Some(human)
}

/// Facts that a scenario must show; the task and its ends are the robot's own business.
const fn asks(kind: &FactKind) -> bool {
    match kind {
        FactKind::Group { .. }
        | FactKind::Reacts { .. }
        | FactKind::Gestures { .. }
        | FactKind::MeetsTimes { .. }
        | FactKind::Before { .. }
        | FactKind::Place(_) => true,
        FactKind::Humans(_)
        | FactKind::Relates { .. }
        | FactKind::RobotTask(_)
        | FactKind::RobotSays(_)
        | FactKind::RobotStart(_)
        | FactKind::RobotGoal(_)
        | FactKind::Pattern(_) => false,
    }
}

/// Whether a clause verifies a fact: it names it as its source and speaks of the same human or
/// group, or it tests the same thing outright.
fn covers(clause: &Clause, fact: &Fact) -> bool {
    let named = clause.source == fact.id;
    match &fact.kind {
        FactKind::Reacts { human, rule } => {
            let same = matches!(&clause.predicate, Predicate::Reacts { human: who, act, .. } if who == human && *act == rule.act);
            same || named && about(clause, *human, None, u32::MAX)
        }
        FactKind::Gestures { human, gesture } => {
            let asked = Predicate::Gestures { agent: AgentId::Human(*human), gesture: *gesture };
            clause.predicate == asked || named && about(clause, *human, None, u32::MAX)
        }
        FactKind::MeetsTimes { human, times, .. } => {
            matches!(&clause.predicate, Predicate::MeetsAgain { human: who, nth, .. } if who == human && nth == times)
        }
        FactKind::Before { first, then } => clause.predicate == Predicate::Before { first: *first, then: *then },
        FactKind::Group { group, members } => members
            .first()
            .is_some_and(|first| about(clause, *first, Some(*group), u32::MAX) && clause.predicate.group().is_some()),
        FactKind::Place(place) => {
            named || matches!(clause.predicate, Predicate::EncounterAt { place: at, .. } if at == *place)
        }
        FactKind::Humans(_)
        | FactKind::Relates { .. }
        | FactKind::RobotTask(_)
        | FactKind::RobotSays(_)
        | FactKind::RobotStart(_)
        | FactKind::RobotGoal(_)
        | FactKind::Pattern(_) => named,
    }
}
