//! Edits of who goes with whom and who says what: two change places, some form a group, a gesture comes or changes.

use socrates_model::rule::{RobotDo, RobotRule, RobotWhen};
use socrates_model::{Action, FactKind, Gesture, HumanId, Rule, Trigger};

use crate::desk::Desk;
use crate::edit_people;
use crate::edit_whom::{Crowd, Whom};
use crate::edit_wish::Wish;

/// A gesture is made when the robot is so near, m, and a robot makes one when somebody is, where the edit does not say.
const SEEN_M: f64 = 5.0;
const NEAR_M: f64 = 4.0;
/// It is shown so long, and whoever lets the robot go first stands so long, s.
const SHOWN_S: f64 = 4.0;
const STANDS_S: f64 = 6.0;

/// Exactly two of those who are there.
fn two(desk: &Desk, wish: &Wish, crowd: &mut Crowd) -> Option<(usize, usize)> {
    let there = desk.draft.proposal.humans.len();
    match crowd.whom(wish) {
        Whom::People(people) => match people.as_slice() {
            [a, b] => Some((*a, *b)),
            _ => None,
        },
        // `let them swap places`, where there are two.
        Whom::Unsaid => (there == 2).then_some((0, 1)),
        Whom::Robot => None,
    }
}

/// Two people take each other's way, and what they are to the robot; what they do and how fast they walk stays theirs.
pub(crate) fn swap(desk: &mut Desk, wish: &Wish, crowd: &mut Crowd) {
    let Some((a, b)) = two(desk, wish, crowd) else {
        return desk.refuse(&wish.quote, "does not say which two change places");
    };
    let (Some(mut first), Some(mut second)) =
        (desk.draft.proposal.humans.get(a).cloned(), desk.draft.proposal.humans.get(b).cloned())
    else {
        return desk.refuse(&wish.quote, "means somebody who is not there");
    };
    let follows = |rules: &[Rule], id: HumanId| rules.iter().any(|rule| rule.act == Action::FollowHuman(id));
    if follows(&first.rules, second.id) || follows(&second.rules, first.id) {
        return desk.refuse(&wish.quote, "would have somebody follow itself: one of the two follows the other");
    }
    if desk.draft.paths.is_none() && first.relation == second.relation && first.group == second.group {
        return desk.refuse(&wish.quote, "changes nothing: there are no paths yet, and both are alike to the robot");
    }
    std::mem::swap(&mut first.relation, &mut second.relation);
    std::mem::swap(&mut first.start, &mut second.start);
    std::mem::swap(&mut first.goal, &mut second.goal);
    std::mem::swap(&mut first.group, &mut second.group);
    let other = |id: HumanId| {
        if id == first.id {
            second.id
        } else if id == second.id {
            first.id
        } else {
            id
        }
    };
    let swapped = |members: &mut Vec<HumanId>| {
        for member in members.iter_mut() {
            *member = other(*member);
        }
        members.sort_unstable();
    };
    for group in &mut desk.draft.proposal.groups {
        swapped(&mut group.members);
    }
    for fact in &mut desk.question.reading.facts {
        if let FactKind::Group { members, .. } = &mut fact.kind {
            swapped(members);
        }
    }
    if let Some(paths) = &mut desk.draft.paths {
        let ways = [paths.humans.remove(&first.id), paths.humans.remove(&second.id)];
        for (id, way) in [second.id, first.id].into_iter().zip(ways) {
            if let Some(way) = way {
                paths.humans.insert(id, way);
            }
        }
        for encounter in &mut paths.encounters {
            encounter.human = other(encounter.human);
        }
        socrates_solver::edit::sort(paths);
    }
    desk.done.push(format!("{} and {} change places: each goes the other's way", first.id, second.id));
    for (who, human) in [(a, first), (b, second)] {
        if let Some(slot) = desk.draft.proposal.humans.get_mut(who) {
            *slot = human;
        }
        desk.touch(who);
    }
}

/// Some of those who are there form a group: they go, or stand, as the first of them does.
pub(crate) fn group(desk: &mut Desk, wish: &Wish, crowd: &mut Crowd) {
    let there: Vec<usize> = (0..desk.draft.proposal.humans.len()).collect();
    let members = match crowd.whom(wish) {
        Whom::People(people) if people.len() > 1 => people,
        Whom::People(_) | Whom::Unsaid if wish.everybody && there.len() > 1 => there,
        Whom::People(_) | Whom::Unsaid | Whom::Robot => {
            return desk.refuse(&wish.quote, "does not say which of those who are there form a group");
        }
    };
    let Some(model) = members.first().and_then(|who| desk.draft.proposal.humans.get(*who)).cloned() else { return };
    edit_people::leave_groups(desk, &members);
    for who in members.iter().skip(1) {
        if let Some(human) = desk.draft.proposal.humans.get_mut(*who) {
            (human.relation, human.start, human.goal) = (model.relation, model.start, model.goal);
        }
    }
    for who in &members {
        desk.touch(*who);
    }
    if !edit_people::group(desk, &members) {
        desk.refuse(&wish.quote, "is so already");
    }
}

/// Every gesture that the words name, in order.
fn named(quote: &str) -> Vec<Gesture> {
    let lower = quote.to_lowercase().replace(['_', '-'], " ");
    let all = [Gesture::Wait, Gesture::Proceed, Gesture::ExcuseMe, Gesture::FollowMe, Gesture::Acknowledged];
    let mut found: Vec<(usize, Gesture)> = all
        .into_iter()
        .filter_map(|gesture| {
            let name = gesture.to_string().to_lowercase().replace('_', " ");
            Some((lower.find(&name)?, gesture))
        })
        .collect();
    found.sort_by_key(|(at, _)| *at);
    found.into_iter().map(|(_, gesture)| gesture).collect()
}

/// A gesture more, or another one instead.
pub(crate) fn gesture(desk: &mut Desk, wish: &Wish, crowd: &mut Crowd) {
    let gestures = named(&wish.quote);
    let adds = wish.adds;
    let (old, new) = match gestures.as_slice() {
        [new] => (None, *new),
        [old, new] if !adds => (Some(*old), *new),
        _ => {
            let all = "WAIT, PROCEED, EXCUSE_ME, FOLLOW_ME, ACKNOWLEDGED";
            return desk.refuse(&wish.quote, &format!("does not say which gesture; there are {all}"));
        }
    };
    let whom = crowd.whom(wish);
    if matches!(whom, Whom::Robot) {
        return robot(desk, wish, (old, new), adds);
    }
    let gestures = |rule: &Rule| rule.gesture.is_some() && (old.is_none() || rule.gesture == old);
    let humans = &desk.draft.proposal.humans;
    let makes = |who: &usize| humans.get(*who).is_some_and(|human| human.rules.iter().any(gestures));
    let people = match whom {
        Whom::People(people) => people,
        // The only one who can be meant.
        Whom::Unsaid if adds && humans.len() == 1 => vec![0],
        Whom::Unsaid if !adds => (0..humans.len()).filter(makes).collect(),
        Whom::Unsaid | Whom::Robot => return desk.refuse(&wish.quote, "does not say who"),
    };
    if !adds && !people.iter().any(makes) {
        return desk.refuse(&wish.quote, "changes nothing: nobody of them makes that gesture; say `add a gesture`");
    }
    let had = desk.done.len();
    for who in people {
        let Some(human) = desk.draft.proposal.humans.get_mut(who) else { continue };
        let id = human.id;
        if adds {
            if human.rules.iter().any(|rule| rule.gesture == Some(new)) {
                continue;
            }
            let at = human.rules.iter().position(|rule| rule.for_s.is_none()).unwrap_or(human.rules.len());
            human.rules.insert(at, made(new, wish.meters));
            desk.done.push(format!("{id} gestures {new} as well"));
        } else {
            let mut before = None;
            for rule in human.rules.iter_mut().filter(|rule| gestures(rule)) {
                before = rule.gesture;
                rule.gesture = Some(new);
            }
            let Some(before) = before else { continue };
            heard(desk, id, before, new);
            desk.done.push(format!("{id} gestures {new} instead of {before}"));
        }
        desk.touch(who);
    }
    if desk.done.len() == had {
        desk.refuse(&wish.quote, &format!("is so already: they gesture {new}"));
    }
}

/// The rule by which somebody makes a gesture.
fn made(gesture: Gesture, meters: Option<f64>) -> Rule {
    let (act, lasts) = match gesture {
        Gesture::Proceed => (Action::StandStill, STANDS_S),
        Gesture::Acknowledged => (Action::LookAtRobot, SHOWN_S),
        Gesture::Wait | Gesture::ExcuseMe | Gesture::FollowMe => (Action::Navigate, SHOWN_S),
    };
    let when = vec![Trigger::RobotVisible(meters.unwrap_or(SEEN_M))];
    Rule { when, act, gesture: Some(gesture), for_s: Some(lasts), latched: true, ..Rule::default() }
}

/// People who waited for the one gesture wait for the other.
fn heard(desk: &mut Desk, id: HumanId, old: Gesture, new: Gesture) {
    for who in 0..desk.draft.proposal.humans.len() {
        let Some(human) = desk.draft.proposal.humans.get_mut(who) else { continue };
        let mut waited = false;
        for trigger in human.rules.iter_mut().flat_map(|rule| &mut rule.when) {
            if *trigger == Trigger::HumanSays(id, old) {
                (*trigger, waited) = (Trigger::HumanSays(id, new), true);
            }
        }
        if waited {
            desk.touch(who);
        }
    }
}

fn robot(desk: &mut Desk, wish: &Wish, (old, new): (Option<Gesture>, Gesture), adds: bool) {
    let script = &mut desk.draft.proposal.robot.script;
    if script.iter().any(|line| line.act == RobotDo::Say(new)) {
        return desk.refuse(&wish.quote, &format!("is so already: the robot gestures {new}"));
    }
    if adds {
        let when = RobotWhen::HumanNear(wish.meters.unwrap_or(NEAR_M));
        script.push(RobotRule { when, act: RobotDo::Say(new) });
        return desk.done.push(format!("the robot gestures {new} when somebody is near"));
    }
    let is = |act: &RobotDo| matches!(act, RobotDo::Say(said) if old.is_none_or(|old| *said == old));
    let mut before = None;
    for line in script.iter_mut().filter(|line| is(&line.act)) {
        if let RobotDo::Say(said) = line.act {
            before = Some(said);
        }
        line.act = RobotDo::Say(new);
    }
    let Some(before) = before else {
        return desk.refuse(&wish.quote, "changes nothing: the robot does not make that gesture; say `add a gesture`");
    };
    // Whoever waits for its word waits for the new one.
    for who in 0..desk.draft.proposal.humans.len() {
        let Some(human) = desk.draft.proposal.humans.get_mut(who) else { continue };
        let mut waited = false;
        for trigger in human.rules.iter_mut().flat_map(|rule| &mut rule.when) {
            if *trigger == Trigger::RobotSays(before) {
                (*trigger, waited) = (Trigger::RobotSays(new), true);
            }
        }
        if waited {
            desk.touch(who);
        }
    }
    desk.done.push(format!("the robot gestures {new} instead of {before}"));
}
