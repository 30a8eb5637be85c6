//! Bags of ROS 2: their folders and files, and what is told of those that are not read.

use std::fs::File;
use std::path::{Path, PathBuf};

use socrates_stream::ros::{self, Bag, BagFault, CONVERT};

use crate::exit::Diagnostic;
use crate::files;

/// What makes a folder a bag.
const METADATA: &str = "metadata.yaml";
/// Largest `metadata.yaml`, bytes: a bag of some thousand files has one of a megabyte.
const MOST_METADATA: u64 = 16 * 1024 * 1024;
/// Bytes by which a file is told from others.
const MAGIC_BYTES: usize = 64;

/// A file of recordings that is not read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Other {
    /// A bag of ROS 2 in the storage `sqlite3`.
    Sqlite,
    /// A bag of ROS 1.
    RosOne,
    /// A file that was compressed as a whole.
    Zstd,
}

impl Other {
    /// What is told of it.
    pub(super) fn refused(self, name: &str) -> Diagnostic {
        let (what, hint) = match self {
            Self::Sqlite => ("a bag of ROS 2 in the storage `sqlite3`; `mcap` is read", CONVERT.to_owned()),
            Self::RosOne => {
                let from = files::shell(Path::new(name));
                let convert = format!("`rosbags-convert --src {from} --dst BAG_mcap --dst-storage mcap`");
                ("a bag of ROS 1", format!("{convert} makes it one of ROS 2 that is read (`pip install rosbags`)"))
            }
            Self::Zstd => (
                "compressed as a whole",
                format!("`zstd -d {}` unpacks it; name the .mcap file that comes of it", files::shell(Path::new(name))),
            ),
        };
        Diagnostic::input(format!("`{name}` is {what}"), hint)
    }
}

/// Whether bytes begin as such a file does.
pub(super) fn other(bytes: &[u8]) -> Option<Other> {
    let magics: [(&[u8], Other); 3] =
        [(b"SQLite format 3\0", Other::Sqlite), (b"#ROSBAG V", Other::RosOne), (b"\x28\xb5\x2f\xfd", Other::Zstd)];
    magics.into_iter().find(|(magic, _)| bytes.starts_with(magic)).map(|(_, other)| other)
}

/// What is wrong with a bag.
pub(super) fn refused(name: &str, why: &BagFault) -> Diagnostic {
    Diagnostic::input(format!("`{name}`: {why}"), why.hint())
}

/// A bag of one file, by its bytes.
pub(super) fn of_bytes(name: &str, bytes: &[u8]) -> Result<Bag, Diagnostic> {
    let mut bag = Bag::new();
    bag.add(name, bytes).map_err(|why| refused(name, &why))?;
    Ok(bag)
}

/// The bag that a path names: a folder with `metadata.yaml`, or a file that begins as those of ROS 2's recorder do. Nothing for
/// what is no bag.
///
/// # Errors
/// A bag that is not read, and a folder of which the metadata is missing.
pub(super) fn at(path: &Path) -> Result<Option<Bag>, Diagnostic> {
    if path.is_dir() {
        return folder(path);
    }
    let mut begin = Vec::new();
    let cannot = |why: std::io::Error| unread(path, &why);
    let file = File::open(path).map_err(cannot)?;
    let _read =
        std::io::Read::read_to_end(&mut std::io::Read::take(&file, MAGIC_BYTES as u64), &mut begin).map_err(cannot)?;
    if !Bag::begins(&begin) {
        return Ok(None);
    }
    let mut bag = Bag::new();
    add(&mut bag, path)?;
    Ok(Some(bag))
}

/// The bytes of a file that is no bag.
///
/// # Errors
/// A file that cannot be read.
pub(super) fn bytes(path: &Path) -> Result<Vec<u8>, Diagnostic> {
    std::fs::read(path).map_err(|why| unread(path, &why))
}

fn unread(path: &Path, why: &std::io::Error) -> Diagnostic {
    Diagnostic::input(
        format!("cannot read `{}`: {why}", path.display()),
        "name a bundle folder, a CSV or an MCAP file, or a bag of ROS 2",
    )
}

fn add(bag: &mut Bag, path: &Path) -> Result<(), Diagnostic> {
    let name = path.display().to_string();
    let file = File::open(path).map_err(|why| unread(path, &why))?;
    bag.add(&name, std::io::BufReader::new(file)).map_err(|why| refused(&name, &why))
}

fn folder(path: &Path) -> Result<Option<Bag>, Diagnostic> {
    let metadata = path.join(METADATA);
    if !metadata.is_file() {
        return match recording(path) {
            Some(file) => Err(Diagnostic::input(
                format!("`{}` holds `{}` and no {METADATA}", path.display(), file.display()),
                format!("`ros2 bag reindex {}` writes it; one .mcap file can be named as well", files::shell(path)),
            )),
            None => Ok(None),
        };
    }
    let name = metadata.display().to_string();
    let text = files::text(&metadata, MOST_METADATA, "a bag of ROS 2 has one")?;
    let mut bag = Bag::new();
    for file in ros::files(&text).map_err(|why| refused(&name, &why))? {
        // The first versions wrote the name of the folder before that of the file.
        let beside = Path::new(&file).file_name().map(|file| path.join(file));
        let found = [Some(path.join(&file)), beside].into_iter().flatten().find(|path| path.is_file());
        let Some(found) = found else {
            return Err(Diagnostic::input(
                format!("`{name}` names the file `{file}`, which is not there"),
                format!(
                    "copy the whole folder of the bag, or write its metadata anew: `ros2 bag reindex {}`",
                    files::shell(path)
                ),
            ));
        };
        add(&mut bag, &found)?;
    }
    Ok(Some(bag))
}

/// A file of a bag in a folder that is none of ours.
fn recording(path: &Path) -> Option<PathBuf> {
    let mut names: Vec<PathBuf> = std::fs::read_dir(path).ok()?.filter_map(|entry| Some(entry.ok()?.path())).collect();
    names.sort();
    let is_bag = |file: &PathBuf| file.extension().is_some_and(|ending| ending == "mcap" || ending == "db3");
    names.into_iter().find(is_bag).and_then(|file| file.file_name().map(PathBuf::from))
}
