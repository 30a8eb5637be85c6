//! `[expect]` wins over the text: how many people there are, where they meet the robot, who is a group.

use socrates_model::{Fault, FaultCode, GroupId, Reading, Request, Rule};

use crate::cast::{Cast, Person};
use crate::story::Story;

/// `[expect]` wins over the text.
pub(crate) fn settle(request: &Request, story: &mut Story, reading: &mut Reading) {
    if let Some(count) = request.expect.headcount() {
        let wanted = usize::try_from(count).unwrap_or(0);
        let read = story.cast.people.len();
        // Groups name how many there are at least.
        let key = if request.expect.humans.is_some() { "humans" } else { "groups" };
        if wanted > 0 && story.cast.nobody.take().is_some() {
            story.problems.retain(|fault| fault.code != FaultCode::PLimit);
        }
        if read > 0 && wanted > 0 && (read < wanted || read != wanted && key == "humans") {
            reading.notes.push(format!("the text speaks of {read} humans, `expect.{key}` of {wanted}; it is {wanted}"));
            story.cast.people.truncate(wanted);
            let like = alike(&story.cast.people);
            let before = story.cast.people.len();
            story.cast.people.resize_with(wanted, || like.clone().unwrap_or_default());
            if let Some((_, members, _)) =
                story.cast.groups.first_mut().filter(|_| like.is_some_and(|one| one.group.is_some()))
            {
                members.extend(before..wanted);
            }
            for (_, members, _) in &mut story.cast.groups {
                members.retain(|i| *i < wanted);
            }
            story.cast.groups.retain(|(_, members, _)| members.len() > 1);
            story.problems.retain(|fault| fault.code != FaultCode::PLimit);
            story.cast.problems.retain(|fault| fault.code != FaultCode::PLimit);
        }
        if key == "humans" {
            story.cast.count_quote = Some(format!("expect.humans = {count}"));
        }
    }
    if let Some(class) = request.expect.place {
        story.place = Some((class, format!("expect.place = \"{class}\"")));
        // A place that no map has is no place of the scenario then.
        for fault in story.problems.extract_if(.., |fault| fault.code == FaultCode::PPlace) {
            reading.notes.push(format!("{}; `expect.place` says where it happens", fault.message));
        }
    }
    let read = story.cast.people.len();
    for numbers in &request.expect.groups {
        let members: Vec<usize> = numbers.iter().filter_map(|n| usize::try_from(*n).ok()?.checked_sub(1)).collect();
        // Where the text names nobody, the pattern's people are grouped so.
        if read == 0 {
            continue;
        }
        if let Some(nobody) = members.iter().find(|i| **i >= read) {
            reading.problems.push(Fault::new(
                FaultCode::PContra,
                "expect.groups",
                format!(
                    "{numbers:?} names human_{}, but the text speaks of {read}; correct one of the two",
                    nobody + 1
                ),
            ));
            continue;
        }
        regroup(&mut story.cast, &members);
    }
}

/// What everybody does, where everybody does the same: whoever `[expect]` adds does so too.
fn alike(people: &[Person]) -> Option<Person> {
    let relation = |person: &Person| person.relation.as_ref().map(|(relation, _)| *relation);
    let rules = |person: &Person| person.rules.iter().map(|read| read.rule.clone()).collect::<Vec<Rule>>();
    let first = people.first()?;
    let same = |other: &Person| {
        (relation(other), rules(other), other.group, &other.role, &other.doings)
            == (relation(first), rules(first), first.group, &first.role, &first.doings)
    };
    people.iter().all(same).then(|| first.clone())
}

/// A group that wins over those of the text: its members are in no other.
fn regroup(cast: &mut Cast, members: &[usize]) {
    if cast.groups.iter().any(|(_, known, _)| known.len() == members.len() && members.iter().all(|i| known.contains(i)))
    {
        return;
    }
    for (_, known, _) in &mut cast.groups {
        known.retain(|i| !members.contains(i));
    }
    for (_, alone, _) in cast.groups.extract_if(.., |(_, known, _)| known.len() < 2) {
        for i in alone {
            if let Some(person) = cast.people.get_mut(i) {
                person.group = None;
            }
        }
    }
    // Ids stay one to n.
    for (id, (own, members, _)) in (1..).map(GroupId).zip(&mut cast.groups) {
        *own = id;
        for i in members.iter() {
            if let Some(person) = cast.people.get_mut(*i) {
                person.group = Some(id);
            }
        }
    }
    cast.group(members, "expect.groups");
}
