//! The folder of what is made: the same again for the same wish, else the next free suffix. Its name is the scenario's name.

use std::path::{Path, PathBuf};

use socrates_model::{Digest, ScenarioEnd, ScenarioId};

use crate::exit::Diagnostic;
use crate::keep::Keep;
use crate::output::Printer;
use crate::{bundle, library_index};

/// Folder, inside that of the result, which only a resumed run needs.
pub const WORK: &str = ".socrates";
/// File in it that holds the digest of the wish.
const WISH: &str = "wish";
/// File in it that says which bundles a library keeps that is being made.
const KEEP: &str = "keep";
/// File in it that says how a scenario ended of which no bundle could be made.
const ENDED: &str = "ended";

/// Where something is made.
#[derive(Debug)]
pub(crate) enum Place {
    /// Here; perhaps a part of it is there already.
    New(PathBuf),
    /// Nowhere: it is there.
    Finished(PathBuf),
}

/// The folder for this wish. Where it is made `anew`, one that is finished already is left alone: a driver outside may have
/// changed since.
pub(crate) fn place(base: &Path, wish: Digest, anew: bool) -> Place {
    for number in 1.. {
        let dir = if number == 1 { base.to_path_buf() } else { PathBuf::from(format!("{}-{number}", base.display())) };
        let made = bundle::manifest(&dir)
            .map(|manifest| manifest.wish)
            .or_else(|| library_index::read(&dir).map(|library| library.wish));
        if let Some(made) = made {
            if made == wish && !anew {
                return Place::Finished(dir);
            }
            continue;
        }
        let started = std::fs::read_to_string(dir.join(WORK).join(WISH)).ok();
        if started.is_none_or(|text| text.trim() == wish.to_string()) || ended(&dir).is_some() {
            return Place::New(dir);
        }
    }
    Place::New(base.to_path_buf())
}

/// The folder, and a word where it is not the one that was named.
pub(crate) fn told(talk: &Printer, named: &Path, dir: PathBuf) -> PathBuf {
    if dir != named {
        talk.line(&format!(
            "folder     `{}` holds something else; this goes into `{}`",
            named.display(),
            dir.display()
        ));
        if library_index::read(named).is_some() {
            talk.line(&format!(
                "fixed      `{}` was made from other requests, seeds, variants, planners, author, `--shard` or `--repeats`, or by another \
                 version; these name a library",
                named.display()
            ));
        }
    }
    dir
}

/// Which bundles the library of this folder keeps, as it was fixed when it was begun; none where nothing was.
pub(crate) fn fixed(root: &Path) -> Option<Keep> {
    let begun = || std::fs::read_to_string(root.join(WORK).join(KEEP)).ok()?.trim().parse().ok();
    library_index::read(root).and_then(|library| library.keeps()).or_else(begun)
}

/// Fixes which bundles are kept in the library of this work folder.
pub(crate) fn fix(work: &Path, keep: Keep) -> Result<(), Diagnostic> {
    crate::files::write(&work.join(KEEP), keep.name().as_bytes())
}

/// Makes the work folder and marks it with the wish, so that the same command resumes it. What ended without a bundle is begun
/// anew.
pub(crate) fn claim(dir: &Path, wish: Digest) -> Result<PathBuf, Diagnostic> {
    let cannot = |why: std::io::Error| {
        Diagnostic::input(format!("cannot write into `{}`: {why}", dir.display()), "--out chooses another folder")
    };
    let work = dir.join(WORK);
    if ended(dir).is_some() {
        std::fs::remove_dir_all(&work).map_err(cannot)?;
    }
    std::fs::create_dir_all(&work).map_err(cannot)?;
    std::fs::write(work.join(WISH), wish.to_string()).map_err(cannot)?;
    Ok(work)
}

/// Marks a folder as one of which nothing more will come by itself.
pub(crate) fn end(dir: &Path, result: Option<ScenarioEnd>) {
    // Where it cannot be written, the folder counts as one to resume.
    let word = result.map_or("", ScenarioEnd::name);
    drop(std::fs::write(dir.join(WORK).join(ENDED), word));
}

/// How it ended without a bundle, if it did.
pub(crate) fn ended(dir: &Path) -> Option<String> {
    std::fs::read_to_string(dir.join(WORK).join(ENDED)).ok()
}

/// The scenario that lies in a folder: it is called like the folder, in letters that an id may have.
pub(crate) fn named_like(dir: &Path, otherwise: ScenarioId) -> ScenarioId {
    let fits = |c: char| c.is_ascii_alphanumeric() || matches!(c, '.' | '_' | '-');
    let name = dir.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let text: String = name.chars().map(|c| if fits(c) { c } else { '-' }).take(96).collect();
    if text.chars().any(|c| c.is_ascii_alphanumeric()) { ScenarioId::new(text).unwrap_or(otherwise) } else { otherwise }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scenario_is_called_like_its_folder() {
        let other = || ScenarioId::new("my-1").unwrap();
        for (dir, name) in [
            ("runs/my-1-2", "my-1-2"),
            ("out/Elevator.v2", "Elevator.v2"),
            ("mein Büro", "mein-B-ro"),
            ("走廊", "my-1"),
            ("..", "my-1"),
        ] {
            assert_eq!(named_like(Path::new(dir), other()).as_str(), name);
        }
    }

    #[test]
    fn what_is_kept_is_fixed_when_a_library_is_begun() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path();
        assert_eq!(fixed(root), None);
        fix(&claim(root, Digest::of(b"one")).unwrap(), Keep::Index).unwrap();
        assert_eq!(fixed(root), Some(Keep::Index));
        claim(root, Digest::of(b"one")).unwrap();
        assert_eq!(fixed(root), Some(Keep::Index), "the same again goes on with it");
    }

    #[test]
    fn a_folder_is_resumed_reused_or_left_alone() {
        let folder = tempfile::tempdir().unwrap();
        let base = folder.path().join("my-1");
        let (one, other) = (Digest::of(b"one"), Digest::of(b"other"));
        let new = |wish: Digest| match place(&base, wish, false) {
            Place::New(dir) => dir.file_name().unwrap().to_string_lossy().into_owned(),
            Place::Finished(dir) => panic!("{} is not finished", dir.display()),
        };
        assert_eq!(new(one), "my-1");
        let work = claim(&base, one).unwrap();
        std::fs::write(work.join("jobs.sqlite"), "of the first").unwrap();
        assert_eq!((new(one).as_str(), new(other).as_str()), ("my-1", "my-1-2"), "what is being made keeps its folder");
        claim(&base, one).unwrap();
        assert!(work.join("jobs.sqlite").is_file(), "the same again resumes");
        end(&base, Some(ScenarioEnd::Failed));
        assert_eq!((new(other).as_str(), ended(&base).as_deref()), ("my-1", Some("failed")));
        claim(&base, other).unwrap();
        assert!(!work.join("jobs.sqlite").exists() && ended(&base).is_none(), "what failed makes room");
    }
}
