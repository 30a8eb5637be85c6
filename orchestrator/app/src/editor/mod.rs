//! `map edit`: the scene graph and the doors of a location, drawn at a page in a browser.
//!
//! ```text
//! files ─► site ─► board: sketch, history, saved ◄── door ◄── the page: map in tiles, tools, findings, way
//!                    │                                │
//!                    └─► journal: each edit on disk   └─► socrates_edit: checks, openings, ways; walk: one person
//! ```
//!
//! One port of this machine alone, with a token. The page draws and asks; whatever is worked out or checked is worked out here, by the code
//! that reads locations. Files are written when the person says so, and never over what another program wrote meanwhile.

mod board;
mod door;
mod journal;
mod page;
mod site;
mod walk;

#[cfg(test)]
mod tests;

use std::path::PathBuf;
use std::sync::{Arc, Mutex};

use serde_json::json;

use crate::exit::Diagnostic;
use crate::folder::{Hold, HoldFor};
use crate::loopback::Loopback;
use crate::output::Printer;
use crate::process::leave;
use board::{Board, Checker};
use door::Shared;
use journal::Journal;
use site::{Site, WORK};

/// What the folder is held for.
const EDITING: HoldFor = HoldFor {
    doing: "being edited",
    instead: "draw at its page or end it (Ctrl-C), look at the location with `--read-only`, or edit a copy with `--out`",
    elsewhere: "`--out` edits a copy in another folder, `--read-only` only looks",
};

/// What is edited, and how.
#[derive(Debug, Clone)]
pub struct EditOptions {
    /// A shipped name, a folder, or a map file.
    pub location: String,
    /// Folder of a copy; none to edit a folder where it is.
    pub out: Option<PathBuf>,
    /// Whether nothing may be changed.
    pub read_only: bool,
    /// Whether a journal of before is put aside.
    pub fresh: bool,
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
/// A [`Diagnostic`] where there is no map, files or journal cannot be read, or somebody else edits the folder.
pub async fn edit(talk: &Printer, options: &EditOptions) -> Result<(), Diagnostic> {
    let site = Site::of(&options.location, options.out.as_deref())?;
    let folder = site.folder.clone();
    let work = folder.join(WORK);
    let mut hold = if options.read_only { None } else { Some(Hold::take_for(&work, EDITING)?) };
    if options.fresh
        && hold.is_some()
        && let Some(aside) = Journal::put_aside(&work)?
    {
        talk.line(&format!("journal    put aside as {}", aside.display()));
    }
    let (board, map) = Board::lay(site, options.read_only)?;
    let loopback = Loopback::bind(options.port).await?;
    if let Some(hold) = hold.as_mut() {
        // Only words for those who come later.
        drop(hold.tell(&format!(", with a page at http://{}/", loopback.address)));
    }
    for note in &board.notes {
        talk.line(&format!("note       {note}"));
    }
    let page = loopback.page();
    talk.line(&format!("page       {page}"));
    let keeps = if options.read_only { "is looked at; nothing is changed" } else { "is where Save writes" };
    talk.line(&format!("folder     {} {keeps}", folder.display()));
    talk.line("The address of the page lets whoever has it draw. Ctrl-C ends; what is drawn and not saved is there again next time.");
    talk.result(
        &json!({"page": page, "token": loopback.token, "folder": folder.display().to_string(), "notes": board.notes,
        "read_only": options.read_only}),
    );
    if options.open {
        loopback.open();
    }
    let shared = Arc::new(Shared { board: Mutex::new(board), checker: Checker::new(&map), map });
    let rules = Arc::clone(&loopback.rules);
    let mut leaves = leave(options.tied);
    tokio::select! {
        () = loopback.serve(door::routes(shared, rules)) => {}
        _ = leaves.changed() => {}
    }
    Ok(())
}
