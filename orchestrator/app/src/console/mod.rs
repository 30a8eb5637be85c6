//! `author console`: a person answers what a language model would be asked, at a page in a browser.
//!
//! ```text
//! a run, or any program ──Chat Completions──► wire ──► desk ◄── door ◄── the page: prompt, picture, form, answer
//!                                              ▲────── answer or refusal ──────┘
//! ```
//!
//! One port of this machine alone. The page and what it reads need the token of its address; questions may be put by any program of
//! this machine, as to a model's server. What is kept of questions and answers is kept by whoever asks, as with any author.

mod desk;
mod door;
mod reply;
mod wire;

use std::sync::Arc;

use serde_json::json;
use tokio::time::Instant;

use crate::exit::Diagnostic;
use crate::loopback::Loopback;
use crate::output::Printer;
use crate::process::leave;
use desk::{Desk, News};
use door::{NAME, Shared};

/// How long a person may think: the longest time that a call can be given, s.
const THINK_S: u32 = 86_400;

/// Where the page is.
#[derive(Debug, Clone)]
pub struct ConsoleOptions {
    /// Port of this machine; none for any that is free.
    pub port: Option<u16>,
    /// Whether a browser is opened.
    pub open: bool,
    /// Leave when standard input closes.
    pub tied: bool,
}

/// Serves the page until it is told to leave.
///
/// # Errors
/// A [`Diagnostic`] where the port is taken, or no token can be drawn.
pub async fn console(talk: &Printer, options: &ConsoleOptions) -> Result<(), Diagnostic> {
    let loopback = Loopback::bind(options.port).await?;
    let (page, base, token) = (loopback.page(), format!("http://{}/v1", loopback.address), &loopback.token);
    let run = |author: &str| {
        format!(
            "socrates run my.toml --author {author} --set author.console.url={base} --set author.longest_s={THINK_S}"
        )
    };
    let (run, record) = (run(&format!("console:{NAME}")), run(&format!("record:tape=console:{NAME}")));
    talk.line(&format!("page       {page}"));
    talk.line(&format!("run        {run}"));
    talk.line(&format!("record     {record}"));
    talk.line(&format!("others     any program that speaks Chat Completions: base address {base}, no key, any model"));
    talk.line("The address of the page lets whoever has it answer. Ctrl-C ends; what waits is then asked again, or elsewhere.");
    talk.result(&json!({"page": page, "base": base, "run": run, "record": record, "token": token}));
    if options.open {
        loopback.open();
    }
    let (desk, mut news) = Desk::new(Instant::now());
    let shared = Arc::new(Shared { desk, rules: Arc::clone(&loopback.rules) });
    let served = loopback.serve(door::routes(shared));
    tokio::pin!(served);
    let mut leaves = leave(options.tied);
    loop {
        tokio::select! {
            () = &mut served => return Ok(()),
            _ = leaves.changed() => return Ok(()),
            Some(news) = news.recv() => tell(talk, &news),
        }
    }
}

/// Says on the terminal what happened, for those who do not look at the page.
fn tell(talk: &Printer, news: &News) {
    let News { number, form, what } = news;
    talk.warn(&format!("{what:<10} question {number}: {form}"));
}
