//! The files of a location as they are written: the same bytes for the same values.

use socrates_model::{Door, DoorKind, DoorOpens, Point};

/// A node as it is written: id, type, and position on the image, pixels.
pub type NodeText<'a> = (&'a str, &'a str, (f64, f64));
/// An edge as it is written: type and both ends.
pub type LinkText<'a> = (&'a str, &'a str, &'a str);

/// The text of a `scene_graph.json`, a node and an edge to a line, positions with so many decimals.
pub fn graph_json<'a>(
    nodes: impl IntoIterator<Item = NodeText<'a>>,
    links: impl IntoIterator<Item = LinkText<'a>>,
    decimals: usize,
) -> String {
    let quoted = |text: &str| serde_json::Value::from(text).to_string();
    let node = |(id, kind, (px, py)): NodeText<'_>| {
        let (id, kind) = (quoted(id), quoted(kind));
        format!("    {{\"id\": {id}, \"type\": {kind}, \"pos\": [{px:.decimals$}, {py:.decimals$}]}}")
    };
    let link = |(kind, from, to): LinkText<'_>| {
        let (kind, from, to) = (quoted(kind), quoted(from), quoted(to));
        format!("    {{\"type\": {kind}, \"source\": {from}, \"target\": {to}}}")
    };
    let nodes: Vec<String> = nodes.into_iter().map(node).collect();
    let links: Vec<String> = links.into_iter().map(link).collect();
    format!(
        "{{\n  \"directed\": false,\n  \"multigraph\": false,\n  \"graph\": {{}},\n  \"nodes\": [\n{}\n  ],\n  \"links\": [\n{}\n  ]\n}}\n",
        nodes.join(",\n"),
        links.join(",\n")
    )
}

/// The text of a `location.toml`; `at` writes a point, map frame, m.
pub fn location_toml(description: &str, doors: &[Door], at: impl Fn(&Point) -> String) -> String {
    let quoted = |text: &str| toml::Value::from(text).to_string();
    let mut out = format!("description = {}\n", quoted(description));
    for door in doors {
        let kind = match door.kind {
            DoorKind::Room => "room",
            DoorKind::Elevator => "elevator",
        };
        let opens = match &door.opens {
            DoorOpens::Always => "\"always\"".to_owned(),
            DoorOpens::Never => "\"never\"".to_owned(),
            DoorOpens::AtTimes(secs) => format!("{{ at_times = {secs:?} }}"),
            DoorOpens::Near(m) => format!("{{ near = {m:?} }}"),
            DoorOpens::RobotNear(m) => format!("{{ robot_near = {m:?} }}"),
            DoorOpens::OnEvent(event) => format!("{{ on_event = {} }}", quoted(event)),
        };
        let inside: Vec<String> = door.inside.iter().map(|id| quoted(id.as_str())).collect();
        out.push_str(&format!(
            "\n[[doors]]\nid = {}\nkind = \"{kind}\"\nfrom = {}\nto = {}\nopens = {opens}\nhold_s = {:?}\ninside = [{}]\n",
            quoted(&door.id),
            at(&door.from),
            at(&door.to),
            door.hold_s,
            inside.join(", ")
        ));
    }
    out
}
