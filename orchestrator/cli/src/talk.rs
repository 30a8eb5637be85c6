//! The only place that prints. Text: lines on standard output. JSON: talk on standard error, one object on standard output.

use std::io::{IsTerminal as _, Write as _};
use std::time::Duration;

use crate::args::Format;
use crate::progress;

/// Printer of one command.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Talk {
    /// How results are printed.
    pub(crate) format: Format,
    /// Whether a person sees the lines on a terminal.
    pub(crate) live: bool,
    /// Pause between two lines of progress where no bar can be drawn; zero for none.
    pub(crate) pause: Duration,
}

impl Talk {
    /// A printer.
    pub(crate) fn new(format: Format) -> Self {
        let live = format == Format::Text && std::io::stdout().is_terminal();
        Self { format, live, pause: Duration::ZERO }
    }

    /// The same with a pause between two lines of progress.
    pub(crate) const fn with_pause(self, pause: Duration) -> Self {
        Self { pause, ..self }
    }

    /// A finished line. A closed pipe is no error: the reader has seen enough.
    pub(crate) fn line(&self, text: &str) {
        progress::bar().suspend(|| {
            let written = match self.format {
                Format::Text => writeln!(std::io::stdout(), "{text}"),
                Format::Json => writeln!(std::io::stderr(), "{text}"),
            };
            drop(written);
        });
    }

    /// A line that the next one replaces; nothing where there is no terminal.
    pub(crate) fn passing(&self, text: &str) {
        if self.live {
            progress::passing(text);
        }
    }

    /// Removes a passing line.
    pub(crate) fn clear(&self) {
        if self.live {
            progress::clear();
        }
    }

    /// A remark beside the result.
    pub(crate) fn warn(&self, text: &str) {
        progress::bar().suspend(|| drop(writeln!(std::io::stderr(), "{text}")));
    }

    /// The last word of a child, for the supervisor at the other end of its standard output.
    pub(crate) fn last_word(&self, object: &serde_json::Value) {
        drop(writeln!(std::io::stdout(), "{object}"));
    }

    /// The result object, or one of many, each on a line of its own; printed for programs only.
    pub(crate) fn result(&self, object: &serde_json::Value) {
        if self.format == Format::Json {
            drop(writeln!(std::io::stdout(), "{object}"));
        }
    }
}
