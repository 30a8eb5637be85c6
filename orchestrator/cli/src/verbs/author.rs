//! `author`: who answers the authoring questions.

use clap::{Args, Subcommand};
use socrates_app::console::{self, ConsoleOptions};
use socrates_app::output::Printer;

use super::{Outcome, done};

/// Arguments of `author`.
#[derive(Debug, Args)]
pub(crate) struct Author {
    #[command(subcommand)]
    what: What,
}

/// What there is.
#[derive(Debug, Subcommand)]
enum What {
    /// Open a page at which a person answers what a language model would be asked: each prompt with its picture and its form.
    /// Runs reach it with `--author console:NAME`, other programs as a server of Chat Completions.
    Console(Console),
}

/// Arguments of `author console`.
#[derive(Debug, Args)]
struct Console {
    /// Port of this machine; default any that is free.
    #[arg(long)]
    port: Option<u16>,
    /// Open a browser.
    #[arg(long)]
    open: bool,
    /// Leave when standard input closes.
    #[arg(long, hide = true)]
    tied: bool,
}

impl Author {
    /// Whether this process is the child of another one that it leaves with.
    pub(super) const fn is_tied(&self) -> bool {
        matches!(self.what, What::Console(Console { tied: true, .. }))
    }

    pub(super) async fn act(&self, talk: &Printer) -> Outcome {
        let What::Console(Console { port, open, tied }) = &self.what;
        done(console::console(talk, &ConsoleOptions { port: *port, open: *open, tied: *tied }).await)
    }
}
