//! The robot's task: from where, to where, and what is only said.

use std::ops::Range;

use socrates_model::{Location, NodeId, PlaceClass};
use socrates_reader::{Errand, Leg, Reader, Toward};

use crate::named;

/// One end of the robot's way by its name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct End {
    /// As the task says it.
    pub(crate) name: String,
    /// Where it says so, in bytes.
    pub(crate) at: Range<usize>,
    /// The nodes that the map calls so; none where it knows no such place.
    pub(crate) nodes: Vec<NodeId>,
    /// Class of those nodes, or of the words.
    pub(crate) class: Option<PlaceClass>,
    /// Whether the map has exactly this one: `ward 2`, not only some ward.
    pub(crate) exact: bool,
}

/// What was read of the task.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Task {
    pub(crate) start: Option<(PlaceClass, String)>,
    pub(crate) goal: Option<(PlaceClass, String)>,
    pub(crate) via: Option<(PlaceClass, String)>,
    /// Beginnings and goals by name, in the order of the text; the first that the map knows counts.
    pub(crate) starts: Vec<End>,
    pub(crate) goals: Vec<End>,
    /// Places by name that the way leads past, those that the map knows.
    pub(crate) vias: Vec<End>,
    /// Words that ask for the way back.
    pub(crate) back: Option<String>,
    /// Whether that way leads to where it began, and not to another place.
    pub(crate) comes_home: bool,
    /// Words that say where the robot is not to go.
    pub(crate) denied: Vec<String>,
    /// Where the words stand of which something was made, in bytes.
    pub(crate) used: Vec<Range<usize>>,
    /// Where words stand that deny something which is no place.
    pub(crate) open: Vec<Range<usize>>,
}

/// The nodes where a way begins or ends by name.
pub(crate) fn nodes(ends: &[End]) -> &[NodeId] {
    ends.iter().find(|end| !end.nodes.is_empty()).map_or(&[], |end| &end.nodes)
}

/// Reads a task such as `Take the elevator to deliver supplies` or `Bring mail from the lobby to the kitchen`.
pub(crate) fn read(text: &str, location: &Location) -> Task {
    let mut task = Task::default();
    let (returns, first): (Vec<Errand>, Vec<Errand>) =
        Reader::shipped().errands(text).into_iter().partition(|errand| errand.returns);
    let alone = first.is_empty();
    for errand in first {
        takes(&mut task, &errand, text, location);
    }
    // `deliver mail and return (to the desk)`: the second errand. `return to the desk`, with no other place to go: the first.
    for errand in returns {
        let mut onward = task.clone();
        takes(&mut onward, &errand, text, location);
        let first = task.goal.is_none() && task.goals.is_empty();
        if first && (onward.goal.is_some() || !onward.goals.is_empty()) {
            task = onward;
        } else {
            let to = onward.goals.get(task.goals.len()..).unwrap_or_default();
            let home = |end: &End| nodes(&task.starts) == end.nodes && !end.nodes.is_empty();
            let elsewhere = onward.goal != task.goal || onward.via != task.via;
            // `Return` alone says of no errand where from.
            task.comes_home = !alone && if to.is_empty() { !elsewhere } else { to.iter().all(home) };
            task.back.get_or_insert_with(|| text.get(errand.at.clone()).unwrap_or_default().to_owned());
            task.used.push(errand.at);
            task.denied = onward.denied;
        }
    }
    // Of several places by name one is taken.
    let taken =
        |ends: &[End]| ends.iter().find(|end| !end.nodes.is_empty()).or_else(|| ends.first()).map(|end| end.at.clone());
    let used: Vec<Range<usize>> =
        [&task.starts, &task.goals, &task.vias].into_iter().filter_map(|ends| taken(ends)).collect();
    task.used.extend(used);
    // The name tells more than the kind of place.
    for (slot, ends) in [(&mut task.start, &task.starts), (&mut task.goal, &task.goals)] {
        let known = ends.iter().find(|end| !end.nodes.is_empty()).or_else(|| ends.first());
        let class = known.and_then(|end| end.class.map(|class| (class, end)));
        if let Some((class, end)) = class.filter(|(_, end)| slot.is_none() || !end.nodes.is_empty()) {
            *slot = Some((class, end.name.clone()));
        }
    }
    task
}

/// Takes what one clause of a task says.
fn takes(task: &mut Task, errand: &Errand, text: &str, location: &Location) {
    let said = |at: &Range<usize>| text.get(at.clone()).unwrap_or_default();
    let of_map = |words: &str| {
        word_starts(words).any(|at| words.get(at..).is_some_and(|name| named::find(location, name).is_some()))
    };
    let denied = errand.denied.as_ref().filter(|denied| denied.names_a_place || of_map(said(&denied.rest)));
    match (denied, &errand.denied) {
        (Some(denied), _) => {
            task.denied.push(said(&denied.at).to_owned());
            task.used.push(denied.at.clone());
        }
        (None, Some(other)) => task.open.push(other.at.start..other.rest.start),
        (None, None) => {}
    }
    let kept = |at: &Range<usize>| denied.is_none_or(|denied| at.start < denied.at.start);
    let mut named: Vec<&Range<usize>> = Vec::new();
    for leg in errand.legs.iter().filter(|leg| kept(&leg.name)) {
        if let Some(end) = end(leg, said(&leg.name), location) {
            let ends = match leg.toward {
                Toward::From if !errand.fetches => &mut task.starts,
                Toward::From | Toward::To | Toward::Within => &mut task.goals,
                Toward::Past => &mut task.vias,
            };
            ends.push(end);
            named.push(&leg.name);
        }
    }
    for spot in errand.spots.iter().filter(|spot| kept(&spot.at)) {
        if named.iter().any(|name| name.start < spot.at.end && spot.at.start < name.end) {
            continue;
        }
        let slot = match spot.toward {
            Toward::From => &mut task.start,
            Toward::To => &mut task.goal,
            Toward::Within | Toward::Past => &mut task.via,
        };
        if slot.is_none() {
            *slot = Some((spot.class, said(&errand.at).to_owned()));
            task.used.extend(of_kind(text, &spot.at));
        }
    }
}

/// The words by which a place is one of a kind: `waiting` tells which area, and any is taken.
fn of_kind(text: &str, at: &Range<usize>) -> Vec<Range<usize>> {
    let words = text.get(at.clone()).unwrap_or_default();
    let starts: Vec<usize> = word_starts(words).collect();
    let ends = starts.iter().skip(1).copied().chain([words.len()]);
    let all = starts.iter().copied().zip(ends).map(|(from, to)| from..to);
    let own = |word: &Range<usize>| {
        word.end == words.len() || named::telling(words.get(word.clone()).unwrap_or_default()).is_empty()
    };
    all.filter(own).map(|word| at.start + word.start..at.start + word.end).collect()
}

/// Where the words of a text begin.
fn word_starts(text: &str) -> impl Iterator<Item = usize> {
    let letters = text.char_indices().scan(' ', |before, (at, letter)| {
        let begins = letter.is_alphanumeric() && !before.is_alphanumeric();
        *before = letter;
        Some((at, begins))
    });
    letters.filter(|(_, begins)| *begins).map(|(at, _)| at)
}

/// A place by name, where it is one for the robot's way on this map.
fn end(leg: &Leg, name: &str, location: &Location) -> Option<End> {
    let known = named::find(location, name);
    let telling = named::telling(name);
    // `in the office`, in an office
    let everywhere = leg.toward == Toward::Within && telling.iter().all(|word| location.name.contains(word));
    let goes = matches!(leg.toward, Toward::From | Toward::To);
    let wanted = match (&known, leg.class) {
        (Some(_), class) => !everywhere && (!leg.may_be_deed || class.is_some()),
        (None, _) if telling.is_empty() => false,
        (None, Some(class)) => goes || class == PlaceClass::Room,
        (None, None) => leg.toward != Toward::Within && leg.stands_alone && !leg.may_be_deed,
    };
    let exact = known.as_ref().is_some_and(|known| known.exact);
    if !wanted || leg.toward == Toward::Past && !exact {
        return None;
    }
    let of_map = known.as_ref().map(|known| known.class).filter(|class| *class != PlaceClass::Plain);
    let nodes = known.map(|known| known.nodes).unwrap_or_default();
    Some(End { name: name.to_owned(), at: leg.name.clone(), nodes, class: of_map.or(leg.class), exact })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Task {
        super::read(text, &crate::tests::map("office"))
    }

    #[test]
    fn start_goal_and_leftovers_are_told_apart() {
        let task = of("Take the elevator to deliver supplies");
        assert_eq!(task.goal.unwrap().0, PlaceClass::Elevator);
        let task = of("Bring mail from the exit to the meeting room via the corridor");
        assert_eq!(task.start.unwrap().0, PlaceClass::Exit);
        assert_eq!(task.goal.unwrap().0, PlaceClass::Room);
        assert_eq!(task.via.unwrap().0, PlaceClass::Corridor);
        let task = of("Deliver mail to the kitchen and come back to the exit");
        assert_eq!((task.goal.unwrap().0, task.back.as_deref()), (PlaceClass::Room, Some("come back to the exit")));
        let task = of("Fetch goods from the open area");
        assert_eq!((task.start, task.goal.map(|(class, _)| class)), (None, Some(PlaceClass::OpenArea)));
        assert_eq!(of("Return the cup to the kitchen").back, None);
        let task = of("Deliver coffee from one corner of the warehouse to another.");
        assert_eq!(task.start, None);
    }

    #[test]
    fn where_the_robot_is_not_to_go_is_no_goal() {
        for (text, denied, goal) in [
            ("Do not go to the kitchen", "Do not go to the kitchen", None),
            ("Never enter the meeting room.", "Never enter the meeting room", None),
            (
                "Bring mail to the exit without entering the kitchen",
                "without entering the kitchen",
                Some(PlaceClass::Exit),
            ),
            ("Bring mail to the exit and avoid the corridor", "avoid the corridor", Some(PlaceClass::Exit)),
        ] {
            let task = of(text);
            assert_eq!(task.denied, [denied], "{text}");
            assert_eq!(task.goal.map(|(class, _)| class), goal, "{text}");
            assert_eq!(task.via, None, "{text}");
        }
        assert_eq!(of("Bring coffee to the kitchen and do not spill it").denied, [""; 0]);
    }

    type Said = (String, usize);

    /// Names of the beginnings and goals with how many nodes of the map are called so.
    fn ends(map: &str, text: &str) -> (Vec<Said>, Vec<Said>) {
        let task = read(text, &crate::tests::map(map));
        let said = |ends: &[End]| ends.iter().map(|end| (end.name.clone(), end.nodes.len())).collect();
        (said(&task.starts), said(&task.goals))
    }

    #[test]
    fn ends_of_the_way_are_found_by_name() {
        let one = |name: &str, n: usize| vec![(name.to_owned(), n)];
        for (map, text, start, goal) in [
            (
                "hospital",
                "Take pills from the pharmacy to the nurse station",
                one("pharmacy", 1),
                one("nurse station", 1),
            ),
            ("office", "Drive to the reception", vec![], one("reception", 2)),
            ("office", "Wash the cups in the kitchen", vec![], one("kitchen", 1)),
            ("warehouse", "Bring a pallet to the loading dock", vec![], one("loading dock", 1)),
            ("hospital", "Bring blood to the laboratory", vec![], one("laboratory", 0)),
            ("hospital", "Bring linen to ward 1", vec![], one("ward 1", 1)),
            ("office", "Deliver a parcel to the manager", vec![], vec![]),
            ("office", "Deliver a parcel to the other end of the corridor", vec![], vec![]),
            ("office", "Clean the floor in the office in the evening", vec![], vec![]),
            ("office", "Go to charge", vec![], vec![]),
            ("warehouse", "Fetch goods from the packing area", vec![], one("packing area", 3)),
            (
                "warehouse",
                "Fetch a box from the packing area and bring it to the loading dock",
                one("packing area", 3),
                one("loading dock", 1),
            ),
        ] {
            assert_eq!(ends(map, text), (start, goal), "{text}");
        }
    }
}
