//! `library merge`: the shards of a batch become the library that one run would have made.
//!
//! ```text
//! folders ─► shards, each once, of one batch, all of them ─► bundles checked and copied ─► list, page and tables as after a run
//! ```

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use socrates_model::ScenarioEnd;

use crate::batch::Card;
use crate::exit::{Code, Diagnostic};
use crate::folder::Hold;
use crate::kept::Lines;
use crate::library_index::{self, Library, Part, Row};
use crate::many::{self, Ended};
use crate::output::Printer;
use crate::place::{self, Place, WORK};
use crate::progress::Progress;
use crate::run_options::Require;
use crate::shard::Shard;
use crate::words::plural;
use crate::{bundle, cores};

/// What helps with a shard that has changed.
const AGAIN: &str = "its files were changed by hand: make the shard again in an empty folder";
/// Shards that are named one by one where several lack.
const NAMED: usize = 12;

/// How shards are put together.
#[derive(Debug, Clone)]
pub struct MergeOptions {
    /// Folders of shards, or folders that hold such folders.
    pub shards: Vec<PathBuf>,
    /// Folder of the library.
    pub out: PathBuf,
    /// Whether bundles are moved out of the shards instead of copied.
    pub moves: bool,
}

/// One finished shard.
#[derive(Debug)]
struct Found {
    folder: PathBuf,
    part: Part,
    library: Library,
}

/// A scenario of the whole batch and the shard that made it.
#[derive(Debug)]
struct Piece<'a> {
    row: &'a Row,
    from: &'a Path,
}

/// Puts shards together.
///
/// # Errors
/// A shard that lacks, is unfinished, is there twice or is of another batch; a bundle that is damaged; a folder that cannot be written.
pub fn merge(talk: &Printer, options: &MergeOptions) -> Result<Code, Diagnostic> {
    let shards = found(&options.shards)?;
    let shards = complete(shards)?;
    let Some(first) = shards.first() else { return Err(none(&options.shards)) };
    let (wish, of) = (first.part.whole, first.part.shard.of());
    let pieces = pieces(&shards)?;
    talk.line(&format!("shards     {of} · {}", plural(pieces.len(), "scenario")));
    let root = match place::place(&options.out, wish, false) {
        Place::Finished(root) => {
            talk.line(&format!("known      {} was put together from these shards; nothing to do", root.display()));
            return many::finish(talk, Require::Any, &root, &[]);
        }
        Place::New(root) => place::told(talk, &options.out, root),
    };
    let work = place::claim(&root, wish)?;
    let hold = Hold::take(&work)?;
    shards.iter().try_for_each(|one| Lines::of(&work).adopt(&one.folder))?;
    let mut progress = Progress::new(*talk, "merging", pieces.len());
    let mut done = 0;
    let came = cores::each(
        pieces.len(),
        |number| pieces.get(number).map(|piece| piece.bring(&root, &work, options.moves)),
        &mut |_| {
            done += 1;
            progress.at(done, "");
        },
    );
    drop(progress);
    hold.check()?;
    let made = pieces.iter().zip(came.into_iter().flatten()).map(|(piece, what)| ended(piece.row, what));
    let made = made.collect::<Result<Vec<Ended>, Diagnostic>>()?;
    let keeps = |one: &Found| one.library.keep;
    let keep = keeps(first).filter(|keep| shards.iter().all(|one| keeps(one) == Some(*keep)));
    let list = Library::new(wish, None, keep, pieces.len(), first.library.readings.clone());
    many::write(talk, &root, &work, list, made)?;
    drop(std::fs::remove_dir_all(&work));
    many::finish(talk, Require::Any, &root, &[])
}

/// What became of a scenario. That a shard could not make it is no fault of the merge; that its bundle cannot be brought is.
fn ended(row: &Row, what: Result<Option<Card>, Diagnostic>) -> Result<Ended, Diagnostic> {
    let what = what?.ok_or_else(|| Diagnostic::input(row.reason.clone(), ""));
    Ok(Ended { scenario: row.scenario.clone(), request: row.request.clone(), what })
}

impl Piece<'_> {
    /// Brings the bundle into the library and hands back its card; none where the scenario failed.
    fn bring(&self, root: &Path, work: &Path, moves: bool) -> Result<Option<Card>, Diagnostic> {
        if self.row.verdict == ScenarioEnd::Failed {
            let dead = |library: &Path| library.join(bundle::dead::FOLDER).join(self.row.scenario.as_str());
            bundle::copy_dead(&dead(self.from), &dead(root), work)?;
            return Ok(None);
        }
        if self.row.bundle.is_empty() {
            let gone =
                || Diagnostic::input(format!("`{}` has lost `{}`", self.from.display(), self.row.scenario), AGAIN);
            let (kept, location) = Lines::of(work).get(&self.row.scenario).ok_or_else(gone)?;
            return Ok(Some(Card::kept(kept, Arc::new(location))));
        }
        let name = self.row.scenario.as_str();
        let (from, to) = (self.from.join(name), root.join(name));
        if !bundle::is_bundle(&to) {
            if moves && bundle::moved(&from, &to) {
                bundle::whole(&to)?;
            } else {
                bundle::copy(&from, &to, work)?;
            }
        }
        Card::read(root, name).map(Some)
    }
}

/// The scenarios of all shards in the order of the whole batch.
fn pieces(shards: &[Found]) -> Result<Vec<Piece<'_>>, Diagnostic> {
    let whole: usize = shards.iter().map(|one| one.library.scenarios.len()).sum();
    for one in shards {
        let (has, wants) = (one.library.scenarios.len(), one.part.shard.share(whole));
        if has != wants || u64::try_from(has).ok() != Some(one.library.count) {
            let what = format!(
                "shard {} in `{}` lists {has} scenarios; {wants} are its share",
                one.part.shard,
                one.folder.display()
            );
            return Err(Diagnostic::input(what, AGAIN));
        }
    }
    let mut rows: Vec<_> = shards.iter().map(|one| (one.folder.as_path(), one.library.scenarios.iter())).collect();
    let mut pieces = Vec::with_capacity(whole);
    // Shards stand in order, and each holds every so-manyth scenario in order.
    while pieces.len() < whole {
        for (from, rows) in &mut rows {
            pieces.extend(rows.next().map(|row| Piece { row, from }));
        }
    }
    Ok(pieces)
}

/// Every shard of these folders, in the order of their names.
fn found(folders: &[PathBuf]) -> Result<Vec<Found>, Diagnostic> {
    let mut shards = Vec::new();
    for folder in folders {
        if let Some(one) = shard_in(folder)? {
            shards.push(one);
            continue;
        }
        let entries = std::fs::read_dir(folder).map_err(|why| {
            Diagnostic::input(format!("cannot read `{}`: {why}", folder.display()), "name the folders of the shards")
        })?;
        let mut inside: Vec<PathBuf> =
            entries.filter_map(Result::ok).map(|entry| entry.path()).filter(|path| path.is_dir()).collect();
        inside.sort();
        let before = shards.len();
        for path in inside {
            shards.extend(shard_in(&path)?);
        }
        if shards.len() == before {
            return Err(none(std::slice::from_ref(folder)));
        }
    }
    Ok(shards)
}

/// The shard in a folder; none where there is none.
fn shard_in(folder: &Path) -> Result<Option<Found>, Diagnostic> {
    let list = folder.join(library_index::FILE);
    if !list.is_file() {
        if folder.join(WORK).is_dir() {
            let what = format!("`{}` holds something that is not finished", folder.display());
            return Err(Diagnostic::input(what, "run the command that makes it again: it goes on where it was"));
        }
        return Ok(None);
    }
    let library = library_index::read_whole(folder)?;
    match library.shard {
        Some(part) => Ok(Some(Found { folder: folder.to_path_buf(), part, library })),
        None => Ok(None),
    }
}

fn none(folders: &[PathBuf]) -> Diagnostic {
    let names: Vec<String> = folders.iter().map(|folder| format!("`{}`", folder.display())).collect();
    Diagnostic::input(
        format!("no shard lies in {}", names.join(", ")),
        "`socrates run REQUESTS --variants 100 --shard 0/8 --out shards/0` makes the first of eight",
    )
}

/// The shards in their order, when they are all shards of one batch, each once.
fn complete(mut shards: Vec<Found>) -> Result<Vec<Found>, Diagnostic> {
    let Some(first) = shards.first() else { return Ok(shards) };
    let alike = |one: &Found| one.part.whole == first.part.whole && one.part.shard.of() == first.part.shard.of();
    if let Some(other) = shards.iter().find(|one| !alike(one)) {
        let what = format!(
            "`{}` (shard {} of batch {}) and `{}` (shard {} of batch {}) are not of one batch",
            first.folder.display(),
            first.part.shard,
            first.part.whole.short(),
            other.folder.display(),
            other.part.shard,
            other.part.whole.short(),
        );
        return Err(Diagnostic::input(
            what,
            "the same requests, options and program make the shards of one batch; `--shard` alone differs",
        ));
    }
    let mut by_index: BTreeMap<u32, &Found> = BTreeMap::new();
    for one in &shards {
        if let Some(other) = by_index.insert(one.part.shard.index(), one) {
            let (a, b) = (other.folder.display(), one.folder.display());
            let what = format!("shard {} is there twice: in `{a}` and in `{b}`", one.part.shard);
            return Err(Diagnostic::input(what, "name each shard once"));
        }
    }
    let of = first.part.shard;
    let missing: Vec<Shard> =
        (0..of.of()).filter(|index| !by_index.contains_key(index)).map(|index| of.beside(index)).collect();
    if !missing.is_empty() {
        let mut named: Vec<String> = missing.iter().take(NAMED).map(Shard::to_string).collect();
        if missing.len() > NAMED {
            named.push("…".to_owned());
        }
        let what = format!("{} of {} shards are missing: {}", missing.len(), of.of(), named.join(", "));
        let again = missing.first().map_or_else(String::new, Shard::to_string);
        return Err(Diagnostic::input(
            what,
            format!("make them with the same command and `--shard {again}`, then merge again"),
        ));
    }
    if let Some(other) = shards.iter().find(|one| one.library.readings != first.library.readings) {
        let (a, b) = (first.folder.display(), other.folder.display());
        let what = format!("the requests were read differently in `{a}` and `{b}`");
        return Err(Diagnostic::input(what, "make them again with one version of the program"));
    }
    shards.sort_by_key(|one| one.part.shard.index());
    Ok(shards)
}

#[cfg(test)]
mod tests {
    use socrates_model::Digest;

    use super::*;

    fn shard(root: &Path, name: &str, shard: &str, whole: &str, rows: &[&str]) -> PathBuf {
        let folder = root.join(name);
        std::fs::create_dir_all(&folder).unwrap();
        let row = |id: &&str| Row {
            scenario: socrates_model::ScenarioId::new(*id).unwrap(),
            request: "hall".to_owned(),
            bundle: (*id).to_owned(),
            verdict: ScenarioEnd::Failed,
            reason: "no way".to_owned(),
            repeats: None,
        };
        let part = Part { shard: shard.parse().unwrap(), whole: Digest::of(whole.as_bytes()) };
        let library = Library {
            wish: Digest::of(format!("{whole} {shard}").as_bytes()),
            shard: Some(part),
            keep: None,
            count: u64::try_from(rows.len()).unwrap(),
            readings: Vec::new(),
            scenarios: rows.iter().map(row).collect(),
        };
        library_index::write(&folder, &library).unwrap();
        folder
    }

    fn merged(shards: &[PathBuf]) -> Result<Vec<String>, Diagnostic> {
        let shards = complete(found(shards)?)?;
        Ok(pieces(&shards)?.iter().map(|piece| piece.row.scenario.to_string()).collect())
    }

    #[test]
    fn scenarios_stand_in_the_order_of_the_whole_batch() {
        let root = tempfile::tempdir().unwrap();
        let at = root.path();
        shard(at, "c", "2/3", "w", &["s2"]);
        shard(at, "a", "0/3", "w", &["s0", "s3"]);
        shard(at, "b", "1/3", "w", &["s1", "s4"]);
        assert_eq!(merged(&[at.to_path_buf()]).unwrap(), ["s0", "s1", "s2", "s3", "s4"]);
    }

    #[test]
    fn a_shard_that_lacks_is_there_twice_or_belongs_elsewhere_is_named() {
        let root = tempfile::tempdir().unwrap();
        let at = root.path();
        let zero = shard(at, "zero", "0/3", "w", &["s0"]);
        let again = shard(at, "again", "0/3", "w", &["s0"]);
        let other = shard(at, "other", "1/3", "v", &["s1"]);
        let why = merged(std::slice::from_ref(&zero)).unwrap_err();
        assert!(
            why.what.contains("2 of 3") && why.what.contains("1/3, 2/3") && why.hint.contains("--shard 1/3"),
            "{why}"
        );
        let why = merged(&[zero.clone(), again]).unwrap_err();
        assert!(why.what.contains("twice") && why.what.contains("again"), "{why}");
        let why = merged(&[zero.clone(), other]).unwrap_err();
        assert!(why.what.contains("not of one batch") && why.what.contains("other"), "{why}");
        let open = at.join("open");
        std::fs::create_dir_all(open.join(WORK)).unwrap();
        let why = merged(&[zero, open]).unwrap_err();
        assert!(why.what.contains("not finished") && why.hint.contains("goes on"), "{why}");
        assert!(merged(&[at.join("nowhere")]).unwrap_err().what.contains("nowhere"));
    }

    #[test]
    fn a_list_that_was_shortened_by_hand_is_refused() {
        let root = tempfile::tempdir().unwrap();
        let at = root.path();
        shard(at, "a", "0/2", "w", &["s0", "s2"]);
        shard(at, "b", "1/2", "w", &[]);
        let why = merged(&[at.to_path_buf()]).unwrap_err();
        assert!(why.what.contains("lists") && why.what.contains("share"), "{why}");
    }
}
