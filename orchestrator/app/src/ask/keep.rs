//! What a person changed in a proposal is kept when it is made again: it is put onto the new one.

use socrates_model::{HumanProposal, Proposal};
use socrates_offline::{Draft, settled};
use socrates_prompts::Question;

use super::version::Version;

/// The new version with what the person changed: the difference of `mine` to `base`, which the author had made. Nothing
/// where there is none, or where the new version has it already.
pub(super) fn kept(question: &Question, base: &Version, mine: &Version, came: &Version) -> Option<Version> {
    let (proposal, changed) = merged(&base.proposal, &mine.proposal, &came.proposal);
    if proposal == came.proposal {
        return None;
    }
    let question = Question { reading: came.reading.clone(), ..question.clone() };
    let before = Draft { proposal: came.proposal.clone(), paths: None, behaviors: None };
    let edited = settled(&question, &before, proposal, &changed);
    let mut version = Version { proposal: edited.draft.proposal, reading: edited.reading, ..came.clone() };
    version.sign(came);
    Some(version)
}

/// The new proposal with the person's changes, and the places of those whose part they change.
fn merged(base: &Proposal, mine: &Proposal, came: &Proposal) -> (Proposal, Vec<usize>) {
    let mut new = came.clone();
    let mut changed = Vec::new();
    take(&mut new.title, &base.title, &mine.title);
    take(&mut new.place, &base.place, &mine.place);
    take(&mut new.robot.script, &base.robot.script, &mine.robot.script);
    take(&mut new.robot.start, &base.robot.start, &mine.robot.start);
    take(&mut new.robot.goal, &base.robot.goal, &mine.robot.goal);
    for (place, (own, now)) in mine.humans.iter().zip(&mut new.humans).enumerate() {
        let Some(old) = before(base, mine, place) else { continue };
        let was = now.clone();
        take(&mut now.role, &old.role, &own.role);
        take(&mut now.relation, &old.relation, &own.relation);
        take(&mut now.rules, &old.rules, &own.rules);
        take(&mut now.speed_mps, &old.speed_mps, &own.speed_mps);
        take(&mut now.start, &old.start, &own.start);
        take(&mut now.goal, &old.goal, &own.goal);
        if *now != was {
            changed.push(place);
        }
    }
    // Who joined, where the new proposal has not let them join by itself.
    for (place, own) in mine.humans.iter().enumerate().skip(base.humans.len().max(new.humans.len())) {
        new.humans.push(own.clone());
        changed.push(place);
    }
    if mine.groups != base.groups && mine.humans.len() == new.humans.len() {
        new.groups.clone_from(&mine.groups);
        for (own, now) in mine.humans.iter().zip(&mut new.humans) {
            now.group = own.group;
        }
    }
    (new, changed)
}

/// The human of the author's proposal that the person's human at this place was. Where somebody left, the numbers of those
/// behind are others now, so they are known by what they are.
fn before<'a>(base: &'a Proposal, mine: &Proposal, place: usize) -> Option<&'a HumanProposal> {
    if mine.humans.len() >= base.humans.len() {
        return base.humans.get(place);
    }
    let own = mine.humans.get(place)?;
    base.humans.iter().skip(place).find(|old| old.role == own.role && old.relation == own.relation)
}

/// Takes what the person changed.
fn take<T: PartialEq + Clone>(new: &mut T, base: &T, mine: &T) {
    if mine != base {
        new.clone_from(mine);
    }
}
