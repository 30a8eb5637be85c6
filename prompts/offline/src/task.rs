//! The robot's task: from where, to where, and what is only said.

use socrates_model::{Location, NodeId, PlaceClass};

use crate::clause::{self, Found, mark};
use crate::cut::{Stretch, sentences};
use crate::lexicon::lexicon;
use crate::named;
use crate::words::Word;

/// One end of the robot's way by its name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct End {
    /// As the task says it.
    pub(crate) name: String,
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
}

/// The nodes where a way begins or ends by name.
pub(crate) fn nodes(ends: &[End]) -> &[NodeId] {
    ends.iter().find(|end| !end.nodes.is_empty()).map_or(&[], |end| &end.nodes)
}

/// Reads a task such as `Take the elevator to deliver supplies` or `Bring mail from the lobby to the kitchen`.
pub(crate) fn read(text: &str, location: &Location) -> Task {
    let mut task = Task::default();
    let (returns, first): (Vec<Stretch>, Vec<Stretch>) =
        sentences(text).into_iter().flatten().partition(|stretch| comes_back(stretch).is_some());
    let alone = first.is_empty();
    for stretch in first {
        errand(&mut task, stretch, text, location);
    }
    // `deliver mail and return (to the desk)`: the second errand. `return to the desk`, with no other place to go: the first.
    for mut stretch in returns {
        let quote = stretch.quote(text).to_owned();
        let mut onward = task.clone();
        let at = comes_back(&stretch).unwrap_or(0);
        for word in stretch.words.iter_mut().skip(at).take(2) {
            word.used = true;
        }
        errand(&mut onward, stretch, text, location);
        let first = task.goal.is_none() && task.goals.is_empty();
        if first && (onward.goal.is_some() || !onward.goals.is_empty()) {
            task = onward;
        } else {
            let to = onward.goals.get(task.goals.len()..).unwrap_or_default();
            let home = |end: &End| nodes(&task.starts) == end.nodes && !end.nodes.is_empty();
            let elsewhere = onward.goal != task.goal || onward.via != task.via;
            // `Return` alone says of no errand where from.
            task.comes_home = !alone && if to.is_empty() { !elsewhere } else { to.iter().all(home) };
            task.back.get_or_insert(quote);
            task.denied = onward.denied;
        }
    }
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

/// Where a clause asks for a way back: `return to the desk`, `comes back`; `return the cup to the kitchen` does not.
fn comes_back(stretch: &Stretch) -> Option<usize> {
    let text = |k: usize| stretch.words.get(k).map_or("", |word| word.text.as_str());
    let last = |i: usize| matches!(text(i + 1), "" | "to" | "back" | "home" | "again");
    (0..stretch.words.len()).find(|i| {
        matches!(text(*i), "return" | "returns" | "returning") && last(*i)
            || matches!(text(*i), "come" | "comes" | "go" | "goes" | "coming") && text(i + 1) == "back"
    })
}

/// Reads one clause of a task.
fn errand(task: &mut Task, mut stretch: Stretch, text: &str, location: &Location) {
    let quote = stretch.quote(text).to_owned();
    if let Some(denied) = denied(&mut stretch, text, location) {
        task.denied.push(denied);
        if stretch.words.is_empty() {
            return;
        }
    }
    let found = clause::read(&mut stretch);
    // `fetch goods from the rack`: the way leads there, unless the text says where it leads then.
    let fetches = stretch.words.iter().any(|word| matches!(word.stem.as_str(), "fetch" | "get" | "collect" | "pick"))
        && !text.to_lowercase().split_whitespace().any(|word| TO.contains(&word));
    let named = named_ends(task, &mut stretch, &found, text, location);
    for (class, at) in found.places {
        if named.iter().any(|(from, to)| (*from..=*to).contains(&at)) {
            continue;
        }
        let before: Vec<&str> = (1..=3)
            .filter_map(|back| at.checked_sub(back))
            .filter_map(|i| stretch.words.get(i))
            .map(|word| word.text.as_str())
            .collect();
        let near = |names: &[&str]| before.iter().position(|word| names.contains(word));
        let (from, to, via) = (
            near(&["from"]),
            near(&["to", "into", "at", "reach", "towards", "toward"]),
            near(&["via", "through", "along", "past"]),
        );
        let rides = class == PlaceClass::Elevator && near(&["take", "use", "ride", "enter", "the", "an"]).is_some();
        let slot = match (from, to, via) {
            (Some(_), None, _) if fetches => &mut task.goal,
            (Some(from), Some(to), _) if from < to => &mut task.start,
            (Some(_), None, _) => &mut task.start,
            (None, None, Some(_)) => &mut task.via,
            (_, Some(_), _) => &mut task.goal,
            (None, None, None) if rides => &mut task.goal,
            (None, None, None) => &mut task.via,
        };
        if slot.is_none() {
            *slot = Some((class, quote.clone()));
        }
    }
    if fetches {
        task.goals.append(&mut task.starts);
    }
    load(&mut stretch);
}

/// Takes the words off a clause that say where the robot is not to go: `do not go to the kitchen`, `without entering the elevator`.
fn denied(stretch: &mut Stretch, text: &str, location: &Location) -> Option<String> {
    let word = |k: usize| stretch.words.get(k).map_or("", |word| word.text.as_str());
    let denies = |k: &usize| matches!(word(*k), "not" | "never" | "avoid" | "avoids" | "avoiding" | "without");
    let at = (0..stretch.words.len()).find(denies)?;
    let from = at.checked_sub(1).filter(|k| matches!(word(*k), "do" | "does" | "must" | "should" | "may" | "can"));
    let tail = Stretch { words: stretch.words.get(at..)?.to_vec(), ..stretch.clone() };
    let (first, last) = (stretch.words.get(from.unwrap_or(at))?, stretch.words.last()?);
    let quote = text.get(first.from..last.to)?.to_owned();
    let place = !clause::read(&mut tail.clone()).places.is_empty()
        || (at + 1..stretch.words.len())
            .filter_map(|k| stretch.words.get(k))
            .any(|word| text.get(word.from..last.to).is_some_and(|name| named::find(location, name).is_some()));
    if place {
        stretch.words.truncate(from.unwrap_or(at));
    }
    place.then_some(quote)
}

/// Words before the beginning of a way, before its end, and before where the work is.
const FROM: &[&str] = &["from"];
const TO: &[&str] = &["to", "into", "towards", "toward", "reach", "visit"];
const IN: &[&str] = &["in", "at", "inside"];
/// Words before what a way leads past.
const PAST: &[&str] = &["via", "through", "past"];
/// Words between such a word and the name.
const FILL: &[&str] = &[
    "the", "a", "an", "its", "their", "our", "my", "your", "this", "that", "next", "nearest", "closest", "main", "new",
];
/// What a robot does for itself: `Go to charge`.
const ITSELF: &[&str] = &["charge", "recharge", "refuel", "park", "work", "human"];

/// Takes the ends of the way that a clause names; says which words those are.
fn named_ends(
    task: &mut Task,
    stretch: &mut Stretch,
    found: &Found,
    said: &str,
    location: &Location,
) -> Vec<(usize, usize)> {
    let lex = lexicon();
    let mut taken = Vec::new();
    for at in 0..stretch.words.len() {
        let text = |k: usize| stretch.words.get(k).map_or("", |word| word.text.as_str());
        let goes = TO.contains(&text(at));
        let past = PAST.contains(&text(at));
        if !goes && !past && !FROM.contains(&text(at)) && !IN.contains(&text(at)) {
            continue;
        }
        let from = (at + 1..).find(|k| !FILL.contains(&text(*k))).unwrap_or(at + 1);
        let content = |word: &Word| {
            word.stem != "robot" && (!lex.stop.contains(&word.text) || word.is_digits()) && word.text != "another"
        };
        let count = stretch.words.iter().skip(from).take(4).take_while(|word| content(word)).count();
        // `from one corner to another`, `to the other end`, `to the nurse`
        let person = found.mentions.iter().any(|mention| (from..from + count).contains(&mention.to));
        if count == 0 || person {
            continue;
        }
        let words = stretch.words.get(from..from + count).unwrap_or_default();
        let (Some(first), Some(last)) = (words.first(), words.last()) else { continue };
        let name = said.get(first.from..last.to).unwrap_or_default().to_owned();
        let known = named::find(location, &name);
        let class =
            found.places.iter().find(|(_, place)| (from..from + count).contains(place)).map(|(class, _)| *class);
        // `in the office`, in an office
        let everywhere =
            IN.contains(&text(at)) && named::telling(&name).iter().all(|word| location.name.contains(word));
        let verb = from == at + 1
            && (lex.verbs.contains(&first.stem)
                || lex.task.contains(&first.stem)
                || ITSELF.contains(&first.stem.as_str()));
        let article = from > at + 1 || count == stretch.words.len() - from;
        let wanted = match (&known, class) {
            (Some(_), _) => !everywhere && (!verb || class.is_some()),
            (None, _) if named::telling(&name).is_empty() => false,
            (None, Some(class)) => goes || FROM.contains(&text(at)) || class == PlaceClass::Room,
            (None, None) => !IN.contains(&text(at)) && article && !verb,
        };
        if !wanted || past && known.as_ref().is_none_or(|known| !known.exact) {
            continue;
        }
        let exact = known.as_ref().is_some_and(|known| known.exact);
        let of_map = known.as_ref().map(|known| known.class).filter(|class| *class != PlaceClass::Plain);
        let end =
            End { name, nodes: known.map(|known| known.nodes).unwrap_or_default(), class: of_map.or(class), exact };
        if past {
            task.vias.push(end)
        } else if FROM.contains(&text(at)) {
            task.starts.push(end)
        } else {
            task.goals.push(end)
        }
        taken.push((from, from + count - 1));
    }
    for (from, to) in &taken {
        mark(stretch, *from, *to);
    }
    taken
}

/// What the robot carries is part of its task, which the reading repeats: `deliver mail`.
fn load(stretch: &mut Stretch) {
    let carries = |word: &Word| {
        matches!(
            word.stem.as_str(),
            "deliver"
                | "bring"
                | "carry"
                | "transport"
                | "fetch"
                | "collect"
                | "pick"
                | "drop"
                | "take"
                | "delivery"
                | "distribute"
                | "haul"
                | "move"
                | "return"
                | "hand"
                | "clean"
                | "pull"
                | "push"
                | "get"
        )
    };
    let ends = |word: &Word| {
        matches!(
            word.text.as_str(),
            "from"
                | "to"
                | "into"
                | "in"
                | "at"
                | "on"
                | "via"
                | "through"
                | "along"
                | "past"
                | "with"
                | "while"
                | "by"
        )
    };
    let mut carried = false;
    for word in &mut stretch.words {
        carried = (carried || carries(word)) && !ends(word);
        word.used |= carried;
    }
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
