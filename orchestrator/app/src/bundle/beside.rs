//! A folder that appears whole: its files are written beside it, then it is moved where it belongs.

use std::path::{Path, PathBuf};

use super::files::{PACKED, pack, packed_at};
use crate::exit::Diagnostic;
use crate::layout;

/// Folder of the work folder in which bundles are written.
const WRITING: &str = "writing";

/// A folder in which files are written that do not count yet; it goes when this does.
#[derive(Debug)]
pub(super) struct Beside(pub(super) PathBuf);

impl Beside {
    /// An empty folder for the bundle of this name. What an earlier process left in it goes.
    pub(super) fn new(work: &Path, name: &str) -> Result<Self, Diagnostic> {
        let folder = work.join(WRITING).join(name);
        let cannot = |why: std::io::Error| cannot(&folder, &why);
        match std::fs::remove_dir_all(&folder) {
            Ok(()) => {}
            Err(why) if why.kind() == std::io::ErrorKind::NotFound => {}
            Err(why) => return Err(cannot(why)),
        }
        std::fs::create_dir_all(&folder).map_err(cannot)?;
        Ok(Self(folder))
    }

    /// Moves the folder to where it belongs, by one rename. Where a folder is there already, such as the one that holds the work
    /// folder of a single scenario, its entries are moved one by one, and the one that finishes a bundle last.
    pub(super) fn appear(&self, dir: &Path) -> Result<(), Diagnostic> {
        let cannot = |why: std::io::Error| cannot(dir, &why);
        if !dir.exists() {
            if let Some(parent) = dir.parent() {
                std::fs::create_dir_all(parent).map_err(cannot)?;
            }
            return std::fs::rename(&self.0, dir).map_err(cannot);
        }
        let last = dir.join(layout::DETAILS);
        if last.exists() {
            std::fs::remove_dir_all(&last).map_err(cannot)?;
        }
        let mut names = std::fs::read_dir(&self.0)
            .and_then(|entries| entries.map(|entry| Ok(entry?.file_name())).collect::<Result<Vec<_>, _>>())
            .map_err(cannot)?;
        names.sort_by_key(|name| (name == layout::DETAILS, name.clone()));
        names.iter().try_for_each(|name| std::fs::rename(self.0.join(name), dir.join(name))).map_err(cannot)
    }
}

impl Beside {
    /// Packs the folder into an archive beside where it would belong, by one rename.
    pub(super) fn appear_packed(&self, dir: &Path) -> Result<(), Diagnostic> {
        let name = dir.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let file = self.0.with_file_name(format!("{name}{PACKED}"));
        let cannot = |why: std::io::Error| cannot(&file, &why);
        // What an earlier process left there goes.
        match std::fs::remove_file(&file) {
            Ok(()) => {}
            Err(why) if why.kind() == std::io::ErrorKind::NotFound => {}
            Err(why) => return Err(cannot(why)),
        }
        pack(&self.0, &name, &file).map_err(cannot)?;
        std::fs::rename(&file, packed_at(dir)).map_err(cannot)
    }
}

/// Where it has appeared, nothing is left to be removed.
impl Drop for Beside {
    fn drop(&mut self) {
        drop(std::fs::remove_dir_all(&self.0));
    }
}

fn cannot(path: &Path, why: &std::io::Error) -> Diagnostic {
    Diagnostic::input(format!("cannot write `{}`: {why}", path.display()), "--out chooses another folder")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn files(dir: &Path) -> Vec<String> {
        let mut names: Vec<String> =
            std::fs::read_dir(dir).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    fn fill(beside: &Beside, text: &str) {
        std::fs::create_dir_all(beside.0.join(layout::DETAILS)).unwrap();
        std::fs::write(beside.0.join(layout::DETAILS).join("manifest.json"), text).unwrap();
        std::fs::write(beside.0.join("run.svg"), text).unwrap();
    }

    #[test]
    fn a_folder_is_there_whole_or_not_at_all() {
        let root = tempfile::tempdir().unwrap();
        let (work, dir) = (root.path().join(".socrates"), root.path().join("hall-1"));
        let beside = Beside::new(&work, "hall-1").unwrap();
        fill(&beside, "one");
        assert!(!dir.exists());
        // Killed here: nothing of it counts, and the next one begins with an empty folder.
        std::mem::forget(beside);
        let beside = Beside::new(&work, "hall-1").unwrap();
        assert!(files(&beside.0).is_empty());
        fill(&beside, "two");
        beside.appear(&dir).unwrap();
        drop(beside);
        assert_eq!(files(&dir), [layout::DETAILS, "run.svg"]);
        assert_eq!(std::fs::read_to_string(dir.join("run.svg")).unwrap(), "two");
        assert!(files(&work.join(WRITING)).is_empty());
    }

    #[test]
    fn what_else_lies_in_a_folder_stays() {
        let root = tempfile::tempdir().unwrap();
        let (dir, work) = (root.path().join("hall"), root.path().join("hall/.socrates"));
        std::fs::create_dir_all(dir.join(layout::DETAILS)).unwrap();
        std::fs::write(dir.join(layout::DETAILS).join("old.json"), "of an unfinished one").unwrap();
        std::fs::write(dir.join("notes.txt"), "mine").unwrap();
        let beside = Beside::new(&work, "hall").unwrap();
        fill(&beside, "one");
        beside.appear(&dir).unwrap();
        assert_eq!(files(&dir), [".socrates", layout::DETAILS, "notes.txt", "run.svg"]);
        assert_eq!(files(&dir.join(layout::DETAILS)), ["manifest.json"]);
    }
}
