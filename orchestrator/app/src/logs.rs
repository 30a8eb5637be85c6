//! Logs that are kept: a file for each process, a JSON object a line, bounded in size, without secrets.
//!
//! ```text
//! DIR/logs/orchestrator.jsonl   proposal.jsonl   simulation-1.jsonl …     and NAME.1.jsonl, which a full one became
//! ```
//!
//! Lines are made where the program starts (`orchestrator/cli`); here is where they go, and what is struck out of them.

use std::fs::File;
use std::io::Write as _;
use std::os::unix::fs::{DirBuilderExt as _, OpenOptionsExt as _};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use jiff::Timestamp;
use serde_json::Value;
use socrates_llm::{ApiKey, strike_shapes};

use crate::config::Config;

/// Folder of the logs, in that of what is made.
pub(crate) const FOLDER: &str = "logs";
/// End of the name of a log.
const END: &str = ".jsonl";
/// Files for their owner alone: they name requests and machines.
const OWNER: u32 = 0o700;
const OWNER_FILE: u32 = 0o600;
/// Bytes of a mebibyte.
const MIB: u64 = 1 << 20;
/// Longest text of a field, characters: a line stays one.
const TEXT_CHARS: usize = 2_000;

/// The log of this process; none before it is known where it goes, and where none is kept.
static KEPT: Mutex<Option<Kept>> = Mutex::new(None);
/// What is struck out of every line of this process.
static SECRETS: Mutex<Vec<ApiKey>> = Mutex::new(Vec::new());

/// A file with a limit: one that is full becomes the earlier one, in place of the one before.
#[derive(Debug)]
struct Kept {
    path: PathBuf,
    file: File,
    len: u64,
    most: u64,
}

impl Kept {
    fn open(path: &Path, most: u64) -> std::io::Result<Self> {
        if let Some(folder) = path.parent() {
            std::fs::DirBuilder::new().recursive(true).mode(OWNER).create(folder)?;
        }
        let file = File::options().create(true).append(true).mode(OWNER_FILE).open(path)?;
        let len = file.metadata()?.len();
        Ok(Self { path: path.to_path_buf(), file, len, most })
    }

    fn write(&mut self, line: &str) -> std::io::Result<()> {
        let len = u64::try_from(line.len()).unwrap_or(u64::MAX);
        if self.len > 0 && self.len.saturating_add(len) > self.most {
            std::fs::rename(&self.path, earlier(&self.path))?;
            *self = Self::open(&self.path, self.most)?;
        }
        self.file.write_all(line.as_bytes())?;
        self.len = self.len.saturating_add(len);
        Ok(())
    }
}

/// The file that a full log becomes: `simulation-1.1.jsonl` of `simulation-1.jsonl`.
fn earlier(path: &Path) -> PathBuf {
    path.with_extension(format!("1{END}"))
}

/// The log of a process in the folder of what is made.
pub(crate) fn file(dir: &Path, process: &str) -> PathBuf {
    dir.join(FOLDER).join(format!("{process}{END}"))
}

/// Keeps the log of this process in a file from now on, where the configuration keeps logs. What cannot be kept is said once; it is
/// no reason not to work.
pub(crate) fn keep(config: &Config, path: &Path) {
    if config.text("log.keep") == "off" {
        return;
    }
    let most = config.number("log.keep_mib").max(1).saturating_mul(MIB);
    match Kept::open(path, most) {
        Ok(kept) => *KEPT.lock().unwrap_or_else(PoisonError::into_inner) = Some(kept),
        Err(why) => tracing::warn!(file = %path.display(), %why, "the log of this process cannot be kept"),
    }
}

/// Whether a log of this process is kept.
pub fn is_kept() -> bool {
    KEPT.lock().unwrap_or_else(PoisonError::into_inner).is_some()
}

/// Writes a line, which ends with a line feed. A full disk loses it: nothing else may fail for a log.
pub fn write(line: &str) {
    if let Some(kept) = &mut *KEPT.lock().unwrap_or_else(PoisonError::into_inner) {
        drop(kept.write(line));
    }
}

/// Name of the process whose log is kept, such as `simulation-1`.
pub fn process() -> Option<String> {
    let kept = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
    kept.as_ref().and_then(|kept| Some(kept.path.file_stem()?.to_string_lossy().into_owned()))
}

/// Remembers the keys of authors' servers, so that no line has them.
pub fn strike_keys_of(config: &Config) {
    *SECRETS.lock().unwrap_or_else(PoisonError::into_inner) = crate::authors::secrets(config);
}

/// The wall time now, ms since 1970: shown, never decides.
pub fn now_ms() -> u64 {
    socrates_link::wall_ms()
}

/// The text as a line may have it: without the keys of this process and without what has the shape of one, and not too long.
pub fn struck(text: &str) -> String {
    let own = SECRETS.lock().unwrap_or_else(PoisonError::into_inner);
    let text = own.iter().fold(text.to_owned(), |text, key| key.strike_from(&text));
    drop(own);
    let text = strike_shapes(&text);
    match text.char_indices().nth(TEXT_CHARS) {
        Some((at, _)) => format!("{}…", text.split_at(at).0),
        None => text,
    }
}

/// A wall time, ms since 1970, as RFC 3339 in UTC: `2026-11-26T22:45:01.123Z`. A time after the year 9999 is told as the last before.
pub fn stamp(ms: u64) -> String {
    let at = i64::try_from(ms).ok().and_then(|ms| Timestamp::from_millisecond(ms).ok());
    format!("{:.3}", at.unwrap_or(Timestamp::MAX))
}

/// A line of a log that is of a trace.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Line {
    /// When, as [`stamp`] writes it: sorted by it, lines are in the order of time of the machines' clocks.
    pub(crate) at: String,
    /// The time of day in it, for people.
    pub(crate) clock: String,
    /// Which process, such as `orchestrator`.
    pub(crate) process: String,
    /// All of it.
    pub(crate) object: Value,
}

/// Lines of the logs of a folder that are of a trace, in order of time; none where there are no logs. A line that is torn is passed over.
pub(crate) fn of_trace(dir: &Path, trace_id: &str) -> Vec<Line> {
    let Ok(entries) = std::fs::read_dir(dir) else { return Vec::new() };
    let mut files: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    files.retain(|file| file.to_string_lossy().ends_with(END));
    // The earlier of two files first: lines of one millisecond stay in their order.
    files.sort_by_key(|file| (!file.to_string_lossy().ends_with(&format!(".1{END}")), file.clone()));
    let mut lines = Vec::new();
    for file in files {
        let Ok(text) = std::fs::read_to_string(&file) else { continue };
        let own = text.lines().filter(|line| line.contains(trace_id));
        lines.extend(own.filter_map(|line| {
            let object: Value = serde_json::from_str(line).ok()?;
            let word = |name: &str| object.get(name).and_then(Value::as_str).map(str::to_owned);
            let (stamped, process) = (word("ts")?, word("process").unwrap_or_default());
            let clock = stamped.rsplit('T').next().unwrap_or_default().trim_end_matches('Z').to_owned();
            (word("trace_id").as_deref() == Some(trace_id)).then_some(Line { at: stamped, clock, process, object })
        }));
    }
    lines.sort_by(|a, b| a.at.cmp(&b.at));
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_full_log_becomes_the_earlier_one_and_there_are_never_more_than_two() {
        let folder = tempfile::tempdir().unwrap();
        let path = file(folder.path(), "simulation-1");
        let mut kept = Kept::open(&path, 100).unwrap();
        for number in 0..40 {
            kept.write(&format!("line {number:>4} of thirty bytes....\n")).unwrap();
        }
        drop(kept);
        let names = |path: &Path| std::fs::read_dir(path.parent().unwrap()).unwrap().count();
        let read = |path: &Path| std::fs::read_to_string(path).unwrap();
        assert_eq!(names(&path), 2);
        assert!(read(&path).len() <= 100 && read(&earlier(&path)).len() <= 100);
        assert!(read(&path).ends_with("line   39 of thirty bytes....\n"), "{}", read(&path));
        // Another process of the same name goes on in the same file.
        let mut again = Kept::open(&path, 1_000).unwrap();
        again.write("more\n").unwrap();
        assert!(read(&path).contains("line   39") && read(&path).ends_with("more\n"));
        // A line that is longer than a file may be is not lost.
        let mut small = Kept::open(&path, 10).unwrap();
        small.write("a line of its own\n").unwrap();
        assert_eq!(read(&path), "a line of its own\n");
        use std::os::unix::fs::PermissionsExt as _;
        assert_eq!(std::fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o600);
    }

    #[test]
    fn times_are_written_as_everybody_reads_them() {
        for (ms, text) in [
            (0, "1970-01-01T00:00:00.000Z"),
            (951_782_399_999, "2000-02-28T23:59:59.999Z"),
            (951_782_400_000, "2000-02-29T00:00:00.000Z"),
            (1_709_251_199_000, "2024-02-29T23:59:59.000Z"),
            (4_102_444_800_000, "2100-01-01T00:00:00.000Z"),
            (4_107_542_400_000, "2100-03-01T00:00:00.000Z"),
        ] {
            assert_eq!(stamp(ms), text);
        }
    }

    #[test]
    fn keys_are_struck_out_by_value_and_by_shape() {
        let set = ["author.key_variable=LAB_KEY".to_owned()];
        let variables = [("LAB_KEY".to_owned(), "of-no-known-shape".to_owned())];
        let config = Config::load(None, variables.into_iter(), &set).unwrap();
        strike_keys_of(&config);
        let told = struck("the server says: bad key of-no-known-shape, not sk-0123456789abcdefghij0123");
        assert_eq!(told, "the server says: bad key ***, not sk-***");
        assert!(struck(&"x".repeat(10_000)).chars().count() <= TEXT_CHARS + 1);
    }

    #[test]
    fn lines_of_a_trace_are_found_in_all_logs_in_order_of_time() {
        let folder = tempfile::tempdir().unwrap();
        let line = |at: &str, process: &str, trace: &str, msg: &str| {
            format!("{{\"ts\":\"{at}\",\"process\":\"{process}\",\"trace_id\":\"{trace}\",\"msg\":\"{msg}\"}}\n")
        };
        let write = |name: &str, text: String| std::fs::write(folder.path().join(name), text).unwrap();
        write(
            "orchestrator.jsonl",
            line("2", "orchestrator", "aa", "reports") + &line("3", "orchestrator", "bb", "other"),
        );
        write("orchestrator.1.jsonl", line("1", "orchestrator", "aa", "hands out"));
        write("paths.jsonl", line("1.5", "paths", "aa", "begins") + "{\"ts\":\"9\",\"trace_id\":\"aa");
        write("notes.txt", line("0", "nobody", "aa", "not a log"));
        let found = of_trace(folder.path(), "aa");
        let told: Vec<&str> = found.iter().filter_map(|line| line.object["msg"].as_str()).collect();
        assert_eq!(told, ["hands out", "begins", "reports"]);
        assert!(of_trace(&folder.path().join("none"), "aa").is_empty());
    }
}
