//! Who waits before an elevator or a room and goes in: it stands there at first, and its way leads on through the door.

use socrates_model::{Action, Fault, FaultCode, Location, PlaceClass, Relation};

use crate::place;
use crate::story::Story;

/// An elevator holds so many people.
const RIDERS: usize = 4;
const FULL: &str = " full";

/// `The elevator is full with five people`: that many do not fit, and whom the robot does not ride with it does not meet.
fn full(story: &mut Story) {
    let quote = story.place.as_ref().filter(|(class, quote)| *class == PlaceClass::Elevator && quote.contains(FULL));
    let Some(quote) = quote.map(|(_, quote)| quote.clone()) else { return };
    let idle = |person: &crate::cast::Person| person.relation.is_none() && person.doings.is_empty();
    if story.cast.people.len() > RIDERS && story.cast.people.iter().all(idle) {
        let message = format!(
            "`{quote}`: an elevator holds at most {RIDERS} people, and whom the robot does not ride with it does not meet; \
             say who gets out, or who waits in front and gets in"
        );
        story.problems.push(Fault::new(FaultCode::PRead, "rough_scenario", message).about([quote]));
    }
}

/// Has those who wait and go in stand before the door until it is open, as long as the robot does not come out of it.
pub(crate) fn settle(story: &mut Story, location: &Location) {
    let comes_out = story.robot_leaves.as_ref().map(|(class, _)| *class);
    full(story);
    let mut any = false;
    for person in &mut story.cast.people {
        let Some(goal) = person.goal.filter(|goal| Some(*goal) != comes_out) else { continue };
        let free = person.relation.as_ref().is_none_or(|(relation, _)| *relation == Relation::Static);
        let waits = |rule: &crate::cast::ReadRule| rule.rule.act == Action::StandStill && !rule.stated && !rule.lasts;
        let Some(at) = person.rules.iter().position(waits).filter(|_| free && person.group.is_none()) else { continue };
        if place::inside(location, Some(goal)).is_empty() {
            continue;
        }
        let read = person.rules.remove(at);
        person.relation.get_or_insert((Relation::Static, read.quote));
        for doing in person.doings.iter_mut().filter(|doing| *doing == "stops") {
            "waits".clone_into(doing);
        }
        any |= goal == PlaceClass::Elevator;
    }
    // They are met before the elevator, not in it.
    let lobby = place::has(location, PlaceClass::ElevatorLobby);
    if let Some((class @ PlaceClass::Elevator, _)) = story.place.as_mut().filter(|_| any && lobby) {
        *class = PlaceClass::ElevatorLobby;
    }
}

#[cfg(test)]
mod tests {
    use socrates_model::{Fault, FaultCode, Predicate, Relation};

    use crate::tests::{answers, map, request};

    const WAIT: &str = "Two people wait in front of the elevator. When the door opens, one person gets out first, and only \
                        after that the two waiting people get in. The robot enters last.";

    #[test]
    fn who_waits_before_the_elevator_and_gets_in_stands_there_and_goes_in() {
        let (request, map) = (request("Take the elevator", Some(WAIT)), map("hospital"));
        let (_, proposal, paths) = answers(&request, &map, 1);
        let enters = |human| {
            let own =
                |predicate: &Predicate| matches!(predicate, Predicate::Enters { human: who, .. } if *who == human);
            proposal.expected_events.iter().any(|clause| clause.must && own(&clause.predicate))
        };
        for human in &proposal.humans[..2] {
            assert_eq!(human.relation, Relation::Static);
            let way = &paths.humans[&human.id];
            assert!(paths.robot.contains(&way[0]) && map.door_of(way.last().unwrap()).is_some(), "{way:?}");
            assert!(enters(human.id), "{:#?}", proposal.expected_events);
        }
    }

    #[test]
    fn that_an_elevator_is_too_full_is_said_before_the_run() {
        let rough =
            "The elevator is full with five people, so the robot does not get in. It waits for the other elevator.";
        let reading = crate::read(&request("Take the elevator", Some(rough)), &map("hospital"));
        let said = |fault: &Fault| {
            fault.code == FaultCode::PRead && fault.message.to_string().contains("full with five people")
        };
        assert!(reading.problems.iter().any(said), "{:#?}", reading.problems);
    }

    #[test]
    fn more_than_fit_into_the_robots_car_go_into_another_that_it_comes_by() {
        let rough = "Four people wait in front of the elevator. When the door opens, they all get in.";
        let (request, map) = (request("Take the elevator", Some(rough)), map("hospital"));
        let (_, _, paths) = answers(&request, &map, 1);
        let door = |way: &[socrates_model::NodeId]| map.door_of(way.last().unwrap()).map(|door| door.id.clone());
        let robot = door(&paths.robot);
        assert!(robot.is_some() && paths.humans.values().all(|way| door(way).is_some_and(|own| Some(own) != robot)));
    }
}
