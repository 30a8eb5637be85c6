//! What a text leaves open, once all of it is read: who is inside, who stands with whom, and what excludes each other.

use socrates_model::request::MAX_HUMANS;
use socrates_model::{Action, Fault, FaultCode, HumanId, PlaceClass, Relation, Trigger};

use crate::manner::STARTLED_S;
use crate::rules;
use crate::story::{Person, ReadRule, Story, Unplayed, is_closed, stands};
use crate::told::exclude;

/// A standing group is judged until the robot is within 3 m; its members react a little later.
pub(crate) const CIRCLE_M: f64 = 2.8;
/// The farthest from which the first sight of the robot startles somebody, m: in the elevator case of SocRATES
/// (arXiv 2412.19595) the door opens with the robot in front of it; 0.8 to 5 m is our reading of that.
const FIRST_SIGHT_M: f64 = 5.0;
/// An elevator holds so many people.
const RIDERS: usize = 4;
/// A group has at most so many members.
const MEMBERS: usize = 8;

/// Why an answer to somebody's own word is not played.
const OWN_WORD: &str = "what the robot does at somebody's sign is up to its planner; nobody answers their own";

/// Fills in what follows from the rest, and finds wishes that exclude each other.
pub(crate) fn settle(story: &mut Story) {
    inside(story);
    elevator(story);
    for (id, person) in (1..).map(HumanId::new).zip(&mut story.people) {
        let own = |read: &ReadRule| {
            read.rule.when.iter().any(|trigger| matches!(trigger, Trigger::HumanSays(who, _) if *who == id))
        };
        let left = person.rules.iter().filter(|read| own(read));
        story.unplayed.extend(left.map(|read| Unplayed { quote: read.quote.clone(), why: OWN_WORD.to_owned() }));
        person.rules.retain(|read| !own(read));
        rules::settle(person);
        if rules::stays_then(person) {
            person.relation = None;
        }
    }
    comes_up_to(story);
    stays_with_group(story);
    circles(story);
    first_sight(story);
    clashes(story);
    too_many(story);
}

/// Whoever is in the room or car that the robot enters, and of whom no more is said, stays there.
fn inside(story: &mut Story) {
    let closed = |(class, _): &(PlaceClass, String)| is_closed(*class);
    let Some((class, quote)) = story.robot_enters.clone().filter(closed) else { return };
    if story.place.as_ref().is_some_and(|(other, _)| *other != class) {
        return;
    }
    let mut any = story.people.iter().any(|person| person.is(Relation::Staying));
    for person in &mut story.people {
        if person.relation.is_none() && person.start == Some(class) && !person.does(&Action::FollowRobot) {
            person.relation = Some((Relation::Staying, quote.clone()));
            any = true;
        }
    }
    if any && story.place.is_none() {
        story.place = Some((class, quote));
    }
}

/// Where some come out of an elevator, the others stay in it.
fn elevator(story: &mut Story) {
    let Some((PlaceClass::Elevator, quote)) = story.place.clone() else { return };
    if !story.people.iter().any(|person| person.is(Relation::Leaving)) {
        return;
    }
    let mut notes = Vec::new();
    for (who, person) in story.people.iter_mut().enumerate() {
        if person.relation.is_none() || person.is(Relation::Static) {
            if person.doings.is_empty() {
                notes.push(format!("nothing is said of human_{}; it stays in the elevator", who + 1));
            }
            person.relation = Some((Relation::Staying, quote.clone()));
            person.start = Some(PlaceClass::Elevator);
        } else if person.is(Relation::Leaving) {
            let before = stands(Relation::Leaving, person.start);
            person.start = Some(PlaceClass::Elevator);
            for doing in person.doings.iter_mut().filter(|doing| **doing == before) {
                *doing = stands(Relation::Leaving, Some(PlaceClass::Elevator));
            }
        }
    }
    story.notes.append(&mut notes);
}

/// `The robot drives to the waiting area and says follow me`: those to whom it speaks there, and who stand, stand there.
fn comes_up_to(story: &mut Story) {
    let open = |class: PlaceClass| matches!(class, PlaceClass::OpenArea | PlaceClass::Room);
    let all_stand = story.people.iter().all(|person| person.is(Relation::Static));
    if story.place.is_none() && !story.robot_says.is_empty() && all_stand && !story.people.is_empty() {
        story.place = story.robot_enters.clone().filter(|(class, _)| open(*class));
    }
}

/// Of a group of which some stand, those who are said to leave, or to stay in a room, stand with the others.
fn stays_with_group(story: &mut Story) {
    let rooms = story.place.as_ref().is_some_and(|(class, _)| is_closed(*class));
    for group in &story.groups {
        let members = || group.members.iter().filter_map(|who| story.people.get(*who));
        let indoors = |person: &Person| person.is(Relation::Leaving) || person.is(Relation::Staying);
        if rooms || !members().any(indoors) || !members().any(|person| person.is(Relation::Static)) {
            continue;
        }
        for who in &group.members {
            let Some(person) = story.people.get_mut(*who) else { continue };
            let Some((relation, quote)) = person.relation.as_mut() else { continue };
            if *relation == Relation::Leaving {
                let left = stands(Relation::Leaving, person.start);
                let id = who + 1;
                story
                    .notes
                    .push(format!("`{quote}`: human_{id} stays where its group stands; that it leaves is not played"));
                person.doings.retain(|doing| *doing != left);
            }
            if matches!(relation, Relation::Leaving | Relation::Staying) {
                *relation = Relation::Static;
                person.start = None;
            }
        }
    }
}

/// A circle holds until the robot is near: reactions of its members at no stated distance wait for that.
fn circles(story: &mut Story) {
    for who in 0..story.people.len() {
        let standing = story.relation_of(who) == Some(Relation::Static);
        let person = story.people.get_mut(who).filter(|person| standing && person.group.is_some());
        for read in person.into_iter().flat_map(|person| &mut person.rules).filter(|read| !read.exact) {
            for trigger in &mut read.rule.when {
                if let Trigger::RobotVisible(m) | Trigger::RobotNear(m) = trigger {
                    *m = m.min(CIRCLE_M);
                }
            }
        }
    }
}

/// Whoever stays inside comes no nearer to the robot: they are startled at no stated distance by the first sight through the door,
/// before those who leave stand in between. Whoever is scared there does not run: there is nowhere to run to.
fn first_sight(story: &mut Story) {
    for who in 0..story.people.len() {
        let stays = story.relation_of(who) == Some(Relation::Staying);
        let Some(person) = story.people.get_mut(who).filter(|_| stays) else { continue };
        for read in person.rules.iter_mut().filter(|read| read.rule.act == Action::RunAway && !read.stated) {
            (read.rule.act, read.rule.for_s) = (Action::LookAtRobot, Some(STARTLED_S));
            person.startled = true;
        }
        let looks = |read: &&mut ReadRule| read.rule.act == Action::LookAtRobot && !read.exact;
        let startled = person.startled;
        for read in person.rules.iter_mut().filter(looks).filter(|_| startled) {
            for trigger in &mut read.rule.when {
                if let Trigger::RobotVisible(m) = trigger {
                    *m = m.max(FIRST_SIGHT_M);
                }
            }
        }
    }
}

/// Deeds of one human that exclude each other for the same reason.
fn clashes(story: &mut Story) {
    let nears = |act: &Action| matches!(act, Action::FollowRobot | Action::Approach | Action::Block);
    let yields = |act: &Action| matches!(act, Action::RunAway | Action::GiveWay);
    for (who, person) in story.people.iter().enumerate() {
        for (at, first) in person.rules.iter().enumerate() {
            let opposed = |second: &&ReadRule| {
                let (a, b) = (&first.rule.act, &second.rule.act);
                let same = first.rule.when == second.rule.when || !first.stated && !second.stated;
                (nears(a) && yields(b) || nears(b) && yields(a)) && same && !second.then
            };
            let found = person.rules.iter().skip(at + 1).filter(opposed);
            story.problems.extend(found.map(|second| exclude(who, &first.quote, &second.quote)));
        }
    }
}

/// More people than a scenario may have, more members than a group has, more people than an elevator holds.
fn too_many(story: &mut Story) {
    let most = usize::try_from(MAX_HUMANS).unwrap_or(usize::MAX);
    if story.people.len() > most {
        let quote = story.count_quote.clone().unwrap_or_default();
        let message = format!("`{quote}` asks for more humans than {MAX_HUMANS}, the most that a scenario may have");
        story.problems.push(Fault::new(FaultCode::PLimit, "rough_scenario", message).about([quote]));
        story.people.truncate(most);
    }
    let large = story.groups.iter().filter(|group| group.members.len() > MEMBERS).map(|group| {
        let message =
            format!("`{}` makes a group of {}; a group has 2 to {MEMBERS} members", group.quote, group.members.len());
        Fault::new(FaultCode::PLimit, group.id, message)
    });
    story.problems.extend(large);
    let idle = |person: &Person| person.relation.is_none() && person.rules.is_empty();
    if let Some((PlaceClass::Elevator, quote)) = &story.place
        && story.people.len() > RIDERS
        && story.people.iter().all(idle)
    {
        let message = format!(
            "`{quote}`: an elevator holds at most {RIDERS} people, and those with whom the robot does not ride it does not meet; \
             say who gets out, or who waits in front and gets in"
        );
        story.problems.push(Fault::new(FaultCode::PRead, "rough_scenario", message).about([quote.clone()]));
    }
}
