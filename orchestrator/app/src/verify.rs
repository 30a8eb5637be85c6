//! `library verify`: whether every file of every bundle is as it was written, and every scenario of the list is there.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use serde_json::json;
use socrates_model::ScenarioEnd;

use crate::exit::{Code, Diagnostic};
use crate::output::Printer;
use crate::progress::Progress;
use crate::words::plural;
use crate::{batch, bundle, cores, kept, library_index};

/// What is wrong with a bundle.
#[derive(Debug, PartialEq, Eq)]
enum Wrong {
    /// These files are gone or not as written.
    Files(Vec<String>),
    /// It is listed and not there.
    Gone,
    /// It cannot be looked at.
    Unread(String),
}

impl Wrong {
    fn told(&self) -> String {
        match self {
            Self::Files(files) => format!("not as written: {}", files.join(", ")),
            Self::Gone => "listed, and not there".to_owned(),
            Self::Unread(why) => why.clone(),
        }
    }
}

/// Checks bundles and libraries. Exits with 2 where something is wrong.
///
/// # Errors
/// A folder that holds no bundle, or cannot be read.
pub fn verify(talk: &Printer, folders: &[PathBuf]) -> Result<Code, Diagnostic> {
    let (mut there, mut gone, mut lines): (Vec<PathBuf>, Vec<PathBuf>, usize) = (Vec::new(), Vec::new(), 0);
    for folder in folders {
        if bundle::is_bundle(folder) {
            there.push(folder.clone());
            continue;
        }
        let found = of_library(folder)?;
        let listed = folder.join(library_index::FILE).is_file();
        if found.there.is_empty() && found.gone.is_empty() && found.lines == 0 && !listed {
            return Err(batch::none(folder));
        }
        there.extend(found.there);
        gone.extend(found.gone);
        lines += found.lines;
    }
    let mut progress = Progress::new(*talk, "checking", there.len());
    let mut done = 0;
    let looked = cores::each(there.len(), |number| there.get(number).and_then(|dir| wrong(dir)), &mut |_| {
        done += 1;
        progress.at(done, "");
    });
    drop(progress);
    let damaged = there.iter().zip(looked).filter_map(|(dir, wrong)| Some((dir, wrong?)));
    let found: Vec<(&PathBuf, Wrong)> = damaged.chain(gone.iter().map(|dir| (dir, Wrong::Gone))).collect();
    for (dir, wrong) in &found {
        talk.line(&format!("wrong      {}: {}", dir.display(), wrong.told()));
    }
    let count = there.len() + gone.len();
    let without = if lines > 0 { format!(" and {} without one", plural(lines, "scenario")) } else { String::new() };
    talk.line(&format!("checked    {}{without} · {} wrong", plural(count, "bundle"), found.len()));
    if !found.is_empty() {
        talk.line("next       remove what is wrong and run the command that made it again: it makes what lacks");
    }
    let listed =
        |(dir, wrong): &(&PathBuf, Wrong)| json!({ "bundle": dir.display().to_string(), "wrong": wrong.told() });
    talk.result(&json!({ "checked": count, "without": lines, "wrong": found.iter().map(listed).collect::<Vec<_>>() }));
    Ok(if found.is_empty() { Code::Ok } else { Code::Input })
}

/// What a library holds.
struct Holds {
    /// Its bundles.
    there: Vec<PathBuf>,
    /// Those that its list names and that are not there.
    gone: Vec<PathBuf>,
    /// Scenarios whose bundles it does not keep; their lines were read.
    lines: usize,
}

fn of_library(root: &Path) -> Result<Holds, Diagnostic> {
    let found: BTreeSet<String> = batch::bundles(root)?.into_iter().collect();
    let listed = if root.join(library_index::FILE).is_file() { Some(library_index::read_whole(root)?) } else { None };
    let rows = listed.into_iter().flat_map(|library| library.scenarios);
    let kept = kept::names(root)?;
    let made = rows.filter(|row| row.verdict != ScenarioEnd::Failed);
    let there = |row: &library_index::Row| {
        let name = row.scenario.as_str();
        found.contains(name) || row.bundle.is_empty() && kept.contains(name)
    };
    let gone = made.filter(|row| !there(row)).map(|row| root.join(row.scenario.as_str())).collect();
    Ok(Holds { there: found.iter().map(|name| root.join(name)).collect(), gone, lines: kept.len() })
}

fn wrong(dir: &Path) -> Option<Wrong> {
    match bundle::damaged(dir) {
        Ok(files) if files.is_empty() => None,
        Ok(files) => Some(Wrong::Files(files)),
        Err(why) => Some(Wrong::Unread(why.short())),
    }
}
