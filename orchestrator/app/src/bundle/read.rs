//! A bundle read back: every file is parsed at this door, and what is wrong with one is named with its file and key.

use std::fmt::Display;
use std::path::Path;

use serde::de::DeserializeOwned;
use socrates_model::driver::Commands;
use socrates_model::{
    Behaviors, Digest, FORMAT, Fault, Location, Paths, Proposal, Reading, Report, Request, Run, ScenarioId,
};

use super::files::{Files, archive};
use super::{Bundle, Manifest, RunEntry};
use crate::exit::Diagnostic;
use crate::layout::{self, LOCATION, Sheet};

/// A file of a bundle that says of which format it is.
trait Versioned {
    fn format(&self) -> u32;
}

macro_rules! versioned {
    ($($file:ty),*) => {
        $(impl Versioned for $file {
            fn format(&self) -> u32 {
                self.format
            }
        })*
    };
}

versioned!(Behaviors, Commands, Location, Manifest, Paths, Proposal, Reading, Report);

/// What helps with a file that was changed or damaged.
const HINT: &str =
    "the file was changed by hand or is damaged: `socrates run BUNDLE/request.toml` makes the bundle again";

/// The manifest of a finished bundle; `None` where there is none that can be read.
pub(crate) fn manifest(dir: &Path) -> Option<Manifest> {
    serde_json::from_slice(&Files::manifest_at(dir).ok()?.read(layout::MANIFEST.path).ok()?).ok()
}

/// Whether a path is a finished bundle, a folder or packed, be its manifest good or damaged.
pub(crate) fn is_bundle(dir: &Path) -> bool {
    dir.join(layout::MANIFEST.path).exists() || archive(dir).is_some()
}

/// A file of a bundle by its name in [`layout`].
///
/// # Errors
/// Where it is not there, or cannot be read.
pub(crate) fn file(dir: &Path, name: &str) -> Result<Vec<u8>, Diagnostic> {
    bytes(&Files::at(dir)?, name)
}

/// Reads a finished bundle back, here or wherever it was moved to.
pub fn read(dir: &Path) -> Result<Bundle, Diagnostic> {
    read_some(dir, |_, _| true)
}

/// The same with some of its runs only, chosen by their place in the manifest and what it says of them.
pub(crate) fn read_some(dir: &Path, wanted: impl Fn(usize, &RunEntry) -> bool) -> Result<Bundle, Diagnostic> {
    read_files(dir, &Files::at(dir)?, wanted)
}

/// The same with the reports of all its runs; an archive is unpacked once.
pub(crate) fn read_with_reports(
    dir: &Path,
    wanted: impl Fn(usize, &RunEntry) -> bool,
) -> Result<(Bundle, Vec<Report>), Diagnostic> {
    let files = Files::at(dir)?;
    let bundle = read_files(dir, &files, wanted)?;
    let reports = reports_of(&files, &bundle.manifest)?;
    Ok((bundle, reports))
}

fn read_files(dir: &Path, files: &Files, wanted: impl Fn(usize, &RunEntry) -> bool) -> Result<Bundle, Diagnostic> {
    let manifest = finished(files)?;
    let request = request(files)?;
    let location: Location = part(files, &LOCATION, &"")?;
    let faults = socrates_model::fault::hard(&socrates_maps::check(&location));
    if !faults.is_empty() {
        return Err(unusable(files, LOCATION.path, &faults));
    }
    let mut runs = Vec::new();
    for (_, entry) in manifest.runs.iter().enumerate().filter(|(index, entry)| wanted(*index, entry)) {
        let name = layout::RECORDINGS.of(&entry.run());
        let recording = socrates_stream::mcap::read(&bytes(files, &name)?)
            .map_err(|why| Diagnostic::input(format!("`{}`: {why}", files.shown(&name)), HINT))?;
        runs.push((recording, report(files, entry)?));
    }
    Ok(Bundle {
        dir: dir.to_path_buf(),
        manifest,
        request,
        location,
        reading: part(files, &layout::READING, &"")?,
        proposal: part(files, &layout::PROPOSAL, &"")?,
        paths: part(files, &layout::PATHS, &"")?,
        behaviors: part(files, &layout::BEHAVIORS, &"")?,
        runs,
    })
}

/// The reports of all runs of a bundle, without their recordings.
pub(crate) fn reports(dir: &Path, manifest: &Manifest) -> Result<Vec<Report>, Diagnostic> {
    reports_of(&Files::at(dir)?, manifest)
}

fn reports_of(files: &Files, manifest: &Manifest) -> Result<Vec<Report>, Diagnostic> {
    manifest.runs.iter().map(|entry| report(files, entry)).collect()
}

/// Files of a bundle that are not as they were written, in order of their names; the page may be written anew.
pub fn changed(bundle: &Bundle) -> Vec<String> {
    // Of an archive that can no longer be read everything has changed.
    let there = Files::at(&bundle.dir).ok();
    let same = |name: &str, digest: &Digest| {
        there.as_ref().and_then(|files| files.read(name).ok()).is_some_and(|bytes| Digest::of(&bytes) == *digest)
    };
    let files =
        bundle.manifest.files.iter().filter(|(name, _)| layout::in_details(name) || *name == layout::REQUEST.path);
    files.filter(|(name, digest)| !same(name, digest)).map(|(name, _)| name.clone()).collect()
}

/// The manifest, or why this is no bundle.
pub(super) fn finished(files: &Files) -> Result<Manifest, Diagnostic> {
    let name = layout::MANIFEST.path;
    if files.read(name).is_err_and(|why| why.kind() == std::io::ErrorKind::NotFound) {
        return Err(Diagnostic::input(
            format!("`{}` is no finished bundle: `{name}` is missing", files.whole()),
            "`socrates run` makes one; the same command again finishes an unfinished one",
        ));
    }
    let manifest: Manifest = json(files, name)?;
    // A name with a slash would leave the bundle; the planners are names by their type.
    ScenarioId::new(&manifest.scenario).map_err(|bad| wrong(files, name, "scenario", &bad.to_string()))?;
    Ok(manifest)
}

fn request(files: &Files) -> Result<Request, Diagnostic> {
    let name = layout::REQUEST.path;
    let text = text(files, name)?;
    // Planners may have gone since; what a run needs of them is looked at when it is run again.
    Request::of_toml(&text, None).map_err(|problems| {
        let mut diagnostic = Diagnostic::input(format!("`{}` cannot be used", files.shown(name)), HINT);
        diagnostic.causes = problems.iter().map(|bad| bad.told(layout::REQUEST.path)).collect();
        diagnostic
    })
}

/// The commands of a driver outside in a run of a bundle.
pub(crate) fn commands(dir: &Path, run: &Run) -> Result<Commands, Diagnostic> {
    part(&Files::at(dir)?, &layout::COMMANDS, run)
}

fn report(files: &Files, entry: &RunEntry) -> Result<Report, Diagnostic> {
    part(files, &layout::REPORTS, &entry.run())
}

/// A part of the bundle: the one of this name, or the only one of its kind.
fn part<T: DeserializeOwned + Versioned>(files: &Files, sheet: &Sheet, name: &dyn Display) -> Result<T, Diagnostic> {
    json(files, &sheet.of(name))
}

fn bytes(files: &Files, name: &str) -> Result<Vec<u8>, Diagnostic> {
    files.read(name).map_err(|why| Diagnostic::input(format!("cannot read `{}`: {why}", files.shown(name)), HINT))
}

fn text(files: &Files, name: &str) -> Result<String, Diagnostic> {
    String::from_utf8(bytes(files, name)?)
        .map_err(|why| Diagnostic::input(format!("cannot read `{}`: {why}", files.shown(name)), HINT))
}

/// A JSON file of the format that this program reads, decoded; an error has the file, the key and, in the decoder's own words, the line.
fn json<T: DeserializeOwned + Versioned>(files: &Files, name: &str) -> Result<T, Diagnostic> {
    let text = text(files, name)?;
    let mut from = serde_json::Deserializer::from_str(&text);
    let value: T = serde_path_to_error::deserialize(&mut from)
        .map_err(|why| wrong(files, name, &why.path().to_string(), &why.inner().to_string()))?;
    from.end().map_err(|why| wrong(files, name, ".", &why.to_string()))?;
    let format = value.format();
    if format != FORMAT {
        return Err(wrong(files, name, "format", &format!("found {format}; this program reads {FORMAT}")));
    }
    Ok(value)
}

fn wrong(files: &Files, name: &str, key: &str, why: &str) -> Diagnostic {
    // `.` is the path of the whole file, and `.?` a place within a key that has no name yet.
    let key = key.trim_end_matches(".?");
    let at = if matches!(key, "." | "?") { String::new() } else { format!("`{key}`: ") };
    Diagnostic::input(format!("`{}`: {at}{why}", files.shown(name)), HINT)
}

fn unusable(files: &Files, name: &str, faults: &[Fault]) -> Diagnostic {
    Diagnostic::faults(format!("`{}` is not usable", files.shown(name)), faults, HINT)
}
