//! The page of a folder of bundles, filled from what lies in it.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;

use serde_json::json;
use socrates_draw::{BatchEntry, BatchPage, BatchRow};
use socrates_model::{Likeness, Location, Report, ScenarioId, Verdict};
use socrates_scoring::Pool;

use crate::batch_stats;
use crate::bundle::{self, Bundle};
use crate::exit::Complaint;
use crate::index::{self, Index, Scenario};
use crate::layout;
use crate::library_index;
use crate::output::Printer;
use crate::progress::Progress;

/// What the page shows.
#[derive(Debug)]
pub(crate) struct Found {
    /// Scenarios on the page.
    pub(crate) rows: usize,
    /// Those that repeat no earlier one.
    pub(crate) distinct: usize,
    /// Bundles that could not be read, and why.
    pub(crate) left_out: Vec<(String, String)>,
    /// What the planners did over all of them, or why that is not put together.
    pub(crate) figures: Result<Pool, Complaint>,
}

/// Names of the folders right below this one that hold a finished bundle, in order.
pub(crate) fn bundles(root: &Path) -> Result<Vec<String>, Complaint> {
    let entries = std::fs::read_dir(root).map_err(|why| {
        Complaint::input(
            format!("cannot read `{}`: {why}", root.display()),
            "name a bundle folder, or a folder that holds bundles",
        )
    })?;
    let names: BTreeSet<String> = entries
        .filter_map(Result::ok)
        .filter(|entry| entry.path().join(layout::MANIFEST.path).is_file())
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect();
    Ok(names.into_iter().collect())
}

/// What page, table and figures of a folder need of one bundle: all that is left of it once it is written or read.
#[derive(Debug, Clone)]
pub(crate) struct Card {
    /// Verdict of its first run.
    pub(crate) verdict: Verdict,
    /// What other scenarios are compared with.
    pub(crate) likeness: Likeness,
    id: ScenarioId,
    location: Arc<Location>,
    row: BatchRow,
    runs: index::Rows,
}

impl Card {
    /// The card of a bundle in a folder of this name, with the reports of all its runs and the recording of the first.
    pub(crate) fn of(
        bundle: &Bundle,
        location: Arc<Location>,
        name: &str,
        reports: &[Report],
    ) -> Result<Self, Complaint> {
        // Folders are unique where ids need not be.
        let id = ScenarioId::new(name).or_else(|_| ScenarioId::new(&bundle.manifest.scenario));
        let id = id.map_err(|bad| Complaint::input(bad.to_string(), "rename the folder"))?;
        let row = BatchRow::of(&BatchEntry {
            folder: name,
            scenario: &bundle.manifest.scenario,
            request: &bundle.request,
            reading_line: &socrates_offline::summary(&bundle.reading),
            location: &location,
            proposal: &bundle.proposal,
            paths: &bundle.paths,
            reports,
            recording: bundle.runs.first().map(|(recording, _)| recording),
        });
        let scenario = Scenario { request: bundle.manifest.request_name(), location: &location.name, path: name };
        let runs = index::Rows::of(scenario, reports, &bundle.manifest.failed);
        let likeness = Likeness::of(&bundle.proposal, &bundle.paths, &location);
        Ok(Self { verdict: bundle.manifest.verdict, likeness, id, location, row, runs })
    }

    /// The card of a bundle that was just written for a scenario.
    pub(crate) fn written(bundle: &Bundle, location: &Arc<Location>, id: &ScenarioId) -> Result<Self, Complaint> {
        let reports: Vec<Report> = bundle.runs.iter().map(|(_, report)| report.clone()).collect();
        Self::of(bundle, Arc::clone(location), id.as_str(), &reports)
    }

    /// The card of a bundle that lies in a folder of this name.
    pub(crate) fn read(root: &Path, name: &str) -> Result<Self, Complaint> {
        let dir = root.join(name);
        // One recording at a time: a library is larger than the memory of a laptop.
        let bundle = bundle::read_some(&dir, |index, _| index == 0)?;
        let reports = bundle::reports(&dir, &bundle.manifest)?;
        Self::of(&bundle, Arc::new(bundle.location.clone()), name, &reports)
    }
}

/// Writes `report.html`, `index.csv` and `planners.csv` into a folder of bundles: those its library lists first, in their order,
/// then the others. Bundles whose cards are not at hand are read.
pub(crate) fn write(talk: &Printer, root: &Path, mut cards: BTreeMap<String, Card>) -> Result<Found, Complaint> {
    let listed = library_index::read(root);
    let mut names: Vec<String> = Vec::new();
    let mut failed: Vec<library_index::Row> = Vec::new();
    // What a library lists was compared when it was made; what else lies in its folder is compared now.
    let mut repeated: BTreeMap<String, Option<ScenarioId>> = BTreeMap::new();
    let found = bundles(root)?;
    for row in listed.into_iter().flat_map(|library| library.scenarios) {
        let name = row.scenario.to_string();
        if found.contains(&name) {
            repeated.insert(name.clone(), row.repeats);
            names.push(name);
        } else {
            failed.push(row);
        }
    }
    let known: BTreeSet<String> = names.iter().cloned().collect();
    names.extend(found.into_iter().filter(|name| !known.contains(name)));
    if names.is_empty() && failed.is_empty() {
        return Err(none(root));
    }
    let (mut page, mut index, mut repeats) =
        (BatchPage::default(), Index::default(), library_index::Repeats::default());
    let mut left_out = Vec::new();
    let mut reports = Vec::new();
    let mut progress = Progress::new(*talk, "reading", names.len());
    for (done, name) in names.into_iter().enumerate() {
        progress.at(done, "");
        let card = cards.remove(&name).map_or_else(|| Card::read(root, &name), Ok);
        let repeat = |card: &Card, repeats: &mut library_index::Repeats| match repeated.get(&name) {
            Some(listed) => repeats.of_listed(&card.id, card.likeness.clone(), listed.as_ref(), |earlier| {
                repeated.contains_key(earlier.as_str())
            }),
            None => repeats.of(&card.id, card.likeness.clone()),
        };
        let added = card.and_then(|card| {
            let earlier = repeat(&card, &mut repeats);
            add(&mut page, &mut index, earlier.as_ref(), card, root, &name)
        });
        match added {
            // What repeats another scenario is no evidence of its own.
            Ok(Some(found)) => reports.push((name, found)),
            Ok(None) => {}
            Err(why) => {
                page.add_failed(&name, &why.what, None);
                index.add_failed(Scenario { request: "", location: "", path: &name }, &why.what, false);
                left_out.push((name, why.what));
            }
        }
    }
    drop(progress);
    let figures = batch_stats::of(&reports);
    match &figures {
        Ok(pool) => {
            page.tell(batch_stats::table(pool));
            crate::files::write(&root.join(batch_stats::FILE), pool.csv().as_bytes())?;
        }
        Err(why) => {
            page.tell_none(&why.what);
            // A table of an earlier time would tell of other runs.
            drop(std::fs::remove_file(root.join(batch_stats::FILE)));
        }
    }
    for row in &failed {
        let why = if row.reason.is_empty() { "no bundle could be made" } else { &row.reason };
        let earlier = row.repeats.as_ref().map(ScenarioId::as_str);
        page.add_failed(row.scenario.as_str(), why, earlier);
        index.add_failed(Scenario { request: &row.request, location: "", path: "" }, why, earlier.is_some());
    }
    index.write(root)?;
    let title = root.canonicalize().ok().and_then(|path| Some(path.file_name()?.to_string_lossy().into_owned()));
    let html = page.html(&title.unwrap_or_else(|| "Scenarios".to_owned()));
    crate::files::write(&root.join(layout::PAGE.path), html.as_bytes())?;
    Ok(Found { rows: page.len(), distinct: page.distinct(), left_out, figures })
}

/// Writes page and tables of a folder of bundles and tells what is in it.
pub(crate) fn report(talk: &Printer, root: &Path) -> Result<(), Complaint> {
    let found = write(talk, root, BTreeMap::new())?;
    let page = root.join(layout::PAGE.path);
    let repeats = found.rows - found.distinct;
    let of_them = if repeats > 0 {
        format!(" · {} distinct, {repeats} repeat one of them", found.distinct)
    } else {
        String::new()
    };
    talk.line(&format!("scenarios  {}{of_them}", found.rows));
    for (name, why) in &found.left_out {
        talk.line(&format!("left out   {name}: {why}"));
    }
    if let Ok(pool) = &found.figures {
        batch_stats::print(talk, pool);
    }
    talk.line(&format!("table      {}", root.join(index::FILE).display()));
    talk.line(&format!("look       {}", page.display()));
    let left_out: Vec<_> = found.left_out.iter().map(|(name, why)| json!({ "name": name, "why": why })).collect();
    let figures = found.figures.as_ref().ok().map(batch_stats::result);
    talk.result(&json!({
        "page": page.display().to_string(), "scenarios": found.rows, "distinct": found.distinct, "left_out": left_out, "figures": figures,
    }));
    found.figures.map(|_| ())
}

/// Adds a bundle to page and table and hands back its reports; none where it repeats an earlier one.
fn add(
    page: &mut BatchPage,
    index: &mut Index,
    earlier: Option<&ScenarioId>,
    card: Card,
    root: &Path,
    name: &str,
) -> Result<Option<Vec<Report>>, Complaint> {
    index.add(card.runs, earlier.is_some());
    page.add(card.row, &card.location, earlier.map(ScenarioId::as_str));
    if earlier.is_some() {
        return Ok(None);
    }
    bundle::reports_in(&root.join(name)).map(Some)
}

/// What is said of a folder without bundles.
pub(crate) fn none(dir: &Path) -> Complaint {
    Complaint::input(
        format!("`{}` is no bundle and holds none", dir.display()),
        "name the folder that `socrates run` printed after `look`",
    )
}
