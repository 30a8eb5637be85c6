//! P-VERIFY: a scenario cannot be realised by promising nothing.

use std::collections::BTreeSet;

use socrates_model::{Clause, ClauseRole, Fault, FaultCode, HumanId, Predicate, Proposal, Reading, Where};

use crate::{limits, list};

/// Every human needs a setup clause that must hold and speaks of it, or of its group.
pub(crate) fn humans(proposal: &Proposal) -> Vec<Fault> {
    let message = "does their part without a clause that could show it";
    let seen = |human: HumanId| must_setup(proposal).any(|clause| speaks_of(clause, human, proposal));
    let unseen = proposal.humans.iter().map(|human| human.id).filter(|human| !seen(*human));
    unseen.map(|human| Fault::new(FaultCode::PVerify, human, message)).collect()
}

/// Every reaction, gesture, place and group that was asked for needs a setup clause that names it as its source.
pub(crate) fn facts(proposal: &Proposal, reading: &Reading) -> Vec<Fault> {
    let mut faults = Vec::new();
    for fact in reading.facts.iter().filter(|fact| fact.kind.needs_clause()) {
        let carriers: Vec<&Clause> = must_setup(proposal).filter(|clause| clause.source == fact.id).collect();
        if carriers.is_empty() {
            let message =
                format!("\"{}\" was asked for, and no clause of the proposal shows whether it happens", fact.quote);
            faults.push(Fault::new(FaultCode::PVerify, Where::key(format_args!("fact {}", fact.id)), message));
        } else if let Some(owner) = fact.kind.human()
            && !carriers.iter().any(|clause| speaks_of(clause, owner, proposal))
        {
            let message = format!(
                "\"{}\" is about {owner}, but its clauses {} show only what others do",
                fact.quote,
                list(carriers.iter().map(|clause| &clause.id))
            );
            faults.push(Fault::new(FaultCode::PVerify, Where::key(format_args!("fact {}", fact.id)), message));
        }
    }
    faults
}

/// Clauses that cannot be judged: doubled ids, unknown groups or orders, results dressed up as setup, impossible numbers.
pub(crate) fn clauses(proposal: &Proposal) -> Vec<Fault> {
    let mut faults = Vec::new();
    let mut seen = BTreeSet::new();
    let ids: BTreeSet<&str> = proposal.expected_events.iter().map(|clause| clause.id.as_str()).collect();
    for clause in &proposal.expected_events {
        let mut bad = |message: String| faults.push(Fault::new(FaultCode::PVerify, Where::clause(&clause.id), message));
        if !seen.insert(clause.id.as_str()) {
            bad("is listed twice; number the clauses c1, c2, …".to_owned());
        }
        if let Some(group) = clause.predicate.group()
            && !proposal.groups.iter().any(|found| found.id == group)
        {
            bad(format!("speaks of {group}; groups: {}", list(proposal.groups.iter().map(|found| found.id))));
        }
        if let Predicate::Order { first, then } = &clause.predicate {
            for id in [first, then].into_iter().filter(|id| !ids.contains(id.as_str())) {
                bad(format!("orders the clause `{id}`; clauses: {}", list(&ids)));
            }
        }
        if let Predicate::Flow { count, .. } | Predicate::Surrounds { count, .. } = clause.predicate
            && usize::try_from(count).is_ok_and(|count| count > proposal.humans.len())
        {
            bad(format!("asks for {count} humans where the proposal has {}", proposal.humans.len()));
        }
        if clause.role == ClauseRole::Setup && clause.predicate.judges_robot() {
            bad("judges what the robot does and cannot be part of the setup; use the role `outcome`".to_owned());
        }
        for message in limits::faults(&clause.predicate, proposal) {
            bad(message);
        }
    }
    faults
}

fn must_setup(proposal: &Proposal) -> impl Iterator<Item = &Clause> {
    proposal.expected_events.iter().filter(|clause| clause.must && clause.role == ClauseRole::Setup)
}

/// Whether a clause is about the human: directly, as the leader it follows, through its group, or by what it puts in order.
fn speaks_of(clause: &Clause, human: HumanId, proposal: &Proposal) -> bool {
    let by_group = |id| proposal.groups.iter().any(|group| group.id == id && group.members.contains(&human));
    let led = matches!(&clause.predicate, Predicate::Follows { leader, .. } if *leader == human.into());
    let grouped = clause.predicate.group().is_some_and(by_group);
    let all = clause.predicate.takes_in_all(u32::try_from(proposal.humans.len()).unwrap_or(u32::MAX));
    // An order tells of everybody of whom its two clauses do.
    let ordered = if let Predicate::Order { first, then } = &clause.predicate {
        let own =
            |other: &&Clause| [first, then].contains(&&other.id) && !matches!(other.predicate, Predicate::Order { .. });
        proposal.expected_events.iter().filter(own).any(|other| speaks_of(other, human, proposal))
    } else {
        false
    };
    led || grouped || all || ordered || clause.predicate.human() == Some(human)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{codes, crossing_proposal, reading_of};

    #[test]
    fn a_crowd_clause_asks_for_no_more_people_than_there_are() {
        let mut proposal = crossing_proposal();
        proposal.expected_events[0].predicate = Predicate::Flow { count: 3, within_m: 4.0, angle_deg: [90.0, 60.0] };
        let faults = clauses(&proposal);
        assert_eq!(faults.len(), 2, "{faults:?}");
        assert!(faults[0].message.to_string().contains("asks for 3 humans where the proposal has 2"), "{faults:?}");
        assert!(faults[1].message.to_string().contains("`angle_deg`, largest less smallest, is -30"), "{faults:?}");
        // Two of two are everybody: nobody needs a clause of its own then.
        proposal.expected_events[0].predicate = Predicate::Flow { count: 2, within_m: 4.0, angle_deg: [0.0, 30.0] };
        proposal.expected_events.truncate(1);
        assert_eq!(clauses(&proposal), []);
        assert_eq!(humans(&proposal), []);
    }

    #[test]
    fn a_human_without_a_clause_cannot_be_verified() {
        let mut proposal = crossing_proposal();
        let second = HumanId::new(2);
        proposal.expected_events.retain(|clause| clause.predicate.human() != Some(second));
        let faults = humans(&proposal);
        assert_eq!(codes(&faults), ["P-VERIFY"]);
        assert_eq!(faults[0].at, Where::agent(HumanId::new(2)));
    }

    #[test]
    fn a_wish_needs_a_must_clause_of_its_own() {
        let mut proposal = crossing_proposal();
        let reading = reading_of(&proposal);
        assert!(facts(&proposal, &reading).is_empty());
        for clause in &mut proposal.expected_events {
            clause.must = clause.source.is_empty();
        }
        assert!(!facts(&proposal, &reading).is_empty());
    }

    #[test]
    fn the_robots_result_is_no_part_of_the_setup() {
        let mut proposal = crossing_proposal();
        proposal.expected_events[0].predicate = Predicate::RobotArrives;
        assert_eq!(codes(&clauses(&proposal)), ["P-VERIFY"]);
    }

    #[test]
    fn doubled_ids_and_dangling_orders_are_refused() {
        let mut proposal = crossing_proposal();
        let double = proposal.expected_events[0].id.clone();
        proposal.expected_events[1].id = double;
        proposal.expected_events[2].predicate = Predicate::Order { first: "c1".into(), then: "c99".into() };
        assert_eq!(codes(&clauses(&proposal)), ["P-VERIFY", "P-VERIFY"]);
    }

    #[test]
    fn an_order_speaks_of_those_whose_deeds_it_puts_in_order() {
        let proposal = crossing_proposal();
        let of = |human: u32| {
            let own = |clause: &&Clause| clause.predicate.human() == Some(HumanId::new(human));
            proposal.expected_events.iter().find(own).unwrap().id.clone()
        };
        let ordered = |first: &str, then: &str| {
            let predicate = Predicate::Order { first: first.to_owned(), then: then.to_owned() };
            let clause = Clause { id: "c9".to_owned(), predicate, ..proposal.expected_events[0].clone() };
            [1, 2].map(|human| speaks_of(&clause, HumanId::new(human), &proposal))
        };
        assert_eq!(ordered(&of(1), &of(2)), [true, true]);
        assert_eq!(ordered(&of(2), &of(2)), [false, true]);
        assert_eq!(ordered("c77", "c78"), [false, false]);
    }
}
