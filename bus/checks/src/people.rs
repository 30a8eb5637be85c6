//! The people of the proposal: P-COUNT, P-NAME, P-CAP, P-OTHER.

use std::collections::BTreeSet;

use socrates_model::request::MAX_HUMANS;
use socrates_model::{Action, AgentId, Fault, FaultCode, HumanId, Predicate, Proposal, Rule, Trigger, Where};
use socrates_model::{HumanProposal, Relation};

use crate::lexicon::{ABILITIES, humans_named, impossible};
use crate::list;

/// Smallest and largest distance a trigger may name, m.
pub(crate) const DISTANCE_M: (f64, f64) = (0.3, 15.0);
/// Shortest and longest time that a trigger may wait, s; a rule lasts no longer.
pub(crate) const WAITS_S: (f64, f64) = (0.0, 600.0);
/// Smallest and largest desired speed, m/s.
pub(crate) const SPEED_MPS: (f64, f64) = (0.2, 1.8);

/// Every fault about the humans and groups themselves.
pub(crate) fn check(proposal: &Proposal) -> Vec<Fault> {
    let mut faults = count(proposal);
    faults.extend(names(proposal));
    faults.extend(groups(proposal));
    for human in &proposal.humans {
        faults.extend(abilities(human, proposal));
        faults.extend(others(human, proposal));
    }
    faults
}

fn count(proposal: &Proposal) -> Vec<Fault> {
    let listed = proposal.humans.len();
    let mut faults = Vec::new();
    if listed == 0 || listed > MAX_HUMANS as usize {
        faults.push(Fault::new(
            FaultCode::PCount,
            "humans",
            format!("lists {listed} humans; allowed: 1 to {MAX_HUMANS}"),
        ));
    }
    for clause in &proposal.expected_events {
        if let Predicate::Humans { count } = clause.predicate
            && count as usize != listed
        {
            let message = format!("says {count} humans, but {listed} are listed; the two must agree");
            faults.push(Fault::new(FaultCode::PCount, Where::clause(&clause.id), message));
        }
    }
    faults
}

fn names(proposal: &Proposal) -> Vec<Fault> {
    let found: Vec<HumanId> = proposal.humans.iter().map(|human| human.id).collect();
    let wanted: Vec<HumanId> = (1..).take(found.len()).map(HumanId::new).collect();
    let mut faults = Vec::new();
    if found != wanted {
        let message = format!("are named {}; expected, in this order and each once: {}", list(&found), list(&wanted));
        faults.push(Fault::new(FaultCode::PName, "humans", message));
    }
    for clause in &proposal.expected_events {
        if let Some(id) = clause.predicate.human().filter(|id| !found.contains(id)) {
            let message = format!("speaks of {id}; humans of the proposal: {}", list(&found));
            faults.push(Fault::new(FaultCode::PName, Where::clause(&clause.id), message));
        }
    }
    faults
}

fn groups(proposal: &Proposal) -> Vec<Fault> {
    let mut faults = Vec::new();
    let mut bad = |at: Where, message: String| faults.push(Fault::new(FaultCode::PName, at, message));
    let mut seen = BTreeSet::new();
    for group in &proposal.groups {
        if !seen.insert(group.id) {
            bad(group.id.into(), "is listed twice; number the groups 1, 2, …".to_owned());
        }
        let members: BTreeSet<HumanId> = group.members.iter().copied().collect();
        if members.len() < 2 {
            bad(group.id.into(), format!("has the members {}; a group needs two or more", list(&members)));
        }
        for member in &members {
            match proposal.human(*member) {
                None => bad(group.id.into(), format!("has the member {member}, who is not in the proposal")),
                Some(human) if human.group != Some(group.id) => {
                    let own = human.group.map_or_else(|| "none".to_owned(), |id| id.0.to_string());
                    bad(
                        (*member).into(),
                        format!(
                            "is a member of {}, but their own `group` says {own}; expected {}",
                            group.id, group.id.0
                        ),
                    );
                }
                Some(_) => {}
            }
        }
    }
    for human in &proposal.humans {
        if let Some(id) = human.group
            && !proposal.groups.iter().any(|group| group.id == id && group.members.contains(&human.id))
        {
            bad(human.id.into(), format!("says group {}, but that group does not list it as a member", id.0));
        }
    }
    faults
}

/// P-CAP: words and numbers that cannot be simulated.
fn abilities(human: &HumanProposal, proposal: &Proposal) -> Vec<Fault> {
    let mut faults = Vec::new();
    let mut bad = |at: Where, message: String| faults.push(Fault::new(FaultCode::PCap, at, message));
    if human.behavior.trim().is_empty() {
        bad(human.id.into(), format!("has an empty behavior; say what it does. A human can: {ABILITIES}"));
    }
    let phrases = impossible(&human.behavior);
    if !phrases.is_empty() {
        bad(human.id.into(), format!("cannot be simulated: {}. A human can: {ABILITIES}", list(phrases)));
    }
    if let Some(speed) = human.speed_mps.filter(|speed| !(SPEED_MPS.0..=SPEED_MPS.1).contains(speed)) {
        bad(human.id.into(), format!("walks at {speed} m/s; allowed: {} to {} m/s", SPEED_MPS.0, SPEED_MPS.1));
    }
    for (index, rule) in human.rules.iter().enumerate() {
        for message in rule_faults(human.id, rule, proposal) {
            bad(Where::rule(human.id, index + 1), message);
        }
    }
    for (hiding, hidden) in Rule::hidden(&human.rules) {
        let [first, later] = [hiding, hidden].map(|index| human.rules.get(index).map(Rule::phrase).unwrap_or_default());
        let message = format!(
            "is never played ({later}): rule {} ({first}) holds whenever it does, and earlier rules win; put it first, or \
             let rule {} end by `for`",
            hiding + 1,
            hiding + 1
        );
        bad(Where::rule(human.id, hidden + 1), message);
    }
    faults
}

/// What of a rule cannot be simulated.
fn rule_faults(own: HumanId, rule: &Rule, proposal: &Proposal) -> Vec<String> {
    let mut wrong = Vec::new();
    if rule.when.is_empty() {
        wrong.push("has no trigger; give one or more, `always` for none in particular".to_owned());
    }
    let known = |id: HumanId| id != own && proposal.human(id).is_some();
    let others = || list(proposal.humans.iter().map(|human| human.id).filter(|id| *id != own));
    for trigger in rule.when.iter().chain(&rule.until) {
        match trigger {
            Trigger::RobotVisible(m) | Trigger::RobotNear(m) | Trigger::RobotBlocking(m) => {
                if !(DISTANCE_M.0..=DISTANCE_M.1).contains(m) {
                    wrong.push(format!("has a distance of {m} m; allowed: {} to {} m", DISTANCE_M.0, DISTANCE_M.1));
                }
            }
            Trigger::AfterSecs(s) | Trigger::StoppedFor(s) => {
                if !(WAITS_S.0..=WAITS_S.1).contains(s) {
                    wrong.push(format!("waits {s} s; allowed: {} to {} s", WAITS_S.0, WAITS_S.1));
                }
            }
            Trigger::Did(id, step) => {
                let steps = proposal.human(*id).map_or(0, HumanProposal::steps);
                if *step == 0 || *step > steps {
                    wrong.push(format!("waits for step {step} of {id}, who has {steps} steps"));
                }
            }
            Trigger::Done(id) => {
                if !known(*id) {
                    wrong.push(format!("waits for {id}; allowed: {}", others()));
                }
            }
            Trigger::HumanSays(id, _) => {
                if !known(*id) {
                    wrong.push(format!("listens to {id}; allowed: {}", others()));
                }
            }
            Trigger::Always
            | Trigger::RobotMoving
            | Trigger::RobotStopped
            | Trigger::RobotPassed
            | Trigger::RobotSays(_)
            | Trigger::GoalReached
            | Trigger::AtEncounter => {}
        }
    }
    if let Action::FollowHuman(id) | Action::LookAt(id) = rule.act
        && !known(id)
    {
        wrong.push(format!("{}; allowed: {}", rule.act.phrase(), others()));
    }
    if let Some(AgentId::Human(id)) = rule.to
        && !known(id)
    {
        wrong.push(format!("makes a sign to {id}; allowed: {}", others()));
    }
    if let Some(s) = rule.for_s.filter(|s| !(*s > 0.0 && *s <= WAITS_S.1)) {
        wrong.push(format!("lasts {s} s; allowed: more than 0 and at most {} s", WAITS_S.1));
    }
    wrong
}

/// P-OTHER: prose that depends on another human who is neither followed, heard nor of the same group.
fn others(human: &HumanProposal, proposal: &Proposal) -> Vec<Fault> {
    let tied = |id: HumanId| {
        let by_rule = human.rules.iter().any(|rule| {
            rule.act == Action::FollowHuman(id)
                || rule.act == Action::LookAt(id)
                || rule.to == Some(AgentId::Human(id))
                || rule.when.iter().chain(&rule.until).any(|trigger| {
                    matches!(trigger,
                    Trigger::HumanSays(other, _) | Trigger::Did(other, _) | Trigger::Done(other) if *other == id)
                })
        });
        let by_group = human.group.is_some() && proposal.human(id).is_some_and(|other| other.group == human.group);
        by_rule || by_group || human.relation == Relation::Staying
    };
    humans_named(&human.behavior)
        .into_iter()
        .map(HumanId::new)
        .filter(|id| *id != human.id && !tied(*id))
        .map(|id| {
            let message = format!(
                "the behavior depends on {id}; they may only follow another human or react to their gesture, as a rule \
                 (`follow_human`, `human_says`). Otherwise speak of {} and the robot alone",
                human.id
            );
            Fault::new(FaultCode::POther, human.id, message)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{codes, crossing_proposal, plus_map};

    fn faults(change: impl FnOnce(&mut Proposal)) -> Vec<Fault> {
        let mut proposal = crossing_proposal();
        change(&mut proposal);
        crate::proposal::check_alone(&proposal, &plus_map())
    }

    #[test]
    fn a_gap_in_the_numbering_is_refused() {
        let faults = faults(|proposal| proposal.humans[1].id = HumanId::new(3));
        assert!(codes(&faults).contains(&"P-NAME".to_owned()), "{faults:?}");
    }

    #[test]
    fn the_count_clause_must_agree_with_the_list() {
        let faults = faults(|proposal| {
            if let Predicate::Humans { count } = &mut proposal.expected_events[0].predicate {
                *count = 5;
            }
        });
        assert_eq!(codes(&faults), ["P-COUNT"]);
    }

    #[test]
    fn hands_are_not_simulated_and_all_phrases_are_named_at_once() {
        let faults = faults(|proposal| proposal.humans[0].behavior = "picks up a box, then sits.".into());
        assert_eq!(codes(&faults), ["P-CAP"]);
        assert!(faults[0].message.to_string().contains("`picks up`, `sits`"), "{}", faults[0].message);
    }

    #[test]
    fn looking_at_what_another_human_does_is_refused_but_following_is_not() {
        let watch = |proposal: &mut Proposal| proposal.humans[0].behavior = "watches what human 2 is doing".into();
        assert_eq!(codes(&faults(watch)), ["P-OTHER"]);
        let follow = |proposal: &mut Proposal| {
            proposal.humans[0].behavior = "walks after human 2".into();
            proposal.humans[0].rules[0].act = Action::FollowHuman(HumanId::new(2));
        };
        assert_eq!(codes(&faults(follow)), Vec::<String>::new());
    }

    #[test]
    fn a_rule_that_an_earlier_one_hides_is_refused_and_one_that_ends_hides_nothing() {
        let rule = |when: Trigger, act| Rule { when: vec![when], act, ..Rule::default() };
        let with = |first: Rule, later: Rule| {
            let found = faults(|proposal| proposal.humans[0].rules = vec![first, later]);
            found.into_iter().filter(|fault| fault.code == FaultCode::PCap).count()
        };
        let looks = rule(Trigger::RobotVisible(5.0), Action::LookAtRobot);
        let flees = || rule(Trigger::RobotVisible(3.0), Action::RunAway);
        assert_eq!(with(looks.clone(), flees()), 1);
        assert_eq!(with(flees(), looks.clone()), 0);
        assert_eq!(with(Rule { for_s: Some(3.0), ..looks.clone() }, flees()), 0);
        assert_eq!(with(looks, rule(Trigger::RobotNear(3.0), Action::RunAway)), 0, "near, and out of sight");
        assert_eq!(with(rule(Trigger::Always, Action::Navigate), flees()), 1);
    }

    #[test]
    fn numbers_out_of_range_and_strangers_are_refused() {
        let faults = faults(|proposal| {
            proposal.humans[0].rules[0].when = vec![Trigger::RobotNear(40.0)];
            proposal.humans[1].speed_mps = Some(3.0);
            proposal.humans[1].group = Some(socrates_model::GroupId(7));
        });
        assert_eq!(codes(&faults), ["P-NAME", "P-CAP", "P-CAP"]);
    }
}
