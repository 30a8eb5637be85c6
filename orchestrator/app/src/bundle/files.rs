//! The files of a bundle, from a folder or out of one archive.
//!
//! An archive `NAME.tar.zst` holds the folder `NAME`, so that any `tar` makes the folder of it again. The manifest is its first
//! file: what a library asks of most bundles is read without unpacking the rest.

use std::collections::BTreeMap;
use std::io::{Read as _, Write as _};
use std::path::{Component, Path, PathBuf};

use crate::exit::Diagnostic;
use crate::layout;

/// How the name of an archive ends.
pub(crate) const PACKED: &str = ".tar.zst";
/// How strongly is packed: the default of zstd, a hundred megabytes a second and core.
const LEVEL: i32 = 3;
/// Files of an archive, and bytes of all of them together, that are read at most: what unpacks to more is no bundle.
const MOST_FILES: usize = 100_000;
const MOST_BYTES: u64 = 4 << 30;
/// What helps with an archive that cannot be read.
const HINT: &str = "remove it and run the command that made it again";

/// The archive that is meant by the path of a bundle: itself, or the folder's name with the ending of archives where there is no folder.
pub(crate) fn archive(bundle: &Path) -> Option<PathBuf> {
    let name = bundle.file_name()?.to_string_lossy();
    if name.ends_with(PACKED) {
        return bundle.is_file().then(|| bundle.to_path_buf());
    }
    let file = bundle.with_file_name(format!("{name}{PACKED}"));
    (!bundle.exists() && file.is_file()).then_some(file)
}

/// The archive of a bundle that is called like this folder.
pub(super) fn packed_at(dir: &Path) -> PathBuf {
    let name = dir.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    dir.with_file_name(format!("{name}{PACKED}"))
}

/// Files of one bundle.
#[derive(Debug)]
pub(crate) enum Files {
    /// In this folder.
    Folder(PathBuf),
    /// Out of an archive.
    Packed {
        /// The archive.
        file: PathBuf,
        /// Its files by their names in the bundle.
        files: BTreeMap<String, Vec<u8>>,
    },
}

impl Files {
    /// Those of the bundle at a path, whichever form it has. A folder is not looked into, an archive is unpacked.
    pub(crate) fn at(bundle: &Path) -> Result<Self, Diagnostic> {
        match archive(bundle) {
            None => Ok(Self::Folder(bundle.to_path_buf())),
            Some(file) => {
                let files = unpacked(&file, |_| true)?;
                Ok(Self::Packed { file, files })
            }
        }
    }

    /// Those of which the manifest alone is wanted.
    pub(crate) fn manifest_at(bundle: &Path) -> Result<Self, Diagnostic> {
        match archive(bundle) {
            None => Ok(Self::Folder(bundle.to_path_buf())),
            Some(file) => {
                let files = unpacked(&file, |name| name != layout::MANIFEST.path)?;
                Ok(Self::Packed { file, files })
            }
        }
    }

    /// The bytes of a file.
    ///
    /// # Errors
    /// Where it is not there, or cannot be read.
    pub(crate) fn read(&self, name: &str) -> std::io::Result<Vec<u8>> {
        match self {
            Self::Folder(dir) => std::fs::read(dir.join(name)),
            Self::Packed { files, .. } => {
                files.get(name).cloned().ok_or_else(|| std::io::Error::from(std::io::ErrorKind::NotFound))
            }
        }
    }

    /// How the bundle is called in messages.
    pub(crate) fn whole(&self) -> String {
        match self {
            Self::Folder(dir) => dir.display().to_string(),
            Self::Packed { file, .. } => file.display().to_string(),
        }
    }

    /// How a file is called in messages.
    pub(crate) fn shown(&self, name: &str) -> String {
        match self {
            Self::Folder(dir) => dir.join(name).display().to_string(),
            Self::Packed { file, .. } => format!("{}: {name}", file.display()),
        }
    }
}

/// The first files of an archive, until one of which no further are wanted.
fn unpacked(file: &Path, further: impl Fn(&str) -> bool) -> Result<BTreeMap<String, Vec<u8>>, Diagnostic> {
    let bad = |why: String| Diagnostic::input(format!("`{}` is no packed bundle: {why}", file.display()), HINT);
    let opened = std::fs::File::open(file).map_err(|why| bad(why.to_string()))?;
    let plain = zstd::Decoder::new(opened).map_err(|why| bad(why.to_string()))?;
    let mut archive = tar::Archive::new(plain.take(MOST_BYTES));
    let mut files = BTreeMap::new();
    for entry in archive.entries().map_err(|why| bad(why.to_string()))? {
        let mut entry = entry.map_err(|why| bad(why.to_string()))?;
        if !entry.header().entry_type().is_file() {
            return Err(bad("it holds something that is no plain file".to_owned()));
        }
        let path = entry.path().map_err(|why| bad(why.to_string()))?.into_owned();
        let name = inside(&path).ok_or_else(|| bad(format!("`{}` is no path in it", path.display())))?;
        if files.len() == MOST_FILES {
            return Err(bad(format!("it holds more than {MOST_FILES} files")));
        }
        // Never as much room as the archive says there is: what comes decides.
        let mut bytes = Vec::new();
        entry.read_to_end(&mut bytes).map_err(|why| bad(why.to_string()))?;
        if bytes.len() as u64 != entry.size() {
            return Err(bad(format!("`{name}` ends early, or it unpacks to more than {MOST_BYTES} bytes")));
        }
        let go_on = further(&name);
        files.insert(name, bytes);
        if !go_on {
            return Ok(files);
        }
    }
    // The sum over all of it stands behind the last file.
    std::io::copy(&mut archive.into_inner(), &mut std::io::sink()).map_err(|why| bad(why.to_string()))?;
    Ok(files)
}

/// The name in the bundle of a path in an archive, without the folder that all of them share.
fn inside(path: &Path) -> Option<String> {
    let mut parts = path.components().map(|part| match part {
        Component::Normal(name) => name.to_str(),
        Component::Prefix(_) | Component::RootDir | Component::CurDir | Component::ParentDir => None,
    });
    parts.next()??;
    let rest: Vec<&str> = parts.collect::<Option<_>>()?;
    (!rest.is_empty()).then(|| rest.join("/"))
}

/// Packs a folder as a bundle of this name into a file that is not there yet. The same files give the same bytes.
pub(super) fn pack(folder: &Path, name: &str, file: &Path) -> std::io::Result<()> {
    let mut names = Vec::new();
    walk(folder, "", &mut names)?;
    names.sort_by_key(|name| (name != layout::MANIFEST.path, name.clone()));
    let mut encoder = zstd::Encoder::new(std::fs::File::create_new(file)?, LEVEL)?;
    encoder.include_checksum(true)?;
    let mut archive = tar::Builder::new(encoder);
    archive.mode(tar::HeaderMode::Deterministic);
    for path in &names {
        let bytes = std::fs::read(folder.join(path))?;
        let mut header = tar::Header::new_gnu();
        header.set_size(bytes.len() as u64);
        header.set_mode(0o644);
        header.set_mtime(0);
        archive.append_data(&mut header, format!("{name}/{path}"), bytes.as_slice())?;
    }
    let mut written = archive.into_inner()?.finish()?;
    written.flush()?;
    written.sync_all()
}

/// Every file below a folder, as a path from there.
fn walk(folder: &Path, before: &str, names: &mut Vec<String>) -> std::io::Result<()> {
    for entry in std::fs::read_dir(folder.join(before))? {
        let entry = entry?;
        let name = format!("{before}{}", entry.file_name().to_string_lossy());
        if entry.file_type()?.is_dir() {
            walk(folder, &format!("{name}/"), names)?;
        } else {
            names.push(name);
        }
    }
    Ok(())
}

/// Makes the folder of an archive, beside it, and hands back its path.
///
/// # Errors
/// An archive that cannot be read, or a folder that cannot be written.
pub(crate) fn unpack_beside(archive: &Path) -> Result<PathBuf, Diagnostic> {
    let name = archive.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let folder = archive.with_file_name(name.strip_suffix(PACKED).unwrap_or(&name));
    let cannot = |why: std::io::Error| {
        Diagnostic::input(
            format!("cannot write `{}`: {why}", folder.display()),
            "move the archive to a folder of yours",
        )
    };
    for (name, bytes) in unpacked(archive, |_| true)? {
        let path = folder.join(&name);
        if let Some(parent) = path.parent() {
            std::fs::create_dir_all(parent).map_err(cannot)?;
        }
        std::fs::write(&path, bytes).map_err(cannot)?;
    }
    Ok(folder)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(at: &Path) -> PathBuf {
        let folder = at.join("hall-1");
        for (name, text) in
            [("run.svg", "<svg/>"), (layout::MANIFEST.path, "{}"), ("details/recordings/a.mcap", "rec"), ("a.csv", "")]
        {
            let path = folder.join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        }
        folder
    }

    #[test]
    fn a_packed_folder_gives_its_files_back_and_the_same_bytes_twice() {
        let root = tempfile::tempdir().unwrap();
        let from = folder(root.path());
        let (one, two) = (root.path().join("packed.tar.zst"), root.path().join("again.tar.zst"));
        pack(&from, "hall-1", &one).unwrap();
        pack(&from, "hall-1", &two).unwrap();
        assert_eq!(std::fs::read(&one).unwrap(), std::fs::read(&two).unwrap());
        assert!(pack(&from, "hall-1", &two).is_err(), "what is there is not written over");
        std::fs::rename(&one, root.path().join("hall-2.tar.zst")).unwrap();
        // By the name of the folder, and by its own.
        for path in ["hall-2", "hall-2.tar.zst"] {
            let files = Files::at(&root.path().join(path)).unwrap();
            assert_eq!(files.read("details/recordings/a.mcap").unwrap(), b"rec");
            assert_eq!(files.read("a.csv").unwrap(), b"");
            assert!(files.read("b.csv").is_err());
            assert!(files.shown("a.csv").ends_with("hall-2.tar.zst: a.csv"));
        }
        let Files::Packed { files, .. } = Files::manifest_at(&root.path().join("hall-2")).unwrap() else { panic!() };
        assert_eq!(files.keys().collect::<Vec<_>>(), [layout::MANIFEST.path]);
        // Where there is a folder, the folder is meant.
        assert!(matches!(Files::at(&from).unwrap(), Files::Folder(_)));
        let unpacked = unpack_beside(&root.path().join("hall-2.tar.zst")).unwrap();
        assert_eq!(std::fs::read(unpacked.join("run.svg")).unwrap(), b"<svg/>");
    }

    #[test]
    fn an_archive_that_is_none_is_hostile_or_ends_early_is_named() {
        let root = tempfile::tempdir().unwrap();
        let from = folder(root.path());
        let whole = root.path().join("whole.tar.zst");
        pack(&from, "hall-1", &whole).unwrap();
        let bytes = std::fs::read(&whole).unwrap();
        let told = |name: &str, bytes: &[u8]| {
            let file = root.path().join(name);
            std::fs::write(&file, bytes).unwrap();
            let why = Files::at(&file).unwrap_err();
            assert!(why.what.contains(name), "{why}");
            why.what
        };
        told("nothing.tar.zst", b"");
        told("words.tar.zst", b"no archive at all");
        told("cut.tar.zst", &bytes[..bytes.len() / 2]);
        let mut changed = bytes.clone();
        let last = changed.len() - 2;
        changed[last] ^= 1;
        told("changed.tar.zst", &changed);
        // A path that leads out, and a link.
        let hostile = |path: &str, kind: tar::EntryType| {
            let mut archive = tar::Builder::new(Vec::new());
            let mut header = tar::Header::new_gnu();
            header.as_old_mut().name[..path.len()].copy_from_slice(path.as_bytes());
            header.set_size(1);
            header.set_mode(0o644);
            header.set_entry_type(kind);
            header.set_cksum();
            archive.append(&header, [1_u8].as_slice()).unwrap();
            zstd::encode_all(archive.into_inner().unwrap().as_slice(), 1).unwrap()
        };
        let out = told("out.tar.zst", &hostile("hall/../../etc/x", tar::EntryType::Regular));
        assert!(out.contains("no path in it"), "{out}");
        let link = told("link.tar.zst", &hostile("hall/x", tar::EntryType::Symlink));
        assert!(link.contains("no plain file"), "{link}");
    }
}
