//! Who stays inside a room or an elevator that the robot enters, wherever in the text that is said.

use socrates_model::{Action, PlaceClass, Relation};

use crate::cast::ReadRule;
use crate::story::Story;

/// `A trainee is inside and remains there when the robot comes in`: said to stay before the robot was said to come in.
pub(crate) fn settle(story: &mut Story) {
    let inside = |class: &PlaceClass| matches!(class, PlaceClass::Room | PlaceClass::Elevator);
    // `so the robot does not get in`
    let enters = |(class, quote): &(PlaceClass, String)| inside(class) && !quote.contains(" not ");
    let Some((class, quote)) = story.robot_enters.clone().filter(enters) else { return };
    let elsewhere = |found: &Option<(PlaceClass, String)>| found.as_ref().is_some_and(|(other, _)| *other != class);
    if elsewhere(&story.place) {
        return;
    }
    let mut any = story.cast.people.iter().any(|person| matches!(person.relation, Some((Relation::Staying, _))));
    for person in &mut story.cast.people {
        // `A patient is already in the elevator when the robot drives in.`
        if person.relation.is_none()
            && person.start == Some(class)
            && !person.rules.iter().any(|read| read.rule.act == Action::FollowRobot)
        {
            person.relation = Some((Relation::Staying, quote.clone()));
            any = true;
        }
        let stands = person.relation.as_ref().is_none_or(|(relation, _)| *relation == Relation::Static);
        let Some(said) = person.stays.take().filter(|_| stands) else { continue };
        person.relation = Some((Relation::Staying, said.clone()));
        person.start = Some(class);
        // To stay is to stand there, which needs no rule of its own.
        let idle = |read: &ReadRule| {
            read.rule.act == Action::StandStill
                && read.rule.gesture.is_none()
                && !read.exact
                && (read.quote == said || read.quote.starts_with(&format!("{said}, ")))
        };
        person.rules.retain(|read| !idle(read));
        any = true;
    }
    if any && story.place.is_none() {
        story.place = Some((class, quote));
    }
}
