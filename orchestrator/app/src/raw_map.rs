//! Maps without a scene graph: read, annotated by the program, and made a location in memory.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use socrates_annotate::{Annotation, Options};
use socrates_draw::MapNote;
use socrates_maps::{GRAPH, Kept, MAP};
use socrates_model::{Fault, Location};

use crate::exit::Complaint;
use crate::files;
use crate::words::plural;

/// A map with what was found on it.
#[derive(Debug, Clone)]
pub(crate) struct RawMap {
    /// The location, as its files are read.
    pub(crate) location: Location,
    /// The files of its folder.
    pub(crate) files: BTreeMap<String, Vec<u8>>,
    /// What was found.
    pub(crate) annotation: Annotation,
}

/// The map file that a name means, if it means a map without a scene graph: a YAML file, or a folder with one.
pub(crate) fn file_of(path: &Path) -> Option<PathBuf> {
    if path.is_file() {
        return is_yaml(path).then(|| path.to_path_buf());
    }
    if path.join(GRAPH).exists() {
        return None;
    }
    file_in(path)
}

fn is_yaml(path: &Path) -> bool {
    path.extension().is_some_and(|ext| ext == "yaml" || ext == "yml")
}

/// The map file of a folder: `map.yaml`, or the only YAML file.
fn file_in(folder: &Path) -> Option<PathBuf> {
    let usual = folder.join(MAP);
    if usual.is_file() {
        return Some(usual);
    }
    let entries = std::fs::read_dir(folder).ok()?.filter_map(Result::ok).map(|entry| entry.path());
    let mut yaml = entries.filter(|path| is_yaml(path));
    let only = yaml.next()?;
    yaml.next().is_none().then_some(only)
}

/// The map file of a folder or a map file itself, whether or not a scene graph lies beside it.
pub(crate) fn given(path: &Path) -> Result<PathBuf, Complaint> {
    let file = if path.is_dir() { file_in(path) } else { path.is_file().then(|| path.to_path_buf()) };
    file.ok_or_else(|| {
        Complaint::input(
            format!("`{}` is no map", path.display()),
            "give a map file of ROS (map.yaml beside its image), or a folder with one",
        )
    })
}

/// What was found on the last few maps, so that a batch on one map looks at it once.
static FOUND: Kept<Result<Annotation, Vec<Fault>>> = Kept::new();

/// Reads a map file and annotates it.
pub(crate) fn annotated(file: &Path, options: &Options) -> Result<RawMap, Complaint> {
    let wrong = |what: &str, faults: &[Fault]| {
        Complaint::faults(
            format!("the map `{}` {what}", file.display()),
            faults,
            "`socrates explain CODE` says what to do; `socrates map annotate --help` lists what can be said about a map",
        )
    };
    let (raw, mut files) = socrates_maps::load_raw(file).map_err(|faults| wrong("is not usable", &faults))?;
    let found = if *options == Options::default() {
        FOUND.of(&raw.grid, |grid| socrates_annotate::annotate(grid, options)).as_ref().clone()
    } else {
        socrates_annotate::annotate(&raw.grid, options)
    };
    let annotation = found.map_err(|faults| wrong("cannot be annotated", &faults))?;
    files.extend(socrates_annotate::files(&annotation, &raw.grid));
    let name = name(file);
    let location = socrates_maps::parse(&files, &name)
        .map_err(|faults| wrong("was annotated, and what was found is not usable: please report the map", &faults))?;
    Ok(RawMap { location, files, annotation })
}

/// What a location of a map file is called: its folder where the file is called `map`, else the file.
fn name(file: &Path) -> String {
    let stem = file.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let folder = file.parent().and_then(|folder| folder.canonicalize().ok());
    let folder = folder.as_deref().and_then(Path::file_name).map(|name| name.to_string_lossy().into_owned());
    if stem == "map" { folder.unwrap_or(stem) } else { stem }
}

/// What was found, in a few words.
pub(crate) fn summary(annotation: &Annotation) -> String {
    let counts = &annotation.counts;
    let mut parts =
        vec![plural(annotation.graph.nodes().len(), "node"), plural(annotation.graph.edges().len(), "edge")];
    for (count, word) in [
        (counts.doors, "doorway"),
        (counts.rooms, "room"),
        (counts.elevators, "elevator"),
        (counts.intersections, "intersection"),
        (counts.corners, "blind corner"),
    ] {
        if count > 0 {
            parts.push(plural(count, word));
        }
    }
    parts.join(", ")
}

/// The line that says that a map was annotated.
pub(crate) fn note(map: &RawMap, given: &str) -> String {
    format!(
        "`{given}` has no scene graph: the program found {} on its map; `socrates map annotate {}` writes and draws them",
        summary(&map.annotation),
        files::shell(Path::new(given))
    )
}

/// The remarks for a picture.
pub(crate) fn notes(annotation: &Annotation) -> Vec<MapNote> {
    annotation.remarks.iter().map(|remark| MapNote { at: remark.at, text: remark.text.clone() }).collect()
}
