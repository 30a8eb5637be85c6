//! Who waits before an elevator or a room and goes in: it stands there at first, and its way leads on through the door.

use socrates_model::{Action, Fault, FaultCode, HumanProposal, Location, PlaceClass, Proposal, Relation};

use crate::humans::{Taken, Way, same_door};
use crate::place;
use crate::routes::{Net, Route};
use crate::story::Story;

/// An elevator holds so many people.
const RIDERS: usize = 4;
const FULL: &str = " full";
/// Nobody waits for a door farther from the place behind it than this, m.
const BEFORE_M: f64 = 8.0;

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

/// Whether somebody stands before a door at first and goes in.
pub(crate) fn boards(human: &HumanProposal) -> bool {
    human.relation == Relation::Static && human.goal.is_some()
}

/// How many do.
pub(crate) fn count(proposal: &Proposal) -> usize {
    proposal.humans.iter().filter(|human| boards(human)).count()
}

/// The places behind the same door as one of them.
fn behind(net: &Net<'_>, class: Option<PlaceClass>, node: usize) -> Vec<usize> {
    let all = place::inside(net.location, class);
    all.iter().filter_map(|id| net.index(id)).filter(|other| same_door(net, *other, Some(node))).collect()
}

/// Nodes right before the doors of other cars, where those who go in do not fit into the robot's; none where they do.
pub(crate) fn doors_beside(net: &Net<'_>, proposal: &Proposal, goal: usize) -> Vec<usize> {
    let Some(class) = proposal.humans.iter().filter(|human| boards(human)).find_map(|human| human.goal) else {
        return Vec::new();
    };
    let own = behind(net, Some(class), goal);
    if count(proposal) < own.len() || own.is_empty() {
        return Vec::new();
    }
    let others = place::inside(net.location, Some(class));
    let others = others.iter().filter_map(|id| net.index(id)).filter(|node| !own.contains(node));
    let mut found: Vec<usize> = Vec::new();
    for node in others.flat_map(|node| net.near(node)).map(|(node, _)| *node) {
        if !net.inside(node) && !found.contains(&node) {
            found.push(node);
        }
    }
    found
}

/// A way from the goal over a node to a start.
pub(crate) fn way_past(net: &Net<'_>, (goal, by): (usize, usize), start: usize) -> Option<Vec<usize>> {
    let mut nodes = net.tree(goal, &|_| false).way(by);
    let on = net.tree(by, &|node| nodes.contains(&node) || net.inside(node)).way(start);
    if nodes.is_empty() || on.len() < 2 {
        return None;
    }
    nodes.extend(on.into_iter().skip(1));
    Some(nodes)
}

/// From where somebody stands before the door to a place behind it: the robot's own if there is room for all, else another.
pub(crate) fn way(human: &HumanProposal, route: &Route, taken: &Taken<'_>) -> Option<Way> {
    let net = taken.net;
    let robot = *route.nodes.last()?;
    let all: Vec<usize> = place::inside(net.location, human.goal).iter().filter_map(|id| net.index(id)).collect();
    let shared = net.inside(robot) && taken.boards < behind(net, human.goal, robot).len();
    let other = all.iter().any(|node| !same_door(net, *node, Some(robot)));
    let fits =
        |node: &usize| *node != robot && (!net.inside(robot) || !other || same_door(net, *node, Some(robot)) == shared);
    let last = route.nodes.len().checked_sub(1)?;
    let open = |node: &usize| !net.inside(*node) && net.kind(*node) != PlaceClass::Doorway;
    let places: Vec<usize> = route.nodes.get(1..last)?.iter().copied().filter(open).collect();
    let mut best: Option<(f64, Vec<usize>)> = None;
    for at in places {
        let tree = net.tree(at, &|_| false);
        let there = taken.standing.iter().filter(|other| **other == at).count() as f64;
        for end in all.iter().copied().filter(|node| fits(node) && tree.length_m(*node) <= BEFORE_M) {
            let ends = taken.goals.iter().filter(|other| **other == end).count() as f64;
            // Few at one place, near the door; the deepest place behind it first, so that the next one finds room.
            let nodes = tree.way(end);
            let before_m = nodes
                .iter()
                .position(|node| net.inside(*node))
                .map_or(0.0, |n| net.length_m(nodes.get(..=n).unwrap_or_default()));
            let deep_m = tree.length_m(end) - before_m;
            let deep = if ends > 0.0 { deep_m } else { -deep_m };
            let cost = before_m + 2.0 * there + 6.0 * ends + 0.5 * deep;
            if best.as_ref().is_none_or(|(least, _)| cost < least - 1e-9) {
                best = Some((cost, nodes));
            }
        }
    }
    let (_, nodes) = best?;
    Some(Way { meet: *nodes.first()?, nodes, cost: 0.0 })
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
