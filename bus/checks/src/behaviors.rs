//! The trees against the proposal and against each other: `B-` faults.

use std::collections::{BTreeMap, BTreeSet};

use socrates_bt::{CheckContext, Tree};
use socrates_model::{Behaviors, Fault, FaultCode, Gesture, HumanId, Location, Proposal, Rule};

use crate::list;
use crate::proposal::robot_says;

/// Every fault of the trees: one for each human, well formed, hearing only what somebody says, doing what the proposal asks.
///
/// The location is part of the contract of all checks; trees name places only by role, so nothing of it is needed yet.
#[must_use]
pub fn check_behaviors(behaviors: &Behaviors, proposal: &Proposal, _location: &Location) -> Vec<Fault> {
    let mut faults = agents(behaviors, proposal);
    let mut trees: BTreeMap<HumanId, Tree> = BTreeMap::new();
    for (id, behavior) in &behaviors.humans {
        match Tree::parse(&behavior.tree) {
            Ok(tree) => {
                trees.insert(*id, tree);
            }
            Err(wrong) => faults.extend(wrong.into_iter().map(|fault| fault.of(*id))),
        }
    }
    let human_says: BTreeMap<HumanId, Vec<Gesture>> =
        trees.iter().map(|(id, tree)| (*id, tree.gestures_made().into_iter().collect())).collect();
    let said = robot_says(proposal);
    let humans = u32::try_from(proposal.humans.len()).unwrap_or(u32::MAX);
    for (id, tree) in &trees {
        let rules: &[Rule] = proposal.human(*id).map_or(&[], |human| human.rules.as_slice());
        let ctx = CheckContext { human: *id, humans, robot_says: &said, human_says: &human_says, rules };
        faults.extend(socrates_bt::check(tree, &ctx).into_iter().map(|fault| fault.of(*id)));
    }
    faults
}

fn agents(behaviors: &Behaviors, proposal: &Proposal) -> Vec<Fault> {
    let wanted: BTreeSet<HumanId> = proposal.humans.iter().map(|human| human.id).collect();
    let found: BTreeSet<HumanId> = behaviors.humans.keys().copied().collect();
    if wanted == found {
        return Vec::new();
    }
    let message = format!(
        "trees are missing for {}, surplus for {}; give exactly one for each of {}",
        list(wanted.difference(&found)),
        list(found.difference(&wanted)),
        list(&wanted)
    );
    vec![Fault::new(FaultCode::BAgents, "humans", message)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{codes, crossing_proposal, hard_codes, plus_map};
    use socrates_model::{FORMAT, HumanBehavior};

    fn compiled(proposal: &Proposal) -> Behaviors {
        let humans = proposal.humans.iter().map(|human| {
            let tree = socrates_bt::compile(human.id, &human.rules).unwrap();
            (human.id, HumanBehavior { tree, description: String::new() })
        });
        Behaviors { format: FORMAT, humans: humans.collect(), author: "test".into() }
    }

    #[test]
    fn compiled_rules_pass_their_own_proposal() {
        let proposal = crossing_proposal();
        assert_eq!(hard_codes(&check_behaviors(&compiled(&proposal), &proposal, &plus_map())), Vec::<String>::new());
    }

    #[test]
    fn a_missing_tree_and_a_stranger_are_named() {
        let proposal = crossing_proposal();
        let mut behaviors = compiled(&proposal);
        let tree = behaviors.humans.remove(&HumanId::new(2)).unwrap();
        behaviors.humans.insert(HumanId::new(5), tree);
        let faults = check_behaviors(&behaviors, &proposal, &plus_map());
        assert!(codes(&faults).contains(&"B-AGENTS".to_owned()), "{faults:?}");
    }

    #[test]
    fn broken_xml_names_its_human() {
        let proposal = crossing_proposal();
        let mut behaviors = compiled(&proposal);
        if let Some(behavior) = behaviors.humans.get_mut(&HumanId::new(1)) {
            behavior.tree.truncate(behavior.tree.len() / 2);
        }
        let faults = check_behaviors(&behaviors, &proposal, &plus_map());
        assert!(
            faults.iter().any(|fault| fault.code == FaultCode::BXml && fault.at.to_string().starts_with("human_1")),
            "{faults:?}"
        );
    }

    #[test]
    fn swapped_trees_do_not_match_the_proposal() {
        let proposal = crossing_proposal();
        let mut behaviors = compiled(&proposal);
        let (one, two) = (HumanId::new(1), HumanId::new(2));
        let (first, second) = (behaviors.humans[&one].clone(), behaviors.humans[&two].clone());
        behaviors.humans.insert(one, second);
        behaviors.humans.insert(two, first);
        let codes = codes(&check_behaviors(&behaviors, &proposal, &plus_map()));
        assert!(codes.contains(&"B-MATCH".to_owned()), "{codes:?}");
    }
}
