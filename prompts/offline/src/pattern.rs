//! Which card a story is about.

use socrates_model::{Action, Gesture, PlaceClass, Relation};

use crate::story::{Person, Story};

/// The card of the story; `None` where no card fits (the proposal is `free` then).
pub(crate) fn of(story: &Story, wanted: Option<&str>) -> Option<String> {
    if let Some(id) = wanted {
        return Some(id.to_owned());
    }
    let people = &story.people;
    let place = story.place.as_ref().map(|(class, _)| *class);
    if people.is_empty() {
        return by_place(place).map(str::to_owned);
    }
    let relation = |wanted: Relation| (0..people.len()).any(|i| story.relation_of(i) == Some(wanted));
    let does = |act: &Action| people.iter().any(|p| has(p, act));
    let says = |gesture: Gesture| people.iter().any(|p| p.rules.iter().any(|read| read.rule.gesture == Some(gesture)));
    let apart = people.iter().any(|p| has(p, &Action::FollowRobot) && !has(p, &Action::Block));
    let group = !story.groups.is_empty();
    let id = if relation(Relation::Leaving) {
        let car = people.iter().any(|p| p.start == Some(PlaceClass::Elevator)) || place == Some(PlaceClass::Elevator);
        if car { "entering_elevator" } else { "room_exit" }
    } else if apart && does(&Action::Block) {
        "corridor_follow_and_block"
    } else if story.groups.iter().any(|group| group.queue) {
        "queue"
    } else if group && relation(Relation::Static) {
        "group_passing"
    } else if does(&Action::RunAway) {
        "frightened"
    } else if does(&Action::FollowRobot) {
        "follower"
    } else if does(&Action::Block) {
        "pedestrian_obstruction"
    } else if says(Gesture::Wait) {
        "intersection_wait"
    } else if says(Gesture::Proceed) {
        "intersection_proceed"
    } else if does(&Action::Approach) {
        "curious"
    } else if group {
        "group_walking"
    } else if relation(Relation::Ahead) {
        "robot_overtaking"
    } else if relation(Relation::Behind) {
        "human_overtaking"
    } else if place == Some(PlaceClass::BlindCorner) {
        "blind_corner"
    } else if relation(Relation::Crossing) {
        "intersection_crossing"
    } else if place == Some(PlaceClass::NarrowPassage) {
        "narrow_hallway"
    } else if place == Some(PlaceClass::Doorway) {
        "narrow_doorway"
    } else if relation(Relation::Frontal) {
        "frontal_approach"
    } else {
        return None;
    };
    Some(id.to_owned())
}

fn has(person: &Person, act: &Action) -> bool {
    person.rules.iter().any(|read| read.rule.act == *act)
}

fn by_place(place: Option<PlaceClass>) -> Option<&'static str> {
    Some(match place? {
        PlaceClass::Intersection => "intersection_crossing",
        PlaceClass::BlindCorner => "blind_corner",
        PlaceClass::Doorway => "narrow_doorway",
        PlaceClass::NarrowPassage => "narrow_hallway",
        PlaceClass::Elevator | PlaceClass::ElevatorLobby => "entering_elevator",
        PlaceClass::Room => "room_exit",
        PlaceClass::OpenArea => "group_passing",
        PlaceClass::Corridor | PlaceClass::Exit | PlaceClass::Plain => "frontal_approach",
    })
}
