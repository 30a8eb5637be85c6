//! Places by the names that a map gives them: `the nurse station`, `ward 2`, `the packing area`.

use socrates_maps::openings::Enclosures;
use socrates_model::{AreaName, GraphNode, Location, NodeId, PlaceClass};
use socrates_reader::Reader;

/// Words of types that say what kind of place it is, not which one.
const KINDS: &[&str] = &[
    "area",
    "room",
    "corridor",
    "hallway",
    "intersection",
    "crossing",
    "junction",
    "passageway",
    "passage",
    "aisle",
    "door",
    "doorway",
    "exit",
    "elevator",
    "lift",
    "end",
    "open",
    "blind",
    "corner",
    "narrow",
    "wide",
    "node",
    "space",
    "zone",
    "place",
    "floor",
    "main",
    "station",
    "desk",
    "bay",
    "in",
];

/// Other words for the same place.
const SAME: &[(&str, &str)] = &[
    ("conference", "meeting"),
    ("pantry", "kitchen"),
    ("kitchenette", "kitchen"),
    ("canteen", "kitchen"),
    ("dispensary", "pharmacy"),
    ("packaging", "packing"),
    ("foyer", "lobby"),
];

/// A place of a map by name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Found {
    /// The nodes that are called so.
    pub(crate) nodes: Vec<NodeId>,
    /// Class of the first of them.
    pub(crate) class: PlaceClass,
    /// Whether a number in the name is one of the map's: `ward 2`.
    pub(crate) exact: bool,
}

fn tokens(text: &str) -> Vec<String> {
    text.split(|c: char| !c.is_alphanumeric())
        .map(str::to_lowercase)
        .filter(|word| !word.is_empty())
        .map(|word| SAME.iter().find(|(other, _)| *other == word).map_or(word, |(_, name)| (*name).to_owned()))
        .map(|word| if number(&word) { word } else { Reader::shipped().base(&word) })
        .collect()
}

fn number(word: &str) -> bool {
    word.chars().all(|c| c.is_ascii_digit())
}

/// The words of a name that tell one place from others of its kind; none in `the room`.
pub(crate) fn telling(name: &str) -> Vec<String> {
    tokens(name)
        .into_iter()
        .filter(|word| number(word) || word.chars().count() > 1)
        .filter(|word| !KINDS.contains(&word.as_str()) && Reader::shipped().may_name(word))
        .collect()
}

/// The area that people gave a name, all of whose words are said; of several the one with the most words.
fn given(location: &Location, name: &str) -> Option<Found> {
    let said = tokens(name);
    let words = |area: &AreaName| {
        let own: Vec<String> = tokens(&area.name).into_iter().filter(|word| Reader::shipped().may_name(word)).collect();
        (!own.is_empty() && own.iter().all(|word| said.contains(word))).then_some(own.len())
    };
    let areas = location.names.iter().filter_map(|area| Some((words(area)?, area)));
    // The first of the longest.
    let (_, area) = areas.reduce(|best, next| if next.0 > best.0 { next } else { best })?;
    let first = location.graph.node(area.nodes.first()?)?;
    Some(Found { class: PlaceClass::of_type(&first.kind), nodes: area.nodes.clone(), exact: true })
}

/// The nodes of a map whose type, or whose door, has most of the words of a name; `None` where it has none of them.
pub(crate) fn find(location: &Location, name: &str) -> Option<Found> {
    if let Some(found) = given(location, name) {
        return Some(found);
    }
    let (wanted, all) = (telling(name), Enclosures::of(location));
    let own = |node: &GraphNode| {
        let mut own = tokens(&node.kind);
        own.extend(all.doors_of(&node.id).flat_map(tokens));
        own
    };
    // A number alone is no name: `room 214` is none of the map's.
    let hits = |node: &GraphNode| {
        let own = own(node);
        let words = wanted.iter().filter(|word| own.contains(word) && !number(word)).count();
        if words == 0 { 0 } else { wanted.iter().filter(|word| own.contains(word)).count() }
    };
    let hits: Vec<(usize, &GraphNode)> = location.graph.nodes().iter().map(|node| (hits(node), node)).collect();
    let most = hits.iter().map(|(hits, _)| *hits).max().filter(|most| *most > 0)?;
    let found: Vec<&GraphNode> = hits.into_iter().filter(|(hits, _)| *hits == most).map(|(_, node)| node).collect();
    let first = found.first()?;
    let there = own(first);
    Some(Found {
        class: PlaceClass::of_type(&first.kind),
        exact: wanted.iter().all(|word| !number(word) || there.contains(word)),
        nodes: found.into_iter().map(|node| node.id.clone()).collect(),
    })
}

/// The nodes of a map whose type has all the words of a name that tells only what kind of place it is: `narrow aisle`.
pub(crate) fn called(location: &Location, name: &str) -> Option<Found> {
    let wanted = tokens(name);
    let all = |node: &&GraphNode| !wanted.is_empty() && wanted.iter().all(|word| tokens(&node.kind).contains(word));
    let found: Vec<&GraphNode> = location.graph.nodes().iter().filter(all).collect();
    let class = PlaceClass::of_type(&found.first()?.kind);
    Some(Found { class, nodes: found.into_iter().map(|node| node.id.clone()).collect(), exact: true })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_that_people_gave_wins_over_the_types_of_a_map() {
        let mut location = socrates_maps::shipped::load("hospital").unwrap();
        // The map has a node of that type, which is another one.
        assert_eq!(find(&location, "the pharmacy").unwrap().nodes[0].as_str(), "p3");
        let node = |id: &str| NodeId::new(id).unwrap();
        let name = |name: &str, nodes: &[&str]| AreaName {
            name: name.to_owned(),
            nodes: nodes.iter().map(|id| node(id)).collect(),
        };
        location.names = vec![name("pharmacy", &["p2"]), name("Old Pharmacy", &["ns"]), name("Café Süd", &["p1"])];
        for (said, nodes, class) in [
            ("the pharmacy", ["p2"], PlaceClass::Room),
            ("the old pharmacy", ["ns"], PlaceClass::Plain),
            ("café süd", ["p1"], PlaceClass::Room),
        ] {
            let found = find(&location, said).unwrap();
            assert_eq!(found.nodes, nodes.map(node), "{said}");
            assert!(found.exact && (found.class == class || said.contains("old")), "{said}: {found:?}");
        }
        assert_eq!(find(&location, "ward 2").unwrap().nodes, [node("p2")]);
    }

    fn ids(map: &str, name: &str) -> Vec<String> {
        let location = socrates_maps::shipped::load(map).unwrap();
        find(&location, name).map(|found| found.nodes.iter().map(ToString::to_string).collect()).unwrap_or_default()
    }

    #[test]
    fn a_map_knows_its_own_names() {
        assert_eq!(ids("hospital", "nurse station"), ["ns"]);
        assert_eq!(ids("hospital", "ward 2"), ["p2"]);
        assert_eq!(ids("hospital", "wards"), ["p1", "p2"]);
        assert_eq!(ids("office", "reception desk"), ["r1", "r2"]);
        assert_eq!(ids("warehouse", "loading bay"), ["kx"]);
        for (map, name) in [("hospital", "laboratory"), ("office", "room 214"), ("hospital", "charging station")] {
            assert!(ids(map, name).is_empty(), "{name}");
        }
    }
}
