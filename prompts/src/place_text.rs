//! The map in words: one line per node, its neighbors with it.

use std::collections::BTreeMap;

use socrates_model::{DoorOpens, Location, PlaceClass};

/// The scene graph as an incidence list: id, type, position, neighbors with the type of the way.
pub(crate) fn graph(location: &Location) -> String {
    let graph = &location.graph;
    let mut text =
        String::from("# The map\nOne line per node: `id` type (x, y in m): neighbor [type of the way, length], …\n");
    for node in &graph.nodes {
        text.push_str(&format!("`{}` {} ({:.1}, {:.1}):", node.id, node.kind, node.at.x, node.at.y));
        for other in graph.neighbors(&node.id) {
            let kind = graph.edge(&node.id, &other).map_or("", |edge| edge.kind.as_str());
            let length_m = graph.edge_length_m(&node.id, &other).unwrap_or(0.0);
            text.push_str(&format!(" `{other}` [{kind}, {length_m:.1} m],"));
        }
        text.pop();
        text.push('\n');
    }
    text
}

/// Doors and what is behind them.
pub(crate) fn doors(location: &Location) -> String {
    if location.doors.is_empty() {
        return "The map has no doors.\n".to_owned();
    }
    let mut text = String::from("# Doors\n");
    for door in &location.doors {
        let inside: Vec<String> = door.inside.iter().map(|node| format!("`{node}`")).collect();
        let opens = match &door.opens {
            DoorOpens::Always => "always open".to_owned(),
            DoorOpens::AtTimes(times) => {
                let times: Vec<String> = times.iter().map(ToString::to_string).collect();
                format!("opens after {} s", times.join(", "))
            }
            DoorOpens::Near(m) => format!("opens when somebody is within {m} m"),
            DoorOpens::RobotNear(m) => format!("opens when the robot is within {m} m"),
            DoorOpens::OnEvent(event) => format!("opens on `{event}`"),
            DoorOpens::Never => "never opens".to_owned(),
        };
        text.push_str(&format!("`{}`: {opens}; behind it: {}\n", door.id, inside.join(", ")));
    }
    text
}

/// The place classes of the map with how often they occur, and the map's own type names.
pub(crate) fn classes(location: &Location) -> String {
    let graph = &location.graph;
    let mut counts: BTreeMap<PlaceClass, usize> = BTreeMap::new();
    let mut kinds: BTreeMap<&str, PlaceClass> = BTreeMap::new();
    for node in &graph.nodes {
        kinds.insert(&node.kind, PlaceClass::of_type(&node.kind));
        for class in graph.classes(&node.id) {
            *counts.entry(class).or_default() += 1;
        }
    }
    let counted: Vec<String> = counts.iter().map(|(class, count)| format!("{class} ({count})")).collect();
    let named: Vec<String> = kinds.iter().map(|(kind, class)| format!("{kind} = {class}")).collect();
    format!(
        "# Places of this map\nClasses, with the number of places: {}\nThe map's own names: {}\nUse only these classes. Name types of places, never ids.\n",
        counted.join(", "),
        named.join(", ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::tee_map;

    #[test]
    fn every_node_has_a_line_with_its_neighbors() {
        let text = graph(&tee_map());
        assert!(
            text.contains(
                "`c` INTERSECTION (0.0, 0.0): `w` [CORRIDOR, 4.0 m], `e` [CORRIDOR, 4.0 m], `n` [CORRIDOR, 3.0 m]"
            ),
            "{text}"
        );
    }

    #[test]
    fn classes_are_counted_and_the_maps_own_names_are_read() {
        let text = classes(&tee_map());
        assert!(text.contains("intersection (1)") && text.contains("INTERSECTION = intersection"), "{text}");
    }
}
