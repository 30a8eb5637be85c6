//! `labels page`: a page on which people label the runs of bundles by hand.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use serde_json::json;
use socrates_draw::LabelPage;
use socrates_model::{Recording, ScenarioId};

use crate::batch;
use crate::bundle;
use crate::exit::Complaint;
use crate::output::Printer;
use crate::progress::Progress;

/// More runs than anybody labels in one sitting, and than a browser opens at once.
const MOST: usize = 500;

/// Does a verb of `labels`.
pub fn page(talk: &Printer, bundles: &[PathBuf], out: &Path, first: bool, title: &str) -> Result<(), Complaint> {
    let mut page = LabelPage::default();
    let dirs = folders(bundles)?;
    let names = names(&dirs)?;
    let mut shown: Vec<String> = Vec::new();
    let mut progress = Progress::new(*talk, "reading", dirs.len());
    for (index, (dir, names)) in dirs.iter().zip(&names).enumerate() {
        progress.at(index, "");
        let bundle = bundle::read_some(dir, |index, _| !first || index == 0)?;
        let all: Vec<&Recording> = bundle.runs.iter().map(|(recording, _)| recording).collect();
        for (recording, report) in &bundle.runs {
            // Without the robot there is nothing to label: the twin run only serves comparison.
            if report.planner.is_no_robot() {
                continue;
            }
            let run = report.run.to_string();
            let name = names.get(&run).unwrap_or(&run);
            page.add(name, &bundle.request, &bundle.location, &bundle.paths, &all, recording);
            shown.push(name.clone());
        }
        if page.len() > MOST {
            return Err(Complaint::input(
                format!("`{}` runs are too many for one page", page.len()),
                format!("at most {MOST}; --first takes one run of each bundle, or name fewer bundles"),
            ));
        }
    }
    drop(progress);
    if page.is_empty() {
        return Err(Complaint::input("the bundles hold no run with a robot", "`socrates run` makes one"));
    }
    crate::files::write(out, page.html(title).as_bytes())?;
    talk.line(&format!("wrote      {} · {} runs", out.display(), page.len()));
    talk.result(&json!({ "page": out.display().to_string(), "runs": shown }));
    Ok(())
}

/// What the runs of each of these bundles are called where all of them are looked at together: by their own names where no other
/// run has the same, else with as much of the folder before it as tells them apart, `library-2/x-1:x-1.reference-1`.
pub(crate) fn names(dirs: &[PathBuf]) -> Result<Vec<BTreeMap<String, String>>, Complaint> {
    let mut runs: Vec<Vec<String>> = Vec::new();
    for dir in dirs {
        let manifest = bundle::manifest(dir).ok_or_else(|| batch::none(dir))?;
        let scenario = ScenarioId::new(&manifest.scenario).map_err(|_damaged| batch::none(dir))?;
        let run = |entry: &bundle::RunEntry| entry.run().id(&scenario).to_string();
        runs.push(manifest.runs.iter().map(run).collect());
    }
    let whole: Vec<Vec<String>> = dirs.iter().map(|dir| chunks(dir)).collect();
    Ok(apart(&whole, &runs))
}

/// The names of the folders on the way to one, the last first; what `..` and links mean is settled.
fn chunks(dir: &Path) -> Vec<String> {
    let dir = dir.canonicalize().unwrap_or_else(|_why| dir.to_path_buf());
    let mut chunks: Vec<String> =
        dir.components().map(|part| part.as_os_str().to_string_lossy().into_owned()).collect();
    chunks.reverse();
    chunks
}

/// Names that tell the runs of these folders apart. The same folder named twice is the same folder.
fn apart(folders: &[Vec<String>], runs: &[Vec<String>]) -> Vec<BTreeMap<String, String>> {
    let named = |folder: usize, run: &String| {
        let own: &[String] = folders.get(folder).map_or(&[], Vec::as_slice);
        let same: Vec<&Vec<String>> = folders
            .iter()
            .zip(runs)
            .filter(|(other, runs)| other.as_slice() != own && runs.contains(run))
            .map(|(other, _)| other)
            .collect();
        if same.is_empty() {
            return run.clone();
        }
        // As few folders as no other of them ends with.
        let shared = |other: &Vec<String>| other.iter().zip(own).take_while(|(a, b)| a == b).count();
        let depth = same.iter().map(|other| shared(other)).max().unwrap_or(0) + 1;
        let mut way: Vec<&str> = own.iter().take(depth).map(String::as_str).collect();
        way.reverse();
        format!("{}:{run}", way.join("/"))
    };
    runs.iter()
        .enumerate()
        .map(|(folder, runs)| runs.iter().map(|run| (run.clone(), named(folder, run))).collect())
        .collect()
}

/// Every bundle that is meant: a bundle itself, or those right below a folder.
pub(crate) fn folders(named: &[PathBuf]) -> Result<Vec<PathBuf>, Complaint> {
    let mut found = Vec::new();
    for dir in named {
        if bundle::manifest(dir).is_some() {
            found.push(dir.clone());
            continue;
        }
        let names = batch::bundles(dir)?;
        if names.is_empty() {
            return Err(batch::none(dir));
        }
        found.extend(names.iter().map(|name| dir.join(name)));
    }
    // A folder and a bundle in it mean the bundle once.
    let mut seen = BTreeSet::new();
    found.retain(|dir| seen.insert(dir.canonicalize().unwrap_or_else(|_why| dir.clone())));
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_of_one_name_are_told_apart_by_as_few_folders_as_it_takes() {
        let folder = |way: &str| way.rsplit('/').map(str::to_owned).collect::<Vec<_>>();
        let folders = [folder("a/lib-1/x-1"), folder("a/lib-2/x-1"), folder("a/x-1-2"), folder("a/y")];
        let run = |name: &str| vec![format!("{name}.reference-1")];
        let runs = [run("x-1"), run("x-1"), run("x-1"), run("y")];
        let named: Vec<String> = apart(&folders, &runs).into_iter().flat_map(BTreeMap::into_values).collect();
        let told = ["lib-1/x-1:x-1.reference-1", "lib-2/x-1:x-1.reference-1", "x-1-2:x-1.reference-1", "y.reference-1"];
        assert_eq!(named, told);
    }
}
