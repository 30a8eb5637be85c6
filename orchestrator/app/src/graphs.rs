//! `map export`, `map import`: locations in formats of others and back, with a list of what a format cannot hold.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde_json::json;
use socrates_export::{Graph, Losses, Unusable, nav2_route, node_link, rmf};
use socrates_maps::{EXTRA, GRAPH, written};
use socrates_model::{Door, FORMAT, Grid, Location, Point, SceneGraph};

use crate::exit::Diagnostic;
use crate::files;
use crate::map;
use crate::output::Printer;
use crate::prepare::load_location;
use crate::raw_map;
use crate::words::plural;

/// Largest file of another tool that is read, bytes.
const MAX_BYTES: u64 = 32 * 1024 * 1024;
/// Name of the list of what was left behind.
const NOT_CARRIED: &str = "not_carried.json";

/// Formats of graphs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GraphFormat {
    /// Scene graphs of SocRATES and networkx: node-link JSON.
    NodeLink,
    /// Route graphs of Nav2: GeoJSON.
    Nav2Route,
    /// Buildings of Open-RMF: YAML.
    Rmf,
}

impl GraphFormat {
    /// Every format in order.
    pub const ALL: [Self; 3] = [Self::NodeLink, Self::Nav2Route, Self::Rmf];

    /// Name as written in arguments.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::NodeLink => "node-link",
            Self::Nav2Route => "nav2-route",
            Self::Rmf => "rmf",
        }
    }

    fn named(name: &str) -> Result<Self, Diagnostic> {
        Self::ALL.into_iter().find(|format| format.name() == name).ok_or_else(|| {
            let names = Self::ALL.map(Self::name).join(", ");
            Diagnostic::input(format!("`{name}` is no format of graphs"), format!("choose one of: {names}"))
        })
    }

    /// Name of the file that is written where none is given.
    fn file(self, location: &str) -> String {
        match self {
            Self::NodeLink => "scene_graph.json".to_owned(),
            Self::Nav2Route => format!("{location}.geojson"),
            Self::Rmf => format!("{location}.building.yaml"),
        }
    }
}

/// Writes a location in a format of others, and beside it the list of what that format cannot hold.
pub fn export(talk: &Printer, name: &str, to: &str, out: Option<&Path>) -> Result<(), Diagnostic> {
    let format = GraphFormat::named(to)?;
    let (location, _) = load_location(name, Path::new("."))?;
    let out = out.map_or_else(|| PathBuf::from(format.file(&location.name)), Path::to_path_buf);
    let (text, losses) = match format {
        GraphFormat::NodeLink => node_link::write(&location),
        GraphFormat::Nav2Route => nav2_route::write(&location),
        GraphFormat::Rmf => rmf::write(&location),
    };
    let list = out.with_file_name(NOT_CARRIED);
    for (path, text) in [(&out, &text), (&list, &losses.json(format.name()))] {
        files::write(path, text.as_bytes())?;
    }
    let (nodes, edges) = (location.graph.nodes().len(), location.graph.edges().len());
    talk.line(&format!("carried    {}, {} of {}", plural(nodes, "node"), plural(edges, "edge"), location.name));
    left(talk, &losses);
    talk.line(&format!("wrote      {} ({} beside it)", out.display(), NOT_CARRIED));
    talk.result(&json!({
        "location": location.name,
        "format": format.name(),
        "file": out.display().to_string(),
        "nodes": nodes,
        "edges": edges,
        "not_carried": losses.rows(),
    }));
    Ok(())
}

/// Says what was left behind, a kind to a line.
fn left(talk: &Printer, losses: &Losses) {
    for row in losses.rows() {
        let first = row.at.first().map_or("", String::as_str);
        let more = if row.count > 1 { format!(" and {} more", row.count - 1) } else { String::new() };
        talk.line(&format!("left       {}: {first}{more}; {}", row.what, row.why));
    }
}

/// What is said of a file that is imported.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ImportOptions {
    /// Format of the file.
    pub from: String,
    /// The map on which the graph lies: a map file or a folder with one; buildings of RMF bring their own.
    pub map: Option<PathBuf>,
    /// Level of a building.
    pub level: Option<String>,
    /// Folder to write.
    pub out: PathBuf,
}

/// What was read of a file: its map with the files of it, its graph, a name, and what was left behind.
struct Read {
    grid: Grid,
    files: BTreeMap<String, Vec<u8>>,
    graph: Graph,
    description: String,
    losses: Losses,
}

/// Makes a location folder from a file of another tool, with the list of what a location cannot hold.
pub fn import(talk: &Printer, file: &Path, options: &ImportOptions) -> Result<(), Diagnostic> {
    let format = GraphFormat::named(&options.from)?;
    let out = &options.out;
    if out.join(GRAPH).exists() {
        return Err(Diagnostic::input(
            format!("`{}` has a scene graph already, which is left as it is", out.display()),
            "name another folder with `--out`, or remove its scene_graph.json",
        ));
    }
    let text = files::text(file, MAX_BYTES, "docs/graphs.md lists what is read")?;
    let mut read = match format {
        GraphFormat::NodeLink | GraphFormat::Nav2Route => on_map(file, &text, format, options)?,
        GraphFormat::Rmf => level(file, &text, options)?,
    };
    fitting(&mut read);
    let name = out.file_name().map_or_else(|| "location".to_owned(), |name| name.to_string_lossy().into_owned());
    let (nodes, edges) = (&read.graph.nodes, &read.graph.edges);
    let row = nodes.iter().map(|node| (node.id.as_str(), node.kind.as_str(), read.grid.pixel_from_world(&node.at)));
    let ways = edges.iter().map(|edge| (edge.kind.as_str(), edge.from.as_str(), edge.to.as_str()));
    let at = |point: &Point| format!("[{:.4}, {:.4}]", point.x, point.y);
    let extra =
        written::location_toml(&read.description, &read.graph.doors, at) + &written::names_toml(&read.graph.names);
    read.files.insert(GRAPH.to_owned(), written::graph_json(row, ways, 4).into_bytes());
    read.files.insert(EXTRA.to_owned(), extra.into_bytes());
    let location = socrates_maps::parse(&read.files, &name).map_err(|faults| {
        Diagnostic::faults(
            format!("`{}` makes no location", file.display()),
            &faults,
            "correct the file, or draw its map with `socrates map draw` and see; `socrates explain CODE` says what to do",
        )
    })?;
    read.files.insert(NOT_CARRIED.to_owned(), read.losses.json(format.name()).into_bytes());
    map::folder(&read.files, out)?;
    talk.line(&format!(
        "read       {}: {}, {}, {}, {}",
        file.display(),
        plural(location.graph.nodes().len(), "node"),
        plural(location.graph.edges().len(), "edge"),
        plural(location.doors.len(), "door"),
        plural(location.names.len(), "name")
    ));
    for warning in &location.warnings {
        talk.line(&format!("warning    {warning}"));
    }
    left(talk, &read.losses);
    talk.line(&format!("wrote      {} ({})", out.display(), read.files.keys().cloned().collect::<Vec<_>>().join(", ")));
    talk.line(&format!("next       socrates map draw {}", files::shell(out)));
    talk.result(&json!({
        "location": out.display().to_string(),
        "format": format.name(),
        "nodes": location.graph.nodes().len(),
        "edges": location.graph.edges().len(),
        "doors": location.doors.len(),
        "names": location.names.len(),
        "warnings": location.warnings,
        "not_carried": read.losses.rows(),
    }));
    Ok(())
}

fn unusable(file: &Path, why: &Unusable) -> Diagnostic {
    Diagnostic::input(format!("`{}` cannot be used: {why}", file.display()), why.hint.clone())
}

/// A graph that lies on a map of its own.
fn on_map(file: &Path, text: &str, format: GraphFormat, options: &ImportOptions) -> Result<Read, Diagnostic> {
    let Some(map) = &options.map else {
        let message = format!("a graph of `{}` has no walls of its own", format.name());
        return Err(Diagnostic::input(message, "name the map on which it was drawn: `--map map.yaml`"));
    };
    let map = raw_map::given(map)?;
    let (raw, files) = socrates_maps::load_raw(&map).map_err(|faults| {
        Diagnostic::faults(
            format!("the map `{}` is not usable", map.display()),
            &faults,
            "`socrates explain CODE` says what to do",
        )
    })?;
    let (graph, losses) = match format {
        GraphFormat::NodeLink => node_link::read(text, &raw.grid),
        GraphFormat::Nav2Route | GraphFormat::Rmf => nav2_route::read(text),
    }
    .map_err(|why| unusable(file, &why))?;
    Ok(Read { grid: raw.grid, files, graph, description: raw.description, losses })
}

/// A level of a building. Where it has no lanes, its places are found on its map.
fn level(file: &Path, text: &str, options: &ImportOptions) -> Result<Read, Diagnostic> {
    let building = rmf::Building::read(text).map_err(|why| unusable(file, &why))?;
    let levels = building.levels();
    let level = match (options.level.as_deref(), levels.as_slice()) {
        (Some(level), _) => level,
        (None, [only]) => only,
        (None, several) => {
            let message = format!("`{}` has {} levels: {}", file.display(), several.len(), several.join(", "));
            return Err(Diagnostic::input(message, "each makes a location of its own: choose one with `--level NAME`"));
        }
    };
    let (mut floor, losses) = building.level(level).map_err(|why| unusable(file, &why))?;
    if floor.graph.edges.is_empty() {
        let found = socrates_annotate::annotate(&floor.grid, &socrates_annotate::Options::default());
        let found = found.map_err(|faults| {
            Diagnostic::faults(
                format!("the level `{level}` has no lanes, and nothing was found on its map"),
                &faults,
                "draw lanes in the building's editor",
            )
        })?;
        floor.graph.nodes = found.graph.nodes().to_vec();
        floor.graph.edges = found.graph.edges().to_vec();
    }
    let files = written::map_files(&floor.grid).map_err(|why| {
        Diagnostic::input(format!("the map of the level `{level}` cannot be written: {why}"), "choose another level")
    })?;
    let description =
        if levels.len() > 1 { format!("{}, level {level}", building.name) } else { building.name.clone() };
    Ok(Read { grid: floor.grid, files, graph: floor.graph, description, losses })
}

/// Leaves out doors that close no opening of the map, and names that are none.
fn fitting(read: &mut Read) {
    let location = |doors: Vec<Door>| Location {
        format: FORMAT,
        name: String::new(),
        description: String::new(),
        grid: read.grid.clone(),
        graph: SceneGraph::new(read.graph.nodes.clone(), read.graph.edges.clone()),
        doors,
        names: Vec::new(),
        warnings: Vec::new(),
    };
    let all = location(read.graph.doors.clone());
    let mut doors = Vec::new();
    for (place, door) in all.doors.iter().enumerate() {
        match socrates_maps::check_door(&all, place).first() {
            None => doors.push(door.clone()),
            Some(fault) => {
                let at = format!("door `{}`: {}", door.id, fault.message);
                read.losses.note("doors that close no opening", at, "a door is a line from wall to wall on the map");
            }
        }
    }
    read.graph.doors = doors;
    for area in read.graph.names.iter().filter(|area| !socrates_maps::is_area_name(&area.name)) {
        read.losses.note(
            "names",
            area.name.chars().take(80).collect::<String>(),
            "a name has at most 60 letters on one line",
        );
    }
    read.graph.names.retain(|area| socrates_maps::is_area_name(&area.name));
}

/// Gives an area of a location folder a name, which requests may then use.
///
/// The area is that of a node: its whole room or car where it lies in one, else the node alone; several are joined by commas.
/// A shipped location is copied into `out` first.
pub fn name(talk: &Printer, location: &str, area: &str, name: &str, out: Option<&Path>) -> Result<(), Diagnostic> {
    let (loaded, mut files) = load_location(location, Path::new("."))?;
    let inside = socrates_maps::openings::Enclosures::of(&loaded);
    let mut nodes = Vec::new();
    for id in area.split(',').map(str::trim) {
        let Some(node) = loaded.graph.nodes().iter().find(|node| node.id.as_str() == id) else {
            let near: Vec<&str> = loaded.graph.nodes().iter().map(|node| node.id.as_str()).take(12).collect();
            return Err(Diagnostic::input(
                format!("`{location}` has no node `{id}`"),
                format!(
                    "`socrates map draw {}` shows all ids: {} …",
                    files::shell(Path::new(location)),
                    near.join(", ")
                ),
            ));
        };
        let whole = inside.of_node(&node.id).map_or_else(|| vec![node.id.clone()], |room| room.nodes.clone());
        // The node that was named is the one to go to.
        for id in std::iter::once(node.id.clone()).chain(whole) {
            if !nodes.contains(&id) {
                nodes.push(id);
            }
        }
    }
    let named = socrates_model::AreaName { name: name.trim().to_owned(), nodes };
    let shipped = socrates_maps::shipped::files(location).is_some() || raw_map::file_of(Path::new(location)).is_some();
    let out = match (out, shipped) {
        (Some(out), _) => out.to_path_buf(),
        (None, false) => PathBuf::from(location),
        (None, true) => {
            let message = format!("`{location}` is no folder with a scene graph of your own");
            return Err(Diagnostic::input(message, "name a folder for the copy: `--out my-location`"));
        }
    };
    let before = files.get(EXTRA).map(|bytes| String::from_utf8_lossy(bytes).into_owned()).unwrap_or_default();
    let ends = if before.is_empty() || before.ends_with('\n') { "" } else { "\n" };
    files.insert(
        EXTRA.to_owned(),
        format!("{before}{ends}{}", written::names_toml(std::slice::from_ref(&named))).into_bytes(),
    );
    let checked = socrates_maps::parse(&files, &loaded.name).map_err(|faults| {
        Diagnostic::faults(
            format!("`{name}` cannot be given"),
            &faults,
            "choose another name, or correct location.toml",
        )
    })?;
    map::folder(&files, &out)?;
    let ids: Vec<&str> = named.nodes.iter().map(socrates_model::NodeId::as_str).collect();
    talk.line(&format!("named      {}: {} ({})", named.name, ids.join(", "), plural(checked.names.len(), "name")));
    talk.line(&format!("wrote      {}", out.join(EXTRA).display()));
    talk.result(&json!({ "location": out.display().to_string(), "name": named.name, "nodes": named.nodes }));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::Format;

    fn talk() -> Printer {
        Printer::to_nobody(Format::Json)
    }

    #[test]
    fn a_location_goes_out_in_every_format_and_comes_back() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let (office, files) = load_location("office", Path::new(".")).unwrap();
        map::folder(&files, &at("map")).unwrap();
        for format in GraphFormat::ALL {
            let (file, back) = (at(format.name()).join("graph"), at(&format!("back {}", format.name())));
            export(&talk(), "office", format.name(), Some(&file)).unwrap();
            let bytes = std::fs::read(&file).unwrap();
            export(&talk(), "office", format.name(), Some(&file)).unwrap();
            assert_eq!(std::fs::read(&file).unwrap(), bytes);
            assert!(file.with_file_name(NOT_CARRIED).is_file());
            let options =
                ImportOptions { from: format.name().to_owned(), map: Some(at("map")), level: None, out: back.clone() };
            import(&talk(), &file, &options).unwrap();
            let location = socrates_maps::load(&back).unwrap();
            assert_eq!(location.graph.nodes().len(), office.graph.nodes().len());
            assert_eq!(location.graph.edges().len(), office.graph.edges().len());
            assert!(back.join(NOT_CARRIED).is_file());
            let again = import(&talk(), &file, &options).unwrap_err();
            assert!(again.what.contains("has a scene graph already"), "{}", again.what);
        }
        let options = ImportOptions { from: "nav2-route".to_owned(), out: at("none"), ..ImportOptions::default() };
        let told = import(&talk(), &at("nav2-route/graph"), &options).unwrap_err();
        assert!(told.what.contains("no walls of its own"), "{}", told.what);
        let told = export(&talk(), "office", "dxf", None).unwrap_err();
        assert!(told.what.contains("`dxf`") && told.hint.contains("nav2-route"), "{told:?}");
    }

    #[test]
    fn levels_of_a_building_are_named_where_none_is_chosen() {
        let folder = tempfile::tempdir().unwrap();
        let text = "name: b\nlevels: {L1: {vertices: []}, L2: {vertices: []}}\n";
        let file = folder.path().join("b.building.yaml");
        std::fs::write(&file, text).unwrap();
        let options =
            ImportOptions { from: "rmf".to_owned(), out: folder.path().join("out"), ..ImportOptions::default() };
        let told = import(&talk(), &file, &options).unwrap_err();
        assert!(told.what.contains("L1, L2") && told.what.contains("2 levels"), "{}", told.what);
        let third = ImportOptions { level: Some("L3".to_owned()), ..options };
        let told = import(&talk(), &file, &third).unwrap_err();
        assert!(told.what.contains("there is no `L3`"), "{}", told.what);
    }

    #[test]
    fn an_area_gets_a_name_and_no_second_one_the_same() {
        let folder = tempfile::tempdir().unwrap();
        let mine = folder.path().join("mine");
        let told = name(&talk(), "hospital", "p2", "pharmacy", None).unwrap_err();
        assert!(told.what.contains("no folder") && told.hint.contains("--out"), "{told:?}");
        name(&talk(), "hospital", "p2", "pharmacy", Some(&mine)).unwrap();
        let location = socrates_maps::load(&mine).unwrap();
        assert_eq!(location.named("Pharmacy").unwrap().nodes[0].as_str(), "p2");
        let here = mine.display().to_string();
        name(&talk(), &here, "ns,p1", "Süße Ecke", None).unwrap();
        assert!(socrates_maps::load(&mine).unwrap().named("süße ecke").unwrap().nodes.len() >= 2);
        for (area, word, part) in [("p1", "PHARMACY", "taken"), ("p1", "", "is no name"), ("zz", "x", "no node `zz`")] {
            let told = name(&talk(), &here, area, word, None).unwrap_err();
            assert!(format!("{} {}", told.what, told.short()).contains(part), "{}", told.short());
        }
    }
}
