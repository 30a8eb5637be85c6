//! `library coverage`: what a library holds of what can be asked for, and what it lacks, from its table alone.

use std::path::{Path, PathBuf};

use crate::coverage::Coverage;
use crate::exit::{Code, Diagnostic};
use crate::files;
use crate::output::Printer;
use crate::query;

/// What is asked.
#[derive(Debug, Clone)]
pub struct CoverageOptions {
    /// Folder of the library.
    pub library: PathBuf,
    /// A table of every cell (CSV); none writes none.
    pub out: Option<PathBuf>,
}

/// Prints what a library covers; with `out`, writes every cell as a table too.
///
/// # Errors
/// A folder without a table, a table that cannot be read, a file that cannot be written or is no `.csv`.
pub fn coverage(talk: &Printer, options: &CoverageOptions) -> Result<Code, Diagnostic> {
    if let Some(out) = options.out.as_deref().filter(|out| out.extension().is_none_or(|ending| ending != "csv")) {
        let what = format!("cannot write `{}`: coverage is written as CSV", out.display());
        return Err(Diagnostic::input(what, "--out coverage.csv; `--format json` prints it for programs"));
    }
    let table = query::table(&options.library)?;
    let coverage = Coverage::of(&table);
    coverage.lines().iter().for_each(|line| talk.line(line));
    if crate::index::COVERED.iter().any(|name| table.column(name).is_none()) {
        talk.warn(&format!(
            "\nhint: the table is of an earlier version, which did not say all of it; `socrates library gallery {}` writes it anew",
            files::shell(&options.library)
        ));
    }
    if let Some(out) = &options.out {
        write(talk, out, &coverage)?;
    }
    talk.result(&coverage.object());
    Ok(Code::Ok)
}

fn write(talk: &Printer, out: &Path, coverage: &Coverage) -> Result<(), Diagnostic> {
    files::write(out, coverage.csv().as_bytes())?;
    talk.line("");
    talk.line(&format!("wrote      {}", out.display()));
    Ok(())
}
