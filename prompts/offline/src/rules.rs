//! The order of somebody's rules: earlier ones win, so what never ends must not stand before what only comes later.

use socrates_model::{Action, Rule, Trigger};

use crate::cast::{Person, ReadRule};

/// Puts the rules of a person in an order in which each of them can run.
pub(crate) fn settle(person: &mut Person) {
    let mut rules: Vec<ReadRule> = Vec::with_capacity(person.rules.len());
    // `gives up and walks off` says the same twice.
    for read in std::mem::take(&mut person.rules) {
        let same = |old: &ReadRule| {
            old.rule.act == read.rule.act && old.rule.when == read.rule.when && old.rule.gesture == read.rule.gesture
        };
        if !rules.iter().any(same) {
            rules.push(read);
        }
    }
    alternate(&mut rules);
    // `until it asks; then he makes room`: what is done for a while comes before walking on at the same word.
    for at in 0..rules.len() {
        let Some(when) = rules.get(at).filter(|read| walks_on(&read.rule)).map(|read| read.rule.when.clone()) else {
            continue;
        };
        let later = (at + 1..rules.len())
            .find(|k| rules.get(*k).is_some_and(|read| read.rule.when == when && read.rule.for_s.is_some()));
        if let Some(later) = later {
            let read = rules.remove(later);
            rules.insert(at, read);
        }
    }
    // Who follows does so whenever nothing else is to be done; a follower walks on by following.
    let (following, mut others): (Vec<ReadRule>, Vec<ReadRule>) =
        rules.into_iter().partition(|read| follows(&read.rule) && read.rule.for_s.is_none());
    let idle = |read: &ReadRule| walks_on(&read.rule) && read.rule.when == [Trigger::RobotMoving];
    let (idle, rest): (Vec<ReadRule>, Vec<ReadRule>) =
        others.drain(..).partition(|read| !following.is_empty() && idle(read));
    person.rules = rest.into_iter().chain(following).chain(idle).collect();
}

/// `stands still while it moves and walks on when it stops`: each as long as its condition holds, again and again.
fn alternate(rules: &mut [ReadRule]) {
    let has = |trigger: &Trigger| rules.iter().any(|read| read.rule.when == [trigger.clone()]);
    if !(has(&Trigger::RobotMoving) && has(&Trigger::RobotStopped)) {
        return;
    }
    for read in rules {
        let waits = matches!(read.rule.when[..], [Trigger::RobotMoving | Trigger::RobotStopped]);
        if waits && read.rule.gesture.is_none() && matches!(read.rule.act, Action::StandStill | Action::Navigate) {
            read.rule.latched = false;
        }
    }
}

fn follows(rule: &Rule) -> bool {
    matches!(rule.act, Action::FollowRobot | Action::FollowHuman(_))
}

fn walks_on(rule: &Rule) -> bool {
    rule.act == Action::Navigate && rule.gesture.is_none() && rule.for_s.is_none()
}
