//! Tests that need what this repository does not hold: programs of others, and data that must not be handed on.
//!
//! Such a test asks here for what it needs. What is missing is written into the file that `SOCRATES_SKIPPED` names, one line
//! each (`NAME<tab>FILE:LINE<tab>WHY`), so that the gate can list it. With `SOCRATES_FOREIGN=1`, the gate's second ring, a
//! program that can be installed must be there, and a missing one fails the test.

use std::io::Write as _;
use std::panic::Location;
use std::path::{Path, PathBuf};

/// The variable of the second ring: `1` where what can be installed must be there.
const FOREIGN: &str = "SOCRATES_FOREIGN";
/// The variable that names the file of skipped tests.
const SKIPPED: &str = "SOCRATES_SKIPPED";
/// Data of others, from the root of the repository.
const SHARED: &str = "../shared/data";

/// Whether this is the second ring of the gate, in which programs of others are installed and must be there.
#[must_use]
pub fn second_ring() -> bool {
    std::env::var(FOREIGN).is_ok_and(|set| set == "1")
}

/// What a test needs and anybody can install: the thing, or none with the reason noted.
///
/// # Panics
/// In the second ring, when it is missing.
#[track_caller]
pub fn installed<T>(found: Result<T, String>) -> Option<T> {
    match found {
        Ok(found) => Some(found),
        Err(why) => {
            assert!(!second_ring(), "missing, and the second ring of the gate has to have it: {why}");
            note(&why);
            None
        }
    }
}

/// What a test needs and only some machines can have: the thing, or none with the reason noted.
#[track_caller]
pub fn elsewhere<T>(found: Result<T, String>) -> Option<T> {
    match found {
        Ok(found) => Some(found),
        Err(why) => {
            note(&why);
            None
        }
    }
}

/// A file or folder of the data that others made and that must not be handed on with this repository.
#[track_caller]
pub fn shared(path: &str) -> Option<PathBuf> {
    let place = crate::root().join(SHARED).join(path);
    elsewhere(if place.exists() { Ok(place) } else { Err(format!("data of others is not here: {SHARED}/{path}")) })
}

/// Installs something into a folder, one test at a time: tests of other processes wait for the lock beside the folder.
///
/// # Errors
/// The reason of `install`, or that the lock cannot be made.
pub fn alone<T>(folder: &Path, install: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    let path = folder.with_extension("lock");
    let lock = std::fs::File::create(&path).and_then(|file| file.lock().map(|()| file));
    let held = lock.map_err(|why| format!("{} cannot be locked: {why}", path.display()))?;
    let done = install();
    drop(held);
    done
}

/// A program in the search path.
#[must_use]
pub fn program(name: &str) -> Option<PathBuf> {
    let paths = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&paths).map(|dir| dir.join(name)).find(|program| program.is_file())
}

/// Says that the running test leaves something out, and why.
#[track_caller]
#[expect(clippy::print_stdout, reason = "whoever reads the output of the tests sees what was left out")]
fn note(why: &str) {
    let line = line(std::thread::current().name(), Location::caller(), why);
    println!("skipped: {}", line.replace('\t', ": "));
    let Some(file) = std::env::var_os(SKIPPED) else { return };
    let written = std::fs::OpenOptions::new()
        .create(true)
        .append(true)
        .open(&file)
        .and_then(|mut file| file.write_all(format!("{line}\n").as_bytes()));
    assert!(written.is_ok(), "`{}` cannot be written: {written:?}", file.display());
}

/// One line of the list: the running test, where it asks, and why it is left out.
fn line(test: Option<&str>, at: &Location<'_>, why: &str) -> String {
    let why: String = why.split_whitespace().collect::<Vec<_>>().join(" ");
    format!("{}\t{}:{}\t{why}", test.unwrap_or("a test"), at.file(), at.line())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_names_the_test_its_place_and_the_reason_once() {
        let at = Location::caller();
        let line = line(Some("rooms::a_door"), at, "there is\nno `chromium`\there");
        let parts: Vec<&str> = line.split('\t').collect();
        assert_eq!(parts.len(), 3, "{line}");
        assert_eq!((parts[0], parts[2]), ("rooms::a_door", "there is no `chromium` here"));
        assert!(parts[1].starts_with(at.file()) && parts[1].ends_with(&at.line().to_string()), "{line}");
    }

    /// Where a helper of a test that hands its caller on is written down.
    #[track_caller]
    fn here() -> String {
        line(None, Location::caller(), "")
    }

    #[test]
    fn a_place_is_where_the_test_asks() {
        assert!(here().contains(&format!("{}:{}", file!(), line!())), "{}", here());
    }

    #[test]
    fn what_is_there_is_handed_out() {
        assert_eq!(installed(Ok(3)), Some(3));
        assert_eq!(elsewhere(Ok(4)), Some(4));
        assert!(program("sh").is_some() && program("no-such-program").is_none());
    }
}
