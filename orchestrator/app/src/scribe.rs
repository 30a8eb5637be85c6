//! A run written down while it goes; nothing of it is kept in memory.

use std::fs::File;
use std::io::{BufWriter, Write as _};
use std::path::{Path, PathBuf};

use socrates_model::recording::RecordingHash;
use socrates_model::{AgentState, Digest, Event, EventKind, Location, Onlooker, RecordingHeader, SimTime};
use socrates_stream::StreamError;
use socrates_stream::csv::AgentTable;
use socrates_stream::mcap::Writer;

use crate::exit::Diagnostic;
use crate::files;

/// Writes the recording of a run and the table of its agents, where they are wanted, and tells its recording hash.
///
/// The file is a recording from its first chunk on: a run that breaks off leaves one that is read up to there.
pub(crate) struct Scribe<'a> {
    path: Option<PathBuf>,
    location: Option<&'a Location>,
    hash: RecordingHash,
    writer: Option<Writer<BufWriter<File>>>,
    table_path: Option<PathBuf>,
    table: Option<(BufWriter<File>, AgentTable)>,
    broken: Option<Diagnostic>,
    ticks: u64,
    contacts: usize,
}

/// What was written.
#[derive(Debug, Clone, Copy)]
pub struct Written {
    /// Time of the last tick, s.
    pub(crate) last_s: f64,
    /// Touches between agents.
    pub(crate) contacts: usize,
    /// The recording hash.
    pub(crate) hash: Digest,
}

impl<'a> Scribe<'a> {
    /// One that will write the recording to this file, with the walls of the location.
    pub(crate) fn new(path: Option<&Path>, location: Option<&'a Location>) -> Self {
        Self {
            path: path.map(Path::to_owned),
            location,
            hash: RecordingHash::default(),
            writer: None,
            table_path: None,
            table: None,
            broken: None,
            ticks: 0,
            contacts: 0,
        }
    }

    /// The same with the table of agents, ten times a second.
    pub(crate) fn with_table(mut self, path: &Path) -> Self {
        self.table_path = Some(path.to_owned());
        self
    }

    /// Ends the files.
    pub(crate) fn finish(self) -> Result<Written, Diagnostic> {
        if let Some(broken) = self.broken {
            return Err(broken);
        }
        if let Some(writer) = self.writer {
            let (file, _whole) = writer.finish().map_err(|why| unwritten(&why))?;
            file.into_inner().map_err(|why| cannot(&self.path.unwrap_or_default(), why.error()))?;
        }
        if let Some((file, _)) = self.table {
            file.into_inner().map_err(|why| cannot(&self.table_path.unwrap_or_default(), why.error()))?;
        }
        let last_s = SimTime::of_last(self.ticks).secs();
        Ok(Written { last_s, contacts: self.contacts, hash: self.hash.finish() })
    }

    fn begin(&mut self, header: &RecordingHeader) -> Result<(), Diagnostic> {
        if let Some(path) = &self.path {
            let file = created(path)?;
            self.writer = Some(Writer::begin(file, header, self.location).map_err(|why| unwritten(&why))?);
        }
        if let Some(path) = &self.table_path {
            let mut file = created(path)?;
            file.write_all(AgentTable::head().as_bytes()).map_err(|why| cannot(path, &why))?;
            self.table = Some((file, AgentTable::of(header)));
        }
        Ok(())
    }

    fn write(&mut self, states: &[AgentState], events: &[Event]) -> Result<(), Diagnostic> {
        if let Some(writer) = &mut self.writer {
            let written = writer.tick(states).and_then(|()| events.iter().try_for_each(|event| writer.event(event)));
            written.map_err(|why| unwritten(&why))?;
        }
        if let (Some(path), Some((file, table))) = (&self.table_path, &mut self.table) {
            file.write_all(table.rows(states).as_bytes()).map_err(|why| cannot(path, &why))?;
        }
        Ok(())
    }
}

impl Onlooker for Scribe<'_> {
    fn announce(&mut self, header: &RecordingHeader) {
        self.broken = self.begin(header).err();
    }

    fn tick(&mut self, states: &[AgentState], events: &[Event]) {
        self.ticks += 1;
        self.hash.states(states);
        events.iter().for_each(|event| self.hash.event(event));
        self.contacts += events.iter().filter(|event| matches!(event.kind, EventKind::Contact { .. })).count();
        if self.broken.is_none() {
            self.broken = self.write(states, events).err();
        }
    }
}

fn created(path: &Path) -> Result<BufWriter<File>, Diagnostic> {
    files::write(path, b"")?;
    File::create(path).map(BufWriter::new).map_err(|why| cannot(path, &why))
}

fn cannot(path: &Path, why: &std::io::Error) -> Diagnostic {
    Diagnostic::input(format!("cannot write `{}`: {why}", path.display()), "--out chooses another folder")
}

fn unwritten(why: &StreamError) -> Diagnostic {
    Diagnostic::input(why.to_string(), "--out chooses another folder")
}
