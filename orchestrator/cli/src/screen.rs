//! The terminal of this process: lines on standard output and standard error, a bar below them, lines that are typed.

use std::io::{IsTerminal as _, Write as _};
use std::sync::{Mutex, OnceLock, PoisonError};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use rustyline::DefaultEditor;
use rustyline::error::ReadlineError;
use socrates_app::output::{Bar, Format, Printer, Terminal};

/// Standard input, output and error.
#[derive(Debug)]
struct Screen;

/// The one bar of this process; it draws on standard error where that is a terminal, and nothing elsewhere.
fn bar() -> &'static ProgressBar {
    static BAR: OnceLock<ProgressBar> = OnceLock::new();
    BAR.get_or_init(|| {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
        // It stands there from its first text on.
        bar.finish_and_clear();
        bar
    })
}

fn show(bar: &ProgressBar, template: &str, total: Option<u64>) {
    // A template of our own is a template: the plain bar stands in for what cannot be.
    bar.set_style(ProgressStyle::with_template(template).unwrap_or_else(|_why| ProgressStyle::default_bar()));
    match total {
        Some(total) => bar.set_length(total),
        None => bar.unset_length(),
    }
    if bar.is_finished() {
        bar.reset();
    }
}

/// Does something with what reads lines and holds those of before; it is made where it is first needed.
fn with_editor<T>(what: impl FnOnce(&mut DefaultEditor) -> T) -> std::io::Result<T> {
    static EDITOR: Mutex<Option<DefaultEditor>> = Mutex::new(None);
    let mut editor = EDITOR.lock().unwrap_or_else(PoisonError::into_inner);
    let lines = match &mut *editor {
        Some(lines) => lines,
        empty => empty.insert(DefaultEditor::new().map_err(std::io::Error::other)?),
    };
    Ok(what(lines))
}

impl Terminal for Screen {
    fn out(&self, text: &str) {
        bar().suspend(|| drop(writeln!(std::io::stdout(), "{text}")));
    }

    fn err(&self, text: &str) {
        bar().suspend(|| drop(writeln!(std::io::stderr(), "{text}")));
    }

    fn passing(&self, text: &str) {
        // What is wider than the terminal is cut: a line that wraps cannot be replaced.
        show(bar(), "{wide_msg}", None);
        bar().set_message(text.to_owned());
    }

    fn clear(&self) {
        bar().finish_and_clear();
    }

    fn draws(&self) -> bool {
        !bar().is_hidden()
    }

    fn bar(&self, told: Bar<'_>) {
        let bar = bar();
        show(bar, "{prefix:<10} [{bar:24}] {pos} of {len}{msg}", Some(told.total));
        bar.set_prefix(told.what.to_owned());
        bar.set_message(if told.remark.is_empty() { String::new() } else { format!(" · {}", told.remark) });
        bar.set_position(told.done);
    }

    fn is_typed_to(&self) -> bool {
        std::io::stdin().is_terminal()
    }

    fn columns(&self) -> Option<usize> {
        let (columns, _) = with_editor(DefaultEditor::dimensions).ok()??;
        Some(usize::from(columns)).filter(|columns| *columns > 0)
    }

    fn ask(&self, prompt: &str) -> std::io::Result<Option<String>> {
        with_editor(|lines| match lines.readline(prompt) {
            Ok(line) => {
                // A line that cannot be remembered can still be followed.
                drop(lines.add_history_entry(line.as_str()));
                Ok(Some(line))
            }
            Err(ReadlineError::Eof | ReadlineError::Interrupted) => Ok(None),
            Err(why) => Err(std::io::Error::other(why)),
        })?
    }
}

/// The printer of this process.
pub(crate) fn talk(format: Format) -> Printer {
    Printer::new(format, format == Format::Text && std::io::stdout().is_terminal(), &Screen)
}
