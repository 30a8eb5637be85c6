//! What should be done again when the scenario did not happen, with the reasons its author reads next.

use socrates_model::job::Stage;
use socrates_model::recording::DRIVEN_LEAF;
use socrates_model::report::{Repair, Standing};
use socrates_model::{
    Action, AgentId, Clause, EventKind, Fault, FaultCode, HumanId, Predicate, Shows, Trigger, Verdict, Where,
};

use crate::evidence::Evidence;
use crate::fidelity::{Finding, Judged, Missed};
use crate::tracks::TrackFault;

/// The repair a verdict asks for, if it is the scenario's fault; what came late could come in time. Only the run with the reference
/// robot can tell; what another planner prevented is its own result, and so is what somebody did whom a driver outside moved.
pub(crate) fn of(evidence: &Evidence<'_>, verdict: Verdict, judged: &Judged) -> Option<Repair> {
    let header = &evidence.recording.header;
    if !header.planner.is_reference() || header.leaves.iter().any(|leaf| leaf == DRIVEN_LEAF) {
        return None;
    }
    let mut faults: Vec<(Stage, Fault)> = Vec::new();
    match verdict {
        Verdict::Realised | Verdict::RobotPrevented => return None,
        Verdict::NotTriggered | Verdict::Contradicted | Verdict::RealisedLate => {}
        Verdict::Invalid => {
            for flaw in &judged.flaws {
                let code = if flaw.stuck { FaultCode::DStuck } else { FaultCode::DPen };
                let at = Where::agents(flaw.agents.iter().copied());
                faults.push((Stage::Paths, Fault::new(code, at, format!("at {:.1} s: {}", flaw.t, flaw.text))));
            }
            if faults.is_empty() {
                evidence.proposal?;
                for missing in &judged.uncovered {
                    faults.push((Stage::Proposal, Fault::new(FaultCode::PVerify, "expected_events", missing.as_str())));
                }
            }
        }
    }
    if faults.is_empty() {
        for (clause, finding) in judged.deciding() {
            if matches!(finding.standing, Standing::NotTriggered | Standing::Fails | Standing::Late) {
                let Some((stage, fault)) = fault_in(evidence, judged, clause, finding) else { continue };
                let left = finding.first_s().filter(|_| fault.code == FaultCode::DGroup);
                faults.push(match left.and_then(|t| left_by_rule(evidence, clause, t)) {
                    Some((human, act)) => {
                        let why = format!("{}; {human} leaves it by their rule to {}", fault.message, act.phrase());
                        (Stage::Behaviors, Fault { message: why.into(), ..fault })
                    }
                    None => (stage, fault),
                });
            }
        }
    }
    // Whoever acts before their reason, or leaves their group, is not where the others expect them: what else was missed may well be of that.
    let hasty = |(stage, fault): &(Stage, Fault)| {
        fault.code == FaultCode::DEarly || fault.code == FaultCode::DGroup && *stage == Stage::Behaviors
    };
    if faults.iter().any(hasty) {
        faults.retain(hasty);
    }
    // One stage is done again at a time, the earliest: what depends on it is made anew anyway.
    let stage = faults.iter().map(|(stage, _)| *stage).min()?;
    let faults = faults.into_iter().filter(|(of, _)| *of == stage).map(|(_, fault)| fault).collect();
    Some(Repair { stage, faults })
}

/// The repair for a recording that cannot be read: only states that are not finite are the scenario's fault.
pub(crate) fn of_broken(evidence: &Evidence<'_>, fault: &TrackFault) -> Option<Repair> {
    let TrackFault::NotFinite { agent, .. } = fault else { return None };
    (evidence.paths.is_some() && evidence.recording.header.planner.is_reference())
        .then(|| Repair { stage: Stage::Paths, faults: vec![Fault::new(FaultCode::DPen, *agent, fault.to_string())] })
}

/// Whether whoever is to do what a clause tests has a rule for it: then a reason that came and nothing done is for who writes rules.
fn has_rule(evidence: &Evidence<'_>, clause: &Clause) -> bool {
    let follower = if let Predicate::Follows { follower: AgentId::Human(human), .. } = &clause.predicate {
        Some(*human)
    } else {
        None
    };
    let human = follower.or_else(|| clause.predicate.human());
    let human = human.and_then(|human| evidence.proposal.and_then(|proposal| proposal.human(human)));
    human.is_some_and(|human| human.rules.iter().any(|rule| clause.predicate.is_deed(&rule.act)))
}

/// The member of the group of a clause who had left for a rule of their own by then: places of people cannot mend that.
fn left_by_rule(evidence: &Evidence<'_>, clause: &Clause, by_s: f64) -> Option<(HumanId, Action)> {
    let proposal = evidence.proposal?;
    let group = proposal.groups.iter().find(|group| clause.predicate.group() == Some(group.id))?;
    let own = |human: HumanId, leaf: &str| {
        let rules = proposal.human(human).into_iter().flat_map(|human| &human.rules);
        rules.map(|rule| &rule.act).find(|act| act.row().leads_away && act.is_leaf(leaf)).cloned()
    };
    evidence.recording.events.iter().find_map(|event| {
        let EventKind::Leaf { human, leaf } = &event.kind else { return None };
        let member = group.members.contains(human) && event.time.secs() <= by_s + LEAVES_S;
        if member { own(*human, leaf).map(|act| (*human, act)) } else { None }
    })
}

/// Time after which a group that somebody leaves is seen to be broken at the latest, s.
const LEAVES_S: f64 = 1.0;

/// What is wrong with a clause that was missed. Of an order, what is wrong with the part that was never seen: nothing of its own where that
/// part decides as well, since it is told of itself then. Where both parts came the other way round, whoever wrote what people do can mend
/// an order with a deed in it, and paths any other.
fn fault_in(evidence: &Evidence<'_>, judged: &Judged, clause: &Clause, finding: &Finding) -> Option<(Stage, Fault)> {
    let of_itself = |clause: &Clause, finding: &Finding| fault_of(clause, finding, has_rule(evidence, clause));
    let Predicate::Order { first, then } = &clause.predicate else { return Some(of_itself(clause, finding)) };
    let part = |id: &String| judged.clauses.iter().find(|(clause, _)| clause.id == *id);
    let parts = [part(first), part(then)];
    let unseen = |finding: &Finding| matches!(finding.standing, Standing::NotTriggered | Standing::Fails);
    if let Some((part, found)) = parts.into_iter().flatten().find(|(_, found)| unseen(found)) {
        if judged.deciding().any(|(clause, _)| clause.id == part.id) {
            return None;
        }
        let (stage, fault) = of_itself(part, found);
        let message = format!("clause {} (\"{}\") waits for it: {}", clause.id, clause.text, fault.message);
        return Some((stage, Fault { message: message.into(), ..fault }));
    }
    let (_, fault) = of_itself(clause, finding);
    let deed = |part: Option<&(Clause, Finding)>| {
        part.is_some_and(|(clause, found)| by_predicate(clause, found, true).1 == Stage::Behaviors)
    };
    Some((if parts.into_iter().any(deed) { Stage::Behaviors } else { Stage::Paths }, fault))
}

/// Code, stage and message of a clause that was missed; `ruled` tells whether its people have a rule for what it tests.
fn fault_of(clause: &Clause, finding: &Finding, ruled: bool) -> (Stage, Fault) {
    let (code, stage) = finding
        .missed
        .as_ref()
        .and_then(elsewhere)
        .map_or_else(|| by_predicate(clause, finding, ruled), |stage| (FaultCode::DNoTrig, stage));
    let at = clause.predicate.human().map_or_else(|| Where::key(&clause.id), Where::agent);
    let when = finding.first_s().map_or_else(String::new, |t| format!(" at {t:.1} s"));
    let state = match finding.standing {
        Standing::NotTriggered => "never came true",
        Standing::Late => "came true late",
        Standing::Holds | Standing::Fails | Standing::NotApplicable => "was seen to be otherwise",
    };
    let message = format!(
        "clause {} (\"{}\") {state}{when}, margin {:.2}: {}",
        clause.id, clause.text, finding.margin, finding.evidence
    );
    (stage, Fault::new(code, at, message))
}

/// The stage that can bring about a trigger that never held, where that is not the one which writes who reacts to what: the robot's script,
/// what others do, and times are the proposal's, places of people the paths'.
fn elsewhere(missed: &Missed) -> Option<Stage> {
    match &missed.trigger {
        // Near enough and not before their eyes: they walk the other way, or elsewhere.
        Trigger::RobotVisible(m) | Trigger::RobotBlocking(m) if missed.nearest_m <= *m => Some(Stage::Paths),
        Trigger::RobotSays(_)
        | Trigger::HumanSays(..)
        | Trigger::RobotStopped
        | Trigger::StoppedFor(_)
        | Trigger::AfterSecs(_)
        | Trigger::Did(..)
        | Trigger::Done(_) => Some(Stage::Proposal),
        Trigger::AtEncounter | Trigger::GoalReached | Trigger::RobotPassed => Some(Stage::Paths),
        Trigger::Always
        | Trigger::RobotVisible(_)
        | Trigger::RobotNear(_)
        | Trigger::RobotBlocking(_)
        | Trigger::RobotMoving => None,
    }
}

/// Code and stage of a clause by what it shows.
fn by_predicate(clause: &Clause, finding: &Finding, ruled: bool) -> (FaultCode, Stage) {
    if finding.early {
        return (FaultCode::DEarly, Stage::Behaviors);
    }
    match clause.predicate.shows() {
        Shows::Meeting => (FaultCode::DNoMeet, Stage::Paths),
        // A human who was never near could not act: that is for the paths.
        Shows::Deed if finding.standing == Standing::NotTriggered && (finding.missed.is_some() || !ruled) => {
            (FaultCode::DNoMeet, Stage::Paths)
        }
        Shows::Deed | Shows::Act => (FaultCode::DNoTrig, Stage::Behaviors),
        Shows::Sign => (FaultCode::DNoGest, Stage::Behaviors),
        Shows::Company => (FaultCode::DGroup, Stage::Paths),
        Shows::Bodies => (FaultCode::DPen, Stage::Paths),
        Shows::Course | Shows::Result => (FaultCode::DSetup, Stage::Paths),
    }
}
