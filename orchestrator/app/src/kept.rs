//! What a library keeps of scenarios whose bundles it does not keep: one file with a line for each.
//!
//! ```text
//! made ─► a packed line of its own in the work folder ─► all in order, one after another ─► scenarios.jsonl.zst ─► page and tables
//! ```
//!
//! Packed lines may stand one after another in one file, so nothing is packed twice. A line is a scenario with all reports of its runs,
//! or a location, which comes before the first scenario that happens there.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{BufRead as _, BufReader, Write as _};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use socrates_draw::BatchRow;
use socrates_model::{Digest, Likeness, Location, Report, ScenarioId, Verdict};

use crate::exit::{Code, Diagnostic};
use crate::{files, index};

/// The file in a library.
pub(crate) const FILE: &str = "scenarios.jsonl.zst";
/// Folder of the work folder that holds lines until all are there.
const LINES: &str = "kept";
/// How strongly is packed, as with bundles.
const LEVEL: i32 = 3;
/// A line longer than this is not read, bytes.
const MOST_BYTES: usize = 64 << 20;
const HINT: &str = "the file was changed by hand or is damaged: make the library again in an empty folder";

/// A line of the file.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Line {
    Location(Box<Location>),
    Scenario(Box<Kept>),
}

/// What is kept of a scenario.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Kept {
    /// Which.
    pub(crate) scenario: ScenarioId,
    /// Verdict of its first run.
    pub(crate) verdict: Verdict,
    /// What other scenarios are compared with.
    pub(crate) likeness: Likeness,
    /// Digest of its location.
    location: Digest,
    /// What the page shows.
    pub(crate) row: BatchRow,
    /// Its rows of the table.
    pub(crate) runs: index::Rows,
    /// Reports of its runs.
    pub(crate) reports: Vec<Report>,
}

impl Kept {
    /// The line of a scenario that happened here.
    pub(crate) fn new(
        scenario: ScenarioId,
        verdict: Verdict,
        location: &Location,
        (likeness, row, runs): (Likeness, BatchRow, index::Rows),
        reports: Vec<Report>,
    ) -> Self {
        Self { scenario, verdict, likeness, location: digest(location), row, runs, reports }
    }
}

fn digest(location: &Location) -> Digest {
    Digest::of(serde_json::to_string(location).unwrap_or_default().as_bytes())
}

/// Lines of a library that is being made.
#[derive(Debug, Clone)]
pub(crate) struct Lines {
    folder: PathBuf,
}

impl Lines {
    /// Those in a work folder.
    pub(crate) fn of(work: &Path) -> Self {
        Self { folder: work.join(LINES) }
    }

    /// Takes over what a finished library has, so that it is not made again.
    pub(crate) fn adopt(&self, library: &Path) -> Result<(), Diagnostic> {
        if library.join(FILE).is_file() {
            for (kept, location) in Reader::open(library)?.all()? {
                self.put(&kept, &location)?;
            }
        }
        Ok(())
    }

    /// Writes the line of a scenario. One that a kill cut short cannot be unpacked: it is not there.
    pub(crate) fn put(&self, kept: &Kept, location: &Location) -> Result<(), Diagnostic> {
        let place = self.path(&format!("location-{}", kept.location));
        if !place.is_file() {
            write(&place, &Line::Location(Box::new(location.clone())))?;
        }
        write(&self.path(&format!("scenario-{}", kept.scenario)), &Line::Scenario(Box::new(kept.clone())))
    }

    /// Whether the line of a scenario is there.
    pub(crate) fn has(&self, scenario: &ScenarioId) -> bool {
        self.path(&format!("scenario-{scenario}")).is_file()
    }

    /// What was kept of a scenario and where it happened, if its line is there.
    pub(crate) fn get(&self, scenario: &ScenarioId) -> Option<(Kept, Location)> {
        let Line::Scenario(kept) = read(&self.path(&format!("scenario-{scenario}")))? else { return None };
        let Line::Location(location) = read(&self.path(&format!("location-{}", kept.location)))? else { return None };
        Some((*kept, *location))
    }

    /// Puts the lines of these scenarios one after another into the file of the library; without any there is no file.
    pub(crate) fn assemble<'a>(
        &self,
        library: &Path,
        scenarios: impl Iterator<Item = &'a ScenarioId>,
    ) -> Result<(), Diagnostic> {
        let (file, beside) = (library.join(FILE), self.path("all"));
        let cannot = |why: std::io::Error| {
            Diagnostic::input(format!("cannot write `{}`: {why}", file.display()), "--out chooses another folder")
        };
        let mut placed = BTreeSet::new();
        let mut all: Option<std::fs::File> = None;
        for scenario in scenarios {
            let lost = || Diagnostic::resumes(format!("what was kept of `{scenario}` is gone"));
            let path = self.path(&format!("scenario-{scenario}"));
            let Some(Line::Scenario(kept)) = read(&path) else { return Err(lost()) };
            let mut packed = Vec::new();
            if placed.insert(kept.location) {
                let place = self.path(&format!("location-{}", kept.location));
                packed.extend(std::fs::read(place).map_err(|_why| lost())?);
            }
            packed.extend(std::fs::read(&path).map_err(|_why| lost())?);
            let out = match &mut all {
                Some(out) => out,
                none => none.insert(std::fs::File::create(&beside).map_err(cannot)?),
            };
            out.write_all(&packed).map_err(cannot)?;
        }
        match all {
            // It is there whole or not at all.
            Some(out) => out.sync_all().and_then(|()| std::fs::rename(&beside, &file)).map_err(cannot),
            None => {
                drop(std::fs::remove_file(file));
                Ok(())
            }
        }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.join(format!("{name}.zst"))
    }
}

fn ours(what: String) -> Diagnostic {
    Diagnostic::input(what, "").with_code(Code::Ours)
}

fn write(path: &Path, line: &Line) -> Result<(), Diagnostic> {
    let mut text = serde_json::to_vec(line).map_err(|why| ours(why.to_string()))?;
    text.push(b'\n');
    let packed = zstd::encode_all(text.as_slice(), LEVEL).map_err(|why| ours(why.to_string()))?;
    files::write(path, &packed)
}

fn read(path: &Path) -> Option<Line> {
    let text = zstd::decode_all(std::fs::File::open(path).ok()?).ok()?;
    serde_json::from_slice(&text).ok()
}

/// The lines of a library, from the first to the last.
pub(crate) struct Reader {
    path: PathBuf,
    lines: BufReader<zstd::Decoder<'static, BufReader<std::fs::File>>>,
    number: usize,
    locations: BTreeMap<Digest, Arc<Location>>,
}

impl Reader {
    /// Opens the file of a library.
    ///
    /// # Errors
    /// Where there is none, or it is no packed file.
    pub(crate) fn open(library: &Path) -> Result<Self, Diagnostic> {
        let path = library.join(FILE);
        let bad = |why: std::io::Error| Diagnostic::input(format!("cannot read `{}`: {why}", path.display()), HINT);
        let lines = zstd::Decoder::new(std::fs::File::open(&path).map_err(bad)?).map_err(bad)?;
        Ok(Self { path, lines: BufReader::new(lines), number: 0, locations: BTreeMap::new() })
    }

    /// The next scenario and where it happened; none at the end.
    ///
    /// # Errors
    /// A line that is damaged or cannot be understood, by its number.
    pub(crate) fn next(&mut self) -> Result<Option<(Kept, Arc<Location>)>, Diagnostic> {
        loop {
            self.number += 1;
            let shown = format!("`{}` line {}", self.path.display(), self.number);
            let bad = |why: String| Diagnostic::input(format!("{shown}: {why}"), HINT);
            let mut text = Vec::new();
            let most = u64::try_from(MOST_BYTES).unwrap_or(u64::MAX);
            std::io::Read::take(&mut self.lines, most)
                .read_until(b'\n', &mut text)
                .map_err(|why| bad(why.to_string()))?;
            if text.is_empty() {
                return Ok(None);
            }
            match serde_json::from_slice(&text).map_err(|why| bad(why.to_string()))? {
                Line::Location(location) => {
                    self.locations.insert(digest(&location), Arc::new(*location));
                }
                Line::Scenario(kept) => {
                    let location = self.locations.get(&kept.location).cloned();
                    let location = location.ok_or_else(|| bad("its location does not come before it".to_owned()))?;
                    return Ok(Some((*kept, location)));
                }
            }
        }
    }

    /// All that follow.
    pub(crate) fn all(mut self) -> Result<Vec<(Kept, Arc<Location>)>, Diagnostic> {
        let mut all = Vec::new();
        while let Some(one) = self.next()? {
            all.push(one);
        }
        Ok(all)
    }
}

/// Names of the scenarios that a library keeps without their bundles; none where it has no such file.
pub(crate) fn names(library: &Path) -> Result<BTreeSet<String>, Diagnostic> {
    let mut names = BTreeSet::new();
    if library.join(FILE).is_file() {
        let mut reader = Reader::open(library)?;
        while let Some((kept, _)) = reader.next()? {
            names.insert(kept.scenario.to_string());
        }
    }
    Ok(names)
}
