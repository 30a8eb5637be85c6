//! `fsck`: whether a job store, its artifacts and the bundles that were made from it agree with each other.
//!
//! ```text
//! folder ─┬─► job store ─► its tables by rules ─► artifacts by length and digest
//!         └─► bundles ─► files by digest ─► scenarios of the list and of the store
//! ```
//!
//! Everything is only read: it may be asked while an orchestrator works on the store, and after a kill -9.

use std::collections::{BTreeMap, BTreeSet};
use std::error::Error as _;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use socrates_kit::LocalBlobs;
use socrates_model::{Digest, ScenarioEnd};
use socrates_store::{Audit, Checked, Counts, Named, Stands, StoreError, audit};

use crate::bundle::Manifest;
use crate::exit::{Code, Diagnostic};
use crate::library_index::{self, Library};
use crate::output::Printer;
use crate::progress::Progress;
use crate::words::plural;
use crate::{batch, bundle, cores, kept, place, work};

/// What may be named.
const HINT: &str = "name the folder of `cluster up --dir`, a library, the folder of a run, or its `.socrates`";

/// What lies in a folder.
#[derive(Debug)]
struct Found {
    /// Where the job store and the artifacts are.
    work: Option<PathBuf>,
    /// Finished bundles.
    bundles: Vec<PathBuf>,
    /// The list of the library.
    listed: Option<Library>,
    /// Scenarios whose bundles the library does not keep, by the file that holds their reports.
    kept: BTreeSet<String>,
}

/// A store with what was found of it.
#[derive(Debug)]
struct Store {
    file: PathBuf,
    counts: Counts,
    checked: Vec<Checked>,
    scenarios: Vec<Stands>,
}

/// Checks job stores, artifacts and bundles; bundles are held against all stores that are named beside them. Exits with 2 where something is
/// wrong.
///
/// # Errors
/// A folder that holds neither, and a store that cannot be read or was written by a newer program.
pub fn fsck(talk: &Printer, folders: &[PathBuf]) -> Result<Code, Diagnostic> {
    let found = folders.iter().map(|folder| found(folder)).collect::<Result<Vec<_>, _>>()?;
    let works: BTreeSet<&PathBuf> = found.iter().filter_map(|found| found.work.as_ref()).collect();
    let stores = works.into_iter().map(|work| store(talk, work)).collect::<Result<Vec<_>, _>>()?;
    let mut checked: Vec<Checked> = Vec::new();
    for store in &stores {
        talk.line(&format!("store      {}", store.file.display()));
        talk.line(&format!("holds      {}", told(&store.counts)));
        checked.extend(store.checked.iter().cloned());
    }
    let scenarios: Vec<&Stands> = stores.iter().flat_map(|store| &store.scenarios).collect();
    let known = (!stores.is_empty()).then_some(scenarios.as_slice());
    let mut bundles = 0;
    for found in found.iter().filter(|found| !found.bundles.is_empty() || found.listed.is_some()) {
        bundles += found.bundles.len();
        checked.extend(shelf(talk, found, known));
    }
    for one in &checked {
        talk.line(&format!("checked    {:>8} · {}", one.looked_at, one.about));
        for wrong in &one.wrong {
            talk.line(&format!("wrong      {wrong}"));
        }
    }
    let wrong: Vec<&String> = checked.iter().flat_map(|one| &one.wrong).collect();
    talk.line(&match wrong.len() {
        0 => "sound      nothing is wrong".to_owned(),
        count => format!("found      {count} wrong"),
    });
    talk.result(&json!({
        "sound": wrong.is_empty(), "wrong": wrong, "checked": checked, "bundles": bundles,
        "stores": stores.iter().map(of_store).collect::<Vec<_>>(),
    }));
    Ok(if wrong.is_empty() { Code::Ok } else { Code::Input })
}

fn told(counts: &Counts) -> String {
    format!(
        "{} scenarios, {} ended, {} of them failed · {} jobs · {} attempts, {} lost with their worker · {} results, {} taken over · \
         {} dead letters · {} entries of the outbox · {} tokens · {} reigns",
        counts.scenarios,
        counts.ended,
        counts.failed,
        counts.jobs,
        counts.attempts,
        counts.lapsed,
        counts.results,
        counts.taken_over,
        counts.dead,
        counts.outbox,
        counts.tokens,
        counts.reigns
    )
}

fn of_store(store: &Store) -> Value {
    json!({ "store": store.file.display().to_string(), "counts": store.counts })
}

/// What lies in a folder; it must be something.
fn found(folder: &Path) -> Result<Found, Diagnostic> {
    let shown = folder.display();
    if !folder.is_dir() {
        let what = if folder.exists() { "is no folder" } else { "is not there" };
        return Err(Diagnostic::input(format!("`{shown}` {what}"), HINT));
    }
    let places = [folder.to_path_buf(), folder.join(place::WORK)];
    let work = places.into_iter().find(|work| work::store(work).exists());
    let root = match folder.parent() {
        // What is made lies around its work folder.
        Some(root) if folder.file_name().is_some_and(|name| name == place::WORK) => {
            if root.as_os_str().is_empty() {
                Path::new(".")
            } else {
                root
            }
        }
        Some(_) | None => folder,
    };
    let bundles = if bundle::is_bundle(root) {
        vec![root.to_path_buf()]
    } else {
        batch::bundles(root)?.into_iter().map(|name| root.join(name)).collect()
    };
    let listed = if root.join(library_index::FILE).is_file() { Some(library_index::read_whole(root)?) } else { None };
    if work.is_none() && bundles.is_empty() && listed.is_none() {
        return Err(Diagnostic::input(format!("`{shown}` holds neither a job store nor a bundle"), HINT));
    }
    let kept = kept::names(root)?;
    Ok(Found { work, bundles, listed, kept })
}

/// Audits the store of a work folder and looks for its artifacts.
fn store(talk: &Printer, work: &Path) -> Result<Store, Diagnostic> {
    let file = work::store(work);
    let Audit { counts, mut checked, named, scenarios } = audit(&file).map_err(|why| unread(&file, &why))?;
    checked.push(artifacts(talk, &work::blobs(work), &named));
    Ok(Store { file, counts, checked, scenarios })
}

/// What is said of a store that cannot be audited.
fn unread(file: &Path, why: &StoreError) -> Diagnostic {
    let hint = match why {
        StoreError::Newer { .. } => "use the program that wrote it, or a newer one",
        StoreError::Locked { .. } => "the same command again, once the other process is done",
        StoreError::Unwritable { .. } => "it belongs to another user, or the disk is not there",
        StoreError::Stranger { .. }
        | StoreError::Full { .. }
        | StoreError::Row { .. }
        | StoreError::SecondResult { .. }
        | StoreError::Sqlite { .. } => {
            "the file is no job store of this program, or damaged beyond reading: put back a copy of it"
        }
    };
    let mut diagnostic = Diagnostic::input(format!("the job store `{}` cannot be read", file.display()), hint);
    diagnostic.causes.push(why.to_string());
    diagnostic.causes.extend(why.source().map(ToString::to_string));
    diagnostic
}

/// Whether every artifact that the store names is there, with the length and the content that its name says.
fn artifacts(talk: &Printer, blobs: &LocalBlobs, named: &[Named]) -> Checked {
    // What many rows name is read once.
    let distinct: BTreeMap<(&str, Option<u64>), &Named> =
        named.iter().map(|named| ((named.digest.as_str(), named.len), named)).collect();
    let distinct: Vec<&Named> = distinct.into_values().collect();
    let mut progress = Progress::new(*talk, "checking", distinct.len());
    let mut done = 0;
    let one = |number: usize| distinct.get(number).and_then(|named| lacks(blobs, named));
    let looked = cores::each(distinct.len(), one, &mut |_| {
        done += 1;
        progress.at(done, "");
    });
    let mut checked =
        about("artifact", "every artifact that the store names is there, with its length and its content");
    checked.looked_at = count(distinct.len());
    checked.wrong = looked.into_iter().flatten().collect();
    checked
}

/// What is wrong with an artifact, if anything is. It is read beside the folder's own door, which would put a torn one aside.
fn lacks(blobs: &LocalBlobs, named: &Named) -> Option<String> {
    let Named { by, digest: name, len, kept } = named;
    let Ok(digest) = name.parse::<Digest>() else {
        return Some(format!("{by} names `{name}`, which is no content address"));
    };
    let bytes = match std::fs::read(blobs.path(&digest)) {
        Ok(bytes) => bytes,
        Err(why) if why.kind() == std::io::ErrorKind::NotFound && *kept => return None,
        Err(why) => return Some(format!("{by} names the artifact `{name}`, which cannot be read: {why}")),
    };
    let found = count(bytes.len());
    if len.is_some_and(|len| len != found) {
        return Some(format!(
            "{by} names the artifact `{name}` of {} bytes, which has {found}",
            len.unwrap_or_default()
        ));
    }
    let content = Digest::of(&bytes);
    (content != digest).then(|| format!("{by} names the artifact `{name}`, whose content has the digest `{content}`"))
}

/// Checks the bundles of a folder: by themselves, against its list, and against the scenarios of the stores where there are any.
fn shelf(talk: &Printer, found: &Found, stores: Option<&[&Stands]>) -> Vec<Checked> {
    let mut progress = Progress::new(*talk, "checking", found.bundles.len());
    let mut done = 0;
    let one = |number: usize| found.bundles.get(number).and_then(|dir| damaged(dir));
    let looked = cores::each(found.bundles.len(), one, &mut |_| {
        done += 1;
        progress.at(done, "");
    });
    drop(progress);
    let mut files = about("bundle-files", "every file of a bundle is as it was written");
    files.looked_at = count(found.bundles.len());
    files.wrong = looked.into_iter().flatten().collect();
    let made: Vec<(&Path, Manifest)> =
        found.bundles.iter().filter_map(|dir| Some((dir.as_path(), bundle::manifest(dir)?))).collect();
    let mut checked = vec![files, once(&made)];
    checked.extend(stores.map(|stores| judged(&made, stores)));
    if let Some(list) = &found.listed {
        checked.push(listed(&made, &found.kept, list));
        checked.extend(
            stores.filter(|stores| list.count == count(stores.len())).map(|stores| written(&made, &found.kept, stores)),
        );
    }
    checked
}

fn damaged(dir: &Path) -> Option<String> {
    match bundle::damaged(dir) {
        Ok(files) if files.is_empty() => None,
        Ok(files) => Some(format!("the bundle `{}` is not as it was written: {}", dir.display(), files.join(", "))),
        Err(why) => Some(format!("the bundle `{}` cannot be looked at: {}", dir.display(), why.short())),
    }
}

fn once(made: &[(&Path, Manifest)]) -> Checked {
    let mut checked = about("bundle-once", "no scenario has two bundles");
    let mut dirs: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for (dir, manifest) in made {
        dirs.entry(&manifest.scenario).or_default().push(format!("`{}`", dir.display()));
    }
    checked.looked_at = count(dirs.len());
    let several = dirs.iter().filter(|(_, dirs)| dirs.len() > 1);
    checked.wrong = several
        .map(|(scenario, dirs)| {
            format!("scenario `{scenario}` has {}: {}", plural(dirs.len(), "bundle"), dirs.join(", "))
        })
        .collect();
    checked
}

/// Whether the stores know of each bundle.
fn judged(made: &[(&Path, Manifest)], stores: &[&Stands]) -> Checked {
    let mut checked = about("bundle-store", "a bundle is of a scenario that the store has judged, with its verdict");
    let known: BTreeMap<&str, &&Stands> = stores.iter().map(|stands| (stands.scenario.as_str(), stands)).collect();
    checked.looked_at = count(made.len());
    let wrong = |(dir, manifest): &(&Path, Manifest)| {
        let (dir, scenario, verdict) = (dir.display(), &manifest.scenario, manifest.verdict);
        let Some(stands) = known.get(scenario.as_str()) else {
            return Some(format!("the bundle `{dir}` is of scenario `{scenario}`, which the store does not know"));
        };
        if !stands.scored {
            return Some(format!(
                "the bundle `{dir}` is of scenario `{scenario}`, of which the store has no judged run"
            ));
        }
        let other = stands.end.and_then(ScenarioEnd::verdict).filter(|judged| *judged != verdict)?;
        Some(format!(
            "the bundle `{dir}` says `{verdict}`, and the store that scenario `{scenario}` ended as `{other}`"
        ))
    };
    checked.wrong = made.iter().filter_map(wrong).collect();
    checked
}

/// Whether the list and the bundles of a library say the same.
fn listed(made: &[(&Path, Manifest)], kept: &BTreeSet<String>, list: &Library) -> Checked {
    let mut checked =
        about("library", "every scenario of the list is listed once, and its bundle is there with its verdict");
    let by_scenario: BTreeMap<&str, &Manifest> =
        made.iter().map(|(_, manifest)| (manifest.scenario.as_str(), manifest)).collect();
    let mut seen = BTreeSet::new();
    checked.looked_at = count(list.scenarios.len());
    for row in &list.scenarios {
        let (scenario, verdict) = (&row.scenario, row.verdict);
        if !seen.insert(scenario) {
            checked.wrong.push(format!("the list names scenario `{scenario}` twice"));
        }
        match by_scenario.get(scenario.as_str()) {
            // What a library does not keep has its line elsewhere.
            None if row.bundle.is_empty() && kept.contains(scenario.as_str()) => {}
            None if verdict != ScenarioEnd::Failed => {
                checked
                    .wrong
                    .push(format!("scenario `{scenario}` is listed as `{verdict}`, and its bundle is not there"));
            }
            Some(manifest) if ScenarioEnd::Judged(manifest.verdict) != verdict => {
                let says = manifest.verdict;
                checked
                    .wrong
                    .push(format!("scenario `{scenario}` is listed as `{verdict}`, and its bundle says `{says}`"));
            }
            Some(_) | None => {}
        }
    }
    if count(list.scenarios.len()) > list.count {
        checked.wrong.push(format!(
            "the list has {} scenarios, and {} were asked for",
            list.scenarios.len(),
            list.count
        ));
    }
    checked
}

/// Whether every scenario that was judged has its bundle, in a library whose list is written.
fn written(made: &[(&Path, Manifest)], kept: &BTreeSet<String>, stores: &[&Stands]) -> Checked {
    let mut checked = about("library-store", "every scenario that the store has judged has its bundle");
    let bundled = made.iter().map(|(_, manifest)| manifest.scenario.as_str());
    let there: BTreeSet<&str> = bundled.chain(kept.iter().map(String::as_str)).collect();
    let judged = stores.iter().filter(|stands| stands.end.and_then(ScenarioEnd::verdict).is_some());
    for stands in judged {
        checked.looked_at += 1;
        if !there.contains(stands.scenario.as_str()) {
            checked.wrong.push(format!("scenario `{}` was judged, and its bundle is not there", stands.scenario));
        }
    }
    checked
}

fn about(rule: &'static str, about: &'static str) -> Checked {
    Checked { rule, about, looked_at: 0, wrong: Vec::new() }
}

fn count(of: usize) -> u64 {
    u64::try_from(of).unwrap_or(u64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::Format;

    fn refused(folder: &Path) -> Diagnostic {
        fsck(&Printer::to_nobody(Format::Text), &[folder.to_path_buf()]).unwrap_err()
    }

    #[test]
    fn a_folder_without_store_and_bundles_is_refused_with_what_may_be_named() {
        let folder = tempfile::tempdir().unwrap();
        let why = refused(folder.path());
        assert!(
            why.what.contains("neither a job store nor a bundle") && why.hint.contains("cluster up --dir"),
            "{why}"
        );
        assert!(refused(&folder.path().join("none")).what.ends_with("is not there"));
        std::fs::write(folder.path().join("file"), "").unwrap();
        assert!(refused(&folder.path().join("file")).what.ends_with("is no folder"));
        std::fs::write(work::store(folder.path()), vec![7_u8; 4096]).unwrap();
        let why = refused(folder.path());
        assert!(why.what.contains("jobs.sqlite") && why.hint.contains("no job store"), "{why}");
        assert_eq!(why.code, Code::Input);
    }

    #[test]
    fn an_artifact_is_missing_short_torn_or_kept_as_a_text() {
        let folder = tempfile::tempdir().unwrap();
        let blobs = work::blobs(folder.path());
        let digest = blobs.put(b"hello").unwrap();
        let named =
            |len: Option<u64>, kept: bool| Named { by: "a result".to_owned(), digest: digest.to_string(), len, kept };
        assert_eq!((lacks(&blobs, &named(Some(5), false)), lacks(&blobs, &named(None, false))), (None, None));
        assert!(lacks(&blobs, &named(Some(6), false)).unwrap().contains("of 6 bytes, which has 5"));
        std::fs::write(blobs.path(&digest), "hellx").unwrap();
        assert!(lacks(&blobs, &named(Some(5), true)).unwrap().contains("whose content has the digest"));
        assert!(blobs.path(&digest).exists(), "a look puts nothing aside");
        std::fs::remove_file(blobs.path(&digest)).unwrap();
        assert!(lacks(&blobs, &named(Some(5), false)).unwrap().contains("cannot be read"));
        assert_eq!(lacks(&blobs, &named(Some(5), true)), None, "the next orchestrator puts it back");
        let odd = Named { digest: "x".to_owned(), ..named(None, false) };
        assert!(lacks(&blobs, &odd).unwrap().contains("no content address"));
    }
}
