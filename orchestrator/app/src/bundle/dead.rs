//! What is left of a scenario that could not be made: enough to see why, and to make the same again with one command.
//!
//! ```text
//! failed/NAME/   request.toml   details/location/…   details/provenance.json   why.txt
//! ```

use std::collections::BTreeMap;
use std::path::Path;

use super::beside::Beside;
use super::{Past, Writer, pretty, provenance, put_request};
use crate::exit::Diagnostic;
use crate::files::shell;
use crate::layout;
use crate::prepare::Prepared;

/// Folder of a library that holds them, each called like its scenario.
pub(crate) const FOLDER: &str = "failed";
/// File that says why, and what makes it again.
const WHY: &str = "why.txt";

/// Writes what is left of a scenario into the folder of this library, and says in a line where. The folder is there whole or not at all.
pub(crate) fn write(
    library: &Path,
    prepared: &Prepared,
    seed: u64,
    past: &Past<'_>,
    why: &Diagnostic,
) -> Result<(), Diagnostic> {
    let name = past.status.id.as_str();
    let folder = library.join(FOLDER).join(name);
    let beside = Beside::new(past.work, &format!("{FOLDER}-{name}"))?;
    let mut out = Writer { dir: beside.0.clone(), files: BTreeMap::new() };
    put_request(&mut out, prepared)?;
    out.put(&layout::PROVENANCE, &"", pretty(&provenance(prepared, seed, past))?.as_bytes())?;
    crate::files::write(&beside.0.join(WHY), told(&folder, prepared, seed, why).as_bytes())?;
    // One of an earlier time goes: it is the same scenario.
    if folder.exists() {
        std::fs::remove_dir_all(&folder).map_err(|why| {
            Diagnostic::input(format!("cannot write `{}`: {why}", folder.display()), "--out chooses another folder")
        })?;
    }
    beside.appear(&folder)
}

fn told(folder: &Path, prepared: &Prepared, seed: u64, why: &Diagnostic) -> String {
    let rates: Vec<String> = prepared
        .injected
        .iter()
        .map(|(name, rate)| format!("{}={rate}", name.strip_prefix("fault.").unwrap_or(name)))
        .collect();
    let inject = if rates.is_empty() { String::new() } else { format!(" --inject {}", rates.join(",")) };
    format!(
        "{why}\n\nThe same again, on this machine, with the author that was asked:\n\n    socrates run {} --seed {seed} --variants 1 --author {}{inject}\n\n\
         What was asked, answered and found wrong stands in {}.\n",
        shell(&folder.join(layout::REQUEST.path)),
        shell(Path::new(&prepared.author.to_string())),
        layout::PROVENANCE.path,
    )
}
