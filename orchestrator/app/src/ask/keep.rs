//! What a person changed in a proposal is kept when it is made again: it is put onto the new one.
//!
//! An author that writes from the request alone knows nothing of the changes: they win. A model was shown what the person left: where
//! it says something new, that is its answer to the person; where it fell back to its own former words, the change is put back.

use socrates_model::{HumanProposal, Proposal};
use socrates_offline::{Draft, settled};
use socrates_prompts::Question;

use super::version::Version;

/// Whether the author saw what the person had changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Shown {
    /// It wrote from the request alone.
    Nothing,
    /// It was shown what the person left.
    Changes,
}

/// The new version with what the person changed: the difference of `mine` to `base`, which the author had made. Nothing
/// where there is none, or where the new version has it already.
pub(super) fn kept(
    question: &Question,
    base: &Version,
    mine: &Version,
    came: &Version,
    shown: Shown,
) -> Option<Version> {
    let (proposal, changed) = merged(&base.proposal, &mine.proposal, &came.proposal, shown);
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
fn merged(base: &Proposal, mine: &Proposal, came: &Proposal, shown: Shown) -> (Proposal, Vec<usize>) {
    let mut new = came.clone();
    let mut changed = Vec::new();
    take(shown, &mut new.title, &base.title, &mine.title);
    take(shown, &mut new.place, &base.place, &mine.place);
    take(shown, &mut new.robot.script, &base.robot.script, &mine.robot.script);
    take(shown, &mut new.robot.start, &base.robot.start, &mine.robot.start);
    take(shown, &mut new.robot.goal, &base.robot.goal, &mine.robot.goal);
    for (place, (own, now)) in mine.humans.iter().zip(&mut new.humans).enumerate() {
        let Some(old) = before(base, mine, place) else { continue };
        let was = now.clone();
        take(shown, &mut now.role, &old.role, &own.role);
        take(shown, &mut now.relation, &old.relation, &own.relation);
        take(shown, &mut now.rules, &old.rules, &own.rules);
        take(shown, &mut now.speed_mps, &old.speed_mps, &own.speed_mps);
        take(shown, &mut now.start, &old.start, &own.start);
        take(shown, &mut now.goal, &old.goal, &own.goal);
        if *now != was {
            changed.push(place);
        }
    }
    // Those who joined, where the new proposal has not let them join by itself.
    for (place, own) in mine.humans.iter().enumerate().skip(base.humans.len().max(new.humans.len())) {
        new.humans.push(own.clone());
        changed.push(place);
    }
    if stands(shown, &new.groups, &base.groups, &mine.groups) && mine.humans.len() == new.humans.len() {
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

/// Takes what the person changed, where it stands.
fn take<T: PartialEq + Clone>(shown: Shown, new: &mut T, base: &T, mine: &T) {
    if stands(shown, new, base, mine) {
        new.clone_from(mine);
    }
}

/// Whether what the person changed stands: an author that saw it has the last word where it says something new.
fn stands<T: PartialEq>(shown: Shown, new: &T, base: &T, mine: &T) -> bool {
    mine != base && (shown == Shown::Nothing || new == base)
}
