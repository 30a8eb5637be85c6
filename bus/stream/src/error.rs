//! What can go wrong with a stream or a file of one.

use socrates_link::LinkError;

/// A stream or file that could not be written or read.
#[derive(Debug, thiserror::Error)]
pub enum StreamError {
    /// The bus refused.
    #[error("live stream of run `{run}` cannot use the bus")]
    Link {
        /// Which run.
        run: String,
        /// Why.
        #[source]
        why: LinkError,
    },
    /// Shared memory refused.
    #[error("shared memory for run `{run}`: {what} failed: {why}")]
    Shm {
        /// Which run.
        run: String,
        /// What was tried.
        what: &'static str,
        /// The library's words.
        why: String,
    },
    /// An MCAP file cannot be written.
    #[error("recording of run `{run}` cannot be written: {why}")]
    Write {
        /// Which run.
        run: String,
        /// Why.
        why: String,
    },
    /// Bytes are no readable MCAP file.
    #[error("recording of {len} bytes cannot be read: {why}")]
    Read {
        /// Length of the file, bytes.
        len: usize,
        /// Whether it ends before it is whole.
        cut: bool,
        /// What is wrong.
        why: String,
    },
    /// An MCAP file is readable but is no recording of ours, or is not whole.
    #[error("recording is not whole: {why}")]
    NotWhole {
        /// What is missing or contradicts itself.
        why: String,
    },
    /// An MCAP file of another program.
    #[error("there is no recording of ours in it: it lacks the topic `/socrates/header` and has {topics}")]
    Foreign {
        /// Its topics with their schemas.
        topics: String,
    },
    /// A CSV file has a line that cannot be read.
    #[error("line {line}: {why}")]
    Csv {
        /// Line, from 1.
        line: usize,
        /// What is wrong, with the value and what would be allowed.
        why: String,
    },
}
