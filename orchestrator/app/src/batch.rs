//! The page of a folder of bundles, filled from what lies in it.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;

use serde_json::json;
use socrates_draw::{BatchEntry, BatchPage, BatchRow, Lies};
use socrates_model::{Likeness, Location, Report, ScenarioId, Verdict};
use socrates_scoring::Pool;
use socrates_stream::csv::Table;

use crate::batch_stats;
use crate::bundle::{self, Bundle};
use crate::coverage::Coverage;
use crate::encounters;
use crate::exit::Diagnostic;
use crate::index::{self, Index, IndexedScenario, Traits};
use crate::keep::{Form, Keep};
use crate::kept::{self, Kept, Lines};
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
    pub(crate) figures: Result<Pool, Diagnostic>,
}

/// Names of the finished bundles right below this folder, in order, without the ending of those that are packed.
pub(crate) fn bundles(root: &Path) -> Result<Vec<String>, Diagnostic> {
    let entries = std::fs::read_dir(root).map_err(|why| {
        Diagnostic::input(
            format!("cannot read `{}`: {why}", root.display()),
            "name a bundle folder, or a folder that holds bundles",
        )
    })?;
    let name = |entry: std::fs::DirEntry| {
        let name = entry.file_name().to_string_lossy().into_owned();
        if entry.path().join(layout::MANIFEST.path).is_file() {
            return Some(name);
        }
        name.strip_suffix(bundle::PACKED).filter(|_| entry.path().is_file()).map(str::to_owned)
    };
    let names: BTreeSet<String> = entries.filter_map(Result::ok).filter_map(name).collect();
    Ok(names.into_iter().collect())
}

/// The form of the bundle of this name in a folder.
pub(crate) fn form(root: &Path, name: &str) -> Form {
    match (root.join(name).is_dir(), bundle::archive(&root.join(name))) {
        (true, _) => Form::Folder,
        (false, Some(_)) => Form::Packed,
        (false, None) => Form::Nothing,
    }
}

/// Where a bundle of this name and form lies, from the library; empty where it was not kept.
pub(crate) fn lies(name: &str, form: Form) -> String {
    match form {
        Form::Folder => name.to_owned(),
        Form::Packed => format!("{name}{}", bundle::PACKED),
        Form::Nothing => String::new(),
    }
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
    form: Form,
    /// What figures need of its reports; none where they are kept elsewhere until all are made.
    reports: Vec<Report>,
}

impl Card {
    /// The card of a bundle of this name and form, with the reports of all its runs and the recording of the first.
    pub(crate) fn of(
        bundle: &Bundle,
        location: Arc<Location>,
        name: &str,
        form: Form,
        reports: &[Report],
    ) -> Result<Self, Diagnostic> {
        let path = lies(name, form);
        // Folders are unique where ids need not be.
        let id = ScenarioId::new(name).or_else(|_| ScenarioId::new(&bundle.manifest.scenario));
        let id = id.map_err(|bad| Diagnostic::input(bad.to_string(), "rename the folder"))?;
        let row = BatchRow::of(&BatchEntry {
            lies: match form {
                Form::Folder => Lies::Folder(&path),
                Form::Packed => Lies::File(&path),
                Form::Nothing => Lies::Nowhere,
            },
            scenario: &bundle.manifest.scenario,
            request: &bundle.request,
            reading_line: &socrates_offline::summary(&bundle.reading),
            location: &location,
            proposal: &bundle.proposal,
            paths: &bundle.paths,
            reports,
            recording: bundle.runs.first().map(|(recording, _)| recording),
        });
        let scenario = IndexedScenario {
            id: id.as_str(),
            request: bundle.manifest.request_name(),
            location: &location.name,
            path: &path,
            traits: Some(&traits(bundle, &location)),
        };
        let runs = index::Rows::of(scenario, reports, &bundle.manifest.failed);
        let likeness = Likeness::of(&bundle.proposal, &bundle.paths, &location);
        let reports = reports.iter().map(counted).collect();
        Ok(Self { verdict: bundle.manifest.verdict, likeness, id, location, row, runs, form, reports })
    }

    /// The card of a bundle that was just made for a scenario. Where the bundle is not kept, its line is written.
    pub(crate) fn written(
        bundle: &Bundle,
        location: &Arc<Location>,
        id: &ScenarioId,
        keep: Keep,
        lines: &Lines,
    ) -> Result<Self, Diagnostic> {
        let reports: Vec<Report> = bundle.runs.iter().map(|(_, report)| report.clone()).collect();
        let form = keep.form(bundle.manifest.verdict);
        let mut card = Self::of(bundle, Arc::clone(location), id.as_str(), form, &reports)?;
        if form == Form::Nothing {
            card.reports.clear();
            let told = (card.likeness.clone(), card.row.clone(), card.runs.clone());
            lines.put(&Kept::new(card.id.clone(), card.verdict, location, told, reports), location)?;
        }
        Ok(card)
    }

    /// The card of a scenario whose bundle was not kept.
    pub(crate) fn kept(kept: Kept, location: Arc<Location>) -> Self {
        let Kept { scenario: id, verdict, likeness, row, runs, reports, .. } = kept;
        let reports = reports.iter().map(counted).collect();
        Self { verdict, likeness, id, location, row, runs, form: Form::Nothing, reports }
    }

    /// Where its bundle lies, from the library; empty where it was not kept.
    pub(crate) fn lies(&self) -> String {
        lies(self.id.as_str(), self.form)
    }

    /// The card of a bundle of this name.
    pub(crate) fn read(root: &Path, name: &str) -> Result<Self, Diagnostic> {
        let dir = root.join(name);
        // One recording at a time: a library is larger than the memory of a laptop.
        let (bundle, reports) = bundle::read_with_reports(&dir, |index, _| index == 0)?;
        Self::of(&bundle, Arc::new(bundle.location.clone()), name, form(root, name), &reports)
    }
}

/// What a bundle's scenario is, for the table.
fn traits(bundle: &Bundle, location: &Location) -> Traits {
    let Bundle { request, proposal, paths, .. } = bundle;
    let encounters: Vec<&str> =
        encounters::sectors(proposal, paths, location).into_iter().map(encounters::Sector::name).collect();
    Traits {
        pattern: proposal.pattern.clone(),
        place: proposal.place.name().to_owned(),
        people: proposal.humans.len(),
        encounters: encounters.join(" "),
        context: request.social_context.clone(),
    }
}

/// What a folder of bundles holds, in the order in which it is told.
struct Holds {
    /// Scenarios with a bundle, or whose bundles the library did not keep.
    made: Vec<Held>,
    /// Scenarios of the list that have none.
    failed: Vec<library_index::Row>,
    /// What a library lists was compared when it was made; what else lies in its folder is compared when it is told.
    repeated: BTreeMap<String, Option<ScenarioId>>,
}

/// A scenario that was made.
struct Held {
    name: String,
    /// Whether its bundle was kept.
    bundled: bool,
}

impl Holds {
    fn of(root: &Path) -> Result<Self, Diagnostic> {
        let found: BTreeSet<String> = bundles(root)?.into_iter().collect();
        let mut holds = Self { made: Vec::new(), failed: Vec::new(), repeated: BTreeMap::new() };
        let library = library_index::read(root);
        let kept: BTreeSet<ScenarioId> = library.iter().flat_map(|library| library.unbundled().cloned()).collect();
        for row in library.into_iter().flat_map(|library| library.scenarios) {
            let name = row.scenario.to_string();
            let bundled = found.contains(&name);
            if bundled || kept.contains(&row.scenario) {
                holds.repeated.insert(name.clone(), row.repeats);
                holds.made.push(Held { name, bundled });
            } else {
                holds.failed.push(row);
            }
        }
        let others = found.into_iter().filter(|name| !holds.repeated.contains_key(name));
        let others: Vec<Held> = others.map(|name| Held { name, bundled: true }).collect();
        holds.made.extend(others);
        if holds.made.is_empty() && holds.failed.is_empty() { Err(none(root)) } else { Ok(holds) }
    }

    /// The earlier scenario that one repeats.
    fn earlier(&self, name: &str, card: &Card, repeats: &mut library_index::Repeats) -> Option<ScenarioId> {
        match self.repeated.get(name) {
            Some(listed) => repeats.of_listed(&card.id, card.likeness.clone(), listed.as_ref(), |earlier| {
                self.repeated.contains_key(earlier.as_str())
            }),
            None => repeats.of(&card.id, card.likeness.clone()),
        }
    }
}

/// Cards and reports of a folder, one scenario after another in the order of its list.
struct Source<'a> {
    root: &'a Path,
    /// Cards that are at hand.
    cards: BTreeMap<String, Card>,
    /// Scenarios without bundles, from the first to the last.
    kept: Option<kept::Reader>,
}

impl Source<'_> {
    /// The card of a scenario.
    fn next(&mut self, held: &Held) -> Result<Card, Diagnostic> {
        let name = &held.name;
        if held.bundled {
            return self.cards.remove(name).map_or_else(|| Card::read(self.root, name), Ok);
        }
        let reader = match &mut self.kept {
            Some(reader) => reader,
            none => none.insert(kept::Reader::open(self.root)?),
        };
        let (kept, location) = reader.next()?.filter(|(kept, _)| kept.scenario.as_str() == name).ok_or_else(|| {
            let what = format!("`{}` does not hold `{name}` in its place", self.root.join(kept::FILE).display());
            Diagnostic::input(what, "list and file are of two libraries: make the library again in an empty folder")
        })?;
        Ok(Card::kept(kept, location))
    }
}

/// Writes `report.html`, `index.csv` and `planners.csv` into a folder of bundles: those its library lists first, in their order,
/// then the others. Bundles whose cards are not at hand are read.
pub(crate) fn write(talk: &Printer, root: &Path, cards: BTreeMap<String, Card>) -> Result<Found, Diagnostic> {
    let holds = Holds::of(root)?;
    let mut source = Source { root, cards, kept: None };
    let (mut page, mut index, mut repeats) =
        (BatchPage::default(), Index::default(), library_index::Repeats::default());
    let mut left_out = Vec::new();
    let mut reports = Vec::new();
    let mut progress = Progress::new(*talk, "reading", holds.made.len());
    for (done, held) in holds.made.iter().enumerate() {
        progress.at(done, "");
        let name = &held.name;
        match source.next(held) {
            Ok(card) => {
                let earlier = holds.earlier(name, &card, &mut repeats);
                index.add(card.runs, earlier.is_some());
                page.add(card.row, &card.location, earlier.as_ref().map(ScenarioId::as_str));
                // What repeats another scenario is no evidence of its own.
                if earlier.is_none() {
                    reports.push((name.clone(), card.reports));
                }
            }
            // Behind a line that cannot be read there is no other.
            Err(why) if !held.bundled => return Err(why),
            Err(why) => {
                page.add_failed(name, &why.what, None);
                let scenario = IndexedScenario { id: name, request: "", location: "", path: name, traits: None };
                index.add_failed(scenario, &why.what, false);
                left_out.push((name.clone(), why.what));
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
    for row in &holds.failed {
        let why = if row.reason.is_empty() { "no bundle could be made" } else { &row.reason };
        let earlier = row.repeats.as_ref().map(ScenarioId::as_str);
        page.add_failed(row.scenario.as_str(), why, earlier);
        let id = row.scenario.as_str();
        let scenario = IndexedScenario { id, request: &row.request, location: "", path: "", traits: None };
        index.add_failed(scenario, why, earlier.is_some());
    }
    let table = index.csv();
    crate::files::write(&root.join(index::FILE), table.as_bytes())?;
    if let Ok(table) = Table::read(&table) {
        page.cover(Coverage::of(&table).told());
    }
    let title = root.canonicalize().ok().and_then(|path| Some(path.file_name()?.to_string_lossy().into_owned()));
    let pages = page.pages(&title.unwrap_or_else(|| "Scenarios".to_owned()));
    for (name, html) in &pages {
        crate::files::write(&root.join(name), html.as_bytes())?;
    }
    // Pages of an earlier time, when there were more scenarios, would be led to by nobody.
    (pages.len()..)
        .take_while(|number| std::fs::remove_file(root.join(BatchPage::file(*number))).is_ok())
        .for_each(drop);
    Ok(Found { rows: page.len(), distinct: page.distinct(), left_out, figures })
}

/// Writes page and tables of a folder of bundles and tells what is in it.
pub(crate) fn report(talk: &Printer, root: &Path) -> Result<(), Diagnostic> {
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

/// What figures need of a report: those of a whole library are in memory at once.
fn counted(report: &Report) -> Report {
    Report {
        clauses: Vec::new(),
        story: Vec::new(),
        verdict_text: String::new(),
        robot_text: String::new(),
        repair: None,
        ..report.clone()
    }
}

/// What is said of a folder without bundles.
pub(crate) fn none(dir: &Path) -> Diagnostic {
    if dir.join(kept::FILE).is_file() {
        return Diagnostic::input(
            format!("`{}` keeps no bundles, and this needs them", dir.display()),
            "make the library again with `--keep packed`, or in an empty folder the scenarios that are needed",
        );
    }
    Diagnostic::input(
        format!("`{}` is no bundle and holds none", dir.display()),
        "name the folder that `socrates run` printed after `look`",
    )
}
