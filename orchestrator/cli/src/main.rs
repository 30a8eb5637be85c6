//! SocRATES on the command line: the one program, from `demo` to the processes of a cluster.
//!
//! ```text
//! arguments, environment ─► a verb of `verbs` ─► what it does (`socrates-app`) ─► screen, exit code
//! ```
//!
//! *Never here:* a rule of authoring, simulation, scoring or retry. Only here: the environment, arguments,
//! printing and exit codes.

#[cfg(test)]
mod build_id;
mod log;
mod screen;
mod verbs;

use std::pin::Pin;
use std::process::ExitCode;
use std::time::Duration;

use clap::Parser as _;
use socrates_app::config::{Config, Program};
use socrates_app::exit::{Code, Diagnostic};
use socrates_app::output::{self, Printer};

use crate::verbs::{Cli, Format};

/// The id of this build, which tells two builds of one version apart: a digest of sources, toolchain and settings.
const BUILD_ID: &str = env!("SOCRATES_BUILD_ID");

fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(why) => {
            drop(why.print());
            return ExitCode::from(if why.use_stderr() { Code::Input as u8 } else { Code::Ok as u8 });
        }
    };
    let talk = screen::talk(match cli.format {
        Format::Text => output::Format::Text,
        Format::Json => output::Format::Json,
    });
    let code = match begin(&talk, &cli) {
        Ok(code) => code,
        // A child tells its supervisor, who tells the person once.
        Err(diagnostic) if cli.verb.is_tied() => {
            talk.last_word(&diagnostic.object());
            if diagnostic.code == Code::Input { Code::Stuck } else { diagnostic.code }
        }
        Err(diagnostic) => {
            // Leaving on purpose is no error.
            let word = if diagnostic.code == Code::Waits { "" } else { "error: " };
            talk.warn(&format!("{word}{diagnostic}"));
            talk.result(&diagnostic.object());
            diagnostic.code
        }
    };
    ExitCode::from(code as u8)
}

fn begin(talk: &Printer, cli: &Cli) -> Result<Code, Diagnostic> {
    let config = Config::load(cli.flags.config.as_deref(), std::env::vars(), &cli.flags.all())?.of(Program {
        file: std::env::current_exe().ok(),
        build: BUILD_ID.to_owned(),
        temp: std::env::temp_dir(),
    });
    log::start(&config)?;
    let talk = &talk.with_pause(Duration::from_secs(config.number("log.progress_s")));
    let runtime =
        tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build().map_err(|why| {
            Diagnostic::input(format!("no threads can be started: {why}"), "`socrates doctor`").with_code(Code::Ours)
        })?;
    // Boxed: the runtime's loops would else each hold the code of all verbs.
    let work: Pin<Box<dyn Future<Output = _> + '_>> = Box::pin(cli.verb.act(talk, &config));
    let code = runtime.block_on(work);
    // A blocked reader of a child's pipe must not hold the exit.
    runtime.shutdown_background();
    code
}
