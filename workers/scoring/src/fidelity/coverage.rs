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
            if fact.kind.needs_clause() && !deciding.iter().any(|clause| covers(clause, fact)) {
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

/// Whether a clause verifies a fact: it tests the same thing outright, or it names the fact as its source and speaks of the
/// same human or group.
fn covers(clause: &Clause, fact: &Fact) -> bool {
    if says(&clause.predicate, &fact.kind) {
        return true;
    }
    if let FactKind::Group { group, members } = &fact.kind {
        return members
            .first()
            .is_some_and(|first| about(clause, *first, Some(*group), u32::MAX) && clause.predicate.group().is_some());
    }
    let of_its_human = || fact.kind.human().is_none_or(|human| about(clause, human, None, u32::MAX));
    !fact.kind.has_own_test() && clause.source == fact.id && of_its_human()
}

/// Whether a predicate claims the very thing that a fact says.
fn says(predicate: &Predicate, fact: &FactKind) -> bool {
    match (predicate, fact) {
        (Predicate::Reacts { human, act, .. }, FactKind::Reacts { human: who, rule }) => {
            who == human && rule.act == *act
        }
        (Predicate::Gestures { agent, gesture }, FactKind::Gestures { human, gesture: asked }) => {
            *agent == AgentId::Human(*human) && asked == gesture
        }
        (Predicate::GesturesTo { human, gesture, .. }, FactKind::Gestures { human: who, gesture: asked }) => {
            (who, asked) == (human, gesture)
        }
        (
            Predicate::GesturesTo { human, gesture, to },
            FactKind::GesturesTo { human: who, gesture: asked, to: whom },
        ) => (who, asked, whom) == (human, gesture, to),
        (Predicate::Step { human, rule, .. }, FactKind::Reacts { human: who, rule: asked }) => {
            who == human && asked.act == rule.act
        }
        (Predicate::Step { human, rule, .. }, FactKind::Gestures { human: who, gesture }) => {
            who == human && rule.gesture == Some(*gesture)
        }
        (Predicate::MeetsAgain { human, nth, .. }, FactKind::MeetsTimes { human: who, times, .. }) => {
            who == human && times == nth
        }
        (Predicate::OnSide { human, side }, FactKind::Side { human: who, side: asked }) => {
            (who, asked) == (human, side)
        }
        (Predicate::Faces { human, facing }, FactKind::Facing { human: who, facing: asked }) => {
            (who, asked) == (human, facing)
        }
        (Predicate::RobotWay { part, nodes }, FactKind::RobotAt { part: own, nodes: asked, .. }) => {
            (own, asked) == (part, nodes)
        }
        (Predicate::Walks { human, mps }, FactKind::Pace { human: who, mps: asked }) => (who, asked) == (human, mps),
        (Predicate::GetsTo { human, nodes }, FactKind::Goal { human: who, nodes: asked, .. }) => {
            (who, asked) == (human, nodes)
        }
        (Predicate::RobotStep { rule, .. }, FactKind::RobotDoes(asked)) => asked == rule,
        (Predicate::Before { first, then, at_door }, FactKind::Before { first: one, then: other, at_door: door }) => {
            (one, other, door) == (first, then, at_door)
        }
        (Predicate::EncounterAt { place, human: None, .. }, FactKind::Place(asked)) => asked == place,
        (
            Predicate::EncounterAt { human: Some(human), nodes, .. },
            FactKind::MeetsAt { human: who, nodes: asked, .. },
        ) => (who, asked) == (human, nodes),
        _ => false,
    }
}
