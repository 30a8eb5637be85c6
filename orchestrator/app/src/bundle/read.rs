//! A bundle read back: every file is parsed at this door, and what is wrong with one is named with its file and key.

use std::fmt::Display;
use std::path::Path;

use serde::de::DeserializeOwned;
use socrates_model::driver::Commands;
use socrates_model::{Digest, Fault, Location, Report, Request, Run, ScenarioId};

use super::{Bundle, Manifest, RunEntry};
use crate::exit::Complaint;
use crate::layout::{self, LOCATION, Sheet};

/// What helps with a file that was changed or damaged.
const HINT: &str =
    "the file was changed by hand or is damaged: `socrates run BUNDLE/request.toml` makes the bundle again";

/// The manifest of a finished bundle; `None` for a folder without one that can be read.
pub(crate) fn manifest(dir: &Path) -> Option<Manifest> {
    serde_json::from_str(&std::fs::read_to_string(dir.join(layout::MANIFEST.path)).ok()?).ok()
}

/// Whether a folder is a finished bundle, be its manifest good or damaged.
pub(crate) fn is_bundle(dir: &Path) -> bool {
    dir.join(layout::MANIFEST.path).exists()
}

/// Reads a finished bundle back, here or wherever it was moved to.
pub(crate) fn read(dir: &Path) -> Result<Bundle, Complaint> {
    read_some(dir, |_, _| true)
}

/// The same with some of its runs only, chosen by their place in the manifest and what it says of them.
pub(crate) fn read_some(dir: &Path, wanted: impl Fn(usize, &RunEntry) -> bool) -> Result<Bundle, Complaint> {
    let manifest = finished(dir)?;
    let request = request(dir)?;
    let location: Location = part(dir, &LOCATION, &"")?;
    let faults = socrates_model::fault::hard(&socrates_maps::check(&location));
    if !faults.is_empty() {
        return Err(unusable(dir, LOCATION.path, &faults));
    }
    let mut runs = Vec::new();
    for (_, entry) in manifest.runs.iter().enumerate().filter(|(index, entry)| wanted(*index, entry)) {
        let path = dir.join(layout::RECORDINGS.of(&entry.run()));
        let bytes = std::fs::read(&path).map_err(|why| gone(&path, &why))?;
        let recording = socrates_stream::mcap::read(&bytes)
            .map_err(|why| Complaint::input(format!("`{}`: {why}", path.display()), HINT))?;
        runs.push((recording, report(dir, entry)?));
    }
    Ok(Bundle {
        dir: dir.to_path_buf(),
        manifest,
        request,
        location,
        reading: part(dir, &layout::READING, &"")?,
        proposal: part(dir, &layout::PROPOSAL, &"")?,
        paths: part(dir, &layout::PATHS, &"")?,
        behaviors: part(dir, &layout::BEHAVIORS, &"")?,
        runs,
    })
}

/// The reports of all runs of a bundle, without their recordings.
pub(crate) fn reports(dir: &Path, manifest: &Manifest) -> Result<Vec<Report>, Complaint> {
    manifest.runs.iter().map(|entry| report(dir, entry)).collect()
}

/// The same of the bundle in a folder.
pub(crate) fn reports_in(dir: &Path) -> Result<Vec<Report>, Complaint> {
    reports(dir, &finished(dir)?)
}

/// Files of a bundle that are not as they were written, in order of their names; the page may be written anew.
pub(crate) fn changed(bundle: &Bundle) -> Vec<String> {
    let same = |name: &str, digest: &Digest| {
        std::fs::read(bundle.dir.join(name)).is_ok_and(|bytes| Digest::of(&bytes) == *digest)
    };
    let files =
        bundle.manifest.files.iter().filter(|(name, _)| layout::in_details(name) || *name == layout::REQUEST.path);
    files.filter(|(name, digest)| !same(name, digest)).map(|(name, _)| name.clone()).collect()
}

/// The manifest, or why this is no bundle.
pub(super) fn finished(dir: &Path) -> Result<Manifest, Complaint> {
    let path = dir.join(layout::MANIFEST.path);
    if !path.exists() {
        return Err(Complaint::input(
            format!("`{}` is no finished bundle: `{}` is missing", dir.display(), layout::MANIFEST.path),
            "`socrates run` makes one; the same command again finishes an unfinished one",
        ));
    }
    let manifest: Manifest = json(&path)?;
    // A name with a slash would leave the bundle; the planners are names by their type.
    ScenarioId::new(&manifest.scenario).map_err(|bad| wrong(&path, "scenario", &bad.to_string()))?;
    Ok(manifest)
}

fn request(dir: &Path) -> Result<Request, Complaint> {
    let path = dir.join(layout::REQUEST.path);
    let text = std::fs::read_to_string(&path).map_err(|why| gone(&path, &why))?;
    // Planners may have gone since; what a run needs of them is looked at when it is run again.
    Request::of_toml(&text, None).map_err(|problems| {
        let mut complaint = Complaint::input(format!("`{}` cannot be used", path.display()), HINT);
        complaint.causes = problems.iter().map(|bad| bad.told(layout::REQUEST.path)).collect();
        complaint
    })
}

/// The commands of a driver outside in a run of a bundle.
pub(crate) fn commands(dir: &Path, run: &Run) -> Result<Commands, Complaint> {
    part(dir, &layout::COMMANDS, run)
}

fn report(dir: &Path, entry: &RunEntry) -> Result<Report, Complaint> {
    part(dir, &layout::REPORTS, &entry.run())
}

/// A part of the bundle: the one of this name, or the only one of its kind.
fn part<T: DeserializeOwned>(dir: &Path, sheet: &Sheet, name: &dyn Display) -> Result<T, Complaint> {
    json(&dir.join(sheet.of(name)))
}

/// A JSON file, decoded; an error has the file, the key and, in the decoder's own words, the line.
fn json<T: DeserializeOwned>(path: &Path) -> Result<T, Complaint> {
    let text = std::fs::read_to_string(path).map_err(|why| gone(path, &why))?;
    let mut from = serde_json::Deserializer::from_str(&text);
    let value = serde_path_to_error::deserialize(&mut from)
        .map_err(|why| wrong(path, &why.path().to_string(), &why.inner().to_string()))?;
    from.end().map_err(|why| wrong(path, ".", &why.to_string()))?;
    Ok(value)
}

fn wrong(path: &Path, key: &str, why: &str) -> Complaint {
    // `.` is the path of the whole file, and `.?` a place within a key that has no name yet.
    let key = key.trim_end_matches(".?");
    let at = if matches!(key, "." | "?") { String::new() } else { format!("`{key}`: ") };
    Complaint::input(format!("`{}`: {at}{why}", path.display()), HINT)
}

fn gone(path: &Path, why: &std::io::Error) -> Complaint {
    Complaint::input(format!("cannot read `{}`: {why}", path.display()), HINT)
}

fn unusable(dir: &Path, name: &str, faults: &[Fault]) -> Complaint {
    Complaint::faults(format!("`{}` is not usable", dir.join(name).display()), faults, HINT)
}
