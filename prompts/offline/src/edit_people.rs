//! Edits of people: who is there, what they do, how fast.

use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use socrates_model::rule::RobotDo;
use socrates_model::{
    Action, AgentId, ClauseRole, FactKind, GroupId, GroupProposal, HumanId, HumanProposal, Predicate, Proposal,
    Relation, Rule, Trigger,
};
use socrates_reader::{Fate, Read, Reader};

use crate::desk::Desk;
use crate::edit_paths;
use crate::edit_whom::{Crowd, Whom};
use crate::edit_wish::Wish;
use crate::story::{ReadRule, Story};
use crate::{manner, place, prose, told};

/// Desired speed of somebody who has none of its own, m/s.
const USUAL_MPS: f64 = 1.2;

/// New people, and what somebody does now.
pub(crate) fn story(desk: &mut Desk, wish: &Wish, crowd: &mut Crowd) {
    let old = crowd.len();
    let said = crowd.read(wish);
    let unread = unread(&said, &wish.quote);
    let mut read = told::told(&wish.quote, &said);
    if read.people.len() > old && !wish.adds {
        return desk.refuse(&wish.quote, "does not say which of those who are there is meant");
    }
    for fault in std::mem::take(&mut read.problems) {
        desk.refuse(&wish.quote, &format!("is not clear: {}", fault.message));
    }
    if !unread.is_empty() {
        desk.left_out.push(unread.join(" "));
    }
    let mut did = false;
    for who in 0..old {
        did |= changed(desk, who, &read, wish);
    }
    for who in old..read.people.len() {
        did |= joins(desk, who, &read, wish);
    }
    for (gesture, _) in &read.robot_says {
        let says = |line: &socrates_model::rule::RobotRule| line.act == RobotDo::Say(*gesture);
        if !desk.draft.proposal.robot.script.iter().any(says) {
            let when = socrates_model::rule::RobotWhen::HumanNear(4.0);
            desk.draft
                .proposal
                .robot
                .script
                .push(socrates_model::rule::RobotRule { when, act: RobotDo::Say(*gesture) });
            desk.done.push(format!("the robot gestures {gesture} when somebody is near"));
        }
        did = true;
    }
    let new: Vec<(GroupId, Vec<usize>)> = read.groups.iter().map(|group| (group.id, group.members.clone())).collect();
    for (_, members) in new {
        did |= group(desk, &members);
    }
    let there = desk.draft.proposal.humans.len();
    let last = match crowd.whom(wish) {
        Whom::People(people) => people,
        Whom::Robot | Whom::Unsaid => (old..there).collect(),
    };
    crowd.now(&desk.draft.proposal, last);
    if !did && desk.not_done.is_empty() && unread.is_empty() {
        desk.refuse(&wish.quote, "was not understood");
    }
}

/// Words of which the reader made nothing, or nothing that is played.
fn unread<'a>(said: &Read, text: &'a str) -> Vec<&'a str> {
    let lost = said.pieces.iter().filter(|piece| matches!(piece.fate, Fate::NotRead | Fate::NotPlayed(_)));
    lost.filter_map(|piece| text.get(piece.at.clone())).collect()
}

/// What the edit says of somebody who is there already.
fn changed(desk: &mut Desk, who: usize, read: &Story, wish: &Wish) -> bool {
    let (Some(said), Some(human)) = (read.people.get(who), desk.draft.proposal.humans.get(who).cloned()) else {
        return false;
    };
    let mut new = human.clone();
    for (act, _) in &said.never {
        let words = manner::actions(*act);
        new.rules.retain(|rule| !words.iter().any(|other| same_act(&rule.act, other)));
    }
    for rule in &said.rules {
        put(&mut new.rules, rule);
    }
    if let Some((relation, _)) = &said.relation {
        let meant = *relation != Relation::Static || said.rules.is_empty();
        if meant && *relation != new.relation {
            new.relation = *relation;
        }
    }
    new.speed_mps = said.speed_mps.or(new.speed_mps).map(|mps| mps.clamp(0.2, 1.8));
    if new == human {
        return false;
    }
    let moved = new.relation != human.relation;
    let id = new.id;
    let slot = desk.draft.proposal.humans.get_mut(who);
    if let Some(slot) = slot {
        *slot = new.clone();
    }
    if moved && desk.draft.paths.is_some() && !edit_paths::anew(desk, who) {
        if let Some(slot) = desk.draft.proposal.humans.get_mut(who) {
            *slot = human;
        }
        desk.refuse(&wish.quote, "finds no way on this map beside the robot's path");
        return true;
    }
    desk.touch(who);
    let place = desk.draft.proposal.place;
    let text = prose::behavior(&new.role, new.relation, place, new.start, &new.rules, new.group.is_some());
    desk.done.push(format!("{id}: {text}"));
    true
}

pub(crate) fn same_act(a: &Action, b: &Action) -> bool {
    std::mem::discriminant(a) == std::mem::discriminant(b)
}

/// A rule in the place of the one that does the same, else behind the others; what is not said stays.
fn put(rules: &mut Vec<Rule>, read: &ReadRule) {
    let known = rules.iter_mut().find(|rule| {
        same_act(&rule.act, &read.rule.act)
            && rule.gesture.is_some() == (read.rule.gesture.is_some() && rule.gesture.is_some())
            || read.rule.gesture.is_some() && rule.gesture == read.rule.gesture
    });
    let Some(old) = known else {
        // Before whatever goes on for good, behind which nothing would ever be done.
        let at = rules.iter().position(|rule| rule.for_s.is_none()).unwrap_or(rules.len());
        rules.insert(at, read.rule.clone());
        return;
    };
    old.act.clone_from(&read.rule.act);
    if read.stated {
        // A distance without a trigger of its own is that of the trigger that is there.
        let meters = read.rule.when.first().and_then(Trigger::distance_m);
        let keeps = !read.exact || matches!(read.rule.when.as_slice(), [Trigger::RobotVisible(_)]);
        match (old.when.as_slice(), meters) {
            ([Trigger::RobotNear(_)], Some(m)) if keeps => old.when = vec![Trigger::RobotNear(m)],
            _ => old.when.clone_from(&read.rule.when),
        }
    }
    if read.lasts {
        old.for_s = read.rule.for_s;
    }
    old.gesture = read.rule.gesture.or(old.gesture);
}

/// Somebody new.
fn joins(desk: &mut Desk, who: usize, read: &Story, wish: &Wish) -> bool {
    let Some(said) = read.people.get(who) else { return false };
    let number = u32::try_from(desk.draft.proposal.humans.len() + 1).unwrap_or(u32::MAX);
    if number > socrates_model::request::MAX_HUMANS {
        desk.refuse(&wish.quote, &format!("asks for more than {} humans", socrates_model::request::MAX_HUMANS));
        return false;
    }
    let class = wish.place.or_else(|| read.place.as_ref().map(|(class, _)| *class));
    if let Some(class) = class.filter(|class| !place::has(&desk.question.location, *class)) {
        desk.no_place(&wish.quote, &format!("asks for {}, which the map does not have", place::an(class)));
        return false;
    }
    let waits = said.rules.iter().all(|read| read.rule.act == Action::StandStill && !read.stated);
    let stands = said.relation.as_ref().is_none_or(|(relation, _)| *relation == Relation::Static);
    let at_place = class.is_some() && waits && stands;
    let relation = if at_place { Relation::Static } else { read.relation_of(who).unwrap_or(Relation::Frontal) };
    // Somebody who only waits somewhere stands there all the time.
    let rules: Vec<Rule> = if relation == Relation::Static && waits {
        Vec::new()
    } else {
        said.rules.iter().map(|read| read.rule.clone()).collect()
    };
    let role = if said.role.is_empty() { "person".to_owned() } else { said.role.clone() };
    let behavior =
        prose::behavior(&role, relation, class.unwrap_or(desk.draft.proposal.place), said.start, &rules, false);
    let human = HumanProposal {
        id: HumanId::new(number),
        role,
        behavior,
        relation,
        side: None,
        facing: None,
        rules,
        group: None,
        speed_mps: said.speed_mps.or_else(|| Reader::shipped().pace_of(&said.role)),
        start: said.start,
        goal: None,
    };
    desk.draft.proposal.humans.push(human.clone());
    let place = desk.draft.proposal.humans.len() - 1;
    if desk.draft.paths.is_some() && !edit_paths::join(desk, place, class.filter(|_| at_place)) {
        desk.draft.proposal.humans.pop();
        let at = class.map_or_else(String::new, |class| format!(" at {} that the robot passes", place::an(class)));
        desk.refuse(&wish.quote, &format!("finds no free way{at}"));
        return false;
    }
    desk.touch(place);
    desk.done.push(format!("{} joins: {}", human.id, human.behavior));
    true
}

pub(crate) fn group(desk: &mut Desk, members: &[usize]) -> bool {
    let proposal = &mut desk.draft.proposal;
    let ids: Vec<HumanId> = members.iter().filter_map(|i| proposal.humans.get(*i)).map(|human| human.id).collect();
    if ids.len() < 2 || proposal.groups.iter().any(|group| group.members == ids) {
        return false;
    }
    let id = GroupId(proposal.groups.iter().map(|group| group.id.0).max().unwrap_or(0) + 1);
    let standing =
        members.iter().all(|i| proposal.humans.get(*i).is_some_and(|human| human.relation == Relation::Static));
    for i in members {
        if let Some(human) = proposal.humans.get_mut(*i) {
            human.group = Some(id);
        }
    }
    let listed: Vec<String> = ids.iter().map(HumanId::to_string).collect();
    proposal.groups.push(GroupProposal { id, members: ids, standing });
    let predicate = if standing {
        Predicate::Formation { group: id, spread_m: 1.8 }
    } else {
        Predicate::WalksTogether { group: id, spread_m: 2.5 }
    };
    let text = format!("{id} {}", if standing { "stands in a circle" } else { "walks together" });
    clause(proposal, text, predicate);
    edit_paths::together(desk, members);
    desk.done.push(format!("{} form {id}", listed.join(" and ")));
    true
}

/// Takes people out of the groups they are in; a group of one is none.
pub(crate) fn leave_groups(desk: &mut Desk, members: &[usize]) {
    let proposal = &mut desk.draft.proposal;
    let ids: Vec<HumanId> = members.iter().filter_map(|i| proposal.humans.get(*i)).map(|human| human.id).collect();
    if proposal.groups.iter().any(|group| group.members == ids) {
        return;
    }
    for group in &mut proposal.groups {
        group.members.retain(|id| !ids.contains(id));
    }
    proposal.groups.retain(|group| group.members.len() > 1);
    let left: Vec<GroupId> = proposal.groups.iter().map(|group| group.id).collect();
    for human in &mut proposal.humans {
        human.group = human.group.filter(|id| left.contains(id) && !ids.contains(&human.id));
    }
    proposal.expected_events.retain(|clause| clause.predicate.group().is_none_or(|id| left.contains(&id)));
}

fn clause(proposal: &mut Proposal, text: String, predicate: Predicate) {
    let clause = socrates_model::Clause {
        id: next_id(proposal),
        text,
        role: ClauseRole::Setup,
        must: true,
        source: String::new(),
        predicate,
    };
    proposal.expected_events.push(clause);
}

pub(crate) fn next_id(proposal: &Proposal) -> String {
    let highest =
        proposal.expected_events.iter().filter_map(|clause| clause.id.strip_prefix('c')?.parse::<u32>().ok()).max();
    format!("c{}", highest.unwrap_or(0) + 1)
}

/// Somebody is slower or faster than before.
pub(crate) fn pace(desk: &mut Desk, wish: &Wish, crowd: &mut Crowd, factor: f64) {
    let people = match crowd.whom(wish) {
        Whom::People(people) => people,
        Whom::Robot => return desk.refuse(&wish.quote, "speaks of the robot, whose speed is that of its model"),
        Whom::Unsaid if crowd.len() == 1 => vec![0],
        Whom::Unsaid => return desk.refuse(&wish.quote, "does not say who"),
    };
    let mut did = false;
    for who in people {
        let Some(human) = desk.draft.proposal.humans.get_mut(who) else { continue };
        let before = human.speed_mps.unwrap_or(USUAL_MPS);
        let mps = (libm::round(before * factor * 10.0) / 10.0).clamp(0.3, 1.8);
        if mps.total_cmp(&before).is_eq() {
            continue;
        }
        did = true;
        human.speed_mps = Some(mps);
        let line = format!("{} walks at {mps} m/s instead of {before} m/s", human.id);
        desk.done.push(line);
    }
    if !did {
        desk.refuse(&wish.quote, "changes nothing: people walk at 0.3 to 1.8 m/s");
    }
}

/// Nobody gestures any more, or only these do not.
pub(crate) fn no_gestures(desk: &mut Desk, wish: &Wish, crowd: &mut Crowd) {
    // `remove all gestures` speaks of nobody in particular.
    let whom = if wish.everybody { Whom::Unsaid } else { crowd.whom(wish) };
    let count = desk.draft.proposal.humans.len();
    let people = if let Whom::People(people) = &whom { people.clone() } else { (0..count).collect() };
    let mut did = false;
    if !matches!(whom, Whom::Robot) {
        for who in people {
            let Some(human) = desk.draft.proposal.humans.get_mut(who) else { continue };
            let before = human.rules.clone();
            // Somebody who walked on with a gesture just walks on.
            human.rules.retain(|rule| rule.gesture.is_none() || rule.act != Action::Navigate);
            for rule in &mut human.rules {
                rule.gesture = None;
                rule.when.retain(|trigger| !matches!(trigger, Trigger::HumanSays(..)) || rule.act == Action::Navigate);
                if rule.when.is_empty() {
                    rule.when = vec![Trigger::RobotVisible(4.0)];
                }
            }
            if human.rules != before {
                let line = format!("{} makes no gesture", human.id);
                desk.done.push(line);
                desk.touch(who);
                did = true;
            }
        }
    }
    if !matches!(whom, Whom::People(_)) {
        let script = &mut desk.draft.proposal.robot.script;
        let before = script.len();
        script.retain(|line| !matches!(line.act, RobotDo::Say(_)));
        if script.len() < before {
            desk.done.push("the robot makes no gesture".to_owned());
            did = true;
            deaf(desk);
        }
    }
    if !did {
        desk.refuse(&wish.quote, "changes nothing: nobody of them gestures");
    }
}

/// People who waited for a word of the robot react to its nearness.
fn deaf(desk: &mut Desk) {
    for who in 0..desk.draft.proposal.humans.len() {
        let Some(human) = desk.draft.proposal.humans.get_mut(who) else { continue };
        let mut waited = false;
        for trigger in human.rules.iter_mut().flat_map(|rule| &mut rule.when) {
            if matches!(trigger, Trigger::RobotSays(_)) {
                (*trigger, waited) = (Trigger::RobotNear(3.0), true);
            }
        }
        if waited {
            let line = format!("{} waited for a gesture of the robot and reacts now when it is within 3 m", human.id);
            desk.done.push(line);
            desk.touch(who);
        }
    }
}

/// A group is no group any more.
pub(crate) fn ungroup(desk: &mut Desk, wish: &Wish) {
    if desk.draft.proposal.groups.is_empty() {
        return desk.refuse(&wish.quote, "changes nothing: there is no group");
    }
    desk.draft.proposal.groups.clear();
    for who in 0..desk.draft.proposal.humans.len() {
        let Some(human) = desk.draft.proposal.humans.get_mut(who).filter(|human| human.group.is_some()) else {
            continue;
        };
        human.group = None;
        desk.touch(who);
    }
    desk.draft.proposal.expected_events.retain(|clause| clause.predicate.group().is_none());
    desk.done.push("the group is no group any more; everybody keeps path and reactions".to_owned());
}

/// Somebody leaves the scenario.
pub(crate) fn remove(desk: &mut Desk, wish: &Wish, crowd: &mut Crowd) {
    let mut out = if wish.group {
        let humans = desk.draft.proposal.humans.iter().enumerate();
        humans.filter(|(_, human)| human.group.is_some()).map(|(place, _)| place).collect()
    } else {
        match crowd.whom(wish) {
            Whom::People(people) => people,
            Whom::Robot => return desk.refuse(&wish.quote, "speaks of the robot, without which there is no scenario"),
            Whom::Unsaid => Vec::new(),
        }
    };
    out.sort_unstable();
    // `the second and human_2` is one person.
    out.dedup();
    if out.is_empty() {
        return desk.refuse(&wish.quote, "means nobody who is there");
    }
    if out.len() >= desk.draft.proposal.humans.len() {
        return desk.refuse(&wish.quote, "would leave nobody; a social scenario needs a human");
    }
    let gone: Vec<HumanId> =
        out.iter().filter_map(|i| desk.draft.proposal.humans.get(*i)).map(|human| human.id).collect();
    for who in &out {
        let Some(human) = desk.draft.proposal.humans.get(*who) else { continue };
        let line = format!(" {}: {}", human.id, human.behavior);
        desk.draft.proposal.description = desk.draft.proposal.description.replacen(&line, "", 1);
    }
    for who in out.iter().rev() {
        desk.draft.proposal.humans.remove(*who);
        desk.changed.retain(|other| other != who);
        for other in desk.changed.iter_mut().filter(|other| **other > *who) {
            *other -= 1;
        }
    }
    let proposal = &mut desk.draft.proposal;
    for group in &mut proposal.groups {
        group.members.retain(|id| !gone.contains(id));
    }
    let small: Vec<GroupId> =
        proposal.groups.iter().filter(|group| group.members.len() < 2).map(|group| group.id).collect();
    proposal.groups.retain(|group| group.members.len() > 1);
    for human in &mut proposal.humans {
        human.group = human.group.filter(|id| !small.contains(id));
        human.rules.retain(|rule| !matches!(rule.act, Action::FollowHuman(id) if gone.contains(&id)));
    }
    let of_gone = |id: Option<HumanId>| id.is_some_and(|id| gone.contains(&id));
    proposal.expected_events.retain(|clause| {
        let led = matches!(&clause.predicate, Predicate::Follows { leader: socrates_model::AgentId::Human(id), .. } if gone.contains(id));
        !of_gone(clause.predicate.human()) && !led && clause.predicate.group().is_none_or(|id| !small.contains(&id))
    });
    proposal
        .robot
        .script
        .retain(|line| !matches!(&line.act, RobotDo::Follow(id) | RobotDo::Abreast(id) | RobotDo::Overtake(id) if gone.contains(id)));
    if let Some(paths) = &mut desk.draft.paths {
        paths.humans.retain(|id, _| !gone.contains(id));
        paths.encounters.retain(|encounter| !gone.contains(&encounter.human));
    }
    renumber(desk, &gone);
    let named: Vec<String> = gone.iter().map(HumanId::to_string).collect();
    desk.done.push(format!("{} left; those behind are numbered anew", named.join(" and ")));
    *crowd = Crowd::of(&desk.draft.proposal);
}

/// `human_3` is `human_2` where the second has left.
fn renumber(desk: &mut Desk, gone: &[HumanId]) {
    let text = |text: &str| -> String {
        let mut out = String::with_capacity(text.len());
        let mut rest = text;
        while let Some(at) = rest.find("human_") {
            let (head, tail) = rest.split_at(at + "human_".len());
            let digits: String = tail.chars().take_while(char::is_ascii_digit).collect();
            out.push_str(head);
            match digits.parse::<u32>() {
                Ok(number) => {
                    let before = gone.iter().filter(|id| id.number() < number).count();
                    out.push_str(&(number - u32::try_from(before).unwrap_or(0)).to_string());
                }
                Err(_) => out.push_str(&digits),
            }
            rest = tail.get(digits.len()..).unwrap_or_default();
        }
        out.push_str(rest);
        out
    };
    desk.draft.proposal = mapped(&desk.draft.proposal, &text);
    desk.draft.paths = mapped(&desk.draft.paths, &text);
    let facts = &mut desk.question.reading.facts;
    let of = |kind: &FactKind| {
        if let FactKind::Reacts { human, .. }
        | FactKind::Gestures { human, .. }
        | FactKind::GesturesTo { human, .. }
        | FactKind::Relates { human, .. }
        | FactKind::Side { human, .. }
        | FactKind::Facing { human, .. }
        | FactKind::MeetsTimes { human, .. } = kind
        {
            gone.contains(human)
        } else if let FactKind::Before { first, then, .. } = kind {
            gone.iter().any(|id| [first, then].contains(&&AgentId::Human(*id)))
        } else if let FactKind::Group { members, .. } = kind {
            members.iter().any(|id| gone.contains(id))
        } else {
            false
        }
    };
    facts.retain(|fact| !of(&fact.kind));
    desk.question.reading.humans.retain(|human| !gone.contains(&human.id));
    desk.question.reading = mapped(&desk.question.reading, &text);
}

/// The same with every string changed; what cannot be written or read back stays.
fn mapped<T: Serialize + DeserializeOwned + Clone>(before: &T, text: &dyn Fn(&str) -> String) -> T {
    fn walk(value: Value, text: &dyn Fn(&str) -> String) -> Value {
        match value {
            Value::String(old) => Value::String(text(&old)),
            Value::Array(items) => Value::Array(items.into_iter().map(|item| walk(item, text)).collect()),
            Value::Object(members) => {
                Value::Object(members.into_iter().map(|(key, member)| (text(&key), walk(member, text))).collect())
            }
            Value::Null | Value::Bool(_) | Value::Number(_) => value,
        }
    }
    let value = serde_json::to_value(before).map(|value| walk(value, text));
    value.and_then(serde_json::from_value).unwrap_or_else(|_| before.clone())
}
