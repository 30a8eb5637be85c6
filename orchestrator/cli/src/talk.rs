//! The only place that prints. Text: lines on standard output. JSON: talk on standard error, one object on standard output.

use std::io::{IsTerminal as _, Write as _};

use crate::args::Format;

/// Printer of one command.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Talk {
    /// How results are printed.
    pub(crate) format: Format,
    /// Whether a line may be rewritten in place.
    pub(crate) live: bool,
}

impl Talk {
    /// A printer.
    pub(crate) fn new(format: Format) -> Self {
        Self { format, live: format == Format::Text && std::io::stdout().is_terminal() }
    }

    /// A finished line. A closed pipe is no error: the reader has seen enough.
    pub(crate) fn line(&self, text: &str) {
        let written = match self.format {
            Format::Text => writeln!(std::io::stdout(), "{text}"),
            Format::Json => writeln!(std::io::stderr(), "{text}"),
        };
        drop(written);
    }

    /// A line that the next one replaces; nothing where there is no terminal.
    pub(crate) fn passing(&self, text: &str) {
        if self.live {
            let width = 118;
            let short: String = text.chars().take(width).collect();
            drop(write!(std::io::stdout(), "\r\x1b[2K{short}"));
            drop(std::io::stdout().flush());
        }
    }

    /// Removes a passing line.
    pub(crate) fn clear(&self) {
        if self.live {
            drop(write!(std::io::stdout(), "\r\x1b[2K"));
            drop(std::io::stdout().flush());
        }
    }

    /// A remark beside the result.
    pub(crate) fn warn(&self, text: &str) {
        drop(writeln!(std::io::stderr(), "{text}"));
    }

    /// The last word of a child, for the supervisor at the other end of its standard output.
    pub(crate) fn to_supervisor(&self, object: &serde_json::Value) {
        drop(writeln!(std::io::stdout(), "{object}"));
    }

    /// The result object; printed for programs only.
    pub(crate) fn result(&self, object: &serde_json::Value) {
        if self.format == Format::Json {
            drop(writeln!(std::io::stdout(), "{object}"));
        }
    }
}
