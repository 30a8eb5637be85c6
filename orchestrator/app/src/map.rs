//! `map`: list, check, draw, generate, annotate, score.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde_json::json;
use socrates_annotate::Options;
use socrates_draw::MapNote;
use socrates_maps::random::Kind;
use socrates_model::{Fault, Location, Point};

use crate::exit::Diagnostic;
use crate::files;
use crate::output::Printer;
use crate::prepare::{load_location, shadowed};
use crate::raw_map;
use crate::words::plural;

/// Largest floor plan that is read, bytes.
const MAX_PLAN_BYTES: u64 = 4 * 1024 * 1024;

/// Lists the shipped locations and their requests.
pub fn list(talk: &Printer) -> Result<(), Diagnostic> {
    let mut all = Vec::new();
    for name in socrates_maps::shipped::names() {
        let (location, _) = load_location(name, Path::new("."))?;
        talk.line(&format!("{name:<11} {}", location.description));
        let requests: Vec<String> =
            socrates_maps::shipped::requests(name).into_iter().map(|(stem, _)| stem.to_owned()).collect();
        talk.line(&format!("{:<11} requests: {}", "", requests.join(", ")));
        all.push(json!({ "name": name, "description": location.description, "requests": requests }));
    }
    talk.result(&json!({ "locations": all }));
    Ok(())
}

/// Says that a shipped location is meant and not a folder of its name.
fn told_shadow(talk: &Printer, name: &str) {
    if let Some(note) = shadowed(name, Path::new(".")) {
        talk.line(&format!("note       {note}"));
    }
}

/// Says everything that is wrong with a location.
pub fn check(talk: &Printer, name: &str) -> Result<(), Diagnostic> {
    told_shadow(talk, name);
    let (location, _) = load_location(name, Path::new("."))?;
    let faults = socrates_maps::check(&location);
    let (hard, soft): (Vec<_>, Vec<_>) = faults.into_iter().partition(|fault| !fault.is_soft());
    for warning in &location.warnings {
        talk.line(&format!("warning    {warning}"));
    }
    for fault in &soft {
        talk.line(&format!("warning    {fault}"));
    }
    if !hard.is_empty() {
        return Err(Diagnostic::faults(
            format!("the location `{name}` has {}", plural(hard.len(), "fault")),
            &hard,
            "`socrates explain CODE` says what to do",
        ));
    }
    let grid = &location.grid;
    talk.line(&format!(
        "good       {name}: {} × {} cells of {} m, {}, {}, {}",
        grid.width,
        grid.height,
        grid.resolution_m,
        plural(location.graph.nodes().len(), "node"),
        plural(location.graph.edges().len(), "edge"),
        plural(location.doors.len(), "door")
    ));
    talk.result(&json!({ "location": name, "nodes": location.graph.nodes().len(), "edges": location.graph.edges().len(), "warnings": location.warnings }));
    Ok(())
}

/// Draws a location with its node ids; a map without a scene graph with what is found on it, and with remarks.
pub fn draw(talk: &Printer, name: &str, out: &Path) -> Result<(), Diagnostic> {
    let (location, notes) = match raw_map::file_of(Path::new(name)) {
        Some(file) => {
            let map = raw_map::annotated(&file, &Options::default())?;
            talk.line(&format!("note       {}", raw_map::note(&map, name)));
            (map.location, raw_map::notes(&map.annotation))
        }
        None => (load_location(name, Path::new("."))?.0, Vec::new()),
    };
    picture(&location, &notes, out)?;
    talk.line(&format!("look       {}", out.display()));
    talk.result(&json!({ "picture": out.display().to_string() }));
    Ok(())
}

/// Writes the picture of a location, as SVG or PNG.
fn picture(location: &Location, notes: &[MapNote], out: &Path) -> Result<(), Diagnostic> {
    let svg = socrates_draw::annotated_map_with(location, notes);
    let bytes = if out.extension().is_some_and(|ext| ext == "svg") {
        svg.into_bytes()
    } else {
        socrates_draw::png_from_svg(&svg, 1.0)
            .map_err(|why| Diagnostic::input(why.to_string(), "choose an .svg file instead"))?
    };
    std::fs::write(out, bytes)
        .map_err(|why| Diagnostic::input(format!("cannot write `{}`: {why}", out.display()), "check the folder"))
}

/// What a person says about a map that is annotated.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct AnnotateOptions {
    /// Folder to write; by default the map's name with `-annotated` where the command is given.
    pub out: Option<PathBuf>,
    /// `x,y` of a point on the floor that is annotated, map frame, m.
    pub keep: Option<String>,
    /// `x,y;x,y;…`: corners of a polygon outside of which nothing is looked at, map frame, m.
    pub within: Option<String>,
    /// `x,y` of points in rooms that are cars of elevators, map frame, m.
    pub elevators: Vec<String>,
}

/// Finds the places of a map without a scene graph, and writes a location folder with a picture.
pub fn annotate(talk: &Printer, given: &Path, options: &AnnotateOptions) -> Result<(), Diagnostic> {
    let file = raw_map::given(given)?;
    let said = Options {
        keep: options.keep.as_deref().map(|text| point("--keep", text)).transpose()?,
        within: match options.within.as_deref() {
            Some(text) => text.split(';').map(|corner| point("--within", corner)).collect::<Result<_, _>>()?,
            None => Vec::new(),
        },
        elevators: options.elevators.iter().map(|text| point("--elevator", text)).collect::<Result<_, _>>()?,
    };
    let map = raw_map::annotated(&file, &said)?;
    let out = options.out.clone().unwrap_or_else(|| PathBuf::from(format!("{}-annotated", map.location.name)));
    if out.join(socrates_maps::GRAPH).exists() {
        return Err(Diagnostic::input(
            format!("`{}` has a scene graph already, which is left as it is", out.display()),
            "name another folder with `--out`, or remove its scene_graph.json",
        ));
    }
    talk.line(&format!("found      {}: {}", map.location.name, raw_map::summary(&map.annotation)));
    for (number, remark) in map.annotation.remarks.iter().enumerate() {
        talk.line(&format!("remark {:<4}{remark}", number + 1));
    }
    folder(&map.files, &out)?;
    let drawn = out.join("annotation.png");
    picture(&map.location, &raw_map::notes(&map.annotation), &drawn)?;
    let shown = files::shell(&out);
    talk.line(&format!("wrote      {} ({})", out.display(), map.files.keys().cloned().collect::<Vec<_>>().join(", ")));
    talk.line(&format!("look       {}", drawn.display()));
    talk.line(&format!("next       socrates new my.toml --location {shown}"));
    talk.result(&json!({
        "location": out.display().to_string(),
        "counts": map.annotation.counts,
        "nodes": map.annotation.graph.nodes().len(),
        "edges": map.annotation.graph.edges().len(),
        "remarks": map.annotation.remarks,
        "picture": drawn.display().to_string(),
        "files": map.files.keys().collect::<Vec<_>>(),
    }));
    Ok(())
}

/// `x,y` in the map frame, m.
fn point(option: &str, text: &str) -> Result<Point, Diagnostic> {
    let numbers: Vec<f64> = text.split(',').filter_map(|part| part.trim().parse().ok()).collect();
    match numbers.as_slice() {
        [x, y] if x.is_finite() && y.is_finite() && text.split(',').count() == 2 => Ok(Point::new(*x, *y)),
        _ => Err(Diagnostic::input(
            format!("`{option} {text}` is no point"),
            format!("write x,y in the map frame, m: {option} 4.5,-2"),
        )),
    }
}

/// Says how near the second annotation of a map comes to the first.
pub fn score(talk: &Printer, first: &str, second: &str) -> Result<(), Diagnostic> {
    let load = |name: &str| {
        told_shadow(talk, name);
        load_location(name, Path::new(".")).map(|(location, _)| location)
    };
    let score = socrates_annotate::score::score(&load(first)?, &load(second)?);
    let rows = [
        ("nodes, 1.0 m", score.nodes),
        ("structural, 1.0 m", score.structural),
        ("doors, 0.5 m", score.doors),
        ("edges", score.edges),
    ];
    talk.line(&format!(
        "{:<19}{:>6}{:>8}{:>9}{:>11}{:>8}{:>6}",
        "", "first", "second", "matched", "precision", "recall", "F1"
    ));
    for (name, row) in rows {
        talk.line(&format!(
            "{name:<19}{:>6}{:>8}{:>9}{:>11.2}{:>8.2}{:>6.2}",
            row.first, row.second, row.matched, row.precision, row.recall, row.f1
        ));
    }
    let (ways, valid) = (score.detours, score.validity);
    talk.line(&format!("types              {:.2} of the matched nodes have the same place class", score.types));
    talk.line(&format!(
        "detours            median {:.2}, 95 % {:.2} of {}, {} not reached",
        ways.p50,
        ways.p95,
        plural(ways.pairs, "way"),
        ways.unreached
    ));
    talk.line(&format!(
        "validity           {} of {} blocked for a radius of 0.3 m, {}, {} in walls",
        valid.blocked,
        plural(valid.edges, "edge"),
        plural(valid.parts, "part"),
        plural(valid.in_walls, "node")
    ));
    talk.result(&json!({ "first": first, "second": second, "score": score }));
    Ok(())
}

/// The files of a location that a floor plan describes.
pub fn generated(plan: &Path) -> Result<BTreeMap<String, Vec<u8>>, Diagnostic> {
    let hint = "see maps/README.md for the form of a floor plan";
    let text = files::text(plan, MAX_PLAN_BYTES, hint)?;
    socrates_maps::generate(&text).map_err(|faults| {
        Diagnostic::faults(format!("the floor plan `{}` is not usable", plan.display()), &faults, hint)
    })
}

/// Makes a location folder from a floor plan; files of a folder that is there are written anew.
pub fn generate(talk: &Printer, plan: &Path, out: &Path) -> Result<(), Diagnostic> {
    write(talk, &generated(plan)?, out)
}

/// Whether a folder can be written: one that holds anything, or a file in its place, is left as it is.
pub(crate) fn is_free(out: &Path) -> Result<(), Diagnostic> {
    let taken = match std::fs::read_dir(out) {
        Ok(mut entries) => entries.next().is_some(),
        Err(why) => why.kind() != std::io::ErrorKind::NotFound,
    };
    if taken {
        let message = format!("`{}` is there already and is not an empty folder", out.display());
        return Err(Diagnostic::input(message, "name another folder with `--out`, or remove it"));
    }
    Ok(())
}

/// Makes a location folder from a floor plan that is drawn by a seed, with the plan in it.
///
/// Without `out` the folder is called by kind and seed. A folder that holds anything already is left as it is.
pub fn random(talk: &Printer, seed: u64, kind: &str, out: Option<&Path>) -> Result<(), Diagnostic> {
    let kind = self::kind(kind)?;
    let out = out.map_or_else(|| PathBuf::from(socrates_maps::random::name(seed, kind)), Path::to_path_buf);
    is_free(&out)?;
    let files = socrates_maps::random::files(seed, kind).map_err(|faults| not_usable(seed, kind, &faults))?;
    write(talk, &files, &out)
}

/// The kind of random worlds of this name.
pub(crate) fn kind(name: &str) -> Result<Kind, Diagnostic> {
    name.parse().map_err(|fault| {
        Diagnostic::faults("there is no such random world", &[fault], "choose one of the kinds with `--kind`")
    })
}

/// What is said of a random world that its own checks refuse.
pub(crate) fn not_usable(seed: u64, kind: Kind, faults: &[Fault]) -> Diagnostic {
    let message = format!("the {kind} of seed {seed} is not usable");
    Diagnostic::faults(message, faults, "please report the kind and the seed; another seed gives another world")
}

/// Writes files into a folder.
pub(crate) fn folder(files: &BTreeMap<String, Vec<u8>>, out: &Path) -> Result<(), Diagnostic> {
    let cannot = |path: &Path, why: std::io::Error| {
        Diagnostic::input(format!("cannot write `{}`: {why}", path.display()), "check the folder")
    };
    std::fs::create_dir_all(out).map_err(|why| cannot(out, why))?;
    for (name, bytes) in files {
        let path = out.join(name);
        std::fs::write(&path, bytes).map_err(|why| cannot(&path, why))?;
    }
    Ok(())
}

fn write(talk: &Printer, files: &BTreeMap<String, Vec<u8>>, out: &Path) -> Result<(), Diagnostic> {
    folder(files, out)?;
    talk.line(&format!("wrote      {} ({})", out.display(), files.keys().cloned().collect::<Vec<_>>().join(", ")));
    talk.line(&format!("next       socrates map draw {}", out.display()));
    talk.result(&json!({ "location": out.display().to_string(), "files": files.keys().collect::<Vec<_>>() }));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::Format;

    #[test]
    fn a_random_world_is_written_once_and_other_kinds_are_refused() {
        let talk = Printer::to_nobody(Format::Json);
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("home-7");
        random(&talk, 7, "home", Some(&out)).unwrap();
        let location = socrates_maps::load(&out).unwrap();
        assert_eq!(location, socrates_maps::random::location(7, Kind::Home).unwrap());
        let plan = std::fs::read(out.join("plan.toml")).unwrap();
        let again = random(&talk, 8, "home", Some(&out)).unwrap_err();
        assert!(again.what.contains("home-7") && again.what.contains("not an empty folder"), "{}", again.what);
        assert_eq!(std::fs::read(out.join("plan.toml")).unwrap(), plan);
        // The plan in the folder makes the folder.
        let copy = folder.path().join("copy");
        generate(&talk, &out.join("plan.toml"), &copy).unwrap();
        assert_eq!(std::fs::read(copy.join("map.png")).unwrap(), std::fs::read(out.join("map.png")).unwrap());
        let castle = random(&talk, 7, "castle", Some(&folder.path().join("castle-7"))).unwrap_err();
        assert!(castle.short().contains("`castle`") && castle.short().contains("warehouse"), "{}", castle.short());
        assert!(!folder.path().join("castle-7").exists());
    }

    #[test]
    fn a_folder_that_has_the_name_of_a_shipped_location_is_told_of() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(shadowed("office", folder.path()), None);
        std::fs::create_dir(folder.path().join("office")).unwrap();
        assert_eq!(shadowed("office", folder.path()), None, "no map is in it");
        std::fs::write(folder.path().join("office/map.yaml"), "").unwrap();
        assert!(shadowed("office", folder.path()).is_some_and(|note| note.contains("`./office` is the folder here")));
        assert_eq!(shadowed("./office", folder.path()), None);
    }

    #[test]
    fn a_map_without_a_scene_graph_is_a_location_and_annotate_writes_it_elsewhere() {
        let talk = Printer::to_nobody(Format::Json);
        let folder = tempfile::tempdir().unwrap();
        let raw = folder.path().join("mine");
        let shipped = socrates_maps::shipped::files("office").unwrap();
        let map = |name: &str| shipped[name].clone();
        self::folder(&BTreeMap::from(["map.yaml", "map.png"].map(|name| (name.to_owned(), map(name)))), &raw).unwrap();
        let (location, files) = load_location(&raw.display().to_string(), Path::new(".")).unwrap();
        assert_eq!(location.name, "mine");
        assert!(!location.graph.nodes().is_empty() && files.contains_key("scene_graph.json"));
        assert_eq!(std::fs::read_dir(&raw).unwrap().count(), 2, "nothing is written into the folder");
        let out = folder.path().join("made");
        let options = AnnotateOptions { out: Some(out.clone()), ..AnnotateOptions::default() };
        annotate(&talk, &raw, &options).unwrap();
        assert_eq!(socrates_maps::load(&out).unwrap().graph, location.graph);
        assert!(out.join("annotation.png").is_file() && out.join("annotation.json").is_file());
        let again = annotate(&talk, &raw, &options).unwrap_err();
        assert!(again.what.contains("has a scene graph already"), "{}", again.what);
        score(&talk, "office", &out.display().to_string()).unwrap();
        for (keep, part) in [("4", "`--keep 4` is no point"), ("900,900", "cannot be annotated")] {
            let wrong = AnnotateOptions { keep: Some(keep.to_owned()), ..AnnotateOptions::default() };
            let told = annotate(&talk, &raw, &wrong).unwrap_err();
            assert!(told.what.contains(part), "{}", told.what);
        }
        let nothing = annotate(&talk, &folder.path().join("nowhere"), &options).unwrap_err();
        assert!(nothing.what.contains("is no map"), "{}", nothing.what);
    }
}
