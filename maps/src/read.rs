//! From the files of a folder to a location, with every problem named at once.

use std::collections::BTreeMap;
use std::path::{Component, Path};

use socrates_model::{Fault, FaultCode, GraphEdge, Grid, Location, SceneGraph, Where};

use crate::field::DistanceField;
use crate::{check, doors_file, graph_file, image, map_file, route};

/// Name of the map's description in a location folder.
pub const MAP: &str = "map.yaml";
/// Name of the scene graph in a location folder.
pub const GRAPH: &str = "scene_graph.json";
/// Name of the optional file of the description and the doors in a location folder.
pub const EXTRA: &str = "location.toml";

/// Radius with which an edge is led round walls, m: a person's; then ever slimmer ones are tried.
const ROUTE_RADII_M: [f64; 3] = [0.3, 0.2, 0.05];
/// A way round a wall may be this many times the straight line, plus [`DETOUR_M`].
const DETOUR: f64 = 3.0;
/// See [`DETOUR`], m.
const DETOUR_M: f64 = 4.0;

/// Reads a location folder: `map.yaml`, its image, `scene_graph.json` and, where there is one, `location.toml`.
///
/// # Errors
/// Every problem found in any of the files, as faults with file, line or key, the value, and a hint.
pub fn load(dir: &Path) -> Result<Location, Vec<Fault>> {
    let mut files = BTreeMap::new();
    let mut faults = Vec::new();
    let mut take = |name: &str, needed: bool| match std::fs::read(dir.join(name)) {
        Ok(bytes) => {
            files.insert(name.to_owned(), bytes);
        }
        Err(why) if !needed && why.kind() == std::io::ErrorKind::NotFound => {}
        Err(why) => faults.push(Fault::new(
            FaultCode::MRead,
            Where::file(dir.join(name).display()),
            format!("cannot be read: {why}; a location folder holds `{MAP}`, its image and `{GRAPH}`"),
        )),
    };
    take(MAP, true);
    take(GRAPH, true);
    take(EXTRA, false);
    if let Some(name) = files.get(MAP).and_then(|bytes| map_file::image_name(bytes)).filter(|name| stays_inside(name)) {
        // A missing image is reported by the parser, which knows the line that names it.
        if let Ok(bytes) = std::fs::read(dir.join(&name)) {
            files.insert(name, bytes);
        }
    }
    let name = dir
        .canonicalize()
        .ok()
        .as_deref()
        .unwrap_or(dir)
        .file_name()
        .map_or_else(|| "location".to_owned(), |name| name.to_string_lossy().into_owned());
    if faults.is_empty() {
        return parse(&files, &name);
    }
    // Files that could not be read are already named; "missing" would say it twice.
    faults.extend(assemble(&files, &name, Missing::Named).err().unwrap_or_default());
    Err(faults)
}

/// Reads a map alone, without a scene graph: a map_server YAML file of any name, and the image it names beside it.
///
/// The location has no nodes; its name is the file's stem.
///
/// # Errors
/// Every problem found in the two files.
pub fn load_map(file: &Path) -> Result<Location, Vec<Fault>> {
    load_raw(file).map(|(location, _)| location)
}

/// A map as a location without nodes, and the bytes of its files by their names in a location folder.
pub type MapWithFiles = (Location, BTreeMap<String, Vec<u8>>);

/// The same with the bytes of both files, that of the description under the name `map.yaml`, as a location folder holds it.
///
/// # Errors
/// As for [`load_map`].
pub fn load_raw(file: &Path) -> Result<MapWithFiles, Vec<Fault>> {
    let bytes = std::fs::read(file).map_err(|why| {
        vec![Fault::new(FaultCode::MRead, Where::file(file.display()), format!("cannot be read: {why}"))]
    })?;
    let folder = file.parent().unwrap_or_else(|| Path::new("."));
    let mut files = BTreeMap::new();
    if let Some(name) = map_file::image_name(&bytes).filter(|name| stays_inside(name))
        && let Ok(image) = std::fs::read(folder.join(&name))
    {
        files.insert(name, image);
    }
    files.insert(MAP.to_owned(), bytes);
    let (mut faults, mut warnings) = (Vec::new(), Vec::new());
    let grid = read_grid(&files, Missing::Unnamed, &mut faults, &mut warnings);
    let (soft, hard): (Vec<Fault>, Vec<Fault>) = faults.into_iter().partition(Fault::is_soft);
    let Some(grid) = grid.filter(|_| hard.is_empty()) else { return Err(hard) };
    let name = file.file_stem().map_or_else(|| "map".to_owned(), |stem| stem.to_string_lossy().into_owned());
    let location = Location {
        format: socrates_model::FORMAT,
        description: name.replace(['_', '-'], " "),
        name,
        grid,
        graph: SceneGraph::default(),
        doors: Vec::new(),
        warnings: warnings.into_iter().chain(soft.iter().map(ToString::to_string)).collect(),
    };
    Ok((location, files))
}

/// Whether a file name stays in its folder.
pub(crate) fn stays_inside(name: &str) -> bool {
    !name.is_empty()
        && Path::new(name).components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir))
}

/// The pure core of [`load`]: file names (within the folder) with their bytes; other files are ignored.
///
/// # Errors
/// Every problem found, as for [`load`].
pub fn parse(files: &BTreeMap<String, Vec<u8>>, name: &str) -> Result<Location, Vec<Fault>> {
    assemble(files, name, Missing::Unnamed)
}

/// Whether a file that is not there was named before.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Missing {
    Named,
    Unnamed,
}

impl Missing {
    fn say(self, file: &str, why: &str, faults: &mut Vec<Fault>) {
        if self == Self::Unnamed {
            faults.push(Fault::new(FaultCode::MRead, Where::file(file), why));
        }
    }
}

fn assemble(files: &BTreeMap<String, Vec<u8>>, name: &str, missing: Missing) -> Result<Location, Vec<Fault>> {
    let mut faults = Vec::new();
    let mut warnings: Vec<String> = Vec::new();
    let grid = read_grid(files, missing, &mut faults, &mut warnings);
    // Node positions need the map; without one the graph is still read, over a map of no cells.
    let graph = match files.get(GRAPH) {
        Some(bytes) => graph_file::read(bytes, grid.as_ref(), &mut faults),
        None => {
            missing.say(GRAPH, "is missing; it holds the nodes and edges of the map", &mut faults);
            None
        }
    };
    let extra = match files.get(EXTRA) {
        Some(bytes) => doors_file::read(bytes, &mut faults),
        None => Some(doors_file::LocationFile::default()),
    };
    let (Some(grid), Some(graph), Some(extra)) = (grid, graph, extra) else { return Err(faults) };
    let description = extra.description.unwrap_or_else(|| name.replace(['_', '-'], " "));
    let mut location = Location {
        format: socrates_model::FORMAT,
        name: name.to_owned(),
        description,
        grid,
        graph,
        doors: extra.doors,
        warnings: Vec::new(),
    };
    route_edges(&mut location, &mut faults, &mut warnings);
    // An edge that could not be routed is named already, with the reason.
    let named: Vec<(FaultCode, Where)> = faults.iter().map(|fault| (fault.code, fault.at.clone())).collect();
    let fresh = |fault: &Fault| !named.contains(&(fault.code, fault.at.clone()));
    faults.extend(check(&location).into_iter().filter(fresh));
    faults.sort();
    faults.dedup();
    let (soft, hard): (Vec<Fault>, Vec<Fault>) = faults.into_iter().partition(Fault::is_soft);
    if !hard.is_empty() {
        return Err(hard);
    }
    location.warnings = warnings.into_iter().chain(soft.iter().map(ToString::to_string)).collect();
    Ok(location)
}

fn read_grid(
    files: &BTreeMap<String, Vec<u8>>,
    missing: Missing,
    faults: &mut Vec<Fault>,
    warnings: &mut Vec<String>,
) -> Option<Grid> {
    let Some(bytes) = files.get(MAP) else {
        missing.say(MAP, "is missing; it names the map image, its resolution and origin", faults);
        return None;
    };
    let map = map_file::read(bytes, faults, warnings)?;
    let Some(bytes) = files.get(&map.image) else {
        let message = format!("the image `{}` is missing; it lies beside `{MAP}`", map.image);
        faults.push(Fault::new(FaultCode::MImage, &map.image_at, message));
        return None;
    };
    match image::read(bytes) {
        Ok(picture) => Some(map.grid(&picture)),
        Err(why) => {
            faults.push(Fault::new(FaultCode::MImage, Where::file(&map.image), why));
            None
        }
    }
}

/// An edge of the scene graph.
pub(crate) fn edge_at(edge: &GraphEdge) -> Where {
    Where::file(GRAPH).at_key(format_args!("edge `{}` – `{}`", edge.from, edge.to))
}

/// Leads every edge whose straight line meets walls round them, or says that there is no way.
fn route_edges(location: &mut Location, faults: &mut Vec<Fault>, warnings: &mut Vec<String>) {
    let mut field: Option<DistanceField> = None;
    let sight = crate::Sight::new(&location.grid);
    let mut led = location.graph.edges().to_vec();
    for edge in &mut led {
        let ends = location.graph.node(&edge.from).zip(location.graph.node(&edge.to));
        let Some((a, b)) = ends.map(|(a, b)| (a.at, b.at)) else { continue };
        // A node in a wall is its own fault; a way from there says nothing new.
        if !location.grid.is_free(&a) || !location.grid.is_free(&b) || sight.clear(&a, &b) {
            continue;
        }
        let field = field.get_or_insert_with(|| DistanceField::new(&location.grid));
        let way = ROUTE_RADII_M.iter().find_map(|radius| route::shortest_path(&location.grid, field, &a, &b, *radius));
        let at = edge_at(edge);
        let straight_m = (b - a).norm();
        let length = |way: &[socrates_model::Point]| -> f64 {
            way.windows(2).map(|pair| if let [p, q] = pair { (q - p).norm() } else { 0.0 }).sum()
        };
        match way.map(|way| (length(&way), way)) {
            Some((length_m, way)) if length_m <= DETOUR * straight_m + DETOUR_M => {
                edge.via = way.get(1..way.len().saturating_sub(1)).unwrap_or_default().to_vec();
                let message = format!(
                    "the straight line of {straight_m:.2} m crosses walls; it was led round them through {} points, {length_m:.2} m",
                    edge.via.len()
                );
                warnings.push(Fault::new(FaultCode::MRoute, at, message).to_string());
            }
            Some((length_m, _)) => faults.push(Fault::new(
                FaultCode::GFree,
                at,
                format!("the straight line of {straight_m:.2} m crosses walls and the way round is {length_m:.1} m; remove the edge or move its nodes"),
            )),
            None => faults.push(Fault::new(
                FaultCode::GFree,
                at,
                format!("the straight line of {straight_m:.2} m crosses walls and there is no way round; open the wall in the image or remove the edge"),
            )),
        }
    }
    location.graph = location.graph.edited(|_, edges| *edges = led);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Sight;

    /// Two rooms with a gap at y 2 to 3, and an edge that runs below the gap.
    const PLAN: &str = r#"description = "Two rooms."
size_m = [8.0, 5.0]
resolution_m = 0.1
floors = [[0.5, 0.5, 7.5, 4.5]]
walls = [[4.0, 0.5, 4.0, 4.5]]
openings = [[4.0, 2.0, 4.0, 3.0]]
nodes = [{ id = "a", type = "ROOM", at = [2.0, 1.0] }, { id = "b", type = "ROOM", at = [6.0, 1.0] }]
edges = [{ type = "DOORWAY", along = ["a", "b"] }]
"#;

    #[test]
    fn an_edge_through_a_wall_is_led_round_with_a_warning() {
        let location = parse(&crate::generate(PLAN).unwrap(), "two").unwrap();
        assert!(location.warnings[0].starts_with("M-ROUTE"), "{:?}", location.warnings);
        let edge = &location.graph.edges()[0];
        assert!(!edge.via.is_empty() && edge.via.len() < 12, "{:?}", edge.via);
        let points = location.graph.edge_points(&edge.from, &edge.to).unwrap();
        let sight = Sight::new(&location.grid);
        let field = DistanceField::new(&location.grid);
        assert!(points.windows(2).all(|pair| sight.clear(&pair[0], &pair[1])));
        assert!(edge.via.iter().all(|point| field.clearance(point) > 0.25));
        let length = location.graph.edge_length_m(&edge.from, &edge.to).unwrap();
        assert!((4.5..5.5).contains(&length), "{length}");
    }

    #[test]
    fn an_edge_without_a_way_round_is_refused() {
        let mut files = crate::generate(PLAN).unwrap();
        let closed = PLAN
            .replace("openings = [[4.0, 2.0, 4.0, 3.0]]", "")
            .replace("nodes = [", "nodes = [{ id = \"c\", type = \"ROOM\", at = [1.0, 1.0] }, ");
        let closed = closed
            .replace("[\"a\", \"b\"]", "[\"a\", \"c\"]")
            .replace("{ id = \"b\", type = \"ROOM\", at = [6.0, 1.0] }", "");
        files.insert("map.png".into(), crate::generate(&closed).unwrap()["map.png"].clone());
        let faults = parse(&files, "two").unwrap_err();
        assert_eq!(faults.len(), 1, "{faults:#?}");
        assert_eq!(faults[0].code, FaultCode::GFree);
        assert!(faults[0].message.to_string().contains("no way round"), "{}", faults[0]);
    }

    #[test]
    fn an_image_outside_the_folder_is_refused() {
        for name in ["../map.png", "/tmp/map.png", ""] {
            assert!(!stays_inside(name), "{name}");
        }
        assert!(stays_inside("map.png") && stays_inside("images/map.png"));
    }
}
