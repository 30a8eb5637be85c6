//! The files of a location as they are written: the same bytes for the same values.

use std::collections::BTreeMap;

use socrates_model::{AreaName, Cell, Door, DoorKind, DoorOpens, Grid, Point, Pose};

use crate::image::gray_png;
use crate::read::MAP;

/// Name of the image.
const IMAGE: &str = "map.png";
/// Shades as map tools write them; 205 lies between the two thresholds of the map's file.
const SHADES: [(Cell, u8); 3] = [(Cell::Free, 254), (Cell::Occupied, 0), (Cell::Unknown, 205)];

/// `map.yaml` and the image of a grid, by their names.
///
/// # Errors
/// A sentence where the image cannot be written, such as for a side of more than 2³² pixels.
pub fn map_files(grid: &Grid) -> Result<BTreeMap<String, Vec<u8>>, String> {
    let shade = |cell: &Cell| SHADES.iter().find(|(known, _)| known == cell).map_or(205, |(_, shade)| *shade);
    let shades: Vec<u8> = grid.cells.iter().map(shade).collect();
    let image = gray_png(grid.width, grid.height, &shades)?;
    let Pose { x, y, yaw } = grid.origin;
    let yaml = format!(
        "image: {IMAGE}\nmode: trinary\nresolution: {:?}\norigin: [{x:?}, {y:?}, {yaw:?}]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n",
        grid.resolution_m
    );
    Ok(BTreeMap::from([(MAP.to_owned(), yaml.into_bytes()), (IMAGE.to_owned(), image)]))
}

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

/// The lines of a `location.toml` that hold the names of areas; they stand behind those of [`location_toml`].
#[must_use]
pub fn names_toml(names: &[AreaName]) -> String {
    let quoted = |text: &str| toml::Value::from(text).to_string();
    let row = |area: &AreaName| {
        let nodes: Vec<String> = area.nodes.iter().map(|id| quoted(id.as_str())).collect();
        format!("\n[[names]]\nname = {}\nnodes = [{}]\n", quoted(&area.name), nodes.join(", "))
    };
    names.iter().map(row).collect()
}
