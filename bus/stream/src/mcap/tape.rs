//! A recording in memory that is read while it is still being written.

use std::io::Write;
use std::ops::Range;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use ::mcap::records::{Record, op};
use ::mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
use socrates_model::Location;
use socrates_model::recording::RecordingHeader;

use super::write::Writer;
use crate::error::StreamError;

/// Ticks that follow each other.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Stretch {
    /// First tick.
    pub(super) from: u64,
    /// How many.
    pub(super) ticks: u64,
}

/// A recording in memory: a [`Writer`] fills it, whoever missed some ticks reads them from its chunks. Clones share it.
#[derive(Debug, Clone, Default)]
pub struct Tape(Arc<Mutex<Roll>>);

#[derive(Debug, Default)]
struct Roll {
    bytes: Vec<u8>,
    /// Where the ticks of each chunk are.
    chunks: Vec<(Stretch, Range<usize>)>,
    channel: u16,
}

impl Write for Tape {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.roll().bytes.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

impl Tape {
    fn roll(&self) -> MutexGuard<'_, Roll> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Begins a recording on this tape, which is empty.
    ///
    /// # Errors
    /// [`StreamError::Write`].
    pub fn record(&self, header: &RecordingHeader, location: Option<&Location>) -> Result<Writer<Self>, StreamError> {
        let writer = Writer::begin(self.clone(), header, location)?;
        self.roll().channel = writer.agents_channel();
        let tape = self.clone();
        Ok(writer.telling(move |stretch| {
            let mut roll = tape.roll();
            let begin = roll.chunks.last().map_or(0, |(_, place)| place.end);
            let place = begin..roll.bytes.len();
            roll.chunks.push((stretch, place));
        }))
    }

    /// The file as it is now.
    #[must_use]
    pub fn bytes(&self) -> Vec<u8> {
        let mut roll = self.roll();
        // Whoever asks for all of it has written all of it.
        roll.bytes.shrink_to_fit();
        roll.bytes.clone()
    }

    /// Ticks that can be read: all before this one.
    #[must_use]
    pub fn ticks(&self) -> u64 {
        self.roll().chunks.last().map_or(0, |(stretch, _)| stretch.from + stretch.ticks)
    }

    /// The records of the ticks of the chunk that holds this one, each tick's bytes in order; none where the chunk is not
    /// closed yet.
    pub(crate) fn chunk_of(&self, tick: u64) -> Vec<Vec<u8>> {
        let (chunk, begins, channel) = {
            let roll = self.roll();
            let at = roll.chunks.partition_point(|(stretch, _)| stretch.from + stretch.ticks <= tick);
            let Some((stretch, place)) = roll.chunks.get(at) else { return Vec::new() };
            let Some(bytes) = roll.bytes.get(place.clone()) else { return Vec::new() };
            (bytes.to_vec(), stretch.from == 0, roll.channel)
        };
        states(&chunk, begins, channel)
    }
}

/// The messages of one channel in a piece of a file that holds whole chunks.
fn states(piece: &[u8], begins: bool, channel: u16) -> Vec<Vec<u8>> {
    let options = LinearReaderOptions::default().with_skip_start_magic(!begins).with_skip_end_magic(true);
    let mut reader = LinearReader::new_with_options(options);
    let (mut found, mut rest) = (Vec::new(), piece);
    while let Some(Ok(event)) = reader.next_event() {
        match event {
            LinearReadEvent::ReadRequest(wanted) => {
                let (given, left) = rest.split_at(wanted.min(rest.len()));
                if given.is_empty() {
                    break;
                }
                if let Some(room) = reader.insert(given.len()).get_mut(..given.len()) {
                    room.copy_from_slice(given);
                }
                reader.notify_read(given.len());
                rest = left;
            }
            LinearReadEvent::Record { opcode: op::MESSAGE, data } => {
                if let Ok(Record::Message { header, data }) = ::mcap::parse_record(op::MESSAGE, data)
                    && header.channel_id == channel
                {
                    found.push(data.into_owned());
                }
            }
            LinearReadEvent::Record { .. } => {}
        }
    }
    found
}
