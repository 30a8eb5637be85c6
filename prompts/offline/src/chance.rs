//! Gives every reaction its chance: what somebody waits for has to come about where it is, and in the order that was told.

use socrates_model::rule::{RobotDo, RobotRule, RobotWhen};
use socrates_model::{Action, Fault, FaultCode, HumanProposal, PlaceClass, Relation, Rule, Trigger};

use crate::story::{ReadRule, Story};

/// Whoever has the robot behind notices it no farther than this, m.
const BEHIND_M: f64 = 3.0;
/// In an aisle that only one gets through the two come so near to each other before one makes room, m.
const FACES_M: f64 = 2.5;
/// A person who stands at their place and walks on lets the robot come so near first, m.
const MET_M: f64 = 2.8;
/// The robot comes no nearer than this to whoever stands in its way, m.
const STOPS_BEFORE_M: f64 = 1.1;
/// Minimum time for which a person blocks the robot that they had to get past first, s.
const CATCHES_UP_S: f64 = 20.0;
/// Where somebody waits for the robot to stop it stops before somebody this near, m, for so long, s.
const STOPS: (f64, f64) = (4.0, 6.0);

/// Mends what could not come about as it was read; distances that the text says stay as they are.
pub(crate) fn settle(story: &mut Story) {
    let narrow = matches!(story.place, Some((PlaceClass::NarrowPassage, _)));
    impossible(story, narrow);
    for who in 0..story.people.len() {
        let relation = story.relation_of(who);
        let Some(person) = story.people.get_mut(who) else { continue };
        for at in 0..person.rules.len() {
            let Some(read) = person.rules.get(at).filter(|read| !read.exact) else { continue };
            let before = read.rule.when.clone();
            // What comes after something else at the same moment comes when that is over.
            let later =
                person.rules.iter().take(at).any(|other| other.rule.when == before && other.rule.for_s.is_some());
            let gives = narrow && read.rule.act == Action::GiveWay && !later;
            let leaves = relation == Some(Relation::Static) && read.rule.act == Action::Navigate && !later;
            let after: Vec<Trigger> = before
                .iter()
                .map(|trigger| match (trigger, relation) {
                    // A person who walks ahead of the robot does not see it.
                    (Trigger::RobotVisible(m), Some(Relation::Ahead)) => Trigger::RobotNear(m.min(BEHIND_M)),
                    // Where only one gets through they have met before one of them goes back.
                    (Trigger::RobotVisible(m), _) if gives => Trigger::RobotVisible(m.min(FACES_M)),
                    // A person who stands there and walks on has been met by then.
                    (Trigger::RobotVisible(m), _) if leaves => Trigger::RobotVisible(m.min(MET_M)),
                    (Trigger::RobotNear(m), _) if leaves => Trigger::RobotNear(m.min(MET_M)),
                    (other, _) => other.clone(),
                })
                .collect();
            // What waits for the same moment goes on doing so.
            for read in person.rules.iter_mut().skip(at).filter(|read| read.rule.when == before) {
                read.rule.when.clone_from(&after);
            }
        }
        if relation == Some(Relation::Behind) {
            for read in person.rules.iter_mut().filter(|read| read.rule.act == Action::Block && !read.lasts) {
                read.rule.for_s = read.rule.for_s.map(|secs| secs.max(CATCHES_UP_S));
            }
        }
        lets_pass_last(&mut person.rules);
    }
}

/// Says before the run what cannot come about in it.
fn impossible(story: &mut Story, narrow: bool) {
    let mut said = Vec::new();
    let people = &story.people;
    for person in people {
        let blocks = person.rules.iter().any(|read| read.rule.act == Action::Block);
        let touches = |read: &&ReadRule| {
            let near = |when: &Trigger| matches!(when, Trigger::RobotNear(m) | Trigger::RobotVisible(m) if *m <= STOPS_BEFORE_M);
            read.exact && read.rule.act != Action::Block && read.rule.when.iter().any(near)
        };
        said.extend(person.rules.iter().find(touches).filter(|_| blocks).map(|read| {
            let message = format!(
                "`{}`: the robot stops more than a meter before whoever stands in its way; ask for {} m or more",
                read.quote,
                STOPS_BEFORE_M + 0.4
            );
            unread(&read.quote, message)
        }));
    }
    let aside = |read: &&ReadRule| read.rule.act == Action::GiveWay;
    let mut yield_there = people
        .iter()
        .filter(|person| matches!(person.relation, Some((Relation::Static, _))))
        .filter_map(|person| person.rules.iter().find(aside));
    if let (true, Some(read), Some(_)) = (narrow, yield_there.next(), yield_there.next()) {
        let message = format!(
            "`{}`: in an aisle that only one gets through there is no room for several to make way; ask for one, or for a wider \
             place",
            read.quote
        );
        said.push(unread(&read.quote, message));
    }
    story.problems.extend(said);
}

/// The fault of words of which something is not played.
fn unread(quote: &str, message: String) -> Fault {
    Fault::new(FaultCode::PRead, "rough_scenario", message).about([quote])
}

/// `stops, looks at it for ten seconds and then lets it pass`: at no stated distance the way is free after all that.
fn lets_pass_last(rules: &mut [ReadRule]) {
    let near = |read: &ReadRule| match read.rule.when[..] {
        [Trigger::RobotVisible(m)] if !read.exact => Some(m),
        _ => None,
    };
    for at in 1..rules.len() {
        let (before, rest) = rules.split_at_mut(at);
        let Some((read, last)) = rest.first_mut().zip(before.last()) else { return };
        let waits = matches!(last.rule.act, Action::StandStill | Action::LookAtRobot | Action::Block)
            && last.rule.for_s.is_some();
        let gives = matches!(read.rule.act, Action::GiveWay | Action::Navigate) && read.rule.gesture.is_none();
        if waits && gives && near(last).zip(near(read)).is_some_and(|(last_m, m)| m > last_m || read.then) {
            read.rule.when.clone_from(&last.rule.when);
        }
    }
}

/// Whether somebody stands while the robot moves and does something else only while it stands.
fn alternates<'a>(rules: impl Iterator<Item = &'a Rule>) -> bool {
    let (mut stands, mut goes) = (false, false);
    for rule in rules {
        stands |= rule.when == [Trigger::RobotMoving] && rule.act == Action::StandStill;
        goes |= rule.when == [Trigger::RobotStopped] && matches!(rule.act, Action::Navigate | Action::Approach);
    }
    stands && goes
}

/// Whoever waits for the robot to stop, and stands until then, gives it no reason to: it stops of itself.
pub(crate) fn stops(script: &mut Vec<RobotRule>, humans: &[HumanProposal]) {
    let holds = script.iter().any(|line| matches!(line.act, RobotDo::Hold(_)));
    if !holds && humans.iter().any(|human| alternates(human.rules.iter())) {
        script.push(RobotRule { when: RobotWhen::HumanNear(STOPS.0), act: RobotDo::Hold(STOPS.1) });
    }
}

/// Until then it stands there.
pub(crate) fn until_then(human: &mut HumanProposal) {
    if socrates_solver::walks_later(human) {
        let when = vec![Trigger::Always];
        human.rules.push(Rule { when, act: Action::StandStill, ..Rule::default() });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::{answers, map, request};

    #[test]
    fn who_walks_ahead_notices_the_robot_behind_it_without_seeing_it() {
        let rough = "The robot overtakes a worker who walks slowly. The worker turns his head and looks at it.";
        let (_, proposal, _) = answers(&request("Drive to the packing area", Some(rough)), &map("warehouse"), 1);
        let rules = &proposal.humans[0].rules;
        assert!(rules.iter().any(|rule| rule.when == [Trigger::RobotNear(BEHIND_M)]), "{rules:?}");
    }

    #[test]
    fn who_lets_the_robot_pass_after_all_else_does_so_last() {
        let rough = "A security guard stops the robot at the exit with a gesture, looks at it for ten seconds and then lets it pass.";
        let (_, proposal, _) = answers(&request("Drive to the exit", Some(rough)), &map("office"), 1);
        let rules = &proposal.humans[0].rules;
        let when = |act: Action| rules.iter().find(|rule| rule.act == act).map(|rule| rule.when.clone());
        assert_eq!(when(Action::GiveWay), when(Action::LookAtRobot), "{rules:?}");
    }

    #[test]
    fn who_stands_until_it_is_asked_has_a_way_to_walk_on() {
        let rough =
            "One person stands in the doorway of the kitchen. She does not move until the robot says excuse me.";
        let (_, proposal, paths) = answers(&request("Bring the mail to the kitchen", Some(rough)), &map("office"), 1);
        let way = paths.humans.values().next().unwrap();
        assert!(way.len() > 1, "{way:?}");
        let last = proposal.humans[0].rules.last().unwrap();
        assert_eq!((&last.act, last.when.as_slice()), (&Action::StandStill, &[Trigger::Always][..]));
    }
}
