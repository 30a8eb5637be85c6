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
        | FactKind::GesturesTo { .. }
        | FactKind::MeetsTimes { .. }
        | FactKind::Side { .. }
        | FactKind::Facing { .. }
        | FactKind::Pace { .. }
        | FactKind::Goal { .. }
        | FactKind::MeetsAt { .. }
        | FactKind::Before { .. }
        | FactKind::RobotDoes(_)
        | FactKind::Place(_)
        | FactKind::Asked { of: None | Some(AgentId::Human(_)) } => true,
        FactKind::Asked { of: Some(AgentId::Robot) }
        | FactKind::Humans(_)
        | FactKind::Relates { .. }
        | FactKind::RobotTask(_)
        | FactKind::RobotSays(_)
        | FactKind::RobotStart(_)
        | FactKind::RobotGoal(_)
        | FactKind::RobotAt { .. }
        | FactKind::Pattern(_) => false,
    }
}

/// Whether a clause verifies a fact: it tests the same thing outright, or it names the fact as its source and speaks of the
/// same human or group.
fn covers(clause: &Clause, fact: &Fact) -> bool {
    let named = clause.source == fact.id;
    let shows = match &fact.kind {
        FactKind::Reacts { human, .. } | FactKind::Gestures { human, .. } | FactKind::GesturesTo { human, .. } => {
            named && about(clause, *human, None, u32::MAX)
        }
        FactKind::MeetsTimes { .. }
        | FactKind::Side { .. }
        | FactKind::Facing { .. }
        | FactKind::Pace { .. }
        | FactKind::Goal { .. }
        | FactKind::MeetsAt { .. }
        | FactKind::Before { .. }
        | FactKind::RobotDoes(_) => false,
        FactKind::Group { group, members } => members
            .first()
            .is_some_and(|first| about(clause, *first, Some(*group), u32::MAX) && clause.predicate.group().is_some()),
        FactKind::Asked { of: Some(AgentId::Human(human)) } => named && about(clause, *human, None, u32::MAX),
        FactKind::Asked { of: None | Some(AgentId::Robot) }
        | FactKind::Place(_)
        | FactKind::Humans(_)
        | FactKind::Relates { .. }
        | FactKind::RobotTask(_)
        | FactKind::RobotSays(_)
        | FactKind::RobotStart(_)
        | FactKind::RobotGoal(_)
        | FactKind::RobotAt { .. }
        | FactKind::Pattern(_) => named,
    };
    shows || says(&clause.predicate, &fact.kind)
}

/// Whether a predicate claims the very thing that a fact says; a predicate that does is named here with its fact.
fn says(predicate: &Predicate, fact: &FactKind) -> bool {
    match predicate {
        Predicate::Reacts { human, act, .. } => {
            matches!(fact, FactKind::Reacts { human: who, rule } if who == human && rule.act == *act)
        }
        Predicate::Gestures { agent, gesture } => {
            matches!(fact, FactKind::Gestures { human, gesture: asked }
                if *agent == AgentId::Human(*human) && asked == gesture)
        }
        Predicate::GesturesTo { human, gesture, to } => {
            matches!(fact, FactKind::Gestures { human: who, gesture: asked } if (who, asked) == (human, gesture))
                || matches!(fact, FactKind::GesturesTo { human: who, gesture: asked, to: whom }
                    if (who, asked, whom) == (human, gesture, to))
        }
        Predicate::Step { human, rule, .. } => {
            matches!(fact, FactKind::Reacts { human: who, rule: asked } if who == human && asked.act == rule.act)
                || matches!(fact, FactKind::Gestures { human: who, gesture }
                    if who == human && rule.gesture == Some(*gesture))
        }
        Predicate::MeetsAgain { human, nth, .. } => {
            matches!(fact, FactKind::MeetsTimes { human: who, times, .. } if who == human && times == nth)
        }
        Predicate::OnSide { human, side } => {
            matches!(fact, FactKind::Side { human: who, side: asked } if (who, asked) == (human, side))
        }
        Predicate::Faces { human, facing } => {
            matches!(fact, FactKind::Facing { human: who, facing: asked } if (who, asked) == (human, facing))
        }
        Predicate::RobotWay { part, nodes } => {
            matches!(fact, FactKind::RobotAt { part: own, nodes: asked, .. } if (own, asked) == (part, nodes))
        }
        Predicate::Walks { human, mps } => {
            matches!(fact, FactKind::Pace { human: who, mps: asked } if (who, asked) == (human, mps))
        }
        Predicate::GetsTo { human, nodes } => {
            matches!(fact, FactKind::Goal { human: who, nodes: asked, .. } if (who, asked) == (human, nodes))
        }
        Predicate::RobotStep { rule, .. } => matches!(fact, FactKind::RobotDoes(asked) if asked == rule),
        Predicate::Before { first, then, at_door } => {
            matches!(fact, FactKind::Before { first: one, then: other, at_door: door } if (one, other, door) == (first, then, at_door))
        }
        Predicate::EncounterAt { place, human: None, .. } => matches!(fact, FactKind::Place(asked) if asked == place),
        Predicate::EncounterAt { human: Some(human), nodes, .. } => {
            matches!(fact, FactKind::MeetsAt { human: who, nodes: asked, .. } if (who, asked) == (human, nodes))
        }
        Predicate::Humans { .. }
        | Predicate::Meets { .. }
        | Predicate::HeadOn { .. }
        | Predicate::Crosses { .. }
        | Predicate::Ahead { .. }
        | Predicate::Overtakes { .. }
        | Predicate::RobotPasses { .. }
        | Predicate::Follows { .. }
        | Predicate::Abreast { .. }
        | Predicate::Parallel { .. }
        | Predicate::Flow { .. }
        | Predicate::Density { .. }
        | Predicate::Surrounds { .. }
        | Predicate::Converges { .. }
        | Predicate::Blocks { .. }
        | Predicate::Looks { .. }
        | Predicate::StandsStill { .. }
        | Predicate::RunsAway { .. }
        | Predicate::GivesWay { .. }
        | Predicate::Leaves { .. }
        | Predicate::StaysInside { .. }
        | Predicate::Enters { .. }
        | Predicate::DoorOpens { .. }
        | Predicate::HiddenUntil { .. }
        | Predicate::Formation { .. }
        | Predicate::WalksTogether { .. }
        | Predicate::Queues { .. }
        | Predicate::Order { .. }
        | Predicate::Reaches { .. }
        | Predicate::StartsAt { .. }
        | Predicate::OnTime { .. }
        | Predicate::Plausible
        | Predicate::RobotArrives
        | Predicate::RobotKeeps { .. }
        | Predicate::RobotEntersLast
        | Predicate::RobotLeavesFirst
        | Predicate::RobotJoins { .. }
        | Predicate::RobotLeavesGroup { .. }
        | Predicate::TurnsBack { .. }
        | Predicate::GoesTo { .. }
        | Predicate::ChangesPace { .. }
        | Predicate::StaysAside { .. }
        | Predicate::MakesRoom { .. }
        | Predicate::RobotObeys { .. } => false,
    }
}
