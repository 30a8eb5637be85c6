//! The only way to say something. Text: lines on standard output. JSON: talk on standard error, one object on standard output.
//!
//! Where the lines go is not known here: a [`Terminal`] is handed in.

use std::fmt::Debug;
use std::time::Duration;

/// How results are printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// For people.
    Text,
    /// For programs.
    Json,
}

/// How far something is that takes time, for a bar.
#[derive(Debug, Clone, Copy)]
pub struct Bar<'a> {
    /// The work, in one word such as `making`.
    pub what: &'a str,
    /// Things done.
    pub done: u64,
    /// Things in all.
    pub total: u64,
    /// What stands behind the counts; may be empty.
    pub remark: &'a str,
}

/// Where lines go and come from. A closed pipe is no error: the reader has seen enough.
pub trait Terminal: Debug + Sync {
    /// A line on standard output.
    fn out(&self, text: &str);

    /// A line on standard error.
    fn err(&self, text: &str);

    /// A line that the next one replaces.
    fn passing(&self, text: &str);

    /// Removes a passing line or a bar.
    fn clear(&self);

    /// Whether bars can be drawn.
    fn draws(&self) -> bool;

    /// A bar, in the place of what stood there.
    fn bar(&self, bar: Bar<'_>);

    /// Letters that fit into a line; none where standard output is no terminal.
    fn columns(&self) -> Option<usize>;

    /// Whether a person types into standard input.
    fn is_typed_to(&self) -> bool;

    /// The next line of standard input; none at its end, or where the person breaks off.
    ///
    /// # Errors
    /// Standard input cannot be read.
    fn ask(&self, prompt: &str) -> std::io::Result<Option<String>>;
}

/// Printer of one command.
#[derive(Debug, Clone, Copy)]
pub struct Printer {
    /// How results are printed.
    pub format: Format,
    /// Whether a person sees the lines on a terminal.
    pub live: bool,
    /// Pause between two lines of progress where no bar can be drawn; zero for none.
    pub pause: Duration,
    terminal: &'static dyn Terminal,
}

impl Printer {
    /// A printer; `live` where a person sees the lines of this terminal.
    pub const fn new(format: Format, live: bool, terminal: &'static dyn Terminal) -> Self {
        Self { format, live, pause: Duration::ZERO, terminal }
    }

    /// The same with a pause between two lines of progress.
    pub const fn with_pause(self, pause: Duration) -> Self {
        Self { pause, ..self }
    }

    /// A finished line.
    pub fn line(&self, text: &str) {
        match self.format {
            Format::Text => self.terminal.out(text),
            Format::Json => self.terminal.err(text),
        }
    }

    /// A line that the next one replaces; nothing where there is no terminal.
    pub fn passing(&self, text: &str) {
        if self.live {
            self.terminal.passing(text);
        }
    }

    /// Removes a passing line.
    pub fn clear(&self) {
        if self.live {
            self.terminal.clear();
        }
    }

    /// A remark beside the result.
    pub fn warn(&self, text: &str) {
        self.terminal.err(text);
    }

    /// The last word of a child, for the supervisor at the other end of its standard output.
    pub fn last_word(&self, object: &serde_json::Value) {
        self.terminal.out(&object.to_string());
    }

    /// The result object, or one of many, each on a line of its own; printed for programs only.
    pub fn result(&self, object: &serde_json::Value) {
        if self.format == Format::Json {
            self.terminal.out(&object.to_string());
        }
    }

    /// Whether bars can be drawn.
    pub(crate) fn draws(&self) -> bool {
        self.terminal.draws()
    }

    /// Draws a bar.
    pub(crate) fn bar(&self, bar: Bar<'_>) {
        self.terminal.bar(bar);
    }

    /// Removes a bar.
    pub(crate) fn end_bar(&self) {
        self.terminal.clear();
    }

    /// Letters that fit into a line; none where nobody sees the lines on a terminal.
    pub(crate) fn columns(&self) -> Option<usize> {
        self.terminal.columns().filter(|_| self.live)
    }

    /// Whether a person types into standard input.
    pub(crate) fn is_typed_to(&self) -> bool {
        self.terminal.is_typed_to()
    }

    /// The next line of standard input.
    pub(crate) fn ask(&self, prompt: &str) -> std::io::Result<Option<String>> {
        self.terminal.ask(prompt)
    }
}

/// A terminal that nobody reads, for tests.
#[cfg(test)]
#[derive(Debug)]
struct Nobody;

#[cfg(test)]
impl Terminal for Nobody {
    fn out(&self, _: &str) {}
    fn err(&self, _: &str) {}
    fn passing(&self, _: &str) {}
    fn clear(&self) {}
    fn draws(&self) -> bool {
        false
    }
    fn bar(&self, _: Bar<'_>) {}
    fn columns(&self) -> Option<usize> {
        None
    }
    fn is_typed_to(&self) -> bool {
        false
    }
    fn ask(&self, _: &str) -> std::io::Result<Option<String>> {
        Ok(None)
    }
}

#[cfg(test)]
impl Printer {
    /// A printer whose lines nobody reads.
    pub(crate) const fn to_nobody(format: Format) -> Self {
        Self::new(format, false, &Nobody)
    }
}
