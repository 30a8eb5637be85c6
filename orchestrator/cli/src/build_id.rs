//! The build id: a digest of the sources that the program is made of, the toolchain and its settings.
//!
//! The same sources, toolchain and settings give the same id, in a checkout as in an unpacked archive; one changed byte of a
//! source gives another. What only tests, benches and readers see does not count.

use std::io::Result;
use std::path::{Path, PathBuf};

/// Rooms and files at the root that the program is made of.
const PARTS: [&str; 8] = ["Cargo.lock", "Cargo.toml", "bus", "deploy", "maps", "orchestrator", "prompts", "workers"];
/// Folders and files of no meaning for the program.
const OTHERS: [&str; 6] = ["tests", "benches", "examples", "target", "README.md", "release.sh"];

/// Files that the program is made of, relative to the root, in order.
pub(crate) fn files(root: &Path) -> Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    let mut open: Vec<PathBuf> = PARTS.iter().map(PathBuf::from).collect();
    while let Some(path) = open.pop() {
        let whole = root.join(&path);
        if whole.is_dir() {
            for entry in std::fs::read_dir(&whole)? {
                let name = entry?.file_name();
                let text = name.to_string_lossy();
                if !text.starts_with('.') && !OTHERS.contains(&&*text) {
                    open.push(path.join(&name));
                }
            }
        } else {
            found.push(path);
        }
    }
    found.sort();
    Ok(found)
}

/// The id of these files under a root, made with these settings: 32 hexadecimal digits.
pub(crate) fn of(root: &Path, files: &[PathBuf], settings: &[String]) -> Result<String> {
    let mut hasher = blake3::Hasher::new();
    let mut part = |bytes: &[u8]| {
        // With its length before it, no part can pass for the end of another.
        hasher.update(&(bytes.len() as u64).to_le_bytes());
        hasher.update(bytes);
    };
    settings.iter().for_each(|setting| part(setting.as_bytes()));
    for file in files {
        let names: Vec<_> = file.iter().map(|name| name.to_string_lossy()).collect();
        part(names.join("/").as_bytes());
        part(&std::fs::read(root.join(file))?);
    }
    Ok(hasher.finalize().to_hex().chars().take(32).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tree with a file in each part, and some that do not count.
    fn tree() -> tempfile::TempDir {
        let root = tempfile::tempdir().unwrap();
        for part in PARTS {
            if part.contains('.') {
                std::fs::write(root.path().join(part), part).unwrap();
            } else {
                for file in ["src/lib.rs", "tests/one.rs", "README.md", ".hidden"] {
                    let path = root.path().join(part).join(file);
                    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
                    std::fs::write(path, file).unwrap();
                }
            }
        }
        root
    }

    fn id(root: &Path, settings: &[&str]) -> String {
        let settings: Vec<String> = settings.iter().map(ToString::to_string).collect();
        of(root, &files(root).unwrap(), &settings).unwrap()
    }

    #[test]
    fn the_same_sources_elsewhere_have_the_same_id() {
        let (one, other) = (tree(), tree());
        assert_eq!(id(one.path(), &["rustc 1.95"]), id(other.path(), &["rustc 1.95"]));
        assert_ne!(id(one.path(), &["rustc 1.95"]), id(one.path(), &["rustc 1.96"]));
        assert_eq!(files(one.path()).unwrap().len(), PARTS.len());
    }

    #[test]
    fn one_byte_one_name_and_one_file_more_give_another_id() {
        let root = tree();
        let before = id(root.path(), &[]);
        let file = root.path().join("bus/src/lib.rs");
        std::fs::write(&file, "src/lib.rt").unwrap();
        let changed = id(root.path(), &[]);
        std::fs::rename(&file, root.path().join("bus/src/lab.rs")).unwrap();
        let renamed = id(root.path(), &[]);
        std::fs::write(&file, "").unwrap();
        let more = id(root.path(), &[]);
        assert_eq!(std::collections::BTreeSet::from([&before, &changed, &renamed, &more]).len(), 4);
    }

    #[test]
    fn tests_and_words_for_readers_do_not_count() {
        let root = tree();
        let before = id(root.path(), &[]);
        for file in ["bus/tests/two.rs", "maps/README.md", "maps/.cache", "notes.txt"] {
            std::fs::write(root.path().join(file), "other").unwrap();
        }
        assert_eq!(id(root.path(), &[]), before);
    }

    #[test]
    fn this_program_has_an_id() {
        assert_eq!(crate::BUILD_ID.len(), 32);
        // That of these very sources, whatever else the settings are.
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let found = files(&root).unwrap();
        assert!(found.iter().any(|file| file.ends_with("cli/src/build_id.rs")) && found.len() > 300);
        assert!(found.iter().any(|file| file.ends_with("app/src/lib.rs")), "what the verbs do decides too");
    }
}
