//! The order of somebody's rules: earlier ones win, so what never ends must not stand before what only comes later.

use socrates_model::{Action, Relation, Rule, Trigger};

use crate::story::{Person, ReadRule};

/// Maximum time for which a person blocks the way when they give it free on request, s.
const ASKED_S: f64 = 20.0;

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
    let answered = answer(&mut rules);
    // A follower does so whenever nothing else is to be done; a follower walks on by following.
    let (following, mut others): (Vec<ReadRule>, Vec<ReadRule>) = rules
        .into_iter()
        .partition(|read| follows(&read.rule) && read.rule.for_s.is_none() && !(answered && read.waits_for_word()));
    let idle = |read: &ReadRule| walks_on(&read.rule) && read.rule.when == [Trigger::RobotMoving];
    let (idle, rest): (Vec<ReadRule>, Vec<ReadRule>) =
        others.drain(..).partition(|read| !following.is_empty() && idle(read));
    person.rules = rest.into_iter().chain(following).chain(idle).collect();
}

/// `blocks the robot; when it says EXCUSE_ME she looks at it and steps aside`: a word is answered at once, and who has made room
/// does not block again. Until then it stays in the way, however long it takes the robot to ask. Gives back whether there is
/// anything that a word ends.
fn answer(rules: &mut Vec<ReadRule>) -> bool {
    let keeps = |read: &ReadRule| {
        !read.waits_for_word()
            && matches!(read.rule.act, Action::Block | Action::StandStill | Action::LookAtRobot | Action::Approach)
    };
    let Some(from) = rules.iter().position(keeps) else { return false };
    let (answers, others): (Vec<ReadRule>, Vec<ReadRule>) =
        rules.split_off(from).into_iter().partition(ReadRule::waits_for_word);
    rules.extend(answers);
    rules.extend(others);
    let ends = |read: &ReadRule| matches!(read.rule.act, Action::GiveWay | Action::RunAway);
    let last = rules.iter().rposition(|read| read.waits_for_word() && ends(read));
    let Some((last, answer)) = last.and_then(|last| Some((last, rules.get(last)?.clone()))) else { return true };
    if !rules.iter().any(|read| walks_on(&read.rule) && read.rule.when == answer.rule.when) {
        let on = Rule { act: Action::Navigate, for_s: None, latched: true, ..answer.rule };
        rules.insert(last + 1, ReadRule { rule: on, stated: false, then: false, lasts: false, ..answer });
    }
    for read in rules.iter_mut().filter(|read| read.rule.act == Action::Block && !read.lasts && !read.waits_for_word())
    {
        read.rule.for_s = read.rule.for_s.map(|secs| secs.max(ASKED_S));
    }
    true
}

/// `two block the robot; when it asks, one makes room and the other stays`: who stays then came as the other did.
pub(crate) fn stays_then(person: &Person) -> bool {
    let quote = person.relation.as_ref().filter(|(relation, _)| *relation == Relation::Static).map(|(_, quote)| quote);
    let blocks = person.rules.iter().any(|read| read.rule.act == Action::Block && !read.waits_for_word());
    blocks && person.rules.iter().any(|read| read.waits_for_word() && Some(&read.quote) == quote)
}

/// Longer than any robot moves or stands at a time, s.
const ALTERNATES_S: f64 = 60.0;

/// `stands still while it moves and walks on when it stops`: each as long as its condition holds, again and again.
fn alternate(rules: &mut [ReadRule]) {
    let has = |trigger: &Trigger| rules.iter().any(|read| read.rule.when == [trigger.clone()]);
    if !(has(&Trigger::RobotMoving) && has(&Trigger::RobotStopped)) {
        return;
    }
    for read in rules {
        let waits = matches!(read.rule.when[..], [Trigger::RobotMoving | Trigger::RobotStopped]);
        if waits
            && read.rule.gesture.is_none()
            && matches!(read.rule.act, Action::StandStill | Action::Navigate | Action::LookAtRobot)
        {
            read.rule.latched = false;
            // It stands for as long as the robot moves.
            if read.rule.act != Action::Navigate && !read.lasts {
                read.rule.for_s = Some(ALTERNATES_S);
            }
        }
    }
}

fn follows(rule: &Rule) -> bool {
    matches!(rule.act, Action::FollowRobot | Action::FollowHuman(_))
}

fn walks_on(rule: &Rule) -> bool {
    rule.act == Action::Navigate && rule.gesture.is_none() && rule.for_s.is_none()
}

#[cfg(test)]
mod tests {
    use socrates_model::{Action, HumanId, Reading, Trigger};

    use crate::tests::told;

    fn acts(reading: &Reading, who: usize) -> Vec<(Action, Option<f64>)> {
        reading.humans[who].rules.iter().map(|rule| (rule.act.clone(), rule.for_s)).collect()
    }

    #[test]
    fn who_has_made_this_gesture_does_nothing_else_then() {
        for said in ["has made this gesture", "has given that signal", "makes the sign"] {
            let rough = format!(
                "Two doctors stand in the corridor. The former tells the robot to wait; the latter, once the former {said}, steps aside."
            );
            let reading = told(&rough, "office");
            let own = Trigger::HumanSays(HumanId::new(1), socrates_model::Gesture::Wait);
            let waits = |who: usize| reading.humans[who].rules.iter().any(|rule| rule.when.contains(&own));
            assert_eq!((waits(0), waits(1)), (false, true), "{said}");
        }
    }

    #[test]
    fn who_overtakes_or_walks_on_follows_no_longer_and_who_only_wants_to_does() {
        let reading = told("A worker walks behind the robot and wants to pass.", "office");
        assert_eq!(acts(&reading, 0), [(Action::FollowRobot, None)]);
        let reading = told("A nurse follows the robot and then walks on.", "office");
        assert_eq!(acts(&reading, 0), [(Action::FollowRobot, Some(8.0)), (Action::Navigate, None)]);
        let reading = told("A nurse follows the robot and walks through the door.", "office");
        assert_eq!(acts(&reading, 0), [(Action::FollowRobot, None)]);
    }
}
