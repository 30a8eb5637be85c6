//! The journal: every edit as a line on the disk before it is answered, so that a killed editor loses nothing.
//!
//! ```text
//! {"begun":…}   the map, the sketch at the beginning, the files that it was read from
//! {"step":…}    an edit, an undo, a redo
//! {"saved":…}   the files as they were written
//! ```

use std::fs::File;
use std::io::{Read as _, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use socrates_edit::{History, Sketch, Step};
use socrates_model::Digest;

use super::site::Disk;
use crate::exit::{Code, Diagnostic};

/// Name of the file in the editor's own folder.
pub(crate) const JOURNAL: &str = "journal.jsonl";
/// Format of the lines.
const FORMAT: u32 = 1;
/// Longest journal that is gone on with, bytes.
const MAX_BYTES: u64 = 512 << 20;

/// A line.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
enum Line {
    Begun { format: u32, map: Digest, disk: Disk, sketch: Sketch },
    Step(Step),
    Saved { disk: Disk },
}

/// An open journal.
#[derive(Debug)]
pub(crate) struct Journal {
    file: File,
    path: PathBuf,
}

/// A journal with what it holds.
#[derive(Debug)]
pub(crate) struct Opened {
    /// To go on with.
    pub(crate) journal: Journal,
    /// What was done.
    pub(crate) history: History,
    /// The files as they were when they were read or written last.
    pub(crate) disk: Disk,
    /// Lines that were there already; none for a new one.
    pub(crate) steps: usize,
}

impl Journal {
    /// Goes on with the journal of a folder, or begins one with a sketch that was read from files.
    ///
    /// # Errors
    /// A [`Diagnostic`] where it cannot be written, was drawn on another map, or holds a line that cannot be done; the last line is left out
    /// where it was cut off.
    pub(crate) fn open(work: &Path, map: Digest, base: Sketch, disk: Disk) -> Result<Opened, Diagnostic> {
        let path = work.join(JOURNAL);
        let cannot = |why: std::io::Error| cannot(&path, why);
        std::fs::create_dir_all(work).map_err(cannot)?;
        let mut file =
            File::options().create(true).truncate(false).read(true).write(true).open(&path).map_err(cannot)?;
        if file.metadata().map_err(cannot)?.len() > MAX_BYTES {
            let what = format!("the journal `{}` has more than {MAX_BYTES} bytes", path.display());
            return Err(Diagnostic::input(what, AFRESH));
        }
        let mut text = String::new();
        file.read_to_string(&mut text).map_err(cannot)?;
        let whole = text.rfind('\n').map_or(0, |end| end + 1);
        file.set_len(u64::try_from(whole).unwrap_or(u64::MAX)).map_err(cannot)?;
        file.seek(SeekFrom::End(0)).map_err(cannot)?;
        let mut journal = Self { file, path: path.clone() };
        let lines = text.get(..whole).unwrap_or_default();
        if lines.is_empty() {
            journal.write(&Line::Begun { format: FORMAT, map, disk: disk.clone(), sketch: base.clone() })?;
            return Ok(Opened { journal, history: History::new(base), disk, steps: 0 });
        }
        let (history, disk, steps) = replayed(&path, lines, map)?;
        Ok(Opened { journal, history, disk, steps })
    }

    /// Moves the journal of a folder aside, where there is one. Gives where it is then.
    ///
    /// # Errors
    /// A [`Diagnostic`] where it cannot be moved.
    pub(crate) fn put_aside(work: &Path) -> Result<Option<PathBuf>, Diagnostic> {
        let path = work.join(JOURNAL);
        if !path.exists() {
            return Ok(None);
        }
        let aside = (1_u32..).map(|number| work.join(format!("journal-{number}.jsonl"))).find(|aside| !aside.exists());
        let Some(aside) = aside else { return Ok(None) };
        std::fs::rename(&path, &aside).map_err(|why| cannot(&path, why))?;
        Ok(Some(aside))
    }

    /// Keeps something that was done.
    ///
    /// # Errors
    /// A [`Diagnostic`] where the disk does not take it.
    pub(crate) fn step(&mut self, step: Step) -> Result<(), Diagnostic> {
        self.write(&Line::Step(step))
    }

    /// Keeps that the files were written.
    ///
    /// # Errors
    /// As [`Journal::step`].
    pub(crate) fn saved(&mut self, disk: &Disk) -> Result<(), Diagnostic> {
        self.write(&Line::Saved { disk: disk.clone() })
    }

    fn write(&mut self, line: &Line) -> Result<(), Diagnostic> {
        let mut text = serde_json::to_string(line).map_err(|why| {
            Diagnostic::input(format!("a line of the journal cannot be written: {why}"), "").with_code(Code::Ours)
        })?;
        text.push('\n');
        let begins = self.file.stream_position();
        let kept = self.file.write_all(text.as_bytes()).and_then(|()| self.file.sync_data());
        kept.map_err(|why| {
            // Half a line would spoil the next one.
            if let Ok(begins) = begins {
                drop(self.file.set_len(begins).and_then(|()| self.file.seek(SeekFrom::Start(begins))));
            }
            cannot(&self.path, why)
        })
    }
}

/// What helps where a journal is of no use.
const AFRESH: &str = "`--fresh` moves it aside and begins with the files as they are";

fn cannot(path: &Path, why: std::io::Error) -> Diagnostic {
    let hint = "check the disk and the folder; `--read-only` looks at the location and keeps nothing";
    Diagnostic::input(format!("cannot keep `{}`: {why}", path.display()), hint).with_code(Code::Ours)
}

/// Does again what the lines say.
fn replayed(path: &Path, lines: &str, map: Digest) -> Result<(History, Disk, usize), Diagnostic> {
    let wrong = |number: usize, why: String| {
        Diagnostic::input(format!("`{}:{}` cannot be done again: {why}", path.display(), number + 1), AFRESH)
    };
    let mut all = lines.lines().enumerate();
    let first = all.next().map(|(_, line)| serde_json::from_str::<Line>(line));
    let (mut history, mut disk) = match first {
        Some(Ok(Line::Begun { format: FORMAT, map: drawn_on, disk, sketch })) => {
            if drawn_on != map {
                let what = format!("the journal `{}` was drawn on another map than this one", path.display());
                return Err(Diagnostic::input(what, AFRESH));
            }
            (History::new(sketch), disk)
        }
        Some(Ok(Line::Begun { format, .. })) => {
            return Err(wrong(0, format!("it has the format {format}; this version reads {FORMAT}")));
        }
        Some(Ok(Line::Step(_) | Line::Saved { .. })) | None => {
            return Err(wrong(0, "the first line does not begin a journal".to_owned()));
        }
        Some(Err(why)) => return Err(wrong(0, why.to_string())),
    };
    let mut steps = 0;
    for (number, line) in all {
        match serde_json::from_str::<Line>(line).map_err(|why| wrong(number, why.to_string()))? {
            Line::Begun { .. } => return Err(wrong(number, "a second journal begins here".to_owned())),
            Line::Saved { disk: now } => disk = now,
            Line::Step(step) => {
                history.take(step).map_err(|why| wrong(number, why.to_string()))?;
                steps += 1;
            }
        }
    }
    Ok((history, disk, steps))
}
