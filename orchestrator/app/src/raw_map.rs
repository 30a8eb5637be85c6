//! Maps without a scene graph: read, annotated by the program, and made a location in memory.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use socrates_annotate::{Annotation, Options};
use socrates_draw::MapNote;
use socrates_maps::{Finding, GRAPH, Kept, MAP, findings};
use socrates_model::{Fault, Location};

use crate::exit::Diagnostic;
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
pub(crate) fn given(path: &Path) -> Result<PathBuf, Diagnostic> {
    let file = if path.is_dir() { file_in(path) } else { path.is_file().then(|| path.to_path_buf()) };
    file.ok_or_else(|| {
        Diagnostic::input(
            format!("`{}` is no map", path.display()),
            "give a map file of ROS (map.yaml beside its image), or a folder with one",
        )
    })
}

/// What was found on the last few maps, so that a batch on one map looks at it once.
static FOUND: Kept<Result<Annotation, Vec<Fault>>> = Kept::new();

/// Reads a map file and annotates it.
pub(crate) fn annotated(file: &Path, options: &Options) -> Result<RawMap, Diagnostic> {
    let wrong = |what: &str, faults: &[Fault]| {
        Diagnostic::faults(
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
    let location = checked(file, &files, &name)?;
    Ok(RawMap { location, files, annotation })
}

/// The location of a map's files and its annotation.
///
/// # Errors
/// The problems that the check of locations finds in the annotation, each with its point on the map.
fn checked(file: &Path, files: &BTreeMap<String, Vec<u8>>, name: &str) -> Result<Location, Diagnostic> {
    socrates_maps::parse(files, name).map_err(|faults| {
        let found = socrates_maps::draft(files, name).map_or_else(|_| Vec::new(), |it| findings(&it.location));
        let point = |fault: &Fault| {
            let same = |finding: &&Finding| finding.fault.code == fault.code && finding.fault.at == fault.at;
            found.iter().find(same).and_then(|finding| finding.at)
        };
        let cause = |fault: &Fault| match point(fault) {
            Some(at) => format!("{fault} (near x {:.2}, y {:.2} m on the map)", at.x, at.y),
            None => fault.to_string(),
        };
        let (shown, given) = (file.display(), files::shell(file));
        let count = plural(faults.len(), "problem");
        let what = format!("the annotation of the map `{shown}` fails the check of locations: {count}");
        let hint = format!(
            "correct the map's image at these points; or leave that floor out: `socrates map annotate {given} --within CORNERS`; or draw the scene graph: `socrates map edit {given}`"
        );
        Diagnostic { causes: faults.iter().map(cause).collect(), ..Diagnostic::input(what, hint) }
    })
}

/// What a location of a map file is called: its folder where the file is called `map`, else the file.
pub(crate) fn name(file: &Path) -> String {
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

#[cfg(test)]
mod tests {
    use super::*;

    /// The files of a shipped map with its own annotation, and the map file that they are said to be of.
    fn annotated_office() -> (BTreeMap<String, Vec<u8>>, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let shipped = socrates_maps::shipped::files("office").unwrap();
        for name in ["map.yaml", "map.png"] {
            std::fs::write(folder.path().join(name), &shipped[name]).unwrap();
        }
        let file = folder.path().join("map.yaml");
        (annotated(&file, &Options::default()).unwrap().files, file)
    }

    #[test]
    fn an_annotation_that_fails_the_check_is_refused_with_place_point_value_and_hint() {
        let (mut files, file) = annotated_office();
        assert!(checked(&file, &files, "office").is_ok());
        let doors = String::from_utf8(files["location.toml"].clone()).unwrap();
        // The first door ends 20 m away from where its wall is.
        let (before, from) = doors.split_once("from = [").unwrap();
        let (point, after) = from.split_once(']').unwrap();
        let x: f64 = point.split(',').next().unwrap().trim().parse().unwrap();
        let moved = format!("{before}from = [{:.3}, 0.0]{after}", x + 20.0);
        files.insert("location.toml".to_owned(), moved.into_bytes());

        let refused = checked(&file, &files, "office").unwrap_err();
        assert!(refused.what.contains("map.yaml` fails the check of locations: "), "{}", refused.what);
        let cause = &refused.causes[0];
        for part in ["location.toml", "door `", "the door line is ", " m long; allowed: 0.3 to 8 m", "(near x "] {
            assert!(cause.contains(part), "{part}: {cause}");
        }
        assert!(refused.hint.contains("socrates map edit") && refused.hint.contains("--within"), "{}", refused.hint);
        assert!(!format!("{} {} {}", refused.what, refused.causes.join(" "), refused.hint).contains("report"));
    }
}
