//! `labels`: pages on which people, blind judges or observers say what they see of the runs of bundles, and what came of it.
//!
//! ```text
//! bundles ─┬─► page                                         ─► a table of answers ─► `dev agreement`
//!          ├─► blind: page, stills, texts, protocol, key.csv ─► tables of answers ─► compare
//!          ├─► observe: page with sliders, beliefs, pairs; key  ─► tables of answers ─► observed
//!          └─► opinion: a vision model is asked, table of facts ─► with tables of blind judges ─► calibrate
//! ```

mod answers;
mod blind;
mod calibrate;
mod compare;
mod door;
mod key;
mod observe;
mod observed;
mod opinion;
mod share;
mod task;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde_json::json;
use socrates_draw::{Asks, LabelPage, Labeled};
use socrates_model::form::{Form, PlaceWord, RobotStep};
use socrates_model::request::RobotGesture;
use socrates_model::{Recording, Request, ScenarioId, Verdict};

pub use self::blind::Blind;
pub use self::calibrate::{CalibrateOptions, calibrate};
pub use self::compare::{CompareOptions, compare};
pub use self::observe::{ObserveOptions, observe};
pub use self::observed::{ObservedOptions, observed};
pub use self::opinion::{OpinionOptions, opinion};
use crate::batch;
use crate::bundle;
use crate::exit::Diagnostic;
use crate::output::Printer;
use crate::progress::Progress;

/// More runs than anybody labels in one sitting, and than a browser opens at once.
const MOST: usize = 500;

/// What `labels page` is given.
#[derive(Debug, Clone)]
pub struct PageOptions {
    /// Bundles, or folders of bundles.
    pub bundles: Vec<PathBuf>,
    /// File of the page.
    pub out: PathBuf,
    /// Only the first run of each bundle.
    pub first: bool,
    /// Heading of the page.
    pub title: String,
    /// A page for blind judges.
    pub blind: Option<Blind>,
}

/// Does `labels page`.
pub fn page(talk: &Printer, options: &PageOptions) -> Result<(), Diagnostic> {
    if let Some(blind) = &options.blind {
        return blind::page(talk, options, blind);
    }
    let mut page = LabelPage::asking(Asks::Qualities);
    let dirs = folders(&options.bundles)?;
    let names = names(&dirs)?;
    let mut shown: Vec<String> = Vec::new();
    let mut progress = Progress::new(*talk, "reading", dirs.len());
    for (index, (dir, names)) in dirs.iter().zip(&names).enumerate() {
        progress.at(index, "");
        let bundle = bundle::read_some(dir, |index, _| !options.first || index == 0)?;
        let all: Vec<&Recording> = bundle.runs.iter().map(|(recording, _)| recording).collect();
        let (location, paths) = (&bundle.location, &bundle.paths);
        let mut texts = texts(&bundle.request);
        let about = if location.description.is_empty() { "" } else { ": " };
        texts.push(("Location", format!("{}{about}{}", location.name, location.description)));
        for (recording, report) in &bundle.runs {
            // Without the robot there is nothing to label: the twin run only serves comparison.
            if report.planner.is_no_robot() {
                continue;
            }
            let run = report.run.to_string();
            let name = names.get(&run).unwrap_or(&run);
            page.add(&Labeled { name, texts: &texts, location, paths, all: &all, recording });
            shown.push(name.clone());
        }
        if page.len() > MOST {
            return Err(too_many(page.len()));
        }
    }
    drop(progress);
    if page.is_empty() {
        return Err(Diagnostic::input("the bundles hold no run with a robot", "`socrates run` makes one"));
    }
    crate::files::write(&options.out, page.html(&options.title).as_bytes())?;
    talk.line(&format!("wrote      {} · {} runs", options.out.display(), page.len()));
    talk.result(&json!({ "page": options.out.display().to_string(), "runs": shown }));
    Ok(())
}

fn too_many(runs: usize) -> Diagnostic {
    Diagnostic::input(
        format!("`{runs}` runs are too many for one page"),
        format!("at most {MOST}; --first takes one run of each bundle, or name fewer bundles"),
    )
}

/// What a request asks for, text by text: what it is, and its words. A form is told in its own lines.
fn texts(request: &Request) -> Vec<(&'static str, String)> {
    let form = form_lines(request);
    let rough = request.rough_scenario.as_deref().map(str::trim).filter(|text| !text.is_empty());
    let asked = rough.unwrap_or(if form.is_empty() { "nothing in particular" } else { "" });
    [
        ("Social context", request.social_context.trim().to_owned()),
        ("Task of the robot", request.task.trim().to_owned()),
        ("Asked for", asked.to_owned()),
        ("Form", form),
    ]
    .into_iter()
    .filter(|(_, text)| !text.is_empty())
    .collect()
}

/// The part of a form about the robot.
#[derive(Serialize)]
struct RobotLines<'a> {
    #[serde(skip_serializing_if = "Option::is_none")]
    start: Option<&'a PlaceWord>,
    #[serde(skip_serializing_if = "Option::is_none")]
    goal: Option<&'a PlaceWord>,
    #[serde(skip_serializing_if = "Option::is_none")]
    via: Option<&'a PlaceWord>,
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    does: &'a [RobotStep],
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    gestures: &'a [RobotGesture],
}

/// A form as it is written: people, groups, orders and the robot's part; nothing where nothing is stated.
#[derive(Serialize)]
struct FormLines<'a> {
    #[serde(flatten)]
    form: &'a Form,
    robot: RobotLines<'a>,
}

fn form_lines(request: &Request) -> String {
    let robot = &request.robot;
    let (start, goal, via) = (robot.start.as_ref(), robot.goal.as_ref(), robot.via.as_ref());
    let robot = RobotLines { start, goal, via, does: &robot.does, gestures: &robot.gestures };
    let Ok(toml::Value::Table(tables)) = toml::Value::try_from(FormLines { form: &request.form, robot }) else {
        return String::new();
    };
    let mut lines: Vec<String> = Vec::new();
    for (key, value) in &tables {
        let one = || (format!("[{key}]"), vec![value]);
        let (head, items) = value.as_array().map_or_else(one, |items| (format!("[[{key}]]"), items.iter().collect()));
        for table in items.into_iter().filter_map(toml::Value::as_table).filter(|table| !table.is_empty()) {
            lines.push(head.clone());
            lines.extend(table.iter().map(|(key, value)| format!("{key} = {value}")));
        }
    }
    lines.join("\n")
}

/// Whether a verdict says that what was asked happened.
pub(crate) const fn meets(verdict: Verdict) -> bool {
    matches!(verdict, Verdict::Realised | Verdict::RealisedLate)
}

/// A coefficient, if there is one.
pub(crate) fn shown(value: Option<f64>) -> String {
    value.map_or_else(|| "n/a".to_owned(), |value| format!("{value:.3}"))
}

/// What the runs of each of these bundles are called where all of them are looked at together: by their own names where no other
/// run has the same, else with as much of the folder before it as tells them apart, `library-2/x-1:x-1.reference-1`.
pub(crate) fn names(dirs: &[PathBuf]) -> Result<Vec<BTreeMap<String, String>>, Diagnostic> {
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
pub(crate) fn folders(named: &[PathBuf]) -> Result<Vec<PathBuf>, Diagnostic> {
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

    #[test]
    fn a_form_is_told_in_its_own_lines_and_planner_and_seeds_are_no_part_of_it() {
        let text = "location = \"hospital\"\nsocial_context = \"\"\ntask = \"Take the elevator\"\n\
                    [[human]]\ncount = 2\nrelation = \"leaving\"\nplace = \"elevator\"\n\
                    does = [{ when = { robot_visible = 5.0 }, act = \"look_at_robot\", for_s = 8 }]\n\
                    [[order]]\nfirst = \"human_1\"\nthen = \"robot\"\n\
                    [robot]\nplanners = [\"reference\"]\ngoal = \"elevator\"\n[run]\nseeds = \"90417\"\n";
        let request = Request::of_toml(text, None).unwrap();
        let told = texts(&request);
        assert_eq!(told[0], ("Task of the robot", "Take the elevator".to_owned()));
        assert_eq!((told.len(), told[1].0), (2, "Form"));
        for line in ["[[human]]", "count = 2", "place = \"elevator\"", "[[order]]", "first = \"human_1\"", "[robot]"] {
            assert!(told[1].1.lines().any(|found| found == line), "{line}: {}", told[1].1);
        }
        assert!(told[1].1.contains("robot_visible = 5.0") && told[1].1.contains("for_s = 8.0"), "{}", told[1].1);
        assert!(!told[1].1.contains("reference") && !told[1].1.contains("90417"), "{}", told[1].1);
    }

    #[test]
    fn a_request_of_texts_has_no_form_and_an_unguided_one_asks_for_nothing() {
        let text = "location = \"office\"\nsocial_context = \"An office\"\ntask = \"Deliver mail\"\n";
        let told = |more: &str| texts(&Request::of_toml(&format!("{text}{more}"), None).unwrap());
        assert_eq!(told("")[2], ("Asked for", "nothing in particular".to_owned()));
        assert_eq!(told("rough_scenario = \"They pass.\"\n").last().unwrap().1, "They pass.");
    }
}
