//! `[expect]` wins over the text: how many people there are, where they meet the robot, who is a group.

use socrates_model::{Fault, FaultCode, GroupId, Reading, Request, Rule};

use crate::story::{Group, Person, Story};

/// `[expect]` wins over the text.
pub(crate) fn settle(request: &Request, story: &mut Story, reading: &mut Reading) {
    if let Some(count) = request.expect.headcount() {
        let wanted = usize::try_from(count).unwrap_or(0);
        let read = story.people.len();
        // Groups name how many there are at least.
        let key = if request.expect.humans.is_some() { "humans" } else { "groups" };
        if wanted > 0 && std::mem::take(&mut story.nobody) {
            story.problems.retain(|fault| fault.code != FaultCode::PLimit);
        }
        if read > 0 && wanted > 0 && (read < wanted || read != wanted && key == "humans") {
            reading.notes.push(format!("the text speaks of {read} humans, `expect.{key}` of {wanted}; it is {wanted}"));
            story.people.truncate(wanted);
            let like = alike(&story.people);
            let before = story.people.len();
            story.people.resize_with(wanted, || like.clone().unwrap_or_default());
            if let Some(group) = story.groups.first_mut().filter(|_| like.is_some_and(|one| one.group.is_some())) {
                group.members.extend(before..wanted);
            }
            for group in &mut story.groups {
                group.members.retain(|i| *i < wanted);
            }
            story.groups.retain(|group| group.members.len() > 1);
            story.problems.retain(|fault| fault.code != FaultCode::PLimit);
        }
        if key == "humans" {
            story.count_quote = Some(format!("expect.humans = {count}"));
        }
    }
    if let Some(class) = request.expect.place {
        story.place = Some((class, format!("expect.place = \"{class}\"")));
        // A place that no map has is no place of the scenario then.
        for fault in story.problems.extract_if(.., |fault| fault.code == FaultCode::PPlace) {
            reading.notes.push(format!("{}; `expect.place` says where it happens", fault.message));
        }
    }
    let read = story.people.len();
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
        regroup(story, &members);
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
fn regroup(story: &mut Story, members: &[usize]) {
    let same =
        |group: &Group| group.members.len() == members.len() && members.iter().all(|i| group.members.contains(i));
    if story.groups.iter().any(same) {
        return;
    }
    for group in &mut story.groups {
        group.members.retain(|i| !members.contains(i));
    }
    story.groups.retain(|group| group.members.len() > 1);
    story.groups.push(Group {
        id: GroupId(0),
        members: members.to_vec(),
        queue: false,
        quote: "expect.groups".to_owned(),
    });
    for person in &mut story.people {
        person.group = None;
    }
    // Ids stay one to n.
    for (id, group) in (1..).map(GroupId).zip(&mut story.groups) {
        group.id = id;
        for member in &group.members {
            if let Some(person) = story.people.get_mut(*member) {
                person.group = Some(id);
            }
        }
    }
}
