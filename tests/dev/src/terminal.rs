//! The terminal of this process: lines on standard output and standard error, and one that the next replaces.

use std::io::{IsTerminal as _, Write as _};

use socrates_app::output::{Bar, Format, Printer, Terminal};

/// Standard output and error.
#[derive(Debug)]
struct Screen;

/// Clears the line of a terminal.
const CLEAR: &str = "\r\x1b[2K";

impl Terminal for Screen {
    fn out(&self, text: &str) {
        self.clear();
        drop(writeln!(std::io::stdout(), "{text}"));
    }

    fn err(&self, text: &str) {
        self.clear();
        drop(writeln!(std::io::stderr(), "{text}"));
    }

    fn passing(&self, text: &str) {
        if self.draws() {
            drop(write!(std::io::stderr(), "{CLEAR}{text}"));
        }
    }

    fn clear(&self) {
        if self.draws() {
            drop(write!(std::io::stderr(), "{CLEAR}"));
        }
    }

    fn draws(&self) -> bool {
        std::io::stderr().is_terminal()
    }

    fn bar(&self, bar: Bar<'_>) {
        self.passing(&format!("{:<10} {} of {}", bar.what, bar.done, bar.total));
    }

    fn is_typed_to(&self) -> bool {
        false
    }

    fn columns(&self) -> Option<usize> {
        None
    }

    fn ask(&self, _prompt: &str) -> std::io::Result<Option<String>> {
        Ok(None)
    }
}

/// The printer of this process.
pub(crate) fn talk(format: Format) -> Printer {
    Printer::new(format, format == Format::Text && std::io::stdout().is_terminal(), &Screen)
}
