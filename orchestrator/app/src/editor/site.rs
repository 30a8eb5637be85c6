//! What is edited: the map it is drawn on, the folder where it is kept, and what of that folder was there before.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use socrates_maps::{Draft, EXTRA, GRAPH, MAP};
use socrates_model::{Digest, Fault};

use crate::exit::{Code, Diagnostic};
use crate::raw_map;

/// Folder, inside that of the location, which only the editor needs.
pub(crate) const WORK: &str = ".socrates-edit";
/// Largest file that is read, bytes: an image of as many pixels as are read, in text.
const MAX_BYTES: u64 = 256 << 20;
/// The files that are drawn.
pub(crate) const DRAWN: [&str; 2] = [GRAPH, EXTRA];
/// A plan from which a location was made.
const PLAN: &str = "plan.toml";

/// The drawn files of a folder, as they are on the disk: none for one that is not there.
pub(crate) type Disk = BTreeMap<String, Option<Digest>>;

/// A location that is edited.
#[derive(Debug, Clone)]
pub(crate) struct Site {
    /// Where it is kept.
    pub(crate) folder: PathBuf,
    /// Name of the location.
    pub(crate) name: String,
    /// The map's file and image, by their names in the folder.
    pub(crate) map: BTreeMap<String, Vec<u8>>,
    /// The drawn files as they were read; without those that are not there.
    drawn: BTreeMap<String, Vec<u8>>,
    /// The drawn files of the folder itself: none of them where a copy is begun.
    pub(crate) disk: Disk,
    /// Whether the folder holds a plan that no longer makes what is drawn.
    pub(crate) has_plan: bool,
}

impl Site {
    /// The location that a name means: a shipped one, a folder, or a map file. A folder is edited where it is unless `out` names
    /// another; of the others a copy is edited, by default `<name>-edited`.
    ///
    /// # Errors
    /// A [`Diagnostic`] where there is no map, or the folder of the copy holds another one.
    pub(crate) fn of(given: &str, out: Option<&Path>) -> Result<Self, Diagnostic> {
        let path = Path::new(given);
        let (files, at, name) = match socrates_maps::shipped::files(given) {
            Some(files) => (files, None, given.to_owned()),
            None => {
                let file = raw_map::given(path).map_err(|why| unknown(given, path, why))?;
                let name = raw_map::name(&file);
                // A map file stands for its folder where that is a location, and for itself where it lies among others.
                let folder =
                    file.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."));
                let own =
                    path.is_dir() || (folder.join(GRAPH).exists() && file.file_name().is_some_and(|file| file == MAP));
                (of_folder(&file, folder, own)?, own.then(|| folder.to_path_buf()), name)
            }
        };
        let folder = match (out, at) {
            (Some(out), _) => out.to_path_buf(),
            (None, Some(at)) => at,
            (None, None) => PathBuf::from(format!("{name}-edited")),
        };
        let is_map = |file: &String| !DRAWN.contains(&file.as_str()) && file != PLAN;
        let (map, mut drawn): (BTreeMap<_, _>, BTreeMap<_, _>) = files.into_iter().partition(|(file, _)| is_map(file));
        let there = drawn_in(&folder)?;
        let has_map = folder.join(MAP).is_file();
        if has_map {
            same_map(&folder, &map)?;
        }
        let disk = digests(&there);
        // A copy that was begun is gone on with.
        drawn = if has_map || !there.is_empty() { there } else { drawn };
        drawn.remove(PLAN);
        let has_plan = folder.join(PLAN).is_file();
        Ok(Self { folder, name, map, drawn, disk, has_plan })
    }

    /// What the files hold.
    ///
    /// # Errors
    /// A [`Diagnostic`] with every fault, where a file cannot be read at all.
    pub(crate) fn draft(&self) -> Result<Draft, Diagnostic> {
        let mut files = self.map.clone();
        files.extend(self.drawn.clone());
        socrates_maps::draft(&files, &self.name).map_err(|faults| self.unusable(&faults))
    }

    /// What the folder holds now, read anew, and the digests of it.
    ///
    /// # Errors
    /// As [`Site::draft`].
    pub(crate) fn again(&self) -> Result<(Draft, Disk), Diagnostic> {
        let drawn = drawn_in(&self.folder)?;
        let disk = digests(&drawn);
        let now = Self { drawn, ..self.clone() };
        Ok((now.draft()?, disk))
    }

    /// Whether the folder holds what was read, or nothing was.
    pub(crate) fn is_saved(&self) -> bool {
        digests(&self.drawn) == self.disk
    }

    /// The digest of the map on which is drawn.
    pub(crate) fn map_digest(&self) -> Digest {
        let parts: Vec<String> =
            self.map.iter().map(|(name, bytes)| format!("{name} {}\n", Digest::of(bytes))).collect();
        Digest::of(parts.concat().as_bytes())
    }

    /// The digests of the drawn files on the disk now.
    ///
    /// # Errors
    /// A [`Diagnostic`] where one of them is there and cannot be read.
    pub(crate) fn disk_now(&self) -> Result<Disk, Diagnostic> {
        drawn_in(&self.folder).map(|drawn| digests(&drawn))
    }

    /// Says so where the map in the folder is no longer the one on which is drawn.
    ///
    /// # Errors
    /// A [`Diagnostic`] that names the file.
    pub(crate) fn check_map(&self) -> Result<(), Diagnostic> {
        if self.folder.join(MAP).exists() { same_map(&self.folder, &self.map) } else { Ok(()) }
    }

    /// Writes files whole or not at all, and those of the map that are not there yet. Gives the names of what was written.
    ///
    /// # Errors
    /// A [`Diagnostic`] that names the file.
    pub(crate) fn write(&self, files: &[(&'static str, String)]) -> Result<Vec<String>, Diagnostic> {
        let mut written = Vec::new();
        for (name, bytes) in self.map.iter().filter(|(name, _)| !self.folder.join(name).exists()) {
            put(&self.folder.join(name), bytes)?;
            written.push(name.clone());
        }
        for (name, text) in files {
            put(&self.folder.join(name), text.as_bytes())?;
            written.push((*name).to_owned());
        }
        Ok(written)
    }

    /// Keeps a copy of the drawn files that another program wrote, in the editor's own folder. Gives their paths.
    ///
    /// # Errors
    /// A [`Diagnostic`] that names the file.
    pub(crate) fn keep_theirs(&self, changed: &[String]) -> Result<Vec<String>, Diagnostic> {
        let mut kept = Vec::new();
        for (name, bytes) in drawn_in(&self.folder)?.iter().filter(|(name, _)| changed.contains(*name)) {
            let path = self.folder.join(WORK).join(format!("theirs-{}-{name}", Digest::of(bytes).short()));
            put(&path, bytes)?;
            kept.push(path.display().to_string());
        }
        Ok(kept)
    }

    fn unusable(&self, faults: &[Fault]) -> Diagnostic {
        Diagnostic::faults(
            format!("`{}` cannot be edited", self.folder.display()),
            faults,
            "mend the file by hand, or move it away: what is not there is drawn anew",
        )
    }
}

/// Files that differ between two looks at a folder.
pub(crate) fn differing(before: &Disk, now: &Disk) -> Vec<String> {
    DRAWN.iter().filter(|name| before.get(**name) != now.get(**name)).map(|name| (*name).to_owned()).collect()
}

fn digests(drawn: &BTreeMap<String, Vec<u8>>) -> Disk {
    DRAWN.iter().map(|name| ((*name).to_owned(), drawn.get(*name).map(|bytes| Digest::of(bytes)))).collect()
}

/// The files of a map file, and what is drawn beside it where its folder is a location.
fn of_folder(file: &Path, folder: &Path, own: bool) -> Result<BTreeMap<String, Vec<u8>>, Diagnostic> {
    let (_, mut files) = socrates_maps::load_raw(file).map_err(|faults| {
        let what = format!("the map `{}` is not usable", file.display());
        Diagnostic::faults(what, &faults, "`socrates explain CODE` says what to do")
    })?;
    if own {
        files.extend(drawn_in(folder)?);
    }
    Ok(files)
}

fn drawn_in(folder: &Path) -> Result<BTreeMap<String, Vec<u8>>, Diagnostic> {
    let there = DRAWN.iter().filter(|name| folder.join(name).exists());
    there.map(|name| Ok(((*name).to_owned(), read(&folder.join(name))?))).collect()
}

fn read(path: &Path) -> Result<Vec<u8>, Diagnostic> {
    crate::files::bytes(path, MAX_BYTES, "check the file")
}

/// Whether a folder holds these files of a map, byte for byte.
fn same_map(folder: &Path, map: &BTreeMap<String, Vec<u8>>) -> Result<(), Diagnostic> {
    for (name, bytes) in map {
        let path = folder.join(name);
        if path.exists() && read(&path)? != *bytes {
            let what = format!("`{}` is another map than the one that is drawn on", path.display());
            return Err(Diagnostic::input(
                what,
                "end the editor and begin it anew on that folder, or name another with `--out`",
            ));
        }
    }
    Ok(())
}

fn unknown(given: &str, path: &Path, why: Diagnostic) -> Diagnostic {
    if path.exists() {
        return why;
    }
    let hint = format!(
        "give a folder with a map (map.yaml and its image), a map file, or one of: {}",
        socrates_maps::shipped::names().join(", ")
    );
    Diagnostic::input(format!("there is no location `{given}`"), hint)
}

/// Writes a file beside its place, makes it durable, and puts it there in one step.
fn put(path: &Path, bytes: &[u8]) -> Result<(), Diagnostic> {
    let cannot = |why: std::io::Error| {
        let what = format!("cannot write `{}`: {why}", path.display());
        Diagnostic::input(what, "check the folder; what is drawn is in the journal").with_code(Code::Ours)
    };
    let folder = path.parent().unwrap_or_else(|| Path::new("."));
    std::fs::create_dir_all(folder).map_err(cannot)?;
    let mut beside = tempfile::Builder::new().prefix(".saving-").tempfile_in(folder).map_err(cannot)?;
    beside.write_all(bytes).and_then(|()| beside.as_file().sync_all()).map_err(cannot)?;
    // A file that is there keeps what its owner allows; a new one is like any other new file.
    let like = std::fs::metadata(path).map(|there| there.permissions());
    let like = like.unwrap_or_else(|_new| std::os::unix::fs::PermissionsExt::from_mode(NEW_FILE));
    beside.as_file().set_permissions(like).map_err(cannot)?;
    beside.persist(path).map_err(|why| cannot(why.error))?;
    File::open(folder).and_then(|folder| folder.sync_all()).map_err(cannot)
}

/// What a new file may be used for: read by everybody, written by its owner.
const NEW_FILE: u32 = 0o644;
