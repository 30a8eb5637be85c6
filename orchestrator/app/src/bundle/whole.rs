//! Bundles as files: whether each is as it was written, and a copy that is there whole or not at all.

use std::path::Path;

use socrates_model::Digest;

use super::beside::Beside;
use super::files::{Files, PACKED, archive, packed_at};
use super::read::finished;
use crate::exit::Diagnostic;

/// Folders within a bundle, at most.
const DEPTH: usize = 8;
/// Damaged files that are named.
const NAMED: usize = 3;

/// Files of a finished bundle that are gone or not as they were written, in order of their names.
pub(crate) fn damaged(dir: &Path) -> Result<Vec<String>, Diagnostic> {
    let files = Files::at(dir)?;
    let manifest = finished(&files)?;
    let same = |(name, digest): &(&String, &Digest)| files.read(name).is_ok_and(|bytes| Digest::of(&bytes) == **digest);
    Ok(manifest.files.iter().filter(|file| !same(file)).map(|(name, _)| name.clone()).collect())
}

/// Says which files of a bundle are damaged, if any are.
pub(crate) fn whole(dir: &Path) -> Result<(), Diagnostic> {
    let damaged = damaged(dir)?;
    if damaged.is_empty() {
        return Ok(());
    }
    let named: Vec<String> = damaged.iter().take(NAMED).map(|name| format!("`{name}`")).collect();
    let more = if damaged.len() > NAMED { format!(" and {} more", damaged.len() - NAMED) } else { String::new() };
    Err(Diagnostic::input(
        format!("the bundle `{}` is damaged: {}{more} not as written", dir.display(), named.join(", ")),
        "remove it and run the command that made it again",
    ))
}

/// Copies a bundle in the form that it has, checked on both sides. `to`: the folder that it is called like; `work`: the work folder of
/// the library, on the same file system.
pub(crate) fn copy(from: &Path, to: &Path, work: &Path) -> Result<(), Diagnostic> {
    let name = to.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let cannot = |why: std::io::Error| {
        Diagnostic::input(format!("cannot copy `{}`: {why}", from.display()), "--out chooses another folder")
    };
    whole(from)?;
    let beside = Beside::new(work, &name)?;
    if let Some(packed) = archive(from) {
        let copied = beside.0.join(format!("{name}{PACKED}"));
        std::fs::copy(&packed, &copied).map_err(cannot)?;
        whole(&copied)?;
        return std::fs::rename(&copied, packed_at(to)).map_err(cannot);
    }
    tree(from, &beside.0, DEPTH).map_err(cannot)?;
    whole(&beside.0)?;
    beside.appear(to)
}

/// Moves a bundle in the form that it has, where both lie on one file system; says whether it did.
pub(crate) fn moved(from: &Path, to: &Path) -> bool {
    match archive(from) {
        Some(packed) => std::fs::rename(packed, packed_at(to)).is_ok(),
        None => std::fs::rename(from, to).is_ok(),
    }
}

/// Copies what is left of a scenario that could not be made; none where nothing is. `from`, `to`: its folders in the shard and in the library.
pub(crate) fn copy_dead(from: &Path, to: &Path, work: &Path) -> Result<(), Diagnostic> {
    if !from.is_dir() || to.exists() {
        return Ok(());
    }
    let name = to.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let beside = Beside::new(work, &format!("dead-{name}"))?;
    tree(from, &beside.0, DEPTH).map_err(|why| {
        Diagnostic::input(format!("cannot copy `{}`: {why}", from.display()), "--out chooses another folder")
    })?;
    beside.appear(to)
}

/// Copies files and folders; what is neither is left out.
fn tree(from: &Path, to: &Path, depth: usize) -> std::io::Result<()> {
    std::fs::create_dir_all(to)?;
    for entry in std::fs::read_dir(from)? {
        let entry = entry?;
        let kind = entry.file_type()?;
        if kind.is_file() {
            std::fs::copy(entry.path(), to.join(entry.file_name()))?;
        } else if let (true, Some(left)) = (kind.is_dir(), depth.checked_sub(1)) {
            tree(&entry.path(), &to.join(entry.file_name()), left)?;
        }
    }
    Ok(())
}
