//! Folders that belong to this user alone: the work folder of a making, and the one of its socket.

use std::fs::{File, Permissions};
use std::io::{Seek as _, Write as _};
use std::os::unix::fs::{DirBuilderExt as _, MetadataExt as _, OpenOptionsExt as _, PermissionsExt as _};
use std::path::{Path, PathBuf};

use tempfile::TempDir;

use crate::exit::{Code, Diagnostic};

/// What a folder for its owner alone may be used for: everything by its owner, nothing by others.
const OWNER: u32 = 0o700;
/// The same of a file.
const OWNER_FILE: u32 = 0o600;
/// File in the work folder that the maker holds a lock on; it holds its process id.
const HOLD_FILE: &str = "making.lock";
/// Begin of the name of every socket's folder.
const SOCKETS: &str = "socrates-";
/// Longest path of a socket that every system takes, bytes; the bus puts `.lock` behind it for a moment.
const LONGEST_SOCKET: usize = 98;

/// File systems that several machines see at once, by the number that the system has for each: what one writes, another may see late or
/// torn, and locks may hold on one machine alone.
const SHARED: [(i64, &str); 9] = [
    (0x6969, "NFS"),
    (0x0BD0_0BD0, "Lustre"),
    (0xFF53_4D42, "CIFS"),
    (0xFE53_4D42, "SMB"),
    (0x4750_4653, "GPFS"),
    (0x1983_0326, "BeeGFS"),
    (0x00C3_6400, "Ceph"),
    (0x5346_414F, "AFS"),
    (0x0102_1997, "9p"),
];

/// Makes the folder of a store that must survive, and refuses one that other machines see as well.
pub(crate) fn of_one_machine(dir: &Path) -> Result<(), Diagnostic> {
    let shown = dir.display();
    let cannot = |why: std::io::Error| {
        Diagnostic::input(format!("cannot write into `{shown}`: {why}"), "--dir chooses another folder")
    };
    // What it holds is its owner's: requests, answers of models, artifacts.
    std::fs::DirBuilder::new().recursive(true).mode(OWNER).create(dir).map_err(cannot)?;
    let kind = rustix::fs::statfs(dir).map_err(|why| cannot(why.into()))?.f_type;
    shared(kind).map_or(Ok(()), |name| {
        Err(Diagnostic::input(
            format!("`{shown}` lies on {name}, which several machines see: the store of jobs would be lost there sooner or later"),
            "--dir names a folder on a disk of this machine, such as /var/lib/socrates; artifacts and bundles are fetched with \
             `socrates cluster collect`, which may write onto a shared folder",
        ))
    })
}

/// Name of a file system that several machines see.
fn shared(kind: i64) -> Option<&'static str> {
    SHARED.iter().find(|(number, _)| *number == kind).map(|(_, name)| *name)
}

/// A work folder that this process alone makes something in, as long as this lives.
#[derive(Debug)]
pub(crate) struct Hold {
    path: PathBuf,
    file: File,
}

/// What a folder is held for, in the words of those who are refused.
#[derive(Debug, Clone, Copy)]
pub(crate) struct HoldFor {
    /// What is done with it: `being made`.
    pub(crate) doing: &'static str,
    /// What helps where somebody else does it.
    pub(crate) instead: &'static str,
    /// What helps where nothing can be written.
    pub(crate) elsewhere: &'static str,
}

/// A run or a library is made in it.
const MAKING: HoldFor = HoldFor {
    doing: "being made",
    instead: "wait for it or end it, or choose another folder with --out",
    elsewhere: "--out chooses another folder",
};

impl Hold {
    /// Takes a work folder, made where needed, and closes it to other users.
    pub(crate) fn take(work: &Path) -> Result<Self, Diagnostic> {
        Self::take_for(work, MAKING)
    }

    /// The same for something else than making a run.
    pub(crate) fn take_for(work: &Path, what: HoldFor) -> Result<Self, Diagnostic> {
        let made = work.parent().unwrap_or(work).display();
        let cannot =
            |why: std::io::Error| Diagnostic::input(format!("cannot write into `{made}`: {why}"), what.elsewhere);
        std::fs::create_dir_all(work).map_err(cannot)?;
        std::fs::set_permissions(work, Permissions::from_mode(OWNER)).map_err(cannot)?;
        let path = work.join(HOLD_FILE);
        let mut file = File::options().create(true).truncate(false).write(true).open(&path).map_err(cannot)?;
        match file.try_lock() {
            Ok(()) => {}
            Err(std::fs::TryLockError::WouldBlock) => {
                let holder = std::fs::read_to_string(&path).unwrap_or_default();
                let told = format!("`{made}` is {} by process {}", what.doing, holder.trim());
                return Err(Diagnostic::input(told, what.instead));
            }
            Err(std::fs::TryLockError::Error(why)) => return Err(cannot(why)),
        }
        file.set_len(0).and_then(|()| writeln!(file, "{}", std::process::id())).map_err(cannot)?;
        Ok(Self { path, file })
    }

    /// Says more about the holder to those who are refused, behind its process id.
    pub(crate) fn tell(&mut self, more: &str) -> std::io::Result<()> {
        self.file.seek(std::io::SeekFrom::Start(0))?;
        writeln!(self.file, "{}{more}", std::process::id())
    }

    /// Says so when the folder was taken away under its maker.
    pub(crate) fn check(&self) -> Result<(), Diagnostic> {
        let same = |there: std::fs::Metadata| {
            self.file.metadata().is_ok_and(|held| (held.dev(), held.ino()) == (there.dev(), there.ino()))
        };
        if std::fs::metadata(&self.path).is_ok_and(same) {
            return Ok(());
        }
        let folder = self.path.parent().unwrap_or(&self.path).display().to_string();
        Err(Diagnostic::input(
            format!("the folder `{folder}` was removed while it was worked in, so the run ends"),
            "the same command begins anew",
        )
        .with_code(Code::Ours))
    }
}

/// A folder for the socket of a run: nobody else can enter it, and its path is short enough for a socket.
pub(crate) fn socket_folder(work: &Path, temp: &Path) -> Result<TempDir, Diagnostic> {
    let places = [temp.to_path_buf(), PathBuf::from("/tmp"), work.to_path_buf()];
    let mut last = String::new();
    for place in places {
        let made =
            tempfile::Builder::new().prefix(SOCKETS).permissions(Permissions::from_mode(OWNER)).tempdir_in(&place);
        match made {
            Ok(folder) if socket(folder.path()).as_os_str().len() <= LONGEST_SOCKET => return Ok(folder),
            Ok(folder) => last = format!("`{}` is too long for a socket", folder.path().display()),
            Err(why) => last = format!("`{}`: {why}", place.display()),
        }
    }
    Err(Diagnostic::input(
        format!("there is no folder for the socket of the run: {last}"),
        "TMPDIR names a folder that can be written and has a short path",
    ))
}

/// The socket in its folder.
pub(crate) fn socket(folder: &Path) -> PathBuf {
    folder.join("bus")
}

/// Removes the folder of a socket whose maker was killed.
pub(crate) fn remove_socket_folder(socket: &Path) {
    let folder = socket.parent().filter(|folder| {
        let name = folder.file_name().unwrap_or_default().to_string_lossy();
        name.starts_with(SOCKETS) && folder.is_dir()
    });
    if let Some(folder) = folder {
        // Whoever cannot remove it leaves an empty folder behind, no more.
        drop(std::fs::remove_dir_all(folder));
    }
}

/// Writes a file that nobody else can read.
pub(crate) fn write_private(path: &Path, text: &str) -> std::io::Result<()> {
    let mut file = File::options().create(true).write(true).truncate(true).mode(OWNER_FILE).open(path)?;
    // A file that was there keeps its mode otherwise.
    file.set_permissions(Permissions::from_mode(OWNER_FILE))?;
    file.write_all(text.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_has_one_maker_and_the_second_hears_who_it_is() {
        let folder = tempfile::tempdir().unwrap();
        let work = folder.path().join("two").join(".socrates");
        let hold = Hold::take(&work).unwrap();
        let why = Hold::take(&work).unwrap_err();
        assert_eq!(why.code, Code::Input);
        assert!(why.what.ends_with(&format!("two` is being made by process {}", std::process::id())), "{why}");
        assert_eq!(std::fs::metadata(&work).unwrap().mode() & 0o777, OWNER);
        hold.check().unwrap();
        std::fs::remove_dir_all(&work).unwrap();
        assert_eq!(hold.check().unwrap_err().code, Code::Ours);
        // A folder of the same name is another one.
        std::fs::create_dir_all(&work).unwrap();
        std::fs::write(work.join(HOLD_FILE), "").unwrap();
        hold.check().unwrap_err();
        drop(hold);
        Hold::take(&work).unwrap();
    }

    #[test]
    fn a_store_is_kept_off_file_systems_that_other_machines_see() {
        assert_eq!((shared(0x6969), shared(0x0BD0_0BD0)), (Some("NFS"), Some("Lustre")));
        // ext4, xfs, btrfs, tmpfs, overlayfs, zfs.
        for own in [0xEF53, 0x5846_5342, 0x9123_683E, 0x0102_1994, 0x794C_7630, 0x2FC1_2FC1] {
            assert_eq!(shared(own), None, "{own:#x}");
        }
        let folder = tempfile::tempdir().unwrap();
        let store = folder.path().join("new/store");
        of_one_machine(&store).unwrap();
        assert_eq!(std::fs::metadata(&store).unwrap().mode() & 0o777, OWNER, "jobs are their owner's alone");
        let file = folder.path().join("file");
        std::fs::write(&file, "").unwrap();
        assert!(of_one_machine(&file.join("store")).unwrap_err().what.contains("file/store"));
    }

    #[test]
    fn the_folder_of_a_socket_is_short_and_closed_even_where_the_work_folder_is_deep() {
        let folder = tempfile::tempdir().unwrap();
        let deep = folder.path().join("a".repeat(120));
        std::fs::create_dir_all(&deep).unwrap();
        let made = socket_folder(&deep, &std::env::temp_dir()).unwrap();
        assert!(socket(made.path()).as_os_str().len() <= LONGEST_SOCKET);
        assert_eq!(std::fs::metadata(made.path()).unwrap().mode() & 0o777, OWNER);
        let kept = made.keep();
        remove_socket_folder(&socket(&kept));
        assert!(!kept.exists());
        remove_socket_folder(&folder.path().join("x"));
        assert!(folder.path().exists(), "only folders of sockets are removed");
    }
}
